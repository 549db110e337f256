/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The word of an orbit: its touchdowns, slips and other events in their order. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/run/follow/follow_parts.h"

/* Modes that last for less than this part of a period are rounding. */
static const double INSTANT = 1e-12;
enum { MOST_TEXT = 400 };

bool strut_follow_word_read(const strut_follow_system *system, strut_arena *arena,
                            strut_follow_word *word) {
  const strut_event_log *log = system->log;
  double span = system->period * system->how.repeats, begin = system->map[0].time;
  word->count = 0;
  word->first = log->first;
  int32_t *latest;
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(word->letter, log->count + 1),
                      STRUT_NEW(latest, log->items + 1)) ||
      !STRUT_DUPLICATE(arena, STRUT_NEW(word->first, log->items + 1)))
    return false;
  for (size_t i = 0; i < log->count; i++) {
    const strut_logged_event *event = &log->event[i];
    double time = (event->time - begin) / span;
    int32_t before = latest[event->item] - 1; /* index of the item's latest letter */
    if (before >= 0 && time - word->letter[before].time <= INSTANT) {
      word->letter[before].mode = event->mode; /* two changes at once are one */
      continue;
    }
    word->letter[word->count++] = (strut_follow_letter){event->item, event->mode, time, 1.0};
    latest[event->item] = (int32_t)word->count;
  }
  /* changes at once that cancel */
  size_t kept = 0;
  for (int32_t i = 0; i < log->items; i++) latest[i] = 0;
  for (size_t i = 0; i < word->count; i++) {
    strut_follow_letter l = word->letter[i];
    int8_t mode = latest[l.item] ? word->letter[latest[l.item] - 1].mode : word->first[l.item];
    if (l.mode == mode) continue;
    if (latest[l.item]) {
      strut_follow_letter *letter = &word->letter[latest[l.item] - 1];
      letter->lasts = l.time - letter->time;
    }
    word->letter[kept++] = l;
    latest[l.item] = (int32_t)kept;
  }
  word->count = kept;
  /* the last mode of an item lasts into the next period */
  for (size_t i = 0; i < word->count; i++) {
    strut_follow_letter *follow_letter = &word->letter[i];
    if (latest[follow_letter->item] == 0) continue;
    strut_follow_letter *end = &word->letter[latest[follow_letter->item] - 1];
    end->lasts = follow_letter->time + 1.0 - end->time;
    latest[follow_letter->item] = 0;
  }
  return true;
}

static bool same_letter(const strut_follow_word *first, size_t i, const strut_follow_word *second,
                        size_t k) {
  return first->letter[i].item == second->letter[k].item &&
         first->letter[i].mode == second->letter[k].mode;
}

/* Words are cycles: an event may pass the start of the period. */
bool strut_follow_words_equal(const strut_follow_word *first, const strut_follow_word *second) {
  if (first->count != second->count) return false;
  size_t n = first->count;
  if (n == 0) return true;
  size_t most = n < 8 ? n : 8;
  for (size_t turn = 0; turn < 2 * most - 1; turn++) {
    size_t by = turn % 2 ? n - (turn + 1) / 2 : turn / 2, i = 0;
    while (i < n && same_letter(first, i, second, (i + by) % n)) i++;
    if (i == n) return true;
  }
  return false;
}

/* ---- what a change is ---- */

static const char *item_name(const strut_follow_system *system, int32_t item) {
  const strut_scene *scene = &system->setup.scene;
  const strut_model *model = system->model;
  const strut_event_log *log = system->log;
  if (item < log->contacts) return scene->nodes[model->contacts.entry[item].node].name;
  item -= log->contacts;
  if (item < log->members)
    return (size_t)item < scene->member_count ? scene->members[item].name : "";
  item -= log->members;
  if (log->elements) item %= log->elements;
  const strut_element *element = &model->elements.element[item];
  if (element->role == STRUT_ELEMENT_MEMBER) return scene->members[element->item].name;
  if (element->role == STRUT_ELEMENT_HINGE) return scene->hinges[element->item].name;
  if (element->role == STRUT_ELEMENT_CELL) return scene->cells[element->item].name;
  return "a collision";
}

static size_t count_of(const strut_follow_word *word, int32_t item) {
  size_t count = 0;
  for (size_t i = 0; i < word->count; i++) count += word->letter[i].item == item;
  return count;
}

/* The modes of an item around the period, equal up to their begin? */
static bool same_cycle(const strut_follow_word *first, const strut_follow_word *second,
                       int32_t item) {
  size_t n = count_of(first, item), k = 0;
  int8_t mode[2][64];
  if (n != count_of(second, item) || n > 64) return n == count_of(second, item) && n > 64;
  for (size_t i = 0; i < first->count; i++)
    if (first->letter[i].item == item) mode[0][k++] = first->letter[i].mode;
  k = 0;
  for (size_t i = 0; i < second->count; i++)
    if (second->letter[i].item == item) mode[1][k++] = second->letter[i].mode;
  if (n == 0) return first->first[item] == second->first[item];
  for (size_t turn = 0; turn < n; turn++) {
    size_t i = 0;
    while (i < n && mode[0][i] == mode[1][(i + turn) % n]) i++;
    if (i == n) return true;
  }
  return false;
}

/* The shortest mode of the item. */
static const strut_follow_letter *shortest(const strut_follow_word *word, int32_t item) {
  const strut_follow_letter *best = NULL;
  for (size_t i = 0; i < word->count; i++)
    if (word->letter[i].item == item && (!best || word->letter[i].lasts < best->lasts))
      best = &word->letter[i];
  return best;
}

