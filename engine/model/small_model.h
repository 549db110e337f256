/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Tables of a small model, by which its whole state stays in vector registers while it is stepped.
 *
 * Nodes are lanes. A member finds its ends, and a node the pulls of its members, by tables of lanes. Sums
 * keep the scene's order, so that they have the bits of the general kernel (forces_kernel.h). What may change
 * between runs of one model (rest lengths, constant forces, signals) is read from model and state, not from
 * here.
 */
#ifndef STRUT_ENGINE_MODEL_SMALL_MODEL_H
#define STRUT_ENGINE_MODEL_SMALL_MODEL_H

#include "engine/model/model.h"

enum {
  STRUT_SMALL_NODES = 8,
  STRUT_SMALL_MEMBERS = 12,
  STRUT_SMALL_SLOTS = 16, /* entries of tables of members: whole vectors */
  STRUT_SMALL_DRIVES = 16
};

/** Which registers step small models. */
typedef enum strut_small_level {
  STRUT_SMALL_NONE, /* none: the general kernel does */
  STRUT_SMALL_AVX2,
  STRUT_SMALL_AVX512
} strut_small_level;

/** A number of each node's lane, and a lane of each; 0 where there is none. */
typedef double strut_small_row[STRUT_SMALL_NODES];
typedef int64_t strut_small_lanes[STRUT_SMALL_NODES];

/** The lanes of which something holds: all bits set, or none. */
typedef strut_small_lanes strut_small_mask;

/**
 * Lanes as AVX2 wants them, which permutes registers of 4 by halves of numbers: the halves' places, and at the
 * top bit 63 of lanes 4 to 7, bit 62 of lanes 8 to 11.
 */
static inline int64_t strut_small_halves(int64_t lane) {
  uint64_t place = (uint64_t)(lane % 4), top = lane / 4 == 1 ? UINT64_C(1) << 63 : 0;
  if (lane / 4 == 2) top = UINT64_C(1) << 62;
  return (int64_t)(place * UINT64_C(0x200000002) + UINT64_C(0x100000000) + top);
}

/** Column j of the blocks of the inverse mass matrix: of which lane, times what, and in which rows. */
typedef struct strut_small_column {
  strut_small_lanes lane, batch_halves;
  strut_small_row inverse;
  strut_small_mask has;
  uint8_t bits; /* of has */
} strut_small_column;

/**
 * The k-th member at each node: its slot, the sign bit with which it pulls, and at which nodes there is one.
 * Elsewhere the slot is that of a 0, and the sign makes it -0.
 */
typedef struct strut_small_pull {
  strut_small_lanes slot, slot_halves, sign;
  strut_small_mask has;
} strut_small_pull;

/**
 * The same for AVX2, whose registers of 4 lanes are permuted one at a time: turns, each of one source
 * register. Those of register g lie before end[g]. Members, and columns, ascend at each node, so all of one
 * register come before those of the next, and sums keep their order.
 */
typedef struct strut_small_pull_turn {
  strut_small_lanes halves, sign;
  strut_small_mask has;
} strut_small_pull_turn;
typedef struct strut_small_pull_turns {
  strut_small_pull_turn turn[STRUT_SMALL_MEMBERS];
  int64_t end[3];
} strut_small_pull_turns;
typedef struct strut_small_mass_turn {
  strut_small_lanes halves[2]; /* of x and of y */
  strut_small_mask has[2];
  strut_small_row minus_inverse[2];
} strut_small_mass_turn;
typedef struct strut_small_mass_turns {
  strut_small_mass_turn turn[STRUT_SMALL_NODES];
  int64_t end[2];
} strut_small_mass_turns;

/** Of which registers of 4 lanes the ends of 4 members are. */
typedef enum strut_small_source {
  STRUT_SMALL_FIRST,
  STRUT_SMALL_SECOND,
  STRUT_SMALL_BOTH
} strut_small_source;

/** Contacts at the lanes of their nodes: the numbers of their laws, and which laws they have. */
typedef struct strut_small_contacts {
  strut_small_row minus_stiffness, minus_damping, dissipation;
#define STRUT_FRICTION_ROW(NAME, field, range) strut_small_row field;
  STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  strut_small_row mu_static_backward, mu_kinetic_backward;
  strut_small_mask touches;
#define STRUT_FRICTION_ROW(NAME, name, ...) strut_small_mask name;
  STRUT_FRICTION_LAWS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
} strut_small_contacts;

typedef struct strut_small_model {
  int64_t from[STRUT_SMALL_SLOTS], to[STRUT_SMALL_SLOTS]; /* lanes of the members' ends */
  int64_t from_halves[STRUT_SMALL_SLOTS], to_halves[STRUT_SMALL_SLOTS];
  double stiffness[STRUT_SMALL_SLOTS], damping[STRUT_SMALL_SLOTS];
  strut_small_pull pull[STRUT_SMALL_MEMBERS];      /* (degree) */
  strut_small_column column[2][STRUT_SMALL_NODES]; /* of x and of y, (columns) */
  strut_small_contacts contact;
  int32_t nodes, members, degree, columns;
  strut_small_level level; /* what the processor has; a test may lower it */
  strut_small_pull_turns pull_turns;
  strut_small_mass_turns mass_turns;
  strut_small_source from_source[STRUT_SMALL_SLOTS / 4], to_source[STRUT_SMALL_SLOTS / 4];
} strut_small_model;

/** Terms of models that are stepped so. */
enum {
  STRUT_TERMS_SMALL = STRUT_TERM_MEMBERS | STRUT_TERM_DAMPING | STRUT_TERM_SLACK |
                      STRUT_TERM_DRIVE | STRUT_TERM_CONSTANT | STRUT_TERM_CONTACT |
                      STRUT_TERM_FRICTION | STRUT_TERM_SLOPE | STRUT_TERM_SOLVE | STRUT_TERM_LAWS |
                      STRUT_TERM_DIRECTION
};

/** Makes model->small where the model is small enough and the processor has the registers. False: out of
    memory. */
bool strut_small_model_compile(strut_model *model);

#endif
