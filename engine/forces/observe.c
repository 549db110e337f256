/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One function for each observable. Hot where a scene has sensors. See observe.h. */
#include "engine/forces/observe.h"

#include <assert.h>
#include <math.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/history.h"
#include "engine/forces/nearby.h"
#include "engine/forces/rigid.h"
#include "engine/forces/surfaces.h"
#include "engine/scene/things.h"

#define OBSERVE(ID)                                                                                \
  static strut_observed observe_##ID(strut_instant *instant, int32_t item, int32_t other)
#define OBSERVED(ID, observed)                                                                     \
  OBSERVE(ID) {                                                                                    \
    (void)instant, (void)item, (void)other;                                                        \
    return observed;                                                                               \
  }
#define VALUE(ID, expression) OBSERVED(ID, ((strut_observed){(expression), 0.0}))
/* One that is the rate of another. */
#define RATE(ID, OF) VALUE(ID, observe_##OF(instant, item, other).rate)

/* ---- the run and its nodes ---- */

static double time_of(const strut_instant *instant) {
  return instant->time + instant->state->time_offset;
}

VALUE(TIME, time_of(instant))

static strut_observed coordinate(const strut_instant *instant, int32_t at) {
  return (strut_observed){instant->q[at], instant->v[at]};
}

OBSERVED(NODE_X, coordinate(instant, 2 * item))
OBSERVED(NODE_Y, coordinate(instant, 2 * item + 1))
VALUE(NODE_VX, instant->v[2 * item])
VALUE(NODE_VY, instant->v[2 * item + 1])

/* Distance from the nearest of several surfaces. */
static double height_above_surfaces(const strut_contact_table *t, const double q[2],
                                    const strut_ground_motion *motion) {
  double least = HUGE_VAL;
  for (int32_t k = 0; k < t->surfaces; k++) {
    const strut_surface *surface = &t->surface[k];
    const double *place = surface->moves && motion ? motion[surface->ground].place : NULL;
    double point[2] = {q[0] - (place ? place[0] : 0.0), q[1] - (place ? place[1] : 0.0)};
    strut_contact_pose pose;
    if (surface->index) {
      strut_surface_lowest(surface, point, &pose.gap);
      k += surface->pieces - 1;
    } else {
      strut_surface_find(surface, point, -1, &pose);
    }
    least = fmin(least, pose.gap);
  }
  return least;
}

static double height_above_ground(const strut_instant *instant, const double *q) {
  const strut_contact_table *contacts = &instant->model->contacts;
  if (contacts->surface)
    return height_above_surfaces(contacts, q, instant->state->latest->ground_motion);
  return q[0] * contacts->normal[0] +
         (q[1] - instant->model->scene->ground.height) * contacts->normal[1];
}

VALUE(HEIGHT, height_above_ground(instant, instant->q + 2 * item))

VALUE(NODE_SPIN, instant->spin[item])

static double sum_of_spins(const strut_instant *instant) {
  double sum = 0.0;
  for (int32_t i = 0; i < instant->model->node_count; i++) sum += instant->spin[i];
  return sum;
}

VALUE(SPIN, sum_of_spins(instant))

/* ---- contacts: from `item` on up to `other`, those of a node side by side ---- */

/* The element that contact i has become, or -1. */
static int32_t element_of(const strut_model *model, int32_t i) {
  int32_t item = model->rubbing.of_contact ? model->rubbing.of_contact[i] : -1;
  return item < 0 ? -1 : model->rubbing.item[item].element;
}

static bool touches(const strut_instant *instant, int32_t i) {
  int32_t element = element_of(instant->model, i);
  double b[STRUT_MOST_GRADIENT];
  if (element < 0)
    return strut_contact_gap_at(&instant->model->contacts, i, instant->q,
                                instant->state->latest->ground_motion) < 0.0;
  return strut_element_strain(instant->model, element, instant->q, 0.0, b) <
         instant->model->elements.element[element].natural;
}

static bool any_touches(const strut_instant *instant, int32_t first, int32_t end) {
  for (int32_t i = first; i < end; i++)
    if (touches(instant, i)) return true;
  return false;
}

VALUE(TOUCHES, any_touches(instant, item, other))

