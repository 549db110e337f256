/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The implicit midpoint method: first the matrix of its steps, then the method. */
#include <math.h>
#include <string.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/elements.h"
#include "engine/forces/tangent.h"
#include "engine/integrate/discrete_gradient.h"
#include "engine/integrate/integrator.h"
#include "engine/model/algebra/linear_solver.h"
#include "engine/model/mass.h"

typedef struct strut_midpoint_matrix {
  int32_t n;           /* free coordinates */
  int32_t *coordinate; /* (n) where they stand in coordinate arrays */
  strut_sparse *matrix;
  double *mass;          /* M at the matrix's places */
  int32_t *place;        /* (members and elements) into its values; -1 where supported */
  strut_ldl *factor;     /* NULL where nothing is free */
  double *lightness;     /* (members) inverse masses of their free ends, added [1/kg] */
  strut_vec2 *direction; /* (members) that the factor was made with */
  double *slope;         /* (members) likewise */
} strut_midpoint_matrix;

static void add_masses(const strut_model *model, const int32_t *row_of, strut_triplets *sum) {
  for (int c = 0; c < 2; c++) {
    const strut_mass_operator *op = &model->mass->coordinate[c];
    for (int32_t j = 0; j < op->matrix->n; j++)
      for (int32_t k = op->matrix->start[j]; k < op->matrix->start[j + 1]; k++)
        strut_triplets_add(sum, row_of[2 * op->matrix_node[op->matrix->row[k]] + c],
                           row_of[2 * op->matrix_node[j] + c], op->matrix->value[k]);
  }
}

/* M with room for what members add: the pattern of the step's matrix. */
static bool make_pattern(const strut_model *model, const int32_t *row_of, strut_arena *arena,
                         strut_midpoint_matrix *matrix) {
  strut_arena scratch = {0};
  strut_triplets sum = {0};
  size_t most = strut_tangent_entries(model, false);
  for (int c = 0; c < 2; c++) {
    const strut_sparse *mass = model->mass->coordinate[c].matrix;
    most += (size_t)mass->start[mass->n];
  }
  bool good = strut_triplets_reserve(&sum, most, &scratch);
  if (good) {
    add_masses(model, row_of, &sum);
    strut_tangent_add_pattern(model, row_of, false, &sum);
    matrix->matrix = strut_sparse_build(matrix->n, &sum, arena);
  }
  strut_arena_free(&scratch);
  return good && matrix->matrix;
}

static bool make_members(const strut_model *model, strut_arena *arena,
                         strut_midpoint_matrix *matrix) {
  const strut_member_table *members = &model->members;
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(matrix->lightness, members->count),
                      STRUT_NEW(matrix->direction, members->count),
                      STRUT_NEW(matrix->slope, members->count)))
    return false;
  for (int32_t j = 0; j < members->count; j++)
    for (int e = 0; e < 2; e++) {
      uint32_t at = e ? members->to[j] : members->from[j];
      if (!model->fixed[at] || !model->fixed[at + 1])
        matrix->lightness[j] += 1.0 / model->weight[at / 2];
    }
  return true;
}

/* In the arena; false: out of memory. */
static bool strut_midpoint_matrix_create(const strut_model *model, strut_arena *arena,
                                         strut_midpoint_matrix *matrix) {
  int32_t *row_of;
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(row_of, model->length),
                      STRUT_NEW(matrix->coordinate, model->length),
                      STRUT_NEW(matrix->place, strut_tangent_entries(model, false))))
    return false;
  matrix->n = strut_number_free(model, NULL, row_of, matrix->coordinate);
  if (matrix->n == 0) return true;
  if (!make_members(model, arena, matrix)) return false;
  if (!make_pattern(model, row_of, arena, matrix)) return false;
  size_t entries = (size_t)matrix->matrix->start[matrix->n];
  matrix->mass = strut_arena_allocate(arena, entries, sizeof *matrix->mass);
  if (!matrix->mass || strut_ldl_create(matrix->matrix, arena, &matrix->factor, NULL)) return false;
  memcpy(matrix->mass, matrix->matrix->value, entries * sizeof *matrix->mass);
  strut_tangent_find_places(model, row_of, false, matrix->matrix, matrix->place);
  return true;
}

