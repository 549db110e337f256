/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/measure.h"

#include <assert.h>
#include <math.h>

#include "engine/forces/sliding_masses.h"
#include "engine/model/pose.h"
#include "engine/model/surface_search.h"

/* A mark this close to the end of a step, in steps, counts as being there. */
static const double MARK_TOLERANCE = 1e-6;

/* A mean velocity below this part of the node speeds is the rounding of a symmetric motion. */
static const double SYMMETRY_ROUNDING = 1e-10;

void strut_measure_tracked_point(const strut_model *model, const strut_state *state,
                                 const strut_measurement *m, double *x, double *v) {
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
  if (model->plan & STRUT_TERM_SLIDING_MASS) {
    sum += strut_sliding_masses_moment(model, state, 0, state->q);
    rate += strut_sliding_masses_momentum(model, state, 0, state->q, state->v);
  }
  *x = sum / m->total_mass;
  *v = rate / m->total_mass;
}

static void place_marks(const strut_span *span, double begin, strut_measurement *m) {
  for (size_t i = 0; i < m->marks; i++)
    m->time[i] = begin + (span->period > 0 ? span->window_start + (double)i * span->period
                                           : (i ? span->duration : span->window_start));
  m->time[m->marks - 1] = begin + span->duration;
}

void strut_measure_window(const strut_model *model, strut_state *state, double begin, double period,
                          size_t periods, strut_measurement *m) {
  size_t contacts = (size_t)model->contacts.count;
  assert(periods >= 1);
  m->marks = periods + 1 < m->capacity ? periods + 1 : m->capacity;
  for (size_t i = 0; i < m->marks; i++) m->time[i] = begin + (double)i * period;
  m->next = 0;
  m->window_steps = 0;
  for (size_t i = 0; i < contacts; i++) m->contact_steps[i] = 0, m->max_height[i] = -HUGE_VAL;
  strut_measure_begin(model, state, m);
}

strut_status strut_measure_create(const strut_model *model, const strut_experiment *experiment,
                                  const strut_time_grid *grid, double begin, size_t capacity,
                                  strut_measurement *m) {
  *m = (strut_measurement){.grid = *grid, .node = experiment->measure_node};
  strut_span span = strut_experiment_span(experiment, model->scene);
  m->by_periods = span.period > 0;
  double periods = span.period > 0 ? (span.duration - span.window_start) / span.period : 1.0;
  size_t contacts = (size_t)model->contacts.count;
  m->marks = periods < 1.5 ? 2 : (size_t)ceil(periods - 1e-9) + 1;
  m->capacity = capacity > m->marks ? capacity : m->marks;
  m->time = strut_arena_allocate(&m->arena, m->capacity, sizeof *m->time);
  m->x = strut_arena_allocate(&m->arena, m->capacity, sizeof *m->x);
  m->work = strut_arena_allocate(&m->arena, m->capacity, sizeof *m->work);
  m->contact_steps = strut_arena_allocate(&m->arena, contacts, sizeof *m->contact_steps);
  m->max_height = strut_arena_allocate(&m->arena, contacts, sizeof *m->max_height);
  m->last_gap = strut_arena_allocate(&m->arena, contacts, sizeof *m->last_gap);
  m->gap_before = strut_arena_allocate(&m->arena, contacts, sizeof *m->gap_before);
  bool wanted = experiment->quantity_count > 0;
  if (wanted) m->quantities = strut_quantities_create(model, experiment, &m->arena);
  if (!m->time || !m->x || !m->work || !m->contact_steps || !m->max_height || !m->last_gap ||
      !m->gap_before || (wanted && !m->quantities)) {
    strut_measure_free(m);
    return STRUT_NO_MEMORY;
  }
  place_marks(&span, begin, m);
  for (int32_t i = 0; i < model->node_count; i++) m->total_mass += model->weight[i];
  m->weight = m->total_mass * hypot(model->scene->gravity[0], model->scene->gravity[1]);
  for (size_t i = 0; i < contacts; i++) m->max_height[i] = -HUGE_VAL;
  return STRUT_OK;
}

int64_t strut_measure_first_step(const strut_measurement *m) {
  double n = floor(m->time[0] / m->grid.step + MARK_TOLERANCE);
  return n > 0 ? (int64_t)n : 0;
}

static double largest_node_speed(const strut_model *model, const strut_state *state) {
  double most = 0.0;
  for (int32_t i = 0; i < model->node_count; i++)
    most = fmax(most, hypot(state->v[2 * i], state->v[2 * i + 1]));
  return most;
}

void strut_measure_begin(const strut_model *model, strut_state *state, strut_measurement *m) {
  const strut_marks marks = {
      .step = m->grid.step, .offset = m->grid.offset, .count = m->marks, .time = m->time};
  m->fastest = largest_node_speed(model, state);
  if (m->quantities) strut_quantities_begin(m->quantities, &marks, state);
  strut_measure_tracked_point(model, state, m, &m->last_x, &m->last_v);
  m->last_work = state->work[STRUT_POWER_DRIVE];
  m->ledger = state->ledger;
  double position = m->time[0] / m->grid.step - (double)state->step;
  if (fabs(position) < MARK_TOLERANCE) {
    m->x[0] = m->last_x;
    m->work[0] = m->last_work;
    m->next = 1;
  }
}

