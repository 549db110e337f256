/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/number_text.h"
#include "engine/output/buffer.h"
#include "engine/output/result_values.h"
#include "engine/study/tradeoff/tradeoff.h"
#include "engine/study/tradeoff/tradeoff_parts.h"

/* ---- words ---- */

const char *strut_tradeoff_percent_text(double error, char text[STRUT_TRADEOFF_TEXT]) {
  if (isnan(error))
    snprintf(text, STRUT_TRADEOFF_TEXT, "-");
  else if (isinf(error))
    snprintf(text, STRUT_TRADEOFF_TEXT, "diverged");
  else if (error >= 10)
    snprintf(text, STRUT_TRADEOFF_TEXT, "%.0e %%", 100 * error);
  else if (error >= 0.0995)
    snprintf(text, STRUT_TRADEOFF_TEXT, "%.0f %%", 100 * error);
  else
    snprintf(text, STRUT_TRADEOFF_TEXT, "%.2g %%", 100 * error);
  return text;
}

const char *strut_tradeoff_group_text(const strut_tradeoff_row *row,
                                      char text[STRUT_TRADEOFF_TEXT]) {
  if (!isfinite(row->refine))
    snprintf(text, STRUT_TRADEOFF_TEXT, "%s", row->method->name);
  else if (row->refine > 0)
    snprintf(text, STRUT_TRADEOFF_TEXT, "%s, refined %.3g", row->method->name, row->refine);
  else
    snprintf(text, STRUT_TRADEOFF_TEXT, "%s, refined", row->method->name);
  return text;
}

const char *strut_tradeoff_step_text(const strut_tradeoff_row *row,
                                     char text[STRUT_TRADEOFF_TEXT]) {
  if (isfinite(row->tolerance))
    snprintf(text, STRUT_TRADEOFF_TEXT, "%.0e", row->tolerance);
  else
    snprintf(text, STRUT_TRADEOFF_TEXT, "%s", strut_quantity_of(row->step, 3, "s").text);
  return text;
}

const char *strut_tradeoff_measure_text(strut_tradeoff_measure measure) {
  static const char *const names[] = {"", "velocity", "position", "energy"};
  return names[measure];
}

/* "verlet-events, refined 8, 80 us". */
static const char *setting_text(const strut_tradeoff_row *row, char text[3 * STRUT_TRADEOFF_TEXT]) {
  char group[STRUT_TRADEOFF_TEXT], step[STRUT_TRADEOFF_TEXT];
  snprintf(text, 3 * STRUT_TRADEOFF_TEXT, "%s, %s%s", strut_tradeoff_group_text(row, group),
           isfinite(row->tolerance) ? "tolerance " : "", strut_tradeoff_step_text(row, step));
  return text;
}

/* The mapping of the language that runs a row. With error control the error left depends on the grid by chance: its
   step is given in full. */
static void add_solver(strut_buffer *text, const strut_tradeoff_row *row) {
  strut_buffer_add(text, "solver: {integrator: %s, step: ", row->method->name);
  if (isfinite(row->tolerance))
    strut_buffer_add(text, "%.17g s", row->step);
  else
    strut_buffer_add(text, "%s", strut_quantity_of(row->step, 6, "s").text);
  if (isfinite(row->tolerance)) strut_buffer_add(text, ", tolerance: %.0e", row->tolerance);
  if (!isfinite(row->tolerance) && !isfinite(row->refine) && row->method->events)
    strut_buffer_add(text, ", refine: 1");
  if (row->refine > 0) strut_buffer_add(text, ", refine: %.3g", row->refine);
  strut_buffer_add(text, "}");
}

const char *strut_tradeoff_base_text(const strut_tradeoff *r, char text[3 * STRUT_TRADEOFF_TEXT]) {
  snprintf(text, 3 * STRUT_TRADEOFF_TEXT, "%s, %s", r->base_method->name,
           strut_quantity_of(r->base_step, 3, "s").text);
  return text;
}

