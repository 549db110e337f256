/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/recording.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory_limit.h"
#include "engine/forces/energy.h"
#include "engine/forces/forces.h"
#include "engine/forces/support_motion.h"
#include "engine/run/measure/summary.h"

static const char *const xy[] = {"x", "y"};
static const char *const single[] = {""};
static const char *const reactions[] = {"normal", "friction"};
static const char *const energies[] = {STRUT_ENERGY_NAMES};
static const char *const total[] = {"total"};

static const struct {
  strut_channel id;
  const char *name, *unit;
  size_t components;
  const char *const *component_names;
} kinds[] = {
    {STRUT_CHANNEL_POSITION, "position", "m", 2, xy},
    {STRUT_CHANNEL_VELOCITY, "velocity", "m/s", 2, xy},
    {STRUT_CHANNEL_LENGTH, "length", "m", 1, single},
    {STRUT_CHANNEL_FORCE, "force", "N", 1, single},
    {STRUT_CHANNEL_CONTACT, "contact", "N", 2, reactions},
    {STRUT_CHANNEL_ANGLE, "angle", "rad", 1, single},
    {STRUT_CHANNEL_MOMENT, "moment", "N m", 1, single},
    {STRUT_CHANNEL_AREA, "area", "m^2", 1, single},
    {STRUT_CHANNEL_PRESSURE, "pressure", "N/m", 1, single},
    {STRUT_CHANNEL_ENERGY, "energy", "J", sizeof energies / sizeof energies[0], energies},
};

static const unsigned ALL_CHANNELS = ~0u;

/* The *count names of the items of a channel, in the arena. */
static const char *const *item_names(const strut_model *model, strut_channel id, strut_arena *arena,
                                     size_t *count) {
  const strut_scene *scene = model->scene;
  bool of_nodes = id == STRUT_CHANNEL_POSITION || id == STRUT_CHANNEL_VELOCITY;
  bool of_contacts = id == STRUT_CHANNEL_CONTACT;
  bool of_hinges = id == STRUT_CHANNEL_ANGLE || id == STRUT_CHANNEL_MOMENT;
  bool of_cells = id == STRUT_CHANNEL_AREA || id == STRUT_CHANNEL_PRESSURE;
  *count = 1;
  if (id == STRUT_CHANNEL_ENERGY) return total;
  *count = of_nodes      ? scene->node_count
           : of_contacts ? (size_t)model->contacts.count
           : of_hinges   ? scene->hinge_count
           : of_cells    ? scene->cell_count
                         : scene->member_count;
  const char **names = strut_arena_allocate(arena, *count, sizeof *names);
  for (size_t i = 0; names && i < *count; i++)
    names[i] = of_nodes      ? scene->nodes[i].name
               : of_contacts ? strut_contact_name(scene, i)
               : of_hinges   ? scene->hinges[i].name
               : of_cells    ? scene->cells[i].name
                             : scene->members[i].name;
  return names;
}

static bool create_layout(const strut_model *model, unsigned wanted, strut_recording *r) {
  r->layout.width = 1;
  for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
    if (!(wanted & kinds[k].id)) continue;
    strut_record_channel *c = &r->channel[r->layout.channel_count];
    *c = (strut_record_channel){.id = kinds[k].id,
                                .name = kinds[k].name,
                                .unit = kinds[k].unit,
                                .components = kinds[k].components,
                                .component_names = kinds[k].component_names,
                                .offset = r->layout.width};
    c->item_names = item_names(model, c->id, &r->arena, &c->items);
    if (!c->item_names) return false;
    if (!c->items) continue;
    r->layout.width += c->items * c->components;
    r->layout.channel_count++;
  }
  r->layout.channels = r->channel;
  return true;
}

static unsigned requested_channels(const strut_experiment *experiment, const strut_sink *sink) {
  return sink->channels ? sink->channels : experiment->channels;
}

