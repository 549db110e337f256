/* SPDX-License-Identifier: GPL-3.0-or-later */
/* springable: sections of comma-separated lines, with expressions of parameters. Without units: SI. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "parser/expression/expression.h"
#include "parser/import/springable.h"
#include "parser/yaml/text.h"

typedef enum section {
  NO_SECTION,
  PARAMETERS,
  NODES,
  SPRINGS,
  ANGULAR,
  PATHS,
  X_DISTANCES,
  Y_DISTANCES,
  LINE_DISTANCES,
  X_TO_MIDDLE, /* from the middle of two nodes to one */
  Y_TO_MIDDLE,
  X_FROM_MIDDLE,
  Y_FROM_MIDDLE,
  AREAS,
  LOADING,
  OTHERS /* that a scene has no words for */
} section;

/* ---- lines ---- */

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/* Splits line[0..length) at commas outside of brackets. */
static void split(strut_springable *r, const char *line, size_t length) {
  size_t from = 0;
  int depth = 0;
  r->field_count = 0;
  for (size_t i = 0; i <= length; i++) {
    char c = i < length ? line[i] : ',';
    depth += (c == '(' || c == '[' || c == '{') - (c == ')' || c == ']' || c == '}');
    if (i < length && (c != ',' || depth > 0)) continue;
    size_t begin = from, end = i;
    while (begin < end && is_blank(line[begin])) begin++;
    while (end > begin && is_blank(line[end - 1])) end--;
    from = i + 1;
    if (r->field_count == MOST_FIELDS) {
      strut_diagnose(r->said, strut_place_at(r->line, 1, 1), "more than %d fields in a line",
                     MOST_FIELDS);
      return;
    }
    strut_springable_field *f = &r->fields[r->field_count++];
    f->text = strut_arena_text(&r->scene->arena, line + begin, end - begin);
    if (!f->text) r->scene->out_of_memory = true;
    if (!f->text) f->text = "";
    f->place = strut_place_at(r->line, (uint32_t)strut_text_points(line, begin) + 1,
                              (uint32_t)strut_text_points(line + begin, end - begin));
  }
}

/* The i-th field, "" where there is none. */
const char *strut_springable_text(const strut_springable *r, size_t i) {
  return i < r->field_count ? r->fields[i].text : "";
}

strut_place strut_springable_place(const strut_springable *r, size_t i) {
  return i < r->field_count ? r->fields[i].place : strut_place_at(r->line, 1, 1);
}

/* ---- expressions ---- */

const strut_springable_point *strut_springable_node(const strut_springable *r, long index) {
  for (size_t i = 0; i < r->node_count; i++)
    if (r->nodes[i].index == index) return &r->nodes[i];
  return NULL;
}

static const strut_springable_parameter *find_parameter(const strut_springable *r, const char *name,
                                                        size_t length) {
  for (size_t i = 0; i < r->parameter_count; i++)
    if (strlen(r->parameters[i].name) == length &&
        strncmp(r->parameters[i].name, name, length) == 0)
      return &r->parameters[i];
  return NULL;
}

static bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

/* Appends what a word of the file is called in a scene; *fixed: its number stands for it. */
static void add_word(strut_springable *r, strut_writer *to, const char *word, size_t length,
                     bool *fixed) {
  static const char *const words[][2] = {{"PI", "pi"},       {"SIN", "sin"},     {"COS", "cos"},
                                         {"TAN", "tan"},     {"SQRT", "sqrt"},   {"ARCSIN", "asin"},
                                         {"ARCCOS", "acos"}, {"ARCTAN", "atan"}, {"EXP", "exp"},
                                         {"LOG", "log"},     {"ABS", "abs"}};
  const strut_springable_parameter *p = find_parameter(r, word, length);
  if (p) {
    strut_put(to, p->own);
    return;
  }
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
    if (strlen(words[i][0]) == length && strncmp(words[i][0], word, length) == 0) {
      strut_put(to, words[i][1]);
      return;
    }
  char *end;
  long index = length > 1 ? strtol(word + 1, &end, 10) : -1;
  const strut_springable_point *node =
      (*word == 'X' || *word == 'Y') && length > 1 && end == word + length
          ? strut_springable_node(r, index)
          : NULL;
  if (!node) {
    strut_put_part(to, word, length); /* the evaluation says what is wrong */
    return;
  }
  *fixed = true;
  strut_put(to, "(");
  strut_put_number(to, node->position[*word == 'Y']);
  strut_put(to, ")");
}

