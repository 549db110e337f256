/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The commands of statics: equilibria, modes, rigidity, path, form, and what they have in common. */
#include "parser/program/open_model.h"

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "parser/language/write/write_scene.h"
#include "parser/program/command/analyses.h"
#include "parser/program/commands.h"
#include "parser/program/options.h"
#include "parser/program/progress.h"
#include "parser/program/streams.h"

static strut_status write_files(const char *directory, const char *const *names, const char *json,
                                const char *csv, strut_error *error) {
  strut_status status = strut_directory_create(directory, error);
  if (status == STRUT_OK && (!json || (names[1] && !csv)))
    status = strut_no_memory(error, "while writing files");
  if (status == STRUT_OK) status = strut_file_write_text(directory, names[0], json, error);
  if (status == STRUT_OK && csv) status = strut_file_write_text(directory, names[1], csv, error);
  return status;
}

/* Writes the files of -o and prints the JSON or the table. */
static strut_status report(const strut_arguments *arguments, const strut_analysis *analysis,
                           strut_error *error) {
  const strut_analysis_kind *kind = analysis->kind;
  strut_status status = STRUT_OK;
  /* Of large structures the JSON takes long to make. */
  char *json = arguments->json || arguments->output ? strut_analysis_json(analysis) : NULL,
       *csv = NULL;
  if (arguments->output && kind->csv) csv = kind->csv(analysis);
  if (arguments->output) status = write_files(arguments->output, kind->files, json, csv, error);
  strut_release(csv);
  if (status == STRUT_OK && arguments->json) return strut_print_report(arguments, json);
  strut_release(json);
  return status == STRUT_OK
             ? strut_print_report(arguments, strut_analysis_text(analysis, strut_report_width()))
             : status;
}

static strut_status compute_and_report(const strut_arguments *arguments, const strut_plot *plot,
                                       strut_analysis *analysis, strut_error *error) {
  const strut_analysis_kind *kind = analysis->kind;
  strut_progress *progress = analysis->setup->experiment.progress_context;
  strut_status status = strut_analysis_compute(analysis, error);
  strut_progress_end(progress);
  analysis->setup->experiment.progress = NULL;
  if (status == STRUT_OK) status = report(arguments, analysis, error);
  if (status == STRUT_OK && kind->warn) kind->warn(analysis, arguments->listener);
  if (status == STRUT_OK && plot->path) status = kind->draw(analysis, plot, error);
  if (status == STRUT_OK && kind->verdict) status = kind->verdict(analysis, error);
  return status;
}

strut_status strut_analysis_run(const strut_arguments *arguments) {
  strut_setup setup;
  strut_plot plot;
  strut_model *model = NULL;
  char *text = NULL;
  strut_error error = {0};
  strut_analysis a = {.kind = arguments->command->analysis,
                      .arguments = arguments,
                      .setup = &setup,
                      .scenes = {.file = strut_model_name(arguments)}};
  strut_status status = strut_plot_read(arguments, 0, &plot);
  if (status == STRUT_OK) status = strut_check_output_writable(arguments, a.kind->files);
  if (status == STRUT_OK)
    status = strut_open_model_text(arguments, &text, &a.scenes.length, &setup);
  if (status != STRUT_OK) return status;
  a.scenes.text = text;
  if (a.kind->asks) setup.experiment.interrupt = strut_interrupt_watch();
  strut_progress progress = strut_progress_begin(arguments->quiet);
  setup.experiment.progress = progress.wanted ? strut_progress_show : NULL;
  setup.experiment.progress_context = &progress;
  status = strut_model_compile(&setup.scene, &model, &error);
  a.model = model;
  if (status == STRUT_OK) status = compute_and_report(arguments, &plot, &a, &error);
  if (status != STRUT_OK && error.message[0]) strut_print_error(&error);
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

/* Options of a command by its analysis; LAST: a further row, or the end. */
#define STATICS_OPTIONS(NAME, FILES, LAST)                                                         \
  static const strut_option NAME##_options[] = {{.table = strut_##NAME##_analysis_options},        \
                                                STRUT_SET_OPTION,                                  \
                                                STRUT_THREADS_OPTION,                              \
                                                STRUT_OUTPUT_OPTION("DIR", FILES),                 \
                                                STRUT_JSON_OPTION,                                 \
                                                {.table = strut_plot_options},                     \
                                                LAST,                                              \
                                                {.name = NULL}};

STATICS_OPTIONS(equilibria, "write equilibria.json into DIR", {.name = NULL})

const strut_command strut_command_equilibria = {
    .name = "equilibria",
    .model = "MODEL",
    .summary = "finds all equilibria, and the energy barriers between stable ones",
    .details =
        "\nThe search holds pairs of contact nodes in turn in place of the ground and starts from\n"
        "the drawn shape, mirrored copies and random shapes. Stable shapes are then released on\n"
        "the real ground, without drive and friction. The table lists what stands there and the\n"
        "energy barriers between; 'stiffness' is the lowest eigenvalue, 'found' the number of\n"
        "starts that ended there. --all adds shapes that sink, tip over or are unstable.\n"
        "Names such as n1-n4-2 give the touching nodes and the rank by energy.\n"
        "Exit code 3 if nothing ever comes to rest.\n",
    .options = equilibria_options,
    .analysis = &strut_equilibria_analysis,
    .refused = refused + 1,
    .timed = true,
};

STATICS_OPTIONS(modes, "write modes.json and modes.csv into DIR", {.name = NULL})

