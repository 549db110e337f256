/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/statics/equilibria/equilibria_parts.h"

#include "engine/base/vec.h"
#include "engine/model/compile_parts.h"
#include "engine/model/pose.h"
#include "engine/scene/things.h"

enum { MOST_LISTED = 4 };

static bool are_same_nodes(const strut_node_set *set, const int32_t *nodes, int32_t count) {
  if (set->count != (size_t)count) return false;
  for (int32_t i = 0; i < count; i++)
    if (!strut_is_listed(set->node, count, nodes[i])) return false;
  return true;
}

bool strut_rests_on_set(const strut_configuration *configuration, const int32_t *nodes,
                        int32_t count) {
  for (size_t k = 0; k < configuration->set_count; k++)
    if (are_same_nodes(&configuration->sets[k], nodes, count)) return true;
  return configuration->set_count == 0;
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
static bool mirror_axis(const strut_model *model, const uint8_t *held, const double *positions,
                        double *vector) {
  bool any = false;
  double sum = 0.0;
  const uint32_t sided = 1u << STRUT_STRAIN_ANGLE | 1u << STRUT_STRAIN_AREA |
                         1u << STRUT_STRAIN_ALONG | 1u << STRUT_STRAIN_OFFSET;
  if (model->strains & sided) return false; /* they change their sign */
  for (int32_t i = 0; i < model->node_count; i++) {
    if (model->constant_force && model->constant_force[2 * i] != 0.0) return false;
    sum += positions[2 * i];
    if (!model->fixed[2 * i] && !(held && held[2 * i])) continue;
    if (any && positions[2 * i] != *vector) return false;
    *vector = positions[2 * i];
    any = true;
  }
  if (!any) *vector = sum / model->node_count;
  return model->contacts.count == 0 || strut_contacts_are_level(&model->contacts);
}

/* Distance to the nearest configuration if that is near enough to lend its name, else HUGE_VAL. */
static double distance_to_configurations(const strut_model *model, const double *positions,
                                         double *scratch) {
  const strut_scene *scene = model->scene;
  double nearest = HUGE_VAL;
  for (size_t c = 0; c < scene->configuration_count; c++) {
    if (!scene->configurations[c].shaped) continue;
    memcpy(scratch, scene->configurations[c].position[0], 2 * scene->node_count * sizeof *scratch);
    nearest = fmin(nearest, strut_shape_distance(model, scratch, positions, false, NULL));
  }
  return nearest < STRUT_NAMED_WITHIN * model->size ? nearest : HUGE_VAL;
}

static double distance_to_drawn(const strut_model *model, const double *positions,
                                double *scratch) {
  const strut_scene *scene = model->scene;
  for (size_t i = 0; i < scene->node_count; i++)
    memcpy(scratch + 2 * i, scene->nodes[i].position, sizeof scene->nodes[i].position);
  return strut_shape_distance(model, scratch, positions, false, NULL);
}

/*
 * A mirror image turns the angles of hinges round. It is an equilibrium too only where all rest angles
 * are straight or folded, and all laws odd.
 */
static bool do_hinges_allow_mirrors(const strut_model *model) {
  static const double places[] = {0.01, 0.1, 1.0};
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *element = &model->elements.element[i];
    if (element->role != STRUT_ELEMENT_HINGE) continue;
    double rest = strut_element_start(model, i), half = 0.5 * STRUT_TAU;
    if (element->carries || fabs(rest - half * rint(rest / half)) > 1e-12) return false;
    for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
      double x = places[k];
      double there = strut_law_respond(element->law, &element->numbers, rest + x, rest, -1).force;
      double back = strut_law_respond(element->law, &element->numbers, rest - x, rest, -1).force;
      if (fabs(there + back) > 1e-9 * (fabs(there) + fabs(back))) return false;
    }
  }
  return true;
}

strut_status strut_orient_shape(const strut_model *model, const uint8_t *held, double *positions,
                                double *softest) {
  double x = 0.0;
  if (!mirror_axis(model, held, positions, &x) || !do_hinges_allow_mirrors(model)) return STRUT_OK;
  size_t length = (size_t)model->length;
  double *mirrored = strut_allocate(2 * length, sizeof *mirrored);
  if (!mirrored) return STRUT_NO_MEMORY;
  double *scratch = mirrored + length;
  memcpy(mirrored, positions, length * sizeof *positions);
  for (int32_t i = 0; i < model->node_count; i++) mirrored[2 * i] = x + (x - positions[2 * i]);
  double as_is = distance_to_configurations(model, positions, scratch);
  double as_mirrored = distance_to_configurations(model, mirrored, scratch);
  if (as_is == as_mirrored) { /* most often both HUGE_VAL */
    as_is = distance_to_drawn(model, positions, scratch);
    as_mirrored = distance_to_drawn(model, mirrored, scratch);
  }
  if (as_mirrored < as_is) {
    memcpy(positions, mirrored, length * sizeof *positions);
    for (int32_t i = 0; i < model->node_count && softest; i++) softest[2 * i] = -softest[2 * i];
  }
  strut_release(mirrored);
  return STRUT_OK;
}

