/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
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
#ifndef STRUT_ENGINE_OUTPUT_VTK_H
#define STRUT_ENGINE_OUTPUT_VTK_H

#include "engine/model/model.h"
#include "engine/output/trajectory.h"

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

#endif
