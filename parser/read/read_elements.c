/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws of members and hinges, and hinges. See reader.h. */
#include <stdio.h>
#include <string.h>

#include "parser/read/reader.h"

const char *strut_hinge_name(const void *context, size_t i) {
  const strut_reader *reader = context;
  return i < reader->scene->hinge_count ? reader->scene->hinges[i].name : NULL;
}

/* force / strain^power */
static strut_dimension per_strain(strut_dimension force, strut_dimension strain, int power) {
  float n = (float)power;
  return (strut_dimension){force.kg - n * strain.kg, force.m - n * strain.m, force.s - n * strain.s,
                           force.angle - n * strain.angle};
}

static bool read_numbers(strut_reader *reader, const strut_fields *fields, strut_owner owner,
                         strut_dimension strain, strut_dimension force, strut_law *law) {
  bool fine = true;
  for (int p = 0; p < STRUT_LAW_NUMBER_COUNT; p++) {
    int key = strut_key_find(STRUT_SECTION_LAW, strut_law_key(p));
    const strut_slot *slot = strut_slot_of((strut_fields *)fields, key);
    int power = strut_law_power(p);
    strut_dimension dimension = power < 0 ? strain : per_strain(force, strain, power);
    if (slot->state != STRUT_GIVEN) continue;
    fine = strut_read_number(reader, slot->value, strut_law_key(p), owner, dimension,
                             strut_key_at(key)->limits.range, strut_law_number(law, p)) &&
           fine;
  }
  return fine;
}

static bool read_coefficients(strut_reader *reader, const strut_tree *list, strut_owner owner,
                              strut_dimension strain, strut_dimension force, strut_law *law) {
  double *c = strut_reader_allocate(reader, &reader->scene->arena, list->count, sizeof *c);
  bool fine = c != NULL;
  for (const strut_tree *item = c ? list->first : NULL; item; item = item->next) {
    strut_dimension dimension = per_strain(force, strain, (int)law->count + 1);
    fine = strut_read_number(reader, item, "coefficients", owner, dimension, STRUT_RANGE_ANY,
                             &c[law->count++]) &&
           fine;
  }
  law->force = c;
  return fine;
}

static bool read_points(strut_reader *reader, const strut_tree *list, strut_owner owner,
                        strut_dimension strain, strut_dimension force, strut_law *law) {
  double *x = strut_reader_allocate(reader, &reader->scene->arena, list->count, sizeof *x);
  double *y = strut_reader_allocate(reader, &reader->scene->arena, list->count, sizeof *y);
  bool fine = x && y;
  for (const strut_tree *point = fine ? list->first : NULL; point; point = point->next) {
    size_t i = law->count++;
    if (point->kind != STRUT_TREE_LIST || point->count != 2) {
      strut_report_error(reader, point->place,
                         "expected a point such as [2 mm, 3 N] for 'points' of %s, found %s",
                         strut_owner_text(reader, owner), strut_found(reader, point));
      fine = false;
      continue;
    }
    fine =
        strut_read_number(reader, point->first, "points", owner, strain, STRUT_RANGE_ANY, &x[i]) &&
        fine;
    fine = strut_read_number(reader, point->first->next, "points", owner, force, STRUT_RANGE_ANY,
                             &y[i]) &&
           fine;
    if (!fine || i == 0 || x[i] > x[i - 1]) continue;
    strut_report_error(reader, point->place,
                       "expected points with increasing x for 'points' of %s, found %g after %g",
                       strut_owner_text(reader, owner), x[i], x[i - 1]);
    fine = false;
  }
  law->x = x, law->force = y;
  return fine;
}

/* Reports a number that the law needs and does not have, or has and does not need. */
static bool check_needs(strut_reader *reader, strut_fields *fields, strut_owner owner,
                        const strut_law *law) {
  bool fine = true;
  for (int p = 0; p < STRUT_LAW_PARAMETER_COUNT; p++) {
    int key = strut_key_find(STRUT_SECTION_LAW, strut_law_key(p));
    const strut_slot *slot = strut_slot_of(fields, key);
    bool needed = strut_law_needs(law->kind, p);
    if (slot->state == STRUT_ABSENT ? !needed : strut_law_allows(law->kind, p)) continue;
    fine = false;
    if (needed)
      strut_report_error(reader, fields->map->place, "%s lacks '%s', which the kind %s needs",
                         strut_owner_text(reader, owner), strut_law_key(p),
                         strut_law_at(law->kind)->word);
    else
      strut_report_error(reader, slot->key->place, "%s gives '%s', which the kind %s does not have",
                         strut_owner_text(reader, owner), strut_law_key(p),
                         strut_law_at(law->kind)->word);
  }
  const strut_slot *smooth = strut_slot_of(fields, STRUT_KEY_LAW_SMOOTH);
  if (smooth->state == STRUT_ABSENT || law->kind == STRUT_LAW_TABLE) return fine;
  strut_report_error(reader, smooth->key->place, "%s gives 'smooth', which only a table has",
                     strut_owner_text(reader, owner));
  return false;
}

