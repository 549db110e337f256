/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/statics/equilibria/equilibria_parts.h"

#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/forces/forces.h"
#include "engine/integrate/integrator.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/model/pose.h"
#include "engine/statics/algebra.h"

/* Quantities of one candidate. */

/* Depth and pull below these are rounding: in model sizes, in weights. */
static const double DEEP = 1e-9, PULL = 1e-9;

int32_t strut_equilibrium_search_add(strut_equilibrium_search *search) {
  if (search->count == search->room) {
    size_t room = search->room ? 2 * search->room : 32;
    strut_candidate_equilibrium *finds;
    if (!STRUT_ALLOCATE(&search->out->arena, STRUT_NEW(finds, room))) return -1;
    if (search->count) memcpy(finds, search->candidates, search->count * sizeof *finds);
    search->candidates = finds;
    search->room = room;
  }
  search->candidates[search->count] = (strut_candidate_equilibrium){.state = -1};
  search->candidates[search->count].e.tips_over = search->candidates[search->count].e.ends_as = -1;
  search->candidates[search->count].e.overlap = search->candidates[search->count].e.through = -1;
  return (int32_t)search->count++;
}

static bool copy_point(strut_equilibrium_search *search, const strut_critical_point *from,
                       strut_critical_point *to) {
  strut_arena *arena = &search->out->arena;
  size_t length = (size_t)search->model->length;
  *to = *from;
  return STRUT_DUPLICATE(arena, STRUT_NEW(to->q, length), STRUT_NEW(to->softest, length),
                         STRUT_NEW(to->eigenvalues, from->eigenvalue_count));
}

static void measure_members(const strut_model *model, const double *positions, double *force) {
  const strut_member_table *members = &model->members;
  for (int32_t j = 0; j < members->count; j++)
    force[j] = strut_member_elastic_tension(model, members->rest, j, positions);
}

/* Reactions on held coordinates: minus the net force there. */
static bool measure_reactions(strut_equilibrium_search *search, const strut_potential *potential,
                              const uint8_t *held, strut_candidate_equilibrium *candidate) {
  double *force = strut_allocate((size_t)search->model->length, sizeof *force);
  if (!force) return false;
  strut_potential_force(potential, candidate->e.point.q, force);
  for (int32_t i = 0; i < search->model->node_count; i++)
    for (int c = 0; c < 2; c++) {
      int32_t at = 2 * i + c;
      if (!search->model->fixed[at] && !(held && held[at])) continue;
      candidate->e.reaction[i][c] = 0.0 - force[at];
      bool by_ground = held && held[at] && c == 1 && !search->model->fixed[at];
      if (by_ground && -force[at] < -PULL * potential->force_scale) candidate->pulls = true;
    }
  strut_release(force);
  return true;
}

static void find_nodes_below(const strut_equilibrium_search *search, const uint8_t *held,
                             strut_equilibrium *equilibrium) {
  const strut_contact_table *contacts = &search->model->contacts;
  for (int32_t i = 0; i < contacts->count && search->on_ground; i++) {
    uint32_t at = contacts->at[i];
    double gap = strut_contact_gap(contacts, i, equilibrium->point.q);
    if (held && !held[at + 1] && gap < -DEEP * search->model->size) equilibrium->below[at / 2] = 1;
  }
}

