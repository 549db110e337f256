/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ordered passes from scene to model. See model.h. */
#include <assert.h>
#include <math.h>

#include "engine/base/vec.h"
#include "engine/model/compile_parts.h"
#include "engine/model/mass.h"

_Static_assert(STRUT_STRAIN_COUNT <= 32, "a bit for each in strut_model");

/* Passes return false where memory is out. */

static bool compile_nodes(strut_model *model) {
  const strut_scene *scene = model->scene;
  size_t count = scene->node_count;
  size_t needed = 2 * count + 2 + strut_feedback_states(scene);
  size_t length = (needed + STRUT_LANES - 1) / STRUT_LANES * STRUT_LANES;
  model->node_count = (int32_t)scene->node_count;
  model->length = (int32_t)length;
  double *start, *velocity, *mass;
  uint8_t *fixed;
  if (!STRUT_ALLOCATE(&model->arena, STRUT_NEW(start, length), STRUT_NEW(velocity, length),
                      STRUT_NEW(mass, count), STRUT_NEW(fixed, length)))
    return false;
  for (size_t i = 0; i < scene->unbalance_count; i++)
    mass[scene->unbalances[i].node] += scene->unbalances[i].mass;
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
  for (size_t i = 0; i < scene->node_count; i++) {
    const strut_node *node = &scene->nodes[i];
    mass[i] += node->mass;
    for (size_t c = 0; c < 2; c++) {
      start[2 * i + c] = node->start[c];
      velocity[2 * i + c] = node->fixed[c] ? 0.0 : node->velocity[c];
      fixed[2 * i + c] = node->fixed[c];
      low[c] = fmin(low[c], node->position[c]);
      high[c] = fmax(high[c], node->position[c]);
    }
  }
  model->size = fmax(high[0] - low[0], high[1] - low[1]);
  if (!(model->size > 0)) model->size = 1.0;
  model->start = start, model->velocity = velocity;
  model->point_mass = mass, model->fixed = fixed;
  return true;
}

static bool compile_members(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_member_table *t = &model->members;
  size_t members = (scene->member_count + STRUT_LANES - 1) / STRUT_LANES * STRUT_LANES;
  size_t slots =
      members + (strut_element_slots(scene) + STRUT_LANES - 1) / STRUT_LANES * STRUT_LANES;
  t->count = (int32_t)scene->member_count;
  t->slots = (int32_t)slots;
  t->blocks = ((int32_t)members + STRUT_BLOCK - 1) / STRUT_BLOCK;
  uint32_t *from, *to;
  double *stiffness, *damping, *rest, *mass, *slack;
  uint16_t *terms;
  if (!STRUT_ALLOCATE(&model->arena, STRUT_NEW(from, slots), STRUT_NEW(to, slots)) ||
      !STRUT_NUMBERS(&model->arena, slots, &stiffness, &damping, &rest, &mass, &slack) ||
      !STRUT_ALLOCATE(&model->arena, STRUT_NEW(terms, t->blocks)))
    return false;
  for (size_t j = 0; j < slots; j++) {
    slack[j] = -HUGE_VAL;
    from[j] = 2 * (uint32_t)model->node_count;
    to[j] = from[j];
  }
  for (size_t j = 0; j < scene->member_count; j++) {
    const strut_member *member = &scene->members[j];
    strut_rest r;
    bool resolved = strut_member_rest(scene, j, &r);
    assert(resolved && "the scene has been checked");
    (void)resolved;
    from[j] = 2 * (uint32_t)member->node[0], to[j] = 2 * (uint32_t)member->node[1];
    stiffness[j] = r.stiffness, rest[j] = r.length;
    damping[j] = member->damping, mass[j] = member->mass;
    unsigned needs = STRUT_TERM_MEMBERS;
    if (member->kind == STRUT_BAR && scene->bar_model == STRUT_BARS_RIGID)
      model->terms |= STRUT_TERM_RIGID | STRUT_TERM_LAWS;
    if (member->damping > 0) needs |= STRUT_TERM_DAMPING;
    if (member->kind == STRUT_CABLE) slack[j] = 0.0, needs |= STRUT_TERM_SLACK;
    terms[j / STRUT_BLOCK] = (uint16_t)(terms[j / STRUT_BLOCK] | needs);
    model->terms |= needs;
  }
  t->from = from, t->to = to, t->stiffness = stiffness, t->damping = damping, t->rest = rest;
  t->slack = slack, t->mass = mass, t->block_terms = terms;
  t->rows = strut_pull_rows_create(&model->arena, t->count, from, to);
  return t->rows;
}

