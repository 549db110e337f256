/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The equilibrium matrix A of a shape: what forces on the nodes the member forces balance.
 *
 * A t = f: member forces t [N], tension positive, hold the loads f [N] on the free coordinates. Its
 * transpose gives the elongations A' d of small displacements d. A column is a member's unit vector
 * from its first node to its second, negative at the first, positive at the second, so that A knows
 * no lengths. Members between held coordinates, or without length, have a column of zeros. A running
 * cable's column is the gradient of its whole length. Behind the members stands a column for each
 * hinge: the gradient of its angle times the model's size, so that its force is moment / size [N]. Then
 * one for each cell: the gradient of its area over the size, so that its force is -pressure times size.
 */
#ifndef STRUT_ENGINE_STATICS_RIGIDITY_RIGIDITY_PARTS_H
#define STRUT_ENGINE_STATICS_RIGIDITY_RIGIDITY_PARTS_H

#include "engine/model/model.h"
#include "engine/model/sparse.h"

typedef struct strut_equilibrium_matrix {
  int32_t rows;    /* free coordinates */
  int32_t columns; /* members, then hinges, then cells */
  int32_t members;
  double size;         /* of the model, by which hinges' moments are divided [m] */
  int32_t *coordinate; /* (rows) index into coordinate arrays */
  int32_t *row_of;     /* (length) row of a coordinate, -1 where fixed */
  double *
      length; /* (columns) of the members in the shape; of hinges angle * size, of cells area / size [m] */
  double (*direction)[2]; /* (columns) unit vector from first node to second; 0, 0 without length */
  int32_t *curved; /* (columns) element of a running cable, hinge or cell; -1: a straight member */
  double *curvature; /* (columns) largest second derivative of such an element [1/m] */
  double **bend;     /* (columns) its second derivatives / curvature (2 nodes, 2 nodes), or NULL */
  int32_t *start;    /* (columns + 1) A by columns */
  int32_t *row;      /* (start[columns]) ascending within a column */
  double *value;     /* (start[columns]) */
} strut_equilibrium_matrix;

/** Columns of the equilibrium matrix of a model. */
static inline int32_t strut_equilibrium_columns(const strut_model *model) {
  return model->members.count + (int32_t)(model->scene->hinge_count + model->scene->cell_count);
}

/** Is column j a cable? */
static inline bool strut_column_is_cable(const strut_model *model, int32_t j) {
  return j < model->members.count && model->scene->members[j].kind == STRUT_CABLE;
}

/** Force density of column j [N/m]: force / length, or force times curvature; 0 without length. */
static inline double strut_column_density(const strut_equilibrium_matrix *a, int32_t j,
                                          double force) {
  if (a->curved[j] >= 0) return force * a->curvature[j];
  return a->length[j] > 0 ? force / a->length[j] : 0.0;
}

/** A of the positions q (length), in the arena. STRUT_OK or STRUT_NO_MEMORY. */
STRUT_API strut_status strut_equilibrium_matrix_build(const strut_model *model, const double *q,
                                                      strut_arena *arena,
                                                      strut_equilibrium_matrix *a);

/** y (rows) = A t for t (columns). */
STRUT_API void strut_equilibrium_multiply(const strut_equilibrium_matrix *a, const double *t,
                                          double *y);
/** e (columns) = A' d for d (rows). */
STRUT_API void strut_equilibrium_elongate(const strut_equilibrium_matrix *a, const double *d,
                                          double *e);

/** A as (rows, columns) row by row into dense, which holds zeros. */
STRUT_API void strut_equilibrium_dense(const strut_equilibrium_matrix *a, double *dense);

/* The rank of an equilibrium matrix, with the gap that decides it, and its two null spaces.
 *
 * Up to STRUT_DENSE_RIGIDITY rows and columns by singular values; above by sparse QR, the diagonal
 * of whose R then stands in for them. Values above STRUT_RANK_TOLERANCE times the largest count
 * towards the rank. Since the columns of A are unit vectors, the size of a structure or of its
 * parts changes nothing.
 */

enum { STRUT_DENSE_RIGIDITY = 300 };
#define STRUT_RANK_TOLERANCE 1e-9
#define STRUT_WEAK 1e-6

typedef struct strut_null_spaces {
  bool dense; /* by singular values, else by QR */
  int32_t rank;
  double largest;  /* singular value, or diagonal entry of R */
  double kept;     /* the smallest kept; 0 where the rank is 0 */
  double dropped;  /* the largest dropped; 0 if none was; NAN with QR */
  int32_t weak;    /* of those kept, how many are below STRUT_WEAK times the largest; 0 with QR */
  int32_t states;  /* s = columns - rank */
  int32_t motions; /* f = rows - rank */
  double *state;   /* (states, columns) a basis of A t = 0; NULL: too large, or none */
  double *motion;  /* (motions, rows) orthonormal basis of A' d = 0; NULL: too large, or none */
} strut_null_spaces;