strut_status strut_equilibrium_search_fill(strut_equilibrium_search *search,
                                           strut_candidate_equilibrium *find,
                                           const strut_potential *potential, const uint8_t *held,
                                           const strut_node_set *set,
                                           const strut_critical_point *point) {
  strut_arena *arena = &search->out->arena;
  strut_equilibrium *equilibrium = &find->e;
  size_t nodes = (size_t)search->model->node_count;
  equilibrium->supports = set;
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(equilibrium->reaction, nodes),
                      STRUT_NEW(equilibrium->below, nodes),
                      STRUT_NEW(equilibrium->member_force, search->model->members.count)) ||
      !copy_point(search, point, &equilibrium->point))
    return strut_no_memory(search->error, "");
  bool placed = 2 * search->model->node_count - potential->n <= 3; /* may be mirrored whole */
  if ((placed &&
       strut_orient_shape(search->model, held, equilibrium->point.q, equilibrium->point.softest)) ||
      !measure_reactions(search, potential, held, find))
    return strut_no_memory(search->error, "");
  equilibrium->energy = strut_potential_energy(potential, equilibrium->point.q);
  measure_members(search->model, equilibrium->point.q, equilibrium->member_force);
  find_nodes_below(search, held, equilibrium);
  if (!set) return strut_equilibrium_search_contacts(search, equilibrium->point.q, equilibrium);
  equilibrium->contacts = set->node;
  equilibrium->contact_count = (int32_t)set->count;
  equilibrium->normal = strut_arena_allocate(arena, set->count, sizeof *equilibrium->normal);
  if (!equilibrium->normal) return strut_no_memory(search->error, "");
  for (size_t i = 0; i < set->count; i++)
    equilibrium->normal[i] = equilibrium->reaction[set->node[i]][1];
  return STRUT_OK;
}

bool strut_closed_contacts(const strut_model *model, const double *positions, double least,
                           strut_arena *arena, strut_node_pushes *pushes) {
  const strut_contact_table *contacts = &model->contacts;
  pushes->count = 0;
  pushes->node = strut_arena_allocate(arena, (size_t)contacts->count, sizeof *pushes->node);
  pushes->normal = strut_arena_allocate(arena, (size_t)contacts->count, sizeof *pushes->normal);
  if (!pushes->node || !pushes->normal) return false;
  for (int32_t i = 0; i < contacts->count; i++) {
    double normal = -contacts->entry[i].stiffness * strut_contact_gap(contacts, i, positions);
    if (!(normal > least)) continue;
    bool again = pushes->count && pushes->node[pushes->count - 1] == contacts->entry[i].node;
    if (!again) pushes->node[pushes->count++] = contacts->entry[i].node;
    pushes->normal[pushes->count - 1] += normal;
  }
  return true;
}

strut_status strut_equilibrium_search_contacts(strut_equilibrium_search *search,
                                               const double *positions,
                                               strut_equilibrium *equilibrium) {
  strut_node_pushes pushes = {0};
  double least = search->on_ground ? PULL * search->potential->force_scale : HUGE_VAL;
  if (!strut_closed_contacts(search->model, positions, least, &search->out->arena, &pushes))
    return strut_no_memory(search->error, "");
  equilibrium->contacts = pushes.node, equilibrium->normal = pushes.normal,
  equilibrium->contact_count = pushes.count;
  return STRUT_OK;
}

struct strut_relaxer {
  double limit; /* [s] */
  const strut_potential *potential;
  const strut_model *model;
  strut_minimiser *minimiser;
  strut_state *state; /* NULL: not simulated */
  const strut_integrator *method;
  void *workspace;
  double step;
  double *quenched, *last; /* (length) the minimum below the present shape, and the one before */
  double *start;           /* (length) */
  strut_arena arena;
};

/* Follows equilibria on static supports after the ground replaces the supports. */

/* A candidate stands if no node moves farther than this, in model sizes. */
static const double AS_IT_STOOD = 0.02;

static bool is_followed(const strut_equilibrium_search *search,
                        const strut_candidate_equilibrium *candidate) {
  return candidate->e.supports && candidate->e.outcome == STRUT_OUTCOME_STANDS &&
         search->instability == STRUT_INSTABILITY_NONE;
}

static strut_outcome judge_on_supports(const strut_equilibrium_search *search,
                                       const strut_candidate_equilibrium *candidate) {
  const strut_equilibrium *equilibrium = &candidate->e;
  if (equilibrium->point.label == STRUT_FLOPPY) return STRUT_OUTCOME_FLOPPY;
  if (equilibrium->point.label != STRUT_STABLE) return STRUT_OUTCOME_UNSTABLE;
  for (int32_t i = 0; i < search->model->node_count; i++)
    if (equilibrium->below[i]) return STRUT_OUTCOME_BELOW_GROUND;
  if (search->held_by_friction && !candidate->pulls) return STRUT_OUTCOME_STANDS;
  return search->instability == STRUT_INSTABILITY_NONE ? STRUT_OUTCOME_STANDS
                                                       : STRUT_OUTCOME_NO_REST;
}

