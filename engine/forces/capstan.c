/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/capstan.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { MOST = STRUT_MOST_ELEMENT_NODES };

/* Tensions this close to a bound, relatively, are at it; those that stick are not beyond it by rounding. */
static const double AT_BOUND = 1e-9, ROUNDING = 1e-12;
/* Rounding of lengths and materials, as part of E. */
static const double LAST_BITS = 2e-14;
/* A turn by less is straight, whatever its sign [rad]. */
static const double STRAIGHT = 1e-13;

/* A cable at some positions: its segments, and the guides between segments k and k + 1. */
typedef struct cable {
  int n;                     /* segments */
  double ea, whole, winding; /* E [N], rest length [m] and its rate [m/s] */
  bool axial;                /* E stays where the rest length is driven */
  double friction;
  double length[MOST], x[MOST], y[MOST]; /* and direction */
  double turn[MOST], bend[MOST];         /* of the guide, with its sign and without */
  int side[MOST];                        /* that sign */
  double material[MOST], tension[MOST];
  double length_rate[MOST], turn_rate[MOST];
  double flow[MOST]; /* of material through the guide, towards the first node [m/s] */
  int mode[MOST];
} cable;

static void turn_at(cable *self, int k) {
  assert(k >= 0 && k + 1 < self->n);
  self->turn[k] = atan2(self->x[k] * self->y[k + 1] - self->y[k] * self->x[k + 1],
                        self->x[k] * self->x[k + 1] + self->y[k] * self->y[k + 1]);
  self->side[k] = self->turn[k] < 0.0 ? -1 : 1;
  self->bend[k] = fabs(self->turn[k]);
}

/* The angle continued through straight, from the side that is kept; at half a turn it turns back. */
static double bend_on_side(const cable *self, int k, int side) {
  assert(k >= 0 && k + 1 < self->n);
  double bend = side * self->turn[k];
  return bend < -1.5 ? self->bend[k] : bend;
}

/* material (segments): as it was at earlier positions. */
static void measure(const strut_model *model, const double *rest, const double *material, int32_t i,
                    const double *q, cable *self) {
  assert(i >= 0 && i < model->elements.count);
  const strut_element *element = &model->elements.element[i];
  const uint32_t *at = model->elements.at + element->first;
  double others = 0.0;
  self->n = element->nodes - 1;
  self->whole = rest[element->base];
  self->axial = element->law == STRUT_LAW_AXIAL;
  self->ea = self->axial ? element->numbers.axial : element->numbers.stiffness * self->whole;
  self->friction = element->guide_friction;
  for (int k = 0; k < self->n; k++) {
    double x = q[at[k + 1]] - q[at[k]], y = q[at[k + 1] + 1] - q[at[k] + 1];
    double length = sqrt(x * x + y * y), inverse = length > 0.0 ? 1.0 / length : 0.0;
    self->length[k] = length, self->x[k] = x * inverse, self->y[k] = y * inverse;
    self->material[k] = material[k];
    if (k) others += self->material[k];
  }
  for (int k = 0; k + 1 < self->n; k++) turn_at(self, k);
  if (self->material[0] < 0.0) return;
  self->material[0] = fmax(self->whole - others, 1e-12 * self->whole);
}

/* Equal tensions, where nothing is remembered. */
static void share_evenly(cable *self) {
  double sum = 0.0;
  for (int k = 0; k < self->n; k++) sum += self->length[k];
  for (int k = 0; k < self->n; k++)
    self->material[k] = sum > 0.0 ? self->whole * self->length[k] / sum : self->whole / self->n;
}

/* Ratio of the tension of segment k + 1 to that of k where guide k slips. */
static double ratio_at(const cable *self, int k) {
  assert(k >= 0 && k + 1 < self->n);
  return exp(-self->mode[k] * self->friction * self->bend[k]);
}

