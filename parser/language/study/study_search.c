/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a study searches: variables, scenarios, and its texts as written. See study_reader.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/text.h"
#include "parser/language/expression/expression.h"
#include "parser/language/study/read_study.h"
#include "parser/language/study/study_reader.h"
#include "parser/language/yaml/document.h"

static const strut_owner search_owner = {"the search", NULL};
/* Scenarios of one evaluation, at most. */
enum { MOST_SCENARIOS = 1000 };
/* The largest end of a logarithmic range, of the smallest. */
static const double MOST_RATIO = 1e12 * (1.0 + 1e-9);

static bool refuse(strut_study_reader *reader, const strut_study_along *along, const char *why) {
  return strut_report_error(reader->reader, along->value->place, "variable '%s' of %s %s",
                            along->parameter->name, along->of, why);
}

static bool read_choices(strut_study_reader *reader, strut_study_along *along,
                         strut_search_variable *variable) {
  if (along->value->count < 2)
    return refuse(reader, along,
                  "has no choice: list two values or more, or write its value under 'set'");
  variable->choice_count = (size_t)along->count;
  variable->numbers = along->column->number;
  variable->words = along->column->words;
  return true;
}

/* An angle that wraps must go once around. */
static bool wraps_around(const strut_study_along *along, const strut_search_variable *variable) {
  const double turn = 6.283185307179586;
  bool angle =
      !along->setting->bare && strut_dimension_equal(along->setting->dimension, STRUT_DIM_ANGLE);
  return !angle || fabs((variable->to - variable->from) / turn - 1.0) < 1e-9;
}

static bool check_range(strut_study_reader *reader, const strut_study_along *along,
                        const strut_search_variable *variable) {
  const double from = variable->from, to = variable->to;
  const bool logarithmic = variable->logarithmic;
  const struct {
    bool found;
    const char *why;
  } flaws[] = {
      {from == to, "has a range of one value: write it under 'set' of the study"},
      {from > to, "has a reversed range: 'from' must be below 'to'"},
      {!isfinite(to - from), "has too wide a range for a number"},
      {logarithmic && from * to <= 0.0,
       "cannot be logarithmic: 'from' and 'to' must be on one side of 0"},
      {logarithmic && to > MOST_RATIO * from, "has more than 12 decades in its logarithmic range"},
      {variable->wraps && (logarithmic || variable->integer),
       "cannot wrap: only even ranges of any number do"},
      {variable->wraps && !wraps_around(along, variable),
       "cannot wrap: its range is no full turn, such as 0 deg to 360 deg"},
      {variable->integer && floor(to) < ceil(from) + 1.0, "has no two whole numbers in its range"},
      {!(variable->start >= from && variable->start <= to), "has a 'start' outside of its range"}};
  for (size_t i = 0; i < sizeof flaws / sizeof flaws[0]; i++)
    if (flaws[i].found) return refuse(reader, along, flaws[i].why);
  return true;
}

static bool read_range(strut_study_reader *reader, strut_study_along *along,
                       strut_search_variable *variable) {
  strut_fields fields;
  const strut_owner owner = {"variable", along->parameter->name};
  if (along->parameter->text)
    return refuse(reader, along, "is a text: give a list of the texts to choose from");
  if (!strut_read_object(reader->reader, STRUT_SECTION_VARIABLE, along->value, owner, &fields,
                         variable))
    return false;
  const strut_slot *start = strut_slot_of(&fields, STRUT_KEY_VARIABLE_START);
  bool fine =
      strut_study_store_value(reader, along, &fields, STRUT_KEY_VARIABLE_FROM, true, variable);
  fine = strut_study_store_value(reader, along, &fields, STRUT_KEY_VARIABLE_TO, false, variable) &&
         fine;
  variable->start = variable->from + 0.5 * (variable->to - variable->from);
  if (fine && variable->logarithmic && variable->from * variable->to > 0.0)
    variable->start = copysign(sqrt(variable->from) * sqrt(variable->to), variable->from);
  fine =
      strut_study_store_value(reader, along, &fields, STRUT_KEY_VARIABLE_START, false, variable) &&
      fine;
  if (fine && variable->logarithmic && variable->from < 0.0)
    return refuse(reader, along, "cannot be logarithmic below 0: search over its negative");
  if (fine && variable->integer && start->state != STRUT_GIVEN)
    variable->start = round(variable->start);
  return fine && check_range(reader, along, variable);
}

