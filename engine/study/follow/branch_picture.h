/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Lines over a parameter whose unstable stretches are dashed, with marked points: see follow_figure.c. */
#ifndef STRUT_ENGINE_STUDY_FOLLOW_BRANCH_PICTURE_H
#define STRUT_ENGINE_STUDY_FOLLOW_BRANCH_PICTURE_H

#include "engine/output/draw/legend.h"
#include "engine/output/draw/plot.h"
#include "engine/run/follow/follow.h"

typedef struct strut_branch_line {
  size_t count, look; /* look: number of its colour */
  double (*data)[2];  /* (count) */
  bool *stable;       /* (count) */
} strut_branch_line;

typedef struct strut_branch_mark {
  double data[2];
  strut_follow_kind kind;
  const char *node; /* or NULL */
} strut_branch_mark;

/** Texts and arrays belong to whoever made them. */
typedef struct strut_branch_picture {
  const char *title; /* unless the plot has one */
  strut_axis x, y;   /* without ranges */
  size_t line_count, mark_count, key_count;
  strut_branch_line *lines;
  strut_branch_mark *marks;
  const strut_key_item *keys; /* (key_count) below the axes */
} strut_branch_picture;

enum { STRUT_BRANCH_KEYS = 6 };
/** What a figure of branches explains: dashes, and the colours of marks. */
void strut_branch_keys(strut_key_item keys[STRUT_BRANCH_KEYS]);
/** The colour of the marks of a kind. */
strut_colour strut_branch_colour(strut_follow_kind kind);

strut_status strut_branch_draw(const strut_plot *plot, const strut_branch_picture *picture,
                               strut_error *error);

#endif
