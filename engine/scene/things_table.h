/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The things of a scene as tables: their kinds, and the fields of each, with name, type, range, default,
 * meaning, and where the value is kept. What follows from them: the keys of the language with their
 * reader, writer, reference page and schema (parser/language/keys.h), the checks of ranges, and the
 * numbers by which an answer is known (things.h). Nothing else repeats what a row says.
 *
 * A row is X(section, id, name, type, measure, range, default, need, set, words, field, description).
 * A section is a mapping of the language; the columns up to `words` are explained in
 * parser/language/keys_table.h. field says where the value is kept:
 *
 *   FIELD(object, member)                    a number, pair, word, text or signal
 *   REFERENCE(object, member, KIND)          the index of a thing, or an array of them; -1: none
 *   LIST(object, member, count)              numbers or points, in memory of their own
 *   REFERENCES(object, member, count, KIND)  likewise of indices
 *   NUMBERS(object, member)                  an array of numbers
 *   NESTED(object, member, SECTION)          a mapping of that section, kept in an object within this one
 *   SECTION(SECTION)                         a mapping whose keys have rows of their own
 *   THINGS(SECTION)                          a mapping of names to things that have the keys of the section
 *   CHOICE(object, tag, value, field)        one of several keys: it also sets `tag` to `value`
 *   OF_RUNS(field)                           what is at rest does not depend on it
 *   NONE                                     nothing is kept
 *   BY_HAND                                  the section's reader and writer have code for the key
 *
 * All but BY_HAND are read and written by rows alone, unless their measure is CONTEXT: the unit of such
 * numbers is known to the section's reader.
 */
#ifndef STRUT_ENGINE_SCENE_THINGS_TABLE_H
#define STRUT_ENGINE_SCENE_THINGS_TABLE_H

#include "engine/scene/channels.h"

#include <math.h>

#include "engine/base/number_text.h"
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
  X(LOAD, "load", "loads", strut_load, loads, load_count, BY_HAND, .name = "", .node = -1, .signal = -1) \
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
  X(LAW, LIST(strut_law, x, count)) \
  X(LAW, LIST(strut_law, force, count)) \
  X(GROUND, FIELD(strut_ground_section, ground.present)) \
  X(CONTACT, REFERENCE(strut_contact, node, NODE)) \
  X(CONTACT, REFERENCE(strut_contact, ground, GROUND)) \
  X(CONTACT, FIELD(strut_contact, piece)) \
  X(SLIDER, REFERENCE(strut_sliding_mass, member, MEMBER)) \
  X(SETTLE, FIELD(strut_settle, wanted)) \
  X(SETTLE, FIELD(strut_settle, step))

