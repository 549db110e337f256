/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/settle.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/indices.h"
#include "engine/forces/elements.h"
#include "engine/forces/forces.h"
#include "engine/forces/tangent.h"
#include "engine/integrate/integrator.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/model/model.h"
#include "engine/model/pose.h"
#include "engine/scene/things.h"

/* What can never come to rest, found before it is tried: it slides along the ground whatever friction does. */

/* Pulls beyond what friction holds, over the push, that are rounding. */
static const double PULL_ROUNDING = 1e-12;

/* Forces on a part of the structure, and what the ground can hold of it. */
typedef struct held_part {
  double along, press; /* [N] */
  double grip;         /* largest static coefficient; 0: nothing sticks [1] */
} held_part;

static held_part find_grip(const strut_relaxation *relaxation, const int32_t *part_of, int32_t part,
                           const double force[2]) {
  const strut_contact_table *contacts = &relaxation->model->contacts;
  held_part found = {.along = force[0] * contacts->tangent[0] + force[1] * contacts->tangent[1],
                     .press = -force[0] * contacts->normal[0] - force[1] * contacts->normal[1]};
  for (int32_t i = 0; i < contacts->count; i++) {
    const strut_friction *friction = &contacts->entry[i].friction;
    if (part_of[contacts->entry[i].node] == part && friction->law != STRUT_FRICTION_NONE)
      found.grip = fmax(found.grip, strut_friction_static(friction, found.along));
  }
  return found;
}

static strut_status fail_sliding(const strut_relaxation *relaxation, const held_part *part,
                                 const char *node, strut_error *error) {
  char grip[100];
  if (!relaxation->experiment->settle.friction)
    snprintf(grip, sizeof grip, "friction acts with initial.settle.friction: kept");
  else if (part->grip > 0.0)
    snprintf(grip, sizeof grip, "it is %.4g at most", part->grip);
  else
    snprintf(grip, sizeof grip, "of the laws of friction coulomb and karnopp hold what is at rest");
  return strut_fail(error, STRUT_NOT_SETTLED,
                    "the structure cannot come to rest: nothing but friction holds node '%.60s' "
                    "along the ground, and that takes a static coefficient of at least %.4g; %s",
                    node, fabs(part->along) / part->press, grip);
}

strut_status strut_relaxation_check(strut_relaxation *relaxation, strut_error *error) {
  const strut_model *model = relaxation->model;
  const strut_contact_table *contacts = &model->contacts;
  size_t nodes = (size_t)model->node_count;
  if (!model->constant_force || !contacts->count || (contacts->surface && !contacts->parallel))
    return STRUT_OK;
  int32_t *part_of = strut_arena_allocate(&relaxation->arena, nodes, sizeof *part_of);
  strut_connected_part *part = strut_arena_allocate(&relaxation->arena, nodes, sizeof *part);
  if (!part_of || !part) return strut_no_memory(error, "");
  strut_connected_parts_find(model, model->constant_force, part_of, part);
  for (int32_t i = 0; i < model->node_count; i++) {
    if (part_of[i] != i || !part[i].touches || part[i].held[0] || part[i].held[1]) continue;
    held_part own = find_grip(relaxation, part_of, i, part[i].force);
    if (own.press > 0.0 && fabs(own.along) > (own.grip + PULL_ROUNDING) * own.press)
      return fail_sliding(relaxation, &own, relaxation->scene.nodes[i].name, error);
  }
  return STRUT_OK;
}

/* Force evaluations after which accelerations explained by rounding count as rest. */
static const int64_t ROUNDING_EVALUATIONS = 1000000;

/*
 * Friction while a structure comes to rest. Laws that stick do so exactly, and slide with the static coefficient, so
 * that sliding ends as soon as it may. Other laws vanish with the speed and hold nothing.
 */
static void make_static(strut_friction *friction, bool kept) {
  bool sticks = strut_friction_has_band(friction->law) || strut_friction_is_exact(friction->law);
  friction->law = kept && sticks ? STRUT_FRICTION_COULOMB : STRUT_FRICTION_NONE;
  friction->stick_velocity = DBL_MIN; /* so that the law, too, holds at a speed of zero */
  friction->mu_kinetic = friction->mu_static;
  friction->mu_kinetic_backward = friction->mu_static_backward;
}

/*
 * Copies the scene without drives, driven loads, feedback, belt and, unless kept, friction. Shares texts and
 * arrays.
 */
