/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What happens within a step although its ends do not show it. Between them each node is taken to move along the cubic
 * through its positions and velocities. Gaps above level ground, and speeds, are cubics too, whose lowest point is
 * known. Of lengths, distances, angles and areas the speeds of the nodes bound the rate, and for lengths and distances
 * their accelerations the second derivative: a part of the step in which these bounds leave no room for a change of mode
 * has none, and any other part is halved.
 */
#include <assert.h>
#include <math.h>

#include "engine/forces/nearby.h"
#include "engine/forces/strains/strains.h"
#include "engine/integrate/events/event_kernel.h"

/* Parts of the step at most, of one law: beyond it what is left is taken to hold its mode. */
enum { MOST_PARTS = 400, MOST_DEPTH = 48 };

double strut_event_dip(double g0, double d0, double g1, double d1, double faint) {
  if (!(g0 + d0 / 3.0 < -faint || g1 - d1 / 3.0 < -faint)) return 0.0; /* it is within their hull */
  /* slope: d0 + 2 b x + 3 c x^2, which passes 0 upwards once */
  double rise = g1 - g0, b = 3.0 * rise - 2.0 * d0 - d1, c = d0 + d1 - 2.0 * rise;
  double inside = b * b - 3.0 * c * d0, root = sqrt(fmax(0.0, inside));
  double x = b > 0.0 ? -d0 / (b + root) : (root - b) / (3.0 * c);
  if (!(inside >= 0.0 && x > 0.0 && x < 1.0)) return 0.0;
  return g0 + x * (d0 + x * (b + x * c)) < -faint ? x : 0.0;
}

/* A coordinate over a step: Bernstein coefficients of its cubic. */
typedef struct cubic {
  double c[4];
} cubic;

static cubic cubic_of(double q0, double v0, double q1, double v1, double h) {
  return (cubic){{q0, q0 + h * v0 / 3.0, q1 - h * v1 / 3.0, q1}};
}

static double cubic_at(const cubic *self, double x) {
  double r = 1.0 - x;
  return r * r * (r * self->c[0] + 3.0 * x * self->c[1]) +
         x * x * (3.0 * r * self->c[2] + x * self->c[3]);
}

/* The largest first and second derivatives of a vector over a step, by the differences of its coefficients. */
typedef struct swiftness {
  double rate, bend;
} swiftness;

static swiftness swiftness_of(const cubic *self, const cubic *other_self) {
  swiftness most = {0};
  for (int k = 0; k < 3; k++) {
    double dx = self->c[k + 1] - self->c[k], dy = other_self->c[k + 1] - other_self->c[k];
    most.rate = fmax(most.rate, 9.0 * (dx * dx + dy * dy));
  }
  for (int k = 0; k < 2; k++) {
    double dx = self->c[k + 2] - 2.0 * self->c[k + 1] + self->c[k];
    double dy = other_self->c[k + 2] - 2.0 * other_self->c[k + 1] + other_self->c[k];
    most.bend = fmax(most.bend, 36.0 * (dx * dx + dy * dy));
  }
  return (swiftness){sqrt(most.rate), sqrt(most.bend)};
}

/* A strain over a step. */
typedef struct course {
  const strut_model *model;
  int32_t element; /* -1: a plain member */
  strut_strain_kind strain;
  int32_t nodes;
  const uint32_t *at;
  uint32_t ends[2]; /* of a member */
  double turn;
  cubic place[STRUT_MOST_GRADIENT]; /* (nodes, 2) */
  swiftness own;                    /* of the first node */
  swiftness
      apart[STRUT_MOST_ELEMENT_NODES]; /* of each node beside the one before it, but the first */
  cubic natural;
  swiftness natural_most;
  double *q; /* (length) scratch */
} course;

static void place_nodes(const course *self, double x) {
  for (int32_t k = 0; k < 2 * self->nodes; k++)
    self->q[self->at[k / 2] + (uint32_t)(k % 2)] = cubic_at(&self->place[k], x);
}

