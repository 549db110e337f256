/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <math.h>

#include "engine/base/indices.h"
#include "engine/model/pose.h"
#include "engine/scene/profile.h"

/* Unit vectors of a line in direction (x, y): the solid is to the right. */
static strut_contact_axes axes_along(double x, double y) {
  return (strut_contact_axes){{x, y}, {-y, x}};
}

/* The largest signed distance of p from the lines of all facets but `except` (-1: of all); *which: the first
   facet that has it. -INFINITY, and facet 0, where there is none. */
static double find_outermost(const strut_surface *surface, const double p[2], int32_t except,
                             int32_t *which) {
  double best = -HUGE_VAL;
  *which = 0;
  for (int32_t k = 0; k < surface->facets; k++) {
    double own = strut_facet_across(&surface->facet[k], p);
    if (k != except && own > best) best = own, *which = k;
  }
  return best;
}

/* The point of a facet that is nearest to some point. */
typedef struct facet_foot {
  double at[2], distance; /* [m] */
  bool held;              /* it is an end of the facet */
} facet_foot;

static void reach_of(const strut_surface *surface, int32_t k, double *low, double *high) {
  assert(k >= 0 && k < surface->facets);
  *low = k == 0 ? -surface->before : 0.0;
  *high = surface->facet[k].length + (k + 1 == surface->facets ? surface->beyond : 0.0);
}

static facet_foot foot_on(const strut_surface *surface, int32_t k, const double p[2]) {
  assert(k >= 0 && k < surface->facets);
  const strut_facet *facet = &surface->facet[k];
  double low, high, at = strut_facet_along(facet, p);
  reach_of(surface, k, &low, &high);
  double held = at < low ? low : at > high ? high : at;
  facet_foot foot = {.at = {facet->point[0] + held * facet->axes.tangent[0],
                            facet->point[1] + held * facet->axes.tangent[1]},
                     .held = held != at};
  foot.distance = foot.held ? strut_distance(foot.at, p) : fabs(strut_facet_across(facet, p));
  return foot;
}

/* The first of the facets that are nearest to p, as far as they reach; -1: p is not finite. */
static int32_t find_nearest(const strut_surface *surface, const double p[2], facet_foot *nearest) {
  int32_t which = -1;
  *nearest = (facet_foot){.distance = HUGE_VAL};
  for (int32_t k = 0; k < surface->facets; k++) {
    facet_foot foot = foot_on(surface, k, p);
    if (foot.distance < nearest->distance) *nearest = foot, which = k;
  }
  return which;
}

static void find_on_facet(const strut_surface *surface, const double p[2], int32_t k,
                          strut_contact_pose *pose) {
  assert(k >= 0 && k < surface->facets);
  *pose = (strut_contact_pose){
      .axes = surface->facet[k].axes, .gap = strut_facet_across(&surface->facet[k], p), .facet = k};
}

/* From a point at distance `gap` outwards of `foot`; where they coincide the facet's own axes. */
static void find_from_foot(const double foot[2], const double p[2], double gap, double turn,
                           strut_contact_pose *pose) {
  double x = (p[0] - foot[0]) / gap, y = (p[1] - foot[1]) / gap;
  pose->axes = (strut_contact_axes){{turn * y, -turn * x}, {turn * x, turn * y}};
}

/* Outside a convex piece: its nearest segment or corner. */
static void find_outside(const strut_surface *surface, const double p[2],
                         strut_contact_pose *pose) {
  facet_foot foot;
  int32_t k = find_nearest(surface, p, &foot);
  if (k < 0) return;
  *pose = (strut_contact_pose){.axes = surface->facet[k].axes, .gap = foot.distance, .facet = k};
  if (!foot.held || !(foot.distance > 0.0)) return;
  find_from_foot(foot.at, p, foot.distance, 1.0, pose);
  pose->curvature = 1.0 / foot.distance;
}

static void find_on_piece(const strut_surface *surface, const double p[2],
                          strut_contact_pose *pose) {
  int32_t nearest;
  double gap = find_outermost(surface, p, -1, &nearest);
  const strut_facet *facet = &surface->facet[nearest];
  double at = strut_facet_along(facet, p);
  bool beyond = (nearest == 0 && at < -surface->before) ||
                (nearest + 1 == surface->facets && at > facet->length + surface->beyond);
  if (gap <= 0.0 && !beyond)
    find_on_facet(surface, p, nearest, pose);
  else
    find_outside(surface, p, pose);
}

