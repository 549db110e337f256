/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <gsl/gsl_interp.h>
#include <math.h>

#include "engine/model/compile_parts.h"
#include "engine/scene/law.h"

/* The block of an element: by strain, law and memory. */
static int kind_of(const strut_element *element) {
  return 2 * ((int)element->strain * STRUT_LAW_COUNT + (int)element->law) + element->remembers;
}

/* So many elements of collisions, and so many times as many as nodes, that few act at a time. */
enum { MANY_COLLISIONS = 64, FAR_MORE = 4 };

/* Blocks of one strain and one law, in the tables' order; in a block the scene's order. */
static bool sort_elements(strut_model *model, const strut_element *element, int32_t count) {
  strut_arena *arena = &model->arena;
  strut_element_table *elements = &model->elements;
  strut_element *sorted = strut_arena_allocate(arena, (size_t)count, sizeof *sorted);
  strut_element_block *block =
      strut_arena_allocate(arena, 2 * (size_t)STRUT_STRAIN_COUNT * STRUT_LAW_COUNT, sizeof *block);
  if (!sorted || !block) return false;
  int32_t all = 0, of_kind[2 * STRUT_STRAIN_COUNT * STRUT_LAW_COUNT] = {0};
  for (int32_t i = 0; i < count; i++) of_kind[kind_of(&element[i])]++;
  for (int kind = 0; kind < 2 * STRUT_STRAIN_COUNT * STRUT_LAW_COUNT; kind++) {
    int32_t begin = elements->count;
    if (!of_kind[kind]) continue;
    for (int32_t i = 0; i < count; i++)
      if (kind_of(&element[i]) == kind) sorted[elements->count++] = element[i];
    int32_t collisions = 0;
    for (int32_t i = begin; i < elements->count; i++)
      collisions += sorted[i].role == STRUT_ELEMENT_COLLISION;
    const strut_element *one = &sorted[begin];
    block[elements->block_count++] = (strut_element_block){
        one->strain, one->law, begin, elements->count, one->remembers, collisions > 0};
    all += collisions;
    model->strains |= UINT32_C(1) << one->strain;
  }
  for (int32_t i = 0; i < elements->count; i++) {
    int32_t rows = 2 * sorted[i].nodes;
    sorted[i].place = elements->entries;
    elements->entries += rows * (rows + 1) / 2;
    if (sorted[i].nodes > elements->most_nodes) elements->most_nodes = sorted[i].nodes;
  }
  elements->element = sorted, elements->block = block;
  elements->scattered = all >= MANY_COLLISIONS + FAR_MORE * (int32_t)model->node_count;
  return true;
}

/*
 * Not all of many collisions act at once, which would make the largest stable step smaller than it can ever be. Marks
 * the stiffest of each node, and as many more as bodies that are packed together have: CROWD at each node.
 */
static bool mark_crowd(strut_model *model) {
  enum { CROWD = 4 };
  strut_element_table *elements = &model->elements;
  if (!elements->scattered) return true;
  uint8_t *at_node = strut_allocate((size_t)model->node_count, sizeof *at_node);
  double *stiffest = strut_allocate((size_t)model->node_count, sizeof *stiffest);
  bool done = at_node && stiffest;
  /* where there is room, then what is stiffer */
  for (int32_t n = 0; n < 2 * elements->count && done; n++) {
    strut_element *element = (strut_element *)&elements->element[n % elements->count];
    if (element->role != STRUT_ELEMENT_COLLISION || element->crowds) continue;
    const uint32_t *at = elements->at + element->first;
    bool room = true;
    for (int32_t k = 0; k < element->nodes; k++) room = room && at_node[at[k] / 2] < CROWD;
    element->crowds = n < elements->count ? room : element->numbers.stiffness > stiffest[at[0] / 2];
    if (!element->crowds) continue;
    for (int32_t k = 0; k < element->nodes; k++) {
      uint32_t node = at[k] / 2;
      stiffest[node] = fmax(stiffest[node], element->numbers.stiffness);
      if (at_node[node] < CROWD) at_node[node]++;
    }
  }
  strut_release(at_node);
  strut_release(stiffest);
  return done;
}

