/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scenes with parameters, groups and parts, as short as they were given. See write_scene.h. */
#include "parser/language/write/write_scene.h"

#include <math.h>
#include <string.h>

#include "engine/base/name_map.h"
#include "engine/base/text.h"
#include "parser/language/read/reuse/overlay.h"
#include "parser/language/write/writer.h"

/* ---- trees as they are ---- */

enum { WIDTH = 100, TOO_WIDE = WIDTH + 1 };

static bool is_plain(const strut_tree *scalar) {
  return !scalar->quoted && !strpbrk(scalar->text, "\n\r");
}

/* ---- on one line ---- */

/* Columns of the value within braces; TOO_WIDE: more than there are, or it cannot stand there. */
static size_t inline_width(const strut_tree *value) {
  size_t width = 2;
  if (value->kind == STRUT_TREE_SCALAR) {
    bool plain = is_plain(value);
    if (plain && (!*value->text || strpbrk(value->text, ",[]{}:?#"))) return TOO_WIDE;
    width = strnlen(value->text, WIDTH) + (plain ? 0 : 2);
    return width > WIDTH ? TOO_WIDE : width;
  }
  for (const strut_tree *child = value->first; child; child = child->next) {
    width += inline_width(child) + 2;
    if (width > WIDTH) return TOO_WIDE;
  }
  return width;
}

static void put_scalar(strut_writer *writer, const strut_tree *value) {
  if (is_plain(value))
    strut_put(writer, value->text);
  else
    strut_put_quoted(writer, value->text);
}

static void put_inline(strut_writer *writer, const strut_tree *value) {
  if (value->kind == STRUT_TREE_SCALAR) {
    put_scalar(writer, value);
    return;
  }
  bool map = value->kind == STRUT_TREE_MAP;
  strut_put(writer, map ? "{" : "[");
  for (const strut_tree *child = value->first; child; child = child->next) {
    if (child != value->first) strut_put(writer, ", ");
    put_inline(writer, child);
    if (!map) continue;
    strut_put(writer, ": ");
    child = child->next;
    put_inline(writer, child);
  }
  strut_put(writer, map ? "}" : "]");
}

/* ---- on several lines ---- */

static void put_indent(strut_writer *writer, size_t indent) {
  strut_put(writer, "\n");
  for (size_t i = 0; i < indent; i++) strut_put(writer, " ");
}

static bool holds_mappings(const strut_tree *map) {
  for (const strut_tree *tree = map->first; tree; tree = tree->next->next)
    if (tree->next->kind == STRUT_TREE_MAP) return true;
  return false;
}

/* May the value stand behind its key? Of the scene's keys, things have a line each. */
static bool fits(const strut_tree *value, size_t column, bool top) {
  if (value->kind == STRUT_TREE_SCALAR || !value->first) return true;
  if (top && value->kind == STRUT_TREE_MAP && holds_mappings(value)) return false;
  return column + inline_width(value) <= WIDTH;
}

static void put_lines(strut_writer *writer, const strut_tree *value, size_t indent, bool top);

/* What stands behind "key:" or "-". */
static void put_value(strut_writer *writer, const strut_tree *value, size_t indent, size_t column,
                      bool top) {
  if (value->kind == STRUT_TREE_SCALAR && is_plain(value) && !*value->text) return;
  if (!fits(value, column + 1, top)) {
    put_lines(writer, value, indent + 2, false);
    return;
  }
  strut_put(writer, " ");
  put_inline(writer, value);
}

static void put_lines(strut_writer *writer, const strut_tree *value, size_t indent, bool top) {
  for (const strut_tree *child = value->first; child; child = child->next) {
    size_t column = indent + 2;
    put_indent(writer, indent);
    if (value->kind == STRUT_TREE_LIST) {
      strut_put(writer, "-");
    } else {
      put_scalar(writer, child);
      strut_put(writer, ":");
      column += strnlen(child->text, WIDTH);
      child = child->next;
    }
    put_value(writer, child, indent, column, top);
  }
}

char *strut_tree_write(const strut_tree *root, const char *comment) {
  strut_writer w = {.scene = NULL};
  strut_c_locale locale = strut_c_locale_enter();
  strut_put(&w, "# ");
  strut_put(&w, comment);
  put_lines(&w, root, 0, true);
  strut_put(&w, "\n");
  strut_c_locale_leave(locale);
  return strut_buffer_take(&w.out);
}

/* ---- scenes with their parts ---- */

static const char comment[] = "A scene with its parameters, groups and parts.";
static const strut_mapping_kind scene_kind = {STRUT_SECTION_SCENE, false};

/* What the functions below need; they return NULL where memory is out. */
typedef struct short_writer {
  strut_document document; /* owns what is made */
  const strut_scene_source *source;
  const strut_setup *setup;
} short_writer;

/* ---- parameters as they were set ---- */