static bool compile_drives(strut_model *model) {
  const strut_scene *scene = model->scene;
  size_t most = scene->actuator_count, count = 0;
  int32_t *member = NULL, *signal = NULL;
  uint8_t *first = NULL, *driven = strut_allocate((size_t)model->members.slots, sizeof *driven);
  bool made = driven && STRUT_ALLOCATE(&model->arena, STRUT_NEW(member, most),
                                       STRUT_NEW(signal, most), STRUT_NEW(first, most));
  if (!made) most = 0;
  uint16_t *terms = (uint16_t *)model->members.block_terms;
  for (size_t i = 0; i < most; i++) {
    if (scene->actuators[i].force) continue;
    int32_t slot = strut_actuator_slot(model, i);
    member[count] = slot;
    signal[count] = scene->actuators[i].signal;
    first[count++] = !driven[slot];
    driven[slot] = 1;
    if (slot < model->members.count) terms[slot / STRUT_BLOCK] |= STRUT_TERM_DRIVE;
    model->terms |= STRUT_TERM_DRIVE;
  }
  model->drives = (strut_drive_table){(int32_t)count, member, signal, first};
  strut_release(driven);
  return made;
}

static bool compile_rubbing(strut_model *model) {
  bool rubs = strut_collisions_rub(model->scene);
  for (size_t i = 0; i < model->scene->contact_count && !rubs; i++)
    rubs = strut_contact_is_element(model->scene, i);
  return !rubs || strut_rubbing_compile(model);
}

/* Half of each member's mass at each of its ends (7), the point masses, and the sliding ones. */
static bool compile_weights(strut_model *model) {
  const strut_member_table *members = &model->members;
  double *weight;
  if (!STRUT_NUMBERS(&model->arena, model->node_count, &weight)) return false;
  for (int32_t i = 0; i < model->node_count; i++) weight[i] = model->point_mass[i];
  for (int32_t j = 0; j < members->count; j++) {
    weight[members->from[j] / 2] += 0.5 * members->mass[j];
    weight[members->to[j] / 2] += 0.5 * members->mass[j];
  }
  for (int32_t i = 0; i < model->node_count && model->sliding.count; i++)
    if (!(weight[i] > 0) && !(model->fixed[2 * i] && model->fixed[2 * i + 1]))
      model->sliding.massless_node = true;
  for (int32_t i = 0; i < model->sliding.count; i++) {
    const strut_sliding_item *item = &model->sliding.item[i];
    weight[item->at[0] / 2] += (1.0 - item->start) * item->mass;
    weight[item->at[1] / 2] += item->start * item->mass;
  }
  model->weight = weight;
  return true;
}

static void compile_unbalances(strut_model *model) {
  const strut_scene *scene = model->scene;
  for (size_t i = 0; i < scene->unbalance_count; i++) {
    int32_t signal = scene->unbalances[i].signal;
    model->terms |= STRUT_TERM_UNBALANCE;
    if (signal >= 0 && strut_signal_next_break(scene->signals, signal, 0.0) < HUGE_VAL)
      model->unbalance_corners = true;
  }
}