/* Node lists in the elements' order, and numbers side by side, so that vector loops read on. */
static bool lay_out(strut_model *model, int32_t nodes) {
  strut_element_table *elements = &model->elements;
  size_t count = (size_t)elements->count;
  uint32_t *at = strut_arena_allocate(&model->arena, (size_t)nodes, sizeof *at);
  double *stiffness = strut_arena_allocate(&model->arena, count, sizeof *stiffness);
  double *damping = strut_arena_allocate(&model->arena, count, sizeof *damping);
  int32_t *slot = strut_arena_allocate(&model->arena, count, sizeof *slot), next = 0;
  if (!at || !stiffness || !damping || !slot) return false;
  for (int32_t i = 0; i < elements->count; i++) {
    strut_element *element = (strut_element *)&elements->element[i];
    for (int32_t k = 0; k < element->nodes; k++) at[next + k] = elements->at[element->first + k];
    element->first = next;
    next += element->nodes;
    stiffness[i] = element->numbers.stiffness, damping[i] = element->damping,
    slot[i] = element->slot;
  }
  elements->at = at, elements->stiffness = stiffness, elements->damping = damping,
  elements->slot = slot;
  return true;
}

/* Chains the elements of each member, its own force first. */
static bool link_members(strut_model *model) {
  strut_element_table *elements = &model->elements;
  strut_element *element = (strut_element *)elements->element;
  size_t members = model->scene->member_count;
  int32_t *of_member = strut_arena_allocate(&model->arena, members, sizeof *of_member);
  if (!of_member) return false;
  for (size_t j = 0; j < members; j++) of_member[j] = -1;
  for (int own = 0; own < 2; own++)
    for (int32_t i = 0; i < elements->count; i++) {
      strut_element *e = &element[i];
      if (!strut_element_is_of_member(e) || (e->role == STRUT_ELEMENT_MEMBER) != own) continue;
      e->sibling = of_member[e->item];
      of_member[e->item] = i;
    }
  elements->of_member = of_member;
  return true;
}

/* What breaks or is released at a force or a time; 0 means never. */
static strut_breakable breakable(strut_element_role role, size_t item, int32_t first, double force,
                                 double time) {
  return (strut_breakable){.role = role,
                           .item = (int32_t)item,
                           .first = first,
                           .force = force > 0.0 ? force : HUGE_VAL,
                           .time = time > 0.0 ? time : HUGE_VAL};
}

static bool list_breakables(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_element_table *elements = &model->elements;
  strut_breakable *list;
  if (!STRUT_ALLOCATE(&model->arena, STRUT_NEW(list, elements->history_count))) return false;
  for (size_t j = 0; j < scene->member_count; j++) {
    const strut_member *member = &scene->members[j];
    if (!strut_member_ends(member)) continue;
    list[elements->breakable_count++] = breakable(STRUT_ELEMENT_MEMBER, j, elements->of_member[j],
                                                  member->breaks_at, member->released_at);
  }
  for (size_t i = 0; i < scene->hinge_count; i++) {
    const strut_hinge *hinge = &scene->hinges[i];
    if (!strut_hinge_ends(hinge)) continue;
    int32_t first = strut_element_find(elements, STRUT_ELEMENT_HINGE, (int32_t)i);
    list[elements->breakable_count++] =
        breakable(STRUT_ELEMENT_HINGE, i, first, hinge->breaks_at, hinge->released_at);
  }
  elements->breakable = list;
  return true;
}

/* After the elements have been sorted. */
static bool list_memories(strut_model *model) {
  strut_element_table *elements = &model->elements;
  if (!elements->history_count) return true;
  int32_t *memory;
  if (!STRUT_ALLOCATE(&model->arena, STRUT_NEW(memory, elements->history_count))) return false;
  for (int32_t i = 0; i < elements->count; i++)
    if (elements->element[i].remembers) memory[elements->element[i].memory] = i;
  elements->memory = memory;
  model->terms |= STRUT_TERM_MEMORY;
  return list_breakables(model);
}

bool strut_elements_arrange(strut_model *model, const strut_element *element, int32_t count,
                            int32_t nodes) {
  return sort_elements(model, element, count) && lay_out(model, nodes) && mark_crowd(model) &&
         link_members(model) && list_memories(model);
}

/* Slopes at the points of a smooth table, of Steffen's monotone spline. */
static bool find_slopes(const strut_law *law, double *slope) {
  if (!law->smooth || law->count < 3) return true;
  gsl_interp *spline = gsl_interp_alloc(gsl_interp_steffen, law->count);
  if (!spline) return false;
  bool good = gsl_interp_init(spline, law->x, law->force, law->count) == 0;
  for (size_t i = 0; i < law->count && good; i++)
    slope[i] = gsl_interp_eval_deriv(spline, law->x, law->force, law->x[i], NULL);
  gsl_interp_free(spline);
  return good;
}

