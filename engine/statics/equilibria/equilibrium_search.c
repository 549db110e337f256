/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/equilibria/equilibria_parts.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/forces/energy.h"
#include "engine/forces/forces.h"
#include "engine/integrate/integrator.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/model/pose.h"
#include "engine/statics/search/critical.h"

/* Quantities of one candidate. */

/* Depth and pull below these are rounding: in model sizes, in weights. */
static const double DEEP = 1e-9, PULL = 1e-9;

int32_t strut_equilibrium_search_add(strut_equilibrium_search *h) {
  if (h->count == h->room) {
    size_t room = h->room ? 2 * h->room : 32;
    strut_candidate_equilibrium *finds = strut_arena_allocate(&h->out->arena, room, sizeof *finds);
    if (!finds) return -1;
    if (h->count) memcpy(finds, h->candidates, h->count * sizeof *finds);
    h->candidates = finds;
    h->room = room;
  }
  h->candidates[h->count] = (strut_candidate_equilibrium){.state = -1};
  h->candidates[h->count].e.tips_over = h->candidates[h->count].e.ends_as = -1;
  h->candidates[h->count].e.overlap = h->candidates[h->count].e.through = -1;
  return (int32_t)h->count++;
}

static bool copy_point(strut_equilibrium_search *h, const strut_critical_point *from,
                       strut_critical_point *to) {
  strut_arena *arena = &h->out->arena;
  size_t length = (size_t)h->model->length;
  *to = *from;
  to->q = strut_arena_copy(arena, from->q, length, sizeof(double));
  to->softest = strut_arena_copy(arena, from->softest, length, sizeof(double));
  to->eigenvalues =
      strut_arena_copy(arena, from->eigenvalues, (size_t)from->eigenvalue_count, sizeof(double));
  return to->q && to->softest && to->eigenvalues;
}

static void measure_members(const strut_model *model, const double *q, double *force) {
  const strut_member_table *t = &model->members;
  for (int32_t j = 0; j < t->count; j++)
    force[j] = strut_member_elastic_tension(model, t->rest, j, q);
}

/* Reactions on held coordinates: minus the net force there. */
static bool measure_reactions(strut_equilibrium_search *h, const strut_potential *potential,
                              const uint8_t *held, strut_candidate_equilibrium *f) {
  double *force = strut_allocate((size_t)h->model->length, sizeof *force);
  if (!force) return false;
  strut_potential_force(potential, f->e.point.q, force);
  for (int32_t i = 0; i < h->model->node_count; i++)
    for (int c = 0; c < 2; c++) {
      int32_t at = 2 * i + c;
      if (!h->model->fixed[at] && !(held && held[at])) continue;
      f->e.reaction[i][c] = 0.0 - force[at];
      bool by_ground = held && held[at] && c == 1 && !h->model->fixed[at];
      if (by_ground && -force[at] < -PULL * potential->force_scale) f->pulls = true;
    }
  strut_release(force);
  return true;
}

static void find_nodes_below(const strut_equilibrium_search *h, const uint8_t *held,
                             strut_equilibrium *e) {
  const strut_contact_table *c = &h->model->contacts;
  for (int32_t i = 0; i < c->count && h->on_ground; i++) {
    uint32_t at = c->at[i];
    double gap = strut_contact_gap(c, i, e->point.q);
    if (held && !held[at + 1] && gap < -DEEP * h->model->size) e->below[at / 2] = 1;
  }
}