/* What --set gave, in the words of the file: a plain number has the unit that was declared. */
static strut_tree *set_value(short_writer *self, const strut_tree *like, const strut_setting *set) {
  const strut_declared *declared = strut_scene_source_parameter(self->source, set->name);
  char number[STRUT_NUMBER_TEXT];
  if (!declared || declared->text || declared->bare) {
    strut_tree *text = strut_tree_scalar(&self->document.arena, like, set->text);
    if (text) text->quoted = declared && declared->text;
    return text;
  }
  const strut_parameter *used = strut_parameter_named(&self->setup->scene, set->name);
  strut_number_text(used ? used->value : (double)NAN, number);
  const char *unit = strut_dimension_unit(declared->dimension);
  if (strcmp(unit, "SI") == 0)
    return strut_tree_scalar(&self->document.arena, like, set->text); /* it has none */
  bool plain = strcmp(unit, "1") == 0;
  return strut_tree_scalar(&self->document.arena, like,
                           strut_arena_format(&self->document.arena, "%s%s%s", number,
                                              plain ? "" : " ", plain ? "" : unit));
}

/* {parameters: {NAME: VALUE, ...}} */
static strut_tree *settings_tree(short_writer *self, const strut_tree *root,
                                 const strut_setting *overrides, size_t count) {
  strut_arena *arena = &self->document.arena;
  strut_tree_builder map = strut_tree_begin(arena, root), inner = strut_tree_begin(arena, root);
  for (size_t i = 0; i < count; i++)
    if (!strut_tree_append(&inner, strut_tree_scalar(arena, root, overrides[i].name),
                           set_value(self, root, &overrides[i])))
      return NULL;
  strut_tree *name = strut_tree_scalar(arena, root, "parameters");
  return strut_tree_append(&map, name, inner.map) ? map.map : NULL;
}

/* ---- what has changed ---- */

/* Both texts have their keys in one order, so that a key is looked for where the last one was found. */
static const strut_tree *find_from(const strut_tree *map, const strut_tree **at, const char *name) {
  for (const strut_tree *tree = *at; tree; tree = tree->next->next)
    if (strcmp(tree->text, name) == 0) return *at = tree->next->next, tree;
  for (const strut_tree *k = map->first; k && k != *at; k = k->next->next)
    if (strcmp(k->text, name) == 0) return *at = k->next->next, k;
  return NULL;
}

/*
 * The keys of `after` that `before` has not, or with another value, and removals of those that are gone. The start and
 * configurations are replaced whole, since the file may say them in another way: `cut` has the removals of these alone.
 */
static strut_tree *difference(short_writer *self, strut_mapping_kind kind, const strut_tree *before,
                              const strut_tree *after, bool cut) {
  strut_arena *arena = &self->document.arena;
  strut_tree_builder map = strut_tree_begin(arena, after);
  const strut_tree *at = before->first;
  if (!map.map) return NULL;
  for (const strut_tree *tree = after->first; tree; tree = tree->next->next) {
    const strut_tree *was = find_from(before, &at, tree->text);
    if (was && strut_tree_equal(was->next, tree->next)) continue;
    strut_mapping_kind below = strut_kind_below(kind, tree->text);
    bool shape =
        below.section == STRUT_SECTION_INITIAL || below.section == STRUT_SECTION_CONFIGURATION;
    if (cut && !(was && shape)) continue;
    bool maps = was && was->next->kind == STRUT_TREE_MAP && tree->next->kind == STRUT_TREE_MAP;
    strut_tree *value = cut              ? strut_tree_scalar(arena, tree, "remove")
                        : maps && !shape ? difference(self, below, was->next, tree->next, false)
                                         : strut_tree_copy(arena, tree->next);
    if (!strut_tree_append(&map, strut_tree_copy(arena, tree), value)) return NULL;
  }
  if (cut) return map.map;
  at = after->first;
  for (const strut_tree *k = before->first; k; k = k->next->next) {
    if (find_from(after, &at, k->text) || strut_says_otherwise(kind, map.map, k->text)) continue;
    strut_tree *value = strut_tree_scalar(arena, k, "remove");
    if (!strut_tree_append(&map, strut_tree_copy(arena, k), value)) return NULL;
  }
  return map.map;
}

/* Cuts out the record of parameters, whose values stand in the numbers. */
static void drop_parameters(char *text) {
  char *from = text ? strstr(text, "\nparameters:") : NULL, *to = from;
  if (!from) return;
  do to = strchr(to + 1, '\n');
  while (to && to[1] == ' ');
  memmove(from, to ? to : "", to ? strlen(to) + 1 : 1);
}

static char *write_flat(const strut_setup *setup) {
  char *text = strut_setup_write(setup);
  drop_parameters(text);
  return text;
}

static strut_tree *read_flat(short_writer *self, const char *text) {
  strut_diagnostics diagnostics = {0};
  strut_diagnostics_source(&diagnostics, "scene", text, strlen(text));
  strut_document_read(&self->document, &diagnostics);
  strut_diagnostics_free(&diagnostics);
  return self->document.root;
}

