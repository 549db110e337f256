/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * One mapping of the language laid over another: a scene over its `base`, a part over the file that it
 * uses, a study's keys over those of its model.
 *
 * Mappings are laid over key by key, all the way down; lists, texts and numbers are replaced. A key takes
 * the place of others that say the same in another way, and `NAME: remove` takes the key away. A node's
 * `[x, y]` counts as {position: [x, y]}. A part that uses a file replaces the one of its name as a whole.
 */
#pragma once

#include <stddef.h>

#include "engine/base/memory.h"
#include "engine/base/status.h"
#include "engine/scene/things.h"
#include "parser/language/keys/keys.h"
#include "parser/language/yaml/document.h"

/** What a mapping is: the keys of a section, or (`things`) names of things that have these keys. */
typedef struct strut_mapping_kind {
  strut_section section; /* STRUT_SECTION_COUNT: none */
  bool things;
} strut_mapping_kind;

/** The mapping that is the value of a key. */
STRUT_API strut_mapping_kind strut_kind_below(strut_mapping_kind kind, const char *key);

/** Does some key of the mapping say the same as this one, of another name, in another way? */
STRUT_API bool strut_says_otherwise(strut_mapping_kind kind, const strut_tree *map,
                                    const char *key);

typedef struct strut_overlay {
  strut_arena *arena; /* of the result, which shares what did not change */
  unsigned file;      /* of every place of what is laid over; 0: as they stand */
  bool of_scene;      /* what is laid over belongs to the scene, not to a copy of a part */
  bool whole;         /* keys within keys are replaced together */
  strut_diagnostics *diagnostics; /* receives removals of what is not there; NULL: they stay */
} strut_overlay;

/** `base` with the keys of `over`, both mappings of a kind; the base's order. NULL: memory is out. */
STRUT_API strut_tree *strut_lay_over(const strut_overlay *overlay, strut_mapping_kind kind,
                                     const strut_tree *base, const strut_tree *over);
/** Does the value take its key away: is it `remove`? */
bool strut_is_removal(const strut_tree *value);

/* Differences between two scenes, as texts; those of many copies of a part as one. */

/**
 * Compares two texts of strut_setup_write (or any YAML) key by key in the order of the first, then lists what
 * only the second has. A list counts as one value, and so does a node or member that only one has; a copy of
 * a part that only one has is one difference, too. The scenes' name, description and source are left out. The
 * results belong to the arena. STRUT_OK, STRUT_BAD_SCENE if a text is not YAML, or STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_text_differences(const char *first, const char *second,
                                              strut_arena *arena, strut_difference **list,
                                              size_t *count);