static bool compile_loads(strut_model *model) {
  const strut_scene *scene = model->scene;
  size_t most = scene->load_count;
  double *constant, *x, *y;
  int32_t *node, *signal, *slot;
  if (!STRUT_ALLOCATE(&model->arena, STRUT_NEW(constant, model->length), STRUT_NEW(x, most),
                      STRUT_NEW(y, most), STRUT_NEW(node, most), STRUT_NEW(signal, most),
                      STRUT_NEW(slot, most)))
    return false;
  bool any = false;
  for (size_t c = 0; c < 2; c++)
    for (size_t i = 0; i < scene->node_count && scene->gravity[c] != 0.0; i++) {
      constant[2 * i + c] = model->weight[i] * scene->gravity[c];
      any = true;
    }
  int32_t count = 0;
  for (size_t i = 0; i < most; i++) {
    const strut_load *load = &scene->loads[i];
    if (load->signal >= 0) {
      node[count] = load->node, signal[count] = load->signal;
      slot[count] = load->couple ? strut_couple_slot(model, i) : -1;
      x[count] = load->couple ? load->moment : load->force[0], y[count++] = load->force[1];
      continue;
    }
    if (load->couple) continue;
    constant[2 * load->node] += load->force[0];
    constant[2 * load->node + 1] += load->force[1];
    any = true;
  }
  model->constant_force = any ? constant : NULL;
  model->loads = (strut_load_table){count, node, slot, signal, x, y};
  model->terms |= (any ? STRUT_TERM_CONSTANT : 0u) | (count ? STRUT_TERM_LOADS : 0u);
  return true;
}

/* A law of damping is a choice of numbers, which the kernel of the ground distinguishes by `dissipation`. */
static void set_damping(strut_model *model, strut_contact_entry *entry, strut_ground_damping law,
                        double dissipation) {
  switch (law) {
    case STRUT_DAMPING_APPROACH: return;
    case STRUT_DAMPING_HUNT_CROSSLEY:
      entry->damping = 0.0;
      entry->dissipation = dissipation;
      model->terms |= STRUT_TERM_LAWS;
      return;
    case STRUT_DAMPING_COUNT: break;
  }
  assert(false && "the scene was checked");
}

/* Times at which a signal is looked at. */
enum { MOST_TIMES = 4096 };

/* The largest value of a signal at the times where it may turn or jump; 1 of one that follows a sensor. */
static double largest_value(const strut_scene *scene, int32_t signal) {
  static const double LONG = 1e4; /* [s] */
  double time[MOST_TIMES], value, rate, most = 0.0;
  strut_signal_evaluate(scene->signals, signal, 0.0, &value, &rate);
  if (isnan(value)) return 1.0;
  most = fmax(most, value);
  size_t count = strut_signal_times(scene->signals, signal, 0.0, LONG, time, MOST_TIMES);
  for (size_t i = 0; i < count; i++) {
    strut_signal_evaluate(scene->signals, signal, time[i], &value, &rate);
    most = fmax(most, value);
  }
  return most;
}

