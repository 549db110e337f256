/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules about signals, and what they read. See check.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/scene/checks/check_rules.h"
#include "engine/scene/profile.h"
#include "engine/scene/signal_program.h"

/* ---- sensors, programs, relays and internal states ---- */

void strut_check_maxwell(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const strut_member *member = &scene->members[checker->index];
  const strut_maxwell *maxwell = &member->maxwell;
  const strut_maxwell none = {0};
  if (memcmp(maxwell, &none, sizeof none) == 0) return;
  checker->within = "maxwell";
  bool valid = strut_check_fields(checker, STRUT_FIELDS_MAXWELL, maxwell, &none);
  checker->within = NULL;
  if (!valid) return;
  if ((maxwell->damping > 0.0) == (maxwell->time > 0.0))
    strut_fault_of(checker, "maxwell", "the Maxwell branch of %s needs either a damping or a time",
                   checker->owner);
  else if (member->kind == STRUT_CABLE || member->law.carries != STRUT_CARRIES_BOTH)
    strut_fault(checker, "maxwell",
                "carries one sign only, but its Maxwell branch both; put a spring or a bar "
                "with the branch beside it");
  else if (member->kind == STRUT_BAR && scene->bar_model == STRUT_BARS_RIGID)
    strut_fault(checker, "maxwell",
                "has a Maxwell branch, but bars are rigid; make it a spring, or bars: "
                "elastic");
}

static bool touches(const strut_scene *scene, int32_t node) {
  for (size_t i = 0; i < scene->contact_count; i++)
    if (scene->contacts[i].node == node) return true;
  return false;
}

/* Is there what a column is of? */
static bool column_exists(const strut_scene *scene, strut_column column) {
  if ((unsigned)column.kind >= STRUT_COLUMN_COUNT) return false;
  strut_channel_owner owner = strut_observable_at(column.kind)->owner;
  strut_thing thing = strut_thing_of_owner(owner);
  if (owner == STRUT_OWNER_PAIR)
    return strut_exists(column.item, scene->node_count) &&
           strut_exists(column.other, scene->node_count);
  return thing == STRUT_THING_COUNT || strut_exists(column.item, strut_thing_count(scene, thing));
}

static void check_sensor(strut_checker *checker, size_t index) {
  const strut_scene *scene = checker->scene;
  const strut_sensor *sensor = &scene->sensors[index];
  strut_check_begin(checker, STRUT_THING_SENSOR, index);
  bool known = sensor->along < 2 && sensor->energy < 3 &&
               strut_sensor_column(sensor).kind != STRUT_COLUMN_TIME &&
               column_exists(scene, strut_sensor_column(sensor));
  if (!known) {
    strut_fault(checker, NULL, "is of a thing that does not exist");
    return;
  }
  strut_column seen = strut_sensor_column(sensor);
  bool contact = strut_observable_at(seen.kind)->owner == STRUT_OWNER_CONTACT,
       ground = contact || seen.kind == STRUT_COLUMN_HEIGHT;
  const char *key = sensor->length                      ? "of"
                    : seen.kind == STRUT_COLUMN_TOUCHES ? "contact"
                                                        : "contact_force";
  if (ground && !strut_scene_has_ground(scene))
    strut_fault(checker, key, "is of a contact, but there is no ground; add 'ground' to the scene");
  else if (contact && !touches(scene, seen.item))
    strut_fault(checker, key,
                "is of node '%s', which cannot touch the ground; list it in 'nodes' of "
                "the ground",
                scene->nodes[seen.item].name);
  else if (seen.kind == STRUT_COLUMN_FORCE && scene->bar_model == STRUT_BARS_RIGID &&
           scene->members[seen.item].kind == STRUT_BAR)
    strut_fault(checker, sensor->length ? "of" : "force",
                "is of the force of a bar, but bars are rigid; make the member a "
                "spring, or bars: elastic");
}

