/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Tangent stiffness and damping of a configuration: the matrices of small motions about it.
 *
 * strut_tangent_visit goes through the members and contacts that add to them. Whatever is built (a
 * sparse matrix, a product with a vector, a form on modes) gets the same stiffnesses from it. Of a
 * member with the 2 x 2 block B, both ends have B on the diagonal and -B between them.
 */
#ifndef STRUT_ENGINE_FORCES_TANGENT_H
#define STRUT_ENGINE_FORCES_TANGENT_H

#include "engine/forces/elements.h"
#include "engine/model/hot.h"
#include "engine/model/pose.h"
#include "engine/model/sparse.h"

/** Entries of the lower triangle of a member's 4 x 4 block, and of a contact's 2 x 2 one. */
enum { STRUT_MEMBER_ENTRIES = 10, STRUT_CONTACT_ENTRIES = 3 };

/** Rows and columns of those entries: 0, 1 are x and y of the first node, 2, 3 of the second. */
typedef struct strut_block_entry {
  uint8_t row, column;
  uint8_t part;  /* of the block: 0 xx, 1 xy, 2 yy */
  bool opposite; /* between the two nodes: -B */
} strut_block_entry;
static const strut_block_entry strut_block_entries[STRUT_MEMBER_ENTRIES] = {
    {0, 0, 0, false}, {1, 0, 1, false}, {1, 1, 2, false}, {2, 0, 0, true},  {2, 1, 1, true},
    {2, 2, 0, false}, {3, 0, 1, true},  {3, 1, 2, true},  {3, 2, 1, false}, {3, 3, 2, false}};

/** A symmetric 2 x 2 block: xx, xy, yy. */
typedef struct strut_stiffness_block {
  double part[3];
} strut_stiffness_block;

/** across + (along - across) u u'. */
STRUT_INLINE strut_stiffness_block strut_block_of(double along, double across, strut_vec2 u) {
  double more = along - across;
  return (strut_stiffness_block){
      {across + more * u.x * u.x, more * u.x * u.y, across + more * u.y * u.y}};
}

/** stiffness * n n' of the contacts' normal or tangent. */
STRUT_INLINE strut_stiffness_block strut_block_of_contact(double stiffness, const double n[2]) {
  return (strut_stiffness_block){
      {stiffness * n[0] * n[0], stiffness * n[0] * n[1], stiffness * n[1] * n[1]}};
}

/** The same with the tangent's part. */
STRUT_INLINE strut_stiffness_block strut_block_of_pose(double along, double across,
                                                       const strut_contact_axes *axes) {
  strut_stiffness_block block = strut_block_of_contact(along, axes->normal);
  if (across == 0.0) return block;
  strut_stiffness_block more = strut_block_of_contact(across, axes->tangent);
  for (int k = 0; k < 3; k++) block.part[k] += more.part[k];
  return block;
}

/** Adds B, -B, B to values at a member's `place` (STRUT_MEMBER_ENTRIES); -1: supported. */
STRUT_INLINE void strut_block_scatter(const strut_stiffness_block *b, int count,
                                      const int32_t *place, double *value) {
  for (int k = 0; k < count; k++) {
    const strut_block_entry *e = &strut_block_entries[k];
    if (place[k] >= 0) value[place[k]] += e->opposite ? -b->part[e->part] : b->part[e->part];
  }
}

/** The same to the triplets at rows `row`: 4 of a member, 2 of a contact; -1: supported. */
void strut_block_add(const strut_stiffness_block *b, int count, const int32_t *row,
                     strut_triplets *sum);

/** Rows of the four coordinates of member j. */
STRUT_INLINE void strut_member_rows(const strut_model *model, const int32_t *row_of, int32_t j,
                                    int32_t row[4]) {
  const int32_t *a = row_of + model->members.from[j], *b = row_of + model->members.to[j];
  row[0] = a[0], row[1] = a[1], row[2] = b[0], row[3] = b[1];
}

/** Adds the lower triangle of an element's matrix k (2 nodes, 2 nodes) to the triplets. */
void strut_element_add(const strut_model *model, int32_t element, const double *k,
                       const int32_t *row_of, strut_triplets *sum);
/** The same to values at the element's places, of which `place` holds those of all elements. */
void strut_element_scatter(const strut_model *model, int32_t element, const double *k,
                           const int32_t *place, double *value);

/** Most entries that members, elements and, if wanted, contacts may add to a matrix. */
static inline size_t strut_tangent_entries(const strut_model *model, bool contacts) {
  return STRUT_MEMBER_ENTRIES * (size_t)model->members.count + (size_t)model->elements.entries +
         (contacts ? STRUT_CONTACT_ENTRIES * (size_t)model->contacts.count : 0);
}

/** Index of the first of the places of elements, and of contacts. */
static inline size_t strut_places_of_elements(const strut_model *model) {
  return STRUT_MEMBER_ENTRIES * (size_t)model->members.count;
}
static inline size_t strut_places_of_contacts(const strut_model *model) {
  return strut_tangent_entries(model, false);
}

