/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts made of a study: a copy for another folder, and what decides its results. See read_study.h. */
#include <stdio.h>
#include <string.h>

#include "engine/base/number_text.h"
#include "parser/study/read_study.h"
#include "parser/write/writer.h"
#include "parser/yaml/text.h"

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
static void put_note(strut_writer *w, const char *what, const char *text, const char *value) {
  const char *const parts[] = {text, value ? "=" : "", value ? value : ""};
  strut_put(w, "# ");
  strut_put(w, what);
  for (int i = 0; i < 3; i++)
    for (const char *at = parts[i]; *at;) {
      size_t length = 0, left = strlen(at), end = 0;
      while (at[length] && !end)
        if ((end = strut_text_break(at + length, left - length)) == 0) length++;
      strut_put_part(w, at, length);
      if (end) strut_put(w, " ");
      at += length + end;
    }
  strut_put(w, "\n");
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

char *strut_study_copy(const strut_study_file *file, const char *model,
                       const strut_override *overrides, size_t override_count) {
  strut_writer w = {.text = NULL};
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
  if (count || override_count) strut_put(&w, "\n");
  if (node && strcmp(node->text, model) != 0)
    put_note(&w, "A copy; its model was ", node->text, NULL);
  for (size_t i = 0; i < file->table_count; i++)
    if (strcmp(file->tables[i].node->text, file->tables[i].copy) != 0)
      put_note(&w, "A copy; a file of points was ", file->tables[i].node->text, NULL);
  for (size_t i = 0; i < override_count; i++)
    put_note(&w, "It was run with --set ", overrides[i].name, overrides[i].value);
  if (!w.failed) return w.text;
  strut_release(w.text);
  return NULL;
}

static void put_number(strut_writer *w, double value) {
  char text[STRUT_NUMBER_TEXT];
  strut_number_text(value, text);
  strut_put(w, text);
  strut_put(w, " ");
}

/* Texts are preceded by their length, so that different trees give different texts. */
static void put_word(strut_writer *w, const char *text) {
  put_number(w, (double)strlen(text));
  strut_put(w, text);
  strut_put(w, "\n");
}

static void put_tree(strut_writer *w, const strut_tree *node) {
  static const char *const kinds[] = {"scalar", "list", "map"};
  strut_put(w, kinds[node->kind]);
  strut_put(w, node->quoted ? " quoted " : " ");
  if (node->kind == STRUT_TREE_SCALAR) {
    put_word(w, node->text);
    return;
  }
  put_number(w, (double)node->count);
  for (const strut_tree *child = node->first; child; child = child->next) put_tree(w, child);
}

static void put_axis(strut_writer *w, const strut_study_axis *axis) {
  put_number(w, (double)axis->count);
  for (size_t i = 0; i < axis->column_count; i++) {
    const strut_study_column *c = &axis->columns[i];
    put_word(w, c->name);
    put_word(w, c->unit);
    put_number(w, (double)c->kind);
    put_number(w, c->from);
    put_number(w, c->to);
    put_number(w, c->step);
    for (int64_t k = 0; c->kind == STRUT_RANGE_LIST && k < axis->count; k++) {
      if (c->word)
        put_word(w, c->words[k]);
      else
        put_number(w, c->number[k]);
    }
  }
}

/* What is computed where it is no run. */
static void put_computed(strut_writer *w, const strut_study *study) {
  if (study->compute == STRUT_COMPUTE_RUN) return;
  put_number(w, (double)study->compute);
  put_number(w, (double)study->lowest);
  put_word(w, study->at ? study->at : "");
  put_word(w, study->path_load ? study->path_load : "");
  put_word(w, study->path_over ? study->path_over : "");
  put_number(w, study->path_from);
  put_number(w, study->path_until);
  put_word(w, study->path_from_unit ? study->path_from_unit : "");
  put_word(w, study->path_until_unit ? study->path_until_unit : "");
  put_number(w, study->path_from_given + 2 * study->path_until_given);
  put_number(w, (double)study->path_steps);
  put_number(w, (double)study->form_from);
  put_number(w, (double)study->form_objective);
  put_number(w, study->form_least_tension);
  put_number(w, study->form_least_density);
}

/* What is searched; the goal decides the column `objective`. */
static void put_search(strut_writer *w, const strut_study_search *search) {
  put_number(w, search->maximise);
  put_word(w, search->goal.text);
  if (search->second.text) put_word(w, search->second.text);
  for (size_t i = 0; i < search->condition_count; i++) put_word(w, search->conditions[i].text);
  for (size_t i = 0; i < search->variable_count; i++) {
    const strut_search_variable *v = &search->variables[i];
    put_word(w, v->name);
    put_number(w, v->from);
    put_number(w, v->to);
    put_number(w, v->start);
    put_number(w, v->logarithmic + 2 * v->wraps + 4 * v->integer);
    for (size_t k = 0; k < v->choice_count; k++) {
      if (v->word)
        put_word(w, v->words[k]);
      else
        put_number(w, v->numbers[k]);
    }
  }
  put_number(w, (double)search->method);
  put_number(w, (double)search->starts);
  put_number(w, (double)search->evaluations);
  put_number(w, (double)search->seed);
}

/* What is followed at each point. */
static void put_follow(strut_writer *w, const strut_study_follow *f) {
  put_word(w, f->over);
  put_number(w, f->from);
  put_number(w, f->to);
  put_number(w, (double)f->at_count);
  for (size_t i = 0; i < f->at_count; i++) put_number(w, f->at[i]);
  for (size_t i = 0; i < f->start_count; i++) put_word(w, f->start_from[i]);
  put_number(w, f->accuracy);
  put_word(w, f->integrator ? f->integrator : "");
  put_number(w, (double)f->steps);
  put_number(w, f->basins);
}

char *strut_study_identity(const strut_study_file *file) {
  strut_writer w = {.text = NULL};
  const strut_study *study = &file->study;
  for (size_t i = 0; i < file->source_count; i++)
    put_tree(&w, strut_scene_source_document(file->sources[i])->root);
  for (size_t i = 0; i < file->setting_count; i++) {
    put_word(&w, file->settings[i].name);
    put_word(&w, file->settings[i].text);
  }
  for (size_t i = 0; i < study->axis_count; i++) put_axis(&w, &study->axes[i]);
  for (size_t i = 0; i < STRUT_KEEP_WORDS; i++) {
    put_number(&w, (double)(study->keep.bits[i] >> 32));
    put_number(&w, (double)(study->keep.bits[i] & UINT32_MAX));
  }
  for (size_t i = 0; i < study->quantity_count; i++) put_word(&w, study->quantities[i]);
  put_number(&w, study->trajectories);
  put_number(&w, study->half_step);
  put_number(&w, study->check_accuracy);
  put_computed(&w, study);
  if (study->refine_depth) {
    put_number(&w, (double)study->refine_depth);
    put_number(&w, study->refine_by);
    put_word(&w, study->refine_where);
  }
  if (study->search) put_search(&w, study->search);
  if (study->follow) put_follow(&w, study->follow);
  if (study->limit_evaluations) put_number(&w, (double)study->limit_evaluations);
  if (!w.failed) return w.text;
  strut_release(w.text);
  return NULL;
}
