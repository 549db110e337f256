/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/equilibria/equilibria.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/model/algebra/linear_solver.h"
#include "engine/model/pose.h"
#include "engine/run/settle.h"
#include "engine/statics/equilibria/equilibria_parts.h"

/* Adds a search's counts; of its estimates the largest is kept. */
static void count_starts(strut_equilibrium_search *h, const strut_critical_set *set) {
  h->out->starts += set->starts;
  strut_missed *most = &h->out->missed;
  most->probability = fmax(most->probability, set->missed.probability);
  most->below = fmax(most->below, set->missed.below);
  most->one = fmax(most->one, set->missed.one);
  most->count = fmax(most->count, set->missed.count);
  h->out->unmet += set->unmet;
  h->out->unseen += set->unseen;
  h->out->cut_short = h->out->cut_short || set->cut_short;
}

/* Copies the level scene and places every configuration and the start on the support set. */
static double *place_shapes(const strut_equilibrium_search *h, const strut_node_set *set,
                            strut_scene *placed, size_t length, strut_arena *arena) {
  const strut_scene *level = &h->level.scene;
  size_t nodes = level->node_count, shapes = level->configuration_count;
  *placed = *level;
  placed->nodes = strut_arena_allocate(arena, nodes, sizeof *placed->nodes);
  double *shape = strut_arena_allocate(arena, (shapes + 1) * length, sizeof *shape);
  double(*start)[2] = strut_arena_allocate(arena, nodes, sizeof *start);
  if (!placed->nodes || !shape || !start) return NULL;
  memcpy(placed->nodes, level->nodes, nodes * sizeof *placed->nodes);
  for (size_t s = 0; s <= shapes; s++) {
    for (size_t i = 0; i < nodes; i++) {
      bool drawn = s == shapes || !level->configurations[s].shaped;
      memcpy(start[i], drawn ? level->nodes[i].position : level->configurations[s].position[i],
             sizeof *start);
    }
    strut_supports_place(&h->supports, level, set, start);
    memcpy(shape + s * length, start, nodes * sizeof *start);
  }
  for (size_t i = 0; i < nodes; i++) memcpy(placed->nodes[i].start, start[i], sizeof *start);
  return shape;
}

static strut_status add_points(strut_equilibrium_search *h, const strut_critical_set *set,
                               const strut_potential *potential, const uint8_t *held,
                               const strut_node_set *supports, int32_t group) {
  for (size_t i = 0; i < set->count; i++) {
    int32_t at = strut_equilibrium_search_add(h);
    if (at < 0) return strut_no_memory(h->error, "");
    h->candidates[at].group = group;
    h->candidates[at].number = (int32_t)i;
    strut_status status = strut_equilibrium_search_fill(h, &h->candidates[at], potential, held,
                                                        supports, &set->points[i]);
    if (status) return status;
  }
  return STRUT_OK;
}

static strut_status search_held(strut_equilibrium_search *h, const strut_potential *potential,
                                const uint8_t *held, const double *shape, const strut_node_set *set,
                                int32_t group, strut_arena *arena) {
  const strut_equilibria_options *o = h->options;
  size_t shapes = h->level.scene.configuration_count, length = (size_t)h->model->length;
  const double **extra = strut_arena_allocate(arena, shapes + 1, sizeof *extra);
  if (!extra) return strut_no_memory(h->error, "");
  strut_critical_effort effort = {.interrupt = o->interrupt,
                                  .starts = o->starts ? o->starts : h->experiment->search.starts,
                                  .seed = h->out->seed,
                                  .searches = (int32_t)h->supports.count + 1,
                                  .saddles = !o->standing_only,
                                  .extra = extra};
  for (size_t s = 0; s < shapes; s++)
    if (h->level.scene.configurations[s].shaped) extra[effort.extra_count++] = shape + s * length;
  strut_critical_set found = {0};
  strut_status status = strut_critical_search(potential, &effort, &found, h->error);
  if (!status) count_starts(h, &found);
  if (!status) status = add_points(h, &found, potential, held, set, group);
  strut_critical_free(&found);
  return status;
}

