/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/build_list.h"

#include <math.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/forces/elements.h"
#include "engine/output/buffer.h"
#include "engine/output/file.h"
#include "engine/output/results.h"

static const char *const file_names[] = {"members.csv", "nodes.csv", "drawing.svg", "drawing.dxf",
                                         NULL};
static const char *const kinds[] = {"bar", "spring", "cable"};

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
  strut_csv_number(to, value);
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
    strut_csv_text(&text, "%s", m->name);
    strut_buffer_add(&text, ",%s,", kinds[m->kind]);
    strut_csv_text(&text, "%s", scene->nodes[m->node[0]].name);
    strut_buffer_add(&text, ",");
    strut_csv_text(&text, "%s", over.text ? over.text : "");
    strut_buffer_add(&text, ",");
    strut_csv_text(&text, "%s", scene->nodes[m->node[1]].name);
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
    strut_csv_text(&text, "%s", n->name);
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
                     kinds[scene->members[i].kind]);
    add_millimetres(&text, line.made);
    add_millimetres(&text, line.cut);
    add_millimetres(&text, line.length);
    strut_buffer_add(&text, "%s\n", line.driven ? "  driven" : "");
  }
  strut_buffer_add(&text, "\n  node    holes\n");
  for (size_t i = 0; i < scene->node_count; i++)
    strut_buffer_add(&text, "  %-6s  %5zu\n", scene->nodes[i].name, strut_build_holes(scene, i));
  if (scene->hinge_count || scene->cell_count || scene->collision_count || scene->sliding_count)
    strut_buffer_add(
        &text, "\n  not in this list: %zu hinges, %zu cells, %zu collisions, %zu sliders\n",
        scene->hinge_count, scene->cell_count, scene->collision_count, scene->sliding_count);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&text);
}
