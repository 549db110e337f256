/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/scene/channels.h"

#include <assert.h>
#include <string.h>

#include "engine/scene/scene.h"

/* Names of components, as those of an axis and as those of the columns of a table. */
#define ENERGY_NAME(name, kind, label) #name,
static const char *const one[] = {""}, *const axes[] = {"x", "y"}, *const rates[] = {"vx", "vy"},
                         *const reactions[] = {"normal", "friction"},
                         *const energies[] = {STRUT_ENERGY_TABLE(ENERGY_NAME)};

#define CHANNEL_NAME(NAME, name, ...) #name,
static const char *const names[] = {STRUT_CHANNEL_TABLE(CHANNEL_NAME)};

/* Four fields of a row: number, axis, names, names of columns. */
#define COUNT(list) (sizeof(list) / sizeof(list)[0])
#define SINGLE(NAME) 1, "axis", one, &names[STRUT_CHANNEL_PLACE_##NAME]
#define POSITIONS(NAME) COUNT(axes), "axis", axes, axes
#define VELOCITIES(NAME) COUNT(axes), "axis", axes, rates
#define REACTIONS(NAME) COUNT(reactions), "contact_component", reactions, reactions
#define ENERGIES(NAME) COUNT(energies), "energy_component", energies, energies

#define WITHOUT_TOTAL false
#define WITH_TOTAL true
#define CHANNEL_ROW(NAME, name, unit, OWNER, COMPONENTS, TOTAL, text)                              \
  {STRUT_CHANNEL_##NAME, #name, unit, STRUT_OWNER_##OWNER, COMPONENTS(NAME), TOTAL},
static const strut_channel_row rows[] = {STRUT_CHANNEL_TABLE(CHANNEL_ROW)};

#define OWNER_ROW(OWNER, things, axis, file) {things, axis, axis "_and_total", file},
static const strut_owner_row owners[] = {STRUT_CHANNEL_OWNERS(OWNER_ROW)};

static_assert(STRUT_CHANNEL_COUNT < 32, "channels are bits of an unsigned");

static bool is_of_system(const strut_channel_row *row) { return row->owner == STRUT_OWNER_SYSTEM; }

const strut_channel_row *strut_channel_at(size_t i) {
  for (int of_system = 0; of_system < 2; of_system++)
    for (size_t k = 0; k < STRUT_CHANNEL_COUNT; k++)
      if (is_of_system(&rows[k]) == (of_system == 1) && i-- == 0) return &rows[k];
  return NULL;
}

const strut_channel_row *strut_channel_row_of(strut_channel id) {
  size_t k = 0;
  while (rows[k].id != id) assert(k + 1 < STRUT_CHANNEL_COUNT), k++;
  return &rows[k];
}

const strut_channel_row *strut_channel_named(const char *name) {
  for (size_t k = 0; k < STRUT_CHANNEL_COUNT; k++)
    if (strcmp(names[k], name) == 0) return &rows[k];
  return NULL;
}

const strut_owner_row *strut_owner_row_of(strut_channel_owner owner) {
  assert(owner < STRUT_OWNER_COUNT);
  return &owners[owner];
}

size_t strut_owner_count(strut_channel_owner owner, const strut_scene *scene) {
  switch (owner) {
    case STRUT_OWNER_NODE: return scene->node_count;
    case STRUT_OWNER_MEMBER: return scene->member_count;
    case STRUT_OWNER_HINGE: return scene->hinge_count;
    case STRUT_OWNER_CELL: return scene->cell_count;
    case STRUT_OWNER_DISTANCE: return scene->distance_count;
    case STRUT_OWNER_CONTACT: return scene->contact_count;
    case STRUT_OWNER_SYSTEM:
    case STRUT_OWNER_COUNT: break;
  }
  return 1;
}

size_t strut_channel_items(const strut_channel_row *row, const strut_scene *scene) {
  return strut_owner_count(row->owner, scene) + (row->total ? 1 : 0);
}

const char *strut_owner_name(strut_channel_owner owner, const strut_scene *scene, size_t i) {
  switch (owner) {
    case STRUT_OWNER_NODE: return scene->nodes[i].name;
    case STRUT_OWNER_MEMBER: return scene->members[i].name;
    case STRUT_OWNER_HINGE: return scene->hinges[i].name;
    case STRUT_OWNER_CELL: return scene->cells[i].name;
    case STRUT_OWNER_DISTANCE: return scene->distances[i].name;
    case STRUT_OWNER_CONTACT: return strut_contact_name(scene, i);
    case STRUT_OWNER_SYSTEM:
    case STRUT_OWNER_COUNT: break;
  }
  return "total";
}

const char *strut_channel_item(const strut_channel_row *row, const strut_scene *scene, size_t i) {
  assert(i < strut_channel_items(row, scene));
  return i == strut_owner_count(row->owner, scene) ? "total"
                                                   : strut_owner_name(row->owner, scene, i);
}

size_t strut_channel_things(const strut_channel_row *row, const strut_scene *scene) {
  return is_of_system(row) ? row->components : strut_channel_items(row, scene);
}

const char *strut_channel_thing(const strut_channel_row *row, const strut_scene *scene, size_t i) {
  return is_of_system(row) ? row->component_names[i] : strut_channel_item(row, scene, i);
}
