/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/simulate_parts.h"

#include <assert.h>
#include <math.h>
#include <string.h>

static const strut_channels ALL_CHANNELS = ~(strut_channels)0;

static void see_piece(strut_observer *observer, strut_state *state,
                      const strut_motion_piece *piece);

/* Names of the items of a channel, in the arena. */
static const char *const *item_names(const strut_model *model, const strut_channel_row *row,
                                     size_t count, strut_arena *arena) {
  const char **names = strut_arena_allocate(arena, count, sizeof *names);
  for (size_t i = 0; names && i < count; i++) names[i] = strut_channel_item(row, model->scene, i);
  return names;
}

static const char *const *item_units(const strut_model *model, const strut_channel_row *row,
                                     size_t count, strut_arena *arena) {
  const char **units = strut_arena_allocate(arena, count, sizeof *units);
  for (size_t i = 0; units && i < count; i++)
    units[i] = strut_channel_item_unit(row, model->scene, i);
  return units;
}

static bool create_layout(const strut_model *model, strut_channels wanted,
                          strut_recording *recording) {
  if (!strut_instant_create(model, &recording->arena, &recording->instant)) return false;
  const strut_channel_row *row;
  recording->layout.width = 1;
  for (size_t k = 0; (row = strut_channel_at(k)) != NULL; k++) {
    size_t items = strut_channel_items(row, model->scene);
    if (!(wanted & row->id) || items <= row->total) continue; /* a total of nothing is left out */
    strut_record_channel *channel = &recording->channel[recording->layout.channel_count++];
    *channel = (strut_record_channel){.id = row->id,
                                      .name = row->name,
                                      .unit = row->unit,
                                      .items = items,
                                      .components = row->components,
                                      .component_names = row->component_names,
                                      .offset = recording->layout.width};
    channel->item_names = item_names(model, row, items, &recording->arena);
    channel->item_units = item_units(model, row, items, &recording->arena);
    if (!channel->item_names || !channel->item_units) return false;
    recording->layout.width += channel->items * channel->components;
  }
  recording->layout.channels = recording->channel;
  return true;
}

/* Where each number of a row comes from. */
static bool find_columns(strut_recording *recording) {
  const strut_model *model = recording->instant.model;
  const size_t width = recording->layout.width;
  bool ready = STRUT_ALLOCATE(&recording->arena, STRUT_NEW(recording->column, width),
                              STRUT_NEW(recording->observe, width));
  for (size_t k = 0; k < recording->layout.channel_count && ready; k++) {
    const strut_record_channel *channel = &recording->channel[k];
    const strut_channel_row *row = strut_channel_row_of(channel->id);
    int32_t near = 0;
    for (size_t i = 0; i < (channel->items - row->total) * channel->components; i++) {
      size_t item = i / channel->components, to = channel->offset + i;
      strut_column column = {(strut_column_kind)(row->first + i % channel->components),
                             (int32_t)strut_owner_index(row->owner, model->scene, item), -1};
      recording->observe[to] = strut_observe_at(column.kind);
      if (row->owner == STRUT_OWNER_CONTACT)
        column.other = column.item + 1; /* each by itself, also of a node on several grounds */
      else
        column = strut_column_find(model, column, near);
      near = column.item >= 0 && column.item < model->elements.count ? column.item : 0;
      recording->column[to] = column;
    }
  }
  return ready;
}

static strut_channels requested_channels(const strut_experiment *experiment,
                                         const strut_sink *sink) {
  return sink->channels ? sink->channels : experiment->channels;
}

/* Each sink hears of its channels, which are at their places in the full rows. */
static strut_status begin_sinks(const strut_experiment *experiment, strut_recording *recording,
                                strut_error *error) {
  for (; recording->begun < recording->sink_count; recording->begun++) {
    strut_sink *sink = recording->sinks[recording->begun];
    strut_channels wanted = requested_channels(experiment, sink);
    strut_record_channel channel[STRUT_CHANNEL_COUNT];
    strut_record_layout layout = recording->layout;
    layout.channels = channel;
    layout.channel_count = 0;
    for (size_t k = 0; k < recording->layout.channel_count; k++)
      if (wanted & recording->channel[k].id)
        channel[layout.channel_count++] = recording->channel[k];
    strut_status status = sink->begin ? sink->begin(sink->context, &layout, error) : STRUT_OK;
    if (status) return status;
  }
  return STRUT_OK;
}

