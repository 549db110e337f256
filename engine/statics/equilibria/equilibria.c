/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/equilibria/equilibria.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/model/algebra/linear_solver.h"
#include "engine/model/pose.h"
#include "engine/run/settle.h"
#include "engine/statics/equilibria/equilibria_parts.h"

/* Adds a search's counts; of its estimates the largest is kept. */
static void count_starts(strut_equilibrium_search *search, const strut_critical_set *set) {
  search->out->starts += set->starts;
  strut_missed *most = &search->out->missed;
  most->probability = fmax(most->probability, set->missed.probability);
  most->below = fmax(most->below, set->missed.below);
  most->one = fmax(most->one, set->missed.one);
  most->count = fmax(most->count, set->missed.count);
  search->out->unmet += set->unmet;
  search->out->unseen += set->unseen;
  search->out->cut_short = search->out->cut_short || set->cut_short;
  search->out->climbs = search->out->climbs || set->climbs;
}

/* Copies the level scene and places every configuration and the start on the support set. */
static double *place_shapes(const strut_equilibrium_search *search, const strut_node_set *set,
                            strut_scene *placed, size_t length, strut_arena *arena) {
  const strut_scene *level = &search->level.scene;
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
    strut_supports_place(&search->supports, level, set, start);
    memcpy(shape + s * length, start, nodes * sizeof *start);
  }
  for (size_t i = 0; i < nodes; i++) memcpy(placed->nodes[i].start, start[i], sizeof *start);
  return shape;
}

static strut_status add_points(strut_equilibrium_search *search, const strut_critical_set *set,
                               const strut_potential *potential, const uint8_t *held,
                               const strut_node_set *supports, int32_t group) {
  for (size_t i = 0; i < set->count; i++) {
    int32_t at = strut_equilibrium_search_add(search);
    if (at < 0) return strut_no_memory(search->error, "");
    search->candidates[at].group = group;
    search->candidates[at].number = (int32_t)i;
    strut_status status = strut_equilibrium_search_fill(search, &search->candidates[at], potential,
                                                        held, supports, &set->points[i]);
    if (status) return status;
  }
  return STRUT_OK;
}

static strut_status search_held(strut_equilibrium_search *search, const strut_potential *potential,
                                const uint8_t *held, const double *shape, const strut_node_set *set,
                                int32_t group, strut_arena *arena) {
  const strut_equilibria_options *options = search->options;
  size_t shapes = search->level.scene.configuration_count, length = (size_t)search->model->length;
  const double **extra = strut_arena_allocate(arena, shapes + 1, sizeof *extra);
  if (!extra) return strut_no_memory(search->error, "");
  strut_critical_effort effort = {
      .interrupt = options->interrupt,
      .starts = options->starts ? options->starts : search->experiment->search.starts,
      .seed = search->out->seed,
      .searches = (int32_t)search->supports.count + 1,
      .saddles = !options->standing_only,
      .extra = extra};
  for (size_t s = 0; s < shapes; s++)
    if (search->level.scene.configurations[s].shaped)
      extra[effort.extra_count++] = shape + s * length;
  strut_critical_set found = {0};
  strut_status status = strut_critical_search(potential, &effort, &found, search->error);
  if (!status) count_starts(search, &found);
  if (!status) status = add_points(search, &found, potential, held, set, group);
  strut_critical_free(&found);
  return status;
}

/* All solutions of (12) on one set of supports. */
static strut_status search_on_supports(strut_equilibrium_search *search, int32_t group) {
  const strut_node_set *set = &search->supports.sets[group];
  strut_arena scratch = {0};
  strut_scene placed;
  strut_model *model = NULL;
  strut_potential *potential = NULL;
  size_t length = (size_t)search->model->length;
  double *shape = place_shapes(search, set, &placed, length, &scratch);
  uint8_t *held = strut_arena_allocate(&scratch, length, 1);
  strut_status status = shape && held ? strut_model_compile(&placed, &model, search->error)
                                      : strut_no_memory(search->error, "");
  if (!status) {
    strut_supports_hold(&search->supports, set, held);
    status = strut_potential_create(model, held, false, &scratch, &potential, search->error);
  }
  if (!status && potential->n == 0)
    status = strut_fail(search->error, STRUT_USAGE,
                        "with the requested supports held no node can move; hold fewer nodes");
  if (!status) status = search_held(search, potential, held, shape, set, group, &scratch);
  strut_model_free(model);
  strut_arena_free(&scratch);
  return status;
}

