/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cells as YAML. See writer.h. */
#include <math.h>

#include "parser/write/writer.h"

static void put_gas_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                            const void *object) {
  const strut_cell *cell = object;
  strut_put_key_name(writer, mapping, key);
  strut_put(writer, cell->law == STRUT_LAW_ISENTROPIC ? "isentropic" : "isothermal");
}

static void put_gas(strut_writer *writer, strut_mapping *mapping, int key, const strut_cell *cell) {
  const strut_cell usual = strut_cell_default();
  strut_mapping inner = STRUT_MAPPING_INLINE;
  strut_put_key_name(writer, mapping, key);
  strut_put(writer, "{");
  strut_put_fields(writer, &inner, STRUT_SECTION_GAS, cell, &usual, put_gas_by_hand);
  strut_put(writer, "}");
}

static void put_cell_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                             const void *object) {
  const strut_cell *cell = object;
  if (key == STRUT_KEY_CELL_GAS) {
    if (cell->law != STRUT_LAW_PRESSURE) put_gas(writer, mapping, key, cell);
    return;
  }
  strut_put_key_name(writer, mapping, key);
  for (size_t k = 0; k < cell->node_count; k++) {
    strut_put(writer, k ? ", " : "[");
    strut_put_name(writer, writer->scene->nodes[cell->node[k]].name);
  }
  strut_put(writer, "]");
}

void strut_put_cells(strut_writer *writer) {
  const strut_scene *scene = writer->scene;
  if (scene->cell_count) strut_put(writer, "cells:\n");
  for (size_t i = 0; i < scene->cell_count; i++) {
    const strut_cell *cell = &scene->cells[i];
    strut_mapping mapping = STRUT_MAPPING_INLINE;
    strut_cell usual = strut_cell_default();
    if (cell->law == STRUT_LAW_PRESSURE)
      usual.pressure = (double)NAN; /* it is always written */
    else
      usual.pressure = cell->pressure; /* it stands in the gas */
    strut_put(writer, "  ");
    strut_put_name(writer, cell->name);
    strut_put(writer, ": {");
    strut_put_fields(writer, &mapping, STRUT_SECTION_CELL, cell, &usual, put_cell_by_hand);
    strut_put(writer, "}\n");
  }
}
