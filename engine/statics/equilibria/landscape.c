/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/statics/equilibria/equilibria_parts.h"

#include "engine/base/vec.h"
#include "engine/forces/strains/strains.h"

/* Two shapes are one: as a share of the model's size, and of the potential. */
static const double SAME_SHAPE = 1e-5, SAME_POTENTIAL = 1e-8;
/* Scenes and supports that fix no more coordinates leave whole shapes free to be placed. */
enum { FEW_FIXED = 3 };

enum { RODS = 4, PARTS = 16 }; /* elements of two rods; parts of a motion, each all but straight */

static const double DEEP = 0.5; /* of the thickness: axes closer than this are in each other */

static const uint32_t *nodes_of(const strut_model *model, int32_t i) {
  return model->elements.at + model->elements.element[i].first;
}

static bool is_collision(const strut_model *model, int32_t i) {
  return model->elements.element[i].role == STRUT_ELEMENT_COLLISION;
}

static double distance_of(const strut_model *model, int32_t i, const double *positions) {
  const uint32_t *at = nodes_of(model, i);
  bool rod = model->elements.element[i].strain == STRUT_STRAIN_REACH;
  return rod ? strut_reach_of(at, positions).distance
             : strut_distance(positions + at[0], positions + at[1]);
}

/* Twice the area between a rod and a node: its sign is the side of the rod's axis on which the node is. */
static double side_of(const uint32_t *at, const double *positions) {
  strut_vec2 rod = strut_vec2_between(positions + at[1], positions + at[2]);
  strut_vec2 node = strut_vec2_between(positions + at[1], positions + at[0]);
  return rod.x * node.y - rod.y * node.x;
}

static bool are_opposite(double a, double b) { return (a > 0.0) != (b > 0.0); }

/* Of the first of the four elements of two rods: do these cross? Of any other element: no. */
static bool rods_cross(const strut_model *model, int32_t i, const double *positions) {
  const strut_element *element = &model->elements.element[i];
  double side[RODS];
  if (i && is_collision(model, i - 1) && element[-1].item == element->item) return false;
  if (strut_element_end(&model->elements, i) - i != RODS) return false;
  for (int k = 0; k < RODS; k++) side[k] = side_of(nodes_of(model, i + k), positions);
  return are_opposite(side[0], side[1]) && are_opposite(side[2], side[3]);
}

int32_t strut_overlap_find(const strut_model *model, const double *positions) {
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *element = &model->elements.element[i];
    if (!is_collision(model, i)) continue;
    if (distance_of(model, i, positions) < DEEP * element->natural ||
        rods_cross(model, i, positions))
      return element->item;
  }
  return -1;
}

int32_t strut_crossing_find(const strut_model *model, const double *first, const double *second) {
  for (int32_t i = 0; i < model->elements.count; i++)
    if (is_collision(model, i) && rods_cross(model, i, first) != rods_cross(model, i, second))
      return model->elements.element[i].item;
  return -1;
}

/* The nodes of an element, and these alone, at the share t of the way from a to b. */
static void place_between(const uint32_t *at, int32_t nodes, const double *first,
                          const double *second, double t, double *positions, uint32_t *own) {
  for (int32_t k = 0; k < nodes; k++) {
    own[k] = 2 * (uint32_t)k;
    for (uint32_t c = 0; c < 2; c++)
      positions[own[k] + c] = first[at[k] + c] + t * (second[at[k] + c] - first[at[k] + c]);
  }
}

/* Does the node pass through the axis of the rod, or past its round end by less than half the thickness? */
static bool passes_rod(const strut_model *model, int32_t i, const double *first,
                       const double *second) {
  const uint32_t *at = nodes_of(model, i);
  uint32_t own[3];
  double q[6], before = side_of(at, first);
  for (int k = 1; k <= PARTS; k++) {
    place_between(at, 3, first, second, (double)k / PARTS, q, own);
    double after = side_of(own, q);
    if (are_opposite(before, after)) {
      place_between(at, 3, first, second, (k - after / (after - before)) / PARTS, q, own);
      if (strut_reach_of(own, q).distance < DEEP * model->elements.element[i].natural) return true;
    }
    before = after;
  }
  return false;
}

