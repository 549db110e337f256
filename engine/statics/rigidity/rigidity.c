/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/rigidity/rigidity.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/tangent.h"
#include "engine/statics/algebra.h"

static const double NONE = 1e-9;    /* of the largest force: no force */
static const double ON_LINE = 1e-9; /* of the size: a node on the outline */

/* -1 pressed, 1 pulled, 0 neither, in the state that is judged. */
static int sign_of(const strut_rigidity *rigidity, int32_t j, double largest) {
  double force = rigidity->judged[j];
  return force > NONE * largest ? 1 : force < -NONE * largest ? -1 : 0;
}

static int32_t root(int32_t *parent, int32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/* Is the line through a and b one that all nodes lie on one side of? */
static bool on_outline(const strut_model *model, const double *positions, uint32_t a, uint32_t b) {
  strut_vec2 d = strut_vec2_between(positions + a, positions + b);
  double length = strut_vec2_length(d);
  bool left = false, right = false;
  for (int32_t i = 0; i < model->node_count; i++) {
    double off =
        d.x * (positions[2 * i + 1] - positions[a + 1]) - d.y * (positions[2 * i] - positions[a]);
    left |= off > ON_LINE * model->size * length;
    right |= off < -ON_LINE * model->size * length;
  }
  return !(left && right);
}

/* Net: what is pulled is connected, struts end on it, and none lies on the outline. */
static bool inside(const strut_model *model, const double *positions,
                   const strut_rigidity *rigidity, double largest, int32_t *parent) {
  const strut_member_table *members = &model->members;
  int32_t net = -1;
  for (int32_t i = 0; i < model->node_count; i++) parent[i] = i;
  for (int32_t j = 0; j < members->count; j++) {
    const strut_member *member = &model->scene->members[j];
    if (sign_of(rigidity, j, largest) <= 0) continue;
    net = (int32_t)(members->to[j] / 2);
    for (size_t k = 0; k <= member->guide_count; k++)
      parent[root(parent, strut_member_node(member, k))] = root(parent, net);
  }
  if (net < 0) return false;
  for (int32_t j = 0; j < members->count; j++) {
    int32_t end[2] = {(int32_t)(members->from[j] / 2), (int32_t)(members->to[j] / 2)};
    int sign = sign_of(rigidity, j, largest);
    for (int k = 0; k < 2 && sign != 0; k++)
      if (root(parent, end[k]) != root(parent, net)) return false;
    if (sign < 0 && on_outline(model, positions, members->from[j], members->to[j])) return false;
  }
  return true;
}

static bool apart(const strut_model *model, const strut_rigidity *rigidity, double largest,
                  int32_t *struts) {
  const strut_member_table *members = &model->members;
  int32_t all = 0;
  for (int32_t i = 0; i < model->node_count; i++) struts[i] = 0;
  for (int32_t j = 0; j < members->count; j++) {
    if (sign_of(rigidity, j, largest) >= 0) continue;
    all++;
    if (++struts[members->from[j] / 2] > 1 || ++struts[members->to[j] / 2] > 1) return false;
  }
  return all > 0;
}

static bool pulls_cables_only(const strut_model *model, const strut_rigidity *rigidity,
                              double largest) {
  int32_t pulled = 0;
  for (int32_t j = 0; j < model->members.count; j++) {
    bool cable = model->scene->members[j].kind == STRUT_CABLE;
    int sign = sign_of(rigidity, j, largest);
    if (cable ? sign < 0 : sign > 0) return false;
    pulled += sign > 0;
  }
  return pulled > 0;
}

static const char *label_of(const strut_tensegrity *tensegrity) {
  if (!tensegrity->self_stress) return "no tensegrity: no state of self-stress";
  if (!tensegrity->judged) return "not judged: too many states";
  if (!tensegrity->cables)
    return "no tensegrity: members that are no cables are pulled, or cables pressed";
  if (tensegrity->mechanism && tensegrity->all_states && tensegrity->struts_apart)
    return tensegrity->struts_inside ? "ideal tensegrity" : "pure tensegrity";
  if (tensegrity->mechanism) return "structure with tensegrity features of class 1";
  if (tensegrity->struts_inside || tensegrity->struts_apart)
    return "structure with tensegrity features of class 2";
  return "no tensegrity: no stiffened mechanism, struts neither apart nor inside the net";
}

/*
 * Fills in rigidity->tensegrity from all else in it, by a published definition; q (length) is the
 * shape. STRUT_OK or STRUT_NO_MEMORY.
 *
 * Obara, Klosowska, Gilewski, "Truth and Myths about 2D Tensegrity Trusses", Appl. Sci. 9 (2019)
 * 179; in the words of Obara, Tomasik, Appl. Sci. 10 (2020) 7042: S a state of self-stress, C
 * cables pull, M an infinitesimal mechanism stiffened by self-stress, D struts that do not touch,
 * I struts within one net of what is pulled. Ideal tensegrity: all of them, with every state; pure:
 * all but I; features of class 1: S, C, M with some state; of class 2: S, C and one of I and D.
 */
static strut_status judge_tensegrity(const strut_model *model, const double *positions,
                                     strut_rigidity *rigidity) {
  strut_tensegrity *tensegrity = &rigidity->tensegrity;
  *tensegrity = (strut_tensegrity){.self_stress = rigidity->states.count > 0,
                                   .judged = rigidity->judged != NULL};
  if (rigidity->judged) {
    const strut_mechanisms *mechanisms = &rigidity->mechanisms;
    double largest = strut_largest_magnitude(rigidity->judged, model->members.count);
    int32_t *scratch = strut_allocate((size_t)model->node_count + 1, sizeof *scratch);
    if (!scratch) return STRUT_NO_MEMORY;
    tensegrity->cables = pulls_cables_only(model, rigidity, largest);
    tensegrity->mechanism =
        mechanisms->infinitesimal > 0 &&
        mechanisms->infinitesimal + mechanisms->rigid_body == mechanisms->count &&
        (mechanisms->by_forces || (mechanisms->stiffener && mechanisms->stiffener_pulls));
    /* of several states, some combination presses what another pulls */
    tensegrity->all_states = tensegrity->mechanism && rigidity->states.count == 1;
    tensegrity->struts_apart = apart(model, rigidity, largest, scratch);
    tensegrity->struts_inside = inside(model, positions, rigidity, largest, scratch);
    strut_release(scratch);
  }
  tensegrity->label = label_of(tensegrity);
  return STRUT_OK;
}

/* A force or a moment; 0 where it is rounding of the lengths or angles of such a size. */
static double resolved(double force, double stiffness, double size) {
  double least = 8.0 * DBL_EPSILON * stiffness * size;
  return fabs(force) > least ? force : 0.0;
}

static void measure_elements(const strut_model *model, const double *positions,
                             strut_rigidity *rigidity) {
  const strut_equilibrium_matrix *matrix = &rigidity->matrix;
  strut_element_pose pose;
  for (int32_t j = matrix->members; j < matrix->columns; j++) {
    strut_element_evaluate(model, matrix->curved[j], model->members.rest, positions, (double)NAN,
                           &pose);
    const strut_element *element = &model->elements.element[matrix->curved[j]];
    double least = element->role == STRUT_ELEMENT_CELL ? 0.0 : fabs(pose.strain);
    pose.force = resolved(pose.force, element->numbers.stiffness, least);
    double force = rigidity->force[j] = pose.force / matrix->scale[j] + 0.0; /* + 0.0: no -0 */
    for (int32_t k = matrix->start[j]; k < matrix->start[j + 1]; k++)
      rigidity->largest_force = fmax(rigidity->largest_force, fabs(force * matrix->value[k]));
  }
}

static bool measure_forces(const strut_model *model, const double *positions,
                           strut_rigidity *rigidity) {
  const strut_member_table *members = &model->members;
  if (!STRUT_NUMBERS(&rigidity->arena, rigidity->matrix.columns, &rigidity->force,
                     &rigidity->density))
    return false;
  for (int32_t j = 0; j < members->count; j++) {
    double length = rigidity->matrix.length[j];
    rigidity->force[j] = resolved(strut_member_elastic_tension(model, members->rest, j, positions),
                                  members->stiffness[j], length + members->rest[j]) +
                         0.0; /* no -0 */
    if (length > 0)
      rigidity->density[j] = rigidity->force[j] / length;
    else
      rigidity->without_length++;
    rigidity->largest_force = fmax(rigidity->largest_force, fabs(rigidity->force[j]));
    if (model->scene->members[j].kind == STRUT_CABLE) rigidity->has_cables = true;
  }
  measure_elements(model, positions, rigidity);
  return true;
}

/* Adds what acts beside the members; also to the scale of balance. */
static void add_outer_forces(const strut_model *model, const double *positions, double *net,
                             double *scale) {
  strut_force_visit visit = {.model = model,
                             .q = positions,
                             .rest = model->members.rest,
                             .least = -HUGE_VAL,
                             .closed = STRUT_CLOSED_TOUCHING};
  for (int32_t at = 0; at < 2 * model->node_count && model->constant_force; at++) {
    net[at] += model->constant_force[at];
    *scale = fmax(*scale, fabs(model->constant_force[at]));
  }
  for (const strut_force *force; (force = strut_force_next(&visit));) {
    const strut_element *element =
        force->kind == STRUT_FORCE_ELEMENT ? &model->elements.element[force->index] : NULL;
    bool outer = force->kind == STRUT_FORCE_CONTACT ||
                 (element && (element->role == STRUT_ELEMENT_COLLISION ||
                              element->role == STRUT_ELEMENT_LOAD));
    for (int32_t k = 0; k < 2 * force->nodes && outer; k++)
      net[strut_force_coordinate(force, k)] -= force->pose.force * force->pose.b[k];
  }
}

static double largest_free(const strut_equilibrium_matrix *matrix, const double *net) {
  double largest = 0.0;
  for (int32_t row = 0; row < matrix->rows; row++)
    largest = fmax(largest, fabs(net[matrix->coordinate[row]]));
  return largest;
}

static bool measure_balance(const strut_model *model, const double *positions,
                            strut_rigidity *rigidity) {
  const strut_equilibrium_matrix *matrix = &rigidity->matrix;
  strut_arena scratch = {0};
  double *net, *held;
  bool good = STRUT_NUMBERS(&scratch, model->length, &net, &held);
  if (good) {
    double members = rigidity->largest_force;
    strut_equilibrium_multiply(matrix, rigidity->force, held);
    for (int32_t row = 0; row < matrix->rows; row++) net[matrix->coordinate[row]] = -held[row];
    rigidity->prestressed = members > 0;
    rigidity->self_equilibrium =
        rigidity->prestressed && largest_free(matrix, net) <= STRUT_BALANCE_TOLERANCE * members;
    add_outer_forces(model, positions, net, &rigidity->largest_force);
    rigidity->residual = largest_free(matrix, net);
    rigidity->equilibrium = rigidity->residual <= STRUT_BALANCE_TOLERANCE * rigidity->largest_force;
  }
  strut_arena_free(&scratch);
  return good;
}

static bool count_bars(const strut_model *model, strut_rigidity *rigidity) {
  int32_t *bars = strut_allocate((size_t)model->node_count + 1, sizeof *bars);
  if (!bars) return false;
  for (int32_t j = 0; j < model->members.count; j++) {
    if (model->scene->members[j].kind != STRUT_BAR) continue;
    uint32_t end[2] = {model->members.from[j] / 2, model->members.to[j] / 2};
    for (int k = 0; k < 2; k++)
      if (++bars[end[k]] > rigidity->bars_at_node) rigidity->bars_at_node = bars[end[k]];
  }
  strut_release(bars);
  return true;
}

static strut_status pull_cables(const strut_model *model, strut_rigidity *rigidity) {
  if (!rigidity->states.force) return STRUT_OK;
  double *force =
      strut_arena_allocate(&rigidity->arena, (size_t)rigidity->matrix.columns, sizeof *force);
  if (!force) return STRUT_NO_MEMORY;
  if (rigidity->states.count == 1) { /* it has been turned so that cables pull, if they can */
    memcpy(force, rigidity->states.force, (size_t)rigidity->matrix.columns * sizeof *force);
    rigidity->cables_can_pull = rigidity->states.cables_pull[0];
  } else {
    strut_status status =
        strut_self_stress_pull_cables(model, &rigidity->states, force, &rigidity->cables_can_pull);
    if (status != STRUT_OK) return status;
  }
  if (rigidity->cables_can_pull) rigidity->feasible = force;
  return STRUT_OK;
}

static void choose_stress(strut_rigidity *rigidity) {
  rigidity->source = STRUT_STRESS_NONE;
  if (!rigidity->states.force) return;
  if (rigidity->states.count == 1) {
    rigidity->source = STRUT_STRESS_STATE;
    rigidity->judged = rigidity->states.force;
  } else if (rigidity->self_equilibrium) {
    rigidity->source = STRUT_STRESS_SHAPE;
    rigidity->judged = rigidity->force;
  } else if (rigidity->feasible) {
    rigidity->source = STRUT_STRESS_COMBINATION;
    rigidity->judged = rigidity->feasible;
  } else {
    rigidity->source = STRUT_STRESS_FIRST;
    rigidity->judged = rigidity->states.force;
  }
}

/* A cable under compression rules out super stability, whatever the matrix. */
static void respect_cables(const strut_model *model, strut_rigidity *rigidity) {
  double largest = strut_largest_magnitude(rigidity->judged, rigidity->matrix.columns);
  for (int32_t j = 0; j < rigidity->matrix.columns; j++)
    if (strut_column_is_cable(model, j) && rigidity->judged[j] < -1e-9 * largest)
      rigidity->stress.super_stable = false;
}

static strut_status find_all(const strut_model *model, const double *positions,
                             strut_rigidity *rigidity, strut_error *error) {
  strut_status status =
      strut_equilibrium_matrix_build(model, positions, &rigidity->arena, &rigidity->matrix);
  if (status != STRUT_OK) return status;
  if (!measure_forces(model, positions, rigidity) || !measure_balance(model, positions, rigidity) ||
      !count_bars(model, rigidity))
    return STRUT_NO_MEMORY;
  status = strut_null_spaces_find(&rigidity->matrix, &rigidity->arena, &rigidity->spaces, error);
  if (status == STRUT_OK)
    status = strut_self_stress_sort(model, &rigidity->spaces, &rigidity->arena, &rigidity->states);
  if (status == STRUT_OK) status = pull_cables(model, rigidity);
  if (status != STRUT_OK) return status;
  const double *force = rigidity->prestressed && rigidity->equilibrium ? rigidity->force : NULL;
  status = strut_mechanisms_find(model, positions, force, rigidity);
  choose_stress(rigidity);
  if (status == STRUT_OK && rigidity->judged) {
    status = strut_stress_matrix_judge(model, &rigidity->matrix, rigidity->judged, &rigidity->arena,
                                       &rigidity->stress);
    respect_cables(model, rigidity);
  }
  return status == STRUT_OK ? judge_tensegrity(model, positions, rigidity) : status;
}

strut_status strut_rigidity_find(const strut_model *model, const double *positions,
                                 strut_rigidity *rigidity, strut_error *error) {
  *rigidity = (strut_rigidity){0};
  strut_status status = find_all(model, positions, rigidity, error);
  if (status == STRUT_NO_MEMORY) strut_fail(error, status, "out of memory");
  return status;
}

void strut_rigidity_free(strut_rigidity *rigidity) {
  strut_arena_free(&rigidity->arena);
  *rigidity = (strut_rigidity){0};
}
