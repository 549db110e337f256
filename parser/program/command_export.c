/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `strut export`: formats that describe a model, and the command. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/forces/elements.h"
#include "engine/output/exports.h"
#include "engine/output/file.h"
#include "parser/command/analyses.h"
#include "parser/program/commands.h"
#include "parser/program/open_model.h"
#include "parser/program/options.h"
#include "parser/program/streams.h"

/* A model to export, with its arguments. */
typedef struct exported {
  const strut_arguments *arguments;
  strut_setup setup;
  strut_model *model;
} exported;

static strut_status export_model(const strut_arguments *arguments, strut_open_purpose purpose,
                                 strut_status (*write)(exported *, strut_error *)) {
  exported x = {.arguments = arguments};
  strut_error error = {0};
  strut_status status = strut_open_model(arguments, purpose, &x.setup);
  if (status) return status;
  status = strut_model_compile(&x.setup.scene, &x.model, &error);
  if (!status) status = write(&x, &error);
  if (status && error.message[0]) strut_print_error(&error);
  strut_model_free(x.model);
  strut_setup_free(&x.setup);
  return status;
}

static strut_status write_build(exported *x, strut_error *error) {
  strut_arena arena = {0};
  strut_named_shape shape;
  strut_build build = {.model = x->model};
  strut_status status =
      strut_option_number(&strut_command_export, x->arguments, STRUT_OPTION_ALLOWANCE,
                          STRUT_DIM_LENGTH, &build.allowance);
  if (status) return status;
  if (build.allowance < 0.0)
    return strut_fail(error, STRUT_USAGE, "--allowance expects a length of 0 or more");
  status =
      strut_named_shape_find(x->arguments, x->model, &x->setup.experiment, &arena, &shape, error);
  if (!status) {
    build.q = shape.q;
    build.at = shape.name;
    status = strut_build_write(x->arguments->output, &build, error);
  }
  if (!status && !x->arguments->quiet) status = strut_print_block(strut_build_table(&build));
  strut_arena_free(&arena);
  return status;
}

/* --format build: a list and drawings for those who build it. Messages go to stderr. */
static strut_status strut_export_build(const strut_arguments *arguments) {
  return export_model(arguments, STRUT_OPEN_FOR_ANY, write_build);
}

static strut_status write_mjcf(exported *x, strut_error *error) {
  strut_mjcf mjcf = {0};
  const char *path = x->arguments->output;
  strut_status status = strut_mjcf_make(x->model, &x->setup.experiment, &mjcf, error);
  if (!status) status = strut_file_write_path(path, mjcf.text, error);
  for (size_t i = 0; i < mjcf.note_count && !status; i++)
    fprintf(stderr, "strut: not said in '%s': %s\n", path, mjcf.notes[i]);
  strut_mjcf_free(&mjcf);
  return status;
}

/* --format mjcf: the model file of MuJoCo; what it does not say is listed on stderr. */
static strut_status strut_export_mjcf(const strut_arguments *arguments) {
  if (strut_option_text(arguments, STRUT_OPTION_AT))
    return strut_print_usage_error(&strut_command_export,
                                   "--at is not for mjcf, which begins where a run does");
  return export_model(arguments, STRUT_OPEN_AS_RUN, write_mjcf);
}

/* ---- a motion or a shape for ParaView ---- */

/* A motion of one frame at rest, in the arena: the shape, its lengths and its elastic forces. */
static strut_status still_of(const strut_arguments *arguments, const strut_opened *opened,
                             strut_arena *arena, strut_trajectory *motion, strut_error *error) {
  const strut_model *model = opened->model;
  strut_named_shape shape;
  strut_status status =
      strut_named_shape_find(arguments, model, &opened->setup.experiment, arena, &shape, error);
  if (status != STRUT_OK) return status;
  size_t nodes = model->scene->node_count, members = model->scene->member_count;
  *motion = (strut_trajectory){.frames = 1, .node_count = nodes, .member_count = members};
  motion->position = strut_arena_allocate(arena, 2 * nodes, sizeof(double));
  motion->length = strut_arena_allocate(arena, members, sizeof(double));
  motion->force = strut_arena_allocate(arena, members, sizeof(double));
  if (!motion->position || !motion->length || !motion->force) return strut_no_memory(error, "");
  for (size_t i = 0; i < 2 * nodes; i++) motion->position[i] = shape.q[i];
  for (size_t i = 0; i < members; i++) {
    motion->length[i] = strut_member_path_length(model, (int32_t)i, shape.q);
    motion->force[i] =
        strut_member_elastic_tension(model, model->members.rest, (int32_t)i, shape.q);
  }
  return STRUT_OK;
}

