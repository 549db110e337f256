/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Points and events are kept with positions and all forces. */
#include <math.h>
#include <string.h>

#include "engine/statics/path/walk.h"

double strut_path_distance(const strut_path_walk *w, const double *a, const double *b) {
  double sum = 0;
  for (int32_t i = 0; i <= w->system.n; i++) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sqrt(sum);
}

/* Memory for one more of `size` bytes at *items. */
static bool grow(strut_path_walk *w, void **items, size_t count, size_t *room, size_t size) {
  if (count < *room) return true;
  size_t more = *room ? 2 * *room : 64;
  void *block = *items ? strut_reallocate(*items, more, size) : strut_allocate(more, size);
  if (!block) {
    w->failed = true;
    return false;
  }
  *items = block, *room = more;
  return true;
}

/* Positions and forces at y; false: out of memory. */
static bool keep_state(strut_path_walk *w, const double *y, strut_path_point *point) {
  strut_path_system *s = &w->system;
  const strut_model *model = s->model;
  size_t length = (size_t)model->length, members = (size_t)model->members.count;
  point->q = strut_arena_allocate(&w->path->arena, length, sizeof(double));
  point->force = strut_arena_allocate(&w->path->arena, members, sizeof(double));
  point->reaction = strut_arena_allocate(&w->path->arena, length, sizeof(double));
  point->contact =
      strut_arena_allocate(&w->path->arena, (size_t)model->contacts.count, sizeof(double));
  if (!point->q || !point->force || !point->reaction || !point->contact) {
    w->failed = true;
    return false;
  }
  strut_path_evaluate(s, y); /* y is of the path: its value was not refused */
  memcpy(point->q, s->q, length * sizeof *s->q);
  for (size_t j = 0; j < members; j++) {
    bool cable = model->scene->members[j].kind == STRUT_CABLE; /* at a kink a rounding may push */
    point->force[j] = cable ? fmax(s->member[j].tension, 0.0) : s->member[j].tension;
  }
  strut_path_reactions(s, point->reaction, point->contact);
  return true;
}

void strut_path_add_point(strut_path_walk *w, int32_t negative) {
  strut_path *p = w->path;
  void *items = p->points;
  strut_path_point point = {
      .factor = strut_path_value(&w->system, w->y), .arc = w->arc, .negative = negative};
  if (!keep_state(w, w->y, &point) ||
      !grow(w, &items, p->point_count, &w->point_room, sizeof *p->points))
    return;
  p->points = items;
  p->points[p->point_count++] = point;
}

void strut_path_add_event(strut_path_walk *w, strut_path_event_kind kind, const double *y,
                          int32_t index, int32_t before, int32_t after, const char *detail) {
  strut_path *p = w->path;
  void *items = p->events;
  strut_path_point state;
  detail = strut_arena_text(&p->arena, detail, strlen(detail));
  if (!detail) w->failed = true;
  if (w->failed || !keep_state(w, y, &state) ||
      !grow(w, &items, p->event_count, &w->event_room, sizeof *p->events))
    return;
  p->events = items;
  strut_path_event event = {.kind = kind,
                            .factor = strut_path_value(&w->system, y),
                            .arc = w->arc + strut_path_distance(w, w->y, y),
                            .index = index,
                            .before = before,
                            .after = after,
                            .detail = detail,
                            .q = state.q,
                            .force = state.force,
                            .reaction = state.reaction,
                            .contact = state.contact};
  size_t at = p->event_count++; /* in the order of the path */
  for (; at > 0 && p->events[at - 1].arc > event.arc; at--) p->events[at] = p->events[at - 1];
  p->events[at] = event;
}
