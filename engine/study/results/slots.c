/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/results/slots.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "engine/base/checksum.h"
#include "engine/study/results/slots_parts.h"

enum { BLOCK_BYTES = 1 << 14, BITS = 64 };

struct strut_slots {
  int descriptor;
  bool writes, shared;
  atomic_bool unsynced; /* rows were written since the last sync */
  char *path;
  strut_slots_description plan;
  strut_slots_layout layout;
  uint64_t seed; /* of the checksums, so that slots of another study are not valid here */
  atomic_uint_fast64_t *done;
  atomic_int_fast64_t missing, failed;
  unsigned char *block; /* (block_slots * slot_bytes) most recently read slots */
  int64_t block_slots, block_first, block_count;
  double *numbers;
  char (*words)[STRUT_SLOT_WORD];
  char message[STRUT_SLOT_MESSAGE];
  strut_arena arena;
  bool retried;              /* rows of points that failed may be written again */
  _Atomic int64_t rewritten; /* rows written since then */
  int64_t block_rewritten;   /* when the block was read */
};

/* The first bytes of a slot. */
typedef struct slot_head {
  uint64_t checksum; /* of the bytes after it; never 0, so that a hole in the file is not a slot */
  int64_t point;
  uint32_t status, reserved;
} slot_head;

_Static_assert(sizeof(slot_head) == STRUT_SLOT_HEAD, "no gaps in what is written");

static strut_status no_memory(strut_error *error, const char *path) {
  return strut_fail(error, STRUT_NO_MEMORY, "out of memory for the results in '%s'", path);
}

static int64_t offset_of(const strut_slots *slots, int64_t i) {
  return (int64_t)slots->layout.header_bytes + i * (int64_t)slots->layout.slot_bytes;
}

/* The slot of a point, or -1. */
static int64_t slot_of(const strut_slots *slots, int64_t point) {
  int64_t from = point - slots->plan.first;
  if (from < 0) return -1;
  if (slots->plan.stride == 1) return from < slots->plan.count ? from : -1;
  int64_t i = from / slots->plan.stride;
  return i * slots->plan.stride == from && i < slots->plan.count ? i : -1;
}

static uint64_t checksum_of(const strut_slots *slots, const unsigned char *slot) {
  size_t head = sizeof(uint64_t);
  uint64_t sum = strut_checksum(slot + head, slots->layout.slot_bytes - head, slots->seed);
  return sum ? sum : 1;
}

/* Are these bytes a complete slot i? */
static bool is_whole(const strut_slots *slots, int64_t i, const unsigned char *slot) {
  slot_head head;
  memcpy(&head, slot, sizeof head);
  return head.checksum && head.point == strut_slots_point(slots, i) &&
         head.status < STRUT_STATUS_COUNT && head.checksum == checksum_of(slots, slot);
}

static void mark(strut_slots *slots, int64_t i, uint32_t status) {
  atomic_fetch_or_explicit(&slots->done[i / BITS], (uint64_t)1 << i % BITS, memory_order_release);
  atomic_fetch_sub_explicit(&slots->missing, 1, memory_order_relaxed);
  if (status != STRUT_OK) atomic_fetch_add_explicit(&slots->failed, 1, memory_order_relaxed);
}

/* Reads the block of slots that starts at i, up to the end of the file. */
static strut_status load(strut_slots *slots, int64_t i, strut_error *error) {
  int64_t count =
      slots->plan.count - i < slots->block_slots ? slots->plan.count - i : slots->block_slots;
  slots->block_count = 0;
  slots->block_rewritten = atomic_load(&slots->rewritten);
  int64_t got = strut_slots_pread(slots->descriptor, slots->block,
                                  (size_t)count * slots->layout.slot_bytes, offset_of(slots, i));
  if (got < 0) return strut_file_fail(error, "read", slots->path, errno);
  slots->block_first = i;
  slots->block_count = got / (int64_t)slots->layout.slot_bytes;
  return STRUT_OK;
}

