/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Explicit Runge-Kutta methods from event to event: the classical one at fixed steps, and pairs with error control. */
#include <assert.h>

#include "engine/integrate/events/event_kernel.h"
#include "engine/integrate/events/tableaus.h"
#include "engine/integrate/integrator.h"
#include "engine/integrate/plain_steps.h"

/* The classical Runge-Kutta method between events: steps within smooth modes keep the fourth order. */

/* Positions, then velocities and accelerations of the stages 2 to 4. */
enum { Q, V, A = V + 3, STAGES = A + 3 };

STRUT_INLINE void gain_of_stage(const strut_state *state, strut_event_stepper *stepper,
                                double weight) {
  for (int p = 0; p < STRUT_POWER_COUNT; p++)
    stepper->gained[p] += weight * state->latest->power[p];
}

STRUT_INLINE void take_rk4(const strut_model *model, const strut_state *state,
                           strut_event_stepper *stepper, double t, double h, unsigned terms,
                           bool balance) {
  const double *ahead = STRUT_RK4_AHEAD, *weight = STRUT_RK4_WEIGHTS;
  double **w = stepper->stage;
  const double *const v[4] = {stepper->now->v, w[V], w[V + 1], w[V + 2]};
  double *const a[4] = {stepper->now->a, w[A], w[A + 1], w[A + 2]};
  int32_t n = model->length;
  bool moves = model->terms & terms & STRUT_TERM_SUPPORT_MOTION;
  for (int p = 0; p < STRUT_POWER_COUNT && balance; p++)
    stepper->gained[p] = h / 6.0 * stepper->now->power[p];
  for (int k = 1; k < 4; k++) {
    rk4_next_stage(n, ahead[k] * h, stepper->now->q, stepper->now->v, v[k - 1], a[k - 1], w[Q],
                   w[V + k - 1]);
    if (moves) strut_support_motion_place(model, state, t + ahead[k] * h, w[Q], w[V + k - 1]);
    accelerate_in_modes(model, state, stepper, t + ahead[k] * h, w[Q], v[k], a[k], stepper->next,
                        terms, balance);
    if (balance) gain_of_stage(state, stepper, weight[k] * h / 6.0);
  }
  rk4_end_of_step(n, h, stepper->now->q, v[0], v[1], v[2], v[3], stepper->next->q);
  rk4_end_of_step(n, h, stepper->now->v, a[0], a[1], a[2], a[3], stepper->next->v);
  if (moves) strut_support_motion_place(model, state, t + h, stepper->next->q, stepper->next->v);
  evaluate_step_end(model, state, stepper, t + h, stepper->next, terms, balance);
}

STRUT_EVENT_TRIAL(rk4_events, take_rk4)

static const strut_tableau rk4 = {
    .stages = 4,
    .order = 4,
    .ahead = {0.0, 0.5, 0.5, 1.0},
    .weight = {{0}, {0.5}, {0.0, 0.5}, {0.0, 0.0, 1.0}, {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6}}};
static const strut_step_formula order_4 = {
    .trial = rk4_events_trial, .stages = STAGES, .exact = true, .tableau = &rk4};

static void *rk4_events_create(const strut_model *model, strut_state *state,
                               const strut_integrator_settings *settings) {
  strut_event_stepper *stepper = strut_event_stepper_create(model, state, &order_4, settings);
  if (stepper && !(settings->refine > 0.0)) stepper->control.refine = 1.0;
  return stepper;
}

const strut_integrator strut_integrator_rk4_events = {
    .name = "rk4-events",
    .description = "classical Runge-Kutta from event to event, fixed step",
    .order = 4,
    .lag = 1.0 / 120.0,
    .evaluations = 4,
    .region = STRUT_REGION_RK4,
    .role = STRUT_ROLE_EXACT_STICK,
    .create = rk4_events_create,
    STRUT_STEPS_TO_EVENTS,
    .tangent = true,
};

/*
 * Pairs of methods with error control. The end of a step is the first stage of the next one.
 *
 * Errors are measured against the size of the structure, a hundredth of it, for positions, and
 * against the fastest speed so far for velocities. A step within which a contact's gap or slip dips
 * below its mode's edge and comes back is rejected as well: its ends alone would not show that.
 */

/* Positions, then velocities and accelerations of the stages but the first; then what given_up keeps. */
#define ARRAYS(stages) (1 + 2 * ((stages)-1) + 2)

/* sum_j weight[j] k[j] over `count` stages at i. `pairs`: the last one has just been stored pair by pair. */
STRUT_INLINE strut_lanes weighted(double *const *k, const double *weight, int count, bool pairs,
                                  int32_t i) {
  const int last = count - 1;
  strut_lanes newest =
      weight[last] * (pairs ? strut_lanes_load_pairs(k[last] + i) : strut_lanes_load(k[last] + i));
  if (last == 0) return newest;
  strut_lanes sum = weight[0] * strut_lanes_load(k[0] + i);
  for (int j = 1; j < last; j++)
    if (weight[j] != 0.0) sum += weight[j] * strut_lanes_load(k[j] + i);
  return sum + newest;
}

