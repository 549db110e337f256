/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/monitors.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/indices.h"
#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/surfaces.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/model/mass.h"
#include "engine/model/pose.h"

/* ---- step limit ---- */

/* Force evaluations between two samples, each a power iteration; more of these at the start. */
enum { EVALUATIONS_PER_SAMPLE = 256, FIRST_ITERATIONS = 30 };
/* Logarithm of the growth at which an unstable motion has replaced the true one. */
static const double LOST_MOTION = 16.0;

/* image = (stiff K + damp D) motion. */
typedef struct product {
  const double *motion;
  double *image, stiff, damp;
} product;

static void apply_force(const strut_model *model, const double *q, const strut_force *force,
                        const product *to) {
  double bend[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT], moved[STRUT_MOST_GRADIENT];
  const double *b = force->pose.b, *side = force->side;
  bool element = force->kind == STRUT_FORCE_ELEMENT;
  int32_t n = 2 * force->nodes;
  double stretch = 0.0, turn = 0.0;
  for (int32_t c = 0; c < n; c += 2) {
    const double *v = to->motion + force->at[c / 2];
    moved[c] = v[0], moved[c + 1] = v[1];
    stretch += b[c] * v[0] + b[c + 1] * v[1];
    if (!element) turn += side[c] * v[0] + side[c + 1] * v[1];
  }
  double along = (to->stiff * force->pose.slope + to->damp * force->damping) * stretch;
  double across = to->stiff * force->across * turn;
  if (element) {
    memset(bend, 0, (size_t)(n * n) * sizeof *bend);
    strut_force_bend(model, force, q, to->stiff, bend);
  }
  for (int32_t r = 0; r < n; r++) {
    double push = along * b[r] + (element ? strut_dot(bend + r * n, moved, n) : across * side[r]);
    to->image[strut_force_coordinate(force, r)] += push;
  }
}

/* Makes (count) products at a state's shape, on free coordinates. */
static void apply_forces(const strut_model *model, const strut_state *state, strut_closed closed,
                         const product *to, int count) {
  strut_force_visit visit = {.model = model,
                             .q = state->q,
                             .rest = state->latest->rest,
                             .least = -HUGE_VAL,
                             .closed = closed};
  for (int i = 0; i < count; i++)
    memset(to[i].image, 0, (size_t)model->length * sizeof *to[i].image);
  for (const strut_force *force; (force = strut_force_next(&visit));)
    for (int i = 0; i < count; i++)
      if (force->kind != STRUT_FORCE_MEMBER || force->pose.strain > 0.0)
        apply_force(model, state->q, force, &to[i]);
  for (int i = 0; i < count; i++)
    for (int32_t at = 0; at < 2 * model->node_count; at++)
      if (model->fixed[at]) to[i].image[at] = 0.0;
}

/* Adds noise to a motion, so that no eigenvector is missed for ever. */
static void perturb_motion(const strut_model *model, strut_step_limit_monitor *monitor,
                           strut_monitored_set *set, double size) {
  for (int32_t i = 0; i < 2 * model->node_count; i++) {
    monitor->noise = monitor->noise * 6364136223846793005u + 1442695040888963407u;
    if (!model->fixed[i]) set->motion[i] += size * ((double)(monitor->noise >> 11) * 0x1p-53 - 0.5);
  }
}

/*
 * The Rayleigh quotient of a motion with its image, which lies below the eigenvalue; the next motion is the inverse
 * mass times the image, so that its norm in the mass is known.
 */
static void improve_motion(const strut_model *model, strut_step_limit_monitor *monitor,
                           strut_monitored_set *set) {
  int32_t n = 2 * model->node_count;
  double work = 0.0, square = 0.0, largest = 0.0, weight = set->weight;
  strut_mass_solve(model, set->image, monitor->divided, monitor->scratch);
  for (int32_t i = 0; i < n; i++) {
    work += set->motion[i] * set->image[i];
    square += monitor->divided[i] * set->image[i];
    largest = strut_larger(largest, fabs(monitor->divided[i]));
  }
  if (!(largest > 0.0 && largest < HUGE_VAL)) {
    perturb_motion(model, monitor, set, 1.0);
    set->weight = set->strength = 0.0;
    return;
  }
  for (int32_t i = 0; i < n; i++) set->motion[i] = monitor->divided[i] / largest;
  set->weight = square / largest / largest;
  set->strength = weight > 0.0 ? work / weight : 0.0;
}