static double strain_at(const course *self, double x, double *b) {
  place_nodes(self, x);
  if (self->element >= 0)
    return strut_element_strain(self->model, self->element, self->q, self->turn, b);
  return strut_strain_length(self->at, 2, self->q, 0.0, b);
}

static double distance_of(const course *self, int32_t i, int32_t k) {
  const double *a = self->q + self->at[i], *b = self->q + self->at[k];
  return hypot(b[0] - a[0], b[1] - a[1]);
}

/* The largest speed of node k beside the first node. */
static double rate_beside_first(const course *self, int32_t k) {
  double sum = 0.0;
  for (int32_t n = 1; n <= k; n++) sum += self->apart[n].rate;
  return sum;
}

/* Bounds of a strain's derivatives less than `half` of the step before and after the nodes stand as in c->q. */
static swiftness bounds_of(const course *self, double half) {
  const strut_element *element =
      self->element >= 0 ? &self->model->elements.element[self->element] : NULL;
  const swiftness *apart = self->apart;
  swiftness most = {0.0, HUGE_VAL};
  switch (self->strain) {
    case STRUT_STRAIN_LENGTH:
    case STRUT_STRAIN_PATH:
      most.bend = 0.0;
      for (int32_t k = 1; k < self->nodes; k++) {
        double least = distance_of(self, k - 1, k) - apart[k].rate * half;
        most.rate += apart[k].rate;
        most.bend += least > 0.0 ? apart[k].rate * apart[k].rate / least + apart[k].bend : HUGE_VAL;
      }
      break;
    case STRUT_STRAIN_WRAP:
      for (int32_t k = 1; k < self->nodes; k++) most.rate += apart[k].rate;
      break;
    case STRUT_STRAIN_ALONG: most = apart[1]; break;
    case STRUT_STRAIN_REACH: most.rate = apart[1].rate + apart[2].rate; break;
    case STRUT_STRAIN_ANGLE:
      for (int32_t k = 1; k <= 2; k++)
        most.rate += apart[k].rate / fmax(0.0, distance_of(self, k - 1, k) - apart[k].rate * half);
      break;
    case STRUT_STRAIN_OFFSET: {
      double length = distance_of(self, 1, 2) - apart[2].rate * half;
      double arm = distance_of(self, 0, 1) + apart[1].rate * half;
      most.rate = apart[1].rate + apart[2].rate * (1.0 + arm / fmax(0.0, length));
      break;
    }
    case STRUT_STRAIN_FOOT:
      most.rate = self->own.rate;
      if (self->nodes > 1)
        most.rate += element->radius * apart[1].rate /
                     fmax(0.0, distance_of(self, 0, 1) - apart[1].rate * half);
      break;
    case STRUT_STRAIN_AREA: /* triangles at the first node */
      for (int32_t k = 1; k + 1 < self->nodes; k++) {
        double turns = rate_beside_first(self, k), grows = apart[k + 1].rate;
        double arm = distance_of(self, 0, k) + turns * half;
        double side = distance_of(self, k, k + 1) + grows * half;
        most.rate += 0.5 * (turns * side + arm * grows);
      }
      break;
    case STRUT_STRAIN_COUNT: break;
  }
  return most;
}

/* A margin within the step, above 0 at both ends, and bounds of its derivatives within `half` of x. */
typedef struct margin {
  double (*value)(const struct margin *of, double x);
  swiftness (*bounds)(const struct margin *of, double x, double half);
  const void *course;
  double sign, kink; /* of a strain: sign (strain - natural strain - kink) */
} margin;

