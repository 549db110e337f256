/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/page/page_blocks.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "engine/base/memory.h"

enum { PIECE = 1 << 16, LONGEST_NUMBER = 10, LEVEL = 9, RAW = -15, MEMORY = 9 };

size_t strut_rows_taken(const strut_rows *rows) {
  if (rows->frames == 0) return 0;
  return (rows->frames - 1) / rows->every + 1 + ((rows->frames - 1) % rows->every != 0);
}

const double *strut_rows_at(const strut_rows *rows, size_t i) {
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

/* The double nearest to digit * 10^power: what a reader makes of the text. */
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

/* Hands what waits to zlib; `flush` as in deflate. */
static bool push(packer *p, int flush) {
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

static bool put(packer *p, int64_t n) {
  uint64_t left = n < 0 ? (uint64_t)(-n) * 2 - 1 : (uint64_t)n * 2;
  assert(left < UINT64_C(1) << 53);
  if (p->waiting + LONGEST_NUMBER > PIECE && !push(p, Z_NO_FLUSH)) return false;
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
    if (!put(p, i == 0 ? n : i == 1 ? step : step - slope)) return false;
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
    good = good && push(p, Z_FINISH);
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
