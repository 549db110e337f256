/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Small motions about a shape: M x'' + D x' + K x = 0 on the free coordinates.
 *
 * K and the forces are computed in twice a double's precision, because the softest motions of a
 * structure may be 1e-16 times as stiff as its hardest; strains of elements in a double's. Drives are at rest, friction does not act.
 */
#ifndef STRUT_ENGINE_STATICS_MODES_VIBRATION_H
#define STRUT_ENGINE_STATICS_MODES_VIBRATION_H

#include "engine/base/double_double.h"
#include "engine/forces/elements.h"
#include "engine/statics/potential.h"

/** A member in the shape. */
typedef struct strut_vibration_member {
  strut_dd ux, uy;  /* from its first node to the second; 0 where it has no length */
  strut_dd stretch; /* [m] */
  strut_dd across;  /* force / length: stiffness across it [N/m] */
  double length;    /* [m] */
  bool taut;        /* pulls or pushes */
  int8_t state;     /* 1: taut, -1: slack, whatever the stretch; 0: by the stretch */
} strut_vibration_member;

typedef struct strut_vibration {
  const strut_model *model;
  strut_potential *shape; /* coordinates, and the pattern of all matrices here; owned */
  int32_t n;
  strut_dd *q;                    /* (length) [m] */
  double *rounded;                /* (length) the same in a double: what elements use */
  strut_vibration_member *member; /* (member_count) */
  uint8_t *closed;                /* (contacts) 1 where the ground pushes, there with stiffness */
  strut_dd *k;                    /* K [N/m], in the pattern's places as the next two */
  double *m, *d;                  /* M [kg], D [N s/m] */
  double *mass;                   /* (n) row sums of M: 0 where nothing has mass */
  int32_t massive;                /* rows with mass */
  double largest;                 /* an upper bound of the eigenvalues of K x = z M x [1/s^2] */
  strut_dd *work;                 /* (n) */
  strut_arena arena;
  double *own_mass; /* (n) diagonal of M without sliding masses */
  bool *idle;       /* (elements) it does not act, whatever its strain */
} strut_vibration;

/**
 * At positions q (length); closed: nodes that touch the ground; held: (length) as for
 * strut_potential_create. The model must outlive it. STRUT_OK or STRUT_NO_MEMORY.
 */
strut_status strut_vibration_create(const strut_model *model, const double *q,
                                    const int32_t *closed, int32_t closed_count,
                                    const uint8_t *held, strut_vibration **vibration,
                                    strut_error *error);
void strut_vibration_free(strut_vibration *vibration);

/** Pose of contact i. */
strut_contact_pose strut_vibration_contact(const strut_vibration *vibration, int32_t i);

/** Computes members and K anew after a change of q. */
void strut_vibration_update(strut_vibration *vibration);

/** force (n): net force of members, ground, gravity and constant loads on free coordinates [N]. */
void strut_vibration_force(const strut_vibration *vibration, strut_dd *force);

/** y = K x. */
void strut_vibration_stiffness(const strut_vibration *vibration, const strut_dd *x, strut_dd *y);
/** y = A x for M or D. */
void strut_vibration_multiply(const strut_vibration *vibration, const double *matrix,
                              const double *x, double *y);
/** y = M x. */
void strut_vibration_mass(const strut_vibration *vibration, const strut_dd *x, strut_dd *y);

/** Relative motion of the ends of member j in the motion x (n), along it and across it. */
typedef struct strut_end_displacement {
  double along, across;
} strut_end_displacement;
strut_end_displacement strut_vibration_spread(const strut_vibration *vibration, int32_t j,
                                              const double *x);

/**
 * Does a member or an element that acts one way only sit at the edge of that, to the last bits of its length
 * or strain? Whether it acts is then rounding, unless loads decide it.
 */
bool strut_vibration_is_borderline(const strut_vibration *vibration, int32_t member);
bool strut_vibration_element_is_borderline(const strut_vibration *vibration, int32_t element);

/**
 * An element in the shape: strain, force and gradient with the digits of positions that a double does
 * not have, to first order. False where it does not act.
 */
bool strut_vibration_pose(const strut_vibration *vibration, int32_t element,
                          strut_element_pose *pose);
/** How the motion x (n) of its coordinate k (2 nodes) differs from that of an element's last node. */
double strut_vibration_relative(const strut_vibration *vibration, int32_t element, int32_t k,
                                const double *x);
/** How the strain of an element changes in the motion x (n). */
double strut_vibration_strain(const strut_vibration *vibration, int32_t element,
                              const strut_element_pose *pose, const double *x);

#endif