/* All solutions of (12) on one set of supports. */
static strut_status search_on_supports(strut_equilibrium_search *h, int32_t group) {
  const strut_node_set *set = &h->supports.sets[group];
  strut_arena scratch = {0};
  strut_scene placed;
  strut_model *model = NULL;
  strut_potential *potential = NULL;
  size_t length = (size_t)h->model->length;
  double *shape = place_shapes(h, set, &placed, length, &scratch);
  uint8_t *held = strut_arena_allocate(&scratch, length, 1);
  strut_status status = shape && held ? strut_model_compile(&placed, &model, h->error)
                                      : strut_no_memory(h->error, "");
  if (!status) {
    strut_supports_hold(&h->supports, set, held);
    status = strut_potential_create(model, held, false, &potential, h->error);
  }
  if (!status && potential->n == 0)
    status = strut_fail(h->error, STRUT_USAGE,
                        "with the requested supports held no node can move; hold fewer nodes");
  if (!status) status = search_held(h, potential, held, shape, set, group, &scratch);
  strut_potential_free(potential);
  strut_model_free(model);
  strut_arena_free(&scratch);
  return status;
}

static strut_status search_all_sets(strut_equilibrium_search *h) {
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < h->supports.count && !status; i++) {
    const strut_flag *interrupt = h->options->interrupt;
    status = interrupt && *interrupt
                 ? strut_fail(h->error, STRUT_INTERRUPTED, "interrupted while searching")
                 : search_on_supports(h, (int32_t)i);
    /* what follows, on the real ground, counts as one more set */
    strut_experiment_advance(h->experiment, (double)(i + 1) / (double)(h->supports.count + 1));
  }
  return status;
}

/* True if a candidate found on supports is that minimum of the real ground. */
static bool has_standing_candidate(const strut_equilibrium_search *h, int32_t state) {
  for (size_t i = 0; i < h->count; i++)
    if (h->candidates[i].e.supports && h->candidates[i].e.outcome == STRUT_OUTCOME_STANDS &&
        h->candidates[i].state == state)
      return true;
  return false;
}

/* Adds the real ground's saddles, and its minima that no candidate on supports represents. */
static strut_status add_ground(strut_equilibrium_search *h) {
  const strut_critical_set *set = &h->landscape.set;
  count_starts(h, set);
  for (size_t i = 0; i < set->count; i++) {
    if ((int32_t)i < h->landscape.minima && has_standing_candidate(h, (int32_t)i)) continue;
    int32_t at = strut_equilibrium_search_add(h);
    if (at < 0) return strut_no_memory(h->error, "");
    strut_candidate_equilibrium *f = &h->candidates[at];
    strut_equilibrium *e = &f->e;
    f->group = (int32_t)h->supports.count;
    strut_status status =
        strut_equilibrium_search_fill(h, f, h->potential, NULL, NULL, &set->points[i]);
    if (status) return status;
    f->number = (int32_t)i;
    f->state = (int32_t)i < h->landscape.minima ? (int32_t)i : -1;
    e->outcome = e->point.label == STRUT_STABLE   ? STRUT_OUTCOME_STANDS
                 : e->point.label == STRUT_FLOPPY ? STRUT_OUTCOME_FLOPPY
                                                  : STRUT_OUTCOME_UNSTABLE;
    if (e->outcome == STRUT_OUTCOME_UNSTABLE) continue;
    e->rest = e->point.q;
    e->rest_energy = e->energy;
    e->rest_residual = e->point.residual;
  }
  return STRUT_OK;
}

/* Order within a group: standing ones, other stable ones by energy, saddles, maxima. */
static int compare_candidates(const void *pa, const void *pb) {
  const strut_candidate_equilibrium *a = pa, *b = pb;
  int stands_a = a->e.outcome == STRUT_OUTCOME_STANDS,
      stands_b = b->e.outcome == STRUT_OUTCOME_STANDS;
  if (a->group != b->group) return a->group < b->group ? -1 : 1;
  if (stands_a != stands_b) return stands_b - stands_a;
  if (a->e.point.label != b->e.point.label) return (int)a->e.point.label - (int)b->e.point.label;
  if (a->e.energy != b->e.energy) return a->e.energy < b->e.energy ? -1 : 1;
  int order = memcmp(&a->e.point.found, &b->e.point.found, sizeof a->e.point.found);
  return order ? order : (a->number > b->number) - (a->number < b->number);
}