/* Tensions and materials of segments a .. b, all guides between which slip. */
static void solve_group(cable *self, int a, int b) {
  assert(a <= b);
  double ratio[MOST], sum = 0.0, material = 0.0, strain = 0.0;
  ratio[a] = 1.0;
  for (int k = a; k <= b; k++) {
    if (k > a) ratio[k] = ratio[k - 1] * ratio_at(self, k - 1);
    sum += self->length[k], material += self->material[k];
  }
  if (!(sum > material)) {
    for (int k = a; k <= b; k++) {
      if (b > a && sum > 0.0) self->material[k] = material * self->length[k] / sum;
      self->tension[k] = 0.0;
    }
    return;
  }
  /* the material that a strain of the first segment leaves is convex: Newton's method climbs */
  for (int turn = 0; turn < 60; turn++) {
    double value = -material, slope = 0.0;
    for (int k = a; k <= b; k++) {
      double inverse = 1.0 / (1.0 + ratio[k] * strain), part = self->length[k] * inverse;
      value += part, slope += part * ratio[k] * inverse;
    }
    double step = value / slope;
    strain += step;
    if (!(fabs(step) > 1e-16 * strain)) break;
  }
  for (int k = a; k <= b; k++) {
    self->tension[k] = self->ea * (ratio[k] * strain);
    if (b > a) self->material[k] = self->length[k] / (1.0 + ratio[k] * strain);
  }
}

static int group_end(const cable *self, int a) {
  assert(a >= 0 && a < self->n);
  while (a + 1 < self->n && self->mode[a] != STRUT_GUIDE_STICKS) a++;
  return a;
}

/* Tensions differ by finite factors, so that they end all at once: where the whole cable is slack. */
static bool is_slack(const cable *self) {
  double sum = 0.0;
  for (int k = 0; k < self->n; k++) sum += self->length[k];
  return !(sum > self->whole);
}

static void solve(cable *self) {
  if (is_slack(self)) {
    share_evenly(self);
    for (int k = 0; k < self->n; k++) self->tension[k] = 0.0;
    return;
  }
  for (int a = 0; a < self->n; a++) {
    int b = group_end(self, a);
    solve_group(self, a, b);
    a = b;
  }
}

/* How far the tensions at guide k are within their bounds, which are relaxed by `more`, on the worse side. */
static double room_at(const cable *self, int k, double more) {
  assert(k >= 0 && k + 1 < self->n);
  double bound = exp(self->friction * self->bend[k]) * (1.0 + more);
  double left = self->tension[k], right = self->tension[k + 1];
  double bits = more < 0.0 ? -LAST_BITS * self->ea : LAST_BITS * self->ea;
  return fmin(right * bound - left, left * bound - right) + bits;
}

/*
 * Modes, tensions and materials that follow from the materials as they are: guides that hold too much
 * slip, and those that would slip back stick, until all agree.
 */
static void settle(cable *self) {
  double before[MOST];
  memcpy(before, self->material, sizeof before);
  for (int k = 0; k < self->n; k++) self->mode[k] = STRUT_GUIDE_STICKS;
  if (is_slack(self)) {
    solve(self);
    return;
  }
  for (int turn = 0; turn < 8 * MOST; turn++) {
    double moved = 0.0;
    bool back = false, beyond = false;
    memcpy(self->material, before, sizeof before);
    solve(self);
    for (int k = 0; k + 1 < self->n; k++) {
      moved += self->material[k] - before[k];
      if (!(self->mode[k] * moved < -1e-15 * self->whole)) continue;
      self->mode[k] = STRUT_GUIDE_STICKS;
      back = true;
    }
    for (int k = 0; k + 1 < self->n && !back; k++) {
      if (self->mode[k] != STRUT_GUIDE_STICKS || !(room_at(self, k, ROUNDING) < 0.0)) continue;
      self->mode[k] =
          self->tension[k] > self->tension[k + 1] ? STRUT_GUIDE_TO_FIRST : STRUT_GUIDE_TO_LAST;
      beyond = true;
    }
    if (!back && !beyond) return;
  }
}