/* A variable: its column has the value at which the search begins. */
static bool read_variable(strut_study_reader *reader, strut_study_axis *axis,
                          strut_study_along *along, strut_search_variable *variable) {
  bool fine;
  double *start = strut_study_allocate(reader, 1, sizeof *start);
  if (!start) return false;
  if (along->value->kind == STRUT_TREE_LIST) {
    fine = strut_study_read_along(reader, axis, along) && read_choices(reader, along, variable);
  } else {
    if (!strut_study_begin_along(reader, axis, along)) return false;
    fine =
        along->value->kind == STRUT_TREE_MAP
            ? read_range(reader, along, variable)
            : refuse(reader, along, "needs a range such as {from: 1, to: 2}, or a list of choices");
    *start = variable->start;
    along->column->kind = STRUT_RANGE_LIST;
    along->column->number = start;
  }
  if (!fine) return false;
  variable->name = along->parameter->name;
  variable->unit = along->column->unit;
  variable->shown = along->column->shown;
  variable->word = along->parameter->text;
  return true;
}

void strut_study_read_variables(strut_study_reader *reader, const strut_slot *over, const char *of,
                                strut_search_variable **variables, size_t *variable_count,
                                size_t *column) {
  strut_study *study = &reader->file->study;
  size_t count = over->value->count;
  strut_study_axis *axis = &study->axes[study->axis_count++];
  *axis = (strut_study_axis){.count = 1};
  axis->columns = strut_study_allocate(reader, count, sizeof *axis->columns);
  *variables = strut_study_allocate(reader, count, sizeof **variables);
  *column = reader->file->column_count;
  if (!axis->columns || !*variables) return;
  for (const strut_tree *key = over->value->first; key; key = key->next->next) {
    strut_study_along a = {.key = key, .value = key->next, .of = of};
    read_variable(reader, axis, &a, &(*variables)[(*variable_count)++]);
  }
}

/* The axes of the scenarios. */
static void read_scenarios(strut_study_reader *reader, const strut_slot *slot,
                           strut_study_search *search) {
  strut_study *study = &reader->file->study;
  double scenarios = 1.0;
  if (slot->state != STRUT_GIVEN) return;
  for (const strut_tree *key = slot->value->first; key; key = key->next->next) {
    strut_study_axis *axis = &study->axes[study->axis_count];
    *axis = (strut_study_axis){.columns = strut_study_allocate(reader, 1, sizeof *axis->columns)};
    strut_study_along a = {.key = key, .value = key->next};
    if (!axis->columns || !strut_study_read_along(reader, axis, &a)) continue;
    axis->count = a.count;
    study->axis_count++;
    scenarios *= (double)axis->count;
    search->scenario_axes++;
  }
  if (scenarios > MOST_SCENARIOS)
    strut_report_error(reader->reader, slot->value->place,
                       "'worst_over' makes %.4g scenarios, an evaluation may have %d", scenarios,
                       MOST_SCENARIOS);
}

/*
 * The axis that numbers evaluations: those of each search, then as `search` 0 the best point computed more
 * exactly, and its neighbours.
 */
static void add_evaluations(strut_study_reader *reader, const strut_study_search *search,
                            strut_study_axis *axis, size_t variables) {
  int64_t checks = 1 + 2 * (int64_t)variables;
  axis->count = search->starts * search->evaluations + checks;
  axis->column_count = 2;
  size_t count = (size_t)axis->count;
  double *numbers = strut_study_allocate(reader, 2 * count, sizeof *numbers);
  axis->columns = strut_study_allocate(reader, 2, sizeof *axis->columns);
  if (!numbers || !axis->columns) {
    axis->count = 1;
    return;
  }
  for (int64_t i = 0; i < axis->count; i++) {
    bool proper = i < search->starts * search->evaluations;
    int64_t checked = i - search->starts * search->evaluations;
    numbers[i] = proper ? (double)(i / search->evaluations + 1) : 0.0;
    numbers[axis->count + i] = proper ? (double)(i % search->evaluations + 1) : (double)checked;
  }
  axis->columns[0] = (strut_study_column){.name = "search", .unit = "1", .number = numbers};
  axis->columns[1] =
      (strut_study_column){.name = "evaluation", .unit = "1", .number = numbers + axis->count};
  reader->file->column_count += 2; /* settings without a name: no parameters */
}

