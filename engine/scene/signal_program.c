/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Programs of signals: value and rate of each operation, side by side. See signal_program.h. */
#include "engine/scene/signal_program.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/scene/scene.h"

/* A number and its time derivative. */
typedef struct dual {
  double value, rate;
} dual;

int strut_operation_operands(strut_operation operation) {
  static const int operands[] = {
#define STRUT_OPERANDS(id, count, ...) count,
      STRUT_OPERATION_TABLE(STRUT_OPERANDS)
#undef STRUT_OPERANDS
  };
  assert((unsigned)operation < STRUT_OPERATION_COUNT);
  return operands[operation];
}

/* slope * rate, where a rate of 0 stays 0 whatever the slope is. */
static dual chain(double value, double slope, double rate) {
  return (dual){value, rate == 0.0 ? 0.0 : slope * rate};
}

static dual raise_to_power(dual a, dual b) {
  dual result = chain(pow(a.value, b.value), b.value * pow(a.value, b.value - 1.0), a.rate);
  if (b.rate != 0.0) result.rate += result.value * log(a.value) * b.rate;
  return result;
}

static dual combine(strut_operation operation, dual a, dual b) {
  double square = a.value * a.value + b.value * b.value, root;
  switch ((int)operation) {
    case STRUT_OPERATION_ADD: return (dual){a.value + b.value, a.rate + b.rate};
    case STRUT_OPERATION_SUBTRACT: return (dual){a.value - b.value, a.rate - b.rate};
    case STRUT_OPERATION_MULTIPLY:
      return (dual){a.value * b.value, a.rate * b.value + a.value * b.rate};
    case STRUT_OPERATION_DIVIDE:
      return (dual){a.value / b.value, (a.rate - a.value / b.value * b.rate) / b.value};
    case STRUT_OPERATION_POWER: return raise_to_power(a, b);
    case STRUT_OPERATION_MIN: return b.value < a.value ? b : a;
    case STRUT_OPERATION_MAX: return b.value > a.value ? b : a;
    case STRUT_OPERATION_ATAN2:
      return chain(atan2(a.value, b.value), 1.0 / square, b.value * a.rate - a.value * b.rate);
    case STRUT_OPERATION_HYPOT:
      root = hypot(a.value, b.value);
      return chain(root, 1.0 / root, a.value * a.rate + b.value * b.rate);
    default: break;
  }
  return (dual){(double)NAN, (double)NAN};
}

static dual apply(strut_operation operation, dual a) {
  const double ten = 2.30258509299404568402; /* log 10 */
  double x = a.value, y;
  switch ((int)operation) {
    case STRUT_OPERATION_NEGATE: return (dual){-x, -a.rate};
    case STRUT_OPERATION_SIN: return chain(sin(x), cos(x), a.rate);
    case STRUT_OPERATION_COS: return chain(cos(x), -sin(x), a.rate);
    case STRUT_OPERATION_TAN: y = tan(x); return chain(y, 1.0 + y * y, a.rate);
    case STRUT_OPERATION_ASIN: return chain(asin(x), 1.0 / sqrt(1.0 - x * x), a.rate);
    case STRUT_OPERATION_ACOS: return chain(acos(x), -1.0 / sqrt(1.0 - x * x), a.rate);
    case STRUT_OPERATION_ATAN: return chain(atan(x), 1.0 / (1.0 + x * x), a.rate);
    case STRUT_OPERATION_SQRT: y = sqrt(x); return chain(y, 0.5 / y, a.rate);
    case STRUT_OPERATION_EXP: y = exp(x); return chain(y, y, a.rate);
    case STRUT_OPERATION_LOG: return chain(log(x), 1.0 / x, a.rate);
    case STRUT_OPERATION_LOG10: return chain(log10(x), 1.0 / (ten * x), a.rate);
    case STRUT_OPERATION_TANH: y = tanh(x); return chain(y, 1.0 - y * y, a.rate);
    case STRUT_OPERATION_ABS: return (dual){fabs(x), x < 0.0 ? -a.rate : a.rate};
    case STRUT_OPERATION_FLOOR: return (dual){floor(x), 0.0};
    case STRUT_OPERATION_CEIL: return (dual){ceil(x), 0.0};
    case STRUT_OPERATION_ROUND: return (dual){round(x), 0.0};
    default: break;
  }
  return (dual){(double)NAN, (double)NAN};
}

double strut_operation_apply(strut_operation operation, double a, double b) {
  dual x = {a, 0.0}, y = {b, 0.0};
  return strut_operation_operands(operation) == 1 ? apply(operation, x).value
                                                  : combine(operation, x, y).value;
}

