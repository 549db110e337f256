/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table and the CSV of a comparison. */
#include "engine/study/compare/compare.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/number_text.h"
#include "engine/output/buffer.h"
#include "engine/output/result_values.h"

enum {
  LABELS = 24, /* width of the column of labels */
  NARROWEST = 11,
  WIDEST = 26,
  DIGITS = 4,
  CELL = 80,
  MOST_STATES = 8,
  MOST_DIFFERENCES = 30,
  MOST_TEXT = 60
};

/* ---- cells ---- */

static void cell_text(strut_compare_quantity quantity, const strut_compare_cell *cell,
                      char text[CELL]) {
  const char *unit = strut_compare_row_of(quantity).unit;
  double v = cell->value;
  if (!isfinite(v))
    snprintf(text, CELL, "-");
  else if (!*unit)
    snprintf(text, CELL, "%.0f", v);
  else if (quantity == STRUT_COMPARE_DUTY || quantity == STRUT_COMPARE_VELOCITY_ERROR)
    snprintf(text, CELL, "%.3g %%", 100.0 * v);
  else if (strcmp(unit, "1") == 0)
    snprintf(text, CELL, "%.4g", v);
  else if (strcmp(unit, "kg") == 0)
    snprintf(text, CELL, "%s", strut_quantity_of(1000.0 * v, DIGITS, "g").text);
  else if (strcmp(unit, "1/s") == 0)
    snprintf(text, CELL, "%s", strut_quantity_of(v, 3, "").text);
  else
    snprintf(text, CELL, "%s",
             strut_quantity_of(v, quantity == STRUT_COMPARE_CPU ? 2 : DIGITS,
                               strcmp(unit, "s/s") == 0 ? "s" : unit)
                 .text);
}

/* Letters of a UTF-8 text, as a terminal's columns. */
static int letters(const char *text) {
  int count = 0;
  for (; *text; text++) count += ((unsigned char)*text & 0xC0) != 0x80;
  return count;
}

/* Cut to `most` letters, the last a dot where that is not all; padded on the left to `width`. */
static void add_right(strut_buffer *to, const char *text, int width) {
  int count = letters(text), most = width - 1;
  strut_buffer_add(to, "%*s", count > most ? 1 : width - count, "");
  for (int shown = 0; *text; text++) {
    bool first = ((unsigned char)*text & 0xC0) != 0x80;
    if (first && count > most && shown == most - 1) {
      strut_buffer_add(to, "~");
      return;
    }
    shown += first;
    strut_buffer_add(to, "%c", *text);
  }
}

static int column_width(const strut_compare_column *c) {
  int width = letters(c->input->label) + 2;
  for (int i = 0; i < STRUT_COMPARE_QUANTITIES; i++) {
    char text[CELL];
    cell_text((strut_compare_quantity)i, &c->cell[i], text);
    if (letters(text) + 2 > width) width = letters(text) + 2;
  }
  return width < NARROWEST ? NARROWEST : width > WIDEST ? WIDEST : width;
}

/* A row is row_info where some structure has it. */
static bool has_values(const strut_compare *r, int row) {
  for (size_t i = 0; i < r->count; i++)
    if (isfinite(r->columns[i].cell[row].value)) return true;
  return false;
}

/* The names that the scenes have, by label. */
static void add_scene_names(strut_buffer *to, const strut_compare *r) {
  int width = 0;
  for (size_t i = 0; i < r->count; i++) {
    int here = letters(r->columns[i].input->label);
    if (*r->columns[i].input->setup->scene.name && here > width) width = here;
  }
  for (size_t i = 0; i < r->count; i++) {
    const strut_compare_input *in = r->columns[i].input;
    if (*in->setup->scene.name)
      strut_buffer_add(to, "%s:%*s %s\n", in->label, width - letters(in->label), "",
                       in->setup->scene.name);
  }
  if (width > 0) strut_buffer_add(to, "\n");
}