/* Rates of lengths and turning angles, and what flows through slipping guides. */
static void find_rates(const strut_model *model, const strut_state *state, int32_t i,
                       const double *velocity, cable *self) {
  assert(i >= 0 && i < model->elements.count);
  const strut_element *element = &model->elements.element[i];
  const uint32_t *at = model->elements.at + element->first;
  double spin[MOST];
  self->winding = state->latest->rest_rate[element->base];
  for (int k = 0; k < self->n; k++) {
    double x = velocity[at[k + 1]] - velocity[at[k]],
           y = velocity[at[k + 1] + 1] - velocity[at[k] + 1];
    self->length_rate[k] = self->x[k] * x + self->y[k] * y;
    spin[k] = self->length[k] > 0.0 ? (self->x[k] * y - self->y[k] * x) / self->length[k] : 0.0;
  }
  for (int k = 0; k + 1 < self->n; k++)
    self->turn_rate[k] = self->side[k] * (spin[k + 1] - spin[k]);
}

/* The flows in the group of segments a .. b. */
static void find_group_flows(cable *self, int a, int b) {
  assert(a <= b);
  double ratio = 1.0, ratio_rate = 0.0, strain = self->tension[a] / self->ea;
  double loose[MOST], stiff[MOST], sum = 0.0, weight = 0.0, passed;
  for (int k = a; k <= b; k++) { /* rate of material: loose - stiff * rate of the first strain */
    double inverse = 1.0 / (1.0 + ratio * strain), part = self->length[k] * inverse * inverse;
    loose[k] = self->length_rate[k] * inverse - part * ratio_rate * strain;
    stiff[k] = part * ratio;
    sum += loose[k], weight += stiff[k];
    if (k == b) break;
    double next = ratio_at(self, k);
    ratio_rate = next * (ratio_rate - ratio * self->mode[k] * self->friction * self->turn_rate[k]);
    ratio *= next;
  }
  passed = a == 0 ? -self->winding : 0.0;
  double strain_rate = (sum + passed) / weight;
  for (int k = a; k < b; k++) {
    passed += loose[k] - stiff[k] * strain_rate;
    self->flow[k] = strain > 0.0 ? passed : 0.0;
  }
}

static void find_flows(cable *self) {
  for (int a = 0; a < self->n; a++) {
    int b = group_end(self, a);
    if (b > a) find_group_flows(self, a, b);
    if (b + 1 < self->n) self->flow[b] = 0.0;
    a = b;
  }
}

/* d energy / d material, with its sign turned: what a length of cable takes with it. */
static double carried(const cable *self, int k) {
  assert(k >= 0 && k < self->n);
  return self->tension[k] + 0.5 * self->tension[k] * self->tension[k] / self->ea;
}

static double energy_of(const cable *self) {
  double sum = 0.0;
  if (is_slack(self)) return sum;
  for (int k = 0; k < self->n; k++) {
    double stretch = self->length[k] - self->material[k];
    if (stretch > 0.0 && self->material[k] > 0.0)
      sum += 0.5 * self->ea * stretch * stretch / self->material[k];
  }
  return sum;
}

/* Where the segments and guides of element i stand among those of all. */
static int32_t place_of(const strut_model *model, int32_t i) {
  assert(i >= 0 && i < model->elements.count);
  const strut_element_table *elements = &model->elements;
  return elements->element[i].slot + 1 - elements->history_slot;
}

/* The cable at q with the materials that the state remembers. */
static void measure_kept(const strut_model *model, const strut_state *state, int32_t i,
                         const double *q, cable *self) {
  measure(model, state->latest->rest, state->history.material + place_of(model, i), i, q, self);
}

/* The cable at q in its modes; true where these are frozen. */
static bool stand(const strut_model *model, const strut_state *state, int32_t i, const double *q,
                  cable *self) {
  const int8_t *mode = state->history.guide_mode + place_of(model, i);
  measure_kept(model, state, i, q, self);
  if (self->material[0] < 0.0) share_evenly(self);
  if (mode[0] == STRUT_GUIDE_FREE) {
    settle(self);
    return false;
  }
  const int8_t *side = state->history.guide_side + place_of(model, i);
  for (int k = 0; k < self->n; k++) self->mode[k] = k + 1 < self->n ? mode[k] : STRUT_GUIDE_STICKS;
  for (int k = 0; k + 1 < self->n; k++) {
    double bend = bend_on_side(self, k, side[k]);
    if (bend == side[k] * self->turn[k]) self->side[k] = side[k];
    self->bend[k] = bend;
  }
  solve(self);
  return true;
}

