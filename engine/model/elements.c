/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/elements.h"

#include "engine/base/vec.h"
#include "engine/model/compile_parts.h"

/* A stop is this many times stiffer than its member where the scene does not say. */
static const double USUAL_STOP = 100.0;

/* `reeled`: see mark_reeled. */
static size_t elements_of_member(const strut_member *member, bool reeled) {
  return (size_t)(strut_member_is_special(member) || reeled) + (size_t)(member->longest > 0.0) +
         (size_t)(member->shortest > 0.0);
}

/* Slots that a law with memory has: that of its natural strain, and those of a curve. */
static size_t memory_of_law(const strut_law *law) {
  return law->kind == STRUT_LAW_FOLDING           ? STRUT_CURVE_SLOTS
         : law->kind == STRUT_LAW_ELASTIC_PLASTIC ? 1
                                                  : 0;
}

static bool rubs(const strut_member *member) { return member->guide_friction > 0.0; }

/*
 * Slots of elements with memory: all of a member that breaks or is released, otherwise those whose law has
 * one or that rub at guides; these have one more for each segment.
 */
static size_t count_history_slots(const strut_scene *scene) {
  size_t count = 0;
  for (size_t j = 0; j < scene->member_count; j++) {
    const strut_member *member = &scene->members[j];
    count += memory_of_law(&member->law);
    if (strut_member_ends(member)) count += elements_of_member(member, false);
    if (rubs(member)) count += member->guide_count + 2;
  }
  for (size_t i = 0; i < scene->hinge_count; i++)
    count += strut_hinge_ends(&scene->hinges[i]) + memory_of_law(&scene->hinges[i].law);
  for (size_t i = 0; i < scene->distance_count; i++)
    count += memory_of_law(&scene->distances[i].law);
  for (size_t i = 0; i < scene->cell_count; i++) count += memory_of_law(&scene->cells[i].elastic);
  return count;
}

/* The loads before number i that are couples. */
static size_t count_couples(const strut_scene *scene, size_t i) {
  size_t count = 0;
  while (i-- > 0) count += scene->loads[i].couple;
  return count;
}

size_t strut_element_slots(const strut_scene *scene) {
  return scene->hinge_count + scene->cell_count + count_couples(scene, scene->load_count) +
         count_history_slots(scene);
}

/* The slots stand behind those of the members. */
static int32_t hinge_slot(const strut_model *model, int32_t hinge) {
  int32_t members = (model->members.count + STRUT_LANES - 1) / STRUT_LANES * STRUT_LANES;
  return members + hinge;
}

static int32_t cell_slot(const strut_model *model, int32_t cell) {
  return hinge_slot(model, (int32_t)model->scene->hinge_count + cell);
}

/* Behind the last of all are those of elements with memory. */
int32_t strut_couple_slot(const strut_model *model, size_t load) {
  return cell_slot(model, (int32_t)(model->scene->cell_count + count_couples(model->scene, load)));
}

int32_t strut_actuator_slot(const strut_model *model, size_t i) {
  assert(i < model->scene->actuator_count);
  const strut_actuator *actuator = &model->scene->actuators[i];
  return actuator->member >= 0  ? actuator->member
         : actuator->hinge >= 0 ? hinge_slot(model, actuator->hinge)
                                : cell_slot(model, actuator->cell);
}

double strut_element_start(const strut_model *model, int32_t element) {
  assert(element >= 0 && element < model->elements.count);
  const strut_element *e = &model->elements.element[element];
  return strut_element_near(e, e->slot >= 0 ? model->members.rest[e->slot] : e->natural);
}

/* A collision of two members is that of each of their four ends with the other member. */
enum { MOST_PAIRS = 4 };

/*
 * Marks the members with an axial_stiffness whose rest length is driven: their stiffness follows it, so that
 * they are elements. NULL: there is none, or no memory, which sets *failed.
 */
