/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure.h"

#include <math.h>

/* A mark this close to a step's end, in steps, counts as being there. */
static const double MARK_TOLERANCE = 1e-6;

void strut_measure_track(const strut_model *model, const strut_state *state,
                         const strut_measure *m, double *x, double *v) {
  if (m->node >= 0) {
    *x = state->q[2 * m->node];
    *v = state->v[2 * m->node];
    return;
  }
  double sum = 0.0, rate = 0.0;
  for (int32_t i = 0; i < model->node_count; i++) {
    sum += model->weight[i] * state->q[2 * i];
    rate += model->weight[i] * state->v[2 * i];
  }
  *x = sum / m->total_mass;
  *v = rate / m->total_mass;
}

static void place_marks(const strut_span *span, double begin, strut_measure *m) {
  for (size_t i = 0; i < m->marks; i++)
    m->time[i] = begin + (span->period > 0 ? span->window_start + (double)i * span->period
                                           : (i ? span->duration : span->window_start));
  m->time[m->marks - 1] = begin + span->duration;
}

void strut_measure_window(const strut_model *model, const strut_state *state, double begin,
                          double period, size_t periods, strut_measure *m) {
  size_t contacts = (size_t)model->contacts.count;
  m->marks = periods + 1 < m->room ? periods + 1 : m->room;
  for (size_t i = 0; i < m->marks; i++) m->time[i] = begin + (double)i * period;
  m->next = 0;
  m->window_steps = 0;
  for (size_t i = 0; i < contacts; i++) m->contact_steps[i] = 0, m->max_height[i] = -HUGE_VAL;
  strut_measure_begin(model, state, m);
}

strut_status strut_measure_create(const strut_model *model, double step, double begin,
                                  size_t room, strut_measure *m) {
  *m = (strut_measure){.step = step, .node = model->scene->experiment.measure_node};
  strut_span span = strut_scene_span(model->scene);
  double periods = span.period > 0 ? (span.duration - span.window_start) / span.period : 1.0;
  size_t contacts = (size_t)model->contacts.count;
  m->marks = periods < 1.5 ? 2 : (size_t)ceil(periods - 1e-9) + 1;
  m->room = room > m->marks ? room : m->marks;
  m->time = strut_arena_allocate(&m->arena, m->room, sizeof *m->time);
  m->x = strut_arena_allocate(&m->arena, m->room, sizeof *m->x);
  m->contact_steps = strut_arena_allocate(&m->arena, contacts, sizeof *m->contact_steps);
  m->max_height = strut_arena_allocate(&m->arena, contacts, sizeof *m->max_height);
  if (!m->time || !m->x || !m->contact_steps || !m->max_height) {
    strut_measure_free(m);
    return STRUT_NO_MEMORY;
  }
  place_marks(&span, begin, m);
  for (int32_t i = 0; i < model->node_count; i++) m->total_mass += model->weight[i];
  for (size_t i = 0; i < contacts; i++) m->max_height[i] = -HUGE_VAL;
  return STRUT_OK;
}

int64_t strut_measure_first_step(const strut_measure *m) {
  double n = floor(m->time[0] / m->step + MARK_TOLERANCE);
  return n > 0 ? (int64_t)n : 0;
}

void strut_measure_begin(const strut_model *model, const strut_state *state, strut_measure *m) {
  strut_measure_track(model, state, m, &m->last_x, &m->last_v);
  double position = m->time[0] / m->step - (double)state->step;
  if (fabs(position) < MARK_TOLERANCE) {
    m->x[0] = m->last_x;
    m->next = 1;
  }
}

/* Cubic through both ends of a step with their slopes, at the fraction s of it. */
static double hermite(double x0, double v0, double x1, double v1, double h, double s) {
  double r = 1.0 - s;
  return x0 * (1.0 + 2.0 * s) * r * r + h * v0 * s * r * r + x1 * s * s * (3.0 - 2.0 * s) -
         h * v1 * s * s * r;
}

static void count_contacts(const strut_model *model, const strut_state *state, strut_measure *m) {
  const strut_contact_table *c = &model->contacts;
  m->window_steps++;
  for (int32_t i = 0; i < c->count; i++) {
    const double *q = state->q + c->at[i];
    double up = q[1] - c->height;
    double gap = c->normal[0] == 0.0 ? up : q[0] * c->normal[0] + up * c->normal[1];
    if (gap < 0.0) m->contact_steps[i]++;
    if (gap > m->max_height[i]) m->max_height[i] = gap;
  }
}

void strut_measure_step(const strut_model *model, const strut_state *state, strut_measure *m) {
  double x, v, n = (double)state->step;
  strut_measure_track(model, state, m, &x, &v);
  count_contacts(model, state, m);
  while (m->next < m->marks && m->time[m->next] / m->step <= n + MARK_TOLERANCE) {
    double s = m->time[m->next] / m->step - (n - 1.0);
    m->x[m->next++] = s > 1.0 - MARK_TOLERANCE
                          ? x
                          : hermite(m->last_x, m->last_v, x, v, m->step, s);
  }
  m->last_x = x;
  m->last_v = v;
}

void strut_measure_finish(const strut_model *model, const strut_measure *m,
                          strut_summary *summary) {
  size_t passed = m->next;
  summary->velocity = summary->velocity_spread = (double)NAN;
  summary->window_start = m->time[0];
  if (passed >= 2) {
    summary->velocity = (m->x[passed - 1] - m->x[0]) / (m->time[passed - 1] - m->time[0]);
    double sum = 0.0, count = (double)(passed - 1);
    for (size_t i = 1; i < passed; i++) {
      double d = (m->x[i] - m->x[i - 1]) / (m->time[i] - m->time[i - 1]) - summary->velocity;
      sum += d * d;
    }
    bool by_periods = strut_scene_span(model->scene).period > 0;
    if (by_periods && passed > 2) summary->velocity_spread = sqrt(sum / (count - 1.0));
  }
  for (size_t i = 0; i < summary->contact_count; i++) {
    strut_contact_summary *c = &summary->contacts[i];
    bool any = m->window_steps > 0;
    c->duty = any ? (double)m->contact_steps[i] / (double)m->window_steps : (double)NAN;
    c->max_height = any ? m->max_height[i] : (double)NAN;
  }
}

void strut_measure_free(strut_measure *measure) { strut_arena_free(&measure->arena); }
