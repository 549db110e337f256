/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The model: a scene compiled into indices and numbers, constant from then on.
 *
 * A model is shared by threads without locks. It refers to the scene it came from for names, so the scene
 * must outlive it. Coordinate arrays follow the paper's q = (x1, y1, x2, y2, ...): node i has its x at 2 i
 * and its y at 2 i + 1, and one unused node or more pad them to `length` doubles. Supports are eliminated
 * from the mass matrix, and their coordinates simply never accelerate. Members keep the scene's order, so
 * that a term left out changes no bit of the others.
 */
#ifndef STRUT_ENGINE_MODEL_MODEL_H
#define STRUT_ENGINE_MODEL_MODEL_H

#include <stdbool.h>
#include <stdint.h>

#include "engine/base/memory.h"
#include "engine/base/status.h"
#include "engine/model/algebra/pull_rows.h"
#include "engine/model/elements.h"
#include "engine/model/feedback.h"
#include "engine/model/rubbing.h"
#include "engine/model/sliding_masses.h"
#include "engine/model/support_motion.h"
#include "engine/model/surfaces.h"
#include "engine/scene/scene.h"

/** The terms a scene may need. The terms of a model is the set of those it does need. */
typedef enum strut_term {
  STRUT_TERM_MEMBERS = 1 << 0,  /* elastic forces (1) */
  STRUT_TERM_DAMPING = 1 << 1,  /* member dampers (2) */
  STRUT_TERM_SLACK = 1 << 2,    /* the slack test of cables */
  STRUT_TERM_DRIVE = 1 << 3,    /* driven rest lengths (6) */
  STRUT_TERM_CONSTANT = 1 << 4, /* gravity (7) and constant loads */
  STRUT_TERM_LOADS = 1 << 5,    /* loads that change with time */
  STRUT_TERM_CONTACT = 1 << 6,  /* ground reaction (8) */
  STRUT_TERM_FRICTION = 1 << 7, /* Coulomb with Karnopp's band (9) */
  STRUT_TERM_SLOPE = 1 << 8,    /* the ground is inclined */
  STRUT_TERM_SOLVE = 1 << 9,    /* the mass matrix is not diagonal */
  STRUT_TERM_LAWS = 1 << 10, /* some contact has another law of damping or friction than (8), (9) */
  STRUT_TERM_RIGID = 1 << 11,           /* bars keep their lengths */
  STRUT_TERM_ELEMENTS = 1 << 12,        /* elements other than plain members */
  STRUT_TERM_DIRECTION = 1 << 13,       /* friction that differs by direction; with LAWS */
  STRUT_TERM_ACTUATOR_FORCES = 1 << 14, /* actuators that give a force or a moment */
  STRUT_TERM_MASS_DAMPING = 1 << 15,    /* Rayleigh's damping by mass */
  STRUT_TERM_SUPPORT_MOTION = 1 << 16,  /* supports that move */
  STRUT_TERM_UNBALANCE = 1 << 17,       /* rotating masses */
  STRUT_TERM_RUBBING = 1 << 18,         /* friction of feet and of collisions */
  STRUT_TERM_MEMORY = 1 << 20,          /* elements that break, are released, yield or rub */
  STRUT_TERM_FEEDBACK = 1 << 22,        /* sensors, internal states, and signals that follow them */
  STRUT_TERM_SLIDING_MASS = 1 << 25,    /* masses that slide along members */
  STRUT_TERM_SURFACES = 1 << 21 /* contacts with surfaces other than one straight line at rest;
                                   instead of CONTACT */
} strut_term;

/**
 * Terms that few scenes need. Step loops exist twice, and a model is stepped by the copy without these where
 * it can be: the terms that a copy knows are a constant in it, so that it asks for no others.
 */
#define STRUT_TERMS_RARE                                                                           \
  ((unsigned)(STRUT_TERM_FEEDBACK | STRUT_TERM_ACTUATOR_FORCES | STRUT_TERM_UNBALANCE |            \
              STRUT_TERM_MASS_DAMPING | STRUT_TERM_SUPPORT_MOTION | STRUT_TERM_MEMORY |            \
              STRUT_TERM_SURFACES | STRUT_TERM_SLIDING_MASS | STRUT_TERM_RUBBING))
#define STRUT_TERMS_COMMON (~STRUT_TERMS_RARE)
#define STRUT_TERMS_ALL (~0u)

/**
 * Member tables in scene order; (slots) entries each. Padding slots have no length, and pull with no
 * force on the node of padding that every coordinate array ends with. A member whose force is that of
 * an element (elements.h) has its ends and its rest length here, but neither stiffness nor damping;
 * slots after the members hold the natural strains of elements that are no members.
 */
