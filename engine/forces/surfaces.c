/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/surfaces.h"

#include <math.h>

#include "engine/forces/elements.h"
#include "engine/forces/forces_kernel.h"
#include "engine/forces/nearby.h"
#include "engine/forces/strains/strains.h"
#include "engine/scene/friction.h"

/* Contacts of one node that touch: `count` indices, ascending. */
typedef struct touching {
  int32_t count, *contact;
} touching;

/* Normal forces of those contacts first .. end - 1, of one node, that touch. */
static touching push(const strut_model *model, const strut_state *state, const double *q,
                     const double *velocity, int32_t first, int32_t end) {
  const strut_contact_table *contacts = &model->contacts;
  touching all = {0, state->buffers->near};
  int32_t near = strut_contacts_near(contacts, first, end, q, state->latest->ground_motion, 0.0,
                                     state->buffers->near);
  for (int32_t k = 0; k < near; k++) {
    int32_t i = state->buffers->near[k];
    strut_contact_pose *pose = &state->latest->pose[i];
    *pose = strut_contact_pose_at(contacts, i, q, state->latest->ground_motion, -1);
    if (!(pose->gap < 0.0)) continue;
    const strut_contact_entry *contact = &contacts->entry[i];
    strut_vec2 u = strut_contact_velocity(contacts, i, velocity, state->latest->ground_motion);
    const strut_law_ground_numbers numbers = strut_contact_numbers(contact);
    double into = strut_component(pose->axes.normal, u.x, u.y);
    double spring = strut_law_ground_spring(&numbers, pose->gap);
    double normal = spring + strut_law_ground_damper(&numbers, spring, into, true);
    double *f = state->latest->force + contacts->at[i];
    f[0] += normal * pose->axes.normal[0], f[1] += normal * pose->axes.normal[1];
    state->latest->normal[i] = normal;
    state->latest->friction[i] = 0.0;
    all.contact[all.count++] = i;
  }
  return all;
}

static double slip_of(const strut_model *model, const strut_state *state, const double *velocity,
                      int32_t i) {
  assert(i >= 0 && i < model->contacts.count);
  const strut_contact_table *contacts = &model->contacts;
  strut_vec2 u = strut_contact_velocity(contacts, i, velocity, state->latest->ground_motion);
  return strut_component(state->latest->pose[i].axes.tangent, u.x, u.y) -
         strut_contact_belt(contacts, i);
}

/* Friction of contact i under the other forces on its node; returns its change. */
static double rub(const strut_model *model, const strut_state *state, const double *velocity,
                  int32_t i) {
  assert(i >= 0 && i < model->contacts.count);
  const strut_contact_table *contacts = &model->contacts;
  const strut_contact_entry *contact = strut_contact_entry_now(model, state, i);
  const double *t = state->latest->pose[i].axes.tangent;
  double *f = state->latest->force + contacts->at[i], before = state->latest->friction[i];
  if (contact->friction.law == STRUT_FRICTION_NONE) return 0.0;
  double applied = strut_component(t, f[0], f[1]) - before,
         slip = slip_of(model, state, velocity, i);
  double friction = ground_friction(contact, state->latest->normal[i], slip, applied, state->rigid);
  f[0] += (friction - before) * t[0], f[1] += (friction - before) * t[1];
  state->latest->friction[i] = friction;
  return friction - before;
}

static bool can_hold(const strut_model *model, const strut_state *state, int32_t i,
                     double friction) {
  assert(i >= 0 && i < model->contacts.count);
  const strut_friction *f = &strut_contact_entry_now(model, state, i)->friction;
  return fabs(friction) < strut_friction_static(f, -friction) * state->latest->normal[i];
}

/* Is contact i within its band, and does it hold against the other forces as they are now? */
static bool sticks(const strut_model *model, const strut_state *state, const double *velocity,
                   int32_t i) {
  assert(i >= 0 && i < model->contacts.count);
  const strut_friction *law = &strut_contact_entry_now(model, state, i)->friction;
  const double *t = state->latest->pose[i].axes.tangent,
               *f = state->latest->force + model->contacts.at[i];
  bool has_band = strut_friction_has_band(law->law);
  return has_band && fabs(slip_of(model, state, velocity, i)) < law->stick_velocity &&
         can_hold(model, state, i, state->latest->friction[i] - strut_component(t, f[0], f[1]));
}

