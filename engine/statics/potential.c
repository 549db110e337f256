/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/potential.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/model/compile_parts.h"

static void sum_forces(strut_potential *potential) {
  const strut_model *model = potential->model;
  const strut_scene *scene = model->scene;
  double g = hypot(scene->gravity[0], scene->gravity[1]);
  if (model->constant_force)
    memcpy(potential->force, model->constant_force,
           (size_t)model->length * sizeof *potential->force);
  for (int32_t i = 0; i < model->node_count; i++) potential->force_scale += g * model->weight[i];
  for (size_t i = 0; i < scene->load_count; i++)
    if (scene->loads[i].signal < 0)
      potential->force_scale +=
          hypot(scene->loads[i].force[0], scene->loads[i].force[1]) +
          fabs(scene->loads[i].moment) / (model->size > 0 ? model->size : 1.0);
}

static bool make_pattern(strut_potential *potential, strut_arena *arena) {
  const strut_model *model = potential->model;
  size_t most = strut_tangent_entries(model, true);
  strut_arena scratch = {0};
  strut_triplets sum = {0};
  potential->place = strut_arena_allocate(arena, most, sizeof *potential->place);
  if (potential->place && strut_triplets_reserve(&sum, most, &scratch)) {
    strut_tangent_add_pattern(model, potential->row_of, true, &sum);
    potential->pattern = strut_sparse_build(potential->n, &sum, arena);
  }
  strut_arena_free(&scratch);
  if (!potential->pattern) return false;
  strut_tangent_find_places(model, potential->row_of, true, potential->pattern, potential->place);
  return true;
}

static strut_status create(const strut_model *model, const uint8_t *held, const int32_t *rows,
                           int32_t n, bool ground, strut_arena *arena, strut_potential **potential,
                           strut_error *error) {
  size_t length = (size_t)model->length;
  strut_potential *p = *potential = strut_arena_allocate(arena, 1, sizeof *p);
  if (!p || !STRUT_ALLOCATE(arena, STRUT_NEW(p->coordinate, length), STRUT_NEW(p->row_of, length),
                            STRUT_NEW(p->force, length)))
    return strut_no_memory(error, "");
  p->model = model;
  p->ground = ground;
  p->n = rows ? n : strut_number_free(model, held, p->row_of, p->coordinate);
  for (int32_t at = model->length - 1; at >= 0 && rows; at--)
    if ((p->row_of[at] = rows[at]) >= 0) p->coordinate[rows[at]] = at;
  sum_forces(p);
  return make_pattern(p, arena) ? STRUT_OK : strut_no_memory(error, "");
}

strut_status strut_potential_create(const strut_model *model, const uint8_t *held, bool ground,
                                    strut_arena *arena, strut_potential **potential,
                                    strut_error *error) {
  return create(model, held, NULL, 0, ground, arena, potential, error);
}

strut_status strut_potential_create_tied(const strut_model *model, const int32_t *rows, int32_t n,
                                         strut_arena *arena, strut_potential **potential,
                                         strut_error *error) {
  return create(model, NULL, rows, n, false, arena, potential, error);
}

void strut_potential_move(const strut_potential *potential, const double *step, double factor,
                          const double *q, double *to) {
  for (int32_t at = 0; at < potential->model->length; at++)
    to[at] = potential->row_of[at] < 0 ? q[at] : q[at] + factor * step[potential->row_of[at]];
}

/* Minus moment times angle of constant couples at q [J], each angle nearest to that in the shape `near`. */
static double couples_potential(const strut_model *model, const double *near, const double *q) {
  double sum = 0.0, b[STRUT_MOST_GRADIENT];
  strut_element_pose pose;
  for (int32_t i = 0; i < model->elements.count && model->elements.couples; i++) {
    const strut_element *element = &model->elements.element[i];
    if (element->role != STRUT_ELEMENT_LOAD) continue;
    double at = strut_element_strain(model, i, near, strut_element_start(model, i), b);
    strut_element_evaluate(model, i, model->members.rest, q, at, &pose);
    sum += pose.energy;
  }
  return sum;
}

static double elastic_energy(const strut_potential *potential, const double *q) {
  const strut_member_table *members = &potential->model->members;
  double sum = 0.0;
  for (int32_t j = 0; j < members->count; j++) {
    strut_member_pose m = strut_member_pose_at(members, members->rest, j, q);
    sum += strut_member_elastic_energy(members, j, &m);
  }
  if (potential->model->elements.count)
    sum += strut_elements_energy(potential->model, members->rest, NULL, q, NULL);
  return sum;
}

