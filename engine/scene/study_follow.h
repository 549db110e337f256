/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A study that follows periodic motions over a parameter, at every point of its axes. */
#ifndef STRUT_ENGINE_SCENE_STUDY_FOLLOW_H
#define STRUT_ENGINE_SCENE_STUDY_FOLLOW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** What zeros stand for: of the accuracy; of the steps of a branch, and of a curve over two parameters. */
#define STRUT_FOLLOW_USUAL_PERCENT 0.1
#define STRUT_FOLLOW_USUAL_STEPS 400
#define STRUT_FOLLOW_USUAL_CURVE_STEPS 200

typedef struct strut_study_follow {
  const char *over, *unit; /* the parameter; unit "": none */
  double from, to;         /* its range [SI], from < to */
  size_t at_count;         /* 0: the model's own value, or the middle */
  const double *at;        /* (at_count) values at which runs start branches [SI] */
  size_t start_count;      /* 0: as the model says */
  const char **start_from; /* (start_count) configurations */
  double accuracy;         /* relative; 0: the usual one */
  const char *integrator;  /* NULL: chosen */
  int32_t steps;           /* 0: the usual ones */
  bool basins;
} strut_study_follow;

/** Most values and configurations to start from. */
enum { STRUT_STUDY_FOLLOW_MOST_AT = 8, STRUT_STUDY_FOLLOW_MOST_FROM = 8 };

#endif
