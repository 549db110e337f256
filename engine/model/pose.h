/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Kinematics of members and contacts in a configuration q, (length) coordinates.
 *
 * This is the one place that says how long a member is, when it carries a force and how far a node is
 * above the ground. The step's vector kernels (members_kernel.h, forces_kernel.h) repeat
 * it for several members at once; tests/unit/pose_test.c compares them.
 */
#pragma once

#include <assert.h>
#include <float.h>

#include "engine/base/vec.h"
#include "engine/model/model.h"
#include "engine/model/surfaces.h"
#include "engine/scene/laws/ground.h"
#include "engine/scene/laws/member.h"

typedef struct strut_member_pose {
  strut_vec2 span;        /* from its first node to its second [m] */
  strut_vec2 unit;        /* the span's direction; 0 where it has no length */
  double length, stretch; /* stretch: length beyond the rest length [m] */
  bool taut;              /* carries a force: a bar or spring always, a cable when stretched */
} strut_member_pose;

/** From member j's first node to its second [m]. */
static inline strut_vec2 strut_member_span(const strut_member_table *members, int32_t j,
                                           const double *positions) {
  assert(j >= 0 && j < members->slots);
  return strut_vec2_between(positions + members->from[j], positions + members->to[j]);
}

static inline double strut_member_length(const strut_member_table *members, int32_t j,
                                         const double *positions) {
  return strut_vec2_length(strut_member_span(members, j, positions));
}

/** Pose of member j with rest lengths `rest` (slots): the table's own, or a state's driven ones. */
static inline strut_member_pose strut_member_pose_at(const strut_member_table *members,
                                                     const double *rest, int32_t j,
                                                     const double *positions) {
  assert(j >= 0 && j < members->count);
  strut_member_pose pose = {.span = strut_member_span(members, j, positions)};
  pose.length = strut_vec2_length(pose.span);
  pose.unit = strut_vec2_unit(pose.span, pose.length);
  pose.stretch = pose.length - rest[j];
  pose.taut = strut_law_member_is_taut(pose.stretch, members->slack[j]);
  return pose;
}

/** Rate of the length at velocities v [m/s]; 0 where it has no length. */
static inline double strut_member_rate(const strut_member_table *members, int32_t j,
                                       const strut_member_pose *pose, const double *velocity) {
  strut_vec2 w = strut_member_span(members, j, velocity);
  double inverse = pose->length > 0.0 ? 1.0 / pose->length : 0.0;
  return (w.x * pose->span.x + w.y * pose->span.y) * inverse;
}

/** Force of the spring, tension positive [N]; 0 of a slack cable. */
static inline double strut_member_elastic_force(const strut_member_table *members, int32_t j,
                                                const strut_member_pose *pose) {
  return pose->taut ? members->stiffness[j] * pose->stretch : 0.0;
}

/** Energy of the spring [J]; 0 of a slack cable. */
static inline double strut_member_elastic_energy(const strut_member_table *members, int32_t j,
                                                 const strut_member_pose *pose) {
  return strut_law_member_energy(members->stiffness[j], pose->stretch, pose->taut);
}

/**
 * Stiffness of a taut member across its direction: tension over length [N/m]. Without length it is an
 * isotropic spring if its rest length is zero too, and has no direction to be stiff across otherwise.
 */
static inline double strut_member_across_stiffness(const strut_member_table *members,
                                                   const double *rest, int32_t j,
                                                   const strut_member_pose *pose) {
  if (pose->length > 0.0) return members->stiffness[j] * pose->stretch / pose->length;
  return rest[j] > 0.0 ? 0.0 : members->stiffness[j];
}

/** The largest rounding error of a coordinate of points a and b [m]. */
static inline double strut_coordinate_rounding(const double *first, const double *second) {
  return DBL_EPSILON * strut_larger(strut_larger(fabs(first[0]), fabs(first[1])),
                                    strut_larger(fabs(second[0]), fabs(second[1])));
}

/** Height of a point above the ground's line, along its normal; the ground touches below 0 [m]. */
static inline double strut_ground_gap(const strut_contact_table *contacts, const double *point) {
  return point[0] * contacts->normal[0] + (point[1] - contacts->height) * contacts->normal[1];
}