/* Looks up a parameter of the scene for the evaluation. */
static int look_up(void *context, const char *name, size_t length, strut_quantity *q) {
  const strut_springable *r = context;
  for (size_t i = 0; i < r->parameter_count; i++) {
    const strut_springable_parameter *p = &r->parameters[i];
    if (strlen(p->own) != length || strncmp(p->own, name, length) != 0) continue;
    *q = (strut_quantity){.value = p->value, .bare = true};
    return 1;
  }
  return 0;
}

/*
 * An expression as a scene's, or the number of it where it names nodes' coordinates; NULL where what is
 * wrong was reported. *value may be NULL.
 */
const char *strut_springable_expression(strut_springable *r, const char *text, strut_place place,
                                        double *value) {
  strut_writer own = {.text = NULL};
  strut_expression_error error;
  strut_quantity q;
  bool fixed = false;
  if (strlen(text) > LONGEST_FIELD || !*text) {
    strut_diagnose(r->said, place, *text ? "the expression is too long" : "expected an expression");
    return NULL;
  }
  for (const char *at = text; *at;) {
    size_t length = 0;
    bool in_number = at > text && ((at[-1] >= '0' && at[-1] <= '9') || at[-1] == '.');
    if (is_letter(*at) && !in_number)
      while (is_letter(at[length]) || (at[length] >= '0' && at[length] <= '9')) length++;
    if (length)
      add_word(r, &own, at, length, &fixed);
    else if (at[0] == '*' && at[1] == '*')
      strut_put(&own, "^");
    else if (at[0] == '.' && !(at[1] >= '0' && at[1] <= '9')) /* "1." */
      strut_put(&own, ".0");
    else
      strut_put_part(&own, at, 1);
    at += length ? length : at[0] == '*' && at[1] == '*' ? 2 : 1;
  }
  const strut_scope scope = {.lookup = look_up, .context = r, .no_hints = true};
  bool fine = own.text && strut_expression_evaluate(own.text, &scope, &q, &error);
  const char *kept = fine && !fixed ? strut_import_text(r->scene, "%s", own.text) : "";
  if (own.failed || !own.text) r->scene->out_of_memory = true;
  strut_release(own.text);
  if (!fine) {
    strut_diagnose(r->said, place, "'%.60s' is no expression of the parameters: %.200s", text,
                   error.message);
    return NULL;
  }
  if (value) *value = q.value;
  return fixed ? strut_import_number(r->scene, q.value) : kept;
}

/* ---- sections ---- */

/* A name that neither a unit nor a function of the language has. */
static const char *parameter_name(strut_springable *r, const char *name) {
  const char *own = strut_import_name(r->scene, name);
  bool taken = strut_unit_find(name, strlen(name)) || strut_expression_reserved(name, strlen(name));
  taken = taken || *own == '"'; /* YAML would misread it */
  return taken ? strut_import_text(r->scene, "%s_value", name) : own;
}

static void read_parameter(strut_springable *r) {
  const char *name = strut_springable_text(r, 0);
  bool named = *name && is_letter(*name);
  double value = 0.0;
  for (const char *c = name; *c; c++) named = named && (is_letter(*c) || (*c >= '0' && *c <= '9'));
  if (!named || r->field_count < 2) {
    strut_diagnose(r->said, strut_springable_place(r, 0), "expected a parameter: NAME, VALUE");
    return;
  }
  if (find_parameter(r, name, strlen(name))) {
    strut_diagnose(r->said, strut_springable_place(r, 0), "parameter '%.60s' is given twice", name);
    return;
  }
  if (*strut_springable_text(r, 1) == '\'') {
    strut_note(r->said, strut_springable_place(r, 1), "not imported: a parameter that is a text");
    return;
  }
  const char *text = strut_springable_expression(r, strut_springable_text(r, 1),
                                                 strut_springable_place(r, 1), &value);
  if (!text) return;
  if (*strut_springable_text(r, 2))
    strut_note(r->said, strut_springable_place(r, 2),
               "not imported: a range; give it as an axis of a study");
  if (r->parameter_count % 64 == 0) {
    strut_springable_parameter *more =
        strut_arena_allocate(&r->scene->arena, r->parameter_count + 64, sizeof *more);
    if (!more) r->scene->out_of_memory = true;
    if (!more) return;
    if (r->parameter_count) memcpy(more, r->parameters, r->parameter_count * sizeof *more);
    r->parameters = more;
  }
  const char *own = parameter_name(r, name);
  r->parameters[r->parameter_count++] =
      (strut_springable_parameter){strut_import_text(r->scene, "%s", name), own, value};
}

