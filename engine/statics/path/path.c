/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parameter, start equilibrium and walk of a path. */
#include "engine/statics/path/path.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/text.h"
#include "engine/forces/capstan.h"
#include "engine/model/compile_parts.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/minimise.h"
#include "engine/statics/path/path_parts.h"

/* Residual that a descent may leave, relative to the rounding in forces; the path is corrected later. */
static const double NEARLY = 1e6;
static const double ALIKE = 1e-12; /* forces of several loads that count as one number */

#define NAME(KIND, text) text,

const char *strut_path_event_name(strut_path_event_kind kind) {
  static const char *const names[] = {STRUT_PATH_EVENTS(NAME)};
  return names[kind];
}

const char *strut_path_end_word(strut_path_end end) {
  static const char *const names[] = {STRUT_PATH_ENDS(NAME)};
  return names[end];
}

const char *strut_path_at(const strut_path_walk *walk, double value, char text[STRUT_PATH_TEXT]) {
  const char *unit = walk->path->unit;
  snprintf(text, STRUT_PATH_TEXT, "%.150s %.6g%s%.20s", strut_path_subject(walk), value,
           *unit ? " " : "", unit);
  return text;
}

void strut_path_remark_steps(strut_path_walk *walk, int32_t steps) {
  const strut_path *path = walk->path;
  if (path->end != STRUT_PATH_STEPS || path->point_count == 0) return;
  char at[STRUT_PATH_TEXT];
  snprintf(walk->path->remark, sizeof path->remark, "%d steps led to %s; --steps allows more",
           (int)steps, strut_path_at(walk, path->points[path->point_count - 1].at.factor, at));
}

static strut_status no_such_load(const strut_scene *scene, const char *name, strut_error *error) {
  strut_buffer list = {0};
  for (size_t i = 0; i < scene->load_count; i++)
    strut_buffer_add(&list, "%s%s", i ? ", " : "", scene->loads[i].name);
  strut_fail(error, STRUT_USAGE, "unknown load '%s'; the scene's loads are: %.400s", name,
             list.text ? list.text : "");
  strut_release(list.text);
  return STRUT_USAGE;
}

/* Is it one of the loads that the factor multiplies? */
static bool is_followed(const strut_load *load, const char *name) {
  return name ? strut_path_names_load(name, load->name) : load->signal < 0;
}

static size_t count_names(const char *names) {
  size_t count = 1;
  for (; *names; names++) count += *names == ',';
  return count;
}

/*
 * Adds the loads that the factor multiplies to `load`, and what they are at factor 1 to the path.
 */
static strut_status choose_loads(const strut_model *model, const char *name, double *load,
                                 strut_path *path, strut_error *error) {
  const strut_scene *scene = model->scene;
  bool acts = false, alike = true, zero = true;
  size_t count = 0;
  for (size_t i = 0; i < scene->load_count; i++) {
    const strut_load *l = &scene->loads[i];
    if (!is_followed(l, name)) continue;
    double size = hypot(l->force[0], l->force[1]);
    path->several = count > 0;
    alike = alike && (!count || fabs(size - path->reference) <= ALIKE * size);
    path->reference = size;
    zero = zero && size == 0 && l->moment == 0;
    alike = alike && !l->couple;
    count++;
    if (l->couple) load[model->length + strut_couple_slot(model, i)] = l->moment;
    acts = acts || l->moment != 0.0;
    for (int c = 0; c < 2 && !l->couple; c++) {
      int32_t at = 2 * l->node + c;
      load[at] += l->force[c];
      acts = acts || (load[at] != 0 && !scene->nodes[l->node].fixed[c]);
    }
  }
  if (!alike) path->reference = 0;
  if (name && scene->load_count && count != count_names(name))
    return no_such_load(scene, name, error);
  if (count && acts) return STRUT_OK;
  if (!count)
    return strut_fail(
        error, STRUT_USAGE,
        "the scene has no constant load to follow; give it one under 'loads', or follow "
        "something else (--over)");
  return strut_fail(error, STRUT_USAGE, "the load%s%s %s; there is no path to follow",
                    name ? " " : "", name ? name : "",
                    zero ? "is zero" : "acts on nothing that can move");
}

