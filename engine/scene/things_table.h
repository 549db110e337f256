/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The things of a scene as tables: their kinds, and the fields of each, with name, type, range, default,
 * meaning, and where the value is kept. What follows from them: the keys of the language with their
 * reader, writer, reference page and schema (parser/language/keys/keys.h), the checks of ranges, and the
 * numbers by which an answer is known (things.h). Nothing else repeats what a row says.
 *
 * A row is X(section, id, name, type, measure, range, default, need, set, words, field, description).
 * A section is a mapping of the language; the columns up to `words` are explained in
 * parser/language/keys/keys_table.h. field says where the value is kept:
 *
 *   FIELD(object, member)                    a number, pair, word, text or signal
 *   REFERENCE(object, member, KIND)          the index of a thing, or an array of them; -1: none
 *   LIST(object, member, count)              numbers, points, texts, sets of nodes or a program, in memory of their own
 *   REFERENCES(object, member, count, KIND)  likewise of indices
 *   NUMBERS(object, member)                  an array of numbers
 *   NESTED(object, member, SECTION)          a mapping of that section, kept in an object within this one
 *   SECTION(SECTION)                         a mapping whose keys have rows of their own
 *   THINGS(SECTION)                          a mapping of names to things that have the keys of the section
 *   CURVE(object, x, y, count)               points in two arrays of numbers
 *   PATH(object, ends, guides, count)        nodes along a path: its two ends, and those between them in memory of their own
 *   DIRECTION(object, member)                x, y or an angle
 *   PLACES(object, member)                   positions of all nodes, of which those that are not as drawn are written
 *   UNIT(object, member, unit)               a number and the text of its unit, NULL or "1": none
 *   SELF(object, SECTION)                    a mapping of that section, kept in the object itself
 *   CHOICE(object, tag, value, field)        one of several keys: it also sets `tag` to `value`
 *   AMONG(object, tag, value, last, field)   one that belongs to tags from `value` to `last`, which others set
 *   FROM(value, field)                       a word, of which the first means `value`
 *   TURNS(field)                             an angle that is kept in turns
 *   LATER(field)                             the section's reader reads it, as what has the measure CONTEXT
 *   OF_RUNS(field)                           what is at rest does not depend on it
 *   NONE                                     nothing is kept
 *   BY_HAND                                  the section's reader and writer have code for the key
 *
 * All but BY_HAND are read and written by rows alone, unless their measure is CONTEXT: the unit of such
 * numbers is known to the section's reader.
 */
#pragma once

#include <math.h>

#include "engine/scene/channels.h"

#include "engine/base/text.h"
#include "engine/scene/experiment.h"

/* clang-format off */

/**
 * X(KIND, word, things, object, array, count, rest, defaults...): the kinds of which a scene has arrays, in the
 * order in which names are checked. rest: AT_REST where what is at rest depends on them; OF_RUNS where it does
 * not; BY_HAND where it depends on what follows from their numbers (things.c). defaults: where not zero.
 */
#define STRUT_THINGS(X) \
  X(NODE, "node", "nodes", strut_node, nodes, node_count, AT_REST, .name = "") \
  X(MEMBER, "member", "members", strut_member, members, member_count, AT_REST, .name = "", .node = {-1, -1}, .rest_kind = STRUT_REST_RATIO, .rest_value = 1.0) \
  X(HINGE, "hinge", "hinges", strut_hinge, hinges, hinge_count, AT_REST, .name = "", .node = {-1, -1, -1}, .rest_angle = (double)NAN) \
  X(CELL, "cell", "cells", strut_cell, cells, cell_count, AT_REST, .name = "", .law = STRUT_LAW_PRESSURE, .exponent = 1.4, .rest_area = (double)NAN) \
  X(COLLISION, "collision", "collisions", strut_collision, collisions, collision_count, AT_REST, .name = "", .node = {-1, -1}, .member = {-1, -1}) \
  X(DISTANCE, "distance", "distances", strut_distance_spring, distances, distance_count, AT_REST, .name = "", .node = {-1, -1}, .line = {-1, -1}, .rest_distance = (double)NAN) \
  X(FOOT, "foot", "feet", strut_foot, feet, foot_count, AT_REST, .name = "", .member = -1, .node = -1) \
  X(ACTUATOR, "actuator", "actuators", strut_actuator, actuators, actuator_count, OF_RUNS, .name = "", .member = -1, .signal = -1, .hinge = -1, .cell = -1) \
  X(LOAD, "load", "loads", strut_load, loads, load_count, BY_HAND, .name = "", .node = -1, .signal = -1, .hinge = -1, .member = -1) \
  X(UNBALANCE, "unbalance", "unbalances", strut_unbalance, unbalances, unbalance_count, AT_REST, .name = "", .node = -1, .signal = -1) \
  X(SLIDER, "slider", "sliders", strut_sliding_mass, sliding_masses, sliding_count, BY_HAND, .name = "", .member = -1, .signal = -1) \
  X(SIGNAL, "signal", "signals", strut_signal, signals, signal_count, OF_RUNS, .stop = (double)INFINITY) \
  X(SENSOR, "sensor", "sensors", strut_sensor, sensors, sensor_count, OF_RUNS, .name = "", .item = -1) \
  X(STATE, "state", "states", strut_internal_state, states, state_count, OF_RUNS, .name = "") \
  X(CONFIGURATION, "configuration", "configurations", strut_configuration, configurations, configuration_count, BY_HAND, .name = "") \
  X(GROUND, "ground", "grounds", strut_ground, grounds, ground_count, AT_REST, .name = "") \
  X(CONTACT, "contact", "contacts", strut_contact, contacts, contact_count, AT_REST, .node = -1)

/**
 * Fields that no key has for itself, each with the section whose objects have them: X(section, field).
 * tests/unit/things_test.py looks for a row of each member of these structs.
 */
#define STRUT_INNER_FIELDS(X) \
  X(NODE, FIELD(strut_node, start)) \
  X(MEMBER, REFERENCE(strut_member, node, NODE)) \
  X(MEMBER, REFERENCES(strut_member, guides, guide_count, NODE)) \
  X(CELL, FIELD(strut_cell, law)) \
  X(LAW, CHOICE(strut_law, source, STRUT_LAW_DATA_POINTS, CURVE(strut_law, x, force, count))) \
  X(GROUND, FIELD(strut_ground_section, ground.present)) \
  X(CONTACT, REFERENCE(strut_contact, node, NODE)) \
  X(CONTACT, REFERENCE(strut_contact, ground, GROUND)) \
  X(CONTACT, FIELD(strut_contact, piece)) \
  X(SETTLE, FIELD(strut_settle, wanted)) \
  X(SETTLE, FIELD(strut_settle, step))