static void link_ends(strut_equilibrium_search *h) {
  for (size_t i = 0; i < h->count; i++) {
    strut_equilibrium *e = &h->candidates[i].e;
    if (e->outcome == STRUT_OUTCOME_STANDS) e->ends_as = (int32_t)i;
    for (size_t k = 0; k < h->count && e->outcome == STRUT_OUTCOME_TIPS && e->ends_as < 0; k++)
      if (h->candidates[k].e.outcome == STRUT_OUTCOME_STANDS &&
          h->candidates[k].state == h->candidates[i].state && h->candidates[i].state >= 0)
        e->ends_as = (int32_t)k;
  }
}

/*
 * Index in the list of point `number` of a search; on the ground that of the equilibrium standing
 * there.
 */
static int32_t find_number(const strut_equilibrium_search *h, int32_t group, int32_t number) {
  for (size_t i = 0; i < h->count && number >= 0; i++) {
    const strut_candidate_equilibrium *f = &h->candidates[i];
    bool there = group == (int32_t)h->supports.count
                     ? f->state == number && f->e.outcome == STRUT_OUTCOME_STANDS
                     : false;
    if (there || (f->group == group && f->number == number)) return (int32_t)i;
  }
  return -1;
}

/* Translates the minima below saddles from numbers in their search to indices in the list. */
static void link_saddles(strut_equilibrium_search *h) {
  for (size_t i = 0; i < h->count; i++) {
    strut_candidate_equilibrium *f = &h->candidates[i];
    bool leads = f->e.point.label == STRUT_SADDLE && f->e.point.negative == 1;
    for (int k = 0; k < 2; k++)
      f->e.point.down[k] = leads ? find_number(h, f->group, f->e.point.down[k]) : -1;
  }
}

/* The landscape's minimum into which the drawn shape descends, or -1; q (length) is scratch. */
static strut_status find_start_state(const strut_equilibrium_search *h, double *q, int32_t *state) {
  strut_minimiser *minimiser;
  strut_status status = strut_minimiser_create(h->potential, &minimiser, h->error);
  if (status) return status;
  strut_minimiser_watch(minimiser, h->options->interrupt);
  memcpy(q, h->model->start, (size_t)h->model->length * sizeof *q);
  bool rests = strut_descend_gently(minimiser, q) == STRUT_DESCENT_REACHED;
  *state = rests ? strut_landscape_find(&h->landscape, q) : -1;
  strut_minimiser_free(minimiser);
  return STRUT_OK;
}

/* Marks shapes in which bodies lie in each other, saddles that lead through one, and what lies behind one. */
static strut_status mark_collisions(strut_equilibrium_search *h) {
  const strut_landscape *l = &h->landscape;
  int32_t start = -1, ground = (int32_t)h->supports.count;
  double *q = strut_arena_allocate(&h->out->arena, (size_t)h->model->length, sizeof *q);
  if (!q) return strut_no_memory(h->error, "");
  bool connected = h->explored && !h->options->standing_only;
  strut_status status = connected ? find_start_state(h, q, &start) : STRUT_OK;
  for (size_t i = 0; i < h->count && status == STRUT_OK; i++) {
    strut_candidate_equilibrium *f = &h->candidates[i];
    f->e.overlap = strut_overlap_find(h->model, f->e.point.q);
    if (l->through && f->group == ground && f->state < 0) f->e.through = l->through[f->number];
    if (start < 0 || f->state < 0 || start == f->state) continue;
    if (strut_landscape_path(l, start, f->state) >= 0) continue;
    const double *from = l->set.points[start].q, *to = l->set.points[f->state].q;
    f->e.through = l->merged ? strut_crossing_find(h->model, from, to)
                             : strut_passage_find(h->model, from, to);
  }
  return status;
}