/* Leaves the materials of an evaluation in the slots, where the energy is found by them. */
static void show_materials(const strut_model *model, const strut_state *state, int32_t i,
                           const cable *self) {
  assert(i >= 0 && i < model->elements.count);
  double *material = state->latest->rest + model->elements.element[i].slot + 1;
  memcpy(material, self->material, (size_t)self->n * sizeof *material);
}

static void keep_materials(const strut_model *model, strut_state *state, int32_t i,
                           const cable *self) {
  show_materials(model, state, i, self);
  memcpy(state->history.material + place_of(model, i), self->material,
         (size_t)self->n * sizeof *self->material);
}

/* Its damper works along the whole cable while that is taut, and does not push. */
static double damper_force(const strut_element *element, const cable *self) {
  double rate = -self->winding, least = HUGE_VAL;
  for (int k = 0; k < self->n; k++) {
    rate += self->length_rate[k];
    least = fmin(least, self->tension[k]);
  }
  return least > 0.0 ? fmax(element->damping * rate, -least) : 0.0;
}

static void add_powers(const strut_state *state, const cable *self, double damper, bool frozen) {
  double rate = -self->winding, lost = 0.0;
  for (int k = 0; k < self->n; k++) rate += self->length_rate[k];
  double stiffer = self->axial ? 0.0 : energy_of(self) / self->whole; /* E grows with it */
  double drive = (stiffer - carried(self, 0) - damper) * self->winding;
  for (int k = 0; k + 1 < self->n && frozen; k++)
    lost += (carried(self, k) - carried(self, k + 1)) * self->flow[k];
  lost += damper * rate;
  strut_power_add_two(state->latest->power, STRUT_POWER_DRIVE, drive, STRUT_POWER_MEMBERS, lost);
}

void strut_capstan_add_forces(const strut_model *model, const strut_state *state, int32_t i,
                              const double *q, const double *velocity, double *force) {
  assert(i >= 0 && i < model->elements.count);
  const strut_element *element = &model->elements.element[i];
  const uint32_t *at = model->elements.at + element->first;
  cable c;
  bool frozen = stand(model, state, i, q, &c);
  if (frozen) show_materials(model, state, i, &c);
  find_rates(model, state, i, velocity, &c);
  double damper = element->damping > 0.0 ? damper_force(element, &c) : 0.0;
  for (int k = 0; k < c.n; k++) {
    double x = (c.tension[k] + damper) * c.x[k], y = (c.tension[k] + damper) * c.y[k];
    force[at[k]] += x, force[at[k] + 1] += y;
    force[at[k + 1]] -= x, force[at[k + 1] + 1] -= y;
  }
  if (!state->balance) return;
  if (frozen) find_flows(&c);
  add_powers(state, &c, damper, frozen);
}

void strut_capstan_begin(const strut_model *model, strut_state *state, int32_t i, const double *q) {
  assert(i >= 0 && i < model->elements.count);
  const strut_element *element = &model->elements.element[i];
  cable c;
  if (strut_capstan_remembers(element, state->latest->rest)) return;
  measure_kept(model, state, i, q, &c);
  share_evenly(&c);
  keep_materials(model, state, i, &c);
  strut_capstan_thaw(model, state, i);
  memset(state->history.guide_drop + place_of(model, i), 0, (size_t)c.n * sizeof(double));
}

void strut_capstan_renew(const strut_model *model, strut_state *state, int32_t i, const double *q,
                         bool jumped) {
  cable c;
  double before[MOST], moved = 0.0, lost = 0.0,
                       *drop = state->history.guide_drop + place_of(model, i);
  measure_kept(model, state, i, q, &c);
  memcpy(before, c.material, sizeof before);
  double held = energy_of(&c);
  settle(&c);
  for (int k = 0; k + 1 < c.n; k++) {
    double now = carried(&c, k) - carried(&c, k + 1);
    moved += c.material[k] - before[k];
    lost += fmax(0.0, 0.5 * (drop[k] + now) * moved);
    drop[k] = now;
  }
  if (jumped) lost = held - energy_of(&c);
  if (state->balance) strut_power_add(state->work, STRUT_POWER_MEMBERS, lost);
  keep_materials(model, state, i, &c);
}

