/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The expressions of a search as programs of the table's columns. See study_search.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "parser/expression/expression.h"
#include "parser/study/study_search.h"
#include "parser/yaml/diagnostics.h"

typedef struct binder {
  strut_study_file *file;
  const strut_table_name *columns; /* (count) */
  size_t count;
  bool no_memory;
} binder;

static const char *column_name(const void *context, size_t i) {
  const binder *b = context;
  return i < b->count ? b->columns[i].name : NULL;
}

static size_t find_column(const binder *b, const char *name, size_t length) {
  size_t i = 0;
  while (i < b->count &&
         (strlen(b->columns[i].name) != length || memcmp(b->columns[i].name, name, length) != 0))
    i++;
  return i;
}

/* The dimension of a column, NAN where it fits any. */
static strut_dimension dimension_of(const char *unit) {
  const strut_scope none = {.unread = true};
  strut_expression_error error;
  strut_quantity q;
  char text[80];
  if (!*unit || strcmp(unit, "1") == 0) return STRUT_DIM_NONE;
  snprintf(text, sizeof text, "1 %s", unit);
  if (strut_expression_evaluate(text, &none, &q, &error) && !q.bare) return q.dimension;
  return (strut_dimension){.kg = NAN};
}

/* As strut_find_column: columns of the table are words alone; names may have dots. */
static int find(void *context, const char *kind, strut_piece owner, strut_piece field,
                strut_column *column, strut_dimension *dimension, strut_refusal *refusal) {
  binder *b = context;
  if (kind) return 0;
  const char *name = owner.length ? owner.text : field.text;
  size_t length = owner.length ? owner.length + 1 + field.length : field.length;
  size_t i = find_column(b, name, length);
  if (i < b->count && !b->columns[i].word) {
    *column = (strut_column){.item = (int32_t)i, .other = -1};
    *dimension = dimension_of(b->columns[i].unit);
    return 1;
  }
  if (i == b->count) return 0;
  snprintf(refusal->text, sizeof refusal->text, "column '%.60s' holds texts, no numbers",
           b->columns[i].name);
  return -1;
}

static int find_pair(void *context, strut_piece word, strut_piece first, strut_piece second,
                     strut_column *column, strut_dimension *dimension, strut_refusal *refusal) {
  (void)context, (void)word, (void)first, (void)second, (void)column, (void)dimension;
  (void)refusal;
  return 0;
}

static int look_up(void *context, const char *name, size_t length, strut_quantity *quantity) {
  (void)context, (void)name, (void)length, (void)quantity;
  return 0;
}

static strut_place place_of(strut_search_place place, size_t offset, size_t length) {
  return (strut_place){
      .line = place.line, .column = place.column + (uint32_t)offset, .length = length & 0xffffffu};
}

/* Compiles text[0..), which lies `offset` bytes behind the place. False where something was reported. */
static bool compile(binder *b, const char *text, size_t offset, strut_search_formula *f,
                    strut_quantity *q) {
  strut_arena *arena = &b->file->arena;
  const strut_scope scope = {.lookup = look_up, .names = column_name, .context = b};
  strut_expression_error error = {0};
  strut_compiled *program = strut_arena_allocate(arena, strlen(text) + 1, sizeof *program);
  strut_instruction *kept = strut_arena_allocate(arena, strlen(text) + 1, sizeof *kept);
  if (!program || !kept) {
    b->no_memory = true;
    return false;
  }
  strut_compiler compiler = {.column = find, .pair = find_pair, .context = b, .program = program};
  if (!strut_expression_compile(text, &scope, &compiler, q, &error)) {
    strut_diagnose(&b->file->diagnostics, place_of(f->place, offset + error.offset, error.length),
                   "in '%s' of the search: %s; 'keep' chooses the columns of the table", f->text,
                   error.message);
    return false;
  }
  for (size_t i = 0; i < compiler.length; i++) kept[i] = program[i].instruction;
  f->program =
      (strut_quantity_definition){.name = f->text,
                                  .unit = q->bare ? "1" : strut_dimension_unit(q->dimension),
                                  .length = compiler.length,
                                  .depth = compiler.depth,
                                  .program = kept};
  return true;
}