/* A whole number from 0 on at *at, which moves past it; -1: there is none. */
long strut_springable_index(const char **at) {
  char *end;
  if (**at < '0' || **at > '9') return -1;
  long index = strtol(*at, &end, 10);
  *at = end;
  return index < 1000000000 ? index : -1;
}

static bool add_node(strut_springable *r, strut_springable_point node) {
  if (r->node_count == r->node_room) {
    r->node_room = 2 * r->node_room + 64;
    strut_springable_point *more =
        strut_arena_allocate(&r->scene->arena, r->node_room, sizeof *more);
    if (!more) r->scene->out_of_memory = true;
    if (!more) return false;
    if (r->node_count) memcpy(more, r->nodes, r->node_count * sizeof *more);
    r->nodes = more;
  }
  r->nodes[r->node_count++] = node;
  return true;
}

static void read_node(strut_springable *r) {
  static const char *const held[] = {"", ", fixed: x", ", fixed: y", ", fixed: both"};
  strut_import_scene *s = r->scene;
  const char *at = strut_springable_text(r, 0);
  long index = strut_springable_index(&at);
  const char *x, *y;
  double position[2] = {0.0, 0.0};
  int fixed = 0;
  if (index < 0 || *at || r->field_count != 5) {
    strut_diagnose(r->said, strut_springable_place(r, 0),
                   "expected a node: NUMBER, X, Y, 0 or 1, 0 or 1");
    return;
  }
  if (strut_springable_node(r, index)) {
    strut_diagnose(r->said, strut_springable_place(r, 0), "node %ld is given twice", index);
    return;
  }
  for (size_t i = 3; i < 5; i++) {
    bool one = strcmp(strut_springable_text(r, i), "1") == 0;
    if (!one && strcmp(strut_springable_text(r, i), "0") != 0)
      strut_diagnose(r->said, strut_springable_place(r, i), "expected 0 or 1, found '%.60s'",
                     strut_springable_text(r, i));
    fixed |= one << (i - 3);
  }
  x = strut_springable_expression(r, strut_springable_text(r, 1), strut_springable_place(r, 1),
                                  &position[0]);
  y = strut_springable_expression(r, strut_springable_text(r, 2), strut_springable_place(r, 2),
                                  &position[1]);
  if (!x || !y ||
      !add_node(r, (strut_springable_point){index, {position[0], position[1]}, fixed == 3}))
    return;
  strut_import_node_add(s, r->said, strut_springable_place(r, 0),
                        strut_import_text(s, "n%ld", index),
                        strut_import_text(s, "{position: [%s, %s]%s}", x, y, held[fixed]));
}

/* Marks the nodes of a chain that is written. */
static void use_nodes(strut_springable *r) {
  for (const char *at = strut_springable_text(r, 0);; at++) {
    strut_import_node_use(r->scene,
                          strut_import_text(r->scene, "n%ld", strut_springable_index(&at)));
    if (*at != '-') return;
  }
}

