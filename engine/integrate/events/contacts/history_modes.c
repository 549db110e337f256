/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Modes of elements with memory: sliders that hold or give way, and what breaks. See event_stepping.h. */
#include "engine/forces/capstan.h"
#include "engine/forces/drives.h"
#include "engine/forces/history.h"

#include <assert.h>
#include <math.h>

#include "engine/integrate/events/event_stepping.h"

/* A slider whose force is this close to its yield is at it; one that holds is not beyond it by rounding. */
static const double AT_YIELD = 1e-9, ROUNDING = 1e-12;
/* Tensions of a cable that becomes taut are compared after this part of a step. */
static const double SOON = 1e-6;

void strut_history_list(const strut_model *model, const strut_state *state,
                        strut_event_stepper *l) {
  const strut_element_table *t = &model->elements;
  for (int32_t m = 0; m < t->history_count && !state->forgetful; m++) {
    const strut_element *e = &t->element[t->memory[m]];
    for (int32_t k = 0; strut_has_capstan(e) && k + 2 < e->nodes; k++) {
      strut_law_switch slips = {.event = STRUT_EVENT_SLIDER,
                                .member = -1,
                                .element = t->memory[m],
                                .guide = k + 1,
                                .breakable = -1};
      l->laws[l->law_count++] = slips;
      slips.straight = true;
      l->laws[l->law_count++] = slips;
    }
    if (strut_has_capstan(e))
      l->laws[l->law_count++] = (strut_law_switch){.event = STRUT_EVENT_ACTS,
                                                   .member = -1,
                                                   .element = t->memory[m],
                                                   .abrupt = true,
                                                   .stiffness = e->numbers.stiffness,
                                                   .whole = true,
                                                   .breakable = -1};
    if (e->law != STRUT_LAW_ELASTIC_PLASTIC) continue;
    l->laws[l->law_count++] = (strut_law_switch){
        .event = STRUT_EVENT_SLIDER, .member = -1, .element = t->memory[m], .breakable = -1};
  }
  for (int32_t b = 0; b < t->breakable_count && !state->forgetful; b++)
    if (t->breakable[b].force < HUGE_VAL)
      l->laws[l->law_count++] = (strut_law_switch){
          .event = STRUT_EVENT_BREAK, .member = -1, .element = -1, .breakable = b};
}

static bool is_gone(const strut_model *model, const strut_state *state, int32_t element) {
  const strut_element *e = &model->elements.element[element];
  return e->remembers && strut_element_is_gone(state->latest.rest[e->slot]);
}

/* Force that is left to the yield while it holds; the rate, as a force, while it gives way. */
static double slider_margin(const strut_model *model, const strut_state *state,
                            const strut_event_stepper *l, const strut_step_end *end, int32_t i) {
  if (is_gone(model, state, i)) return 1.0;
  strut_slider s = strut_slider_at(model, state, i, end->q, end->v);
  int mode = state->modes.element_piece[i];
  if (mode != STRUT_SLIDER_HOLDS)
    return (mode - STRUT_SLIDER_HOLDS) * s.rate * model->elements.element[i].numbers.stiffness *
           l->wanted_step;
  return s.acts ? s.yield * (1.0 + ROUNDING) - fabs(s.force) : s.yield;
}

/* Is the cable of guide switch k taut in this mode? Its switch as a whole stands behind those of its guides. */
static bool is_taut(const strut_event_stepper *l, int32_t k) {
  int32_t whole = k;
  while (!l->laws[whole].whole) whole++;
  return l->acting[whole];
}

/* All switches of the guides of a cable, the first of which is switch k. */
static void measure_guides(const strut_model *model, const strut_state *state,
                           const strut_event_stepper *l, const strut_step_end *end, int32_t k) {
  int32_t i = l->laws[k].element;
  strut_capstan_guide guide[STRUT_MOST_ELEMENT_NODES];
  bool taut = is_taut(l, k); /* which guides slip is found when it gets so */
  strut_capstan_measure(model, state, i, end->q, end->v, l->wanted_step, guide);
  for (int32_t g = 0; g + 2 < model->elements.element[i].nodes; g++, k += 2) {
    end->tension[k] = taut ? guide[g].margin : 1.0;
    end->tension[k + 1] = guide[g].bend;
  }
}

