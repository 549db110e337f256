/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/form/parts.h"

#include "engine/base/vec.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/model/algebra/linear_solver.h"
#include "engine/model/pose.h"
#include "engine/scene/things.h"
#include "engine/statics/form/form.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/statics/minimise.h"
#include "engine/statics/search/critical.h"

/* Parts that all methods of form finding share. */

static const double TOUCH = 1e-6; /* of the size: nearer to the ground is drawn on it */

strut_contact_pose strut_form_contact(const strut_former *former, int32_t contact,
                                      const double *point) {
  assert(contact >= 0 && contact < former->model->contacts.count);
  const strut_contact_table *contacts = &former->model->contacts;
  strut_contact_pose pose = {.axes = contacts->axes, .gap = strut_ground_gap(contacts, point)};
  if (contacts->surface)
    strut_surface_find(&contacts->surface[contacts->surface_of[contact]], point, -1, &pose);
  return pose;
}

strut_contact_pose strut_form_contact_as_drawn(const strut_former *former, int32_t contact) {
  int32_t node = former->model->contacts.entry[contact].node;
  return strut_form_contact(former, contact, former->scene->nodes[node].position);
}

bool strut_form_touches(const strut_former *former, int32_t contact) {
  return strut_form_contact_as_drawn(former, contact).gap <= TOUCH * former->size;
}

/* Sets the error that energies and forces overflow; returns its status. */
static strut_status form_out_of_range(strut_error *error) {
  return strut_fail(error, STRUT_DIVERGED,
                    "energies and forces leave the range of numbers; check the units of sizes, "
                    "stiffnesses and loads");
}

double strut_form_length(const strut_scene *scene, size_t j) {
  const strut_member *member = &scene->members[j];
  return strut_distance(scene->nodes[member->node[0]].start, scene->nodes[member->node[1]].start);
}

strut_status strut_form_set_force(strut_former *former, size_t j, double force,
                                  strut_error *error) {
  assert(j < former->scene->member_count);
  strut_member *member = &former->scene->members[j];
  double length = strut_form_length(former->scene, j);
  double rest = member->axial_stiffness > 0
                    ? member->axial_stiffness * length / (member->axial_stiffness + force)
                : member->stiffness > 0 ? length - force / member->stiffness
                                        : length;
  if (!isfinite(force) || !isfinite(length)) return form_out_of_range(error);
  bool carries = member->axial_stiffness > 0 || member->stiffness > 0 || force == 0;
  if (!carries || !isfinite(rest) || rest < 0)
    return strut_fail(error, STRUT_NOT_SETTLED,
                      "member %s would have to carry %.4g N at a length of %.4g m, which its "
                      "stiffness does not allow; make it stiffer",
                      member->name, force, length);
  member->rest_kind = STRUT_REST_LENGTH;
  member->rest_value = rest;
  former->form->largest_force = fmax(former->form->largest_force, fabs(force));
  return STRUT_OK;
}

/*
 * The force density method (Schek 1974): with densities q = force / length equilibrium is linear in
 * the positions, D x = f. Where that determines no shape, the nearest pair of shape and densities.
 */

static const double DETERMINED = 1e-12; /* least reciprocal condition of D */
static const double SOUND = 1e-9;       /* least pivot that is no noise */
static const double BEYOND = 1e3;       /* in sizes: farther solutions are rejected */
enum { RIGID_MOTIONS = 3 };

typedef struct density_problem {
  strut_former *f;
  double *q;     /* (members) [N/m] */
  double *x;     /* (2 nodes) [m] */
  uint8_t *held; /* (2 nodes) 1: keeps its coordinate, by a support or the ground */
} density_problem;

static strut_status read_densities(density_problem *self, strut_error *error) {
  strut_scene *scene = self->f->scene;
  double largest = 0;
  for (size_t j = 0; j < scene->member_count; j++) {
    strut_rest rest;
    const strut_member *member = &scene->members[j];
    if (!strut_member_rest(scene, j, &rest)) continue;
    bool given = member->rest_kind == STRUT_REST_FORCE_DENSITY;
    self->q[j] = given ? member->rest_value : rest.force_density;
    largest = fmax(largest, fabs(self->q[j]));
    if (member->kind == STRUT_CABLE && self->q[j] < 0)
      return strut_fail(error, STRUT_NOT_SETTLED,
                        "cable %s is given the force density %.4g N/m, but cables only pull",
                        member->name, self->q[j]);
  }
  if (largest > 0) return STRUT_OK;
  return strut_fail(error, STRUT_NOT_SETTLED,
                    "no member has a force density: give some with force_density or pretension");
}

