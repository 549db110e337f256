/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The study's text, its model and its figures. See read_study.h; axes are in study_axes.c. */
#include "parser/language/study/read_study.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/text.h"
#include "engine/scene/things.h"
#include "parser/language/study/study_reader.h"

static const strut_owner study_owner = {"the study", NULL}, path_owner = {"the path", NULL};

void *strut_study_allocate(strut_study_reader *reader, size_t count, size_t size) {
  return strut_keep_array(reader->reader, count, size);
}

const strut_declared *strut_study_declared(const strut_study_reader *reader, const char *name) {
  return strut_scene_source_parameter(reader->file->sources[0], name);
}

const strut_declared *strut_study_parameter(strut_study_reader *study_reader, const strut_tree *key,
                                            const char *advice) {
  strut_reader *reader = study_reader->reader;
  const strut_scene_source *source = study_reader->file->sources[0];
  const strut_declared *found = strut_study_declared(study_reader, key->text);
  bool twice = found && strut_name_map_find(&study_reader->given, found->name) >= 0;
  if (twice)
    strut_report_error(reader, key->place, "parameter '%s' is given twice", found->name);
  else if (!found)
    strut_report_error(reader, key->place, "the model has no parameter '%s'%s%s",
                       strut_sanitised_text(reader, key->text),
                       strut_hint_of_rows(reader, key->text,
                                          STRUT_NAMED(source->parameters, source->parameter_count)),
                       advice ? advice : "");
  else
    strut_add_name(reader, &study_reader->given, found->name, 0);
  return twice ? NULL : found;
}

/* --set wins over the study's own `set`. */
static void read_settings(strut_study_reader *reader, const strut_slot *slot, size_t overrides,
                          bool may_yield) {
  strut_study_file *file = reader->file;
  if (slot->state != STRUT_GIVEN) return;
  for (const strut_tree *key = slot->value->first; key; key = key->next->next) {
    const strut_tree *value = key->next;
    if (!strut_read_scalar(reader->reader, value, key->text, study_owner,
                           "an expression or a text"))
      continue;
    bool yields =
        may_yield && strut_row_find(STRUT_NAMED(file->settings, overrides), key->text) < overrides;
    const strut_declared *parameter = strut_study_parameter(reader, key, NULL);
    if (!parameter || yields) continue;
    file->settings[file->setting_count++] =
        (strut_setting){.name = parameter->name,
                        .text = value->text,
                        .place = strut_study_place(file, value->place)};
  }
}

/* Reports --set of parameters that the study itself varies or derives. */
static void check_overrides(strut_study_reader *reader, size_t overrides) {
  strut_study_file *file = reader->file;
  for (size_t i = 0; i < overrides; i++) {
    const char *name = file->settings[i].name;
    for (size_t k = 0; k < file->column_count; k++)
      if (file->columns[k].name && strcmp(file->columns[k].name, name) == 0)
        strut_report_error(reader->reader, file->columns[k].place,
                           "--set %s=%s: an axis gives '%s' its values", name,
                           strut_sanitised_text(reader->reader, file->settings[i].text), name);
    if (file->followed.name && strcmp(file->followed.name, name) == 0)
      strut_report_error(reader->reader, file->followed.place,
                         "--set %s=%s: the study follows motions over '%s'", name,
                         strut_sanitised_text(reader->reader, file->settings[i].text), name);
    for (size_t k = overrides; k < file->setting_count; k++)
      if (strcmp(file->settings[k].name, name) == 0)
        strut_report_error(reader->reader, (strut_place){0}, "--set %s=%s: the study derives '%s'",
                           name, strut_sanitised_text(reader->reader, file->settings[i].text),
                           name);
  }
}

/* The quantities that the model of a variant measures, or NULL. */
static const strut_tree *quantities_of(strut_scene_source *source) {
  static const char *const path[] = {"run", "measure", "quantities"};
  const strut_tree *tree = source->document.root;
  for (size_t i = 0; i < sizeof path / sizeof path[0] && tree; i++)
    tree = tree->kind == STRUT_TREE_MAP ? strut_tree_find(tree, path[i], NULL) : NULL;
  return tree && tree->kind == STRUT_TREE_MAP ? tree : NULL;
}

