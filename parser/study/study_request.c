/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requests for points of a model, in JSON or as files of Dakota. See study_request.h. */
#include "parser/study/study_request.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "parser/expression/expression.h"
#include "parser/language/keys.h"
#include "parser/study/study_reader.h"
#include "parser/yaml/text.h"

/* Set in the lines of places in a request's text, within the tree of the model. */
#define REQUEST_LINE ((uint32_t)1 << 29)

strut_status strut_study_open_model(const char *path, const strut_override *overrides,
                                    size_t override_count, strut_study_file *file,
                                    strut_error *error) {
  *file = (strut_study_file){.path = path};
  file->study = (strut_study){.name = "", .description = "", .model = path};
  file->sources = strut_arena_allocate(&file->arena, 1, sizeof(void *));
  file->settings = strut_arena_allocate(&file->arena, override_count + 1, sizeof *file->settings);
  file->model_path = strut_allocate(strlen(path) + 8, 1);
  if (!file->sources || !file->settings || !file->model_path) return strut_no_memory(error, "");
  strcpy(file->model_path, strcmp(path, "-") == 0 ? "<stdin>" : path);
  for (size_t i = 0; i < override_count; i++)
    file->settings[file->setting_count++] =
        (strut_setting){.name = overrides[i].name, .text = overrides[i].value};
  strut_status status = strut_file_read(path, &file->model_text, &file->model_length, error);
  if (status) return status;
  status = strut_scene_source_open(file->model_path, file->model_text, file->model_length,
                                   &file->model_diagnostics, &file->sources[0]);
  if (status) return status;
  file->source_count = 1;
  return STRUT_OK;
}

strut_status strut_study_open_either(const char *path, const strut_override *overrides,
                                     size_t override_count, strut_study_file *file,
                                     strut_error *error) {
  strut_status status = strut_study_open_model(path, overrides, override_count, file, error);
  if (status != STRUT_BAD_SCENE || !file->model_text || !strut_study_is_its_model(file))
    return status;
  strut_study_close(file);
  return strut_study_open(path, overrides, override_count, file, error);
}

void strut_request_begin(const strut_study_file *file, strut_request *request) {
  *request = (strut_request){.study = file->study};
  request->study.axis_count = request->study.figure_count = 0;
  request->study.axes = NULL;
  request->study.trajectories = false;
  request->study.refine.depth = 0;
  request->study.search = NULL;
}

void strut_request_free(strut_request *request) {
  strut_arena_free(&request->arena);
  *request = (strut_request){0};
}

/* ---- findings ---- */

__attribute__((format(printf, 4, 5))) static void find_fault(strut_request *r,
                                                             strut_request_findings *f,
                                                             strut_place place, const char *format,
                                                             ...) {
  char text[500];
  va_list values;
  if (f->count++ >= STRUT_REQUEST_FINDINGS) return;
  va_start(values, format);
  vsnprintf(text, sizeof text, format, values);
  va_end(values);
  const char *whole =
      strut_arena_format(&r->arena, "%s:%u:%u: %s", f->file, place.line, place.column, text);
  f->text[f->count - 1] = whole ? whole : "out of memory";
}

bool strut_request_parameter(const strut_study_file *file, const strut_request *request,
                             const char *name, bool *text) {
  const strut_declared *found = strut_scene_source_parameter(file->sources[request->source], name);
  *text = found && found->text;
  return found != NULL;
}

/* ---- what is computed and kept ---- */

static const struct {
  const char *word;
  unsigned of;
} kept_words[] = {
#define KEPT_WORD(name, word, of) {word, of},
    STRUT_KEEP_TABLE(KEPT_WORD)
#undef KEPT_WORD
};

static strut_status choose_compute(strut_request *r, const char *word, strut_error *error) {
  char expected[200];
  const char *words = strut_key_at(STRUT_KEY_STUDY_COMPUTE)->words;
  int found = strut_word_find(words, word);
  if (found < 0)
    return strut_fail(error, STRUT_BAD_SCENE, "expected %s for 'compute', found '%.40s'",
                      strut_words_text(words, expected, sizeof expected), word);
  if ((uint32_t)found != r->study.compute) { /* what the study keeps is of another computation */
    r->study.keep = (strut_keep_set){{0}};
    r->study.quantity_count = 0;
  }
  r->study.compute = (uint32_t)found;
  return STRUT_OK;
}