#define STRUT_SCENE_FIELDS(X) \
  X(SCENE, VERSION, "strut", VERSION, NONE, ANY, "", REQUIRED, 0, "1", NONE, "Version of the language.") \
  X(SCENE, NAME, "name", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_scene, name), "Name of the scene, used in figures and tables.") \
  X(SCENE, DESCRIPTION, "description", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_scene, description), "What the scene shows.") \
  X(SCENE, SOURCE, "source", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_scene, source), "Where its numbers come from.") \
  X(SCENE, PARAMETERS, "parameters", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression or a quoted text", BY_HAND, "Named values that expressions may use and `--set` may change.") \
  X(SCENE, GROUPS, "groups", THINGS, NONE, ANY, "", OPTIONAL, 0, "keys of a member, a node, a contact or a hinge", BY_HAND, "Keys that several members, nodes, contacts or hinges share. A thing's own keys take precedence.") \
  X(SCENE, NODES, "nodes", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[x, y]` or the keys of a node", THINGS(NODE), "The points of the structure. Required unless parts are placed; the name of a placed thing changes or adds its keys, and `*` in it stands for any part of a name between dots.") \
  X(SCENE, MEMBERS, "members", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a member", THINGS(MEMBER), "The bars, springs and cables between the nodes.") \
  X(SCENE, HINGES, "hinges", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a hinge", THINGS(HINGE), "Springs of the angle between two arms that meet in a node.") \
  X(SCENE, CELLS, "cells", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a cell", THINGS(CELL), "Polygons of nodes under pressure.") \
  X(SCENE, PIPES, "pipes", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a pipe", THINGS(PIPE), "Flow of gas between cells.") \
  X(SCENE, COLLISIONS, "collisions", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a collision", THINGS(COLLISION), "Pairs of nodes and members that do not pass through each other.") \
  X(SCENE, DISTANCES, "distances", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a distance", THINGS(DISTANCE), "Springs of the distance of two nodes along a direction, or of a node from a line.") \
  X(SCENE, FEET, "feet", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a foot", THINGS(FOOT), "Circular arcs at ends of members, which roll on the ground.") \
  X(SCENE, BEAMS, "beams", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a beam", THINGS(BEAM), "Chains of bars and hinges that bend.") \
  X(SCENE, RAYLEIGH, "rayleigh", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(RAYLEIGH), "Damping of the whole structure by mass and by stiffness.") \
  X(SCENE, MASS_MODEL, "mass_model", WORD, NONE, ANY, "consistent", WRITTEN, 0, "consistent|lumped", FIELD(strut_scene, mass_model), "How a member's mass acts: `consistent` as that of a uniform rod (the paper's model), `lumped` as half of it at each end.") \
  X(SCENE, BARS, "bars", WORD, NONE, ANY, "elastic", OPTIONAL, 0, "elastic|rigid", FIELD(strut_scene, bar_model), "`rigid` bars keep, during a run, the length they have at its start; their stiffness and damping then count only while the structure settles.") \
  X(SCENE, GRAVITY, "gravity", PAIR, ACCELERATION, ANY, "[0, 0]", WRITTEN, 0, "", FIELD(strut_scene, gravity), "Gravitational acceleration.") \
  X(SCENE, LATTICE, "lattice", FREE, NONE, ANY, "", OPTIONAL, 0, "one or two displacements, such as [[1 m, 0]]", BY_HAND, "Steps by which the structure repeats without end, for `strut modes --wave`. A node that lies such a step from another one is that node of the next cell.") \
  X(SCENE, GROUND, "ground", MAP, NONE, ANY, "", OPTIONAL, 1, "", SECTION(GROUND), "The line that nodes may touch; without it there is no ground.") \
  X(SCENE, ACTUATORS, "actuators", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an actuator", THINGS(ACTUATOR), "Members whose rest length a signal changes, or to which it adds a force. Several actuators on one member add up.") \
  X(SCENE, LOADS, "loads", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a load", THINGS(LOAD), "Forces on nodes.") \
  X(SCENE, UNBALANCES, "unbalances", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an unbalance", THINGS(UNBALANCE), "Masses that rotate about nodes.") \
  X(SCENE, SIGNALS, "signals", THINGS, NONE, ANY, "", OPTIONAL, 0, "a signal", THINGS(SIGNAL), "Named signals, for use in several places.") \
  X(SCENE, CONFIGURATIONS, "configurations", THINGS, NONE, ANY, "", OPTIONAL, 0, "`{NODE: [x, y], ...}` or the keys of a [configuration](#configuration)", THINGS(CONFIGURATION), "Named shapes: to start from, and to name equilibria. Nodes that are not listed stay as drawn.") \
  X(SCENE, INITIAL, "initial", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(INITIAL), "The state at t = 0; by default the drawn shape at rest.") \
  X(SCENE, EQUILIBRIA, "equilibria", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(EQUILIBRIA), "Settings of the search for equilibria.") \
  X(SCENE, PATH, "path", FREE, NONE, ANY, "", OPTIONAL, 0, "the keys of a [path in stages](#path-in-stages)", BY_HAND, "What `strut path` follows, in stages, unless it is told otherwise.") \
  X(SCENE, SOLVER, "solver", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(SOLVER), "Method, time step and accuracy. Required for a run.") \
  X(SCENE, RUN, "run", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(RUN), "Duration and measurement. Required for a run.") \
  X(SCENE, OUTPUT, "output", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(OUTPUT), "What is recorded.") \
  X(SCENE, GROUNDS, "grounds", THINGS, NONE, ANY, "", OPTIONAL, 1, "the keys of [ground](#ground)", THINGS(GROUND), "Several grounds, instead of `ground`: walls, profiles, circles. Nodes touch all of them.") \
  X(SCENE, SLIDERS, "sliders", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a slider", THINGS(SLIDER), "Masses on members, along which they may slide.") \
  X(SCENE, SENSORS, "sensors", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a sensor", THINGS(SENSOR), "Numbers of the motion that the expressions of signals may use.") \
  X(SCENE, STATES, "states", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a state", THINGS(STATE), "Numbers that a run integrates beside the motion.") \
  X(SCENE, OSCILLATORS, "oscillators", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an oscillator", THINGS(OSCILLATOR), "Phase oscillators, each an internal state with the same name.") \
  X(SCENE, CONTROLLERS, "controllers", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a controller", THINGS(CONTROLLER), "PID controllers and relays, each a signal with the same name.") \
  X(SCENE, PARTS, "parts", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a part", THINGS(PART), "Structures to be placed, once or many times.") \
  X(SCENE, PLACE, "place", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a [place](#place)", THINGS(PLACE), "Copies of parts. What is in a copy is called `NAME.THING`, or `NAME.0.THING` and so on where it is repeated.") \
  X(SCENE, MERGE, "merge", FREE, NONE, ANY, "", OPTIONAL, 0, "touching, or {node: other node, ...}", BY_HAND, "Nodes that become one: those named, or with `touching` all that lie in one place.") \
  X(SCENE, LIMIT_THINGS, "limit_things", NUMBER, NONE, WHOLE(1, STRUT_MOST_THINGS), "500000", OPTIONAL, 0, "", BY_HAND, "How many nodes, members and other things all copies of parts may have together, and how many contacts a profile; more need memory and time.") \
  X(SCENE, BASE, "base", TEXT, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Another scene's file, relative to this one: the scene is that one with the keys here laid over it, and `NAME: remove` takes things away.")

#define STRUT_NODE_FIELDS(X) \
  X(NODE, POSITION, "position", PAIR, LENGTH, ANY, "", REQUIRED, 0, "", FIELD(strut_node, position), "Position in the drawn shape.") \
  X(NODE, GROUP, "group", GROUPS, NONE, ANY, "", OPTIONAL, 0, "", NONE, "Groups that provide defaults; later groups take precedence.") \
  X(NODE, MASS, "mass", NUMBER, MASS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_node, mass), "Point mass, in addition to the masses of the members.") \
  X(NODE, FIXED, "fixed", FIXED, NONE, ANY, "none", OPTIONAL, 0, "none|x|y|both", FIELD(strut_node, fixed), "Supported directions; also as a list, `[x, y]`.") \
  X(NODE, MOVES, "moves", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Directions in which a signal moves the node, which is then supported there.")

#define STRUT_MOVES_FIELDS(X) \
  X(MOVES, ALONG_X, "x", SIGNAL, LENGTH, ANY, "", OPTIONAL, 0, "", FIELD(strut_moves, signal[0]), "Added to the x of the node's position.") \
  X(MOVES, ALONG_Y, "y", SIGNAL, LENGTH, ANY, "", OPTIONAL, 0, "", FIELD(strut_moves, signal[1]), "Added to the y of the node's position.")

#define STRUT_MEMBER_FIELDS(X) \
  X(MEMBER, GROUP, "group", GROUPS, NONE, ANY, "", OPTIONAL, 0, "", NONE, "Groups that provide defaults; later groups take precedence.") \
  X(MEMBER, NODES, "nodes", NODE_PATH, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "The two nodes that the member joins. A cable may run over further nodes, its guides, without friction unless `guide_friction` is given: `[a, p, q, b]`; it then has one tension along its whole length, and its mass is lumped.") \
  X(MEMBER, KIND, "kind", WORD, NONE, ANY, "", REQUIRED, 0, "bar|spring|cable", FIELD(strut_member, kind), "Bars and springs carry tension and compression; a cable carries tension only and no force while slack. `strut` is another word for `bar`, `string` for `cable`.") \
  X(MEMBER, STIFFNESS, "stiffness", NUMBER, STIFFNESS, NOT_NEGATIVE, "0", OPTIONAL, 1, "", FIELD(strut_member, stiffness), "Force per elongation.") \
  X(MEMBER, AXIAL_STIFFNESS, "axial_stiffness", NUMBER, FORCE, NOT_NEGATIVE, "", OPTIONAL, 1, "", FIELD(strut_member, axial_stiffness), "EA; the stiffness is EA / rest length, also while an actuator changes that.") \
  X(MEMBER, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 8, "", FIELD(strut_member, damping), "Force per rate of elongation.") \
  X(MEMBER, DAMPING_RATIO, "damping_ratio", NUMBER, NONE, NOT_NEGATIVE, "0", OPTIONAL, 8, "", FIELD(strut_member, damping_ratio), "Instead of `damping`, zeta: the damping is 2 zeta sqrt(c m), with the stiffness c at the rest length and m the reduced mass of the member's two ends, 1/m = 1/m1 + 1/m2, along the member as drawn. m1 and m2 are lumped masses, half of each member's at each end; a supported direction is infinitely heavy.") \
  X(MEMBER, MASS, "mass", NUMBER, MASS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_member, mass), "Mass of the whole member.") \
  X(MEMBER, REST_LENGTH, "rest_length", NUMBER, LENGTH, NOT_NEGATIVE, "", OPTIONAL, 2, "", CHOICE(strut_member, rest_kind, STRUT_REST_LENGTH, FIELD(strut_member, rest_value)), "Length at which the member carries no force.") \
  X(MEMBER, REST_LENGTH_RATIO, "rest_length_ratio", NUMBER, NONE, NOT_NEGATIVE, "1", OPTIONAL, 2, "", CHOICE(strut_member, rest_kind, STRUT_REST_RATIO, FIELD(strut_member, rest_value)), "Rest length / drawn length.") \
  X(MEMBER, PRETENSION, "pretension", NUMBER, FORCE, ANY, "", OPTIONAL, 2, "", CHOICE(strut_member, rest_kind, STRUT_REST_PRETENSION, FIELD(strut_member, rest_value)), "Force in the drawn shape; tension is positive.") \
  X(MEMBER, FORCE_DENSITY, "force_density", NUMBER, STIFFNESS, ANY, "", OPTIONAL, 2, "", CHOICE(strut_member, rest_kind, STRUT_REST_FORCE_DENSITY, FIELD(strut_member, rest_value)), "Force in the drawn shape / drawn length.") \
  X(MEMBER, LAW, "law", LAW, FORCE, ANY, "linear", OPTIONAL, 0, "", NESTED(strut_member, law, LAW), "Law of the force over the elongation, length - rest length. A cable carries tension only under every law.") \
  X(MEMBER, SHORTEST, "shortest", NUMBER, LENGTH, NOT_NEGATIVE, "none", OPTIONAL, 0, "", FIELD(strut_member, shortest), "Length below which a stop pushes the ends apart.") \
  X(MEMBER, LONGEST, "longest", NUMBER, LENGTH, ABOVE_ZERO, "none", OPTIONAL, 0, "", FIELD(strut_member, longest), "Length beyond which a stop pulls the ends together.") \
  X(MEMBER, STOP_STIFFNESS, "stop_stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "a hundred times the stiffness", OPTIONAL, 0, "", FIELD(strut_member, stop_stiffness), "Stiffness of the stops.") \
  X(MEMBER, STOP_DAMPING, "stop_damping", NUMBER, DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_member, stop_damping), "Damping of a stop while it acts; a stop never holds its member back.") \
  X(MEMBER, MAXWELL, "maxwell", MAP, NONE, ANY, "", OPTIONAL, 0, "Maxwell branch", OF_RUNS(NESTED(strut_member, maxwell, MAXWELL)), "A spring and a dashpot in a row, beside the member.") \
  X(MEMBER, BREAKS_AT, "breaks_at", NUMBER, FORCE, ABOVE_ZERO, "never", OPTIONAL, 0, "", OF_RUNS(FIELD(strut_member, breaks_at)), "Tension at which the member breaks: from then on it carries nothing for the rest of the run. What it stored is lost. Statics and settling take it as whole.") \
  X(MEMBER, RELEASED_AT, "released_at", NUMBER, TIME, ABOVE_ZERO, "never", OPTIONAL, 0, "", OF_RUNS(FIELD(strut_member, released_at)), "Time from which on the member carries nothing, as a latch that is released.") \
  X(MEMBER, GUIDE_FRICTION, "guide_friction", NUMBER, NONE, NOT_NEGATIVE, "0", OPTIONAL, 0, "", OF_RUNS(FIELD(strut_member, guide_friction)), "Friction coefficient mu of a running cable at its guides: over a guide at which it turns by theta, the tensions differ by the factor exp(mu theta) at most. Statics takes the guides without friction unless a path keeps it; so does settling.") \
  X(MEMBER, GUIDE_RADIUS, "guide_radius", NUMBER, LENGTH, ABOVE_ZERO, "points", OPTIONAL, 0, "", FIELD(strut_member, guide_radius), "Radius of the guides: circles about their nodes, round which the cable leads for as long as it is pulled against them.") \
  X(MEMBER, GUIDE_SIDE, "guide_side", WORD, NONE, ANY, "drawn", OPTIONAL, 0, "drawn|left|right", FIELD(strut_member, guide_side), "On which side of the cable, followed from its first node to its last, the centres of guides with a radius are: `left`, `right`, or each as the cable turns over it in the drawn shape.")

#define STRUT_HINGE_FIELDS(X) \
  X(HINGE, NODES, "nodes", NODE_TRIPLE, NONE, ANY, "", REQUIRED, 0, "", REFERENCE(strut_hinge, node, NODE), "Three nodes `[a, b, c]`: the hinge is at b, and its angle is that from the arm b-a to the arm b-c, counter-clockwise.") \
  X(HINGE, STIFFNESS, "stiffness", NUMBER, ANGULAR_STIFFNESS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_hinge, stiffness), "Moment per angle.") \
  X(HINGE, DAMPING, "damping", NUMBER, ANGULAR_DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_hinge, damping), "Moment per angular velocity.") \
  X(HINGE, REST_ANGLE, "rest_angle", NUMBER, ANGLE, ANY, "as drawn", OPTIONAL, 0, "", FIELD(strut_hinge, rest_angle), "Angle at which the hinge has no moment. The angle is continuous over whole turns; at the start it is within half a turn of this one.") \
  X(HINGE, LAW, "law", LAW, MOMENT, ANY, "linear", OPTIONAL, 0, "", NESTED(strut_hinge, law, LAW), "Law of the moment over angle - rest angle.") \
  X(HINGE, BREAKS_AT, "breaks_at", NUMBER, MOMENT, ABOVE_ZERO, "never", OPTIONAL, 0, "", OF_RUNS(FIELD(strut_hinge, breaks_at)), "Size of the moment at which the hinge breaks: from then on it has none.") \
  X(HINGE, RELEASED_AT, "released_at", NUMBER, TIME, ABOVE_ZERO, "never", OPTIONAL, 0, "", OF_RUNS(FIELD(strut_hinge, released_at)), "Time from which on the hinge has no moment.") \
  X(HINGE, GROUP, "group", GROUPS, NONE, ANY, "", OPTIONAL, 0, "", NONE, "Groups that provide defaults; later groups take precedence.")

