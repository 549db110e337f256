/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/command/scene_options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/integrate/integrator.h"
#include "engine/output/figures/table_figure.h"
#include "engine/scene/things.h"
#include "parser/language/read/csv.h"
#include "parser/language/read/read_scene.h"
#include "parser/language/yaml/document.h"

const strut_option strut_method_options[] = {
    {STRUT_FILLS(integrator), "integrator", "NAME",
     "integration method, instead of that of the file", .words = STRUT_INTEGRATOR_WORDS},
    {STRUT_FILLS(step), "step", "TIME", "time step, instead of that of the file",
     .measure = STRUT_MEASURE_TIME, STRUT_ABOVE_ZERO},
    {STRUT_FILLS(tolerance), "tolerance", "X", "error tolerance of adaptive and adaptive8",
     STRUT_ABOVE_ZERO},
    {.name = NULL}};

const strut_option strut_run_setting_options[] = {
    {STRUT_FILLS(accuracy), "accuracy", "X",
     "choose method and step for a relative error of the velocity of X, such as 1%",
     STRUT_ACCURACY_RANGE},
    {STRUT_FILLS(budget), "budget", "N",
     "limit on the work of --accuracy, in units of one fine fixed-step run "
     "(default " STRUT_TEXT_OF(STRUT_USUAL_BUDGET) ")",
     STRUT_ABOVE_ZERO},
    {.table = strut_method_options},
    {STRUT_FILLS(steady), "steady", "TOLERANCE",
     "stop once the motion repeats within TOLERANCE, such as 0.5%", STRUT_ABOVE_ZERO},
    {.name = NULL}};

const strut_option strut_fidelity_options[] = {
    {STRUT_FILLS(bars), "bars", "MODEL", "elastic or rigid, instead of the file's",
     .key = STRUT_KEY_SCENE_BARS},
    {STRUT_FILLS(mass_model), "mass-model", "MODEL", "consistent or lumped, instead of the file's",
     .key = STRUT_KEY_SCENE_MASS_MODEL},
    {STRUT_FILLS(friction_law), "friction-law", "LAW",
     "none, karnopp, coulomb, smooth, stribeck or lugre, instead of the file's",
     .key = STRUT_KEY_FRICTION_LAW},
    {STRUT_FILLS(damping_law), "damping-law", "LAW",
     "of the ground: approach_only or hunt_crossley, instead of the file's",
     .key = STRUT_KEY_GROUND_DAMPING_LAW},
    {.name = NULL}};

const strut_option strut_experiment_options[] = {
    {.table = strut_run_setting_options}, {.table = strut_fidelity_options}, {.name = NULL}};

static strut_status apply_settings(const strut_arguments *arguments, strut_experiment *experiment) {
  bool by_hand = arguments->integrator.text || arguments->step.text;
  if (arguments->integrator.text)
    experiment->integrator = strut_integrator_find(arguments->integrator.text)->name;
  if (arguments->integrator.text) experiment->integrator_named = true;
  if (arguments->accuracy.text)
    experiment->accuracy = arguments->accuracy.value, experiment->accuracy_assumed = false;
  if (arguments->step.text) experiment->step = arguments->step.value;
  if (arguments->tolerance.text) experiment->tolerance = arguments->tolerance.value;
  if (arguments->budget.text) experiment->budget = arguments->budget.value;
  if (arguments->steady.text && !(experiment->periods > 0.0))
    return strut_usage_error(arguments,
                             "--steady compares periods: the run must be given in periods");
  if (arguments->steady.text)
    experiment->steady.wanted = true, experiment->steady.tolerance = arguments->steady.value;
  if (by_hand && arguments->accuracy.text)
    return strut_usage_error(
        arguments,
        "--accuracy chooses method and step: give either --accuracy, or --integrator and --step");
  if (by_hand) experiment->accuracy = 0.0;
  bool stepless = experiment->step_chosen || (by_hand && experiment->step == 0.0);
  if (stepless && !strut_experiment_is_adaptive(experiment->integrator) &&
      !(experiment->accuracy > 0.0) && !arguments->step.text)
    return strut_usage_error(
        arguments,
        "the solver has no step, which only adaptive and adaptive8 do without: give --step");
  return STRUT_OK;
}