static bool compile_contacts(strut_model *model) {
  const strut_scene *scene = model->scene;
  size_t count = scene->contact_count;
  strut_contact_table *contacts = &model->contacts;
  uint32_t *at;
  strut_contact_entry *entry;
  bool grips = false;
  if (!STRUT_ALLOCATE(&model->arena, STRUT_NEW(at, count), STRUT_NEW(entry, count))) return false;
  if (!strut_scene_has_ground(scene) || !count) return true;
  for (size_t i = 0; i < count; i++) {
    const strut_contact *contact = &scene->contacts[i];
    at[i] = 2 * (uint32_t)contact->node;
    entry[i] = (strut_contact_entry){.node = contact->node,
                                     .lane = contact->node % STRUT_CONTACT_LANES,
                                     .stiffness = contact->stiffness,
                                     .damping = contact->damping};
    const strut_ground *ground =
        scene->ground_count ? &scene->grounds[contact->ground] : &scene->ground;
    set_damping(model, &entry[i], ground->damping_law, contact->dissipation);
    if (contact->friction.law == STRUT_FRICTION_NONE) continue;
    entry[i].friction = contact->friction;
    grips = grips || contact->friction.driven;
    if (contact->friction.driven) {
      bool again = i > 0 && entry[i - 1].friction.driven &&
                   entry[i - 1].friction.signal == contact->friction.signal;
      strut_friction_drive(&entry[i].friction,
                           again ? entry[i - 1].friction.mu_kinetic
                                 : largest_value(scene, contact->friction.signal));
    }
    model->terms |= STRUT_TERM_FRICTION;
    if (contact->friction.law != STRUT_FRICTION_KARNOPP) model->terms |= STRUT_TERM_LAWS;
    if (contact->friction.directional) model->terms |= STRUT_TERM_LAWS | STRUT_TERM_DIRECTION;
  }
  *contacts = (strut_contact_table){.count = (int32_t)count,
                                    .at = at,
                                    .entry = entry,
                                    .tangent = {1, 0},
                                    .normal = {0, 1},
                                    .axes = {{1, 0}, {0, 1}},
                                    .grips = grips};
  if (grips) model->terms |= STRUT_TERM_DRIVE; /* a function of time, too */
  if (scene->ground_count) return strut_surfaces_compile(model);
  contacts->height = scene->ground.height, contacts->belt_speed = scene->ground.belt_speed;
  model->terms |= STRUT_TERM_CONTACT;
  if (scene->ground.slope == 0.0) return true;
  double c = cos(scene->ground.slope), s = sin(scene->ground.slope);
  contacts->tangent[0] = c, contacts->tangent[1] = s, contacts->normal[0] = -s,
  contacts->normal[1] = c;
  contacts->axes = (strut_contact_axes){{c, s}, {-s, c}};
  model->terms |= STRUT_TERM_SLOPE;
  return true;
}

/* Inverse of a node's lumped mass along d, in which supported directions are infinitely heavy. */
static double lightness(const strut_model *model, int32_t node, strut_vec2 d) {
  assert(node >= 0 && node < model->node_count);
  const uint8_t *fixed = model->fixed + 2 * node;
  double along = (fixed[0] ? 0.0 : d.x * d.x) + (fixed[1] ? 0.0 : d.y * d.y);
  return along > 0.0 ? along / model->weight[node] : 0.0;
}

static strut_vec2 direction(const strut_scene *scene, int32_t a, int32_t b) {
  strut_vec2 span = strut_vec2_between(scene->nodes[a].position, scene->nodes[b].position);
  return strut_vec2_unit(span, strut_vec2_length(span));
}

/* Mass against which a member as drawn changes its length: 1 / sum |de/dq|^2 / m over its nodes. */
static double mass_of_length(const strut_model *model, size_t j) {
  const strut_scene *scene = model->scene;
  const strut_member *member = &scene->members[j];
  double sum = 0.0;
  for (size_t k = 0; k < member->guide_count + 2; k++) {
    int32_t node = strut_member_node(member, k);
    strut_vec2 d = {0.0, 0.0};
    if (k > 0) d = direction(scene, strut_member_node(member, k - 1), node);
    if (k <= member->guide_count) {
      strut_vec2 next = direction(scene, node, strut_member_node(member, k + 1));
      d.x -= next.x, d.y -= next.y;
    }
    sum += lightness(model, node, d);
  }
  return sum > 0.0 ? 1.0 / sum : 0.0;
}

static void damp_member(strut_model *model, size_t j, double more) {
  assert(j < (size_t)model->members.count);
  strut_member_table *members = &model->members;
  if (!(more > 0.0)) return;
  if (strut_member_is_element(&model->elements, (int32_t)j)) {
    ((strut_element *)strut_element_of_member(&model->elements, (int32_t)j))->damping += more;
    return;
  }
  ((double *)members->damping)[j] += more;
  uint16_t *terms = (uint16_t *)members->block_terms;
  terms[j / STRUT_BLOCK] = (uint16_t)(terms[j / STRUT_BLOCK] | STRUT_TERM_DAMPING);
  model->terms |= STRUT_TERM_DAMPING;
}

static double stiffness_of(const strut_model *model, size_t j) {
  assert(j < (size_t)model->members.count);
  const strut_element *e = strut_element_of_member(&model->elements, (int32_t)j);
  bool element = e && e->role == STRUT_ELEMENT_MEMBER;
  return fmax(0.0, element ? e->numbers.stiffness : model->members.stiffness[j]);
}

