/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Commands with an analysis: what all of them do, and those of statics. */
#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "engine/output/result_values.h"
#include "engine/output/results.h"
#include "parser/language/write/write_scene.h"
#include "parser/program/command/analyses.h"
#include "parser/program/commands.h"

/* What commands with an analysis do: open, compute with progress, write the files of -o, print, draw. */

static size_t file_count(const strut_output_file *file) { return file->most ? file->most : 1; }

/* The name of a file, or of a numbered picture; NULL: memory is out. */
static const char *name_file(strut_arena *arena, const strut_output_file *file, size_t i) {
  return file->most ? strut_arena_format(arena, "%s-%zu.svg", file->name, i + 1) : file->name;
}

/* The names of all files, NULL after the last; NULL: memory is out. */
static const char *const *list_names(strut_arena *arena, const strut_output_file *files) {
  size_t count = 0, n = 0;
  for (const strut_output_file *file = files; file->name; file++) count += file_count(file);
  const char **names = strut_arena_allocate(arena, count + 1, sizeof *names);
  for (const strut_output_file *file = files; names && file->name; file++)
    for (size_t i = 0; i < file_count(file); i++)
      if (!(names[n++] = name_file(arena, file, i))) return NULL;
  return names;
}

static strut_status write_file(strut_analysis *a, const strut_output_file *file, size_t i,
                               const char *directory, const char *json, const strut_plot *plot,
                               strut_error *error) {
  const char *name = name_file(&a->arena, file, i);
  const strut_value_rows *rows = file->rows ? file->rows : a->kind->rows;
  if (file->there && !file->there(a, file->number + i)) return STRUT_OK;
  if (file->draw) {
    strut_plot own = file->width > 0.0 ? (strut_plot){.width = file->width} : *plot;
    own.path = strut_arena_format(&a->arena, "%s/%s", directory, name);
    a->picture = file->number + i;
    return own.path ? file->draw(a, &own, error) : strut_no_memory(error, "");
  }
  if (file->csv || file->list)
    return strut_file_write_block(
        directory, name,
        file->csv ? file->csv(a) : strut_values_csv(rows, file->list, NULL, a->found, a->scene),
        error);
  return json ? strut_file_write_text(directory, name, json, error) : strut_no_memory(error, "");
}

/* Writes all files of -o or none. */
static strut_status write_files(strut_analysis *a, const char *directory, const char *json,
                                const strut_plot *plot, strut_error *error) {
  strut_results results = {0};
  const char *const *names = list_names(&a->arena, a->kind->files);
  strut_status status = names ? strut_results_begin_named(&results, directory, names, error)
                              : strut_no_memory(error, "");
  for (const strut_output_file *file = a->kind->files; !status && file->name; file++)
    for (size_t i = 0; i < file_count(file) && !status; i++)
      status = write_file(a, file, i, results.stage, json, plot, error);
  if (!status) status = strut_results_commit(&results, error);
  strut_results_abandon(&results);
  return status;
}

/* Writes the files and prints the CSV, the JSON or the table. */
static strut_status report(strut_analysis *a, const strut_arguments *arguments,
                           const strut_plot *plot, strut_error *error) {
  /* Of large structures the JSON takes long to make. */
  char *json = arguments->json || arguments->output ? strut_analysis_json(a) : NULL;
  strut_status status = STRUT_OK;
  if (arguments->output) status = write_files(a, arguments->output, json, plot, error);
  if (!status && arguments->json) return strut_print_report(arguments, json);
  strut_release(json);
  if (status) return status;
  return strut_print_report(
      arguments, arguments->csv
                     ? strut_values_csv(a->kind->rows, a->kind->printed, NULL, a->found, a->scene)
                     : strut_analysis_text(a, strut_report_width(arguments)));
}

/* Finds out, before anything is computed, whether the files can go where -o and --plot want them. */
static strut_status check_files(strut_analysis *a, const strut_arguments *arguments,
                                strut_plot *plot) {
  const strut_output_file *files = a->kind->files;
  const char *const *names = files ? list_names(&a->arena, files) : NULL;
  strut_status status = strut_plot_read(arguments, a->kind->width, plot);
  if (status) return status;
  if (arguments->json && arguments->csv)
    return strut_usage_error(arguments, "give either --json or --csv, not both");
  if (!files) return strut_try_file(arguments->output);
  return names ? strut_check_output_writable(arguments, names) : strut_print_out_of_memory();
}

