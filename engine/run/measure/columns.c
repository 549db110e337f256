/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

#include "engine/base/vec.h"
#include "engine/model/elements.h"
#include "engine/run/measure/quantities.h"

/* Rounding of positions, relative to the lengths that forces compare; and of sums over many steps. */
static const double POSITION_ROUNDING = 1e-12, SUM_ROUNDING = 1e-10;

static bool has_powers(const strut_observable *observable, int kg, int m, int s, int angle) {
  return observable->kg == kg && observable->m == m && observable->s == s &&
         observable->angle == angle;
}

/* Angles continue over whole turns; what is left of one does not turn. */
static bool is_angle(const strut_observable *observable) {
  return has_powers(observable, 0, 0, 0, 1) &&
         observable != strut_observable_at(STRUT_COLUMN_HINGE_PLASTIC);
}

static bool is_speed(const strut_observable *observable) {
  return has_powers(observable, 0, 1, -1, 0) || has_powers(observable, 0, 0, -1, 1);
}

bool strut_columns_create(const strut_model *model, size_t most, strut_arena *arena,
                          strut_columns *columns) {
  *columns = (strut_columns){.needs = 1u << STRUT_OBSERVED_DRIVES};
  return STRUT_NUMBERS(arena, most, &columns->value, &columns->least, &columns->most,
                       &columns->largest) &&
         STRUT_ALLOCATE(arena, STRUT_NEW(columns->column, most), STRUT_NEW(columns->observe, most),
                        STRUT_NEW(columns->branch, most)) &&
         strut_instant_create(model, arena, &columns->instant);
}

size_t strut_columns_add(strut_columns *columns, strut_column column) {
  const strut_observable *observable = strut_observable_at(column.kind);
  column = strut_column_find(columns->instant.model, column, 0);
  for (size_t i = 0; i < columns->count; i++) {
    const strut_column *other = &columns->column[i];
    if (other->kind == column.kind && other->item == column.item && other->other == column.other)
      return i;
  }
  columns->needs |= 1u << observable->need;
  columns->speeds = columns->speeds || is_speed(observable);
  columns->observe[columns->count] = strut_observe_at(column.kind);
  columns->column[columns->count] = column;
  return columns->count++;
}

/* Computes what columns need at the state. */
static void show_state(strut_columns *columns, const strut_state *state, double t) {
  strut_instant_show(&columns->instant, state, columns->needs, t);
  for (int32_t i = 0; columns->speeds && i < columns->instant.model->node_count; i++)
    columns->fastest = fmax(columns->fastest, hypot(state->v[2 * i], state->v[2 * i + 1]));
}

static void note_extremes(strut_columns *columns, size_t i) {
  double size = columns->instant.size < 0.0 ? fabs(columns->value[i]) : columns->instant.size;
  if (columns->column[i].kind == STRUT_COLUMN_LARGEST_FORCE && columns->value[i] > columns->most[i])
    columns->loaded = columns->instant.loaded;
  columns->least[i] = fmin(columns->least[i], columns->value[i]);
  columns->most[i] = fmax(columns->most[i], columns->value[i]);
  columns->largest[i] = fmax(columns->largest[i], size);
}

/* Takes a column of the state that is shown. */
static double take(strut_columns *columns, size_t i) {
  const strut_column *column = &columns->column[i];
  columns->instant.size = -1.0, columns->instant.branch = 0;
  double value = columns->observe[i](&columns->instant, column->item, column->other).value;
  columns->branch[i] = columns->instant.branch;
  return value;
}

void strut_columns_evaluate(strut_columns *columns, const strut_state *state, double t) {
  show_state(columns, state, t);
  for (size_t i = 0; i < columns->count; i++) {
    double last = columns->value[i], now = take(columns, i);
    if (is_angle(strut_observable_at(columns->column[i].kind)))
      now += STRUT_TAU * round((last - now) / STRUT_TAU);
    columns->value[i] = now;
    note_extremes(columns, i);
  }
}

void strut_columns_begin(strut_columns *columns, const strut_state *state, double t) {
  columns->fastest = 0.0;
  columns->loaded = -1;
  show_state(columns, state, t);
  for (size_t i = 0; i < columns->count; i++) {
    columns->value[i] = take(columns, i);
    columns->least[i] = (double)INFINITY, columns->most[i] = -(double)INFINITY,
    columns->largest[i] = 0.0;
    note_extremes(columns, i);
  }
}

double strut_columns_span(const strut_columns *columns, size_t index) {
  bool sums = columns->column[index].kind ==
              STRUT_COLUMN_TOTAL; /* the terms vary even where the total does not */
  return sums ? columns->largest[index] : columns->most[index] - columns->least[index];
}

/* The stiffest spring of a member, or of its elements. */
static double member_stiffness(const strut_model *model, int32_t member) {
  const strut_element *element = strut_element_of_member(&model->elements, member);
  if (member < 0) return 0.0;
  double stiffest = model->members.stiffness[member];
  for (; element;
       element = element->sibling >= 0 ? &model->elements.element[element->sibling] : NULL)
    stiffest = fmax(stiffest, element->numbers.stiffness);
  return stiffest;
}

/* The stiffness that a force, moment or pressure follows positions with. */
static double stiffness_behind(const strut_columns *columns, const strut_column *column) {
  const strut_model *model = columns->instant.model;
  if (column->kind == STRUT_COLUMN_LARGEST_FORCE) return member_stiffness(model, columns->loaded);
  switch ((int)strut_observable_at(column->kind)->owner) {
    case STRUT_OWNER_MEMBER: return member_stiffness(model, column->item);
    case STRUT_OWNER_HINGE:
    case STRUT_OWNER_CELL:
    case STRUT_OWNER_COLLISION:
    case STRUT_OWNER_DISTANCE: return model->elements.element[column->item].numbers.stiffness;
    case STRUT_OWNER_CONTACT:
      if (column->kind == STRUT_COLUMN_NORMAL && column->item < column->other)
        return model->contacts.entry[column->item].stiffness;
      break;
    default: break;
  }
  return 0.0;
}

double strut_columns_noise(const strut_columns *columns, size_t index) {
  const strut_model *model = columns->instant.model;
  const strut_column *column = &columns->column[index];
  const strut_observable *observable = strut_observable_at(column->kind);
  bool joined = model->members.count > 0 || model->elements.count > 0;
  double length = joined ? POSITION_ROUNDING * model->size : 0.0;
  if (has_powers(observable, 0, 1, 0, 0))
    return fmax(length, POSITION_ROUNDING * columns->largest[index]);
  if (is_angle(observable)) return POSITION_ROUNDING;
  if (has_powers(observable, 0, 1, -1, 0)) return SUM_ROUNDING * columns->fastest;
  if (has_powers(observable, 0, 0, -1, 1)) return SUM_ROUNDING * columns->fastest / model->size;
  if (has_powers(observable, 0, 2, 0, 0)) return length * model->size;
  if (has_powers(observable, 0, 2, -1, 0)) return SUM_ROUNDING * columns->fastest * model->size;
  if (has_powers(observable, 1, 1, -2, 0)) return length * stiffness_behind(columns, column);
  if (has_powers(observable, 1, 0, -2, 0))
    return length * model->size * stiffness_behind(columns, column);
  bool moment = column->kind == STRUT_COLUMN_MOMENT;
  return moment ? POSITION_ROUNDING * stiffness_behind(columns, column) : 0.0;
}
