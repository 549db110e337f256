/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Linear algebra of statics: dense and sparse matrices, linear programs, parts of a spectrum. */
#pragma once

#include <gsl/gsl_matrix.h>
#include <gsl/gsl_permutation.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/flag.h"
#include "engine/base/library.h"
#include "engine/statics/potential.h"

/* Small dense matrices: eigenvalues and factors.
 *
 * strut_eigen: Householder's reduction to a tridiagonal and QL steps with implicit shifts (Bowdler,
 * Martin, Reinsch and Wilkinson, Handbook for Automatic Computation II). Searches for equilibria
 * spend most of their time there, on matrices of some ten rows, where general libraries mostly
 * administrate.
 */

/**
 * matrix (n, n), symmetric and finite, becomes the unit eigenvectors, one per row, in no order;
 * value (n) their values; work (n). Errors are some last bits of the largest |value|. False: no
 * convergence, which finite matrices do not show.
 */
STRUT_API bool strut_eigen(double *matrix, int32_t n, double *value, double *work);

/** The same with values ascending, equal ones in their order; vector (n, n) has the unit vector of value i in row i. */
bool strut_eigen_ascending(double *matrix, int32_t n, double *value, double *vector);

/**
 * Of matrix (n, n), which it overwrites: value (n) ascending, and the unit vector of value i as row
 * i of vector (n, n), its largest entry positive. False: out of memory.
 */
bool strut_symmetric_eigen(double *matrix, size_t n, double *value, double *vector);

/** Zeros, owned by the arena; NULL: out of memory. */
gsl_matrix *strut_arena_matrix(strut_arena *arena, size_t rows, size_t columns);
gsl_vector *strut_arena_vector(strut_arena *arena, size_t size);
gsl_permutation *strut_arena_order(strut_arena *arena, size_t size);

/** Takes out of x (n) its shares in `count` orthonormal rows (count, n), twice for rounding; returns what is left, x.x. */
double strut_remove_shares(const double *rows, size_t count, size_t n, double *vector);

/** Solves A x = right, with its rows brought to one size first; both are overwritten. False: singular. */
bool strut_solve_rows(gsl_matrix *matrix, gsl_vector *right, gsl_permutation *order,
                      gsl_vector *vector);

/**
 * The shortest x with A' x = right, for A of at least as many rows as columns, which becomes its left singular
 * vectors; `right` becomes a y with x = A y. Singular values up to `cut` of the largest are none. False: out of memory.
 */
bool strut_shortest(gsl_matrix *matrix, double cut, gsl_vector *right, gsl_vector *vector);

/* What statics needs of SPQR and ARPACK: a rank-revealing A E = Q R of a sparse matrix, and the lowest eigenpairs
 * of K x = z M x by shift-invert Lanczos.
 *
 * Only sparse_algebra.c sees their headers. Q is kept as its reflections, since an explicit one would be dense.
 * ARPACK keeps its state in static variables, so that one lock lets one search run at a time. While either works,
 * the BLAS beneath them uses one thread.
 */

typedef struct strut_lanczos_problem {
  int32_t n;
  double shift; /* below all eigenvalues */
  void *context;
  void (*solve)(void *context, double *vector);                 /* x becomes (K - shift M)^-1 x */
  void (*mass)(void *context, const double *vector, double *y); /* y = M x */
  const strut_flag *interrupt; /* ends it with STRUT_INTERRUPTED; or NULL */
} strut_lanczos_problem;

/** A matrix (rows, columns) by columns: the entries of column j are row and value [start[j], start[j + 1]). */
typedef struct strut_sparse_columns {
  int32_t rows, columns;
  const int32_t *start, *row;
  const double *value;
} strut_sparse_columns;

/** Bases of what a matrix A (rows, columns) and its transpose map to zero. */
typedef struct strut_sparse_null_spaces {
  int32_t most_vectors; /* of a basis, and its numbers, that are wanted: larger ones stay NULL */
  int64_t most_numbers;
  int32_t rank;
  double smallest, largest; /* diagonal entries of R, absolute; 0 where the rank is 0 */
  double *null; /* (columns - rank, columns): of dependent columns 1 at its own, 0 at others */
  double *left; /* (rows - rank, rows) orthonormal, of the transpose */
} strut_sparse_null_spaces;

typedef struct strut_sparse_algebra_library {
  strut_library_stamp stamp;
  /**
   * By a QR of A, into the arena. Columns that keep a norm of `tolerance` or less beside those before them count as
   * dependent. STRUT_NO_MEMORY, or STRUT_SINGULAR where SPQR fails for another reason.
   */
  strut_status (*null_spaces)(const strut_sparse_columns *columns, double tolerance,
                              strut_arena *arena, strut_sparse_null_spaces *spaces,
                              strut_error *error);
  /**
   * The `count` eigenvalues next above the shift, ascending, and their vectors (count, n) with
   * x'Mx = 1. count < n. The start vector is always the same. STRUT_SINGULAR where it does not
   * converge, STRUT_NO_MEMORY.
   */
  strut_status (*lowest_eigenpairs)(const strut_lanczos_problem *problem, int32_t count,
                                    double *value, double *vector, strut_error *error);
} strut_sparse_algebra_library;