/* Opens the model that the arguments name for statics. */
static strut_status open_for_statics(strut_analysis *a, char **text) {
  strut_open_report kept = {.prints = true};
  strut_status status = strut_open_model(a->arguments, STRUT_OPEN_FOR_STATICS, a->setup, &kept);
  a->scenes.text = *text = kept.text;
  a->scenes.length = kept.length;
  return status;
}

/* Computes, shows what was found, and says what is doubtful. */
static strut_status compute(strut_analysis *a, const strut_arguments *arguments,
                            const strut_plot *plot, strut_error *error) {
  strut_progress progress = strut_progress_begin(arguments->quiet);
  a->interrupt = a->kind->asks ? strut_interrupt_watch() : NULL;
  a->progress = progress.wanted ? strut_progress_show : NULL;
  a->progress_context = &progress;
  const strut_status computed = strut_analysis_compute(a, error);
  strut_progress_end(&progress);
  if (computed && !a->partial) return computed;
  strut_print_failure(computed, error);
  *error = (strut_error){0};
  strut_status status = arguments->command->report ? arguments->command->report(a, arguments, error)
                                                   : report(a, arguments, plot, error);
  if (!status && a->kind->warn) a->kind->warn(a, arguments->listener);
  a->picture = 0;
  if (!status && plot->path) status = a->kind->draw(a, plot, error);
  if (!status && a->kind->verdict) status = a->kind->verdict(a, error);
  return computed ? computed : status;
}

strut_status strut_analysis_run(const strut_arguments *arguments) {
  const strut_command *command = arguments->command;
  strut_setup setup = {0};
  strut_plot plot;
  strut_model *model = NULL;
  char *text = NULL;
  strut_error error = {0};
  strut_analysis a = {.kind = command->analysis,
                      .arguments = arguments,
                      .setup = &setup,
                      .scenes = {.file = strut_model_name(arguments)}};
  strut_status status = check_files(&a, arguments, &plot);
  if (!status) status = command->open ? command->open(&a, &text) : open_for_statics(&a, &text);
  if (!status && !a.kind->uncompiled) status = strut_model_compile(&setup.scene, &model, &error);
  a.model = model;
  if (!status) status = compute(&a, arguments, &plot, &error);
  if (status && error.message[0]) strut_print_error(&error);
  strut_analysis_free(&a);
  strut_model_free(model);
  strut_release(text);
  strut_setup_free(&setup);
  return status;
}

/* The first is refused by form alone. */
static const strut_refused_option refused[] = {
    {"threads", "it computes one step after the other"},
    {"accuracy", "equilibria are computed to rounding errors"},
    {"integrator", "nothing is integrated over time"},
    {"step", "nothing is integrated over time"},
    {NULL, NULL}};

/* A command by its analysis: its -o, a further table of options or none, and its forms. */
#define STATICS(NAME, FILES, TABLE, FORMS, SUMMARY, DETAILS)                                       \
  static const strut_option NAME##_options[] = {{.table = strut_##NAME##_analysis_options},        \
                                                STRUT_SET_OPTION,                                  \
                                                STRUT_THREADS_OPTION,                              \
                                                STRUT_OUTPUT_OPTION("DIR", FILES),                 \
                                                STRUT_PRINT_OPTIONS,                               \
                                                {.table = strut_plot_options},                     \
                                                {.table = TABLE},                                  \
                                                {.name = NULL}};                                   \
  const strut_command strut_command_##NAME = {.name = #NAME,                                       \
                                              .model = "MODEL",                                    \
                                              .summary = SUMMARY,                                  \
                                              .details = DETAILS,                                  \
                                              .options = NAME##_options,                           \
                                              .analysis = &strut_##NAME##_analysis,                \
                                              .refused = refused + 1,                              \
                                              .timed = true,                                       \
                                              .forms = FORMS};

STATICS(equilibria, "write equilibria.json into DIR", NULL, NULL,
        "searches for all equilibria and the energy barriers between stable ones",
        "\nThe search holds pairs of contact nodes in turn in place of the ground and starts from\n"
        "the drawn shape, mirrored copies and random shapes. Stable equilibria are then released\n"
        "on the real ground, without drive and friction. The table lists what stands there and\n"
        "the energy barriers between; 'stiffness' is the lowest eigenvalue, 'found' the number of\n"
        "starts that ended there. --all adds those that sink, tip over or are unstable.\n"
        "Names such as n1-n4-2 give the touching nodes and the rank by energy.\n"
        "Exit code 3 if nothing ever comes to rest.\n")

