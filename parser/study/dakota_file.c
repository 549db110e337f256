/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/study/dakota_file.h"

#include <stdlib.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "parser/yaml/text.h"

/* One line of the file: a value and its name. */
typedef struct entry {
  const char *value, *name;
  bool quoted; /* the value was in quotes */
  strut_place value_place, name_place;
} entry;

typedef struct dakota_reader {
  strut_diagnostics *diagnostics;
  strut_dakota_file *file;
  const char *text, *end;
  uint32_t line;
  bool aprepro, out_of_memory;
} dakota_reader;

/* Groups of lines, each begun by how many follow: by their names in both formats. */
enum { VARIABLES, FUNCTIONS, DERIVATIVES, COMPONENTS, EVALUATION, METADATA, GROUPS };
static const char *const groups[GROUPS][2] = {{"variables", "DAKOTA_VARS"},
                                              {"functions", "DAKOTA_FNS"},
                                              {"derivative_variables", "DAKOTA_DER_VARS"},
                                              {"analysis_components", "DAKOTA_AN_COMPS"},
                                              {"eval_id", "DAKOTA_EVAL_ID"},
                                              {"metadata", "DAKOTA_METADATA"}};
enum { MOST_ENTRIES = 100000 };

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/* text[from..to) without blanks at its ends, and its place on the line. */
static const char *trim(dakota_reader *r, const char *line, const char *from, const char *to,
                        strut_place *place) {
  while (from < to && is_blank(*from)) from++;
  while (to > from && is_blank(to[-1])) to--;
  size_t length = (size_t)(to - from);
  *place = strut_place_at(r->line, (uint32_t)strut_text_points(line, (size_t)(from - line)) + 1,
                          (uint32_t)strut_text_points(from, length));
  const char *copy = strut_arena_text(&r->file->arena, from, length);
  if (!copy) r->out_of_memory = true;
  return copy ? copy : "";
}

static void unquote(dakota_reader *r, entry *e) {
  size_t length = strlen(e->value);
  if (length < 2 || e->value[0] != '"' || e->value[length - 1] != '"') return;
  e->quoted = true;
  e->value = strut_arena_text(&r->file->arena, e->value + 1, length - 2);
  if (!e->value) r->out_of_memory = true;
  if (!e->value) e->value = "";
}

/* "{ name = value }" */
static bool split_aprepro(dakota_reader *r, const char *line, const char *from, const char *to,
                          entry *e) {
  const char *equals = memchr(from, '=', (size_t)(to - from));
  while (to > from && is_blank(to[-1])) to--;
  if (!equals || to[-1] != '}' || equals >= to - 1) return false;
  e->name = trim(r, line, from + 1, equals, &e->name_place);
  e->value = trim(r, line, equals + 1, to - 1, &e->value_place);
  unquote(r, e);
  return true;
}

/* "value name": the name is the last word. */
static bool split_standard(dakota_reader *r, const char *line, const char *from, const char *to,
                           entry *e) {
  const char *word = to;
  while (word > from && is_blank(word[-1])) word--;
  to = word;
  while (word > from && !is_blank(word[-1])) word--;
  if (word == from) return false;
  e->name = trim(r, line, word, to, &e->name_place);
  e->value = trim(r, line, from, word, &e->value_place);
  unquote(r, e);
  return *e->value || e->quoted;
}

/* The next line that is not empty. 1; 0 at the end; -1: it was refused. */
static int next_entry(dakota_reader *r, entry *e) {
  while (r->text < r->end) {
    const char *line = r->text, *from = line;
    const char *stop = memchr(line, '\n', (size_t)(r->end - line));
    if (!stop) stop = r->end;
    r->text = stop < r->end ? stop + 1 : stop;
    r->line++;
    while (from < stop && is_blank(*from)) from++;
    if (from == stop) continue;
    *e = (entry){0};
    if (*from == '{') r->aprepro = true;
    bool fine = *from == '{' ? split_aprepro(r, line, from, stop, e)
                             : split_standard(r, line, from, stop, e);
    if (fine && *e->name) return 1;
    strut_diagnose(
        r->diagnostics,
        strut_place_at(r->line, (uint32_t)strut_text_points(line, (size_t)(from - line)) + 1, 1),
        "expected a line of DAKOTA's parameters file: 'VALUE NAME' or '{ NAME = VALUE }'");
    return -1;
  }
  return 0;
}

static int group_of(const entry *e) {
  for (int i = 0; i < GROUPS; i++)
    if (strcmp(e->name, groups[i][0]) == 0 || strcmp(e->name, groups[i][1]) == 0) return i;
  return -1;
}

static long count_of(dakota_reader *r, const entry *e) {
  char *end;
  long count = strtol(e->value, &end, 10);
  if (*end == '\0' && end != e->value && count >= 0 && count <= MOST_ENTRIES) return count;
  strut_diagnose(r->diagnostics, e->value_place, "expected how many of '%s' follow, up to %d",
                 e->name, MOST_ENTRIES);
  return -1;
}

static bool is_number(const char *text) {
  char *end;
  if (!*text || strspn(text, "+-.0123456789eE") != strlen(text)) return false;
  strtod(text, &end);
  return *end == '\0';
}

static void keep_variable(dakota_reader *r, const entry *e) {
  strut_request_value *v = &r->file->variables[r->file->variable_count++];
  *v = (strut_request_value){.name = e->name,
                             .text = e->value,
                             .number = !e->quoted && is_number(e->value),
                             .name_place = e->name_place,
                             .place = e->value_place};
  for (size_t i = 0; i + 1 < r->file->variable_count; i++)
    if (strcmp(r->file->variables[i].name, e->name) == 0)
      strut_diagnose(r->diagnostics, e->name_place, "variable '%.80s' is given twice", e->name);
}