/* ---- advice: for one accuracy in words, else a line for each level ---- */

static void add_half(strut_buffer *text, const strut_tradeoff *r, const strut_tradeoff_advice *a) {
  char b[STRUT_TRADEOFF_TEXT];
  strut_buffer_add(text, "  half the error: ");
  if (a->half < 0)
    strut_buffer_add(text, "not measured\n");
  else if (a->half == a->row)
    strut_buffer_add(text, "kept by the same setting\n");
  else
    strut_buffer_add(text, "%.2f times that cost, interpolated between steps of %s\n", a->cost,
                     strut_tradeoff_group_text(&r->rows[a->half], b));
}

static void advise_accuracy(strut_buffer *text, const strut_tradeoff *r) {
  const strut_tradeoff_advice a = strut_tradeoff_advise(r, r->accuracy);
  char b[3 * STRUT_TRADEOFF_TEXT], c[3 * STRUT_TRADEOFF_TEXT], d[STRUT_TRADEOFF_TEXT];
  double floor = r->variants[0].floor_spread.worst;
  strut_buffer_add(text, "For an error of %s: ", strut_tradeoff_percent_text(a.error, b));
  if (!a.known) {
    strut_buffer_add(text, "not known: the references differ by %s\n",
                     strut_tradeoff_percent_text(floor, c));
    return;
  }
  if (a.row < 0) {
    strut_buffer_add(text, "no setting measured keeps it\n");
  } else {
    const strut_tradeoff_row *row = &r->rows[a.row];
    add_solver(text, row);
    strut_buffer_add(text, "\n  cost: %.3g force evaluations per simulated second, %.2g times %s; ",
                     row->rate, row->evaluations, strut_tradeoff_base_text(r, b));
    strut_buffer_add(text, "its error is at most %s\n",
                     strut_tradeoff_percent_text(strut_tradeoff_promise(r, a.row), d));
    add_half(text, r, &a);
  }
  if (a.other >= 0)
    strut_buffer_add(text, "  next best method: %s, at %.2g times that cost\n",
                     setting_text(&r->rows[a.other], c),
                     r->rows[a.other].evaluations / r->rows[a.row].evaluations);
  if (floor > 0)
    strut_buffer_add(text, "  certainty: the references differ by %s, %s of this error\n",
                     strut_tradeoff_percent_text(floor, b),
                     strut_tradeoff_percent_text(floor / a.error, c));
}

static void advise_levels(strut_buffer *text, const strut_tradeoff *r) {
  char b[STRUT_TRADEOFF_TEXT], c[STRUT_TRADEOFF_TEXT], d[3 * STRUT_TRADEOFF_TEXT];
  strut_buffer_add(text,
                   "The cheapest setting for an error that it and all finer settings keep\n"
                   "  %7s %12s %9s %9s %8s  setting\n",
                   "error", "forces/s", "cost", "for half", "CPU");
  for (size_t i = 0; i < strut_tradeoff_level_count(r); i++) {
    const strut_tradeoff_advice a = strut_tradeoff_advise(r, strut_tradeoff_level(r, i));
    char half[STRUT_TRADEOFF_TEXT] = "-", cpu[STRUT_TRADEOFF_TEXT] = "-";
    strut_buffer_add(text, "  %7s ", strut_tradeoff_percent_text(a.error, b));
    if (a.row < 0) {
      strut_buffer_add(text, "%s\n", a.known ? "no setting measured keeps it" : "not known");
      return;
    }
    const strut_tradeoff_row *row = &r->rows[a.row];
    if (isfinite(a.cost)) snprintf(half, sizeof half, "%.2f", a.cost);
    if (isfinite(row->cpu)) snprintf(cpu, sizeof cpu, "%.3g", row->cpu);
    strut_buffer_add(text, "%12.3g %9.3g %9s %8s  %s; at most %s\n", row->rate, row->evaluations,
                     half, cpu, setting_text(row, d),
                     strut_tradeoff_percent_text(strut_tradeoff_promise(r, a.row), c));
  }
}

