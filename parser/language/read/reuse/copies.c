/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scope of a copy: its frame, its names, and notes of its messages. See copies.h. */
#include "parser/language/read/reuse/copies.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- frames ---- */

const strut_frame strut_frame_of_scene = {.axes = {{1.0, 0.0}, {0.0, 1.0}}, .scale = 1.0};

void strut_frame_vector(const strut_frame *frame, double vector[2]) {
  double x = vector[0], y = vector[1];
  bool plain = frame->axes[0][0] == 1.0 && frame->axes[1][1] == 1.0 && frame->axes[1][0] == 0.0;
  if (plain) return;
  vector[0] = frame->axes[0][0] * x + frame->axes[0][1] * y;
  vector[1] = frame->axes[1][0] * x + frame->axes[1][1] * y;
}

void strut_frame_point(const strut_frame *frame, double point[2]) {
  strut_frame_vector(frame, point);
  point[0] += frame->at[0];
  point[1] += frame->at[1];
}

strut_frame strut_frame_within(const strut_frame *outer, const strut_frame *inner) {
  strut_frame f = {.scale = outer->scale * inner->scale};
  for (int c = 0; c < 2; c++) {
    double axis[2] = {inner->axes[0][c], inner->axes[1][c]};
    strut_frame_vector(outer, axis);
    f.axes[0][c] = axis[0], f.axes[1][c] = axis[1];
    f.at[c] = outer->scale * inner->at[c];
  }
  strut_frame_point(outer, f.at);
  return f;
}

/* ---- scopes ---- */

strut_copy *strut_scope_of(const strut_reader *reader, const strut_tree *tree) {
  return tree && tree->placed ? ((const strut_placed_tree *)tree)->scope : reader->scope;
}

static const strut_tree *enter(strut_reader *reader, const strut_tree *key) {
  reader->scope = key && key->placed ? ((const strut_placed_tree *)key)->scope : NULL;
  return key;
}

const strut_tree *strut_first_entry(strut_reader *reader, const strut_tree *map) {
  return enter(reader, map ? map->first : NULL);
}

const strut_tree *strut_following_entry(strut_reader *reader, const strut_tree *key) {
  return enter(reader, key->next->next);
}

strut_copy *strut_enter_scope(strut_reader *reader, const strut_tree *key) {
  strut_copy *before = reader->scope;
  enter(reader, key);
  return before;
}

double strut_scope_scale(const strut_reader *reader, const strut_tree *value) {
  const strut_copy *scope = strut_scope_of(reader, value);
  return scope ? scope->frame.scale : 1.0;
}

void strut_place_point(const strut_reader *reader, const strut_tree *value, double point[2]) {
  const strut_copy *scope = strut_scope_of(reader, value);
  if (scope) strut_frame_point(&scope->frame, point);
}

void strut_place_vector(const strut_reader *reader, const strut_tree *value, double vector[2]) {
  const strut_copy *scope = strut_scope_of(reader, value);
  if (scope) strut_frame_vector(&scope->frame, vector);
}

bool strut_scope_flips(const strut_reader *reader) {
  const strut_frame *frame = reader->scope ? &reader->scope->frame : &strut_frame_of_scene;
  return frame->axes[0][0] * frame->axes[1][1] - frame->axes[0][1] * frame->axes[1][0] < 0.0;
}

int strut_scope_axis(const strut_reader *reader, int axis, bool *reversed) {
  *reversed = false;
  if (!reader->scope) return axis;
  for (int c = 0; c < 2; c++) {
    double along = reader->scope->frame.axes[c][axis];
    if (!(along > 1.0 - 1e-12 || along < -1.0 + 1e-12)) continue;
    *reversed = along < 0.0;
    return c;
  }
  return -1;
}

/* ---- names ---- */

const strut_placement *strut_placement_find(const strut_reader *reader, const char *name) {
  if (!reader->copies) return NULL;
  int32_t i = strut_name_map_find(&reader->copies->placement_names, name);
  return i < 0 ? NULL : reader->copies->placements[i];
}

bool strut_name_resolve_last(const strut_reader *reader, const char *name, strut_full_name *full) {
  size_t used = 0, numbers = 0, taken = 0;
  const strut_placement *of = NULL;
  full->text[0] = '\0';
  while (*name) {
    size_t length = strcspn(name, ".");
    char number[32];
    const char *piece = name;
    size_t size = length;
    bool last = length == 4 && memcmp(name, "last", 4) == 0;
    if (taken < numbers && last) {
      size = (size_t)snprintf(number, sizeof number, "%lld", (long long)of->count[taken] - 1);
      piece = number;
    }
    if (used + size + 2 > sizeof full->text) return false;
    if (used) full->text[used++] = '.';
    memcpy(full->text + used, piece, size);
    used += size;
    full->text[used] = '\0';
    if (taken < numbers)
      taken++;
    else if ((of = strut_placement_find(reader, full->text)) != NULL)
      numbers = (size_t)of->numbers, taken = 0;
    name += length + (name[length] == '.');
  }
  return true;
}

