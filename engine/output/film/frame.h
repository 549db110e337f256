/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * One frame of a film: where the camera points, the motion interpolated to a time, and the drawing
 * with forces, ground marks and the time.
 */
#ifndef STRUT_ENGINE_OUTPUT_FILM_FRAME_H
#define STRUT_ENGINE_OUTPUT_FILM_FRAME_H

#include "engine/model/model.h"
#include "engine/output/draw/structure.h"
#include "engine/output/trajectory.h"

/** The middle of every frame of a film, and the range to show around it. */
typedef struct strut_camera {
  size_t count;
  double (*middle)[2]; /* (count) [m] */
  double half[2];      /* half of the width and height that show all nodes in every frame [m] */
  bool follows[2];     /* in x, in y */
} strut_camera;

/**
 * From the bounds of the structure in every frame (count >= 1). `reach`: how many frames before and
 * after count for where it looks. The middles are in the arena; false when memory is out.
 */
bool strut_camera_plan(strut_camera *camera, const strut_bounds *bounds, size_t count, size_t reach,
                       strut_arena *arena);

typedef struct strut_moment {
  double time;     /* [s] */
  double *q;       /* (model->length) */
  double *force;   /* (members) [N], or NULL where not recorded */
  double *contact; /* (contacts, 2) normal and friction [N], or NULL */
  size_t frame;    /* the recorded frame at or before it; times must ascend */
} strut_moment;

/** Number of drawable frames; a diverged run ends earlier. */
size_t strut_frames_to_show(const strut_model *model, const strut_trajectory *motion);
/** Allocates in an arena; false when memory is out. */
bool strut_moment_create(strut_moment *moment, const strut_model *model,
                         const strut_trajectory *motion, strut_arena *arena);
/** Interpolates the motion at a time, not before the last one; clamps to the last frame. */
void strut_moment_at(strut_moment *moment, const strut_trajectory *motion, size_t frames,
                     double time);
/** x of the measured point, a node or the centre of mass [m]. */
double strut_moment_travel(const strut_moment *moment, const strut_model *model, int32_t node);

/** Shared by the pictures of a film. */
typedef struct strut_view_frame {
  const strut_model *model;
  const strut_camera *camera;
  strut_window window; /* its scale; it moves with the camera */
  double most_force;   /* largest |force| of a member [N]; 0: colours by kind */
  double most_contact; /* largest contact force [N] */
  double step;         /* between marks of the ground [m] */
  double start_time, end_time, travelled_from; /* [s], [s], [m] */
  int32_t measured_node;                       /* that travels; -1: the centre of mass */
  double mean_velocity;                        /* [m/s] */
  double shown;                                /* time between two pictures [s] */
  bool travels;                                /* free in x: its travel is shown */
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
