/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/page/page.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "engine/base/memory.h"
#include "engine/base/number_text.h"
#include "engine/output/buffer.h"

enum { PIECE = 1 << 16, LONGEST_NUMBER = 10, LEVEL = 9, RAW = -15, MEMORY = 9 };

size_t strut_rows_taken(const strut_rows *rows) {
  if (rows->frames == 0) return 0;
  return (rows->frames - 1) / rows->every + 1 + ((rows->frames - 1) % rows->every != 0);
}

const double *strut_rows_at(const strut_rows *rows, size_t i) {
  assert(i < strut_rows_taken(rows));
  size_t frame = i * rows->every;
  if (frame >= rows->frames) frame = rows->frames - 1;
  return rows->values + frame * rows->columns;
}

double strut_rows_largest(const strut_rows *rows) {
  double largest = 0;
  for (size_t i = 0; i < rows->frames * rows->columns; i++)
    if (fabs(rows->values[i]) > largest) largest = fabs(rows->values[i]);
  return largest;
}

/* The double nearest to digit * 10^power, as a reader of the text obtains it. */
static double decimal(int digit, int power) {
  char text[32];
  snprintf(text, sizeof text, "%de%d", digit, power);
  return strtod(text, NULL);
}

double strut_round_quantum(double wanted, double largest) {
  static const int digits[] = {1, 2, 5};
  double least = largest / STRUT_MOST_QUANTA, quantum = 0;
  if (least < DBL_MIN) least = DBL_MIN;
  if (!(wanted > least)) wanted = least;
  int power = (int)floor(log10(wanted)) - 1;
  for (int k = 0; k < 9; k++) {
    double next = decimal(digits[k % 3], power + k / 3);
    if (isinf(next) || (next > wanted && quantum >= least)) break;
    quantum = next;
  }
  return quantum;
}

bool strut_rows_multiples(const strut_rows *rows, double quantum) {
  if (!(quantum > 0)) return false;
  for (size_t i = 0; i < rows->frames * rows->columns; i++) {
    double value = rows->values[i], n = round(value / quantum);
    if (fabs(n) > STRUT_MOST_QUANTA) return false;
    if (fabs(n * quantum - value) > 4 * DBL_EPSILON * fabs(value)) return false;
  }
  return true;
}

/* Deflates piece by piece into a block that grows. */
typedef struct packer {
  z_stream zip;
  strut_block *block;
  size_t room, waiting;
  unsigned char piece[PIECE];
} packer;

static voidpf zip_allocate(voidpf opaque, uInt count, uInt size) {
  (void)opaque;
  return strut_allocate(count, size);
}

static void zip_release(voidpf opaque, voidpf memory) {
  (void)opaque;
  strut_release(memory);
}

static bool make_room(packer *p) {
  strut_block *block = p->block;
  if (block->size < p->room) return true;
  size_t room = 2 * p->room + 1024;
  unsigned char *more = strut_reallocate(block->bytes, room, 1);
  if (!more) return false;
  block->bytes = more;
  p->room = room;
  return true;
}

/* Passes the waiting bytes to zlib; `flush` as in deflate. */
static bool deflate_waiting(packer *p, int flush) {
  int state;
  p->zip.next_in = p->piece;
  p->zip.avail_in = (uInt)p->waiting;
  p->waiting = 0;
  do {
    if (!make_room(p)) return false;
    size_t left = p->room - p->block->size;
    uInt offered = left < PIECE ? (uInt)left : PIECE;
    p->zip.next_out = p->block->bytes + p->block->size;
    p->zip.avail_out = offered;
    state = deflate(&p->zip, flush);
    p->block->size += offered - p->zip.avail_out;
    if (state == Z_STREAM_ERROR) return false;
  } while (p->zip.avail_in > 0 || (flush == Z_FINISH && state != Z_STREAM_END));
  return true;
}

