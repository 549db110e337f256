/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/commands.h"

#include <stdio.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "engine/output/record_files.h"
#include "engine/output/results.h"
#include "engine/output/run_report.h"
#include "engine/run/accuracy/accuracy.h"
#include "engine/run/simulate.h"
#include "parser/language/write/write_scene.h"
#include "parser/program/command/run_settings.h"
#include "parser/program/command/varied_scenes.h"
#include "parser/program/open_model.h"
#include "parser/program/progress.h"
#include "parser/program/run_pictures.h"
#include "parser/program/streams.h"

static const strut_option options[] = {
    STRUT_SET_OPTION,
    STRUT_OUTPUT_OPTION("DIR", "write summary, scene and trajectories into DIR"),
    {STRUT_FILLS(json), "json", NULL, "print the summary as one JSON object"},
    STRUT_FORCE_OPTION,
    {.table = strut_experiment_options},
    STRUT_THREADS_OPTION,
    {.table = strut_plot_options},
    {.table = strut_run_figure_options},
    {.table = strut_film_options},
    {.name = NULL},
};

/* The files of -o DIR. All zero without it. */
typedef struct run_files {
  strut_results results;
  char *scene_text; /* the effective scene */
  strut_sink *csv, *hdf5;
  strut_sink *sinks[3]; /* these two, and that of the pictures */
  size_t sink_count;
} run_files;

static strut_status begin_results(const strut_arguments *arguments, const strut_setup *setup,
                                  run_files *keep, strut_error *error) {
  if (!arguments->output) return STRUT_OK;
  strut_status status = strut_results_begin(&keep->results, arguments->output, error);
  if (status != STRUT_OK) return status;
  status = strut_data_copy(setup->scene.tables, setup->scene.table_count, arguments->output, error);
  if (status != STRUT_OK) return status;
  keep->scene_text = strut_setup_write(setup);
  if (keep->scene_text) {
    keep->csv = keep->sinks[keep->sink_count++] = strut_csv_create(keep->results.stage);
    keep->hdf5 = keep->sinks[keep->sink_count++] =
        strut_hdf5_create(keep->results.stage, keep->scene_text);
  }
  if (keep->csv && keep->hdf5) return STRUT_OK;
  return strut_no_memory(error, "");
}

/* Adds the summary and the scene, and makes all files appear. */
static strut_status complete_results(run_files *keep, const strut_summary *summary,
                                     const strut_scene *scene, strut_error *error) {
  if (!keep->results.stage) return STRUT_OK;
  const char *stage = keep->results.stage;
  strut_status status = strut_file_write_block(stage, "summary.json",
                                               strut_summary_json(summary, scene, false), error);
  if (status == STRUT_OK) {
    status = strut_file_write_text(stage, "scene.yaml", keep->scene_text, error);
  }
  return status == STRUT_OK ? strut_results_commit(&keep->results, error) : status;
}

static void free_results(run_files *keep) {
  strut_csv_free(keep->csv);
  strut_hdf5_free(keep->hdf5);
  strut_release(keep->scene_text);
  strut_results_abandon(&keep->results); /* nothing where they are complete */
}

static strut_status simulate(const strut_model *model, const strut_setup *setup,
                             const strut_arguments *arguments, run_files *keep,
                             strut_run_pictures *pictures, strut_summary *summary,
                             strut_error *error) {
  const strut_flag *interrupt = strut_interrupt_watch(); /* before there are files */
  strut_status status = begin_results(arguments, setup, keep, error);
  if (status != STRUT_OK) return status;
  strut_sink *pictures_sink = strut_run_pictures_sink(pictures, model->scene, &status);
  if (status != STRUT_OK) return strut_fail(error, status, "out of memory");
  if (pictures_sink) keep->sinks[keep->sink_count++] = pictures_sink;
  strut_progress progress = strut_progress_begin(arguments->quiet);
  progress.span = strut_experiment_span(&setup->experiment, model->scene).duration;
  const strut_run_options run = {
      .force = arguments->force,
      .interrupt = interrupt,
      .progress = progress.wanted ? strut_progress_show : NULL,
      .phase = progress.wanted ? strut_progress_phase : NULL,
      .progress_context = &progress,
      .sinks = keep->sinks,
      .sink_count = keep->sink_count,
  };
  status = strut_simulate_as_asked(model, &setup->experiment, &run, summary, error);
  strut_progress_end(&progress);
  return status;
}

static strut_status print_summary(const strut_arguments *arguments, const strut_summary *summary,
                                  const strut_scene *scene) {
  if (arguments->quiet && !arguments->json) return STRUT_OK;
  return strut_print_block(arguments->json ? strut_summary_json(summary, scene, true)
                                           : strut_summary_table(summary, scene));
}