/* Stage k, or the end: q = q0 + h sum v, v[k] = v0 + h sum a, over the stages before it. */
STRUT_INLINE void stage_of(int32_t n, double h, const strut_step_end *now,
                           double *const *velocities, double *const *accelerations,
                           const double *weight, int k, double *restrict positions) {
  double *restrict speed = velocities[k];
  for (int32_t i = 0; i < n; i += STRUT_LANES) {
    strut_lanes_store(positions + i,
                      strut_lanes_load(now->q + i) + h * weighted(velocities, weight, k, false, i));
    strut_lanes_store(
        speed + i, strut_lanes_load(now->v + i) + h * weighted(accelerations, weight, k, true, i));
  }
}

/* The same; the stages of the usual pair with the weights as constants. */
STRUT_INLINE void stage(int32_t n, double h, const strut_step_end *now, double *const *velocities,
                        double *const *accelerations, const strut_tableau *tableau, int k,
                        double *restrict positions) {
#define STRUT_CASE(k)                                                                              \
  case k:                                                                                          \
    stage_of(n, h, now, velocities, accelerations, strut_dormand_prince.weight[k], k, positions);  \
    break
  switch (tableau == &strut_dormand_prince ? k : 0) {
    STRUT_CASE(1);
    STRUT_CASE(2);
    STRUT_CASE(3);
    STRUT_CASE(4);
    STRUT_CASE(5);
    STRUT_CASE(6);
    default: stage_of(n, h, now, velocities, accelerations, tableau->weight[k], k, positions);
  }
#undef STRUT_CASE
}

/* The largest magnitude seen so far, lane by lane; `poison` is no number once one was none. */
typedef struct largest {
  strut_lanes most, poison;
} largest;

STRUT_INLINE largest larger_of(largest so_far, strut_lanes x) {
  strut_lanes size = four_magnitude(x);
  return (largest){four_choose(size > so_far.most, size, so_far.most), so_far.poison + (x - x)};
}

STRUT_INLINE double largest_of(largest x) {
  double most = x.most[0], poison = x.poison[0];
  for (int l = 1; l < STRUT_LANES; l++) {
    most = x.most[l] > most ? x.most[l] : most;
    poison += x.poison[l];
  }
  return poison == 0.0 ? most : HUGE_VAL;
}

/* The pair's differences of positions and velocities, and the fastest speed at an end. */
typedef struct difference {
  largest position, velocity, speed;
} difference;

STRUT_INLINE difference difference_of(int32_t n, double h, const strut_event_stepper *stepper,
                                      double *const *velocities, double *const *accelerations,
                                      const double *weight, int count) {
  difference d = {.speed = {.most = {0}}};
  for (int32_t i = 0; i < n; i += STRUT_LANES) {
    d.position = larger_of(d.position, h * weighted(velocities, weight, count, false, i));
    d.velocity = larger_of(d.velocity, h * weighted(accelerations, weight, count, true, i));
    d.speed = larger_of(d.speed, strut_lanes_load(stepper->now->v + i));
    d.speed = larger_of(d.speed, strut_lanes_load(stepper->next->v + i));
  }
  return d;
}

/* Local error over what is allowed, by the difference of the pair. */
STRUT_INLINE double error_of(const strut_model *model, strut_event_stepper *stepper, double h,
                             double *const *velocities, double *const *accelerations) {
  const strut_tableau *tableau = stepper->formula->tableau, *usual = &strut_dormand_prince;
  int32_t n = model->length;
  difference d = tableau == usual
                     ? difference_of(n, h, stepper, velocities, accelerations, usual->difference,
                                     STRUT_DORMAND_PRINCE_STAGES + 1)
                     : difference_of(n, h, stepper, velocities, accelerations, tableau->difference,
                                     tableau->stages + 1);
  double fast = largest_of(d.speed), off = largest_of(d.velocity);
  stepper->control.own_speed = fast;
  if (fast > stepper->control.speed) stepper->control.speed = fast;
  return relative_error(model, &stepper->control, h, largest_of(d.position), off);
}

