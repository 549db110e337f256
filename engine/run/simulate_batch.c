/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/simulate.h"

#include <assert.h>

#include "engine/base/subnormals.h"
#include "engine/integrate/batch/batch.h"
#include "engine/run/simulate_parts.h"

/* A slot with its run. */
typedef struct batch_run {
  bool taken;
  strut_batch_point point;
  strut_run run;
  strut_summary summary;
  strut_error error;
  int64_t stop; /* step at which to sample it next */
} batch_run;

typedef struct batch_state {
  const strut_batch_source *source;
  strut_batch *batch; /* NULL: every run is made alone */
  bool more;          /* the source may have another point */
  int32_t width, taken;
  strut_step_limits limits;
  batch_run slots[STRUT_BATCH_MOST];
} batch_state;

static void end_run(batch_state *h, batch_run *s, strut_status status) {
  strut_batch_point point = s->point;
  status = strut_run_end(&s->run, status);
  h->source->result(h->source->context, &point, status, &s->summary, &s->error);
  h->more = true;
}

/* Runs a slot to its end outside the batch. */
static void run_to_end(batch_state *h, batch_run *s) {
  strut_status status = STRUT_OK;
  while (!status) {
    if (s->stop == s->run.state->step) break;
    strut_run_step(&s->run, s->stop);
    status = strut_run_sample(&s->run, &s->stop);
  }
  end_run(h, s, status);
}

static bool fits_slot(const batch_state *h, const batch_run *s) {
  const strut_run *r = &s->run;
  if (r->measure.quantities) return false; /* a batch provides positions and velocities only */
  if (strut_run_is_short_step_due(r) || r->grid.offset != 0.0) return false;
  return h->batch && r->state->balance != h->source->without_balance &&
         h->batch->method == r->method && strut_batch_possible(r->model, r->method) &&
         strut_batch_takes_both(h->source->example, r->model);
}

/* Fills a slot with the next point that fits; runs all others at once. */
static void fill_slot(batch_state *h, int32_t slot) {
  batch_run *s = &h->slots[slot];
  while (h->more && !s->taken) {
    h->more = h->source->next(h->source->context, &s->point);
    if (!h->more) return;
    s->error = (strut_error){0};
    strut_status status = strut_run_begin(s->point.model, s->point.experiment, s->point.options,
                                          &h->limits, &s->summary, &s->error, &s->run);
    if (!status) status = strut_run_sample(&s->run, &s->stop);
    if (status || s->stop == s->run.state->step) {
      end_run(h, s, status);
    } else if (!fits_slot(h, s)) {
      run_to_end(h, s);
    } else {
      s->taken = true;
      h->taken++;
      strut_batch_fill(h->batch, slot, s->run.model, s->run.dt);
      strut_batch_put(h->batch, slot, s->run.state);
    }
  }
}

static void release_slot(batch_state *h, int32_t slot) {
  assert(h->slots[slot].taken && h->taken > 0);
  strut_batch_empty(h->batch, slot);
  h->slots[slot].taken = false;
  h->taken--;
}

static bool is_measured(const batch_run *s, int64_t step) {
  return step >= strut_measure_first_step(&s->run.measure);
}

/* Steps to the nearest stop of a slot; by single steps while a slot is measured. */
static void step_batch(batch_state *h) {
  int64_t left[STRUT_BATCH_MOST] = {0}, before[STRUT_BATCH_MOST] = {0};
  for (int32_t l = 0; l < h->width; l++) {
    const batch_run *s = &h->slots[l];
    if (!s->taken) continue;
    before[l] = s->run.state->step;
    assert(s->stop > before[l]);
    left[l] = is_measured(s, before[l]) ? 1 : s->stop - before[l];
  }
  unsigned subnormals = strut_subnormals_off();
  strut_batch_advance(h->batch, left);
  for (int32_t l = 0; l < h->width; l++) {
    batch_run *s = &h->slots[l];
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

static void run_slot_to_end(batch_state *h, int32_t slot) {
  strut_batch_get(h->batch, slot, h->slots[slot].run.state);
  release_slot(h, slot);
  run_to_end(h, &h->slots[slot]);
}

/* Samples the slots that reached their stop, and releases those whose run ended. */
static void sample_batch(batch_state *h) {
  for (int32_t l = 0; l < h->width; l++) {
    batch_run *s = &h->slots[l];
    if (!s->taken || s->run.state->step < s->stop) continue;
    strut_status status = strut_run_sample(&s->run, &s->stop);
    if (status || s->stop == s->run.state->step) {
      release_slot(h, l);
      end_run(h, s, status);
    } else if (strut_run_is_short_step_due(&s->run)) {
      run_slot_to_end(h, l);
    }
  }
}

/* A batch costs the same with any number of slots in use: the last runs are faster alone. */
static bool too_few(const batch_state *h) { return !h->more && 4 * h->taken <= h->width; }

static void finish_remaining(batch_state *h) {
  for (int32_t l = 0; l < h->width; l++) {
    batch_run *s = &h->slots[l];
    if (!s->taken) continue;
    run_slot_to_end(h, l);
  }
}

/* NULL, and a width of one, where no batch can be used. */
static strut_batch *create_batch(const strut_batch_source *source, int32_t wanted, int32_t *width) {
  const strut_model *m = source->example;
  const strut_integrator *method = m ? strut_integrator_find(source->integrator) : NULL;
  if (wanted < 4 || !method || !strut_batch_possible(m, method)) return NULL;
  strut_batch *batch = strut_batch_create(m, method, wanted, !source->without_balance);
  if (batch) *width = wanted;
  if (batch && source->halves) strut_batch_halve(batch);
  return batch;
}

void strut_simulate_batch(const strut_batch_source *source) {
  int32_t widest = strut_batch_widest(), width = source->width;
  batch_state h = {.source = source, .more = true, .width = 1};
  h.batch = create_batch(source, width < 1 || width > widest ? widest : width, &h.width);
  do {
    for (int32_t l = 0; l < h.width; l++) fill_slot(&h, l);
    if (!h.taken) break;
    if (too_few(&h)) {
      finish_remaining(&h);
    } else {
      step_batch(&h);
      sample_batch(&h);
    }
  } while (h.taken || h.more);
  strut_batch_free(h.batch);
}
