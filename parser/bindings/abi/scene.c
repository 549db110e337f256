/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scenes: a text that is read once, with settings; and what a scene holds, as names, values, arrays and a text. */
#include <math.h>
#include <string.h>

#include "engine/run/measure/summary.h"
#include "engine/scene/things.h"
#include "parser/bindings/abi/handles.h"
#include "parser/language/write/write_scene.h"

/* ---- names ---- */

/* The i-th of the channels that are recorded, or NULL. */
static const char *recorded_at(strut_channels recorded, size_t i) {
  const strut_channel_row *row;
  for (size_t k = 0; (row = strut_channel_at(k)) != NULL; k++)
    if ((recorded & row->id) && i-- == 0) return row->name;
  return NULL;
}

/* What names may be asked for: the things of a scene first. */
static const char *const kinds[] = {"parameters", "nodes",      "members",        "hinges",
                                    "cells",      "collisions", "actuators",      "loads",
                                    "sensors",    "states",     "configurations", "unbalances",
                                    "grounds",    "sliders",    "contacts",       "quantities",
                                    "channels",   "energies",   "kinds",          NULL};

/* The kind of things that "nodes", "members", ... name; STRUT_THING_COUNT: none, or things without names. */
static strut_thing thing_of(const char *kind) {
  int k = 0;
  if (strcmp(kind, "contacts") == 0 || strcmp(kind, "signals") == 0) return STRUT_THING_COUNT;
  while (k < STRUT_THING_COUNT && strcmp(strut_thing_at((strut_thing)k)->things, kind) != 0) k++;
  return (strut_thing)k;
}

static const char *name_at(const strut_setup *setup, const char *kind, size_t i) {
  const strut_scene *scene = &setup->scene;
  strut_thing thing = thing_of(kind);
  if (thing != STRUT_THING_COUNT) return strut_thing_name(scene, thing, i);
  if (strcmp(kind, "parameters") == 0)
    return i < scene->parameter_count ? scene->parameters[i].name : NULL;
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
  strut_thing thing = thing_of(kind);
  if (thing != STRUT_THING_COUNT) return strut_thing_count(&scene->setup.scene, thing);
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

/* Of the channel's row, NULL where there is none. */
#define CHANNEL(PART, INDEX, KNOWN, VALUE)                                                         \
  const char *strutlib_channel_##PART(const char *channel INDEX) {                                 \
    const strut_channel_row *row = channel ? strut_channel_named(channel) : NULL;                  \
    return row && (KNOWN) ? VALUE : NULL;                                                          \
  }
#define AT , size_t i
CHANNEL(kind, , true, strut_owner_row_of(row->owner)->things)
CHANNEL(unit, , true, row->unit)
CHANNEL(component, AT, i<row->components && row->components> 1 && !strut_channel_is_whole(row),
        row->component_names[i])
CHANNEL(column, AT, i < row->components, row->column_names[i])

/* ---- arrays ---- */

static bool fill_arrays(strutlib_scene *scene) {
  const strut_scene *s = &scene->setup.scene;
  const strut_member *members = s->members;
  size_t n = s->node_count, m = s->member_count;
  strut_rest r;
#define THINGS(NAME, UNIT, COUNT, PARTS, VALUE)                                                    \
  ABI_FILL(abi_new_array(&scene->arrays, NAME, UNIT, COUNT, PARTS), COUNT, PARTS, VALUE)
#define MEMBERS(NAME, UNIT, PARTS, VALUE) THINGS("members." NAME, UNIT, m, PARTS, VALUE)
#define REST(PART) (strut_member_rest(s, i, &r) ? r.PART : (double)NAN)
  THINGS("nodes.position", "m", n, 2, s->nodes[i].position[c]);
  THINGS("nodes.mass", "kg", n, 1, s->nodes[i].mass);
  MEMBERS("nodes", "1", 2, members[i].node[c]);
  MEMBERS("length", "m", 1, REST(drawn_length));
  MEMBERS("rest_length", "m", 1, REST(length));
  MEMBERS("stiffness", "N/m", 1, REST(stiffness));
  MEMBERS("damping", "N s/m", 1, members[i].damping);
  MEMBERS("mass", "kg", 1, members[i].mass);
  MEMBERS("pretension", "N", 1, REST(pretension));
  return true;
}

int strutlib_scene_array(const strutlib_scene *scene, const char *name, const double **data,
                         int *dimensions, size_t *shape, size_t *stride) {
  const abi_array *found = scene && name ? abi_find_array(&scene->arrays, name) : NULL;
  return abi_show_array(found, data, dimensions, shape, stride);
}

/* ---- texts ---- */