/* Warnings about a result that exists but may not be what was meant. */
static void print_warnings(const strut_summary *summary) {
  for (size_t i = 0; i < summary->warning_count; i++)
    fprintf(stderr, "strut: warning: %s\n", summary->warnings[i].text);
}

static strut_status run_model(const strut_arguments *arguments, const strut_setup *setup,
                              const strut_model *model, strut_varied_scenes *scenes,
                              strut_run_pictures *pictures) {
  run_files keep = {.scene_text = NULL};
  strut_summary summary = {0};
  strut_error error = {0}, late = {0};
  strut_status status = simulate(model, setup, arguments, &keep, pictures, &summary, &error);
  if (status == STRUT_OK)
    status = strut_varied_scenes_derive(arguments, scenes, setup, strut_interrupt_watch(), &summary,
                                        &error);
  if (status != STRUT_OK) strut_print_error(&error);
  if (strut_run_has_results(status)) {
    print_warnings(&summary);
    strut_status written = complete_results(&keep, &summary, model->scene, &late);
    if (written == STRUT_OK) written = strut_run_pictures_draw(pictures, model, &summary, &late);
    if (written != STRUT_OK) strut_print_error(&late);
    /* The failure of the run is reported, not the missing figure. */
    if (written == STRUT_USAGE && status != STRUT_OK) written = status;
    if (written != STRUT_OK) status = written;
    strut_status printed = print_summary(arguments, &summary, model->scene);
    if (status == STRUT_OK) status = printed;
    if (written == STRUT_OK) written = strut_run_pictures_film(pictures, model);
    if (written != STRUT_OK) status = written;
    if (status == STRUT_OK && strut_summary_is_inaccurate(&summary)) status = STRUT_INACCURATE;
  }
  strut_summary_free(&summary);
  free_results(&keep);
  return status;
}

static strut_status run_run(const strut_arguments *arguments) {
  strut_setup setup;
  strut_model *model = NULL;
  strut_error error = {0};
  strut_run_pictures pictures = {0};
  char *text = NULL;
  strut_varied_scenes scenes = {.file = strut_model_name(arguments),
                                .purpose = strut_run_options_purpose(arguments)};
  strut_status status = strut_run_pictures_read(arguments, &pictures);
  if (status == STRUT_OK)
    status = strut_open_model_kept(arguments, STRUT_OPEN_FOR_RUN, &text, &scenes.length, &setup);
  scenes.text = text;
  if (status != STRUT_OK) {
    strut_release(text);
    return status;
  }
  status = strut_run_options_apply(arguments, &setup);
  if (status != STRUT_OK) {
    strut_release(text);
    strut_run_pictures_free(&pictures);
    strut_setup_free(&setup);
    return status;
  }
  if (status == STRUT_OK) status = strut_warn_of_scene(&setup);
  if (status != STRUT_OK) error.status = status;
  if (status == STRUT_OK) status = strut_model_compile(&setup.scene, &model, &error);
  if (status == STRUT_OK)
    status = strut_run_pictures_check(&pictures, &setup.experiment, model, &error);
  if (status == STRUT_OK)
    status = run_model(arguments, &setup, model, &scenes, &pictures);
  else
    strut_print_error(&error);
  strut_release(text);
  strut_run_pictures_free(&pictures);
  strut_model_free(model);
  strut_setup_free(&setup);
  return status;
}

static const char run_details[] =
    "\nPrints a short table at the end, or with --json the whole summary. With -o, DIR receives\n"
    "summary.json, scene.yaml (the scene as run: running it gives bit-identical results),\n"
    "trajectory.h5 and, as CSV, nodes, members, contacts and energy, as the scene records them;\n"
    "either all files are written or none.\n"
    "--plot draws the final shape with curves of the last periods (overview), node\n"
    "trajectories over the last period, magnified by --scale (period), shapes at several\n"
    "instants (snapshots), or curves of everything recorded (curves). A run that diverged is\n"
    "drawn up to that point.\n"
    "--animate makes a film of the recorded motion with the program ffmpeg.\n"
    "A result that is less accurate than requested is printed all the same, with a warning and\n"
    "exit code 5.\n"
    "Ctrl-C stops the run and keeps the results so far; a second Ctrl-C kills it.\n";

const strut_command strut_command_run = {
    .name = "run",
    .model = "MODEL",
    .summary = "simulates a model",
    .details = run_details,
    .options = options,
    .run = run_run,
};
