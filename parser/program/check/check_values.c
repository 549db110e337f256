/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What `strut check` finds, a row for each value: JSON, and the tables of its things. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/integrate/integrator.h"
#include "engine/output/result_values.h"
#include "parser/language/expression/units.h"
#include "parser/program/check/check_messages.h"
#include "parser/program/streams.h"
#include "parser/program/study/sweep.h"

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
/* How well the largest steps are known. */
static const char *limit_words(const strut_cost_estimate *e) {
  return !e->runnable          ? NULL
         : e->limits.bound     ? "lower bounds: the structure is too large for estimates"
         : e->step_limit_exact ? "from all eigenvalues"
                               : "within 1 %";
}

/* The scene's step, and whether its method can have it. */
static void write_step(const strut_result_object *of, char text[STRUT_VALUE_ROOM]) {
  const strut_check_result *c = of->at;
  const strut_experiment *experiment = &c->setup->experiment;
  const strut_integrator *method = strut_integrator_find(experiment->integrator);
  double limit =
      method ? strut_step_limit_of_method(&c->estimate->limits, method) : c->estimate->step_limit;
  if (c->estimate->runnable && experiment->step > 0)
    snprintf(text, STRUT_VALUE_ROOM, "%s%s", strut_quantity_of(experiment->step, DIGITS, "s").text,
             experiment->step > limit ? ": too large, strut run rejects it" : "");
}

/* A line of text alone, and a number that is above 0. */
#define SAYS(X, LABEL, TEXT_OF) X(NULL, "", IF(TEXT_OF, TEXT(TEXT_OF)), "", .label = {LABEL})
#define SOME(X, LABEL, COUNT_OF)                                                                   \
  X(NULL, "", IF((COUNT_OF) > 0, COUNT(COUNT_OF)), "", .label = {LABEL})
#define SCENE(X)                                                                                   \
  X("language", "", COUNT(STRUT_LANGUAGE_VERSION), "version of the scene's language")              \
  X("nodes", "", COUNT(e->count.nodes), "number", COLUMN)                                          \
  X("degrees_of_freedom", "", COUNT(e->count.degrees_of_freedom), "of the nodes", COLUMN)          \
  X("bars", "", COUNT(e->count.bars), "number", COLUMN)                                            \
  X("springs", "", COUNT(e->count.springs), "number", COLUMN)                                      \
  X("cables", "", COUNT(e->count.cables), "number", COLUMN)                                        \
  X("running_cables", "", COUNT(e->count.running_cables), "of the cables")                         \
  X("laws", "", COUNT(e->count.laws), "members with another law than the linear")                  \
  X("stops", "", COUNT(e->count.stops), "members with stops")                                      \
  SOME(X, "running cables", e->count.running_cables)                                               \
  SOME(X, "members with a law", e->count.laws)                                                     \
  SOME(X, "members with stops", e->count.stops)                                                    \
  SOME(X, "hinges", e->count.hinges)                                                               \
  SOME(X, "cells", e->count.cells)                                                                 \
  SOME(X, "collisions", e->count.collisions)                                                       \
  X("contacts", "", COUNT(e->count.contacts), "number", COLUMN)                                    \
  X("actuators", "", COUNT(e->count.actuators), "number", COLUMN)                                  \
  X("loads", "", COUNT(e->count.loads), "number", COLUMN)                                          \
  X("mass_nonzeros", "", COUNT(e->matrix.mass_nonzeros), "entries of the mass matrix")             \
  X("factor_nonzeros", "", COUNT(e->matrix.factor_nonzeros), "entries of its sparse factor")       \
  X("dense_entries", "", COUNT(e->matrix.dense_entries), "entries of dense inverses")              \
  X("bytes", "", COUNT(e->bytes), "of the compiled model")                                         \
  X(NULL, "B", NUMBER((double)e->bytes), "", .label = {"memory"})                                  \
  X("runnable", "", FLAG(e->runnable), "whether every free node has a mass")                       \
  SAYS(X, "no run", e->runnable ? NULL : "a free node has no mass: statics only")                  \
  SOME(X, "nonzeros of the mass matrix", e->runnable ? e->matrix.mass_nonzeros : 0)                \
  SOME(X, "and of its factor", e->runnable ? e->matrix.factor_nonzeros : 0)                        \
  X("largest_frequency", "Hz", KNOWN(e->runnable, NUMBER(e->largest_frequency / STRUT_TAU)),       \
    "undamped, all contacts closed", .label = {"highest frequency"})                               \
  X("step", "s", NUMBER(c->setup->experiment.step), "of the scene; 0: none")                       \
  X("step_limit", "s", KNOWN(e->runnable, NUMBER(e->step_limit)), "largest stable one of rk4")     \
  X("step_limit_exact", "", FLAG(e->step_limit_exact), "or within 1 %")                            \
  X("step_limit_bound", "", FLAG(e->limits.bound), "the limits are lower bounds")                  \
  X("step_limits", "s", MAP(e->runnable ? method_count() : 0, method_name, method_limit),          \
    "of all methods", .label = {"largest step of"})                                                \
  SAYS(X, "steps are known", limit_words(e))                                                       \
  SAYS(X, "feedback", e->feedback ? "not counted in this frequency and these steps" : NULL)        \
  X(NULL, "", WORDS(write_step), "", .label = {"step"})                                            \
  THINGS(X, member, members)                                                                       \
  THINGS(X, hinge, hinges)                                                                         \
  THINGS(X, cell, cells)                                                                           \
  THINGS(X, collision, collisions)                                                                 \
  THINGS(X, distance, distances)                                                                   \
  X("data", "", NAMED(of->scene->tables, of->scene->table_count, data_table_name), "by name",      \
    .rows = &data_table_values, .label = {"data"})                                                 \
  X("warnings", "", LIST(c->found.items, c->found.count), "of the scene", .rows = &warning_values)
STRUT_VALUES_HERE(scene_values, SCENE, const strut_check_result *c = of->at;
                  const strut_cost_estimate *e = c->estimate)

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

strut_status strut_check_print_tables(const strut_check_result *checked, int width) {
  strut_buffer text = {0};
  const strut_scene *scene = checked->model->scene;
  strut_buffer_add(&text, "%s%s%svalid\n", width == STRUT_REPORT_LATEX ? "% " : "", scene->name,
                   *scene->name ? ": " : "");
  strut_values_add_tables(&text, &scene_values, &(strut_result_object){checked, NULL, scene, 0},
                          &(strut_table_page){width, MOST_THINGS, DIGITS});
  return strut_print_block(strut_buffer_take(&text));
}
