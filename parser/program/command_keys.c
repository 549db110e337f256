/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `strut keys`: the language as a page and as a schema. */
#include <stdio.h>
#include <string.h>

#include "engine/output/result_values.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/form/form.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/modes/waves.h"
#include "engine/statics/path/path.h"
#include "engine/statics/rigidity/rigidity.h"
#include "engine/study/compare/compare.h"
#include "engine/study/fit/fit.h"
#include "engine/study/follow/follow_study.h"
#include "engine/study/report/study_report.h"
#include "engine/study/tradeoff/tradeoff.h"
#include "parser/language/write/writer.h"
#include "parser/language/yaml/document.h"
#include "parser/program/check/check_messages.h"
#include "parser/program/commands.h"

enum { LINE = 79 };

static const char *section_at(const void *context, size_t i) {
  (void)context;
  return i < STRUT_SECTION_COUNT ? strut_section_name((strut_section)i) : NULL;
}

static const char *key_at(const void *context, size_t i) {
  (void)context;
  return i < STRUT_KEY_COUNT ? strut_key_at((int)i)->name : NULL;
}

static strut_status refuse_name(const char *name) {
  strut_near near = strut_near_to(name, section_at, NULL);
  if (!*near.text) near = strut_near_to(name, key_at, NULL);
  fprintf(stderr, "strut keys: there is no section or key '%s'%s\nSections:", name, near.text);
  for (int i = 0, column = LINE; i < STRUT_SECTION_COUNT; i++) {
    const char *section = section_at(NULL, (size_t)i);
    int length = (int)strlen(section) + 2;
    if (column + length > LINE) column = fprintf(stderr, "\n ") - 1;
    column += fprintf(stderr, " %s%s", section, i + 1 < STRUT_SECTION_COUNT ? "," : "\n");
  }
  return STRUT_USAGE;
}

bool strut_keys_know(const char *name) {
  for (int i = 0; i < STRUT_SECTION_COUNT; i++)
    if (strut_key_find((strut_section)i, name) >= 0) return true;
  return strut_section_find(name) != STRUT_SECTION_COUNT;
}

static strut_status run_keys(const strut_arguments *arguments) {
  strut_status status = STRUT_OK;
  if (!arguments->model_count) return strut_print_block(strut_keys_page());
  for (size_t i = 0; i < arguments->model_count; i++)
    if (!strut_keys_know(arguments->models[i])) return refuse_name(arguments->models[i]);
  for (size_t i = 0; i < arguments->model_count && status == STRUT_OK; i++) {
    /* The section of that name, or the key of that name in every section that has one. */
    strut_section section = strut_section_find(arguments->models[i]);
    if (i) status = strut_print("\n");
    if (status == STRUT_OK)
      status = strut_print_block(section != STRUT_SECTION_COUNT
                                     ? strut_keys_text(section)
                                     : strut_keys_named(arguments->models[i]));
  }
  return status;
}

/* ---- what commands find ---- */

static strut_status run_results(const strut_arguments *arguments) {
  static const struct {
    const char *command;
    const strut_value_rows *rows;
  } results[] = {{"run", &strut_summary_values},
                 {"equilibria", &strut_equilibria_values},
                 {"modes", &strut_modes_values},
                 {"modes --wave", &strut_waves_values},
                 {"rigidity", &strut_rigidity_values},
                 {"form", &strut_form_values},
                 {"path", &strut_path_values},
                 {"path --periodic", &strut_follow_values},
                 {"check", &strut_check_values},
                 {"compare", &strut_compare_values},
                 {"tradeoff", &strut_tradeoff_values},
                 {"sweep", &strut_sweep_end_values},
                 {"sweep, of a study with `search`", &strut_search_report_values},
                 {"sweep, of a study with `fit`", &strut_fit_values},
                 {"sweep --plan", &strut_fit_plan_values},
                 {"sweep --count", &strut_sweep_count_values},
                 {"sweep --status", &strut_slots_progress_values},
                 {"sweep --status, of shards", &strut_shards_progress_values}};
  strut_buffer page = {0};
  (void)arguments;
  strut_buffer_add(
      &page,
      "# Results\n\nWhat commands find, by the keys of their JSON (`--json`, and the files of "
      "`-o`), which are the names in Python and\nin the library, too. Values are in SI "
      "units; `null` is a value that is not known or that does not exist. Of lists\nand "
      "of things by their names, keys behind the dot are those of each. Those marked in "
      "the last column are\ncolumns of the CSV. Every result begins with the scene's "
      "`name` and `strut_version`.\n\n`strut keys --results` prints this page.\n");
  for (size_t i = 0; i < sizeof results / sizeof *results; i++) {
    strut_buffer_add(&page, "\n## strut %s\n\n| key | unit | what | CSV |\n|---|---|---|---|\n",
                     results[i].command);
    strut_values_describe(&page, results[i].rows, "");
  }
  return strut_print_block(strut_buffer_take(&page));
}

static const strut_option no_options[] = {
    {.kind = STRUT_OPTION_SELECTOR, .name = "results", NULL, "print what commands find, as a page"},
    {.name = NULL},
};

static const strut_command strut_command_results = {
    .name = "keys --results",
    .summary = "explains the results of all commands, as Markdown",
    .options = no_options,
    .run = run_results,
};

static const strut_command_variant forms[] = {
    {"schema", &strut_command_schema}, {"results", &strut_command_results}, {NULL, NULL}};

const strut_command strut_command_keys = {
    .name = "keys",
    .model = "SECTION|KEY",
    .model_optional = true,
    .many = true,
    .summary = "explains the keys of the modelling language",
    .details =
        "\nPrints the keys of each SECTION, which is a mapping of the language such as member, "
        "ground or\n"
        "solver, or a KEY wherever it occurs; without both the reference page, as Markdown.\n",
    .run = run_keys,
    .forms = forms,
};

static const strut_option options[] = {
    {.kind = STRUT_OPTION_SELECTOR, .name = "schema", NULL, "print the language as a JSON Schema"},
    {STRUT_FILLS(study), "study", NULL, "the schema of a study instead of a scene"},
    {.name = NULL},
};

static strut_status run_schema(const strut_arguments *arguments) {
  return strut_print_block(strut_schema_write(arguments->study));
}

const strut_command strut_command_schema = {
    .name = "keys --schema",
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
