/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Copies of parts: where they lie, which names and parameters they see. Internal to parser/.
 * 
 * A placed part becomes entries of the scene's own mappings: `cell.3.foot` among the nodes, and so on. An
 * entry shares its text with the part, so that every message finds it there, and knows its copy. While a
 * thing of a copy is read, the copy is the reader's *scope*: names are looked up in it, parameters too,
 * and what has a direction or a length is turned and scaled with it.
 */
#pragma once

#include "parser/language/read/reader.h"

/** From a copy's coordinates to the scene's: x' = at + scale * axes x. */
typedef struct strut_frame {
  double axes[2][2]; /* a rotation, or one with a flip; its columns are the images of x and y */
  double scale, at[2];
} strut_frame;

STRUT_API extern const strut_frame strut_frame_of_scene;
/** The frame within another one. */
strut_frame strut_frame_within(const strut_frame *outer, const strut_frame *inner);
void strut_frame_point(const strut_frame *frame,
                       double point[2]); /* of lengths that are scaled already */
void strut_frame_vector(const strut_frame *frame, double vector[2]);

/** A part as the file describes it. */
typedef struct strut_part {
  const char *name;
  const strut_tree *key;
  strut_copy *home;    /* the copy within whose part it is described; NULL: the scene */
  strut_fields fields; /* of the section part */
  strut_part_keys keys;
  bool broken, placed, open; /* open: it is being copied */
} strut_part;

/** The parts that a scope describes. */
typedef struct strut_part_list {
  size_t count;
  strut_part *part;
} strut_part_list;

/** An entry of `place`. */
typedef struct strut_placement {
  const strut_tree *key;
  const char *name; /* in full: "a.2.wedge" */
  strut_part *part;
  int numbers; /* of a copy: 0, 1 or 2 */
  int64_t count[2];
} strut_placement;

typedef enum strut_scope_kind {
  STRUT_SCOPE_COPY,  /* the entries of a part */
  STRUT_SCOPE_PLACE, /* the keys of a placement, where i and j are the copy's numbers */
  STRUT_SCOPE_LINK /* the entries of `next`, with names of the copy and, as next.NAME, of the next one */
} strut_scope_kind;

struct strut_copy {
  strut_scope_kind kind;
  const strut_placement *placement;
  strut_copy *outer;  /* the scope in which the placement stands; NULL: the scene */
  strut_copy *home;   /* where other names are looked up; NULL: the scene */
  bool closed;        /* they are not */
  const char *prefix; /* "cell.3." */
  size_t prefix_length;
  int64_t number[2];
  int numbers;                 /* PLACE: how many of them are known */
  size_t node_begin, node_end; /* of its own among the entries of nodes */
  size_t parameter_count;
  strut_parameter_state *parameters;
  strut_part_list parts;
  strut_frame frame;            /* to the scene, */
  strut_frame within;           /* and to the scope around it, as far as it is known */
  struct strut_copy *made_next; /* the scope that was made after it */
  strut_copy *next;             /* LINK; NULL of one that is only seen from outside */
  const strut_tree *twist;      /* LINK that closes: {own: other}, or NULL */
};

/** What the next copy calls the node that the link's copy calls `text`. */
const char *strut_twisted(const strut_copy *link, const char *text);
/** The scope of a placed tree; else the reader's. */
strut_copy *strut_scope_of(const strut_reader *reader, const strut_tree *tree);

/** The name in the scene of what `text` means in a scope; NULL: there is no such name. */
enum { STRUT_LONGEST_NAME = 255 };
typedef struct strut_full_name {
  char text[2 * STRUT_LONGEST_NAME + 2];
} strut_full_name;

const strut_placement *strut_placement_find(const strut_reader *reader, const char *name);
/** The copy past whose ports a full name leads, where that is not around the scope; or NULL. */
const strut_copy *strut_name_hidden_by(const strut_reader *reader, const strut_copy *scope,
                                       const char *name);
/** Does a value name a thing of the structure from within a part, which knows its own things only? */
bool strut_within_part(const strut_reader *reader, const strut_tree *value,
                       const strut_name_map *map);
/** The part whose ports hide the node that a value names, or NULL. */
const char *strut_hiding_part(const strut_reader *reader, const strut_tree *value);
/** Why there is no thing of that name, as far as copies tell: "; 'cell' has the copies 0 to 2", or "". */
const char *strut_copy_hint(strut_reader *reader, const strut_tree *value);
const char *strut_copy_hint_of(strut_reader *reader, const char *name);
/** `last` in place of a number becomes that number. False: the name is too long. */
bool strut_name_resolve_last(const strut_reader *reader, const char *name, strut_full_name *full);
/** Does `name` fit a pattern in which * stands for one part between dots? */
bool strut_name_matches(const char *pattern, const char *name);

/** Does the scalar hold a *? */
bool strut_is_pattern(const strut_tree *name);
/** The node after `node` (-1: the first) whose name fits the pattern, or -1. */
int32_t strut_next_match(const strut_reader *reader, const strut_tree *pattern, int32_t node);