static uint8_t *mark_reeled(const strut_scene *scene, bool *failed) {
  uint8_t *reeled = NULL;
  for (size_t i = 0; i < scene->actuator_count && !*failed; i++) {
    const strut_actuator *actuator = &scene->actuators[i];
    if (actuator->force || actuator->member < 0 ||
        !(scene->members[actuator->member].axial_stiffness > 0.0))
      continue;
    if (!reeled) reeled = strut_allocate(scene->member_count, sizeof *reeled);
    *failed = !reeled;
    if (reeled) reeled[actuator->member] = 1;
  }
  return reeled;
}

static void count_elements(const strut_scene *scene, const uint8_t *reeled, size_t *elements,
                           size_t *nodes) {
  *elements = scene->hinge_count + scene->cell_count;
  *nodes = 3 * scene->hinge_count;
  for (size_t i = 0; i < scene->cell_count; i++) *nodes += scene->cells[i].node_count;
  size_t couples = count_couples(scene, scene->load_count);
  *elements += MOST_PAIRS * scene->collision_count + scene->distance_count + couples;
  for (size_t i = 0; i < scene->contact_count; i++)
    if (strut_contact_is_element(scene, i)) ++*elements, *nodes += 2;
  *nodes += 3 * (MOST_PAIRS * scene->collision_count + scene->distance_count + couples);
  for (size_t j = 0; j < scene->member_count; j++) {
    size_t own = elements_of_member(&scene->members[j], reeled && reeled[j]);
    *elements += own;
    *nodes += own * (scene->members[j].guide_count + 2);
  }
}

static int8_t sign_of(strut_carries carries) {
  return carries == STRUT_CARRIES_TENSION ? 1 : carries == STRUT_CARRIES_COMPRESSION ? -1 : 0;
}

typedef struct compilation {
  strut_model *model;
  const uint8_t *reeled;
  strut_element *element;
  uint32_t *at;
  int32_t count, nodes;
  bool failed;
} compilation;

static strut_element *add_element(compilation *self, strut_element element) {
  element.first = self->nodes;
  element.sibling = -1;
  self->element[self->count] = element;
  return &self->element[self->count++];
}

static void add_node(compilation *self, strut_element *element, int32_t node) {
  self->at[self->nodes++] = 2 * (uint32_t)node;
  element->nodes++;
}

static strut_strain_kind strain_of_member(const strut_member *member) {
  return !member->guide_count         ? STRUT_STRAIN_LENGTH
         : member->guide_radius > 0.0 ? STRUT_STRAIN_WRAP
                                      : STRUT_STRAIN_PATH;
}

static void add_way(compilation *self, strut_element *element, const strut_member *member) {
  for (size_t k = 0; k < member->guide_count + 2; k++)
    add_node(self, element, strut_member_node(member, k));
  element->radius = member->guide_radius;
  element->axis = (double)strut_member_right_guides(self->model->scene, member);
}

/* Its slot keeps ends and rest length, but has no force; the mass of a running cable is lumped. */
static void take_over(compilation *self, size_t j) {
  strut_model *model = self->model;
  strut_member_table *members = &model->members;
  const strut_scene *scene = model->scene;
  const strut_member *member = &scene->members[j];
  ((double *)members->stiffness)[j] = 0.0;
  ((double *)members->damping)[j] = 0.0;
  ((double *)members->slack)[j] = -HUGE_VAL;
  if (!member->guide_count) return;
  ((double *)members->mass)[j] = 0.0;
  double whole = 0.0;
  for (int pass = 0; pass < 2; pass++)
    for (size_t k = 0; k <= member->guide_count; k++) {
      int32_t a = strut_member_node(member, k), b = strut_member_node(member, k + 1);
      double part = strut_distance(scene->nodes[a].position, scene->nodes[b].position);
      if (pass == 0) {
        whole += part;
        continue;
      }
      double share = 0.5 * member->mass * (whole > 0.0 ? part / whole : 0.0);
      ((double *)model->point_mass)[a] += share;
      ((double *)model->point_mass)[b] += share;
    }
}

