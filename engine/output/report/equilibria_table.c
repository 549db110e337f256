/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a search for equilibria found, as tables of a screenful. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/buffer.h"
#include "engine/output/quantity_text.h"
#include "engine/output/report/equilibria_report.h"

enum { MOST_ROWS = 80, MOST_SHAPES = 6, MOST_SADDLES = 24, MOST_NODES = 12, NAMES = 64 };

static void list_names(const strut_scene *scene, const int32_t *node, size_t count,
                       char text[NAMES]) {
  size_t used = 0;
  snprintf(text, NAMES, "-");
  for (size_t i = 0; i < count && used < NAMES; i++) {
    int n = snprintf(text + used, NAMES - used, "%s%s", i ? "," : "", scene->nodes[node[i]].name);
    if (n < 0) return;
    used += (size_t)n;
  }
}

static void add_row(strut_buffer *table, const strut_scene *scene, const strut_equilibrium *e) {
  char names[NAMES];
  list_names(scene, e->supports ? e->supports->node : NULL, e->supports ? e->supports->count : 0,
             names);
  int32_t first = e->point.label == STRUT_STABLE ? e->point.zero : 0; /* free motions apart */
  double lowest = first < e->point.eigenvalue_count ? e->point.eigenvalues[first] : (double)NAN;
  strut_buffer_add(table, "  %-12s %-10s %-8s %14s %13s %7" PRId64 "  %s\n", e->name, names,
                   strut_stability_name(e->point.label), strut_quantity_of(e->energy, 8, "J").text,
                   strut_quantity_of(lowest, 5, "N/m").text, e->point.found, e->verdict);
}

static void add_list(strut_buffer *table, const strut_equilibria *all, const strut_scene *scene) {
  size_t shown = 0, left = 0, unstable = 0;
  if (all->count == 0) return;
  strut_buffer_add(table, "\n  %-12s %-10s %-8s %14s %13s %7s  %s\n", "equilibrium", "held",
                   "label", "energy", "lowest", "found", "what becomes of it");
  for (size_t i = 0; i < all->count; i++) {
    const strut_equilibrium *e = &all->list[i];
    if (e->fate == STRUT_OUTCOME_UNSTABLE) {
      unstable++;
    } else if (shown < MOST_ROWS) {
      add_row(table, scene, e);
      shown++;
    } else {
      left++;
    }
  }
  if (left) strut_buffer_add(table, "  ... and %zu more; --json lists all\n", left);
  if (unstable)
    strut_buffer_add(table, "  and %zu unstable ones, saddles and maxima; --json lists all\n",
                     unstable);
}

/* Saddles with one way down on either side; the real ground's, which are few and matter, first. */
static void add_saddles(strut_buffer *table, const strut_equilibria *all,
                        const strut_scene *scene) {
  size_t shown = 0, left = 0;
  for (int held = 0; held < 2; held++)
    for (size_t i = 0; i < all->count; i++) {
      const strut_equilibrium *e = &all->list[i];
      const int32_t *down = e->point.down;
      char names[NAMES];
      if (e->point.negative != 1 || (e->supports != NULL) != held) continue;
      if (down[0] < 0 || down[1] < 0) continue;
      if (shown == MOST_SADDLES) {
        left++;
        continue;
      }
      if (shown++ == 0)
        strut_buffer_add(table, "\n  %-12s %-10s %14s %13s  %s\n", "saddle", "held", "energy",
                         "lowest", "between");
      list_names(scene, held ? e->supports->node : NULL, held ? e->supports->count : 0, names);
      strut_buffer_add(table, "  %-12s %-10s %14s %13s  %s, %s\n", e->name, names,
                       strut_quantity_of(e->energy, 8, "J").text,
                       strut_quantity_of(e->point.eigenvalues[0], 5, "N/m").text,
                       all->list[down[0]].name, all->list[down[1]].name);
    }
  if (left) strut_buffer_add(table, "  ... and %zu more; --json lists all\n", left);
}

static bool is_named(const strut_equilibrium *e) { return strncmp(e->name, "unnamed-", 8) != 0; }

