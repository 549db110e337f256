/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/stepping.h"

#include <assert.h>
#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "engine/forces/drive.h"
#include "engine/run/simulate_parts.h"
#include "engine/run/stepping_inputs.h"

/* No run is as long: the end is never reached, and nothing is measured. */
static const double ENDLESS = 0x1p50; /* steps */

struct strut_stepping {
  strut_run run;
  strut_run_options options;
  strut_experiment experiment;
  strut_model *model;
  strut_summary summary;
  strut_error error;
  strut_stepping_inputs inputs;
  strut_recording live;
  unsigned shown;  /* channels that follow */
  int64_t checked; /* step of the latest strut_run_sample; -1: none */
  strut_status status;
  uint64_t identity;
  bool begun;
};

struct strut_stepping_snapshot {
  uint64_t identity;
  strut_run run;
  strut_state state;
  int64_t checked;
  strut_status status;
  double *inputs; /* strut_stepping_inputs_store */
  void *arena;    /* strut_arena_store */
};

static uint64_t next_identity(void) {
  static atomic_uint_fast64_t last;
  return atomic_fetch_add(&last, 1) + 1;
}

/* Without measurements, and without an end. */
static strut_status make_endless(strut_experiment *e, strut_error *error) {
  if (!(e->step > 0.0))
    return strut_fail(error, STRUT_USAGE,
                      "the scene leaves its step to be chosen: a simulation needs the option "
                      "'step', such as 0.1 ms");
  e->accuracy = 0.0;
  e->steady.wanted = false;
  e->quantity_count = 0;
  e->periods = 0.0;
  e->duration = ENDLESS * e->step;
  e->measure_last = e->step;
  return STRUT_OK;
}

strut_status strut_stepping_create(strut_setup *setup, bool force,
                                   const volatile sig_atomic_t *interrupt,
                                   strut_stepping **stepping, strut_error *error) {
  strut_stepping *s = strut_allocate(1, sizeof *s);
  *stepping = NULL;
  if (!s) return strut_no_memory(error, "");
  s->experiment = setup->experiment;
  s->options = (strut_run_options){.force = force, .interrupt = interrupt};
  s->checked = -1;
  s->identity = next_identity();
  strut_status status = make_endless(&s->experiment, error);
  if (status == STRUT_OK) status = strut_stepping_inputs_prepare(setup, error);
  if (status == STRUT_OK) status = strut_model_compile(&setup->scene, &s->model, error);
  if (status == STRUT_OK) {
    status =
        strut_run_begin(s->model, &s->experiment, &s->options, NULL, &s->summary, error, &s->run);
    s->begun = true;
  }
  if (status == STRUT_OK)
    status = strut_recording_create_alone(s->model, &s->run.grid, &s->live, error);
  if (status == STRUT_OK) status = strut_stepping_inputs_create(setup, s->model, &s->inputs, error);
  s->run.error = &s->error; /* `error` is the caller's, and may be gone */
  if (status == STRUT_OK) {
    *stepping = s;
    return STRUT_OK;
  }
  strut_stepping_free(s);
  return status;
}

void strut_stepping_free(strut_stepping *s) {
  if (!s) return;
  s->run.error = &s->error;
  if (s->begun) strut_run_end(&s->run, STRUT_OK);
  strut_summary_free(&s->summary);
  strut_recording_free(&s->live);
  strut_stepping_inputs_free(&s->inputs);
  strut_model_free(s->model);
  strut_release(s);
}

double strut_stepping_time(const strut_stepping *s) { return strut_run_time(&s->run); }
double strut_stepping_step(const strut_stepping *s) { return s->run.dt; }

static void refresh(strut_stepping *s) {
  if (s->shown) strut_recording_observe(s->run.state, &s->live, s->shown);
}

/* ---- steps ---- */

/* Checks the state as a run does between its steps. */
static strut_status check(strut_stepping *s) {
  int64_t stop;
  s->checked = s->run.check = s->run.state->step;
  return strut_run_sample(&s->run, &stop);
}

