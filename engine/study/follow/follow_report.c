/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The values of branches. */
#include <math.h>
#include <string.h>

#include "engine/study/follow/follow_parts.h"

static const double DEGREES = 57.29577951308232;

/* A value of the parameter, in its unit. */
#define STRUT_VALUE_AS_IN_UNIT(RESULT, NUMBER) STRUT_VALUE_AS_CALLED(NULL, (RESULT)->unit, NUMBER)

#define MULTIPLIER(X)                                                                              \
  X(NULL, "", NUMBER(hypot(m[0], m[1])), "", .column = {"multiplier"})                             \
  X(NULL, "", NUMBER(fabs(atan2(m[1], m[0])) * DEGREES), "", .column = {"multiplier_angle [deg]"})
STRUT_VALUES(strut_follow_multiplier_values, MULTIPLIER, const double *m = of->at)

#define MOTION(X)                                                                                  \
  X("arclength", "1", NUMBER(p->arc), "along the branch", .column = {"arclength"})                 \
  X("value", "", CALLED(r->name, r->unit, p->at.value[0]), "of the parameter", .column = {""},     \
    .label = {""})                                                                                 \
  X("velocity", "m/s", NUMBER(p->velocity), "mean", .column = {"velocity [m/s]"}, .label = {""})   \
  X("work", "J", NUMBER(p->work), "that goes in, for a drive period", .column = {"work [J]"})      \
  X(NULL, "", NUMBER(b->travels ? (double)NAN : p->amplitude), "", .column = {"amplitude [m]"})    \
  X("amplitude", "m", IF(!b->travels, NUMBER(p->amplitude)), "half the largest range",             \
    .label = {""})                                                                                 \
  X("multiplier", "1", NUMBERS(p->multiplier, 2), "the largest: real, imaginary")
#define POINT(X)                                                                                   \
  X(NULL, "", COUNT(of->outer->index + 1), "", .column = {"branch"})                               \
  MOTION(X)                                                                                        \
  X(NULL, "", COUNT(b->repeats), "", .column = {"period_multiple"})                                \
  X("stable", "", FLAG(p->stable), "whether it is")                                                \
  X(NULL, "", TEXT(p->stable ? "yes" : "no"), "", .column = {"stable"})                            \
  X(NULL, "", PART(p->multiplier), "", .rows = &strut_follow_multiplier_values)                    \
  X("point", "", IF(*word, TEXT(word)), "kind of a special one")                                   \
  X(NULL, "", TEXT(word), "", .column = {"point"})                                                 \
  X(NULL, "", TEXT(p->node), "", .column = {"node"})                                               \
  X(NULL, "", TEXT(p->detail), "", .column = {"detail"})                                           \
  X(NULL, "", TEXT(p->word), "", .column = {"word"})                                               \
  X(NULL, "",                                                                                      \
    TEXT(!p->detail   ? ""                                                                         \
         : p->changes ? "yes"                                                                      \
                      : "no"),                                                                     \
    "", .column = {"changes_stability"})
#define SPECIAL(X)                                                                                 \
  X("point", "", TEXT(word), "its kind", .label = {""})                                            \
  MOTION(X)                                                                                        \
  X("node", "", TEXT(p->node), "or member, or element, that it is about")                          \
  X("detail", "", TEXT(p->detail), "a sentence", .label = {""})                                    \
  X("changes_stability", "", FLAG(p->changes), "whether it does")                                  \
  X(NULL, "",                                                                                      \
    TEXT(!p->changes      ? ""                                                                     \
         : p->unstable[1] ? "lost"                                                                 \
                          : "from here"),                                                          \
    "", .label = {"stability"})
#define OF_POINT                                                                                   \
  const strut_follow_result *r = strut_result_whole(of);                                           \
  const strut_follow_branch *b = &((const strut_followed_branch *)of->outer->at)->branch;          \
  const strut_follow_point *p = of->at;                                                            \
  const char *word = strut_follow_kind_word(p->kind)
