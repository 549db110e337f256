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

bool strut_step_end_create(const strut_model *model, strut_arena *arena, bool borrowed,
                           strut_step_end *end) {
  const strut_contact_table *contacts = &model->contacts;
  return (borrowed || STRUT_NUMBERS(arena, model->length, &end->q, &end->v)) &&
         STRUT_NUMBERS(arena, model->length, &end->a, &end->structure) &&
         STRUT_NUMBERS(arena, most_law_switches(model) + 1, &end->tension, &end->stretch,
                       &end->stretch_rate) &&
         STRUT_ALLOCATE(arena, STRUT_NEW(end->touch, contacts->count)) &&
         (!contacts->surface || STRUT_ALLOCATE(arena, STRUT_NEW(end->frame, contacts->count))) &&
         (!contacts->surface || !contacts->moves ||
          STRUT_ALLOCATE(arena, STRUT_NEW(end->motion, model->scene->ground_count)));
}

static bool make_contacts(const strut_model *model, strut_state *state,
                          strut_event_stepper *stepper) {
  strut_arena *arena = &state->arena;
  int32_t count = model->contacts.count;
  strut_contact_modes *modes = &stepper->modes;
  strut_active_set *active = &stepper->active;
  strut_contact_bodies *contacts = &stepper->contacts;
  contacts->entry = state->latest->grip ? state->latest->grip : model->contacts.entry;
  return STRUT_ALLOCATE(arena, STRUT_NEW(modes->of, count), STRUT_NEW(modes->side, count),
                        STRUT_NEW(modes->damper, count), STRUT_NEW(active->closed, count),
                        STRUT_NEW(active->stuck, count), STRUT_NEW(contacts->body, count),
                        STRUT_NEW(contacts->compliance, count)) &&
         (!model->contacts.surface || STRUT_ALLOCATE(arena, STRUT_NEW(modes->facet, count))) &&
         STRUT_NUMBERS(arena, count, &modes->outward, &contacts->settling_time,
                       &contacts->damped) &&
         /* for recording and measuring: */
         STRUT_ALLOCATE(arena, STRUT_NEW(state->modes.held_normal, count),
                        STRUT_NEW(state->modes.held_friction, count)) &&
         STRUT_NUMBERS(arena, model->length, &contacts->scatter);
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
static bool list_turns(const strut_model *model, strut_state *state, strut_event_stepper *stepper) {
  strut_turns *turns = &stepper->turns;
  turns->first = stepper->laws.count;
  int32_t count = strut_turns_list(model, NULL, NULL);
  uint32_t *ends;
  if (!STRUT_ALLOCATE(&state->arena, STRUT_NEW(ends, 2 * count),
                      STRUT_NEW(turns->ahead, 2 * count)))
    return false;
  turns->ends = ends;
  if (count) turns->count = strut_turns_list(model, stepper->laws.item + turns->first, ends);
  return true;
}

static bool list_kinks(const strut_model *model, strut_arena *arena, strut_event_stepper *stepper) {
  strut_kinks *kinks = &stepper->kinks;
  int32_t count = strut_scene_kinks(model->scene, NULL, NULL), *signal;
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(signal, count), STRUT_NEW(kinks->at, count)) ||
      !STRUT_NUMBERS(arena, count, &kinks->side, &kinks->margin, &kinks->rate, &kinks->largest))
    return false;
  kinks->controlled = stepper->formula->adaptive;
  kinks->count = strut_scene_kinks(model->scene, kinks->at, signal);
  for (int32_t i = 0; i < kinks->count; i++) {
    list_threshold(&stepper->laws, signal[i]);
    stepper->laws.item[stepper->laws.count - 1].kink = 1 + i;
  }
  return true;
}

static bool list_laws(const strut_model *model, strut_state *state, strut_event_stepper *stepper) {
  strut_law_switches *laws = &stepper->laws;
  size_t most = most_law_switches(model);
  if (!most) return true;
  if (!STRUT_ALLOCATE(&state->arena, STRUT_NEW(laws->item, most), STRUT_NEW(laws->acting, most)) ||
      (model->elements.scattered && !STRUT_ALLOCATE(&state->arena, STRUT_NEW(laws->nearby, most))))
    return false;
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
  return !stepper->formula->exact || list_kinks(model, &state->arena, stepper);
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
  strut_arena *arena = &state->arena;
  strut_event_stepper *stepper = strut_arena_allocate(arena, 1, sizeof *stepper);
  if (!stepper) return NULL;
  size_t stages = (size_t)formula->stages, contacts = (size_t)model->contacts.count;
  stepper->formula = formula;
  stepper->now = &stepper->end[0], stepper->next = &stepper->end[1];
  stepper->now->q = state->q, stepper->now->v = state->v;
  stepper->control.tolerance = settings->tolerance;
  if (formula->adaptive) {
    double fastest = stepper->control.frequency = strut_model_fastest_spring(model);
    stepper->control.rounding = rounding_of(model, formula->tableau, fastest);
  }
  bool ready = strut_step_end_create(model, arena, true, stepper->now) &&
               strut_step_end_create(model, arena, false, stepper->next) &&
               make_contacts(model, state, stepper) &&
               STRUT_ALLOCATE(arena, STRUT_NEW(stepper->stage, stages + 1),
                              STRUT_NEW(stepper->middle, model->length));
  for (size_t k = 0; k < stages && ready; k++)
    ready = STRUT_NUMBERS(arena, model->length, &stepper->stage[k]);
  if (!ready || !list_laws(model, state, stepper) || !list_turns(model, state, stepper))
    return NULL;
  stepper->scales = formula->adaptive || stepper->kinks.count;
  size_t switches = contacts + (size_t)(stepper->laws.count + stepper->turns.count);
  strut_chatter *chatter = &stepper->chatter;
  ready = STRUT_ALLOCATE(arena, STRUT_NEW(chatter->times, switches),
                         STRUT_NEW(chatter->switched, switches),
                         STRUT_NEW(stepper->control.least, switches));
  return ready && !strut_event_stepper_prepare(model, state, settings, stepper) ? stepper : NULL;
}