/* A saddle on supports that only push is one on the ground too, up to the ground's compliance. */
static bool is_pass(const strut_equilibrium_search *search,
                    const strut_candidate_equilibrium *candidate) {
  bool under = false;
  for (int32_t i = 0; i < search->model->node_count; i++) under = under || candidate->e.below[i];
  return candidate->e.supports && candidate->e.point.negative == 1 && !candidate->pulls && !under;
}

/*
 * Searches the real ground, starting from the minimum below each candidate that may stand and from
 * the saddles found on supports.
 */
static strut_status explore_landscape(strut_equilibrium_search *search) {
  const strut_equilibria_options *options = search->options;
  size_t length = (size_t)search->model->length, extras = 0, hints = 0;
  strut_arena scratch = {0};
  const double **extra = strut_arena_allocate(&scratch, 2 * search->count + 1, sizeof *extra);
  const double **hint = strut_arena_allocate(&scratch, search->count + 1, sizeof *hint);
  strut_status status = extra && hint ? STRUT_OK : STRUT_NO_MEMORY;
  for (size_t i = 0; i < search->count && !status; i++)
    if (is_pass(search, &search->candidates[i])) hint[hints++] = search->candidates[i].e.point.q;
  for (size_t i = 0; i < search->count && !status; i++) {
    strut_equilibrium *equilibrium = &search->candidates[i].e;
    if (!is_followed(search, &search->candidates[i]) && !equilibrium->rest) continue;
    double *q = strut_arena_copy(&scratch, equilibrium->point.q, length, sizeof *q);
    if (!q) status = STRUT_NO_MEMORY;
    if (status) break;
    strut_minimise(search->relaxer->minimiser, q);
    extra[extras++] = q;
    if (equilibrium->rest) extra[extras++] = equilibrium->rest;
  }
  if (status) strut_fail(search->error, status, "out of memory");
  strut_critical_effort effort = {
      .interrupt = options->interrupt,
      .starts = options->starts ? options->starts : search->experiment->search.starts,
      .seed = search->out->seed,
      .searches = (int32_t)search->supports.count + 1,
      .saddles = !options->standing_only,
      .extra_count = extras,
      .extra = extra,
      .hint_count = hints,
      .hint = hint};
  if (search->explored) strut_landscape_free(&search->landscape);
  search->explored = true;
  if (!status)
    status = strut_landscape_create(search->potential, &effort, &search->landscape, search->error);
  strut_arena_free(&scratch);
  return status;
}

bool strut_equilibrium_search_stands(const strut_equilibrium_search *search,
                                     const strut_candidate_equilibrium *candidate,
                                     const double *rest) {
  const strut_node_set *set = candidate->e.supports;
  double moved = strut_shape_distance(search->model, candidate->e.point.q, rest, false, NULL);
  for (size_t i = 0; i < set->count; i++)
    if (!strut_is_listed(candidate->e.contacts, candidate->e.contact_count, set->node[i]))
      return false;
  return moved < AS_IT_STOOD * search->model->size;
}

/*
 * The support with the largest push while another pulls: the structure tips over there. -1: none.
 */
static int32_t turning_node(const strut_candidate_equilibrium *candidate) {
  int32_t most = -1;
  for (size_t i = 0; i < candidate->e.supports->count && candidate->pulls; i++) {
    int32_t node = candidate->e.supports->node[i];
    if (candidate->e.reaction[node][1] > 0 &&
        (most < 0 || candidate->e.reaction[node][1] > candidate->e.reaction[most][1]))
      most = node;
  }
  return most;
}

