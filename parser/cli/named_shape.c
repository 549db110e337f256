/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/named_shape.h"

#include <string.h>

static const double *drawn(const strut_model *model, strut_arena *arena) {
  double *q = strut_arena_allocate(arena, (size_t)model->length, sizeof *q);
  for (int32_t i = 0; q && i < model->node_count; i++)
    memcpy(q + 2 * i, model->scene->nodes[i].position, 2 * sizeof *q);
  return q;
}

strut_status strut_named_shape_find(const strut_arguments *arguments, const strut_model *model,
                                    strut_arena *arena, strut_named_shape *shape,
                                    strut_error *error) {
  const char *name = strut_option_text(arguments, STRUT_OPTION_AT);
  shape->name = name ? name : "drawn";
  if (strcmp(shape->name, "drawn") != 0)
    return strut_fail(error, STRUT_USAGE, "there is no shape '%s'; there is 'drawn'", shape->name);
  shape->q = drawn(model, arena);
  return shape->q ? STRUT_OK : strut_fail(error, STRUT_NO_MEMORY, "out of memory");
}