static bool put_number(packer *p, int64_t n) {
  uint64_t left = n < 0 ? (uint64_t)(-n) * 2 - 1 : (uint64_t)n * 2;
  assert(left < UINT64_C(1) << 53);
  if (p->waiting + LONGEST_NUMBER > PIECE && !deflate_waiting(p, Z_NO_FLUSH)) return false;
  for (; left >= 128; left >>= 7) p->piece[p->waiting++] = (unsigned char)(left | 128);
  p->piece[p->waiting++] = (unsigned char)left;
  return true;
}

/* First the number, then its difference, then second differences. */
static bool put_column(packer *p, const strut_rows *rows, size_t column, double quantum) {
  size_t count = strut_rows_taken(rows);
  int64_t previous = 0, slope = 0;
  for (size_t i = 0; i < count; i++) {
    int64_t n = llround(strut_rows_at(rows, i)[column] / quantum);
    int64_t step = n - previous;
    if (!put_number(p, i == 0 ? n : i == 1 ? step : step - slope)) return false;
    previous = n;
    slope = step;
  }
  return true;
}

bool strut_block_encode(const strut_rows *rows, double quantum, strut_block *block) {
  *block = (strut_block){.quantum = quantum, .columns = rows->columns};
  packer *p = strut_allocate(1, sizeof *p);
  if (!p) return false;
  p->block = block;
  p->zip.zalloc = zip_allocate;
  p->zip.zfree = zip_release;
  bool good = deflateInit2(&p->zip, LEVEL, Z_DEFLATED, RAW, MEMORY, Z_DEFAULT_STRATEGY) == Z_OK;
  if (good) {
    for (size_t c = 0; c < rows->columns && good; c++) good = put_column(p, rows, c, quantum);
    good = good && deflate_waiting(p, Z_FINISH);
    deflateEnd(&p->zip);
  }
  strut_release(p);
  if (!good) strut_block_free(block);
  return good;
}

void strut_block_free(strut_block *block) {
  strut_release(block->bytes);
  *block = (strut_block){0};
}

/* The motion of the page's data: which frames, how fine, and their blocks. */

/* Quanta: of positions in sizes; of what is drawn as curves and colours in the largest of all, but
   of energies in that of the smallest column; of times that are no whole steps in their span. */
static const double POSITION_QUANTUM = 1e-6, VALUE_QUANTUM = 1e-5, COLUMN_QUANTUM = 1e-3,
                    LEAST_QUANTUM = 1e-10, TIME_QUANTUM = 1e-12;
/* A diverged run is shown up to this distance from its start, in sizes. */
static const double DIVERGED_REACH = 1e3;

/*
 * Blocks: the time, then the channels in the order of their table. The page draws the motion, not velocities
 * and lengths; it has charts of its own for some channels, whose keys are always there, and a common one for
 * others.
 */
enum {
  TIME,
  POSITION = 1 + STRUT_CHANNEL_PLACE_POSITION,
  ENERGY = 1 + STRUT_CHANNEL_PLACE_ENERGY,
  BLOCKS = 1 + STRUT_CHANNEL_COUNT
};
static const unsigned LEFT_OUT = STRUT_CHANNEL_VELOCITY | STRUT_CHANNEL_LENGTH,
                      OWN_CHARTS = STRUT_CHANNEL_POSITION | STRUT_CHANNEL_FORCE |
                                   STRUT_CHANNEL_CONTACT | STRUT_CHANNEL_ENERGY |
                                   STRUT_CHANNEL_ANGLE | STRUT_CHANNEL_MOMENT | STRUT_CHANNEL_AREA |
                                   STRUT_CHANNEL_PRESSURE;

static const strut_channel_row *channel_of(int block) {
  return strut_channel_row_of((strut_channels)1 << (block - 1));
}

static bool has_common_chart(int block) {
  return block != TIME && !(OWN_CHARTS & channel_of(block)->id);
}

typedef struct motion {
  const strut_page *page;
  size_t frames; /* those before the first that cannot be shown */
  strut_rows rows[BLOCKS];
  double quantum[BLOCKS];
  strut_block block[BLOCKS];
} motion;

static bool all_finite(const double *values, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (!isfinite(values[i])) return false;
  return true;
}

