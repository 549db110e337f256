/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <string.h>

#include "engine/base/text.h"
#include "engine/forces/tangent.h"
#include "engine/run/settle.h"
#include "engine/scene/things.h"
#include "engine/statics/equilibria/equilibria_parts.h"

/* The residual of a drawn shape that counts as at rest, in weights. */
static const double AT_REST = 1e-8;

/* A hinge pushes on its nodes with its moment over the arms, a cell with its pressure times lengths. */
static double sum_member_forces(const strut_model *model, const double *positions) {
  const strut_member_table *members = &model->members;
  strut_force_visit visit = {
      .model = model, .q = positions, .rest = members->rest, .least = -HUGE_VAL};
  double sum = 0.0, others = 0.0;
  for (int32_t j = 0; j < members->count; j++)
    sum += fabs(strut_member_elastic_tension(model, members->rest, j, positions));
  for (const strut_force *force; (force = strut_force_next(&visit));)
    if (force->kind == STRUT_FORCE_ELEMENT &&
        !strut_element_is_of_member(&model->elements.element[force->index]))
      others += fabs(force->pose.force) * hypot(force->pose.b[0], force->pose.b[1]);
  return sum + others;
}

/* Fills in all fields but name and q, from q. */
static strut_status judge_rest(const strut_model *model, strut_arena *arena, strut_rest_state *rest,
                               strut_error *error) {
  strut_potential *potential = NULL;
  strut_status status = strut_potential_create(model, NULL, true, arena, &potential, error);
  if (status) return status;
  double *g = strut_arena_allocate(arena, (size_t)potential->n, sizeof *g);
  strut_node_pushes pushes;
  if (g && strut_closed_contacts(model, rest->q, 0.0, arena, &pushes)) {
    rest->closed = pushes.node, rest->normal = pushes.normal, rest->closed_count = pushes.count;
    strut_potential_gradient(potential, rest->q, g);
    rest->residual = strut_largest_magnitude(g, potential->n);
    rest->scale = potential->force_scale;
    if (!(rest->scale > 0)) rest->scale = sum_member_forces(model, rest->q);
    double rounding = 4 * strut_potential_rounding(potential, rest->q);
    rest->at_rest = rest->residual <= fmax(AT_REST * rest->scale, rounding);
  } else {
    status = strut_no_memory(error, "");
  }
  return status;
}

/* Prepares a search for a single relaxation; of what friction holds there is none without it. */
static strut_status prepare_relaxation(strut_equilibrium_search *search, const strut_model *model) {
  strut_status status = strut_level_frame_create(model->scene, &search->level, search->error);
  if (!status) status = strut_model_compile(&search->level.scene, &search->model, search->error);
  if (!status) {
    search->on_ground = search->model->contacts.count > 0;
    status = strut_potential_create(search->model, NULL, search->on_ground, &search->out->arena,
                                    &search->potential, search->error);
  }
  if (!status) search->instability = strut_equilibrium_search_instability(search);
  search->supports.pin = true;
  if (!status && search->instability == STRUT_INSTABILITY_SLIDES)
    status = strut_equilibrium_search_grips(search, model->scene, &search->held_by_friction);
  if (status || search->held_by_friction) return status;
  if (search->instability != STRUT_INSTABILITY_NONE)
    status = strut_fail(search->error, STRUT_NOT_SETTLED, "%s", search->out->remark);
  if (!status && search->potential->n > 0)
    status = strut_relaxer_create(search->potential, search->experiment->settle.limit,
                                  &search->relaxer, search->error);
  return status;
}

static void free_search(strut_equilibrium_search *search) {
  strut_relaxer_free(search->relaxer);
  strut_model_free(search->model);
  strut_level_frame_free(&search->level);
  strut_arena_free(&search->out->arena);
}

