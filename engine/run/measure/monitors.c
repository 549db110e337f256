/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/monitors.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/forces/drives/feedback.h"
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/surfaces.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/model/mass.h"
#include "engine/model/pose.h"
#include "engine/model/surface_search.h"

/* ---- step limit ---- */

/* Force evaluations between two samples, power iterations per sample and at the start. */
enum { EVALUATIONS_PER_SAMPLE = 256, ITERATIONS = 1, FIRST_ITERATIONS = 30 };
/* Logarithm of the growth at which an unstable motion has replaced the true one. */
static const double LOST_MOTION = 16.0;

/* image = (h^2 stiff K + h damp D) motion, on free coordinates. */
typedef struct product {
  const strut_model *model;
  const double *q, *motion;
  double *image, stiff, damp; /* factors of K and D */
} product;

static void apply_member(const product *p, const strut_force *member) {
  const double *unit = member->pose.b + 2;
  uint32_t from = member->at[0], to = member->at[1];
  const double motion[2] = {p->motion[to] - p->motion[from],
                            p->motion[to + 1] - p->motion[from + 1]};
  if (!(member->pose.strain > 0.0)) return;
  double along = unit[0] * motion[0] + unit[1] * motion[1], across = p->stiff * member->across;
  double pull = (p->stiff * member->pose.slope - across + p->damp * member->damping) * along;
  for (uint32_t k = 0; k < 2; k++) {
    double force = across * motion[k] + pull * unit[k];
    p->image[from + k] -= force;
    p->image[to + k] += force;
  }
}

/* An element or a contact. */
static void apply_element(const product *p, const strut_force *force) {
  double bend[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT], along = 0.0, across = 0.0;
  int32_t n = 2 * force->nodes;
  bool bends = force->kind == STRUT_FORCE_ELEMENT;
  for (int32_t k = 0; k < n; k += 2) {
    const double *motion = p->motion + force->at[k / 2];
    along += force->pose.b[k] * motion[0] + force->pose.b[k + 1] * motion[1];
  }
  memset(bend, 0, (size_t)(n * n) * sizeof *bend);
  if (bends) strut_force_bend(p->model, force, p->q, p->stiff, bend);
  for (int32_t r = 0; r < n; r++) {
    double push =
        (p->stiff * force->pose.slope + p->damp * force->damping) * along * force->pose.b[r];
    for (int32_t c = 0; c < n && bends; c++)
      push += bend[r * n + c] * p->motion[strut_force_coordinate(force, c)];
    p->image[strut_force_coordinate(force, r)] += push;
  }
  if (force->across == 0.0) return;
  for (int32_t k = 0; k < n; k++)
    across += p->motion[strut_force_coordinate(force, k)] * force->side[k];
  for (int32_t k = 0; k < n; k++)
    p->image[strut_force_coordinate(force, k)] +=
        p->stiff * force->across * across * force->side[k];
}

static void apply_forces(const product *p, const double *rest, strut_closed closed) {
  strut_force_visit visit = {
      .model = p->model, .q = p->q, .rest = rest, .least = -HUGE_VAL, .closed = closed};
  for (const strut_force *force; (force = strut_force_next(&visit));)
    if (force->kind == STRUT_FORCE_MEMBER)
      apply_member(p, force);
    else
      apply_element(p, force);
}

/* Adds noise to a motion, so that no eigenvector is missed for ever. */
static void perturb_motion(const strut_model *model, strut_step_limit_monitor *g,
                           strut_monitored_set *w, double size) {
  for (int32_t i = 0; i < 2 * model->node_count; i++) {
    g->noise = g->noise * 6364136223846793005u + 1442695040888963407u;
    if (!model->fixed[i]) w->motion[i] += size * ((double)(g->noise >> 11) * 0x1p-53 - 0.5);
  }
}

