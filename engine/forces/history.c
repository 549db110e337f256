/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/history.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/forces/capstan.h"
#include "engine/forces/drives/drives.h"
#include "engine/model/pose.h"

/* An element's e0 as its member or hinge has it, before anything has yielded. */
static double base_of(const strut_element *element, const double *rest) {
  return element->base >= 0 ? rest[element->base] : element->natural;
}

static double base_rate_of(const strut_element *element, const strut_state *state) {
  return element->base >= 0 ? state->latest->rest_rate[element->base] : 0.0;
}

static bool yields(const strut_element *element) {
  return element->law == STRUT_LAW_ELASTIC_PLASTIC;
}

static double shift_of(const strut_element *element, double plastic) {
  return strut_slider_share(element) * plastic;
}

/* The slip at which the slider at x is at its yield, on the side of `sign`. */
static double plastic_at(const strut_element *element, double x, double sign) {
  return x - sign * strut_slider_yield(element) / strut_slider_spring(element);
}

/* Which way the slider gives way at x: by its mode, or by its force; 0: it holds. */
static int direction_at(const strut_state *state, const strut_element *element, int32_t i,
                        double x) {
  int piece = state->modes.element_piece[i];
  if (state->forgetful) return 0;
  if (piece >= 0) return piece - STRUT_SLIDER_HOLDS;
  double p = state->history.plastic[element->memory],
         force = strut_slider_spring(element) * (x - p);
  if (element->carries && !(element->carries * (x - shift_of(element, p)) > 0.0)) return 0;
  return fabs(force) > strut_slider_yield(element) ? (force > 0.0 ? 1 : -1) : 0;
}

double strut_history_natural(const strut_model *model, const strut_state *state, int32_t i,
                             double strain) {
  assert(i >= 0 && i < model->elements.count);
  const strut_element *element = &model->elements.element[i];
  double base = base_of(element, state->latest->rest);
  if (strut_element_is_gone(state->latest->rest[element->slot]))
    return state->latest->rest[element->slot];
  if (!yields(element)) return base;
  int direction = direction_at(state, element, i, strain - base);
  double plastic = direction ? plastic_at(element, strain - base, direction)
                             : state->history.plastic[element->memory];
  return base + shift_of(element, plastic);
}

double strut_history_locked_energy(const strut_element *element, const double *rest) {
  double shift = rest[element->slot] - base_of(element, rest),
         beside = element->numbers.second_stiffness;
  if (!yields(element) || beside == 0.0) return 0.0;
  return 0.5 * shift * shift * element->numbers.stiffness * beside / strut_slider_spring(element);
}

strut_slider strut_slider_at(const strut_model *model, const strut_state *state, int32_t i,
                             const double *q, const double *velocity) {
  assert(i >= 0 && i < model->elements.count);
  const strut_element *element = &model->elements.element[i];
  const uint32_t *at = model->elements.at + element->first;
  double b[STRUT_MOST_GRADIENT], rate = -base_rate_of(element, state);
  double x = strut_element_strain(model, i, q, state->history.turn[i], b) -
             base_of(element, state->latest->rest);
  for (int32_t k = 0; k < element->nodes; k++)
    rate += b[2 * k] * velocity[at[k]] + b[2 * k + 1] * velocity[at[k] + 1];
  double p = state->history.plastic[element->memory],
         force = strut_slider_spring(element) * (x - p);
  return (strut_slider){
      .force = force,
      .yield = strut_slider_yield(element),
      .rate = rate,
      .plastic = plastic_at(element, x, force < 0.0 ? -1.0 : 1.0),
      .acts = !element->carries || element->carries * (x - shift_of(element, p)) > 0.0};
}

void strut_slider_set(const strut_model *model, strut_state *state, int32_t i, int mode,
                      const double *q) {
  assert(i >= 0 && i < model->elements.count);
  const strut_element *element = &model->elements.element[i];
  double b[STRUT_MOST_GRADIENT];
  int before = state->modes.element_piece[i];
  if (before >= 0 && before != STRUT_SLIDER_HOLDS) {
    double strain = strut_element_strain(model, i, q, state->history.turn[i], b);
    double x = strain - base_of(element, state->latest->rest);
    state->history.plastic[element->memory] = plastic_at(element, x, before - STRUT_SLIDER_HOLDS);
  }
  state->modes.element_piece[i] = (int16_t)mode;
}

static void accumulate_loss(strut_state *state, double energy) {
  if (!state->balance) return;
  strut_power_add(state->work, STRUT_POWER_MEMBERS, energy);
}

