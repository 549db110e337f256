/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Built-in parameters are linear in one term; scenes are compiled anew, and their terms compared.
 */
#include "engine/statics/path/path_parts.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/model/compile_parts.h"

static const double VALUE_STEP =
    1e-5; /* of the range: values whose difference gives a derivative */

/* Numbers of some terms, one after the other from `stiffness` on. */
static size_t count_terms(const strut_model *model) {
  return 3 * ((size_t)model->members.slots + (size_t)model->length);
}

bool strut_path_terms_create(const strut_model *model, strut_arena *arena, strut_path_terms *t) {
  size_t length = (size_t)model->length, slots = (size_t)model->members.slots;
  t->stiffness = strut_arena_allocate(arena, count_terms(model), sizeof(double));
  if (!t->stiffness) return false;
  t->rest = t->stiffness + slots, t->rest_low = t->rest + slots;
  t->position = t->rest_low + slots, t->position_low = t->position + length;
  t->force = t->position_low + length;
  return true;
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
  memcpy(to->stiffness, from->stiffness, count_terms(model) * sizeof *to->stiffness);
  to->laws = from->laws;
}

static void read_terms(const strut_model *model, strut_path_terms *t) {
  size_t length = (size_t)model->length * sizeof(double);
  size_t slots = (size_t)model->members.slots * sizeof(double);
  memset(t->stiffness, 0, count_terms(model) * sizeof *t->stiffness);
  memcpy(t->stiffness, model->members.stiffness, slots);
  memcpy(t->rest, model->members.rest, slots);
  memcpy(t->position, model->start, length);
  if (model->constant_force) memcpy(t->force, model->constant_force, length);
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

static bool is_equal(const double *a, const double *b, size_t count) {
  return memcmp(a, b, count * sizeof *a) == 0;
}

/* The same contacts, with surfaces of as many facets. */
static bool are_grounds_alike(const strut_contact_table *a, const strut_contact_table *b) {
  if (a->count != b->count || a->surfaces != b->surfaces || !a->surface != !b->surface)
    return false;
  for (int32_t k = 0; k < a->surfaces; k++)
    if (a->surface[k].facets != b->surface[k].facets) return false;
  for (int32_t i = 0; i < a->count; i++)
    if (a->at[i] != b->at[i] || (a->surface && a->surface_of[i] != b->surface_of[i])) return false;
  return true;
}

/* Do alike grounds lie elsewhere? */
static bool are_grounds_moved(const strut_contact_table *a, const strut_contact_table *b) {
  if (!is_equal(a->normal, b->normal, 2) || a->height != b->height) return true;
  for (int32_t k = 0; k < a->surfaces; k++) {
    const strut_surface *s = &a->surface[k], *t = &b->surface[k];
    if (!is_equal(s->centre, t->centre, 2) || s->radius != t->radius) return true;
    for (int32_t f = 0; f < s->facets; f++)
      if (!is_equal(s->facet[f].point, t->facet[f].point, 2) ||
          !is_equal(s->facet[f].axes.normal, t->facet[f].axes.normal, 2))
        return true;
  }
  return false;
}

/* Have alike contacts another stiffness, or, where it is kept, another friction? */
static bool are_contacts_different(const strut_contact_table *a, const strut_contact_table *b,
                                   bool friction) {
  for (int32_t i = 0; i < a->count; i++) {
    const strut_friction *s = &a->entry[i].friction, *t = &b->entry[i].friction;
    bool other = s->mu_static != t->mu_static || s->mu_kinetic != t->mu_kinetic ||
                 s->mu_static_backward != t->mu_static_backward ||
                 s->mu_kinetic_backward != t->mu_kinetic_backward;
    if (a->entry[i].stiffness != b->entry[i].stiffness || (friction && other)) return true;
  }
  return false;
}

/* Two models of one structure: the same members, elements, supports and contacts. */
static bool is_same_structure(const strut_model *a, const strut_model *b) {
  const strut_member_table *s = &a->members, *t = &b->members;
  if (a->node_count != b->node_count || a->length != b->length || s->count != t->count ||
      s->slots != t->slots || !are_grounds_alike(&a->contacts, &b->contacts))
    return false;
  for (int32_t j = 0; j < s->count; j++)
    if (s->from[j] != t->from[j] || s->to[j] != t->to[j] || s->slack[j] != t->slack[j])
      return false;
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
  if (status == STRUT_OK && p->options->friction &&
      are_grounds_moved(&p->model->contacts, &scene->model->contacts))
    status = strut_fail(&error, STRUT_USAGE,
                        "%s moves the ground, and friction is kept, which needs a ground at rest; "
                        "move the structure or turn its loads, or leave friction out",
                        p->options->name);
  if (status == STRUT_OK) {
    read_terms(scene->model, terms);
    strut_path_terms_release(terms);
    terms->scene = scene;
    return true;
  }
  free_scene(scene);
  return refuse_value(p, value, &error);
}

/* Elements with memory have slots of their own, which follow that of what is driven. */
static void follow_slot(const strut_model *model, int32_t slot, double *rest) {
  for (int32_t m = 0; m < model->elements.history_count; m++) {
    const strut_element *e = &model->elements.element[model->elements.memory[m]];
    if (e->base == slot) rest[e->slot] = rest[slot];
  }
}

bool strut_path_parameter_terms(strut_path_parameter *p, strut_dd value, strut_path_terms *t) {
  strut_dd change = dd_sub(value, dd_of(p->from));
  int32_t at = p->options->index;
  strut_error error = {0};
  if (p->options->over == STRUT_PATH_OVER_SCENE) return read_scene_terms(p, dd_double(value), t);
  copy_terms(p->model, &p->base, t);
  if (p->options->over == STRUT_PATH_OVER_LOAD) {
    const double *moment = p->load + p->model->length;
    for (int32_t i = 0; i < p->model->length; i++) t->force[i] += dd_double(change) * p->load[i];
    for (int32_t i = 0; i < p->model->members.slots; i++)
      t->rest[i] += dd_double(change) * moment[i];
  } else if (p->options->over == STRUT_PATH_OVER_ACTUATOR) {
    int32_t member = p->model->scene->actuators[at].member;
    int32_t slot = strut_actuator_slot(p->model, (size_t)at);
    strut_dd rest = dd_add(dd_of(p->base.rest[slot]), change);
    t->rest[slot] = rest.hi, t->rest_low[slot] = rest.lo;
    follow_slot(p->model, slot, t->rest);
    bool axial = member >= 0 && p->model->scene->members[member].axial_stiffness > 0.0;
    double least = axial ? STRUT_AXIAL_LEAST * p->model->members.rest[slot] : 0.0;
    if (member >= 0 && rest.hi < least) {
      strut_fail(&error, STRUT_BAD_SCENE, "the rest length of %s would %s",
                 p->model->scene->members[member].name, axial ? "reach zero" : "be negative");
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
  double h = VALUE_STEP * fabs(p->range), low = value - h, high = value + h;
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
  return true;
}

/* The rates of a built-in parameter never change; the other entries of `rates` stay zero. */
bool strut_path_parameter_rates(strut_path_parameter *p, double value, strut_path_terms *rates) {
  int32_t at = p->options->index;
  switch (p->options->over) {
    case STRUT_PATH_OVER_SCENE: return difference_scenes(p, value, rates);
    case STRUT_PATH_OVER_LOAD:
      memcpy(rates->force, p->load, (size_t)p->model->length * sizeof(double));
      memcpy(rates->rest, p->load + p->model->length,
             (size_t)p->model->members.slots * sizeof(double));
      return true;
    case STRUT_PATH_OVER_ACTUATOR:
      rates->rest[strut_actuator_slot(p->model, (size_t)at)] = 1;
      follow_slot(p->model, strut_actuator_slot(p->model, (size_t)at), rates->rest);
      return true;
    case STRUT_PATH_OVER_COORDINATE: rates->position[at] = 1; return true;
  }
  return false;
}

/* Do the elements' laws have other numbers? */
static bool are_laws_different(const strut_element_table *a, const strut_element_table *b) {
  for (int32_t i = 0; i < a->count; i++) {
    const strut_element *s = &a->element[i], *t = &b->element[i];
    const strut_law_numbers *m = &s->numbers, *n = &t->numbers;
    bool numbers = m->stiffness != n->stiffness || m->count != n->count || m->area != n->area ||
                   m->exponent != n->exponent || m->outside != n->outside || m->axial != n->axial;
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
                         const strut_path_terms *b, bool friction) {
  size_t slots = (size_t)model->members.slots;
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    if (model->fixed[i] ? a->position[i] != b->position[i] : a->force[i] != b->force[i])
      return true;
  return are_laws_different(&a->laws->elements, &b->laws->elements) ||
         are_grounds_moved(&a->laws->contacts, &b->laws->contacts) ||
         are_contacts_different(&a->laws->contacts, &b->laws->contacts, friction) ||
         !is_equal(a->stiffness, b->stiffness, slots) || !is_equal(a->rest, b->rest, slots);
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
    if (!valid || is_different(p->model, &p->base, &p->low, p->options->friction)) return STRUT_OK;
  }
  return strut_fail(error, STRUT_USAGE,
                    "%s changes nothing that matters at rest: no stiffness, rest length, support, "
                    "load or ground; there is no path to follow",
                    p->options->name);
}

strut_status strut_path_parameter_create(strut_path_parameter *p, const double *position,
                                         strut_arena *arena, strut_error *error) {
  const strut_model *model = p->model;
  if (!strut_path_terms_create(model, arena, &p->base) ||
      !strut_path_terms_create(model, arena, &p->low) ||
      !strut_path_terms_create(model, arena, &p->high))
    return strut_no_memory(error, "");
  read_terms(model, &p->base);
  memcpy(p->base.position, position, (size_t)model->length * sizeof *position);
  return check_effect(p, error);
}

static const double STRAIN_STEP =
    1e-5; /* relative: natural strains whose difference gives a derivative */

/* A kink that matters: it lies where the element can act. */
static bool is_kink_felt(const strut_element *e, double kink) {
  return !e->carries || e->carries * kink > 0.0;
}

static int32_t count_switches(const strut_element_table *t) {
  int32_t count = 0;
  for (int32_t i = 0; i < t->count; i++)
    count +=
        (t->element[i].carries != 0) + strut_law_kinks(t->element[i].law, &t->element[i].numbers);
  return count;
}

bool strut_path_elements_create(const strut_model *model, strut_arena *arena,
                                strut_path_elements *p) {
  const strut_element_table *t = &model->elements;
  *p = (strut_path_elements){0};
  if (t->count == 0) return true;
  p->element = strut_arena_allocate(arena, (size_t)t->count, sizeof *p->element);
  p->switches = strut_arena_allocate(arena, (size_t)count_switches(t) + 1, sizeof *p->switches);
  if (!p->element || !p->switches) return false;
  for (int32_t i = 0; i < t->count; i++) {
    const strut_element *e = &t->element[i];
    int kinks = strut_law_kinks(e->law, &e->numbers);
    p->element[i] = (strut_path_element){.turn = (double)NAN, .acts = true};
    p->noise = fmax(p->noise, DBL_EPSILON * strut_force_stiffest(model, model->members.count + i));
    if (e->carries) p->switches[p->switch_count++] = (strut_path_element_switch){i, -1};
    for (int k = 0; k < kinks; k++) {
      double kink = strut_law_kink(e->law, &e->numbers, k);
      bool folds = e->law == STRUT_LAW_FOLDING;
      p->switches[p->switch_count++] = (strut_path_element_switch){i, k};
      p->element[i].piece += !folds && !is_kink_felt(e, kink) && kink <= 0.0; /* always above it */
    }
  }
  return true;
}

void strut_path_find_pieces(strut_path_system *s) {
  const double *rest = s->equations.terms.rest;
  strut_element_pose pose;
  for (int32_t i = 0; i < s->model->elements.count; i++) {
    const strut_element *e = &s->model->elements.element[i];
    if (e->law != STRUT_LAW_FOLDING) continue;
    strut_element_evaluate(s->model, i, rest, s->latest.q, s->elements.element[i].turn, &pose);
    s->elements.element[i].piece = strut_element_piece(e, rest, pose.strain - pose.natural);
  }
}

int32_t strut_path_count_folded(const strut_path_system *s) {
  int32_t count = 0;
  for (int32_t i = 0; i < s->model->elements.count; i++) {
    const strut_element *e = &s->model->elements.element[i];
    const strut_path_element *own = &s->elements.element[i];
    count += own->acts && strut_law_way(e->law, &e->numbers, own->piece) < 0;
  }
  return count;
}

/* Natural strain where the parameter has its present value, or in other terms. */
static double natural_in(const strut_path_terms *terms, int32_t i) {
  const strut_element *e = &terms->laws->elements.element[i];
  return strut_element_natural(e, terms->rest);
}

/* Law, numbers and natural strain of some terms, at a strain. */
static strut_law_response respond(const strut_path_terms *terms, int32_t i, double strain,
                                  double natural, int piece) {
  const strut_element *e = &terms->laws->elements.element[i];
  return strut_law_respond(e->law, &e->numbers, strain, natural, piece);
}

/* How the force changes with the parameter where the strain does not. */
static double find_rate(const strut_path_system *s, int32_t i) {
  const strut_path_parameter *p = &s->parameter;
  const strut_path_element *own = &s->elements.element[i];
  const strut_element *e = &s->model->elements.element[i];
  const strut_element_pose *pose = &strut_path_element_force(s, i)->pose;
  double strain = pose->strain, natural = pose->natural;
  if (p->options->over == STRUT_PATH_OVER_SCENE) {
    double low = respond(&p->low, i, strain, natural_in(&p->low, i), own->piece).force;
    double high = respond(&p->high, i, strain, natural_in(&p->high, i), own->piece).force;
    return (high - low) / p->apart;
  }
  double rate = e->slot >= 0 ? s->equations.rates.rest[e->slot] : 0.0;
  if (rate == 0.0) return 0.0;
  double h = STRAIN_STEP * fmax(fabs(natural), fabs(strain));
  if (!(h > 0.0)) h = STRAIN_STEP;
  double low = respond(&s->equations.terms, i, strain, natural - h, own->piece).force;
  double high = respond(&s->equations.terms, i, strain, natural + h, own->piece).force;
  return rate * (high - low) / (2.0 * h);
}

/*
 * Of a straight element whose nodes have passed one another since the last point strain and gradient count as negative,
 * as those of a plain member.
 */
static void turn_round(const strut_path_system *s, const strut_element *e, strut_path_element *own,
                       strut_element_pose *pose) {
  double *b = pose->b;
  own->turned = false;
  if (!strut_element_is_of_member(e) || !strut_path_turns_round(s, e->item)) return;
  const double *ahead = &s->latest.ahead[2 * e->item];
  own->turned = b[2] * ahead[0] + b[3] * ahead[1] < 0.0;
  if (own->turned) pose->strain *= -1.0;
  bool tiny = fabs(pose->strain) < STRUT_PATH_NOTHING * s->size;
  for (int k = 0; k < 4; k++)
    b[k] = tiny && (ahead[0] != 0.0 || ahead[1] != 0.0) ? (k < 2 ? -1.0 : 1.0) * ahead[k % 2]
                                                        : (own->turned ? -b[k] : b[k]);
}

/* Strain and gradient at system->q, natural strain of its terms, force and slope of its piece. */
static void evaluate_element(strut_path_system *s, int32_t i) {
  strut_path_element *own = &s->elements.element[i];
  strut_element_pose *pose = &strut_path_element_force(s, i)->pose;
  strut_element_evaluate(s->model, i, s->equations.terms.rest, s->latest.q, own->turn, pose);
  turn_round(s, &s->model->elements.element[i], own, pose);
  pose->natural = natural_in(&s->equations.terms, i);
  strut_law_response r = respond(&s->equations.terms, i, pose->strain, pose->natural, own->piece);
  pose->acts = own->acts;
  pose->force = own->acts ? r.force : 0.0;
  pose->slope = own->acts ? r.slope : 0.0;
  own->rate = own->acts ? find_rate(s, i) : 0.0;
}

void strut_path_add_elements(strut_path_system *s) {
  for (int32_t i = 0; i < s->model->elements.count; i++) {
    evaluate_element(s, i);
    if (!s->elements.element[i].acts) continue;
    if (strut_path_rubs(s, i))
      strut_path_add_rubbing(s, i);
    else
      strut_path_add_strain(s, strut_path_element_force(s, i), s->elements.element[i].rate);
  }
}

void strut_path_keep_turns(strut_path_system *s) {
  for (int32_t i = 0; i < s->model->elements.count; i++)
    s->elements.element[i].turn = strut_path_element_force(s, i)->pose.strain;
}

double strut_path_element_tension(const strut_path_system *s, int32_t member) {
  const strut_element_table *t = &s->model->elements;
  const strut_element *e = strut_element_of_member(t, member);
  double sum = 0.0;
  for (; e; e = e->sibling >= 0 ? &t->element[e->sibling] : NULL) {
    double force = strut_path_element_force(s, (int32_t)(e - t->element))->pose.force;
    if (e->carries) force = e->carries * fmax(e->carries * force, 0.0); /* at a kink, rounding */
    sum += force;
  }
  return sum;
}

void strut_path_element_forces(const strut_path_system *s, strut_element_role role, double *force) {
  const strut_element_table *t = &s->model->elements;
  for (int32_t i = 0; i < t->count; i++)
    if (t->element[i].role == role)
      force[t->element[i].item] = strut_path_element_force(s, i)->pose.force + 0.0; /* no -0 */
}

void strut_path_pressures(const strut_path_system *s, double *pressure) {
  const strut_element_table *t = &s->model->elements, *now = &s->equations.terms.laws->elements;
  for (int32_t i = 0; i < t->count; i++)
    if (t->element[i].role == STRUT_ELEMENT_CELL)
      pressure[t->element[i].item] =
          now->element[i].numbers.outside - strut_path_element_force(s, i)->pose.force;
}

/*
 * One that carries one sign acts where both its strain beyond the natural one and its force have
 * it: the nearer of the two to zero decides. Angles are turned into lengths by the size.
 */
double strut_path_element_switch_value(const strut_path_system *s, int32_t which) {
  const strut_path_element_switch *w = &s->elements.switches[which];
  const strut_element *e = &s->equations.terms.laws->elements.element[w->element];
  const strut_path_element *own = &s->elements.element[w->element];
  strut_element_pose pose;
  strut_element_evaluate(s->model, w->element, s->equations.terms.rest, s->latest.q, own->turn,
                         &pose);
  double natural = natural_in(&s->equations.terms, w->element), x = pose.strain - natural;
  double unit = e->strain == STRUT_STRAIN_ANGLE ? s->size : 1.0;
  if (w->kink >= 0) {
    double kink = strut_law_kink(e->law, &e->numbers, w->kink);
    bool near = w->kink == own->piece || w->kink == own->piece - 1;
    if (e->law == STRUT_LAW_FOLDING)
      return near ? unit * strut_law_way(e->law, &e->numbers, own->piece) * (x - kink) : -HUGE_VAL;
    return is_kink_felt(e, kink) ? unit * (x - kink) : -HUGE_VAL;
  }
  double beyond = e->carries * x;
  int piece = e->law == STRUT_LAW_FOLDING ? own->piece : -1;
  strut_law_response r = respond(&s->equations.terms, w->element, pose.strain, natural, piece);
  double slope = fmax(fabs(r.slope), e->numbers.stiffness);
  if (beyond > 0.0 && r.force != 0.0 && slope > 0.0)
    beyond = fmin(beyond, e->carries * r.force / slope);
  return unit * beyond;
}

bool strut_path_element_switch_is_on(const strut_path_system *s, int32_t which) {
  const strut_path_element_switch *w = &s->elements.switches[which];
  const strut_path_element *own = &s->elements.element[w->element];
  return w->kink < 0 ? own->acts : own->piece > w->kink;
}

void strut_path_element_switch_set(strut_path_system *s, int32_t which, bool on) {
  const strut_path_element_switch *w = &s->elements.switches[which];
  strut_path_element *own = &s->elements.element[w->element];
  if (w->kink < 0)
    own->acts = on;
  else if (on)
    own->piece = own->piece > w->kink ? own->piece : w->kink + 1;
  else
    own->piece = own->piece > w->kink ? w->kink : own->piece;
}
