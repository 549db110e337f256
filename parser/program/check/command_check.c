/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/commands.h"

#include <math.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/integrate/integrator.h"
#include "engine/output/result_values.h"
#include "parser/language/expression/expression.h"
#include "parser/program/check/check_messages.h"
#include "parser/program/command/scene_options.h"
#include "parser/program/study/sweep.h"

/* What `strut check` finds, a row for each value: JSON, and the tables of its things. */

enum { MOST_THINGS = 40, DIGITS = 5 };

/* ---- things, as they are drawn ---- */

/* Columns of a table, whose titles are the keys. */
#define COLUMN .label = {""}

static strut_element_pose pose_of(const strut_result_object *of, int32_t element) {
  const strut_check_result *result = strut_result_whole(of);
  strut_element_pose pose;
  strut_element_evaluate(result->model, element, result->model->members.rest, result->drawn,
                         (double)NAN, &pose);
  return pose;
}

/* Rest length, force and stiffness of a member as drawn; of one that is an element by its law. */
static strut_rest rest_of(const strut_result_object *of) {
  const strut_model *model = ((const strut_check_result *)strut_result_whole(of))->model;
  strut_rest rest = {0};
  strut_member_rest(of->scene, of->index, &rest);
  const strut_element *element = strut_element_of_member(&model->elements, (int32_t)of->index);
  if (!element || element->role != STRUT_ELEMENT_MEMBER) return rest;
  rest.pretension = pose_of(of, (int32_t)(element - model->elements.element)).force;
  rest.force_density = rest.drawn_length > 0.0 ? rest.pretension / rest.drawn_length : 0.0;
  rest.stiffness = element->numbers.stiffness;
  return rest;
}

static const char *carries_name(const strut_member *member) {
  static const char *const names[] = {"both", "tension", "compression"};
  return names[member->kind == STRUT_CABLE ? STRUT_CARRIES_TENSION : member->law.carries];
}

/* The stiffness of a member's stops [N/m]. */
static double stop_stiffness(const strut_model *model, size_t j) {
  const strut_element *element = strut_element_of_member(&model->elements, (int32_t)j);
  while (element && element->role == STRUT_ELEMENT_MEMBER)
    element = element->sibling >= 0 ? &model->elements.element[element->sibling] : NULL;
  return element ? element->numbers.stiffness : 0.0;
}

static strut_value way_of(const strut_result_object *of, size_t k) {
  return STRUT_VALUE_AS_TEXT(of->scene->nodes[strut_member_node(of->at, k)].name);
}

/* Its rest length is given in the four forms that the language accepts. */
#define MEMBER(X)                                                                                  \
  X("kind", "", TEXT(strut_member_kind_name(m->kind)), "bar, spring or cable", COLUMN)             \
  X("drawn_length", "m", NUMBER(rest.drawn_length), "as drawn", COLUMN)                            \
  X("rest_length", "m", NUMBER(rest.length), "without force", COLUMN)                              \
  X("rest_length_ratio", "1", NUMBER(rest.ratio), "to the drawn length", COLUMN)                   \
  X("pretension", "N", NUMBER(rest.pretension), "as drawn", COLUMN)                                \
  X("force_density", "N/m", NUMBER(rest.force_density), "as drawn", COLUMN)                        \
  X("stiffness", "N/m", NUMBER(rest.stiffness), "as drawn", COLUMN)                                \
  X("law", "", IF(lawful, TEXT(strut_law_at(m->law.kind)->word)), "of its force", COLUMN)          \
  X("carries", "", IF(lawful, TEXT(carries_name(m))), "tension, compression or both", COLUMN)      \
  X("guide_friction", "1", POSITIVE(m->guide_friction), "coefficient", COLUMN)                     \
  X("guide_radius", "m", POSITIVE(m->guide_radius), "of its guides", COLUMN)                       \
  X("breaks_at", "N", POSITIVE(m->breaks_at), "force", COLUMN)                                     \
  X("released_at", "s", POSITIVE(m->released_at), "time", COLUMN)                                  \
  X("shortest", "m", POSITIVE(m->shortest), "length, by a stop", COLUMN)                           \
  X("longest", "m", POSITIVE(m->longest), "length, by a stop", COLUMN)                             \
  X("stop_stiffness", "N/m", POSITIVE(stops ? stop_stiffness(model, of->index) : 0.0), "of both",  \
    COLUMN)                                                                                        \
  X("stop_damping", "N s/m", POSITIVE(stops ? m->stop_damping : 0.0), "of both", COLUMN)           \
  X("nodes", "", IF(m->guide_count, ARRAY(m->guide_count + 2, way_of)), "that it runs over",       \
    .label = {"over"})
