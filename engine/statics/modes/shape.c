/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the modes are counted. */
#include <string.h>

#include "engine/statics/modes/parts.h"

/*
 * A structure that nothing holds comes to rest nowhere, but where it is drawn in balance its modes
 * are as good as any: some of them are the free motions.
 */
strut_status strut_modes_shape(const strut_model *model, const strut_experiment *experiment,
                               const char *name, strut_arena *arena, strut_rest_state *stand,
                               strut_error *error) {
  strut_status status = strut_rest_state_find(model, experiment, name, arena, stand, error);
  if (status != STRUT_NOT_SETTLED || (name && strcmp(name, "start") != 0)) return status;
  strut_rest_state drawn = {0};
  strut_error ignored = {0};
  if (strut_rest_state_find(model, experiment, "drawn", arena, &drawn, &ignored) != STRUT_OK ||
      !drawn.at_rest)
    return status;
  *stand = drawn;
  return STRUT_OK;
}