bool strut_name_matches(const char *pattern, const char *name) {
  for (;;) {
    if (*pattern == '*') {
      pattern++;
      while (*name && *name != '.') name++;
    } else if (*pattern != *name) {
      return false;
    } else if (!*pattern) {
      return true;
    } else {
      pattern++, name++;
    }
  }
}

bool strut_is_pattern(const strut_tree *name) {
  return name->kind == STRUT_TREE_SCALAR && strchr(name->text, '*') != NULL;
}

int32_t strut_next_match(const strut_reader *reader, const strut_tree *pattern, int32_t node) {
  strut_full_name full;
  if (!strut_name_resolve_last(reader, pattern->text, &full)) return -1;
  for (size_t i = (size_t)(node + 1); i < reader->scene->node_count; i++)
    if (strut_name_matches(full.text, reader->scene->nodes[i].name)) return (int32_t)i;
  return -1;
}

/* prefix + text; false: too long for a name. */
static bool join_name(const char *prefix, const char *text, strut_full_name *full) {
  int length = snprintf(full->text, sizeof full->text, "%s%s", prefix, text);
  return length >= 0 && (size_t)length < sizeof full->text;
}

const char *strut_twisted(const strut_copy *link, const char *text) {
  const strut_tree *other = link->twist ? strut_tree_find(link->twist, text, NULL) : NULL;
  return other && other->kind == STRUT_TREE_SCALAR ? other->text : text;
}

/* The name that `text` has in one scope alone. */
static bool own_name(const strut_copy *scope, const char *text, strut_full_name *full) {
  bool next = scope->next && strncmp(text, "next.", 5) == 0;
  if (next) return join_name(scope->next->prefix, strut_twisted(scope, text + 5), full);
  return join_name(scope->prefix, text, full);
}

/* True for what belongs to the structure: a part has its own, and joins no other. */
static bool stays_within(const strut_reader *reader, const strut_name_map *map) {
  return map == &reader->things[STRUT_THING_NODE].names ||
         map == &reader->things[STRUT_THING_MEMBER].names ||
         map == &reader->things[STRUT_THING_HINGE].names ||
         map == &reader->things[STRUT_THING_CELL].names;
}

bool strut_within_part(const strut_reader *reader, const strut_tree *value,
                       const strut_name_map *map) {
  const strut_copy *scope = strut_scope_of(reader, value);
  return scope && scope->kind == STRUT_SCOPE_COPY && stays_within(reader, map);
}

static int32_t find_resolved(const strut_reader *reader, const strut_name_map *map,
                             const char *name) {
  strut_full_name full;
  int32_t index = strut_name_map_find(map, name);
  if (index >= 0 || !reader->copies || !strstr(name, "last")) return index;
  return strut_name_resolve_last(reader, name, &full) ? strut_name_map_find(map, full.text) : -1;
}

const strut_copy *strut_name_hidden_by(const strut_reader *reader, const strut_copy *scope,
                                       const char *name) {
  const struct strut_copies *copies = reader->copies;
  strut_full_name prefix;
  const char *around = !scope                            ? ""
                       : scope->kind == STRUT_SCOPE_COPY ? scope->prefix
                       : scope->outer                    ? scope->outer->prefix
                                                         : "";
  for (const char *dot = strchr(name, '.'); dot; dot = strchr(dot + 1, '.')) {
    size_t length = (size_t)(dot - name);
    if (length + 1 > sizeof prefix.text || strncmp(around, name, length + 1) == 0) continue;
    memcpy(prefix.text, name, length);
    prefix.text[length] = '\0';
    int32_t i = strut_name_map_find(&copies->ported, prefix.text);
    if (i < 0) continue;
    const strut_copy *copy = copies->ported_copies[i];
    return strut_tree_find(copy->placement->part->keys.ports, dot + 1, NULL) ? NULL : copy;
  }
  return NULL;
}

