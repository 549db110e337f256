/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules about sensors and the programs of signals. See check.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/scene/check_rules.h"
#include "engine/scene/signal_program.h"

static bool exists(int32_t index, size_t count) { return index >= 0 && (size_t)index < count; }

void strut_check_maxwell(strut_checker *checker, size_t index, const char *owner) {
  const strut_scene *scene = checker->scene;
  const strut_member *member = &scene->members[index];
  const strut_maxwell *m = &member->maxwell;
  const strut_maxwell none = {0};
  const strut_checked whose = {STRUT_ON_MEMBER, index, owner, "maxwell"};
  if (memcmp(m, &none, sizeof none) == 0) return;
  if (!strut_check_fields(checker, &whose, STRUT_FIELDS_MAXWELL, m, &none)) return;
  if ((m->damping > 0.0) == (m->time > 0.0))
    strut_report_finding(checker, STRUT_ON_MEMBER, index, "maxwell",
                         "the Maxwell branch of %s needs either a damping or a time", owner);
  else if (member->kind == STRUT_CABLE || member->law.carries != STRUT_CARRIES_BOTH)
    strut_report_finding(
        checker, STRUT_ON_MEMBER, index, "maxwell",
        "%s carries one sign only, but its Maxwell branch both; put a spring or a bar "
        "with the branch beside it",
        owner);
  else if (member->kind == STRUT_BAR && scene->bar_model == STRUT_BARS_RIGID)
    strut_report_finding(checker, STRUT_ON_MEMBER, index, "maxwell",
                         "%s has a Maxwell branch, but bars are rigid; make it a spring, or bars: "
                         "elastic",
                         owner);
}

static bool touches(const strut_scene *scene, int32_t node) {
  for (size_t i = 0; i < scene->contact_count; i++)
    if (scene->contacts[i].node == node) return true;
  return false;
}

static void check_sensor(strut_checker *checker, size_t index) {
  const strut_scene *scene = checker->scene;
  const strut_sensor *s = &scene->sensors[index];
  bool known = true;
  char owner[200];
  strut_format_name(owner, "sensor", s->name, index);
  switch (s->kind) {
    case STRUT_SENSOR_LENGTH:
    case STRUT_SENSOR_FORCE: known = exists(s->item, scene->member_count); break;
    case STRUT_SENSOR_ANGLE: known = exists(s->item, scene->hinge_count); break;
    case STRUT_SENSOR_CONTACT:
    case STRUT_SENSOR_POSITION:
    case STRUT_SENSOR_VELOCITY: known = exists(s->item, scene->node_count) && s->along < 2; break;
    case STRUT_SENSOR_ENERGY: known = s->energy <= STRUT_SENSED_TOTAL; break;
    case STRUT_SENSOR_KINDS: known = false;
  }
  if (!known)
    strut_report_finding(checker, STRUT_ON_SENSOR, index, NULL,
                         "%s is of a thing that does not exist", owner);
  else if (s->kind == STRUT_SENSOR_CONTACT && !strut_scene_has_ground(scene))
    strut_report_finding(checker, STRUT_ON_SENSOR, index, "contact",
                         "%s is of a contact, but there is no ground; add 'ground' to the scene",
                         owner);
  else if (s->kind == STRUT_SENSOR_CONTACT && !touches(scene, s->item))
    strut_report_finding(checker, STRUT_ON_SENSOR, index, "contact",
                         "%s is of node '%s', which cannot touch the ground; list it in 'nodes' of "
                         "the ground",
                         owner, scene->nodes[s->item].name);
  else if (s->kind == STRUT_SENSOR_FORCE && scene->bar_model == STRUT_BARS_RIGID &&
           scene->members[s->item].kind == STRUT_BAR)
    strut_report_finding(checker, STRUT_ON_SENSOR, index, "force",
                         "%s is of the force of a bar, but bars are rigid; make the member a "
                         "spring, or bars: elastic",
                         owner);
}

void strut_check_sensors(strut_checker *checker) {
  for (size_t i = 0; i < checker->scene->sensor_count; i++) check_sensor(checker, i);
}

/* Is the instruction one that a signal may have? `signals`: of those before it. */
static bool is_known(const strut_scene *scene, const strut_instruction *p, size_t signals) {
  if (p->operation == STRUT_OPERATION_NUMBER) return isfinite(p->number);
  if (p->operation != STRUT_OPERATION_COLUMN) return (unsigned)p->operation < STRUT_OPERATION_COUNT;
  int32_t item = p->column.item;
  if (p->column.kind == STRUT_COLUMN_TIME) return true;
  if (p->column.kind == STRUT_COLUMN_SENSOR) return exists(item, scene->sensor_count);
  if (p->column.kind == STRUT_COLUMN_SENSOR_RATE)
    return exists(item, scene->sensor_count) && strut_sensor_has_rate(scene->sensors[item].kind);
  if (p->column.kind == STRUT_COLUMN_STATE) return exists(item, scene->state_count);
  return p->column.kind == STRUT_COLUMN_SIGNAL && exists(item, signals);
}

static bool check_program(strut_checker *checker, const strut_program *program, size_t signals,
                          strut_subject subject, size_t index, const char *key, const char *owner) {
  size_t top = 0, most = 0;
  bool valid = program->length > 0;
  for (size_t i = 0; i < program->length && valid; i++) {
    const strut_instruction *p = &program->instruction[i];
    valid = is_known(checker->scene, p, signals);
    if (!valid) break;
    size_t operands = (size_t)strut_operation_operands(p->operation);
    valid = top >= operands;
    top += 1 - operands;
    if (valid && top > most) most = top;
  }
  if (!valid || top != 1)
    strut_report_finding(checker, subject, index, key, "the program of %s is not valid", owner);
  else if (most > STRUT_MOST_PROGRAM_DEPTH)
    strut_report_finding(checker, subject, index, key,
                         "the expression of %s needs more than %d intermediate numbers", owner,
                         STRUT_MOST_PROGRAM_DEPTH);
  else
    return true;
  return false;
}

