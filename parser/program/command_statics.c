/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The commands of statics: equilibria, modes, rigidity, path, form. */
#include "parser/program/open_model.h"

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "parser/language/write/write_scene.h"
#include "parser/program/command/analyses.h"
#include "parser/program/commands.h"
#include "parser/program/options.h"
#include "parser/program/streams.h"

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
                                                STRUT_PRINT_OPTIONS,                               \
                                                {.table = strut_plot_options},                     \
                                                LAST,                                              \
                                                {.name = NULL}};

STATICS_OPTIONS(equilibria, "write equilibria.json into DIR", {.name = NULL})

const strut_command strut_command_equilibria = {
    .name = "equilibria",
    .model = "MODEL",
    .summary = "searches for all equilibria and the energy barriers between stable ones",
    .details =
        "\nThe search holds pairs of contact nodes in turn in place of the ground and starts from\n"
        "the drawn shape, mirrored copies and random shapes. Stable equilibria are then released\n"
        "on the real ground, without drive and friction. The table lists what stands there and\n"
        "the energy barriers between; 'stiffness' is the lowest eigenvalue, 'found' the number of\n"
        "starts that ended there. --all adds those that sink, tip over or are unstable.\n"
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

static strut_status open_form(strut_analysis *analysis, char **text) {
  strut_status status = strut_analysis_open(analysis, text);
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
