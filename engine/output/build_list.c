/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists and drawings to build a structure by. */
#include <math.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/forces/elements.h"
#include "engine/output/buffer.h"
#include "engine/output/exports.h"
#include "engine/output/file.h"
#include "engine/output/results.h"

static const char *const file_names[] = {"members.csv", "nodes.csv", "drawing.svg", "drawing.dxf",
                                         NULL};

static double start_length(const strut_scene *scene, const strut_member *m) {
  double length = 0.0;
  for (size_t k = 0; k <= m->guide_count; k++) {
    const strut_node *from = &scene->nodes[strut_member_node(m, k)];
    const strut_node *to = &scene->nodes[strut_member_node(m, k + 1)];
    length += hypot(to->start[0] - from->start[0], to->start[1] - from->start[1]);
  }
  return length;
}

strut_build_member strut_build_member_of(const strut_build *b, size_t i) {
  const strut_scene *scene = b->model->scene;
  const strut_member *m = &scene->members[i];
  bool rigid = scene->bar_model == STRUT_BARS_RIGID && m->kind == STRUT_BAR;
  strut_build_member line = {.cut = (double)NAN, .force = (double)NAN};
  line.length = strut_member_path_length(b->model, (int32_t)i, b->q);
  line.made = rigid ? start_length(scene, m) : b->model->members.rest[i];
  if (!rigid)
    line.force = strut_member_elastic_tension(b->model, b->model->members.rest, (int32_t)i, b->q);
  if (m->kind == STRUT_CABLE) line.cut = line.made + 2.0 * b->allowance;
  for (size_t k = 0; k < scene->actuator_count; k++)
    line.driven =
        line.driven || (scene->actuators[k].member == (int32_t)i && !scene->actuators[k].force);
  return line;
}

size_t strut_build_holes(const strut_scene *scene, size_t node) {
  size_t count = 0;
  for (size_t i = 0; i < scene->member_count; i++)
    for (size_t k = 0; k < scene->members[i].guide_count + 2; k++)
      count += strut_member_node(&scene->members[i], k) == (int32_t)node;
  return count;
}

/* ---- tables ---- */

/* A number in the next cell; empty where there is none. */
static void add_number(strut_buffer *to, double value) {
  strut_buffer_add(to, ",");
  strut_csv_add_number(to, value);
}

static char *write_members(const strut_build *b) {
  const strut_scene *scene = b->model->scene;
  strut_buffer text = {0};
  strut_buffer_add(&text,
                   "member,kind,from,over,to,made length [m],cut length [m],"
                   "length in shape [m],force in shape [N],driven\n");
  for (size_t i = 0; i < scene->member_count; i++) {
    const strut_member *m = &scene->members[i];
    strut_build_member line = strut_build_member_of(b, i);
    strut_buffer over = {0};
    for (size_t k = 0; k < m->guide_count; k++)
      strut_buffer_add(&over, "%s%s", k ? ";" : "", scene->nodes[m->guides[k]].name);
    strut_csv_add_text(&text, "%s", m->name);
    strut_buffer_add(&text, ",%s,", strut_member_kind_name(m->kind));
    strut_csv_add_text(&text, "%s", scene->nodes[m->node[0]].name);
    strut_buffer_add(&text, ",");
    strut_csv_add_text(&text, "%s", over.text ? over.text : "");
    strut_buffer_add(&text, ",");
    strut_csv_add_text(&text, "%s", scene->nodes[m->node[1]].name);
    add_number(&text, line.made);
    add_number(&text, line.cut);
    add_number(&text, line.length);
    add_number(&text, line.force);
    strut_buffer_add(&text, ",%s\n", line.driven ? "yes" : "no");
    strut_release(strut_buffer_take(&over));
  }
  return strut_buffer_take(&text);
}