static strut_status copy_passive_scene(const strut_scene *scene, bool friction,
                                       strut_scene *passive, strut_arena *arena) {
  *passive = *scene;
  passive->actuator_count = 0;
  passive->nodes = strut_arena_copy(arena, scene->nodes, scene->node_count, sizeof *passive->nodes);
  if (!passive->nodes) return STRUT_NO_MEMORY;
  if (!strut_scene_hold_sliding_masses(passive, arena)) return STRUT_NO_MEMORY;
  strut_scene_hold_supports(passive, false);
  strut_scene_stop_unbalances(passive);
  passive->ground.belt_speed = 0.0;
  passive->bar_model = STRUT_BARS_ELASTIC; /* they become rigid in the settled, loaded shape */
  passive->loads = strut_arena_allocate(arena, scene->load_count, sizeof *passive->loads);
  passive->contacts = strut_arena_allocate(arena, scene->contact_count, sizeof *passive->contacts);
  if (!passive->loads || !passive->contacts || !strut_scene_stop_grounds(passive, arena))
    return STRUT_NO_MEMORY;
  passive->load_count = 0;
  for (size_t i = 0; i < scene->load_count; i++)
    if (scene->loads[i].signal < 0) passive->loads[passive->load_count++] = scene->loads[i];
  for (size_t i = 0; i < scene->contact_count; i++) {
    passive->contacts[i] = scene->contacts[i];
    strut_scene_stop_grip(scene, &passive->contacts[i].friction);
    make_static(&passive->contacts[i].friction, friction);
  }
  strut_collision *bodies =
      strut_arena_copy(arena, scene->collisions, scene->collision_count, sizeof *bodies);
  if (!bodies) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < scene->collision_count && !friction; i++)
    bodies[i].friction.mu_kinetic = 0.0;
  passive->collisions = bodies;
  return strut_scene_remove_feedback(passive, arena) ? STRUT_OK : STRUT_NO_MEMORY;
}

/* The largest absolute entry of x and its node; infinite where x has a NaN. */
static double find_largest(const double *vector, int32_t n, int32_t *node) {
  double most = 0.0;
  *node = 0;
  for (int32_t i = 0; i < n; i++) {
    if (!(fabs(vector[i]) <= most)) most = fabs(vector[i]), *node = i / 2;
    if (isnan(vector[i])) return HUGE_VAL;
  }
  return most;
}

/* The last bits of strains and positions, through slope and gradient, as forces on the nodes. */
static void add_element_rounding(const strut_relaxation *relaxation, double *force) {
  const strut_element_table *elements = &relaxation->model->elements;
  const double *q = relaxation->state->q;
  strut_element_pose pose;
  for (int32_t i = 0; i < elements->count; i++) {
    const strut_element *element = &elements->element[i];
    const uint32_t *at = elements->at + element->first;
    strut_element_evaluate(relaxation->model, i, relaxation->state->latest->rest, q,
                           relaxation->state->history.turn[i], &pose);
    double bits = fabs(pose.strain) * DBL_EPSILON;
    for (int32_t k = 0; k < element->nodes; k++)
      bits +=
          hypot(pose.b[2 * k], pose.b[2 * k + 1]) * strut_coordinate_rounding(q + at[k], q + at[k]);
    for (int32_t k = 0; k < element->nodes; k++)
      force[at[k]] += fabs(pose.slope) * bits * hypot(pose.b[2 * k], pose.b[2 * k + 1]);
  }
}

/* The acceleration that rounding of the positions may cause at a node of stiff members. */
static double rounding_acceleration(const strut_relaxation *relaxation) {
  const strut_model *model = relaxation->model;
  const strut_member_table *members = &model->members;
  double worst = 0.0, *force = relaxation->acceleration;
  memset(force, 0, (size_t)model->length * sizeof *force);
  for (int32_t j = 0; j < members->count; j++) {
    const double *a = relaxation->state->q + members->from[j],
                 *b = relaxation->state->q + members->to[j];
    double far = strut_coordinate_rounding(a, b);
    force[members->from[j]] += members->stiffness[j] * far;
    force[members->to[j]] += members->stiffness[j] * far;
  }
  add_element_rounding(relaxation, force);
  for (int32_t i = 0; i < model->node_count; i++)
    if (model->weight[i] > 0.0) worst = fmax(worst, force[2 * i] / model->weight[i]);
  return 4.0 * worst;
}

