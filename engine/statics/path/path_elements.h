/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Elements in the equations of a path: running cables, hinges, other laws, stops. For system.c.
 *
 * They are evaluated in double. Which ones act and on which smooth piece of its law each stays is
 * frozen between events, as for cables. An angle stays near that of the last point kept, so that it
 * is continuous over whole turns.
 */
#ifndef STRUT_ENGINE_STATICS_PATH_PATH_ELEMENTS_H
#define STRUT_ENGINE_STATICS_PATH_PATH_ELEMENTS_H

#include "engine/forces/elements.h"
#include "engine/statics/path/parameter.h"

struct strut_path_system;

/** An element at the point that was evaluated last. */
typedef struct strut_path_element {
  strut_element_pose pose; /* force and slope of its frozen piece; 0 where it does not act */
  double rate;             /* of its force with the parameter, its strain held */
  double turn;             /* value near which an angle is taken; NAN: its natural one */
  bool acts;
  int piece; /* of its law */
} strut_path_element;

/** What may change about an element: whether it acts (kink -1), or on which side of a kink it is. */
typedef struct strut_path_element_switch {
  int32_t element, kink;
} strut_path_element_switch;

typedef struct strut_path_elements {
  int32_t switch_count;
  strut_path_element *element;         /* (elements) */
  strut_path_element_switch *switches; /* (switch_count) kinks of one element ascending */
} strut_path_elements;

/** False: out of memory. */
bool strut_path_elements_create(const strut_model *model, strut_arena *arena,
                                strut_path_elements *elements);

/** Adds forces, stiffness and the parameter's slope of all elements at system->q. */
void strut_path_add_elements(struct strut_path_system *system);
/** Adds the forces that hold them, on all coordinates, to the reactions (length). */
void strut_path_element_reactions(const struct strut_path_system *system, double *reaction);
/** Angles are taken near those of the last evaluation from now on. */
void strut_path_keep_turns(struct strut_path_system *system);

/** Force of all elements of member j [N]. */
double strut_path_element_tension(const struct strut_path_system *system, int32_t member);
/** Moments of the hinges [N m] (hinges). */
void strut_path_moments(const struct strut_path_system *system, double *moment);
/** Pressures in the cells [N/m] (cells). */
void strut_path_pressures(const struct strut_path_system *system, double *pressure);

/** As strut_path_switch_value, for an element's switch at the terms and positions of the system. */
double strut_path_element_switch_value(const struct strut_path_system *system, int32_t which);
bool strut_path_element_switch_is_on(const struct strut_path_system *system, int32_t which);
void strut_path_element_switch_set(struct strut_path_system *system, int32_t which, bool on);

#endif
