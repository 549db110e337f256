/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/commands.h"

#include <math.h>
#include <stdio.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/output/figures/run_figure.h"
#include "engine/output/file.h"
#include "engine/output/record_files.h"
#include "engine/output/results.h"
#include "engine/output/run_report.h"
#include "engine/run/accuracy/accuracy.h"
#include "engine/run/simulate.h"
#include "parser/language/write/write_scene.h"
#include "parser/program/command/scene_options.h"

/* What is drawn and filmed of a run. Zero-initialise. */
typedef struct run_pictures {
  strut_run_figure figure;
  strut_film film;
  bool quiet, silent; /* no progress bar; no report of the film on stdout */
  double times[STRUT_MOST_TIMES];
  strut_trajectory motion;
  strut_sink *sink; /* fills the motion; NULL if nothing is drawn */
} run_pictures;

static const strut_option film_options[] = {
    {STRUT_FILLS(animate), "animate", "FILE", "make a film: FILE ends with .mp4, .webm or .gif"},
    {STRUT_FILLS(speed), "speed", "SPEED",
     "speed of the film, such as 1/10 or 5 (default 1, real time)", .low = 1e-9, .high = 1e6},
    {STRUT_FILLS(fps), "fps", "NUMBER",
     "frames per second (default " STRUT_TEXT_OF(STRUT_FILM_FPS) "; gif: " STRUT_TEXT_OF(
         STRUT_FILM_GIF_FPS) ")",
     .low = 1, .high = 120},
    {.name = NULL}};

static strut_status read_pictures(const strut_arguments *arguments, run_pictures *pictures) {
  strut_status status = strut_plot_read(arguments, 0, &pictures->figure.plot);
  if (!status) status = strut_run_figure_read(arguments, &pictures->figure, pictures->times);
  pictures->quiet = arguments->quiet;
  pictures->silent = arguments->quiet || arguments->json || arguments->format.index;
  pictures->film = (strut_film){.path = arguments->animate,
                                .speed = arguments->speed.text ? arguments->speed.value : 1,
                                .fps = arguments->fps.value};
  if (!status && !pictures->film.path && (arguments->speed.text || arguments->fps.text))
    return strut_usage_error(arguments, "--speed and --fps need --animate FILE");
  return status;
}

/* Checks before the run that it will record what is to be drawn; STRUT_USAGE if not. */
static strut_status check_pictures(run_pictures *pictures, const strut_experiment *experiment,
                                   const strut_model *model, strut_error *error) {
  pictures->figure.experiment = pictures->film.experiment = experiment;
  strut_span span = strut_experiment_span(experiment, model->scene);
  strut_status status = STRUT_OK;
  if (pictures->film.path)
    status = strut_film_check(&pictures->film, span.duration - span.record_start, error);
  if (status != STRUT_OK || !pictures->figure.plot.path) return status;
  return strut_run_figure_check(&pictures->figure, model->scene, error);
}

/* The sink that collects the motion, or NULL where none is needed or *status is an error. */
static strut_sink *create_pictures_sink(run_pictures *pictures, const strut_scene *scene,
                                        strut_status *status) {
  *status = STRUT_OK;
  if (!pictures->figure.plot.path && !pictures->film.path) return NULL;
  strut_channels channels =
      pictures->figure.plot.path ? strut_run_figure_channels(pictures->figure.view) : 0;
  if (scene->table_count) channels |= pictures->figure.experiment->channels; /* beside data */
  if (pictures->film.path) channels |= strut_run_figure_channels(STRUT_RUN_SNAPSHOTS);
  pictures->sink = strut_trajectory_sink(&pictures->motion, scene, channels, STRUT_TRAJECTORY_ROOM);
  if (!pictures->sink) *status = STRUT_NO_MEMORY;
  return pictures->sink;
}

static strut_status draw_picture(run_pictures *pictures, const strut_model *model,
                                 const strut_summary *summary, strut_error *error) {
  if (!pictures->figure.plot.path) return STRUT_OK;
  return strut_run_figure_draw(&pictures->figure, model, &pictures->motion, summary, error);
}

/* And what would make it better: a speed at which it lasts five seconds, more recorded frames. */
static void print_film(const strut_film *film) {
  enum { SHORT = 2, WATCHED = 5 /* [s] */, DIGITS = 4 };
  double slower = ceil(WATCHED / film->motion), shown = film->speed / film->fps;
  printf("\n  film %s: %d x %d, %zu frames, %s", film->path, film->width, film->height,
         film->frames, strut_quantity_of((double)film->frames / film->fps, DIGITS, "s").text);
  printf(film->speed == 1 ? " at real speed\n" : " at %.4g times real speed\n", film->speed);
  if (film->motion < SHORT * film->speed && film->motion > 0)
    printf("  the recording lasts only %s; --speed 1/%.0f makes a film of %s\n",
           strut_quantity_of(film->motion, DIGITS, "s").text, slower,
           strut_quantity_of(film->motion * slower, 2, "s").text);
  if (film->every > 1.5 * shown)
    printf(
        "  recorded every %s but shown every %s; with a shorter output.every motion is smoother\n",
        strut_quantity_of(film->every, DIGITS, "s").text,
        strut_quantity_of(shown, DIGITS, "s").text);
}

