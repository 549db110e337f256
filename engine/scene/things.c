/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables of things, and what loops over them. See things.h. */
#include "engine/scene/things.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST = 1024 }; /* name in which `last` is a number */

/* ---- kinds ---- */

#define USUAL(KIND, word, things, object, array, number, rest, ...)                                \
  static const object usual_##KIND = {__VA_ARGS__};
STRUT_THINGS(USUAL)
#undef USUAL

static const strut_thing_row kinds[] = {
#define KIND_ROW(KIND, word, things, object, array, number, rest, ...)                             \
  {word,                                                                                           \
   things,                                                                                         \
   sizeof(object),                                                                                 \
   offsetof(object, name),                                                                         \
   offsetof(strut_scene, array),                                                                   \
   offsetof(strut_scene, number),                                                                  \
   &usual_##KIND},
    STRUT_THINGS(KIND_ROW)};

const strut_thing_row *strut_thing_at(strut_thing kind) {
  assert((unsigned)kind < STRUT_THING_COUNT);
  return &kinds[kind];
}

size_t strut_thing_count(const strut_scene *scene, strut_thing kind) {
  return *(const size_t *)(const void *)((const char *)scene + kinds[kind].count);
}

const void *strut_thing_object(const strut_scene *scene, strut_thing kind, size_t i) {
  const char *array;
  memcpy(&array, (const char *)scene + kinds[kind].array, sizeof array);
  assert(i < strut_thing_count(scene, kind));
  return array + i * kinds[kind].size;
}

const char *strut_thing_name(const strut_scene *scene, strut_thing kind, size_t i) {
  const char *name;
  if (i >= strut_thing_count(scene, kind)) return NULL;
  memcpy(&name, (const char *)strut_thing_object(scene, kind, i) + kinds[kind].name, sizeof name);
  return name;
}

/* Writes for each `.last` of a name the largest number that things have there. */
static void resolve_last(const strut_scene *scene, strut_thing kind, char name[LONGEST]) {
  char rest[LONGEST];
  for (char *at = name; (at = strstr(at, ".last")) != NULL; at++) {
    size_t before = (size_t)(++at - name);
    long most = -1;
    for (size_t i = 0; i < strut_thing_count(scene, kind); i++) {
      const char *own = strut_thing_name(scene, kind, i);
      if (own && strncmp(own, name, before) == 0 && own[before] >= '0' && own[before] <= '9' &&
          strtol(own + before, NULL, 10) > most)
        most = strtol(own + before, NULL, 10);
    }
    if (most < 0 || (at[4] && at[4] != '.')) continue;
    memcpy(rest, at + 4, strlen(at + 4) + 1);
    snprintf(at, LONGEST - before, "%ld%s", most, rest);
  }
}

int32_t strut_thing_find(const strut_scene *scene, strut_thing kind, const char *name) {
  char text[LONGEST];
  size_t count = strut_thing_count(scene, kind);
  snprintf(text, sizeof text, "%s", name);
  if (strlen(name) + 1 < sizeof text) resolve_last(scene, kind, text), name = text;
  for (size_t i = 0; i < count; i++) {
    const char *own = strut_thing_name(scene, kind, i);
    if (own && strcmp(own, name) == 0) return (int32_t)i;
  }
  return -1;
}

int32_t strut_coordinate_find(const strut_scene *scene, const char *name) {
  char node[LONGEST];
  const char *dot = strrchr(name, '.');
  if (!dot || (strcmp(dot, ".x") != 0 && strcmp(dot, ".y") != 0)) return -1;
  if ((size_t)snprintf(node, sizeof node, "%.*s", (int)(dot - name), name) >= sizeof node)
    return -1;
  int32_t i = strut_thing_find(scene, STRUT_THING_NODE, node);
  return i < 0 ? -1 : 2 * i + (dot[1] == 'y');
}

strut_thing strut_thing_of_owner(strut_channel_owner owner) {
  static const strut_thing things[] = {
#define OWNER_THING(OWNER, THING, ...) STRUT_THING_##THING,
      STRUT_OWNERS(OWNER_THING)};
  return things[owner];
}

const strut_parameter *strut_parameter_named(const strut_scene *scene, const char *name) {
  for (size_t i = 0; i < scene->parameter_count; i++)
    if (strcmp(scene->parameters[i].name, name) == 0) return &scene->parameters[i];
  return NULL;
}

const strut_configuration *strut_configuration_named(const strut_scene *scene, const char *name) {
  int32_t i = strut_thing_find(scene, STRUT_THING_CONFIGURATION, name);
  return i >= 0 ? &scene->configurations[i] : NULL;
}

/* ---- fields ---- */

const char *strut_limits_fault(strut_key_limits limits, double number,
                               char text[STRUT_LIMITS_TEXT]) {
  strut_key_range range = limits.range;
  bool whole = range == STRUT_RANGE_WHOLE, share = range == STRUT_RANGE_SHARE;
  bool inside = number == floor(number) && number >= limits.least && number <= limits.most;
  char from[40] = "up to";
  if (limits.least > 0.0) snprintf(from, sizeof from, "from %.0f to", limits.least);
  if (number < 0.0 && (range == STRUT_RANGE_NOT_NEGATIVE || (whole && limits.least == 0.0)))
    snprintf(text, STRUT_LIMITS_TEXT, "must not be negative, found %g", number);
  else if (number <= 0.0 && (range == STRUT_RANGE_ABOVE_ZERO || share))
    snprintf(text, STRUT_LIMITS_TEXT, "must be above zero, found %g", number);
  else if (share && number > limits.most)
    snprintf(text, STRUT_LIMITS_TEXT, "must be at most %g %%, found %g %%; 1 %% is 0.01",
             100.0 * limits.most, 100.0 * number);
  else if ((whole || range == STRUT_RANGE_COUNT) && !inside)
    snprintf(text, STRUT_LIMITS_TEXT, "must %s %s %.0f%s, found %.15g",
             whole ? "be a whole number" : "have", from, limits.most, whole ? "" : " entries",
             number);
  else
    return NULL;
  return text;
}

#define STRUT_BELOW(SECTION) 0 /* the engine has no mappings */
#define FIELD_ROW(section, id, name, type, measure, range, fallback, need, set, words, field, ...) \
  {name, STRUT_LIMITS_##range, STRUT_##need, {STRUT_FIELD_OF_##field}},
#define FIELDS_OF_SECTION(SECTION, ...)                                                            \
  static const strut_field_row fields_##SECTION[] = {STRUT_##SECTION##_FIELDS(FIELD_ROW)};
STRUT_THINGS(FIELDS_OF_SECTION)
STRUT_FURTHER_SECTIONS(FIELDS_OF_SECTION)

static const struct {
  const strut_field_row *row;
  size_t count;
} sections[] = {
#define SECTION_ROW(SECTION, ...)                                                                  \
  {fields_##SECTION, sizeof fields_##SECTION / sizeof fields_##SECTION[0]},
    STRUT_THINGS(SECTION_ROW) STRUT_FURTHER_SECTIONS(SECTION_ROW)};

static const struct {
  strut_thing_section section;
  strut_field field;
} inner[] = {
#define INNER_ROW(SECTION, field) {STRUT_FIELDS_##SECTION, {STRUT_FIELD_OF_##field}},
    STRUT_INNER_FIELDS(INNER_ROW)};

const strut_field_row *strut_fields_of(strut_thing_section section, size_t *count) {
  *count = sections[section].count;
  return sections[section].row;
}

/* ---- what is at rest ---- */

typedef struct numbers {
  strut_number_sink *sink;
  void *context;
} numbers;

static void put(const numbers *to, double number) { to->sink(to->context, number); }

static double number_at(strut_field_type type, const void *value) {
  switch (type) {
    case STRUT_FIELD_DOUBLE: return *(const double *)value;
    case STRUT_FIELD_INT32: return *(const int32_t *)value;
    case STRUT_FIELD_UINT32: return *(const uint32_t *)value;
    case STRUT_FIELD_INT64: return (double)*(const int64_t *)value;
    case STRUT_FIELD_UINT64: return (double)*(const uint64_t *)value;
    case STRUT_FIELD_BOOL: return *(const bool *)value;
    case STRUT_FIELD_OBJECT:
    case STRUT_FIELD_DOUBLE_PAIR:
    case STRUT_FIELD_BOOL_PAIR:
    case STRUT_FIELD_TEXT:
    case STRUT_FIELD_INSTRUCTION:
    case STRUT_FIELD_NODE_SET:
    case STRUT_FIELD_TREE: break;
  }
  assert(false);
  return 0.0;
}

static void put_value(const numbers *to, strut_field_type type, const void *value) {
  if (type == STRUT_FIELD_DOUBLE_PAIR) {
    for (int c = 0; c < 2; c++) put(to, ((const double *)value)[c]);
  } else if (type == STRUT_FIELD_BOOL_PAIR) {
    for (int c = 0; c < 2; c++) put(to, ((const bool *)value)[c]);
  } else if (type != STRUT_FIELD_TEXT) { /* nothing computes with texts */
    put(to, number_at(type, value));
  }
}

static void put_sets(const numbers *to, const strut_node_set *sets, size_t count) {
  put(to, (double)count);
  for (size_t i = 0; i < count; i++) {
    put(to, (double)sets[i].count);
    for (size_t k = 0; k < sets[i].count; k++) put(to, sets[i].node[k]);
  }
}

static void put_list(const numbers *to, const strut_field *field, const char *object) {
  size_t size = field->type == STRUT_FIELD_INT32    ? sizeof(int32_t)
                : field->type == STRUT_FIELD_DOUBLE ? sizeof(double)
                                                    : 2 * sizeof(double);
  size_t count = *(const size_t *)(const void *)(object + field->number);
  const char *array, *second;
  memcpy(&array, object + field->offset, sizeof array);
  memcpy(&second, object + field->beside, sizeof second);
  if (field->type == STRUT_FIELD_NODE_SET) {
    put_sets(to, (const strut_node_set *)(const void *)array, count);
    return;
  }
  put(to, (double)count);
  for (size_t i = 0; i < count && array; i++) put_value(to, field->type, array + i * size);
  for (size_t i = 0; i < count && array && field->beside; i++)
    put_value(to, field->type, second + i * size);
}

/* A field of an object of `size` bytes, unless it belongs to a larger one or what is at rest does not need it. */
static void put_field(const numbers *to, const strut_field *field, const char *object,
                      size_t size) {
  if (field->of_runs || field->offset + field->size > size) return;
  if (field->chosen)
    put(to, field->tag_size == sizeof(bool)
                ? *(const bool *)(object + field->tag)
                : *(const uint32_t *)(const void *)(object + field->tag));
  if (field->role == STRUT_FIELD_VALUE)
    put_value(to, field->type, object + field->offset);
  else if (field->role == STRUT_FIELD_LIST)
    put_list(to, field, object);
  else if (field->role == STRUT_FIELD_REFERENCE)
    for (size_t i = 0; i < field->size / sizeof(int32_t); i++)
      put(to, ((const int32_t *)(const void *)(object + field->offset))[i]);
}

static void put_section(const numbers *to, strut_thing_section section, const void *object,
                        size_t size) {
  for (size_t i = 0; i < sections[section].count; i++)
    put_field(to, &sections[section].row[i].field, object, size);
  for (size_t i = 0; i < sizeof inner / sizeof inner[0]; i++)
    if (inner[i].section == section) put_field(to, &inner[i].field, object, size);
}

/* The section of a kind is that of the same number; these are within its objects, too. */
static const struct {
  strut_thing kind;
  strut_thing_section section;
  size_t offset, size;
} parts[] = {{STRUT_THING_MEMBER, STRUT_FIELDS_LAW, offsetof(strut_member, law), sizeof(strut_law)},
             {STRUT_THING_HINGE, STRUT_FIELDS_LAW, offsetof(strut_hinge, law), sizeof(strut_law)},
             {STRUT_THING_DISTANCE, STRUT_FIELDS_LAW, offsetof(strut_distance_spring, law),
              sizeof(strut_law)},
             {STRUT_THING_CELL, STRUT_FIELDS_LAW, offsetof(strut_cell, elastic), sizeof(strut_law)},
             {STRUT_THING_CELL, STRUT_FIELDS_GAS, 0, sizeof(strut_cell)},
             {STRUT_THING_GROUND, STRUT_FIELDS_CIRCLE, 0, sizeof(strut_ground)}};

static void put_thing(const numbers *to, strut_thing kind, const void *object) {
  put_section(to, (strut_thing_section)kind, object, kinds[kind].size);
  for (size_t p = 0; p < sizeof parts / sizeof parts[0]; p++)
    if (parts[p].kind == kind)
      put_section(to, parts[p].section, (const char *)object + parts[p].offset, parts[p].size);
}

static void put_configurations(const numbers *to, const strut_scene *scene) {
  put(to, (double)scene->configuration_count);
  for (size_t i = 0; i < scene->configuration_count; i++) {
    const strut_configuration *configuration = &scene->configurations[i];
    put(to, configuration->shaped);
    for (size_t k = 0; configuration->position && k < scene->node_count; k++)
      for (int d = 0; d < 2; d++) put(to, configuration->position[k][d]);
    put_sets(to, configuration->sets, configuration->set_count);
  }
}

/* What moves is where its signal has it at t = 0. */
static void put_moved(const numbers *to, const strut_scene *scene) {
  for (size_t i = 0; i < scene->support_motion_count; i++) {
    const strut_support_motion *motion = &scene->support_motions[i];
    double value, rate;
    strut_signal_evaluate(scene->signals, motion->signal, 0.0, &value, &rate);
    put(to, motion->node), put(to, motion->axis), put(to, value);
  }
  for (size_t i = 0; i < scene->sliding_count; i++) {
    put_thing(to, STRUT_THING_SLIDER, &scene->sliding_masses[i]);
    put(to, strut_sliding_mass_share(scene, i, 0.0));
  }
}

void strut_setup_at_rest(const strut_setup *setup, strut_number_sink *sink, void *context) {
  enum { AT_REST, OF_RUNS, BY_HAND };
  static const int rest[] = {
#define REST_OF(KIND, word, things, object, array, count, rest, ...) rest,
      STRUT_THINGS(REST_OF)};
  const strut_scene *scene = &setup->scene;
  const strut_search *search = &setup->experiment.search;
  const numbers to = {sink, context};
  put_section(&to, STRUT_FIELDS_SCENE, scene, sizeof *scene);
  put_section(&to, STRUT_FIELDS_RAYLEIGH, scene, sizeof *scene);
  put_section(&to, STRUT_FIELDS_GROUND, &scene->ground, sizeof scene->ground);
  put_section(&to, STRUT_FIELDS_SETTLE, &setup->experiment.settle, sizeof setup->experiment.settle);
  put_section(&to, STRUT_FIELDS_EQUILIBRIA, search, sizeof *search);
  for (strut_thing kind = 0; kind < STRUT_THING_COUNT; kind++) {
    size_t count = rest[kind] == AT_REST ? strut_thing_count(scene, kind) : 0;
    if (rest[kind] == AT_REST) put(&to, (double)count);
    for (size_t i = 0; i < count; i++) put_thing(&to, kind, strut_thing_object(scene, kind, i));
  }
  put_configurations(&to, scene);
  for (size_t i = 0; i < scene->load_count; i++) /* those with a signal are off at rest */
    if (scene->loads[i].signal < 0) put_thing(&to, STRUT_THING_LOAD, &scene->loads[i]);
  put_moved(&to, scene);
}