STATICS(modes, "write modes.json and modes.csv into DIR", NULL, NULL,
        "computes natural frequencies and mode shapes about an equilibrium",
        "\nClosed contacts stay closed and slide without friction, unless --stuck holds them.\n"
        "Without --at, the equilibrium is the one in which the start comes to rest. All modes are\n"
        "computed up to 400 coordinates, beyond that the ten lowest.\n")

STATICS(rigidity, "write rigidity.json into DIR", NULL, NULL,
        "computes self-stress states and mechanisms, and classifies them",
        "\nPrints the rank of the equilibrium matrix with its spectral gap, self-stress states,\n"
        "mechanisms (rigid-body, infinitesimal, finite), super stability, and the\n"
        "member forces in the shape. Supports are those of the scene; the ground does not\n"
        "count as one.\n")

static const strut_command_variant path_forms[] = {{"periodic", &strut_command_periodic},
                                                   {NULL, NULL}};

STATICS(path, "write path.json and path.csv into DIR", strut_axis_options, path_forms,
        "follows an equilibrium as a load, an actuator or a parameter changes",
        "\nStarts without the load at the equilibrium in which the start comes to rest, and "
        "follows\n"
        "the equilibria as the load factor grows, past limit points, to the factor VALUE. Detects\n"
        "limit points, bifurcations, cables that become slack or taut, and nodes that touch or\n"
        "leave the ground, each with its effect on stability. Drives are ignored, and friction "
        "unless kept.\n"
        "--over varies something else at constant loads: a number under 'parameters' (from its\n"
        "value in the file), an actuator (the change of its member's rest length, its hinge's "
        "rest\n"
        "angle or its cell's pressure), or the prescribed displacement of a node along x or y.\n")

static const strut_option form_options[] = {
    {.table = strut_form_analysis_options},
    STRUT_SET_OPTION,
    STRUT_OUTPUT_OPTION("FILE", "write the new model to FILE and print a report"),
    {STRUT_FILLS(json), "json", NULL, "print the report as one JSON object instead of the model"},
    {.table = strut_plot_options},
    {.name = NULL},
};

static strut_status open_form(strut_analysis *analysis, char **text) {
  strut_status status = open_for_statics(analysis, text);
  if (status) return status;
  analysis->result.form.before = strut_setup_write(analysis->setup);
  return analysis->result.form.before ? STRUT_OK : strut_print_out_of_memory();
}

/* The new model, in the words of the file where that can be; NULL: it was reported. */
static char *write_model(const strut_arguments *arguments, const strut_analysis *analysis) {
  char *model;
  if (strut_write_short(arguments, analysis->scenes.text, analysis->scenes.length,
                        analysis->result.form.before, analysis->setup, false, &model))
    return NULL;
  if (!model) model = strut_setup_write(analysis->setup);
  if (!model) strut_print_out_of_memory();
  return model;
}

/* With -o the model goes there, and a report to stdout, else the model. */
static strut_status report_form(const strut_analysis *analysis, const strut_arguments *arguments,
                                strut_error *error) {
  const char *output = arguments->output;
  const bool wanted = output || !arguments->json;
  char *model = wanted ? write_model(arguments, analysis) : NULL;
  strut_status status = wanted && !model ? STRUT_NO_MEMORY : STRUT_OK;
  if (model && output) status = strut_file_write_path(output, model, error);
  if (model && !status && !output) status = strut_print(model);
  strut_release(model);
  if (status || !(output || arguments->json)) return status;
  return strut_print_report(
      arguments, arguments->json ? strut_analysis_json(analysis)
                                 : strut_analysis_text(analysis, strut_report_width(arguments)));
}

static const char form_details[] =
    "\n--given densities: the shape given by the force densities of the members, or the nearest\n"
    "densities for which one exists. --given lengths: the shape given by the rest lengths.\n"
    "--given prestress: the drawn shape, with rest lengths that hold it under gravity, loads and\n"
    "ground forces, every cable in tension. By default, densities if the model gives force\n"
    "densities, lengths if it gives rest lengths, otherwise prestress.\n"
    "The new model is printed or written to FILE, with the parameters, groups and parts of the\n"
    "old one where these can say it; it stays at rest when run without drives.\n";

const strut_command strut_command_form = {
    .name = "form",
    .model = "MODEL",
    .summary = "finds an equilibrium shape or prestress, and writes that model",
    .details = form_details,
    .options = form_options,
    .analysis = &strut_form_analysis,
    .open = open_form,
    .report = report_form,
    .refused = refused,
};