/* The node that moved most from one shape to the other. */
static const char *farthest_node(const strut_equilibrium_search *search, const double *from,
                                 const double *to) {
  int32_t node = 0;
  double most = -1.0;
  for (int32_t i = 0; i < search->model->node_count; i++) {
    double moved = hypot(to[2 * i] - from[2 * i], to[2 * i + 1] - from[2 * i + 1]);
    if (moved > most) most = moved, node = i;
  }
  return search->level.scene.nodes[node].name;
}

/* Moves q (level coordinates) to where the structure comes to rest from it. */
static strut_status relax_to_rest(strut_equilibrium_search *search, const char *what,
                                  double *positions) {
  size_t length = (size_t)search->model->length;
  strut_relaxed relaxed;
  if (search->potential->n == 0) return STRUT_OK;
  const double *from = strut_arena_copy(&search->out->arena, positions, length, sizeof *positions);
  if (!from) return strut_no_memory(search->error, "");
  strut_status status = strut_relax_nearby(search->relaxer, positions,
                                           search->experiment->interrupt, &relaxed, search->error);
  if (status || relaxed.end == STRUT_RELAXED_RESTS) return status;
  return strut_fail(
      search->error, STRUT_NOT_SETTLED,
      relaxed.end == STRUT_RELAXED_LEAVES
          ? "from %s the structure moves away without end, %s farthest: nothing holds it there"
          : "from %s the structure does not come to rest within "
            "initial.settle.limit or 1e7 steps, having moved most at %s; give a "
            "larger limit, or more damping",
      what, farthest_node(search, from, positions));
}

/* True where q rests on one of the configuration's contact sets, in about its shape. */
static bool fits_configuration(strut_equilibrium_search *search,
                               const strut_configuration *configuration, const double *shape,
                               const double *positions, strut_node_set *rests_on) {
  strut_equilibrium e = {0};
  if (strut_equilibrium_search_contacts(search, positions, &e)) return false;
  *rests_on = (strut_node_set){(size_t)e.contact_count, e.contacts};
  return strut_rests_on_set(configuration, e.contacts, e.contact_count) &&
         strut_shape_distance(search->model, shape, positions, false, NULL) <
             STRUT_NAMED_WITHIN * search->model->size;
}

/*
 * Relaxes from the configuration's shape; *found: it stands there; else *rests_on has its contacts.
 */
static strut_status relax_from_shape(strut_equilibrium_search *search,
                                     const strut_configuration *configuration, double *positions,
                                     bool *found, strut_node_set *rests_on) {
  size_t nodes = search->level.scene.node_count;
  size_t length = (size_t)search->model->length;
  double *shape = strut_arena_allocate(&search->out->arena, length, sizeof *shape);
  if (!shape) return strut_no_memory(search->error, "");
  memcpy(shape, configuration->position[0], 2 * nodes * sizeof *shape);
  for (size_t i = 0; i < nodes; i++) /* held coordinates stay */
    for (size_t k = 0; k < 2; k++)
      if (search->level.scene.nodes[i].fixed[k])
        shape[2 * i + k] = search->level.scene.nodes[i].start[k];
  memcpy(positions, shape, length * sizeof *positions);
  strut_status status = relax_to_rest(search, "the configuration's shape", positions);
  if (status == STRUT_NOT_SETTLED) return STRUT_OK;
  *found = !status && fits_configuration(search, configuration, shape, positions, rests_on);
  return status;
}

/* The equilibrium of that name in the list that a search makes, into q. Where only standing ones are wanted: at rest. */
static strut_status find_named(const strut_model *model, const strut_experiment *experiment,
                               const strut_node_set *set, bool standing, const char *name,
                               double *positions, bool *found, strut_error *error) {
  strut_equilibria_options options = {
      .standing_only = standing, .supports = set, .interrupt = experiment->interrupt};
  strut_equilibria all;
  strut_status status = strut_equilibria_find(model, experiment, &options, &all, error);
  for (size_t i = 0; i < all.count && !status && !*found; i++) {
    const strut_equilibrium *equilibrium = &all.list[i];
    bool stands = equilibrium->outcome == STRUT_OUTCOME_STANDS && equilibrium->rest;
    if ((standing && !stands) || strcmp(equilibrium->name, name) != 0) continue;
    memcpy(positions, stands ? equilibrium->rest : equilibrium->point.q,
           (size_t)model->length * sizeof *positions);
    *found = true;
  }
  strut_equilibria_free(&all);
  return status;
}