void strut_capstan_place(const strut_model *model, strut_state *state, int32_t i, const double *q) {
  cable c;
  measure_kept(model, state, i, q, &c);
  settle(&c);
  keep_materials(model, state, i, &c);
}

void strut_capstan_keep(const strut_model *model, strut_state *state, int32_t i, const double *q) {
  cable c;
  bool frozen = stand(model, state, i, q, &c);
  if (frozen && !is_slack(&c))
    keep_materials(model, state, i, &c); /* what sticks is not shared out */
}

void strut_capstan_thaw(const strut_model *model, strut_state *state, int32_t i) {
  assert(i >= 0 && i < model->elements.count);
  int8_t *mode = state->history.guide_mode + place_of(model, i);
  for (int k = 0; k + 1 < model->elements.element[i].nodes; k++) mode[k] = STRUT_GUIDE_FREE;
}

void strut_capstan_freeze(const strut_model *model, strut_state *state, int32_t i, const double *q,
                          const double *velocity) {
  int8_t *mode = state->history.guide_mode + place_of(model, i);
  cable c;
  strut_capstan_renew(model, state, i, q, true);
  measure_kept(model, state, i, q, &c);
  for (int k = 0; k < c.n; k++) c.mode[k] = STRUT_GUIDE_STICKS;
  solve(&c);
  for (int k = 0; k + 1 < c.n; k++) {
    bool taut = c.tension[k] > 0.0 && c.tension[k + 1] > 0.0;
    bool at_bound = taut && room_at(&c, k, -AT_BOUND) < 0.0;
    if (at_bound)
      c.mode[k] = c.tension[k] > c.tension[k + 1] ? STRUT_GUIDE_TO_FIRST : STRUT_GUIDE_TO_LAST;
  }
  find_rates(model, state, i, velocity, &c);
  find_flows(&c);
  for (int k = 0; k + 1 < c.n; k++)
    mode[k] = (int8_t)(c.mode[k] * c.flow[k] > 0.0 ? c.mode[k] : STRUT_GUIDE_STICKS);
  int8_t *side = state->history.guide_side + place_of(model, i);
  for (int k = 0; k + 1 < c.n; k++) side[k] = (int8_t)c.side[k];
}

void strut_capstan_pass_straight(const strut_model *model, strut_state *state, int32_t i, int k) {
  assert(i >= 0 && i < model->elements.count);
  int8_t *side = state->history.guide_side + place_of(model, i);
  side[k] = (int8_t)-side[k];
}

void strut_capstan_measure(const strut_model *model, const strut_state *state, int32_t i,
                           const double *q, const double *velocity, double h,
                           strut_capstan_guide *guide) {
  assert(i >= 0 && i < model->elements.count);
  const int8_t *side = state->history.guide_side + place_of(model, i);
  cable c;
  bool pulls = stand(model, state, i, q, &c) && !is_slack(&c);
  if (pulls) find_rates(model, state, i, velocity, &c);
  if (pulls) find_flows(&c);
  for (int k = 0; k + 1 < c.n; k++) {
    double flow = pulls ? c.mode[k] * c.flow[k] * h * c.ea / c.whole : c.ea;
    bool sticks = pulls && c.mode[k] == STRUT_GUIDE_STICKS;
    guide[k].margin = sticks ? room_at(&c, k, ROUNDING) : flow;
    guide[k].bend = bend_on_side(&c, k, side[k]) + STRAIGHT;
  }
}

strut_capstan_stretch strut_capstan_stretch_of(const strut_model *model, const strut_state *state,
                                               int32_t i, const double *q, const double *velocity) {
  cable c;
  measure_kept(model, state, i, q, &c);
  find_rates(model, state, i, velocity, &c);
  strut_capstan_stretch found = {-c.whole, -c.winding};
  for (int k = 0; k < c.n; k++) found.stretch += c.length[k], found.rate += c.length_rate[k];
  return found;
}

