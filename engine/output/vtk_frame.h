/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The texts of VTK's XML files: a frame of a motion, the ground.
 */
#ifndef STRUT_ENGINE_OUTPUT_VTK_FRAME_H
#define STRUT_ENGINE_OUTPUT_VTK_FRAME_H

#include "engine/model/model.h"
#include "engine/output/buffer.h"
#include "engine/output/trajectory.h"

/** What all frames of a motion share, and room that is taken once. */
typedef struct strut_vtk_frame {
  const strut_model *model;
  const strut_trajectory *motion;
  double *points; /* (nodes, 3) */
  double *cells;  /* (members) */
  int32_t *whole; /* (max(2 members, nodes)) */
  strut_arena arena;
} strut_vtk_frame;

/** Takes the room; false when memory is out. strut_vtk_frame_free in any case. */
bool strut_vtk_frame_create(strut_vtk_frame *frame, const strut_model *model,
                            const strut_trajectory *motion);
void strut_vtk_frame_free(strut_vtk_frame *frame);
/** Appends the file of frame `i` of the motion. Numbers want the C locale. */
void strut_vtk_frame_write(strut_vtk_frame *frame, size_t i, strut_buffer *buffer);
/** Appends the file of the ground: a line from x = low to x = high [m]. */
void strut_vtk_ground_write(const strut_model *model, double low, double high,
                            strut_buffer *buffer);

#endif
