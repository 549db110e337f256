/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/named_shape.h"

#include "engine/statics/equilibria/rest_state.h"

strut_status strut_named_shape_find(const strut_arguments *arguments, const strut_model *model,
                                    const strut_experiment *experiment, strut_arena *arena,
                                    strut_named_shape *shape, strut_error *error) {
  const char *name = strut_option_text(arguments, STRUT_OPTION_AT);
  strut_rest_state stand = {0};
  strut_status status =
      strut_rest_state_find(model, experiment, name ? name : "drawn", arena, &stand, error);
  if (status != STRUT_OK) return status;
  *shape = (strut_named_shape){.name = stand.name, .q = stand.q};
  return STRUT_OK;
}