void strut_capstan_tauten(const strut_model *model, strut_state *state, int32_t i, const double *q,
                          const double *velocity, double soon) {
  int8_t *mode = state->history.guide_mode + place_of(model, i);
  cable c;
  measure_kept(model, state, i, q, &c);
  share_evenly(&c);
  keep_materials(model, state, i, &c);
  find_rates(model, state, i, velocity, &c);
  c.whole += soon * c.winding, c.material[0] += soon * c.winding;
  for (int k = 0; k < c.n; k++) c.length[k] += soon * c.length_rate[k];
  settle(&c);
  for (int k = 0; k + 1 < c.n; k++) mode[k] = (int8_t)c.mode[k];
}

void strut_capstan_switch(const strut_model *model, strut_state *state, int32_t i, int k,
                          const double *q) {
  assert(i >= 0 && i < model->elements.count);
  int8_t *mode = state->history.guide_mode + place_of(model, i);
  cable c;
  stand(model, state, i, q, &c);
  keep_materials(model, state, i, &c);
  if (mode[k] != STRUT_GUIDE_STICKS)
    mode[k] = STRUT_GUIDE_STICKS;
  else
    mode[k] = c.tension[k] > c.tension[k + 1] ? STRUT_GUIDE_TO_FIRST : STRUT_GUIDE_TO_LAST;
}

strut_capstan_ends strut_capstan_tensions(const strut_model *model, const strut_state *state,
                                          int32_t i, const double *q, const double *velocity) {
  assert(i >= 0 && i < model->elements.count);
  const strut_element *element = &model->elements.element[i];
  strut_capstan_ends ends = {0.0, 0.0, 0.0};
  cable c;
  stand(model, state, i, q, &c);
  find_rates(model, state, i, velocity, &c);
  double damper = element->damping > 0.0 ? damper_force(element, &c) : 0.0;
  for (int k = 0; k < c.n; k++) ends.most = fmax(ends.most, c.tension[k] + damper);
  ends.first = c.tension[0] + damper, ends.last = c.tension[c.n - 1] + damper;
  return ends;
}

void strut_capstan_find_rest(const strut_model *model, int32_t i, const double *rest,
                             const double *q, strut_capstan_rest *found) {
  cable c;
  measure(model, rest, rest + model->elements.element[i].slot + 1, i, q, &c);
  if (c.material[0] < 0.0) share_evenly(&c);
  settle(&c);
  memset(found->force, 0, sizeof found->force);
  for (int k = 0; k < c.n; k++) {
    const double pull[2] = {c.tension[k] * c.x[k], c.tension[k] * c.y[k]};
    for (int a = 0; a < 2; a++)
      found->force[2 * k + a] += pull[a], found->force[2 * k + 2 + a] -= pull[a];
    found->tension[k] = c.tension[k], found->material[k] = c.material[k];
    found->mode[k] = c.mode[k];
  }
}

double strut_capstan_energy(const strut_model *model, int32_t i, const double *rest,
                            const double *q) {
  cable c;
  measure(model, rest, rest + model->elements.element[i].slot + 1, i, q, &c);
  return energy_of(&c);
}

void strut_capstan_stiffness(const strut_model *model, int32_t i, const double *q, double *k) {
  assert(i >= 0 && i < model->elements.count);
  const strut_element *element = &model->elements.element[i];
  int32_t rows = 2 * element->nodes;
  double whole = 0.0;
  cable c;
  measure(model, model->members.rest, model->members.rest + element->slot + 1, i, q, &c);
  for (int s = 0; s < c.n; s++) whole += c.length[s];
  memset(k, 0, (size_t)rows * (size_t)rows * sizeof *k);
  for (int s = 0; s < c.n; s++) {
    if (!(c.length[s] > 0.0)) continue;
    double stiffness = element->numbers.stiffness * whole / c.length[s];
    const double b[4] = {-c.x[s], -c.y[s], c.x[s], c.y[s]};
    for (int r = 0; r < 4; r++)
      for (int j = 0; j < 4; j++) k[(2 * s + r) * rows + 2 * s + j] += stiffness * b[r] * b[j];
  }
}