/* Does the way of one node past the other come closer than half the thickness? */
static bool passes_node(const strut_model *model, int32_t i, const double *first,
                        const double *second) {
  const uint32_t *at = nodes_of(model, i);
  strut_vec2 from = strut_vec2_between(first + at[0], first + at[1]);
  strut_vec2 to = strut_vec2_between(second + at[0], second + at[1]);
  const double way[4] = {from.x, from.y, to.x, to.y}, origin[2] = {0.0, 0.0};
  double points[6] = {origin[0], origin[1], way[0], way[1], way[2], way[3]};
  const uint32_t own[3] = {0, 2, 4};
  return strut_reach_of(own, points).distance < DEEP * model->elements.element[i].natural;
}

int32_t strut_passage_find(const strut_model *model, const double *first, const double *second) {
  for (int32_t i = 0; i < model->elements.count; i++) {
    if (!is_collision(model, i)) continue;
    bool rod = model->elements.element[i].strain == STRUT_STRAIN_REACH;
    if (rod ? passes_rod(model, i, first, second) : passes_node(model, i, first, second))
      return model->elements.element[i].item;
  }
  return -1;
}

/* A way down, point by point. */
typedef struct way_down {
  const strut_model *model;
  double *last;    /* (length) */
  int32_t through; /* the first collision met, or -1 */
} way_down;

static void follow(void *context, const double *positions) {
  way_down *way = context;
  if (way->through < 0) way->through = strut_passage_find(way->model, way->last, positions);
  memcpy(way->last, positions, (size_t)way->model->length * sizeof *positions);
}

/*
 * through (set->count) gets for each saddle with one way down on either side a collision that is on one of
 * them, else -1. A floppy minimum is listed once for all shapes of its energy: a way to it leads through a
 * collision also where the straight way on to the shape that is listed does, or, where whole shapes are free
 * to be placed (`merged`), where crossing rods tell the two apart. STRUT_OK or STRUT_NO_MEMORY. The flag ends
 * it early; it may be NULL.
 */
static strut_status passages_find(const strut_potential *potential, const strut_critical_set *set,
                                  bool merged, const strut_flag *interrupt, int32_t *through,
                                  strut_error *error) {
  const strut_model *model = potential->model;
  size_t length = (size_t)model->length;
  strut_arena scratch = {0};
  way_down way = {model, strut_arena_allocate(&scratch, length, sizeof(double)), -1};
  double *q = strut_arena_allocate(&scratch, length, sizeof *q);
  strut_minimiser *minimiser = NULL;
  strut_status status = way.last && q
                            ? strut_minimiser_create(potential, &scratch, &minimiser, error)
                            : strut_no_memory(error, "");
  if (status == STRUT_OK) strut_minimiser_visit(minimiser, follow, &way);
  if (status == STRUT_OK) strut_minimiser_watch(minimiser, interrupt);
  for (size_t i = 0; i < set->count && status == STRUT_OK; i++) {
    const strut_critical_point *point = &set->points[i];
    through[i] = -1;
    for (int k = 0; k < 2 && point->negative == 1 && through[i] < 0; k++) {
      if (point->down[k] < 0) continue;
      memcpy(q, point->q, length * sizeof *q);
      memcpy(way.last, point->q, length * sizeof *q);
      way.through = -1;
      strut_descend_along(minimiser, point->softest, k ? -1.0 : 1.0, q);
      const strut_critical_point *end = &set->points[point->down[k]];
      if (way.through < 0 && merged) way.through = strut_crossing_find(model, q, end->q);
      if (way.through < 0 && !merged && end->label == STRUT_FLOPPY) follow(&way, end->q);
      through[i] = way.through;
    }
  }
  strut_arena_free(&scratch);
  return status;
}

