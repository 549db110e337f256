/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/language/scenes.h"

#include <dirent.h>

#include "parser/language/write/write_scene.h"
#include "tests/language/cases.h"
#include "tests/support/test.h"

enum { MOST_BYTES = 1 << 20 };

typedef struct collection {
  scene_file *files;
  size_t count;
} collection;

/* Takes the text, unless it is a study. */
static void add_text(collection *all, const char *path, char *text, size_t length) {
  if (strstr(text, "\nstudy:")) {
    free(text);
    return;
  }
  all->files = realloc(all->files, (all->count + 1) * sizeof *all->files);
  scene_file *added = &all->files[all->count++];
  *added = (scene_file){.text = text, .length = length};
  snprintf(added->path, sizeof added->path, "%s", path);
}

static void add_file(collection *all, const char *path) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  char *text = calloc(1, MOST_BYTES);
  size_t length = fread(text, 1, MOST_BYTES - 1, file);
  fclose(file);
  add_text(all, path, text, length);
}

static void walk(collection *all, const char *folder) {
  DIR *directory = opendir(folder);
  if (!directory) return;
  for (struct dirent *entry = readdir(directory); entry; entry = readdir(directory)) {
    char path[600];
    size_t length = strlen(entry->d_name);
    if (entry->d_name[0] == '.') continue;
    snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
    if (length > 5 && strcmp(entry->d_name + length - 5, ".yaml") == 0)
      add_file(all, path);
    else if (!strchr(entry->d_name, '.'))
      walk(all, path);
  }
  closedir(directory);
}

static int by_path(const void *a, const void *b) {
  return strcmp(((const scene_file *)a)->path, ((const scene_file *)b)->path);
}

static size_t sorted_files(collection *all, scene_file **files) {
  assert_true(all->count > 0);
  qsort(all->files, all->count, sizeof *all->files, by_path);
  *files = all->files;
  return all->count;
}

size_t scene_files(scene_file **files) {
  collection all = {NULL, 0};
  walk(&all, STRUT_TESTS_DIR "/language/good");
  assert_true(all.count > 0);
  walk(&all, STRUT_SOURCE_DIR "/models");
  return sorted_files(&all, files);
}

size_t refused_files(scene_file **files) {
  collection all = {NULL, 0};
  faulty_cases cases = read_faulty_cases(STRUT_TESTS_DIR "/language/bad");
  for (size_t i = 0; i < cases.count; i++) {
    char path[600];
    const faulty_case *c = &cases.items[i];
    if (c->is_base) continue;
    snprintf(path, sizeof path, STRUT_TESTS_DIR "/language/bad/%s.yaml", c->name);
    char *text = calloc(1, MOST_BYTES);
    assert_true(c->length < MOST_BYTES);
    memcpy(text, c->text, c->length);
    add_text(&all, path, text, c->length);
  }
  free_faulty_cases(&cases);
  return sorted_files(&all, files);
}

void free_scene_files(scene_file *files, size_t count) {
  for (size_t i = 0; i < count; i++) free(files[i].text);
  free(files);
}

strut_status read_quietly_as(const char *path, const char *text, size_t length,
                             strut_setup *setup) {
  OWN(strut_diagnostics) diagnostics = {0};
  strut_status status =
      strut_setup_read(setup, path, text, length, NULL, 0, STRUT_FOR_ANY, &diagnostics);
  return status;
}

strut_status read_quietly(const char *text, size_t length, strut_setup *setup) {
  return read_quietly_as("scene", text, length, setup);
}

char *read_and_write(const char *path, const char *text, size_t length) {
  strut_setup setup;
  if (read_quietly_as(path, text, length, &setup) != STRUT_OK) return NULL;
  char *written = strut_setup_write(&setup);
  assert_non_null(written);
  strut_setup_free(&setup);
  return written;
}
