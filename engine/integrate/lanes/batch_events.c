/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Lanes of methods that locate events. While nothing happens in a lane it is in step with the others:
 * the structure is all lanes' at once, the ground and the modes are each lane's own. Where something
 * does, the lane's state takes over, with the single run's code, and joins again afterwards.
 */
#include <math.h>

#include "engine/integrate/events/implicit_ground.h"
#include "engine/integrate/lanes/batch.h"

static void get_column(const double *table, int32_t rows, int32_t width, int32_t lane, double *to) {
  for (int32_t i = 0; i < rows; i++) to[i] = table[i * width + lane];
}

static void put_column(double *table, int32_t rows, int32_t width, int32_t lane,
                       const double *from) {
  for (int32_t i = 0; i < rows; i++) table[i * width + lane] = from[i];
}

static bool create_end(strut_batch *b, strut_batch_end *end) {
  size_t width = (size_t)b->tables.width, both = (size_t)b->tables.first->length * width;
  double **const arrays[] = {&end->q, &end->v, &end->a, &end->structure};
  double **const powers[] = {&end->power, &end->structure_power};
  bool good = true;
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0] && good; i++)
    good = (*arrays[i] = strut_arena_allocate(&b->arena, both, sizeof(double))) != NULL;
  for (size_t i = 0; i < sizeof powers / sizeof powers[0] && good; i++)
    good = (*powers[i] =
                strut_arena_allocate(&b->arena, STRUT_LANE_POWERS * width, sizeof(double))) != NULL;
  return good;
}

bool strut_batch_events_create(strut_batch *b) {
  const strut_model *m = b->tables.first;
  size_t width = (size_t)b->tables.width;
  strut_batch_events *e = strut_arena_allocate(&b->arena, 1, sizeof *e);
  if (!e) return false;
  b->events = e;
  e->now = &e->end[0], e->next = &e->end[1];
  e->predicted = strut_arena_allocate(&b->arena, (size_t)m->length * width, sizeof(double));
  e->outward = strut_arena_allocate(&b->arena, (size_t)m->contacts.count * width, sizeof(double));
  double **const rows[] = {&e->time, &e->h, &e->crossed};
  double **const laws[] = {&e->stretch, &e->stretch_rate, &e->tension};
  bool good = e->predicted && e->outward && create_end(b, e->now) && create_end(b, e->next);
  for (size_t i = 0, most = strut_most_law_switches(m) * width; i < 3 && good; i++)
    good = (*laws[i] = strut_arena_allocate(&b->arena, most, sizeof(double))) != NULL;
  for (size_t i = 0; i < sizeof rows / sizeof rows[0] && good; i++)
    good = (*rows[i] = strut_arena_allocate(&b->arena, width, sizeof(double))) != NULL;
  return good;
}

/* Can the lane go in step with others as its modes are now? */
static bool can_join(const strut_event_stepper *l) {
  return l->at_once == 0 && !(l->next_break < HUGE_VAL) &&
         (!l->closed_count || l->contacts_decoupled);
}

/* Which laws act in a lane that joins. */
static void put_modes(strut_batch *b, int32_t lane) {
  strut_lane_tables *t = &b->tables;
  const strut_state *state = b->events->state[lane];
  if (!b->events->law_count && !t->first->elements.count) return;
  put_column(t->slack_length_threshold, t->first->members.count, t->width, lane,
             state->slack_length_threshold);
  put_column(t->slack_force_threshold, t->first->members.count, t->width, lane,
             state->slack_force_threshold);
  strut_lane_tables_put_elements(t, lane, state);
}

static void join(strut_batch *b, int32_t lane) {
  strut_batch_events *e = b->events;
  const strut_event_stepper *l = e->stepper[lane];
  const strut_step_end *now = l->now;
  int32_t width = b->tables.width, rows = 2 * b->tables.first->node_count;
  put_column(e->now->q, rows, width, lane, now->q);
  put_column(e->now->v, rows, width, lane, now->v);
  put_column(e->now->a, rows, width, lane, now->a);
  put_column(e->now->structure, rows, width, lane, now->structure);
  put_column(e->now->power, STRUT_LANE_POWERS, width, lane, now->power);
  put_column(e->now->structure_power, STRUT_LANE_POWERS, width, lane, now->structure_power);
  put_column(e->outward, b->tables.first->contacts.count, width, lane, l->outward);
  put_modes(b, lane);
  e->joined[lane] = true;
}