void strut_slider_return(const strut_model *model, strut_state *state, int32_t i, const double *q,
                         bool jumped) {
  assert(i >= 0 && i < model->elements.count);
  const strut_element *element = &model->elements.element[i];
  strut_slider s = strut_slider_at(model, state, i, q, state->v);
  if (!s.acts || !(fabs(s.force) > s.yield)) return;
  double *p = &state->history.plastic[element->memory], slip = fabs(s.plastic - *p);
  accumulate_loss(state, slip * (jumped ? 0.5 * (fabs(s.force) + s.yield) : s.yield));
  *p = s.plastic;
  state->latest->rest[element->slot] =
      base_of(element, state->latest->rest) + shift_of(element, *p);
}

/* Notes that element i has jumped over folds at time t, and loses the energy that this set free. */
static void note_jump(strut_state *state, const strut_element *element, double freed, double t) {
  double *own = &state->latest->rest[element->slot];
  if (isnan(t)) return; /* on the way to the start */
  own[STRUT_CURVE_JUMPS] += 1.0;
  own[STRUT_CURVE_LAST] = t + state->time_offset;
  own[STRUT_CURVE_FREED] += freed;
  accumulate_loss(state, freed);
}

void strut_curve_renew(const strut_model *model, strut_state *state, int32_t i, const double *q,
                       double t) {
  assert(i >= 0 && i < model->elements.count);
  const strut_element *element = &model->elements.element[i];
  double b[STRUT_MOST_GRADIENT], freed = 0.0;
  double *piece = &state->latest->rest[element->slot + STRUT_CURVE_PIECE];
  double strain = strut_element_strain(model, i, q, state->history.turn[i], b);
  double x = strain - base_of(element, state->latest->rest);
  *piece = strut_folding_follow(element->numbers.curve, (int)*piece, x, &freed);
  if (freed != 0.0) note_jump(state, element, freed, t);
}

int strut_curve_pass(const strut_model *model, strut_state *state, int32_t i, strut_crossing at) {
  assert(i >= 0 && i < model->elements.count);
  const strut_element *element = &model->elements.element[i];
  const strut_law_curve *curve = element->numbers.curve;
  int from = state->modes.element_piece[i], to = strut_folding_pass(curve, from, at.way, at.x);
  double freed = strut_law_curve_piece(curve, (size_t)from, at.x).energy -
                 strut_law_curve_piece(curve, (size_t)to, at.x).energy;
  if (to != from + at.way) note_jump(state, element, freed, at.time);
  state->latest->rest[element->slot + STRUT_CURVE_PIECE] = to;
  return to;
}

/* What an element with its damper does: how its sign is frozen or follows is as with all elements. */
static bool element_acts(const strut_element *element, const strut_state *state, int32_t i,
                         double x, double force) {
  int8_t mode = state->modes.element_acts[i];
  if (!element->carries) return true;
  return mode ? mode > 0 : element->carries * x > 0.0 && element->carries * force > 0.0;
}

/*
 * Powers of an element. The part of its force that energy follows is all of the law's, or, while a slider
 * gives way, that of the spring beside it; the rest is lost. Without modes that loss is found when p is
 * renewed.
 */
static void add_powers(const strut_element *element, const strut_state *state, int32_t i,
                       double force, double elastic, double x, double rate) {
  int piece = state->modes.element_piece[i];
  double drive = -force * base_rate_of(element, state), lost = force - elastic;
  if (yields(element) && piece >= 0 && piece != STRUT_SLIDER_HOLDS && !state->forgetful)
    lost = force - element->numbers.second_stiffness * x;
  lost *= rate;
  strut_power_add_two(state->latest->power, STRUT_POWER_DRIVE, drive, STRUT_POWER_MEMBERS, lost);
}