/* "0-2-1" as "n0, n2, n1"; NULL where it was reported. */
static const char *read_chain(strut_springable *r, size_t least, size_t most) {
  const char *at = strut_springable_text(r, 0), *names = "";
  size_t count = 0;
  do {
    long index = strut_springable_index(&at);
    if (index < 0 || (*at && *at != '-') || count == most) {
      strut_diagnose(r->said, strut_springable_place(r, 0),
                     "expected %zu%s numbers of nodes with dashes between", least,
                     most > least ? " or more" : "");
      return NULL;
    }
    if (!strut_springable_node(r, index)) {
      strut_diagnose(r->said, strut_springable_place(r, 0), "there is no node %ld", index);
      return NULL;
    }
    names = strut_import_text(r->scene, "%s%sn%ld", names, count ? ", " : "", index);
    count++;
  } while (*at++ == '-');
  if (count >= least) return names;
  strut_diagnose(r->said, strut_springable_place(r, 0), "expected %zu numbers of nodes, found %zu",
                 least, count);
  return NULL;
}

/* A spring of two nodes, or along a path of several. */
static void read_spring(strut_springable *r, bool path) {
  strut_import_scene *s = r->scene;
  const char *nodes = read_chain(r, 2, path ? MOST_CHAIN : 2), *length = NULL;
  if (*strut_springable_text(r, 2))
    length = strut_springable_expression(r, strut_springable_text(r, 2),
                                         strut_springable_place(r, 2), NULL);
  if (!nodes || (*strut_springable_text(r, 2) && !length)) return;
  bool running = path && strchr(nodes, ',') != strrchr(nodes, ',');
  strut_spring_values v = {.kind = "spring", .rest = "", .law = ""};
  if (length) v.rest = strut_import_text(s, ", rest_length: %s", length);
  size_t before = r->said->count;
  v.stiffness = strut_springable_stiffness(r);
  if (!v.stiffness && !strut_springable_two_pieces(r, running, length, &v)) {
    v.law = strut_springable_curve(r);
    if (!v.law && r->said->count == before) strut_springable_note(r);
    if (!v.law) return;
  }
  use_nodes(r);
  strut_import_line(
      s, &s->section[STRUT_IMPORT_MEMBERS], "  %s%zu: {kind: %s, nodes: [%s]%s%s%s%s}",
      path ? "path" : "s", path ? ++r->paths : ++r->springs, v.kind, nodes,
      v.stiffness ? ", stiffness: " : "", v.stiffness ? v.stiffness : "", v.rest, v.law);
}

static void read_angle(strut_springable *r) {
  static const double pi = 3.14159265358979323846;
  strut_import_scene *s = r->scene;
  size_t before = r->said->count;
  const char *nodes = read_chain(r, 3, 3), *stiffness = strut_springable_stiffness(r), *rest = "";
  const char *law = stiffness ? "" : strut_springable_curve(r);
  double angle = 0.0;
  if (*strut_springable_text(r, 2)) {
    const char *text = strut_springable_expression(r, strut_springable_text(r, 2),
                                                   strut_springable_place(r, 2), &angle);
    if (text && angle > pi)
      text = strut_import_number(s, angle - 2.0 * pi); /* within half a turn */
    rest = text ? strut_import_text(s, ", rest_angle: %s", text) : NULL;
  }
  if (nodes && !law && r->said->count == before) strut_springable_note(r);
  if (!nodes || !law || !rest) return;
  use_nodes(r);
  strut_import_line(s, &s->section[STRUT_IMPORT_HINGES], "  a%zu: {nodes: [%s]%s%s%s%s}",
                    ++r->angles, nodes, stiffness ? ", stiffness: " : "",
                    stiffness ? stiffness : "", rest, law);
}

/* Along x or y, the first node seen from the second; or of the first node from the line of the others. */
/* A fixed node in the middle of two fixed nodes; NULL: one of them is not, or it was reported. */
static const char *add_middle(strut_springable *r, const char *chain) {
  strut_import_scene *s = r->scene;
  const strut_springable_point *end[2];
  strut_springable_index(&chain);
  for (int k = 0; k < 2; k++) {
    chain++;
    end[k] = strut_springable_node(r, strut_springable_index(&chain));
    if (!end[k] || !end[k]->held) return NULL;
  }
  const char *name = strut_import_text(s, "m%zu", ++r->middles), *place[2];
  for (int c = 0; c < 2; c++)
    place[c] = strut_import_number(s, 0.5 * (end[0]->position[c] + end[1]->position[c]));
  strut_import_node_add(
      s, r->said, strut_springable_place(r, 0), name,
      strut_import_text(s, "{position: [%s, %s], fixed: both}", place[0], place[1]));
  strut_import_node_use(s, name);
  return name;
}

