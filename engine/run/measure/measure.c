/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/measure.h"

#include <assert.h>
#include <float.h>
#include <math.h>

#include "engine/base/interpolation.h"
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/surfaces.h"
#include "engine/model/pose.h"

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
static double rounding_of(const strut_energy *energy, int64_t steps) {
  double stored = fabs(energy->initial) + energy->kinetic + energy->elastic +
                  fabs(energy->gravity) + energy->contact;
  return ROUNDING * ((double)steps + 100.0) * (stored + energy->moved + energy->placed);
}

/*
 * Energy whose rounding is that of positions: a force that acts over the way to the origin, as positions are stored
 * from there, however small the motion. The forces are those of gravity, and of springs that store such an energy.
 */
static double energy_of_places(const strut_model *model, const strut_state *state,
                               const strut_energies *now) {
  const strut_contact_table *contacts = &model->contacts;
  const double *g = model->scene->gravity;
  double away = 0.0, weight = 0.0, stiffness = 0.0;
  for (int32_t i = 0; i < model->node_count; i++) {
    away = fmax(away, fmax(fabs(state->q[2 * i]), fabs(state->q[2 * i + 1])));
    weight += model->weight[i] * hypot(g[0], g[1]);
  }
  for (int32_t j = 0; j < model->members.count; j++) stiffness += model->members.stiffness[j];
  for (int32_t i = 0; i < model->elements.count; i++)
    stiffness += model->elements.element[i].numbers.stiffness;
  for (int32_t i = 0; i < contacts->count; i++) stiffness += contacts->entry[i].stiffness;
  double force = weight + sqrt(2.0 * stiffness * (fabs(now->elastic) + now->contact));
  return away * (force + stiffness * away * DBL_EPSILON);
}

void strut_balance_fill(const strut_model *model, const strut_state *state,
                        const strut_energies *begin, double t, strut_energy *energy) {
  const double *w = state->work;
  strut_energies end = strut_energy_evaluate(model, state, t);
  double loads = strut_energy_load_work(model, state);
  energy->kinetic = end.kinetic, energy->elastic = end.elastic, energy->gravity = end.gravity;
  energy->contact = end.contact;
  energy->drive_work = w[STRUT_POWER_DRIVE];
  energy->load_work = w[STRUT_POWER_LOAD] + loads;
  energy->belt_work = w[STRUT_POWER_BELT];
  energy->support_work = strut_support_motion_work(model, state);
  energy->dissipated_members = w[STRUT_POWER_MEMBERS];
  energy->dissipated_contact = w[STRUT_POWER_CONTACT];
  energy->dissipated_friction = w[STRUT_POWER_FRICTION];
  energy->initial = begin->kinetic + begin->elastic + begin->gravity + begin->contact;
  energy->residual = end.kinetic + end.elastic + end.gravity + end.contact - energy->initial -
                     energy->drive_work - energy->load_work - energy->belt_work -
                     energy->support_work + energy->dissipated_members +
                     energy->dissipated_contact + energy->dissipated_friction;
  energy->placed = energy_of_places(model, state, &end);
  energy->moved =
      absolute_change(end.kinetic, begin->kinetic) + absolute_change(end.elastic, begin->elastic) +
      absolute_change(end.gravity, begin->gravity) + absolute_change(end.contact, begin->contact) +
      fabs(loads) + w[STRUT_POWER_EXCHANGED];
}

void strut_balance_begin(const strut_state *state, const strut_energies *begin, double t,
                         int evaluations, strut_balance_monitor *monitor) {
  int64_t every = EVALUATIONS_PER_SAMPLE / evaluations;
  *monitor =
      (strut_balance_monitor){.every = every > 0 ? every : 1, .swing = begin->kinetic, .time = t};
  monitor->next = state->balance ? state->step + monitor->every : INT64_MAX;
}