static void find_on_circle(const strut_surface *surface, const double p[2],
                           strut_contact_pose *pose) {
  double distance = strut_distance(surface->centre, p), turn = surface->inside ? -1.0 : 1.0;
  *pose = (strut_contact_pose){.gap = turn * (distance - surface->radius),
                               .axes = axes_along(1.0, 0.0)};
  if (!(distance > 0.0)) return;
  find_from_foot(surface->centre, p, distance, turn, pose);
  pose->curvature = turn / distance;
}

void strut_surface_find(const strut_surface *surface, const double point[2], int32_t facet,
                        strut_contact_pose *pose) {
  if (!surface->facets)
    find_on_circle(surface, point, pose);
  else if (facet >= 0 ||
           (surface->facets == 1 && surface->before == HUGE_VAL && surface->beyond == HUGE_VAL))
    find_on_facet(surface, point, facet < 0 ? 0 : facet, pose);
  else
    find_on_piece(surface, point, pose);
}

double strut_surface_margin(const strut_surface *surface, const double point[2], int32_t facet,
                            int32_t *nearest) {
  assert(facet >= 0 && facet < surface->facets);
  double other = find_outermost(surface, point, facet, nearest);
  if (other == -HUGE_VAL) *nearest = facet;
  return strut_facet_across(&surface->facet[facet], point) - other;
}

/* ---- bounds ---- */

/* Bounds are widened by this part of the lengths they come from: more than these are rounded by. */
static const double ROUNDING = 1e-14;

/* Widens the box of a surface by a facet, as far as that reaches. */
static void add_facet(strut_surface *surface, int32_t k) {
  assert(k >= 0 && k < surface->facets);
  const strut_facet *facet = &surface->facet[k];
  double end[2];
  reach_of(surface, k, &end[0], &end[1]);
  for (int e = 0; e < 2; e++)
    for (int c = 0; c < 2; c++) {
      double t = facet->axes.tangent[c], x = facet->point[c] + (t != 0.0 ? end[e] * t : 0.0);
      double wide = ROUNDING * (fabs(facet->point[0]) + fabs(facet->point[1]) + facet->length);
      surface->low[c] = fmin(surface->low[c], x - wide);
      surface->high[c] = fmax(surface->high[c], x + wide);
    }
}

static void bound_facets(strut_surface *surface) {
  for (int c = 0; c < 2; c++) surface->low[c] = HUGE_VAL, surface->high[c] = -HUGE_VAL;
  for (int32_t k = 0; k < surface->facets; k++) add_facet(surface, k);
}

/* The least distance of p from the box of a surface. */
static double box_distance(const strut_surface *surface, const double p[2]) {
  double x = fmax(0.0, fmax(surface->low[0] - p[0], p[0] - surface->high[0]));
  double y = fmax(0.0, fmax(surface->low[1] - p[1], p[1] - surface->high[1]));
  double size = sqrt(x * x + y * y);
  return size - ROUNDING * (size + fabs(p[0]) + fabs(p[1]));
}

/* How far p is outside the lines of a piece's first and last facets, at most: its gap is no less. */
static double outside_ends(const strut_surface *piece, const double p[2]) {
  double first = strut_facet_across(&piece->facet[0], p);
  double last = strut_facet_across(&piece->facet[piece->facets - 1], p);
  return first > last ? first : last;
}

/* ---- compilation ---- */

/* The piece between points first and last. */
static bool compile_piece(strut_model *model, const strut_ground *ground, bool monotone,
                          size_t first, size_t last, strut_surface *surface) {
  strut_facet *facet = strut_arena_allocate(&model->arena, last - first, sizeof *facet);
  if (!facet) return false;
  for (size_t k = first; k < last; k++) {
    strut_vec2 d = strut_vec2_between(ground->points[k], ground->points[k + 1]);
    double length = strut_vec2_length(d);
    facet[k - first] = (strut_facet){.point = {ground->points[k][0], ground->points[k][1]},
                                     .axes = axes_along(d.x / length, d.y / length),
                                     .length = length};
  }
  surface->facet = facet, surface->facets = (int32_t)(last - first);
  surface->before = strut_profile_reach(ground, monotone, first, false);
  surface->beyond = strut_profile_reach(ground, monotone, last, true);
  bound_facets(surface);
  return true;
}