/* Adds the damping that ratios and Rayleigh's numbers give; after the weights of nodes are known. */
static void compile_damping(strut_model *model) {
  const strut_scene *scene = model->scene;
  double share = scene->rayleigh_stiffness;
  for (size_t j = 0; j < scene->member_count; j++) {
    double ratio = scene->members[j].damping_ratio, c = stiffness_of(model, j);
    if (ratio > 0.0) damp_member(model, j, 2.0 * ratio * sqrt(c * mass_of_length(model, j)));
    damp_member(model, j, share * c);
  }
  for (int32_t i = 0; i < model->elements.count && share > 0.0; i++) {
    strut_element *element = (strut_element *)&model->elements.element[i];
    if (element->role == STRUT_ELEMENT_HINGE)
      element->damping += share * fmax(0.0, element->numbers.stiffness);
  }
  model->mass_damping = scene->rayleigh_mass;
  if (model->mass_damping > 0.0) model->terms |= STRUT_TERM_MASS_DAMPING;
}

static bool compile_tables(strut_model *model) {
  if (!compile_nodes(model) || !compile_members(model) || !strut_elements_compile(model) ||
      !compile_drives(model) || !strut_sliding_masses_compile(model) || !compile_weights(model) ||
      !compile_loads(model) || !compile_contacts(model))
    return false;
  compile_damping(model);
  compile_unbalances(model);
  return strut_actuator_forces_compile(model) && strut_support_motion_compile(model) &&
         strut_feedback_compile(model) && compile_rubbing(model);
}

strut_status strut_model_compile(const strut_scene *scene, strut_model **result,
                                 strut_error *error) {
  *result = NULL;
  strut_model *model = strut_allocate(1, sizeof *model);
  if (!model) return strut_no_memory(error, "for the model");
  model->scene = scene;
  strut_status status = compile_tables(model) ? strut_mass_create(model, &model->mass, error)
                                              : strut_no_memory(error, "for the model");
  if (!status && strut_sliding_masses_solve(model))
    status = strut_no_memory(error, "for the model");
  if (status) {
    strut_model_free(model);
    return status;
  }
  if (model->mass && !model->mass->diagonal) model->terms |= STRUT_TERM_SOLVE;
  *result = model;
  return STRUT_OK;
}

void strut_model_free(strut_model *model) {
  if (!model) return;
  strut_mass_free(model->mass);
  strut_arena_free(&model->arena);
  strut_release(model);
}

strut_model_inputs strut_model_inputs_of(strut_model *model) {
  return (strut_model_inputs){
      .rest = (double *)model->members.rest,
      .stiffness = (double *)model->members.stiffness,
      .element = (strut_element *)model->elements.element,
      .element_stiffness = (double *)model->elements.stiffness,
      .drive_signal = (int32_t *)model->drives.signal,
      .actuator_force = (strut_actuator_force *)model->actuator_forces.item};
}

/* The lightest of nodes that are free to move [kg]. */
static double lightest_of(const strut_model *model, const uint32_t *at, int count) {
  double lightest = HUGE_VAL;
  for (int k = 0; k < count; k++)
    if (!(model->fixed[at[k]] && model->fixed[at[k] + 1]) && model->weight[at[k] / 2] > 0.0)
      lightest = fmin(lightest, model->weight[at[k] / 2]);
  return lightest;
}

double strut_model_fastest_spring(const strut_model *model) {
  const strut_member_table *members = &model->members;
  const strut_contact_table *contacts = &model->contacts;
  double square = 0.0;
  for (int32_t j = 0; j < members->count; j++)
    square = fmax(square,
                  members->stiffness[j] /
                      lightest_of(model, (const uint32_t[]){members->from[j], members->to[j]}, 2));
  for (int32_t i = 0; i < contacts->count; i++)
    square = fmax(square, contacts->entry[i].stiffness / lightest_of(model, &contacts->at[i], 1));
  return sqrt(square);
}
