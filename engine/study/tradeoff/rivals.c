/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What other libraries took on scenes of the same class: see docs/numerics.md, "Beside other
 * integrators".
 */
#include <math.h>
#include <stdio.h>

#include "engine/model/model.h"
#include "engine/study/tradeoff/rivals_table.h"
#include "engine/study/tradeoff/tradeoff_parts.h"

typedef enum scene_class { NO_CLASS, CONTACT, STIFF, SMOOTH } scene_class;

static const char *const names[] = {"", "with contact", "with stiff bars",
                                    "without contact or stiff bars"};

static const strut_tradeoff_rival rows[] = {
#define STRUT_RIVAL_ROW(of, error, least, most, scenes, none)                                      \
  {of, error, least, most, scenes, none},
    STRUT_RIVALS(STRUT_RIVAL_ROW)
#undef STRUT_RIVAL_ROW
};
enum { ROWS = sizeof rows / sizeof rows[0] };

/* Bars this much stiffer than springs or cables are stiff. */
static const double STIFF_RATIO = 1e4;

int strut_tradeoff_classify(const strut_model *model) {
  const strut_scene *scene = model->scene;
  double bar = 0, spring = HUGE_VAL;
  bool jumps = false;
  for (size_t i = 0; i < scene->contact_count; i++)
    jumps = jumps || scene->contacts[i].friction.law != STRUT_FRICTION_SMOOTH;
  for (size_t m = 0; m < scene->member_count; m++) {
    double stiffness = model->members.stiffness[m];
    if (scene->members[m].kind == STRUT_BAR)
      bar = fmax(bar, stiffness);
    else if (stiffness > 0)
      spring = fmin(spring, stiffness);
  }
  if (model->terms & STRUT_TERM_RIGID) return NO_CLASS;
  if (scene->contact_count > 0) return jumps ? CONTACT : NO_CLASS;
  if (bar > 0 && !isfinite(spring)) return NO_CLASS;
  return bar >= STIFF_RATIO * spring ? STIFF : SMOOTH;
}

const strut_tradeoff_rival *strut_tradeoff_next_rival(int scenes,
                                                      const strut_tradeoff_rival *last) {
  for (const strut_tradeoff_rival *row = last ? last + 1 : rows; row < rows + ROWS; row++)
    if (row->of == scenes) return row;
  return NULL;
}

const char *strut_tradeoff_scenes_text(const strut_tradeoff_rival *rival,
                                       char text[STRUT_TRADEOFF_TEXT]) {
  snprintf(text, STRUT_TRADEOFF_TEXT, "%d scenes %s", rival->scenes, names[rival->of]);
  return text;
}

void strut_tradeoff_add_rivals(strut_buffer *text, int scenes, double error) {
  const strut_tradeoff_rival *near = NULL, *row = NULL;
  char a[STRUT_TRADEOFF_TEXT], b[STRUT_TRADEOFF_TEXT];
  while ((row = strut_tradeoff_next_rival(scenes, row)))
    if (!near || fabs(log(row->error / error)) < fabs(log(near->error / error))) near = row;
  if (!near) return;
  strut_buffer_add(text,
                   "  other libraries: for %s on %s, the best took %.2g to %.2g times strut's CPU "
                   "time",
                   strut_tradeoff_percent_text(near->error, a), strut_tradeoff_scenes_text(near, b),
                   near->least, near->most);
  if (near->none > 0) strut_buffer_add(text, ", none kept it on %d", near->none);
  strut_buffer_add(text, "\n");
}
