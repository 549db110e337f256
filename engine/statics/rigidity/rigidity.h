/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Statics of a shape: self-stress, mechanisms, their counts, and what the forces in the shape make
 * of them. In the plane: there is no third coordinate to move along.
 */
#ifndef STRUT_ENGINE_STATICS_RIGIDITY_RIGIDITY_H
#define STRUT_ENGINE_STATICS_RIGIDITY_RIGIDITY_H

#include "engine/statics/rigidity/rigidity_parts.h"

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
 * All of it at the positions q (length). strut_rigidity_free releases it, after a failure too.
 * STRUT_OK, STRUT_NO_MEMORY, or STRUT_SINGULAR where the rank cannot be found.
 */
STRUT_API strut_status strut_rigidity_find(const strut_model *model, const double *q,
                                           strut_rigidity *rigidity, strut_error *error);
STRUT_API void strut_rigidity_free(strut_rigidity *rigidity);

#endif