/* Gives an element a slot of its own, in which what it remembers shifts its natural strain, and a curve one
 * for the piece that it is on. */
static void remember(compilation *self, strut_element *element) {
  strut_model *model = self->model;
  element->remembers = true;
  element->base = element->slot;
  element->memory = model->elements.history_count++;
  strut_element_table *elements = &model->elements;
  elements->history_slot = strut_couple_slot(model, model->scene->load_count);
  element->slot = elements->history_slot + elements->history_slots++;
  double *rest = (double *)model->members.rest;
  rest[element->slot] = element->base >= 0 ? rest[element->base] : element->natural;
  if (element->law == STRUT_LAW_FOLDING && !self->failed) {
    rest[element->slot + STRUT_CURVE_PIECE] = element->numbers.curve->start;
    elements->history_slots += STRUT_CURVE_SLOTS - 1;
  }
  for (int32_t k = 0; k + 1 < element->nodes && element->guide_friction > 0.0; k++)
    rest[elements->history_slot + elements->history_slots++] = -1.0; /* nothing is remembered yet */
}

/* `ends`: it breaks or is released. */
static void set_law(compilation *self, strut_element *element, const strut_law *law,
                    double stiffness, bool ends) {
  element->law = law->kind;
  element->carries = sign_of(law->carries);
  if (!strut_law_numbers_set(self->model, law, stiffness, &element->numbers)) self->failed = true;
  if (ends || memory_of_law(law)) remember(self, element);
}

static void add_stop(compilation *self, size_t j, strut_element_role role, double at,
                     double stiffness) {
  const strut_member *member = &self->model->scene->members[j];
  strut_element *element =
      add_element(self, (strut_element){.strain = strain_of_member(member),
                                        .law = STRUT_LAW_LINEAR,
                                        .role = role,
                                        .item = (int32_t)j,
                                        .slot = -1,
                                        .carries = role == STRUT_ELEMENT_LONGEST ? 1 : -1,
                                        .natural = at,
                                        .damping = member->stop_damping,
                                        .numbers = {.stiffness = stiffness}});
  add_way(self, element, member);
  if (strut_member_ends(member)) remember(self, element);
}

static void add_member(compilation *self, size_t j) {
  assert(j < self->model->scene->member_count);
  const strut_member *member = &self->model->scene->members[j];
  double stiffness = self->model->members.stiffness[j];
  bool reeled = self->reeled && self->reeled[j];
  if (strut_member_is_special(member) || reeled) {
    bool cable = member->kind == STRUT_CABLE;
    strut_element *element =
        add_element(self, (strut_element){.strain = strain_of_member(member),
                                          .law = reeled ? STRUT_LAW_AXIAL : member->law.kind,
                                          .role = STRUT_ELEMENT_MEMBER,
                                          .item = (int32_t)j,
                                          .slot = (int32_t)j,
                                          .carries = cable ? 1 : sign_of(member->law.carries),
                                          .damping = member->damping});
    add_way(self, element, member);
    if (!strut_law_numbers_set(self->model, &member->law, stiffness, &element->numbers))
      self->failed = true;
    stiffness = element->numbers.stiffness;
    if (reeled)
      element->numbers.axial = member->axial_stiffness,
      element->numbers.material = (int)member->law.kind;
    element->guide_friction = member->guide_friction;
    if (strut_member_ends(member) || memory_of_law(&member->law) || rubs(member))
      remember(self, element);
    take_over(self, j);
  }
  double stop = member->stop_stiffness > 0.0 ? member->stop_stiffness : USUAL_STOP * stiffness;
  if (member->shortest > 0.0) add_stop(self, j, STRUT_ELEMENT_SHORTEST, member->shortest, stop);
  if (member->longest > 0.0) add_stop(self, j, STRUT_ELEMENT_LONGEST, member->longest, stop);
}

