/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `strut examples`, and `strut examples --new`: models that come with strut. */
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "parser/program/commands.h"
#include "parser/program/complete.h"
#include "parser/program/installed.h"
#include "parser/program/streams.h"
#include "parser/write/writer.h"
#include "parser/yaml/diagnostics.h"
#include "parser/yaml/document.h"

enum { MOST = 1000, WIDTH = 36 };

/* The installed models, as FOLDER/NAME.yaml, in order. Zero-initialise. */
typedef struct models {
  char root[STRUT_LONGEST_PATH];
  strut_arena arena;
  const char *path[MOST + 1]; /* NULL after the last */
  const char *bare[MOST + 1]; /* without folder and ending */
  size_t count;
  bool failed;
} models;

static int by_name(const void *a, const void *b) {
  return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static void add_folder(models *m, const char *folder) {
  char path[2 * STRUT_LONGEST_PATH];
  snprintf(path, sizeof path, "%s/%s", m->root, folder);
  DIR *open = opendir(path);
  for (struct dirent *entry; open && (entry = readdir(open)) && m->count < MOST;) {
    const char *end = strrchr(entry->d_name, '.');
    if (!end || strcmp(end, ".yaml") != 0) continue;
    const char *name = strut_arena_format(&m->arena, "%s/%s", folder, entry->d_name);
    if (name) m->path[m->count++] = name;
    if (!name) m->failed = true;
  }
  if (open) closedir(open);
}

static strut_status find_models(models *m) {
  strut_error error = {0};
  if (!strut_find_installed("models", "models", m->root))
    return strut_print_failure(
        strut_fail(&error, STRUT_FILE_TROUBLE, "the models are not installed with this program"),
        &error);
  DIR *open = opendir(m->root);
  for (struct dirent *entry; open && (entry = readdir(open));)
    if (entry->d_name[0] != '.') add_folder(m, entry->d_name);
  if (open) closedir(open);
  qsort(m->path, m->count, sizeof *m->path, by_name);
  for (size_t i = 0; i < m->count && !m->failed; i++) {
    const char *base = strchr(m->path[i], '/') + 1;
    m->bare[i] = strut_arena_text(&m->arena, base, strlen(base) - strlen(".yaml"));
    m->failed = !m->bare[i];
  }
  return m->failed ? strut_print_out_of_memory() : STRUT_OK;
}

/* ---- a model's text ---- */

typedef struct source {
  char *text;
  size_t length;
  strut_document document;
  strut_diagnostics unused;
} source;

static strut_status open_source(const models *m, const char *path, source *s, strut_error *error) {
  char whole[2 * STRUT_LONGEST_PATH];
  *s = (source){.text = NULL};
  snprintf(whole, sizeof whole, "%s/%s", m->root, path);
  strut_status status = strut_file_read(whole, &s->text, &s->length, error);
  if (status != STRUT_OK) return status;
  strut_diagnostics_source(&s->unused, path, s->text, s->length);
  strut_document_read(&s->document, &s->unused);
  return STRUT_OK;
}

static void close_source(source *s) {
  strut_document_free(&s->document);
  strut_diagnostics_free(&s->unused);
  strut_release(s->text);
}

/* The text of a key at the top, or "". */
static const char *text_of(const source *s, const char *key) {
  const strut_tree *root = s->document.root;
  const strut_tree *value =
      root && root->kind == STRUT_TREE_MAP ? strut_tree_find(root, key, NULL) : NULL;
  return value && value->kind == STRUT_TREE_SCALAR ? value->text : "";
}

static strut_status list_models(const models *m) {
  strut_error error = {0};
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < m->count && status == STRUT_OK; i++) {
    source s;
    status = open_source(m, m->path[i], &s, &error);
    const char *study = text_of(&s, "study");
    printf("%-*s %s%s\n", WIDTH, m->path[i], *study ? "study: " : "",
           *study ? study : text_of(&s, "name"));
    close_source(&s);
  }
  return strut_print_failure(status, &error);
}

