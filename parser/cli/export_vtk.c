/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/export_vtk.h"

#include <math.h>
#include <stdio.h>

#include "engine/output/vtk.h"
#include "parser/cli/named_shape.h"
#include "parser/cli/open_run.h"
#include "parser/cli/streams.h"

/* A motion of one frame at rest, in the arena: the shape, its lengths and its elastic forces. */
static strut_status still_of(const strut_arguments *arguments, const strut_opened *opened,
                             strut_arena *arena, strut_trajectory *motion, strut_error *error) {
  const strut_model *model = opened->model;
  strut_named_shape shape;
  strut_status status =
      strut_named_shape_find(arguments, model, &opened->setup.experiment, arena, &shape, error);
  if (status != STRUT_OK) return status;
  const strut_member_table *table = &model->members;
  size_t nodes = model->scene->node_count, members = model->scene->member_count;
  *motion = (strut_trajectory){.frames = 1, .node_count = nodes, .member_count = members};
  motion->position = strut_arena_allocate(arena, 2 * nodes, sizeof(double));
  motion->length = strut_arena_allocate(arena, members, sizeof(double));
  motion->force = strut_arena_allocate(arena, members, sizeof(double));
  if (!motion->position || !motion->length || !motion->force)
    return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  for (size_t i = 0; i < 2 * nodes; i++) motion->position[i] = shape.q[i];
  for (size_t i = 0; i < members; i++) {
    const double *from = shape.q + table->from[i], *to = shape.q + table->to[i];
    motion->length[i] = hypot(to[0] - from[0], to[1] - from[1]);
    double elastic = table->stiffness[i] * (motion->length[i] - table->rest[i]);
    motion->force[i] = elastic < table->slack[i] ? table->slack[i] : elastic;
  }
  return STRUT_OK;
}

static void say(const strut_arguments *arguments, const strut_trajectory *motion,
                const strut_vtk_written *written) {
  printf("%zu frame%s in '%s': open structure.pvd with ParaView\n", written->frames,
         written->frames == 1 ? "" : "s", arguments->output);
  size_t recorded = motion->recorded > motion->frames ? motion->recorded : motion->frames;
  if (recorded > written->frames)
    printf("of %zu recorded ones: more than %d are thinned evenly\n", recorded,
           STRUT_VTK_MOST_FRAMES);
}

static const char *const none[] = {NULL}; /* frames are checked when their number is known */

strut_status strut_export_vtk(const strut_command *command, const strut_arguments *arguments) {
  strut_opened opened = {0};
  strut_arena arena = {0};
  strut_trajectory still = {0};
  strut_error error = {0};
  strut_vtk_written written = {0};
  strut_status status = strut_check_output_writable(arguments, none);
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
    say(arguments, motion, &written);
  } else {
    strut_print_error(&error);
  }
  strut_arena_free(&arena);
  strut_opened_free(&opened);
  return status;
}
