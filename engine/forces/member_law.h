/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Texts of laws for four things side by side, the vectors of model/hot.h: members, angles of hinges, and
    coordinates in a step. */
#ifndef STRUT_ENGINE_FORCES_MEMBER_LAW_H
#define STRUT_ENGINE_FORCES_MEMBER_LAW_H

#include "engine/base/vec.h"
#include "engine/model/hot.h"

#define LAW(name) four_##name
#define LAW_INLINE STRUT_INLINE
#include "engine/forces/strains/direction.h"
#include "engine/scene/laws/member.h"
#include "engine/scene/laws/runge_kutta.h"
#undef LAW
#undef LAW_INLINE

#endif
