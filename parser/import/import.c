/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/import/import.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/number_text.h"
#include "parser/import/import_parts.h"
#include "parser/read/csv.h"
#include "parser/read/read_scene.h"

static const char *format_text(strut_import_scene *s, const char *format, va_list values) {
  va_list again;
  va_copy(again, values);
  int length = vsnprintf(NULL, 0, format, again);
  va_end(again);
  char *text = length < 0 ? NULL : strut_arena_allocate(&s->arena, (size_t)length + 1, 1);
  if (!text) s->out_of_memory = true;
  if (!text) return "";
  vsnprintf(text, (size_t)length + 1, format, values);
  return text;
}

void strut_import_line(strut_import_scene *s, strut_writer *to, const char *format, ...) {
  va_list values;
  va_start(values, format);
  strut_put(to, format_text(s, format, values));
  va_end(values);
  strut_put(to, "\n");
  s->out_of_memory = s->out_of_memory || to->failed;
}

const char *strut_import_text(strut_import_scene *s, const char *format, ...) {
  va_list values;
  va_start(values, format);
  const char *text = format_text(s, format, values);
  va_end(values);
  return text;
}

const char *strut_import_name(strut_import_scene *s, const char *name) {
  enum { MOST = 200 };
  char *kept = strut_arena_text(&s->arena, name, strlen(name) < MOST ? strlen(name) : MOST);
  strut_writer quoted = {.text = NULL};
  if (!kept) s->out_of_memory = true;
  for (char *c = kept; c && *c; c++) {
    bool plain = (*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || (*c >= '0' && *c <= '9') ||
                 *c == '_' || *c == '-' || *c == '.';
    if (!plain) *c = '_';
  }
  strut_put_name(&quoted, kept && *kept ? kept : "_"); /* in quotes where YAML would misread it */
  const char *text = quoted.text ? strut_arena_text(&s->arena, quoted.text, quoted.length) : NULL;
  if (!text) s->out_of_memory = true;
  strut_release(quoted.text);
  return text ? text : "_";
}

const char *strut_import_number(strut_import_scene *s, double value) {
  char text[STRUT_NUMBER_TEXT];
  strut_number_text(value, text);
  return strut_import_text(s, "%s", text);
}

const char *strut_import_length(strut_import_scene *s, double value) {
  double parts = 1.0 / s->unit, whole = round(parts);
  bool decimal = whole >= 1.0 && fabs(parts - whole) < 1e-9 * whole;
  return strut_import_number(s, decimal ? value / whole : value * s->unit); /* rounded once */
}

bool strut_import_read_number(strut_diagnostics *d, const strut_tree *value, const char *what,
                              double *number) {
  bool scalar = value->kind == STRUT_TREE_SCALAR && *value->text;
  if (scalar && strut_csv_number(value->text, number) && isfinite(*number)) return true;
  strut_diagnose(d, value->place, "expected a number for %s, found '%.60s'", what,
                 value->kind == STRUT_TREE_SCALAR ? value->text
                 : value->kind == STRUT_TREE_LIST ? "a list"
                                                  : "a mapping");
  return false;
}

void strut_import_node_add(strut_import_scene *s, strut_diagnostics *said, strut_place place,
                           const char *name, const char *value) {
  if (s->node_count == s->node_room) {
    s->node_room = 2 * s->node_room + 64;
    strut_import_node *more = strut_arena_allocate(&s->arena, s->node_room, sizeof *more);
    if (!more) s->out_of_memory = true;
    if (!more) return;
    if (s->node_count) memcpy(more, s->nodes, s->node_count * sizeof *more);
    s->nodes = more;
  }
  const char *kept = strut_import_text(s, "%s", name);
  int32_t there = strut_name_map_add(&s->node_names, kept, (int32_t)s->node_count);
  if (there == -2) s->out_of_memory = true;
  if (there >= 0) strut_diagnose(said, place, "node '%.60s' is given twice", name);
  s->nodes[s->node_count++] = (strut_import_node){
      .name = strut_import_name(s, name), .value = value, .place = place, .said = said};
}

const char *strut_import_node_use(strut_import_scene *s, const char *name) {
  int32_t found = strut_name_map_find(&s->node_names, name);
  if (found < 0) return strut_import_name(s, name); /* the scene's own check reports it */
  s->nodes[found].used = true;
  return s->nodes[found].name;
}

static void write_nodes(strut_import_scene *s) {
  for (size_t i = 0; i < s->node_count; i++) {
    const strut_import_node *n = &s->nodes[i];
    if (n->used)
      strut_import_line(s, &s->section[STRUT_IMPORT_NODES], "  %s: %s", n->name, n->value);
    else
      strut_note(n->said, n->place, "not imported: node %s, which nothing uses", n->name);
  }
}

/* ---- which format ---- */

/* Is this a line of the text? */
static bool has_line(const char *text, const char *line) {
  size_t length = strlen(line);
  for (const char *at = text; (at = strstr(at, line)) != NULL; at += length) {
    const char *before = at, *after = at + length;
    while (before > text && (before[-1] == ' ' || before[-1] == '\t')) before--;
    while (*after == ' ' || *after == '\t' || *after == '\r') after++;
    if ((before == text || before[-1] == '\n') && (*after == '\n' || !*after)) return true;
  }
  return false;
}

int strut_import_guess(const char *text, size_t length) {
  strut_document document = {0};
  strut_diagnostics unsaid = {0};
  int found = -1;
  if (strlen(text) != length) return -1;
  if (has_line(text, "NODES")) return STRUT_IMPORT_SPRINGABLE;
  strut_diagnostics_source(&unsaid, "", text, length);
  strut_document_read(&document, &unsaid);
  const strut_tree *root = document.root;
  if (root && root->kind == STRUT_TREE_MAP) {
    if (strut_tree_find(root, "connections", NULL))
      found = STRUT_IMPORT_TENSEGRITYSIM;
    else if (strut_tree_find(root, "pair_groups", NULL) ||
             strut_tree_find(root, "substructures", NULL) ||
             strut_tree_find(root, "bond_groups", NULL))
      found = STRUT_IMPORT_NTRT;
  } else {
    size_t first = strcspn(text, "\n");
    if (memchr(text, ',', first)) found = STRUT_IMPORT_TABLES;
  }
  strut_document_free(&document);
  strut_diagnostics_free(&unsaid);
  return found;
}

/* ---- the scene ---- */

/* The last part of a path, without what a comment could not hold. */
static const char *base_name(strut_import_scene *s, const char *path) {
  const char *slash = strrchr(path, '/');
  char *name =
      strut_arena_text(&s->arena, slash ? slash + 1 : path, strlen(slash ? slash + 1 : path));
  for (char *c = name; c && *c; c++)
    if ((unsigned char)*c < ' ' || (unsigned char)*c >= 0x7f) *c = '_';
  if (!name) s->out_of_memory = true;
  return name ? name : "";
}

static char *join(strut_import_scene *s, strut_import_format format) {
  static const char *const keys[] = {
#define KEY(name, key) key,
      STRUT_IMPORT_SECTIONS(KEY)
#undef KEY
  };
  static const char *const titles[] = {
#define TITLE(name, word, title) title,
      STRUT_IMPORT_FORMATS(TITLE)
#undef TITLE
  };
  strut_writer text = {.text = NULL};
  const char *name = base_name(s, s->files[0].name);
  strut_import_line(s, &text, "# Imported by strut from '%s'%s%s%s, %s.", name,
                    s->file_count > 1 ? " and '" : "",
                    s->file_count > 1 ? base_name(s, s->files[1].name) : "",
                    s->file_count > 1 ? "'" : "", titles[format]);
  strut_put(&text, "strut: 1\nname: ");
  strut_put_quoted(&text, name);
  strut_put(&text, "\n");
  strut_put(&text, s->head.text ? s->head.text : "");
  for (int i = 0; i < STRUT_IMPORT_SECTION_COUNT; i++) {
    if (!s->section[i].length) continue;
    strut_put(&text, keys[i]);
    strut_put(&text, ":\n");
    strut_put(&text, s->section[i].text);
  }
  if (!text.failed) return text.text;
  strut_release(text.text);
  return NULL;
}

/* Does the text make a scene? */
static strut_status try_scene(const char *scene, strut_diagnostics *result) {
  strut_setup setup;
  strut_status status = strut_setup_read(&setup, "the imported scene", scene, strlen(scene), NULL,
                                         0, STRUT_FOR_ANY, result);
  if (status == STRUT_OK) strut_setup_free(&setup);
  return status;
}

static strut_status read_files(strut_import_scene *s, strut_import_format format) {
  switch (format) {
    case STRUT_IMPORT_NTRT: return strut_import_ntrt(s);
    case STRUT_IMPORT_TENSEGRITYSIM: return strut_import_tensegritysim(s);
    case STRUT_IMPORT_SPRINGABLE: return strut_import_springable(s);
    case STRUT_IMPORT_TABLES: return strut_import_tables(s);
    case STRUT_IMPORT_COUNT: break;
  }
  return STRUT_USAGE;
}

strut_status strut_import(strut_import_format format, strut_import_file *files, size_t count,
                          double unit, char **scene, strut_diagnostics *result,
                          strut_error *error) {
  strut_import_scene s = {.files = files, .file_count = count, .unit = unit};
  *scene = NULL;
  if (unit <= 0.0) s.unit = format == STRUT_IMPORT_NTRT ? 0.1 : 1.0;
  bool many = format == STRUT_IMPORT_NTRT, tables = format == STRUT_IMPORT_TABLES;
  if (many ? count < 1 : count != (tables ? 2u : 1u))
    return strut_fail(error, STRUT_USAGE, "expected %s, found %zu files",
                      tables ? "a table of nodes and one of members"
                      : many ? "a file, and those of the structures in it"
                             : "one file",
                      count);
  for (size_t i = 0; i < count; i++)
    strut_diagnostics_source(&files[i].diagnostics, files[i].name, files[i].text, files[i].length);
  strut_c_locale locale = strut_c_locale_enter();
  strut_status status = read_files(&s, format);
  strut_c_locale_leave(locale);
  for (size_t i = 0; i < count && status != STRUT_NO_MEMORY; i++) {
    if (files[i].diagnostics.count) status = STRUT_BAD_SCENE;
    if (files[i].diagnostics.out_of_memory) s.out_of_memory = true;
  }
  bool any = s.section[STRUT_IMPORT_MEMBERS].length || s.section[STRUT_IMPORT_HINGES].length ||
             s.section[STRUT_IMPORT_CELLS].length || s.section[STRUT_IMPORT_DISTANCES].length;
  if (!status && !any && !s.out_of_memory)
    status = strut_fail(error, STRUT_BAD_SCENE, "'%s' has no member that a scene could have",
                        files[0].name);
  if (!status) write_nodes(&s);
  if (!status) *scene = join(&s, format);
  if (s.out_of_memory || (!status && !*scene)) status = STRUT_NO_MEMORY;
  if (!status) status = try_scene(*scene, result);
  if (status && status != STRUT_BAD_SCENE) {
    strut_release(*scene);
    *scene = NULL;
  }
  if (status == STRUT_NO_MEMORY) strut_no_memory(error, "");
  strut_release(s.head.text);
  for (int i = 0; i < STRUT_IMPORT_SECTION_COUNT; i++) strut_release(s.section[i].text);
  strut_name_map_free(&s.node_names);
  strut_arena_free(&s.arena);
  return status;
}

void strut_import_files_free(strut_import_file *files, size_t count) {
  for (size_t i = 0; i < count; i++) {
    strut_diagnostics_free(&files[i].diagnostics);
    strut_release(files[i].text);
    files[i] = (strut_import_file){0};
  }
}
