/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How contact nodes answer to forces on them, and the multipliers that hold stuck ones. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/indices.h"
#include "engine/integrate/events/event_kernel.h"
#include "engine/model/algebra/dense_cholesky.h"

/* Entries below this part of a column's largest one change no bit that matters. */
static const double NEGLIGIBLE = 1e-18;
/* Sets of stuck contacts above this size are solved for by sweeps, without a matrix. */
enum { LARGEST_FACTOR = 512 };
/* Steps are not made shorter than by this on a contact's account: its damper is implicit anyway. */
static const double MOST_REFINED = 64.0;

/* The column of M^-1 for one coordinate of a node, into `column` (length). */
static void solve_column(const strut_model *model, const strut_state *state, uint32_t at,
                         double *column) {
  assert(at < (uint32_t)model->length);
  memset(state->latest->force, 0, (size_t)model->length * sizeof(double));
  state->latest->force[at] = 1.0;
  strut_mass_solve(model, state->latest->force, column, state->buffers->mass_solve);
}

/* Then the mass matrix changes with time, and with it the compliances. */
static bool has_moving_masses(const strut_model *model) {
  return model->terms & STRUT_TERM_SLIDING_MASS;
}

/* The compliances of the node itself, from the column of M^-1. */
static void find_own(const strut_contact_table *contacts, double x, double y,
                     strut_contact_compliance *compliance) {
  compliance->own[0] = x, compliance->own[1] = y;
  compliance->normal =
      x * contacts->normal[0] * contacts->normal[0] + y * contacts->normal[1] * contacts->normal[1];
  compliance->tangent = x * contacts->tangent[0] * contacts->tangent[0] +
                        y * contacts->tangent[1] * contacts->tangent[1];
  if (contacts->surface) compliance->normal = compliance->tangent = fmax(x, y);
}

/* Marks the nodes that answer to a force, directly or through masses that slide. */
static void mark_nodes(const strut_model *model, const double *vector, const double *y,
                       double least, uint8_t *answers) {
  const strut_sliding_table *table = &model->sliding;
  for (int32_t i = 0; i < model->node_count; i++)
    answers[i] = fabs(vector[2 * i]) > least || fabs(y[2 * i + 1]) > least;
  for (bool more = table->moving_count > 0; more;) {
    more = false;
    for (int32_t k = 0; k < table->moving_count; k++) {
      const strut_sliding_item *item = &table->item[table->moving[k]];
      const strut_sliding_answer *answer = &table->answer[k];
      if (!answers[item->at[0] / 2] && !answers[item->at[1] / 2]) continue;
      for (int32_t i = 0; i < answer->count; i++) {
        more = more || !answers[answer->at[i] / 2];
        answers[answer->at[i] / 2] = 1;
      }
    }
  }
}

static strut_status make_compliance(const strut_model *model, strut_state *state, int32_t i,
                                    double *vector, double *y, uint8_t *answers,
                                    strut_contact_compliance *compliance) {
  assert(i >= 0 && i < model->contacts.count);
  const strut_contact_table *contacts = &model->contacts;
  uint32_t at = contacts->at[i];
  solve_column(model, state, at, vector);
  solve_column(model, state, at + 1, y);
  double least = NEGLIGIBLE * fmax(fabs(vector[at]), fabs(y[at + 1]));
  size_t count = 0;
  mark_nodes(model, vector, y, least, answers);
  for (int32_t k = 0; k < model->node_count; k++) count += answers[k];
  uint32_t *place;
  double *xy;
  if (!STRUT_ALLOCATE(&state->arena, STRUT_NEW(place, count), STRUT_NEW(xy, 2 * count)))
    return STRUT_NO_MEMORY;
  for (int32_t k = 0; k < 2 * model->node_count; k += 2) {
    if (!answers[k / 2]) continue;
    place[compliance->count] = (uint32_t)k;
    xy[2 * compliance->count] = vector[k];
    xy[2 * compliance->count++ + 1] = y[k + 1];
  }
  compliance->at = place, compliance->xy = xy;
  find_own(contacts, vector[at], y[at + 1], compliance);
  if (!(model->terms & STRUT_TERM_SLIDING_MASS)) return STRUT_OK;
  compliance->constant = strut_arena_copy(&state->arena, xy, 2 * count, sizeof *xy);
  return compliance->constant ? STRUT_OK : STRUT_NO_MEMORY;
}

