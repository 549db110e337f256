/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * One picture of a film: structure, forces, ground with marks, and what time it is.
 */
#ifndef STRUT_ENGINE_OUTPUT_FILM_SCENE_FRAME_H
#define STRUT_ENGINE_OUTPUT_FILM_SCENE_FRAME_H

#include "engine/output/film/camera.h"
#include "engine/output/film/moment.h"

/** What the pictures of a film share. */
typedef struct strut_view_frame {
  const strut_model *model;
  const strut_camera *camera;
  strut_window window; /* its scale; it moves with the camera */
  double most_force;   /* largest |force| of a member [N]; 0: colours tell the kinds */
  double most_contact; /* largest force of the ground [N] */
  double step;         /* between marks of the ground [m] */
  double start_time, end_time, travelled_from; /* [s], [s], [m] */
  int32_t measured_node;                       /* that travels; -1: the centre of mass */
  double mean_velocity;                        /* [m/s] */
  double shown;                                /* time between two pictures [s] */
  bool travels;                                /* nothing holds it in x: how far it went is told */
  char speed[48];                              /* "1/10 of true speed" */
} strut_view_frame;

/** Chooses scale and marks for a page; the fields from most_force on stay as they are. */
void strut_view_frame_fit(strut_view_frame *scenery, strut_box page);
/** "true speed", "1/10 of true speed", "4 times true speed". In the C locale. */
void strut_view_frame_speed(strut_view_frame *scenery, double speed);
/** Draws picture `i` of the film on a page. In the C locale. */
void strut_view_frame_draw(const strut_view_frame *scenery, strut_canvas *canvas, size_t i,
                           const strut_moment *moment);

#endif
