/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Members that shrink to nothing. Their nodes pass one another, and the force, which has a direction still, turns round:
 * a step ends there, and in the step itself the force goes on as before. Beyond a guide it would pull the wrong way, so
 * that a run ends there.
 *
 * Nobody asks a member that cannot get there within a step. Whether one can is looked up when the shortest time in which
 * one could, by its length, speed and acceleration, has gone.
 */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/integrate/events/event_kernel.h"

enum { LONGEST_REST = 200 };         /* grid steps between two looks */
static const double CLOSE = 1e-6;    /* of the size: an end so near to a guide is at it */
static const double CAUTION = 0.125; /* of the time in which a member could shrink to nothing */
static const double COARSE = 0.5; /* a way beside a length, of which fixed steps see too little, */
static const double STRAIGHT =
    2e-4;                       /* unless the square of the sine by which it turns is below this */
static const double PART = 0.4; /* of that length, to which the step is cut */

/* From the first node to the second at an end of a step, and its change over the step at that rate. */
typedef struct span {
  double x, y, dx, dy, length;
} span;

static double along(const double *r, double x, double y) { return r[0] * x + r[1] * y; }

static span span_at(const uint32_t *at, const double *q, const double *v, double h) {
  double x = q[at[1]] - q[at[0]], y = q[at[1] + 1] - q[at[0] + 1];
  return (span){x, y, h * (v[at[1]] - v[at[0]]), h * (v[at[1] + 1] - v[at[0] + 1]),
                sqrt(x * x + y * y)};
}

static const uint32_t *ends_of(const strut_event_stepper *stepper, int32_t k) {
  return stepper->turns.ends + 2 * (k - stepper->turns.first);
}

static double *ahead_of(const strut_event_stepper *stepper, int32_t k) {
  return stepper->turns.ahead + 2 * (k - stepper->turns.first);
}

/* Lengths below this have no direction [m]. */
static double nothing(const strut_model *model, const strut_event_stepper *stepper, int32_t k) {
  double faint = strut_faint_length(model, stepper);
  return stepper->laws.item[k].guide ? fmax(faint, CLOSE * model->size) : faint;
}

/* ---- what may turn round ---- */

/* Has the force of member j, which is straight, a direction where it has no length? */
static bool pushes_at_nothing(const strut_model *model, int32_t j) {
  const strut_element *e = strut_element_of_member(&model->elements, j);
  bool plain = model->members.stiffness[j] > 0.0 &&
               (model->members.rest[j] != 0.0 || model->terms & STRUT_TERM_DRIVE);
  if (e && e->strain != STRUT_STRAIN_LENGTH) return false;
  if (model->terms & STRUT_TERM_ACTUATOR_FORCES) return true;
  return model->scene->members[j].kind != STRUT_CABLE ? plain || e : e && e->sibling >= 0;
}

static void list(strut_law_switch *item, uint32_t *ends, int32_t *count, strut_law_switch law,
                 const uint32_t *at) {
  law.event = STRUT_EVENT_TURN;
  if (item) item[*count] = law, ends[2 * *count] = at[0], ends[2 * *count + 1] = at[1];
  ++*count;
}

int32_t strut_turns_list(const strut_model *model, strut_law_switch *item, uint32_t *ends) {
  const strut_element_table *t = &model->elements;
  int32_t count = 0;
  for (int32_t j = 0; j < model->members.count; j++) {
    const uint32_t at[2] = {model->members.from[j], model->members.to[j]};
    if (pushes_at_nothing(model, j))
      list(item, ends, &count, (strut_law_switch){.member = j, .element = -1}, at);
  }
  for (int32_t i = 0; i < t->count; i++) {
    const strut_element *e = &t->element[i];
    bool balls = e->role == STRUT_ELEMENT_COLLISION && e->strain == STRUT_STRAIN_LENGTH;
    for (int32_t k = 0; balls && !t->scattered && k < 1; k++)
      list(item, ends, &count, (strut_law_switch){.member = -1, .element = i}, t->at + e->first);
    for (int32_t k = 0; e->strain == STRUT_STRAIN_PATH && k + 1 < e->nodes; k++)
      list(item, ends, &count, (strut_law_switch){.member = e->item, .element = i, .guide = k + 1},
           t->at + e->first + k);
  }
  return count;
}