static void keep_text(const strut_tree *value, strut_search_formula *formula) {
  formula->text = value->text;
  formula->place =
      (strut_search_place){value->place.line, value->place.column + (value->quoted ? 1 : 0)};
}

/* One expression, or a list of two. */
static void read_goals(strut_study_reader *reader, const strut_tree *value,
                       strut_study_search *search) {
  bool two = value->kind == STRUT_TREE_LIST && value->count == 2;
  const strut_tree *first = two ? value->first : value;
  bool fine = first->kind == STRUT_TREE_SCALAR &&
              (!two || first->next->kind == STRUT_TREE_SCALAR) && !strut_is_null(first);
  if (!fine) {
    strut_refuse_value(reader->reader, value, search->maximise ? "maximise" : "minimise",
                       search_owner,
                       "a column, an expression of columns, or a list of two of them");
    return;
  }
  keep_text(first, &search->goal);
  if (two) keep_text(first->next, &search->second);
}

static void read_goal(strut_study_reader *reader, strut_fields *fields,
                      strut_study_search *search) {
  const strut_slot *most = strut_slot_of(fields, STRUT_KEY_SEARCH_MAXIMISE);
  const strut_slot *least = strut_slot_of(fields, STRUT_KEY_SEARCH_MINIMISE);
  const strut_slot *method = strut_slot_of(fields, STRUT_KEY_SEARCH_METHOD);
  search->maximise = most->state == STRUT_GIVEN;
  const strut_slot *goal = search->maximise ? most : least;
  if (goal->state == STRUT_GIVEN) read_goals(reader, goal->value, search);
  bool two = search->second.text != NULL, given = method->state == STRUT_GIVEN;
  if (given && goal->state == STRUT_GIVEN && two != (search->method == STRUT_SEARCH_NSGA2))
    strut_report_error(reader->reader, method->value->place,
                       two ? "two goals need the method 'nsga2'"
                           : "the method 'nsga2' is for two goals: [velocity, -cost_of_transport]");
  if (two) search->method = STRUT_SEARCH_NSGA2;
}

static void read_conditions(strut_study_reader *reader, const strut_slot *slot,
                            strut_study_search *search) {
  if (slot->state != STRUT_GIVEN) return;
  search->conditions =
      strut_study_allocate(reader, slot->value->count + 1, sizeof *search->conditions);
  for (const strut_tree *item = slot->value->first; item && search->conditions; item = item->next) {
    strut_search_condition *condition = &search->conditions[search->condition_count];
    if (!strut_read_scalar(reader->reader, item, "subject_to", search_owner,
                           "a text such as \"work < 2 mJ\""))
      continue;
    search->condition_count++;
    keep_text(item, &condition->left);
    condition->text = condition->left.text;
    condition->place = condition->left.place;
  }
}

/* A method that follows derivatives takes those by its variables. */
static void choose_derivatives(strut_study_reader *reader, strut_fields *fields,
                               const strut_study_search *search) {
  strut_study *study = &reader->file->study;
  const strut_place place = strut_slot_of(fields, STRUT_KEY_SEARCH_METHOD)->value->place;
  bool smooth = !search->condition_count && !search->scenario_axes;
  study->derivative_count = 0;
  study->derivatives =
      strut_study_allocate(reader, search->variable_count, sizeof *study->derivatives);
  for (size_t i = 0; i < search->variable_count && study->derivatives; i++) {
    const strut_search_variable *variable = &search->variables[i];
    smooth = smooth && !variable->integer && !variable->choice_count;
    study->derivatives[study->derivative_count++] =
        (strut_derived_by){variable->name, variable->unit};
  }
  if (!smooth)
    strut_report_error(
        reader->reader, place,
        "'bfgs' follows derivatives by ranges of numbers, without conditions, choices, "
        "whole numbers and 'worst_over'; give another method");
}

static void refuse_trajectories(strut_study_reader *reader, const strut_slot *slot) {
  const strut_study *study = &reader->file->study;
  const strut_tree *root = reader->file->document.root;
  strut_tree *key = NULL;
  if (study->trajectories && strut_tree_find(root, "trajectories", &key))
    strut_report_error(reader->reader, key ? key->place : slot->key->place,
                       "a study that searches records no trajectories: run its best.yaml for that");
}