static strut_status follow_candidate(strut_equilibrium_search *search,
                                     strut_candidate_equilibrium *candidate) {
  strut_equilibrium *equilibrium = &candidate->e;
  strut_relaxed relaxed;
  double *q = strut_arena_copy(&search->out->arena, equilibrium->point.q,
                               (size_t)search->model->length, sizeof *q);
  if (!q) return strut_no_memory(search->error, "");
  strut_status status = strut_relax(search->relaxer, q, &search->landscape,
                                    search->options->interrupt, &relaxed, search->error);
  if (status) return status;
  equilibrium->tips_over = turning_node(candidate);
  if (relaxed.end != STRUT_RELAXED_RESTS) {
    equilibrium->outcome = STRUT_OUTCOME_NO_REST;
    return STRUT_OK;
  }
  equilibrium->rest = q;
  equilibrium->rest_energy = strut_potential_energy(search->potential, q);
  equilibrium->rest_residual = relaxed.residual;
  candidate->state = strut_landscape_find(&search->landscape, q);
  if ((status = strut_equilibrium_search_contacts(search, q, equilibrium))) return status;
  equilibrium->outcome = strut_equilibrium_search_stands(search, candidate, q)
                             ? STRUT_OUTCOME_STANDS
                             : STRUT_OUTCOME_TIPS;
  return STRUT_OK;
}

strut_status strut_equilibrium_search_follow(strut_equilibrium_search *search) {
  bool any = false, lost = false;
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < search->count; i++)
    search->candidates[i].e.outcome = judge_on_supports(search, &search->candidates[i]);
  for (size_t i = 0; i < search->count && search->held_by_friction && !status; i++)
    if (search->candidates[i].e.outcome == STRUT_OUTCOME_STANDS)
      status = strut_equilibrium_search_hold(search, &search->candidates[i]);
  if (search->instability != STRUT_INSTABILITY_NONE) return status;
  if ((status = explore_landscape(search))) return status;
  for (size_t i = 0; i < search->count && !status; i++) {
    if (!is_followed(search, &search->candidates[i])) continue;
    status = follow_candidate(search, &search->candidates[i]);
    any = any || search->candidates[i].e.rest;
    lost = lost || (search->candidates[i].e.rest && search->candidates[i].state < 0);
  }
  if (status || !any || !lost) return status;
  /* one came to rest in a minimum not found before: search again from there */
  if ((status = explore_landscape(search))) return status;
  for (size_t i = 0; i < search->count; i++)
    if (search->candidates[i].e.rest)
      search->candidates[i].state =
          strut_landscape_find(&search->landscape, search->candidates[i].e.rest);
  return STRUT_OK;
}

/* Simulated steps between two checks of the energy; they grow while nothing is decided. */
static const int64_t FIRST_LOOK = 128, LAST_LOOK = 8192;
/* Steps after which it counts as moving on, however short they are beside initial.settle.limit. */
static const int64_t MOST_STEPS = 10000000;
/* Quenches in a row that end in one place, and the share of the first excess energy still there. */
enum { AGREE = 5 };
static const double DIED = 1e-3;
/* Distances, in model sizes: two shapes are one; the structure has moved away. */
static const double SAME = 1e-5, GONE = 1e3;
/* A start nearer to its minimum is at rest up to the ground's compliance; likewise. */
static const double NEAR = 0.01;
/* The share of the stable step; folded shapes are stiffer than the start that the limit is for. */
static const double CAREFUL = 0.5;
static const double GROWN = 1e-6;
enum { HALVINGS = 6 };

static bool loses_energy(const strut_model *model) {
  strut_force force = {.damping = model->mass_damping};
  for (int32_t i = 0; i < strut_force_count(model, true) && !(force.damping > 0); i++)
    strut_force_begin(model, i, &force);
  return force.damping > 0;
}

/* Creates state and integrator, unless the model cannot be simulated. */
static strut_status prepare_motion(strut_relaxer *relaxer, strut_error *error) {
  strut_step_limit limit;
  if (!relaxer->model->mass || !loses_energy(relaxer->model) ||
      relaxer->potential->n > STRUT_DENSE_STATICS)
    return STRUT_OK;
  strut_status status = strut_step_limit_estimate(relaxer->model, &limit, error);
  if (status) return status;
  if (!isfinite(limit.limit)) return STRUT_OK;
  relaxer->step = CAREFUL * limit.limit;
  relaxer->method = strut_integrator_for(STRUT_ROLE_PLAIN);
  if ((status = strut_state_create(relaxer->model, &relaxer->state, error))) return status;
  const strut_integrator_settings settings = {.step = relaxer->step};
  relaxer->workspace = relaxer->method->create(relaxer->model, relaxer->state, &settings);
  return relaxer->workspace ? STRUT_OK : strut_no_memory(error, "");
}