static void add_block(strut_buffer *to, const strut_compare *r, size_t first, size_t end) {
  const char *group = "";
  strut_buffer_add(to, "%-*s", LABELS, "");
  for (size_t i = first; i < end; i++)
    add_right(to, r->columns[i].input->label, column_width(&r->columns[i]));
  strut_buffer_add(to, "\n");
  for (int row = 0; row < STRUT_COMPARE_QUANTITIES; row++) {
    strut_compare_row row_info = strut_compare_row_of((strut_compare_quantity)row);
    if (!has_values(r, row)) continue;
    if (strcmp(group, row_info.group) != 0) strut_buffer_add(to, "%s\n", row_info.group);
    group = row_info.group;
    strut_buffer_add(to, "  %-*s", LABELS - 2, row_info.label);
    for (size_t i = first; i < end; i++) {
      char text[CELL];
      cell_text((strut_compare_quantity)row, &r->columns[i].cell[row], text);
      add_right(to, text, column_width(&r->columns[i]));
    }
    strut_buffer_add(to, "\n");
  }
}

/* ---- what has no place in the table ---- */

static void add_states(strut_buffer *to, const strut_compare_column *c) {
  if (c->state_count == 0) return;
  strut_buffer_add(to, "  %s: equilibria", c->input->label);
  for (size_t i = 0; i < c->state_count && i < MOST_STATES; i++)
    strut_buffer_add(to, "%s %s (%s)", i ? "," : "", c->states[i].name,
                     strut_quantity_of(c->states[i].energy, 6, "J").text);
  if (c->state_count > MOST_STATES)
    strut_buffer_add(to, " and %zu more", c->state_count - MOST_STATES);
  strut_buffer_add(to, "\n");
}

static void add_motion(strut_buffer *to, const strut_compare_column *c) {
  if (!c->motion) return;
  strut_buffer_add(to, "  %s moves %s", c->input->label,
                   c->motion[0] == 'p'   ? "periodically"
                   : c->motion[0] == 'i' ? "irregularly"
                                         : "without becoming steady");
  if (c->repeats > 1) strut_buffer_add(to, ", with a period of %d drive periods", (int)c->repeats);
  if (c->still) strut_buffer_add(to, ", without travel");
  const char *between = "; contact duty of";
  for (size_t i = 0; i < c->contact_count; i++) {
    if (!(c->contacts[i].duty > 0.0)) continue;
    strut_buffer_add(to, "%s %s %.3g %%", between, c->contacts[i].node,
                     100.0 * c->contacts[i].duty);
    between = ",";
  }
  strut_buffer_add(to, "\n");
}

static void add_remarks(strut_buffer *to, const strut_compare_column *c) {
  for (size_t i = 0; i < c->input->without_count; i++)
    strut_buffer_add(to, "  %s has no parameter '%s' and keeps the values of its file\n",
                     c->input->label, c->input->without[i]);
  if (c->status != STRUT_OK) strut_buffer_add(to, "  %s: %s\n", c->input->label, c->message);
}

static void add_value(strut_buffer *to, const char *text) {
  bool long_text = strlen(text) > MOST_TEXT;
  int bytes = (int)strlen(text);
  if (long_text)
    for (bytes = MOST_TEXT; bytes > 0 && ((unsigned char)text[bytes] & 0xC0) == 0x80; bytes--) {
    }
  strut_buffer_add(to, "%.*s%s", bytes, text, long_text ? "..." : "");
}

static void add_differences(strut_buffer *to, const strut_compare *r,
                            const strut_compare_column *c) {
  const strut_compare_input *in = c->input;
  strut_buffer_add(to, "\n%s against %s: ", in->label, r->columns[0].input->label);
  if (in->difference_count == 0) strut_buffer_add(to, "no difference");
  strut_buffer_add(to, "\n");
  for (size_t i = 0; i < in->difference_count && i < MOST_DIFFERENCES; i++) {
    const strut_difference *d = &in->differences[i];
    strut_buffer_add(to, "  %c %s: ", !d->was ? '+' : !d->is ? '-' : '~', d->where);
    if (d->was) add_value(to, d->was);
    if (d->was && d->is) strut_buffer_add(to, " -> ");
    if (d->is) add_value(to, d->is);
    strut_buffer_add(to, "\n");
  }
  if (in->difference_count > MOST_DIFFERENCES)
    strut_buffer_add(to, "  ... and %zu more; --json lists all\n",
                     in->difference_count - MOST_DIFFERENCES);
}

