/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Members that shrink to nothing. Their nodes pass one another, and the force that they carry turns round there: a step
 * ends at that moment, and within the step the force keeps its direction. A cable that would be pulled through its guide
 * ends the run.
 *
 * A member that cannot shrink to nothing within a step costs nothing: its length, speed and acceleration say for how
 * many steps it need not be looked at.
 */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/integrate/events/event_kernel.h"

enum { LONGEST_REST = 200 };         /* grid steps between two looks */
static const double CAUTION = 0.125; /* of the time in which a member could shrink to nothing */
static const double AT_GUIDE = 1e-6; /* of the size */
static const double SWINGS =
    0.25; /* square of the sine of the angle from which on a node is not behind */
/* Fixed steps see too little of a way beside a length of more than COARSE, unless the member turns by an angle the
   square of whose sine is below STRAIGHT; they are cut to PART of that length, into MOST_PIECES at most. */
static const double COARSE = 0.5, STRAIGHT = 2e-4, PART = 0.4;
enum { MOST_PIECES = 400 };

/* From the first node to the second at an end of a step, and its change over the step at that rate. */
typedef struct span {
  double x, y, dx, dy, length;
} span;

static double along(const double *r, double x, double y) { return r[0] * x + r[1] * y; }

static const uint32_t *ends_of(const strut_event_stepper *stepper, int32_t k) {
  return stepper->turns.ends + 2 * (k - stepper->turns.first);
}
static double *ahead_of(const strut_event_stepper *stepper, int32_t k) {
  return stepper->turns.ahead + 2 * (k - stepper->turns.first);
}

static span span_of(const strut_event_stepper *stepper, int32_t k, const double *positions,
                    const double *velocity, double h) {
  const uint32_t *at = ends_of(stepper, k);
  double x = positions[at[1]] - positions[at[0]], y = positions[at[1] + 1] - positions[at[0] + 1];
  return (span){x, y, h * (velocity[at[1]] - velocity[at[0]]),
                h * (velocity[at[1] + 1] - velocity[at[0] + 1]), hypot(x, y)};
}

/* Has the second node passed the first, and not just swung round it? */
static bool is_behind(const double *r, const span *self) {
  double across = r[0] * self->y - r[1] * self->x;
  return along(r, self->x, self->y) < 0.0 && across * across < SWINGS * self->length * self->length;
}

/* Lengths below this have no direction [m]. */
static double nothing(const strut_model *model, const strut_event_stepper *stepper, int32_t k) {
  double faint = strut_faint_length(model, stepper);
  return stepper->laws.item[k].guide ? fmax(faint, AT_GUIDE * model->size) : faint;
}

/* Segments of member j that may turn round: of a cable at point guides all, else one if it carries something there. */
static int32_t segments_of(const strut_model *model, int32_t j) {
  const strut_element *element = strut_element_of_member(&model->elements, j);
  if (element && element->strain != STRUT_STRAIN_LENGTH)
    return element->strain == STRUT_STRAIN_PATH ? element->nodes - 1 : 0;
  bool driven = model->members.rest[j] != 0.0 || model->terms & STRUT_TERM_DRIVE;
  bool pushes = model->scene->members[j].kind != STRUT_CABLE || (element && element->sibling >= 0);
  return model->terms & STRUT_TERM_ACTUATOR_FORCES ||
         (pushes && (element || (driven && model->members.stiffness[j] > 0.0)));
}

int32_t strut_turns_list(const strut_model *model, strut_law_switch *item, uint32_t *ends) {
  const strut_member_table *members = &model->members;
  int32_t count = 0;
  for (int32_t j = 0; j < members->count; j++) {
    const strut_element *element = strut_element_of_member(&model->elements, j);
    bool guided = element && element->strain == STRUT_STRAIN_PATH;
    for (int32_t k = 0; k < segments_of(model, j); k++, count++) {
      if (!item) continue;
      item[count] = (strut_law_switch){
          .event = STRUT_EVENT_TURN, .member = j, .element = -1, .guide = guided ? k + 1 : 0};
      const uint32_t *at = model->elements.at + (guided ? element->first + k : 0);
      ends[2 * count] = guided ? at[0] : members->from[j];
      ends[2 * count + 1] = guided ? at[1] : members->to[j];
    }
  }
  return count;
}

/* ---- who looks, and when ---- */

void strut_turns_measure(const strut_event_stepper *stepper, const strut_step_end *end) {
  for (int32_t k = stepper->turns.first; k < stepper->laws.count; k++) {
    const double *r = ahead_of(stepper, k);
    span s = span_of(stepper, k, end->q, end->v, 1.0);
    end->stretch[k] = end->tension[k] = along(r, s.x, s.y);
    end->stretch_rate[k] = along(r, s.dx, s.dy);
  }
}

