/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

#include "engine/base/c_locale.h"
#include "engine/base/number_text.h"
#include "engine/output/buffer.h"
#include "engine/output/json_value.h"
#include "engine/output/report/reports.h"

enum { MOST_ROWS = 40, DIGITS = 6 };

static const char *hertz(double value, strut_rounded_quantity *text) {
  *text = strut_quantity_of(value, DIGITS, "Hz");
  return text->text;
}

static void add_edge(strut_json *json, struct cJSON *row, const char *key, const char *at,
                     const strut_wave_edge *edge, int32_t steps) {
  strut_json_number(json, row, key, edge->frequency);
  strut_json_numbers(json, row, at, edge->phase, (size_t)steps);
}

static void add_bands(strut_json *json, const strut_waves *w) {
  struct cJSON *bands = strut_json_array(json, json->root, "bands");
  for (int32_t b = 0; b < w->shown; b++) {
    struct cJSON *row = strut_json_object(json, bands, NULL);
    add_edge(json, row, "low", "low_at", &w->band[b].low, w->steps);
    add_edge(json, row, "high", "high_at", &w->band[b].high, w->steps);
  }
  struct cJSON *gaps = strut_json_array(json, json->root, "gaps");
  for (size_t g = 0; g < w->gap_count; g++) {
    struct cJSON *row = strut_json_object(json, gaps, NULL);
    strut_json_integer(json, row, "below", w->gaps[g].below);
    strut_json_number(json, row, "low", w->gaps[g].low);
    strut_json_number(json, row, "high", w->gaps[g].high);
  }
}

static void add_samples(strut_json *json, const strut_waves *w) {
  struct cJSON *corners = strut_json_array(json, json->root, "corners");
  for (int32_t i = 0; i < w->corner_count; i++) {
    struct cJSON *row = strut_json_object(json, corners, NULL);
    strut_json_text(json, row, "name", w->corner[i].name);
    strut_json_number(json, row, "along", w->along[w->corner[i].sample]);
  }
  struct cJSON *samples = strut_json_array(json, json->root, "waves");
  for (size_t i = 0; i < w->count; i++) {
    struct cJSON *row = strut_json_object(json, samples, NULL);
    strut_json_number(json, row, "along", w->along[i]);
    strut_json_numbers(json, row, "phase", w->phase[i], (size_t)w->steps);
    strut_json_numbers(json, row, "frequencies", w->frequency + i * (size_t)w->band_count,
                       (size_t)w->shown);
  }
}

char *strut_waves_json(const strut_model *model, const strut_waves *w) {
  const strut_scene *scene = model->scene;
  strut_json json = strut_json_begin();
  strut_json_text(&json, json.root, "name", scene->name);
  strut_json_text(&json, json.root, "strut_version", STRUT_VERSION);
  strut_json_text(&json, json.root, "at", w->at);
  struct cJSON *lattice = strut_json_array(&json, json.root, "lattice");
  for (int32_t k = 0; k < w->steps; k++)
    strut_json_numbers(&json, lattice, NULL, scene->lattice[k], 2);
  struct cJSON *nodes = strut_json_object(&json, json.root, "nodes");
  for (size_t i = 0; i < scene->node_count; i++)
    strut_json_numbers(&json, nodes, scene->nodes[i].name, w->q + 2 * i, 2);
  strut_json_number(&json, json.root, "moved", w->moved);
  strut_json_number(&json, json.root, "residual", w->residual);
  strut_json_integer(&json, json.root, "coordinates", w->band_count);
  strut_json_integer(&json, json.root, "images", w->images);
  strut_json_integer(&json, json.root, "samples", (int64_t)(w->count + w->inside));
  struct cJSON *speeds = strut_json_array(&json, json.root, "speeds");
  for (int32_t k = 0; k < w->steps; k++)
    strut_json_numbers(&json, speeds, NULL, w->speed[k], (size_t)w->acoustic);
  add_bands(&json, w);
  add_samples(&json, w);
  return strut_json_end(&json);
}

static bool grows(const strut_waves *w) { return w->band[0].low.frequency < 0.0; }

