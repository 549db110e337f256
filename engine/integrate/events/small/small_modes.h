/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Modes of contacts and cables of a small model as lanes, by which methods with events step it with all its
 * state in vector registers. Made anew after modes have changed.
 */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_SMALL_MODES_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_SMALL_SMALL_MODES_H

#include "engine/forces/small_inputs.h"
#include "engine/integrate/events/event_stepping.h"

/* Instants for which rest lengths are computed at once: of the stages of a step, or of several steps. */
enum { STRUT_SMALL_INSTANTS = 17 };

/** Nodes that answer to a closed contact. */
typedef struct strut_small_response {
  strut_small_row x; /* acceleration under a unit force [1/kg] */
  strut_small_mask has;
} strut_small_response;

typedef struct strut_small_modes {
  struct {
    bool current;      /* they are those of the stepper */
    bool rows_current; /* rest lengths of members that are not driven are in all rows */
    bool in_registers; /* every contact is in a mode that registers hold */
    bool decoupled;    /* and no two closed contacts are of one body, on level ground */
    bool any_held;     /* some contact sticks or creeps */
    bool any_band;     /* or is in Karnopp's band */
    bool any_drops;    /* in which friction drops where forces pass what it holds */
    bool any_by_speed; /* or has friction by the speed alone */
    bool any_by_sign;  /* or a damper that acts by its sign */
  } is;
  strut_small_inputs inputs;
  struct {
    strut_small_mask closed, slips, rubs, band, pushes, held; /* rubs: slips or is pushed */
    strut_small_mask stick, creep, drops; /* drops: static and kinetic friction differ */
    strut_small_mask by_speed;            /* slides with a continuous law */
    strut_small_mask damper_on, damper_off, damper_by_sign;
  } mask;
  struct {
    strut_small_row slip_factor;         /* friction over normal force, where it slips [1] */
    strut_small_row side, edge, kinetic; /* s; of the band [m/s]; mu towards s [1] */
    strut_small_row outward;             /* the sign of gaps that keep the mode; 0: no contact */
    strut_small_row normal, tangent;     /* of a closed contact's own node [1/kg] */
  } row;
  /** Which cables act, and which do not; force per stretch, by which both are compared. */
  struct {
    int64_t taut[STRUT_SMALL_SLOTS], slack[STRUT_SMALL_SLOTS];
    double elastic[STRUT_SMALL_SLOTS];
  } cables;
  strut_small_response stuck[STRUT_SMALL_NODES]; /* (l->stuck_count) */
  int32_t stuck_lane[STRUT_SMALL_NODES];
  strut_small_column
      answer[2]; /* with `decoupled`: the contact to which a node answers, in x and in y */
  small_rest rest[STRUT_SMALL_INSTANTS];
} strut_small_modes;

/** Room for them in the state's arena where the model is small. STRUT_OK or STRUT_NO_MEMORY. */
strut_status strut_small_modes_create(const strut_model *model, strut_state *state,
                                      strut_event_stepper *l);
/** Makes them those of the stepper. */
void strut_small_modes_update(const strut_model *model, const strut_state *state,
                              strut_event_stepper *l);

/** The modes have changed. */
static inline void strut_small_modes_change(strut_event_stepper *l) {
  if (l->small) l->small->is.current = false;
}

/** The modes as lanes; NULL where the model is stepped by the general kernel. */
static inline strut_small_modes *strut_small_modes_of(const strut_model *model,
                                                      const strut_state *state,
                                                      strut_event_stepper *l) {
  strut_small_modes *m = l->small;
  if (!m || !model->small || model->small->level == STRUT_SMALL_NONE) return NULL;
  if (!m->is.current) strut_small_modes_update(model, state, l);
  return m->is.in_registers ? m : NULL;
}

#endif
