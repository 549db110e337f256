/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The parts of compiling a scene: elements, feedback, and what slides. */
#pragma once

#include "engine/model/model.h"

/* From the members and hinges of a scene to the elements of a model; see elements.h. */

/** Slots for natural strains of elements that are no members, behind the members' own. */
size_t strut_element_slots(const strut_scene *scene);

/**
 * Fills model->elements from the scene, whose members stand in the model's tables already, and takes out
 * of those what elements do instead. False: out of memory.
 */
bool strut_elements_compile(strut_model *model);

/** The numbers of a law, with the pieces of its curve where it has one. False: out of memory. */
bool strut_law_numbers_set(strut_model *model, const strut_law *law, double stiffness,
                           strut_law_numbers *numbers);

/**
 * Puts (count) elements, whose nodes are in model->elements.at, into the order of the tables, and fills these.
 * nodes: of all elements. False: out of memory.
 */
bool strut_elements_arrange(strut_model *model, const strut_element *element, int32_t count,
                            int32_t nodes);

/** Lists what rubs, and places the elements of feet on their grounds, after contacts were compiled; false: out of memory. */
bool strut_rubbing_compile(strut_model *model);

/** Fills model->actuator_forces from the scene. False: out of memory. */
bool strut_actuator_forces_compile(strut_model *model);

/** Fills model->support_motion, and start and velocity of moved coordinates. False: out of memory. */
bool strut_support_motion_compile(strut_model *model);

/** Value near which an element's strain is taken at the start: its natural strain. */
double strut_element_start(const strut_model *model, int32_t element);
/** Slot of the moment of a load that is a couple. */
int32_t strut_couple_slot(const strut_model *model, size_t load);
/** Slot of the natural strain that actuator i of the scene drives. */
int32_t strut_actuator_slot(const strut_model *model, size_t i);

/* From the scene's sensors to the model's. */

/** Coordinates that internal states need. */
size_t strut_feedback_states(const strut_scene *scene);
/** Fills model->feedback, after elements and contacts. False: out of memory. */
bool strut_feedback_compile(strut_model *model);

/* How a model gets its table of sliding masses; internal to engine/model. */

/** Fills the table but for the answers; before the weights. False: out of memory. */
bool strut_sliding_masses_compile(strut_model *model);
/** Finds the answers; after the mass matrix. STRUT_OK or STRUT_NO_MEMORY. */
strut_status strut_sliding_masses_solve(strut_model *model);
