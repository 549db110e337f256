/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `strut keys` and `strut schema`: the language as a page and as a schema. */
#include <stdio.h>
#include <string.h>

#include "parser/program/commands.h"
#include "parser/program/streams.h"
#include "parser/write/writer.h"
#include "parser/yaml/diagnostics.h"

enum { LINE = 79 };

static const char *section_at(const void *context, size_t i) {
  (void)context;
  return i < STRUT_SECTION_COUNT ? strut_section_name((strut_section)i) : NULL;
}

/* "; it is a key of node, member and beam", or what the name may have meant. */
static void print_hint(const char *name) {
  int found = 0, last = 0;
  for (int i = 0; i < STRUT_SECTION_COUNT; i++)
    if (strut_key_find((strut_section)i, name) >= 0) found++, last = i;
  const char *near = found ? NULL : strut_did_you_mean(name, section_at, NULL);
  if (near) fprintf(stderr, "; did you mean '%s'?", near);
  if (!found) return;
  const char *separator = "; it is a key of ";
  for (int i = 0; i < STRUT_SECTION_COUNT; i++) {
    if (strut_key_find((strut_section)i, name) < 0) continue;
    if (i == last && found > 1) separator = " and ";
    fprintf(stderr, "%s%s", separator, section_at(NULL, (size_t)i));
    separator = ", ";
  }
}

static strut_status refuse_section(const char *name) {
  fprintf(stderr, "strut keys: there is no section '%s'", name);
  print_hint(name);
  fprintf(stderr, "\nSections:");
  for (int i = 0, column = LINE; i < STRUT_SECTION_COUNT; i++) {
    const char *section = section_at(NULL, (size_t)i);
    int length = (int)strlen(section) + 2;
    if (column + length > LINE) column = fprintf(stderr, "\n ") - 1;
    column += fprintf(stderr, " %s%s", section, i + 1 < STRUT_SECTION_COUNT ? "," : "\n");
  }
  return STRUT_USAGE;
}

static strut_status run_keys(const strut_arguments *arguments) {
  strut_status status = STRUT_OK;
  if (!arguments->model_count) return strut_print_block(strut_keys_page());
  for (size_t i = 0; i < arguments->model_count; i++)
    if (strut_section_find(arguments->models[i]) == STRUT_SECTION_COUNT)
      return refuse_section(arguments->models[i]);
  for (size_t i = 0; i < arguments->model_count && status == STRUT_OK; i++) {
    if (i) status = strut_print("\n");
    if (status == STRUT_OK)
      status = strut_print_block(strut_keys_text(strut_section_find(arguments->models[i])));
  }
  return status;
}

const strut_command strut_command_keys = {
    .name = "keys",
    .model = "SECTION",
    .model_optional = true,
    .many = true,
    .summary = "explains the keys of the modelling language",
    .details =
        "\nPrints the keys of each SECTION, which is a mapping of the language such as member, "
        "ground or\n"
        "solver; without SECTION the reference page of all, as Markdown.\n",
    .run = run_keys,
};

static const strut_option options[] = {
    {STRUT_OPTION_STUDY, "study", NULL, "the schema of a study instead of a scene"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_status run_schema(const strut_arguments *arguments) {
  return strut_print_block(strut_schema_write(arguments->study));
}

const strut_command strut_command_schema = {
    .name = "schema",
    .summary = "prints the language as a JSON Schema, for editors",
    .details =
        "\nWith it an editor completes keys and words, explains them, and marks unknown keys, "
        "words and\n"
        "values of the wrong shape. It is installed as share/strut/strut-1.schema.json; the one of "
        "a\n"
        "study as share/strut/strut-1.study.schema.json.\n",
    .options = options,
    .run = run_schema,
};
