/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/elements.h"

#include <assert.h>
#include <string.h>

#include "engine/forces/capstan.h"
#include "engine/forces/history.h"
#include "engine/forces/members_kernel.h"
#include "engine/forces/nearby.h"
#include "engine/forces/strains/strains.h"
#include "engine/model/pose.h"

/* The numbers that the function of a strain takes beside the positions, and those of its second derivative. */
#define STRUT_REFERENCE_TURN(e, turn) turn
#define STRUT_REFERENCE_AXIS(e, turn) (e)->axis
#define STRUT_REFERENCE_ARC(e, turn) (e)->axis, (e)->radius
#define STRUT_BEND_TURN(e)
#define STRUT_BEND_AXIS(e)
#define STRUT_BEND_ARC(e) (e)->axis, (e)->radius,

/* Strain and gradient. */
static double strain_of(const strut_element *element, const uint32_t *at, const double *q,
                        double turn, double *b) {
  switch (element->strain) {
#define STRUT_CASE(NAME, name, unit, reference, ...)                                               \
  case STRUT_STRAIN_##NAME:                                                                        \
    return strut_strain_##name(at, element->nodes, q, STRUT_REFERENCE_##reference(element, turn),  \
                               b);
    STRUT_STRAINS(STRUT_CASE, )
#undef STRUT_CASE
    case STRUT_STRAIN_COUNT: break;
  }
  return 0.0;
}

double strut_element_strain(const strut_model *model, int32_t element, const double *q, double turn,
                            double *b) {
  assert(element >= 0 && element < model->elements.count);
  const strut_element *e = &model->elements.element[element];
  return strain_of(e, model->elements.at + e->first, q, turn, b);
}

void strut_element_bend(const strut_model *model, int32_t element, const double *q, double t,
                        double *h) {
  const strut_element *e = &model->elements.element[element];
  const uint32_t *at = model->elements.at + e->first;
  switch (e->strain) {
#define STRUT_CASE(NAME, name, unit, reference, ...)                                               \
  case STRUT_STRAIN_##NAME:                                                                        \
    strut_strain_##name##_bend(at, e->nodes, q, STRUT_BEND_##reference(e) t, h);                   \
    return;
    STRUT_STRAINS(STRUT_CASE, )
#undef STRUT_CASE
    case STRUT_STRAIN_COUNT: break;
  }
}

void strut_element_evaluate(const strut_model *model, int32_t element, const double *rest,
                            const double *q, double turn, strut_element_pose *pose) {
  assert(element >= 0 && element < model->elements.count);
  const strut_element *e = &model->elements.element[element];
  pose->natural = strut_element_natural(e, rest);
  double near = strut_element_is_gone(pose->natural) ? 0.0 : strut_element_near(e, pose->natural);
  pose->strain = strain_of(e, model->elements.at + e->first, q, isnan(turn) ? near : turn, pose->b);
  if (strut_element_is_gone(pose->natural)) {
    pose->acts = false;
    pose->force = pose->energy = pose->slope = 0.0;
    return;
  }
  double x = pose->strain - pose->natural;
  strut_law_response r = strut_law_respond(e->law, &e->numbers, pose->strain, pose->natural,
                                           strut_element_piece(e, rest, x));
  bool beyond = !e->carries || e->carries * x > 0.0;
  pose->acts = beyond && (!e->carries || e->carries * r.force > 0.0);
  pose->force = pose->acts ? r.force : 0.0;
  pose->energy = beyond ? r.energy : 0.0;
  if (e->remembers) pose->energy += strut_history_locked_energy(e, rest);
  if (strut_capstan_remembers(e, rest))
    pose->energy = strut_capstan_energy(model, element, rest, q);
  pose->slope = pose->acts ? r.slope : 0.0;
}

double strut_element_rate(const strut_model *model, int32_t element, const strut_element_pose *pose,
                          const double *velocity) {
  assert(element >= 0 && element < model->elements.count);
  const strut_element *e = &model->elements.element[element];
  const uint32_t *at = model->elements.at + e->first;
  double sum = 0.0;
  for (int32_t k = 0; k < e->nodes; k++)
    sum += pose->b[2 * k] * velocity[at[k]] + pose->b[2 * k + 1] * velocity[at[k] + 1];
  return sum;
}

