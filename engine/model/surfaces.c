/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/surfaces.h"

#include <math.h>

#include "engine/base/vec.h"
#include "engine/model/model.h"
#include "engine/model/surface_search.h"
#include "engine/scene/profile.h"

/* Unit vectors of a line in direction (x, y): the solid is to the right. */
static strut_contact_axes axes_along(double x, double y) {
  return (strut_contact_axes){{x, y}, {-y, x}};
}

static void find_on_facet(const strut_surface *s, const double p[2], int32_t k,
                          strut_contact_pose *pose) {
  *pose = (strut_contact_pose){
      .axes = s->facet[k].axes, .gap = strut_facet_across(&s->facet[k], p), .facet = k};
}

/* From a point at distance `gap` outwards of `foot`; where they coincide the facet's own axes. */
static void find_from_foot(const double foot[2], const double p[2], double gap, double turn,
                           strut_contact_pose *pose) {
  double x = (p[0] - foot[0]) / gap, y = (p[1] - foot[1]) / gap;
  pose->axes = (strut_contact_axes){{turn * y, -turn * x}, {turn * x, turn * y}};
}

/* Outside a convex piece: its nearest segment or corner. */
static void find_outside(const strut_surface *s, const double p[2], strut_contact_pose *pose) {
  strut_facet_foot foot;
  int32_t k = strut_surface_nearest(s, p, &foot);
  if (k < 0) return;
  *pose = (strut_contact_pose){.axes = s->facet[k].axes, .gap = foot.distance, .facet = k};
  if (!foot.held || !(foot.distance > 0.0)) return;
  find_from_foot(foot.at, p, foot.distance, 1.0, pose);
  pose->curvature = 1.0 / foot.distance;
}

static void find_on_piece(const strut_surface *s, const double p[2], strut_contact_pose *pose) {
  int32_t nearest;
  double gap = strut_surface_outermost(s, p, -1, &nearest);
  const strut_facet *f = &s->facet[nearest];
  double at = strut_facet_along(f, p);
  bool beyond =
      (nearest == 0 && at < -s->before) || (nearest + 1 == s->facets && at > f->length + s->beyond);
  if (gap <= 0.0 && !beyond)
    find_on_facet(s, p, nearest, pose);
  else
    find_outside(s, p, pose);
}

static void find_on_circle(const strut_surface *s, const double p[2], strut_contact_pose *pose) {
  double distance = strut_distance(s->centre, p), turn = s->inside ? -1.0 : 1.0;
  *pose = (strut_contact_pose){.gap = turn * (distance - s->radius), .axes = axes_along(1.0, 0.0)};
  if (!(distance > 0.0)) return;
  find_from_foot(s->centre, p, distance, turn, pose);
  pose->curvature = turn / distance;
}

void strut_surface_find(const strut_surface *s, const double point[2], int32_t facet,
                        strut_contact_pose *pose) {
  if (!s->facets)
    find_on_circle(s, point, pose);
  else if (facet >= 0 || (s->facets == 1 && s->before == HUGE_VAL && s->beyond == HUGE_VAL))
    find_on_facet(s, point, facet < 0 ? 0 : facet, pose);
  else
    find_on_piece(s, point, pose);
}

double strut_surface_margin(const strut_surface *s, const double point[2], int32_t facet,
                            int32_t *nearest) {
  double other = strut_surface_outermost(s, point, facet, nearest);
  if (other == -HUGE_VAL) *nearest = facet;
  return strut_facet_across(&s->facet[facet], point) - other;
}

/* ---- compilation ---- */

/* The piece between points first and last. */
static bool compile_piece(strut_model *model, const strut_profile_index *index, size_t first,
                          size_t last, strut_surface *s) {
  const strut_ground *g = index->ground;
  strut_facet *facet = strut_arena_allocate(&model->arena, last - first, sizeof *facet);
  if (!facet) return false;
  for (size_t k = first; k < last; k++) {
    strut_vec2 d = strut_vec2_between(g->points[k], g->points[k + 1]);
    double length = strut_vec2_length(d);
    facet[k - first] = (strut_facet){.point = {g->points[k][0], g->points[k][1]},
                                     .axes = axes_along(d.x / length, d.y / length),
                                     .length = length};
  }
  s->facet = facet, s->facets = (int32_t)(last - first);
  s->before = strut_profile_reach(index, first, false);
  s->beyond = strut_profile_reach(index, last, true);
  return strut_surface_bound_facets(&model->arena, s);
}

