/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The parameter of a path: how each number of the equations depends on it. */
#ifndef STRUT_ENGINE_STATICS_PATH_PARAMETER_H
#define STRUT_ENGINE_STATICS_PATH_PARAMETER_H

#include "engine/base/double_double.h"
#include "engine/statics/path/path.h"

/**
 * Numbers of the equations that a parameter may change, or their derivatives with respect to it.
 */
typedef struct strut_path_terms {
  double *stiffness;               /* (slots) [N/m] */
  double *rest, *rest_low;         /* (slots) rest length as a sum of two [m] */
  double *position, *position_low; /* (length) of held coordinates, likewise [m] */
  double *force;                   /* (length) gravity and loads [N] */
  double *ground;                  /* (contacts) stiffness [N/m] */
  double normal[2], point[2];      /* of the ground's line */
  const strut_model *laws;         /* whose elements have laws and natural strains of these terms */
  struct strut_path_scene *scene; /* that `laws` is of if it is not the path's own model, or NULL */
} strut_path_terms;

/** strut_path_parameter_create fills it; of the one in use the address must not change. */
typedef struct strut_path_parameter {
  const strut_path_options *options;
  const strut_model *model; /* at `from`: of all others the structure must be the same */
  const double *load;       /* (length) loads at factor 1 [N] */
  double from, range;       /* [SI]; range is not 0 */
  strut_path_terms base, low, high;
  double apart;        /* of low and high as a derivative took them */
  double refused_at;   /* the last value that was refused, and why */
  strut_error refusal; /* STRUT_OK: none was */
} strut_path_parameter;

/** Is the ground of the model, if it has one, one straight line at rest? */
bool strut_path_has_line(const strut_model *model);
/** Terms of zeros in the arena; false: out of memory. */
bool strut_path_terms_create(const strut_model *model, strut_arena *arena, strut_path_terms *terms);
/** Releases the scene that terms were read from; what lies in the arena stays. */
void strut_path_terms_release(strut_path_terms *terms);

/**
 * `position` (length) are the held coordinates at `from`. STRUT_USAGE where the parameter changes
 * nothing at rest, or the structure itself; STRUT_NO_MEMORY.
 */
strut_status strut_path_parameter_create(const strut_model *model,
                                         const strut_path_options *options, const double *load,
                                         double from, double until, const double *position,
                                         strut_arena *arena, strut_path_parameter *parameter,
                                         strut_error *error);

/** Releases what its terms hold outside of the arena; zero-initialised ones may be freed. */
void strut_path_parameter_free(strut_path_parameter *parameter);

/** The terms at a value; false: there are none, parameter->refusal says why. */
bool strut_path_parameter_terms(strut_path_parameter *parameter, strut_dd value,
                                strut_path_terms *terms);
/** Their derivatives with respect to the parameter; false likewise. */
bool strut_path_parameter_rates(strut_path_parameter *parameter, double value,
                                strut_path_terms *rates);

#endif
