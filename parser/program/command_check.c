/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/commands.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/integrate/integrator.h"
#include "engine/output/buffer.h"
#include "engine/output/json_value.h"
#include "engine/run/cost_estimate.h"
#include "engine/run/measure/monitors.h"
#include "parser/command/run_settings.h"
#include "parser/program/check_messages.h"
#include "parser/program/open_model.h"
#include "parser/program/streams.h"

enum { MOST_MEMBERS = 40, DIGITS = 5 };

static const strut_option options[] = {
    STRUT_SET_OPTION,
    STRUT_RUN_SETTING_OPTIONS,
    STRUT_FIDELITY_OPTIONS,
    STRUT_JSON_OPTION,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_rounded_quantity in(double value, const char *unit) {
  return strut_quantity_of(value, DIGITS, unit);
}

static void print_counts(const strut_cost_estimate *estimate) {
  size_t members = estimate->count.bars + estimate->count.springs + estimate->count.cables;
  printf("  nodes              %zu, with %zu degrees of freedom\n", estimate->count.nodes,
         estimate->count.degrees_of_freedom);
  printf("  members            %zu: bars %zu, springs %zu, cables %zu\n", members,
         estimate->count.bars, estimate->count.springs, estimate->count.cables);
  if (estimate->count.running_cables + estimate->count.laws + estimate->count.stops > 0)
    printf("  of them            running cables %zu, with a law %zu, stops %zu\n",
           estimate->count.running_cables, estimate->count.laws, estimate->count.stops);
  if (estimate->count.hinges) printf("  hinges             %zu\n", estimate->count.hinges);
  if (estimate->count.cells) printf("  cells              %zu\n", estimate->count.cells);
  if (estimate->count.collisions) printf("  collisions         %zu\n", estimate->count.collisions);
  printf("  contacts           %zu\n  actuators          %zu\n  loads              %zu\n",
         estimate->count.contacts, estimate->count.actuators, estimate->count.loads);
  printf("  memory             %s\n", in((double)estimate->bytes, "B").text);
}

/* Step limits of the other methods, on one line. */
static void print_limits(const strut_cost_estimate *estimate) {
  const char *between = "  of other methods   ";
  for (size_t i = 0; strut_integrator_at(i); i++) {
    const strut_integrator *method = strut_integrator_at(i);
    double limit = strut_step_limit_of_method(&estimate->limits, method);
    if (method->region == STRUT_REGION_RK4 || !isfinite(limit)) continue;
    printf("%s%s %s", between, method->name, in(limit, "s").text);
    between = ", ";
  }
  if (*between == ',') printf("\n");
}

static void print_run(const strut_cost_estimate *estimate, const strut_experiment *e) {
  if (!estimate->runnable) {
    printf("  no run             a free node has no mass: statics only\n");
    return;
  }
  double step = e->step, hertz = estimate->largest_frequency / STRUT_TAU;
  printf("  mass matrix        %zu nonzeros, %zu in its factor, %zu in dense inverses\n",
         estimate->matrix.mass_nonzeros, estimate->matrix.factor_nonzeros,
         estimate->matrix.dense_entries);
  bool bound = estimate->limits.bound;
  printf("  highest frequency  %s%s (undamped, all contacts closed)\n", bound ? "at most " : "",
         in(hertz, "Hz").text);
  printf("  largest step       %s%s for rk4, with contacts and damping (%s)\n",
         bound ? "at least " : "", in(estimate->step_limit, "s").text,
         bound                        ? "a bound: the structure is too large for an estimate"
         : estimate->step_limit_exact ? "from all eigenvalues"
                                      : "within 1 %");
  print_limits(estimate);
  if (estimate->feedback)
    printf("  feedback           not counted in this frequency and these steps\n");
  const strut_integrator *method = strut_integrator_find(e->integrator);
  double limit =
      method ? strut_step_limit_of_method(&estimate->limits, method) : estimate->step_limit;
  if (method && method->region == STRUT_REGION_ALL) printf("  limit of %-9s none\n", method->name);
  if (step > limit) {
    printf("  step               %s: too large, strut run rejects it\n", in(step, "s").text);
  } else if (step > 0) {
    printf("  step               %s\n", in(step, "s").text);
  }
}

/* Warns of stick bands that a step passes over, in one line for all nodes. */
static void print_bands(const strut_model *model, const strut_experiment *experiment) {
  const strut_scene *scene = model->scene;
  const strut_integrator *method = strut_integrator_find(experiment->integrator);
  double needed = 0.0;
  int32_t first = -1, more = -1;
  for (int32_t i = 0; method && i < model->contacts.count; i++) {
    double here = strut_stick_band_needed(model, method, i, experiment->step);
    if (!(here * (1.0 - 1e-6) > model->contacts.entry[i].friction.stick_velocity)) continue;
    if (first < 0) first = i;
    if (here > needed) needed = here;
    more++;
  }
  if (first < 0) return;
  const strut_contact_entry *e = &model->contacts.entry[first];
  char others[40] = "";
  if (more > 0) snprintf(others, sizeof others, " and %d more", (int)more);
  fprintf(stderr,
          "strut: warning: stick_velocity %s of node '%s'%s is narrower than the change of slip in "
          "one step of %s, so that sticking is a matter of chance; use stick_velocity >= %s, a "
          "smaller step, or a method with events\n",
          in(e->friction.stick_velocity, "m/s").text, scene->nodes[e->node].name, others,
          in(experiment->step, "s").text, in(needed, "m/s").text);
}

/* Positions of the drawn shape (length), or NULL. */
static double *drawn_shape(const strut_model *model) {
  double *q = strut_allocate((size_t)model->length, sizeof *q);
  for (size_t i = 0; q && i < model->scene->node_count; i++) {
    q[2 * i] = model->scene->nodes[i].position[0];
    q[2 * i + 1] = model->scene->nodes[i].position[1];
  }
  return q;
}

/* Rest length, force and stiffness of a member as drawn; of one that is an element by its law. */
static bool find_rest(const strut_model *model, const double *q, size_t j, strut_rest *rest) {
  if (!strut_member_rest(model->scene, j, rest)) return false;
  const strut_element *e = strut_element_of_member(&model->elements, (int32_t)j);
  if (!e || e->role != STRUT_ELEMENT_MEMBER) return true;
  strut_element_pose pose;
  strut_element_evaluate(model, (int32_t)(e - model->elements.element), model->members.rest, q,
                         (double)NAN, &pose);
  rest->pretension = pose.force;
  rest->force_density = rest->drawn_length > 0.0 ? pose.force / rest->drawn_length : 0.0;
  rest->stiffness = e->numbers.stiffness;
  return true;
}

/* ---- things: each is described once, for a row of a table and for JSON ---- */

enum { MOST_VALUES = 20 };

/* Those with `column` are the table's columns; the others stand behind them, where there are any. */
typedef struct description {
  strut_report_value value[MOST_VALUES];
  size_t count;
  const strut_member *running; /* a cable over guides, or NULL */
} description;

static void add_number(description *d, const char *key, const char *unit, double number) {
  d->value[d->count++] = (strut_report_value){key, unit, number, NULL, true};
}

static void add_word(description *d, const char *key, const char *text, bool column) {
  d->value[d->count++] = (strut_report_value){key, "1", 0.0, text, column};
}

static void add_extra(description *d, const char *key, const char *unit, double number) {
  if (number > 0.0) d->value[d->count++] = (strut_report_value){key, unit, number, NULL, false};
}

static const char *carries_name(const strut_member *m) {
  static const char *const names[] = {"both", "tension", "compression"};
  return names[m->kind == STRUT_CABLE ? STRUT_CARRIES_TENSION : m->law.carries];
}

/* The stiffness of a member's stops [N/m]. */
static double stop_stiffness(const strut_model *model, size_t j) {
  const strut_element *e = strut_element_of_member(&model->elements, (int32_t)j);
  while (e && e->role == STRUT_ELEMENT_MEMBER)
    e = e->sibling >= 0 ? &model->elements.element[e->sibling] : NULL;
  return e ? e->numbers.stiffness : 0.0;
}

/* Its rest length is given in the four forms that the language accepts. */
static bool describe_member(const strut_model *model, const double *q, size_t i, description *d) {
  const strut_member *m = &model->scene->members[i];
  strut_rest rest;
  if (!find_rest(model, q, i, &rest)) return false;
  add_word(d, "kind", strut_member_kind_name(m->kind), true);
  add_number(d, "drawn_length", "m", rest.drawn_length);
  add_number(d, "rest_length", "m", rest.length);
  add_number(d, "rest_length_ratio", "1", rest.ratio);
  add_number(d, "pretension", "N", rest.pretension);
  add_number(d, "force_density", "N/m", rest.force_density);
  add_number(d, "stiffness", "N/m", rest.stiffness);
  if (m->guide_count) d->running = m;
  if (m->law.kind != STRUT_LAW_LINEAR || m->law.carries != STRUT_CARRIES_BOTH) {
    add_word(d, "law", strut_law_at(m->law.kind)->word, false);
    add_word(d, "carries", carries_name(m), false);
  }
  add_extra(d, "guide_friction", "1", m->guide_friction);
  add_extra(d, "guide_radius", "m", m->guide_radius);
  add_extra(d, "breaks_at", "N", m->breaks_at);
  add_extra(d, "released_at", "s", m->released_at);
  add_extra(d, "shortest", "m", m->shortest);
  add_extra(d, "longest", "m", m->longest);
  if (!(m->shortest > 0.0) && !(m->longest > 0.0)) return true;
  add_extra(d, "stop_stiffness", "N/m", stop_stiffness(model, i));
  add_extra(d, "stop_damping", "N s/m", m->stop_damping);
  return true;
}

static bool describe_hinge(const strut_model *model, const double *q, size_t i, description *d) {
  const strut_hinge *h = &model->scene->hinges[i];
  int32_t element = strut_element_find(&model->elements, STRUT_ELEMENT_HINGE, (int32_t)i);
  strut_element_pose pose;
  strut_element_evaluate(model, element, model->members.rest, q, (double)NAN, &pose);
  add_number(d, "drawn_angle", "rad", pose.strain);
  add_number(d, "rest_angle", "rad", pose.natural);
  add_number(d, "moment", "N m", pose.force);
  add_number(d, "stiffness", "N m/rad", model->elements.element[element].numbers.stiffness);
  add_extra(d, "breaks_at", "N m", h->breaks_at);
  add_extra(d, "released_at", "s", h->released_at);
  return true;
}

static bool describe_cell(const strut_model *model, const double *q, size_t i, description *d) {
  const strut_cell *cell = &model->scene->cells[i];
  (void)q;
  add_number(d, "drawn_area", "m^2", fabs(strut_cell_drawn(model->scene, i)));
  add_number(d, "pressure", "N/m", cell->pressure);
  add_number(d, "outside", "N/m", cell->outside);
  add_word(d, "content",
           strut_cell_is_elastic(cell)         ? "elastic"
           : cell->law == STRUT_LAW_PRESSURE   ? "given pressure"
           : cell->law == STRUT_LAW_ISOTHERMAL ? "isothermal gas"
                                               : "isentropic gas",
           true);
  return true;
}

/* The least distance of the surfaces of a collision in the drawn shape. */
static double drawn_gap(const strut_model *model, const double *q, size_t i) {
  int32_t first = strut_element_find(&model->elements, STRUT_ELEMENT_COLLISION, (int32_t)i);
  int32_t end = strut_element_end(&model->elements, first);
  double gap = HUGE_VAL;
  strut_element_pose pose;
  for (int32_t k = first; k < end; k++) {
    strut_element_evaluate(model, k, model->members.rest, q, (double)NAN, &pose);
    gap = fmin(gap, pose.strain - pose.natural);
  }
  return gap;
}

static bool describe_collision(const strut_model *model, const double *q, size_t i,
                               description *d) {
  const strut_collision *c = &model->scene->collisions[i];
  add_number(d, "thickness", "m", c->thickness);
  add_number(d, "drawn_gap", "m", drawn_gap(model, q, i));
  add_number(d, "stiffness", "N/m", c->stiffness);
  add_number(d, "damping", "N s/m", c->damping);
  return true;
}

static bool describe_distance(const strut_model *model, const double *q, size_t i, description *d) {
  const strut_distance_spring *s = &model->scene->distances[i];
  int32_t element = strut_element_find(&model->elements, STRUT_ELEMENT_DISTANCE, (int32_t)i);
  (void)q;
  add_number(d, "drawn", "m", strut_distance_drawn(model->scene, i));
  add_number(d, "rest", "m", strut_distance_rest(model->scene, i));
  /* at rest, of a law that brings its own too */
  add_number(d, "stiffness", "N/m", model->elements.element[element].numbers.stiffness);
  add_number(d, "damping", "N s/m", s->damping);
  add_word(d, "law", strut_law_at(s->law.kind)->word, true);
  return true;
}

/* The things of one kind, which have their names at an offset. */
typedef struct kind {
  const char *one, *all;
  bool (*describe)(const strut_model *model, const double *q, size_t i, description *d);
  const void *first;
  size_t count, size, name;
} kind;
enum { KINDS = 5 };

static void list_kinds(const strut_scene *s, kind kinds[KINDS]) {
#define KIND(one, all, things, type)                                                               \
  { #one, #all, describe_##one, s->things, s->one##_count, sizeof(type), offsetof(type, name) }
  const kind list[KINDS] = {KIND(member, members, members, strut_member),
                            KIND(hinge, hinges, hinges, strut_hinge),
                            KIND(cell, cells, cells, strut_cell),
                            KIND(collision, collisions, collisions, strut_collision),
                            KIND(distance, distances, distances, strut_distance_spring)};
#undef KIND
  memcpy(kinds, list, sizeof list);
}

static const char *name_of(const kind *k, size_t i) {
  return *(const char *const *)(const void *)((const char *)k->first + i * k->size + k->name);
}

/* The width of the columns of names: of the longest, from 12 to 40. */
static int name_width(const kind kinds[KINDS]) {
  size_t longest = 12;
  for (int k = 0; k < KINDS; k++)
    for (size_t i = 0; i < kinds[k].count && i < MOST_MEMBERS; i++) {
      size_t length = strlen(name_of(&kinds[k], i));
      if (length > longest) longest = length;
    }
  return longest > 40 ? 40 : (int)longest;
}

/* "rest_length" as "rest length". */
static const char *title_of(const strut_report_value *value, char title[40]) {
  snprintf(title, 40, "%s", value->key);
  for (char *c = title; *c; c++)
    if (*c == '_') *c = ' ';
  return title;
}

static void print_value(const strut_report_value *value, int width) {
  bool angle = strcmp(value->unit, "rad") == 0;
  double number = angle ? value->number * 180.0 / STRUT_PI : value->number;
  strut_rounded_quantity rounded =
      strut_quantity_of_any(number, DIGITS, angle ? "deg" : value->unit);
  printf("%*s", width, value->text ? value->text : rounded.text);
}

static void print_description(const strut_scene *scene, const char *name, int names,
                              const description *d) {
  char title[40];
  printf("  %-*s", names, name);
  for (size_t i = 0; i < d->count; i++) {
    if (d->value[i].column) {
      size_t length = strlen(d->value[i].key);
      print_value(&d->value[i], length > 11 ? (int)length + 2 : 13);
    } else {
      printf(", %s ", title_of(&d->value[i], title));
      print_value(&d->value[i], 0);
    }
  }
  for (size_t k = 0; d->running && k < d->running->guide_count + 2; k++)
    printf("%s%s", k ? ", " : ", over ", scene->nodes[strut_member_node(d->running, k)].name);
  printf("\n");
}

static void print_titles(const kind *k, int names, const description *d) {
  char title[40];
  printf("\n  %-*s", names, k->one);
  for (size_t i = 0; i < d->count; i++)
    if (d->value[i].column) printf("  %11s", title_of(&d->value[i], title));
  printf("\n");
}

static void print_things(const strut_model *model, const double *q, const kind *k, int names) {
  bool titled = false;
  for (size_t i = 0; i < k->count && i < MOST_MEMBERS; i++) {
    description d = {.count = 0};
    if (!k->describe(model, q, i, &d)) continue;
    if (!titled) print_titles(k, names, &d);
    titled = true;
    print_description(model->scene, name_of(k, i), names, &d);
  }
  if (k->count > MOST_MEMBERS)
    printf("  ... and %zu more; --json lists all\n", k->count - MOST_MEMBERS);
}

static void add_things(strut_json *json, const strut_model *model, const double *q, const kind *k) {
  struct cJSON *things = strut_json_object(json, json->root, k->all);
  for (size_t i = 0; i < k->count; i++) {
    description d = {.count = 0};
    if (!k->describe(model, q, i, &d)) continue;
    struct cJSON *thing = strut_json_object(json, things, name_of(k, i));
    strut_json_cells(json, thing, d.value, d.count);
    struct cJSON *nodes = d.running ? strut_json_array(json, thing, "nodes") : NULL;
    for (size_t n = 0; d.running && n < d.running->guide_count + 2; n++)
      strut_json_text(json, nodes, NULL, model->scene->nodes[strut_member_node(d.running, n)].name);
  }
}

static strut_status print_estimate(const strut_cost_estimate *estimate, const strut_model *model,
                                   const strut_experiment *experiment) {
  const strut_scene *scene = model->scene;
  kind kinds[KINDS];
  double *q = drawn_shape(model);
  if (!q) return strut_print_out_of_memory();
  printf("%s%svalid\n", scene->name, *scene->name ? ": " : "");
  print_counts(estimate);
  print_run(estimate, experiment);
  list_kinds(scene, kinds);
  for (int k = 0; k < KINDS; k++) print_things(model, q, &kinds[k], name_width(kinds));
  strut_release(q);
  return STRUT_OK;
}

static void add_estimate(strut_json *json, const strut_cost_estimate *estimate,
                         const strut_setup *setup) {
  const strut_scene *scene = &setup->scene;
  struct cJSON *root = json->root;
  strut_json_text(json, root, "name", scene->name);
  strut_json_text(json, root, "strut_version", STRUT_VERSION);
  strut_json_integer(json, root, "language", STRUT_LANGUAGE_VERSION);
  strut_json_integer(json, root, "nodes", (int64_t)estimate->count.nodes);
  strut_json_integer(json, root, "degrees_of_freedom", (int64_t)estimate->count.degrees_of_freedom);
  strut_json_integer(json, root, "bars", (int64_t)estimate->count.bars);
  strut_json_integer(json, root, "springs", (int64_t)estimate->count.springs);
  strut_json_integer(json, root, "cables", (int64_t)estimate->count.cables);
  strut_json_integer(json, root, "running_cables", (int64_t)estimate->count.running_cables);
  strut_json_integer(json, root, "laws", (int64_t)estimate->count.laws);
  strut_json_integer(json, root, "stops", (int64_t)estimate->count.stops);
  strut_json_integer(json, root, "contacts", (int64_t)estimate->count.contacts);
  strut_json_integer(json, root, "actuators", (int64_t)estimate->count.actuators);
  strut_json_integer(json, root, "loads", (int64_t)estimate->count.loads);
  strut_json_integer(json, root, "mass_nonzeros", (int64_t)estimate->matrix.mass_nonzeros);
  strut_json_integer(json, root, "factor_nonzeros", (int64_t)estimate->matrix.factor_nonzeros);
  strut_json_integer(json, root, "dense_entries", (int64_t)estimate->matrix.dense_entries);
  strut_json_integer(json, root, "bytes", (int64_t)estimate->bytes);
  strut_json_bool(json, root, "runnable", estimate->runnable);
  strut_json_number(json, root, "largest_frequency",
                    estimate->runnable ? estimate->largest_frequency / STRUT_TAU : (double)NAN);
  strut_json_number(json, root, "step", setup->experiment.step);
  strut_json_number(json, root, "step_limit",
                    estimate->runnable ? estimate->step_limit : (double)NAN);
  strut_json_bool(json, root, "step_limit_exact", estimate->step_limit_exact);
  strut_json_bool(json, root, "step_limit_bound", estimate->limits.bound);
  struct cJSON *limits = strut_json_object(json, root, "step_limits");
  for (size_t i = 0; strut_integrator_at(i) && estimate->runnable; i++)
    strut_json_number(json, limits, strut_integrator_at(i)->name,
                      strut_step_limit_of_method(&estimate->limits, strut_integrator_at(i)));
}

static bool add_warnings(strut_json *json, const strut_setup *setup, strut_open_report *report) {
  strut_findings found = {0};
  strut_status status = strut_setup_warn(setup, &found);
  struct cJSON *warnings = strut_json_array(json, json->root, "warnings");
  for (size_t i = 0; i < found.count; i++) {
    struct cJSON *warning = strut_json_object(json, warnings, NULL);
    strut_json_text(json, warning, "code", found.items[i].key);
    strut_json_text(json, warning, "text", found.items[i].message);
  }
  struct cJSON *messages = strut_json_array(json, json->root, "messages");
  strut_add_diagnostics(json, messages, &report->diagnostics);
  strut_add_warnings(json, messages, &found, &setup->scene, &report->diagnostics);
  strut_findings_free(&found);
  return status == STRUT_OK;
}

static strut_status print_json(const strut_cost_estimate *estimate, const strut_model *model,
                               const strut_setup *setup, strut_open_report *report) {
  double *q = drawn_shape(model);
  if (!q) return strut_print_out_of_memory();
  strut_json json = strut_json_begin();
  strut_json_bool(&json, json.root, "valid", true);
  add_estimate(&json, estimate, setup);
  kind kinds[KINDS];
  list_kinds(model->scene, kinds);
  for (int k = 0; k < KINDS; k++) add_things(&json, model, q, &kinds[k]);
  strut_release(q);
  if (!add_warnings(&json, setup, report)) json.failed = true;
  return strut_print_block(strut_json_end(&json));
}

/* Does the scene fix the method of a run? If not, it is for statics, or --accuracy chooses. */
static bool has_fixed_method(const strut_experiment *e) {
  bool by_hand = !(e->accuracy > 0.0);
  return by_hand && (e->step != 0.0 || e->duration != 0.0 || e->periods != 0.0);
}

/* What is wrong, as JSON; returns `status`. */
static strut_status print_wrong(strut_status status, const strut_error *error,
                                strut_open_report *report) {
  strut_json json = strut_json_begin();
  strut_json_bool(&json, json.root, "valid", false);
  struct cJSON *messages = strut_json_array(&json, json.root, "messages");
  strut_add_diagnostics(&json, messages, &report->diagnostics);
  if (error->message[0])
    strut_add_message(&json, messages, report->diagnostics.file, "error", error->message);
  strut_json_integer(&json, json.root, "unlisted", (int64_t)report->diagnostics.unstored);
  strut_status printed = strut_print_block(strut_json_end(&json));
  return printed != STRUT_OK ? printed : status;
}

static strut_status open_checked(const strut_arguments *arguments, strut_setup *setup,
                                 strut_open_report *report) {
  if (!arguments->json) return strut_open_model(arguments, STRUT_OPEN_AS_RUN, setup);
  strut_status status = strut_open_model_reported(arguments, STRUT_OPEN_AS_RUN, setup, report);
  bool located = status == STRUT_BAD_SCENE && report->diagnostics.count;
  if (located || report->error.message[0]) return print_wrong(status, &report->error, report);
  return status; /* what is not about the scene was printed */
}

static strut_status check_model(const strut_arguments *arguments, strut_open_report *report) {
  strut_setup setup;
  strut_cost_estimate estimate;
  strut_model *model = NULL;
  strut_error error = {0};
  strut_status status = open_checked(arguments, &setup, report);
  if (status != STRUT_OK) return status;
  status = strut_run_options_apply(&strut_command_check, arguments, &setup);
  if (status != STRUT_OK) {
    strut_setup_free(&setup);
    return status;
  }
  status = strut_model_compile(&setup.scene, &model, &error);
  if (status == STRUT_OK && has_fixed_method(&setup.experiment))
    status = strut_integrator_check(model, &setup.experiment, &error);
  if (status == STRUT_OK) status = strut_cost_estimate_describe(model, &estimate, &error);
  if (status == STRUT_OK) print_bands(model, &setup.experiment);
  if (status == STRUT_OK && (status = strut_warn_of_scene(&setup))) {
    /* reported already */
  } else if (status != STRUT_OK) {
    if (arguments->json && error.message[0])
      status = print_wrong(status, &error, report);
    else
      strut_print_error(&error);
  } else if (arguments->json) {
    status = print_json(&estimate, model, &setup, report);
  } else if (!arguments->quiet) {
    status = print_estimate(&estimate, model, &setup.experiment);
  }
  strut_model_free(model);
  strut_setup_free(&setup);
  return status;
}

static strut_status run_check(const strut_arguments *arguments) {
  strut_open_report report = {.text = NULL};
  if (strut_is_study(arguments->model)) return strut_check_study(&strut_command_check, arguments);
  strut_status status = check_model(arguments, &report);
  strut_open_report_free(&report);
  return status;
}

static const strut_refused_option refused[] = {
    {"plot", "'strut view' and 'strut run --plot' draw a model"},
    {"output", "it only prints; --json prints everything"},
    {"threads", "nothing takes long enough"},
    {NULL, NULL}};

const strut_command strut_command_check = {
    .name = "check",
    .model = "MODEL",
    .summary = "validates a model and describes what a run of it computes",
    .details =
        "\nPrints the numbers of nodes and members, the largest stable step, and for each member\n"
        "its rest length in each of the four forms that the language accepts. Hinges, cells,\n"
        "collisions and distances have tables of their own.\n"
        "--json lists all messages with their places, for editors; a study is checked, too.\n",
    .options = options,
    .run = run_check,
    .refused = refused,
};
