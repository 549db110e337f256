/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/language/yaml/document.h"

#include <assert.h>
#include <string.h>

#include "engine/base/name_map.h"
#include "parser/language/yaml/document_parts.h"
#include "parser/language/yaml/text.h"

enum {
  DEPTH_MOST = 64,
  SLAB = 256,          /* nodes taken from the arena at once */
  RECENT_SLOTS = 1024, /* recent short scalars, whose texts are shared */
  RECENT_LENGTH = 24,
  PROBLEMS_MOST = 1000, /* then reading stops */
  ANCHOR_MOST = 1000
};
static const uint64_t NODES_MOST = 64000000, EXPANDED_MOST = 1000000;

/* An anchored node. */
typedef struct anchored_node {
  strut_tree *node;
  uint64_t weight; /* nodes in it, aliases expanded; 0: still open */
  size_t height;   /* levels of lists and mappings in it, aliases expanded */
  int32_t latest;  /* index of the latest of its name; of the first of them only */
} anchored_node;

typedef struct anchor_table {
  anchored_node *items;  /* (ANCHOR_MOST) */
  strut_name_map firsts; /* index of the first of each name */
  int32_t count;
} anchor_table;

static anchored_node *find_anchor(const anchor_table *anchors, const char *name) {
  int32_t first = strut_name_map_find(&anchors->firsts, name);
  return first < 0 ? NULL : &anchors->items[anchors->items[first].latest];
}

static anchored_node *add_anchor(anchor_table *anchors, const char *name, strut_tree *node) {
  if (!anchors->items) anchors->items = strut_allocate(ANCHOR_MOST, sizeof *anchors->items);
  int32_t first = anchors->items ? strut_name_map_add(&anchors->firsts, name, anchors->count) : -2;
  if (first == -2) return NULL;
  anchored_node *anchor = &anchors->items[anchors->count];
  *anchor = (anchored_node){.node = node, .latest = anchors->count};
  if (first >= 0) anchors->items[first].latest = anchors->count;
  anchors->count++;
  return anchor;
}

/* A list or map whose end has not come yet. */
typedef struct frame {
  strut_tree *node, *last; /* last child so far */
  uint64_t weight;
  size_t height;         /* of the highest child so far */
  anchored_node *anchor; /* or NULL */
  bool bracketed;
  bool value_next; /* map: a key waits for its value */
} frame;

typedef struct reader {
  yaml_parser_t yaml;
  strut_document *document;
  strut_diagnostics *diagnostics;
  strut_cursor cursor;
  frame stack[DEPTH_MOST];
  size_t depth;
  strut_tree *spare; /* unused nodes of the newest slab */
  size_t spare_count;
  uint64_t nodes, expanded;
  anchor_table anchors;
  const char *recent[RECENT_SLOTS];
  bool ended, no_memory;
} reader;

static strut_place place_of(const yaml_event_t *event) {
  size_t length = event->end_mark.index - event->start_mark.index;
  return strut_place_at((uint32_t)event->start_mark.line + 1,
                        (uint32_t)event->start_mark.column + 1, (uint32_t)length);
}

/* Functions below return false if reading must stop. */
static bool out_of_memory(reader *self) {
  self->no_memory = true;
  return false;
}

/* libyaml gives the anchor as the place of an anchored node: this moves it to the node itself. */
static void skip_anchor(reader *self, const yaml_event_t *event, strut_place *place) {
  strut_cursor *at = &self->cursor;
  strut_cursor_to_index(at, event->start_mark.index);
  bool in_word = true, in_comment = false;
  for (; at->offset < at->length; strut_cursor_step(at)) {
    char c = at->text[at->offset];
    bool end_of_line = strut_text_break(at->text + at->offset, at->length - at->offset) > 0;
    bool blank = c == ' ' || c == '\t' || end_of_line;
    if (end_of_line) in_comment = false;
    if (blank)
      in_word = false;
    else if (c == '#' && !in_word)
      in_comment = true;
    else if (!in_word && !in_comment)
      break;
  }
  size_t end = event->end_mark.index;
  place->line = at->line;
  place->column = at->column;
  place->length = strut_place_at(0, 0, end > at->index ? (uint32_t)(end - at->index) : 0).length;
}

