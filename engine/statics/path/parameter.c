/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Built-in parameters are linear in one term; scenes are compiled anew, and their terms compared.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/statics/path/path_parts.h"

#include "engine/model/compile_parts.h"

static const double VALUE_STEP = 1e-5; /* of the range: apart, for a derivative */

/* Numbers of some terms, one after the other from `stiffness` on. */
static size_t count_terms(const strut_model *model) {
  return 3 * ((size_t)model->members.slots + (size_t)model->length);
}

bool strut_path_terms_create(const strut_model *model, strut_arena *arena,
                             strut_path_terms *terms) {
  size_t length = (size_t)model->length, slots = (size_t)model->members.slots;
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(terms->stiffness, count_terms(model)))) return false;
  terms->rest = terms->stiffness + slots, terms->rest_low = terms->rest + slots;
  terms->position = terms->rest_low + slots, terms->position_low = terms->position + length;
  terms->force = terms->position_low + length;
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

static void read_terms(const strut_model *model, strut_path_terms *terms) {
  size_t length = (size_t)model->length * sizeof(double);
  size_t slots = (size_t)model->members.slots * sizeof(double);
  memset(terms->stiffness, 0, count_terms(model) * sizeof *terms->stiffness);
  memcpy(terms->stiffness, model->members.stiffness, slots);
  memcpy(terms->rest, model->members.rest, slots);
  memcpy(terms->position, model->start, length);
  if (model->constant_force) memcpy(terms->force, model->constant_force, length);
  terms->laws = model;
}

/* The same elements: strains, laws and kinks, whatever their numbers. */
static bool are_elements_alike(const strut_element_table *first,
                               const strut_element_table *second) {
  if (first->count != second->count) return false;
  for (int32_t i = 0; i < first->count; i++) {
    const strut_element *element = &first->element[i], *t = &second->element[i];
    if (element->strain != t->strain || element->law != t->law || element->role != t->role ||
        element->item != t->item || element->nodes != t->nodes || element->carries != t->carries ||
        element->slot != t->slot ||
        strut_law_kinks(element->law, &element->numbers) != strut_law_kinks(t->law, &t->numbers) ||
        memcmp(first->at + element->first, second->at + t->first,
               (size_t)element->nodes * sizeof *first->at) != 0)
      return false;
  }
  return true;
}

static bool is_equal(const double *first, const double *second, size_t count) {
  return memcmp(first, second, count * sizeof *first) == 0;
}

/* The same contacts, with surfaces of as many facets. */
static bool are_grounds_alike(const strut_contact_table *first, const strut_contact_table *second) {
  if (first->count != second->count || first->surfaces != second->surfaces ||
      !first->surface != !second->surface)
    return false;
  for (int32_t k = 0; k < first->surfaces; k++)
    if (first->surface[k].facets != second->surface[k].facets) return false;
  for (int32_t i = 0; i < first->count; i++)
    if (first->at[i] != second->at[i] ||
        (first->surface && first->surface_of[i] != second->surface_of[i]))
      return false;
  return true;
}

/* Do alike grounds lie elsewhere? */
static bool are_grounds_moved(const strut_contact_table *first, const strut_contact_table *second) {
  if (!is_equal(first->normal, second->normal, 2) || first->height != second->height) return true;
  for (int32_t k = 0; k < first->surfaces; k++) {
    const strut_surface *surface = &first->surface[k], *t = &second->surface[k];
    if (!is_equal(surface->centre, t->centre, 2) || surface->radius != t->radius) return true;
    for (int32_t f = 0; f < surface->facets; f++)
      if (!is_equal(surface->facet[f].point, t->facet[f].point, 2) ||
          !is_equal(surface->facet[f].axes.normal, t->facet[f].axes.normal, 2))
        return true;
  }
  return false;
}

/* Have alike contacts another stiffness, or, where it is kept, another friction? */
static bool are_contacts_different(const strut_contact_table *first,
                                   const strut_contact_table *second, bool friction) {
  for (int32_t i = 0; i < first->count; i++) {
    const strut_friction *s = &first->entry[i].friction, *t = &second->entry[i].friction;
    bool other = s->mu_static != t->mu_static || s->mu_kinetic != t->mu_kinetic ||
                 s->mu_static_backward != t->mu_static_backward ||
                 s->mu_kinetic_backward != t->mu_kinetic_backward;
    if (first->entry[i].stiffness != second->entry[i].stiffness || (friction && other)) return true;
  }
  return false;
}

