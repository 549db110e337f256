/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rigidity of a shape as a table that fits a screen. */
#include <math.h>

#include "engine/base/c_locale.h"
#include "engine/output/buffer.h"
#include "engine/output/quantity_text.h"
#include "engine/output/report/rigidity_report.h"
#include "engine/output/report/rigidity_words.h"

enum { MOST_ROWS = 30, MOST_STATES = 6, DIGITS = 6 };

static strut_quantity in(double value, const char *unit) {
  return strut_quantity_of(value, DIGITS, unit);
}

static void add_rank(strut_buffer *table, const strut_rigidity *r) {
  const strut_null_spaces *s = &r->spaces;
  strut_buffer_add(table, "  rank               %d of %d x %d; %s kept down to %.4g, ", s->rank,
                   r->matrix.rows, r->matrix.columns,
                   s->dense ? "singular values" : "diagonal of R", s->kept);
  if (s->dense && s->dropped > 0)
    strut_buffer_add(table, "dropped from %.1e\n", s->dropped);
  else
    strut_buffer_add(table, "%s\n", s->dense ? "the rest are zero" : "by sparse QR");
  if (s->weak > 0)
    strut_buffer_add(
        table,
        "                     %d of them below a millionth of the largest: as small a\n"
        "                     displacement of nodes may change s and f\n",
        s->weak);
}

static void add_counts(strut_buffer *table, const strut_rigidity *r) {
  const strut_mechanisms *m = &r->mechanisms;
  strut_buffer_add(table, "  self-stress        s = %d\n", r->states.count);
  strut_buffer_add(table, "  mechanisms         f = %d", m->count);
  const char *before = ": ";
  const int32_t count[] = {m->rigid_body, m->infinitesimal, m->finite, m->undecided};
  for (int i = 0; i < 4; i++) {
    if (count[i] == 0) continue;
    strut_buffer_add(table, "%s%d %s", before, count[i],
                     strut_motion_kind_name((strut_motion_kind)i));
    before = ", ";
  }
  strut_buffer_add(table, "\n  Maxwell-Calladine  %d members - %d free coordinates = %d = s - f\n",
                   r->matrix.columns, r->matrix.rows, r->matrix.columns - r->matrix.rows);
}

static void add_verdicts(strut_buffer *table, const strut_rigidity *r) {
  char words[STRUT_RIGIDITY_WORDS];
  const strut_tensegrity *t = &r->tensegrity;
  if (r->bars_at_node > 0)
    strut_buffer_add(
        table, "  class              %d: %s\n", r->bars_at_node,
        r->bars_at_node == 1 ? "no two bars meet" : "at most so many bars meet at a node");
  strut_buffer_add(table, "  super stable       %s\n", strut_super_stability_words(r, words));
  if (r->has_cables && r->states.force && r->states.count > 0)
    strut_buffer_add(table, "  cables             %s\n",
                     r->cables_can_pull
                         ? "one self-stress state tensions every cable that any state loads"
                         : "no self-stress state tensions every cable that some state loads");
  strut_buffer_add(table, "  kind               %s", t->label);
  if (t->judged)
    strut_buffer_add(table, " (%s%s%s%s%s)", t->self_stress ? "S" : "", t->cables ? "C" : "",
                     t->mechanism ? "M" : "", t->struts_apart ? "D" : "",
                     t->struts_inside ? "I" : "");
  strut_buffer_add(table, "\n  equilibrium        %s: net force on a free coordinate up to %s\n",
                   r->equilibrium ? "yes" : "no", in(r->residual, "N").text);
  if (r->without_length)
    strut_buffer_add(table, "  without length     %d members, which have no direction here\n",
                     r->without_length);
}

static void add_members(strut_buffer *table, const strut_rigidity *r, const strut_scene *scene) {
  size_t members = scene->member_count;
  int32_t states = r->states.force ? r->states.count : 0;
  if (states > MOST_STATES) states = MOST_STATES;
  strut_buffer_add(table, "\n  %-12s %-6s %12s %12s %13s", "member", "kind", "length", "force",
                   "force density");
  for (int32_t i = 0; i < states; i++) strut_buffer_add(table, "   state %-2d", i + 1);
  strut_buffer_add(table, "\n");
  for (size_t j = 0; j < members && j < MOST_ROWS; j++) {
    strut_buffer_add(table, "  %-12s %-6s %12s %12s %13s", scene->members[j].name,
                     strut_member_kind_words(scene->members[j].kind),
                     in(r->matrix.length[j], "m").text, in(r->force[j], "N").text,
                     in(r->density[j], "N/m").text);
    for (int32_t i = 0; i < states; i++)
      strut_buffer_add(table, " %10.6g", r->states.force[(size_t)i * members + j]);
    strut_buffer_add(table, "\n");
  }
  if (members > MOST_ROWS)
    strut_buffer_add(table, "  ... and %zu more; --json lists all\n", members - MOST_ROWS);
  if (r->states.count > states)
    strut_buffer_add(table, "  %d more self-stress states%s\n", r->states.count - states,
                     r->states.force ? "; --json lists all" : ": too many to list");
}

static void add_modes(strut_buffer *table, const strut_mechanisms *m) {
  char words[STRUT_RIGIDITY_WORDS];
  if (m->count == 0) return;
  if (!m->list) {
    strut_buffer_add(table, "\n  too many mechanisms to list\n");
    return;
  }
  strut_buffer_add(table, "\n  mechanism\n");
  for (int32_t i = 0; i < m->count && i < MOST_ROWS; i++)
    strut_buffer_add(table, "  %-3d %-14s %s\n", i + 1, strut_motion_kind_name(m->list[i].kind),
                     strut_mechanism_words(m, &m->list[i], words));
  if (m->count > MOST_ROWS)
    strut_buffer_add(table, "  ... and %d more; --json lists all\n", m->count - MOST_ROWS);
}

char *strut_rigidity_table(const strut_rigidity *r, const strut_model *model, const char *at) {
  strut_c_locale locale = strut_c_locale_enter();
  strut_buffer table = {0};
  const char *name = model->scene->name;
  strut_buffer_add(&table, "%s%srigidity at: %s\n", name, *name ? ": " : "", at);
  add_rank(&table, r);
  add_counts(&table, r);
  add_verdicts(&table, r);
  add_members(&table, r, model->scene);
  add_modes(&table, &r->mechanisms);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}
