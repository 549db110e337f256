/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A batch: several states of models of one topology, stepped in lockstep with vector registers.
 *
 * Each slot has its own model, step size and step number, and after any number of steps the bits that
 * the method's single run would have. Slots that are not filled idle as copies of others.
 */
#ifndef STRUT_ENGINE_INTEGRATE_BATCH_BATCH_H
#define STRUT_ENGINE_INTEGRATE_BATCH_BATCH_H

#include "engine/forces/batch_tables.h"
#include "engine/integrate/integrator.h"

typedef struct strut_batch strut_batch;

/** The most slots that this processor steps at once: 8 from AVX2 on, else 1. */
STRUT_API int32_t strut_batch_widest(void);
/** Can the method step a batch at all? */
STRUT_API bool strut_batch_knows(const strut_integrator *method);
/** Can it step this model in a batch? */
STRUT_API bool strut_batch_possible(const strut_model *model, const strut_integrator *method);
/**
 * Does a batch of this width take less time than its runs one by one, which have kernels of their own? As
 * measured.
 */
STRUT_API bool strut_batch_pays(const strut_model *model, const strut_integrator *method,
                                int32_t width);

/**
 * A batch for models like `first`, which must be possible and outlive it. width: 4 or 8, at most the
 * widest. balance: whether the slots' states keep one. NULL: out of memory.
 */
STRUT_API strut_batch *strut_batch_create(const strut_model *first, const strut_integrator *method,
                                          int32_t width, bool balance);
STRUT_API void strut_batch_free(strut_batch *batch);
/** Steps 8 slots in pairs of registers of 4, as is done where there are no wider ones (AVX2). */
STRUT_API void strut_batch_halve(strut_batch *batch);
/** Puts a model, which must be like the first one (strut_batch_takes_both), into a slot. */
STRUT_API void strut_batch_fill(strut_batch *batch, int32_t slot, const strut_model *model,
                                double dt);
/** Releases the slot; its model may then be freed. */
STRUT_API void strut_batch_empty(strut_batch *batch, int32_t slot);
/** The slot continues from the state: q, v, works, step. */
STRUT_API void strut_batch_put(strut_batch *batch, int32_t slot, const strut_state *state);
/** The state becomes the slot's: all that the method's advance would have left there. */
STRUT_API void strut_batch_get(strut_batch *batch, int32_t slot, strut_state *state);
/** Only the step's number and the count of evaluations. */
STRUT_API void strut_batch_count(const strut_batch *batch, int32_t slot, strut_state *state);
/** These, positions and velocities, and the work of the drives. */
STRUT_API void strut_batch_sample(const strut_batch *batch, int32_t slot, strut_state *state);
/**
 * Advances the slots until one of them has taken the steps that are left to it, left[slot] > 0; none
 * takes more. Allocates nothing. At least one slot must be filled.
 */
STRUT_API void strut_batch_advance(strut_batch *batch, const int64_t *left);

/* Shared by batch.c and the kernels of each width. */

/** Arrays are (length, width) where not said otherwise. */
struct strut_batch {
  strut_batch_tables tables;
  const strut_integrator *method;
  bool balance, driven; /* driven: all slots' drives are those of the present step */
  bool filled[STRUT_BATCH_MOST];
  double *dt, *step; /* (width) */
  double *q, *v, *stage_q, *stage_v[4], *a[4];
  double *work; /* (STRUT_BATCH_POWERS, width) */
  void (*run)(strut_batch *batch, int64_t count);
  strut_arena arena;
};

void strut_batch_rk4_4(strut_batch *batch, int64_t count);
void strut_batch_rk4_8(strut_batch *batch, int64_t count);
void strut_batch_rk4_8_halves(strut_batch *batch, int64_t count);

#endif