/* The time before and after the end of a step in which a member does not shrink to nothing [s]. */
static double time_left(const uint32_t *at, const strut_step_end *end) {
  const double *q = end->q, *v = end->v, *a = end->a;
  uint32_t i = at[0], k = at[1];
  double x = q[k] - q[i], y = q[k + 1] - q[i + 1], u = v[k] - v[i], w = v[k + 1] - v[i + 1];
  double ax = a[k] - a[i], ay = a[k + 1] - a[i + 1];
  double length = CAUTION * sqrt(x * x + y * y), bend = length / sqrt(ax * ax + ay * ay);
  double straight = length / sqrt(u * u + w * w), square = straight * straight;
  return sqrt(square < bend ? square : bend > 0.0 ? bend : 0.0);
}

void strut_turns_look(const strut_model *model, const strut_state *state,
                      strut_event_stepper *stepper, double h) {
  strut_turns *turns = &stepper->turns;
  double least = LONGEST_REST * stepper->control.longest;
  if (turns->on && !turns->stepped) return; /* a trial of the same step */
  for (int32_t k = 0; k < turns->count; k++) {
    double left = time_left(turns->ends + 2 * k, stepper->next);
    if (!(left >= least)) least = left;
  }
  bool near = turns->count && !(least > h);
  turns->due = state->step + (near ? 0 : (int64_t)(least / stepper->control.longest));
  turns->stepped = false;
  if (near == turns->on) return;
  turns->on = near;
  stepper->laws.count = turns->first + (near ? turns->count : 0);
  stepper->laws.nearby_made = 0;
  memset(turns->ahead, 0, 2 * (size_t)turns->count * sizeof *turns->ahead);
  if (near) strut_turns_keep(model, state, stepper), turns->stepped = false;
}

/* The direction of the span, or if it is short, that of its change. */
static void point(const span *self, bool is_short, double *r) {
  double x = is_short ? self->dx : self->x, y = is_short ? self->dy : self->y, length = hypot(x, y);
  if (length > 0.0) r[0] = x / length, r[1] = y / length;
}

void strut_turns_keep(const strut_model *model, const strut_state *state,
                      strut_event_stepper *stepper) {
  const strut_step_end *now = stepper->now;
  strut_turns *turns = &stepper->turns;
  turns->stepped = true;
  turns->pieces = turns->step == state->step ? turns->pieces + 1 : 0;
  turns->step = state->step;
  for (int32_t k = stepper->turns.first; k < stepper->laws.count; k++) {
    span s = span_of(stepper, k, now->q, now->v, 1.0);
    double *r = ahead_of(stepper, k);
    bool is_short = s.length <= nothing(model, stepper, k), known = r[0] != 0.0 || r[1] != 0.0;
    if (!known || !is_short) point(&s, is_short, r);
  }
  strut_turns_measure(stepper, now);
}

/* ---- forces ---- */

/* What a straight member carries where it has no length, tension positive [N]. */
static double force_at_nothing(const strut_model *model, const strut_state *state,
                               const strut_event_stepper *stepper, int32_t k,
                               const double *positions) {
  int32_t j = stepper->laws.item[k].member;
  const uint32_t *at = ends_of(stepper, k);
  double *there = stepper->middle;
  memcpy(there, positions, (size_t)model->length * sizeof *positions);
  there[at[1]] = there[at[0]], there[at[1] + 1] = there[at[0] + 1];
  double force = strut_member_elastic_tension(model, state->latest->rest, j, there) +
                 strut_actuator_force_on(model, state, j, -1);
  return isfinite(force) ? force : 0.0;
}

void strut_turns_hold(const strut_model *model, const strut_state *state,
                      const strut_event_stepper *stepper, const double *positions,
                      const double *velocity) {
  double *force = state->latest->force;
  for (int32_t k = stepper->turns.first; k < stepper->laws.count; k++) {
    const strut_law_switch *law = &stepper->laws.item[k];
    const uint32_t *at = ends_of(stepper, k);
    const double *r = ahead_of(stepper, k);
    span s = span_of(stepper, k, positions, velocity, 1.0);
    bool is_short = s.length <= nothing(model, stepper, k);
    if (law->guide || !(is_short || is_behind(r, &s))) continue;
    double pull = force_at_nothing(model, state, stepper, k, positions);
    double push[2] = {2.0 * pull * r[0], 2.0 * pull * r[1]}, u[2] = {0.0, 0.0};
    if (is_short) { /* without a length the damper has no direction either */
      const strut_element *element = strut_element_of_member(&model->elements, law->member);
      double damping = model->members.damping[law->member] + (element ? element->damping : 0.0);
      if (s.length > 0.0) u[0] = s.x / s.length, u[1] = s.y / s.length;
      double ahead = pull + damping * along(r, s.dx, s.dy);
      double own = pull + damping * along(u, s.dx, s.dy);
      for (int c = 0; c < 2; c++) push[c] = ahead * r[c] - own * u[c];
    }
    for (uint32_t c = 0; c < 2; c++) force[at[0] + c] += push[c], force[at[1] + c] -= push[c];
  }
}

