/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/results/study_table.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "engine/base/text.h"
#include "engine/output/file.h"
#include "engine/study/results/slots_parts.h"

/* Writes a line, which is empty then. */
static strut_status write_line(strut_file *file, strut_buffer *line, strut_error *error) {
  if (line->failed) return strut_no_memory(error, "");
  errno = 0;
  bool written = fwrite(line->text, 1, line->length, file->stream) == line->length;
  line->length = 0;
  return written ? STRUT_OK : strut_file_trouble(file, error);
}

void strut_study_table_add_name(strut_buffer *line, const strut_slot_column *column) {
  bool plain = strcmp(column->unit, "1") == 0 || !*column->unit;
  strut_csv_add_text(line, plain ? "%s%s" : "%s [%s]", column->name, plain ? "" : column->unit);
  strut_buffer_add(line, ",");
}

static void add_header(strut_buffer *line, const strut_slots_description *plan) {
  strut_buffer_add(line, "point,");
  for (size_t i = 0; i < plan->column_count; i++)
    strut_study_table_add_name(line, &plan->columns[i]);
  strut_buffer_add(line, "status,message\n");
}

static void add_row(strut_buffer *line, const strut_slots_description *plan, int64_t point,
                    const strut_result_slot *row) {
  size_t numbers = 0, words = 0;
  strut_csv_add_number(line, (double)point);
  for (size_t i = 0; i < plan->column_count; i++) {
    strut_buffer_add(line, ",");
    if (plan->columns[i].word)
      strut_csv_add_text(line, "%s", row->words[words++]);
    else
      strut_csv_add_number(line, row->numbers[numbers++]);
  }
  strut_buffer_add(line, ",");
  strut_csv_add_text(line, "%s", strut_status_text(row->status));
  strut_buffer_add(line, ",");
  strut_csv_add_text(line, "%s", row->message);
  strut_buffer_add(line, "\n");
}

strut_status strut_study_table_write(const char *directory, const char *name,
                                     const strut_slot_rows *of, int64_t *rows, strut_error *error) {
  strut_file file = {0};
  strut_buffer line = {0};
  int64_t written = 0;
  const strut_slots_description *plan = strut_slots_description_of(of->sources[0]);
  strut_status status = strut_file_open(&file, directory, name, error);
  if (status) return status;
  add_header(&line, plan);
  status = write_line(&file, &line, error);
  for (int64_t i = 0; i < (of->points ? of->point_count : plan->points) && !status; i++) {
    strut_result_slot row;
    int64_t point = of->points ? of->points[i] : i;
    strut_slots *source = of->sources[(size_t)point % of->count];
    if (of->partial && !strut_slots_done(source, point)) continue;
    if (strut_slots_get(source, point, &row)) {
      add_row(&line, plan, point, &row);
      status = write_line(&file, &line, error);
      written++;
    } else if (!of->partial) {
      status =
          strut_fail(error, STRUT_USAGE, "no table yet: point %lld is missing", (long long)point);
    }
  }
  strut_release(line.text);
  if (rows) *rows = written;
  if (!status) return strut_file_commit(&file, error);
  strut_file_abandon(&file);
  return status;
}

static const char WHOLE[] = "points.slots", FOLDER[] = "shards";
enum { NAME_ROOM = 64 };

/* Parses a whole number at *at and moves *at past it; -1 if there is none. */
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

/* Checks that the Slurm array has one task per shard. */
static strut_status read_array(const char *text, const strut_array_task *task, strut_shard *shard,
                               strut_error *error) {
  int64_t id = integer_of(task->id), low = integer_of(task->min), high = integer_of(task->max);
  int64_t step = task->step ? integer_of(task->step) : 1, count = integer_of(task->count);
  if (id < 0 || low < 0 || high < 0 || step < 1 || count < 1)
    return strut_fail(
        error, STRUT_USAGE,
        "%s: this is not a task of a Slurm job array (SLURM_ARRAY_TASK_ID, _MIN, _MAX and "
        "_COUNT are not all set)",
        text);
  bool dense = (high - low) / step + 1 == count && (id - low) % step == 0;
  if (!dense || low > 1)
    return strut_fail(error, STRUT_USAGE,
                      "%s: this array, %lld tasks from %lld to %lld, lacks a task for each shard, "
                      "counted from 0 or 1; give the number of shards: slurm/N",
                      text, (long long)count, (long long)low, (long long)high);
  *shard = (strut_shard){(id - low) / step, count};
  return check(text, *shard, error);
}