/* Determines which slots exist. */
static strut_status scan(strut_slots *slots, strut_error *error) {
  strut_status status = STRUT_OK;
  for (int64_t at = 0; at < slots->plan.count && status == STRUT_OK; at += slots->block_count) {
    status = load(slots, at, error);
    if (status == STRUT_OK && slots->block_count == 0) break; /* the end of the file */
    for (int64_t i = 0; i < slots->block_count; i++) {
      const unsigned char *slot = slots->block + (size_t)i * slots->layout.slot_bytes;
      slot_head head;
      memcpy(&head, slot, sizeof head);
      if (is_whole(slots, at + i, slot)) mark(slots, at + i, head.status);
    }
  }
  return status;
}

/* Allocates everything that the slots of a plan need. */
static strut_status prepare(strut_slots *slots, strut_error *error) {
  size_t words = (size_t)(slots->plan.count / BITS + 1);
  slots->block_slots = BLOCK_BYTES / (int64_t)slots->layout.slot_bytes;
  slots->done = strut_allocate(words, sizeof *slots->done);
  if (!STRUT_ALLOCATE(
          &slots->arena,
          STRUT_NEW(slots->block, (size_t)slots->block_slots * slots->layout.slot_bytes),
          STRUT_NEW(slots->numbers, slots->layout.number_count + 1),
          STRUT_NEW(slots->words, slots->layout.word_count + 1)) ||
      !slots->done)
    return no_memory(error, slots->path);
  atomic_store(&slots->missing, slots->plan.count);
  memcpy(&slots->seed, slots->plan.hash, sizeof slots->seed);
  return STRUT_OK;
}

/*
 * Locks the file against other writers, a shared one only against those that do not share it. Without file
 * locks all would write the same bytes.
 */
static strut_status lock(const strut_slots *slots, strut_error *error) {
  struct flock wanted = {.l_type = slots->shared ? F_RDLCK : F_WRLCK,
                         .l_whence = SEEK_SET,
                         .l_len = slots->shared ? 1 : 0}; /* 0: all of it */
  if (fcntl(slots->descriptor, F_SETLK, &wanted) == 0 || (errno != EACCES && errno != EAGAIN))
    return STRUT_OK;
  char who[48] = "another process";
  if (fcntl(slots->descriptor, F_GETLK, &wanted) == 0 && wanted.l_type != F_UNLCK &&
      wanted.l_pid > 0)
    snprintf(who, sizeof who, "another process (%ld)", (long)wanted.l_pid);
  return strut_fail(error, STRUT_FILE_TROUBLE, "%s is writing '%s': wait for it, or stop it first",
                    who, slots->path);
}

/*
 * The header of a new file, or of one whose header was never finished. It covers all that is there, so that
 * those who share a file may begin it at the same time.
 */
static strut_status begin(strut_slots *slots, const strut_slots_description *plan,
                          strut_error *error) {
  slots->plan = *plan;
  strut_status status = strut_slots_lay_out(&slots->plan, &slots->layout, error);
  if (status != STRUT_OK) return status;
  unsigned char *header = strut_slots_header(&slots->plan, &slots->layout, &slots->arena);
  if (!header) return no_memory(error, slots->path);
  if (!strut_slots_pwrite(slots->descriptor, header, slots->layout.header_bytes, 0) ||
      (fsync(slots->descriptor) != 0 && errno != EINVAL))
    return strut_file_fail(error, "write", slots->path, errno);
  return STRUT_OK;
}

/* Reads the existing header, which must belong to this plan. */
static strut_status resume(strut_slots *slots, const strut_slots_description *plan,
                           strut_error *error) {
  bool torn = false;
  strut_slots_description own = *plan;
  strut_status status = strut_slots_lay_out(&own, &slots->layout, error);
  size_t header = slots->layout.header_bytes;
  if (status == STRUT_OK) status = lock(slots, error);
  if (status == STRUT_OK)
    status = strut_slots_read_header(&(strut_slots_file){slots->descriptor, slots->path, header},
                                     &slots->plan, &slots->layout, &slots->arena, &torn, error);
  if (status == STRUT_OK && torn) return begin(slots, plan, error);
  return status == STRUT_OK ? strut_slots_compare(slots->path, &slots->plan, plan, error) : status;
}

