/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A program of somebody else's: reads a scene, runs it, prints the summary; with DRAW, which needs one
   library more, draws where it ended; with SWEEP, for which there is another, runs it at three points.
   See install_test.sh. */
#include <strut.h>

static const char scene_text[] =
    "strut: 1\n"
    "nodes: {wall: {position: [0, 0], fixed: both}, bob: {position: [1.1, 0], mass: 1}}\n"
    "members: {spring: {kind: spring, nodes: [wall, bob], stiffness: 10, rest_length: 1}}\n"
    "solver: {step: 1 ms}\n"
    "run: {duration: 0.1 s}\n";

#ifdef DRAW
static strut_status draw(const strut_model *model, strut_error *error) {
  strut_figure figure = {.title = "shape"};
  strut_add_shape(&figure, strut_add_panel(&figure), model, model->start)->names = true;
  return strut_figure_draw(&(strut_plot){.path = "shape.svg", .width = 200}, &figure, error);
}
#endif

#ifdef SWEEP
/* The points of study.yaml, into points.slots and table.csv. */
static strut_status sweep(strut_error *error) {
  strut_study_file file = {0};
  strut_sweep_plan plan = {0};
  strut_slots *slots = NULL;
  strut_sweep_state state;
  const strut_sweep_options options = {.threads = 2, .directory = "."};
  strut_status status = strut_study_open("study.yaml", NULL, 0, &file, error);
  const strut_sweep_scenes scenes = {strut_study_setup, strut_setup_write, &file};
  if (status == STRUT_OK) status = strut_sweep_plan_make(&file.study, &scenes, &plan, error);
  const strut_slots_description rows = {.version = "mine",
                                        .name = "mine",
                                        .points = plan.points,
                                        .count = plan.points,
                                        .columns = plan.columns,
                                        .column_count = plan.column_count};
  if (status == STRUT_OK) status = strut_slots_open("points.slots", &rows, &slots, error);
  if (status == STRUT_OK) status = strut_sweep_run(&plan, slots, &options, &state, error);
  const strut_slot_rows all = {.sources = &slots, .count = 1};
  if (status == STRUT_OK) status = strut_study_table_write(".", "table.csv", &all, NULL, error);
  strut_slots_close(slots);
  strut_sweep_plan_free(&plan);
  strut_study_close(&file);
  return status;
}
#endif

int main(void) {
  strut_setup setup = {0};
  strut_model *model = NULL;
  strut_summary summary = {0};
  strut_diagnostics diagnostics = {0};
  strut_error error = {0};
  strut_sink *sinks[] = {strut_csv_create("."), strut_hdf5_create(".", scene_text, &error)};
  const strut_run_options options = {.sinks = sinks, .sink_count = 2};

  strut_status status = strut_setup_read(&setup, "scene", scene_text, sizeof scene_text - 1, NULL,
                                         0, STRUT_FOR_RUN, &diagnostics);
  if (status == STRUT_OK) status = strut_model_compile(&setup.scene, &model, &error);
  if (status == STRUT_OK)
    status = strut_simulate(model, &setup.experiment, &options, &summary, &error);
#ifdef DRAW
  if (status == STRUT_OK) status = draw(model, &error);
#endif
#ifdef SWEEP
  if (status == STRUT_OK) status = sweep(&error);
#endif
  if (status == STRUT_OK) {
    char *text = strut_summary_json(&summary, &setup.scene, false);
    puts(text ? text : "no memory");
    strut_release(text);
  } else {
    printf("%s: %s\n", strut_status_text(status), error.message);
  }
  strut_csv_free(sinks[0]);
  strut_hdf5_free(sinks[1]);
  strut_summary_free(&summary);
  strut_model_free(model);
  strut_setup_free(&setup);
  strut_diagnostics_free(&diagnostics);
  return status == STRUT_OK ? 0 : 1;
}
