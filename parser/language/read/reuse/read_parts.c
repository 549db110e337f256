/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Parts and their placement: every copy becomes entries of the scene's own mappings. See copies.h.
 *
 * An entry of a copy has a name and a head of its own and shares all below with the part, so that a copy
 * costs little. The first copy tells how large all are, and counts that are too large are refused at their number.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "parser/language/read/reuse/copies.h"

/* ---- parts ---- */

static void read_part_list(strut_reader *reader, const strut_slot *slot, strut_copy *home,
                           strut_part_list *list) {
  const strut_tree *map = slot->state == STRUT_GIVEN ? slot->value : NULL;
  *list = (strut_part_list){0};
  if (!map) return;
  list->part = strut_scratch_array(reader, map->count, sizeof *list->part);
  for (const strut_tree *key = map->first; key && list->part; key = key->next->next) {
    strut_part *part = &list->part[list->count++];
    *part = (strut_part){.name = key->text, .key = key, .home = home};
    strut_owner owner = {"part", key->text};
    bool fine = strut_read_name(reader, key, "part");
    strut_read_fields(reader, STRUT_SECTION_PART, key->next, owner, &part->fields);
    strut_store(reader, &part->fields, &part->keys);
    part->broken = !fine || part->fields.broken || part->keys.use; /* a file that was not read */
  }
}

/* The part of that name which a scope sees. */
static strut_part *find_part(strut_reader *reader, const strut_copy *scope, const char *name,
                             const strut_part_list **nearest) {
  for (;; scope = scope->home) {
    const strut_part_list *list = scope ? &scope->parts : &reader->copies->parts;
    for (size_t i = 0; i < list->count; i++)
      if (strcmp(list->part[i].name, name) == 0) return &list->part[i];
    if (list->count || !scope) *nearest = list;
    if (!scope || scope->closed) return NULL;
  }
}

static strut_part *read_part_name(strut_reader *reader, const strut_copy *scope,
                                  const strut_tree *name, strut_owner owner) {
  const strut_part_list *nearest = &reader->copies->parts;
  if (!name) return NULL;
  strut_part *part = find_part(reader, scope, name->text, &nearest);
  if (part || strut_slot_of(&reader->top, STRUT_KEY_SCENE_PARTS)->state == STRUT_BROKEN)
    return part;
  strut_report_error(
      reader, name->place, "unknown part '%s' in 'part' of %s%s",
      strut_sanitised_text(reader, name->text), strut_owner_text(reader, owner),
      strut_hint_of_rows(reader, name->text, STRUT_NAMED(nearest->part, nearest->count)));
  return NULL;
}

/* ---- scopes of copies ---- */

static strut_copy *new_scope(strut_expansion *expansion, strut_scope_kind kind,
                             const strut_placement *placement, strut_copy *outer) {
  strut_copy *copy = strut_scratch_array(expansion->reader, 1, sizeof *copy);
  if (!copy) {
    expansion->stopped = true;
    return NULL;
  }
  *copy = (strut_copy){.kind = kind,
                       .placement = placement,
                       .outer = outer,
                       .home = outer,
                       .prefix = "",
                       .frame = strut_frame_of_scene,
                       .within = strut_frame_of_scene};
  if (expansion->latest) expansion->latest->made_next = copy;
  return expansion->latest = copy;
}

/* "cell.3." */
static const char *make_prefix(strut_expansion *expansion, const strut_placement *placement,
                               const int64_t number[2]) {
  strut_reader *reader = expansion->reader;
  strut_arena *arena = &reader->scratch;
  long long i = (long long)number[0], j = (long long)number[1];
  return placement->numbers == 2
             ? strut_formatted(reader, arena, "%s.%lld.%lld.", placement->name, i, j)
         : placement->numbers == 1 ? strut_formatted(reader, arena, "%s.%lld.", placement->name, i)
                                   : strut_formatted(reader, arena, "%s.", placement->name);
}

