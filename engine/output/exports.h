/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Files for other programs: Matrix Market, VTK, MuJoCo's MJCF, and lists and drawings to build by. */
#ifndef STRUT_ENGINE_OUTPUT_EXPORTS_H
#define STRUT_ENGINE_OUTPUT_EXPORTS_H

#include <stddef.h>
#include <stdio.h>

#include "engine/model/model.h"
#include "engine/output/trajectory.h"
#include "engine/scene/experiment.h"
#include "engine/statics/rigidity/rigidity.h"

/*
 * Matrices for other programs: Matrix Market files, and what their rows and columns are called.
 *
 * In it: node_names.csv, rows.csv (free coordinates), columns.csv (members); as .mtx files
 * connectivity (nodes x members, -1 and 1), equilibrium (rows x columns), and over the rows mass,
 * stiffness_elastic, stiffness_geometric, damping and, where nodes touch the ground,
 * stiffness_contact. The first line of each .mtx after the banner says what it is and its unit.
 */

/**
 * Writes them all, or none: those of an earlier export go when these come. q (length)
 * is the shape, `at` its name.
 */
STRUT_API strut_status strut_matrices_write(const char *directory, const strut_model *model,
                                            const double *q, const char *at, strut_error *error);

/*
 * Motions for ParaView: a VTK file per frame (.vtp, XML PolyData), and one that lists them (.pvd).
 *
 * DIR/structure.pvd names structure_00000.vtp, ... with their times and, as part 1, ground.vtp
 * where the scene has a ground. Numbers are Float64 with the same bits as everywhere else. Points are the
 * nodes with z = 0, cells the members as lines, both in the scene's order; a structure without
 * members has its nodes as cells.
 *
 *   of points: node (index), displacement from the first frame [m], and as far as recorded velocity
 *              [m/s] and contact_force of the ground on the node [N], (x, y, 0) each
 *   of cells:  kind (0 bar, 1 spring, 2 cable), length [m], strain (length over rest length, less
 *              1; the rest length without its drive), slack (1: a cable without force), and force [N],
 *              tension positive, if recorded
 *   of all:    node_names, member_names (texts), TimeValue [s]
 */

/** More frames than this are thinned evenly; the first is kept. */
enum { STRUT_VTK_MOST_FRAMES = 10000 };

/** Report of an export. */
typedef struct strut_vtk_written {
  size_t frames, every; /* every: stride in the frames of the motion */
} strut_vtk_written;

/**
 * Writes all files, or none; frames of an earlier export go when these come. `motion` has
 * positions. STRUT_FILE_TROUBLE or STRUT_NO_MEMORY with the reason.
 */
STRUT_API strut_status strut_vtk_write(const char *directory, const strut_model *model,
                                       const strut_trajectory *motion, strut_vtk_written *written,
                                       strut_error *error);

/*
 * A scene as a model of MuJoCo (MJCF), in its plane x z.
 *
 * A node is a body with a slide joint for each free coordinate, "NODE.x" and "NODE.y", 0 where the run
 * begins, and a site; a member is a spatial tendon with stiffness, damping and spring length, of a cable
 * from 0 to its rest length. Rest lengths that are driven, loads and forces of actuators are motors, whose
 * controls are the signals; those of constant loads are in the key frame "start".
 */

enum { STRUT_MJCF_MOST_NOTES = 8 };

/** Zero-initialise; strut_mjcf_free releases it. */
typedef struct strut_mjcf {
  char *text; /* the file; a block of strut_allocate */
  size_t note_count;
  const char *notes[STRUT_MJCF_MOST_NOTES]; /* what the file does not say */
} strut_mjcf;

/**
 * STRUT_BAD_SCENE, with all reasons in one sentence, where the scene has what MJCF has no word for;
 * STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_mjcf_make(const strut_model *model, const strut_experiment *experiment,
                                       strut_mjcf *mjcf, strut_error *error);
STRUT_API void strut_mjcf_free(strut_mjcf *mjcf);

/*
 * What it takes to build a structure: lengths to cut, holes to drill, and a drawing at true scale.
 *
 * members.csv has for each member its unstressed length hole to hole and, for cables, the length to cut: that
 * length and an allowance at both ends; nodes.csv has what meets at each node; drawing.svg and drawing.dxf
 * show the shape in millimetres, each member with its name and that length, beside a line of 100 mm to check
 * a print by.
 */

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

/* ---- what of a scene a foreign format cannot express, as a list in one sentence ---- */

typedef struct strut_unsupported {
  char text[600]; /* empty: nothing is refused */
  size_t used;
} strut_unsupported;

/** Adds `what` to the list where there are any of it. */
static inline void strut_unsupported_add(strut_unsupported *r, size_t count, const char *what) {
  if (!count || r->used >= sizeof r->text - 1) return;
  int n = snprintf(r->text + r->used, sizeof r->text - r->used, "%s%s", r->used ? ", " : "", what);
  r->used += n > 0 ? (size_t)n : 0;
}

#endif