static bool compile_profile(strut_model *model, const strut_ground *g, strut_surface *pieces,
                            size_t count) {
  strut_arena scratch = {0};
  strut_profile_index index;
  bool fine = strut_profile_index_create(&scratch, g, &index);
  for (size_t k = 0, first = 0, last; k < count && fine; k++, first = last) {
    last = strut_profile_piece_end(g, first);
    fine = compile_piece(model, &index, first, last, &pieces[k]);
  }
  strut_arena_free(&scratch);
  return fine && strut_surface_bound_pieces(&model->arena, pieces, count);
}

static bool compile_line(strut_model *model, const strut_ground *g, strut_surface *s) {
  strut_facet *facet = strut_arena_allocate(&model->arena, 1, sizeof *facet);
  double x = cos(g->slope), y = sin(g->slope);
  if (!facet) return false;
  if (fabs(x) < 2e-16) x = 0.0, y = y < 0.0 ? -1.0 : 1.0; /* upright, or upside down, exactly */
  if (fabs(y) < 2e-16) y = 0.0, x = x < 0.0 ? -1.0 : 1.0;
  *facet = (strut_facet){.axes = axes_along(x, y), .length = HUGE_VAL};
  facet->point[0] = g->placed ? g->through[0] : 0.0;
  facet->point[1] = g->placed ? g->through[1] : g->height;
  s->facet = facet, s->facets = 1;
  s->before = s->beyond = HUGE_VAL;
  return true;
}

static bool compile_ground(strut_model *model, size_t ground, strut_surface *s, size_t pieces) {
  const strut_ground *g = &model->scene->grounds[ground];
  for (size_t k = 0; k < pieces; k++)
    s[k] = (strut_surface){.ground = (int32_t)ground,
                           .piece = (int32_t)k,
                           .pieces = (int32_t)pieces,
                           .belt_speed = g->belt_speed,
                           .moves = g->moves[0] || g->moves[1]};
  if (s->moves) model->contacts.moves = true;
  switch (g->shape) {
    case STRUT_GROUND_LINE: return compile_line(model, g, s);
    case STRUT_GROUND_PROFILE: return compile_profile(model, g, s, pieces);
    case STRUT_GROUND_CIRCLE: break;
  }
  s->centre[0] = g->centre[0], s->centre[1] = g->centre[1];
  s->radius = g->radius, s->inside = g->inside;
  return true;
}

/* Lines along one direction make the tangent and normal of the whole ground. */
static void find_direction(strut_contact_table *t) {
  t->parallel = true;
  for (int32_t k = 0; k < t->surfaces && t->parallel; k++) {
    const strut_surface *s = &t->surface[k];
    t->parallel = s->facets == 1 && s->before == HUGE_VAL && s->beyond == HUGE_VAL;
    if (!t->parallel) break;
    const double *first = t->surface[0].facet[0].axes.tangent, *own = s->facet[0].axes.tangent;
    t->parallel = fabs(first[0] * own[1] - first[1] * own[0]) < 1e-15;
  }
  if (!t->parallel) return;
  const strut_contact_axes *first = &t->surface[0].facet[0].axes;
  for (int c = 0; c < 2; c++) t->tangent[c] = first->tangent[c], t->normal[c] = first->normal[c];
}

bool strut_surfaces_compile(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_contact_table *t = &model->contacts;
  size_t most = 0, made = 0;
  for (size_t g = 0; g < scene->ground_count; g++) most += strut_ground_pieces(&scene->grounds[g]);
  strut_surface *surface = strut_arena_allocate(&model->arena, most, sizeof *surface);
  int32_t *begin = strut_arena_allocate(&model->arena, scene->ground_count + 1, sizeof *begin);
  int32_t *of = strut_arena_allocate(&model->arena, scene->contact_count, sizeof *of);
  if (!surface || !begin || !of) return false;
  for (size_t g = 0; g < scene->ground_count; g++) {
    begin[g] = (int32_t)made;
    size_t pieces = strut_ground_pieces(&scene->grounds[g]);
    if (!compile_ground(model, g, &surface[made], pieces)) return false;
    made += pieces;
  }
  for (size_t i = 0; i < scene->contact_count; i++)
    of[i] = begin[scene->contacts[i].ground] + scene->contacts[i].piece;
  t->surface = surface, t->surface_of = of;
  t->surfaces = (int32_t)made;
  find_direction(t);
  model->terms |= STRUT_TERM_SURFACES;
  if (t->moves) model->terms |= STRUT_TERM_DRIVE; /* a function of time, too */
  return true;
}