static void print_written(const strut_arguments *arguments, const strut_trajectory *motion,
                          const strut_vtk_written *written) {
  printf("%zu frame%s in '%s': open structure.pvd with ParaView\n", written->frames,
         written->frames == 1 ? "" : "s", arguments->output);
  size_t recorded = motion->recorded > motion->frames ? motion->recorded : motion->frames;
  if (recorded > written->frames)
    printf("evenly chosen from %zu recorded: at most %d are written\n", recorded,
           STRUT_VTK_MOST_FRAMES);
}

static const char *const no_names[] = {NULL}; /* frames are checked once their number is known */

static strut_status export_vtk(const strut_command *command, const strut_arguments *arguments) {
  strut_opened opened = {0};
  strut_arena arena = {0};
  strut_trajectory still = {0};
  strut_error error = {0};
  strut_vtk_written written = {0};
  strut_status status = strut_check_output_writable(arguments, no_names);
  if (status == STRUT_OK)
    status = strut_open_run(command, arguments, STRUT_OPEN_FOR_ANY, STRUT_TRAJECTORY_ROOM, &opened);
  if (status != STRUT_OK) return status;
  if (opened.run && strut_option_text(arguments, STRUT_OPTION_AT)) {
    status = strut_fail(&error, STRUT_USAGE, "--at is for models: a run has its own shapes");
  } else if (!opened.run) {
    status = still_of(arguments, &opened, &arena, &still, &error);
  }
  const strut_trajectory *motion = opened.run ? &opened.motion : &still;
  if (status == STRUT_OK)
    status = strut_vtk_write(arguments->output, opened.model, motion, &written, &error);
  if (status == STRUT_OK) {
    if (!arguments->quiet) print_written(arguments, motion, &written);
  } else {
    strut_print_error(&error);
  }
  strut_arena_free(&arena);
  strut_opened_free(&opened);
  return status;
}

static strut_status export_matrices(const strut_arguments *arguments) {
  strut_setup setup;
  strut_model *model = NULL;
  strut_arena arena = {0};
  strut_named_shape shape;
  strut_error error = {0};
  strut_status status = strut_open_model(arguments, STRUT_OPEN_FOR_ANY, &setup);
  if (status != STRUT_OK) return status;
  status = strut_model_compile(&setup.scene, &model, &error);
  if (status == STRUT_OK)
    status = strut_named_shape_find(arguments, model, &setup.experiment, &arena, &shape, &error);
  if (status == STRUT_OK)
    status = strut_matrices_write(arguments->output, model, shape.q, shape.name, &error);
  if (status != STRUT_OK && error.message[0]) strut_print_error(&error);
  strut_arena_free(&arena);
  strut_model_free(model);
  strut_setup_free(&setup);
  return status;
}

/* The formats, in the order of their words. */
typedef enum export_format { SCENE, MATRICES, VTK, BUILD, MJCF } export_format;
static const char *const formats[] = {"scene", "matrices", "vtk", "build", "mjcf", NULL};