#define STRUT_CELL_FIELDS(X) \
  X(CELL, NODES, "nodes", NODE_RING, NONE, ANY, "", REQUIRED, 0, "", REFERENCES(strut_cell, node, node_count, NODE), "The corners `[a, b, c, ...]` in order, in either sense. They need no members between them.") \
  X(CELL, PRESSURE, "pressure", NUMBER, STIFFNESS, ANY, "", OPTIONAL, 7, "", CHOICE(strut_cell, law, STRUT_LAW_PRESSURE, FIELD(strut_cell, pressure)), "Given pressure, force per length of the boundary, outwards; negative: suction. An actuator may change it.") \
  X(CELL, GAS, "gas", MAP, NONE, ANY, "", OPTIONAL, 7, "", BY_HAND, "A closed gas, whose pressure follows from the area.") \
  X(CELL, STIFFNESS, "stiffness", NUMBER, AREA_STIFFNESS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_cell, stiffness), "Of an elastic cell, instead of a pressure or a gas: pressure per loss of area.") \
  X(CELL, DAMPING, "damping", NUMBER, AREA_DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_cell, damping), "Of an elastic cell: pressure per rate at which it loses area.") \
  X(CELL, REST_AREA, "rest_area", NUMBER, AREA, ABOVE_ZERO, "as drawn", OPTIONAL, 0, "", FIELD(strut_cell, rest_area), "Area at which an elastic cell has no pressure.") \
  X(CELL, LAW, "law", LAW, PRESSURE, ANY, "linear", OPTIONAL, 0, "", NESTED(strut_cell, elastic, LAW), "Law of an elastic cell, of minus the pressure over area - rest area. With `compression` it only resists being squeezed.")

#define STRUT_GAS_FIELDS(X) \
  X(GAS, KIND, "kind", WORD, NONE, ANY, "", REQUIRED, 0, "isothermal|isentropic", BY_HAND, "With the area A, A0 as drawn: `isothermal`, p = pressure * A0 / A. `isentropic`, p = pressure * (A0 / A)^exponent.") \
  X(GAS, PRESSURE, "pressure", NUMBER, STIFFNESS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_cell, pressure), "Absolute pressure as drawn.") \
  X(GAS, EXPONENT, "exponent", NUMBER, NONE, ABOVE_ZERO, "1.4", OPTIONAL, 0, "", FIELD(strut_cell, exponent), "Isentropic exponent, above 1.") \
  X(GAS, OUTSIDE, "outside", NUMBER, STIFFNESS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_cell, outside), "Absolute pressure outside, which pushes inwards.")

#define STRUT_COLLISION_FIELDS(X) \
  X(COLLISION, NODE, "node", NAME, NONE, ANY, "", OPTIONAL, 0, "", CHOICE(strut_collision, node[1], UINT32_MAX, REFERENCE(strut_collision, node[0], NODE)), "A node that may touch the `member`.") \
  X(COLLISION, MEMBER, "member", NAME, NONE, ANY, "", OPTIONAL, 8, "", CHOICE(strut_collision, member[1], UINT32_MAX, REFERENCE(strut_collision, member[0], MEMBER)), "The member that the `node` may touch; a straight line between its ends, which are round.") \
  X(COLLISION, NODES, "nodes", NAME_PAIR, NONE, ANY, "", OPTIONAL, 8, "", REFERENCE(strut_collision, node, NODE), "Two nodes that may touch each other as discs.") \
  X(COLLISION, MEMBERS, "members", NAME_PAIR, NONE, ANY, "", OPTIONAL, 8, "", REFERENCE(strut_collision, member, MEMBER), "Two members that may touch each other: each end of one with the other.") \
  X(COLLISION, BETWEEN, "between", FREE, NONE, ANY, "", OPTIONAL, 8, "all, a group of members, or two of these", BY_HAND, "Every two straight members of these: of all, of a group, or one of each group. Left out are members that share a node, and those that cross or are nearer than the thickness as drawn.") \
  X(COLLISION, THICKNESS, "thickness", NUMBER, LENGTH, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_collision, thickness), "Distance of the two axes or centres at which they touch.") \
  X(COLLISION, STIFFNESS, "stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_collision, stiffness), "Force per depth.") \
  X(COLLISION, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_collision, damping), "Force per speed of approach while they touch; a collision never pulls.") \
  X(COLLISION, FRICTION, "friction", MAP, NONE, ANY, "", OPTIONAL, 0, "friction", OF_RUNS(NESTED(strut_collision, friction, RUBBING)), "Friction of the two on each other.")

#define STRUT_DISTANCE_FIELDS(X) \
  X(DISTANCE, NODES, "nodes", NAME_PAIR, NONE, ANY, "", OPTIONAL, 8, "", REFERENCE(strut_distance_spring, node, NODE), "Two nodes `[a, b]`: the distance is how far b is ahead of a in the direction `along`; it may be negative.") \
  X(DISTANCE, ALONG, "along", FREE, NONE, ANY, "", OPTIONAL, 0, "x, y, or an angle from +x", BY_HAND, "The direction of the distance of two nodes. In a copy of a part it turns with the copy.") \
  X(DISTANCE, NODE, "node", NAME, NONE, ANY, "", OPTIONAL, 8, "", CHOICE(strut_distance_spring, node[1], UINT32_MAX, REFERENCE(strut_distance_spring, node[0], NODE)), "A node, whose distance from the `line` counts.") \
  X(DISTANCE, LINE, "line", NAME_PAIR, NONE, ANY, "", OPTIONAL, 0, "", REFERENCE(strut_distance_spring, line, NODE), "Two nodes `[a, b]`: the distance is that of the `node` from the straight line through them, positive on the left of the way from a to b.") \
  X(DISTANCE, STIFFNESS, "stiffness", NUMBER, STIFFNESS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_distance_spring, stiffness), "Force per distance.") \
  X(DISTANCE, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_distance_spring, damping), "Force per rate of the distance.") \
  X(DISTANCE, REST_DISTANCE, "rest_distance", NUMBER, LENGTH, ANY, "as drawn", OPTIONAL, 0, "", FIELD(strut_distance_spring, rest_distance), "Distance without force, of either sign.") \
  X(DISTANCE, LAW, "law", LAW, FORCE, ANY, "linear", OPTIONAL, 0, "", NESTED(strut_distance_spring, law, LAW), "Law of the force over distance - rest distance; with `compression_only` the node is kept ahead of the other, or on the left of the line, as by a wall.")