/* Selects the channels of one sink from the full layout. */
static void create_part_layout(const strut_recording *r, unsigned wanted,
                               strut_recording_part *part) {
  part->layout = (strut_record_layout){
      .width = 1, .channels = part->channel, .expected_rows = r->layout.expected_rows};
  for (size_t k = 0; k < r->layout.channel_count; k++) {
    if (!(wanted & r->channel[k].id)) continue;
    strut_record_channel *c = &part->channel[part->layout.channel_count];
    *c = r->channel[k];
    part->from[part->layout.channel_count++] = c->offset;
    c->offset = part->layout.width;
    part->layout.width += c->items * c->components;
  }
  part->whole = part->layout.channel_count == r->layout.channel_count;
}

static bool create_parts(const strut_experiment *experiment, strut_recording *r) {
  bool all_whole = true;
  r->parts = strut_arena_allocate(&r->arena, r->sink_count, sizeof *r->parts);
  for (size_t s = 0; s < r->sink_count && r->parts; s++) {
    create_part_layout(r, requested_channels(experiment, r->sinks[s]), &r->parts[s]);
    all_whole = all_whole && r->parts[s].whole;
  }
  if (r->parts && !all_whole)
    r->picked = strut_arena_allocate(&r->arena, r->capacity * r->layout.width, sizeof(double));
  return r->parts && (all_whole || r->picked);
}

/* Space for what is measured of members, hinges and cells. */
static bool create_scratch(const strut_model *model, strut_recording *r) {
  size_t members = model->scene->member_count, hinges = model->scene->hinge_count;
  size_t cells = model->scene->cell_count;
  r->length = strut_arena_allocate(&r->arena, members, sizeof(double));
  r->force = strut_arena_allocate(&r->arena, members, sizeof(double));
  r->angle = strut_arena_allocate(&r->arena, hinges, sizeof(double));
  r->moment = strut_arena_allocate(&r->arena, hinges, sizeof(double));
  r->hinge = strut_arena_allocate(&r->arena, hinges, sizeof *r->hinge);
  r->area = strut_arena_allocate(&r->arena, cells, sizeof(double));
  r->pressure = strut_arena_allocate(&r->arena, cells, sizeof(double));
  r->cell = strut_arena_allocate(&r->arena, cells, sizeof *r->cell);
  if (!r->length || !r->force || !r->angle || !r->moment || !r->hinge || !r->area || !r->pressure ||
      !r->cell)
    return false;
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *e = &model->elements.element[i];
    if (e->role == STRUT_ELEMENT_HINGE) r->hinge[e->item] = i;
    if (e->role == STRUT_ELEMENT_CELL) r->cell[e->item] = i;
  }
  return true;
}

static strut_status begin_sinks(strut_recording *r, strut_error *error) {
  for (; r->begun < r->sink_count; r->begun++) {
    strut_sink *sink = r->sinks[r->begun];
    strut_status status = sink->begin(sink->context, &r->parts[r->begun].layout, error);
    if (status) return status;
  }
  return STRUT_OK;
}

strut_status strut_recording_create(const strut_model *model, const strut_experiment *experiment,
                                    const strut_time_grid *grid, double begin, strut_sink **sinks,
                                    size_t sink_count, strut_recording *r, strut_error *error) {
  *r = (strut_recording){.sinks = sinks, .sink_count = sink_count, .grid = *grid, .last = -1};
  if (!sink_count) return STRUT_OK;
  strut_span span = strut_experiment_span(experiment, model->scene);
  r->start = begin + span.record_start;
  r->every = span.record_every;
  unsigned wanted = 0;
  for (size_t s = 0; s < sink_count; s++) wanted |= requested_channels(experiment, sinks[s]);
  bool ready = create_scratch(model, r) && create_layout(model, wanted, r);
  double expected = (span.duration - span.record_start) / fmax(span.record_every, grid->step) + 1.0;
  r->layout.expected_rows = expected < 1e15 ? (size_t)expected : (size_t)1e15;
  char what[80];
  double bytes = sizeof(double) * (double)r->layout.width;
  snprintf(what, sizeof what, "each row of a recording of %zu columns", r->layout.width);
  strut_status status = strut_memory_check(bytes, what, error);
  if (status) return status;
  if (ready) {
    r->capacity = 1 + 65536 / r->layout.width;
    r->rows = strut_arena_allocate(&r->arena, r->capacity * r->layout.width, sizeof(double));
    ready = r->rows && create_parts(experiment, r);
  }
  if (!ready) return strut_memory_fail(bytes, what, error);
  return begin_sinks(r, error);
}

