/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Friction in the equations of a path: a contact sticks, or slides one way.
 *
 * Where it sticks, a spring much stiffer than all else holds its node along the ground; where it slides, the
 * force is that of the kinetic coefficient, and the stiffness has no symmetry. Nothing moves at a speed:
 * laws whose force vanishes with the speed have no part in this.
 */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/statics/path/path_parts.h"

static const double STIFF = 1e5;  /* what holds a contact, over the stiffest member or ground */
static const double SMALL = 1e-6; /* of the range: a jump that is none */

/* The law of contact i at some value of the parameter; driven coefficients are those at t = 0. */
static strut_friction law_of(const strut_path_terms *terms, int32_t i) {
  strut_friction law = terms->laws->contacts.entry[i].friction;
  strut_scene_stop_grip(terms->laws->scene, &law);
  return law;
}

static bool has_static_friction(const strut_friction *law) {
  bool coulomb = strut_friction_has_band(law->law) || strut_friction_is_exact(law->law);
  return coulomb &&
         (strut_friction_static(law, 1.0) > 0.0 || strut_friction_static(law, -1.0) > 0.0);
}

bool strut_path_friction_create(strut_path_system *system) {
  const strut_contact_table *contacts = &system->model->contacts;
  double stiffest = strut_stiffest(system->model);
  const strut_path_terms drawn = {.laws = system->model};
  bool some = false;
  for (int32_t i = 0; i < contacts->count; i++) {
    const strut_friction law = law_of(&drawn, i);
    system->contacts.contact[i].grips = has_static_friction(&law);
    some = some || system->contacts.contact[i].grips;
    stiffest = fmax(stiffest, contacts->entry[i].stiffness);
  }
  system->contacts.grip = STIFF * stiffest;
  return some;
}

/* How far the node of a contact that sticks has come from where nothing holds it back, along the ground [m]. */
static double strain_of(const strut_path_system *system, int32_t i) {
  const strut_path_contact *own = &system->contacts.contact[i];
  uint32_t at = system->model->contacts.at[i];
  const strut_dd x = {system->latest.q[at], system->latest.q_low[at]};
  const strut_dd y = {system->latest.q[at + 1], system->latest.q_low[at + 1]};
  strut_dd along = dd_add(dd_scale(x, own->tangent[0]), dd_scale(y, own->tangent[1]));
  return dd_double(dd_sub(along, own->anchor));
}

/* Sticks from the latest place on, where the ground pulls its node by `force` along the tangent [N]. */
static void stick(strut_path_system *system, int32_t i, double force) {
  strut_path_contact *own = &system->contacts.contact[i];
  own->sticks = true, own->direction = 0.0;
  own->anchor = dd_of(0.0);
  memcpy(own->tangent, own->pose.axes.tangent, sizeof own->tangent);
  own->anchor = dd_of(strain_of(system, i) + force / system->contacts.grip);
}

/* Push of the ground, and what it can hold or holds of a sliding node [N]. */
static double limit_of(const strut_path_system *system, const strut_path_terms *terms, int32_t i,
                       double gap) {
  const strut_path_contact *own = &system->contacts.contact[i];
  const strut_friction law = law_of(terms, i);
  double push = -terms->laws->contacts.entry[i].stiffness * gap;
  double way = own->sticks ? strain_of(system, i) : own->direction;
  return push *
         (own->sticks ? strut_friction_static(&law, way) : strut_friction_kinetic(&law, way));
}

double strut_path_friction_force(const strut_path_system *system, const strut_path_terms *terms,
                                 int32_t i, double gap) {
  const strut_path_contact *own = &system->contacts.contact[i];
  if (!own->grips || !own->touches) return 0.0;
  if (own->sticks) return -system->contacts.grip * strain_of(system, i);
  return -own->direction * limit_of(system, terms, i, gap);
}

void strut_path_friction_block(const strut_path_system *system, int32_t i, double block[4]) {
  const strut_path_contact *own = &system->contacts.contact[i];
  const double *n = own->pose.axes.normal, *t = own->pose.axes.tangent;
  if (!own->grips) return;
  double force = strut_path_friction_force(system, &system->equations.terms, i, own->pose.gap);
  double per_gap =
      -strut_path_friction_force(system, &system->equations.terms, i, 1.0); /* where it slides */
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++)
      block[2 * a + b] += own->sticks
                              ? system->contacts.grip * own->tangent[a] * own->tangent[b]
                              : per_gap * t[a] * n[b] + force * own->pose.curvature * n[a] * t[b];
}

bool strut_path_slides(const strut_path_system *system) {
  for (int32_t i = 0; i < system->model->contacts.count; i++) {
    const strut_path_contact *own = &system->contacts.contact[i];
    if (own->grips && own->touches && !own->sticks) return true;
  }
  return false;
}

