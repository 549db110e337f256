/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which way, and what every way ends with: a polished start, proof of stability, a run. */
#include "engine/statics/form/form.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/statics/form/parts.h"
#include "engine/statics/minimise.h"

static const double STABLE = 0.02;    /* of the size: what an equilibrium may move on being left */
static const double NEARLY = 1e3;     /* of the rounding in forces: what a descent may leave */
static const double STEP_SHARE = 0.7; /* of the largest stable step */
static const double HOLD = 10.0;      /* duration of an added run [s] */
static const double MEET = 1e-9;      /* nodes this near are in one place [largest extent] */
static const double LARGEST_SIZE = 1e100; /* [m]: sums of squares of it are numbers */
static const double LEAST_STEP = 1e-300;  /* [s] */
static const double IDLE_STEP = 1e-3;     /* step where nothing limits it [s] */

const char *strut_form_source_name(strut_form_source source) {
  static const char *const names[] = {"scene", "densities", "lengths", "prestress"};
  return names[source];
}

static strut_form_source choose(const strut_scene *scene, strut_form_source wanted) {
  bool density = false, length = false;
  for (size_t j = 0; j < scene->member_count; j++) {
    density = density || scene->members[j].rest_kind == STRUT_REST_FORCE_DENSITY;
    length = length || scene->members[j].rest_kind == STRUT_REST_LENGTH;
  }
  if (wanted != STRUT_FORM_BY_SCENE) return wanted;
  return density ? STRUT_FORM_DENSITIES : length ? STRUT_FORM_LENGTHS : STRUT_FORM_PRESTRESS;
}

/* The start of a scene that has just got a form; what would move it is not wanted. */
static void quieten(strut_scene *scene, strut_experiment *experiment) {
  for (size_t i = 0; i < scene->node_count; i++)
    scene->nodes[i].velocity[0] = scene->nodes[i].velocity[1] = 0.0;
  experiment->settle.wanted = false;
  scene->start_equilibrium = -1;
}

/* A shape may have put a member's ends in one place, where it has no direction and no strain. */
static strut_status check_lengths(const strut_former *f, strut_error *error) {
  const strut_scene *scene = f->scene;
  for (size_t j = 0; j < scene->member_count; j++) {
    const strut_member *m = &scene->members[j];
    const strut_node *a = &scene->nodes[m->node[0]], *b = &scene->nodes[m->node[1]];
    strut_rest rest;
    bool apart = strut_distance(a->start, b->start) > MEET * f->size;
    if (strut_member_rest(scene, j, &rest) && (apart || f->form->from != STRUT_FORM_DENSITIES))
      continue;
    return strut_fail(error, STRUT_NOT_SETTLED,
                      "in this form nodes '%s' and '%s', the ends of '%s', lie in one place; "
                      "other densities or supports keep them apart",
                      a->name, b->name, m->name);
  }
  return STRUT_OK;
}

/* Rest lengths as lengths: said in other ways they would change with the drawn shape. */
static void fix_lengths(strut_scene *scene) {
  for (size_t j = 0; j < scene->member_count; j++) {
    strut_rest rest;
    strut_member *m = &scene->members[j];
    if (m->rest_kind == STRUT_REST_LENGTH || !strut_member_rest(scene, j, &rest)) continue;
    m->rest_kind = STRUT_REST_LENGTH;
    m->rest_value = rest.length;
  }
}

/* May the structure be shifted along x, and turned and shifted at will, without meeting anything? */
static void find_freedom(const strut_former *f, bool *shift, bool *turn) {
  const strut_contact_table *c = &f->model->contacts;
  *shift = c->count == 0 || c->normal[0] == 0;
  *turn = c->count == 0;
  for (size_t i = 0; i < f->scene->node_count; i++) {
    if (f->scene->nodes[i].fixed[0]) *shift = *turn = false;
    if (f->scene->nodes[i].fixed[1]) *turn = false;
  }
}

