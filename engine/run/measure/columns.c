/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/quantities.h"

#include <math.h>

#include "engine/base/vec.h"
#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/drives/support_motion.h"
#include "engine/forces/elements.h"
#include "engine/forces/forces.h"
#include "engine/forces/history.h"
#include "engine/forces/nearby.h"
#include "engine/model/pose.h"
#include "engine/model/surface_search.h"

/* Rounding of positions, relative to the lengths that forces compare; and of sums over many steps. */
static const double POSITION_ROUNDING = 1e-12, SUM_ROUNDING = 1e-10;

/* What a column belongs to, and the powers of its unit. */
static const struct column_row {
  strut_column_owner owner;
  int kg, m, s, angle;
} rows[] = {
#define STRUT_COLUMN_ROW(id, owner, word, kg, m, s, angle)                                         \
  {STRUT_COLUMN_OF_##owner, kg, m, s, angle},
    STRUT_COLUMN_TABLE(STRUT_COLUMN_ROW)
#undef STRUT_COLUMN_ROW
};

static bool is_angle(strut_column_kind kind) {
  return rows[kind].angle == 1 && rows[kind].s == 0 && kind != STRUT_COLUMN_HINGE_PLASTIC;
}

static bool is_speed(strut_column_kind kind) {
  return rows[kind].kg == 0 && rows[kind].m == 1 && rows[kind].s == -1;
}

static bool is_length(strut_column_kind kind) {
  return rows[kind].kg == 0 && rows[kind].m == 1 && rows[kind].s == 0;
}

bool strut_columns_create(const strut_model *model, size_t most, strut_arena *arena,
                          strut_columns *c) {
  double slope = model->scene->ground.slope;
  *c = (strut_columns){.model = model, .normal = {-sin(slope), cos(slope)}};
  c->column = strut_arena_allocate(arena, most, sizeof *c->column);
  c->value = strut_arena_allocate(arena, most, sizeof *c->value);
  c->least = strut_arena_allocate(arena, most, sizeof *c->least);
  c->most = strut_arena_allocate(arena, most, sizeof *c->most);
  c->largest = strut_arena_allocate(arena, most, sizeof *c->largest);
  c->branch = strut_arena_allocate(arena, most, sizeof *c->branch);
  return c->column && c->value && c->least && c->most && c->largest && c->branch;
}

/* Finds the first contact of a node: the scene refers to contacts by nodes. */
static int32_t find_contact(const strut_model *model, int32_t node) {
  for (int32_t i = 0; i < model->contacts.count; i++)
    if (model->contacts.entry[i].node == node) return i;
  return -1;
}

static bool is_of_hinge(strut_column_kind kind) {
  return rows[kind].owner == STRUT_COLUMN_OF_HINGE;
}

static void note_needs(strut_columns *c, strut_column_kind kind) {
  bool rigid = c->model->terms & STRUT_TERM_RIGID;
  bool force = kind == STRUT_COLUMN_FORCE || kind == STRUT_COLUMN_LARGEST_FORCE;
  if (rows[kind].owner == STRUT_COLUMN_OF_CONTACT || (force && rigid)) c->forces = true;
  if (rows[kind].owner == STRUT_COLUMN_OF_ENERGY) c->energies = true;
  if (is_speed(kind) || kind == STRUT_COLUMN_HINGE_RATE) c->speeds = true;
}

size_t strut_columns_add(strut_columns *c, strut_column column) {
  if (column.kind == STRUT_COLUMN_NORMAL || column.kind == STRUT_COLUMN_FRICTION)
    column.item = find_contact(c->model, column.item);
  if (is_of_hinge(column.kind))
    column.item = strut_element_find(&c->model->elements, STRUT_ELEMENT_HINGE, column.item);
  if (rows[column.kind].owner == STRUT_COLUMN_OF_CELL)
    column.item = strut_element_find(&c->model->elements, STRUT_ELEMENT_CELL, column.item);
  if (rows[column.kind].owner == STRUT_COLUMN_OF_COLLISION)
    column.item = strut_element_find(&c->model->elements, STRUT_ELEMENT_COLLISION, column.item);
  if (rows[column.kind].owner == STRUT_COLUMN_OF_DISTANCE)
    column.item = strut_element_find(&c->model->elements, STRUT_ELEMENT_DISTANCE, column.item);
  for (size_t i = 0; i < c->count; i++) {
    const strut_column *other = &c->column[i];
    if (other->kind == column.kind && other->item == column.item && other->other == column.other)
      return i;
  }
  note_needs(c, column.kind);
  c->column[c->count] = column;
  return c->count++;
}

/* Mean of one component of q or v weighted by mass; *size: the same of absolute values. */
static double mean_by_mass(const strut_model *model, const double *from, double *size) {
  double sum = 0.0, mass = 0.0;
  *size = 0.0;
  for (int32_t i = 0; i < model->node_count; i++) {
    sum += model->weight[i] * from[2 * i];
    *size += model->weight[i] * fabs(from[2 * i]);
    mass += model->weight[i];
  }
  *size /= mass;
  return sum / mass;
}

/* Position or velocity of the centre of mass along x or y. */
static double evaluate_centre(const strut_columns *c, const strut_state *state,
                              strut_column_kind kind, double *size) {
  int axis = kind == STRUT_COLUMN_CENTRE_Y || kind == STRUT_COLUMN_CENTRE_VY;
  bool rate = kind == STRUT_COLUMN_CENTRE_VX || kind == STRUT_COLUMN_CENTRE_VY;
  double mean = mean_by_mass(c->model, (rate ? state->v : state->q) + axis, size);
  if (!(c->model->terms & STRUT_TERM_SLIDING_MASS)) return mean;
  double more = rate ? strut_sliding_masses_momentum(c->model, state, axis, state->q, state->v)
                     : strut_sliding_masses_moment(c->model, state, axis, state->q);
  double mass = 0.0;
  for (int32_t i = 0; i < c->model->node_count; i++) mass += c->model->weight[i];
  *size += fabs(more) / mass;
  return mean + more / mass;
}

/* Sum of a force over all contacts of the node of one of them, the first. */
static double sum_of_node(const strut_columns *c, int32_t first, const double *force) {
  const strut_contact_table *t = &c->model->contacts;
  double sum = force[first];
  for (int32_t i = first + 1; i < t->count && t->at[i] == t->at[first]; i++) sum += force[i];
  return sum;
}

/* Distance from the nearest of several surfaces. */
static double height_above_surfaces(const strut_contact_table *t, const double q[2],
                                    const strut_ground_motion *motion) {
  double least = HUGE_VAL;
  for (int32_t k = 0; k < t->surfaces; k++) {
    const strut_surface *s = &t->surface[k];
    const double *place = s->moves && motion ? motion[s->ground].place : NULL;
    double point[2] = {q[0] - (place ? place[0] : 0.0), q[1] - (place ? place[1] : 0.0)};
    strut_contact_pose pose;
    if (s->index) {
      strut_surface_lowest(s, point, &pose.gap);
      k += s->pieces - 1;
    } else {
      strut_surface_find(s, point, -1, &pose);
    }
    least = fmin(least, pose.gap);
  }
  return least;
}

/* Height above the ground, along its normal. */
static double height_above_ground(const strut_columns *c, const strut_state *state,
                                  const double q[2]) {
  if (c->model->contacts.surface)
    return height_above_surfaces(&c->model->contacts, q, state->latest->ground_motion);
  return q[0] * c->normal[0] + (q[1] - c->model->scene->ground.height) * c->normal[1];
}

static double plastic_of_member(const strut_model *model, const strut_state *state,
                                int32_t member) {
  const strut_element *e = strut_element_of_member(&model->elements, member);
  return e ? strut_element_plastic(model, state, (int32_t)(e - model->elements.element)) : 0.0;
}

static double last_force_of_member(const strut_model *model, const strut_state *state,
                                   int32_t member) {
  const strut_element *e = strut_element_of_member(&model->elements, member);
  if (!e || !(e->guide_friction > 0.0)) return strut_member_measure(model, state, member).force;
  return strut_element_last_force(model, state, (int32_t)(e - model->elements.element));
}

static double evaluate_hinge(const strut_columns *c, const strut_state *state,
                             strut_column column) {
  strut_hinge_values h = strut_hinge_measure(c->model, state, column.item);
  return column.kind == STRUT_COLUMN_HINGE_ANGLE  ? h.angle
         : column.kind == STRUT_COLUMN_HINGE_RATE ? h.rate
                                                  : h.moment;
}

/* Difference of two node positions. */
static void node_difference(const strut_columns *c, const strut_state *state, strut_column column,
                            double d[2]) {
  const strut_member_table *t = &c->model->members;
  bool tilt = column.kind == STRUT_COLUMN_TILT;
  size_t a = tilt ? t->from[column.item] : 2 * (size_t)column.item;
  size_t b = tilt ? t->to[column.item] : 2 * (size_t)column.other;
  for (size_t k = 0; k < 2; k++) d[k] = state->q[b + k] - state->q[a + k];
}

static double total_energy(const strut_energies *s, double *size) {
  *size = fabs(s->kinetic) + fabs(s->elastic) + fabs(s->gravity) + fabs(s->contact);
  return s->kinetic + s->elastic + s->gravity + s->contact;
}

static double column_time(const strut_columns *c, const strut_state *state) {
  return c->time + state->time_offset;
}

/* Place or velocity of a mass on a member, along x or y. */
static double evaluate_slider(const strut_columns *c, const strut_state *state,
                              strut_column column) {
  size_t slider = (size_t)column.item;
  const strut_sliding_item *s = &c->model->sliding.item[slider];
  double t = column_time(c, state), far = strut_sliding_mass_share(c->model->scene, slider, t);
  uint32_t axis = column.kind == STRUT_COLUMN_SLIDER_Y || column.kind == STRUT_COLUMN_SLIDER_VY;
  bool rate = column.kind == STRUT_COLUMN_SLIDER_VX || column.kind == STRUT_COLUMN_SLIDER_VY;
  const double *z = rate ? state->v : state->q, *q = state->q;
  uint32_t a = s->at[0] + axis, b = s->at[1] + axis;
  double place = (1.0 - far) * z[a] + far * z[b];
  return rate ? place + strut_sliding_mass_rate(c->model->scene, slider, t) * (q[b] - q[a]) : place;
}

/* The largest absolute force of a member; *member: which; *branch: also at which end, and its sign. */
static double largest_force(const strut_columns *c, const strut_state *state, int32_t *member,
                            int32_t *branch) {
  double most = 0.0;
  *member = *branch = -1;
  for (int32_t j = 0; j < c->model->members.count; j++) {
    double first = strut_member_measure(c->model, state, j).force;
    double last = last_force_of_member(c->model, state, j);
    bool other = fabs(last) > fabs(first);
    double force = other ? last : first;
    if (!(fabs(force) > most)) continue;
    most = fabs(force);
    *member = j, *branch = 4 * j + 2 * other + (force < 0.0);
  }
  return most;
}

/* Evaluates a column; *size: magnitude of the terms that it sums, where that is not the value; *branch as in
   strut_columns. */
static double evaluate_column(strut_columns *c, const strut_state *state, strut_column column,
                              double *size, int32_t *branch) {
  size_t at = 2 * (size_t)(column.item < 0 ? 0 : column.item);
  const double *w = state->work;
  double d[2];
  switch (column.kind) {
    case STRUT_COLUMN_TIME: return column_time(c, state);
    case STRUT_COLUMN_NODE_X: return state->q[at];
    case STRUT_COLUMN_NODE_Y: return state->q[at + 1];
    case STRUT_COLUMN_NODE_VX: return state->v[at];
    case STRUT_COLUMN_NODE_VY: return state->v[at + 1];
    case STRUT_COLUMN_HEIGHT: return height_above_ground(c, state, state->q + at);
    case STRUT_COLUMN_NORMAL:
      return column.item < 0 ? 0.0 : sum_of_node(c, column.item, state->latest->normal);
    case STRUT_COLUMN_FRICTION:
      return column.item < 0 ? 0.0 : sum_of_node(c, column.item, state->latest->friction);
    case STRUT_COLUMN_LENGTH: return strut_member_measure(c->model, state, column.item).length;
    case STRUT_COLUMN_STRETCH:
      return strut_member_measure(c->model, state, column.item).length -
             state->latest->rest[column.item];
    case STRUT_COLUMN_RATE: return strut_member_measure(c->model, state, column.item).rate;
    case STRUT_COLUMN_FORCE: return strut_member_measure(c->model, state, column.item).force;
    case STRUT_COLUMN_PLASTIC: return plastic_of_member(c->model, state, column.item);
    case STRUT_COLUMN_LAST_FORCE: return last_force_of_member(c->model, state, column.item);
    case STRUT_COLUMN_HINGE_PLASTIC: return strut_element_plastic(c->model, state, column.item);
    case STRUT_COLUMN_HINGE_ANGLE:
    case STRUT_COLUMN_HINGE_RATE:
    case STRUT_COLUMN_MOMENT: return evaluate_hinge(c, state, column);
    case STRUT_COLUMN_TILT:
    case STRUT_COLUMN_ANGLE: node_difference(c, state, column, d); return atan2(d[1], d[0]);
    case STRUT_COLUMN_DISTANCE: node_difference(c, state, column, d); return hypot(d[0], d[1]);
    case STRUT_COLUMN_CENTRE_X:
    case STRUT_COLUMN_CENTRE_Y:
    case STRUT_COLUMN_CENTRE_VX:
    case STRUT_COLUMN_CENTRE_VY: return evaluate_centre(c, state, column.kind, size);
    case STRUT_COLUMN_KINETIC: return c->stored.kinetic;
    case STRUT_COLUMN_ELASTIC: return c->stored.elastic;
    case STRUT_COLUMN_GRAVITY: return c->stored.gravity;
    case STRUT_COLUMN_GROUND: return c->stored.contact;
    case STRUT_COLUMN_TOTAL: return total_energy(&c->stored, size);
    case STRUT_COLUMN_DRIVES: return w[STRUT_POWER_DRIVE];
    case STRUT_COLUMN_LOADS: return w[STRUT_POWER_LOAD] + strut_energy_load_work(c->model, state);
    case STRUT_COLUMN_BELT: return w[STRUT_POWER_BELT];
    case STRUT_COLUMN_SUPPORTS: return strut_support_motion_work(c->model, state);
    case STRUT_COLUMN_LOST_MEMBERS: return w[STRUT_POWER_MEMBERS];
    case STRUT_COLUMN_LOST_CONTACT: return w[STRUT_POWER_CONTACT];
    case STRUT_COLUMN_LOST_FRICTION: return w[STRUT_POWER_FRICTION];
    case STRUT_COLUMN_LOST:
      return w[STRUT_POWER_MEMBERS] + w[STRUT_POWER_CONTACT] + w[STRUT_POWER_FRICTION];
    case STRUT_COLUMN_CELL_AREA: return strut_cell_measure(c->model, state, column.item).area;
    case STRUT_COLUMN_PRESSURE: return strut_cell_measure(c->model, state, column.item).pressure;
    case STRUT_COLUMN_COLLISION_GAP:
      return strut_collision_measure(c->model, state, column.item).gap;
    case STRUT_COLUMN_COLLISION_FORCE:
      return strut_collision_measure(c->model, state, column.item).force;
    case STRUT_COLUMN_DISTANCE_VALUE:
      return strut_distance_measure(c->model, state, column.item).distance;
    case STRUT_COLUMN_DISTANCE_RATE:
      return strut_distance_measure(c->model, state, column.item).rate;
    case STRUT_COLUMN_DISTANCE_FORCE:
      return strut_distance_measure(c->model, state, column.item).force;
    case STRUT_COLUMN_SENSOR: return state->latest->sensor[column.item];
    case STRUT_COLUMN_SENSOR_RATE: return state->latest->sensor_rate[column.item];
    case STRUT_COLUMN_STATE: return state->v[c->model->feedback.base + column.item];
    case STRUT_COLUMN_SIGNAL:
      return strut_drive_signal(c->model, state, state->v, column.item, column_time(c, state));
    case STRUT_COLUMN_SLIDER_X:
    case STRUT_COLUMN_SLIDER_Y:
    case STRUT_COLUMN_SLIDER_VX:
    case STRUT_COLUMN_SLIDER_VY: return evaluate_slider(c, state, column);
    case STRUT_COLUMN_SLIDER_SHARE:
      return strut_sliding_mass_share(c->model->scene, (size_t)column.item, column_time(c, state));
    case STRUT_COLUMN_LEAST_GAP: return strut_nearby_least_gap(c->model, state, state->q, branch);
    case STRUT_COLUMN_LARGEST_FORCE: return largest_force(c, state, &c->loaded_now, branch);
    case STRUT_COLUMN_COUNT: break;
  }
  return 0.0;
}

/* Computes forces and energies at the state where a column needs them. */
static void prepare_state(strut_columns *c, const strut_state *state, double t) {
  c->time = t;
  if (c->forces && !strut_forces_show_held(c->model, state))
    strut_forces_observe(c->model, state, t);
  else
    strut_drive_apply(c->model, state, t);
  if (c->energies) c->stored = strut_energy_evaluate(c->model, state, t);
  for (int32_t i = 0; c->speeds && i < c->model->node_count; i++)
    c->fastest = fmax(c->fastest, hypot(state->v[2 * i], state->v[2 * i + 1]));
}

static void note_extremes(strut_columns *c, size_t i, double size) {
  if (c->column[i].kind == STRUT_COLUMN_LARGEST_FORCE && c->value[i] > c->most[i])
    c->loaded_most = c->loaded_now;
  c->least[i] = fmin(c->least[i], c->value[i]);
  c->most[i] = fmax(c->most[i], c->value[i]);
  c->largest[i] = fmax(c->largest[i], size);
}

void strut_columns_evaluate(strut_columns *c, const strut_state *state, double t) {
  prepare_state(c, state, t);
  for (size_t i = 0; i < c->count; i++) {
    double size = -1.0, last = c->value[i];
    double now = evaluate_column(c, state, c->column[i], &size, &c->branch[i]);
    if (is_angle(c->column[i].kind)) now += STRUT_TAU * round((last - now) / STRUT_TAU);
    c->value[i] = now;
    note_extremes(c, i, size < 0.0 ? fabs(now) : size);
  }
}

void strut_columns_begin(strut_columns *c, const strut_state *state, double t) {
  c->fastest = 0.0;
  c->loaded_now = c->loaded_most = -1;
  prepare_state(c, state, t);
  for (size_t i = 0; i < c->count; i++) {
    double size = -1.0;
    c->value[i] = evaluate_column(c, state, c->column[i], &size, &c->branch[i]);
    c->least[i] = (double)INFINITY, c->most[i] = -(double)INFINITY, c->largest[i] = 0.0;
    note_extremes(c, i, size < 0.0 ? fabs(c->value[i]) : size);
  }
}

double strut_columns_span(const strut_columns *c, size_t index) {
  bool sums = c->column[index].kind ==
              STRUT_COLUMN_TOTAL; /* the terms vary even where the total does not */
  return sums ? c->largest[index] : c->most[index] - c->least[index];
}

/* The stiffest spring of a member, or of its elements. */
static double member_stiffness(const strut_model *model, int32_t member) {
  const strut_element *e = strut_element_of_member(&model->elements, member);
  double stiffest = model->members.stiffness[member];
  for (; e; e = e->sibling >= 0 ? &model->elements.element[e->sibling] : NULL)
    stiffest = fmax(stiffest, e->numbers.stiffness);
  return stiffest;
}

double strut_columns_noise(const strut_columns *c, size_t index) {
  strut_column column = c->column[index];
  bool joined = c->model->members.count > 0 || c->model->elements.count > 0;
  double length = joined ? POSITION_ROUNDING * c->model->size : 0.0;
  if (is_length(column.kind)) return fmax(length, POSITION_ROUNDING * c->largest[index]);
  if (is_angle(column.kind)) return POSITION_ROUNDING;
  if (is_speed(column.kind)) return SUM_ROUNDING * c->fastest;
  if (column.kind == STRUT_COLUMN_FORCE || column.kind == STRUT_COLUMN_LAST_FORCE)
    return length * member_stiffness(c->model, column.item);
  if (column.kind == STRUT_COLUMN_LARGEST_FORCE)
    return c->loaded_most < 0 ? 0.0 : length * member_stiffness(c->model, c->loaded_most);
  if (column.kind == STRUT_COLUMN_HINGE_RATE) return SUM_ROUNDING * c->fastest / c->model->size;
  if (column.kind == STRUT_COLUMN_MOMENT)
    return POSITION_ROUNDING * c->model->elements.element[column.item].numbers.stiffness;
  if (column.kind == STRUT_COLUMN_COLLISION_FORCE || column.kind == STRUT_COLUMN_DISTANCE_FORCE)
    return length * c->model->elements.element[column.item].numbers.stiffness;
  if (column.kind == STRUT_COLUMN_CELL_AREA) return length * c->model->size;
  if (column.kind == STRUT_COLUMN_PRESSURE)
    return length * c->model->size * c->model->elements.element[column.item].numbers.stiffness;
  if (column.kind == STRUT_COLUMN_NORMAL && column.item >= 0)
    return length * c->model->contacts.entry[column.item].stiffness;
  return 0.0;
}