static bool over_limit(reader *self, strut_place place, const char *what, uint64_t most) {
  strut_diagnose(self->diagnostics, place, "more than %llu %s", (unsigned long long)most, what);
  return false;
}

static bool new_slab(reader *self) {
  self->spare = strut_arena_allocate(&self->document->arena, SLAB, sizeof *self->spare);
  self->spare_count = self->spare ? SLAB : 0;
  return self->spare || out_of_memory(self);
}

static strut_tree *new_node(reader *self, strut_tree_kind kind, strut_place place) {
  if (self->nodes >= NODES_MOST) {
    over_limit(self, place, "values", NODES_MOST);
    return NULL;
  }
  if (!self->spare_count && !new_slab(self)) return NULL;
  self->nodes++;
  self->spare_count--;
  strut_tree *node = self->spare++;
  *node = (strut_tree){.kind = (uint32_t)kind & 3u, .place = place, .text = ""};
  return node;
}

/* Links a node to the open list or map, or makes it the root. */
static void attach(reader *self, strut_tree *node, uint64_t weight, size_t height) {
  if (!self->depth) {
    self->document->root = node;
    return;
  }
  frame *open = &self->stack[self->depth - 1];
  if (open->last)
    open->last->next = node;
  else
    open->node->first = node;
  open->last = node;
  open->weight += weight;
  if (open->height < height) open->height = height;
  if (open->node->kind == STRUT_TREE_LIST || open->value_next) open->node->count++;
  if (open->node->kind == STRUT_TREE_MAP) open->value_next = !open->value_next;
}

static bool key_expected(const reader *self) {
  const frame *open = self->depth ? &self->stack[self->depth - 1] : NULL;
  return open && open->node->kind == STRUT_TREE_MAP && !open->value_next;
}

/* Names the node; *anchor is NULL without a name. */
static bool read_anchor(reader *self, const yaml_char_t *name, strut_tree *node,
                        anchored_node **anchor) {
  *anchor = NULL;
  if (!name) return true;
  if (self->anchors.count >= ANCHOR_MOST)
    return over_limit(self, node->place, "anchors", ANCHOR_MOST);
  const char *text = (const char *)name;
  text = strut_arena_text(&self->document->arena, text, strlen(text));
  *anchor = text ? add_anchor(&self->anchors, text, node) : NULL;
  return *anchor || out_of_memory(self);
}

static void check_tag(reader *self, const yaml_char_t *tag, const yaml_event_t *event) {
  if (!tag) return;
  strut_place place = place_of(event);
  place.length = 1;
  strut_diagnose(self->diagnostics, place, "tags (words that begin with '!') are not allowed");
}

/* Escapes could produce characters that are forbidden in the text. */
static bool check_escapes(reader *self, const char *text, size_t length, strut_place place) {
  for (size_t at = 0; at < length;) {
    uint32_t code;
    at += strut_text_decode(text + at, length - at, &code);
    if (!strut_text_forbidden(code)) continue;
    strut_diagnose(self->diagnostics, place, "an escape makes the control character U+%04X",
                   (unsigned)code);
    return false;
  }
  return true;
}

static size_t slot_of(const char *text, size_t length) {
  uint32_t hash = 0x811C9DC5;
  for (size_t i = 0; i < length; i++) hash = (hash ^ (unsigned char)text[i]) * 0x01000193;
  return (hash ^ hash >> 16) % RECENT_SLOTS;
}

/* A copy of the scalar's text in the arena; recent short texts are shared. */
static const char *keep_text(reader *self, const char *text, size_t length) {
  if (!length) return "";
  if (length > RECENT_LENGTH) return strut_arena_text(&self->document->arena, text, length);
  size_t slot = slot_of(text, length);
  const char *known = self->recent[slot];
  if (known && strncmp(known, text, length) == 0 && known[length] == '\0') return known;
  return self->recent[slot] = strut_arena_text(&self->document->arena, text, length);
}

