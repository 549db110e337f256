/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rigidity of a shape as a table that fits a screen. */
#include "engine/output/report/reports.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/buffer.h"
#include "engine/statics/rigidity/rigidity.h"

/* ---- elements beside members: columns of the equilibrium matrix behind those of members ---- */

/* Words and units of a table. */
static const struct {
  strut_channel_owner owner;
  const char *word, *extent, *force, *extent_unit, *force_unit;
} elements[] = {{STRUT_OWNER_HINGE, "hinge", "angle", "moment", "rad", "N m"},
                {STRUT_OWNER_CELL, "cell", "area", "pressure", "m^2", "N/m"},
                {STRUT_OWNER_DISTANCE, "distance", "distance", "force", "m", "N"}};
enum { ELEMENTS = sizeof elements / sizeof *elements };

/* ---- the table ---- */

enum { MOST_ROWS = 30, MOST_STATES = 6, DIGITS = 6 };

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

/* Forces of the states are those of elements where members have forces [N]. */
static void add_elements(strut_buffer *table, const strut_rigidity *r, const strut_scene *scene,
                         int kind, int32_t states) {
  strut_channel_owner owner = elements[kind].owner;
  size_t columns = (size_t)r->matrix.columns,
         count = strut_owner_count(elements[kind].owner, scene);
  if (count)
    strut_buffer_add(table, "  %-12s %-6s %12s %12s\n", elements[kind].word, "",
                     elements[kind].extent, elements[kind].force);
  for (size_t i = 0; i < count && i < MOST_ROWS; i++) {
    size_t j = strut_column_of(scene, elements[kind].owner, i);
    double extent = strut_column_extent(r, owner, j),
           force = strut_column_force(r, owner, r->force[j]);
    strut_buffer_add(table, "  %-12s %-6s %12s %12s %13s", strut_owner_name(owner, scene, i), "",
                     strut_quantity_of_any(extent, DIGITS, elements[kind].extent_unit).text,
                     in(force, elements[kind].force_unit).text, "");
    for (int32_t k = 0; k < states; k++)
      strut_buffer_add(table, " %10.6g",
                       strut_column_force(r, owner, r->states.force[(size_t)k * columns + j]));
    strut_buffer_add(table, "\n");
  }
  if (count > MOST_ROWS)
    strut_buffer_add(table, "  ... and %zu more; --json lists all\n", count - MOST_ROWS);
}

static void add_members(strut_buffer *table, const strut_rigidity *r, const strut_scene *scene) {
  size_t members = scene->member_count, columns = (size_t)r->matrix.columns;
  int32_t states = r->states.force ? r->states.count : 0;
  if (states > MOST_STATES) states = MOST_STATES;
  strut_buffer_add(table, "\n  %-12s %-6s %12s %12s %13s", "member", "kind", "length", "force",
                   "force density");
  for (int32_t i = 0; i < states; i++) strut_buffer_add(table, "   state %-2d", i + 1);
  strut_buffer_add(table, "\n");
  for (size_t j = 0; j < members && j < MOST_ROWS; j++) {
    strut_buffer_add(table, "  %-12s %-6s %12s %12s %13s", scene->members[j].name,
                     strut_member_kind_name(scene->members[j].kind),
                     in(r->matrix.length[j], "m").text, in(r->force[j], "N").text,
                     in(r->density[j], "N/m").text);
    for (int32_t i = 0; i < states; i++)
      strut_buffer_add(table, " %10.6g", r->states.force[(size_t)i * columns + j]);
    strut_buffer_add(table, "\n");
  }
  if (members > MOST_ROWS)
    strut_buffer_add(table, "  ... and %zu more; --json lists all\n", members - MOST_ROWS);
  for (int kind = 0; kind < ELEMENTS; kind++) add_elements(table, r, scene, kind, states);
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
  add_counts(&table, r, model->scene);
  add_verdicts(&table, r, model->scene);
  add_members(&table, r, model->scene);
  add_modes(&table, &r->mechanisms);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}
