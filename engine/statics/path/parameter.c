/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Built-in parameters are linear in one term; scenes are compiled anew, and their terms compared.
 */
#include "engine/statics/path/parameter.h"
#include "engine/model/element_compile.h"

#include <math.h>
#include <string.h>

static const double APART = 1e-5; /* of the range: values whose difference gives a derivative */

bool strut_path_terms_create(const strut_model *model, strut_arena *arena, strut_path_terms *t) {
  size_t length = (size_t)model->length, slots = (size_t)model->members.slots;
  t->stiffness = strut_arena_allocate(arena, slots, sizeof(double));
  t->rest = strut_arena_allocate(arena, slots, sizeof(double));
  t->rest_low = strut_arena_allocate(arena, slots, sizeof(double));
  t->position = strut_arena_allocate(arena, length, sizeof(double));
  t->position_low = strut_arena_allocate(arena, length, sizeof(double));
  t->force = strut_arena_allocate(arena, length, sizeof(double));
  t->ground = strut_arena_allocate(arena, (size_t)model->contacts.count, sizeof(double));
  return t->stiffness && t->rest && t->rest_low && t->position && t->position_low && t->force &&
         t->ground;
}

bool strut_path_has_line(const strut_model *model) {
  const strut_scene *scene = model->scene;
  const strut_surface *surface = model->contacts.surface;
  return !surface || (scene->ground_count == 1 && scene->grounds->shape == STRUT_GROUND_LINE &&
                      !surface->moves);
}

/* A scene at a value with its model, kept as long as laws of its elements are used. */
struct strut_path_scene {
  strut_setup setup;
  strut_model *model;
};

static void free_scene(struct strut_path_scene *scene) {
  if (!scene) return;
  strut_model_free(scene->model);
  strut_setup_free(&scene->setup);
  strut_release(scene);
}

void strut_path_terms_release(strut_path_terms *terms) {
  free_scene(terms->scene);
  terms->scene = NULL;
}

void strut_path_parameter_free(strut_path_parameter *p) {
  strut_path_terms_release(&p->base);
  strut_path_terms_release(&p->low);
  strut_path_terms_release(&p->high);
}

static void copy_terms(const strut_model *model, const strut_path_terms *from,
                       strut_path_terms *to) {
  size_t length = (size_t)model->length * sizeof(double);
  size_t slots = (size_t)model->members.slots * sizeof(double);
  memcpy(to->stiffness, from->stiffness, slots);
  memcpy(to->rest, from->rest, slots);
  memcpy(to->rest_low, from->rest_low, slots);
  memcpy(to->position, from->position, length);
  memcpy(to->position_low, from->position_low, length);
  memcpy(to->force, from->force, length);
  memcpy(to->ground, from->ground, (size_t)model->contacts.count * sizeof(double));
  memcpy(to->normal, from->normal, sizeof to->normal);
  memcpy(to->point, from->point, sizeof to->point);
  to->laws = from->laws;
}

static void read_terms(const strut_model *model, strut_path_terms *t) {
  const strut_contact_table *c = &model->contacts;
  size_t length = (size_t)model->length * sizeof(double);
  size_t slots = (size_t)model->members.slots * sizeof(double);
  memcpy(t->stiffness, model->members.stiffness, slots);
  memcpy(t->rest, model->members.rest, slots);
  memset(t->rest_low, 0, slots);
  memcpy(t->position, model->start, length);
  memset(t->position_low, 0, length);
  if (model->constant_force)
    memcpy(t->force, model->constant_force, length);
  else
    memset(t->force, 0, length);
  for (int32_t i = 0; i < c->count; i++) t->ground[i] = c->entry[i].stiffness;
  const double level[2] = {0.0, c->height};
  memcpy(t->normal, c->surface ? c->surface->facet->axes.normal : c->normal, sizeof t->normal);
  memcpy(t->point, c->surface ? c->surface->facet->point : level, sizeof t->point);
  t->laws = model;
}

/* The same elements: strains, laws and kinks, whatever their numbers. */
static bool are_elements_alike(const strut_element_table *a, const strut_element_table *b) {
  if (a->count != b->count) return false;
  for (int32_t i = 0; i < a->count; i++) {
    const strut_element *s = &a->element[i], *t = &b->element[i];
    if (s->strain != t->strain || s->law != t->law || s->role != t->role || s->item != t->item ||
        s->nodes != t->nodes || s->carries != t->carries || s->slot != t->slot ||
        strut_law_kinks(s->law, &s->numbers) != strut_law_kinks(t->law, &t->numbers) ||
        memcmp(a->at + s->first, b->at + t->first, (size_t)s->nodes * sizeof *a->at) != 0)
      return false;
  }
  return true;
}