/* The index of a full name, as far as the scope may see it. */
static int32_t find_seen(const strut_reader *reader, const strut_name_map *map,
                         const strut_copy *scope, const char *name) {
  int32_t index = find_resolved(reader, map, name);
  strut_full_name full;
  if (index < 0 || map != &reader->things[STRUT_THING_NODE].names || !reader->copies ||
      !reader->copies->ported_count)
    return index;
  return strut_name_resolve_last(reader, name, &full) &&
                 strut_name_hidden_by(reader, scope, full.text)
             ? -1
             : index;
}

int32_t strut_find_literally(const strut_reader *reader, const strut_name_map *map,
                             const strut_tree *value, const char *text) {
  strut_full_name full;
  for (const strut_copy *scope = strut_scope_of(reader, value); scope; scope = scope->home) {
    if (scope->kind == STRUT_SCOPE_PLACE) continue;
    int32_t index = own_name(scope, text, &full) ? find_seen(reader, map, scope, full.text) : -1;
    if (index >= 0 || scope->closed) return index;
    if (scope->kind == STRUT_SCOPE_COPY && stays_within(reader, map)) return -1;
  }
  return find_seen(reader, map, NULL, text);
}

int32_t strut_find_named(const strut_reader *reader, const strut_name_map *map,
                         const strut_tree *value, const char *text) {
  strut_tree given;
  int32_t index = strut_find_literally(reader, map, value, text);
  bool by_parameter =
      index < 0 && strut_text_parameter(reader, strut_scope_of(reader, value), text, &given);
  return by_parameter ? strut_find_literally(reader, map, value, given.text) : index;
}

const char *strut_hiding_part(const strut_reader *reader, const strut_tree *value) {
  strut_full_name full, resolved;
  const strut_copy *scope = strut_scope_of(reader, value);
  if (!reader->copies || !reader->copies->ported_count) return NULL;
  if (scope ? !own_name(scope, value->text, &full) : !join_name("", value->text, &full))
    return NULL;
  if (!strut_name_resolve_last(reader, full.text, &resolved) ||
      find_resolved(reader, &reader->things[STRUT_THING_NODE].names, resolved.text) < 0)
    return NULL;
  const strut_copy *hiding = strut_name_hidden_by(reader, scope, resolved.text);
  return hiding ? hiding->placement->part->name : NULL;
}

/* "; 'cell' has the copies 0 to 2" for `number` beyond them. */
static const char *count_hint(strut_reader *reader, const strut_placement *placement,
                              const char *name, size_t length, int which) {
  if (placement->numbers == 0) return "; what is placed once has no numbers";
  char *end;
  long long number = strtoll(name, &end, 10);
  bool counted = length && end == name + length && number >= placement->count[which];
  if (!counted) return "";
  return strut_scratch_text(reader, "; '%s' has the copies 0 to %lld%s", placement->name,
                            (long long)placement->count[which] - 1,
                            placement->numbers == 1 ? ""
                            : which                 ? " along its second count"
                                                    : " along its first count");
}

const char *strut_copy_hint_of(strut_reader *reader, const char *name) {
  strut_full_name full;
  const char *hint = "";
  if (!reader->copies || !strut_name_resolve_last(reader, name, &full)) return hint;
  if (strut_name_map_find(&reader->copies->removed, full.text) >= 0) return "; it is removed";
  for (char *dot = strchr(full.text, '.'); dot && !*hint; dot = strchr(dot + 1, '.')) {
    *dot = '\0';
    const strut_placement *placement = strut_placement_find(reader, full.text);
    *dot = '.';
    const char *piece = dot + 1;
    for (int k = 0; placement && (k < placement->numbers || k == 0) && !hint[0]; k++) {
      size_t length = strcspn(piece, ".");
      bool number = length && strspn(piece, "0123456789") == length;
      if (placement->numbers || number || strncmp(piece, "last.", 5) == 0)
        hint = count_hint(reader, placement, piece, length, k);
      piece += length + (piece[length] == '.');
    }
  }
  return hint;
}

const char *strut_copy_hint(strut_reader *reader, const strut_tree *value) {
  strut_full_name full;
  const strut_copy *scope = strut_scope_of(reader, value);
  bool within = scope && scope->kind != STRUT_SCOPE_PLACE;
  if (within && scope != reader->scope && strncmp(value->text, "next.", 5) == 0)
    return "; its names stand here without 'next.'";
  bool fits = within ? own_name(scope, value->text, &full) : join_name("", value->text, &full);
  return fits ? strut_copy_hint_of(reader, full.text) : "";
}

const char *strut_local_name(const strut_reader *reader, const char *name) {
  const strut_copy *scope = reader->scope;
  bool within = scope && scope->kind != STRUT_SCOPE_PLACE &&
                strncmp(name, scope->prefix, scope->prefix_length) == 0;
  return within ? name + scope->prefix_length : name;
}

