/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * From pixels to a video file, by the program ffmpeg.
 */
#ifndef STRUT_ENGINE_OUTPUT_FILM_ENCODER_H
#define STRUT_ENGINE_OUTPUT_FILM_ENCODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/types.h>

#include "engine/output/file.h"

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

#endif
