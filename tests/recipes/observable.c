/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The observable that docs/dev/recipes.md adds, by a row and a function: a channel with a column in its file, and as
 * the library lists channels, a measured quantity, a sensor, and a column that a study keeps.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/model/model.h"
#include "engine/output/record_files.h"
#include "engine/run/simulate.h"
#include "parser/language/read/read_scene.h"
#include "parser/language/study/read_study.h"
#include "parser/language/write/write_scene.h"

int test_an_observable(void);

/* After 1 s of fall from rest, with 3 m/s along x. */
static const char SCENE[] =
    "strut: 1\nname: fall\ngravity: [0, -4]\nparameters: {along: 3 m/s}\n"
    "nodes: {bob: {position: [0, 0], mass: 1}}\n"
    "sensors: {fast: {of: bob.speed}}\n"
    "initial: {velocity: [along, 0]}\nsolver: {step: 1 ms}\n"
    "run:\n  duration: 1\n  measure:\n    quantities:\n"
    "      end: {of: bob.speed, take: final}\n"
    "      seen: {of: fast, take: final}\n"
    "output: {channels: [speed]}\n";
static const char STUDY[] =
    "strut: 1\nstudy: kept\nmodel: fall.yaml\naxes: [{along: [3 m/s, 6 m/s]}]\nkeep: [bob.speed]\n";

static int failures;

static void expect(bool good, const char *what, double value) {
  if (!good) printf("recipe of an observable: %s (%.17g)\n", what, value);
  failures += !good;
}

static void write_file(const char *path, const char *text) {
  FILE *file = fopen(path, "w");
  if (file) fputs(text, file), fclose(file);
}

/* Value of a quantity at the end of a run, whose rows a sink may take. */
static double measure(strut_setup *setup, strut_sink *sink, const char *name) {
  strut_model *model = NULL;
  strut_summary summary = {0};
  strut_error error = {0};
  strut_run_options options = {.sinks = &sink, .sink_count = sink ? 1 : 0};
  double value = (double)NAN;
  bool good = !strut_model_compile(&setup->scene, &model, &error) &&
              !strut_simulate(model, &setup->experiment, &options, &summary, &error);
  if (!good) printf("%s\n", error.message);
  for (size_t i = 0; good && i < summary.measured_count; i++)
    if (strcmp(summary.measured[i].name, name) == 0) value = summary.measured[i].value;
  if (good) strut_summary_free(&summary);
  strut_model_free(model);
  return value;
}

static void test_a_scene(void) {
  strut_setup setup, again;
  strut_diagnostics diagnostics = {0};
  char line[200] = "", last[200] = "";
  strut_status status = strut_setup_read(&setup, "fall.yaml", SCENE, strlen(SCENE), NULL, 0,
                                         STRUT_FOR_RUN, &diagnostics);
  if (diagnostics.count) printf("%s\n", diagnostics.items[0].message);
  expect(!status, "its scene is refused", 0);
  if (status) return;
  strut_sink *sink = strut_csv_create(".");
  double end = measure(&setup, sink, "end"), seen = measure(&setup, NULL, "seen");
  strut_csv_free(sink);
  expect(fabs(end - 5.0) < 1e-9, "it is not measured", end);
  expect(seen == end, "it is not sensed", seen);
  FILE *file = fopen("nodes.csv", "r");
  expect(file && fgets(line, sizeof line, file) && !strcmp(line, "time [s],bob.speed [m/s]\n"),
         "it has no column", 0);
  while (file && fgets(line, sizeof line, file)) memcpy(last, line, sizeof last);
  double time = 0, recorded = 0;
  expect(sscanf(last, "%lf,%lf", &time, &recorded) == 2 && fabs(recorded - 5.0) < 1e-9,
         "it is not recorded", recorded);
  if (file) fclose(file);
  char *written = strut_setup_write(&setup);
  bool back = written && !strut_setup_read(&again, "fall.yaml", written, strlen(written), NULL, 0,
                                           STRUT_FOR_RUN, &diagnostics);
  expect(back && again.experiment.channels == setup.experiment.channels &&
             again.scene.sensors[0].of->column.kind == STRUT_COLUMN_NODE_SPEED,
         "it is lost when the scene is written", 0);
  if (back) strut_setup_free(&again);
  strut_release(written);
  strut_setup_free(&setup);
  strut_diagnostics_free(&diagnostics);
}

static void test_a_study(void) {
  strut_study_file file = {0};
  strut_setup setup;
  strut_error error = {0};
  const strut_study_value values[] = {{.number = 6.0}};
  write_file("fall.yaml", SCENE);
  write_file("kept.yaml", STUDY);
  strut_status status = strut_study_open("kept.yaml", NULL, 0, &file, &error);
  if (status) printf("%s %s\n", error.message, strut_study_messages(&file, 5));
  expect(!status && file.study.quantity_count == 1, "a study does not keep it", 0);
  if (status) return;
  status = strut_study_setup(&file, values, &setup, &error);
  double kept = status ? (double)NAN : measure(&setup, NULL, file.study.quantities[0]);
  expect(fabs(kept - hypot(6.0, 4.0)) < 1e-9, "a study keeps another value", kept);
  if (!status) strut_setup_free(&setup);
  strut_study_close(&file);
}

int test_an_observable(void) {
  const strut_channel_row *row = strut_channel_named("speed");
  expect(row && row->owner == STRUT_OWNER_NODE && !strcmp(row->unit, "m/s"),
         "no channel is listed for the library", 0);
  test_a_scene();
  test_a_study();
  return failures;
}