/* How a distance is written between "FIRST, SECOND" or "NODE, LINE, LINE"; NULL: it is left out. */
static const char *written_distance(strut_springable *r, section in, const char *nodes) {
  strut_import_scene *s = r->scene;
  const char *second = strchr(nodes, ',') + 2;
  int first = (int)(second - nodes) - 2;
  bool to_middle = in >= X_TO_MIDDLE && in <= Y_FROM_MIDDLE;
  if (in == LINE_DISTANCES)
    return strut_import_text(s, "node: %.*s, line: [%s]", first, nodes, second);
  if (to_middle) {
    const char *middle = add_middle(r, strut_springable_text(r, 0));
    if (!middle)
      strut_note(r->said, strut_springable_place(r, 0),
                 "not imported: a distance from the middle of nodes that move");
    if (!middle) return NULL;
    bool from = in == X_FROM_MIDDLE || in == Y_FROM_MIDDLE;
    const char *point = strut_import_text(s, "%.*s", first, nodes);
    return strut_import_text(s, "nodes: [%s, %s], along: %s", from ? point : middle,
                             from ? middle : point,
                             in == X_TO_MIDDLE || in == X_FROM_MIDDLE ? "x" : "y");
  }
  return strut_import_text(s, "nodes: [%s, %.*s], along: %s", second, first, nodes,
                           in == X_DISTANCES ? "x" : "y");
}

static void read_distance(strut_springable *r, section in) {
  strut_import_scene *s = r->scene;
  size_t count = in == X_DISTANCES || in == Y_DISTANCES ? 2 : 3, before = r->said->count;
  const char *nodes = read_chain(r, count, count), *rest = strut_springable_text(r, 2);
  strut_spring_values v = {.rest = "", .law = ""};
  if (!nodes) return;
  v.stiffness = strut_springable_stiffness(r);
  if (*rest) rest = strut_springable_expression(r, rest, strut_springable_place(r, 2), NULL);
  if (!rest) return;
  if (*rest) v.rest = strut_import_text(s, ", rest_distance: %s", rest);
  if (v.stiffness) {
    v.stiffness = strut_import_text(s, ", stiffness: %s", v.stiffness);
  } else if (!strut_springable_contact(r, &v)) {
    v.law = strut_springable_curve(r);
    if (!v.law && r->said->count == before) strut_springable_note(r);
    if (!v.law) return;
  }
  const char *which = written_distance(r, in, nodes);
  if (!which) return;
  if (in >= X_TO_MIDDLE && in <= Y_FROM_MIDDLE)
    strut_import_node_use(s, strut_import_text(s, "%.*s", (int)strcspn(nodes, ","), nodes));
  else
    use_nodes(r);
  strut_import_line(s, &s->section[STRUT_IMPORT_DISTANCES], "  d%zu: {%s%s%s%s}", ++r->distances,
                    which, v.stiffness ? v.stiffness : "", v.rest, v.law);
}

/* A spring of an area, or a gas in it. */
static void read_area(strut_springable *r) {
  strut_import_scene *s = r->scene;
  size_t before = r->said->count;
  const char *nodes = read_chain(r, 3, MOST_CHAIN), *rest = strut_springable_text(r, 2),
             *law = NULL;
  if (!nodes) return;
  const char *stiffness = strut_springable_stiffness(r),
             *gas = stiffness ? NULL : strut_springable_gas(r, rest);
  if (stiffness)
    law = strut_import_text(s, ", stiffness: %s", stiffness);
  else if (!gas)
    law = strut_springable_curve(r);
  if (!law && !gas && r->said->count == before) strut_springable_note(r);
  if (!law && !gas) return;
  if (!gas && *rest) {
    rest = strut_springable_expression(r, rest, strut_springable_place(r, 2), NULL);
    if (!rest) return;
    law = strut_import_text(s, "%s, rest_area: %s", law, rest);
  }
  use_nodes(r);
  strut_import_line(s, &s->section[STRUT_IMPORT_CELLS], "  area%zu: {nodes: [%s]%s}", ++r->areas,
                    nodes, gas ? gas : law);
}