static strut_status look(strut_slots *slots, strut_error *error) {
  bool torn = false; /* unused: an unfinished header cannot be read */
  return strut_slots_read_header(&(strut_slots_file){slots->descriptor, slots->path, 0},
                                 &slots->plan, &slots->layout, &slots->arena, &torn, error);
}

/* Opens for writing if there is a plan, otherwise read-only. */
static strut_status open_file(const char *path, const strut_slots_description *plan, bool shared,
                              strut_slots **slots, strut_error *error) {
  *slots = NULL;
  strut_slots *s = strut_allocate(1, sizeof *s);
  if (!s) return no_memory(error, path);
  s->writes = plan != NULL;
  s->shared = shared;
  s->descriptor = -1;
  s->path = strut_arena_text(&s->arena, path, strlen(path));
  strut_status status = s->path ? STRUT_OK : no_memory(error, path);
  if (status == STRUT_OK) {
    s->descriptor = open(path, plan ? O_RDWR | O_CREAT | O_CLOEXEC : O_RDONLY | O_CLOEXEC, 0666);
    if (s->descriptor < 0) status = strut_file_fail(error, plan ? "write" : "read", path, errno);
  }
  if (status == STRUT_OK) status = plan ? resume(s, plan, error) : look(s, error);
  if (status == STRUT_OK) status = prepare(s, error);
  if (status == STRUT_OK) status = scan(s, error);
  if (status == STRUT_OK) {
    *slots = s;
  } else {
    strut_slots_close(s);
  }
  return status;
}

static strut_status open_planned(const char *path, const strut_slots_description *plan, bool shared,
                                 strut_slots **slots, strut_error *error) {
  strut_slots_description wanted = *plan;
  strut_slots_layout layout;
  *slots = NULL;
  strut_status status = strut_slots_lay_out(&wanted, &layout, error); /* before creating a file */
  return status == STRUT_OK ? open_file(path, &wanted, shared, slots, error) : status;
}

strut_status strut_slots_open(const char *path, const strut_slots_description *plan,
                              strut_slots **slots, strut_error *error) {
  return open_planned(path, plan, false, slots, error);
}

strut_status strut_slots_open_shared(const char *path, const strut_slots_description *plan,
                                     strut_slots **slots, strut_error *error) {
  return open_planned(path, plan, true, slots, error);
}

strut_status strut_slots_read(const char *path, strut_slots **slots, strut_slots_description *plan,
                              strut_error *error) {
  strut_status status = open_file(path, NULL, false, slots, error);
  if (status == STRUT_OK) *plan = (*slots)->plan;
  return status;
}

void strut_slots_close(strut_slots *slots) {
  if (!slots) return;
  if (slots->descriptor >= 0) {
    strut_slots_sync(slots, NULL);
    close(slots->descriptor);
  }
  strut_release(slots->done);
  strut_arena_free(&slots->arena);
  strut_release(slots);
}

const strut_slots_description *strut_slots_description_of(const strut_slots *slots) {
  return &slots->plan;
}

int64_t strut_slots_point(const strut_slots *slots, int64_t i) {
  return slots->plan.first + i * slots->plan.stride;
}

static bool is_done(const strut_slots *slots, int64_t i) {
  return atomic_load_explicit(&slots->done[i / BITS], memory_order_acquire) >> i % BITS & 1;
}

bool strut_slots_done(const strut_slots *slots, int64_t point) {
  int64_t i = slot_of(slots, point);
  return i >= 0 && is_done(slots, i);
}

int64_t strut_slots_missing(const strut_slots *slots) { return atomic_load(&slots->missing); }
int64_t strut_slots_failed(const strut_slots *slots) { return atomic_load(&slots->failed); }

/* Copies a text without control characters into a field of zeros, cut between two characters. */
static void fill_text(unsigned char *field, size_t room, const char *text) {
  size_t length = 0;
  for (; text && length < room && text[length]; length++) {
    unsigned char c = (unsigned char)text[length];
    field[length] = c < ' ' || c == 0x7F ? ' ' : c;
  }
  if (length < room) return;
  do {
    length--;
  } while (length > 0 && (field[length] & 0xC0) == 0x80);
  memset(field + length, 0, room - length);
}

