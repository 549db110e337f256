/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/scene/channels.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/scene/signal_program.h"
#include "engine/scene/things.h"
#include "engine/scene/value_rows.h"

/* Unit and table of an observable, by its identifier. */
#define TABLE_OF_OWNER(OWNER, THING, TABLE, ...) shown_in_##OWNER = STRUT_OWNER_##TABLE,
enum { STRUT_OWNERS(TABLE_OF_OWNER) };
#define FACTS(ID, OWNER, NAME, word, DIMENSION, ...)                                               \
  static const char unit_of_##ID[] = STRUT_DIMENSION_##DIMENSION(STRUT_CHANNEL_UNIT);              \
  enum { table_of_##ID = shown_in_##OWNER };
STRUT_OBSERVABLES(FACTS)

#define POWERS(unit, kg, m, s, angle) kg, m, s, angle
#define OBSERVABLE(ID, OWNER, NAME, word, DIMENSION, NEED, RECORD, SENSE, text)                    \
  {NAME,                                                                                           \
   word,                                                                                           \
   unit_of_##ID,                                                                                   \
   text,                                                                                           \
   STRUT_OWNER_##OWNER,                                                                            \
   STRUT_DIMENSION_##DIMENSION(POWERS),                                                            \
   STRUT_OBSERVED_##NEED,                                                                          \
   STRUT_OBSERVED_##RECORD,                                                                        \
   STRUT_OBSERVED_##SENSE},
static const strut_observable observables[] = {STRUT_OBSERVABLES(OBSERVABLE)};

const strut_observable *strut_observable_at(strut_column_kind kind) {
  assert(kind < STRUT_COLUMN_COUNT);
  return &observables[kind];
}

const char *strut_observable_unsensed(strut_column_kind kind) {
#define REASON(HOW, reason) reason,
  static const char *const reasons[] = {STRUT_OBSERVED_SENSES(REASON)};
  return reasons[strut_observable_at(kind)->sense];
}

/* Names of components, as those of an axis and as those of the columns of a table. */
#define ENERGY_NAME(name, kind, label) #name,
static const char *const one[] = {""}, *const axes[] = {"x", "y"},
                         *const energies[] = {STRUT_ENERGY_TABLE(ENERGY_NAME)};
/* That of a single one: of the structure its name, of a thing what stands behind the dot. */
#define COLUMN_NAME(ID, OWNER, NAME, word, ...)                                                    \
  STRUT_OWNER_##OWNER >= STRUT_OWNER_SYSTEM ? NAME : word,
static const char *const columns[] = {STRUT_OBSERVABLES(COLUMN_NAME)};

/* Four fields of a row: number, axis, names, names of columns. */
#define COUNT(list) (sizeof(list) / sizeof(list)[0])
#define SINGLE(FIRST) 1, "axis", one, &columns[STRUT_COLUMN_##FIRST]
#define POSITIONS(FIRST) COUNT(axes), "axis", axes, &columns[STRUT_COLUMN_##FIRST]
#define VELOCITIES POSITIONS
#define REACTIONS(FIRST)                                                                           \
  2, "contact_component", &columns[STRUT_COLUMN_##FIRST], &columns[STRUT_COLUMN_##FIRST]
#define ENERGIES(FIRST) COUNT(energies), "energy_component", energies, energies

#define WITHOUT_TOTAL false
#define WITH_TOTAL true
#define ROW(PLACE, name, FIRST, COMPONENTS, TOTAL)                                                 \
  {(strut_channels)1 << STRUT_CHANNEL_PLACE_##PLACE,                                               \
   name,                                                                                           \
   unit_of_##FIRST,                                                                                \
   (strut_channel_owner)table_of_##FIRST,                                                          \
   STRUT_COLUMN_##FIRST,                                                                           \
   COMPONENTS(FIRST),                                                                              \
   TOTAL},
#define CHANNEL_ROW(NAME, name, FIRST, COMPONENTS, TOTAL, text)                                    \
  ROW(NAME, #name, FIRST, COMPONENTS, TOTAL)
#define OWN_ROW(ID, OWNER, NAME, word, DIMENSION, NEED, RECORD, ...)                               \
  STRUT_OF_##RECORD(ROW(OF_##ID, NAME, ID, SINGLE, false))
static const strut_channel_row rows[] = {STRUT_CHANNEL_TABLE(CHANNEL_ROW)
                                             STRUT_OBSERVABLES(OWN_ROW)};

#define OWNER_ROW(OWNER, THING, TABLE, group, phrase, things, axis, file)                          \
  {STRUT_OWNER_##TABLE, group, phrase, things, axis, axis "_and_total", file},
static const strut_owner_row owners[] = {STRUT_OWNERS(OWNER_ROW)};

static_assert(STRUT_CHANNEL_COUNT <= 64, "channels are bits of strut_channels");

bool strut_channel_is_whole(const strut_channel_row *row) {
  return row->owner >= STRUT_OWNER_SYSTEM;
}

const strut_channel_row *strut_channel_at(size_t i) {
  for (int of_system = 0; of_system < 2; of_system++)
    for (size_t k = 0; k < STRUT_CHANNEL_COUNT; k++)
      if (strut_channel_is_whole(&rows[k]) == (of_system == 1) && i-- == 0) return &rows[k];
  return NULL;
}

const strut_channel_row *strut_channel_row_of(strut_channels id) {
  size_t k = 0;
  while (rows[k].id != id) assert(k + 1 < STRUT_CHANNEL_COUNT), k++;
  return &rows[k];
}

const strut_channel_row *strut_channel_named(const char *name) {
  for (size_t k = 0; k < STRUT_CHANNEL_COUNT; k++)
    if (strcmp(rows[k].name, name) == 0) return &rows[k];
  return NULL;
}

const strut_owner_row *strut_owner_row_of(strut_channel_owner owner) {
  assert(owner < STRUT_OWNER_COUNT);
  return &owners[owner];
}

static bool is_named(const strut_scene *scene, strut_thing thing, size_t i) {
  const char *name = strut_thing_name(scene, thing, i);
  return name && *name;
}

size_t strut_owner_index(strut_channel_owner owner, const strut_scene *scene, size_t i) {
  if (owner != STRUT_OWNER_SIGNAL) return i;
  size_t k = 0, count = scene->signal_count;
  while (k < count && !(is_named(scene, STRUT_THING_SIGNAL, k) && i-- == 0)) k++;
  return k;
}

size_t strut_owner_count(strut_channel_owner owner, const strut_scene *scene) {
  strut_thing thing = strut_thing_of_owner(owner);
  if (owner == STRUT_OWNER_CONTACT) return scene->contact_count;
  if (thing == STRUT_THING_COUNT) return 1;
  size_t count = 0, all = strut_thing_count(scene, thing);
  if (owner != STRUT_OWNER_SIGNAL) return all;
  for (size_t i = 0; i < all; i++) count += is_named(scene, thing, i);
  return count;
}

size_t strut_channel_items(const strut_channel_row *row, const strut_scene *scene) {
  if (row->first == STRUT_COLUMN_LEAST_GAP && !scene->collision_count) return 0;
  return strut_owner_count(row->owner, scene) + (row->total ? 1 : 0);
}

const char *strut_owner_name(strut_channel_owner owner, const strut_scene *scene, size_t i) {
  if (owner == STRUT_OWNER_CONTACT) return strut_contact_name(scene, i);
  strut_thing thing = strut_thing_of_owner(owner);
  return thing == STRUT_THING_COUNT
             ? "total"
             : strut_thing_name(scene, thing, strut_owner_index(owner, scene, i));
}

const char *strut_channel_item(const strut_channel_row *row, const strut_scene *scene, size_t i) {
  assert(i < strut_channel_items(row, scene));
  return i == strut_owner_count(row->owner, scene) ? "total"
                                                   : strut_owner_name(row->owner, scene, i);
}

/* By the second. */
static const char *unit_of_rate(const char *unit) {
  static const char *const rates[][2] = {{"m", "m/s"}, {"rad", "rad/s"}, {"m^2", "m^2/s"}};
  for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++)
    if (strcmp(unit, rates[i][0]) == 0) return rates[i][1];
  return "SI";
}

const char *strut_channel_item_unit(const strut_channel_row *row, const strut_scene *scene,
                                    size_t i) {
  const char *unit = row->unit;
  const size_t at = strut_owner_index(row->owner, scene, i);
  if (row->owner == STRUT_OWNER_SENSOR)
    unit = strut_observable_at(strut_sensor_column(&scene->sensors[at]).kind)->unit;
  if (row->owner == STRUT_OWNER_SIGNAL && scene->signals[at].unit) unit = scene->signals[at].unit;
  if (row->owner == STRUT_OWNER_STATE) unit = scene->states[at].unit ? scene->states[at].unit : "1";
  return row->first == STRUT_COLUMN_SENSOR_RATE ? unit_of_rate(unit) : unit;
}

const char *strut_channel_unit(const strut_channel_row *row, const strut_scene *scene) {
  const char *unit = NULL;
  for (size_t i = 0; i < strut_owner_count(row->owner, scene); i++) {
    const char *own = strut_channel_item_unit(row, scene, i);
    if (unit && strcmp(own, unit) != 0) return row->unit;
    unit = own;
  }
  return unit ? unit : row->unit;
}

size_t strut_channel_things(const strut_channel_row *row, const strut_scene *scene) {
  return strut_channel_is_whole(row) ? row->components : strut_channel_items(row, scene);
}

const char *strut_channel_thing(const strut_channel_row *row, const strut_scene *scene, size_t i) {
  return strut_channel_is_whole(row) ? row->column_names[i] : strut_channel_item(row, scene, i);
}

/* ---- rows of results ---- */

const strut_value_row *strut_value_at(const strut_value_rows *table, const char *path,
                                      const strut_result_object *of, strut_value *value) {
  strut_value values[STRUT_MOST_VALUES];
  size_t length = strcspn(path, ".");
  assert(table->count <= STRUT_MOST_VALUES);
  if (of) table->fill(of, values);
  for (size_t i = 0; i < table->count; i++) {
    const strut_value_row *row = &table->row[i];
    if (!row->key || strncmp(row->key, path, length) != 0 || row->key[length]) continue;
    if (of) *value = values[i];
    if (!path[length]) return row;
    strut_result_object part = {of ? values[i].items : NULL, of, of ? of->scene : NULL, 0};
    return strut_value_at(row->rows, path + length + 1,
                          of && values[i].kind == STRUT_VALUE_PART ? &part : NULL, value);
  }
  return NULL;
}

const char *strut_name_of_parameter(const strut_result_object *of, size_t i) {
  return of->scene->parameters[i].name;
}

strut_value strut_value_of_parameter(const strut_result_object *of, size_t i) {
  const strut_parameter *parameter = &of->scene->parameters[i];
  return isnan(parameter->value) ? STRUT_VALUE_AS_TEXT(parameter->text)
                                 : STRUT_VALUE_AS_NUMBER(parameter->value);
}