static strut_status search_all_sets(strut_equilibrium_search *search) {
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < search->supports.count && !status; i++) {
    const strut_flag *interrupt = search->options->interrupt;
    status = interrupt && *interrupt
                 ? strut_fail(search->error, STRUT_INTERRUPTED, "interrupted while searching")
                 : search_on_supports(search, (int32_t)i);
    /* what follows, on the real ground, counts as one more set */
    strut_experiment_advance(search->experiment,
                             (double)(i + 1) / (double)(search->supports.count + 1));
  }
  return status;
}

/* True if a candidate found on supports is that minimum of the real ground. */
static bool has_standing_candidate(const strut_equilibrium_search *search, int32_t state) {
  for (size_t i = 0; i < search->count; i++)
    if (search->candidates[i].e.supports &&
        search->candidates[i].e.outcome == STRUT_OUTCOME_STANDS &&
        search->candidates[i].state == state)
      return true;
  return false;
}

/* Adds the real ground's saddles, and its minima that no candidate on supports represents. */
static strut_status add_ground(strut_equilibrium_search *search) {
  const strut_critical_set *set = &search->landscape.set;
  count_starts(search, set);
  for (size_t i = 0; i < set->count; i++) {
    if ((int32_t)i < search->landscape.minima && has_standing_candidate(search, (int32_t)i))
      continue;
    int32_t at = strut_equilibrium_search_add(search);
    if (at < 0) return strut_no_memory(search->error, "");
    strut_candidate_equilibrium *candidate = &search->candidates[at];
    strut_equilibrium *equilibrium = &candidate->e;
    candidate->group = (int32_t)search->supports.count;
    strut_status status = strut_equilibrium_search_fill(search, candidate, search->potential, NULL,
                                                        NULL, &set->points[i]);
    if (status) return status;
    candidate->number = (int32_t)i;
    candidate->state = (int32_t)i < search->landscape.minima ? (int32_t)i : -1;
    equilibrium->outcome = equilibrium->point.label == STRUT_STABLE   ? STRUT_OUTCOME_STANDS
                           : equilibrium->point.label == STRUT_FLOPPY ? STRUT_OUTCOME_FLOPPY
                                                                      : STRUT_OUTCOME_UNSTABLE;
    if (equilibrium->outcome == STRUT_OUTCOME_UNSTABLE) continue;
    equilibrium->rest = equilibrium->point.q;
    equilibrium->rest_energy = equilibrium->energy;
    equilibrium->rest_residual = equilibrium->point.residual;
  }
  return STRUT_OK;
}

/* Order within a group: standing ones, other stable ones by energy, saddles, maxima. */
static bool comes_before(const strut_equilibrium_search *search,
                         const strut_candidate_equilibrium *a,
                         const strut_candidate_equilibrium *b) {
  bool stands_a = a->e.outcome == STRUT_OUTCOME_STANDS,
       stands_b = b->e.outcome == STRUT_OUTCOME_STANDS;
  if (a->group != b->group) return a->group < b->group;
  if (stands_a != stands_b) return stands_a;
  if (a->e.point.label != b->e.point.label) return a->e.point.label < b->e.point.label;
  return strut_equilibrium_comes_before(search->model, &a->e, &b->e);
}

/* Insertion sort: it tolerates a comparison that rounding makes intransitive. */
static void sort_candidates(strut_equilibrium_search *search) {
  strut_candidate_equilibrium *list = search->candidates;
  for (size_t i = 1; i < search->count; i++) {
    strut_candidate_equilibrium moved = list[i];
    size_t k = i;
    for (; k > 0 && comes_before(search, &moved, &list[k - 1]); k--) list[k] = list[k - 1];
    list[k] = moved;
  }
}

static void link_ends(strut_equilibrium_search *search) {
  for (size_t i = 0; i < search->count; i++) {
    strut_equilibrium *equilibrium = &search->candidates[i].e;
    if (equilibrium->outcome == STRUT_OUTCOME_STANDS) equilibrium->ends_as = (int32_t)i;
    for (size_t k = 0; k < search->count && equilibrium->outcome == STRUT_OUTCOME_TIPS &&
                       equilibrium->ends_as < 0;
         k++)
      if (search->candidates[k].e.outcome == STRUT_OUTCOME_STANDS &&
          search->candidates[k].state == search->candidates[i].state &&
          search->candidates[i].state >= 0)
        equilibrium->ends_as = (int32_t)k;
  }
}