static void turn_to_original(strut_equilibrium_search *h, strut_equilibrium *e) {
  size_t nodes = (size_t)h->model->node_count;
  strut_level_frame_place(&h->level, nodes, e->point.q);
  strut_level_frame_to_original(&h->level, nodes, e->point.softest);
  strut_level_frame_to_original(&h->level, nodes, e->reaction[0]);
  if (e->rest && e->rest != e->point.q) strut_level_frame_place(&h->level, nodes, e->rest);
  double lower = strut_level_frame_work(&h->level, h->model->weight);
  e->energy -= lower, e->rest_energy -= lower, e->point.potential -= lower;
}

/* Sorts, names, links and describes the candidates, and moves them to the result. */
static strut_status report_equilibria(strut_equilibrium_search *h) {
  strut_arena *arena = &h->out->arena;
  if (h->count) qsort(h->candidates, h->count, sizeof *h->candidates, compare_candidates);
  strut_equilibrium **list = strut_arena_allocate(arena, h->count, sizeof *list);
  h->out->list = strut_arena_allocate(arena, h->count, sizeof *h->out->list);
  if (!list || !h->out->list) return strut_no_memory(h->error, "");
  for (size_t i = 0; i < h->count; i++) list[i] = &h->candidates[i].e;
  if (strut_name_equilibria(h->model, h->count, list, arena)) return strut_no_memory(h->error, "");
  link_ends(h);
  link_saddles(h);
  strut_status status = STRUT_OK;
  if (h->model->scene->collision_count) status = mark_collisions(h);
  if (status) return status;
  strut_report_candidates(h, h->candidates, h->count);
  if (h->explored && !h->options->standing_only) status = strut_barriers_find(h);
  for (size_t i = 0; i < h->count; i++) {
    turn_to_original(h, &h->candidates[i].e);
    h->out->list[i] = h->candidates[i].e;
  }
  h->out->count = h->count;
  return status;
}

/* True if a force acts across the ground or a support holds a node across it. */
static bool is_pressed(const strut_equilibrium_search *h) {
  double scale = 1e-12 * h->potential->force_scale, sum = 0.0;
  if (h->model->contacts.surface) return true; /* they may face any direction */
  for (int32_t i = 0; i < h->model->node_count; i++) {
    if (h->model->fixed[2 * i + 1]) return true;
    sum += h->potential->force[2 * i + 1];
  }
  return fabs(sum) > scale;
}

static strut_status create_potential(strut_equilibrium_search *h, bool ground) {
  strut_potential_free(h->potential);
  h->potential = NULL;
  h->on_ground = ground;
  return strut_potential_create(h->model, NULL, ground, &h->potential, h->error);
}

static strut_status prepare_search(strut_equilibrium_search *h, const strut_model *original) {
  const strut_equilibria_options *o = h->options;
  h->out->seed = o->seed ? *o->seed : h->experiment->search.seed;
  strut_status status = strut_level_frame_create(original->scene, &h->level, h->error);
  if (!status) status = strut_model_compile(&h->level.scene, &h->model, h->error);
  if (!status) status = create_potential(h, h->model && h->model->contacts.count > 0);
  if (!status && h->on_ground && !is_pressed(h)) status = create_potential(h, false);
  if (status) return status;
  if (h->on_ground && h->level.oblique_node < 0)
    status = strut_supports_choose(&h->level.scene, &h->experiment->search, o->supports,
                                   &h->out->arena, &h->supports, h->error);
  else if (o->supports)
    status = strut_fail(
        h->error, STRUT_USAGE,
        h->level.oblique_node >= 0
            ? "static supports cannot replace a sloped ground while a node is held in one "
              "direction only"
            : "the ground does not press on the structure, so supports cannot replace it");
  return status;
}

static strut_status search_scene(strut_equilibrium_search *h, const strut_scene *scene) {
  if (h->potential->n == 0) {
    strncpy(h->out->remark, "nothing can move: the scene holds every node",
            sizeof h->out->remark - 1);
    return STRUT_OK;
  }
  h->instability = strut_equilibrium_search_instability(h);
  if (h->instability == STRUT_INSTABILITY_FALLS) return STRUT_OK;
  strut_status status =
      strut_relaxer_create(h->potential, h->experiment->settle.limit, &h->relaxer, h->error);
  if (!status && h->instability == STRUT_INSTABILITY_SLIDES)
    status = strut_equilibrium_search_grips(h, scene, &h->held_by_friction);
  if (!status) status = search_all_sets(h);
  if (!status) status = strut_equilibrium_search_follow(h);
  if (!status && h->explored) status = add_ground(h);
  return status;
}