/* The margin at whose zero the mode of contact i, at o, ends; HUGE_VAL for modes that need no look at stages. */
static double kept_margin(const strut_event_stepper *stepper, int32_t i, const strut_touch *touch) {
  const strut_contact_entry *contact = &stepper->contacts.entry[i];
  switch ((strut_contact_mode)stepper->modes.of[i]) {
    case STRUT_MODE_STICK: return margin_of_stick(contact, touch);
    case STRUT_MODE_CREEP:
      return fmin(margin_of_creep_out(contact, touch, stepper->modes.side[i]),
                  margin_of_creep_in(contact, touch, stepper->modes.side[i]));
    case STRUT_MODE_BAND:
      if (!strut_friction_drops(&contact->friction)) break;
      return margin_of_push(contact, touch, STRUT_MODE_BAND, stepper->modes.side[i]);
    case STRUT_MODE_PUSH:
      return margin_of_push(contact, touch, STRUT_MODE_PUSH, stepper->modes.side[i]);
    case STRUT_MODE_OPEN:
    case STRUT_MODE_SLIDE:
    case STRUT_MODE_SLIP: /* by earliest_dip */
    case STRUT_MODE_YIELD: break;
  }
  return HUGE_VAL;
}

static void note(strut_least_margin *least, double margin, double at, bool first) {
  if (first || margin < least->margin) *least = (strut_least_margin){margin, at};
}

void strut_event_note_stage(const strut_event_stepper *stepper, double at, bool first) {
  for (int32_t k = 0; k < stepper->active.closed_count; k++) {
    int32_t i = stepper->active.closed[k];
    const strut_touch *touch = &stepper->next->touch[i];
    note(&stepper->control.least[i],
         touch->normal > 0.0 ? kept_margin(stepper, i, touch) : HUGE_VAL, at, first);
  }
}

/* Is switch k one of a slider, a guide or a break, whose margin has no rate? */
static bool remembers(const strut_event_stepper *stepper, int32_t k) {
  const strut_law_switches *laws = &stepper->laws;
  assert(k >= 0 && k < laws->count);
  return laws->item[k].event == STRUT_EVENT_SLIDER || laws->item[k].event == STRUT_EVENT_BREAK;
}

/* As note_stage, of sliders, guides and breaks, at a stage's q and v. */
static void note_memory(const strut_model *model, const strut_state *state,
                        const strut_event_stepper *stepper, const strut_step_end *stage, double at,
                        bool first) {
  for (int32_t k = 0; k < stepper->laws.count; k++) {
    if (!remembers(stepper, k)) continue;
    strut_history_measure(model, state, stepper, stage, k);
    note(&stepper->control.least[model->contacts.count + k], stage->tension[k], at, first);
  }
}

/* Is less of a margin left, where it is `least` within a step, than it has lost from what it is at its ends, `kept` at
   least? Its true least value may then be below 0. */
static bool is_spent_at_stage(double least, double kept) { return 2.0 * least < kept; }

/* A margin this small beside the normal force says nothing. */
static const double FAINT_MARGIN = 1e-9;

/*
 * Earliest stage by which contact i has nearly given way, or has, though it keeps its mode at the end of the step: from
 * there and from the begin its margin falls by more than is left of it. Where it is below 0 from the begin, since other
 * forces have jumped there: soon after. 0: none.
 */
static double spent_at(const strut_event_stepper *stepper, int32_t i) {
  const strut_step_control *control = &stepper->control;
  const strut_touch *now = &stepper->now->touch[i], *next = &stepper->next->touch[i];
  if (control->least[i].margin == HUGE_VAL) return 0.0;
  double from = now->normal > 0.0 ? kept_margin(stepper, i, now) : 0.0;
  double to = next->normal > 0.0 ? kept_margin(stepper, i, next) : 0.0;
  double faint = FAINT_MARGIN * next->normal;
  if (to < 0.0 || !is_spent_at_stage(control->least[i].margin, to)) return 0.0;
  if (from < -faint) return SOON * stepper->formula->tableau->ahead[1];
  return is_spent_at_stage(control->least[i].margin, fmin(from, to) - faint) ? control->least[i].at
                                                                             : 0.0;
}

/* As spent_at, of switch k of a slider, a guide or a break. */
static double memory_spent_at(const strut_model *model, const strut_event_stepper *stepper,
                              int32_t k) {
  const strut_least_margin *least = &stepper->control.least[model->contacts.count + k];
  double from = fmax(stepper->now->tension[k], 0.0), to = stepper->next->tension[k];
  bool spent = to > 0.0 && is_spent_at_stage(least->margin, fmin(from, to) - FAINT_MARGIN * to);
  return spent ? least->at : 0.0;
}

static double earliest_spent(const strut_model *model, const strut_event_stepper *stepper) {
  double first = 0.0;
  for (int32_t k = 0; k < stepper->active.closed_count && !stepper->active.all_sliding; k++)
    first = earlier(first, spent_at(stepper, stepper->active.closed[k]));
  for (int32_t k = 0; k < stepper->laws.count && model->terms & STRUT_TERM_MEMORY; k++)
    if (remembers(stepper, k)) first = earlier(first, memory_spent_at(model, stepper, k));
  return first;
}

