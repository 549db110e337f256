/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/language/cases.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_LINES = 200, PATH_SIZE = 600 };

/* The lines of one scene; `place` is the index at which the next line is added. */
typedef struct lines {
  char *line[MOST_LINES];
  size_t count, place;
} lines;

typedef struct document {
  const char *folder;
  char path[PATH_SIZE];
  int line_number;
  faulty_cases *cases;
  lines base, text;
  char *base_text;     /* of the file that the base begins with */
  const char *purpose; /* of the base and of its cases */
  faulty_case *now;    /* the base or case that is being read; NULL before the first */
} document;

static void *allocate(size_t size) {
  void *bytes = calloc(1, size);
  if (!bytes) abort();
  return bytes;
}

static char *copy_text(const char *text) { return strcpy(allocate(strlen(text) + 1), text); }

static void refuse(const document *d, const char *message, const char *text) {
  fprintf(stderr, "%s:%d: %s '%s'\n", d->path, d->line_number, message, text);
  exit(EXIT_FAILURE);
}

static char *read_file(const char *path, size_t *length) {
  FILE *file = fopen(path, "rb");
  if (!file) {
    fprintf(stderr, "%s: cannot be opened\n", path);
    exit(EXIT_FAILURE);
  }
  char *text = allocate(1 << 20);
  *length = fread(text, 1, (1 << 20) - 1, file);
  fclose(file);
  return text;
}

/* ---- changes of a base ---- */

/* The one line that begins with so many bytes of `start`. */
static size_t find_line(const document *d, const char *start, size_t length) {
  size_t found = 0, matches = 0;
  for (size_t i = 0; i < d->text.count; i++)
    if (strncmp(d->text.line[i], start, length) == 0) {
      found = i;
      matches++;
    }
  if (matches == 0) refuse(d, "no line of the base begins with", start);
  if (matches > 1) refuse(d, "several lines of the base begin with", start);
  return found;
}

static void insert_line(const document *d, lines *text, char *line) {
  if (text->count == MOST_LINES) refuse(d, "too many lines before", line);
  memmove(&text->line[text->place + 1], &text->line[text->place],
          (text->count - text->place) * sizeof text->line[0]);
  text->line[text->place++] = line;
  text->count++;
}

static void remove_line(lines *text, size_t at) {
  text->count--;
  memmove(&text->line[at], &text->line[at + 1], (text->count - at) * sizeof text->line[0]);
  text->place = at;
}

static void change_line(document *d, char mark, char *line) {
  if (!d->now || (mark == '|' && !d->now->is_base))
    refuse(d, "this mark has no meaning here:", line);
  if (mark == '=') {
    char *colon = strchr(line, ':');
    remove_line(&d->text, find_line(d, line, colon ? (size_t)(colon + 1 - line) : strlen(line)));
  }
  if (mark == '-') remove_line(&d->text, find_line(d, line, strlen(line)));
  if (mark == '@') d->text.place = *line ? find_line(d, line, strlen(line)) + 1 : 0;
  if (mark == '|' || mark == '=' || mark == '+') insert_line(d, &d->text, line);
}

/* ---- bases and cases ---- */

static char *join_lines(const lines *text, size_t *length) {
  *length = 0;
  for (size_t i = 0; i < text->count; i++) *length += strlen(text->line[i]) + 1;
  char *joined = allocate(*length + 1), *end = joined;
  for (size_t i = 0; i < text->count; i++) end += sprintf(end, "%s\n", text->line[i]);
  return joined;
}

static void free_case(faulty_case *c) {
  for (size_t k = 0; k < c->message_count; k++) free(c->message[k]);
  for (size_t k = 0; k < c->set_count; k++) free(c->set[k]);
  free(c->name);
  free(c->document);
  free(c->text);
}

/* Gives what has been read its text. A base is kept for the cases behind it, and
   listed unless it is empty. */
static void finish_case(document *d) {
  if (!d->now) return;
  if (!d->now->text) d->now->text = join_lines(&d->text, &d->now->length);
  if (d->now->is_base) d->base = d->text;
  if (d->now->is_base == (d->now->message_count > 0))
    refuse(d, "a base has no messages, and a case has one or more:", d->now->name);
  if (d->now->is_base && d->now->length == 0) free_case(&d->cases->items[--d->cases->count]);
  d->now = NULL;
}

/* name: NULL for that of the document and the line. */
static void begin_case(document *d, const char *name, bool is_base) {
  faulty_cases *all = d->cases;
  char own[PATH_SIZE];
  const char *file = strrchr(d->path, '/') + 1;
  snprintf(own, sizeof own, "%.*s-%d", (int)strcspn(file, "."), file, d->line_number);
  finish_case(d);
  all->items = realloc(all->items, (all->count + 1) * sizeof *all->items);
  if (!all->items) abort();
  d->now = &all->items[all->count++];
  if (is_base) {
    d->base.count = 0;
    d->purpose = "run";
  }
  char place[PATH_SIZE + 20];
  snprintf(place, sizeof place, "%s:%d", d->path, d->line_number);
  *d->now = (faulty_case){.is_base = is_base,
                          .name = copy_text(name ? name : own),
                          .document = copy_text(place),
                          .purpose = d->purpose};
  d->text = d->base;
  d->text.place = d->text.count;
}

