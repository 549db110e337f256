/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The table of the language, one row per key; keys.h lists what is generated from it.
 *
 * X(section, id, name, type, measure, range, default, need, set, words, field, description)
 *
 * range: ANY, NOT_NEGATIVE, ABOVE_ZERO, or WHOLE(least, most) for whole numbers. need: REQUIRED keys must
 * be given; `strut write` always writes REQUIRED and WRITTEN keys, OPTIONAL ones only where they differ
 * from the default. set: a mapping may give only one of the keys of a set (not 0). Words are separated
 * by '|'. field: FIELD(type, member) is where the value is kept in the section's object; a number, pair,
 * word or text with a field needs no code in the reader and the writer. BY_HAND: it has code of its own.
 */
#ifndef STRUT_PARSER_LANGUAGE_KEYS_TABLE_H
#define STRUT_PARSER_LANGUAGE_KEYS_TABLE_H

/* clang-format off */
#define STRUT_KEY_TABLE(X) \
  X(SCENE, VERSION, "strut", VERSION, NONE, ANY, "", REQUIRED, 0, "1", BY_HAND, "Version of the language.") \
  X(SCENE, NAME, "name", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_scene, name), "Name of the scene, used in figures and tables.") \
  X(SCENE, DESCRIPTION, "description", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_scene, description), "What the scene shows.") \
  X(SCENE, SOURCE, "source", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_scene, source), "Where its numbers come from.") \
  X(SCENE, PARAMETERS, "parameters", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression or a quoted text", BY_HAND, "Named values that expressions may use and `--set` may change.") \
  X(SCENE, GROUPS, "groups", THINGS, NONE, ANY, "", OPTIONAL, 0, "keys of a member, a node, a contact or a hinge", BY_HAND, "Keys that several members, nodes, contacts or hinges share. A thing's own keys take precedence.") \
  X(SCENE, NODES, "nodes", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[x, y]` or the keys of a node", BY_HAND, "The points of the structure. Required unless parts are placed; the name of a placed thing changes or adds its keys, and `*` in it stands for any part of a name between dots.") \
  X(SCENE, MEMBERS, "members", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a member", BY_HAND, "The bars, springs and cables between the nodes.") \
  X(SCENE, HINGES, "hinges", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a hinge", BY_HAND, "Springs of the angle between two arms that meet in a node.") \
  X(SCENE, CELLS, "cells", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a cell", BY_HAND, "Polygons of nodes under pressure.") \
  X(SCENE, COLLISIONS, "collisions", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a collision", BY_HAND, "Pairs of nodes and members that do not pass through each other.") \
  X(SCENE, BEAMS, "beams", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a beam", BY_HAND, "Chains of bars and hinges that bend.") \
  X(SCENE, RAYLEIGH, "rayleigh", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Damping of the whole structure by mass and by stiffness.") \
  X(SCENE, MASS_MODEL, "mass_model", WORD, NONE, ANY, "consistent", WRITTEN, 0, "consistent|lumped", FIELD(strut_scene, mass_model), "How a member's mass acts: `consistent` as that of a uniform rod (the paper's model), `lumped` as half of it at each end.") \
  X(SCENE, BARS, "bars", WORD, NONE, ANY, "elastic", OPTIONAL, 0, "elastic|rigid", FIELD(strut_scene, bar_model), "`rigid` bars keep, during a run, the length they have at its start; their stiffness and damping then count only while the structure settles.") \
  X(SCENE, GRAVITY, "gravity", PAIR, ACCELERATION, ANY, "[0, 0]", WRITTEN, 0, "", FIELD(strut_scene, gravity), "Gravitational acceleration.") \
  X(SCENE, GROUND, "ground", MAP, NONE, ANY, "", OPTIONAL, 1, "", BY_HAND, "The line that nodes may touch; without it there is no ground.") \
  X(SCENE, ACTUATORS, "actuators", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an actuator", BY_HAND, "Members whose rest length a signal changes, or to which it adds a force. Several actuators on one member add up.") \
  X(SCENE, LOADS, "loads", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a load", BY_HAND, "Forces on nodes.") \
  X(SCENE, UNBALANCES, "unbalances", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an unbalance", BY_HAND, "Masses that rotate about nodes.") \
  X(SCENE, SIGNALS, "signals", THINGS, NONE, ANY, "", OPTIONAL, 0, "a signal", BY_HAND, "Named signals, for use in several places.") \
  X(SCENE, CONFIGURATIONS, "configurations", THINGS, NONE, ANY, "", OPTIONAL, 0, "`{NODE: [x, y], ...}` or the keys of a [configuration](#configuration)", BY_HAND, "Named shapes: to start from, and to name equilibria. Nodes that are not listed stay as drawn.") \
  X(SCENE, INITIAL, "initial", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "The state at t = 0; by default the drawn shape at rest.") \
  X(SCENE, EQUILIBRIA, "equilibria", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Settings of the search for equilibria.") \
  X(SCENE, SOLVER, "solver", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Method, time step and accuracy. Required for a run.") \
  X(SCENE, RUN, "run", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Duration and measurement. Required for a run.") \
  X(SCENE, OUTPUT, "output", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "What is recorded.") \
  X(SCENE, GROUNDS, "grounds", THINGS, NONE, ANY, "", OPTIONAL, 1, "the keys of [ground](#ground)", BY_HAND, "Several grounds, instead of `ground`: walls, profiles, circles. Nodes touch all of them.") \
  X(SCENE, SLIDERS, "sliders", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a slider", BY_HAND, "Masses on members, along which they may slide.") \
  X(SCENE, SENSORS, "sensors", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a sensor", BY_HAND, "Numbers of the motion that the expressions of signals may use.") \
  X(SCENE, STATES, "states", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a state", BY_HAND, "Numbers that a run integrates beside the motion.") \
  X(SCENE, OSCILLATORS, "oscillators", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an oscillator", BY_HAND, "Phase oscillators, each an internal state with the same name.") \
  X(SCENE, CONTROLLERS, "controllers", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a controller", BY_HAND, "PID controllers and relays, each a signal with the same name.") \
  X(SCENE, PARTS, "parts", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a part", BY_HAND, "Structures to be placed, once or many times.") \
  X(SCENE, PLACE, "place", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a [place](#place)", BY_HAND, "Copies of parts. What is in a copy is called `NAME.THING`, or `NAME.0.THING` and so on where it is repeated.") \
  X(SCENE, MERGE, "merge", FREE, NONE, ANY, "", OPTIONAL, 0, "touching, or {node: other node, ...}", BY_HAND, "Nodes that become one: those named, or with `touching` all that lie in one place.") \
  X(SCENE, LIMIT_THINGS, "limit_things", NUMBER, NONE, WHOLE(1, STRUT_MOST_THINGS), "500000", OPTIONAL, 0, "", BY_HAND, "How many nodes, members and other things all copies of parts may have together, and how many contacts a profile; more need memory and time.") \
  X(SCENE, BASE, "base", TEXT, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Another scene's file, relative to this one: the scene is that one with the keys here laid over it, and `NAME: remove` takes things away.") \
  X(PART, USE, "use", TEXT, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "A file whose structure is the part, relative to this one; its own keys lie over it.") \
  X(PART, PARAMETERS, "parameters", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression", BY_HAND, "Values that `set` of a placement may change.") \
  X(PART, GROUPS, "groups", THINGS, NONE, ANY, "", OPTIONAL, 0, "keys of a member, a node or a contact", BY_HAND, "As in a scene; those of the scene are known too.") \
  X(PART, NODES, "nodes", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[x, y]` or the keys of a node", BY_HAND, "As in a scene, in the part's own coordinates.") \
  X(PART, MEMBERS, "members", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a member", BY_HAND, "As in a scene.") \
  X(PART, HINGES, "hinges", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a hinge", BY_HAND, "As in a scene.") \
  X(PART, CELLS, "cells", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a cell", BY_HAND, "As in a scene.") \
  X(PART, COLLISIONS, "collisions", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a collision", BY_HAND, "As in a scene.") \
  X(PART, BEAMS, "beams", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a beam", BY_HAND, "As in a scene.") \
  X(PART, ACTUATORS, "actuators", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an actuator", BY_HAND, "As in a scene.") \
  X(PART, LOADS, "loads", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a load", BY_HAND, "As in a scene; forces turn with the part.") \
  X(PART, UNBALANCES, "unbalances", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an unbalance", BY_HAND, "As in a scene.") \
  X(PART, SLIDERS, "sliders", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a slider", BY_HAND, "As in a scene.") \
  X(PART, SIGNALS, "signals", THINGS, NONE, ANY, "", OPTIONAL, 0, "a signal", BY_HAND, "As in a scene; those of the scene are known too.") \
  X(PART, CONFIGURATIONS, "configurations", THINGS, NONE, ANY, "", OPTIONAL, 0, "`{NODE: [x, y], ...}` or the keys of a [configuration](#configuration)", BY_HAND, "Shapes of the part; what is not in the copy stays as drawn.") \
  X(PART, SENSORS, "sensors", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a sensor", BY_HAND, "As in a scene.") \
  X(PART, STATES, "states", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a state", BY_HAND, "As in a scene.") \
  X(PART, OSCILLATORS, "oscillators", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an oscillator", BY_HAND, "As in a scene.") \
  X(PART, CONTROLLERS, "controllers", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a controller", BY_HAND, "As in a scene.") \
  X(PART, CONTACTS, "contacts", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a contact", BY_HAND, "Nodes that may touch the ground, by name, and settings of their contacts; `{}` for none.") \
  X(PART, PARTS, "parts", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a part", BY_HAND, "Parts that only this one knows.") \
  X(PART, PLACE, "place", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a [place](#place)", BY_HAND, "Copies of other parts within this one.") \
  X(PART, MERGE, "merge", FREE, NONE, ANY, "", OPTIONAL, 0, "touching, or {node: other node, ...}", BY_HAND, "As in a scene, among the nodes of the part.") \
  X(PART, PORTS, "ports", THINGS, NONE, ANY, "all nodes", OPTIONAL, 0, "the name of a node", BY_HAND, "Names by which nodes are seen from outside; then no other nodes are.") \
  X(PART, ISOLATED, "isolated", WORD, NONE, ANY, "no, `yes` with `use`", OPTIONAL, 0, "no|yes", BY_HAND, "Whether the part sees only its own parameters, groups, signals and parts, and none of those around it.") \
  X(PLACE, PART, "part", NAME, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "The part to copy.") \
  X(PLACE, FLIP, "flip", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|x|y|both", BY_HAND, "Changes the sign of coordinates. The order is always: flip, scale, turn, move.") \
  X(PLACE, SCALE, "scale", FREE, NONE, ANY, "1", OPTIONAL, 0, "a number above zero, or fit", BY_HAND, "Multiplies all lengths of the copy; masses, forces and stiffnesses stay. `fit`: what `onto` needs.") \
  X(PLACE, TURN, "turn", NUMBER, ANGLE, ANY, "0", OPTIONAL, 1, "", BY_HAND, "Turns the copy about its origin, counter-clockwise.") \
  X(PLACE, AT, "at", PAIR, LENGTH, ANY, "[0, 0]", OPTIONAL, 2, "", BY_HAND, "Where its origin comes to lie.") \
  X(PLACE, ONTO, "onto", THINGS, NONE, ANY, "", OPTIONAL, 2, "the name of a node outside", BY_HAND, "Instead of `at`: nodes of the copy and those on which they come to lie, which are merged. Two pairs turn it too.") \
  X(PLACE, SET, "set", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression", BY_HAND, "Parameters of the part; `i` and `j` are the numbers of the copy.") \
  X(PLACE, REPEAT, "repeat", FREE, NONE, ANY, "once", OPTIONAL, 0, "a number of copies, or the keys of repeat", BY_HAND, "Several copies.") \
  X(REPEAT, COUNT, "count", FREE, NONE, ANY, "", REQUIRED, 0, "a whole number, or [n, m] for a lattice", BY_HAND, "How many; numbered from 0.") \
  X(REPEAT, STEP, "step", FREE, NONE, ANY, "[0, 0]", OPTIONAL, 0, "a displacement such as [1 m, 0], or two of a lattice", BY_HAND, "From each copy to the next, in the copy's own frame.") \
  X(REPEAT, TURN, "turn", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", BY_HAND, "Turns each copy against the one before.") \
  X(REPEAT, SCALE, "scale", NUMBER, NONE, ABOVE_ZERO, "1", OPTIONAL, 0, "", BY_HAND, "Size of each copy over that of the one before.") \
  X(REPEAT, ABOUT, "about", PAIR, LENGTH, ANY, "[0, 0]", OPTIONAL, 0, "", BY_HAND, "The point about which it is turned and scaled.") \
  X(REPEAT, NEXT, "next", FREE, NONE, ANY, "", OPTIONAL, 0, "the keys of next, or two such mappings for a lattice", BY_HAND, "What ties a copy to the next one.") \
  X(REPEAT, CLOSED, "closed", FREE, NONE, ANY, "no", OPTIONAL, 0, "yes, no, or {node: node of the first copy, ...}", BY_HAND, "The first copy is the next of the last one; a mapping says under which other names, as in a ring with a twist.") \
  X(NEXT, MERGE, "merge", THINGS, NONE, ANY, "", OPTIONAL, 0, "the name of a node of the next copy", BY_HAND, "Nodes of a copy that are nodes of the next one: `{b: a}`.") \
  X(NEXT, MEMBERS, "members", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a member", BY_HAND, "Members between them; `next.NAME` is a node of the next copy.") \
  X(NEXT, HINGES, "hinges", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a hinge", BY_HAND, "Likewise.") \
  X(NEXT, CELLS, "cells", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a cell", BY_HAND, "Likewise.") \
  X(NEXT, COLLISIONS, "collisions", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a collision", BY_HAND, "Likewise.") \
  X(NEXT, BEAMS, "beams", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a beam", BY_HAND, "Likewise.") \
  X(NEXT, ACTUATORS, "actuators", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an actuator", BY_HAND, "Likewise.") \
  X(NEXT, SLIDERS, "sliders", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a slider", BY_HAND, "Likewise.") \
  X(NEXT, SENSORS, "sensors", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a sensor", BY_HAND, "Likewise.") \
  X(NODE, POSITION, "position", PAIR, LENGTH, ANY, "", REQUIRED, 0, "", FIELD(strut_node, position), "Position in the drawn shape.") \
  X(NODE, GROUP, "group", GROUPS, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Groups that provide defaults; later groups take precedence.") \
  X(NODE, MASS, "mass", NUMBER, MASS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_node, mass), "Point mass, in addition to the masses of the members.") \
  X(NODE, FIXED, "fixed", FIXED, NONE, ANY, "none", OPTIONAL, 0, "none|x|y|both", FIELD(strut_node, fixed), "Supported directions; also as a list, `[x, y]`.") \
  X(NODE, MOVES, "moves", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Directions in which a signal moves the node, which is then supported there.") \
  X(MOVES, ALONG_X, "x", SIGNAL, LENGTH, ANY, "", OPTIONAL, 0, "", BY_HAND, "Added to the x of the node's position.") \
  X(MOVES, ALONG_Y, "y", SIGNAL, LENGTH, ANY, "", OPTIONAL, 0, "", BY_HAND, "Added to the y of the node's position.") \
  X(MEMBER, GROUP, "group", GROUPS, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Groups that provide defaults; later groups take precedence.") \
  X(MEMBER, NODES, "nodes", NODE_PATH, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "The two nodes that the member joins. A cable may run over further nodes, its guides, without friction unless `guide_friction` is given: `[a, p, q, b]`; it then has one tension along its whole length, and its mass is lumped.") \
  X(MEMBER, KIND, "kind", WORD, NONE, ANY, "", REQUIRED, 0, "bar|spring|cable", FIELD(strut_member, kind), "Bars and springs carry tension and compression; a cable carries tension only and no force while slack. `strut` is another word for `bar`, `string` for `cable`.") \
  X(MEMBER, STIFFNESS, "stiffness", NUMBER, STIFFNESS, NOT_NEGATIVE, "0", OPTIONAL, 1, "", FIELD(strut_member, stiffness), "Force per elongation.") \
  X(MEMBER, AXIAL_STIFFNESS, "axial_stiffness", NUMBER, FORCE, NOT_NEGATIVE, "", OPTIONAL, 1, "", FIELD(strut_member, axial_stiffness), "EA; the stiffness is EA / rest length, also while an actuator changes that.") \
  X(MEMBER, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 8, "", FIELD(strut_member, damping), "Force per rate of elongation.") \
  X(MEMBER, DAMPING_RATIO, "damping_ratio", NUMBER, NONE, NOT_NEGATIVE, "0", OPTIONAL, 8, "", FIELD(strut_member, damping_ratio), "Instead of `damping`, zeta: the damping is 2 zeta sqrt(c m), with the stiffness c at the rest length and m the reduced mass of the member's two ends, 1/m = 1/m1 + 1/m2, along the member as drawn. m1 and m2 are lumped masses, half of each member's at each end; a supported direction is infinitely heavy.") \
  X(MEMBER, MASS, "mass", NUMBER, MASS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_member, mass), "Mass of the whole member.") \
  X(MEMBER, REST_LENGTH, "rest_length", NUMBER, LENGTH, NOT_NEGATIVE, "", OPTIONAL, 2, "", BY_HAND, "Length at which the member carries no force.") \
  X(MEMBER, REST_LENGTH_RATIO, "rest_length_ratio", NUMBER, NONE, NOT_NEGATIVE, "1", OPTIONAL, 2, "", BY_HAND, "Rest length / drawn length.") \
  X(MEMBER, PRETENSION, "pretension", NUMBER, FORCE, ANY, "", OPTIONAL, 2, "", BY_HAND, "Force in the drawn shape; tension is positive.") \
  X(MEMBER, FORCE_DENSITY, "force_density", NUMBER, STIFFNESS, ANY, "", OPTIONAL, 2, "", BY_HAND, "Force in the drawn shape / drawn length.") \
  X(MEMBER, LAW, "law", LAW, NONE, ANY, "linear", OPTIONAL, 0, "", BY_HAND, "Law of the force over the elongation, length - rest length. A cable carries tension only under every law.") \
  X(MEMBER, SHORTEST, "shortest", NUMBER, LENGTH, NOT_NEGATIVE, "none", OPTIONAL, 0, "", FIELD(strut_member, shortest), "Length below which a stop pushes the ends apart.") \
  X(MEMBER, LONGEST, "longest", NUMBER, LENGTH, ABOVE_ZERO, "none", OPTIONAL, 0, "", FIELD(strut_member, longest), "Length beyond which a stop pulls the ends together.") \
  X(MEMBER, STOP_STIFFNESS, "stop_stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "a hundred times the stiffness", OPTIONAL, 0, "", FIELD(strut_member, stop_stiffness), "Stiffness of the stops.") \
  X(MEMBER, STOP_DAMPING, "stop_damping", NUMBER, DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_member, stop_damping), "Damping of a stop while it acts; a stop never holds its member back.") \
  X(MEMBER, MAXWELL, "maxwell", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "A spring and a dashpot in a row, beside the member.") \
  X(MEMBER, BREAKS_AT, "breaks_at", NUMBER, FORCE, ABOVE_ZERO, "never", OPTIONAL, 0, "", FIELD(strut_member, breaks_at), "Tension at which the member breaks: from then on it carries nothing for the rest of the run. What it stored is lost. Statics and settling take it as whole.") \
  X(MEMBER, RELEASED_AT, "released_at", NUMBER, TIME, ABOVE_ZERO, "never", OPTIONAL, 0, "", FIELD(strut_member, released_at), "Time from which on the member carries nothing, as a latch that is released.") \
  X(MEMBER, GUIDE_FRICTION, "guide_friction", NUMBER, NONE, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_member, guide_friction), "Friction coefficient mu of a running cable at its guides: over a guide at which it turns by theta, the tensions differ by the factor exp(mu theta) at most. Statics and settling take the guides without friction.") \
  X(HINGE, NODES, "nodes", NODE_TRIPLE, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "Three nodes `[a, b, c]`: the hinge is at b, and its angle is that from the arm b-a to the arm b-c, counter-clockwise.") \
  X(HINGE, STIFFNESS, "stiffness", NUMBER, ANGULAR_STIFFNESS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_hinge, stiffness), "Moment per angle.") \
  X(HINGE, DAMPING, "damping", NUMBER, ANGULAR_DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_hinge, damping), "Moment per angular velocity.") \
  X(HINGE, REST_ANGLE, "rest_angle", NUMBER, ANGLE, ANY, "as drawn", OPTIONAL, 0, "", FIELD(strut_hinge, rest_angle), "Angle at which the hinge has no moment. The angle is continuous over whole turns; at the start it is within half a turn of this one.") \
  X(HINGE, LAW, "law", LAW, NONE, ANY, "linear", OPTIONAL, 0, "", BY_HAND, "Law of the moment over angle - rest angle.") \
  X(HINGE, BREAKS_AT, "breaks_at", NUMBER, MOMENT, ABOVE_ZERO, "never", OPTIONAL, 0, "", FIELD(strut_hinge, breaks_at), "Size of the moment at which the hinge breaks: from then on it has none.") \
  X(HINGE, RELEASED_AT, "released_at", NUMBER, TIME, ABOVE_ZERO, "never", OPTIONAL, 0, "", FIELD(strut_hinge, released_at), "Time from which on the hinge has no moment.") \
  X(HINGE, GROUP, "group", GROUPS, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Groups that provide defaults; later groups take precedence.") \
  X(CELL, NODES, "nodes", NODE_RING, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "The corners `[a, b, c, ...]` in order, in either sense. They need no members between them.") \
  X(CELL, PRESSURE, "pressure", NUMBER, STIFFNESS, ANY, "", OPTIONAL, 7, "", FIELD(strut_cell, pressure), "Given pressure, force per length of the boundary, outwards; negative: suction. An actuator may change it.") \
  X(CELL, GAS, "gas", MAP, NONE, ANY, "", OPTIONAL, 7, "", BY_HAND, "A closed gas, whose pressure follows from the area.") \
  X(GAS, KIND, "kind", WORD, NONE, ANY, "", REQUIRED, 0, "isothermal|isentropic", BY_HAND, "With the area A, A0 as drawn: `isothermal`, p = pressure * A0 / A. `isentropic`, p = pressure * (A0 / A)^exponent.") \
  X(GAS, PRESSURE, "pressure", NUMBER, STIFFNESS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_cell, pressure), "Absolute pressure as drawn.") \
  X(GAS, EXPONENT, "exponent", NUMBER, NONE, ABOVE_ZERO, "1.4", OPTIONAL, 0, "", FIELD(strut_cell, exponent), "Isentropic exponent, above 1.") \
  X(GAS, OUTSIDE, "outside", NUMBER, STIFFNESS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_cell, outside), "Absolute pressure outside, which pushes inwards.") \
  X(COLLISION, NODE, "node", NAME, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "A node that may touch the `member`.") \
  X(COLLISION, MEMBER, "member", NAME, NONE, ANY, "", OPTIONAL, 8, "", BY_HAND, "The member that the `node` may touch; a straight line between its ends, which are round.") \
  X(COLLISION, NODES, "nodes", NAME_PAIR, NONE, ANY, "", OPTIONAL, 8, "", BY_HAND, "Two nodes that may touch each other as discs.") \
  X(COLLISION, MEMBERS, "members", NAME_PAIR, NONE, ANY, "", OPTIONAL, 8, "", BY_HAND, "Two members that may touch each other: each end of one with the other.") \
  X(COLLISION, THICKNESS, "thickness", NUMBER, LENGTH, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_collision, thickness), "Distance of the two axes or centres at which they touch.") \
  X(COLLISION, STIFFNESS, "stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_collision, stiffness), "Force per depth.") \
  X(COLLISION, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_collision, damping), "Force per speed of approach while they touch; a collision never pulls.") \
  X(BEAM, NODES, "nodes", NAME_PAIR, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "The nodes at its ends; it is straight at rest.") \
  X(BEAM, BENDING_STIFFNESS, "bending_stiffness", NUMBER, BENDING_STIFFNESS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_beam, bending_stiffness), "EI; a hinge between two parts of the length h has the stiffness EI / h, one at a clamp 2 EI / h.") \
  X(BEAM, AXIAL_STIFFNESS, "axial_stiffness", NUMBER, FORCE, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_beam, axial_stiffness), "EA of its parts.") \
  X(BEAM, PARTS, "parts", NUMBER, NONE, WHOLE(1, 10000), "10", OPTIONAL, 0, "", FIELD(strut_beam, parts), "Number of bars.") \
  X(BEAM, MASS, "mass", NUMBER, MASS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_beam, mass), "Mass of the whole beam.") \
  X(BEAM, DAMPING, "damping", NUMBER, TIME, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_beam, damping), "Damping / stiffness of the material, of bars and hinges alike (Kelvin-Voigt).") \
  X(BEAM, CLAMPED, "clamped", WORD, NONE, ANY, "none", OPTIONAL, 0, "none|start|end|both", FIELD(strut_beam, clamped), "Ends whose direction is held, at a fixed node.") \
  X(BEAM, CLAMPED_TO, "clamped_to", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Members and other beams whose direction its ends follow.") \
  X(CLAMPED_TO, START, "start", NAME, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "A bar, a spring or a beam that ends at the first node.") \
  X(CLAMPED_TO, END, "end", NAME, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "The same at the second node.") \
  X(LAW, KIND, "kind", WORD, NONE, ANY, "linear", WRITTEN, 0, STRUT_LAW_WORDS, FIELD(strut_law, kind), "With the stiffness k and x the elongation: `linear`, k x. `bilinear`, k x up to the knee on either side, then with the slope `second_stiffness`. `play`, no force within the gap on either side, beyond it k times the excess. `elastic_plastic`, k x until the force reaches the yield, then with the slope `second_stiffness`, and back along k: what has yielded stays. `polynomial`, c1 x + c2 x^2 + ... `logarithmic`, k L ln(length / L) with the rest length L. `exponential`, k s (exp(x / s) - 1) with the scale s. `table`, through points.") \
  X(LAW, CARRIES, "carries", WORD, NONE, ANY, "both", OPTIONAL, 0, "both|tension|compression", FIELD(strut_law, carries), "Forces that are carried: with `tension` the element acts beyond its rest length only, with `compression` below it.") \
  X(LAW, KNEE, "knee", NUMBER, CONTEXT, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_law, knee), "Elongation at which a bilinear law changes its slope.") \
  X(LAW, SECOND_STIFFNESS, "second_stiffness", NUMBER, CONTEXT, ANY, "", OPTIONAL, 0, "", FIELD(strut_law, second_stiffness), "Slope of a bilinear law beyond its knee, and of an elastic-plastic law beyond its yield, where 0 is the default.") \
  X(LAW, GAP, "gap", NUMBER, CONTEXT, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_law, gap), "Free play to either side of the rest length.") \
  X(LAW, SCALE, "scale", NUMBER, CONTEXT, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_law, scale), "Elongation over which the slope of an exponential law grows by the factor e.") \
  X(LAW, YIELD, "yield", NUMBER, CONTEXT, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_law, yield), "Force, or moment of a hinge, at which an elastic-plastic law gives way.") \
  X(LAW, COEFFICIENTS, "coefficients", NUMBERS, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "Coefficients of x, x^2, ... of a polynomial, such as `[10 N/m, 0, 1e5 N/m^3]`.") \
  X(LAW, POINTS, "points", POINTS, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "Points `[[x, force], ...]` of a table, such as `[[-1 mm, -5 N], [0, 0], [2 mm, 3 N]]`, with increasing x; beyond the ends it continues straight.") \
  X(LAW, SMOOTH, "smooth", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_law, smooth), "A table by a monotone spline through its points (Steffen) instead of straight lines.") \
  X(RAYLEIGH, MASS, "mass", NUMBER, FREQUENCY, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_scene, rayleigh_mass), "alpha: the force -alpha M v on the nodes, with the mass matrix M of the run.") \
  X(RAYLEIGH, STIFFNESS, "stiffness", NUMBER, TIME, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_scene, rayleigh_stiffness), "beta: adds beta times the stiffness at the rest length to the damping of every member and hinge.") \
  X(GROUND, HEIGHT, "height", NUMBER, LENGTH, ANY, "0", OPTIONAL, 1, "", FIELD(strut_ground_section, ground.height), "Height of the line at x = 0.") \
  X(GROUND, SLOPE, "slope", NUMBER, ANGLE, ANY, "0", OPTIONAL, 2, "", FIELD(strut_ground_section, ground.slope), "Angle of the line, between -90 deg and 90 deg; positive where it rises towards +x. With `through` any angle: the solid is to the right of the direction in which the angle points, so that 90 deg is a wall whose free side is at -x.") \
  X(GROUND, BELT_SPEED, "belt_speed", NUMBER, VELOCITY, ANY, "0", OPTIONAL, 0, "", FIELD(strut_ground_section, ground.belt_speed), "Speed of the surface along itself, positive towards +x.") \
  X(GROUND, STIFFNESS, "stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_ground_section, contact.stiffness), "Normal force per penetration depth.") \
  X(GROUND, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_ground_section, contact.damping), "Normal force per speed of a node that moves into the ground.") \
  X(GROUND, DAMPING_LAW, "damping_law", WORD, NONE, ANY, "approach_only", OPTIONAL, 0, "approach_only|hunt_crossley", FIELD(strut_ground_section, ground.damping_law), "Damping at contacts. `approach_only`: stiffness * depth + damping * speed inwards, without damping while the node moves out (the paper's law, with a jump at touchdown). `hunt_crossley`: stiffness * depth * (1 + dissipation * speed inwards), never tensile, without a jump.") \
  X(GROUND, DISSIPATION, "dissipation", NUMBER, DISSIPATION, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_ground_section, contact.dissipation), "Dissipation of the Hunt-Crossley law, which uses it instead of `damping`.") \
  X(GROUND, FRICTION, "friction", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Friction of every contact; without it the ground is frictionless.") \
  X(GROUND, NODES, "nodes", CONTACT_NODES, NONE, ANY, "all", OPTIONAL, 0, "", BY_HAND, "The nodes that may touch the ground; `all` are those that nothing moves.") \
  X(GROUND, CONTACTS, "contacts", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a contact", BY_HAND, "Settings of single contacts, by the name of the node.") \
  X(GROUND, THROUGH, "through", PAIR, LENGTH, ANY, "", OPTIONAL, 1, "", BY_HAND, "A point of the line, instead of `height`.") \
  X(GROUND, NORMAL, "normal", PAIR, NONE, ANY, "", OPTIONAL, 2, "", BY_HAND, "A vector out of the solid, of any length, instead of `slope`.") \
  X(GROUND, PROFILE, "profile", PROFILE, NONE, ANY, "", OPTIONAL, 3, "", BY_HAND, "Points of a polyline, instead of a line: the solid is to the right of its direction, and its ends continue straight. In a concave corner a node touches both sides.") \
  X(GROUND, CIRCLE, "circle", MAP, NONE, ANY, "", OPTIONAL, 3, "", BY_HAND, "A circle, instead of a line.") \
  X(GROUND, MOTION, "motion", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Shakes the ground: displacements by signals.") \
  X(CIRCLE, CENTRE, "centre", PAIR, LENGTH, ANY, "", REQUIRED, 0, "", FIELD(strut_ground, centre), "Its centre.") \
  X(CIRCLE, RADIUS, "radius", NUMBER, LENGTH, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_ground, radius), "Its radius.") \
  X(CIRCLE, INSIDE, "inside", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_ground, inside), "Nodes are inside of it, as in a pipe or a hoop; otherwise it is solid.") \
  X(MOTION, IN_X, "x", SIGNAL, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Displacement in x.") \
  X(MOTION, IN_Y, "y", SIGNAL, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Displacement in y.") \
  X(FRICTION, LAW, "law", WORD, NONE, ANY, "karnopp", WRITTEN, 0, STRUT_FRICTION_WORDS, FIELD(strut_friction, law), "`karnopp`: Coulomb friction with a stick band (the paper's law). `coulomb`: exact sticking; needs a method with events. `smooth`: the regularised law -mu_kinetic N u / sqrt(u^2 + width^2), under which contacts creep.") \
  X(FRICTION, MU, "mu", NUMBER, NONE, NOT_NEGATIVE, "", OPTIONAL, 0, "", BY_HAND, "Both friction coefficients.") \
  X(FRICTION, MU_STATIC, "mu_static", NUMBER, NONE, NOT_NEGATIVE, "", WRITTEN, 0, "", FIELD(strut_friction, mu_static), "Coefficient of static friction.") \
  X(FRICTION, MU_KINETIC, "mu_kinetic", NUMBER, NONE, NOT_NEGATIVE, "", WRITTEN, 0, "", FIELD(strut_friction, mu_kinetic), "Coefficient of kinetic friction.") \
  X(FRICTION, MU_FORWARD, "mu_forward", NUMBER, NONE, NOT_NEGATIVE, "", OPTIONAL, 0, "", BY_HAND, "Both coefficients against motion towards +x along the ground, where those against motion towards -x differ.") \
  X(FRICTION, MU_FORWARD_STATIC, "mu_forward_static", NUMBER, NONE, NOT_NEGATIVE, "`mu_forward`", OPTIONAL, 0, "", BY_HAND, "Coefficient of static friction against motion towards +x.") \
  X(FRICTION, MU_BACKWARD, "mu_backward", NUMBER, NONE, NOT_NEGATIVE, "as forward", OPTIONAL, 0, "", BY_HAND, "Both coefficients against motion towards -x along the ground.") \
  X(FRICTION, MU_BACKWARD_STATIC, "mu_backward_static", NUMBER, NONE, NOT_NEGATIVE, "`mu_backward`", OPTIONAL, 0, "", BY_HAND, "Coefficient of static friction against motion towards -x.") \
  X(FRICTION, STICK_VELOCITY, "stick_velocity", NUMBER, VELOCITY, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_friction, stick_velocity), "Half the width of the stick band; Karnopp's law needs it.") \
  X(FRICTION, WIDTH, "width", NUMBER, VELOCITY, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_friction, width), "Sliding speed at which the smooth law reaches 0.71 of the full friction; that law needs it.") \
  X(CONTACT, GROUP, "group", GROUPS, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Groups that provide defaults; later groups take precedence.") \
  X(CONTACT, STIFFNESS, "stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "the ground's", OPTIONAL, 0, "", FIELD(strut_contact, stiffness), "Replaces the value of the ground.") \
  X(CONTACT, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "the ground's", OPTIONAL, 0, "", FIELD(strut_contact, damping), "Replaces the value of the ground.") \
  X(CONTACT, DISSIPATION, "dissipation", NUMBER, DISSIPATION, NOT_NEGATIVE, "the ground's", OPTIONAL, 0, "", FIELD(strut_contact, dissipation), "Replaces the value of the ground.") \
  X(CONTACT, FRICTION, "friction", MAP, NONE, ANY, "the ground's", OPTIONAL, 0, "", BY_HAND, "Replaces single keys of the ground's friction.") \
  X(ACTUATOR, MEMBER, "member", NAME, NONE, ANY, "", OPTIONAL, 6, "", BY_HAND, "The member whose rest length it changes, or to which it adds a force.") \
  X(ACTUATOR, HINGE, "hinge", NAME, NONE, ANY, "", OPTIONAL, 6, "", BY_HAND, "The hinge whose rest angle it changes, or to which it adds a moment.") \
  X(ACTUATOR, CELL, "cell", NAME, NONE, ANY, "", OPTIONAL, 6, "", BY_HAND, "The cell whose given pressure it changes.") \
  X(ACTUATOR, SIGNAL, "signal", SIGNAL, CONTEXT, ANY, "", OPTIONAL, 7, "", BY_HAND, "Added to the rest length of the member, to the rest angle of the hinge, or to the pressure of the cell.") \
  X(ACTUATOR, FORCE, "force", SIGNAL, FORCE, ANY, "", OPTIONAL, 7, "", BY_HAND, "Instead of `signal`: a force added to the member's own, tension positive. Statics leave it out.") \
  X(ACTUATOR, MOMENT, "moment", SIGNAL, CONTEXT, ANY, "", OPTIONAL, 7, "", BY_HAND, "Instead of `signal`: a moment added to the hinge's own, which closes its angle where positive. Statics leave it out.") \
  X(LOAD, NODE, "node", NAME, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "The node on which the force acts.") \
  X(LOAD, FORCE, "force", PAIR, FORCE, ANY, "", REQUIRED, 0, "", FIELD(strut_load, force), "The force; with a signal, the force while the signal is 1.") \
  X(LOAD, SIGNAL, "signal", SIGNAL, NONE, ANY, "constant 1", OPTIONAL, 0, "", BY_HAND, "Factor on the force.") \
  X(UNBALANCE, NODE, "node", NAME, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "The node about which it rotates.") \
  X(UNBALANCE, MASS, "mass", NUMBER, MASS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_unbalance, mass), "The rotating mass, which counts to the node's mass.") \
  X(UNBALANCE, RADIUS, "radius", NUMBER, LENGTH, NOT_NEGATIVE, "", REQUIRED, 0, "", FIELD(strut_unbalance, radius), "Its distance from the node.") \
  X(UNBALANCE, SPEED, "speed", NUMBER, CONTEXT, ANY, "", OPTIONAL, 9, "", BY_HAND, "Its constant speed, counter-clockwise: turns per second such as 30 Hz, or 188 rad/s; a plain number is in rad/s.") \
  X(UNBALANCE, SIGNAL, "angle", SIGNAL, ANGLE, ANY, "", OPTIONAL, 9, "", BY_HAND, "Its angle instead, as a signal that must not jump.") \
  X(UNBALANCE, PHASE, "phase", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", FIELD(strut_unbalance, phase), "Added to the angle, which counts from +x.") \
  X(SLIDER, MEMBER, "member", NAME, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "The member on whose straight line between its two nodes it is.") \
  X(SLIDER, MASS, "mass", NUMBER, MASS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_sliding_mass, mass), "The mass, a point.") \
  X(SLIDER, POSITION, "position", NUMBER, CONTEXT, ANY, "0", OPTIONAL, 0, "", BY_HAND, "Where it is: a share of the member, such as 50 %, or a length as drawn, from its first node.") \
  X(SLIDER, MOVES, "moves", SIGNAL, NONE, ANY, "", OPTIONAL, 1, "", BY_HAND, "Added to the position, as a share of the member: a signal that must not jump.") \
  X(SLIDER, TRAVEL, "travel", SIGNAL, LENGTH, ANY, "", OPTIONAL, 1, "", BY_HAND, "The same as a length along the member as drawn, which stretches with it.") \
  X(SIGNAL, CONSTANT, "constant", NUMBER, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "A constant, for t >= 0.") \
  X(SIGNAL, SINE, "sine", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "amplitude * sin(2 pi frequency (t - start) + phase).") \
  X(SIGNAL, HALF_SINE, "half_sine", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "One half-wave of a sine, then 0.") \
  X(SIGNAL, SQUARE, "square", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "+amplitude in the first half of each period, -amplitude in the second.") \
  X(SIGNAL, RAMP, "ramp", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Rises linearly from 0 at `start` to amplitude at `stop` and stays there.") \
  X(SIGNAL, TABLE, "table", TABLE, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "Points `[[t, value], ...]`, interpolated linearly; constant before the first and after the last.") \
  X(SIGNAL, SUM, "sum", SIGNALS, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "The sum of the listed signals.") \
  X(SIGNAL, EXPRESSION, "expression", EXPRESSION, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "An expression of the time `t`, parameters, [sensors](#sensor) and other signals by their names, evaluated whenever forces are.") \
  X(SIGNAL, STARTS, "starts", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Beside one of the keys above: the event with which the time of the signal begins. Before it the signal is 0.") \
  X(SIGNAL, LAG, "lag", NUMBER, TIME, ABOVE_ZERO, "0", OPTIONAL, 0, "", FIELD(strut_signal, lag), "Beside one of the keys above: time constant of a first-order lag, which begins at 0. It comes before sampling.") \
  X(SIGNAL, EVERY, "every", NUMBER, TIME, ABOVE_ZERO, "0", OPTIONAL, 0, "", FIELD(strut_signal, every), "Beside one of the keys above: the signal is sampled at the multiples of this time, and held in between.") \
  X(SINE, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, amplitude), "Largest value.") \
  X(SINE, FREQUENCY, "frequency", NUMBER, FREQUENCY, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_signal, frequency), "Periods per second.") \
  X(SINE, PHASE, "phase", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", BY_HAND, "Phase angle at `start`.") \
  X(SINE, START, "start", NUMBER, TIME, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, start), "The signal is 0 before this time.") \
  X(SINE, STOP, "stop", NUMBER, TIME, ANY, "never", OPTIONAL, 0, "", FIELD(strut_signal, stop), "The signal is 0 from this time on.") \
  X(HALF_SINE, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, amplitude), "Largest value.") \
  X(HALF_SINE, FREQUENCY, "frequency", NUMBER, FREQUENCY, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_signal, frequency), "Frequency of the sine; the half-wave lasts 1 / (2 frequency).") \
  X(HALF_SINE, START, "start", NUMBER, TIME, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, start), "Time at which the half-wave begins.") \
  X(SQUARE, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, amplitude), "Largest value.") \
  X(SQUARE, FREQUENCY, "frequency", NUMBER, FREQUENCY, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_signal, frequency), "Periods per second.") \
  X(SQUARE, PHASE, "phase", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", BY_HAND, "Phase angle at `start`.") \
  X(SQUARE, START, "start", NUMBER, TIME, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, start), "The signal is 0 before this time.") \
  X(SQUARE, STOP, "stop", NUMBER, TIME, ANY, "never", OPTIONAL, 0, "", FIELD(strut_signal, stop), "The signal is 0 from this time on.") \
  X(RAMP, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, amplitude), "Value from `stop` on.") \
  X(RAMP, START, "start", NUMBER, TIME, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, start), "Time at which the signal leaves 0.") \
  X(RAMP, STOP, "stop", NUMBER, TIME, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, stop), "Time at which it reaches the amplitude.") \
  X(SENSOR, LENGTH, "length", NAME, NONE, ANY, "", OPTIONAL, 7, "", BY_HAND, "The member whose length it senses [m].") \
  X(SENSOR, FORCE, "force", NAME, NONE, ANY, "", OPTIONAL, 7, "", BY_HAND, "The member whose force it senses [N], tension positive: with damper and stops, without what an actuator's `force` adds.") \
  X(SENSOR, ANGLE, "angle", NAME, NONE, ANY, "", OPTIONAL, 7, "", BY_HAND, "The hinge whose angle it senses [rad].") \
  X(SENSOR, CONTACT, "contact", NAME, NONE, ANY, "", OPTIONAL, 7, "", BY_HAND, "The node whose touch it senses: 1 while the node is in the ground, else 0.") \
  X(SENSOR, POSITION, "position", NAME, NONE, ANY, "", OPTIONAL, 7, "", BY_HAND, "The node whose position it senses [m], `along` x or y.") \
  X(SENSOR, VELOCITY, "velocity", NAME, NONE, ANY, "", OPTIONAL, 7, "", BY_HAND, "The node whose velocity it senses [m/s], `along` x or y.") \
  X(SENSOR, ENERGY, "energy", WORD, NONE, ANY, "", OPTIONAL, 7, "kinetic|elastic|total", FIELD(strut_sensor, energy), "The energy of the structure that it senses [J].") \
  X(SENSOR, ALONG, "along", WORD, NONE, ANY, "", OPTIONAL, 0, "x|y", FIELD(strut_sensor, along), "Direction of a position or a velocity.") \
  X(STATE, RATE, "rate", EXPRESSION, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "Its rate: an expression as that of a signal, which may also use states.") \
  X(STATE, START, "start", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "Its value at t = 0, with its unit.") \
  X(OSCILLATOR, FREQUENCY, "frequency", NUMBER, FREQUENCY, ANY, "", REQUIRED, 0, "", BY_HAND, "Its own frequency.") \
  X(OSCILLATOR, PHASE, "phase", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", BY_HAND, "Phase at t = 0.") \
  X(OSCILLATOR, COUPLING, "coupling", THINGS, NONE, ANY, "", OPTIONAL, 0, "the strength K of the coupling to that oscillator [1/s]", BY_HAND, "Adds K sin(phase of the other - own phase - bias) to the rate of the phase.") \
  X(OSCILLATOR, BIAS, "bias", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", BY_HAND, "Phase by which the others are to be ahead.") \
  X(OSCILLATOR, FEEDBACK, "feedback", EXPRESSION, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "Added to the rate of the phase: an expression as that of a signal.") \
  X(CONTROLLER, SENSOR, "sensor", NAME, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "The sensor s that it controls.") \
  X(CONTROLLER, TARGET, "target", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "Wanted value of the sensor. The error is e = target - s.") \
  X(CONTROLLER, GAIN, "gain", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "The signal is gain e + integral times the integral of e - derivative ds/dt.") \
  X(CONTROLLER, INTEGRAL, "integral", NUMBER, CONTEXT, ANY, "0", OPTIONAL, 0, "", BY_HAND, "In the unit of the gain per second.") \
  X(CONTROLLER, DERIVATIVE, "derivative", NUMBER, CONTEXT, ANY, "0", OPTIONAL, 0, "", BY_HAND, "In the unit of the gain times a second. A rest length needs `every` with it.") \
  X(CONTROLLER, LEAST, "least", NUMBER, CONTEXT, ANY, "none", OPTIONAL, 0, "", BY_HAND, "Least value of the signal.") \
  X(CONTROLLER, MOST, "most", NUMBER, CONTEXT, ANY, "none", OPTIONAL, 0, "", BY_HAND, "Largest value. Between limits the integral follows what the limits leave (no windup).") \
  X(CONTROLLER, EVERY, "every", NUMBER, TIME, ABOVE_ZERO, "0", OPTIONAL, 0, "", BY_HAND, "Time between samples; 0: the controller is continuous.") \
  X(CONTROLLER, KIND, "kind", WORD, NONE, ANY, "pid", OPTIONAL, 0, "pid|relay", BY_HAND, "`relay`: the controller has the keys of a [relay](#relay) instead.") \
  X(RELAY, KIND, "kind", WORD, NONE, ANY, "", REQUIRED, 0, "relay", BY_HAND, "Which controller it is.") \
  X(RELAY, OF, "of", EXPRESSION, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "Its input: a sensor, or an expression as that of a signal.") \
  X(RELAY, ON_ABOVE, "on_above", NUMBER, CONTEXT, ANY, "", OPTIONAL, 7, "", BY_HAND, "It goes on when the input rises above this, and stays so until it goes off.") \
  X(RELAY, OFF_BELOW, "off_below", NUMBER, CONTEXT, ANY, "", OPTIONAL, 8, "", BY_HAND, "With `on_above`: it goes off when the input falls below this.") \
  X(RELAY, ON_BELOW, "on_below", NUMBER, CONTEXT, ANY, "", OPTIONAL, 7, "", BY_HAND, "Instead, as a thermostat: it goes on when the input falls below this.") \
  X(RELAY, OFF_ABOVE, "off_above", NUMBER, CONTEXT, ANY, "", OPTIONAL, 8, "", BY_HAND, "With `on_below`: it goes off when the input rises above this.") \
  X(RELAY, ON_VALUE, "on_value", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "The signal while it is on.") \
  X(RELAY, OFF_VALUE, "off_value", NUMBER, CONTEXT, ANY, "0", OPTIONAL, 0, "", BY_HAND, "The signal while it is off.") \
  X(RELAY, ON_AT_START, "on_at_start", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_relay, on_at_start), "Whether it is on at t = 0 where the input is between the thresholds.") \
  X(RELAY, EVERY, "every", NUMBER, TIME, ABOVE_ZERO, "0", OPTIONAL, 0, "", BY_HAND, "Time between samples; 0: it switches when the input passes a threshold, which methods with events locate.") \
  X(MAXWELL, STIFFNESS, "stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_maxwell, stiffness), "Stiffness k of the spring.") \
  X(MAXWELL, DAMPING, "damping", NUMBER, DAMPING, ABOVE_ZERO, "", OPTIONAL, 7, "", FIELD(strut_maxwell, damping), "Damping c of the dashpot.") \
  X(MAXWELL, TIME, "time", NUMBER, TIME, ABOVE_ZERO, "", OPTIONAL, 7, "", FIELD(strut_maxwell, time), "Instead of the damping: the time c/k in which the force relaxes.") \
  X(MAXWELL, FORCE, "force", NUMBER, FORCE, ANY, "0", OPTIONAL, 0, "", FIELD(strut_maxwell, force), "Force of the branch at t = 0; tension is positive.") \
  X(STARTS, CONTACT, "contact", NAME, NONE, ANY, "", OPTIONAL, 7, "", BY_HAND, "The node whose touchdown starts the signal.") \
  X(STARTS, SENSOR, "sensor", NAME, NONE, ANY, "", OPTIONAL, 7, "", BY_HAND, "The sensor that starts it, at the end of the step in which it passes a level.") \
  X(STARTS, ABOVE, "above", NUMBER, CONTEXT, ANY, "", OPTIONAL, 8, "", BY_HAND, "Level above which the sensor rises.") \
  X(STARTS, BELOW, "below", NUMBER, CONTEXT, ANY, "", OPTIONAL, 8, "", BY_HAND, "Level below which it falls.") \
  X(STARTS, EACH, "each", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_trigger, each), "Start again each time, not only the first.") \
  X(CONFIGURATION, CONTACTS, "contacts", NODE_SETS, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "The nodes that touch the ground in this shape; several lists are alternatives.") \
  X(CONFIGURATION, SHAPE, "shape", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[x, y]`", BY_HAND, "Approximate positions; nodes that are not listed stay as drawn. Without `shape` the contacts alone identify the configuration.") \
  X(INITIAL, CONFIGURATION, "configuration", NAME, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "A configuration, or a text parameter that names one.") \
  X(INITIAL, EQUILIBRIUM, "equilibrium", NAME, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "A configuration, or a text parameter that names one, from whose equilibrium the run starts; replaces `configuration`, `positions` and `settle`.") \
  X(INITIAL, POSITIONS, "positions", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[x, y]`", BY_HAND, "Positions of single nodes; they take precedence over the configuration.") \
  X(INITIAL, VELOCITIES, "velocities", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[vx, vy]`", BY_HAND, "Velocities of single nodes.") \
  X(INITIAL, VELOCITY, "velocity", PAIR, VELOCITY, ANY, "[0, 0]", OPTIONAL, 0, "", BY_HAND, "Velocity of all other nodes in the directions in which they are free.") \
  X(INITIAL, SETTLE, "settle", SETTLE, NONE, ANY, "false", OPTIONAL, 0, "", BY_HAND, "Let the structure come to rest before t = 0, with actuators, driven loads, the belt and (as in the paper) friction switched off.") \
  X(SETTLE, SPEED, "speed", NUMBER, VELOCITY, ABOVE_ZERO, "1e-8", WRITTEN, 0, "", FIELD(strut_settle, speed), "The structure is at rest when the speed of every node is below this value") \
  X(SETTLE, ACCELERATION, "acceleration", NUMBER, ACCELERATION, ABOVE_ZERO, "1e-8", WRITTEN, 0, "", FIELD(strut_settle, acceleration), "and the acceleration of every node is below this value.") \
  X(SETTLE, LIMIT, "limit", NUMBER, TIME, ABOVE_ZERO, "100", WRITTEN, 0, "", FIELD(strut_settle, limit), "Longest simulated time.") \
  X(SETTLE, EVALUATIONS, "evaluations", NUMBER, NONE, ABOVE_ZERO, "4e7", OPTIONAL, 0, "", FIELD(strut_settle, evaluations), "Largest number of force evaluations.") \
  X(SETTLE, STEP, "step", NUMBER, TIME, NOT_NEGATIVE, "`solver.step`", OPTIONAL, 0, "", BY_HAND, "Time step of the Runge-Kutta method that settles, whatever the method of the run. Half the stability limit is used instead for `0`, for a step above that limit, and where the file gives no step.") \
  X(SETTLE, PERTURB, "perturb", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_settle, perturb), "Leave unstable equilibria: push slightly along the most unstable direction and settle again, until the equilibrium is stable.") \
  X(SETTLE, FRICTION, "friction", WORD, NONE, ANY, "none", OPTIONAL, 0, "none|kept", FIELD(strut_settle, friction), "`kept` leaves friction on, which a body on a slope needs; `none` switches it off, as in the paper.") \
  X(EQUILIBRIA, SUPPORTS, "supports", NODE_SETS, NONE, ANY, "every pair that can carry", OPTIONAL, 0, "", BY_HAND, "Contact nodes to support in turn: the first node of each list is pinned, the others roll on the ground.") \
  X(EQUILIBRIA, STARTS, "starts", NUMBER, NONE, WHOLE(0, STRUT_MOST_STARTS), "until few equilibria can be missing", OPTIONAL, 0, "", FIELD(strut_search, starts), "Random starts for each list of supports.") \
  X(EQUILIBRIA, SEED, "seed", NUMBER, NONE, WHOLE(0, STRUT_MOST_SEED), "1", WRITTEN, 0, "", FIELD(strut_search, seed), "Seed of the random starts; the same seed gives the same result.") \
  X(SOLVER, INTEGRATOR, "integrator", WORD, NONE, ANY, "rk4", WRITTEN, 0, STRUT_INTEGRATOR_WORDS, FIELD(strut_experiment, integrator), "Time integration method.") \
  X(SOLVER, STEP, "step", NUMBER, TIME, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_experiment, step), "Time step; with `adaptive`, the longest step. A run needs `step` or `accuracy`.") \
  X(SOLVER, TOLERANCE, "tolerance", NUMBER, NONE, ABOVE_ZERO, "1e-6", OPTIONAL, 0, "", FIELD(strut_experiment, tolerance), "Relative local error per step of `adaptive`.") \
  X(SOLVER, REFINE, "refine", NUMBER, NONE, ABOVE_ZERO, "from the scene", OPTIONAL, 0, "", FIELD(strut_experiment, refine), "Methods with events divide the step by this factor after a touchdown; 1 switches the refinement off.") \
  X(SOLVER, REFINE_TIME, "refine_time", NUMBER, TIME, ABOVE_ZERO, "from the scene", OPTIONAL, 0, "", FIELD(strut_experiment, refine_time), "Duration of the refinement after a touchdown.") \
  X(SOLVER, ACCURACY, "accuracy", NUMBER, NONE, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_experiment, accuracy), "Wanted relative accuracy of the measured quantities, such as 1 %; method and step are chosen to meet it.") \
  X(SOLVER, BUDGET, "budget", NUMBER, NONE, ABOVE_ZERO, STRUT_TEXT_OF(STRUT_USUAL_BUDGET), OPTIONAL, 0, "", FIELD(strut_experiment, budget), "Work allowed for `accuracy`, in units of one fine run with a fixed step; a result that would need more is reported as such.") \
  X(RUN, DURATION, "duration", NUMBER, TIME, ABOVE_ZERO, "", OPTIONAL, 3, "", FIELD(strut_experiment, duration), "Simulated time.") \
  X(RUN, PERIODS, "periods", NUMBER, NONE, ABOVE_ZERO, "", OPTIONAL, 3, "", FIELD(strut_experiment, periods), "Simulated time in periods of the signal that `of` names.") \
  X(RUN, OF, "of", NAME, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "The actuator, load or signal whose periods count.") \
  X(RUN, MEASURE, "measure", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "What is measured; by default the velocity of the centre of mass over the whole run.") \
  X(MEASURE, LAST, "last", NUMBER, CONTEXT, ABOVE_ZERO, "the whole run", OPTIONAL, 0, "", FIELD(strut_experiment, measure_last), "Length of the measuring window at the end of the run: a number of periods if the run is given in periods, otherwise a time.") \
  X(MEASURE, STEADY, "steady", STEADY, NONE, ANY, "false", OPTIONAL, 0, "", BY_HAND, "Stop as soon as the motion repeats itself. The run must be given in periods, which are then an upper bound.") \
  X(MEASURE, NODE, "node", NAME, NONE, ANY, "the centre of mass", OPTIONAL, 0, "", BY_HAND, "The node whose velocity is measured.") \
  X(MEASURE, QUANTITIES, "quantities", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression, whose mean is measured, or the keys of a [quantity](#quantity)", BY_HAND, "Further quantities to measure over the window.") \
  X(QUANTITY, OF, "of", EXPRESSION, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "An expression of columns of the motion, listed in [the language](language.md#measured-quantities).") \
  X(QUANTITY, TAKE, "take", WORD, NONE, ANY, "mean", OPTIONAL, 0, "mean|min|max|range|rms|final|change|rate|rise|arrival", FIELD(strut_quantity_definition, take), "How the window reduces the expression to one number: `mean` over time, `min`, `max`, `range` (max - min), `rms`, `final` value, `change` from the first to the last value, `rate` (change / time), `rise` (sum of all increases), or `arrival`, the time at which `target` is first reached or passed.") \
  X(QUANTITY, ACCURACY, "accuracy", NUMBER, CONTEXT, ABOVE_ZERO, "that of the solver", OPTIONAL, 0, "", BY_HAND, "Wanted accuracy: relative if given without a unit, such as 1 %, absolute with a unit, such as 0.1 mm.") \
  X(QUANTITY, TARGET, "target", NUMBER, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "Value that `take: arrival` waits for, from below or above, in the unit of the expression.") \
  X(STEADY, TOLERANCE, "tolerance", NUMBER, NONE, ABOVE_ZERO, "0.5 %", WRITTEN, 0, "", FIELD(strut_steady, tolerance), "Largest relative difference of the velocity between repetitions.") \
  X(STEADY, ABSOLUTE_TOLERANCE, "absolute_tolerance", NUMBER, VELOCITY, ABOVE_ZERO, "from the scene", OPTIONAL, 0, "", FIELD(strut_steady, floor), "Differences of the velocity below this value are neglected.") \
  X(STEADY, REPETITIONS, "repetitions", NUMBER, NONE, WHOLE(2, 16), "5", WRITTEN, 0, "", FIELD(strut_steady, successive), "Number of successive repetitions that must agree.") \
  X(STEADY, SHOOTING, "shooting", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_steady, shooting), "Solve for the periodic orbit by Newton's method (shooting) and report its Floquet multipliers; for structures with up to 48 degrees of freedom.") \
  X(OUTPUT, EVERY, "every", NUMBER, TIME, ABOVE_ZERO, "a thousandth of the recorded time", OPTIONAL, 0, "", FIELD(strut_experiment, output_every), "Time between two samples.") \
  X(OUTPUT, LAST, "last", NUMBER, CONTEXT, ABOVE_ZERO, "the whole run", OPTIONAL, 0, "", FIELD(strut_experiment, output_last), "Record only the end of the run: a number of periods if the run is given in periods, otherwise a time.") \
  X(OUTPUT, CHANNELS, "channels", WORDS, NONE, ANY, "[position, length, force]", WRITTEN, 0, STRUT_CHANNEL_WORDS, FIELD(strut_experiment, channels), STRUT_CHANNEL_DESCRIPTION) \
  X(STUDY, VERSION, "strut", VERSION, NONE, ANY, "", REQUIRED, 0, "1", BY_HAND, "Version of the language.") \
  X(STUDY, NAME, "study", TEXT, NONE, ANY, "", REQUIRED, 0, "", FIELD(strut_study, name), "Name of the study.") \
  X(STUDY, DESCRIPTION, "description", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study, description), "What the study is for.") \
  X(STUDY, MODEL, "model", TEXT, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "File of the model, in the folder of the study or below.") \
  X(STUDY, SET, "set", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression or a text", BY_HAND, "Values of the model's parameters at all points; `--set` takes precedence.") \
  X(STUDY, AXES, "axes", AXES, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Each axis gives one parameter its values, `{NAME: [...]}` or `{NAME: {...}}` with the keys of a [range](#range), or several parameters together, `{zip: {NAME: ..., NAME: ...}}`. Several parameters go together in `{points: FILE}`, with a row for each value, or the keys of [points](#points), and in `{sample: {...}}`, with the keys of a [sample](#sample). The points are all combinations of the axes; the last axis varies fastest. Required without a `search` or a `sensitivity` analysis; beside one, there is one for each of these points.") \
  X(STUDY, DERIVE, "derive", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression", BY_HAND, "Parameters computed from others at each point, such as `{step: 1/(1000*frequency)}`.") \
  X(STUDY, VARIANTS, "variants", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a [variant](#variant)", BY_HAND, "Variants of the model, for example with other numerics; they form the first axis, the column `variant`.") \
  X(STUDY, SOLVER, "solver", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Keys that replace those of the model.") \
  X(STUDY, RUN, "run", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Keys that replace those of the model.") \
  X(STUDY, INITIAL, "initial", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Keys that replace those of the model.") \
  X(STUDY, OUTPUT, "output", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Keys that replace those of the model.") \
  X(STUDY, KEEP, "keep", KEEP, NONE, ANY, "[velocity, velocity_spread, motion, periods, force_evaluations, outcome, quantities]", OPTIONAL, 0, "velocity|velocity_spread|velocity_interval|motion|repeats|periods|distance|duration|settle_time|steps|force_evaluations|check_evaluations|events|method|step|step_limit|expected_error|energy|work|losses|residual|contacts|positions|outcome|quantities|accuracy_kept|node_count|member_count|degrees_of_freedom|total_mass|stable_count|equilibrium_count|states|energies|barriers|starts|missed_probability|at|frequencies|damping_ratios|mode_counts|condition|rank|self_stress_count|mechanism_count|mechanism_kinds|super_stable|label|limit_factor|bifurcation_factor|critical_factor|last_factor|event_count|end|moved|density_change|least_tension|largest_force|lengths|cost_of_transport|lowest_barrier|stiffness|shape_distance|curve_distance", BY_HAND, "Columns of the table: `velocity` [m/s] and its spread over the window; `velocity_interval`, `motion` (periodic, irregular, creeping, transient), `repeats` and `periods` of runs that stop when steady; `distance` travelled per drive period; `energy` (at the end), `work` (of drives, loads, belt), `losses` and `residual` of the energy balance over the `duration`; `cost_of_transport` (net work of the drives over weight and distance in the window, and `work_per_distance` [N]); `contacts` (duty factor and height of each), `positions` (of each node at the end); `accuracy_kept` (1 if the wanted accuracy was reached, otherwise 0; always there where one is wanted); `outcome` (the nearest configuration); `quantities` (all that the model measures), or single ones by name; and further entries of the summary. Of every `compute`: `node_count`, `member_count`, `degrees_of_freedom`, `total_mass`. Of equilibria: `stable_count`, `equilibrium_count` (all that were found, saddles too), and of the stable states that are lowest in energy, `states` (names), `energies`, `barriers` (the lowest way out of each); `lowest_barrier` (out of any stable state); `starts`, `missed_probability`. Of modes: `at`, `frequencies` and `damping_ratios` of the lowest elastic modes, `mode_counts` (rigid-body, mechanisms, unstable), `condition`. Of rigidity: `rank`, `self_stress_count`, `mechanism_count`, `mechanism_kinds`, `super_stable`, `label`, `residual`. Of a path: `limit_factor` (the first limit point), `bifurcation_factor`, `critical_factor` (where stability is lost first), `last_factor`, `event_count`, `end`. Of a form: `moved`, `residual`, `density_change`, `least_tension`, `largest_force`, `lengths` (of members), `positions`. By default, of what is at rest: all but the first four, `lowest_barrier`, `lengths`, `positions`, and what compares with a goal: `stiffness` (at `stiffness_at`), `shape_distance` (root mean square over nodes, after the best rigid motion: at the end of a run, of the nearest stable state, of the equilibrium of modes), `curve_distance` (root mean square of forces).") \
  X(STUDY, TRAJECTORIES, "trajectories", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_study, trajectories), "Write the results of each run to a folder `runs/POINT`, as `strut run -o` does.") \
  X(STUDY, CHECK, "check", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Repeat each point more accurately and mark the points whose outcome changes.") \
  X(STUDY, FIGURES, "figures", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a [figure](#figure)", BY_HAND, "Figures of the table or of the recorded motions, each written to NAME.svg.") \
  X(STUDY, COMPUTE, "compute", WORD, NONE, ANY, "run", OPTIONAL, 0, "run|equilibria|modes|rigidity|path|form", FIELD(strut_study, compute), "What is computed at each point: a run, or what the command of that name finds at rest.") \
  X(STUDY, LOWEST, "lowest", NUMBER, NONE, WHOLE(1, 20), "3", OPTIONAL, 0, "", FIELD(strut_study, lowest), "How many `energies`, `states`, `barriers`, `frequencies` and `damping_ratios` a row lists, the lowest first.") \
  X(STUDY, AT, "at", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study, at), "The equilibrium of modes, rigidity and path, as `--at` of these commands.") \
  X(STUDY, PATH, "path", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "What `compute: path` follows.") \
  X(STUDY, REFINE, "refine", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Divide the cells of a map where a column changes, instead of computing all points of a fine grid.") \
  X(STUDY, SENSITIVITY, "sensitivity", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "What columns owe to which parameters: derivatives, and first-order and total indices from samples, at every point of the axes.") \
  X(STUDY, STIFFNESS_AT, "stiffness_at", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Of `compute: modes`: the node and the direction of the column `stiffness`.") \
  X(STUDY, SHAPE, "shape", THINGS, NONE, ANY, "", OPTIONAL, 0, "positions `[x, y]` of nodes", BY_HAND, "The shape that `shape_distance` compares with: places of some nodes or of all.") \
  X(STUDY, LIKE, "like", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study, like), "Instead of `shape`: a configuration of the model that has positions.") \
  X(STUDY, CURVE, "curve", POINTS, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "Of `compute: path` with `over: NODE.x` or `NODE.y`: displacements and forces `[[-1 mm, 2 N], ...]` that `curve_distance` compares with.") \
  X(STUDY, LIMIT, "limit", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "What a point may cost. One that needs more fails, and its row says so.") \
  X(STUDY, FORM, "form", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "How `compute: form` finds the form.") \
  X(STUDY, SEARCH, "search", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Search for the parameters at which a column is best, instead of computing the points of a grid.") \
  X(STUDY, FOLLOW, "follow", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Follow periodic motions, stable or not, over a parameter at every point of the axes, as `strut follow` does, instead of running the points.") \
  X(RANGE, FROM, "from", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "First value.") \
  X(RANGE, TO, "to", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "Last value, if the steps meet it.") \
  X(RANGE, STEP, "step", NUMBER, CONTEXT, ANY, "", OPTIONAL, 4, "", BY_HAND, "Difference between successive values.") \
  X(RANGE, COUNT, "count", NUMBER, NONE, ABOVE_ZERO, "", OPTIONAL, 4, "", BY_HAND, "Number of values, including both ends.") \
  X(RANGE, SCALE, "scale", WORD, NONE, ANY, "linear", OPTIONAL, 0, "linear|log", BY_HAND, "`log`: equal ratios instead of equal differences; needs `count`.") \
  X(VARIANT, SOLVER, "solver", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Keys that replace those of the study and of the model.") \
  X(VARIANT, RUN, "run", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Keys that replace those of the study and of the model.") \
  X(VARIANT, INITIAL, "initial", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Keys that replace those of the study and of the model.") \
  X(VARIANT, OUTPUT, "output", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Keys that replace those of the study and of the model.") \
  X(CHECK, HALF_STEP, "half_step", WORD, NONE, ANY, "no", OPTIONAL, 5, "no|yes", FIELD(strut_study, half_step), "Repeat with half the step, or with half the `accuracy` if the model gives one.") \
  X(CHECK, ACCURACY, "accuracy", NUMBER, NONE, ABOVE_ZERO, "", OPTIONAL, 5, "", FIELD(strut_study, check_accuracy), "Repeat with this accuracy.") \
  X(FIGURE, KIND, "kind", WORD, NONE, ANY, "lines", OPTIONAL, 0, "lines|map|motion|period|snapshots|best|points|winner", FIELD(strut_study_figure, kind), "Figures of the table: `lines`, or a `map` in which colour shows the value at each point. Figures of recorded motions, which need `trajectories: yes`: `motion`, lines from a table with one row per node and sample (columns: the axes, `node`, `time`, `elapsed` since the record began, `x`, `y`, and the displacements `dx`, `dy` since then); `period` and `snapshots`, one picture per run, as by `strut run --draw`. Figures of a [search](#search): `best`, the best objective so far over evaluations, `points` over `x` and `y`, the best of each search in a ring, and `winner`, the best of all beside the start, as `strut compare` draws them.") \
  X(FIGURE, AT_X, "x", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, x), "Column on the x axis; required for lines, maps and motion.") \
  X(FIGURE, AT_Y, "y", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, y), "Column on the y axis; required as `x` is.") \
  X(FIGURE, SERIES, "series", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, series), "Lines: the column that distinguishes the lines.") \
  X(FIGURE, COLOR, "color", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, color), "Map: the column shown by colour; hatched where `flips` is 1.") \
  X(FIGURE, PANELS, "panels", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, panels), "The column with one panel for each of its values.") \
  X(FIGURE, BAND, "band", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, band), "Lines: `COLUMN=TEXT`, a grey band where the column has that text, up to halfway to the neighbouring points.") \
  X(FIGURE, ONLY, "only", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, only), "`COLUMN=TEXT`: draw only the rows in which the column has that text, such as `variant=coarse`.") \
  X(FIGURE, DIFFERENCE, "difference", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, difference), "A column with two different texts. Lines: `y` of the second minus `y` of the first; map: the second, hatched where the first differs; picture: the second, with the first dashed.") \
  X(FIGURE, FROM, "from", NUMBER, TIME, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, from), "Motion: start of the time range.") \
  X(FIGURE, TO, "to", NUMBER, TIME, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, to), "Motion: end of the time range.") \
  X(FIGURE, SCALE, "scale", PAIR, NONE, ANY, "[1, 1]", OPTIONAL, 0, "", FIELD(strut_study_figure, scale), "Period: magnification of the motion along x and y.") \
  X(FIGURE, TIMES, "times", TIMES, NONE, ANY, "six", OPTIONAL, 0, "", BY_HAND, "Snapshots: the times to draw.") \
  X(FIGURE, TITLE, "title", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, title), "Title of the figure.") \
  X(FIGURE, X_LABEL, "x_label", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, x_label), "Lines, map and motion: label of the x axis instead of the column's name; the unit is added.") \
  X(FIGURE, Y_LABEL, "y_label", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, y_label), "Likewise of the y axis.") \
  X(FIGURE, X_LIMITS, "x_limits", PAIR, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, x_limits), "Lines, map and motion: ends of the x axis in the column's SI unit, ascending.") \
  X(FIGURE, Y_LIMITS, "y_limits", PAIR, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, y_limits), "Likewise of the y axis.") \
  X(FIGURE, COLORS, "colors", WORD, NONE, ANY, "auto", OPTIONAL, 0, "auto|sequential|diverging|grey", FIELD(strut_study_figure, colours), "Map: the colour scale of numbers.") \
  X(PATH, LOAD, "load", TEXT, NONE, ANY, "all without a signal", OPTIONAL, 6, "", FIELD(strut_study, path_load), "The load to scale.") \
  X(PATH, OVER, "over", TEXT, NONE, ANY, "", OPTIONAL, 6, "", FIELD(strut_study, path_over), "Instead of loads, an actuator, or a displacement `NODE.x` or `NODE.y`.") \
  X(PATH, FROM, "from", NUMBER, CONTEXT, ANY, "0", OPTIONAL, 0, "", BY_HAND, "Start value: a load factor, or in the unit of `over`.") \
  X(PATH, UNTIL, "until", NUMBER, CONTEXT, ANY, "load factor 1", OPTIONAL, 0, "", BY_HAND, "End value, likewise; required with `over`.") \
  X(PATH, STEPS, "steps", NUMBER, NONE, WHOLE(1, 1000000), "400", OPTIONAL, 0, "", FIELD(strut_study, path_steps), "Maximum number of steps.") \
  X(FORM, FROM, "from", WORD, NONE, ANY, "scene", OPTIONAL, 0, "scene|densities|lengths|prestress", FIELD(strut_study, form_from), "What gives the shape; `scene`: as the model's keys say.") \
  X(FORM, LEAST_TENSION, "least_tension", NUMBER, FORCE, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_study, form_least_tension), "Lower bound on the tension of every cable.") \
  X(FORM, LEAST_DENSITY, "least_density", NUMBER, STIFFNESS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_study, form_least_density), "Lower bound on the force density of every cable.") \
  X(FORM, OBJECTIVE, "objective", WORD, NONE, ANY, "largest", OPTIONAL, 0, "largest|sum|squares", FIELD(strut_study, form_objective), "Which prestress: that whose minimum this is.") \
  X(POINTS, FILE, "file", TEXT, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "A CSV file with a header, below the folder of the study. `NAME [UNIT]` heads the values of a parameter; without a unit they are in SI.") \
  X(POINTS, COLUMNS, "columns", NAMES, NONE, ANY, "all but `point`, `status` and `message`", OPTIONAL, 0, "", BY_HAND, "The columns to use; others are skipped.") \
  X(SAMPLE, COUNT, "count", NUMBER, NONE, WHOLE(1, 1000000), "", REQUIRED, 0, "", BY_HAND, "Number of points.") \
  X(SAMPLE, SEED, "seed", NUMBER, NONE, WHOLE(1, 4294967295), "1", OPTIONAL, 0, "", BY_HAND, "Another seed gives other points, the same seed the same.") \
  X(SAMPLE, SCHEME, "scheme", WORD, NONE, ANY, "sobol", OPTIONAL, 0, "sobol|lhs|random", BY_HAND, "`sobol`: Sobol's sequence, shifted by the seed; `lhs`: Latin hypercube; `random`: independent points.") \
  X(SAMPLE, OVER, "over", THINGS, NONE, ANY, "", REQUIRED, 0, "a [distribution](#distribution)", BY_HAND, "The parameters, up to 40, and their distributions.") \
  X(DISTRIBUTION, UNIFORM, "uniform", NUMBERS, CONTEXT, ANY, "", OPTIONAL, 10, "", BY_HAND, "`[LEAST, MOST]`.") \
  X(DISTRIBUTION, LOG_UNIFORM, "log_uniform", NUMBERS, CONTEXT, ANY, "", OPTIONAL, 10, "", BY_HAND, "`[LEAST, MOST]`, on one side of 0; the logarithm is uniform.") \
  X(DISTRIBUTION, NORMAL, "normal", NUMBERS, CONTEXT, ANY, "", OPTIONAL, 10, "", BY_HAND, "`[MEAN, DEVIATION]`.") \
  X(DISTRIBUTION, LOGNORMAL, "lognormal", NUMBERS, CONTEXT, ANY, "", OPTIONAL, 10, "", BY_HAND, "`[MEDIAN, DEVIATION]`, the deviation that of the natural logarithm, without unit.") \
  X(DISTRIBUTION, TRIANGULAR, "triangular", NUMBERS, CONTEXT, ANY, "", OPTIONAL, 10, "", BY_HAND, "`[LEAST, MODE, MOST]`.") \
  X(LIMIT, EVALUATIONS, "evaluations", NUMBER, NONE, WHOLE(1, 1000000000000000), "none", OPTIONAL, 0, "", FIELD(strut_study, limit_evaluations), "Force evaluations of each run, the check's too. The same points fail on every machine.") \
  X(LIMIT, TIME, "time", NUMBER, TIME, ABOVE_ZERO, "none", OPTIONAL, 0, "", FIELD(strut_study, limit_time), "Time of a point by the clock. Which points fail depends on the machine and its load; `--retry` computes them again.") \
  X(REFINE, WHERE, "where", NAME, NONE, ANY, "", REQUIRED, 0, "", FIELD(strut_study, refine_where), "A column of the table, such as `outcome`. Cells whose points differ in it are divided; a point that failed differs from others.") \
  X(REFINE, DEPTH, "depth", NUMBER, NONE, WHOLE(1, 10), "", REQUIRED, 0, "", BY_HAND, "How often: the finest cells have 2^depth of the width of those of the axes.") \
  X(REFINE, BY, "by", NUMBER, NONE, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_study, refine_by), "Numbers must differ by more than this, in the SI unit of the column.") \
  X(REFINE, AXES, "axes", NAMES, NONE, ANY, "the axes with ranges", OPTIONAL, 0, "", BY_HAND, "The parameters of the two axes to divide.") \
  X(SENSITIVITY, OF, "of", NAMES, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "Columns of the table: numbers, or texts such as `outcome`.") \
  X(SENSITIVITY, OVER, "over", THINGS, NONE, ANY, "", REQUIRED, 0, "a [distribution](#distribution)", BY_HAND, "The parameters, up to 20, and their distributions.") \
  X(SENSITIVITY, SAMPLES, "samples", NUMBER, NONE, WHOLE(0, 100000), "256", OPTIONAL, 0, "", BY_HAND, "Base samples of Saltelli's design, each of as many points as there are parameters, and two; 0: derivatives only.") \
  X(SENSITIVITY, SEED, "seed", NUMBER, NONE, WHOLE(1, 4294967295), "1", OPTIONAL, 0, "", BY_HAND, "Another seed gives other points, the same seed the same.") \
  X(SENSITIVITY, SCHEME, "scheme", WORD, NONE, ANY, "sobol", OPTIONAL, 0, "sobol|lhs|random", BY_HAND, "As that of a [sample](#sample).") \
  X(SENSITIVITY, DERIVATIVES, "derivatives", WORD, NONE, ANY, "yes", OPTIONAL, 0, "no|yes", BY_HAND, "Central differences about the medians, with two steps, four points for each parameter.") \
  X(SENSITIVITY, THRESHOLD, "threshold", NUMBER, NONE, NOT_NEGATIVE, "0", OPTIONAL, 0, "", BY_HAND, "Shares of the samples above it, within it in both directions, and below minus it, in the SI unit of the columns; 0: the share above 0.") \
  X(STIFFNESS_AT, NODE, "node", NAME, NONE, ANY, "", REQUIRED, 0, "", FIELD(strut_study, stiffness_node), "A node of the model.") \
  X(STIFFNESS_AT, DIRECTION, "direction", NUMBER, ANGLE, ANY, "", REQUIRED, 0, "", FIELD(strut_study, stiffness_direction), "From the x axis: 90 deg is upwards.") \
  X(SEARCH, MAXIMISE, "maximise", FREE, NONE, ANY, "", OPTIONAL, 12, "an expression of columns, or a list of two", BY_HAND, "What is to be as large as possible: a column of the table, or an expression of columns such as `velocity/frequency`. Two of them, `[velocity, -cost_of_transport]`: the points that no other one beats in both.") \
  X(SEARCH, MINIMISE, "minimise", FREE, NONE, ANY, "", OPTIONAL, 12, "an expression of columns, or a list of two", BY_HAND, "What is to be as small as possible, likewise: `abs(velocity - 10 mm/s)`.") \
  X(SEARCH, OVER, "over", THINGS, NONE, ANY, "", REQUIRED, 0, "the keys of a [variable](#variable), or a list of choices", BY_HAND, "The parameters to be found.") \
  X(SEARCH, METHOD, "method", WORD, NONE, ANY, "multistart", OPTIONAL, 0, "multistart|crs2|direct|isres|cobyla|bobyqa|sbplx|neldermead|cma|nsga2", FIELD(strut_study_search, method), "Of the whole range: `multistart` (points spread evenly, then `sbplx` from the best two that lie apart), `crs2` (points spread evenly, controlled random search, then `sbplx` from the best point), `direct` (dividing rectangles; has no seed), `isres` (evolution), `cma` (evolution by CMA-ES, a generation at a time). From a start: `cobyla`, `bobyqa`, `sbplx`, `neldermead`. Of two goals always `nsga2`.") \
  X(SEARCH, EVALUATIONS, "evaluations", NUMBER, NONE, WHOLE(1, 100000), "200", OPTIONAL, 0, "", FIELD(strut_study_search, evaluations), "How many different points each search may compute.") \
  X(SEARCH, STARTS, "starts", NUMBER, NONE, WHOLE(1, 1000), "1", OPTIONAL, 0, "", FIELD(strut_study_search, starts), "Searches side by side; the first begins at `start`, the others anywhere.") \
  X(SEARCH, SEED, "seed", NUMBER, NONE, WHOLE(1, 4294960000), "1", OPTIONAL, 0, "", FIELD(strut_study_search, seed), "Of the random numbers of the first search; the next has the next seed. The same seed gives the same points.") \
  X(SEARCH, SUBJECT_TO, "subject_to", NAMES, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "What must hold at the best point, a list of texts: `work < 2 mJ`, `outcome = I`; with `<`, `<=`, `>`, `>=` between expressions of columns, `=` and `!=` between a column of texts and a word.") \
  X(SEARCH, WORST_OVER, "worst_over", THINGS, NONE, ANY, "", OPTIONAL, 0, "a list of values, or the keys of a [range](#range)", BY_HAND, "Scenarios: each evaluation computes all combinations of these values, and the worst of them counts; what `subject_to` says must hold in all.") \
  X(VARIABLE, FROM, "from", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "Lower bound.") \
  X(VARIABLE, TO, "to", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "Upper bound.") \
  X(VARIABLE, START, "start", NUMBER, CONTEXT, ANY, "the middle", OPTIONAL, 0, "", BY_HAND, "Where the first search begins.") \
  X(VARIABLE, SCALE, "scale", WORD, NONE, ANY, "linear", OPTIONAL, 0, "linear|log", BY_HAND, "`log`: steps are ratios.") \
  X(VARIABLE, WRAPS, "wraps", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_search_variable, wraps), "`yes`: both bounds are the same, as 0 deg and 360 deg of a phase.") \
  X(VARIABLE, INTEGER, "integer", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_search_variable, integer), "`yes`: only whole numbers, of the SI unit.") \
  X(FOLLOW, OVER, "over", NAME, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "The parameter over which motions are followed.") \
  X(FOLLOW, FROM, "from", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "The lower end of its range.") \
  X(FOLLOW, TO, "to", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "The upper end.") \
  X(FOLLOW, AT, "at", NUMBERS, CONTEXT, ANY, "the model's own value, or the middle", OPTIONAL, 0, "", BY_HAND, "Values at which runs start branches.") \
  X(FOLLOW, START_FROM, "start_from", NAMES, NONE, ANY, "as the model says", OPTIONAL, 0, "", BY_HAND, "Configurations from whose equilibria these runs start.") \
  X(FOLLOW, ACCURACY, "accuracy", NUMBER, NONE, ABOVE_ZERO, STRUT_TEXT_OF(STRUT_FOLLOW_USUAL_PERCENT) " %", OPTIONAL, 0, "", FIELD(strut_study_follow, accuracy), "Relative error of velocities, at most 10 %.") \
  X(FOLLOW, INTEGRATOR, "integrator", WORD, NONE, ANY, "`rk4-events`, or `adaptive` where that cannot", OPTIONAL, 0, STRUT_INTEGRATOR_WORDS, FIELD(strut_study_follow, integrator), "A method that locates events where there are contacts or cables.") \
  X(FOLLOW, STEPS, "steps", NUMBER, NONE, WHOLE(1, 100000), STRUT_TEXT_OF(STRUT_FOLLOW_USUAL_STEPS), OPTIONAL, 0, "", FIELD(strut_study_follow, steps), "Maximum number of steps of a branch each way.") \
  X(FOLLOW, BASINS, "basins", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_study_follow, basins), "Kick the stable motions at the values of `at`, to find how far they may be pushed.")

/* clang-format on */

#endif
