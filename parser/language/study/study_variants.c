/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The models of a study, one for each variant, and its own text. See study_reader.h. */
#include <string.h>

#include "engine/base/checksum.h"
#include "engine/base/text.h"
#include "parser/language/read/reuse/used_files.h"
#include "parser/language/study/read_study.h"
#include "parser/language/study/study_reader.h"
#include "parser/language/write/write_scene.h"
#include "parser/language/write/writer.h"
#include "parser/language/yaml/text.h"

strut_place strut_study_place(const strut_study_file *file, strut_place place) {
  place.file = file->number & 0xFFu;
  return place;
}

/*
 * Lays the mapping `value` over the section of that name: its keys replace those of the section, within
 * nested mappings too, and keys that say the same in another way. False: memory is out.
 */
static bool lay_map_over(const strut_study_file *file, strut_document *document,
                         const char *section, const strut_tree *value) {
  strut_arena *arena = &document->arena;
  strut_tree *root = document->root;
  if (root->kind != STRUT_TREE_MAP || value->kind != STRUT_TREE_MAP) return true;
  const strut_tree *below = strut_tree_find(root, section, NULL);
  if (below && below->kind != STRUT_TREE_MAP) return true; /* the reader reports it */
  const strut_overlay overlay = {.arena = arena, .file = file->number};
  strut_tree_builder over = strut_tree_begin(arena, value);
  strut_tree *whole = NULL;
  if (strut_tree_append(&over, strut_tree_scalar(arena, value, section),
                        strut_tree_copy(arena, value)))
    whole =
        strut_lay_over(&overlay, (strut_mapping_kind){STRUT_SECTION_SCENE, false}, root, over.map);
  if (whole) document->root = whole;
  return whole != NULL;
}

/* {key: value} where `like` stands; NULL: memory is out. */
static strut_tree *wrap(strut_arena *arena, const strut_tree *like, const char *key,
                        strut_tree *value) {
  strut_tree_builder map = strut_tree_begin(arena, like);
  bool fine = strut_tree_append(&map, strut_tree_scalar(arena, like, key), value);
  return fine ? map.map : NULL;
}

bool strut_study_measure(strut_study_file *file, const strut_tree *column) {
  bool fine = true;
  for (size_t i = 0; i < file->source_count && fine; i++) {
    strut_document *document = &file->sources[i]->document;
    strut_arena *arena = &document->arena;
    strut_tree_builder quantity = strut_tree_begin(arena, column);
    fine = strut_tree_append(&quantity, strut_tree_scalar(arena, column, "of"),
                             strut_tree_scalar(arena, column, column->text)) &&
           strut_tree_append(&quantity, strut_tree_scalar(arena, column, "take"),
                             strut_tree_scalar(arena, column, "final"));
    strut_tree *run = fine ? wrap(arena, column, column->text, quantity.map) : NULL;
    run = wrap(arena, column, "measure", wrap(arena, column, "quantities", run));
    fine = run && lay_map_over(file, document, "run", run);
  }
  return fine;
}

/* Reads the model's file: below the folder of the study, as all files that a file names. */
static strut_status read_model(strut_study_reader *reader, const strut_tree *name,
                               strut_error *error) {
  strut_study_file *file = reader->file;
  strut_safe_text text;
  const char *folder = strut_folder_of(file->path, &file->arena);
  if (!folder) return STRUT_NO_MEMORY;
  strut_status status =
      strut_safe_read(folder, file->path, name->text, STRUT_TEXT_MOST, &text, error);
  if (status == STRUT_BAD_SCENE) {
    strut_report_error(reader->reader, name->place, "%s", error->message);
    *error = (strut_error){0}; /* said where it is */
  }
  if (status) return status;
  file->model_path = text.path, file->model_text = text.text, file->model_length = text.length;
  return STRUT_OK;
}

/* A model that cannot be read may be the study itself, or another: then that is all there is to say. */
static bool is_study(const strut_study_file *file) {
  strut_document document = {0};
  strut_diagnostics unsaid = {0};
  strut_diagnostics_source(&unsaid, file->model_path, file->model_text, file->model_length);
  strut_document_read(&document, &unsaid);
  bool found = document.root && strut_tree_is_study(document.root);
  strut_document_free(&document);
  strut_diagnostics_free(&unsaid);
  return found;
}

/* A model whose files are elsewhere could not stand beside the results. False: memory is out. */
static bool keep_copy(strut_study_file *file, strut_scene_source *source) {
  if (file->model_copy || !source->used_count || !source->used[0].owned) return true;
  file->model_copy =
      strut_tree_write(source->document.root, "The model and the files that it uses.");
  return file->model_copy != NULL;
}