static void add_hinge(compilation *self, size_t i) {
  assert(i < self->model->scene->hinge_count);
  strut_model *model = self->model;
  const strut_hinge *hinge = &model->scene->hinges[i];
  int32_t slot = hinge_slot(model, (int32_t)i);
  strut_element *element = add_element(self, (strut_element){.strain = STRUT_STRAIN_ANGLE,
                                                             .role = STRUT_ELEMENT_HINGE,
                                                             .item = (int32_t)i,
                                                             .slot = slot,
                                                             .damping = hinge->damping});
  for (int k = 0; k < 3; k++) add_node(self, element, hinge->node[k]);
  ((double *)model->members.rest)[slot] = strut_hinge_rest(model->scene, i);
  set_law(self, element, &hinge->law, hinge->stiffness, strut_hinge_ends(hinge));
}

/* Their nodes run counter-clockwise, so that their area is positive. */
static void add_corners(compilation *self, strut_element *element, const strut_cell *cell,
                        double area) {
  for (size_t k = 0; k < cell->node_count; k++)
    add_node(self, element, cell->node[area < 0.0 ? cell->node_count - 1 - k : k]);
}

static void add_elastic_cell(compilation *self, size_t i, double area) {
  const strut_cell *cell = &self->model->scene->cells[i];
  strut_element *element = add_element(
      self, (strut_element){.strain = STRUT_STRAIN_AREA,
                            .role = STRUT_ELEMENT_CELL,
                            .item = (int32_t)i,
                            .slot = -1,
                            .natural = isnan(cell->rest_area) ? fabs(area) : cell->rest_area,
                            .damping = cell->damping});
  add_corners(self, element, cell, area);
  set_law(self, element, &cell->elastic, cell->stiffness, false);
  element->numbers.area = fabs(area);
}

static void add_cell(compilation *self, size_t i) {
  assert(i < self->model->scene->cell_count);
  strut_model *model = self->model;
  const strut_cell *cell = &model->scene->cells[i];
  double area = strut_cell_drawn(model->scene, i);
  if (strut_cell_is_elastic(cell)) {
    add_elastic_cell(self, i, area);
    return;
  }
  int32_t slot = cell_slot(model, (int32_t)i);
  double stiffness = strut_law_respond(cell->law,
                                       &(strut_law_numbers){.area = fabs(area),
                                                            .exponent = cell->exponent,
                                                            .outside = cell->outside},
                                       fabs(area), cell->pressure, -1)
                         .slope;
  strut_element *element =
      add_element(self, (strut_element){.strain = STRUT_STRAIN_AREA,
                                        .law = cell->law,
                                        .role = STRUT_ELEMENT_CELL,
                                        .item = (int32_t)i,
                                        .slot = slot,
                                        .numbers = {.stiffness = stiffness,
                                                    .area = fabs(area),
                                                    .exponent = cell->exponent,
                                                    .outside = cell->outside}});
  add_corners(self, element, cell, area);
  ((double *)model->members.rest)[slot] = cell->pressure;
}

/* Of a node with the segment from a to b, or with the node a where b is -1. */
static void add_pair(compilation *self, size_t i, int32_t node, int32_t a, int32_t b) {
  const strut_collision *collision = &self->model->scene->collisions[i];
  strut_element *element =
      add_element(self, (strut_element){.strain = b < 0 ? STRUT_STRAIN_LENGTH : STRUT_STRAIN_REACH,
                                        .law = STRUT_LAW_LINEAR,
                                        .role = STRUT_ELEMENT_COLLISION,
                                        .item = (int32_t)i,
                                        .slot = -1,
                                        .carries = -1,
                                        .natural = collision->thickness,
                                        .damping = collision->damping,
                                        .numbers = {.stiffness = collision->stiffness}});
  add_node(self, element, node);
  add_node(self, element, a);
  if (b >= 0) add_node(self, element, b);
}

