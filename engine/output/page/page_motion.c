/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The motion of the page's data: which frames, how fine, and their blocks. */
#include <math.h>

#include "engine/base/memory.h"
#include "engine/base/number_text.h"
#include "engine/output/base64.h"
#include "engine/output/page/page_blocks.h"
#include "engine/output/page/page_parts.h"

/* Quanta: of positions in sizes; of what is drawn as curves and colours in the largest of all, but
   of energies in that of the smallest column; of times that are no whole steps in their span. */
static const double POSITION_QUANTUM = 1e-6, VALUE_QUANTUM = 1e-5, COLUMN_QUANTUM = 1e-3,
                    LEAST_QUANTUM = 1e-10, TIME_QUANTUM = 1e-12;
/* A diverged run is shown until it is so many sizes from where it began. */
static const double FAR = 1e3;

enum { TIME, POSITION, FORCE, CONTACT, ENERGY, BLOCKS };
static const char *const keys[BLOCKS] = {"time", "position", "force", "contact", "energy"};
static const char *const energy_names[STRUT_ENERGIES] = {"kinetic",
                                                         "elastic",
                                                         "gravity",
                                                         "contact",
                                                         "drive_work",
                                                         "load_work",
                                                         "belt_work",
                                                         "dissipated_members",
                                                         "dissipated_contact",
                                                         "dissipated_friction"};

typedef struct motion {
  const strut_page *page;
  size_t frames; /* those before the first that cannot be shown */
  strut_rows rows[BLOCKS];
  double quantum[BLOCKS];
  strut_block block[BLOCKS];
} motion;

static bool finite(const double *values, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (!isfinite(values[i])) return false;
  return true;
}

/* Whether every node is within reach of its start; `reach` in sizes. */
static bool near(const strut_model *model, const double *q, double reach) {
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    if (fabs(q[i] - model->start[i]) > reach * model->size) return false;
  return true;
}

static size_t count_frames(const motion *m) {
  const strut_trajectory *t = m->page->motion;
  bool diverged = t->status == STRUT_DIVERGED;
  double most = STRUT_MOST_QUANTA * POSITION_QUANTUM / 8;
  for (size_t f = 0; f < t->frames; f++) {
    for (int b = 0; b < BLOCKS; b++) {
      const strut_rows *rows = &m->rows[b];
      if (rows->values && !finite(rows->values + f * rows->columns, rows->columns)) return f;
    }
    const double *q = m->rows[POSITION].values + f * m->rows[POSITION].columns;
    if (!near(m->page->model, q, diverged ? FAR : most)) return f;
  }
  return t->frames;
}

static void take_rows(motion *m) {
  const strut_trajectory *t = m->page->motion;
  m->rows[TIME] = (strut_rows){t->time, t->frames, 1, 1};
  m->rows[POSITION] = (strut_rows){t->position, t->frames, 2 * t->node_count, 1};
  m->rows[FORCE] = (strut_rows){t->force, t->frames, t->member_count, 1};
  m->rows[CONTACT] = (strut_rows){t->contact, t->frames, 2 * t->contact_count, 1};
  m->rows[ENERGY] = (strut_rows){t->energy, t->frames, STRUT_ENERGIES, 1};
  m->frames = count_frames(m);
  for (int b = 0; b < BLOCKS; b++) m->rows[b].frames = m->frames;
}

static double time_quantum(const motion *m) {
  const strut_rows *time = &m->rows[TIME];
  double step = m->page->experiment->step;
  if (strut_rows_multiples(time, step)) return step;
  double span = time->values[m->frames - 1] - time->values[0];
  return strut_round_quantum(TIME_QUANTUM * span, strut_rows_largest(time));
}

/* The scale of forces and energies: the largest of all, but of a diverged run's first half, for
   beside what it ends with everything else would be nothing. */
static double scale_of(const motion *m, const strut_rows *rows, double largest) {
  bool diverged = m->page->motion->status == STRUT_DIVERGED || m->frames < m->page->motion->frames;
  strut_rows half = *rows;
  half.frames = diverged ? (m->frames + 1) / 2 : m->frames;
  double scale = strut_rows_largest(&half);
  return scale > 0 ? scale : largest;
}

/* Energies of one column may be tiny beside those of another, and are curves all the same: the
   quantum suits the smallest column, within what a block holds at little cost. */
static double energy_quantum(const motion *m, const strut_rows *rows, double scale) {
  double wanted = VALUE_QUANTUM * scale;
  for (size_t c = 0; c < rows->columns; c++) {
    double largest = 0;
    for (size_t f = 0; f < m->frames; f++) {
      double value = fabs(rows->values[f * rows->columns + c]);
      if (value > largest) largest = value;
    }
    if (largest > 0 && COLUMN_QUANTUM * largest < wanted) wanted = COLUMN_QUANTUM * largest;
  }
  return fmax(wanted, LEAST_QUANTUM * scale);
}