/* Systems that number the tasks of a job in a variable: word, variable, number of the first task; Slurm, whose variable
   the task has, first. */
static const struct system {
  const char *word, *variable;
  int64_t first;
  const char *name, *how;
} systems[] = {
    {"slurm", "SLURM_ARRAY_TASK_ID", 0, "a Slurm job array", "sbatch --array=0-LAST"},
    {"pbs", "PBS_ARRAY_INDEX", 0, "a PBS job array", "qsub -J 0-LAST"},
    {"torque", "PBS_ARRAYID", 0, "a Torque job array", "qsub -t 0-LAST"},
    {"lsf", "LSB_JOBINDEX", 1, "an LSF job array", "bsub -J \"NAME[1-N]\""},
    {"sge", "SGE_TASK_ID", 1, "a Grid Engine array job", "qsub -t 1-N"},
    {"kubernetes", "JOB_COMPLETION_INDEX", 0, "an Indexed Job of Kubernetes",
     "completionMode: Indexed"},
};
enum { SYSTEMS = sizeof systems / sizeof systems[0] };

/* The shard of a text such as "lsf/6", whose word and count were found. */
static strut_status read_system(const char *text, const struct system *system, const char *count,
                                const strut_array_task *task, strut_shard *shard,
                                strut_error *error) {
  shard->count = *count == '/' ? integer_of(count + 1) : -1;
  if (shard->count < 0)
    return strut_fail(error, STRUT_USAGE, "%s: give the number of shards: %s/N", text,
                      system->word);
  const char *value = system == systems ? task->id
                      : task->variable  ? task->variable(system->variable)
                                        : NULL;
  int64_t number = integer_of(value);
  if (number >= system->first) {
    shard->index = number - system->first;
    return check(text, *shard, error);
  }
  if (!value)
    return strut_fail(error, STRUT_USAGE, "%s: this is not a task of %s (%s is not set): %s", text,
                      system->name, system->variable, system->how);
  return strut_fail(error, STRUT_USAGE,
                    "%s: this is not a task of %s (%s is '%.40s', expected a number from %lld): %s",
                    text, system->name, system->variable, value, (long long)system->first,
                    system->how);
}

/* A text such as "env:NAME/6". */
static strut_status read_variable(const char *text, const strut_array_task *task,
                                  strut_shard *shard, strut_error *error) {
  char name[NAME_ROOM];
  size_t length = strcspn(text + 4, "/");
  snprintf(name, sizeof name, "%.*s", (int)(length < NAME_ROOM ? length : 0), text + 4);
  if (!*name)
    return strut_fail(error, STRUT_USAGE,
                      "expected env:VARIABLE/N, a name of at most %d bytes, not '%.80s'",
                      NAME_ROOM - 1, text);
  const struct system own = {"env:VARIABLE", name, 0, "an array",
                             "set it to the shard's number, counted from 0"};
  return read_system(text, &own, text + 4 + length, task, shard, error);
}

/* Does the text begin with this word, and a count or nothing behind it? */
static bool begins_with(const char *text, const char *word) {
  size_t length = strlen(word);
  return strncmp(text, word, length) == 0 && (!text[length] || text[length] == '/');
}

strut_status strut_shard_read(const char *text, const strut_array_task *task, strut_shard *shard,
                              strut_error *error) {
  const char *at = text;
  if (strcmp(text, systems[0].word) == 0) return read_array(text, task, shard, error);
  for (size_t i = 0; i < SYSTEMS; i++)
    if (begins_with(text, systems[i].word))
      return read_system(text, &systems[i], text + strlen(systems[i].word), task, shard, error);
  if (strncmp(text, "env:", 4) == 0) return read_variable(text, task, shard, error);
  shard->index = take_integer(&at);
  shard->count = *at == '/' ? integer_of(at + 1) : -1;
  if (shard->count < 0 || shard->index < 0)
    return strut_fail(
        error, STRUT_USAGE,
        "expected K/N, slurm, or one of slurm, pbs, torque, lsf, sge, kubernetes and env:VARIABLE "
        "with /N, not '%s'",
        text);
  return check(text, *shard, error);
}