static bool read_scalar(reader *self, const yaml_event_t *event) {
  const char *text = (const char *)event->data.scalar.value;
  size_t length = event->data.scalar.length;
  anchored_node *anchor;
  strut_place place = place_of(event);
  bool quoted = event->data.scalar.style != YAML_PLAIN_SCALAR_STYLE;
  check_tag(self, event->data.scalar.tag, event);
  if (event->data.scalar.anchor) skip_anchor(self, event, &place);
  strut_tree *node = new_node(self, STRUT_TREE_SCALAR, place);
  if (!node || !read_anchor(self, event->data.scalar.anchor, node, &anchor)) return false;
  if (event->data.scalar.style == YAML_DOUBLE_QUOTED_SCALAR_STYLE &&
      !check_escapes(self, text, length, place))
    length = 0;
  node->quoted = quoted;
  node->text = keep_text(self, text, length);
  if (!node->text) return out_of_memory(self);
  if (anchor) anchor->weight = 1;
  attach(self, node, 1, 0);
  return true;
}

static bool read_alias(reader *self, const yaml_event_t *event) {
  const char *name = (const char *)event->data.alias.anchor;
  strut_place place = place_of(event);
  const anchored_node *anchor = find_anchor(&self->anchors, name);
  if (key_expected(self)) {
    strut_diagnose(self->diagnostics, place, "a key must be a plain text, not an alias");
    return false;
  }
  if (!anchor || !anchor->weight) {
    strut_diagnose(
        self->diagnostics, place,
        anchor ? "alias '*%.64s' refers to a value that contains it" : "unknown alias '*%.64s'",
        name);
    return false;
  }
  self->expanded += anchor->weight;
  if (self->expanded > EXPANDED_MOST)
    return over_limit(self, place, "values repeated by aliases", EXPANDED_MOST);
  if (self->depth + anchor->height > DEPTH_MOST)
    return over_limit(self, place, "levels of nesting", DEPTH_MOST);
  strut_tree *node = new_node(self, STRUT_TREE_SCALAR, place);
  if (!node) return false;
  *node = *anchor->node;
  node->place = place;
  node->next = NULL;
  attach(self, node, anchor->weight, anchor->height);
  return true;
}

static bool open_collection(reader *self, const yaml_event_t *event) {
  bool map = event->type == YAML_MAPPING_START_EVENT;
  const yaml_char_t *anchor =
      map ? event->data.mapping_start.anchor : event->data.sequence_start.anchor;
  strut_place place = place_of(event);
  check_tag(self, map ? event->data.mapping_start.tag : event->data.sequence_start.tag, event);
  if (anchor) skip_anchor(self, event, &place);
  place.length = 1;
  if (key_expected(self)) {
    strut_diagnose(self->diagnostics, place, "a key must be a plain text, not a %s",
                   map ? "mapping" : "list");
    return false;
  }
  if (self->depth == DEPTH_MOST) return over_limit(self, place, "levels of nesting", DEPTH_MOST);
  strut_tree *node = new_node(self, map ? STRUT_TREE_MAP : STRUT_TREE_LIST, place);
  bool bracketed = map ? event->data.mapping_start.style == YAML_FLOW_MAPPING_STYLE
                       : event->data.sequence_start.style == YAML_FLOW_SEQUENCE_STYLE;
  frame open = {.node = node, .weight = 1, .bracketed = bracketed};
  if (!node || !read_anchor(self, anchor, node, &open.anchor)) return false;
  self->stack[self->depth++] = open;
  return true;
}

static bool close_collection(reader *self, const yaml_event_t *event) {
  assert(self->depth > 0 && self->depth <= DEPTH_MOST);
  frame closed = self->stack[--self->depth];
  strut_tree *node = closed.node;
  /* Only a bracketed collection on one line has a length; a block is marked by its first character. */
  size_t line = event->end_mark.line + 1, column = event->end_mark.column + 1;
  if (event->end_mark.index > event->start_mark.index && line == node->place.line &&
      column > node->place.column)
    node->place.length = strut_place_at(0, 0, (uint32_t)column - node->place.column).length;
  if (node->kind == STRUT_TREE_MAP && !strut_document_check_keys(node, self->diagnostics))
    return out_of_memory(self);
  if (closed.anchor) {
    closed.anchor->weight = closed.weight;
    closed.anchor->height = closed.height + 1;
  }
  attach(self, node, closed.weight, closed.height + 1);
  return true;
}

