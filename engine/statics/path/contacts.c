/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Contacts in the equations of a path: which touch, and on which facet of its surface each lies, is
 * frozen between events, as for cables.
 */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/model/pose.h"
#include "engine/statics/path/path_parts.h"

static const double ALONG = 1e-9; /* a direction's part across its line */
static const double STILL = 1e-9; /* what does not move [units of y] */

bool strut_path_contacts_create(const strut_model *model, strut_arena *arena,
                                strut_path_contacts *p) {
  const strut_contact_table *t = &model->contacts;
  p->contact = strut_arena_allocate(arena, (size_t)t->count, sizeof *p->contact);
  for (int32_t k = 0; k < t->surfaces; k++) p->has_corners |= t->surface[k].facets > 1;
  return p->contact;
}

/* Position of a contact's node against a point [m]. */
static void span_from(const strut_path_system *s, uint32_t at, const double *point, strut_dd d[2]) {
  for (uint32_t c = 0; c < 2; c++) {
    const strut_dd place = {s->latest.q[at + c], s->latest.q_low[at + c]};
    d[c] = dd_sub(place, dd_of(point[c]));
  }
}

/* Against the line of a facet, to all digits. */
static void find_on_line(const strut_path_system *s, uint32_t at, const double *point,
                         const strut_contact_axes *axes, strut_contact_pose *pose) {
  strut_dd d[2];
  span_from(s, at, point, d);
  pose->axes = *axes;
  pose->gap = dd_double(dd_add(dd_scale(d[0], axes->normal[0]), dd_scale(d[1], axes->normal[1])));
}

/* The same of a circle. */
static void find_on_circle(const strut_path_system *s, uint32_t at, const strut_surface *circle,
                           strut_contact_pose *pose) {
  strut_dd d[2], distance, gap;
  double sign = circle->inside ? -1.0 : 1.0;
  span_from(s, at, circle->centre, d);
  distance = dd_length(d[0], d[1]);
  if (!(distance.hi > 0.0)) return;
  gap = dd_scale(dd_sub(distance, dd_of(circle->radius)), sign);
  const double normal[2] = {sign * dd_double(dd_div(d[0], distance)),
                            sign * dd_double(dd_div(d[1], distance))};
  pose->axes = (strut_contact_axes){{normal[1], -normal[0]}, {normal[0], normal[1]}};
  pose->gap = dd_double(gap), pose->curvature = sign / dd_double(distance);
}

const char *strut_path_ground_name(const strut_path_system *s, int32_t i) {
  const strut_scene *scene = s->model->scene;
  return scene->ground_count > 1 ? scene->grounds[scene->contacts[i].ground].name : "the ground";
}

/* Contact i at the latest positions against a ground of some terms: its facet if it touches, else the nearest. */
static strut_contact_pose pose_in(const strut_path_system *s, const strut_path_terms *terms,
                                  int32_t i) {
  const strut_contact_table *c = &terms->laws->contacts;
  const strut_path_contact *own = &s->contacts.contact[i];
  strut_contact_pose pose = {.axes = c->axes};
  const double level[2] = {0.0, c->height};
  uint32_t at = c->at[i];
  if (!c->surface) {
    find_on_line(s, at, level, &c->axes, &pose);
    return pose;
  }
  const strut_surface *surface = &c->surface[c->surface_of[i]];
  bool line = surface->before == HUGE_VAL && surface->beyond == HUGE_VAL && surface->facets == 1;
  if (surface->facets && (own->touches || line)) {
    const strut_facet *facet = &surface->facet[own->touches ? own->facet : 0];
    find_on_line(s, at, facet->point, &facet->axes, &pose);
    pose.facet = own->touches ? own->facet : 0;
    return pose;
  }
  pose = strut_contact_pose_at(c, i, s->latest.q, NULL, -1);
  if (!surface->facets) find_on_circle(s, at, surface, &pose);
  return pose;
}

