/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the parts of the scene reader share. Internal to parser/.
 *
 * Every mapping is read in two passes: strut_read_fields turns its keys into *fields*, by the table of keys alone; then
 * the part that knows the thing takes its values from there. A value that cannot be read is reported and marked BROKEN;
 * nothing that depends on it is reported, so that one mistake gives one message.
 */
#pragma once

#include "engine/base/name_map.h"
#include "engine/scene/checks/check.h"
#include "engine/scene/experiment.h"
#include "parser/language/expression/expression.h"
#include "parser/language/keys/keys.h"
#include "parser/language/read/read_scene.h"
#include "parser/language/read/reuse/used_files.h"
#include "parser/language/yaml/document.h"

/** The subject of a message: "member 'm1'", or "the solver" where name is NULL. */
typedef struct strut_owner {
  const char *kind, *name;
} strut_owner;

typedef enum strut_slot_state { STRUT_ABSENT, STRUT_GIVEN, STRUT_BROKEN } strut_slot_state;

/** The value of one key, as far as the table determines it. */
typedef struct strut_slot {
  strut_slot_state state;
  int word;                      /* WORD: its index; FIXED: 1 x, 2 y */
  uint64_t words;                /* WORDS: a bit for each */
  double number[2];              /* NUMBER, PAIR; SI */
  const strut_tree *key, *value; /* its place in the tree */
  struct strut_group_item *from; /* the group's key that gave it; NULL: its own */
} strut_slot;

/** The keys of one mapping. */
typedef struct strut_fields {
  strut_section section;
  strut_owner owner;          /* what messages call it */
  bool broken;                /* some value, or the mapping itself, could not be read */
  bool strange;               /* it has an unknown key, which may mean any that is missing */
  bool unresolved;            /* a thing that it must name is not known */
  const strut_tree *map;      /* NULL: the mapping is absent */
  const strut_tree *key;      /* whose value it is, where reading needs its place */
  struct strut_fields *outer; /* of the mapping around it, where its keys depend on that; or NULL */
  strut_slot slot[STRUT_MOST_KEYS];
} strut_fields;

/** One key of a group, and its number in each section that may use the group. */
typedef struct strut_group_item {
  strut_slot slot;
  int key[STRUT_GROUP_SECTIONS];      /* -1: not there */
  bool refused[STRUT_GROUP_SECTIONS]; /* it has been reported that the section has no such key */
  bool found;                         /* a finding has been reported here */
  strut_fields *nested;               /* of a mapping: friction */
  int first;                          /* the key of the first section that has it */
  bool apart;                         /* hinges measure it by another unit: */
  strut_slot of_hinge;
} strut_group_item;

typedef struct strut_group {
  const char *name;
  const strut_tree *key;
  size_t count;
  strut_group_item *items;
  bool used, broken;
} strut_group;

/** A copy of a part as the scope of what is read, see copies.h. */
typedef struct strut_copy strut_copy;

/** Where the value of a part's parameter is read. */
typedef struct strut_part_value {
  strut_copy *scope;
  const strut_tree *given; /* in `set` of the placement, or NULL; read in the scope: */
  strut_copy *given_scope;
} strut_part_value;

/** A parameter while parameters are being evaluated. */
typedef struct strut_parameter_state {
  const char *name;
  const strut_setting *set; /* given from outside, or NULL */
  const strut_tree *key, *value;
  enum { STRUT_UNREAD, STRUT_READING, STRUT_READ, STRUT_FAILED } state;
  bool text;
  bool used;      /* something refers to it */
  bool ambiguous; /* it has been reported that a unit has its name */
  strut_quantity quantity;
  strut_part_value *of_part; /* NULL: it is the scene's */
} strut_parameter_state;

/** What others may know of it; the texts are the tree's. */
strut_declared strut_declaration_of(const strut_parameter_state *parameter);

/** A named thing: its place, and whether it was read completely, so that findings about it make sense. */
typedef struct strut_source {
  const strut_tree *key, *value;
  bool broken;
} strut_source;

/** The things of one kind that were read. */
typedef struct strut_things_read {
  strut_name_map names;
  strut_source *source; /* of each; NULL: there are none */
} strut_things_read;

