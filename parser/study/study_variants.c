/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The model of a study, once for each variant, with their keys laid over its own. See study_reader.h. */
#include <string.h>

#include "parser/read/overlay.h"
#include "parser/read/safe_path.h"
#include "parser/study/study_reader.h"
#include "parser/write/write_tree.h"

strut_place strut_overlay_place(strut_place place) {
  place.line |= STRUT_OVERLAY_LINE;
  return place;
}

/*
 * Lays the mapping `value` over the section of that name: its keys replace those of the section, within
 * nested mappings too, and keys that say the same in another way. False: memory is out.
 */
static bool lay_map_over(strut_document *document, const char *section, const strut_tree *value) {
  strut_tree *root = document->root;
  if (root->kind != STRUT_TREE_MAP || value->kind != STRUT_TREE_MAP) return true;
  const strut_tree *below = strut_tree_find(root, section, NULL);
  if (below && below->kind != STRUT_TREE_MAP) return true; /* the reader reports it */
  const strut_overlay overlay = {.arena = &document->arena, .mark = STRUT_OVERLAY_LINE};
  strut_tree inner = *value;
  strut_tree key = {.kind = STRUT_TREE_SCALAR, .place = value->place, .text = section};
  const strut_tree over = {
      .kind = STRUT_TREE_MAP, .place = value->place, .count = 1, .first = &key};
  key.next = &inner;
  inner.next = NULL;
  strut_tree *whole =
      strut_lay_over(&overlay, (strut_mapping_kind){STRUT_SECTION_SCENE, false}, root, &over);
  if (whole) document->root = whole;
  return whole != NULL;
}

static void split_notes(strut_diagnostics *from, strut_diagnostics *over) {
  size_t kept = 0;
  for (size_t i = 0; i < from->note_count; i++) {
    strut_diagnostic note = from->notes[i];
    if (note.place.line & STRUT_OVERLAY_LINE) {
      note.place.line &= ~STRUT_OVERLAY_LINE;
      strut_note(over, note.place, "%s", note.message);
    } else {
      from->notes[kept++] = note;
    }
  }
  from->note_count = kept;
}

bool strut_overlay_split(strut_diagnostics *from, strut_diagnostics *over) {
  size_t kept = 0;
  split_notes(from, over);
  for (size_t i = 0; i < from->count; i++) {
    strut_diagnostic item = from->items[i];
    if (!(item.place.line & STRUT_OVERLAY_LINE)) {
      from->items[kept++] = item;
      continue;
    }
    item.place.line &= ~STRUT_OVERLAY_LINE;
    strut_diagnose(over, item.place, "%s", item.message);
  }
  from->count = kept;
  return !over->out_of_memory;
}

/* Sections of the model that are laid over, and the keys that do so. */
static const struct {
  const char *section;
  int study, variant;
} sections[] = {{"solver", STRUT_KEY_STUDY_SOLVER, STRUT_KEY_VARIANT_SOLVER},
                {"run", STRUT_KEY_STUDY_RUN, STRUT_KEY_VARIANT_RUN},
                {"initial", STRUT_KEY_STUDY_INITIAL, STRUT_KEY_VARIANT_INITIAL},
                {"output", STRUT_KEY_STUDY_OUTPUT, STRUT_KEY_VARIANT_OUTPUT}};

/* Reads the model's file: below the folder of the study, as all files that a file names. */
static strut_status read_model(strut_study_reader *r, const strut_tree *name, strut_error *error) {
  strut_study_file *file = r->file;
  strut_safe_text text;
  const char *folder = strut_folder_of(file->path, &file->arena);
  if (!folder) return STRUT_NO_MEMORY;
  strut_status status =
      strut_safe_read(folder, file->path, name->text, STRUT_TEXT_MOST, &text, error);
  if (status == STRUT_BAD_SCENE) strut_report_error(r->reader, name->place, "%s", error->message);
  if (status) return status;
  file->model_path = text.path, file->model_text = text.text, file->model_length = text.length;
  return STRUT_OK;
}