/**
 * Contact i in q: against the nearest facet of its surface, or against `facet` alone where that is not
 * negative. motion: of the grounds, or NULL where they are as drawn.
 */
static inline strut_contact_pose strut_contact_pose_at(const strut_contact_table *contacts,
                                                       int32_t i, const double *positions,
                                                       const strut_ground_motion *motion,
                                                       int32_t facet) {
  assert(i >= 0 && i < contacts->count);
  strut_contact_pose pose = {.axes = contacts->axes};
  const double *at = positions + contacts->at[i];
  if (!contacts->surface) {
    pose.gap = strut_ground_gap(contacts, at);
    return pose;
  }
  const strut_surface *surface = &contacts->surface[contacts->surface_of[i]];
  const double *place = surface->moves && motion ? motion[surface->ground].place : NULL;
  const double point[2] = {at[0] - (place ? place[0] : 0.0), at[1] - (place ? place[1] : 0.0)};
  strut_surface_find(surface, point, facet, &pose);
  return pose;
}

/** The contact after those of the node of contact `first`. */
STRUT_API int32_t strut_contacts_end_of_node(const strut_contact_table *contacts, int32_t first);
/**
 * Contacts first .. end - 1, of one node, without those whose gap in q exceeds `margin` [m] for certain and
 * is not negative: few of the many pieces of a long profile. Ascending, into list; returns their number.
 */
STRUT_API int32_t strut_contacts_near(const strut_contact_table *contacts, int32_t first,
                                      int32_t end, const double *positions,
                                      const strut_ground_motion *motion, double margin,
                                      int32_t *list);

/** The gap alone. */
static inline double strut_contact_gap_at(const strut_contact_table *contacts, int32_t i,
                                          const double *positions,
                                          const strut_ground_motion *motion) {
  assert(i >= 0 && i < contacts->count);
  if (!contacts->surface) return strut_ground_gap(contacts, positions + contacts->at[i]);
  return strut_contact_pose_at(contacts, i, positions, motion, -1).gap;
}

/** The same where the grounds are as drawn. */
static inline double strut_contact_gap(const strut_contact_table *contacts, int32_t i,
                                       const double *positions) {
  return strut_contact_gap_at(contacts, i, positions, NULL);
}

/**
 * The two pieces that are nearest to their node of contacts `first` and following, of this node with one
 * ground: a node hardly touches more of them at once. near[1] is near[0] where there is only one. Returns the
 * contact after these.
 */
STRUT_API int32_t strut_contacts_nearest(const strut_contact_table *contacts, int32_t first,
                                         const double *positions, int32_t near[2]);

/** Is a displacement of the whole structure along x no change to any contact? */
static inline bool strut_contacts_are_level(const strut_contact_table *contacts) {
  return contacts->normal[0] == 0.0 && (!contacts->surface || contacts->parallel);
}

/** Is there a direction, `tangent`, along which the whole structure may travel over the ground? */
static inline bool strut_contacts_allow_travel(const strut_contact_table *contacts) {
  return contacts->count > 0 && (!contacts->surface || contacts->parallel);
}

/** Does it do so without anything that holds a node? */
static inline bool strut_model_travels(const strut_model *model) {
  bool travels = strut_contacts_allow_travel(&model->contacts);
  for (int32_t i = 0; i < 2 * model->node_count; i++) travels = travels && !model->fixed[i];
  return travels;
}

/** Speed of the belt of contact i [m/s]. */
static inline double strut_contact_belt(const strut_contact_table *contacts, int32_t i) {
  assert(i >= 0 && i < contacts->count);
  return contacts->surface ? contacts->surface[contacts->surface_of[i]].belt_speed
                           : contacts->belt_speed;
}

/** Motion of the ground of contact i, or NULL where it is at rest. */
static inline const strut_ground_motion *strut_contact_motion(const strut_contact_table *contacts,
                                                              int32_t i,
                                                              const strut_ground_motion *motion) {
  assert(i >= 0 && i < contacts->count);
  if (!contacts->surface || !motion) return NULL;
  const strut_surface *surface = &contacts->surface[contacts->surface_of[i]];
  return surface->moves ? &motion[surface->ground] : NULL;
}