/*
 * One step of the power iteration: the Rayleigh quotient of the motion, which lies below the
 * eigenvalue. The motion is the inverse mass times the last image, so that its norm in the mass is
 * known.
 */
static void iterate_power(const strut_model *model, const strut_state *state,
                          strut_step_limit_monitor *g, strut_monitored_set *w) {
  int32_t n = 2 * model->node_count;
  double work = 0.0, square = 0.0, largest = 0.0, weight = w->weight;
  memset(g->image, 0, (size_t)model->length * sizeof *g->image);
  product p = {
      model, state->q, w->motion, g->image, g->step * g->step * w->stiff, g->step * w->damp};
  /* implicit ground dampers: steps are refined while the ground is touched */
  strut_closed closed = g->method->implicit_damper ? STRUT_CLOSED_NONE : STRUT_CLOSED_TOUCHING;
  apply_forces(&p, state->latest->rest, closed);
  for (int32_t i = 0; i < n; i++)
    if (model->fixed[i]) g->image[i] = 0.0;
  strut_mass_solve(model, g->image, g->divided, g->scratch);
  for (int32_t i = 0; i < n; i++) {
    work += w->motion[i] * g->image[i];
    square += g->divided[i] * g->image[i];
    largest = fmax(largest, fabs(g->divided[i]));
  }
  if (!(largest > 0.0 && largest < HUGE_VAL)) {
    perturb_motion(model, g, w, 1.0);
    w->weight = w->strength = 0.0;
    return;
  }
  for (int32_t i = 0; i < n; i++) w->motion[i] = g->divided[i] / largest;
  w->weight = square / largest / largest;
  w->strength = weight > 0.0 ? work / weight : 0.0;
}

/*
 * Step limit of a shape; HUGE_VAL where memory is out. Where only a bound is available and the
 * iterated motions are of this shape, at least the limit that they show: a bound alone must not
 * stop a run.
 */
static double find_limit(const strut_model *model, const strut_step_limit_monitor *g,
                         const double *q, const double *rest, bool of_this_shape) {
  strut_closed closed = g->method->implicit_damper ? STRUT_CLOSED_NONE : STRUT_CLOSED_TOUCHING;
  strut_step_limit limit;
  if (strut_step_limit_at_shape(model, q, rest, closed, &limit, NULL)) return HUGE_VAL;
  double bound = limit.of[g->method->region], seen = HUGE_VAL;
  if (!limit.bound || !of_this_shape) return bound;
  for (int i = 0; i < g->count; i++) seen = fmin(seen, g->step / g->set[i].strength);
  return fmax(bound, seen);
}

static void update_limit(const strut_model *model, const strut_state *state,
                         strut_step_limit_monitor *g) {
  g->known_limit = find_limit(model, g, state->q, state->latest->rest, true);
  for (int i = 0; i < g->count; i++) {
    strut_monitored_set *w = &g->set[i];
    w->known = w->strength;
    /*
     * the limit falls at most with 1/strength: recompute when strength could bring it to the step
     */
    w->alarm = fmax(1.0, w->strength * fmax(1.01, 0.99 * g->known_limit / g->step));
  }
}

/* Records that the step is above the limit, for the last `steps` steps. */
static void record_violation(strut_step_limit_monitor *g, double time, int64_t steps) {
  double limit = g->known_limit;
  double growth = strut_region_at(g->method->region)->growth;
  if (!(g->lowest > 0.0)) g->first_time = time;
  if (!(g->lowest > 0.0) || limit < g->lowest) g->lowest = limit, g->lowest_time = time;
  g->grown = g->below ? g->grown + growth * fmin(g->step / limit - 1.0, 1.0) * (double)steps : 0.0;
  g->steps_below += steps;
  g->below = true;
  g->motion_lost = g->motion_lost || g->grown > LOST_MOTION;
}

