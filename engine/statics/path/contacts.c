/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Contacts in the equations of a path: which touch, on which facet of its surface each lies, and, with friction,
 * whether it sticks or slides one way is frozen between events, as for cables.
 *
 * Where a contact sticks, a spring much stiffer than all else holds its node along the ground; where it slides, the
 * force is that of the kinetic coefficient, and the stiffness has no symmetry. Nothing moves at a speed: laws whose
 * force vanishes with the speed have no part in this.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/model/pose.h"
#include "engine/statics/path/path_parts.h"

static const double ALONG = 1e-9; /* a direction's part across its line */
static const double STILL = 1e-9; /* what does not move [units of y] */
static const double STIFF = 1e5;  /* what holds a contact, over the stiffest member or ground */
static const double SMALL = 1e-6; /* of the range: a jump that is none */

/* Position of a contact's node against a point [m]. */
static void span_from(const strut_path_system *system, uint32_t at, const double *point,
                      strut_dd d[2]) {
  for (uint32_t c = 0; c < 2; c++) {
    const strut_dd place = {system->latest.q[at + c], system->latest.q_low[at + c]};
    d[c] = dd_sub(place, dd_of(point[c]));
  }
}

/* Against the line of a facet, to all digits. */
static void find_on_line(const strut_path_system *system, uint32_t at, const double *point,
                         const strut_contact_axes *axes, strut_contact_pose *pose) {
  strut_dd d[2];
  span_from(system, at, point, d);
  pose->axes = *axes;
  pose->gap = dd_double(dd_add(dd_scale(d[0], axes->normal[0]), dd_scale(d[1], axes->normal[1])));
}

/* The same of a circle. */
static void find_on_circle(const strut_path_system *system, uint32_t at,
                           const strut_surface *circle, strut_contact_pose *pose) {
  strut_dd d[2], distance, gap;
  double sign = circle->inside ? -1.0 : 1.0;
  span_from(system, at, circle->centre, d);
  distance = dd_length(d[0], d[1]);
  if (!(distance.hi > 0.0)) return;
  gap = dd_scale(dd_sub(distance, dd_of(circle->radius)), sign);
  const double normal[2] = {sign * dd_double(dd_div(d[0], distance)),
                            sign * dd_double(dd_div(d[1], distance))};
  pose->axes = (strut_contact_axes){{normal[1], -normal[0]}, {normal[0], normal[1]}};
  pose->gap = dd_double(gap), pose->curvature = sign / dd_double(distance);
}

const char *strut_path_ground_name(const strut_path_system *system, int32_t i) {
  const strut_scene *scene = system->model->scene;
  return scene->ground_count > 1 ? scene->grounds[scene->contacts[i].ground].name : "the ground";
}

/* Contact i at the latest positions against a ground of some terms: its facet if it touches, else the nearest. */
static strut_contact_pose pose_in(const strut_path_system *system, const strut_path_terms *terms,
                                  int32_t i) {
  const strut_contact_table *contacts = &terms->laws->contacts;
  const strut_path_contact *own = &system->contacts.contact[i];
  strut_contact_pose pose = {.axes = contacts->axes};
  const double level[2] = {0.0, contacts->height};
  uint32_t at = contacts->at[i];
  if (!contacts->surface) {
    find_on_line(system, at, level, &contacts->axes, &pose);
    return pose;
  }
  const strut_surface *surface = &contacts->surface[contacts->surface_of[i]];
  bool line = surface->before == HUGE_VAL && surface->beyond == HUGE_VAL && surface->facets == 1;
  if (surface->facets && (own->touches || line)) {
    const strut_facet *facet = &surface->facet[own->touches ? own->facet : 0];
    find_on_line(system, at, facet->point, &facet->axes, &pose);
    pose.facet = own->touches ? own->facet : 0;
    return pose;
  }
  pose = strut_contact_pose_at(contacts, i, system->latest.q, NULL, -1);
  if (!surface->facets) find_on_circle(system, at, surface, &pose);
  return pose;
}

/* ---- friction ---- */

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