/*
 * Searches on the configuration's contact sets in turn, else on all supports; q in original
 * coordinates.
 */
static strut_status search_configuration(const strut_model *model,
                                         const strut_experiment *experiment,
                                         const strut_configuration *configuration,
                                         double *positions, const strut_node_set *rests_on,
                                         strut_error *error) {
  bool found = false;
  strut_status status = STRUT_OK;
  for (size_t k = 0; k < configuration->set_count && !status && !found; k++)
    status = find_named(model, experiment,
                        configuration->sets[k].count == 2 ? &configuration->sets[k] : NULL, true,
                        configuration->name, positions, &found, error);
  if (!status && !found && configuration->set_count == 0)
    status =
        find_named(model, experiment, NULL, true, configuration->name, positions, &found, error);
  if (status || found) return status;
  strut_buffer instead = {0};
  for (size_t i = 0; i < rests_on->count; i++)
    strut_buffer_add(&instead, "%s%s", i ? ", " : "; from its shape it comes to rest on ",
                     model->scene->nodes[rests_on->node[i]].name);
  strut_fail(error, STRUT_NOT_SETTLED,
             "no equilibrium fits configuration '%.60s': none stands%s%s%.200s; 'strut equilibria' "
             "lists all",
             configuration->name, configuration->set_count ? " on its contacts" : "",
             configuration->shaped ? " near its shape" : "", instead.text ? instead.text : "");
  strut_release(instead.text);
  return STRUT_NOT_SETTLED;
}

static strut_status report_unknown(const strut_scene *scene, const char *name, strut_error *error) {
  strut_buffer names = {0};
  for (size_t i = 0; i < scene->configuration_count; i++)
    strut_buffer_add(&names, ", %s", scene->configurations[i].name);
  strut_fail(error, STRUT_USAGE,
             "unknown configuration '%.100s'; choose one of: start, drawn%.300s, or what 'strut "
             "equilibria' lists",
             name, names.text ? names.text : "");
  strut_release(names.text);
  return STRUT_USAGE;
}

/* The equilibrium of that name in the list that the scene's own search makes. */
static strut_status find_in_list(const strut_model *model, const strut_experiment *experiment,
                                 const char *name, strut_arena *arena, strut_rest_state *rest,
                                 strut_error *error) {
  bool found = false;
  strut_status status = find_named(model, experiment, NULL, false, name, rest->q, &found, error);
  rest->name = strut_arena_text(arena, name, strlen(name));
  if (!status && !rest->name) status = strut_no_memory(error, "");
  if (status || found) return status;
  return strut_fail(error, STRUT_USAGE,
                    "unknown equilibrium '%.100s'; 'strut equilibria' lists all", name);
}

/* *held: by friction alone. */
static strut_status find_rest(const strut_model *model, const strut_experiment *experiment,
                              const strut_configuration *configuration, double *positions,
                              bool *held, strut_error *error) {
  strut_equilibria scratch = {0};
  strut_equilibrium_search h = {.experiment = experiment, .out = &scratch, .error = error};
  strut_node_set rests_on = {0};
  strut_settle_summary how;
  strut_experiment kept = *experiment;
  kept.settle.friction = true;
  strut_status status = prepare_relaxation(&h, model);
  bool found = !configuration, turned = !h.held_by_friction;
  *held = h.held_by_friction;
  if (!status && !configuration && !turned)
    status = strut_settle_experiment(model, &kept, experiment->interrupt, positions, &how, error);
  else if (!status && !configuration) {
    memcpy(positions, h.model->start, (size_t)h.model->length * sizeof *positions);
    status = relax_to_rest(&h, "the scene's start", positions);
  }
  if (!status && configuration && configuration->shaped && turned)
    status = relax_from_shape(
        &h, &h.level.scene.configurations[configuration - model->scene->configurations], positions,
        &found, &rests_on);
  if (!status && !found) {
    turned = false;
    status = search_configuration(model, experiment, configuration, positions, &rests_on, error);
  }
  if (!status && turned) strut_level_frame_place(&h.level, (size_t)model->node_count, positions);
  free_search(&h);
  return status;
}

