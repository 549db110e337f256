/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/form_report.h"

#include <math.h>

#include "engine/base/c_locale.h"
#include "engine/output/buffer.h"
#include "engine/output/quantity_text.h"

enum { MOST_MEMBERS = 40, DIGITS = 7 };

typedef struct quantity {
  char text[STRUT_QUANTITY_TEXT];
} quantity;

static quantity in(double value, const char *unit) {
  quantity q;
  strut_quantity_text(value, DIGITS, unit, q.text);
  return q;
}

static void add_head(strut_buffer *table, const strut_form *form, const strut_scene *scene) {
  strut_buffer_add(table, "%s%sform by %s\n", scene->name, *scene->name ? ": " : "",
                   strut_form_source_name(form->from));
  strut_buffer_add(table, "  nodes moved       up to %s from where they were drawn\n",
                   in(form->moved, "m").text);
  if (form->from == STRUT_FORM_DENSITIES)
    strut_buffer_add(table, "  densities changed by %.3g of the largest one\n",
                     form->density_change);
  if (form->from == STRUT_FORM_PRESTRESS)
    strut_buffer_add(table, "  cables            pull with %s at least\n",
                     in(form->least_tension, "N").text);
  strut_buffer_add(table, "  forces left       %s at the start\n", in(form->residual, "N").text);
  if (form->run_added)
    strut_buffer_add(table, "  run added         %s in steps of %s\n",
                     in(scene->experiment.duration, "s").text,
                     in(scene->experiment.step, "s").text);
  if (form->massless)
    strut_buffer_add(table, "  no run            some node that can move has no mass\n");
  if (form->driven)
    strut_buffer_add(table, "  drives            are at rest here; running the model moves it\n");
}

char *strut_form_table(const strut_form *form, const strut_scene *scene) {
  static const char *const kinds[] = {"bar", "spring", "cable"};
  strut_buffer table = {0};
  strut_c_locale locale = strut_c_locale_enter();
  add_head(&table, form, scene);
  strut_buffer_add(&table, "\n  %-12s %-6s %14s %14s %14s %14s\n", "member", "kind", "length",
                   "rest length", "force", "force density");
  for (size_t j = 0; j < scene->member_count && j < MOST_MEMBERS; j++) {
    const strut_member *m = &scene->members[j];
    const double *a = scene->nodes[m->node[0]].start, *b = scene->nodes[m->node[1]].start;
    strut_rest rest;
    if (!strut_member_rest(scene, j, &rest)) continue;
    double length = hypot(b[0] - a[0], b[1] - a[1]);
    double force = rest.stiffness * (length - rest.length);
    if (m->kind == STRUT_CABLE && force < 0) force = 0;
    strut_buffer_add(&table, "  %-12s %-6s %14s %14s %14s %14s\n", m->name, kinds[m->kind],
                     in(length, "m").text, in(rest.length, "m").text, in(force, "N").text,
                     in(length > 0 ? force / length : 0, "N/m").text);
  }
  if (scene->member_count > MOST_MEMBERS)
    strut_buffer_add(&table, "  ... and %zu more\n", scene->member_count - MOST_MEMBERS);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}