/* The start of a path. */
typedef struct path_start {
  const strut_path_options *options;
  const strut_model *drawn; /* the model that was given */
  strut_setup setup; /* where the parameter is `from`; its arena is its own only if `owned` */
  bool owned;
  strut_model *model; /* of that scene */
  double *load;       /* (length) loads at factor 1 [N], then (slots) moments [N m] */
  double *q;          /* (length) the equilibrium [m] */
  uint8_t *held;      /* (length) a free coordinate that is displaced; NULL without one */
  strut_arena arena;
} path_start;

/* Loads of the scene that is followed, at the factor that the path begins with. */
static bool scale_loads(path_start *self) {
  const strut_scene *drawn = self->drawn->scene;
  strut_load *loads = strut_arena_allocate(&self->arena, drawn->load_count, sizeof *loads);
  if (!loads) return false;
  self->setup.scene.loads = loads;
  for (size_t i = 0; i < drawn->load_count; i++) {
    loads[i] = drawn->loads[i];
    if (!is_followed(&loads[i], self->options->load)) continue;
    loads[i].signal = -1;
    strut_load_scale(&loads[i], self->options->from);
  }
  return true;
}

strut_status strut_path_set_actuator(const strut_model *drawn, int32_t actuator, double value,
                                     strut_arena *arena, strut_scene *scene, strut_error *error) {
  const strut_actuator *a = &scene->actuators[actuator];
  double rest = drawn->members.rest[strut_actuator_slot(drawn, (size_t)actuator)] + value;
  if (!STRUT_DUPLICATE(arena, STRUT_NEW(scene->cells, scene->cell_count),
                       STRUT_NEW(scene->hinges, scene->hinge_count),
                       STRUT_NEW(scene->members, scene->member_count)))
    return strut_no_memory(error, "");
  if (a->member < 0 && a->hinge < 0) scene->cells[a->cell].pressure = rest;
  if (a->member < 0 && a->hinge >= 0) scene->hinges[a->hinge].rest_angle = rest;
  if (a->member < 0) return STRUT_OK;
  strut_member *driven = &scene->members[a->member];
  driven->rest_kind = STRUT_REST_LENGTH;
  driven->rest_value = rest;
  bool axial = driven->axial_stiffness > 0;
  if (axial ? rest > 0 : rest >= 0) return STRUT_OK;
  return strut_fail(error, STRUT_USAGE, "the rest length of %s would be %s at the start",
                    driven->name, axial ? "zero or less" : "negative");
}

/* A support where the path begins. */
static bool move_support(path_start *self) {
  const strut_scene *drawn = self->drawn->scene;
  int32_t at = self->options->index;
  strut_node *nodes =
      strut_arena_copy(&self->arena, drawn->nodes, drawn->node_count, sizeof *nodes);
  if (!nodes) return false;
  self->setup.scene.nodes = nodes;
  if (nodes[at / 2].fixed[at % 2]) nodes[at / 2].start[at % 2] += self->options->from;
  return true;
}

/* Scene and model where the parameter is `from`. */
static strut_status make_model(path_start *self, strut_error *error) {
  const strut_path_options *options = self->options;
  strut_status status = STRUT_OK;
  bool made = true;
  self->setup.scene = *self->drawn->scene;
  if (options->over == STRUT_PATH_OVER_LOAD) made = scale_loads(self);
  if (options->over == STRUT_PATH_OVER_COORDINATE) made = move_support(self);
  if (options->over == STRUT_PATH_OVER_ACTUATOR)
    status = strut_path_set_actuator(self->drawn, options->index, options->from, &self->arena,
                                     &self->setup.scene, error);
  if (!made) return strut_no_memory(error, "");
  if (options->over == STRUT_PATH_OVER_SCENE) {
    status = options->scene_at(options->context, options->from, &self->setup, error);
    self->owned = status == STRUT_OK;
  }
  return status ? status : strut_model_compile(&self->setup.scene, &self->model, error);
}

/* Laws that fold go on from the piece, and cables that rub with the materials, that the path before left. */
static void recall(path_start *self) {
  const strut_path *after = self->options->after;
  const strut_element_table *elements = &self->model->elements;
  double *rest = strut_model_inputs_of(self->model).rest;
  for (int32_t i = 0; i < elements->count && after; i++) {
    const strut_element *element = &elements->element[i];
    if (element->law == STRUT_LAW_FOLDING)
      rest[element->slot + STRUT_CURVE_PIECE] = after->piece[i];
    for (int32_t k = 0; k + 1 < element->nodes && after->material && strut_has_capstan(element);
         k++)
      rest[element->slot + 1 + k] = after->material[element->slot + 1 + k];
  }
}