/* How many ends or passages of members of a kind a node has. */
static size_t count_kind(const strut_scene *scene, size_t node, strut_member_kind kind) {
  size_t count = 0;
  for (size_t i = 0; i < scene->member_count; i++)
    for (size_t k = 0; k < scene->members[i].guide_count + 2; k++)
      count += scene->members[i].kind == kind &&
               strut_member_node(&scene->members[i], k) == (int32_t)node;
  return count;
}

static char *write_nodes(const strut_build *b) {
  static const char *const held[] = {"no", "x", "y", "both"};
  const strut_scene *scene = b->model->scene;
  strut_buffer text = {0};
  strut_buffer_add(&text, "node,x [m],y [m],fixed,holes,bars,springs,cables\n");
  for (size_t i = 0; i < scene->node_count; i++) {
    const strut_node *n = &scene->nodes[i];
    strut_csv_add_text(&text, "%s", n->name);
    add_number(&text, b->q[2 * i]);
    add_number(&text, b->q[2 * i + 1]);
    strut_buffer_add(&text, ",%s,%zu,%zu,%zu,%zu\n", held[n->fixed[0] + 2 * n->fixed[1]],
                     strut_build_holes(scene, i), count_kind(scene, i, STRUT_BAR),
                     count_kind(scene, i, STRUT_SPRING), count_kind(scene, i, STRUT_CABLE));
  }
  return strut_buffer_take(&text);
}

/* ---- the whole ---- */

static strut_status check(const strut_build *b, strut_error *error) {
  const strut_scene *scene = b->model->scene;
  if (scene->member_count == 0)
    return strut_fail(error, STRUT_BAD_SCENE, "the scene has no members to build");
  for (size_t i = 0; i < scene->member_count; i++) {
    strut_build_member line = strut_build_member_of(b, i);
    if (line.made > 0.0) continue;
    return strut_fail(
        error, STRUT_BAD_SCENE,
        "member '%s' cannot be made: its rest length is %g m; give it a stiffness and "
        "a pretension that leave some length",
        scene->members[i].name, line.made);
  }
  return STRUT_OK;
}

strut_status strut_build_write(const char *directory, const strut_build *b, strut_error *error) {
  static char *(*const writers[])(const strut_build *) = {write_members, write_nodes,
                                                          strut_build_svg, strut_build_dxf};
  strut_results results = {0};
  strut_status status = check(b, error);
  if (!status) status = strut_results_begin_named(&results, directory, file_names, error);
  if (status) return status;
  strut_c_locale locale = strut_c_locale_enter();
  for (int i = 0; file_names[i] && !status; i++)
    status = strut_file_write_block(results.stage, file_names[i], writers[i](b), error);
  strut_c_locale_leave(locale);
  if (!status) return strut_results_commit(&results, error);
  strut_results_abandon(&results);
  return status;
}

static void add_millimetres(strut_buffer *text, double metres) {
  if (isnan(metres))
    strut_buffer_add(text, "  %10s", "");
  else
    strut_buffer_add(text, "  %7.2f mm", 1000.0 * metres);
}

char *strut_build_table(const strut_build *b) {
  const strut_scene *scene = b->model->scene;
  strut_buffer text = {0};
  int width = 6;
  strut_c_locale locale = strut_c_locale_enter();
  for (size_t i = 0; i < scene->member_count; i++)
    if ((int)strlen(scene->members[i].name) > width && strlen(scene->members[i].name) < 30)
      width = (int)strlen(scene->members[i].name);
  strut_buffer_add(&text, "  %-*s  kind    %10s  %10s  %10s\n", width, "member", "made", "cut",
                   "in shape");
  for (size_t i = 0; i < scene->member_count; i++) {
    strut_build_member line = strut_build_member_of(b, i);
    strut_buffer_add(&text, "  %-*s  %-6s", width, scene->members[i].name,
                     strut_member_kind_name(scene->members[i].kind));
    add_millimetres(&text, line.made);
    add_millimetres(&text, line.cut);
    add_millimetres(&text, line.length);
    strut_buffer_add(&text, "%s\n", line.driven ? "  driven" : "");
  }
  strut_buffer_add(&text, "\n  node    holes\n");
  for (size_t i = 0; i < scene->node_count; i++)
    strut_buffer_add(&text, "  %-6s  %5zu\n", scene->nodes[i].name, strut_build_holes(scene, i));
  if (scene->hinge_count || scene->cell_count || scene->collision_count || scene->distance_count ||
      scene->sliding_count)
    strut_buffer_add(
        &text,
        "\n  not in this list: %zu hinges, %zu cells, %zu collisions, %zu distances, %zu sliders\n",
        scene->hinge_count, scene->cell_count, scene->collision_count, scene->distance_count,
        scene->sliding_count);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&text);
}