int64_t strut_recording_next_step(const strut_recording *r) {
  if (!r->sink_count) return INT64_MAX;
  double step = ceil((r->start + (double)r->sampled * r->every) / r->grid.step - 1e-6);
  if (!(step < 9e18)) return INT64_MAX; /* never: beyond the integers */
  int64_t due = (int64_t)step;
  return due > r->last ? due : r->last + 1;
}

bool strut_recording_lacks(const strut_recording *r, int64_t n) {
  return r->sink_count && r->last < n;
}

/* Values of one channel, (items, components) in the row's order. */
static void fill_channel(const strut_model *model, strut_state *state, const strut_recording *r,
                         const strut_record_channel *c, double *out) {
  const double *from = c->id == STRUT_CHANNEL_POSITION ? state->q : state->v;
  switch (c->id) {
    case STRUT_CHANNEL_POSITION:
    case STRUT_CHANNEL_VELOCITY: memcpy(out, from, 2 * c->items * sizeof *out); break;
    case STRUT_CHANNEL_LENGTH: memcpy(out, r->length, c->items * sizeof *out); break;
    case STRUT_CHANNEL_FORCE: memcpy(out, r->force, c->items * sizeof *out); break;
    case STRUT_CHANNEL_ANGLE: memcpy(out, r->angle, c->items * sizeof *out); break;
    case STRUT_CHANNEL_MOMENT: memcpy(out, r->moment, c->items * sizeof *out); break;
    case STRUT_CHANNEL_AREA: memcpy(out, r->area, c->items * sizeof *out); break;
    case STRUT_CHANNEL_PRESSURE: memcpy(out, r->pressure, c->items * sizeof *out); break;
    case STRUT_CHANNEL_CONTACT:
      for (size_t i = 0; i < c->items; i++) {
        out[2 * i] = state->normal[i];
        out[2 * i + 1] = state->friction[i];
      }
      break;
    case STRUT_CHANNEL_ENERGY: {
      strut_energies stored =
          strut_energy_evaluate(model, state, strut_time_grid_at(&r->grid, state->step));
      const double *w = state->work;
      double values[] = {
          stored.kinetic,         stored.elastic,
          stored.gravity,         stored.contact,
          w[STRUT_POWER_DRIVE],   w[STRUT_POWER_LOAD] + strut_energy_load_work(model, state),
          w[STRUT_POWER_BELT],    strut_support_motion_work(model, state),
          w[STRUT_POWER_MEMBERS], w[STRUT_POWER_CONTACT],
          w[STRUT_POWER_FRICTION]};
      memcpy(out, values, sizeof values);
    }
  }
}

static void measure_hinges(const strut_model *model, const strut_state *state, strut_recording *r) {
  for (size_t i = 0; i < model->scene->hinge_count; i++) {
    strut_hinge_values values = strut_hinge_measure(model, state, r->hinge[i]);
    r->angle[i] = values.angle;
    r->moment[i] = values.moment;
  }
}

static void measure_cells(const strut_model *model, const strut_state *state, strut_recording *r) {
  for (size_t i = 0; i < model->scene->cell_count; i++) {
    strut_cell_values values = strut_cell_measure(model, state, r->cell[i]);
    r->area[i] = values.area;
    r->pressure[i] = values.pressure;
  }
}

