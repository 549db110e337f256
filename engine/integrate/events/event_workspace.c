/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The workspace of methods with events: arrays, and a list of what switches. */
#include <float.h>
#include <math.h>

#include "engine/integrate/events/event_stepping.h"
#include "engine/model/compile_parts.h"

/* Most laws that switch: each cable, each element by its sign, by its kinks and by its memory, thresholds. */
static size_t most_law_switches(const strut_model *model) {
  bool slack = model->terms & STRUT_TERM_SLACK;
  return (slack ? (size_t)model->members.count : 0) + 2 * (size_t)model->elements.count +
         (size_t)(2 * model->elements.history_slots + model->elements.breakable_count +
                  model->feedback.relay_count + model->feedback.trigger_count +
                  strut_turns_list(model, NULL, NULL) +
                  strut_scene_kinks(model->scene, NULL, NULL));
}

static void *make(strut_arena *arena, size_t count, size_t size, bool *failed) {
  void *array = strut_arena_allocate(arena, count, size);
  *failed = *failed || !array;
  return array;
}

static double *make_doubles(strut_arena *arena, size_t count, bool *failed) {
  return make(arena, count, sizeof(double), failed);
}

void strut_step_end_create(const strut_model *model, strut_arena *arena, bool borrowed,
                           strut_step_end *end, bool *failed) {
  const strut_contact_table *contacts = &model->contacts;
  size_t length = (size_t)model->length, switches = most_law_switches(model) + 1;
  if (!borrowed) end->q = make_doubles(arena, length, failed);
  if (!borrowed) end->v = make_doubles(arena, length, failed);
  end->a = make_doubles(arena, length, failed);
  end->structure = make_doubles(arena, length, failed);
  end->touch = make(arena, (size_t)contacts->count, sizeof *end->touch, failed);
  end->tension = make_doubles(arena, switches, failed);
  end->stretch = make_doubles(arena, switches, failed);
  end->stretch_rate = make_doubles(arena, switches, failed);
  if (contacts->surface)
    end->frame = make(arena, (size_t)contacts->count, sizeof *end->frame, failed);
  if (contacts->surface && contacts->moves)
    end->motion = make(arena, model->scene->ground_count, sizeof *end->motion, failed);
}

static void make_contacts(const strut_model *model, strut_state *state,
                          strut_event_stepper *stepper, bool *failed) {
  strut_arena *arena = &state->arena;
  size_t count = (size_t)model->contacts.count;
  strut_contact_modes *modes = &stepper->modes;
  modes->of = make(arena, count, 1, failed);
  modes->side = make(arena, count, 1, failed);
  modes->damper = make(arena, count, 1, failed);
  modes->outward = make_doubles(arena, count, failed);
  if (model->contacts.surface) modes->facet = make(arena, count, sizeof *modes->facet, failed);
  stepper->active.closed = make(arena, count, sizeof *stepper->active.closed, failed);
  stepper->active.stuck = make(arena, count, sizeof *stepper->active.stuck, failed);
  strut_contact_bodies *contacts = &stepper->contacts;
  contacts->entry = state->latest->grip ? state->latest->grip : model->contacts.entry;
  contacts->body = make(arena, count, sizeof *contacts->body, failed);
  contacts->compliance = make(arena, count, sizeof *contacts->compliance, failed);
  contacts->settling_time = make_doubles(arena, count, failed);
  contacts->damped = make_doubles(arena, count, failed);
  contacts->scatter = make_doubles(arena, (size_t)model->length, failed);
  /* for recording and measuring: */
  state->modes.held_normal = make_doubles(arena, count, failed);
  state->modes.held_friction = make_doubles(arena, count, failed);
}

static void list_cables(const strut_model *model, strut_law_switches *laws) {
  const strut_member_table *members = &model->members;
  for (int32_t j = 0; j < members->count; j++)
    if (members->slack[j] == 0.0)
      laws->item[laws->count++] = (strut_law_switch){.event = STRUT_EVENT_ACTS,
                                                     .member = j,
                                                     .element = -1,
                                                     .stiffness = members->stiffness[j],
                                                     .damping = members->damping[j]};
}

static void list_elements(const strut_model *model, const strut_state *state,
                          strut_law_switches *laws) {
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *element = &model->elements.element[i];
    double natural = strut_element_start(model, i);
    strut_law_response rest =
        strut_law_respond(element->law, &element->numbers, natural, natural, -1);
    bool abrupt = element->carries * rest.force > 0.0 || (rest.force == 0.0 && !(rest.slope > 0.0));
    const strut_law_switch own = {.event = STRUT_EVENT_ACTS,
                                  .member = -1,
                                  .element = i,
                                  .abrupt = abrupt,
                                  .stiffness = element->numbers.stiffness,
                                  .damping = element->damping};
    bool rubs = element->guide_friction > 0.0 && !state->forgetful;
    if (element->carries && !rubs) laws->item[laws->count++] = own;
    if (!strut_law_kinks(element->law, &element->numbers)) continue;
    laws->item[laws->count] = own;
    laws->item[laws->count++].event = STRUT_EVENT_KINK;
  }
}

static void list_threshold(strut_law_switches *laws, int32_t signal) {
  laws->item[laws->count++] = (strut_law_switch){
      .event = STRUT_EVENT_THRESHOLD, .member = -1, .element = -1, .signal = 1 + signal};
}