static strut_status set_friction(const strut_arguments *arguments, strut_scene *scene,
                                 strut_friction_law law) {
  bool any = false;
  for (size_t i = 0; i < scene->contact_count; i++) {
    strut_friction *friction = &scene->contacts[i].friction;
    if (friction->law == STRUT_FRICTION_NONE) continue;
    any = true;
    for (int p = 0; p < STRUT_FRICTION_PARAMETER_COUNT; p++) {
      if (!strut_friction_needs(law, p) || !strut_friction_above_zero(p)) continue;
      if (strut_friction_value(friction, p) > 0.0) continue;
      return strut_usage_error(arguments, "--friction-law %s needs ground.friction.%s in the model",
                               strut_friction_law_at(law)->word, strut_friction_key(p));
    }
    friction->law = law;
  }
  if (any) return STRUT_OK;
  return strut_usage_error(arguments, "--friction-law needs a ground with friction in the model");
}

static strut_status set_damping(const strut_arguments *arguments, strut_scene *scene,
                                strut_ground_damping law) {
  bool damped = false, other = false;
  if (!strut_scene_has_ground(scene))
    return strut_usage_error(arguments, "--damping-law needs a ground in the model");
  for (size_t i = 0; i < scene->contact_count; i++) {
    bool crossley = law == STRUT_DAMPING_HUNT_CROSSLEY;
    damped = damped || (crossley ? scene->contacts[i].dissipation : scene->contacts[i].damping) > 0;
    other = other || (crossley ? scene->contacts[i].damping : scene->contacts[i].dissipation) > 0;
  }
  if (other && !damped)
    return strut_usage_error(arguments, "--damping-law %s in the model",
                             law == STRUT_DAMPING_HUNT_CROSSLEY
                                 ? "hunt_crossley needs ground.dissipation"
                                 : "approach_only needs ground.damping");
  scene->ground.damping_law = law;
  for (size_t g = 0; g < scene->ground_count; g++) scene->grounds[g].damping_law = law;
  return STRUT_OK;
}

const strut_option *strut_run_option_given(const strut_arguments *arguments, size_t i) {
  const strut_option *row;
  for (size_t k = 0; (row = strut_option_row(strut_experiment_options, k)); k++)
    if (strut_given_text(row, arguments) && !i--) break;
  return row;
}

strut_purpose strut_run_options_purpose(const strut_arguments *arguments) {
  const char *method = arguments->integrator.text;
  bool later = arguments->accuracy.text || arguments->step.text ||
               (method && strut_experiment_is_adaptive(method));
  return later ? STRUT_FOR_RUN_STEP_LATER : STRUT_FOR_RUN;
}

strut_status strut_run_options_apply(const strut_arguments *arguments, strut_setup *setup) {
  strut_scene *scene = &setup->scene;
  strut_status status = apply_settings(arguments, &setup->experiment);
  if (status) return status;
  if (arguments->bars.text) scene->bar_model = (strut_bar_model)arguments->bars.index;
  if (arguments->mass_model.text) scene->mass_model = (strut_mass_model)arguments->mass_model.index;
  if (arguments->friction_law.text)
    status = set_friction(arguments, scene, (strut_friction_law)arguments->friction_law.index);
  if (!status && arguments->damping_law.text)
    status = set_damping(arguments, scene, (strut_ground_damping)arguments->damping_law.index);
  if (!status) strut_experiment_choose_method(&setup->experiment, scene);
  return status;
}

const char *strut_unit_of(strut_dimension dimension) {
  const char *unit = strut_dimension_unit(dimension);
  return strcmp(unit, "1") == 0 || strcmp(unit, "SI") == 0 ? "" : unit;
}

static bool is_varied(const char *const *names, size_t count, const char *name) {
  bool found = false;
  for (size_t i = 0; i < count; i++) found = found || strcmp(names[i], name) == 0;
  return found;
}

/* Appends the setting of a varied parameter. False: the tree is not there. */
static bool add_varied(strut_varied_scenes *scenes, const char *name, strut_dimension *dimension) {
  const strut_declared *declared =
      scenes->source ? strut_scene_source_parameter(scenes->source, name) : NULL;
  if (!declared) return false;
  scenes->settings[scenes->setting_count++] = (strut_setting){.name = name,
                                                              .text = "",
                                                              .known = !declared->text,
                                                              .bare = declared->bare,
                                                              .dimension = declared->dimension};
  scenes->varied++;
  if (dimension) *dimension = declared->bare ? STRUT_DIM_NONE : declared->dimension;
  return true;
}