/* The parameters of a copy: those of the part, with the values of `set`. */
static bool read_copy_parameters(strut_reader *reader, strut_copy *copy, strut_copy *place,
                                 const strut_tree *set) {
  const strut_tree *map = copy->placement->part->keys.parameters;
  const strut_tree *given = set ? set->first : NULL;
  bool fine = true;
  copy->parameters = strut_scratch_array(reader, map ? map->count : 0, sizeof *copy->parameters);
  strut_part_value *values = strut_scratch_array(reader, map ? map->count : 0, sizeof *values);
  if (!copy->parameters || !values) return false;
  for (const strut_tree *key = map ? map->first : NULL; key; key = key->next->next) {
    strut_parameter_state *parameters = &copy->parameters[copy->parameter_count++];
    strut_declare_parameter(reader, key, parameters);
    parameters->of_part = values++;
    parameters->of_part->scope = copy;
    if (!copy->closed && strut_parameter_find(reader, key->text))
      fine = strut_report_error(
          reader, key->place,
          "the scene has a parameter '%s' already, which the part sees; give this "
          "one another name",
          key->text);
  }
  for (; given; given = given->next->next) {
    size_t i = strut_row_find(STRUT_NAMED(copy->parameters, copy->parameter_count), given->text);
    if (i < copy->parameter_count) {
      copy->parameters[i].of_part->given = given->next;
      copy->parameters[i].of_part->given_scope = place;
      continue;
    }
    fine = strut_report_error(
        reader, given->place, "part '%s' has no parameter '%s'%s", copy->placement->part->name,
        strut_sanitised_text(reader, given->text),
        strut_hint_of_rows(reader, given->text,
                           STRUT_NAMED(copy->parameters, copy->parameter_count)));
  }
  for (size_t i = 0; i < copy->parameter_count; i++) {
    strut_parameter_state *p = &copy->parameters[i];
    const strut_tree *value = p->of_part->given;
    if (value && (value->kind != STRUT_TREE_SCALAR || strut_is_null(value))) {
      strut_report_error(reader, value->place, "expected an expression for '%s' in 'set', found %s",
                         p->name, strut_found(reader, value));
      p->state = STRUT_FAILED;
    }
    strut_resolve_parameter(reader, p);
    fine = fine && p->state == STRUT_READ;
  }
  return fine;
}

/* ---- one placement ---- */

static bool mentions_number(const strut_tree *tree) {
  if (tree->kind != STRUT_TREE_SCALAR) {
    for (const strut_tree *k = tree->first; k; k = k->next)
      if (mentions_number(k)) return true;
    return false;
  }
  for (const char *c = tree->text; *c; c++) {
    size_t word = strspn(c, STRUT_LETTERS STRUT_DIGITS);
    if (word == 1 && (*c == 'i' || *c == 'j')) return true;
    if (word) c += word - 1;
  }
  return false;
}

static void expand_places(strut_expansion *expansion, const strut_slot *place, strut_copy *outer);

/* The scopes of one copy; *place_scope is that of the placement's keys. NULL: it could not be made. */
static strut_copy *make_copy(strut_expansion *expansion, strut_placing *placing,
                             const int64_t number[2], strut_copy **place_scope) {
  strut_reader *reader = expansion->reader;
  strut_part *part = placing->placement->part;
  strut_copy *place = new_scope(expansion, STRUT_SCOPE_PLACE, placing->placement, placing->outer);
  strut_copy *copy =
      place ? new_scope(expansion, STRUT_SCOPE_COPY, placing->placement, placing->outer) : NULL;
  if (!copy) return NULL;
  *place_scope = place;
  memcpy(place->number, number, sizeof place->number);
  memcpy(copy->number, number, sizeof copy->number);
  place->numbers = placing->placement->numbers;
  place->prefix = copy->prefix = make_prefix(expansion, placing->placement, number);
  place->prefix_length = copy->prefix_length = strlen(copy->prefix);
  copy->home = part->home;
  copy->closed = part->keys.isolated;
  read_part_list(reader, strut_slot_of(&part->fields, STRUT_KEY_PART_PARTS), copy, &copy->parts);
  bool first = number[0] == 0 && number[1] == 0;
  reader->scope = place;
  if (!first && placing->varies) {
    strut_owner owner = {"place", placing->placement->key->text};
    strut_read_fields(reader, STRUT_SECTION_PLACE, placing->placement->key->next, owner,
                      &placing->fields);
    strut_store(reader, &placing->fields, &placing->keys);
  }
  bool fine =
      read_copy_parameters(reader, copy, place, placing->keys.set) && !placing->fields.broken;
  reader->scope = NULL;
  return fine ? copy : NULL;
}

