/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The laws of cells, of an area e with the pressure e0 as drawn; see engine/scene/law.h. */
#ifndef STRUT_ENGINE_SCENE_LAWS_CELL_LAWS_H
#define STRUT_ENGINE_SCENE_LAWS_CELL_LAWS_H

#include "engine/scene/laws/isentropic.h"
#include "engine/scene/laws/isothermal.h"
#include "engine/scene/laws/pressure.h"

/** Rows as of STRUT_LAWS. No member and no hinge can have these laws. */
#define STRUT_CELL_LAWS(X, context)                                                                \
  X(PRESSURE, pressure, "pressure", 0, context)                                                    \
  X(ISOTHERMAL, isothermal, "isothermal", 0, context)                                              \
  X(ISENTROPIC, isentropic, "isentropic", 0, context)

#endif