void strut_study_read_search(strut_study_reader *reader, const strut_slot *slot) {
  strut_study *study = &reader->file->study;
  strut_fields fields;
  if (slot->state != STRUT_GIVEN) return;
  strut_study_search *search = strut_study_allocate(reader, 1, sizeof *search);
  if (!search) return;
  *search = (strut_study_search){.starts = 1, .evaluations = 200, .seed = 1};
  strut_read_object(reader->reader, STRUT_SECTION_SEARCH, slot->value, search_owner, &fields,
                    search);
  read_goal(reader, &fields, search);
  read_conditions(reader, strut_slot_of(&fields, STRUT_KEY_SEARCH_SUBJECT_TO), search);
  refuse_trajectories(reader, slot);
  const strut_slot *over = strut_slot_of(&fields, STRUT_KEY_SEARCH_OVER);
  const strut_slot *starts = strut_slot_of(&fields, STRUT_KEY_SEARCH_STARTS);
  if (search->method == STRUT_SEARCH_DIRECT && search->starts > 1)
    strut_report_error(reader->reader, starts->value->place,
                       "'direct' has no seed, all its searches would be the same: give another "
                       "method, or no 'starts'");
  if (over->state != STRUT_GIVEN) return;
  search->axis = study->axis_count;
  strut_study_axis *evaluations = &study->axes[study->axis_count++];
  add_evaluations(reader, search, evaluations, over->value->count);
  read_scenarios(reader, strut_slot_of(&fields, STRUT_KEY_SEARCH_WORST_OVER), search);
  strut_study_read_variables(reader, over, "the search", &search->variables,
                             &search->variable_count, &search->column);
  if (search->method == STRUT_SEARCH_BFGS) choose_derivatives(reader, &fields, search);
  study->search = search;
}

/* ---- columns in expressions ---- */

typedef struct binder {
  strut_study_file *file;
  const strut_table_name *columns; /* (count) */
  size_t count;
  bool no_memory;
} binder;

static const char *column_name(const void *context, size_t i) {
  const binder *self = context;
  return i < self->count ? self->columns[i].name : NULL;
}

static size_t find_column(const binder *self, const char *name, size_t length) {
  size_t i = 0;
  while (i < self->count && (strlen(self->columns[i].name) != length ||
                             memcmp(self->columns[i].name, name, length) != 0))
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
  binder *self = context;
  if (kind) return 0;
  const char *name = owner.length ? owner.text : field.text;
  size_t length = owner.length ? owner.length + 1 + field.length : field.length;
  size_t i = find_column(self, name, length);
  if (i < self->count && !self->columns[i].word) {
    *column = (strut_column){.item = (int32_t)i, .other = -1};
    *dimension = dimension_of(self->columns[i].unit);
    return 1;
  }
  if (i == self->count) return 0;
  snprintf(refusal->text, sizeof refusal->text, "column '%.60s' holds texts, no numbers",
           self->columns[i].name);
  return -1;
}

static strut_place place_of(strut_search_place place, size_t offset, size_t length) {
  return (strut_place){
      .line = place.line, .column = place.column + (uint32_t)offset, .length = length & 0xffffffu};
}

/* "; did you mean 'drive_work'?" of the group `work` of columns, which `keep` has and the table has not, or "". */
static strut_near near_group(const binder *self, const char *text, size_t length) {
  strut_near near = {""};
  for (size_t i = 0; i < self->count && !near.text[0]; i++) {
    const char *end = strrchr(self->columns[i].name, '_');
    if (end && strlen(end + 1) == length && memcmp(end + 1, text, length) == 0)
      snprintf(near.text, sizeof near.text, "; did you mean '%.60s'?", self->columns[i].name);
  }
  return near;
}

/* Compiles text[0..), which lies `offset` bytes behind the place. False where something was reported. */
static bool compile(binder *self, const char *text, size_t offset, strut_search_formula *formula,
                    strut_quantity *quantity) {
  strut_arena *arena = &self->file->arena;
  const strut_scope scope = {.names = column_name, .context = self};
  strut_expression_error error = {0};
  strut_compiled *program = strut_arena_allocate(arena, strlen(text) + 1, sizeof *program);
  strut_instruction *kept = strut_arena_allocate(arena, strlen(text) + 1, sizeof *kept);
  if (!program || !kept) {
    self->no_memory = true;
    return false;
  }
  strut_compiler compiler = {.column = find, .context = self, .program = program};
  if (!strut_expression_compile(text, &scope, &compiler, quantity, &error)) {
    strut_diagnose(
        &self->file->diagnostics, place_of(formula->place, offset + error.offset, error.length),
        "in '%s' of the search: %s%s%s", formula->text, error.message,
        strstr(error.message, "unknown") ? "; 'keep' chooses the columns of the table" : "",
        near_group(self, text + error.offset, error.length).text);
    return false;
  }
  for (size_t i = 0; i < compiler.length; i++) kept[i] = program[i].instruction;
  formula->program = (strut_quantity_definition){
      .name = formula->text,
      .unit = quantity->bare ? "1" : strut_dimension_unit(quantity->dimension),
      .length = compiler.length,
      .depth = compiler.depth,
      .program = kept};
  return true;
}