/* The lane's state and workspace as the single run would have them. */
static void fetch(const strut_batch *b, int32_t lane) {
  const strut_batch_events *e = b->events;
  const strut_lane_tables *t = &b->tables;
  strut_state *state = e->state[lane];
  strut_step_end *now = e->stepper[lane]->now;
  int32_t width = t->width, rows = 2 * t->first->node_count;
  get_column(e->now->q, rows, width, lane, now->q);
  get_column(e->now->v, rows, width, lane, now->v);
  get_column(e->now->a, rows, width, lane, now->a);
  get_column(e->now->structure, rows, width, lane, now->structure);
  get_column(e->now->structure, rows, width, lane, state->force);
  get_column(t->rest, t->first->members.slots, width, lane, state->rest);
  get_column(t->rest_rate, t->first->members.slots, width, lane, state->rest_rate);
  strut_lane_tables_get_elements(t, lane, state);
  state->drive_time = (double)NAN; /* what they are for may be the step that is due */
  if (!b->ledger) return;
  get_column(e->now->power, STRUT_LANE_POWERS, width, lane, now->power);
  get_column(e->now->power, STRUT_LANE_POWERS, width, lane, state->power);
  get_column(e->now->structure_power, STRUT_LANE_POWERS, width, lane, now->structure_power);
}

void strut_batch_events_put(strut_batch *b, int32_t lane, strut_state *state, void *workspace) {
  strut_batch_events *e = b->events;
  e->state[lane] = state;
  e->stepper[lane] = workspace;
  e->laws = e->stepper[lane]->laws;
  e->law_count = e->stepper[lane]->law_count;
  e->joined[lane] = e->jumped[lane] = false;
  if (!e->stepper[lane]->started)
    strut_event_stepper_restart(b->tables.model[lane], state, workspace, b->dt[lane]);
}

void strut_batch_events_sample(const strut_batch *b, int32_t lane) {
  const strut_batch_events *e = b->events;
  int32_t width = b->tables.width, rows = 2 * b->tables.first->node_count;
  if (!e->joined[lane]) return;
  get_column(e->now->q, rows, width, lane, e->state[lane]->q);
  get_column(e->now->v, rows, width, lane, e->state[lane]->v);
}

void strut_batch_events_get(strut_batch *b, int32_t lane) {
  strut_batch_events *e = b->events;
  if (e->joined[lane]) fetch(b, lane);
  strut_event_stepper_advance(b->tables.model[lane], e->state[lane], e->stepper[lane], b->dt[lane],
                              0);
}

/* ---- the ground of one lane; see implicit_ground.h ---- */

/* A lane's columns at the end of the step that is being tried. */
typedef struct column {
  const strut_model *model;
  strut_event_stepper *l;
  double h;
  size_t width;
  const double *q, *predicted, *force, *v;
  double *a, *power;
} column;

static column column_of(const strut_batch *b, int32_t lane) {
  const strut_batch_events *e = b->events;
  const strut_batch_end *next = e->next;
  return (column){.model = b->tables.model[lane],
                  .l = e->stepper[lane],
                  .h = e->h[lane],
                  .width = (size_t)b->tables.width,
                  .q = next->q + lane,
                  .predicted = e->predicted + lane,
                  .force = next->structure + lane,
                  .v = next->v + lane,
                  .a = next->a + lane,
                  .power = next->power + lane};
}

static void answer(const column *c, int32_t nodes, const uint32_t *place, const double *xy,
                   double x, double y) {
  for (int32_t j = 0; j < nodes; j++) {
    double *node = c->a + place[j] * c->width;
    node[0] += xy[2 * j] * x;
    node[c->width] += xy[2 * j + 1] * y;
  }
}

static void slide(const column *c) {
  const strut_event_stepper *l = c->l;
  const double h = c->h, height = c->model->contacts.height;
  for (const strut_sliding_contact *s = l->sliding, *end = s + l->closed_count; s < end; s++) {
    const strut_touch *b = &l->now->touch[s->index];
    strut_touch *o = &l->next->touch[s->index];
    size_t up = (s->at + 1) * c->width;
    double gap = c->q[up] - height, spring = -s->stiffness * gap, half = 0.5 * h * s->answer;
    double free = b->into + 0.5 * h * (b->into_rate + c->a[up]) + half * spring;
    double into = free / (1.0 + half * s->damping);
    double normal = spring + (into > 0.0 ? 0.0 : -s->damping * into);
    o->gap = gap;
    o->normal = normal;
    o->friction = s->friction * normal;
    answer(c, s->nodes, s->place, s->xy, o->friction, normal);
  }
}