/* The direction of a member's force; 0 where it has none. */
static strut_vec2 force_direction(const strut_discrete_gradient *step, int32_t j) {
  strut_vec2 sum = {step->sum[0][j], step->sum[1][j]};
  return strut_vec2_unit(sum, strut_vec2_length(sum));
}

/* Adds h^2/2 of what the forces of member j change by with its end: B, -B, B. */
static void add_member(const strut_model *model, const strut_discrete_gradient *step, int32_t j,
                       double tension, strut_midpoint_matrix *matrix) {
  double half = 0.5 * step->h * step->h, lengths = step->lengths[j];
  strut_vec2 u = matrix->direction[j] = force_direction(step, j);
  bool shapeless = u.x == 0.0 && u.y == 0.0; /* as an isotropic spring */
  matrix->slope[j] = step->slope[j];
  strut_force force;
  double k[16];
  strut_force_begin(model, j, &force);
  strut_member_stiffness(step->slope[j], shapeless ? step->slope[j] : tension / lengths, u, k);
  for (int i = 0; i < 16; i++) k[i] *= half;
  strut_force_scatter(&force, k, matrix->place, matrix->matrix->value);
}

/* What the average force changes by with the end; it turns with half of the force there. */
static void add_element(const strut_model *model, const strut_discrete_gradient *step, int32_t i,
                        const double *rest, const double *positions, bool clip,
                        strut_midpoint_matrix *matrix) {
  double k[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT];
  strut_force force;
  strut_force_begin(model, model->members.count + i, &force);
  strut_element_evaluate(model, i, rest, positions, step->strain0[i], &force.pose);
  double half = 0.5 * step->h * step->h;
  strut_force_square(&force, half * step->element_slope[i], k);
  if (!clip) strut_force_bend(model, &force, positions, 0.5 * half, k);
  strut_force_scatter(&force, k, matrix->place, matrix->matrix->value);
}

/*
 * Builds and factorises it for the step as it was evaluated last, to positions q (length) with rest
 * lengths `rest` (slots). `tension` (members): what turns
 * with a member; where that leaves no positive definite matrix, or with `stiff`, compression is left
 * out, which makes it one. False: not even then.
 */
static bool strut_midpoint_matrix_update(const strut_model *model,
                                         const strut_discrete_gradient *step, const double *rest,
                                         const double *positions, const double *tension, bool stiff,
                                         strut_midpoint_matrix *matrix) {
  for (bool clip = stiff;; clip = true) {
    double whole = 1.0 + 0.5 * step->h * model->mass_damping;
    for (int32_t k = 0; k < matrix->matrix->start[matrix->n]; k++)
      matrix->matrix->value[k] = whole * matrix->mass[k];
    for (int32_t j = 0; j < model->members.count; j++)
      add_member(model, step, j, clip ? fmax(tension[j], 0.0) : tension[j], matrix);
    for (int32_t i = 0; i < model->elements.count; i++)
      add_element(model, step, i, rest, positions, clip, matrix);
    strut_inertia inertia;
    if (!strut_ldl_factorise(matrix->factor, matrix->matrix, 0.0, &inertia) &&
        inertia.negative == 0)
      return true;
    if (clip) return false;
  }
}

/*
 * Would the factor mislead? A stiff member that has turned by an angle a since, whose force it takes
 * for one along the old direction, moves its ends aside so far that its length changes by
 * (h^2/2 slope sin^2 a / mass) times what was to be undone; and a cable may have gone slack or taut.
 */
static bool strut_midpoint_matrix_stale(const strut_model *model,
                                        const strut_discrete_gradient *step,
                                        const strut_midpoint_matrix *matrix) {
  const double much = 1e-3;
  for (int32_t j = 0; j < model->members.count; j++) {
    double per_mass = 0.5 * step->h * step->h * matrix->lightness[j];
    strut_vec2 u = force_direction(step, j), before = matrix->direction[j];
    double sine = u.x * before.y - u.y * before.x;
    double change = fabs(step->slope[j] - matrix->slope[j]);
    if (per_mass * step->slope[j] * sine * sine > much) return true;
    if (per_mass * change > much * (1.0 + per_mass * matrix->slope[j])) return true;
  }
  return false;
}