static void bind_goal(binder *self, strut_search_formula *goal) {
  strut_quantity q;
  if (!compile(self, goal->text, 0, goal, &q) || q.varies) return;
  strut_diagnose(&self->file->diagnostics, place_of(goal->place, 0, strlen(goal->text)),
                 "'%s' of the search is the same everywhere: it names no column", goal->text);
}

/* The text [from..to) without blanks about it; *from moves to its beginning. */
static char *part_of(binder *self, const char *text, size_t *from, size_t to) {
  while (*from < to && text[*from] == ' ') ++*from;
  while (to > *from && text[to - 1] == ' ') to--;
  char *part = strut_arena_text(&self->file->arena, text + *from, to - *from);
  self->no_memory = self->no_memory || !part;
  return part;
}

static void refuse_condition(binder *self, const strut_search_condition *condition,
                             const char *why) {
  strut_diagnose(&self->file->diagnostics, place_of(condition->place, 0, strlen(condition->text)),
                 "'%s' of 'subject_to': %s", condition->text, why);
}

/* COLUMN = WORD */
static void bind_word(binder *self, strut_search_condition *condition, const char *left,
                      const char *right) {
  condition->column = find_column(self, left, strlen(left));
  condition->word = right;
  if (condition->column == self->count)
    refuse_condition(self, condition, "the table has no such column; 'keep' chooses the columns");
  else if (!self->columns[condition->column].word)
    refuse_condition(self, condition, "numbers are compared by <, <=, > or >=");
  else if (!*right)
    refuse_condition(self, condition, "the word is missing");
}

static void bind_numbers(binder *self, strut_search_condition *condition, const char *left,
                         const char *right, size_t offset) {
  strut_quantity l, r;
  condition->right = condition->left;
  bool fine = compile(self, left, 0, &condition->left, &l);
  fine = compile(self, right, offset, &condition->right, &r) && fine;
  if (!fine) return;
  if (!l.varies && !r.varies) refuse_condition(self, condition, "neither side names a column");
  if (!l.bare && !r.bare && !strut_dimension_equal(l.dimension, r.dimension)) {
    char first[80], second[80], why[200];
    snprintf(why, sizeof why, "%s cannot be compared with %s",
             strut_dimension_name(l.dimension, first, sizeof first),
             strut_dimension_name(r.dimension, second, sizeof second));
    refuse_condition(self, condition, why);
  }
}

static void bind_condition(binder *self, strut_search_condition *condition) {
  size_t at = strcspn(condition->text, "<>=!"), behind = at + strspn(condition->text + at, "<>=!"),
         from = 0;
  size_t sign = behind - at;
  const char *text = condition->text;
  bool below = sign && text[at] == '<', above = sign && text[at] == '>';
  bool is = sign == 1 && text[at] == '=', is_not = sign == 2 && memcmp(text + at, "!=", 2) == 0;
  bool known =
      is || is_not || ((below || above) && (sign == 1 || (sign == 2 && text[at + 1] == '=')));
  char *left = part_of(self, text, &from, at);
  char *right = part_of(self, text, &behind, strlen(text));
  if (!left || !right) return;
  if (!known || strcspn(right, "<>=!") < strlen(right)) {
    refuse_condition(self, condition,
                     "expected one comparison, such as work < 2 mJ or outcome = I");
    return;
  }
  condition->relation = below    ? STRUT_SEARCH_BELOW
                        : above  ? STRUT_SEARCH_ABOVE
                        : is_not ? STRUT_SEARCH_IS_NOT
                                 : STRUT_SEARCH_IS;
  if (is || is_not)
    bind_word(self, condition, left, right);
  else
    bind_numbers(self, condition, left, right, behind);
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
