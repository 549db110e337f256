/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/state.h"

#include <string.h>

#include "engine/model/compile_parts.h"

/* What contacts need that are not with one straight line at rest. */
static bool make_surfaces(const strut_model *model, strut_state *state) {
  const strut_contact_table *c = &model->contacts;
  size_t contacts = (size_t)c->count, grounds = model->scene->ground_count;
  if (!c->surface) return true;
  state->latest->pose = strut_arena_allocate(&state->arena, contacts, sizeof *state->latest->pose);
  state->buffers->near =
      strut_arena_allocate(&state->arena, contacts, sizeof *state->buffers->near);
  if (c->moves)
    state->latest->ground_motion =
        strut_arena_allocate(&state->arena, grounds, sizeof *state->latest->ground_motion);
  if (c->grips)
    state->latest->grip = strut_arena_copy(&state->arena, c->entry, contacts, sizeof *c->entry);
  return state->latest->pose && state->buffers->near &&
         (state->latest->ground_motion || !c->moves) && (state->latest->grip || !c->grips);
}

/* The arrays of a state and how long they are. */
#define STRUT_STATE_ARRAYS(ARRAY)                                                                  \
  ARRAY(latest, 1)                                                                                 \
  ARRAY(buffers, 1)                                                                                \
  ARRAY(nearby, 1)                                                                                 \
  ARRAY(q, model->length)                                                                          \
  ARRAY(v, model->length)                                                                          \
  ARRAY(modes.slack_length_threshold, model->members.slots)                                        \
  ARRAY(modes.slack_force_threshold, model->members.slots)                                         \
  ARRAY(modes.element_acts, model->elements.count)                                                 \
  ARRAY(modes.element_piece, model->elements.count)                                                \
  ARRAY(history.turn, model->elements.count)                                                       \
  ARRAY(history.plastic, model->elements.history_count)                                            \
  ARRAY(history.broken_at, model->elements.breakable_count)                                        \
  ARRAY(history.material, model->elements.history_slots)                                           \
  ARRAY(history.guide_mode, model->elements.history_slots)                                         \
  ARRAY(history.guide_side, model->elements.history_slots)                                         \
  ARRAY(history.guide_drop, model->elements.history_slots)                                         \
  ARRAY(history.kept, 2 * model->elements.history_slots + model->elements.history_count +          \
                          model->elements.breakable_count)                                         \
  ARRAY(signals.started, model->scene->signal_count)                                               \
  ARRAY(signals.trigger_was, model->scene->signal_count)                                           \
  ARRAY(signals.held, model->scene->signal_count)                                                  \
  ARRAY(signals.relay_side, model->scene->signal_count)                                            \
  ARRAY(latest->rest, model->members.slots)                                                        \
  ARRAY(latest->rest_rate, model->members.slots)                                                   \
  ARRAY(latest->actuator_force, model->actuator_forces.count)                                      \
  ARRAY(latest->sensor, model->feedback.count)                                                     \
  ARRAY(latest->sensor_rate, model->feedback.count)                                                \
  ARRAY(latest->force, model->length)                                                              \
  ARRAY(latest->normal, model->contacts.count)                                                     \
  ARRAY(latest->friction, model->contacts.count)                                                   \
  ARRAY(latest->sliding, model->sliding.moving_count)                                              \
  ARRAY(nearby->element, model->elements.scattered ? model->elements.count : 0)                    \
  ARRAY(nearby->q, model->elements.scattered ? model->length : 0)                                  \
  ARRAY(buffers->mass_solve, model->length)                                                        \
  ARRAY(buffers->support_rates, model->support_motion.count)                                       \
  ARRAY(buffers->support_answer, answers_supports(model) ? model->length : 0)                      \
  ARRAY(buffers->sliding_factor,                                                                   \
        2 * (size_t)model->sliding.moving_count * (size_t)model->sliding.moving_count)             \
  ARRAY(buffers->sliding_push, 2 * model->sliding.moving_count)

static bool answers_supports(const strut_model *model) {
  return model->terms &
         (STRUT_TERM_SUPPORT_MOTION | STRUT_TERM_UNBALANCE | STRUT_TERM_SLIDING_MASS);
}

static bool make_arrays(const strut_model *model, strut_state *state) {
  bool good = true;
#define STRUT_STATE_ARRAY(field, count)                                                            \
  good = good && (state->field =                                                                   \
                      strut_arena_allocate(&state->arena, (size_t)(count), sizeof *state->field));
  STRUT_STATE_ARRAYS(STRUT_STATE_ARRAY)
  return good && make_surfaces(model, state);
}

strut_status strut_state_create(const strut_model *model, strut_state **result,
                                strut_error *error) {
  strut_state *state = strut_allocate(1, sizeof *state);
  *result = state;
  if (!state) return strut_no_memory(error, "for the model");
  if (!make_arrays(model, state)) {
    strut_state_free(state);
    *result = NULL;
    return strut_no_memory(error, "for the model");
  }
  strut_state_reset(model, state);
  return STRUT_OK;
}

void strut_state_reset(const strut_model *model, strut_state *state) {
  size_t both = (size_t)model->length * sizeof(double);
  size_t slots = (size_t)model->members.slots * sizeof(double);
  state->step = 0;
  state->latest->evaluations = state->events = 0;
  state->forced = (strut_forced_steps){0};
  state->limits.interrupt = NULL;
  state->limits.most_evaluations = 0;
  state->trouble = STRUT_FAILURE_NONE;
  state->latest->drive_time = (double)NAN;
  state->time_offset = 0.0;
  state->nearby->known = false;
  state->refined_until = -HUGE_VAL;
  memcpy(state->q, model->start, both);
  memcpy(state->v, model->velocity, both);
  memcpy(state->latest->rest, model->members.rest, slots);
  memcpy(state->modes.slack_length_threshold, model->members.slack, slots);
  memcpy(state->modes.slack_force_threshold, model->members.slack, slots);
  memset(state->latest->rest_rate, 0, slots);
  for (int32_t i = 0; i < model->elements.count; i++) {
    state->modes.element_acts[i] = 0;
    state->modes.element_piece[i] = -1;
    state->history.turn[i] = strut_element_start(model, i);
  }
  for (size_t i = 0; i < model->scene->signal_count; i++) {
    state->signals.held[i] = (double)NAN;
    state->signals.started[i] = (double)INFINITY;
    state->signals.trigger_was[i] = -1;
    state->signals.relay_side[i] = 0;
  }
  for (int32_t k = 0; k < model->sliding.moving_count; k++)
    state->latest->sliding[k] =
        (strut_sliding_motion){.share = model->sliding.item[model->sliding.moving[k]].start};
  for (int32_t i = 0; i < model->elements.history_count; i++) state->history.plastic[i] = 0.0;
  for (int32_t i = 0; i < model->elements.history_slots; i++) {
    state->history.material[i] = state->latest->rest[model->elements.history_slot + i];
    state->history.guide_mode[i] = 2; /* STRUT_GUIDE_FREE */
    state->history.guide_side[i] = 1;
    state->history.guide_drop[i] = 0.0;
  }
  for (int32_t i = 0; i < model->elements.breakable_count; i++)
    state->history.broken_at[i] = HUGE_VAL;
  memset(state->work, 0, sizeof state->work);
  memset(state->latest->power, 0, sizeof state->latest->power);
}

void strut_state_free(strut_state *state) {
  if (!state) return;
  strut_arena_free(&state->arena);
  strut_release(state);
}