static const char *kept_word_at(const void *context, size_t i) {
  const strut_study *study = context;
  for (size_t k = 0; k < STRUT_KEEP_COUNT; k++)
    if ((kept_words[k].of >> study->compute & 1u) && i-- == 0) return kept_words[k].word;
  return NULL;
}

static strut_status keep_word(strut_request *r, const char *word, size_t length,
                              strut_error *error) {
  strut_study *study = &r->study;
  const char *name = strut_arena_text(&r->arena, word, length);
  if (!name) return strut_no_memory(error, "");
  for (int i = 0; i < STRUT_KEEP_COUNT; i++) {
    if (strcmp(kept_words[i].word, name) != 0 || !(kept_words[i].of >> study->compute & 1u))
      continue;
    strut_keep_add(&study->keep, (unsigned)i);
    return STRUT_OK;
  }
  const char *near = strut_did_you_mean(name, kept_word_at, study);
  if (study->compute == STRUT_COMPUTE_RUN && !near) { /* a quantity that the model measures */
    study->quantities[study->quantity_count++] = name;
    return STRUT_OK;
  }
  char compute[24];
  strut_word_at(strut_key_at(STRUT_KEY_STUDY_COMPUTE)->words, (int)study->compute, compute,
                sizeof compute);
  return strut_fail(error, STRUT_BAD_SCENE, "'%.60s' is nothing that '%s' gives%s%s%s", name,
                    compute, near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

static strut_status choose_kept(strut_request *r, const char *text, strut_error *error) {
  static const char between[] = ", \t";
  size_t most = strlen(text) / 2 + 1;
  r->study.keep = (strut_keep_set){{0}};
  r->study.quantity_count = 0;
  r->study.quantities = strut_arena_allocate(&r->arena, most, sizeof *r->study.quantities);
  if (!r->study.quantities) return strut_no_memory(error, "");
  for (text += strspn(text, between); *text; text += strspn(text, between)) {
    size_t length = strcspn(text, between);
    strut_status status = keep_word(r, text, length, error);
    if (status) return status;
    text += length;
  }
  if (!strut_keep_is_empty(&r->study.keep) || r->study.quantity_count) return STRUT_OK;
  return strut_fail(error, STRUT_BAD_SCENE, "'keep' names nothing");
}

strut_status strut_request_choose(strut_request *r, const strut_request_choice *choice,
                                  strut_error *error) {
  const unsigned at_rest = STRUT_OF_MODES | STRUT_OF_RIGIDITY | STRUT_OF_PATH;
  strut_status status = STRUT_OK;
  if (choice->compute) status = choose_compute(r, choice->compute, error);
  if (!status && choice->keep) status = choose_kept(r, choice->keep, error);
  if (status) return status;
  if (choice->at && !(at_rest >> r->study.compute & 1u))
    return strut_fail(error, STRUT_BAD_SCENE, "'at' is for modes, rigidity and path");
  if (choice->at) r->study.at = choice->at;
  if (!(at_rest >> r->study.compute & 1u)) r->study.at = NULL;
  return STRUT_OK;
}

/* ---- the mapping ---- */

static void read_value(const strut_study_file *file, const strut_tree *key, strut_request *r,
                       strut_request_findings *f) {
  const strut_tree *value = key->next;
  const strut_scene_source *source = file->sources[r->source];
  const strut_declared *parameter = strut_scene_source_parameter(source, key->text);
  if (!parameter) {
    const char *near = strut_did_you_mean(key->text, strut_scene_source_parameter_name, source);
    find_fault(r, f, key->place, "the model has no parameter '%.80s'%s%s%s", key->text,
               near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
    return;
  }
  bool word = value->kind != STRUT_TREE_SCALAR || strchr("tfn", value->text[0]);
  bool wrong = value->kind != STRUT_TREE_SCALAR || (!value->quoted && (parameter->text || word));
  if (wrong) {
    find_fault(r, f, value->place, "expected %s for '%s'",
               parameter->text ? "a text in quotes" : "a number, or a text such as \"10 mm\",",
               parameter->name);
    return;
  }
  r->values[r->value_count++] = (strut_request_value){.name = parameter->name,
                                                      .text = value->text,
                                                      .number = !value->quoted,
                                                      .name_place = key->place,
                                                      .place = value->place};
}

/* A text, or the words of a list with commas between; NULL where that was reported. */
static const char *read_words(const strut_tree *key, strut_request *r, strut_request_findings *f) {
  const strut_tree *value = key->next;
  if (value->kind == STRUT_TREE_SCALAR && value->quoted) return value->text;
  const char *text = value->kind == STRUT_TREE_LIST ? "" : NULL;
  const strut_tree *item = value->kind == STRUT_TREE_LIST ? value->first : NULL;
  for (; item && text; item = item->next) {
    bool word = item->kind == STRUT_TREE_SCALAR && item->quoted;
    text = word ? strut_arena_format(&r->arena, "%s%s,", text, item->text) : NULL;
  }
  if (!text) find_fault(r, f, value->place, "expected texts in quotes for '%s'", key->text);
  return text;
}

static void read_variant(const strut_study_file *file, const strut_tree *value, strut_request *r,
                         strut_request_findings *f) {
  if (!value && !file->variants) return;
  size_t i = 0, count = file->variants ? file->source_count : 0;
  const char *const *names = file->variants ? file->study.axes[0].columns[0].words : NULL;
  bool text = value && value->kind == STRUT_TREE_SCALAR && value->quoted;
  while (text && i < count && strcmp(names[i], value->text) != 0) i++;
  if (!value) i = 0; /* the first one */
  if (value && (!text || i == count)) {
    find_fault(r, f, value->place,
               count ? "expected the name of a variant, such as \"%s\"" : "there are no variants%s",
               count ? names[0] : ": give a study that has some");
    return;
  }
  r->source = i;
  r->variant = names[i];
}

/* The keys beside `set`. */
static void read_choices(const strut_study_file *file, const strut_tree *tree, strut_request *r,
                         strut_request_findings *f) {
  strut_request_choice choice = {0};
  const strut_tree *variant = NULL, *place = tree;
  for (const strut_tree *key = tree->first; key; key = key->next->next) {
    const char *name = key->text;
    if (strcmp(name, "set") == 0 || strcmp(name, "id") == 0) continue;
    place = key->next;
    if (strcmp(name, "variant") == 0)
      variant = key->next;
    else if (strcmp(name, "compute") == 0)
      choice.compute = read_words(key, r, f);
    else if (strcmp(name, "keep") == 0)
      choice.keep = read_words(key, r, f);
    else if (strcmp(name, "at") == 0)
      choice.at = read_words(key, r, f);
    else
      find_fault(r, f, key->place,
                 "expected set, id, compute, keep, at or variant in a request, found '%.80s'",
                 name);
  }
  strut_error error = {0};
  read_variant(file, variant, r, f);
  if (!f->count && strut_request_choose(r, &choice, &error))
    find_fault(r, f, place->place, "%s", error.message);
}

static void read_id(const strut_tree *id, strut_request *r, strut_request_findings *f) {
  if (id && id->kind != STRUT_TREE_SCALAR)
    find_fault(r, f, id->place, "expected a text or a number for 'id'");
  else
    r->id = id;
}

strut_status strut_request_read(const strut_study_file *file, const strut_tree *tree,
                                strut_request *r, strut_request_findings *f) {
  if (tree->kind != STRUT_TREE_MAP) {
    find_fault(r, f, tree->place, "expected a mapping of parameters, such as {\"NAME\": 1}");
    return STRUT_BAD_SCENE;
  }
  const strut_tree *set = strut_tree_find(tree, "set", NULL);
  bool whole = set && set->kind == STRUT_TREE_MAP;
  bool named =
      !whole && strut_scene_source_parameter(file->sources[0], "id"); /* it is no identifier */
  if (!named) read_id(strut_tree_find(tree, "id", NULL), r, f);
  if (whole)
    read_choices(file, tree, r, f);
  else
    read_variant(file, NULL, r, f);
  const strut_tree *values = whole ? set : tree;
  r->values = strut_arena_allocate(&r->arena, values->count + 1u, sizeof *r->values);
  if (!r->values) return STRUT_NO_MEMORY;
  for (const strut_tree *key = values->first; key; key = key->next->next)
    if (whole || named || strcmp(key->text, "id") != 0) read_value(file, key, r, f);
  return f->count ? STRUT_BAD_SCENE : STRUT_OK;
}

/* ---- the scene ---- */

/* The number in its parameter's dimension. */
static bool set_number(strut_request *r, const strut_request_value *v, const strut_declared *p,
                       strut_setting *s, strut_request_findings *f) {
  char *end;
  double value = strtod(v->text, &end);
  s->known = true;
  s->bare = p->bare;
  s->dimension = p->dimension;
  s->value = value;
  if (*end == '\0' && isfinite(value)) return true;
  find_fault(r, f, v->place, "expected a number that a double can hold for '%s'", v->name);
  return false;
}

/* The study's settings that the request does not replace, then those of the request. */
static strut_setting *list_settings(const strut_study_file *file, strut_request *r, size_t *count,
                                    strut_request_findings *f) {
  const strut_scene_source *source = file->sources[r->source];
  size_t room = file->setting_count + r->value_count + 1, n = 0;
  strut_setting *settings = strut_arena_allocate(&r->arena, room, sizeof *settings);
  for (size_t i = 0; settings && i < file->setting_count; i++) {
    size_t k = 0;
    while (k < r->value_count && strcmp(r->values[k].name, file->settings[i].name) != 0) k++;
    if (k == r->value_count) settings[n++] = file->settings[i];
  }
  for (size_t i = 0; settings && i < r->value_count; i++) {
    const strut_request_value *v = &r->values[i];
    strut_setting *s = &settings[n++];
    *s = (strut_setting){.name = v->name, .text = v->text, .place = v->place};
    s->place.line |= REQUEST_LINE;
    if (v->number) set_number(r, v, strut_scene_source_parameter(source, v->name), s, f);
  }
  *count = n;
  return settings;
}

/* A message about a setting, which does not know that it is no study's: "in 'x' of the study: ...". */
static const char *without_study(strut_request *r, const char *message) {
  static const char words[] = " of the study: ";
  const char *found = strncmp(message, "in '", 4) == 0 ? strstr(message, words) : NULL;
  if (!found) return message;
  const char *text = strut_arena_format(&r->arena, "%.*s: %s", (int)(found - message), message,
                                        found + strlen(words));
  return text ? text : message;
}

/* Messages about the model, where it was read with the values of a request. */
static void list_messages(const strut_study_file *file, strut_request *r,
                          const strut_diagnostics *d, strut_request_findings *f) {
  for (size_t i = 0; i < d->count; i++) {
    strut_place place = d->items[i].place;
    if (f->count++ >= STRUT_REQUEST_FINDINGS) continue;
    const char *name = place.file ? d->used[place.file - 1].file : file->model_path;
    if (place.line & STRUT_OVERLAY_LINE) name = file->path;
    if (place.line & REQUEST_LINE) name = f->file;
    uint32_t line = place.line & ~(STRUT_OVERLAY_LINE | REQUEST_LINE);
    const char *message = d->items[i].message;
    if (place.line & REQUEST_LINE) message = without_study(r, message);
    const char *text =
        line ? strut_arena_format(&r->arena, "%s:%u:%u: %s", name, line, place.column, message)
             : strut_arena_format(&r->arena, "%s: %s", name, message);
    f->text[f->count - 1] = text ? text : "out of memory";
  }
}

static void check_quantities(strut_request *r, const strut_setup *setup,
                             strut_request_findings *f) {
  const strut_experiment *e = &setup->experiment;
  for (size_t i = 0; i < r->study.quantity_count; i++) {
    size_t k = 0;
    while (k < e->quantity_count && strcmp(e->quantities[k].name, r->study.quantities[i]) != 0) k++;
    if (k < e->quantity_count) continue;
    find_fault(r, f, strut_place_at(1, 1, 1),
               "'%.60s' of 'keep' is nothing that a run gives or that the model measures",
               r->study.quantities[i]);
  }
}

strut_status strut_request_setup(const strut_study_file *file, strut_request *r, strut_setup *setup,
                                 strut_request_findings *f) {
  strut_diagnostics diagnostics = {0};
  size_t count = 0;
  const strut_study_adjustment *a = &file->adjustment;
  strut_purpose purpose = r->study.compute != STRUT_COMPUTE_RUN ? STRUT_FOR_ANY_STATICS
                          : a->adjust                           ? a->purpose
                                                                : STRUT_FOR_RUN;
  strut_c_locale locale = strut_c_locale_enter();
  strut_setting *settings = list_settings(file, r, &count, f);
  strut_c_locale_leave(locale);
  if (!settings) return STRUT_NO_MEMORY;
  if (f->count) return STRUT_BAD_SCENE;
  strut_status status = strut_scene_source_read(file->sources[r->source], settings, count, purpose,
                                                &diagnostics, setup);
  if (status == STRUT_BAD_SCENE) list_messages(file, r, &diagnostics, f);
  strut_diagnostics_free(&diagnostics);
  if (status) return status;
  if (a->adjust && r->study.compute == STRUT_COMPUTE_RUN &&
      (status = a->adjust(a->context, setup)) != STRUT_OK) {
    strut_setup_free(setup);
    return status;
  }
  check_quantities(r, setup, f);
  if (!f->count) return STRUT_OK;
  strut_setup_free(setup);
  return STRUT_BAD_SCENE;
}

/* ---- files of Dakota ---- */

/* One line of the file: a value and its name. */
typedef struct entry {
  const char *value, *name;
  bool quoted; /* the value was in quotes */
  strut_place value_place, name_place;
} entry;

typedef struct dakota_reader {
  strut_diagnostics *diagnostics;
  strut_dakota_file *file;
  const char *text, *end;
  uint32_t line;
  bool aprepro, out_of_memory;
} dakota_reader;

/* Groups of lines, each begun by how many follow: by their names in both formats. */
enum { VARIABLES, FUNCTIONS, DERIVATIVES, COMPONENTS, EVALUATION, METADATA, GROUPS };
static const char *const groups[GROUPS][2] = {{"variables", "DAKOTA_VARS"},
                                              {"functions", "DAKOTA_FNS"},
                                              {"derivative_variables", "DAKOTA_DER_VARS"},
                                              {"analysis_components", "DAKOTA_AN_COMPS"},
                                              {"eval_id", "DAKOTA_EVAL_ID"},
                                              {"metadata", "DAKOTA_METADATA"}};
enum { MOST_ENTRIES = 100000 };

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/* text[from..to) without blanks at its ends, and its place on the line. */
static const char *trim(dakota_reader *r, const char *line, const char *from, const char *to,
                        strut_place *place) {
  while (from < to && is_blank(*from)) from++;
  while (to > from && is_blank(to[-1])) to--;
  size_t length = (size_t)(to - from);
  *place = strut_place_at(r->line, (uint32_t)strut_text_points(line, (size_t)(from - line)) + 1,
                          (uint32_t)strut_text_points(from, length));
  const char *copy = strut_arena_text(&r->file->arena, from, length);
  if (!copy) r->out_of_memory = true;
  return copy ? copy : "";
}

static void unquote(dakota_reader *r, entry *e) {
  size_t length = strlen(e->value);
  if (length < 2 || e->value[0] != '"' || e->value[length - 1] != '"') return;
  e->quoted = true;
  e->value = strut_arena_text(&r->file->arena, e->value + 1, length - 2);
  if (!e->value) r->out_of_memory = true;
  if (!e->value) e->value = "";
}

/* "{ name = value }" */
static bool split_aprepro(dakota_reader *r, const char *line, const char *from, const char *to,
                          entry *e) {
  const char *equals = memchr(from, '=', (size_t)(to - from));
  while (to > from && is_blank(to[-1])) to--;
  if (!equals || to[-1] != '}' || equals >= to - 1) return false;
  e->name = trim(r, line, from + 1, equals, &e->name_place);
  e->value = trim(r, line, equals + 1, to - 1, &e->value_place);
  unquote(r, e);
  return true;
}

/* "value name": the name is the last word. */
static bool split_standard(dakota_reader *r, const char *line, const char *from, const char *to,
                           entry *e) {
  const char *word = to;
  while (word > from && is_blank(word[-1])) word--;
  to = word;
  while (word > from && !is_blank(word[-1])) word--;
  if (word == from) return false;
  e->name = trim(r, line, word, to, &e->name_place);
  e->value = trim(r, line, from, word, &e->value_place);
  unquote(r, e);
  return *e->value || e->quoted;
}

/* The next line that is not empty. 1; 0 at the end; -1: it was refused. */
static int next_entry(dakota_reader *r, entry *e) {
  while (r->text < r->end) {
    const char *line = r->text, *from = line;
    const char *stop = memchr(line, '\n', (size_t)(r->end - line));
    if (!stop) stop = r->end;
    r->text = stop < r->end ? stop + 1 : stop;
    r->line++;
    while (from < stop && is_blank(*from)) from++;
    if (from == stop) continue;
    *e = (entry){0};
    if (*from == '{') r->aprepro = true;
    bool fine = *from == '{' ? split_aprepro(r, line, from, stop, e)
                             : split_standard(r, line, from, stop, e);
    if (fine && *e->name) return 1;
    strut_diagnose(
        r->diagnostics,
        strut_place_at(r->line, (uint32_t)strut_text_points(line, (size_t)(from - line)) + 1, 1),
        "expected a line of DAKOTA's parameters file: 'VALUE NAME' or '{ NAME = VALUE }'");
    return -1;
  }
  return 0;
}

static int group_of(const entry *e) {
  for (int i = 0; i < GROUPS; i++)
    if (strcmp(e->name, groups[i][0]) == 0 || strcmp(e->name, groups[i][1]) == 0) return i;
  return -1;
}

static long count_of(dakota_reader *r, const entry *e) {
  char *end;
  long count = strtol(e->value, &end, 10);
  if (*end == '\0' && end != e->value && count >= 0 && count <= MOST_ENTRIES) return count;
  strut_diagnose(r->diagnostics, e->value_place, "expected how many of '%s' follow, up to %d",
                 e->name, MOST_ENTRIES);
  return -1;
}

static bool is_number(const char *text) {
  char *end;
  if (!*text || strspn(text, "+-.0123456789eE") != strlen(text)) return false;
  strtod(text, &end);
  return *end == '\0';
}

static void keep_variable(dakota_reader *r, const entry *e) {
  strut_request_value *v = &r->file->variables[r->file->variable_count++];
  *v = (strut_request_value){.name = e->name,
                             .text = e->value,
                             .number = !e->quoted && is_number(e->value),
                             .name_place = e->name_place,
                             .place = e->value_place};
  for (size_t i = 0; i + 1 < r->file->variable_count; i++)
    if (strcmp(r->file->variables[i].name, e->name) == 0)
      strut_diagnose(r->diagnostics, e->name_place, "variable '%.80s' is given twice", e->name);
}

/* "ASV_1:velocity" */
static void keep_function(dakota_reader *r, const entry *e) {
  strut_dakota_function *f = &r->file->functions[r->file->function_count++];
  const char *colon = strchr(e->name, ':');
  *f = (strut_dakota_function){.name = colon ? colon + 1 : "", .place = e->name_place};
  if (strlen(e->value) == 1 && *e->value >= '0' && *e->value <= '7')
    f->wanted = *e->value - '0';
  else
    strut_diagnose(r->diagnostics, e->value_place,
                   "expected a number from 0 to 7 for '%.80s': what is wanted of this function",
                   e->name);
  if (f->wanted > 1)
    strut_diagnose(r->diagnostics, e->value_place,
                   "'%.80s' asks for derivatives, which are not computed: say numerical_gradients, "
                   "or no_gradients and no_hessians, to DAKOTA",
                   e->name);
}

/* Reads the lines of a group. False: the rest of the file makes no sense. */
static bool read_group(dakota_reader *r, int group, long count) {
  strut_dakota_file *file = r->file;
  size_t room = (size_t)count + 1;
  entry e;
  if (group == VARIABLES)
    file->variables = strut_arena_allocate(&file->arena, room, sizeof *file->variables);
  if (group == FUNCTIONS)
    file->functions = strut_arena_allocate(&file->arena, room, sizeof *file->functions);
  r->out_of_memory = r->out_of_memory || (group == VARIABLES && !file->variables) ||
                     (group == FUNCTIONS && !file->functions);
  for (long i = 0; i < count && !r->out_of_memory; i++) {
    int got = next_entry(r, &e);
    if (got == 0)
      strut_diagnose(r->diagnostics, strut_place_at(r->line ? r->line : 1, 1, 1),
                     "the file ends within the %ld %s", count, groups[group][r->aprepro]);
    if (got <= 0) return false;
    if (group == VARIABLES) keep_variable(r, &e);
    if (group == FUNCTIONS) keep_function(r, &e);
  }
  if (group == METADATA && count > 0)
    strut_diagnose(r->diagnostics, strut_place_at(r->line, 1, 1),
                   "there is no metadata: leave 'metadata' out of DAKOTA's responses");
  return !r->out_of_memory;
}

static void read_all(dakota_reader *r) {
  unsigned seen = 0;
  entry e;
  int got = 0;
  while ((got = next_entry(r, &e)) > 0) {
    int group = group_of(&e);
    long count = group == EVALUATION ? 0 : group < 0 ? -1 : count_of(r, &e);
    if (group < 0 || (seen >> group & 1u)) {
      strut_diagnose(r->diagnostics, e.name_place, "expected one of the groups %s%s, found '%.80s'",
                     "variables, functions, derivative_variables, analysis_components, eval_id",
                     group < 0 ? "" : " once", e.name);
      return;
    }
    seen |= 1u << group;
    if (count < 0 || !read_group(r, group, count)) return;
  }
  if (got < 0) return;
  for (int i = VARIABLES; i <= FUNCTIONS; i++)
    if (!(seen >> i & 1u))
      strut_diagnose(r->diagnostics, strut_place_at(1, 1, 1),
                     "this is no parameters file of DAKOTA: it lacks '%s'", groups[i][0]);
}

strut_status strut_dakota_read(const char *text, size_t length, strut_diagnostics *diagnostics,
                               strut_dakota_file *file) {
  *file = (strut_dakota_file){0};
  dakota_reader r = {.diagnostics = diagnostics, .file = file, .text = text, .end = text + length};
  for (size_t i = 0; i < length;) { /* before any of it is shown */
    uint32_t code;
    size_t bytes = strut_text_decode(text + i, length - i, &code);
    if (code == STRUT_BAD_CODE || (strut_text_forbidden(code))) {
      strut_diagnose(diagnostics, strut_place_at(1, 1, 1), "the file is not a text in UTF-8");
      return STRUT_BAD_SCENE;
    }
    i += bytes;
  }
  strut_c_locale locale = strut_c_locale_enter();
  read_all(&r);
  strut_c_locale_leave(locale);
  if (r.out_of_memory || diagnostics->out_of_memory) return STRUT_NO_MEMORY;
  return diagnostics->count ? STRUT_BAD_SCENE : STRUT_OK;
}

void strut_dakota_free(strut_dakota_file *file) {
  strut_arena_free(&file->arena);
  *file = (strut_dakota_file){0};
}

strut_status strut_dakota_request(const strut_study_file *study, const strut_dakota_file *file,
                                  strut_request *request, strut_diagnostics *diagnostics) {
  for (size_t i = 0; i < file->variable_count; i++) {
    strut_request_value *v = &file->variables[i];
    bool text = false;
    if (!strut_request_parameter(study, request, v->name, &text)) {
      strut_diagnose(diagnostics, v->name_place, "the model has no parameter '%.80s'", v->name);
    } else if (!text && !v->number) {
      strut_diagnose(diagnostics, v->place, "expected a number for '%.80s', found '%.80s'", v->name,
                     v->text);
    }
    if (text) v->number = false;
  }
  request->values = file->variables;
  request->value_count = file->variable_count;
  return diagnostics->count ? STRUT_BAD_SCENE : STRUT_OK;
}