static double lost_in(const strut_energy *energy, strut_loss loss) {
  return loss == STRUT_LOSS_MEMBERS   ? energy->dissipated_members
         : loss == STRUT_LOSS_CONTACT ? energy->dissipated_contact
                                      : energy->dissipated_friction;
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
  const strut_contact_table *contacts = &model->contacts;
  const double *g = model->scene->gravity;
  double weight = 0.0, power = 0.0, crept = 0.0, speed = 0.0;
  int32_t feet = 0;
  for (int32_t i = 0; i < model->node_count; i++) {
    weight += model->weight[i] * hypot(g[0], g[1]);
    speed += hypot(state->v[2 * i], state->v[2 * i + 1]) / model->node_count;
  }
  for (int32_t i = 0; i < contacts->count; i++) {
    const strut_contact_entry *contact = &contacts->entry[i];
    double gap, slip, band = contact->friction.stick_velocity;
    if (!strut_friction_has_band(contact->friction.law)) continue;
    strut_contact_observe(contacts, i, state, &gap, &slip);
    power += band * strut_friction_largest(&contact->friction) *
             (4.0 * fmax(0.0, -gap * contact->stiffness) + weight);
    if (!(gap < 0.0)) continue;
    feet++;
    crept += creep_within(band, slip);
  }
  for (int32_t i = 0; i < model->rubbing.count;
       i++) { /* feet have no stick: within the band they creep */
    const strut_rubbing_entry *entry = &model->rubbing.item[i];
    double normal, slip = strut_rubbing_slip(model, state, i, &normal);
    if (entry->contact < 0 || entry->bend >= 0 || !(normal > 0.0)) continue;
    const strut_friction *friction = &model->scene->contacts[entry->contact].friction;
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
    const strut_element *element = &model->elements.element[i];
    if (strut_law_at(element->law)->own && (element->carries || element->remembers)) return true;
  }
  return false;
}

