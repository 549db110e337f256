/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Differences that are whole copies of a part, `cell.5` of both nodes and members, become one each. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "parser/read/difference_copies.h"

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

static thing read_thing(const strut_difference *d) {
  static const char contacts[] = "ground.contacts.";
  thing t = {.section = d->where};
  bool whole = !d->was != !d->is;
  const char *dot = strchr(d->where, '.');
  if (strncmp(d->where, contacts, strlen(contacts)) == 0) {
    t.section += strlen("ground.");
    dot = d->where + strlen(contacts) - 1;
  }
  if (!whole || !dot) return t;
  t.name = dot + 1;
  t.section_length = (size_t)(dot - t.section);
  t.copy_length = copy_length(t.name);
  return t;
}

/* Does a scene have things of that copy? */
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
    const thing *t = &things[i];
    bool same = !taken[i] && t->copy_length == one->copy_length &&
                !list[i].was == !list[first].was &&
                strncmp(t->name, one->name, one->copy_length) == 0;
    if (!same) continue;
    size_t k = 0;
    while (k < used && (sections[k]->section_length != t->section_length ||
                        strncmp(sections[k]->section, t->section, t->section_length) != 0))
      k++;
    if (k == MOST_SECTIONS) continue;
    if (k == used) sections[used] = t, counts[used++] = 0;
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
static bool continues(const strut_difference *run, const char *last, const strut_difference *d,
                      const char *text) {
  size_t before, other;
  const char *was = run->was ? run->was : run->is, *is = d->was ? d->was : d->is;
  if (!run->was != !d->was || strcmp(text, is) != 0 || !was) return false;
  long a = last_number(last, &before), b = last_number(d->where, &other);
  return before == other && b == a + 1 && strncmp(last, d->where, before) == 0;
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

strut_status strut_differences_join_copies(const strut_tree *first, const strut_tree *second,
                                           strut_arena *arena, strut_difference *list,
                                           size_t *count) {
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
    const thing *t = &things[i];
    bool whole = t->copy_length && !has_copy(d.was ? second : first, t->name, t->copy_length, 0);
    if (whole) {
      const char *text = count_things(&scratch, list, things, i, all, taken);
      const char *where = strut_arena_text(arena, t->name, t->copy_length);
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