STRUT_VALUES_HERE(member_values, MEMBER, const strut_member *m = of->at;
                  strut_rest rest = rest_of(of);
                  const strut_model *model = ((const strut_check_result *)of->outer->at)->model;
                  bool stops = m->shortest > 0.0 || m->longest > 0.0;
                  bool lawful = m->law.kind != STRUT_LAW_LINEAR ||
                                m->law.carries != STRUT_CARRIES_BOTH)

#define HINGE(X)                                                                                   \
  X("drawn_angle", "rad", NUMBER(pose.strain), "as drawn", COLUMN)                                 \
  X("rest_angle", "rad", NUMBER(pose.natural), "without moment", COLUMN)                           \
  X("moment", "N m", NUMBER(pose.force), "as drawn", COLUMN)                                       \
  X("stiffness", "N m/rad", NUMBER(elements->element[i].numbers.stiffness), "as drawn", COLUMN)    \
  X("breaks_at", "N m", POSITIVE(h->breaks_at), "moment", COLUMN)                                  \
  X("released_at", "s", POSITIVE(h->released_at), "time", COLUMN)
#define ELEMENTS                                                                                   \
  const strut_element_table *elements =                                                            \
      &((const strut_check_result *)of->outer->at)->model->elements
STRUT_VALUES_HERE(hinge_values, HINGE, const strut_hinge *h = of->at; ELEMENTS;
                  int32_t i = strut_element_find(elements, STRUT_ELEMENT_HINGE, (int32_t)of->index);
                  strut_element_pose pose = pose_of(of, i))

#define CELL(X)                                                                                    \
  X("drawn_area", "m^2", NUMBER(fabs(strut_cell_drawn(of->scene, of->index))), "as drawn", COLUMN) \
  X("pressure", "N/m", NUMBER(cell->pressure), "pressure inside", COLUMN)                          \
  X("outside", "N/m", NUMBER(cell->outside), "pressure there", COLUMN)                             \
  X("content", "",                                                                                 \
    TEXT(strut_cell_is_elastic(cell)         ? "elastic"                                           \
         : cell->law == STRUT_LAW_PRESSURE   ? "given pressure"                                    \
         : cell->law == STRUT_LAW_ISOTHERMAL ? "isothermal gas"                                    \
                                             : "isentropic gas"),                                  \
    "in words", COLUMN)
STRUT_VALUES_HERE(cell_values, CELL, const strut_cell *cell = of->at)

/* The least distance of the surfaces of a collision in the drawn shape. */
static double drawn_gap(const strut_result_object *of, const strut_element_table *elements) {
  int32_t first = strut_element_find(elements, STRUT_ELEMENT_COLLISION, (int32_t)of->index);
  double gap = HUGE_VAL;
  for (int32_t k = first; k < strut_element_end(elements, first); k++) {
    strut_element_pose pose = pose_of(of, k);
    gap = fmin(gap, pose.strain - pose.natural);
  }
  return gap;
}

#define COLLISION(X)                                                                               \
  X("thickness", "m", NUMBER(c->thickness), "of both together", COLUMN)                            \
  X("drawn_gap", "m", NUMBER(drawn_gap(of, elements)), "as drawn", COLUMN)                         \
  X("stiffness", "N/m", NUMBER(c->stiffness), "of the contact", COLUMN)                            \
  X("damping", "N s/m", NUMBER(c->damping), "of the contact", COLUMN)
STRUT_VALUES_HERE(collision_values, COLLISION, const strut_collision *c = of->at; ELEMENTS)

#define DISTANCE(X)                                                                                \
  X("drawn", "m", NUMBER(strut_distance_drawn(of->scene, of->index)), "as drawn", COLUMN)          \
  X("rest", "m", NUMBER(strut_distance_rest(of->scene, of->index)), "without force", COLUMN)       \
  X("stiffness", "N/m", NUMBER(elements->element[i].numbers.stiffness), "at rest", COLUMN)         \
  X("damping", "N s/m", NUMBER(s->damping), "of it", COLUMN)                                       \
  X("law", "", TEXT(strut_law_at(s->law.kind)->word), "of its force", COLUMN)
