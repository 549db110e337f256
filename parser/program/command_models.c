/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models as files: those that come with strut (`strut examples`), and one as one file (`strut export`). */
#include <errno.h>
#include <glob.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "parser/language/write/write_scene.h"
#include "parser/program/commands.h"

enum { WIDTH = 36, LONGEST = 2 * STRUT_LONGEST_PATH };

/* The rest of the line that begins with "key: ", or "". The models have such keys on lines of their own. */
static void find_key(const char *text, const char *key, char value[200]) {
  *value = '\0';
  for (const char *line = text; line; line = strchr(line, '\n') ? strchr(line, '\n') + 1 : NULL)
    if (strncmp(line, key, strlen(key)) == 0)
      snprintf(value, 200, "%.*s", (int)strcspn(line + strlen(key), "\n"), line + strlen(key));
}

/* The models as ROOT/FOLDER/NAME.yaml, in order; globfree releases them. False: there are none. */
static bool find_models(glob_t *found, size_t *root_length) {
  char root[STRUT_LONGEST_PATH], pattern[LONGEST + 16], *at = pattern;
  if (!strut_find_installed("models", "models", root)) return false;
  for (const char *c = root; *c; c++) {
    if (strchr("*?[\\", *c)) *at++ = '\\';
    *at++ = *c;
  }
  strcpy(at, "/*/*.yaml");
  *root_length = strlen(root) + 1;
  return glob(pattern, 0, NULL, found) == 0;
}

void strut_examples_list(void (*each)(void *context, const char *model), void *context) {
  glob_t found;
  size_t root;
  if (!find_models(&found, &root)) return;
  for (size_t i = 0; i < found.gl_pathc; i++) each(context, found.gl_pathv[i] + root);
  globfree(&found);
}

static strut_status print_model(const char *path, size_t root, strut_error *error) {
  char *text, name[200], study[200];
  size_t length;
  strut_status status = strut_file_read(path, &text, &length, error);
  if (status != STRUT_OK) return status;
  find_key(text, "name: ", name);
  find_key(text, "study: ", study);
  printf("%-*s %s%s\n", WIDTH, path + root, *study ? "study: " : "", *study ? study : name);
  strut_release(text);
  return STRUT_OK;
}

/* A file that exists stays as it is. */
static strut_status create_file(const char *path, const char *text, size_t length,
                                strut_error *error) {
  FILE *file = fopen(path, "wx");
  int code = !file || fwrite(text, 1, length, file) != length ? errno : 0;
  if (file && fclose(file) != 0 && !code) code = errno;
  if (!code) return STRUT_OK;
  if (file) unlink(path);
  if (code == EEXIST)
    return strut_fail(error, STRUT_FILE_TROUBLE, "'%s' exists already, and is left as it is", path);
  return strut_fail(error, STRUT_FILE_TROUBLE, "cannot write '%s': %s", path, strerror(code));
}

/* Copies a model, and those that it names: the model of a study, the base of a scene. */
static strut_status copy_model(const strut_arguments *arguments, const char *path,
                               strut_error *error) {
  static const char *const keys[] = {"model: ", "base: "};
  char copy[LONGEST], named[LONGEST], name[200], *text, *there = NULL;
  const char *directory = arguments->output, *base = strrchr(path, '/') + 1;
  size_t length, size;
  strut_error unused = {0};
  strut_status status = strut_file_read(path, &text, &length, error);
  if (status != STRUT_OK) return status;
  snprintf(copy, sizeof copy, "%s%s%s", directory ? directory : "", directory ? "/" : "", base);
  bool same = strut_file_read(copy, &there, &size, &unused) == STRUT_OK && strcmp(there, text) == 0;
  if (!same) status = create_file(copy, text, length, error);
  if (!same && status == STRUT_OK && !arguments->quiet) printf("%s\n", copy);
  for (size_t k = 0; k < sizeof keys / sizeof keys[0] && status == STRUT_OK; k++) {
    find_key(text, keys[k], name);
    snprintf(named, sizeof named, "%.*s%s", (int)(base - path), path, name);
    if (*name) status = copy_model(arguments, named, error);
  }
  strut_release(there);
  strut_release(text);
  return status;
}

/* "crawler/crawler.yaml", "crawler.yaml", "crawler", or "crawler/" for all of a folder. */
static bool is_named(const char *model, const char *name) {
  size_t length = strlen(name);
  if (length && name[length - 1] == '/') return strncmp(model, name, length) == 0;
  if (!strchr(name, '/')) model = strchr(model, '/') + 1;
  return strncmp(model, name, length) == 0 &&
         (!model[length] || strcmp(model + length, ".yaml") == 0);
}

