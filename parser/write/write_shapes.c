/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Configurations, the search for equilibria and the initial state, as YAML. See writer.h. */
#include <math.h>
#include <string.h>

#include "parser/write/writer.h"

/* Same bits? -0 and 0 differ. */
static bool same(const double a[2], const double b[2]) { return memcmp(a, b, 2 * sizeof *a) == 0; }

/* "[[n1, n4], [n2]]": always a list of lists, which cannot be mistaken for a position. */
static void put_node_sets(strut_writer *writer, const strut_node_set *sets, size_t count) {
  strut_put(writer, "[");
  for (size_t i = 0; i < count; i++) {
    strut_put(writer, i ? ", [" : "[");
    for (size_t n = 0; n < sets[i].count; n++) {
      if (n) strut_put(writer, ", ");
      strut_put_name(writer, writer->scene->nodes[sets[i].node[n]].name);
    }
    strut_put(writer, "]");
  }
  strut_put(writer, "]");
}

/* The positions that are not as drawn. */
static void put_shape(strut_writer *writer, const strut_configuration *c) {
  bool first = true;
  strut_put(writer, "{");
  for (size_t i = 0; i < writer->scene->node_count; i++) {
    const strut_node *node = &writer->scene->nodes[i];
    if (same(c->position[i], node->position)) continue;
    if (!first) strut_put(writer, ", ");
    first = false;
    strut_put_name(writer, node->name);
    strut_put(writer, ": ");
    strut_put_pair(writer, c->position[i]);
  }
  strut_put(writer, "}");
}

static void put_configurations(strut_writer *writer) {
  const strut_scene *scene = writer->scene;
  if (scene->configuration_count) strut_put(writer, "configurations:\n");
  for (size_t i = 0; i < scene->configuration_count; i++) {
    const strut_configuration *c = &scene->configurations[i];
    strut_mapping mapping = STRUT_MAPPING_INLINE;
    strut_put(writer, "  ");
    strut_put_name(writer, c->name);
    strut_put(writer, ": {");
    if (c->set_count) {
      strut_put_key_name(writer, &mapping, STRUT_KEY_CONFIGURATION_CONTACTS);
      put_node_sets(writer, c->sets, c->set_count);
    }
    if (c->shaped) {
      strut_put_key_name(writer, &mapping, STRUT_KEY_CONFIGURATION_SHAPE);
      put_shape(writer, c);
    }
    strut_put(writer, "}\n");
  }
}

static void put_supports(strut_writer *writer, strut_mapping *mapping, int key,
                         const void *object) {
  const strut_search *search = object;
  if (!search->support_count) return;
  strut_put_key_name(writer, mapping, key);
  put_node_sets(writer, search->supports, search->support_count);
}

static void put_search(strut_writer *writer) {
  const strut_search *search = &writer->experiment->search,
                     *usual = &writer->usual.experiment.search;
  strut_mapping mapping = STRUT_MAPPING_INLINE;
  if (!search->support_count && !strut_fields_differ(STRUT_SECTION_EQUILIBRIA, search, usual))
    return;
  strut_put(writer, "equilibria: {");
  strut_put_fields(writer, &mapping, STRUT_SECTION_EQUILIBRIA, search, usual, put_supports);
  strut_put(writer, "}\n");
}

static bool is_configuration(const strut_scene *scene, const char *name) {
  for (size_t i = 0; i < scene->configuration_count; i++)
    if (strcmp(scene->configurations[i].name, name) == 0) return true;
  return false;
}

/* A name that refers to the configuration: its own, unless a text parameter has that name. */
static const char *leading_name(const strut_scene *scene, const char *name) {
  const char *leading = name;
  bool taken = false;
  for (size_t i = 0; i < scene->parameter_count; i++) {
    const strut_parameter *p = &scene->parameters[i];
    if (!isnan(p->value)) continue; /* no text */
    if (strcmp(p->name, name) == 0) taken = true;
    if (strcmp(p->text, name) == 0 && !is_configuration(scene, p->name)) leading = p->name;
  }
  return taken ? leading : name;
}

static void put_initial_pair(strut_writer *writer, bool *begun, bool *listed, const char *key,
                             const char *node, const double pair[2]) {
  if (!*begun) strut_put(writer, "initial:\n");
  if (!*listed) strut_put(writer, key);
  *begun = *listed = true;
  strut_put(writer, "    ");
  strut_put_name(writer, node);
  strut_put(writer, ": ");
  strut_put_pair(writer, pair);
  strut_put(writer, "\n");
}

/* The step of settling, if it differs from that of the run. */
static void put_settling_step(strut_writer *writer, strut_mapping *mapping, int key,
                              const void *object) {
  const strut_settle *settle = object;
  if (settle->step <= 0.0 || settle->step == writer->experiment->step) return;
  strut_put_key_name(writer, mapping, key);
  strut_put_number(writer, settle->step);
}

static void put_settle(strut_writer *writer, const strut_settle *settle) {
  strut_mapping mapping = STRUT_MAPPING_INLINE;
  strut_put(writer, "  settle: {");
  strut_put_fields(writer, &mapping, STRUT_SECTION_SETTLE, settle, &writer->usual.experiment.settle,
                   put_settling_step);
  strut_put(writer, "}\n");
}

static void put_initial(strut_writer *writer) {
  static const double rest[2] = {0.0, 0.0};
  const strut_scene *scene = writer->scene;
  bool begun = false, positions = false, velocities = false;
  if (scene->start_equilibrium >= 0) {
    strut_put(writer, "initial:\n  equilibrium: ");
    strut_put_name(writer,
                   leading_name(scene, scene->configurations[scene->start_equilibrium].name));
    strut_put(writer, "\n");
    begun = true;
  }
  for (size_t i = 0; i < scene->node_count && scene->start_equilibrium < 0; i++) {
    const strut_node *node = &scene->nodes[i];
    if (!same(node->start, node->position))
      put_initial_pair(writer, &begun, &positions, "  positions:\n", node->name, node->start);
  }
  for (size_t i = 0; i < scene->node_count; i++) {
    const strut_node *node = &scene->nodes[i];
    if (!same(node->velocity, rest))
      put_initial_pair(writer, &begun, &velocities, "  velocities:\n", node->name, node->velocity);
  }
  if (!writer->experiment->settle.wanted) return;
  if (!begun) strut_put(writer, "initial:\n");
  put_settle(writer, &writer->experiment->settle);
}

void strut_put_shapes(strut_writer *writer) {
  put_configurations(writer);
  put_search(writer);
  put_initial(writer);
}