/* ---- messages ---- */

enum { MOST_COPIED = STRUT_DIAGNOSTICS_MOST };

/* A message about a copy, which stands for those of all copies. */
typedef struct strut_copied_error {
  const char *format; /* NULL: free */
  strut_place place;
  size_t item; /* among the diagnostics; SIZE_MAX: it was not stored */
  const strut_copy *first, *latest;
  int64_t copies;
} copied_error;

/* Its message of that place and format, a free slot for one, or NULL. */
static copied_error *error_slot(strut_reader *reader, strut_place place, const char *format) {
  struct strut_copies *copies = reader->copies;
  if (!copies->errors)
    copies->errors = strut_scratch_array(reader, MOST_COPIED, sizeof(copied_error));
  for (copied_error *slot = copies->errors; slot && slot < copies->errors + MOST_COPIED; slot++)
    if (!slot->format ||
        (slot->format == format && memcmp(&slot->place, &place, sizeof place) == 0 &&
         slot->first->placement->key == reader->scope->placement->key))
      return slot;
  return NULL;
}

bool strut_error_is_repeated(strut_reader *reader, strut_place place, const char *format) {
  copied_error *slot = reader->scope ? error_slot(reader, place, format) : NULL;
  if (!slot || !slot->format || slot->latest == reader->scope) return false;
  if (slot->first != reader->scope) slot->copies++;
  slot->latest = reader->scope;
  return true;
}

/* How many copies the placements of one entry of `place` have made. */
static int64_t copies_of(const strut_reader *reader, const strut_tree *key) {
  int64_t sum = 0;
  for (size_t i = 0; i < reader->copies->placement_count; i++) {
    const strut_placement *placement = reader->copies->placements[i];
    if (placement->key == key)
      sum += placement->count[0] * (placement->numbers > 1 ? placement->count[1] : 1);
  }
  return sum;
}

/* Adds to a message where the copy was placed, and in how many copies it is so. */
static void note_copy(strut_reader *reader, size_t item, const strut_copy *copy, int64_t copies) {
  char which[220] = "", first[120];
  const strut_placement *placement = copy->placement;
  int64_t all = copies_of(reader, placement->key);
  if (copies > all) copies = all; /* several times in a copy */
  strut_place place = placement->key->place;
  size_t length = copy->prefix_length ? copy->prefix_length - 1 : 0; /* without the dot */
  snprintf(first, sizeof first, "%.*s", length > 100 ? 100 : (int)length, copy->prefix);
  bool link = copy->kind == STRUT_SCOPE_LINK;
  if (all > 1 && copies == all && !link)
    snprintf(which, sizeof which, ", in all %lld copies", (long long)all);
  else if (all > 1 && copies > 1)
    snprintf(which, sizeof which, ", in %lld of %lld copies, first in '%s'", (long long)copies,
             (long long)all, first);
  else if (all > 1)
    snprintf(which, sizeof which, ", in the copy '%s'", first);
  if (copy->kind == STRUT_SCOPE_PLACE && !*which) return; /* the message is there already */
  if (copy->kind == STRUT_SCOPE_COPY)
    strut_diagnose_note(reader->diagnostics, item, place,
                        "in part '%.100s', placed here as '%.100s'%s", placement->part->name,
                        placement->key->text, which);
  else
    strut_diagnose_note(reader->diagnostics, item, place, "placed here as '%.100s'%s",
                        placement->key->text, which);
}

void strut_error_remember(strut_reader *reader, strut_place place, const char *format) {
  copied_error *slot = reader->scope ? error_slot(reader, place, format) : NULL;
  size_t stored = reader->diagnostics->count;
  if (!slot || strut_diagnostics_full(reader->diagnostics)) return;
  if (slot->format) { /* a second message of the same copy */
    note_copy(reader, stored - 1, reader->scope, 1);
    return;
  }
  *slot = (copied_error){.format = format,
                         .place = place,
                         .item = stored ? stored - 1 : SIZE_MAX,
                         .first = reader->scope,
                         .latest = reader->scope,
                         .copies = 1};
}

void strut_note_copies(strut_reader *reader) {
  const copied_error *errors = reader->copies ? reader->copies->errors : NULL;
  for (size_t i = 0; errors && i < MOST_COPIED; i++)
    if (errors[i].format && errors[i].item != SIZE_MAX)
      note_copy(reader, errors[i].item, errors[i].first, errors[i].copies);
}