static bool is_pass(const strut_critical_point *point) {
  return point->label == STRUT_SADDLE && point->negative == 1;
}

static bool leads_from(const strut_critical_point *pass, int32_t a) {
  return pass->down[0] == a || pass->down[1] == a;
}

static bool is_unknown(const strut_critical_point *pass) {
  return pass->down[0] < 0 || pass->down[1] < 0;
}

static strut_status find_lowest(strut_landscape *landscape, strut_error *error) {
  const strut_critical_set *set = &landscape->set;
  while ((size_t)landscape->minima < set->count &&
         set->points[landscape->minima].label <= STRUT_FLOPPY)
    landscape->minima++;
  size_t minima = (size_t)landscape->minima;
  landscape->lowest = strut_arena_allocate(&landscape->arena, minima, sizeof(double));
  landscape->parent = strut_arena_allocate(&landscape->arena, minima, sizeof(int32_t));
  if (!landscape->lowest || !landscape->parent) return strut_no_memory(error, "");
  for (int32_t i = 0; i < landscape->minima; i++) {
    landscape->lowest[i] = HUGE_VAL;
    for (size_t k = (size_t)landscape->minima; k < set->count; k++) {
      const strut_critical_point *pass = &set->points[k];
      /* a pass with unknown ends may lead anywhere */
      if (!is_pass(pass) || !(leads_from(pass, i) || is_unknown(pass))) continue;
      if (pass->potential > set->points[i].potential)
        landscape->lowest[i] = fmin(landscape->lowest[i], pass->potential);
    }
  }
  return STRUT_OK;
}

strut_status strut_landscape_create(const strut_potential *potential,
                                    const strut_critical_effort *effort, strut_landscape *landscape,
                                    strut_error *error) {
  *landscape = (strut_landscape){.potential = potential};
  landscape->merged = 2 * potential->model->node_count - potential->n <= FEW_FIXED;
  strut_status status = strut_critical_search(potential, effort, &landscape->set, error);
  if (status == STRUT_OK && potential->model->scene->collision_count) {
    landscape->through =
        strut_arena_allocate(&landscape->arena, landscape->set.count, sizeof *landscape->through);
    status = landscape->through ? passages_find(potential, &landscape->set, landscape->merged,
                                                effort->interrupt, landscape->through, error)
                                : strut_no_memory(error, "");
  }
  return status ? status : find_lowest(landscape, error);
}

void strut_landscape_free(strut_landscape *landscape) {
  strut_critical_free(&landscape->set);
  strut_arena_free(&landscape->arena);
  memset(landscape, 0, sizeof *landscape);
}

static double point_distance(const strut_landscape *landscape, const double *first,
                             const double *second) {
  const strut_model *model = landscape->potential->model;
  if (landscape->merged) return strut_shape_distance(model, first, second, true, NULL);
  double most = 0.0;
  for (int32_t i = 0; i < 2 * model->node_count; i++) most = fmax(most, fabs(first[i] - second[i]));
  return most;
}

int32_t strut_landscape_find(const strut_landscape *landscape, const double *positions) {
  double potential = strut_potential_value(landscape->potential, positions), scale = 0.0;
  double size = landscape->potential->model->size;
  for (int32_t i = 0; i < landscape->minima; i++)
    scale = fmax(scale, fabs(landscape->set.points[i].potential));
  for (int32_t i = 0; i < landscape->minima; i++) {
    const strut_critical_point *point = &landscape->set.points[i];
    if (fabs(point->potential - potential) > SAME_POTENTIAL * scale) continue;
    /* a floppy shape is a whole family of one energy */
    if (point->label == STRUT_FLOPPY ||
        point_distance(landscape, point->q, positions) <= SAME_SHAPE * size)
      return i;
  }
  return -1;
}