/* With friction, the last bit of a speed is sliding; what comes to rest stands. */
static void accelerate(const strut_relaxation *relaxation) {
  const double *v =
      relaxation->experiment->settle.friction ? relaxation->still : relaxation->state->v;
  strut_forces_acceleration(relaxation->model, relaxation->state, 0.0, relaxation->state->q, v,
                            relaxation->acceleration);
}

static strut_status fail_not_settled(const strut_relaxation *relaxation, strut_error *error) {
  const strut_settle *wanted = &relaxation->experiment->settle;
  int32_t fastest, pushed, length = relaxation->model->length;
  double speed = find_largest(relaxation->state->v, length, &fastest);
  accelerate(relaxation);
  double push = find_largest(relaxation->acceleration, length, &pushed);
  bool late = relaxation->time >= wanted->limit, moves = !(speed < wanted->speed);
  bool slides = relaxation->scene.contact_count && !wanted->friction;
  char within[60];
  snprintf(within, sizeof within, late ? "%g s" : "%g evaluations of the forces",
           late ? wanted->limit : (double)relaxation->evaluations);
  return strut_fail(error, STRUT_NOT_SETTLED,
                    "the structure did not come to rest within %s: largest speed %.3g m/s, "
                    "largest acceleration %.3g m/s^2, node '%.60s' %s most; give a larger "
                    "initial.settle.%s or looser speed and acceleration%s",
                    within, speed, push, relaxation->scene.nodes[moves ? fastest : pushed].name,
                    moves ? "moving" : "accelerating", late ? "limit" : "evaluations",
                    slides ? ", or let it hold by initial.settle.friction: kept" : "");
}

static strut_status fail_diverged(const strut_relaxation *relaxation, double time,
                                  strut_error *error) {
  if (relaxation->state->trouble)
    return strut_fail(error, STRUT_DIVERGED,
                      "%s failed while settling, after %g s; look for a member of zero length",
                      relaxation->method->name, time);
  return strut_fail(error, STRUT_DIVERGED,
                    "settling before the run diverged after %g s with a step of %g s; use a "
                    "smaller initial.settle.step",
                    time, relaxation->step);
}

/* Sets all velocities to zero: at the start and whenever the kinetic energy has passed a peak. */
static void stop_motion(strut_relaxation *relaxation) {
  memset(relaxation->state->v, 0, (size_t)relaxation->model->length * sizeof(double));
  if (relaxation->method->restart)
    relaxation->method->restart(relaxation->model, relaxation->state, relaxation->workspace,
                                relaxation->step);
}

strut_status strut_relaxation_run(strut_relaxation *relaxation, strut_error *error) {
  const strut_settle *wanted = &relaxation->experiment->settle;
  strut_state *state = relaxation->state;
  double dt = relaxation->step, previous = 0.0, before = relaxation->time,
         enough = wanted->acceleration;
  double most = wanted->evaluations > 0.0 ? wanted->evaluations : STRUT_SETTLE_EVALUATIONS;
  int64_t spent = relaxation->evaluations;
  int32_t length = relaxation->model->length, node;
  bool strict = true;
  state->limits.interrupt = relaxation->interrupt;
  stop_motion(relaxation);
  while (relaxation->time < wanted->limit && (double)relaxation->evaluations < most) {
    if (relaxation->interrupt && *relaxation->interrupt)
      return strut_fail(error, STRUT_INTERRUPTED, "interrupted while coming to rest");
    relaxation->method->advance(relaxation->model, state, relaxation->workspace, dt, 1);
    relaxation->time = before + (double)state->step * dt;
    relaxation->evaluations = spent + state->latest->evaluations;
    if (state->trouble == STRUT_FAILURE_INTERRUPT) continue;
    double kinetic = strut_energy_kinetic(relaxation->model, state->v);
    if (state->trouble || !isfinite(kinetic))
      return fail_diverged(relaxation, relaxation->time - before, error);
    if (kinetic < previous) {
      stop_motion(relaxation);
      kinetic = 0.0;
    }
    previous = kinetic;
    if (strict && relaxation->evaluations > ROUNDING_EVALUATIONS) {
      strict = false;
      enough = fmax(enough, rounding_acceleration(relaxation));
    }
    if (!(find_largest(state->v, length, &node) < wanted->speed)) continue;
    accelerate(relaxation);
    if (find_largest(relaxation->acceleration, length, &node) < enough) return STRUT_OK;
  }
  return fail_not_settled(relaxation, error);
}

