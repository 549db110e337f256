/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The parts of a step in subdomains: what each stage does there, and who steps which. */
#ifndef STRUT_ENGINE_INTEGRATE_DOMAIN_PARTS_H
#define STRUT_ENGINE_INTEGRATE_DOMAIN_PARTS_H

#include <stdatomic.h>

#include "engine/base/thread_pool.h"
#include "engine/forces/members_kernel.h"
#include "engine/integrate/integrator.h"
#include "engine/integrate/mass_shares.h"
#include "engine/integrate/subdomain.h"

/*
 * Steps of rk4, verlet and euler for large structures, by one thread or several.
 *
 * Each thread steps a subdomain (subdomain.h) by STRUT_PASSES evaluations of the forces before it meets the
 * others: a step of rk4, or four of another method. Within it, nodes move as soon as their members have been
 * worked on, and members are worked on again as soon as their nodes have moved: four passes read the tables
 * from memory once. Where masses are coupled, every evaluation ends with a solve by all of them
 * (mass_shares.h) instead.
 *
 * Motions have the same bits as the method's own, the energy balance's works too where members are stored as
 * in the scene; both for any number of threads.
 */

typedef struct strut_domain_steps strut_domain_steps;

/** Does it know the method, and all terms of the model's terms? */
bool strut_domain_steps_possible(const strut_model *model, const strut_integrator *method);
/**
 * member: (members) the scene's member that is stored at k, so that members at a node keep their order; NULL:
 * as in the scene. It is read here only. NULL: out of memory.
 */
strut_domain_steps *strut_domain_steps_create(const strut_model *model,
                                              const strut_integrator *method, const int32_t *member,
                                              int threads);
/** NULL is allowed. */
void strut_domain_steps_free(strut_domain_steps *steps);
/** As the method's restart, and whenever someone else has changed positions or velocities. */
void strut_domain_steps_restart(strut_domain_steps *steps, strut_state *state, double dt);
/** Advances a state of the model by `count` steps of dt [s]. */
void strut_domain_steps_advance(strut_domain_steps *steps, strut_state *state, double dt,
                                int64_t count);

/*
 * What domain_steps.c makes and domain_sweep.c works on: the arrays of each subdomain, and what subdomains
 * leave for each other and for the energy balance.
 */

enum {
  DOMAIN_SIDES = 2,          /* one is written while the other is read */
  DOMAIN_EXCHANGED = 6,      /* numbers of a ghost node: position, velocity, acceleration */
  DOMAIN_CONTACT_POWERS = 4, /* contact, friction, belt, exchanged */
  DOMAIN_CONTACT_BLOCK = 64
};

typedef enum domain_method { DOMAIN_RK4, DOMAIN_VERLET, DOMAIN_EULER } domain_method;

/* What a thread works on. Arrays of coordinates are (length). */
typedef struct domain_part {
  strut_subdomain domain;
  double *q, *v, *force; /* of the pass at which each node is: members read and write them */
  double *base;          /* constant forces; NULL: none */
  double *inverse;       /* of the masses */
  double *q0, *v0,
      *a[STRUT_PASSES - 1]; /* of the step; accelerations of the passes before the last */
  double *position, *velocity, *acceleration; /* two or three of these: the state between steps */
  double *load;                               /* (STRUT_PASSES, loads, 2) [N] */
  double *rest, *rest_rate;                   /* (STRUT_PASSES, drives) */
  int32_t begun, done[STRUT_PASSES], block[STRUT_PASSES]; /* progress of nodes and of members */
  int32_t contact[STRUT_PASSES], loaded[STRUT_PASSES], paid[STRUT_PASSES],
      drive[STRUT_PASSES];                /* and of these */
  four_member_powers power[STRUT_PASSES]; /* since the last whole block of the energy balance */
  strut_arena arena;
  bool good;
} domain_part;

/* What subdomains leave for the energy balance in one sweep; (STRUT_PASSES, ...). */
typedef struct domain_balance {
  four_member_powers *member; /* blocks of the energy balance */
  double *contact, *load;     /* (contacts, DOMAIN_CONTACT_POWERS), (loads) */
  atomic_uchar *touched;      /* blocks of contacts: some of them touch */
} domain_balance;

struct strut_domain_steps {
  const strut_model *model;
  domain_method stepping;
  strut_thread_pool *pool;
  strut_subdivision division;
  domain_part **part;
  domain_balance balance[DOMAIN_SIDES];
  int32_t balance_blocks;
  double *exchange[DOMAIN_SIDES]; /* (shared nodes, DOMAIN_EXCHANGED) */
  double *acceleration;           /* (length) of verlet at a restart, in the scene's order */
  double kept[STRUT_POWER_ROOM];  /* powers at the begin of a step of verlet */
  bool started, needs_velocity;
  bool loaded; /* subdomains have the motion of the state */
  int side;    /* where they left what others need of it */
  /* of coupled masses; NULL where there are none */
  strut_mass_shares *mass;
  double *sum, *shared; /* (length) forces and accelerations, in the scene's order */
  strut_arena arena;
  /* of the present call */
  strut_state *state;
  double dt;
  int64_t count;
  unsigned subnormals;
};

/** Is the node of a subdomain its own? */
static inline bool domain_part_owns(const strut_subdomain *d, int32_t node) {
  return node >= d->own_begin && node < d->own_end;
}

/** As many passes as are wanted, one behind the other. */
void strut_domain_sweep(const strut_domain_steps *steps, domain_part *part, int passes, int side);
/** The same with coupled masses, by all threads: one pass after the other. */
void strut_domain_coupled_sweep(const strut_domain_steps *steps, domain_part *part, int thread,
                                int passes, int side);

#endif
