/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/equilibria/naming.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOST_LISTED = 4 };

bool strut_same_nodes(const strut_node_set *set, const int32_t *nodes, int32_t count) {
  if (set->count != (size_t)count) return false;
  for (int32_t i = 0; i < count; i++) {
    bool there = false;
    for (size_t k = 0; k < set->count; k++) there = there || set->node[k] == nodes[i];
    if (!there) return false;
  }
  return true;
}

void strut_list_nodes(const strut_scene *scene, const uint8_t *flag, size_t size, char *text) {
  size_t all = 0, done = 0, used = 0;
  text[0] = '\0';
  for (size_t i = 0; i < scene->node_count; i++) all += flag[i] != 0;
  size_t shown = all <= MOST_LISTED + 1 ? all : MOST_LISTED;
  for (size_t i = 0; i < scene->node_count && done < shown && used < size; i++) {
    if (!flag[i]) continue;
    const char *before = done == 0 ? "" : done + 1 == all ? " and " : ", ";
    int n = snprintf(text + used, size - used, "%s%s", before, scene->nodes[i].name);
    if (n < 0) return;
    used += (size_t)n, done++;
  }
  if (shown < all && used < size) snprintf(text + used, size - used, " and %zu more", all - shown);
}

/* The x about which the whole may be mirrored; false: its mirror image is another problem. */
static bool mirror_axis(const strut_model *model, const uint8_t *held, const double *q, double *x) {
  bool any = false;
  double sum = 0.0;
  for (int32_t i = 0; i < model->node_count; i++) {
    if (model->constant_force && model->constant_force[2 * i] != 0.0) return false;
    sum += q[2 * i];
    if (!model->fixed[2 * i] && !(held && held[2 * i])) continue;
    if (any && q[2 * i] != *x) return false;
    *x = q[2 * i];
    any = true;
  }
  if (!any) *x = sum / model->node_count;
  return model->contacts.count == 0 || model->contacts.normal[0] == 0.0;
}

/* Distance to the nearest configuration if that is near enough to lend its name, else HUGE_VAL. */
static double to_configurations(const strut_model *model, const double *q, double *scratch) {
  const strut_scene *scene = model->scene;
  double nearest = HUGE_VAL;
  for (size_t c = 0; c < scene->configuration_count; c++) {
    if (!scene->configurations[c].shaped) continue;
    memcpy(scratch, scene->configurations[c].position[0], 2 * scene->node_count * sizeof *scratch);
    nearest = fmin(nearest, strut_shape_distance(model, scratch, q, false, NULL));
  }
  return nearest < STRUT_NAMED_WITHIN * model->size ? nearest : HUGE_VAL;
}

static double to_drawn(const strut_model *model, const double *q, double *scratch) {
  const strut_scene *scene = model->scene;
  for (size_t i = 0; i < scene->node_count; i++)
    memcpy(scratch + 2 * i, scene->nodes[i].position, sizeof scene->nodes[i].position);
  return strut_shape_distance(model, scratch, q, false, NULL);
}

strut_status strut_orient_shape(const strut_model *model, const uint8_t *held, double *q,
                                double *softest) {
  double x = 0.0;
  if (!mirror_axis(model, held, q, &x)) return STRUT_OK;
  size_t length = (size_t)model->length;
  double *mirrored = strut_allocate(2 * length, sizeof *mirrored);
  if (!mirrored) return STRUT_NO_MEMORY;
  double *scratch = mirrored + length;
  memcpy(mirrored, q, length * sizeof *q);
  for (int32_t i = 0; i < model->node_count; i++) mirrored[2 * i] = x + (x - q[2 * i]);
  double as_is = to_configurations(model, q, scratch);
  double as_mirrored = to_configurations(model, mirrored, scratch);
  if (as_is == as_mirrored) { /* most often both HUGE_VAL */
    as_is = to_drawn(model, q, scratch);
    as_mirrored = to_drawn(model, mirrored, scratch);
  }
  if (as_mirrored < as_is) {
    memcpy(q, mirrored, length * sizeof *q);
    for (int32_t i = 0; i < model->node_count && softest; i++) softest[2 * i] = -softest[2 * i];
  }
  strut_release(mirrored);
  return STRUT_OK;
}