/* Where nothing holds the whole, it may have drifted on its way: back to where it started. */
static bool lay_back(const strut_former *f, double *q) {
  const strut_scene *scene = f->scene;
  double n = (double)scene->node_count, from[2] = {0}, to[2] = {0}, cosine = 0, sine = 0;
  bool shift, turn;
  find_freedom(f, &shift, &turn);
  for (size_t i = 0; i < 2 * scene->node_count; i++)
    from[i % 2] += q[i] / n, to[i % 2] += scene->nodes[i / 2].start[i % 2] / n;
  for (size_t i = 0; i < scene->node_count; i++) {
    double a[2] = {q[2 * i] - from[0], q[2 * i + 1] - from[1]};
    double b[2] = {scene->nodes[i].start[0] - to[0], scene->nodes[i].start[1] - to[1]};
    cosine += a[0] * b[0] + a[1] * b[1], sine += a[0] * b[1] - a[1] * b[0];
  }
  double size = hypot(cosine, sine);
  if (!shift || !(size > 0)) return false;
  if (!turn) cosine = size, sine = 0, to[1] = from[1];
  for (size_t i = 0; i < scene->node_count; i++) {
    double a[2] = {q[2 * i] - from[0], q[2 * i + 1] - from[1]};
    q[2 * i] = to[0] + (cosine * a[0] - sine * a[1]) / size;
    q[2 * i + 1] = to[1] + (sine * a[0] + cosine * a[1]) / size;
  }
  return true;
}

/* Whichever node moved most between the start and q; how far. */
static double farthest(const strut_scene *scene, const double *q, size_t *node) {
  double most = -1;
  for (size_t i = 0; i < scene->node_count; i++) {
    double moved = strut_distance(scene->nodes[i].start, q + 2 * i);
    if (moved > most) most = moved, *node = i;
  }
  return most;
}

static strut_status judge(const strut_former *f, const strut_descent *d, const double *q,
                          strut_error *error) {
  size_t node = 0;
  bool finite = isfinite(d->residual);
  for (size_t i = 0; i < 2 * f->scene->node_count; i++) finite = finite && isfinite(q[i]);
  if (!finite) return strut_form_out_of_range(error);
  double moved = farthest(f->scene, q, &node);
  const char *name = f->scene->nodes[node].name;
  if (d->end == STRUT_DESCENT_RUNAWAY)
    return strut_fail(error, STRUT_NOT_SETTLED,
                      "nothing holds the structure: %s moves away without end; support it", name);
  if (d->end == STRUT_DESCENT_EXHAUSTED && !(d->residual <= NEARLY * d->rounding))
    return strut_fail(error, STRUT_NOT_SETTLED,
                      "the structure does not come to rest: %.3g N are left, and %s still moves",
                      d->residual, name);
  if (f->form->from != STRUT_FORM_LENGTHS && moved > STABLE * f->size)
    return strut_fail(error, STRUT_NOT_SETTLED,
                      "the equilibrium found is not stable: left to itself, %s moves by %.3g m; "
                      "more tension (--least-tension) or stiffer members may hold it",
                      name, moved);
  return STRUT_OK;
}

