/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/simulate_batch.h"

#include "engine/base/subnormals.h"
#include "engine/integrate/lanes/batch.h"
#include "engine/run/simulate_parts.h"

/* A lane and who runs in it. */
typedef struct seat {
  bool taken;
  strut_batch_point point;
  strut_run run;
  strut_summary summary;
  strut_error error;
  int64_t stop; /* step at which to look at it next */
} seat;

typedef struct hall {
  const strut_batch_source *source;
  strut_batch *batch; /* NULL: all runs are run alone */
  bool more;          /* the next point is worth asking for */
  int32_t width, taken;
  strut_step_limits limits;
  seat seats[STRUT_MOST_LANES];
} hall;

static void end(hall *h, seat *s, strut_status status) {
  strut_batch_point point = s->point;
  status = strut_run_end(&s->run, status);
  h->source->result(h->source->context, &point, status, &s->summary, &s->error);
  h->more = true;
}

/* To the end, in the caller's own time. */
static void finish_alone(hall *h, seat *s) {
  strut_status status = STRUT_OK;
  while (!status) {
    if (s->stop == s->run.state->step) break;
    strut_run_step(&s->run, s->stop);
    status = strut_run_sample(&s->run, &s->stop);
  }
  end(h, s, status);
}

static bool fits(const hall *h, const seat *s) {
  const strut_run *r = &s->run;
  if (r->measure.quantities) return false; /* lanes show positions and velocities only */
  if (strut_run_last_step_due(r) || r->grid.offset != 0.0) return false;
  return h->batch && r->state->ledger != h->source->without_ledger &&
         h->batch->method == r->method && strut_batch_possible(r->model, r->method) &&
         strut_lanes_alike(h->source->example, r->model);
}

/* The next point that is to run in this lane; those that no lane can take are run at once. */
static void seat_next(hall *h, int32_t lane) {
  seat *s = &h->seats[lane];
  while (h->more && !s->taken) {
    h->more = h->source->next(h->source->context, &s->point);
    if (!h->more) return;
    s->error = (strut_error){0};
    strut_status status = strut_run_begin(s->point.model, s->point.experiment, s->point.options,
                                          &h->limits, &s->summary, &s->error, &s->run);
    if (!status) status = strut_run_sample(&s->run, &s->stop);
    if (status || s->stop == s->run.state->step) {
      end(h, s, status);
    } else if (!fits(h, s)) {
      finish_alone(h, s);
    } else {
      s->taken = true;
      h->taken++;
      strut_batch_fill(h->batch, lane, s->run.model, s->run.dt);
      strut_batch_put(h->batch, lane, s->run.state, s->run.workspace);
    }
  }
}

static void leave(hall *h, int32_t lane) {
  strut_batch_empty(h->batch, lane);
  h->seats[lane].taken = false;
  h->taken--;
}

static bool is_measured(const seat *s, int64_t step) {
  return step >= strut_measure_first_step(&s->run.measure);
}

/* Steps to the next stop of some lane; by single steps where one is measured after each. */
static void step(hall *h) {
  int64_t left[STRUT_MOST_LANES] = {0}, before[STRUT_MOST_LANES] = {0};
  for (int32_t l = 0; l < h->width; l++) {
    const seat *s = &h->seats[l];
    if (!s->taken) continue;
    before[l] = s->run.state->step;
    left[l] = is_measured(s, before[l]) ? 1 : s->stop - before[l];
  }
  unsigned subnormals = strut_subnormals_off();
  strut_batch_advance(h->batch, left);
  for (int32_t l = 0; l < h->width; l++) {
    seat *s = &h->seats[l];
    if (!s->taken) continue;
    bool measured = is_measured(s, before[l]);
    strut_batch_count(h->batch, l, s->run.state);
    if (s->run.state->step == before[l]) continue;
    if (s->run.state->step == s->stop)
      strut_batch_get(h->batch, l, s->run.state);
    else if (measured)
      strut_batch_sample(h->batch, l, s->run.state);
    if (measured) strut_measure_step(s->run.model, s->run.state, &s->run.measure);
  }
  strut_subnormals_restore(subnormals);
}

static void leave_alone(hall *h, int32_t lane) {
  strut_batch_get(h->batch, lane, h->seats[lane].run.state);
  leave(h, lane);
  finish_alone(h, &h->seats[lane]);
}

/* Looks at the lanes that have come to their stop; those that have ended leave. */
static void look(hall *h) {
  for (int32_t l = 0; l < h->width; l++) {
    seat *s = &h->seats[l];
    if (!s->taken || s->run.state->step < s->stop) continue;
    int64_t shot = s->run.shot_periods;
    strut_status status = strut_run_sample(&s->run, &s->stop);
    if (status || s->stop == s->run.state->step) {
      leave(h, l);
      end(h, s, status);
    } else if (strut_run_last_step_due(&s->run)) {
      leave_alone(h, l);
    } else if (s->run.shot_periods != shot) {
      strut_batch_put(h->batch, l, s->run.state, s->run.workspace); /* it goes on from the orbit */
    }
  }
}

/* Lanes cost the same however few are taken: the last runs are faster alone. */
static bool too_few(const hall *h) { return !h->more && 4 * h->taken <= h->width; }

static void finish_last(hall *h) {
  for (int32_t l = 0; l < h->width; l++) {
    seat *s = &h->seats[l];
    if (!s->taken) continue;
    leave_alone(h, l);
  }
}

/* NULL, and one seat, where there are no lanes to be had. */
static strut_batch *batch_for(const strut_batch_source *source, int32_t wanted, int32_t *width) {
  const strut_model *m = source->example;
  const strut_integrator *method = m ? strut_integrator_find(source->integrator) : NULL;
  if (wanted < 2 || !method || !strut_batch_possible(m, method)) return NULL;
  strut_batch *batch = strut_batch_create(m, method, wanted, !source->without_ledger);
  if (batch) *width = wanted;
  if (batch && source->halves) strut_batch_halve(batch);
  return batch;
}

void strut_simulate_batch(const strut_batch_source *source) {
  int32_t widest = strut_batch_widest(), width = source->width;
  hall h = {.source = source, .more = true, .width = 1};
  h.batch = batch_for(source, width < 1 || width > widest ? widest : width, &h.width);
  do {
    for (int32_t l = 0; l < h.width; l++) seat_next(&h, l);
    if (!h.taken) break;
    if (too_few(&h)) {
      finish_last(&h);
    } else {
      step(&h);
      look(&h);
    }
  } while (h.taken || h.more);
  strut_batch_free(h.batch);
}
