/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/rigidity/rigidity.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/tangent.h"

static const double NONE = 1e-9;    /* of the largest force: no force */
static const double ON_LINE = 1e-9; /* of the size: a node on the outline */

/* -1 pressed, 1 pulled, 0 neither, in the state that is judged. */
static int sign_of(const strut_rigidity *r, int32_t j, double largest) {
  double force = r->judged[j];
  return force > NONE * largest ? 1 : force < -NONE * largest ? -1 : 0;
}

static int32_t root(int32_t *parent, int32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/* Is the line through a and b one that all nodes lie on one side of? */
static bool on_outline(const strut_model *model, const double *q, uint32_t a, uint32_t b) {
  strut_vec2 d = strut_vec2_between(q + a, q + b);
  double length = strut_vec2_length(d);
  bool left = false, right = false;
  for (int32_t i = 0; i < model->node_count; i++) {
    double off = d.x * (q[2 * i + 1] - q[a + 1]) - d.y * (q[2 * i] - q[a]);
    left |= off > ON_LINE * model->size * length;
    right |= off < -ON_LINE * model->size * length;
  }
  return !(left && right);
}

/* Net: what is pulled is connected, struts end on it, and none lies on the outline. */
static bool inside(const strut_model *model, const double *q, const strut_rigidity *r,
                   double largest, int32_t *parent) {
  const strut_member_table *t = &model->members;
  int32_t net = -1;
  for (int32_t i = 0; i < model->node_count; i++) parent[i] = i;
  for (int32_t j = 0; j < t->count; j++) {
    const strut_member *m = &model->scene->members[j];
    if (sign_of(r, j, largest) <= 0) continue;
    net = (int32_t)(t->to[j] / 2);
    for (size_t k = 0; k <= m->guide_count; k++)
      parent[root(parent, strut_member_node(m, k))] = root(parent, net);
  }
  if (net < 0) return false;
  for (int32_t j = 0; j < t->count; j++) {
    int32_t end[2] = {(int32_t)(t->from[j] / 2), (int32_t)(t->to[j] / 2)};
    int sign = sign_of(r, j, largest);
    for (int k = 0; k < 2 && sign != 0; k++)
      if (root(parent, end[k]) != root(parent, net)) return false;
    if (sign < 0 && on_outline(model, q, t->from[j], t->to[j])) return false;
  }
  return true;
}

static bool apart(const strut_model *model, const strut_rigidity *r, double largest,
                  int32_t *struts) {
  const strut_member_table *t = &model->members;
  int32_t all = 0;
  for (int32_t i = 0; i < model->node_count; i++) struts[i] = 0;
  for (int32_t j = 0; j < t->count; j++) {
    if (sign_of(r, j, largest) >= 0) continue;
    all++;
    if (++struts[t->from[j] / 2] > 1 || ++struts[t->to[j] / 2] > 1) return false;
  }
  return all > 0;
}

static bool pulls_cables_only(const strut_model *model, const strut_rigidity *r, double largest) {
  int32_t pulled = 0;
  for (int32_t j = 0; j < model->members.count; j++) {
    bool cable = model->scene->members[j].kind == STRUT_CABLE;
    int sign = sign_of(r, j, largest);
    if (cable ? sign < 0 : sign > 0) return false;
    pulled += sign > 0;
  }
  return pulled > 0;
}

/* Every listed state that loads movable members must alone stiffen all mechanisms. */
static bool all_states_stiffen(const strut_rigidity *r) {
  return r->states.count == 1; /* of several, some combination presses what another pulls */
}

static const char *label_of(const strut_tensegrity *t) {
  if (!t->self_stress) return "no tensegrity: no state of self-stress";
  if (!t->judged) return "not judged: too many states";
  if (!t->cables) return "no tensegrity: members that are no cables are pulled, or cables pressed";
  if (t->mechanism && t->all_states && t->struts_apart)
    return t->struts_inside ? "ideal tensegrity" : "pure tensegrity";
  if (t->mechanism) return "structure with tensegrity features of class 1";
  if (t->struts_inside || t->struts_apart) return "structure with tensegrity features of class 2";
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
static strut_status judge_tensegrity(const strut_model *model, const double *q, strut_rigidity *r) {
  strut_tensegrity *t = &r->tensegrity;
  *t = (strut_tensegrity){.self_stress = r->states.count > 0, .judged = r->judged != NULL};
  if (r->judged) {
    const strut_mechanisms *m = &r->mechanisms;
    double largest = strut_largest_magnitude(r->judged, model->members.count);
    int32_t *scratch = strut_allocate((size_t)model->node_count + 1, sizeof *scratch);
    if (!scratch) return STRUT_NO_MEMORY;
    t->cables = pulls_cables_only(model, r, largest);
    t->mechanism = m->infinitesimal > 0 && m->infinitesimal + m->rigid_body == m->count &&
                   (m->by_forces || (m->stiffener && m->stiffener_pulls));
    t->all_states = t->mechanism && all_states_stiffen(r);
    t->struts_apart = apart(model, r, largest, scratch);
    t->struts_inside = inside(model, q, r, largest, scratch);
    strut_release(scratch);
  }
  t->label = label_of(t);
  return STRUT_OK;
}

/* A force or a moment; 0 where it is rounding of the lengths or angles of such a size. */
static double resolved(double force, double stiffness, double size) {
  double least = 8.0 * DBL_EPSILON * stiffness * size;
  return fabs(force) > least ? force : 0.0;
}

static void measure_elements(const strut_model *model, const double *q, strut_rigidity *r) {
  const strut_equilibrium_matrix *a = &r->matrix;
  strut_element_pose pose;
  for (int32_t j = a->members; j < a->columns; j++) {
    strut_element_evaluate(model, a->curved[j], model->members.rest, q, (double)NAN, &pose);
    const strut_element *e = &model->elements.element[a->curved[j]];
    double least = e->role == STRUT_ELEMENT_CELL ? 0.0 : fabs(pose.strain);
    pose.force = resolved(pose.force, e->numbers.stiffness, least);
    double force = r->force[j] = pose.force / a->scale[j] + 0.0; /* + 0.0: no -0 */
    for (int32_t k = a->start[j]; k < a->start[j + 1]; k++)
      r->largest_force = fmax(r->largest_force, fabs(force * a->value[k]));
  }
}

static bool measure_forces(const strut_model *model, const double *q, strut_rigidity *r) {
  const strut_member_table *t = &model->members;
  r->force = strut_arena_allocate(&r->arena, (size_t)r->matrix.columns + 1, sizeof *r->force);
  r->density = strut_arena_allocate(&r->arena, (size_t)t->count + 1, sizeof *r->density);
  if (!r->force || !r->density) return false;
  for (int32_t j = 0; j < t->count; j++) {
    double length = r->matrix.length[j];
    r->force[j] = resolved(strut_member_elastic_tension(model, t->rest, j, q), t->stiffness[j],
                           length + t->rest[j]) +
                  0.0; /* no -0 */
    if (length > 0)
      r->density[j] = r->force[j] / length;
    else
      r->without_length++;
    r->largest_force = fmax(r->largest_force, fabs(r->force[j]));
    if (model->scene->members[j].kind == STRUT_CABLE) r->has_cables = true;
  }
  measure_elements(model, q, r);
  return true;
}

/* Adds what acts beside the members; also to the scale of balance. */
static void add_outer_forces(const strut_model *model, const double *q, double *net,
                             double *scale) {
  strut_force_visit visit = {.model = model,
                             .q = q,
                             .rest = model->members.rest,
                             .least = -HUGE_VAL,
                             .closed = STRUT_CLOSED_TOUCHING};
  for (int32_t at = 0; at < 2 * model->node_count && model->constant_force; at++) {
    net[at] += model->constant_force[at];
    *scale = fmax(*scale, fabs(model->constant_force[at]));
  }
  for (const strut_force *force; (force = strut_force_next(&visit));) {
    const strut_element *e =
        force->kind == STRUT_FORCE_ELEMENT ? &model->elements.element[force->index] : NULL;
    bool outer = force->kind == STRUT_FORCE_CONTACT ||
                 (e && (e->role == STRUT_ELEMENT_COLLISION || e->role == STRUT_ELEMENT_LOAD));
    for (int32_t k = 0; k < 2 * force->nodes && outer; k++)
      net[strut_force_coordinate(force, k)] -= force->pose.force * force->pose.b[k];
  }
}

static double largest_free(const strut_equilibrium_matrix *a, const double *net) {
  double largest = 0.0;
  for (int32_t row = 0; row < a->rows; row++)
    largest = fmax(largest, fabs(net[a->coordinate[row]]));
  return largest;
}

static bool measure_balance(const strut_model *model, const double *q, strut_rigidity *r) {
  const strut_equilibrium_matrix *a = &r->matrix;
  strut_arena scratch = {0};
  double *net = strut_arena_allocate(&scratch, (size_t)model->length, sizeof *net);
  double *held = strut_arena_allocate(&scratch, (size_t)a->rows + 1, sizeof *held);
  bool good = net && held;
  if (good) {
    double members = r->largest_force;
    strut_equilibrium_multiply(a, r->force, held);
    for (int32_t row = 0; row < a->rows; row++) net[a->coordinate[row]] = -held[row];
    r->prestressed = members > 0;
    r->self_equilibrium =
        r->prestressed && largest_free(a, net) <= STRUT_BALANCE_TOLERANCE * members;
    add_outer_forces(model, q, net, &r->largest_force);
    r->residual = largest_free(a, net);
    r->equilibrium = r->residual <= STRUT_BALANCE_TOLERANCE * r->largest_force;
  }
  strut_arena_free(&scratch);
  return good;
}

static bool count_bars(const strut_model *model, strut_rigidity *r) {
  int32_t *bars = strut_allocate((size_t)model->node_count + 1, sizeof *bars);
  if (!bars) return false;
  for (int32_t j = 0; j < model->members.count; j++) {
    if (model->scene->members[j].kind != STRUT_BAR) continue;
    uint32_t end[2] = {model->members.from[j] / 2, model->members.to[j] / 2};
    for (int k = 0; k < 2; k++)
      if (++bars[end[k]] > r->bars_at_node) r->bars_at_node = bars[end[k]];
  }
  strut_release(bars);
  return true;
}

static strut_status pull_cables(const strut_model *model, strut_rigidity *r) {
  if (!r->states.force) return STRUT_OK;
  double *force = strut_arena_allocate(&r->arena, (size_t)r->matrix.columns, sizeof *force);
  if (!force) return STRUT_NO_MEMORY;
  if (r->states.count == 1) { /* it has been turned so that cables pull, if they can */
    memcpy(force, r->states.force, (size_t)r->matrix.columns * sizeof *force);
    r->cables_can_pull = r->states.cables_pull[0];
  } else {
    strut_status status =
        strut_self_stress_pull_cables(model, &r->states, force, &r->cables_can_pull);
    if (status != STRUT_OK) return status;
  }
  if (r->cables_can_pull) r->feasible = force;
  return STRUT_OK;
}

static void choose_stress(strut_rigidity *r) {
  r->source = STRUT_STRESS_NONE;
  if (!r->states.force) return;
  if (r->states.count == 1) {
    r->source = STRUT_STRESS_STATE;
    r->judged = r->states.force;
  } else if (r->self_equilibrium) {
    r->source = STRUT_STRESS_SHAPE;
    r->judged = r->force;
  } else if (r->feasible) {
    r->source = STRUT_STRESS_COMBINATION;
    r->judged = r->feasible;
  } else {
    r->source = STRUT_STRESS_FIRST;
    r->judged = r->states.force;
  }
}

/* A cable under compression rules out super stability, whatever the matrix. */
static void respect_cables(const strut_model *model, strut_rigidity *r) {
  double largest = strut_largest_magnitude(r->judged, r->matrix.columns);
  for (int32_t j = 0; j < r->matrix.columns; j++)
    if (strut_column_is_cable(model, j) && r->judged[j] < -1e-9 * largest)
      r->stress.super_stable = false;
}

static strut_status find_all(const strut_model *model, const double *q, strut_rigidity *r,
                             strut_error *error) {
  strut_status status = strut_equilibrium_matrix_build(model, q, &r->arena, &r->matrix);
  if (status != STRUT_OK) return status;
  if (!measure_forces(model, q, r) || !measure_balance(model, q, r) || !count_bars(model, r))
    return STRUT_NO_MEMORY;
  status = strut_null_spaces_find(&r->matrix, &r->arena, &r->spaces, error);
  if (status == STRUT_OK) status = strut_self_stress_sort(model, &r->spaces, &r->arena, &r->states);
  if (status == STRUT_OK) status = pull_cables(model, r);
  if (status != STRUT_OK) return status;
  const double *force = r->prestressed && r->equilibrium ? r->force : NULL;
  status = strut_mechanisms_find(model, q, force, r);
  choose_stress(r);
  if (status == STRUT_OK && r->judged) {
    status = strut_stress_matrix_judge(model, &r->matrix, r->judged, &r->arena, &r->stress);
    respect_cables(model, r);
  }
  return status == STRUT_OK ? judge_tensegrity(model, q, r) : status;
}

strut_status strut_rigidity_find(const strut_model *model, const double *q,
                                 strut_rigidity *rigidity, strut_error *error) {
  *rigidity = (strut_rigidity){0};
  strut_status status = find_all(model, q, rigidity, error);
  if (status == STRUT_NO_MEMORY) strut_fail(error, status, "out of memory");
  return status;
}

void strut_rigidity_free(strut_rigidity *rigidity) {
  strut_arena_free(&rigidity->arena);
  *rigidity = (strut_rigidity){0};
}