/* ---- who looks, and when ---- */

static void measure(const strut_event_stepper *stepper, const strut_step_end *end, int32_t k) {
  span s = span_at(ends_of(stepper, k), end->q, end->v, 1.0);
  const double *r = ahead_of(stepper, k);
  end->stretch[k] = end->tension[k] = along(r, s.x, s.y);
  end->stretch_rate[k] = along(r, s.dx, s.dy);
}

void strut_turns_measure(const strut_event_stepper *stepper, const strut_step_end *end) {
  for (int32_t k = stepper->turns.first; k < stepper->laws.count; k++) measure(stepper, end, k);
}

/* The direction at an end, or of the way there where it has no length. */
static void find_ahead(const span *s, double least, double *r) {
  double way = hypot(s->dx, s->dy);
  if (s->length > least)
    r[0] = s->x / s->length, r[1] = s->y / s->length;
  else if (way > 0.0)
    r[0] = s->dx / way, r[1] = s->dy / way;
}

/* Does it turn within a step from a to b of which fixed steps see too little? */
static bool is_coarse(const strut_event_stepper *stepper, const span *a, const span *b,
                      double least) {
  double short_of = fmin(a->length, b->length), way = hypot(b->x - a->x, b->y - a->y);
  double across = a->x * b->y - a->y * b->x, both = a->length * b->length;
  return !stepper->formula->adaptive && short_of > least && way > COARSE * short_of &&
         across * across > STRAIGHT * both * both;
}

/* May it pass zero length between a and b, by the hull of the cubic between them? */
static bool may_turn(const double *r, const span *a, const span *b, double least) {
  double g[] = {along(r, a->x, a->y), along(r, a->x + a->dx / 3.0, a->y + a->dy / 3.0),
                along(r, b->x - b->dx / 3.0, b->y - b->dy / 3.0), along(r, b->x, b->y)};
  return fmin(fmin(g[0], g[1]), fmin(g[2], g[3])) <= least;
}

/* The time from the end of a step on, and before it, in which a member cannot shrink to nothing [s]. */
static double time_left(const uint32_t *at, const strut_step_end *end) {
  const double *q = end->q, *v = end->v, *a = end->a;
  uint32_t i = at[0], k = at[1];
  double x = q[k] - q[i], y = q[k + 1] - q[i + 1], u = v[k] - v[i], w = v[k + 1] - v[i + 1];
  double ax = a[k] - a[i], ay = a[k + 1] - a[i + 1];
  double length = CAUTION * sqrt(x * x + y * y), bend = length / sqrt(ax * ax + ay * ay);
  double straight = length / sqrt(u * u + w * w), square = straight * straight;
  return sqrt(square < bend ? square : bend > 0.0 ? bend : 0.0);
}

static void turn_on(strut_event_stepper *stepper, bool on) {
  stepper->turns.on = on;
  stepper->laws.count = stepper->turns.first + (on ? stepper->turns.count : 0);
  stepper->laws.nearby_made = 0;
}

/* May law k turn round in the step of h? It may begin at nothing, having turned. */
static bool is_near(const strut_model *model, const strut_event_stepper *stepper, int32_t k,
                    double h) {
  const uint32_t *at = ends_of(stepper, k);
  span a = span_at(at, stepper->now->q, stepper->now->v, h);
  span b = span_at(at, stepper->next->q, stepper->next->v, h);
  double least = nothing(model, stepper, k), *r = ahead_of(stepper, k);
  if (!stepper->turns.on) find_ahead(&a, least, r);
  return may_turn(r, &a, &b, least) || is_coarse(stepper, &a, &b, least);
}