/* Force on the node along the tangent for some terms and gap [N]; 0 where there is no friction. */
static double friction_force(const strut_path_system *system, const strut_path_terms *terms,
                             int32_t i, double gap) {
  const strut_path_contact *own = &system->contacts.contact[i];
  if (!own->grips || !own->touches) return 0.0;
  if (own->sticks) return -system->contacts.grip * strain_of(system, i);
  return -own->direction * limit_of(system, terms, i, gap);
}

/* Adds the stiffness; where the contact slides it has no symmetry. */
static void add_friction_block(const strut_path_system *system, int32_t i, double block[4]) {
  const strut_path_contact *own = &system->contacts.contact[i];
  const double *n = own->pose.axes.normal, *t = own->pose.axes.tangent;
  if (!own->grips) return;
  double force = friction_force(system, &system->equations.terms, i, own->pose.gap);
  double per_gap = -friction_force(system, &system->equations.terms, i, 1.0); /* where it slides */
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++)
      block[2 * a + b] += own->sticks
                              ? system->contacts.grip * own->tangent[a] * own->tangent[b]
                              : per_gap * t[a] * n[b] + force * own->pose.curvature * n[a] * t[b];
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

bool strut_path_friction_drops(const strut_path_system *system, int32_t i) {
  const strut_friction law = law_of(&system->equations.terms, i);
  return strut_friction_drops(&law);
}

void strut_path_grip_set(strut_path_system *system, int32_t i, bool on) {
  strut_path_contact *own = &system->contacts.contact[i];
  if (on == own->sticks || !own->grips) return;
  if (on) {
    stick(system, i, friction_force(system, &system->equations.terms, i, own->pose.gap));
    return;
  }
  own->direction = strain_of(system, i) < 0.0 ? -1.0 : 1.0;
  own->sticks = false;
}

/* ---- forces ---- */

/* Derivative of its energy, with friction, by its node's coordinates: minus the force on the node [N]. */
static void gradient_in(const strut_path_system *system, const strut_path_terms *terms, int32_t i,
                        const strut_contact_pose *pose, double gradient[2]) {
  const strut_path_contact *own = &system->contacts.contact[i];
  const double *along = own->sticks ? own->tangent : pose->axes.tangent;
  double normal = terms->laws->contacts.entry[i].stiffness * pose->gap;
  double friction = friction_force(system, terms, i, pose->gap);
  for (int c = 0; c < 2; c++) gradient[c] = normal * pose->axes.normal[c] - friction * along[c];
}

/* How that changes with the parameter where its node stays. */
static void find_rate(const strut_path_system *system, int32_t i, double rate[2]) {
  const strut_path_parameter *parameter = &system->parameter;
  double below[2], above[2];
  const strut_contact_pose low = pose_in(system, &parameter->low, i),
                           high = pose_in(system, &parameter->high, i);
  gradient_in(system, &parameter->low, i, &low, below);
  gradient_in(system, &parameter->high, i, &high, above);
  for (int c = 0; c < 2; c++) rate[c] = (above[c] - below[c]) / parameter->apart;
}

static double stiffness_of(const strut_path_system *system, int32_t i) {
  return system->equations.terms.laws->contacts.entry[i].stiffness;
}

/* The ground as a spring that is there or not, whatever the sign of the gap. */
static void add_contact(strut_path_system *system, int32_t i, strut_force *force) {
  const strut_path_contact *own = &system->contacts.contact[i];
  double gradient[2], rate[2], block[4], stiffness = stiffness_of(system, i);
  strut_force_set_contact(stiffness, &own->pose, force);
  force->across = stiffness * own->pose.gap * own->pose.curvature;
  strut_force_stiffness(system->model, force, system->latest.q, block);
  add_friction_block(system, i, block);
  if (own->sticks) force->across += system->contacts.grip;
  gradient_in(system, &system->equations.terms, i, &own->pose, gradient);
  find_rate(system, i, rate);
  strut_path_add_force(system, force, gradient, rate, block);
}