/* Has it a kink, where its operand, or the difference of both, is 0? */
static bool has_kink(strut_operation operation) {
  return operation == STRUT_OPERATION_ABS || operation == STRUT_OPERATION_MIN ||
         operation == STRUT_OPERATION_MAX;
}

/*
 * The result of an instruction, which is `free` by its operands, where a side is held; and notes the margin. What min
 * and max leave out may be too steep for a step without error control.
 */
static dual hold_side(const strut_kinks *kinks, const strut_instruction *instruction, dual a,
                      dual b, dual free) {
  int32_t i = 0;
  while (i < kinks->count && kinks->at[i] != instruction) i++;
  if (i == kinks->count) return free;
  double side = kinks->side[i], sign = side < 0.0 ? -1.0 : 1.0;
  kinks->margin[i] = sign * (a.value - b.value), kinks->rate[i] = sign * (a.rate - b.rate);
  if (side == 0.0) return free;
  if (instruction->operation == STRUT_OPERATION_ABS) return (dual){side * a.value, side * a.rate};
  if (!kinks->controlled) return free;
  return (instruction->operation == STRUT_OPERATION_MIN) == (side > 0.0) ? b : a;
}

/* An internal state and its rate, which takes the values of others only. */
static dual read_state(int32_t index, const strut_signal *signals, const strut_signal_inputs *in,
                       double t) {
  dual x = {in->state[index], 0.0};
  if (in->values_only) return x;
  strut_signal_inputs values = *in;
  double unused;
  values.values_only = true;
  strut_program_evaluate(&in->states[index].rate, signals, &values, t, &x.rate, &unused);
  return x;
}

static dual read_column(strut_column column, const strut_signal *signals,
                        const strut_signal_inputs *in, double t) {
  dual x = {(double)NAN, (double)NAN};
  if (column.kind == STRUT_COLUMN_TIME)
    x = (dual){t, 1.0};
  else if (column.kind == STRUT_COLUMN_SIGNAL)
    strut_signal_follow(signals, in, column.item, t, &x.value, &x.rate);
  else if (column.kind == STRUT_COLUMN_SENSOR && in)
    x = (dual){in->sensor[column.item], in->sensor_rate[column.item]};
  else if (column.kind == STRUT_COLUMN_SENSOR_RATE && in)
    x = (dual){in->sensor_rate[column.item], 0.0};
  else if (column.kind == STRUT_COLUMN_STATE && in)
    x = read_state(column.item, signals, in, t);
  return x;
}

void strut_program_evaluate(const strut_program *program, const strut_signal *signals,
                            const strut_signal_inputs *in, double t, double *value, double *rate) {
  dual stack[STRUT_MOST_PROGRAM_DEPTH];
  size_t top = 0;
  for (size_t i = 0; i < program->length; i++) {
    const strut_instruction *instruction = &program->instruction[i];
    int operands = strut_operation_operands(instruction->operation);
    assert(top >= (size_t)operands && top < STRUT_MOST_PROGRAM_DEPTH + (size_t)operands);
    if (instruction->operation == STRUT_OPERATION_NUMBER) {
      stack[top++] = (dual){instruction->number, 0.0};
    } else if (operands == 0) {
      stack[top++] = read_column(instruction->column, signals, in, t);
    } else {
      top -= (size_t)operands - 1;
      dual a = stack[top - 1], b = operands == 1 ? (dual){0.0, 0.0} : stack[top];
      stack[top - 1] =
          operands == 1 ? apply(instruction->operation, a) : combine(instruction->operation, a, b);
      if (in && in->kinks && has_kink(instruction->operation))
        stack[top - 1] = hold_side(in->kinks, instruction, a, b, stack[top - 1]);
    }
  }
  assert(top == 1);
  *value = stack[0].value, *rate = stack[0].rate;
}

/* How a dependence reaches a signal: at once, or through an integral, whose rate it is. */
typedef enum passage { DIRECT, INTEGRATED } passage;

static void describe_signal(const strut_scene *scene, int32_t index, passage through,
                            strut_signal_traits *traits);

static void describe_sensor(const strut_scene *scene, int32_t index, bool rate, passage through,
                            strut_signal_traits *traits) {
  const strut_sensor *sensor = &scene->sensors[index];
  strut_column seen = strut_sensor_column(sensor);
  traits->follows = true;
  if (through == DIRECT) {
    if (rate || !strut_sensor_has_rate(sensor)) traits->sensor = index;
  } else if (seen.kind == STRUT_COLUMN_FORCE && scene->members[seen.item].damping > 0.0) {
    traits->damped = index;
  }
}