/* Descends from b->q to an equilibrium, with the `held` coordinates fixed. */
static strut_status descend_to_rest(const path_start *self, const uint8_t *held, bool without,
                                    strut_error *error) {
  strut_potential *potential = NULL;
  strut_minimiser *minimiser = NULL;
  strut_arena scratch = {0};
  const char *where = without ? "without the load" : "at the start of the path";
  strut_status status =
      strut_potential_create(self->model, held, true, &scratch, &potential, error);
  if (status == STRUT_OK && potential->n > 0)
    status = strut_minimiser_create(potential, &scratch, &minimiser, error);
  if (status == STRUT_OK && potential->n > 0) {
    strut_minimiser_watch(minimiser, self->setup.experiment.interrupt);
    strut_descent descent = strut_minimise(minimiser, self->q);
    if (descent.end == STRUT_DESCENT_RUNAWAY)
      status = strut_fail(error, STRUT_NOT_SETTLED,
                          "%s there is no equilibrium to start from: nothing holds the structure; "
                          "support it or give it a ground",
                          where);
    else if (descent.end == STRUT_DESCENT_EXHAUSTED && descent.residual > NEARLY * descent.rounding)
      status = strut_fail(error, STRUT_NOT_SETTLED,
                          "%s no equilibrium was found to start from: the residual is %.3g N",
                          where, descent.residual);
  }
  strut_arena_free(&scratch);
  return status;
}

/* The equilibrium of that name. Where friction is kept it may hold a shape that is none without it. */
static strut_status start_at_name(path_start *self, const char *name, strut_error *error) {
  strut_rest_state rest;
  strut_status status =
      strut_rest_state_find(self->model, &self->setup.experiment, name, &self->arena, &rest, error);
  if (status) return status;
  if (!rest.at_rest && !self->options->friction)
    return strut_fail(error, STRUT_NOT_SETTLED,
                      "'%.100s' is no equilibrium where the path starts: the residual is %.3g N",
                      rest.name, rest.residual);
  memcpy(self->q, rest.q, (size_t)self->model->length * sizeof *self->q);
  return STRUT_OK;
}

/* The equilibrium to begin at, in q. A free coordinate to be displaced is held from then on. */
static strut_status find_start(path_start *self, strut_error *error) {
  const strut_path_options *options = self->options;
  size_t length = (size_t)self->model->length;
  bool without = options->over == STRUT_PATH_OVER_LOAD && options->from == 0;
  const strut_settle *settle = &self->setup.experiment.settle;
  const char *at = options->at                                               ? options->at
                   : options->friction && settle->wanted && settle->friction ? "start"
                                                                             : NULL;
  memcpy(self->q, options->start ? options->start : self->model->start, length * sizeof *self->q);
  strut_status status = options->start ? STRUT_OK
                        : at           ? start_at_name(self, at, error)
                                       : descend_to_rest(self, NULL, without, error);
  if (status == STRUT_NOT_SETTLED && options->friction && !at)
    status = start_at_name(self, "start", error); /* friction alone may hold it */
  if (status || options->over != STRUT_PATH_OVER_COORDINATE || self->model->fixed[options->index])
    return status;
  self->held = strut_arena_allocate(&self->arena, length, sizeof *self->held);
  if (!self->held) return strut_no_memory(error, "");
  self->held[options->index] = 1;
  if (options->from == 0 || options->start) return STRUT_OK;
  self->q[options->index] += options->from;
  return descend_to_rest(self, self->held, false, error);
}

static strut_status list_held(const path_start *self, strut_path *path, strut_error *error) {
  size_t length = (size_t)self->model->length;
  uint8_t *held = strut_arena_allocate(&path->arena, length, sizeof *held);
  if (!held) return strut_no_memory(error, "");
  for (size_t i = 0; i < length; i++)
    held[i] = self->model->fixed[i] || (self->held && self->held[i]);
  path->held = held;
  return STRUT_OK;
}

