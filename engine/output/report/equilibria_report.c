/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reports the results of a search for equilibria in tables that fit a screen. */
#include <assert.h>
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/memory.h"
#include "engine/output/buffer.h"
#include "engine/output/json_value.h"
#include "engine/output/report/reports.h"
#include "engine/output/run_report.h"

/* ---- the table ---- */

enum { MOST_ROWS = 80, MOST_BARRIERS = 24, MOST_NODES = 12, NAMES = 64, FLAWS = 11 };

/* Rows of one table: those of one kind. */
typedef enum section { STANDING, HELD, UNSTABLE } section;

static section section_of(const strut_equilibrium *e) {
  if (e->outcome == STRUT_OUTCOME_STANDS) return STANDING;
  return e->outcome == STRUT_OUTCOME_UNSTABLE ? UNSTABLE : HELD;
}

static void list_names(const strut_scene *scene, const strut_equilibrium *e, char text[NAMES]) {
  const int32_t *node = e->contacts;
  size_t count = (size_t)e->contact_count, used = 0;
  if (e->supports && e->outcome != STRUT_OUTCOME_STANDS)
    node = e->supports->node, count = e->supports->count;
  snprintf(text, NAMES, "-");
  for (size_t i = 0; i < count && used < NAMES; i++) {
    int n = snprintf(text + used, NAMES - used, "%s%s", i ? "," : "", scene->nodes[node[i]].name);
    if (n < 0) return;
    used += (size_t)n;
  }
}

/* "collapsed", "2 crossings" or "-". */
static void describe_flaws(const strut_equilibrium *e, char text[NAMES]) {
  if (e->collapsed)
    snprintf(text, NAMES, "collapsed");
  else if (e->crossings)
    snprintf(text, NAMES, "%" PRId32 " crossing%s", e->crossings, e->crossings == 1 ? "" : "s");
  else
    snprintf(text, NAMES, "-");
}

/* The last part of the verdict, which is about collisions. */
static const char *collision_words(const strut_equilibrium *e) {
  const char *words = strrchr(e->verdict, ';');
  return words && (e->overlap >= 0 || e->through >= 0) ? words : "";
}

/* The minima on both sides of a saddle, else the outcome of the equilibrium; empty if it stands. */
static void add_end(strut_buffer *table, const strut_equilibria *all, const strut_equilibrium *e) {
  const int32_t *down = e->point.down;
  if (e->outcome == STRUT_OUTCOME_STANDS) {
    if (e->friction > 0.0) strut_buffer_add(table, "  needs friction %.4g", e->friction);
    strut_buffer_add(table, "%s", collision_words(e));
    return;
  }
  if (e->point.negative == 1 && down[0] >= 0 && down[1] >= 0)
    strut_buffer_add(table, "  between %s and %s%s", all->list[down[0]].name,
                     all->list[down[1]].name, collision_words(e));
  else
    strut_buffer_add(table, "  %s", e->verdict);
}

/* The largest energy of all equilibria [J]. */
static double largest_energy(const strut_equilibria *all) {
  double most = 0.0;
  for (size_t i = 0; i < all->count; i++) most = fmax(most, fabs(all->list[i].energy));
  return most;
}

/* An energy; 0 where it is rounding beside those of the others. */
static double shown_energy(double energy, double largest) {
  return fabs(energy) > 4.0 * DBL_EPSILON * largest ? energy : 0.0;
}

static void add_row(strut_buffer *table, const strut_equilibria *all, const strut_model *model,
                    const strut_equilibrium *e, double largest) {
  char names[NAMES], flaws[NAMES];
  list_names(model->scene, e, names);
  describe_flaws(e, flaws);
  int32_t first = e->point.label == STRUT_STABLE ? e->point.zero : 0; /* free motions apart */
  double lowest = first < e->point.eigenvalue_count ? e->point.eigenvalues[first] : (double)NAN;
  strut_buffer_add(table, "  %-18s %-12s %-8s %14s %13s %7" PRId64 "  %-*s", e->name, names,
                   strut_stability_name(e->point.label),
                   strut_quantity_of(shown_energy(e->energy, largest), 6, "J").text,
                   strut_quantity_of(lowest, 5, "N/m").text, e->point.found,
                   e->outcome == STRUT_OUTCOME_STANDS ? 0 : FLAWS, flaws);
  add_end(table, all, e);
  strut_buffer_add(table, "\n");
}