const strut_command strut_command_modes = {
    .name = "modes",
    .model = "MODEL",
    .summary = "computes natural frequencies and mode shapes about an equilibrium",
    .details =
        "\nClosed contacts stay closed and slide without friction, unless --stuck holds them.\n"
        "Without --at, the equilibrium is the one in which the start comes to rest. All modes are\n"
        "computed up to 400 coordinates, beyond that the ten lowest.\n",
    .options = modes_options,
    .analysis = &strut_modes_analysis,
    .refused = refused + 1,
    .timed = true,
};

STATICS_OPTIONS(rigidity, "write rigidity.json into DIR", {.name = NULL})

const strut_command strut_command_rigidity = {
    .name = "rigidity",
    .model = "MODEL",
    .summary = "computes self-stress states and mechanisms, and classifies them",
    .details =
        "\nPrints the rank of the equilibrium matrix with its spectral gap, self-stress states,\n"
        "mechanisms (rigid-body, infinitesimal, finite), super stability, and the\n"
        "member forces in the shape. Supports are those of the scene; the ground does not\n"
        "count as one.\n",
    .options = rigidity_options,
    .analysis = &strut_rigidity_analysis,
    .refused = refused + 1,
    .timed = true,
};

STATICS_OPTIONS(path, "write path.json and path.csv into DIR", {.table = strut_axis_options})

static const strut_command_variant path_forms[] = {{"periodic", &strut_command_periodic},
                                                   {NULL, NULL}};

const strut_command strut_command_path = {
    .name = "path",
    .model = "MODEL",
    .summary = "follows an equilibrium as a load, an actuator or a parameter changes",
    .details =
        "\nStarts without the load at the equilibrium in which the start comes to rest, and "
        "follows\n"
        "the equilibria as the load factor grows, past limit points, to the factor VALUE. Detects\n"
        "limit points, bifurcations, cables that become slack or taut, and nodes that touch or\n"
        "leave the ground, each with its effect on stability. Drives are ignored, and friction "
        "unless kept.\n"
        "--over varies something else at constant loads: a number under 'parameters' (from its\n"
        "value in the file), an actuator (the change of its member's rest length, its hinge's "
        "rest\n"
        "angle or its cell's pressure), or the prescribed displacement of a node along x or y.\n",
    .options = path_options,
    .forms = path_forms,
    .analysis = &strut_path_analysis,
    .refused = refused + 1,
    .timed = true,
};

static const strut_option form_options[] = {
    {.table = strut_form_analysis_options},
    STRUT_SET_OPTION,
    STRUT_OUTPUT_OPTION("FILE", "write the new model to FILE and print a report"),
    {STRUT_FILLS(json), "json", NULL, "print the report as one JSON object instead of the model"},
    {.table = strut_plot_options},
    {.name = NULL},
};

/* The new model, in the words of the file where that can be; `flat`: the model before. NULL: it was reported. */
static char *write_model(const strut_arguments *arguments, const strut_analysis *analysis,
                         const char *flat) {
  char *model;
  if (strut_write_short(arguments, analysis->scenes.text, analysis->scenes.length, flat,
                        analysis->setup, false, &model))
    return NULL;
  if (!model) model = strut_setup_write(analysis->setup);
  if (!model) strut_print_out_of_memory();
  return model;
}

/* With -o the model goes there, and a report to stdout, else the model. */
static strut_status report_form(const strut_arguments *arguments, const strut_analysis *analysis,
                                const char *flat, strut_error *error) {
  bool silent = arguments->quiet && arguments->output && !arguments->json;
  bool wanted = arguments->output || !arguments->json;
  char *model = wanted ? write_model(arguments, analysis, flat) : NULL, *text = NULL;
  strut_status status = wanted && !model ? STRUT_NO_MEMORY : STRUT_OK;
  if (status == STRUT_OK && arguments->output)
    status = strut_file_write_path(arguments->output, model, error);
  if (arguments->json || arguments->output)
    text = arguments->json ? strut_analysis_json(analysis)
                           : strut_analysis_text(analysis, strut_report_width());
  if (status == STRUT_OK && !text && (arguments->json || arguments->output))
    status = strut_print_out_of_memory();
  if (status == STRUT_OK && !silent) status = strut_print(text ? text : model);
  strut_release(model);
  strut_release(text);
  return status;
}

static strut_status run_form(const strut_arguments *arguments) {
  strut_setup setup;
  strut_plot plot;
  strut_error error = {0};
  strut_status status = strut_plot_read(arguments, 0, &plot);
  if (status == STRUT_OK) status = strut_try_file(arguments->output);
  if (status != STRUT_OK) return status;
  char *text = NULL;
  strut_analysis a = {.kind = &strut_form_analysis, .arguments = arguments, .setup = &setup};
  status = strut_open_model_text(arguments, &text, &a.scenes.length, &setup);
  if (status != STRUT_OK) return status;
  a.scenes.text = text;
  char *flat = strut_setup_write(&setup);
  status = flat ? strut_analysis_compute(&a, &error) : strut_print_out_of_memory();
  if (status == STRUT_OK) status = report_form(arguments, &a, flat, &error);
  if (status == STRUT_OK && plot.path) status = a.kind->draw(&a, &plot, &error);
  if (error.message[0]) strut_print_error(&error);
  strut_analysis_free(&a);
  strut_release(text);
  strut_release(flat);
  strut_setup_free(&setup);
  return status;
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
    .run = run_form,
    .refused = refused,
};