STRUT_VALUES_HERE(point_values, POINT, OF_POINT)
STRUT_VALUES_HERE(special_values, SPECIAL, OF_POINT)

static bool is_special(const strut_result_object *of, size_t k) {
  return ((const strut_followed_branch *)of->at)->branch.points[k].detail;
}

#define BRANCH(X)                                                                                  \
  X("start", "", TEXT(f->label), "the motion that it was followed from", .label = {""})            \
  X("doubled_from", "", IF(f->parent >= 0, COUNT(f->parent + 1)), "branch", .label = {""})         \
  X("period_multiple", "", COUNT(f->branch.repeats), "drive periods of one repetition",            \
    .label = {""})                                                                                 \
  X("begins", "", TEXT(f->branch.ends[0]), "why", .label = {""})                                   \
  X("ends", "", TEXT(f->branch.ends[1]), "why", .label = {""})                                     \
  X(NULL, "", COUNT(f->branch.count), "", .label = {"points"})                                     \
  X("special", "", LIST_WHERE(f->branch.points, f->branch.count, is_special),                      \
    "points where something changes", .rows = &special_values, .label = {""})                      \
  X("points", "", LIST(f->branch.points, f->branch.count), "all", .rows = &point_values)
STRUT_VALUES_HERE(branch_values, BRANCH, const strut_followed_branch *f = of->at)

static const char *kick_name(const strut_result_object *of, size_t i) {
  (void)of;
  return strut_follow_kick_name((int)i);
}

static strut_value kick_of(const strut_result_object *of, size_t i) {
  return STRUT_VALUE_AS_NUMBER(((const strut_follow_basin *)of->at)->kick[i]);
}

#define BASIN(X)                                                                                   \
  X("branch", "", COUNT(basin->branch + 1), "that the motion is on", .label = {""})                \
  X("value", "", IN_UNIT(r, basin->value), "of the parameter", .label = {""})                      \
  X(NULL, "m/s", MAP(STRUT_FOLLOW_KICKS, kick_name, kick_of), "", .label = {""})
STRUT_VALUES_HERE(basin_values, BASIN, const strut_follow_basin *basin = of->at;
                  const strut_follow_result *r = of->outer->at)

static strut_value note_of(const strut_result_object *of, size_t i) {
  return STRUT_VALUE_AS_TEXT(((const strut_follow_result *)of->at)->notes[i]);
}

#define NOTE(X) X(NULL, "", TEXT(of->at), "", .label = {"sentence"})
STRUT_VALUES_HERE(note_values, NOTE, )

#define FOLLOWED(X)                                                                                \
  X("name", "", TEXT(r->title), "of the scene", .label = {""})                                     \
  X("over", "", TEXT(r->name), "the parameter", .label = {""})                                     \
  X("unit", "", TEXT(r->unit), "of it")                                                            \
  X("from", "", IN_UNIT(r, r->low), "its range", .label = {""})                                    \
  X("to", "", IN_UNIT(r, r->high), "its range", .label = {""})                                     \
  X("method", "", TEXT(r->method), "of integration", .label = {""})                                \
  X("tolerance", "1", NUMBER(r->tolerance), "of motions")                                          \
  X("branches", "", LIST(r->branches, r->count), "of periodic motions", .rows = &branch_values,    \
    .label = {"branch"})                                                                           \
  X("basins", "", IF(r->basin_count, LIST(r->basins, r->basin_count)),                             \
    "smallest kicks that motions do not come back from", .rows = &basin_values,                    \
    .label = {"smallest kicks that a motion does not come back from"})                             \
  X(NULL, "", IF(r->second.name, SAME), "", .rows = &strut_follow_curves_values)                   \
  X("notes", "", ARRAY(r->note_count, note_of), "sentences")                                       \
  X(NULL, "", LIST(r->notes, r->note_count), "", .rows = &note_values, .label = {"notes"})
STRUT_VALUES(strut_follow_values, FOLLOWED, const strut_follow_result *r = of->at)