static void add_section(strut_buffer *table, const strut_equilibria *all, const strut_model *model,
                        section wanted, const char *title, size_t most) {
  size_t count = 0;
  double largest = largest_energy(all);
  for (size_t i = 0; i < all->count; i++) {
    const strut_equilibrium *e = &all->list[i];
    if (section_of(e) != wanted || count++ >= most) continue;
    if (count == 1)
      strut_buffer_add(table, "\n  %-18s %-12s %-8s %14s %13s %7s  %-*s%s\n", title,
                       wanted == HELD ? "held" : "touching", "label", "energy", "stiffness",
                       "found", wanted == STANDING ? 0 : FLAWS, "shape",
                       wanted == STANDING ? "" : "  outcome");
    add_row(table, all, model, e, largest);
  }
  if (count > most)
    strut_buffer_add(table, "  ... and %zu more; --all lists every row\n", count - most);
}

/* Counts the equilibria that the short table leaves out. */
static void add_counts(strut_buffer *table, const strut_equilibria *all) {
  size_t fates[STRUT_OUTCOME_NO_REST + 1] = {0}, any = 0;
  static const char *const words[] = {
      [STRUT_OUTCOME_TIPS] = "that tip over or move elsewhere once the contacts are released",
      [STRUT_OUTCOME_BELOW_GROUND] = "with nodes below the ground",
      [STRUT_OUTCOME_UNSTABLE] = "unstable (saddles and maxima)",
      [STRUT_OUTCOME_FLOPPY] = "floppy",
      [STRUT_OUTCOME_NO_REST] = "that come to no rest once released"};
  for (size_t i = 0; i < all->count; i++) fates[all->list[i].outcome]++;
  for (int f = STRUT_OUTCOME_TIPS; f <= STRUT_OUTCOME_NO_REST; f++) {
    if (!fates[f]) continue;
    strut_buffer_add(table, any++ ? ",\n  " : "\n  not shown: ");
    strut_buffer_add(table, "%zu %s", fates[f], words[f]);
  }
  if (any) strut_buffer_add(table, "; --all lists them\n");
}

/* The nodes on which it rests, with their contact forces. */
static void add_shape(strut_buffer *table, const strut_scene *scene, const strut_equilibrium *e) {
  strut_buffer_add(table, "\n  %-12s %14s %14s", e->name, "x", "y");
  strut_buffer_add(table, e->contact_count ? " %14s\n" : "\n", "presses with");
  for (size_t i = 0; i < scene->node_count && i < MOST_NODES; i++) {
    strut_buffer_add(table, "  %-12s %14s %14s", scene->nodes[i].name,
                     strut_quantity_of(e->rest[2 * i], 6, "m").text,
                     strut_quantity_of(e->rest[2 * i + 1], 6, "m").text);
    for (int32_t k = 0; k < e->contact_count; k++)
      if (e->contacts[k] == (int32_t)i)
        strut_buffer_add(table, " %14s", strut_quantity_of(e->normal[k], 6, "N").text);
    strut_buffer_add(table, "\n");
  }
  if (scene->node_count > MOST_NODES)
    strut_buffer_add(table, "  ... and %zu more\n", scene->node_count - MOST_NODES);
}

static void add_shapes(strut_buffer *table, const strut_equilibria *all, const strut_scene *scene) {
  for (size_t i = 0; i < all->count; i++)
    if (all->list[i].outcome == STRUT_OUTCOME_STANDS) add_shape(table, scene, &all->list[i]);
}