/*
 * Index in the list of point `number` of a search; on the ground that of the equilibrium standing
 * there.
 */
static int32_t find_number(const strut_equilibrium_search *search, int32_t group, int32_t number) {
  for (size_t i = 0; i < search->count && number >= 0; i++) {
    const strut_candidate_equilibrium *candidate = &search->candidates[i];
    bool there = group == (int32_t)search->supports.count
                     ? candidate->state == number && candidate->e.outcome == STRUT_OUTCOME_STANDS
                     : false;
    if (there || (candidate->group == group && candidate->number == number)) return (int32_t)i;
  }
  return -1;
}

/* Translates the minima below saddles from numbers in their search to indices in the list. */
static void link_saddles(strut_equilibrium_search *search) {
  for (size_t i = 0; i < search->count; i++) {
    strut_candidate_equilibrium *candidate = &search->candidates[i];
    bool leads = candidate->e.point.label == STRUT_SADDLE && candidate->e.point.negative == 1;
    for (int k = 0; k < 2; k++)
      candidate->e.point.down[k] =
          leads ? find_number(search, candidate->group, candidate->e.point.down[k]) : -1;
  }
}

/* The landscape's minimum into which the drawn shape descends, or -1; q (length) is scratch. */
static strut_status find_start_state(const strut_equilibrium_search *search, double *positions,
                                     int32_t *state) {
  strut_minimiser *minimiser;
  strut_status status =
      strut_minimiser_create(search->potential, &search->out->arena, &minimiser, search->error);
  if (status) return status;
  strut_minimiser_watch(minimiser, search->options->interrupt);
  memcpy(positions, search->model->start, (size_t)search->model->length * sizeof *positions);
  bool rests = strut_descend_gently(minimiser, positions) == STRUT_DESCENT_REACHED;
  *state = rests ? strut_landscape_find(&search->landscape, positions) : -1;
  return STRUT_OK;
}

/* Marks shapes in which bodies lie in each other, saddles that lead through one, and what lies behind one. */
static strut_status mark_collisions(strut_equilibrium_search *search) {
  const strut_landscape *landscape = &search->landscape;
  int32_t start = -1, ground = (int32_t)search->supports.count;
  double *q = strut_arena_allocate(&search->out->arena, (size_t)search->model->length, sizeof *q);
  if (!q) return strut_no_memory(search->error, "");
  bool connected = search->explored && !search->options->standing_only;
  strut_status status = connected ? find_start_state(search, q, &start) : STRUT_OK;
  for (size_t i = 0; i < search->count && status == STRUT_OK; i++) {
    strut_candidate_equilibrium *candidate = &search->candidates[i];
    candidate->e.overlap = strut_overlap_find(search->model, candidate->e.point.q);
    if (landscape->through && candidate->group == ground && candidate->state < 0)
      candidate->e.through = landscape->through[candidate->number];
    if (start < 0 || candidate->state < 0 || start == candidate->state) continue;
    if (strut_landscape_path(landscape, start, candidate->state) >= 0) continue;
    const double *from = landscape->set.points[start].q,
                 *to = landscape->set.points[candidate->state].q;
    candidate->e.through = landscape->merged ? strut_crossing_find(search->model, from, to)
                                             : strut_passage_find(search->model, from, to);
  }
  return status;
}

static void turn_to_original(strut_equilibrium_search *search, strut_equilibrium *equilibrium) {
  size_t nodes = (size_t)search->model->node_count;
  strut_level_frame_place(&search->level, nodes, equilibrium->point.q);
  strut_level_frame_to_original(&search->level, nodes, equilibrium->point.softest);
  strut_level_frame_to_original(&search->level, nodes, equilibrium->reaction[0]);
  if (equilibrium->rest && equilibrium->rest != equilibrium->point.q)
    strut_level_frame_place(&search->level, nodes, equilibrium->rest);
  double lower = strut_level_frame_work(&search->level, search->model->weight);
  equilibrium->energy -= lower, equilibrium->rest_energy -= lower,
      equilibrium->point.potential -= lower;
}

