/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The values of a comparison. */
#include "engine/study/compare/compare.h"

#include <math.h>
#include <string.h>

#include "engine/output/result_values.h"

static const strut_scene *scene_of(const strut_compare_column *column) {
  return &column->input->setup->scene;
}

static const char *quantity_name(const strut_result_object *of, size_t i) {
  (void)of;
  return strut_compare_row_of((strut_compare_quantity)i).key;
}

static strut_value quantity_unit(const strut_result_object *of, size_t i) {
  const char *unit = strut_compare_row_of((strut_compare_quantity)i).unit;
  (void)of;
  return STRUT_VALUE_AS_IF(*unit, TEXT(unit));
}

static strut_value quantity_value(const strut_result_object *of, size_t i) {
  double value = ((const strut_compare_column *)of->at)->cell[i].value;
  const strut_compare_row row = strut_compare_row_of((strut_compare_quantity)i);
  const char *unit = strcmp(row.unit, "1") == 0 ? "" : row.unit;
  strut_value cell =
      isfinite(value) && !*row.unit ? STRUT_VALUE_AS_COUNT(value) : STRUT_VALUE_AS_NUMBER(value);
  cell.own_unit = unit;
  return cell;
}

static strut_value quantity_reason(const strut_result_object *of, size_t i) {
  const char *reason = ((const strut_compare_column *)of->at)->cell[i].reason;
  return STRUT_VALUE_AS_IF(reason, TEXT(reason));
}

#define STATE(X)                                                                                   \
  X("name", "", TEXT(state->name), "of the equilibrium", .label = {""})                            \
  X("energy", "J", NUMBER(state->energy), "at rest on the real ground", .label = {""})
STRUT_VALUES_HERE(state_values, STATE, const strut_compare_column *c = of->outer->at;
                  const strut_equilibrium *state = &c->equilibria.list[*(const int32_t *)of->at])

#define BARRIER(X)                                                                                 \
  X("from", "", TEXT(list[barrier->from].name), "an equilibrium")                                  \
  X("to", "", TEXT(list[barrier->to].name), "another one")                                         \
  X("height", "J", NUMBER(barrier->height), "above `from`")
STRUT_VALUES_HERE(
    barrier_values, BARRIER, const strut_barrier *barrier = of->at;
    const strut_equilibrium *list = ((const strut_compare_column *)of->outer->at)->equilibria.list)

#define NODE(X)                                                                                    \
  X("position", "m", NUMBERS(of->at, 2), "in that shape")                                          \
  X("stiffness", "N/m", IF(c->stiffness, NUMBERS(c->stiffness[of->index], 2)), "under unit loads")
STRUT_VALUES_HERE(node_values, NODE, const strut_compare_column *c = of->outer->at)

#define CONTACT(X)                                                                                 \
  X("duty", "1", NUMBER(contact->duty), "share of the time in contact")                            \
  X("max_height", "m", NUMBER(contact->max_height), "above the ground")
STRUT_VALUES_HERE(contact_values, CONTACT, const strut_contact_summary *contact = of->at)

#define DIFFERENCE(X)                                                                              \
  X("where", "", TEXT(d->where), "path of the key", .label = {""})                                 \
  X("change", "",                                                                                  \
    TEXT(!d->was  ? "added"                                                                        \
         : !d->is ? "removed"                                                                      \
                  : "changed"),                                                                    \
    "against the first", .label = {""})                                                            \
  X("was", "", TEXT(d->was), "in the first", .label = {""})                                        \
  X("is", "", TEXT(d->is), "here", .label = {""})
STRUT_VALUES_HERE(difference_values, DIFFERENCE, const strut_difference *d = of->at)

static const char *node_name(const strut_result_object *of, size_t i) {
  return scene_of(of->at)->nodes[i].name;
}

static const char *contact_name(const strut_result_object *of, size_t i) {
  return ((const strut_compare_column *)of->at)->contacts[i].node;
}