strut_status strut_relaxation_create(const strut_model *model, const strut_experiment *experiment,
                                     strut_relaxation *relaxation, strut_error *error) {
  const strut_settle *settle = &experiment->settle;
  *relaxation = (strut_relaxation){.experiment = experiment};
  if (settle->friction && strut_bristle_count(model->scene))
    return strut_fail(error, STRUT_BAD_SCENE,
                      "initial.settle.friction: kept is for friction that sticks by itself, not by "
                      "bristles (lugre), which settling would straighten again and again; use "
                      "settle: true, or another law");
  strut_status status =
      copy_passive_scene(model->scene, settle->friction, &relaxation->scene, &relaxation->arena);
  relaxation->step = settle->step > 0.0 ? settle->step : experiment->step;
  relaxation->acceleration =
      strut_arena_allocate(&relaxation->arena, (size_t)model->length, sizeof(double));
  relaxation->still =
      strut_arena_allocate(&relaxation->arena, (size_t)model->length, sizeof(double));
  if (!relaxation->acceleration || !relaxation->still) status = STRUT_NO_MEMORY;
  if (status) return strut_fail(error, status, "out of memory");
  status = strut_model_compile(&relaxation->scene, &relaxation->model, error);
  if (!status) status = strut_state_create(relaxation->model, &relaxation->state, error);
  if (status) return status;
  relaxation->state->forgetful = true;
  relaxation->method = strut_integrator_for_settling(relaxation->model);
  const strut_integrator_settings settings = strut_integrator_settings_of(experiment);
  relaxation->workspace =
      relaxation->method->create(relaxation->model, relaxation->state, &settings);
  return relaxation->workspace ? STRUT_OK : strut_no_memory(error, "");
}

void strut_relaxation_free(strut_relaxation *relaxation) {
  strut_state_free(relaxation->state);
  strut_model_free(relaxation->model);
  strut_arena_free(&relaxation->arena);
  *relaxation = (strut_relaxation){.model = NULL};
}

/* ---- settling an experiment ---- */

/* Part of the largest stiffness that rounding may give a motion without stiffness. */
static const double ROUNDING = 1e-12;
/* The most unstable direction of an equilibrium. */
typedef struct instability {
  int32_t node;       /* that moves most; -1: the equilibrium is not unstable */
  double stiffness;   /* lowest eigenvalue of the Hessian [N/m] */
  double growth_rate; /* [1/s] */
  double *direction;  /* (length) 1 where the node moves; of the arena; NULL where not unstable */
} instability;

/* Row of a coordinate, or -1 where it is fixed. */
static int32_t find_row(const strut_tangent *tangent, int32_t coordinate) {
  int32_t row = strut_index_find(tangent->coordinate, tangent->n, coordinate);
  return row < tangent->n && tangent->coordinate[row] == coordinate ? row : -1;
}

/* Adds the ground stiffness along the ground for contacts that touch and may stick. */
static void add_stick_stiffness(const strut_model *model, const double *positions,
                                strut_tangent *tangent) {
  const strut_contact_table *contacts = &model->contacts;
  for (int32_t i = 0; i < contacts->count; i++) {
    const strut_contact_entry *contact = &contacts->entry[i];
    const strut_contact_pose pose = strut_contact_pose_at(contacts, i, positions, NULL, -1);
    const double *t = pose.axes.tangent;
    bool touches = pose.gap < 0.0;
    bool sticks = strut_friction_has_band(contact->friction.law) ||
                  strut_friction_is_exact(contact->friction.law);
    if (!touches || !sticks ||
        !(contact->friction.mu_static > 0.0 || contact->friction.mu_static_backward > 0.0))
      continue;
    strut_sparse *matrix = tangent->stiffness;
    const int32_t row[2] = {find_row(tangent, (int32_t)contacts->at[i]),
                            find_row(tangent, (int32_t)contacts->at[i] + 1)};
    for (int a = 0; a < 2; a++) {
      if (row[a] < 0) continue;
      matrix->value[matrix->start[row[a]]] += contact->stiffness * t[a] * t[a];
      for (int32_t p = matrix->start[row[a]] + 1; a == 0 && p < matrix->start[row[a] + 1]; p++)
        if (matrix->row[p] == row[1]) matrix->value[p] += contact->stiffness * t[0] * t[1];
    }
  }
}