/* Two models of one structure: the same members, elements, supports and contacts. */
static bool is_same_structure(const strut_model *a, const strut_model *b) {
  const strut_member_table *s = &a->members, *t = &b->members;
  if (a->node_count != b->node_count || a->length != b->length || s->count != t->count ||
      s->slots != t->slots || a->contacts.count != b->contacts.count || !strut_path_has_line(a) ||
      !strut_path_has_line(b))
    return false;
  for (int32_t j = 0; j < s->count; j++)
    if (s->from[j] != t->from[j] || s->to[j] != t->to[j] || s->slack[j] != t->slack[j])
      return false;
  for (int32_t i = 0; i < a->contacts.count; i++)
    if (a->contacts.at[i] != b->contacts.at[i]) return false;
  return memcmp(a->fixed, b->fixed, (size_t)a->length * sizeof *a->fixed) == 0 &&
         are_elements_alike(&a->elements, &b->elements);
}

/* Records why the scene is invalid at a value. */
static bool refuse_value(strut_path_parameter *p, double value, const strut_error *why) {
  p->refused_at = value;
  p->refusal = *why;
  return false;
}

static bool read_scene_terms(strut_path_parameter *p, double value, strut_path_terms *terms) {
  strut_error error = {0};
  struct strut_path_scene *scene = strut_allocate(1, sizeof *scene);
  if (!scene) {
    strut_no_memory(&error, "");
    return refuse_value(p, value, &error);
  }
  strut_status status = p->options->scene_at(p->options->context, value, &scene->setup, &error);
  if (status != STRUT_OK) {
    strut_release(scene);
    return refuse_value(p, value, &error);
  }
  status = strut_model_compile(&scene->setup.scene, &scene->model, &error);
  if (status == STRUT_OK && !is_same_structure(p->model, scene->model))
    status = strut_fail(&error, STRUT_USAGE,
                        "%s changes what the structure is made of (nodes, members, hinges, laws, "
                        "supports or contacts); a path needs the same structure throughout",
                        p->options->name);
  if (status == STRUT_OK) {
    read_terms(scene->model, terms);
    strut_path_terms_release(terms);
    if (scene->model->elements.count) {
      terms->scene = scene;
      return true;
    }
    terms->laws = p->model;
  }
  free_scene(scene);
  return status == STRUT_OK || refuse_value(p, value, &error);
}

bool strut_path_parameter_terms(strut_path_parameter *p, strut_dd value, strut_path_terms *t) {
  strut_dd change = dd_sub(value, dd_of(p->from));
  int32_t at = p->options->index;
  strut_error error = {0};
  if (p->options->over == STRUT_PATH_OVER_SCENE) return read_scene_terms(p, dd_double(value), t);
  copy_terms(p->model, &p->base, t);
  if (p->options->over == STRUT_PATH_OVER_LOAD) {
    for (int32_t i = 0; i < p->model->length; i++) t->force[i] += dd_double(change) * p->load[i];
  } else if (p->options->over == STRUT_PATH_OVER_ACTUATOR) {
    int32_t member = p->model->scene->actuators[at].member;
    int32_t slot = strut_actuator_slot(p->model, (size_t)at);
    strut_dd rest = dd_add(dd_of(p->base.rest[slot]), change);
    t->rest[slot] = rest.hi, t->rest_low[slot] = rest.lo;
    if (member >= 0 && rest.hi < 0) {
      strut_fail(&error, STRUT_BAD_SCENE, "the rest length of %s would be negative",
                 p->model->scene->members[member].name);
      return refuse_value(p, dd_double(value), &error);
    }
  } else {
    strut_dd place = dd_add(dd_of(p->base.position[at]), change);
    t->position[at] = place.hi, t->position_low[at] = place.lo;
  }
  return true;
}

static void divide_difference(const double *low, const double *high, double apart, size_t count,
                              double *rate) {
  for (size_t i = 0; i < count; i++) rate[i] = (high[i] - low[i]) / apart;
}

static bool difference_scenes(strut_path_parameter *p, double value, strut_path_terms *rates) {
  size_t length = (size_t)p->model->length, slots = (size_t)p->model->members.slots;
  double h = APART * fabs(p->range), low = value - h, high = value + h;
  strut_path_terms *a = &p->low, *b = &p->high;
  double refused_at = p->refused_at; /* what is refused beside a value does not refuse the value */
  strut_error refusal = p->refusal;
  if (!read_scene_terms(p, low, a)) {
    low = value;
    if (!read_scene_terms(p, low, a)) return false;
  }
  if (!read_scene_terms(p, high, b)) {
    high = value;
    if (low == high || !read_scene_terms(p, high, b)) return false;
  }
  p->refused_at = refused_at, p->refusal = refusal;
  double apart = p->apart = high - low;
  divide_difference(a->stiffness, b->stiffness, apart, slots, rates->stiffness);
  divide_difference(a->rest, b->rest, apart, slots, rates->rest);
  divide_difference(a->position, b->position, apart, length, rates->position);
  divide_difference(a->force, b->force, apart, length, rates->force);
  divide_difference(a->ground, b->ground, apart, (size_t)p->model->contacts.count, rates->ground);
  divide_difference(a->normal, b->normal, apart, 2, rates->normal);
  divide_difference(a->point, b->point, apart, 2, rates->point);
  return true;
}