/* The compliance of contact i with sliding masses as they have been placed. */
static void refresh_compliance(const strut_model *model, const strut_state *state,
                               strut_event_stepper *stepper, int32_t i) {
  assert(i >= 0 && i < model->contacts.count);
  strut_contact_compliance *compliance = &stepper->contacts.compliance[i];
  double *xy = (double *)compliance->xy, *column = stepper->contacts.scatter;
  uint32_t at = model->contacts.at[i];
  for (int32_t k = 0; k < compliance->count; k++)
    for (uint32_t c = 0; c < 2; c++)
      column[compliance->at[k] + c] = compliance->constant[2 * (uint32_t)k + c];
  strut_sliding_masses_correct(model, state, column);
  find_own(&model->contacts, column[at], column[at + 1], compliance);
  for (int32_t k = 0; k < compliance->count; k++)
    for (uint32_t c = 0; c < 2; c++) {
      xy[2 * (uint32_t)k + c] = column[compliance->at[k] + c];
      column[compliance->at[k] + c] = 0.0;
    }
  for (int32_t m = 0; m < model->sliding.moving_count; m++) { /* what is cut from compliances */
    const strut_sliding_answer *answer = &model->sliding.answer[m];
    for (int32_t k = 0; k < answer->count; k++)
      column[answer->at[k]] = column[answer->at[k] + 1] = 0.0;
  }
}

void strut_refresh_compliances(const strut_model *model, const strut_state *state,
                               strut_event_stepper *stepper) {
  for (int32_t k = 0; k < stepper->active.closed_count; k++)
    refresh_compliance(model, state, stepper, stepper->active.closed[k]);
}

/* How long a closed contact remembers a touchdown: the slower root of m s^2 + k s + c; undamped, three periods. */
static double settling_time(const strut_contact_entry *contact, double inverse_mass) {
  double rate = 0.5 * contact->damping * inverse_mass, square = contact->stiffness * inverse_mass;
  if (!(square > 0.0)) return 0.0;
  double longest = 18.0 / sqrt(square);
  if (rate * rate > square) rate -= sqrt(rate * rate - square);
  return rate * longest > 1.0 ? 1.0 / rate : longest;
}

/* Joins contacts that accelerate a common node. */
static strut_status find_bodies(const strut_model *model, strut_event_stepper *stepper) {
  strut_contact_bodies *contacts = &stepper->contacts;
  size_t nodes = (size_t)model->node_count;
  int32_t *seen = strut_allocate(nodes, sizeof *seen), count = model->contacts.count;
  if (!seen) return STRUT_NO_MEMORY;
  for (int32_t i = 0; i < count; i++) {
    const strut_contact_compliance *compliance = &contacts->compliance[i];
    contacts->body[i] = i;
    for (int32_t k = 0; k < compliance->count; k++) {
      int32_t *first = &seen[compliance->at[k] / 2]; /* one more than the index; 0: none yet */
      if (*first)
        contacts->body[strut_index_root(contacts->body, *first - 1)] =
            strut_index_root(contacts->body, i);
      else
        *first = i + 1;
    }
  }
  for (int32_t i = 0; i < count; i++) contacts->body[i] = strut_index_root(contacts->body, i);
  strut_release(seen);
  return STRUT_OK;
}