/* Sorts, names, links and describes the candidates, and moves them to the result. */
static strut_status report_equilibria(strut_equilibrium_search *search) {
  strut_arena *arena = &search->out->arena;
  sort_candidates(search);
  strut_equilibrium **list = strut_arena_allocate(arena, search->count, sizeof *list);
  search->out->list = strut_arena_allocate(arena, search->count, sizeof *search->out->list);
  if (!list || !search->out->list) return strut_no_memory(search->error, "");
  for (size_t i = 0; i < search->count; i++) list[i] = &search->candidates[i].e;
  if (strut_name_equilibria(search->model, search->count, list, arena))
    return strut_no_memory(search->error, "");
  link_ends(search);
  link_saddles(search);
  strut_status status = STRUT_OK;
  if (search->model->scene->collision_count) status = mark_collisions(search);
  if (status) return status;
  strut_report_candidates(search, search->candidates, search->count);
  if (search->explored && !search->options->standing_only) status = strut_barriers_find(search);
  for (size_t i = 0; i < search->count; i++) {
    turn_to_original(search, &search->candidates[i].e);
    search->out->list[i] = search->candidates[i].e;
  }
  search->out->count = search->count;
  return status;
}

/* True if a force acts across the ground or a support holds a node across it. */
static bool is_pressed(const strut_equilibrium_search *search) {
  double scale = 1e-12 * search->potential->force_scale, sum = 0.0;
  if (search->model->contacts.surface) return true; /* they may face any direction */
  for (int32_t i = 0; i < search->model->node_count; i++) {
    if (search->model->fixed[2 * i + 1]) return true;
    sum += search->potential->force[2 * i + 1];
  }
  return fabs(sum) > scale;
}

static strut_status create_potential(strut_equilibrium_search *search, bool ground) {
  search->on_ground = ground;
  return strut_potential_create(search->model, NULL, ground, &search->out->arena,
                                &search->potential, search->error);
}

static strut_status prepare_search(strut_equilibrium_search *search, const strut_model *original) {
  const strut_equilibria_options *options = search->options;
  search->out->seed = options->seed ? *options->seed : search->experiment->search.seed;
  strut_status status = strut_level_frame_create(original->scene, &search->level, search->error);
  if (!status) status = strut_model_compile(&search->level.scene, &search->model, search->error);
  if (!status)
    status = create_potential(search, search->model && search->model->contacts.count > 0);
  if (!status && search->on_ground && !is_pressed(search)) status = create_potential(search, false);
  if (status) return status;
  if (search->on_ground && search->level.oblique_node < 0)
    status =
        strut_supports_choose(&search->level.scene, &search->experiment->search, options->supports,
                              &search->out->arena, &search->supports, search->error);
  else if (options->supports)
    status = strut_fail(
        search->error, STRUT_USAGE,
        search->level.oblique_node >= 0
            ? "static supports cannot replace a sloped ground while a node is held in one "
              "direction only"
            : "the ground does not press on the structure, so supports cannot replace it");
  return status;
}

static strut_status search_scene(strut_equilibrium_search *search, const strut_scene *scene) {
  if (search->potential->n == 0) {
    strncpy(search->out->remark, "nothing can move: the scene holds every node",
            sizeof search->out->remark - 1);
    return STRUT_OK;
  }
  search->instability = strut_equilibrium_search_instability(search);
  if (search->instability == STRUT_INSTABILITY_FALLS) return STRUT_OK;
  strut_status status = strut_relaxer_create(search->potential, search->experiment->settle.limit,
                                             &search->relaxer, search->error);
  if (!status && search->instability == STRUT_INSTABILITY_SLIDES)
    status = strut_equilibrium_search_grips(search, scene, &search->held_by_friction);
  if (!status) status = search_all_sets(search);
  if (!status) status = strut_equilibrium_search_follow(search);
  if (!status && search->explored) status = add_ground(search);
  return status;
}

/* Is the shape q held by the ground where that equilibrium is? */
static bool touches_alike(const strut_model *model, const strut_equilibrium *equilibrium,
                          const double *positions) {
  const strut_contact_table *contacts = &model->contacts;
  for (int32_t i = 0; i < contacts->count; i++)
    if ((strut_contact_gap(contacts, i, positions) < 0.0) !=
        strut_is_listed(equilibrium->contacts, equilibrium->contact_count, contacts->entry[i].node))
      return false;
  return true;
}

