/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The commands of statics: equilibria, modes, rigidity, path, form, and what they have in common. */
#include "parser/program/open_model.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/figures/statics_figures.h"
#include "engine/output/file.h"
#include "engine/output/report/reports.h"
#include "engine/statics/path/path.h"
#include "parser/command/messages.h"
#include "parser/command/statics_options.h"
#include "parser/program/commands.h"
#include "parser/program/options.h"
#include "parser/program/streams.h"
#include "parser/write/write_scene.h"

strut_status strut_analysis_run(const strut_command *command, const strut_arguments *arguments,
                                const char *const *names, strut_analyse analyse) {
  strut_analysis a = {.arguments = arguments, .names = names};
  strut_error error = {0};
  strut_status status = strut_plot_read(command, arguments, 0, &a.plot);
  if (status == STRUT_OK) status = strut_check_output_writable(arguments, names);
  if (status == STRUT_OK) status = strut_open_model(arguments, STRUT_OPEN_FOR_ANY, &a.setup);
  if (status != STRUT_OK) return status;
  status = strut_model_compile(&a.setup.scene, &a.model, &error);
  if (status == STRUT_OK) status = analyse(&a, &error);
  if (status != STRUT_OK && error.message[0]) strut_print_error(&error);
  strut_model_free(a.model);
  strut_setup_free(&a.setup);
  return status;
}

static strut_status write_files(const char *directory, const char *const *names, const char *json,
                                const char *csv, strut_error *error) {
  strut_status status = strut_directory_create(directory, error);
  if (status == STRUT_OK && (!json || (names[1] && !csv)))
    status = strut_no_memory(error, "while writing files");
  if (status == STRUT_OK) status = strut_file_write_text(directory, names[0], json, error);
  if (status == STRUT_OK && csv) status = strut_file_write_text(directory, names[1], csv, error);
  return status;
}

bool strut_report_needs_json(const strut_arguments *arguments) {
  return arguments->json || arguments->output;
}

strut_status strut_report(const strut_arguments *arguments, const char *const *names, char *json,
                          char *csv, char *table, strut_error *error) {
  strut_status status = STRUT_OK;
  if (arguments->output) status = write_files(arguments->output, names, json, csv, error);
  char *shown = arguments->json ? json : table;
  strut_release(csv);
  strut_release(arguments->json ? table : json);
  if (status == STRUT_OK) return strut_print_report(arguments, shown);
  strut_release(shown);
  return status;
}

static const char *const equilibria_file_names[] = {"equilibria.json", NULL};

static const strut_option equilibria_options[] = {
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    STRUT_EQUILIBRIA_OPTIONS,
    {STRUT_OPTION_OUTPUT, "output", "DIR", "write equilibria.json into DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print everything as one JSON object"},
    STRUT_PLOT_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_status analyse_equilibria(strut_analysis *a, strut_error *error) {
  strut_equilibria_options wanted;
  strut_equilibria all = {0};
  uint64_t seed;
  strut_status status = strut_equilibria_options_read(&strut_command_equilibria, a->arguments,
                                                      &a->setup, &wanted, &seed);
  wanted.interrupt = strut_interrupt_watch();
  if (!status) status = strut_equilibria_find(a->model, &a->setup.experiment, &wanted, &all, error);
  if (!status)
    status = strut_report(
        a->arguments, a->names,
        strut_report_needs_json(a->arguments) ? strut_equilibria_json(&all, a->model) : NULL, NULL,
        strut_equilibria_table(&all, a->model, a->arguments->all), error);
  if (!status) strut_warn_of_equilibria(a->arguments->listener, a->model, &all);
  if (!status && a->plot.path && all.count > 0)
    status = strut_equilibria_figure(&a->plot, a->model, &all, error);
  if (!status && all.count == 0) status = strut_fail(error, STRUT_NOT_SETTLED, "%s", all.remark);
  strut_equilibria_free(&all);
  return status;
}

static strut_status run_equilibria(const strut_arguments *arguments) {
  return strut_analysis_run(&strut_command_equilibria, arguments, equilibria_file_names,
                            analyse_equilibria);
}

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
    .run = run_equilibria,
    .timed = true,
};