#define STRUT_FOOT_FIELDS(X) \
  X(FOOT, MEMBER, "member", NAME, NONE, ANY, "", REQUIRED, 0, "", REFERENCE(strut_foot, member, MEMBER), "The member that the arc is fixed to: its middle lies on the member's line, `radius` from the node.") \
  X(FOOT, NODE, "node", NAME, NONE, ANY, "", REQUIRED, 0, "", REFERENCE(strut_foot, node, NODE), "The end of the member through which the arc passes, square to it. The node's contact with each ground says how the foot touches it.") \
  X(FOOT, RADIUS, "radius", NUMBER, LENGTH, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_foot, radius), "Radius of the arc.")

#define STRUT_LAW_FIELDS(X) \
  X(LAW, KIND, "kind", WORD, NONE, ANY, "linear", WRITTEN, 0, STRUT_LAW_WORDS, FIELD(strut_law, kind), "With the stiffness k and x the elongation: `linear`, k x. `bilinear`, k x up to the knee on either side, then with the slope `second_stiffness`. `play`, no force within the gap on either side, beyond it k times the excess. `elastic_plastic`, k x until the force reaches the yield, then with the slope `second_stiffness`, and back along k: what has yielded stays. `polynomial`, c1 x + c2 x^2 + ... `logarithmic`, k L ln(length / L) with the rest length L. `exponential`, k s (exp(x / s) - 1) with the scale s. `table`, through points. `curve`, along points in any order of x: it may fold back, where statics follow it and a motion jumps.") \
  X(LAW, CARRIES, "carries", WORD, NONE, ANY, "both", OPTIONAL, 0, "both|tension|compression", FIELD(strut_law, carries), "Forces that are carried: with `tension` the element acts beyond its rest length only, with `compression` below it.") \
  X(LAW, KNEE, "knee", NUMBER, CONTEXT, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_law, knee), "Elongation at which a bilinear law changes its slope.") \
  X(LAW, SECOND_STIFFNESS, "second_stiffness", NUMBER, CONTEXT, ANY, "", OPTIONAL, 0, "", FIELD(strut_law, second_stiffness), "Slope of a bilinear law beyond its knee, and of an elastic-plastic law beyond its yield, where 0 is the default.") \
  X(LAW, GAP, "gap", NUMBER, CONTEXT, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_law, gap), "Free play to either side of the rest length.") \
  X(LAW, SCALE, "scale", NUMBER, CONTEXT, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_law, scale), "Elongation over which the slope of an exponential law grows by the factor e.") \
  X(LAW, YIELD, "yield", NUMBER, CONTEXT, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_law, yield), "Force, or moment of a hinge, at which an elastic-plastic law gives way.") \
  X(LAW, COEFFICIENTS, "coefficients", NUMBERS, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "Coefficients of x, x^2, ... of a polynomial, such as `[10 N/m, 0, 1e5 N/m^3]`.") \
  X(LAW, POINTS, "points", POINTS, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "Points `[[x, force], ...]` of a table, such as `[[-1 mm, -5 N], [0, 0], [2 mm, 3 N]]`, with increasing x, or of a curve, whose x may fall; beyond the ends it continues straight.") \
  X(LAW, CONTROL_POINTS, "control_points", POINTS, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "Control points `[[x, force], ...]` of one Bezier curve, at most 64, instead of the `points` of a curve.") \
  X(LAW, ROUNDING, "rounding", NUMBER, NONE, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_law, rounding), "Rounds the corners of a curve: this share of each piece, below 1, goes to the parabolas at its two ends.") \
  X(LAW, MIRRORED, "mirrored", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_law, mirrored), "The points of a table or a curve, from `[0, 0]` on, hold for negative x too, with the opposite force.") \
  X(LAW, SMOOTH, "smooth", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_law, smooth), "A table by a monotone spline through its points (Steffen) instead of straight lines.")

#define STRUT_RAYLEIGH_FIELDS(X) \
  X(RAYLEIGH, MASS, "mass", NUMBER, FREQUENCY, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_scene, rayleigh_mass), "alpha: the force -alpha M v on the nodes, with the mass matrix M of the run.") \
  X(RAYLEIGH, STIFFNESS, "stiffness", NUMBER, TIME, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_scene, rayleigh_stiffness), "beta: adds beta times the stiffness at the rest length to the damping of every member and hinge.")

#define STRUT_GROUND_FIELDS(X) \
  X(GROUND, HEIGHT, "height", NUMBER, LENGTH, ANY, "0", OPTIONAL, 1, "", FIELD(strut_ground_section, ground.height), "Height of the line at x = 0.") \
  X(GROUND, SLOPE, "slope", NUMBER, ANGLE, ANY, "0", OPTIONAL, 2, "", FIELD(strut_ground_section, ground.slope), "Angle of the line, between -90 deg and 90 deg; positive where it rises towards +x. With `through` any angle: the solid is to the right of the direction in which the angle points, so that 90 deg is a wall whose free side is at -x.") \
  X(GROUND, BELT_SPEED, "belt_speed", NUMBER, VELOCITY, ANY, "0", OPTIONAL, 0, "", OF_RUNS(FIELD(strut_ground_section, ground.belt_speed)), "Speed of the surface along itself, positive towards +x.") \
  X(GROUND, STIFFNESS, "stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_ground_section, contact.stiffness), "Normal force per penetration depth.") \
  X(GROUND, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_ground_section, contact.damping), "Normal force per speed of a node that moves into the ground.") \
  X(GROUND, DAMPING_LAW, "damping_law", WORD, NONE, ANY, "approach_only", OPTIONAL, 0, "approach_only|hunt_crossley", FIELD(strut_ground_section, ground.damping_law), "Damping at contacts. `approach_only`: stiffness * depth + damping * speed inwards, without damping while the node moves out (the paper's law, with a jump at touchdown). `hunt_crossley`: stiffness * depth * (1 + dissipation * speed inwards), never tensile, without a jump.") \
  X(GROUND, DISSIPATION, "dissipation", NUMBER, DISSIPATION, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_ground_section, contact.dissipation), "Dissipation of the Hunt-Crossley law, which uses it instead of `damping`.") \
  X(GROUND, FRICTION, "friction", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Friction of every contact; without it the ground is frictionless.") \
  X(GROUND, NODES, "nodes", CONTACT_NODES, NONE, ANY, "all", OPTIONAL, 0, "", BY_HAND, "The nodes that may touch the ground; `all` are those that nothing moves.") \
  X(GROUND, CONTACTS, "contacts", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a contact", THINGS(CONTACT), "Settings of single contacts, by the name of the node.") \
  X(GROUND, THROUGH, "through", PAIR, LENGTH, ANY, "", OPTIONAL, 1, "", CHOICE(strut_ground_section, ground.placed, true, FIELD(strut_ground_section, ground.through)), "A point of the line, instead of `height`.") \
  X(GROUND, NORMAL, "normal", PAIR, NONE, ANY, "", OPTIONAL, 2, "", BY_HAND, "A vector out of the solid, of any length, instead of `slope`.") \
  X(GROUND, PROFILE, "profile", PROFILE, NONE, ANY, "", OPTIONAL, 3, "", CHOICE(strut_ground_section, ground.shape, STRUT_GROUND_PROFILE, LIST(strut_ground_section, ground.points, ground.point_count)), "Points of a polyline, instead of a line: the solid is to the right of its direction, and its ends continue straight. In a concave corner a node touches both sides.") \
  X(GROUND, CIRCLE, "circle", MAP, NONE, ANY, "", OPTIONAL, 3, "", CHOICE(strut_ground_section, ground.shape, STRUT_GROUND_CIRCLE, NESTED(strut_ground_section, ground, CIRCLE)), "A circle, instead of a line.") \
  X(GROUND, MOTION, "motion", MAP, NONE, ANY, "", OPTIONAL, 0, "", NESTED(strut_ground_section, ground, MOTION), "Shakes the ground: displacements by signals.")

#define STRUT_CIRCLE_FIELDS(X) \
  X(CIRCLE, CENTRE, "centre", PAIR, LENGTH, ANY, "", REQUIRED, 0, "", FIELD(strut_ground, centre), "Its centre.") \
  X(CIRCLE, RADIUS, "radius", NUMBER, LENGTH, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_ground, radius), "Its radius.") \
  X(CIRCLE, INSIDE, "inside", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_ground, inside), "Nodes are inside of it, as in a pipe or a hoop; otherwise it is solid.")