/* `law: bilinear` lacks its numbers and is refused; the others are complete. */
static bool read_word(strut_reader *reader, const strut_tree *value, strut_owner owner,
                      strut_law *law) {
  static const char words[] = "tension_only|compression_only" STRUT_LAWS(STRUT_LAW_WORD, );
  strut_key key = *strut_key_at(STRUT_KEY_MEMBER_LAW);
  int word;
  key.words = words;
  if (!strut_read_word(reader, &key, value, owner, &word)) return false;
  if (word < 2) {
    law->carries = word ? STRUT_CARRIES_COMPRESSION : STRUT_CARRIES_TENSION;
    return true;
  }
  law->kind = (strut_law_kind)(word - 2);
  if (!strut_law_at(law->kind)->needs) return true;
  strut_report_error(reader, value->place,
                     "the law %s of %s needs numbers: write a mapping {kind: %s, ...}", value->text,
                     strut_owner_text(reader, owner), value->text);
  return false;
}

bool strut_read_law(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                    strut_dimension strain, strut_dimension force, strut_law *law) {
  strut_fields fields;
  if (slot->state == STRUT_ABSENT) return true;
  if (slot->state != STRUT_GIVEN) return false;
  if (slot->value->kind == STRUT_TREE_SCALAR) return read_word(reader, slot->value, owner, law);
  char text[200];
  snprintf(text, sizeof text, "the law of %.150s", strut_owner_text(reader, owner));
  strut_owner within = {text, NULL};
  strut_read_fields(reader, STRUT_SECTION_LAW, slot->value, within, &fields);
  const strut_slot *coefficients = strut_slot_of(&fields, STRUT_KEY_LAW_COEFFICIENTS);
  const strut_slot *points = strut_slot_of(&fields, STRUT_KEY_LAW_POINTS);
  strut_store_fields(reader, &fields, &reader->scene->arena, law, sizeof *law);
  bool fine = !fields.broken && check_needs(reader, &fields, within, law);
  fine = read_numbers(reader, &fields, within, strain, force, law) && fine;
  if (!fine) return false;
  if (coefficients->state == STRUT_GIVEN)
    return read_coefficients(reader, coefficients->value, within, strain, force, law);
  if (points->state == STRUT_GIVEN)
    return read_points(reader, points->value, within, strain, force, law);
  return true;
}

static bool read_hinge(strut_reader *reader, const strut_tree *key, strut_hinge *hinge) {
  strut_owner owner = {"hinge", hinge->name};
  bool fine = strut_read_name(reader, key, "hinge");
  strut_fields fields;
  strut_read_fields(reader, STRUT_SECTION_HINGE, key->next, owner, &fields);
  strut_apply_groups(reader, &fields, STRUT_KEY_HINGE_GROUP, owner);
  strut_require(reader, &fields, owner, key->place);
  const strut_slot *nodes = strut_slot_of(&fields, STRUT_KEY_HINGE_NODES);
  const strut_tree *item = nodes->state == STRUT_GIVEN ? nodes->value->first : NULL;
  for (int k = 0; k < 3 && item; k++, item = item->next) {
    hinge->node[k] = strut_read_node(reader, item, owner);
    if (hinge->node[k] < 0) fine = false;
  }
  if (strut_scope_flips(reader)) { /* counter-clockwise is the other way round */
    int32_t first = hinge->node[0];
    hinge->node[0] = hinge->node[2], hinge->node[2] = first;
  }
  strut_store_fields(reader, &fields, &reader->scene->arena, hinge, sizeof *hinge);
  if (!strut_read_law(reader, strut_slot_of(&fields, STRUT_KEY_HINGE_LAW), owner, STRUT_DIM_ANGLE,
                      STRUT_DIM_MOMENT, &hinge->law))
    fine = false;
  if (!fine || fields.broken) reader->ends_unknown = true;
  return fine && !fields.broken;
}

void strut_read_rayleigh(strut_reader *reader) {
  strut_fields fields;
  if (strut_read_section(reader, STRUT_KEY_SCENE_RAYLEIGH, STRUT_SECTION_RAYLEIGH, "rayleigh",
                         &fields))
    strut_store_fields(reader, &fields, &reader->scene->arena, reader->scene,
                       sizeof *reader->scene);
}

void strut_read_hinges(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_HINGES);
  if (!map) return;
  scene->hinges = strut_reader_allocate(reader, &scene->arena, map->count, sizeof *scene->hinges);
  reader->hinge_source =
      strut_reader_allocate(reader, &reader->scratch, map->count, sizeof *reader->hinge_source);
  if (!scene->hinges || !reader->hinge_source) return;
  for (const strut_tree *key = strut_first_entry(reader, map); key;
       key = strut_following_entry(reader, key)) {
    size_t i = strut_next_entry(reader, &scene->hinge_count);
    scene->hinges[i] = strut_hinge_default();
    scene->hinges[i].name = strut_keep_text(reader, key->text);
    strut_add_name(reader, &reader->hinge_names, scene->hinges[i].name, i);
    bool fine = read_hinge(reader, key, &scene->hinges[i]);
    reader->hinge_source[i] = (strut_source){key, key->next, !fine};
  }
}
