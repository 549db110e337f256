/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Modes of elements with memory: sliders that hold or give way, and what breaks. See event_stepping.h. */
#include "engine/forces/capstan.h"
#include "engine/forces/drives/drives.h"
#include "engine/forces/history.h"

#include <assert.h>
#include <math.h>

#include "engine/integrate/events/event_stepping.h"

/* A slider whose force is this close to its yield is at it; one that holds is not beyond it by rounding. */
static const double AT_YIELD = 1e-9, ROUNDING = 1e-12;
/* Tensions of a cable that becomes taut are compared after this part of a step. */
static const double SOON = 1e-6;

void strut_history_list(const strut_model *model, const strut_state *state,
                        strut_law_switches *laws) {
  const strut_element_table *elements = &model->elements;
  for (int32_t m = 0; m < elements->history_count && !state->forgetful; m++) {
    const strut_element *element = &elements->element[elements->memory[m]];
    for (int32_t k = 0; strut_has_capstan(element) && k + 2 < element->nodes; k++) {
      strut_law_switch slips = {.event = STRUT_EVENT_SLIDER,
                                .member = -1,
                                .element = elements->memory[m],
                                .guide = k + 1,
                                .breakable = -1};
      laws->item[laws->count++] = slips;
      slips.straight = true;
      laws->item[laws->count++] = slips;
    }
    if (strut_has_capstan(element))
      laws->item[laws->count++] = (strut_law_switch){.event = STRUT_EVENT_ACTS,
                                                     .member = -1,
                                                     .element = elements->memory[m],
                                                     .abrupt = true,
                                                     .stiffness = element->numbers.stiffness,
                                                     .whole = true,
                                                     .breakable = -1};
    if (element->law != STRUT_LAW_ELASTIC_PLASTIC) continue;
    laws->item[laws->count++] = (strut_law_switch){
        .event = STRUT_EVENT_SLIDER, .member = -1, .element = elements->memory[m], .breakable = -1};
  }
  for (int32_t b = 0; b < elements->breakable_count && !state->forgetful; b++)
    if (elements->breakable[b].force < HUGE_VAL)
      laws->item[laws->count++] = (strut_law_switch){
          .event = STRUT_EVENT_BREAK, .member = -1, .element = -1, .breakable = b};
}

static bool is_gone(const strut_model *model, const strut_state *state, int32_t element) {
  const strut_element *e = &model->elements.element[element];
  return e->remembers && strut_element_is_gone(state->latest->rest[e->slot]);
}

/* Force that is left to the yield while it holds; the rate, as a force, while it gives way. */
static double slider_margin(const strut_model *model, const strut_state *state,
                            const strut_event_stepper *stepper, const strut_step_end *end,
                            int32_t i) {
  if (is_gone(model, state, i)) return 1.0;
  strut_slider s = strut_slider_at(model, state, i, end->q, end->v);
  int mode = state->modes.element_piece[i];
  if (mode != STRUT_SLIDER_HOLDS)
    return (mode - STRUT_SLIDER_HOLDS) * s.rate * model->elements.element[i].numbers.stiffness *
           stepper->control.wanted_step;
  return s.acts ? s.yield * (1.0 + ROUNDING) - fabs(s.force) : s.yield;
}

/* Is the cable of guide switch k taut in this mode? Its switch as a whole stands behind those of its guides. */
static bool is_taut(const strut_event_stepper *stepper, int32_t k) {
  int32_t whole = k;
  while (!stepper->laws.item[whole].whole) whole++;
  return stepper->laws.acting[whole];
}

/* All switches of the guides of a cable, the first of which is switch k. */
static void measure_guides(const strut_model *model, const strut_state *state,
                           const strut_event_stepper *stepper, const strut_step_end *end,
                           int32_t k) {
  int32_t i = stepper->laws.item[k].element;
  strut_capstan_guide guide[STRUT_MOST_ELEMENT_NODES];
  bool taut = is_taut(stepper, k); /* which guides slip is found when it gets so */
  strut_capstan_measure(model, state, i, end->q, end->v, stepper->control.wanted_step, guide);
  for (int32_t g = 0; g + 2 < model->elements.element[i].nodes; g++, k += 2) {
    end->tension[k] = taut ? guide[g].margin : 1.0;
    end->tension[k + 1] = guide[g].bend;
  }
}

