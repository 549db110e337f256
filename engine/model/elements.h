/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Elements: forces that are a strain with a law.
 *
 * A strain is one number e made of the positions of a few nodes (engine/forces/strains); a law is the
 * force that works on it (engine/scene/laws). A plain member, `length` with the linear law, is stepped
 * by the vector kernel from the member table instead. All other pairs are elements: members that run
 * over guides, with other laws or with stops, and hinges.
 */
#ifndef STRUT_ENGINE_MODEL_ELEMENTS_H
#define STRUT_ENGINE_MODEL_ELEMENTS_H

#include <stdbool.h>
#include <stdint.h>

#include "engine/scene/scene.h"

/** The strains: X(NAME, name, unit, context); context is passed on. */
#define STRUT_STRAINS(X, context)                                                                  \
  X(LENGTH, length, "m", context)                                                                  \
  X(PATH, path, "m", context)                                                                      \
  X(ANGLE, angle, "rad", context)                                                                  \
  X(AREA, area, "m^2", context)                                                                    \
  X(REACH, reach, "m", context)

typedef enum strut_strain_kind {
#define STRUT_STRAIN_ROW(NAME, ...) STRUT_STRAIN_##NAME,
  STRUT_STRAINS(STRUT_STRAIN_ROW, )
#undef STRUT_STRAIN_ROW
      STRUT_STRAIN_COUNT
} strut_strain_kind;

/** What an element is in the scene. */
typedef enum strut_element_role {
  STRUT_ELEMENT_MEMBER,   /* the force of a member */
  STRUT_ELEMENT_LONGEST,  /* a stop of a member, which pulls beyond its longest length */
  STRUT_ELEMENT_SHORTEST, /* a stop of a member, which pushes below its shortest length */
  STRUT_ELEMENT_HINGE     /* the moment of a hinge */
} strut_element_role;

typedef struct strut_element {
  strut_strain_kind strain;
  strut_law_kind law;
  strut_element_role role;
  int32_t item;         /* member or hinge of the scene */
  int32_t first, nodes; /* its nodes: `nodes` entries of the table's `at`, from `first` on */
  int32_t slot;         /* where its natural strain stands in arrays of rest lengths; -1: fixed */
  double natural;       /* natural strain where there is no slot */
  int32_t place;        /* of its (2 nodes) (2 nodes + 1) / 2 entries among those of all elements */
  int32_t sibling;      /* the next element of the same member, or -1 */
  int8_t carries;       /* 1 tension only, -1 compression only, 0 both; only beyond e0 */
  double damping;       /* force per rate of e */
  strut_law_numbers numbers;
  /* an element with memory has a slot of its own, which follows that of its member or hinge */
  bool remembers;
  int32_t
      base; /* the slot that it follows; -1: its natural strain is `natural` before it has yielded */
  int32_t memory; /* place among the elements with memory */
} strut_element;

/** Elements begin .. end - 1, of one strain with one law. */
typedef struct strut_element_block {
  strut_strain_kind strain;
  strut_law_kind law;
  int32_t begin, end;
  bool both_signs; /* all of them carry both */
  bool remembers;  /* all of them have memory; otherwise none */
} strut_element_block;

/** Elements of one member or hinge that from some force or time on carry nothing. */
typedef struct strut_breakable {
  strut_element_role role; /* MEMBER or HINGE */
  int32_t item;            /* member or hinge of the scene */
  int32_t first;           /* its elements, chained by `sibling` */
  double force, time;      /* [N] or [N m], [s]; INFINITY: never */
} strut_breakable;

typedef struct strut_element_table {
  int32_t count, block_count;
  int32_t most_nodes;               /* of one element */
  int32_t entries;                  /* of the lower triangles of all elements' matrices */
  const strut_element *element;     /* (count) by blocks, in a block in the scene's order */
  const strut_element_block *block; /* (block_count) */
  const uint32_t *at;               /* where the nodes' x stand in coordinate arrays: 2 * node */
  const int32_t *of_member;         /* (members) first element of a member, or -1; NULL: none */
  int32_t memory_count, breakable_count;
  const int32_t *memory;            /* (memory_count) the elements with memory */
  const strut_breakable *breakable; /* (breakable_count) members, then hinges */
  /* (count) what vector loops read of elements, side by side; `at` is in the order of elements, too */
  const double *stiffness, *damping;
  const int32_t *slot;
} strut_element_table;

/** The first element of member j, or NULL for a plain member without stops. */
static inline const strut_element *strut_element_of_member(const strut_element_table *t,
                                                           int32_t j) {
  return t->of_member && t->of_member[j] >= 0 ? &t->element[t->of_member[j]] : NULL;
}

/** The element of hinge i. Found by a search, so not for the step. */
static inline int32_t strut_element_of_hinge(const strut_element_table *t, int32_t i) {
  int32_t k = 0;
  while (k < t->count && (t->element[k].role != STRUT_ELEMENT_HINGE || t->element[k].item != i))
    k++;
  return k < t->count ? k : -1;
}

/** Does an element take the place of the plain member j? */
static inline bool strut_member_is_element(const strut_element_table *t, int32_t j) {
  const strut_element *e = strut_element_of_member(t, j);
  return e && e->role == STRUT_ELEMENT_MEMBER;
}

#endif
