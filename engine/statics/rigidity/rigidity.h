/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Statics of a shape: self-stress, mechanisms, their counts, and what the forces in the shape make
 * of them. In the plane: there is no third coordinate to move along.
 */
#pragma once

#include "engine/model/model.h"
#include "engine/scene/value_rows.h"

/* The equilibrium matrix A of a shape: what forces on the nodes the member forces balance.
 *
 * A t = f: member forces t [N], tension positive, hold the loads f [N] on the free coordinates. Its
 * transpose gives the elongations A' d of small displacements d. A column is a member's unit vector
 * from its first node to its second, negative at the first, positive at the second, so that A knows
 * no lengths. Members between held coordinates, or without length, have a column of zeros. A running
 * cable's column is the gradient of its whole length. Behind the members stands a column for each
 * hinge: the gradient of its angle times the model's size, so that its force is moment / size [N]. Then
 * one for each cell: the gradient of its area over the size, so that its force is -pressure times size.
 */

typedef struct strut_equilibrium_matrix {
  int32_t rows;    /* free coordinates */
  int32_t columns; /* members, then hinges, cells and distances */
  int32_t members;
  double size;         /* of the model, by which hinges' moments are divided [m] */
  int32_t *coordinate; /* (rows) index into coordinate arrays */
  int32_t *row_of;     /* (length) row of a coordinate, -1 where fixed */
  double *length;      /* (columns) of members; of hinges angle * size, of cells area / size [m] */
  double *scale;       /* (columns) of gradients, strains and, divided by it, forces */
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
  const strut_scene *scene = model->scene;
  return model->members.count +
         (int32_t)(scene->hinge_count + scene->cell_count + scene->distance_count);
}

/** Is column j a cable? */
static inline bool strut_column_is_cable(const strut_model *model, int32_t j) {
  return j < model->members.count && model->scene->members[j].kind == STRUT_CABLE;
}

/** Force density of column j [N/m]: force / length, or force times curvature; 0 without length. */
static inline double strut_column_density(const strut_equilibrium_matrix *matrix, int32_t j,
                                          double force) {
  if (matrix->curved[j] >= 0) return force * matrix->curvature[j];
  return matrix->length[j] > 0 ? force / matrix->length[j] : 0.0;
}

/** A of the positions q (length), in the arena. STRUT_OK or STRUT_NO_MEMORY. */
STRUT_API strut_status strut_equilibrium_matrix_build(const strut_model *model,
                                                      const double *positions, strut_arena *arena,
                                                      strut_equilibrium_matrix *matrix);

/** y (rows) = A t for t (columns). */
STRUT_API void strut_equilibrium_multiply(const strut_equilibrium_matrix *matrix, const double *t,
                                          double *y);
/** e (columns) = A' d for d (rows). */
STRUT_API void strut_equilibrium_elongate(const strut_equilibrium_matrix *matrix,
                                          const double *change, double *e);

/* The rank of an equilibrium matrix, with the gap that decides it, and its two null spaces.
 *
 * Up to STRUT_DENSE_RIGIDITY rows and columns by singular values; above by sparse QR, the diagonal
 * of whose R then replaces them. Values above STRUT_RANK_TOLERANCE times the largest count
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
STRUT_API strut_status strut_null_spaces_find(const strut_equilibrium_matrix *matrix,
                                              strut_arena *arena, strut_null_spaces *spaces,
                                              strut_error *error);

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
  double largest;       /* motion of the node that moves most in it */
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
  double *stiffener;    /* (members, hinges) a self-stress that does, at most 1; NULL: none found */
  bool stiffener_pulls; /* and presses no cable */
} strut_mechanisms;

/* The stress matrix of force densities: the stiffness that member forces give to motions without
 * stretch.
 *
 * Omega has the sum of a node's force densities on its diagonal and minus a member's at its two
 * nodes (Connelly and Whiteley 1996). Its form, sum of density * |d2 - d1|^2 over members, is the
 * stiffness that a prestress gives to a mechanism d.
 */

/** The bilinear form at motions x and y (rows) of the free coordinates; density (columns) [N/m]. */
STRUT_API double strut_stress_form(const strut_model *model, const strut_equilibrium_matrix *matrix,
                                   const double *density, const double *vector, const double *y);

/** The form on the span of `count` motions (count, rows), as a symmetric (count, count) matrix. */
STRUT_API void strut_stress_form_on(const strut_model *model,
                                    const strut_equilibrium_matrix *matrix, const double *density,
                                    const double *motion, int32_t count, double *form);

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