/** In the arena. STRUT_OK, STRUT_NO_MEMORY, or STRUT_SINGULAR where the decomposition fails. */
STRUT_API strut_status strut_null_spaces_find(const strut_equilibrium_matrix *a, strut_arena *arena,
                                              strut_null_spaces *spaces, strut_error *error);

/* Both decompositions that strut_null_spaces_find chooses from. */

strut_status strut_null_spaces_dense(const strut_equilibrium_matrix *a, strut_arena *arena,
                                     strut_null_spaces *spaces, strut_error *error);
strut_status strut_null_spaces_sparse(const strut_equilibrium_matrix *a, strut_arena *arena,
                                      strut_null_spaces *spaces, strut_error *error);

/* The sparse matrices of small motions about a shape. */

typedef struct strut_linear_matrices {
  int32_t n;               /* free coordinates */
  strut_sparse *mass;      /* [kg] consistent or lumped, as the scene says */
  strut_sparse *elastic;   /* sum of c u u' over members that are not slack [N/m] */
  strut_sparse *geometric; /* sum of (t / L) (1 - u u') over the same [N/m] */
  strut_sparse *contact;   /* of the nodes below the ground's line [N/m]; NULL where none is */
  strut_sparse *damping;   /* of members and of those nodes [N s/m] */
} strut_linear_matrices;

/**
 * At positions q (length), drives at rest, in the arena. A member without length has no direction:
 * nothing of it counts, unless its rest length is zero too; then c acts alike in all directions.
 * STRUT_OK or STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_linear_matrices_build(const strut_model *model, const double *q,
                                                   strut_arena *arena,
                                                   strut_linear_matrices *matrices);

/* States of self-stress in readable form: local and scaled; and which of them cables can bear. */

/**
 * A state is scaled so that its first cable carries 1, of those with a hundredth of the largest
 * force; without cables its first spring, else its first member. Cables pull where one sign does
 * it.
 */
typedef struct strut_self_stress {
  int32_t count;     /* s */
  double *force;     /* (count, members, then hinges) [1]; NULL: none or too many to list */
  bool *cables_pull; /* (count) no cable is pressed in it */
} strut_self_stress;

/**
 * Turns the null space into states that involve few members each, in the arena. STRUT_OK or
 * STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_self_stress_sort(const strut_model *model,
                                              const strut_null_spaces *spaces, strut_arena *arena,
                                              strut_self_stress *states);

/** Requirements on a combination of states. */
typedef struct strut_stress_wish {
  bool cables;         /* all cables that any state loads must pull */
  int32_t motions;     /* it must be positive definite on this many motions; 0: no requirement */
  const double *forms; /* (count of states, motions, motions) their forms on them */
  const double *scale; /* (count of states) their largest force densities: what forms compare to */
} strut_stress_wish;

/**
 * Searches for a combination (members) that meets the requirements, by the perceptron rule, which
 * finds one if one with some margin exists; *found: it did. Scaled to a largest force of 1.
 */
STRUT_API strut_status strut_self_stress_combine(const strut_model *model,
                                                 const strut_self_stress *states,
                                                 const strut_stress_wish *wish, double *force,
                                                 bool *found);

/**
 * Finds a combination (members) that pulls all cables that any state loads, by a linear programme:
 * the least sum of cable forces with each at least 1, then scaled to a largest force of 1. *found
 * false: none exists.
 */
STRUT_API strut_status strut_self_stress_pull_cables(const strut_model *model,
                                                     const strut_self_stress *states, double *force,
                                                     bool *found);

/* Motions that stretch no member to first order: rigid-body, infinitesimal and finite ones. */

typedef enum strut_motion_kind {
  STRUT_MOTION_RIGID_BODY,    /* of the whole: what the supports leave of three */
  STRUT_MOTION_INFINITESIMAL, /* lengths change at second order: some self-stress stiffens it */
  STRUT_MOTION_FINITE,        /* lengths stay: followed, or no state of self-stress can stop it */
  STRUT_MOTION_UNDECIDED
} strut_motion_kind;

/** "rigid-body", "infinitesimal", "finite", "undecided". */
STRUT_API const char *strut_motion_kind_name(strut_motion_kind kind);

typedef struct strut_mechanism {
  strut_motion_kind kind;
  const double *motion; /* (rows) free coordinates; unit vector */
  double stiffness;     /* by the forces in the shape [N/m]; NAN where these do not balance */
  double stress_form;   /* the same by strut_mechanisms.stiffener [1/m]; NAN without one */
  double moved;         /* followed: largest change of a distance between nodes [m]; NAN: not */
  double strain;        /* and the largest relative change of a member's length on the way */
} strut_mechanism;