static void set_friction(const strut_model *model, const strut_state *state, int32_t i,
                         double friction) {
  assert(i >= 0 && i < model->contacts.count);
  double *f = state->latest->force + model->contacts.at[i],
         change = friction - state->latest->friction[i];
  f[0] += change * state->latest->pose[i].axes.tangent[0],
      f[1] += change * state->latest->pose[i].axes.tangent[1];
  state->latest->friction[i] = friction;
}

/* The share of the way to `friction` at which contact i breaks loose; above 1: it does not. */
static double way_to_break(const strut_model *model, const strut_state *state, int32_t i,
                           double friction) {
  assert(i >= 0 && i < model->contacts.count);
  double change = friction - state->latest->friction[i], side = change < 0.0 ? -1.0 : 1.0;
  double bound = strut_friction_static(&strut_contact_entry_now(model, state, i)->friction, -side);
  double way = side * bound * state->latest->normal[i] - state->latest->friction[i];
  return change != 0.0 ? way / change : HUGE_VAL;
}

/*
 * Two contacts of a node that stick hold it together: their frictions balance the other forces in both
 * directions, or one of them breaks loose on the way there. One after the other they would go it the more
 * slowly the more alike their directions are.
 */
static void hold_together(const strut_model *model, const strut_state *state,
                          const double *velocity, int32_t a, int32_t b) {
  assert(a != b);
  const double *ta = state->latest->pose[a].axes.tangent, *tb = state->latest->pose[b].axes.tangent;
  const double *f = state->latest->force + model->contacts.at[a];
  double area = ta[0] * tb[1] - ta[1] * tb[0];
  double x = f[0] - state->latest->friction[a] * ta[0] - state->latest->friction[b] * tb[0];
  double y = f[1] - state->latest->friction[a] * ta[1] - state->latest->friction[b] * tb[1];
  if (fabs(area) < 1e-9) return;
  double by_a = -(x * tb[1] - y * tb[0]) / area, by_b = (x * ta[1] - y * ta[0]) / area;
  if (can_hold(model, state, a, by_a) && can_hold(model, state, b, by_b)) {
    set_friction(model, state, a, by_a);
    set_friction(model, state, b, by_b);
    return;
  }
  bool first = way_to_break(model, state, a, by_a) <= way_to_break(model, state, b, by_b);
  int32_t loose = first ? a : b;
  double side = (first ? by_a : by_b) < state->latest->friction[loose] ? -1.0 : 1.0;
  double kinetic =
      strut_friction_kinetic(&strut_contact_entry_now(model, state, loose)->friction, -side);
  set_friction(model, state, loose, side * kinetic * state->latest->normal[loose]);
  rub(model, state, velocity, first ? b : a);
}

/* The same of those two of all that stick whose directions differ most. */
static void hold_node(const strut_model *model, const strut_state *state, const double *velocity,
                      const touching *all) {
  int32_t a = -1, b = -1;
  double most = 0.0;
  for (int32_t k = 0; k < all->count; k++) {
    int32_t i = all->contact[k];
    if (!sticks(model, state, velocity, i)) continue;
    for (int32_t m = k + 1; m < all->count; m++) {
      int32_t j = all->contact[m];
      const double *ti = state->latest->pose[i].axes.tangent,
                   *tj = state->latest->pose[j].axes.tangent;
      double area = fabs(ti[0] * tj[1] - ti[1] * tj[0]);
      if (area > most && sticks(model, state, velocity, j)) most = area, a = i, b = j;
    }
  }
  if (a >= 0) hold_together(model, state, velocity, a, b);
}

/* Friction of all contacts of a node, until they agree. */
static void rub_all(const strut_model *model, const strut_state *state, const double *velocity,
                    const touching *all) {
  enum { MOST_SWEEPS = 60 };
  for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
    double changed = 0.0, largest = 0.0;
    for (int32_t k = 0; k < all->count; k++) {
      int32_t i = all->contact[k];
      changed = fmax(changed, fabs(rub(model, state, velocity, i)));
      largest = fmax(largest, fabs(state->latest->friction[i]));
    }
    if (changed <= 1e-15 * largest) return;
    hold_node(model, state, velocity, all);
  }
}