double strut_landscape_pass(const strut_landscape *landscape, const double *positions) {
  int32_t at = strut_landscape_find(landscape, positions);
  return at >= 0 && isfinite(landscape->lowest[at]) ? landscape->lowest[at] : -HUGE_VAL;
}

/* The root of a's tree. */
static int32_t find_root(int32_t *parent, int32_t a) {
  while (parent[a] != a) a = parent[a] = parent[parent[a]];
  return a;
}

/* A pass whose two sides are both known, and lead through no body. */
static bool connects(const strut_landscape *landscape, const strut_critical_point *pass) {
  if (landscape->through && landscape->through[pass - landscape->set.points] >= 0) return false;
  return is_pass(pass) && !is_unknown(pass) && pass->down[0] < landscape->minima &&
         pass->down[1] < landscape->minima;
}

int32_t strut_landscape_path(const strut_landscape *landscape, int32_t a, int32_t b) {
  assert(a >= 0 && a < landscape->minima && b >= 0 && b < landscape->minima);
  const strut_critical_set *set = &landscape->set;
  int32_t *parent = landscape->parent;
  for (int32_t i = 0; i < landscape->minima; i++) parent[i] = i;
  /* saddles come by energy: the one that connects a and b is the highest on the lowest path */
  for (size_t k = (size_t)landscape->minima; k < set->count; k++) {
    const strut_critical_point *pass = &set->points[k];
    if (!connects(landscape, pass)) continue;
    parent[find_root(parent, pass->down[0])] = find_root(parent, pass->down[1]);
    if (find_root(parent, a) == find_root(parent, b)) return (int32_t)k;
  }
  return -1;
}

/* The lowest saddle that leads from minimum a down to minimum b the other way, or -1. */
static int32_t landscape_direct(const strut_landscape *landscape, int32_t a, int32_t b) {
  for (size_t k = (size_t)landscape->minima; k < landscape->set.count; k++) {
    const strut_critical_point *pass = &landscape->set.points[k];
    if (connects(landscape, pass) && leads_from(pass, a) && leads_from(pass, b)) return (int32_t)k;
  }
  return -1;
}

/*
 * Writes the minima between a and b on the shortest path over saddles up to `highest` to via
 * (minima), in order; returns their count.
 */
static int32_t landscape_between(const strut_landscape *landscape, int32_t a, int32_t b,
                                 int32_t highest, int32_t *via) {
  assert(a >= 0 && a < landscape->minima && b >= 0 && b < landscape->minima);
  int32_t *next = landscape->parent, count = 0;
  for (int32_t i = 0; i < landscape->minima; i++) next[i] = -1;
  next[b] = b;
  /* in rounds from b, so that each minimum gets its successor on a shortest path */
  for (bool grew = true; grew && next[a] < 0;) {
    grew = false;
    for (int32_t i = 0; i < landscape->minima; i++) via[i] = next[i];
    for (int32_t k = landscape->minima; k <= highest; k++) {
      const strut_critical_point *pass = &landscape->set.points[k];
      for (int way = 0; way < 2 && connects(landscape, pass); way++) {
        int32_t from = pass->down[way], to = pass->down[1 - way];
        if (next[from] >= 0 || via[to] < 0) continue;
        next[from] = to;
        grew = true;
      }
    }
  }
  for (int32_t at = next[a]; at >= 0 && at != b; at = next[at]) via[count++] = at;
  return count;
}

/* The first candidate at each of the landscape's minima, or -1. */
static void find_representatives(const strut_equilibrium_search *search, int32_t *of_state) {
  for (int32_t s = 0; s < search->landscape.minima; s++) of_state[s] = -1;
  for (size_t i = 0; i < search->count; i++) {
    const strut_candidate_equilibrium *candidate = &search->candidates[i];
    if (candidate->e.outcome != STRUT_OUTCOME_STANDS || candidate->state < 0) continue;
    if (of_state[candidate->state] < 0) of_state[candidate->state] = (int32_t)i;
  }
}