strut_status strut_equilibrium_search_fill(strut_equilibrium_search *h,
                                           strut_candidate_equilibrium *find,
                                           const strut_potential *potential, const uint8_t *held,
                                           const strut_node_set *set,
                                           const strut_critical_point *point) {
  strut_arena *arena = &h->out->arena;
  strut_equilibrium *e = &find->e;
  size_t nodes = (size_t)h->model->node_count;
  e->supports = set;
  e->reaction = strut_arena_allocate(arena, nodes, sizeof *e->reaction);
  e->below = strut_arena_allocate(arena, nodes, 1);
  e->member_force = strut_arena_allocate(arena, (size_t)h->model->members.count, sizeof(double));
  if (!e->reaction || !e->below || !e->member_force || !copy_point(h, point, &e->point))
    return strut_no_memory(h->error, "");
  bool placed = 2 * h->model->node_count - potential->n <=
                3; /* the shape may be mirrored as a whole: orient it */
  if ((placed && strut_orient_shape(h->model, held, e->point.q, e->point.softest)) ||
      !measure_reactions(h, potential, held, find))
    return strut_no_memory(h->error, "");
  e->energy = strut_potential_energy(potential, e->point.q);
  measure_members(h->model, e->point.q, e->member_force);
  find_nodes_below(h, held, e);
  if (!set) return strut_equilibrium_search_contacts(h, e->point.q, e);
  e->contacts = set->node;
  e->contact_count = (int32_t)set->count;
  e->normal = strut_arena_allocate(arena, set->count, sizeof *e->normal);
  if (!e->normal) return strut_no_memory(h->error, "");
  for (size_t i = 0; i < set->count; i++) e->normal[i] = e->reaction[set->node[i]][1];
  return STRUT_OK;
}

bool strut_closed_contacts(const strut_model *model, const double *q, double least,
                           strut_arena *arena, strut_node_pushes *pushes) {
  const strut_contact_table *c = &model->contacts;
  pushes->count = 0;
  pushes->node = strut_arena_allocate(arena, (size_t)c->count, sizeof *pushes->node);
  pushes->normal = strut_arena_allocate(arena, (size_t)c->count, sizeof *pushes->normal);
  if (!pushes->node || !pushes->normal) return false;
  for (int32_t i = 0; i < c->count; i++) {
    double normal = -c->entry[i].stiffness * strut_contact_gap(c, i, q);
    if (!(normal > least)) continue;
    bool again = pushes->count && pushes->node[pushes->count - 1] == c->entry[i].node;
    if (!again) pushes->node[pushes->count++] = c->entry[i].node;
    pushes->normal[pushes->count - 1] += normal;
  }
  return true;
}

strut_status strut_equilibrium_search_contacts(strut_equilibrium_search *h, const double *q,
                                               strut_equilibrium *e) {
  strut_node_pushes pushes = {0};
  double least = h->on_ground ? PULL * h->potential->force_scale : HUGE_VAL;
  if (!strut_closed_contacts(h->model, q, least, &h->out->arena, &pushes))
    return strut_no_memory(h->error, "");
  e->contacts = pushes.node, e->normal = pushes.normal, e->contact_count = pushes.count;
  return STRUT_OK;
}

/* Follows equilibria on static supports after the ground replaces the supports. */

/* A candidate stands if no node moves farther than this, in model sizes. */
static const double AS_IT_STOOD = 0.02;

static bool is_followed(const strut_equilibrium_search *h, const strut_candidate_equilibrium *f) {
  return f->e.supports && f->e.outcome == STRUT_OUTCOME_STANDS &&
         h->instability == STRUT_INSTABILITY_NONE;
}

static strut_outcome judge_on_supports(const strut_equilibrium_search *h,
                                       const strut_candidate_equilibrium *f) {
  const strut_equilibrium *e = &f->e;
  if (e->point.label == STRUT_FLOPPY) return STRUT_OUTCOME_FLOPPY;
  if (e->point.label != STRUT_STABLE) return STRUT_OUTCOME_UNSTABLE;
  for (int32_t i = 0; i < h->model->node_count; i++)
    if (e->below[i]) return STRUT_OUTCOME_BELOW_GROUND;
  if (h->held_by_friction && !f->pulls) return STRUT_OUTCOME_STANDS;
  return h->instability == STRUT_INSTABILITY_NONE ? STRUT_OUTCOME_STANDS : STRUT_OUTCOME_NO_REST;
}