/* Sets the frames of a copy and of all scopes that were made for what it holds. */
static void set_frames(strut_copy *copy) {
  for (strut_copy *scope = copy; scope; scope = scope->made_next)
    scope->frame =
        scope->outer ? strut_frame_within(&scope->outer->frame, &scope->within) : scope->within;
}

/* Lays the copy where its keys and numbers say; *base is the frame of copy 0. False: that was reported. */
static bool lay_copy(strut_expansion *expansion, strut_placing *placing, strut_copy *copy,
                     strut_copy *place, strut_frame *base) {
  bool first = copy->number[0] == 0 && copy->number[1] == 0, fine = true;
  expansion->reader->scope = place;
  if (first || placing->varies) fine = strut_read_frame(expansion, placing, copy, base);
  expansion->reader->scope = NULL;
  strut_frame repeated = strut_repeated_frame(&placing->repeat, copy->number);
  copy->within = strut_frame_within(base, &repeated);
  if (fine) set_frames(copy);
  return fine;
}

/* Lets `onto` find the node of a port. */
static void enter_port(strut_expansion *expansion, const strut_port *port) {
  strut_reader *reader = expansion->reader;
  const strut_tree *inner = port->key->next;
  if (inner->kind != STRUT_TREE_SCALAR) return;
  const char *prefix = port->scope->prefix;
  int32_t node = strut_name_map_find(&expansion->copies->node_entries,
                                     strut_scratch_text(reader, "%s%s", prefix, inner->text));
  if (node >= 0)
    strut_add_name(reader, &expansion->copies->node_entries,
                   strut_scratch_text(reader, "%s%s", prefix, port->key->text), (size_t)node);
}

/* The names by which the copy is seen from outside. */
static void add_ports(strut_expansion *expansion, strut_copy *copy) {
  struct strut_copies *copies = expansion->copies;
  strut_reader *reader = expansion->reader;
  const strut_tree *ports = copy->placement->part->keys.ports;
  if (!ports) return;
  if (!strut_grow(&copies->ported_copies, &copies->ported_capacity, copies->ported_count,
                  sizeof *copies->ported_copies)) {
    reader->out_of_memory = expansion->stopped = true;
    return;
  }
  const char *name = strut_arena_text(&reader->scratch, copy->prefix, copy->prefix_length - 1);
  if (!name) return;
  copies->ported_copies[copies->ported_count] = copy;
  strut_add_name(reader, &copies->ported, name, copies->ported_count++);
  for (const strut_tree *key = ports->first; key; key = key->next->next) {
    strut_port *port = strut_scratch_array(reader, 1, sizeof *port);
    if (!port) return;
    *port = (strut_port){.scope = copy, .key = key, .node = -1};
    if (!copies->ports_end) copies->ports_end = &copies->ports;
    *copies->ports_end = port;
    copies->ports_end = &port->next;
    enter_port(expansion, port);
  }
}

static void fill_copy(strut_expansion *expansion, strut_copy *copy) {
  strut_part *part = copy->placement->part;
  expansion->reader->scope = NULL;
  expansion->copies->things++;
  copy->node_begin = expansion->copies->node_count;
  strut_copy_things(expansion, &part->fields, copy);
  strut_read_merge(expansion, part->keys.merge, copy, STRUT_KEY_PART_MERGE);
  expand_places(expansion, strut_slot_of(&part->fields, STRUT_KEY_PART_PLACE), copy);
  copy->node_end = expansion->copies->node_count;
  add_ports(expansion, copy);
}

