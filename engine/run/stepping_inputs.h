/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Inputs of a stepping: what the caller has written, and what of it the model has. */
#ifndef STRUT_ENGINE_RUN_STEPPING_INPUTS_H
#define STRUT_ENGINE_RUN_STEPPING_INPUTS_H

#include "engine/run/simulate_parts.h"
#include "engine/run/stepping.h"

typedef struct strut_stepping_inputs {
  strut_scene *scene; /* whose loads and signals are changed */
  double *given;      /* (count) rest, actuators, loads: what the caller writes */
  double *applied;    /* (count) what the model has */
  size_t count, members, actuators, nodes;
  bool loads;            /* loads were asked for */
  int32_t first_signal;  /* of the signals that hold actuators, one for each */
  size_t first_load;     /* of the loads, one for each node */
  double *constant;      /* (length) the model's constant force, of which: */
  double *constant_base; /* (length) the scene's */
  double work;           /* that changes have done [J] */
  strut_arena arena;
} strut_stepping_inputs;

/** Adds the signals that hold actuators to the scene, before it is compiled. */
strut_status strut_stepping_inputs_prepare(strut_setup *setup, strut_error *error);
strut_status strut_stepping_inputs_create(strut_setup *setup, const strut_model *model,
                                          strut_stepping_inputs *inputs, strut_error *error);
void strut_stepping_inputs_free(strut_stepping_inputs *inputs);
/** The array of an input; loads become terms of the model only now. NULL: no memory. */
double *strut_stepping_inputs_show(strut_stepping_inputs *inputs, strut_model *model,
                                   strut_run *run, strut_input input, size_t *count);
bool strut_stepping_inputs_changed(const strut_stepping_inputs *inputs);
/** Takes what is given into the model, as an event of the run. STRUT_USAGE: nothing is changed. */
strut_status strut_stepping_inputs_apply(strut_stepping_inputs *inputs, strut_model *model,
                                         strut_run *run, strut_error *error);
/** What was given and applied, and the work; NULL: no memory. Restoring leaves the state alone. */
double *strut_stepping_inputs_store(const strut_stepping_inputs *inputs);
void strut_stepping_inputs_restore(strut_stepping_inputs *inputs, strut_model *model,
                                   const double *stored);

#endif
