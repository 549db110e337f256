/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/state.h"

#include <math.h>
#include <string.h>

#include "engine/model/compile_parts.h"
#include "engine/model/memory_estimate.h"

/* What contacts need that are not with one straight line at rest. */
static bool make_surfaces(const strut_model *model, strut_state *state) {
  const strut_contact_table *c = &model->contacts;
  size_t contacts = (size_t)c->count, grounds = model->scene->ground_count;
  if (!c->surface) return true;
  state->pose = strut_arena_allocate(&state->arena, contacts, sizeof *state->pose);
  state->near = strut_arena_allocate(&state->arena, contacts, sizeof *state->near);
  if (c->moves)
    state->ground_motion =
        strut_arena_allocate(&state->arena, grounds, sizeof *state->ground_motion);
  return state->pose && state->near && (state->ground_motion || !c->moves);
}

strut_status strut_state_create(const strut_model *model, strut_state **result,
                                strut_error *error) {
  strut_state *state = strut_allocate(1, sizeof *state);
  *result = state;
  if (!state) return strut_memory_fail_model(model->scene, error);
  size_t both = (size_t)model->length, slots = (size_t)model->members.slots;
  size_t contacts = (size_t)model->contacts.count, elements = (size_t)model->elements.count;
  strut_arena *arena = &state->arena;
  state->q = strut_arena_allocate(arena, both, sizeof(double));
  state->v = strut_arena_allocate(arena, both, sizeof(double));
  state->rest = strut_arena_allocate(arena, slots, sizeof(double));
  state->rest_rate = strut_arena_allocate(arena, slots, sizeof(double));
  state->slack_length_threshold = strut_arena_allocate(arena, slots, sizeof(double));
  state->slack_force_threshold = strut_arena_allocate(arena, slots, sizeof(double));
  state->element_acts = strut_arena_allocate(arena, elements, sizeof *state->element_acts);
  state->element_piece = strut_arena_allocate(arena, elements, sizeof *state->element_piece);
  state->element_turn = strut_arena_allocate(arena, elements, sizeof *state->element_turn);
  state->plastic =
      strut_arena_allocate(arena, (size_t)model->elements.history_count, sizeof(double));
  state->broken_at =
      strut_arena_allocate(arena, (size_t)model->elements.breakable_count, sizeof(double));
  state->history_kept =
      strut_arena_allocate(arena,
                           (size_t)(model->elements.history_slots + model->elements.history_count +
                                    model->elements.breakable_count),
                           sizeof(double));
  size_t history_slots = (size_t)model->elements.history_slots;
  state->guide_mode = strut_arena_allocate(arena, history_slots, sizeof *state->guide_mode);
  state->guide_side = strut_arena_allocate(arena, history_slots, sizeof *state->guide_side);
  state->guide_drop = strut_arena_allocate(arena, history_slots, sizeof *state->guide_drop);
  state->force = strut_arena_allocate(arena, both, sizeof(double));
  state->normal = strut_arena_allocate(arena, contacts, sizeof(double));
  state->friction = strut_arena_allocate(arena, contacts, sizeof(double));
  state->scratch = strut_arena_allocate(arena, both, sizeof(double));
  bool surfaces = make_surfaces(model, state);
  size_t sensors = (size_t)model->feedback.count;
  state->sensor = strut_arena_allocate(arena, sensors, sizeof(double));
  state->sensor_rate = strut_arena_allocate(arena, sensors, sizeof(double));
  state->started = strut_arena_allocate(arena, model->scene->signal_count, sizeof(double));
  state->trigger_was = strut_arena_allocate(arena, model->scene->signal_count, 1);
  state->held = strut_arena_allocate(arena, model->scene->signal_count, sizeof(double));
  state->relay_side = strut_arena_allocate(arena, model->scene->signal_count, 1);
  state->actuator_force =
      strut_arena_allocate(arena, (size_t)model->actuator_forces.count, sizeof(double));
  bool moves =
      model->terms & (STRUT_TERM_SUPPORT_MOTION | STRUT_TERM_UNBALANCE | STRUT_TERM_SLIDING_MASS);
  size_t sliding = (size_t)model->sliding.moving_count;
  state->sliding = strut_arena_allocate(arena, sliding, sizeof *state->sliding);
  state->sliding_factor = strut_arena_allocate(arena, 2 * sliding * sliding, sizeof(double));
  state->sliding_push = strut_arena_allocate(arena, 2 * sliding, sizeof(double));
  state->support_rates =
      strut_arena_allocate(arena, (size_t)model->support_motion.count, sizeof(double));
  state->support_answer = strut_arena_allocate(arena, moves ? both : 0, sizeof(double));
  if (!state->q || !state->v || !state->rest || !state->element_acts || !state->element_piece ||
      !state->element_turn || !state->slack_length_threshold || !state->slack_force_threshold ||
      !state->rest_rate || !state->plastic || !state->broken_at || !state->history_kept ||
      !state->guide_mode || !state->guide_drop || !state->guide_side || !state->force ||
      !state->normal || !state->friction || !state->scratch || !state->actuator_force ||
      !state->support_rates || !state->support_answer || !surfaces || !state->sensor ||
      !state->sensor_rate || !state->sliding || !state->sliding_factor || !state->sliding_push ||
      !state->held || !state->started || !state->trigger_was || !state->relay_side) {
    strut_state_free(state);
    *result = NULL;
    return strut_memory_fail_model(model->scene, error);
  }
  strut_state_reset(model, state);
  return STRUT_OK;
}

void strut_state_reset(const strut_model *model, strut_state *state) {
  size_t both = (size_t)model->length * sizeof(double);
  size_t slots = (size_t)model->members.slots * sizeof(double);
  state->step = 0;
  state->evaluations = state->events = 0;
  state->interrupt = NULL;
  state->most_evaluations = 0;
  state->trouble = STRUT_FAILURE_NONE;
  state->drive_time = (double)NAN;
  state->time_offset = 0.0;
  state->refined_until = -HUGE_VAL;
  memcpy(state->q, model->start, both);
  memcpy(state->v, model->velocity, both);
  memcpy(state->rest, model->members.rest, slots);
  memcpy(state->slack_length_threshold, model->members.slack, slots);
  memcpy(state->slack_force_threshold, model->members.slack, slots);
  memset(state->rest_rate, 0, slots);
  for (int32_t i = 0; i < model->elements.count; i++) {
    state->element_acts[i] = 0;
    state->element_piece[i] = -1;
    state->element_turn[i] = strut_element_start(model, i);
  }
  for (size_t i = 0; i < model->scene->signal_count; i++) {
    state->held[i] = (double)NAN;
    state->started[i] = (double)INFINITY;
    state->trigger_was[i] = -1;
    state->relay_side[i] = 0;
  }
  for (int32_t k = 0; k < model->sliding.moving_count; k++)
    state->sliding[k] =
        (strut_sliding_motion){.share = model->sliding.item[model->sliding.moving[k]].start};
  for (int32_t i = 0; i < model->elements.history_count; i++) state->plastic[i] = 0.0;
  for (int32_t i = 0; i < model->elements.history_slots; i++)
    state->guide_mode[i] = 2, state->guide_side[i] = 1,
    state->guide_drop[i] = 0.0; /* STRUT_GUIDE_FREE */
  for (int32_t i = 0; i < model->elements.breakable_count; i++) state->broken_at[i] = HUGE_VAL;
  memset(state->work, 0, sizeof state->work);
  memset(state->power, 0, sizeof state->power);
}

void strut_state_free(strut_state *state) {
  if (!state) return;
  strut_arena_free(&state->arena);
  strut_release(state);
}