void strut_shard_points(strut_shard shard, strut_slots_description *plan) {
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

/* Is it the file name of a shard? */
static bool is_shard(const char *name, strut_shard *shard) {
  char expected[NAME_ROOM];
  long long index, count;
  if (sscanf(name, "shard-%9lld-of-%9lld", &index, &count) != 2) return false;
  *shard = (strut_shard){index, count};
  snprintf(expected, sizeof expected, "shard-%04lld-of-%04lld.slots", index, count);
  return strcmp(name, expected) == 0 && index >= 0 && index < count && count <= STRUT_MOST_SHARDS;
}

static strut_status note(strut_shards_found *found, strut_shard shard, strut_arena *arena,
                         strut_error *error) {
  if (!found->count) {
    found->there = strut_arena_allocate(arena, (size_t)shard.count, 1);
    if (!found->there) return strut_no_memory(error, "for shards");
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
  if (!whole || !folder) return strut_no_memory(error, "for shards");
  found->whole = access(whole, F_OK) == 0;
  DIR *open = opendir(folder);
  if (!open && errno == ENOENT) return STRUT_OK;
  if (!open) return strut_file_fail(error, "read", folder, errno);
  strut_status status = STRUT_OK;
  strut_shard shard;
  for (const struct dirent *entry; status == STRUT_OK && (entry = readdir(open));)
    if (is_shard(entry->d_name, &shard)) status = note(found, shard, arena, error);
  closedir(open);
  return status;
}

/* Could the new shard be merged with the existing files? */
static strut_status agree(const char *directory, strut_shard shard, const strut_shards_found *found,
                          strut_error *error) {
  if (shard.count && found->whole)
    return strut_fail(error, STRUT_USAGE,
                      "'%s' holds the study in one piece ('%s'): omit --shard, or give "
                      "another directory",
                      directory, WHOLE);
  if (!shard.count && found->count)
    return strut_fail(error, STRUT_USAGE,
                      "'%s' holds %lld shards of the study: give --shard as for these, or "
                      "another directory",
                      directory, (long long)found->count);
  int64_t count = found->other && found->count == shard.count ? found->other : found->count;
  if (count && count != shard.count)
    return strut_fail(error, STRUT_USAGE,
                      "'%s' is divided into %lld shards, not %lld: give --shard with "
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
    status = folder ? strut_directory_create(folder, error) : strut_no_memory(error, "for shards");
  }
  strut_arena_free(&arena);
  return status;
}

/* ---- merging ---- */

enum { MOST_NAMED = 12 };

/* State of a merge. */
typedef struct merge {
  const char *directory;
  strut_shards_found found;
  strut_slots **sources;
  size_t count;
  strut_arena arena;
} merge;

/* Appends the missing shards as "2, 5 to 7"; returns their number. */
static int64_t name_absent(const strut_shards_found *found, strut_buffer *text) {
  int64_t absent = 0;
  int named = 0;
  for (int64_t i = 0; i < found->count; i++) {
    if (found->there[i]) continue;
    int64_t last = i;
    while (last + 1 < found->count && !found->there[last + 1]) last++;
    absent += last - i + 1;
    if (named < MOST_NAMED) strut_buffer_add(text, named ? ", %lld" : "%lld", (long long)i);
    if (named < MOST_NAMED && last > i) strut_buffer_add(text, " to %lld", (long long)last);
    if (named++ == MOST_NAMED) strut_buffer_add(text, ", ...");
    i = last;
  }
  return absent;
}

/* Reports missing shards and incomplete shards in one sentence. */
static strut_status check_gaps(const merge *self, strut_error *error) {
  strut_buffer text = {0};
  int unfinished = 0;
  int64_t absent = name_absent(&self->found, &text);
  if (absent) strut_buffer_add(&text, ")");
  for (size_t i = 0; i < self->count; i++) {
    int64_t missing = self->sources[i] ? strut_slots_missing(self->sources[i]) : 0;
    if (missing == 0) continue;
    long long of = (long long)strut_slots_description_of(self->sources[i])->count;
    if (!self->found.count)
      return strut_fail(error, STRUT_FILE_TROUBLE,
                        "'%s': %lld of %lld points are missing: run the study again to resume it",
                        self->directory, (long long)missing, of);
    if (unfinished < MOST_NAMED)
      strut_buffer_add(&text, "%s shard %zu lacks %lld of its %lld points",
                       unfinished || absent ? "," : "", i, (long long)missing, of);
    if (unfinished++ == MOST_NAMED) strut_buffer_add(&text, ", ...");
  }
  if (!absent && !unfinished) return STRUT_OK;
  char gone[80] = "";
  if (absent)
    snprintf(gone, sizeof gone, " %lld of %lld shards %s missing (", (long long)absent,
             (long long)self->found.count, absent == 1 ? "is" : "are");
  strut_status status = text.failed
                            ? strut_no_memory(error, "for shards")
                            : strut_fail(error, STRUT_FILE_TROUBLE,
                                         "'%s':%s%.400s; run these shards again to resume them",
                                         self->directory, gone, text.text);
  strut_release(text.text);
  return status;
}

/* Opens the existing shards; the others stay NULL. */
static strut_status open_sources(merge *self, strut_error *error) {
  strut_status status = STRUT_OK;
  self->sources = strut_arena_allocate(&self->arena, self->count, sizeof *self->sources);
  if (!self->sources) return strut_no_memory(error, "for shards");
  for (size_t i = 0; i < self->count && status == STRUT_OK; i++) {
    strut_slots_description plan;
    if (self->found.count && !self->found.there[i]) continue;
    strut_shard shard = {(int64_t)i, self->found.count};
    char *path = strut_shard_path(self->directory, shard, &self->arena);
    status = path ? strut_slots_read(path, &self->sources[i], &plan, error)
                  : strut_no_memory(error, "for shards");
    if (status != STRUT_OK) break;
    strut_shard_points(shard, &plan);
    const strut_slots_description *own = strut_slots_description_of(self->sources[i]);
    if (plan.first != own->first || plan.count != own->count || plan.stride != own->stride)
      status = strut_fail(
          error, STRUT_USAGE,
          "'%s' holds other points than its name says; it may be a copy of another shard", path);
  }
  return status;
}

/* Checks that all files belong to one study. */
static strut_status check_study(const merge *self, strut_error *error) {
  size_t first = 0;
  while (first < self->count && !self->sources[first]) first++;
  for (size_t i = first + 1; i < self->count; i++) {
    if (!self->sources[i]) continue;
    const char *difference =
        strut_slots_difference(strut_slots_description_of(self->sources[first]),
                               strut_slots_description_of(self->sources[i]));
    if (difference)
      return strut_fail(
          error, STRUT_USAGE,
          "'%s': shards %zu and %zu belong to different studies, which differ in %s: remove "
          "those that are outdated and run them again",
          self->directory, first, i, difference);
  }
  return STRUT_OK;
}

static strut_status find(merge *self, strut_error *error) {
  strut_status status = strut_shards_find(self->directory, &self->found, &self->arena, error);
  if (status != STRUT_OK) return status;
  if (!self->found.whole && !self->found.count)
    return strut_fail(
        error, STRUT_FILE_TROUBLE,
        "'%s' holds no results of a study: it has neither 'points.slots' nor 'shards'",
        self->directory);
  if (self->found.whole && self->found.count)
    return strut_fail(error, STRUT_USAGE,
                      "'%s' holds the study twice, in one piece ('points.slots') and in 'shards': "
                      "remove one of them",
                      self->directory);
  if (self->found.other)
    return strut_fail(
        error, STRUT_USAGE,
        "'%s' holds shards of %lld and shards of %lld, which overlap: remove those of "
        "one kind",
        self->directory, (long long)self->found.count, (long long)self->found.other);
  self->count = self->found.count ? (size_t)self->found.count : 1;
  return STRUT_OK;
}

strut_status strut_merge(const char *directory, strut_merge_check *enough, void *context,
                         strut_merged *merged, strut_error *error) {
  merge m = {.directory = directory};
  *merged = (strut_merged){0};
  strut_status status = find(&m, error);
  if (status == STRUT_OK) status = open_sources(&m, error);
  if (status == STRUT_OK) status = check_study(&m, error);
  if (status == STRUT_OK)
    status = enough ? enough(context, m.sources, m.count, error) : check_gaps(&m, error);
  const strut_slot_rows rows = {.sources = m.sources, .count = m.count, .partial = enough};
  if (status == STRUT_OK)
    status = strut_study_table_write(directory, "table.csv", &rows, &merged->points, error);
  merged->shards = m.found.count;
  for (size_t i = 0; i < m.count && status == STRUT_OK; i++) {
    merged->failed += strut_slots_failed(m.sources[i]);
    merged->inaccurate += strut_slots_inaccurate(m.sources[i]);
  }
  for (size_t i = 0; m.sources && i < m.count; i++) strut_slots_close(m.sources[i]);
  strut_arena_free(&m.arena);
  return status;
}