/* The normal force on contact i at the instant's positions and velocities. */
static double press(const strut_instant *instant, int32_t i) {
  const strut_contact_table *contacts = &instant->model->contacts;
  const strut_ground_motion *motion = instant->state->latest->ground_motion;
  int32_t element = element_of(instant->model, i);
  strut_element_pose pressed;
  if (element >= 0)
    return -strut_element_measure_at(instant->model, instant->state, element, instant->q,
                                     instant->v, &pressed);
  const strut_contact_pose pose = strut_contact_pose_at(contacts, i, instant->q, motion, -1);
  if (!(pose.gap < 0.0)) return 0.0;
  strut_vec2 u = strut_contact_velocity(contacts, i, instant->v, motion);
  const strut_law_ground_numbers numbers = strut_contact_numbers(&contacts->entry[i]);
  double spring = strut_law_ground_spring(&numbers, pose.gap);
  double into = strut_component(pose.axes.normal, u.x, u.y);
  return spring + strut_law_ground_damper(&numbers, spring, into, true);
}

static double sum_of(const double *force, int32_t first, int32_t end) {
  double sum = first < end ? force[first] : 0.0;
  for (int32_t i = first + 1; i < end; i++) sum += force[i];
  return sum;
}

OBSERVE(NORMAL) {
  double sum = 0.0;
  if (!instant->sensed)
    return (strut_observed){sum_of(instant->state->latest->normal, item, other), 0.0};
  for (int32_t i = item; i < other; i++) sum += press(instant, i);
  return (strut_observed){sum, 0.0};
}

VALUE(FRICTION, sum_of(instant->state->latest->friction, item, other))

/* ---- members ---- */

static strut_member_values member_of(const strut_instant *instant, int32_t member) {
  strut_member_values values =
      strut_member_measure_at(instant->model, instant->state, member, instant->q, instant->v);
  if (instant->sensed) return values;
  if (instant->state->rigid) values.force += strut_rigid_tension(instant->state->rigid, member);
  values.force += strut_actuator_force_on(instant->model, instant->state, member, -1);
  return values;
}

static strut_observed length_of(const strut_instant *instant, int32_t member) {
  strut_member_values values =
      strut_member_measure_at(instant->model, instant->state, member, instant->q, instant->v);
  return (strut_observed){values.length, values.rate};
}

OBSERVED(LENGTH, length_of(instant, item))
VALUE(STRETCH, length_of(instant, item).value - instant->state->latest->rest[item])
RATE(RATE, LENGTH)
VALUE(FORCE, member_of(instant, item).force)

static double plastic_of(const strut_instant *instant, int32_t member) {
  const strut_element_table *elements = &instant->model->elements;
  const strut_element *element = strut_element_of_member(elements, member);
  return element ? strut_element_plastic(instant->model, instant->state,
                                         (int32_t)(element - elements->element))
                 : 0.0;
}

static double last_force_of(const strut_instant *instant, int32_t member) {
  const strut_element_table *elements = &instant->model->elements;
  const strut_element *element = strut_element_of_member(elements, member);
  if (!element || !(element->guide_friction > 0.0)) return member_of(instant, member).force;
  return strut_element_last_force(instant->model, instant->state,
                                  (int32_t)(element - elements->element));
}

VALUE(PLASTIC, plastic_of(instant, item))
VALUE(LAST_FORCE, last_force_of(instant, item))

OBSERVE(LARGEST_FORCE) {
  double most = 0.0;
  (void)item, (void)other;
  instant->loaded = instant->branch = -1;
  for (int32_t j = 0; j < instant->model->members.count; j++) {
    double first = member_of(instant, j).force, last = last_force_of(instant, j);
    bool at_last = fabs(last) > fabs(first);
    double force = at_last ? last : first;
    if (!(fabs(force) > most)) continue;
    most = fabs(force);
    instant->loaded = j;
    instant->branch = 4 * j + 2 * at_last + (force < 0.0); /* which, at which end, its sign */
  }
  return (strut_observed){most, 0.0};
}

/* The line from one coordinate to another. */
static strut_vec2 line(const strut_instant *instant, size_t from, size_t to) {
  return (strut_vec2){instant->q[to] - instant->q[from], instant->q[to + 1] - instant->q[from + 1]};
}

static strut_vec2 line_of_pair(const strut_instant *instant, int32_t a, int32_t b) {
  return line(instant, 2 * (size_t)a, 2 * (size_t)b);
}

static double direction(strut_vec2 d) { return atan2(d.y, d.x); }

VALUE(TILT, direction(line(instant, instant->model->members.from[item],
                           instant->model->members.to[item])))
VALUE(ANGLE, direction(line_of_pair(instant, item, other)))

VALUE(DISTANCE, hypot(line_of_pair(instant, item, other).x, line_of_pair(instant, item, other).y))