/* The names that `keep` may contain: words, then the model's quantities. */
typedef struct kept_names {
  const char *word[STRUT_KEEP_COUNT];
  size_t word_count;
  const strut_tree *quantities;
} kept_names;

static const char *kept_name(const void *context, size_t i) {
  const kept_names *names = context;
  if (i < names->word_count) return names->word[i];
  i -= names->word_count;
  const strut_tree *key = names->quantities ? names->quantities->first : NULL;
  while (key && i-- > 0) key = key->next->next;
  return key ? key->text : NULL;
}

/* The words that the study may keep, as "velocity, motion or steps". */
static const char *list_kept(const strut_study *study, kept_names *names, char *text, size_t size) {
  size_t used = 0;
  *text = '\0';
  for (int i = 0; i < STRUT_KEEP_COUNT; i++)
    if (strut_kept_word_at((size_t)i)->of >> study->compute & 1u)
      names->word[names->word_count++] = strut_kept_word_at((size_t)i)->word;
  for (size_t i = 0; i < names->word_count && used < size; i++) {
    const char *before = i == 0 ? "" : i + 1 < names->word_count ? ", " : " or ";
    int n = snprintf(text + used, size - used, "%s%s", before, names->word[i]);
    used += n > 0 ? (size_t)n : 0;
  }
  return text;
}

static void refuse_kept(strut_study_reader *reader, const strut_tree *item,
                        const strut_tree *quantities) {
  char expected[700];
  const strut_study *study = &reader->file->study;
  bool run = study->compute == STRUT_COMPUTE_RUN;
  kept_names names = {.quantities = run ? quantities : NULL};
  list_kept(study, &names, expected, sizeof expected);
  if (!strut_read_scalar(reader->reader, item, "keep", study_owner, expected)) return;
  strut_report_error(reader->reader, item->place,
                     "expected %s%s for 'keep' of the study, found '%s'%s", expected,
                     run ? ", or a quantity that the model measures," : "",
                     strut_sanitised_text(reader->reader, item->text),
                     strut_hint(reader->reader, item->text, kept_name, &names));
}

static bool is_twice(const strut_tree *list, const strut_tree *item) {
  for (const strut_tree *other = list->first; other != item; other = other->next)
    if (other->kind == STRUT_TREE_SCALAR && strcmp(other->text, item->text) == 0) return true;
  return false;
}

/* Is it written like a column of the motion, which quantities know? */
static bool is_column(const char *text) {
  for (int k = 0; k < STRUT_COLUMN_COUNT; k++) {
    const strut_observable *row = strut_observable_at((strut_column_kind)k);
    if (row->owner == STRUT_OWNER_RUN && strcmp(row->word, text) == 0) return true;
  }
  return strpbrk(text, ".(") != NULL;
}

/* Words, names of what the model measures, and columns of the motion, which it then measures at its end. */
static void read_keep(strut_study_reader *reader, const strut_slot *slot) {
  strut_study *study = &reader->file->study;
  if (slot->state != STRUT_GIVEN) return;
  bool run = study->compute == STRUT_COMPUTE_RUN;
  const strut_tree *quantities =
      run && reader->file->source_count ? quantities_of(reader->file->sources[0]) : NULL;
  study->quantities =
      strut_study_allocate(reader, slot->value->count + 1, sizeof *study->quantities);
  if (!study->quantities) return;
  for (const strut_tree *item = slot->value->first; item; item = item->next) {
    bool scalar = item->kind == STRUT_TREE_SCALAR;
    int word = scalar ? strut_keep_find(item->text, study->compute) : -1;
    if (scalar && is_twice(slot->value, item))
      strut_report_error(reader->reader, item->place, "'%s' appears twice in 'keep' of the study",
                         item->text);
    else if (word >= 0)
      strut_keep_add(&study->keep, (unsigned)word);
    else if (scalar && quantities && strut_tree_find(quantities, item->text, NULL))
      study->quantities[study->quantity_count++] = item->text;
    else if (scalar && run && is_column(item->text) && strut_study_measure(reader->file, item))
      study->quantities[study->quantity_count++] = item->text;
    else
      refuse_kept(reader, item, quantities);
  }
}