strut_status strut_varied_scenes_open(const strut_arguments *arguments, const char *const *names,
                                      size_t count, strut_varied_scenes *scenes,
                                      strut_dimension *dimensions) {
  strut_diagnostics unused = {0};
  if (!scenes->source) {
    strut_scene_source_open(scenes->file, scenes->text, scenes->length, &unused, &scenes->own);
    scenes->source = scenes->own;
  }
  strut_diagnostics_free(&unused);
  scenes->settings = strut_allocate(arguments->override_count + count, sizeof *scenes->settings);
  bool fine = scenes->settings && scenes->source;
  for (size_t i = 0; i < arguments->override_count && fine; i++)
    if (!is_varied(names, count, arguments->overrides[i].name))
      scenes->settings[scenes->setting_count++] = arguments->overrides[i];
  for (size_t i = 0; i < count && fine; i++)
    fine = add_varied(scenes, names[i], dimensions ? &dimensions[i] : NULL);
  if (fine) return STRUT_OK;
  strut_tell(arguments->listener, STRUT_MESSAGE_ERROR, NULL, "out of memory");
  return STRUT_NO_MEMORY;
}

/* The first finding by its place, without the "--set NAME=VALUE: " of a varied parameter. */
static strut_status report_first(const strut_varied_scenes *scenes, const strut_setting *settings,
                                 const strut_diagnostics *diagnostics, strut_error *error) {
  char set[300], at[300];
  if (diagnostics->count == 0) return strut_fail(error, STRUT_BAD_SCENE, "the scene is not valid");
  const strut_diagnostic *first = &diagnostics->items[0];
  for (size_t i = 1; i < diagnostics->count; i++)
    if (diagnostics->items[i].place.line < first->place.line) first = &diagnostics->items[i];
  const char *message = first->message;
  size_t used = 0;
  for (size_t i = scenes->setting_count - scenes->varied; i < scenes->setting_count; i++) {
    const strut_setting *setting = &settings[i];
    snprintf(set, sizeof set, "--set %.100s=%.100s: ", setting->name, setting->text);
    if (strncmp(message, set, strlen(set)) == 0) message += strlen(set);
    int n = snprintf(at + used, sizeof at - used, "%s%.80s = %.40s", used ? ", " : "",
                     setting->name, setting->text);
    used += n > 0 ? (size_t)n : 0;
    if (used > sizeof at - 1) used = sizeof at - 1;
  }
  const char *between = used ? ": " : "", *where = used ? "at " : "";
  if (!used) *at = '\0';
  if (first->place.line == 0)
    return strut_fail(error, STRUT_BAD_SCENE, "%s%s%s%s", where, at, between, message);
  return strut_fail(error, STRUT_BAD_SCENE, "%s:%u:%u: %s%s%s%s",
                    strut_diagnostics_text(diagnostics, first->place).file, first->place.line,
                    first->place.column, where, at, between, message);
}

strut_status strut_varied_scenes_vary(void *context, const strut_study_value *values,
                                      const strut_derived_by *by, size_t more,
                                      const double *numbers, strut_setup *setup,
                                      strut_error *error) {
  const strut_varied_scenes *scenes = context;
  strut_diagnostics diagnostics = {0};
  const size_t fixed = scenes->setting_count - scenes->varied;
  size_t count = scenes->setting_count, most = count + more;
  strut_setting *settings = strut_allocate(most, sizeof *settings + STRUT_NUMBER_TEXT);
  if (!settings) return strut_no_memory(error, "");
  char(*texts)[STRUT_NUMBER_TEXT] = (char(*)[STRUT_NUMBER_TEXT])(settings + most);
  if (count) memcpy(settings, scenes->settings, count * sizeof *settings);
  for (size_t i = fixed; i < count; i++) {
    const strut_study_value *value = &values[i - fixed];
    strut_number_text(value->number, texts[i]);
    settings[i].text = settings[i].known ? texts[i] : value->word;
    settings[i].value = value->number;
  }
  for (size_t i = 0; i < more; i++)
    strut_setting_put(scenes->source, by[i].name, numbers[i], texts[most - 1 - i], settings,
                      &count);
  strut_status status = strut_scene_source_read(scenes->source, settings, count, scenes->purpose,
                                                &diagnostics, setup);
  if (status == STRUT_BAD_SCENE)
    status = report_first(scenes, settings, &diagnostics, error);
  else if (status != STRUT_OK)
    strut_no_memory(error, "");
  strut_diagnostics_free(&diagnostics);
  strut_release(settings);
  if (status || !scenes->options) return status;
  if ((status = strut_run_options_apply(scenes->options, setup)) == STRUT_OK) return STRUT_OK;
  strut_setup_free(setup);
  return strut_fail(error, status, "the options do not fit the scene of this point");
}

