/* SPDX-License-Identifier: GPL-3.0-or-later */
/* springable's behaviours as stiffnesses, laws and gases of a scene. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "parser/import/springable.h"

/* The stiffness of a linear behaviour, "k", "k=3" or "LINEAR(k=3)"; NULL: it is another, which is said. */
const char *strut_springable_stiffness(strut_springable *r) {
  char text[LONGEST_FIELD + 1];
  const char *given = strut_springable_text(r, 1);
  size_t length = strlen(given);
  if (strncmp(given, "LINEAR(", 7) == 0 && length > 8 && given[length - 1] == ')') {
    given += 7;
    length -= 8;
  }
  if (length > LONGEST_FIELD || !length) {
    strut_diagnose(r->said, strut_springable_place(r, 1), "expected a mechanical behaviour");
    return NULL;
  }
  memcpy(text, given, length);
  text[length] = '\0';
  const char *from = text;
  if (from[0] == 'k' && from[strspn(from + 1, " ") + 1] == '=') from = strchr(from, '=') + 1;
  size_t word = strspn(from, "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789");
  bool function = from[word] == '(' && strchr(from, '='); /* PIECEWISE(k_i=...), CONTACT(f0=...) */
  if (!function && !strchr(from, ';') && !strchr(from, '='))
    return strut_springable_expression(r, from, strut_springable_place(r, 1), NULL);
  return NULL;
}