/* Damper, friction, and what the ground's own motion and belt give to the structure. */
static void accumulate(const strut_model *model, const strut_state *state, const double *velocity,
                       int32_t i) {
  assert(i >= 0 && i < model->contacts.count);
  const strut_contact_table *contacts = &model->contacts;
  const strut_contact_pose *pose = &state->latest->pose[i];
  const strut_ground_motion *own = strut_contact_motion(contacts, i, state->latest->ground_motion);
  strut_vec2 u = strut_contact_velocity(contacts, i, velocity, state->latest->ground_motion);
  double normal = state->latest->normal[i], friction = state->latest->friction[i];
  double into = strut_component(pose->axes.normal, u.x, u.y);
  double belt = strut_contact_belt(contacts, i),
         slip = strut_component(pose->axes.tangent, u.x, u.y) - belt;
  double moved = friction * belt;
  if (own)
    moved += normal * strut_component(pose->axes.normal, own->rate[0], own->rate[1]) +
             friction * strut_component(pose->axes.tangent, own->rate[0], own->rate[1]);
  double damped = -(normal + contacts->entry[i].stiffness * pose->gap) * into,
         rubbed = -friction * slip;
  state->latest->power[STRUT_POWER_CONTACT] += damped;
  state->latest->power[STRUT_POWER_FRICTION] += rubbed;
  state->latest->power[STRUT_POWER_BELT] += moved;
  state->latest->power[STRUT_POWER_EXCHANGED] += fabs(damped) + fabs(rubbed) + fabs(moved);
}

void strut_surfaces_add_forces(const strut_model *model, const strut_state *state,
                               const double *restrict q, const double *restrict velocity) {
  const strut_contact_table *contacts = &model->contacts;
  for (int32_t first = 0, end; first < contacts->count; first = end) {
    end = strut_contacts_end_of_node(contacts, first);
    const touching all = push(model, state, q, velocity, first, end);
    if (all.count == 1)
      rub(model, state, velocity, all.contact[0]);
    else if (all.count)
      rub_all(model, state, velocity, &all);
    for (int32_t k = 0; k < all.count && state->balance; k++)
      accumulate(model, state, velocity, all.contact[k]);
  }
}

void strut_contact_observe(const strut_contact_table *contacts, int32_t i, const strut_state *state,
                           double *gap, double *slip) {
  const strut_contact_pose pose =
      strut_contact_pose_at(contacts, i, state->q, state->latest->ground_motion, -1);
  strut_vec2 u = strut_contact_velocity(contacts, i, state->v, state->latest->ground_motion);
  *gap = pose.gap;
  *slip = strut_component(pose.axes.tangent, u.x, u.y) - strut_contact_belt(contacts, i);
}

static void slide_foot(const strut_element *element, const uint32_t *at, const double *q,
                       double *b) {
  const strut_foot_pose pose =
      strut_foot_pose_of(at, element->nodes, q, element->axis, element->radius);
  /* the tangent is to the right of the normal; rolling, the middle moves as the member turns */
  double tx = pose.ny, ty = -pose.nx, roll = pose.turn * (1.0 - pose.along);
  b[2] = -roll * pose.uy, b[3] = roll * pose.ux;
  b[0] = tx - b[2], b[1] = ty - b[3];
}

int32_t strut_rubbing_slide(const strut_model *model, int32_t item, const double *q,
                            double b[STRUT_MOST_RUBBING]) {
  assert(item >= 0 && item < model->rubbing.count);
  int32_t element = model->rubbing.item[item].element;
  const strut_element *e = &model->elements.element[element];
  double across[STRUT_MOST_GRADIENT];
  if (e->strain == STRUT_STRAIN_FOOT) {
    slide_foot(e, model->elements.at + e->first, q, b);
    return e->nodes;
  }
  /* along the surfaces the nodes have the shares that they have across them */
  strut_element_strain(model, element, q, 0.0, across);
  for (int32_t k = 0; k < e->nodes; k++)
    b[2 * k] = across[2 * k + 1], b[2 * k + 1] = -across[2 * k];
  return e->nodes;
}

/* An entry at q and v: how it slides, and the forces normal to the surfaces and along them. */
typedef struct rubbing_forces {
  int32_t nodes; /* 0: it does not touch */
  double slide[STRUT_MOST_RUBBING], slip, normal, friction;
  double bend_rate; /* of bristles [1/s] */
} rubbing_forces;