/* Two models of one structure: the same members, elements, supports and contacts. */
static bool is_same_structure(const strut_model *first, const strut_model *second) {
  const strut_member_table *members = &first->members, *t = &second->members;
  if (first->node_count != second->node_count || first->length != second->length ||
      members->count != t->count || members->slots != t->slots ||
      !are_grounds_alike(&first->contacts, &second->contacts))
    return false;
  for (int32_t j = 0; j < members->count; j++)
    if (members->from[j] != t->from[j] || members->to[j] != t->to[j] ||
        members->slack[j] != t->slack[j])
      return false;
  return memcmp(first->fixed, second->fixed, (size_t)first->length * sizeof *first->fixed) == 0 &&
         are_elements_alike(&first->elements, &second->elements);
}

/* Records why the scene is invalid at a value. */
static bool refuse_value(strut_path_parameter *parameter, double value, const strut_error *why) {
  parameter->refused_at = value;
  parameter->refusal = *why;
  return false;
}

static bool read_scene_terms(strut_path_parameter *parameter, double value,
                             strut_path_terms *terms) {
  strut_error error = {0};
  struct strut_path_scene *scene = strut_allocate(1, sizeof *scene);
  if (!scene) {
    strut_no_memory(&error, "");
    return refuse_value(parameter, value, &error);
  }
  strut_status status =
      parameter->options->scene_at(parameter->options->context, value, &scene->setup, &error);
  if (status != STRUT_OK) {
    strut_release(scene);
    return refuse_value(parameter, value, &error);
  }
  status = strut_model_compile(&scene->setup.scene, &scene->model, &error);
  if (status == STRUT_OK && !is_same_structure(parameter->model, scene->model))
    status = strut_fail(&error, STRUT_USAGE,
                        "%s changes what the structure is made of (nodes, members, hinges, laws, "
                        "supports or contacts); a path needs the same structure throughout",
                        parameter->options->name);
  if (status == STRUT_OK && parameter->options->friction &&
      are_grounds_moved(&parameter->model->contacts, &scene->model->contacts))
    status = strut_fail(&error, STRUT_USAGE,
                        "%s moves the ground, and friction is kept, which needs a ground at rest; "
                        "move the structure or turn its loads, or leave friction out",
                        parameter->options->name);
  if (status == STRUT_OK) {
    read_terms(scene->model, terms);
    strut_path_terms_release(terms);
    terms->scene = scene;
    return true;
  }
  free_scene(scene);
  return refuse_value(parameter, value, &error);
}

/* Elements with memory have slots of their own, which follow that of what is driven. */
static void follow_slot(const strut_model *model, int32_t slot, double *rest) {
  for (int32_t m = 0; m < model->elements.history_count; m++) {
    const strut_element *element = &model->elements.element[model->elements.memory[m]];
    if (element->base == slot) rest[element->slot] = rest[slot];
  }
}

bool strut_path_parameter_terms(strut_path_parameter *parameter, strut_dd value,
                                strut_path_terms *terms) {
  strut_dd change = dd_sub(value, dd_of(parameter->from));
  int32_t at = parameter->options->index;
  strut_error error = {0};
  if (parameter->options->over == STRUT_PATH_OVER_SCENE)
    return read_scene_terms(parameter, dd_double(value), terms);
  memcpy(terms->stiffness, parameter->base.stiffness,
         count_terms(parameter->model) * sizeof *terms->stiffness);
  terms->laws = parameter->base.laws;
  if (parameter->options->over == STRUT_PATH_OVER_LOAD) {
    const double *moment = parameter->load + parameter->model->length;
    for (int32_t i = 0; i < parameter->model->length; i++)
      terms->force[i] += dd_double(change) * parameter->load[i];
    for (int32_t i = 0; i < parameter->model->members.slots; i++)
      terms->rest[i] += dd_double(change) * moment[i];
  } else if (parameter->options->over == STRUT_PATH_OVER_ACTUATOR) {
    int32_t member = parameter->model->scene->actuators[at].member;
    int32_t slot = strut_actuator_slot(parameter->model, (size_t)at);
    strut_dd rest = dd_add(dd_of(parameter->base.rest[slot]), change);
    terms->rest[slot] = rest.hi, terms->rest_low[slot] = rest.lo;
    follow_slot(parameter->model, slot, terms->rest);
    bool axial = member >= 0 && parameter->model->scene->members[member].axial_stiffness > 0.0;
    double least = axial ? STRUT_AXIAL_LEAST * parameter->model->members.rest[slot] : 0.0;
    if (member >= 0 && rest.hi < least) {
      strut_fail(&error, STRUT_BAD_SCENE, "the rest length of %s would %s",
                 parameter->model->scene->members[member].name,
                 axial ? "reach zero" : "be negative");
      return refuse_value(parameter, dd_double(value), &error);
    }
  } else {
    strut_dd place = dd_add(dd_of(parameter->base.position[at]), change);
    terms->position[at] = place.hi, terms->position_low[at] = place.lo;
  }
  return true;
}