strut_status strut_varied_scenes_read(void *scenes, const strut_study_value *values,
                                      strut_setup *setup, strut_error *error) {
  return strut_varied_scenes_vary(scenes, values, NULL, 0, NULL, setup, error);
}

strut_status strut_varied_scenes_at(void *context, double value, strut_setup *setup,
                                    strut_error *error) {
  return strut_varied_scenes_read(context, &(strut_study_value){.number = value}, setup, error);
}

void strut_varied_scenes_free(strut_varied_scenes *scenes) {
  strut_scene_source_free(scenes->own);
  strut_release(scenes->settings);
  *scenes = (strut_varied_scenes){0};
}

strut_status strut_varied_scenes_derive(const strut_arguments *arguments,
                                        strut_varied_scenes *scenes, const strut_setup *setup,
                                        const strut_flag *interrupt, strut_summary *summary,
                                        strut_error *error) {
  strut_arguments silent = *arguments;
  const strut_sweep_scenes made = {
      .setup = strut_varied_scenes_read, .vary = strut_varied_scenes_vary, .context = scenes};
  const strut_sweep_options how = {.threads = (int)arguments->threads.value,
                                   .interrupt = interrupt};
  if (!setup->experiment.derivative_count) return STRUT_OK;
  silent.listener = NULL;
  scenes->options = &silent;
  strut_status status = strut_varied_scenes_open(arguments, NULL, 0, scenes, NULL);
  if (!status) status = strut_sweep_derive_run(&made, setup, &how, summary, error);
  strut_varied_scenes_free(scenes);
  return status;
}

/* ---- figures ---- */

const strut_option strut_svg_text_options[] = {
    {STRUT_FILLS(svg_text), "svg-text", NULL, "texts of an SVG can be edited, rather than outlines",
     .of_figure = true},
    {.name = NULL}};

const strut_option strut_width_options[] = {
    {STRUT_FILLS(width), "width", "WIDTH",
     "width of the figure: page (180 mm, default), column (88 mm) or a length", .of_figure = true,
     .words = "page|column"},
    {.table = strut_svg_text_options},
    {.name = NULL}};

const strut_option strut_plot_setting_options[] = {
    {.table = strut_width_options},
    {STRUT_FILLS(title), "title", "TEXT", "title of the figure (default: the model's name)",
     .of_figure = true},
    {.name = NULL}};

const strut_option strut_run_figure_options[] = {
    {STRUT_FILLS(draw), "draw", "WHAT", "overview (default), period, snapshots or curves",
     .of_figure = true, .words = "overview|period|snapshots|curves"},
    {STRUT_FILLS(scale), "scale", "X,Y", "magnification of the motion in the figure period"},
    {STRUT_FILLS(times), "times", "TIME,...", "instants of the snapshots, such as 0 s,80 ms"},
    {.name = NULL}};

const strut_option strut_axis_options[] = {
    {STRUT_FILLS(x_label), "x-label", "TEXT", "label of the x axis, without unit",
     .of_figure = true},
    {STRUT_FILLS(y_label), "y-label", "TEXT", "label of the (left) y axis, without unit",
     .of_figure = true},
    {STRUT_FILLS(x_limits), "x-limits", "LOW,HIGH", "range of the x axis, in its base unit",
     .of_figure = true},
    {STRUT_FILLS(y_limits), "y-limits", "LOW,HIGH", "range of the (left) y axis, likewise",
     .of_figure = true},
    {.name = NULL}};

static const double POINTS = 72.0 / 0.0254;                                      /* in a metre */
static const double PAGE = 0.18, COLUMN = 0.088, NARROWEST = 0.04, WIDEST = 1.0; /* [m] */