/* The text of the model as a tree, with the study's keys over it and those of a variant, or NULL. */
static strut_status open_source(strut_study_reader *reader, strut_fields *top,
                                const strut_tree *variant) {
  static const char *const sections[] = {"solver", "run", "initial", "output"};
  strut_study_file *file = reader->file;
  strut_scene_source **source = &file->sources[file->source_count];
  strut_status status = strut_scene_source_open(
      file->model_path, file->model_text, file->model_length, &file->model_diagnostics, source);
  if (status == STRUT_BAD_SCENE && is_study(file)) {
    strut_diagnostics_free(&file->model_diagnostics);
    strut_report_error(reader->reader, strut_slot_of(top, STRUT_KEY_STUDY_MODEL)->value->place,
                       "'%s' is a study, expected a model",
                       strut_sanitised_text(reader->reader, file->study.model));
  }
  if (status != STRUT_OK) return status;
  file->source_count++;
  strut_document *document = &(*source)->document;
  if (!keep_copy(file, *source)) return STRUT_NO_MEMORY;
  file->number = strut_scene_source_use(*source, file->path, file->text, file->length);
  if (!file->number)
    strut_report_error(reader->reader, strut_slot_of(top, STRUT_KEY_STUDY_MODEL)->value->place,
                       "the model uses too many files for one of a study");
  const strut_tree *layers[] = {file->document.root, variant};
  for (int layer = 0; layer < (variant ? 2 : 1); layer++)
    for (size_t i = 0; i < sizeof sections / sizeof sections[0]; i++) {
      const strut_tree *value = strut_tree_find(layers[layer], sections[i], NULL);
      if (value && !lay_map_over(file, document, sections[i], value)) return STRUT_NO_MEMORY;
    }
  return STRUT_OK;
}

/* Names stand in the table, as texts of axes do. */
static void check_name(strut_study_reader *reader, const strut_tree *key) {
  strut_read_name(reader->reader, key, "variant");
  if (strlen(key->text) >= 24)
    strut_report_error(reader->reader, key->place,
                       "names of variants may have at most 23 bytes, found %zu", strlen(key->text));
}

static strut_status open_variants(strut_study_reader *reader, strut_fields *top,
                                  const strut_tree *variants) {
  strut_status status = STRUT_OK;
  for (const strut_tree *key = variants->first; key && status == STRUT_OK; key = key->next->next) {
    strut_fields fields;
    strut_owner owner = {"variant", key->text};
    check_name(reader, key);
    strut_read_fields(reader->reader, STRUT_SECTION_VARIANT, key->next, owner, &fields);
    reader->variant_names[reader->variant_count++] = key->text;
    status = open_source(reader, top, key->next);
  }
  return status;
}

strut_status strut_study_open_sources(strut_study_reader *reader, strut_fields *top,
                                      strut_error *error) {
  strut_study_file *file = reader->file;
  const strut_slot *model = strut_slot_of(top, STRUT_KEY_STUDY_MODEL);
  const strut_slot *variants = strut_slot_of(top, STRUT_KEY_STUDY_VARIANTS);
  size_t count = variants->state == STRUT_GIVEN ? variants->value->count : 0;
  if (variants->state == STRUT_GIVEN && !count)
    strut_report_error(reader->reader, variants->value->place,
                       "there are no variants in 'variants'");
  if (model->state != STRUT_GIVEN) return STRUT_BAD_SCENE;
  strut_status status = read_model(reader, model->value, error);
  if (status != STRUT_OK) return status;
  file->sources = strut_study_allocate(reader, count + 1, sizeof *file->sources);
  reader->variant_names = strut_study_allocate(reader, count + 1, sizeof *reader->variant_names);
  if (!file->sources || !reader->variant_names) return STRUT_NO_MEMORY;
  status = count ? open_variants(reader, top, variants->value) : open_source(reader, top, NULL);
  if (status == STRUT_OK) reader->declared_count = file->sources[0]->parameter_count;
  return status;
}

/* ---- texts of a study: identity, copy, messages ---- */

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/* First and last byte of a node's text. */
static void find_span(const strut_study_file *file, strut_place place, size_t *from, size_t *to) {
  strut_cursor at = strut_cursor_begin(file->text, file->length);
  strut_cursor_to_line(&at, place.line);
  while (at.column < place.column && strut_cursor_step(&at)) continue;
  *from = at.offset;
  strut_cursor_to_index(&at, at.index + place.length);
  *to = at.offset;
  while (*to > *from && is_blank(file->text[*to - 1])) --*to; /* of a block */
}

/* One line of comment; what would end it becomes a blank. */
static void put_note(strut_writer *writer, const char *what, const char *text, const char *value) {
  const char *const parts[] = {text, value ? "=" : "", value ? value : ""};
  strut_put(writer, "# ");
  strut_put(writer, what);
  for (int i = 0; i < 3; i++)
    for (const char *at = parts[i]; *at;) {
      size_t length = 0, left = strlen(at), end = 0;
      while (at[length] && !end)
        if ((end = strut_text_break(at + length, left - length)) == 0) length++;
      strut_put_part(writer, at, length);
      if (end) strut_put(writer, " ");
      at += length + end;
    }
  strut_put(writer, "\n");
}

/* A part of the study's text that its copy replaces. */
typedef struct replacement {
  size_t from, to;
  const char *text;
} replacement;