/* A copy as it is seen from outside. */
static strut_copy *view_of(strut_expansion *expansion, const strut_copy *copy) {
  strut_copy *view = new_scope(expansion, STRUT_SCOPE_LINK, copy->placement, copy->outer);
  if (!view) return NULL;
  view->prefix = copy->prefix, view->prefix_length = copy->prefix_length;
  memcpy(view->number, copy->number, sizeof view->number);
  view->frame = copy->frame, view->within = copy->within;
  view->node_begin = copy->node_begin, view->node_end = copy->node_end;
  return view;
}

/* What ties a copy to the next one. */
static void link_copies(strut_expansion *expansion, strut_fields *next, strut_copy *place,
                        strut_copy *copy, const strut_copy *other, const strut_tree *twist) {
  strut_copy *link = view_of(expansion, copy), *next_view = view_of(expansion, other);
  if (!link || !next_view) return;
  link->home = place, link->next = next_view, link->twist = twist;
  strut_copy_things(expansion, next, link);
  strut_next_keys keys = {0};
  strut_store(expansion->reader, next, &keys);
  strut_read_merge(expansion, keys.merge, link, STRUT_KEY_NEXT_MERGE);
}

/* The keys of `next` in each direction, read once for all copies. False: one is broken. */
static bool read_links(strut_expansion *expansion, strut_placing *placing) {
  bool fine = true;
  expansion->reader->scope = placing->outer;
  for (int d = 0; d < 2; d++) {
    if (!placing->repeat.next[d]) continue;
    strut_read_fields(expansion->reader, STRUT_SECTION_NEXT, placing->repeat.next[d],
                      (strut_owner){"'next'", NULL}, &placing->next[d]);
    fine = fine && !placing->next[d].broken;
  }
  expansion->reader->scope = NULL;
  if (!fine) expansion->copies->incomplete = true;
  return fine;
}

/* The names of a twist must be those of nodes. */
static void check_twist(strut_expansion *expansion, const strut_tree *twist,
                        const strut_copy *copy) {
  strut_reader *reader = expansion->reader;
  const strut_placement *placement = copy->placement;
  for (const strut_tree *tree = twist ? twist->first : NULL; tree; tree = tree->next->next) {
    const strut_tree *const names[] = {tree, tree->next};
    for (int n = 0; n < 2; n++) {
      strut_full_name full;
      if (!strut_read_scalar(reader, names[n], "closed",
                             (strut_owner){"place", placement->key->text}, "the name of a node"))
        continue;
      int length = snprintf(full.text, sizeof full.text, "%s%s", copy->prefix, names[n]->text);
      if (length > 0 && (size_t)length < sizeof full.text &&
          strut_name_map_find(&expansion->copies->node_entries, full.text) >= 0)
        continue;
      strut_report_error(reader, names[n]->place, "unknown node '%s' of '%s' in 'closed'",
                         strut_sanitised_text(reader, names[n]->text), placement->key->text);
    }
  }
}

static void link_all(strut_expansion *expansion, strut_placing *placing, strut_copy **copies,
                     strut_copy **places) {
  const strut_repetition *repetition = &placing->repeat;
  int64_t all = repetition->count[0] * repetition->count[1];
  if (copies[0]) check_twist(expansion, repetition->twist, copies[0]);
  for (int64_t n = 0; n < all && !expansion->stopped; n++) {
    int64_t i = n / repetition->count[1], j = n % repetition->count[1];
    if (!copies[n]) continue;
    bool wraps = repetition->closed && i == repetition->count[0] - 1;
    if (repetition->next[0] && (i + 1 < repetition->count[0] || wraps)) {
      strut_copy *other = copies[wraps ? 0 : n + repetition->count[1]];
      if (other)
        link_copies(expansion, &placing->next[0], places[n], copies[n], other,
                    wraps ? repetition->twist : NULL);
    }
    if (repetition->next[1] && j + 1 < repetition->count[1] && copies[n + 1])
      link_copies(expansion, &placing->next[1], places[n], copies[n], copies[n + 1], NULL);
  }
}