/* product (n) = M x (length). */
static void strut_midpoint_matrix_mass(const strut_midpoint_matrix *matrix, const double *vector,
                                       double *product) {
  const strut_sparse *a = matrix->matrix;
  for (int32_t i = 0; i < matrix->n; i++) product[i] = 0.0;
  for (int32_t j = 0; j < matrix->n; j++) {
    double xj = vector[matrix->coordinate[j]];
    product[j] += matrix->mass[a->start[j]] * xj;
    for (int32_t k = a->start[j] + 1; k < a->start[j + 1]; k++) {
      product[a->row[k]] += matrix->mass[k] * xj;
      product[j] += matrix->mass[k] * vector[matrix->coordinate[a->row[k]]];
    }
  }
}

/*
 * Implicit midpoint with a fixed step, for stiff members without ground: velocities and positions
 * from M (v1 - v0) = h F, q1 - q0 = h (v0 + v1) / 2, where the members' forces in F are averaged over
 * the step so that energies change by what is done on them (averaged.h). Of order 2, stable at every
 * step, and undamped: motions too fast for the step stay as large as they are.
 *
 * Newton's method in the mean velocity u: R = M (u - v0) - h/2 F, to near rounding. The factor is
 * kept from step to step and made anew where it no longer serves.
 */

enum { MOST_TURNS = 30, MOST_HALVINGS = 4 };
/* Corrections that shrink by less than this want a new factor. */
static const double SLOW = 0.2;
/* Corrections within so many times rounding are the last; where they stall within the second. */
static const double CLOSE = 8.0, STALLED = 1e5;
static const double ROUNDING = 0x1p-52;

typedef struct midpoint_workspace {
  strut_discrete_gradient step;
  strut_midpoint_matrix matrix;
  double *u, *q1;       /* (length) mean velocity, positions at the end */
  double *before[2];    /* (length) mean velocities of the last two steps, latest first */
  int known;            /* of those */
  double *grid[2];      /* (length) positions and velocities on the latest grid point */
  double *held;         /* (members) tension in the step before [N] */
  double *x, *residual; /* (n) correction, and what it is to undo */
  double stiffest;      /* about the largest squared frequency [1/s^2] */
  double *moved[3];     /* (moved coordinates) velocities at both ends of a step, and on average */
  double factor_step;   /* the step that the factor is for [s]; 0: none; below: never restarted */
  bool states_settled;  /* the latest correction changed no internal state by more than rounding */
} midpoint_workspace;

/* Stiffness over mass at the worst node. */
static double stiffest_of(const strut_model *model) {
  const strut_member_table *members = &model->members;
  double most = 0.0;
  for (int32_t j = 0; j < members->count; j++)
    for (int e = 0; e < 2; e++) {
      uint32_t at = e ? members->to[j] : members->from[j];
      if (model->fixed[at] && model->fixed[at + 1]) continue;
      most = fmax(most, 4.0 * members->stiffness[j] / model->weight[at / 2]);
    }
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *element = &model->elements.element[i];
    const uint32_t *at = model->elements.at + element->first;
    strut_element_pose pose;
    strut_element_evaluate(model, i, members->rest, model->start, (double)NAN, &pose);
    double stiffness = fmax(pose.slope, element->numbers.stiffness);
    for (int32_t k = 0; k < element->nodes; k++) {
      if (model->fixed[at[k]] && model->fixed[at[k] + 1]) continue;
      double square = pose.b[2 * k] * pose.b[2 * k] + pose.b[2 * k + 1] * pose.b[2 * k + 1];
      most = fmax(most, 4.0 * stiffness * square / model->weight[at[k] / 2]);
    }
  }
  return most;
}