void strut_turns_look(const strut_model *model, const strut_state *state,
                      strut_event_stepper *stepper, double h) {
  strut_turns *turns = &stepper->turns;
  bool was = turns->on, near = false;
  double least = LONGEST_REST * stepper->control.longest;
  if (was && !turns->stepped) return;
  turns->stepped = false;
  for (int32_t k = 0; k < turns->count; k++) {
    double left = time_left(turns->ends + 2 * k, stepper->next);
    if (!(left >= least)) least = left;
    if (!(left > h)) near = is_near(model, stepper, turns->first + k, h) || near;
  }
  turns->due = state->step + (near ? 0 : (int64_t)(least / stepper->control.longest));
  if (near == was) return;
  for (int32_t k = turns->first; near && k < turns->first + turns->count; k++)
    is_near(model, stepper, k, h); /* finds their directions */
  turn_on(stepper, near);
  if (near) strut_turns_measure(stepper, stepper->now);
}

bool strut_turns_appear(const strut_model *model, const strut_state *state,
                        strut_event_stepper *stepper, double h) {
  bool was = stepper->turns.on, turned = false;
  strut_turns_look(model, state, stepper, h);
  if (was || !stepper->turns.on) return false;
  strut_turns_measure(stepper, stepper->next);
  for (int32_t k = stepper->turns.first; k < stepper->laws.count; k++)
    turned = turned || stepper->next->tension[k] < 0.0;
  return turned;
}

void strut_turns_keep(const strut_model *model, strut_event_stepper *stepper) {
  stepper->turns.stepped = true;
  for (int32_t k = stepper->turns.first; k < stepper->laws.count; k++) {
    span s = span_at(ends_of(stepper, k), stepper->now->q, stepper->now->v, 1.0);
    double *r = ahead_of(stepper, k), least = nothing(model, stepper, k);
    if (s.length > least && along(r, s.x, s.y) > 0.0) find_ahead(&s, least, r);
    measure(stepper, stepper->now, k);
  }
}

/* ---- forces ---- */

/* Force of a straight member or of two balls where they have no length, tension positive [N]. */
static double force_at_nothing(const strut_model *model, const strut_state *state,
                               const strut_event_stepper *stepper, int32_t k, const double *q) {
  const strut_law_switch *law = &stepper->laws.item[k];
  const uint32_t *at = ends_of(stepper, k);
  const double *rest = state->latest->rest;
  double *there = stepper->middle, force;
  memcpy(there, q, (size_t)model->length * sizeof *q);
  there[at[1]] = there[at[0]], there[at[1] + 1] = there[at[0] + 1];
  if (law->member >= 0) {
    force = strut_member_elastic_tension(model, rest, law->member, there) +
            strut_actuator_force_on(model, state, law->member, -1);
  } else {
    strut_element_pose pose;
    strut_element_evaluate(model, law->element, rest, there, (double)NAN, &pose);
    force = pose.force;
  }
  return isfinite(force) ? force : 0.0;
}

/* Damping along it, where no length gives the damper a direction [N s/m]. */
static double damping_of(const strut_model *model, const strut_law_switch *law) {
  const strut_element *e = law->element >= 0
                               ? &model->elements.element[law->element]
                               : strut_element_of_member(&model->elements, law->member);
  return (law->member >= 0 ? model->members.damping[law->member] : 0.0) + (e ? e->damping : 0.0);
}