/* Encodes a slot; all NANs become the same one. */
static void fill_slot(const strut_slots *slots, int64_t point, const strut_result_slot *row,
                      unsigned char *slot) {
  slot_head head = {.point = point, .status = (uint32_t)row->status};
  unsigned char *at = slot + sizeof head;
  memset(slot, 0, slots->layout.slot_bytes);
  for (size_t i = 0; i < slots->layout.number_count; i++, at += sizeof(double)) {
    double number = isnan(row->numbers[i]) ? (double)NAN : row->numbers[i];
    memcpy(at, &number, sizeof number);
  }
  for (size_t i = 0; i < slots->layout.word_count; i++, at += STRUT_SLOT_WORD)
    fill_text(at, STRUT_SLOT_WORD, row->words[i]);
  fill_text(at, STRUT_SLOT_MESSAGE, row->message);
  memcpy(slot, &head, sizeof head);
  head.checksum = checksum_of(slots, slot);
  memcpy(slot, &head, sizeof head);
}

/* Does slot i have a row, which another process may have written since the file was opened? */
static bool is_written(strut_slots *slots, int64_t i) {
  unsigned char slot[STRUT_SLOT_MOST];
  int64_t length = (int64_t)slots->layout.slot_bytes;
  slot_head head;
  if (is_done(slots, i)) return true;
  if (!slots->shared) return false;
  if (strut_slots_pread(slots->descriptor, slot, (size_t)length, offset_of(slots, i)) < length ||
      !is_whole(slots, i, slot))
    return false;
  memcpy(&head, slot, sizeof head);
  mark(slots, i, head.status);
  return true;
}

/* Locks (F_WRLCK) or unlocks (F_UNLCK) the bytes of slot i. False: another process has them. */
static bool lock_slot(const strut_slots *slots, int64_t i, short type) {
  struct flock wanted = {.l_type = type,
                         .l_whence = SEEK_SET,
                         .l_start = offset_of(slots, i),
                         .l_len = (off_t)slots->layout.slot_bytes};
  return fcntl(slots->descriptor, F_SETLK, &wanted) == 0 || (errno != EACCES && errno != EAGAIN);
}

bool strut_slots_claim(strut_slots *slots, int64_t point) {
  int64_t i = slot_of(slots, point);
  if (i < 0 || is_written(slots, i)) return false;
  if (!slots->shared) return true;
  if (!lock_slot(slots, i, F_WRLCK)) return false;
  if (!is_written(slots, i)) return true; /* nobody has put it since */
  lock_slot(slots, i, F_UNLCK);
  return false;
}

strut_status strut_slots_put(strut_slots *slots, int64_t point, const strut_result_slot *row,
                             strut_error *error) {
  unsigned char slot[STRUT_SLOT_MOST];
  int64_t i = slot_of(slots, point);
  if (i < 0 || !slots->writes || is_done(slots, i))
    return strut_fail(error, STRUT_USAGE, "point %lld: '%s' %s", (long long)point, slots->path,
                      i < 0           ? "is not for it"
                      : slots->writes ? "has its result already"
                                      : "is open for reading only");
  fill_slot(slots, point, row, slot);
  if (!strut_slots_pwrite(slots->descriptor, slot, slots->layout.slot_bytes, offset_of(slots, i)))
    return strut_file_fail(error, "write", slots->path, errno);
  atomic_store_explicit(&slots->unsynced, true, memory_order_relaxed);
  if (slots->retried) atomic_fetch_add(&slots->rewritten, 1);
  mark(slots, i, (uint32_t)row->status);
  if (slots->shared) lock_slot(slots, i, F_UNLCK);
  return STRUT_OK;
}

strut_status strut_slots_sync(strut_slots *slots, strut_error *error) {
  if (!atomic_exchange(&slots->unsynced, false)) return STRUT_OK;
  if (fsync(slots->descriptor) == 0 || errno == EINVAL) return STRUT_OK;
  return strut_file_fail(error, "write", slots->path, errno);
}

