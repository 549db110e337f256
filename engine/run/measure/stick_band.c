/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/stick_band.h"

#include <math.h>

#include "engine/forces/sliding_masses.h"
#include "engine/forces/surfaces.h"
#include "engine/model/mass.h"
#include "engine/model/pose.h"
#include "engine/model/surface_search.h"

/* Samples per solved acceleration; fewest of those for a mean. */
enum { ACCELERATION_INTERVAL = 4, LEAST_SAMPLES = 4 };
/*
 * Parts of |a| dt below which a band is too narrow. The band has its width on both sides of zero,
 * so that one of half of |a| dt is always met. Where static friction is no stronger than kinetic
 * friction, a node that passes over the band is turned back until it meets it and then rests; not
 * so once that takes a hundred turns. Where static friction is stronger, it only holds a node that
 * meets the band at once.
 */
static const double ALWAYS_MISSED = 0.5, MET_BY_CHANCE = 0.01;

/* Part of the static friction of a node that strain from creeping may reach before it matters. */
static const double STRAINED = 0.1;

static bool has_band(const strut_contact_entry *e) {
  return strut_friction_has_band(e->friction.law);
}

static bool is_stronger_at_rest(const strut_contact_entry *e) {
  return has_band(e) && strut_friction_drops(&e->friction);
}

/* Contact with stronger static friction at a coordinate, or -1; contacts are in ascending order. */
static int32_t contact_at(const strut_contact_table *c, uint32_t coordinate) {
  int32_t low = 0, high = c->count;
  while (low < high) {
    int32_t middle = low + (high - low) / 2;
    if (c->at[middle] < coordinate)
      low = middle + 1;
    else
      high = middle;
  }
  bool found = low < c->count && c->at[low] == coordinate;
  return found && is_stronger_at_rest(&c->entry[low]) ? low : -1;
}

/* Counts the ties; fills them if `ties` is given. */
static int32_t list_ties(const strut_model *model, strut_band_tie *ties) {
  const strut_member_table *t = &model->members;
  int32_t count = 0;
  for (int32_t j = 0; j < t->count; j++) {
    int32_t a = contact_at(&model->contacts, t->from[j]),
            b = contact_at(&model->contacts, t->to[j]);
    if (a < 0 || b < 0) continue;
    if (ties) ties[count] = (strut_band_tie){.member = j, .contact = {a, b}};
    count++;
  }
  return count;
}

/* Does a contact touch, with a slip velocity within its band? *normal: its normal force. */
static bool is_stuck(const strut_model *model, const strut_state *state, int32_t i,
                     double *normal) {
  const strut_contact_table *c = &model->contacts;
  double gap, slip;
  strut_contact_observe(c, i, state, &gap, &slip);
  *normal = -gap * c->entry[i].stiffness;
  return gap < 0.0 && fabs(slip) < c->entry[i].friction.stick_velocity;
}

/* Of a member at the present rest length, where that matters. */
static double stiffness_of(const strut_model *model, const strut_state *state, int32_t member) {
  const strut_element *e = strut_element_of_member(&model->elements, member);
  if (!e || e->law != STRUT_LAW_AXIAL) return model->members.stiffness[member];
  return e->numbers.axial / strut_axial_length(&e->numbers, state->rest[member]);
}

static void sample_tie(const strut_model *model, const strut_state *state, double time,
                       strut_band_tie *tie) {
  const strut_member_table *t = &model->members;
  const strut_contact_entry *e = model->contacts.entry;
  double length = strut_member_length(t, tie->member, state->q), change = length - tie->length,
         normal[2];
  double creep = 0.0, resistance = HUGE_VAL;
  bool held = true;
  for (int k = 0; k < 2; k++) {
    const strut_contact_entry *one = &e[tie->contact[k]];
    held = is_stuck(model, state, tie->contact[k], &normal[k]) && held;
    creep += one->friction.stick_velocity * time;
    double least = fmin(strut_friction_static(&one->friction, 1.0),
                        strut_friction_static(&one->friction, -1.0));
    resistance = fmin(resistance, least * normal[k]);
  }
  /* a larger change means that one of them has slid */
  if (held && tie->held && fabs(change) <= creep)
    tie->force += stiffness_of(model, state, tie->member) * change;
  else
    tie->force = 0.0;
  if (held && fabs(tie->force) > tie->worst * resistance)
    tie->worst = fabs(tie->force) / resistance;
  tie->held = held, tie->length = length;
}