/** Largest number of nodes whose stress matrix is analysed. */
enum { STRUT_DENSE_STRESS = 300 };

/**
 * Super stability (Connelly): the form is positive semidefinite, vanishes on affine motions alone
 * (nullity 3 in the plane), and no affine motion keeps all lengths. That is proven
 * for straight members: not judged where running cables or hinges carry a part. Where supports carry forces of
 * the state, the form on the free coordinates must be positive definite instead. force (columns) is
 * a state of self-stress. STRUT_OK or STRUT_NO_MEMORY; eigenvalues in the arena.
 */
STRUT_API strut_status strut_stress_matrix_judge(const strut_model *model,
                                                 const strut_equilibrium_matrix *matrix,
                                                 const double *force, strut_arena *arena,
                                                 strut_stress_matrix *stress);

/** Residual forces up to this share of the largest force in the shape count as balance. */
#define STRUT_BALANCE_TOLERANCE 1e-8

/** The member forces that a verdict refers to. */
typedef enum strut_stress_source {
  STRUT_STRESS_NONE,        /* there is no state of self-stress */
  STRUT_STRESS_STATE,       /* the only state */
  STRUT_STRESS_SHAPE,       /* the forces in the shape, which balance without loads */
  STRUT_STRESS_COMBINATION, /* a combination that pulls all cables */
  STRUT_STRESS_FIRST        /* the first of several states, for want of something better */
} strut_stress_source;

/** The features of Obara, Klosowska and Gilewski's definition; a truss it always is. */
typedef struct strut_tensegrity {
  bool judged;        /* false: no state of self-stress to judge by */
  bool self_stress;   /* S: there is a state of self-stress */
  bool cables;        /* C: what is pulled are cables */
  bool mechanism;     /* M: a mechanism, which self-stress with pulled cables stiffens */
  bool all_states;    /* every state of self-stress does so, as far as the listed ones tell */
  bool struts_apart;  /* D: no two members that are pressed meet */
  bool struts_inside; /* I: what is pulled is one net that meets all struts, none outermost */
  const char *label;  /* words */
} strut_tensegrity;

typedef struct strut_rigidity {
  const char *at; /* name of the shape; the caller's */
  strut_equilibrium_matrix matrix;
  strut_null_spaces spaces;
  strut_self_stress states;
  strut_mechanisms mechanisms;
  double *force;        /* (members, hinges, cells) in the shape, tension positive; of a hinge
                           moment / size of the model [N] */
  double *density;      /* (members) force / length [N/m]; 0 without length */
  bool prestressed;     /* some member carries a force */
  double residual;      /* largest net force on a free coordinate: members, gravity, constant
                             loads and the ground's springs [N] */
  double largest_force; /* of members, weights and loads: what the residual compares to [N] */
  bool equilibrium;
  bool self_equilibrium; /* the members balance alone: the forces are a state of self-stress */
  bool has_cables;
  bool cables_can_pull;   /* some self-stress pulls every cable that any state loads: `feasible` */
  double *feasible;       /* (columns) that one, largest force 1; NULL: none found */
  int32_t bars_at_node;   /* class k: the most bars that meet; 0 without bars */
  int32_t without_length; /* members of no length in this shape: they have no direction */
  strut_stress_source source; /* what `stress` and the tensegrity's features are about */
  const double *judged;       /* (columns) those forces; NULL without */
  strut_stress_matrix stress;
  strut_tensegrity tensegrity;
  strut_arena arena;
} strut_rigidity;

/**
 * Sorts the motions of rigidity->spaces at q (length) into rigidity->mechanisms. force (members) [N] are
 * those in the shape, or NULL where they do not balance. A mechanism is infinitesimal where a self-stress has
 * a positive form on all that are not rigid-body (prestress stability, Connelly and Whiteley 1996); finite
 * where it can be walked along by a tenth of the structure's size with all lengths kept. All in the arena.
 * STRUT_OK or STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_mechanisms_find(const strut_model *model, const double *positions,
                                             const double *force, strut_rigidity *rigidity);

/**
 * All of it at the positions q (length). strut_rigidity_free releases it, after a failure too.
 * STRUT_OK, STRUT_NO_MEMORY, or STRUT_SINGULAR where the rank cannot be found.
 */
STRUT_API strut_status strut_rigidity_find(const strut_model *model, const double *positions,
                                           strut_rigidity *rigidity, strut_error *error);
STRUT_API void strut_rigidity_free(strut_rigidity *rigidity);

/** Rows of a strut_rigidity. */
STRUT_API extern const strut_value_rows strut_rigidity_values;