/*
 * The equilibrium on the real ground whose shape is nearest, if that is near, in model sizes. Friction holds others
 * around it, on the same contacts.
 */
static int32_t find_nearest(const strut_model *model, const strut_equilibria *all, bool friction,
                            const double *positions) {
  double least = (friction ? STRUT_NAMED_WITHIN : 1e-4) * model->size;
  int32_t nearest = -1;
  for (size_t i = 0; i < all->count; i++) {
    const strut_equilibrium *equilibrium = &all->list[i];
    bool unstable = !equilibrium->supports && equilibrium->outcome == STRUT_OUTCOME_UNSTABLE;
    if (equilibrium->outcome != STRUT_OUTCOME_STANDS && !unstable) continue;
    if (friction && (unstable || !touches_alike(model, equilibrium, positions))) continue;
    const double *shape = unstable ? equilibrium->point.q : equilibrium->rest;
    double away = strut_shape_distance(model, positions, shape, false, NULL);
    if (away < least) least = away, nearest = (int32_t)i;
  }
  return nearest;
}

/* Finds the equilibrium that a settling run of the scene starts from. */
static strut_status settle_start(strut_equilibrium_search *search, const strut_model *model) {
  strut_error trouble = {0};
  search->out->start = -1;
  if (!search->experiment->settle.wanted || !model->mass || search->options->standing_only)
    return STRUT_OK;
  double *q = strut_arena_allocate(&search->out->arena, (size_t)model->length, sizeof *q);
  if (!q) return strut_no_memory(search->error, "");
  strut_status status = strut_settle_experiment(
      model, search->experiment, search->options->interrupt, q, &search->out->settle, &trouble);
  if (!status)
    search->out->start = find_nearest(model, search->out, search->experiment->settle.friction, q);
  if (!status) return STRUT_OK;
  if (status != STRUT_NOT_SETTLED && status != STRUT_DIVERGED)
    return strut_fail(search->error, status, "%s", trouble.message);
  snprintf(search->out->start_trouble, sizeof search->out->start_trouble, "%s", trouble.message);
  return STRUT_OK; /* the list is valid without it */
}

/* Twice the area of a, b, c: positive where they turn left. */
static double turn(const double *a, const double *b, const double *c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static bool members_cross(const strut_model *model, const double *positions, int32_t i, int32_t j) {
  const strut_member_table *members = &model->members;
  const double *a = positions + members->from[i], *b = positions + members->to[i],
               *c = positions + members->from[j], *d = positions + members->to[j];
  if (a == c || a == d || b == c || b == d || fmin(a[0], b[0]) > fmax(c[0], d[0]) ||
      fmin(c[0], d[0]) > fmax(a[0], b[0]))
    return false;
  double least = 1e-8 * model->size * model->size;
  double c_side = turn(a, b, c), d_side = turn(a, b, d);
  double a_side = turn(c, d, a), b_side = turn(c, d, b);
  bool apart = fmin(fabs(c_side), fabs(d_side)) > least && fmin(fabs(a_side), fabs(b_side)) > least;
  return apart && (c_side > 0) != (d_side > 0) && (a_side > 0) != (b_side > 0);
}

/* Finds whether nodes of the shape coincide and which members cross. */
static void find_shape_flaws(const strut_model *model, strut_equilibrium *equilibrium) {
  const double *q = equilibrium->point.q, near = 1e-4 * model->size;
  for (int32_t i = 0; i < model->node_count && !equilibrium->collapsed; i++)
    for (int32_t j = 0; j < i && !equilibrium->collapsed; j++)
      equilibrium->collapsed =
          fabs(q[2 * i] - q[2 * j]) < near && strut_distance(q + 2 * i, q + 2 * j) < near;
  for (int32_t i = 0; i < model->members.count; i++)
    for (int32_t j = 0; j < i; j++) equilibrium->crossings += members_cross(model, q, i, j);
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
    find_shape_flaws(model, &equilibria->list[i]);
  strut_landscape_free(&h.landscape);
  strut_relaxer_free(h.relaxer);
  strut_model_free(h.model);
  strut_level_frame_free(&h.level);
  return status;
}

void strut_equilibria_free(strut_equilibria *equilibria) {
  strut_arena_free(&equilibria->arena);
  memset(equilibria, 0, sizeof *equilibria);
}
