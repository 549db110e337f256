/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keys that mean nothing without another one. See reader.h. */
#include "parser/language/read/reader.h"
#include "parser/language/read/reuse/overlay.h"

/* `key` has a meaning beside one of `words`: of the key `other`, in the mapping or the one around it; -1: keys. */
typedef struct companion {
  int key, other;
  const char *words;
} companion;

#define WITH(section, key, around, other, words)                                                   \
  { STRUT_KEY_##section##_##key, STRUT_KEY_##around##_##other, words }
#define BESIDE(section, key, keys)                                                                 \
  { STRUT_KEY_##section##_##key, -1, keys }
#define OF_FIGURE(key, kinds) WITH(FIGURE, key, FIGURE, KIND, kinds)
#define OF_STUDY(section, key, computed) WITH(section, key, STUDY, COMPUTE, computed)

static const companion companions[] = {
    BESIDE(MEMBER, GUIDE_SIDE, "guide_radius"),
    WITH(GAS, EXPONENT, GAS, KIND, "isentropic"),
    BESIDE(CELL, REST_AREA, "stiffness|law"),
    BESIDE(DISTANCE, REST_DISTANCE, "stiffness|law"),
    WITH(LAW, SMOOTH, LAW, KIND, "table"),
    WITH(LAW, MIRRORED, LAW, KIND, "table|curve"),
    WITH(LAW, ROUNDING, LAW, KIND, "curve"),
    WITH(LAW, DATA, LAW, KIND, "table"),
    BESIDE(LAW, OVER, "data"),
    BESIDE(SIGNAL, OVER, "data"),
    BESIDE(SIGNAL, INTERPOLATION, "data"),
    BESIDE(SIGNAL, OUTSIDE, "data"),
    BESIDE(SENSOR, ALONG, "position|velocity"),
    BESIDE(OSCILLATOR, BIAS, "coupling"),
    BESIDE(REPEAT, ABOUT, "turn|scale"),
    BESIDE(RUN, OF, "periods"),
    BESIDE(RUBBING, MU_STATIC, "decay_velocity"),
    BESIDE(RUBBING, DECAY_VELOCITY, "mu_static"),
    WITH(QUANTITY, TARGET, QUANTITY, TAKE, "arrival"),
    OF_STUDY(STUDY, LOWEST, "equilibria|modes"),
    OF_STUDY(STUDY, AT, "modes|rigidity|path"),
    OF_STUDY(STUDY, PATH, "path"),
    OF_STUDY(STUDY, FORM, "form"),
    OF_STUDY(STUDY, CHECK, "run"),
    OF_STUDY(STUDY, TRAJECTORIES, "run"),
    OF_STUDY(STUDY, STIFFNESS_AT, "modes"),
    OF_STUDY(STUDY, SHAPE, "run|equilibria|modes"),
    OF_STUDY(STUDY, LIKE, "run|equilibria|modes"),
    OF_STUDY(STUDY, CURVE, "path"),
    OF_STUDY(LIMIT, EVALUATIONS, "run"),
    OF_STUDY(LIMIT, TIME, "run|equilibria"),
    OF_FIGURE(AT_X, "lines|map|motion|points"),
    OF_FIGURE(AT_Y, "lines|map|motion|points"),
    OF_FIGURE(SERIES, "lines|motion|best"),
    OF_FIGURE(COLOR, "map|points"),
    OF_FIGURE(PANELS, "lines|map|motion|best"),
    OF_FIGURE(BAND, "lines|motion"),
    OF_FIGURE(DIFFERENCE, "lines|map|motion|period|snapshots"),
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

/* Is the key beside, or the other's word one of the words? What could not be read is. */
static bool is_met(strut_fields *fields, const companion *self, const strut_slot **other) {
  char word[40];
  bool beside = false;
  for (int i = 0; self->other < 0 && strut_word_at(self->words, i, word, sizeof word); i++)
    beside = beside || strut_slot_of(fields, strut_key_find(fields->section, word))->state;
  if (self->other < 0) return beside;
  const strut_key *key = strut_key_at(self->other);
  while (fields && fields->section != key->section) fields = fields->outer;
  if (!fields) return true;
  if (self->other == STRUT_KEY_STUDY_COMPUTE &&
      strut_slot_of(fields, STRUT_KEY_STUDY_FIT)->state != STRUT_ABSENT)
    return true; /* its matches compute several things: study_fit.c */
  *other = strut_slot_of(fields, self->other);
  if ((*other)->state == STRUT_BROKEN) return true;
  if ((*other)->state == STRUT_ABSENT) return strut_word_find(self->words, key->fallback) >= 0;
  return strut_word_at(key->words, (*other)->word, word, sizeof word) &&
         strut_word_find(self->words, word) >= 0;
}

bool strut_check_companions(strut_reader *reader, strut_fields *fields, strut_owner owner) {
  bool fine = true;
  for (const companion *c = companions; c < companions + COMPANIONS; c++) {
    const strut_slot *other = NULL;
    char words[200];
    if (strut_key_at(c->key)->section != fields->section) continue;
    strut_slot *slot = strut_slot_of(fields, c->key);
    if (slot->state != STRUT_GIVEN || is_met(fields, c, &other)) continue;
    if (slot->from || (other && other->key && slot->key->place.file != other->key->place.file)) {
      slot->state = STRUT_ABSENT; /* a group's is for others, a base's for its own kind */
      continue;
    }
    strut_report_error(reader, slot->key->place, "'%s' of %s has no meaning without %s%s%s",
                       slot->key->text, strut_owner_text(reader, owner),
                       c->other < 0 ? "" : strut_key_at(c->other)->name, c->other < 0 ? "" : ": ",
                       strut_words_text(c->words, words, sizeof words));
    slot->state = STRUT_BROKEN;
    fields->broken = true;
    fine = false;
  }
  return fine;
}

const char *strut_study_key_computes(int key) {
  for (const companion *c = companions; c < companions + COMPANIONS; c++)
    if (c->key == key && c->other == STRUT_KEY_STUDY_COMPUTE) return c->words;
  return NULL;
}
