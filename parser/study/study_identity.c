/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What decides a study's results, as one text. See read_study.h. */
#include <stdio.h>
#include <string.h>

#include "engine/base/number_text.h"
#include "parser/study/read_study.h"
#include "parser/write/writer.h"

static void put_number(strut_writer *w, double value) {
  char text[STRUT_NUMBER_TEXT];
  strut_number_text(value, text);
  strut_put(w, text);
  strut_put(w, " ");
}

/* Texts with their length, so that no two trees read alike. */
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
  put_number(&w, (double)study->keep);
  for (size_t i = 0; i < study->quantity_count; i++) put_word(&w, study->quantities[i]);
  put_number(&w, study->trajectories);
  put_number(&w, study->half_step);
  put_number(&w, study->check_accuracy);
  if (!w.failed) return w.text;
  strut_release(w.text);
  return NULL;
}
