/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Velocity over the parameter: stable motions solid, unstable ones dashed, special points marked. */
#include <math.h>

#include "engine/study/follow/branch_picture.h"
#include "engine/study/follow/follow_study.h"

/* Is the point marked in the figure? Events that change nothing are in the table alone. */
static bool is_marked(const strut_follow_point *p) {
  if (p->kind >= STRUT_FOLLOW_FOLD && p->kind <= STRUT_FOLLOW_TORUS) return true;
  return p->detail && p->changes;
}

/* What is drawn: velocity, or amplitude of what does not travel. */
static double height_of(const strut_follow_branch *b, const strut_follow_point *p) {
  return b->travels ? p->velocity : p->amplitude;
}

/* Appends the line of a branch and its marks. False: no memory. */
static bool add_branch(strut_branch_picture *p, const strut_follow_branch *b, strut_arena *arena) {
  strut_branch_line *line = &p->lines[p->line_count];
  line->data = strut_arena_allocate(arena, b->count, sizeof *line->data);
  line->stable = strut_arena_allocate(arena, b->count, sizeof *line->stable);
  if (!line->data || !line->stable) return false;
  line->look = p->line_count++;
  line->count = b->count;
  for (size_t k = 0; k < b->count; k++) {
    const strut_follow_point *point = &b->points[k];
    line->data[k][0] = point->value;
    line->data[k][1] = height_of(b, point);
    line->stable[k] = point->stable;
    if (!is_marked(point)) continue;
    p->marks[p->mark_count++] = (strut_branch_mark){
        .data = {point->value, height_of(b, point)}, .kind = point->kind, .node = point->node};
  }
  return true;
}

strut_status strut_follow_figure(const strut_plot *plot, const strut_follow_result *r,
                                 strut_error *error) {
  strut_arena arena = {0};
  strut_key_item keys[STRUT_BRANCH_KEYS];
  bool travels = r->count && r->branches[0].branch.travels;
  size_t points = 0;
  for (size_t i = 0; i < r->count; i++) points += r->branches[i].branch.count;
  strut_branch_picture p = {
      .title = r->title,
      .x = {.name = r->name, .unit = r->unit},
      .y = {.name = travels ? "velocity" : "amplitude", .unit = travels ? "m/s" : "m"},
      .lines = strut_arena_allocate(&arena, r->count + 1, sizeof *p.lines),
      .marks = strut_arena_allocate(&arena, points + 1, sizeof *p.marks),
      .keys = keys,
      .key_count = STRUT_BRANCH_KEYS};
  strut_branch_keys(keys);
  bool fine = p.lines && p.marks;
  for (size_t i = 0; i < r->count && fine; i++)
    fine = add_branch(&p, &r->branches[i].branch, &arena);
  strut_status status =
      fine ? strut_branch_draw(plot, &p, error) : strut_no_memory(error, "while drawing");
  strut_arena_free(&arena);
  return status;
}