/* The row of a variant that reaches some error level cheaper than the unchanged model, or -1. */
static int find_saving(const strut_tradeoff *r, int variant, double *level) {
  for (size_t i = strut_tradeoff_level_count(r); i-- > 0;) {
    *level = strut_tradeoff_level(r, i);
    int own = strut_tradeoff_best(r, 0, *level);
    int other = strut_tradeoff_best(r, variant, *level);
    if (other >= 0 && (own < 0 || r->rows[other].evaluations < 0.9 * r->rows[own].evaluations))
      return other;
  }
  return -1;
}

static void advise_model(strut_buffer *text, const strut_tradeoff *r, int variant) {
  const strut_model_variant *f = &r->variants[variant];
  char a[STRUT_TRADEOFF_TEXT], b[STRUT_TRADEOFF_TEXT], c[STRUT_TRADEOFF_TEXT];
  if (!f->run) {
    strut_buffer_add(text, "  %s: not run; %s\n", f->name, f->remark);
    return;
  }
  double level = 0, change = f->model_spread.worst;
  int row = find_saving(r, variant, &level);
  strut_buffer_add(text, "  %s: %s the answer by %s", f->name,
                   r->point_count > 1 ? "in the worst case changes" : "changes",
                   strut_tradeoff_percent_text(change, a));
  if (row >= 0) {
    int own = strut_tradeoff_best(r, 0, level);
    strut_buffer_add(text, "; pays off at %s: %s, %s costs %.2g, ",
                     strut_tradeoff_percent_text(level, a), r->rows[row].method->name,
                     strut_tradeoff_step_text(&r->rows[row], b), r->rows[row].evaluations);
    if (own >= 0)
      strut_buffer_add(text, "the unchanged model %.2g\n", r->rows[own].evaluations);
    else
      strut_buffer_add(text, "the unchanged model does not achieve it\n");
  } else if (change > strut_tradeoff_level(r, 0)) {
    strut_buffer_add(text, "; does not pay off in this scene\n");
  } else {
    strut_buffer_add(text, " (floor %s), and is no cheaper; does not pay off in this scene\n",
                     strut_tradeoff_percent_text(f->floor_spread.worst, c));
  }
}

void strut_tradeoff_add_advice(strut_buffer *text, const strut_tradeoff *r) {
  if (r->accuracy > 0)
    advise_accuracy(text, r);
  else
    advise_levels(text, r);
  if (r->variant_count > 1)
    strut_buffer_add(text, "\nConverged variants of the model, relative to the unchanged one\n");
  for (size_t i = 1; i < r->variant_count; i++) advise_model(text, r, (int)i);
}

/* ---- the table ---- */

static void add_head(strut_buffer *table, const strut_tradeoff *r) {
  char a[3 * STRUT_TRADEOFF_TEXT];
  strut_buffer_add(table, "%s%serror against cost of the %s", r->name, *r->name ? ": " : "",
                   strut_tradeoff_measure_text(r->measure));
  if (r->periods > 0)
    strut_buffer_add(table, " in %.6g periods", r->periods);
  else
    strut_buffer_add(table, " in %s", strut_quantity_of(r->duration, 4, "s").text);
  if (r->point_count > 1) strut_buffer_add(table, ", %zu operating points", r->point_count);
  strut_buffer_add(table, "\ncost 1: %s: %.0f force evaluations%s%s\n",
                   strut_tradeoff_base_text(r, a), r->base_evaluations,
                   r->point_count > 1 ? " at the first point" : "", r->base < 0 ? ", not run" : "");
  if (r->measure == STRUT_TRADEOFF_VELOCITY)
    strut_buffer_add(table, "errors relative to the velocity, or to %s if larger\n",
                     strut_quantity_of(r->scale, 3, "m/s").text);
  if (r->measure == STRUT_TRADEOFF_POSITION)
    strut_buffer_add(table, "errors relative to the size of the structure\n");
}

