/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/commands.h"

#include "parser/program/streams.h"
#include "parser/write/writer.h"

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