/* Lets the structure come to rest from its start, to the last bits; a form by lengths is that. */
static strut_status polish(strut_former *f, strut_error *error) {
  strut_model *model = NULL;
  strut_potential *potential = NULL;
  strut_minimiser *minimiser = NULL;
  double *q = NULL;
  strut_scene *scene = f->scene;
  strut_status status = strut_model_compile(scene, &model, error);
  if (status == STRUT_OK) status = strut_potential_create(model, NULL, true, &potential, error);
  if (status == STRUT_OK) status = strut_minimiser_create(potential, &minimiser, error);
  if (status == STRUT_OK) q = strut_arena_allocate(&f->arena, (size_t)model->length, sizeof *q);
  if (status == STRUT_OK && !q) status = strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  if (status == STRUT_OK) {
    memcpy(q, model->start, (size_t)model->length * sizeof *q);
    strut_descent descent = strut_minimise(minimiser, q, 0.0);
    if (descent.end != STRUT_DESCENT_RUNAWAY && lay_back(f, q))
      descent = strut_polish(minimiser, q, 0.0);
    f->form->residual = descent.residual;
    status = judge(f, &descent, q, error);
  }
  for (size_t i = 0; i < scene->node_count && status == STRUT_OK; i++)
    for (size_t c = 0; c < 2; c++) {
      scene->nodes[i].start[c] = q[2 * i + c];
      if (f->form->from == STRUT_FORM_LENGTHS) scene->nodes[i].position[c] = q[2 * i + c];
    }
  strut_minimiser_free(minimiser);
  strut_potential_free(potential);
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
static strut_status add_run(strut_former *f, strut_error *error) {
  strut_experiment *e = f->experiment;
  strut_model *model = NULL;
  strut_step_limit limit = {0};
  strut_status status = strut_model_compile(f->scene, &model, error);
  f->form->massless = status == STRUT_OK && !model->mass;
  if (status == STRUT_OK && model->mass) {
    status = strut_step_limit_estimate(model, &limit, error);
    if (status == STRUT_OK && !(limit.limit > LEAST_STEP))
      status = strut_fail(error, STRUT_BAD_SCENE,
                          "stiffnesses are so large beside the masses that no step can be given; "
                          "check their units");
    f->form->run_added = e->step == 0 || (e->duration == 0 && e->periods == 0);
    if (status == STRUT_OK && (e->step == 0 || e->step > limit.limit))
      e->step = isfinite(limit.limit) ? round_down(STEP_SHARE * limit.limit) : IDLE_STEP;
    if (e->duration == 0 && e->periods == 0) e->duration = HOLD;
  }
  strut_model_free(model);
  return status;
}

static strut_status find(strut_former *f, strut_error *error) {
  strut_scene *scene = f->scene;
  strut_status status = STRUT_OK;
  if (f->form->from == STRUT_FORM_DENSITIES) status = strut_form_densities(f, error);
  if (f->form->from == STRUT_FORM_PRESTRESS) status = strut_form_prestress(f, error);
  if (status != STRUT_OK) return status;
  fix_lengths(scene);
  quieten(scene, f->experiment);
  status = check_lengths(f, error);
  if (status == STRUT_OK) status = polish(f, error);
  return status == STRUT_OK ? add_run(f, error) : status;
}

/* How far every node was drawn from where it is now. */
static double moved_from(const double *drawn, const strut_scene *scene) {
  double most = 0;
  for (size_t i = 0; i < scene->node_count; i++)
    most = fmax(most, hypot(scene->nodes[i].position[0] - drawn[2 * i],
                            scene->nodes[i].position[1] - drawn[2 * i + 1]));
  return most;
}

/* Shapes drawn for another form mean nothing now. */
static void drop_shapes(strut_scene *scene) {
  for (size_t i = 0; i < scene->configuration_count; i++) {
    strut_configuration *c = &scene->configurations[i];
    for (size_t k = 0; k < scene->node_count && c->position; k++)
      memcpy(c->position[k], scene->nodes[k].position, sizeof c->position[k]);
    c->shaped = c->set_count == 0;
  }
}

strut_status strut_form_find(strut_setup *setup, const strut_form_options *options,
                             strut_form *form, strut_error *error) {
  strut_scene *scene = &setup->scene;
  strut_model *model = NULL;
  strut_potential *potential = NULL;
  *form = (strut_form){.from = choose(scene, options->from)};
  strut_former f = {
      .scene = scene, .experiment = &setup->experiment, .options = options, .form = form};
  double *drawn = strut_arena_allocate(&f.arena, 2 * scene->node_count, sizeof *drawn);
  strut_status status = drawn ? strut_model_compile(scene, &model, error)
                              : strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  if (status == STRUT_OK) status = strut_potential_create(model, NULL, true, &potential, error);
  if (status == STRUT_OK) {
    for (size_t i = 0; i < 2 * scene->node_count; i++)
      drawn[i] = scene->nodes[i / 2].position[i % 2];
    f.model = model, f.potential = potential;
    f.size = model->size > 0 ? model->size : 1.0;
    if (f.size > LARGEST_SIZE)
      status = strut_fail(error, STRUT_BAD_SCENE,
                          "the drawn shape is %.3g m large, too large to compute with; check its "
                          "units",
                          f.size);
    form->driven = scene->actuator_count > 0 || model->loads.count > 0;
    if (status == STRUT_OK) status = find(&f, error);
  }
  if (status == STRUT_OK) {
    form->moved = moved_from(drawn, scene);
    if (form->moved > 0) drop_shapes(scene);
  }
  strut_potential_free(potential);
  strut_model_free(model);
  strut_arena_free(&f.arena);
  return status;
}
