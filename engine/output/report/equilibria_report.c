/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/report/equilibria_report.h"

#include <math.h>

#include "engine/output/json.h"
#include "engine/output/json_value.h"

struct cJSON;

const char *strut_outcome_name(strut_outcome fate) {
  static const char *const names[] = {"stands",   "tips",   "below ground",
                                      "unstable", "floppy", "no rest"};
  return names[fate];
}

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

strut_shape_flaws strut_find_shape_flaws(const strut_model *model, const double *q) {
  const double least = 1e-4 * model->size;
  strut_shape_flaws flaws = {0};
  for (int32_t i = 0; i < model->node_count && !flaws.collapsed; i++)
    for (int32_t j = 0; j < i && !flaws.collapsed; j++)
      flaws.collapsed = hypot(q[2 * i] - q[2 * j], q[2 * i + 1] - q[2 * j + 1]) < least;
  for (int32_t i = 0; i < model->members.count; i++)
    for (int32_t j = 0; j < i; j++) flaws.crossings += members_cross(model, q, i, j);
  return flaws;
}

static void add_names(strut_json *json, struct cJSON *to, const char *key, const strut_scene *scene,
                      const int32_t *node, size_t count) {
  struct cJSON *names = strut_json_array(json, to, key);
  for (size_t i = 0; i < count; i++) strut_json_text(json, names, NULL, scene->nodes[node[i]].name);
}

static void add_nodes(strut_json *json, struct cJSON *to, const strut_scene *scene,
                      const double *q) {
  struct cJSON *nodes = strut_json_object(json, to, "nodes");
  for (size_t i = 0; i < scene->node_count; i++)
    strut_json_numbers(json, nodes, scene->nodes[i].name, q + 2 * i, 2);
}

static void add_supports(strut_json *json, struct cJSON *to, const strut_scene *scene,
                         const strut_equilibrium *e) {
  add_names(json, to, "contacts", scene, e->contacts, (size_t)e->contact_count);
  if (e->supports)
    add_names(json, to, "supports", scene, e->supports->node, e->supports->count);
  else
    strut_json_text(json, to, "supports", NULL);
}

static bool is_support(const strut_scene *scene, const strut_equilibrium *e, size_t node) {
  for (size_t i = 0; e->supports && i < e->supports->count; i++)
    if (e->supports->node[i] == (int32_t)node) return true;
  return scene->nodes[node].fixed[0] || scene->nodes[node].fixed[1];
}

static void add_forces(strut_json *json, struct cJSON *to, const strut_scene *scene,
                       const strut_equilibrium *e) {
  struct cJSON *forces = strut_json_object(json, to, "forces");
  for (size_t j = 0; j < scene->member_count; j++)
    strut_json_number(json, forces, scene->members[j].name, e->member_force[j]);
  struct cJSON *reactions = strut_json_object(json, to, "reactions");
  for (size_t i = 0; i < scene->node_count; i++)
    if (is_support(scene, e, i))
      strut_json_numbers(json, reactions, scene->nodes[i].name, e->reaction[i], 2);
}

static void add_below(strut_json *json, struct cJSON *to, const strut_scene *scene,
                      const strut_equilibrium *e) {
  struct cJSON *below = strut_json_array(json, to, "below_ground");
  for (size_t i = 0; i < scene->node_count; i++)
    if (e->below[i]) strut_json_text(json, below, NULL, scene->nodes[i].name);
}

static void add_rest(strut_json *json, struct cJSON *to, const strut_scene *scene,
                     const strut_equilibrium *e) {
  if (!e->rest) {
    strut_json_text(json, to, "rest", NULL);
    return;
  }
  struct cJSON *rest = strut_json_object(json, to, "rest");
  add_nodes(json, rest, scene, e->rest);
  strut_json_number(json, rest, "energy", e->rest_energy);
  strut_json_number(json, rest, "residual", e->rest_residual);
  struct cJSON *contacts = strut_json_object(json, rest, "contacts");
  for (int32_t i = 0; i < e->contact_count; i++)
    strut_json_number(json, contacts, scene->nodes[e->contacts[i]].name, e->normal[i]);
}

static void add_down(strut_json *json, struct cJSON *to, const strut_equilibria *all,
                     const strut_equilibrium *e) {
  if (e->point.label != STRUT_SADDLE || e->point.negative != 1) return;
  struct cJSON *down = strut_json_array(json, to, "down");
  for (int k = 0; k < 2; k++)
    strut_json_text(json, down, NULL,
                    e->point.down[k] >= 0 ? all->list[e->point.down[k]].name : NULL);
}

static void add_equilibrium(strut_json *json, struct cJSON *to, const strut_equilibria *all,
                            const strut_model *model, const strut_equilibrium *e) {
  const strut_scene *scene = model->scene;
  const strut_critical_point *p = &e->point;
  strut_json_text(json, to, "name", e->name);
  strut_json_text(json, to, "label", strut_stability_name(p->label));
  strut_json_number(json, to, "energy", e->energy);
  strut_json_number(json, to, "potential", p->potential);
  add_supports(json, to, scene, e);
  strut_json_text(json, to, "outcome", strut_outcome_name(e->fate));
  strut_json_text(json, to, "verdict", e->verdict);
  strut_json_text(json, to, "tips_over",
                  e->tips_over >= 0 ? scene->nodes[e->tips_over].name : NULL);
  strut_json_text(json, to, "ends_as", e->ends_as >= 0 ? all->list[e->ends_as].name : NULL);
  strut_json_integer(json, to, "shape", p->shape);
  strut_json_integer(json, to, "congruent_copies", p->placements);
  strut_json_integer(json, to, "found", p->found);
  strut_shape_flaws flaws = strut_find_shape_flaws(model, p->q);
  strut_json_bool(json, to, "collapsed", flaws.collapsed);
  strut_json_integer(json, to, "crossings", flaws.crossings);
  add_nodes(json, to, scene, p->q);
  add_forces(json, to, scene, e);
  add_below(json, to, scene, e);
  strut_json_numbers(json, to, "eigenvalues", p->eigenvalues, (size_t)p->eigenvalue_count);
  strut_json_integer(json, to, "negative_eigenvalues", p->negative);
  strut_json_integer(json, to, "zero_eigenvalues", p->zero);
  add_rest(json, to, scene, e);
  add_down(json, to, all, e);
}

static void add_barriers(strut_json *json, const strut_equilibria *all) {
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
  strut_json_number(&json, missed, "probability", all->missed);
  strut_json_number(&json, missed, "probability_bound", all->missed_below);
  strut_json_integer(&json, missed, "unreached", all->unmet);
  strut_json_number(&json, missed, "smallest_basin", all->missed_one);
  strut_json_bool(&json, missed, "cut_short", all->cut_short);
  strut_json_settle(&json, json.root, &all->settle);
  if (all->settle.evaluations > 0)
    strut_json_text(&json, json.root, "start", all->start >= 0 ? all->list[all->start].name : NULL);
  if (all->start_trouble[0]) strut_json_text(&json, json.root, "start_trouble", all->start_trouble);
  strut_json_text(&json, json.root, "remark", all->remark[0] ? all->remark : NULL);
  struct cJSON *list = strut_json_array(&json, json.root, "equilibria");
  for (size_t i = 0; i < all->count; i++)
    add_equilibrium(&json, strut_json_object(&json, list, NULL), all, model, &all->list[i]);
  add_barriers(&json, all);
  return strut_json_end(&json);
}
