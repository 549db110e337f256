/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is made of measured data: signals, laws, positions. See reader.h. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "parser/language/read/reader.h"

/* Two columns of one table. */
typedef struct columns {
  const strut_data_table *table;
  const strut_data_column *x, *y;
  const strut_tree *value; /* where x is named */
  size_t count;            /* of rows without gaps */
} columns;

/* A row without gaps? */
static bool is_whole(const columns *self, size_t row) {
  return !isnan(self->x->values[row]) && !isnan(self->y->values[row]);
}

/* Column x, which `value` names, or the table's time where that is NULL. False: that was reported. */
static bool read_over(strut_reader *reader, const strut_tree *value, const strut_tree *y,
                      strut_owner owner, const strut_dimension *expected, columns *self) {
  const strut_data_table *of = self->table;
  self->value = value ? value : y;
  if (!value && of->time < 0)
    return strut_report_error(reader, y->place,
                              "data '%s' have no column of a time; name its unit, or the column by "
                              "'over', for %s",
                              of->name, strut_owner_text(reader, owner));
  if (!value) self->x = &of->columns[of->time];
  if (value) self->x = strut_read_data_column(reader, value, "over", owner, expected, &self->table);
  if (self->x && self->table != of)
    return strut_report_error(reader, value->place, "expected a column of data '%s', as '%s' is",
                              of->name, strut_sanitised_text(reader, y->text));
  if (!self->x) return false;
  for (size_t k = 0; k < self->table->row_count; k++) self->count += is_whole(self, k);
  return self->count > 1 || strut_refuse_data(reader, self->value, self->table, self->x, SIZE_MAX,
                                              "expected two rows or more without gaps");
}

/* The first row whose x is not above that of the one before; SIZE_MAX: none. */
static size_t find_disorder(const columns *self, double sign) {
  double before = -HUGE_VAL;
  for (size_t k = 0; k < self->table->row_count; k++) {
    if (!is_whole(self, k)) continue;
    if (!(sign * self->x->values[k] > before)) return k;
    before = sign * self->x->values[k];
  }
  return SIZE_MAX;
}

/* The rows without gaps, from the last to the first if x falls; the table's own where those are all. */
static bool take_rows(strut_reader *reader, const columns *self, bool falls, const double **x,
                      const double **y) {
  size_t count = self->count, rows = self->table->row_count, to = 0;
  *x = self->x->values, *y = self->y->values;
  if (count == rows && !falls) return true;
  double *copy = strut_keep_array(reader, 2 * count, sizeof *copy);
  for (size_t i = 0; copy && i < rows; i++) {
    size_t k = falls ? rows - 1 - i : i;
    if (!is_whole(self, k)) continue;
    copy[to] = self->x->values[k];
    copy[count + to++] = self->y->values[k];
  }
  *x = copy, *y = copy ? copy + count : NULL;
  return copy != NULL;
}

/* "TABLE.COLUMN", kept. */
static const char *name_column(strut_reader *reader, const strut_data_table *table,
                               const strut_data_column *column) {
  const char *name = strut_arena_format(reader->keep, "%s.%s", table->name, column->name);
  if (!name) reader->out_of_memory = true;
  return name ? name : "";
}

bool strut_read_data_signal(strut_reader *reader, const strut_tree *value, const strut_tree *over,
                            strut_owner owner, const strut_dimension *expected,
                            strut_dimension *found, strut_signal *signal) {
  char message[120];
  columns c = {.table = NULL};
  const strut_dimension time = STRUT_DIM_TIME;
  c.y = strut_read_data_column(reader, value, "data", owner, expected, &c.table);
  if (!c.y || !read_over(reader, over, value, owner, &time, &c)) return false;
  size_t row = find_disorder(&c, 1.0);
  snprintf(message, sizeof message, "expected a time above that of the row before, found %g s",
           row < c.table->row_count ? c.x->values[row] : 0.0);
  if (row < c.table->row_count)
    return strut_refuse_data(reader, c.value, c.table, c.x, row, message);
  signal->data = name_column(reader, c.table, c.y);
  signal->over = name_column(reader, c.table, c.x);
  signal->point_count = c.count;
  *found = c.y->dimension;
  return take_rows(reader, &c, false, &signal->time, &signal->value);
}

/* ---- laws ---- */

enum { PIECES = 201, MOST_POINTS = 1000 };

/* Sums of rows in a piece of the range of x, of loading and of unloading. */
typedef struct piece {
  double x[2], y[2];
  size_t count[2];
} piece;

/* Sums rows by pieces; x has turned where it goes back by more than a twentieth of its range. */
static void sum_pieces(const columns *self, char *ways, piece pieces[PIECES]) {
  double least = self->x->least, range = self->x->most - least, extreme = (double)NAN;
  size_t turn = 0, rows = self->table->row_count;
  char way = 0; /* 1: unloading */
  for (size_t k = 0; k < rows; k++) {
    if (!is_whole(self, k)) continue;
    double x = self->x->values[k], ahead = way ? extreme - x : x - extreme;
    if (ahead < -0.05 * range) {
      way = !way, ahead = 1.0;
      memset(ways + turn + 1, way, k - turn);
    }
    ways[k] = way;
    if (!(ahead <= 0.0)) extreme = x, turn = k;
  }
  for (size_t k = 0; k < rows; k++) {
    if (!is_whole(self, k)) continue;
    double x = self->x->values[k];
    piece *p = &pieces[(size_t)((x - least) / range * (PIECES - 1) + 0.5)];
    p->x[(int)ways[k]] += x, p->y[(int)ways[k]] += self->y->values[k], p->count[(int)ways[k]]++;
  }
}

