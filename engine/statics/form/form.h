/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Form finding: from what a scene gives of a structure to a shape, rest lengths and start positions
 * that stand still when the scene is run.
 */
#pragma once

#include "engine/scene/experiment.h"
#include "engine/scene/value_rows.h"

typedef enum strut_form_source {
  STRUT_FORM_BY_SCENE, /* densities if a member gives one, else lengths if one does, else prestress */
  STRUT_FORM_DENSITIES, /* force densities, in the drawn shape, and connectivity give the shape */
  STRUT_FORM_LENGTHS,   /* rest lengths give the shape, the one that the drawn one falls into */
  STRUT_FORM_PRESTRESS  /* the drawn shape stays; forces that hold it give the rest lengths */
} strut_form_source;

/** The objective that selects one state of prestress among many. */
typedef enum strut_form_objective {
  STRUT_FORM_LARGEST, /* the largest magnitude of a force is least, then the sum of magnitudes */
  STRUT_FORM_SUM,     /* the sum of the magnitudes is least */
  STRUT_FORM_SQUARES  /* the sum of the squares of the cables' force densities is least */
} strut_form_objective;

typedef struct strut_form_options {
  strut_form_source from;
  strut_form_objective objective;
  double
      least_tension; /* of every cable [N]; 0: a hundredth of the weight and the loads or, without
                           any, of the least stiffness times length of a cable; none of that where
                           least_density is given */
  double least_density; /* of every cable [N/m]; 0: none */
} strut_form_options;

typedef struct strut_form {
  strut_form_source from; /* what was done */
  double moved;           /* farthest that a node was moved from where it was drawn [m] */
  double residual;        /* largest net force on a free coordinate at the start [N] */
  double density_change;  /* largest change of a force density, of the largest one [1] */
  double least_tension;   /* lower bound for the cables [N] */
  double largest_force;   /* magnitude [N] */
  bool run_added;         /* the scene had no run: a step and 10 s were given to it */
  bool driven;            /* the scene has drives or loads with a signal: they will move it */
  bool massless;          /* a node that can move has no mass: the result is for statics alone */
  const double *length, *rest, *force, *density; /* (members) at the start [m], [m], [N], [N/m]; in
                                                     the scene's arena */
} strut_form;
/** Rows of a strut_form. */
STRUT_API extern const strut_value_rows strut_form_values;

/**
 * Changes the scene and its experiment: positions, rest lengths, start. Supports stay where they are drawn;
 * gravity, constant loads and the ground are reckoned with, friction is not. The result is an equilibrium
 * that is stable or floppy. Fails with STRUT_NOT_SETTLED and a sentence that names nodes where there is no
 * such shape, no such forces or no stability, STRUT_SINGULAR where densities determine no shape,
 * STRUT_BAD_SCENE where densities or a prestress are wanted of running cables, hinges or members with another
 * law than the linear one, STRUT_NO_MEMORY; then the scene is of no further use.
 */
STRUT_API strut_status strut_form_find(strut_setup *setup, const strut_form_options *options,
                                       strut_form *form, strut_error *error);
