/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a scene holds: names, values by dotted name, arrays of the drawn structure, and all of it as a text. */
#include <math.h>
#include <string.h>

#include "engine/run/measure/summary.h"
#include "engine/statics/equilibria/rest_state.h"
#include "parser/abi/handles.h"
#include "parser/write/write_scene.h"
#include "parser/write/write_short.h"

/* ---- names ---- */

/* The i-th of the channels that are recorded, or NULL. */
static const char *recorded_at(unsigned recorded, size_t i) {
  const strut_channel_row *row;
  for (size_t k = 0; (row = strut_channel_at(k)) != NULL; k++)
    if ((recorded & (unsigned)row->id) && i-- == 0) return row->name;
  return NULL;
}

#define NAMES_OF_SCENE(X)                                                                          \
  X(parameters, parameter_count)                                                                   \
  X(nodes, node_count)                                                                             \
  X(members, member_count)                                                                         \
  X(hinges, hinge_count)                                                                           \
  X(cells, cell_count)                                                                             \
  X(collisions, collision_count)                                                                   \
  X(actuators, actuator_count)                                                                     \
  X(loads, load_count)                                                                             \
  X(sensors, sensor_count)                                                                         \
  X(states, state_count)                                                                           \
  X(configurations, configuration_count)                                                           \
  X(unbalances, unbalance_count)                                                                   \
  X(grounds, ground_count)

static const char *const kinds[] = {
#define KIND(things, count) #things,
    NAMES_OF_SCENE(KIND)
#undef KIND
        "sliders",
    "contacts",
    "quantities",
    "channels",
    "energies",
    "kinds",
    NULL};

