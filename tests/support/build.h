/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Scenes made by hand, thing by thing. Each function that adds returns the new thing's index.
 *
 * Begin with build_scene or build_setup and end with strut_scene_free or strut_setup_free. Things are called n1, n2, ..., m1, ...
 * A function that is refused memory fails the test.
 */
#pragma once

#include "engine/scene/experiment.h"

strut_scene build_scene(void);
strut_setup build_setup(void);
/** The same under gravity, 9.81 m/s^2 downwards. */
strut_setup build_falling(void);
/** The same with node 0 fixed at the origin and node 1, a mass [kg], at (x, y) [m]. */
strut_setup build_tethered(double x, double y, double mass);
/** A free node, drawn and starting at x, y [m], without mass and at rest. */
int32_t build_node(strut_scene *scene, double x, double y);
/** The same with a point mass [kg]. */
int32_t build_mass(strut_scene *scene, double x, double y, double mass);
/** The same, supported in x and y. */
int32_t build_support(strut_scene *scene, double x, double y);
/** A member that is at rest as drawn: [N/m], [N s/m], [kg]. */
int32_t build_member(strut_scene *scene, strut_member_kind kind, int32_t from, int32_t to,
                     double stiffness, double damping, double mass);
/** The same with a rest length [m] of its own. */
int32_t build_sized(strut_scene *scene, strut_member_kind kind, int32_t from, int32_t to,
                    double stiffness, double damping, double mass, double rest_length);
int32_t build_signal(strut_scene *scene, strut_signal signal);
int32_t build_sine(strut_scene *scene, double amplitude, double frequency);
int32_t build_actuator(strut_scene *scene, int32_t member, int32_t signal);
/** A hinge at b, from the arm b-a to the arm b-c, at rest as drawn: [N m/rad], [N m s/rad]. */
int32_t build_hinge(strut_scene *scene, int32_t a, int32_t b, int32_t c, double stiffness,
                    double damping);
/** Lets a member run over further nodes between its ends. */
void build_guides(strut_scene *scene, int32_t member, const int32_t *guides, size_t count);
/** signal: -1 for a constant load. */
int32_t build_load(strut_scene *scene, int32_t node, double x, double y, int32_t signal);
/** A contact without friction; makes the ground present. Call it in the order of the nodes. */
int32_t build_contact(strut_scene *scene, int32_t node, double stiffness, double damping);
/** A contact with Karnopp's law. */
int32_t build_rough_contact(strut_scene *scene, int32_t node, double stiffness, double damping,
                            double mu_static, double mu_kinetic, double stick_velocity);
/** A copy of count doubles that the scene owns. */
const double *build_numbers(strut_scene *scene, const double *numbers, size_t count);