/* Threshold below which a stiffness is rounding or due to forces not quite in balance. */
static double find_stiffness_threshold(const strut_model *model, double acceleration,
                                       const strut_sparse *matrix) {
  double stiffest = 0.0, heaviest = 0.0;
  for (int32_t i = 0; i < matrix->n; i++)
    stiffest = fmax(stiffest, fabs(matrix->value[matrix->start[i]]));
  for (int32_t i = 0; i < model->node_count; i++) heaviest = fmax(heaviest, model->weight[i]);
  return ROUNDING * stiffest + 10.0 * acceleration * heaviest / model->size;
}

/* Describes the eigenvector x (n): the node that moves most, its direction, and the growth rate. */
static void describe_direction(const strut_model *model, const strut_tangent *tangent,
                               const double *vector, instability *found) {
  double *d = found->direction, most = -1.0;
  for (int32_t i = 0; i < tangent->n; i++) d[tangent->coordinate[i]] = vector[i];
  for (int32_t i = 0; i < model->node_count; i++) {
    double moved = hypot(d[2 * i], d[2 * i + 1]);
    if (moved > most * (1.0 + 1e-9)) most = moved, found->node = i;
  }
  const double *at = d + 2 * found->node;
  double scale = (fabs(at[0]) >= 1e-6 * fabs(at[1]) ? at[0] : at[1]) < 0.0 ? -most : most;
  for (int32_t i = 0; i < 2 * model->node_count; i++) d[i] = d[i] / scale + 0.0;
  double inertia = 2.0 * strut_energy_kinetic(model, d) * most * most;
  found->growth_rate = inertia > 0.0 ? sqrt(-found->stiffness / inertia) : 0.0;
}

/*
 * Counts the negative eigenvalues of the tangent stiffness at q by Sylvester's law of inertia,
 * touching contacts closed, and held along the ground where they stick. Motions without stiffness,
 * such as those of a free structure, are no instability; nor is a stiffness within the residual
 * `acceleration` [m/s^2] of rest. STRUT_NO_MEMORY.
 */
static strut_status find_instability(const strut_model *model, double acceleration,
                                     const double *positions, strut_arena *arena,
                                     instability *found, strut_error *error) {
  strut_arena scratch = {0};
  strut_tangent tangent;
  strut_ldl *ldl = NULL;
  *found = (instability){.node = -1};
  strut_status status = strut_tangent_assemble(model, positions, model->members.rest,
                                               STRUT_CLOSED_TOUCHING, &scratch, &tangent);
  double *x = NULL;
  if (!status) {
    x = strut_arena_allocate(&scratch, 2 * (size_t)tangent.n + 1, sizeof *x);
    found->direction = strut_arena_allocate(arena, (size_t)model->length, sizeof(double));
    if (!x || !found->direction) status = STRUT_NO_MEMORY;
  }
  if (status) strut_fail(error, status, "out of memory");
  if (!status && tangent.n > 0) {
    add_stick_stiffness(model, positions, &tangent);
    double least = find_stiffness_threshold(model, acceleration, tangent.stiffness);
    status = strut_ldl_create(tangent.stiffness, &scratch, &ldl, error);
    if (!status && least > 0.0 && isfinite(least))
      found->stiffness = strut_ldl_lowest(ldl, tangent.stiffness, least, x, x + tangent.n);
    if (found->stiffness < -0.5 * least) describe_direction(model, &tangent, x, found);
  }
  if (found->node < 0) *found = (instability){.node = -1};
  strut_arena_free(&scratch);
  return status;
}

/* ---- the settled start of an experiment ---- */

/*
 * Part of the largest stable step taken where the scene gives none; times a diverging step is
 * halved.
 */
static const double LIMIT_FRACTION = 0.5;
enum { HALVINGS = 6, MOST_PERTURBATIONS = 8 };
/* Perturbation of the node that moves most, in model sizes. */
static const double PUSH = 1e-4;

static strut_status choose_settle_step(strut_relaxation *relaxation, strut_error *error) {
  const strut_settle *settle = &relaxation->experiment->settle;
  double given = settle->step == 0.0 ? relaxation->experiment->step : settle->step, limit = 0.0;
  if (!relaxation->model->mass) return strut_fail(error, STRUT_SINGULAR, "a free node has no mass");
  strut_status status =
      strut_step_limit_for_method(relaxation->model, relaxation->method, &limit, error);
  if (status) return status;
  if (given > 0.0 && given <= fmin(limit, settle->limit))
    relaxation->step = given;
  else
    relaxation->step = isfinite(limit) ? LIMIT_FRACTION * limit : 1e-4 * settle->limit;
  return STRUT_OK;
}

