/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/number_text.h"
#include "engine/output/buffer.h"
#include "engine/output/json_value.h"
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

/* ---- CSV ---- */

static void add_number(strut_buffer *csv, double value) {
  char text[STRUT_NUMBER_TEXT];
  strut_buffer_add(csv, ",");
  if (isinf(value)) strut_buffer_add(csv, "inf");
  if (!isfinite(value)) return;
  strut_number_text(value, text);
  strut_buffer_add(csv, "%s", text);
}

static void add_spread(strut_buffer *csv, const strut_spread *spread) {
  add_number(csv, spread->median);
  add_number(csv, spread->ninety);
  add_number(csv, spread->worst);
}

char *strut_tradeoff_csv(const strut_tradeoff *r) {
  strut_buffer csv = {0};
  char a[STRUT_TRADEOFF_TEXT];
  strut_buffer_add(&csv,
                   "model,group,method,refine,step [s],tolerance,evaluations,cpu,seconds [s],"
                   "error median,error 90 %%,error worst,total median,total 90 %%,"
                   "total worst,diverged,points,front,base\n");
  for (size_t i = 0; i < r->row_count; i++) {
    const strut_tradeoff_row *row = &r->rows[i];
    strut_buffer_add(&csv, "\"%s\",\"%s\",%s", r->variants[row->variant].name,
                     strut_tradeoff_group_text(row, a), row->method->name);
    add_number(&csv, row->refine);
    add_number(&csv, row->step);
    add_number(&csv, row->tolerance);
    add_number(&csv, row->evaluations);
    add_number(&csv, row->cpu);
    add_number(&csv, row->seconds);
    add_spread(&csv, &row->error_spread);
    add_spread(&csv, &row->total_spread);
    strut_buffer_add(&csv, ",%zu,%zu,%d,%d\n", row->diverged, r->point_count, row->front,
                     row->base);
  }
  return strut_buffer_take(&csv);
}

/* ---- JSON ---- */

static void put_spread(strut_json *json, struct cJSON *to, const char *key,
                       const strut_spread *spread, const double *values, size_t count) {
  struct cJSON *object = strut_json_object(json, to, key);
  strut_json_number(json, object, "median", spread->median);
  strut_json_number(json, object, "percentile_90", spread->ninety);
  strut_json_number(json, object, "worst", spread->worst);
  strut_json_numbers(json, object, "points", values, count);
}

static void put_variants(strut_json *json, const strut_tradeoff *r) {
  struct cJSON *list = strut_json_array(json, json->root, "models");
  for (size_t i = 0; i < r->variant_count; i++) {
    const strut_model_variant *f = &r->variants[i];
    struct cJSON *object = strut_json_object(json, list, NULL);
    strut_json_text(json, object, "name", f->name);
    strut_json_text(json, object, "remark", f->remark[0] ? f->remark : NULL);
    strut_json_bool(json, object, "run", f->run);
    if (!f->run) continue;
    struct cJSON *methods = strut_json_array(json, object, "reference");
    for (int k = 0; k < 2; k++)
      if (f->reference[k][0]) strut_json_text(json, methods, NULL, f->reference[k]);
    strut_json_numbers(json, object, "values", f->value, r->point_count * r->value_count);
    put_spread(json, object, "floor", &f->floor_spread, f->floor, r->point_count);
    put_spread(json, object, "model_error", &f->model_spread, f->model_error, r->point_count);
  }
}

