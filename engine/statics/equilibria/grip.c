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
static double sum_forces(const strut_equilibrium_search *h, int32_t component) {
  double sum = 0.0;
  for (int32_t i = 0; i < h->model->node_count; i++) sum += h->potential->force[2 * i + component];
  return sum;
}

strut_status strut_equilibrium_search_grips(strut_equilibrium_search *h, const strut_scene *scene,
                                            bool *hold) {
  double along = sum_forces(h, 0), press = -sum_forces(h, 1), most = 0.0;
  int32_t count = h->model->contacts.count;
  *hold = false;
  if (!h->supports.pin || h->model->contacts.surface) return STRUT_OK;
  double *grip = h->grip = strut_arena_allocate(&h->out->arena, (size_t)count, sizeof *grip);
  if (!grip) return strut_no_memory(h->error, "");
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

static double push_at(const strut_equilibrium_search *h, int32_t i, const double *q) {
  const strut_contact_table *c = &h->model->contacts;
  return fmax(0.0, -c->entry[i].stiffness * strut_contact_gap(c, i, q));
}

/* Shares the pull along the ground among the contacts; returns the largest change of a force [N]. */
static double share(grip_search *g, double along) {
  const strut_equilibrium_search *h = g->search;
  const strut_contact_table *c = &h->model->contacts;
  double all = 0.0, change = 0.0;
  for (int32_t i = 0; i < c->count; i++) all += h->grip[i] * push_at(h, i, g->q);
  if (!(all > 0.0)) return HUGE_VAL;
  g->used = fabs(along) / all;
  for (int32_t i = 0; i < c->count; i++) {
    double now = -along * h->grip[i] * push_at(h, i, g->q) / all;
    if (c->entry[i].node == g->pin) continue;
    change = fmax(change, fabs(now - g->friction[i]));
    g->potential->force[c->at[i]] += now - g->friction[i];
    g->friction[i] = now;
  }
  return change;
}

/* Moves g->q to the equilibrium; false where there is none near it. */
static bool find_rest(grip_search *g, double along, double *residual) {
  double scale = g->search->potential->force_scale;
  for (int turn = 0; turn < ROUNDS; turn++) {
    strut_descent descent = strut_minimise(g->minimiser, g->q, 0.0);
    if (descent.end == STRUT_DESCENT_RUNAWAY) return false;
    *residual = descent.residual;
    if (share(g, along) <= SAME * scale) return descent.end == STRUT_DESCENT_REACHED;
  }
  return false;
}

static bool create(grip_search *g, const double *from, strut_arena *scratch) {
  size_t length = (size_t)g->search->model->length;
  uint8_t *held = strut_arena_allocate(scratch, length, 1);
  g->friction =
      strut_arena_allocate(scratch, (size_t)g->search->model->contacts.count, sizeof *g->friction);
  if (!held || !g->friction) return false;
  held[2 * g->pin] = 1;
  memcpy(g->q, from, length * sizeof *g->q);
  return strut_potential_create(g->search->model, held, true, &g->potential, NULL) == STRUT_OK &&
         strut_minimiser_create(g->potential, &g->minimiser, NULL) == STRUT_OK;
}

static strut_status accept(strut_equilibrium_search *h, strut_candidate_equilibrium *f,
                           const grip_search *g) {
  strut_equilibrium *e = &f->e;
  double press = 0.0;
  strut_status status = strut_equilibrium_search_contacts(h, g->q, e);
  for (int32_t i = 0; i < e->contact_count; i++) press += e->normal[i];
  if (status || !(g->used <= 1.0 + SAME)) return status;
  e->friction = fabs(sum_forces(h, 0)) / press;
  e->rest = g->q;
  e->rest_energy = strut_potential_energy(h->potential, g->q);
  e->outcome =
      strut_equilibrium_search_stands(h, f, g->q) ? STRUT_OUTCOME_STANDS : STRUT_OUTCOME_TIPS;
  return STRUT_OK;
}

strut_status strut_equilibrium_search_hold(strut_equilibrium_search *h,
                                           strut_candidate_equilibrium *f) {
  strut_arena scratch = {0};
  size_t length = (size_t)h->model->length;
  grip_search g = {.search = h, .pin = f->e.supports->node[0]};
  g.q = strut_arena_allocate(&h->out->arena, length, sizeof *g.q);
  strut_status status = g.q && create(&g, f->e.point.q, &scratch) ? STRUT_OK : STRUT_NO_MEMORY;
  if (status) strut_no_memory(h->error, "");
  f->e.outcome = STRUT_OUTCOME_NO_REST;
  if (!status && find_rest(&g, sum_forces(h, 0), &f->e.rest_residual)) status = accept(h, f, &g);
  strut_minimiser_free(g.minimiser);
  strut_potential_free(g.potential);
  strut_arena_free(&scratch);
  return status;
}