#define STRUT_MOTION_FIELDS(X) \
  X(MOTION, IN_X, "x", SIGNAL, LENGTH, ANY, "", OPTIONAL, 0, "", OF_RUNS(CHOICE(strut_ground, moves[0], true, FIELD(strut_ground, motion[0]))), "Displacement in x.") \
  X(MOTION, IN_Y, "y", SIGNAL, LENGTH, ANY, "", OPTIONAL, 0, "", OF_RUNS(CHOICE(strut_ground, moves[1], true, FIELD(strut_ground, motion[1]))), "Displacement in y.")

#define STRUT_FRICTION_FIELDS(X) \
  X(FRICTION, LAW, "law", WORD, NONE, ANY, "karnopp", WRITTEN, 0, STRUT_FRICTION_WORDS, FIELD(strut_friction, law), "`karnopp`: Coulomb friction with a stick band (the paper's law). `coulomb`: exact sticking; needs a method with events. `smooth`: the regularised law -mu_kinetic N u / sqrt(u^2 + width^2), under which contacts creep. `stribeck`: the same with a coefficient that falls from mu_static to mu_kinetic. `lugre`: bristles that bend before they slide, with the same coefficients; on straight grounds at rest.") \
  X(FRICTION, MU, "mu", FREE, NONE, NOT_NEGATIVE, "", OPTIONAL, 0, "a number, a signal or the name of one", BY_HAND, "Both friction coefficients. Those of a signal change with time, and are 0 where it is negative; settling takes that of t = 0.") \
  X(FRICTION, MU_STATIC, "mu_static", NUMBER, NONE, NOT_NEGATIVE, "", OPTIONAL, 0, "", FIELD(strut_friction, mu_static), "Coefficient of static friction.") \
  X(FRICTION, MU_KINETIC, "mu_kinetic", NUMBER, NONE, NOT_NEGATIVE, "", OPTIONAL, 0, "", FIELD(strut_friction, mu_kinetic), "Coefficient of kinetic friction.") \
  X(FRICTION, MU_FORWARD, "mu_forward", NUMBER, NONE, NOT_NEGATIVE, "", OPTIONAL, 0, "", BY_HAND, "Both coefficients against motion towards +x along the ground, where those against motion towards -x differ.") \
  X(FRICTION, MU_FORWARD_STATIC, "mu_forward_static", NUMBER, NONE, NOT_NEGATIVE, "`mu_forward`", OPTIONAL, 0, "", BY_HAND, "Coefficient of static friction against motion towards +x.") \
  X(FRICTION, MU_BACKWARD, "mu_backward", NUMBER, NONE, NOT_NEGATIVE, "as forward", OPTIONAL, 0, "", FIELD(strut_friction, mu_kinetic_backward), "Both coefficients against motion towards -x along the ground.") \
  X(FRICTION, MU_BACKWARD_STATIC, "mu_backward_static", NUMBER, NONE, NOT_NEGATIVE, "`mu_backward`", OPTIONAL, 0, "", FIELD(strut_friction, mu_static_backward), "Coefficient of static friction against motion towards -x.") \
  X(FRICTION, STICK_VELOCITY, "stick_velocity", NUMBER, VELOCITY, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_friction, stick_velocity), "Half the width of the stick band; Karnopp's law needs it.") \
  X(FRICTION, WIDTH, "width", NUMBER, VELOCITY, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_friction, width), "Sliding speed at which the smooth law reaches 0.71 of the full friction; that law and Stribeck's need it.") \
  X(FRICTION, DECAY_VELOCITY, "decay_velocity", NUMBER, VELOCITY, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_friction, decay_velocity), "Sliding speed at which Stribeck's coefficient is half way from mu_static to mu_kinetic; that law and `lugre` need it.") \
  X(FRICTION, PRESLIDING, "presliding", NUMBER, LENGTH, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_friction, presliding), "Slip that bends bristles until they hold mu_static; `lugre` needs it.") \
  X(FRICTION, RELAXATION, "relaxation", NUMBER, TIME, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_friction, relaxation), "Time in which free bristles straighten; `lugre` needs it.")

#define STRUT_CONTACT_FIELDS(X) \
  X(CONTACT, GROUP, "group", GROUPS, NONE, ANY, "", OPTIONAL, 0, "", NONE, "Groups that provide defaults; later groups take precedence.") \
  X(CONTACT, STIFFNESS, "stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "the ground's", OPTIONAL, 0, "", FIELD(strut_contact, stiffness), "Replaces the value of the ground.") \
  X(CONTACT, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "the ground's", OPTIONAL, 0, "", FIELD(strut_contact, damping), "Replaces the value of the ground.") \
  X(CONTACT, DISSIPATION, "dissipation", NUMBER, DISSIPATION, NOT_NEGATIVE, "the ground's", OPTIONAL, 0, "", FIELD(strut_contact, dissipation), "Replaces the value of the ground.") \
  X(CONTACT, FRICTION, "friction", MAP, NONE, ANY, "the ground's", OPTIONAL, 0, "", BY_HAND, "Replaces single keys of the ground's friction.")

#define STRUT_ACTUATOR_FIELDS(X) \
  X(ACTUATOR, MEMBER, "member", NAME, NONE, ANY, "", OPTIONAL, 6, "", REFERENCE(strut_actuator, member, MEMBER), "The member whose rest length it changes, or to which it adds a force.") \
  X(ACTUATOR, HINGE, "hinge", NAME, NONE, ANY, "", OPTIONAL, 6, "", REFERENCE(strut_actuator, hinge, HINGE), "The hinge whose rest angle it changes, or to which it adds a moment.") \
  X(ACTUATOR, CELL, "cell", NAME, NONE, ANY, "", OPTIONAL, 6, "", REFERENCE(strut_actuator, cell, CELL), "The cell whose given pressure it changes, or that of an isothermal gas at the area as drawn, by letting gas in or out.") \
  X(ACTUATOR, SIGNAL, "signal", SIGNAL, CONTEXT, ANY, "", OPTIONAL, 7, "", BY_HAND, "Added to the rest length of the member, to the rest angle of the hinge, or to the pressure of the cell.") \
  X(ACTUATOR, FORCE, "force", SIGNAL, FORCE, ANY, "", OPTIONAL, 7, "", BY_HAND, "Instead of `signal`: a force added to the member's own, tension positive. Statics leave it out.") \
  X(ACTUATOR, MOMENT, "moment", SIGNAL, CONTEXT, ANY, "", OPTIONAL, 7, "", BY_HAND, "Instead of `signal`: a moment added to the hinge's own, which closes its angle where positive. Statics leave it out.")

#define STRUT_LOAD_FIELDS(X) \
  X(LOAD, NODE, "node", NAME, NONE, ANY, "", REQUIRED, 0, "", REFERENCE(strut_load, node, NODE), "The node on which the force acts.") \
  X(LOAD, FORCE, "force", PAIR, FORCE, ANY, "", REQUIRED, 0, "", FIELD(strut_load, force), "The force; with a signal, the force while the signal is 1.") \
  X(LOAD, SIGNAL, "signal", SIGNAL, NONE, ANY, "constant 1", OPTIONAL, 0, "", FIELD(strut_load, signal), "Factor on the force.")

#define STRUT_UNBALANCE_FIELDS(X) \
  X(UNBALANCE, NODE, "node", NAME, NONE, ANY, "", REQUIRED, 0, "", REFERENCE(strut_unbalance, node, NODE), "The node about which it rotates.") \
  X(UNBALANCE, MASS, "mass", NUMBER, MASS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_unbalance, mass), "The rotating mass, which counts to the node's mass.") \
  X(UNBALANCE, RADIUS, "radius", NUMBER, LENGTH, NOT_NEGATIVE, "", REQUIRED, 0, "", OF_RUNS(FIELD(strut_unbalance, radius)), "Its distance from the node.") \
  X(UNBALANCE, SPEED, "speed", NUMBER, CONTEXT, ANY, "", OPTIONAL, 9, "", BY_HAND, "Its constant speed, counter-clockwise: turns per second such as 30 Hz, or 188 rad/s; a plain number is in rad/s.") \
  X(UNBALANCE, SIGNAL, "angle", SIGNAL, ANGLE, ANY, "", OPTIONAL, 9, "", OF_RUNS(FIELD(strut_unbalance, signal)), "Its angle instead, as a signal that must not jump.") \
  X(UNBALANCE, PHASE, "phase", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", OF_RUNS(FIELD(strut_unbalance, phase)), "Added to the angle, which counts from +x.")

#define STRUT_SLIDER_FIELDS(X) \
  X(SLIDER, MEMBER, "member", NAME, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "The member on whose straight line between its two nodes it is.") \
  X(SLIDER, MASS, "mass", NUMBER, MASS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_sliding_mass, mass), "The mass, a point.") \
  X(SLIDER, POSITION, "position", NUMBER, CONTEXT, ANY, "0", OPTIONAL, 0, "", FIELD(strut_sliding_mass, share), "Where it is: a share of the member, such as 50 %, or a length as drawn, from its first node.") \
  X(SLIDER, MOVES, "moves", SIGNAL, NONE, ANY, "", OPTIONAL, 1, "", OF_RUNS(CHOICE(strut_sliding_mass, travel, false, FIELD(strut_sliding_mass, signal))), "Added to the position, as a share of the member: a signal that must not jump.") \
  X(SLIDER, TRAVEL, "travel", SIGNAL, LENGTH, ANY, "", OPTIONAL, 1, "", OF_RUNS(CHOICE(strut_sliding_mass, travel, true, FIELD(strut_sliding_mass, signal))), "The same as a length along the member as drawn, which stretches with it.")

