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
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "engine/model/algebra/pull_rows.h"
#include "engine/model/elements.h"
#include "engine/model/surfaces.h"
#include "engine/scene/scene.h"

/*
 * Compiled feedback: where sensors find their values, and internal states. A model without them has none
 * of it.
 *
 * Internal states are integrated beside the motion as auxiliary coordinates of unit mass, which stand
 * behind those of the nodes and that of padding in coordinate arrays: the state is the velocity there,
 * its rate the force. Every method so integrates them at its own order. They count as fixed, so that
 * nobody else takes them for positions.
 */

/** Does a column need the driven rest lengths, or where shaken grounds are? */
static inline bool strut_column_needs_drives(strut_column column) {
  return strut_observable_at(column.kind)->need != STRUT_OBSERVED_MOTION;
}

/** The Maxwell branch of a member, whose force is an internal state. */
typedef struct strut_maxwell_entry {
  int32_t member, state;
  double stiffness, damping;
} strut_maxwell_entry;

typedef struct strut_feedback_table {
  int32_t count;
  const strut_column *sensor; /* (count) as strut_column_find finds them */
  bool needs_drives;          /* some sensor's value follows from the driven rest lengths */
  int32_t base, state_count;  /* states stand at base .. base + state_count - 1 of velocities */
  int32_t lag_count;
  const int32_t
      *lagged; /* (lag_count) signals with a lag; their states follow those of the scene */
  const int32_t *lag_of; /* (signals) state of a signal's lag, or -1 */
  int32_t maxwell_count;
  const strut_maxwell_entry *maxwell; /* (maxwell_count); their states follow */
  int32_t bristle_count;              /* bends of bristles, the last states */
  int32_t sampled_count;
  int32_t trigger_count;
  const int32_t *triggered; /* (trigger_count) signals with a trigger */
  const int32_t *sampled;   /* (sampled_count) signals that are sampled, terms before their sums */
  int32_t relay_count;
  const int32_t *relay; /* (relay_count) relays that are not sampled: they switch at any time */
} strut_feedback_table;

/** Does the motion depend on more of the past than positions and velocities hold? */
static inline bool strut_feedback_remembers(const strut_feedback_table *feedback) {
  return feedback->state_count || feedback->sampled_count || feedback->trigger_count ||
         feedback->relay_count;
}

struct strut_model;
/**
 * The column of a scene with the item that its function knows: an element, which is looked for from `near` on, or
 * contacts from `item` up to `other`.
 */
STRUT_API strut_column strut_column_find(const struct strut_model *model, strut_column column,
                                         int32_t near);

/*
 * Supported coordinates that a signal moves: position + signal(t).
 *
 * They stay out of the mass matrix that is factored. With the consistent mass their acceleration a_c
 * pushes free neighbours by -M_fc a_c; the entries of M_fc are the couplings.
 */

typedef struct strut_moved_coordinate {
  int32_t at;     /* index in coordinate arrays */
  int32_t signal; /* of the scene */
  double base;    /* position where the signal is 0 [m] */
} strut_moved_coordinate;

/** An entry of the mass matrix between a moved coordinate and a free one. */
typedef struct strut_support_coupling {
  int32_t item; /* moved coordinate */
  int32_t at;   /* index of the free one in coordinate arrays */
  double mass;  /* [kg] */
} strut_support_coupling;

typedef struct strut_support_motion_table {
  int32_t count, coupling_count;
  const strut_moved_coordinate *item;     /* (count) in the scene's order */
  const strut_support_coupling *coupling; /* (coupling_count) */
  bool corners; /* some coupled coordinate has a signal whose rate jumps */
} strut_support_motion_table;

/*
 * Point masses on the straight line between the two nodes of a member.
 *
 * A mass m at the share s of the line is at x = N q with N = (1 - s, s) at the member's two nodes, alike in
 * x and y. One at rest on its member adds m N'N to the mass matrix, which is factored with it. One that moves
 * stays out of that matrix M: its nodes answer through columns of M^-1 kept here, see
 * engine/forces/drives/moving_masses.h.
 */

/** How nodes answer to unit forces on the two nodes of a member, cut where it is negligible. */
typedef struct strut_sliding_answer {
  int32_t count;
  const uint32_t *at; /* (count) 2 * node */
  const double *xy;   /* (count, 4) x, y by the first node, x, y by the second [1/kg] */
} strut_sliding_answer;