void strut_turns_hold(const strut_model *model, const strut_state *state,
                      const strut_event_stepper *stepper, const double *q, const double *v) {
  double *force = state->latest->force;
  for (int32_t k = stepper->turns.first; k < stepper->laws.count; k++) {
    if (stepper->laws.item[k].guide) continue;
    const uint32_t *at = ends_of(stepper, k);
    const double *r = ahead_of(stepper, k);
    span s = span_at(at, q, v, 1.0);
    bool tiny = s.length <= nothing(model, stepper, k);
    if (!tiny && !(along(r, s.x, s.y) < 0.0)) continue;
    double pull = force_at_nothing(model, state, stepper, k, q), x = 2.0 * pull * r[0],
           y = 2.0 * pull * r[1];
    if (tiny) {
      double inverse = s.length > 0.0 ? 1.0 / s.length : 0.0,
             damping = damping_of(model, &stepper->laws.item[k]);
      const double u[2] = {inverse * s.x, inverse * s.y};
      double ahead = pull + damping * along(r, s.dx, s.dy),
             own = pull + damping * along(u, s.dx, s.dy);
      x = ahead * r[0] - own * u[0], y = ahead * r[1] - own * u[1];
    }
    force[at[0]] += x, force[at[0] + 1] += y;
    force[at[1]] -= x, force[at[1] + 1] -= y;
  }
}

/* ---- the event ---- */

/* The step from now to next, h apart. */
typedef struct course {
  span a, b;
  double g[2],
      rate[2];   /* how far ahead the second node is at both ends, and its change over the step */
  double at;     /* the part of the step where it is no longer, if that is so at the end */
  double length; /* there [m] */
} course;

static course course_of(const strut_event_stepper *stepper, int32_t k, double h) {
  const uint32_t *at = ends_of(stepper, k);
  const double *r = ahead_of(stepper, k);
  course c = {.a = span_at(at, stepper->now->q, stepper->now->v, h),
              .b = span_at(at, stepper->next->q, stepper->next->v, h)};
  c.g[0] = along(r, c.a.x, c.a.y), c.g[1] = along(r, c.b.x, c.b.y);
  c.rate[0] = along(r, c.a.dx, c.a.dy), c.rate[1] = along(r, c.b.dx, c.b.dy);
  if (!(c.g[0] > 0.0 && c.g[1] < 0.0)) return c;
  double x = c.at = strut_event_cubic_root(c.g[0], c.rate[0], c.g[1], c.rate[1]), y = 1.0 - x;
  double a = y * y * (1.0 + 2.0 * x), b = 1.0 - a, da = x * y * y, db = -x * x * y;
  c.length = hypot(a * c.a.x + b * c.b.x + da * c.a.dx + db * c.b.dx,
                   a * c.a.y + b * c.b.y + da * c.a.dy + db * c.b.dy);
  return c;
}

bool strut_turn_passes(const strut_model *model, const strut_event_stepper *stepper, int32_t k,
                       double h) {
  course c = course_of(stepper, k, h);
  return c.at > 0.0 ? c.length <= nothing(model, stepper, k) : c.g[1] < c.g[0];
}

double strut_turn_between(const strut_model *model, const strut_event_stepper *stepper, int32_t k,
                          double h) {
  course c = course_of(stepper, k, h);
  double least = nothing(model, stepper, k);
  if (c.at > 0.0) return c.length > least ? 0.5 * c.at : 0.0;
  if (c.g[0] > least && is_coarse(stepper, &c.a, &c.b, least))
    return PART * c.a.length / hypot(c.b.x - c.a.x, c.b.y - c.a.y);
  return strut_event_dip(c.g[0], c.rate[0], c.g[1], c.rate[1], least);
}

void strut_turn_round(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                      int32_t k, double t) {
  const strut_law_switch *law = &stepper->laws.item[k];
  span s = span_at(ends_of(stepper, k), stepper->now->q, stepper->now->v, 1.0);
  double *r = ahead_of(stepper, k);
  if (law->guide && strut_member_elastic_tension(model, state->latest->rest, law->member,
                                                 stepper->now->q) > 0.0) {
    state->trouble = STRUT_FAILURE_GUIDE;
    state->trouble_node = model->elements.element[law->element].first + law->guide - 1;
    state->trouble_time = t + state->time_offset;
  }
  r[0] = -r[0], r[1] = -r[1];
  s.length = 0.0;
  find_ahead(&s, 0.0, r);
  measure(stepper, stepper->now, k);
  stepper->fresh = false;
}
