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
#include "engine/output/buffer.h"
#include "engine/output/result_values.h"

enum { LEVEL = 9, RAW = -15, MEMORY = 9, DIGITS = 9 };
/* Values of a block at most: zlib counts its bytes in 32 bits. */
static const size_t MOST_VALUES = (size_t)1 << 28;

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

enum { MOST_GROUPS = 8 }; /* of 7 bits, of a number */

/* Writes a number in groups of 7 bits. Returns how many. */
static size_t put_number(int64_t n, unsigned char *to) {
  uint64_t left = n < 0 ? (uint64_t)(-n) * 2 - 1 : (uint64_t)n * 2;
  size_t size = 0;
  assert(left < UINT64_C(1) << 53);
  for (; left >= 128; left >>= 7) to[size++] = (unsigned char)(left | 128);
  to[size++] = (unsigned char)left;
  return size;
}

/* Column after column: first the number, then its difference, then second differences. */
static size_t put_numbers(const strut_rows *rows, double quantum, unsigned char *to) {
  size_t count = strut_rows_taken(rows), size = 0;
  for (size_t column = 0; column < rows->columns; column++) {
    int64_t previous = 0, slope = 0;
    for (size_t i = 0; i < count; i++) {
      int64_t n = llround(strut_rows_at(rows, i)[column] / quantum), step = n - previous;
      size += put_number(i == 0 ? n : i == 1 ? step : step - slope, to + size);
      previous = n, slope = step;
    }
  }
  return size;
}

static voidpf zip_allocate(voidpf opaque, uInt count, uInt size) {
  (void)opaque;
  return strut_allocate(count, size);
}

static void zip_release(voidpf opaque, voidpf memory) {
  (void)opaque;
  strut_release(memory);
}

static bool deflate_all(unsigned char *numbers, size_t size, strut_block *block) {
  z_stream zip = {.zalloc = zip_allocate, .zfree = zip_release};
  if (deflateInit2(&zip, LEVEL, Z_DEFLATED, RAW, MEMORY, Z_DEFAULT_STRATEGY) != Z_OK) return false;
  size_t room = deflateBound(&zip, size);
  block->bytes = strut_allocate(room, 1);
  zip.next_in = numbers, zip.avail_in = (uInt)size;
  zip.next_out = block->bytes, zip.avail_out = (uInt)room;
  bool good = block->bytes && deflate(&zip, Z_FINISH) == Z_STREAM_END;
  block->size = zip.total_out;
  deflateEnd(&zip);
  return good;
}