/* Marks coordinates held by supports, level ground or walls; returns their number. */
static int32_t mark_held(density_problem *self) {
  const strut_former *former = self->f;
  const strut_contact_table *contacts = &former->model->contacts;
  int32_t count = 0;
  for (size_t i = 0; i < former->scene->node_count; i++)
    for (size_t k = 0; k < 2; k++) {
      self->held[2 * i + k] = former->scene->nodes[i].fixed[k];
      self->x[2 * i + k] = former->scene->nodes[i].position[k];
    }
  for (int32_t i = 0; i < contacts->count; i++) {
    const strut_contact_pose pose = strut_form_contact_as_drawn(former, i);
    for (uint32_t k = 0; k < 2 && pose.curvature == 0 && strut_form_touches(former, i); k++)
      if (pose.axes.normal[1 - k] == 0) self->held[contacts->at[i] + k] = 1;
  }
  for (size_t i = 0; i < 2 * former->scene->node_count; i++) count += self->held[i];
  return count;
}

/* D of one axis on the nodes that are free in it, and the forces on them (right). */
static strut_sparse *assemble_axis(const density_problem *self, int axis, const int32_t *row_of,
                                   int32_t n, double *right, strut_arena *arena) {
  const strut_scene *scene = self->f->scene;
  strut_triplets sum = {0};
  if (!strut_triplets_reserve(&sum, 3 * scene->member_count, arena)) return NULL;
  for (size_t i = 0; i < scene->node_count; i++)
    if (row_of[i] >= 0) right[row_of[i]] = self->f->potential->force[2 * i + (size_t)axis];
  for (size_t j = 0; j < scene->member_count; j++) {
    const int32_t *node = scene->members[j].node;
    int32_t a = row_of[node[0]], b = row_of[node[1]];
    if (a >= 0) strut_triplets_add(&sum, a, a, self->q[j]);
    if (b >= 0) strut_triplets_add(&sum, b, b, self->q[j]);
    if (a >= 0 && b >= 0) strut_triplets_add(&sum, a > b ? a : b, a > b ? b : a, -self->q[j]);
    if (a >= 0 && b < 0) right[a] += self->q[j] * self->x[2 * node[1] + axis];
    if (b >= 0 && a < 0) right[b] += self->q[j] * self->x[2 * node[0] + axis];
  }
  return strut_sparse_build(n, &sum, arena);
}

/* One axis: STRUT_SINGULAR where D determines nothing. */
static strut_status solve_axis(density_problem *self, int axis) {
  size_t nodes = self->f->scene->node_count;
  strut_arena arena = {0};
  strut_ldl *ldl = NULL;
  strut_inertia inertia;
  int32_t n = 0;
  int32_t *row_of = strut_arena_allocate(&arena, nodes, sizeof *row_of);
  double *right = strut_arena_allocate(&arena, nodes, sizeof *right);
  strut_sparse *matrix = NULL;
  for (size_t i = 0; i < nodes && row_of; i++)
    row_of[i] = self->held[2 * i + (size_t)axis] ? -1 : n++;
  if (row_of && right && n > 0) matrix = assemble_axis(self, axis, row_of, n, right, &arena);
  strut_status status = !row_of || !right ? STRUT_NO_MEMORY : STRUT_OK;
  if (n > 0 && status == STRUT_OK) {
    status = matrix ? strut_ldl_create(matrix, &arena, &ldl, NULL) : STRUT_NO_MEMORY;
    if (status == STRUT_OK) status = strut_ldl_factorise(ldl, matrix, 0.0, &inertia);
    if (status == STRUT_OK &&
        (inertia.smallest < SOUND || strut_ldl_rcond(ldl, matrix) < DETERMINED))
      status = STRUT_SINGULAR;
    if (status == STRUT_OK) strut_ldl_solve(ldl, right);
    for (size_t i = 0; i < nodes && status == STRUT_OK; i++) {
      if (row_of[i] < 0) continue;
      double x = right[row_of[i]];
      if (!(fabs(x - self->x[2 * i + (size_t)axis]) <= BEYOND * self->f->size))
        status = STRUT_SINGULAR;
    }
    for (size_t i = 0; i < nodes && status == STRUT_OK; i++)
      if (row_of[i] >= 0) self->x[2 * i + (size_t)axis] = right[row_of[i]];
  }
  strut_arena_free(&arena);
  return status;
}