static void add_head(strut_buffer *table, const strut_model *model, const strut_waves *w) {
  const char *name = model->scene->name;
  strut_buffer_add(table, "%s%swaves at %s, over ", name, *name ? ": " : "", w->at);
  for (int32_t k = 0; k < w->steps; k++)
    strut_buffer_add(table, "%s[%g m, %g m]", k ? " and " : "", model->scene->lattice[k][0],
                     model->scene->lattice[k][1]);
  strut_buffer_add(table, "\n  %d coordinates in a cell, %d node%s of the next cells; ",
                   (int)w->band_count, (int)w->images, w->images == 1 ? "" : "s");
  strut_buffer_add(table, "%zu samples of the wave vector\n", w->count + w->inside);
  strut_buffer_add(table, "  equilibrium %s from that shape, residual force %s\n",
                   strut_quantity_of(w->moved, 3, "m").text,
                   strut_quantity_of(w->residual, 2, "N").text);
  if (grows(w))
    strut_buffer_add(table,
                     "  frequencies below zero: the wave grows, the structure is unstable\n");
  for (int32_t k = 0; k < w->steps && w->acoustic; k++) {
    strut_buffer_add(table, "  long waves%s ",
                     w->steps == 1 ? ""
                     : k           ? " across step 1"
                                   : " across step 2");
    for (int32_t b = 0; b < w->acoustic; b++)
      strut_buffer_add(table, "%s%s", b ? " and " : "at ",
                       strut_quantity_of(w->speed[k][b], DIGITS, "m/s").text);
    strut_buffer_add(table, "\n");
  }
}

char *strut_waves_table(const strut_model *model, const strut_waves *w) {
  strut_c_locale locale = strut_c_locale_enter();
  strut_buffer table = {0};
  strut_rounded_quantity low, high, wide;
  add_head(&table, model, w);
  strut_buffer_add(&table, "\n  %4s %14s %14s\n", "band", "lowest", "highest");
  for (int32_t b = 0; b < w->shown && b < MOST_ROWS; b++)
    strut_buffer_add(&table, "  %4d %14s %14s\n", (int)b + 1, hertz(w->band[b].low.frequency, &low),
                     hertz(w->band[b].high.frequency, &high));
  if (w->shown > MOST_ROWS)
    strut_buffer_add(&table, "  ... and %d more; --json lists all\n", (int)w->shown - MOST_ROWS);
  strut_buffer_add(&table, w->gap_count ? "\n" : "\n  no gap: bands meet or overlap\n");
  for (size_t g = 0; g < w->gap_count; g++) {
    const strut_wave_gap *gap = &w->gaps[g];
    strut_buffer_add(&table, "  gap %s band %d: %s to %s, %s wide\n",
                     gap->below ? "above" : "under", gap->below ? (int)gap->below : 1,
                     hertz(gap->low, &low), hertz(gap->high, &high),
                     hertz(gap->high - gap->low, &wide));
  }
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}

char *strut_waves_csv(const strut_waves *w) {
  strut_buffer csv = {0};
  strut_buffer_add(&csv, "along [1]");
  for (int32_t k = 0; k < w->steps; k++) strut_buffer_add(&csv, ",phase %d [1]", (int)k + 1);
  for (int32_t b = 0; b < w->shown; b++) strut_buffer_add(&csv, ",band %d [Hz]", (int)b + 1);
  for (size_t i = 0; i < w->count; i++) {
    strut_buffer_add(&csv, "\n");
    strut_csv_add_number(&csv, w->along[i]);
    for (int32_t k = 0; k < w->steps; k++) {
      strut_buffer_add(&csv, ",");
      strut_csv_add_number(&csv, w->phase[i][k]);
    }
    for (int32_t b = 0; b < w->shown; b++) {
      strut_buffer_add(&csv, ",");
      strut_csv_add_number(&csv, w->frequency[i * (size_t)w->band_count + (size_t)b]);
    }
  }
  strut_buffer_add(&csv, "\n");
  return strut_buffer_take(&csv);
}
