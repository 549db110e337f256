/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Channels: what a run can record over time. Each is one or more observables of all that their owner has.
 *
 * An observable that is RECORDED is a channel by its name. Those that have other names in C, or several observables,
 * are rows of STRUT_CHANNEL_TABLE.
 */
#pragma once

#include <stdbool.h>

#include "engine/scene/observables.h"

struct strut_scene;

/**
 * X(NAME, name, FIRST, COMPONENTS, TOTAL, text): the channels that C knows by name. FIRST is the first of their
 * observables and COMPONENTS one of STRUT_CHANNEL_COMPONENTS. Of a channel WITH_TOTAL the sum over all owners follows
 * that of the last.
 */
#define STRUT_CHANNEL_TABLE(X)                                                                     \
  X(POSITION, position, NODE_X, POSITIONS, WITHOUT_TOTAL, "of nodes [m]")                          \
  X(VELOCITY, velocity, NODE_VX, VELOCITIES, WITHOUT_TOTAL, "of nodes [m/s]")                      \
  X(LENGTH, length, LENGTH, SINGLE, WITHOUT_TOTAL, "of members [m]")                               \
  X(FORCE, force, FORCE, SINGLE, WITHOUT_TOTAL, "of members, tension positive [N]")                \
  X(CONTACT, contact, NORMAL, REACTIONS, WITHOUT_TOTAL, "forces [N]")                              \
  X(ENERGY, energy, KINETIC, ENERGIES, WITHOUT_TOTAL, "with works and losses [J]")                 \
  X(ANGLE, angle, HINGE_ANGLE, SINGLE, WITHOUT_TOTAL, "of hinges [rad]")                           \
  X(MOMENT, moment, MOMENT, SINGLE, WITHOUT_TOTAL, "of hinges [N m]")                              \
  X(AREA, area, CELL_AREA, SINGLE, WITHOUT_TOTAL, "of cells [m^2]")                                \
  X(PRESSURE, pressure, PRESSURE, SINGLE, WITHOUT_TOTAL, "of cells [N/m]")                         \
  X(ANGULAR_MOMENTUM, angular_momentum, NODE_SPIN, SINGLE, WITH_TOTAL,                             \
    "about the centre of mass [kg m^2/s]")

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

/* Something for each observable that is a channel of its own. */
#define STRUT_OF_RECORDED(...) __VA_ARGS__
#define STRUT_OF_PART(...)
#define STRUT_OF_UNRECORDED(...)

enum {
#define STRUT_CHANNEL_PLACE(NAME, ...) STRUT_CHANNEL_PLACE_##NAME,
#define STRUT_CHANNEL_OWN_PLACE(ID, OWNER, NAME, word, DIMENSION, NEED, RECORD, ...)               \
  STRUT_OF_##RECORD(STRUT_CHANNEL_PLACE_OF_##ID, )
  STRUT_CHANNEL_TABLE(STRUT_CHANNEL_PLACE) STRUT_OBSERVABLES(STRUT_CHANNEL_OWN_PLACE)
      STRUT_CHANNEL_COUNT
};

/** A set of channels, and one of them: bit k is that of place k. */
typedef uint64_t strut_channels;

enum {
#define STRUT_CHANNEL_BIT(NAME, ...) STRUT_CHANNEL_##NAME = 1 << STRUT_CHANNEL_PLACE_##NAME,
  STRUT_CHANNEL_TABLE(STRUT_CHANNEL_BIT)
};

/** The key's words, "position|velocity|...", and its description. */
#define STRUT_CHANNEL_WORD(NAME, name, ...) "|" #name
#define STRUT_CHANNEL_OWN_WORD(ID, OWNER, NAME, word, DIMENSION, NEED, RECORD, ...)                \
  STRUT_OF_##RECORD("|" NAME)
#define STRUT_CHANNEL_WORDS                                                                        \
  (&("" STRUT_CHANNEL_TABLE(STRUT_CHANNEL_WORD) STRUT_OBSERVABLES(STRUT_CHANNEL_OWN_WORD))[1])
#define STRUT_CHANNEL_SENTENCE(NAME, name, FIRST, COMPONENTS, TOTAL, text) " `" #name "` " text ";"
#define STRUT_CHANNEL_UNIT(unit, ...) unit
#define STRUT_CHANNEL_OWN_SENTENCE(ID, OWNER, NAME, word, DIMENSION, NEED, RECORD, SENSE, text)    \
  STRUT_OF_##RECORD(" `" NAME "` " text " [" STRUT_DIMENSION_##DIMENSION(STRUT_CHANNEL_UNIT) "];")
#define STRUT_CHANNEL_DESCRIPTION                                                                  \
  "Channels to record:" STRUT_CHANNEL_TABLE(STRUT_CHANNEL_SENTENCE)                                \
      STRUT_OBSERVABLES(STRUT_CHANNEL_OWN_SENTENCE) " absent things are left out."

typedef struct strut_channel_row {
  strut_channels id;
  const char *name, *unit;
  strut_channel_owner owner; /* the table that it is in */
  strut_column_kind first;   /* observable of the first component; those of others follow */
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
STRUT_API const strut_channel_row *strut_channel_row_of(strut_channels id);
/** The channel of that name, or NULL. */
STRUT_API const strut_channel_row *strut_channel_named(const char *name);
/** Is it of the whole structure, so that people see its components as columns? */
STRUT_API bool strut_channel_is_whole(const strut_channel_row *row);
/** Number and names of what the scene has of a kind; 1 and "total" of the system. */
STRUT_API size_t strut_owner_count(strut_channel_owner owner, const struct strut_scene *scene);
STRUT_API const char *strut_owner_name(strut_channel_owner owner, const struct strut_scene *scene,
                                       size_t i);
/** The index in the scene of the i-th of a kind: signals without names are not counted. */
STRUT_API size_t strut_owner_index(strut_channel_owner owner, const struct strut_scene *scene,
                                   size_t i);
/** Number of a channel's items: things of the scene, and the total; 1 for the system. */
STRUT_API size_t strut_channel_items(const strut_channel_row *row, const struct strut_scene *scene);
/** Name of the i-th item; the scene's, or "total". */
STRUT_API const char *strut_channel_item(const strut_channel_row *row,
                                         const struct strut_scene *scene, size_t i);
/** Unit of the i-th item: that of its sensor, signal or state, "SI" where it is not known; else the row's. */
STRUT_API const char *strut_channel_item_unit(const strut_channel_row *row,
                                              const struct strut_scene *scene, size_t i);
/** The unit that all items have; else that of the row. */
STRUT_API const char *strut_channel_unit(const strut_channel_row *row,
                                         const struct strut_scene *scene);
/** Number and names of what people see as the columns of a channel: items, but components of the system's. */
STRUT_API size_t strut_channel_things(const strut_channel_row *row,
                                      const struct strut_scene *scene);
STRUT_API const char *strut_channel_thing(const strut_channel_row *row,
                                          const struct strut_scene *scene, size_t i);
