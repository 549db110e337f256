/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The methods of form finding and their shared parts, for the files of this folder. */
#pragma once

#include "engine/statics/form/form.h"
#include "engine/statics/potential.h"

/** A scene on its way to a form. */
typedef struct strut_former {
  strut_scene *scene;
  strut_experiment *experiment;
  const strut_form_options *options;
  strut_form *form;
  const strut_model *model;   /* the original scene, compiled */
  strut_potential *potential; /* of it: free coordinates, weight and loads */
  double size;                /* of the drawn shape [m], > 0 */
  strut_arena arena;
} strut_former;

/** Contact i with its node at some point, or where that is drawn. */
strut_contact_pose strut_form_contact(const strut_former *former, int32_t contact,
                                      const double *point);
strut_contact_pose strut_form_contact_as_drawn(const strut_former *former, int32_t contact);
/** Is its node drawn in the ground or on it, within rounding? */
bool strut_form_touches(const strut_former *former, int32_t contact);

/** Length of member j at the start [m]. */
double strut_form_length(const strut_scene *scene, size_t member);
/** Gives member j the rest length with which it carries `force` at the length it starts with. */
strut_status strut_form_set_force(strut_former *former, size_t member, double force,
                                  strut_error *error);
/**
 * Rest lengths from the drawn shape; start positions sink into the ground under the contact forces.
 */
strut_status strut_form_prestress(strut_former *former, strut_error *error);

/**
 * The pair of shape x (2 node_count) and densities q (member_count) in equilibrium that is nearest
 * to the one given. held (2 node_count): 1 where a coordinate keeps its value. `standing`: the held
 * coordinates only prevent rigid motions.
 */
strut_status strut_form_nearest(strut_former *former, const uint8_t *held, bool standing,
                                double *vector, double *positions, strut_error *error);

/**
 * Minimises the sum of (weight x)^2 subject to A x = b, with b from the initial `x` (count), and x
 * >= low. equations (rows, count), row by row. False: memory was out.
 */
bool strut_bounded_squares(int32_t rows, int32_t count, const double *equations,
                           const double *weight, const double *low, double *vector);