/** The notes of messages about copies, once all copies are read. */
void strut_note_copies(strut_reader *reader);

/** Reads `place` and makes the entries of all copies, in place of the scene's own ones. */
void strut_read_parts(strut_reader *reader);
/** Unites the nodes that `merge` names, once their positions are read. */
void strut_merge_nodes(strut_reader *reader);

/** Nodes that become one: by name, or all that touch within a scope. */
typedef struct strut_merger {
  strut_copy *scope;
  const strut_tree *a;     /* NULL: all that touch */
  strut_placed_tree b;     /* in another scope, maybe */
  const strut_tree *place; /* of touching; of `onto`, its key */
  struct strut_merger *next;
} strut_merger;

/** The section of the things in a mapping of the scene, or STRUT_SECTION_COUNT. */
strut_section strut_section_of_things(int scene_key);
/** Lays the mapping `over`, of the scene, on the value of a copied entry, whose head is its own. */
void strut_lay_over_placed(strut_reader *reader, strut_tree *value, const strut_tree *over,
                           strut_section section);

void strut_copies_free(strut_reader *reader);

/** A name by which a node of a copy is seen from outside. */
typedef struct strut_port {
  strut_copy *scope;
  const strut_tree *key; /* and behind it the name within */
  int32_t node;          /* once it is known, else -1 */
  struct strut_port *next;
} strut_port;

/** Things of the reader that only scenes with parts have. */
struct strut_copies {
  strut_name_map placement_names;
  size_t placement_count, placement_capacity;
  strut_placement **placements;
  strut_part_list parts; /* of the scene */
  strut_merger *mergers, **mergers_end;
  strut_name_map node_entries; /* names of nodes, for onto */
  size_t node_count, node_capacity;
  const strut_tree **nodes;
  size_t things;                     /* entries so far */
  int depth;                         /* parts within parts */
  const char *chain[17];             /* their names */
  const strut_tree *contacts;        /* the entries of the copies' contacts, or NULL */
  struct strut_copied_error *errors; /* see copies.c */
  strut_port *ports, **ports_end;    /* of inner copies before those around them */
  strut_name_map ported; /* copies whose part has ports, by their prefix without the dot */
  size_t ported_count, ported_capacity;
  const strut_copy **ported_copies;
  bool incomplete;        /* some copies could not be made */
  strut_name_map removed; /* names of things that the scene takes away */
};

/* ---- while parts are expanded: for the files that do so ---- */

#define STRUT_MOST_COPIES 2e6
enum { STRUT_DEEPEST_PARTS = 16 };

/** Entries of the copies for one key of the scene. */
typedef struct strut_entry_list {
  strut_tree *first, *last; /* the last value */
  size_t count;
} strut_entry_list;

typedef struct strut_expansion {
  strut_reader *reader;
  struct strut_copies *copies;
  strut_entry_list list[STRUT_MOST_KEYS]; /* of the keys of the scene */
  strut_entry_list contacts;
  bool stopped;
  strut_copy *latest; /* the scope that was made last */
} strut_expansion;

typedef struct strut_repetition {
  int numbers; /* 0: no repetition */
  int64_t count[2];
  double step[2][2], turn, scale, about[2];
  const strut_tree *next[2], *twist;
  bool closed;
} strut_repetition;

typedef struct strut_placing {
  strut_placement *placement;
  strut_copy *outer;
  strut_fields fields;
  strut_place_keys keys;
  strut_repetition repeat;
  strut_fields next[2]; /* of `repeat`, in each direction that it gives */
  bool varies;          /* some key mentions the copy's number */
} strut_placing;

/* place_frame.c */

/** Reads `repeat` of the placement of that name; absent: one copy without a number. */
bool strut_read_repeat(strut_reader *reader, const strut_slot *slot, const char *name,
                       strut_repetition *repeat);
/** The frame of a copy by its numbers, within that of the first. */
strut_frame strut_repeated_frame(const strut_repetition *repeat, const int64_t number[2]);

/** Enters the node under its full name, so that `onto` finds it. */
void strut_remember_node(strut_expansion *expansion, const strut_tree *key);
/** Copies all entries of the fields of a part, or of `next`, into a scope. */
void strut_copy_things(strut_expansion *expansion, strut_fields *fields, strut_copy *scope);
size_t strut_count_things(strut_fields *fields);
/** Adds nodes to be merged: one of the scope with that of another, or, with NULL, all that touch within it. */
void strut_add_merger(strut_expansion *expansion, strut_copy *scope, const strut_tree *own,
                      strut_copy *beyond, const strut_tree *other, const strut_tree *place);
/** Reads `merge`: `touching`, or a mapping of names. */
void strut_read_merge(strut_expansion *expansion, const strut_tree *value, strut_copy *scope,
                      int key);
/** Lays the scene's own entries of a key over those of the copies, and joins both. */
void strut_join_entries(strut_expansion *expansion, int key);

/** The frame of the first copy by the placement's own keys; false: it was reported. */
bool strut_read_frame(strut_expansion *expansion, strut_placing *placing, strut_copy *copy,
                      strut_frame *frame);