/* The build list as drawings in millimetres: SVG to print, DXF for machines. */

/* Sizes on the paper [mm]. */
static const double MARGIN = 15.0, HOLE = 1.0, RULER = 100.0, SMALLEST = 1.2, LARGEST = 4.0;

/* The drawing's extent and the height of its letters [mm]. */
typedef struct sheet {
  const strut_build *build;
  const strut_scene *scene;
  double left, bottom, width, height, letters;
} sheet;

static double x_of(const sheet *s, int32_t node) { return 1000.0 * s->build->q[2 * node]; }
static double y_of(const sheet *s, int32_t node) { return 1000.0 * s->build->q[2 * node + 1]; }

static sheet make_sheet(const strut_build *build) {
  sheet s = {.build = build, .scene = build->model->scene};
  double right = -HUGE_VAL, top = -HUGE_VAL, shortest = HUGE_VAL;
  s.left = s.bottom = HUGE_VAL;
  for (size_t i = 0; i < s.scene->node_count; i++) {
    s.left = fmin(s.left, x_of(&s, (int32_t)i));
    right = fmax(right, x_of(&s, (int32_t)i));
    s.bottom = fmin(s.bottom, y_of(&s, (int32_t)i));
    top = fmax(top, y_of(&s, (int32_t)i));
  }
  for (size_t i = 0; i < s.scene->member_count; i++)
    shortest = fmin(shortest, 1000.0 * strut_build_member_of(build, i).length);
  s.letters = fmin(LARGEST, fmax(SMALLEST, shortest / 15.0));
  s.left -= MARGIN;
  s.bottom -= MARGIN + 3.0 * s.letters; /* of the ruler */
  s.width = fmax(right + MARGIN - s.left, RULER + 2.0 * MARGIN);
  s.height = top + MARGIN - s.bottom;
  return s;
}

/* "name 123.45", with the length that is made or cut [mm]. */
static void add_label(strut_buffer *to, const sheet *s, size_t member,
                      void (*add)(strut_buffer *, const char *)) {
  strut_build_member line = strut_build_member_of(s->build, member);
  add(to, s->scene->members[member].name);
  strut_buffer_add(to, "  %.2f", 1000.0 * (isnan(line.cut) ? line.made : line.cut));
}

/* The middle of a member's first stretch, and its angle, read from below [degrees]. */
static void find_middle(const sheet *s, size_t member, double at[2], double *angle) {
  const strut_member *m = &s->scene->members[member];
  int32_t from = strut_member_node(m, 0), to = strut_member_node(m, 1);
  double dx = x_of(s, to) - x_of(s, from), dy = y_of(s, to) - y_of(s, from);
  if (dx < 0.0 || (dx == 0.0 && dy < 0.0)) {
    dx = -dx;
    dy = -dy;
  }
  double length = hypot(dx, dy), lift = length > 0.0 ? 0.4 * s->letters / length : 0.0;
  at[0] = 0.5 * (x_of(s, from) + x_of(s, to)) - lift * dy;
  at[1] = 0.5 * (y_of(s, from) + y_of(s, to)) + lift * dx;
  *angle = dy == 0.0 ? 0.0 : atan2(dy, dx) * 57.295779513082321;
}