/* Of the many pieces of a long profile: which touch, and the height over the lowest. */
static void count_pieces(const strut_contact_table *c, const strut_state *state, int32_t first,
                         int32_t pieces, strut_measurement *m) {
  const strut_ground_motion *motion = state->ground_motion;
  int32_t near = strut_contacts_near(c, first, first + pieces, state->q, motion, 0.0, state->near);
  for (int32_t k = 0; k < near; k++)
    if (strut_contact_gap_at(c, state->near[k], state->q, motion) < 0.0)
      m->contact_steps[state->near[k]]++;
  double gap;
  int32_t lowest = strut_contacts_lowest(c, first, state->q, motion, &gap);
  if (gap > m->max_height[lowest]) m->max_height[lowest] = gap;
}

static void count_contacts(const strut_model *model, const strut_state *state,
                           strut_measurement *m) {
  const strut_contact_table *c = &model->contacts;
  bool equal = m->window_steps >= 2 && state->step != m->grid.last;
  m->window_steps++;
  for (int32_t i = 0; i < c->count; i++) {
    int32_t pieces = c->surface ? strut_contacts_of_profile(c, i) : 0;
    if (pieces) {
      count_pieces(c, state, i, pieces, m);
      i += pieces - 1;
      continue;
    }
    double gap = strut_contact_gap_at(c, i, state->q, state->ground_motion), high = gap;
    double last = m->last_gap[i], before = m->gap_before[i];
    if (gap < 0.0) m->contact_steps[i]++;
    if (equal && last > gap && last > before) /* the vertex between these steps */
      high = last + (gap - before) * (gap - before) / (8.0 * (2.0 * last - gap - before));
    if (high > m->max_height[i]) m->max_height[i] = high;
    m->gap_before[i] = last, m->last_gap[i] = gap;
  }
}

/* Is the next mark within the latest step, which ended as step n? */
static bool mark_reached(const strut_measurement *m, double n) {
  return m->next < m->marks && m->time[m->next] / m->grid.step <= n + MARK_TOLERANCE;
}

/* Length of the step that ended as step n: the last one of a run may be shorter. */
static double step_length(const strut_measurement *m, int64_t n) {
  double rest = n == m->grid.last ? strut_time_grid_rest(&m->grid) : 0.0;
  return rest > 0.0 ? rest : m->grid.step;
}

/* Kept out of strut_measure_step, most calls of which pass no mark. */
static __attribute__((noinline)) void pass_marks(const strut_model *model, const strut_state *state,
                                                 strut_measurement *m, double x, double v) {
  double n = (double)state->step, step = m->grid.step, length = step_length(m, state->step);
  m->fastest = fmax(m->fastest, largest_node_speed(model, state));
  while (mark_reached(m, n)) {
    double s = (m->time[m->next] / step - (n - 1.0)) * (step / length);
    bool end = s > 1.0 - MARK_TOLERANCE;
    double work = state->work[STRUT_POWER_DRIVE];
    m->work[m->next] = end ? work : m->last_work + s * (work - m->last_work);
    m->x[m->next++] = end ? x : strut_hermite(m->last_x, m->last_v, x, v, length, s);
  }
}

void strut_measure_step(const strut_model *model, const strut_state *state, strut_measurement *m) {
  double x, v;
  strut_measure_tracked_point(model, state, m, &x, &v);
  count_contacts(model, state, m);
  if (mark_reached(m, (double)state->step)) pass_marks(model, state, m, x, v);
  m->last_x = x;
  m->last_v = v;
  m->last_work = state->work[STRUT_POWER_DRIVE];
}

void strut_measure_step_quantities(const strut_model *model, strut_state *state,
                                   strut_measurement *m) {
  assert(m->quantities);
  strut_measure_step(model, state, m);
  strut_quantities_step(m->quantities, step_length(m, state->step), state);
}

bool strut_measure_is_zero(const strut_measurement *m, double velocity) {
  return fabs(velocity) <= SYMMETRY_ROUNDING * m->fastest;
}

void strut_measure_finish(const strut_measurement *m, strut_summary *summary) {
  size_t passed = m->next;
  if (m->quantities) strut_quantities_finish(m->quantities, summary);
  summary->velocity = summary->velocity_spread = (double)NAN;
  summary->window_start = m->time[0] + m->grid.offset;
  summary->window_time = summary->window_work = (double)NAN;
  summary->weight = m->weight;
  if (passed >= 2) {
    summary->window_time = m->time[passed - 1] - m->time[0];
    if (m->ledger) summary->window_work = m->work[passed - 1] - m->work[0];
    summary->velocity = (m->x[passed - 1] - m->x[0]) / (m->time[passed - 1] - m->time[0]);
    double sum = 0.0, count = (double)(passed - 1);
    for (size_t i = 1; i < passed; i++) {
      double d = (m->x[i] - m->x[i - 1]) / (m->time[i] - m->time[i - 1]) - summary->velocity;
      sum += d * d;
    }
    if (m->by_periods && passed > 2) summary->velocity_spread = sqrt(sum / (count - 1.0));
  }
  for (size_t i = 0; i < summary->contact_count; i++) {
    strut_contact_summary *c = &summary->contacts[i];
    bool any = m->window_steps > 0;
    c->duty = any ? (double)m->contact_steps[i] / (double)m->window_steps : (double)NAN;
    c->max_height = any && isfinite(m->max_height[i]) ? m->max_height[i] : (double)NAN;
  }
}

void strut_measure_free(strut_measurement *measure) { strut_arena_free(&measure->arena); }