static void describe_program(const strut_scene *scene, const strut_program *program,
                             passage through, strut_signal_traits *traits) {
  for (size_t i = 0; i < program->length; i++) {
    const strut_instruction *instruction = &program->instruction[i];
    if (instruction->operation != STRUT_OPERATION_COLUMN) continue;
    strut_column_kind kind = instruction->column.kind;
    if (kind == STRUT_COLUMN_SIGNAL)
      describe_signal(scene, instruction->column.item, through, traits);
    if (kind == STRUT_COLUMN_SENSOR || kind == STRUT_COLUMN_SENSOR_RATE)
      describe_sensor(scene, instruction->column.item, kind == STRUT_COLUMN_SENSOR_RATE, through,
                      traits);
    if (kind != STRUT_COLUMN_STATE) continue;
    traits->follows = true;
    if (through == DIRECT)
      describe_program(scene, &scene->states[instruction->column.item].rate, INTEGRATED, traits);
  }
}

static void describe_signal(const strut_scene *scene, int32_t index, passage through,
                            strut_signal_traits *traits) {
  const strut_signal *signal = &scene->signals[index];
  if (signal->every > 0.0 || signal->lag > 0.0 || signal->trigger.kind != STRUT_TRIGGER_NONE)
    traits->follows = true;
  if (signal->kind == STRUT_RELAY) traits->follows = true;
  if (signal->kind == STRUT_RELAY || signal->every > 0.0 ||
      (signal->lag > 0.0 && through == INTEGRATED))
    return;
  if (signal->lag > 0.0) through = INTEGRATED;
  for (size_t i = 0; signal->kind == STRUT_SUM && i < signal->term_count; i++)
    describe_signal(scene, signal->terms[i], through, traits);
  if (signal->kind == STRUT_EXPRESSION) describe_program(scene, &signal->program, through, traits);
}

strut_signal_traits strut_signal_describe(const strut_scene *scene, int32_t index) {
  strut_signal_traits traits = {.sensor = -1, .damped = -1};
  describe_signal(scene, index, DIRECT, &traits);
  return traits;
}

int32_t strut_scene_kinks(const strut_scene *scene, const strut_instruction **at, int32_t *signal) {
  int32_t count = 0;
  for (size_t i = 0; i < scene->signal_count; i++) {
    const strut_signal *s = &scene->signals[i];
    if (s->kind != STRUT_EXPRESSION || s->every > 0.0) continue;
    if (!strut_signal_describe(scene, (int32_t)i).follows) continue;
    for (size_t k = 0; k < s->program.length; k++) {
      if (!has_kink(s->program.instruction[k].operation)) continue;
      if (at) at[count] = &s->program.instruction[k], signal[count] = (int32_t)i;
      count++;
    }
  }
  return count;
}

bool strut_program_reads(const strut_program *program, strut_column_kind one,
                         strut_column_kind other) {
  for (size_t i = 0; i < program->length; i++) {
    const strut_instruction *instruction = &program->instruction[i];
    bool column = instruction->operation == STRUT_OPERATION_COLUMN;
    if (column && (instruction->column.kind == one || instruction->column.kind == other))
      return true;
  }
  return false;
}

static bool reads_sensor(const strut_program *program) {
  return strut_program_reads(program, STRUT_COLUMN_SENSOR, STRUT_COLUMN_SENSOR_RATE);
}

bool strut_scene_has_feedback(const strut_scene *scene) {
  for (size_t i = 0; i < scene->signal_count; i++)
    if (strut_signal_has_program(&scene->signals[i]) && reads_sensor(&scene->signals[i].program))
      return true;
  for (size_t i = 0; i < scene->state_count; i++)
    if (reads_sensor(&scene->states[i].rate)) return true;
  return false;
}

/* ---- what turns ---- */

enum { MOMENTS = 16 }; /* at which rates are looked at */

static void note_turn(strut_turning *fastest, double rate, const char *kind, const char *name) {
  if (!(fabs(rate) > fastest->rate)) return;
  fastest->rate = fabs(rate);
  snprintf(fastest->name, sizeof fastest->name, name ? "%s '%.80s'" : "%s", kind, name);
}

/* Where the instructions begin that compute the operand of number `end`. */
static size_t begin_of_operand(const strut_program *program, size_t end) {
  int wanted = 1;
  while (end > 0 && wanted > 0)
    wanted += strut_operation_operands(program->instruction[--end].operation) - 1;
  return end;
}

