/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Elements: forces that are a strain with a law.
 *
 * A strain is one number e made of the positions of a few nodes (engine/forces/strains); a law is the
 * force that works on it (engine/scene/laws). A plain member, `length` with the linear law, is stepped
 * by the vector kernel from the member table instead. All other pairs are elements: members that run
 * over guides, with other laws or with stops, hinges, cells, and collisions.
 */
#pragma once

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "engine/scene/scene.h"
#include "engine/scene/things.h"

/**
 * The strains: X(NAME, name, unit, reference, context); context is passed on. reference: the numbers that its
 * function takes beside the positions: TURN, the strain before, AXIS, the element's direction, or ARC, that and
 * its radius.
 */
#define STRUT_STRAINS(X, context)                                                                  \
  X(LENGTH, length, "m", TURN, context)                                                            \
  X(PATH, path, "m", TURN, context)                                                                \
  X(WRAP, wrap, "m", ARC, context)                                                                 \
  X(ANGLE, angle, "rad", TURN, context)                                                            \
  X(AREA, area, "m^2", TURN, context)                                                              \
  X(REACH, reach, "m", TURN, context)                                                              \
  X(ALONG, along, "m", AXIS, context)                                                              \
  X(OFFSET, offset, "m", TURN, context)                                                            \
  X(FOOT, foot, "m", ARC, context)

typedef enum strut_strain_kind {
#define STRUT_STRAIN_ROW(NAME, ...) STRUT_STRAIN_##NAME,
  STRUT_STRAINS(STRUT_STRAIN_ROW, ) STRUT_STRAIN_COUNT
} strut_strain_kind;

/** What an element is in the scene. */
typedef enum strut_element_role {
  STRUT_ELEMENT_MEMBER,   /* the force of a member */
  STRUT_ELEMENT_LONGEST,  /* a stop of a member, which pulls beyond its longest length */
  STRUT_ELEMENT_SHORTEST, /* a stop of a member, which pushes below its shortest length */
  STRUT_ELEMENT_HINGE,    /* the moment of a hinge */
  STRUT_ELEMENT_CELL,     /* the pressure in a cell */
  STRUT_ELEMENT_COLLISION, /* what two bodies exert on each other; of two members it has four elements */
  STRUT_ELEMENT_DISTANCE, /* the force of a distance */
  STRUT_ELEMENT_LOAD,     /* a load that is a couple; its slot holds the moment */
  STRUT_ELEMENT_FOOT,     /* what a ground presses a foot with */
  STRUT_ELEMENT_CONTACT /* what it presses a node with that it holds by bristles: a foot without an arc */
} strut_element_role;

typedef struct strut_element {
  strut_strain_kind strain;
  strut_law_kind law;
  strut_element_role role;
  int32_t item;         /* member, hinge, ... of the scene */
  int32_t first, nodes; /* its nodes: `nodes` entries of the table's `at`, from `first` on */
  int32_t slot;         /* index of its natural strain in arrays of rest lengths; -1: fixed */
  double natural;       /* natural strain where there is no slot */
  double
      axis; /* of `along` and `foot`: tangent of half the angle of a direction; of `wrap`: bit k where
                           guide k is to the right */
  double radius;   /* of `foot` and `wrap` [m] */
  int32_t contact; /* of a foot, or a node with bristles: that of the node with the ground */
  int32_t place;   /* of its (2 nodes) (2 nodes + 1) / 2 entries among those of all elements */
  int32_t sibling; /* the next element of the same member, or -1 */
  int8_t carries;  /* 1 tension only, -1 compression only, 0 both; only beyond e0 */
  double damping;  /* force per rate of e */
  strut_law_numbers numbers;
  /* an element with memory has a slot of its own, which follows that of its member or hinge */
  bool remembers;
  bool crowds; /* of so many collisions, one of those that may act at once; see mark_crowd */
  int32_t
      base; /* the slot that it follows; -1: its natural strain is `natural` before it has yielded */
  int32_t memory; /* place among the elements with memory */
  double
      guide_friction; /* of a running cable whose materials stand behind its slot, see capstan.h */
} strut_element;

/** What an element on a curve that folds remembers, in the slots from its own on. */
enum {
  STRUT_CURVE_PIECE = 1, /* the piece on which it is */
  STRUT_CURVE_JUMPS,     /* how often it has jumped over a fold in a run */
  STRUT_CURVE_LAST,      /* when it did so last [s] */
  STRUT_CURVE_FREED,     /* energy that this set free in all [J] */
  STRUT_CURVE_SLOTS      /* with the one of its natural strain */
};

