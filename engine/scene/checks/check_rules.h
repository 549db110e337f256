/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Shared by the rules of the check; internal to engine/scene. */
#pragma once

#include "engine/scene/checks/check.h"
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
  bool *loose; /* (member_count) an end of it does not exist: other rules skip it */
  bool *wild;  /* (signal_count) true where a signal must not be evaluated */
  /* What is being checked: the subject of findings, with its number, */
  strut_subject subject;
  size_t index;
  char owner[200];    /* its name in messages: "member 'm1'", or "member number 3" without one */
  const char *within; /* the key of the mapping with its numbers; NULL: each has its own */
} strut_checker;

/** Begins with a thing, or with another subject that has this name. */
void strut_check_begin(strut_checker *checker, strut_thing kind, size_t index);
void strut_check_begin_with(strut_checker *checker, strut_subject subject, size_t index,
                            const char *owner);

/** Adds a finding; sets out_of_memory where that fails. Returns false, for `return strut_report_finding(...)`. */
bool strut_report_finding(strut_checker *checker, strut_subject subject, size_t index,
                          const char *key, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/** The same about what is being checked: "OWNER" and then the text, */
bool strut_fault(strut_checker *checker, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/** or the text alone. */
#define strut_fault_of(checker, key, ...)                                                          \
  strut_report_finding(checker, (checker)->subject, (checker)->index, key, __VA_ARGS__)

/** Is it the index of one of so many things? */
static inline bool strut_exists(int32_t index, size_t count) {
  return index >= 0 && (size_t)index < count;
}

/** Formats a name for messages: "member 'm1'", or "member number 3" without one. */
const char *strut_format_name(char buffer[200], const char *kind, const char *name, size_t index);

/**
 * Reports the numbers of an object that are not finite, or outside the range of their row. Those that are as
 * in `usual` were not given, and valid unless they are required; NULL: all must be in their range. True where
 * all are valid.
 */
bool strut_check_fields(strut_checker *checker, strut_thing_section section, const void *object,
                        const void *usual);
/** The same of the thing that is being checked, beside the defaults of its kind. */
bool strut_check_thing(strut_checker *checker);
/** The same of one number, by the row of its key. */
bool strut_check_number(strut_checker *checker, strut_thing_section section, const char *key,
                        double value);

/** Are two nodes drawn, and do they start, apart, so that `what` of the owner ("", "an arm of ") has a direction? */
bool strut_check_apart(strut_checker *checker, const char *key, int32_t first, int32_t second,
                       const char *what);
/**
 * Has the signal of a motion an acceleration and no jumps? If not, that is reported of `what` ("the angle of unbalance
 * 'u'"), by which a `moved` ("support") moves.
 */
bool strut_check_motion(strut_checker *checker, const char *key, int32_t signal, const char *what,
                        const char *moved);
/** Does an actuator add a force to that member, a moment to that hinge? -1: none. */
bool strut_is_pulled(const strut_scene *scene, int32_t member, int32_t hinge);

/** 1 for each node (node_count) that things between nodes join; to be released. NULL: out of memory. */
unsigned char *strut_joined_nodes(strut_checker *checker);

/** The rules, one function for each kind of thing. */
/** Is it a valid law of the member? Findings name its key. */
bool strut_check_member_law(strut_checker *checker);
void strut_check_hinges(strut_checker *checker);
void strut_check_cells(strut_checker *checker);
void strut_check_collisions(strut_checker *checker);
void strut_check_distances(strut_checker *checker);
void strut_check_feet(strut_checker *checker);
void strut_warn_of_overlaps(strut_checker *checker);
/** After the signals. */
void strut_check_sliding_masses(strut_checker *checker);
void strut_check_ground(strut_checker *checker);
void strut_check_sensors(strut_checker *checker);
/** Is the Maxwell branch of the member valid? */
void strut_check_maxwell(strut_checker *checker);
void strut_check_states(strut_checker *checker);
/** Is the rate of an actuator's signal, which is valid, known? */
void strut_check_driven_rate(strut_checker *checker);
void strut_check_signals(strut_checker *checker);
void strut_check_drives(strut_checker *checker);
void strut_check_shapes(strut_checker *checker);
void strut_check_experiment(strut_checker *checker);
