/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `repeat`: how often a part is copied, and where copy k lies. See expansion.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/trig.h"
#include "parser/read/expansion.h"

static bool read_count(strut_reader *reader, const strut_tree *value, strut_owner owner,
                       int64_t *count) {
  double number;
  if (!strut_read_number(reader, value, "count", owner, STRUT_DIM_NONE, STRUT_RANGE_ANY, &number))
    return false;
  if (number >= 1.0 && number <= STRUT_MOST_COPIES && number == floor(number)) {
    *count = (int64_t)number;
    return true;
  }
  strut_report_error(
      reader, value->place,
      "the number of copies of %s must be a whole number from 1 to %.0f, found %.15g",
      strut_owner_text(reader, owner), STRUT_MOST_COPIES, number);
  return false;
}

bool strut_refuse_form(strut_reader *reader, int key, const strut_tree *value, strut_owner owner) {
  char expected[200];
  strut_report_error(reader, value->place, "expected %s for '%s' of %s, found %s",
                     strut_key_expected(key, expected, sizeof expected), strut_key_at(key)->name,
                     strut_owner_text(reader, owner), strut_found(reader, value));
  return false;
}

/* A number, or [n, m]. */
static bool read_counts(strut_reader *reader, const strut_tree *value, strut_owner owner,
                        strut_repetition *r) {
  r->numbers = 1;
  r->count[1] = 1;
  if (value->kind == STRUT_TREE_SCALAR) return read_count(reader, value, owner, &r->count[0]);
  if (value->kind != STRUT_TREE_LIST || value->count != 2)
    return strut_refuse_form(reader, STRUT_KEY_REPEAT_COUNT, value, owner);
  r->numbers = 2;
  bool fine = read_count(reader, value->first, owner, &r->count[0]);
  return read_count(reader, value->first->next, owner, &r->count[1]) && fine;
}

static bool read_steps(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                       strut_repetition *r) {
  const strut_tree *value = slot->value;
  if (slot->state != STRUT_GIVEN) return slot->state == STRUT_ABSENT;
  bool lists =
      value->kind == STRUT_TREE_LIST && value->count == 2 && value->first->kind == STRUT_TREE_LIST;
  if (lists != (r->numbers == 2)) {
    strut_report_error(reader, value->place,
                       r->numbers == 2
                           ? "a lattice has two steps, as in [[1 m, 0], [0, 1 m]], found %s"
                           : "one count has one step, as in [1 m, 0], found %s",
                       strut_found(reader, value));
    return false;
  }
  const strut_tree *item = lists ? value->first : value;
  bool fine = true;
  for (int k = 0; k < r->numbers; k++, item = item->next)
    fine = strut_read_pair(reader, item, "step", owner, STRUT_DIM_LENGTH, r->step[k]) && fine;
  return fine;
}

static bool read_next(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                      strut_repetition *r) {
  const strut_tree *value = slot->value;
  if (slot->state != STRUT_GIVEN) return slot->state == STRUT_ABSENT;
  bool list = value->kind == STRUT_TREE_LIST && value->count == 2;
  if (list != (r->numbers == 2) || (!list && value->kind != STRUT_TREE_MAP))
    return strut_refuse_form(reader, STRUT_KEY_REPEAT_NEXT, value, owner);
  r->next[0] = list ? value->first : value;
  r->next[1] = list ? value->first->next : NULL;
  return true;
}

static bool read_closed(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                        strut_repetition *r) {
  const strut_tree *value = slot->value;
  if (slot->state != STRUT_GIVEN) return slot->state == STRUT_ABSENT;
  int word = value->kind == STRUT_TREE_SCALAR ? strut_switch_find(value->text) : 1;
  r->closed = word == 1;
  r->twist = value->kind == STRUT_TREE_MAP ? value : NULL;
  if (word < 0 || value->kind == STRUT_TREE_LIST)
    return strut_refuse_form(reader, STRUT_KEY_REPEAT_CLOSED, value, owner);
  if (!r->closed || (r->numbers == 1 && r->next[0])) return true;
  strut_report_error(reader, slot->key->place,
                     r->numbers > 1 ? "a lattice cannot be closed; close a ring and repeat the ring"
                                    : "'closed' needs 'next', which says what ties a copy to the "
                                      "next one");
  return false;
}