/* The scene as a run would use it, as a flat text; NULL with the error. */
static char *write_flat(const strutlib_scene *scene, strut_error *what, strutlib_error **error) {
  strut_setup setup;
  char *text = NULL;
  if (abi_setup(scene, STRUT_FOR_ANY, &setup, error) != STRUT_OK) return NULL;
  if (strut_resolve_start_equilibrium(&setup, what) == STRUT_OK) text = strut_setup_write(&setup);
  strut_setup_free(&setup);
  return text;
}

/* The same with parameters, groups and parts; flat where these cannot say it. */
static char *write_parts(const strutlib_scene *scene, strut_error *what) {
  const abi_source *source = scene->source;
  strut_diagnostics unused = {0};
  strut_scene_source *tree = NULL;
  char *flat = strut_setup_write(&scene->setup), *text = NULL;
  if (!flat) return NULL; /* the tree is changed: it cannot be that of the scene */
  strut_status status =
      strut_scene_source_open(source->name, source->text, source->length, &unused, &tree);
  if (status == STRUT_OK)
    status = strut_short_write(tree, scene->settings, scene->setting_count, flat, &scene->setup,
                               source->name, &text);
  what->status = status;
  strut_diagnostics_free(&unused);
  strut_scene_source_free(tree);
  if (status == STRUT_OK && !text) return flat;
  strut_release(flat);
  return text;
}