/* Refuses what would become too large. */
static bool check_size(strut_expansion *expansion, const strut_placing *placing, double all) {
  double most = expansion->reader->limit_things;
  if (all <= most) return true;
  strut_report_error(
      expansion->reader,
      placing->keys.repeat ? placing->keys.repeat->place : placing->placement->key->place,
      "the copies would have %.3g nodes, members and other things, at most %.0f are "
      "possible%s",
      all, most, strut_limit_hint(expansion->reader));
  expansion->stopped = true;
  return false;
}

/* All copies; the first one tells how large they all will be. */
static void make_copies(strut_expansion *expansion, strut_placing *placing) {
  strut_reader *reader = expansion->reader;
  const strut_repetition *repetition = &placing->repeat;
  int64_t all = repetition->count[0] * repetition->count[1];
  size_t before = expansion->copies->things, links = 0;
  strut_frame base = strut_frame_of_scene;
  if (!read_links(expansion, placing)) return;
  for (int d = 0; d < repetition->numbers; d++)
    if (repetition->next[d]) links += strut_count_things(&placing->next[d]);
  double least = (double)strut_count_things(&placing->placement->part->fields) + 1.0;
  if (!check_size(expansion, placing, (double)before + (double)all * least)) return;
  strut_copy **copies = strut_scratch_array(reader, (size_t)all, sizeof *copies);
  strut_copy **places = strut_scratch_array(reader, (size_t)all, sizeof *places);
  if (!copies || !places) return;
  for (int64_t n = 0; n < all && !expansion->stopped; n++) {
    const int64_t number[2] = {n / repetition->count[1], n % repetition->count[1]};
    strut_copy *copy = make_copy(expansion, placing, number, &places[n]);
    bool onto = placing->keys.onto && (n == 0 || placing->varies); /* by the nodes that it has */
    if (copy && !onto && !lay_copy(expansion, placing, copy, places[n], &base)) copy = NULL;
    if (!copy || (n == 0 && reader->failed)) expansion->copies->incomplete = true;
    if (copy) fill_copy(expansion, copy);
    if (copy && onto && !lay_copy(expansion, placing, copy, places[n], &base)) {
      expansion->copies->incomplete = true;
      copy = NULL;
    }
    copies[n] = copy;
    double each = (double)(expansion->copies->things - before + links);
    if (expansion->stopped) return;
    if (n == 0 && !check_size(expansion, placing, (double)before + (double)all * each)) return;
    if (n == 0 && expansion->copies->incomplete) { /* the others would say the same */
      placing->placement->count[0] = placing->placement->count[1] = 1;
      return;
    }
    if (strut_diagnostics_full(reader->diagnostics)) expansion->stopped = true;
  }
  link_all(expansion, placing, copies, places);
  const strut_tree *tree = placing->keys.onto ? placing->keys.onto->first : NULL;
  strut_copy *first = tree && copies[0] ? view_of(expansion, copies[0]) : NULL;
  for (; tree && first; tree = tree->next->next)
    strut_add_merger(expansion, first, tree, placing->outer, tree->next,
                     strut_slot_of(&placing->fields, STRUT_KEY_PLACE_ONTO)->key);
}