void strut_check_sensors(strut_checker *checker) {
  for (size_t i = 0; i < checker->scene->sensor_count; i++) check_sensor(checker, i);
}

/* Is the instruction one that a signal may have? `signals`: of those before it. */
static bool is_known(const strut_scene *scene, const strut_instruction *instruction,
                     size_t signals) {
  if (instruction->operation == STRUT_OPERATION_NUMBER) return isfinite(instruction->number);
  if (instruction->operation != STRUT_OPERATION_COLUMN)
    return (unsigned)instruction->operation < STRUT_OPERATION_COUNT;
  int32_t item = instruction->column.item;
  if (instruction->column.kind == STRUT_COLUMN_TIME) return true;
  if (instruction->column.kind == STRUT_COLUMN_SENSOR)
    return strut_exists(item, scene->sensor_count);
  if (instruction->column.kind == STRUT_COLUMN_SENSOR_RATE)
    return strut_exists(item, scene->sensor_count) && strut_sensor_has_rate(&scene->sensors[item]);
  if (instruction->column.kind == STRUT_COLUMN_STATE) return strut_exists(item, scene->state_count);
  return instruction->column.kind == STRUT_COLUMN_SIGNAL && strut_exists(item, signals);
}

static bool check_program(strut_checker *checker, const strut_program *program, size_t signals,
                          const char *key) {
  size_t top = 0, most = 0;
  bool valid = program->length > 0;
  for (size_t i = 0; i < program->length && valid; i++) {
    const strut_instruction *instruction = &program->instruction[i];
    if (instruction->operation == STRUT_OPERATION_NUMBER && !isfinite(instruction->number))
      return strut_fault_of(checker, key, "a number of %s is not finite", checker->owner);
    valid = is_known(checker->scene, instruction, signals);
    if (!valid) break;
    size_t operands = (size_t)strut_operation_operands(instruction->operation);
    valid = top >= operands;
    top += 1 - operands;
    if (valid && top > most) most = top;
  }
  if (!valid || top != 1)
    return strut_fault_of(checker, key, "the program of %s is not valid", checker->owner);
  if (most > STRUT_MOST_PROGRAM_DEPTH)
    return strut_fault_of(checker, key,
                          "the expression of %s needs more than %d intermediate numbers",
                          checker->owner, STRUT_MOST_PROGRAM_DEPTH);
  return true;
}

static bool check_relay(strut_checker *checker) {
  const strut_signal *signal = &checker->scene->signals[checker->index];
  const strut_relay *relay = &signal->relay;
  if (!isfinite(relay->upper) || !isfinite(relay->lower) || !isfinite(relay->on) ||
      !isfinite(relay->off))
    return strut_fault_of(checker, NULL, "the numbers of relay %s are not finite", checker->owner);
  if (!signal->name)
    return strut_fault_of(checker, NULL, "the relay of %s needs a name", checker->owner);
  if (signal->lag > 0.0 || signal->trigger.kind != STRUT_TRIGGER_NONE)
    return strut_fault_of(
        checker, NULL, "relay %s has a lag or a trigger; give it to a signal that uses the relay",
        checker->owner);
  if (relay->lower > relay->upper)
    return strut_fault_of(checker, relay->on_above ? "off_below" : "off_above",
                          relay->on_above
                              ? "%s is on above %g and off below %g, so that both hold in between; "
                                "let it be off below a lesser value"
                              : "%s is on below %g and off above %g, so that both hold in between; "
                                "let it be off above a greater value",
                          checker->owner, relay->on_above ? relay->upper : relay->lower,
                          relay->on_above ? relay->lower : relay->upper);
  if (relay->lower == relay->upper && !(signal->every > 0.0))
    return strut_fault_of(
        checker, relay->on_above ? "off_below" : "off_above",
        "the thresholds of %s are equal, so that it would switch without end; set "
        "them apart, or sample it ('every')",
        checker->owner);
  return true;
}

