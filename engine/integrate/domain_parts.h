/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What domain_steps.c makes and domain_sweep.c works on: the arrays of each subdomain, and what subdomains leave for
 * each other and for the energy balance.
 */
#ifndef STRUT_ENGINE_INTEGRATE_DOMAIN_PARTS_H
#define STRUT_ENGINE_INTEGRATE_DOMAIN_PARTS_H

#include <stdatomic.h>

#include "engine/base/thread_pool.h"
#include "engine/forces/members_kernel.h"
#include "engine/integrate/domain_steps.h"
#include "engine/integrate/mass_shares.h"
#include "engine/integrate/subdomain.h"

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