bool strut_block_encode(const strut_rows *rows, double quantum, strut_block *block) {
  *block = (strut_block){.quantum = quantum, .columns = rows->columns};
  unsigned char *numbers = strut_allocate(strut_rows_taken(rows) * rows->columns + 1, MOST_GROUPS);
  bool good = numbers && deflate_all(numbers, put_numbers(rows, quantum, numbers), block);
  strut_release(numbers);
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

/* Blocks: the time, then the channels in the order of their table. The page draws the motion, not velocities and lengths. */
enum {
  TIME,
  POSITION = 1 + STRUT_CHANNEL_PLACE_POSITION,
  ENERGY = 1 + STRUT_CHANNEL_PLACE_ENERGY,
  BLOCKS = 1 + STRUT_CHANNEL_COUNT
};
static const unsigned LEFT_OUT = STRUT_CHANNEL_VELOCITY | STRUT_CHANNEL_LENGTH;

static const strut_channel_row *channel_of(size_t block) {
  return strut_channel_row_of((strut_channels)1 << (block - 1));
}

typedef struct motion {
  const strut_page *page;
  size_t frames; /* those before the first that cannot be shown */
  strut_rows rows[BLOCKS];
  double quantum[BLOCKS];
  strut_block block[BLOCKS];
  char *text[BLOCKS]; /* those in base64 */
  double (*dots)[2];  /* (STRUT_DATA_DOTS) room for data */
} motion;

/* True if every node is within `reach` model sizes of its start. */
static bool is_within(const strut_model *model, const double *positions, double reach) {
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    if (fabs(positions[i] - model->start[i]) > reach * model->size) return false;
  return true;
}

static size_t count_frames(const motion *self) {
  const strut_trajectory *trajectory = self->page->motion;
  bool diverged = trajectory->status == STRUT_DIVERGED;
  double most = STRUT_MOST_QUANTA * POSITION_QUANTUM / 8;
  for (size_t f = 0; f < trajectory->frames; f++) {
    for (const strut_rows *rows = self->rows; rows < self->rows + BLOCKS; rows++)
      for (size_t k = 0; k < rows->columns && rows->values; k++)
        if (!isfinite(rows->values[f * rows->columns + k])) return f;
    const double *q = self->rows[POSITION].values + f * self->rows[POSITION].columns;
    if (!is_within(self->page->model, q, diverged ? DIVERGED_REACH : most)) return f;
  }
  return trajectory->frames;
}

static void find_rows(motion *self) {
  const strut_trajectory *trajectory = self->page->motion;
  self->rows[TIME] = (strut_rows){trajectory->time, trajectory->frames, 1, 1};
  for (size_t b = 1; b < BLOCKS; b++) {
    const strut_channel_row *row = channel_of(b);
    size_t columns = strut_channel_items(row, self->page->model->scene) * row->components;
    if (!(LEFT_OUT & row->id))
      self->rows[b] = (strut_rows){strut_trajectory_channel(trajectory, row->id),
                                   trajectory->frames, columns, 1};
  }
  self->frames = count_frames(self);
  for (int b = 0; b < BLOCKS; b++) self->rows[b].frames = self->frames;
}

static double time_quantum(const motion *self) {
  const strut_rows *time = &self->rows[TIME];
  double step = self->page->experiment->step;
  if (strut_rows_multiples(time, step)) return step;
  double span = time->values[self->frames - 1] - time->values[0];
  return strut_round_quantum(TIME_QUANTUM * span, strut_rows_largest(time));
}

/* The scale of forces and energies: the largest of all, but of a diverged run's first half, for
   beside what it ends with everything else would be nothing. */
static double largest_shown(const motion *self, const strut_rows *rows, double largest) {
  bool diverged =
      self->page->motion->status == STRUT_DIVERGED || self->frames < self->page->motion->frames;
  strut_rows half = *rows;
  half.frames = diverged ? (self->frames + 1) / 2 : self->frames;
  double scale = strut_rows_largest(&half);
  return scale > 0 ? scale : largest;
}

/* Energies of one column may be tiny beside those of another, and are curves all the same: the
   quantum suits the smallest column, within what a block holds at little cost. */
static double energy_quantum(const motion *self, const strut_rows *rows, double scale) {
  double wanted = VALUE_QUANTUM * scale;
  for (size_t c = 0; c < rows->columns; c++) {
    double largest = 0;
    for (size_t f = 0; f < self->frames; f++) {
      double value = fabs(rows->values[f * rows->columns + c]);
      if (value > largest) largest = value;
    }
    if (largest > 0 && COLUMN_QUANTUM * largest < wanted) wanted = COLUMN_QUANTUM * largest;
  }
  return fmax(wanted, LEAST_QUANTUM * scale);
}

static double wanted_quantum(const motion *self, int b, double largest) {
  if (b == POSITION) return POSITION_QUANTUM * self->page->model->size;
  double scale = largest_shown(self, &self->rows[b], largest);
  return b == ENERGY ? energy_quantum(self, &self->rows[b], scale) : VALUE_QUANTUM * scale;
}

static void choose_quanta(motion *self) {
  self->quantum[TIME] = time_quantum(self);
  for (int b = 1; b < BLOCKS; b++) {
    if (!self->rows[b].values) continue;
    double largest = strut_rows_largest(&self->rows[b]);
    self->quantum[b] = strut_round_quantum(wanted_quantum(self, b, largest), largest);
  }
}

static void free_blocks(motion *self) {
  for (int b = 0; b < BLOCKS; b++) strut_block_free(&self->block[b]);
}

/* Encodes every `every`-th frame. Returns the bytes in base64, or 0 when memory is out. */
static size_t encode(motion *self, size_t every) {
  size_t bytes = 0;
  free_blocks(self);
  for (int b = 0; b < BLOCKS; b++) {
    if (!self->rows[b].values) continue;
    self->rows[b].every = every;
    if (!strut_block_encode(&self->rows[b], self->quantum[b], &self->block[b])) return 0;
    bytes += (self->block[b].size + 2) / 3 * 4;
  }
  return bytes;
}

/* Leaves out half of the frames as often as needed. Half the frames never take less than half the
   bytes, so that two halvings at once are right where four times the room is filled. */
static bool choose_frames(motion *self, size_t room) {
  size_t every = 1, bytes, most = 1;
  for (int b = 0; b < BLOCKS; b++)
    if (self->rows[b].values && self->rows[b].columns > most) most = self->rows[b].columns;
  while (self->frames / every > MOST_VALUES / most) every *= 2;
  while ((bytes = encode(self, every)) > room && strut_rows_taken(&self->rows[TIME]) > 2) {
    size_t more = 2;
    while (bytes / room >= 2 * more) more *= 2;
    every *= more;
  }
  return bytes > 0;
}

/* ---- as rows ---- */

/* The block that is shown, counted from the time on. */
static size_t block_of(const strut_result_object *of) {
  const motion *self = strut_result_whole(of);
  return (size_t)((const strut_block *)of->at - self->block);
}

static strut_value component_of(const strut_result_object *of, size_t i) {
  return STRUT_VALUE_AS_TEXT(channel_of(block_of(of))->component_names[i]);
}

static strut_value name_of(const strut_result_object *of, size_t i) {
  const motion *self = strut_result_whole(of);
  return STRUT_VALUE_AS_TEXT(
      strut_channel_item(channel_of(block_of(of)), self->page->model->scene, i));
}

/* Data beside a column of a channel. */
static strut_value dots_of(const strut_result_object *of, size_t k) {
  const motion *self = strut_result_whole(of);
  const double *time = self->rows[TIME].values, span[] = {time[0], time[self->frames - 1]};
  size_t count =
      strut_data_dots(self->page->model->scene, channel_of(block_of(of)), k, span, self->dots);
  return STRUT_VALUE_AS_ROUNDED(DIGITS, TABLE(self->dots, count, 2));
}

#define BLOCK(X)                                                                                   \
  X("columns", "", COUNT(m->block[b].columns), "numbers of a frame")                               \
  X("quantum", "", NUMBER(m->block[b].quantum), "what a whole number stands for")                  \
  X("unit", "", TEXT(row ? strut_channel_unit(row, scene) : "s"), "of it")                         \
  X("names", "", IF(named, ARRAY(strut_channel_items(row, scene), name_of)), "whose it is")        \
  X("components", "", IF(row, ARRAY(row->components, component_of)), "of each thing")              \
  X("data", "", IF(row && scene->table_count, ARRAY(m->block[b].columns, dots_of)), "beside each") \
  X("bytes", "", TEXT(m->text[b]), "see page.h")
STRUT_VALUES_HERE(block_values, BLOCK, const motion *m = strut_result_whole(of);
                  size_t b = block_of(of); const strut_scene *scene = m->page->model->scene;
                  const strut_channel_row *row = b == TIME ? NULL : channel_of(b);
                  bool named = row && !strut_channel_is_whole(row))

static const char *channel_name(const strut_result_object *of, size_t i) {
  (void)of;
  return channel_of(i + 1)->name;
}

static strut_value channel_block(const strut_result_object *of, size_t i) {
  const motion *self = of->at;
  if (LEFT_OUT & channel_of(i + 1)->id) return (strut_value){0};
  return STRUT_VALUE_AS_KNOWN(self->text[i + 1], PART(&self->block[i + 1]));
}

static strut_value energy_name(const strut_result_object *of, size_t i) {
  (void)of;
  return STRUT_VALUE_AS_TEXT(channel_of(ENERGY)->component_names[i]);
}

#define MOTION(X)                                                                                  \
  X("frames", "", COUNT(strut_rows_taken(&m->rows[TIME])), "on the page")                          \
  X("recorded", "", COUNT(t->recorded), "frames")                                                  \
  X("every", "", COUNT(t->every * m->rows[TIME].every), "recorded frame is on the page")           \
  X("status", "", TEXT(strut_status_text(m->frames < t->frames ? STRUT_DIVERGED : t->status)), "") \
  X("track", "", INDEX(m->page->experiment->measure_node), "node index, or null")                  \
  X("time", "", PART(&m->block[TIME]), "block", .rows = &block_values)                             \
  X(NULL, "", MAP(STRUT_CHANNEL_COUNT, channel_name, channel_block), "", .rows = &block_values)    \
  X("energy_names", "", ARRAY(STRUT_ENERGIES, energy_name), "components of the energy")            \
  X("weights", "kg", NUMBERS(m->page->model->weight, m->page->model->node_count), "of the nodes")
STRUT_VALUES_HERE(motion_values, MOTION, const motion *m = of->at;
                  const strut_trajectory *t = m->page->motion)

/* The motion as JSON; NULL: out of memory. */
static char *write_motion(motion *self) {
  char *json = NULL;
  self->dots = strut_allocate(STRUT_DATA_DOTS, sizeof *self->dots);
  bool good = self->dots;
  for (int b = 0; b < BLOCKS && good; b++) {
    strut_buffer text = {0};
    if (!self->block[b].bytes) continue;
    strut_base64_add(&text, self->block[b].bytes, self->block[b].size);
    self->text[b] = strut_buffer_take(&text);
    good = self->text[b] != NULL;
  }
  if (good) json = strut_values_json(&motion_values, self, NULL);
  for (int b = 0; b < BLOCKS; b++) strut_release(self->text[b]);
  strut_release(self->dots);
  return json;
}

char *strut_page_motion(const strut_page *page, size_t room, strut_page_frames *frames) {
  static const char none[] = "null";
  motion m = {.page = page};
  if (page->motion && page->motion->position && page->motion->frames > 0) find_rows(&m);
  if (m.frames == 0) {
    char *text = strut_allocate(sizeof none, 1);
    return text ? memcpy(text, none, sizeof none) : NULL;
  }
  choose_quanta(&m);
  char *json = choose_frames(&m, room) ? write_motion(&m) : NULL;
  *frames = (strut_page_frames){strut_rows_taken(&m.rows[TIME]), page->motion->recorded};
  free_blocks(&m);
  return json;
}