static void replace_node(const strut_study_file *file, const strut_tree *node, const char *text,
                         replacement *list, size_t *count) {
  replacement new = {.text = text};
  if (!node || strcmp(node->text, text) == 0) return;
  find_span(file, node->place, &new.from, &new.to);
  size_t at = (*count)++;
  for (; at > 0 && list[at - 1].from > new.from; at--) list[at] = list[at - 1];
  list[at] = new;
}

char *strut_study_copy(const strut_study_file *file, const char *model, const char *const *words,
                       size_t word_count) {
  strut_writer w = {.scene = NULL};
  const strut_tree *node = strut_tree_find(file->document.root, "model", NULL);
  replacement *list = strut_allocate(file->table_count + 1, sizeof *list);
  size_t count = 0, done = 0;
  if (!list) return NULL;
  replace_node(file, node, model, list, &count);
  for (size_t i = 0; i < file->table_count; i++)
    replace_node(file, file->tables[i].node, file->tables[i].copy, list, &count);
  for (size_t i = 0; i < count; i++) {
    strut_put_part(&w, file->text + done, list[i].from - done);
    strut_put(&w, list[i].text);
    done = list[i].to;
  }
  strut_put_part(&w, file->text + done, file->length - done);
  strut_release(list);
  if (count || word_count) strut_put(&w, "\n");
  if (node && strcmp(node->text, model) != 0)
    put_note(&w, "A copy; its model was ", node->text, NULL);
  for (size_t i = 0; i < file->table_count; i++)
    if (strcmp(file->tables[i].node->text, file->tables[i].copy) != 0)
      put_note(&w, "A copy; a file of points was ", file->tables[i].node->text, NULL);
  for (size_t i = 0; i + 1 < word_count; i += 2) {
    bool set = strcmp(words[i], "--set") == 0;
    put_note(&w, set ? "It was run with --set " : "It was run with ", words[i + set],
             set ? NULL : words[i + 1]);
  }
  return strut_buffer_take(&w.out);
}

static void put_number(strut_writer *writer, double value) {
  char text[STRUT_NUMBER_TEXT];
  strut_number_text(value, text);
  strut_put(writer, text);
  strut_put(writer, " ");
}

/* Texts are preceded by their length, so that different trees give different texts. */
static void put_word(strut_writer *writer, const char *text) {
  put_number(writer, (double)strlen(text));
  strut_put(writer, text);
  strut_put(writer, "\n");
}

static void put_tree(strut_writer *writer, const strut_tree *node) {
  char *text = strut_tree_write(node, "");
  writer->out.failed = writer->out.failed || !text;
  if (text) put_word(writer, text);
  strut_release(text);
}

static void put_axis(strut_writer *writer, const strut_study_axis *axis) {
  put_number(writer, (double)axis->count);
  for (size_t i = 0; i < axis->column_count; i++) {
    const strut_study_column *column = &axis->columns[i];
    put_word(writer, column->name);
    put_word(writer, column->unit);
    put_number(writer, (double)column->kind);
    put_number(writer, column->from);
    put_number(writer, column->to);
    put_number(writer, column->step);
    for (int64_t k = 0; column->kind == STRUT_RANGE_LIST && k < axis->count; k++) {
      if (column->word)
        put_word(writer, column->words[k]);
      else
        put_number(writer, column->number[k]);
    }
  }
}

/* What is measured, by checksums. */
static void put_tables(strut_writer *writer, const strut_data_table *tables, size_t count) {
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < tables[i].column_count; k++) {
      const double *values = tables[i].columns[k].values;
      size_t bytes = values ? tables[i].row_count * sizeof *values : 0;
      const double *weights = tables[i].columns[k].weights;
      uint64_t sum = strut_checksum(values, bytes, tables[i].row_count);
      if (weights) sum = strut_checksum(weights, bytes, sum);
      put_word(writer, tables[i].columns[k].name);
      put_number(writer, (double)(sum >> 32));
      put_number(writer, (double)(sum & UINT32_MAX));
    }
}

char *strut_study_identity(const strut_study_file *file) {
  strut_writer w = {.scene = NULL};
  const strut_study *study = &file->study;
  for (size_t i = 0; i < file->source_count; i++) {
    put_tree(&w, file->sources[i]->document.root);
    put_tables(&w, file->sources[i]->tables, file->sources[i]->table_count);
  }
  put_tables(&w, study->tables, study->table_count);
  for (size_t i = 0; i < file->setting_count; i++) {
    put_word(&w, file->settings[i].name);
    put_word(&w, file->settings[i].text);
  }
  for (size_t i = 0; i < study->axis_count; i++) put_axis(&w, &study->axes[i]);
  for (int key = STRUT_KEY_STUDY_KEEP; key <= STRUT_KEY_STUDY_FIT; key++) {
    const char *name = strut_key_at(key)->name;
    const strut_tree *value = strut_tree_find(file->document.root, name, NULL);
    if (!value || key == STRUT_KEY_STUDY_FIGURES || key == STRUT_KEY_STUDY_LIMIT) continue;
    put_word(&w, name);
    put_tree(&w, value);
  }
  if (study->limit.evaluations) put_number(&w, (double)study->limit.evaluations);
  return strut_buffer_take(&w.out);
}