static const char *const modes_file_names[] = {"modes.json", "modes.csv", NULL};

static const strut_option modes_options[] = {
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    STRUT_MODES_OPTIONS,
    {STRUT_OPTION_OUTPUT, "output", "DIR", "write modes.json and modes.csv into DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print everything as one JSON object"},
    STRUT_PLOT_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_status analyse_modes(strut_analysis *a, strut_error *error) {
  strut_modes modes = {0};
  strut_modes_options wanted;
  strut_status status = strut_modes_options_read(&strut_command_modes, a->arguments, &wanted);
  if (status != STRUT_OK) return status;
  status = strut_modes_find(a->model, &a->setup.experiment, &wanted, &modes, error);
  if (status == STRUT_OK)
    status = strut_report(
        a->arguments, a->names,
        strut_report_needs_json(a->arguments) ? strut_modes_json(a->model, &modes) : NULL,
        a->arguments->output ? strut_modes_csv(&modes) : NULL, strut_modes_table(a->model, &modes),
        error);
  if (status == STRUT_OK)
    strut_warn_of_overload(a->arguments->listener, a->model, modes.q, "in this shape");
  if (status == STRUT_OK && a->plot.path)
    status = strut_modes_figure(&a->plot, a->model, &modes, (size_t)wanted.count, error);
  strut_modes_free(&modes);
  return status;
}

static strut_status run_modes(const strut_arguments *arguments) {
  return strut_analysis_run(&strut_command_modes, arguments, modes_file_names, analyse_modes);
}

const strut_command strut_command_modes = {
    .name = "modes",
    .model = "MODEL",
    .summary = "computes natural frequencies and mode shapes about an equilibrium",
    .details =
        "\nClosed contacts stay closed and slide without friction, unless --stuck holds them.\n"
        "Without --at, the equilibrium is the one in which the start comes to rest. All modes are\n"
        "computed up to 400 coordinates, beyond that the ten lowest.\n",
    .options = modes_options,
    .run = run_modes,
    .timed = true,
};

static const char *const rigidity_file_names[] = {"rigidity.json", NULL};

static const strut_option rigidity_options[] = {
    STRUT_SHAPE_OPTIONS,
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    {STRUT_OPTION_OUTPUT, "output", "DIR", "write rigidity.json into DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print everything as one JSON object"},
    STRUT_PLOT_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_status analyse_rigidity(strut_analysis *a, strut_error *error) {
  const strut_model *model = a->model;
  strut_arena arena = {0};
  strut_named_shape shape;
  strut_rigidity rigidity = {0};
  strut_status status =
      strut_named_shape_find(a->arguments, model, &a->setup.experiment, &arena, &shape, error);
  if (status == STRUT_OK) status = strut_rigidity_find(model, shape.q, &rigidity, error);
  if (status == STRUT_OK)
    status = strut_report(a->arguments, a->names,
                          strut_report_needs_json(a->arguments)
                              ? strut_rigidity_json(&rigidity, model, shape.name)
                              : NULL,
                          NULL, strut_rigidity_table(&rigidity, model, shape.name), error);
  if (status == STRUT_OK && a->plot.path)
    status = strut_rigidity_figure(&a->plot, model, shape.q, shape.name, &rigidity, error);
  strut_rigidity_free(&rigidity);
  strut_arena_free(&arena);
  return status;
}

static strut_status run_rigidity(const strut_arguments *arguments) {
  return strut_analysis_run(&strut_command_rigidity, arguments, rigidity_file_names,
                            analyse_rigidity);
}

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
    .run = run_rigidity,
    .timed = true,
};

static const char *const path_file_names[] = {"path.json", "path.csv", NULL};

static const strut_option path_options[] = {
    STRUT_PATH_OPTIONS,
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    {STRUT_OPTION_OUTPUT, "output", "DIR", "write path.json and path.csv into DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print everything as one JSON object"},
    STRUT_PLOT_OPTIONS,
    STRUT_AXIS_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

/* Writes, prints and draws the path; reports what fails on stderr. */
static strut_status report_path(const strut_arguments *arguments, const strut_plot *plot,
                                const strut_model *model, const strut_path *path) {
  strut_error error = {0};
  strut_status status = strut_report(
      arguments, path_file_names, strut_path_json(path, model->scene),
      strut_path_csv(path, model->scene), strut_path_table(path, model->scene), &error);
  if (status == STRUT_OK) strut_warn_of_path(arguments->listener, model->scene, path);
  if (status == STRUT_OK && plot->path) status = strut_path_figure(plot, model, path, &error);
  if (status != STRUT_OK && error.message[0]) strut_print_error(&error);
  return status;
}

static strut_status follow_path(const strut_arguments *arguments, const strut_plot *plot,
                                const strut_path_options *wanted, const strut_setup *setup) {
  strut_path path = {0};
  strut_model *model = NULL;
  strut_error error = {0};
  strut_status status = strut_model_compile(&setup->scene, &model, &error);
  if (status == STRUT_OK)
    status = strut_path_follow(model, &setup->experiment, wanted, &path, &error);
  if (status == STRUT_OK)
    status = report_path(arguments, plot, model, &path);
  else
    strut_print_error(&error);
  strut_path_free(&path);
  strut_model_free(model);
  return status;
}

static strut_status run_path(const strut_arguments *arguments) {
  strut_setup setup;
  strut_path_options wanted;
  strut_varied_scenes followed = {.file = strut_model_name(arguments)};
  strut_plot plot;
  char *text = NULL;
  strut_status status = strut_path_options_read(&strut_command_path, arguments, &wanted);
  if (status == STRUT_OK) status = strut_plot_read(&strut_command_path, arguments, 0, &plot);
  if (status != STRUT_OK) return status;
  status = strut_check_output_writable(arguments, path_file_names);
  if (status != STRUT_OK) return status;
  status = strut_open_model_text(arguments, &text, &followed.length, &setup);
  if (status != STRUT_OK) return status;
  followed.text = text;
  status =
      strut_path_followed_read(&strut_command_path, arguments, &setup.scene, &followed, &wanted);
  if (status == STRUT_OK) status = follow_path(arguments, &plot, &wanted, &setup);
  strut_varied_scenes_free(&followed);
  strut_release(text);
  strut_setup_free(&setup);
  return status;
}

const strut_command strut_command_path = {
    .name = "path",
    .model = "MODEL",
    .summary = "follows an equilibrium as a load, an actuator or a parameter changes",
    .details =
        "\nStarts without the load at the equilibrium in which the start comes to rest, and "
        "follows\n"
        "the equilibria as the load factor grows, past limit points, to the factor VALUE. Detects\n"
        "limit points, bifurcations, cables that become slack or taut, and nodes that touch or\n"
        "leave the ground, each with its effect on stability. Friction and drives are ignored.\n"
        "--over varies something else at constant loads: a number under 'parameters' (from its\n"
        "value in the file), an actuator (the change of its member's rest length, its hinge's "
        "rest\n"
        "angle or its cell's pressure), or the prescribed displacement of a node along x or y.\n",
    .options = path_options,
    .run = run_path,
    .timed = true,
};

static const strut_option form_options[] = {
    STRUT_FORM_OPTIONS,
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    {STRUT_OPTION_OUTPUT, "output", "FILE", "write the new model to FILE and print a report"},
    {STRUT_OPTION_JSON, "json", NULL, "print the report as one JSON object instead of the model"},
    STRUT_PLOT_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

/* A model before its form was found. */
typedef struct drawn_model {
  char *text, *flat; /* of the file; of strut_setup_write */
  size_t length;
  double (*position)[2]; /* (node_count) */
} drawn_model;

/* The new model, in the words of the file where that can be. NULL: it was reported. */
static char *write_model(const strut_arguments *arguments, const drawn_model *drawn,
                         const strut_setup *setup) {
  char *model;
  if (strut_write_short(arguments, drawn->text, drawn->length, drawn->flat, setup, false, &model))
    return NULL;
  if (!model) model = strut_setup_write(setup);
  if (!model) strut_print_out_of_memory();
  return model;
}

/* With -o the model goes there, and a report to stdout, else the model. */
static strut_status report_form(const strut_arguments *arguments, const drawn_model *drawn,
                                const strut_setup *setup, const strut_form *form) {
  strut_error error = {0};
  bool silent = arguments->quiet && arguments->output && !arguments->json;
  bool wanted = arguments->output || !arguments->json;
  char *model = wanted ? write_model(arguments, drawn, setup) : NULL, *text = NULL;
  strut_status status = wanted && !model ? STRUT_NO_MEMORY : STRUT_OK;
  if (status == STRUT_OK && arguments->output) {
    status = strut_file_write_path(arguments->output, model, &error);
    if (status != STRUT_OK) strut_print_error(&error);
  }
  if (arguments->json || arguments->output)
    text = arguments->json ? strut_form_json(form, &setup->scene) : strut_form_table(form, setup);
  if (status == STRUT_OK && !text && (arguments->json || arguments->output))
    status = strut_print_out_of_memory();
  if (status == STRUT_OK && !silent) status = strut_print(text ? text : model);
  strut_release(model);
  strut_release(text);
  return status;
}

static strut_status draw_form(const strut_plot *plot, const strut_scene *scene,
                              const double (*drawn)[2], strut_error *error) {
  strut_model *model = NULL;
  if (!plot->path) return STRUT_OK;
  strut_status status = strut_model_compile(scene, &model, error);
  if (status == STRUT_OK) status = strut_form_figure(plot, model, drawn, error);
  strut_model_free(model);
  return status;
}

/* Finds the form, prints and draws it. */
static strut_status find_form(const strut_arguments *arguments, const strut_form_options *wanted,
                              const strut_plot *plot, strut_setup *setup,
                              const drawn_model *drawn) {
  const strut_scene *scene = &setup->scene;
  strut_form form;
  strut_error error = {0};
  for (size_t i = 0; i < scene->node_count; i++)
    memcpy(drawn->position[i], scene->nodes[i].position, sizeof *drawn->position);
  strut_status status = strut_form_find(setup, wanted, &form, &error);
  if (status == STRUT_OK) status = report_form(arguments, drawn, setup, &form);
  if (status == STRUT_OK)
    status = draw_form(plot, scene, (const double(*)[2])drawn->position, &error);
  if (error.message[0]) strut_print_error(&error);
  return status;
}

static strut_status run_form(const strut_arguments *arguments) {
  strut_setup setup;
  strut_form_options wanted = {0};
  strut_plot plot;
  strut_arena arena = {0};
  strut_status status = strut_form_options_read(&strut_command_form, arguments, &wanted);
  if (status == STRUT_OK) status = strut_plot_read(&strut_command_form, arguments, 0, &plot);
  if (status == STRUT_OK) status = strut_try_file(arguments->output);
  if (status != STRUT_OK) return status;
  drawn_model drawn = {0};
  status = strut_open_model_text(arguments, &drawn.text, &drawn.length, &setup);
  if (status != STRUT_OK) return status;
  drawn.flat = strut_setup_write(&setup);
  drawn.position = strut_arena_allocate(&arena, setup.scene.node_count, sizeof *drawn.position);
  status = drawn.position && drawn.flat ? find_form(arguments, &wanted, &plot, &setup, &drawn)
                                        : strut_print_out_of_memory();
  strut_release(drawn.text);
  strut_release(drawn.flat);
  strut_arena_free(&arena);
  strut_setup_free(&setup);
  return status;
}

const strut_command strut_command_form = {
    .name = "form",
    .model = "MODEL",
    .summary = "finds an equilibrium shape or prestress, and writes that model",
    .details =
        "\n--from densities: the shape given by the force densities of the members, or the "
        "nearest\n"
        "densities for which one exists. --from lengths: the shape given by the rest lengths.\n"
        "--from prestress: the drawn shape, with rest lengths that hold it under gravity, loads "
        "and\n"
        "ground forces, every cable in tension. By default, densities if the model gives force\n"
        "densities, lengths if it gives rest lengths, otherwise prestress.\n"
        "The new model is printed or written to FILE, with the parameters, groups and parts of "
        "the\n"
        "old one where these can say it; it stays at rest when run without drives.\n",
    .options = form_options,
    .run = run_form,
};
