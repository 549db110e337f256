/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Shapes that friction alone holds along the ground.
 *
 * With friction there are as many equilibria as there are ways to share the pull along the ground among the
 * contacts. Listed is the one that needs least of it: all contacts use the same part of what they can hold, so that
 * it stands whenever some equilibrium on these contacts does.
 */
#include <math.h>
#include <string.h>

#include "engine/model/pose.h"
#include "engine/scene/things.h"
#include "engine/statics/equilibria/equilibria_parts.h"

/* Changes of friction, over all forces, that are none; rounds until there are no others. */
static const double SAME = 1e-13;
enum { ROUNDS = 100 };

/* The sum of all forces from outside on coordinates along the ground (0) or across (1). */
static double sum_forces(const strut_equilibrium_search *search, int32_t component) {
  double sum = 0.0;
  for (int32_t i = 0; i < search->model->node_count; i++)
    sum += search->potential->force[2 * i + component];
  return sum;
}

strut_status strut_equilibrium_search_grips(strut_equilibrium_search *search,
                                            const strut_scene *scene, bool *hold) {
  double along = sum_forces(search, 0), press = -sum_forces(search, 1), most = 0.0;
  int32_t count = search->model->contacts.count;
  *hold = false;
  if (!search->supports.pin || search->model->contacts.surface) return STRUT_OK;
  double *grip = search->grip =
      strut_arena_allocate(&search->out->arena, (size_t)count, sizeof *grip);
  if (!grip) return strut_no_memory(search->error, "");
  for (int32_t i = 0; i < count; i++) {
    strut_friction friction = scene->contacts[i].friction;
    strut_scene_stop_grip(scene, &friction);
    if (strut_friction_has_band(friction.law) || strut_friction_is_exact(friction.law))
      grip[i] = strut_friction_static(&friction, along);
    most = fmax(most, grip[i]);
  }
  *hold = most * press >= fabs(along);
  return STRUT_OK;
}

/* A structure held at one contact, which the others help by their friction. */
typedef struct grip_search {
  const strut_equilibrium_search *search;
  strut_potential *potential;
  strut_minimiser *minimiser;
  int32_t pin;      /* node */
  double *friction; /* (contacts) [N] */
  double *q;        /* (length) */
  double used;      /* part of what all contacts could hold */
} grip_search;

static double push_at(const strut_equilibrium_search *search, int32_t i, const double *positions) {
  const strut_contact_table *contacts = &search->model->contacts;
  return fmax(0.0, -contacts->entry[i].stiffness * strut_contact_gap(contacts, i, positions));
}

/* Shares the pull along the ground among the contacts; returns the largest change of a force [N]. */
static double share(grip_search *self, double along) {
  const strut_equilibrium_search *search = self->search;
  const strut_contact_table *contacts = &search->model->contacts;
  double all = 0.0, change = 0.0;
  for (int32_t i = 0; i < contacts->count; i++)
    all += search->grip[i] * push_at(search, i, self->q);
  if (!(all > 0.0)) return HUGE_VAL;
  self->used = fabs(along) / all;
  for (int32_t i = 0; i < contacts->count; i++) {
    double now = -along * search->grip[i] * push_at(search, i, self->q) / all;
    if (contacts->entry[i].node == self->pin) continue;
    change = fmax(change, fabs(now - self->friction[i]));
    self->potential->force[contacts->at[i]] += now - self->friction[i];
    self->friction[i] = now;
  }
  return change;
}

/* Moves g->q to the equilibrium; false where there is none near it. */
static bool find_rest(grip_search *self, double along, double *residual) {
  double scale = self->search->potential->force_scale;
  for (int turn = 0; turn < ROUNDS; turn++) {
    strut_descent descent = strut_minimise(self->minimiser, self->q);
    if (descent.end == STRUT_DESCENT_RUNAWAY) return false;
    *residual = descent.residual;
    if (share(self, along) <= SAME * scale) return descent.end == STRUT_DESCENT_REACHED;
  }
  return false;
}

static bool create(grip_search *self, const double *from, strut_arena *scratch) {
  size_t length = (size_t)self->search->model->length;
  uint8_t *held = strut_arena_allocate(scratch, length, 1);
  self->friction = strut_arena_allocate(scratch, (size_t)self->search->model->contacts.count,
                                        sizeof *self->friction);
  if (!held || !self->friction) return false;
  held[2 * self->pin] = 1;
  memcpy(self->q, from, length * sizeof *self->q);
  return strut_potential_create(self->search->model, held, true, &self->potential, NULL) ==
             STRUT_OK &&
         strut_minimiser_create(self->potential, &self->minimiser, NULL) == STRUT_OK;
}

static strut_status accept(strut_equilibrium_search *search, strut_candidate_equilibrium *candidate,
                           const grip_search *self) {
  strut_equilibrium *equilibrium = &candidate->e;
  double press = 0.0;
  strut_status status = strut_equilibrium_search_contacts(search, self->q, equilibrium);
  for (int32_t i = 0; i < equilibrium->contact_count; i++) press += equilibrium->normal[i];
  if (status || !(self->used <= 1.0 + SAME)) return status;
  equilibrium->friction = fabs(sum_forces(search, 0)) / press;
  equilibrium->rest = self->q;
  equilibrium->rest_energy = strut_potential_energy(search->potential, self->q);
  equilibrium->outcome = strut_equilibrium_search_stands(search, candidate, self->q)
                             ? STRUT_OUTCOME_STANDS
                             : STRUT_OUTCOME_TIPS;
  return STRUT_OK;
}

strut_status strut_equilibrium_search_hold(strut_equilibrium_search *search,
                                           strut_candidate_equilibrium *candidate) {
  strut_arena scratch = {0};
  size_t length = (size_t)search->model->length;
  grip_search g = {.search = search, .pin = candidate->e.supports->node[0]};
  g.q = strut_arena_allocate(&search->out->arena, length, sizeof *g.q);
  strut_status status =
      g.q && create(&g, candidate->e.point.q, &scratch) ? STRUT_OK : STRUT_NO_MEMORY;
  if (status) strut_no_memory(search->error, "");
  candidate->e.outcome = STRUT_OUTCOME_NO_REST;
  if (!status && find_rest(&g, sum_forces(search, 0), &candidate->e.rest_residual))
    status = accept(search, candidate, &g);
  strut_minimiser_free(g.minimiser);
  strut_potential_free(g.potential);
  strut_arena_free(&scratch);
  return status;
}