strut_status strut_event_stepper_prepare(const strut_model *model, strut_state *state,
                                         const strut_integrator_settings *settings,
                                         strut_event_stepper *stepper) {
  strut_contact_bodies *contacts = &stepper->contacts;
  strut_active_set *active = &stepper->active;
  const strut_contact_table *c = &model->contacts;
  double *x = stepper->next->q, *y = stepper->next->v;
  double fastest = 0.0;
  memset(x, 0, (size_t)model->length * sizeof *x);
  memset(y, 0, (size_t)model->length * sizeof *y);
  uint8_t *answers =
      strut_arena_allocate(&state->arena, (size_t)model->node_count, sizeof *answers);
  if (!answers) return STRUT_NO_MEMORY;
  if (model->terms & STRUT_TERM_SLIDING_MASS) strut_sliding_masses_place(model, state, 0.0);
  for (int32_t i = 0; i < c->count; i++) {
    strut_status status = make_compliance(model, state, i, x, y, answers, &contacts->compliance[i]);
    if (status) return status;
    if (model->terms & STRUT_TERM_SLIDING_MASS) refresh_compliance(model, state, stepper, i);
    contacts->settling_time[i] = settling_time(&c->entry[i], contacts->compliance[i].normal);
    fastest = fmax(fastest, c->entry[i].damping * contacts->compliance[i].normal);
    fastest = fmax(fastest, sqrt(c->entry[i].stiffness * contacts->compliance[i].normal));
  }
  double wanted = ceil(fastest * settings->step / settings->refine_rate);
  stepper->control.wanted_step = settings->step;
  stepper->control.refine =
      settings->refine > 0.0 ? settings->refine : fmin(fmax(1.0, wanted), MOST_REFINED);
  stepper->control.refine_time = settings->refine_time;
  stepper->control.refine_memory = settings->refine_memory;
  contacts->passes = c->surface || (c->normal[0] != 0.0 && !model->mass->shared) ? 8 : 1;
  active->stuck_room = c->count < LARGEST_FACTOR ? c->count : LARGEST_FACTOR;
  size_t room = (size_t)active->stuck_room;
  if (!STRUT_ALLOCATE(&state->arena, STRUT_NEW(active->factor, room * room),
                      STRUT_NEW(active->work, c->count), STRUT_NEW(contacts->body_seen, c->count),
                      STRUT_NEW(active->sliding, c->count)))
    return STRUT_NO_MEMORY;
  return find_bodies(model, stepper);
}

STRUT_INLINE void push(const strut_contact_compliance *compliance, const strut_contact_axes *axes,
                       double normal, double tangential, double *restrict acceleration) {
  const strut_pair force = {tangential * axes->tangent[0] + normal * axes->normal[0],
                            tangential * axes->tangent[1] + normal * axes->normal[1]};
  for (int32_t k = 0, count = compliance->count; k < count; k++) {
    double *node = acceleration + compliance->at[k];
    strut_pair_store(node, strut_pair_load(node) + strut_pair_load(compliance->xy + 2 * k) * force);
  }
}

void strut_apply_contact_impulse(const strut_contact_compliance *compliance,
                                 const strut_contact_axes *axes, double normal, double tangential,
                                 double *acceleration) {
  push(compliance, axes, normal, tangential, acceleration);
}

/* In place, lower triangle; false if it is not positive definite. */
static bool factor(int32_t n, double *matrix) {
  for (int32_t j = 0; j < n; j++) {
    for (int32_t k = 0; k < j; k++)
      for (int32_t i = j; i < n; i++) matrix[i * n + j] -= matrix[i * n + k] * matrix[j * n + k];
    if (!(matrix[j * n + j] > 0.0)) return false;
    double root = sqrt(matrix[j * n + j]);
    for (int32_t i = j; i < n; i++) matrix[i * n + j] /= root;
  }
  return true;
}

/* T' M^-1 T of the stuck contacts, column by column through the scatter array. */
static void factor_stuck(const strut_model *model, strut_event_stepper *stepper,
                         const strut_contact_frame *frame) {
  const strut_contact_bodies *contacts = &stepper->contacts;
  strut_active_set *active = &stepper->active;
  const strut_contact_table *c = &model->contacts;
  int32_t n = active->stuck_count;
  for (int32_t j = 0; j < n; j++) {
    const strut_contact_compliance *compliance = &contacts->compliance[active->stuck[j]];
    const double *t = strut_axes_of_contact(c, frame, active->stuck[j])->tangent;
    for (int32_t k = 0; k < compliance->count; k++) {
      contacts->scatter[compliance->at[k]] = compliance->xy[2 * k] * t[0];
      contacts->scatter[compliance->at[k] + 1] = compliance->xy[2 * k + 1] * t[1];
    }
    for (int32_t i = j; i < n; i++) {
      uint32_t at = c->at[active->stuck[i]];
      const double *s = strut_axes_of_contact(c, frame, active->stuck[i])->tangent;
      active->factor[i * n + j] = contacts->scatter[at] * s[0] + contacts->scatter[at + 1] * s[1];
    }
    for (int32_t k = 0; k < compliance->count; k++)
      contacts->scatter[compliance->at[k]] = contacts->scatter[compliance->at[k] + 1] = 0.0;
  }
  if (!factor(n, active->factor)) active->stuck_count = -n; /* singular: by sweeps */
}