void strut_check_states(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  for (size_t i = 0; i < scene->state_count; i++) {
    strut_check_begin(checker, STRUT_THING_STATE, i);
    if (!isfinite(scene->states[i].start))
      strut_fault_of(checker, "start", "the start of %s is not finite", checker->owner);
    check_program(checker, &scene->states[i].rate, scene->signal_count, "rate");
  }
}

static bool check_trigger(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const strut_trigger *trigger = &scene->signals[checker->index].trigger;
  if (trigger->kind == STRUT_TRIGGER_NONE) return true;
  bool contact = trigger->kind == STRUT_TRIGGER_CONTACT;
  if (!strut_exists(trigger->item, contact ? scene->node_count : scene->sensor_count) ||
      (unsigned)trigger->kind > STRUT_TRIGGER_BELOW || !isfinite(trigger->level))
    return strut_fault_of(checker, "starts", "what starts %s does not exist", checker->owner);
  if (contact && (!strut_scene_has_ground(scene) || !touches(scene, trigger->item)))
    return strut_fault(checker, "starts",
                       "starts with the touchdown of node '%s', which cannot touch the ground",
                       scene->nodes[trigger->item].name);
  return true;
}

/* Do all programs that a signal may follow make sense? Others have been reported. */
static bool may_describe(const strut_checker *checker) {
  for (size_t i = 0; i < checker->findings->count; i++)
    if (checker->findings->items[i].subject == STRUT_ON_STATE ||
        checker->findings->items[i].subject == STRUT_ON_SENSOR)
      return false;
  return checker->findings->unstored == 0;
}

void strut_check_driven_rate(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const strut_actuator *actuator = &scene->actuators[checker->index];
  if (actuator->force || !may_describe(checker)) return;
  strut_signal_traits traits = strut_signal_describe(scene, actuator->signal);
  const char *what = actuator->member >= 0 ? "length" : "angle";
  if (traits.sensor >= 0)
    strut_fault(checker, "signal",
                "drives a rest %s by sensor '%s', whose rate is not known; sample the "
                "signal ('every'), let it lag ('lag'), or drive a load",
                what, scene->sensors[traits.sensor].name);
  else if (traits.damped >= 0)
    strut_fault_of(checker, "signal",
                   "the rate of the rest %s that %s drives follows sensor '%s', the force of a "
                   "member with a damper, which follows such rates; sample the signal "
                   "('every')",
                   what, checker->owner, scene->sensors[traits.damped].name);
}

/* ---- signals ---- */

enum { MOST_TERMS = 10000, DEEPEST_SUM = 64 };

static bool check_table(strut_checker *checker) {
  const strut_signal *signal = &checker->scene->signals[checker->index];
  if (signal->point_count < (signal->kind == STRUT_DATA ? 2 : 1))
    return strut_fault_of(checker, "table", "the table of %s has %s", checker->owner,
                          signal->point_count ? "one point" : "no points");
  for (size_t i = 0; i < signal->point_count; i++) {
    if (!isfinite(signal->time[i]) || !isfinite(signal->value[i]))
      strut_fault_of(checker, "table", "point %zu in the table of %s is not finite", i + 1,
                     checker->owner);
    else if (i && signal->time[i] < signal->time[i - 1])
      strut_fault_of(
          checker, "table",
          "the times in the table of %s must increase, but point %zu at %g s follows %g s",
          checker->owner, i + 1, signal->time[i], signal->time[i - 1]);
    else if (i > 1 && signal->time[i] <= signal->time[i - 2])
      strut_fault_of(
          checker, "table",
          "the table of %s has three points at %g s, expected at most two, between which it jumps",
          checker->owner, signal->time[i]);
    else
      continue;
    return false;
  }
  return true;
}