static strut_status copy_named(const strut_arguments *arguments, const char *name,
                               const glob_t *found, size_t root, strut_error *error) {
  strut_status status = STRUT_OK;
  size_t copied = 0;
  for (size_t i = 0; i < found->gl_pathc && status == STRUT_OK; i++) {
    if (!is_named(found->gl_pathv[i] + root, name)) continue;
    status = copy_model(arguments, found->gl_pathv[i], error);
    copied++;
  }
  if (copied) return status;
  return strut_fail(error, STRUT_USAGE, "there is no example '%s'; 'strut examples' lists all",
                    name);
}

static strut_status run_examples(const strut_arguments *arguments) {
  glob_t found;
  size_t root;
  strut_error error = {0};
  if (arguments->output && !arguments->model)
    return strut_usage_error(arguments, "missing NAME of what is copied");
  if (!find_models(&found, &root))
    return strut_print_failure(
        strut_fail(&error, STRUT_FILE_TROUBLE, "the models are not installed with this program"),
        &error);
  strut_status status = STRUT_OK;
  if (arguments->output) status = strut_directory_create(arguments->output, &error);
  for (size_t i = 0; i < arguments->model_count && status == STRUT_OK; i++)
    status = copy_named(arguments, arguments->models[i], &found, root, &error);
  for (size_t i = 0; i < found.gl_pathc && !arguments->model && status == STRUT_OK; i++)
    status = print_model(found.gl_pathv[i], root, &error);
  globfree(&found);
  return strut_print_failure(status, &error);
}

static const strut_option examples_options[] = {
    STRUT_OUTPUT_OPTION("DIR", "copy into DIR instead of the current folder"),
    {.name = NULL},
};

const strut_command strut_command_examples = {
    .name = "examples",
    .model = "EXAMPLE",
    .model_optional = true,
    .many = true,
    .summary = "lists the models that come with strut, and copies them",
    .details =
        "\nWithout EXAMPLE, lists all models and studies. Otherwise copies them: a file such as\n"
        "crawler/crawler.yaml or just crawler, with the files that it names, or all of a folder "
        "such as\n"
        "gallery/. Another file of the same name is left as it is. 'strut examples robot' is a "
        "scene with\n"
        "comments to start from.\n",
    .options = examples_options,
    .run = run_examples,
};

/* `strut export`: a model as one file. */

static strut_status put_scene(const strut_arguments *arguments, const char *text) {
  strut_error error = {0};
  if (!arguments->output) return strut_print(text);
  return strut_print_failure(strut_file_write_path(arguments->output, text, &error), &error);
}

/* Flat, or with --parts as short as the file gave it where that can be kept. */
static strut_status run_export(const strut_arguments *arguments) {
  const bool parts = arguments->parts;
  strut_setup setup;
  strut_open_report kept = {.prints = true};
  char *text = NULL;
  struct stat found;
  if (stat(arguments->model, &found) == 0 && S_ISDIR(found.st_mode))
    return strut_usage_error(arguments, "the scene of a run is %s/scene.yaml", arguments->model);
  strut_status status = strut_open_model(
      arguments, parts ? STRUT_OPEN_FOR_STATICS : STRUT_OPEN_AS_RUN, &setup, &kept);
  if (status != STRUT_OK) return status;
  char *flat = strut_setup_write(&setup);
  if (!flat) status = strut_print_out_of_memory();
  if (flat && parts)
    status = strut_write_short(arguments, kept.text, kept.length, flat, &setup, true, &text);
  if (status == STRUT_OK) status = put_scene(arguments, text ? text : flat);
  strut_release(text);
  strut_release(flat);
  strut_open_report_free(&kept);
  strut_setup_free(&setup);
  return status;
}

static const strut_option export_options[] = {
    STRUT_OUTPUT_OPTION("FILE", "file to write (default: print)"),
    STRUT_SET_OPTION,
    {STRUT_FILLS(parts), "parts", NULL, "keep parameters, groups and parts"},
    {.name = NULL},
};

const strut_command strut_command_export = {
    .name = "export",
    .model = "MODEL",
    .summary = "writes a model as one file",
    .details =
        "\n"
        "One file without parts and parameters, with every value in SI units; a run of it gives\n"
        "bit-identical results. With --parts as short as the original, with its base and parts\n"
        "written out. For other programs' formats: python3 -m strut.formats --help\n",
    .options = export_options,
    .run = run_export,
};
