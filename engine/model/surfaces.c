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
  strut_facet_foot foot;
  int32_t k = strut_surface_nearest(surface, p, &foot);
  if (k < 0) return;
  *pose = (strut_contact_pose){.axes = surface->facet[k].axes, .gap = foot.distance, .facet = k};
  if (!foot.held || !(foot.distance > 0.0)) return;
  find_from_foot(foot.at, p, foot.distance, 1.0, pose);
  pose->curvature = 1.0 / foot.distance;
}

static void find_on_piece(const strut_surface *surface, const double p[2],
                          strut_contact_pose *pose) {
  int32_t nearest;
  double gap = strut_surface_outermost(surface, p, -1, &nearest);
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
  double other = strut_surface_outermost(surface, point, facet, nearest);
  if (other == -HUGE_VAL) *nearest = facet;
  return strut_facet_across(&surface->facet[facet], point) - other;
}

/* ---- compilation ---- */

/* The piece between points first and last. */
static bool compile_piece(strut_model *model, const strut_profile_index *index, size_t first,
                          size_t last, strut_surface *surface) {
  const strut_ground *ground = index->ground;
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
  surface->before = strut_profile_reach(index, first, false);
  surface->beyond = strut_profile_reach(index, last, true);
  return strut_surface_bound_facets(&model->arena, surface);
}

