/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Steps of rk4, verlet and euler for large structures, by one thread or several.
 *
 * Each thread steps a subdomain (subdomain.h) by STRUT_PASSES evaluations of the forces before it meets the others:
 * a step of rk4, or four of another method. Within it, nodes move as soon as their members have been worked on,
 * and members are worked on again as soon as their nodes have moved: four passes read the tables from memory
 * once. Where masses are coupled, every evaluation ends with a solve by all of them (mass_shares.h) instead.
 *
 * Motions have the same bits as the method's own, the energy balance's works too where members are stored as in the scene;
 * both for any number of threads.
 */
#ifndef STRUT_ENGINE_INTEGRATE_DOMAIN_STEPS_H
#define STRUT_ENGINE_INTEGRATE_DOMAIN_STEPS_H

#include "engine/integrate/integrator.h"

typedef struct strut_domain_steps strut_domain_steps;

/** Does it know the method, and all terms of the model's terms? */
bool strut_domain_steps_possible(const strut_model *model, const strut_integrator *method);
/**
 * member: (members) the scene's member that is stored at k, so that members at a node keep their order; NULL: as in
 * the scene. It is read here only. NULL: out of memory.
 */
strut_domain_steps *strut_domain_steps_create(const strut_model *model,
                                              const strut_integrator *method, const int32_t *member,
                                              int threads);
/** NULL is allowed. */
void strut_domain_steps_free(strut_domain_steps *steps);
/** As the method's restart, and whenever someone else has changed positions or velocities. */
void strut_domain_steps_restart(strut_domain_steps *steps, strut_state *state, double dt);
/** Advances a state of the model by `count` steps of dt [s]. */
void strut_domain_steps_advance(strut_domain_steps *steps, strut_state *state, double dt,
                                int64_t count);

#endif