/* Reports columns that the kind of figure needs. */
static void require_columns(strut_study_reader *reader, const strut_fields *fields,
                            const strut_tree *key, const strut_study_figure *figure) {
  bool map = figure->kind == STRUT_FIGURE_MAP;
  const struct {
    const char *name, *text;
  } columns[] = {{"x", figure->x}, {"y", figure->y}, {"color", figure->color}};
  if (fields->broken || figure->kind == STRUT_FIGURE_PERIOD ||
      figure->kind == STRUT_FIGURE_SNAPSHOTS || figure->kind == STRUT_FIGURE_BEST ||
      figure->kind == STRUT_FIGURE_WINNER)
    return;
  for (int i = 0; i < 2 + map; i++)
    if (!columns[i].text)
      strut_report_error(reader->reader, key->place,
                         "%s '%s' lacks '%s', expected a column of the table",
                         map ? "map" : "figure", key->text, columns[i].name);
}

/* A number of any dimension; *unit: NULL without one. False: that was reported. */
static bool read_any(strut_study_reader *reader, const strut_tree *value, const char *key,
                     strut_owner owner, double *number, const char **unit) {
  strut_quantity q;
  if (!strut_read_any_quantity(reader->reader, value, key, owner, "a number", &q)) return false;
  *number = q.value;
  *unit = q.bare ? NULL : strut_dimension_unit(q.dimension);
  return true;
}

/* Ends of an axis, in the unit of its column or without one. */
static void read_limits(strut_study_reader *reader, const strut_slot *slot, strut_owner owner,
                        double limits[2], const char **unit) {
  const char *key = slot->key ? slot->key->text : "", *units[2];
  if (slot->state != STRUT_GIVEN) return;
  const strut_tree *list = slot->value;
  for (int i = 0; i < 2; i++)
    if (list->count == 2 &&
        !read_any(reader, i ? list->first->next : list->first, key, owner, &limits[i], &units[i]))
      return;
  *unit = units[0] ? units[0] : units[1];
  if (list->count != 2 || !(limits[0] < limits[1]) ||
      (units[0] && units[1] && strcmp(units[0], units[1]) != 0))
    strut_report_error(reader->reader, list->place,
                       "'%s' of figure '%s' must be two ascending numbers", key, owner.name);
}

static void read_figure(strut_study_reader *reader, const strut_tree *key,
                        strut_study_figure *figure) {
  strut_fields fields;
  strut_owner owner = {"figure", key->text};
  strut_read_name(reader->reader, key, "figure");
  strut_read_fields(reader->reader, STRUT_SECTION_FIGURE, key->next, owner, &fields);
  *figure = (strut_study_figure){.name = key->text, .from = -HUGE_VAL, .to = HUGE_VAL};
  strut_store(reader->reader, &fields, figure);
  read_limits(reader, strut_slot_of(&fields, STRUT_KEY_FIGURE_X_LIMITS), owner, figure->x_limits,
              &figure->limit_units[0]);
  read_limits(reader, strut_slot_of(&fields, STRUT_KEY_FIGURE_Y_LIMITS), owner, figure->y_limits,
              &figure->limit_units[1]);
  require_columns(reader, &fields, key, figure);
  const strut_slot *to = strut_slot_of(&fields, STRUT_KEY_FIGURE_TO);
  if (to->state == STRUT_GIVEN && !(figure->from < figure->to))
    strut_report_error(reader->reader, to->value->place,
                       "'to' of figure '%s' must be later than 'from'", key->text);
}