void strut_springable_note(strut_springable *r) {
  strut_note(r->said, strut_springable_place(r, 1),
             "not imported: an element with the behaviour '%.40s'; see 'law' of members and hinges",
             strut_springable_text(r, 1));
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
static bool read_pieces(strut_springable *r, two_pieces *p) {
  char first[LONGEST_FIELD + 1], second[LONGEST_FIELD + 1], knee[LONGEST_FIELD + 1];
  const char *text = strut_springable_text(r, 1), *list = strstr(text, "k_i=[");
  if (strncmp(text, "PIECEWISE(", 10) != 0 || !list || !strchr(list, ';')) return false;
  if (!find_argument(text, "k_i=[", first) || !find_argument(text, "u_i=[", knee) ||
      !find_argument(strchr(list, ';'), ";", second))
    return false;
  const char *after = strchr(strchr(list, ';') + 1, ']'),
             *third = strchr(strchr(list, ';') + 1, ';');
  if (!after || (third && third < after)) return false; /* three pieces or more */
  p->first = strut_springable_expression(r, first, strut_springable_place(r, 1), &p->values[0]);
  p->second = strut_springable_expression(r, second, strut_springable_place(r, 1), &p->values[1]);
  p->knee = strut_springable_expression(r, knee, strut_springable_place(r, 1), &p->values[2]);
  return p->first && p->second && p->knee;
}

/* ---- curves ---- */

/* Points of a curve from the origin outwards, the first of them (0, 0). */
typedef struct curve {
  size_t count;
  double u[MOST_POINTS + 2], f[MOST_POINTS + 2];
} curve;

/* The numbers behind "KEY=[", separated by semicolons; -1: there are none, or what is wrong was reported. */
static int read_list(strut_springable *r, const char *key, double value[MOST_POINTS]) {
  const char *at = strstr(strut_springable_text(r, 1), key);
  int count = 0;
  if (!at) return -1;
  for (at += strlen(key); count < MOST_POINTS; at++) {
    char number[LONGEST_FIELD + 1];
    size_t length = strcspn(at, ";]");
    if (!at[length]) return -1;
    memcpy(number, at, length);
    number[length] = '\0';
    const char *from = number + strspn(number, " \t");
    if (!strut_springable_expression(r, from, strut_springable_place(r, 1), &value[count++]))
      return -1;
    at += length;
    if (*at == ']') return count;
  }
  return -1;
}

/* Slopes of straight pieces and where they change. */
static bool read_piecewise(strut_springable *r, curve *c) {
  double slope[MOST_POINTS], change[MOST_POINTS];
  int slopes = read_list(r, "k_i=[", slope), changes = read_list(r, "u_i=[", change);
  if (slopes < 1 || changes != slopes - 1) return false;
  for (int i = 0; i < slopes; i++) {
    double to = i < changes ? change[i] : 2.0 * change[changes - 1];
    c->u[i + 1] = to;
    c->f[i + 1] = c->f[i] + slope[i] * (to - c->u[i]);
  }
  c->count = (size_t)slopes + 1;
  return true;
}

/* Corners of a zigzag. */
static bool read_corners(strut_springable *r, curve *c) {
  int count = read_list(r, "u_i=[", c->u + 1);
  c->count = (size_t)count + 1;
  return count >= 1 && read_list(r, "f_i=[", c->f + 1) == count;
}

static void put_point(strut_writer *to, double u, double f) {
  strut_put(to, to->text ? ", [" : "[");
  strut_put_number(to, u);
  strut_put(to, ", ");
  strut_put_number(to, f);
  strut_put(to, "]");
}

/*
 * The law of a BEZIER behaviour, or of BEZIER2 or ZIGZAG2, which may fold back, as a curve: mirrored, or with `mode` on one side
 * only and straight on on the other. NULL: it is another.
 */
static const char *read_curve(strut_springable *r) {
  const char *text = strut_springable_text(r, 1), *mode = strstr(text, "mode=");
  bool bezier = strncmp(text, "BEZIER2(", 8) == 0 || strncmp(text, "BEZIER(", 7) == 0;
  double u[MOST_POINTS + 1] = {0.0}, f[MOST_POINTS + 1] = {0.0}, rounding = 0.0;
  char argument[LONGEST_FIELD + 1];
  if (!bezier && strncmp(text, "ZIGZAG2(", 8) != 0) return NULL;
  int count = read_list(r, "u_i=[", u + 1), side = mode ? (int)strtol(mode + 5, NULL, 10) : 0;
  if (count < 1 || read_list(r, "f_i=[", f + 1) != count) return NULL;
  if (!bezier &&
      (!find_argument(text, "epsilon=", argument) ||
       !strut_springable_expression(r, argument, strut_springable_place(r, 1), &rounding)))
    return NULL;
  strut_writer points = {.text = NULL}, end = {.text = NULL};
  for (int i = 0; i <= count; i++) {
    int k = side < 0 ? count - i : i, sign = side < 0 ? -1 : 1;
    put_point(&points, sign * u[k] + 0.0, sign * f[k] + 0.0);
  }
  if (rounding > 0.0) strut_put(&end, ", rounding: "), strut_put_number(&end, rounding);
  if (!side) strut_put(&end, ", mirrored: yes");
  bool failed = points.failed || end.failed;
  if (failed) r->scene->out_of_memory = true;
  const char *law = failed ? NULL
                           : strut_import_text(r->scene, ", law: {kind: curve, %s: [%s]%s}",
                                               bezier ? "control_points" : "points", points.text,
                                               end.text ? end.text : "");
  strut_release(points.text);
  strut_release(end.text);
  return law;
}

/*
 * The law of a PIECEWISE or ZIGZAG behaviour as a table: odd, or with `mode` on one side only and straight on on the
 * other; of curves, see read_curve. NULL: it is another.
 */
const char *strut_springable_curve(strut_springable *r) {
  const char *text = strut_springable_text(r, 1), *mode = strstr(text, "mode=");
  bool pieces = strncmp(text, "PIECEWISE(", 10) == 0;
  curve c = {.count = 0};
  const char *smooth = read_curve(r);
  if (smooth) return smooth;
  if (!pieces && strncmp(text, "ZIGZAG(", 7) != 0) return NULL;
  if (!(pieces ? read_piecewise(r, &c) : read_corners(r, &c))) return NULL;
  for (size_t i = 1; i < c.count; i++)
    if (!(c.u[i] > c.u[i - 1])) return NULL; /* it folds back */
  int side = mode ? (int)strtol(mode + 5, NULL, 10) : 0;
  size_t below = side > 0 ? 1 : c.count - 1, above = side < 0 ? 1 : c.count - 1;
  strut_writer points = {.text = NULL};
  for (size_t i = below; i > 0; i--) put_point(&points, -c.u[i], -c.f[i]);
  for (size_t i = 0; i <= above; i++) put_point(&points, c.u[i], c.f[i]);
  if (points.failed) r->scene->out_of_memory = true;
  const char *law =
      points.failed
          ? NULL
          : strut_import_text(r->scene, ", law: {kind: table, points: [%s]}", points.text);
  strut_release(points.text);
  strut_note(r->said, strut_springable_place(r, 1),
             "rounded corners of a behaviour become sharp ones of a table");
  return law;
}

/*
 * Two pieces are a cable where the first is as good as none: it is slack below the knee. Along a path
 * they are a bilinear law.
 */
bool strut_springable_two_pieces(strut_springable *r, bool running, const char *length,
                                 strut_spring_values *v) {
  static const double NOTHING = 1e-3; /* of the second stiffness */
  two_pieces p;
  if (!read_pieces(r, &p)) return false;
  bool slack = p.values[0] <= NOTHING * p.values[1];
  bool sided = strstr(strut_springable_text(r, 1), "mode="); /* a table says what it does there */
  if (!running && (!slack || sided)) return false;
  if (slack) v->kind = "cable";
  v->stiffness = slack ? p.second : p.first;
  if (slack && length)
    v->rest = strut_import_text(r->scene, ", rest_length: %s + %s", length, p.knee);
  else if (!slack)
    v->law = strut_import_text(r->scene, ", law: {kind: bilinear, knee: %s, second_stiffness: %s}",
                               p.knee, p.second);
  strut_note(r->said, strut_springable_place(r, 1),
             slack && length ? "a spring that is nearly slack up to a knee becomes a cable"
             : slack
                 ? "a spring that is nearly slack up to a knee becomes a cable, slack below its "
                   "drawn length"
                 : "two pieces become a bilinear law, whose knee is sharp");
  return true;
}

/* CONTACT(f0; uc; delta): the force f0 ((delta - d) / uc)^3 pushes below the distance delta. False: another. */
bool strut_springable_contact(strut_springable *r, strut_spring_values *v) {
  static const char *const keys[] = {"f0=", "uc=", "delta="};
  const char *text = strut_springable_text(r, 1), *value[3];
  char argument[LONGEST_FIELD + 1];
  if (strncmp(text, "CONTACT(", 8) != 0) return false;
  for (int i = 0; i < 3; i++) {
    if (!find_argument(text, keys[i], argument)) return false;
    value[i] = strut_springable_expression(r, argument, strut_springable_place(r, 1), NULL);
    if (!value[i]) return false;
  }
  v->rest = strut_import_text(r->scene, ", rest_distance: %s", value[2]);
  v->law = strut_import_text(r->scene,
                             ", law: {kind: polynomial, coefficients: [0, 0, \"(%s) / (%s)^3\"], "
                             "carries: compression}",
                             value[0], value[1]);
  return true;
}

/* Of the polygon of the line's nodes, positive. */
static double area_of(const strut_springable *r) {
  const char *at = strut_springable_text(r, 0);
  double first[2] = {0.0}, last[2] = {0.0}, twice = 0.0;
  for (size_t k = 0;; k++, at++) {
    const strut_springable_point *node = strut_springable_node(r, strut_springable_index(&at));
    if (!node) return 0.0;
    if (!k) memcpy(first, node->position, sizeof first);
    twice += k ? (last[0] - first[0]) * (node->position[1] - first[1]) -
                     (node->position[0] - first[0]) * (last[1] - first[1])
               : 0.0;
    memcpy(last, node->position, sizeof last);
    if (*at != '-') return 0.5 * fabs(twice);
  }
}

/*
 * ISOTHERMAL(n; R; T0) or ISENTROPIC(...; gamma): a gas at the pressure n R T0 / v0 around it, where v0 is the natural area.
 * NULL: another.
 */
const char *strut_springable_gas(strut_springable *r, const char *rest) {
  static const char *const keys[] = {"n=", "R=", "T0=", "gamma="};
  const char *text = strut_springable_text(r, 1);
  bool isentropic = strncmp(text, "ISENTROPIC(", 11) == 0;
  double value[4] = {0.0}, drawn = area_of(r), natural = drawn;
  char argument[LONGEST_FIELD + 1];
  if (!isentropic && strncmp(text, "ISOTHERMAL(", 11) != 0) return NULL;
  for (int i = 0; i < (isentropic ? 4 : 3); i++)
    if (!find_argument(strchr(text, '(') + 1, keys[i], argument) ||
        !strut_springable_expression(r, argument, strut_springable_place(r, 1), &value[i]))
      return NULL;
  if (*rest && !strut_springable_expression(r, rest, strut_springable_place(r, 2), &natural))
    return NULL;
  if (!(drawn > 0.0 && natural > 0.0)) return NULL;
  double outside = value[0] * value[1] * value[2] / natural;
  double pressure = outside * pow(natural / drawn, isentropic ? value[3] : 1.0);
  const char *exponent = isentropic ? strut_import_text(r->scene, ", exponent: %s",
                                                        strut_import_number(r->scene, value[3]))
                                    : "";
  return strut_import_text(r->scene, ", gas: {kind: %s, pressure: %s, outside: %s%s}",
                           isentropic ? "isentropic" : "isothermal",
                           strut_import_number(r->scene, pressure),
                           strut_import_number(r->scene, outside), exponent);
}
