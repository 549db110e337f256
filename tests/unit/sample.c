/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/sample.h"

#include "tests/support/test.h"

#include "tests/support/test.h"

static const char *const nodes[] = {"n1", "left, \"upper\"", "\xc3\xa4"};
static const char *const members[] = {"m1", "m2"};
static const char *const total[] = {"total"};
static const char *const axes[] = {"x", "y"};
static const char *const single[] = {""};
static const char *const reactions[] = {"normal", "friction"};
static const char *const energies[] = {"kinetic", "elastic", "gravity"};

static const strut_record_channel channels[] = {
    {STRUT_CHANNEL_POSITION, "position", "m", 3, 2, 1, nodes, axes, NULL},
    {STRUT_CHANNEL_VELOCITY, "velocity", "m/s", 3, 2, 7, nodes, axes, NULL},
    {STRUT_CHANNEL_LENGTH, "length", "m", 2, 1, 13, members, single, NULL},
    {STRUT_CHANNEL_FORCE, "force", "N", 2, 1, 15, members, single, NULL},
    {STRUT_CHANNEL_CONTACT, "contact", "N", 2, 2, 17, nodes, reactions, NULL},
    {STRUT_CHANNEL_ENERGY, "energy", "J", 1, 3, 21, total, energies, NULL}};

static const strut_record_layout layout = {24, 6, channels, 40};

const strut_record_layout *sample_layout(void) { return &layout; }

double sample_value(size_t row, size_t column) {
  if (column == 0) return 0.1 * (double)row;
  uint64_t mixed = (row * 64 + column) * UINT64_C(0x9e3779b97f4a7c15);
  double unit = (double)(mixed >> 11) / 9007199254740992.0 - 0.5;
  return ldexp(unit, (int)(mixed % 60) - 40);
}

double *sample_rows(const strut_record_layout *of, size_t first, size_t count) {
  double *rows = calloc(count * of->width, sizeof *rows);
  for (size_t i = 0; i < count * of->width; i++)
    rows[i] = sample_value(first + i / of->width, i % of->width);
  return rows;
}

strut_status sample_feed(strut_sink *sink, size_t count, strut_status run_status,
                         strut_error *error) {
  strut_status status = sink->begin(sink->context, &layout, error);
  if (status != STRUT_OK) return status;
  size_t portion = 1;
  for (size_t done = 0; done < count && status == STRUT_OK; done += portion, portion += 6) {
    if (portion > count - done) portion = count - done;
    FREED double *rows = sample_rows(&layout, done, portion);
    status = sink->rows(sink->context, rows, portion, error);
  }
  strut_status ended = sink->end(sink->context, status == STRUT_OK ? run_status : status, error);
  return status == STRUT_OK ? ended : status;
}