static void read_figures(strut_study_reader *reader, const strut_slot *slot) {
  strut_study *study = &reader->file->study;
  if (slot->state != STRUT_GIVEN) return;
  study->figures = strut_study_allocate(reader, slot->value->count, sizeof *study->figures);
  for (const strut_tree *key = slot->value->first; key && study->figures; key = key->next->next)
    read_figure(reader, key, &study->figures[study->figure_count++]);
}

/* A number whose dimension the model decides. */
static void read_path_value(strut_study_reader *reader, strut_fields *fields, int key,
                            const char **unit) {
  const strut_key *k = strut_key_at(key);
  const strut_slot *slot = strut_slot_of(fields, key);
  char *study = (char *)&reader->file->study;
  if (slot->state == STRUT_GIVEN && read_any(reader, slot->value, k->name, path_owner,
                                             (double *)(void *)(study + k->field.offset), unit))
    strut_store_choice(k, study);
}

static void read_path(strut_study_reader *reader, const strut_slot *slot) {
  strut_study *study = &reader->file->study;
  strut_fields fields;
  if (slot->state != STRUT_GIVEN) return;
  strut_read_object(reader->reader, STRUT_SECTION_PATH, slot->value, path_owner, &fields, study);
  read_path_value(reader, &fields, STRUT_KEY_PATH_FROM, &study->path.from_unit);
  read_path_value(reader, &fields, STRUT_KEY_PATH_UNTIL, &study->path.until_unit);
  if (fields.broken) return;
  if (study->path.from_given && study->path.until_given && study->path.from == study->path.until)
    strut_report_error(reader->reader, slot->value->place,
                       "'from' and 'until' of the path are equal");
}

static void read_rest(strut_study_reader *reader, strut_fields *top) {
  strut_study *study = &reader->file->study;
  study->name = study->description = "";
  strut_store(reader->reader, top, study);
  read_path(reader, strut_slot_of(top, STRUT_KEY_STUDY_PATH));
  read_figures(reader, strut_slot_of(top, STRUT_KEY_STUDY_FIGURES));
}

/* Reads what refers to the model's parameters: set, derive and axes. */
static void read_points(strut_study_reader *reader, strut_fields *top,
                        const strut_setting *overrides, size_t count) {
  strut_study_file *file = reader->file;
  const strut_slot *set = strut_slot_of(top, STRUT_KEY_STUDY_SET);
  const strut_slot *derive = strut_slot_of(top, STRUT_KEY_STUDY_DERIVE);
  const strut_slot *axes = strut_slot_of(top, STRUT_KEY_STUDY_AXES);
  file->settings =
      strut_study_allocate(reader, count + reader->declared_count, sizeof *file->settings);
  if (!file->settings) return;
  for (; file->setting_count < count; file->setting_count++)
    file->settings[file->setting_count] = overrides[file->setting_count];
  read_settings(reader, set, count, true);
  read_settings(reader, derive, count, false);
  const strut_slot *search = strut_slot_of(top, STRUT_KEY_STUDY_SEARCH);
  reader->following = strut_slot_of(top, STRUT_KEY_STUDY_FOLLOW)->state == STRUT_GIVEN;
  strut_study_read_axes(reader, axes->state == STRUT_GIVEN ? axes->value : NULL, search);
  strut_study_read_refine(reader, strut_slot_of(top, STRUT_KEY_STUDY_REFINE));
  strut_study_read_sensitivity(reader, top);
  strut_study_read_follow(reader, top);
  strut_study_read_fit(reader, top);
  check_overrides(reader, count);
}

/* A model instead of a study gets one message instead of one for each line. */
static bool is_model(const strut_tree *root) {
  return root->kind == STRUT_TREE_MAP && strut_tree_find(root, "nodes", NULL) &&
         !strut_tree_find(root, "study", NULL) && !strut_tree_find(root, "model", NULL);
}

