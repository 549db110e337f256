/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/results/shard.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "engine/output/file.h"
#include "engine/study/results/slots_parts.h"

static const char WHOLE[] = "points.slots", FOLDER[] = "shards";
enum { NAME_ROOM = 64 };

/* A whole number of digits only at *at, which moves behind it; -1 where there is none. */
static int64_t take_integer(const char **at) {
  int64_t value = 0;
  const char *from = *at;
  for (; **at >= '0' && **at <= '9' && *at - from < 9; ++*at) value = 10 * value + (**at - '0');
  return *at == from ? -1 : value;
}

static int64_t integer_of(const char *text) {
  if (!text) return -1;
  int64_t value = take_integer(&text);
  return *text ? -1 : value;
}

static strut_status check(const char *text, strut_shard shard, strut_error *error) {
  if (shard.count < 1 || shard.count > STRUT_MOST_SHARDS)
    return strut_fail(error, STRUT_USAGE, "%s: a study has 1 to %d shards", text,
                      STRUT_MOST_SHARDS);
  if (shard.index >= shard.count)
    return strut_fail(error, STRUT_USAGE, "%s: shards of %lld are numbered 0 to %lld", text,
                      (long long)shard.count, (long long)shard.count - 1);
  return STRUT_OK;
}

/* All tasks of an array that has one for each shard. */
static strut_status read_array(const char *text, const strut_array_task *task, strut_shard *shard,
                               strut_error *error) {
  int64_t id = integer_of(task->id), low = integer_of(task->min), high = integer_of(task->max);
  int64_t step = task->step ? integer_of(task->step) : 1, count = integer_of(task->count);
  if (id < 0 || low < 0 || high < 0 || step < 1 || count < 1)
    return strut_fail(
        error, STRUT_USAGE,
        "%s: this is no task of a Slurm job array (SLURM_ARRAY_TASK_ID, _MIN, _MAX and "
        "_COUNT are not all set)",
        text);
  bool dense = (high - low) / step + 1 == count && (id - low) % step == 0;
  if (!dense || low > 1)
    return strut_fail(
        error, STRUT_USAGE,
        "%s: this array, %lld tasks from %lld to %lld, has not a task for each shard, "
        "counted from 0 or 1; say how many shards there are: slurm/N",
        text, (long long)count, (long long)low, (long long)high);
  *shard = (strut_shard){(id - low) / step, count};
  return check(text, *shard, error);
}

strut_status strut_shard_read(const char *text, const strut_array_task *task, strut_shard *shard,
                              strut_error *error) {
  static const char slurm[] = "slurm";
  const char *at = text;
  bool from_slurm = strncmp(text, slurm, strlen(slurm)) == 0;
  if (from_slurm) at += strlen(slurm);
  if (from_slurm && !*at) return read_array(text, task, shard, error);
  shard->index = from_slurm ? integer_of(task->id) : take_integer(&at);
  shard->count = *at == '/' ? integer_of(at + 1) : -1;
  if (shard->count < 0 || (shard->index < 0 && !from_slurm))
    return strut_fail(error, STRUT_USAGE, "expected K/N, slurm or slurm/N, not '%s'", text);
  if (shard->index < 0)
    return strut_fail(error, STRUT_USAGE,
                      "%s: this is no task of a Slurm job array (SLURM_ARRAY_TASK_ID is not set)",
                      text);
  return check(text, *shard, error);
}

void strut_shard_points(strut_shard shard, strut_slots_plan *plan) {
  bool whole = shard.count < 1;
  plan->first = whole ? 0 : shard.index;
  plan->stride = whole ? 1 : shard.count;
  int64_t from = plan->points - plan->first;
  plan->count = from <= 0 ? 0 : (from - 1) / plan->stride + 1;
}

char *strut_shard_path(const char *directory, strut_shard shard, strut_arena *arena) {
  if (shard.count < 1) return strut_arena_format(arena, "%s/%s", directory, WHOLE);
  return strut_arena_format(arena, "%s/%s/shard-%04lld-of-%04lld.slots", directory, FOLDER,
                            (long long)shard.index, (long long)shard.count);
}

