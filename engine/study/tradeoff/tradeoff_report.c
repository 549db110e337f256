/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>

#include "engine/base/text.h"
#include "engine/output/result_values.h"
#include "engine/study/tradeoff/tradeoff_parts.h"

/* ---- words ---- */

const char *strut_tradeoff_group_text(const strut_tradeoff_row *row,
                                      char text[STRUT_TRADEOFF_TEXT]) {
  if (!isfinite(row->setting.refine))
    snprintf(text, STRUT_TRADEOFF_TEXT, "%s", row->setting.method->name);
  else if (row->setting.refine > 0)
    snprintf(text, STRUT_TRADEOFF_TEXT, "%s, refined %.3g", row->setting.method->name,
             row->setting.refine);
  else
    snprintf(text, STRUT_TRADEOFF_TEXT, "%s, refined", row->setting.method->name);
  return text;
}

const char *strut_tradeoff_step_text(const strut_tradeoff_row *row,
                                     char text[STRUT_TRADEOFF_TEXT]) {
  if (isfinite(row->setting.tolerance))
    snprintf(text, STRUT_TRADEOFF_TEXT, "%.0e", row->setting.tolerance);
  else
    snprintf(text, STRUT_TRADEOFF_TEXT, "%s", strut_quantity_of(row->setting.step, 3, "s").text);
  return text;
}

const char *strut_tradeoff_measure_text(strut_tradeoff_measure measure) {
  static const char *const names[] = {"", "velocity", "position", "energy"};
  return names[measure];
}

/* The mapping of the language that runs a row. With error control the error left depends on the grid by chance: its
   step is given in full. */
static void write_solver(const strut_tradeoff_row *row, char text[STRUT_VALUE_ROOM]) {
  bool adaptive = isfinite(row->setting.tolerance);
  int used = snprintf(text, STRUT_VALUE_ROOM,
                      "solver: {integrator: %s, step: ", row->setting.method->name);
  char *end = text + STRUT_VALUE_ROOM, *at = text + used;
  if (adaptive)
    at += snprintf(at, (size_t)(end - at), "%.17g s, tolerance: %.0e", row->setting.step,
                   row->setting.tolerance);
  else
    at += snprintf(at, (size_t)(end - at), "%s", strut_quantity_of(row->setting.step, 6, "s").text);
  if (row->setting.refine > 0 ||
      (!adaptive && !isfinite(row->setting.refine) && row->setting.method->events))
    at += snprintf(at, (size_t)(end - at), ", refine: %.3g",
                   row->setting.refine > 0 ? row->setting.refine : 1.0);
  snprintf(at, (size_t)(end - at), "}");
}

const char *strut_tradeoff_base_text(const strut_tradeoff *tradeoff,
                                     char text[3 * STRUT_TRADEOFF_TEXT]) {
  snprintf(text, 3 * STRUT_TRADEOFF_TEXT, "%s, %s", tradeoff->base_setting.method->name,
           strut_quantity_of(tradeoff->base_setting.step, 3, "s").text);
  return text;
}

/* ---- values ---- */

#define SPREAD(X)                                                                                  \
  X("median", "1", NUMBER(spread->median), "of the points", .column = {"median"})                  \
  X(NULL, "1", NUMBER(spread->count > 1 ? spread->median : (double)NAN), "",                       \
    .label = {"median", "%"})                                                                      \
  X("percentile_90", "1", NUMBER(spread->ninety), "of the points", .column = {"90 %"})             \
  X("worst", "1", NUMBER(spread->worst), "of the points", .column = {"worst"}, .label = {"", "%"}) \
  X("points", "1", NUMBERS(spread->values, spread->count), "at each of them")
STRUT_VALUES_HERE(spread_values, SPREAD, const strut_spread *spread = of->at)

static strut_value reference_name(const strut_result_object *of, size_t i) {
  const strut_model_variant *variant = of->at;
  return STRUT_VALUE_AS_IF(variant->reference[i][0], TEXT(variant->reference[i]));
}

