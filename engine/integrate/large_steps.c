/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/large_steps.h"

#include <math.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

#include "engine/integrate/domain_parts.h"
#include "engine/model/mass.h"
#include "engine/model/renumber.h"

/* Members from which on two threads are faster than one: meeting takes some microseconds. */
enum { LEAST_FOR_THREADS = 16384, MEMBERS_PER_THREAD = 8192 };

/* Members from which on subdomains are as fast for one thread, too: less of a structure stays in the caches. */
enum { LEAST_FOR_ONE = 200000 };

/* Evaluations of the forces at once, since each look at the state costs a copy in the scene's order. */
enum { EVALUATIONS_AT_ONCE = 32 };

struct strut_large_steps {
  const strut_integrator *method;
  strut_renumbering *order; /* the method steps `state`, of order->model */
  strut_state *state;
  void *workspace;
  strut_domain_steps *domains; /* instead of all these */
};

int strut_large_threads(void) {
#ifdef _OPENMP
  return omp_in_parallel() ? 1 : omp_get_max_threads();
#else
  return 1;
#endif
}

static strut_status create_reordered(strut_large_steps *s, const strut_model *model,
                                     const strut_integrator_settings *settings,
                                     strut_error *error) {
  /* members in the order of subdomains: the energy balance adds them up as they are stored */
  strut_status status = strut_renumbering_create(model, false, &s->order, error);
  if (!status) status = strut_state_create(s->order->model, &s->state, error);
  if (status) return status;
  s->workspace = s->method->create(s->order->model, s->state, settings);
  return s->workspace ? STRUT_OK : strut_no_memory(error, "");
}

static strut_status create_domains(strut_large_steps *s, const strut_model *model, bool scattered,
                                   int threads, strut_error *error) {
  strut_arena scratch = {0};
  int32_t *member = NULL;
  strut_status status =
      scattered ? strut_member_order_create(model, &scratch, &member, error) : STRUT_OK;
  if (!status) s->domains = strut_domain_steps_create(model, s->method, member, threads);
  strut_arena_free(&scratch);
  return status || s->domains ? status : strut_no_memory(error, "");
}

typedef struct choice {
  bool scattered, domains;
} choice;

/* Which of them step the model, if there are threads enough. */
static choice choose(const strut_model *model, const strut_integrator *method) {
  bool plain = !method->events && method->role != STRUT_ROLE_STIFF;
  bool large = plain && model->members.count >= LEAST_FOR_THREADS;
  return (choice){.scattered = plain && strut_model_is_scattered(model),
                  .domains = large && strut_domain_steps_possible(model, method)};
}

int64_t strut_large_steps_at_once(const strut_model *model, const strut_integrator *method) {
  choice c = choose(model, method);
  return c.scattered || c.domains ? EVALUATIONS_AT_ONCE / method->evaluations : 1;
}

/* Masses that are not coupled: in another order, or from some size on, by one thread too, since memory is read a
   fourth as often. */
static bool one_thread_pays(const strut_model *model, choice c) {
  return model->mass->diagonal && (c.scattered || model->members.count >= LEAST_FOR_ONE);
}

strut_status strut_large_steps_create(const strut_model *model, const strut_integrator *method,
                                      const strut_integrator_settings *settings, int threads,
                                      strut_large_steps **steps, strut_error *error) {
  *steps = NULL;
  int32_t members = model->members.count;
  choice c = choose(model, method);
  if (threads > members / MEMBERS_PER_THREAD) threads = members / MEMBERS_PER_THREAD;
  if (threads < 2) threads = 1, c.domains = c.domains && one_thread_pays(model, c);
  if (!c.scattered && !c.domains) return STRUT_OK;
  strut_large_steps *s = strut_allocate(1, sizeof *s);
  if (!s) return strut_no_memory(error, "");
  s->method = method;
  strut_status status = c.domains ? create_domains(s, model, c.scattered, threads, error)
                                  : create_reordered(s, model, settings, error);
  if (status)
    strut_large_steps_free(s);
  else
    *steps = s;
  return status;
}

void strut_large_steps_free(strut_large_steps *steps) {
  if (!steps) return;
  strut_domain_steps_free(steps->domains);
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
  to->forced = from->forced;
  to->limits.interrupt = from->limits.interrupt;
  to->limits.most_evaluations = from->limits.most_evaluations;
  to->trouble = from->trouble;
  to->balance = from->balance;
  to->load_work_origin = from->load_work_origin;
  memcpy(to->work, from->work, sizeof to->work);
  memcpy(to->latest.power, from->latest.power, sizeof to->latest.power);
}

void strut_large_steps_restart(strut_large_steps *steps, strut_state *state, double dt) {
  strut_state *own = steps->state;
  if (steps->domains) strut_domain_steps_restart(steps->domains, state, dt);
  if (!steps->order) return;
  const strut_model *model = steps->order->model;
  const int32_t *place = steps->order->place;
  copy_numbers(state, own);
  own->latest.drive_time = (double)NAN;
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
  memcpy(state->latest.normal, own->latest.normal, contacts);
  memcpy(state->latest.friction, own->latest.friction, contacts);
  for (int32_t i = 0; i < model->node_count; i++)
    memcpy(state->latest.force + 2 * i, own->latest.force + 2 * place[i], 2 * sizeof(double));
}

void strut_large_steps_advance(strut_large_steps *steps, strut_state *state, double dt,
                               int64_t count) {
  strut_state *own = steps->state;
  if (steps->domains) {
    strut_domain_steps_advance(steps->domains, state, dt, count);
    return;
  }
  copy_numbers(state, own);
  own->latest.drive_time = (double)NAN;
  steps->method->advance(steps->order->model, own, steps->workspace, dt, count);
  copy_numbers(own, state);
  copy_back(steps->order, own, state);
}
