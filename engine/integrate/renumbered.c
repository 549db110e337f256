/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/renumbered.h"

#include <math.h>
#include <string.h>

#include "engine/model/renumber.h"

struct strut_renumbered {
  const strut_integrator *method;
  strut_renumbering *order;
  strut_state *state; /* of order->model */
  void *workspace;
};

strut_status strut_renumbered_create(const strut_model *model, const strut_integrator *method,
                                     const strut_integrator_settings *settings,
                                     strut_renumbered **renumbered, strut_error *error) {
  *renumbered = NULL;
  if (method->role == STRUT_ROLE_STIFF || method->events || !strut_model_is_scattered(model))
    return STRUT_OK;
  strut_renumbered *r = strut_allocate(1, sizeof *r);
  if (!r) return strut_no_memory(error, "");
  r->method = method;
  strut_status status = strut_renumbering_create(model, &r->order, error);
  if (!status) status = strut_state_create(r->order->model, &r->state, error);
  if (!status && !(r->workspace = method->create(r->order->model, r->state, settings)))
    status = strut_no_memory(error, "");
  if (status)
    strut_renumbered_free(r);
  else
    *renumbered = r;
  return status;
}

void strut_renumbered_free(strut_renumbered *renumbered) {
  if (!renumbered) return;
  strut_state_free(renumbered->state);
  strut_renumbering_free(renumbered->order);
  strut_release(renumbered);
}

/* Numbers that have no place in memory. */
static void copy_numbers(const strut_state *from, strut_state *to) {
  to->step = from->step;
  to->time_offset = from->time_offset;
  to->refined_until = from->refined_until;
  to->evaluations = from->evaluations;
  to->events = from->events;
  to->interrupt = from->interrupt;
  to->most_evaluations = from->most_evaluations;
  to->trouble = from->trouble;
  to->ledger = from->ledger;
  to->load_work_origin = from->load_work_origin;
  memcpy(to->work, from->work, sizeof to->work);
  memcpy(to->power, from->power, sizeof to->power);
}

void strut_renumbered_restart(strut_renumbered *renumbered, strut_state *state, double dt) {
  strut_state *own = renumbered->state;
  const strut_model *model = renumbered->order->model;
  const int32_t *place = renumbered->order->place;
  copy_numbers(state, own);
  own->drive_time = (double)NAN;
  for (int32_t i = 0; i < model->node_count; i++) {
    memcpy(own->q + 2 * place[i], state->q + 2 * i, 2 * sizeof(double));
    memcpy(own->v + 2 * place[i], state->v + 2 * i, 2 * sizeof(double));
  }
  if (renumbered->method->restart)
    renumbered->method->restart(model, own, renumbered->workspace, dt);
  state->evaluations = own->evaluations;
}

void strut_renumbered_advance(strut_renumbered *renumbered, strut_state *state, double dt,
                              int64_t count) {
  strut_state *own = renumbered->state;
  const strut_model *model = renumbered->order->model;
  const int32_t *place = renumbered->order->place;
  size_t contacts = (size_t)model->contacts.count * sizeof(double);
  copy_numbers(state, own);
  own->drive_time = (double)NAN;
  renumbered->method->advance(model, own, renumbered->workspace, dt, count);
  copy_numbers(own, state);
  for (int32_t i = 0; i < model->node_count; i++) {
    memcpy(state->q + 2 * i, own->q + 2 * place[i], 2 * sizeof(double));
    memcpy(state->v + 2 * i, own->v + 2 * place[i], 2 * sizeof(double));
  }
  if (!contacts) return;
  memcpy(state->normal, own->normal, contacts);
  memcpy(state->friction, own->friction, contacts);
  for (int32_t i = 0; i < model->node_count; i++)
    memcpy(state->force + 2 * i, own->force + 2 * place[i], 2 * sizeof(double));
}
