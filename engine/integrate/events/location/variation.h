/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Variations of a motion: how its end depends on its start, carried along with the steps of a method that
 * locates events exactly.
 *
 * Between events the columns follow the derivative of the method's own step, with its length and its modes as
 * they are. An event at which g = 0 comes sooner by dg/g' where a column raises it by dg: the columns then
 * change by the jump of the acceleration times that time (the saltation matrix of Aizerman and Gantmacher
 * 1958). At once with the step it costs no motion of its own.
 */
#pragma once

#include "engine/integrate/events/event_stepping.h"
#include "engine/integrate/integrator.h"

struct strut_event_stepper;
struct strut_event;

typedef struct strut_variation {
  int32_t n, stride;       /* free coordinates; columns, 2 n, rounded up to whole vectors */
  const int32_t *place;    /* (n) of the free coordinates in coordinate arrays */
  double *columns;         /* (2 n, stride) of positions, then of velocities, row by row */
  double **slope;          /* (stages) (2 n, stride) time derivatives at the stages */
  double *middle;          /* (2 n, stride) at a stage */
  double *delay;           /* (stride) how much later the latest event is [s] */
  double *before;          /* (n) acceleration before an event */
  double *gradient;        /* (stride) of an event's value */
  double *stage_q, *drift; /* (length) positions at a stage; scratch */
  struct strut_mode_tangent *tangent;
} strut_variation;

/** Can variations of the model's motions be carried along by the method? */
STRUT_API bool strut_variation_possible(const strut_model *model, const strut_integrator *method);
/** In the state's arena; attach it as state->watched.variation. NULL: out of memory. */
STRUT_API strut_variation *strut_variation_create(const strut_model *model, strut_state *state);
/** The columns become unit vectors: of the free coordinates, then of their velocities. */
STRUT_API void strut_variation_reset(strut_variation *variation);

/** At the start of a run, when its modes are known. */
void strut_variation_begin(const strut_model *model, const strut_state *state,
                           const struct strut_event_stepper *stepper);
/** Along the step from stepper->now at time t over h, whose stages and end the stepper holds. */
void strut_variation_step(const strut_model *model, strut_state *state,
                          const struct strut_event_stepper *stepper, double t, double h);
/** At an event at time t, before modes change. `stepped`: a step has led here, not an event at that time. */
void strut_variation_meet(const strut_model *model, const strut_state *state,
                          struct strut_event_stepper *stepper, const struct strut_event *event,
                          double t, double dt, bool stepped);
/** After modes have changed; `event`: by an event that was met, otherwise at a time of its own. */
void strut_variation_pass(const strut_model *model, const strut_state *state,
                          const struct strut_event_stepper *stepper, bool event);

/*
 * Derivative of the acceleration to positions and velocities with the contacts' modes frozen.
 *
 * It is dense, over the free coordinates. Members and contacts on one straight ground are differentiated
 * by hand; elements and other forces by central differences of the forces with their modes frozen.
 */

typedef struct strut_mode_tangent {
  int32_t n, width;    /* free coordinates; 2 n, rounded up to whole vectors */
  int32_t *coordinate; /* (n) index into coordinate arrays */
  int32_t *row_of;     /* (length) index of a free coordinate, or -1 */
  double *inverse;     /* (n, n) M^-1 */
  double *force; /* (n, width) derivative of the forces: to n positions, then to n velocities */
  double *rate;  /* (n, width) of the accelerations */
  bool plain;    /* members alone give forces beside the ground */
  /* contacts that stick: accelerations and speeds along functional (held, n) are 0; response (held, n)
     removes them, and functional i of response k is 1 for i = k, else 0 */
  int32_t held;
  double *functional, *response;
  double *place, *speed, *pull; /* (length), (length), (width) scratch */
} strut_mode_tangent;

/** Are positions and velocities of the free coordinates the whole state of the model, with forces that a
    tangent of this kind has? */
bool strut_mode_tangent_possible(const strut_model *model);
/** In the state's arena. NULL: out of memory. */
strut_mode_tangent *strut_mode_tangent_create(const strut_model *model, strut_state *state);
/** Finds the contacts that stick, after modes have changed. */
void strut_mode_tangent_hold(const strut_model *model, const strut_event_stepper *stepper,
                             strut_mode_tangent *tangent);
/** Removes from the rows x (n, width) what sticking contacts do not allow. */
void strut_mode_tangent_project(const strut_mode_tangent *tangent, double *vector, int32_t width);
/** Fills `rate` at time t, q and v (length). */
void strut_mode_tangent_evaluate(const strut_model *model, strut_state *state,
                                 const strut_event_stepper *stepper, double t,
                                 const double *positions, const double *velocity,
                                 strut_mode_tangent *tangent);