static void *midpoint_create(const strut_model *model, strut_state *state,
                             const strut_integrator_settings *settings) {
  (void)settings;
  strut_arena *arena = &state->arena;
  midpoint_workspace *workspace = strut_arena_allocate(arena, 1, sizeof *workspace);
  if (!workspace || !strut_discrete_gradient_create(model, state, &workspace->step) ||
      !strut_midpoint_matrix_create(model, arena, &workspace->matrix) ||
      !STRUT_NUMBERS(arena, model->length, &workspace->u, &workspace->q1, &workspace->before[0],
                     &workspace->before[1], &workspace->grid[0], &workspace->grid[1], &workspace->x,
                     &workspace->residual) ||
      !STRUT_NUMBERS(arena, model->members.count, &workspace->held) ||
      !STRUT_NUMBERS(arena, model->support_motion.count, &workspace->moved[0], &workspace->moved[1],
                     &workspace->moved[2]))
    return NULL;
  workspace->stiffest = stiffest_of(model);
  workspace->factor_step = -1.0;
  return workspace;
}

static void midpoint_restart(const strut_model *model, strut_state *state, void *workspace,
                             double dt) {
  midpoint_workspace *w = workspace;
  if (model->terms & STRUT_TERM_DRIVE) strut_drive_apply(model, state, (double)state->step * dt);
  strut_discrete_gradient_tensions(model, state, w->held);
  w->known = 0;
  w->factor_step = 0.0;
}

/* Velocities of supports at both ends of the step and on average; they may jump within it. */
static void move_supports(const strut_model *model, const strut_state *state,
                          midpoint_workspace *workspace) {
  double t = workspace->step.begin + workspace->step.h;
  for (int32_t i = 0; i < model->support_motion.count; i++) {
    const strut_moved_coordinate *coordinate = &model->support_motion.item[i];
    double value;
    strut_signal_evaluate(model->scene->signals, coordinate->signal, t + state->time_offset, &value,
                          &workspace->moved[1][i]);
    workspace->moved[0][i] = state->v[coordinate->at];
    workspace->moved[2][i] =
        (coordinate->base + value - state->q[coordinate->at]) / workspace->step.h;
  }
}

/* The mean velocity is extrapolated, or else set to the velocity. */
static void guess(const strut_model *model, const strut_state *state, midpoint_workspace *workspace,
                  bool plain) {
  for (int32_t i = 0; i < model->length; i++)
    workspace->u[i] = workspace->known < 2 || plain
                          ? state->v[i]
                          : 2.0 * workspace->before[0][i] - workspace->before[1][i];
  for (int32_t i = 0; i < model->support_motion.count; i++)
    workspace->u[model->support_motion.item[i].at] = workspace->moved[2][i];
}

/* Forces over the step that ends at q1 with velocity u on average. */
static void evaluate(const strut_model *model, const strut_state *state,
                     midpoint_workspace *workspace) {
  for (int32_t i = 0; i < model->length; i++)
    workspace->q1[i] = state->q[i] + workspace->step.h * workspace->u[i];
  strut_discrete_gradient_forces(model, state, &workspace->step, workspace->q1, workspace->u);
  if (model->terms & STRUT_TERM_SUPPORT_MOTION)
    strut_support_motion_apply_mean(model, state, workspace->step.h, workspace->moved[0],
                                    workspace->moved[1], workspace->u);
}

/* Mean values of the internal states, by their rates half-way: a fixed point of the iteration. */
static bool correct_states(const strut_model *model, const strut_state *state,
                           midpoint_workspace *workspace) {
  const strut_feedback_table *feedback = &model->feedback;
  bool finite = true;
  workspace->states_settled = true;
  for (int32_t i = feedback->base; i < feedback->base + feedback->state_count; i++) {
    double next = state->v[i] + 0.5 * workspace->step.h * state->latest->force[i];
    double close = CLOSE * ROUNDING * (fabs(next) + fabs(state->v[i]));
    if (!(fabs(next - workspace->u[i]) <= close)) workspace->states_settled = false;
    finite = finite && isfinite(next);
    workspace->u[i] = next;
  }
  return finite;
}