double strut_stick_band_needed(const strut_model *model, const strut_integrator *method,
                               int32_t contact, double step) {
  const strut_contact_table *c = &model->contacts;
  const strut_contact_entry *e = &c->entry[contact];
  const double *g = model->scene->gravity;
  if (method->events || !has_band(e) || !(strut_friction_largest(&e->friction) > 0.0)) return 0.0;
  double down = -(g[0] * c->normal[0] + g[1] * c->normal[1]);
  if (c->surface) down = hypot(g[0], g[1]);
  return down > 0.0 && step > 0.0 ? strut_friction_largest(&e->friction) * down * step : 0.0;
}

bool strut_stick_band_create(const strut_model *model, strut_state *state,
                             const strut_integrator *method, double step, strut_stick_band *band) {
  bool any = false;
  *band = (strut_stick_band){.step = step};
  for (int32_t i = 0; i < model->contacts.count; i++)
    any = any || (has_band(&model->contacts.entry[i]) &&
                  strut_friction_largest(&model->contacts.entry[i].friction) > 0.0);
  if (!any || method->events) return true;
  size_t length = (size_t)model->length, contacts = (size_t)model->contacts.count;
  band->a = strut_arena_allocate(&state->arena, length, sizeof(double));
  band->scratch = strut_arena_allocate(&state->arena, length, sizeof(double));
  band->contacts = strut_arena_allocate(&state->arena, contacts, sizeof *band->contacts);
  band->tie_count = list_ties(model, NULL);
  band->ties = strut_arena_allocate(&state->arena, (size_t)band->tie_count, sizeof *band->ties);
  if (band->ties) list_ties(model, band->ties);
  return band->a && band->scratch && band->contacts && band->ties;
}

void strut_stick_band_sample(const strut_model *model, const strut_state *state,
                             strut_stick_band *band) {
  const strut_contact_table *c = &model->contacts;
  if (!band->contacts) return;
  double time = (double)(state->step - band->last) * band->step;
  for (int32_t k = 0; k < band->tie_count; k++) sample_tie(model, state, time, &band->ties[k]);
  band->last = state->step;
  bool with_acceleration = band->samples++ % ACCELERATION_INTERVAL == 0 && state->evaluations > 0;
  if (with_acceleration) strut_mass_solve(model, state->force, band->a, band->scratch);
  if (with_acceleration && model->plan & STRUT_TERM_SLIDING_MASS)
    strut_sliding_masses_correct(model, state, band->a);
  int32_t count = c->surface ? strut_contacts_all_near(c, state->q, NULL, state->near) : c->count;
  for (int32_t k = 0; k < count; k++) {
    int32_t i = c->surface ? state->near[k] : k;
    strut_stick_band_monitor *w = &band->contacts[i];
    if (!(strut_contact_gap(c, i, state->q) < 0.0)) continue;
    if (!with_acceleration ||
        fabs(strut_contact_slip(c, i, state->v)) < c->entry[i].friction.stick_velocity)
      continue;
    w->sliding++;
    w->change += band->step * fabs(strut_contact_along_ground(c, i, band->a));
  }
}

double strut_stick_band_missed(const strut_model *model, const strut_stick_band *band,
                               int32_t contact) {
  const strut_contact_entry *e = &model->contacts.entry[contact];
  if (!band->contacts || !has_band(e)) return 0.0;
  const strut_stick_band_monitor *w = &band->contacts[contact];
  double needed = w->sliding >= LEAST_SAMPLES ? w->change / w->sliding : 0.0;
  double least = strut_friction_drops(&e->friction) ? ALWAYS_MISSED : MET_BY_CHANCE;
  return e->friction.stick_velocity < least * needed ? needed : 0.0;
}

const strut_band_tie *strut_stick_band_strained(const strut_stick_band *band) {
  const strut_band_tie *most = NULL;
  for (int32_t k = 0; k < band->tie_count; k++)
    if (band->ties[k].worst > STRAINED && (!most || band->ties[k].worst > most->worst))
      most = &band->ties[k];
  return most;
}
