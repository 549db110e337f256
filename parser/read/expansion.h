/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the files that expand parts share; nobody else includes it. See copies.h.
 */
#ifndef STRUT_PARSER_READ_EXPANSION_H
#define STRUT_PARSER_READ_EXPANSION_H

#include "parser/read/copies.h"

/** Most copies of one placement. */
#define STRUT_MOST_COPIES 2e6
/** Most parts within parts. */
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
  bool weighing; /* nothing is copied yet */
  bool stopped;
} strut_expansion;

/** What `repeat` says. */
typedef struct strut_repetition {
  int numbers; /* 0: no repetition */
  int64_t count[2];
  double step[2][2], turn, scale, about[2];
  const strut_tree *next[2], *twist;
  bool closed;
} strut_repetition;

/** One placement while its copies are made. */
typedef struct strut_placing {
  strut_placement *placement;
  strut_copy *outer;
  strut_fields fields;
  strut_repetition repeat;
  strut_fields next[2]; /* of `repeat`, in each direction that it gives */
  bool varies;          /* some key mentions the copy's number */
} strut_placing;

/* read_parts.c */

/** The keys of a placement. False: it cannot be copied, which was reported. */
bool strut_read_placement(strut_expansion *e, const strut_tree *key, strut_copy *outer,
                          strut_placing *p);
/**
 * The scopes of one copy, and what it holds. *base is the frame of the first copy, which is made before
 * others; *place_scope that of the placement's keys. NULL: it could not be made.
 */
strut_copy *strut_make_copy(strut_expansion *e, strut_placing *p, const int64_t number[2],
                            strut_frame *base, strut_copy **place_scope);

/* repeat.c */

/** Reports a value of another form than the key has; returns false. */
bool strut_refuse_form(strut_reader *reader, int key, const strut_tree *value, strut_owner owner);
/** Reads `repeat` of the placement of that name; absent: one copy without a number. */
bool strut_read_repeat(strut_reader *reader, const strut_slot *slot, const char *name,
                       strut_repetition *repeat);
/** Turns the axes of the scene by an angle [rad]. */
void strut_frame_turn(strut_frame *frame, double angle);
/** The frame of a copy by its numbers, within that of the first. */
strut_frame strut_repeated_frame(const strut_repetition *repeat, const int64_t number[2]);

/* copy_entries.c */

/** Enters the node under its full name, so that `onto` finds it. */
void strut_remember_node(strut_expansion *e, const strut_tree *key);
/** Copies all entries of the fields of a part, or of `next`, into a scope. */
void strut_copy_things(strut_expansion *e, strut_fields *fields, strut_copy *scope);
size_t strut_count_things(strut_fields *fields);
/** Adds nodes to be merged: two names in a scope, or, with NULL, all that touch within it. */
void strut_add_merger(strut_expansion *e, strut_copy *scope, const strut_tree *a,
                      const strut_tree *b, const strut_tree *place);
/** Reads `merge`: `touching`, or a mapping of names. */
void strut_read_merge(strut_expansion *e, const strut_slot *slot, strut_copy *scope, int key);
/** Lays the scene's own entries of a key over those of the copies, and joins both. */
void strut_join_entries(strut_expansion *e, int key);

/* place_frame.c */

/**
 * Where the node of a copy lies that `name` means, one of a part placed within it too, in the coordinates
 * that the copy's frame leads to. False: there is none, or a part on the way is laid onto others.
 */
bool strut_find_in_copy(strut_expansion *e, strut_copy *copy, const char *name, double position[2]);
/** The frame of the first copy by the placement's own keys; false: it was reported. */
bool strut_read_frame(strut_expansion *e, strut_placing *p, strut_copy *copy, strut_frame *frame);

#endif
