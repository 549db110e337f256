/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scenes: a text that is read once, with settings. */
#include <string.h>

#include "parser/abi/handles.h"
#include "parser/yaml/memory_estimate.h"

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

static strut_status fail_of_memory(const abi_source *source, strutlib_error **error) {
  strut_error what = {0};
  strut_memory_fail_document(source->name, source->text, source->length, &what);
  abi_fail_with(error, STRUT_NO_MEMORY, &what);
  return STRUT_NO_MEMORY;
}

/* Takes ownership of the text, a block of strut_allocate that may be NULL. */
static abi_source *read_source(const char *name, char *text, size_t length,
                               strutlib_error **error) {
  abi_source *source = strut_allocate(1, sizeof *source);
  strut_diagnostics found = {0};
  strut_error what = {0};
  if (!source || !text) {
    strut_release(source);
    strut_release(text);
    abi_no_memory(error);
    return NULL;
  }
  *source = (abi_source){.text = text, .length = length, .name = copy_of(name, strlen(name))};
  atomic_init(&source->users, 1);
  strut_status status = STRUT_NO_MEMORY;
  if (source->name) status = strut_memory_check_document(name, text, length, &what);
  if (status != STRUT_OK)
    abi_fail_with(error, status, &what);
  else if ((status = strut_scene_source_open(source->name, text, length, &found, &source->tree)) ==
           STRUT_NO_MEMORY)
    fail_of_memory(source, error);
  else if (status != STRUT_OK)
    abi_fail_located(error, status, &found);
  strut_diagnostics_free(&found);
  if (status == STRUT_OK) return source;
  release_source(source);
  return NULL;
}

/* ---- the scene ---- */

strut_status abi_setup(const strutlib_scene *scene, strut_purpose purpose, strut_setup *setup,
                       strutlib_error **error) {
  strut_diagnostics found = {0};
  strut_status status = strut_scene_source_read(scene->source->tree, scene->settings,
                                                scene->setting_count, purpose, &found, setup);
  if (status == STRUT_NO_MEMORY)
    fail_of_memory(scene->source, error);
  else if (status != STRUT_OK)
    abi_fail_located(error, status, &found);
  strut_diagnostics_free(&found);
  return status;
}

static bool add_setting(strutlib_scene *scene, const char *name, const char *value) {
  size_t at = 0; /* a later setting replaces an earlier one */
  while (at < scene->setting_count && strcmp(scene->overrides[at].name, name) != 0) at++;
  name = strut_arena_text(&scene->arena, name, strlen(name));
  value = strut_arena_text(&scene->arena, value, strlen(value));
  scene->overrides[at] = (strut_override){name, value};
  scene->settings[at] = (strut_setting){.name = name, .text = value};
  if (at == scene->setting_count) scene->setting_count++;
  return name && value;
}

static bool add_settings(strutlib_scene *scene, const strutlib_scene *before, size_t count,
                         const char *const *names, const char *const *values) {
  size_t most = count + (before ? before->setting_count : 0);
  scene->overrides = strut_arena_allocate(&scene->arena, most, sizeof *scene->overrides);
  scene->settings = strut_arena_allocate(&scene->arena, most, sizeof *scene->settings);
  bool good = scene->overrides && scene->settings;
  for (size_t i = 0; good && before && i < before->setting_count; i++)
    good = add_setting(scene, before->overrides[i].name, before->overrides[i].value);
  for (size_t i = 0; good && i < count; i++) good = add_setting(scene, names[i], values[i]);
  return good;
}

static strut_status add_warnings(strutlib_scene *scene, strut_diagnostics *found) {
  strut_findings warnings = {0};
  strut_status status = strut_setup_warn(&scene->setup, &warnings);
  for (size_t i = 0; i < found->note_count; i++)
    abi_add_warning(&scene->messages, found->notes[i].message);
  for (size_t i = 0; i < warnings.count; i++)
    abi_add_warning(&scene->messages, warnings.items[i].message);
  strut_findings_free(&warnings);
  return status == STRUT_OK && scene->messages.out_of_memory ? STRUT_NO_MEMORY : status;
}

bool abi_scene_fill_arrays(strutlib_scene *scene); /* scene_values.c */

