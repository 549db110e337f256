/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * One frame of a film: where the camera points, the motion interpolated to a time, and the drawing
 * with forces, ground marks and the time.
 */
#ifndef STRUT_ENGINE_OUTPUT_FILM_FILM_H
#define STRUT_ENGINE_OUTPUT_FILM_FILM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/types.h>

#include "engine/base/flag.h"
#include "engine/model/model.h"
#include "engine/output/draw/structure.h"
#include "engine/output/file.h"
#include "engine/output/trajectory.h"
#include "engine/scene/experiment.h"

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

/* From pixels to a video file, by the program ffmpeg. */

typedef enum strut_film_format {
  STRUT_FILM_MP4,  /* H.264 */
  STRUT_FILM_WEBM, /* VP9 */
  STRUT_FILM_GIF   /* 256 colours, looping */
} strut_film_format;

/** The format by a file name's ending; STRUT_USAGE with the possible endings. */
strut_status strut_encoder_format(const char *path, strut_film_format *format, strut_error *error);
/** STRUT_FILE_TROUBLE with advice where ffmpeg is not on the PATH. */
strut_status strut_encoder_find(strut_error *error);

/** A video being written beside its final name. Zero-initialise. */
typedef struct strut_encoder {
  strut_file file;
  pid_t process;  /* of ffmpeg; 0: not running */
  int pipe;       /* for pixels; -1: closed */
  FILE *messages; /* standard error of ffmpeg */
} strut_encoder;

/** Starts ffmpeg for a number of frames of an even size at `fps` frames per second. */
strut_status strut_encoder_begin(strut_encoder *encoder, const char *path, int width, int height,
                                 double fps, size_t frames, strut_error *error);
/** Writes one frame: (height, stride) bytes of blue, green, red, unused. */
strut_status strut_encoder_frame(strut_encoder *encoder, const unsigned char *pixels, int width,
                                 int height, size_t stride, strut_error *error);
/** Waits for ffmpeg and lets the file appear. On failure nothing is left. */
strut_status strut_encoder_end(strut_encoder *encoder, strut_error *error);
/** Stops ffmpeg and removes the partial file; does nothing after strut_encoder_end. */
void strut_encoder_abandon(strut_encoder *encoder);

/* Films of a recorded motion: the structure true to scale, its forces in colour, the ground
 * passing.
 */

/** Channels that a film needs from strut_trajectory_sink. */
#define STRUT_FILM_CHANNELS                                                                        \
  ((unsigned)STRUT_CHANNEL_POSITION | STRUT_CHANNEL_FORCE | STRUT_CHANNEL_CONTACT)

/** Longest film [s], and the default frames per second of a format. */
enum { STRUT_FILM_LONGEST = 1800 };
#define STRUT_FILM_FPS 30
#define STRUT_FILM_GIF_FPS 25

typedef struct strut_film {
  const strut_experiment *experiment; /* of the run: whose travel is shown */
  const char *path; /* .mp4, .webm (1280 x 720 pixels) or .gif (640 x 360); NULL: no film */
  double speed;     /* 1: real time, 0.1: ten times slower */
  double fps;       /* frames per second; 0: default of the format */
  const strut_flag *interrupt; /* stops soon after it becomes non-zero; may be NULL */
  void (*progress)(void *context, double fraction); /* may be NULL */
  void *progress_context;
} strut_film;

/** Properties of a finished film. */
typedef struct strut_film_made {
  size_t frames;
  int width, height; /* pixels */
  double fps;
  double lasts; /* the film [s] */
  double every; /* mean time between frames of the motion [s]; 0 for a single one */
  double shown; /* time of the motion between frames of the film [s] */
} strut_film_made;

/**
 * Before anything is computed: whether such a film can be written there. STRUT_USAGE for an ending
 * that is none, STRUT_FILE_TROUBLE for a place that cannot be written to, or without ffmpeg.
 */
STRUT_API strut_status strut_film_check(const char *path, strut_error *error);
/** Checks the length of a film of a motion of this duration [s]; STRUT_USAGE. */
STRUT_API strut_status strut_film_check_length(const strut_film *film, double motion,
                                               strut_error *error);
/**
 * Makes the film; positions between two recorded frames are on the straight line between them. The
 * file appears whole or not at all. STRUT_USAGE for a film longer than STRUT_FILM_LONGEST, or
 * STRUT_FILE_TROUBLE with what ffmpeg says, STRUT_INTERRUPTED, STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_film_make(const strut_film *film, const strut_model *model,
                                       const strut_trajectory *motion, strut_film_made *made,
                                       strut_error *error);

#endif