static bool is_sliding(const strut_event_stepper *stepper, const strut_contact_entry *contact,
                       int32_t i) {
  if (contact->dissipation > 0.0) return false;
  return stepper->modes.of[i] == STRUT_MODE_SLIP ||
         (stepper->modes.of[i] == STRUT_MODE_SLIDE &&
          !strut_friction_is_continuous(contact->friction.law));
}

static void list_sliding_contacts(const strut_model *model, strut_event_stepper *stepper) {
  const strut_contact_modes *modes = &stepper->modes;
  stepper->active.all_sliding = stepper->active.decoupled;
  for (int32_t k = 0; k < stepper->active.closed_count && stepper->active.all_sliding; k++) {
    int32_t i = stepper->active.closed[k];
    const strut_contact_entry *contact = &stepper->contacts.entry[i];
    const strut_contact_compliance *compliance = &stepper->contacts.compliance[i];
    bool slips = modes->of[i] == STRUT_MODE_SLIP;
    stepper->active.all_sliding = is_sliding(stepper, contact, i);
    stepper->active.sliding[k] = (strut_sliding_contact){
        .at = model->contacts.at[i],
        .index = i,
        .nodes = compliance->count,
        .stiffness = contact->stiffness,
        .damping = contact->damping,
        .answer = compliance->normal,
        .friction =
            slips ? -modes->side[i] * strut_friction_kinetic(&contact->friction, modes->side[i])
                  : 0.0,
        .side = slips ? modes->side[i] : 0.0,
        .edge = slips ? stick_band_edge(contact) : 0.0,
        .place = compliance->at,
        .xy = compliance->xy};
  }
}

void strut_update_active_set(const strut_model *model, strut_event_stepper *stepper) {
  const strut_contact_bodies *contacts = &stepper->contacts;
  strut_active_set *active = &stepper->active;
  active->closed_count = active->stuck_count = 0;
  active->decoupled = /* where axes and compliances of contacts stay */
      model->contacts.normal[0] == 0.0 && !model->contacts.surface && !has_moving_masses(model);
  int32_t count = model->contacts.count;
  for (int32_t i = 0; i < count; i++) contacts->body_seen[contacts->body[i]] = false;
  for (int32_t i = 0; i < count; i++) {
    stepper->modes.outward[i] = stepper->modes.of[i] == STRUT_MODE_OPEN ? 1.0 : -1.0;
    if (stepper->modes.of[i] == STRUT_MODE_OPEN) continue;
    if (contacts->body_seen[contacts->body[i]]) active->decoupled = false;
    contacts->body_seen[contacts->body[i]] = true;
    active->closed[active->closed_count++] = i;
    if (stepper->modes.of[i] == STRUT_MODE_STICK || stepper->modes.of[i] == STRUT_MODE_CREEP)
      if (contacts->compliance[i].tangent > 0.0) active->stuck[active->stuck_count++] = i;
  }
  list_sliding_contacts(model, stepper);
  if (active->stuck_count > active->stuck_room)
    active->stuck_count = -active->stuck_count;
  else if (active->stuck_count > 1 && !model->contacts.surface && !has_moving_masses(model))
    factor_stuck(model, stepper, NULL);
}

/* Rate of the sliding speed of a contact under the accelerations x. */
STRUT_INLINE double along(const strut_contact_table *contacts, int32_t i, const double *vector,
                          const strut_contact_frame *frame) {
  const double *t = strut_axes_of_contact(contacts, frame, i)->tangent;
  double rate = vector[contacts->at[i]] * t[0] + vector[contacts->at[i] + 1] * t[1];
  return frame ? rate + frame[i].slip_drift : rate;
}