void strut_path_add_contacts(strut_path_system *system) {
  strut_force *force = strut_path_element_force(system, system->model->elements.count);
  for (int32_t i = 0; i < system->model->contacts.count; i++) {
    system->contacts.contact[i].pose = pose_in(system, &system->equations.terms, i);
    force[i].pose.acts = system->contacts.contact[i].touches;
    if (force[i].pose.acts) add_contact(system, i, &force[i]);
  }
}

void strut_path_contact_reactions(const strut_path_system *system, double *reaction,
                                  double *contact, double *friction) {
  for (int32_t i = 0; i < system->model->contacts.count; i++) {
    const strut_path_contact *own = &system->contacts.contact[i];
    double gradient[2] = {0.0, 0.0};
    if (own->touches) gradient_in(system, &system->equations.terms, i, &own->pose, gradient);
    contact[i] = own->touches ? 0.0 - stiffness_of(system, i) * own->pose.gap : 0.0;
    friction[i] = 0.0 + friction_force(system, &system->equations.terms, i, own->pose.gap);
    for (uint32_t c = 0; c < 2; c++) reaction[system->model->contacts.at[i] + c] += gradient[c];
  }
}

double strut_path_contact_switch_value(const strut_path_system *system, int32_t i) {
  return -pose_in(system, &system->equations.terms, i).gap;
}

void strut_path_contact_switch_set(strut_path_system *system, int32_t i, bool on) {
  strut_path_contact *own = &system->contacts.contact[i];
  if (on && !own->touches) {
    own->pose = pose_in(system, &system->equations.terms, i);
    own->facet = own->pose.facet;
    if (own->grips) stick(system, i, 0.0);
  }
  own->touches = on;
  if (!on) own->sticks = false, own->direction = 0.0;
}

/* What is left of the limit of a contact that sticks, as a depth of the ground. */
double strut_path_grip_value(const strut_path_system *system, int32_t i) {
  const strut_path_contact *own = &system->contacts.contact[i];
  const strut_path_terms *terms = &system->equations.terms;
  if (!own->sticks || !own->touches) return -HUGE_VAL;
  double gap = pose_in(system, terms, i).gap;
  return (limit_of(system, terms, i, gap) - fabs(friction_force(system, terms, i, gap))) /
         stiffness_of(system, i);
}

/* The surface of contact i where it has corners that the contact may pass, or NULL. */
static const strut_surface *cornered(const strut_path_system *system, int32_t i) {
  const strut_contact_table *contacts = &system->equations.terms.laws->contacts;
  const strut_surface *surface =
      contacts->surface ? &contacts->surface[contacts->surface_of[i]] : NULL;
  return surface && surface->facets > 1 && system->contacts.contact[i].touches ? surface : NULL;
}

double strut_path_corner_value(const strut_path_system *system, int32_t i) {
  const strut_surface *surface = cornered(system, i);
  int32_t other;
  if (!surface) return -HUGE_VAL;
  return strut_surface_margin(surface, system->latest.q + system->model->contacts.at[i],
                              system->contacts.contact[i].facet, &other);
}

/* Adds the derivative by coordinate `at` [1] to a row (n + 1) over the unknowns. */
static void add_to_row(const strut_path_system *system, uint32_t at, double entry, double *row) {
  int32_t free = system->potential->row_of[at];
  double moved = system->equations.rates.position[at] * system->parameter.range / system->size;
  row[free >= 0 ? free : system->n] += free >= 0 ? entry : entry * moved;
}

/* Rate of coordinate `at` along a tangent (n + 1), in units of y. */
static double rate_of(const strut_path_system *system, uint32_t at, const double *tangent) {
  int32_t free = system->potential->row_of[at];
  double moved = system->equations.rates.position[at] * system->parameter.range / system->size;
  return free >= 0 ? tangent[free] : tangent[system->n] * moved;
}

/* Corrects walk->y, with row . y as it is; false: it does not converge, and stays. A row of zeros changes nothing. */
static bool jump(strut_path_walk *walk, const double *row) {
  int32_t count = walk->system.n + 1;
  double place = strut_path_dot(walk, row, walk->y) + strut_path_dot(walk, row, walk->y + count);
  if (!(strut_path_dot(walk, row, row) > 0.0)) return true;
  memcpy(walk->next, walk->y, strut_path_bytes(walk));
  if (strut_path_correct(&walk->system, row, place, walk->next) < 0) return false;
  walk->arc += strut_path_distance(walk, walk->next, walk->y);
  memcpy(walk->y, walk->next, strut_path_bytes(walk));
  return true;
}

