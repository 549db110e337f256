/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reports of modes and of a form that was found. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/output/buffer.h"
#include "engine/output/json_value.h"
#include "engine/output/report/reports.h"
#include "engine/output/result_values.h"
#include "engine/output/run_report.h"
#include "engine/scene/signal_program.h"

enum { MOST_ROWS = 40, DIGITS = 6 };

static const char *name_of(const strut_model *model, int32_t node) {
  return model->scene->nodes[node].name;
}

/* Members that take no part here. */
static void add_idle_lines(strut_buffer *table, const strut_model *model,
                           const strut_modes *modes) {
  static const char *const words[][2] = {
      [STRUT_SLACK] = {"slack", "."},
      [STRUT_JUST_TAUT] = {"just taut, without prestress",
                           ". They act one way only, and count as slack here."}};
  const strut_member *member = model->scene->members;
  size_t count[STRUT_JUST_TAUT + 1] = {0}, first[STRUT_JUST_TAUT + 1];
  for (size_t j = model->scene->member_count; j-- > 0;)
    count[modes->idleness[j]]++, first[modes->idleness[j]] = j;
  for (int k = STRUT_SLACK; k <= STRUT_JUST_TAUT; k++) {
    if (!count[k]) continue;
    strut_buffer_add(table, "  %s: %s", words[k][0], member[first[k]].name);
    if (count[k] > 1) strut_buffer_add(table, " and %zu more", count[k] - 1);
    strut_buffer_add(table, "%s\n", words[k][1]);
  }
  if (count[STRUT_SLACK] + count[STRUT_JUST_TAUT])
    strut_buffer_add(table, "  strut rigidity counts these as members, and so fewer mechanisms\n");
}

static void add_head(strut_buffer *table, const strut_model *model, const strut_modes *modes) {
  const char *name = model->scene->name;
  strut_buffer_add(table, "%s%smodes at %s", name, *name ? ": " : "", modes->at);
  for (int32_t i = 0; i < modes->closed_count; i++)
    strut_buffer_add(table, "%s%s", i ? ", " : ", on ", name_of(model, modes->closed[i]));
  strut_buffer_add(
      table, "\n  %d coordinates, %s; condition number %.2g\n", (int)modes->coordinates,
      modes->dense ? "all modes computed" : "the lowest modes computed", modes->condition);
  if (!modes->at_rest)
    strut_buffer_add(table,
                     "  this shape is not an equilibrium: the structure moves away from it%s\n",
                     model->contacts.count ? " where friction does not hold it" : "");
  char warning[300];
  if (strut_settle_warning(&modes->settle, warning, sizeof warning))
    strut_buffer_add(table, "  %s\n", warning);
  if (modes->left_out) strut_buffer_add(table, "  without %s\n", modes->left_out);
  add_idle_lines(table, model, modes);
  if (!modes->damped_exactly)
    strut_buffer_add(table,
                     "  damping ratios by modal quotient, coupling between modes neglected\n");
}

char *strut_modes_table(const strut_model *model, const strut_modes *modes) {
  strut_c_locale locale = strut_c_locale_enter();
  strut_buffer table = {0};
  add_head(&table, model, modes);
  strut_values_add_tables(&table, &strut_modes_values,
                          &(strut_result_object){modes, NULL, model->scene, 0},
                          &(strut_table_limits){MOST_ROWS, DIGITS});
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}

enum { MOST_MEMBERS = 40, FORM_REPORT_DIGITS = 6 };

static strut_rounded_quantity in(double value, const char *unit) {
  return strut_quantity_of(value, FORM_REPORT_DIGITS, unit);
}

static void form_report_add_head(strut_buffer *table, const strut_form *form,
                                 const strut_setup *setup) {
  const strut_scene *scene = &setup->scene;
  strut_buffer_add(table, "%s%sform by %s\n", scene->name, *scene->name ? ": " : "",
                   strut_form_source_name(form->from));
  strut_buffer_add(table, "  displacement      at most %s from the drawn positions\n",
                   in(form->moved, "m").text);
  if (form->from == STRUT_FORM_DENSITIES)
    strut_buffer_add(table, "  force densities   changed by %.3g of the largest\n",
                     form->density_change);
  if (form->from == STRUT_FORM_PRESTRESS)
    strut_buffer_add(table, "  cable tension     at least %s\n", in(form->least_tension, "N").text);
  strut_buffer_add(table, "  residual force    %s at the start\n", in(form->residual, "N").text);
  if (form->run_added)
    strut_buffer_add(table, "  run added         %s with a step of %s\n",
                     in(setup->experiment.duration, "s").text,
                     in(setup->experiment.step, "s").text);
  if (form->massless) strut_buffer_add(table, "  no run            a free node has no mass\n");
  if (form->driven)
    strut_buffer_add(table, "  drives            at rest here; running the model moves them\n");
}

char *strut_form_table(const strut_form *form, const strut_setup *setup) {
  const strut_scene *scene = &setup->scene;
  strut_buffer table = {0};
  strut_c_locale locale = strut_c_locale_enter();
  form_report_add_head(&table, form, setup);
  strut_buffer_add(&table, "\n  %-12s %-6s %14s %14s %14s %14s\n", "member", "kind", "length",
                   "rest length", "force", "force density");
  for (size_t j = 0; j < scene->member_count && j < MOST_MEMBERS; j++) {
    const strut_member *m = &scene->members[j];
    strut_buffer_add(&table, "  %-12s %-6s %14s %14s %14s %14s\n", m->name,
                     strut_member_kind_name(m->kind), in(form->length[j], "m").text,
                     in(form->rest[j], "m").text, in(form->force[j], "N").text,
                     in(form->density[j], "N/m").text);
  }
  if (scene->member_count > MOST_MEMBERS)
    strut_buffer_add(&table, "  ... and %zu more\n", scene->member_count - MOST_MEMBERS);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}
