/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/events/small/small_modes.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

#include "engine/integrate/events/event_kernel.h"

strut_status strut_small_modes_create(const strut_model *model, strut_state *state,
                                      strut_event_stepper *l) {
  if (!model->small) return STRUT_OK;
  l->small = strut_arena_allocate(&state->arena, 1, sizeof *l->small);
  return l->small ? STRUT_OK : STRUT_NO_MEMORY;
}

/* Does the kernel of small models know friction in this mode? */
static bool is_known(uint8_t mode) {
  switch ((strut_contact_mode)mode) {
    case STRUT_MODE_OPEN:
    case STRUT_MODE_SLIP:
    case STRUT_MODE_STICK:
    case STRUT_MODE_BAND:
    case STRUT_MODE_PUSH:
    case STRUT_MODE_CREEP:
    case STRUT_MODE_SLIDE: return true;
    case STRUT_MODE_YIELD: break;
  }
  return false;
}

static int64_t mask_of(bool holds) { return holds ? -1 : 0; }

/* A closed contact, at the lane of its node. */
static void list_contact(const strut_model *model, const strut_event_stepper *l, int32_t i,
                         strut_small_modes *m) {
  assert(i >= 0 && i < model->contacts.count);
  const strut_contact_entry *e = &model->contacts.entry[i];
  int32_t n = e->node;
  uint8_t mode = l->mode[i];
  double s = l->side[i], kinetic = strut_friction_kinetic(&e->friction, s);
  bool slips = mode == STRUT_MODE_SLIP || mode == STRUT_MODE_PUSH;
  m->mask.closed[n] = -1;
  m->mask.rubs[n] = mask_of(slips);
  m->mask.slips[n] = mask_of(mode == STRUT_MODE_SLIP);
  m->mask.pushes[n] = mask_of(mode == STRUT_MODE_PUSH);
  m->mask.band[n] = mask_of(mode == STRUT_MODE_BAND);
  m->mask.stick[n] = mask_of(mode == STRUT_MODE_STICK);
  m->mask.creep[n] = mask_of(mode == STRUT_MODE_CREEP);
  m->mask.by_speed[n] =
      mask_of(mode == STRUT_MODE_SLIDE && strut_friction_is_continuous(e->friction.law));
  m->is.any_held = m->is.any_held || m->mask.stick[n] || m->mask.creep[n];
  m->is.any_band = m->is.any_band || m->mask.band[n] || m->mask.pushes[n];
  m->is.any_by_speed = m->is.any_by_speed || m->mask.by_speed[n];
  m->is.any_by_sign = m->is.any_by_sign || l->damper[i] == 0;
  m->mask.drops[n] = mask_of(strut_friction_drops(&e->friction));
  m->is.any_drops = m->is.any_drops || ((m->mask.band[n] || m->mask.pushes[n]) && m->mask.drops[n]);
  m->mask.damper_on[n] = mask_of(l->damper[i] > 0);
  m->mask.damper_off[n] = mask_of(l->damper[i] < 0);
  m->mask.damper_by_sign[n] = mask_of(l->damper[i] == 0);
  m->row.slip_factor[n] = slips ? -s * kinetic : 0.0;
  m->row.side[n] = s;
  m->row.edge[n] = stick_band_edge(e);
  m->row.kinetic[n] = kinetic;
  m->row.normal[n] = l->response[i].normal;
  m->row.tangent[n] = l->response[i].tangent;
}

/* The nodes that answer to contact i, and to no other that is closed. */
static void list_answers(const strut_model *model, const strut_event_stepper *l, int32_t i,
                         strut_small_modes *m) {
  assert(i >= 0 && i < model->contacts.count);
  const strut_contact_compliance *r = &l->response[i];
  int32_t from = model->contacts.entry[i].node;
  for (int32_t k = 0; k < r->count; k++)
    for (int c = 0; c < 2; c++) {
      uint32_t n = r->at[k] / 2;
      m->answer[c].lane[n] = from, m->answer[c].batch_halves[n] = strut_small_halves(from);
      m->answer[c].inverse[n] = r->xy[2 * k + c];
      m->answer[c].has[n] = -1;
    }
}

static void list_stuck(const strut_model *model, const strut_event_stepper *l, int32_t k,
                       strut_small_modes *m) {
  const strut_contact_compliance *r = &l->response[l->stuck[k]];
  strut_small_response *to = &m->stuck[k];
  memset(to, 0, sizeof *to);
  m->stuck_lane[k] = model->contacts.entry[l->stuck[k]].node;
  m->mask.held[m->stuck_lane[k]] = -1;
  for (int32_t j = 0; j < r->count; j++)
    to->x[r->at[j] / 2] = r->xy[2 * j], to->has[r->at[j] / 2] = -1;
}

/* See law_value. */
static void list_cable(const strut_event_stepper *l, int32_t k, strut_small_modes *m) {
  assert(k >= 0 && k < l->law_count);
  const strut_law_switch *law = &l->laws[k];
  double d = law->damping;
  int32_t j = law->member;
  m->cables.taut[j] = mask_of(l->acting[k]);
  m->cables.slack[j] = mask_of(!l->acting[k]);
  m->cables.elastic[j] = law->stiffness > 0.0 ? law->stiffness : d > 0.0 ? d / l->wanted_step : 1.0;
}

void strut_small_modes_update(const strut_model *model, const strut_state *state,
                              strut_event_stepper *l) {
  strut_small_modes *m = l->small;
  const strut_contact_table *c = &model->contacts;
  bool level = c->normal[0] == 0.0;
  if (!m->is.rows_current) strut_small_rest_fill(model, state, STRUT_SMALL_INSTANTS, m->rest);
  memset(m, 0, offsetof(strut_small_modes, stuck));
  memset(m->answer, 0, sizeof m->answer);
  m->is.current = m->is.rows_current = true;
  m->is.decoupled = l->contacts_decoupled && level;
  m->is.in_registers = l->stuck_count >= 0 && (level || !l->stuck_count);
  strut_small_inputs_read(model, state, &m->inputs);
  for (int32_t i = 0; i < c->count; i++) {
    m->row.outward[c->entry[i].node] = l->outward[i];
    if (!is_known(l->mode[i])) m->is.in_registers = false;
    if (l->mode[i] == STRUT_MODE_OPEN) continue;
    list_contact(model, l, i, m);
    if (m->is.decoupled) list_answers(model, l, i, m);
  }
  for (int32_t k = 0; k < l->law_count; k++) list_cable(l, k, m);
  for (int32_t k = 0; k < l->stuck_count; k++) list_stuck(model, l, k, m);
}