static strut_status read_all(strut_study_reader *study_reader, const strut_setting *overrides,
                             size_t count, strut_error *error) {
  strut_study_file *file = study_reader->file;
  strut_reader *reader = study_reader->reader;
  strut_fields top;
  strut_status status = strut_document_read(&file->document, &file->diagnostics);
  if (status == STRUT_NO_MEMORY || !file->document.root) return status;
  reader->document.root = file->document.root;
  reader->holes = status == STRUT_BAD_SCENE;
  if (reader->holes) reader->failed = true;
  if (is_model(file->document.root)) {
    strut_report_error(reader, strut_root_place(reader),
                       "this is a model, expected a study, which names one");
    return STRUT_BAD_SCENE;
  }
  strut_read_fields(reader, STRUT_SECTION_STUDY, file->document.root, study_owner, &top);
  if (file->document.root->kind != STRUT_TREE_MAP) return STRUT_BAD_SCENE;
  strut_require(reader, &top, strut_root_place(reader));
  read_rest(study_reader, &top);
  status = strut_study_open_sources(study_reader, &top, error);
  strut_read_data(reader, strut_slot_of(&top, STRUT_KEY_STUDY_DATA));
  file->study.tables = reader->tables, file->study.table_count = reader->table_count;
  read_keep(study_reader, strut_slot_of(&top, STRUT_KEY_STUDY_KEEP));
  if (file->source_count)
    file->study.derivative_count =
        strut_read_derivatives(reader, strut_slot_of(&top, STRUT_KEY_STUDY_DERIVATIVES),
                               study_owner, file->sources[0], &file->study.derivatives);
  strut_study_read_goals(study_reader, &top);
  if (status == STRUT_OK) read_points(study_reader, &top, overrides, count);
  if (reader->out_of_memory) return STRUT_NO_MEMORY;
  return status == STRUT_OK && reader->failed ? STRUT_BAD_SCENE : status;
}

strut_status strut_study_open(const char *path, const strut_setting *overrides, size_t count,
                              strut_study_file *file, strut_error *error) {
  *file = (strut_study_file){.path = path};
  strut_status status = strut_file_read(path, &file->text, &file->length, error);
  if (status != STRUT_OK) return status;
  strut_setup setup;
  strut_reader *reader = strut_allocate(1, sizeof *reader);
  if (!reader) return strut_no_memory(error, "");
  strut_setup_init(&setup);
  strut_reader_target(reader, &setup);
  reader->diagnostics = &file->diagnostics;
  reader->keep = &file->arena;
  strut_diagnostics_source(&file->diagnostics, path, file->text, file->length);
  strut_study_reader r = {.reader = reader, .file = file};
  strut_c_locale locale = strut_c_locale_enter();
  status = read_all(&r, overrides, count, error);
  strut_c_locale_leave(locale);
  if (status == STRUT_NO_MEMORY) strut_fail(error, status, "out of memory");
  strut_name_map_free(&r.given);
  strut_arena_free(&reader->scratch);
  strut_release(reader);
  strut_setup_free(&setup);
  return status;
}

const char *strut_study_messages(strut_study_file *file, size_t most) {
  const char *text = strut_diagnostics_render(&file->diagnostics, most);
  const char *model =
      file->model_diagnostics.file ? strut_diagnostics_render(&file->model_diagnostics, most) : "";
  return text && model ? strut_arena_format(&file->arena, "%s%s", text, model) : NULL;
}

const char *strut_study_notes(strut_study_file *file) {
  const char *own = strut_diagnostics_render_notes(&file->diagnostics);
  const char *model = strut_diagnostics_render_notes(&file->model_diagnostics);
  return own && model ? strut_arena_format(&file->arena, "%s%s", own, model) : NULL;
}

/* The model of a point: that of its variant. */
static const strut_scene_source *source_of(const strut_study_file *file,
                                           const strut_study_value *values) {
  size_t i = 0;
  if (!file->variants) return file->sources[0];
  while (strcmp(file->study.axes[0].columns[0].words[i], values[0].word) != 0) i++;
  return file->sources[i];
}