static strut_status read_scene(strutlib_scene *scene, strutlib_error **error) {
  strut_diagnostics found = {0};
  strut_status status =
      strut_scene_source_read(scene->source->tree, scene->settings, scene->setting_count,
                              STRUT_FOR_ANY, &found, &scene->setup);
  if (status == STRUT_NO_MEMORY) fail_of_memory(scene->source, error);
  if (status == STRUT_BAD_SCENE) abi_fail_located(error, status, &found);
  if (status == STRUT_OK) {
    status = add_warnings(scene, &found);
    if (status == STRUT_OK && !abi_scene_fill_arrays(scene)) status = STRUT_NO_MEMORY;
    if (status != STRUT_OK) abi_no_memory(error);
  }
  strut_diagnostics_free(&found);
  return status;
}

/* Takes over the source, which may be NULL after an error. */
static strutlib_scene *make_scene(abi_source *source, const strutlib_scene *before, size_t count,
                                  const char *const *names, const char *const *values,
                                  strutlib_error **error) {
  if (!source) return NULL;
  strutlib_scene *scene = strut_allocate(1, sizeof *scene);
  if (!scene || pthread_mutex_init(&scene->lock, NULL) != 0) {
    strut_release(scene);
    release_source(source);
    abi_no_memory(error);
    return NULL;
  }
  scene->source = source;
  strut_status status = STRUT_NO_MEMORY;
  if (add_settings(scene, before, count, names, values))
    status = read_scene(scene, error);
  else
    abi_no_memory(error);
  if (status == STRUT_OK) return scene;
  strutlib_close(scene);
  return NULL;
}

strutlib_scene *strutlib_open(const char *path, size_t count, const char *const *names,
                              const char *const *values, strutlib_error **error) {
  char *text = NULL;
  size_t length = 0;
  strut_error what = {0};
  strutlib_scene *scene = NULL;
  if (abi_lacks(error, path, "path") || abi_lacks_pairs(error, count, names, values)) return NULL;
  abi_enter(error);
  strut_status status =
      strcmp(path, "-") == 0
          ? strut_fail(&what, STRUT_FILE_TROUBLE, "'-' is no file: use strutlib_open_text")
          : strut_file_read(path, &text, &length, &what);
  if (status == STRUT_OK)
    scene = make_scene(read_source(path, text, length, error), NULL, count, names, values, error);
  else
    abi_fail_with(error, status, &what);
  abi_leave();
  return scene;
}

strutlib_scene *strutlib_open_text(const char *name, const char *text, size_t length, size_t count,
                                   const char *const *names, const char *const *values,
                                   strutlib_error **error) {
  strutlib_scene *scene = NULL;
  if (abi_lacks(error, name, "name") || abi_lacks(error, text, "text") ||
      abi_lacks_pairs(error, count, names, values))
    return NULL;
  abi_enter(error);
  if (length <= STRUT_TEXT_MOST)
    scene = make_scene(read_source(name, copy_of(text, length), length, error), NULL, count, names,
                       values, error);
  else
    abi_fail(error, STRUTLIB_BAD_SCENE, "'%s' has more than %zu MiB", name, STRUT_TEXT_MOST >> 20);
  abi_leave();
  return scene;
}

strutlib_scene *strutlib_scene_with(const strutlib_scene *scene, size_t count,
                                    const char *const *names, const char *const *values,
                                    strutlib_error **error) {
  if (abi_lacks(error, scene, "scene") || abi_lacks_pairs(error, count, names, values)) return NULL;
  abi_enter(error);
  atomic_fetch_add(&scene->source->users, 1);
  strutlib_scene *other = make_scene(scene->source, scene, count, names, values, error);
  abi_leave();
  return other;
}

void strutlib_close(strutlib_scene *scene) {
  if (!scene) return;
  strut_setup_free(&scene->setup);
  abi_tree_free(scene->tree);
  abi_messages_free(&scene->messages);
  release_source(scene->source);
  pthread_mutex_destroy(&scene->lock);
  strut_arena_free(&scene->arena);
  strut_release(scene);
}

const char *strutlib_scene_warning(const strutlib_scene *scene, size_t i) {
  return scene && i < scene->messages.count ? scene->messages.warnings[i] : NULL;
}