/* ---- copies ---- */

/* What is to be copied: indices of models. */
typedef struct selection {
  bool wanted[MOST];
} selection;

/* With a file those that it names: the model of a study, the base of a scene. */
static strut_status want(const models *m, selection *s, size_t i, strut_error *error) {
  static const char *const keys[] = {"model", "base"};
  source file;
  if (s->wanted[i]) return STRUT_OK;
  s->wanted[i] = true;
  strut_status status = open_source(m, m->path[i], &file, error);
  for (size_t k = 0; k < sizeof keys / sizeof keys[0] && status == STRUT_OK; k++) {
    char path[2 * STRUT_LONGEST_PATH];
    int folder = (int)(strchr(m->path[i], '/') + 1 - m->path[i]);
    snprintf(path, sizeof path, "%.*s%s", folder, m->path[i], text_of(&file, keys[k]));
    for (size_t j = 0; j < m->count && status == STRUT_OK; j++)
      if (strcmp(m->path[j], path) == 0) status = want(m, s, j, error);
  }
  close_source(&file);
  return status;
}

/* Is `name` the model, or its last part, with or without ending? */
static bool names_model(const models *m, const char *name, size_t i) {
  const char *path = m->path[i], *base = strchr(path, '/') + 1, *bare = m->bare[i];
  size_t length = strlen(name), whole = strlen(path) - strlen(".yaml");
  return strcmp(name, path) == 0 || strcmp(name, base) == 0 || strcmp(name, bare) == 0 ||
         (length == whole && strncmp(name, path, whole) == 0);
}

/* Is it the model's folder? */
static bool names_folder(const models *m, const char *name, size_t i) {
  size_t length = strlen(name), folder = (size_t)(strchr(m->path[i], '/') - m->path[i]);
  while (length > 1 && name[length - 1] == '/') length--;
  return length == folder && strncmp(name, m->path[i], folder) == 0;
}

static const char *path_at(const void *context, size_t i) {
  return ((const models *)context)->path[i];
}
static const char *bare_at(const void *context, size_t i) {
  return ((const models *)context)->bare[i];
}

typedef bool naming(const models *m, const char *name, size_t i);

/* How many models `name` names so; all of them are wanted. */
static strut_status want_named(const models *m, selection *s, const char *name, naming *is_named,
                               size_t *found, strut_error *error) {
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < m->count && status == STRUT_OK; i++) {
    if (!is_named(m, name, i)) continue;
    ++*found;
    status = want(m, s, i, error);
  }
  return status;
}