static void set_purpose(document *d, const char *word) {
  static const char *const words[] = {"run", "statics", "any"};
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
    if (strcmp(words[i], word) == 0) {
      d->now->purpose = words[i];
      if (d->now->is_base) d->purpose = words[i];
      return;
    }
  refuse(d, "unknown purpose", word);
}

static void add_message(document *d, const char *text) {
  if (d->now->message_count == CASE_MOST_MESSAGES) refuse(d, "too many messages:", text);
  d->now->message[d->now->message_count++] = copy_text(text);
}

/* The text of a file beside the document. */
static char *read_beside(const document *d, const char *name, size_t *length) {
  char path[2 * PATH_SIZE];
  snprintf(path, sizeof path, "%s/%s", d->folder, name);
  return read_file(path, length);
}

static void take_lines(document *d, const char *name) {
  size_t length;
  char *rest;
  free(d->base_text);
  d->base_text = read_beside(d, name, &length);
  for (char *line = strtok_r(d->base_text, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest))
    insert_line(d, &d->text, line);
}

/* "WORD rest of the line" */
static void read_statement(document *d, char *line) {
  const char *rest = strchr(line, ' ');
  size_t length = rest ? (size_t)(rest - line) : strlen(line);
  rest = rest ? rest + 1 : "";
#define IS(word) (length == sizeof word - 1 && strncmp(line, word, length) == 0)
  if (IS("base")) {
    begin_case(d, "", true);
    if (*rest) take_lines(d, rest);
  } else if (IS("case")) {
    begin_case(d, rest, false);
  } else if (IS("expect")) {
    add_message(d, rest);
  } else if (IS("note")) {
    char note[2000];
    snprintf(note, sizeof note, "note: %s", rest);
    add_message(d, note);
  } else if (IS("purpose")) {
    set_purpose(d, rest);
  } else if (IS("set") && strchr(rest, '=') && d->now->set_count < CASE_MOST_SETS) {
    d->now->set[d->now->set_count++] = copy_text(rest);
  } else if (IS("file")) {
    d->now->text = read_beside(d, rest, &d->now->length);
  } else {
    refuse(d, "unknown line", line);
  }
#undef IS
}

/* ---- documents ---- */

/* Whether the line is of another case than the messages before it. */
static bool begins_next(const document *d, const char *line) {
  return d->now && d->now->message_count > 0 && strncmp(line, "expect", 6) != 0 &&
         strncmp(line, "note", 4) != 0;
}

static void read_document(faulty_cases *cases, const char *folder, const char *name) {
  size_t length;
  document *d = allocate(sizeof *d);
  d->folder = folder;
  d->cases = cases;
  d->purpose = "run";
  snprintf(d->path, sizeof d->path, "%s/%s", folder, name);
  char *text = read_file(d->path, &length), *next;
  for (char *line = text; *line; line = next) {
    next = line + strcspn(line, "\n");
    if (*next) *next++ = '\0';
    d->line_number++;
    if (!*line || begins_next(d, line)) finish_case(d);
    if (!*line || *line == '#') continue;
    if (!d->now && strncmp(line, "base", 4) != 0 && strncmp(line, "case ", 5) != 0)
      begin_case(d, NULL, false);
    if (!strchr("|=-+@", *line)) {
      read_statement(d, line);
      continue;
    }
    char *message = strstr(line, " => ");
    if (message) *message = '\0';
    for (char *after; line; line = after) { /* several changes in one line */
      after = strstr(line, " ;; ");
      if (after) *after = '\0', after += 4;
      change_line(d, *line, line + 1);
    }
    if (message) add_message(d, message + 4);
  }
  finish_case(d);
  free(d->base_text);
  free(text);
  free(d);
}

static int is_document(const struct dirent *entry) {
  const char *ending = strrchr(entry->d_name, '.');
  return ending && strcmp(ending, ".cases") == 0;
}

faulty_cases read_faulty_cases(const char *folder) {
  faulty_cases cases = {0};
  struct dirent **found;
  int count = scandir(folder, &found, is_document, alphasort);
  for (int i = 0; i < count; i++) {
    read_document(&cases, folder, found[i]->d_name);
    free(found[i]);
  }
  if (count > 0) free(found);
  if (cases.count == 0) {
    fprintf(stderr, "%s: no cases\n", folder);
    exit(EXIT_FAILURE);
  }
  return cases;
}

void free_faulty_cases(faulty_cases *cases) {
  for (size_t i = 0; i < cases->count; i++) free_case(&cases->items[i]);
  free(cases->items);
  *cases = (faulty_cases){0};
}

const faulty_case *find_faulty_case(const faulty_cases *cases, const char *name) {
  for (size_t i = 0; i < cases->count; i++)
    if (strcmp(cases->items[i].name, name) == 0) return &cases->items[i];
  return NULL;
}

bool write_faulty_case(const faulty_case *c, const char *folder) {
  char path[PATH_SIZE];
  snprintf(path, sizeof path, "%s/%s.yaml", folder, c->name);
  FILE *file = fopen(path, "wb");
  bool written = file && fwrite(c->text, 1, c->length, file) == c->length;
  if (file && fclose(file) != 0) written = false;
  if (!written) perror(path);
  return written;
}