/* ---- elements: hinges, cells, collisions, distances ---- */

static strut_observed strain_of(const strut_instant *instant, int32_t element) {
  const strut_state *state = instant->state;
  strut_element_pose pose;
  assert(element >= 0 && element < instant->model->elements.count);
  strut_element_evaluate(instant->model, element, state->latest->rest, instant->q,
                         state->history.turn[element], &pose);
  return (strut_observed){pose.strain,
                          strut_element_rate(instant->model, element, &pose, instant->v)};
}

static double force_of(const strut_instant *instant, int32_t element) {
  strut_element_pose pose;
  return strut_element_measure_at(instant->model, instant->state, element, instant->q, instant->v,
                                  &pose);
}

/* Pressure in a cell, or what all elements of a collision push with. */
static double push_of(const strut_instant *instant, int32_t first) {
  const strut_element_table *elements = &instant->model->elements;
  double push = elements->element[first].numbers.outside;
  for (int32_t i = first; i < strut_element_end(elements, first); i++) push -= force_of(instant, i);
  return push;
}

static double gap_of(const strut_instant *instant, int32_t first) {
  const strut_element_table *elements = &instant->model->elements;
  const strut_state *state = instant->state;
  double least = HUGE_VAL;
  for (int32_t i = first; i < strut_element_end(elements, first); i++) {
    strut_element_pose pose;
    strut_element_evaluate(instant->model, i, state->latest->rest, instant->q,
                           state->history.turn[i], &pose);
    least = fmin(least, pose.strain - pose.natural);
  }
  return least;
}

static double moment_of(const strut_instant *instant, int32_t element) {
  double moment = force_of(instant, element);
  if (instant->sensed) return moment;
  int32_t hinge = instant->model->elements.element[element].item;
  return moment + strut_actuator_force_on(instant->model, instant->state, -1, hinge);
}

OBSERVED(HINGE_ANGLE, strain_of(instant, item))
RATE(HINGE_RATE, HINGE_ANGLE)
VALUE(MOMENT, moment_of(instant, item))
VALUE(HINGE_PLASTIC, strut_element_plastic(instant->model, instant->state, item))
OBSERVED(CELL_AREA, strain_of(instant, item))
RATE(CELL_RATE, CELL_AREA)
VALUE(PRESSURE, push_of(instant, item))
VALUE(COLLISION_GAP, gap_of(instant, item))
VALUE(COLLISION_FORCE, push_of(instant, item))
OBSERVED(DISTANCE_VALUE, strain_of(instant, item))
RATE(DISTANCE_RATE, DISTANCE_VALUE)
VALUE(DISTANCE_FORCE, force_of(instant, item))

VALUE(LEAST_GAP,
      strut_nearby_least_gap(instant->model, instant->state, instant->q, &instant->branch))

/* ---- the structure as a whole ---- */

/* Position or velocity of the centre of mass along an axis; and the same of absolute values as its size. */
static double centre(strut_instant *instant, int axis, bool rate) {
  const strut_model *model = instant->model;
  const double *from = (rate ? instant->v : instant->q) + axis;
  double sum = 0.0, mass = 0.0, size = 0.0;
  for (int32_t i = 0; i < model->node_count; i++) {
    sum += model->weight[i] * from[2 * i];
    size += model->weight[i] * fabs(from[2 * i]);
    mass += model->weight[i];
  }
  instant->size = size / mass;
  if (!(model->terms & STRUT_TERM_SLIDING_MASS)) return sum / mass;
  double more =
      rate ? strut_sliding_masses_momentum(model, instant->state, axis, instant->q, instant->v)
           : strut_sliding_masses_moment(model, instant->state, axis, instant->q);
  instant->size += fabs(more) / mass;
  return sum / mass + more / mass;
}

#define CENTRE(ID, RATE, axis)                                                                     \
  OBSERVE(ID) {                                                                                    \
    (void)item, (void)other;                                                                       \
    double rate = instant->sensed ? centre(instant, axis, true) : 0.0;                             \
    return (strut_observed){centre(instant, axis, false), rate};                                   \
  }                                                                                                \
  VALUE(RATE, centre(instant, axis, true))
CENTRE(CENTRE_X, CENTRE_VX, 0)
CENTRE(CENTRE_Y, CENTRE_VY, 1)

static strut_energies stored_in(const strut_instant *instant) {
  return instant->sensed
             ? strut_energy_evaluate_at(instant->model, instant->state, instant->q, instant->v)
             : instant->stored;
}