/* What the scenes of the study are for. */
static strut_purpose purpose_of(const strut_study *study) {
  if (study->follow || (study->fit && strut_study_fit_computes(study->fit, "run")))
    return STRUT_FOR_RUN_STEP_LATER;
  return study->compute == STRUT_COMPUTE_RUN && !study->fit ? STRUT_FOR_RUN : STRUT_FOR_ANY_STATICS;
}

/* Reads a scene, and adjusts it. */
static strut_status read_scene(const strut_study_file *file, const strut_study_value *values,
                               const strut_setting *settings, size_t count,
                               strut_diagnostics *diagnostics, strut_setup *setup) {
  const strut_study_adjustment *adjustment = &file->adjustment;
  strut_purpose purpose = adjustment->adjust ? adjustment->purpose : purpose_of(&file->study);
  strut_status status = strut_scene_source_read(source_of(file, values), settings, count, purpose,
                                                diagnostics, setup);
  if (status != STRUT_OK || !adjustment->adjust) return status;
  status = adjustment->adjust(adjustment->context, setup);
  if (status != STRUT_OK) strut_setup_free(setup);
  return status;
}

/* Reads a point's scene, the parameters `by` at `numbers`; messages go to `diagnostics`, of the model's text. */
static strut_status read_point(const strut_study_file *file, const strut_study_value *values,
                               const strut_derived_by *by, size_t by_count, const double *numbers,
                               strut_diagnostics *diagnostics, strut_setup *setup) {
  const strut_scene_source *source = source_of(file, values);
  size_t first = file->variants, count = file->setting_count;
  size_t most = count + file->column_count - first + by_count;
  strut_setting *settings = strut_allocate(most, sizeof *settings + STRUT_NUMBER_TEXT);
  if (!settings) return STRUT_NO_MEMORY;
  char(*texts)[STRUT_NUMBER_TEXT] = (char(*)[STRUT_NUMBER_TEXT])(settings + most);
  for (size_t i = 0; i < count; i++) settings[i] = file->settings[i];
  for (size_t i = first; i < file->column_count; i++) {
    if (!file->columns[i].name) continue; /* a number of the search's own */
    strut_setting *setting = &settings[count++];
    *setting = file->columns[i];
    setting->place = strut_study_place(file, setting->place);
    setting->value = values[i].number;
    setting->text = values[i].word ? values[i].word : texts[i - first];
    if (!values[i].word) strut_number_text(values[i].number, texts[i - first]);
  }
  for (size_t i = 0; i < by_count; i++) {
    strut_setting_put(source, by[i].name, numbers[i], texts[most - 1 - i], settings, &count);
    if (by[i].name == file->followed.name)
      settings[count - 1].place = strut_study_place(file, file->followed.place);
  }
  strut_status status = read_scene(file, values, settings, count, diagnostics, setup);
  strut_release(settings);
  return status;
}

strut_status strut_study_vary(void *study_file, const strut_study_value *values,
                              const strut_derived_by *by, size_t count, const double *numbers,
                              strut_setup *setup, strut_error *error) {
  const strut_study_file *file = study_file;
  strut_diagnostics diagnostics = {0};
  strut_status status = read_point(file, values, by, count, numbers, &diagnostics, setup);
  if (status == STRUT_BAD_SCENE) {
    strut_diagnostics_sort(&diagnostics);
    const strut_diagnostic *first = &diagnostics.items[0];
    strut_fail(error, status, "%s:%u: %s", strut_diagnostics_text(&diagnostics, first->place).file,
               first->place.line, first->message);
  } else if (status == STRUT_USAGE) {
    strut_fail(error, status, "the options do not fit the scene of this point");
  } else if (status != STRUT_OK) {
    strut_fail(error, status, "out of memory");
  }
  strut_diagnostics_free(&diagnostics);
  return status;
}

