/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/report/rigidity_words.h"

#include <math.h>
#include <stdio.h>

#include "engine/output/quantity_text.h"

enum { DIGITS = 4 };

const char *strut_member_kind_words(strut_member_kind kind) {
  static const char *const names[] = {"bar", "spring", "cable"};
  return names[kind];
}

const char *strut_stress_source_words(strut_stress_source source) {
  static const char *const words[] = {
      "no self-stress state", "the self-stress state", "the member forces",
      "a combination of states that tensions all cables", "the first self-stress state"};
  return words[source];
}

const char *strut_mechanism_words(const strut_mechanisms *all, const strut_mechanism *motion,
                                  char words[STRUT_RIGIDITY_WORDS]) {
  char moved[STRUT_QUANTITY_TEXT], stiff[STRUT_QUANTITY_TEXT];
  bool followed = isfinite(motion->moved) && motion->kind == STRUT_MOTION_FINITE;
  words[0] = '\0';
  if (motion->kind == STRUT_MOTION_RIGID_BODY) {
    snprintf(words, STRUT_RIGIDITY_WORDS, "not prevented by the supports");
  } else if (motion->kind == STRUT_MOTION_INFINITESIMAL && all->by_forces) {
    snprintf(words, STRUT_RIGIDITY_WORDS, "stiffened by the member forces: %s",
             strut_quantity_text(motion->stiffness, DIGITS, "N/m", stiff));
  } else if (motion->kind == STRUT_MOTION_INFINITESIMAL) {
    snprintf(
        words, STRUT_RIGIDITY_WORDS, "stiffened by a self-stress state%s",
        all->stiffener_pulls ? "" : ", but none is known that does so without compressing a cable");
  } else if (followed) {
    snprintf(words, STRUT_RIGIDITY_WORDS, "member lengths constant within %.0e over %s",
             motion->strain, strut_quantity_text(motion->moved, DIGITS, "m", moved));
  } else if (motion->kind == STRUT_MOTION_FINITE) {
    snprintf(words, STRUT_RIGIDITY_WORDS,
             "finite: without self-stress the member lengths are independent");
  } else {
    snprintf(words, STRUT_RIGIDITY_WORDS,
             "undecided: no stiffening self-stress found, and it could not be followed");
  }
  return words;
}

static const char *why_not(const strut_rigidity *r) {
  if (!r->stress.positive) return "the stress matrix has a negative eigenvalue";
  if (r->stress.supported && r->stress.nullity > 0)
    return "the stress matrix is not definite on the free coordinates";
  if (!r->stress.supported && r->stress.nullity > 3)
    return "the stress matrix vanishes on more than affine motions";
  if (!r->stress.supported && r->stress.nullity < 3) return "the forces do not balance";
  if (!r->stress.supported && r->stress.on_conic)
    return "an affine motion keeps all lengths: the members have only two directions";
  return "a cable is in compression";
}

const char *strut_super_stability_words(const strut_rigidity *r, char words[STRUT_RIGIDITY_WORDS]) {
  const char *source = strut_stress_source_words(r->source);
  if (r->states.count == 0)
    snprintf(words, STRUT_RIGIDITY_WORDS, "no: %s", source);
  else if (!r->stress.tested)
    snprintf(words, STRUT_RIGIDITY_WORDS, "not tested: the structure is too large");
  else if (r->stress.super_stable)
    snprintf(words, STRUT_RIGIDITY_WORDS, "yes, by %s", source);
  else
    snprintf(words, STRUT_RIGIDITY_WORDS, "%s, by %s: %s",
             r->states.count == 1 ? "no" : "not shown", source, why_not(r));
  return words;
}
