/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <string.h>

#include "engine/base/indices.h"
#include "engine/model/compile_parts.h"
#include "engine/model/mass.h"
#include "engine/scene/signal.h"

int32_t strut_foot_of_contact(const strut_scene *scene, size_t i) {
  for (size_t f = 0; f < scene->foot_count; f++)
    if (scene->feet[f].node == scene->contacts[i].node) return (int32_t)f;
  return -1;
}

bool strut_contact_is_element(const strut_scene *scene, size_t i) {
  return strut_friction_has_bristles(scene->contacts[i].friction.law) ||
         strut_foot_of_contact(scene, i) >= 0;
}

size_t strut_bristle_count(const strut_scene *scene) {
  size_t count = 0;
  for (size_t i = 0; i < scene->contact_count; i++)
    count += strut_friction_has_bristles(scene->contacts[i].friction.law);
  return count;
}

/* Friction that sticks has no stick here: within its band it grows with the speed. */
static strut_friction friction_of(const strut_friction *friction) {
  strut_friction own = *friction;
  if (friction->law != STRUT_FRICTION_KARNOPP) return own;
  own.law = STRUT_FRICTION_SMOOTH;
  own.width = friction->stick_velocity;
  return own;
}

/* The place of a foot on the straight ground of contact i. */
static void place_element(const strut_contact_table *contacts, int32_t i, strut_element *element) {
  strut_contact_axes axes = contacts->axes;
  double point[2] = {0.0, contacts->height};
  if (contacts->surface) {
    const strut_facet *line = contacts->surface[contacts->surface_of[i]].facet;
    axes = line->axes;
    point[0] = line->point[0], point[1] = line->point[1];
  }
  double nx = axes.normal[0], ny = axes.normal[1];
  element->axis = tan(0.5 * atan2(ny, nx));
  element->natural = nx * point[0] + ny * point[1] + element->radius;
}

/* Friction of element k, instead of the contact of its node, which touches nothing any more. */
static strut_rubbing_entry take_contact(strut_model *model, int32_t k) {
  strut_contact_table *contacts = &model->contacts;
  strut_element *element = (strut_element *)&model->elements.element[k];
  int32_t i = element->contact;
  strut_contact_entry *entry = (strut_contact_entry *)&contacts->entry[i];
  place_element(contacts, i, element);
  bool bristles = strut_friction_has_bristles(entry->friction.law);
  const strut_feedback_table *feedback = &model->feedback;
  int32_t bend =
      feedback->base + feedback->state_count - feedback->bristle_count + model->rubbing.bristles;
  model->rubbing.bristles += bristles;
  const strut_rubbing_entry item = {k, i, bristles ? bend : -1,
                                    contacts->surface
                                        ? contacts->surface[contacts->surface_of[i]].belt_speed
                                        : contacts->belt_speed,
                                    friction_of(&entry->friction)};
  entry->stiffness = entry->damping = entry->dissipation = 0.0;
  entry->friction = (strut_friction){STRUT_FRICTION_NONE};
  return item;
}

bool strut_collisions_rub(const strut_scene *scene) {
  for (size_t i = 0; i < scene->collision_count; i++)
    if (scene->collisions[i].friction.mu_kinetic > 0.0) return true;
  return false;
}

/* Smooth friction, or with a coefficient that falls from the static one, Stribeck's. */
static strut_friction friction_of_collision(const strut_collision *collision) {
  strut_friction own = collision->friction;
  own.law = own.decay_velocity > 0.0 ? STRUT_FRICTION_STRIBECK : STRUT_FRICTION_SMOOTH;
  return own;
}