static void bind_goal(binder *b, strut_search_formula *goal) {
  strut_quantity q;
  if (!compile(b, goal->text, 0, goal, &q) || q.varies) return;
  strut_diagnose(&b->file->diagnostics, place_of(goal->place, 0, strlen(goal->text)),
                 "'%s' of the search is the same everywhere: it names no column", goal->text);
}

/* The text [from..to) without blanks about it; *from moves to its beginning. */
static char *part_of(binder *b, const char *text, size_t *from, size_t to) {
  while (*from < to && text[*from] == ' ') ++*from;
  while (to > *from && text[to - 1] == ' ') to--;
  char *part = strut_arena_text(&b->file->arena, text + *from, to - *from);
  b->no_memory = b->no_memory || !part;
  return part;
}

static void refuse(binder *b, const strut_search_condition *c, const char *why) {
  strut_diagnose(&b->file->diagnostics, place_of(c->place, 0, strlen(c->text)),
                 "'%s' of 'subject_to': %s", c->text, why);
}

/* COLUMN = WORD */
static void bind_word(binder *b, strut_search_condition *c, const char *left, const char *right) {
  c->column = find_column(b, left, strlen(left));
  c->word = right;
  if (c->column == b->count)
    refuse(b, c, "the table has no such column; 'keep' chooses the columns");
  else if (!b->columns[c->column].word)
    refuse(b, c, "numbers are compared by <, <=, > or >=");
  else if (!*right)
    refuse(b, c, "the word is missing");
}

static void bind_numbers(binder *b, strut_search_condition *c, const char *left, const char *right,
                         size_t offset) {
  strut_quantity l, r;
  c->right = c->left;
  bool fine = compile(b, left, 0, &c->left, &l);
  fine = compile(b, right, offset, &c->right, &r) && fine;
  if (!fine) return;
  if (!l.varies && !r.varies) refuse(b, c, "neither side names a column");
  if (!l.bare && !r.bare && !strut_dimension_equal(l.dimension, r.dimension)) {
    char first[80], second[80], why[200];
    snprintf(why, sizeof why, "%s cannot be compared with %s",
             strut_dimension_name(l.dimension, first, sizeof first),
             strut_dimension_name(r.dimension, second, sizeof second));
    refuse(b, c, why);
  }
}

static void bind_condition(binder *b, strut_search_condition *c) {
  size_t at = strcspn(c->text, "<>=!"), behind = at + strspn(c->text + at, "<>=!"), from = 0;
  size_t sign = behind - at;
  const char *text = c->text;
  bool below = sign && text[at] == '<', above = sign && text[at] == '>';
  bool is = sign == 1 && text[at] == '=', is_not = sign == 2 && memcmp(text + at, "!=", 2) == 0;
  bool known =
      is || is_not || ((below || above) && (sign == 1 || (sign == 2 && text[at + 1] == '=')));
  char *left = part_of(b, text, &from, at);
  char *right = part_of(b, text, &behind, strlen(text));
  if (!left || !right) return;
  if (!known || strcspn(right, "<>=!") < strlen(right)) {
    refuse(b, c, "expected one comparison, such as work < 2 mJ or outcome = I");
    return;
  }
  c->relation = below    ? STRUT_SEARCH_BELOW
                : above  ? STRUT_SEARCH_ABOVE
                : is_not ? STRUT_SEARCH_IS_NOT
                         : STRUT_SEARCH_IS;
  if (is || is_not)
    bind_word(b, c, left, right);
  else
    bind_numbers(b, c, left, right, behind);
}

strut_status strut_study_search_bind(strut_study_file *file, const strut_table_name *columns,
                                     size_t count) {
  binder b = {.file = file, .columns = columns, .count = count};
  strut_study_search *search = file->study.search;
  size_t before = file->diagnostics.count;
  strut_c_locale locale = strut_c_locale_enter();
  bind_goal(&b, &search->goal);
  if (search->second.text) bind_goal(&b, &search->second);
  for (size_t i = 0; i < search->condition_count; i++) bind_condition(&b, &search->conditions[i]);
  strut_c_locale_leave(locale);
  if (b.no_memory) return STRUT_NO_MEMORY;
  return file->diagnostics.count > before ? STRUT_BAD_SCENE : STRUT_OK;
}