static strut_follow_kind kind_of(const strut_follow_system *system,
                                 const strut_follow_letter *letter, bool only_touch) {
  if (letter->item >= system->log->contacts) return STRUT_FOLLOW_SWITCH;
  switch ((strut_logged_contact)letter->mode) {
    case STRUT_LOGGED_OPEN: return STRUT_FOLLOW_LIFT;
    case STRUT_LOGGED_STICK: return STRUT_FOLLOW_STICK;
    case STRUT_LOGGED_SLIDE: return STRUT_FOLLOW_TOUCH;
    case STRUT_LOGGED_FORWARD:
    case STRUT_LOGGED_BACKWARD: return only_touch ? STRUT_FOLLOW_TOUCH : STRUT_FOLLOW_SLIP;
  }
  return STRUT_FOLLOW_SWITCH;
}

/* The mode of the same item before or behind a letter, around the period; -1: there is no other. */
static int neighbour(const strut_follow_word *word, const strut_follow_letter *letter,
                     bool behind) {
  size_t at = (size_t)(letter - word->letter);
  for (size_t k = 1; k < word->count; k++) {
    const strut_follow_letter *other =
        &word->letter[(at + (behind ? k : word->count - k)) % word->count];
    if (other->item == letter->item) return other->mode;
  }
  return -1;
}

/* A sentence on what begins or ceases for a moment. */
static const char *sentence(strut_follow_kind kind, bool begins, const char *name,
                            strut_arena *arena) {
  static const char *const what[STRUT_FOLLOW_KINDS][2] = {
      [STRUT_FOLLOW_TOUCH] = {"touches it once more", "touch the ground once more"},
      [STRUT_FOLLOW_LIFT] = {"leaves the ground for a moment", "leave the ground for a moment"},
      [STRUT_FOLLOW_STICK] = {"sticks for a moment", "stick for a moment"},
      [STRUT_FOLLOW_SLIP] = {"slips for a moment", "slip for a moment"},
      [STRUT_FOLLOW_SWITCH] = {"changes its mode for a moment", "change its mode for a moment"}};
  return strut_arena_format(arena, "%s %s %s", name, begins ? "begins to" : "no longer",
                            what[kind][begins]);
}

static bool compare_orders(const strut_follow_system *system, const strut_follow_word *first,
                           const strut_follow_word *second, strut_arena *arena,
                           strut_follow_point *point) {
  int32_t pair[2] = {-1, -1};
  for (size_t i = 0; i < first->count && i < second->count; i++) {
    if (same_letter(first, i, second, i)) continue;
    pair[0] = first->letter[i].item, pair[1] = second->letter[i].item;
    break;
  }
  point->kind = STRUT_FOLLOW_MEETING;
  point->node = pair[0] >= 0 ? strut_arena_format(arena, "%s", item_name(system, pair[0])) : NULL;
  point->detail = pair[0] >= 0 && pair[1] != pair[0]
                      ? strut_arena_format(arena, "events of %s and %s change their order",
                                           item_name(system, pair[0]), item_name(system, pair[1]))
                      : strut_arena_format(arena, "events change their order");
  return point->detail != NULL;
}

bool strut_follow_words_compare(const strut_follow_system *system, const strut_follow_word *first,
                                const strut_follow_word *second, strut_arena *arena,
                                strut_follow_point *point) {
  for (int32_t item = 0; item < system->log->items; item++) {
    if (same_cycle(first, second, item)) continue;
    bool begins = count_of(second, item) >= count_of(first, item);
    const strut_follow_word *longer = begins ? second : first;
    const strut_follow_letter *letter = shortest(longer, item);
    if (!letter) continue;
    bool touch = letter->item < system->log->contacts && letter->mode != STRUT_LOGGED_OPEN &&
                 neighbour(longer, letter, false) == STRUT_LOGGED_OPEN &&
                 neighbour(longer, letter, true) == STRUT_LOGGED_OPEN;
    point->kind = kind_of(system, letter, touch);
    if (touch) point->kind = STRUT_FOLLOW_TOUCH;
    point->node = strut_arena_format(arena, "%s", item_name(system, item));
    if (count_of(first, item) == count_of(second, item))
      point->detail =
          strut_arena_format(arena, "%s replaces one short mode by another", point->node);
    else
      point->detail = sentence(point->kind, begins, point->node, arena);
    return point->node && point->detail;
  }
  return compare_orders(system, first, second, arena, point);
}

static char sign_of(const strut_follow_system *system, const strut_follow_letter *letter) {
  static const char signs[] = {[STRUT_LOGGED_OPEN] = '^',
                               [STRUT_LOGGED_SLIDE] = '_',
                               [STRUT_LOGGED_FORWARD] = '>',
                               [STRUT_LOGGED_BACKWARD] = '<',
                               [STRUT_LOGGED_STICK] = '='};
  if (letter->item >= system->log->contacts) return letter->mode > 0 ? '*' : 'o';
  return signs[letter->mode];
}

const char *strut_follow_word_text(const strut_follow_system *system, const strut_follow_word *word,
                                   strut_arena *arena) {
  char text[MOST_TEXT];
  size_t used = 0;
  text[0] = '\0';
  for (size_t i = 0; i < word->count; i++) {
    char one[80];
    int n = snprintf(one, sizeof one, "%s%.60s%c", i ? " " : "",
                     item_name(system, word->letter[i].item), sign_of(system, &word->letter[i]));
    if (used + (size_t)n + 5 >= sizeof text) {
      memcpy(text + used, " ...", 5);
      break;
    }
    memcpy(text + used, one, (size_t)n + 1);
    used += (size_t)n;
  }
  return strut_arena_text(arena, text, strlen(text));
}
