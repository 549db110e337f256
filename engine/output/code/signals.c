/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signals as functions of time; see engine/scene/signal.c, whose bits they have. */
#include <math.h>

#include "engine/base/vec.h"
#include "engine/output/code/writer.h"

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

/* Part n of a signal, which is a sum or an expression; -1: there are no more. */
static int32_t part_of(const strut_signal *s, size_t n) {
  if (s->kind == STRUT_SUM) return n < s->term_count ? s->terms[n] : -1;
  for (size_t i = 0; s->kind == STRUT_EXPRESSION && i < s->program.length; i++) {
    const strut_instruction *p = &s->program.instruction[i];
    bool reads = p->operation == STRUT_OPERATION_COLUMN && p->column.kind == STRUT_COLUMN_SIGNAL;
    if (reads && n-- == 0) return p->column.item;
  }
  return -1;
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
static void add_span(strut_code_writer *w, const strut_signal *s) {
  strut_buffer_add(&w->text, "  if (t < ");
  strut_code_add_double(w, s->start);
  if (isfinite(s->stop)) {
    strut_buffer_add(&w->text, " || t >= ");
    strut_code_add_double(w, s->stop);
  }
  strut_buffer_add(&w->text, ") return;\n");
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
                         "  signal_%d(t, &part, &part_rate);\n"
                         "  *value += part, *rate += part_rate;\n",
                         s->terms[i]);
      break;
    case STRUT_EXPRESSION: strut_code_add_program(w, &s->program); break;
    case STRUT_RELAY:
    case STRUT_SIGNAL_KINDS: break; /* refused by strut_code_check */
  }
}

/* The functions of a signal and of its terms, those that are not there yet. */
static void add_signal(strut_code_writer *w, int32_t index, uint8_t *done) {
  const strut_signal *s = &w->scene->signals[index];
  bool holds = s->kind == STRUT_RAMP || s->kind == STRUT_TABLE || s->kind == STRUT_EXPRESSION;
  if (done[index]) return;
  done[index] = 1;
  for (size_t n = 0; part_of(s, n) >= 0; n++) add_signal(w, part_of(s, n), done);
  if (s->kind == STRUT_TABLE) add_points(w, s, index);
  if (s->name && s->name[0]) {
    strut_buffer_add(&w->text, "/* ");
    strut_code_add_comment(w, s->name);
    strut_buffer_add(&w->text, " */\n");
  }
  strut_buffer_add(&w->text,
                   "static void signal_%d(double t, real *value, real *rate) {\n"
                   "  *value = 0, *rate = 0;\n",
                   index);
  if (!holds) add_span(w, s);
  add_body(w, s, index);
  strut_buffer_add(&w->text, "}\n\n");
}

void strut_code_add_signals(strut_code_writer *w) {
  int32_t count = strut_code_input_count(w->model);
  if (!count) return;
  uint8_t *done = strut_arena_allocate(&w->arena, w->scene->signal_count, 1);
  if (!done) {
    w->text.failed = true;
    return;
  }
  for (int32_t k = 0; k < count; k++) add_signal(w, signal_of_input(w->model, k), done);
  strut_buffer_add(&w->text, "static void (*const own_signal[])(double, real *, real *) = {\n");
  for (int32_t k = 0; k < count; k++)
    strut_buffer_add(&w->text, "    signal_%d, /* %s */\n", signal_of_input(w->model, k),
                     w->inputs.name[k]);
  strut_buffer_add(&w->text, "};\n\n");
}