static bool is_named(const strut_equilibrium_search *search, int32_t find) {
  return find >= 0 && search->candidates[find].e.configured;
}

static bool is_next_to_named(const strut_equilibrium_search *search, const int32_t *of_state,
                             int32_t s) {
  for (int32_t t = 0; t < search->landscape.minima; t++) {
    if (t == s || !is_named(search, of_state[t])) continue;
    if (landscape_direct(&search->landscape, t, s) >= 0) return true;
  }
  return false;
}

/* States that enter the table, at most STRUT_MOST_BARRIERS_BETWEEN; their count. */
static int choose_states(const strut_equilibrium_search *search, const int32_t *of_state,
                         int32_t *chosen) {
  int32_t minima = search->landscape.minima;
  bool names = false;
  int count = 0;
  for (int32_t s = 0; s < minima; s++) names = names || is_named(search, of_state[s]);
  for (int pass = 0; pass < 2; pass++) /* named ones first: the limit must not drop them */
    for (int32_t s = 0; s < minima && count < STRUT_MOST_BARRIERS_BETWEEN; s++) {
      if (of_state[s] < 0 || is_named(search, of_state[s]) != (pass == 0)) continue;
      if (pass == 1 && names && !is_next_to_named(search, of_state, s)) continue;
      chosen[count++] = s;
    }
  return count;
}

static int32_t find_saddle(const strut_equilibrium_search *search, int32_t saddle) {
  for (size_t i = 0; i < search->count; i++)
    if (!search->candidates[i].e.supports && search->candidates[i].number == saddle)
      return (int32_t)i;
  return -1;
}

/* The barrier from one of the landscape's minima to another; false: out of memory. */
static bool fill_barrier(const strut_equilibrium_search *search, const int32_t *of_state, int32_t a,
                         int32_t b, int32_t way, strut_barrier *barrier) {
  const strut_landscape *landscape = &search->landscape;
  const strut_critical_point *points = landscape->set.points;
  int32_t direct = landscape_direct(landscape, a, b);
  *barrier = (strut_barrier){
      .from = of_state[a],
      .to = of_state[b],
      .height = points[way].potential - points[a].potential,
      .saddle = find_saddle(search, way),
      .direct = direct >= 0 ? points[direct].potential - points[a].potential : (double)NAN,
      .direct_saddle = direct >= 0 ? find_saddle(search, direct) : -1};
  if (!STRUT_ALLOCATE(&search->out->arena, STRUT_NEW(barrier->via, landscape->minima)))
    return false;
  barrier->via_count = landscape_between(landscape, a, b, way, barrier->via);
  for (int32_t i = 0; i < barrier->via_count; i++) barrier->via[i] = of_state[barrier->via[i]];
  return true;
}

strut_status strut_barriers_find(strut_equilibrium_search *search) {
  const strut_landscape *landscape = &search->landscape;
  int32_t chosen[STRUT_MOST_BARRIERS_BETWEEN];
  int32_t *of_state = strut_allocate((size_t)landscape->minima, sizeof *of_state);
  size_t most = (size_t)STRUT_MOST_BARRIERS_BETWEEN * (STRUT_MOST_BARRIERS_BETWEEN - 1);
  search->out->barriers =
      strut_arena_allocate(&search->out->arena, most, sizeof *search->out->barriers);
  bool good = of_state && search->out->barriers;
  if (good) find_representatives(search, of_state);
  int count = good ? choose_states(search, of_state, chosen) : 0;
  for (int a = 0; a < count; a++)
    for (int b = 0; b < count && good; b++) {
      int32_t way = a == b ? -1 : strut_landscape_path(landscape, chosen[a], chosen[b]);
      if (way < 0) continue;
      good = fill_barrier(search, of_state, chosen[a], chosen[b], way,
                          &search->out->barriers[search->out->barrier_count++]);
    }
  strut_release(of_state);
  return good ? STRUT_OK : strut_no_memory(search->error, "");
}
