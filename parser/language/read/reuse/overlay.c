/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/language/read/reuse/overlay.h"

#include <stdlib.h>
#include <string.h>

#include "engine/base/name_map.h"
#include "parser/language/yaml/document.h"

/* ---- what a mapping is ---- */

strut_mapping_kind strut_kind_below(strut_mapping_kind kind, const char *key) {
  const strut_mapping_kind nothing = {STRUT_SECTION_COUNT, false};
  if (kind.section == STRUT_SECTION_COUNT) return nothing;
  if (kind.things) return (strut_mapping_kind){kind.section, false};
  int k = strut_key_find(kind.section, strut_key_current(kind.section, key));
  if (k < 0) return nothing;
  const strut_key *row = strut_key_at(k);
  if (row->type == STRUT_TYPE_SIGNAL) return (strut_mapping_kind){STRUT_SECTION_SIGNAL, false};
  return (strut_mapping_kind){strut_section_below(row), row->type == STRUT_TYPE_THINGS};
}

/* ---- keys that replace each other ---- */

/* Pairs of keys of which the first, laid over, also replaces the second. */
static const char *const rivals[][2] = {
    {"duration", "of"},           {"step", "accuracy"},      {"integrator", "accuracy"},
    {"equilibrium", "positions"}, {"equilibrium", "settle"}, {"configuration", "equilibrium"},
    {"positions", "equilibrium"}, {"settle", "equilibrium"}, {"equilibrium", "configuration"}};

enum { RIVALS = sizeof rivals / sizeof rivals[0] };

/* The name of a key in a mapping: it may have its former one. */
static const char *current(strut_mapping_kind kind, const strut_tree *key) {
  bool keys = kind.section != STRUT_SECTION_COUNT && !kind.things;
  return keys ? strut_key_current(kind.section, key->text) : key->text;
}

static int find_key(strut_mapping_kind kind, const char *name) {
  bool keys = kind.section != STRUT_SECTION_COUNT && !kind.things;
  return keys ? strut_key_find(kind.section, name) : -1;
}

/* The keys of a mapping by name. */
typedef struct key_index {
  strut_mapping_kind kind;
  strut_name_map names;
  const strut_tree **key;
  uint64_t sets;      /* bits: of some key, see keys_table.h */
  bool beats[RIVALS]; /* the first of the pair is there */
} key_index;

static bool index_keys(key_index *index, strut_mapping_kind kind, const strut_tree *map) {
  *index =
      (key_index){.kind = kind, .key = strut_allocate((size_t)map->count + 1, sizeof *index->key)};
  if (!index->key) return false;
  size_t count = 0;
  for (const strut_tree *tree = map->first; tree; tree = tree->next->next, count++) {
    const char *name = current(kind, tree);
    index->key[count] = tree;
    if (strut_name_map_add(&index->names, name, (int32_t)count) == -2) return false;
    int key = find_key(kind, name);
    if (key >= 0 && strut_key_at(key)->set) index->sets |= UINT64_C(1) << strut_key_at(key)->set;
    for (size_t i = 0; i < RIVALS && key >= 0; i++)
      if (strcmp(name, rivals[i][0]) == 0) index->beats[i] = true;
  }
  return true;
}

static void free_index(key_index *index) {
  strut_name_map_free(&index->names);
  strut_release(index->key);
}

/* The key that says the same, or NULL. */
static const strut_tree *same_key(const key_index *index, const strut_tree *key) {
  int32_t i = strut_name_map_find(&index->names, current(index->kind, key));
  return i < 0 ? NULL : index->key[i];
}

/* Does some key that is laid over say the same as this one in another way? */
static bool is_replaced(const key_index *over, const strut_tree *key) {
  const char *name = current(over->kind, key);
  int found = find_key(over->kind, name);
  if (found < 0) return false;
  for (size_t i = 0; i < RIVALS; i++)
    if (over->beats[i] && strcmp(name, rivals[i][1]) == 0) return true;
  return strut_key_at(found)->set && over->sets >> strut_key_at(found)->set & 1;
}

bool strut_says_otherwise(strut_mapping_kind kind, const strut_tree *map, const char *key) {
  int k = find_key(kind, key), set = k < 0 ? 0 : strut_key_at(k)->set;
  for (const strut_tree *other = map->first; other && set; other = other->next->next) {
    int o = find_key(kind, other->text);
    if (o >= 0 && o != k && strut_key_at(o)->set == set) return true;
  }
  return false;
}