/* Steps are not split for a stage's sake below this part of the longest. */
static const double LEAST_SPLIT = 1e-4;

void strut_event_look_between(const strut_model *model, const strut_state *state,
                              strut_event_stepper *stepper, double h) {
  if (strut_turns_due(state, stepper)) strut_turns_look(model, state, stepper, h);
  if (!(stepper->control.error <= 1.0)) return;
  strut_event_measure(model, state, stepper, stepper->next);
  double part = strut_event_between(model, state, stepper, h);
  double spent = h > LEAST_SPLIT * stepper->control.longest ? earliest_spent(model, stepper) : 0.0;
  if (spent > 0.0 && earlier(part, spent) == spent) {
    strut_event event = strut_event_first(model, state, stepper, h);
    if (!event.kind || event.fraction > spent) part = spent;
  }
  if (part > 0.0) /* the error that makes the next step end there */
    stepper->control.error = fmax(1.01, pow(0.9 / part, stepper->formula->tableau->order));
}

STRUT_INLINE void take(const strut_model *model, const strut_state *state,
                       strut_event_stepper *stepper, double t, double h, unsigned terms,
                       bool balance) {
  const strut_tableau *tableau = stepper->formula->tableau;
  double *v[STRUT_MOST_STAGES + 1], *a[STRUT_MOST_STAGES + 1];
  const int end = tableau->stages;
  const double *ahead = tableau->ahead, *last = tableau->weight[end];
  v[0] = stepper->now->v, a[0] = stepper->now->a;
  for (int k = 1; k < end; k++) v[k] = stepper->stage[k], a[k] = stepper->stage[end - 1 + k];
  v[end] = stepper->next->v, a[end] = stepper->next->a;
  for (int p = 0; p < STRUT_POWER_COUNT && balance; p++)
    stepper->gained[p] = last[0] * h * stepper->now->power[p];
  for (int k = 1; k <= end; k++) {
    double *q = k == end ? stepper->next->q : stepper->stage[0];
    stage(model->length, h, stepper->now, v, a, tableau, k, q);
    if (model->terms & terms & STRUT_TERM_SUPPORT_MOTION)
      strut_support_motion_place(model, state, t + ahead[k] * h, q, v[k]);
    if (k == end) break;
    accelerate_in_modes(model, state, stepper, t + ahead[k] * h, q, v[k], a[k], stepper->next,
                        terms, balance);
    if (stepper->active.closed_count && !stepper->active.all_sliding)
      strut_event_note_stage(stepper, ahead[k], k == 1);
    if (model->terms & terms & STRUT_TERM_MEMORY) {
      strut_step_end at = *stepper->next;
      at.q = q, at.v = v[k];
      note_memory(model, state, stepper, &at, ahead[k], k == 1);
    }
    for (int p = 0; p < STRUT_POWER_COUNT && balance; p++)
      stepper->gained[p] += last[k] * h * state->latest->power[p];
  }
  evaluate_step_end(model, state, stepper, t + h, stepper->next, terms, balance);
  stepper->control.error = error_of(model, stepper, h, v, a);
  strut_event_look_between(model, state, stepper, h);
}

STRUT_EVENT_TRIAL(adaptive, take)

/* The method that steps by this pair. */
#define FORMULA(pair, count)                                                                       \
  {                                                                                                \
    .trial = adaptive_trial, .stages = ARRAYS(count), .exact = true, .adaptive = true,             \
    .tableau = &(pair)                                                                             \
  }
static const strut_step_formula order_5 =
                                    FORMULA(strut_dormand_prince, STRUT_DORMAND_PRINCE_STAGES),
                                order_8 = FORMULA(strut_verner, STRUT_VERNER_STAGES);

static void *adaptive_create(const strut_model *model, strut_state *state,
                             const strut_integrator_settings *settings) {
  return strut_event_stepper_create(model, state, &order_5, settings);
}

static void *adaptive8_create(const strut_model *model, strut_state *state,
                              const strut_integrator_settings *settings) {
  return strut_event_stepper_create(model, state, &order_8, settings);
}

const strut_integrator strut_integrator_adaptive = {
    .name = "adaptive",
    .description = "Dormand-Prince 5(4) from event to event, step by error control",
    .order = 5,
    .evaluations = 6,
    .role = STRUT_ROLE_REFERENCE,
    .create = adaptive_create,
    STRUT_STEPS_TO_EVENTS,
    .tangent = true,
};

const strut_integrator strut_integrator_adaptive8 = {
    .name = "adaptive8",
    .role = STRUT_ROLE_PRECISE,
    .description = "Verner 8(7) from event to event, step by error control",
    .order = 8,
    .evaluations = 13,
    .create = adaptive8_create,
    STRUT_STEPS_TO_EVENTS,
};
