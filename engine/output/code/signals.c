/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signals as functions of time; see engine/scene/signal.c, whose bits they have. */
#include <math.h>

#include "engine/base/vec.h"
#include "engine/output/code/writer.h"
#include "engine/scene/signal_program.h"

/* The signal of input k. */
static int32_t signal_of_input(const strut_model *model, int32_t k) {
  int32_t drives = model->drives.count, loads = model->loads.count;
  int32_t others = drives + loads + model->actuator_forces.count;
  if (k >= others) {
    int axis;
    const strut_ground *ground = strut_code_shaken(model, k - others, &axis);
    return ground->motion[axis];
  }
  return k < drives           ? model->drives.signal[k]
         : k < drives + loads ? model->loads.signal[k - drives]
                              : model->actuator_forces.item[k - drives - loads].signal;
}

static bool reads(const strut_instruction *p, strut_column_kind kind) {
  return p->operation == STRUT_OPERATION_COLUMN && p->column.kind == kind;
}

/* The n-th signal that a program reads; -1: there are no more. */
static int32_t signal_in(const strut_program *program, size_t n) {
  for (size_t i = 0; i < program->length; i++) {
    const strut_instruction *p = &program->instruction[i];
    if (reads(p, STRUT_COLUMN_SIGNAL) && n-- == 0) return p->column.item;
  }
  return -1;
}

/* Part n of a signal, which is a sum or an expression; -1: there are no more. */
static int32_t part_of(const strut_signal *s, size_t n) {
  if (s->kind == STRUT_SUM) return n < s->term_count ? s->terms[n] : -1;
  return strut_signal_has_program(s) ? signal_in(&s->program, n) : -1;
}

static bool contains(const strut_signal *signals, int32_t index, int32_t wanted) {
  if (index == wanted) return true;
  for (size_t n = 0; part_of(&signals[index], n) >= 0; n++)
    if (contains(signals, part_of(&signals[index], n), wanted)) return true;
  return false;
}

bool strut_code_signal_acts(const strut_code_writer *w, int32_t signal) {
  for (int32_t k = 0; k < strut_code_input_count(w->model); k++)
    if (contains(w->scene->signals, signal_of_input(w->model, k), signal)) return true;
  for (int32_t k = 0; strut_code_slider_signal(w, k) >= 0; k++)
    if (contains(w->scene->signals, strut_code_slider_signal(w, k), signal)) return true;
  for (size_t k = 0; k < w->scene->state_count && strut_code_has_feedback(w); k++)
    for (size_t n = 0; signal_in(&w->scene->states[k].rate, n) >= 0; n++)
      if (contains(w->scene->signals, signal_in(&w->scene->states[k].rate, n), signal)) return true;
  return false;
}

bool strut_code_has_signal(const strut_code_writer *w, strut_signal_kind kind) {
  for (size_t i = 0; i < w->scene->signal_count; i++)
    if (w->scene->signals[i].kind == kind && strut_code_signal_acts(w, (int32_t)i)) return true;
  return false;
}

/* "double turns = 10.0 * (t - 1.0) + 0.25;" */
static void add_turns(strut_code_writer *w, const strut_signal *s) {
  strut_buffer_add(&w->text, "  double turns = ");
  strut_code_add_double(w, s->frequency);
  strut_buffer_add(&w->text, s->start != 0.0 ? " * (t - " : " * t");
  if (s->start != 0.0) {
    strut_code_add_double(w, s->start);
    strut_buffer_add(&w->text, ")");
  }
  if (s->phase != 0.0) {
    strut_buffer_add(&w->text, " + ");
    strut_code_add_double(w, s->phase);
  }
  strut_buffer_add(&w->text, ";\n");
}

static void add_wave(strut_code_writer *w, const strut_signal *s, const char *condition) {
  add_turns(w, s);
  strut_buffer_add(&w->text, "  %swave(turns, ", condition);
  strut_code_add_real(w, s->amplitude);
  strut_buffer_add(&w->text, ", ");
  strut_code_add_real(w, s->amplitude * STRUT_TAU * s->frequency);
  strut_buffer_add(&w->text, ", value, rate);\n");
}

static void add_square(strut_code_writer *w, const strut_signal *s) {
  add_turns(w, s);
  strut_buffer_add(&w->text, "  *value = turns - floor(turns) < 0.5 ? ");
  strut_code_add_real(w, s->amplitude);
  strut_buffer_add(&w->text, " : ");
  strut_code_add_real(w, -s->amplitude);
  strut_buffer_add(&w->text, ";\n");
}