static void touch(const column *c) {
  const strut_contact_table *t = &c->model->contacts;
  const strut_event_stepper *l = c->l;
  for (int32_t k = 0; k < l->closed_count; k++) {
    int32_t i = l->closed[k];
    uint8_t mode = l->mode[i];
    size_t x = t->at[i] * c->width, y = x + c->width;
    const strut_contact_compliance *r = &l->response[i];
    strut_touch *o = &l->next->touch[i];
    o->gap = c->q[y] - t->height;
    o->slip = c->predicted[x] - t->belt_speed;
    o->applied = c->force[x];
    implicit_ground_touch(&t->entry[i], r, &l->now->touch[i], o, mode, l->side[i], c->h, c->a[x],
                          c->a[y]);
    answer(c, r->count, r->at, r->xy, o->friction, o->normal);
    if (mode == STRUT_MODE_STICK || mode == STRUT_MODE_CREEP) c->a[x] = 0.0; /* but for rounding */
  }
}

static void leave_ground(const column *c, bool ledger) {
  const strut_contact_table *t = &c->model->contacts;
  double contact = 0.0, friction = 0.0, belt = 0.0, exchanged = 0.0;
  for (int32_t k = 0; k < c->l->closed_count; k++) {
    int32_t i = c->l->closed[k];
    size_t x = t->at[i] * c->width, y = x + c->width;
    strut_touch *o = &c->l->next->touch[i];
    o->into = c->v[y];
    o->slip = c->v[x] - t->belt_speed;
    o->into_rate = c->a[y];
    o->slip_rate = c->a[x];
    if (!ledger) continue;
    double damped = -(o->normal + t->entry[i].stiffness * o->gap) * o->into;
    double rubbed = -o->friction * o->slip, carried = o->friction * t->belt_speed;
    contact += damped, friction += rubbed, belt += carried;
    exchanged += fabs(damped) + fabs(rubbed) + fabs(carried);
  }
  if (!ledger || !c->l->closed_count) return;
  c->power[STRUT_POWER_BELT * c->width] += belt;
  c->power[STRUT_POWER_CONTACT * c->width] += contact;
  c->power[STRUT_POWER_FRICTION * c->width] += friction;
  c->power[STRUT_POWER_EXCHANGED * c->width] += exchanged;
}

/* Do strains and forces at the end of the step contradict which laws act? See strut_event_first. */
static bool laws_switch(const strut_batch *b, int32_t lane) {
  const strut_batch_events *e = b->events;
  const strut_event_stepper *l = e->stepper[lane];
  int32_t width = b->tables.width;
  get_column(e->stretch, e->law_count, width, lane, l->next->stretch);
  get_column(e->stretch_rate, e->law_count, width, lane, l->next->stretch_rate);
  get_column(e->tension, e->law_count, width, lane, l->next->tension);
  for (int32_t k = 0; k < e->law_count; k++) {
    if (strut_event_value(b->tables.model[lane], l, l->next, e->laws[k].event, k) < 0.0)
      return true;
  }
  return false;
}

static void stop_where_laws_switch(strut_batch *b, bool *goes) {
  b->events->kernels->measure(b);
  for (int32_t l = 0; l < b->tables.width; l++) goes[l] = goes[l] && !laws_switch(b, l);
}

/* Does the end of the step contradict a mode of a contact? */
static bool contradicts(const column *c) {
  const strut_event_stepper *l = c->l;
  if (l->all_sliding) {
    for (const strut_sliding_contact *s = l->sliding, *end = s + l->closed_count; s < end; s++)
      if (s->side * l->next->touch[s->index].slip < s->edge) return true;
    return false;
  }
  for (int32_t k = 0; k < l->closed_count; k++) {
    int32_t i = l->closed[k];
    if (contradicting_event(&c->model->contacts.entry[i], &l->next->touch[i], l->mode[i],
                            l->side[i]))
      return true;
  }
  return false;
}

/* ---- steps ---- */

static void add_works(const strut_batch *b, int32_t lane) {
  const strut_batch_events *e = b->events;
  size_t width = (size_t)b->tables.width;
  double *work = e->state[lane]->work, half = 0.5 * e->h[lane];
  for (size_t p = 0; p < STRUT_LANE_POWERS; p++) {
    size_t at = p * width + (size_t)lane;
    work[p] += half * (e->now->power[at] + e->next->power[at]);
  }
}

