/* SPDX-License-Identifier: GPL-3.0-or-later */
/* springable: sections of comma-separated lines, with expressions of parameters. Without units: SI. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "parser/expression/expression.h"
#include "parser/import/import_parts.h"
#include "parser/yaml/text.h"

enum { MOST_FIELDS = 8, MOST_CHAIN = 32, LONGEST_FIELD = 400 };

typedef struct springable_parameter {
  const char *name, *own; /* in the file and in the scene */
  double value;
} springable_parameter;

typedef struct springable_node {
  long index;
  double position[2];
} springable_node;

/* One field of a line: its text without blanks at the ends. */
typedef struct field {
  const char *text;
  strut_place place;
} field;

typedef struct springable {
  strut_import_scene *scene;
  strut_diagnostics *said;
  uint32_t line;
  size_t field_count;
  field fields[MOST_FIELDS];
  size_t parameter_count, node_count, node_room;
  springable_parameter *parameters;
  springable_node *nodes;
  size_t springs, angles, paths, distances, loads; /* so far */
  bool later;                                      /* of LOADING: after "then" */
} springable;

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
  LOADING,
  OTHERS /* that a scene has no words for */
} section;

/* ---- lines ---- */

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/* Splits line[0..length) at commas outside of brackets. */
static void split(springable *r, const char *line, size_t length) {
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
    field *f = &r->fields[r->field_count++];
    f->text = strut_arena_text(&r->scene->arena, line + begin, end - begin);
    if (!f->text) r->scene->out_of_memory = true;
    if (!f->text) f->text = "";
    f->place = strut_place_at(r->line, (uint32_t)strut_text_points(line, begin) + 1,
                              (uint32_t)strut_text_points(line + begin, end - begin));
  }
}

/* The i-th field, "" where there is none. */
static const char *text_of(const springable *r, size_t i) {
  return i < r->field_count ? r->fields[i].text : "";
}

static strut_place place_of(const springable *r, size_t i) {
  return i < r->field_count ? r->fields[i].place : strut_place_at(r->line, 1, 1);
}

/* ---- expressions ---- */

static const springable_node *find_node(const springable *r, long index) {
  for (size_t i = 0; i < r->node_count; i++)
    if (r->nodes[i].index == index) return &r->nodes[i];
  return NULL;
}