STRUT_VALUES_HERE(distance_values, DISTANCE, const strut_distance_spring *s = of->at; ELEMENTS;
                  int32_t i = strut_element_find(elements, STRUT_ELEMENT_DISTANCE,
                                                 (int32_t)of->index))

static const char *member_name(const strut_result_object *of, size_t i) {
  strut_rest rest;
  return strut_member_rest(of->scene, i, &rest) ? of->scene->members[i].name : NULL;
}
#define NAME_OF(THING, THINGS)                                                                     \
  static const char *THING##_name(const strut_result_object *of, size_t i) {                       \
    return of->scene->THINGS[i].name;                                                              \
  }
NAME_OF(hinge, hinges)
NAME_OF(cell, cells)
NAME_OF(collision, collisions)
NAME_OF(distance, distances)

/* ---- the whole ---- */

static const char *method_name(const strut_result_object *of, size_t i) {
  (void)of;
  return strut_integrator_at(i)->name;
}

static strut_value method_limit(const strut_result_object *of, size_t i) {
  const strut_check_result *result = of->at;
  double limit = strut_step_limit_of_method(&result->estimate->limits, strut_integrator_at(i));
  return STRUT_VALUE_AS_NUMBER(limit);
}

/* The largest step of the scene's method [s]. */
static double limit_of_run(const strut_check_result *result) {
  const strut_integrator *method = strut_integrator_find(result->setup->experiment.integrator);
  return method ? strut_step_limit_of_method(&result->estimate->limits, method)
                : result->estimate->step_limit;
}

static size_t method_count(void) {
  size_t count = 0;
  while (strut_integrator_at(count)) count++;
  return count;
}

#define WARNING(X)                                                                                 \
  X("code", "", TEXT(finding->key), "for programs")                                                \
  X("text", "", TEXT(finding->message), "one sentence")
STRUT_VALUES_HERE(warning_values, WARNING, const strut_finding *finding = of->at)

static const char *unit_of(const strut_data_column *d) {
  const char *unit = d->unit ? strut_dimension_unit(d->dimension) : "";
  return strcmp(unit, "1") == 0 ? "" : unit;
}

static bool has_range(const strut_data_column *d) { return d->values && !isnan(d->least); }

#define DATA_COLUMN(X)                                                                             \
  X("unit", "", KNOWN(d->unit != NULL, TEXT(d->unit)), "as given; null: not known", COLUMN)        \
  X("numbers", "", FLAG(d->values != NULL), "or texts", COLUMN)                                    \
  X("least", "", KNOWN(has_range(d), CALLED("least", unit_of(d), d->least)), "in SI", COLUMN)      \
  X("most", "", KNOWN(has_range(d), CALLED("most", unit_of(d), d->most)), "in SI", COLUMN)         \
  X("gaps", "", COUNT(d->gap_count), "rows without a value", COLUMN)
STRUT_VALUES_HERE(data_column_values, DATA_COLUMN, const strut_data_column *d = of->at)

static const char *data_column_name(const strut_result_object *of, size_t i) {
  return ((const strut_data_table *)of->at)->columns[i].name;
}

#define DATA_TABLE(X)                                                                              \
  X("file", "", TEXT(t->file), "as the scene names it", COLUMN)                                    \
  X("rows", "", COUNT(t->row_count), "below the header", COLUMN)                                   \
  X("columns", "", NAMED(t->columns, t->column_count, data_column_name), "by name",                \
    .rows = &data_column_values, .label = {"column"})
STRUT_VALUES_HERE(data_table_values, DATA_TABLE, const strut_data_table *t = of->at)

static const char *data_table_name(const strut_result_object *of, size_t i) {
  return of->scene->tables[i].name;
}