/* A saddle on supports that only push is one on the ground too, up to the ground's compliance. */
static bool is_pass(const strut_equilibrium_search *h, const strut_candidate_equilibrium *f) {
  bool under = false;
  for (int32_t i = 0; i < h->model->node_count; i++) under = under || f->e.below[i];
  return f->e.supports && f->e.point.negative == 1 && !f->pulls && !under;
}

/*
 * Searches the real ground, starting from the minimum below each candidate that may stand and from
 * the saddles found on supports.
 */
static strut_status explore_landscape(strut_equilibrium_search *h) {
  const strut_equilibria_options *o = h->options;
  size_t length = (size_t)h->model->length, extras = 0, hints = 0;
  strut_arena scratch = {0};
  const double **extra = strut_arena_allocate(&scratch, 2 * h->count + 1, sizeof *extra);
  const double **hint = strut_arena_allocate(&scratch, h->count + 1, sizeof *hint);
  strut_status status = extra && hint ? STRUT_OK : STRUT_NO_MEMORY;
  for (size_t i = 0; i < h->count && !status; i++)
    if (is_pass(h, &h->candidates[i])) hint[hints++] = h->candidates[i].e.point.q;
  for (size_t i = 0; i < h->count && !status; i++) {
    strut_equilibrium *e = &h->candidates[i].e;
    if (!is_followed(h, &h->candidates[i]) && !e->rest) continue;
    double *q = strut_arena_allocate(&scratch, length, sizeof *q);
    if (!q) status = STRUT_NO_MEMORY;
    if (status) break;
    memcpy(q, e->point.q, length * sizeof *q);
    strut_relaxer_quench(h->relaxer, q);
    extra[extras++] = q;
    if (e->rest) extra[extras++] = e->rest;
  }
  if (status) strut_fail(h->error, status, "out of memory");
  strut_critical_effort effort = {.interrupt = o->interrupt,
                                  .starts = o->starts ? o->starts : h->experiment->search.starts,
                                  .seed = h->out->seed,
                                  .searches = (int32_t)h->supports.count + 1,
                                  .saddles = !o->standing_only,
                                  .extra_count = extras,
                                  .extra = extra,
                                  .hint_count = hints,
                                  .hint = hint};
  if (h->explored) strut_landscape_free(&h->landscape);
  h->explored = true;
  if (!status) status = strut_landscape_create(h->potential, &effort, &h->landscape, h->error);
  strut_arena_free(&scratch);
  return status;
}

bool strut_equilibrium_search_stands(const strut_equilibrium_search *h,
                                     const strut_candidate_equilibrium *f, const double *rest) {
  const strut_node_set *set = f->e.supports;
  double moved = strut_shape_distance(h->model, f->e.point.q, rest, false, NULL);
  for (size_t i = 0; i < set->count; i++) {
    bool touches = false;
    for (int32_t k = 0; k < f->e.contact_count; k++)
      touches = touches || f->e.contacts[k] == set->node[i];
    if (!touches) return false;
  }
  return moved < AS_IT_STOOD * h->model->size;
}

/*
 * The support with the largest push while another pulls: the structure tips over there. -1: none.
 */
static int32_t turning_node(const strut_candidate_equilibrium *f) {
  int32_t most = -1;
  for (size_t i = 0; i < f->e.supports->count && f->pulls; i++) {
    int32_t node = f->e.supports->node[i];
    if (f->e.reaction[node][1] > 0 && (most < 0 || f->e.reaction[node][1] > f->e.reaction[most][1]))
      most = node;
  }
  return most;
}