/* Notes the first loss that has given energy since the latest sample, or since the start. */
static void watch_losses(const strut_model *model, const strut_energy *energy, int64_t steps,
                         double creep, strut_balance_monitor *monitor) {
  double allowed = GIVEN * energy->moved + rounding_of(energy, steps);
  monitor->creep += creep;
  for (int k = 0; k < STRUT_LOSS_COUNT; k++) {
    bool rubs = k == STRUT_LOSS_FRICTION;
    double now = lost_in(energy, (strut_loss)k), since = monitor->lost[k] - now;
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
                          strut_energy *energy) {
  strut_balance_fill(model, state, begin, t, energy);
  monitor->swing = fmax(monitor->swing, energy->kinetic);
  energy->moved = fmax(energy->moved, monitor->swing); /* an oscillation may end as it began */
  double change = energy->residual - monitor->residual;
  if (fabs(change) > fabs(monitor->worst)) {
    monitor->worst = change;
    monitor->from = monitor->time, monitor->to = t;
  }
  double creep = creeping_power(model, state, monitor) * (t - monitor->time);
  watch_losses(model, energy, state->step, creep, monitor);
  energy->rubbed = monitor->rubbed;
  monitor->residual = energy->residual, monitor->time = t;
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

void strut_balance_warn(strut_summary *summary, const char *why) {
  const char *code = "energy_balance";
  double residual = summary->energy.residual;
  strut_summary_withdraw(summary, code);
  if (summary->balance != STRUT_BALANCE_OPEN || summary->status != STRUT_OK) return;
  strut_summary_warn(
      summary, code,
      "the energy balance does not close: %.3g J, %.2g %% of the exchanged energy, %s%s",
      fabs(residual), 100.0 * fabs(residual) / summary->energy.moved,
      residual > 0.0 ? "appeared without a source" : "disappeared without a sink", why);
}

strut_balance strut_balance_judge(const strut_energy *energy, int64_t steps) {
  double most = fmax(OPEN * energy->moved, rounding_of(energy, steps));
  return fabs(energy->residual) <= most ? STRUT_BALANCE_CLOSED
                                        : STRUT_BALANCE_OPEN; /* open where NaN */
}

/* ---- velocities and contacts ---- */

/* A mark this close to the end of a step, in steps, counts as being there. */
static const double MARK_TOLERANCE = 1e-6;

/* A mean velocity below this part of what cancels in it, among nodes or over time, is rounding. */
static const double SYMMETRY_ROUNDING = 1e-10;

void strut_measure_tracked_point(const strut_model *model, const strut_state *state,
                                 const strut_measurement *measurement, double *place,
                                 double *velocity) {
  if (measurement->node >= 0) {
    *place = state->q[2 * measurement->node];
    *velocity = state->v[2 * measurement->node];
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
  *place = sum / measurement->total_mass;
  *velocity = rate / measurement->total_mass;
}

static void place_marks(const strut_span *span, double begin, strut_measurement *measurement) {
  const strut_run_samples *samples = measurement->samples;
  for (size_t i = 0; samples && i < samples->count; i++)
    measurement->time[i] = begin + samples->time[i];
  if (samples) return;
  for (size_t i = 0; i < measurement->marks; i++)
    measurement->time[i] = begin + (span->period > 0 ? span->window_start + (double)i * span->period
                                                     : (i ? span->duration : span->window_start));
  measurement->time[measurement->marks - 1] = begin + span->duration;
}

void strut_measure_window(const strut_model *model, strut_state *state, double begin, double period,
                          size_t periods, strut_measurement *measurement) {
  size_t contacts = (size_t)model->contacts.count;
  assert(periods >= 1);
  measurement->marks = periods + 1 < measurement->capacity ? periods + 1 : measurement->capacity;
  for (size_t i = 0; i < measurement->marks; i++) measurement->time[i] = begin + (double)i * period;
  measurement->next = 0;
  measurement->window_steps = 0;
  for (size_t i = 0; i < contacts; i++)
    measurement->contact_steps[i] = 0, measurement->max_height[i] = -HUGE_VAL;
  strut_measure_begin(model, state, measurement);
}

strut_status strut_measure_create(const strut_model *model, const strut_experiment *experiment,
                                  double begin, size_t capacity, strut_measurement *measurement) {
  *measurement = (strut_measurement){
      .grid = measurement->grid, .samples = measurement->samples, .node = experiment->measure_node};
  strut_span span = strut_experiment_span(experiment, model->scene);
  measurement->by_periods = span.period > 0;
  double periods = span.period > 0 ? (span.duration - span.window_start) / span.period : 1.0;
  size_t contacts = (size_t)model->contacts.count;
  measurement->marks = measurement->samples ? measurement->samples->count
                       : periods < 1.5      ? 2
                                            : (size_t)ceil(periods - 1e-9) + 1;
  measurement->capacity = capacity > measurement->marks ? capacity : measurement->marks;
  bool ready = STRUT_NUMBERS(&measurement->arena, measurement->capacity, &measurement->time,
                             &measurement->x, &measurement->work) &&
               STRUT_NUMBERS(&measurement->arena, contacts, &measurement->max_height,
                             &measurement->last_gap, &measurement->gap_before) &&
               STRUT_ALLOCATE(&measurement->arena, STRUT_NEW(measurement->contact_steps, contacts));
  bool wanted = experiment->quantity_count > 0;
  if (wanted)
    measurement->quantities = strut_quantities_create(model, experiment, &measurement->arena);
  if (!ready || (wanted && !measurement->quantities)) {
    strut_measure_free(measurement);
    return STRUT_NO_MEMORY;
  }
  place_marks(&span, begin, measurement);
  for (int32_t i = 0; i < model->node_count; i++) measurement->total_mass += model->weight[i];
  measurement->weight =
      measurement->total_mass * hypot(model->scene->gravity[0], model->scene->gravity[1]);
  for (size_t i = 0; i < contacts; i++) measurement->max_height[i] = -HUGE_VAL;
  return STRUT_OK;
}

int64_t strut_measure_first_step(const strut_measurement *measurement) {
  double n = floor(measurement->time[0] / measurement->grid.step + MARK_TOLERANCE);
  return n > 0 ? (int64_t)n : 0;
}

/* The largest velocity of a node beside that of the tracked point along x, v. */
static double largest_difference(const strut_model *model, const strut_state *state, double v) {
  double most = 0.0;
  for (int32_t i = 0; i < model->node_count; i++)
    most = fmax(most, hypot(state->v[2 * i] - v, state->v[2 * i + 1]));
  return most;
}

void strut_measure_begin(const strut_model *model, strut_state *state,
                         strut_measurement *measurement) {
  const strut_marks marks = {.step = measurement->grid.step,
                             .offset = measurement->grid.offset,
                             .count = measurement->marks,
                             .time = measurement->time,
                             .value = measurement->samples ? measurement->samples->value : NULL};
  if (measurement->quantities) strut_quantities_begin(measurement->quantities, &marks, state);
  strut_measure_tracked_point(model, state, measurement, &measurement->last_x,
                              &measurement->last_v);
  measurement->apart = largest_difference(model, state, measurement->last_v);
  measurement->path = 0.0;
  measurement->last_work = state->work[STRUT_POWER_DRIVE];
  measurement->balance = state->balance;
  double position = measurement->time[0] / measurement->grid.step - (double)state->step;
  if (fabs(position) < MARK_TOLERANCE) {
    measurement->x[0] = measurement->last_x;
    measurement->work[0] = measurement->last_work;
    measurement->next = 1;
  }
}

/* Of the many pieces of a long profile: which touch, and the height over the lowest. */
static void count_pieces(const strut_contact_table *contacts, const strut_state *state,
                         int32_t first, int32_t pieces, strut_measurement *measurement) {
  const strut_ground_motion *motion = state->latest->ground_motion;
  int32_t near = strut_contacts_near(contacts, first, first + pieces, state->q, motion, 0.0,
                                     state->buffers->near);
  for (int32_t k = 0; k < near; k++)
    if (strut_contact_gap_at(contacts, state->buffers->near[k], state->q, motion) < 0.0)
      measurement->contact_steps[state->buffers->near[k]]++;
  double gap;
  int32_t lowest = strut_contacts_lowest(contacts, first, state->q, motion, &gap);
  if (gap > measurement->max_height[lowest]) measurement->max_height[lowest] = gap;
}

static void count_contacts(const strut_model *model, const strut_state *state,
                           strut_measurement *measurement) {
  const strut_contact_table *contacts = &model->contacts;
  bool equal = measurement->window_steps >= 2 && state->step != measurement->grid.last;
  measurement->window_steps++;
  for (int32_t i = 0; i < contacts->count; i++) {
    int32_t pieces = contacts->surface ? strut_contacts_of_profile(contacts, i) : 0;
    if (pieces) {
      count_pieces(contacts, state, i, pieces, measurement);
      i += pieces - 1;
      continue;
    }
    double gap = strut_contact_gap_at(contacts, i, state->q, state->latest->ground_motion),
           high = gap;
    double last = measurement->last_gap[i], before = measurement->gap_before[i];
    if (gap < 0.0) measurement->contact_steps[i]++;
    if (equal && last > gap && last > before) /* the vertex between these steps */
      high = last + (gap - before) * (gap - before) / (8.0 * (2.0 * last - gap - before));
    if (high > measurement->max_height[i]) measurement->max_height[i] = high;
    measurement->gap_before[i] = last, measurement->last_gap[i] = gap;
  }
}

/* Is the next mark within the latest step, which ended as step n? */
static bool mark_reached(const strut_measurement *measurement, double n) {
  return measurement->next < measurement->marks &&
         measurement->time[measurement->next] / measurement->grid.step <= n + MARK_TOLERANCE;
}

/* Length of the step that ended as step n: the last one of a run may be shorter. */
static double step_length(const strut_measurement *measurement, int64_t n) {
  double rest = n == measurement->grid.last ? strut_time_grid_rest(&measurement->grid) : 0.0;
  return rest > 0.0 ? rest : measurement->grid.step;
}

/* Kept out of strut_measure_step, most calls of which pass no mark. */
static __attribute__((noinline)) void pass_marks(const strut_model *model, const strut_state *state,
                                                 strut_measurement *measurement, double x,
                                                 double v) {
  double n = (double)state->step, step = measurement->grid.step,
         length = step_length(measurement, state->step);
  measurement->apart = fmax(measurement->apart, largest_difference(model, state, v));
  while (mark_reached(measurement, n)) {
    double s = (measurement->time[measurement->next] / step - (n - 1.0)) * (step / length);
    bool end = s > 1.0 - MARK_TOLERANCE;
    double work = state->work[STRUT_POWER_DRIVE];
    measurement->work[measurement->next] =
        end ? work : measurement->last_work + s * (work - measurement->last_work);
    measurement->x[measurement->next++] =
        end ? x : strut_hermite(measurement->last_x, measurement->last_v, x, v, length, s);
  }
}

void strut_measure_step(const strut_model *model, strut_state *state,
                        strut_measurement *measurement) {
  double x, v;
  strut_measure_tracked_point(model, state, measurement, &x, &v);
  count_contacts(model, state, measurement);
  if (mark_reached(measurement, (double)state->step)) pass_marks(model, state, measurement, x, v);
  measurement->path += fabs(x - measurement->last_x);
  measurement->last_x = x;
  measurement->last_v = v;
  measurement->last_work = state->work[STRUT_POWER_DRIVE];
  if (measurement->quantities)
    strut_quantities_step(measurement->quantities, step_length(measurement, state->step), state);
}

bool strut_measure_is_zero(const strut_measurement *measurement, const strut_summary *summary) {
  return fabs(summary->velocity) <=
         SYMMETRY_ROUNDING * (measurement->apart + measurement->path / summary->window.time);
}

void strut_measure_finish(const strut_measurement *measurement, strut_summary *summary) {
  size_t passed = measurement->next;
  if (measurement->quantities) strut_quantities_finish(measurement->quantities, summary);
  summary->velocity = summary->velocity_spread = (double)NAN;
  summary->window.start = measurement->time[0] + measurement->grid.offset;
  summary->window.time = summary->window.work = (double)NAN;
  summary->weight = measurement->weight;
  if (passed >= 2) {
    summary->window.time = measurement->time[passed - 1] - measurement->time[0];
    if (measurement->balance)
      summary->window.work = measurement->work[passed - 1] - measurement->work[0];
    summary->velocity = (measurement->x[passed - 1] - measurement->x[0]) /
                        (measurement->time[passed - 1] - measurement->time[0]);
    double sum = 0.0, count = (double)(passed - 1);
    for (size_t i = 1; i < passed; i++) {
      double d = (measurement->x[i] - measurement->x[i - 1]) /
                     (measurement->time[i] - measurement->time[i - 1]) -
                 summary->velocity;
      sum += d * d;
    }
    if (measurement->by_periods && passed > 2) summary->velocity_spread = sqrt(sum / (count - 1.0));
  }
  for (size_t i = 0; i < summary->end.contact_count; i++) {
    strut_contact_summary *contact_summary = &summary->end.contacts[i];
    bool any = measurement->window_steps > 0;
    contact_summary->duty =
        any ? (double)measurement->contact_steps[i] / (double)measurement->window_steps
            : (double)NAN;
    contact_summary->max_height =
        any && isfinite(measurement->max_height[i]) ? measurement->max_height[i] : (double)NAN;
  }
}

void strut_measure_free(strut_measurement *measure) { strut_arena_free(&measure->arena); }
