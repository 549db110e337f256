/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The mass matrix and its inverse: diagonal, small dense blocks, or a sparse factor.
 *
 * Masses act alike on x and y, so there is one matrix per coordinate and, where the supports are
 * alike too, only one. Nodes that no mass couples are divided; small connected groups keep their
 * dense inverse; the rest is one sparse L D L' by CHOLMOD. Each part costs nothing where it is empty.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/model/algebra/linear_solver.h"
#include "engine/model/model.h"

struct strut_model;

/** Groups up to this many nodes keep a dense inverse: chains of bars are faster so up to 8 nodes, and
    with the factor from 10 on (timed on 200 chains at once). */
enum { STRUT_DENSE_BLOCK = 8 };

/** Inverse of the mass matrix of one coordinate. */
typedef struct strut_mass_operator {
  const double *inverse; /* (length) 1/m where no mass couples; 0 where supported or in a block;
                            at 2 i + coordinate, the other places belong to the other one */
  int32_t block_count;
  const int32_t *block_size;   /* (block_count) */
  const uint32_t *block_at;    /* 2 * node of their rows, one block after the other */
  const double *block_inverse; /* dense inverses, row by row, one after the other */
  const strut_factor *factor;  /* of the remaining nodes, or NULL */
  const int32_t *factor_node;  /* (factor->n) node of each row, already in the factor's order */
  const strut_sparse *matrix;  /* M of the free nodes, lower triangle */
  const int32_t *matrix_node;  /* (matrix->n) node of each row of it */
} strut_mass_operator;

typedef struct strut_mass {
  strut_mass_operator coordinate[2]; /* x, y; the same arrays where supports are alike */
  bool shared;                       /* x and y are one and the same */
  bool diagonal;                     /* no blocks and no factor */
  bool any_single;                   /* some node is in neither; else `inverse` is all 0 */
  const double *inverse;             /* (length) both coordinates' inverse, joined */
  size_t matrix_nonzeros, factor_nonzeros, dense_entries;
  strut_factor *owned_factor[2];
} strut_mass;

/** Builds and factorises into the model's arena; *mass is NULL if a free node has no mass. */
strut_status strut_mass_create(struct strut_model *model, strut_mass **mass, strut_error *error);
void strut_mass_free(strut_mass *mass);

/**
 * acceleration = M^-1 force for both coordinates; all arrays are (length), work is scratch. Places
 * of supported coordinates and of padding in `acceleration` must be 0 before and stay so.
 */
void strut_mass_solve(const struct strut_model *model, const double *restrict force,
                      double *restrict acceleration, double *restrict work);

/* The sparse part of it: both coordinates at once, or the one that f and a point at. */
void strut_mass_factor_pair(const strut_mass_operator *op, const double *restrict f,
                            double *restrict acceleration, double *restrict work);
void strut_mass_factor_single(const strut_mass_operator *op, const double *restrict f,
                              double *restrict acceleration, double *restrict work);

/* Assembly of the sparse mass matrix of one coordinate, supports eliminated. */

/**
 * M of the free nodes of coordinate 0 (x) or 1 (y): point masses, and per member (m/6)[2 1; 1 2]
 * (consistent, exact for a uniform rigid rod) or m/2 at each end (lumped). *matrix (lower triangle)
 * and *node (its node per row) live in the model's arena. STRUT_OK or STRUT_NO_MEMORY.
 */
strut_status strut_mass_matrix(strut_model *model, int coordinate, strut_arena *scratch,
                               strut_sparse **matrix, int32_t **node);

/** Contributions of strut_mass_add at most. */
static inline size_t strut_mass_entries(const strut_model *model) {
  return 2 *
         ((size_t)model->node_count + 3 * (size_t)(model->members.count + model->sliding.count));
}
/**
 * Adds the masses at the rows of coordinates, row_of (length), -1: none, times a factor. Those on members are where
 * they start; moving: also those that signals move.
 */
void strut_mass_add(const strut_model *model, const int32_t *row_of, double factor, bool moving,
                    strut_triplets *sum);