static strut_status follow_candidate(strut_equilibrium_search *h, strut_candidate_equilibrium *f) {
  strut_equilibrium *e = &f->e;
  size_t length = (size_t)h->model->length;
  strut_relaxed relaxed;
  double *q = strut_arena_allocate(&h->out->arena, length, sizeof *q);
  if (!q) return strut_no_memory(h->error, "");
  memcpy(q, e->point.q, length * sizeof *q);
  strut_status status = strut_relax(h->relaxer, q, strut_landscape_pass, &h->landscape,
                                    h->options->interrupt, &relaxed, h->error);
  if (status) return status;
  e->tips_over = turning_node(f);
  if (relaxed.end != STRUT_RELAXED_RESTS) {
    e->outcome = STRUT_OUTCOME_NO_REST;
    return STRUT_OK;
  }
  e->rest = q;
  e->rest_energy = strut_potential_energy(h->potential, q);
  e->rest_residual = relaxed.residual;
  f->state = strut_landscape_find(&h->landscape, q);
  if ((status = strut_equilibrium_search_contacts(h, q, e))) return status;
  e->outcome = strut_equilibrium_search_stands(h, f, q) ? STRUT_OUTCOME_STANDS : STRUT_OUTCOME_TIPS;
  return STRUT_OK;
}

strut_status strut_equilibrium_search_follow(strut_equilibrium_search *h) {
  bool any = false, lost = false;
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < h->count; i++)
    h->candidates[i].e.outcome = judge_on_supports(h, &h->candidates[i]);
  for (size_t i = 0; i < h->count && h->held_by_friction && !status; i++)
    if (h->candidates[i].e.outcome == STRUT_OUTCOME_STANDS)
      status = strut_equilibrium_search_hold(h, &h->candidates[i]);
  if (h->instability != STRUT_INSTABILITY_NONE) return status;
  if ((status = explore_landscape(h))) return status;
  for (size_t i = 0; i < h->count && !status; i++) {
    if (!is_followed(h, &h->candidates[i])) continue;
    status = follow_candidate(h, &h->candidates[i]);
    any = any || h->candidates[i].e.rest;
    lost = lost || (h->candidates[i].e.rest && h->candidates[i].state < 0);
  }
  if (status || !any || !lost) return status;
  /* one came to rest in a minimum not found before: search again from there */
  if ((status = explore_landscape(h))) return status;
  for (size_t i = 0; i < h->count; i++)
    if (h->candidates[i].e.rest)
      h->candidates[i].state = strut_landscape_find(&h->landscape, h->candidates[i].e.rest);
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
/* The share of the stable step; folded shapes are stiffer than the start that the limit is for. */
static const double CAREFUL = 0.5;
static const double GROWN = 1e-6;
enum { HALVINGS = 6 };

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

static bool loses_energy(const strut_model *model) {
  strut_force force = {.damping = model->mass_damping};
  for (int32_t i = 0; i < strut_force_count(model, true) && !(force.damping > 0); i++)
    strut_force_begin(model, i, &force);
  return force.damping > 0;
}

/* Creates state and integrator, unless the model cannot be simulated. */
static strut_status prepare_motion(strut_relaxer *r, strut_error *error) {
  strut_step_limit limit;
  if (!r->model->mass || !loses_energy(r->model) || r->potential->n > STRUT_DENSE_STATICS)
    return STRUT_OK;
  strut_status status = strut_step_limit_estimate(r->model, &limit, error);
  if (status) return status;
  if (!isfinite(limit.limit)) return STRUT_OK;
  r->step = CAREFUL * limit.limit;
  r->method = strut_integrator_for(STRUT_ROLE_PLAIN);
  if ((status = strut_state_create(r->model, &r->state, error))) return status;
  const strut_integrator_settings settings = {.step = r->step};
  r->workspace = r->method->create(r->model, r->state, &settings);
  return r->workspace ? STRUT_OK : strut_no_memory(error, "");
}