static void put_rows(strut_json *json, const strut_tradeoff *r) {
  struct cJSON *list = strut_json_array(json, json->root, "settings");
  char a[STRUT_TRADEOFF_TEXT];
  for (size_t i = 0; i < r->row_count; i++) {
    const strut_tradeoff_row *row = &r->rows[i];
    struct cJSON *object = strut_json_object(json, list, NULL);
    strut_json_text(json, object, "model", r->variants[row->variant].name);
    strut_json_text(json, object, "group", strut_tradeoff_group_text(row, a));
    strut_json_text(json, object, "method", row->method->name);
    strut_json_number(json, object, "step", row->step);
    strut_json_number(json, object, "tolerance", row->tolerance);
    strut_json_number(json, object, "refine", row->refine);
    strut_json_number(json, object, "evaluations", row->evaluations);
    strut_json_number(json, object, "rate", row->rate);
    strut_json_number(json, object, "cpu", row->cpu);
    strut_json_number(json, object, "seconds", row->seconds);
    put_spread(json, object, "step_error", &row->error_spread, row->error, r->point_count);
    put_spread(json, object, "total_error", &row->total_spread, row->total, r->point_count);
    strut_json_numbers(json, object, "values", row->value, r->point_count * r->value_count);
    strut_json_integer(json, object, "diverged", (int64_t)row->diverged);
    strut_json_bool(json, object, "above_limit", row->above);
    strut_json_bool(json, object, "front", row->front);
    strut_json_bool(json, object, "base", row->base);
  }
}

static void put_points(strut_json *json, const strut_setup *const *setups, size_t count) {
  struct cJSON *list = strut_json_array(json, json->root, "points");
  for (size_t p = 0; p < count; p++) {
    struct cJSON *object = strut_json_object(json, list, NULL);
    for (size_t i = 0; i < setups[p]->scene.parameter_count; i++) {
      const strut_parameter *parameter = &setups[p]->scene.parameters[i];
      if (isnan(parameter->value))
        strut_json_text(json, object, parameter->name, parameter->text);
      else
        strut_json_number(json, object, parameter->name, parameter->value);
    }
  }
}

/* An index of `settings`, or null. */
static void put_setting(strut_json *json, struct cJSON *object, const char *key, int row) {
  if (row < 0)
    strut_json_text(json, object, key, NULL);
  else
    strut_json_integer(json, object, key, row);
}

static void put_advice(strut_json *json, const strut_tradeoff *r) {
  struct cJSON *list = strut_json_array(json, json->root, "advice");
  for (size_t i = 0; i < strut_tradeoff_level_count(r); i++) {
    const strut_tradeoff_advice a = strut_tradeoff_advise(r, strut_tradeoff_level(r, i));
    struct cJSON *object = strut_json_object(json, list, NULL);
    strut_json_number(json, object, "error", a.error);
    strut_json_bool(json, object, "known", a.known);
    put_setting(json, object, "setting", a.row);
    put_setting(json, object, "half_setting", a.half);
    strut_json_number(json, object, "half_cost", a.cost);
    put_setting(json, object, "next_method", a.other);
  }
}

static void put_work(strut_json *json, const strut_tradeoff *r) {
  struct cJSON *object = strut_json_object(json, json->root, "work");
  strut_json_number(json, object, "evaluations", r->work);
  strut_json_number(json, object, "unit", r->work_unit);
  strut_json_integer(json, object, "limit", STRUT_TRADEOFF_MOST_WORK);
  strut_json_integer(json, object, "unrefined_series", (int64_t)r->left_out);
  strut_json_bool(json, object, "cut_by_time", r->cut);
}

char *strut_tradeoff_json(const strut_tradeoff *r, const strut_setup *const *setups) {
  strut_json json = strut_json_begin();
  strut_json_text(&json, json.root, "name", r->name);
  strut_json_text(&json, json.root, "strut_version", STRUT_VERSION);
  strut_json_text(&json, json.root, "measure", strut_tradeoff_measure_text(r->measure));
  if (r->periods > 0) strut_json_number(&json, json.root, "periods", r->periods);
  strut_json_number(&json, json.root, "duration", r->duration);
  if (r->measure == STRUT_TRADEOFF_VELOCITY) strut_json_number(&json, json.root, "scale", r->scale);
  put_setting(&json, json.root, "base_setting", r->base);
  strut_json_number(&json, json.root, "base_evaluations", r->base_evaluations);
  strut_json_number(&json, json.root, "base_seconds", r->base_seconds);
  strut_json_number(&json, json.root, "spent_seconds", r->spent);
  put_work(&json, r);
  put_points(&json, setups, r->point_count);
  put_variants(&json, r);
  put_rows(&json, r);
  put_advice(&json, r);
  return strut_json_end(&json);
}
