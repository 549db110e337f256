/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * One frame of a film: where the camera points, the motion interpolated to a time, and the drawing with
 * forces, ground marks and the time.
 */
#ifndef STRUT_ENGINE_OUTPUT_FILM_FRAME_H
#define STRUT_ENGINE_OUTPUT_FILM_FRAME_H

#include "engine/model/model.h"
#include "engine/output/draw/structure.h"
#include "engine/output/trajectory.h"

/** The middle of every frame of a film, and what must be seen around it. */
typedef struct strut_camera {
  size_t count;
  double (*middle)[2]; /* (count) [m] */
  double half[2];      /* half of the width and height that show all nodes in every frame [m] */
  bool follows[2];     /* in x, in y */
} strut_camera;

/**
 * From the bounds of the structure in every frame (count >= 1). `reach`: how many frames before and
 * after count for where it looks. The middles are in the arena; false when there is no memory.
 */
bool strut_camera_plan(strut_camera *camera, const strut_bounds *bounds, size_t count, size_t reach,
                       strut_arena *arena);

typedef struct strut_moment {
  double time;     /* [s] */
  double *q;       /* (model->length) */
  double *force;   /* (members) [N], or NULL where not recorded */
  double *contact; /* (contacts, 2) normal and friction [N], or NULL */
  size_t frame;    /* the recorded one at or before it: times are asked for in ascending order */
} strut_moment;

/** Frames that show the structure: those of a run that diverged end before it flies apart. */
size_t strut_frames_to_show(const strut_model *model, const strut_trajectory *motion);
/** Takes the room from an arena; false when there is none. */
bool strut_moment_create(strut_moment *moment, const strut_model *model,
                         const strut_trajectory *motion, strut_arena *arena);
/** Fills it for a time not before the last one asked for; beyond the last frame it is that one. */
void strut_moment_at(strut_moment *moment, const strut_trajectory *motion, size_t frames,
                     double time);
/** Where the point is whose velocity is measured, a node or the centre of mass: its x [m]. */
double strut_moment_travel(const strut_moment *moment, const strut_model *model);

/** What the pictures of a film share. */
typedef struct strut_view_frame {
  const strut_model *model;
  const strut_camera *camera;
  strut_window window; /* its scale; it moves with the camera */
  double most_force;   /* largest |force| of a member [N]; 0: colours tell the kinds */
  double most_contact; /* largest force of the ground [N] */
  double step;         /* between marks of the ground [m] */
  double start_time, end_time, travelled_from; /* [s], [s], [m] */
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