/* The rates of a built-in parameter never change; the other entries of `rates` stay zero. */
bool strut_path_parameter_rates(strut_path_parameter *p, double value, strut_path_terms *rates) {
  int32_t at = p->options->index;
  switch (p->options->over) {
    case STRUT_PATH_OVER_SCENE: return difference_scenes(p, value, rates);
    case STRUT_PATH_OVER_LOAD:
      memcpy(rates->force, p->load, (size_t)p->model->length * sizeof(double));
      return true;
    case STRUT_PATH_OVER_ACTUATOR:
      rates->rest[strut_actuator_slot(p->model, (size_t)at)] = 1;
      return true;
    case STRUT_PATH_OVER_COORDINATE: rates->position[at] = 1; return true;
  }
  return false;
}

static bool is_equal(const double *a, const double *b, size_t count) {
  return memcmp(a, b, count * sizeof *a) == 0;
}

/* Do the elements' laws have other numbers? */
static bool are_laws_different(const strut_element_table *a, const strut_element_table *b) {
  for (int32_t i = 0; i < a->count; i++) {
    const strut_element *s = &a->element[i], *t = &b->element[i];
    const strut_law_numbers *m = &s->numbers, *n = &t->numbers;
    bool numbers = m->stiffness != n->stiffness || m->count != n->count || m->area != n->area ||
                   m->exponent != n->exponent || m->outside != n->outside;
#define STRUT_LAW_ROW(NAME, field, ...) numbers = numbers || m->field != n->field;
    STRUT_LAW_PARAMETERS(STRUT_LAW_ROW)
#undef STRUT_LAW_ROW
    if (numbers || s->natural != t->natural) return true;
    if (m->count && !is_equal(m->coefficient, n->coefficient, m->count)) return true;
    if (m->curve &&
        (m->curve->count != n->curve->count ||
         !is_equal(m->curve->x, n->curve->x, m->curve->count) ||
         !is_equal(&m->curve->piece[0][0], &n->curve->piece[0][0], 4 * (m->curve->count - 1))))
      return true;
  }
  return false;
}

/* True if the terms differ in equilibrium; positions matter only where they are held. */
static bool is_different(const strut_model *model, const strut_path_terms *a,
                         const strut_path_terms *b) {
  size_t slots = (size_t)model->members.slots;
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    if (model->fixed[i] ? a->position[i] != b->position[i] : a->force[i] != b->force[i])
      return true;
  return are_laws_different(&a->laws->elements, &b->laws->elements) ||
         !is_equal(a->stiffness, b->stiffness, slots) || !is_equal(a->rest, b->rest, slots) ||
         !is_equal(a->ground, b->ground, (size_t)model->contacts.count) ||
         !is_equal(a->normal, b->normal, 2) || !is_equal(a->point, b->point, 2);
}

/* Checks that a scene's number has an effect and does not change the structure. */
static strut_status check_effect(strut_path_parameter *p, strut_error *error) {
  static const double places[] = {1e-3, 0.37, 1.0};
  if (p->options->over != STRUT_PATH_OVER_SCENE) return STRUT_OK;
  if (!read_scene_terms(p, p->from, &p->base))
    return strut_fail(error, p->refusal.status, "%s", p->refusal.message);
  for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
    bool valid = read_scene_terms(p, p->from + places[i] * p->range, &p->low);
    strut_error why = p->refusal;
    p->refusal = (strut_error){0};
    if (!valid && (why.status == STRUT_USAGE || why.status == STRUT_NO_MEMORY))
      return strut_fail(error, why.status, "%s", why.message);
    if (!valid || is_different(p->model, &p->base, &p->low)) return STRUT_OK;
  }
  return strut_fail(error, STRUT_USAGE,
                    "%s changes nothing that matters at rest: no stiffness, rest length, support, "
                    "load or ground; there is no path to follow",
                    p->options->name);
}

strut_status strut_path_parameter_create(const strut_model *model,
                                         const strut_path_options *options, const double *load,
                                         double from, double until, const double *position,
                                         strut_arena *arena, strut_path_parameter *p,
                                         strut_error *error) {
  *p = (strut_path_parameter){
      .options = options, .model = model, .load = load, .from = from, .range = until - from};
  if (!strut_path_terms_create(model, arena, &p->base) ||
      !strut_path_terms_create(model, arena, &p->low) ||
      !strut_path_terms_create(model, arena, &p->high))
    return strut_no_memory(error, "");
  read_terms(model, &p->base);
  memcpy(p->base.position, position, (size_t)model->length * sizeof *position);
  return check_effect(p, error);
}