/* Relaxes from `from` (length), with a smaller step where it diverges. */
static strut_status relax_from(strut_relaxation *relaxation, const double *from,
                               strut_error *error) {
  strut_status status = STRUT_DIVERGED;
  for (int i = 0; i <= HALVINGS && status == STRUT_DIVERGED; i++) {
    if (i > 0) relaxation->step *= 0.5;
    strut_state_reset(relaxation->model, relaxation->state);
    memcpy(relaxation->state->q, from, (size_t)relaxation->model->length * sizeof *from);
    memset(relaxation->state->v, 0,
           2 * (size_t)relaxation->model->node_count * sizeof *relaxation->state->v);
    status = strut_relaxation_run(relaxation, error);
  }
  return status;
}

/*
 * Settles, and leaves unstable equilibria where requested. q (length): start positions in, settled
 * positions out.
 */
static strut_status settle_and_perturb(strut_relaxation *relaxation, double *positions,
                                       strut_settle_summary *how, strut_error *error) {
  instability unstable;
  for (;;) {
    strut_status status = relax_from(relaxation, positions, error);
    if (!status)
      status = find_instability(relaxation->model, relaxation->experiment->settle.acceleration,
                                relaxation->state->q, &relaxation->arena, &unstable, error);
    if (status) return status;
    if (unstable.node < 0 || !relaxation->experiment->settle.perturb ||
        how->perturbations == MOST_PERTURBATIONS)
      break;
    for (int32_t i = 0; i < 2 * relaxation->model->node_count; i++)
      positions[i] =
          relaxation->state->q[i] + PUSH * relaxation->model->size * unstable.direction[i];
    how->perturbations++;
  }
  memcpy(positions, relaxation->state->q, (size_t)relaxation->model->length * sizeof *positions);
  how->step = relaxation->step;
  how->evaluations = relaxation->evaluations;
  how->unstable = unstable.node >= 0;
  if (!how->unstable) return STRUT_OK;
  how->stiffness = unstable.stiffness;
  how->growth_rate = unstable.growth_rate;
  how->node = relaxation->scene.nodes[unstable.node].name;
  return STRUT_OK;
}

strut_status strut_settle_experiment(const strut_model *model, const strut_experiment *experiment,
                                     const strut_flag *interrupt, double *positions,
                                     strut_settle_summary *how, strut_error *error) {
  strut_relaxation r;
  strut_status status = strut_relaxation_create(model, experiment, &r, error);
  *how = (strut_settle_summary){0};
  r.interrupt = interrupt;
  memcpy(positions, model->start, (size_t)model->length * sizeof *positions);
  if (!status) status = strut_relaxation_check(&r, error);
  if (!status) status = choose_settle_step(&r, error);
  if (!status) status = settle_and_perturb(&r, positions, how, error);
  how->time = r.time;
  strut_relaxation_free(&r);
  return status;
}

/* Copies the scene with its nodes in the positions q (length). */
static strut_status move_start(const strut_scene *scene, const double *positions,
                               strut_settled_start *start) {
  strut_scene *settled = start->scene = strut_arena_allocate(&start->arena, 1, sizeof *settled);
  if (!settled) return STRUT_NO_MEMORY;
  *settled = *scene;
  settled->nodes =
      strut_arena_copy(&start->arena, scene->nodes, scene->node_count, sizeof *settled->nodes);
  if (!settled->nodes) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < scene->node_count; i++)
    for (size_t c = 0; c < 2; c++)
      if (!scene->nodes[i].fixed[c]) settled->nodes[i].start[c] = positions[2 * i + c];
  return STRUT_OK;
}

strut_status strut_settle_model(const strut_model *model, const strut_experiment *experiment,
                                const strut_flag *interrupt, strut_settled_start *start,
                                strut_error *error) {
  *start = (strut_settled_start){.model = model};
  if (!experiment->settle.wanted) return STRUT_OK;
  double *q = strut_arena_allocate(&start->arena, (size_t)model->length, sizeof *q);
  if (!q) return strut_no_memory(error, "");
  strut_status status =
      strut_settle_experiment(model, experiment, interrupt, q, &start->how, error);
  if (status) return status;
  if (move_start(model->scene, q, start)) return strut_no_memory(error, "");
  status = strut_model_compile(start->scene, &start->own, error);
  start->model = start->own;
  return status;
}

void strut_settled_start_free(strut_settled_start *start) {
  strut_model_free(start->own);
  strut_arena_free(&start->arena);
  *start = (strut_settled_start){.model = NULL};
}