/* What replaces axis 0, x, or 1, y; limits of a logarithmic axis are above 0. */
static strut_status read_axis(const strut_arguments *arguments, int d, strut_axis_choice *axis) {
  const char *text = d ? arguments->y_limits : arguments->x_limits;
  double range[2];
  *axis = (strut_axis_choice){.label = d ? arguments->y_label : arguments->x_label};
  axis->logarithmic = arguments->log.text && arguments->log.index != 1 - d; /* x, y or both */
  if (!text) return STRUT_OK;
  axis->limited = strut_quantities_read(text, STRUT_DIM_NONE, range, 2) == 2 &&
                  range[0] < range[1] && (!axis->logarithmic || range[0] > 0);
  axis->low = range[0], axis->high = range[1];
  return axis->limited ? STRUT_OK
                       : strut_usage_error(arguments,
                                           "--%c-limits expects two ascending numbers%s, in the "
                                           "base unit of the axis, such as 1,10; not '%s'",
                                           'x' + d, axis->logarithmic ? " above 0" : "", text);
}

strut_status strut_plot_settings_read(const strut_arguments *arguments, double usual,
                                      strut_plot *plot) {
  const char *text = arguments->width;
  bool column = text && strcmp(text, "column") == 0, page = !text || strcmp(text, "page") == 0;
  double width = column ? COLUMN : PAGE;
  plot->title = arguments->title;
  plot->texts = arguments->svg_text;
  if (!column && !page) {
    strut_status status = strut_quantity_read(arguments, "width", text, STRUT_DIM_LENGTH, &width);
    if (status) return status;
  }
  if (!(width >= NARROWEST && width <= WIDEST))
    return strut_usage_error(
        arguments, "--width %s: expected a width between 40 mm and 1 m, such as 88mm", text);
  plot->width = text || !(usual > 0) ? width * POINTS : usual;
  strut_status status = read_axis(arguments, 0, &plot->x);
  return status ? status : read_axis(arguments, 1, &plot->y);
}

/* ---- of runs ---- */

strut_status strut_run_figure_read(const strut_arguments *arguments, strut_run_figure *figure,
                                   double *times) {
  const char *scale = arguments->scale, *text = arguments->times;
  figure->view = (strut_run_view)arguments->draw.index;
  if (scale && !(figure->plot.path && figure->view == STRUT_RUN_PERIOD))
    return strut_usage_error(arguments, "--scale goes with --plot FILE --draw period");
  if (scale && !(strut_quantities_read(scale, STRUT_DIM_NONE, figure->scale, 2) == 2 &&
                 figure->scale[0] > 0 && figure->scale[1] > 0))
    return strut_usage_error(arguments,
                             "--scale expects two numbers above 0, such as 10,2; not '%s'", scale);
  if (!text) return STRUT_OK;
  if (!(figure->plot.path && figure->view == STRUT_RUN_SNAPSHOTS))
    return strut_usage_error(arguments, "--times goes with --plot FILE --draw snapshots");
  figure->time_count = strut_quantities_read(text, STRUT_DIM_TIME, times, STRUT_MOST_TIMES);
  figure->times = times;
  if (figure->time_count > 0) return STRUT_OK;
  return strut_usage_error(
      arguments,
      "--times expects up to %d times with a comma between, such as \"0 s, 80 ms\"; not '%s'",
      STRUT_MOST_TIMES, text);
}

/* ---- of tables ---- */

#define KEY(NAME, OPTION, ...) NAME, OPTION, offsetof(strut_study_figure, __VA_ARGS__)
static const strut_figure_key keys[] = {{KEY("x", "x", x), "", true},
                                        {KEY("y", "y", y), ",", true},
                                        {KEY("series", "by", series), "", false},
                                        {KEY("color", "label", color), "", false},
                                        {KEY("panels", "panels", panels), "", false},
                                        {KEY("doubt", "doubt", doubt), "", false},
                                        {KEY("difference", "difference", difference), "", false},
                                        {KEY("band", "band", band), "=", false},
                                        {KEY("only", "only", only), "=", false}};