static strut_status step_to(strut_stepping *s, int64_t last) {
  strut_run *r = &s->run;
  strut_status status = STRUT_OK;
  while (status == STRUT_OK && r->state->step < last) {
    if (s->checked < 0 || r->state->step - s->checked >= r->chunk) status = check(s);
    int64_t stop = s->checked + r->chunk;
    if (status == STRUT_OK) strut_run_step(r, stop < last ? stop : last);
    if (status == STRUT_OK && r->state->trouble) status = check(s);
  }
  return status;
}

strut_status strut_stepping_advance(strut_stepping *s, int64_t steps, strut_error *error) {
  if (s->status != STRUT_OK) {
    if (error) *error = s->error;
    return s->status;
  }
  if (steps < 0) return strut_fail(error, STRUT_USAGE, "a simulation cannot go back");
  const volatile sig_atomic_t *interrupt = s->options.interrupt;
  if (interrupt && *interrupt)
    return strut_fail(error, STRUT_INTERRUPTED, "interrupted at t = %.9g s",
                      strut_run_time(&s->run));
  if (strut_stepping_inputs_changed(&s->inputs)) {
    strut_status valid = strut_stepping_inputs_apply(&s->inputs, s->model, &s->run, error);
    if (valid != STRUT_OK) return valid;
  }
  int64_t done = s->run.state->step, most = INT64_MAX - done;
  strut_status status = step_to(s, done + (steps < most ? steps : most));
  refresh(s);
  if (status == STRUT_OK) return STRUT_OK;
  if (error) *error = s->error;
  if (status != STRUT_INTERRUPTED) s->status = status;
  if (status == STRUT_INTERRUPTED) s->run.state->trouble = STRUT_FAILURE_NONE;
  return status;
}

/* ---- what it shows ---- */

const strut_record_channel *strut_stepping_channel(strut_stepping *s, strut_channel id,
                                                   const double **data) {
  for (size_t k = 0; k < s->live.layout.channel_count; k++) {
    const strut_record_channel *c = &s->live.channel[k];
    if (c->id != id) continue;
    s->shown |= (unsigned)id;
    refresh(s);
    *data = s->live.rows + c->offset;
    return c;
  }
  return NULL;
}

double *strut_stepping_input(strut_stepping *s, strut_input input, size_t *count) {
  return strut_stepping_inputs_show(&s->inputs, s->model, &s->run, input, count);
}

double strut_stepping_input_work(const strut_stepping *s) { return s->inputs.work; }

/* ---- snapshots ---- */

strut_stepping_snapshot *strut_stepping_store(const strut_stepping *s) {
  strut_stepping_snapshot *snapshot = strut_allocate(1, sizeof *snapshot);
  if (!snapshot) return NULL;
  const strut_state *state = s->run.state;
  *snapshot = (strut_stepping_snapshot){.identity = s->identity,
                                        .run = s->run,
                                        .state = *state,
                                        .checked = s->checked,
                                        .status = s->status};
  snapshot->arena = strut_allocate(strut_arena_stored_size(&state->arena), 1);
  snapshot->inputs = strut_stepping_inputs_store(&s->inputs);
  if (!snapshot->arena || !snapshot->inputs) {
    strut_stepping_snapshot_free(snapshot);
    return NULL;
  }
  strut_arena_store(&state->arena, snapshot->arena);
  return snapshot;
}

bool strut_stepping_restore(strut_stepping *s, const strut_stepping_snapshot *snapshot) {
  if (snapshot->identity != s->identity) return false;
  strut_state *state = s->run.state;
  strut_arena arena = state->arena; /* may have grown since */
  strut_stepping_inputs_restore(&s->inputs, s->model, snapshot->inputs);
  s->run = snapshot->run;
  s->checked = snapshot->checked;
  s->status = snapshot->status;
  *state = snapshot->state;
  state->arena = arena;
  strut_arena_restore(&state->arena, snapshot->arena);
  refresh(s);
  return true;
}

void strut_stepping_snapshot_free(strut_stepping_snapshot *snapshot) {
  if (!snapshot) return;
  strut_release(snapshot->arena);
  strut_release(snapshot->inputs);
  strut_release(snapshot);
}
