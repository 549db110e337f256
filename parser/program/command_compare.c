/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/commands.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/study/compare/compare.h"
#include "parser/language/read/read_scene.h"
#include "parser/language/read/reuse/overlay.h"
#include "parser/language/write/write_scene.h"
#include "parser/program/command/analyses.h"

/* ---- reading the models ---- */

/* Zero-initialise. */
typedef struct compared_models {
  size_t count;
  strut_compare_input *inputs; /* (count) */
  strut_setup *setups;         /* (count) */
  strut_arena arena;           /* of names and differences */
  const char *notes;           /* on --set, as printed so far; or NULL */
  strut_compare result;
} compared_models;

/* A model being read. */
typedef struct model_source {
  const char *path, *shown;
  char *text;
  size_t length;
  strut_setting *known; /* (known_count) of --set: parameters that it has */
  size_t known_count;
} model_source;

/* ---- names ---- */

static bool is_taken(const compared_models *compared, size_t count, const char *label) {
  for (size_t i = 0; i < count; i++)
    if (strcmp(compared->inputs[i].label, label) == 0) return true;
  return false;
}

/* The label with the values of --set behind the model: "crawler friction=0.2". */
static const char *add_own_settings(const strut_arguments *arguments, compared_models *compared,
                                    size_t number, const char *label) {
  for (size_t i = 0; i < arguments->override_count && label; i++)
    if (arguments->override_model[i] == number + 1)
      label = strut_arena_format(&compared->arena, "%s %s=%s", label, arguments->overrides[i].name,
                                 arguments->overrides[i].text);
  return label;
}

/* The file's name without its folder and ending, else its path, else that with a number; unique. */
static const char *choose_label(const strut_arguments *arguments, compared_models *compared,
                                size_t number, const char *path) {
  const char *slash = strrchr(path, '/'), *name = slash && slash[1] ? slash + 1 : path;
  if (strcmp(path, "-") == 0) name = "stdin";
  size_t length = strlen(name);
  const char *dot = strrchr(name, '.');
  if (dot && dot > name && (strcmp(dot, ".yaml") == 0 || strcmp(dot, ".yml") == 0))
    length = (size_t)(dot - name);
  const char *label = strut_arena_text(&compared->arena, name, length);
  label = add_own_settings(arguments, compared, number, label);
  if (label && is_taken(compared, number, label))
    label = add_own_settings(arguments, compared, number, path);
  const char *stem = label;
  for (int k = 2; label && is_taken(compared, number, label); k++)
    label = strut_arena_format(&compared->arena, "%s (%d)", stem, k);
  return label;
}

/* ---- reading ---- */

/* Prints the notes on --set that no earlier column gave. */
static bool print_notes(compared_models *compared, strut_diagnostics *diagnostics) {
  if (diagnostics->note_count == 0) return true;
  const char *notes = strut_diagnostics_render_notes(diagnostics);
  const char *before = compared->notes ? compared->notes : "";
  if (notes && strstr(before, notes)) return true;
  if (notes) fputs(notes, stderr);
  if (notes) compared->notes = strut_arena_format(&compared->arena, "%s%s", before, notes);
  return notes && compared->notes;
}

static strut_status read_setup(compared_models *compared, const model_source *from,
                               const strut_setting *overrides, size_t count, strut_setup *setup) {
  strut_diagnostics diagnostics = {0};
  strut_status status = strut_setup_read(setup, from->shown, from->text, from->length, overrides,
                                         count, STRUT_FOR_ANY, &diagnostics);
  status = strut_print_found(&diagnostics, status, true, setup);
  if (status == STRUT_OK && !print_notes(compared, &diagnostics)) {
    strut_setup_free(setup);
    status = STRUT_NO_MEMORY;
  }
  if (status == STRUT_NO_MEMORY) strut_print_out_of_memory();
  strut_diagnostics_free(&diagnostics);
  return status;
}