/* Judges one name of `length` bytes; what follows it is `text`. */
static void judge_name(const strut_figure_columns *columns, const strut_figure_key *key,
                       const char *name, size_t length, char fault[STRUT_MESSAGE_MOST]) {
  const char *other;
  char word[200];
  for (size_t i = 0; (other = columns->name(columns->context, i)); i++) {
    if (strlen(other) != length || memcmp(other, name, length) != 0) continue;
    columns->judge(columns->context, i, key, name + length + 1, fault);
    return;
  }
  snprintf(word, sizeof word, "%.*s", (int)length, name);
  snprintf(fault, STRUT_MESSAGE_MOST, "%s has no column '%s'%s", columns->of, word,
           strut_near_to(word, columns->name, columns->context).text);
}

const strut_figure_key *strut_figure_fault(const strut_study_figure *figure,
                                           const strut_figure_columns *columns,
                                           char fault[STRUT_MESSAGE_MOST]) {
  fault[0] = '\0';
  for (const strut_figure_key *key = keys; key < keys + sizeof keys / sizeof *keys; key++) {
    const char *name = *(const char *const *)((const char *)figure + key->member), *end;
    for (int count = 1; name && !fault[0]; name = *end == ',' ? end + 1 : NULL, count++) {
      end = name + strcspn(name, key->ends);
      if (*key->ends == '=' && !*end)
        snprintf(fault, STRUT_MESSAGE_MOST, "expects COLUMN=TEXT, not '%.200s'", name);
      else if (count > STRUT_MOST_Y)
        snprintf(fault, STRUT_MESSAGE_MOST, "at most %d columns", STRUT_MOST_Y);
      else
        judge_name(columns, key, name, (size_t)(end - name), fault);
    }
    if (fault[0]) return key;
  }
  return NULL;
}

enum { MOST_MESSAGES = 20 };

static bool fill_column(const strut_csv *csv, strut_table *table, size_t i) {
  const char **text = strut_arena_allocate(&table->arena, table->row_count, sizeof *text);
  double *value = strut_arena_allocate(&table->arena, table->row_count, sizeof *value);
  bool numbers = true, some = false;
  if (!text || !value) return false;
  for (size_t k = 0; k < table->row_count; k++) {
    text[k] = csv->cell[(k + 1) * table->column_count + i];
    numbers = numbers && strut_csv_number(text[k], 0, &value[k]);
    some = some || (numbers && !isnan(value[k]));
  }
  table->columns[i].name = csv->titles[i].name;
  table->columns[i].unit = csv->titles[i].unit;
  table->columns[i].text = text;
  table->columns[i].value = numbers && some ? value : NULL;
  return true;
}

/* The table takes over the cells. */
static bool make_columns(strut_csv *csv, strut_table *table) {
  table->arena = csv->arena;
  csv->arena = (strut_arena){0};
  table->column_count = csv->column_count;
  table->row_count = csv->row_count;
  table->columns = strut_arena_allocate(&table->arena, table->column_count, sizeof *table->columns);
  bool good = table->columns;
  for (size_t i = 0; i < table->column_count && good; i++) good = fill_column(csv, table, i);
  return good;
}

strut_status strut_table_parse(const strut_listener *listener, const char *path, const char *text,
                               size_t length, strut_table *table) {
  strut_diagnostics diagnostics = {0};
  strut_csv csv;
  *table = (strut_table){0};
  strut_diagnostics_source(&diagnostics, strcmp(path, "-") == 0 ? "<stdin>" : path, text, length);
  strut_status status = strut_csv_read(text, length, STRUT_CSV_ANY_HEADER, &diagnostics, &csv);
  if (status == STRUT_OK && !make_columns(&csv, table)) status = STRUT_NO_MEMORY;
  if (status == STRUT_BAD_SCENE) {
    const char *messages = strut_diagnostics_render(&diagnostics, MOST_MESSAGES);
    if (strut_tell_lines(listener, messages)) status = STRUT_NO_MEMORY;
  } else {
    strut_tell_failure(listener, status, NULL);
  }
  strut_diagnostics_free(&diagnostics);
  strut_arena_free(&csv.arena);
  if (status == STRUT_OK) return STRUT_OK;
  strut_arena_free(&table->arena);
  *table = (strut_table){0};
  return status;
}

strut_status strut_table_read(const strut_listener *listener, const char *path,
                              strut_table *table) {
  char *text;
  size_t length;
  strut_error error = {0};
  *table = (strut_table){0};
  strut_status status = strut_file_read(path, &text, &length, &error);
  if (status) return strut_tell_failure(listener, status, &error);
  status = strut_table_parse(listener, path, text, length, table);
  strut_release(text);
  return status;
}