char *strut_compare_table(const strut_compare *r, int columns) {
  strut_buffer table = {0};
  strut_c_locale locale = strut_c_locale_enter();
  add_scene_names(&table, r);
  for (size_t first = 0, end; first < r->count; first = end) {
    int used = LABELS;
    for (end = first; end < r->count; end++) {
      used += column_width(&r->columns[end]);
      if (used > columns && end > first) break;
    }
    if (first) strut_buffer_add(&table, "\n");
    add_block(&table, r, first, end);
  }
  strut_buffer_add(&table, "\n");
  for (size_t i = 0; i < r->count; i++) add_states(&table, &r->columns[i]);
  for (size_t i = 0; i < r->count; i++) add_motion(&table, &r->columns[i]);
  for (size_t i = 0; i < r->count; i++) add_remarks(&table, &r->columns[i]);
  for (size_t i = 1; i < r->count; i++) add_differences(&table, r, &r->columns[i]);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}

/* ---- CSV ---- */

char *strut_compare_csv(const strut_compare *r) {
  strut_buffer csv = {0};
  strut_buffer_add(&csv, "model,name");
  for (int row = 0; row < STRUT_COMPARE_QUANTITIES; row++) {
    strut_compare_row row_info = strut_compare_row_of((strut_compare_quantity)row);
    strut_buffer_add(&csv, ",%s", row_info.key);
    if (*row_info.unit && strcmp(row_info.unit, "1") != 0)
      strut_buffer_add(&csv, " [%s]", row_info.unit);
  }
  strut_buffer_add(&csv, "\n");
  for (size_t i = 0; i < r->count; i++) {
    const strut_compare_column *c = &r->columns[i];
    strut_csv_add_text(&csv, "%s", c->input->label);
    strut_buffer_add(&csv, ",");
    strut_csv_add_text(&csv, "%s", c->input->setup->scene.name);
    for (int row = 0; row < STRUT_COMPARE_QUANTITIES; row++) {
      char text[STRUT_NUMBER_TEXT] = "";
      if (isfinite(c->cell[row].value)) strut_number_text(c->cell[row].value, text);
      strut_buffer_add(&csv, ",%s", text);
    }
    strut_buffer_add(&csv, "\n");
  }
  return strut_buffer_take(&csv);
}

/* ---- JSON ---- */

static const strut_scene *scene_of(const strut_compare_column *c) {
  return &c->input->setup->scene;
}

static const char *quantity_name(const strut_result_object *of, size_t i) {
  (void)of;
  return strut_compare_row_of((strut_compare_quantity)i).key;
}

static strut_value quantity_unit(const strut_result_object *of, size_t i) {
  const char *unit = strut_compare_row_of((strut_compare_quantity)i).unit;
  (void)of;
  return STRUT_VALUE_AS_IF(*unit, TEXT(unit));
}

static strut_value quantity_value(const strut_result_object *of, size_t i) {
  double value = ((const strut_compare_column *)of->at)->cell[i].value;
  bool whole = isfinite(value) && !*strut_compare_row_of((strut_compare_quantity)i).unit;
  return whole ? STRUT_VALUE_AS_COUNT(value) : STRUT_VALUE_AS_NUMBER(value);
}

static strut_value quantity_reason(const strut_result_object *of, size_t i) {
  const char *reason = ((const strut_compare_column *)of->at)->cell[i].reason;
  return STRUT_VALUE_AS_IF(reason, TEXT(reason));
}

#define STATE(X)                                                                                   \
  X("name", "", TEXT(state->name), "of the equilibrium")                                           \
  X("energy", "J", NUMBER(state->energy), "at rest on the real ground")
STRUT_VALUES_HERE(state_values, STATE, const strut_compare_state *state = of->at)

#define BARRIER(X)                                                                                 \
  X("from", "", TEXT(barrier->from), "an equilibrium")                                             \
  X("to", "", TEXT(barrier->to), "another one")                                                    \
  X("height", "J", NUMBER(barrier->height), "above `from`")
STRUT_VALUES_HERE(barrier_values, BARRIER, const strut_compare_barrier *barrier = of->at)

#define NODE(X)                                                                                    \
  X("position", "m", NUMBERS(of->at, 2), "in that shape")                                          \
  X("stiffness", "N/m", IF(c->stiffness, NUMBERS(c->stiffness[of->index], 2)), "under unit loads")
STRUT_VALUES_HERE(node_values, NODE, const strut_compare_column *c = of->outer->at)

#define CONTACT(X)                                                                                 \
  X("duty", "1", NUMBER(contact->duty), "share of the time in contact")                            \
  X("max_height", "m", NUMBER(contact->max_height), "above the ground")
STRUT_VALUES_HERE(contact_values, CONTACT, const strut_contact_summary *contact = of->at)