bool strut_rubbing_compile(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_rubbing_entry *item =
      strut_arena_allocate(&model->arena, (size_t)model->elements.count, sizeof *item);
  int32_t *of = strut_arena_allocate(&model->arena, (size_t)model->elements.count, sizeof *of);
  int32_t *at_contact =
      strut_arena_allocate(&model->arena, (size_t)model->contacts.count, sizeof *at_contact);
  if (!item || !of || !at_contact) return false;
  for (int32_t i = 0; i < model->contacts.count; i++) at_contact[i] = -1;
  for (int32_t k = 0; k < model->elements.count; k++) {
    int32_t before = model->rubbing.count;
    const strut_element *element = &model->elements.element[k];
    const strut_collision *collision =
        element->role == STRUT_ELEMENT_COLLISION ? &scene->collisions[element->item] : NULL;
    if (element->strain == STRUT_STRAIN_FOOT) item[model->rubbing.count++] = take_contact(model, k);
    if (collision && collision->friction.mu_kinetic > 0.0)
      item[model->rubbing.count++] =
          (strut_rubbing_entry){k, -1, -1, 0.0, friction_of_collision(collision)};
    of[k] = model->rubbing.count > before ? before : -1;
    if (of[k] >= 0 && item[before].contact >= 0) at_contact[item[before].contact] = before;
  }
  model->rubbing.item = item, model->rubbing.of_element = of;
  model->rubbing.of_contact = at_contact;
  if (model->rubbing.count) model->terms |= STRUT_TERM_RUBBING;
  return true;
}

/* Entries of an answer below this part of its largest one change no bit that matters. */
static const double NEGLIGIBLE = 1e-18;

bool strut_sliding_masses_compile(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_sliding_table *table = &model->sliding;
  size_t count = scene->sliding_count;
  if (!count) return true;
  strut_sliding_item *item = strut_arena_allocate(&model->arena, count, sizeof *item);
  int32_t *moving = strut_arena_allocate(&model->arena, count, sizeof *moving);
  if (!item || !moving) return false;
  for (size_t i = 0; i < count; i++) {
    const strut_sliding_mass *mass = &scene->sliding_masses[i];
    const int32_t *node = scene->members[mass->member].node;
    item[i] = (strut_sliding_item){.member = mass->member,
                                   .at = {2 * (uint32_t)node[0], 2 * (uint32_t)node[1]},
                                   .mass = mass->mass,
                                   .start = strut_sliding_mass_share(scene, i, 0.0),
                                   .base = mass->share,
                                   .scale = strut_sliding_mass_scale(scene, i),
                                   .signal = mass->signal};
    if (mass->signal < 0) continue;
    moving[table->moving_count++] = (int32_t)i;
    table->corners = table->corners || strut_signal_has_corners(scene->signals, mass->signal);
    model->terms |= STRUT_TERM_SLIDING_MASS;
  }
  table->count = (int32_t)count;
  table->item = item;
  table->moving = moving;
  return true;
}

static bool keep_answer(strut_model *model, double *const *column, strut_sliding_answer *answer) {
  double most = 0.0;
  int32_t end = 2 * model->node_count, count = 0;
  for (int32_t k = 0; k < end; k++) most = fmax(most, fmax(fabs(column[0][k]), fabs(column[1][k])));
  uint32_t *at = strut_arena_allocate(&model->arena, (size_t)model->node_count, sizeof *at);
  if (!at) return false;
  for (int32_t k = 0; k < end; k += 2) {
    bool any = false;
    for (int c = 0; c < 4; c++) any = any || fabs(column[c / 2][k + c % 2]) > NEGLIGIBLE * most;
    if (any) at[count++] = (uint32_t)k;
  }
  double *xy = strut_arena_allocate(&model->arena, 4 * (size_t)count, sizeof *xy);
  for (int32_t k = 0; xy && k < count; k++)
    for (int c = 0; c < 4; c++) xy[4 * k + c] = column[c / 2][at[k] + (uint32_t)(c % 2)];
  *answer = (strut_sliding_answer){count, at, xy};
  return xy;
}