static void add_variant(strut_buffer *table, const strut_tradeoff *r, int variant) {
  const strut_model_variant *f = &r->variants[variant];
  char a[STRUT_TRADEOFF_TEXT];
  if (!f->run) return;
  strut_buffer_add(table, "\n%s%s\n", f->name, variant ? ", Pareto-optimal settings only" : "");
  if (f->remark[0]) strut_buffer_add(table, "  %s\n", f->remark);
  strut_buffer_add(table, "  reference: %s", f->reference[0]);
  if (f->reference[1][0])
    strut_buffer_add(table, " and %s, which differ by %s", f->reference[1],
                     strut_tradeoff_percent_text(f->floor_spread.worst, a));
  if (r->point_count > 1) strut_buffer_add(table, " at worst; settings of the first point");
  strut_buffer_add(table, "\n  %-26s %9s %9s %8s %9s", "method", "step", "cost", "CPU",
                   r->point_count > 1 ? "median" : "error");
  if (r->point_count > 1) strut_buffer_add(table, " %9s %9s", "90 %", "worst");
  strut_buffer_add(table, "\n");
}

static void add_row(strut_buffer *table, const strut_tradeoff *r, const strut_tradeoff_row *row) {
  char a[STRUT_TRADEOFF_TEXT], b[STRUT_TRADEOFF_TEXT], cpu[STRUT_TRADEOFF_TEXT] = "-";
  char worst[STRUT_TRADEOFF_TEXT];
  if (isfinite(row->cpu)) snprintf(cpu, sizeof cpu, "%.3g", row->cpu);
  strut_buffer_add(table, "%c%c %-25s %9s %9.3g %8s", row->front ? '*' : ' ', row->base ? '=' : ' ',
                   strut_tradeoff_group_text(row, a), strut_tradeoff_step_text(row, b),
                   row->evaluations, cpu);
  strut_buffer_add(table, " %9s", strut_tradeoff_percent_text(row->error_spread.median, a));
  if (r->point_count > 1) {
    strut_buffer_add(table, " %9s %9s", strut_tradeoff_percent_text(row->error_spread.ninety, a),
                     strut_tradeoff_percent_text(row->error_spread.worst, worst));
    if (row->diverged) strut_buffer_add(table, "  (%zu diverged)", row->diverged);
  }
  strut_buffer_add(table, "\n");
}

char *strut_tradeoff_table(const strut_tradeoff *r) {
  strut_buffer table = {0};
  strut_c_locale locale = strut_c_locale_enter();
  add_head(&table, r);
  for (size_t f = 0; f < r->variant_count; f++) {
    add_variant(&table, r, (int)f);
    for (size_t i = 0; i < r->row_count; i++) {
      const strut_tradeoff_row *row = &r->rows[i];
      bool shown = row->variant == (int)f && r->variants[f].run && (f == 0 || row->front);
      if (shown) add_row(&table, r, row);
    }
  }
  strut_buffer_add(&table, "  (* Pareto-optimal, = the reference of costs; CPU: measured here)\n");
  if (r->left_out)
    strut_buffer_add(&table, "  %zu %s not refined further: the work is bounded\n", r->left_out,
                     r->left_out == 1 ? "series of steps was" : "series of steps were");
  if (r->cut) strut_buffer_add(&table, "  cut by --cpu-time: another machine may measure more\n");
  strut_buffer_add(&table, "  work: %.3g force evaluations, %.2g times %s (at most %d)\n\n",
                   r->work, r->work / r->work_unit,
                   r->accuracy > 0 && r->measure != STRUT_TRADEOFF_ENERGY
                       ? "a reference run"
                       : "the longer of a reference run and cost 1",
                   STRUT_TRADEOFF_MOST_WORK);
  strut_tradeoff_add_advice(&table, r);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}