/* ---- groups of a base that nothing uses any more ---- */

static bool collect_groups(const strut_tree *tree, strut_name_map *names) {
  bool map = tree->kind == STRUT_TREE_MAP, fine = true;
  const strut_tree *isolated = map ? strut_tree_find(tree, "isolated", NULL) : NULL;
  if (tree->kind == STRUT_TREE_SCALAR || (isolated && strcmp(isolated->text, "yes") == 0))
    return true;
  for (const strut_tree *k = tree->first; k && fine; k = k->next) {
    const strut_tree *value = map ? k->next : k;
    fine = collect_groups(value, names);
    const strut_tree *item = value->kind == STRUT_TREE_LIST ? value->first : value;
    for (; map && strcmp(k->text, "group") == 0 && item; item = item == value ? NULL : item->next)
      if (item->kind == STRUT_TREE_SCALAR) fine = strut_name_map_add(names, item->text, 0) != -2;
    k = value;
  }
  return fine;
}

/* In a file of its own an unused group would be an error. Changes the root, whose entries are not shared. */
static bool drop_unused_groups(short_writer *self, strut_tree *root) {
  strut_tree *key = NULL, *groups = strut_tree_find(root, "groups", &key);
  strut_name_map names = {0};
  if (!groups || groups->kind != STRUT_TREE_MAP) return true;
  strut_tree_builder kept = strut_tree_begin(&self->document.arena, groups);
  bool fine = kept.map && collect_groups(root, &names);
  for (const strut_tree *tree = groups->first; tree && fine; tree = tree->next->next)
    if (!tree->place.file || strut_name_map_find(&names, tree->text) >= 0)
      fine = strut_tree_share(&kept, &self->document.arena, tree, tree->next);
  strut_name_map_free(&names);
  if (!fine) return false;
  kept.map->next = groups->next;
  key->next = kept.map;
  if (!kept.map->count) strut_tree_drop(root, "groups");
  return true;
}

/* ---- the whole ---- */

/* The root with the mapping laid over it; what it removes may be there in another way. */
static strut_tree *lay_over(short_writer *self, const strut_tree *root, const strut_tree *over) {
  strut_diagnostics unsaid = {0};
  const strut_overlay overlay = {.arena = &self->document.arena, .diagnostics = &unsaid};
  strut_tree *result = strut_lay_over(&overlay, scene_kind, root, over);
  strut_diagnostics_free(&unsaid);
  return result;
}

static strut_tree *whole_tree(short_writer *self, const strut_setting *overrides, size_t count,
                              const char *before, const char *after) {
  const strut_tree *root = self->source->document.root;
  const strut_tree *old = read_flat(self, before), *now = old ? read_flat(self, after) : NULL;
  const strut_tree *over = now ? difference(self, scene_kind, old, now, false) : NULL;
  const strut_tree *cut = now ? difference(self, scene_kind, old, now, true) : NULL;
  if (count) {
    const strut_tree *set = settings_tree(self, root, overrides, count);
    root = set ? lay_over(self, root, set) : NULL;
  }
  root = root && cut ? lay_over(self, root, cut) : NULL;
  strut_tree *whole = root && over ? lay_over(self, root, over) : NULL;
  return whole && drop_unused_groups(self, whole) ? whole : NULL;
}

static strut_status reads_as(const char *name, const char *text, const char *flat, bool *same) {
  strut_setup setup;
  strut_diagnostics diagnostics = {0};
  strut_status status = strut_setup_read(&setup, name, text, strlen(text), NULL, 0,
                                         STRUT_FOR_ANY_STATICS, &diagnostics);
  strut_diagnostics_free(&diagnostics);
  *same = false;
  if (status) return status == STRUT_NO_MEMORY ? status : STRUT_OK;
  char *again = write_flat(&setup);
  strut_setup_free(&setup);
  if (!again) return STRUT_NO_MEMORY;
  *same = strcmp(again, flat) == 0;
  strut_release(again);
  return STRUT_OK;
}

strut_status strut_short_write(strut_scene_source *source, const strut_setting *overrides,
                               size_t override_count, const char *before, const strut_setup *setup,
                               const char *name, char **text) {
  short_writer w = {.source = source, .setup = setup};
  bool same = false;
  char *after = write_flat(setup);
  char *first = strut_arena_text(&w.document.arena, before, strlen(before));
  drop_parameters(first);
  const strut_tree *root =
      after && first ? whole_tree(&w, overrides, override_count, first, after) : NULL;
  *text = root ? strut_tree_write(root, comment) : NULL;
  strut_status status = *text ? reads_as(name, *text, after, &same) : STRUT_NO_MEMORY;
  if (!same) {
    strut_release(*text);
    *text = NULL;
  }
  strut_release(after);
  strut_document_free(&w.document);
  return status;
}