/** Elements begin .. end - 1, of one strain with one law. */
typedef struct strut_element_block {
  strut_strain_kind strain;
  strut_law_kind law;
  int32_t begin, end;
  bool remembers; /* all of them have memory; otherwise none */
  bool collides;  /* some of them are of collisions */
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
  int32_t most_nodes; /* of one element */
  bool scattered;     /* collisions are so many that few act at a time: see forces/nearby.h */
  int32_t entries;    /* of the lower triangles of all elements' matrices */
  const strut_element *element;     /* (count) by blocks, in a block in the scene's order */
  const strut_element_block *block; /* (block_count) */
  const uint32_t *at;               /* where the nodes' x stand in coordinate arrays: 2 * node */
  const int32_t *of_member;         /* (members) first element of a member, or -1; NULL: none */
  int32_t couples;                  /* elements of loads */
  int32_t history_count, breakable_count;
  const int32_t *memory;               /* (history_count) the elements with memory */
  int32_t history_slot, history_slots; /* the first of their slots, and how many there are */
  const strut_breakable *breakable;    /* (breakable_count) members, then hinges */
  /* (count) what vector loops read of elements, side by side; `at` is in the order of elements, too */
  const double *stiffness, *damping;
  const int32_t *slot;
} strut_element_table;

/** The first element of member j, or NULL for a plain member without stops. */
static inline const strut_element *strut_element_of_member(const strut_element_table *elements,
                                                           int32_t j) {
  return elements->of_member && elements->of_member[j] >= 0
             ? &elements->element[elements->of_member[j]]
             : NULL;
}

/** Index of the first element of an item in that role, looked for from element `near` on; -1: it has none. */
static inline int32_t strut_element_find_near(const strut_element_table *elements,
                                              strut_element_role role, int32_t item, int32_t near) {
  for (int32_t i = 0, k = near; i < elements->count; i++, k = k + 1 < elements->count ? k + 1 : 0)
    if (elements->element[k].role == role && elements->element[k].item == item) return k;
  return -1;
}

static inline int32_t strut_element_find(const strut_element_table *elements,
                                         strut_element_role role, int32_t item) {
  return strut_element_find_near(elements, role, item, 0);
}

/** The element behind the last one of the same item; elements of a collision follow each other. */
static inline int32_t strut_element_end(const strut_element_table *elements, int32_t first) {
  assert(first >= 0 && first < elements->count);
  int32_t k = first;
  while (k < elements->count && elements->element[k].role == elements->element[first].role &&
         elements->element[k].item == elements->element[first].item)
    k++;
  return k;
}

/** Is it the force or a stop of a member? */
static inline bool strut_element_is_of_member(const strut_element *element) {
  return element->role == STRUT_ELEMENT_MEMBER || element->role == STRUT_ELEMENT_LONGEST ||
         element->role == STRUT_ELEMENT_SHORTEST;
}

/** The kind of thing that elements of a role belong to. */
static inline strut_thing strut_element_thing(strut_element_role role) {
  switch (role) {
    case STRUT_ELEMENT_HINGE: return STRUT_THING_HINGE;
    case STRUT_ELEMENT_CELL: return STRUT_THING_CELL;
    case STRUT_ELEMENT_COLLISION: return STRUT_THING_COLLISION;
    case STRUT_ELEMENT_DISTANCE: return STRUT_THING_DISTANCE;
    case STRUT_ELEMENT_LOAD: return STRUT_THING_LOAD;
    case STRUT_ELEMENT_FOOT: return STRUT_THING_FOOT;
    case STRUT_ELEMENT_CONTACT: return STRUT_THING_CONTACT;
    case STRUT_ELEMENT_MEMBER:
    case STRUT_ELEMENT_LONGEST:
    case STRUT_ELEMENT_SHORTEST: break;
  }
  return STRUT_THING_MEMBER;
}

/** The name of the thing that the element belongs to. */
static inline const char *strut_element_name(const strut_scene *scene,
                                             const strut_element *element) {
  if (element->role == STRUT_ELEMENT_CONTACT)
    return scene->nodes[scene->contacts[element->item].node].name;
  return strut_thing_name(scene, strut_element_thing(element->role), (size_t)element->item);
}

/** The natural strain in the unit of the strain: the laws of cells have a pressure there instead. */
static inline double strut_element_origin(const strut_element *element, double natural) {
  return strut_law_is_of_cells(element->law) ? 0.0 : natural;
}

/** The angle near which an element's is taken at first. A couple leans, so that it may turn by just half a turn. */
static inline double strut_element_near(const strut_element *element, double natural) {
  return element->role == STRUT_ELEMENT_LOAD ? element->numbers.area + copysign(0.1, natural)
                                             : natural;
}

/** Does an element take the place of the plain member j? */
static inline bool strut_member_is_element(const strut_element_table *elements, int32_t j) {
  const strut_element *element = strut_element_of_member(elements, j);
  return element && element->role == STRUT_ELEMENT_MEMBER;
}

/* Actuators that give a force or a moment instead of a rest length or a rest angle.
 *
 * The force acts along the gradient of a strain, the length of a member or the angle of a hinge, beside
 * whatever the member or hinge exerts itself.
 */

typedef struct strut_actuator_force {
  strut_strain_kind strain; /* length, path or angle */
  int32_t member, hinge;    /* of the scene; the other one is -1 */
  int32_t signal;
  int32_t first, nodes; /* its nodes: `nodes` entries of the table's `at`, from `first` on */
} strut_actuator_force;

typedef struct strut_actuator_force_table {
  int32_t count;
  const strut_actuator_force *item; /* (count) in the scene's order */
  const uint32_t *at;               /* where the nodes' x stand in coordinate arrays: 2 * node */
} strut_actuator_force_table;
