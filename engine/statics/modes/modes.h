/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Natural frequencies and shapes of small motions about an equilibrium, contacts closed there.
 *
 * K x = z M x, z = omega^2. Up to STRUT_DENSE_MODES free coordinates by GSL's dense eigensolver,
 * above by shift-invert Lanczos (ARPACK), which is checked against the number of eigenvalues below
 * the last one that a factor's signs count. Each mode is then improved by inverse iteration in
 * twice a double's precision until its eigenvalue is right to 1e-12 or cannot be.
 *
 * Friction and drives do not act; a closed contact is a spring both ways, its damper too.
 */
#ifndef STRUT_ENGINE_STATICS_MODES_MODES_H
#define STRUT_ENGINE_STATICS_MODES_MODES_H

#include "engine/base/double_double.h"
#include "engine/forces/elements.h"
#include "engine/model/model.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"
#include "engine/statics/potential.h"

enum { STRUT_DENSE_MODES = 400, STRUT_SPARSE_MODES = 10, STRUT_DAMPED_MODES = 160 };

typedef enum strut_mode_kind {
  STRUT_MODE_RIGID,     /* no stiffness: a rigid motion that supports and contacts leave */
  STRUT_MODE_MECHANISM, /* no stiffness, but not rigid */
  STRUT_MODE_ELASTIC,
  STRUT_MODE_UNSTABLE /* eigenvalue below zero: it grows */
} strut_mode_kind;

/** "rigid-body", "mechanism", "elastic", "unstable". */
STRUT_API const char *strut_mode_kind_name(strut_mode_kind kind);

/** What a member that only pulls, or only pushes, does in the shape. */
typedef enum strut_idleness {
  STRUT_ACTS,
  STRUT_SLACK,
  STRUT_JUST_TAUT /* without a force: it would act one way only, so that it counts as slack */
} strut_idleness;

typedef struct strut_mode {
  double eigenvalue;        /* omega^2 [1/s^2]; 0 where there is no stiffness */
  double angular_frequency; /* [rad/s]; 0 where the eigenvalue is not above zero */
  double damping_ratio;     /* [1]; NAN where there is nothing to oscillate */
  double damped_frequency;  /* [rad/s]; 0 where it creeps */
  double decay_rate;        /* of the amplitude, the slower one where it creeps [1/s] */
  double residual;          /* |K x - z M x| / (|K x| + |z M x|); without stiffness, |K x| relative
                              to the largest there can be */
  double error; /* of the eigenvalue, relative, estimated: of the method, and of the last
                              bits of the scene's numbers */
  strut_mode_kind kind;
  int32_t just_taut;     /* of a mechanism: members without force that would resist it one way */
  double *shape;         /* (length) largest entry 1 */
  char description[200]; /* in words */
} strut_mode;

typedef struct strut_modes {
  const char *at;      /* name of the equilibrium */
  const double *q;     /* (length) its shape [m] */
  int32_t coordinates; /* free ones */
  int32_t closed_count;
  const int32_t *closed;          /* (closed_count) nodes */
  const strut_idleness *idleness; /* (members) */
  bool dense;                     /* all modes were computed */
  bool damped_exactly; /* damping from the quadratic eigenproblem; else by the modal quotient */
  bool at_rest;        /* the shape is an equilibrium */
  strut_settle_summary settle; /* of strut_rest_state */
  double condition;            /* largest eigenvalue over the smallest that is not zero */
  size_t count;
  strut_mode *list; /* by eigenvalue */
  strut_arena arena;
} strut_modes;

typedef struct strut_modes_options {
  const char *at; /* as for strut_rest_state_find */
  int32_t count;  /* number of lowest modes; 0: all if dense, else STRUT_SPARSE_MODES */
  bool stuck;     /* nodes that touch are held along the ground too, as friction would */
  bool sparse;    /* by Lanczos's method whatever the size */
} strut_modes_options;

/**
 * Fails with what strut_rest_state_find fails with; STRUT_SINGULAR where an elastic mode asked for
 * cannot be had to 1e-8, with the condition, and where a node without mass is held by nothing;
 * STRUT_BAD_SCENE where nothing is free to move or nothing has mass; STRUT_NO_MEMORY.
 * strut_modes_free releases it, after a failure too. The model must outlive it.
 */
STRUT_API strut_status strut_modes_find(const strut_model *model,
                                        const strut_experiment *experiment,
                                        const strut_modes_options *options, strut_modes *modes,
                                        strut_error *error);
STRUT_API void strut_modes_free(strut_modes *modes);

/* Small motions about a shape: M x'' + D x' + K x = 0 on the free coordinates.
 *
 * K and the forces are computed in twice a double's precision, because the softest motions of a
 * structure may be 1e-16 times as stiff as its hardest; strains of elements in a double's. Drives are at rest, friction does not act.
 */

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