/* How far to both sides; forces are linear in loads, and steep in rest lengths near zero. */
static double find_step(const strut_path_parameter *parameter, double value) {
  const strut_path_options *options = parameter->options;
  const strut_model *model = parameter->model;
  double range = fabs(parameter->range), step = VALUE_STEP * range;
  if (options->over == STRUT_PATH_OVER_LOAD) return range;
  if (options->over != STRUT_PATH_OVER_ACTUATOR) return step;
  double rest = parameter->base.rest[strut_actuator_slot(model, (size_t)options->index)];
  bool length = model->scene->actuators[options->index].member >= 0;
  double part = VALUE_STEP * (rest + value - parameter->from);
  return length ? fmin(step, fmax(part, VALUE_STEP * step)) : step;
}

/* Terms to both sides of a value, or at the value itself where there are none to one side; false: there are none. */
static bool find_neighbours(strut_path_parameter *parameter, double value) {
  double h = find_step(parameter, value);
  double low = value - h, high = value + h;
  double refused_at = parameter->refused_at; /* values beside it do not count */
  strut_error refusal = parameter->refusal;
  if (!strut_path_parameter_terms(parameter, dd_of(low), &parameter->low)) {
    low = value;
    if (!strut_path_parameter_terms(parameter, dd_of(low), &parameter->low)) return false;
  }
  if (!strut_path_parameter_terms(parameter, dd_of(high), &parameter->high)) {
    high = value;
    if (low == high || !strut_path_parameter_terms(parameter, dd_of(high), &parameter->high))
      return false;
  }
  parameter->refused_at = refused_at, parameter->refusal = refusal;
  parameter->apart = high - low;
  return true;
}

bool strut_path_parameter_rates(strut_path_parameter *parameter, double value,
                                strut_path_terms *rates) {
  const strut_path_terms *low = &parameter->low, *high = &parameter->high;
  size_t length = (size_t)parameter->model->length, slots = (size_t)parameter->model->members.slots;
  if (!find_neighbours(parameter, value)) return false;
  for (size_t i = 0; i < count_terms(parameter->model); i++)
    rates->stiffness[i] = (high->stiffness[i] - low->stiffness[i]) / parameter->apart;
  for (size_t i = 0; i < slots; i++) rates->rest[i] += rates->rest_low[i];
  for (size_t i = 0; i < length; i++) rates->position[i] += rates->position_low[i];
  return true;
}