/* Last, as it takes longest: the results are on the screen by then. */
static strut_status make_film(run_pictures *pictures, const strut_model *model) {
  strut_error error = {0};
  if (!pictures->film.path) return STRUT_OK;
  fflush(stdout);
  strut_progress progress = strut_progress_begin(pictures->quiet);
  /* After an interrupted run the film still shows what was recorded. */
  const strut_flag *interrupt = strut_interrupt_watch();
  pictures->film.interrupt = *interrupt ? NULL : interrupt;
  pictures->film.progress = progress.wanted ? strut_progress_show : NULL;
  pictures->film.progress_context = &progress;
  strut_status status = strut_film_make(&pictures->film, model, &pictures->motion, &error);
  strut_progress_end(&progress);
  if (status != STRUT_OK) strut_print_error(&error);
  if (status == STRUT_OK && !pictures->silent) print_film(&pictures->film);
  return status;
}

static void free_pictures(run_pictures *pictures) {
  strut_trajectory_sink_free(pictures->sink);
  strut_trajectory_free(&pictures->motion);
}

/* ---- the run ---- */

static const strut_option options[] = {
    STRUT_SET_OPTION,
    STRUT_OUTPUT_OPTION("DIR", "write summary, scene and trajectories into DIR"),
    STRUT_PRINT_OPTIONS,
    STRUT_FORCE_OPTION,
    {.table = strut_experiment_options},
    STRUT_THREADS_OPTION,
    {.table = strut_plot_options},
    {.table = strut_run_figure_options},
    {.table = film_options},
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
  if (keep->scene_text)
    keep->csv = keep->sinks[keep->sink_count++] = strut_csv_create(keep->results.stage);
  if (!keep->csv) return strut_no_memory(error, "");
  keep->hdf5 = keep->sinks[keep->sink_count++] =
      strut_hdf5_create(keep->results.stage, keep->scene_text, error);
  return keep->hdf5 ? STRUT_OK : error->status;
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
                             run_pictures *pictures, strut_summary *summary, strut_error *error) {
  const strut_flag *interrupt = strut_interrupt_watch(); /* before there are files */
  strut_status status = begin_results(arguments, setup, keep, error);
  if (status != STRUT_OK) return status;
  strut_sink *pictures_sink = create_pictures_sink(pictures, model->scene, &status);
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

static strut_status run_model(const strut_arguments *arguments, const strut_setup *setup,
                              const strut_model *model, strut_varied_scenes *scenes,
                              run_pictures *pictures) {
  run_files keep = {.scene_text = NULL};
  strut_summary summary = {0};
  strut_error error = {0}, late = {0};
  strut_status status = simulate(model, setup, arguments, &keep, pictures, &summary, &error);
  if (status == STRUT_OK)
    status = strut_varied_scenes_derive(arguments, scenes, setup, strut_interrupt_watch(), &summary,
                                        &error);
  if (status != STRUT_OK) strut_print_error(&error);
  if (strut_run_has_results(status)) {
    /* Of a result that exists but may not be what was meant. */
    for (size_t i = 0; i < summary.warning_count; i++)
      fprintf(stderr, "strut: warning: %s\n", summary.warnings[i].text);
    strut_status written = complete_results(&keep, &summary, model->scene, &late);
    if (written == STRUT_OK) written = draw_picture(pictures, model, &summary, &late);
    if (written != STRUT_OK) strut_print_error(&late);
    /* The failure of the run is reported, not the missing figure. */
    if (written == STRUT_USAGE && status != STRUT_OK) written = status;
    if (written != STRUT_OK) status = written;
    strut_status printed = strut_print_report(
        arguments, arguments->json ? strut_summary_json(&summary, model->scene, true)
                                   : strut_summary_table(&summary, model->scene,
                                                         strut_report_width(arguments)));
    if (status == STRUT_OK) status = printed;
    if (written == STRUT_OK) written = make_film(pictures, model);
    if (written != STRUT_OK) status = written;
    if (status == STRUT_OK && strut_summary_is_inaccurate(&summary)) status = STRUT_INACCURATE;
  }
  strut_summary_free(&summary);
  free_results(&keep);
  return status;
}

static strut_status run_run(const strut_arguments *arguments) {
  strut_setup setup = {0};
  strut_model *model = NULL;
  strut_error error = {0};
  run_pictures pictures = {0};
  strut_open_report kept = {.prints = true};
  strut_status status = read_pictures(arguments, &pictures);
  if (status == STRUT_OK) status = strut_open_model(arguments, STRUT_OPEN_FOR_RUN, &setup, &kept);
  if (status != STRUT_OK) return status;
  strut_varied_scenes scenes = {.file = strut_model_name(arguments),
                                .text = kept.text,
                                .length = kept.length,
                                .purpose = strut_run_options_purpose(arguments)};
  status = strut_run_options_apply(arguments, &setup);
  if (status == STRUT_OK) status = strut_warn_of_scene(&setup);
  if (status == STRUT_OK) status = strut_model_compile(&setup.scene, &model, &error);
  if (status == STRUT_OK) status = check_pictures(&pictures, &setup.experiment, model, &error);
  if (status == STRUT_OK)
    status = run_model(arguments, &setup, model, &scenes, &pictures);
  else if (error.message[0])
    strut_print_error(&error);
  strut_open_report_free(&kept);
  free_pictures(&pictures);
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
