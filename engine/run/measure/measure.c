/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/measure.h"

#include <assert.h>
#include <float.h>
#include <math.h>

#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/drives/support_motion.h"
#include "engine/forces/rubbing.h"
#include "engine/forces/surfaces.h"
#include "engine/model/pose.h"
#include "engine/model/surface_search.h"

/* ---- energy balance ---- */

/* Force evaluations between two samples, which make the cost of a sample negligible. */
enum { EVALUATIONS_PER_SAMPLE = 256 };
/* Part of the exchanged energy; rounding errors of this many units in the last place per step. */
static const double OPEN = 0.01, ROUNDING = 16.0 * DBL_EPSILON;

/*
 * Part of the exchanged energy that a loss may give between two samples. Weights of Runge-Kutta's stages
 * below 0 do: 4e-11 of it at most in all models, by each method and with steps far too long.
 */
static const double GIVEN = 1e-6;

static double absolute_change(double a, double b) { return fabs(a - b); }

/* Change of the balance that rounding over the steps may explain. */
static double rounding_of(const strut_energy *e, int64_t steps) {
  double stored = fabs(e->initial) + e->kinetic + e->elastic + fabs(e->gravity) + e->contact;
  return ROUNDING * ((double)steps + 100.0) * (stored + e->moved + e->placed);
}

/*
 * Energy whose rounding is that of positions: a force that acts over the way to the origin, as positions are stored
 * from there, however small the motion. The forces are those of gravity, and of springs that store such an energy.
 */
static double energy_of_places(const strut_model *model, const strut_state *state,
                               const strut_energies *now) {
  const strut_contact_table *c = &model->contacts;
  const double *g = model->scene->gravity;
  double away = 0.0, weight = 0.0, stiffness = 0.0;
  for (int32_t i = 0; i < model->node_count; i++) {
    away = fmax(away, fmax(fabs(state->q[2 * i]), fabs(state->q[2 * i + 1])));
    weight += model->weight[i] * hypot(g[0], g[1]);
  }
  for (int32_t j = 0; j < model->members.count; j++) stiffness += model->members.stiffness[j];
  for (int32_t i = 0; i < model->elements.count; i++)
    stiffness += model->elements.element[i].numbers.stiffness;
  for (int32_t i = 0; i < c->count; i++) stiffness += c->entry[i].stiffness;
  double force = weight + sqrt(2.0 * stiffness * (fabs(now->elastic) + now->contact));
  return away * (force + stiffness * away * DBL_EPSILON);
}

void strut_balance_fill(const strut_model *model, const strut_state *state,
                        const strut_energies *begin, double t, strut_energy *e) {
  const double *w = state->work;
  strut_energies end = strut_energy_evaluate(model, state, t);
  double loads = strut_energy_load_work(model, state);
  e->kinetic = end.kinetic, e->elastic = end.elastic, e->gravity = end.gravity;
  e->contact = end.contact;
  e->drive_work = w[STRUT_POWER_DRIVE];
  e->load_work = w[STRUT_POWER_LOAD] + loads;
  e->belt_work = w[STRUT_POWER_BELT];
  e->support_work = strut_support_motion_work(model, state);
  e->dissipated_members = w[STRUT_POWER_MEMBERS];
  e->dissipated_contact = w[STRUT_POWER_CONTACT];
  e->dissipated_friction = w[STRUT_POWER_FRICTION];
  e->initial = begin->kinetic + begin->elastic + begin->gravity + begin->contact;
  e->residual = end.kinetic + end.elastic + end.gravity + end.contact - e->initial - e->drive_work -
                e->load_work - e->belt_work - e->support_work + e->dissipated_members +
                e->dissipated_contact + e->dissipated_friction;
  e->placed = energy_of_places(model, state, &end);
  e->moved = absolute_change(end.kinetic, begin->kinetic) +
             absolute_change(end.elastic, begin->elastic) +
             absolute_change(end.gravity, begin->gravity) +
             absolute_change(end.contact, begin->contact) + fabs(loads) + w[STRUT_POWER_EXCHANGED];
}

void strut_balance_begin(const strut_state *state, const strut_energies *begin, double t,
                         int evaluations, strut_balance_monitor *monitor) {
  int64_t every = EVALUATIONS_PER_SAMPLE / evaluations;
  *monitor =
      (strut_balance_monitor){.every = every > 0 ? every : 1, .swing = begin->kinetic, .time = t};
  monitor->next = state->balance ? state->step + monitor->every : INT64_MAX;
}

static double lost_in(const strut_energy *e, strut_loss loss) {
  return loss == STRUT_LOSS_MEMBERS   ? e->dissipated_members
         : loss == STRUT_LOSS_CONTACT ? e->dissipated_contact
                                      : e->dissipated_friction;
}

/* Slower than this part of a band nothing creeps. */
static const double AT_REST = 1e-3;