static void add_ramp(strut_code_writer *w, const strut_signal *s) {
  strut_buffer_add(&w->text, "  if (t >= ");
  strut_code_add_double(w, s->stop);
  strut_buffer_add(&w->text, ") {\n    *value = ");
  strut_code_add_real(w, s->amplitude);
  strut_buffer_add(&w->text, ";\n  } else if (t >= ");
  strut_code_add_double(w, s->start);
  strut_buffer_add(&w->text, ") {\n    *value = ");
  strut_code_add_real(w, s->amplitude);
  strut_buffer_add(&w->text, " * (real)((t - ");
  strut_code_add_double(w, s->start);
  strut_buffer_add(&w->text, ") / ");
  strut_code_add_double(w, s->stop - s->start);
  strut_buffer_add(&w->text, ");\n    *rate = ");
  strut_code_add_real(w, s->amplitude / (s->stop - s->start));
  strut_buffer_add(&w->text, ";\n  }\n");
}

static void add_points(strut_code_writer *w, const strut_signal *s, int32_t index) {
  strut_buffer_add(&w->text, "static const double time_%d[] = {", index);
  for (size_t i = 0; i < s->point_count; i++) {
    strut_buffer_add(&w->text, i % 6 ? " " : "\n    ");
    strut_code_add_double(w, s->time[i]);
    strut_buffer_add(&w->text, ",");
  }
  strut_buffer_add(&w->text, "};\nstatic const real point_%d[] = {", index);
  for (size_t i = 0; i < s->point_count; i++) {
    strut_buffer_add(&w->text, i % 6 ? " " : "\n    ");
    strut_code_add_real(w, s->value[i]);
    strut_buffer_add(&w->text, ",");
  }
  strut_buffer_add(&w->text, "};\n");
}

/* Outside its time the signal is 0. */
static void add_span(strut_code_writer *w, const strut_signal *s, const char *leave) {
  strut_buffer_add(&w->text, "  if (t < ");
  strut_code_add_double(w, s->start);
  if (isfinite(s->stop)) {
    strut_buffer_add(&w->text, " || t >= ");
    strut_code_add_double(w, s->stop);
  }
  strut_buffer_add(&w->text, ") %s;\n", leave);
}

static void add_body(strut_code_writer *w, const strut_signal *s, int32_t index) {
  switch (s->kind) {
    case STRUT_CONSTANT:
      strut_buffer_add(&w->text, "  *value = ");
      strut_code_add_real(w, s->amplitude);
      strut_buffer_add(&w->text, ";\n");
      break;
    case STRUT_SINE: add_wave(w, s, ""); break;
    case STRUT_HALF_SINE: add_wave(w, s, "if (turns < 0.5) "); break;
    case STRUT_SQUARE: add_square(w, s); break;
    case STRUT_RAMP: add_ramp(w, s); break;
    case STRUT_TABLE:
      strut_buffer_add(&w->text, "  interpolate(time_%d, point_%d, %zu, t, value, rate);\n", index,
                       index, s->point_count);
      break;
    case STRUT_SUM:
      strut_buffer_add(&w->text, "  real part, part_rate;\n");
      for (size_t i = 0; i < s->term_count; i++)
        strut_buffer_add(&w->text,
                         "  signal_%s(%st, &part, &part_rate);\n"
                         "  *value += part, *rate += part_rate;\n",
                         w->signals.name[s->terms[i]], strut_code_has_feedback(w) ? "o, " : "");
      break;
    case STRUT_EXPRESSION:
      strut_code_add_program(w, &s->program);
      strut_buffer_add(&w->text, "  *value = (real)x[0].value, *rate = (real)x[0].rate;\n");
      break;
    case STRUT_RELAY:
      strut_buffer_add(&w->text, "  *value = o->s->relay_above[%d] ? ",
                       strut_code_relay_of(w, index));
      strut_code_add_real(w, strut_relay_value(s, 1));
      strut_buffer_add(&w->text, " : ");
      strut_code_add_real(w, strut_relay_value(s, -1));
      strut_buffer_add(&w->text, ";\n");
      break;
    case STRUT_SIGNAL_KINDS: break;
  }
}

/* "static TYPE NAME(const observed *o, double t" */
static void begin_function(strut_code_writer *w, const char *type, const char *what,
                           const char *name) {
  strut_buffer_add(&w->text, "static %s %s_%s(%sdouble t", type, what, name,
                   strut_code_has_feedback(w) ? "const observed *o, " : "");
}

/* Parameters that the function does not read. */
static void add_unread(strut_code_writer *w, bool reads_observed, bool reads_time) {
  if (!reads_observed && strut_code_has_feedback(w)) strut_buffer_add(&w->text, "  (void)o;\n");
  if (!reads_time) strut_buffer_add(&w->text, "  (void)t;\n");
}

