/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/cluster/cluster_script.h"

#include <ctype.h>
#include <stdbool.h>
#include <string.h>

#include "engine/output/buffer.h"
#include "engine/study/results/study_table.h"

/* slurm.sh, embedded at build time and followed by a row of NULL. @NAME@ is to be replaced, and a line whose NAME
   has no value left out. */
extern const strut_embedded strut_slurm_template[];

enum { MOST_NAME = 60 };

/* A placeholder of the templates and its text; NULL removes its lines. */
typedef struct placeholder {
  const char *name, *value;
} placeholder;

static bool is_plain(const char *text, const char *others) {
  size_t length = 0;
  if (!text) return true;
  for (; text[length]; length++)
    if (!isdigit((unsigned char)text[length]) && !strchr(others, text[length])) return false;
  return length > 0 && length < 32 && isdigit((unsigned char)text[0]);
}

/* A line break would end a here-document; no other control character is meant, either. */
static bool has_controls(const char *text) {
  while (*text && (unsigned char)*text >= 0x20 && *text != 0x7F) text++;
  return *text;
}

static strut_status check_texts(const strut_cluster_script *script, strut_error *error) {
  const char *const texts[] = {script->program, script->folder, script->study, script->output};
  bool wild = false;
  for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) wild = wild || has_controls(texts[i]);
  for (size_t i = 0; i < script->word_count; i++) wild = wild || has_controls(script->words[i]);
  if (!wild) return STRUT_OK;
  return strut_fail(error, STRUT_USAGE,
                    "a path or an option for the script has a line break or another control "
                    "character; choose one without");
}

static strut_status check(const strut_cluster_script *script, strut_error *error) {
  if (script->shards < 1 || script->shards > STRUT_MOST_SHARDS)
    return strut_fail(error, STRUT_USAGE, "a study has 1 to %d shards", STRUT_MOST_SHARDS);
  if (!is_plain(script->time, ":-"))
    return strut_fail(error, STRUT_USAGE,
                      "'%s' is not a time for Slurm: minutes, H:M:S or D-H:M:S, such as 12:00:00",
                      script->time);
  if (!is_plain(script->memory, "KMGT"))
    return strut_fail(error, STRUT_USAGE, "'%s' is not an amount of memory, such as 500M or 2G",
                      script->memory);
  return check_texts(script, error);
}

/* A name for the queue: letters, digits, dots, dashes and underscores. */
static char *plain_name(const char *name, strut_arena *arena) {
  size_t length = strlen(name) < MOST_NAME ? strlen(name) : MOST_NAME;
  char *plain = strut_arena_text(arena, name, length);
  for (char *c = plain; c && *c; c++)
    if ((unsigned char)*c >= 0x80 || !(isalnum((unsigned char)*c) || strchr("._-", *c))) *c = '_';
  return plain;
}

/* Adds a word in single quotes, which the shell takes literally. */
static void add_quoted(strut_buffer *to, const char *word) {
  strut_buffer_add(to, "'");
  for (; *word; word++) strut_buffer_add(to, *word == '\'' ? "'\\''" : "%c", *word);
  strut_buffer_add(to, "'");
}

static const char *quote(const char *const *words, size_t count, strut_arena *arena) {
  strut_buffer quoted = {0};
  for (size_t i = 0; i < count; i++) {
    if (i) strut_buffer_add(&quoted, " ");
    add_quoted(&quoted, words[i]);
  }
  char *text = strut_buffer_take(&quoted);
  const char *kept = text ? strut_arena_format(arena, "%s", text) : NULL;
  strut_release(text);
  return kept;
}

/* The placeholder NAME of a text that starts with "@NAME@", or NULL. */
static const placeholder *find(const placeholder *all, const char *text) {
  for (; all->name; all++) {
    size_t length = strlen(all->name);
    if (text[0] == '@' && strncmp(text + 1, all->name, length) == 0 && text[length + 1] == '@')
      return all;
  }
  return NULL;
}

/* The template with its placeholders filled in, without the lines of those that have no value. */
static char *fill(const strut_embedded *template, const placeholder *all) {
  strut_buffer text = {0};
  size_t line = 0; /* where the latest one begins */
  for (const char *at = template->text; *at;) {
    const placeholder *self = find(all, at);
    if (!self) {
      strut_buffer_add(&text, "%c", *at);
      if (*at++ == '\n') line = text.length;
      continue;
    }
    at += strlen(self->name) + 2;
    if (self->value) strut_buffer_add(&text, "%s", self->value);
    if (self->value) continue;
    text.length = line;
    at += strcspn(at, "\n");
    at += *at == '\n';
  }
  return strut_buffer_take(&text);
}

strut_status strut_cluster_script_write(const strut_cluster_script *script, char **text,
                                        strut_error *error) {
  strut_arena arena = {0};
  *text = NULL;
  strut_status status = check(script, error);
  if (status != STRUT_OK) return status;
  const placeholder all[] = {
      {"job", plain_name(script->name && *script->name ? script->name : "study", &arena)},
      {"strut", quote(&script->program, 1, &arena)},
      {"folder", quote(&script->folder, 1, &arena)},
      {"study", quote(&script->study, 1, &arena)},
      {"results", quote(&script->output, 1, &arena)},
      {"shards", strut_arena_format(&arena, "%lld", (long long)script->shards)},
      {"last", strut_arena_format(&arena, "%lld", (long long)script->shards - 1)},
      {"cpus", strut_arena_format(&arena, "%lld", (long long)script->cpus)},
      {"words", script->word_count ? quote(script->words, script->word_count, &arena) : NULL},
      {"time", script->time},
      {"memory", script->memory},
      {NULL, NULL}};
  bool good = !script->word_count || all[8].value;
  for (size_t i = 0; i < 8; i++) good = good && all[i].value;
  if (good) *text = fill(strut_slurm_template, all);
  strut_arena_free(&arena);
  return *text ? STRUT_OK : strut_no_memory(error, "for the script");
}
