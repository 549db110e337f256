/* SPDX-License-Identifier: GPL-3.0-or-later */
/** One difference between two scenes, as texts. */
#ifndef STRUT_ENGINE_SCENE_DIFFERENCE_H
#define STRUT_ENGINE_SCENE_DIFFERENCE_H

typedef struct strut_difference {
  const char *where;    /* such as "members.m8.stiffness", values in SI units */
  const char *was, *is; /* in the first and the second scene; NULL: absent */
} strut_difference;

#endif