/* True if every node is within `reach` model sizes of its start. */
static bool is_within(const strut_model *model, const double *q, double reach) {
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
      if (rows->values && !all_finite(rows->values + f * rows->columns, rows->columns)) return f;
    }
    const double *q = m->rows[POSITION].values + f * m->rows[POSITION].columns;
    if (!is_within(m->page->model, q, diverged ? DIVERGED_REACH : most)) return f;
  }
  return t->frames;
}

static void find_rows(motion *m) {
  const strut_trajectory *t = m->page->motion;
  m->rows[TIME] = (strut_rows){t->time, t->frames, 1, 1};
  for (int b = 1; b < BLOCKS; b++) {
    const strut_channel_row *row = channel_of(b);
    size_t columns = strut_channel_items(row, m->page->model->scene) * row->components;
    if (!(LEFT_OUT & row->id))
      m->rows[b] = (strut_rows){strut_trajectory_channel(t, row->id), t->frames, columns, 1};
  }
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
static double largest_shown(const motion *m, const strut_rows *rows, double largest) {
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
  double scale = largest_shown(m, &m->rows[b], largest);
  return b == ENERGY ? energy_quantum(m, &m->rows[b], scale) : VALUE_QUANTUM * scale;
}

static void choose_quanta(motion *m) {
  m->quantum[TIME] = time_quantum(m);
  for (int b = 1; b < BLOCKS; b++) {
    if (!m->rows[b].values) continue;
    double largest = strut_rows_largest(&m->rows[b]);
    m->quantum[b] = strut_round_quantum(wanted_quantum(m, b, largest), largest);
  }
}

static void free_blocks(motion *m) {
  for (int b = 0; b < BLOCKS; b++) strut_block_free(&m->block[b]);
}

/* Encodes every `every`-th frame. Returns the bytes in base64, or 0 when memory is out. */
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
static bool choose_frames(motion *m, size_t room) {
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

/* A channel without a chart of its own says what the common one needs to know. */
static void add_block(strut_buffer *buffer, const motion *m, int b) {
  const strut_block *block = &m->block[b];
  if (!block->bytes) {
    strut_buffer_add(buffer, "null");
    return;
  }
  strut_buffer_add(buffer, "{\"columns\":%zu,\"quantum\":", block->columns);
  add_number(buffer, block->quantum);
  if (has_common_chart(b)) {
    const strut_channel_row *row = channel_of(b);
    const strut_scene *scene = m->page->model->scene;
    bool whole = strut_channel_is_whole(row);
    strut_buffer_add(buffer, ",\"unit\":\"%s\",\"things\":\"%s\",\"names\":[", row->unit,
                     strut_owner_row_of(row->owner)->things);
    for (size_t i = 0; i < strut_channel_items(row, scene); i++)
      strut_buffer_add(buffer, "%s\"%s\"", i ? "," : "",
                       whole ? row->name : strut_channel_item(row, scene, i));
    strut_buffer_add(buffer, "],\"components\":[");
    for (size_t i = 0; i < row->components; i++)
      strut_buffer_add(buffer, "%s\"%s\"", i ? "," : "", row->component_names[i]);
    strut_buffer_add(buffer, "]");
  }
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
  for (int b = 0; b < BLOCKS; b++) {
    if (has_common_chart(b) && !m->block[b].bytes) continue;
    strut_buffer_add(buffer, ",\"%s\":", b == TIME ? "time" : channel_of(b)->name);
    add_block(buffer, m, b);
  }
  strut_buffer_add(buffer, ",\"energy_names\":[");
  for (size_t i = 0; i < STRUT_ENERGIES; i++)
    strut_buffer_add(buffer, "%s\"%s\"", i ? "," : "", channel_of(ENERGY)->component_names[i]);
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
  if (page->motion && page->motion->position && page->motion->frames > 0) find_rows(&m);
  if (m.frames == 0) {
    strut_buffer_add(buffer, "null");
    return;
  }
  choose_quanta(&m);
  if (choose_frames(&m, room))
    add_motion(buffer, &m);
  else
    buffer->failed = true;
  *frames = (strut_page_frames){strut_rows_taken(&m.rows[TIME]), page->motion->recorded};
  free_blocks(&m);
}