/* Where in the step, if before `until`, the margin is below -faint; 0: nowhere. */
static double first_below(const margin *self, double faint, double until) {
  struct {
    double x, value;
  } end[MOST_DEPTH + 1];
  double from = 0.0, before = self->value(self, 0.0);
  int depth = 0;
  end[0].x = until, end[0].value = self->value(self, until);
  if (until < 1.0 && end[0].value < -faint) return until;
  for (int parts = 0; depth >= 0; parts++) {
    double to = end[depth].x, after = end[depth].value, width = to - from;
    swiftness most = self->bounds(self, 0.5 * (from + to), 0.5 * width);
    bool above = 0.5 * (before + after - most.rate * width) >= -faint ||
                 fmin(before, after) - 0.125 * most.bend * width * width >= -faint;
    if (above || depth == MOST_DEPTH || parts >= MOST_PARTS) {
      from = to, before = after, depth--;
      continue;
    }
    end[++depth].x = 0.5 * (from + to);
    end[depth].value = self->value(self, end[depth].x);
    if (end[depth].value < -faint) return end[depth].x;
  }
  return 0.0;
}

static double strain_margin(const margin *self, double x) {
  const course *c = self->course;
  double b[STRUT_MOST_GRADIENT];
  return self->sign * (strain_at(c, x, b) - cubic_at(&c->natural, x) - self->kink);
}

/*
 * A distance from a segment is the least of the distances from its points, of which only those are of interest that are
 * at least the kink plus the natural strain.
 */
static swiftness strain_bounds(const margin *self, double x, double half) {
  const course *c = self->course;
  place_nodes(c, x);
  swiftness most = bounds_of(c, half);
  if (c->strain == STRUT_STRAIN_REACH && self->sign > 0.0) {
    double least = self->kink + fmin(c->natural.c[0], c->natural.c[3]);
    double bend = c->apart[1].bend + c->apart[2].bend;
    most.bend = least > 0.0 ? most.rate * most.rate / least + bend : HUGE_VAL;
  }
  return (swiftness){most.rate + c->natural_most.rate, most.bend + c->natural_most.bend};
}

static margin margin_of(const course *self, double sign, double kink) {
  return (margin){strain_margin, strain_bounds, self, sign, kink};
}

/* The nodes of an element or a member between the ends of the stepper's step. */
static void begin_course(const strut_event_stepper *stepper, double h, course *self) {
  const strut_step_end *now = stepper->now, *next = stepper->next;
  for (int32_t k = 0; k < 2 * self->nodes; k++) {
    uint32_t i = self->at[k / 2] + (uint32_t)(k % 2);
    self->place[k] = cubic_of(now->q[i], now->v[i], next->q[i], next->v[i], h);
  }
  self->own = swiftness_of(&self->place[0], &self->place[1]);
  for (int32_t k = 1; k < self->nodes; k++) {
    cubic way[2];
    for (int32_t n = 0; n < 2; n++)
      for (int p = 0; p < 4; p++)
        way[n].c[p] = self->place[2 * k + n].c[p] - self->place[2 * k - 2 + n].c[p];
    self->apart[k] = swiftness_of(&way[0], &way[1]);
  }
}

/* The natural strain over the step, from stretch and rate of it at both ends. */
static void begin_natural(const strut_event_stepper *stepper, double h, const double stretch[2],
                          const double rate[2], course *self) {
  const strut_step_end *ends[2] = {stepper->now, stepper->next};
  double natural[2], natural_rate[2], b[STRUT_MOST_GRADIENT];
  for (int n = 0; n < 2; n++) {
    natural[n] = strain_at(self, n, b) - stretch[n];
    natural_rate[n] = -rate[n];
    for (int32_t k = 0; k < 2 * self->nodes; k++)
      natural_rate[n] += b[k] * ends[n]->v[self->at[k / 2] + (uint32_t)(k % 2)];
  }
  self->natural = cubic_of(natural[0], natural_rate[0], natural[1], natural_rate[1], h);
  self->natural_most = swiftness_of(&self->natural, &(cubic){{0}});
}

static void begin_element(const strut_model *model, const strut_state *state,
                          const strut_event_stepper *stepper, int32_t element, double h,
                          course *self) {
  const strut_element *e = &model->elements.element[element];
  self->model = model, self->q = stepper->middle;
  self->element = element;
  self->strain = e->strain, self->nodes = e->nodes, self->at = model->elements.at + e->first;
  self->turn = state->history.turn[element];
  begin_course(stepper, h, self);
}

