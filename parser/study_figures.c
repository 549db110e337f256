/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The figures of a study. See study_reader.h. */
#include <string.h>

#include "parser/study_reader.h"

const char *strut_study_text(strut_study_reader *r, strut_fields *fields, int key) {
  const strut_slot *slot = strut_slot_of(fields, key);
  if (slot->state != STRUT_GIVEN) return NULL;
  const char *copy =
      strut_arena_text(&r->file->arena, slot->value->text, strlen(slot->value->text));
  if (!copy) r->reader->out_of_memory = true;
  return copy;
}

void strut_study_read_figures(strut_study_reader *r, const strut_slot *slot) {
  strut_study *study = &r->file->study;
  if (slot->state != STRUT_GIVEN) return;
  study->figures =
      strut_take(r->reader, &r->file->arena, slot->value->count, sizeof *study->figures);
  for (const strut_tree *key = slot->value->first; key && study->figures; key = key->next->next) {
    strut_fields fields;
    strut_owner owner = {"figure", key->text};
    strut_read_name(r->reader, key, "figure");
    strut_read_fields(r->reader, STRUT_ROOM_FIGURE, key->next, owner, &fields);
    strut_require(r->reader, &fields, owner, key->place);
    strut_study_figure *figure = &study->figures[study->figure_count++];
    const strut_slot *kind = strut_slot_of(&fields, STRUT_KEY_FIGURE_KIND);
    figure->name = key->text;
    figure->map = kind->state == STRUT_GIVEN && kind->word == 1;
    figure->x = strut_study_text(r, &fields, STRUT_KEY_FIGURE_AT_X);
    figure->y = strut_study_text(r, &fields, STRUT_KEY_FIGURE_AT_Y);
    figure->series = strut_study_text(r, &fields, STRUT_KEY_FIGURE_SERIES);
    figure->color = strut_study_text(r, &fields, STRUT_KEY_FIGURE_COLOR);
    figure->panels = strut_study_text(r, &fields, STRUT_KEY_FIGURE_PANELS);
    figure->band = strut_study_text(r, &fields, STRUT_KEY_FIGURE_BAND);
    figure->only = strut_study_text(r, &fields, STRUT_KEY_FIGURE_ONLY);
    figure->difference = strut_study_text(r, &fields, STRUT_KEY_FIGURE_DIFFERENCE);
    figure->title = strut_study_text(r, &fields, STRUT_KEY_FIGURE_TITLE);
    if (figure->map && !figure->color && !fields.broken)
      strut_say(r->reader, key->place, "map '%s' lacks 'color', expected a column of the table",
                key->text);
  }
}