strut_status strut_relaxer_create(const strut_potential *potential, double limit,
                                  strut_relaxer **result, strut_error *error) {
  assert(limit > 0.0);
  strut_relaxer *r = *result = strut_allocate(1, sizeof *r);
  if (!r) return strut_no_memory(error, "");
  size_t length = (size_t)potential->model->length;
  r->potential = potential;
  r->limit = limit;
  r->model = potential->model;
  r->quenched = strut_arena_allocate(&r->arena, length, sizeof(double));
  r->last = strut_arena_allocate(&r->arena, length, sizeof(double));
  r->start = strut_arena_allocate(&r->arena, length, sizeof(double));
  strut_status status = r->quenched && r->last && r->start
                            ? strut_minimiser_create(potential, &r->minimiser, error)
                            : strut_no_memory(error, "");
  if (!status) status = prepare_motion(r, error);
  if (status) {
    strut_relaxer_free(r);
    *result = NULL;
  }
  return status;
}

void strut_relaxer_free(strut_relaxer *r) {
  if (!r) return;
  strut_state_free(r->state);
  strut_minimiser_free(r->minimiser);
  strut_arena_free(&r->arena);
  strut_release(r);
}

bool strut_relaxer_simulates(const strut_relaxer *r) { return r->state != NULL; }

strut_descent strut_relaxer_quench(strut_relaxer *r, double *q) {
  return strut_minimise(r->minimiser, q, 0.0);
}

static bool free_along_x(const strut_model *model) {
  if (model->contacts.count && !strut_contacts_are_level(&model->contacts)) return false;
  for (int32_t i = 0; i < model->node_count; i++)
    if (model->fixed[2 * i]) return false;
  return true;
}

static double centre_x(const strut_model *model, const double *q) {
  double sum = 0.0, all = 0.0;
  for (int32_t i = 0; i < model->node_count; i++) {
    sum += model->weight[i] * q[2 * i];
    all += model->weight[i];
  }
  return all > 0 ? sum / all : 0.0;
}

/* No force acts along the ground, so the centre of mass stays; Newton's method knows no masses. */
static void restore_centre(const strut_model *model, double x, double *q) {
  if (!free_along_x(model)) return;
  double back = x - centre_x(model, q);
  for (int32_t i = 0; i < model->node_count; i++) q[2 * i] += back;
}

static double total_energy(const strut_relaxer *r) {
  return strut_potential_value(r->potential, r->state->q) +
         strut_energy_kinetic(r->model, r->state->v);
}

static bool has_escaped(const strut_model *model, const double *start, const double *q) {
  double bound = GONE * (model->size > 0 ? model->size : 1.0);
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    if (!(fabs(q[i] - start[i]) <= bound)) return true;
  return false;
}

/* Evidence that the minimum below the present shape is the only one left within reach. */
typedef struct verdict {
  double excess; /* at the first look [J] */
  int agreed;
} verdict;

static bool is_decided(strut_relaxer *r, double energy, const double *q, strut_pass_of passes,
                       const void *context, verdict *v) {
  size_t bytes = (size_t)r->model->length * sizeof(double);
  memcpy(r->quenched, q, bytes);
  strut_descent descent = strut_relaxer_quench(r, r->quenched);
  if (descent.end != STRUT_DESCENT_REACHED) {
    v->agreed = 0;
    return false;
  }
  if (passes && energy < passes(context, r->quenched)) return true;
  double excess = energy - strut_potential_value_near(r->potential, r->quenched, q);
  if (v->excess < 0) v->excess = excess;
  bool same = v->agreed && strut_shape_distance(r->model, r->last, r->quenched, false, NULL) <
                               SAME * r->model->size;
  v->agreed = same ? v->agreed + 1 : 1;
  memcpy(r->last, r->quenched, bytes);
  return v->agreed >= AGREE && excess <= DIED * v->excess;
}

typedef enum outcome { DECIDED, LEFT, TIME_OUT, UNSTABLE_STEP, STOPPED } outcome;

