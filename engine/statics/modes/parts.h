/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Shared by the files of this folder: the eigenproblem from matrices to named modes. */
#ifndef STRUT_ENGINE_STATICS_MODES_PARTS_H
#define STRUT_ENGINE_STATICS_MODES_PARTS_H

#include "engine/statics/equilibria/rest_state.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/modes/solver.h"
#include "engine/statics/modes/vibration.h"

/** Eigenvalues ascending and vectors (n each), x'Mx = 1. */
typedef struct strut_eigen_set {
  int32_t n, count;
  double *value;    /* (count) */
  double *vector;   /* (count, n) */
  double *noise;    /* (count) stiffness that the last bits make in that motion, over x'Mx */
  double *error;    /* (count) of the method, absolute [1/s^2] */
  double *residual; /* (count) */
} strut_eigen_set;

typedef struct strut_modes_work {
  strut_vibration *v;
  strut_modes_solver solver;
  strut_eigen_set set;
  double soft; /* a shift well below the elastic eigenvalues, > 0 [1/s^2] */
  int32_t rigid_count;
  double *rigid;            /* (rigid_count, n) rigid motions left, x'Mx = 1, orthogonal */
  strut_idleness *idleness; /* (members) as in strut_modes */
  strut_arena *arena;
  const strut_experiment *experiment; /* which may be interrupted */
} strut_modes_work;

/** The shape of that name, as strut_rest_state_find. */
strut_status strut_modes_shape(const strut_model *model, const strut_experiment *experiment,
                               const char *name, strut_arena *arena, strut_rest_state *rest,
                               strut_error *error);

/** All modes of a dense problem, or the lowest ones of a sparse one, into work->set. */
strut_status strut_modes_dense(strut_modes_work *work, strut_error *error);
strut_status strut_modes_sparse(strut_modes_work *work, int32_t count, strut_error *error);

/**
 * Decides which members and elements that act one way only act in the shape, into work->idleness. One that is at the edge
 * counts as slack if it carries nothing there, or only what last bits of the scene's numbers make of it.
 */
strut_status strut_modes_loosen(strut_modes_work *work, bool at_rest, strut_error *error);

/** The shape to twice a double's precision, from one that is at rest as far as doubles tell. */
strut_status strut_modes_settle(strut_modes_work *work, strut_error *error);
/**
 * Effect of the last bits of rest lengths, or of a shape that is not at rest, on the eigenvalues.
 */
strut_status strut_modes_noise(strut_modes_work *work, bool at_rest, strut_error *error);
/** Improves the eigenpairs and estimates their errors. */
strut_status strut_modes_refine(strut_modes_work *work, strut_error *error);

/** The rigid motions that supports and closed contacts leave. */
strut_status strut_modes_rigid(strut_modes_work *work, strut_error *error);

/** Damping of the modes into the list; `exactly`: the set holds all modes. */
strut_status strut_modes_damping(const strut_modes_work *work, bool exactly, strut_mode *list,
                                 strut_error *error);

/** Describes a mode in words. */
void strut_modes_describe(const strut_modes_work *work, const double *x, strut_mode *mode);

#endif
