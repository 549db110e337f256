/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names and literals of the text. */
#include <assert.h>
#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/number_text.h"
#include "engine/output/code/writer.h"

/* ---- literals and comments ---- */

static void add_literal(strut_code_writer *w, const char *digits, const char *suffix) {
  strut_buffer_add(&w->text, "%s%s%s", digits, strpbrk(digits, ".e") ? "" : ".0", suffix);
}

void strut_code_add_double(strut_code_writer *w, double value) {
  char text[STRUT_NUMBER_TEXT];
  strut_number_text(value, text);
  add_literal(w, text, "");
}

void strut_code_add_real(strut_code_writer *w, double value) {
  char text[STRUT_NUMBER_TEXT];
  if (!w->options->single) {
    strut_code_add_double(w, value);
    return;
  }
  float nearest = (float)value;
  if (!isfinite(nearest)) w->no_float = true;
  int digits = 1;
  do snprintf(text, sizeof text, "%.*g", digits, (double)nearest);
  while (digits++ < FLT_DECIMAL_DIG &&
         !(strtof(text, NULL) >= nearest && strtof(text, NULL) <= nearest));
  add_literal(w, text, "f");
}

void strut_code_add_comment(strut_code_writer *w, const char *text) {
  for (const unsigned char *c = (const unsigned char *)text; *c; c++)
    strut_buffer_add(&w->text, "%c", *c < 32 || *c == 127 || strchr("*\\?", *c) ? '_' : *c);
}

void strut_code_add_field(strut_code_writer *w, double value) {
  strut_buffer_add(&w->text, ", ");
  strut_code_add_real(w, value);
}

void strut_code_end_row(strut_code_writer *w, const char *name) {
  strut_buffer_add(&w->text, "}, /* ");
  strut_code_add_comment(w, name ? name : "");
  strut_buffer_add(&w->text, " */\n");
}

void strut_code_add_constant(strut_code_writer *w, const char *name, double value) {
  strut_buffer_add(&w->text, "static const real %s = ", name);
  strut_code_add_real(w, value);
  strut_buffer_add(&w->text, ";\n");
}

/* ---- identifiers ---- */

bool strut_code_is_prefix(const char *text) {
  size_t length = strlen(text);
  if (length < 1 || length > 64 || !isalpha((unsigned char)text[0])) return false;
  for (; *text; text++)
    if (!isalnum((unsigned char)*text) && *text != '_') return false;
  return true;
}

static char identifier_letter(char c) {
  bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
  return plain ? c : '_';
}

void strut_code_prefix_of(const char *text, char prefix[65]) {
  const char *slash = strrchr(text, '/'), *stem = slash ? slash + 1 : text;
  size_t length = strcspn(stem, "."), used = 0;
  bool letter = (*stem >= 'a' && *stem <= 'z') || (*stem >= 'A' && *stem <= 'Z');
  if (!letter && length) used = (size_t)snprintf(prefix, 65, "model_");
  if (!length) used = (size_t)snprintf(prefix, 65, "model");
  for (size_t i = 0; i < length && used < 64; i++) prefix[used++] = identifier_letter(stem[i]);
  prefix[used] = '\0';
}

static bool make_names(strut_code_writer *w, strut_code_names *names, size_t count,
                       const char *(*name_of)(strut_code_writer *, size_t)) {
  strut_name_map taken = {0};
  bool good = true;
  names->count = count;
  names->name = strut_arena_allocate(&w->arena, count, sizeof *names->name);
  if (!names->name) return false;
  for (size_t i = 0; i < count && good; i++) {
    const char *given = name_of(w, i), *text = given ? given : "";
    size_t length = strlen(text);
    char *name = strut_arena_allocate(&w->arena, length + 24, 1);
    if (!name) {
      good = false;
      break;
    }
    for (size_t k = 0; k < length; k++) name[k] = identifier_letter(text[k]);
    int32_t other = strut_name_map_add(&taken, name, (int32_t)i);
    for (int again = 2; other >= 0; again++) {
      snprintf(name + length, 24, "_%d", again);
      other = strut_name_map_add(&taken, name, (int32_t)i);
    }
    good = other == -1;
    names->name[i] = name;
  }
  strut_name_map_free(&taken);
  return good;
}