strut_status strut_relaxer_create(const strut_potential *potential, double limit,
                                  strut_relaxer **result, strut_error *error) {
  assert(limit > 0.0);
  strut_relaxer *relaxer = *result = strut_allocate(1, sizeof *relaxer);
  if (!relaxer) return strut_no_memory(error, "");
  size_t length = (size_t)potential->model->length;
  relaxer->potential = potential;
  relaxer->limit = limit;
  relaxer->model = potential->model;
  bool good =
      STRUT_NUMBERS(&relaxer->arena, length, &relaxer->quenched, &relaxer->last, &relaxer->start);
  strut_status status =
      good ? strut_minimiser_create(potential, &relaxer->arena, &relaxer->minimiser, error)
           : strut_no_memory(error, "");
  if (!status) status = prepare_motion(relaxer, error);
  if (status) {
    strut_relaxer_free(relaxer);
    *result = NULL;
  }
  return status;
}

void strut_relaxer_free(strut_relaxer *relaxer) {
  if (!relaxer) return;
  strut_state_free(relaxer->state);
  strut_arena_free(&relaxer->arena);
  strut_release(relaxer);
}

static bool free_along_x(const strut_model *model) {
  if (model->contacts.count && !strut_contacts_are_level(&model->contacts)) return false;
  for (int32_t i = 0; i < model->node_count; i++)
    if (model->fixed[2 * i]) return false;
  return true;
}

static double centre_x(const strut_model *model, const double *positions) {
  double sum = 0.0, all = 0.0;
  for (int32_t i = 0; i < model->node_count; i++) {
    sum += model->weight[i] * positions[2 * i];
    all += model->weight[i];
  }
  return all > 0 ? sum / all : 0.0;
}

/* No force acts along the ground, so the centre of mass stays; Newton's method knows no masses. */
static void restore_centre(const strut_model *model, double x, double *positions) {
  if (!free_along_x(model)) return;
  double back = x - centre_x(model, positions);
  for (int32_t i = 0; i < model->node_count; i++) positions[2 * i] += back;
}

static double total_energy(const strut_relaxer *relaxer) {
  return strut_potential_value(relaxer->potential, relaxer->state->q) +
         strut_energy_kinetic(relaxer->model, relaxer->state->v);
}

static bool has_escaped(const strut_model *model, const double *start, const double *positions) {
  double bound = GONE * (model->size > 0 ? model->size : 1.0);
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    if (!(fabs(positions[i] - start[i]) <= bound)) return true;
  return false;
}

/* Evidence that the minimum below the present shape is the only one left within reach. */
typedef struct verdict {
  double excess; /* at the first look [J] */
  int agreed;
} verdict;

static bool is_decided(strut_relaxer *relaxer, double energy, const strut_landscape *passes,
                       verdict *self) {
  const double *positions = relaxer->state->q;
  size_t bytes = (size_t)relaxer->model->length * sizeof(double);
  memcpy(relaxer->quenched, positions, bytes);
  strut_descent descent = strut_minimise(relaxer->minimiser, relaxer->quenched);
  if (descent.end != STRUT_DESCENT_REACHED) {
    self->agreed = 0;
    return false;
  }
  if (passes && energy < strut_landscape_pass(passes, relaxer->quenched)) return true;
  double excess =
      energy - strut_potential_value_near(relaxer->potential, relaxer->quenched, positions);
  if (self->excess < 0) self->excess = excess;
  bool same = self->agreed && strut_shape_distance(relaxer->model, relaxer->last, relaxer->quenched,
                                                   false, NULL) < SAME * relaxer->model->size;
  self->agreed = same ? self->agreed + 1 : 1;
  memcpy(relaxer->last, relaxer->quenched, bytes);
  return self->agreed >= AGREE && excess <= DIED * self->excess;
}

typedef enum outcome { DECIDED, LEFT, TIME_OUT, UNSTABLE_STEP, STOPPED } outcome;