typedef struct strut_sliding_item {
  int32_t member; /* of the scene */
  uint32_t at[2]; /* 2 * node of the member's two nodes */
  double mass;    /* [kg] */
  double start;   /* share at t = 0 */
  double base;    /* share where the signal is 0 */
  double scale;   /* share per unit of the signal */
  int32_t signal; /* of the scene; -1: at rest */
} strut_sliding_item;

/** A moving mass at one instant. */
typedef struct strut_sliding_motion {
  double share, rate, bend; /* of its member's line [1], and its derivatives [1/s], [1/s^2] */
  double jump;              /* of the rate, while an impulse is found */
} strut_sliding_motion;

typedef struct strut_sliding_table {
  int32_t count, moving_count;
  const strut_sliding_item *item;     /* (count) in the scene's order */
  const int32_t *moving;              /* (moving_count) those that move */
  const strut_sliding_answer *answer; /* (moving_count) */
  /* (2, 2 moving_count, 2 moving_count) of x, then y: entries of M^-1 between the members' nodes [1/kg] */
  const double *between;
  bool corners;       /* some signal's rate jumps */
  bool massless_node; /* some free node has no mass but that of sliding masses */
} strut_sliding_table;

/** Mass moment beyond that of the weights at time t [s], sum of m x, of one coordinate at positions q [kg m]. */
STRUT_API double strut_sliding_moment(const struct strut_model *model, double t, int axis,
                                      const double *positions);

/*
 * Elements that rub: feet, circular arcs at ends of members, which roll on the ground instead of the node there,
 * nodes that the ground holds by bristles (LuGre), and collisions with friction.
 *
 * How they press is an element of a one-sided linear law, so that every method and statics know it; the contact
 * of the node with each ground says with which stiffness, damping and friction. Friction is a term of its own
 * (engine/forces/surfaces.h).
 */

/** A foot or a node on one ground, or one element of a collision. */
typedef struct strut_rubbing_entry {
  int32_t element, contact; /* contact: of a foot or a node; else -1 */
  int32_t
      bend; /* where in velocities the bend of bristles stands, see strut_feedback_table; -1: none */
  double belt_speed; /* [m/s] */
  strut_friction friction;
} strut_rubbing_entry;

typedef struct strut_rubbing_table {
  int32_t count, bristles;         /* bristles: entries that have them */
  const strut_rubbing_entry *item; /* (count) */
  const int32_t *of_element;       /* (elements) its entry, or -1 */
  const int32_t *of_contact;       /* (contacts) likewise */
} strut_rubbing_table;

/** The foot at contact i of the scene, or -1. */
STRUT_API int32_t strut_foot_of_contact(const strut_scene *scene, size_t i);
/** Does a foot or bristles make the contact an element? */
STRUT_API bool strut_contact_is_element(const strut_scene *scene, size_t i);
/** Contacts with bristles, whose bends are internal states. */
STRUT_API size_t strut_bristle_count(const strut_scene *scene);
/** Does some collision of the scene have friction? */
STRUT_API bool strut_collisions_rub(const strut_scene *scene);

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
/** The tables that the only owner of a model may change between steps: a run stepped from outside, a path. */
typedef struct strut_model_inputs {
  double *rest, *stiffness;             /* of members, as in their table */
  strut_element *element;               /* whose law's numbers may change, and with them: */
  double *element_stiffness;            /* (elements) */
  int32_t *drive_signal;                /* (drives) */
  strut_actuator_force *actuator_force; /* (actuator forces) */
} strut_model_inputs;
STRUT_API strut_model_inputs strut_model_inputs_of(strut_model *model);
/** Of members and contacts: the largest root of stiffness over the mass of the lightest free node [rad/s]. */
STRUT_API double strut_model_fastest_spring(const strut_model *model);

/* The parts of a structure, nodes that members and elements connect, and what acts on each as a whole. */

typedef struct strut_connected_part {
  double force[2]; /* sum of those on free coordinates [N] */
  bool held[2];    /* some node of it, along x, along y */
  bool touches;    /* some node of it is one that contacts have */
} strut_connected_part;

/**
 * part_of (node_count) becomes the number of a node's part, the first that was found of its nodes; part
 * (node_count), zeros before, is filled there. force: (length) [N].
 */
STRUT_API void strut_connected_parts_find(const strut_model *model, const double *force,
                                          int32_t *part_of, strut_connected_part *part);