char *strutlib_scene_yaml(const strutlib_scene *scene, int parts, strutlib_error **error) {
  strut_error what = {0};
  if (abi_lacks(error, scene, "scene")) return NULL;
  abi_enter(error);
  char *text = parts ? write_parts(scene, &what) : write_flat(scene, &what, error);
  return abi_leave_text(error, text, &what);
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
    const strut_parameter *parameter = &s->parameters[i];
    good = abi_tree_set(tree, "parameters", parameter->name, parameter->value,
                        isfinite(parameter->value) ? NULL : parameter->text);
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

ABI_TREE_VALUES(scene)

char *strutlib_scene_json(const strutlib_scene *scene, strutlib_error **error) {
  if (abi_lacks(error, scene, "scene")) return NULL;
  abi_enter(error);
  const abi_tree *tree = tree_of(scene);
  return abi_leave_text(error, tree ? abi_tree_write(tree) : NULL, NULL);
}

/* ---- the text ---- */

static void release_source(abi_source *source) {
  if (!source || atomic_fetch_sub(&source->users, 1) > 1) return;
  strut_scene_source_free(source->tree);
  strut_release(source->name);
  strut_release(source->text);
  strut_release(source);
}

static char *copy_of(const char *text, size_t length) {
  char *copy = strut_allocate(length + 1, 1);
  if (copy) memcpy(copy, text, length);
  return copy;
}

/* Takes ownership of the text, a block of strut_allocate that may be NULL. NULL: memory is out, or *error says why. */
static abi_source *read_source(const char *name, char *text, size_t length,
                               strutlib_error **error) {
  abi_source *source = strut_allocate(1, sizeof *source);
  strut_diagnostics found = {0};
  if (!source || !text) {
    strut_release(source);
    strut_release(text);
    return NULL;
  }
  *source = (abi_source){.text = text, .length = length, .name = copy_of(name, strlen(name))};
  atomic_init(&source->users, 1);
  strut_status status = STRUT_NO_MEMORY;
  if (source->name)
    status = strut_scene_source_open(source->name, text, length, &found, &source->tree);
  if (abi_settle(error, status, &found) == STRUT_OK) return source;
  release_source(source);
  return NULL;
}

/* ---- the scene ---- */

strut_status abi_setup(const strutlib_scene *scene, strut_purpose purpose, strut_setup *setup,
                       strutlib_error **error) {
  strut_diagnostics found = {0};
  strut_status status = strut_scene_source_read(scene->source->tree, scene->settings,
                                                scene->setting_count, purpose, &found, setup);
  return abi_settle(error, status, &found);
}

static bool add_setting(strutlib_scene *scene, const char *name, const char *value) {
  size_t at = 0; /* a later setting replaces an earlier one */
  while (at < scene->setting_count && strcmp(scene->settings[at].name, name) != 0) at++;
  name = strut_arena_text(&scene->arrays.arena, name, strlen(name));
  value = strut_arena_text(&scene->arrays.arena, value, strlen(value));
  scene->settings[at] = (strut_setting){.name = name, .text = value};
  if (at == scene->setting_count) scene->setting_count++;
  return name && value;
}

static bool add_settings(strutlib_scene *scene, const strutlib_scene *before,
                         const abi_pairs *settings) {
  size_t most = settings->count + (before ? before->setting_count : 0);
  scene->settings = strut_arena_allocate(&scene->arrays.arena, most, sizeof *scene->settings);
  bool good = scene->settings;
  for (size_t i = 0; good && before && i < before->setting_count; i++)
    good = add_setting(scene, before->settings[i].name, before->settings[i].text);
  for (size_t i = 0; good && i < settings->count; i++)
    good = add_setting(scene, settings->names[i], settings->values[i]);
  return good;
}

static strut_status add_warnings(strutlib_scene *scene) {
  strut_findings warnings = {0};
  strut_status status = strut_setup_warn(&scene->setup, &warnings);
  for (size_t i = 0; i < warnings.count; i++)
    abi_add_warning(&scene->messages, warnings.items[i].message);
  strut_findings_free(&warnings);
  return status == STRUT_OK && scene->messages.out_of_memory ? STRUT_NO_MEMORY : status;
}

static strut_status read_scene(strutlib_scene *scene, strutlib_error **error) {
  strut_diagnostics found = {0};
  strut_status status =
      strut_scene_source_read(scene->source->tree, scene->settings, scene->setting_count,
                              STRUT_FOR_ANY, &found, &scene->setup);
  abi_add_notes(&scene->messages, &found);
  if (abi_settle(error, status, &found) != STRUT_OK) return status;
  status = add_warnings(scene);
  return status == STRUT_OK && !fill_arrays(scene) ? STRUT_NO_MEMORY : status;
}

/* The end of a call that opens a scene of a source, which it takes over, or which is NULL after a failure. */
static strutlib_scene *make_scene(abi_source *source, const strutlib_scene *before,
                                  const abi_pairs *settings, const strut_error *what,
                                  strutlib_error **error) {
  strut_status status = what && what->status ? what->status : STRUT_NO_MEMORY;
  strutlib_scene *scene = source ? strut_allocate(1, sizeof *scene) : NULL;
  if (scene && pthread_mutex_init(&scene->lock, NULL) == 0) {
    scene->source = source;
    if (add_settings(scene, before, settings)) status = read_scene(scene, error);
    if (status != STRUT_OK) strutlib_close(scene);
  } else {
    strut_release(scene);
    release_source(source);
  }
  abi_leave(error, status, what);
  return status == STRUT_OK ? scene : NULL;
}

strutlib_scene *strutlib_open(const char *path, size_t count, const char *const *names,
                              const char *const *values, strutlib_error **error) {
  const abi_pairs settings = {count, names, values};
  char *text = NULL;
  size_t length = 0;
  strut_error what = {0};
  if (abi_lacks(error, path, "path") || abi_lacks_pairs(error, count, names, values)) return NULL;
  abi_enter(error);
  if (strcmp(path, "-") == 0)
    strut_fail(&what, STRUT_FILE_TROUBLE, "'-' is no file: use strutlib_open_text");
  else
    strut_file_read(path, &text, &length, &what);
  abi_source *source = text ? read_source(path, text, length, error) : NULL;
  return make_scene(source, NULL, &settings, &what, error);
}

strutlib_scene *strutlib_open_text(const char *name, const char *text, size_t length, size_t count,
                                   const char *const *names, const char *const *values,
                                   strutlib_error **error) {
  const abi_pairs settings = {count, names, values};
  abi_source *source = NULL;
  strut_error what = {0};
  if (abi_lacks(error, name, "name") || abi_lacks(error, text, "text") ||
      abi_lacks_pairs(error, count, names, values))
    return NULL;
  abi_enter(error);
  if (length <= STRUT_TEXT_MOST)
    source = read_source(name, copy_of(text, length), length, error);
  else
    strut_fail(&what, STRUT_BAD_SCENE, "'%s' has more than %zu MiB", name, STRUT_TEXT_MOST >> 20);
  return make_scene(source, NULL, &settings, &what, error);
}

strutlib_scene *strutlib_scene_with(const strutlib_scene *scene, size_t count,
                                    const char *const *names, const char *const *values,
                                    strutlib_error **error) {
  if (abi_lacks(error, scene, "scene") || abi_lacks_pairs(error, count, names, values)) return NULL;
  abi_enter(error);
  atomic_fetch_add(&scene->source->users, 1);
  return make_scene(scene->source, scene, &(abi_pairs){count, names, values}, NULL, error);
}

void strutlib_close(strutlib_scene *scene) {
  if (!scene) return;
  strut_setup_free(&scene->setup);
  abi_tree_free(scene->tree);
  abi_messages_free(&scene->messages);
  release_source(scene->source);
  pthread_mutex_destroy(&scene->lock);
  abi_arrays_free(&scene->arrays);
  strut_release(scene);
}

const char *strutlib_scene_warning(const strutlib_scene *scene, size_t i) {
  return scene && i < scene->messages.count ? scene->messages.warnings[i] : NULL;
}