/* Splits the settings for a model into those whose parameter it has and the others. */
static strut_status split_settings(const strut_arguments *arguments, const strut_scene *scene,
                                   compared_models *compared, size_t number, model_source *from) {
  size_t count = arguments->override_count;
  strut_compare_input *input = &compared->inputs[number];
  const char **without = strut_arena_allocate(&compared->arena, count + 1, sizeof *without);
  from->known = strut_arena_allocate(&compared->arena, count + 1, sizeof *from->known);
  if (!without || !from->known) return strut_print_out_of_memory();
  for (size_t i = 0; i < count; i++) {
    size_t owner = arguments->override_model[i]; /* 0: all models */
    if (owner != 0 && owner != number + 1) continue;
    if (strut_parameter_named(scene, arguments->overrides[i].name))
      from->known[from->known_count++] = arguments->overrides[i];
    else
      without[input->without_count++] = arguments->overrides[i].name;
  }
  input->without = without;
  return STRUT_OK;
}

static strut_status open_one(const strut_arguments *arguments, compared_models *compared,
                             size_t number) {
  const char *path = arguments->models[number];
  model_source from = {.path = path, .shown = strcmp(path, "-") == 0 ? "<stdin>" : path};
  strut_compare_input *input = &compared->inputs[number];
  strut_setup *setup = &compared->setups[number];
  strut_error error = {0};
  input->setup = setup;
  input->label = choose_label(arguments, compared, number, path);
  if (!input->label) return strut_print_out_of_memory();
  strut_status status = strut_file_read(path, &from.text, &from.length, &error);
  if (status != STRUT_OK) return strut_print_failure(status, &error);
  status = read_setup(compared, &from, NULL, 0, setup);
  if (status == STRUT_OK)
    status = split_settings(arguments, &setup->scene, compared, number, &from);
  if (status == STRUT_OK && from.known_count > 0) {
    strut_setup_free(setup);
    status = read_setup(compared, &from, from.known, from.known_count, setup);
  }
  strut_release(from.text);
  return status;
}

/* ---- all models ---- */

/* Parameters of all models, concatenated: candidates for suggestions. */
static const char *parameter_at(const void *context, size_t i) {
  const compared_models *compared = context;
  for (size_t k = 0; k < compared->count; k++) {
    if (i < compared->setups[k].scene.parameter_count)
      return compared->setups[k].scene.parameters[i].name;
    i -= compared->setups[k].scene.parameter_count;
  }
  return NULL;
}

static strut_status check_settings(const strut_arguments *arguments,
                                   const compared_models *compared) {
  for (size_t i = 0; i < arguments->override_count; i++) {
    const char *name = arguments->overrides[i].name;
    size_t owner = arguments->override_model[i];
    bool known = false;
    for (size_t k = 0; k < compared->count; k++)
      known = known || ((owner == 0 || owner == k + 1) &&
                        strut_parameter_named(&compared->setups[k].scene, name));
    if (known) continue;
    return strut_usage_error(arguments, "--set %s: %s%s%s has %s parameter%s", name,
                             owner ? "'" : "", owner ? arguments->models[owner - 1] : "no model",
                             owner ? "'" : "", owner ? "no such" : "such a",
                             strut_near_to(name, parameter_at, compared).text);
  }
  return STRUT_OK;
}

/* Gives all models the mass of --mass. */
static strut_status scale_masses(const strut_arguments *arguments, compared_models *compared) {
  for (size_t i = 0; i < compared->count && arguments->mass.text; i++) {
    double mass = strut_scene_mass(&compared->setups[i].scene);
    if (!(mass > 0.0))
      return strut_usage_error(arguments, "--mass: '%s' has no mass", compared->inputs[i].label);
    strut_scene_scale_masses(&compared->setups[i].scene, arguments->mass.value / mass);
  }
  return STRUT_OK;
}