bool strut_read_repeat(strut_reader *reader, const strut_slot *slot, const char *name,
                       strut_repetition *r) {
  char text[STRUT_LONGEST_NAME + 40];
  *r = (strut_repetition){.scale = 1.0, .count = {1, 1}};
  if (slot->state != STRUT_GIVEN) return slot->state == STRUT_ABSENT;
  snprintf(text, sizeof text, "'repeat' of '%s'", name);
  strut_owner owner = {text, NULL};
  const strut_tree *value = slot->value;
  if (value->kind != STRUT_TREE_MAP) return read_counts(reader, value, owner, r);
  strut_fields fields;
  strut_read_fields(reader, STRUT_SECTION_REPEAT, value, owner, &fields);
  strut_require(reader, &fields, owner, slot->key->place);
  const strut_slot *count = strut_slot_of(&fields, STRUT_KEY_REPEAT_COUNT);
  const strut_slot *turn = strut_slot_of(&fields, STRUT_KEY_REPEAT_TURN);
  const strut_slot *scale = strut_slot_of(&fields, STRUT_KEY_REPEAT_SCALE);
  const strut_slot *about = strut_slot_of(&fields, STRUT_KEY_REPEAT_ABOUT);
  if (fields.broken || count->state != STRUT_GIVEN) return false;
  if (!read_counts(reader, count->value, owner, r)) return false;
  bool fine = read_steps(reader, strut_slot_of(&fields, STRUT_KEY_REPEAT_STEP), owner, r);
  fine = read_next(reader, strut_slot_of(&fields, STRUT_KEY_REPEAT_NEXT), owner, r) && fine;
  fine = read_closed(reader, strut_slot_of(&fields, STRUT_KEY_REPEAT_CLOSED), owner, r) && fine;
  if (turn->state == STRUT_GIVEN) r->turn = turn->number[0];
  if (scale->state == STRUT_GIVEN) r->scale = scale->number[0];
  if (about->state == STRUT_GIVEN) memcpy(r->about, about->number, sizeof r->about);
  const strut_slot *odd = turn->key ? turn : scale->key ? scale : about;
  if (r->numbers < 2 || !odd->key) return fine;
  strut_report_error(
      reader, odd->key->place,
      "a lattice has steps only, no '%s'; place a row that turns, and repeat the row",
      odd->key->text);
  return false;
}

void strut_frame_turn(strut_frame *f, double angle) {
  double s, c;
  strut_sincos_turns(angle / STRUT_TAU, &s, &c);
  f->axes[0][0] = c, f->axes[0][1] = -s;
  f->axes[1][0] = s, f->axes[1][1] = c;
}

static double power(double base, int64_t exponent) {
  double result = 1.0;
  for (; exponent; exponent >>= 1, base *= base)
    if (exponent & 1) result *= base;
  return result;
}

static void move_point(const strut_frame *f, double point[2]) {
  point[0] *= f->scale, point[1] *= f->scale;
  strut_frame_point(f, point);
}

/* S^k, or i times one step and j times the other. */
strut_frame strut_repeated_frame(const strut_repetition *r, const int64_t number[2]) {
  strut_frame f = strut_frame_of_scene, once = strut_frame_of_scene;
  double k = (double)number[0];
  if (r->numbers == 2 || (r->turn == 0.0 && r->scale == 1.0)) {
    for (int c = 0; c < 2; c++)
      f.at[c] = k * r->step[0][c] + (r->numbers == 2 ? (double)number[1] * r->step[1][c] : 0.0);
    return f;
  }
  double s = power(r->scale, number[0]), origin[2] = {0.0, 0.0};
  strut_frame_turn(&f, k * r->turn);
  f.scale = s;
  if (r->step[0][0] == 0.0 && r->step[0][1] == 0.0) { /* `about` stays where it is */
    double away[2] = {s * r->about[0], s * r->about[1]};
    strut_frame_vector(&f, away);
    for (int c = 0; c < 2; c++) f.at[c] = r->about[c] - away[c];
    return f;
  }
  /* The images of the origin under S, S^2, S^4, ..., those of the bits of k. */
  double once_away[2] = {r->scale * r->about[0], r->scale * r->about[1]};
  strut_frame_turn(&once, r->turn);
  once.scale = r->scale;
  strut_frame_vector(&once, once_away);
  for (int c = 0; c < 2; c++) once.at[c] = r->about[c] + r->step[0][c] - once_away[c];
  for (int64_t bits = number[0], n = 1; bits; bits >>= 1, n *= 2) {
    if (bits & 1) move_point(&once, origin);
    double squared[2] = {once.at[0], once.at[1]};
    move_point(&once, squared);
    strut_frame_turn(&once, (double)(2 * n) * r->turn);
    once.scale *= once.scale;
    memcpy(once.at, squared, sizeof squared);
  }
  memcpy(f.at, origin, sizeof origin);
  return f;
}
