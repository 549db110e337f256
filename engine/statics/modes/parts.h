/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What modes are made of: the matrices of small vibrations, solvers, and the parts of the search. */
#pragma once

#include "engine/base/flag.h"
#include "engine/model/algebra/linear_solver.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/potential.h"

/*
 * Small motions about a shape: M x'' + D x' + K x = 0 on the free coordinates. Drives are at rest,
 * friction does not act.
 */

typedef struct strut_vibration {
  const strut_model *model;
  strut_potential *shape; /* coordinates, and the pattern of all matrices here */
  int32_t n;
  double *q,
      *low; /* (length) positions, and how far from there to equilibrium: less than the last bits of q
                      change forces of stiff members. To first order [m] */
  int8_t *state;     /* (members, then elements) 1: acts, if a member, -1: does not,
                                     whatever its strain; 0: by the strain */
  uint8_t *closed;   /* (contacts) 1 where the ground pushes, there with stiffness */
  double *k, *m, *d; /* K [N/m], M [kg], D [N s/m] in the pattern's places */
  double *mass;      /* (n) row sums of M: 0 where nothing has mass */
  int32_t massive;   /* rows with mass */
  double largest;    /* an upper bound of the eigenvalues of K x = z M x [1/s^2] */
  double *work;      /* (n) */
  double *own_mass;  /* (n) diagonal of M without sliding masses */
} strut_vibration;

/**
 * In `arena`, at positions q (length); closed: nodes that touch the ground; held: (length) as for
 * strut_potential_create. The model must outlive it. STRUT_OK or STRUT_NO_MEMORY.
 */
strut_status strut_vibration_create(const strut_model *model, const double *q,
                                    const int32_t *closed, int32_t closed_count,
                                    const uint8_t *held, strut_arena *arena,
                                    strut_vibration **vibration, strut_error *error);

/** The force of that number in the shape (strut_force_begin), with `low` to first order; false: it does not act. */
bool strut_vibration_force_at(const strut_vibration *vibration, int32_t number, strut_force *force);

/** Computes K anew after a change of q or low. */
void strut_vibration_update(strut_vibration *vibration);

/** force (n): net force of members, ground, gravity and constant loads on free coordinates [N]. */
void strut_vibration_force(const strut_vibration *vibration, double *force);

/** y = A x for K, M or D. */
void strut_vibration_multiply(const strut_vibration *vibration, const double *matrix,
                              const double *vector, double *y);

/**
 * Does a member or an element that acts one way only sit at the edge of that, to the last bits of its length
 * or strain? Whether it acts is then rounding, unless loads decide it.
 */
bool strut_vibration_is_borderline(const strut_vibration *vibration, int32_t number);

/** How the strain of a force changes in the motion x (n). */
double strut_vibration_strain(const strut_vibration *vibration, const strut_force *force,
                              const double *vector);

/** x' B x of a member or an element, B the second derivative of its strain, and the sum of its terms' sizes. */
typedef struct strut_strain_bow {
  double sum, size;
} strut_strain_bow;
strut_strain_bow strut_vibration_bow(const strut_vibration *vibration, const strut_force *force,
                                     const double *vector);

/**
 * x' K x from strains, and a bound of its rounding. Stiff members that a motion hardly strains add
 * next to nothing to either, unlike in K, where they hide softer ones.
 */
typedef struct strut_vibration_energy {
  double value, rounding;
} strut_vibration_energy;
strut_vibration_energy strut_vibration_energy_of(const strut_vibration *vibration,
                                                 const double *vector);

/*
 * (K + shift M) x = b by a factor L D L'. Its signs count the eigenvalues below -shift, if the shift
 * is larger than the rounding of K: that of the largest eigenvalue.
 */
typedef struct strut_modes_solver {
  const strut_vibration *v;
  strut_ldl *ldl;
  strut_sparse sum; /* K + shift M, in the pattern's places */
  strut_inertia inertia;
  strut_arena arena;
  const strut_flag *interrupt; /* once set, nothing more is factorised or solved; or NULL */
} strut_modes_solver;

/** v must outlive it. STRUT_OK or STRUT_NO_MEMORY; strut_modes_solver_free either way. */
strut_status strut_modes_solver_create(const strut_vibration *vibration, strut_modes_solver *solver,
                                       strut_error *error);
void strut_modes_solver_free(strut_modes_solver *solver);

void strut_modes_factorise(strut_modes_solver *solver, double shift);
/** x (n) becomes (K + shift M)^-1 x. */
void strut_modes_solve(strut_modes_solver *solver, double *vector);

/** A shift with which solutions have some digits whatever the matrix, of the largest eigenvalue. */
static const double STRUT_FIRM = 1e-10;

/* Shared by the files of this folder: the eigenproblem from matrices to named modes. */

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
  int32_t rigid_count;
  double *rigid;            /* (rigid_count, n) rigid motions left, x'Mx = 1, orthogonal */
  strut_idleness *idleness; /* (members) as in strut_modes */
  strut_arena *arena;
  const strut_experiment *experiment; /* which may be interrupted */
} strut_modes_work;

/** All modes of a dense problem, or the lowest ones of a sparse one, into work->set. */
strut_status strut_modes_dense(strut_modes_work *work, strut_error *error);
strut_status strut_modes_sparse(strut_modes_work *work, int32_t count, strut_error *error);

/**
 * Decides which members and elements that act one way only act in the shape, into work->idleness. One that is
 * at the edge counts as slack if it carries nothing there, or only what last bits of the scene's numbers make
 * of it.
 */
strut_status strut_modes_loosen(strut_modes_work *work, bool at_rest, strut_error *error);

/** The shape at rest to more than the last bits of its positions, from one at rest to these. */
strut_status strut_modes_settle(strut_modes_work *work, strut_error *error);
/**
 * Effect of the last bits of rest lengths, or of a shape that is not at rest, on the eigenvalues.
 */
strut_status strut_modes_noise(strut_modes_work *work, bool at_rest, strut_error *error);
/** Eigenvalues from strains, and their errors. */
strut_status strut_modes_measure(strut_modes_work *work, strut_error *error);

/** Damping of the modes into the list; `exactly`: the set holds all modes. */
strut_status strut_modes_damping(const strut_modes_work *work, bool exactly, strut_mode *list,
                                 strut_error *error);