/* Runs before starts are resolved, so that scenes are compared as written. */
static strut_status find_differences(compared_models *compared) {
  strut_status status = STRUT_OK;
  char *first = strut_setup_write(&compared->setups[0]);
  if (!first) return strut_print_out_of_memory();
  for (size_t i = 1; i < compared->count && status == STRUT_OK; i++) {
    strut_compare_input *input = &compared->inputs[i];
    strut_difference *list = NULL;
    char *text = strut_setup_write(&compared->setups[i]);
    status = text ? strut_text_differences(first, text, &compared->arena, &list,
                                           &input->difference_count)
                  : STRUT_NO_MEMORY;
    input->differences = list;
    strut_release(text);
    if (status != STRUT_OK) strut_print_out_of_memory();
  }
  strut_release(first);
  return status == STRUT_OK ? STRUT_OK : STRUT_NO_MEMORY;
}

static strut_status check_models(const strut_arguments *arguments) {
  size_t standard = 0;
  for (size_t i = 0; i < arguments->model_count; i++)
    standard += strcmp(arguments->models[i], "-") == 0;
  if (standard > 1)
    return strut_usage_error(arguments, "standard input can be read only once: give '-' once");
  if (arguments->model_count > STRUT_COMPARE_MOST)
    return strut_usage_error(arguments, "%zu models given, at most %d can be compared",
                             arguments->model_count, STRUT_COMPARE_MOST);
  return STRUT_OK;
}

static strut_status open_compared(strut_analysis *analysis, char **text) {
  const strut_arguments *arguments = analysis->arguments;
  size_t count = arguments->model_count;
  compared_models *compared = strut_allocate(1, sizeof *compared);
  (void)text;
  analysis->setup = NULL;
  analysis->result.own = compared;
  if (!compared) return strut_print_out_of_memory();
  strut_status status = check_models(arguments);
  if (status) return status;
  compared->inputs = strut_arena_allocate(&compared->arena, count, sizeof *compared->inputs);
  compared->setups = strut_arena_allocate(&compared->arena, count, sizeof *compared->setups);
  if (!compared->inputs || !compared->setups) return strut_print_out_of_memory();
  for (size_t i = 0; i < count && status != STRUT_NO_MEMORY; i++) {
    strut_status here = open_one(arguments, compared, i);
    compared->count = i + 1;
    if (status == STRUT_OK || here == STRUT_NO_MEMORY) status = here;
  }
  if (status == STRUT_OK) status = check_settings(arguments, compared);
  if (status == STRUT_OK) status = scale_masses(arguments, compared);
  return status ? status : find_differences(compared);
}

static void free_compared(strut_analysis *analysis) {
  compared_models *compared = analysis->result.own;
  if (!compared) return;
  strut_compare_free(&compared->result);
  for (size_t i = 0; i < compared->count; i++) strut_setup_free(&compared->setups[i]);
  strut_arena_free(&compared->arena);
  strut_release(compared);
}

/* ---- comparing ---- */

static const strut_option options[] = {
    {STRUT_FILLS(overrides), "set", "NAME=VALUE",
     "change a parameter of all models that have it; after a MODEL, of that one"},
    {STRUT_FILLS(mass), "mass", "MASS", "scale the masses of each model to this sum, such as 200g",
     .measure = STRUT_MEASURE_MASS, STRUT_ABOVE_ZERO},
    {STRUT_FILLS(accuracy), "accuracy", "X",
     "relative accuracy of velocities, such as 1% (default " STRUT_TEXT_OF(
         STRUT_COMPARE_USUAL_PERCENT) "%)",
     STRUT_ACCURACY_RANGE},
    {STRUT_FILLS(no_motion), "no-motion", NULL, "skip the simulated motion"},
    {STRUT_FILLS(no_states), "no-states", NULL, "skip the search for stable equilibria"},
    STRUT_OUTPUT_OPTION("DIR", "write compare.csv, .json, .svg and model-1.svg, ... into DIR"),
    STRUT_PRINT_OPTIONS,
    STRUT_THREADS_OPTION,
    {STRUT_FILLS(csv), "csv", NULL, "print CSV, one row per model"},
    {.table = strut_plot_options},
    {.name = NULL},
};

static const strut_compare *result_of(const strut_analysis *analysis) {
  return &((const compared_models *)analysis->result.own)->result;
}