double strut_member_elastic_tension(const strut_model *model, const double *rest, int32_t member,
                                    const double *q) {
  assert(member >= 0 && (size_t)member < model->scene->member_count);
  const strut_element *element = strut_element_of_member(&model->elements, member);
  strut_member_pose plain = strut_member_pose_at(&model->members, rest, member, q);
  double sum = strut_member_elastic_force(&model->members, member, &plain);
  strut_element_pose pose;
  for (; element;
       element = element->sibling >= 0 ? &model->elements.element[element->sibling] : NULL) {
    strut_element_evaluate(model, (int32_t)(element - model->elements.element), rest, q,
                           (double)NAN, &pose);
    sum += pose.force;
  }
  return sum;
}

double strut_member_path_length(const strut_model *model, int32_t member, const double *q) {
  assert(member >= 0 && (size_t)member < model->scene->member_count);
  const strut_element *element = strut_element_of_member(&model->elements, member);
  double b[STRUT_MOST_GRADIENT];
  if (!element) return strut_member_length(&model->members, member, q);
  return strain_of(element, model->elements.at + element->first, q, 0.0, b);
}

double strut_elements_energy(const strut_model *model, const double *rest, const double *turn,
                             const double *q, const strut_nearby *near) {
  double sum = 0.0;
  strut_element_pose pose;
  int32_t count = near ? near->count : model->elements.count;
  for (int32_t k = 0; k < count; k++) {
    int32_t i = near ? near->element[k] : k;
    if (!near && model->elements.scattered && strut_nearby_is_far(model, i, q, false)) continue;
    strut_element_evaluate(model, i, rest, q, turn ? turn[i] : (double)NAN, &pose);
    if (model->elements.element[i].role != STRUT_ELEMENT_LOAD) sum += pose.energy;
  }
  return sum;
}

/* An element with its damper: what it exerts, the elastic part, and rates; excess as of its law. */
typedef struct exertion {
  double force, elastic, own_rate, excess;
} exertion;

/* Its modes are those that a method with events has frozen, or those that hold here. */
static inline exertion exert(const strut_element *element, const strut_state *state, int32_t i,
                             const strut_law_response *response, double x, double own_rate) {
  double force = response->force + element->damping * own_rate;
  if (element->carries) {
    int8_t mode = state->modes.element_acts[i];
    bool acts = mode ? mode > 0 : element->carries * x > 0.0 && element->carries * force > 0.0;
    /* a damper may outweigh the spring: that relaxes then, and the damper takes its energy */
    bool beyond = element->carries * x > 0.0;
    if (!acts)
      return (exertion){0.0, beyond ? response->force : 0.0, own_rate,
                        beyond ? response->excess : 0.0};
  }
  return (exertion){force, response->force, own_rate, response->excess};
}

static inline void add_powers(const strut_element *element, const strut_state *state,
                              const exertion *self, double rest_rate) {
  bool cell = strut_law_is_of_cells(element->law); /* its drive is all excess */
  double drive = (cell ? self->excess : self->excess - self->force) * rest_rate,
         lost = (self->force - self->elastic) * self->own_rate;
  bool load = element->role == STRUT_ELEMENT_LOAD;
  if (load) drive = -self->force * self->own_rate;
  strut_power_add_two(state->latest->power, load ? STRUT_POWER_LOAD : STRUT_POWER_DRIVE, drive,
                      STRUT_POWER_MEMBERS, lost);
}