/* Where a method has implicit dampers of the ground, its steps are refined while the ground is touched. */
static strut_closed closed_in(const strut_step_limit_monitor *monitor) {
  return monitor->method->implicit_damper ? STRUT_CLOSED_NONE : STRUT_CLOSED_TOUCHING;
}

/* One step of the power iteration of all sets. */
static void iterate_power(const strut_model *model, const strut_state *state,
                          strut_step_limit_monitor *monitor) {
  product to[2];
  for (int i = 0; i < monitor->count; i++) {
    const strut_monitored_set *set = &monitor->set[i];
    to[i] = (product){set->motion, set->image, monitor->step * monitor->step * set->stiff,
                      monitor->step * set->damp};
  }
  apply_forces(model, state, closed_in(monitor), to, monitor->count);
  for (int i = 0; i < monitor->count; i++) improve_motion(model, monitor, &monitor->set[i]);
}

/* Step limit of a shape; HUGE_VAL where memory is out. */
static double find_limit(const strut_model *model, const strut_step_limit_monitor *monitor,
                         const double *positions, const double *rest) {
  strut_step_limit limit;
  if (strut_step_limit_at_shape(model, positions, rest, closed_in(monitor), &limit, NULL))
    return HUGE_VAL;
  return limit.of[monitor->method->region];
}

static void update_limit(const strut_model *model, const strut_state *state,
                         strut_step_limit_monitor *monitor) {
  monitor->known_limit = find_limit(model, monitor, state->q, state->latest->rest);
  for (int i = 0; i < monitor->count; i++) {
    strut_monitored_set *set = &monitor->set[i];
    set->known = set->strength;
    /*
     * the limit falls at most with 1/strength: recompute when strength could bring it to the step
     */
    set->alarm = fmax(1.0, set->strength * fmax(1.01, 0.99 * monitor->known_limit / monitor->step));
  }
}

/* Records that the step is above the limit, for the last `steps` steps. */
static void record_violation(strut_step_limit_monitor *monitor, double time, int64_t steps) {
  double limit = monitor->known_limit;
  double growth = strut_region_at(monitor->method->region)->growth;
  if (!(monitor->lowest > 0.0)) monitor->first_time = time;
  if (!(monitor->lowest > 0.0) || limit < monitor->lowest)
    monitor->lowest = limit, monitor->lowest_time = time;
  monitor->grown =
      monitor->below
          ? monitor->grown + growth * fmin(monitor->step / limit - 1.0, 1.0) * (double)steps
          : 0.0;
  monitor->steps_below += steps;
  monitor->below = true;
  monitor->motion_lost = monitor->motion_lost || monitor->grown > LOST_MOTION;
}

void strut_step_limit_monitor_sample(const strut_model *model, const strut_state *state,
                                     strut_step_limit_monitor *monitor) {
  int64_t steps = state->step - monitor->last;
  bool again = false;
  monitor->last = state->step;
  monitor->next = state->step + monitor->every;
  for (int i = 0; i < monitor->count; i++) perturb_motion(model, monitor, &monitor->set[i], 1e-6);
  iterate_power(model, state, monitor);
  for (int i = 0; i < monitor->count; i++) {
    const strut_monitored_set *set = &monitor->set[i];
    again = again || set->strength >= set->alarm ||
            (monitor->below && set->strength < 0.99 * set->known);
  }
  if (monitor->count > 0) {
    memcpy(monitor->shape, state->q, (size_t)model->length * sizeof *monitor->shape);
    memcpy(monitor->rest, state->latest->rest,
           (size_t)model->members.slots * sizeof *monitor->rest);
  }
  if (again) update_limit(model, state, monitor);
  if (monitor->known_limit < monitor->step)
    record_violation(monitor, (double)state->step * monitor->step, steps);
  else
    monitor->below = false;
}

double strut_step_limit_monitor_last_limit(const strut_model *model,
                                           const strut_step_limit_monitor *monitor) {
  return monitor->count > 0 ? find_limit(model, monitor, monitor->shape, monitor->rest) : HUGE_VAL;
}

