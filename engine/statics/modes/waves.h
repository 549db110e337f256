/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Waves in a structure that repeats without end over one or two steps (a lattice).
 *
 * By Bloch's theorem a wave moves every cell as the one before, a phase later: nodes that lie whole
 * steps apart move alike but for that phase, and K(phase) x = omega^2 M(phase) x of one cell is all
 * there is to solve (Hussein, Leamy, Ruzzene, Appl. Mech. Rev. 66, 040802, 2014). K is that of the
 * cell's equilibrium among its neighbours, prestress and constant loads included. Damping, friction,
 * drives and the ground do not act.
 *
 * A phase is in turns: 1/2 is opposite motion of neighbouring cells. Frequencies are in Hz, below
 * zero where the wave grows without swinging, at the rate of 2 pi times their size.
 */
#pragma once

#include "engine/model/model.h"
#include "engine/scene/experiment.h"
#include "engine/scene/value_rows.h"

enum { STRUT_MOST_BANDS = 120, STRUT_MOST_CORNERS = 6 };

/** A corner of the line through the zone of phases: the sample there and its name. */
typedef struct strut_wave_corner {
  const char *name; /* "0" and "1/2" over one step; over two, as usual, of the letters G, X, M, Y */
  size_t sample;
} strut_wave_corner;

/** A frequency [Hz] and where it occurs [turns]. */
typedef struct strut_wave_edge {
  double frequency, phase[2];
} strut_wave_edge;

/** All frequencies of the same rank. */
typedef struct strut_wave_band {
  strut_wave_edge low, high;
} strut_wave_band;

/** Frequencies that no wave has: above the highest of `below` bands, under the lowest of the next. */
typedef struct strut_wave_gap {
  int32_t below; /* 0: below all bands */
  double low, high;
} strut_wave_gap;

typedef struct strut_waves {
  const char *at;     /* "drawn", or the configuration from which the equilibrium was found */
  const double *q;    /* (length) the equilibrium [m] */
  double moved;       /* of a node, at most, from the shape it was found from [m] */
  double residual;    /* largest net force on a node of the repeated structure [N] */
  int32_t steps;      /* of the lattice: 1 or 2 */
  int32_t images;     /* nodes of the scene that are those of neighbouring cells */
  int32_t band_count; /* coordinates of a cell */
  int32_t shown;      /* bands that were asked for, the lowest */
  size_t count;       /* samples along the zone's line */
  double (*phase)[2]; /* (count, 2) [turns] */
  double *along;      /* (count) place on the line; its corners are at 0, 1, 2, ... */
  double *frequency;  /* (count, band_count) ascending [Hz] */
  int32_t corner_count;
  strut_wave_corner corner[STRUT_MOST_CORNERS];
  size_t inside;         /* samples of the zone beside the line, for bands and gaps */
  strut_wave_band *band; /* (band_count) from all samples; edges of gaps are located besides */
  size_t gap_count;
  strut_wave_gap *gaps; /* by frequency */
  int32_t acoustic;     /* bands that start at zero, at most two are measured */
  double speed[2][2];   /* (steps, acoustic) of their long waves along each step [m/s] */
  strut_arena arena;
} strut_waves;
/** Rows of a strut_waves, and of a sample in it. */
STRUT_API extern const strut_value_rows strut_waves_values, strut_wave_values;

typedef struct strut_waves_options {
  const char *at; /* NULL or "drawn", or a configuration that has positions */
  int32_t count;  /* bands to show; 0: all */
} strut_waves_options;

/**
 * STRUT_USAGE for an unknown `at`; STRUT_BAD_SCENE without a lattice, where no node lies a step from
 * another, where it is not clear which, or with more than STRUT_MOST_BANDS coordinates;
 * STRUT_NOT_SETTLED where there is no equilibrium; STRUT_SINGULAR where a node has no mass;
 * STRUT_INTERRUPTED, STRUT_NO_MEMORY. strut_waves_free releases it, after a failure too. The model
 * must outlive it.
 */
STRUT_API strut_status strut_waves_find(const strut_model *model,
                                        const strut_experiment *experiment,
                                        const strut_waves_options *options, strut_waves *waves,
                                        strut_error *error);
STRUT_API void strut_waves_free(strut_waves *waves);