/** A signal of the scene under construction: what its values measure. */
typedef struct strut_signal_state {
  strut_dimension dimension;
  bool bare; /* made of plain numbers, and nothing has used it yet */
  const strut_tree *value;
  const strut_tree *gain; /* of a controller whose gain has no unit; NULL otherwise */
} strut_signal_state;

/** A signal with a name. */
typedef struct strut_named_signal {
  const char *name;
  const strut_tree *key;
  enum { STRUT_SIGNAL_UNREAD, STRUT_SIGNAL_READING, STRUT_SIGNAL_READ } state;
  int32_t index;   /* into the signals; -1: it could not be read */
  bool controller; /* it stands under `controllers` */
} strut_named_signal;

/** Longest chains of parameters and of signals that refer to each other. */
enum { STRUT_DEEPEST_PARAMETER = 200, STRUT_DEEPEST_SIGNAL = 64 };

/** An actuator that stands for an end of a pipe: it drives the cell by the signal. */
typedef struct strut_pipe_drive {
  const strut_tree *key; /* of the pipe */
  const char *end;       /* "in" or "out" */
  int32_t cell, signal;
} strut_pipe_drive;

typedef struct strut_reader {
  strut_setup *setup; /* what is read, in its two parts: */
  strut_scene *scene;
  strut_experiment *experiment;
  strut_diagnostics *diagnostics;
  strut_document document;
  strut_arena scratch; /* freed with the reader */
  strut_arena *keep;   /* of what outlives it: the scene's, or a study's */
  strut_purpose purpose;
  strut_fields top;
  strut_things_read things[STRUT_THING_COUNT]; /* signals: their names are the next ones */
  strut_name_map signal_names, group_names, parameter_names;
  strut_group *groups;
  size_t group_count;
  strut_parameter_state *parameters;
  size_t parameter_count, parameter_depth;
  strut_parameter_state *parameter_stack[STRUT_DEEPEST_PARAMETER]; /* being read */
  strut_dimension *state_dimension;                                /* (states) */
  size_t pipe_drive_count;
  struct strut_pipe_drive *pipe_drives; /* actuators that pipes stand for */
  strut_named_signal *named;
  size_t named_count, signal_depth, signal_capacity;
  strut_named_signal *signal_stack[STRUT_DEEPEST_SIGNAL]; /* being read */
  strut_signal *signals;         /* strut_allocate; moves to the scene at the end */
  const strut_tree **node_moves; /* (node_count) the keys of moves of a node, or NULL */
  strut_signal_state *signal_state;
  double limit_things;         /* entries of all copies, and of beams, that are allowed */
  const char *signal_quantity; /* what the signal that is being read gives, for messages, or NULL */
  size_t signal_count;
  strut_fields ground, initial, settle, search, solver, run, measure, steady, output;
  const strut_tree *asking; /* the value whose expression is being evaluated */
  const char *asking_set;   /* or the parameter whose setting is */
  unsigned spellings;       /* one bit for each former name that was noted */
  size_t suggestions;       /* names compared so far, to bound the effort */
  strut_beam *beams;        /* (beam_count) those that could be read */
  size_t beam_count;
  bool holes;          /* refused parts are missing from the tree: absent keys are not reported */
  bool ends_unknown;   /* some member or load could not be tied to its nodes */
  bool masses_unknown; /* some mass could not be read */
  bool groups_unknown; /* of some thing: not read, or named by a parameter */
  bool failed, out_of_memory;
  strut_fields *grounds;       /* of each of the scene's grounds; of `ground` the one above */
  strut_copy *scope;           /* the copy of which a thing is being read; NULL: the scene's own */
  struct strut_copies *copies; /* NULL: the scene has no parts */
  size_t table_count;
  const strut_data_table *tables; /* measured data; NULL: not read yet, or none */
  bool tables_unknown;            /* some could not be read */
} strut_reader;

void strut_require_nodes(strut_reader *reader);
/** Some things of the scene are missing: what refers to them is not reported. */
void strut_mark_incomplete(strut_reader *reader);
/** Is this the tree of a study? As a model it would be wrong in every line. */
bool strut_tree_is_study(const strut_tree *root);

/* read_values.c: messages and single values */