/* How long a run takes [s]; 0 where that is not known, or nothing runs. */
static double run_time(const strut_checker *checker) {
  const strut_experiment *experiment = checker->experiment;
  int32_t period = experiment->period_signal;
  bool known = experiment->periods == 0.0 ||
               (strut_exists(period, checker->scene->signal_count) && !checker->wild[period]);
  if (checker->purpose != STRUT_FOR_RUN || !known) return 0.0;
  return strut_experiment_span(experiment, checker->scene).duration;
}

/* Do data last from t = 0 to the end of a run, where they must? */
static void check_data(strut_checker *checker) {
  const strut_signal *signal = &checker->scene->signals[checker->index];
  double first = signal->time[0], last = signal->time[signal->point_count - 1],
         end = run_time(checker);
  if (signal->outside != STRUT_OUTSIDE_ERROR) return;
  if (signal->trigger.kind != STRUT_TRIGGER_NONE)
    strut_fault_of(checker, "data",
                   "the time of %s begins later, so that its data need 'outside: hold' or 'repeat'",
                   checker->owner);
  else if (first > 0.0 || last < end)
    strut_fault_of(checker, "data",
                   "the data of %s last from %g s to %g s, expected all times from 0 to %g s; or "
                   "say what they are 'outside': hold or repeat",
                   checker->owner, first, last, end);
}

/* Signal that part i of a sum or an expression refers to; -1: it refers to none. */
static int32_t part_of(const strut_signal *signal, size_t i) {
  if (signal->kind == STRUT_SUM) return signal->terms[i];
  const strut_instruction *instruction = &signal->program.instruction[i];
  bool refers = instruction->operation == STRUT_OPERATION_COLUMN &&
                instruction->column.kind == STRUT_COLUMN_SIGNAL;
  return refers ? instruction->column.item : -1;
}

static size_t part_count(const strut_signal *signal) {
  if (signal->kind == STRUT_SUM) return signal->term_count;
  return strut_signal_has_program(signal) ? signal->program.length : 0;
}

/* Counts parts and depth of a sum or an expression, whose signals have been checked before. */
static bool check_sum(strut_checker *checker, uint32_t *size, uint32_t *depth) {
  const strut_signal *signal = &checker->scene->signals[checker->index];
  uint64_t terms = 1;
  size_t index = checker->index;
  if (strut_signal_has_program(signal) &&
      !check_program(checker, &signal->program, index, "expression"))
    return false;
  if (signal->kind == STRUT_RELAY && !check_relay(checker)) return false;
  if (signal->kind == STRUT_SUM && !signal->term_count)
    return strut_fault_of(checker, "sum", "the sum of %s has no terms", checker->owner);
  for (size_t i = 0; i < part_count(signal); i++) {
    int32_t term = part_of(signal, i);
    if (term < 0 && strut_signal_has_program(signal)) continue;
    if (term < 0 || (size_t)term >= index)
      return strut_fault_of(checker, "sum", "term %zu of %s is not a signal that comes before it",
                            i + 1, checker->owner);
    if (checker->wild[term]) return false; /* reported there */
    terms += size[term];
    if (depth[term] >= depth[index]) depth[index] = depth[term] + 1;
  }
  size[index] = terms > MOST_TERMS ? MOST_TERMS + 1 : (uint32_t)terms;
  if (terms <= MOST_TERMS && depth[index] <= DEEPEST_SUM) return true;
  return strut_fault(checker, NULL, "has more than %d terms, or sums within sums more than %d deep",
                     MOST_TERMS, DEEPEST_SUM);
}