/* Means of both ways; returns their number and the largest difference between the ways. */
static size_t mean_of_ways(const piece *pieces, double *x, double *y, double *apart) {
  size_t count = 0;
  for (size_t i = 0; i < PIECES; i++) {
    double sum[2] = {0.0, 0.0}, mean[2] = {0.0, 0.0};
    int ways = 0;
    for (int w = 0; w < 2; w++) {
      double n = (double)pieces[i].count[w];
      if (n == 0.0) continue;
      sum[0] += pieces[i].x[w] / n, sum[1] += mean[w] = pieces[i].y[w] / n;
      ways++;
    }
    if (!ways) continue;
    if (ways == 2) *apart = fmax(*apart, fabs(mean[0] - mean[1]));
    x[count] = sum[0] / ways;
    y[count++] = sum[1] / ways;
  }
  return count;
}

/* A note of how the rows became a law. */
static bool take_means(strut_reader *reader, const columns *self, const strut_tree *value,
                       strut_law *law) {
  piece pieces[PIECES] = {{.count = {0}}};
  double *x = strut_keep_array(reader, 2 * PIECES, sizeof *x), apart = 0.0;
  char *ways = strut_scratch_array(reader, self->table->row_count, 1);
  if (!x || !ways) return false;
  if (!(self->x->most > self->x->least))
    return strut_refuse_data(reader, self->value, self->table, self->x, SIZE_MAX,
                             "this column is constant, expected one that varies");
  sum_pieces(self, ways, pieces);
  law->x = x, law->force = x + PIECES;
  law->count = mean_of_ways(pieces, x, x + PIECES, &apart);
  strut_note(reader->diagnostics, value->place,
             "the law of '%s' over '%s' is a mean of %zu rows at %zu places; loading and unloading "
             "differ by up to %.2g %s",
             law->data, law->over, self->count, law->count, apart,
             strut_dimension_unit(self->y->dimension));
  return true;
}

bool strut_read_data_law(strut_reader *reader, const strut_tree *value, const strut_tree *over,
                         strut_owner owner, const strut_dimension dimensions[2], strut_law *law) {
  columns c = {.table = NULL};
  c.y = strut_read_data_column(reader, value, "data", owner, &dimensions[1], &c.table);
  if (!c.y || !read_over(reader, over, value, owner, &dimensions[0], &c)) return false;
  law->data = name_column(reader, c.table, c.y);
  law->over = name_column(reader, c.table, c.x);
  bool rises = find_disorder(&c, 1.0) == SIZE_MAX, falls = find_disorder(&c, -1.0) == SIZE_MAX;
  if ((!rises && !falls) || c.count > MOST_POINTS) return take_means(reader, &c, value, law);
  bool fine = take_rows(reader, &c, !rises, &law->x, &law->force);
  law->count = fine ? c.count : 0;
  return fine;
}

/* ---- positions ---- */

/* The number of a column at a time, between rows, or in a row. False: that was reported. */
static bool read_at(strut_reader *reader, const strut_tree *value, strut_owner owner,
                    const strut_slot *time, const strut_row_keys *keys, double *number) {
  const strut_dimension length = STRUT_DIM_LENGTH;
  const strut_data_table *table;
  strut_signal signal = strut_signal_default(STRUT_DATA);
  double rate;
  if (time->state == STRUT_GIVEN) {
    strut_dimension found;
    if (!strut_read_data_signal(reader, value, NULL, owner, &length, &found, &signal)) return false;
    if (keys->time < signal.time[0] || keys->time > signal.time[signal.point_count - 1])
      return strut_report_error(reader, time->value->place,
                                "the data end before or begin after %g s", keys->time);
    strut_signal_evaluate(&signal, 0, keys->time, number, &rate);
    return true;
  }
  const strut_data_column *column =
      strut_read_data_column(reader, value, "x", owner, &length, &table);
  size_t row = (size_t)keys->row - 1;
  if (!column) return false;
  if (row >= table->row_count)
    return strut_report_error(reader, value->place, "data '%s' have %zu rows, expected one of them",
                              table->name, table->row_count);
  *number = column->values[row];
  return !isnan(*number) ||
         strut_refuse_data(reader, value, table, column, row, "expected a position, found a gap");
}

bool strut_read_data_point(strut_reader *reader, const strut_tree *map, strut_owner owner,
                           double point[2]) {
  strut_fields fields;
  strut_row_keys keys = {.row = 1};
  if (!strut_read_object(reader, STRUT_SECTION_ROW, map, owner, &fields, &keys)) return false;
  const strut_slot *time = strut_slot_of(&fields, STRUT_KEY_ROW_TIME);
  return read_at(reader, fields.slot[0].value, owner, time, &keys, &point[0]) &&
         read_at(reader, fields.slot[1].value, owner, time, &keys, &point[1]);
}