static const char *missing_name(const strut_result_object *of, size_t i) {
  return ((const strut_compare_column *)of->at)->input->without[i];
}

static const char *softest_node(const strut_compare_column *column, int axis) {
  return column->softest[axis] < 0 ? NULL : scene_of(column)->nodes[column->softest[axis]].name;
}

#define MODEL(X)                                                                                   \
  X("model", "", TEXT(c->input->label), "its label", .column = {"model"}, .label = {""})           \
  X("name", "", TEXT(scene_of(c)->name), "of its scene", .column = {"name"}, .label = {""})        \
  X("status", "", TEXT(strut_status_text(c->status)), "the worst of what was computed",            \
    .label = {""})                                                                                 \
  X("reason", "", TEXT(c->status == STRUT_OK ? NULL : c->message), "of it")                        \
  X("parameters", "", PARAMETERS, "of its scene")                                                  \
  X("values", "", MAP(STRUT_COMPARE_QUANTITIES, quantity_name, quantity_value), "of the rows",     \
    .column = {""}, .label = {""})                                                                 \
  X("reasons", "", MAP(STRUT_COMPARE_QUANTITIES, quantity_name, quantity_reason), "of null")       \
  X("states", "", LIST(c->states, c->state_count), "equilibria in which it stands",                \
    .rows = &state_values, .label = {""})                                                          \
  X("barriers", "", LIST(c->equilibria.barriers, c->equilibria.barrier_count), "between",          \
    .rows = &barrier_values)                                                                       \
  X("shape", "", TEXT(c->shape), "that is evaluated and drawn")                                    \
  X("nodes", "", NAMED((const double(*)[2])c->q, c->q ? scene_of(c)->node_count : 0, node_name),   \
    "in it", .rows = &node_values)                                                                 \
  X("softest_in_x", "", TEXT(softest_node(c, 0)), "node")                                          \
  X("softest_in_y", "", TEXT(softest_node(c, 1)), "node")                                          \
  X("motion", "", TEXT(c->motion), "periodic, irregular, ..., or the window of a mean",            \
    .label = {""})                                                                                 \
  X("repeats", "", IF(c->repeats > 0, COUNT(c->repeats)), "drive periods of one repetition",       \
    .label = {""})                                                                                 \
  X("still", "", IF(c->motion, FLAG(c->still)), "whether it does not travel")                      \
  X("velocity_method", "", TEXT(c->how), "how its velocity was found")                             \
  X("contacts", "", NAMED(c->contacts, c->contact_count, contact_name), "in the steady motion",    \
    .rows = &contact_values)                                                                       \
  X("differences", "", IF(of->index, LIST(in->differences, in->difference_count)),                 \
    "from the first", .rows = &difference_values, .label = {"against the first"})                  \
  X("without_parameters", "", IF(of->index, NAMES(missing_name, in->without_count)),               \
    "that were set and that it does not have", .label = {""})
STRUT_VALUES_HERE(model_values, MODEL, const strut_compare_column *c = of->at;
                  const strut_compare_input *in = c->input)

static const strut_scene *scene_of_model(const strut_result_object *of, size_t i) {
  return scene_of(&((const strut_compare *)of->at)->columns[i]);
}

static strut_value models_of(const strut_compare *compare) {
  strut_value list = STRUT_VALUE_AS_LIST(compare->columns, compare->count);
  list.scene = scene_of_model;
  return list;
}

#define COMPARISON(X)                                                                              \
  X("strut_version", "", TEXT(STRUT_VERSION), "that computed it")                                  \
  X("accuracy", "1", NUMBER(r->no_motion ? (double)NAN : r->accuracy), "asked of velocities")      \
  X("units", "", MAP(STRUT_COMPARE_QUANTITIES, quantity_name, quantity_unit), "of the rows")       \
  X("models", "", BY(models_of(r)), "in their order", .rows = &model_values, .label = {""})
STRUT_VALUES(strut_compare_values, COMPARISON, const strut_compare *r = of->at)