/* Options of one format only. */
static strut_status check_options(const strut_arguments *arguments, export_format format) {
  const strut_command *command = &strut_command_export;
  static const struct {
    strut_option_id id;
    export_format format;
    const char *name;
  } rows[] = {{STRUT_OPTION_ALLOWANCE, BUILD, "allowance"},
              {STRUT_OPTION_INPUT, SCENE, "input"},
              {STRUT_OPTION_UNIT, SCENE, "unit"}};
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
    if (rows[i].format != format && strut_option_text(arguments, rows[i].id))
      return strut_print_usage_error(command, "--%s is for --format %s", rows[i].name,
                                     formats[rows[i].format]);
  if (format != SCENE && arguments->parts)
    return strut_print_usage_error(command, "--parts is for --format scene");
  if (format == SCENE && strut_option_text(arguments, STRUT_OPTION_AT))
    return strut_print_usage_error(command, "--at is not for scenes, which start where a run does");
  if (format == SCENE) return STRUT_OK;
  if (arguments->model_count > 1)
    return strut_print_usage_error(command, "unexpected argument '%s'", arguments->models[1]);
  if (!arguments->output || !*arguments->output)
    return strut_print_usage_error(command, "missing -o %s", format == MJCF ? "FILE.xml" : "DIR");
  return STRUT_OK;
}

static strut_status run_export(const strut_arguments *arguments) {
  const strut_command *command = &strut_command_export;
  int word = SCENE;
  strut_status status = strut_option_word(command, arguments, STRUT_OPTION_FORMAT, formats, &word);
  if (status == STRUT_OK) status = check_options(arguments, (export_format)word);
  if (status != STRUT_OK) return status;
  switch ((export_format)word) {
    case SCENE: return strut_export_scene(arguments);
    case MATRICES: return export_matrices(arguments);
    case VTK: return export_vtk(command, arguments);
    case BUILD: return strut_export_build(arguments);
    case MJCF: return strut_export_mjcf(arguments);
  }
  return STRUT_OK;
}

static const strut_option options[] = {
    {STRUT_OPTION_FORMAT, "format", "FORMAT",
     "scene (default), matrices, vtk, build or mjcf; see above"},
    {STRUT_OPTION_OUTPUT, "output", "PATH",
     "directory to write into; a file for mjcf and scene (default: print the scene)"},
    STRUT_SET_OPTION,
    {STRUT_OPTION_AT, "at", "NAME",
     "shape for matrices, vtk and build: drawn (default), start, or an equilibrium"},
    {STRUT_OPTION_PARTS, "parts", NULL, "scene: keep parameters, groups and parts"},
    {STRUT_OPTION_INPUT, "input", "FORMAT",
     "scene: MODEL is a file of ntrt, tensegritysim, springable or tables (default: recognised)"},
    {STRUT_OPTION_UNIT, "unit", "LENGTH",
     "scene: unit of length of such a file (default: 1 dm of ntrt, otherwise 1 m)"},
    {STRUT_OPTION_ALLOWANCE, "allowance", "LENGTH",
     "build: what a cable needs at each end, such as 20 mm"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

const strut_command strut_command_export = {
    .name = "export",
    .model = "RUN|MODEL [FILE]...",
    .many = true,
    .summary = "writes a model or a run in another format, and reads other programs' files",
    .details =
        "\n"
        "  scene     one file without parts and parameters, every value in SI units; a run of it\n"
        "            gives bit-identical results. With --parts as short as the original, with its\n"
        "            base and parts written out. MODEL may be a file of NTRT or TensegritySim\n"
        "            (YAML), of springable (CSV), or two tables: of nodes (node,x [m],y "
        "[m],fixed,\n"
        "            mass [kg]) and members (member,kind,from,to,stiffness [N/m],rest length "
        "[m]).\n"
        "            Features that a scene cannot express are listed with their places.\n"
        "  matrices  for MATLAB, Octave or Python: connectivity, equilibrium, mass, damping,\n"
        "            stiffness_elastic, stiffness_geometric and stiffness_contact (their sum is "
        "the\n"
        "            tangent stiffness) as Matrix Market files, with the names of rows and "
        "columns\n"
        "  vtk       for ParaView: every frame of RUN, a directory of 'strut run -o', or a shape\n"
        "  build     to build it: lengths to cut, holes, and drawings (SVG, DXF) at true scale\n"
        "  mjcf      for MuJoCo; what it cannot express is refused or listed\n"
        "\nEither all files are written or none.\n",
    .options = options,
    .run = run_export,
};