strut_status strut_recording_create(const strut_model *model, const strut_experiment *experiment,
                                    double begin, strut_recording *recording, strut_error *error) {
  *recording = (strut_recording){.sinks = recording->sinks,
                                 .sink_count = recording->sink_count,
                                 .grid = recording->grid,
                                 .observer.see = see_piece,
                                 .last = -1};
  if (!recording->sink_count) return STRUT_OK;
  strut_span span = strut_experiment_span(experiment, model->scene);
  recording->start = begin + span.record_start;
  recording->every = span.record_every;
  double in_step = experiment->output_every > 0.0 ? recording->grid.step / recording->every : 0.0;
  if (!(in_step < STRUT_MOST_IN_STEP))
    return strut_fail(
        error, STRUT_USAGE,
        "'output: {every: %g s}' is %.3g samples in a step of %g s; at most %g are taken",
        recording->every, in_step, recording->grid.step, STRUT_MOST_IN_STEP);
  recording->in_step = in_step > 0.0 ? 1 + (size_t)in_step : 0;
  strut_channels wanted = 0;
  for (size_t s = 0; s < recording->sink_count; s++)
    wanted |= requested_channels(experiment, recording->sinks[s]);
  bool ready = create_layout(model, wanted, recording) && find_columns(recording);
  double apart = fmax(span.record_every, recording->in_step ? 0.0 : recording->grid.step);
  double expected = (span.duration - span.record_start) / apart + 1.0;
  recording->layout.expected_rows = expected < 1e15 ? (size_t)expected : (size_t)1e15;
  if (ready) {
    recording->capacity = recording->in_step + 1 + 65536 / recording->layout.width;
    recording->rows = strut_arena_allocate(
        &recording->arena, recording->capacity * recording->layout.width, sizeof(double));
    ready = recording->rows && strut_dense_create(model, &recording->arena, &recording->dense);
  }
  if (!ready) return strut_no_memory(error, "for the recording");
  return begin_sinks(experiment, recording, error);
}

/* A sample this close to the end of a step, in steps, is taken there. */
static const double AT_END = 1e-6;

/* When the next sample is due, without the offset of the grid [s]. */
static double next_time(const strut_recording *recording) {
  return recording->start + (double)recording->sampled * recording->every;
}

/* Is a sample due within step n, before its end? */
static bool is_within(const strut_recording *recording, int64_t n) {
  double due = next_time(recording), step = recording->grid.step, near = AT_END * step;
  return recording->in_step && due > strut_time_grid_at(&recording->grid, n - 1) + near &&
         due < strut_time_grid_at(&recording->grid, n) - near;
}

int64_t strut_recording_next_step(const strut_recording *recording, int64_t n) {
  if (!recording->sink_count) return INT64_MAX;
  double step = ceil(next_time(recording) / recording->grid.step - AT_END);
  if (!(step < 9e18)) return INT64_MAX; /* never: beyond the integers */
  int64_t due = (int64_t)step;
  if (is_within(recording, due)) return due - 1 > n ? due - 1 : due;
  return due > recording->last ? due : recording->last + 1;
}

bool strut_recording_lacks(const strut_recording *recording, int64_t n) {
  return recording->sink_count && recording->last < n;
}

strut_status strut_recording_flush(strut_recording *recording, strut_error *error) {
  size_t count = recording->row_count;
  recording->row_count = 0;
  for (size_t s = 0; s < recording->begun && count; s++) {
    const strut_sink *sink = recording->sinks[s];
    strut_status status =
        sink->rows ? sink->rows(sink->context, recording->rows, count, error) : STRUT_OK;
    if (status) return status;
  }
  return STRUT_OK;
}

static unsigned needs_of(const strut_recording *recording, strut_channels wanted) {
  unsigned needs = 0;
  for (size_t k = 0; k < recording->layout.channel_count; k++)
    for (size_t c = 0; c < recording->channel[k].components && (wanted & recording->channel[k].id);
         c++)
      needs |=
          1u << strut_observable_at(recording->column[recording->channel[k].offset + c].kind)->need;
  return needs;
}

/* Fills the channels of the state at time t [s], without its time_offset. */
static void fill_row(strut_state *state, strut_recording *recording, strut_channels wanted,
                     double t, double *row) {
  strut_instant_show(&recording->instant, state, needs_of(recording, wanted), t);
  for (size_t k = 0; k < recording->layout.channel_count; k++) {
    const strut_record_channel *channel = &recording->channel[k];
    double sum = 0.0;
    for (size_t i = channel->offset;
         i < channel->offset + channel->items * channel->components && (wanted & channel->id);
         i++) {
      const strut_column *from = &recording->column[i];
      row[i] = recording->observe[i]
                   ? recording->observe[i](&recording->instant, from->item, from->other).value
                   : sum;
      sum += row[i];
    }
  }
}