void strut_history_measure(const strut_model *model, const strut_state *state,
                           const strut_event_stepper *l, const strut_step_end *end, int32_t k) {
  assert(k >= 0 && k < l->law_count);
  const strut_law_switch *law = &l->laws[k];
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
      end->tension[k] = slider_margin(model, state, l, end, law->element);
    else if (law->guide == 1 && !law->straight)
      measure_guides(model, state, l, end, k);
    return;
  }
  bool broken = state->history.broken_at[law->breakable] < HUGE_VAL;
  end->tension[k] = broken ? 1.0
                           : model->elements.breakable[law->breakable].force -
                                 strut_breakable_load(model, state, law->breakable, end->q, end->v);
}

void strut_history_thaw(const strut_model *model, strut_state *state, strut_event_stepper *l) {
  for (int32_t k = 0; k < l->law_count; k++) {
    int32_t i = l->laws[k].element;
    if (l->laws[k].event != STRUT_EVENT_SLIDER || is_gone(model, state, i)) continue;
    l->fresh = false;
    if (l->laws[k].guide) {
      strut_capstan_begin(model, state, i, l->now->q);
      strut_capstan_thaw(model, state, i);
      continue;
    }
    strut_slider_set(model, state, i, -1, l->now->q);
    strut_slider_return(model, state, i, l->now->q, true);
  }
}

void strut_history_start(const strut_model *model, strut_state *state, strut_event_stepper *l,
                         int32_t k) {
  assert(k >= 0 && k < l->law_count);
  int32_t i = l->laws[k].element;
  if (l->laws[k].event != STRUT_EVENT_SLIDER || is_gone(model, state, i)) return;
  l->fresh = false;
  if (l->laws[k].guide) {
    if (l->laws[k].guide == 1 && !l->laws[k].straight)
      strut_capstan_freeze(model, state, i, l->now->q, l->now->v);
    return;
  }
  strut_slider s = strut_slider_at(model, state, i, l->now->q, l->now->v);
  int side = s.force < 0.0 ? -1 : 1;
  bool gives = s.acts && fabs(s.force) >= s.yield * (1.0 - AT_YIELD) && side * s.rate > 0.0;
  strut_slider_set(model, state, i, gives ? STRUT_SLIDER_HOLDS + side : STRUT_SLIDER_HOLDS,
                   l->now->q);
}

void strut_history_drop_gone(const strut_model *model, strut_state *state, strut_event_stepper *l) {
  for (int32_t k = 0; k < l->law_count; k++) {
    const strut_law_switch *law = &l->laws[k];
    if (law->element < 0 || law->event != STRUT_EVENT_ACTS) continue;
    if (!is_gone(model, state, law->element)) continue;
    state->modes.element_acts[law->element] = -1;
    l->acting[k] = false;
  }
}

void strut_history_apply(const strut_model *model, strut_state *state, strut_event_stepper *l,
                         int32_t k, double t) {
  assert(k >= 0 && k < l->law_count);
  const strut_law_switch *law = &l->laws[k];
  l->fresh = false;
  strut_drive_apply(model, state, t); /* a rejected step has been further */
  if (law->whole) {
    double soon = SOON * l->wanted_step;
    if (l->acting[k]) strut_capstan_tauten(model, state, law->element, l->now->q, l->now->v, soon);
    return;
  }
  if (law->event == STRUT_EVENT_BREAK) {
    strut_breakable_break(model, state, law->breakable, t + state->time_offset);
    strut_history_drop_gone(model, state, l);
    return;
  }
  if (law->straight) {
    strut_capstan_pass_straight(model, state, law->element, law->guide - 1);
    return;
  }
  if (law->guide) {
    strut_capstan_switch(model, state, law->element, law->guide - 1, l->now->q);
    return;
  }
  int mode = STRUT_SLIDER_HOLDS;
  if (state->modes.element_piece[law->element] == STRUT_SLIDER_HOLDS) {
    strut_slider s = strut_slider_at(model, state, law->element, l->now->q, l->now->v);
    mode = s.force < 0.0 ? STRUT_SLIDER_BACK : STRUT_SLIDER_FORTH;
  }
  strut_slider_set(model, state, law->element, mode, l->now->q);
}