/* ---- the event ---- */

/* The step from now to next: how far ahead the second node is at both ends, and its change over the step. */
typedef struct course {
  span a, b;
  double g[2], rate[2];
  double at, length; /* the part of the step from which it is behind, or 0; the length there [m] */
} course;

static course course_of(const strut_event_stepper *stepper, int32_t k, double h) {
  const double *r = ahead_of(stepper, k);
  course c = {.a = span_of(stepper, k, stepper->now->q, stepper->now->v, h),
              .b = span_of(stepper, k, stepper->next->q, stepper->next->v, h)};
  c.g[0] = along(r, c.a.x, c.a.y), c.g[1] = along(r, c.b.x, c.b.y);
  c.rate[0] = along(r, c.a.dx, c.a.dy), c.rate[1] = along(r, c.b.dx, c.b.dy);
  if (!(c.g[0] > 0.0 && is_behind(r, &c.b))) return c;
  double x = c.at = strut_event_cubic_root(c.g[0], c.rate[0], c.g[1], c.rate[1]), y = 1.0 - x;
  double a = y * y * (1.0 + 2.0 * x), b = 1.0 - a, da = x * y * y, db = -x * x * y;
  c.length = hypot(a * c.a.x + b * c.b.x + da * c.a.dx + db * c.b.dx,
                   a * c.a.y + b * c.b.y + da * c.a.dy + db * c.b.dy);
  return c;
}

/* May the step be cut once more? */
static bool may_cut(const strut_event_stepper *stepper) {
  return stepper->formula->adaptive || stepper->turns.pieces < MOST_PIECES;
}

/* Do the nodes miss each other by too little for a shorter step? */
static bool is_narrow(const strut_model *model, const strut_event_stepper *stepper, int32_t k,
                      const course *self) {
  return self->length <= nothing(model, stepper, k) || !may_cut(stepper);
}

bool strut_turn_passes(const strut_model *model, const strut_event_stepper *stepper, int32_t k,
                       double h) {
  course c = course_of(stepper, k, h);
  if (c.at > 0.0) return is_narrow(model, stepper, k, &c);
  return !(c.g[0] > 0.0) && c.g[1] < c.g[0];
}

double strut_turn_between(const strut_model *model, const strut_event_stepper *stepper, int32_t k,
                          double h) {
  course c = course_of(stepper, k, h);
  double least = nothing(model, stepper, k), shorter = fmin(c.a.length, c.b.length);
  double way = hypot(c.b.x - c.a.x, c.b.y - c.a.y), across = c.a.x * c.b.y - c.a.y * c.b.x;
  double both = c.a.length * c.b.length;
  if (c.at > 0.0) return is_narrow(model, stepper, k, &c) ? 0.0 : 0.5 * c.at;
  if (!stepper->formula->adaptive && may_cut(stepper) && shorter > least &&
      way > COARSE * shorter && across * across > STRAIGHT * both * both)
    return PART * shorter / way;
  return strut_event_dip(c.g[0], c.rate[0], c.g[1], c.rate[1], least);
}

void strut_turn_round(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                      int32_t k, double t) {
  const strut_law_switch *law = &stepper->laws.item[k];
  const strut_step_end *now = stepper->now;
  span s = span_of(stepper, k, now->q, now->v, 1.0);
  double *r = ahead_of(stepper, k);
  r[0] = -r[0], r[1] = -r[1];
  point(&s, true, r);
  strut_turns_measure(stepper, now);
  stepper->fresh = false;
  if (!law->guide ||
      !(strut_member_elastic_tension(model, state->latest->rest, law->member, now->q) > 0.0))
    return;
  state->trouble = STRUT_FAILURE_GUIDE;
  state->trouble_node =
      strut_element_of_member(&model->elements, law->member)->first + law->guide - 1;
  state->trouble_time = t + state->time_offset;
}