static strut_status solve_shape(density_problem *self, int32_t held, strut_error *error) {
  size_t nodes = self->f->scene->node_count;
  bool standing = held <= RIGID_MOTIONS;
  strut_status status = STRUT_SINGULAR;
  if (!standing) {
    status = solve_axis(self, 0);
    if (status == STRUT_OK) status = solve_axis(self, 1);
  }
  if (status == STRUT_NO_MEMORY) return strut_fail(error, status, "out of memory");
  if (status == STRUT_OK) return status;
  for (size_t i = 0; i < 2 * nodes; i++) self->x[i] = self->f->scene->nodes[i / 2].position[i % 2];
  return strut_form_nearest(self->f, self->held, standing, self->x, self->q, error);
}

static strut_status apply_solution(density_problem *self, strut_error *error) {
  strut_scene *scene = self->f->scene;
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < scene->node_count; i++)
    for (size_t k = 0; k < 2; k++)
      scene->nodes[i].position[k] = scene->nodes[i].start[k] = self->x[2 * i + k];
  for (size_t j = 0; j < scene->member_count && status == STRUT_OK; j++) {
    const double *a = scene->nodes[scene->members[j].node[0]].position;
    const double *b = scene->nodes[scene->members[j].node[1]].position;
    double force = self->q[j] * strut_distance(a, b);
    if (scene->members[j].kind == STRUT_CABLE && force < 0)
      return strut_fail(error, STRUT_NOT_SETTLED,
                        "the nearest densities in equilibrium make cable %s push (%.4g N/m); "
                        "--given prestress keeps the drawn shape instead",
                        scene->members[j].name, self->q[j]);
    status = strut_form_set_force(self->f, j, force, error);
  }
  return status;
}

/* Shape and rest lengths from force densities. */
static strut_status form_densities(strut_former *former, strut_error *error) {
  size_t nodes = former->scene->node_count, members = former->scene->member_count;
  density_problem p = {.f = former,
                       .q = strut_arena_allocate(&former->arena, members, sizeof(double)),
                       .x = strut_arena_allocate(&former->arena, 2 * nodes, sizeof(double)),
                       .held = strut_arena_allocate(&former->arena, 2 * nodes, 1)};
  double *given = strut_arena_allocate(&former->arena, members, sizeof *given);
  if (!p.q || !p.x || !p.held || !given) return strut_no_memory(error, "");
  strut_status status = read_densities(&p, error);
  if (status) return status;
  memcpy(given, p.q, members * sizeof *given);
  status = solve_shape(&p, mark_held(&p), error);
  double largest = 0, change = 0;
  for (size_t j = 0; j < members; j++) {
    largest = fmax(largest, fabs(given[j]));
    change = fmax(change, fabs(p.q[j] - given[j]));
  }
  former->form->density_change = change / largest;
  return status == STRUT_OK ? apply_solution(&p, error) : status;
}

/* The choice of the method, and its common end: a polished start, proof of stability, a run. */

static const double STABLE = 0.02;    /* of the size: what an equilibrium may move on being left */
static const double NEARLY = 1e3;     /* of the rounding in forces: what a descent may leave */
static const double STEP_SHARE = 0.7; /* of the largest stable step */
static const double HOLD = 10.0;      /* duration of an added run [s] */
static const double MEET = 1e-9;      /* nodes this near are in one place [largest extent] */
static const double LARGEST_SIZE = 1e100; /* [m]: sums of squares of it are numbers */
static const double LEAST_STEP = 1e-300;  /* [s] */
static const double IDLE_STEP = 1e-3;     /* step where nothing limits it [s] */

static const char *form_source_name(strut_form_source source) {
  static const char *const names[] = {"scene", "densities", "lengths", "prestress"};
  assert((size_t)source < sizeof names / sizeof names[0]);
  return names[source];
}