/* Behind all others. */
static void list_turns(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                       bool *failed) {
  strut_turns *turns = &stepper->turns;
  turns->first = stepper->laws.count;
  int32_t count = strut_turns_list(model, NULL, NULL);
  uint32_t *ends = make(&state->arena, 2 * (size_t)count, sizeof *ends, failed);
  turns->ahead = make_doubles(&state->arena, 2 * (size_t)count, failed);
  turns->ends = ends;
  if (*failed || !count) return;
  turns->count = strut_turns_list(model, stepper->laws.item + turns->first, ends);
}

static void list_kinks(const strut_model *model, strut_arena *arena, strut_event_stepper *stepper,
                       bool *failed) {
  strut_kinks *kinks = &stepper->kinks;
  int32_t count = strut_scene_kinks(model->scene, NULL, NULL);
  int32_t *signal = make(arena, (size_t)count, sizeof *signal, failed);
  kinks->at = make(arena, (size_t)count, sizeof *kinks->at, failed);
  double **arrays[] = {&kinks->side, &kinks->margin, &kinks->rate, &kinks->largest};
  for (int k = 0; k < 4; k++) *arrays[k] = make_doubles(arena, (size_t)count, failed);
  if (*failed) return;
  kinks->controlled = stepper->formula->adaptive;
  kinks->count = strut_scene_kinks(model->scene, kinks->at, signal);
  for (int32_t i = 0; i < kinks->count; i++) {
    list_threshold(&stepper->laws, signal[i]);
    stepper->laws.item[stepper->laws.count - 1].kink = 1 + i;
  }
}

static void list_laws(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                      bool *failed) {
  strut_law_switches *laws = &stepper->laws;
  size_t most = most_law_switches(model);
  if (!most) return;
  laws->item = make(&state->arena, most, sizeof *laws->item, failed);
  laws->acting = make(&state->arena, most, 1, failed);
  if (model->elements.scattered)
    laws->nearby = make(&state->arena, most, sizeof *laws->nearby, failed);
  if (*failed) return;
  list_cables(model, laws);
  list_elements(model, state, laws);
  strut_history_list(model, state, laws);
  for (int32_t i = 0; i < model->feedback.relay_count; i++)
    list_threshold(laws, model->feedback.relay[i]);
  for (int32_t i = 0; i < model->feedback.trigger_count && !state->forgetful; i++) {
    int32_t signal = model->feedback.triggered[i];
    if (model->scene->signals[signal].trigger.kind != STRUT_TRIGGER_CONTACT)
      list_threshold(laws, signal);
  }
  if (stepper->formula->exact) list_kinks(model, &state->arena, stepper, failed);
}

/*
 * What rounding leaves of a pair's difference of accelerations [m/s^2]: lengths are known to a part in 1e16 of the
 * size, and the stiffest spring on the lightest node pulls by as much.
 */
static double rounding_of(const strut_model *model, const strut_tableau *pair, double fastest) {
  double weights = 0.0;
  for (int k = 0; k <= pair->stages; k++) weights += fabs(pair->difference[k]);
  return DBL_EPSILON * model->size * fastest * fastest * weights;
}

void *strut_event_stepper_create(const strut_model *model, strut_state *state,
                                 const strut_step_formula *formula,
                                 const strut_integrator_settings *settings) {
  bool failed = false;
  strut_arena *arena = &state->arena;
  strut_event_stepper *stepper = make(arena, 1, sizeof *stepper, &failed);
  if (failed) return NULL;
  size_t stages = (size_t)formula->stages, contacts = (size_t)model->contacts.count;
  stepper->formula = formula;
  stepper->now = &stepper->end[0], stepper->next = &stepper->end[1];
  stepper->now->q = state->q, stepper->now->v = state->v;
  stepper->control.tolerance = settings->tolerance;
  if (formula->adaptive) {
    double fastest = stepper->control.frequency = strut_model_fastest_spring(model);
    stepper->control.rounding = rounding_of(model, formula->tableau, fastest);
  }
  strut_step_end_create(model, arena, true, stepper->now, &failed);
  strut_step_end_create(model, arena, false, stepper->next, &failed);
  make_contacts(model, state, stepper, &failed);
  stepper->stage = make(arena, stages + 1, sizeof *stepper->stage, &failed);
  for (size_t k = 0; k < stages && !failed; k++)
    stepper->stage[k] = make_doubles(arena, (size_t)model->length, &failed);
  stepper->middle = make_doubles(arena, (size_t)model->length, &failed);
  list_laws(model, state, stepper, &failed);
  if (!failed) list_turns(model, state, stepper, &failed);
  stepper->scales = formula->adaptive || stepper->kinks.count;
  size_t switches = contacts + (size_t)(stepper->laws.count + stepper->turns.count);
  strut_chatter *chatter = &stepper->chatter;
  chatter->times = make(arena, switches, sizeof *chatter->times, &failed);
  chatter->switched = make(arena, switches, sizeof *chatter->switched, &failed);
  stepper->control.least = make(arena, switches, sizeof *stepper->control.least, &failed);
  return failed || strut_event_stepper_prepare(model, state, settings, stepper) ? NULL : stepper;
}