static void add_barriers(strut_buffer *table, const strut_equilibria *all, bool everything) {
  bool names = false;
  size_t shown = 0, left = 0, most = everything ? SIZE_MAX : MOST_BARRIERS;
  if (all->barrier_count == 0) return;
  for (size_t i = 0; i < all->count; i++) names = names || all->list[i].configured;
  strut_buffer_add(table, "\n  %-18s %-18s %14s %14s  %s\n", "from", "to", "barrier", "direct",
                   "over");
  for (size_t i = 0; i < all->barrier_count; i++) {
    const strut_barrier *b = &all->barriers[i];
    bool both = all->list[b->from].configured && all->list[b->to].configured;
    if ((names && !both && !everything) || shown == most) {
      left++;
      continue;
    }
    shown++;
    strut_buffer_add(table, "  %-18s %-18s %14s %14s  %s", all->list[b->from].name,
                     all->list[b->to].name, strut_quantity_of(b->height, 6, "J").text,
                     isnan(b->direct) ? "-" : strut_quantity_of(b->direct, 6, "J").text,
                     b->saddle >= 0 ? all->list[b->saddle].name : "-");
    for (int32_t k = 0; k < b->via_count; k++)
      strut_buffer_add(table, "%s%s", k ? ", " : ", via ",
                       b->via[k] >= 0 ? all->list[b->via[k]].name : "-");
    strut_buffer_add(table, "\n");
  }
  if (left) strut_buffer_add(table, "  ... and %zu more; --all lists them\n", left);
}

char *strut_equilibria_table(const strut_equilibria *all, const strut_model *model,
                             bool everything) {
  const strut_scene *scene = model->scene;
  strut_buffer table = {0};
  strut_c_locale locale = strut_c_locale_enter();
  strut_buffer_add(&table, "%s%s%zu equilibria from %" PRId64 " starts, seed %" PRIu64 "\n",
                   scene->name, *scene->name ? ": " : "", all->count, all->starts, all->seed);
  if (all->count)
    strut_buffer_add(
        &table,
        "  probability that one more start finds a new stable one: about %.2g, at most "
        "%.2g (95 %%);\n  a stable one that was missed attracts less than %.2g of the "
        "starts (95 %%)\n",
        all->missed.probability, all->missed.below, all->missed.one);
  if (all->unmet)
    strut_buffer_add(&table,
                     "  %" PRId64
                     " stable %s reached by no random start, only from other shapes: more basins "
                     "this small\n  may be missing\n",
                     all->unmet, all->unmet == 1 ? "one was" : "ones were");
  if (all->unseen)
    strut_buffer_add(&table, "  at least %" PRId64 " more stable ones exist (95 %%)\n",
                     all->unseen);
  if (all->cut_short)
    strut_buffer_add(&table,
                     "  cut short: a search of all shapes, bounded to some ten seconds of work; a "
                     "structure of this\n  size needs more starts and climbs; --starts N asks for "
                     "more\n");
  if (all->settle.evaluations > 0)
    strut_buffer_add(
        &table, "  the start settles in %s\n",
        all->start >= 0 ? all->list[all->start].name : "an equilibrium that is not in this list");
  if (all->start_trouble[0])
    strut_buffer_add(&table, "  the start does not settle: %s\n", all->start_trouble);
  char warning[300];
  if (strut_settle_warning(&all->settle, warning, sizeof warning))
    strut_buffer_add(&table, "  %s\n", warning);
  if (all->remark[0]) strut_buffer_add(&table, "  %s\n", all->remark);
  size_t most = everything ? SIZE_MAX : MOST_ROWS;
  add_section(&table, all, model, STANDING, "equilibrium", most);
  add_barriers(&table, all, everything);
  if (everything) {
    add_section(&table, all, model, HELD, "only while held", most);
    add_section(&table, all, model, UNSTABLE, "unstable", most);
    add_shapes(&table, all, scene);
  } else {
    add_counts(&table, all);
  }
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}
