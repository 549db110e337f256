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
  STRUT_FILM_GIF   /* 256 colours of its own, played again and again */
} strut_film_format;

/** The format that a file's name asks for by its ending; STRUT_USAGE with the endings there are. */
strut_status strut_encoder_format(const char *path, strut_film_format *format, strut_error *error);
/** STRUT_FILE_TROUBLE with what to do where ffmpeg is not on the PATH. */
strut_status strut_encoder_find(strut_error *error);

/** A video being written beside its final name. Zero-initialise. */
typedef struct strut_encoder {
  strut_file file;
  pid_t process; /* of ffmpeg; 0: none runs */
  int pipe;      /* where pixels go; -1: closed */
  FILE *said;    /* what ffmpeg complains of */
} strut_encoder;

/** Starts ffmpeg for so many frames of that size, which is even, at `fps` frames per second. */
strut_status strut_encoder_begin(strut_encoder *encoder, const char *path, int width, int height,
                                 double fps, size_t frames, strut_error *error);
/** Hands one frame over: (height, stride) bytes of blue, green, red, unused. */
strut_status strut_encoder_frame(strut_encoder *encoder, const unsigned char *pixels, int width,
                                 int height, size_t stride, strut_error *error);
/** Waits for ffmpeg and lets the file appear. On failure nothing is left. */
strut_status strut_encoder_end(strut_encoder *encoder, strut_error *error);
/** Stops ffmpeg and removes what there is of the file; nothing after strut_encoder_end. */
void strut_encoder_abandon(strut_encoder *encoder);

#endif