static bool on_a_set(const strut_configuration *c, const strut_equilibrium *e) {
  for (size_t k = 0; k < c->set_count; k++)
    if (strut_same_nodes(&c->sets[k], e->contacts, e->contact_count)) return true;
  return c->set_count == 0;
}

static bool may_be_named(const strut_equilibrium *e) {
  return !e->name && e->fate == STRUT_OUTCOME_STANDS;
}

static void name_shaped(const strut_model *model, const strut_configuration *c, size_t count,
                        strut_equilibrium **list, double *scratch) {
  strut_equilibrium *nearest = NULL;
  double least = STRUT_NAMED_WITHIN * model->size;
  memcpy(scratch, c->position[0], 2 * model->scene->node_count * sizeof *scratch);
  for (size_t i = 0; i < count; i++) {
    if (!may_be_named(list[i]) || !on_a_set(c, list[i])) continue;
    double d = strut_shape_distance(model, scratch, list[i]->rest, false, NULL);
    if (!(d < least)) continue;
    least = d;
    nearest = list[i];
  }
  if (nearest) nearest->name = c->name;
}

static bool taken(size_t count, strut_equilibrium **list, const strut_scene *scene,
                  const char *name) {
  for (size_t i = 0; i < count; i++)
    if (list[i]->name && strcmp(list[i]->name, name) == 0) return true;
  for (size_t i = 0; i < scene->configuration_count; i++)
    if (strcmp(scene->configurations[i].name, name) == 0) return true;
  return false;
}

/* STEM-n with the first n from *n on that nothing is called yet. */
static const char *numbered(size_t count, strut_equilibrium **list, const strut_scene *scene,
                            const char *stem, int *n, strut_arena *arena) {
  const char *name;
  do {
    name = strut_arena_format(arena, "%s-%d", stem, (*n)++);
  } while (name && taken(count, list, scene, name));
  return name;
}

/* All that rest on set k, lowest first. False: out of memory. */
static bool name_on_set(const strut_model *model, const strut_configuration *c, size_t k,
                        size_t count, strut_equilibrium **list, int *n, strut_arena *arena) {
  for (;;) {
    strut_equilibrium *lowest = NULL;
    for (size_t i = 0; i < count; i++) {
      strut_equilibrium *e = list[i];
      if (!may_be_named(e) || !strut_same_nodes(&c->sets[k], e->contacts, e->contact_count))
        continue;
      if (!lowest || e->rest_energy < lowest->rest_energy) lowest = e;
    }
    if (!lowest) return true;
    lowest->name = *n == 1 ? c->name : numbered(count, list, model->scene, c->name, n, arena);
    if (*n == 1) *n = 2;
    if (!lowest->name) return false;
  }
}

strut_status strut_name_equilibria(const strut_model *model, size_t count, strut_equilibrium **list,
                                   strut_arena *arena) {
  const strut_scene *scene = model->scene;
  double *scratch = strut_allocate((size_t)model->length, sizeof *scratch);
  if (!scratch) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < scene->configuration_count; i++)
    if (scene->configurations[i].shaped)
      name_shaped(model, &scene->configurations[i], count, list, scratch);
  strut_release(scratch);
  for (size_t i = 0; i < scene->configuration_count; i++) {
    const strut_configuration *c = &scene->configurations[i];
    int n = 1;
    for (size_t k = 0; !c->shaped && k < c->set_count; k++)
      if (!name_on_set(model, c, k, count, list, &n, arena)) return STRUT_NO_MEMORY;
  }
  int n = 1;
  for (size_t i = 0; i < count; i++) {
    if (list[i]->name) continue;
    list[i]->name = numbered(count, list, scene, "unnamed", &n, arena);
    if (!list[i]->name) return STRUT_NO_MEMORY;
  }
  return STRUT_OK;
}
