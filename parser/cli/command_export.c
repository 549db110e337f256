/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/command_export.h"

#include <stdio.h>

#include "engine/output/matrix_market.h"
#include "parser/cli/export_vtk.h"
#include "parser/cli/named_shape.h"
#include "parser/cli/open_model.h"
#include "parser/cli/option_values.h"
#include "parser/cli/streams.h"

static const strut_option options[] = {
    {STRUT_OPTION_MATRICES, "matrices", "DIR", "write the matrices into DIR"},
    {STRUT_OPTION_FORMAT, "format", "FORMAT", "vtk: the motion of a run, or a shape, for ParaView"},
    {STRUT_OPTION_OUTPUT, "output", "DIR", "write the files of --format into DIR"},
    {STRUT_OPTION_AT, "at", "NAME", "the shape: drawn (if not given), start, or an equilibrium"},
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "give a parameter another value; may be repeated"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_status write_matrices(const strut_arguments *arguments, const char *directory,
                                   const strut_model *model, const strut_experiment *experiment,
                                   strut_error *error) {
  strut_arena arena = {0};
  strut_named_shape shape;
  strut_status status = strut_named_shape_find(arguments, model, experiment, &arena, &shape, error);
  if (status == STRUT_OK)
    status = strut_matrices_write(directory, model, shape.q, shape.name, error);
  strut_arena_free(&arena);
  return status;
}

static strut_status export_format(const strut_arguments *arguments, const char *matrices) {
  static const char *const formats[] = {"vtk", NULL};
  int format = 0;
  strut_status status =
      strut_option_word(&strut_command_export, arguments, STRUT_OPTION_FORMAT, formats, &format);
  if (status != STRUT_OK) return status;
  if (arguments->output && *arguments->output && !matrices)
    return strut_export_vtk(&strut_command_export, arguments);
  fprintf(stderr, "strut export: %s\n",
          matrices ? "--matrices and --format are two commands" : "where to? give -o DIR");
  return STRUT_USAGE;
}

static strut_status run(const strut_arguments *arguments) {
  const char *directory = strut_option_text(arguments, STRUT_OPTION_MATRICES);
  strut_setup setup;
  strut_model *model = NULL;
  strut_error error = {0};
  if (strut_option_text(arguments, STRUT_OPTION_FORMAT)) return export_format(arguments, directory);
  if (!directory || !*directory || arguments->output) {
    fprintf(stderr, "strut export: %s\n",
            arguments->output ? "-o DIR wants a format: give --format vtk too"
                              : "where to? give --matrices DIR, or --format vtk -o DIR");
    return STRUT_USAGE;
  }
  strut_status status = strut_open_model(arguments, STRUT_OPEN_FOR_ANY, &setup);
  if (status != STRUT_OK) return status;
  status = strut_model_compile(&setup.scene, &model, &error);
  if (status == STRUT_OK)
    status = write_matrices(arguments, directory, model, &setup.experiment, &error);
  if (status != STRUT_OK) strut_print_error(&error);
  strut_model_free(model);
  strut_setup_free(&setup);
  return status;
}

const strut_command strut_command_export = {
    .name = "export",
    .model = "RUN|MODEL",
    .summary = "writes a model's matrices, or a run's motion for ParaView",
    .details =
        "\nWith --matrices, for MATLAB, Octave or Python: Matrix Market files:\n"
        "connectivity, equilibrium, mass, stiffness_elastic,\n"
        "stiffness_geometric, damping and, where nodes touch the ground, stiffness_contact;\n"
        "node_names.csv, rows.csv (free coordinates) and columns.csv (members) name their rows\n"
        "and columns. The tangent stiffness is the sum of the three.\n"
        "With --format vtk, for ParaView: structure.pvd, a .vtp file for every frame of RUN (a\n"
        "directory that 'strut run -o' made) or one for the shape of MODEL, and ground.vtp.\n"
        "All files or none.\n",
    .options = options,
    .run = run,
};