static bool program_reads_time(const strut_program *program) {
  for (size_t i = 0; i < program->length; i++) {
    const strut_instruction *p = &program->instruction[i];
    if (reads(p, STRUT_COLUMN_TIME) || reads(p, STRUT_COLUMN_SIGNAL) ||
        reads(p, STRUT_COLUMN_STATE))
      return true;
  }
  return false;
}

static bool program_reads_observed(const strut_program *program) {
  for (size_t i = 0; i < program->length; i++) {
    const strut_instruction *p = &program->instruction[i];
    if (p->operation == STRUT_OPERATION_COLUMN && p->column.kind != STRUT_COLUMN_TIME) return true;
  }
  return false;
}

/* What a program gives, rates of states and lags left out. */
static void add_value_of(strut_code_writer *w, const char *what, const char *name,
                         const strut_program *program) {
  begin_function(w, "double", what, name);
  strut_buffer_add(&w->text, ") {\n");
  add_unread(w, program_reads_observed(program), program_reads_time(program));
  strut_code_add_program(w, program);
  strut_buffer_add(&w->text, "  return x[0].value;\n}\n\n");
}

/* The signal itself, from its start on, without lag and samples. */
static void add_plain(strut_code_writer *w, int32_t index, const char *what) {
  const strut_signal *s = &w->scene->signals[index];
  bool holds = s->kind == STRUT_RAMP || s->kind == STRUT_TABLE || strut_signal_has_program(s);
  bool starts = s->trigger.kind != STRUT_TRIGGER_NONE;
  bool observes = s->kind == STRUT_SUM || s->kind == STRUT_RELAY || starts ||
                  (s->kind == STRUT_EXPRESSION && program_reads_observed(&s->program));
  begin_function(w, "void", what, w->signals.name[index]);
  strut_buffer_add(&w->text, ", real *value, real *rate) {\n  *value = 0, *rate = 0;\n");
  add_unread(w, observes,
             starts || (s->kind == STRUT_EXPRESSION ? program_reads_time(&s->program)
                                                    : s->kind != STRUT_RELAY));
  if (starts) {
    int32_t k = strut_code_start_of(w, index);
    strut_buffer_add(&w->text,
                     "  if (!(t >= o->s->started_at[%d])) return;\n  t -= o->s->started_at[%d];\n",
                     k, k);
  }
  if (!holds) add_span(w, s, "return");
  add_body(w, s, index);
  strut_buffer_add(&w->text, "}\n\n");
}

/* It follows with a first-order lag, which is an internal state. */
static void add_lagged(strut_code_writer *w, int32_t index, const char *what) {
  int32_t state = w->model->feedback.lag_of[index];
  begin_function(w, "void", what, w->signals.name[index]);
  strut_buffer_add(&w->text,
                   ", real *value, real *rate) {\n"
                   "  const observed values = {o->s, o->state, 1};\n"
                   "  real wanted, unused;\n"
                   "  *value = o->state[%d], *rate = 0;\n"
                   "  if (o->values_only) return;\n"
                   "  unlagged_%s(&values, t, &wanted, &unused);\n"
                   "  *rate = (wanted - *value) / ",
                   state, w->signals.name[index]);
  strut_code_add_real(w, w->scene->signals[index].lag);
  strut_buffer_add(&w->text, ";\n}\n\n");
}

/* The functions of a signal and of its terms, those that are not there yet. */
static void add_signal(strut_code_writer *w, int32_t index, uint8_t *done) {
  const strut_signal *s = &w->scene->signals[index];
  bool lagged = s->lag > 0.0, sampled = s->every > 0.0;
  if (done[index]) return;
  done[index] = 1;
  for (size_t n = 0; part_of(s, n) >= 0; n++) add_signal(w, part_of(s, n), done);
  if (s->kind == STRUT_TABLE) add_points(w, s, index);
  if (s->name && s->name[0]) {
    strut_buffer_add(&w->text, "/* ");
    strut_code_add_comment(w, s->name);
    strut_buffer_add(&w->text, " */\n");
  }
  if (s->kind == STRUT_RELAY) add_value_of(w, "relay_input", w->signals.name[index], &s->program);
  add_plain(w, index, lagged ? "unlagged" : sampled ? "unsampled" : "signal");
  if (lagged) add_lagged(w, index, sampled ? "lagged" : "signal");
  if (!sampled) return;
  begin_function(w, "void", "signal", w->signals.name[index]);
  strut_buffer_add(&w->text,
                   ", real *value, real *rate) {\n  (void)t;\n"
                   "  *value = o->s->held[%d], *rate = 0;\n}\n\n",
                   strut_code_sample_of(w, index));
}