/* What rounding leaves of the accelerations of held nodes: nothing, so that they do not creep. */
STRUT_INLINE void still(const strut_contact_table *contacts, int32_t i, double *acceleration,
                        const strut_contact_frame *frame) {
  const double *t = strut_axes_of_contact(contacts, frame, i)->tangent;
  double rest = along(contacts, i, acceleration, frame);
  acceleration[contacts->at[i]] -= rest * t[0];
  acceleration[contacts->at[i] + 1] -= rest * t[1];
}

STRUT_INLINE double tangent_compliance(const strut_event_stepper *stepper, int32_t i,
                                       const strut_contact_frame *frame) {
  if (!frame) return stepper->contacts.compliance[i].tangent;
  return strut_compliance_along(&stepper->contacts.compliance[i], frame[i].axes.tangent);
}

/* One after the other until none needs more: for sets too large for a matrix. */
static void hold_by_sweeps(const strut_model *model, const strut_event_stepper *stepper,
                           double *acceleration, strut_step_end *end) {
  const strut_active_set *active = &stepper->active;
  const strut_contact_table *contacts = &model->contacts;
  int32_t n = active->stuck_count < 0 ? -active->stuck_count : active->stuck_count;
  for (int sweep = 0; sweep < 200; sweep++) {
    double largest = 0.0, changed = 0.0;
    for (int32_t k = 0; k < n; k++) {
      int32_t i = active->stuck[k];
      double more = -along(contacts, i, acceleration, end->frame) /
                    tangent_compliance(stepper, i, end->frame);
      strut_apply_contact_impulse(&stepper->contacts.compliance[i],
                                  strut_axes_of_contact(contacts, end->frame, i), 0.0, more,
                                  acceleration);
      end->touch[i].friction += more;
      changed = fmax(changed, fabs(more));
      largest = fmax(largest, fabs(end->touch[i].friction));
    }
    if (changed <= 1e-15 * largest) break;
  }
}

STRUT_INLINE void hold_stuck(const strut_model *model, strut_event_stepper *stepper,
                             double *acceleration, strut_step_end *end, unsigned terms) {
  const strut_contact_frame *frame = frames_of(end, terms);
  const strut_contact_table *contacts = &model->contacts;
  int32_t n = stepper->active.stuck_count;
  double *x = stepper->active.work;
  if ((frame || has_moving_masses(model)) &&
      n > 1) { /* their axes turn, or have not been known until now */
    factor_stuck(model, stepper, frame);
    bool singular = stepper->active.stuck_count < 0;
    stepper->active.stuck_count = n;
    if (singular) {
      hold_by_sweeps(model, stepper, acceleration, end);
      return;
    }
  }
  if (n < 0) {
    hold_by_sweeps(model, stepper, acceleration, end);
    return;
  }
  for (int32_t k = 0; k < n; k++)
    x[k] = -along(contacts, stepper->active.stuck[k], acceleration, frame);
  if (n == 1) {
    x[0] /= tangent_compliance(stepper, stepper->active.stuck[0], frame);
  } else {
    strut_cholesky_solve(n, stepper->active.factor, x);
  }
  for (int32_t k = 0; k < n; k++) {
    int32_t i = stepper->active.stuck[k];
    push(&stepper->contacts.compliance[i], strut_axes_of_contact(contacts, frame, i), 0.0, x[k],
         acceleration);
    end->touch[i].friction += x[k];
    still(contacts, i, acceleration, frame);
  }
  for (int32_t k = 0; k < n; k++) still(contacts, stepper->active.stuck[k], acceleration, frame);
}

void strut_solve_stick_constraints(const strut_model *model, strut_event_stepper *stepper,
                                   double *acceleration, strut_step_end *end) {
  if (model->contacts.surface)
    hold_stuck(model, stepper, acceleration, end, STRUT_TERMS_ALL);
  else
    hold_stuck(model, stepper, acceleration, end, STRUT_TERMS_COMMON);
}