static bool is_listed(const int32_t *nodes, int32_t count, int32_t node) {
  for (int32_t k = 0; k < count; k++)
    if (nodes[k] == node) return true;
  return false;
}

/* Is the shape q held by the ground where that equilibrium is? */
static bool touches_alike(const strut_model *model, const strut_equilibrium *e, const double *q) {
  const strut_contact_table *c = &model->contacts;
  for (int32_t i = 0; i < c->count; i++)
    if ((strut_contact_gap(c, i, q) < 0.0) !=
        is_listed(e->contacts, e->contact_count, c->entry[i].node))
      return false;
  return true;
}

/*
 * The equilibrium on the real ground whose shape is nearest, if that is near, in model sizes. Friction holds others
 * around it, on the same contacts.
 */
static int32_t find_nearest(const strut_model *model, const strut_equilibria *all, bool friction,
                            const double *q) {
  double least = (friction ? STRUT_NAMED_WITHIN : 1e-4) * model->size;
  int32_t nearest = -1;
  for (size_t i = 0; i < all->count; i++) {
    const strut_equilibrium *e = &all->list[i];
    bool unstable = !e->supports && e->outcome == STRUT_OUTCOME_UNSTABLE;
    if (e->outcome != STRUT_OUTCOME_STANDS && !unstable) continue;
    if (friction && (unstable || !touches_alike(model, e, q))) continue;
    const double *shape = unstable ? e->point.q : e->rest;
    double away = strut_shape_distance(model, q, shape, false, NULL);
    if (away < least) least = away, nearest = (int32_t)i;
  }
  return nearest;
}

/* Finds the equilibrium that a settling run of the scene starts from. */
static strut_status settle_start(strut_equilibrium_search *h, const strut_model *model) {
  strut_error trouble = {0};
  h->out->start = -1;
  if (!h->experiment->settle.wanted || !model->mass || h->options->standing_only) return STRUT_OK;
  double *q = strut_arena_allocate(&h->out->arena, (size_t)model->length, sizeof *q);
  if (!q) return strut_no_memory(h->error, "");
  strut_status status = strut_settle_experiment(model, h->experiment, h->options->interrupt, q,
                                                &h->out->settle, &trouble);
  if (!status) h->out->start = find_nearest(model, h->out, h->experiment->settle.friction, q);
  if (!status) return STRUT_OK;
  if (status != STRUT_NOT_SETTLED && status != STRUT_DIVERGED)
    return strut_fail(h->error, status, "%s", trouble.message);
  snprintf(h->out->start_trouble, sizeof h->out->start_trouble, "%s", trouble.message);
  return STRUT_OK; /* the list is valid without it */
}

strut_status strut_equilibria_find(const strut_model *model, const strut_experiment *experiment,
                                   const strut_equilibria_options *options,
                                   strut_equilibria *equilibria, strut_error *error) {
  memset(equilibria, 0, sizeof *equilibria);
  /* Here, since its parts report nothing but a lack of memory. */
  strut_status status = strut_linear_solver_load(error);
  if (status) return status;
  strut_equilibrium_search h = {
      .experiment = experiment, .options = options, .out = equilibria, .error = error};
  status = prepare_search(&h, model);
  if (!status) status = search_scene(&h, model->scene);
  if (!status) status = report_equilibria(&h);
  if (!status) status = settle_start(&h, model);
  for (size_t i = 0; !status && i < equilibria->count; i++)
    strut_find_shape_flaws(model, &equilibria->list[i]);
  strut_landscape_free(&h.landscape);
  strut_relaxer_free(h.relaxer);
  strut_potential_free(h.potential);
  strut_model_free(h.model);
  strut_level_frame_free(&h.level);
  return status;
}

void strut_equilibria_free(strut_equilibria *equilibria) {
  strut_arena_free(&equilibria->arena);
  memset(equilibria, 0, sizeof *equilibria);
}