static const springable_parameter *find_parameter(const springable *r, const char *name,
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
static void add_word(springable *r, strut_writer *to, const char *word, size_t length,
                     bool *fixed) {
  static const char *const words[][2] = {{"PI", "pi"},       {"SIN", "sin"},     {"COS", "cos"},
                                         {"TAN", "tan"},     {"SQRT", "sqrt"},   {"ARCSIN", "asin"},
                                         {"ARCCOS", "acos"}, {"ARCTAN", "atan"}, {"EXP", "exp"},
                                         {"LOG", "log"},     {"ABS", "abs"}};
  const springable_parameter *p = find_parameter(r, word, length);
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
  const springable_node *node = (*word == 'X' || *word == 'Y') && length > 1 && end == word + length
                                    ? find_node(r, index)
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
  const springable *r = context;
  for (size_t i = 0; i < r->parameter_count; i++) {
    const springable_parameter *p = &r->parameters[i];
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
static const char *read_expression(springable *r, const char *text, strut_place place,
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
static const char *parameter_name(springable *r, const char *name) {
  const char *own = strut_import_name(r->scene, name);
  bool taken = strut_unit_find(name, strlen(name)) || strut_expression_reserved(name, strlen(name));
  taken = taken || *own == '"'; /* YAML would misread it */
  return taken ? strut_import_text(r->scene, "%s_value", name) : own;
}

static void read_parameter(springable *r) {
  const char *name = text_of(r, 0);
  bool named = *name && is_letter(*name);
  double value = 0.0;
  for (const char *c = name; *c; c++) named = named && (is_letter(*c) || (*c >= '0' && *c <= '9'));
  if (!named || r->field_count < 2) {
    strut_diagnose(r->said, place_of(r, 0), "expected a parameter: NAME, VALUE");
    return;
  }
  if (find_parameter(r, name, strlen(name))) {
    strut_diagnose(r->said, place_of(r, 0), "parameter '%.60s' is given twice", name);
    return;
  }
  if (*text_of(r, 1) == '\'') {
    strut_note(r->said, place_of(r, 1), "not imported: a parameter that is a text");
    return;
  }
  const char *text = read_expression(r, text_of(r, 1), place_of(r, 1), &value);
  if (!text) return;
  if (*text_of(r, 2))
    strut_note(r->said, place_of(r, 2), "not imported: a range; give it as an axis of a study");
  if (r->parameter_count % 64 == 0) {
    springable_parameter *more =
        strut_arena_allocate(&r->scene->arena, r->parameter_count + 64, sizeof *more);
    if (!more) r->scene->out_of_memory = true;
    if (!more) return;
    if (r->parameter_count) memcpy(more, r->parameters, r->parameter_count * sizeof *more);
    r->parameters = more;
  }
  const char *own = parameter_name(r, name);
  r->parameters[r->parameter_count++] =
      (springable_parameter){strut_import_text(r->scene, "%s", name), own, value};
}

/* A whole number from 0 on at *at, which moves past it; -1: there is none. */
static long read_index(const char **at) {
  char *end;
  if (**at < '0' || **at > '9') return -1;
  long index = strtol(*at, &end, 10);
  *at = end;
  return index < 1000000000 ? index : -1;
}

static bool add_node(springable *r, long index, const double position[2]) {
  if (r->node_count == r->node_room) {
    r->node_room = 2 * r->node_room + 64;
    springable_node *more = strut_arena_allocate(&r->scene->arena, r->node_room, sizeof *more);
    if (!more) r->scene->out_of_memory = true;
    if (!more) return false;
    if (r->node_count) memcpy(more, r->nodes, r->node_count * sizeof *more);
    r->nodes = more;
  }
  r->nodes[r->node_count++] = (springable_node){index, {position[0], position[1]}};
  return true;
}

static void read_node(springable *r) {
  static const char *const held[] = {"", ", fixed: x", ", fixed: y", ", fixed: both"};
  strut_import_scene *s = r->scene;
  const char *at = text_of(r, 0);
  long index = read_index(&at);
  const char *x, *y;
  double position[2] = {0.0, 0.0};
  int fixed = 0;
  if (index < 0 || *at || r->field_count != 5) {
    strut_diagnose(r->said, place_of(r, 0), "expected a node: NUMBER, X, Y, 0 or 1, 0 or 1");
    return;
  }
  if (find_node(r, index)) {
    strut_diagnose(r->said, place_of(r, 0), "node %ld is given twice", index);
    return;
  }
  for (size_t i = 3; i < 5; i++) {
    bool one = strcmp(text_of(r, i), "1") == 0;
    if (!one && strcmp(text_of(r, i), "0") != 0)
      strut_diagnose(r->said, place_of(r, i), "expected 0 or 1, found '%.60s'", text_of(r, i));
    fixed |= one << (i - 3);
  }
  x = read_expression(r, text_of(r, 1), place_of(r, 1), &position[0]);
  y = read_expression(r, text_of(r, 2), place_of(r, 2), &position[1]);
  if (!x || !y || !add_node(r, index, position)) return;
  strut_import_node_add(s, r->said, place_of(r, 0), strut_import_text(s, "n%ld", index),
                        strut_import_text(s, "{position: [%s, %s]%s}", x, y, held[fixed]));
}

/* Marks the nodes of a chain that is written. */
static void use_nodes(springable *r) {
  for (const char *at = text_of(r, 0);; at++) {
    strut_import_node_use(r->scene, strut_import_text(r->scene, "n%ld", read_index(&at)));
    if (*at != '-') return;
  }
}

/* "0-2-1" as "n0, n2, n1"; NULL where it was reported. */
static const char *read_chain(springable *r, size_t least, size_t most) {
  const char *at = text_of(r, 0), *names = "";
  size_t count = 0;
  do {
    long index = read_index(&at);
    if (index < 0 || (*at && *at != '-') || count == most) {
      strut_diagnose(r->said, place_of(r, 0), "expected %zu%s numbers of nodes with dashes between",
                     least, most > least ? " or more" : "");
      return NULL;
    }
    if (!find_node(r, index)) {
      strut_diagnose(r->said, place_of(r, 0), "there is no node %ld", index);
      return NULL;
    }
    names = strut_import_text(r->scene, "%s%sn%ld", names, count ? ", " : "", index);
    count++;
  } while (*at++ == '-');
  if (count >= least) return names;
  strut_diagnose(r->said, place_of(r, 0), "expected %zu numbers of nodes, found %zu", least, count);
  return NULL;
}

/* The stiffness of a linear behaviour, "k", "k=3" or "LINEAR(k=3)"; NULL: it is another, which is said. */
static const char *read_stiffness(springable *r) {
  char text[LONGEST_FIELD + 1];
  const char *given = text_of(r, 1);
  size_t length = strlen(given);
  if (strncmp(given, "LINEAR(", 7) == 0 && length > 8 && given[length - 1] == ')') {
    given += 7;
    length -= 8;
  }
  if (length > LONGEST_FIELD || !length) {
    strut_diagnose(r->said, place_of(r, 1), "expected a mechanical behaviour");
    return NULL;
  }
  memcpy(text, given, length);
  text[length] = '\0';
  const char *from = text;
  if (from[0] == 'k' && from[strspn(from + 1, " ") + 1] == '=') from = strchr(from, '=') + 1;
  size_t word = strspn(from, "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789");
  bool function = from[word] == '(' && strchr(from, '='); /* PIECEWISE(k_i=...), CONTACT(f0=...) */
  if (!function && !strchr(from, ';') && !strchr(from, '='))
    return read_expression(r, from, place_of(r, 1), NULL);
  return NULL;
}

static void note_behaviour(springable *r) {
  strut_note(r->said, place_of(r, 1),
             "not imported: an element with the behaviour '%.40s'; see 'law' of members and hinges",
             text_of(r, 1));
}

/* The expression behind "KEY=" within the behaviour, up to one of `ends`; false: there is none. */
static bool find_argument(const char *text, const char *key, char to[LONGEST_FIELD + 1]) {
  const char *found = strstr(text, key);
  if (found) found += strlen(key) + strspn(found + strlen(key), " \t");
  size_t length = found ? strcspn(found, ";])") : 0;
  if (!found || length > LONGEST_FIELD) return false;
  memcpy(to, found, length);
  to[length] = '\0';
  return length > 0;
}

/* A behaviour of two straight pieces: stiffnesses, and where the second begins. */
typedef struct two_pieces {
  const char *first, *second, *knee;
  double values[3];
} two_pieces;

/* PIECEWISE(k_i=[a; b]; u_i=[u]; us=...); false: it is something else. */
static bool read_pieces(springable *r, two_pieces *p) {
  char first[LONGEST_FIELD + 1], second[LONGEST_FIELD + 1], knee[LONGEST_FIELD + 1];
  const char *text = text_of(r, 1), *list = strstr(text, "k_i=[");
  if (strncmp(text, "PIECEWISE(", 10) != 0 || !list || !strchr(list, ';')) return false;
  if (!find_argument(text, "k_i=[", first) || !find_argument(text, "u_i=[", knee) ||
      !find_argument(strchr(list, ';'), ";", second))
    return false;
  const char *after = strchr(strchr(list, ';') + 1, ']'),
             *third = strchr(strchr(list, ';') + 1, ';');
  if (!after || (third && third < after)) return false; /* three pieces or more */
  p->first = read_expression(r, first, place_of(r, 1), &p->values[0]);
  p->second = read_expression(r, second, place_of(r, 1), &p->values[1]);
  p->knee = read_expression(r, knee, place_of(r, 1), &p->values[2]);
  return p->first && p->second && p->knee;
}

/* What a spring's line says behind its nodes. */
typedef struct spring_values {
  const char *kind, *stiffness, *rest, *law;
} spring_values;

/*
 * Two pieces are a cable where the first is as good as none: it is slack below the knee. On a running cable
 * they are a bilinear law.
 */
static bool read_two_pieces(springable *r, bool running, const char *length, spring_values *v) {
  static const double NOTHING = 1e-3; /* of the second stiffness */
  two_pieces p;
  if (!read_pieces(r, &p)) return false;
  bool slack = p.values[0] <= NOTHING * p.values[1];
  if (!slack && !running) return false;
  v->kind = "cable";
  v->stiffness = slack ? p.second : p.first;
  if (slack && length)
    v->rest = strut_import_text(r->scene, ", rest_length: %s + %s", length, p.knee);
  else if (!slack)
    v->law = strut_import_text(r->scene, ", law: {kind: bilinear, knee: %s, second_stiffness: %s}",
                               p.knee, p.second);
  strut_note(r->said, place_of(r, 1),
             slack && length ? "a spring that is nearly slack up to a knee becomes a cable"
             : slack
                 ? "a spring that is nearly slack up to a knee becomes a cable, slack below its "
                   "drawn length"
                 : "two pieces become a bilinear law, whose knee is sharp");
  return true;
}

/* A spring of two nodes, or along a path of several. */
static void read_spring(springable *r, bool path) {
  strut_import_scene *s = r->scene;
  const char *nodes = read_chain(r, 2, path ? MOST_CHAIN : 2), *length = NULL;
  if (*text_of(r, 2)) length = read_expression(r, text_of(r, 2), place_of(r, 2), NULL);
  if (!nodes || (*text_of(r, 2) && !length)) return;
  bool running = path && strchr(nodes, ',') != strrchr(nodes, ',');
  spring_values v = {.kind = running ? "cable" : "spring", .rest = "", .law = ""};
  if (length) v.rest = strut_import_text(s, ", rest_length: %s", length);
  size_t before = r->said->count;
  v.stiffness = read_stiffness(r);
  if (!v.stiffness && !read_two_pieces(r, running, length, &v)) {
    if (r->said->count == before) note_behaviour(r);
    return;
  }
  if (running)
    strut_note(r->said, place_of(r, 0),
               "a path of several nodes becomes a running cable, which carries no compression");
  use_nodes(r);
  strut_import_line(s, &s->section[STRUT_IMPORT_MEMBERS],
                    "  %s%zu: {kind: %s, nodes: [%s], stiffness: %s%s%s}", path ? "path" : "s",
                    path ? ++r->paths : ++r->springs, v.kind, nodes, v.stiffness, v.rest, v.law);
}

static void read_angle(springable *r) {
  static const double pi = 3.14159265358979323846;
  strut_import_scene *s = r->scene;
  const char *nodes = read_chain(r, 3, 3), *stiffness = read_stiffness(r), *rest = "";
  double angle = 0.0;
  if (*text_of(r, 2)) {
    const char *text = read_expression(r, text_of(r, 2), place_of(r, 2), &angle);
    if (text && angle > pi)
      text = strut_import_number(s, angle - 2.0 * pi); /* within half a turn */
    rest = text ? strut_import_text(s, ", rest_angle: %s", text) : NULL;
  }
  if (nodes && !stiffness && !r->said->count) note_behaviour(r);
  if (!nodes || !stiffness || !rest) return;
  use_nodes(r);
  strut_import_line(s, &s->section[STRUT_IMPORT_HINGES], "  a%zu: {nodes: [%s], stiffness: %s%s}",
                    ++r->angles, nodes, stiffness, rest);
}

/* CONTACT(f0; uc; delta): the force f0 ((delta - d) / uc)^3 pushes below the distance delta. False: another. */
static bool read_contact(springable *r, spring_values *v) {
  static const char *const keys[] = {"f0=", "uc=", "delta="};
  const char *text = text_of(r, 1), *value[3];
  char argument[LONGEST_FIELD + 1];
  if (strncmp(text, "CONTACT(", 8) != 0) return false;
  for (int i = 0; i < 3; i++) {
    if (!find_argument(text, keys[i], argument)) return false;
    value[i] = read_expression(r, argument, place_of(r, 1), NULL);
    if (!value[i]) return false;
  }
  v->rest = strut_import_text(r->scene, ", rest_distance: %s", value[2]);
  v->law = strut_import_text(r->scene,
                             ", law: {kind: polynomial, coefficients: [0, 0, \"(%s) / (%s)^3\"], "
                             "carries: compression}",
                             value[0], value[1]);
  return true;
}

/* Along x or y, the first node seen from the second; or of the first node from the line of the others. */
static void read_distance(springable *r, section in) {
  strut_import_scene *s = r->scene;
  size_t count = in == LINE_DISTANCES ? 3 : 2, before = r->said->count;
  const char *nodes = read_chain(r, count, count), *rest = text_of(r, 2);
  spring_values v = {.rest = "", .law = ""};
  if (!nodes) return;
  v.stiffness = read_stiffness(r);
  if (v.stiffness) {
    v.stiffness = strut_import_text(s, ", stiffness: %s", v.stiffness);
    if (*rest) rest = read_expression(r, rest, place_of(r, 2), NULL);
    if (!rest) return;
    if (*rest) v.rest = strut_import_text(s, ", rest_distance: %s", rest);
  } else if (!read_contact(r, &v)) {
    if (r->said->count == before) note_behaviour(r);
    return;
  }
  use_nodes(r);
  const char *second = strchr(nodes, ',') + 2;
  int first = (int)(second - nodes) - 2;
  const char *which = in == LINE_DISTANCES
                          ? strut_import_text(s, "node: %.*s, line: [%s]", first, nodes, second)
                          : strut_import_text(s, "nodes: [%s, %.*s], along: %s", second, first,
                                              nodes, in == X_DISTANCES ? "x" : "y");
  strut_import_line(s, &s->section[STRUT_IMPORT_DISTANCES], "  d%zu: {%s%s%s%s}", ++r->distances,
                    which, v.stiffness ? v.stiffness : "", v.rest, v.law);
}

static void read_load(springable *r) {
  strut_import_scene *s = r->scene;
  const char *at = text_of(r, 0), *axis = text_of(r, 1);
  if (r->field_count == 1 && strcmp(at, "then") == 0) {
    r->later = true;
    strut_note(r->said, place_of(r, 0), "not imported: the later steps of the loading");
    return;
  }
  if (r->later) return;
  long index = read_index(&at);
  bool x = strcmp(axis, "X") == 0, y = strcmp(axis, "Y") == 0;
  if (index < 0 || *at || !find_node(r, index) || (!x && !y) || r->field_count < 3) {
    strut_diagnose(r->said, place_of(r, 0), "expected a load: NODE, X or Y, FORCE");
    return;
  }
  const char *force = read_expression(r, text_of(r, 2), place_of(r, 2), NULL);
  double end;
  if (*text_of(r, 3) && read_expression(r, text_of(r, 3), place_of(r, 3), &end))
    strut_note(
        r->said, place_of(r, 3),
        "not imported: the displacement at which the loading ends; give it to strut path, as "
        "--stop n%ld.%c=%.10g",
        index, x ? 'x' : 'y', end);
  if (!force) return;
  use_nodes(r);
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
               {"DISTANCE SPRINGS", LINE_DISTANCES},
               {"DISTANCE FLEXELS", LINE_DISTANCES},
               {"LOADING", LOADING}};
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
    if (strcmp(words[i].word, text) == 0) return words[i].of;
  size_t length = strlen(text);
  bool others = length > 8 && (strcmp(text + length - 8, " SPRINGS") == 0 ||
                               strcmp(text + length - 8, " FLEXELS") == 0);
  return others ? OTHERS : NO_SECTION;
}

static void read_line(springable *r, section *in, const char *line, size_t length) {
  split(r, line, length);
  const char *first = text_of(r, 0);
  if (!*first && r->field_count == 1) return;
  if (*first == '#') return;
  section begins = r->field_count == 1 ? section_of(first) : NO_SECTION;
  if (begins) {
    *in = begins;
    return;
  }
  switch (*in) {
    case NO_SECTION:
      strut_diagnose(r->said, place_of(r, 0), "expected a section such as PARAMETERS or NODES");
      break;
    case PARAMETERS: read_parameter(r); break;
    case NODES: read_node(r); break;
    case SPRINGS: read_spring(r, false); break;
    case ANGULAR: read_angle(r); break;
    case PATHS: read_spring(r, true); break;
    case X_DISTANCES:
    case Y_DISTANCES:
    case LINE_DISTANCES: read_distance(r, *in); break;
    case LOADING: read_load(r); break;
    case OTHERS:
      strut_note(r->said, place_of(r, 0), "not imported: an element on an area or a midpoint");
      break;
  }
}

strut_status strut_import_springable(strut_import_scene *s) {
  const strut_import_file *file = &s->files[0];
  springable r = {.scene = s, .said = &s->files[0].diagnostics};
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
  for (size_t i = 0; i < r.parameter_count; i++)
    strut_import_line(s, &s->section[STRUT_IMPORT_PARAMETERS], "  %s: %s", r.parameters[i].own,
                      strut_import_number(s, r.parameters[i].value));
  if (!r.node_count && !r.said->count)
    strut_diagnose(r.said, strut_place_at(1, 1, 1), "the file has no section NODES");
  return STRUT_OK;
}