double strut_potential_value(const strut_potential *potential, const double *q) {
  return strut_potential_value_near(potential, q, q);
}

double strut_potential_value_near(const strut_potential *potential, const double *q,
                                  const double *near) {
  const strut_contact_table *contacts = &potential->model->contacts;
  double sum = elastic_energy(potential, q), work = 0.0;
  for (int32_t at = 0; at < 2 * potential->model->node_count; at++)
    work += potential->force[at] * q[at];
  for (int32_t i = 0; i < contacts->count && potential->ground; i++) {
    double gap = strut_contact_gap(contacts, i, q);
    if (gap < 0.0) sum += 0.5 * contacts->entry[i].stiffness * gap * gap;
  }
  return sum - work + couples_potential(potential->model, near, q);
}

double strut_potential_energy(const strut_potential *potential, const double *q) {
  const double *g = potential->model->scene->gravity, *weight = potential->model->weight;
  double sum = 0.0;
  for (int32_t i = 0; i < potential->model->node_count; i++)
    sum += weight[i] * (g[0] * q[2 * i] + g[1] * q[2 * i + 1]);
  return elastic_energy(potential, q) - sum;
}

strut_force_visit strut_potential_visit(const strut_potential *potential, const double *q,
                                        double least) {
  return (strut_force_visit){
      .model = potential->model,
      .q = q,
      .rest = potential->model->members.rest,
      .least = least,
      .closed = potential->ground ? STRUT_CLOSED_TOUCHING : STRUT_CLOSED_NONE};
}

void strut_potential_force(const strut_potential *potential, const double *q, double *sum) {
  strut_force_visit visit = strut_potential_visit(potential, q, -HUGE_VAL);
  memcpy(sum, potential->force, (size_t)potential->model->length * sizeof *sum);
  for (const strut_force *force; (force = strut_force_next(&visit));)
    for (int32_t k = 0; k < 2 * force->nodes; k++)
      sum[strut_force_coordinate(force, k)] -= force->pose.force * force->pose.b[k];
}

/* The same sums in the same order as the force, kept where they are free. */
void strut_potential_gradient(const strut_potential *potential, const double *q, double *gradient) {
  strut_force_visit visit = strut_potential_visit(potential, q, -HUGE_VAL);
  for (int32_t i = 0; i < potential->n; i++) gradient[i] = 0.0;
  for (int32_t at = 0; at < potential->model->length; at++)
    if (potential->row_of[at] >= 0) gradient[potential->row_of[at]] -= potential->force[at];
  for (const strut_force *force; (force = strut_force_next(&visit));)
    for (int32_t k = 0; k < force->nodes; k++) {
      const int32_t *row = potential->row_of + force->at[k];
      const double *b = force->pose.b + 2 * k;
      if (row[0] >= 0) gradient[row[0]] += force->pose.force * b[0];
      if (row[1] >= 0) gradient[row[1]] += force->pose.force * b[1];
    }
}

/* The last bits of the coordinates, through the gradient to the strain, and back to a force. */
double strut_potential_rounding(const strut_potential *potential, const double *q) {
  strut_force_visit visit = strut_potential_visit(potential, q, -HUGE_VAL);
  double largest = 0.0, forces = 0.0;
  for (int32_t at = 0; at < 2 * potential->model->node_count; at++)
    if (potential->row_of[at] >= 0) forces = strut_larger(forces, fabs(potential->force[at]));
  for (const strut_force *force; (force = strut_force_next(&visit));) {
    double bits = force->kind == STRUT_FORCE_ELEMENT ? fabs(force->pose.strain) * DBL_EPSILON : 0.0;
    double steepest = 0.0;
    bool free = force->kind != STRUT_FORCE_MEMBER;
    for (int32_t k = 0; k < force->nodes; k++) {
      const double *at = q + force->at[k], *b = &force->pose.b[2 * k];
      double slope = strut_larger(fabs(b[0]), fabs(b[1]));
      if (force->kind != STRUT_FORCE_ELEMENT) slope = 1.0; /* a length in any direction */
      free =
          free || potential->row_of[force->at[k]] >= 0 || potential->row_of[force->at[k] + 1] >= 0;
      bits = strut_larger(bits, slope * strut_coordinate_rounding(at, at));
      steepest = strut_larger(steepest, slope);
    }
    bits = steepest * (fabs(force->pose.slope) * bits + fabs(force->pose.force) * DBL_EPSILON);
    if (free) largest = strut_larger(largest, bits);
  }
  return largest + forces * DBL_EPSILON;
}