/* The bytes of slot i, from the block in memory or from the file; NULL if it is missing. */
static const unsigned char *find(strut_slots *slots, int64_t i) {
  for (int pass = 0; pass < 2; pass++) { /* it may have been written since the block was read */
    int64_t at = i - slots->block_first;
    bool fresh = slots->block_rewritten == atomic_load(&slots->rewritten);
    if (at >= 0 && at < slots->block_count && (fresh || pass)) {
      const unsigned char *slot = slots->block + (size_t)at * slots->layout.slot_bytes;
      if (is_whole(slots, i, slot)) return slot;
    }
    if (pass == 0 && load(slots, i, NULL) != STRUT_OK) return NULL;
  }
  return NULL;
}

bool strut_slots_get(strut_slots *slots, int64_t point, strut_result_slot *row) {
  int64_t i = slot_of(slots, point);
  const unsigned char *slot = i < 0 ? NULL : find(slots, i);
  if (!slot) return false;
  slot_head head;
  size_t numbers = slots->layout.number_count * sizeof *slots->numbers;
  size_t words = slots->layout.word_count * sizeof *slots->words;
  memcpy(&head, slot, sizeof head);
  memcpy(slots->numbers, slot + sizeof head, numbers);
  memcpy(slots->words, slot + sizeof head + numbers, words);
  memcpy(slots->message, slot + sizeof head + numbers + words, sizeof slots->message);
  *row = (strut_result_slot){.status = (strut_status)head.status,
                             .numbers = slots->numbers,
                             .words = (const char(*)[STRUT_SLOT_WORD])slots->words,
                             .message = slots->message};
  return true;
}

size_t strut_slot_place(const strut_slot_column *columns, size_t column) {
  size_t place = 0;
  for (size_t k = 0; k < column; k++) place += columns[k].word == columns[column].word;
  return place;
}

size_t strut_slot_named(const strut_slot_column *columns, size_t count, const char *name) {
  size_t column = 0;
  while (column < count && strcmp(columns[column].name, name) != 0) column++;
  return column;
}

strut_value strut_slot_value(const strut_slot_column *columns, const strut_result_slot *row,
                             size_t column) {
  const size_t place = strut_slot_place(columns, column);
  const char *unit = columns[column].unit;
  return columns[column].word
             ? STRUT_VALUE_AS_TEXT(row->words[place])
             : STRUT_VALUE_AS_CALLED(NULL, strcmp(unit, "1") == 0 ? "" : unit, row->numbers[place]);
}

bool strut_slots_is_inaccurate(strut_slots *slots, int64_t point) {
  const strut_slots_description *plan = &slots->plan;
  const size_t column = strut_slot_named(plan->columns, plan->column_count, STRUT_KEPT_COLUMN);
  strut_result_slot row;
  return column < plan->column_count && strut_slots_done(slots, point) &&
         strut_slots_get(slots, point, &row) && row.status == STRUT_OK &&
         row.numbers[strut_slot_place(plan->columns, column)] == 0.0;
}

int64_t strut_slots_inaccurate(strut_slots *slots) {
  int64_t inaccurate = 0;
  for (int64_t i = 0; i < slots->plan.count; i++)
    inaccurate += strut_slots_is_inaccurate(slots, strut_slots_point(slots, i));
  return inaccurate;
}

strut_status strut_slots_retry(strut_slots *slots, strut_error *error) {
  slots->retried = true;
  for (int64_t i = 0; i < slots->plan.count && strut_slots_failed(slots) > 0; i++) {
    strut_result_slot row;
    if (!is_done(slots, i)) continue;
    if (!strut_slots_get(slots, strut_slots_point(slots, i), &row))
      return strut_fail(error, STRUT_FILE_TROUBLE, "'%s' has changed while it was read",
                        slots->path);
    if (row.status == STRUT_OK) continue;
    atomic_fetch_and(&slots->done[i / BITS], ~((uint64_t)1 << i % BITS));
    atomic_fetch_add(&slots->missing, 1);
    atomic_fetch_sub(&slots->failed, 1);
  }
  return STRUT_OK;
}