/* Ends a stage of the loading; the first is written only if it must be. */
static void end_stage(strut_springable *r) {
  strut_import_scene *s = r->scene;
  strut_writer *path = &s->section[STRUT_IMPORT_PATH];
  const char *hold = r->hold ? strut_import_text(s, ", hold: [%s]", r->hold) : "";
  if (r->stage_loads && (r->staged || r->stop)) {
    const char *names = strut_import_text(s, "load%zu", r->loads - r->stage_loads + 1);
    for (size_t i = r->loads - r->stage_loads + 2; i <= r->loads; i++)
      names = strut_import_text(s, "%s, load%zu", names, i);
    if (!path->length) strut_import_line(s, path, "  stages:");
    strut_import_line(s, path,
                      r->stage_loads > 1 ? "    - {load: [%s]%s%s}" : "    - {load: %s%s%s}", names,
                      hold ? hold : "", r->stop ? r->stop : "");
  }
  r->stage_loads = 0;
  r->hold = r->stop = NULL;
  r->blocking = false;
}

/* "then", or "block" and the coordinates that a stage holds; false: the line is a load. */
static bool read_stage(strut_springable *r) {
  strut_import_scene *s = r->scene;
  const char *at = strut_springable_text(r, 0), *axis = strut_springable_text(r, 1);
  if (r->field_count == 1 && strcmp(at, "then") == 0) {
    r->staged = true;
    end_stage(r);
    return true;
  }
  if (r->field_count == 1 && strcmp(at, "block") == 0) {
    r->blocking = true;
    return true;
  }
  if (!r->blocking || r->field_count != 2) return false;
  long index = strut_springable_index(&at);
  bool x = strcmp(axis, "X") == 0;
  if (index < 0 || *at || !strut_springable_node(r, index) || (!x && strcmp(axis, "Y") != 0))
    return false;
  r->hold = strut_import_text(s, "%s%sn%ld.%c", r->hold ? r->hold : "", r->hold ? ", " : "", index,
                              x ? 'x' : 'y');
  return true;
}

static void read_load(strut_springable *r) {
  strut_import_scene *s = r->scene;
  const char *at = strut_springable_text(r, 0), *axis = strut_springable_text(r, 1);
  if (read_stage(r)) return;
  long index = strut_springable_index(&at);
  bool x = strcmp(axis, "X") == 0, y = strcmp(axis, "Y") == 0;
  if (index < 0 || *at || !strut_springable_node(r, index) || (!x && !y) || r->field_count < 3) {
    strut_diagnose(r->said, strut_springable_place(r, 0), "expected a load: NODE, X or Y, FORCE");
    return;
  }
  const char *force = strut_springable_expression(r, strut_springable_text(r, 2),
                                                  strut_springable_place(r, 2), NULL);
  double end;
  if (*strut_springable_text(r, 3) &&
      strut_springable_expression(r, strut_springable_text(r, 3), strut_springable_place(r, 3),
                                  &end))
    r->stop = strut_import_text(s, ", stop: {n%ld.%c: %s}", index, x ? 'x' : 'y',
                                strut_import_number(s, end));
  if (!force) return;
  use_nodes(r);
  r->stage_loads++;
  strut_import_line(s, &s->section[STRUT_IMPORT_LOADS], "  load%zu: {node: n%ld, force: [%s, %s]}",
                    ++r->loads, index, x ? force : "0", y ? force : "0");
}