/* Do the elements' laws have other numbers? */
static bool are_laws_different(const strut_element_table *first,
                               const strut_element_table *second) {
  for (int32_t i = 0; i < first->count; i++) {
    const strut_element *element = &first->element[i], *t = &second->element[i];
    const strut_law_numbers *m = &element->numbers, *n = &t->numbers;
    bool numbers = m->stiffness != n->stiffness || m->count != n->count || m->area != n->area ||
                   m->exponent != n->exponent || m->outside != n->outside || m->axial != n->axial;
#define STRUT_LAW_ROW(NAME, field, ...) numbers = numbers || m->field != n->field;
    STRUT_LAW_PARAMETERS(STRUT_LAW_ROW)
#undef STRUT_LAW_ROW
    if (numbers || element->natural != t->natural) return true;
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
static bool is_different(const strut_model *model, const strut_path_terms *first,
                         const strut_path_terms *second, bool friction) {
  size_t slots = (size_t)model->members.slots;
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    if (model->fixed[i] ? first->position[i] != second->position[i]
                        : first->force[i] != second->force[i])
      return true;
  return are_laws_different(&first->laws->elements, &second->laws->elements) ||
         are_grounds_moved(&first->laws->contacts, &second->laws->contacts) ||
         are_contacts_different(&first->laws->contacts, &second->laws->contacts, friction) ||
         !is_equal(first->stiffness, second->stiffness, slots) ||
         !is_equal(first->rest, second->rest, slots);
}

/* Checks that a scene's number has an effect and does not change the structure. */
static strut_status check_effect(strut_path_parameter *parameter, strut_error *error) {
  static const double places[] = {1e-3, 0.37, 1.0};
  if (parameter->options->over != STRUT_PATH_OVER_SCENE) return STRUT_OK;
  if (!read_scene_terms(parameter, parameter->from, &parameter->base))
    return strut_fail(error, parameter->refusal.status, "%s", parameter->refusal.message);
  for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
    bool valid = read_scene_terms(parameter, parameter->from + places[i] * parameter->range,
                                  &parameter->low);
    strut_error why = parameter->refusal;
    parameter->refusal = (strut_error){0};
    if (!valid && (why.status == STRUT_USAGE || why.status == STRUT_NO_MEMORY))
      return strut_fail(error, why.status, "%s", why.message);
    if (!valid || is_different(parameter->model, &parameter->base, &parameter->low,
                               parameter->options->friction))
      return STRUT_OK;
  }
  return strut_fail(error, STRUT_USAGE,
                    "%s changes nothing that matters at rest: no stiffness, rest length, support, "
                    "load or ground; there is no path to follow",
                    parameter->options->name);
}

strut_status strut_path_parameter_create(strut_path_parameter *parameter, const double *position,
                                         strut_arena *arena, strut_error *error) {
  const strut_model *model = parameter->model;
  if (!strut_path_terms_create(model, arena, &parameter->base) ||
      !strut_path_terms_create(model, arena, &parameter->low) ||
      !strut_path_terms_create(model, arena, &parameter->high))
    return strut_no_memory(error, "");
  read_terms(model, &parameter->base);
  memcpy(parameter->base.position, position, (size_t)model->length * sizeof *position);
  return check_effect(parameter, error);
}

/* A kink that matters: it lies where the element can act. */
static bool is_kink_felt(const strut_element *element, double kink) {
  return !element->carries || element->carries * kink > 0.0;
}

static int32_t count_switches(const strut_element_table *elements) {
  int32_t count = 0;
  for (int32_t i = 0; i < elements->count; i++)
    count += (elements->element[i].carries != 0) +
             strut_law_kinks(elements->element[i].law, &elements->element[i].numbers);
  return count;
}

bool strut_path_elements_create(const strut_model *model, strut_arena *arena,
                                strut_path_elements *elements) {
  const strut_element_table *t = &model->elements;
  *elements = (strut_path_elements){0};
  if (t->count == 0) return true;
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(elements->element, t->count),
                      STRUT_NEW(elements->switches, (size_t)count_switches(t) + 1)))
    return false;
  for (int32_t i = 0; i < t->count; i++) {
    const strut_element *element = &t->element[i];
    int kinks = strut_law_kinks(element->law, &element->numbers);
    elements->element[i] = (strut_path_element){.turn = (double)NAN, .acts = true};
    elements->noise =
        fmax(elements->noise, DBL_EPSILON * strut_force_stiffest(model, model->members.count + i));
    if (element->carries)
      elements->switches[elements->switch_count++] = (strut_path_element_switch){i, -1};
    for (int k = 0; k < kinks; k++) {
      double kink = strut_law_kink(element->law, &element->numbers, k);
      bool folds = element->law == STRUT_LAW_FOLDING;
      elements->switches[elements->switch_count++] = (strut_path_element_switch){i, k};
      elements->element[i].piece +=
          !folds && !is_kink_felt(element, kink) && kink <= 0.0; /* always above it */
    }
  }
  return true;
}

/* Natural strain where the parameter has its present value, or in other terms. */
static double natural_in(const strut_path_terms *terms, int32_t i) {
  const strut_element *element = &terms->laws->elements.element[i];
  return strut_element_natural(element, terms->rest);
}

/* Law, numbers and natural strain of some terms, at a strain. */
static strut_law_response respond(const strut_path_terms *terms, int32_t i, double strain,
                                  double natural, int piece) {
  const strut_element *element = &terms->laws->elements.element[i];
  return strut_law_respond(element->law, &element->numbers, strain, natural, piece);
}