static strut_status select_models(const models *m, const strut_arguments *arguments, selection *s,
                                  strut_error *error) {
  for (size_t k = 0; k < arguments->model_count; k++) {
    const char *name = arguments->models[k];
    size_t found = 0;
    strut_status status = want_named(m, s, name, names_model, &found, error);
    if (status == STRUT_OK && !found) status = want_named(m, s, name, names_folder, &found, error);
    if (status != STRUT_OK) return status;
    if (found) continue;
    const char *near = strut_did_you_mean(name, bare_at, m);
    if (!near) near = strut_did_you_mean(name, path_at, m);
    return strut_fail(error, STRUT_USAGE,
                      "there is no example '%s'%s%s%s; 'strut examples' lists all", name,
                      near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
  }
  return STRUT_OK;
}

/* The name of a copy; those of several folders stand in folders of these names. */
static void name_copy(const char *directory, bool folders, const char *path,
                      char copy[2 * STRUT_LONGEST_PATH]) {
  const char *shown = folders ? path : strchr(path, '/') + 1;
  bool slash = *directory && directory[strlen(directory) - 1] != '/';
  snprintf(copy, 2 * STRUT_LONGEST_PATH, "%s%s%s", directory, slash ? "/" : "", shown);
}

/* Does any of the copies exist? Nothing is copied then. */
static strut_status check_copies(const models *m, const selection *s, const char *directory,
                                 bool folders, strut_error *error) {
  char copy[2 * STRUT_LONGEST_PATH];
  struct stat found;
  for (size_t i = 0; i < m->count; i++) {
    if (!s->wanted[i]) continue;
    name_copy(directory, folders, m->path[i], copy);
    if (lstat(copy, &found) == 0)
      return strut_fail(error, STRUT_FILE_TROUBLE, "'%s' exists already, and is left as it is",
                        copy);
  }
  return STRUT_OK;
}

static strut_status copy_model(const models *m, size_t i, const char *copy, bool quiet,
                               strut_error *error) {
  source s;
  char folder[2 * STRUT_LONGEST_PATH];
  snprintf(folder, sizeof folder, "%s", copy);
  char *slash = strrchr(folder, '/');
  strut_status status = STRUT_OK;
  if (slash && slash != folder) {
    *slash = '\0';
    status = strut_directory_create(folder, error);
  }
  if (status != STRUT_OK) return status;
  status = open_source(m, m->path[i], &s, error);
  if (status == STRUT_OK) status = strut_create_file(copy, s.text, s.length, error);
  if (status == STRUT_OK && !quiet) printf("%s\n", copy);
  close_source(&s);
  return status;
}

static strut_status copy_models(const models *m, const strut_arguments *arguments) {
  selection s = {{false}};
  strut_error error = {0};
  const char *directory = arguments->output ? arguments->output : "";
  strut_status status = select_models(m, arguments, &s, &error);
  size_t folders = 0, length = 0;
  const char *last = NULL;
  for (size_t i = 0; i < m->count; i++) { /* in order: those of a folder follow each other */
    if (!s.wanted[i]) continue;
    if (!last || strncmp(last, m->path[i], length) != 0) folders++;
    last = m->path[i];
    length = (size_t)(strchr(last, '/') + 1 - last);
  }
  if (status == STRUT_OK) status = check_copies(m, &s, directory, folders > 1, &error);
  for (size_t i = 0; i < m->count && status == STRUT_OK; i++) {
    char copy[2 * STRUT_LONGEST_PATH];
    if (!s.wanted[i]) continue;
    name_copy(directory, folders > 1, m->path[i], copy);
    status = copy_model(m, i, copy, arguments->quiet, &error);
  }
  if (status == STRUT_USAGE)
    return strut_print_usage_error(&strut_command_examples, "%s", error.message);
  return strut_print_failure(status, &error);
}

static strut_status run_examples(const strut_arguments *arguments) {
  models *m = strut_allocate(1, sizeof *m);
  if (!m) return strut_print_out_of_memory();
  strut_status status = find_models(m);
  if (status == STRUT_OK && !arguments->model_count && arguments->output)
    status = strut_print_usage_error(&strut_command_examples, "missing NAME of what is copied");
  else if (status == STRUT_OK)
    status = arguments->model_count ? copy_models(m, arguments) : list_models(m);
  strut_arena_free(&m->arena);
  strut_release(m);
  return status;
}

void strut_offer_examples(const strut_completion *c) {
  models *m = strut_allocate(1, sizeof *m);
  if (m && strut_find_installed("models", "models", m->root) && find_models(m) == STRUT_OK)
    for (size_t i = 0; i < m->count; i++) {
      strut_error error = {0};
      source s;
      if (open_source(m, m->path[i], &s, &error) == STRUT_OK)
        strut_offer(c, m->path[i], "",
                    *text_of(&s, "study") ? text_of(&s, "study") : text_of(&s, "name"));
      close_source(&s);
    }
  if (m) strut_arena_free(&m->arena);
  strut_release(m);
}

static const strut_option options[] = {
    {STRUT_OPTION_OUTPUT, "output", "DIR", "copy into DIR instead of the current folder"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static const strut_command_variant forms[] = {{"new", &strut_command_new}, {NULL, NULL}};

const strut_command strut_command_examples = {
    .name = "examples",
    .model = "EXAMPLE",
    .model_optional = true,
    .many = true,
    .summary = "lists the models that come with strut, and copies them",
    .details =
        "\nWithout EXAMPLE, lists all models and studies. Otherwise copies them: a file such as\n"
        "crawler/crawler.yaml or just crawler.yaml, with the files that it names, or all of a "
        "folder\n"
        "such as gallery. A file that exists is left as it is, and then nothing is copied.\n",
    .options = options,
    .run = run_examples,
    .forms = forms,
};

static bool ends_with(const char *text, const char *end) {
  size_t length = strlen(text), wanted = strlen(end);
  return length >= wanted && strcmp(text + length - wanted, end) == 0;
}

static bool is_fine(const char *name) {
  const char *base = strrchr(name, '/') ? strrchr(name, '/') + 1 : name;
  for (const char *c = name; *c; c++)
    if ((unsigned char)*c < 0x20 || *c == 0x7F) return false;
  return *base && *base != '.';
}

/* The template with the file's name and the scene's for the marks. */
static void put_scene(strut_writer *writer, const char *file, const char *name) {
  char schema[STRUT_LONGEST_PATH];
  if (strut_find_installed("strut-1.schema.json", "descriptions/strut-1.schema.json", schema)) {
    strut_put(writer, "# yaml-language-server: $schema=");
    strut_put(writer, schema);
    strut_put(writer, "\n");
  }
  for (const char *at = strut_new_scene[0].text; *at;) {
    size_t length = strcspn(at, "@");
    strut_put_part(writer, at, length);
    at += length;
    if (strncmp(at, "@FILE@", 6) == 0)
      strut_put(writer, file);
    else if (strncmp(at, "@NAME@", 6) == 0)
      strut_put_quoted(writer, name);
    at += *at ? 6 : 0;
  }
}

static strut_status run_new(const strut_arguments *arguments) {
  const char *given = strut_option_text(arguments, STRUT_OPTION_NEW);
  strut_writer path = {.text = NULL}, name = {.text = NULL}, scene = {.text = NULL};
  strut_error error = {0};
  if (!is_fine(given))
    return strut_print_usage_error(&strut_command_new,
                                   "expected a name for the scene's file, not '%s'", given);
  bool ended = ends_with(given, ".yaml") || ends_with(given, ".yml");
  const char *base = strrchr(given, '/') ? strrchr(given, '/') + 1 : given;
  strut_put(&path, given);
  if (!ended) strut_put(&path, ".yaml");
  strut_put_part(&name, base, ended ? (size_t)(strrchr(base, '.') - base) : strlen(base));
  if (!path.failed && !name.failed) put_scene(&scene, path.text, name.text);
  strut_status status = STRUT_OK;
  if (path.failed || name.failed || scene.failed)
    status = strut_no_memory(&error, "");
  else
    status = strut_create_file(path.text, scene.text, scene.length, &error);
  if (status == STRUT_OK && !arguments->quiet)
    printf("%s is written; 'strut run %s' simulates it\n", path.text, path.text);
  strut_print_failure(status, &error);
  strut_release(path.text);
  strut_release(name.text);
  strut_release(scene.text);
  return status;
}

static const strut_option new_options[] = {
    {STRUT_OPTION_NEW, "new", "NAME", "write NAME.yaml"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

const strut_command strut_command_new = {
    .name = "examples --new",
    .summary = "writes a small scene to start from",
    .details =
        "\nNAME.yaml is a frame with a muscle that crawls, with comments. A file that exists is "
        "left as\n"
        "it is. Where the schema of the language is installed, the first line names it, so that "
        "editors\n"
        "complete and check the file.\n",
    .options = new_options,
    .run = run_new,
};