/* ---- SVG ---- */

static void add_xml(strut_buffer *to, const char *text) {
  for (; *text; text++) {
    const char *escape = *text == '&'   ? "&amp;"
                         : *text == '<' ? "&lt;"
                         : *text == '>' ? "&gt;"
                                        : NULL;
    if (escape)
      strut_buffer_add(to, "%s", escape);
    else
      strut_buffer_add(to, "%c", *text);
  }
}

/* y runs down in SVG. */
static double down(const sheet *s, double y) { return s->bottom + s->height - y; }

static void add_svg_member(strut_buffer *to, const sheet *s, size_t i) {
  static const char *const strokes[] = {"stroke-width=\"0.7\"",
                                        "stroke-width=\"0.35\" stroke-dasharray=\"2 1\"",
                                        "stroke-width=\"0.25\""};
  const strut_member *m = &s->scene->members[i];
  double at[2], angle;
  strut_buffer_add(to, "<polyline class=\"%s\" fill=\"none\" stroke=\"black\" %s points=\"",
                   strut_member_kind_name(m->kind), strokes[m->kind]);
  for (size_t k = 0; k < m->guide_count + 2; k++) {
    int32_t node = strut_member_node(m, k);
    strut_buffer_add(to, "%s%.6f,%.6f", k ? " " : "", x_of(s, node) - s->left,
                     down(s, y_of(s, node)));
  }
  strut_buffer_add(to, "\"><title>");
  add_xml(to, m->name);
  find_middle(s, i, at, &angle);
  strut_buffer_add(to,
                   "</title></polyline>\n<text font-size=\"%.3f\" text-anchor=\"middle\" "
                   "transform=\"translate(%.6f %.6f) rotate(%.4f)\">",
                   s->letters, at[0] - s->left, down(s, at[1]), angle == 0.0 ? 0.0 : -angle);
  add_label(to, s, i, add_xml);
  strut_buffer_add(to, "</text>\n");
}

char *strut_build_svg(const strut_build *build) {
  sheet s = make_sheet(build);
  strut_buffer text = {0};
  double foot = s.height - MARGIN / 2.0;
  strut_buffer_add(&text,
                   "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                   "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.6fmm\" height=\"%.6fmm\" "
                   "viewBox=\"0 0 %.6f %.6f\" font-family=\"sans-serif\">\n<title>",
                   s.width, s.height, s.width, s.height);
  add_xml(&text, *s.scene->name ? s.scene->name : "structure");
  strut_buffer_add(&text, ", true scale; lengths in mm, without force; cables as cut</title>\n");
  for (size_t i = 0; i < s.scene->member_count; i++) add_svg_member(&text, &s, i);
  for (size_t i = 0; i < s.scene->node_count; i++) {
    double x = x_of(&s, (int32_t)i) - s.left, y = down(&s, y_of(&s, (int32_t)i));
    strut_buffer_add(&text,
                     "<circle cx=\"%.6f\" cy=\"%.6f\" r=\"%.2f\" fill=\"white\" stroke=\"black\" "
                     "stroke-width=\"0.25\"/>\n<text font-size=\"%.3f\" font-weight=\"bold\" "
                     "x=\"%.6f\" y=\"%.6f\">",
                     x, y, HOLE, s.letters, x + 1.5 * HOLE, y - 1.5 * HOLE);
    add_xml(&text, s.scene->nodes[i].name);
    strut_buffer_add(&text, "</text>\n");
  }
  strut_buffer_add(&text,
                   "<line class=\"ruler\" x1=\"%.6f\" y1=\"%.6f\" x2=\"%.6f\" y2=\"%.6f\" "
                   "stroke=\"black\" stroke-width=\"0.35\"/>\n<text font-size=\"%.3f\" x=\"%.6f\" "
                   "y=\"%.6f\">this line is 100 mm</text>\n</svg>\n",
                   MARGIN, foot, MARGIN + RULER, foot, s.letters, MARGIN, foot - 1.0);
  return strut_buffer_take(&text);
}