static bool allocate_walk(strut_path_walk *walk) {
  if (!STRUT_NUMBERS(&walk->system.arena, 2 * (walk->system.n + 1), &walk->y, &walk->tangent,
                     &walk->next, &walk->next_tangent, &walk->trial, &walk->spare, &walk->upward,
                     &walk->fork, &walk->values, &walk->earlier_values, &walk->scale, &walk->first,
                     &walk->first_tangent, &walk->last, &walk->last_tangent, &walk->part.from,
                     &walk->part.tangent, &walk->part.to, &walk->beyond, &walk->check.whole.y,
                     &walk->check.whole.tangent, &walk->check.whole.end, &walk->check.inner.y,
                     &walk->check.inner.tangent, &walk->check.inner.end, &walk->check.y,
                     &walk->check.tangent, &walk->check.next_tangent) ||
      !STRUT_NUMBERS(&walk->system.arena, walk->system.model->length, &walk->settled))
    return false;
  walk->upward[walk->system.n] = 1.0;
  walk->step = 0.01;
  return true;
}

/* Room for bifurcations and the paths that leave them. */
static bool allocate_branches(strut_path_walk *walk) {
  walk->forks.fork =
      strut_arena_allocate(&walk->system.arena, STRUT_PATH_FORKS, sizeof *walk->forks.fork);
  walk->path->branches = strut_allocate(STRUT_PATH_BRANCHES, sizeof *walk->path->branches);
  return walk->forks.fork && walk->path->branches;
}

/* Takes the materials that the model remembers, if some cable rubs, and what slipped at the end of the path before,
    or NULL; false: out of memory. */
static bool create_guides(strut_path_system *system, const strut_path *after) {
  const strut_element_table *elements = &system->model->elements;
  size_t slots = (size_t)system->model->members.slots;
  bool some = false;
  for (int32_t i = 0; i < elements->count; i++)
    some = some || strut_has_capstan(&elements->element[i]);
  if (!some) return true;
  if (!STRUT_ALLOCATE(&system->arena, STRUT_NEW(system->elements.material, slots),
                      STRUT_NEW(system->elements.guide_mode, slots)))
    return false;
  memcpy(system->elements.material, system->model->members.rest, slots * sizeof(double));
  if (after && after->guide_mode)
    memcpy(system->elements.guide_mode, after->guide_mode, slots * sizeof *after->guide_mode);
  return true;
}

static strut_status create_walk(path_start *self, double until, strut_path_walk *walk,
                                strut_error *error) {
  strut_path_system *system = &walk->system;
  strut_status status = strut_path_system_create(self->model, self->held, system, error);
  if (status) return status;
  if (system->n > STRUT_PATH_COORDINATES)
    return strut_fail(error, STRUT_USAGE,
                      "the structure has %d free coordinates; paths are followed with up to %d",
                      (int)system->n, STRUT_PATH_COORDINATES);
  if (!allocate_walk(walk) || (self->options->branches > 0 && !allocate_branches(walk)))
    return strut_no_memory(error, "");
  system->parameter = (strut_path_parameter){.options = self->options,
                                             .model = self->model,
                                             .load = self->load,
                                             .from = self->options->from,
                                             .range = until - self->options->from};
  if (self->options->friction) {
    bool grips = strut_path_friction_create(system);
    if (!create_guides(system, self->options->after)) return strut_no_memory(error, "");
    walk->path->grips = grips || strut_path_has_rubbing(system);
  }
  return strut_path_parameter_create(&system->parameter, self->q, &system->arena, error);
}

/* Keeps on which piece of its law each element is, and materials between guides; false: out of memory. */
static bool keep_pieces(const strut_path_system *system, strut_path *path) {
  int32_t count = system->model->elements.count, slots = system->model->members.slots;
  int *piece = strut_arena_allocate(&path->arena, (size_t)count + 1, sizeof *piece);
  for (int32_t i = 0; i < count && piece; i++) piece[i] = system->elements.element[i].piece;
  path->piece = piece;
  if (!system->elements.material) return piece;
  path->material = system->elements.material, path->guide_mode = system->elements.guide_mode;
  return STRUT_DUPLICATE(&path->arena, STRUT_NEW(path->material, slots),
                         STRUT_NEW(path->guide_mode, slots)) &&
         piece;
}

