/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Branches as CSV, as JSON, and as people read them. */
#include <math.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/buffer.h"
#include "engine/output/json_value.h"
#include "engine/study/follow/follow_parts.h"

static const double DEGREES = 57.29577951308232;
/* Special points that change no stability are counted, not listed, beyond so many of a branch. */
enum { MOST_LISTED = 12 };

static void add_number(strut_buffer *csv, double value) {
  strut_buffer_add(csv, ",");
  strut_csv_add_number(csv, isfinite(value) ? value : (double)NAN);
}

static void add_text(strut_buffer *csv, const char *text) {
  strut_buffer_add(csv, ",");
  strut_csv_add_text(csv, "%s", text ? text : "");
}

/* Does stability change at a special point? Nothing of other points. */
static const char *change_of(const strut_follow_point *p) {
  if (!p->detail) return "";
  return p->changes ? "yes" : "no";
}

char *strut_follow_csv_beside(const strut_follow_result *r, const char *names, const char *values) {
  strut_buffer csv = {0};
  strut_c_locale locale = strut_c_locale_enter();
  strut_buffer_add(&csv, "%sbranch,arclength", names);
  add_text(&csv, r->name);
  if (*r->unit) strut_buffer_add(&csv, " [%s]", r->unit);
  strut_buffer_add(&csv,
                   ",velocity [m/s],work [J],amplitude [m],period_multiple,stable,multiplier,"
                   "multiplier_angle [deg],point,node,detail,word,changes_stability\n");
  for (size_t i = 0; i < r->count; i++) {
    const strut_follow_branch *b = &r->branches[i].branch;
    for (size_t k = 0; k < b->count; k++) {
      const strut_follow_point *p = &b->points[k];
      strut_buffer_add(&csv, "%s%zu", values, i + 1);
      add_number(&csv, p->arc);
      add_number(&csv, p->value);
      add_number(&csv, p->velocity);
      add_number(&csv, p->work);
      add_number(&csv, b->travels ? (double)NAN : p->amplitude);
      strut_buffer_add(&csv, ",%d,%s", (int)b->repeats, p->stable ? "yes" : "no");
      add_number(&csv, hypot(p->multiplier[0], p->multiplier[1]));
      add_number(&csv, fabs(atan2(p->multiplier[1], p->multiplier[0])) * DEGREES);
      add_text(&csv, strut_follow_kind_word(p->kind));
      add_text(&csv, p->node);
      add_text(&csv, p->detail);
      add_text(&csv, p->word);
      strut_buffer_add(&csv, ",%s\n", change_of(p));
    }
  }
  strut_c_locale_leave(locale);
  return strut_buffer_take(&csv);
}

char *strut_follow_csv(const strut_follow_result *r) { return strut_follow_csv_beside(r, "", ""); }

static void add_points(strut_json *json, struct cJSON *to, const strut_follow_branch *b,
                       bool special) {
  struct cJSON *points = strut_json_array(json, to, special ? "special" : "points");
  for (size_t k = 0; k < b->count; k++) {
    const strut_follow_point *p = &b->points[k];
    if (special && !p->detail) continue;
    struct cJSON *row = strut_json_object(json, points, NULL);
    if (*strut_follow_kind_word(p->kind))
      strut_json_text(json, row, "point", strut_follow_kind_word(p->kind));
    strut_json_number(json, row, "value", p->value);
    strut_json_number(json, row, "arclength", p->arc);
    strut_json_number(json, row, "velocity", p->velocity);
    strut_json_number(json, row, "work", p->work);
    if (!b->travels) strut_json_number(json, row, "amplitude", p->amplitude);
    if (!special) strut_json_bool(json, row, "stable", p->stable);
    strut_json_numbers(json, row, "multiplier", p->multiplier, 2);
    if (!special) continue;
    strut_json_text(json, row, "node", p->node);
    strut_json_text(json, row, "detail", p->detail);
    strut_json_bool(json, row, "changes_stability", p->changes);
  }
}

char *strut_follow_json(const strut_follow_result *r) {
  strut_json json = strut_json_begin();
  strut_json_text(&json, json.root, "name", r->title);
  strut_json_text(&json, json.root, "over", r->name);
  strut_json_text(&json, json.root, "unit", r->unit);
  strut_json_number(&json, json.root, "from", r->low);
  strut_json_number(&json, json.root, "to", r->high);
  strut_json_text(&json, json.root, "method", r->method);
  strut_json_number(&json, json.root, "tolerance", r->tolerance);
  struct cJSON *branches = strut_json_array(&json, json.root, "branches");
  for (size_t i = 0; i < r->count; i++) {
    const strut_followed_branch *f = &r->branches[i];
    struct cJSON *row = strut_json_object(&json, branches, NULL);
    strut_json_text(&json, row, "start", f->label);
    if (f->parent >= 0) strut_json_integer(&json, row, "doubled_from", f->parent + 1);
    strut_json_integer(&json, row, "period_multiple", f->branch.repeats);
    strut_json_text(&json, row, "begins", f->branch.ends[0]);
    strut_json_text(&json, row, "ends", f->branch.ends[1]);
    add_points(&json, row, &f->branch, true);
    add_points(&json, row, &f->branch, false);
  }
  struct cJSON *basins = r->basin_count ? strut_json_array(&json, json.root, "basins") : NULL;
  for (size_t i = 0; i < r->basin_count; i++) {
    const strut_follow_basin *b = &r->basins[i];
    struct cJSON *row = strut_json_object(&json, basins, NULL);
    strut_json_integer(&json, row, "branch", (int64_t)b->branch + 1);
    strut_json_number(&json, row, "value", b->value);
    for (int k = 0; k < STRUT_FOLLOW_KICKS; k++)
      strut_json_number(&json, row, strut_follow_kick_name(k), b->kick[k]);
  }
  strut_follow_curves_json(r, &json);
  struct cJSON *notes = strut_json_array(&json, json.root, "notes");
  for (size_t i = 0; i < r->note_count; i++) strut_json_text(&json, notes, NULL, r->notes[i]);
  return strut_json_end(&json);
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
