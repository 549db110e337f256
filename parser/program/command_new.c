/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "parser/program/commands.h"
#include "parser/program/installed.h"
#include "parser/program/shells.h"
#include "parser/program/streams.h"
#include "parser/write/writer.h"

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
  const char *given = arguments->model;
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

const strut_command strut_command_new = {
    .name = "new",
    .model = "NAME",
    .summary = "writes a small scene to start from",
    .details =
        "\nNAME.yaml is a frame with a muscle that crawls, with comments. A file that exists is "
        "left as\n"
        "it is. Where the schema of the language is installed, the first line names it, so that "
        "editors\n"
        "complete and check the file.\n",
    .run = run_new,
};
