/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/models/run_model.h"

#include "tests/support/check.h"

enum { MOST_SETTINGS = 8, NAME_ROOM = 64 };

static strut_status begin(void *context, const strut_record_layout *layout, strut_error *error) {
  (void)error;
  model_run *run = context;
  run->layout = *layout;
  assert_true(layout->channel_count <= sizeof run->channels / sizeof run->channels[0]);
  for (size_t i = 0; i < layout->channel_count; i++) run->channels[i] = layout->channels[i];
  return STRUT_OK;
}

static strut_status take(void *context, const double *rows, size_t count, strut_error *error) {
  (void)error;
  model_run *run = context;
  size_t width = run->layout.width;
  if (run->row_count + count > run->row_room) {
    run->row_room = 2 * run->row_room + count;
    run->rows = strut_reallocate(run->rows, run->row_room, width * sizeof *rows);
    assert_non_null(run->rows);
  }
  memcpy(run->rows + run->row_count * width, rows, count * width * sizeof *rows);
  run->row_count += count;
  return STRUT_OK;
}

static strut_status end(void *context, strut_status status, strut_error *error) {
  (void)context, (void)status, (void)error;
  return STRUT_OK;
}

model_run model_read_text(const char *name, const char *text, const char *const *settings) {
  char names[MOST_SETTINGS][NAME_ROOM];
  strut_setting overrides[MOST_SETTINGS];
  size_t count = 0;
  for (; settings[count]; count++) {
    const char *sign = strchr(settings[count], '=');
    assert_true(sign && count < MOST_SETTINGS && sign - settings[count] < NAME_ROOM);
    snprintf(names[count], NAME_ROOM, "%.*s", (int)(sign - settings[count]), settings[count]);
    overrides[count] = (strut_setting){.name = names[count], .text = sign + 1};
  }
  model_run run = {.model = NULL};
  OWN(strut_diagnostics) diagnostics = {0};
  size_t size = strlen(text) + 20;
  FREED char *whole = malloc(size);
  assert_non_null(whole);
  snprintf(whole, size, "%s%s", strstr(text, "strut: 1") ? "" : "strut: 1\n", text);
  strut_status status = strut_setup_read(&run.setup, name, whole, strlen(whole), overrides, count,
                                         STRUT_FOR_RUN, &diagnostics);
  for (size_t i = 0; i < diagnostics.count; i++)
    print_error("%s:%u: %s\n", name, diagnostics.items[i].place.line, diagnostics.items[i].message);
  if (status) fail_msg("%s is not valid: %s", name, strut_status_text(status));
  return run;
}

model_run model_read_format(const char *format, ...) {
  char text[4000];
  va_list arguments;
  va_start(arguments, format);
  int length = vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  assert_true(length >= 0 && (size_t)length < sizeof text);
  return model_read_text("scene", text, set_none);
}

model_run model_read(const char *name, const char *const *settings) {
  char path[256], *text = NULL;
  size_t length = 0;
  snprintf(path, sizeof path, "models/%s.yaml", name);
  strut_error error = {0};
  if (strut_file_read(path, &text, &length, &error)) fail_msg("%s: %s", path, error.message);
  model_run run = model_read_text(path, text, settings);
  strut_release(text);
  return run;
}

void model_simulate(model_run *run) {
  strut_error error = {0};
  strut_sink sink = {run, begin, take, end, 0}, *sinks[] = {&sink};
  strut_run_options options = {.sinks = sinks, .sink_count = 1};
  strut_status status = strut_model_compile(&run->setup.scene, &run->model, &error);
  if (!status)
    status = strut_simulate(run->model, &run->setup.experiment, &options, &run->summary, &error);
  if (status) fail_msg("%s: %s", run->setup.scene.name, error.message);
  run->layout.channels = run->channels;
}

void model_simulate_by(model_run *run, const char *method) {
  run->setup.experiment.integrator = method;
  model_simulate(run);
}

void model_run_free(model_run *run) {
  strut_release(run->rows);
  strut_summary_free(&run->summary);
  strut_model_free(run->model);
  strut_setup_free(&run->setup);
}

const double *model_position(const model_run *run, const char *node) {
  for (size_t i = 0; i < run->summary.end.node_count; i++)
    if (!strcmp(run->summary.end.node_names[i], node)) return run->summary.end.positions + 2 * i;
  fail_msg("no node '%s'", node);
  return NULL;
}

/* Offset in a row. The item names were the recorder's; the scene's are the same ones in order. */
static size_t place(const model_run *run, strut_channels id, const char *item, size_t component) {
  const strut_scene *scene = &run->setup.scene;
  bool members = id == STRUT_CHANNEL_LENGTH || id == STRUT_CHANNEL_FORCE;
  size_t count = members ? scene->member_count : scene->node_count;
  for (size_t k = 0; k < run->layout.channel_count; k++) {
    const strut_record_channel *channel = &run->channels[k];
    if (channel->id != id) continue;
    for (size_t i = 0; i < count; i++)
      if (!strcmp(members ? scene->members[i].name : scene->nodes[i].name, item))
        return channel->offset + i * channel->components + component;
  }
  fail_msg("'%s' was not recorded", item);
  return 0;
}

double model_value(const model_run *run, size_t row, strut_channels channel, const char *item,
                   size_t component) {
  assert_true(row < run->row_count);
  return run->rows[row * run->layout.width + place(run, channel, item, component)];
}