/**
 * Numbers the free coordinates, those neither supported nor, where `held` (length) is not NULL, held:
 * row_of (length), -1 of the others, and coordinate (n), index into coordinate arrays. Returns n.
 */
int32_t strut_number_free(const strut_model *model, const uint8_t *held, int32_t *row_of,
                          int32_t *coordinate);

/** Adds zeros where members, elements and, if wanted, contacts may add to a matrix. */
void strut_tangent_add_pattern(const strut_model *model, const int32_t *row_of, bool contacts,
                               strut_triplets *sum);
/** Positions of those entries in the pattern's values: members, then elements, then contacts. */
void strut_tangent_find_places(const strut_model *model, const int32_t *row_of, bool contacts,
                               const strut_sparse *pattern, int32_t *place);

/** Which contacts count as closed, with the ground's forces as in strut_tangent_assemble. */
typedef enum strut_closed {
  STRUT_CLOSED_NONE,
  STRUT_CLOSED_TOUCHING, /* those below the ground in q */
  STRUT_CLOSED_ALL,      /* every node that may touch, and every stop: the stiffest case */
  STRUT_CLOSED_UNDAMPED  /* the same without the ground's dampers, but with smooth friction */
} strut_closed;

/** A member that carries a force, and its stiffnesses [N/m] along and across. */
typedef struct strut_member_tangent {
  strut_member_pose pose;
  double along, across;
} strut_member_tangent;

/** A contact that is closed, its spring [N/m] and its gap [m]; its axes, and the stiffness along the tangent
    that a curved surface adds, for contacts that touch [N/m]. */
typedef struct strut_closed_contact {
  double gap, stiffness;
  strut_contact_axes axes;
  double across;
} strut_closed_contact;

typedef void strut_visit_member(void *context, int32_t member, const strut_member_tangent *tangent);
typedef void strut_visit_contact(void *context, int32_t contact,
                                 const strut_closed_contact *tangent);

/**
 * Calls `member` of every member that carries a force in q with rest lengths `rest` (slots), in the
 * scene's order, then `element` of every element that acts, then `contact` of every closed contact.
 * Those that carry one sign of force only, and contacts, are left out if their force is at most `least`
 * [N]. Inlined, and so are static functions passed to it.
 */
STRUT_INLINE void strut_tangent_visit(const strut_model *model, const double *q, const double *rest,
                                      double least, strut_closed closed, void *context,
                                      strut_visit_member *member, strut_visit_element *element,
                                      strut_visit_contact *contact) {
  const strut_member_table *t = &model->members;
  const strut_contact_table *c = &model->contacts;
  for (int32_t j = 0; j < t->count; j++) {
    strut_member_tangent m = {.pose = strut_member_pose_at(t, rest, j, q),
                              .along = t->stiffness[j]};
    if (!m.pose.taut || (t->slack[j] == 0.0 && m.along * m.pose.stretch <= least)) continue;
    m.across = strut_member_across_stiffness(t, rest, j, &m.pose);
    member(context, j, &m);
  }
  if (model->elements.count)
    strut_elements_visit(model, rest, q, least,
                         closed == STRUT_CLOSED_ALL || closed == STRUT_CLOSED_UNDAMPED, context,
                         element);
  for (int32_t i = 0, end = 0, near[2] = {0}; i < c->count && closed != STRUT_CLOSED_NONE; i++) {
    if (c->surface && closed != STRUT_CLOSED_TOUCHING) {
      if (i == end) end = strut_contacts_nearest(c, i, q, near);
      if (i != near[0] && i != near[1]) continue;
    }
    strut_contact_pose pose = strut_contact_pose_at(c, i, q, NULL, -1);
    strut_closed_contact n = {pose.gap, c->entry[i].stiffness, pose.axes, 0.0};
    if (pose.gap < 0.0 && pose.curvature != 0.0) n.across = n.stiffness * pose.gap * pose.curvature;
    if (closed == STRUT_CLOSED_TOUCHING && (!(n.gap < 0.0) || -n.stiffness * n.gap <= least))
      continue;
    contact(context, i, &n);
  }
}

typedef struct strut_tangent {
  int32_t n;                 /* free coordinates */
  int32_t *coordinate;       /* (n) index into coordinate arrays */
  strut_sparse *stiffness;   /* K = sum c u u' + (t/L)(1 - u u') + ground [N/m] */
  strut_sparse *damping;     /* D = sum k u u' + alpha M + ground [N s/m] */
  struct strut_rigid *rigid; /* NULL, or rigid bars, which leave fewer motions; see rigid.h */
} strut_tangent;

/**
 * K and D at positions q (length) with rest lengths `rest` (slots), supports eliminated, members slack
 * there left out. With those two that close all contacts, Hunt-Crossley dampers and friction laws with
 * a slope are linearised with half the weight on each contact. Everything is in the arena. STRUT_OK or
 * STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_tangent_assemble(const strut_model *model, const double *q,
                                              const double *rest, strut_closed closed,
                                              strut_arena *arena, strut_tangent *tangent);

#endif
