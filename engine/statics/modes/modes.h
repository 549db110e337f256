/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Natural frequencies and shapes of small motions about an equilibrium, contacts closed there.
 *
 * K x = z M x, z = omega^2. Up to STRUT_DENSE_MODES free coordinates by GSL's dense eigensolver,
 * above by shift-invert Lanczos (ARPACK), which is checked against the number of eigenvalues below
 * the last one that a factor's signs count. Each eigenvalue is then the quotient of its shape, with the
 * stiffness summed from strains, and has a bound of its error; above 1e-8 it counts as unknown.
 *
 * Friction and drives do not act; a closed contact is a spring both ways, its damper too.
 */
#pragma once

#include "engine/model/model.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"

enum { STRUT_DENSE_MODES = 400, STRUT_SPARSE_MODES = 10, STRUT_DAMPED_MODES = 160 };

typedef enum strut_mode_kind {
  STRUT_MODE_RIGID,     /* no stiffness: a rigid motion that supports and contacts leave */
  STRUT_MODE_MECHANISM, /* no stiffness, but not rigid */
  STRUT_MODE_ELASTIC,
  STRUT_MODE_UNSTABLE, /* eigenvalue below zero: it grows */
  STRUT_MODE_UNKNOWN   /* rounding hides its eigenvalue */
} strut_mode_kind;

/** "rigid-body", "mechanism", "elastic", "unstable", "unknown". */
STRUT_API const char *strut_mode_kind_name(strut_mode_kind kind);

/** What a member that only pulls, or only pushes, does in the shape. */
typedef enum strut_idleness {
  STRUT_ACTS,
  STRUT_SLACK,
  STRUT_JUST_TAUT /* without a force: it would act one way only, so that it counts as slack */
} strut_idleness;

typedef struct strut_mode {
  double eigenvalue;        /* omega^2 [1/s^2]; 0 where there is no stiffness; these five are NAN
                               where unknown */
  double angular_frequency; /* [rad/s]; 0 where the eigenvalue is not above zero */
  double damping_ratio;     /* [1]; NAN where there is nothing to oscillate */
  double damped_frequency;  /* [rad/s]; 0 where it creeps */
  double decay_rate;        /* of the amplitude, the slower one where it creeps [1/s] */
  double residual;          /* |K x - z M x| / (|K x| + |z M x|); without stiffness, |K x| relative
                              to the largest there can be */
  double
      error; /* of the eigenvalue, relative (without stiffness, to the largest there can be): a bound for
                   the method, an estimate for the last bits of the scene's numbers */
  strut_mode_kind kind;
  int32_t just_taut;     /* of a mechanism: members without force that would resist it one way */
  double *shape;         /* (length) largest entry 1 */
  char description[200]; /* in words */
} strut_mode;

typedef struct strut_modes {
  const char *at;      /* name of the equilibrium */
  const double *q;     /* (length) its shape [m] */
  int32_t coordinates; /* free ones */
  int32_t closed_count;
  const int32_t *closed;          /* (closed_count) nodes */
  const strut_idleness *idleness; /* (members) */
  bool dense;                     /* all modes were computed */
  bool damped_exactly; /* damping from the quadratic eigenproblem; else by the modal quotient */
  bool at_rest;        /* the shape is an equilibrium */
  strut_settle_summary settle; /* of strut_rest_state */
  const char *left_out;        /* what acts in a run, but not here; NULL: nothing */
  double condition;            /* largest eigenvalue over the smallest that is not zero */
  size_t count;
  strut_mode *list; /* by eigenvalue */
  strut_arena arena;
} strut_modes;
/** Rows of a strut_modes, and of a strut_mode in it. */
STRUT_API extern const strut_value_rows strut_modes_values, strut_mode_values;

typedef struct strut_modes_options {
  const char *at; /* as for strut_rest_state_find */
  int32_t count;  /* number of lowest modes; 0: all if dense, else STRUT_SPARSE_MODES */
  bool stuck;     /* nodes that touch are held along the ground too, as friction would */
  bool sparse;    /* by Lanczos's method whatever the size */
} strut_modes_options;

/**
 * Fails with what strut_rest_state_find fails with; STRUT_SINGULAR where a node without mass is held by
 * nothing, and where more modes have no stiffness than the sparse method can tell apart; STRUT_BAD_SCENE where nothing is free to move or nothing has mass; STRUT_NO_MEMORY.
 * strut_modes_free releases it, after a failure too. The model must outlive it.
 */
STRUT_API strut_status strut_modes_find(const strut_model *model,
                                        const strut_experiment *experiment,
                                        const strut_modes_options *options, strut_modes *modes,
                                        strut_error *error);
STRUT_API void strut_modes_free(strut_modes *modes);
