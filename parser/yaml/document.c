/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/yaml/document.h"

#include <assert.h>
#include <string.h>
#include <time.h>

#include "parser/yaml/document_parts.h"
#include "parser/yaml/rows.h"
#include "parser/yaml/text.h"

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
  const char *name;
  strut_tree *node;
  uint64_t weight; /* nodes in it, aliases expanded; 0: still open */
  size_t height;   /* levels of lists and mappings in it, aliases expanded */
} anchored_node;

typedef struct anchor_table {
  anchored_node *items; /* (ANCHOR_MOST) */
  uint16_t *slots;      /* 1 + index of the latest of its name */
  size_t count;
  uint64_t seed;
} anchor_table;

enum { SLOT_COUNT = 2048 };

/* The slot of that name, or the empty slot in which to store it. */
static size_t anchor_slot(const anchor_table *anchors, const char *name) {
  size_t slot = (size_t)strut_document_hash(name, strlen(name), anchors->seed) % SLOT_COUNT;
  while (anchors->slots[slot] && strcmp(anchors->items[anchors->slots[slot] - 1].name, name) != 0)
    slot = (slot + 1) % SLOT_COUNT;
  return slot;
}

static anchored_node *find_anchor(const anchor_table *anchors, const char *name) {
  if (!anchors->count) return NULL;
  uint16_t found = anchors->slots[anchor_slot(anchors, name)];
  return found ? &anchors->items[found - 1] : NULL;
}

static anchored_node *add_anchor(anchor_table *anchors, const char *name, strut_tree *node) {
  if (!anchors->items) anchors->items = strut_allocate(ANCHOR_MOST, sizeof *anchors->items);
  if (!anchors->slots) anchors->slots = strut_allocate(SLOT_COUNT, sizeof *anchors->slots);
  if (!anchors->items || !anchors->slots) return NULL;
  size_t slot = anchor_slot(anchors, name);
  anchored_node *anchor = &anchors->items[anchors->count++];
  *anchor = (anchored_node){.name = name, .node = node};
  anchors->slots[slot] = (uint16_t)anchors->count;
  return anchor;
}

static void free_anchors(anchor_table *anchors) {
  strut_release(anchors->items);
  strut_release(anchors->slots);
}

/* A list or map whose end has not come yet. */
typedef struct frame {
  strut_tree *node, *last; /* last child so far */
  uint64_t weight;
  size_t height; /* of the highest child so far */
  size_t anchor; /* 1 + index, or 0 */
  bool bracketed;
  bool value_next; /* map: a key waits for its value */
} frame;

/* From libyaml's marks, which know nothing of the runs, to those of the text. */
typedef struct run_marks {
  size_t passed;       /* runs before the latest mark */
  size_t lines, bytes; /* in them */
} run_marks;

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
  strut_key_table keys;
  const char *recent[RECENT_SLOTS];
  bool ended, no_memory;
  strut_row_runs runs;
  run_marks marks;
  size_t input;                     /* bytes of the text that libyaml was given, runs among them */
  size_t input_run;                 /* runs among them */
  size_t next_run;                  /* the first that is not in the tree yet */
  size_t run_depth;                 /* its first row's key has come, at this depth; 0: not yet */
  const char *const *deferred_keys; /* NULL: none */
} reader;

static strut_place place_of(const yaml_event_t *event) {
  size_t length = event->end_mark.index - event->start_mark.index;
  return strut_place_at((uint32_t)event->start_mark.line + 1,
                        (uint32_t)event->start_mark.column + 1, (uint32_t)length);
}

/* Functions below return false if reading must stop. */
static bool out_of_memory(reader *r) {
  r->no_memory = true;
  return false;
}