/* Whether a file's name is that of a shard. */
static bool is_shard(const char *name, strut_shard *shard) {
  char expected[NAME_ROOM];
  const char *at = name;
  if (strncmp(at, "shard-", 6) != 0) return false;
  at += 6;
  shard->index = take_integer(&at);
  if (strncmp(at, "-of-", 4) != 0) return false;
  at += 4;
  shard->count = take_integer(&at);
  snprintf(expected, sizeof expected, "shard-%04lld-of-%04lld.slots", (long long)shard->index,
           (long long)shard->count);
  return strcmp(name, expected) == 0 && shard->index < shard->count &&
         shard->count <= STRUT_MOST_SHARDS;
}

static strut_status note(strut_shards_found *found, strut_shard shard, strut_arena *arena,
                         strut_error *error) {
  if (!found->count) {
    found->there = strut_arena_allocate(arena, (size_t)shard.count, 1);
    if (!found->there) return strut_fail(error, STRUT_NO_MEMORY, "out of memory for shards");
    found->count = shard.count;
  }
  if (shard.count == found->count) {
    found->there[shard.index] = 1;
  } else {
    found->other = shard.count;
  }
  return STRUT_OK;
}

strut_status strut_shards_find(const char *directory, strut_shards_found *found, strut_arena *arena,
                               strut_error *error) {
  *found = (strut_shards_found){0};
  char *whole = strut_arena_format(arena, "%s/%s", directory, WHOLE);
  char *folder = strut_arena_format(arena, "%s/%s", directory, FOLDER);
  if (!whole || !folder) return strut_fail(error, STRUT_NO_MEMORY, "out of memory for shards");
  found->whole = access(whole, F_OK) == 0;
  DIR *open = opendir(folder);
  if (!open && errno == ENOENT) return STRUT_OK;
  if (!open) return strut_slots_trouble(error, "read", folder, errno);
  strut_status status = STRUT_OK;
  strut_shard shard;
  for (const struct dirent *entry; status == STRUT_OK && (entry = readdir(open));)
    if (is_shard(entry->d_name, &shard)) status = note(found, shard, arena, error);
  closedir(open);
  return status;
}

/* Whether what is there and a new shard could be merged. */
static strut_status agree(const char *directory, strut_shard shard, const strut_shards_found *found,
                          strut_error *error) {
  if (shard.count && found->whole)
    return strut_fail(error, STRUT_USAGE,
                      "'%s' holds the study in one piece ('%s'): go on without --shard, or give "
                      "another directory",
                      directory, WHOLE);
  if (!shard.count && found->count)
    return strut_fail(error, STRUT_USAGE,
                      "'%s' holds shards of the study, %lld in all: give --shard as for these, or "
                      "another directory",
                      directory, (long long)found->count);
  int64_t count = found->other && found->count == shard.count ? found->other : found->count;
  if (count && count != shard.count)
    return strut_fail(error, STRUT_USAGE,
                      "'%s' holds shards of %lld, and this would be one of %lld: say --shard with "
                      "/%lld, or give another directory",
                      directory, (long long)count, (long long)shard.count, (long long)count);
  return STRUT_OK;
}

strut_status strut_shard_begin(const char *directory, strut_shard shard, strut_error *error) {
  strut_arena arena = {0};
  strut_shards_found found;
  strut_status status = strut_shards_find(directory, &found, &arena, error);
  if (status == STRUT_OK) status = agree(directory, shard, &found, error);
  if (status == STRUT_OK) {
    char *folder = strut_arena_format(&arena, shard.count ? "%s/%s" : "%s", directory, FOLDER);
    status = folder ? strut_directory_create(folder, error)
                    : strut_fail(error, STRUT_NO_MEMORY, "out of memory for shards");
  }
  strut_arena_free(&arena);
  return status;
}
