/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Shared by the rules of the check; internal to engine/scene. */
#ifndef STRUT_ENGINE_SCENE_CHECK_RULES_H
#define STRUT_ENGINE_SCENE_CHECK_RULES_H

#include "engine/scene/check.h"
#include "engine/scene/things.h"

/** State of a check. */
typedef struct strut_checker {
  const strut_scene *scene;
  const strut_experiment *experiment;
  strut_purpose purpose;
  bool step_given_later; /* the step is given later */
  bool resting;          /* nothing moves, so that no mass is needed */
  strut_findings *findings;
  bool out_of_memory;
  bool *
      loose; /* (member_count) true where an end of the member does not exist: other rules skip it */
  bool *wild; /* (signal_count) true where a signal must not be evaluated */
} strut_checker;

/** Adds a finding; sets out_of_memory where that fails. Returns false, for `return strut_report_finding(...)`. */
bool strut_report_finding(strut_checker *checker, strut_subject subject, size_t index,
                          const char *key, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/** Is it the index of one of so many things? */
static inline bool strut_exists(int32_t index, size_t count) {
  return index >= 0 && (size_t)index < count;
}

/** Formats a name for messages: "member 'm1'", or "member number 3" without one. */
const char *strut_format_name(char buffer[200], const char *kind, const char *name, size_t index);

/** Whose numbers are checked. */
typedef struct strut_checked {
  strut_subject subject;
  size_t index;
  const char *owner; /* what messages call it */
  const char *key;   /* of the mapping in which they are; NULL: each has its own */
} strut_checked;

/**
 * Reports the numbers of an object that are not finite, or outside the range of their row. Those that are as
 * in `usual` were not given, and valid unless they are required; NULL: all must be in their range. True where
 * all are valid.
 */
bool strut_check_fields(strut_checker *checker, const strut_checked *whose,
                        strut_thing_section section, const void *object, const void *usual);
/** The same of one number, by the row of its key. */
bool strut_check_number(strut_checker *checker, const strut_checked *whose,
                        strut_thing_section section, const char *key, double value);

/** Does an actuator add a force to that member, a moment to that hinge? -1: none. */
bool strut_is_pulled(const strut_scene *scene, int32_t member, int32_t hinge);

/** 1 for each node (node_count) that things between nodes join; to be released. NULL: out of memory. */
unsigned char *strut_joined_nodes(strut_checker *checker);

/** The rules, one function for each kind of thing. */
void strut_check_names(strut_checker *checker);
void strut_check_nodes(strut_checker *checker);
/** Is it a valid law of member `index`? Findings name its key. */
bool strut_check_member_law(strut_checker *checker, size_t index, const char *owner);
void strut_check_hinges(strut_checker *checker);
void strut_check_cells(strut_checker *checker);
void strut_check_collisions(strut_checker *checker);
void strut_check_distances(strut_checker *checker);
void strut_check_feet(strut_checker *checker);
void strut_warn_of_overlaps(strut_checker *checker);
/** After the signals. */
void strut_check_sliding_masses(strut_checker *checker);
void strut_check_members(strut_checker *checker);
void strut_check_use(strut_checker *checker);
void strut_check_ground(strut_checker *checker);
void strut_check_sensors(strut_checker *checker);
/** Is the Maxwell branch of member `index` valid? */
void strut_check_maxwell(strut_checker *checker, size_t index, const char *owner);
void strut_check_states(strut_checker *checker);
/** Are the lag and the sampling of signal `index` valid? */
bool strut_check_modifiers(strut_checker *checker, size_t index, const char *owner);
/** Is the program of signal `index` valid? */
bool strut_check_program(strut_checker *checker, size_t index, const char *owner);
/** Thresholds, values and name of a relay. */
bool strut_check_relay(strut_checker *checker, size_t index, const char *owner);
/** Is the rate of an actuator's signal, which is valid, known? */
void strut_check_driven_rate(strut_checker *checker, size_t actuator, const char *owner);
void strut_check_signals(strut_checker *checker);
void strut_check_drives(strut_checker *checker);
void strut_check_shapes(strut_checker *checker);
void strut_check_experiment(strut_checker *checker);

#endif
