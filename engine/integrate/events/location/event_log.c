/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/events/location/event_log.h"

#include "engine/integrate/events/event_stepping.h"

enum { MOST_EVENTS = 8192 };

strut_event_log *strut_event_log_create(const strut_model *model, strut_arena *arena) {
  strut_event_log *log = strut_arena_allocate(arena, 1, sizeof *log);
  if (!log) return NULL;
  log->contacts = model->contacts.count;
  log->members = model->members.count;
  log->elements = model->elements.count;
  log->items = log->contacts + log->members + 2 * log->elements;
  log->room = MOST_EVENTS;
  bool ready =
      STRUT_ALLOCATE(arena, STRUT_NEW(log->first, log->items + 1),
                     STRUT_NEW(log->now, log->items + 1), STRUT_NEW(log->event, log->room));
  return ready ? log : NULL;
}

static int8_t contact_mode(const strut_event_stepper *stepper, int32_t i) {
  switch ((strut_contact_mode)stepper->modes.of[i]) {
    case STRUT_MODE_OPEN: return STRUT_LOGGED_OPEN;
    case STRUT_MODE_SLIDE: return STRUT_LOGGED_SLIDE;
    case STRUT_MODE_SLIP:
      return stepper->modes.side[i] > 0 ? STRUT_LOGGED_FORWARD : STRUT_LOGGED_BACKWARD;
    case STRUT_MODE_STICK:
    case STRUT_MODE_BAND:
    case STRUT_MODE_PUSH:
    case STRUT_MODE_YIELD:
    case STRUT_MODE_CREEP: return STRUT_LOGGED_STICK;
  }
  return STRUT_LOGGED_OPEN;
}

static void set_mode(strut_event_log *log, int32_t item, int8_t mode, double t) {
  if (log->now[item] == mode) return;
  log->now[item] = mode;
  log->full = log->full || log->count == log->room;
  if (!log->full) log->event[log->count++] = (strut_logged_event){t, item, mode};
}

void strut_event_log_note(const strut_model *model, const strut_state *state,
                          const strut_event_stepper *stepper, double t) {
  strut_event_log *log = state->watched.event_log;
  for (int32_t i = 0; i < model->contacts.count; i++) set_mode(log, i, contact_mode(stepper, i), t);
  int32_t laws = strut_laws_of(&stepper->laws);
  for (int32_t n = 0; n < laws; n++) {
    int32_t k = strut_law_of(&stepper->laws, n);
    const strut_law_switch *law_switch = &stepper->laws.item[k];
    if (law_switch->event == STRUT_EVENT_ACTS && law_switch->member >= 0)
      set_mode(log, log->contacts + law_switch->member, (int8_t)stepper->laws.acting[k], t);
    else if (law_switch->event == STRUT_EVENT_ACTS)
      set_mode(log, log->contacts + log->members + law_switch->element,
               (int8_t)stepper->laws.acting[k], t);
    else if (law_switch->event == STRUT_EVENT_KINK && law_switch->element >= 0)
      set_mode(log, log->contacts + log->members + log->elements + law_switch->element,
               (int8_t)state->modes.element_piece[law_switch->element], t);
  }
}

void strut_event_log_begin(const strut_model *model, const strut_state *state,
                           const strut_event_stepper *stepper) {
  strut_event_log *log = state->watched.event_log;
  for (int32_t i = 0; i < log->items; i++) log->now[i] = 0;
  strut_event_log_note(model, state, stepper, 0.0);
  for (int32_t i = 0; i < log->items; i++) log->first[i] = log->now[i];
  log->count = 0;
  log->full = false;
}