static bool compile_profile(strut_model *model, const strut_ground *ground, strut_surface *pieces,
                            size_t count) {
  strut_arena scratch = {0};
  strut_profile_index index;
  bool fine = strut_profile_index_create(&scratch, ground, &index);
  for (size_t k = 0, first = 0, last; k < count && fine; k++, first = last) {
    last = strut_profile_piece_end(ground, first);
    fine = compile_piece(model, &index, first, last, &pieces[k]);
  }
  strut_arena_free(&scratch);
  return fine && strut_surface_bound_pieces(&model->arena, pieces, count);
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

/* Bounds are widened by this part of the lengths they come from: more than these are rounded by. */
static const double ROUNDING = 1e-14;

/* ---- bounds ---- */

static strut_line_bounds bound_lines(const strut_facet *first, size_t count) {
  strut_line_bounds b = {.normal_low = {1.0, 1.0}, .normal_high = {-1.0, -1.0}};
  const strut_facet *among = first + count / 2;
  b.middle[0] = among->point[0], b.middle[1] = among->point[1];
  b.least = HUGE_VAL, b.most = -HUGE_VAL;
  for (size_t k = 0; k < count; k++) {
    const strut_facet *facet = first + k;
    double distance = strut_facet_across(facet, b.middle);
    double wide = ROUNDING * strut_distance(facet->point, b.middle);
    b.least = fmin(b.least, distance - wide), b.most = fmax(b.most, distance + wide);
    for (int c = 0; c < 2; c++) {
      b.normal_low[c] = fmin(b.normal_low[c], facet->axes.normal[c]);
      b.normal_high[c] = fmax(b.normal_high[c], facet->axes.normal[c]);
    }
  }
  return b;
}

/* No facet of them is further on the outer side of its line than `high`, none less than `low`. */
static void bound_across(const strut_line_bounds *bounds, const double p[2], double *low,
                         double *high) {
  double x = p[0] - bounds->middle[0], y = p[1] - bounds->middle[1];
  double wide = ROUNDING * (fabs(x) + fabs(y));
  double left = x * bounds->normal_low[0], right = x * bounds->normal_high[0];
  double down = y * bounds->normal_low[1], up = y * bounds->normal_high[1];
  *low = (left < right ? left : right) + (down < up ? down : up) + bounds->least - wide;
  *high = (left < right ? right : left) + (down < up ? up : down) + bounds->most + wide;
}

static void reach_of(const strut_surface *surface, int32_t k, double *low, double *high) {
  assert(k >= 0 && k < surface->facets);
  *low = k == 0 ? -surface->before : 0.0;
  *high = surface->facet[k].length + (k + 1 == surface->facets ? surface->beyond : 0.0);
}

/* Widens a box by a facet, as far as that reaches. */
static void add_facet(const strut_surface *surface, int32_t k, double box_low[2],
                      double box_high[2]) {
  assert(k >= 0 && k < surface->facets);
  const strut_facet *facet = &surface->facet[k];
  double end[2];
  reach_of(surface, k, &end[0], &end[1]);
  for (int e = 0; e < 2; e++)
    for (int c = 0; c < 2; c++) {
      double t = facet->axes.tangent[c], x = facet->point[c] + (t != 0.0 ? end[e] * t : 0.0);
      double wide = ROUNDING * (fabs(facet->point[0]) + fabs(facet->point[1]) + facet->length);
      box_low[c] = fmin(box_low[c], x - wide), box_high[c] = fmax(box_high[c], x + wide);
    }
}

/* The least distance of p from a box. */
static double box_distance(const double low[2], const double high[2], const double p[2]) {
  double x = fmax(0.0, fmax(low[0] - p[0], p[0] - high[0]));
  double y = fmax(0.0, fmax(low[1] - p[1], p[1] - high[1])), size = sqrt(x * x + y * y);
  return size - ROUNDING * (size + fabs(p[0]) + fabs(p[1]));
}

static void bound_facets(const strut_surface *surface, strut_facet_bounds *node, strut_subtree r) {
  strut_facet_bounds *bounds = &node[r.at];
  for (int c = 0; c < 2; c++) bounds->low[c] = HUGE_VAL, bounds->high[c] = -HUGE_VAL;
  for (size_t k = r.begin; k < r.end; k++)
    add_facet(surface, (int32_t)k, bounds->low, bounds->high);
  bounds->lines = bound_lines(&surface->facet[r.begin], r.end - r.begin);
  for (int i = 0; i < 2 && !strut_subtree_is_leaf(r); i++)
    bound_facets(surface, node, strut_subtree_child(r, i));
}

bool strut_surface_bound_facets(strut_arena *arena, strut_surface *surface) {
  size_t count = (size_t)surface->facets;
  if (count <= STRUT_SUBTREE_LEAF) return true;
  strut_facet_bounds *node = strut_arena_allocate(arena, strut_subtree_nodes(count), sizeof *node);
  if (node) bound_facets(surface, node, (strut_subtree){0, 0, count});
  surface->bounds = node;
  return node != NULL;
}

/* ---- pieces ---- */

/* Bounds of some pieces, of their first facets, and of their last ones. */
typedef struct piece_bounds {
  double low[2], high[2]; /* all facets, as far as they reach [m] */
  strut_line_bounds first, last;
} piece_bounds;

/* A tree over some of the pieces. */
typedef struct piece_tree {
  size_t count;
  const int32_t *piece; /* (count) ascending */
  const piece_bounds *node;
} piece_tree;

/*
 * A piece that reaches without end has no box, but its line leads away from a point that is far above: trees
 * of one kind each can tell either way.
 */
enum { KINDS = 4 };
struct strut_piece_index {
  piece_tree tree[KINDS];
};

static int kind_of(const strut_surface *piece) {
  return (piece->before == HUGE_VAL) + 2 * (piece->beyond == HUGE_VAL);
}

/* first, last: the facets at the ends of each piece of the tree. */
static void bound_pieces(const strut_surface *all, const piece_tree *tree, const strut_facet *first,
                         const strut_facet *last, piece_bounds *node, strut_subtree r) {
  size_t count = r.end - r.begin;
  piece_bounds *self = &node[r.at];
  self->first = bound_lines(first + r.begin, count);
  self->last = bound_lines(last + r.begin, count);
  for (int c = 0; c < 2; c++) self->low[c] = HUGE_VAL, self->high[c] = -HUGE_VAL;
  for (size_t k = r.begin; k < r.end; k++) {
    const strut_surface *piece = &all[tree->piece[k]];
    for (int32_t i = 0; i < piece->facets; i++) add_facet(piece, i, self->low, self->high);
  }
  for (int i = 0; i < 2 && !strut_subtree_is_leaf(r); i++)
    bound_pieces(all, tree, first, last, node, strut_subtree_child(r, i));
}

/* The tree of one kind of pieces; ends: space for twice as many facets. */
static bool make_tree(strut_arena *arena, const strut_surface *all, size_t count, int kind,
                      strut_facet *ends, piece_tree *tree) {
  size_t n = 0;
  for (size_t k = 0; k < count; k++) n += kind_of(&all[k]) == kind;
  if (!n) return true;
  int32_t *piece = strut_arena_allocate(arena, n, sizeof *piece);
  piece_bounds *node = strut_arena_allocate(arena, strut_subtree_nodes(n), sizeof *node);
  if (!piece || !node) return false;
  *tree = (piece_tree){n, piece, node};
  for (size_t k = 0, i = 0; k < count; k++) {
    if (kind_of(&all[k]) != kind) continue;
    ends[i] = all[k].facet[0], ends[n + i] = all[k].facet[all[k].facets - 1];
    piece[i++] = (int32_t)k;
  }
  bound_pieces(all, tree, ends, ends + n, node, (strut_subtree){0, 0, n});
  return true;
}

bool strut_surface_bound_pieces(strut_arena *arena, strut_surface *pieces, size_t count) {
  if (count <= STRUT_SUBTREE_LEAF) return true;
  struct strut_piece_index *index = strut_arena_allocate(arena, 1, sizeof *index);
  strut_facet *ends = strut_allocate(2 * count, sizeof *ends);
  bool fine = index && ends;
  for (int kind = 0; kind < KINDS && fine; kind++)
    fine = make_tree(arena, pieces, count, kind, ends, &index->tree[kind]);
  for (size_t k = 0; k < count && fine; k++) pieces[k].index = index;
  strut_release(ends);
  return fine;
}

/* ---- searches ---- */

typedef struct facet_search {
  const strut_surface *surface;
  const double *p;
  int32_t except, which;
  double best;
  strut_facet_foot foot;
} facet_search;

static strut_subtree all_facets(const strut_surface *surface) {
  return (strut_subtree){0, 0, (size_t)surface->facets};
}

/* How far inwards all facets of a node are at least, negated: the most that one can be outwards. */
static double most_across(const facet_search *self, strut_subtree r) {
  double low, high;
  bound_across(&self->surface->bounds[r.at].lines, self->p, &low, &high);
  return high;
}

static void search_outermost(facet_search *self, strut_subtree r) {
  if (!self->surface->bounds || strut_subtree_is_leaf(r)) {
    for (int32_t k = (int32_t)r.begin; k < (int32_t)r.end; k++) {
      if (k == self->except) continue;
      double own = strut_facet_across(&self->surface->facet[k], self->p);
      if (own > self->best || (own == self->best && k < self->which))
        self->best = own, self->which = k;
    }
    return;
  }
  strut_subtree one = strut_subtree_child(r, 0), other = strut_subtree_child(r, 1);
  double at_one = most_across(self, one), at_other = most_across(self, other);
  bool turned = at_other > at_one;
  if (!((turned ? at_other : at_one) < self->best)) search_outermost(self, turned ? other : one);
  if (!((turned ? at_one : at_other) < self->best)) search_outermost(self, turned ? one : other);
}

double strut_surface_outermost(const strut_surface *surface, const double p[2], int32_t except,
                               int32_t *which) {
  facet_search s = {.surface = surface, .p = p, .except = except, .best = -HUGE_VAL};
  search_outermost(&s, all_facets(surface));
  *which = s.which;
  return s.best;
}

static strut_facet_foot foot_on(const strut_surface *surface, int32_t k, const double p[2]) {
  assert(k >= 0 && k < surface->facets);
  const strut_facet *facet = &surface->facet[k];
  double low, high, at = strut_facet_along(facet, p);
  reach_of(surface, k, &low, &high);
  double held = at < low ? low : at > high ? high : at;
  strut_facet_foot foot = {.at = {facet->point[0] + held * facet->axes.tangent[0],
                                  facet->point[1] + held * facet->axes.tangent[1]},
                           .held = held != at};
  foot.distance = foot.held ? strut_distance(foot.at, p) : fabs(strut_facet_across(facet, p));
  return foot;
}

/* The least distance that a facet of a node can have. */
static double least_distance(const facet_search *self, strut_subtree r) {
  const strut_facet_bounds *bounds = &self->surface->bounds[r.at];
  return box_distance(bounds->low, bounds->high, self->p);
}

static void search_nearest(facet_search *self, strut_subtree r) {
  if (!self->surface->bounds || strut_subtree_is_leaf(r)) {
    for (int32_t k = (int32_t)r.begin; k < (int32_t)r.end; k++) {
      strut_facet_foot foot = foot_on(self->surface, k, self->p);
      if (foot.distance < self->best || (foot.distance == self->best && k < self->which))
        self->best = foot.distance, self->which = k, self->foot = foot;
    }
    return;
  }
  strut_subtree one = strut_subtree_child(r, 0), other = strut_subtree_child(r, 1);
  double at_one = least_distance(self, one), at_other = least_distance(self, other);
  bool turned = at_other < at_one;
  if (!((turned ? at_other : at_one) > self->best)) search_nearest(self, turned ? other : one);
  if (!((turned ? at_one : at_other) > self->best)) search_nearest(self, turned ? one : other);
}

int32_t strut_surface_nearest(const strut_surface *surface, const double p[2],
                              strut_facet_foot *foot) {
  facet_search s = {.surface = surface, .p = p, .which = -1, .best = HUGE_VAL};
  search_nearest(&s, all_facets(surface));
  *foot = s.foot;
  return s.which;
}

/* ---- contacts ---- */

int32_t strut_contacts_of_profile(const strut_contact_table *contacts, int32_t first) {
  assert(first >= 0 && first < contacts->count);
  const strut_surface *surface = &contacts->surface[contacts->surface_of[first]];
  int32_t last = first + surface->pieces - 1;
  bool whole = surface->index && surface->piece == 0 && last < contacts->count &&
               contacts->at[last] == contacts->at[first] &&
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

typedef struct piece_search {
  const strut_surface *all;
  const piece_tree *tree;
  const double *p;
  double margin;
  int32_t first, count, *list;
} piece_search;

/*
 * Is no piece of a node of the tree within the margin, and none touched? The gap is not less than the
 * distance from any of its lines; where it is negative, it is minus the distance from a point of the piece
 * that is no further than each of them.
 */
static bool is_apart(const piece_bounds *self, const double p[2], double margin) {
  double first, last, unused;
  bound_across(&self->first, p, &first, &unused);
  bound_across(&self->last, p, &last, &unused);
  if (first > margin || last > margin) return true;
  double deepest = first > last ? -first : -last;
  return box_distance(self->low, self->high, p) > (deepest > margin ? deepest : margin);
}

static void search_pieces(piece_search *self, strut_subtree r) {
  if (is_apart(&self->tree->node[r.at], self->p, self->margin)) return;
  for (size_t k = r.begin; k < r.end && strut_subtree_is_leaf(r); k++) {
    const strut_surface *piece = &self->all[self->tree->piece[k]];
    if (!(strut_facet_across(&piece->facet[0], self->p) > self->margin) &&
        !(strut_facet_across(&piece->facet[piece->facets - 1], self->p) > self->margin))
      self->list[self->count++] = self->first + self->tree->piece[k];
  }
  for (int i = 0; i < 2 && !strut_subtree_is_leaf(r); i++)
    search_pieces(self, strut_subtree_child(r, i));
}

/* Shell's sort, which needs no memory. */
static void sort_numbers(int32_t *list, int32_t count) {
  for (int32_t gap = count / 2; gap > 0; gap /= 2)
    for (int32_t i = gap; i < count; i++) {
      int32_t number = list[i], at = i;
      for (; at >= gap && list[at - gap] > number; at -= gap) list[at] = list[at - gap];
      list[at] = number;
    }
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
    piece_search s = {all, NULL, p, margin, i, 0, list + count};
    for (int kind = 0; kind < KINDS; kind++) {
      s.tree = &all->index->tree[kind];
      if (s.tree->count) search_pieces(&s, (strut_subtree){0, 0, s.tree->count});
    }
    sort_numbers(s.list, s.count);
    count += s.count;
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

/* ---- the lowest piece ---- */

typedef struct lowest_search {
  const strut_surface *all;
  const piece_tree *tree;
  const double *p;
  int32_t which;
  double gap;
} lowest_search;

/* No piece of a node of the tree has a smaller gap. */
static double least_gap(const lowest_search *self, strut_subtree r) {
  const piece_bounds *b = &self->tree->node[r.at];
  double first, last, unused;
  bound_across(&b->first, self->p, &first, &unused);
  bound_across(&b->last, self->p, &last, &unused);
  double lines = first > last ? first : last, box = box_distance(b->low, b->high, self->p);
  return lines > 0.0 && box > lines ? box : lines;
}

static void search_lowest(lowest_search *self, strut_subtree r) {
  for (size_t i = r.begin; i < r.end && strut_subtree_is_leaf(r); i++) {
    int32_t k = self->tree->piece[i];
    strut_contact_pose pose = {.gap = HUGE_VAL};
    strut_surface_find(&self->all[k], self->p, -1, &pose);
    if (pose.gap < self->gap || (pose.gap == self->gap && k < self->which))
      self->gap = pose.gap, self->which = k;
  }
  if (strut_subtree_is_leaf(r)) return;
  strut_subtree one = strut_subtree_child(r, 0), other = strut_subtree_child(r, 1);
  double at_one = least_gap(self, one), at_other = least_gap(self, other);
  bool turned = at_other < at_one;
  if (!((turned ? at_other : at_one) > self->gap)) search_lowest(self, turned ? other : one);
  if (!((turned ? at_one : at_other) > self->gap)) search_lowest(self, turned ? one : other);
}

int32_t strut_surface_lowest(const strut_surface *first, const double p[2], double *gap) {
  lowest_search s = {first, NULL, p, 0, HUGE_VAL};
  for (int kind = 0; kind < KINDS; kind++) {
    s.tree = &first->index->tree[kind];
    if (s.tree->count) search_lowest(&s, (strut_subtree){0, 0, s.tree->count});
  }
  *gap = s.gap;
  return s.which;
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