/* That of law k, which has been measured at both ends. */
static void begin_law(const strut_model *model, const strut_state *state,
                      const strut_event_stepper *stepper, int32_t k, double h, course *self) {
  const strut_law_switch *law = &stepper->laws.item[k];
  double sign = 1.0;
  if (law->element >= 0) {
    begin_element(model, state, stepper, law->element, h, self);
    if (law->event == STRUT_EVENT_ACTS) sign = model->elements.element[law->element].carries;
  } else {
    self->model = model, self->q = stepper->middle;
    self->element = -1;
    self->strain = STRUT_STRAIN_LENGTH, self->nodes = 2, self->at = self->ends;
    self->ends[0] = model->members.from[law->member],
    self->ends[1] = model->members.to[law->member];
    begin_course(stepper, h, self);
  }
  const double stretch[2] = {sign * stepper->now->stretch[k], sign * stepper->next->stretch[k]};
  const double rate[2] = {sign * stepper->now->stretch_rate[k],
                          sign * stepper->next->stretch_rate[k]};
  begin_natural(stepper, h, stretch, rate, self);
}

/*
 * Where a law acts within the step but at neither end: its strain passes the kink, at a speed at which the damper pulls
 * too, and by the end the damper outweighs it. 0: nowhere.
 */
static double short_pull(const strut_event_stepper *stepper, int32_t k, double h, double faint) {
  double from = -stepper->now->stretch[k], to = stepper->next->stretch[k];
  if (stepper->laws.acting[k] || !(from > 0.0 && to > faint && stepper->next->tension[k] < 0.0))
    return 0.0;
  double at = strut_event_cubic_root(from, -h * stepper->now->stretch_rate[k], -to,
                                     -h * stepper->next->stretch_rate[k]);
  return at + SOON * (1.0 - at);
}

/* Strains that change no faster than the distances of their nodes do. */
static bool is_of_distances(strut_strain_kind strain) {
  return strain == STRUT_STRAIN_LENGTH || strain == STRUT_STRAIN_PATH ||
         strain == STRUT_STRAIN_WRAP || strain == STRUT_STRAIN_REACH ||
         strain == STRUT_STRAIN_ALONG;
}

/* The faint length as a strain of an element: an angle and an area have other units. */
static double faint_strain(const strut_model *model, strut_strain_kind strain, double length) {
  if (strain == STRUT_STRAIN_ANGLE) return length / model->size;
  return strain == STRUT_STRAIN_AREA ? length * model->size : length;
}

/* Is the law too far from leaving its mode, for nodes of which none goes further than `way`? */
static bool is_far(const strut_model *model, const strut_event_stepper *stepper, int32_t k,
                   double h, double way) {
  int32_t element = stepper->laws.item[k].element;
  const strut_element *e = element >= 0 ? &model->elements.element[element] : NULL;
  if (e && !is_of_distances(e->strain)) return false;
  const strut_step_end *now = stepper->now, *next = stepper->next;
  double from = fabs(now->stretch[k]), to = fabs(next->stretch[k]);
  double rate = fabs(now->stretch_rate[k]) + fabs(next->stretch_rate[k]);
  double most = 16.0 * (e ? e->nodes - 1 : 1) * way + h * rate + 3.0 * fabs(to - from);
  return now->stretch[k] * next->stretch[k] > 0.0 && from + to > most;
}