/** Fails where the libraries cannot be loaded (engine/base/library.h). */
strut_status strut_sparse_algebra_load(const strut_sparse_algebra_library **library,
                                       strut_error *error);

/* The seam around GLPK: a linear programme with bounds, solved by the simplex method.
 *
 * The same programme gives the same bits.
 */

/** Least sum of cost x with row_low <= A x <= row_high, low <= x <= high; all may be infinite. */
typedef struct strut_linear_program {
  int32_t rows, columns;
  double *row_low, *row_high; /* (rows); 0 at first */
  double *low, *high, *cost;  /* (columns); 0, INFINITY, 0 at first */
  size_t entry_count, entry_room;
  int *entry_row, *entry_column; /* (1 + entry_room) as GLPK counts all, from 1; each place once */
  double *entry;
  const strut_flag *interrupt; /* ends the solution; NULL at first */
} strut_linear_program;

typedef enum strut_linear_program_end {
  STRUT_PROGRAM_OPTIMAL,
  STRUT_PROGRAM_INFEASIBLE,
  STRUT_PROGRAM_UNBOUNDED,
  STRUT_PROGRAM_FAILED /* the simplex method gave up */
} strut_linear_program_end;

/** Room for `entries` nonzeros, all in the arena; false: out of memory. */
bool strut_linear_program_create(strut_linear_program *program, int32_t rows, int32_t columns,
                                 size_t entries, strut_arena *arena);
/** A(row, column) = value; nothing where it is 0. */
void strut_linear_program_add(strut_linear_program *program, int32_t row, int32_t column,
                              double value);
/** x (columns) and the sum, filled where optimal; STRUT_NO_MEMORY, STRUT_INTERRUPTED or STRUT_OK. */
strut_status strut_linear_program_solve(const strut_linear_program *program, double *vector,
                                        double *sum, strut_linear_program_end *end);

/* All eigenvalues and eigenvectors of a small Hessian, the soft ones to their own last digits.
 *
 * A dense solver leaves every eigenvalue with the rounding error of the largest: beside bars of
 * 1e12 N/m nothing is left of a spring of 1 N/m. The soft ones are therefore found again in the
 * space of their eigenvectors, from stretches summed member by member (Rayleigh-Ritz), which loses
 * nothing.
 */

typedef struct strut_spectrum {
  int32_t n;
  double *value;  /* (n) ascending [N/m] */
  double *vector; /* (n, n) the unit vector of value i in row i */
  double *noise;  /* (n) what rounding may have done to the value, positions' last bits included */
} strut_spectrum;

/** Memory for computations with n free coordinates; for one thread at a time. */
typedef struct strut_spectrum_workspace strut_spectrum_workspace;
/** In the arena; NULL: out of memory. */
strut_spectrum_workspace *strut_spectrum_create(const strut_potential *potential,
                                                strut_arena *arena);

/**
 * The spectrum of a Hessian by strut_potential_hessian_above(q, least), valid until the next call. `careful`:
 * noise is estimated mode by mode and soft modes are always refined; else only where the dense
 * solver's error could matter, with one noise for all. False if the Hessian is not finite.
 */
bool strut_spectrum_compute(strut_spectrum_workspace *room, const strut_sparse *hessian,
                            const double *q, double least, bool careful, strut_spectrum *spectrum);
/** Eigenvalues up to this may be all rounding, where none is larger than `largest`. */
double strut_spectrum_noise(const strut_spectrum_workspace *room, double largest);

/* Steps put together from modes. Arrays are (n). */

/** part: shares of g in the modes; idle: 1 where a mode has neither stiffness nor a share beyond `still` [N]. */
void strut_spectrum_split(const strut_spectrum *spectrum, const double *gradient, double still,
                          double *part, uint8_t *idle);
/** step = the sum of the modes times x; returns its length. */
double strut_spectrum_combine(const strut_spectrum *spectrum, const double *vector, double *step);
/**
 * Corrects a step by Newton's method, with the gradient g at its end, in modes whose eigenvalue and `value` exceed
 * `stiff`. False: there are none.
 */
bool strut_spectrum_rebalance(const strut_spectrum *spectrum, const double *value, double stiff,
                              const double *gradient, double *step);

/** The stiffness that forces give to some modes, summed force by force: stiff ones that a mode does not strain do not
    blur it. Mode i's row r is vector[i mode_step + r row_step]. */
typedef struct strut_mode_form {
  const strut_model *model;
  const int32_t *row_of; /* (length) */
  int32_t count;         /* modes */
  const double *vector;
  size_t mode_step, row_step;
  double *sum;            /* (count, count) lower triangle */
  double *noise;          /* (count) what rounding may have done to the diagonal */
  double *along, *across; /* (count) scratch */
  double part;            /* the largest part that an element has in the diagonal */
} strut_mode_form;
void strut_mode_form_add(strut_mode_form *form, const strut_force *force, const double *q);