static bool is_compared(const strut_analysis *analysis, size_t number) {
  return number <= result_of(analysis)->count;
}

/* All models, or one, counted from 1. */
static strut_status draw(const strut_analysis *analysis, const strut_plot *plot,
                         strut_error *error) {
  const strut_compare *result = result_of(analysis);
  size_t one = analysis->picture;
  return one ? strut_compare_figure(plot, result, one - 1, 1, error)
             : strut_compare_figure(plot, result, 0, result->count, error);
}

static const strut_output_file files[] = {
    {.name = "compare.csv", .list = "models"},
    {.name = "compare.json"},
    {.name = "compare.svg", .draw = draw, .width = 510.24}, /* 180 mm */
    {.name = "model",
     .draw = draw,
     .number = 1,
     .most = STRUT_COMPARE_MOST,
     .width = 249.45, /* 88 mm */
     .there = is_compared},
    {.name = NULL}};

/* Repeats on stderr what could not be computed, or not as accurately as requested. */
static strut_status report_failures(const strut_analysis *analysis, strut_error *unused) {
  const strut_compare *result = result_of(analysis);
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < result->count; i++) {
    const strut_compare_column *column = &result->columns[i];
    (void)unused;
    strut_error error = {0};
    if (column->inaccurate) {
      fprintf(stderr, "strut: warning: %s: the velocity is less accurate than requested: %s\n",
              column->input->label, column->how);
      if (status == STRUT_OK) status = STRUT_INACCURATE;
    }
    if (column->status == STRUT_OK) continue;
    strut_fail(&error, column->status, "%s: %s", column->input->label, column->message);
    strut_print_error(&error);
    if (status == STRUT_OK || status == STRUT_INACCURATE) status = column->status;
  }
  return status;
}

static strut_status compare(strut_analysis *analysis, strut_error *error) {
  compared_models *models = analysis->result.own;
  const strut_compare_options wanted = {.accuracy = analysis->arguments->accuracy.value,
                                        .no_motion = analysis->arguments->no_motion,
                                        .no_states = analysis->arguments->no_states,
                                        .interrupt = analysis->interrupt,
                                        .progress = analysis->progress,
                                        .progress_context = analysis->progress_context};
  analysis->found = &models->result;
  return strut_compare_make(models->inputs, models->count, &wanted, &models->result, error);
}

static const strut_analysis_kind compare_analysis = {.files = files,
                                                     .rows = &strut_compare_values,
                                                     .printed = "models",
                                                     .uncompiled = true,
                                                     .asks = true,
                                                     .compute = compare,
                                                     .verdict = report_failures,
                                                     .draw = draw,
                                                     .release = free_compared};

static const strut_refused_option refused[] = {
    {"integrator", "every model is run to --accuracy, by the method that this takes"},
    {"step", "every model is run to --accuracy, with the step that this takes"},
    {NULL, NULL}};

static const char compare_details[] =
    "\nFor each model, the results of check, rigidity, equilibria, modes and run:\n"
    "counts, mass, self-stress, mechanisms; stable equilibria and the lowest escape barrier of\n"
    "the starting one; forces, frequencies and stiffness at rest (of each node under a unit load\n"
    "in x and y, contacts held); the largest step; and for a model with a run the velocity,\n"
    "travel per period, drive energy, cost of transport (drive power over weight times speed) and\n"
    "duty factor of the steady motion, with the cost of a simulated second.\n"
    "Then how the effective scenes differ from the first: + added, - removed, ~ changed.\n"
    "Missing values are left empty, and null with a reason in JSON.\n"
    "'strut compare m.yaml m.yaml --set mu=0.2' compares a model with a variant of itself.\n";

const strut_command strut_command_compare = {
    .name = "compare",
    .model = "MODEL...",
    .many = true,
    .summary = "compares models side by side: structure, statics and motion",
    .details = compare_details,
    .options = options,
    .analysis = &compare_analysis,
    .open = open_compared,
    .refused = refused,
    .timed = true,
};