#define STRUT_SCENE_FIELDS(X) \
  X(SCENE, VERSION, "strut", VERSION, NONE, ANY, "", REQUIRED, 0, "1", NONE, "Version of the language.") \
  X(SCENE, NAME, "name", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_scene, name), "Name of the scene, used in figures and tables.") \
  X(SCENE, DESCRIPTION, "description", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_scene, description), "What the scene shows.") \
  X(SCENE, SOURCE, "source", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_scene, source), "Where its numbers come from.") \
  X(SCENE, PARAMETERS, "parameters", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression or a quoted text", BY_HAND, "Named values for expressions, which `--set` may change.") \
  X(SCENE, DATA, "data", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of [data](#data)", THINGS(DATA), "Tables of measured data, for signals, laws and positions.") \
  X(SCENE, GROUPS, "groups", THINGS, NONE, ANY, "", OPTIONAL, 0, "keys of a member, a node, a contact or a hinge", NONE, "Defaults that members, nodes, contacts or hinges share. Own keys take precedence.") \
  X(SCENE, NODES, "nodes", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[x, y]` or the keys of a node", THINGS(NODE), "The points of the structure; required unless parts are placed. Under the name of a placed thing, as under `members` and the like, keys change that thing; `*` stands for one part of a name between dots.") \
  X(SCENE, MEMBERS, "members", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a member", THINGS(MEMBER), "The bars, springs and cables between the nodes.") \
  X(SCENE, HINGES, "hinges", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a hinge", THINGS(HINGE), "Springs of the angle between two arms that meet at a node.") \
  X(SCENE, CELLS, "cells", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a cell", THINGS(CELL), "Polygons of nodes under pressure.") \
  X(SCENE, PIPES, "pipes", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a pipe", THINGS(PIPE), "Flow of gas between cells.") \
  X(SCENE, COLLISIONS, "collisions", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a collision", THINGS(COLLISION), "Pairs of nodes and members that do not pass through each other.") \
  X(SCENE, DISTANCES, "distances", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a distance", THINGS(DISTANCE), "Springs of the distance between two nodes along a direction, or of a node from a line.") \
  X(SCENE, FEET, "feet", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a foot", THINGS(FOOT), "Circular arcs at ends of members, which roll on the ground.") \
  X(SCENE, BEAMS, "beams", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a beam", THINGS(BEAM), "Chains of bars and hinges that bend.") \
  X(SCENE, RAYLEIGH, "rayleigh", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(RAYLEIGH), "Damping of the whole structure by mass and by stiffness.") \
  X(SCENE, MASS_MODEL, "mass_model", WORD, NONE, ANY, "consistent", WRITTEN, 0, "consistent|lumped", FIELD(strut_scene, mass_model), "How a member's mass acts: `consistent` as that of a uniform rod (the paper's model), `lumped` as half of it at each end.") \
  X(SCENE, BARS, "bars", WORD, NONE, ANY, "elastic", OPTIONAL, 0, "elastic|rigid", FIELD(strut_scene, bar_model), "`rigid` bars keep, during a run, the length they have at its start; their stiffness and damping then count only while the structure settles.") \
  X(SCENE, GRAVITY, "gravity", PAIR, ACCELERATION, ANY, "[0, 0]", WRITTEN, 0, "", FIELD(strut_scene, gravity), "Gravitational acceleration.") \
  X(SCENE, LATTICE, "lattice", FREE, NONE, ANY, "", OPTIONAL, 0, "one or two displacements, such as [[1 m, 0]]", BY_HAND, "Displacements by which the structure repeats without end, for `strut modes --wave`. A node at such a displacement from another is that node of the next cell.") \
  X(SCENE, GROUND, "ground", MAP, NONE, ANY, "", OPTIONAL, 1, "", SECTION(GROUND), "The line, profile or circle that nodes may touch. Without it there is no ground.") \
  X(SCENE, ACTUATORS, "actuators", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an actuator", THINGS(ACTUATOR), "Drives of rest lengths, rest angles and pressures, or added forces and moments. Several on one member add up.") \
  X(SCENE, LOADS, "loads", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a load", THINGS(LOAD), "Forces on nodes, moments on hinges and members.") \
  X(SCENE, UNBALANCES, "unbalances", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an unbalance", THINGS(UNBALANCE), "Masses that rotate about nodes.") \
  X(SCENE, SIGNALS, "signals", THINGS, NONE, ANY, "", OPTIONAL, 0, "a signal", THINGS(SIGNAL), "Named signals, for use in several places.") \
  X(SCENE, CONFIGURATIONS, "configurations", THINGS, NONE, ANY, "", OPTIONAL, 0, "`{NODE: [x, y], ...}` or the keys of a [configuration](#configuration)", THINGS(CONFIGURATION), "Named shapes, to start from and to name equilibria. Nodes that are not listed stay as drawn.") \
  X(SCENE, INITIAL, "initial", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(INITIAL), "The state at t = 0; by default the drawn shape at rest.") \
  X(SCENE, EQUILIBRIA, "equilibria", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(EQUILIBRIA), "Settings of the search for equilibria.") \
  X(SCENE, PATH, "path", FREE, NONE, ANY, "", OPTIONAL, 0, "the keys of a [path in stages](#path-in-stages)", SECTION(SCENE_PATH), "What `strut path` follows by default, in stages.") \
  X(SCENE, SOLVER, "solver", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(SOLVER), "Method, time step and accuracy. Required for a run.") \
  X(SCENE, RUN, "run", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(RUN), "Duration and measurement. Required for a run.") \
  X(SCENE, OUTPUT, "output", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(OUTPUT), "What a run records.") \
  X(SCENE, GROUNDS, "grounds", THINGS, NONE, ANY, "", OPTIONAL, 1, "the keys of [ground](#ground)", THINGS(GROUND), "Several grounds instead of `ground`: walls, profiles, circles. A node touches every ground that lists it.") \
  X(SCENE, SLIDERS, "sliders", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a slider", THINGS(SLIDER), "Point masses on members, which a signal may move along.") \
  X(SCENE, SENSORS, "sensors", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a sensor", THINGS(SENSOR), "Numbers of the motion, for the expressions of signals.") \
  X(SCENE, STATES, "states", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a state", THINGS(STATE), "Further numbers that a run integrates.") \
  X(SCENE, OSCILLATORS, "oscillators", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an oscillator", THINGS(OSCILLATOR), "Phase oscillators, each an internal state with the same name.") \
  X(SCENE, CONTROLLERS, "controllers", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a controller", THINGS(CONTROLLER), "PID controllers and relays, each a signal with the same name.") \
  X(SCENE, PARTS, "parts", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a part", THINGS(PART), "Pieces of structure, which `place` copies.") \
  X(SCENE, PLACE, "place", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a [place](#place)", THINGS(PLACE), "Copies of parts. Things in a copy are called `NAME.THING`, in repeated copies `NAME.0.THING` and so on.") \
  X(SCENE, MERGE, "merge", FREE, NONE, ANY, "", OPTIONAL, 0, "touching, or {node: other node, ...}", BY_HAND, "Pairs of nodes to merge, or `touching`: all nodes at the same place. Masses add, supports unite.") \
  X(SCENE, LIMIT_THINGS, "limit_things", NUMBER, NONE, WHOLE(1, STRUT_MOST_THINGS), "500000", OPTIONAL, 0, "", BY_HAND, "Largest number of nodes, members and other things in all copies of parts and in beams, and of contacts with a profile.") \
  X(SCENE, BASE, "base", TEXT, NONE, ANY, "", OPTIONAL, 0, "", NONE, "File of another scene, relative to this one, which the keys here change: mappings merge, other values are replaced, `NAME: remove` deletes.")

#define STRUT_NODE_FIELDS(X) \
  X(NODE, POSITION, "position", PAIR, LENGTH, ANY, "", REQUIRED, 0, "", FIELD(strut_node, position), "Position in the drawn shape.") \
  X(NODE, GROUP, "group", GROUPS, NONE, ANY, "", OPTIONAL, 0, "", NONE, "Groups that provide defaults; later groups take precedence.") \
  X(NODE, MASS, "mass", NUMBER, MASS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_node, mass), "Point mass, in addition to those of the members.") \
  X(NODE, FIXED, "fixed", FIXED, NONE, ANY, "none", OPTIONAL, 0, "none|x|y|both", FIELD(strut_node, fixed), "Supported directions; also as a list, `[x, y]`.") \
  X(NODE, MOVES, "moves", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Directions in which a signal moves the node and thereby supports it.")

#define STRUT_MOVES_FIELDS(X) \
  X(MOVES, ALONG_X, "x", SIGNAL, LENGTH, ANY, "", OPTIONAL, 0, "", FIELD(strut_moves, signal[0]), "Added to x of the node's position.") \
  X(MOVES, ALONG_Y, "y", SIGNAL, LENGTH, ANY, "", OPTIONAL, 0, "", FIELD(strut_moves, signal[1]), "Added to y of the node's position.")

#define STRUT_MEMBER_FIELDS(X) \
  X(MEMBER, GROUP, "group", GROUPS, NONE, ANY, "", OPTIONAL, 0, "", NONE, "Groups that provide defaults; later groups take precedence.") \
  X(MEMBER, NODES, "nodes", NODE_PATH, NONE, ANY, "", REQUIRED, 0, "", PATH(strut_member, node, guides, guide_count), "The two nodes that the member joins. A cable or spring may run over further nodes in between, its guides, `[a, p, q, b]`; it then has one force along its whole length, and its mass is lumped.") \
  X(MEMBER, KIND, "kind", WORD, NONE, ANY, "", REQUIRED, 0, "bar|spring|cable", FIELD(strut_member, kind), "Bars and springs carry tension and compression; a cable carries tension only, and no force while slack. `strut` means `bar`, `string` means `cable`.") \
  X(MEMBER, STIFFNESS, "stiffness", NUMBER, STIFFNESS, NOT_NEGATIVE, "0", OPTIONAL, 1, "", FIELD(strut_member, stiffness), "Force per elongation.") \
  X(MEMBER, AXIAL_STIFFNESS, "axial_stiffness", NUMBER, FORCE, NOT_NEGATIVE, "", OPTIONAL, 1, "", FIELD(strut_member, axial_stiffness), "EA; the stiffness is EA / rest length, also while an actuator changes the rest length.") \
  X(MEMBER, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 8, "", FIELD(strut_member, damping), "Force per rate of elongation.") \
  X(MEMBER, DAMPING_RATIO, "damping_ratio", NUMBER, NONE, NOT_NEGATIVE, "0", OPTIONAL, 8, "", FIELD(strut_member, damping_ratio), "Instead of `damping`: zeta in 2 zeta sqrt(c m), with the stiffness c at the rest length and 1/m = 1/m1 + 1/m2. The lumped masses m1 and m2 of the two ends, half of each member's, act along the drawn member; in a supported direction they are infinite.") \
  X(MEMBER, MASS, "mass", NUMBER, MASS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_member, mass), "Mass of the whole member.") \
  X(MEMBER, REST_LENGTH, "rest_length", NUMBER, LENGTH, NOT_NEGATIVE, "", OPTIONAL, 2, "", CHOICE(strut_member, rest_kind, STRUT_REST_LENGTH, FIELD(strut_member, rest_value)), "Length at which the member carries no force.") \
  X(MEMBER, REST_LENGTH_RATIO, "rest_length_ratio", NUMBER, NONE, NOT_NEGATIVE, "1", OPTIONAL, 2, "", CHOICE(strut_member, rest_kind, STRUT_REST_RATIO, FIELD(strut_member, rest_value)), "Rest length / drawn length.") \
  X(MEMBER, PRETENSION, "pretension", NUMBER, FORCE, ANY, "", OPTIONAL, 2, "", CHOICE(strut_member, rest_kind, STRUT_REST_PRETENSION, FIELD(strut_member, rest_value)), "Force in the drawn shape; tension is positive.") \
  X(MEMBER, FORCE_DENSITY, "force_density", NUMBER, STIFFNESS, ANY, "", OPTIONAL, 2, "", CHOICE(strut_member, rest_kind, STRUT_REST_FORCE_DENSITY, FIELD(strut_member, rest_value)), "Force in the drawn shape / drawn length.") \
  X(MEMBER, LAW, "law", LAW, FORCE, ANY, "linear", OPTIONAL, 0, "", NESTED(strut_member, law, LAW), "Force as a function of elongation, length - rest length. A cable carries tension only, under every law.") \
  X(MEMBER, SHORTEST, "shortest", NUMBER, LENGTH, NOT_NEGATIVE, "none", OPTIONAL, 0, "", FIELD(strut_member, shortest), "Length below which a stop pushes the ends apart.") \
  X(MEMBER, LONGEST, "longest", NUMBER, LENGTH, ABOVE_ZERO, "none", OPTIONAL, 0, "", FIELD(strut_member, longest), "Length beyond which a stop pulls the ends together.") \
  X(MEMBER, STOP_STIFFNESS, "stop_stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "a hundred times the stiffness", OPTIONAL, 0, "", FIELD(strut_member, stop_stiffness), "Stiffness of the stops.") \
  X(MEMBER, STOP_DAMPING, "stop_damping", NUMBER, DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_member, stop_damping), "Damping of a stop while it acts. A stop never holds its member back.") \
  X(MEMBER, MAXWELL, "maxwell", MAP, NONE, ANY, "", OPTIONAL, 0, "Maxwell branch", OF_RUNS(NESTED(strut_member, maxwell, MAXWELL)), "A spring and a dashpot in series, beside a bar or spring.") \
  X(MEMBER, BREAKS_AT, "breaks_at", NUMBER, FORCE, ABOVE_ZERO, "never", OPTIONAL, 0, "", OF_RUNS(FIELD(strut_member, breaks_at)), "Tension at which the member breaks. It then carries nothing for the rest of the run, and its stored energy is lost. Statics and settling treat it as whole.") \
  X(MEMBER, RELEASED_AT, "released_at", NUMBER, TIME, ABOVE_ZERO, "never", OPTIONAL, 0, "", OF_RUNS(FIELD(strut_member, released_at)), "Time from which the member carries nothing, like a released latch.") \
  X(MEMBER, GUIDE_FRICTION, "guide_friction", NUMBER, NONE, NOT_NEGATIVE, "0", OPTIONAL, 0, "", OF_RUNS(FIELD(strut_member, guide_friction)), "Friction coefficient mu of a running cable at its guides. At a guide where it turns by theta, the tensions differ by at most the factor exp(mu theta). Statics and settling ignore this friction, except paths that keep it.") \
  X(MEMBER, GUIDE_RADIUS, "guide_radius", NUMBER, LENGTH, ABOVE_ZERO, "points", OPTIONAL, 0, "", FIELD(strut_member, guide_radius), "Radius of the guides: circles about their nodes. The cable follows common tangents and wraps a circle while it is pulled against it, by at most three quarters of a turn.") \
  X(MEMBER, GUIDE_SIDE, "guide_side", WORD, NONE, ANY, "drawn", OPTIONAL, 0, "drawn|left|right", FIELD(strut_member, guide_side), "Side of the cable, from its first node to its last, on which the centres of circles lie. `drawn`: as the cable turns at each in the drawn shape.")

#define STRUT_HINGE_FIELDS(X) \
  X(HINGE, NODES, "nodes", NODE_TRIPLE, NONE, ANY, "", REQUIRED, 0, "", REFERENCE(strut_hinge, node, NODE), "Three nodes `[a, b, c]`. The hinge is at b; its angle leads counter-clockwise from arm b-a to arm b-c.") \
  X(HINGE, STIFFNESS, "stiffness", NUMBER, ANGULAR_STIFFNESS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_hinge, stiffness), "Moment per angle.") \
  X(HINGE, DAMPING, "damping", NUMBER, ANGULAR_DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_hinge, damping), "Moment per angular velocity.") \
  X(HINGE, REST_ANGLE, "rest_angle", NUMBER, ANGLE, ANY, "as drawn", OPTIONAL, 0, "", FIELD(strut_hinge, rest_angle), "Angle without moment. The angle of the hinge is continuous over whole turns, and at the start within half a turn of this one.") \
  X(HINGE, LAW, "law", LAW, MOMENT, ANY, "linear", OPTIONAL, 0, "", NESTED(strut_hinge, law, LAW), "Moment as a function of angle - rest angle.") \
  X(HINGE, BREAKS_AT, "breaks_at", NUMBER, MOMENT, ABOVE_ZERO, "never", OPTIONAL, 0, "", OF_RUNS(FIELD(strut_hinge, breaks_at)), "Size of the moment at which the hinge breaks. It then carries nothing.") \
  X(HINGE, RELEASED_AT, "released_at", NUMBER, TIME, ABOVE_ZERO, "never", OPTIONAL, 0, "", OF_RUNS(FIELD(strut_hinge, released_at)), "Time from which on the hinge has no moment.") \
  X(HINGE, GROUP, "group", GROUPS, NONE, ANY, "", OPTIONAL, 0, "", NONE, "Groups that provide defaults; later groups take precedence.")

#define STRUT_CELL_FIELDS(X) \
  X(CELL, NODES, "nodes", NODE_RING, NONE, ANY, "", REQUIRED, 0, "", REFERENCES(strut_cell, node, node_count, NODE), "The corners `[a, b, c, ...]` in order, in either sense, up to 32. They need no members between them.") \
  X(CELL, PRESSURE, "pressure", NUMBER, STIFFNESS, ANY, "", OPTIONAL, 7, "", CHOICE(strut_cell, law, STRUT_LAW_PRESSURE, FIELD(strut_cell, pressure)), "Given pressure, an outward force per length of the boundary; negative: suction. An actuator may change it.") \
  X(CELL, GAS, "gas", MAP, NONE, ANY, "", OPTIONAL, 7, "", AMONG(strut_cell, law, STRUT_LAW_ISOTHERMAL, STRUT_LAW_ISENTROPIC, LATER(SELF(strut_cell, GAS))), "A closed gas. Its pressure follows from the area.") \
  X(CELL, STIFFNESS, "stiffness", NUMBER, AREA_STIFFNESS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_cell, stiffness), "Elastic cell, instead of a pressure or gas: pressure per loss of area.") \
  X(CELL, DAMPING, "damping", NUMBER, AREA_DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_cell, damping), "Elastic cell: pressure per rate of loss of area.") \
  X(CELL, REST_AREA, "rest_area", NUMBER, AREA, ABOVE_ZERO, "as drawn", OPTIONAL, 0, "", FIELD(strut_cell, rest_area), "Elastic cell: area without pressure.") \
  X(CELL, LAW, "law", LAW, PRESSURE, ANY, "linear", OPTIONAL, 0, "", NESTED(strut_cell, elastic, LAW), "Elastic cell: minus the pressure as a function of area - rest area. With `compression_only` it only resists compression.")

#define STRUT_GAS_FIELDS(X) \
  X(GAS, KIND, "kind", WORD, NONE, ANY, "", REQUIRED, 0, "isothermal|isentropic", FROM(STRUT_LAW_ISOTHERMAL, FIELD(strut_cell, law)), "With the area A, and A0 as drawn: `isothermal`, p = pressure * A0 / A; `isentropic`, p = pressure * (A0 / A)^exponent.") \
  X(GAS, PRESSURE, "pressure", NUMBER, STIFFNESS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_cell, pressure), "Absolute pressure as drawn.") \
  X(GAS, EXPONENT, "exponent", NUMBER, NONE, ABOVE_ZERO, "1.4", OPTIONAL, 0, "", FIELD(strut_cell, exponent), "Isentropic exponent, above 1.") \
  X(GAS, OUTSIDE, "outside", NUMBER, STIFFNESS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_cell, outside), "Absolute pressure outside.")

#define STRUT_COLLISION_FIELDS(X) \
  X(COLLISION, NODE, "node", NAME, NONE, ANY, "", OPTIONAL, 0, "", CHOICE(strut_collision, node[1], UINT32_MAX, REFERENCE(strut_collision, node[0], NODE)), "A node that may touch the `member`.") \
  X(COLLISION, MEMBER, "member", NAME, NONE, ANY, "", OPTIONAL, 8, "", CHOICE(strut_collision, member[1], UINT32_MAX, REFERENCE(strut_collision, member[0], MEMBER)), "The member that the `node` may touch: a straight rod with round ends.") \
  X(COLLISION, NODES, "nodes", NAME_PAIR, NONE, ANY, "", OPTIONAL, 8, "", REFERENCE(strut_collision, node, NODE), "Two nodes that may touch each other as discs.") \
  X(COLLISION, MEMBERS, "members", NAME_PAIR, NONE, ANY, "", OPTIONAL, 8, "", REFERENCE(strut_collision, member, MEMBER), "Two members that may touch each other. This stands for four collisions of an end with the other rod.") \
  X(COLLISION, BETWEEN, "between", FREE, NONE, ANY, "", OPTIONAL, 8, "all, a group of members, or two of these", NONE, "Every two straight members of all, of a group, or one of each of two groups. Pairs that share a node, cross, or are nearer than the thickness as drawn are left out. The collisions are called `NAME_FIRST_SECOND`.") \
  X(COLLISION, THICKNESS, "thickness", NUMBER, LENGTH, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_collision, thickness), "Distance of the two axes or centres at contact.") \
  X(COLLISION, STIFFNESS, "stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_collision, stiffness), "Force per depth.") \
  X(COLLISION, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_collision, damping), "Force per speed of approach in contact. A collision never pulls.") \
  X(COLLISION, FRICTION, "friction", MAP, NONE, ANY, "", OPTIONAL, 0, "friction", OF_RUNS(NESTED(strut_collision, friction, RUBBING)), "Friction between the two.")

#define STRUT_DISTANCE_FIELDS(X) \
  X(DISTANCE, NODES, "nodes", NAME_PAIR, NONE, ANY, "", OPTIONAL, 8, "", REFERENCE(strut_distance_spring, node, NODE), "Two nodes `[a, b]`. The distance is that of b from a in the direction `along`; it may be negative.") \
  X(DISTANCE, ALONG, "along", FREE, NONE, ANY, "", OPTIONAL, 0, "x, y, or an angle from +x", CHOICE(strut_distance_spring, line[0], UINT32_MAX, DIRECTION(strut_distance_spring, along)), "Direction of the distance between two nodes. It turns with a copy of a part.") \
  X(DISTANCE, NODE, "node", NAME, NONE, ANY, "", OPTIONAL, 8, "", CHOICE(strut_distance_spring, node[1], UINT32_MAX, REFERENCE(strut_distance_spring, node[0], NODE)), "The node whose distance from the `line` counts.") \
  X(DISTANCE, LINE, "line", NAME_PAIR, NONE, ANY, "", OPTIONAL, 0, "", REFERENCE(strut_distance_spring, line, NODE), "Two nodes `[a, b]`. The distance is that of the `node` from the straight line through them, positive to the left of the direction from a to b.") \
  X(DISTANCE, STIFFNESS, "stiffness", NUMBER, STIFFNESS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_distance_spring, stiffness), "Force per distance.") \
  X(DISTANCE, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_distance_spring, damping), "Force per rate of the distance.") \
  X(DISTANCE, REST_DISTANCE, "rest_distance", NUMBER, LENGTH, ANY, "as drawn", OPTIONAL, 0, "", FIELD(strut_distance_spring, rest_distance), "Distance without force; may be negative.") \
  X(DISTANCE, LAW, "law", LAW, FORCE, ANY, "linear", OPTIONAL, 0, "", NESTED(strut_distance_spring, law, LAW), "Force as a function of distance - rest distance. With `compression_only` the second node stays ahead of the first, or the node to the left of the line, as at a wall.")

#define STRUT_FOOT_FIELDS(X) \
  X(FOOT, MEMBER, "member", NAME, NONE, ANY, "", REQUIRED, 0, "", REFERENCE(strut_foot, member, MEMBER), "The member that carries the arc. The centre lies on the member's line, `radius` from the node.") \
  X(FOOT, NODE, "node", NAME, NONE, ANY, "", REQUIRED, 0, "", REFERENCE(strut_foot, node, NODE), "The end of the member through which the arc passes, square to it. The foot takes stiffness, damping and friction from the node's contact with each ground.") \
  X(FOOT, RADIUS, "radius", NUMBER, LENGTH, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_foot, radius), "Radius of the arc.")

#define STRUT_LAW_FIELDS(X) \
  X(LAW, KIND, "kind", WORD, NONE, ANY, "linear", WRITTEN, 0, STRUT_LAW_WORDS, FIELD(strut_law, kind), "Form of the law; [the language](language.md#laws-of-members) has the formulas. `bilinear` needs `knee` and `second_stiffness`, `play` `gap`, `elastic_plastic` `yield`, `polynomial` `coefficients`, `exponential` `scale`, `table` and `curve` `points`.") \
  X(LAW, CARRIES, "carries", WORD, NONE, ANY, "both", OPTIONAL, 0, "both|tension|compression", FIELD(strut_law, carries), "`tension`: the element acts only beyond its rest length; `compression`: only below it.") \
  X(LAW, KNEE, "knee", NUMBER, CONTEXT, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_law, knee), "Elongation at which a bilinear law changes its slope, on either side.") \
  X(LAW, SECOND_STIFFNESS, "second_stiffness", NUMBER, CONTEXT, ANY, "", OPTIONAL, 0, "", FIELD(strut_law, second_stiffness), "Slope of a bilinear law beyond its knee, or of an elastic-plastic law beyond its yield force (default 0).") \
  X(LAW, GAP, "gap", NUMBER, CONTEXT, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_law, gap), "Free play to either side of the rest length.") \
  X(LAW, SCALE, "scale", NUMBER, CONTEXT, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_law, scale), "Elongation over which the slope of an exponential law grows by the factor e.") \
  X(LAW, YIELD, "yield", NUMBER, CONTEXT, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_law, yield), "Force, or moment of a hinge, at which an elastic-plastic law yields.") \
  X(LAW, COEFFICIENTS, "coefficients", NUMBERS, CONTEXT, ANY, "", OPTIONAL, 0, "", CHOICE(strut_law, kind, STRUT_LAW_POLYNOMIAL, LIST(strut_law, force, count)), "Coefficients of x, x^2, ... of a polynomial, such as `[10 N/m, 0, 1e5 N/m^3]`.") \
  X(LAW, POINTS, "points", POINTS, CONTEXT, ANY, "", OPTIONAL, 9, "", AMONG(strut_law, source, STRUT_LAW_POINTS, STRUT_LAW_POINTS, CURVE(strut_law, x, force, count)), "Points `[[x, force], ...]` of a table, such as `[[-1 mm, -5 N], [0, 0], [2 mm, 3 N]]`, with increasing x, or of a curve, whose x may decrease. Beyond its ends the law continues straight.") \
  X(LAW, CONTROL_POINTS, "control_points", POINTS, CONTEXT, ANY, "", OPTIONAL, 0, "", CHOICE(strut_law, source, STRUT_LAW_CONTROL_POINTS, CURVE(strut_law, x, force, count)), "Control points `[[x, force], ...]` of one Bezier curve, at most 64, instead of `points`.") \
  X(LAW, DATA, "data", TEXT, NONE, ANY, "", OPTIONAL, 9, "", CHOICE(strut_law, source, STRUT_LAW_DATA_POINTS, FIELD(strut_law, data)), "Column `TABLE.COLUMN` of [data](#data) with the force of a table, instead of `points`. Where x turns back, or of more than 1000 rows, means of 200 pieces are taken, of loading and unloading apart and then of both.") \
  X(LAW, OVER, "over", TEXT, NONE, ANY, "", OPTIONAL, 0, "", AMONG(strut_law, source, STRUT_LAW_DATA_POINTS, STRUT_LAW_DATA_POINTS, FIELD(strut_law, over)), "With `data`: column of x.") \
  X(LAW, ROUNDING, "rounding", NUMBER, NONE, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_law, rounding), "Rounds the corners of a curve by parabolas, which take this share, below 1, of each piece.") \
  X(LAW, MIRRORED, "mirrored", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_law, mirrored), "The points of a table or curve, from `[0, 0]` on, also hold for negative x with the opposite force.") \
  X(LAW, SMOOTH, "smooth", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_law, smooth), "A table is a monotone spline through its points (Steffen), instead of straight lines.")

#define STRUT_RAYLEIGH_FIELDS(X) \
  X(RAYLEIGH, MASS, "mass", NUMBER, FREQUENCY, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_scene, rayleigh_mass), "alpha: the force -alpha M v on the nodes, with the mass matrix M.") \
  X(RAYLEIGH, STIFFNESS, "stiffness", NUMBER, TIME, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_scene, rayleigh_stiffness), "beta: every member and hinge gets additional damping of beta times its stiffness at the rest length.")

#define STRUT_GROUND_FIELDS(X) \
  X(GROUND, HEIGHT, "height", NUMBER, LENGTH, ANY, "0", OPTIONAL, 1, "", FIELD(strut_ground_section, ground.height), "Height of the line at x = 0.") \
  X(GROUND, SLOPE, "slope", NUMBER, ANGLE, ANY, "0", OPTIONAL, 2, "", FIELD(strut_ground_section, ground.slope), "Angle of the line, between -90 deg and 90 deg; positive if it rises towards +x. With `through`, any angle: the solid is to the right of its direction, so that 90 deg is a wall with its free side towards -x.") \
  X(GROUND, BELT_SPEED, "belt_speed", NUMBER, VELOCITY, ANY, "0", OPTIONAL, 0, "", OF_RUNS(FIELD(strut_ground_section, ground.belt_speed)), "Speed of the surface along itself, positive towards +x.") \
  X(GROUND, STIFFNESS, "stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_ground_section, contact.stiffness), "Normal force per penetration depth.") \
  X(GROUND, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_ground_section, contact.damping), "Normal force per speed of a node moving into the ground.") \
  X(GROUND, DAMPING_LAW, "damping_law", WORD, NONE, ANY, "approach_only", OPTIONAL, 0, "approach_only|hunt_crossley", FIELD(strut_ground_section, ground.damping_law), "`approach_only` (the paper's law): stiffness * depth + damping * speed inwards, without damping while the node moves out; the force jumps at touchdown. `hunt_crossley`: stiffness * depth * (1 + dissipation * speed inwards), never tensile, without a jump.") \
  X(GROUND, DISSIPATION, "dissipation", NUMBER, DISSIPATION, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_ground_section, contact.dissipation), "Dissipation of the Hunt-Crossley law, instead of `damping`.") \
  X(GROUND, FRICTION, "friction", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Friction of every contact; without it the ground is frictionless.") \
  X(GROUND, NODES, "nodes", CONTACT_NODES, NONE, ANY, "all", OPTIONAL, 0, "", BY_HAND, "The nodes that may touch the ground. `all` leaves out nodes that a signal moves.") \
  X(GROUND, CONTACTS, "contacts", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a contact", THINGS(CONTACT), "Settings of single contacts, by the name of the node.") \
  X(GROUND, THROUGH, "through", PAIR, LENGTH, ANY, "", OPTIONAL, 1, "", CHOICE(strut_ground_section, ground.placed, true, FIELD(strut_ground_section, ground.through)), "A point of the line, instead of `height`.") \
  X(GROUND, NORMAL, "normal", PAIR, NONE, ANY, "", OPTIONAL, 2, "", FIELD(strut_ground_section, normal), "A vector out of the solid, of any length, instead of `slope`.") \
  X(GROUND, PROFILE, "profile", PROFILE, NONE, ANY, "", OPTIONAL, 3, "", CHOICE(strut_ground_section, ground.shape, STRUT_GROUND_PROFILE, LIST(strut_ground_section, ground.points, ground.point_count)), "Points of a polyline, instead of a line. The solid is to the right of its direction; the ends continue straight; it must not cross itself.") \
  X(GROUND, CIRCLE, "circle", MAP, NONE, ANY, "", OPTIONAL, 3, "", CHOICE(strut_ground_section, ground.shape, STRUT_GROUND_CIRCLE, NESTED(strut_ground_section, ground, CIRCLE)), "A circle, instead of a line.") \
  X(GROUND, MOTION, "motion", MAP, NONE, ANY, "", OPTIONAL, 0, "", NESTED(strut_ground_section, ground, MOTION), "Displacements of the ground by signals.")

#define STRUT_CIRCLE_FIELDS(X) \
  X(CIRCLE, CENTRE, "centre", PAIR, LENGTH, ANY, "", REQUIRED, 0, "", FIELD(strut_ground, centre), "Its centre.") \
  X(CIRCLE, RADIUS, "radius", NUMBER, LENGTH, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_ground, radius), "Its radius.") \
  X(CIRCLE, INSIDE, "inside", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_ground, inside), "`yes`: nodes are inside, as in a pipe or hoop; `no`: the circle is solid.")

#define STRUT_MOTION_FIELDS(X) \
  X(MOTION, IN_X, "x", SIGNAL, LENGTH, ANY, "", OPTIONAL, 0, "", OF_RUNS(CHOICE(strut_ground, moves[0], true, FIELD(strut_ground, motion[0]))), "Displacement in x.") \
  X(MOTION, IN_Y, "y", SIGNAL, LENGTH, ANY, "", OPTIONAL, 0, "", OF_RUNS(CHOICE(strut_ground, moves[1], true, FIELD(strut_ground, motion[1]))), "Displacement in y.")

#define STRUT_FRICTION_FIELDS(X) \
  X(FRICTION, LAW, "law", WORD, NONE, ANY, "karnopp", WRITTEN, 0, STRUT_FRICTION_WORDS, FIELD(strut_friction, law), "`karnopp`: Coulomb friction with a stick band (the paper's law). `coulomb`: exact sticking; needs a method with events. `smooth`: -mu_kinetic N u / sqrt(u^2 + width^2); loaded contacts creep. `stribeck`: likewise, from mu_static to mu_kinetic as speed grows. `lugre`: bristles that bend before they slide, with these coefficients; on straight grounds at rest.") \
  X(FRICTION, MU, "mu", FREE, NONE, NOT_NEGATIVE, "", OPTIONAL, 0, "a number, a signal or the name of one", CHOICE(strut_friction, driven, true, LATER(REFERENCE(strut_friction, signal, SIGNAL))), "Both friction coefficients. A signal changes them with time; where it is negative they are 0. Settling uses its value at t = 0.") \
  X(FRICTION, MU_STATIC, "mu_static", NUMBER, NONE, NOT_NEGATIVE, "", OPTIONAL, 0, "", FIELD(strut_friction, mu_static), "Coefficient of static friction; with `karnopp` and `coulomb` not below `mu_kinetic`.") \
  X(FRICTION, MU_KINETIC, "mu_kinetic", NUMBER, NONE, NOT_NEGATIVE, "", OPTIONAL, 0, "", FIELD(strut_friction, mu_kinetic), "Coefficient of kinetic friction.") \
  X(FRICTION, MU_FORWARD, "mu_forward", NUMBER, NONE, NOT_NEGATIVE, "", OPTIONAL, 0, "", BY_HAND, "Both coefficients against motion towards +x along the ground, if they depend on the direction.") \
  X(FRICTION, MU_FORWARD_STATIC, "mu_forward_static", NUMBER, NONE, NOT_NEGATIVE, "`mu_forward`", OPTIONAL, 0, "", BY_HAND, "Coefficient of static friction against motion towards +x.") \
  X(FRICTION, MU_BACKWARD, "mu_backward", NUMBER, NONE, NOT_NEGATIVE, "as forward", OPTIONAL, 0, "", FIELD(strut_friction, mu_kinetic_backward), "Both coefficients against motion towards -x along the ground.") \
  X(FRICTION, MU_BACKWARD_STATIC, "mu_backward_static", NUMBER, NONE, NOT_NEGATIVE, "`mu_backward`", OPTIONAL, 0, "", FIELD(strut_friction, mu_static_backward), "Coefficient of static friction against motion towards -x.") \
  X(FRICTION, STICK_VELOCITY, "stick_velocity", NUMBER, VELOCITY, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_friction, stick_velocity), "Half the width of the stick band. Karnopp's law needs it.") \
  X(FRICTION, WIDTH, "width", NUMBER, VELOCITY, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_friction, width), "Sliding speed at which `smooth` and `stribeck` reach 0.71 of full friction; both need it.") \
  X(FRICTION, DECAY_VELOCITY, "decay_velocity", NUMBER, VELOCITY, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_friction, decay_velocity), "Sliding speed u at which mu = mu_kinetic + (mu_static - mu_kinetic) / (1 + (u / decay_velocity)^2) is half way; `stribeck` and `lugre` need it.") \
  X(FRICTION, PRESLIDING, "presliding", NUMBER, LENGTH, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_friction, presliding), "Slip at which bristles hold mu_static: their stiffness is mu_static N / presliding. `lugre` needs it.") \
  X(FRICTION, RELAXATION, "relaxation", NUMBER, TIME, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_friction, relaxation), "Time in which free bristles straighten. `lugre` needs it.")

#define STRUT_CONTACT_FIELDS(X) \
  X(CONTACT, GROUP, "group", GROUPS, NONE, ANY, "", OPTIONAL, 0, "", NONE, "Groups that provide defaults; later groups take precedence.") \
  X(CONTACT, STIFFNESS, "stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "the ground's", OPTIONAL, 0, "", FIELD(strut_contact, stiffness), "Replaces the value of the ground.") \
  X(CONTACT, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "the ground's", OPTIONAL, 0, "", FIELD(strut_contact, damping), "Replaces the value of the ground.") \
  X(CONTACT, DISSIPATION, "dissipation", NUMBER, DISSIPATION, NOT_NEGATIVE, "the ground's", OPTIONAL, 0, "", FIELD(strut_contact, dissipation), "Replaces the value of the ground.") \
  X(CONTACT, FRICTION, "friction", MAP, NONE, ANY, "the ground's", OPTIONAL, 0, "", BY_HAND, "Replaces single keys of the ground's friction.")

#define STRUT_ACTUATOR_FIELDS(X) \
  X(ACTUATOR, MEMBER, "member", NAME, NONE, ANY, "", OPTIONAL, 6, "", REFERENCE(strut_actuator, member, MEMBER), "The member whose rest length it changes, or to which it adds a force.") \
  X(ACTUATOR, HINGE, "hinge", NAME, NONE, ANY, "", OPTIONAL, 6, "", REFERENCE(strut_actuator, hinge, HINGE), "The hinge whose rest angle it changes, or to which it adds a moment.") \
  X(ACTUATOR, CELL, "cell", NAME, NONE, ANY, "", OPTIONAL, 6, "", REFERENCE(strut_actuator, cell, CELL), "The cell whose given pressure it changes. For an isothermal gas it changes the pressure at the drawn area, by letting gas in or out.") \
  X(ACTUATOR, SIGNAL, "signal", SIGNAL, CONTEXT, ANY, "", OPTIONAL, 7, "", CHOICE(strut_actuator, force, 0, FIELD(strut_actuator, signal)), "Added to the rest length of the member, the rest angle of the hinge or the pressure of the cell.") \
  X(ACTUATOR, FORCE, "force", SIGNAL, FORCE, ANY, "", OPTIONAL, 7, "", LATER(CHOICE(strut_actuator, force, 1, FIELD(strut_actuator, signal))), "Instead of `signal`: a force in addition to the member's own, tension positive. Statics ignore it.") \
  X(ACTUATOR, MOMENT, "moment", SIGNAL, CONTEXT, ANY, "", OPTIONAL, 7, "", CHOICE(strut_actuator, force, 2, FIELD(strut_actuator, signal)), "Instead of `signal`: a moment in addition to the hinge's own; positive closes the angle. Statics ignore it.")

#define STRUT_LOAD_FIELDS(X) \
  X(LOAD, NODE, "node", NAME, NONE, ANY, "", OPTIONAL, 6, "", REFERENCE(strut_load, node, NODE), "The node on which the force acts.") \
  X(LOAD, HINGE, "hinge", NAME, NONE, ANY, "", OPTIONAL, 6, "", REFERENCE(strut_load, hinge, HINGE), "The hinge whose angle the moment opens: opposite couples on its two arms.") \
  X(LOAD, MEMBER, "member", NAME, NONE, ANY, "", OPTIONAL, 6, "", REFERENCE(strut_load, member, MEMBER), "The member that the moment turns: opposite forces across it on its two end nodes.") \
  X(LOAD, FORCE, "force", PAIR, FORCE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_load, couple, false, FIELD(strut_load, force)), "The force; with a signal, the force at signal 1.") \
  X(LOAD, MOMENT, "moment", NUMBER, MOMENT, ANY, "", OPTIONAL, 7, "", CHOICE(strut_load, couple, true, FIELD(strut_load, moment)), "Of a hinge or member, instead of `force`: the moment, counter-clockwise.") \
  X(LOAD, SIGNAL, "signal", SIGNAL, NONE, ANY, "constant 1", OPTIONAL, 0, "", FIELD(strut_load, signal), "Factor of the force or moment, without unit.")

#define STRUT_UNBALANCE_FIELDS(X) \
  X(UNBALANCE, NODE, "node", NAME, NONE, ANY, "", REQUIRED, 0, "", REFERENCE(strut_unbalance, node, NODE), "The node about which it rotates.") \
  X(UNBALANCE, MASS, "mass", NUMBER, MASS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_unbalance, mass), "The rotating mass. It counts to the node's mass.") \
  X(UNBALANCE, RADIUS, "radius", NUMBER, LENGTH, NOT_NEGATIVE, "", REQUIRED, 0, "", OF_RUNS(FIELD(strut_unbalance, radius)), "Its distance from the node.") \
  X(UNBALANCE, SPEED, "speed", NUMBER, CONTEXT, ANY, "", OPTIONAL, 9, "", OF_RUNS(CHOICE(strut_unbalance, signal, UINT32_MAX, FIELD(strut_unbalance, speed))), "Constant speed, counter-clockwise: 30 Hz (turns per second) or 188 rad/s. A plain number is in rad/s.") \
  X(UNBALANCE, SIGNAL, "angle", SIGNAL, ANGLE, ANY, "", OPTIONAL, 9, "", OF_RUNS(FIELD(strut_unbalance, signal)), "Instead of `speed`: the angle, a signal that must not jump.") \
  X(UNBALANCE, PHASE, "phase", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", OF_RUNS(FIELD(strut_unbalance, phase)), "Added to the angle, measured from +x.")

#define STRUT_SLIDER_FIELDS(X) \
  X(SLIDER, MEMBER, "member", NAME, NONE, ANY, "", REQUIRED, 0, "", LATER(REFERENCE(strut_sliding_mass, member, MEMBER)), "The member on whose straight line, between its two nodes, the mass lies.") \
  X(SLIDER, MASS, "mass", NUMBER, MASS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_sliding_mass, mass), "Point mass.") \
  X(SLIDER, POSITION, "position", NUMBER, CONTEXT, ANY, "0", OPTIONAL, 0, "", FIELD(strut_sliding_mass, share), "Position from the member's first node: a share of the member, such as 50 %, or a length in the drawn shape.") \
  X(SLIDER, MOVES, "moves", SIGNAL, NONE, ANY, "", OPTIONAL, 1, "", OF_RUNS(CHOICE(strut_sliding_mass, travel, false, FIELD(strut_sliding_mass, signal))), "Added to the position as a share of the member: a signal that must not jump. Its corners are impulses.") \
  X(SLIDER, TRAVEL, "travel", SIGNAL, LENGTH, ANY, "", OPTIONAL, 1, "", OF_RUNS(CHOICE(strut_sliding_mass, travel, true, FIELD(strut_sliding_mass, signal))), "Likewise, as a length along the drawn member, which stretches with it.")

#define STRUT_SIGNAL_FIELDS(X) \
  X(SIGNAL, CONSTANT, "constant", NUMBER, CONTEXT, ANY, "", OPTIONAL, 1, "", CHOICE(strut_signal, kind, STRUT_CONSTANT, FIELD(strut_signal, amplitude)), "A constant, for t >= 0.") \
  X(SIGNAL, SINE, "sine", MAP, NONE, ANY, "", OPTIONAL, 1, "", CHOICE(strut_signal, kind, STRUT_SINE, LATER(SELF(strut_signal, SINE))), "amplitude * sin(2 pi frequency (t - start) + phase).") \
  X(SIGNAL, HALF_SINE, "half_sine", MAP, NONE, ANY, "", OPTIONAL, 1, "", CHOICE(strut_signal, kind, STRUT_HALF_SINE, LATER(SELF(strut_signal, HALF_SINE))), "One half-wave of a sine, then 0.") \
  X(SIGNAL, SQUARE, "square", MAP, NONE, ANY, "", OPTIONAL, 1, "", CHOICE(strut_signal, kind, STRUT_SQUARE, LATER(SELF(strut_signal, SQUARE))), "+amplitude in the first half of each period, -amplitude in the second.") \
  X(SIGNAL, RAMP, "ramp", MAP, NONE, ANY, "", OPTIONAL, 1, "", CHOICE(strut_signal, kind, STRUT_RAMP, LATER(SELF(strut_signal, RAMP))), "Rises linearly from 0 at `start` to the amplitude at `stop`, and stays there.") \
  X(SIGNAL, TABLE, "table", TABLE, CONTEXT, ANY, "", OPTIONAL, 1, "", CHOICE(strut_signal, kind, STRUT_TABLE, CURVE(strut_signal, time, value, point_count)), "Points `[[t, value], ...]`, interpolated linearly; constant before the first and after the last. At two points of one time the signal jumps.") \
  X(SIGNAL, SUM, "sum", SIGNALS, CONTEXT, ANY, "", OPTIONAL, 1, "", CHOICE(strut_signal, kind, STRUT_SUM, REFERENCES(strut_signal, terms, term_count, SIGNAL)), "The sum of the listed signals.") \
  X(SIGNAL, EXPRESSION, "expression", EXPRESSION, CONTEXT, ANY, "", OPTIONAL, 1, "", CHOICE(strut_signal, kind, STRUT_EXPRESSION, LIST(strut_signal, program.instruction, program.length)), "An expression of the time `t`, parameters, [sensors](#sensor) and other signals, evaluated with the forces.") \
  X(SIGNAL, DATA, "data", TEXT, NONE, ANY, "", OPTIONAL, 1, "", CHOICE(strut_signal, kind, STRUT_DATA, FIELD(strut_signal, data)), "A column `TABLE.COLUMN` of [data](#data) over the time of the table. Gaps are bridged.") \
  X(SIGNAL, OVER, "over", TEXT, NONE, ANY, "the first column whose unit is a time", OPTIONAL, 0, "", AMONG(strut_signal, kind, STRUT_DATA, STRUT_DATA, FIELD(strut_signal, over)), "Beside `data`: the column of the time.") \
  X(SIGNAL, INTERPOLATION, "interpolation", WORD, NONE, ANY, "linear", OPTIONAL, 0, "linear|smooth", AMONG(strut_signal, kind, STRUT_DATA, STRUT_DATA, FIELD(strut_signal, smooth)), "Beside `data`: straight lines, or a spline that is monotone where the data are (Steffen).") \
  X(SIGNAL, OUTSIDE, "outside", WORD, NONE, ANY, "error", OPTIONAL, 0, "error|hold|repeat", AMONG(strut_signal, kind, STRUT_DATA, STRUT_DATA, FIELD(strut_signal, outside)), "Beside `data`: what it is before and after the data. `error`: the run must lie within them; `hold`: their first and last value; `repeat`: they are a period.") \
  X(SIGNAL, STARTS, "starts", MAP, NONE, ANY, "", OPTIONAL, 0, "start", NESTED(strut_signal, trigger, STARTS), "Beside one of the keys above: the event at which the time of the signal begins. Before it, the signal is 0.") \
  X(SIGNAL, LAG, "lag", NUMBER, TIME, ABOVE_ZERO, "0", OPTIONAL, 0, "", FIELD(strut_signal, lag), "Beside one of the keys above: time constant of a first-order lag, from 0 at t = 0. It precedes sampling.") \
  X(SIGNAL, EVERY, "every", NUMBER, TIME, ABOVE_ZERO, "0", OPTIONAL, 0, "", FIELD(strut_signal, every), "Beside one of the keys above: samples the signal at multiples of this time and holds it in between.")

#define STRUT_SINE_FIELDS(X) \
  X(SINE, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, amplitude), "Largest value.") \
  X(SINE, FREQUENCY, "frequency", NUMBER, FREQUENCY, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_signal, frequency), "Periods per second.") \
  X(SINE, PHASE, "phase", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", TURNS(FIELD(strut_signal, phase)), "Phase angle at `start`.") \
  X(SINE, START, "start", NUMBER, TIME, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, start), "The signal is 0 before this time.") \
  X(SINE, STOP, "stop", NUMBER, TIME, ANY, "never", OPTIONAL, 0, "", FIELD(strut_signal, stop), "The signal is 0 from this time on.")

#define STRUT_HALF_SINE_FIELDS(X) \
  X(HALF_SINE, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, amplitude), "Largest value.") \
  X(HALF_SINE, FREQUENCY, "frequency", NUMBER, FREQUENCY, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_signal, frequency), "Frequency of the sine; the half-wave lasts 1 / (2 frequency).") \
  X(HALF_SINE, START, "start", NUMBER, TIME, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, start), "Time at which the half-wave begins.")

#define STRUT_SQUARE_FIELDS(X) \
  X(SQUARE, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, amplitude), "Largest value.") \
  X(SQUARE, FREQUENCY, "frequency", NUMBER, FREQUENCY, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_signal, frequency), "Periods per second.") \
  X(SQUARE, PHASE, "phase", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", TURNS(FIELD(strut_signal, phase)), "Phase angle at `start`.") \
  X(SQUARE, START, "start", NUMBER, TIME, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, start), "The signal is 0 before this time.") \
  X(SQUARE, STOP, "stop", NUMBER, TIME, ANY, "never", OPTIONAL, 0, "", FIELD(strut_signal, stop), "The signal is 0 from this time on.")

#define STRUT_RAMP_FIELDS(X) \
  X(RAMP, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, amplitude), "Value from `stop` on.") \
  X(RAMP, START, "start", NUMBER, TIME, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, start), "Time at which the signal leaves 0.") \
  X(RAMP, STOP, "stop", NUMBER, TIME, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, stop), "Time at which it reaches the amplitude.")

#define STRUT_SENSOR_FIELDS(X) \
  X(SENSOR, LENGTH, "length", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_COLUMN_LENGTH, REFERENCE(strut_sensor, item, MEMBER)), "A member: its length [m].") \
  X(SENSOR, FORCE, "force", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_COLUMN_FORCE, REFERENCE(strut_sensor, item, MEMBER)), "A member: its force [N], tension positive, including damper and stops, without the `force` of actuators.") \
  X(SENSOR, ANGLE, "angle", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_COLUMN_HINGE_ANGLE, REFERENCE(strut_sensor, item, HINGE)), "A hinge: its angle [rad].") \
  X(SENSOR, CONTACT, "contact", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_COLUMN_TOUCHES, REFERENCE(strut_sensor, item, NODE)), "A node: 1 while it touches the ground, otherwise 0.") \
  X(SENSOR, POSITION, "position", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_COLUMN_NODE_X, REFERENCE(strut_sensor, item, NODE)), "A node: its position [m] `along` x or y.") \
  X(SENSOR, VELOCITY, "velocity", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_COLUMN_NODE_VX, REFERENCE(strut_sensor, item, NODE)), "A node: its velocity [m/s] `along` x or y.") \
  X(SENSOR, ENERGY, "energy", WORD, NONE, ANY, "", OPTIONAL, 7, "kinetic|elastic|total", CHOICE(strut_sensor, kind, STRUT_COLUMN_KINETIC, FIELD(strut_sensor, energy)), "An energy of the structure [J].") \
  X(SENSOR, AREA, "area", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_COLUMN_CELL_AREA, REFERENCE(strut_sensor, item, CELL)), "A cell: its area [m^2].") \
  X(SENSOR, PRESSURE, "pressure", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_COLUMN_PRESSURE, REFERENCE(strut_sensor, item, CELL)), "A cell: its pressure [N/m], absolute for a gas.") \
  X(SENSOR, DISTANCE, "distance", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_COLUMN_DISTANCE_VALUE, REFERENCE(strut_sensor, item, DISTANCE)), "A distance spring: its distance [m].") \
  X(SENSOR, CONTACT_FORCE, "contact_force", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_COLUMN_NORMAL, REFERENCE(strut_sensor, item, NODE)), "A node: its normal force on the ground [N], summed over several grounds.") \
  X(SENSOR, COLLISION_FORCE, "collision_force", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_COLUMN_COLLISION_FORCE, REFERENCE(strut_sensor, item, COLLISION)), "A collision: its force [N].") \
  X(SENSOR, OF, "of", EXPRESSION, NONE, ANY, "", OPTIONAL, 7, "", LATER(LIST(strut_sensor, of, length)), "Any other column of the motion that measured quantities know, such as `NODE.height`, `com.vy` or `energy.total`.") \
  X(SENSOR, ALONG, "along", WORD, NONE, ANY, "", OPTIONAL, 0, "x|y", AMONG(strut_sensor, kind, STRUT_COLUMN_NODE_X, STRUT_COLUMN_NODE_VX, FIELD(strut_sensor, along)), "Direction of a position or a velocity.")

#define STRUT_STATE_FIELDS(X) \
  X(STATE, RATE, "rate", EXPRESSION, CONTEXT, ANY, "", REQUIRED, 0, "", LIST(strut_internal_state, rate.instruction, rate.length), "Its rate: an expression as of a signal, which may also use states.") \
  X(STATE, START, "start", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", UNIT(strut_internal_state, start, unit), "Value at t = 0, with its unit.")

#define STRUT_RELAY_FIELDS(X) \
  X(RELAY, KIND, "kind", WORD, NONE, ANY, "", REQUIRED, 0, "relay", NONE, "Kind of controller.") \
  X(RELAY, OF, "of", EXPRESSION, CONTEXT, ANY, "", REQUIRED, 0, "", LIST(strut_signal, program.instruction, program.length), "Input: a sensor, or an expression as of a signal.") \
  X(RELAY, ON_ABOVE, "on_above", NUMBER, CONTEXT, ANY, "", OPTIONAL, 7, "", CHOICE(strut_signal, relay.on_above, true, FIELD(strut_signal, relay.upper)), "The relay switches on when the input rises above this value.") \
  X(RELAY, OFF_BELOW, "off_below", NUMBER, CONTEXT, ANY, "", OPTIONAL, 8, "", CHOICE(strut_signal, relay.on_above, true, FIELD(strut_signal, relay.lower)), "With `on_above`: switches off when the input falls below this value.") \
  X(RELAY, ON_BELOW, "on_below", NUMBER, CONTEXT, ANY, "", OPTIONAL, 7, "", CHOICE(strut_signal, relay.on_above, false, FIELD(strut_signal, relay.lower)), "Instead, as in a thermostat: switches on when the input falls below this value.") \
  X(RELAY, OFF_ABOVE, "off_above", NUMBER, CONTEXT, ANY, "", OPTIONAL, 8, "", CHOICE(strut_signal, relay.on_above, false, FIELD(strut_signal, relay.upper)), "With `on_below`: switches off when the input rises above this value.") \
  X(RELAY, ON_VALUE, "on_value", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, relay.on), "The signal while it is on.") \
  X(RELAY, OFF_VALUE, "off_value", NUMBER, CONTEXT, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, relay.off), "The signal while it is off.") \
  X(RELAY, ON_AT_START, "on_at_start", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_signal, relay.on_at_start), "State at t = 0 if the input lies between the thresholds.") \
  X(RELAY, EVERY, "every", NUMBER, TIME, ABOVE_ZERO, "0", OPTIONAL, 0, "", FIELD(strut_signal, every), "Sampling interval, at which the relay switches; 0: it switches when the input passes a threshold. Methods with events locate this instant, others switch at the end of the step.")

#define STRUT_MAXWELL_FIELDS(X) \
  X(MAXWELL, STIFFNESS, "stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_maxwell, stiffness), "Stiffness k of the spring.") \
  X(MAXWELL, DAMPING, "damping", NUMBER, DAMPING, ABOVE_ZERO, "", OPTIONAL, 7, "", FIELD(strut_maxwell, damping), "Damping c of the dashpot.") \
  X(MAXWELL, TIME, "time", NUMBER, TIME, ABOVE_ZERO, "", OPTIONAL, 7, "", FIELD(strut_maxwell, time), "Instead of `damping`: the relaxation time c/k.") \
  X(MAXWELL, FORCE, "force", NUMBER, FORCE, ANY, "0", OPTIONAL, 0, "", FIELD(strut_maxwell, force), "Force of the branch at t = 0; tension is positive.")

#define STRUT_RUBBING_FIELDS(X) \
  X(RUBBING, MU, "mu", NUMBER, NONE, NOT_NEGATIVE, "", REQUIRED, 0, "", FIELD(strut_friction, mu_kinetic), "Coefficient of friction; with `decay_velocity`, that of fast sliding.") \
  X(RUBBING, WIDTH, "width", NUMBER, VELOCITY, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_friction, width), "Sliding speed at which friction reaches 0.71 of its full value.") \
  X(RUBBING, MU_STATIC, "mu_static", NUMBER, NONE, NOT_NEGATIVE, "", OPTIONAL, 0, "", FIELD(strut_friction, mu_static), "Coefficient of slow sliding, with a `decay_velocity`.") \
  X(RUBBING, DECAY_VELOCITY, "decay_velocity", NUMBER, VELOCITY, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_friction, decay_velocity), "Sliding speed at which the coefficient is halfway from `mu_static` to `mu` (Stribeck's curve).")

#define STRUT_STARTS_FIELDS(X) \
  X(STARTS, CONTACT, "contact", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_trigger, kind, STRUT_TRIGGER_CONTACT, REFERENCE(strut_trigger, item, NODE)), "The node whose touchdown starts the signal.") \
  X(STARTS, SENSOR, "sensor", NAME, NONE, ANY, "", OPTIONAL, 7, "", AMONG(strut_trigger, kind, STRUT_TRIGGER_ABOVE, STRUT_TRIGGER_BELOW, REFERENCE(strut_trigger, item, SENSOR)), "The sensor that starts the signal, where it passes a level.") \
  X(STARTS, ABOVE, "above", NUMBER, CONTEXT, ANY, "", OPTIONAL, 8, "", CHOICE(strut_trigger, kind, STRUT_TRIGGER_ABOVE, FIELD(strut_trigger, level)), "The signal starts when the sensor rises above this level.") \
  X(STARTS, BELOW, "below", NUMBER, CONTEXT, ANY, "", OPTIONAL, 8, "", CHOICE(strut_trigger, kind, STRUT_TRIGGER_BELOW, FIELD(strut_trigger, level)), "The signal starts when the sensor falls below this level.") \
  X(STARTS, EACH, "each", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_trigger, each), "`yes`: the signal starts again each time.")

#define STRUT_CONFIGURATION_FIELDS(X) \
  X(CONFIGURATION, CONTACTS, "contacts", NODE_SETS, NONE, ANY, "", OPTIONAL, 0, "", LIST(strut_configuration, sets, set_count), "The nodes that touch the ground. Several lists are alternatives.") \
  X(CONFIGURATION, SHAPE, "shape", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[x, y]`", CHOICE(strut_configuration, shaped, true, LATER(PLACES(strut_configuration, position))), "Approximate positions; other nodes are as drawn. Without `shape` the contacts alone identify the configuration.")

#define STRUT_INITIAL_FIELDS(X) \
  X(INITIAL, CONFIGURATION, "configuration", NAME, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "A configuration, or a text parameter that names one.") \
  X(INITIAL, EQUILIBRIUM, "equilibrium", NAME, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "A configuration, or a text parameter that names one. The run starts in its equilibrium. Replaces `configuration`, `positions` and `settle`.") \
  X(INITIAL, POSITIONS, "positions", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[x, y]`", BY_HAND, "Positions of single nodes, which override the configuration.") \
  X(INITIAL, VELOCITIES, "velocities", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[vx, vy]`", BY_HAND, "Velocities of single nodes.") \
  X(INITIAL, VELOCITY, "velocity", PAIR, VELOCITY, ANY, "[0, 0]", OPTIONAL, 0, "", BY_HAND, "Velocity of all other nodes, in their free directions.") \
  X(INITIAL, SETTLE, "settle", SETTLE, NONE, ANY, "false", OPTIONAL, 0, "", CHOICE(strut_experiment, settle.wanted, true, LATER(NESTED(strut_experiment, settle, SETTLE))), "Lets the structure come to rest before t = 0, without actuators, driven loads, belt and (as in the paper) friction.")

#define STRUT_SETTLE_FIELDS(X) \
  X(SETTLE, SPEED, "speed", NUMBER, VELOCITY, ABOVE_ZERO, "1e-8", WRITTEN, 0, "", FIELD(strut_settle, speed), "At rest, the speed of every node is below this.") \
  X(SETTLE, ACCELERATION, "acceleration", NUMBER, ACCELERATION, ABOVE_ZERO, "1e-8", WRITTEN, 0, "", FIELD(strut_settle, acceleration), "At rest, the acceleration of every node is below this.") \
  X(SETTLE, LIMIT, "limit", NUMBER, TIME, ABOVE_ZERO, "100", WRITTEN, 0, "", FIELD(strut_settle, limit), "Longest simulated time.") \
  X(SETTLE, EVALUATIONS, "evaluations", NUMBER, NONE, ABOVE_ZERO, "4e7", OPTIONAL, 0, "", FIELD(strut_settle, evaluations), "Largest number of force evaluations.") \
  X(SETTLE, STEP, "step", NUMBER, TIME, NOT_NEGATIVE, "`solver.step`", OPTIONAL, 0, "", BY_HAND, "Time step of the Runge-Kutta method that settles, independent of the method of the run. Half the stability limit replaces `0`, a step above that limit, and a missing step.") \
  X(SETTLE, PERTURB, "perturb", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_settle, perturb), "`yes`: leaves unstable equilibria by slight pushes in the most unstable direction, until the equilibrium is stable.") \
  X(SETTLE, FRICTION, "friction", WORD, NONE, ANY, "none", OPTIONAL, 0, "none|kept", FIELD(strut_settle, friction), "`kept`: friction acts, as a body on a slope requires; `none`: no friction, as in the paper.")

#define STRUT_EQUILIBRIA_FIELDS(X) \
  X(EQUILIBRIA, SUPPORTS, "supports", NODE_SETS, NONE, ANY, "every pair that can carry", OPTIONAL, 0, "", LIST(strut_search, supports, support_count), "Sets of contact nodes to support: the first node of each list is pinned, the others roll on the ground.") \
  X(EQUILIBRIA, STARTS, "starts", NUMBER, NONE, WHOLE(0, STRUT_MOST_STARTS), "until few equilibria can be missing", OPTIONAL, 0, "", FIELD(strut_search, starts), "Random starts for each set of supports.") \
  X(EQUILIBRIA, SEED, "seed", NUMBER, NONE, WHOLE(0, STRUT_MOST_SEED), "1", WRITTEN, 0, "", FIELD(strut_search, seed), "Seed of the random starts. The same seed gives the same result.")

#define STRUT_SOLVER_FIELDS(X) \
  X(SOLVER, INTEGRATOR, "integrator", WORD, NONE, ANY, "rk4", WRITTEN, 0, STRUT_INTEGRATOR_WORDS, FIELD(strut_experiment, integrator), "Time integration method; unnamed and with `coulomb`, `rk4-events`.") \
  X(SOLVER, STEP, "step", NUMBER, TIME, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_experiment, step), "Time step; with `adaptive`, `adaptive8` and `implicit`, the longest step. A run needs `step` or `accuracy`.") \
  X(SOLVER, TOLERANCE, "tolerance", NUMBER, NONE, ABOVE_ZERO, "1e-6", OPTIONAL, 0, "", FIELD(strut_experiment, tolerance), "Relative local error per step of `adaptive`, `adaptive8` and `implicit`.") \
  X(SOLVER, REFINE, "refine", NUMBER, NONE, ABOVE_ZERO, "from the scene", OPTIONAL, 0, "", FIELD(strut_experiment, refine), "Factor by which methods with events divide the step after a touchdown; 1: no refinement.") \
  X(SOLVER, REFINE_TIME, "refine_time", NUMBER, TIME, ABOVE_ZERO, "from the scene", OPTIONAL, 0, "", FIELD(strut_experiment, refine_time), "Duration of the refinement after a touchdown.") \
  X(SOLVER, ACCURACY, "accuracy", NUMBER, NONE, SHARE(STRUT_MOST_ACCURACY), "", OPTIONAL, 0, "", FIELD(strut_experiment, accuracy), "Desired relative accuracy of the measured quantities, such as 1 %. Method and step are chosen to meet it.") \
  X(SOLVER, BUDGET, "budget", NUMBER, NONE, ABOVE_ZERO, STRUT_TEXT_OF(STRUT_USUAL_BUDGET), OPTIONAL, 0, "", FIELD(strut_experiment, budget), "Work limit of `accuracy`, in units of one fine run with a fixed step. A result that would need more is reported as not accurate enough.")