VALUE(KINETIC, stored_in(instant).kinetic)
VALUE(ELASTIC, stored_in(instant).elastic)
VALUE(GRAVITY, stored_in(instant).gravity)
VALUE(GROUND, stored_in(instant).contact)

OBSERVE(TOTAL) {
  strut_energies e = stored_in(instant);
  (void)item, (void)other;
  instant->size = fabs(e.kinetic) + fabs(e.elastic) + fabs(e.gravity) + fabs(e.contact);
  return (strut_observed){e.kinetic + e.elastic + e.gravity + e.contact, 0.0};
}

VALUE(DRIVES, instant->state->work[STRUT_POWER_DRIVE])
VALUE(LOADS, instant->state->work[STRUT_POWER_LOAD] +
                 strut_energy_load_work(instant->model, instant->state))
VALUE(BELT, instant->state->work[STRUT_POWER_BELT])
VALUE(SUPPORTS, strut_support_motion_work(instant->model, instant->state))
VALUE(LOST_MEMBERS, instant->state->work[STRUT_POWER_MEMBERS])
VALUE(LOST_CONTACT, instant->state->work[STRUT_POWER_CONTACT])
VALUE(LOST_FRICTION, instant->state->work[STRUT_POWER_FRICTION])
VALUE(LOST, instant->state->work[STRUT_POWER_MEMBERS] + instant->state->work[STRUT_POWER_CONTACT] +
                instant->state->work[STRUT_POWER_FRICTION])

/* ---- signals, and masses that they move ---- */

VALUE(SENSOR, instant->state->latest->sensor[item])
VALUE(SENSOR_RATE, instant->state->latest->sensor_rate[item])
VALUE(STATE, instant->v[instant->model->feedback.base + item])
VALUE(SIGNAL,
      strut_drive_signal(instant->model, instant->state, instant->v, item, time_of(instant)))

static double share_of(const strut_instant *instant, int32_t slider) {
  return strut_sliding_mass_share(instant->model->scene, (size_t)slider, time_of(instant));
}

/* Place or velocity of a mass on a member, along x or y. */
static double slide(const strut_instant *instant, int32_t slider, uint32_t axis, bool rate) {
  const strut_sliding_item *item = &instant->model->sliding.item[slider];
  double far = share_of(instant, slider);
  const double *z = rate ? instant->v : instant->q, *q = instant->q;
  uint32_t a = item->at[0] + axis, b = item->at[1] + axis;
  double place = (1.0 - far) * z[a] + far * z[b];
  return rate ? place + strut_sliding_mass_rate(instant->model->scene, (size_t)slider,
                                                time_of(instant)) *
                            (q[b] - q[a])
              : place;
}

VALUE(SLIDER_X, slide(instant, item, 0, false))
VALUE(SLIDER_Y, slide(instant, item, 1, false))
VALUE(SLIDER_VX, slide(instant, item, 0, true))
VALUE(SLIDER_VY, slide(instant, item, 1, true))
VALUE(SLIDER_SHARE, share_of(instant, item))

strut_observe *strut_observe_at(strut_column_kind kind) {
  static strut_observe *const functions[] = {
#define FUNCTION(ID, ...) observe_##ID,
      STRUT_OBSERVABLES(FUNCTION)};
  assert(kind < STRUT_COLUMN_COUNT);
  return functions[kind];
}

double strut_observe_item(strut_instant *instant, strut_column_kind kind, int32_t item) {
  strut_column column = strut_column_find(instant->model, (strut_column){kind, item, -1}, 0);
  return strut_observe_at(kind)(instant, column.item, column.other).value;
}

/* ---- a instant of a state ---- */

/*
 * momentum = M u of each node at velocities u (nodes, 2), with the model's mass matrix, lumped or consistent,
 * of all nodes, supported ones too. Masses that slide add their speed along their lines at the positions q;
 * without it where q is NULL. Forces must have been observed where some mass slides.
 */
