/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The figures of a study. See study_reader.h. */
#include <math.h>
#include <string.h>

#include "parser/study/study_reader.h"

static bool wanted(strut_study_reader *r, const strut_fields *fields, const strut_tree *key,
                   const char *kind, const char *name, const char *text) {
  if (text || fields->broken) return true;
  strut_report_error(r->reader, key->place, "%s '%s' lacks '%s', expected a column of the table",
                     kind, key->text, name);
  return false;
}

/* What a kind cannot do without. */
static void require(strut_study_reader *r, const strut_fields *fields, const strut_tree *key,
                    const strut_study_figure *f) {
  static const char *const kinds[] = {"figure", "map", "figure", "", ""};
  const char *kind = kinds[f->kind];
  if (f->kind == STRUT_FIGURE_PERIOD || f->kind == STRUT_FIGURE_SNAPSHOTS) return;
  wanted(r, fields, key, kind, "x", f->x);
  wanted(r, fields, key, kind, "y", f->y);
  if (f->kind == STRUT_FIGURE_MAP) wanted(r, fields, key, kind, "color", f->color);
}

static void read_times(strut_study_reader *r, const strut_slot *slot, strut_owner owner,
                       strut_study_figure *figure) {
  if (slot->state != STRUT_GIVEN) return;
  double *times =
      strut_reader_allocate(r->reader, &r->file->arena, slot->value->count, sizeof *times);
  for (const strut_tree *item = slot->value->first; item && times; item = item->next)
    if (strut_read_number(r->reader, item, "times", owner, STRUT_DIM_TIME, STRUT_RANGE_ANY,
                          &times[figure->time_count]))
      figure->time_count++;
  figure->times = times;
}

static void read_figure(strut_study_reader *r, const strut_tree *key, strut_study_figure *figure) {
  strut_fields fields;
  strut_owner owner = {"figure", key->text};
  strut_read_name(r->reader, key, "figure");
  strut_read_fields(r->reader, STRUT_SECTION_FIGURE, key->next, owner, &fields);
  *figure = (strut_study_figure){.name = key->text, .from = -HUGE_VAL, .to = HUGE_VAL};
  strut_store_fields(r->reader, &fields, &r->file->arena, figure, sizeof *figure);
  read_times(r, strut_slot_of(&fields, STRUT_KEY_FIGURE_TIMES), owner, figure);
  require(r, &fields, key, figure);
}

void strut_study_read_figures(strut_study_reader *r, const strut_slot *slot) {
  strut_study *study = &r->file->study;
  if (slot->state != STRUT_GIVEN) return;
  study->figures =
      strut_reader_allocate(r->reader, &r->file->arena, slot->value->count, sizeof *study->figures);
  for (const strut_tree *key = slot->value->first; key && study->figures; key = key->next->next)
    read_figure(r, key, &study->figures[study->figure_count++]);
}