static const char *name_at(const strut_setup *setup, const char *kind, size_t i) {
  const strut_scene *scene = &setup->scene;
#define NAME(things, count)                                                                        \
  if (strcmp(kind, #things) == 0) return i < scene->count ? scene->things[i].name : NULL;
  NAMES_OF_SCENE(NAME)
#undef NAME
  if (strcmp(kind, "sliders") == 0)
    return i < scene->sliding_count ? scene->sliding_masses[i].name : NULL;
  if (strcmp(kind, "contacts") == 0)
    return i < scene->contact_count ? strut_contact_name(scene, i) : NULL;
  if (strcmp(kind, "quantities") == 0)
    return i < setup->experiment.quantity_count ? setup->experiment.quantities[i].name : NULL;
  if (strcmp(kind, "channels") == 0) return recorded_at(setup->experiment.channels, i);
  if (strcmp(kind, "kinds") == 0) return i < sizeof kinds / sizeof kinds[0] ? kinds[i] : NULL;
  const strut_channel_row *row = strut_channel_named(strcmp(kind, "energies") ? kind : "energy");
  return row && i < strut_channel_things(row, scene) ? strut_channel_thing(row, scene, i) : NULL;
}

const char *strutlib_name(const strutlib_scene *scene, const char *kind, size_t i) {
  if (!scene || !kind) return NULL;
  return name_at(&scene->setup, kind, i);
}

size_t strutlib_name_count(const strutlib_scene *scene, const char *kind) {
  if (!scene || !kind) return 0;
  const strut_scene *s = &scene->setup.scene;
#define COUNT(things, count)                                                                       \
  if (strcmp(kind, #things) == 0) return s->count;
  NAMES_OF_SCENE(COUNT)
#undef COUNT
  size_t count = 0;
  while (name_at(&scene->setup, kind, count)) count++;
  return count;
}

long strutlib_index(const strutlib_scene *scene, const char *kind, const char *name) {
  const char *there;
  for (size_t i = 0; scene && kind && name && (there = name_at(&scene->setup, kind, i)); i++)
    if (strcmp(there, name) == 0) return (long)i;
  return -1;
}

/* ---- channels ---- */

const char *strutlib_channel(size_t i) {
  const strut_channel_row *row = strut_channel_at(i);
  return row ? row->name : NULL;
}

const char *strutlib_channel_kind(const char *channel) {
  const strut_channel_row *row = channel ? strut_channel_named(channel) : NULL;
  return row ? strut_owner_row_of(row->owner)->things : NULL;
}

const char *strutlib_channel_component(const char *channel, size_t i) {
  const strut_channel_row *row = channel ? strut_channel_named(channel) : NULL;
  bool several = row && row->owner != STRUT_OWNER_SYSTEM && row->components > 1;
  return several && i < row->components ? row->component_names[i] : NULL;
}

const char *strutlib_channel_column(const char *channel, size_t i) {
  const strut_channel_row *row = channel ? strut_channel_named(channel) : NULL;
  return row && i < row->components ? row->column_names[i] : NULL;
}

/* ---- arrays ---- */

static bool add(strutlib_scene *scene, size_t *at, const char *name, const char *unit, size_t count,
                size_t components, double **data) {
  abi_array *a = &scene->arrays[(*at)++];
  *data = strut_arena_allocate(&scene->arena, count * components, sizeof **data);
  *a = (abi_array){.name = name, .unit = unit, .data = *data};
  a->dimensions = components > 1 ? 2 : 1;
  a->shape[0] = count;
  a->shape[1] = components;
  a->stride[0] = components;
  a->stride[1] = 1;
  return *data != NULL;
}

bool abi_scene_fill_arrays(strutlib_scene *scene);
bool abi_scene_fill_arrays(strutlib_scene *scene) {
  const strut_scene *s = &scene->setup.scene;
  size_t n = s->node_count, m = s->member_count, at = 0;
  double *position, *mass, *ends, *length, *rest, *stiffness, *damping, *weight, *tension;
  bool good = add(scene, &at, "nodes.position", "m", n, 2, &position) &&
              add(scene, &at, "nodes.mass", "kg", n, 1, &mass) &&
              add(scene, &at, "members.nodes", "1", m, 2, &ends) &&
              add(scene, &at, "members.length", "m", m, 1, &length) &&
              add(scene, &at, "members.rest_length", "m", m, 1, &rest) &&
              add(scene, &at, "members.stiffness", "N/m", m, 1, &stiffness) &&
              add(scene, &at, "members.damping", "N s/m", m, 1, &damping) &&
              add(scene, &at, "members.mass", "kg", m, 1, &weight) &&
              add(scene, &at, "members.pretension", "N", m, 1, &tension);
  if (!good) return false;
  for (size_t i = 0; i < n; i++) {
    memcpy(position + 2 * i, s->nodes[i].position, sizeof s->nodes[i].position);
    mass[i] = s->nodes[i].mass;
  }
  for (size_t i = 0; i < m; i++) {
    strut_rest r;
    bool known = strut_member_rest(s, i, &r);
    ends[2 * i] = s->members[i].node[0];
    ends[2 * i + 1] = s->members[i].node[1];
    length[i] = known ? r.drawn_length : (double)NAN;
    rest[i] = known ? r.length : (double)NAN;
    stiffness[i] = known ? r.stiffness : (double)NAN;
    tension[i] = known ? r.pretension : (double)NAN;
    damping[i] = s->members[i].damping;
    weight[i] = s->members[i].mass;
  }
  return true;
}

int abi_show_array(const abi_array *array, const double **data, int *dimensions, size_t *shape,
                   size_t *stride) {
  if (!data || !dimensions || !shape || !stride) return 0;
  *data = array->data;
  *dimensions = array->dimensions;
  for (int d = 0; d < array->dimensions; d++) {
    shape[d] = array->shape[d];
    stride[d] = array->stride[d];
  }
  return 1;
}

int strutlib_scene_array(const strutlib_scene *scene, const char *name, const double **data,
                         int *dimensions, size_t *shape, size_t *stride) {
  for (size_t i = 0; i < ABI_SCENE_ARRAYS && scene && name; i++)
    if (strcmp(scene->arrays[i].name, name) == 0)
      return abi_show_array(&scene->arrays[i], data, dimensions, shape, stride);
  return 0;
}

/* ---- texts ---- */

/* The scene as a run would use it, as a flat text; NULL with the error. */
static char *write_flat(const strutlib_scene *scene, strutlib_error **error) {
  strut_setup setup;
  strut_error what = {0};
  char *text = NULL;
  if (abi_setup(scene, STRUT_FOR_ANY, &setup, error) != STRUT_OK) return NULL;
  strut_status status = strut_resolve_start_equilibrium(&setup, &what);
  if (status == STRUT_OK)
    text = abi_give(strut_setup_write(&setup), error);
  else
    abi_fail_with(error, status, &what);
  strut_setup_free(&setup);
  return text;
}

/* The same with parameters, groups and parts; flat where these cannot say it. */
static char *write_parts(const strutlib_scene *scene, strutlib_error **error) {
  const abi_source *source = scene->source;
  strut_diagnostics unused = {0};
  strut_scene_source *tree = NULL;
  char *flat = strut_setup_write(&scene->setup), *text = NULL;
  strut_status status = flat ? STRUT_OK : STRUT_NO_MEMORY;
  if (status == STRUT_OK) /* the tree is changed: it cannot be that of the scene */
    status = strut_scene_source_open(source->name, source->text, source->length, &unused, &tree);
  if (status == STRUT_OK)
    status =
        strut_short_write(tree, scene->overrides, scene->setting_count, flat, &scene->setup, &text);
  if (status != STRUT_OK) abi_fail_with(error, status, NULL);
  strut_diagnostics_free(&unused);
  strut_scene_source_free(tree);
  if (status == STRUT_OK && !text) return flat;
  strut_release(flat);
  return text;
}

char *strutlib_scene_yaml(const strutlib_scene *scene, int parts, strutlib_error **error) {
  if (abi_lacks(error, scene, "scene")) return NULL;
  abi_enter(error);
  char *text = parts ? write_parts(scene, error) : write_flat(scene, error);
  abi_leave();
  return text;
}

/* ---- values ---- */

/* The tree of the scene as it stands, a start equilibrium unresolved; NULL: memory is out. */
static abi_tree *make_tree(const strutlib_scene *scene) {
  strut_diagnostics unused = {0};
  strut_document document = {.root = NULL};
  char *text = strut_setup_write(&scene->setup);
  abi_tree *tree = NULL;
  if (text) {
    strut_diagnostics_source(&unused, scene->source->name, text, strlen(text));
    if (strut_document_read(&document, &unused) == STRUT_OK) tree = abi_tree_of(document.root);
  }
  const strut_scene *s = &scene->setup.scene;
  bool good = tree != NULL;
  for (size_t i = 0; good && i < s->parameter_count; i++) {
    const strut_parameter *p = &s->parameters[i];
    good = abi_tree_set(tree, "parameters", p->name, p->value, isfinite(p->value) ? NULL : p->text);
  }
  strut_document_free(&document);
  strut_diagnostics_free(&unused);
  strut_release(text);
  if (good) return tree;
  abi_tree_free(tree);
  return NULL;
}

static const abi_tree *tree_of(const strutlib_scene *constant) {
  if (!constant) return NULL;
  strutlib_scene *scene = (strutlib_scene *)(uintptr_t)constant; /* the lock guards what changes */
  pthread_mutex_lock(&scene->lock);
  if (!scene->tree) scene->tree = make_tree(scene);
  pthread_mutex_unlock(&scene->lock);
  return scene->tree;
}

int strutlib_scene_number(const strutlib_scene *scene, const char *name, double *value) {
  const abi_tree *tree = tree_of(scene);
  return tree && abi_tree_number(tree, name, value) ? 1 : 0;
}

int strutlib_scene_flag(const strutlib_scene *scene, const char *name, int *value) {
  const abi_tree *tree = tree_of(scene);
  return tree && abi_tree_flag(tree, name, value) ? 1 : 0;
}

const char *strutlib_scene_text(const strutlib_scene *scene, const char *name) {
  const abi_tree *tree = tree_of(scene);
  return tree ? abi_tree_text(tree, name) : NULL;
}

char *strutlib_scene_json(const strutlib_scene *scene, strutlib_error **error) {
  if (abi_lacks(error, scene, "scene")) return NULL;
  abi_enter(error);
  const abi_tree *tree = tree_of(scene);
  char *text = abi_give(tree ? abi_tree_write(tree) : NULL, error);
  abi_leave();
  return text;
}