void strut_path_friction_begin(strut_path_system *system) {
  for (int32_t i = 0; i < system->model->contacts.count; i++) {
    strut_path_contact *own = &system->contacts.contact[i];
    double force = 0.0, held = 0.0;
    if (!own->grips || !own->touches) continue;
    /* what other forces leave at the node is what holds it */
    for (uint32_t c = 0; c < 2; c++) {
      int32_t row = system->potential->row_of[system->model->contacts.at[i] + c];
      double t = own->pose.axes.tangent[c];
      if (row >= 0) force += system->latest.g[row] * t, held += t * t;
    }
    stick(system, i, held > 0.0 ? force / held : 0.0);
  }
}

void strut_path_friction_touch(strut_path_system *system, int32_t i) {
  if (system->contacts.contact[i].grips) stick(system, i, 0.0);
}

bool strut_path_friction_drops(const strut_path_system *system, int32_t i) {
  const strut_friction law = law_of(&system->equations.terms, i);
  return strut_friction_drops(&law);
}

/* What is left of the limit of a contact that sticks, as a depth of the ground. */
double strut_path_grip_value(const strut_path_system *system, int32_t i, double gap) {
  const strut_path_contact *own = &system->contacts.contact[i];
  if (!own->sticks || !own->touches) return -HUGE_VAL;
  double force = fabs(strut_path_friction_force(system, &system->equations.terms, i, gap));
  return (limit_of(system, &system->equations.terms, i, gap) - force) /
         system->equations.terms.laws->contacts.entry[i].stiffness;
}

void strut_path_grip_set(strut_path_system *system, int32_t i, bool on) {
  strut_path_contact *own = &system->contacts.contact[i];
  if (on == own->sticks || !own->grips) return;
  if (on) {
    stick(system, i, strut_path_friction_force(system, &system->equations.terms, i, own->pose.gap));
    return;
  }
  own->direction = strain_of(system, i) < 0.0 ? -1.0 : 1.0;
  own->sticks = false;
}

/* The direction of a contact's tangent, over the unknowns. */
static void fill_row(const strut_path_system *system, int32_t i, double *row) {
  uint32_t at = system->model->contacts.at[i];
  memset(row, 0, ((size_t)system->n + 1) * sizeof *row);
  for (uint32_t c = 0; c < 2; c++)
    strut_path_add_to_row(system, at + c, system->contacts.contact[i].pose.axes.tangent[c], row);
}

double strut_path_measure_grip(strut_path_system *system, const double *unknowns,
                               const strut_path_piece *piece, int32_t which) {
  int32_t i = which - strut_path_first_grip_switch(system);
  const strut_path_contact *own = &system->contacts.contact[i];
  double *along = system->latest.row, back = 0.0;
  if (own->sticks || own->direction == 0.0) return strut_path_switch_value(system, which, unknowns);
  if (!strut_path_tangent(system, unknowns, piece->tangent, along)) return (double)NAN;
  for (uint32_t c = 0; c < 2; c++)
    back -= own->direction * own->pose.axes.tangent[c] *
            strut_path_rate_of(system, system->model->contacts.at[i] + c, along);
  return back;
}

bool strut_path_pass_grip(strut_path_walk *walk, int32_t which, const double *beyond) {
  strut_path_system *system = &walk->system;
  int32_t i = which - strut_path_first_grip_switch(system), before = walk->negative;
  int32_t node = system->model->contacts.entry[i].node;
  const char *name = system->model->scene->nodes[node].name,
             *ground = strut_path_ground_name(system, i);
  strut_path_contact *own = &system->contacts.contact[i];
  double *row = walk->trial, value = strut_path_value(system, walk->y),
         turn = walk->tangent[system->n];
  char detail[300];
  bool slips = own->sticks;
  if (slips && strut_path_friction_drops(system, i)) strut_path_add_point(walk, before);
  strut_path_switch_value(system, which, beyond);
  if (slips) strut_path_grip_set(system, i, false);
  strut_path_evaluate(system, walk->y);
  if (!slips) strut_path_grip_set(system, i, true);
  fill_row(system, i, row);
  /* against the kinetic coefficient it takes less to hold the node where it is */
  if (slips && !strut_path_jump(walk, row)) return false;
  for (int32_t k = 0; k <= system->n; k++) row[k] *= own->direction;
  bool leads = strut_path_dot(walk, row, row) > 0.0; /* its direction is where it slides to */
  if (!strut_path_tangent(system, walk->y, leads ? row : walk->tangent, walk->next_tangent))
    return false;
  memcpy(walk->tangent, walk->next_tangent, ((size_t)system->n + 1) * sizeof *walk->tangent);
  strut_path_count_negative(walk);
  double jump = strut_path_value(system, walk->y) - value;
  int used = snprintf(detail, sizeof detail, "%s %s %s", name,
                      slips ? "begins to slide on" : "sticks to", ground);
  if (fabs(jump) > SMALL * fabs(system->parameter.range))
    snprintf(detail + used, sizeof detail - (size_t)used, ": %s jumps from %.6g to %.6g there",
             strut_path_subject(walk), value, value + jump);
  strut_path_add_event(walk, slips ? STRUT_PATH_SLIP : STRUT_PATH_STICK, walk->y, node, before,
                       walk->negative, detail);
  strut_path_report_exchange(walk, turn, before);
  return true;
}
