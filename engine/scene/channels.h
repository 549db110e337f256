/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Channels: what a run can record over time.
 *
 * A row of STRUT_CHANNEL_TABLE and the function record_NAME of engine/run/channels.c are all that there is of a
 * channel. The language, recording, CSV, HDF5, pages, the library and Python loop over the table.
 */
#ifndef STRUT_ENGINE_SCENE_CHANNELS_H
#define STRUT_ENGINE_SCENE_CHANNELS_H

#include <stdbool.h>
#include <stddef.h>

#include "engine/base/status.h"

struct strut_scene;

/**
 * X(NAME, name, unit, OWNER, COMPONENTS, TOTAL, text): the channels in the order of their words in the key table.
 * OWNER is a row of STRUT_CHANNEL_OWNERS and COMPONENTS one of STRUT_CHANNEL_COMPONENTS. Of a channel WITH_TOTAL
 * the sum over all owners follows that of the last. The text says in the key's description of what it is.
 */
#define STRUT_CHANNEL_TABLE(X)                                                                     \
  X(POSITION, position, "m", NODE, POSITIONS, WITHOUT_TOTAL, "of nodes")                           \
  X(VELOCITY, velocity, "m/s", NODE, VELOCITIES, WITHOUT_TOTAL, "of nodes")                        \
  X(LENGTH, length, "m", MEMBER, SINGLE, WITHOUT_TOTAL, "of members")                              \
  X(FORCE, force, "N", MEMBER, SINGLE, WITHOUT_TOTAL, "of members, tension positive")              \
  X(CONTACT, contact, "N", CONTACT, REACTIONS, WITHOUT_TOTAL, "forces")                            \
  X(ENERGY, energy, "J", SYSTEM, ENERGIES, WITHOUT_TOTAL, "with works and losses")                 \
  X(ANGLE, angle, "rad", HINGE, SINGLE, WITHOUT_TOTAL, "of hinges")                                \
  X(MOMENT, moment, "N m", HINGE, SINGLE, WITHOUT_TOTAL, "of hinges")                              \
  X(AREA, area, "m^2", CELL, SINGLE, WITHOUT_TOTAL, "of cells")                                    \
  X(PRESSURE, pressure, "N/m", CELL, SINGLE, WITHOUT_TOTAL, "of cells")                            \
  X(ANGULAR_MOMENTUM, angular_momentum, "kg m^2/s", NODE, SINGLE, WITH_TOTAL,                      \
    "about the centre of mass")

/** X(OWNER, things, axis, file): their name in the plural, that of their axis in HDF5, and their CSV file. */
#define STRUT_CHANNEL_OWNERS(X)                                                                    \
  X(NODE, "nodes", "node", "nodes.csv")                                                            \
  X(MEMBER, "members", "member", "members.csv")                                                    \
  X(HINGE, "hinges", "hinge", "hinges.csv")                                                        \
  X(CELL, "cells", "cell", "cells.csv")                                                            \
  X(DISTANCE, "distances", "distance", "distances.csv")                                            \
  X(CONTACT, "contacts", "contact_node", "contacts.csv")                                           \
  X(SYSTEM, "energies", "system", "energy.csv")

/**
 * X(kind, label): energies, works and losses [J] in the order of all outputs, with what people read. Energies
 * are those at the end of a summary's duration; works and losses are over all of it.
 */
#define STRUT_ENERGY_TABLE(X)                                                                      \
  X(kinetic, ENERGY, "kinetic")                                                                    \
  X(elastic, ENERGY, "elastic")                                                                    \
  X(gravity, ENERGY, "gravity")                    /* zero at y = 0 (x = 0) */                     \
  X(contact, ENERGY, "ground springs")             /* elastic */                                   \
  X(drive_work, WORK, "drive work")                /* done on the structure by the actuators */    \
  X(load_work, WORK, "load work")                  /* by loads */                                  \
  X(belt_work, WORK, "belt work")                  /* by the moving ground */                      \
  X(support_work, WORK, "support work")            /* by supports that move */                     \
  X(dissipated_members, LOSSES, "lost in members") /* positive: lost */                            \
  X(dissipated_contact, LOSSES, "lost in contact")                                                 \
  X(dissipated_friction, LOSSES, "lost to friction")