/* Rows of one sink: the full ones, or a copy of its channels. */
static const double *select_rows(strut_recording *r, const strut_recording_part *part,
                                 size_t count) {
  if (part->whole) return r->rows;
  for (size_t i = 0; i < count; i++) {
    const double *row = r->rows + i * r->layout.width;
    double *out = r->picked + i * part->layout.width;
    out[0] = row[0];
    for (size_t k = 0; k < part->layout.channel_count; k++) {
      const strut_record_channel *c = &part->channel[k];
      memcpy(out + c->offset, row + part->from[k], c->items * c->components * sizeof *out);
    }
  }
  return r->picked;
}

/* Passes all rows to the sinks; rows that a sink refuses are not offered again. */
static strut_status flush_rows(strut_recording *r, strut_error *error) {
  size_t count = r->row_count;
  r->row_count = 0;
  for (size_t s = 0; s < r->begun && count; s++) {
    const double *rows = select_rows(r, &r->parts[s], count);
    strut_status status = r->sinks[s]->rows(r->sinks[s]->context, rows, count, error);
    if (status) return status;
  }
  return STRUT_OK;
}

static void fill_row(const strut_model *model, strut_state *state, strut_recording *r,
                     unsigned wanted, double *row) {
  double t = strut_time_grid_at(&r->grid, state->step);
  if (wanted & ~(unsigned)(STRUT_CHANNEL_POSITION | STRUT_CHANNEL_VELOCITY)) {
    strut_forces_observe(model, state, t);
    strut_members_measure(model, state, r->length, r->force);
    measure_hinges(model, state, r);
    measure_cells(model, state, r);
  }
  row[0] = strut_time_grid_real(&r->grid, state->step);
  for (size_t k = 0; k < r->layout.channel_count; k++)
    if (wanted & (unsigned)r->channel[k].id)
      fill_channel(model, state, r, &r->channel[k], row + r->channel[k].offset);
}

strut_status strut_recording_sample(const strut_model *model, strut_state *state,
                                    strut_recording *r, strut_error *error) {
  assert(r->sink_count && r->row_count < r->capacity && state->step > r->last);
  fill_row(model, state, r, ALL_CHANNELS, r->rows + r->row_count++ * r->layout.width);
  r->last = state->step;
  r->sampled++;
  return r->row_count == r->capacity ? flush_rows(r, error) : STRUT_OK;
}

strut_status strut_recording_create_alone(const strut_model *model, const strut_time_grid *grid,
                                          strut_recording *r, strut_error *error) {
  *r = (strut_recording){.grid = *grid, .last = -1};
  bool good = create_scratch(model, r) && create_layout(model, ALL_CHANNELS, r);
  if (good) r->rows = strut_arena_allocate(&r->arena, r->layout.width, sizeof *r->rows);
  return r->rows ? STRUT_OK : strut_no_memory(error, "");
}

void strut_recording_observe(const strut_model *model, strut_state *state, strut_recording *r,
                             unsigned wanted) {
  if (wanted) fill_row(model, state, r, wanted, r->rows);
}

strut_status strut_recording_finish(strut_recording *r, strut_status run_status,
                                    strut_error *error) {
  strut_status status = flush_rows(r, error);
  if (status) run_status = status;
  for (size_t s = 0; s < r->begun; s++) {
    strut_error own = {0};
    strut_status ended = r->sinks[s]->end(r->sinks[s]->context, run_status, &own);
    if (!ended || status) continue;
    status = ended;
    if (error) *error = own;
  }
  r->begun = 0;
  return status;
}

void strut_recording_free(strut_recording *r) {
  for (size_t s = 0; s < r->begun; s++)
    r->sinks[s]->end(r->sinks[s]->context, STRUT_FILE_TROUBLE, NULL);
  strut_arena_free(&r->arena);
}