/* Coefficients of a cubic from values and slopes at its two ends, h apart; straight where one has no slope. */
static void fill_piece(const strut_law *law, const double *slope, size_t i, double piece[4]) {
  double h = law->x[i + 1] - law->x[i], rise = (law->force[i + 1] - law->force[i]) / h;
  bool straight = isnan(slope[i]) || isnan(slope[i + 1]);
  piece[0] = law->force[i];
  piece[1] = straight ? rise : slope[i];
  piece[2] = straight ? 0.0 : (3.0 * rise - 2.0 * slope[i] - slope[i + 1]) / h;
  piece[3] = straight ? 0.0 : (slope[i] + slope[i + 1] - 2.0 * rise) / (h * h);
}

/*
 * The law with its points as strut_curve_trace makes them of those given, and their slopes, where they have some;
 * false: out of memory.
 */
static bool take_points(strut_arena *arena, strut_law *law, double **slope) {
  size_t room = strut_curve_room(law);
  strut_curve_point *point = strut_allocate(room, sizeof *point);
  double *x = strut_arena_allocate(arena, room, sizeof *x);
  double *force = strut_arena_allocate(arena, room, sizeof *force);
  *slope = strut_arena_allocate(arena, room, sizeof **slope);
  bool made = point && x && force && *slope;
  if (made) law->count = strut_curve_trace(law, point);
  for (size_t i = 0; i < law->count && made; i++)
    x[i] = point[i].x, force[i] = point[i].force, (*slope)[i] = point[i].slope;
  law->x = x, law->force = force;
  strut_release(point);
  return made;
}

/* The stable piece of a curve at x = 0 whose force is least. */
static int find_start(const strut_law_curve *curve) {
  double least = HUGE_VAL;
  int start = 0;
  for (int i = 0; i + 1 < (int)curve->count; i++) {
    if (strut_folding_way(curve, i) < 0 || strut_folding_beyond(curve, i, 0.0)) continue;
    double force = fabs(strut_law_curve_piece(curve, (size_t)i, 0.0).force);
    if (force < least) least = force, start = i;
  }
  return start;
}

static const strut_law_curve *make_curve(strut_model *model, const strut_law *given) {
  strut_arena *arena = &model->arena;
  strut_law points = *given;
  const strut_law *law = &points;
  double *slope;
  if (!take_points(arena, &points, &slope)) return NULL;
  size_t n = law->count;
  strut_law_curve *curve = strut_arena_allocate(arena, 1, sizeof *curve);
  double(*piece)[4] = strut_arena_allocate(arena, n, sizeof *piece);
  double *energy = strut_arena_allocate(arena, n, sizeof *energy);
  if (!curve || !piece || !energy || !find_slopes(law, slope)) return NULL;
  bool folds = law->kind == STRUT_LAW_FOLDING;
  *curve = (strut_law_curve){n, law->x, (const double(*)[4])piece, energy, law->smooth, 0};
  for (size_t i = 0; i + 1 < n; i++) {
    double h = law->x[i + 1] - law->x[i], *p = piece[i];
    fill_piece(law, slope, i, p);
    energy[i + 1] = energy[i] + h * (p[0] + h * (p[1] / 2.0 + h * (p[2] / 3.0 + h * p[3] / 4.0)));
  }
  strut_law_numbers numbers = {.curve = curve};
  if (folds)
    curve->start = find_start(curve),
    curve->smooth = law->source == STRUT_LAW_CONTROL_POINTS || law->rounding > 0.0;
  double origin = strut_law_respond(law->kind, &numbers, 0.0, 0.0, -1).energy;
  for (size_t i = 0; i < n; i++) energy[i] -= origin;
  return curve;
}

bool strut_law_numbers_set(strut_model *model, const strut_law *law, double stiffness,
                           strut_law_numbers *numbers) {
  *numbers = (strut_law_numbers){.stiffness = stiffness};
#define STRUT_LAW_ROW(NAME, field, ...) numbers->field = law->field;
  STRUT_LAW_PARAMETERS(STRUT_LAW_ROW)
#undef STRUT_LAW_ROW
  if (strut_law_needs(law->kind, STRUT_LAW_PARAMETER_COEFFICIENTS))
    numbers->coefficient = law->force, numbers->count = law->count;
  if (strut_law_allows(law->kind, STRUT_LAW_PARAMETER_POINTS) &&
      !(numbers->curve = make_curve(model, law)))
    return false;
  if (strut_law_at(law->kind)->own)
    numbers->stiffness = strut_law_respond(law->kind, numbers, 0.0, 0.0, -1).slope;
  return true;
}