#define VARIANT(X)                                                                                 \
  X("name", "", TEXT(f->name), "of the variant; the first is the unchanged model", .label = {""})  \
  X("remark", "", TEXT(f->remark[0] ? f->remark : NULL), "why it was not run, or an assumption",   \
    .label = {""})                                                                                 \
  X("run", "", FLAG(f->run), "whether it was")                                                     \
  X("reference", "", IF(f->run, ARRAY(2, reference_name)), "settings that agree on it",            \
    .label = {""})                                                                                 \
  X("values", "", IF(f->run, NUMBERS(f->value, r->point_count * r->value_count)),                  \
    "point by point")                                                                              \
  X("floor", "1", IF(f->run, PART(&f->floor_spread)), "how far they differ",                       \
    .rows = &spread_values, .label = {""})                                                         \
  X("model_error", "1", IF(f->run, PART(&f->model_spread)), "its change of the answer",            \
    .rows = &spread_values, .label = {""})
STRUT_VALUES_HERE(variant_values, VARIANT, const strut_model_variant *f = of->at;
                  const strut_tradeoff *r = of->outer->at)

static void write_group(const strut_result_object *of, char text[STRUT_VALUE_ROOM]) {
  strut_tradeoff_group_text(of->at, text);
}

#define SETTING(X)                                                                                 \
  X("model", "", TEXT(r->variants[row->variant].name), "its variant", .column = {"model"},         \
    .label = {""})                                                                                 \
  X("group", "", WORDS(write_group), "settings that differ by their step alone",                   \
    .column = {"group"}, .label = {"method"})                                                      \
  X("method", "", TEXT(row->setting.method->name), "of integration", .column = {"method"})         \
  X("refine", "1", NUMBER(row->setting.refine), "of steps with events", .column = {"refine"})      \
  X("step", "s", NUMBER(row->setting.step), "the largest, where it adapts",                        \
    .column = {"step [s]"}, .label = {""})                                                         \
  X("tolerance", "1", NUMBER(row->setting.tolerance), "of an adaptive method",                     \
    .column = {"tolerance"}, .label = {""})                                                        \
  X("evaluations", "1", NUMBER(row->evaluations), "of forces, over those of the base",             \
    .column = {"evaluations"}, .label = {"cost"})                                                  \
  X("rate", "1/s", NUMBER(row->rate), "evaluations for a simulated second")                        \
  X("cpu", "1", NUMBER(row->cpu), "CPU time over that of the base", .column = {"cpu"},             \
    .label = {"CPU"})                                                                              \
  X("seconds", "s", NUMBER(row->seconds), "CPU time of a run", .column = {"seconds [s]"})          \
  X("step_error", "1", PART(&row->error_spread), "from its model's answer", .column = {"error "},  \
    .rows = &spread_values)                                                                        \
  X("total_error", "1", PART(&row->total_spread), "from the unchanged model's",                    \
    .column = {"total "}, .rows = &spread_values, .label = {"error"})                              \
  X("values", "", NUMBERS(row->value, r->point_count * r->value_count), "point by point")          \
  X("diverged", "", COUNT(row->diverged), "points", .column = {"diverged"})                        \
  X(NULL, "", COUNT(r->point_count), "", .column = {"points"})                                     \
  X("above_limit", "", FLAG(row->above), "of stability: runs refuse the step")                     \
  X("front", "", FLAG(row->front), "Pareto-optimal in its variant", .column = {"front"},           \
    .label = {"best"})                                                                             \
  X("base", "", FLAG(row->base), "costs are relative to it", .column = {"base"})
STRUT_VALUES_HERE(setting_values, SETTING, const strut_tradeoff_row *row = of->at;
                  const strut_tradeoff *r = of->outer->at)

static void write_advice(const strut_result_object *of, char text[STRUT_VALUE_ROOM]) {
  const strut_tradeoff *tradeoff = of->at;
  const strut_tradeoff_advice a =
      strut_tradeoff_advise(tradeoff, strut_tradeoff_level(tradeoff, of->index));
  if (a.row >= 0)
    write_solver(&tradeoff->rows[a.row], text);
  else
    snprintf(text, STRUT_VALUE_ROOM, "%s",
             a.known ? "no setting measured keeps it" : "not known: the references differ by more");
}