/* One element; `strain` and `law` are inlined, so that a block's loop tests neither. */
#define STRUT_ADD_ELEMENT(strain_name, law_name, reference)                                        \
  static void add_##strain_name##_##law_name(const strut_model *model, const strut_state *state,   \
                                             const strut_element_block *block, const double *q,    \
                                             const double *v, double *force) {                     \
    const strut_element_table *t = &model->elements;                                               \
    for (int32_t i = block->begin; i < block->end; i++) {                                          \
      const strut_element *e = &t->element[i];                                                     \
      const uint32_t *at = t->at + e->first;                                                       \
      double b[STRUT_MOST_GRADIENT], rate = 0.0;                                                   \
      double strain = strut_strain_##strain_name(                                                  \
          at, e->nodes, q, STRUT_REFERENCE_##reference(e, state->history.turn[i]), b);             \
      double natural = strut_element_natural(e, state->latest->rest);                              \
      double rest_rate = e->slot >= 0 ? state->latest->rest_rate[e->slot] : 0.0;                   \
      if (e->damping > 0.0 || state->balance)                                                      \
        for (int32_t k = 0; k < e->nodes; k++)                                                     \
          rate += b[2 * k] * v[at[k]] + b[2 * k + 1] * v[at[k] + 1];                               \
      strut_law_response r =                                                                       \
          strut_law_##law_name(&e->numbers, strain, natural, state->modes.element_piece[i]);       \
      exertion x = exert(e, state, i, &r, strain - natural, rate - rest_rate);                     \
      for (int32_t k = 0; k < e->nodes; k++) {                                                     \
        force[at[k]] -= x.force * b[2 * k];                                                        \
        force[at[k] + 1] -= x.force * b[2 * k + 1];                                                \
      }                                                                                            \
      if (state->balance) add_powers(e, state, &x, rest_rate);                                     \
    }                                                                                              \
  }

#define STRUT_ADD_CELL(LAW, law, word, needs, context) STRUT_ADD_ELEMENT_OF(context, law)
#define STRUT_ADD_ELEMENT_OF(context, law) STRUT_ADD_ELEMENT_WITH(STRUT_UNPACK context, law)
#define STRUT_ADD_ELEMENT_WITH(...) STRUT_ADD_ELEMENT_IN_ORDER(__VA_ARGS__)
#define STRUT_ADD_ELEMENT_IN_ORDER(strain, reference, law) STRUT_ADD_ELEMENT(strain, law, reference)
#define STRUT_UNPACK(...) __VA_ARGS__
#define STRUT_ADD_ROW(NAME, name, unit, reference, ...)                                            \
  STRUT_ALL_LAWS(STRUT_ADD_CELL, (name, reference))
STRUT_STRAINS(STRUT_ADD_ROW, )

typedef void add_block(const strut_model *model, const strut_state *state,
                       const strut_element_block *block, const double *q, const double *velocity,
                       double *force);

#define STRUT_NAME_CELL(LAW, law, word, needs, strain) add_##strain##_##law,
#define STRUT_NAME_ROW(NAME, name, ...) {STRUT_ALL_LAWS(STRUT_NAME_CELL, name)},
static add_block *const adders[STRUT_STRAIN_COUNT][STRUT_LAW_COUNT] = {
    STRUT_STRAINS(STRUT_NAME_ROW, )};

/* Of a block with collisions, those that may act. */
static void add_nearby(const strut_model *model, const strut_state *state,
                       const strut_element_block *block, const double *q, const double *velocity,
                       double *force) {
  const strut_nearby *near = strut_nearby_at(model, state, q);
  add_block *add = adders[block->strain][block->law];
  strut_element_block one = *block;
  for (int32_t k = strut_nearby_find(near, block->begin); k < near->count; k++) {
    one.begin = near->element[k], one.end = one.begin + 1;
    if (one.begin >= block->end) return;
    add(model, state, &one, q, velocity, force);
  }
}

void strut_elements_add_forces(const strut_model *model, const strut_state *state, const double *q,
                               const double *velocity, double *force) {
  for (int32_t b = 0; b < model->elements.block_count; b++) {
    const strut_element_block *block = &model->elements.block[b];
    if (block->collides && model->elements.scattered)
      add_nearby(model, state, block, q, velocity, force);
    else if (block->remembers)
      strut_history_add_forces(model, state, block, q, velocity, force);
    else
      adders[block->strain][block->law](model, state, block, q, velocity, force);
  }
}