/* Where it rests, and what presses there. */
static void add_shape(strut_buffer *table, const strut_scene *scene, const strut_equilibrium *e) {
  strut_buffer_add(table, "\n  %-12s %14s %14s", e->name, "x", "y");
  strut_buffer_add(table, e->contact_count ? " %14s\n" : "\n", "presses with");
  for (size_t i = 0; i < scene->node_count && i < MOST_NODES; i++) {
    strut_buffer_add(table, "  %-12s %14s %14s", scene->nodes[i].name,
                     strut_quantity_of(e->rest[2 * i], 7, "m").text,
                     strut_quantity_of(e->rest[2 * i + 1], 7, "m").text);
    for (int32_t k = 0; k < e->contact_count; k++)
      if (e->contacts[k] == (int32_t)i)
        strut_buffer_add(table, " %14s", strut_quantity_of(e->normal[k], 6, "N").text);
    strut_buffer_add(table, "\n");
  }
  if (scene->node_count > MOST_NODES)
    strut_buffer_add(table, "  ... and %zu more\n", scene->node_count - MOST_NODES);
}

/* Those that configurations name first. */
static void add_shapes(strut_buffer *table, const strut_equilibria *all, const strut_scene *scene) {
  int shown = 0;
  for (int named = 1; named >= 0; named--)
    for (size_t i = 0; i < all->count && shown < MOST_SHAPES; i++) {
      const strut_equilibrium *e = &all->list[i];
      if (e->fate != STRUT_OUTCOME_STANDS || is_named(e) != named) continue;
      add_shape(table, scene, e);
      shown++;
    }
}

static void add_barriers(strut_buffer *table, const strut_equilibria *all) {
  bool names = false;
  size_t shown = 0, left = 0;
  if (all->barrier_count == 0) return;
  for (size_t i = 0; i < all->count; i++) names = names || is_named(&all->list[i]);
  strut_buffer_add(table, "\n  %-12s %-12s %14s %14s  %s\n", "from", "to", "barrier",
                   "straight there", "over");
  for (size_t i = 0; i < all->barrier_count; i++) {
    const strut_barrier *b = &all->barriers[i];
    bool both = is_named(&all->list[b->from]) && is_named(&all->list[b->to]);
    if ((names && !both) || shown == MOST_ROWS) {
      left++;
      continue;
    }
    shown++;
    strut_buffer_add(table, "  %-12s %-12s %14s %14s  %s", all->list[b->from].name,
                     all->list[b->to].name, strut_quantity_of(b->height, 6, "J").text,
                     isnan(b->direct) ? "-" : strut_quantity_of(b->direct, 6, "J").text,
                     b->saddle >= 0 ? all->list[b->saddle].name : "-");
    for (int32_t k = 0; k < b->via_count; k++)
      strut_buffer_add(table, "%s%s", k ? ", " : ", by way of ",
                       b->via[k] >= 0 ? all->list[b->via[k]].name : "-");
    strut_buffer_add(table, "\n");
  }
  if (left) strut_buffer_add(table, "  ... and %zu more; --json lists all\n", left);
}

char *strut_equilibria_table(const strut_equilibria *all, const strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_buffer table = {0};
  strut_c_locale locale = strut_c_locale_enter();
  strut_buffer_add(&table, "%s%s%zu equilibria from %" PRId64 " starts, seed %" PRIu64 "\n",
                   scene->name, *scene->name ? ": " : "", all->count, all->starts, all->seed);
  if (all->count)
    strut_buffer_add(
        &table,
        "  chance that one more start finds a new stable one: about %.2g, below %.2g; a "
        "stable\n  one never met would have less than %.2g of the starts (95 %%)\n",
        all->missed, all->missed_below, all->missed_one);
  if (all->unmet)
    strut_buffer_add(&table,
                     "  %" PRId64
                     " stable %s met by no random start but found from others: small "
                     "basins, of which\n  there may be more than starts can tell\n",
                     all->unmet, all->unmet == 1 ? "one was" : "ones were");
  if (all->cut_short)
    strut_buffer_add(&table,
                     "  cut short: for its size it would take more starts and climbs; --starts N "
                     "asks for more\n");
  if (all->settle.evaluations > 0)
    strut_buffer_add(
        &table, "  the start settles in %s\n",
        all->start >= 0 ? all->list[all->start].name : "an equilibrium that is not listed here");
  if (all->start_trouble[0])
    strut_buffer_add(&table, "  the start does not settle: %s\n", all->start_trouble);
  char warning[300];
  if (strut_settle_warning(&all->settle, warning, sizeof warning))
    strut_buffer_add(&table, "  %s\n", warning);
  if (all->remark[0]) strut_buffer_add(&table, "  %s\n", all->remark);
  add_list(&table, all, scene);
  add_saddles(&table, all, scene);
  add_shapes(&table, all, scene);
  add_barriers(&table, all);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}