/* Correction at u into x. False where there are no numbers. */
static bool correct(const strut_model *model, const strut_state *state,
                    midpoint_workspace *workspace, double *vector) {
  const strut_midpoint_matrix *matrix = &workspace->matrix;
  double h = workspace->step.h;
  evaluate(model, state, workspace);
  for (int32_t i = 0; i < model->length; i++) workspace->u[i] -= state->v[i];
  strut_midpoint_matrix_mass(matrix, workspace->u, vector);
  for (int32_t i = 0; i < model->length; i++) workspace->u[i] += state->v[i];
  bool finite = correct_states(model, state, workspace);
  for (int32_t i = 0; i < matrix->n; i++) {
    vector[i] = 0.5 * h * state->latest->force[matrix->coordinate[i]] - vector[i];
    finite = finite && isfinite(vector[i]);
  }
  return finite;
}

static double size_of(const strut_midpoint_matrix *matrix, const double *vector) {
  double most = 0.0;
  for (int32_t i = 0; i < matrix->n; i++) most = fmax(most, fabs(vector[i]));
  return most;
}

/* What rounding leaves of a correction [m/s]. */
static double rounding_of(const strut_model *model, const strut_state *state,
                          const midpoint_workspace *workspace) {
  double speed = 0.0, reach = 0.0, h = workspace->step.h;
  for (int32_t i = 0; i < 2 * model->node_count; i++) {
    speed = fmax(speed, fabs(workspace->u[i]));
    reach = fmax(reach, fabs(state->q[i]));
  }
  return ROUNDING * (speed + reach * fmin(1.0 / h, h * workspace->stiffest));
}

static bool renew(const strut_model *model, const strut_state *state, midpoint_workspace *workspace,
                  bool stiff) {
  workspace->factor_step = workspace->step.h;
  return strut_midpoint_matrix_update(model, &workspace->step, state->latest->rest, workspace->q1,
                                      workspace->held, stiff, &workspace->matrix);
}

/*
 * Newton's method from the guess in u. What turns with members is the tension of the step before, not
 * that of an iterate, in which a stiff member is far too long or short until the next one. Where
 * corrections grow although the factor is new, only a part of each is taken.
 */
static bool iterate(const strut_model *model, const strut_state *state,
                    midpoint_workspace *workspace, bool stiff) {
  double before = 0.0, part = 1.0;
  size_t bytes = (size_t)workspace->matrix.n * sizeof *workspace->x;
  for (int turn = 0; turn < MOST_TURNS; turn++) {
    if (!correct(model, state, workspace, workspace->x)) return false;
    memcpy(workspace->residual, workspace->x, bytes);
    bool missing = workspace->factor_step != workspace->step.h || (turn == 0 && stiff);
    bool fresh =
        missing || strut_midpoint_matrix_stale(model, &workspace->step, &workspace->matrix);
    if (fresh && !renew(model, state, workspace, stiff)) return false;
    strut_ldl_solve(workspace->matrix.factor, workspace->x);
    double size = size_of(&workspace->matrix, workspace->x),
           close = rounding_of(model, state, workspace);
    if (turn > 0 && size > SLOW * before && size > CLOSE * close) {
      if (size <= STALLED * close && size > 0.5 * before && workspace->states_settled) return true;
      if (!fresh && !renew(model, state, workspace, stiff)) return false;
      memcpy(workspace->x, workspace->residual, bytes);
      strut_ldl_solve(workspace->matrix.factor, workspace->x);
      size = size_of(&workspace->matrix, workspace->x);
      part = size > 2.0 * before ? fmax(0.5 * part, 1.0 / 64.0) : fmin(1.0, 2.0 * part);
    } else {
      part = 1.0;
    }
    if (!isfinite(size)) return false;
    for (int32_t i = 0; i < workspace->matrix.n; i++)
      workspace->u[workspace->matrix.coordinate[i]] += part * workspace->x[i];
    if (size <= CLOSE * close && workspace->states_settled) return true;
    before = size;
  }
  return false;
}

/* The node that is farthest from having a solution. */
static int32_t worst_node(const midpoint_workspace *workspace) {
  int32_t worst = 0;
  for (int32_t i = 0; i < workspace->matrix.n; i++)
    if (!(fabs(workspace->residual[i]) <= fabs(workspace->residual[worst]))) worst = i;
  return workspace->matrix.coordinate[worst] / 2;
}

