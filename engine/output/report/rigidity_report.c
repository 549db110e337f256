/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rigidity of a shape as a table that fits a screen. */
#include "engine/output/report/reports.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/buffer.h"
#include "engine/output/result_values.h"
#include "engine/statics/rigidity/rigidity.h"

/* Elements beside members: columns of the equilibrium matrix behind those of members. */
static const struct {
  strut_channel_owner owner;
  const char *word;
} elements[] = {
    {STRUT_OWNER_HINGE, "hinge"}, {STRUT_OWNER_CELL, "cell"}, {STRUT_OWNER_DISTANCE, "distance"}};
enum { ELEMENTS = sizeof elements / sizeof *elements, MOST_ROWS = 30, MOST_STATES = 6, DIGITS = 6 };

static strut_rounded_quantity in(double value, const char *unit) {
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

static void add_counts(strut_buffer *table, const strut_rigidity *r, const strut_scene *scene) {
  char others[60] = "";
  int left = 0;
  for (int kind = 0; kind < ELEMENTS; kind++)
    left += strut_owner_count(elements[kind].owner, scene) > 0;
  for (int kind = 0; kind < ELEMENTS; kind++)
    if (strut_owner_count(elements[kind].owner, scene)) {
      size_t used = strlen(others);
      snprintf(others + used, sizeof others - used, "%s%ss", --left ? ", " : " and ",
               elements[kind].word);
    }
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
  strut_buffer_add(table,
                   "\n  Maxwell-Calladine  %d members%s - %d free coordinates = %d = s - f\n",
                   r->matrix.columns, others, r->matrix.rows, r->matrix.columns - r->matrix.rows);
}

/* Cables that do not pull here, which strut modes leaves out. */
static void add_idle(strut_buffer *table, const strut_rigidity *r, const strut_scene *scene) {
  size_t count = 0, first = 0;
  for (size_t j = scene->member_count; j-- > 0;)
    if (strut_member_is_idle(r, scene, j)) count++, first = j;
  if (!count) return;
  strut_buffer_add(table, "  without force      %s", scene->members[first].name);
  if (count > 1) strut_buffer_add(table, " and %zu more", count - 1);
  strut_buffer_add(table,
                   ": slack or just taut. They count as members here;\n%21sstrut modes leaves them "
                   "out, and so finds more motions without stiffness\n",
                   "");
}

/* ": self-stress, cables in tension": what the kind is judged by. */
static void add_features(strut_buffer *table, const strut_tensegrity *t) {
  const struct {
    bool has;
    const char *text;
  } features[] = {{t->self_stress, "self-stress"},
                  {t->cables, "cables in tension"},
                  {t->mechanism, "a stiffened mechanism"},
                  {t->struts_apart, "bars apart"},
                  {t->struts_inside, "bars inside the net"}};
  const char *between = ": ";
  for (size_t i = 0; t->judged && i < sizeof features / sizeof features[0]; i++) {
    if (!features[i].has) continue;
    strut_buffer_add(table, "%s%s", between, features[i].text);
    between = ", ";
  }
}

static void add_verdicts(strut_buffer *table, const strut_rigidity *r, const strut_scene *scene) {
  char words[STRUT_RIGIDITY_WORDS];
  const strut_tensegrity *t = &r->tensegrity;
  if (r->bars_at_node > 0)
    strut_buffer_add(
        table, "  class              %d: %s\n", r->bars_at_node,
        r->bars_at_node == 1 ? "no two bars meet" : "at most this many bars meet at a node");
  strut_buffer_add(table, "  super stable       %s\n", strut_super_stability_words(r, words));
  if (r->has_cables && r->states.force && r->states.count > 0)
    strut_buffer_add(table, "  cables             %s\n",
                     r->cables_can_pull
                         ? "one self-stress state tensions every cable that any state loads"
                         : "no self-stress state tensions every cable that some state loads");
  strut_buffer_add(table, "  kind               %s", t->label);
  add_features(table, t);
  strut_buffer_add(table, "\n  equilibrium        %s: net force on a free coordinate up to %s\n",
                   r->equilibrium ? "yes" : "no", in(r->residual, "N").text);
  add_idle(table, r, scene);
  if (r->without_length)
    strut_buffer_add(table, "  without length     %d members, which have no direction here\n",
                     r->without_length);
}

char *strut_rigidity_table(const strut_rigidity *r, const strut_model *model, const char *at) {
  strut_c_locale locale = strut_c_locale_enter();
  strut_buffer table = {0};
  const char *name = model->scene->name;
  strut_buffer_add(&table, "%s%srigidity at: %s\n", name, *name ? ": " : "", at);
  add_rank(&table, r);
  add_counts(&table, r, model->scene);
  add_verdicts(&table, r, model->scene);
  strut_values_add_tables(&table, &strut_rigidity_values,
                          &(strut_result_object){r, NULL, model->scene, 0},
                          &(strut_table_limits){MOST_ROWS, DIGITS});
  if (r->states.count > (r->states.force ? MOST_STATES : 0))
    strut_buffer_add(&table, "  %d self-stress states%s\n", r->states.count,
                     r->states.force ? "; --json lists all" : ": too many to list");
  if (r->mechanisms.count && !r->mechanisms.list)
    strut_buffer_add(&table, "\n  too many mechanisms to list\n");
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}