#define STRUT_SIGNAL_FIELDS(X) \
  X(SIGNAL, CONSTANT, "constant", NUMBER, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "A constant, for t >= 0.") \
  X(SIGNAL, SINE, "sine", MAP, NONE, ANY, "", OPTIONAL, 0, "", CHOICE(strut_signal, kind, STRUT_SINE, SECTION(SINE)), "amplitude * sin(2 pi frequency (t - start) + phase).") \
  X(SIGNAL, HALF_SINE, "half_sine", MAP, NONE, ANY, "", OPTIONAL, 0, "", CHOICE(strut_signal, kind, STRUT_HALF_SINE, SECTION(HALF_SINE)), "One half-wave of a sine, then 0.") \
  X(SIGNAL, SQUARE, "square", MAP, NONE, ANY, "", OPTIONAL, 0, "", CHOICE(strut_signal, kind, STRUT_SQUARE, SECTION(SQUARE)), "+amplitude in the first half of each period, -amplitude in the second.") \
  X(SIGNAL, RAMP, "ramp", MAP, NONE, ANY, "", OPTIONAL, 0, "", CHOICE(strut_signal, kind, STRUT_RAMP, SECTION(RAMP)), "Rises linearly from 0 at `start` to amplitude at `stop` and stays there.") \
  X(SIGNAL, TABLE, "table", TABLE, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "Points `[[t, value], ...]`, interpolated linearly; constant before the first and after the last.") \
  X(SIGNAL, SUM, "sum", SIGNALS, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "The sum of the listed signals.") \
  X(SIGNAL, EXPRESSION, "expression", EXPRESSION, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "An expression of the time `t`, parameters, [sensors](#sensor) and other signals by their names, evaluated whenever forces are.") \
  X(SIGNAL, STARTS, "starts", MAP, NONE, ANY, "", OPTIONAL, 0, "start", NESTED(strut_signal, trigger, STARTS), "Beside one of the keys above: the event with which the time of the signal begins. Before it the signal is 0.") \
  X(SIGNAL, LAG, "lag", NUMBER, TIME, ABOVE_ZERO, "0", OPTIONAL, 0, "", FIELD(strut_signal, lag), "Beside one of the keys above: time constant of a first-order lag, which begins at 0. It comes before sampling.") \
  X(SIGNAL, EVERY, "every", NUMBER, TIME, ABOVE_ZERO, "0", OPTIONAL, 0, "", FIELD(strut_signal, every), "Beside one of the keys above: the signal is sampled at the multiples of this time, and held in between.")

#define STRUT_SINE_FIELDS(X) \
  X(SINE, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, amplitude), "Largest value.") \
  X(SINE, FREQUENCY, "frequency", NUMBER, FREQUENCY, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_signal, frequency), "Periods per second.") \
  X(SINE, PHASE, "phase", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", BY_HAND, "Phase angle at `start`.") \
  X(SINE, START, "start", NUMBER, TIME, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, start), "The signal is 0 before this time.") \
  X(SINE, STOP, "stop", NUMBER, TIME, ANY, "never", OPTIONAL, 0, "", FIELD(strut_signal, stop), "The signal is 0 from this time on.")

#define STRUT_HALF_SINE_FIELDS(X) \
  X(HALF_SINE, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, amplitude), "Largest value.") \
  X(HALF_SINE, FREQUENCY, "frequency", NUMBER, FREQUENCY, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_signal, frequency), "Frequency of the sine; the half-wave lasts 1 / (2 frequency).") \
  X(HALF_SINE, START, "start", NUMBER, TIME, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, start), "Time at which the half-wave begins.")

#define STRUT_SQUARE_FIELDS(X) \
  X(SQUARE, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, amplitude), "Largest value.") \
  X(SQUARE, FREQUENCY, "frequency", NUMBER, FREQUENCY, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_signal, frequency), "Periods per second.") \
  X(SQUARE, PHASE, "phase", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", BY_HAND, "Phase angle at `start`.") \
  X(SQUARE, START, "start", NUMBER, TIME, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, start), "The signal is 0 before this time.") \
  X(SQUARE, STOP, "stop", NUMBER, TIME, ANY, "never", OPTIONAL, 0, "", FIELD(strut_signal, stop), "The signal is 0 from this time on.")

#define STRUT_RAMP_FIELDS(X) \
  X(RAMP, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, amplitude), "Value from `stop` on.") \
  X(RAMP, START, "start", NUMBER, TIME, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, start), "Time at which the signal leaves 0.") \
  X(RAMP, STOP, "stop", NUMBER, TIME, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, stop), "Time at which it reaches the amplitude.")

#define STRUT_SENSOR_FIELDS(X) \
  X(SENSOR, LENGTH, "length", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_SENSOR_LENGTH, REFERENCE(strut_sensor, item, MEMBER)), "The member whose length it senses [m].") \
  X(SENSOR, FORCE, "force", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_SENSOR_FORCE, REFERENCE(strut_sensor, item, MEMBER)), "The member whose force it senses [N], tension positive: with damper and stops, without what an actuator's `force` adds.") \
  X(SENSOR, ANGLE, "angle", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_SENSOR_ANGLE, REFERENCE(strut_sensor, item, HINGE)), "The hinge whose angle it senses [rad].") \
  X(SENSOR, CONTACT, "contact", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_SENSOR_CONTACT, REFERENCE(strut_sensor, item, NODE)), "The node whose touch it senses: 1 while the node is in the ground, else 0.") \
  X(SENSOR, POSITION, "position", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_SENSOR_POSITION, REFERENCE(strut_sensor, item, NODE)), "The node whose position it senses [m], `along` x or y.") \
  X(SENSOR, VELOCITY, "velocity", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_SENSOR_VELOCITY, REFERENCE(strut_sensor, item, NODE)), "The node whose velocity it senses [m/s], `along` x or y.") \
  X(SENSOR, ENERGY, "energy", WORD, NONE, ANY, "", OPTIONAL, 7, "kinetic|elastic|total", CHOICE(strut_sensor, kind, STRUT_SENSOR_ENERGY, FIELD(strut_sensor, energy)), "The energy of the structure that it senses [J].") \
  X(SENSOR, AREA, "area", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_SENSOR_AREA, REFERENCE(strut_sensor, item, CELL)), "The cell whose area it senses [m^2].") \
  X(SENSOR, PRESSURE, "pressure", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_SENSOR_PRESSURE, REFERENCE(strut_sensor, item, CELL)), "The cell whose pressure it senses [N/m]; of a gas the absolute one.") \
  X(SENSOR, DISTANCE, "distance", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_SENSOR_DISTANCE, REFERENCE(strut_sensor, item, DISTANCE)), "The distance that it senses [m].") \
  X(SENSOR, CONTACT_FORCE, "contact_force", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_SENSOR_CONTACT_FORCE, REFERENCE(strut_sensor, item, NODE)), "The node whose force on the ground, normal to it, it senses [N]; on several grounds their sum.") \
  X(SENSOR, COLLISION_FORCE, "collision_force", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_sensor, kind, STRUT_SENSOR_COLLISION_FORCE, REFERENCE(strut_sensor, item, COLLISION)), "The collision whose force it senses [N].") \
  X(SENSOR, ALONG, "along", WORD, NONE, ANY, "", OPTIONAL, 0, "x|y", BY_HAND, "Direction of a position or a velocity.")

