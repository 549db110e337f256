/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reports the results of a search for equilibria: flaws of their shapes, JSON, and tables that fit a screen. */
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

/* ---- flaws of shapes ---- */

/*
 * Which nodes coincide and which members cross. Only those are compared whose extents along x overlap: they
 * are sorted by where these begin.
 */

/* Twice the area of a, b, c: positive where they turn left. */
static double turn(const double *a, const double *b, const double *c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static bool members_cross(const strut_model *model, const double *q, int32_t i, int32_t j) {
  const strut_member_table *t = &model->members;
  if (t->from[i] == t->from[j] || t->from[i] == t->to[j] || t->to[i] == t->from[j] ||
      t->to[i] == t->to[j])
    return false;
  const double *a = q + t->from[i], *b = q + t->to[i], *c = q + t->from[j], *d = q + t->to[j];
  double least = 1e-8 * model->size * model->size;
  double c_side = turn(a, b, c), d_side = turn(a, b, d);
  double a_side = turn(c, d, a), b_side = turn(c, d, b);
  bool apart = fmin(fabs(c_side), fabs(d_side)) > least && fmin(fabs(a_side), fabs(b_side)) > least;
  return apart && (c_side > 0) != (d_side > 0) && (a_side > 0) != (b_side > 0);
}

typedef struct shape_flaws {
  bool collapsed;    /* two nodes coincide, or a member has no length, within 1e-4 model sizes */
  int32_t crossings; /* pairs of members that cross, away from their ends */
} shape_flaws;

/* What is compared: nodes, or members. */
typedef struct things {
  const strut_model *model;
  const double *q;
  int32_t count;
  bool members;
  shape_flaws *flaws;
} things;

static double margin(const things *t) { return 1e-4 * t->model->size; }

static void compare(const things *t, int32_t i, int32_t j) {
  const double *q = t->q;
  if (t->members)
    t->flaws->crossings += members_cross(t->model, q, i, j);
  else if (hypot(q[2 * i] - q[2 * j], q[2 * i + 1] - q[2 * j + 1]) < margin(t))
    t->flaws->collapsed = true;
}

static bool is_done(const things *t) { return !t->members && t->flaws->collapsed; }

/* The rectangle of a thing; two things whose rectangles do not touch have no flaw. */
typedef struct extent {
  double least[2], most[2];
  int32_t thing;
} extent;

static extent extent_of(const things *t, int32_t i) {
  const strut_member_table *m = &t->model->members;
  extent e = {.thing = i};
  for (int c = 0; c < 2; c++) {
    double a = t->q[t->members ? (int32_t)m->from[i] + c : 2 * i + c];
    double b = t->members ? t->q[(int32_t)m->to[i] + c] : a + margin(t);
    e.least[c] = fmin(a, b);
    e.most[c] = fmax(a, b);
  }
  return e;
}

static int by_left_edge(const void *a, const void *b) {
  double x = ((const extent *)a)->least[0], y = ((const extent *)b)->least[0];
  return (x > y) - (x < y);
}

static void find_flaws(const things *t) {
  extent *e = strut_allocate((size_t)t->count + 1, sizeof *e);
  if (!e) { /* memory is out */
    for (int32_t i = 0; i < t->count; i++)
      for (int32_t j = 0; j < i && !is_done(t); j++) compare(t, i, j);
    return;
  }
  for (int32_t i = 0; i < t->count; i++) e[i] = extent_of(t, i);
  qsort(e, (size_t)t->count, sizeof *e, by_left_edge);
  for (int32_t i = 0; i < t->count && !is_done(t); i++)
    for (int32_t j = i + 1; j < t->count && e[j].least[0] <= e[i].most[0]; j++)
      if (e[j].least[1] <= e[i].most[1] && e[j].most[1] >= e[i].least[1])
        compare(t, e[i].thing, e[j].thing);
  strut_release(e);
}

static shape_flaws find_shape_flaws(const strut_model *model, const double *q) {
  shape_flaws flaws = {0};
  find_flaws(&(things){model, q, model->node_count, false, &flaws});
  find_flaws(&(things){model, q, model->members.count, true, &flaws});
  return flaws;
}

/* ---- JSON ---- */

struct cJSON;

const char *strut_outcome_name(strut_outcome fate) {
  static const char *const names[] = {"stands",   "tips",   "below ground",
                                      "unstable", "floppy", "no rest"};
  assert((size_t)fate < sizeof names / sizeof names[0]);
  return names[fate];
}

static void put_names(strut_json *json, struct cJSON *to, const char *key, const strut_scene *scene,
                      const int32_t *node, size_t count) {
  struct cJSON *names = strut_json_array(json, to, key);
  for (size_t i = 0; i < count; i++) strut_json_text(json, names, NULL, scene->nodes[node[i]].name);
}

static void put_nodes(strut_json *json, struct cJSON *to, const strut_scene *scene,
                      const double *q) {
  struct cJSON *nodes = strut_json_object(json, to, "nodes");
  for (size_t i = 0; i < scene->node_count; i++)
    strut_json_numbers(json, nodes, scene->nodes[i].name, q + 2 * i, 2);
}

static void put_supports(strut_json *json, struct cJSON *to, const strut_scene *scene,
                         const strut_equilibrium *e) {
  put_names(json, to, "contacts", scene, e->contacts, (size_t)e->contact_count);
  if (e->supports)
    put_names(json, to, "supports", scene, e->supports->node, e->supports->count);
  else
    strut_json_text(json, to, "supports", NULL);
}

static bool is_support(const strut_scene *scene, const strut_equilibrium *e, size_t node) {
  for (size_t i = 0; e->supports && i < e->supports->count; i++)
    if (e->supports->node[i] == (int32_t)node) return true;
  return scene->nodes[node].fixed[0] || scene->nodes[node].fixed[1];
}

static void put_forces(strut_json *json, struct cJSON *to, const strut_scene *scene,
                       const strut_equilibrium *e) {
  struct cJSON *forces = strut_json_object(json, to, "forces");
  for (size_t j = 0; j < scene->member_count; j++)
    strut_json_number(json, forces, scene->members[j].name, e->member_force[j]);
  struct cJSON *reactions = strut_json_object(json, to, "reactions");
  for (size_t i = 0; i < scene->node_count; i++)
    if (is_support(scene, e, i))
      strut_json_numbers(json, reactions, scene->nodes[i].name, e->reaction[i], 2);
}

static void put_below(strut_json *json, struct cJSON *to, const strut_scene *scene,
                      const strut_equilibrium *e) {
  struct cJSON *below = strut_json_array(json, to, "below_ground");
  for (size_t i = 0; i < scene->node_count; i++)
    if (e->below[i]) strut_json_text(json, below, NULL, scene->nodes[i].name);
}

static void put_rest(strut_json *json, struct cJSON *to, const strut_scene *scene,
                     const strut_equilibrium *e) {
  if (!e->rest) {
    strut_json_text(json, to, "rest", NULL);
    return;
  }
  struct cJSON *rest = strut_json_object(json, to, "rest");
  put_nodes(json, rest, scene, e->rest);
  strut_json_number(json, rest, "energy", e->rest_energy);
  strut_json_number(json, rest, "residual", e->rest_residual);
  strut_json_number(json, rest, "friction", e->friction);
  struct cJSON *contacts = strut_json_object(json, rest, "contacts");
  for (int32_t i = 0; i < e->contact_count; i++)
    strut_json_number(json, contacts, scene->nodes[e->contacts[i]].name, e->normal[i]);
}

static void put_down(strut_json *json, struct cJSON *to, const strut_equilibria *all,
                     const strut_equilibrium *e) {
  if (e->point.label != STRUT_SADDLE || e->point.negative != 1) return;
  struct cJSON *down = strut_json_array(json, to, "down");
  for (int k = 0; k < 2; k++)
    strut_json_text(json, down, NULL,
                    e->point.down[k] >= 0 ? all->list[e->point.down[k]].name : NULL);
}

static void put_equilibrium(strut_json *json, struct cJSON *to, const strut_equilibria *all,
                            const strut_model *model, const strut_equilibrium *e) {
  const strut_scene *scene = model->scene;
  const strut_critical_point *p = &e->point;
  strut_json_text(json, to, "name", e->name);
  strut_json_text(json, to, "label", strut_stability_name(p->label));
  strut_json_number(json, to, "energy", e->energy);
  strut_json_number(json, to, "potential", p->potential);
  put_supports(json, to, scene, e);
  strut_json_text(json, to, "outcome", strut_outcome_name(e->outcome));
  strut_json_text(json, to, "verdict", e->verdict);
  strut_json_text(json, to, "tips_over",
                  e->tips_over >= 0 ? scene->nodes[e->tips_over].name : NULL);
  strut_json_text(json, to, "ends_as", e->ends_as >= 0 ? all->list[e->ends_as].name : NULL);
  strut_json_integer(json, to, "shape", p->shape);
  strut_json_integer(json, to, "congruent_copies", p->placements);
  strut_json_integer(json, to, "found", p->found);
  shape_flaws flaws = find_shape_flaws(model, p->q);
  strut_json_bool(json, to, "collapsed", flaws.collapsed);
  strut_json_integer(json, to, "crossings", flaws.crossings);
  if (scene->collision_count) {
    strut_json_text(json, to, "overlap",
                    e->overlap >= 0 ? scene->collisions[e->overlap].name : NULL);
    strut_json_text(json, to, "through",
                    e->through >= 0 ? scene->collisions[e->through].name : NULL);
  }
  put_nodes(json, to, scene, p->q);
  put_forces(json, to, scene, e);
  put_below(json, to, scene, e);
  strut_json_numbers(json, to, "eigenvalues", p->eigenvalues, (size_t)p->eigenvalue_count);
  strut_json_integer(json, to, "negative_eigenvalues", p->negative);
  strut_json_integer(json, to, "zero_eigenvalues", p->zero);
  put_rest(json, to, scene, e);
  put_down(json, to, all, e);
}

static void put_barriers(strut_json *json, const strut_equilibria *all) {
  struct cJSON *barriers = strut_json_array(json, json->root, "barriers");
  for (size_t i = 0; i < all->barrier_count; i++) {
    const strut_barrier *b = &all->barriers[i];
    struct cJSON *row = strut_json_object(json, barriers, NULL);
    strut_json_text(json, row, "from", all->list[b->from].name);
    strut_json_text(json, row, "to", all->list[b->to].name);
    strut_json_number(json, row, "height", b->height);
    strut_json_text(json, row, "saddle", b->saddle >= 0 ? all->list[b->saddle].name : NULL);
    struct cJSON *via = strut_json_array(json, row, "via");
    for (int32_t k = 0; k < b->via_count; k++)
      strut_json_text(json, via, NULL, b->via[k] >= 0 ? all->list[b->via[k]].name : NULL);
    strut_json_number(json, row, "direct", b->direct);
    strut_json_text(json, row, "direct_saddle",
                    b->direct_saddle >= 0 ? all->list[b->direct_saddle].name : NULL);
  }
}

char *strut_equilibria_json(const strut_equilibria *all, const strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_json json = strut_json_begin();
  strut_json_text(&json, json.root, "name", scene->name);
  strut_json_text(&json, json.root, "strut_version", STRUT_VERSION);
  strut_json_integer(&json, json.root, "seed", (int64_t)all->seed);
  strut_json_integer(&json, json.root, "starts", all->starts);
  struct cJSON *missed = strut_json_object(&json, json.root, "missed");
  strut_json_number(&json, missed, "probability", all->missed.probability);
  strut_json_number(&json, missed, "probability_bound", all->missed.below);
  strut_json_integer(&json, missed, "unreached", all->unmet);
  strut_json_number(&json, missed, "smallest_basin", all->missed.one);
  strut_json_integer(&json, missed, "at_least", all->unseen);
  strut_json_bool(&json, missed, "cut_short", all->cut_short);
  strut_json_settle(&json, json.root, &all->settle);
  if (all->settle.evaluations > 0)
    strut_json_text(&json, json.root, "start", all->start >= 0 ? all->list[all->start].name : NULL);
  if (all->start_trouble[0]) strut_json_text(&json, json.root, "start_trouble", all->start_trouble);
  strut_json_text(&json, json.root, "remark", all->remark[0] ? all->remark : NULL);
  struct cJSON *list = strut_json_array(&json, json.root, "equilibria");
  for (size_t i = 0; i < all->count; i++)
    put_equilibrium(&json, strut_json_object(&json, list, NULL), all, model, &all->list[i]);
  put_barriers(&json, all);
  return strut_json_end(&json);
}

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
static void describe_flaws(shape_flaws flaws, char text[NAMES]) {
  if (flaws.collapsed)
    snprintf(text, NAMES, "collapsed");
  else if (flaws.crossings)
    snprintf(text, NAMES, "%" PRId32 " crossing%s", flaws.crossings,
             flaws.crossings == 1 ? "" : "s");
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
  describe_flaws(find_shape_flaws(model, e->point.q), flaws);
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