/* ---- trees ---- */

static strut_tree *marked_node(const strut_overlay *overlay, const strut_tree *node) {
  strut_tree *copy = strut_tree_copy(overlay->arena, node);
  if (copy && overlay->file) copy->place.file = overlay->file & 0xFFu;
  return copy;
}

/* A copy of what is laid over, all the way down where its nodes are not as they were. */
static strut_tree *marked_tree(const strut_overlay *overlay, const strut_tree *node) {
  strut_placed_tree placed = {*node, NULL};
  if (overlay->of_scene) placed.tree.placed = true;
  strut_tree *copy = marked_node(overlay, overlay->of_scene ? &placed.tree : node);
  if (!copy || !(overlay->file || overlay->of_scene)) return copy;
  strut_tree **end = &copy->first;
  for (const strut_tree *child = node->first; child; child = child->next) {
    *end = marked_tree(overlay, child);
    if (!*end) return NULL;
    end = &(*end)->next;
  }
  return copy;
}

bool strut_is_removal(const strut_tree *value) {
  return value->kind == STRUT_TREE_SCALAR && !value->quoted && strcmp(value->text, "remove") == 0;
}

/* `[x, y]` of a node as {position: [x, y]}. NULL: memory is out. */
static strut_tree *written_out(strut_arena *arena, const strut_tree *list) {
  strut_tree_builder map = strut_tree_begin(arena, list);
  strut_tree *key = strut_tree_scalar(arena, list, "position");
  return strut_tree_append(&map, key, strut_tree_copy(arena, list)) ? map.map : NULL;
}

static bool is_node(strut_mapping_kind kind) {
  return kind.section == STRUT_SECTION_NODE && !kind.things;
}

/* The value of a key that both mappings have. */
static strut_tree *joined(const strut_overlay *overlay, strut_mapping_kind kind,
                          const strut_tree *below, const strut_tree *over) {
  bool part = kind.section == STRUT_SECTION_PART && !kind.things;
  bool maps = below->kind == STRUT_TREE_MAP && over->kind == STRUT_TREE_MAP;
  bool place = is_node(kind) && below->kind + over->kind == STRUT_TREE_MAP + STRUT_TREE_LIST;
  if (overlay->whole || !(maps || place) || (part && strut_tree_find(over, "use", NULL)))
    return marked_tree(overlay, over);
  return strut_lay_over(overlay, kind, below, over);
}

static const char *name_at(const void *context, size_t i) {
  const strut_tree *tree = ((const strut_tree *)context)->first;
  while (tree && i-- > 0) tree = tree->next->next;
  return tree ? tree->text : NULL;
}

/* Takes away what is not there? Things of copies are looked for when these are made. */
static bool removes_nothing(const strut_overlay *overlay, const strut_tree *base,
                            const strut_tree *key) {
  if (!overlay->diagnostics || !strut_is_removal(key->next) || strpbrk(key->text, ".*"))
    return false;
  const strut_near near =
      base->count <= 1000 ? strut_near_to(key->text, name_at, base) : (strut_near){""};
  int shown = (int)strcspn(key->text, "\n");
  strut_diagnose(overlay->diagnostics, key->place, "there is no '%.*s' to remove%s",
                 shown > 64 ? 64 : shown, key->text, near.text);
  return true;
}

/* The keys of the base, changed or not, then those that it has not. */
static bool join(const strut_overlay *overlay, const key_index *below, const strut_tree *base,
                 const key_index *above, const strut_tree *over, strut_tree_builder *builder) {
  for (const strut_tree *tree = base->first; tree; tree = tree->next->next) {
    const strut_tree *by = same_key(above, tree);
    if (by ? strut_is_removal(by->next) : is_replaced(above, tree)) continue;
    strut_mapping_kind value = strut_kind_below(below->kind, tree->text);
    bool fine = by ? strut_tree_append(builder, marked_node(overlay, by),
                                       joined(overlay, value, tree->next, by->next))
                   : strut_tree_share(builder, overlay->arena, tree, tree->next);
    if (!fine) return false;
  }
  for (const strut_tree *k = over->first; k; k = k->next->next) {
    if (same_key(below, k) || removes_nothing(overlay, base, k)) continue;
    if (!strut_tree_append(builder, marked_node(overlay, k), marked_tree(overlay, k->next)))
      return false;
  }
  return true;
}