static void add_collision(compilation *self, size_t i) {
  assert(i < self->model->scene->collision_count);
  const strut_scene *scene = self->model->scene;
  const strut_collision *collision = &scene->collisions[i];
  const strut_member *m[2] = {NULL, NULL};
  for (int k = 0; k < 2; k++)
    if (collision->member[k] >= 0) m[k] = &scene->members[collision->member[k]];
  if (!m[0]) add_pair(self, i, collision->node[0], collision->node[1], -1);
  if (m[0] && !m[1]) add_pair(self, i, collision->node[0], m[0]->node[0], m[0]->node[1]);
  for (int k = 0; k < MOST_PAIRS && m[0] && m[1]; k++)
    add_pair(self, i, m[k / 2]->node[k % 2], m[1 - k / 2]->node[0], m[1 - k / 2]->node[1]);
}

/* Against a direction that points to -x the nodes change places, so that the half angle has a tangent. */
static void add_distance(compilation *self, size_t i) {
  const strut_distance_spring *spring = &self->model->scene->distances[i];
  bool line = spring->line[0] >= 0, back = !line && cos(spring->along) < 0.0;
  double sign = back ? -1.0 : 1.0;
  strut_element *element = add_element(
      self, (strut_element){.strain = line ? STRUT_STRAIN_OFFSET : STRUT_STRAIN_ALONG,
                            .role = STRUT_ELEMENT_DISTANCE,
                            .item = (int32_t)i,
                            .slot = -1,
                            .natural = strut_distance_rest(self->model->scene, i),
                            .axis = sign * sin(spring->along) / (1.0 + sign * cos(spring->along)),
                            .damping = spring->damping});
  add_node(self, element, line ? spring->node[0] : spring->node[back]);
  add_node(self, element, line ? spring->line[0] : spring->node[!back]);
  if (line) add_node(self, element, spring->line[1]);
  set_law(self, element, &spring->law, spring->stiffness, false);
}

/* Its law is that of a given pressure, with the drawn angle for the area. */
static void add_couple(compilation *self, size_t i) {
  strut_model *model = self->model;
  const strut_load *load = &model->scene->loads[i];
  int32_t slot = strut_couple_slot(model, i);
  strut_element *element = add_element(self, (strut_element){.strain = STRUT_STRAIN_ANGLE,
                                                             .law = STRUT_LAW_PRESSURE,
                                                             .role = STRUT_ELEMENT_LOAD,
                                                             .item = (int32_t)i,
                                                             .slot = slot});
  const int32_t *node = load->hinge >= 0 ? model->scene->hinges[load->hinge].node
                                         : model->scene->members[load->member].node;
  for (int k = 0; k < (load->hinge >= 0 ? 3 : 2); k++) add_node(self, element, node[k]);
  strut_vec2 span = strut_vec2_between(model->scene->nodes[node[0]].position,
                                       model->scene->nodes[node[1]].position);
  element->numbers.area = load->hinge >= 0 ? strut_hinge_drawn(model->scene, (size_t)load->hinge)
                                           : atan2(span.y, span.x);
  ((double *)model->members.rest)[slot] = load->signal < 0 ? load->moment : 0.0;
  model->elements.couples++;
}

/*
 * Contacts that are elements press as the scene says: a foot, or a node alone, which is one without an arc.
 * strut_rubbing_compile places them on their grounds.
 */
static void add_feet(compilation *self) {
  const strut_scene *scene = self->model->scene;
  for (size_t i = 0; i < scene->contact_count; i++) {
    int32_t k = strut_foot_of_contact(scene, i);
    if (!strut_contact_is_element(scene, i)) continue;
    strut_element *element = add_element(
        self, (strut_element){.strain = STRUT_STRAIN_FOOT,
                              .law = STRUT_LAW_LINEAR,
                              .role = k < 0 ? STRUT_ELEMENT_CONTACT : STRUT_ELEMENT_FOOT,
                              .item = k < 0 ? (int32_t)i : k,
                              .slot = -1,
                              .carries = -1,
                              .contact = (int32_t)i,
                              .radius = k < 0 ? 0.0 : scene->feet[k].radius,
                              .damping = scene->contacts[i].damping,
                              .numbers.stiffness = scene->contacts[i].stiffness});
    add_node(self, element, scene->contacts[i].node);
    if (k < 0) continue;
    const strut_member *member = &scene->members[scene->feet[k].member];
    add_node(self, element, member->node[member->node[0] == scene->feet[k].node]);
  }
}