/* Forces that are rounding beside the largest of the path become 0. */
static void drop_rounding(const strut_model *model, strut_path *path) {
  const double rounding = 1e-12;
  size_t contacts = (size_t)model->contacts.count;
  double largest = 0.0;
  for (size_t k = 0, all = path->point_count + path->event_count; k < 2 * all; k++) {
    strut_path_state *at = k % all < path->point_count
                               ? &path->points[k % all].at
                               : &path->events[k % all - path->point_count].at;
    const struct {
      double *force;
      size_t count;
    } lists[] = {{at->force, (size_t)model->members.count},
                 {at->distance, model->scene->distance_count},
                 {at->reaction, (size_t)model->length},
                 {at->contact, contacts},
                 {at->friction, contacts}};
    for (size_t l = 0; l < sizeof lists / sizeof *lists; l++)
      for (size_t i = 0; i < lists[l].count; i++)
        if (k < all)
          largest = fmax(largest, fabs(lists[l].force[i]));
        else if (fabs(lists[l].force[i]) <= rounding * largest)
          lists[l].force[i] = 0.0;
  }
}

/* How much of the path, or of its steps, is done. */
static double part_done(const strut_path *path, double until, int32_t step, int32_t steps) {
  double done = ((double)step + 1.0) / (double)steps;
  if (path->point_count < 2) return done;
  double from = path->points[0].at.factor, at = path->points[path->point_count - 1].at.factor;
  return fmin(1.0, fmax(done, (at - from) / (until - from)));
}

/* Descends from q to rest where the parameter has a value, with held coordinates where q has them. */
static bool settle_at(void *context, double value, double *q) {
  const path_start *start = context;
  strut_path_options options = *start->options;
  options.from = value;
  path_start there = {.options = &options, .drawn = start->drawn, .q = q};
  there.setup.experiment = start->setup.experiment;
  strut_error error;
  bool found = make_model(&there, &error) == STRUT_OK;
  found = found && descend_to_rest(&there, start->held, false, &error) == STRUT_OK;
  strut_model_free(there.model);
  if (there.owned) strut_setup_free(&there.setup);
  strut_arena_free(&there.arena);
  return found;
}

static strut_status walk_from(path_start *self, double until, int32_t steps, strut_path *path,
                              strut_error *error) {
  strut_path_walk w = {.path = path, .settle = settle_at, .settler = self};
  strut_status status = create_walk(self, until, &w, error);
  if (status == STRUT_OK) {
    strut_path_unplace(&w.system, self->q, w.y);
    path->end = STRUT_PATH_STEPS;
    bool on = strut_path_walk_begin(&w);
    for (int32_t i = 0; i < steps && on && !strut_experiment_interrupted(&self->setup.experiment);
         i++) {
      on = strut_path_walk_step(&w);
      strut_experiment_advance(&self->setup.experiment, part_done(path, until, i, steps));
    }
    strut_path_remark_steps(&w, steps);
    w.failed = w.failed || !keep_pieces(&w.system, path);
    if (w.forks.fork && path->point_count > 0)
      strut_path_walk_branches(&w, path, &self->setup.experiment);
    drop_rounding(self->model, path);
    if (!w.failed) strut_path_remark_idle(&w);
    for (size_t k = 0; k < path->branch_count; k++) drop_rounding(self->model, &path->branches[k]);
    if (w.system.drifts && path->point_count == 0)
      status = strut_fail(error, STRUT_NOT_SETTLED,
                          "nothing holds the structure against %s: it moves as a whole",
                          path->over == STRUT_PATH_OVER_LOAD ? "the load" : path->name);
    if (w.failed) status = strut_no_memory(error, "");
  }
  if (status == STRUT_OK && path->point_count == 0)
    status = strut_fail(
        error, STRUT_NOT_SETTLED,
        "the structure has no stiffness against %s at the start, so no path starts there",
        path->over == STRUT_PATH_OVER_LOAD ? "the load" : path->name);
  strut_path_system_free(&w.system);
  return status;
}

/* A longer range than this is a mistake: squares of it have no number. */
static const double LONGEST_RANGE = 1e100;

/* Unit of what the actuator drives. */
static const char *unit_of_drive(const strut_actuator *actuator) {
  return actuator->member >= 0 ? "m" : actuator->hinge >= 0 ? "rad" : "N/m";
}