static void add_element(const strut_model *model, const strut_state *state, int32_t i,
                        const double *q, const double *velocity, double *force) {
  assert(i >= 0 && i < model->elements.count);
  const strut_element *element = &model->elements.element[i];
  const uint32_t *at = model->elements.at + element->first;
  double b[STRUT_MOST_GRADIENT], rate = 0.0;
  if (strut_capstan_remembers(element, state->latest->rest) &&
      !strut_element_is_gone(state->latest->rest[element->slot])) {
    strut_capstan_add_forces(model, state, i, q, velocity, force);
    return;
  }
  double strain = strut_element_strain(model, i, q, state->history.turn[i], b);
  double natural = strut_history_natural(model, state, i, strain), x = strain - natural;
  if (strut_element_is_gone(natural)) return;
  state->latest->rest[element->slot] = natural;
  for (int32_t k = 0; k < element->nodes; k++)
    rate += b[2 * k] * velocity[at[k]] + b[2 * k + 1] * velocity[at[k] + 1];
  rate -= base_rate_of(element,
                       state); /* last, as of other elements: with their bits before it breaks */
  int piece = state->modes.element_piece[i];
  if (piece < 0) piece = strut_element_piece(element, state->latest->rest, x);
  strut_law_response r = strut_law_respond(element->law, &element->numbers, strain, natural, piece);
  double whole = r.force + element->damping * rate;
  if (!element_acts(element, state, i, x, whole)) {
    /* a damper may outweigh the spring: that relaxes then, and the damper takes its energy */
    double relaxing = element->carries * x > 0.0 ? r.force : 0.0;
    if (state->balance) add_powers(element, state, i, 0.0, relaxing, x, rate);
    return;
  }
  for (int32_t k = 0; k < element->nodes; k++) {
    force[at[k]] -= whole * b[2 * k];
    force[at[k] + 1] -= whole * b[2 * k + 1];
  }
  if (!state->balance) return;
  add_powers(element, state, i, whole, r.force, strain - base_of(element, state->latest->rest),
             rate);
  double excess = r.excess * base_rate_of(element, state);
  strut_power_add(state->latest->power, STRUT_POWER_DRIVE, excess);
}

void strut_history_add_forces(const strut_model *model, const strut_state *state,
                              const strut_element_block *block, const double *q,
                              const double *velocity, double *force) {
  for (int32_t i = block->begin; i < block->end; i++)
    add_element(model, state, i, q, velocity, force);
}

void strut_history_follow(const strut_model *model, const strut_state *state) {
  for (int32_t m = 0; m < model->elements.history_count; m++) {
    const strut_element *element = &model->elements.element[model->elements.memory[m]];
    double *own = &state->latest->rest[element->slot];
    if (strut_element_is_gone(*own)) continue;
    *own = base_of(element, state->latest->rest) +
           (yields(element) ? shift_of(element, state->history.plastic[m]) : 0.0);
    state->latest->rest_rate[element->slot] = base_rate_of(element, state);
  }
}

void strut_history_keep(const strut_model *model, strut_state *state) {
  for (int32_t m = 0; m < model->elements.history_count; m++) {
    int32_t i = model->elements.memory[m];
    const strut_element *element = &model->elements.element[i];
    double b[STRUT_MOST_GRADIENT], base = base_of(element, state->latest->rest);
    int direction = direction_at(state, element, i, 0.0);
    if (strut_element_is_gone(state->latest->rest[element->slot])) continue;
    if (strut_capstan_remembers(element, state->latest->rest))
      strut_capstan_keep(model, state, i, state->q);
    if (!yields(element) || state->modes.element_piece[i] < 0) continue;
    if (direction) {
      double strain = strut_element_strain(model, i, state->q, state->history.turn[i], b);
      state->history.plastic[m] = plastic_at(element, strain - base, direction);
    }
    state->latest->rest[element->slot] = base + shift_of(element, state->history.plastic[m]);
  }
}

void strut_history_store(const strut_model *model, const strut_state *state, double *memory) {
  const strut_element_table *elements = &model->elements;
  size_t slots = (size_t)elements->history_slots, count = (size_t)elements->history_count;
  memcpy(memory, state->latest->rest + elements->history_slot, slots * sizeof(double));
  memcpy(memory += slots, state->history.material, slots * sizeof(double));
  memcpy(memory + slots, state->history.plastic, count * sizeof(double));
  memcpy(memory + slots + count, state->history.broken_at,
         (size_t)elements->breakable_count * sizeof(double));
}

void strut_history_load(const strut_model *model, strut_state *state, const double *memory) {
  const strut_element_table *elements = &model->elements;
  size_t slots = (size_t)elements->history_slots, count = (size_t)elements->history_count;
  memcpy(state->latest->rest + elements->history_slot, memory, slots * sizeof(double));
  memcpy(state->history.material, memory += slots, slots * sizeof(double));
  memcpy(state->history.plastic, memory + slots, count * sizeof(double));
  memcpy(state->history.broken_at, memory + slots + count,
         (size_t)elements->breakable_count * sizeof(double));
  strut_history_follow(model, state);
}