double strut_force_stiffest(const strut_model *model, int32_t number) {
  static const double places[] = {-0.3, -0.1, -0.01, 0.0, 0.01, 0.1, 0.3};
  strut_force force;
  strut_force_begin(model, number, &force);
  if (force.kind == STRUT_FORCE_MEMBER) return model->members.stiffness[force.index];
  if (force.kind == STRUT_FORCE_CONTACT) return model->contacts.entry[force.index].stiffness;
  const strut_element *element = &model->elements.element[force.index];
  double natural = strut_element_start(model, force.index), stiffest = 0.0;
  double size = model->size > 0.0 ? model->size : 1.0;
  bool angle = element->strain == STRUT_STRAIN_ANGLE;
  if (element->strain == STRUT_STRAIN_AREA) return element->numbers.stiffness * size * size;
  for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
    double x = places[k] * (angle ? 1.0 : natural > 0.0 ? natural : size);
    double slope =
        strut_law_respond(element->law, &element->numbers, natural + x, natural, -1).slope;
    stiffest = fmax(stiffest, fabs(slope));
  }
  return angle ? stiffest / (size * size) : stiffest;
}

double strut_stiffest(const strut_model *model) {
  double stiffest = 0.0;
  for (int32_t i = 0; i < strut_force_count(model, false); i++)
    stiffest = fmax(stiffest, strut_force_stiffest(model, i));
  return stiffest;
}

strut_sparse *strut_potential_matrix(const strut_potential *potential, strut_arena *arena) {
  const strut_sparse *pattern = potential->pattern;
  strut_sparse *matrix = strut_arena_allocate(arena, 1, sizeof *matrix);
  if (!matrix) return NULL;
  *matrix = *pattern; /* rows and columns are shared: they never change */
  matrix->value = strut_arena_allocate(arena, (size_t)pattern->start[potential->n], sizeof(double));
  return matrix->value ? matrix : NULL;
}

void strut_potential_hessian(const strut_potential *potential, const double *q,
                             strut_sparse *hessian) {
  strut_potential_hessian_above(potential, q, 0.0, hessian);
}

void strut_potential_hessian_above(const strut_potential *potential, const double *q, double least,
                                   strut_sparse *hessian) {
  assert(hessian->n == potential->n);
  double matrix[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT];
  strut_force_visit visit = strut_potential_visit(potential, q, least);
  memset(hessian->value, 0, (size_t)hessian->start[hessian->n] * sizeof *hessian->value);
  for (const strut_force *force; (force = strut_force_next(&visit));) {
    strut_force_stiffness(potential->model, force, q, matrix);
    strut_force_scatter(force, matrix, potential->place, hessian->value);
  }
}

bool strut_force_has_collapsed(const strut_model *model, double share, const double *q,
                               strut_force *force) {
  const strut_member_table *members = &model->members;
  const strut_element_pose *pose = &force->pose;
  int32_t i = force->index;
  if (force->kind == STRUT_FORCE_MEMBER)
    return members->slack[i] != 0.0 && members->rest[i] * members->stiffness[i] > 0.0 &&
           strut_member_length(members, i, q) < share * members->rest[i];
  if (force->kind == STRUT_FORCE_CONTACT) return false;
  const strut_element *own = &model->elements.element[i];
  if (own->strain != STRUT_STRAIN_LENGTH || own->carries > 0) return false;
  strut_element_evaluate(model, i, members->rest, q, (double)NAN, &force->pose);
  return pose->strain < share * pose->natural && pose->force < 0.0;
}

/* True where an arm of some hinge is all but gone beside what it is at the start: its angle has no meaning then. */
static bool have_hinges_collapsed(const strut_model *model, const double *q) {
  const double gone = 1e-4; /* of the arm at the start */
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *element = &model->elements.element[i];
    const uint32_t *at = model->elements.at + element->first;
    for (int k = 1; k < element->nodes && element->strain == STRUT_STRAIN_ANGLE; k++)
      if (strut_distance(q + at[k], q + at[k - 1]) <
          gone * strut_distance(model->start + at[k], model->start + at[k - 1]))
        return true;
  }
  return false;
}

bool strut_shape_has_collapsed(const strut_model *model, const double *q) {
  return have_hinges_collapsed(model, q) || strut_cell_that_collapsed(model, q) >= 0;
}