void strut_elements_keep_turns(const strut_model *model, strut_state *state) {
  double b[STRUT_MOST_GRADIENT];
  for (int32_t k = 0; k < model->elements.block_count; k++) {
    const strut_element_block *block = &model->elements.block[k];
    for (int32_t i = block->begin; i < block->end && block->strain == STRUT_STRAIN_ANGLE; i++)
      state->history.turn[i] = strut_element_strain(model, i, state->q, state->history.turn[i], b);
  }
}

int32_t strut_cell_that_collapsed(const strut_model *model, const double *q) {
  double b[STRUT_MOST_GRADIENT];
  for (int32_t i = 0; i < model->elements.count && model->scene->cell_count; i++) {
    const strut_element *element = &model->elements.element[i];
    if (element->role != STRUT_ELEMENT_CELL) continue;
    double area = strain_of(element, model->elements.at + element->first, q, 0.0, b);
    if (!(area > STRUT_CELL_COLLAPSED * element->numbers.area)) return element->item;
  }
  return -1;
}

int32_t strut_member_that_is_wound_in(const strut_model *model, const double *rest) {
  const strut_element_table *elements = &model->elements;
  for (int32_t b = 0; b < elements->block_count; b++)
    for (int32_t i = elements->block[b].begin;
         elements->block[b].law == STRUT_LAW_AXIAL && i < elements->block[b].end; i++) {
      const strut_element *element = &elements->element[i];
      double natural = rest[element->remembers ? element->base : element->slot];
      if (strut_axial_length(&element->numbers, natural) != natural) return element->item;
    }
  return -1;
}

strut_element_motion strut_element_move(const strut_model *model, const strut_state *state,
                                        int32_t element, const double *q, const double *velocity) {
  assert(element >= 0 && element < model->elements.count);
  const strut_element *e = &model->elements.element[element];
  const uint32_t *at = model->elements.at + e->first;
  double b[STRUT_MOST_GRADIENT], rate = 0.0;
  double strain = strain_of(e, at, q, state->history.turn[element], b);
  double natural = e->remembers ? strut_history_natural(model, state, element, strain)
                                : strut_element_natural(e, state->latest->rest);
  if (strut_element_is_gone(natural)) return (strut_element_motion){-e->carries, 0.0, -e->carries};
  for (int32_t k = 0; k < e->nodes; k++)
    rate += b[2 * k] * velocity[at[k]] + b[2 * k + 1] * velocity[at[k] + 1];
  int32_t slot = e->remembers ? e->base : e->slot;
  if (slot >= 0) rate -= state->latest->rest_rate[slot];
  int piece = state->modes.element_piece[element];
  if (piece < 0) piece = strut_element_piece(e, state->latest->rest, strain - natural);
  strut_law_response r = strut_law_respond(e->law, &e->numbers, strain, natural, piece);
  return (strut_element_motion){strain - natural, rate, r.force + e->damping * rate};
}

double strut_element_measure_at(const strut_model *model, const strut_state *state, int32_t element,
                                const double *q, const double *velocity, strut_element_pose *pose) {
  assert(element >= 0 && element < model->elements.count);
  const strut_element *e = &model->elements.element[element];
  strut_element_evaluate(model, element, state->latest->rest, q, state->history.turn[element],
                         pose);
  if (strut_element_is_gone(pose->natural)) return 0.0;
  if (strut_capstan_remembers(e, state->latest->rest))
    return strut_capstan_tensions(model, state, element, state->q, state->v).first;
  int32_t slot = e->remembers ? e->base : e->slot;
  double rest_rate = slot >= 0 ? state->latest->rest_rate[slot] : 0.0;
  strut_law_response r =
      strut_law_respond(e->law, &e->numbers, pose->strain, pose->natural,
                        strut_element_piece(e, state->latest->rest, pose->strain - pose->natural));
  double own = strut_element_rate(model, element, pose, velocity) - rest_rate;
  double force = exert(e, state, element, &r, pose->strain - pose->natural, own).force;
  /* where a step ends a little beyond the end of a frozen mode */
  return e->carries && !(e->carries * force > 0.0) ? 0.0 : force;
}