static strut_form_source choose_source(const strut_scene *scene, strut_form_source wanted) {
  bool density = false, length = false;
  for (size_t j = 0; j < scene->member_count; j++) {
    density = density || scene->members[j].rest_kind == STRUT_REST_FORCE_DENSITY;
    length = length || scene->members[j].rest_kind == STRUT_REST_LENGTH;
  }
  if (wanted != STRUT_FORM_BY_SCENE) return wanted;
  return density ? STRUT_FORM_DENSITIES : length ? STRUT_FORM_LENGTHS : STRUT_FORM_PRESTRESS;
}

/* Removes velocities, settling and a start equilibrium from a scene whose form was found. */
static void remove_motion(strut_scene *scene, strut_experiment *experiment) {
  for (size_t i = 0; i < scene->node_count; i++)
    scene->nodes[i].velocity[0] = scene->nodes[i].velocity[1] = 0.0;
  experiment->settle.wanted = false;
  scene->start_equilibrium = -1;
}

/* A shape may have put a member's ends in one place, where it has no direction and no strain. */
static strut_status check_lengths(const strut_former *former, strut_error *error) {
  const strut_scene *scene = former->scene;
  for (size_t j = 0; j < scene->member_count; j++) {
    const strut_member *member = &scene->members[j];
    const strut_node *node = &scene->nodes[member->node[0]], *b = &scene->nodes[member->node[1]];
    strut_rest rest;
    bool apart = strut_form_length(scene, j) > MEET * former->size;
    if (strut_member_rest(scene, j, &rest) && (apart || former->form->from != STRUT_FORM_DENSITIES))
      continue;
    return strut_fail(error, STRUT_NOT_SETTLED,
                      "in this form nodes '%s' and '%s', the ends of '%s', coincide; choose other "
                      "densities or supports",
                      node->name, b->name, member->name);
  }
  return STRUT_OK;
}

/*
 * Writes rest lengths as lengths, rest angles as angles: given otherwise they would change with the drawn
 * shape.
 */
static void fix_lengths(strut_scene *scene) {
  for (size_t j = 0; j < scene->member_count; j++) {
    strut_rest rest;
    strut_member *member = &scene->members[j];
    if (member->rest_kind == STRUT_REST_LENGTH || !strut_member_rest(scene, j, &rest)) continue;
    member->rest_kind = STRUT_REST_LENGTH;
    member->rest_value = rest.length;
  }
  for (size_t i = 0; i < scene->hinge_count; i++)
    scene->hinges[i].rest_angle = strut_hinge_rest(scene, i);
}

/* Finds whether the structure is free to shift along x, and to turn and shift in the plane. */
static void find_freedom(const strut_former *former, bool *shift, bool *turn) {
  const strut_contact_table *contacts = &former->model->contacts;
  *shift = contacts->count == 0 || strut_contacts_are_level(contacts);
  *turn = contacts->count == 0;
  for (size_t i = 0; i < former->scene->node_count; i++) {
    if (former->scene->nodes[i].fixed[0]) *shift = *turn = false;
    if (former->scene->nodes[i].fixed[1]) *turn = false;
  }
}

/* Undoes the drift of a structure that nothing holds from where it started. */
static bool undo_drift(const strut_former *former, const double *start, double *positions) {
  strut_rigid_fit fit =
      strut_rigid_fit_find((int32_t)former->scene->node_count, start, positions, 1.0);
  bool shift, turn;
  find_freedom(former, &shift, &turn);
  if (!shift) return false;
  if (!turn) fit.cosine = 1.0, fit.sine = 0.0, fit.to[1] = fit.from[1];
  for (size_t i = 0; i < former->scene->node_count; i++)
    strut_rigid_fit_apply(&fit, positions + 2 * i, positions + 2 * i);
  return true;
}

/* The node that moved most between the start and q, and its distance. */
static double farthest(const strut_scene *scene, const double *positions, size_t *node) {
  double most = -1;
  for (size_t i = 0; i < scene->node_count; i++) {
    double moved = strut_distance(scene->nodes[i].start, positions + 2 * i);
    if (moved > most) most = moved, *node = i;
  }
  return most;
}