#define THINGS(X, THING, OF)                                                                       \
  X(#OF, "", NAMED(of->scene->OF, of->scene->THING##_count, THING##_name), "by name",              \
    .rows = &THING##_values, .label = {#THING})
#define LINE .label = {""}
#define NOT_ZERO .label = {"", "0"}
#define COUNTED(X, NAME, WHAT, ...) X(#NAME, "", COUNT(e->count.NAME), WHAT, __VA_ARGS__)
#define SCENE(X)                                                                                   \
  X("language", "", COUNT(STRUT_LANGUAGE_VERSION), "version of the scene's language")              \
  COUNTED(X, nodes, "number", LINE)                                                                \
  COUNTED(X, degrees_of_freedom, "of the nodes", LINE)                                             \
  COUNTED(X, bars, "number", LINE)                                                                 \
  COUNTED(X, springs, "number", LINE)                                                              \
  COUNTED(X, cables, "number", LINE)                                                               \
  COUNTED(X, running_cables, "of the cables", NOT_ZERO)                                            \
  COUNTED(X, laws, "members with another law than the linear", NOT_ZERO)                           \
  COUNTED(X, stops, "members with stops", NOT_ZERO)                                                \
  COUNTED(X, contacts, "number", LINE)                                                             \
  COUNTED(X, actuators, "number", LINE)                                                            \
  COUNTED(X, loads, "number", LINE)                                                                \
  X("mass_nonzeros", "", COUNT(e->matrix.mass_nonzeros), "entries of the mass matrix", LINE)       \
  X("factor_nonzeros", "", COUNT(e->matrix.factor_nonzeros), "entries of its sparse factor", LINE) \
  X("dense_entries", "", COUNT(e->matrix.dense_entries), "entries of dense inverses")              \
  X("bytes", "B", COUNT(e->bytes), "of the compiled model", .label = {"memory"})                   \
  X("runnable", "", FLAG(e->runnable), "whether every free node has a mass")                       \
  X(NULL, "", TEXT(e->runnable ? NULL : "a free node has no mass: statics only"), "",              \
    .label = {"no run"})                                                                           \
  X("largest_frequency", "Hz", KNOWN(e->runnable, NUMBER(e->largest_frequency / STRUT_TAU)),       \
    "undamped, all contacts closed", .label = {"highest frequency"})                               \
  X("step", "s", NUMBER(step), "of the scene; 0: none", NOT_ZERO)                                  \
  X(NULL, "", TEXT(step > limit ? "too large: strut run rejects it" : NULL), "",                   \
    .label = {"the step is"})                                                                      \
  X("step_limit", "s", KNOWN(e->runnable, NUMBER(e->step_limit)), "largest stable one of rk4")     \
  X(NULL, "",                                                                                      \
    TEXT(!e->runnable          ? NULL                                                              \
         : e->step_limit_exact ? "from all eigenvalues"                                            \
                               : "within 1 %"),                                                    \
    "", .label = {"step limits"})                                                                  \
  X(NULL, "", TEXT(e->feedback ? "not counted in this frequency and these steps" : NULL), "",      \
    .label = {"feedback"})                                                                         \
  X("step_limit_exact", "", FLAG(e->step_limit_exact), "or within 1 %")                            \
  X("step_limits", "s", MAP(e->runnable ? method_count() : 0, method_name, method_limit),          \
    "of all methods", .label = {"largest step of"})                                                \
  THINGS(X, member, members)                                                                       \
  THINGS(X, hinge, hinges)                                                                         \
  THINGS(X, cell, cells)                                                                           \
  THINGS(X, collision, collisions)                                                                 \
  THINGS(X, distance, distances)                                                                   \
  X("data", "", NAMED(of->scene->tables, of->scene->table_count, data_table_name), "by name",      \
    .rows = &data_table_values, .label = {"data"})                                                 \
  X("warnings", "", LIST(c->found.items, c->found.count), "of the scene", .rows = &warning_values)
STRUT_VALUES_HERE(scene_values, SCENE, const strut_check_result *c = of->at;
                  const strut_cost_estimate *e = c->estimate;
                  double step = c->setup->experiment.step, limit = limit_of_run(c))

#define CHECKED(X)                                                                                 \
  X("valid", "", FLAG(c->valid), "whether there is no error")                                      \
  X("study", "", IF(c->study, TEXT(c->valid ? c->study->file.study.name : NULL)), "its name")      \
  X("points", "", IF(c->study, KNOWN(c->valid, COUNT(c->study->plan.points))), "of a study")       \
  X(NULL, "", IF(c->model, SAME), "", .rows = &scene_values)                                       \
  X("messages", "", LIST(c->messages.list, c->messages.count), "errors, warnings and notes",       \
    .rows = &strut_message_values)                                                                 \
  X("unlisted", "", IF(!c->valid && !c->study, COUNT(c->unlisted)), "messages beyond the first")
STRUT_VALUES(strut_check_values, CHECKED, const strut_check_result *c = of->at)

strut_status strut_check_print(strut_check_result *c) {
  char *text = c->messages.failed
                   ? NULL
                   : strut_values_json(&strut_check_values, c, c->model ? c->model->scene : NULL);
  strut_release(c->messages.list);
  strut_arena_free(&c->messages.arena);
  strut_findings_free(&c->found);
  return strut_print_block(text);
}

/* Prints what a valid model consists of, its largest steps, and a table for each kind of its things. */
static strut_status print_text(const strut_check_result *checked, int width) {
  strut_buffer text = {0};
  const strut_scene *scene = checked->model->scene;
  strut_buffer_add(&text, "%s%s%svalid\n", width == STRUT_REPORT_LATEX ? "% " : "", scene->name,
                   *scene->name ? ": " : "");
  strut_values_add_tables(&text, &scene_values, &(strut_result_object){checked, NULL, scene, 0},
                          &(strut_table_page){width, MOST_THINGS, DIGITS});
  return strut_print_block(strut_buffer_take(&text));
}

static const strut_option options[] = {
    STRUT_SET_OPTION,
    {.table = strut_experiment_options},
    STRUT_PRINT_OPTIONS,
    {.name = NULL},
};

static strut_status print_json(strut_check_result *result, strut_open_report *report) {
  strut_status status = strut_setup_warn(result->setup, &result->found);
  strut_messages_add_diagnostics(&result->messages, &report->diagnostics);
  strut_messages_add_warnings(&result->messages, &result->found, &result->setup->scene,
                              &report->diagnostics);
  result->messages.failed = result->messages.failed || status != STRUT_OK;
  return strut_check_print(result);
}

static strut_status print_valid(const strut_arguments *arguments, strut_check_result *result,
                                strut_open_report *report) {
  result->drawn = strut_allocate((size_t)result->model->length, sizeof *result->drawn);
  if (!result->drawn) return strut_print_out_of_memory();
  const strut_scene *scene = result->model->scene;
  for (size_t i = 0; i < 2 * scene->node_count; i++)
    result->drawn[i] = scene->nodes[i / 2].position[i % 2];
  strut_status status = arguments->json ? print_json(result, report)
                                        : print_text(result, strut_report_width(arguments));
  strut_release(result->drawn);
  return status;
}

/* Does the scene fix the method of a run? If not, it is for statics, or --accuracy chooses. */
static bool has_fixed_method(const strut_experiment *experiment) {
  bool by_hand = !(experiment->accuracy > 0.0);
  return by_hand &&
         (experiment->step != 0.0 || experiment->duration != 0.0 || experiment->periods != 0.0);
}

/* What is wrong, as JSON; returns `status`. */
static strut_status print_wrong(strut_status status, const strut_error *error,
                                strut_open_report *report) {
  strut_check_result checked = {.unlisted = report->diagnostics.unstored};
  strut_messages_add_diagnostics(&checked.messages, &report->diagnostics);
  strut_messages_add_error(&checked.messages, report->diagnostics.file, error->message);
  strut_status printed = strut_check_print(&checked);
  return printed != STRUT_OK ? printed : status;
}

static strut_status open_checked(const strut_arguments *arguments, strut_setup *setup,
                                 strut_open_report *report) {
  strut_status status = strut_open_model(arguments, STRUT_OPEN_AS_RUN, setup, report);
  if (!arguments->json) return status;
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
  status = strut_run_options_apply(arguments, &setup);
  if (status == STRUT_OK) status = strut_model_compile(&setup.scene, &model, &error);
  if (status == STRUT_OK && has_fixed_method(&setup.experiment))
    status = strut_integrator_check(model, &setup.experiment, &error);
  if (status == STRUT_OK) status = strut_cost_estimate_describe(model, &estimate, &error);
  if (status == STRUT_OK) strut_check_bands(model, &setup.experiment);
  if (status == STRUT_OK) status = strut_warn_of_scene(&setup);
  strut_check_result checked = {
      .valid = true, .setup = &setup, .model = model, .estimate = &estimate};
  if (status != STRUT_OK && error.message[0]) /* others are reported already */
    status =
        arguments->json ? print_wrong(status, &error, report) : strut_print_failure(status, &error);
  else if (status == STRUT_OK && (arguments->json || !arguments->quiet))
    status = print_valid(arguments, &checked, report);
  strut_model_free(model);
  strut_setup_free(&setup);
  return status;
}

static strut_status run_check(const strut_arguments *arguments) {
  strut_open_report report = {.prints = !arguments->json};
  if (strut_is_study(arguments->model)) return strut_check_study(arguments);
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