static void add_row(strut_state *state, strut_recording *recording, double t, double real) {
  double *row = recording->rows + recording->row_count++ * recording->layout.width;
  assert(recording->sink_count && recording->row_count <= recording->capacity);
  row[0] = real;
  fill_row(state, recording, ALL_CHANNELS, t, row);
  recording->sampled++;
}

strut_status strut_recording_sample(strut_state *state, strut_recording *recording, bool due,
                                    strut_error *error) {
  if (due) {
    add_row(state, recording, strut_time_grid_at(&recording->grid, state->step),
            strut_time_grid_real(&recording->grid, state->step));
    recording->last = state->step;
  }
  bool full = recording->row_count + recording->in_step + 1 > recording->capacity;
  return full ? strut_recording_flush(recording, error) : STRUT_OK;
}

/* Takes the samples of step n that are due before the end of the piece, which stands `later` than it says [s]. */
static void sample_piece(strut_recording *recording, strut_state *state, strut_motion_piece piece,
                         double later, int64_t n) {
  double begin = piece.begin + later, end = begin + piece.length, due;
  if (strut_run_find_lost_node(recording->dense.model, state) >= 0) return;
  while (is_within(recording, n) && (due = next_time(recording)) <= end) {
    double s = fmin(fmax((due - begin) / piece.length, 0.0), 1.0);
    double t = strut_dense_place(&recording->dense, state, &piece, s);
    add_row(state, recording, t, recording->grid.offset + due);
  }
  strut_dense_return(&recording->dense, state, &piece);
}

/* The other observer is called as if it were the only one, since it may wish to see no more. */
static void see_piece(strut_observer *observer, strut_state *state,
                      const strut_motion_piece *piece) {
  strut_recording *recording = (strut_recording *)observer;
  sample_piece(recording, state, *piece, state->time_offset - recording->grid.offset,
               state->step + 1);
  if (!recording->other) return;
  state->watched.observer = recording->other;
  recording->other->see(recording->other, state, piece);
  recording->other = state->watched.observer;
  state->watched.observer = observer;
}

void strut_recording_begin_step(strut_recording *recording, strut_state *state) {
  if (!is_within(recording, state->step + 1)) return;
  recording->other = state->watched.observer;
  state->watched.observer = &recording->observer;
  strut_dense_keep(&recording->dense, state);
}

void strut_recording_end_step(strut_recording *recording, strut_state *state) {
  double begin = strut_time_grid_at(&recording->grid, state->step - 1);
  double length = strut_time_grid_at(&recording->grid, state->step) - begin;
  if (state->watched.observer != &recording->observer) return;
  state->watched.observer = recording->other;
  sample_piece(recording, state, strut_dense_step(&recording->dense, state, begin, length), 0.0,
               state->step);
}

strut_status strut_recording_create_alone(const strut_model *model, const strut_time_grid *grid,
                                          strut_recording *recording, strut_error *error) {
  *recording = (strut_recording){.grid = *grid, .last = -1};
  if (create_layout(model, ALL_CHANNELS, recording) && find_columns(recording))
    recording->rows =
        strut_arena_allocate(&recording->arena, recording->layout.width, sizeof *recording->rows);
  return recording->rows ? STRUT_OK : strut_no_memory(error, "");
}

void strut_recording_observe(strut_state *state, strut_recording *recording,
                             strut_channels wanted) {
  if (wanted)
    fill_row(state, recording, wanted, strut_time_grid_at(&recording->grid, state->step),
             recording->rows);
}

strut_status strut_recording_finish(strut_recording *recording, strut_status run_status,
                                    strut_error *error) {
  strut_status status = strut_recording_flush(recording, error);
  if (status) run_status = status;
  for (size_t s = 0; s < recording->begun; s++) {
    strut_error own = {0};
    if (!recording->sinks[s]->end) continue;
    strut_status ended = recording->sinks[s]->end(recording->sinks[s]->context, run_status, &own);
    if (!ended || status) continue;
    status = ended;
    if (error) *error = own;
  }
  recording->begun = 0;
  return status;
}

void strut_recording_free(strut_recording *recording) {
  for (size_t s = 0; s < recording->begun; s++)
    if (recording->sinks[s]->end)
      recording->sinks[s]->end(recording->sinks[s]->context, STRUT_FILE_TROUBLE, NULL);
  strut_arena_free(&recording->arena);
}