void strut_history_place(const strut_model *model, strut_state *state, const double *memory,
                         double t, bool frozen) {
  const strut_element_table *table = &model->elements;
  strut_history_load(model, state, memory);
  if (frozen) strut_history_keep(model, state);
  if (frozen || state->forgetful) return;
  strut_drive_apply(model, state, t);
  for (int32_t m = 0; m < table->history_count; m++) {
    int32_t i = table->memory[m];
    const strut_element *element = &table->element[i];
    if (strut_element_is_gone(state->latest->rest[element->slot])) continue;
    if (strut_capstan_remembers(element, state->latest->rest))
      strut_capstan_place(model, state, i, state->q);
    if (yields(element)) strut_slider_return(model, state, i, state->q, false);
  }
}

/* ---- what breaks ---- */

double strut_breakable_load(const strut_model *model, const strut_state *state, int32_t breakable,
                            const double *q, const double *velocity) {
  assert(breakable >= 0 && breakable < model->elements.breakable_count);
  const strut_element_table *elements = &model->elements;
  const strut_breakable *b = &elements->breakable[breakable];
  double sum = 0.0;
  for (int32_t i = b->first; i >= 0; i = elements->element[i].sibling) {
    if (strut_capstan_remembers(&elements->element[i], state->latest->rest)) {
      sum += strut_capstan_tensions(model, state, i, q, velocity).most;
      continue;
    }
    strut_element_motion m = strut_element_move(model, state, i, q, velocity);
    if (element_acts(&elements->element[i], state, i, m.stretch, m.force)) sum += m.force;
  }
  return b->role == STRUT_ELEMENT_HINGE ? fabs(sum) : sum;
}

void strut_breakable_break(const strut_model *model, strut_state *state, int32_t breakable,
                           double t) {
  assert(breakable >= 0 && breakable < model->elements.breakable_count);
  const strut_element_table *table = &model->elements;
  strut_element_pose pose;
  double energy = 0.0;
  for (int32_t i = table->breakable[breakable].first; i >= 0; i = table->element[i].sibling) {
    strut_element_evaluate(model, i, state->latest->rest, state->q, state->history.turn[i], &pose);
    energy += pose.energy;
    state->latest->rest[table->element[i].slot] = STRUT_GONE;
    state->latest->rest_rate[table->element[i].slot] = 0.0;
  }
  accumulate_loss(state, energy);
  state->history.broken_at[breakable] = t;
}

bool strut_history_release(const strut_model *model, strut_state *state, double t) {
  bool released = false;
  for (int32_t i = 0; i < model->elements.breakable_count && !state->forgetful; i++) {
    double due = model->elements.breakable[i].time;
    if (state->history.broken_at[i] < HUGE_VAL || due > t) continue;
    strut_breakable_break(model, state, i, due);
    released = true;
  }
  return released;
}

/* A step that ends this close to a time, in parts of it, has reached it. */
static const double REACHED = 1e-12;

static bool renew(const strut_model *model, strut_state *state, double t, bool jumped) {
  const strut_element_table *table = &model->elements;
  double now = t + state->time_offset;
  bool broken = false;
  if (state->forgetful) return false;
  if (model->terms & STRUT_TERM_DRIVE && t != state->latest->drive_time)
    strut_drive_apply(model, state, t);
  for (int32_t m = 0; m < table->history_count; m++) {
    int32_t i = table->memory[m];
    if (strut_has_capstan(&table->element[i]) &&
        !strut_element_is_gone(state->latest->rest[table->element[i].slot])) {
      strut_capstan_begin(model, state, i, state->q);
      strut_capstan_renew(model, state, i, state->q, jumped);
    }
    if (strut_element_is_gone(state->latest->rest[table->element[i].slot])) continue;
    if (yields(&table->element[i])) strut_slider_return(model, state, i, state->q, jumped);
    if (table->element[i].law == STRUT_LAW_FOLDING)
      strut_curve_renew(model, state, i, state->q, jumped ? (double)NAN : t);
  }
  for (int32_t i = 0; i < table->breakable_count; i++)
    if (state->history.broken_at[i] == HUGE_VAL && table->breakable[i].force < HUGE_VAL &&
        strut_breakable_load(model, state, i, state->q, state->v) >= table->breakable[i].force) {
      strut_breakable_break(model, state, i, now);
      broken = true;
    }
  return strut_history_release(model, state, now + REACHED * fabs(now)) || broken;
}

bool strut_history_renew(const strut_model *model, strut_state *state, double t) {
  return renew(model, state, t, false);
}

void strut_history_begin(const strut_model *model, strut_state *state, double t) {
  bool balance = state->balance;
  state->balance = false;
  renew(model, state, t, true);
  state->balance = balance;
}