/* Derivative of its energy, with friction, by its node's coordinates: minus the force on the node [N]. */
static void gradient_in(const strut_path_system *s, const strut_path_terms *terms, int32_t i,
                        const strut_contact_pose *pose, double gradient[2]) {
  const strut_path_contact *own = &s->contacts.contact[i];
  const double *along = own->sticks ? own->tangent : pose->axes.tangent;
  double normal = terms->laws->contacts.entry[i].stiffness * pose->gap;
  double friction = strut_path_friction_force(s, terms, i, pose->gap);
  for (int c = 0; c < 2; c++) gradient[c] = normal * pose->axes.normal[c] - friction * along[c];
}

/* How that changes with the parameter where its node stays. */
static void find_rate(const strut_path_system *s, int32_t i, double rate[2]) {
  const strut_path_parameter *p = &s->parameter;
  double below[2], above[2];
  rate[0] = rate[1] = 0.0;
  if (p->options->over != STRUT_PATH_OVER_SCENE) return;
  const strut_contact_pose low = pose_in(s, &p->low, i), high = pose_in(s, &p->high, i);
  gradient_in(s, &p->low, i, &low, below);
  gradient_in(s, &p->high, i, &high, above);
  for (int c = 0; c < 2; c++) rate[c] = (above[c] - below[c]) / p->apart;
}

static double stiffness_of(const strut_path_system *s, int32_t i) {
  return s->equations.terms.laws->contacts.entry[i].stiffness;
}

/* The ground as a spring that is there or not, whatever the sign of the gap. */
static void add_contact(strut_path_system *s, int32_t i, strut_force *force) {
  const strut_path_contact *own = &s->contacts.contact[i];
  double gradient[2], rate[2], block[4], stiffness = stiffness_of(s, i);
  strut_force_set_contact(stiffness, &own->pose, force);
  force->across = stiffness * own->pose.gap * own->pose.curvature;
  strut_force_stiffness(s->model, force, s->latest.q, block);
  strut_path_friction_block(s, i, block);
  if (own->sticks) force->across += s->contacts.grip;
  gradient_in(s, &s->equations.terms, i, &own->pose, gradient);
  find_rate(s, i, rate);
  strut_path_add_force(s, force, gradient, rate, block);
}

void strut_path_add_contacts(strut_path_system *s) {
  strut_force *force = strut_path_element_force(s, s->model->elements.count);
  for (int32_t i = 0; i < s->model->contacts.count; i++) {
    s->contacts.contact[i].pose = pose_in(s, &s->equations.terms, i);
    force[i].pose.acts = s->contacts.contact[i].touches;
    if (force[i].pose.acts) add_contact(s, i, &force[i]);
  }
}

void strut_path_contact_reactions(const strut_path_system *s, double *reaction, double *contact,
                                  double *friction) {
  for (int32_t i = 0; i < s->model->contacts.count; i++) {
    const strut_path_contact *own = &s->contacts.contact[i];
    double gradient[2] = {0.0, 0.0};
    if (own->touches) gradient_in(s, &s->equations.terms, i, &own->pose, gradient);
    contact[i] = own->touches ? 0.0 - stiffness_of(s, i) * own->pose.gap : 0.0;
    friction[i] = 0.0 + strut_path_friction_force(s, &s->equations.terms, i, own->pose.gap);
    for (uint32_t c = 0; c < 2; c++) reaction[s->model->contacts.at[i] + c] += gradient[c];
  }
}

double strut_path_contact_switch_value(const strut_path_system *s, int32_t i) {
  return -pose_in(s, &s->equations.terms, i).gap;
}

void strut_path_contact_switch_set(strut_path_system *s, int32_t i, bool on) {
  strut_path_contact *own = &s->contacts.contact[i];
  if (on && !own->touches) {
    own->pose = pose_in(s, &s->equations.terms, i);
    own->facet = own->pose.facet;
    strut_path_friction_touch(s, i);
  }
  own->touches = on;
  if (!on) own->sticks = false, own->direction = 0.0;
}