/* How the force changes with the parameter where the strain does not. */
static double find_rate(const strut_path_system *system, int32_t i) {
  const strut_path_parameter *parameter = &system->parameter;
  double strain = strut_path_element_force(system, i)->pose.strain, force[2];
  for (int k = 0; k < 2; k++) {
    const strut_path_terms *terms = k ? &parameter->high : &parameter->low;
    force[k] =
        respond(terms, i, strain, natural_in(terms, i), system->elements.element[i].piece).force;
  }
  return (force[1] - force[0]) / parameter->apart;
}

/*
 * Of a straight element whose nodes have passed one another since the last point strain and gradient count as negative,
 * as those of a plain member.
 */
static void turn_round(const strut_path_system *system, const strut_element *element,
                       strut_path_element *own, strut_element_pose *pose) {
  double *b = pose->b;
  own->turned = false;
  if (!strut_element_is_of_member(element) || !strut_path_turns_round(system, element->item))
    return;
  const double *ahead = &system->latest.ahead[2 * element->item];
  own->turned = b[2] * ahead[0] + b[3] * ahead[1] < 0.0;
  if (own->turned) pose->strain *= -1.0;
  bool tiny = fabs(pose->strain) < STRUT_PATH_NOTHING * system->size;
  for (int k = 0; k < 4; k++)
    b[k] = tiny && (ahead[0] != 0.0 || ahead[1] != 0.0) ? (k < 2 ? -1.0 : 1.0) * ahead[k % 2]
                                                        : (own->turned ? -b[k] : b[k]);
}

/* Strain and gradient at system->q, natural strain of its terms, force and slope of its piece. */
static void evaluate_element(strut_path_system *system, int32_t i) {
  strut_path_element *own = &system->elements.element[i];
  strut_element_pose *pose = &strut_path_element_force(system, i)->pose;
  strut_element_evaluate(system->model, i, system->equations.terms.rest, system->latest.q,
                         own->turn, pose);
  turn_round(system, &system->model->elements.element[i], own, pose);
  pose->natural = natural_in(&system->equations.terms, i);
  strut_law_response r =
      respond(&system->equations.terms, i, pose->strain, pose->natural, own->piece);
  pose->acts = own->acts;
  pose->force = own->acts ? r.force : 0.0;
  pose->slope = own->acts ? r.slope : 0.0;
  own->rate = own->acts ? find_rate(system, i) : 0.0;
}

void strut_path_add_elements(strut_path_system *system) {
  for (int32_t i = 0; i < system->model->elements.count; i++) {
    evaluate_element(system, i);
    if (!system->elements.element[i].acts) continue;
    if (strut_path_rubs(system, i))
      strut_path_add_rubbing(system, i);
    else
      strut_path_add_strain(system, strut_path_element_force(system, i),
                            system->elements.element[i].rate);
  }
}

/*
 * One that carries one sign acts where both its strain beyond the natural one and its force have
 * it: the nearer of the two to zero decides. Angles are turned into lengths by the size.
 */
double strut_path_element_switch_value(const strut_path_system *system, int32_t which) {
  const strut_path_element_switch *element_switch = &system->elements.switches[which];
  const strut_element *element =
      &system->equations.terms.laws->elements.element[element_switch->element];
  const strut_path_element *own = &system->elements.element[element_switch->element];
  strut_element_pose pose;
  strut_element_evaluate(system->model, element_switch->element, system->equations.terms.rest,
                         system->latest.q, own->turn, &pose);
  double natural = natural_in(&system->equations.terms, element_switch->element),
         x = pose.strain - natural;
  double unit = element->strain == STRUT_STRAIN_ANGLE ? system->size : 1.0;
  if (element_switch->kink >= 0) {
    double kink = strut_law_kink(element->law, &element->numbers, element_switch->kink);
    bool near = element_switch->kink == own->piece || element_switch->kink == own->piece - 1;
    if (element->law == STRUT_LAW_FOLDING)
      return near ? unit * strut_law_way(element->law, &element->numbers, own->piece) * (x - kink)
                  : -HUGE_VAL;
    return is_kink_felt(element, kink) ? unit * (x - kink) : -HUGE_VAL;
  }
  double beyond = element->carries * x;
  int piece = element->law == STRUT_LAW_FOLDING ? own->piece : -1;
  strut_law_response r =
      respond(&system->equations.terms, element_switch->element, pose.strain, natural, piece);
  double slope = fmax(fabs(r.slope), element->numbers.stiffness);
  if (beyond > 0.0 && r.force != 0.0 && slope > 0.0)
    beyond = fmin(beyond, element->carries * r.force / slope);
  return unit * beyond;
}