bool strut_check_program(strut_checker *checker, size_t index, const char *owner) {
  return check_program(checker, &checker->scene->signals[index].program, index, STRUT_ON_SIGNAL,
                       index, "expression", owner);
}

bool strut_check_relay(strut_checker *checker, size_t index, const char *owner) {
  const strut_signal *s = &checker->scene->signals[index];
  const strut_relay *r = &s->relay;
  if (!isfinite(r->upper) || !isfinite(r->lower) || !isfinite(r->on) || !isfinite(r->off))
    strut_report_finding(checker, STRUT_ON_SIGNAL, index, NULL,
                         "the numbers of relay %s are not finite", owner);
  else if (!s->name)
    strut_report_finding(checker, STRUT_ON_SIGNAL, index, NULL, "the relay of %s needs a name",
                         owner);
  else if (s->lag > 0.0 || s->trigger.kind != STRUT_TRIGGER_NONE)
    strut_report_finding(checker, STRUT_ON_SIGNAL, index, NULL,
                         "relay %s has a lag or a trigger; give it to a signal that uses the relay",
                         owner);
  else if (r->lower > r->upper)
    strut_report_finding(
        checker, STRUT_ON_SIGNAL, index, r->on_above ? "off_below" : "off_above",
        r->on_above ? "%s is on above %g and off below %g, so that both hold in between; "
                      "let it be off below a lesser value"
                    : "%s is on below %g and off above %g, so that both hold in between; "
                      "let it be off above a greater value",
        owner, r->on_above ? r->upper : r->lower, r->on_above ? r->lower : r->upper);
  else if (r->lower == r->upper && !(s->every > 0.0))
    strut_report_finding(checker, STRUT_ON_SIGNAL, index, r->on_above ? "off_below" : "off_above",
                         "the thresholds of %s are equal, so that it would switch without end; set "
                         "them apart, or sample it ('every')",
                         owner);
  else
    return true;
  return false;
}

void strut_check_states(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  for (size_t i = 0; i < scene->state_count; i++) {
    char owner[200];
    strut_format_name(owner, "state", scene->states[i].name, i);
    if (!isfinite(scene->states[i].start))
      strut_report_finding(checker, STRUT_ON_STATE, i, "start", "the start of %s is not finite",
                           owner);
    check_program(checker, &scene->states[i].rate, scene->signal_count, STRUT_ON_STATE, i, "rate",
                  owner);
  }
}

static bool check_trigger(strut_checker *checker, size_t index, const char *owner) {
  const strut_scene *scene = checker->scene;
  const strut_trigger *trigger = &scene->signals[index].trigger;
  if (trigger->kind == STRUT_TRIGGER_NONE) return true;
  bool contact = trigger->kind == STRUT_TRIGGER_CONTACT;
  if (!exists(trigger->item, contact ? scene->node_count : scene->sensor_count) ||
      (unsigned)trigger->kind > STRUT_TRIGGER_BELOW || !isfinite(trigger->level))
    strut_report_finding(checker, STRUT_ON_SIGNAL, index, "starts", "what starts %s does not exist",
                         owner);
  else if (contact && (!strut_scene_has_ground(scene) || !touches(scene, trigger->item)))
    strut_report_finding(checker, STRUT_ON_SIGNAL, index, "starts",
                         "%s starts with the touchdown of node '%s', which cannot touch the ground",
                         owner, scene->nodes[trigger->item].name);
  else
    return true;
  return false;
}

bool strut_check_modifiers(strut_checker *checker, size_t index, const char *owner) {
  const strut_signal *s = &checker->scene->signals[index];
  bool trigger = check_trigger(checker, index, owner);
  const strut_checked whose = {STRUT_ON_SIGNAL, index, owner, NULL};
  return strut_check_fields(checker, &whose, STRUT_FIELDS_SIGNAL, s,
                            strut_thing_at(STRUT_THING_SIGNAL)->usual) &&
         trigger;
}

/* Do all programs that a signal may follow make sense? Others have been reported. */
static bool may_describe(const strut_checker *checker) {
  for (size_t i = 0; i < checker->findings->count; i++)
    if (checker->findings->items[i].subject == STRUT_ON_STATE ||
        checker->findings->items[i].subject == STRUT_ON_SENSOR)
      return false;
  return checker->findings->unstored == 0;
}

void strut_check_driven_rate(strut_checker *checker, size_t actuator, const char *owner) {
  const strut_scene *scene = checker->scene;
  const strut_actuator *a = &scene->actuators[actuator];
  if (a->force || !may_describe(checker)) return;
  strut_signal_traits traits = strut_signal_describe(scene, a->signal);
  const char *what = a->member >= 0 ? "length" : "angle";
  if (traits.sensor >= 0)
    strut_report_finding(checker, STRUT_ON_ACTUATOR, actuator, "signal",
                         "%s drives a rest %s by sensor '%s', whose rate is not known; sample the "
                         "signal ('every'), let it lag ('lag'), or drive a load",
                         owner, what, scene->sensors[traits.sensor].name);
  else if (traits.damped >= 0)
    strut_report_finding(
        checker, STRUT_ON_ACTUATOR, actuator, "signal",
        "the rate of the rest %s that %s drives follows sensor '%s', the force of a "
        "member with a damper, which follows such rates; sample the signal "
        "('every')",
        what, owner, scene->sensors[traits.damped].name);
}