/* Names the path's parameter for messages. */
static strut_status name_parameter(const strut_model *model, const strut_path_options *options,
                                   strut_path *path, strut_error *error) {
  const strut_scene *scene = model->scene;
  path->over = options->over;
  path->friction = options->friction;
  /* The names may be those of a call's options, which do not stay. */
  if (options->load)
    path->load = strut_arena_text(&path->arena, options->load, strlen(options->load));
  path->coordinate = options->over == STRUT_PATH_OVER_COORDINATE ? options->index : -1;
  path->unit = options->over == STRUT_PATH_OVER_LOAD    ? ""
               : options->over == STRUT_PATH_OVER_SCENE ? options->unit
               : options->over == STRUT_PATH_OVER_ACTUATOR
                   ? unit_of_drive(&scene->actuators[options->index])
                   : "m";
  if (options->over == STRUT_PATH_OVER_LOAD) path->name = options->load ? path->load : "all loads";
  if (options->over == STRUT_PATH_OVER_ACTUATOR) path->name = scene->actuators[options->index].name;
  if (options->over == STRUT_PATH_OVER_SCENE)
    path->name = strut_arena_text(&path->arena, options->name, strlen(options->name));
  if (options->over == STRUT_PATH_OVER_COORDINATE)
    path->name = strut_arena_format(&path->arena, "%s.%c", scene->nodes[options->index / 2].name,
                                    options->index % 2 ? 'y' : 'x');
  return path->name ? STRUT_OK : strut_no_memory(error, "");
}

/* Elements, unlike members, are computed with the digits that positions have. */
static const double FARTHEST = 1e4; /* sizes from the origin */

static strut_status check_place(const strut_model *model, strut_error *error) {
  double away = 0.0;
  for (int32_t i = 0; i < 2 * model->node_count; i++) away = fmax(away, fabs(model->start[i]));
  if (!model->elements.count || !(away > FARTHEST * model->size)) return STRUT_OK;
  return strut_fail(error, STRUT_NOT_SETTLED,
                    "the structure stands %.3g m from the origin, %.2g times its size, so that "
                    "rounding of positions may lead the path elsewhere; draw it nearer",
                    away, away / model->size);
}

strut_status strut_path_follow(const strut_model *model, const strut_experiment *experiment,
                               const strut_path_options *options, strut_path *path,
                               strut_error *error) {
  if (options->over == STRUT_PATH_OVER_ACTUATOR && model->scene->actuators[options->index].force)
    return strut_fail(error, STRUT_USAGE,
                      "actuator '%s' gives a force, which statics leaves out; follow a load, or an "
                      "actuator with a signal",
                      model->scene->actuators[options->index].name);
  strut_status place = check_place(model, error);
  if (place) return place;
  bool over_load = options->over == STRUT_PATH_OVER_LOAD;
  bool unsaid = over_load && options->until == 0 && options->from == 0;
  double until = unsaid ? 1.0 : options->until;
  int32_t steps = options->steps > 0 ? options->steps : STRUT_PATH_USUAL_STEPS;
  path_start b = {.options = options, .drawn = model, .setup.experiment = *experiment};
  *path = (strut_path){0};
  if (!(fabs(until - options->from) > 0))
    return strut_fail(error, STRUT_USAGE, "the path ends where it starts, at %.6g", until);
  if (!(fabs(until - options->from) < LONGEST_RANGE))
    return strut_fail(error, STRUT_USAGE, "the path's range from %g to %g is too large",
                      options->from, until);
  bool made = STRUT_ALLOCATE(&b.arena, STRUT_NEW(b.load, model->length + model->members.slots),
                             STRUT_NEW(b.q, model->length));
  strut_status status =
      made ? name_parameter(model, options, path, error) : strut_no_memory(error, "");
  if (status == STRUT_OK && over_load)
    status = choose_loads(model, options->load, b.load, path, error);
  if (status == STRUT_OK) status = make_model(&b, error);
  b.setup.experiment.interrupt = experiment->interrupt;
  if (status == STRUT_OK && b.model->length != model->length)
    status = strut_fail(error, STRUT_USAGE, "%s changes how many nodes there are", path->name);
  if (status == STRUT_OK) recall(&b);
  if (status == STRUT_OK) status = find_start(&b, error);
  if (status == STRUT_OK) status = list_held(&b, path, error);
  if (status == STRUT_OK) status = walk_from(&b, until, steps, path, error);
  strut_model_free(b.model);
  if (b.owned) strut_setup_free(&b.setup);
  strut_arena_free(&b.arena);
  return strut_experiment_end(experiment, status, error);
}

void strut_path_free(strut_path *path) {
  for (size_t i = 0; i < path->stage_count; i++) strut_path_free(&path->stages[i]);
  strut_release(path->stages);
  for (size_t i = 0; i < path->branch_count; i++) strut_path_free(&path->branches[i]);
  strut_release(path->branches);
  strut_release(path->points);
  strut_release(path->events);
  strut_arena_free(&path->arena);
  *path = (strut_path){0};
}