/* The section that a line begins; NO_SECTION: it is a line within one. */
static section section_of(const char *text) {
  static const struct {
    const char *word;
    section of;
  } words[] = {{"PARAMETERS", PARAMETERS},
               {"NODES", NODES},
               {"SPRINGS", SPRINGS},
               {"LONGITUDINAL SPRINGS", SPRINGS},
               {"LONGITUDINAL FLEXELS", SPRINGS},
               {"ANGULAR SPRINGS", ANGULAR},
               {"ANGULAR FLEXELS", ANGULAR},
               {"PATH SPRINGS", PATHS},
               {"PATH FLEXELS", PATHS},
               {"X DISTANCE SPRINGS", X_DISTANCES},
               {"X DISTANCE FLEXELS", X_DISTANCES},
               {"Y DISTANCE SPRINGS", Y_DISTANCES},
               {"Y DISTANCE FLEXELS", Y_DISTANCES},
               {"POINT2MID X DISTANCE SPRINGS", X_TO_MIDDLE},
               {"POINT2MID X DISTANCE FLEXELS", X_TO_MIDDLE},
               {"POINT2MID Y DISTANCE SPRINGS", Y_TO_MIDDLE},
               {"POINT2MID Y DISTANCE FLEXELS", Y_TO_MIDDLE},
               {"MID2POINT X DISTANCE SPRINGS", X_FROM_MIDDLE},
               {"MID2POINT X DISTANCE FLEXELS", X_FROM_MIDDLE},
               {"MID2POINT Y DISTANCE SPRINGS", Y_FROM_MIDDLE},
               {"MID2POINT Y DISTANCE FLEXELS", Y_FROM_MIDDLE},
               {"DISTANCE SPRINGS", LINE_DISTANCES},
               {"DISTANCE FLEXELS", LINE_DISTANCES},
               {"AREA SPRINGS", AREAS},
               {"AREA FLEXELS", AREAS},
               {"LOADING", LOADING}};
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
    if (strcmp(words[i].word, text) == 0) return words[i].of;
  size_t length = strlen(text);
  bool others = length > 8 && (strcmp(text + length - 8, " SPRINGS") == 0 ||
                               strcmp(text + length - 8, " FLEXELS") == 0);
  return others ? OTHERS : NO_SECTION;
}

static void read_line(strut_springable *r, section *in, const char *line, size_t length) {
  split(r, line, length);
  const char *first = strut_springable_text(r, 0);
  if (!*first && r->field_count == 1) return;
  if (*first == '#') return;
  section begins = r->field_count == 1 ? section_of(first) : NO_SECTION;
  if (begins) {
    *in = begins;
    return;
  }
  switch (*in) {
    case NO_SECTION:
      strut_diagnose(r->said, strut_springable_place(r, 0),
                     "expected a section such as PARAMETERS or NODES");
      break;
    case PARAMETERS: read_parameter(r); break;
    case NODES: read_node(r); break;
    case SPRINGS: read_spring(r, false); break;
    case ANGULAR: read_angle(r); break;
    case PATHS: read_spring(r, true); break;
    case X_DISTANCES:
    case Y_DISTANCES:
    case LINE_DISTANCES:
    case X_TO_MIDDLE:
    case Y_TO_MIDDLE:
    case X_FROM_MIDDLE:
    case Y_FROM_MIDDLE: read_distance(r, *in); break;
    case AREAS: read_area(r); break;
    case LOADING: read_load(r); break;
    case OTHERS:
      strut_note(r->said, strut_springable_place(r, 0),
                 "not imported: an element of a kind that is not known");
      break;
  }
}

strut_status strut_import_springable(strut_import_scene *s) {
  const strut_import_file *file = &s->files[0];
  strut_springable r = {.scene = s, .said = &s->files[0].diagnostics};
  section in = NO_SECTION;
  const char *end = file->text + file->length;
  if (s->unit != 1.0)
    strut_diagnose(
        r.said, strut_place_at(1, 1, 1),
        "expressions of springable are taken in metres: --unit is for the other formats");
  for (const char *line = file->text; line < end && !strut_diagnostics_full(r.said);) {
    const char *stop = memchr(line, '\n', (size_t)(end - line));
    if (!stop) stop = end;
    r.line++;
    read_line(&r, &in, line, (size_t)(stop - line));
    line = stop + 1;
  }
  end_stage(&r);
  for (size_t i = 0; i < r.parameter_count; i++)
    strut_import_line(s, &s->section[STRUT_IMPORT_PARAMETERS], "  %s: %s", r.parameters[i].own,
                      strut_import_number(s, r.parameters[i].value));
  if (!r.node_count && !r.said->count)
    strut_diagnose(r.said, strut_place_at(1, 1, 1), "the file has no section NODES");
  return STRUT_OK;
}