#define STRUT_STATE_FIELDS(X) \
  X(STATE, RATE, "rate", EXPRESSION, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "Its rate: an expression as that of a signal, which may also use states.") \
  X(STATE, START, "start", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "Its value at t = 0, with its unit.")

#define STRUT_RELAY_FIELDS(X) \
  X(RELAY, KIND, "kind", WORD, NONE, ANY, "", REQUIRED, 0, "relay", NONE, "Which controller it is.") \
  X(RELAY, OF, "of", EXPRESSION, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "Its input: a sensor, or an expression as that of a signal.") \
  X(RELAY, ON_ABOVE, "on_above", NUMBER, CONTEXT, ANY, "", OPTIONAL, 7, "", CHOICE(strut_relay, on_above, true, FIELD(strut_relay, upper)), "It goes on when the input rises above this, and stays so until it goes off.") \
  X(RELAY, OFF_BELOW, "off_below", NUMBER, CONTEXT, ANY, "", OPTIONAL, 8, "", CHOICE(strut_relay, on_above, true, FIELD(strut_relay, lower)), "With `on_above`: it goes off when the input falls below this.") \
  X(RELAY, ON_BELOW, "on_below", NUMBER, CONTEXT, ANY, "", OPTIONAL, 7, "", CHOICE(strut_relay, on_above, false, FIELD(strut_relay, lower)), "Instead, as a thermostat: it goes on when the input falls below this.") \
  X(RELAY, OFF_ABOVE, "off_above", NUMBER, CONTEXT, ANY, "", OPTIONAL, 8, "", CHOICE(strut_relay, on_above, false, FIELD(strut_relay, upper)), "With `on_below`: it goes off when the input rises above this.") \
  X(RELAY, ON_VALUE, "on_value", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_relay, on), "The signal while it is on.") \
  X(RELAY, OFF_VALUE, "off_value", NUMBER, CONTEXT, ANY, "0", OPTIONAL, 0, "", FIELD(strut_relay, off), "The signal while it is off.") \
  X(RELAY, ON_AT_START, "on_at_start", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_relay, on_at_start), "Whether it is on at t = 0 where the input is between the thresholds.") \
  X(RELAY, EVERY, "every", NUMBER, TIME, ABOVE_ZERO, "0", OPTIONAL, 0, "", BY_HAND, "Time between samples; 0: it switches when the input passes a threshold, which methods with events locate.")

#define STRUT_MAXWELL_FIELDS(X) \
  X(MAXWELL, STIFFNESS, "stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_maxwell, stiffness), "Stiffness k of the spring.") \
  X(MAXWELL, DAMPING, "damping", NUMBER, DAMPING, ABOVE_ZERO, "", OPTIONAL, 7, "", FIELD(strut_maxwell, damping), "Damping c of the dashpot.") \
  X(MAXWELL, TIME, "time", NUMBER, TIME, ABOVE_ZERO, "", OPTIONAL, 7, "", FIELD(strut_maxwell, time), "Instead of the damping: the time c/k in which the force relaxes.") \
  X(MAXWELL, FORCE, "force", NUMBER, FORCE, ANY, "0", OPTIONAL, 0, "", FIELD(strut_maxwell, force), "Force of the branch at t = 0; tension is positive.")

#define STRUT_RUBBING_FIELDS(X) \
  X(RUBBING, MU, "mu", NUMBER, NONE, NOT_NEGATIVE, "", REQUIRED, 0, "", FIELD(strut_friction, mu_kinetic), "Coefficient of friction, of fast sliding where there is a `decay_velocity`.") \
  X(RUBBING, WIDTH, "width", NUMBER, VELOCITY, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_friction, width), "Sliding speed at which friction reaches 0.71 of its full value.") \
  X(RUBBING, MU_STATIC, "mu_static", NUMBER, NONE, NOT_NEGATIVE, "", OPTIONAL, 0, "", FIELD(strut_friction, mu_static), "Coefficient of slow sliding, with a `decay_velocity`.") \
  X(RUBBING, DECAY_VELOCITY, "decay_velocity", NUMBER, VELOCITY, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_friction, decay_velocity), "Sliding speed at which the coefficient is half way from `mu_static` to `mu` (Stribeck's curve).")

#define STRUT_STARTS_FIELDS(X) \
  X(STARTS, CONTACT, "contact", NAME, NONE, ANY, "", OPTIONAL, 7, "", CHOICE(strut_trigger, kind, STRUT_TRIGGER_CONTACT, REFERENCE(strut_trigger, item, NODE)), "The node whose touchdown starts the signal.") \
  X(STARTS, SENSOR, "sensor", NAME, NONE, ANY, "", OPTIONAL, 7, "", REFERENCE(strut_trigger, item, SENSOR), "The sensor that starts it, at the end of the step in which it passes a level.") \
  X(STARTS, ABOVE, "above", NUMBER, CONTEXT, ANY, "", OPTIONAL, 8, "", CHOICE(strut_trigger, kind, STRUT_TRIGGER_ABOVE, FIELD(strut_trigger, level)), "Level above which the sensor rises.") \
  X(STARTS, BELOW, "below", NUMBER, CONTEXT, ANY, "", OPTIONAL, 8, "", CHOICE(strut_trigger, kind, STRUT_TRIGGER_BELOW, FIELD(strut_trigger, level)), "Level below which it falls.") \
  X(STARTS, EACH, "each", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_trigger, each), "Start again each time, not only the first.")

#define STRUT_CONFIGURATION_FIELDS(X) \
  X(CONFIGURATION, CONTACTS, "contacts", NODE_SETS, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "The nodes that touch the ground in this shape; several lists are alternatives.") \
  X(CONFIGURATION, SHAPE, "shape", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[x, y]`", BY_HAND, "Approximate positions; nodes that are not listed stay as drawn. Without `shape` the contacts alone identify the configuration.")

#define STRUT_INITIAL_FIELDS(X) \
  X(INITIAL, CONFIGURATION, "configuration", NAME, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "A configuration, or a text parameter that names one.") \
  X(INITIAL, EQUILIBRIUM, "equilibrium", NAME, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "A configuration, or a text parameter that names one, from whose equilibrium the run starts; replaces `configuration`, `positions` and `settle`.") \
  X(INITIAL, POSITIONS, "positions", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[x, y]`", BY_HAND, "Positions of single nodes; they take precedence over the configuration.") \
  X(INITIAL, VELOCITIES, "velocities", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[vx, vy]`", BY_HAND, "Velocities of single nodes.") \
  X(INITIAL, VELOCITY, "velocity", PAIR, VELOCITY, ANY, "[0, 0]", OPTIONAL, 0, "", BY_HAND, "Velocity of all other nodes in the directions in which they are free.") \
  X(INITIAL, SETTLE, "settle", SETTLE, NONE, ANY, "false", OPTIONAL, 0, "", BY_HAND, "Let the structure come to rest before t = 0, with actuators, driven loads, the belt and (as in the paper) friction switched off.")