static bool lay_over(strut_document *document, const char *section, const strut_slot *slot) {
  return slot->state != STRUT_GIVEN || lay_map_over(document, section, slot->value);
}

bool strut_study_is_its_model(const strut_study_file *file) {
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
  if (file->model_copy || !strut_scene_source_uses_files(source)) return true;
  file->model_copy = strut_tree_write(strut_scene_source_document(source)->root,
                                      "The model and the files that it uses.");
  return file->model_copy != NULL;
}

/* The text of the model as a tree, with the study's keys over it and those of a variant, or NULL. */
static strut_status open_source(strut_study_reader *r, strut_fields *top, strut_fields *variant) {
  strut_study_file *file = r->file;
  strut_scene_source **source = &file->sources[file->source_count];
  strut_status status = strut_scene_source_open(
      file->model_path, file->model_text, file->model_length, &file->model_diagnostics, source);
  if (status == STRUT_BAD_SCENE && strut_study_is_its_model(file)) {
    strut_diagnostics_free(&file->model_diagnostics);
    strut_report_error(r->reader, strut_slot_of(top, STRUT_KEY_STUDY_MODEL)->value->place,
                       "'%s' is a study, expected a model",
                       strut_sanitised_text(r->reader, file->study.model));
  }
  if (status != STRUT_OK) return status;
  file->source_count++;
  strut_document *document = strut_scene_source_document(*source);
  if (!keep_copy(file, *source)) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < sizeof sections / sizeof sections[0]; i++) {
    const char *section = sections[i].section;
    if (!lay_over(document, section, strut_slot_of(top, sections[i].study)) ||
        (variant && !lay_over(document, section, strut_slot_of(variant, sections[i].variant))))
      return STRUT_NO_MEMORY;
  }
  return STRUT_OK;
}

/* Names stand in the table, as texts of axes do. */
static void check_name(strut_study_reader *r, const strut_tree *key) {
  strut_read_name(r->reader, key, "variant");
  if (strlen(key->text) >= 24)
    strut_report_error(r->reader, key->place,
                       "names of variants may have at most 23 bytes, found %zu", strlen(key->text));
}

static strut_status open_variants(strut_study_reader *r, strut_fields *top,
                                  const strut_tree *variants) {
  strut_status status = STRUT_OK;
  for (const strut_tree *key = variants->first; key && status == STRUT_OK; key = key->next->next) {
    strut_fields fields;
    strut_owner owner = {"variant", key->text};
    check_name(r, key);
    strut_read_fields(r->reader, STRUT_SECTION_VARIANT, key->next, owner, &fields);
    r->variant_names[r->variant_count++] = key->text;
    status = open_source(r, top, &fields);
  }
  return status;
}

strut_status strut_study_open_sources(strut_study_reader *r, strut_fields *top,
                                      strut_error *error) {
  strut_study_file *file = r->file;
  const strut_slot *model = strut_slot_of(top, STRUT_KEY_STUDY_MODEL);
  const strut_slot *variants = strut_slot_of(top, STRUT_KEY_STUDY_VARIANTS);
  size_t count = variants->state == STRUT_GIVEN ? variants->value->count : 0;
  if (variants->state == STRUT_GIVEN && !count)
    strut_report_error(r->reader, variants->value->place, "there are no variants in 'variants'");
  if (model->state != STRUT_GIVEN) return STRUT_BAD_SCENE;
  file->study.model = model->value->text;
  strut_status status = read_model(r, model->value, error);
  if (status != STRUT_OK) return status;
  file->sources = strut_reader_allocate(r->reader, &file->arena, count + 1, sizeof *file->sources);
  r->variant_names =
      strut_reader_allocate(r->reader, &file->arena, count + 1, sizeof *r->variant_names);
  if (!file->sources || !r->variant_names) return STRUT_NO_MEMORY;
  status = count ? open_variants(r, top, variants->value) : open_source(r, top, NULL);
  if (status == STRUT_OK)
    r->declared = strut_scene_source_parameters(file->sources[0], &r->declared_count);
  return status;
}
