/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/equilibria/equilibrium_search.h"

#include <math.h>
#include <string.h>

#include "engine/forces/elements.h"
#include "engine/model/pose.h"
#include "engine/statics/equilibria/naming.h"

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

static double *copy_numbers(strut_arena *arena, const double *from, size_t count) {
  double *copy = strut_arena_allocate(arena, count, sizeof *copy);
  if (copy && from && count) memcpy(copy, from, count * sizeof *copy);
  return copy;
}

static bool copy_point(strut_equilibrium_search *h, const strut_critical_point *from,
                       strut_critical_point *to) {
  strut_arena *arena = &h->out->arena;
  size_t length = (size_t)h->model->length;
  *to = *from;
  to->q = copy_numbers(arena, from->q, length);
  to->softest = copy_numbers(arena, from->softest, length);
  to->eigenvalues = copy_numbers(arena, from->eigenvalues, (size_t)from->eigenvalue_count);
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

strut_status strut_equilibrium_search_contacts(strut_equilibrium_search *h, const double *q,
                                               strut_equilibrium *e) {
  const strut_contact_table *c = &h->model->contacts;
  size_t most = h->on_ground ? (size_t)c->count : 0;
  e->contacts = strut_arena_allocate(&h->out->arena, most, sizeof *e->contacts);
  e->normal = strut_arena_allocate(&h->out->arena, most, sizeof *e->normal);
  if (!e->contacts || !e->normal) return strut_no_memory(h->error, "");
  e->contact_count = 0;
  for (size_t i = 0; i < most; i++) {
    double normal = -c->entry[i].stiffness * strut_contact_gap(c, (int32_t)i, q);
    if (!(normal > PULL * h->potential->force_scale)) continue;
    bool again = e->contact_count && e->contacts[e->contact_count - 1] == c->entry[i].node;
    if (again) { /* of a node with several contacts the sum */
      e->normal[e->contact_count - 1] += normal;
      continue;
    }
    e->contacts[e->contact_count] = c->entry[i].node;
    e->normal[e->contact_count++] = normal;
  }
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

static bool stands_on(const strut_equilibrium_search *h, const strut_candidate_equilibrium *f,
                      const double *rest) {
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
  e->outcome = stands_on(h, f, q) ? STRUT_OUTCOME_STANDS : STRUT_OUTCOME_TIPS;
  return STRUT_OK;
}

strut_status strut_equilibrium_search_follow(strut_equilibrium_search *h) {
  bool any = false, lost = false;
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < h->count; i++)
    h->candidates[i].e.outcome = judge_on_supports(h, &h->candidates[i]);
  if (h->instability != STRUT_INSTABILITY_NONE) return STRUT_OK;
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