/* Entries of M^-1 between the nodes of moving mass l and those of all others, by its columns. */
static void keep_entries(const strut_sliding_table *table, int32_t l, double *const *column,
                         double *between) {
  int32_t n = 2 * table->moving_count;
  for (int32_t i = 0; i < n; i++)
    for (int32_t e = 0; e < 2; e++)
      for (int32_t c = 0; c < 2; c++)
        between[(c * n + i) * n + 2 * l + e] =
            column[e][table->item[table->moving[i / 2]].at[i % 2] + (uint32_t)c];
}

double strut_sliding_moment(const strut_model *model, double t, int axis, const double *positions) {
  const strut_sliding_table *table = &model->sliding;
  double sum = 0.0;
  for (int32_t k = 0; k < table->moving_count; k++) {
    const strut_sliding_item *item = &table->item[table->moving[k]];
    double span = positions[item->at[1] + (uint32_t)axis] - positions[item->at[0] + (uint32_t)axis];
    double share = strut_sliding_mass_share(model->scene, (size_t)table->moving[k], t);
    sum += item->mass * (share - item->start) * span;
  }
  return sum;
}

strut_status strut_sliding_masses_solve(strut_model *model) {
  strut_sliding_table *table = &model->sliding;
  size_t count = (size_t)table->moving_count, length = (size_t)model->length;
  if (!count || !model->mass) return STRUT_OK;
  strut_sliding_answer *answer = strut_arena_allocate(&model->arena, count, sizeof *answer);
  double *between = strut_arena_allocate(&model->arena, 8 * count * count, sizeof *between);
  double *scratch = strut_allocate(4 * length, sizeof *scratch);
  bool good = answer && between && scratch;
  for (int32_t l = 0; l < table->moving_count && good; l++) {
    double *column[2] = {scratch, scratch + length}, *force = scratch + 2 * length;
    for (int e = 0; e < 2; e++) { /* columns of M^-1 for both coordinates of a node */
      uint32_t at = table->item[table->moving[l]].at[e];
      memset(force, 0, length * sizeof *force);
      force[at] = force[at + 1] = 1.0;
      strut_mass_solve(model, force, column[e], force + length);
    }
    good = keep_answer(model, column, &answer[l]);
    keep_entries(table, l, column, between);
  }
  strut_release(scratch);
  table->answer = answer;
  table->between = between;
  return good ? STRUT_OK : STRUT_NO_MEMORY;
}

/* Index of the moved coordinate at a place, or NONE. */
enum { NONE = -1 };

static void add_coupling(strut_model *model, strut_support_coupling *list, int32_t item,
                         uint32_t other, double mass) {
  strut_support_motion_table *table = &model->support_motion;
  if (item == NONE || model->fixed[other]) return;
  list[table->coupling_count++] = (strut_support_coupling){item, (int32_t)other, mass};
  table->corners =
      table->corners || strut_signal_has_corners(model->scene->signals, table->item[item].signal);
}

static bool add_couplings(strut_model *model) {
  const strut_member_table *members = &model->members;
  strut_support_motion_table *table = &model->support_motion;
  size_t most = 4 * (size_t)members->count, length = (size_t)model->length;
  strut_support_coupling *list = strut_arena_allocate(&model->arena, most, sizeof *list);
  int32_t *item_at = strut_allocate(length, sizeof *item_at);
  if (!list || !item_at) {
    strut_release(item_at);
    return false;
  }
  for (size_t i = 0; i < length; i++) item_at[i] = NONE;
  for (int32_t i = 0; i < table->count; i++) item_at[table->item[i].at] = i;
  for (int32_t j = 0; j < members->count; j++)
    for (uint32_t c = 0; c < 2 && members->mass[j] > 0.0; c++) {
      uint32_t a = members->from[j] + c, b = members->to[j] + c;
      add_coupling(model, list, item_at[a], b, members->mass[j] / 6.0);
      add_coupling(model, list, item_at[b], a, members->mass[j] / 6.0);
    }
  table->coupling = list;
  strut_release(item_at);
  return true;
}