/* Where the law leaves its mode within the step though it has it at both ends; 0: nowhere before `until`. */
static double law_leaves(const strut_model *model, const strut_state *state,
                         const strut_event_stepper *stepper, int32_t k, double h, double length,
                         double until) {
  const strut_law_switch *law = &stepper->laws.item[k];
  const strut_element *element = law->element >= 0 ? &model->elements.element[law->element] : NULL;
  double from = stepper->now->stretch[k], to = stepper->next->stretch[k], at = 0.0;
  course c;
  if (!isfinite(from) || !isfinite(to)) return 0.0;
  begin_law(model, state, stepper, k, h, &c);
  double faint = faint_strain(model, c.strain, length);
  if (law->event == STRUT_EVENT_ACTS) {
    double side = stepper->laws.acting[k] ? 1.0 : -1.0;
    if (!(side * from > 0.0 && side * to > 0.0)) return short_pull(stepper, k, h, faint);
    const margin m = margin_of(&c, side * (element && !law->whole ? element->carries : 1.0), 0.0);
    return first_below(&m, faint, until);
  }
  int piece = state->modes.element_piece[law->element];
  double way = strut_law_way(element->law, &element->numbers, piece), low[2], high[2];
  strut_law_margins(element->law, &element->numbers, piece, from, &low[0], &high[0]);
  strut_law_margins(element->law, &element->numbers, piece, to, &low[1], &high[1]);
  if (low[0] > 0.0 && low[1] > 0.0 && low[0] < HUGE_VAL) {
    const margin m = margin_of(&c, way, strut_law_kink(element->law, &element->numbers, piece - 1));
    at = first_below(&m, faint, until);
  }
  if (high[0] > 0.0 && high[1] > 0.0 && high[0] < HUGE_VAL) {
    const margin m = margin_of(&c, -way, strut_law_kink(element->law, &element->numbers, piece));
    at = earlier(at, first_below(&m, faint, until));
  }
  return at;
}

/* Where bodies meet within the step that are apart at both ends and in no list of bodies nearby. */
static double strangers_meet(const strut_model *model, const strut_state *state,
                             const strut_event_stepper *stepper, double h, double faint) {
  double first = 0.0;
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *element = &model->elements.element[i];
    if (element->role != STRUT_ELEMENT_COLLISION) continue;
    course c;
    begin_element(model, state, stepper, i, h, &c);
    c.natural = cubic_of(element->natural, 0.0, element->natural, 0.0, h);
    c.natural_most = (swiftness){0};
    const margin m = margin_of(&c, 1.0, 0.0);
    if (strain_margin(&m, 0.0) > 0.0 && strain_margin(&m, 1.0) > 0.0)
      first = earlier(first, first_below(&m, faint, first > 0.0 ? first : 1.0));
  }
  return first;
}

/* The longest way of a node within the step, at most [m]. */
static double longest_way(const strut_model *model, const strut_event_stepper *stepper, double h) {
  const strut_step_end *now = stepper->now, *next = stepper->next;
  double most = 0.0;
  for (int32_t i = 0; i < 2 * model->node_count; i += 2) {
    cubic x = cubic_of(now->q[i], now->v[i], next->q[i], next->v[i], h);
    cubic y = cubic_of(now->q[i + 1], now->v[i + 1], next->q[i + 1], next->v[i + 1], h);
    most = fmax(most, swiftness_of(&x, &y).rate);
  }
  return most;
}

/* Where a sensor is beyond a threshold within the step, as far as its rates at both ends say; 0: nowhere. */
static double threshold_dip(const strut_event_stepper *stepper, int32_t k, double h) {
  double from = stepper->now->tension[k], to = stepper->next->tension[k];
  double falls = h * stepper->now->stretch_rate[k], rises = h * stepper->next->stretch_rate[k];
  return from > 0.0 && to > 0.0 ? strut_event_dip(from, falls, to, rises, 1e-9 * (from + to)) : 0.0;
}

