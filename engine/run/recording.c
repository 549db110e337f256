/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/recording.h"

#include <assert.h>
#include <math.h>
#include <string.h>

static const strut_channels ALL_CHANNELS = ~(strut_channels)0;

/* Names of the items of a channel, in the arena. */
static const char *const *item_names(const strut_model *model, const strut_channel_row *row,
                                     size_t count, strut_arena *arena) {
  const char **names = strut_arena_allocate(arena, count, sizeof *names);
  for (size_t i = 0; names && i < count; i++) names[i] = strut_channel_item(row, model->scene, i);
  return names;
}

static bool create_layout(const strut_model *model, strut_channels wanted, strut_recording *r) {
  if (!strut_instant_create(model, &r->arena, &r->instant)) return false;
  const strut_channel_row *row;
  r->layout.width = 1;
  for (size_t k = 0; (row = strut_channel_at(k)) != NULL; k++) {
    size_t items = strut_channel_items(row, model->scene);
    if (!(wanted & row->id) || items <= row->total) continue; /* a total of nothing is left out */
    strut_record_channel *c = &r->channel[r->layout.channel_count++];
    *c = (strut_record_channel){.id = row->id,
                                .name = row->name,
                                .unit = row->unit,
                                .items = items,
                                .components = row->components,
                                .component_names = row->component_names,
                                .offset = r->layout.width};
    c->item_names = item_names(model, row, items, &r->arena);
    if (!c->item_names) return false;
    r->layout.width += c->items * c->components;
  }
  r->layout.channels = r->channel;
  return true;
}

/* Where each number of a row comes from. */
static bool find_columns(strut_recording *r) {
  const strut_model *model = r->instant.model;
  r->column = strut_arena_allocate(&r->arena, r->layout.width, sizeof *r->column);
  r->observe = strut_arena_allocate(&r->arena, r->layout.width, sizeof *r->observe);
  for (size_t k = 0; k < r->layout.channel_count && r->column && r->observe; k++) {
    const strut_record_channel *c = &r->channel[k];
    const strut_channel_row *row = strut_channel_row_of(c->id);
    int32_t near = 0;
    for (size_t i = 0; i < (c->items - row->total) * c->components; i++) {
      size_t item = i / c->components, to = c->offset + i;
      strut_column column = {(strut_column_kind)(row->first + i % c->components),
                             (int32_t)strut_owner_index(row->owner, model->scene, item), -1};
      r->observe[to] = strut_observe_at(column.kind);
      if (row->owner == STRUT_OWNER_CONTACT)
        column.other = column.item + 1; /* each by itself, also of a node on several grounds */
      else
        column = strut_column_find(model, column, near);
      near = column.item >= 0 && column.item < model->elements.count ? column.item : 0;
      r->column[to] = column;
    }
  }
  return r->column && r->observe;
}

static strut_channels requested_channels(const strut_experiment *experiment,
                                         const strut_sink *sink) {
  return sink->channels ? sink->channels : experiment->channels;
}

/* Selects the channels of one sink from the full layout. */
static void create_part_layout(const strut_recording *r, strut_channels wanted,
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

static strut_status begin_sinks(strut_recording *r, strut_error *error) {
  for (; r->begun < r->sink_count; r->begun++) {
    strut_sink *sink = r->sinks[r->begun];
    strut_status status =
        !sink->begin ? STRUT_OK : sink->begin(sink->context, &r->parts[r->begun].layout, error);
    if (status) return status;
  }
  return STRUT_OK;
}

strut_status strut_recording_create(const strut_model *model, const strut_experiment *experiment,
                                    double begin, strut_recording *r, strut_error *error) {
  *r = (strut_recording){
      .sinks = r->sinks, .sink_count = r->sink_count, .grid = r->grid, .last = -1};
  if (!r->sink_count) return STRUT_OK;
  strut_span span = strut_experiment_span(experiment, model->scene);
  r->start = begin + span.record_start;
  r->every = span.record_every;
  strut_channels wanted = 0;
  for (size_t s = 0; s < r->sink_count; s++) wanted |= requested_channels(experiment, r->sinks[s]);
  bool ready = create_layout(model, wanted, r) && find_columns(r);
  double expected =
      (span.duration - span.record_start) / fmax(span.record_every, r->grid.step) + 1.0;
  r->layout.expected_rows = expected < 1e15 ? (size_t)expected : (size_t)1e15;
  if (ready) {
    r->capacity = 1 + 65536 / r->layout.width;
    r->rows = strut_arena_allocate(&r->arena, r->capacity * r->layout.width, sizeof(double));
    ready = r->rows && create_parts(experiment, r);
  }
  if (!ready) return strut_no_memory(error, "for the recording");
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
    if (!r->sinks[s]->rows) continue;
    strut_status status = r->sinks[s]->rows(r->sinks[s]->context, rows, count, error);
    if (status) return status;
  }
  return STRUT_OK;
}

static unsigned needs_of(const strut_recording *r, strut_channels wanted) {
  unsigned needs = 0;
  for (size_t k = 0; k < r->layout.channel_count; k++)
    for (size_t c = 0; c < r->channel[k].components && (wanted & r->channel[k].id); c++)
      needs |= 1u << strut_observable_at(r->column[r->channel[k].offset + c].kind)->need;
  return needs;
}

static void fill_row(strut_state *state, strut_recording *r, strut_channels wanted, double *row) {
  strut_instant_show(&r->instant, state, needs_of(r, wanted),
                     strut_time_grid_at(&r->grid, state->step));
  row[0] = strut_time_grid_real(&r->grid, state->step);
  for (size_t k = 0; k < r->layout.channel_count; k++) {
    const strut_record_channel *c = &r->channel[k];
    double sum = 0.0;
    for (size_t i = c->offset; i < c->offset + c->items * c->components && (wanted & c->id); i++) {
      const strut_column *from = &r->column[i];
      row[i] = r->observe[i] ? r->observe[i](&r->instant, from->item, from->other).value : sum;
      sum += row[i];
    }
  }
}

strut_status strut_recording_sample(strut_state *state, strut_recording *r, strut_error *error) {
  assert(r->sink_count && r->row_count < r->capacity && state->step > r->last);
  fill_row(state, r, ALL_CHANNELS, r->rows + r->row_count++ * r->layout.width);
  r->last = state->step;
  r->sampled++;
  return r->row_count == r->capacity ? flush_rows(r, error) : STRUT_OK;
}

strut_status strut_recording_create_alone(const strut_model *model, const strut_time_grid *grid,
                                          strut_recording *r, strut_error *error) {
  *r = (strut_recording){.grid = *grid, .last = -1};
  if (create_layout(model, ALL_CHANNELS, r) && find_columns(r))
    r->rows = strut_arena_allocate(&r->arena, r->layout.width, sizeof *r->rows);
  return r->rows ? STRUT_OK : strut_no_memory(error, "");
}

void strut_recording_observe(strut_state *state, strut_recording *r, strut_channels wanted) {
  if (wanted) fill_row(state, r, wanted, r->rows);
}

strut_status strut_recording_finish(strut_recording *r, strut_status run_status,
                                    strut_error *error) {
  strut_status status = flush_rows(r, error);
  if (status) run_status = status;
  for (size_t s = 0; s < r->begun; s++) {
    strut_error own = {0};
    if (!r->sinks[s]->end) continue;
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
    if (r->sinks[s]->end) r->sinks[s]->end(r->sinks[s]->context, STRUT_FILE_TROUBLE, NULL);
  strut_arena_free(&r->arena);
}