static outcome simulate(strut_relaxer *relaxer, double step, const strut_landscape *passes,
                        const strut_flag *interrupt) {
  size_t bytes = (size_t)relaxer->model->length * sizeof(double);
  verdict v = {-1.0, 0};
  strut_state_reset(relaxer->model, relaxer->state);
  memcpy(relaxer->state->q, relaxer->start, bytes);
  memset(relaxer->state->v, 0, bytes);
  double first = total_energy(relaxer), look = (double)FIRST_LOOK;
  if (is_decided(relaxer, first, passes, &v)) return DECIDED;
  while (relaxer->state->step < MOST_STEPS &&
         (double)relaxer->state->step * step < relaxer->limit) {
    if (interrupt && *interrupt) return STOPPED;
    relaxer->method->advance(relaxer->model, relaxer->state, relaxer->workspace, step,
                             (int64_t)look);
    double energy = total_energy(relaxer);
    /* Nothing feeds the motion: an energy above the first comes from the step. */
    if (!isfinite(energy) || energy > first + GROWN * fabs(first)) return UNSTABLE_STEP;
    if (has_escaped(relaxer->model, relaxer->start, relaxer->state->q)) return LEFT;
    if (is_decided(relaxer, energy, passes, &v)) return DECIDED;
    look = fmin(1.1 * look, (double)LAST_LOOK);
  }
  return v.agreed >= AGREE ? DECIDED : TIME_OUT;
}

/* Minimises from q, with the centre of mass moved to x. */
static void quench_to_rest(strut_relaxer *relaxer, double x, double *positions,
                           strut_relaxed *relaxed) {
  strut_descent descent = strut_minimise(relaxer->minimiser, positions);
  relaxed->end = descent.end == STRUT_DESCENT_REACHED   ? STRUT_RELAXED_RESTS
                 : descent.end == STRUT_DESCENT_RUNAWAY ? STRUT_RELAXED_LEAVES
                                                        : STRUT_RELAXED_MOVES;
  restore_centre(relaxer->model, x, positions);
  relaxed->residual = descent.residual;
}

strut_status strut_relax(strut_relaxer *relaxer, double *positions, const strut_landscape *passes,
                         const strut_flag *interrupt, strut_relaxed *relaxed, strut_error *error) {
  size_t bytes = (size_t)relaxer->model->length * sizeof(double);
  outcome end = DECIDED;
  *relaxed = (strut_relaxed){.end = STRUT_RELAXED_RESTS};
  memcpy(relaxer->start, positions, bytes);
  strut_minimiser_watch(relaxer->minimiser, interrupt);
  if (relaxer->state) {
    double step = relaxer->step;
    end = simulate(relaxer, step, passes, interrupt);
    for (int i = 0; end == UNSTABLE_STEP && i < HALVINGS; i++)
      end = simulate(relaxer, step *= 0.5, passes, interrupt);
    memcpy(positions, end == DECIDED ? relaxer->quenched : relaxer->state->q, bytes);
  }
  if (end == STOPPED)
    return strut_fail(error, STRUT_INTERRUPTED, "interrupted while coming to rest");
  if (end == DECIDED)
    quench_to_rest(relaxer, centre_x(relaxer->model, relaxer->start), positions, relaxed);
  else
    relaxed->end = end == LEFT ? STRUT_RELAXED_LEAVES : STRUT_RELAXED_MOVES;
  return STRUT_OK;
}

strut_status strut_relax_nearby(strut_relaxer *relaxer, double *positions,
                                const strut_flag *interrupt, strut_relaxed *relaxed,
                                strut_error *error) {
  const strut_model *model = relaxer->model;
  size_t bytes = (size_t)model->length * sizeof *positions;
  memcpy(relaxer->start, positions, bytes);
  quench_to_rest(relaxer, centre_x(model, positions), positions, relaxed);
  bool close =
      relaxed->end == STRUT_RELAXED_RESTS &&
      strut_shape_distance(model, relaxer->start, positions, false, NULL) < NEAR * model->size;
  if (close || !relaxer->state) return STRUT_OK;
  memcpy(positions, relaxer->start, bytes);
  return strut_relax(relaxer, positions, NULL, interrupt, relaxed, error);
}