bool strut_support_motion_compile(strut_model *model) {
  const strut_scene *scene = model->scene;
  size_t count = scene->support_motion_count;
  if (!count) return true;
  strut_moved_coordinate *item = strut_arena_allocate(&model->arena, count, sizeof *item);
  if (!item) return false;
  for (size_t i = 0; i < count; i++) {
    const strut_support_motion *motion = &scene->support_motions[i];
    double value, rate;
    item[i] = (strut_moved_coordinate){.at = 2 * motion->node + motion->axis,
                                       .signal = motion->signal,
                                       .base = scene->nodes[motion->node].start[motion->axis]};
    strut_signal_evaluate(scene->signals, motion->signal, 0.0, &value, &rate);
    ((double *)model->start)[item[i].at] = item[i].base + value;
    ((double *)model->velocity)[item[i].at] = rate;
  }
  model->support_motion = (strut_support_motion_table){.count = (int32_t)count, .item = item};
  model->terms |= STRUT_TERM_SUPPORT_MOTION;
  return scene->mass_model != STRUT_MASS_CONSISTENT || add_couplings(model);
}

strut_column strut_column_find(const strut_model *model, strut_column column, int32_t near) {
  static const strut_element_role roles[STRUT_OWNER_COUNT] = {
      [STRUT_OWNER_HINGE] = STRUT_ELEMENT_HINGE,
      [STRUT_OWNER_CELL] = STRUT_ELEMENT_CELL,
      [STRUT_OWNER_COLLISION] = STRUT_ELEMENT_COLLISION,
      [STRUT_OWNER_DISTANCE] = STRUT_ELEMENT_DISTANCE};
  const strut_contact_table *contacts = &model->contacts;
  strut_channel_owner owner = strut_observable_at(column.kind)->owner;
  if (roles[owner])
    column.item = strut_element_find_near(&model->elements, roles[owner], column.item, near);
  if (owner != STRUT_OWNER_CONTACT) return column;
  int32_t first = 0;
  while (first < contacts->count && contacts->entry[first].node != column.item) first++;
  int32_t end = first;
  while (end < contacts->count && contacts->at[end] == contacts->at[first]) end++;
  column.item = first, column.other = end;
  return column;
}

size_t strut_feedback_states(const strut_scene *scene) {
  size_t count = scene->state_count;
  for (size_t i = 0; i < scene->signal_count; i++) count += scene->signals[i].lag > 0.0;
  for (size_t i = 0; i < scene->member_count; i++)
    count += scene->members[i].maxwell.stiffness > 0.0;
  return count + strut_bristle_count(scene);
}

static bool compile_maxwell(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_feedback_table *feedback = &model->feedback;
  size_t count = 0;
  for (size_t i = 0; i < scene->member_count; i++)
    count += scene->members[i].maxwell.stiffness > 0.0;
  strut_maxwell_entry *entry = strut_arena_allocate(&model->arena, count, sizeof *entry);
  if (!entry) return false;
  for (size_t i = 0; i < scene->member_count; i++) {
    const strut_maxwell *maxwell = &scene->members[i].maxwell;
    if (!(maxwell->stiffness > 0.0)) continue;
    int32_t state = (int32_t)scene->state_count + feedback->lag_count + feedback->maxwell_count;
    double damping = maxwell->time > 0.0 ? maxwell->stiffness * maxwell->time : maxwell->damping;
    entry[feedback->maxwell_count++] =
        (strut_maxwell_entry){(int32_t)i, state, maxwell->stiffness, damping};
    ((double *)model->velocity)[feedback->base + state] = maxwell->force;
  }
  feedback->maxwell = entry;
  return true;
}

static bool compile_sensors(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_feedback_table *feedback = &model->feedback;
  strut_column *sensor = strut_arena_allocate(&model->arena, scene->sensor_count, sizeof *sensor);
  if (!sensor) return false;
  for (size_t i = 0; i < scene->sensor_count; i++) {
    sensor[i] = strut_column_find(model, strut_sensor_column(&scene->sensors[i]), 0);
    if (strut_column_needs_drives(sensor[i])) feedback->needs_drives = true;
  }
  feedback->count = (int32_t)scene->sensor_count;
  feedback->sensor = sensor;
  return true;
}

