/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/stick_band.h"

#include <math.h>

/* Accelerations are asked for at every so many looks. A step that passes zero meets a band of this
   part of |a| dt once in a hundred times: sticking is then an accident. */
enum { EVERY = 4, LEAST = 4 };
static const double ACCIDENT = 0.01;

double strut_stick_band_needed(const strut_model *model, const strut_integrator *method,
                               int32_t contact, double step) {
  const strut_contact_table *c = &model->contacts;
  const strut_contact_entry *e = &c->entry[contact];
  const double *g = model->scene->gravity;
  if (method->events || e->law != STRUT_FRICTION_KARNOPP || !(e->mu_kinetic > 0.0)) return 0.0;
  double down = -(g[0] * c->normal[0] + g[1] * c->normal[1]);
  return down > 0.0 && step > 0.0 ? e->mu_kinetic * down * step : 0.0;
}

bool strut_stick_band_create(const strut_model *model, strut_state *state,
                             const strut_integrator *method, double step, strut_stick_band *band) {
  bool any = false;
  *band = (strut_stick_band){.step = step};
  for (int32_t i = 0; i < model->contacts.count; i++)
    any = any || (model->contacts.entry[i].law == STRUT_FRICTION_KARNOPP &&
                  model->contacts.entry[i].mu_kinetic > 0.0);
  if (!any || method->events) return true;
  size_t length = (size_t)model->length, contacts = (size_t)model->contacts.count;
  band->a = strut_arena_allocate(&state->arena, length, sizeof(double));
  band->scratch = strut_arena_allocate(&state->arena, length, sizeof(double));
  band->watch = strut_arena_allocate(&state->arena, contacts, sizeof *band->watch);
  return band->a && band->scratch && band->watch;
}

void strut_stick_band_look(const strut_model *model, const strut_state *state,
                           strut_stick_band *band) {
  const strut_contact_table *c = &model->contacts;
  if (!band->watch) return;
  bool ask = band->looks++ % EVERY == 0 && state->evaluations > 0;
  if (ask) strut_mass_solve(model, state->force, band->a, band->scratch);
  for (int32_t i = 0; i < c->count; i++) {
    const double *q = state->q + c->at[i], *v = state->v + c->at[i], *a = band->a + c->at[i];
    strut_band_watch *w = &band->watch[i];
    if (!(q[0] * c->normal[0] + (q[1] - c->height) * c->normal[1] < 0.0)) continue;
    double slip = v[0] * c->tangent[0] + v[1] * c->tangent[1] - c->belt_speed;
    if (!ask || fabs(slip) < c->entry[i].stick_velocity) continue;
    w->sliding++;
    w->change += band->step * fabs(a[0] * c->tangent[0] + a[1] * c->tangent[1]);
  }
}

double strut_stick_band_missed(const strut_model *model, const strut_stick_band *band,
                               int32_t contact) {
  const strut_contact_entry *e = &model->contacts.entry[contact];
  if (!band->watch || e->law != STRUT_FRICTION_KARNOPP) return 0.0;
  const strut_band_watch *w = &band->watch[contact];
  double needed = w->sliding >= LEAST ? w->change / w->sliding : 0.0;
  return e->stick_velocity < ACCIDENT * needed ? needed : 0.0;
}