static void swap(double **a, double **b) {
  double *kept = *a;
  *a = *b, *b = kept;
}

/* In lanes that have taken the step, what is known of the laws at next is that of now from here on. */
static void swap_laws(const strut_batch *b, const bool *goes) {
  for (int32_t lane = 0; lane < b->tables.width; lane++) {
    strut_event_stepper *l = b->events->stepper[lane];
    if (!goes[lane]) continue;
    swap(&l->now->stretch, &l->next->stretch);
    swap(&l->now->stretch_rate, &l->next->stretch_rate);
    swap(&l->now->tension, &l->next->tension);
  }
}

/* The step has been taken, as accept_step has it. */
static void accept(const strut_batch *b, int32_t lane) {
  strut_event_stepper *l = b->events->stepper[lane];
  strut_state *state = b->events->state[lane];
  strut_touch *touches = l->now->touch;
  l->now->touch = l->next->touch;
  l->next->touch = touches;
  l->fresh = true;
  state->evaluations++;
  if (b->ledger) add_works(b, lane);
  advance_within_grid(state, l, b->events->h[lane], b->dt[lane]);
}

/* Tries a step in all lanes that are in step with each other. */
static void step_together(strut_batch *b) {
  strut_batch_events *e = b->events;
  bool goes[STRUT_MOST_LANES] = {false};
  e->kernels->predict(b);
  for (int32_t l = 0; l < b->tables.width; l++) {
    if (!e->joined[l]) continue;
    goes[l] = e->crossed[l] == 0.0;
    column c = column_of(b, l);
    if (goes[l] && c.l->all_sliding)
      slide(&c);
    else if (goes[l])
      touch(&c);
  }
  e->kernels->correct(b);
  if (e->law_count) stop_where_laws_switch(b, goes);
  for (int32_t l = 0; l < b->tables.width; l++) {
    if (goes[l]) {
      column c = column_of(b, l);
      leave_ground(&c, b->ledger);
      if (!c.l->all_sliding) settle_band_ties(c.model, c.l);
      goes[l] = !contradicts(&c);
    }
    if (goes[l]) {
      accept(b, l);
    } else if (e->joined[l]) {
      fetch(b, l);
      e->joined[l] = false;
      e->jumped[l] = true;
    }
  }
  if (e->law_count) swap_laws(b, goes);
  strut_batch_end *now = e->now;
  e->now = e->next;
  e->next = now;
}

/* On its own through what happens, or, where contacts answer to each other, to the next grid point. */
static void step_alone(strut_batch *b, int32_t lane, int64_t end) {
  strut_batch_events *e = b->events;
  const strut_model *model = b->tables.model[lane];
  strut_state *state = e->state[lane];
  strut_event_stepper *l = e->stepper[lane];
  while (e->jumped[lane] && state->step < end) {
    strut_event_stepper_step(model, state, l, b->dt[lane]);
    e->jumped[lane] = l->at_once > 0;
  }
  if (state->step == end) return;
  if (can_join(l))
    join(b, lane);
  else
    strut_event_stepper_advance(model, state, l, b->dt[lane], 1);
}

void strut_batch_events_advance(strut_batch *b, const int64_t *left) {
  strut_batch_events *e = b->events;
  int64_t end[STRUT_MOST_LANES];
  int32_t width = b->tables.width;
  bool done = false;
  for (int32_t l = 0; l < width; l++) {
    if (b->filled[l]) {
      int64_t step = e->state[l]->step;
      end[l] = left[l] < INT64_MAX - step ? step + left[l] : INT64_MAX;
    }
    if (!b->filled[l]) e->joined[l] = false;
  }
  while (!done) {
    bool any = false;
    for (int32_t l = 0; l < width; l++) {
      strut_state *state = e->state[l];
      e->h[l] = 0.0;
      if (!b->filled[l]) continue;
      if (!e->joined[l]) step_alone(b, l, end[l]);
      if (state->trouble || state->step >= end[l]) done = true;
      if (!e->joined[l]) continue;
      any = true;
      e->time[l] = (double)state->step * b->dt[l] + e->stepper[l]->done;
      e->h[l] = next_step_size(state, e->stepper[l], b->dt[l]);
    }
    if (done || !any) continue;
    step_together(b);
    for (int32_t l = 0; l < width; l++)
      if (b->filled[l] && e->state[l]->step >= end[l]) done = true;
  }
}