static bool enter_part(strut_expansion *expansion, const strut_part *part, const strut_tree *name) {
  struct strut_copies *copies = expansion->copies;
  char chain[600] = "";
  size_t used = 0;
  if (!part->open && copies->depth < STRUT_DEEPEST_PARTS) {
    copies->chain[copies->depth++] = part->name;
    return true;
  }
  for (int i = 0; i < copies->depth && used < sizeof chain - 80; i++)
    used += (size_t)snprintf(chain + used, sizeof chain - used, "%.60s -> ", copies->chain[i]);
  strut_report_error(expansion->reader, name->place,
                     part->open ? "part '%s' contains itself: %s%s"
                                : "parts are placed within parts more than 16 deep: '%s' in %s%s",
                     part->name, chain, part->name);
  expansion->stopped = true;
  return false;
}

/* How many numbers a copy has, as far as the form of `repeat` says. */
static int count_numbers(const strut_tree *place) {
  const strut_tree *repeat = strut_tree_find(place, "repeat", NULL);
  const strut_tree *count = repeat ? strut_tree_find(repeat, "count", NULL) : NULL;
  if (!repeat) return 0;
  if (!count) count = repeat;
  return count->kind == STRUT_TREE_LIST ? 2 : 1;
}

static bool read_placement(strut_expansion *expansion, const strut_tree *key, strut_copy *outer,
                           strut_placing *placing) {
  strut_reader *reader = expansion->reader;
  strut_owner owner = {"place", key->text};
  strut_placement *placement = strut_scratch_array(reader, 1, sizeof *placement);
  strut_copy *scope = new_scope(expansion, STRUT_SCOPE_PLACE, placement, outer);
  *placing = (strut_placing){.placement = placement, .outer = outer};
  if (!placement || !scope) return false;
  *placement = (strut_placement){.key = key, .count = {1, 1}};
  placement->name = strut_scratch_text(reader, "%s%s", outer ? outer->prefix : "", key->text);
  scope->numbers = count_numbers(key->next); /* as in the first copy */
  reader->scope = scope;
  bool fine = strut_read_name(reader, key, "placement");
  strut_read_fields(reader, STRUT_SECTION_PLACE, key->next, owner, &placing->fields);
  strut_require(reader, &placing->fields, key->place);
  strut_store(reader, &placing->fields, &placing->keys);
  scope->numbers = 0;
  placement->part = read_part_name(reader, outer, placing->keys.part, owner);
  fine = strut_read_repeat(reader, strut_slot_of(&placing->fields, STRUT_KEY_PLACE_REPEAT),
                           key->text, &placing->repeat) &&
         fine;
  reader->scope = NULL;
  if (!placement->part || !fine || placing->fields.broken || placement->part->broken) {
    reader->failed = true;
    reader->copies->incomplete = true;
    return false;
  }
  memcpy(placement->count, placing->repeat.count, sizeof placement->count);
  placement->numbers = placing->repeat.numbers;
  placing->varies = placing->repeat.numbers && mentions_number(key->next);
  return true;
}

static void expand_place(strut_expansion *expansion, const strut_tree *key, strut_copy *outer) {
  strut_reader *reader = expansion->reader;
  struct strut_copies *copies = expansion->copies;
  strut_placing p;
  if (!read_placement(expansion, key, outer, &p)) return;
  strut_placement *placement = p.placement;
  strut_part *part = placement->part;
  if (!enter_part(expansion, part, p.keys.part)) return;
  if (!strut_grow(&copies->placements, &copies->placement_capacity, copies->placement_count,
                  sizeof *copies->placements)) {
    reader->out_of_memory = expansion->stopped = true;
    return;
  }
  copies->placements[copies->placement_count] = placement;
  strut_add_name(reader, &copies->placement_names, placement->name, copies->placement_count++);
  part->open = part->placed = true;
  make_copies(expansion, &p);
  part->open = false;
  copies->depth--;
}

static void expand_places(strut_expansion *expansion, const strut_slot *place, strut_copy *outer) {
  const strut_tree *map = place->state == STRUT_GIVEN ? place->value : NULL;
  for (const strut_tree *key = map ? map->first : NULL; key && !expansion->stopped;
       key = key->next->next)
    expand_place(expansion, key, outer);
}

/* ---- the scene ---- */