static bool compile_profile(strut_model *model, const strut_ground *ground, strut_surface *pieces,
                            size_t count) {
  bool fine = true, monotone = strut_profile_is_monotone(ground);
  for (size_t k = 0, first = 0, last; k < count && fine; k++, first = last) {
    last = strut_profile_piece_end(ground, first);
    fine = compile_piece(model, ground, monotone, first, last, &pieces[k]);
  }
  return fine;
}

static bool compile_line(strut_model *model, const strut_ground *ground, strut_surface *surface) {
  strut_facet *facet = strut_arena_allocate(&model->arena, 1, sizeof *facet);
  double x = cos(ground->slope), y = sin(ground->slope);
  if (!facet) return false;
  if (fabs(x) < 2e-16) x = 0.0, y = y < 0.0 ? -1.0 : 1.0; /* upright, or upside down, exactly */
  if (fabs(y) < 2e-16) y = 0.0, x = x < 0.0 ? -1.0 : 1.0;
  *facet = (strut_facet){.axes = axes_along(x, y), .length = HUGE_VAL};
  facet->point[0] = ground->placed ? ground->through[0] : 0.0;
  facet->point[1] = ground->placed ? ground->through[1] : ground->height;
  surface->facet = facet, surface->facets = 1;
  surface->before = surface->beyond = HUGE_VAL;
  return true;
}

static bool compile_ground(strut_model *model, size_t ground, strut_surface *surface,
                           size_t pieces) {
  const strut_ground *g = &model->scene->grounds[ground];
  for (size_t k = 0; k < pieces; k++)
    surface[k] = (strut_surface){.ground = (int32_t)ground,
                                 .piece = (int32_t)k,
                                 .pieces = (int32_t)pieces,
                                 .belt_speed = g->belt_speed,
                                 .moves = g->moves[0] || g->moves[1]};
  if (surface->moves) model->contacts.moves = true;
  switch (g->shape) {
    case STRUT_GROUND_LINE: return compile_line(model, g, surface);
    case STRUT_GROUND_PROFILE: return compile_profile(model, g, surface, pieces);
    case STRUT_GROUND_CIRCLE: break;
  }
  surface->centre[0] = g->centre[0], surface->centre[1] = g->centre[1];
  surface->radius = g->radius, surface->inside = g->inside;
  return true;
}

/* Lines along one direction make the tangent and normal of the whole ground. */
static void find_direction(strut_contact_table *contacts) {
  contacts->parallel = true;
  for (int32_t k = 0; k < contacts->surfaces && contacts->parallel; k++) {
    const strut_surface *surface = &contacts->surface[k];
    contacts->parallel =
        surface->facets == 1 && surface->before == HUGE_VAL && surface->beyond == HUGE_VAL;
    if (!contacts->parallel) break;
    const double *first = contacts->surface[0].facet[0].axes.tangent,
                 *own = surface->facet[0].axes.tangent;
    contacts->parallel = fabs(first[0] * own[1] - first[1] * own[0]) < 1e-15;
  }
  if (!contacts->parallel) return;
  const strut_contact_axes *first = &contacts->surface[0].facet[0].axes;
  for (int c = 0; c < 2; c++)
    contacts->tangent[c] = first->tangent[c], contacts->normal[c] = first->normal[c];
}

bool strut_surfaces_compile(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_contact_table *contacts = &model->contacts;
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
  contacts->surface = surface, contacts->surface_of = of;
  contacts->surfaces = (int32_t)made;
  find_direction(contacts);
  model->terms |= STRUT_TERM_SURFACES;
  if (contacts->moves) model->terms |= STRUT_TERM_DRIVE; /* a function of time, too */
  return true;
}

/* ---- contacts ---- */

int32_t strut_contacts_of_profile(const strut_contact_table *contacts, int32_t first) {
  assert(first >= 0 && first < contacts->count);
  const strut_surface *surface = &contacts->surface[contacts->surface_of[first]];
  int32_t last = first + surface->pieces - 1;
  bool whole = surface->pieces > STRUT_FEW_PIECES && surface->piece == 0 &&
               last < contacts->count && contacts->at[last] == contacts->at[first] &&
               contacts->surface_of[last] - contacts->surface_of[first] == last - first;
  return whole ? surface->pieces : 0;
}

int32_t strut_contacts_end_of_node(const strut_contact_table *contacts, int32_t first) {
  assert(first >= 0 && first < contacts->count);
  int32_t end = first;
  while (end < contacts->count && contacts->at[end] == contacts->at[first]) {
    int32_t pieces = strut_contacts_of_profile(contacts, end);
    end += pieces ? pieces : 1;
  }
  return end;
}

