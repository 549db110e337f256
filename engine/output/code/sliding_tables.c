/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Masses that slide along members: their tables, and the lines that place them. */
#include <math.h>

#include "engine/output/code/writer.h"

static const strut_sliding_item *item_of(const strut_code_writer *w, int32_t k) {
  const strut_sliding_table *t = &w->model->sliding;
  return &t->item[t->moving[k]];
}

int32_t strut_code_slider_signal(const strut_code_writer *w, int32_t k) {
  return k < w->model->sliding.moving_count ? item_of(w, k)->signal : -1;
}

const char *strut_code_slider_name(const strut_code_writer *w, int32_t k) {
  return w->scene->sliding_masses[w->model->sliding.moving[k]].name;
}

bool strut_code_has_sliding(const strut_code_writer *w) {
  return w->model->terms & STRUT_TERM_SLIDING_MASS;
}
static bool has_corners(const strut_code_writer *w) {
  return strut_code_has_sliding(w) && w->model->sliding.corners;
}
static bool has_resting(const strut_code_writer *w) {
  return w->model->sliding.count > w->model->sliding.moving_count;
}

const strut_code_condition strut_code_sliding_conditions[] = {
    {"sliding", strut_code_has_sliding},
    {"slider_corners", has_corners},
    {"resting", has_resting},
    {NULL, NULL},
};

/* ---- tables ---- */

static void add_answers(strut_code_writer *w) {
  const strut_sliding_table *t = &w->model->sliding;
  strut_buffer_add(&w->text, "static const answer answers[] = {\n");
  for (int32_t k = 0; k < t->moving_count; k++)
    for (int32_t i = 0; i < t->answer[k].count; i++) {
      strut_buffer_add(&w->text, "    {%u", t->answer[k].at[i]);
      for (int c = 0; c < 4; c++) strut_code_add_field(w, t->answer[k].xy[4 * i + c]);
      strut_code_end_row(w, w->scene->nodes[t->answer[k].at[i] / 2].name);
    }
  strut_buffer_add(&w->text, "};\n\n");
}

/* Corners of a signal after t = 0: they are finitely many, since nothing that repeats has any. */
static int32_t add_corners(strut_code_writer *w, int32_t signal, bool write) {
  const strut_signal *signals = w->scene->signals;
  int32_t count = 0;
  double at = strut_signal_next_break(signals, signal, 0.0);
  for (; at < HUGE_VAL; at = strut_signal_next_break(signals, signal, at), count++) {
    if (!write) continue;
    strut_buffer_add(&w->text, count % 8 ? " " : "\n    ");
    strut_code_add_double(w, at);
    strut_buffer_add(&w->text, ",");
  }
  return count;
}

static void add_corner_times(strut_code_writer *w) {
  strut_buffer_add(&w->text, "static const double corner_time[] = { /* [s] */");
  for (int32_t k = 0; k < w->model->sliding.moving_count; k++)
    add_corners(w, item_of(w, k)->signal, true);
  strut_buffer_add(&w->text, "};\n\n");
}

static void add_between(strut_code_writer *w) {
  const strut_sliding_table *t = &w->model->sliding;
  int32_t row = 2 * t->moving_count;
  strut_buffer_add(
      &w->text,
      "/* Entries of the inverse mass matrix between the nodes of all sliders' members, of x, then "
      "y [1/kg]. */\nstatic const real between[] = {\n");
  for (int32_t i = 0; i < 2 * row * row; i++) {
    strut_buffer_add(&w->text, i % row ? " " : "    ");
    strut_code_add_real(w, t->between[i]);
    strut_buffer_add(&w->text, (i + 1) % row ? "," : ",\n");
  }
  strut_buffer_add(&w->text, "};\n\n");
}