void strut_step_limit_monitor_sample(const strut_model *model, const strut_state *state,
                                     strut_step_limit_monitor *g) {
  int64_t steps = state->step - g->last;
  bool again = false;
  g->last = state->step;
  g->next = state->step + g->every;
  for (int i = 0; i < g->count; i++) {
    strut_monitored_set *w = &g->set[i];
    perturb_motion(model, g, w, 1e-6);
    for (int k = 0; k < ITERATIONS; k++) iterate_power(model, state, g, w);
    again = again || w->strength >= w->alarm || (g->below && w->strength < 0.99 * w->known);
  }
  if (g->count > 0) {
    memcpy(g->shape, state->q, (size_t)model->length * sizeof *g->shape);
    memcpy(g->rest, state->latest->rest, (size_t)model->members.slots * sizeof *g->rest);
  }
  if (again) update_limit(model, state, g);
  if (g->known_limit < g->step)
    record_violation(g, (double)state->step * g->step, steps);
  else
    g->below = false;
}

double strut_step_limit_monitor_last_limit(const strut_model *model,
                                           const strut_step_limit_monitor *g) {
  return g->count > 0 ? find_limit(model, g, g->shape, g->rest, false) : HUGE_VAL;
}

void strut_step_limit_monitor_check(const strut_model *model, const strut_state *state,
                                    strut_step_limit_monitor *g) {
  if (g->count == 0) return;
  double before = strut_step_limit_monitor_last_limit(model, g);
  g->known_limit = fmin(before, find_limit(model, g, state->q, state->latest->rest, false));
  if (g->known_limit < g->step) record_violation(g, (double)g->last * g->step, 0);
}

bool strut_step_limit_monitor_create(const strut_model *model, strut_state *state,
                                     const strut_integrator *method, double step,
                                     strut_step_limit_monitor *monitor) {
  const strut_region_data *region = strut_region_at(method->region);
  *monitor =
      (strut_step_limit_monitor){.method = method, .step = step, .next = INT64_MAX, .noise = 1};
  assert(region->sets <= (int)(sizeof monitor->set / sizeof monitor->set[0]));
  if (region->sets == 0 || (model->terms & STRUT_TERM_RIGID)) return true;
  monitor->known_limit = HUGE_VAL;
  monitor->count = region->sets;
  for (int i = 0; i < region->sets; i++)
    monitor->set[i].stiff = region->set[i].stiff, monitor->set[i].damp = region->set[i].damp;
  double **const all[] = {&monitor->set[0].motion, &monitor->set[1].motion, &monitor->image,
                          &monitor->divided, &monitor->scratch};
  monitor->shape = strut_arena_allocate(&state->arena, (size_t)model->length, sizeof(double));
  monitor->rest = strut_arena_allocate(&state->arena, (size_t)model->members.slots, sizeof(double));
  if (!monitor->shape || !monitor->rest) return false;
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
    if (!(*all[i] = strut_arena_allocate(&state->arena, (size_t)model->length, sizeof(double))))
      return false;
  monitor->every = EVALUATIONS_PER_SAMPLE / method->evaluations;
  monitor->last = monitor->next = state->step;
  for (int i = 0; i < monitor->count; i++) {
    monitor->set[i].alarm = 1.0;
    perturb_motion(model, monitor, &monitor->set[i], 1.0);
    for (int k = 0; k < FIRST_ITERATIONS; k++)
      iterate_power(model, state, monitor, &monitor->set[i]);
  }
  return true;
}

strut_status strut_step_limit_monitor_fail(const strut_step_limit_monitor *g,
                                           const strut_state *state, double start_limit,
                                           strut_error *error) {
  const char *name = g->method->name;
  if (g->lowest > 0.0)
    return strut_fail(
        error, STRUT_DIVERGED,
        "the structure has become stiffer: at t = %.9g s the largest stable step of %s, %.4g s at "
        "the start, fell below the step %g s, then to %.4g s, and the motion since then is "
        "numerical; use solver.step <= %.2g s, or --force to continue anyway",
        g->first_time, name, start_limit, g->step, g->lowest, 0.9 * g->lowest);
  return strut_fail(
      error, STRUT_DIVERGED,
      "by t = %.9g s most of the energy has appeared without a source: the structure became "
      "stiffer than at the start, where the largest stable step of %s is %.4g s, and too stiff for "
      "the step %g s; use solver.step <= %.2g s, or --force to continue anyway",
      (double)state->step * g->step, name, start_limit, g->step, 0.75 * g->step);
}