static outcome simulate(strut_relaxer *r, double step, strut_pass_of passes, const void *context,
                        const strut_flag *interrupt) {
  size_t bytes = (size_t)r->model->length * sizeof(double);
  verdict v = {-1.0, 0};
  strut_state_reset(r->model, r->state);
  memcpy(r->state->q, r->start, bytes);
  memset(r->state->v, 0, bytes);
  double first = total_energy(r), look = (double)FIRST_LOOK;
  if (is_decided(r, first, r->state->q, passes, context, &v)) return DECIDED;
  while (r->state->step < MOST_STEPS && (double)r->state->step * step < r->limit) {
    if (interrupt && *interrupt) return STOPPED;
    r->method->advance(r->model, r->state, r->workspace, step, (int64_t)look);
    double energy = total_energy(r);
    /* Nothing feeds the motion: an energy above the first comes from the step. */
    if (!isfinite(energy) || energy > first + GROWN * fabs(first)) return UNSTABLE_STEP;
    if (has_escaped(r->model, r->start, r->state->q)) return LEFT;
    if (is_decided(r, energy, r->state->q, passes, context, &v)) return DECIDED;
    look = fmin(1.1 * look, (double)LAST_LOOK);
  }
  return v.agreed >= AGREE ? DECIDED : TIME_OUT;
}

/* Largest acceleration at rest: the paper's break-off criterion with all speeds 0. */
static void judge_rest(strut_relaxer *r, const double *q, strut_relaxed *relaxed) {
  const strut_model *model = r->model;
  if (!r->state) return;
  size_t bytes = (size_t)model->length * sizeof(double);
  memset(r->state->v, 0, bytes);
  memset(r->last, 0, bytes);
  strut_forces_acceleration(model, r->state, 0.0, q, r->state->v, r->last);
  relaxed->acceleration = strut_largest_magnitude(r->last, 2 * model->node_count);
}

/* Minimises from q, with the centre of mass moved to x. */
static void quench_to_rest(strut_relaxer *r, double x, double *q, strut_relaxed *relaxed) {
  strut_descent descent = strut_relaxer_quench(r, q);
  relaxed->end = descent.end == STRUT_DESCENT_REACHED   ? STRUT_RELAXED_RESTS
                 : descent.end == STRUT_DESCENT_RUNAWAY ? STRUT_RELAXED_LEAVES
                                                        : STRUT_RELAXED_MOVES;
  restore_centre(r->model, x, q);
  relaxed->residual = descent.residual;
  if (relaxed->end == STRUT_RELAXED_RESTS) judge_rest(r, q, relaxed);
}

void strut_relax_down(strut_relaxer *r, double *q, strut_relaxed *relaxed) {
  *relaxed = (strut_relaxed){.end = STRUT_RELAXED_RESTS};
  quench_to_rest(r, centre_x(r->model, q), q, relaxed);
}

strut_status strut_relax(strut_relaxer *r, double *q, strut_pass_of passes, const void *context,
                         const strut_flag *interrupt, strut_relaxed *relaxed, strut_error *error) {
  size_t bytes = (size_t)r->model->length * sizeof(double);
  outcome end = DECIDED;
  *relaxed = (strut_relaxed){.end = STRUT_RELAXED_RESTS};
  memcpy(r->start, q, bytes);
  strut_minimiser_watch(r->minimiser, interrupt);
  if (r->state) {
    double step = r->step;
    end = simulate(r, step, passes, context, interrupt);
    for (int i = 0; end == UNSTABLE_STEP && i < HALVINGS; i++)
      end = simulate(r, step *= 0.5, passes, context, interrupt);
    relaxed->time = (double)r->state->step * step;
    relaxed->simulated = r->state->step > 0;
    memcpy(q, end == DECIDED ? r->quenched : r->state->q, bytes);
  }
  if (end == STOPPED)
    return strut_fail(error, STRUT_INTERRUPTED, "interrupted while coming to rest");
  if (end == DECIDED)
    quench_to_rest(r, centre_x(r->model, r->start), q, relaxed);
  else
    relaxed->end = end == LEFT ? STRUT_RELAXED_LEAVES : STRUT_RELAXED_MOVES;
  return STRUT_OK;
}