#define STRUT_SETTLE_FIELDS(X) \
  X(SETTLE, SPEED, "speed", NUMBER, VELOCITY, ABOVE_ZERO, "1e-8", WRITTEN, 0, "", FIELD(strut_settle, speed), "The structure is at rest when the speed of every node is below this value") \
  X(SETTLE, ACCELERATION, "acceleration", NUMBER, ACCELERATION, ABOVE_ZERO, "1e-8", WRITTEN, 0, "", FIELD(strut_settle, acceleration), "and the acceleration of every node is below this value.") \
  X(SETTLE, LIMIT, "limit", NUMBER, TIME, ABOVE_ZERO, "100", WRITTEN, 0, "", FIELD(strut_settle, limit), "Longest simulated time.") \
  X(SETTLE, EVALUATIONS, "evaluations", NUMBER, NONE, ABOVE_ZERO, "4e7", OPTIONAL, 0, "", FIELD(strut_settle, evaluations), "Largest number of force evaluations.") \
  X(SETTLE, STEP, "step", NUMBER, TIME, NOT_NEGATIVE, "`solver.step`", OPTIONAL, 0, "", BY_HAND, "Time step of the Runge-Kutta method that settles, whatever the method of the run. Half the stability limit is used instead for `0`, for a step above that limit, and where the file gives no step.") \
  X(SETTLE, PERTURB, "perturb", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_settle, perturb), "Leave unstable equilibria: push slightly along the most unstable direction and settle again, until the equilibrium is stable.") \
  X(SETTLE, FRICTION, "friction", WORD, NONE, ANY, "none", OPTIONAL, 0, "none|kept", FIELD(strut_settle, friction), "`kept` leaves friction on, which a body on a slope needs; `none` switches it off, as in the paper.")

#define STRUT_EQUILIBRIA_FIELDS(X) \
  X(EQUILIBRIA, SUPPORTS, "supports", NODE_SETS, NONE, ANY, "every pair that can carry", OPTIONAL, 0, "", BY_HAND, "Contact nodes to support in turn: the first node of each list is pinned, the others roll on the ground.") \
  X(EQUILIBRIA, STARTS, "starts", NUMBER, NONE, WHOLE(0, STRUT_MOST_STARTS), "until few equilibria can be missing", OPTIONAL, 0, "", FIELD(strut_search, starts), "Random starts for each list of supports.") \
  X(EQUILIBRIA, SEED, "seed", NUMBER, NONE, WHOLE(0, STRUT_MOST_SEED), "1", WRITTEN, 0, "", FIELD(strut_search, seed), "Seed of the random starts; the same seed gives the same result.")

#define STRUT_SOLVER_FIELDS(X) \
  X(SOLVER, INTEGRATOR, "integrator", WORD, NONE, ANY, "rk4", WRITTEN, 0, STRUT_INTEGRATOR_WORDS, FIELD(strut_experiment, integrator), "Time integration method.") \
  X(SOLVER, STEP, "step", NUMBER, TIME, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_experiment, step), "Time step; with `adaptive`, the longest step. A run needs `step` or `accuracy`.") \
  X(SOLVER, TOLERANCE, "tolerance", NUMBER, NONE, ABOVE_ZERO, "1e-6", OPTIONAL, 0, "", FIELD(strut_experiment, tolerance), "Relative local error per step of `adaptive`.") \
  X(SOLVER, REFINE, "refine", NUMBER, NONE, ABOVE_ZERO, "from the scene", OPTIONAL, 0, "", FIELD(strut_experiment, refine), "Methods with events divide the step by this factor after a touchdown; 1 switches the refinement off.") \
  X(SOLVER, REFINE_TIME, "refine_time", NUMBER, TIME, ABOVE_ZERO, "from the scene", OPTIONAL, 0, "", FIELD(strut_experiment, refine_time), "Duration of the refinement after a touchdown.") \
  X(SOLVER, ACCURACY, "accuracy", NUMBER, NONE, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_experiment, accuracy), "Wanted relative accuracy of the measured quantities, such as 1 %; method and step are chosen to meet it.") \
  X(SOLVER, BUDGET, "budget", NUMBER, NONE, ABOVE_ZERO, STRUT_TEXT_OF(STRUT_USUAL_BUDGET), OPTIONAL, 0, "", FIELD(strut_experiment, budget), "Work allowed for `accuracy`, in units of one fine run with a fixed step; a result that would need more is reported as such.")

#define STRUT_RUN_FIELDS(X) \
  X(RUN, DURATION, "duration", NUMBER, TIME, ABOVE_ZERO, "", OPTIONAL, 3, "", FIELD(strut_experiment, duration), "Simulated time.") \
  X(RUN, PERIODS, "periods", NUMBER, NONE, ABOVE_ZERO, "", OPTIONAL, 3, "", FIELD(strut_experiment, periods), "Simulated time in periods of the signal that `of` names.") \
  X(RUN, OF, "of", NAME, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "The actuator, load or signal whose periods count.") \
  X(RUN, MEASURE, "measure", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(MEASURE), "What is measured; by default the velocity of the centre of mass over the whole run.")

#define STRUT_MEASURE_FIELDS(X) \
  X(MEASURE, LAST, "last", NUMBER, CONTEXT, ABOVE_ZERO, "the whole run", OPTIONAL, 0, "", FIELD(strut_experiment, measure_last), "Length of the measuring window at the end of the run: a number of periods if the run is given in periods, otherwise a time.") \
  X(MEASURE, STEADY, "steady", STEADY, NONE, ANY, "false", OPTIONAL, 0, "", BY_HAND, "Stop as soon as the motion repeats itself. The run must be given in periods, which are then an upper bound.") \
  X(MEASURE, NODE, "node", NAME, NONE, ANY, "the centre of mass", OPTIONAL, 0, "", REFERENCE(strut_experiment, measure_node, NODE), "The node whose velocity is measured.") \
  X(MEASURE, QUANTITIES, "quantities", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression, whose mean is measured, or the keys of a [quantity](#quantity)", THINGS(QUANTITY), "Further quantities to measure over the window.")

#define STRUT_QUANTITY_FIELDS(X) \
  X(QUANTITY, OF, "of", EXPRESSION, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "An expression of columns of the motion, listed in [the language](language.md#measured-quantities).") \
  X(QUANTITY, TAKE, "take", WORD, NONE, ANY, "mean", OPTIONAL, 0, "mean|min|max|range|rms|final|change|rate|rise|arrival", FIELD(strut_quantity_definition, take), "How the window reduces the expression to one number: `mean` over time, `min`, `max`, `range` (max - min), `rms`, `final` value, `change` from the first to the last value, `rate` (change / time), `rise` (sum of all increases), or `arrival`, the time at which `target` is first reached or passed.") \
  X(QUANTITY, ACCURACY, "accuracy", NUMBER, CONTEXT, ABOVE_ZERO, "that of the solver", OPTIONAL, 0, "", BY_HAND, "Wanted accuracy: relative if given without a unit, such as 1 %, absolute with a unit, such as 0.1 mm.") \
  X(QUANTITY, TARGET, "target", NUMBER, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "Value that `take: arrival` waits for, from below or above, in the unit of the expression.")

#define STRUT_STEADY_FIELDS(X) \
  X(STEADY, TOLERANCE, "tolerance", NUMBER, NONE, ABOVE_ZERO, "0.5 %", WRITTEN, 0, "", FIELD(strut_steady, tolerance), "Largest relative difference of the velocity between repetitions.") \
  X(STEADY, ABSOLUTE_TOLERANCE, "absolute_tolerance", NUMBER, VELOCITY, ABOVE_ZERO, "from the scene", OPTIONAL, 0, "", FIELD(strut_steady, floor), "Differences of the velocity below this value are neglected.") \
  X(STEADY, REPETITIONS, "repetitions", NUMBER, NONE, WHOLE(2, 16), "5", WRITTEN, 0, "", FIELD(strut_steady, successive), "Number of successive repetitions that must agree.") \
  X(STEADY, SHOOTING, "shooting", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_steady, shooting), "Solve for the periodic orbit by Newton's method (shooting) and report its Floquet multipliers; for structures with up to 48 degrees of freedom.")

#define STRUT_OUTPUT_FIELDS(X) \
  X(OUTPUT, EVERY, "every", NUMBER, TIME, ABOVE_ZERO, "a thousandth of the recorded time", OPTIONAL, 0, "", FIELD(strut_experiment, output_every), "Time between two samples.") \
  X(OUTPUT, LAST, "last", NUMBER, CONTEXT, ABOVE_ZERO, "the whole run", OPTIONAL, 0, "", FIELD(strut_experiment, output_last), "Record only the end of the run: a number of periods if the run is given in periods, otherwise a time.") \
  X(OUTPUT, CHANNELS, "channels", WORDS, NONE, ANY, "[position, length, force]", WRITTEN, 0, STRUT_CHANNEL_WORDS, FIELD(strut_experiment, channels), STRUT_CHANNEL_DESCRIPTION)

/* clang-format on */

#endif