strut_tree *strut_lay_over(const strut_overlay *overlay, strut_mapping_kind kind,
                           const strut_tree *base, const strut_tree *over) {
  if (is_node(kind) && base->kind == STRUT_TREE_LIST) base = written_out(overlay->arena, base);
  if (is_node(kind) && over->kind == STRUT_TREE_LIST) over = written_out(overlay->arena, over);
  strut_tree *map = base && over ? strut_tree_copy(overlay->arena, base) : NULL;
  if (!map) return NULL;
  strut_tree_builder b = {map, &map->first};
  key_index below = {0}, above = {0};
  map->count = 0;
  map->first = NULL;
  bool fine = index_keys(&below, kind, base) && index_keys(&above, kind, over) &&
              join(overlay, &below, base, &above, over, &b);
  free_index(&below);
  free_index(&above);
  return fine ? map : NULL;
}

/* Differences of two scenes, as their effective texts. See overlay.h. */

/* The two scenes under comparison. */
typedef struct comparison {
  strut_arena *arena; /* of the results */
  strut_difference *list;
  size_t count, room;
  bool failed; /* memory was out */
} comparison;

/* Joins three texts in the arena; values are short. */
static const char *join_texts(comparison *self, const char *first, const char *second,
                              const char *d) {
  const char *text =
      first && second && d ? strut_arena_format(self->arena, "%s%s%s", first, second, d) : NULL;
  if (!text) self->failed = true;
  return text;
}

/* A value as it would stand on one line. */
static const char *flat(comparison *self, const strut_tree *tree) {
  if (tree->kind == STRUT_TREE_SCALAR) return join_texts(self, tree->text, "", "");
  bool map = tree->kind == STRUT_TREE_MAP;
  const char *text = map ? "{" : "[";
  for (const strut_tree *t = tree->first; t && !self->failed; t = t->next) {
    if (t != tree->first) text = join_texts(self, text, ", ", "");
    if (map) {
      text = join_texts(self, text, t->text, ": ");
      t = t->next;
    }
    text = join_texts(self, text, flat(self, t), "");
  }
  return join_texts(self, text, map ? "}" : "]", "");
}

static void add(comparison *self, const char *where, const strut_tree *was, const strut_tree *is) {
  if (self->count == self->room) {
    size_t room = 2 * self->room + 64;
    strut_difference *list = strut_arena_allocate(self->arena, room, sizeof *list);
    if (!list) {
      self->failed = true;
      return;
    }
    for (size_t i = 0; i < self->count; i++) list[i] = self->list[i];
    self->list = list;
    self->room = room;
  }
  self->list[self->count++] = (strut_difference){
      .where = where, .was = was ? flat(self, was) : NULL, .is = is ? flat(self, is) : NULL};
}

/* Names and descriptions do not count as differences. */
static bool is_label(const char *where) {
  return strcmp(where, "name") == 0 || strcmp(where, "description") == 0 ||
         strcmp(where, "source") == 0;
}

static void compare(comparison *self, const char *where, const strut_tree *first,
                    const strut_tree *second);

static void compare_maps(comparison *self, const char *where, const strut_tree *first,
                         const strut_tree *second) {
  const char *dot = *where ? "." : "";
  for (const strut_tree *key = first->first; key && !self->failed; key = key->next->next) {
    const char *here = join_texts(self, where, dot, key->text);
    const strut_tree *other = strut_tree_find(second, key->text, NULL);
    if (!here || is_label(here)) continue;
    if (other)
      compare(self, here, key->next, other);
    else
      add(self, here, key->next, NULL);
  }
  for (const strut_tree *key = second->first; key && !self->failed; key = key->next->next) {
    const char *here = join_texts(self, where, dot, key->text);
    if (here && !is_label(here) && !strut_tree_find(first, key->text, NULL))
      add(self, here, NULL, key->next);
  }
}