double strut_element_last_force(const strut_model *model, const strut_state *state, int32_t i) {
  assert(i >= 0 && i < model->elements.count);
  strut_element_pose pose;
  const strut_element *element = &model->elements.element[i];
  if (strut_capstan_remembers(element, state->latest->rest) &&
      !strut_element_is_gone(state->latest->rest[element->slot]))
    return strut_capstan_tensions(model, state, i, state->q, state->v).last;
  return strut_element_measure_at(model, state, i, state->q, state->v, &pose);
}

double strut_element_plastic(const strut_model *model, const strut_state *state, int32_t element) {
  assert(element >= 0 && element < model->elements.count);
  const strut_element *e = &model->elements.element[element];
  return e->remembers && yields(e) ? shift_of(e, state->history.plastic[e->memory]) : 0.0;
}

static void keep_worst(const strut_model *model, strut_element_role role, int32_t item, bool breaks,
                       double force, double limit, strut_overload *worst) {
  assert(item >= 0 && limit > 0.0);
  bool hinge = role == STRUT_ELEMENT_HINGE;
  if (!(force > limit) || (worst->name && force / limit <= worst->force / worst->limit)) return;
  *worst = (strut_overload){
      .kind = strut_thing_at(strut_element_thing(role))->word,
      .name = strut_thing_name(model->scene, strut_element_thing(role), (size_t)item),
      .hinge = hinge,
      .breaks = breaks,
      .force = force,
      .limit = limit};
}

bool strut_history_overload(const strut_model *model, const double *q, strut_overload *worst) {
  const strut_element_table *elements = &model->elements;
  strut_element_pose pose;
  *worst = (strut_overload){.name = NULL};
  for (int32_t m = 0; m < elements->history_count; m++) {
    const strut_element *element = &elements->element[elements->memory[m]];
    if (!yields(element)) continue;
    strut_element_evaluate(model, elements->memory[m], model->members.rest, q, (double)NAN, &pose);
    keep_worst(model, element->role, element->item, false, fabs(pose.force), element->numbers.yield,
               worst);
  }
  for (int32_t b = 0; b < elements->breakable_count; b++) {
    const strut_breakable *what = &elements->breakable[b];
    double sum = 0.0;
    for (int32_t i = what->first; i >= 0; i = elements->element[i].sibling) {
      strut_element_evaluate(model, i, model->members.rest, q, (double)NAN, &pose);
      sum += pose.force;
    }
    if (what->role == STRUT_ELEMENT_HINGE) sum = fabs(sum);
    keep_worst(model, what->role, what->item, true, sum, what->force, worst);
  }
  return worst->name;
}

void strut_maxwell_apply(const strut_model *model, const strut_state *state, const double *q,
                         const double *velocity, double *force) {
  const strut_feedback_table *feedback = &model->feedback;
  const strut_member_table *members = &model->members;
  for (int32_t i = 0; i < feedback->maxwell_count; i++) {
    const strut_maxwell_entry *entry = &feedback->maxwell[i];
    strut_member_pose pose = strut_member_pose_at(members, state->latest->rest, entry->member, q);
    double rest_rate = state->latest->rest_rate[entry->member],
           tension = velocity[feedback->base + entry->state];
    double rate = strut_member_rate(members, entry->member, &pose, velocity) - rest_rate;
    uint32_t a = members->from[entry->member], b = members->to[entry->member];
    force[a] += tension * pose.unit.x, force[a + 1] += tension * pose.unit.y;
    force[b] -= tension * pose.unit.x, force[b + 1] -= tension * pose.unit.y;
    force[feedback->base + entry->state] = entry->stiffness * (rate - tension / entry->damping);
    if (!state->balance) continue;
    double drive = -tension * rest_rate, lost = tension * tension / entry->damping;
    strut_power_add_two(state->latest->power, STRUT_POWER_DRIVE, drive, STRUT_POWER_MEMBERS, lost);
  }
}

double strut_maxwell_force(const strut_model *model, const double *velocity, int32_t member) {
  assert(member >= 0 && (size_t)member < model->scene->member_count);
  const strut_feedback_table *feedback = &model->feedback;
  for (int32_t i = 0; i < feedback->maxwell_count; i++)
    if (feedback->maxwell[i].member == member)
      return velocity[feedback->base + feedback->maxwell[i].state];
  return 0.0;
}

double strut_maxwell_energy(const strut_model *model, const double *velocity) {
  const strut_feedback_table *feedback = &model->feedback;
  double sum = 0.0;
  for (int32_t i = 0; i < feedback->maxwell_count; i++) {
    double tension = velocity[feedback->base + feedback->maxwell[i].state];
    sum += 0.5 * tension * tension / feedback->maxwell[i].stiffness;
  }
  return sum;
}