static double creep_within(double band, double slip) {
  return fabs(slip) < band && fabs(slip) > AT_REST * band ? fabs(slip) : 0.0;
}

/*
 * Within its band Karnopp's friction balances the other forces whatever the speed, so that it may give energy, at
 * most with the speed at the edge. Normal forces between samples are taken to be a few times those at them.
 * Notes how fast the feet creep there, and the structure moves.
 */
static double creeping_power(const strut_model *model, const strut_state *state,
                             strut_balance_monitor *monitor) {
  const strut_contact_table *c = &model->contacts;
  const double *g = model->scene->gravity;
  double weight = 0.0, power = 0.0, crept = 0.0, speed = 0.0;
  int32_t feet = 0;
  for (int32_t i = 0; i < model->node_count; i++) {
    weight += model->weight[i] * hypot(g[0], g[1]);
    speed += hypot(state->v[2 * i], state->v[2 * i + 1]) / model->node_count;
  }
  for (int32_t i = 0; i < c->count; i++) {
    const strut_contact_entry *e = &c->entry[i];
    double gap, slip, band = e->friction.stick_velocity;
    if (!strut_friction_has_band(e->friction.law)) continue;
    strut_contact_observe(c, i, state, &gap, &slip);
    power += band * strut_friction_largest(&e->friction) *
             (4.0 * fmax(0.0, -gap * e->stiffness) + weight);
    if (!(gap < 0.0)) continue;
    feet++;
    crept += creep_within(band, slip);
  }
  for (int32_t i = 0; i < model->rubbing.count;
       i++) { /* feet have no stick: within the band they creep */
    const strut_rubbing_entry *f = &model->rubbing.item[i];
    double normal, slip = strut_rubbing_slip(model, state, i, &normal);
    if (f->contact < 0 || f->bend >= 0 || !(normal > 0.0)) continue;
    const strut_friction *friction = &model->scene->contacts[f->contact].friction;
    if (!strut_friction_has_band(friction->law)) continue;
    feet++;
    crept += creep_within(friction->stick_velocity, slip);
  }
  if (feet) monitor->crept += crept / feet, monitor->speed += speed;
  return power;
}

/*
 * May what members lose be below 0? Where a law pushes that carries tension only, or breaks with less than no
 * energy.
 */
static bool members_may_give(const strut_model *model) {
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *e = &model->elements.element[i];
    if (strut_law_at(e->law)->own && (e->carries || e->remembers)) return true;
  }
  return false;
}

/* Notes the first loss that has given energy since the latest sample, or since the start. */
static void watch_losses(const strut_model *model, const strut_energy *e, int64_t steps,
                         double creep, strut_balance_monitor *monitor) {
  double allowed = GIVEN * e->moved + rounding_of(e, steps);
  monitor->creep += creep;
  for (int k = 0; k < STRUT_LOSS_COUNT; k++) {
    bool rubs = k == STRUT_LOSS_FRICTION;
    double now = lost_in(e, (strut_loss)k), since = monitor->lost[k] - now;
    double over = fmax(since - (rubs ? creep : 0.0), -now - (rubs ? monitor->creep : 0.0));
    monitor->lost[k] = now;
    if (rubs && !model->rubbing.bristles && -now > fmax(allowed, monitor->rubbed))
      monitor->rubbed = -now;
    if (!(over > allowed) || monitor->given > 0.0) continue;
    if (k == STRUT_LOSS_MEMBERS && members_may_give(model)) continue;
    if (rubs && model->rubbing.bristles) continue; /* they spring back */
    monitor->giver = (strut_loss)k, monitor->given = fmax(since, -now);
  }
}

void strut_balance_sample(const strut_model *model, const strut_state *state,
                          const strut_energies *begin, double t, strut_balance_monitor *monitor,
                          strut_energy *e) {
  strut_balance_fill(model, state, begin, t, e);
  monitor->swing = fmax(monitor->swing, e->kinetic);
  e->moved = fmax(e->moved, monitor->swing); /* an oscillation may end as it began */
  double change = e->residual - monitor->residual;
  if (fabs(change) > fabs(monitor->worst)) {
    monitor->worst = change;
    monitor->from = monitor->time, monitor->to = t;
  }
  double creep = creeping_power(model, state, monitor) * (t - monitor->time);
  watch_losses(model, e, state->step, creep, monitor);
  e->rubbed = monitor->rubbed;
  monitor->residual = e->residual, monitor->time = t;
  while (monitor->next <= state->step) monitor->next += monitor->every;
}

void strut_balance_continue(const strut_energy *before, strut_state *state, strut_energies *begin) {
  double *w = state->work;
  w[STRUT_POWER_DRIVE] = before->drive_work;
  w[STRUT_POWER_LOAD] = before->load_work;
  w[STRUT_POWER_BELT] = before->belt_work;
  w[STRUT_POWER_MEMBERS] = before->dissipated_members;
  w[STRUT_POWER_CONTACT] = before->dissipated_contact;
  w[STRUT_POWER_FRICTION] = before->dissipated_friction;
  w[STRUT_POWER_EXCHANGED] = before->moved;
  state->support_work_origin -= before->support_work;
  double end = before->kinetic + before->elastic + before->gravity + before->contact;
  begin->elastic += before->initial - end;
}