/* The fields of struct slider in sliding.c.in. */
static void add_rows(strut_code_writer *w) {
  const strut_sliding_table *t = &w->model->sliding;
  int32_t answers = 0, corners = 0;
  strut_buffer_add(&w->text, "static const slider sliders[] = {\n");
  for (int32_t k = 0; k < t->moving_count; k++) {
    const strut_sliding_item *s = item_of(w, k);
    strut_buffer_add(&w->text, "    {%u, %u", s->at[0], s->at[1]);
    strut_code_add_field(w, s->mass);
    strut_code_add_field(w, s->start);
    strut_code_add_field(w, s->scale);
    strut_buffer_add(&w->text, ", %d, %d", answers, t->answer[k].count);
    answers += t->answer[k].count;
    if (has_corners(w)) {
      int32_t own = add_corners(w, s->signal, false);
      strut_buffer_add(&w->text, ", signal_%s, %d, %d", w->signals.name[s->signal], corners, own);
      corners += own;
    }
    strut_code_end_row(w, strut_code_slider_name(w, k));
  }
  strut_buffer_add(&w->text, "};\n\n");
}

/* The lines that place sliders at time t. */
void strut_code_add_places(strut_code_writer *w) {
  for (int32_t k = 0; k < w->model->sliding.moving_count; k++) {
    const strut_sliding_item *s = item_of(w, k);
    const char *name = w->signals.name[s->signal];
    strut_buffer_add(&w->text, "  signal_%s(%st, &value, &rate); /* %s */\n  s->share[%d] = ", name,
                     strut_code_has_feedback(w) ? "&o, " : "", w->sliders.name[k], k);
    strut_code_add_real(w, s->base);
    strut_buffer_add(&w->text, " + ");
    strut_code_add_real(w, s->scale);
    strut_buffer_add(&w->text, " * value;\n  s->share_rate[%d] = ", k);
    strut_code_add_real(w, s->scale);
    strut_buffer_add(&w->text, " * rate;\n  s->share_bend[%d] = ", k);
    strut_code_add_real(w, s->scale);
    strut_buffer_add(&w->text, " * second_rate_%s(t);\n", name);
  }
}

void strut_code_add_sliders(strut_code_writer *w) {
  add_answers(w);
  add_between(w);
  if (has_corners(w)) add_corner_times(w);
  add_rows(w);
  strut_code_add_second_rates(w);
}

/* "  u = 0.7 * v[2] + 0.3 * v[4];": the speed of a mass that rests on its member. */
static void add_speed(strut_code_writer *w, const strut_sliding_item *s, uint32_t c) {
  strut_buffer_add(&w->text, "  u = ");
  strut_code_add_real(w, 1.0 - s->start);
  strut_buffer_add(&w->text, " * v[%u] + ", s->at[0] + c);
  strut_code_add_real(w, s->start);
  strut_buffer_add(&w->text, " * v[%u];\n", s->at[1] + c);
}

/* Kinetic energy of masses that rest on their members, which the mass matrix has. */
void strut_code_add_resting(strut_code_writer *w) {
  const strut_sliding_table *t = &w->model->sliding;
  strut_buffer_add(&w->text,
                   "static real energy_of_resting(const real *v) {\n  real sum = 0, u;\n");
  for (int32_t i = 0; i < t->count; i++)
    for (uint32_t c = 0; c < 2 && t->item[i].signal < 0; c++) {
      add_speed(w, &t->item[i], c);
      strut_buffer_add(&w->text, "  sum += ");
      strut_code_add_real(w, 0.5 * t->item[i].mass);
      strut_buffer_add(&w->text, " * u * u;\n");
    }
  strut_buffer_add(&w->text, "  return sum;\n}\n\n");
}

static void add_drag(strut_code_writer *w, uint32_t at, double share) {
  strut_buffer_add(&w->text, "  s->force[%u] -= ", at);
  strut_code_add_real(w, share);
  strut_buffer_add(&w->text, " * drag;\n");
}

/* And what damps them by their mass. */
void strut_code_add_resting_damping(strut_code_writer *w) {
  const strut_sliding_table *t = &w->model->sliding;
  strut_buffer_add(&w->text, "  real u, drag; /* of masses that rest on their members */\n");
  for (int32_t i = 0; i < t->count; i++)
    for (uint32_t c = 0; c < 2 && t->item[i].signal < 0; c++) {
      const strut_sliding_item *s = &t->item[i];
      add_speed(w, s, c);
      strut_buffer_add(&w->text, "  drag = mass_damping * ");
      strut_code_add_real(w, s->mass);
      strut_buffer_add(&w->text, " * u;\n");
      add_drag(w, s->at[0] + c, 1.0 - s->start);
      add_drag(w, s->at[1] + c, s->start);
    }
}