/* ---- values ---- */

#define SPREAD(X)                                                                                  \
  X("median", "1", NUMBER(spread->median), "of the points", .column = {"median"})                  \
  X("percentile_90", "1", NUMBER(spread->ninety), "of the points", .column = {"90 %"})             \
  X("worst", "1", NUMBER(spread->worst), "of the points", .column = {"worst"})                     \
  X("points", "1", NUMBERS(spread->values, spread->count), "at each of them")
STRUT_VALUES_HERE(spread_values, SPREAD, const strut_spread *spread = of->at)

static strut_value reference_name(const strut_result_object *of, size_t i) {
  const strut_model_variant *f = of->at;
  return STRUT_VALUE_AS_IF(f->reference[i][0], TEXT(f->reference[i]));
}

#define VARIANT(X)                                                                                 \
  X("name", "", TEXT(f->name), "of the variant; the first is the unchanged model")                 \
  X("remark", "", TEXT(f->remark[0] ? f->remark : NULL), "why it was not run, or an assumption")   \
  X("run", "", FLAG(f->run), "whether it was")                                                     \
  X("reference", "", IF(f->run, ARRAY(2, reference_name)), "settings that agree on it")            \
  X("values", "", IF(f->run, NUMBERS(f->value, r->point_count * r->value_count)),                  \
    "point by point")                                                                              \
  X("floor", "1", IF(f->run, PART(&f->floor_spread)), "how far they differ",                       \
    .rows = &spread_values)                                                                        \
  X("model_error", "1", IF(f->run, PART(&f->model_spread)), "its change of the answer",            \
    .rows = &spread_values)
STRUT_VALUES_HERE(variant_values, VARIANT, const strut_model_variant *f = of->at;
                  const strut_tradeoff *r = of->outer->at)

static void write_group(const strut_result_object *of, char text[STRUT_VALUE_ROOM]) {
  strut_tradeoff_group_text(of->at, text);
}

#define SETTING(X)                                                                                 \
  X("model", "", TEXT(r->variants[row->variant].name), "its variant", .column = {"model"})         \
  X("group", "", WORDS(write_group), "settings that differ by their step alone",                   \
    .column = {"group"})                                                                           \
  X("method", "", TEXT(row->method->name), "of integration", .column = {"method"})                 \
  X("refine", "1", NUMBER(row->refine), "of steps with events", .column = {"refine"})              \
  X("step", "s", NUMBER(row->step), "the largest, where it adapts", .column = {"step [s]"})        \
  X("tolerance", "1", NUMBER(row->tolerance), "of an adaptive method", .column = {"tolerance"})    \
  X("evaluations", "1", NUMBER(row->evaluations), "of forces, over those of the base",             \
    .column = {"evaluations"})                                                                     \
  X("rate", "1/s", NUMBER(row->rate), "evaluations for a simulated second")                        \
  X("cpu", "1", NUMBER(row->cpu), "CPU time over that of the base", .column = {"cpu"})             \
  X("seconds", "s", NUMBER(row->seconds), "CPU time of a run", .column = {"seconds [s]"})          \
  X("step_error", "1", PART(&row->error_spread), "from its model's answer", .column = {"error "},  \
    .rows = &spread_values)                                                                        \
  X("total_error", "1", PART(&row->total_spread), "from the unchanged model's",                    \
    .column = {"total "}, .rows = &spread_values)                                                  \
  X("values", "", NUMBERS(row->value, r->point_count * r->value_count), "point by point")          \
  X("diverged", "", COUNT(row->diverged), "points", .column = {"diverged"})                        \
  X(NULL, "", COUNT(r->point_count), "", .column = {"points"})                                     \
  X("above_limit", "", FLAG(row->above), "of stability: runs refuse the step")                     \
  X("front", "", FLAG(row->front), "Pareto-optimal in its variant", .column = {"front"})           \
  X("base", "", FLAG(row->base), "costs are relative to it", .column = {"base"})