static bool compile(strut_model *model, const uint8_t *reeled) {
  const strut_scene *scene = model->scene;
  size_t elements, nodes;
  count_elements(scene, reeled, &elements, &nodes);
  if (!elements) return true;
  compilation c = {.model = model, .reeled = reeled};
  if (!STRUT_ALLOCATE(&model->arena, STRUT_NEW(c.element, elements), STRUT_NEW(c.at, nodes)))
    return false;
  for (size_t j = 0; j < scene->member_count; j++)
    if (elements_of_member(&scene->members[j], reeled && reeled[j])) add_member(&c, j);
  for (size_t i = 0; i < scene->hinge_count; i++) add_hinge(&c, i);
  for (size_t i = 0; i < scene->cell_count; i++) add_cell(&c, i);
  for (size_t i = 0; i < scene->collision_count; i++) add_collision(&c, i);
  for (size_t i = 0; i < scene->distance_count; i++) add_distance(&c, i);
  for (size_t i = 0; i < scene->load_count; i++)
    if (scene->loads[i].couple) add_couple(&c, i);
  add_feet(&c);
  assert(c.count <= (int32_t)elements && c.nodes <= (int32_t)nodes);
  model->elements.at = c.at;
  model->terms |= STRUT_TERM_ELEMENTS;
  return !c.failed && strut_elements_arrange(model, c.element, c.count, c.nodes);
}

bool strut_elements_compile(strut_model *model) {
  bool failed = false;
  uint8_t *reeled = mark_reeled(model->scene, &failed);
  bool done = !failed && compile(model, reeled);
  strut_release(reeled);
  return done;
}

static int32_t nodes_of(const strut_scene *scene, const strut_actuator *actuator) {
  return actuator->member >= 0 ? (int32_t)scene->members[actuator->member].guide_count + 2 : 3;
}

bool strut_actuator_forces_compile(strut_model *model) {
  const strut_scene *scene = model->scene;
  size_t count = 0, nodes = 0;
  for (size_t i = 0; i < scene->actuator_count; i++) {
    if (!scene->actuators[i].force) continue;
    count++;
    nodes += (size_t)nodes_of(scene, &scene->actuators[i]);
  }
  if (!count) return true;
  strut_actuator_force *item = strut_arena_allocate(&model->arena, count, sizeof *item);
  uint32_t *at = strut_arena_allocate(&model->arena, nodes, sizeof *at);
  if (!item || !at) return false;
  int32_t filled = 0, first = 0;
  for (size_t i = 0; i < scene->actuator_count; i++) {
    const strut_actuator *actuator = &scene->actuators[i];
    if (!actuator->force) continue;
    int32_t n = nodes_of(scene, actuator);
    bool member = actuator->member >= 0;
    item[filled++] = (strut_actuator_force){.strain = !member ? STRUT_STRAIN_ANGLE
                                                      : n > 2 ? STRUT_STRAIN_PATH
                                                              : STRUT_STRAIN_LENGTH,
                                            .member = member ? actuator->member : -1,
                                            .hinge = member ? -1 : actuator->hinge,
                                            .signal = actuator->signal,
                                            .first = first,
                                            .nodes = n};
    for (int32_t k = 0; k < n; k++)
      at[first++] =
          2 * (uint32_t)(member ? strut_member_node(&scene->members[actuator->member], (size_t)k)
                                : scene->hinges[actuator->hinge].node[k]);
  }
  model->actuator_forces = (strut_actuator_force_table){(int32_t)count, item, at};
  model->terms |= STRUT_TERM_ACTUATOR_FORCES;
  return true;
}