/* ---- vibrations ---- */

bool strut_motion_frequency_create(const strut_model *model, strut_state *state,
                                   strut_motion_frequency *w) {
  *w = (strut_motion_frequency){0};
  w->image = strut_arena_allocate(&state->arena, (size_t)model->length, sizeof(double));
  return w->image;
}

/* v'(stiff K + damp D)v of the velocities. */
static double form_of_motion(const strut_model *model, const strut_state *state, double stiff,
                             double damp, double *image) {
  double sum = 0.0;
  product p = {model, state->q, state->v, image, stiff, damp};
  memset(image, 0, (size_t)model->length * sizeof *image);
  apply_forces(&p, state->latest->rest, STRUT_CLOSED_TOUCHING);
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    if (!model->fixed[i]) sum += image[i] * state->v[i];
  return sum;
}

void strut_motion_frequency_sample(const strut_model *model, const strut_state *state,
                                   double kinetic, strut_motion_frequency *w) {
  w->curvature += form_of_motion(model, state, 1.0, 0.0, w->image);
  w->damping += form_of_motion(model, state, 0.0, 1.0, w->image);
  w->movement += 2.0 * kinetic;
  w->samples++;
}

/* ---- stick band ---- */

/* Samples per solved acceleration; fewest of those for a mean. */
enum { ACCELERATION_INTERVAL = 4, LEAST_SAMPLES = 4 };
/*
 * Parts of |a| dt below which a band is too narrow. The band has its width on both sides of zero,
 * so that one of half of |a| dt is always met. Where static friction is no stronger than kinetic
 * friction, a node that passes over the band is turned back until it meets it and then rests; not
 * so once that takes a hundred turns. Where static friction is stronger, it only holds a node that
 * meets the band at once.
 */
static const double ALWAYS_MISSED = 0.5, MET_BY_CHANCE = 0.01;

/* Part of the static friction of a node that strain from creeping may reach before it matters. */
static const double STRAINED = 0.1;

static bool has_band(const strut_contact_entry *e) {
  return strut_friction_has_band(e->friction.law);
}

static bool is_stronger_at_rest(const strut_contact_entry *e) {
  return has_band(e) && strut_friction_drops(&e->friction);
}

/* Contact with stronger static friction at a coordinate, or -1; contacts are in ascending order. */
static int32_t contact_at(const strut_contact_table *c, uint32_t coordinate) {
  int32_t low = 0, high = c->count;
  while (low < high) {
    int32_t middle = low + (high - low) / 2;
    if (c->at[middle] < coordinate)
      low = middle + 1;
    else
      high = middle;
  }
  bool found = low < c->count && c->at[low] == coordinate;
  return found && is_stronger_at_rest(&c->entry[low]) ? low : -1;
}

/* Counts the ties; fills them if `ties` is given. */
static int32_t list_ties(const strut_model *model, strut_band_tie *ties) {
  const strut_member_table *t = &model->members;
  int32_t count = 0;
  for (int32_t j = 0; j < t->count; j++) {
    int32_t a = contact_at(&model->contacts, t->from[j]),
            b = contact_at(&model->contacts, t->to[j]);
    if (a < 0 || b < 0) continue;
    if (ties) ties[count] = (strut_band_tie){.member = j, .contact = {a, b}};
    count++;
  }
  return count;
}