/* The node of contact i, as its ground sees it. */
static void place_of(const strut_contact_table *contacts, int32_t i, const double *positions,
                     const strut_ground_motion *motion, double p[2]) {
  assert(i >= 0 && i < contacts->count);
  const strut_ground_motion *own = strut_contact_motion(contacts, i, motion);
  p[0] = positions[contacts->at[i]] - (own ? own->place[0] : 0.0);
  p[1] = positions[contacts->at[i] + 1] - (own ? own->place[1] : 0.0);
}

/*
 * Is the piece not within the margin, nor touched? The gap is not less than the distance from any of its lines; where it
 * is negative, it is minus the distance from a point of the piece that is no further than each of them.
 */
static bool is_apart(const strut_surface *piece, const double p[2], double margin) {
  double outside = outside_ends(piece, p);
  return outside > margin || box_distance(piece, p) > (-outside > margin ? -outside : margin);
}

int32_t strut_contacts_near(const strut_contact_table *contacts, int32_t first, int32_t end,
                            const double *positions, const strut_ground_motion *motion,
                            double margin, int32_t *list) {
  int32_t count = 0;
  for (int32_t i = first, next; i < end; i = next) {
    int32_t pieces = strut_contacts_of_profile(contacts, i);
    next = i + (pieces ? pieces : 1);
    if (!pieces) {
      list[count++] = i;
      continue;
    }
    double p[2];
    place_of(contacts, i, positions, motion, p);
    const strut_surface *all = &contacts->surface[contacts->surface_of[i]];
    for (int32_t k = 0; k < pieces; k++)
      if (!is_apart(&all[k], p, margin)) list[count++] = i + k;
  }
  return count;
}

int32_t strut_contacts_all_near(const strut_contact_table *contacts, const double *positions,
                                const strut_ground_motion *motion, int32_t *list) {
  if (contacts->surface)
    return strut_contacts_near(contacts, 0, contacts->count, positions, motion, 0.0, list);
  for (int32_t i = 0; i < contacts->count; i++) list[i] = i;
  return contacts->count;
}

/* No piece's gap is smaller than this. */
static double least_gap(const strut_surface *piece, const double p[2]) {
  double outside = outside_ends(piece, p), box = box_distance(piece, p);
  return outside > 0.0 && box > outside ? box : outside;
}

static double gap_of(const strut_surface *surface, const double p[2]) {
  strut_contact_pose pose = {.gap = HUGE_VAL};
  strut_surface_find(surface, p, -1, &pose);
  return pose.gap;
}

int32_t strut_surface_lowest(const strut_surface *first, const double p[2], double *gap) {
  int32_t which = 0;
  double least = HUGE_VAL;
  for (int32_t k = 0; k < first->pieces; k++) { /* one that is likely to be among the lowest */
    double own = least_gap(&first[k], p);
    if (own < least) least = own, which = k;
  }
  *gap = gap_of(&first[which], p);
  for (int32_t k = 0; k < first->pieces; k++) {
    if (k == which || least_gap(&first[k], p) > *gap) continue;
    double own = gap_of(&first[k], p);
    if (own < *gap || (own == *gap && k < which)) *gap = own, which = k;
  }
  return which;
}

int32_t strut_contacts_lowest(const strut_contact_table *contacts, int32_t first,
                              const double *positions, const strut_ground_motion *motion,
                              double *gap) {
  assert(first >= 0 && first < contacts->count);
  double p[2];
  place_of(contacts, first, positions, motion, p);
  return first + strut_surface_lowest(&contacts->surface[contacts->surface_of[first]], p, gap);
}

int32_t strut_contacts_nearest(const strut_contact_table *contacts, int32_t first,
                               const double *positions, int32_t near[2]) {
  assert(first >= 0 && first < contacts->count);
  int32_t ground = contacts->surface[contacts->surface_of[first]].ground, i = first;
  double least[2] = {HUGE_VAL, HUGE_VAL};
  near[0] = near[1] = first;
  for (; i < contacts->count && contacts->at[i] == contacts->at[first]; i++) {
    if (contacts->surface[contacts->surface_of[i]].ground != ground) break;
    double gap = fabs(strut_contact_gap(contacts, i, positions));
    if (gap < least[0]) {
      least[1] = least[0], near[1] = near[0];
      least[0] = gap, near[0] = i;
    } else if (gap < least[1]) {
      least[1] = gap, near[1] = i;
    }
  }
  return i;
}