#define STRUT_RUN_FIELDS(X) \
  X(RUN, DURATION, "duration", NUMBER, TIME, ABOVE_ZERO, "", OPTIONAL, 3, "", FIELD(strut_experiment, duration), "Simulated time.") \
  X(RUN, PERIODS, "periods", NUMBER, NONE, ABOVE_ZERO, "", OPTIONAL, 3, "", FIELD(strut_experiment, periods), "Simulated time in periods of the signal that `of` names.") \
  X(RUN, OF, "of", NAME, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "The actuator, load or signal that defines the period.") \
  X(RUN, MEASURE, "measure", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(MEASURE), "What the run measures; by default the velocity of the centre of mass over the whole run.")

#define STRUT_MEASURE_FIELDS(X) \
  X(MEASURE, LAST, "last", NUMBER, CONTEXT, ABOVE_ZERO, "the whole run", OPTIONAL, 0, "", FIELD(strut_experiment, measure_last), "Length of the measuring window at the end of the run: a number of periods in a run by `periods`, otherwise a time.") \
  X(MEASURE, STEADY, "steady", STEADY, NONE, ANY, "false", OPTIONAL, 0, "", CHOICE(strut_experiment, steady.wanted, true, LATER(NESTED(strut_experiment, steady, STEADY))), "Stops the run as soon as the motion repeats itself. The run needs `periods`, which are then an upper bound.") \
  X(MEASURE, NODE, "node", NAME, NONE, ANY, "the centre of mass", OPTIONAL, 0, "", REFERENCE(strut_experiment, measure_node, NODE), "The node whose velocity is measured.") \
  X(MEASURE, QUANTITIES, "quantities", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression, whose mean is measured, or the keys of a [quantity](#quantity)", THINGS(QUANTITY), "Further quantities to measure over the window.") \
  X(MEASURE, DERIVATIVES, "derivatives", NAMES, NONE, ANY, "", OPTIONAL, 0, "a parameter", NONE, "Parameters of the scene, numbers. Everything measured gets its derivative by each of them, with an error, or the verdict that it has none. See [derivatives](numerics.md#derivatives).")

#define STRUT_QUANTITY_FIELDS(X) \
  X(QUANTITY, OF, "of", EXPRESSION, NONE, ANY, "", REQUIRED, 0, "", LATER(LIST(strut_quantity_definition, program, length)), "An expression of columns of the motion, which [the language](language.md#measured-quantities) lists.") \
  X(QUANTITY, TAKE, "take", WORD, NONE, ANY, "mean", OPTIONAL, 0, "mean|min|max|range|rms|final|change|rate|rise|arrival", FIELD(strut_quantity_definition, take), "The number taken over the window: `mean` over time, `min`, `max`, `range` (max - min), `rms`, `final` value, `change` from first to last value, `rate` (change / time), `rise` (sum of all increases), or `arrival`, the time at which the expression first reaches or passes `target`, missing if never.") \
  X(QUANTITY, ACCURACY, "accuracy", NUMBER, CONTEXT, SHARE(STRUT_MOST_ACCURACY), "that of the solver", OPTIONAL, 0, "", UNIT(strut_quantity_definition, accuracy, accuracy_unit), "Desired accuracy: relative without a unit, such as 1 %, absolute with a unit, such as 0.1 mm.") \
  X(QUANTITY, TARGET, "target", NUMBER, CONTEXT, ANY, "", OPTIONAL, 0, "", CHOICE(strut_quantity_definition, take, STRUT_TAKE_ARRIVAL, UNIT(strut_quantity_definition, target, target_unit)), "Value for `take: arrival`, reached from below or above, in the unit of the expression.")

#define STRUT_STEADY_FIELDS(X) \
  X(STEADY, TOLERANCE, "tolerance", NUMBER, NONE, ABOVE_ZERO, "0.5 %", WRITTEN, 0, "", FIELD(strut_steady, tolerance), "Largest relative difference of the velocity between repetitions.") \
  X(STEADY, ABSOLUTE_TOLERANCE, "absolute_tolerance", NUMBER, VELOCITY, ABOVE_ZERO, "from the scene", OPTIONAL, 0, "", FIELD(strut_steady, floor), "Velocity differences below this value count as none.") \
  X(STEADY, REPETITIONS, "repetitions", NUMBER, NONE, WHOLE(2, 16), "5", WRITTEN, 0, "", FIELD(strut_steady, successive), "Number of successive repetitions that must agree.")

#define STRUT_OUTPUT_FIELDS(X) \
  X(OUTPUT, EVERY, "every", NUMBER, TIME, ABOVE_ZERO, "a thousandth of the recorded time", OPTIONAL, 0, "", FIELD(strut_experiment, output_every), "Time between two samples, which is exact: see [output](output.md#the-files-of--o-dir).") \
  X(OUTPUT, LAST, "last", NUMBER, CONTEXT, ABOVE_ZERO, "the whole run", OPTIONAL, 0, "", FIELD(strut_experiment, output_last), "Records only the end of the run: a number of periods in a run by `periods`, otherwise a time.") \
  X(OUTPUT, CHANNELS, "channels", WORDS, NONE, ANY, "[position, length, force]", WRITTEN, 0, STRUT_CHANNEL_WORDS, FIELD(strut_experiment, channels), STRUT_CHANNEL_DESCRIPTION)

/* clang-format on */