typedef struct strut_mechanisms {
  int32_t count; /* f */
  int32_t rigid_body, infinitesimal, finite, undecided;
  strut_mechanism *list; /* (count) rigid-body ones first; NULL: none or too many */
  bool by_forces;        /* the forces in the shape stiffen all that are not rigid-body */
  double
      *stiffener; /* (members, hinges) a self-stress that does, largest force 1; NULL: none found */
  bool stiffener_pulls; /* and presses no cable */
} strut_mechanisms;

/**
 * Sorts the motions of A at q (length). force (members) [N] are those in the shape, or NULL where
 * they do not balance. A mechanism is infinitesimal where a self-stress has a positive form
 * on all that are not rigid-body (prestress stability, Connelly and Whiteley 1996); finite where it
 * can be walked along by a tenth of the structure's size with all lengths kept. All in the arena.
 * STRUT_OK or STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_mechanisms_find(const strut_model *model,
                                             const strut_equilibrium_matrix *a, const double *q,
                                             const strut_null_spaces *spaces,
                                             const strut_self_stress *states, const double *force,
                                             strut_arena *arena, strut_mechanisms *mechanisms);

/* The stress matrix of force densities: the stiffness that member forces give to motions without
 * stretch.
 *
 * Omega has the sum of a node's force densities on its diagonal and minus a member's at its two
 * nodes (Connelly and Whiteley 1996). Its form, sum of density * |d2 - d1|^2 over members, is the
 * stiffness that a prestress gives to a mechanism d.
 */

/** The bilinear form at motions x and y (rows) of the free coordinates; density (columns) [N/m]. */
STRUT_API double strut_stress_form(const strut_model *model, const strut_equilibrium_matrix *a,
                                   const double *density, const double *x, const double *y);

/**
 * The form on the span of `count` motions (count, rows), as a symmetric (count, count) matrix.
 */
STRUT_API void strut_stress_form_on(const strut_model *model, const strut_equilibrium_matrix *a,
                                    const double *density, const double *motion, int32_t count,
                                    double *form);

typedef struct strut_stress_matrix {
  bool tested;         /* false: too large, or by_elements */
  bool by_elements;    /* running cables or hinges carry a part of the forces: not judged */
  bool supported;      /* the supports carry forces: eigenvalues on the free coordinates instead */
  int32_t count;       /* eigenvalues */
  double *eigenvalues; /* (count) ascending [N/m] */
  int32_t nullity;     /* zero to rounding */
  bool positive;       /* no eigenvalue below zero */
  bool on_conic;       /* an affine motion keeps all lengths: directions on a conic at infinity */
  bool super_stable;
} strut_stress_matrix;

/** Largest number of nodes whose stress matrix is looked at. */
enum { STRUT_DENSE_STRESS = 300 };

/**
 * Super stability (Connelly): the form is positive semidefinite, vanishes on affine motions alone
 * (nullity 3 in the plane), and no affine motion keeps all lengths. That is proven
 * for straight members: not judged where running cables or hinges carry a part. Where supports carry forces of
 * the state, the form on the free coordinates must be positive definite instead. force (columns) is
 * a state of self-stress. STRUT_OK or STRUT_NO_MEMORY; eigenvalues in the arena.
 */
STRUT_API strut_status strut_stress_matrix_judge(const strut_model *model,
                                                 const strut_equilibrium_matrix *a,
                                                 const double *force, strut_arena *arena,
                                                 strut_stress_matrix *stress);

/* Static stiffness of nodes: what a small force at a node meets along its direction, 1/(d' K^-1 d).
 *
 * K is that of members, their forces, and closed contacts, which hold along the ground as across it, as
 * sticking friction does. Rigid motions that nothing resists are taken out of the force.
 */

/** Free coordinates at most: K is dense here. */
enum { STRUT_STIFFNESS_COORDINATES = 1000 };

typedef struct strut_node_stiffness strut_node_stiffness;

/**
 * At the shape q, which is an equilibrium. *reason: why there is none, a constant, and *stiffness is
 * NULL; else NULL. The model must outlive it.
 */
STRUT_API strut_status strut_node_stiffness_create(const strut_model *model, const double *q,
                                                   strut_node_stiffness **stiffness,
                                                   const char **reason, strut_error *error);
/** Along the unit vector `direction` [N/m]; NAN where the node cannot move that way. */
STRUT_API double strut_node_stiffness_along(strut_node_stiffness *stiffness, int32_t node,
                                            const double direction[2]);
STRUT_API void strut_node_stiffness_free(strut_node_stiffness *stiffness); /* NULL is allowed */

#endif