static strut_status judge(const strut_former *former, const strut_descent *descent,
                          const double *positions, strut_error *error) {
  size_t node = 0;
  bool finite = isfinite(descent->residual);
  for (size_t i = 0; i < 2 * former->scene->node_count; i++)
    finite = finite && isfinite(positions[i]);
  if (!finite) return form_out_of_range(error);
  double moved = farthest(former->scene, positions, &node);
  const char *name = former->scene->nodes[node].name;
  if (descent->end == STRUT_DESCENT_RUNAWAY)
    return strut_fail(error, STRUT_NOT_SETTLED,
                      "nothing holds the structure: %s moves away without end; support it", name);
  if (descent->end == STRUT_DESCENT_EXHAUSTED && !(descent->residual <= NEARLY * descent->rounding))
    return strut_fail(
        error, STRUT_NOT_SETTLED,
        "the structure does not come to rest: the residual is %.3g N, and %s still moves",
        descent->residual, name);
  if (former->form->from != STRUT_FORM_LENGTHS && moved > STABLE * former->size)
    return strut_fail(error, STRUT_NOT_SETTLED,
                      "the equilibrium found is not stable: left to itself, %s moves by %.3g m; "
                      "more tension (--least-tension) or stiffer members may hold it",
                      name, moved);
  return STRUT_OK;
}

/* Lets the structure come to rest from its start, to the last bits; a form by lengths is that. */
static strut_status polish(strut_former *former, strut_error *error) {
  strut_model *model = NULL;
  strut_potential *potential = NULL;
  strut_minimiser *minimiser = NULL;
  double *q = NULL;
  strut_scene *scene = former->scene;
  strut_status status = strut_model_compile(scene, &model, error);
  if (status == STRUT_OK)
    status = strut_potential_create(model, NULL, true, &former->arena, &potential, error);
  if (status == STRUT_OK)
    status = strut_minimiser_create(potential, &former->arena, &minimiser, error);
  if (status == STRUT_OK)
    q = strut_arena_allocate(&former->arena, (size_t)model->length, sizeof *q);
  if (status == STRUT_OK && !q) status = strut_no_memory(error, "");
  if (status == STRUT_OK) {
    memcpy(q, model->start, (size_t)model->length * sizeof *q);
    strut_minimiser_watch(minimiser, former->experiment->interrupt);
    strut_descent descent = strut_minimise(minimiser, q);
    if (descent.end != STRUT_DESCENT_RUNAWAY && undo_drift(former, model->start, q))
      descent = strut_polish(minimiser, q);
    former->form->residual = descent.residual;
    status = judge(former, &descent, q, error);
  }
  for (size_t i = 0; i < scene->node_count && status == STRUT_OK; i++)
    for (size_t c = 0; c < 2; c++) {
      scene->nodes[i].start[c] = q[2 * i + c];
      if (former->form->from == STRUT_FORM_LENGTHS) scene->nodes[i].position[c] = q[2 * i + c];
    }
  strut_model_free(model);
  return status;
}

/* The largest of 1, 2, 5 times a power of ten that is not above x. */
static double round_down(double x) {
  double power = pow(10, floor(log10(x))), digit = x / power;
  int exponent = (int)floor(log10(x));
  double lead = digit >= 5 ? 5 : digit >= 2 ? 2 : 1;
  return exponent < 0 ? lead / pow(10, -exponent) : lead * pow(10, exponent);
}

/* A step that the new shape bears, and a run where the scene has none. */
static strut_status add_run(strut_former *former, strut_error *error) {
  strut_experiment *experiment = former->experiment;
  strut_model *model = NULL;
  strut_step_limit limit = {0};
  strut_status status = strut_model_compile(former->scene, &model, error);
  former->form->massless = status == STRUT_OK && !model->mass;
  if (status == STRUT_OK && model->mass) {
    status = strut_step_limit_estimate(model, &limit, error);
    if (status == STRUT_OK && !(limit.limit > LEAST_STEP))
      status = strut_fail(error, STRUT_BAD_SCENE,
                          "stiffnesses are so large beside the masses that no time step can be "
                          "chosen; check their units");
    bool chosen = experiment->accuracy > 0.0,
         still = !(experiment->duration || experiment->periods);
    bool stepless = experiment->step == 0 && !chosen;
    former->form->run_added = stepless || still;
    if (status == STRUT_OK && !chosen && (stepless || experiment->step > limit.limit))
      experiment->step = isfinite(limit.limit) ? round_down(STEP_SHARE * limit.limit) : IDLE_STEP;
    if (still) experiment->duration = HOLD;
  }
  strut_model_free(model);
  return status;
}

