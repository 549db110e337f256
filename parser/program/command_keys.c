/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What comes with the program: the language as a page and as a schema (`strut keys`), models (`strut examples`); `strut export`. */
#include <errno.h>
#include <glob.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
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
#include "parser/language/write/write_scene.h"
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

/* ---- models as files: those that come with strut, and one as one file ---- */

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

/* A file that exists stays as it is, even one that another process is just writing. */
static strut_status create_file(const char *path, const char *text, strut_error *error) {
  FILE *file = fopen(path, "wxe");
  if (!file && errno == EEXIST)
    return strut_fail(error, STRUT_FILE_TROUBLE, "'%s' exists already, and is left as it is", path);
  bool whole = file && fputs(text, file) >= 0;
  if (file && fclose(file) == 0 && whole) return STRUT_OK;
  strut_status status = strut_file_fail(error, "write", path, errno);
  if (file) remove(path);
  return status;
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
  if (!same) status = create_file(copy, text, error);
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