/* After the document only comments and its end mark are allowed. */
static bool check_rest(reader *self, const yaml_event_t *event) {
  strut_cursor *at = &self->cursor;
  strut_cursor_to_index(at, event->end_mark.index);
  bool comment = false;
  while (at->offset < at->length) {
    const char *here = at->text + at->offset;
    size_t left = at->length - at->offset;
    bool end_of_line = strut_text_break(here, left) > 0;
    if (end_of_line)
      comment = false;
    else if (*here == '#')
      comment = true;
    bool dots = at->column == 1 && left >= 3 && memcmp(here, "...", 3) == 0;
    if (dots && !comment)
      strut_cursor_to_offset(at, at->offset + 2);
    else if (!comment && !end_of_line && *here != ' ' && *here != '\t')
      break;
    strut_cursor_step(at);
  }
  if (at->offset >= at->length) return true;
  bool next = at->length - at->offset >= 3 && memcmp(at->text + at->offset, "---", 3) == 0;
  strut_place place = strut_place_at(at->line, at->column, next ? 3 : 1);
  strut_diagnose(
      self->diagnostics, place,
      next ? "a second document; a file holds one" : "text after the end of the document");
  return false;
}

static bool read_end(reader *self, const yaml_event_t *event) {
  const strut_tree *root = self->document->root;
  self->ended = true;
  if (root && (root->kind != STRUT_TREE_SCALAR || root->quoted || root->text[0] != '\0'))
    return event->type != YAML_DOCUMENT_END_EVENT || check_rest(self, event);
  const char *text = self->diagnostics->text;
  bool comments = text && memchr(text, '#', self->diagnostics->length);
  strut_diagnose(self->diagnostics, (strut_place){0},
                 comments ? "the file has comments only" : "the file is empty");
  return false;
}

static bool handle_event(reader *self, const yaml_event_t *event) {
  switch ((int)event->type) { /* as an int: of libyaml's kinds not all matter */
    case YAML_SCALAR_EVENT: return read_scalar(self, event);
    case YAML_ALIAS_EVENT: return read_alias(self, event);
    case YAML_MAPPING_START_EVENT:
    case YAML_SEQUENCE_START_EVENT: return open_collection(self, event);
    case YAML_MAPPING_END_EVENT:
    case YAML_SEQUENCE_END_EVENT: return close_collection(self, event);
    case YAML_DOCUMENT_END_EVENT:
    case YAML_STREAM_END_EVENT: return read_end(self, event);
    default: return true;
  }
}

static bool read_events(reader *self) {
  if (!yaml_parser_initialize(&self->yaml)) return out_of_memory(self);
  yaml_parser_set_encoding(&self->yaml, YAML_UTF8_ENCODING);
  const char *text = self->diagnostics->text;
  size_t mark = strut_text_mark(text, self->diagnostics->length);
  yaml_parser_set_input_string(&self->yaml, (const unsigned char *)text + mark,
                               self->diagnostics->length - mark);
  bool fine = true;
  while (fine && !self->ended) {
    yaml_event_t event;
    if (yaml_parser_parse(&self->yaml, &event)) {
      fine = handle_event(self, &event) && self->diagnostics->count < PROBLEMS_MOST;
      yaml_event_delete(&event);
    } else {
      const frame *open = self->depth ? &self->stack[self->depth - 1] : NULL;
      const strut_tree *bracket = open && open->bracketed ? open->node : NULL;
      fine = false;
      if (!strut_document_syntax_error(&self->yaml, bracket, self->diagnostics))
        out_of_memory(self);
    }
  }
  yaml_parser_delete(&self->yaml);
  return fine;
}