static bool check_wave(strut_checker *checker) {
  const strut_signal *signal = &checker->scene->signals[checker->index];
  bool wave =
      signal->kind == STRUT_SINE || signal->kind == STRUT_HALF_SINE || signal->kind == STRUT_SQUARE;
  const struct {
    const char *key;
    double value;
  } numbers[] = {
      {"amplitude", signal->amplitude}, {"phase", signal->phase}, {"start", signal->start}};
  bool valid = true; /* as of a sine, whatever the wave */
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
    valid =
        strut_check_number(checker, STRUT_FIELDS_SINE, numbers[i].key, numbers[i].value) && valid;
  if (wave)
    valid = strut_check_number(checker, STRUT_FIELDS_SINE, "frequency", signal->frequency) && valid;
  if (!valid) return false;
  if (signal->kind == STRUT_RAMP && !isfinite(signal->stop))
    return strut_fault(checker, "stop", "needs a stop");
  if (!(signal->stop > signal->start))
    return strut_fault_of(checker, "stop",
                          "the stop of %s must come after its start, found %g s after %g s",
                          checker->owner, signal->stop, signal->start);
  return true;
}

/* A run stops at each jump: more of them than this in a step, or in a run without one, are a mistake. */
static const double MOST_JUMPS_OF_STEP = 1e3, MOST_JUMPS_OF_RUN = 1e9;

static void check_jumps(strut_checker *checker) {
  const strut_experiment *experiment = checker->experiment;
  const strut_signal *signal = &checker->scene->signals[checker->index];
  bool step = experiment->step > 0.0 && isfinite(experiment->step);
  /* jumps per second; tables and ramps jump as often as they are long */
  double rate = signal->kind == STRUT_SQUARE ? 2.0 * signal->frequency : 0.0;
  double span = step ? experiment->step : experiment->duration;
  if (signal->every > 0.0) rate = fmax(rate, 1.0 / signal->every);
  if (checker->purpose != STRUT_FOR_RUN || !(span > 0.0 && isfinite(span))) return;
  if (rate * span <= (step ? MOST_JUMPS_OF_STEP : MOST_JUMPS_OF_RUN)) return;
  bool sampled = signal->every > 0.0 && signal->every * rate <= 1.0;
  strut_fault(checker, sampled ? "every" : "frequency",
              "jumps %.3g times within %s of %g s, expected at most %g; give %s%s", rate * span,
              step ? "a step" : "the run", span, step ? MOST_JUMPS_OF_STEP : MOST_JUMPS_OF_RUN,
              sampled ? "a longer 'every'" : "a lower frequency", step ? " or a smaller step" : "");
}

static void begin_with_signal(strut_checker *checker, size_t i) {
  const strut_signal *signal = &checker->scene->signals[i];
  strut_check_begin(checker, STRUT_THING_SIGNAL, i);
  if (!signal->name && signal->owner)
    snprintf(checker->owner, sizeof checker->owner, "%s", signal->owner);
}

void strut_check_signals(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  uint32_t *size = strut_allocate(scene->signal_count, sizeof *size);
  uint32_t *depth = strut_allocate(scene->signal_count, sizeof *depth);
  if (!size || !depth) checker->out_of_memory = true;
  for (size_t i = 0; !checker->out_of_memory && i < scene->signal_count; i++) {
    const strut_signal *signal = &scene->signals[i];
    begin_with_signal(checker, i);
    size[i] = depth[i] = 1;
    if ((unsigned)signal->kind >= STRUT_SIGNAL_KINDS) {
      strut_fault(checker, NULL, "is of an unknown kind");
      checker->wild[i] = true;
      continue;
    }
    bool modified = check_trigger(checker);
    modified = strut_check_thing(checker) && modified;
    checker->wild[i] = !modified || (strut_signal_has_points(signal) ? !check_table(checker)
                                     : signal->kind == STRUT_SUM || strut_signal_has_program(signal)
                                         ? !check_sum(checker, size, depth)
                                         : !check_wave(checker));
    if (!checker->wild[i]) check_jumps(checker);
  }
  for (size_t i = 0; !checker->out_of_memory && i < scene->signal_count; i++)
    if (scene->signals[i].kind == STRUT_DATA && !checker->wild[i]) {
      begin_with_signal(checker, i);
      check_data(checker);
    }
  strut_release(size);
  strut_release(depth);
}