/* Earliest point, within the step, where a law is not in the mode that it has at both ends; 0: none. */
static double earliest_switch(const strut_model *model, const strut_state *state,
                              strut_event_stepper *stepper, double h, double faint) {
  double first = 0.0, way = longest_way(model, stepper, h);
  bool strangers =
      stepper->laws.nearby && !strut_nearby_around(model, state, stepper->next->q, way);
  int32_t count = strut_laws_of(&stepper->laws);
  for (int32_t n = 0; n < count; n++) {
    int32_t k = strut_law_of(&stepper->laws, n);
    const strut_law_switch *law = &stepper->laws.item[k];
    if (law->event == STRUT_EVENT_THRESHOLD) first = earlier(first, threshold_dip(stepper, k, h));
    if (law->event == STRUT_EVENT_TURN)
      first = earlier(first, strut_turn_between(model, stepper, k, h));
    if (law->event != STRUT_EVENT_ACTS && law->event != STRUT_EVENT_KINK) continue;
    if (law->event == STRUT_EVENT_ACTS && is_far(model, stepper, k, h, way)) continue;
    first =
        earlier(first, law_leaves(model, state, stepper, k, h, faint, first > 0.0 ? first : 1.0));
  }
  return strangers ? earlier(first, strangers_meet(model, state, stepper, h, faint)) : first;
}

/* ---- contacts with the ground ---- */

/* Lowest point, within the step, of the slip left to closed contact i, of what is left to the edge of its band, or of
   its speed into the ground, where that passes 0 twice; 0: none. */
static double speed_dip(const strut_event_stepper *stepper, int32_t i, double h, double to_slip,
                        double to_into, double faint) {
  const strut_touch *now = &stepper->now->touch[i], *next = &stepper->next->touch[i];
  double at = 0.0;
  double edge = stick_band_edge(&stepper->contacts.entry[i]), s = 0.0,
         bound = 0.0; /* s u is above it */
  switch ((strut_contact_mode)stepper->modes.of[i]) {
    case STRUT_MODE_SLIP: s = stepper->modes.side[i], bound = edge; break;
    case STRUT_MODE_BAND:
    case STRUT_MODE_PUSH:
    case STRUT_MODE_YIELD: s = to_slip < 0.0 ? 1.0 : -1.0, bound = -edge; break;
    case STRUT_MODE_OPEN:
    case STRUT_MODE_SLIDE:
    case STRUT_MODE_STICK:
    case STRUT_MODE_CREEP: break;
  }
  double left = s * to_slip - bound;
  if (s != 0.0 && left > 0.0)
    at = strut_event_dip(s * now->slip - bound, s * h * now->slip_rate, left,
                         s * h * next->slip_rate, faint);
  double turns = -stepper->modes.damper[i], end = turns * to_into;
  if (end > 0.0)
    at = earlier(at, strut_event_dip(turns * now->into, turns * h * now->into_rate, end,
                                     turns * h * next->into_rate, faint));
  return at;
}

/* The node of an open contact of surfaces over a step, beside its ground, which stands as at the step's end. */
typedef struct approach {
  const strut_contact_table *contacts;
  const strut_event_stepper *stepper;
  int32_t contact;
  cubic way[2];
} approach;

static double gap_within(const margin *self, double x) {
  const approach *a = self->course;
  double *place = a->stepper->middle + a->contacts->at[a->contact];
  for (int n = 0; n < 2; n++) place[n] = cubic_at(&a->way[n], x);
  return strut_contact_pose_at(a->contacts, a->contact, a->stepper->middle,
                               a->stepper->next->motion, -1)
      .gap;
}

/* A gap changes no faster than its node moves beside the ground. */
static swiftness gap_bounds(const margin *self, double x, double half) {
  const approach *a = self->course;
  (void)x, (void)half;
  return (swiftness){swiftness_of(&a->way[0], &a->way[1]).rate, HUGE_VAL};
}