/* Does a contact touch, with a slip velocity within its band? *normal: its normal force. */
static bool is_stuck(const strut_model *model, const strut_state *state, int32_t i,
                     double *normal) {
  const strut_contact_table *c = &model->contacts;
  double gap, slip;
  strut_contact_observe(c, i, state, &gap, &slip);
  *normal = -gap * c->entry[i].stiffness;
  return gap < 0.0 && fabs(slip) < c->entry[i].friction.stick_velocity;
}

/* Of a member at the present rest length, where that matters. */
static double stiffness_of(const strut_model *model, const strut_state *state, int32_t member) {
  const strut_element *e = strut_element_of_member(&model->elements, member);
  if (!e || e->law != STRUT_LAW_AXIAL) return model->members.stiffness[member];
  return e->numbers.axial / strut_axial_length(&e->numbers, state->latest->rest[member]);
}

static void sample_tie(const strut_model *model, const strut_state *state, double time,
                       strut_band_tie *tie) {
  const strut_member_table *t = &model->members;
  const strut_contact_entry *e = model->contacts.entry;
  double length = strut_member_length(t, tie->member, state->q), change = length - tie->length,
         normal[2];
  double creep = 0.0, resistance = HUGE_VAL;
  bool held = true;
  for (int k = 0; k < 2; k++) {
    const strut_contact_entry *one = &e[tie->contact[k]];
    held = is_stuck(model, state, tie->contact[k], &normal[k]) && held;
    creep += one->friction.stick_velocity * time;
    double least = fmin(strut_friction_static(&one->friction, 1.0),
                        strut_friction_static(&one->friction, -1.0));
    resistance = fmin(resistance, least * normal[k]);
  }
  /* a larger change means that one of them has slid */
  if (held && tie->held && fabs(change) <= creep)
    tie->force += stiffness_of(model, state, tie->member) * change;
  else
    tie->force = 0.0;
  if (held && fabs(tie->force) > tie->worst * resistance)
    tie->worst = fabs(tie->force) / resistance;
  tie->held = held, tie->length = length;
}

double strut_stick_band_needed(const strut_model *model, const strut_integrator *method,
                               int32_t contact, double step) {
  const strut_contact_table *c = &model->contacts;
  const strut_contact_entry *e = &c->entry[contact];
  const double *g = model->scene->gravity;
  if (method->events || !has_band(e) || !(strut_friction_largest(&e->friction) > 0.0)) return 0.0;
  double down = -(g[0] * c->normal[0] + g[1] * c->normal[1]);
  if (c->surface) down = hypot(g[0], g[1]);
  return down > 0.0 && step > 0.0 ? strut_friction_largest(&e->friction) * down * step : 0.0;
}

bool strut_stick_band_create(const strut_model *model, strut_state *state,
                             const strut_integrator *method, double step, strut_stick_band *band) {
  bool any = false;
  *band = (strut_stick_band){.step = step};
  for (int32_t i = 0; i < model->contacts.count; i++)
    any = any || (has_band(&model->contacts.entry[i]) &&
                  strut_friction_largest(&model->contacts.entry[i].friction) > 0.0);
  if (!any || method->events) return true;
  size_t length = (size_t)model->length, contacts = (size_t)model->contacts.count;
  band->a = strut_arena_allocate(&state->arena, length, sizeof(double));
  band->scratch = strut_arena_allocate(&state->arena, length, sizeof(double));
  band->contacts = strut_arena_allocate(&state->arena, contacts, sizeof *band->contacts);
  band->tie_count = list_ties(model, NULL);
  band->ties = strut_arena_allocate(&state->arena, (size_t)band->tie_count, sizeof *band->ties);
  if (band->ties) list_ties(model, band->ties);
  return band->a && band->scratch && band->contacts && band->ties;
}

