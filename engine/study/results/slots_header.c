/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The header of a file of slots: its study and its points. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/checksum.h"
#include "engine/study/results/slots_parts.h"

static const uint32_t BYTE_ORDER_MARK = 0x01020304, FOREIGN_MARK = 0x04030201, FORMAT = 1;
static const char MAGIC[8] = {'\x89', 's', 't', 'r', 'u', 't', '\r', '\n'};
enum { ALIGNMENT = 64, MOST_HEADER = 1 << 20 };

/* Layout in the file; the texts follow: version, name, then kind, name and unit of each column. */
typedef struct fixed_part {
  char magic[8];
  uint32_t byte_order, format;
  uint64_t checksum; /* of the whole header with this field 0 */
  uint64_t header_bytes, slot_bytes;
  int64_t points, first, stride, count;
  uint8_t hash[STRUT_STUDY_HASH];
  uint64_t column_count, text_bytes;
} fixed_part;

_Static_assert(sizeof(fixed_part) == 88 + STRUT_STUDY_HASH, "no gaps in what is written");

int64_t strut_slots_pread(int descriptor, void *bytes, size_t length, int64_t offset) {
  size_t done = 0;
  while (done < length) {
    ssize_t got = pread(descriptor, (char *)bytes + done, length - done, offset + (int64_t)done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return -1;
    if (got == 0) break;
    done += (size_t)got;
  }
  return (int64_t)done;
}

bool strut_slots_pwrite(int descriptor, const void *bytes, size_t length, int64_t offset) {
  size_t done = 0;
  while (done < length) {
    ssize_t put =
        pwrite(descriptor, (const char *)bytes + done, length - done, offset + (int64_t)done);
    if (put < 0 && errno == EINTR) continue;
    if (put == 0) errno = ENOSPC;
    if (put <= 0) return false;
    done += (size_t)put;
  }
  return true;
}

static size_t text_bytes(const strut_slots_description *plan) {
  size_t bytes = strlen(plan->version) + strlen(plan->name) + 2;
  for (size_t i = 0; i < plan->column_count; i++)
    bytes += strlen(plan->columns[i].name) + strlen(plan->columns[i].unit) + 3;
  return bytes;
}

strut_status strut_slots_lay_out(strut_slots_description *plan, strut_slots_layout *layout,
                                 strut_error *error) {
  if (plan->stride == 0) plan->stride = 1;
  bool good =
      plan->points >= 0 && plan->first >= 0 && plan->count >= 0 && plan->stride > 0 &&
      plan->count <= plan->points &&
      (plan->count == 0 || (plan->first < plan->points &&
                            (plan->count - 1) <= (plan->points - 1 - plan->first) / plan->stride));
  if (!good) return strut_fail(error, STRUT_USAGE, "points that the study does not have");
  *layout = (strut_slots_layout){0};
  for (size_t i = 0; i < plan->column_count; i++) {
    layout->word_count += plan->columns[i].word;
    layout->number_count += !plan->columns[i].word;
  }
  if (plan->column_count > STRUT_SLOT_MOST)
    return strut_fail(error, STRUT_USAGE, "%zu columns are too many", plan->column_count);
  layout->slot_bytes = STRUT_SLOT_HEAD + layout->number_count * sizeof(double) +
                       layout->word_count * STRUT_SLOT_WORD + STRUT_SLOT_MESSAGE;
  size_t header = sizeof(fixed_part) + text_bytes(plan);
  layout->header_bytes = (header + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
  if (layout->slot_bytes > STRUT_SLOT_MOST || layout->header_bytes > MOST_HEADER)
    return strut_fail(error, STRUT_USAGE, "%zu columns are too many", plan->column_count);
  return STRUT_OK;
}

static char *put_text(char *at, const char *text) {
  size_t length = strlen(text) + 1;
  memcpy(at, text, length);
  return at + length;
}

/* The next text before `end`, or NULL. */
static const char *take_text(const char **at, const char *end) {
  const char *text = *at, *nul = memchr(text, '\0', (size_t)(end - text));
  if (!nul) return NULL;
  *at = nul + 1;
  return text;
}

/* Reads the texts of a header with a valid checksum. */
static bool take_texts(strut_slots_description *plan, const char *at, const char *end,
                       strut_arena *arena) {
  strut_slot_column *columns = strut_arena_allocate(arena, plan->column_count + 1, sizeof *columns);
  if (!columns) return false;
  plan->version = take_text(&at, end);
  plan->name = plan->version ? take_text(&at, end) : NULL;
  bool good = plan->name != NULL;
  for (size_t i = 0; good && i < plan->column_count; i++) {
    good = at < end;
    if (good) columns[i].word = *at++ == 'w';
    columns[i].name = good ? take_text(&at, end) : NULL;
    columns[i].unit = columns[i].name ? take_text(&at, end) : NULL;
    good = columns[i].unit != NULL;
  }
  plan->columns = columns;
  return good;
}

unsigned char *strut_slots_header(strut_slots_description *plan, const strut_slots_layout *layout,
                                  strut_arena *arena) {
  unsigned char *header = strut_arena_allocate(arena, layout->header_bytes, 1);
  if (!header) return NULL;
  fixed_part fixed = {.byte_order = BYTE_ORDER_MARK,
                      .format = FORMAT,
                      .header_bytes = layout->header_bytes,
                      .slot_bytes = layout->slot_bytes,
                      .points = plan->points,
                      .first = plan->first,
                      .stride = plan->stride,
                      .count = plan->count,
                      .column_count = plan->column_count,
                      .text_bytes = text_bytes(plan)};
  memcpy(fixed.magic, MAGIC, sizeof MAGIC);
  memcpy(fixed.hash, plan->hash, sizeof fixed.hash);
  char *texts = (char *)header + sizeof fixed, *at = texts;
  at = put_text(put_text(at, plan->version), plan->name);
  for (size_t i = 0; i < plan->column_count; i++) {
    *at++ = plan->columns[i].word ? 'w' : 'n';
    at = put_text(put_text(at, plan->columns[i].name), plan->columns[i].unit);
  }
  memcpy(header, &fixed, sizeof fixed);
  fixed.checksum = strut_checksum(header, layout->header_bytes, 0);
  memcpy(header, &fixed, sizeof fixed);
  return take_texts(plan, texts, at, arena) ? header : NULL;
}

/* Are these only the first bytes of a header, or of space reserved for one? */
static bool is_torn(const unsigned char *begin, int64_t got) {
  bool magic = true, zeros = true;
  for (int64_t i = 0; i < got; i++) {
    magic = magic && (i >= (int64_t)sizeof MAGIC || begin[i] == (unsigned char)MAGIC[i]);
    zeros = zeros && begin[i] == 0;
  }
  return magic || zeros;
}

static strut_status foreign(strut_error *error, const char *path, const char *why) {
  return strut_fail(error, STRUT_FILE_TROUBLE, "'%s' is %s", path, why);
}

strut_status strut_slots_read_header(const strut_slots_file *file, strut_slots_description *plan,
                                     strut_slots_layout *layout, strut_arena *arena, bool *torn,
                                     strut_error *error) {
  const int descriptor = file->descriptor;
  const char *path = file->path;
  fixed_part fixed = {0};
  struct stat found; /* before the bytes are read, since another process may write rows meanwhile */
  bool small = fstat(descriptor, &found) == 0 && found.st_size <= (off_t)file->most;
  *torn = false;
  int64_t got = strut_slots_pread(descriptor, &fixed, sizeof fixed, 0);
  if (got < 0) return strut_file_fail(error, "read", path, errno);
  *torn = small && is_torn((unsigned char *)&fixed, got);
  bool ours = memcmp(fixed.magic, MAGIC, sizeof MAGIC) == 0;
  if (got < (int64_t)sizeof fixed || !ours)
    return *torn ? STRUT_OK : foreign(error, path, "not a file of study results");
  if (fixed.byte_order == FOREIGN_MARK)
    return foreign(error, path, "written by a machine with another byte order");
  if (fixed.byte_order == BYTE_ORDER_MARK && fixed.format != FORMAT)
    return strut_fail(error, STRUT_FILE_TROUBLE,
                      "'%s' is of format %u, but this program reads only %u", path, fixed.format,
                      FORMAT);
  const char *damaged = "damaged: its header does not agree with itself";
  if (fixed.header_bytes < sizeof fixed || fixed.header_bytes > MOST_HEADER ||
      fixed.text_bytes > fixed.header_bytes - sizeof fixed || fixed.column_count > fixed.text_bytes)
    return *torn ? STRUT_OK : foreign(error, path, damaged);
  unsigned char *header = strut_arena_allocate(arena, (size_t)fixed.header_bytes, 1);
  if (!header) return strut_fail(error, STRUT_NO_MEMORY, "out of memory reading '%s'", path);
  got = strut_slots_pread(descriptor, header, (size_t)fixed.header_bytes, 0);
  if (got < 0) return strut_file_fail(error, "read", path, errno);
  uint64_t checksum = fixed.checksum;
  fixed.checksum = 0;
  memcpy(header, &fixed, sizeof fixed);
  if (got < (int64_t)fixed.header_bytes ||
      strut_checksum(header, (size_t)fixed.header_bytes, 0) != checksum)
    return *torn ? STRUT_OK : foreign(error, path, damaged);
  *torn = false;
  *plan = (strut_slots_description){.points = fixed.points,
                                    .first = fixed.first,
                                    .stride = fixed.stride,
                                    .count = fixed.count,
                                    .column_count = (size_t)fixed.column_count};
  memcpy(plan->hash, fixed.hash, sizeof plan->hash);
  const char *texts = (const char *)header + sizeof fixed;
  if (!take_texts(plan, texts, texts + fixed.text_bytes, arena)) {
    if (!plan->columns)
      return strut_fail(error, STRUT_NO_MEMORY, "out of memory reading '%s'", path);
    return foreign(error, path, damaged);
  }
  strut_status status = strut_slots_lay_out(plan, layout, error);
  bool agree = layout->header_bytes == fixed.header_bytes && layout->slot_bytes == fixed.slot_bytes;
  return status == STRUT_OK && agree ? STRUT_OK : foreign(error, path, damaged);
}

static bool same_columns(const strut_slots_description *first,
                         const strut_slots_description *second) {
  bool same = first->column_count == second->column_count;
  for (size_t i = 0; same && i < first->column_count; i++)
    same = strcmp(first->columns[i].name, second->columns[i].name) == 0 &&
           strcmp(first->columns[i].unit, second->columns[i].unit) == 0 &&
           first->columns[i].word == second->columns[i].word;
  return same;
}

const char *strut_slots_difference(const strut_slots_description *first,
                                   const strut_slots_description *second) {
  if (strcmp(first->version, second->version) != 0) return "the version of strut";
  if (first->points != second->points) return "the number of points";
  if (!same_columns(first, second)) return "the columns";
  if (memcmp(first->hash, second->hash, sizeof first->hash) != 0)
    return "the model, its data, its parameters or the axes";
  return NULL;
}

strut_status strut_slots_compare(const char *path, const strut_slots_description *there,
                                 const strut_slots_description *wanted, strut_error *error) {
  const char *difference = strut_slots_difference(there, wanted);
  char detail[160] = "";
  if (strcmp(there->version, wanted->version) != 0)
    snprintf(detail, sizeof detail, " (%.60s, now %.60s)", there->version, wanted->version);
  else if (there->points != wanted->points)
    snprintf(detail, sizeof detail, " (%lld, now %lld)", (long long)there->points,
             (long long)wanted->points);
  else if (!difference && (there->first != wanted->first || there->count != wanted->count ||
                           there->stride != wanted->stride))
    difference = "their points";
  if (!difference) return STRUT_OK;
  return strut_fail(error, STRUT_USAGE,
                    "'%.250s' holds results of another study, which differs in %s%s: give another "
                    "directory, or remove that file to start anew",
                    path, difference, detail);
}