strut_status strut_document_read(strut_document *document, strut_diagnostics *diagnostics) {
  size_t before = diagnostics->count;
  document->root = NULL;
  if (!strut_document_scan(diagnostics))
    return diagnostics->out_of_memory ? STRUT_NO_MEMORY : STRUT_BAD_SCENE;
  reader *self = strut_allocate(1, sizeof *self);
  if (!self) return STRUT_NO_MEMORY;
  self->document = document;
  self->diagnostics = diagnostics;
  self->cursor = strut_cursor_begin(diagnostics->text, diagnostics->length);
  bool fine = read_events(self), no_memory = self->no_memory || diagnostics->out_of_memory;
  if (!fine || no_memory) document->root = NULL;
  strut_release(self->anchors.items);
  strut_name_map_free(&self->anchors.firsts);
  strut_release(self);
  if (no_memory) return STRUT_NO_MEMORY;
  return diagnostics->count > before ? STRUT_BAD_SCENE : STRUT_OK;
}

void strut_document_free(strut_document *document) {
  strut_arena_free(&document->arena);
  document->root = NULL;
}

strut_tree *strut_tree_find(const strut_tree *map, const char *key, strut_tree **key_node) {
  for (strut_tree *tree = map->kind == STRUT_TREE_MAP ? map->first : NULL; tree;
       tree = tree->next->next) {
    if (strcmp(tree->text, key) != 0) continue;
    if (key_node) *key_node = tree;
    return tree->next;
  }
  return NULL;
}

strut_tree *strut_tree_copy(strut_arena *arena, const strut_tree *node) {
  size_t size = node->placed ? sizeof(strut_placed_tree) : sizeof *node;
  strut_tree *copy = strut_arena_copy(arena, node, 1, size);
  if (copy) copy->next = NULL;
  return copy;
}

strut_tree *strut_tree_scalar(strut_arena *arena, const strut_tree *like, const char *text) {
  strut_tree node = {.kind = STRUT_TREE_SCALAR, .place = like->place, .text = text};
  return text ? strut_tree_copy(arena, &node) : NULL;
}

strut_tree_builder strut_tree_begin(strut_arena *arena, const strut_tree *like) {
  strut_tree *map = strut_tree_scalar(arena, like, "");
  if (map) map->kind = STRUT_TREE_MAP;
  return (strut_tree_builder){map, map ? &map->first : NULL};
}

bool strut_tree_append(strut_tree_builder *builder, strut_tree *key, strut_tree *value) {
  if (!builder->map || !key || !value) return false;
  *builder->end = key;
  key->next = value;
  builder->end = &value->next;
  builder->map->count = (builder->map->count + 1) & STRUT_TREE_COUNT_MASK;
  return true;
}

bool strut_tree_share(strut_tree_builder *builder, strut_arena *arena, const strut_tree *key,
                      const strut_tree *value) {
  return strut_tree_append(builder, strut_tree_copy(arena, key), strut_tree_copy(arena, value));
}

void strut_tree_drop(strut_tree *map, const char *key) {
  strut_tree **link = &map->first;
  while (*link && strcmp((*link)->text, key) != 0) link = &(*link)->next->next;
  if (!*link) return;
  *link = (*link)->next->next;
  map->count--;
}

bool strut_tree_equal(const strut_tree *first, const strut_tree *second) {
  if (first->kind != second->kind || first->count != second->count) return false;
  if (first->kind == STRUT_TREE_SCALAR) return strcmp(first->text, second->text) == 0;
  const strut_tree *tree = first->first, *y = second->first;
  for (; tree && y; tree = tree->next, y = y->next)
    if (!strut_tree_equal(tree, y)) return false;
  return !tree && !y;
}

bool strut_is_null(const strut_tree *value) {
  static const char *const nulls[] = {"", "~", "null", "Null", "NULL"};
  if (value->kind != STRUT_TREE_SCALAR || value->quoted) return false;
  for (size_t i = 0; i < sizeof nulls / sizeof nulls[0]; i++)
    if (strcmp(value->text, nulls[i]) == 0) return true;
  return false;
}
