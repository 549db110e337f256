/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Branches as CSV, as JSON, and as people read them. */
#include <math.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/buffer.h"
#include "engine/output/result_values.h"
#include "engine/study/follow/follow_parts.h"

static const double DEGREES = 57.29577951308232;
/* Special points that change no stability are counted, not listed, beyond so many of a branch. */
enum { MOST_LISTED = 12 };

/* ---- values ---- */

#define MULTIPLIER(X)                                                                              \
  X(NULL, "", NUMBER(hypot(m[0], m[1])), "", .column = {"multiplier"})                             \
  X(NULL, "", NUMBER(fabs(atan2(m[1], m[0])) * DEGREES), "", .column = {"multiplier_angle [deg]"})
STRUT_VALUES(strut_follow_multiplier_values, MULTIPLIER, const double *m = of->at)

#define MOTION(X)                                                                                  \
  X("arclength", "1", NUMBER(p->arc), "along the branch", .column = {"arclength"})                 \
  X("value", "", CALLED(r->name, r->unit, p->value), "of the parameter", .column = {""})           \
  X("velocity", "m/s", NUMBER(p->velocity), "mean", .column = {"velocity [m/s]"})                  \
  X("work", "J", NUMBER(p->work), "that goes in, for a drive period", .column = {"work [J]"})      \
  X(NULL, "", NUMBER(b->travels ? (double)NAN : p->amplitude), "", .column = {"amplitude [m]"})    \
  X("amplitude", "m", IF(!b->travels, NUMBER(p->amplitude)), "half the largest range")             \
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
  X("point", "", TEXT(word), "its kind")                                                           \
  MOTION(X)                                                                                        \
  X("node", "", TEXT(p->node), "or member, or element, that it is about")                          \
  X("detail", "", TEXT(p->detail), "a sentence")                                                   \
  X("changes_stability", "", FLAG(p->changes), "whether it does")
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
  X("start", "", TEXT(f->label), "the motion that it was followed from")                           \
  X("doubled_from", "", IF(f->parent >= 0, COUNT(f->parent + 1)), "branch")                        \
  X("period_multiple", "", COUNT(f->branch.repeats), "drive periods of one repetition")            \
  X("begins", "", TEXT(f->branch.ends[0]), "why")                                                  \
  X("ends", "", TEXT(f->branch.ends[1]), "why")                                                    \
  X("special", "", LIST_WHERE(f->branch.points, f->branch.count, is_special),                      \
    "points where something changes", .rows = &special_values)                                     \
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
  X("branch", "", COUNT(basin->branch + 1), "that the motion is on")                               \
  X("value", "", NUMBER(basin->value), "of the parameter")                                         \
  X(NULL, "m/s", MAP(STRUT_FOLLOW_KICKS, kick_name, kick_of), "")
STRUT_VALUES_HERE(basin_values, BASIN, const strut_follow_basin *basin = of->at)

static strut_value note_of(const strut_result_object *of, size_t i) {
  return STRUT_VALUE_AS_TEXT(((const strut_follow_result *)of->at)->notes[i]);
}

#define FOLLOWED(X)                                                                                \
  X("name", "", TEXT(r->title), "of the scene")                                                    \
  X("over", "", TEXT(r->name), "the parameter")                                                    \
  X("unit", "", TEXT(r->unit), "of it")                                                            \
  X("from", "", NUMBER(r->low), "its range")                                                       \
  X("to", "", NUMBER(r->high), "its range")                                                        \
  X("method", "", TEXT(r->method), "of integration")                                               \
  X("tolerance", "1", NUMBER(r->tolerance), "of motions")                                          \
  X("branches", "", LIST(r->branches, r->count), "of periodic motions", .rows = &branch_values)    \
  X("basins", "", IF(r->basin_count, LIST(r->basins, r->basin_count)),                             \
    "smallest kicks that motions do not come back from", .rows = &basin_values)                    \
  X(NULL, "", IF(r->second.name, SAME), "", .rows = &strut_follow_curves_values)                   \
  X("notes", "", ARRAY(r->note_count, note_of), "sentences")
STRUT_VALUES(strut_follow_values, FOLLOWED, const strut_follow_result *r = of->at)

char *strut_follow_csv_beside(const strut_follow_result *r, const char *names, const char *values) {
  const char *const before[] = {names, values};
  return strut_values_csv(&strut_follow_values, "branches.points", before, r, NULL);
}

char *strut_follow_csv(const strut_follow_result *r) { return strut_follow_csv_beside(r, "", ""); }

char *strut_follow_json(const strut_follow_result *r) {
  return strut_values_json(&strut_follow_values, r, NULL);
}

/* ---- the table ---- */

static const char *unit_of(const strut_follow_result *r) { return *r->unit ? r->unit : "1"; }