/* Bristles at the bend y that slip; where nothing presses, or nothing rubs, their own damper straightens them. */
static void bend_bristles(const strut_friction *friction, double y, rubbing_forces *self) {
  const strut_law_friction_numbers numbers = strut_friction_numbers(friction);
  bool bends = self->nodes && friction->mu_static > 0.0;
  self->bend_rate =
      bends ? strut_law_friction_bristle_rate(&numbers, self->slip, y) : -y / friction->relaxation;
  self->friction = bends ? -self->normal * (y + friction->relaxation * self->bend_rate) : 0.0;
}

static rubbing_forces forces_of(const strut_model *model, const strut_state *state, int32_t item,
                                const double *q, const double *velocity) {
  const strut_rubbing_entry *entry = &model->rubbing.item[item];
  const uint32_t *at = model->elements.at + model->elements.element[entry->element].first;
  strut_element_pose pose;
  rubbing_forces r = {
      .normal = -strut_element_measure_at(model, state, entry->element, q, velocity, &pose)};
  if (!(r.normal > 0.0)) {
    r = (rubbing_forces){.nodes = 0};
    if (entry->bend >= 0) bend_bristles(&entry->friction, velocity[entry->bend], &r);
    return r;
  }
  r.nodes = strut_rubbing_slide(model, item, q, r.slide);
  for (int32_t k = 0; k < 2 * r.nodes; k++)
    r.slip += r.slide[k] * velocity[at[k / 2] + (uint32_t)(k % 2)];
  r.slip -= entry->belt_speed;
  if (entry->bend >= 0)
    bend_bristles(&entry->friction, velocity[entry->bend], &r);
  else
    r.friction = strut_friction_force(&entry->friction, r.normal, r.slip, 0.0);
  return r;
}

double strut_rubbing_slip(const strut_model *model, const strut_state *state, int32_t item,
                          double *normal) {
  rubbing_forces r = forces_of(model, state, item, state->q, state->v);
  *normal = r.nodes ? r.normal : 0.0;
  return r.slip;
}

static void add_entry(const strut_model *model, const strut_state *state, int32_t item,
                      const double *q, const double *velocity) {
  const strut_rubbing_entry *entry = &model->rubbing.item[item];
  const uint32_t *at = model->elements.at + model->elements.element[entry->element].first;
  if (entry->friction.law == STRUT_FRICTION_NONE) return;
  rubbing_forces r = forces_of(model, state, item, q, velocity);
  if (entry->bend >= 0) state->latest->force[entry->bend] = r.bend_rate;
  for (int32_t k = 0; k < 2 * r.nodes; k++)
    state->latest->force[at[k / 2] + (uint32_t)(k % 2)] += r.friction * r.slide[k];
  if (!state->balance) return;
  double lost = -r.friction * r.slip, belt = r.friction * entry->belt_speed;
  strut_power_add_two(state->latest->power, STRUT_POWER_FRICTION, lost, STRUT_POWER_BELT, belt);
}

void strut_rubbing_add_forces(const strut_model *model, const strut_state *state, const double *q,
                              const double *velocity) {
  const strut_rubbing_table *table = &model->rubbing;
  if (!model->elements.scattered) {
    for (int32_t i = 0; i < table->count; i++) add_entry(model, state, i, q, velocity);
    return;
  }
  const strut_nearby *near = strut_nearby_at(model, state, q);
  for (int32_t k = 0; k < near->count; k++) {
    int32_t i = table->of_element[near->element[k]];
    if (i >= 0) add_entry(model, state, i, q, velocity);
  }
}

double strut_rubbing_bristle_decay(const strut_model *model, const strut_state *state,
                                   int32_t item) {
  assert(item >= 0 && item < model->rubbing.count);
  const strut_rubbing_entry *entry = &model->rubbing.item[item];
  if (entry->bend < 0) return 0.0;
  const strut_law_friction_numbers numbers = strut_friction_numbers(&entry->friction);
  rubbing_forces r = forces_of(model, state, item, state->q, state->v);
  return r.nodes ? strut_law_friction_bristle_decay(&numbers, r.slip)
                 : 1.0 / entry->friction.relaxation;
}

void strut_rubbing_show_feet(const strut_model *model, const strut_state *state, const double *q,
                             const double *velocity) {
  for (int32_t i = 0; i < model->rubbing.count; i++) {
    int32_t contact = model->rubbing.item[i].contact;
    if (contact < 0) continue;
    rubbing_forces r = forces_of(model, state, i, q, velocity);
    state->latest->normal[contact] = r.normal;
    state->latest->friction[contact] = r.friction;
  }
}