static const char *node_name(strut_code_writer *w, size_t i) { return w->scene->nodes[i].name; }
static const char *member_name(strut_code_writer *w, size_t i) { return w->scene->members[i].name; }

/* The n-th load of the scene that has a signal. */
static const strut_load *driven_load(const strut_scene *scene, size_t n) {
  for (size_t i = 0; i < scene->load_count; i++)
    if (scene->loads[i].signal >= 0 && n-- == 0) return &scene->loads[i];
  assert(false && "inputs are counted from the same loads");
  return NULL;
}

/* The n-th actuator of the scene that gives a force, or that gives none. */
static const strut_actuator *actuator(const strut_scene *scene, bool force, size_t n) {
  for (size_t i = 0; i < scene->actuator_count; i++)
    if (scene->actuators[i].force == force && n-- == 0) return &scene->actuators[i];
  assert(false && "inputs are counted from the same actuators");
  return NULL;
}

/* "GROUND_x" */
static const char *shake_name(strut_code_writer *w, size_t n) {
  int axis;
  const strut_ground *ground = strut_code_shaken(w->model, (int32_t)n, &axis);
  const char *of = ground->name && ground->name[0] ? ground->name : "ground";
  size_t length = strlen(of) + 3;
  char *name = strut_arena_allocate(&w->arena, length, 1);
  if (name) snprintf(name, length, "%s_%c", of, "xy"[axis]);
  return name;
}

static const char *input_name(strut_code_writer *w, size_t i) {
  size_t drives = (size_t)w->model->drives.count, loads = (size_t)w->model->loads.count;
  size_t others = drives + loads + (size_t)w->model->actuator_forces.count;
  return i >= others          ? shake_name(w, i - others)
         : i < drives         ? actuator(w->scene, false, i)->name
         : i < drives + loads ? driven_load(w->scene, i - drives)->name
                              : actuator(w->scene, true, i - drives - loads)->name;
}

static const char *breakable_name(strut_code_writer *w, size_t i) {
  const strut_breakable *b = &w->model->elements.breakable[i];
  return b->role == STRUT_ELEMENT_HINGE ? w->scene->hinges[b->item].name
                                        : w->scene->members[b->item].name;
}

/* Its name, or its number. */
static const char *signal_name(strut_code_writer *w, size_t i) {
  const char *given = w->scene->signals[i].name;
  if (given && given[0]) return given;
  char *number = strut_arena_allocate(&w->arena, 24, 1);
  if (number) snprintf(number, 24, "%zu", i);
  return number;
}
static const char *slider_name(strut_code_writer *w, size_t k) {
  return strut_code_slider_name(w, (int32_t)k);
}
static const char *sensor_name(strut_code_writer *w, size_t i) { return w->scene->sensors[i].name; }

/* "z", "lag_SIGNAL", "maxwell_MEMBER" */
static const char *state_name(strut_code_writer *w, size_t k) {
  const char *kind, *of = strut_code_state_name(w, (int32_t)k, &kind);
  size_t length = strlen(kind) + strlen(of) + 1;
  char *name = strut_arena_allocate(&w->arena, length, 1);
  if (name) snprintf(name, length, "%s%s", kind, of);
  return name;
}

bool strut_code_make_names(strut_code_writer *w) {
  return make_names(w, &w->nodes, w->scene->node_count, node_name) &&
         make_names(w, &w->members, w->scene->member_count, member_name) &&
         make_names(w, &w->inputs, (size_t)strut_code_input_count(w->model), input_name) &&
         make_names(w, &w->breakables, (size_t)w->model->elements.breakable_count,
                    breakable_name) &&
         make_names(w, &w->signals, w->scene->signal_count, signal_name) &&
         make_names(w, &w->sliders, (size_t)w->model->sliding.moving_count, slider_name) &&
         make_names(w, &w->sensors, w->scene->sensor_count, sensor_name) &&
         make_names(w, &w->states, (size_t)w->model->feedback.state_count, state_name);
}