static bool may_be_named(const strut_equilibrium *equilibrium) {
  return !equilibrium->name && equilibrium->outcome == STRUT_OUTCOME_STANDS;
}

/* Largest distance between corresponding nodes after the best translation carries b onto a [m]. */
static double translated_distance(const strut_model *model, const double *first,
                                  const double *second) {
  double shift[2] = {0.0, 0.0}, largest = 0.0;
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    shift[i % 2] += (second[i] - first[i]) / (double)model->node_count;
  for (int32_t i = 0; i < 2 * model->node_count; i += 2)
    largest = fmax(largest,
                   hypot(second[i] - first[i] - shift[0], second[i + 1] - first[i + 1] - shift[1]));
  return largest;
}

static void name_shaped(const strut_model *model, const strut_configuration *configuration,
                        size_t count, strut_equilibrium **list, double *scratch) {
  strut_equilibrium *nearest = NULL;
  double least = STRUT_NAMED_WITHIN * model->size;
  memcpy(scratch, configuration->position[0], 2 * model->scene->node_count * sizeof *scratch);
  for (size_t i = 0; i < count; i++) {
    if (!may_be_named(list[i]) ||
        !strut_rests_on_set(configuration, list[i]->contacts, list[i]->contact_count))
      continue;
    /* Without a list of contacts, the shape says on which side the structure lies. */
    double d = model->contacts.count && !configuration->set_count
                   ? translated_distance(model, scratch, list[i]->rest)
                   : strut_shape_distance(model, scratch, list[i]->rest, false, NULL);
    if (!(d < least)) continue;
    least = d;
    nearest = list[i];
  }
  if (nearest) nearest->name = configuration->name;
}

static bool is_name_taken(size_t count, strut_equilibrium **list, const strut_scene *scene,
                          const char *name) {
  for (size_t i = 0; i < count; i++)
    if (list[i]->name && strcmp(list[i]->name, name) == 0) return true;
  return strut_thing_find(scene, STRUT_THING_CONFIGURATION, name) >= 0;
}

/* STEM-n with the first unused n from *n on. */
static const char *numbered_name(size_t count, strut_equilibrium **list, const strut_scene *scene,
                                 const char *stem, int *n, strut_arena *arena) {
  const char *name;
  do {
    name = strut_arena_format(arena, "%s-%d", stem, (*n)++);
  } while (name && is_name_taken(count, list, scene, name));
  return name;
}

/* All that rest on set k, lowest first. False: out of memory. */
static bool name_on_set(const strut_model *model, const strut_configuration *configuration,
                        size_t k, size_t count, strut_equilibrium **list, int *n,
                        strut_arena *arena) {
  for (;;) {
    strut_equilibrium *lowest = NULL;
    for (size_t i = 0; i < count; i++) {
      strut_equilibrium *equilibrium = list[i];
      if (!may_be_named(equilibrium) ||
          !are_same_nodes(&configuration->sets[k], equilibrium->contacts,
                          equilibrium->contact_count))
        continue;
      if (!lowest || equilibrium->rest_energy < lowest->rest_energy) lowest = equilibrium;
    }
    if (!lowest) return true;
    lowest->name = *n == 1
                       ? configuration->name
                       : numbered_name(count, list, model->scene, configuration->name, n, arena);
    if (*n == 1) *n = 2;
    if (!lowest->name) return false;
  }
}

/* ---- names by contacts and order of energy, for what no configuration names ---- */

enum { KINDS = 3, MOST_IN_STEM = 6, STEM = 300 };
static const char HELD[] = "held-";
static const char *const kind_names[KINDS] = {"equilibrium", "saddle", "maximum"};

/* Energies and shapes closer than this, relative, are equal but for rounding. */
static const double SAME = 1e-7;

typedef struct unnamed {
  strut_equilibrium *e;
  const char *stem; /* the name without its number */
  size_t place;     /* in the list; of equals the first stays first, whatever sorts */
} unnamed;

static int kind_of(const strut_equilibrium *equilibrium) {
  if (equilibrium->point.label == STRUT_SADDLE) return 1;
  return equilibrium->point.label == STRUT_MAXIMUM ? 2 : 0;
}

/* "n1-n4", "n1-n4-saddle", "held-n1-n4" (at rest only while held), "saddle" (touches nothing). */
static const char *make_stem(const strut_scene *scene, const strut_equilibrium *equilibrium,
                             strut_arena *arena) {
  char text[STEM] = "";
  size_t used = 0;
  int shown = 0;
  if (equilibrium->contact_count == 0) return kind_names[kind_of(equilibrium)];
  bool held = equilibrium->supports && equilibrium->outcome != STRUT_OUTCOME_STANDS;
  if (held) used = (size_t)snprintf(text, sizeof text, "%s", HELD);
  for (size_t i = 0; i < scene->node_count && used < sizeof text; i++) {
    if (!strut_is_listed(equilibrium->contacts, equilibrium->contact_count, (int32_t)i) ||
        ++shown > MOST_IN_STEM)
      continue;
    int n = snprintf(text + used, sizeof text - used, "%s%s", shown > 1 ? "-" : "",
                     scene->nodes[i].name);
    if (n > 0) used += (size_t)n;
  }
  if (shown > MOST_IN_STEM && used < sizeof text)
    used += (size_t)snprintf(text + used, sizeof text - used, "+%d", shown - MOST_IN_STEM);
  if (kind_of(equilibrium) > 0 && used < sizeof text)
    snprintf(text + used, sizeof text - used, "-%s", kind_names[kind_of(equilibrium)]);
  return strut_arena_format(arena, "%s", text);
}