static strut_status find(strut_former *former, strut_error *error) {
  strut_scene *scene = former->scene;
  strut_status status = STRUT_OK;
  if (former->form->from == STRUT_FORM_DENSITIES) status = form_densities(former, error);
  if (former->form->from == STRUT_FORM_PRESTRESS) status = strut_form_prestress(former, error);
  if (status != STRUT_OK) return status;
  fix_lengths(scene);
  remove_motion(scene, former->experiment);
  status = check_lengths(former, error);
  if (status == STRUT_OK) status = polish(former, error);
  return status == STRUT_OK ? add_run(former, error) : status;
}

/* Shapes drawn for another form mean nothing now. */
static void drop_shapes(strut_scene *scene) {
  for (size_t i = 0; i < scene->configuration_count; i++) {
    strut_configuration *configuration = &scene->configurations[i];
    for (size_t k = 0; k < scene->node_count && configuration->position; k++)
      memcpy(configuration->position[k], scene->nodes[k].position,
             sizeof configuration->position[k]);
    configuration->shaped = configuration->set_count == 0;
  }
}

/* Densities and forces that hold a shape are found for straight members with a linear law only. */
static strut_status refuse_elements(const strut_scene *scene, strut_form_source from,
                                    strut_error *error) {
  if (from == STRUT_FORM_LENGTHS) return STRUT_OK;
  for (size_t j = 0; j < scene->member_count; j++) {
    const strut_member *member = &scene->members[j];
    if (!strut_member_is_special(member)) continue;
    return strut_fail(error, STRUT_BAD_SCENE,
                      "form finding by %s knows straight members with a linear law only: %s %s",
                      form_source_name(from), member->name,
                      member->guide_count ? "runs over guides" : "has another law");
  }
  static const strut_thing others[] = {STRUT_THING_COLLISION, STRUT_THING_DISTANCE,
                                       STRUT_THING_CELL, STRUT_THING_HINGE, STRUT_THING_LOAD};
  for (size_t k = 0; k < sizeof others / sizeof *others; k++)
    for (size_t i = 0; i < strut_thing_count(scene, others[k]); i++)
      if (others[k] != STRUT_THING_LOAD || scene->loads[i].couple)
        return strut_fail(
            error, STRUT_BAD_SCENE,
            "form finding by %s knows straight members with a linear law only: %s is a %s",
            form_source_name(from), strut_thing_name(scene, others[k], i),
            others[k] == STRUT_THING_LOAD ? "moment" : strut_thing_at(others[k])->word);
  return STRUT_OK;
}

/* A member at the start; model: of the scene where it has elements, else NULL. */
static void measure_member(const strut_scene *scene, const strut_model *model, size_t j,
                           double pose[4]) {
  const strut_member *member = &scene->members[j];
  strut_rest rest = {0};
  double length = strut_form_length(scene, j), force = 0;
  bool known = strut_member_rest(scene, j, &rest);
  if (known && model && strut_element_of_member(&model->elements, (int32_t)j)) {
    length = strut_member_path_length(model, (int32_t)j, model->start);
    force = strut_member_elastic_tension(model, model->members.rest, (int32_t)j, model->start);
  } else if (known) {
    force = rest.stiffness * (length - rest.length);
    if (member->kind == STRUT_CABLE && force < 0) force = 0;
  }
  pose[0] = length, pose[1] = rest.length, pose[2] = force;
  pose[3] = length > 0 ? force / length : 0;
}

/* Lengths and forces of the members of the form that was found. */
static strut_status measure_members(strut_scene *scene, strut_form *form, strut_error *error) {
  size_t count = scene->member_count;
  strut_model *model = NULL;
  double *values = strut_arena_allocate(&scene->arena, 4 * count, sizeof *values);
  if (!values) return strut_no_memory(error, "");
  if (strut_model_compile(scene, &model, &(strut_error){0}) != STRUT_OK) model = NULL;
  for (size_t j = 0; j < count; j++) {
    double pose[4];
    measure_member(scene, model && model->elements.count ? model : NULL, j, pose);
    for (size_t k = 0; k < 4; k++) values[k * count + j] = pose[k];
  }
  form->length = values, form->rest = values + count;
  form->force = values + 2 * count, form->density = values + 3 * count;
  strut_model_free(model);
  return STRUT_OK;
}