/** Component out of a single straight ground of what x (length) holds at contact i. */
static inline double strut_contact_along_normal(const strut_contact_table *contacts, int32_t i,
                                                const double *vector) {
  assert(i >= 0 && i < contacts->count);
  const double *at = vector + contacts->at[i];
  return at[0] * contacts->normal[0] + at[1] * contacts->normal[1];
}

/** Component along a single straight ground of what x (length) holds at contact i. */
static inline double strut_contact_along_ground(const strut_contact_table *contacts, int32_t i,
                                                const double *vector) {
  assert(i >= 0 && i < contacts->count);
  const double *at = vector + contacts->at[i];
  return at[0] * contacts->tangent[0] + at[1] * contacts->tangent[1];
}

/** Sliding speed of contact i against the belt of a single straight ground at velocities v [m/s]. */
static inline double strut_contact_slip(const strut_contact_table *contacts, int32_t i,
                                        const double *velocity) {
  return strut_contact_along_ground(contacts, i, velocity) - contacts->belt_speed;
}

/* The law of the ground for single contacts: the text of scene/laws/ground.h for doubles. */

/** The numbers of a contact as the law takes them. */
static inline strut_law_ground_numbers strut_contact_numbers(const strut_contact_entry *contact) {
  return (strut_law_ground_numbers){-contact->stiffness, -contact->damping, contact->dissipation};
}

/*
 * Which facet of a surface is nearest to a point, and which pieces of a profile are near: by trees of bounds
 * where there are many, with the answers of a search through all of them, ties included.
 */

/** Signed distance of a point from the line of a facet [m]. */
static inline double strut_facet_across(const strut_facet *facet, const double p[2]) {
  return (p[0] - facet->point[0]) * facet->axes.normal[0] +
         (p[1] - facet->point[1]) * facet->axes.normal[1];
}

/** Position of a point along a facet, from where that begins [m]. */
static inline double strut_facet_along(const strut_facet *facet, const double p[2]) {
  return (p[0] - facet->point[0]) * facet->axes.tangent[0] +
         (p[1] - facet->point[1]) * facet->axes.tangent[1];
}

/** The point of a facet that is nearest to some point. */
typedef struct strut_facet_foot {
  double at[2], distance; /* [m] */
  bool held;              /* it is an end of the facet */
} strut_facet_foot;

/** The largest signed distance of p from the lines of all facets but `except` (-1: of all); *which: the first
    facet that has it. -INFINITY, and facet 0, where there is none. */
double strut_surface_outermost(const strut_surface *surface, const double p[2], int32_t except,
                               int32_t *which);
/** The first of the facets that are nearest to p, as far as they reach; -1: p is not finite. */
int32_t strut_surface_nearest(const strut_surface *surface, const double p[2],
                              strut_facet_foot *foot);

/** Makes the tree over the facets of a compiled surface, where they are many; false: out of memory. */
bool strut_surface_bound_facets(strut_arena *arena, strut_surface *surface);
/** Makes the tree over the pieces of one profile, likewise, for all of them. */
bool strut_surface_bound_pieces(strut_arena *arena, strut_surface *pieces, size_t count);

/**
 * Contacts from `first` on that are those of one node with all pieces of a long profile, which is searched by
 * a tree; 0 where it begins none.
 */
int32_t strut_contacts_of_profile(const strut_contact_table *contacts, int32_t first);
/** The contact of these whose gap in q is least, the first of several; *gap: that [m]. */
int32_t strut_contacts_lowest(const strut_contact_table *contacts, int32_t first,
                              const double *positions, const strut_ground_motion *motion,
                              double *gap);
/** Of the pieces of a long profile, `first` on, the one whose gap from p is least; its number. */
int32_t strut_surface_lowest(const strut_surface *first, const double p[2], double *gap);
/** strut_contacts_near of all nodes, with no margin; all contacts where there is one straight line at rest. */
int32_t strut_contacts_all_near(const strut_contact_table *contacts, const double *positions,
                                const strut_ground_motion *motion, int32_t *list);
