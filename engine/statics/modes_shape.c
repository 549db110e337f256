/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the modes are counted: an equilibrium by name, or the drawn shape as it is. */
#include "engine/statics/modes_parts.h"

strut_status strut_modes_shape(const strut_model *model, const char *name, strut_arena *arena,
                               strut_stand *stand, strut_error *error) {
  return strut_stand_find(model, name, arena, stand, error);
}