void strut_stick_band_sample(const strut_model *model, const strut_state *state,
                             strut_stick_band *band) {
  const strut_contact_table *c = &model->contacts;
  if (!band->contacts) return;
  double time = (double)(state->step - band->last) * band->step;
  for (int32_t k = 0; k < band->tie_count; k++) sample_tie(model, state, time, &band->ties[k]);
  band->last = state->step;
  bool with_acceleration =
      band->samples++ % ACCELERATION_INTERVAL == 0 && state->latest->evaluations > 0;
  if (with_acceleration) strut_mass_solve(model, state->latest->force, band->a, band->scratch);
  if (with_acceleration && model->terms & STRUT_TERM_SLIDING_MASS)
    strut_sliding_masses_correct(model, state, band->a);
  int32_t count =
      c->surface ? strut_contacts_all_near(c, state->q, NULL, state->buffers->near) : c->count;
  for (int32_t k = 0; k < count; k++) {
    int32_t i = c->surface ? state->buffers->near[k] : k;
    strut_stick_band_monitor *w = &band->contacts[i];
    if (!(strut_contact_gap(c, i, state->q) < 0.0)) continue;
    if (!with_acceleration ||
        fabs(strut_contact_slip(c, i, state->v)) < c->entry[i].friction.stick_velocity)
      continue;
    w->sliding++;
    w->change += band->step * fabs(strut_contact_along_ground(c, i, band->a));
  }
}

double strut_stick_band_missed(const strut_model *model, const strut_stick_band *band,
                               int32_t contact) {
  const strut_contact_entry *e = &model->contacts.entry[contact];
  if (!band->contacts || !has_band(e)) return 0.0;
  const strut_stick_band_monitor *w = &band->contacts[contact];
  double needed = w->sliding >= LEAST_SAMPLES ? w->change / w->sliding : 0.0;
  double least = strut_friction_drops(&e->friction) ? ALWAYS_MISSED : MET_BY_CHANCE;
  return e->friction.stick_velocity < least * needed ? needed : 0.0;
}

const strut_band_tie *strut_stick_band_strained(const strut_stick_band *band) {
  const strut_band_tie *most = NULL;
  for (int32_t k = 0; k < band->tie_count; k++)
    if (band->ties[k].worst > STRAINED && (!most || band->ties[k].worst > most->worst))
      most = &band->ties[k];
  return most;
}

/* ---- internal states ---- */

enum { ROUNDS = 40 };

double strut_states_rate(const strut_model *model, strut_state *state, double t, double *work,
                         int32_t *fastest) {
  const strut_feedback_table *f = &model->feedback;
  int32_t count = (int32_t)model->scene->state_count + f->lag_count, base = f->base;
  double *v = work, *here = v + model->length, *there = here + model->length;
  double size = 1e-3, rate = 0.0;
  *fastest = -1;
  if (!count) return 0.0;
  memcpy(v, state->v, (size_t)model->length * sizeof *v);
  strut_feedback_apply(model, state, t, state->q, v);
  strut_feedback_add_rates(model, state, t, v, here);
  for (int32_t i = 0; i < count; i++) size = fmax(size, fabs(v[base + i]));
  for (int32_t i = 0; i < count; i++) v[base + i] += 1e-6 * size * (i % 2 ? -1.0 : 1.0);
  for (int round = 0; round < ROUNDS; round++) { /* power iteration with differences of rates */
    double most = 0.0;
    strut_feedback_apply(model, state, t, state->q, v);
    strut_feedback_add_rates(model, state, t, v, there);
    for (int32_t i = 0; i < count; i++) {
      double change = there[base + i] - here[base + i];
      v[base + i] = change;
      if (fabs(change) > most) most = fabs(change), *fastest = i;
    }
    rate = most / (1e-6 * size);
    if (!(most > 0.0) || !isfinite(most)) break;
    for (int32_t i = 0; i < count; i++)
      v[base + i] = state->v[base + i] + 1e-6 * size * v[base + i] / most;
  }
  strut_feedback_apply(model, state, t, state->q, state->v);
  return isfinite(rate) ? rate : 0.0;
}