static void compare(comparison *self, const char *where, const strut_tree *first,
                    const strut_tree *second) {
  if (first->kind == STRUT_TREE_MAP && second->kind == STRUT_TREE_MAP)
    compare_maps(self, where, first, second);
  else if (!strut_tree_equal(first, second))
    add(self, where, first, second);
}

/* ---- copies of parts ---- */

enum { MOST_SECTIONS = 16 };

/* A thing that one scene has and the other has not: "members.cell.5.top". */
typedef struct thing {
  const char *name, *section; /* "cell.5.top", "members.cell.5.top" */
  size_t section_length;      /* of "members" */
  size_t copy_length;         /* of "cell.5"; 0: it belongs to no copy */
} thing;

static bool is_number(const char *piece) {
  size_t length = strcspn(piece, ".");
  return length > 0 && strspn(piece, "0123456789") == length;
}

/* The length of "cell.5" in "cell.5.top"; 0: the name has no number with something behind it. */
static size_t copy_length(const char *name) {
  const char *dot = strchr(name, '.'), *end = NULL;
  while (dot && !end) {
    for (const char *next = dot; next && is_number(next + 1); next = strchr(next + 1, '.'))
      if (strchr(next + 1, '.')) end = strchr(next + 1, '.');
    dot = strchr(dot + 1, '.');
  }
  return end ? (size_t)(end - name) : 0;
}

static thing read_thing(const strut_difference *difference) {
  static const char contacts[] = "ground.contacts.";
  thing t = {.section = difference->where};
  bool whole = !difference->was != !difference->is;
  const char *dot = strchr(difference->where, '.');
  if (strncmp(difference->where, contacts, strlen(contacts)) == 0) {
    t.section += strlen("ground.");
    dot = difference->where + strlen(contacts) - 1;
  }
  if (!whole || !dot) return t;
  t.name = dot + 1;
  t.section_length = (size_t)(dot - t.section);
  t.copy_length = copy_length(t.name);
  return t;
}

static bool has_copy(const strut_tree *map, const char *copy, size_t length, int depth) {
  for (const strut_tree *key = map->first; key; key = key->next->next) {
    if (depth > 0 && strncmp(key->text, copy, length) == 0 && key->text[length] == '.') return true;
    bool deeper = key->next->kind == STRUT_TREE_MAP && depth < 2;
    if (deeper && has_copy(key->next, copy, length, depth + 1)) return true;
  }
  return false;
}

/* "2 nodes, 5 members": all that one scene has of the copy of thing `first`. Takes these out. */
static const char *count_things(strut_arena *arena, const strut_difference *list,
                                const thing *things, size_t first, size_t count, bool *taken) {
  const thing *sections[MOST_SECTIONS], *one = &things[first];
  size_t counts[MOST_SECTIONS], used = 0;
  for (size_t i = first; i < count; i++) {
    const thing *self = &things[i];
    bool same = !taken[i] && self->copy_length == one->copy_length &&
                !list[i].was == !list[first].was &&
                strncmp(self->name, one->name, one->copy_length) == 0;
    if (!same) continue;
    size_t k = 0;
    while (k < used && (sections[k]->section_length != self->section_length ||
                        strncmp(sections[k]->section, self->section, self->section_length) != 0))
      k++;
    if (k == MOST_SECTIONS) continue;
    if (k == used) sections[used] = self, counts[used++] = 0;
    counts[k]++;
    taken[i] = true;
  }
  const char *text = "";
  for (size_t k = 0; k < used && text; k++) {
    size_t length = sections[k]->section_length - (counts[k] == 1); /* "1 member" */
    text = strut_arena_format(arena, "%s%s%zu %.*s", text, k ? ", " : "", counts[k], (int)length,
                              sections[k]->section);
  }
  return text;
}

/* The number at the end of "cell.5", and the length of what is before it. */
static long last_number(const char *copy, size_t *before) {
  const char *dot = strrchr(copy, '.');
  *before = (size_t)(dot + 1 - copy);
  return strtol(dot + 1, NULL, 10);
}

/* Is `d` the copy behind the last one of the run of equal copies that `run` is? */
static bool continues(const strut_difference *run, const char *last,
                      const strut_difference *difference, const char *text) {
  size_t before, other;
  const char *was = run->was ? run->was : run->is,
             *is = difference->was ? difference->was : difference->is;
  if (!run->was != !difference->was || strcmp(text, is) != 0 || !was) return false;
  long a = last_number(last, &before), b = last_number(difference->where, &other);
  return before == other && b == a + 1 && strncmp(last, difference->where, before) == 0;
}

