/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The one place where texts are put beside what they name. The canvas gathers labels and places them
 * when all else is drawn: the most important first, each where it covers the least ink, never over
 * another text, with a thin line to what it names where that is far. See strut_draw_label in canvas.h.
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_LABELS_H
#define STRUT_ENGINE_OUTPUT_DRAW_LABELS_H

#include "engine/base/memory.h"
#include "engine/output/draw/canvas.h"

/** Labels that wait, and the boxes of all texts that are drawn. Zero-initialise. */
typedef struct strut_labels {
  strut_label *list;
  size_t count, room;
  strut_box *texts; /* (text_count) [pt] */
  size_t text_count, text_room;
  strut_arena arena; /* of their texts */
  bool failed;       /* memory was out */
} strut_labels;

/** Keeps a label until strut_labels_place. */
void strut_labels_add(strut_labels *labels, const strut_label *label);
/** Notes the ink of a text that was drawn, which labels keep off. */
void strut_labels_avoid(strut_labels *labels, strut_box ink);
/** Draws all that wait. Where some find no place, a note on the page says how many. */
void strut_labels_place(strut_labels *labels, strut_canvas *canvas);
void strut_labels_free(strut_labels *labels);

#endif