bool strut_feedback_compile(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_feedback_table *feedback = &model->feedback;
  size_t signals = scene->signal_count;
  int32_t *lagged, *lag_of, *sampled, *triggered, *relay;
  if (!STRUT_ALLOCATE(&model->arena, STRUT_NEW(lagged, signals), STRUT_NEW(lag_of, signals),
                      STRUT_NEW(sampled, signals), STRUT_NEW(triggered, signals),
                      STRUT_NEW(relay, signals)) ||
      !compile_sensors(model))
    return false;
  for (size_t i = 0; i < signals; i++) {
    const strut_signal *signal = &scene->signals[i];
    lag_of[i] = signal->lag > 0.0 ? (int32_t)scene->state_count + feedback->lag_count : -1;
    if (signal->lag > 0.0) lagged[feedback->lag_count++] = (int32_t)i;
    if (signal->trigger.kind != STRUT_TRIGGER_NONE)
      triggered[feedback->trigger_count++] = (int32_t)i;
    if (signal->every > 0.0)
      sampled[feedback->sampled_count++] = (int32_t)i;
    else if (signal->kind == STRUT_RELAY)
      relay[feedback->relay_count++] = (int32_t)i;
  }
  feedback->lagged = lagged, feedback->lag_of = lag_of, feedback->sampled = sampled,
  feedback->triggered = triggered;
  feedback->relay = relay;
  feedback->state_count = (int32_t)strut_feedback_states(scene);
  feedback->bristle_count = (int32_t)strut_bristle_count(scene);
  feedback->base = 2 * model->node_count + 2;
  if (!compile_maxwell(model)) return false;
  double *velocity = (double *)model->velocity;
  for (size_t i = 0; i < scene->state_count; i++)
    velocity[(size_t)feedback->base + i] = scene->states[i].start;
  for (int32_t i = 0; i < feedback->state_count; i++)
    ((uint8_t *)model->fixed)[feedback->base + i] = 1;
  if (feedback->count || feedback->state_count || feedback->sampled_count ||
      feedback->trigger_count || feedback->relay_count)
    model->terms |= STRUT_TERM_FEEDBACK;
  return true;
}

static void connect_nodes(const strut_model *model, int32_t *parent) {
  for (int32_t i = 0; i < model->node_count; i++) parent[i] = i;
  for (int32_t j = 0; j < model->members.count; j++) {
    int32_t a = (int32_t)model->members.from[j] / 2, b = (int32_t)model->members.to[j] / 2;
    parent[strut_index_root(parent, a)] = strut_index_root(parent, b);
  }
  for (int32_t j = 0; j < model->elements.count; j++) {
    const uint32_t *at = model->elements.at + model->elements.element[j].first;
    for (int32_t k = 1; k < model->elements.element[j].nodes; k++)
      parent[strut_index_root(parent, (int32_t)at[0] / 2)] =
          strut_index_root(parent, (int32_t)at[k] / 2);
  }
}

void strut_connected_parts_find(const strut_model *model, const double *force, int32_t *part_of,
                                strut_connected_part *part) {
  connect_nodes(model, part_of);
  for (int32_t i = 0; i < model->node_count; i++) {
    strut_connected_part *connected_part = &part[part_of[i] = strut_index_root(part_of, i)];
    for (int c = 0; c < 2; c++) {
      connected_part->held[c] = connected_part->held[c] || model->fixed[2 * i + c];
      if (!model->fixed[2 * i + c]) connected_part->force[c] += force[2 * i + c];
    }
  }
  for (int32_t i = 0; i < model->contacts.count; i++)
    part[part_of[model->contacts.entry[i].node]].touches = true;
}
