/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A study that follows periodic motions over a parameter, at every point of its axes. */
#ifndef STRUT_ENGINE_SCENE_STUDY_FOLLOW_H
#define STRUT_ENGINE_SCENE_STUDY_FOLLOW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct strut_study_follow {
  const char *over, *unit; /* the parameter; unit "": none */
  double from, to;         /* its range [SI], from < to */
  size_t at_count;         /* 0: the model's own value, or the middle */
  const double *at;        /* (at_count) values at which runs start branches [SI] */
  size_t start_count;      /* 0: as the model says */
  const char **start_from; /* (start_count) configurations */
  double accuracy;         /* relative; 0: the default */
  const char *integrator;  /* NULL: the default */
  int32_t steps;           /* 0: the default */
  bool basins;
} strut_study_follow;

/** Most values and configurations to start from. */
enum { STRUT_STUDY_FOLLOW_MOST_AT = 8, STRUT_STUDY_FOLLOW_MOST_FROM = 8 };

#endif