/**
 * Reports at a place. Once the diagnostics are full a message is only counted, and the functions below
 * that make its parts return "". Returns false, for `return strut_report_error(...)`.
 */
bool strut_report_error(strut_reader *reader, strut_place place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/** Reports a text that is there already; of those with one `origin` at one place, those of further copies are counted. */
void strut_report_text(strut_reader *reader, strut_place place, const char *origin,
                       const char *text);
/** "member 'm1'", for use within a message; lives in scratch. */
const char *strut_owner_text(strut_reader *reader, strut_owner owner);
/** "the law of member 'm1'", as the subject of messages about what is within it; its text lives in scratch. */
strut_owner strut_owner_within(strut_reader *reader, const char *what, strut_owner owner);
/** Text from the file, shortened and without control characters; lives in scratch. */
const char *strut_sanitised_text(strut_reader *reader, const char *text);
/** What may be said of reader->limit_things where that is too little: "; 'limit_things' of ...", or "". */
const char *strut_limit_hint(strut_reader *reader);
/** "; did you mean 'x'?" or "": the nearest of these names; lives in scratch. */
const char *strut_hint(strut_reader *reader, const char *word, strut_names *names,
                       const void *context);
const char *strut_hint_of_rows(strut_reader *reader, const char *word,
                               const strut_named_rows *rows);
/** "; the names here are 'a', 'b'" where they are few, or ""; lives in scratch. */
const char *strut_list_names(strut_reader *reader, strut_names *names, const void *context);
/** True while suggestions may still be looked for: they are bounded for the file as a whole. */
bool strut_hints_left(const strut_reader *reader);
/** "a list of 3", "a mapping", "nothing", "'text'": the value in a message; lives in scratch. */
const char *strut_found(strut_reader *reader, const strut_tree *value);
/** A text of at most 1199 bytes in the arena; never NULL, since the reader remembers when memory is out. */
const char *strut_formatted(strut_reader *reader, strut_arena *arena, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
#define strut_scratch_text(reader, ...) strut_formatted(reader, &(reader)->scratch, __VA_ARGS__)
#define strut_kept_text(reader, ...) strut_formatted(reader, (reader)->keep, __VA_ARGS__)
/** A copy of the piece, in scratch. */
const char *strut_piece_text(strut_reader *reader, strut_piece piece);
/** The unit of a dimension, "kg m s^-2", where it is kept; `none` of one without. */
const char *strut_keep_unit(strut_reader *reader, strut_dimension dimension, const char *none);
/** The beginning of the file, for what is about all of it. */
strut_place strut_root_place(const strut_reader *reader);
/** "a -> b -> a" from the names of a stack, shortened in the middle; lives in scratch. */
const char *strut_format_cycle(strut_reader *reader, const char *(*name)(strut_reader *, size_t),
                               size_t first, size_t depth);
/** True for a plain text such as `mass:1 kg`, which lacks the space that would make it a key. */
bool strut_lacks_space(const strut_tree *value);
/** The same of a text whose key would be `name`. */
bool strut_lacks_space_after(const strut_tree *value, const char *name);
/** Reports "expected EXPECTED for 'KEY' of OWNER, found VALUE"; returns false. */
bool strut_refuse_value(strut_reader *reader, const strut_tree *value, const char *key,
                        strut_owner owner, const char *expected);
/** Is it a scalar that is not null? If not, that is reported. */
bool strut_read_scalar(strut_reader *reader, const strut_tree *value, const char *key,
                       strut_owner owner, const char *expected);
bool strut_read_quantity(strut_reader *reader, const strut_tree *value, const char *key,
                         strut_owner owner, strut_quantity *quantity);
/** The same of a value that may be no scalar, which is reported; `expected` says what it should be. */
bool strut_read_any_quantity(strut_reader *reader, const strut_tree *value, const char *key,
                             strut_owner owner, const char *expected, strut_quantity *quantity);
/** Reports a quantity of another dimension than is `expected`. */
bool strut_refuse_dimension(strut_reader *reader, const strut_tree *value, const char *key,
                            strut_owner owner, const char *expected, strut_dimension found);
/** The same of an expression of columns, whose program the compiler makes. */
bool strut_read_program(strut_reader *reader, const strut_tree *value, const char *key,
                        strut_owner owner, strut_compiler *compiler, strut_quantity *quantity);
/** A number of the given dimension in SI. */
bool strut_read_number(strut_reader *reader, const strut_tree *value, const char *key,
                       strut_owner owner, strut_dimension dimension, strut_key_limits limits,
                       double *number);
/** Is the number within the limits? If not, that is reported. */
bool strut_check_limits(strut_reader *reader, const strut_tree *value, const char *key,
                        strut_owner owner, strut_key_limits limits, double number);
bool strut_read_pair(strut_reader *reader, const strut_tree *value, const char *key,
                     strut_owner owner, strut_dimension dimension, double number[2]);
/** Things that a name may refer to. */
typedef struct strut_namespace {
  const char *kind; /* "node", "group", ... */
  const strut_name_map *map;
  strut_names *name; /* of number i, for suggestions */
  const void *context;
} strut_namespace;

/** The index of what the scalar names, or -1, which was reported. */
int32_t strut_read_name_of(strut_reader *reader, const strut_tree *value, const char *key,
                           strut_owner owner, const strut_namespace *names);
/** The same of a thing of the scene; -1 without a message where the things of that kind could not be read. */
int32_t strut_read_reference(strut_reader *reader, const strut_tree *value, const char *key,
                             strut_owner owner, strut_thing kind);
/** "; did you mean 'x'?" or "" for the name of a thing. */
const char *strut_hint_of_things(strut_reader *reader, const char *word, strut_thing kind);
/** Is the name allowed? If not, that is reported. */
bool strut_read_name(strut_reader *reader, const strut_tree *key, const char *kind);
/** Adds a name to a map; remembers when memory is out. */
void strut_add_name(strut_reader *reader, strut_name_map *map, const char *name, size_t index);
/** Makes room for so many names in a map; remembers when memory is out. */
void strut_reserve_names(strut_reader *reader, strut_name_map *map, size_t count);
/** count * size zeroed bytes of what is kept, or of scratch; the reader remembers when memory is out. */
void *strut_keep_array(strut_reader *reader, size_t count, size_t size);
void *strut_scratch_array(strut_reader *reader, size_t count, size_t size);

/**
 * The index of the next thing of an array. Once the diagnostics are full, things are read for their
 * errors only, all into the same place behind the last one that is kept, and without names.
 */
size_t strut_next_entry(const strut_reader *reader, size_t *count);

void strut_reader_target(strut_reader *reader, strut_setup *setup);
/** A copy that outlives the reader; "" if memory is out. */
const char *strut_keep_text(strut_reader *reader, const char *text);

/* copies.c: the scope in which a thing is read; without parts all of this does nothing */

/** The first entry of a mapping of names to things (NULL: none), and the one after; enter its scope. */
const strut_tree *strut_first_entry(strut_reader *reader, const strut_tree *map);
const strut_tree *strut_following_entry(strut_reader *reader, const strut_tree *key);
/** Each entry, as `key`. */
#define STRUT_ENTRIES(reader, key, map)                                                            \
  for (const strut_tree *(key) = strut_first_entry(reader, map); key;                              \
       (key) = strut_following_entry(reader, key))
/** Enters the scope of an entry; returns the one before. */
strut_copy *strut_enter_scope(strut_reader *reader, const strut_tree *key);
/** The index of what `text`, or the text parameter of that name, names in the scope of `value` (NULL: of the reader), or -1. */
int32_t strut_find_named(const strut_reader *reader, const strut_name_map *map,
                         const strut_tree *value, const char *text);
/** The same without parameters. */
int32_t strut_find_literally(const strut_reader *reader, const strut_name_map *map,
                             const strut_tree *value, const char *text);
/** The first of a thing of the scene. */
static inline int32_t strut_find_thing(const strut_reader *reader, strut_thing kind,
                                       const strut_tree *value, const char *text) {
  return strut_find_named(reader, &reader->things[kind].names, value, text);
}
/** The name within the reader's scope of one of its things. */
const char *strut_local_name(const strut_reader *reader, const char *name);
/** Lengths that stand in the scope of `value` are multiplied by this. */
double strut_scope_scale(const strut_reader *reader, const strut_tree *value);
/** From the scope of `value` to the scene: a point [m] scaled already, and the direction of a vector. */
void strut_place_point(const strut_reader *reader, const strut_tree *value, double point[2]);
void strut_place_vector(const strut_reader *reader, const strut_tree *value, double vector[2]);
bool strut_scope_flips(const strut_reader *reader);
/** The scene's axis (0: x) along which one of the scope's lies, or -1; *reversed: against it. */
int strut_scope_axis(const strut_reader *reader, int axis, bool *reversed);
/** Was this said about another copy? Then it is counted, and not to be reported again. */
bool strut_error_is_repeated(strut_reader *reader, strut_place place, const char *format);
/** Remembers that it was reported as the latest message. */
void strut_error_remember(strut_reader *reader, strut_place place, const char *format);

/* read_fields.c: mappings */

/** Reads a mapping by the table. A value that is not a mapping is reported. */
void strut_read_fields(strut_reader *reader, strut_section section, const strut_tree *map,
                       strut_owner owner, strut_fields *fields);
/** Reports what is required and absent, at the place given. */
void strut_require(strut_reader *reader, strut_fields *fields, strut_place place);
/** One of the words of `key`; false for another text, which was reported. */
bool strut_read_word(strut_reader *reader, const strut_key *key, const strut_tree *value,
                     strut_owner owner, int *word);
/** Reports a value of another form than the key has; returns false. */
bool strut_refuse_form(strut_reader *reader, int key, const strut_tree *value, strut_owner owner);
/** Reads a value by the table's line for the key. */
void strut_read_slot(strut_reader *reader, int key, const strut_tree *key_tree,
                     const strut_tree *value, strut_owner owner, strut_slot *slot);
/** The key of that name in a section, or -1; a former name is accepted with a note. */
int strut_key_named(strut_reader *reader, strut_section section, const strut_tree *key);
/** The slot of a key: fields->section must be the key's. */
strut_slot *strut_slot_of(strut_fields *fields, int key);
/** The value of a key that is given and could be read, else NULL. */
const strut_tree *strut_given(strut_fields *fields, int key);
/** Is the key there, whether or not its value could be read? */
static inline bool strut_mentions(strut_fields *fields, int key) {
  return strut_slot_of(fields, key)->state != STRUT_ABSENT;
}
/** Reports an unknown key; returns the key of the sections that was probably meant, or -1. */
int strut_unknown_key(strut_reader *reader, const strut_tree *key, const strut_section *sections,
                      size_t count, strut_owner owner);
/** The mapping behind a key, with the place of the key in `fields`. */
void strut_read_fields_of(strut_reader *reader, strut_section section, const strut_tree *key,
                          strut_owner owner, strut_fields *fields);
/** Marks every absent key as broken, so that none is reported as missing. */
void strut_suppress_missing(strut_fields *fields);
/** Reads the mapping of a key of the scene; true if it is present and a mapping. */
bool strut_read_section(strut_reader *reader, int key, strut_section section, const char *owner,
                        strut_fields *fields);
/** The mapping of names to things that is the value of a key of the scene, or NULL. */
const strut_tree *strut_entries(strut_reader *reader, int key);
size_t strut_entry_count(strut_reader *reader, int key);

/**
 * Reports keys that mean nothing without another one, of which those of a group or of a base become absent, and what
 * breaks STRUT_KEY_RULES. False: something does; then the fields are broken.
 */
bool strut_check_rules(strut_reader *reader, strut_fields *fields);
/** What a study must compute for a key of it to mean anything, "modes|path"; NULL: anything. */
const char *strut_study_key_computes(int key);

/* read_things.c: values into objects */

/**
 * Stores what could be read in the section's object by the rows of its keys, texts in the arena: values, indices of
 * things, signals, lists and nested mappings; then what the section's own code adds (strut_section_reader). Numbers
 * whose unit depends on the context are left to the caller. False: some of it could not be read.
 */
bool strut_store_fields(strut_reader *reader, strut_fields *fields, void *object,
                        size_t object_size);
/** The same of a whole object, whose type is that of the section; texts in the reader's memory for what it keeps. */
#define strut_store(reader, fields, object)                                                        \
  strut_store_fields(reader, fields, object, sizeof *(object))
/** Reads a mapping with all that it requires, and stores it. False: some of it could not be read. */
bool strut_read_sized_object(strut_reader *reader, strut_section section, const strut_tree *map,
                             strut_owner owner, strut_fields *fields, void *object, size_t size);
#define strut_read_object(reader, section, map, owner, fields, object)                             \
  strut_read_sized_object(reader, section, map, owner, fields, object, sizeof *(object))
/** Stores the value of a key that is given, by its row; `dimension` is that of a number. */
bool strut_store_number(strut_reader *reader, strut_fields *fields, int key,
                        strut_dimension dimension, void *object);
/** Sets the tag that the choice of a key sets. */
void strut_store_choice(const strut_key *key, void *object);
/** Reads the mapping that is the value of a key of `outer`, "the KEY of OWNER", and stores its values in `object`. */
bool strut_read_nested(strut_reader *reader, const strut_key *key, strut_fields *outer,
                       void *object, size_t object_size);

/** What rows do not say about a section: reads the keys that are BY_HAND. False: it could not be read. */
typedef bool strut_section_reader(strut_reader *reader, strut_fields *fields, void *object);

/* parameters.c: groups */

enum { STRUT_MOST_GROUPS = 64 }; /* that one thing may name */
void strut_read_groups(strut_reader *reader);
/** Fills absent keys from the groups that the fields name. */
void strut_apply_groups(strut_reader *reader, strut_fields *fields, int group_key);
/** The groups that `group:` names, in order; unknown ones are left out. Returns their number. */
size_t strut_groups_named(strut_reader *reader, const strut_tree *value, strut_group **groups);
void strut_report_unused_groups(strut_reader *reader);

/* parameters.c */

void strut_read_parameters(strut_reader *reader, const strut_setting *settings, size_t count);
/** Stores the parameters as they were used in the scene, for the record. */
void strut_keep_parameters(strut_reader *reader);
/** Reports settings of parameters that nothing uses. */
void strut_report_idle_settings(strut_reader *reader);
strut_scope strut_parameter_scope(strut_reader *reader);
/** The parameter that the name means in the reader's scope, or NULL. */
strut_parameter_state *strut_parameter_in_scope(const strut_reader *reader, const strut_copy *scope,
                                                const char *name);
/** Is the name that of a text parameter in the scope? *text: with its place. */
bool strut_text_parameter(const strut_reader *reader, const strut_copy *scope, const char *name,
                          strut_tree *text);
/** Evaluates the parameters of a copy. */
void strut_resolve_parameter(strut_reader *reader, strut_parameter_state *parameter);
void strut_declare_parameter(strut_reader *reader, const strut_tree *key,
                             strut_parameter_state *parameter);
/** The scene's parameter of that name, or NULL. */
strut_parameter_state *strut_parameter_find(const strut_reader *reader, const char *name);

/* The sections, in the order in which they are read. */

/** Makes room for so many more things of a kind; false: memory is out. */
bool strut_reserve_things(strut_reader *reader, strut_thing kind, size_t more);
/** Appends a thing with its defaults, where there is room, and enters its name and its place. */
void *strut_add_thing(strut_reader *reader, strut_thing kind, const strut_tree *key,
                      const char *name);
/** All things of a kind, by its row in read_things.c. */
void strut_read_things(strut_reader *reader, strut_thing kind);
/** The key of the scene whose mapping has the things of the kind. */
int strut_key_of_things(strut_thing kind);
void strut_read_ground(strut_reader *reader);
/** Enters the names of signals, so that anything may refer to them. */
void strut_list_signals(strut_reader *reader);
void strut_read_signals(strut_reader *reader);
void strut_read_nodes(strut_reader *reader);
void strut_read_moves(strut_reader *reader);
void strut_read_configurations(strut_reader *reader);
void strut_keep_signals(strut_reader *reader);
void strut_read_search(strut_reader *reader);
void strut_read_initial(strut_reader *reader);
void strut_read_experiment(strut_reader *reader);
void strut_read_quantities(strut_reader *reader, const strut_slot *slot);
/**
 * `derivatives`, of parameters of the scene that is read, or of those of `source`; *list is in the reader's arena.
 * Returns how many there are.
 */
size_t strut_read_derivatives(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                              const struct strut_scene_source *source, strut_derived_by **list);

/**
 * A signal or the name of one. `expected`: what its values must measure, or NULL for anything.
 * Returns its index, or -1 where it was reported.
 */
int32_t strut_read_signal(strut_reader *reader, const strut_tree *value, const char *key,
                          strut_owner owner, const strut_dimension *expected);
/** `[n1, n4]`, or a list of such lists, in the scene's memory. */
bool strut_read_node_sets(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                          strut_node_set **sets, size_t *count);
/** Reads `{NODE: [x, y], ...}`: pairs of numbers of each node, `stride` bytes apart from `pairs` on. */
bool strut_read_node_pairs(strut_reader *reader, const strut_tree *map, strut_owner owner,
                           strut_dimension dimension, void *pairs, size_t stride);

/* read_data.c: measured data */

/** Reads the file of at most `most` bytes that a value names, as strut_safe_read does. False: reported. */
bool strut_read_file_of(strut_reader *reader, const strut_tree *name, size_t most,
                        strut_safe_text *text);
/** Reads the tables behind the key into the reader's memory for what it keeps; nothing where it has some. */
void strut_read_data(strut_reader *reader, const strut_slot *slot);
void strut_read_scene_data(strut_reader *reader);
/**
 * The column with numbers and a unit that "TABLE.COLUMN" names, and its table; NULL: reported. `expected`:
 * what it must measure, or NULL for anything.
 */
const strut_data_column *strut_read_data_column(strut_reader *reader, const strut_tree *value,
                                                const char *key, strut_owner owner,
                                                const strut_dimension *expected,
                                                const strut_data_table **table);
/**
 * Reports about a cell of the column in its file, or about its title where row is SIZE_MAX, and that it is
 * used by `value`. Returns false.
 */
bool strut_refuse_data(strut_reader *reader, const strut_tree *value, const strut_data_table *table,
                       const strut_data_column *column, size_t row, const char *message);

/* use_data.c */

/** A measured signal's points, and what they measure; `over`: the column of the time, or NULL. */
bool strut_read_data_signal(strut_reader *reader, const strut_tree *value, const strut_tree *over,
                            strut_owner owner, const strut_dimension *expected,
                            strut_dimension *found, strut_signal *signal);
/** The points of a law whose strain and force have these dimensions. */
bool strut_read_data_law(strut_reader *reader, const strut_tree *value, const strut_tree *over,
                         strut_owner owner, const strut_dimension dimensions[2], strut_law *law);
/** A position, `{x: TABLE.COLUMN, y: TABLE.COLUMN, row: 1}`. */
bool strut_read_data_point(strut_reader *reader, const strut_tree *map, strut_owner owner,
                           double point[2]);

/* Readers of things, or of sections, beyond their rows: entries of the tables in read_things.c. */

/** A thing whose value may be more than a mapping. False: it could not be read. */
typedef bool strut_thing_reader(strut_reader *reader, const strut_tree *key, void *object);
strut_thing_reader strut_read_node, strut_read_configuration;
strut_section_reader strut_read_member, strut_read_hinge, strut_read_cell, strut_read_distance,
    strut_read_actuator, strut_read_load, strut_read_unbalance, strut_read_slider,
    strut_read_sensor, strut_read_trigger;

/** The law of a member or a hinge, whose strain and force have these dimensions. */
bool strut_read_law(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                    strut_dimension strain, strut_dimension force, strut_law *law);
void strut_read_rayleigh(strut_reader *reader);
void strut_read_lattice(strut_reader *reader);
/** The coordinate that a text names, "NODE.x"; -1, which was reported. */
int32_t strut_read_coordinate(strut_reader *reader, const strut_tree *value, const char *key,
                              strut_owner owner);
void strut_read_stages(strut_reader *reader);
/** Collisions of all members or of groups become those of pairs. */
void strut_read_bodies(strut_reader *reader);

/* read_beams.c */

/** Reads the beams and adds their nodes; the others add their members and hinges, when those are read. */
void strut_read_beams(strut_reader *reader);
void strut_add_beam_members(strut_reader *reader);
void strut_add_beam_hinges(strut_reader *reader);

/* read_scene.c */

/** Reports findings where they belong, except those that follow from what was reported before. */
void strut_place_findings(strut_reader *reader, const strut_findings *findings);