/* The i-th invariant of the shape under rigid motions; mirroring changes it. */
static double shape_invariant(const strut_model *model, const double *positions, int32_t i) {
  int32_t node = i / 2, second = model->node_count > 1 ? 1 : 0;
  double x = positions[2 * node] - positions[0], y = positions[2 * node + 1] - positions[1];
  if (i % 2 == 0) return hypot(x, y) / model->size;
  double dx = positions[2 * second] - positions[0], dy = positions[2 * second + 1] - positions[1];
  return (x * dy - y * dx) / (model->size * model->size);
}

bool strut_equilibrium_comes_before(const strut_model *model, const strut_equilibrium *first,
                                    const strut_equilibrium *second) {
  double scale = fmax(fabs(first->energy), fabs(second->energy));
  if (fabs(first->energy - second->energy) > SAME * scale) return first->energy < second->energy;
  for (int32_t i = 0; i < 2 * model->node_count; i++) {
    double x = shape_invariant(model, first->point.q, i),
           y = shape_invariant(model, second->point.q, i);
    if (fabs(x - y) > 100 * SAME) return x < y;
  }
  return false;
}

/*
 * Insertion sort: few share a stem, and it tolerates a comparison that rounding makes intransitive.
 */
static void sort_by_energy(const strut_model *model, size_t count, unnamed *rows) {
  for (size_t i = 1; i < count; i++) {
    unnamed row = rows[i];
    size_t k = i;
    for (; k > 0 && strut_equilibrium_comes_before(model, row.e, rows[k - 1].e); k--)
      rows[k] = rows[k - 1];
    rows[k] = row;
  }
}

static int by_stem(const void *first, const void *second) {
  const unnamed *self = first, *y = second;
  int order = strcmp(self->stem, y->stem);
  if (order) return order;
  return (self->place > y->place) - (self->place < y->place);
}

static strut_status name_by_contacts(const strut_model *model, size_t count,
                                     strut_equilibrium **list, strut_arena *arena) {
  unnamed *rows = strut_allocate(count + 1, sizeof *rows);
  size_t rest = 0;
  bool good = rows;
  for (size_t i = 0; i < count && good; i++) {
    if (list[i]->name) continue;
    rows[rest] = (unnamed){list[i], make_stem(model->scene, list[i], arena), i};
    good = rows[rest++].stem;
  }
  if (good && rest) qsort(rows, rest, sizeof *rows, by_stem);
  for (size_t from = 0, to; from < rest && good; from = to) {
    int n = 1;
    for (to = from + 1; to < rest && strcmp(rows[to].stem, rows[from].stem) == 0;) to++;
    sort_by_energy(model, to - from, rows + from);
    for (size_t i = from; i < to && good; i++) {
      rows[i].e->name = numbered_name(count, list, model->scene, rows[i].stem, &n, arena);
      good = rows[i].e->name;
    }
  }
  strut_release(rows);
  return good ? STRUT_OK : STRUT_NO_MEMORY;
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
    const strut_configuration *configuration = &scene->configurations[i];
    int n = 1;
    for (size_t k = 0; !configuration->shaped && k < configuration->set_count; k++)
      if (!name_on_set(model, configuration, k, count, list, &n, arena)) return STRUT_NO_MEMORY;
  }
  for (size_t i = 0; i < count; i++) list[i]->configured = list[i]->name != NULL;
  return name_by_contacts(model, count, list, arena);
}

static bool starts_with(const char *text, const char *start) {
  return strncmp(text, start, strlen(start)) == 0;
}

bool strut_is_listed_name(const strut_scene *scene, const char *name) {
  const char *dash = strrchr(name, '-');
  if (!dash || dash[1] == 0 || dash[1 + strspn(dash + 1, "0123456789")] != 0) return false;
  size_t stem = (size_t)(dash - name);
  for (size_t i = 0; i < scene->configuration_count; i++) {
    const char *own = scene->configurations[i].name;
    if (strlen(own) == stem && strncmp(own, name, stem) == 0) return true;
  }
  if (starts_with(name, HELD)) name += strlen(HELD);
  for (size_t i = 0; i < scene->contact_count; i++) {
    const char *node = scene->nodes[scene->contacts[i].node].name;
    const char *after = name + strlen(node);
    if (starts_with(name, node) && (*after == '-' || *after == '+')) return true;
  }
  for (int i = 0; i < KINDS; i++)
    if (starts_with(name, kind_names[i]) && strlen(kind_names[i]) == (size_t)(dash - name))
      return true;
  return false;
}