static void multiply_by_mass(const strut_instant *instant, const double *u, const double *q,
                             double *momentum) {
  const strut_model *model = instant->model;
  const strut_member_table *members = &model->members;
  bool consistent = model->scene->mass_model == STRUT_MASS_CONSISTENT;
  double own = consistent ? 1.0 / 3.0 : 0.5, other = consistent ? 1.0 / 6.0 : 0.0;
  for (int32_t i = 0; i < 2 * model->node_count; i++) momentum[i] = model->point_mass[i / 2] * u[i];
  for (int32_t j = 0; j < members->count; j++)
    for (uint32_t c = 0; c < 2; c++) {
      uint32_t a = members->from[j] + c, b = members->to[j] + c;
      momentum[a] += members->mass[j] * (own * u[a] + other * u[b]);
      momentum[b] += members->mass[j] * (own * u[b] + other * u[a]);
    }
  for (int32_t j = 0, k = 0; j < model->sliding.count; j++) {
    const strut_sliding_item *item = &model->sliding.item[j];
    strut_sliding_motion motion = {.share = item->start};
    if (item->signal >= 0) motion = instant->state->latest->sliding[k++];
    for (uint32_t c = 0; c < 2; c++) {
      uint32_t a = item->at[0] + c, b = item->at[1] + c;
      double speed = (1.0 - motion.share) * u[a] + motion.share * u[b];
      if (q) speed += motion.rate * (q[b] - q[a]);
      momentum[a] += (1.0 - motion.share) * item->mass * speed;
      momentum[b] += motion.share * item->mass * speed;
    }
  }
}

/* Sums of x and of y, of weights times values or of the values alone, over the total; all (nodes, 2). */
static strut_vec2 mean(const strut_model *model, const double *weights, const double *values,
                       double total) {
  double sum[2] = {0.0, 0.0};
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    sum[i % 2] += (weights ? weights[i] : 1.0) * values[i];
  return total > 0.0 ? (strut_vec2){sum[0] / total, sum[1] / total} : (strut_vec2){0.0, 0.0};
}

/*
 * (r - c) x p of each node: r its position, p its part of M (v - v_c), c and v_c the centre of
 * mass and its velocity. Since M couples x to x and y to y alike, forces within the structure leave their
 * sum as it is.
 */
static void find_spin(strut_instant *instant) {
  const strut_model *model = instant->model;
  const double *q = instant->state->q;
  double *p = instant->momentum, *u = instant->relative_velocity, total = 0.0;
  int32_t n = model->node_count;
  for (int32_t i = 0; i < 2 * n; i++) u[i] = 1.0;
  multiply_by_mass(instant, u, NULL, p); /* masses, in x and in y */
  for (int32_t i = 0; i < n; i++) total += p[2 * i];
  strut_vec2 centre = mean(model, p, q, total);
  multiply_by_mass(instant, instant->state->v, q, p);
  strut_vec2 velocity = mean(model, NULL, p, total);
  for (int32_t i = 0; i < n; i++) {
    u[2 * i] = instant->state->v[2 * i] - velocity.x;
    u[2 * i + 1] = instant->state->v[2 * i + 1] - velocity.y;
  }
  multiply_by_mass(instant, u, q, p);
  for (int32_t i = 0; i < n; i++)
    instant->spin[i] = (q[2 * i] - centre.x) * p[2 * i + 1] - (q[2 * i + 1] - centre.y) * p[2 * i];
}

bool strut_instant_create(const strut_model *model, strut_arena *arena, strut_instant *instant) {
  size_t nodes = (size_t)model->node_count;
  *instant = (strut_instant){.model = model};
  return STRUT_ALLOCATE(arena, STRUT_NEW(instant->spin, nodes),
                        STRUT_NEW(instant->momentum, 2 * nodes),
                        STRUT_NEW(instant->relative_velocity, 2 * nodes));
}

/* Must all forces be evaluated, not only those of contacts, which a method with events may hold? */
static bool needs_evaluation(const strut_model *model, unsigned needs) {
  bool acted = model->terms & (STRUT_TERM_RIGID | STRUT_TERM_ACTUATOR_FORCES);
  return (acted && (needs & 1u << STRUT_OBSERVED_TENSION)) ||
         (model->sliding.moving_count && (needs & 1u << STRUT_OBSERVED_MOMENTUM));
}

void strut_instant_show(strut_instant *instant, const strut_state *state, unsigned needs,
                        double t) {
  const strut_model *model = instant->model;
  instant->state = state, instant->q = state->q, instant->v = state->v, instant->time = t;
  if (!(needs & ~(1u << STRUT_OBSERVED_MOTION))) return;
  if (needs_evaluation(model, needs) ||
      ((needs & 1u << STRUT_OBSERVED_FORCES) && !strut_forces_show_held(model, state)))
    strut_forces_observe(model, state, t);
  else
    strut_drive_apply(model, state, t);
  if (needs & 1u << STRUT_OBSERVED_ENERGIES)
    instant->stored = strut_energy_evaluate(model, state, t);
  if (needs & 1u << STRUT_OBSERVED_MOMENTUM) find_spin(instant);
}
