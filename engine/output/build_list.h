/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What it takes to build a structure: lengths to cut, holes to drill, and a drawing at true scale.
 *
 * members.csv has for each member its unstressed length hole to hole and, for cables, the length to cut: that
 * length and an allowance at both ends; nodes.csv has what meets at each node; drawing.svg and drawing.dxf
 * show the shape in millimetres, each member with its name and that length, beside a line of 100 mm to check
 * a print by.
 */
#ifndef STRUT_ENGINE_OUTPUT_BUILD_LIST_H
#define STRUT_ENGINE_OUTPUT_BUILD_LIST_H

#include "engine/model/model.h"

typedef struct strut_build {
  const strut_model *model;
  const double *q;  /* (length) the shape that is drawn */
  const char *at;   /* its name */
  double allowance; /* of a cable at each end [m], >= 0 */
} strut_build;

/** One line of the list. */
typedef struct strut_build_member {
  double length; /* hole to hole in the shape, over guides [m] */
  double made;   /* without force [m] */
  double cut;    /* of a cable, with the allowance [m]; otherwise NAN */
  double force;  /* in the shape, tension positive [N]; NAN: of a rigid bar */
  bool driven;   /* an actuator changes the length */
} strut_build_member;

STRUT_API strut_build_member strut_build_member_of(const strut_build *build, size_t member);
/** Ends of members at a node, and cables that run over it. */
STRUT_API size_t strut_build_holes(const strut_scene *scene, size_t node);

/**
 * Writes all files, or none. STRUT_BAD_SCENE where a member has no length that could be made.
 */
STRUT_API strut_status strut_build_write(const char *directory, const strut_build *build,
                                         strut_error *error);
/** The list as a table for people, in a block of strut_allocate; NULL: memory is out. */
STRUT_API char *strut_build_table(const strut_build *build);

/** The drawings as texts, in blocks of strut_allocate; NULL: memory is out. */
STRUT_API char *strut_build_svg(const strut_build *build);
STRUT_API char *strut_build_dxf(const strut_build *build);

#endif