/* Is there a solution? It is left in u, q1 and the powers. */
static bool solve(const strut_model *model, const strut_state *state,
                  midpoint_workspace *workspace) {
  if (workspace->matrix.n == 0) {
    guess(model, state, workspace, true);
    for (int turn = 0; turn < MOST_TURNS; turn++) {
      evaluate(model, state, workspace);
      if (!correct_states(model, state, workspace)) return false;
      if (workspace->states_settled) return true;
    }
    return false;
  }
  for (int attempt = 0; attempt < 2; attempt++) {
    guess(model, state, workspace, attempt > 0);
    if (iterate(model, state, workspace, attempt > 0)) return true;
    workspace->factor_step = 0.0;
  }
  return false;
}

static void finish(const strut_model *model, strut_state *state, midpoint_workspace *workspace) {
  double h = workspace->step.h, *oldest = workspace->before[1];
  for (int32_t i = 0; i < workspace->matrix.n; i++) {
    int32_t at = workspace->matrix.coordinate[i];
    state->q[at] += h * workspace->u[at];
    state->v[at] = 2.0 * workspace->u[at] - state->v[at];
  }
  const strut_feedback_table *feedback = &model->feedback;
  for (int32_t at = feedback->base; at < feedback->base + feedback->state_count; at++) {
    state->q[at] += h * workspace->u[at];
    state->v[at] = 2.0 * workspace->u[at] - state->v[at];
  }
  if (model->terms & STRUT_TERM_SUPPORT_MOTION)
    strut_support_motion_place(model, state, workspace->step.begin + h, state->q, state->v);
  for (int p = 0; p < STRUT_POWER_COUNT && state->balance; p++)
    state->work[p] += h * state->latest->power[p];
  strut_elements_keep_turns(model, state);
  memcpy(workspace->held, workspace->step.tension,
         (size_t)model->members.count * sizeof *workspace->held);
  workspace->before[1] = workspace->before[0], workspace->before[0] = workspace->u,
  workspace->u = oldest;
  if (workspace->known < 2) workspace->known++;
}

/* A step, or where that has no solution its halves: cables may chase Newton's method round in circles. */
static bool take(const strut_model *model, strut_state *state, midpoint_workspace *workspace,
                 double begin, double h, int halvings) {
  strut_discrete_gradient_begin(model, state, state->q, begin, h, &workspace->step);
  move_supports(model, state, workspace);
  if (solve(model, state, workspace)) {
    finish(model, state, workspace);
    return true;
  }
  workspace->known = 0;
  if (halvings == 0) return false;
  bool done = take(model, state, workspace, begin, 0.5 * h, halvings - 1) &&
              take(model, state, workspace, begin + 0.5 * h, 0.5 * h, halvings - 1);
  workspace->known = 0; /* mean velocities of other steps */
  return done;
}

static void midpoint_advance(const strut_model *model, strut_state *state, void *workspace,
                             double dt, int64_t count) {
  midpoint_workspace *w = workspace;
  size_t bytes = (size_t)model->length * sizeof(double);
  if (w->factor_step < 0.0) midpoint_restart(model, state, w, dt);
  for (int64_t end = state->step + count; state->step < end && !state->trouble; state->step++) {
    memcpy(w->grid[0], state->q, bytes);
    memcpy(w->grid[1], state->v, bytes);
    if (take(model, state, w, (double)state->step * dt, dt, MOST_HALVINGS)) continue;
    state->trouble = STRUT_FAILURE_IMPLICIT;
    state->trouble_node = w->matrix.n ? worst_node(w) : 0;
    memcpy(state->q, w->grid[0], bytes);
    memcpy(state->v, w->grid[1], bytes);
    return;
  }
}

const strut_integrator strut_integrator_midpoint = {
    .name = "midpoint",
    .description = "implicit midpoint, fixed step, for stiff members without ground",
    .order = 2,
    .lag = 1.0 / 12.0,
    .evaluations = 4, /* about: as many as Newton's method takes */
    .region = STRUT_REGION_ALL,
    .role = STRUT_ROLE_STIFF,
    .no_ground = true,
    .no_memory = true,
    .no_sliding_masses = true,
    .solves = true,
    .create = midpoint_create,
    .restart = midpoint_restart,
    .advance = midpoint_advance,
};