/* libyaml gives the anchor as the place of an anchored node: this moves it to the node itself. */
static void skip_anchor(reader *r, const yaml_event_t *event, strut_place *place) {
  strut_cursor *at = &r->cursor;
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

static bool over_limit(reader *r, strut_place place, const char *what, uint64_t most) {
  strut_diagnose(r->diagnostics, place, "more than %llu %s", (unsigned long long)most, what);
  return false;
}

static bool new_slab(reader *r) {
  r->spare = strut_arena_allocate(&r->document->arena, SLAB, sizeof *r->spare);
  r->spare_count = r->spare ? SLAB : 0;
  return r->spare || out_of_memory(r);
}

static strut_tree *new_node(reader *r, strut_tree_kind kind, strut_place place) {
  if (r->nodes >= NODES_MOST) {
    over_limit(r, place, "values", NODES_MOST);
    return NULL;
  }
  if (!r->spare_count && !new_slab(r)) return NULL;
  r->nodes++;
  r->spare_count--;
  strut_tree *node = r->spare++;
  *node = (strut_tree){.kind = (uint32_t)kind & 3u, .place = place, .text = ""};
  return node;
}

/* Links a node to the open list or map, or makes it the root. */
static void attach(reader *r, strut_tree *node, uint64_t weight, size_t height) {
  if (!r->depth) {
    r->document->root = node;
    return;
  }
  frame *open = &r->stack[r->depth - 1];
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

static bool key_expected(const reader *r) {
  const frame *open = r->depth ? &r->stack[r->depth - 1] : NULL;
  return open && open->node->kind == STRUT_TREE_MAP && !open->value_next;
}

/* Names the node; *index is 1 + the anchor's, or 0 without one. */
static bool read_anchor(reader *r, const yaml_char_t *name, strut_tree *node, size_t *index) {
  *index = 0;
  if (!name) return true;
  if (r->anchors.count >= ANCHOR_MOST) return over_limit(r, node->place, "anchors", ANCHOR_MOST);
  const char *text = (const char *)name;
  text = strut_arena_text(&r->document->arena, text, strlen(text));
  if (!text || !add_anchor(&r->anchors, text, node)) return out_of_memory(r);
  *index = r->anchors.count;
  return true;
}

static void check_tag(reader *r, const yaml_char_t *tag, const yaml_event_t *event) {
  if (!tag) return;
  strut_place place = place_of(event);
  place.length = 1;
  strut_diagnose(r->diagnostics, place, "tags (words that begin with '!') are not allowed");
}

/* Escapes could produce characters that are forbidden in the text. */
static bool check_escapes(reader *r, const char *text, size_t length, strut_place place) {
  for (size_t at = 0; at < length;) {
    uint32_t code;
    at += strut_text_decode(text + at, length - at, &code);
    if (!strut_text_forbidden(code)) continue;
    strut_diagnose(r->diagnostics, place, "an escape makes the control character U+%04X",
                   (unsigned)code);
    return false;
  }
  return true;
}

/* A copy of the scalar's text in the arena; recent short texts are shared. */
static const char *keep_text(reader *r, const char *text, size_t length) {
  if (!length) return "";
  if (length > RECENT_LENGTH) return strut_arena_text(&r->document->arena, text, length);
  size_t slot = (size_t)strut_document_hash(text, length, 0) % RECENT_SLOTS;
  const char *known = r->recent[slot];
  if (known && strncmp(known, text, length) == 0 && known[length] == '\0') return known;
  return r->recent[slot] = strut_arena_text(&r->document->arena, text, length);
}

static bool read_scalar(reader *r, const yaml_event_t *event) {
  const char *text = (const char *)event->data.scalar.value;
  size_t length = event->data.scalar.length, anchor;
  strut_place place = place_of(event);
  bool quoted = event->data.scalar.style != YAML_PLAIN_SCALAR_STYLE;
  check_tag(r, event->data.scalar.tag, event);
  if (event->data.scalar.anchor) skip_anchor(r, event, &place);
  strut_tree *node = new_node(r, STRUT_TREE_SCALAR, place);
  if (!node || !read_anchor(r, event->data.scalar.anchor, node, &anchor)) return false;
  if (event->data.scalar.style == YAML_DOUBLE_QUOTED_SCALAR_STYLE &&
      !check_escapes(r, text, length, place))
    length = 0;
  node->quoted = quoted;
  node->text = keep_text(r, text, length);
  if (!node->text) return out_of_memory(r);
  if (anchor) r->anchors.items[anchor - 1].weight = 1;
  attach(r, node, 1, 0);
  return true;
}

static bool read_alias(reader *r, const yaml_event_t *event) {
  const char *name = (const char *)event->data.alias.anchor;
  strut_place place = place_of(event);
  const anchored_node *anchor = find_anchor(&r->anchors, name);
  if (key_expected(r)) {
    strut_diagnose(r->diagnostics, place, "a key must be a plain text, not an alias");
    return false;
  }
  if (!anchor || !anchor->weight) {
    strut_diagnose(
        r->diagnostics, place,
        anchor ? "alias '*%.64s' refers to a value that contains it" : "unknown alias '*%.64s'",
        name);
    return false;
  }
  r->expanded += anchor->weight;
  if (r->expanded > EXPANDED_MOST)
    return over_limit(r, place, "values repeated by aliases", EXPANDED_MOST);
  if (r->depth + anchor->height > DEPTH_MOST)
    return over_limit(r, place, "levels of nesting", DEPTH_MOST);
  strut_tree *node = new_node(r, STRUT_TREE_SCALAR, place);
  if (!node) return false;
  *node = *anchor->node;
  node->place = place;
  node->next = NULL;
  attach(r, node, anchor->weight, anchor->height);
  return true;
}

static bool open_collection(reader *r, const yaml_event_t *event) {
  bool map = event->type == YAML_MAPPING_START_EVENT;
  const yaml_char_t *anchor =
      map ? event->data.mapping_start.anchor : event->data.sequence_start.anchor;
  strut_place place = place_of(event);
  check_tag(r, map ? event->data.mapping_start.tag : event->data.sequence_start.tag, event);
  if (anchor) skip_anchor(r, event, &place);
  place.length = 1;
  if (key_expected(r)) {
    strut_diagnose(r->diagnostics, place, "a key must be a plain text, not a %s",
                   map ? "mapping" : "list");
    return false;
  }
  if (r->depth == DEPTH_MOST) return over_limit(r, place, "levels of nesting", DEPTH_MOST);
  strut_tree *node = new_node(r, map ? STRUT_TREE_MAP : STRUT_TREE_LIST, place);
  bool bracketed = map ? event->data.mapping_start.style == YAML_FLOW_MAPPING_STYLE
                       : event->data.sequence_start.style == YAML_FLOW_SEQUENCE_STYLE;
  frame open = {.node = node, .weight = 1, .bracketed = bracketed};
  if (!node || !read_anchor(r, anchor, node, &open.anchor)) return false;
  r->stack[r->depth++] = open;
  return true;
}

static bool close_collection(reader *r, const yaml_event_t *event) {
  assert(r->depth > 0 && r->depth <= DEPTH_MOST);
  frame closed = r->stack[--r->depth];
  strut_tree *node = closed.node;
  /* Only a bracketed collection on one line has a length; a block is marked by its first character. */
  size_t line = event->end_mark.line + 1, column = event->end_mark.column + 1;
  if (event->end_mark.index > event->start_mark.index && line == node->place.line &&
      column > node->place.column)
    node->place.length = strut_place_at(0, 0, (uint32_t)column - node->place.column).length;
  if (node->kind == STRUT_TREE_MAP && !strut_document_check_keys(node, &r->keys, r->diagnostics))
    return out_of_memory(r);
  if (closed.anchor) {
    anchored_node *anchor = &r->anchors.items[closed.anchor - 1];
    anchor->weight = closed.weight;
    anchor->height = closed.height + 1;
  }
  attach(r, node, closed.weight, closed.height + 1);
  return true;
}

/* After the document only comments and its end mark are allowed. */
static bool check_rest(reader *r, const yaml_event_t *event) {
  strut_cursor *at = &r->cursor;
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
      r->diagnostics, place,
      next ? "a second document; a file holds one" : "text after the end of the document");
  return false;
}

static bool read_end(reader *r, const yaml_event_t *event) {
  const strut_tree *root = r->document->root;
  r->ended = true;
  if (root && (root->kind != STRUT_TREE_SCALAR || root->quoted || root->text[0] != '\0'))
    return event->type != YAML_DOCUMENT_END_EVENT || check_rest(r, event);
  strut_diagnose(r->diagnostics, (strut_place){0}, "the file is empty");
  return false;
}

static bool handle_event(reader *r, const yaml_event_t *event) {
  switch ((int)event->type) { /* as an int: of libyaml's kinds not all matter */
    case YAML_SCALAR_EVENT: return read_scalar(r, event);
    case YAML_ALIAS_EVENT: return read_alias(r, event);
    case YAML_MAPPING_START_EVENT:
    case YAML_SEQUENCE_START_EVENT: return open_collection(r, event);
    case YAML_MAPPING_END_EVENT:
    case YAML_SEQUENCE_END_EVENT: return close_collection(r, event);
    case YAML_DOCUMENT_END_EVENT:
    case YAML_STREAM_END_EVENT: return read_end(r, event);
    default: return true;
  }
}

/* ---- runs of rows, see rows.h ---- */

static void translate(reader *r, yaml_mark_t *mark) {
  run_marks *m = &r->marks;
  const strut_row_run *run = r->runs.run;
  while (m->passed < r->runs.count && mark->line + m->lines >= run[m->passed].line) {
    m->lines += run[m->passed].lines;
    m->bytes += run[m->passed].end - run[m->passed].begin;
    m->passed++;
  }
  while (m->passed > 0 &&
         mark->line + m->lines < run[m->passed - 1].line + run[m->passed - 1].lines) {
    m->passed--;
    m->lines -= run[m->passed].lines;
    m->bytes -= run[m->passed].end - run[m->passed].begin;
  }
  mark->line += m->lines;
  mark->index += m->bytes; /* rows are ASCII */
}

/* Nodes of a row, one after the other. They are as many values as the row has tokens, deferred or not. */
static strut_tree *new_row_nodes(reader *r, size_t count, const strut_row *row, strut_place place) {
  if (r->nodes + (uint64_t)row->count > NODES_MOST) {
    over_limit(r, place, "values", NODES_MOST);
    return NULL;
  }
  if (r->spare_count < count && !new_slab(r)) return NULL;
  strut_tree *nodes = r->spare;
  r->nodes += (uint64_t)row->count;
  r->spare += count;
  r->spare_count -= count;
  return nodes;
}

static const char *keep_row_text(void *context, const char *text, size_t length) {
  return keep_text(context, text, length);
}

/* Are rows of the open mapping deferred? An anchor's value is not, which an alias may put elsewhere. */
static bool defers_rows(const reader *r) {
  const char *const *key = r->deferred_keys;
  if (!key || r->depth != 2 || r->anchors.count || !r->stack[0].value_next) return false;
  while (*key && strcmp(*key, r->stack[0].last->text) != 0) key++;
  return *key != NULL;
}

/* Appends a row, which `text` begins with, to the open mapping. */
static bool append_row(reader *r, const char *text, uint32_t line, const strut_row *row,
                       bool defers) {
  const strut_row_token *value = &row->token[1];
  bool deferred = defers && strut_row_is_deferrable(row);
  int count = deferred ? 1 : row->count;
  strut_place place = strut_place_at(line, value->at + 1, value->length);
  strut_tree *nodes = new_row_nodes(r, deferred ? 2 : (size_t)count, row, place);
  if (!nodes) return false;
  if (!strut_row_build(row, count, text, line, nodes, keep_row_text, r)) return out_of_memory(r);
  if (deferred) {
    nodes[1] = (strut_tree){.kind = value->kind & 3u, .place = place};
    strut_row_defer(row, text, &nodes[1]);
    r->document->deferred = true;
  }
  attach(r, &nodes[0], 1, 0);
  attach(r, &nodes[1], (uint64_t)row->count - 1, (size_t)row->levels);
  return true;
}

/* Appends the rows of the next run to the open mapping, to which libyaml added the first one. */
static bool append_run(reader *r) {
  const strut_row_run *run = &r->runs.run[r->next_run++];
  const char *text = r->diagnostics->text;
  strut_row row;
  size_t at = run->begin;
  bool defers = defers_rows(r);
  r->run_depth = 0;
  for (uint32_t i = 0; i < run->lines; i++) {
    if (!strut_row_read(text + at, run->end - at, &row)) return false;
    if (!append_row(r, text + at, run->line + i + 1, &row, defers)) return false;
    at += row.length;
  }
  return true;
}

/*
 * Is the first row of the next run what it seemed to be? Then its key begins where the row does, in a
 * mapping that is no bracketed one. False: the line has come as something else.
 */
static bool meet_run(reader *r, const yaml_event_t *event) {
  if (r->next_run == r->runs.count || r->run_depth) return true;
  const strut_row_run *run = &r->runs.run[r->next_run];
  const yaml_mark_t *mark = &event->start_mark;
  if (mark->line + 1 < run->line) return true;
  bool text = event->type == YAML_SCALAR_EVENT, here = mark->line + 1 == run->line;
  if (here && !text && event->type != YAML_ALIAS_EVENT) return true; /* what begins or ends there */
  if (!text || !here || mark->column != run->indent || !key_expected(r)) return false;
  if (event->data.scalar.style != YAML_PLAIN_SCALAR_STYLE || event->data.scalar.anchor)
    return false;
  if (r->stack[r->depth - 1].bracketed || r->depth + STRUT_ROW_LEVELS > DEPTH_MOST) return false;
  r->run_depth = r->depth;
  return true;
}

/* Gives libyaml the text without the runs. */
static int give_input(void *context, unsigned char *buffer, size_t size, size_t *given) {
  reader *r = context;
  *given = 0;
  while (*given < size && r->input < r->diagnostics->length) {
    const strut_row_run *run = r->input_run < r->runs.count ? &r->runs.run[r->input_run] : NULL;
    size_t end = run ? run->begin : r->diagnostics->length, left = end - r->input;
    if (left > size - *given) left = size - *given;
    memcpy(buffer + *given, r->diagnostics->text + r->input, left);
    *given += left;
    r->input += left;
    if (run && r->input == run->begin) r->input = run->end, r->input_run++;
  }
  return 1;
}

static bool read_event(reader *r, yaml_event_t *event) {
  translate(r, &event->start_mark);
  translate(r, &event->end_mark);
  if (!meet_run(r, event)) return false;
  if (!handle_event(r, event)) return false;
  bool appended = r->run_depth && r->depth == r->run_depth && key_expected(r);
  return !appended || append_run(r);
}

static bool read_events(reader *r) {
  if (!yaml_parser_initialize(&r->yaml)) return out_of_memory(r);
  yaml_parser_set_encoding(&r->yaml, YAML_UTF8_ENCODING);
  r->input = strut_text_mark(r->diagnostics->text, r->diagnostics->length);
  yaml_parser_set_input(&r->yaml, give_input, r);
  bool fine = true;
  while (fine && !r->ended) {
    yaml_event_t event;
    if (yaml_parser_parse(&r->yaml, &event)) {
      fine = read_event(r, &event) && r->diagnostics->count < PROBLEMS_MOST;
      yaml_event_delete(&event);
    } else {
      const frame *open = r->depth ? &r->stack[r->depth - 1] : NULL;
      const strut_tree *bracket = open && open->bracketed ? open->node : NULL;
      fine = false;
      if (!strut_document_syntax_error(&r->yaml, bracket, r->diagnostics)) out_of_memory(r);
    }
  }
  yaml_parser_delete(&r->yaml);
  return fine;
}

/* Reads the text with these runs; whether all of it, and every run, was read. */
static bool read_with(strut_document *document, strut_diagnostics *diagnostics,
                      const strut_row_runs *runs, const char *const *deferred_keys,
                      bool *no_memory) {
  reader *r = strut_allocate(1, sizeof *r);
  *no_memory = !r;
  if (!r) return false;
  r->document = document;
  r->diagnostics = diagnostics;
  r->cursor = strut_cursor_begin(diagnostics->text, diagnostics->length);
  r->keys.seed = r->anchors.seed = (uint64_t)(uintptr_t)r ^ (uint64_t)time(NULL) << 20;
  r->runs = *runs;
  r->deferred_keys = deferred_keys;
  bool fine = read_events(r) && r->next_run == r->runs.count;
  if (!fine) document->root = NULL;
  *no_memory = r->no_memory || diagnostics->out_of_memory;
  free_anchors(&r->anchors);
  strut_release(r->keys.slots);
  strut_release(r);
  if (*no_memory) document->root = NULL;
  return fine && !*no_memory;
}

/* Reads runs of rows without libyaml. False: something is wrong; there is no message. */
static bool read_rows(strut_document *document, const strut_diagnostics *diagnostics,
                      uint32_t least, const char *const *keys, bool *no_memory) {
  strut_row_runs runs = {0};
  strut_diagnostics unused = {0};
  strut_diagnostics_source(&unused, diagnostics->file, diagnostics->text, diagnostics->length);
  *no_memory = !strut_row_runs_find(diagnostics->text, diagnostics->length, least, &runs);
  bool fine = !*no_memory && runs.count && read_with(document, &unused, &runs, keys, no_memory) &&
              !unused.count;
  strut_row_runs_free(&runs);
  strut_diagnostics_free(&unused);
  if (!fine) strut_document_free(document);
  return fine;
}

strut_status strut_document_read_rows(strut_document *document, strut_diagnostics *diagnostics,
                                      uint32_t least, const char *const *keys) {
  size_t before = diagnostics->count;
  bool no_memory = false;
  strut_row_runs none = {0};
  document->root = NULL;
  if (!strut_document_scan(diagnostics))
    return diagnostics->out_of_memory ? STRUT_NO_MEMORY : STRUT_BAD_SCENE;
  bool alone = !document->arena.chunk; /* what is not read well is released */
  if (least && alone && read_rows(document, diagnostics, least, keys, &no_memory)) return STRUT_OK;
  if (!no_memory) read_with(document, diagnostics, &none, NULL, &no_memory);
  if (no_memory) return STRUT_NO_MEMORY;
  return diagnostics->count > before ? STRUT_BAD_SCENE : STRUT_OK;
}

strut_status strut_document_read(strut_document *document, strut_diagnostics *diagnostics) {
  return strut_document_read_rows(document, diagnostics, STRUT_RUN_LEAST, NULL);
}

void strut_document_free(strut_document *document) {
  strut_arena_free(&document->arena);
  document->root = NULL;
  document->deferred = false;
}

strut_tree *strut_tree_find(const strut_tree *map, const char *key, strut_tree **key_node) {
  for (strut_tree *k = map->kind == STRUT_TREE_MAP ? map->first : NULL; k; k = k->next->next) {
    if (strcmp(k->text, key) != 0) continue;
    if (key_node) *key_node = k;
    return k->next;
  }
  return NULL;
}
