/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/results/merge.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/study/results/slots_parts.h"
#include "engine/study/results/study_table.h"

enum { MOST_NAMED = 12 };

/* A merge being made. */
typedef struct merge {
  const char *directory;
  strut_shards_found found;
  strut_slots **sources;
  size_t count;
  strut_arena arena;
} merge;

static strut_status no_memory(strut_error *error) {
  return strut_fail(error, STRUT_NO_MEMORY, "out of memory for shards");
}

/* A sentence that grows; what does not fit is left out. */
typedef struct sentence {
  char text[400];
  size_t used;
} sentence;

__attribute__((format(printf, 2, 3))) static void add(sentence *s, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  int length = vsnprintf(s->text + s->used, sizeof s->text - s->used, format, arguments);
  va_end(arguments);
  if (length > 0) s->used += (size_t)length;
  if (s->used > sizeof s->text - 1) s->used = sizeof s->text - 1;
}

/* "2, 5 to 7": the shards that are not there. How many. */
static int64_t name_absent(const strut_shards_found *found, sentence *s) {
  int64_t absent = 0;
  int named = 0;
  for (int64_t i = 0; i < found->count; i++) {
    if (found->there[i]) continue;
    int64_t last = i;
    while (last + 1 < found->count && !found->there[last + 1]) last++;
    absent += last - i + 1;
    if (named < MOST_NAMED) add(s, named ? ", %lld" : "%lld", (long long)i);
    if (named < MOST_NAMED && last > i) add(s, " to %lld", (long long)last);
    if (named++ == MOST_NAMED) add(s, ", ...");
    i = last;
  }
  return absent;
}

/* Missing shards, and shards that miss points, all in one sentence. */
static strut_status check_gaps(const merge *m, strut_error *error) {
  sentence names = {.used = 0}, lacks = {.used = 0};
  int64_t absent = name_absent(&m->found, &names);
  int unfinished = 0;
  for (size_t i = 0; i < m->count; i++) {
    int64_t missing = m->sources[i] ? strut_slots_missing(m->sources[i]) : 0;
    if (missing == 0) continue;
    long long of = (long long)strut_slots_plan_of(m->sources[i])->count;
    if (!m->found.count)
      return strut_fail(error, STRUT_FILE_TROUBLE,
                        "'%s': %lld of %lld points are missing: run the study again, it goes on",
                        m->directory, (long long)missing, of);
    if (unfinished < MOST_NAMED)
      add(&lacks, "%s shard %zu lacks %lld of its %lld points", unfinished || absent ? "," : "", i,
          (long long)missing, of);
    if (unfinished++ == MOST_NAMED) add(&lacks, ", ...");
  }
  if (!absent && !unfinished) return STRUT_OK;
  sentence gone = {.used = 0};
  if (absent)
    add(&gone, " %lld of %lld shards %s missing (%s)", (long long)absent, (long long)m->found.count,
        absent == 1 ? "is" : "are", names.text);
  return strut_fail(error, STRUT_FILE_TROUBLE, "'%s':%s%.300s; run these shards again, they go on",
                    m->directory, gone.text, lacks.text);
}

/* Opens what is there; of a shard that is not, the place stays NULL. */
static strut_status open_sources(merge *m, strut_error *error) {
  strut_status status = STRUT_OK;
  m->sources = strut_arena_allocate(&m->arena, m->count, sizeof *m->sources);
  if (!m->sources) return no_memory(error);
  for (size_t i = 0; i < m->count && status == STRUT_OK; i++) {
    strut_slots_plan plan;
    if (m->found.count && !m->found.there[i]) continue;
    strut_shard shard = {(int64_t)i, m->found.count};
    char *path = strut_shard_path(m->directory, shard, &m->arena);
    status = path ? strut_slots_read(path, &m->sources[i], &plan, error) : no_memory(error);
    if (status != STRUT_OK) break;
    strut_shard_points(shard, &plan);
    const strut_slots_plan *own = strut_slots_plan_of(m->sources[i]);
    if (plan.first != own->first || plan.count != own->count || plan.stride != own->stride)
      status =
          strut_fail(error, STRUT_USAGE,
                     "'%s' is for other points than its name says: is it a copy of another?", path);
  }
  return status;
}

/* All of one study? */
static strut_status check_study(const merge *m, strut_error *error) {
  size_t first = 0;
  while (first < m->count && !m->sources[first]) first++;
  for (size_t i = first + 1; i < m->count; i++) {
    if (!m->sources[i]) continue;
    const char *difference = strut_slots_difference(strut_slots_plan_of(m->sources[first]),
                                                    strut_slots_plan_of(m->sources[i]));
    if (difference)
      return strut_fail(error, STRUT_USAGE,
                        "'%s': shards %zu and %zu are not of one study, they differ in %s: remove "
                        "those that are out of date and run them again",
                        m->directory, first, i, difference);
  }
  return STRUT_OK;
}

static strut_status find(merge *m, strut_error *error) {
  strut_status status = strut_shards_find(m->directory, &m->found, &m->arena, error);
  if (status != STRUT_OK) return status;
  if (!m->found.whole && !m->found.count)
    return strut_fail(error, STRUT_FILE_TROUBLE,
                      "'%s' holds no results of a study: neither 'points.slots' nor 'shards'",
                      m->directory);
  if (m->found.whole && m->found.count)
    return strut_fail(error, STRUT_USAGE,
                      "'%s' holds the study twice, in one piece ('points.slots') and in 'shards': "
                      "remove one of them",
                      m->directory);
  if (m->found.other)
    return strut_fail(
        error, STRUT_USAGE,
        "'%s' holds shards of %lld and shards of %lld, which overlap: remove those of "
        "one kind",
        m->directory, (long long)m->found.count, (long long)m->found.other);
  m->count = m->found.count ? (size_t)m->found.count : 1;
  return STRUT_OK;
}

strut_status strut_merge(const char *directory, strut_merged *merged, strut_error *error) {
  merge m = {.directory = directory};
  *merged = (strut_merged){0};
  strut_status status = find(&m, error);
  if (status == STRUT_OK) status = open_sources(&m, error);
  if (status == STRUT_OK) status = check_study(&m, error);
  if (status == STRUT_OK) status = check_gaps(&m, error);
  if (status == STRUT_OK)
    status = strut_study_table_write(directory, "table.csv", m.sources, m.count, error);
  if (status == STRUT_OK) {
    merged->shards = m.found.count;
    merged->points = strut_slots_plan_of(m.sources[0])->points;
    for (size_t i = 0; i < m.count; i++) merged->failed += strut_slots_failed(m.sources[i]);
  }
  for (size_t i = 0; m.sources && i < m.count; i++) strut_slots_close(m.sources[i]);
  strut_arena_free(&m.arena);
  return status;
}