double strut_path_grip_switch_value(const strut_path_system *s, int32_t i) {
  return strut_path_grip_value(s, i, pose_in(s, &s->equations.terms, i).gap);
}

/* The surface of contact i where it has corners that the contact may pass, or NULL. */
static const strut_surface *cornered(const strut_path_system *s, int32_t i) {
  const strut_contact_table *c = &s->equations.terms.laws->contacts;
  const strut_surface *surface = c->surface ? &c->surface[c->surface_of[i]] : NULL;
  return surface && surface->facets > 1 && s->contacts.contact[i].touches ? surface : NULL;
}

double strut_path_corner_value(const strut_path_system *s, int32_t i) {
  const strut_surface *surface = cornered(s, i);
  int32_t other;
  if (!surface) return -HUGE_VAL;
  return strut_surface_margin(surface, s->latest.q + s->model->contacts.at[i],
                              s->contacts.contact[i].facet, &other);
}

void strut_path_add_to_row(const strut_path_system *s, uint32_t at, double entry, double *row) {
  int32_t free = s->potential->row_of[at];
  double moved = s->equations.rates.position[at] * s->parameter.range / s->size;
  row[free >= 0 ? free : s->n] += free >= 0 ? entry : entry * moved;
}

double strut_path_rate_of(const strut_path_system *s, uint32_t at, const double *tangent) {
  int32_t free = s->potential->row_of[at];
  double moved = s->equations.rates.position[at] * s->parameter.range / s->size;
  return free >= 0 ? tangent[free] : tangent[s->n] * moved;
}

bool strut_path_jump(strut_path_walk *w, const double *row) {
  int32_t count = w->system.n + 1;
  double place = strut_path_dot(w, row, w->y);
  if (!(strut_path_dot(w, row, row) > 0.0)) return true;
  for (int32_t k = 0; k < count; k++) place += row[k] * w->y[count + k];
  memcpy(w->spare, w->y, strut_path_bytes(w));
  if (strut_path_correct(&w->system, row, place, w->y) < 0) return false;
  w->arc += strut_path_distance(w, w->spare, w->y);
  return true;
}

/* Moves contact i to the facet beside its own; `row` (n + 1) becomes the direction that leads onto it. */
static void change_facet(strut_path_system *s, int32_t i, double *row) {
  const strut_surface *surface = cornered(s, i);
  strut_path_contact *own = &s->contacts.contact[i];
  uint32_t at = s->model->contacts.at[i];
  int32_t other;
  strut_surface_margin(surface, s->latest.q + at, own->facet, &other);
  memset(row, 0, ((size_t)s->n + 1) * sizeof *row);
  for (uint32_t c = 0; c < 2; c++)
    strut_path_add_to_row(
        s, at + c, surface->facet[other].axes.normal[c] - surface->facet[own->facet].axes.normal[c],
        row);
  own->facet = other;
}

/*
 * The force of a contact turns at once where its node passes a corner of the solid. At the corner each force in
 * between is in equilibrium for some value of the parameter, with the node held by nothing else: the path leads
 * along the corner to the value that the facet beyond wants, and that piece is unstable but for a displacement.
 */