strut_status strut_form_find(strut_setup *setup, const strut_form_options *options,
                             strut_form *form, strut_error *error) {
  strut_scene *scene = &setup->scene;
  strut_model *model = NULL;
  *form = (strut_form){.from = choose_source(scene, options->from)};
  strut_status status = strut_linear_solver_load(error);
  if (status) return status;
  strut_former f = {
      .scene = scene, .experiment = &setup->experiment, .options = options, .form = form};
  double *drawn = strut_arena_allocate(&f.arena, 2 * scene->node_count, sizeof *drawn);
  status = drawn ? strut_model_compile(scene, &model, error) : strut_no_memory(error, "");
  if (status == STRUT_OK)
    status = strut_potential_create(model, NULL, true, &f.arena, &f.potential, error);
  if (status == STRUT_OK) {
    for (size_t i = 0; i < 2 * scene->node_count; i++)
      drawn[i] = scene->nodes[i / 2].position[i % 2];
    f.model = model;
    f.size = model->size > 0 ? model->size : 1.0;
    if (f.size > LARGEST_SIZE)
      status = strut_fail(error, STRUT_BAD_SCENE,
                          "the drawn shape is %.3g m large, too large to compute with; check its "
                          "units",
                          f.size);
    form->driven = scene->actuator_count > 0 || model->loads.count > 0;
    if (status == STRUT_OK) status = refuse_elements(scene, form->from, error);
    if (status == STRUT_OK) status = find(&f, error);
  }
  if (status == STRUT_OK) {
    for (size_t i = 0; i < scene->node_count; i++)
      form->moved = fmax(form->moved, strut_distance(drawn + 2 * i, scene->nodes[i].position));
    if (form->moved > 0) drop_shapes(scene);
    status = measure_members(scene, form, error);
  }
  strut_model_free(model);
  strut_arena_free(&f.arena);
  return strut_experiment_end(&setup->experiment, status, error);
}

/* ---- what a form has, a row for each value ---- */

static double start_of(const strut_result_object *of, size_t k) {
  return of->scene->nodes[k / 2].start[k % 2];
}

static const char *member_name(const strut_result_object *of, size_t j) {
  return of->scene->members[j].name;
}

#define MEMBER(X)                                                                                  \
  X(NULL, "", TEXT(strut_member_kind_name(of->scene->members[j].kind)), "", .label = {"kind"})     \
  X(NULL, "m", NUMBER(form->length[j]), "", .label = {"length"})                                   \
  X(NULL, "m", NUMBER(form->rest[j]), "", .label = {"rest length"})                                \
  X(NULL, "N", NUMBER(form->force[j]), "", .label = {"force"})                                     \
  X(NULL, "N/m", NUMBER(form->density[j]), "", .label = {"force density"})
STRUT_VALUES_HERE(member_values, MEMBER, const strut_form *form = of->outer->at;
                  size_t j = of->index)

#define FORM(X)                                                                                    \
  X("from", "", TEXT(form_source_name(form->from)), "what was given", .label = {"form by"})        \
  X("moved", "m", NUMBER(form->moved), "largest displacement of a node from where it was drawn",   \
    .label = {"displacement"})                                                                     \
  X("residual", "N", NUMBER(form->residual), "largest net force on a free coordinate",             \
    .label = {"residual force"})                                                                   \
  X("density_change", "1", NUMBER(form->density_change),                                           \
    "largest change of a force density, of the largest one", .label = {""})                        \
  X("least_tension", "N", NUMBER(form->least_tension), "lower bound for the cables",               \
    .label = {""})                                                                                 \
  X("run_added", "", FLAG(form->run_added), "whether a step and 10 s were given to it",            \
    .label = {""})                                                                                 \
  X("driven", "", FLAG(form->driven), "whether drives or loads will move it", .label = {""})       \
  X("massless", "", FLAG(form->massless), "whether a node that can move has no mass",              \
    .label = {"without mass"})                                                                     \
  X("nodes", "m", OF_EACH(NODE, start_of), "positions")                                            \
  X("lengths", "m", OF(MEMBER, form->length), "of members")                                        \
  X("rest_lengths", "m", OF(MEMBER, form->rest), "of members")                                     \
  X("forces", "N", OF(MEMBER, form->force), "tensions of members")                                 \
  X("densities", "N/m", OF(MEMBER, form->density), "forces over lengths")                          \
  X(NULL, "", NAMED(form->length, of->scene->member_count, member_name), "",                       \
    .rows = &member_values, .label = {"member"})
STRUT_VALUES(strut_form_values, FORM, const strut_form *form = of->at)