/*
 * Settles the scene as its run does. Friction, if kept, may hold a shape that is no equilibrium
 * without.
 */
static strut_status settle_scene(const strut_model *model, const strut_experiment *experiment,
                                 strut_arena *arena, strut_rest_state *rest, strut_error *error) {
  strut_status status = strut_settle_experiment(model, experiment, experiment->interrupt, rest->q,
                                                &rest->settle, error);
  if (!status) status = judge_rest(model, arena, rest, error);
  if (!experiment->settle.friction) rest->at_rest = true;
  return status;
}

strut_status strut_rest_state_find(const strut_model *model, const strut_experiment *experiment,
                                   const char *name, strut_arena *arena, strut_rest_state *rest,
                                   strut_error *error) {
  const strut_scene *scene = model->scene;
  const strut_configuration *configuration = NULL;
  bool start = !name || strcmp(name, "start") == 0, drawn = name && strcmp(name, "drawn") == 0;
  *rest = (strut_rest_state){.name = start ? "start" : "drawn"};
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(rest->q, model->length))) return strut_no_memory(error, "");
  if (name && (configuration = strut_configuration_named(scene, name)))
    start = drawn = false; /* a configuration has this name */
  if (!configuration && !start && !drawn) {
    if (!strut_is_listed_name(scene, name)) return report_unknown(scene, name, error);
    strut_status status = find_in_list(model, experiment, name, arena, rest, error);
    return status ? status : judge_rest(model, arena, rest, error);
  }
  if (!configuration && start && scene->start_equilibrium >= 0)
    configuration = &scene->configurations[scene->start_equilibrium];
  if (configuration) rest->name = configuration->name;
  if (drawn) {
    for (size_t i = 0; i < scene->node_count; i++)
      memcpy(rest->q + 2 * i, scene->nodes[i].position, sizeof scene->nodes[i].position);
    return judge_rest(model, arena, rest, error);
  }
  if (!configuration && experiment->settle.wanted && model->mass)
    return settle_scene(model, experiment, arena, rest, error);
  bool held = false;
  strut_status status = find_rest(model, experiment, configuration, rest->q, &held, error);
  if (!status) status = judge_rest(model, arena, rest, error);
  if (!held) rest->at_rest = true;
  return strut_experiment_end(experiment, status, error);
}

strut_status strut_resolve_start_equilibrium(strut_setup *setup, strut_error *error) {
  strut_scene *scene = &setup->scene;
  if (scene->start_equilibrium < 0) return STRUT_OK;
  const char *name = scene->configurations[scene->start_equilibrium].name;
  strut_model *model = NULL;
  strut_arena arena = {0};
  strut_rest_state rest;
  strut_status status = strut_model_compile(scene, &model, error);
  if (!status)
    status = strut_rest_state_find(model, &setup->experiment, name, &arena, &rest, error);
  for (size_t i = 0; i < scene->node_count && !status; i++)
    for (size_t c = 0; c < 2; c++)
      if (!scene->nodes[i].fixed[c]) scene->nodes[i].start[c] = rest.q[2 * i + c];
  if (!status) scene->start_equilibrium = -1;
  strut_arena_free(&arena);
  strut_model_free(model);
  return status;
}