bool strut_path_pass_corner(strut_path_walk *w, int32_t which) {
  strut_path_system *s = &w->system;
  const strut_scene *scene = s->model->scene;
  int32_t i = which - strut_path_first_corner_switch(s), before = w->negative;
  int32_t node = s->model->contacts.entry[i].node;
  double *row = w->trial, value = strut_path_value(s, w->y), turn = w->tangent[s->n];
  char detail[300];
  strut_path_evaluate(s, w->y);
  strut_path_add_point(w, before);
  change_facet(s, i, row);
  bool held = !(strut_path_dot(w, row, row) > 0.0); /* the ground moves under a support */
  if (!strut_path_jump(w, row)) return false;
  if (!strut_path_tangent(s, w->y, held ? w->tangent : row, w->next_tangent)) return false;
  memcpy(w->tangent, w->next_tangent, ((size_t)s->n + 1) * sizeof *w->tangent);
  strut_path_count_negative(w);
  snprintf(detail, sizeof detail, "%s passes a corner of %s: %s jumps from %.6g to %.6g there",
           scene->nodes[node].name, strut_path_ground_name(s, i), strut_path_subject(w), value,
           strut_path_value(s, w->y));
  strut_path_add_event(w, STRUT_PATH_CORNER, w->y, node, before, w->negative, detail);
  strut_path_report_exchange(w, turn, before);
  return true;
}

/* Do supports keep the two nodes of a member on its line? */
static bool is_kept_on_line(const strut_path_system *s, int32_t member, const double *ahead) {
  const strut_member_table *t = &s->model->members;
  const uint32_t end[2] = {t->from[member], t->to[member]};
  for (int k = 0; k < 2; k++)
    for (uint32_t c = 0; c < 2; c++)
      if (s->potential->row_of[end[k] + c] >= 0 && fabs(ahead[1 - c]) > ALONG) return false;
  return true;
}

/*
 * The force of a member that shrinks to nothing turns round with its direction. As at a corner, each force in
 * between is in equilibrium there for some value of the parameter, if nothing else moves or the nodes stay on its
 * line. Else the nodes would go on together, and the path ends.
 */
bool strut_path_pass_zero_length(strut_path_walk *w, int32_t member) {
  strut_path_system *s = &w->system;
  const strut_member_table *t = &s->model->members;
  double *ahead = &s->latest.ahead[2 * member], *row = w->trial, turn = w->tangent[s->n];
  double value = strut_path_value(s, w->y), arc = w->arc, beyond[2] = {-ahead[0], -ahead[1]};
  int32_t before = w->negative;
  char detail[300];
  strut_path_evaluate(s, w->y);
  if (fabs(s->force[member].pose.strain) > STRUT_PATH_EVEN * s->size)
    return false; /* it has a direction */
  memset(row, 0, ((size_t)s->n + 1) * sizeof *row);
  for (uint32_t c = 0; c < 2; c++) {
    ahead[c] = beyond[c];
    strut_path_add_to_row(s, t->to[member] + c, beyond[c], row);
    strut_path_add_to_row(s, t->from[member] + c, -beyond[c], row);
  }
  memcpy(w->next, w->y, strut_path_bytes(w));
  bool found = strut_path_jump(w, row) && strut_path_tangent(s, w->y, row, w->next_tangent);
  bool still = true;
  for (int32_t i = 0; i < s->n; i++) still = still && fabs(w->y[i] - w->next[i]) < STILL;
  memcpy(w->trial, w->y, strut_path_bytes(w));
  memcpy(w->y, w->next, strut_path_bytes(w));
  if (!found || !(still || is_kept_on_line(s, member, beyond))) return false;
  double jumped = w->arc;
  ahead[0] = -beyond[0], ahead[1] = -beyond[1], w->arc = arc;
  strut_path_add_point(w, before);
  memcpy(ahead, beyond, sizeof beyond), w->arc = jumped;
  memcpy(w->y, w->trial, strut_path_bytes(w));
  memcpy(w->tangent, w->next_tangent, ((size_t)s->n + 1) * sizeof *w->tangent);
  strut_path_count_negative(w);
  snprintf(detail, sizeof detail,
           "%s shrinks to nothing and its force turns round: %s jumps from %.6g to %.6g there",
           s->model->scene->members[member].name, strut_path_subject(w), value,
           strut_path_value(s, w->y));
  strut_path_add_event(w, STRUT_PATH_ZERO_LENGTH, w->y, member, before, w->negative, detail);
  strut_path_report_exchange(w, turn, before);
  return true;
}
