/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/rigidity/tensegrity.h"

#include <math.h>

#include "engine/base/vec.h"

static const double NONE = 1e-9;    /* of the largest force: no force */
static const double ON_LINE = 1e-9; /* of the size: a node on the outline */

/* -1 pressed, 1 pulled, 0 neither, in the state that is judged. */
static int sign_of(const strut_rigidity *r, int32_t j, double largest) {
  double force = r->judged[j];
  return force > NONE * largest ? 1 : force < -NONE * largest ? -1 : 0;
}

static int32_t root(int32_t *parent, int32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/* Is the line through a and b one that all nodes lie on one side of? */
static bool on_outline(const strut_model *model, const double *q, uint32_t a, uint32_t b) {
  strut_vec2 d = strut_vec2_between(q + a, q + b);
  double length = strut_vec2_length(d);
  bool left = false, right = false;
  for (int32_t i = 0; i < model->node_count; i++) {
    double off = d.x * (q[2 * i + 1] - q[a + 1]) - d.y * (q[2 * i] - q[a]);
    left |= off > ON_LINE * model->size * length;
    right |= off < -ON_LINE * model->size * length;
  }
  return !(left && right);
}

/* Net: what is pulled is connected, struts end on it, and none lies on the outline. */
static bool inside(const strut_model *model, const double *q, const strut_rigidity *r,
                   double largest, int32_t *parent) {
  const strut_member_table *t = &model->members;
  int32_t net = -1;
  for (int32_t i = 0; i < model->node_count; i++) parent[i] = i;
  for (int32_t j = 0; j < t->count; j++) {
    int32_t a = (int32_t)(t->from[j] / 2), b = (int32_t)(t->to[j] / 2);
    if (sign_of(r, j, largest) <= 0) continue;
    parent[root(parent, a)] = root(parent, b);
    net = b;
  }
  if (net < 0) return false;
  for (int32_t j = 0; j < t->count; j++) {
    int32_t end[2] = {(int32_t)(t->from[j] / 2), (int32_t)(t->to[j] / 2)};
    int sign = sign_of(r, j, largest);
    for (int k = 0; k < 2 && sign != 0; k++)
      if (root(parent, end[k]) != root(parent, net)) return false;
    if (sign < 0 && on_outline(model, q, t->from[j], t->to[j])) return false;
  }
  return true;
}

static bool apart(const strut_model *model, const strut_rigidity *r, double largest,
                  int32_t *struts) {
  const strut_member_table *t = &model->members;
  int32_t all = 0;
  for (int32_t i = 0; i < model->node_count; i++) struts[i] = 0;
  for (int32_t j = 0; j < t->count; j++) {
    if (sign_of(r, j, largest) >= 0) continue;
    all++;
    if (++struts[t->from[j] / 2] > 1 || ++struts[t->to[j] / 2] > 1) return false;
  }
  return all > 0;
}

static bool pulls_cables_only(const strut_model *model, const strut_rigidity *r, double largest) {
  int32_t pulled = 0;
  for (int32_t j = 0; j < model->members.count; j++) {
    bool cable = model->scene->members[j].kind == STRUT_CABLE;
    int sign = sign_of(r, j, largest);
    if (cable ? sign < 0 : sign > 0) return false;
    pulled += sign > 0;
  }
  return pulled > 0;
}

/* The listed states that load what can move: each must stiffen all mechanisms by itself. */
static bool all_states_stiffen(const strut_rigidity *r) {
  return r->states.count == 1; /* of several, some combination presses what another pulls */
}

static const char *label_of(const strut_tensegrity *t) {
  if (!t->self_stress) return "no tensegrity: no state of self-stress";
  if (!t->judged) return "not judged: too many states";
  if (!t->cables) return "no tensegrity: members that are no cables are pulled, or cables pressed";
  if (t->mechanism && t->all_states && t->struts_apart)
    return t->struts_inside ? "ideal tensegrity" : "pure tensegrity";
  if (t->mechanism) return "structure with tensegrity features of class 1";
  if (t->struts_inside || t->struts_apart) return "structure with tensegrity features of class 2";
  return "no tensegrity: no stiffened mechanism, struts neither apart nor inside the net";
}

strut_status strut_tensegrity_judge(const strut_model *model, const double *q, strut_rigidity *r) {
  strut_tensegrity *t = &r->tensegrity;
  *t = (strut_tensegrity){.self_stress = r->states.count > 0, .judged = r->judged != NULL};
  if (r->judged) {
    const strut_mechanisms *m = &r->mechanisms;
    double largest = 0.0;
    int32_t *scratch = strut_allocate((size_t)model->node_count + 1, sizeof *scratch);
    if (!scratch) return STRUT_NO_MEMORY;
    for (int32_t j = 0; j < model->members.count; j++) largest = fmax(largest, fabs(r->judged[j]));
    t->cables = pulls_cables_only(model, r, largest);
    t->mechanism = m->infinitesimal > 0 && m->infinitesimal + m->rigid_body == m->count &&
                   (m->by_forces || (m->stiffener && m->stiffener_pulls));
    t->all_states = t->mechanism && all_states_stiffen(r);
    t->struts_apart = apart(model, r, largest, scratch);
    t->struts_inside = inside(model, q, r, largest, scratch);
    strut_release(scratch);
  }
  t->label = label_of(t);
  return STRUT_OK;
}