/* Moves contact i to the facet beside its own; `row` (n + 1) becomes the direction that leads onto it. */
static void change_facet(strut_path_system *system, int32_t i, double *row) {
  const strut_surface *surface = cornered(system, i);
  strut_path_contact *own = &system->contacts.contact[i];
  uint32_t at = system->model->contacts.at[i];
  int32_t other;
  strut_surface_margin(surface, system->latest.q + at, own->facet, &other);
  memset(row, 0, ((size_t)system->n + 1) * sizeof *row);
  for (uint32_t c = 0; c < 2; c++)
    add_to_row(system, at + c,
               surface->facet[other].axes.normal[c] - surface->facet[own->facet].axes.normal[c],
               row);
  own->facet = other;
}

/*
 * Continues from walk->y along the row, or as before where the row is zero. Reports what happened there, and by how much
 * the parameter has jumped from a value, unless by `least` or less. False: there is no tangent.
 */
static bool finish_jump(strut_path_walk *walk, const double *row, strut_path_event_kind kind,
                        int32_t index, double from, double least, const char *what) {
  strut_path_system *system = &walk->system;
  int32_t before = walk->negative;
  double turn = walk->tangent[system->n], to = strut_path_value(system, walk->y);
  char detail[300];
  bool leads = strut_path_dot(walk, row, row) > 0.0;
  if (!strut_path_tangent(system, walk->y, leads ? row : walk->tangent, walk->next_tangent))
    return false;
  int used = snprintf(detail, sizeof detail, "%s", what);
  if (!(fabs(to - from) <= least))
    snprintf(detail + used, sizeof detail - (size_t)used, ": %s jumps from %.6g to %.6g there",
             strut_path_subject(walk), from, to);
  memcpy(walk->tangent, walk->next_tangent, strut_path_bytes(walk) / 2);
  strut_path_count_negative(walk);
  strut_path_add_event(walk, kind, walk->y, index, before, walk->negative, detail);
  strut_path_report_exchange(walk, turn, before);
  return true;
}

/*
 * The force of a contact turns at once where its node passes a corner of the solid. At the corner each force in
 * between is in equilibrium for some value of the parameter, with the node held by nothing else: the path leads
 * along the corner to the value that the facet beyond wants, and that piece is unstable but for a displacement.
 */
bool strut_path_pass_corner(strut_path_walk *walk, int32_t i) {
  strut_path_system *system = &walk->system;
  int32_t node = system->model->contacts.entry[i].node;
  double *row = walk->trial, value = strut_path_value(system, walk->y);
  char what[200];
  strut_path_evaluate(system, walk->y);
  strut_path_add_point(walk, walk->negative);
  change_facet(system, i, row); /* zeros: the ground moves under a support */
  snprintf(what, sizeof what, "%s passes a corner of %s", system->model->scene->nodes[node].name,
           strut_path_ground_name(system, i));
  return jump(walk, row) && finish_jump(walk, row, STRUT_PATH_CORNER, node, value, -1.0, what);
}

/* Do supports keep the two nodes of a member on its line? */
static bool is_kept_on_line(const strut_path_system *system, int32_t member, const double *ahead) {
  const strut_member_table *members = &system->model->members;
  const uint32_t end[2] = {members->from[member], members->to[member]};
  for (int k = 0; k < 2; k++)
    for (uint32_t c = 0; c < 2; c++)
      if (system->potential->row_of[end[k] + c] >= 0 && fabs(ahead[1 - c]) > ALONG) return false;
  return true;
}

/*
 * The force of a member that shrinks to nothing turns round with its direction. As at a corner, each force in
 * between is in equilibrium there for some value of the parameter, if nothing else moves or the nodes stay on its
 * line. Else the nodes would go on together, and the path ends.
 */