/* Where within the step open contact i, of surfaces, is closed; 0: nowhere. */
static double surface_dip(const strut_contact_table *contacts, const strut_event_stepper *stepper,
                          int32_t i, double h, double faint) {
  const strut_step_end *now = stepper->now, *next = stepper->next;
  if (!(gap_at_end(contacts, &stepper->modes, i, now, STRUT_TERMS_ALL) > 0.0 &&
        gap_at_end(contacts, &stepper->modes, i, next, STRUT_TERMS_ALL) > 0.0))
    return 0.0;
  const strut_ground_motion *from = strut_contact_motion(contacts, i, now->motion);
  const strut_ground_motion *to = strut_contact_motion(contacts, i, next->motion);
  approach a = {.contacts = contacts, .stepper = stepper, .contact = i};
  for (uint32_t n = 0; n < 2; n++) {
    uint32_t k = contacts->at[i] + n;
    double q0 = now->q[k], v0 = now->v[k], v1 = next->v[k];
    if (from) q0 += to->place[n] - from->place[n], v0 -= from->rate[n], v1 -= to->rate[n];
    a.way[n] = cubic_of(q0, v0, next->q[k], v1, h);
  }
  return first_below(&(margin){gap_within, gap_bounds, &a, 1.0, 0.0}, faint, 1.0);
}

/* The same of contact i with one straight ground, and where a closed one leaves it. */
static double gap_dip(const strut_contact_table *contacts, const strut_event_stepper *stepper,
                      int32_t i, double h, double faint) {
  const strut_step_end *now = stepper->now, *next = stepper->next;
  double side = stepper->modes.outward[i], turn = side * h;
  double from = side * strut_ground_gap(contacts, now->q + contacts->at[i]);
  double to = side * strut_ground_gap(contacts, next->q + contacts->at[i]);
  double falls = turn * strut_contact_along_normal(contacts, i, now->v);
  double rises = turn * strut_contact_along_normal(contacts, i, next->v);
  return from > 0.0 && to > 0.0 ? strut_event_dip(from, falls, to, rises, faint) : 0.0;
}

/* What is too small to matter: of lengths [m], of speeds [m/s]. */
typedef struct faintness {
  double length, speed;
} faintness;

/*
 * Earliest point, within the step, where a gap or speed is beyond an edge that it passes twice; 0: none. Methods that are
 * not exact do not see a dip of a gap of the size of their error.
 */
static double earliest_dip(const strut_model *model, const strut_state *state,
                           const strut_event_stepper *stepper, double h, faintness faint) {
  const strut_contact_table *contacts = &model->contacts;
  const strut_step_end *next = stepper->next;
  double first = 0.0;
  bool surfaces = frames_of(next, STRUT_TERMS_ALL), adaptive = stepper->formula->adaptive;
  int32_t count = surfaces ? strut_surface_candidates(model, stepper, h, state->buffers->near)
                           : contacts->count;
  for (int32_t k = 0; k < count; k++) {
    int32_t i = surfaces ? state->buffers->near[k] : k;
    bool open = stepper->modes.of[i] == STRUT_MODE_OPEN;
    double at = 0.0;
    if (!surfaces)
      at = gap_dip(contacts, stepper, i, h, faint.length);
    else if (open)
      at = surface_dip(contacts, stepper, i, h, faint.length);
    if (!open && adaptive) {
      strut_touch to; /* what is noted has been settled at the edges of bands */
      measure_at_end(contacts, &stepper->modes, next, i, STRUT_TERMS_ALL, &to);
      at = earlier(at, speed_dip(stepper, i, h, to.slip, to.into, faint.speed));
    }
    first = earlier(first, at);
  }
  return first;
}

static faintness faint_of(const strut_model *model, const strut_event_stepper *stepper, double h) {
  const strut_step_control *control = &stepper->control;
  return (faintness){strut_faint_length(model, stepper),
                     fmax(strut_faint_part(stepper) * control->speed, h * control->rounding)};
}

double strut_event_between(const strut_model *model, const strut_state *state,
                           strut_event_stepper *stepper, double h) {
  const faintness faint = faint_of(model, stepper, h);
  bool looks = stepper->formula->exact || model->contacts.surface;
  double first =
      looks && model->contacts.count ? earliest_dip(model, state, stepper, h, faint) : 0.0;
  return stepper->laws.count
             ? earlier(first, earliest_switch(model, state, stepper, h, faint.length))
             : first;
}