void strut_history_measure(const strut_model *model, const strut_state *state,
                           const strut_event_stepper *stepper, const strut_step_end *end,
                           int32_t k) {
  assert(k >= 0 && k < stepper->laws.count);
  const strut_law_switch *law = &stepper->laws.item[k];
  end->stretch[k] = 1.0;
  end->stretch_rate[k] = 0.0;
  if (law->whole) {
    bool gone = is_gone(model, state, law->element);
    strut_capstan_stretch s = {-1.0, 0.0};
    if (!gone) s = strut_capstan_stretch_of(model, state, law->element, end->q, end->v);
    end->stretch[k] = s.stretch, end->stretch_rate[k] = s.rate;
    end->tension[k] = law->stiffness * s.stretch;
    return;
  }
  if (law->event == STRUT_EVENT_SLIDER) {
    if (!law->guide || is_gone(model, state, law->element))
      end->tension[k] = slider_margin(model, state, stepper, end, law->element);
    else if (law->guide == 1 && !law->straight)
      measure_guides(model, state, stepper, end, k);
    return;
  }
  bool broken = state->history.broken_at[law->breakable] < HUGE_VAL;
  end->tension[k] = broken ? 1.0
                           : model->elements.breakable[law->breakable].force -
                                 strut_breakable_load(model, state, law->breakable, end->q, end->v);
}

void strut_history_thaw(const strut_model *model, strut_state *state,
                        strut_event_stepper *stepper) {
  for (int32_t k = 0; k < stepper->laws.count; k++) {
    int32_t i = stepper->laws.item[k].element;
    if (stepper->laws.item[k].event != STRUT_EVENT_SLIDER || is_gone(model, state, i)) continue;
    stepper->fresh = false;
    if (stepper->laws.item[k].guide) {
      strut_capstan_begin(model, state, i, stepper->now->q);
      strut_capstan_thaw(model, state, i);
      continue;
    }
    strut_slider_set(model, state, i, -1, stepper->now->q);
    strut_slider_return(model, state, i, stepper->now->q, true);
  }
}

void strut_history_start(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                         int32_t k) {
  assert(k >= 0 && k < stepper->laws.count);
  int32_t i = stepper->laws.item[k].element;
  if (stepper->laws.item[k].event != STRUT_EVENT_SLIDER || is_gone(model, state, i)) return;
  stepper->fresh = false;
  if (stepper->laws.item[k].guide) {
    if (stepper->laws.item[k].guide == 1 && !stepper->laws.item[k].straight)
      strut_capstan_freeze(model, state, i, stepper->now->q, stepper->now->v);
    return;
  }
  strut_slider s = strut_slider_at(model, state, i, stepper->now->q, stepper->now->v);
  int side = s.force < 0.0 ? -1 : 1;
  bool gives = s.acts && fabs(s.force) >= s.yield * (1.0 - AT_YIELD) && side * s.rate > 0.0;
  strut_slider_set(model, state, i, gives ? STRUT_SLIDER_HOLDS + side : STRUT_SLIDER_HOLDS,
                   stepper->now->q);
}

void strut_history_drop_gone(const strut_model *model, strut_state *state,
                             strut_law_switches *laws) {
  for (int32_t k = 0; k < laws->count; k++) {
    const strut_law_switch *law = &laws->item[k];
    if (law->element < 0 || law->event != STRUT_EVENT_ACTS) continue;
    if (!is_gone(model, state, law->element)) continue;
    state->modes.element_acts[law->element] = -1;
    laws->acting[k] = false;
  }
}

void strut_history_apply(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                         int32_t k, double t) {
  assert(k >= 0 && k < stepper->laws.count);
  const strut_law_switch *law = &stepper->laws.item[k];
  stepper->fresh = false;
  strut_drive_apply(model, state, t); /* a rejected step has been further */
  if (law->whole) {
    double soon = SOON * stepper->control.wanted_step;
    if (stepper->laws.acting[k])
      strut_capstan_tauten(model, state, law->element, stepper->now->q, stepper->now->v, soon);
    return;
  }
  if (law->event == STRUT_EVENT_BREAK) {
    strut_breakable_break(model, state, law->breakable, t + state->time_offset);
    strut_history_drop_gone(model, state, &stepper->laws);
    return;
  }
  if (law->straight) {
    strut_capstan_pass_straight(model, state, law->element, law->guide - 1);
    return;
  }
  if (law->guide) {
    strut_capstan_switch(model, state, law->element, law->guide - 1, stepper->now->q);
    return;
  }
  int mode = STRUT_SLIDER_HOLDS;
  if (state->modes.element_piece[law->element] == STRUT_SLIDER_HOLDS) {
    strut_slider s = strut_slider_at(model, state, law->element, stepper->now->q, stepper->now->v);
    mode = s.force < 0.0 ? STRUT_SLIDER_BACK : STRUT_SLIDER_FORTH;
  }
  strut_slider_set(model, state, law->element, mode, stepper->now->q);
}