bool strut_path_pass_zero_length(strut_path_walk *walk, int32_t member) {
  strut_path_system *system = &walk->system;
  const strut_member_table *members = &system->model->members;
  double *ahead = &system->latest.ahead[2 * member], *row = walk->trial;
  double value = strut_path_value(system, walk->y);
  char what[200];
  strut_path_evaluate(system, walk->y);
  if (fabs(system->force[member].pose.strain) > STRUT_PATH_EVEN * system->size) return false;
  strut_path_add_point(walk, walk->negative);
  memset(row, 0, strut_path_bytes(walk));
  for (uint32_t c = 0; c < 2; c++) {
    ahead[c] = -ahead[c];
    add_to_row(system, members->to[member] + c, ahead[c], row);
    add_to_row(system, members->from[member] + c, -ahead[c], row);
  }
  memcpy(walk->spare, walk->y, strut_path_bytes(walk));
  bool found = jump(walk, row), still = true;
  for (int32_t i = 0; i < system->n; i++)
    still = still && fabs(walk->y[i] - walk->spare[i]) < STILL;
  if (!found || !(still || is_kept_on_line(system, member, ahead))) {
    memcpy(walk->y, walk->spare, strut_path_bytes(walk));
    walk->path->point_count--;
    return false;
  }
  snprintf(what, sizeof what, "%s shrinks to nothing and its force turns round",
           system->model->scene->members[member].name);
  return finish_jump(walk, row, STRUT_PATH_ZERO_LENGTH, member, value, -1.0, what);
}

/* The direction of a contact's tangent, over the unknowns. */
static void fill_row(const strut_path_system *system, int32_t i, double *row) {
  uint32_t at = system->model->contacts.at[i];
  memset(row, 0, ((size_t)system->n + 1) * sizeof *row);
  for (uint32_t c = 0; c < 2; c++)
    add_to_row(system, at + c, system->contacts.contact[i].pose.axes.tangent[c], row);
}

double strut_path_measure_switch(strut_path_system *system, const double *unknowns,
                                 const strut_path_piece *piece, int32_t which) {
  const strut_path_switch kind = strut_path_switch_at(system, which);
  if (kind.of != STRUT_PATH_GRIP) return strut_path_switch_value(system, which, unknowns);
  int32_t i = kind.index;
  const strut_path_contact *own = &system->contacts.contact[i];
  double *along = system->latest.row, back = 0.0;
  if (own->sticks || own->direction == 0.0) return strut_path_switch_value(system, which, unknowns);
  if (!strut_path_tangent(system, unknowns, piece->tangent, along)) return (double)NAN;
  for (uint32_t c = 0; c < 2; c++)
    back -= own->direction * own->pose.axes.tangent[c] *
            rate_of(system, system->model->contacts.at[i] + c, along);
  return back;
}

bool strut_path_pass_grip(strut_path_walk *walk, int32_t which, const double *beyond) {
  strut_path_system *system = &walk->system;
  int32_t i = strut_path_switch_at(system, which).index;
  int32_t node = system->model->contacts.entry[i].node;
  strut_path_contact *own = &system->contacts.contact[i];
  double *row = walk->trial, value = strut_path_value(system, walk->y);
  char what[200];
  bool slips = own->sticks;
  if (slips && strut_path_friction_drops(system, i)) strut_path_add_point(walk, walk->negative);
  strut_path_switch_value(system, which, beyond);
  if (slips) strut_path_grip_set(system, i, false);
  strut_path_evaluate(system, walk->y);
  if (!slips) strut_path_grip_set(system, i, true);
  fill_row(system, i, row);
  /* against the kinetic coefficient it takes less to hold the node where it is */
  if (slips && !jump(walk, row)) return false;
  for (int32_t k = 0; k <= system->n; k++) row[k] *= own->direction; /* 0: it sticks */
  snprintf(what, sizeof what, "%s %s %s", system->model->scene->nodes[node].name,
           slips ? "begins to slide on" : "sticks to", strut_path_ground_name(system, i));
  return finish_jump(walk, row, slips ? STRUT_PATH_SLIP : STRUT_PATH_STICK, node, value,
                     SMALL * fabs(system->parameter.range), what);
}