static void add_special(strut_buffer *t, const strut_follow_result *r, const strut_follow_branch *b,
                        const strut_follow_point *p) {
  strut_buffer_add(t, "  %-14s %-16s at %s, %s: %s",
                   strut_quantity_of_any(p->value, 6, unit_of(r)).text,
                   strut_follow_kind_word(p->kind),
                   (b->travels ? strut_quantity_of(p->velocity, 4, "m/s")
                               : strut_quantity_of(p->amplitude, 4, "m"))
                       .text,
                   p->changes ? (p->unstable[1] ? "stability lost" : "stable from here")
                              : "no change of stability",
                   p->detail);
  strut_buffer_add(t, "\n");
}

/* Stretches of equal stability, by the parameter. */
static void add_stretches(strut_buffer *t, const strut_follow_result *r,
                          const strut_follow_branch *b) {
  size_t from = 0, listed = 0;
  strut_buffer_add(t, "  ");
  for (size_t k = 1; k <= b->count; k++) {
    if (k < b->count && b->points[k].stable == b->points[from].stable) continue;
    strut_buffer_add(t, "%s%s %s to %s", listed++ ? ", " : "",
                     b->points[from].stable ? "stable" : "unstable",
                     strut_quantity_of_any(b->points[from].value, 5, unit_of(r)).text,
                     strut_quantity_of_any(b->points[k - 1].value, 5, unit_of(r)).text);
    from = k;
    if (listed == 12 && k < b->count) {
      strut_buffer_add(t, ", and so on");
      break;
    }
  }
  strut_buffer_add(t, "\n");
}

static void add_branch(strut_buffer *t, const strut_follow_result *r, size_t index) {
  const strut_followed_branch *f = &r->branches[index];
  const strut_follow_branch *b = &f->branch;
  size_t quiet = 0, listed = 0;
  strut_buffer_add(t, "\nbranch %zu, from %s", index + 1, f->label);
  if (b->repeats > 1) strut_buffer_add(t, ", every %d periods", (int)b->repeats);
  strut_buffer_add(t, ": %zu points, %s to %s\n", b->count,
                   strut_quantity_of_any(b->points[0].value, 6, unit_of(r)).text,
                   strut_quantity_of_any(b->points[b->count - 1].value, 6, unit_of(r)).text);
  add_stretches(t, r, b);
  for (size_t k = 0; k < b->count; k++) {
    const strut_follow_point *p = &b->points[k];
    if (!p->detail) continue;
    bool main = p->changes || (p->kind >= STRUT_FOLLOW_FOLD && p->kind <= STRUT_FOLLOW_TORUS);
    if (!main && listed >= MOST_LISTED) {
      quiet++;
      continue;
    }
    listed += !main;
    add_special(t, r, b, p);
  }
  if (quiet) strut_buffer_add(t, "  and %zu more events that do not change the stability\n", quiet);
  strut_buffer_add(t, "  begins: %s; ends: %s\n", b->ends[0], b->ends[1]);
}

/* Kicks that motions do not survive. */
static void add_basins(strut_buffer *t, const strut_follow_result *r) {
  if (r->basin_count)
    strut_buffer_add(t, "\nsmallest kicks found from which a motion does not come back\n");
  for (size_t i = 0; i < r->basin_count; i++) {
    const strut_follow_basin *b = &r->basins[i];
    strut_buffer_add(t, "  branch %zu at %s, %s:", b->branch + 1,
                     strut_quantity_of_any(b->value, 6, unit_of(r)).text,
                     strut_quantity_of(b->velocity, 4, "m/s").text);
    for (int k = 0; k < STRUT_FOLLOW_KICKS; k++)
      strut_buffer_add(t, "%s %s %s", k ? "," : "", strut_follow_kick_name(k),
                       isfinite(b->kick[k]) ? strut_quantity_of(b->kick[k], 2, "m/s").text : "any");
    strut_buffer_add(t, "\n");
  }
}

char *strut_follow_table(const strut_follow_result *r) {
  strut_buffer t = {0};
  strut_c_locale locale = strut_c_locale_enter();
  strut_buffer_add(&t, "%s: periodic motions over %s from %s to %s, by %s\n", r->title, r->name,
                   strut_quantity_of_any(r->low, 6, unit_of(r)).text,
                   strut_quantity_of_any(r->high, 6, unit_of(r)).text, r->method);
  for (size_t i = 0; i < r->count; i++) add_branch(&t, r, i);
  add_basins(&t, r);
  if (r->note_count) strut_buffer_add(&t, "\n");
  strut_follow_curves_table(r, &t);
  for (size_t i = 0; i < r->note_count; i++) strut_buffer_add(&t, "note: %s\n", r->notes[i]);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&t);
}
