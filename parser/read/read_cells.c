/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cells: polygons under pressure. See reader.h. */
#include <stdio.h>

#include "parser/read/reader.h"

const char *strut_cell_name(const void *context, size_t i) {
  const strut_reader *reader = context;
  return i < reader->scene->cell_count ? reader->scene->cells[i].name : NULL;
}

static bool read_corners(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                         strut_cell *cell) {
  bool known = true;
  if (slot->state != STRUT_GIVEN) return false;
  size_t count = slot->value->count;
  if (count > STRUT_MOST_ELEMENT_NODES) {
    strut_report_error(reader, slot->value->place, "%s has %zu nodes, at most %d are possible",
                       strut_owner_text(reader, owner), count, STRUT_MOST_ELEMENT_NODES);
    return false;
  }
  cell->node = strut_reader_allocate(reader, &reader->scene->arena, count, sizeof *cell->node);
  if (!cell->node) return false;
  for (const strut_tree *item = slot->value->first; item; item = item->next) {
    int32_t node = strut_read_node(reader, item, owner);
    known = known && node >= 0;
    cell->node[cell->node_count++] = node;
  }
  return known;
}

static bool read_gas(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                     strut_cell *cell) {
  char text[200];
  strut_fields fields;
  snprintf(text, sizeof text, "the gas of %.150s", strut_owner_text(reader, owner));
  strut_owner within = {text, NULL};
  strut_read_fields(reader, STRUT_SECTION_GAS, slot->value, within, &fields);
  strut_require(reader, &fields, within, slot->key->place);
  strut_store_fields(reader, &fields, &reader->scene->arena, cell, sizeof *cell);
  const strut_slot *kind = strut_slot_of(&fields, STRUT_KEY_GAS_KIND);
  const strut_slot *exponent = strut_slot_of(&fields, STRUT_KEY_GAS_EXPONENT);
  if (kind->state == STRUT_GIVEN)
    cell->law = kind->word ? STRUT_LAW_ISENTROPIC : STRUT_LAW_ISOTHERMAL;
  if (cell->law == STRUT_LAW_ISOTHERMAL && exponent->state == STRUT_GIVEN) {
    strut_report_error(reader, exponent->key->place,
                       "%s gives 'exponent', which the kind isothermal does not have",
                       strut_owner_text(reader, within));
    return false;
  }
  return !fields.broken;
}

static bool read_cell(strut_reader *reader, const strut_tree *key, strut_cell *cell) {
  strut_owner owner = {"cell", cell->name};
  bool fine = strut_read_name(reader, key, "cell");
  strut_fields fields;
  strut_read_fields(reader, STRUT_SECTION_CELL, key->next, owner, &fields);
  strut_require(reader, &fields, owner, key->place);
  const strut_slot *gas = strut_slot_of(&fields, STRUT_KEY_CELL_GAS);
  const strut_slot *pressure = strut_slot_of(&fields, STRUT_KEY_CELL_PRESSURE);
  if (!read_corners(reader, strut_slot_of(&fields, STRUT_KEY_CELL_NODES), owner, cell)) {
    reader->ends_unknown = true;
    fine = false;
  }
  strut_store_fields(reader, &fields, &reader->scene->arena, cell, sizeof *cell);
  if (gas->state == STRUT_GIVEN) fine = read_gas(reader, gas, owner, cell) && fine;
  if (gas->state == STRUT_ABSENT && pressure->state == STRUT_ABSENT && !fields.broken) {
    strut_report_error(reader, key->place,
                       "%s lacks 'pressure', expected a pressure such as '500 N/m', or 'gas'",
                       strut_owner_text(reader, owner));
    fine = false;
  }
  return fine && !fields.broken;
}

void strut_read_cells(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_CELLS);
  if (!map) return;
  scene->cells = strut_reader_allocate(reader, &scene->arena, map->count, sizeof *scene->cells);
  reader->cell_source =
      strut_reader_allocate(reader, &reader->scratch, map->count, sizeof *reader->cell_source);
  if (!scene->cells || !reader->cell_source) return;
  for (const strut_tree *key = strut_first_entry(reader, map); key;
       key = strut_following_entry(reader, key)) {
    size_t i = strut_next_entry(reader, &scene->cell_count);
    scene->cells[i] = strut_cell_default();
    scene->cells[i].name = strut_keep_text(reader, key->text);
    strut_add_name(reader, &reader->cell_names, scene->cells[i].name, i);
    bool fine = read_cell(reader, key, &scene->cells[i]);
    reader->cell_source[i] = (strut_source){key, key->next, !fine};
  }
}
