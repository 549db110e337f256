/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The one visitor of everything that exerts a force in a configuration, and tangent stiffness and damping.
 *
 * Plain members, elements and closed contacts are the same: a strain with its gradient b, a force t along it, and a
 * slope; the nodes feel -t b, and the stiffness is (dt/de) b b' + t d2e/dq2. Whatever is built (a sum of forces, a
 * sparse matrix, a product with a vector, a form on modes) is one loop over them:
 *
 *   strut_force_visit visit = {.model = model, .q = q, .rest = rest, .closed = STRUT_CLOSED_TOUCHING};
 *   for (const strut_force *force; (force = strut_force_next(&visit));) ...
 */
#pragma once

#include "engine/forces/elements.h"
#include "engine/model/algebra/hot.h"
#include "engine/model/algebra/linear_solver.h"
#include "engine/model/pose.h"
#include "engine/model/state.h"

typedef enum strut_force_kind {
  STRUT_FORCE_MEMBER,
  STRUT_FORCE_ELEMENT,
  STRUT_FORCE_CONTACT
} strut_force_kind;

/** A force in a configuration. Not to be copied: `at` may point into it. */
typedef struct strut_force {
  strut_force_kind kind;
  int32_t index;           /* member, element or contact of the model */
  int32_t nodes;           /* that it acts on */
  const uint32_t *at;      /* (nodes) where their x stand in coordinate arrays */
  int32_t place;           /* of its entries among those of all forces, strut_tangent_find_places */
  double damping;          /* force per rate of the strain */
  strut_element_pose pose; /* of a contact the gap is the strain */
  double side[4],
      across; /* of members and contacts: d2e/dq2 times the force is across side side' */
  uint32_t end[2];
} strut_force;

/** Coordinate k (2 nodes) of a force. */
static inline uint32_t strut_force_coordinate(const strut_force *force, int32_t k) {
  return force->at[k / 2] + (uint32_t)(k % 2);
}

/** Which contacts count as closed, with the ground's forces as in strut_tangent_assemble. */
typedef enum strut_closed {
  STRUT_CLOSED_NONE,
  STRUT_CLOSED_TOUCHING, /* those below the ground in q */
  STRUT_CLOSED_ALL,      /* every node that may touch, and every stop: the stiffest case */
  STRUT_CLOSED_UNDAMPED  /* the same without the ground's dampers, but with smooth friction */
} strut_closed;

typedef struct strut_force_visit {
  const strut_model *model;
  const double *q, *rest; /* (length), (slots) */
  double least;           /* see strut_force_next [N] */
  strut_closed closed;
  int32_t next, surface_end,
      near[2]; /* the next force; contacts of a node, and the nearest of them */
  strut_force now;
} strut_force_visit;

/** Forces of a model, acting or not: members in the scene's order, elements, then, if wanted, contacts. */
static inline int32_t strut_force_count(const strut_model *model, bool contacts) {
  return model->members.count + model->elements.count + (contacts ? model->contacts.count : 0);
}
/** Kind, index, nodes, place and damping of the force of that number. */
void strut_force_begin(const strut_model *model, int32_t number, strut_force *force);
/** The rest of a member from its stiffness along and across, its direction, length and stretch. */
void strut_force_set_member(double stiffness, double across, strut_vec2 unit, double length,
                            double stretch, strut_force *force);
/** The rest of a contact. */
void strut_force_set_contact(double stiffness, const strut_contact_pose *pose, strut_force *force);
/**
 * The next force that acts, or NULL. Those that carry one sign of force only, and contacts, are left out if their force
 * is at most `least`; of contacts on surfaces that need not touch those nearest to their node are visited.
 */
const strut_force *strut_force_next(strut_force_visit *visit);

/** matrix (2 nodes, 2 nodes) = factor b b'. */
void strut_force_square(const strut_force *force, double factor, double *matrix);
/** matrix (2 nodes, 2 nodes) += factor d2e/dq2 times the force. */
void strut_force_bend(const strut_model *model, const strut_force *force, const double *q,
                      double factor, double *matrix);
/** The tangent stiffness: both with what the force has. */
void strut_force_stiffness(const strut_model *model, const strut_force *force, const double *q,
                           double *matrix);

/** matrix (4, 4): of a member, across + (along - across) u u' at both ends, and minus that between them. */
STRUT_INLINE void strut_member_stiffness(double along, double across, strut_vec2 u,
                                         double *matrix) {
  double more = along - across;
  const double part[3] = {across + more * u.x * u.x, more * u.x * u.y, across + more * u.y * u.y};
  for (int r = 0; r < 4; r++)
    for (int c = 0; c < 4; c++)
      matrix[4 * r + c] = r / 2 == c / 2 ? part[r % 2 + c % 2] : -part[r % 2 + c % 2];
}

/** Adds the lower triangle of a matrix (2 nodes, 2 nodes) of a force to the triplets. */
void strut_force_add(const strut_force *force, const double *matrix, const int32_t *row_of,
                     strut_triplets *sum);
/** The same to the values of a pattern; place: those of all forces, of strut_tangent_find_places. */
void strut_force_scatter(const strut_force *force, const double *matrix, const int32_t *place,
                         double *value);

/** Most entries that members, elements and, if wanted, contacts may add to a matrix. */
static inline size_t strut_tangent_entries(const strut_model *model, bool contacts) {
  return 10 * (size_t)model->members.count + (size_t)model->elements.entries +
         (contacts ? 3 * (size_t)model->contacts.count : 0);
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
/** Positions of those entries in the pattern's values. */
void strut_tangent_find_places(const strut_model *model, const int32_t *row_of, bool contacts,
                               const strut_sparse *pattern, int32_t *place);

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

/* Rayleigh's damping by mass, alpha M v; its part by stiffness is in the dampers of members and hinges. */

/** Subtracts alpha M v from state->latest->force and accumulates what that takes as lost in members. */
void strut_mass_damping_apply(const strut_model *model, const strut_state *state,
                              const double *velocity);