#define STRUT_ENERGY_ONE(name, kind, label) +1
enum { STRUT_ENERGIES = STRUT_ENERGY_TABLE(STRUT_ENERGY_ONE) };
#undef STRUT_ENERGY_ONE

enum {
#define STRUT_CHANNEL_PLACE(NAME, ...) STRUT_CHANNEL_PLACE_##NAME,
  STRUT_CHANNEL_TABLE(STRUT_CHANNEL_PLACE)
#undef STRUT_CHANNEL_PLACE
      STRUT_CHANNEL_COUNT
};

/** Bits of a set of channels. */
typedef enum strut_channel {
#define STRUT_CHANNEL_BIT(NAME, ...) STRUT_CHANNEL_##NAME = 1 << STRUT_CHANNEL_PLACE_##NAME,
  STRUT_CHANNEL_TABLE(STRUT_CHANNEL_BIT)
#undef STRUT_CHANNEL_BIT
} strut_channel;

/** The key's words, "position|velocity|...", and its description. */
#define STRUT_CHANNEL_WORD(NAME, name, ...) "|" #name
#define STRUT_CHANNEL_WORDS (&("" STRUT_CHANNEL_TABLE(STRUT_CHANNEL_WORD))[1])
#define STRUT_CHANNEL_SENTENCE(NAME, name, unit, OWNER, COMPONENTS, TOTAL, text)                   \
  " `" #name "` " text " [" unit "];"
#define STRUT_CHANNEL_DESCRIPTION                                                                  \
  "Channels to record:" STRUT_CHANNEL_TABLE(STRUT_CHANNEL_SENTENCE) " absent things are left out."

typedef enum strut_channel_owner {
#define STRUT_CHANNEL_OWNER(OWNER, ...) STRUT_OWNER_##OWNER,
  STRUT_CHANNEL_OWNERS(STRUT_CHANNEL_OWNER)
#undef STRUT_CHANNEL_OWNER
      STRUT_OWNER_COUNT
} strut_channel_owner;

typedef struct strut_owner_row {
  const char *things, *axis, *axis_with_total, *file;
} strut_owner_row;

typedef struct strut_channel_row {
  strut_channel id;
  const char *name, *unit;
  strut_channel_owner owner;
  size_t components;
  const char *component_axis;         /* name of the components' axis in HDF5 */
  const char *const *component_names; /* (components) "x", "normal", ...; "" of a single one */
  const char *const
      *column_names; /* (components) those of a table's columns: "vx", "length", ... */
  bool total;        /* the sum over all owners follows as a further one */
} strut_channel_row;

/** The i-th channel in the order in which they are recorded, those of the whole system last; NULL behind it. */
STRUT_API const strut_channel_row *strut_channel_at(size_t i);
/** The channel of that bit. */
STRUT_API const strut_channel_row *strut_channel_row_of(strut_channel id);
/** The channel of that name, or NULL. */
STRUT_API const strut_channel_row *strut_channel_named(const char *name);
STRUT_API const strut_owner_row *strut_owner_row_of(strut_channel_owner owner);
/** Number and names of what the scene has of a kind; 1 and "total" of the system. */
STRUT_API size_t strut_owner_count(strut_channel_owner owner, const struct strut_scene *scene);
STRUT_API const char *strut_owner_name(strut_channel_owner owner, const struct strut_scene *scene,
                                       size_t i);
/** Number of a channel's items: things of the scene, and the total; 1 for the system. */
STRUT_API size_t strut_channel_items(const strut_channel_row *row, const struct strut_scene *scene);
/** Name of the i-th item; the scene's, or "total". */
STRUT_API const char *strut_channel_item(const strut_channel_row *row,
                                         const struct strut_scene *scene, size_t i);
/** Number and names of what people see as the columns of a channel: items, but components of the system's. */
STRUT_API size_t strut_channel_things(const strut_channel_row *row,
                                      const struct strut_scene *scene);
STRUT_API const char *strut_channel_thing(const strut_channel_row *row,
                                          const struct strut_scene *scene, size_t i);

#endif
