/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/large_steps.h"

#include <math.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

#include "engine/integrate/rows.h"
#include "engine/model/renumber.h"

/* Members from which on two threads are faster than one: meeting takes some microseconds, 8 to 16 times a step. */
enum { LEAST_FOR_THREADS = 16384, MEMBERS_PER_THREAD = 8192 };

struct strut_large_steps {
  const strut_integrator *method;
  strut_renumbering *order; /* NULL: as in the scene; then there are rows */
  strut_rows *rows;         /* NULL: the method steps `state` */
  strut_state *state;       /* of order->model */
  void *workspace;
};

int strut_large_threads(void) {
#ifdef _OPENMP
  return omp_in_parallel() ? 1 : omp_get_max_threads();
#else
  return 1;
#endif
}

static strut_status create_parts(strut_large_steps *s, const strut_model *model,
                                 const strut_integrator_settings *settings, bool scattered,
                                 bool rows, int threads, strut_error *error) {
  strut_status status =
      scattered ? strut_renumbering_create(model, rows, &s->order, error) : STRUT_OK;
  const strut_model *own = s->order ? s->order->model : model;
  if (!status && scattered) status = strut_state_create(own, &s->state, error);
  if (status) return status;
  if (rows)
    s->rows = strut_rows_create(own, s->order ? s->order->stored : NULL, threads);
  else
    s->workspace = s->method->create(own, s->state, settings);
  return s->rows || s->workspace ? STRUT_OK : strut_no_memory(error, "");
}

strut_status strut_large_steps_create(const strut_model *model, const strut_integrator *method,
                                      const strut_integrator_settings *settings, int threads,
                                      strut_large_steps **steps, strut_error *error) {
  *steps = NULL;
  int32_t members = model->members.count;
  bool plain = !method->events && method->role != STRUT_ROLE_STIFF;
  bool scattered = plain && strut_model_is_scattered(model);
  if (threads > members / MEMBERS_PER_THREAD) threads = members / MEMBERS_PER_THREAD;
  bool rows = plain && method->lanes == STRUT_LANES_RK4 && strut_rows_possible(model) &&
              threads > 1 && members >= LEAST_FOR_THREADS;
  if (!scattered && !rows) return STRUT_OK;
  strut_large_steps *s = strut_allocate(1, sizeof *s);
  if (!s) return strut_no_memory(error, "");
  s->method = method;
  strut_status status = create_parts(s, model, settings, scattered, rows, threads, error);
  if (status)
    strut_large_steps_free(s);
  else
    *steps = s;
  return status;
}

void strut_large_steps_free(strut_large_steps *steps) {
  if (!steps) return;
  strut_rows_free(steps->rows);
  strut_state_free(steps->state);
  strut_renumbering_free(steps->order);
  strut_release(steps);
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

void strut_large_steps_restart(strut_large_steps *steps, strut_state *state, double dt) {
  strut_state *own = steps->state;
  if (!steps->order) return;
  const strut_model *model = steps->order->model;
  const int32_t *place = steps->order->place;
  copy_numbers(state, own);
  own->drive_time = (double)NAN;
  for (int32_t i = 0; i < model->node_count; i++) {
    memcpy(own->q + 2 * place[i], state->q + 2 * i, 2 * sizeof(double));
    memcpy(own->v + 2 * place[i], state->v + 2 * i, 2 * sizeof(double));
  }
  if (steps->workspace && steps->method->restart)
    steps->method->restart(model, own, steps->workspace, dt);
  state->evaluations = own->evaluations;
}

/* Positions and velocities, and what contacts leave, in the scene's order. */
static void copy_back(const strut_renumbering *order, const strut_state *own, strut_state *state) {
  const strut_model *model = order->model;
  const int32_t *place = order->place;
  size_t contacts = (size_t)model->contacts.count * sizeof(double);
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

void strut_large_steps_advance(strut_large_steps *steps, strut_state *state, double dt,
                               int64_t count) {
  strut_state *own = steps->state;
  if (!steps->order) {
    strut_rows_advance(steps->rows, state, dt, count);
    return;
  }
  copy_numbers(state, own);
  own->drive_time = (double)NAN;
  if (steps->rows)
    strut_rows_advance(steps->rows, own, dt, count);
  else
    steps->method->advance(steps->order->model, own, steps->workspace, dt, count);
  copy_numbers(own, state);
  copy_back(steps->order, own, state);
}