/* Rates of the scene's internal states. */
static void add_states(strut_code_writer *w, uint8_t *done) {
  int32_t count = (int32_t)w->scene->state_count;
  for (int32_t k = 0; k < count; k++) {
    const strut_program *rate = &w->scene->states[k].rate;
    for (size_t n = 0; signal_in(rate, n) >= 0; n++) add_signal(w, signal_in(rate, n), done);
  }
  for (int32_t k = 0; k < count; k++) {
    strut_buffer_add(&w->text, "/* d/dt ");
    strut_code_add_comment(w, w->scene->states[k].name);
    strut_buffer_add(&w->text, " */\n");
    add_value_of(w, "state_rate", w->states.name[k], &w->scene->states[k].rate);
  }
  strut_buffer_add(&w->text,
                   "static double rate_of_state(const observed *o, int k, double t) {\n"
                   "  static double (*const rates[])(const observed *, double) = {");
  for (int32_t k = 0; k < count; k++)
    strut_buffer_add(&w->text, "%sstate_rate_%s", k ? ", " : "", w->states.name[k]);
  strut_buffer_add(&w->text, "};\n  return rates[k](o, t);\n}\n\n");
}

void strut_code_add_signals(strut_code_writer *w) {
  int32_t count = strut_code_input_count(w->model);
  if (!count && !strut_code_has_sliding(w)) return;
  uint8_t *done = strut_arena_allocate(&w->arena, w->scene->signal_count, 1);
  if (!done) {
    w->text.failed = true;
    return;
  }
  for (int32_t k = 0; k < count; k++) add_signal(w, signal_of_input(w->model, k), done);
  for (int32_t k = 0; strut_code_slider_signal(w, k) >= 0; k++)
    add_signal(w, strut_code_slider_signal(w, k), done);
  if (strut_code_has_internal_states(w)) add_states(w, done);
  if (!count) return;
  strut_buffer_add(&w->text, "static void (*const own_signal[])(%sdouble, real *, real *) = {\n",
                   strut_code_has_feedback(w) ? "const observed *, " : "");
  for (int32_t k = 0; k < count; k++)
    strut_buffer_add(&w->text, "    signal_%s, /* %s */\n",
                     w->signals.name[signal_of_input(w->model, k)], w->inputs.name[k]);
  strut_buffer_add(&w->text, "};\n\n");
}

/* As strut_signal_acceleration: of waves and their sums, 0 of others. */
static void add_second_rate(strut_code_writer *w, int32_t index, uint8_t *done) {
  const strut_signal *s = &w->scene->signals[index];
  bool wave = s->kind == STRUT_SINE || s->kind == STRUT_HALF_SINE;
  double omega = STRUT_TAU * s->frequency;
  if (done[index]) return;
  done[index] = 1;
  for (size_t n = 0; part_of(s, n) >= 0; n++) add_second_rate(w, part_of(s, n), done);
  strut_buffer_add(&w->text, "static real second_rate_%s(double t) {\n", w->signals.name[index]);
  if (wave) {
    strut_buffer_add(&w->text, "  real sine = 0, unused = 0;\n");
    add_span(w, s, "return 0");
    add_turns(w, s);
    strut_buffer_add(&w->text, "  %swave(turns, 1, 0, &sine, &unused);\n  return ",
                     s->kind == STRUT_HALF_SINE ? "if (turns < 0.5) " : "");
    strut_code_add_real(w, -s->amplitude * omega * omega);
    strut_buffer_add(&w->text, " * sine;\n");
  } else if (s->kind == STRUT_SUM) {
    strut_buffer_add(&w->text, "  real sum = 0;\n");
    add_span(w, s, "return 0");
    for (size_t i = 0; i < s->term_count; i++)
      strut_buffer_add(&w->text, "  sum += second_rate_%s(t);\n", w->signals.name[s->terms[i]]);
    strut_buffer_add(&w->text, "  return sum;\n");
  } else {
    strut_buffer_add(&w->text, "  (void)t;\n  return 0;\n");
  }
  strut_buffer_add(&w->text, "}\n\n");
}

void strut_code_add_second_rates(strut_code_writer *w) {
  uint8_t *done = strut_arena_allocate(&w->arena, w->scene->signal_count, 1);
  if (!done) {
    w->text.failed = true;
    return;
  }
  for (int32_t k = 0; strut_code_slider_signal(w, k) >= 0; k++)
    add_second_rate(w, strut_code_slider_signal(w, k), done);
}