#define ADVICE(X)                                                                                  \
  X("error", "1", NUMBER(a.error), "to be kept", .label = {"", "%"})                               \
  X("known", "", FLAG(a.known), "whether the references agree well enough")                        \
  X(NULL, "1", NUMBER(best ? strut_tradeoff_promise(r, a.row) : (double)NAN), "",                  \
    .label = {"at most", "%"})                                                                     \
  X(NULL, "1/s", NUMBER(best ? best->rate : (double)NAN), "", .label = {"force evaluations"})      \
  X(NULL, "1", NUMBER(best ? best->evaluations : (double)NAN), "", .label = {"cost"})              \
  X("setting", "", INDEX(a.row), "the cheapest, from 0")                                           \
  X("half_setting", "", INDEX(a.half), "likewise, for half the error")                             \
  X("half_cost", "1", NUMBER(a.cost), "of it, over that of `setting`",                             \
    .label = {"for half of it"})                                                                   \
  X("next_method", "", INDEX(a.other), "the cheapest of another method")                           \
  X(NULL, "", WORDS(write_advice), "", .label = {"cheapest setting"})
STRUT_VALUES_HERE(
    advice_values, ADVICE, const strut_tradeoff *r = of->at;
    const strut_tradeoff_advice a = strut_tradeoff_advise(r, strut_tradeoff_level(r, of->index));
    const strut_tradeoff_row *best = a.row < 0 ? NULL : &r->rows[a.row])

#define WORK(X)                                                                                    \
  X("evaluations", "", NUMBER(r->work), "of forces, of all runs", .label = {"force evaluations"})  \
  X("unit", "", NUMBER(r->work_unit), "those of a reference run", .label = {"of a reference run"}) \
  X("limit", "1", COUNT(STRUT_TRADEOFF_MOST_WORK), "of their ratio")                               \
  X("unrefined_series", "", COUNT(r->left_out), "that the limit kept from finer steps",            \
    .label = {""})                                                                                 \
  X("cut_by_time", "", FLAG(r->cut), "another machine may measure more")                           \
  X(NULL, "", IF(r->cut, TEXT("another machine may measure more")), "",                            \
    .label = {"cut by --cpu-time"})
STRUT_VALUES_HERE(work_values, WORK, const strut_tradeoff *r = of->at)

#define POINT(X) X(NULL, "", PARAMETERS, "")
STRUT_VALUES_HERE(point_values, POINT, )

static const strut_scene *scene_of(const strut_result_object *of, size_t i) {
  return &((const strut_tradeoff *)of->at)->setups[i]->scene;
}

static strut_value points_of(const strut_tradeoff *tradeoff) {
  strut_value points = STRUT_VALUE_AS_LIST(tradeoff->setups, tradeoff->point_count);
  points.scene = scene_of;
  return points;
}

static void write_base(const strut_result_object *of, char text[STRUT_VALUE_ROOM]) {
  strut_tradeoff_base_text(of->at, text);
}

#define TRADEOFF(X)                                                                                \
  X("measure", "", TEXT(strut_tradeoff_measure_text(r->measure)), "what errors are of",            \
    .label = {"errors of"})                                                                        \
  X("periods", "1", IF(r->periods > 0, NUMBER(r->periods)), "of a run")                            \
  X("duration", "s", NUMBER(r->duration), "of a run at the first point", .label = {""})            \
  X("scale", "m/s", IF(r->measure == STRUT_TRADEOFF_VELOCITY, NUMBER(r->scale)),                   \
    "velocities below it have errors relative to it", .label = {""})                               \
  X(NULL, "", WORDS(write_base), "", .label = {"cost 1"})                                          \
  X("base_setting", "", INDEX(r->base), "that costs are relative to; null: not run")               \
  X("base_evaluations", "", NUMBER(r->base_evaluations), "of forces",                              \
    .label = {"its force evaluations"})                                                            \
  X("base_seconds", "s", NUMBER(r->base_seconds), "CPU time")                                      \
  X("spent_seconds", "s", NUMBER(r->spent), "CPU time of the study")                               \
  X("work", "", PART(r), "its bound", .rows = &work_values, .label = {""})                         \
  X("points", "", BY(points_of(r)), "parameters of each operating point", .rows = &point_values)   \
  X("models", "", LIST(r->variants, r->variant_count), "variants", .rows = &variant_values,        \
    .label = {""})                                                                                 \
  X("settings", "", LIST(r->rows, r->row_count), "that were run", .rows = &setting_values,         \
    .label = {""})                                                                                 \
  X("advice", "", TIMES(strut_tradeoff_level_count(r)), "for each error", .rows = &advice_values,  \
    .label = {""})
STRUT_VALUES(strut_tradeoff_values, TRADEOFF, const strut_tradeoff *r = of->at)
