/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

#include "engine/base/vec.h"
#include "engine/model/elements.h"
#include "engine/run/measure/quantities.h"

/* Rounding of positions, relative to the lengths that forces compare; and of sums over many steps. */
static const double POSITION_ROUNDING = 1e-12, SUM_ROUNDING = 1e-10;

static bool has_powers(const strut_observable *o, int kg, int m, int s, int angle) {
  return o->kg == kg && o->m == m && o->s == s && o->angle == angle;
}

/* Angles continue over whole turns; what is left of one does not turn. */
static bool is_angle(const strut_observable *o) {
  return has_powers(o, 0, 0, 0, 1) && o != strut_observable_at(STRUT_COLUMN_HINGE_PLASTIC);
}

static bool is_speed(const strut_observable *o) {
  return has_powers(o, 0, 1, -1, 0) || has_powers(o, 0, 0, -1, 1);
}

bool strut_columns_create(const strut_model *model, size_t most, strut_arena *arena,
                          strut_columns *c) {
  *c = (strut_columns){.needs = 1u << STRUT_OBSERVED_DRIVES};
  c->column = strut_arena_allocate(arena, most, sizeof *c->column);
  c->observe = strut_arena_allocate(arena, most, sizeof *c->observe);
  c->value = strut_arena_allocate(arena, most, sizeof *c->value);
  c->least = strut_arena_allocate(arena, most, sizeof *c->least);
  c->most = strut_arena_allocate(arena, most, sizeof *c->most);
  c->largest = strut_arena_allocate(arena, most, sizeof *c->largest);
  c->branch = strut_arena_allocate(arena, most, sizeof *c->branch);
  return c->column && c->observe && c->value && c->least && c->most && c->largest && c->branch &&
         strut_instant_create(model, arena, &c->instant);
}

size_t strut_columns_add(strut_columns *c, strut_column column) {
  const strut_observable *observable = strut_observable_at(column.kind);
  column = strut_column_find(c->instant.model, column, 0);
  for (size_t i = 0; i < c->count; i++) {
    const strut_column *other = &c->column[i];
    if (other->kind == column.kind && other->item == column.item && other->other == column.other)
      return i;
  }
  c->needs |= 1u << observable->need;
  c->speeds = c->speeds || is_speed(observable);
  c->observe[c->count] = strut_observe_at(column.kind);
  c->column[c->count] = column;
  return c->count++;
}

/* Computes what columns need at the state. */
static void show_state(strut_columns *c, const strut_state *state, double t) {
  strut_instant_show(&c->instant, state, c->needs, t);
  for (int32_t i = 0; c->speeds && i < c->instant.model->node_count; i++)
    c->fastest = fmax(c->fastest, hypot(state->v[2 * i], state->v[2 * i + 1]));
}

static void note_extremes(strut_columns *c, size_t i) {
  double size = c->instant.size < 0.0 ? fabs(c->value[i]) : c->instant.size;
  if (c->column[i].kind == STRUT_COLUMN_LARGEST_FORCE && c->value[i] > c->most[i])
    c->loaded = c->instant.loaded;
  c->least[i] = fmin(c->least[i], c->value[i]);
  c->most[i] = fmax(c->most[i], c->value[i]);
  c->largest[i] = fmax(c->largest[i], size);
}

/* Takes a column of the state that is shown. */
static double take(strut_columns *c, size_t i) {
  const strut_column *column = &c->column[i];
  c->instant.size = -1.0, c->instant.branch = 0;
  double value = c->observe[i](&c->instant, column->item, column->other).value;
  c->branch[i] = c->instant.branch;
  return value;
}

void strut_columns_evaluate(strut_columns *c, const strut_state *state, double t) {
  show_state(c, state, t);
  for (size_t i = 0; i < c->count; i++) {
    double last = c->value[i], now = take(c, i);
    if (is_angle(strut_observable_at(c->column[i].kind)))
      now += STRUT_TAU * round((last - now) / STRUT_TAU);
    c->value[i] = now;
    note_extremes(c, i);
  }
}

void strut_columns_begin(strut_columns *c, const strut_state *state, double t) {
  c->fastest = 0.0;
  c->loaded = -1;
  show_state(c, state, t);
  for (size_t i = 0; i < c->count; i++) {
    c->value[i] = take(c, i);
    c->least[i] = (double)INFINITY, c->most[i] = -(double)INFINITY, c->largest[i] = 0.0;
    note_extremes(c, i);
  }
}

double strut_columns_span(const strut_columns *c, size_t index) {
  bool sums = c->column[index].kind ==
              STRUT_COLUMN_TOTAL; /* the terms vary even where the total does not */
  return sums ? c->largest[index] : c->most[index] - c->least[index];
}

/* The stiffest spring of a member, or of its elements. */
static double member_stiffness(const strut_model *model, int32_t member) {
  const strut_element *e = strut_element_of_member(&model->elements, member);
  if (member < 0) return 0.0;
  double stiffest = model->members.stiffness[member];
  for (; e; e = e->sibling >= 0 ? &model->elements.element[e->sibling] : NULL)
    stiffest = fmax(stiffest, e->numbers.stiffness);
  return stiffest;
}

/* The stiffness that a force, moment or pressure follows positions with. */
static double stiffness_behind(const strut_columns *c, const strut_column *column) {
  const strut_model *model = c->instant.model;
  if (column->kind == STRUT_COLUMN_LARGEST_FORCE) return member_stiffness(model, c->loaded);
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

double strut_columns_noise(const strut_columns *c, size_t index) {
  const strut_model *model = c->instant.model;
  const strut_column *column = &c->column[index];
  const strut_observable *o = strut_observable_at(column->kind);
  bool joined = model->members.count > 0 || model->elements.count > 0;
  double length = joined ? POSITION_ROUNDING * model->size : 0.0;
  if (has_powers(o, 0, 1, 0, 0)) return fmax(length, POSITION_ROUNDING * c->largest[index]);
  if (is_angle(o)) return POSITION_ROUNDING;
  if (has_powers(o, 0, 1, -1, 0)) return SUM_ROUNDING * c->fastest;
  if (has_powers(o, 0, 0, -1, 1)) return SUM_ROUNDING * c->fastest / model->size;
  if (has_powers(o, 0, 2, 0, 0)) return length * model->size;
  if (has_powers(o, 0, 2, -1, 0)) return SUM_ROUNDING * c->fastest * model->size;
  if (has_powers(o, 1, 1, -2, 0)) return length * stiffness_behind(c, column);
  if (has_powers(o, 1, 0, -2, 0)) return length * model->size * stiffness_behind(c, column);
  bool moment = column->kind == STRUT_COLUMN_MOMENT;
  return moment ? POSITION_ROUNDING * stiffness_behind(c, column) : 0.0;
}