/* "ASV_1:velocity" */
static void keep_function(dakota_reader *r, const entry *e) {
  strut_dakota_function *f = &r->file->functions[r->file->function_count++];
  const char *colon = strchr(e->name, ':');
  *f = (strut_dakota_function){.name = colon ? colon + 1 : "", .place = e->name_place};
  if (strlen(e->value) == 1 && *e->value >= '0' && *e->value <= '7')
    f->wanted = *e->value - '0';
  else
    strut_diagnose(r->diagnostics, e->value_place,
                   "expected a number from 0 to 7 for '%.80s': what is wanted of this function",
                   e->name);
  if (f->wanted > 1)
    strut_diagnose(r->diagnostics, e->value_place,
                   "'%.80s' asks for derivatives, which are not computed: say numerical_gradients, "
                   "or no_gradients and no_hessians, to DAKOTA",
                   e->name);
}

/* Reads the lines of a group. False: the rest of the file makes no sense. */
static bool read_group(dakota_reader *r, int group, long count) {
  strut_dakota_file *file = r->file;
  size_t room = (size_t)count + 1;
  entry e;
  if (group == VARIABLES)
    file->variables = strut_arena_allocate(&file->arena, room, sizeof *file->variables);
  if (group == FUNCTIONS)
    file->functions = strut_arena_allocate(&file->arena, room, sizeof *file->functions);
  r->out_of_memory = r->out_of_memory || (group == VARIABLES && !file->variables) ||
                     (group == FUNCTIONS && !file->functions);
  for (long i = 0; i < count && !r->out_of_memory; i++) {
    int got = next_entry(r, &e);
    if (got == 0)
      strut_diagnose(r->diagnostics, strut_place_at(r->line ? r->line : 1, 1, 1),
                     "the file ends within the %ld %s", count, groups[group][r->aprepro]);
    if (got <= 0) return false;
    if (group == VARIABLES) keep_variable(r, &e);
    if (group == FUNCTIONS) keep_function(r, &e);
  }
  if (group == METADATA && count > 0)
    strut_diagnose(r->diagnostics, strut_place_at(r->line, 1, 1),
                   "there is no metadata: leave 'metadata' out of DAKOTA's responses");
  return !r->out_of_memory;
}

static void read_all(dakota_reader *r) {
  unsigned seen = 0;
  entry e;
  int got = 0;
  while ((got = next_entry(r, &e)) > 0) {
    int group = group_of(&e);
    long count = group == EVALUATION ? 0 : group < 0 ? -1 : count_of(r, &e);
    if (group < 0 || (seen >> group & 1u)) {
      strut_diagnose(r->diagnostics, e.name_place, "expected one of the groups %s%s, found '%.80s'",
                     "variables, functions, derivative_variables, analysis_components, eval_id",
                     group < 0 ? "" : " once", e.name);
      return;
    }
    seen |= 1u << group;
    if (count < 0 || !read_group(r, group, count)) return;
  }
  if (got < 0) return;
  for (int i = VARIABLES; i <= FUNCTIONS; i++)
    if (!(seen >> i & 1u))
      strut_diagnose(r->diagnostics, strut_place_at(1, 1, 1),
                     "this is no parameters file of DAKOTA: it lacks '%s'", groups[i][0]);
}

strut_status strut_dakota_read(const char *text, size_t length, strut_diagnostics *diagnostics,
                               strut_dakota_file *file) {
  *file = (strut_dakota_file){0};
  dakota_reader r = {.diagnostics = diagnostics, .file = file, .text = text, .end = text + length};
  for (size_t i = 0; i < length;) { /* before any of it is shown */
    uint32_t code;
    size_t bytes = strut_text_decode(text + i, length - i, &code);
    if (code == STRUT_BAD_CODE || (strut_text_forbidden(code))) {
      strut_diagnose(diagnostics, strut_place_at(1, 1, 1), "the file is not a text in UTF-8");
      return STRUT_BAD_SCENE;
    }
    i += bytes;
  }
  strut_c_locale locale = strut_c_locale_enter();
  read_all(&r);
  strut_c_locale_leave(locale);
  if (r.out_of_memory || diagnostics->out_of_memory) return STRUT_NO_MEMORY;
  return diagnostics->count ? STRUT_BAD_SCENE : STRUT_OK;
}

void strut_dakota_free(strut_dakota_file *file) {
  strut_arena_free(&file->arena);
  *file = (strut_dakota_file){0};
}

strut_status strut_dakota_request(const strut_study_file *study, const strut_dakota_file *file,
                                  strut_request *request, strut_diagnostics *diagnostics) {
  for (size_t i = 0; i < file->variable_count; i++) {
    strut_request_value *v = &file->variables[i];
    bool text = false;
    if (!strut_request_parameter(study, request, v->name, &text)) {
      strut_diagnose(diagnostics, v->name_place, "the model has no parameter '%.80s'", v->name);
    } else if (!text && !v->number) {
      strut_diagnose(diagnostics, v->place, "expected a number for '%.80s', found '%.80s'", v->name,
                     v->text);
    }
    if (text) v->number = false;
  }
  request->values = file->variables;
  request->value_count = file->variable_count;
  return diagnostics->count ? STRUT_BAD_SCENE : STRUT_OK;
}