STRUT_VALUES_HERE(setting_values, SETTING, const strut_tradeoff_row *row = of->at;
                  const strut_tradeoff *r = of->outer->at)

#define ADVICE(X)                                                                                  \
  X("error", "1", NUMBER(a.error), "to be kept")                                                   \
  X("known", "", FLAG(a.known), "whether the references agree well enough")                        \
  X("setting", "", INDEX(a.row), "the cheapest, from 0")                                           \
  X("half_setting", "", INDEX(a.half), "likewise, for half the error")                             \
  X("half_cost", "1", NUMBER(a.cost), "of it, over that of `setting`")                             \
  X("next_method", "", INDEX(a.other), "the cheapest of another method")
STRUT_VALUES_HERE(
    advice_values, ADVICE, const strut_tradeoff *r = of->at;
    const strut_tradeoff_advice a = strut_tradeoff_advise(r, strut_tradeoff_level(r, of->index)))

#define WORK(X)                                                                                    \
  X("evaluations", "", NUMBER(r->work), "of forces, of all runs")                                  \
  X("unit", "", NUMBER(r->work_unit), "those of a reference run")                                  \
  X("limit", "1", COUNT(STRUT_TRADEOFF_MOST_WORK), "of their ratio")                               \
  X("unrefined_series", "", COUNT(r->left_out), "that the limit kept from finer steps")            \
  X("cut_by_time", "", FLAG(r->cut), "another machine may measure more")
STRUT_VALUES_HERE(work_values, WORK, const strut_tradeoff *r = of->at)

#define POINT(X) X(NULL, "", PARAMETERS, "")
STRUT_VALUES_HERE(point_values, POINT, )

static const strut_scene *scene_of(const strut_result_object *of, size_t i) {
  return &((const strut_tradeoff *)of->at)->setups[i]->scene;
}

static strut_value points_of(const strut_tradeoff *r) {
  strut_value points = STRUT_VALUE_AS_LIST(r->setups, r->point_count);
  points.scene = scene_of;
  return points;
}

#define TRADEOFF(X)                                                                                \
  X("measure", "", TEXT(strut_tradeoff_measure_text(r->measure)), "what errors are of")            \
  X("periods", "1", IF(r->periods > 0, NUMBER(r->periods)), "of a run")                            \
  X("duration", "s", NUMBER(r->duration), "of a run at the first point")                           \
  X("scale", "m/s", IF(r->measure == STRUT_TRADEOFF_VELOCITY, NUMBER(r->scale)),                   \
    "velocities below it have errors relative to it")                                              \
  X("base_setting", "", INDEX(r->base), "that costs are relative to; null: not run")               \
  X("base_evaluations", "", NUMBER(r->base_evaluations), "of forces")                              \
  X("base_seconds", "s", NUMBER(r->base_seconds), "CPU time")                                      \
  X("spent_seconds", "s", NUMBER(r->spent), "CPU time of the study")                               \
  X("work", "", PART(r), "its bound", .rows = &work_values)                                        \
  X("points", "", BY(points_of(r)), "parameters of each operating point", .rows = &point_values)   \
  X("models", "", LIST(r->variants, r->variant_count), "variants", .rows = &variant_values)        \
  X("settings", "", LIST(r->rows, r->row_count), "that were run", .rows = &setting_values)         \
  X("advice", "", TIMES(strut_tradeoff_level_count(r)), "for each error", .rows = &advice_values)
STRUT_VALUES(strut_tradeoff_values, TRADEOFF, const strut_tradeoff *r = of->at)

char *strut_tradeoff_csv(const strut_tradeoff *r) {
  return strut_values_csv(&strut_tradeoff_values, "settings", NULL, r, NULL);
}

char *strut_tradeoff_json(const strut_tradeoff *r) {
  return strut_values_json(&strut_tradeoff_values, r, &r->setups[0]->scene);
}
