/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Semantic rules of a scene; all findings are reported at once.
 *
 * The rules apply to the plain description, however it was made. A finding names its subject and
 * key, by which a reader of text finds the position.
 */
#pragma once

#include "engine/scene/things.h"

/** What a finding is about: a thing, or one of the scene's own mappings. */
typedef enum strut_subject {
#define STRUT_SUBJECT_ROW(KIND, ...) STRUT_ON_##KIND,
  STRUT_THINGS(STRUT_SUBJECT_ROW) STRUT_ON_SCENE,
  STRUT_ON_EQUILIBRIA,
  STRUT_ON_INITIAL,
  STRUT_ON_SOLVER,
  STRUT_ON_RUN,
  STRUT_ON_OUTPUT
} strut_subject;

/** Is it a thing? */
static inline bool strut_subject_is_thing(strut_subject subject) {
  return subject < STRUT_ON_SCENE;
}
static inline strut_subject strut_on_thing(strut_thing kind) { return (strut_subject)kind; }

typedef struct strut_finding {
  strut_subject subject;
  size_t index;        /* into the scene's array of that kind of thing; else 0 */
  const char *key;     /* key of the language ("stiffness"), or NULL for the subject itself */
  const char *message; /* one sentence without a full stop */
} strut_finding;

/** Most stored findings; later ones are only counted. */
enum { STRUT_FINDINGS_MOST = 1000 };

/** All findings; owns their messages. Zero-initialise it. */
typedef struct strut_findings {
  size_t count, capacity, unstored;
  strut_finding *items;
  strut_arena arena;
} strut_findings;

/** Purpose of the scene: a run needs masses, a step and a duration; statics does not. */
typedef enum strut_purpose {
  STRUT_FOR_STATICS,
  STRUT_FOR_RUN,
  STRUT_FOR_RUN_STEP_LATER, /* for a run whose step or accuracy is given later */
  STRUT_FOR_ANY,            /* for a run where the scene describes one, otherwise for statics */
  STRUT_FOR_ANY_STATICS /* the same for what only rests: a run's step and masses may be missing */
} strut_purpose;

/** Appends every finding. Returns STRUT_OK (none new), STRUT_BAD_SCENE or STRUT_NO_MEMORY. */
STRUT_API strut_status strut_setup_check(const strut_setup *setup, strut_purpose purpose,
                                         strut_findings *findings);
/**
 * Warns of properties of a valid scene that are rarely intended, once per cause: rest lengths that
 * drives take below zero, nodes that start inside the ground, members that join the same two nodes,
 * masses that no member holds. The key of a warning is an identifier for programs, such as
 * "inside_ground". STRUT_OK or STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_setup_warn(const strut_setup *setup, strut_findings *warnings);
STRUT_API void strut_findings_free(strut_findings *findings);
