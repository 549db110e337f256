/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * When contacts, cables and elements change their modes: what methods with events note on request.
 *
 * Items are the contacts, then the members (a cable is taut or slack), then the elements that carry one
 * sign, then the elements again for the smooth pieces of their laws.
 */
#pragma once

#include "engine/model/state.h"

/** What a contact does, as far as the log tells: creep within the band counts as stick. */
typedef enum strut_logged_contact {
  STRUT_LOGGED_OPEN,
  STRUT_LOGGED_SLIDE, /* without friction, or with a smooth law */
  STRUT_LOGGED_FORWARD,
  STRUT_LOGGED_BACKWARD,
  STRUT_LOGGED_STICK
} strut_logged_contact;

typedef struct strut_logged_event {
  double time; /* [s] */
  int32_t item;
  int8_t mode; /* strut_logged_contact; 0 slack or without force, 1 acting; the piece of a law */
} strut_logged_event;

typedef struct strut_event_log {
  int32_t contacts, members, elements, items;
  int8_t *first, *now; /* (items) modes at the start, and at present */
  size_t count, room;
  strut_logged_event *event; /* (count) */
  bool full;                 /* later events are not there */
} strut_event_log;

/** A log for runs of the model, in the arena; attach it as state->watched.event_log. NULL: out of memory. */
STRUT_API strut_event_log *strut_event_log_create(const strut_model *model, strut_arena *arena);

struct strut_event_stepper;
/** The modes at the start of a run: empties the log. */
void strut_event_log_begin(const strut_model *model, const strut_state *state,
                           const struct strut_event_stepper *stepper);
/** Notes what has changed at the time t. */
void strut_event_log_note(const strut_model *model, const strut_state *state,
                          const struct strut_event_stepper *stepper, double t);