void strut_balance_warn(strut_summary *s, const char *why) {
  const char *code = "energy_balance";
  double residual = s->energy.residual;
  strut_summary_withdraw(s, code);
  if (s->balance != STRUT_BALANCE_OPEN || s->status != STRUT_OK) return;
  strut_summary_warn(
      s, code, "the energy balance does not close: %.3g J, %.2g %% of the exchanged energy, %s%s",
      fabs(residual), 100.0 * fabs(residual) / s->energy.moved,
      residual > 0.0 ? "appeared without a source" : "disappeared without a sink", why);
}

strut_balance strut_balance_judge(const strut_energy *e, int64_t steps) {
  double most = fmax(OPEN * e->moved, rounding_of(e, steps));
  return fabs(e->residual) <= most ? STRUT_BALANCE_CLOSED : STRUT_BALANCE_OPEN; /* open where NaN */
}

/* ---- velocities and contacts ---- */

/* A mark this close to the end of a step, in steps, counts as being there. */
static const double MARK_TOLERANCE = 1e-6;

/* A mean velocity below this part of what cancels in it, among nodes or over time, is rounding. */
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
  if (model->terms & STRUT_TERM_SLIDING_MASS) {
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

/* The largest velocity of a node beside that of the tracked point along x, v. */
static double largest_difference(const strut_model *model, const strut_state *state, double v) {
  double most = 0.0;
  for (int32_t i = 0; i < model->node_count; i++)
    most = fmax(most, hypot(state->v[2 * i] - v, state->v[2 * i + 1]));
  return most;
}

void strut_measure_begin(const strut_model *model, strut_state *state, strut_measurement *m) {
  const strut_marks marks = {
      .step = m->grid.step, .offset = m->grid.offset, .count = m->marks, .time = m->time};
  if (m->quantities) strut_quantities_begin(m->quantities, &marks, state);
  strut_measure_tracked_point(model, state, m, &m->last_x, &m->last_v);
  m->apart = largest_difference(model, state, m->last_v);
  m->path = 0.0;
  m->last_work = state->work[STRUT_POWER_DRIVE];
  m->balance = state->balance;
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
  const strut_ground_motion *motion = state->latest->ground_motion;
  int32_t near =
      strut_contacts_near(c, first, first + pieces, state->q, motion, 0.0, state->buffers->near);
  for (int32_t k = 0; k < near; k++)
    if (strut_contact_gap_at(c, state->buffers->near[k], state->q, motion) < 0.0)
      m->contact_steps[state->buffers->near[k]]++;
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
    double gap = strut_contact_gap_at(c, i, state->q, state->latest->ground_motion), high = gap;
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
  m->apart = fmax(m->apart, largest_difference(model, state, v));
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
  m->path += fabs(x - m->last_x);
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

bool strut_measure_is_zero(const strut_measurement *m, const strut_summary *s) {
  return fabs(s->velocity) <= SYMMETRY_ROUNDING * (m->apart + m->path / s->window.time);
}

void strut_measure_finish(const strut_measurement *m, strut_summary *summary) {
  size_t passed = m->next;
  if (m->quantities) strut_quantities_finish(m->quantities, summary);
  summary->velocity = summary->velocity_spread = (double)NAN;
  summary->window.start = m->time[0] + m->grid.offset;
  summary->window.time = summary->window.work = (double)NAN;
  summary->weight = m->weight;
  if (passed >= 2) {
    summary->window.time = m->time[passed - 1] - m->time[0];
    if (m->balance) summary->window.work = m->work[passed - 1] - m->work[0];
    summary->velocity = (m->x[passed - 1] - m->x[0]) / (m->time[passed - 1] - m->time[0]);
    double sum = 0.0, count = (double)(passed - 1);
    for (size_t i = 1; i < passed; i++) {
      double d = (m->x[i] - m->x[i - 1]) / (m->time[i] - m->time[i - 1]) - summary->velocity;
      sum += d * d;
    }
    if (m->by_periods && passed > 2) summary->velocity_spread = sqrt(sum / (count - 1.0));
  }
  for (size_t i = 0; i < summary->end.contact_count; i++) {
    strut_contact_summary *c = &summary->end.contacts[i];
    bool any = m->window_steps > 0;
    c->duty = any ? (double)m->contact_steps[i] / (double)m->window_steps : (double)NAN;
    c->max_height = any && isfinite(m->max_height[i]) ? m->max_height[i] : (double)NAN;
  }
}

void strut_measure_free(strut_measurement *measure) { strut_arena_free(&measure->arena); }