/* Equal copies with numbers in a row become one difference. */
static size_t join_runs(strut_arena *arena, strut_difference *list, const bool *copies,
                        size_t count) {
  size_t kept = 0;
  for (size_t i = 0; i < count;) {
    strut_difference run = list[i];
    const char *text = run.was ? run.was : run.is;
    size_t end = i + 1;
    while (copies[i] && end < count && copies[end] &&
           continues(&run, list[end - 1].where, &list[end], text))
      end++;
    if (end - i > 1) {
      const char *where = strut_arena_format(arena, "%s to %s", list[i].where, list[end - 1].where);
      const char *each = strut_arena_format(arena, "each %s", text);
      if (where && each) {
        run.where = where;
        *(run.was ? &run.was : &run.is) = each;
      }
    }
    list[kept++] = run;
    i = end;
  }
  return kept;
}

/*
 * Joins what only one of two scenes has and belongs to one copy that the other lacks: "cell.5", with the value
 * "2 nodes, 5 members"; copies in a row that are alike become "cell.5 to cell.9". Shortens the list.
 */
static strut_status join_copies(const strut_tree *first, const strut_tree *second,
                                strut_arena *arena, strut_difference *list, size_t *count) {
  strut_arena scratch = {0};
  size_t all = *count, kept = 0;
  thing *things = strut_arena_allocate(&scratch, all, sizeof *things);
  bool *taken = strut_arena_allocate(&scratch, all, sizeof *taken);
  bool *copies = strut_arena_allocate(&scratch, all, sizeof *copies);
  strut_status status = things && taken && copies ? STRUT_OK : STRUT_NO_MEMORY;
  for (size_t i = 0; i < all && status == STRUT_OK; i++) {
    things[i] = read_thing(&list[i]);
    taken[i] = copies[i] = false;
  }
  for (size_t i = 0; i < all && status == STRUT_OK; i++) {
    if (taken[i]) continue;
    strut_difference d = list[i];
    const thing *self = &things[i];
    bool whole =
        self->copy_length && !has_copy(d.was ? second : first, self->name, self->copy_length, 0);
    if (whole) {
      const char *text = count_things(&scratch, list, things, i, all, taken);
      const char *where = strut_arena_text(arena, self->name, self->copy_length);
      text = text ? strut_arena_text(arena, text, strlen(text)) : NULL;
      if (!text || !where) status = STRUT_NO_MEMORY;
      d = (strut_difference){where, d.was ? text : NULL, d.was ? NULL : text};
    }
    copies[kept] = whole;
    list[kept++] = d; /* at i or before, which was read already */
  }
  if (status == STRUT_OK) *count = join_runs(arena, list, copies, kept);
  strut_arena_free(&scratch);
  return status;
}

/* ---- two texts ---- */

static strut_status read(const char *text, strut_document *document,
                         strut_diagnostics *diagnostics) {
  strut_diagnostics_source(diagnostics, "", text, strlen(text));
  strut_status status = strut_document_read(document, diagnostics);
  return status == STRUT_OK && !document->root ? STRUT_BAD_SCENE : status;
}

strut_status strut_text_differences(const char *first, const char *second, strut_arena *arena,
                                    strut_difference **list, size_t *count) {
  comparison c = {.arena = arena};
  strut_document a = {0}, b = {0};
  strut_diagnostics about_a = {0}, about_b = {0};
  *list = NULL;
  *count = 0;
  strut_status status = read(first, &a, &about_a);
  if (status == STRUT_OK) status = read(second, &b, &about_b);
  if (status == STRUT_OK) {
    compare(&c, "", a.root, b.root);
    if (c.failed) status = STRUT_NO_MEMORY;
    if (status == STRUT_OK && c.count)
      status = join_copies(a.root, b.root, arena, c.list, &c.count);
  }
  if (status == STRUT_OK) {
    *list = c.list;
    *count = c.count;
  }
  strut_document_free(&a);
  strut_document_free(&b);
  strut_diagnostics_free(&about_a);
  strut_diagnostics_free(&about_b);
  return status;
}