static void report_unplaced(strut_reader *reader) {
  const strut_part_list *parts = &reader->copies->parts;
  for (size_t i = 0; i < parts->count; i++)
    if (!parts->part[i].placed && !parts->part[i].broken)
      strut_note(reader->diagnostics, parts->part[i].key->place, "part '%s' is placed nowhere",
                 parts->part[i].name);
}

static void read_limit(strut_reader *reader) {
  const strut_key *key = strut_key_at(STRUT_KEY_SCENE_LIMIT_THINGS);
  const strut_slot *slot = strut_slot_of(&reader->top, STRUT_KEY_SCENE_LIMIT_THINGS);
  strut_owner owner = {"the scene", NULL};
  reader->limit_things = strtod(key->fallback, NULL);
  if (slot->state == STRUT_GIVEN)
    strut_read_number(reader, slot->value, key->name, owner, STRUT_DIM_NONE, key->limits,
                      &reader->limit_things);
}

const char *strut_limit_hint(strut_reader *reader) {
  return reader->limit_things >= STRUT_MOST_THINGS
             ? ""
             : strut_scratch_text(reader, "; 'limit_things' of the scene allows up to %d",
                                  STRUT_MOST_THINGS);
}

static void expand_scene(strut_expansion *expansion) {
  strut_reader *reader = expansion->reader;
  const strut_slot *nodes = strut_slot_of(&reader->top, STRUT_KEY_SCENE_NODES);
  const strut_tree *own = nodes->state == STRUT_GIVEN ? nodes->value->first : NULL;
  for (; own; own = own->next->next)
    if (own->next->kind == STRUT_TREE_LIST || strut_tree_find(own->next, "position", NULL))
      strut_remember_node(expansion, own); /* others are laid over copies */
  expand_places(expansion, strut_slot_of(&reader->top, STRUT_KEY_SCENE_PLACE), NULL);
  if (expansion->stopped) expansion->copies->incomplete = true;
}

void strut_read_parts(strut_reader *reader) {
  const strut_slot *parts = strut_slot_of(&reader->top, STRUT_KEY_SCENE_PARTS);
  const strut_slot *place = strut_slot_of(&reader->top, STRUT_KEY_SCENE_PLACE);
  const strut_slot *merge = strut_slot_of(&reader->top, STRUT_KEY_SCENE_MERGE);
  read_limit(reader);
  if (!parts->key && !place->key && !merge->key) {
    strut_require_nodes(reader);
    return;
  }
  strut_expansion e = {.reader = reader};
  reader->copies = strut_scratch_array(reader, 1, sizeof *reader->copies);
  e.copies = reader->copies;
  if (!e.copies) return;
  read_part_list(reader, parts, NULL, &e.copies->parts);
  expand_scene(&e);
  strut_read_merge(&e, merge->state == STRUT_GIVEN ? merge->value : NULL, NULL,
                   STRUT_KEY_SCENE_MERGE);
  int first = strut_section_first(STRUT_SECTION_SCENE);
  for (int k = 0; k < strut_section_size(STRUT_SECTION_SCENE); k++)
    strut_join_entries(&e, first + k);
  if (e.contacts.count) {
    strut_tree *map = strut_scratch_array(reader, 1, sizeof *map);
    if (map) *map = (strut_tree){.kind = STRUT_TREE_MAP, .first = e.contacts.first};
    e.copies->contacts = map;
  }
  if (e.copies->incomplete)
    strut_mark_incomplete(reader);
  else
    strut_require_nodes(reader);
  report_unplaced(reader);
}

void strut_copies_free(strut_reader *reader) {
  struct strut_copies *copies = reader->copies;
  if (!copies) return;
  strut_name_map_free(&copies->placement_names);
  strut_name_map_free(&copies->node_entries);
  strut_name_map_free(&copies->ported);
  strut_name_map_free(&copies->removed);
  strut_release(copies->ported_copies);
  strut_release(copies->placements);
  strut_release(copies->nodes);
}