void strut_step_limit_monitor_check(const strut_model *model, const strut_state *state,
                                    strut_step_limit_monitor *monitor) {
  if (monitor->count == 0) return;
  double before = strut_step_limit_monitor_last_limit(model, monitor);
  monitor->known_limit = fmin(before, find_limit(model, monitor, state->q, state->latest->rest));
  if (monitor->known_limit < monitor->step)
    record_violation(monitor, (double)monitor->last * monitor->step, 0);
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
  if (!STRUT_NUMBERS(&state->arena, model->length, &monitor->shape, &monitor->set[0].motion,
                     &monitor->set[1].motion, &monitor->set[0].image, &monitor->set[1].image,
                     &monitor->divided, &monitor->scratch) ||
      !STRUT_NUMBERS(&state->arena, model->members.slots, &monitor->rest))
    return false;
  monitor->every = EVALUATIONS_PER_SAMPLE / method->evaluations;
  monitor->last = monitor->next = state->step;
  for (int i = 0; i < monitor->count; i++) {
    monitor->set[i].alarm = 1.0;
    perturb_motion(model, monitor, &monitor->set[i], 1.0);
  }
  for (int k = 0; k < FIRST_ITERATIONS; k++) iterate_power(model, state, monitor);
  return true;
}

strut_status strut_step_limit_monitor_fail(const strut_step_limit_monitor *monitor,
                                           const strut_state *state, double start_limit,
                                           strut_error *error) {
  const char *name = monitor->method->name;
  if (monitor->lowest > 0.0)
    return strut_fail(
        error, STRUT_DIVERGED,
        "the structure has become stiffer: at t = %.9g s the largest stable step of %s, %.4g s at "
        "the start, fell below the step %g s, then to %.4g s, and the motion since then is "
        "numerical; use solver.step <= %.2g s, or --force to continue anyway",
        monitor->first_time, name, start_limit, monitor->step, monitor->lowest,
        0.9 * monitor->lowest);
  return strut_fail(
      error, STRUT_DIVERGED,
      "by t = %.9g s most of the energy has appeared without a source: the structure became "
      "stiffer than at the start, where the largest stable step of %s is %.4g s, and too stiff for "
      "the step %g s; use solver.step <= %.2g s, or --force to continue anyway",
      (double)state->step * monitor->step, name, start_limit, monitor->step, 0.75 * monitor->step);
}

/* ---- vibrations ---- */

bool strut_motion_frequency_create(const strut_model *model, strut_state *state,
                                   strut_motion_frequency *frequency) {
  *frequency = (strut_motion_frequency){0};
  return STRUT_NUMBERS(&state->arena, (size_t)model->length, &frequency->image[0],
                       &frequency->image[1]);
}