/* The fastest argument of a sine or of whole numbers [turns/s]; what follows the motion is not known. */
static double turns_of_program(const strut_scene *scene, const strut_program *program,
                               double last) {
  double most = 0.0, value, rate;
  for (size_t i = 0; i < program->length; i++) {
    strut_operation operation = program->instruction[i].operation;
    bool wave = operation == STRUT_OPERATION_SIN || operation == STRUT_OPERATION_COS ||
                operation == STRUT_OPERATION_TAN;
    bool saw = operation == STRUT_OPERATION_FLOOR || operation == STRUT_OPERATION_CEIL ||
               operation == STRUT_OPERATION_ROUND;
    if (!wave && !saw) continue;
    size_t begin = begin_of_operand(program, i);
    strut_program angle = {i - begin, program->depth, program->instruction + begin};
    for (int k = 0; k <= MOMENTS; k++) {
      strut_program_evaluate(&angle, scene->signals, NULL, last * k / MOMENTS, &value, &rate);
      rate = fabs(rate) / (wave ? STRUT_TAU : 1.0);
      if (rate > most) most = rate;
    }
  }
  return most;
}

static double turns_of_signal(const strut_scene *scene, const strut_signal *signal, double last,
                              bool stops) {
  if (signal->every > 0.0) return 0.0;
  if (strut_signal_has_program(signal)) /* within a step such methods look for what it does */
    return stops ? 0.0 : turns_of_program(scene, &signal->program, last);
  bool jumps = signal->kind == STRUT_SQUARE || signal->kind == STRUT_HALF_SINE;
  bool turns = signal->kind == STRUT_SINE || (jumps && !stops);
  return turns && signal->amplitude != 0.0 ? signal->frequency : 0.0;
}

/* An oscillator's own rate is the number that its program begins with. */
static double turns_of_state(const strut_internal_state *state) {
  const strut_instruction *first = state->rate.instruction;
  bool angle = state->unit && strcmp(state->unit, "rad") == 0 && state->rate.length > 0;
  return angle && first->operation == STRUT_OPERATION_NUMBER ? first->number / STRUT_TAU : 0.0;
}

static void note_user(const strut_scene *scene, double last, bool stops, int32_t signal,
                      strut_turning *fastest) {
  if (signal < 0) return;
  const strut_signal *s = &scene->signals[signal];
  const char *kind = s->name ? "signal" : s->owner ? s->owner : "a signal";
  note_turn(fastest, turns_of_signal(scene, s, last, stops), kind, s->name);
  for (size_t i = 0; s->kind == STRUT_SUM && i < s->term_count; i++)
    note_user(scene, last, stops, s->terms[i], fastest);
  for (size_t i = 0; strut_signal_has_program(s) && i < s->program.length; i++) {
    const strut_instruction *instruction = &s->program.instruction[i];
    if (instruction->operation == STRUT_OPERATION_COLUMN &&
        instruction->column.kind == STRUT_COLUMN_SIGNAL)
      note_user(scene, last, stops, instruction->column.item, fastest);
  }
}

strut_turning strut_scene_fastest_turn(const strut_scene *scene, double last, bool stops) {
  strut_turning fastest = {.rate = 0.0};
  for (size_t i = 0; i < scene->actuator_count; i++)
    note_user(scene, last, stops, scene->actuators[i].signal, &fastest);
  for (size_t i = 0; i < scene->load_count; i++)
    note_user(scene, last, stops, scene->loads[i].signal, &fastest);
  for (size_t i = 0; i < scene->support_motion_count; i++)
    note_user(scene, last, stops, scene->support_motions[i].signal, &fastest);
  for (size_t i = 0; i < scene->sliding_count; i++)
    note_user(scene, last, stops, scene->sliding_masses[i].signal, &fastest);
  for (size_t i = 0; i < scene->ground_count; i++)
    for (int c = 0; c < 2; c++)
      if (scene->grounds[i].moves[c])
        note_user(scene, last, stops, scene->grounds[i].motion[c], &fastest);
  for (size_t i = 0; i < scene->contact_count; i++)
    if (scene->contacts[i].friction.driven)
      note_user(scene, last, stops, scene->contacts[i].friction.signal, &fastest);
  for (size_t i = 0; i < scene->unbalance_count; i++) {
    const strut_unbalance *unbalance = &scene->unbalances[i];
    note_turn(&fastest, unbalance->speed / STRUT_TAU, "unbalance", unbalance->name);
    double value, rate;
    for (int k = 0; k <= MOMENTS && unbalance->signal >= 0; k++) {
      strut_signal_evaluate(scene->signals, unbalance->signal, last * k / MOMENTS, &value, &rate);
      note_turn(&fastest, rate / STRUT_TAU, "unbalance", unbalance->name);
    }
  }
  for (size_t i = 0; i < scene->state_count; i++)
    note_turn(&fastest, turns_of_state(&scene->states[i]), "oscillator", scene->states[i].name);
  return fastest;
}
