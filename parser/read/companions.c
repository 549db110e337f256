/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keys that mean nothing without another one. See reader.h. */
#include <stdio.h>
#include <string.h>

#include "parser/read/overlay.h"
#include "parser/read/reader.h"

/* `key` has a meaning beside `other`, if that is a word beside one of `words`; or by another row of `key`. */
typedef struct companion {
  int key, other; /* of the same mapping, or of the one around it */
  const char *words;
} companion;

#define WITH(section, key, around, other, words)                                                   \
  { STRUT_KEY_##section##_##key, STRUT_KEY_##around##_##other, words }
#define BESIDE(section, key, other) WITH(section, key, section, other, "")
#define OF_FIGURE(key, kinds) WITH(FIGURE, key, FIGURE, KIND, kinds)
#define OF_STUDY(key, computed) WITH(STUDY, key, STUDY, COMPUTE, computed)

static const companion companions[] = {
    BESIDE(MEMBER, GUIDE_SIDE, GUIDE_RADIUS),
    WITH(GAS, EXPONENT, GAS, KIND, "isentropic"),
    BESIDE(CELL, REST_AREA, STIFFNESS),
    BESIDE(CELL, REST_AREA, LAW),
    BESIDE(DISTANCE, REST_DISTANCE, STIFFNESS),
    BESIDE(DISTANCE, REST_DISTANCE, LAW),
    WITH(LAW, SMOOTH, LAW, KIND, "table"),
    WITH(LAW, MIRRORED, LAW, KIND, "table|curve"),
    WITH(LAW, ROUNDING, LAW, KIND, "curve"),
    WITH(GROUND, DAMPING, GROUND, DAMPING_LAW, "approach_only"),
    WITH(GROUND, DISSIPATION, GROUND, DAMPING_LAW, "hunt_crossley"),
    WITH(CONTACT, DAMPING, GROUND, DAMPING_LAW, "approach_only"),
    WITH(CONTACT, DISSIPATION, GROUND, DAMPING_LAW, "hunt_crossley"),
    BESIDE(SENSOR, ALONG, POSITION),
    BESIDE(SENSOR, ALONG, VELOCITY),
    BESIDE(OSCILLATOR, BIAS, COUPLING),
    BESIDE(REPEAT, ABOUT, TURN),
    BESIDE(REPEAT, ABOUT, SCALE),
    BESIDE(RUN, OF, PERIODS),
    WITH(QUANTITY, TARGET, QUANTITY, TAKE, "arrival"),
    OF_STUDY(LOWEST, "equilibria|modes"),
    OF_STUDY(AT, "modes|rigidity|path"),
    OF_STUDY(PATH, "path"),
    OF_STUDY(FORM, "form"),
    OF_STUDY(CHECK, "run"),
    OF_STUDY(TRAJECTORIES, "run"),
    OF_STUDY(STIFFNESS_AT, "modes"),
    OF_STUDY(SHAPE, "run|equilibria|modes"),
    OF_STUDY(LIKE, "run|equilibria|modes"),
    OF_STUDY(CURVE, "path"),
    OF_FIGURE(AT_X, "lines|map|motion|points"),
    OF_FIGURE(AT_Y, "lines|map|motion|points"),
    OF_FIGURE(SERIES, "lines|motion|best"),
    OF_FIGURE(COLOR, "map|points"),
    OF_FIGURE(PANELS, "lines|map|motion|best"),
    OF_FIGURE(BAND, "lines|motion"),
    OF_FIGURE(FROM, "motion"),
    OF_FIGURE(TO, "motion"),
    OF_FIGURE(SCALE, "period"),
    OF_FIGURE(TIMES, "snapshots"),
    OF_FIGURE(X_LABEL, "lines|map|motion|best|points"),
    OF_FIGURE(Y_LABEL, "lines|map|motion|best|points"),
    OF_FIGURE(X_LIMITS, "lines|map|motion|best|points"),
    OF_FIGURE(Y_LIMITS, "lines|map|motion|best|points"),
    OF_FIGURE(COLORS, "map|points"),
    WITH(SEARCH, SEED, SEARCH, METHOD,
         "multistart|crs2|isres|cobyla|bobyqa|sbplx|neldermead|cma|nsga2")};

enum { COMPANIONS = sizeof companions / sizeof companions[0] };

bool strut_same_layer(const strut_tree *a, const strut_tree *b) {
  return a->place.file == b->place.file && (a->place.line ^ b->place.line) < STRUT_OVERLAY_LINE;
}

/* The slot of the key that `c` wants, in the mapping or around it; NULL: it is not known there. */
static const strut_slot *find_other(strut_fields *fields, const companion *c) {
  strut_section section = strut_key_at(c->other)->section;
  while (fields && fields->section != section) fields = fields->outer;
  return fields ? strut_slot_of(fields, c->other) : NULL;
}

static bool is_met(const companion *c, const strut_slot *other) {
  if (!other || other->state == STRUT_BROKEN) return true;
  if (!*c->words) return other->state == STRUT_GIVEN;
  const strut_key *key = strut_key_at(c->other);
  char word[40];
  if (other->state == STRUT_ABSENT) return strut_word_find(c->words, key->fallback) >= 0;
  return strut_word_at(key->words, other->word, word, sizeof word) &&
         strut_word_find(c->words, word) >= 0;
}

/* "'law: smooth' or 'law: stribeck'": all rows from the first to before `end`. */
static const char *wanted_text(const companion *first, const companion *end, char *text,
                               size_t size) {
  size_t used = 0;
  text[0] = '\0';
  for (const companion *c = first; c < end; c++) {
    const char *name = strut_key_at(c->other)->name;
    char word[40] = "";
    for (int i = 0;
         used < size && (strut_word_at(c->words, i, word, sizeof word) || (!*c->words && i == 0));
         i++)
      used += (size_t)snprintf(text + used, size - used, "%s'%s%s%s'", used ? " or " : "", name,
                               *word ? ": " : "", word);
  }
  return text;
}

bool strut_check_companions(strut_reader *reader, strut_fields *fields, strut_owner owner) {
  bool fine = true;
  for (const companion *c = companions, *end; c < companions + COMPANIONS; c = end) {
    end = c + 1;
    while (end < companions + COMPANIONS && end->key == c->key) end++;
    if (strut_key_at(c->key)->section != fields->section) continue;
    strut_slot *slot = strut_slot_of(fields, c->key);
    const strut_slot *other = NULL;
    bool met = slot->state != STRUT_GIVEN;
    for (const companion *row = c; row < end && !met; row++)
      met = is_met(row, other = find_other(fields, row));
    if (met) continue;
    if (slot->from || (other->key && !strut_same_layer(slot->key, other->key))) {
      slot->state = STRUT_ABSENT; /* a group's is for others, a base's for its own law */
      continue;
    }
    char text[300];
    strut_report_error(reader, slot->key->place, "'%s' of %s has no meaning without %s",
                       slot->key->text, strut_owner_text(reader, owner),
                       wanted_text(c, end, text, sizeof text));
    slot->state = STRUT_BROKEN;
    fields->broken = true;
    fine = false;
  }
  return fine;
}