strut_status strut_study_setup(void *study_file, const strut_study_value *values,
                               strut_setup *setup, strut_error *error) {
  return strut_study_vary(study_file, values, NULL, 0, NULL, setup, error);
}

strut_status strut_study_setup_at(void *study_file, const strut_study_value *values, double value,
                                  strut_setup *setup, strut_error *error) {
  const strut_derived_by followed = {.name = ((strut_study_file *)study_file)->followed.name};
  return strut_study_vary(study_file, values, &followed, 1, &value, setup, error);
}

/* Appends "frequency = 10 Hz" or "start = I" to a text. */
static size_t format_value(const strut_setting *setting, strut_study_value value, char *text,
                           size_t used, size_t size) {
  char number[STRUT_NUMBER_TEXT];
  const char *unit = setting->bare ? "1" : strut_dimension_unit(setting->dimension);
  bool plain = value.word || strcmp(unit, "1") == 0;
  if (used >= size) return used;
  strut_number_text(value.number, number);
  int n = snprintf(text + used, size - used, "%s%s = %s%s%s", used ? ", " : "", setting->name,
                   value.word ? value.word : number, plain ? "" : " ", plain ? "" : unit);
  return used + (n > 0 ? (size_t)n : 0);
}

/* The configurations to start from are known once there is a scene. */
static strut_status check_starts(strut_study_file *file, const strut_scene *scene) {
  const strut_tree *follow = strut_tree_find(file->document.root, "follow", NULL);
  const strut_tree *list = follow ? strut_tree_find(follow, "start_from", NULL) : NULL;
  strut_status status = STRUT_OK;
  for (const strut_tree *item = list ? list->first : NULL; item; item = item->next) {
    if (strut_thing_find(scene, STRUT_THING_CONFIGURATION, item->text) >= 0) continue;
    strut_diagnose(&file->diagnostics, item->place,
                   "'start_from' of what is followed: the model has no configuration '%.60s'",
                   item->text);
    status = STRUT_BAD_SCENE;
  }
  return status;
}

/* Adds the values of the axes, and of what is followed, to the first of the messages. */
static void note_values(strut_study_file *file, const strut_study_value *values,
                        const double *followed) {
  char text[300] = "";
  size_t used = 0;
  strut_place place = file->column_count ? file->columns[0].place : (strut_place){0};
  for (size_t i = 0; i < file->column_count; i++)
    if (file->columns[i].name)
      used = format_value(&file->columns[i], values[i], text, used, sizeof text);
  if (followed)
    format_value(&file->followed, (strut_study_value){.number = *followed}, text, used,
                 sizeof text);
  strut_diagnostics_sort(&file->model_diagnostics);
  strut_diagnose_note(&file->model_diagnostics, 0, strut_study_place(file, place),
                      "the model cannot be run at %s", text);
}

strut_status strut_study_try(strut_study_file *file, const strut_study_value *values,
                             const double *followed) {
  strut_setup setup;
  const strut_derived_by by = {.name = file->followed.name};
  strut_status status =
      read_point(file, values, &by, followed != NULL, followed, &file->model_diagnostics, &setup);
  if (status == STRUT_OK) {
    status = followed ? check_starts(file, &setup.scene) : STRUT_OK;
    strut_setup_free(&setup);
  } else if (status == STRUT_BAD_SCENE && (file->column_count || followed)) {
    note_values(file, values, followed);
  }
  return status;
}

void strut_study_close(strut_study_file *file) {
  for (size_t i = 0; i < file->source_count; i++) strut_scene_source_free(file->sources[i]);
  for (size_t i = 0; i < file->table_count; i++) strut_safe_text_free(&file->tables[i].file);
  strut_diagnostics_free(&file->diagnostics);
  strut_diagnostics_free(&file->model_diagnostics);
  strut_document_free(&file->document);
  strut_arena_free(&file->arena);
  strut_release(file->text);
  strut_release(file->model_path);
  strut_release(file->model_text);
  strut_release(file->model_copy);
  *file = (strut_study_file){0};
}