typedef struct strut_member_table {
  int32_t count, slots, blocks;
  const uint32_t *from, *to;   /* where nodes i1, i2 have their x in coordinate arrays: 2 * node */
  const double *stiffness;     /* c [N/m] */
  const double *damping;       /* k [N s/m] */
  const double *rest;          /* lambda_0 [m] */
  const double *slack;         /* least force [N]: 0 for cables, -INFINITY otherwise */
  const double *mass;          /* m [kg] */
  const uint16_t *block_terms; /* (blocks) DAMPING, SLACK, DRIVE: what some member of it needs */
  const strut_pull_rows *rows; /* (blocks) */
} strut_member_table;

/** Sums in which the energy balance of a Runge-Kutta step keeps the powers of contacts. */
enum { STRUT_CONTACT_LANES = 8 };

/** A contact, a node with a surface: a record, because most of them are only asked whether they do. */
typedef struct strut_contact_entry {
  int32_t node;
  int32_t lane;              /* of the energy balance: node modulo STRUT_CONTACT_LANES */
  double stiffness, damping; /* c_g [N/m], k_g [N s/m] */
  double dissipation;        /* chi of the Hunt-Crossley law [s/m]; 0 with the approach-only one */
  strut_friction friction;   /* its numbers are 0 without friction */
} strut_contact_entry;

typedef struct strut_contact_table {
  int32_t count;
  const uint32_t *at;               /* index of its x in coordinate arrays: 2 * node */
  const strut_contact_entry *entry; /* (count) */
  double tangent[2], normal[2];     /* unit vectors along and out of the ground */
  double height;                    /* at x = 0 [m] */
  double belt_speed;                /* [m/s] */
  /* with STRUT_TERM_SURFACES; the vectors above are then those of parallel lines, or of level ground */
  const strut_surface *surface; /* (surfaces); NULL: one straight line at rest */
  const int32_t *surface_of;    /* (count) */
  int32_t surfaces;
  bool moves; /* some surface is shaken */
  bool grips; /* some friction follows a signal; then a state has the entries as they are now */
  bool
      parallel; /* all of them are lines along `tangent`: then a displacement along it changes nothing */
  strut_contact_axes axes; /* tangent and normal once more */
} strut_contact_table;

/** Signals that act on the structure. */
typedef struct strut_drive_table {
  int32_t count;
  const int32_t *member, *signal;
  const uint8_t *first; /* 1: the first of possibly several on its member */
} strut_drive_table;

typedef struct strut_load_table {
  int32_t count;
  const int32_t *node, *slot, *signal; /* slot: of a couple's moment, or -1 */
  const double *x, *y; /* [N], times the signal; x of a couple is its moment [N m] */
} strut_load_table;

typedef struct strut_model {
  const strut_scene *scene;
  unsigned terms;   /* strut_term bits */
  uint32_t strains; /* of its elements: a bit for each strut_strain_kind */
  int32_t node_count, length;
  double size;                  /* largest extent as drawn, or 1 [m]: the scale for "beyond" */
  const double *start;          /* (length) positions at t = 0 */
  const double *velocity;       /* (length) velocities at t = 0 */
  const double *constant_force; /* (length) gravity and constant loads; NULL when all zero */
  const double
      *weight; /* (node_count) mass half of each member at each node, point masses, and shares of
                           sliding masses where they are at t = 0 */
  const uint8_t *fixed;     /* (length) 1 where supported */
  const double *point_mass; /* (node_count) [kg] */
  strut_member_table members;
  strut_element_table elements;
  strut_rubbing_table rubbing;
  strut_contact_table contacts;
  strut_drive_table drives;
  strut_load_table loads;
  struct strut_mass *mass; /* mass.h; NULL where some free coordinate has no mass: statics only */
  strut_feedback_table feedback;
  strut_arena arena;
  strut_actuator_force_table actuator_forces;
  double mass_damping; /* alpha of Rayleigh's damping [1/s] */
  strut_support_motion_table support_motion;
  bool unbalance_corners; /* some rotating mass has an angle whose rate jumps */
  strut_sliding_table sliding;
} strut_model;

/** Does nothing but supports and the ground tell one direction in space from another? */
static inline bool strut_model_may_turn(const strut_model *model) {
  return !(model->strains & 1u << STRUT_STRAIN_ALONG);
}

/**
 * Compiles a valid scene. The model refers to the scene. Fails with STRUT_NO_MEMORY or
 * STRUT_SINGULAR (a mass matrix that cannot be factorised).
 */
STRUT_API strut_status strut_model_compile(const strut_scene *scene, strut_model **model,
                                           strut_error *error);
/** NULL is allowed. */
STRUT_API void strut_model_free(strut_model *model);
/** Of members and contacts: the largest root of stiffness over the mass of the lightest free node [rad/s]. */
STRUT_API double strut_model_fastest_spring(const strut_model *model);

#endif