void strut_motion_frequency_sample(const strut_model *model, const strut_state *state,
                                   double kinetic, strut_motion_frequency *frequency) {
  const product to[] = {{state->v, frequency->image[0], 1.0, 0.0},
                        {state->v, frequency->image[1], 0.0, 1.0}};
  apply_forces(model, state, STRUT_CLOSED_TOUCHING, to, 2);
  frequency->curvature += strut_dot(state->v, frequency->image[0], 2 * model->node_count);
  frequency->damping += strut_dot(state->v, frequency->image[1], 2 * model->node_count);
  frequency->movement += 2.0 * kinetic;
  frequency->samples++;
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

static bool has_band(const strut_contact_entry *contact) {
  return strut_friction_has_band(contact->friction.law);
}

/* Contact with stronger static friction at a coordinate, or -1; contacts are in ascending order. */
static int32_t contact_at(const strut_contact_table *contacts, uint32_t coordinate) {
  int32_t i = strut_index_find((const int32_t *)contacts->at, contacts->count, (int32_t)coordinate);
  if (i == contacts->count || contacts->at[i] != coordinate) return -1;
  const strut_contact_entry *contact = &contacts->entry[i];
  return has_band(contact) && strut_friction_drops(&contact->friction) ? i : -1;
}

/* Counts the ties; fills them if `ties` is given. */
static int32_t list_ties(const strut_model *model, strut_band_tie *ties) {
  const strut_member_table *members = &model->members;
  int32_t count = 0;
  for (int32_t j = 0; j < members->count; j++) {
    int32_t a = contact_at(&model->contacts, members->from[j]),
            b = contact_at(&model->contacts, members->to[j]);
    if (a < 0 || b < 0) continue;
    if (ties) ties[count] = (strut_band_tie){.member = j, .contact = {a, b}};
    count++;
  }
  return count;
}

/* Does a contact touch, with a slip velocity within its band? *normal: its normal force. */
static bool is_stuck(const strut_model *model, const strut_state *state, int32_t i,
                     double *normal) {
  const strut_contact_table *contacts = &model->contacts;
  double gap, slip;
  strut_contact_observe(contacts, i, state, &gap, &slip);
  *normal = -gap * contacts->entry[i].stiffness;
  return gap < 0.0 && fabs(slip) < contacts->entry[i].friction.stick_velocity;
}

/* Of a member at the present rest length, where that matters. */
static double stiffness_of(const strut_model *model, const strut_state *state, int32_t member) {
  const strut_element *element = strut_element_of_member(&model->elements, member);
  if (!element || element->law != STRUT_LAW_AXIAL) return model->members.stiffness[member];
  return element->numbers.axial /
         strut_axial_length(&element->numbers, state->latest->rest[member]);
}

static void sample_tie(const strut_model *model, const strut_state *state, double time,
                       strut_band_tie *tie) {
  const strut_member_table *members = &model->members;
  const strut_contact_entry *contact = model->contacts.entry;
  double length = strut_member_length(members, tie->member, state->q),
         change = length - tie->length, normal[2];
  double creep = 0.0, resistance = HUGE_VAL;
  bool held = true;
  for (int k = 0; k < 2; k++) {
    const strut_contact_entry *one = &contact[tie->contact[k]];
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
  const strut_contact_table *contacts = &model->contacts;
  const strut_contact_entry *e = &contacts->entry[contact];
  const double *g = model->scene->gravity;
  if (method->events || !has_band(e) || !(strut_friction_largest(&e->friction) > 0.0)) return 0.0;
  double down = -(g[0] * contacts->normal[0] + g[1] * contacts->normal[1]);
  if (contacts->surface) down = hypot(g[0], g[1]);
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
  band->tie_count = list_ties(model, NULL);
  if (!STRUT_ALLOCATE(
          &state->arena, STRUT_NEW(band->a, model->length), STRUT_NEW(band->scratch, model->length),
          STRUT_NEW(band->contacts, model->contacts.count), STRUT_NEW(band->ties, band->tie_count)))
    return false;
  list_ties(model, band->ties);
  return true;
}

void strut_stick_band_sample(const strut_model *model, const strut_state *state,
                             strut_stick_band *band) {
  const strut_contact_table *contacts = &model->contacts;
  if (!band->contacts) return;
  double time = (double)(state->step - band->last) * band->step;
  for (int32_t k = 0; k < band->tie_count; k++) sample_tie(model, state, time, &band->ties[k]);
  band->last = state->step;
  bool with_acceleration =
      band->samples++ % ACCELERATION_INTERVAL == 0 && state->latest->evaluations > 0;
  if (with_acceleration) strut_mass_solve(model, state->latest->force, band->a, band->scratch);
  if (with_acceleration && model->terms & STRUT_TERM_SLIDING_MASS)
    strut_sliding_masses_correct(model, state, band->a);
  int32_t count = contacts->surface
                      ? strut_contacts_all_near(contacts, state->q, NULL, state->buffers->near)
                      : contacts->count;
  for (int32_t k = 0; k < count; k++) {
    int32_t i = contacts->surface ? state->buffers->near[k] : k;
    strut_stick_band_monitor *monitor = &band->contacts[i];
    if (!(strut_contact_gap(contacts, i, state->q) < 0.0)) continue;
    if (!with_acceleration || fabs(strut_contact_slip(contacts, i, state->v)) <
                                  contacts->entry[i].friction.stick_velocity)
      continue;
    monitor->sliding++;
    monitor->change += band->step * fabs(strut_contact_along_ground(contacts, i, band->a));
  }
}

double strut_stick_band_missed(const strut_model *model, const strut_stick_band *band,
                               int32_t contact) {
  const strut_contact_entry *e = &model->contacts.entry[contact];
  if (!band->contacts || !has_band(e)) return 0.0;
  const strut_stick_band_monitor *monitor = &band->contacts[contact];
  double needed = monitor->sliding >= LEAST_SAMPLES ? monitor->change / monitor->sliding : 0.0;
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
  const strut_feedback_table *feedback = &model->feedback;
  int32_t count = (int32_t)model->scene->state_count + feedback->lag_count, base = feedback->base;
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