static double wanted_quantum(const motion *m, int b, double largest) {
  if (b == POSITION) return POSITION_QUANTUM * m->page->model->size;
  double scale = scale_of(m, &m->rows[b], largest);
  return b == ENERGY ? energy_quantum(m, &m->rows[b], scale) : VALUE_QUANTUM * scale;
}

static void choose_quanta(motion *m) {
  m->quantum[TIME] = time_quantum(m);
  for (int b = POSITION; b < BLOCKS; b++) {
    if (!m->rows[b].values) continue;
    double largest = strut_rows_largest(&m->rows[b]);
    m->quantum[b] = strut_round_quantum(wanted_quantum(m, b, largest), largest);
  }
}

static void free_blocks(motion *m) {
  for (int b = 0; b < BLOCKS; b++) strut_block_free(&m->block[b]);
}

/* All blocks of every so many-th frame. Their bytes in base64, or 0 when memory is out. */
static size_t encode(motion *m, size_t every) {
  size_t bytes = 0;
  free_blocks(m);
  for (int b = 0; b < BLOCKS; b++) {
    if (!m->rows[b].values) continue;
    m->rows[b].every = every;
    if (!strut_block_encode(&m->rows[b], m->quantum[b], &m->block[b])) return 0;
    bytes += (m->block[b].size + 2) / 3 * 4;
  }
  return bytes;
}

/* Leaves out half of the frames as often as needed. Half the frames never take less than half the
   bytes, so that two halvings at once are right where four times the room is filled. */
static bool fit(motion *m, size_t room) {
  size_t every = 1, bytes;
  while ((bytes = encode(m, every)) > room && strut_rows_taken(&m->rows[TIME]) > 2) {
    size_t more = 2;
    while (bytes / room >= 2 * more) more *= 2;
    every *= more;
  }
  return bytes > 0;
}

static void add_number(strut_buffer *buffer, double value) {
  char text[STRUT_NUMBER_TEXT];
  strut_number_text(value, text);
  strut_buffer_add(buffer, "%s", text);
}

static void add_block(strut_buffer *buffer, const char *key, const strut_block *block) {
  strut_buffer_add(buffer, ",\"%s\":", key);
  if (!block->bytes) {
    strut_buffer_add(buffer, "null");
    return;
  }
  strut_buffer_add(buffer, "{\"columns\":%zu,\"quantum\":", block->columns);
  add_number(buffer, block->quantum);
  strut_buffer_add(buffer, ",\"bytes\":\"");
  strut_base64_add(buffer, block->bytes, block->size);
  strut_buffer_add(buffer, "\"}");
}

static void add_head(strut_buffer *buffer, const motion *m) {
  const strut_trajectory *t = m->page->motion;
  bool cut = m->frames < t->frames;
  strut_status status = cut ? STRUT_DIVERGED : t->status;
  strut_buffer_add(buffer, "{\"frames\":%zu,\"recorded\":%zu,\"every\":%zu",
                   strut_rows_taken(&m->rows[TIME]), t->recorded, t->every * m->rows[TIME].every);
  strut_buffer_add(buffer, ",\"status\":\"%s\",\"track\":", strut_status_text(status));
  int32_t track = m->page->experiment->measure_node;
  if (track >= 0)
    strut_buffer_add(buffer, "%d", (int)track);
  else
    strut_buffer_add(buffer, "null");
}

static void add_motion(strut_buffer *buffer, const motion *m) {
  const strut_model *model = m->page->model;
  add_head(buffer, m);
  for (int b = 0; b < BLOCKS; b++) add_block(buffer, keys[b], &m->block[b]);
  strut_buffer_add(buffer, ",\"energy_names\":[");
  for (int i = 0; i < STRUT_ENERGIES; i++)
    strut_buffer_add(buffer, "%s\"%s\"", i ? "," : "", energy_names[i]);
  strut_buffer_add(buffer, "],\"weights\":[");
  for (int32_t i = 0; i < model->node_count; i++) {
    if (i) strut_buffer_add(buffer, ",");
    add_number(buffer, model->weight[i]);
  }
  strut_buffer_add(buffer, "]}");
}

void strut_page_add_motion(strut_buffer *buffer, const strut_page *page, size_t room,
                           strut_page_frames *frames) {
  motion m = {.page = page};
  if (page->motion && page->motion->position && page->motion->frames > 0) take_rows(&m);
  if (m.frames == 0) {
    strut_buffer_add(buffer, "null");
    return;
  }
  choose_quanta(&m);
  if (fit(&m, room))
    add_motion(buffer, &m);
  else
    buffer->failed = true;
  *frames = (strut_page_frames){strut_rows_taken(&m.rows[TIME]), page->motion->recorded};
  free_blocks(&m);
}