/* ---- DXF ---- */

/* DXF of release 12 is ASCII: other characters are \U+XXXX, those beyond U+FFFF a question mark. */
static void add_ascii(strut_buffer *to, const char *text) {
  const unsigned char *at = (const unsigned char *)text;
  while (*at) {
    unsigned code = *at++;
    int more = code >= 0xF0 ? 3 : code >= 0xE0 ? 2 : code >= 0xC0 ? 1 : 0;
    if (more) code &= 0x3Fu >> more;
    for (; more > 0 && *at; more--) code = code << 6 | (*at++ & 0x3Fu);
    if (code < 0x80)
      strut_buffer_add(to, "%c", (int)code);
    else if (code < 0x10000)
      strut_buffer_add(to, "\\U+%04X", code);
    else
      strut_buffer_add(to, "?");
  }
}

static void add_dxf_text(strut_buffer *to, const char *layer, double x, double y, double height,
                         double angle) {
  strut_buffer_add(to, "0\nTEXT\n8\n%s\n10\n%.6f\n20\n%.6f\n30\n0\n40\n%.3f\n50\n%.4f\n1\n", layer,
                   x, y, height, angle);
}

static void add_dxf_line(strut_buffer *to, const char *layer, double x1, double y1, double x2,
                         double y2) {
  strut_buffer_add(to, "0\nLINE\n8\n%s\n10\n%.6f\n20\n%.6f\n30\n0\n11\n%.6f\n21\n%.6f\n31\n0\n",
                   layer, x1, y1, x2, y2);
}

static void add_dxf_member(strut_buffer *to, const sheet *s, size_t i) {
  static const char *const layers[] = {"BARS", "SPRINGS", "CABLES"};
  const strut_member *m = &s->scene->members[i];
  double at[2], angle;
  for (size_t k = 0; k <= m->guide_count; k++) {
    int32_t from = strut_member_node(m, k), next = strut_member_node(m, k + 1);
    add_dxf_line(to, layers[m->kind], x_of(s, from), y_of(s, from), x_of(s, next), y_of(s, next));
  }
  find_middle(s, i, at, &angle);
  add_dxf_text(to, "LABELS", at[0], at[1], s->letters, angle);
  add_label(to, s, i, add_ascii);
  strut_buffer_add(to, "\n");
}

char *strut_build_dxf(const strut_build *build) {
  sheet s = make_sheet(build);
  strut_buffer text = {0};
  strut_buffer_add(&text,
                   "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n4\n"
                   "0\nENDSEC\n0\nSECTION\n2\nENTITIES\n");
  for (size_t i = 0; i < s.scene->member_count; i++) add_dxf_member(&text, &s, i);
  for (size_t i = 0; i < s.scene->node_count; i++) {
    double x = x_of(&s, (int32_t)i), y = y_of(&s, (int32_t)i);
    strut_buffer_add(&text, "0\nCIRCLE\n8\nHOLES\n10\n%.6f\n20\n%.6f\n30\n0\n40\n%.3f\n", x, y,
                     HOLE);
    add_dxf_text(&text, "LABELS", x + 1.5 * HOLE, y + 1.5 * HOLE, s.letters, 0.0);
    add_ascii(&text, s.scene->nodes[i].name);
    strut_buffer_add(&text, "\n");
  }
  double foot = s.bottom + MARGIN / 2.0, begin = s.left + MARGIN;
  add_dxf_line(&text, "RULER", begin, foot, begin + RULER, foot);
  add_dxf_text(&text, "RULER", begin, foot + 1.0, s.letters, 0.0);
  strut_buffer_add(&text, "this line is 100 mm\n0\nENDSEC\n0\nEOF\n");
  return strut_buffer_take(&text);
}