#define DIFFERENCE(X)                                                                              \
  X("where", "", TEXT(d->where), "path of the key")                                                \
  X("change", "", TEXT(!d->was ? "added" : !d->is ? "removed" : "changed"), "against the first")   \
  X("was", "", TEXT(d->was), "in the first")                                                       \
  X("is", "", TEXT(d->is), "here")
STRUT_VALUES_HERE(difference_values, DIFFERENCE, const strut_difference *d = of->at)

static const char *node_name(const strut_result_object *of, size_t i) {
  return scene_of(of->at)->nodes[i].name;
}

static const char *contact_name(const strut_result_object *of, size_t i) {
  return ((const strut_compare_column *)of->at)->contacts[i].node;
}

static const char *missing_name(const strut_result_object *of, size_t i) {
  return ((const strut_compare_column *)of->at)->input->without[i];
}

static const char *softest_node(const strut_compare_column *c, int axis) {
  return c->softest[axis] < 0 ? NULL : scene_of(c)->nodes[c->softest[axis]].name;
}

#define MODEL(X)                                                                                   \
  X("model", "", TEXT(c->input->label), "its label")                                               \
  X("name", "", TEXT(scene_of(c)->name), "of its scene")                                           \
  X("status", "", TEXT(strut_status_text(c->status)), "the worst of what was computed")            \
  X("reason", "", TEXT(c->status == STRUT_OK ? NULL : c->message), "of it")                        \
  X("parameters", "", PARAMETERS, "of its scene")                                                  \
  X("values", "", MAP(STRUT_COMPARE_QUANTITIES, quantity_name, quantity_value), "of the rows")     \
  X("reasons", "", MAP(STRUT_COMPARE_QUANTITIES, quantity_name, quantity_reason), "of null")       \
  X("states", "", LIST(c->states, c->state_count), "equilibria in which it stands",                \
    .rows = &state_values)                                                                         \
  X("barriers", "", LIST(c->barriers, c->barrier_count), "between", .rows = &barrier_values)       \
  X("shape", "", TEXT(c->shape), "that is evaluated and drawn")                                    \
  X("nodes", "", NAMED((const double(*)[2])c->q, c->q ? scene_of(c)->node_count : 0, node_name),   \
    "in it", .rows = &node_values)                                                                 \
  X("softest_in_x", "", TEXT(softest_node(c, 0)), "node")                                          \
  X("softest_in_y", "", TEXT(softest_node(c, 1)), "node")                                          \
  X("motion", "", TEXT(c->motion), "periodic, irregular, ...")                                     \
  X("repeats", "", IF(c->repeats > 0, COUNT(c->repeats)), "drive periods of one repetition")       \
  X("still", "", IF(c->motion, FLAG(c->still)), "whether it does not travel")                      \
  X("velocity_method", "", TEXT(c->how), "how its velocity was found")                             \
  X("contacts", "", NAMED(c->contacts, c->contact_count, contact_name), "in the steady motion",    \
    .rows = &contact_values)                                                                       \
  X("differences", "", IF(of->index, LIST(in->differences, in->difference_count)),                 \
    "from the first", .rows = &difference_values)                                                  \
  X("without_parameters", "", IF(of->index, NAMES(missing_name, in->without_count)),               \
    "that were set and that it does not have")
STRUT_VALUES_HERE(model_values, MODEL, const strut_compare_column *c = of->at;
                  const strut_compare_input *in = c->input)

static const strut_scene *scene_of_model(const strut_result_object *of, size_t i) {
  return scene_of(&((const strut_compare *)of->at)->columns[i]);
}

static strut_value models_of(const strut_compare *r) {
  strut_value list = STRUT_VALUE_AS_LIST(r->columns, r->count);
  list.scene = scene_of_model;
  return list;
}

#define COMPARISON(X)                                                                              \
  X("strut_version", "", TEXT(STRUT_VERSION), "that computed it")                                  \
  X("accuracy", "1", NUMBER(r->no_motion ? (double)NAN : r->accuracy), "asked of velocities")      \
  X("units", "", MAP(STRUT_COMPARE_QUANTITIES, quantity_name, quantity_unit), "of the rows")       \
  X("models", "", BY(models_of(r)), "in their order", .rows = &model_values)
STRUT_VALUES(strut_compare_values, COMPARISON, const strut_compare *r = of->at)

char *strut_compare_json(const strut_compare *r) {
  return strut_values_json(&strut_compare_values, r, NULL);
}
