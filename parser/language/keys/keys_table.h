/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The table of the language, one row per key; keys.h lists what is generated from it. Keys of a scene's things are rows
 * of engine/scene/things_table.h, which also explains the column `field`; those of parts and studies are here.
 *
 * X(section, id, name, type, measure, range, default, need, set, words, field, description)
 *
 * range: ANY, NOT_NEGATIVE, ABOVE_ZERO, SHARE(most) of shares above zero, WHOLE(least, most) of whole numbers. need:
 * REQUIRED keys must be given; `strut export` always writes REQUIRED and WRITTEN keys, OPTIONAL ones only where they
 * differ from the default. set: a mapping may give only one of the keys of a set (not 0). Words are separated by '|';
 * those of a nested mapping are what messages call it, if not by its key, and of NAMES what they are.
 */
#pragma once

#include "engine/scene/things_table.h"

/* clang-format off */
#define STRUT_PART_KEYS(X) \
  X(PART, USE, "use", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_part_keys, use), "File of a scene whose structure is the part, relative to this file. The part's own keys override it.") \
  X(PART, PARAMETERS, "parameters", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression", FIELD(strut_part_keys, parameters), "Default values, which `set` of a placement changes.") \
  X(PART, GROUPS, "groups", THINGS, NONE, ANY, "", OPTIONAL, 0, "keys of a member, a node or a contact", NONE, "As in a scene, in addition to those of the scene.") \
  X(PART, NODES, "nodes", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[x, y]` or the keys of a node", THINGS(NODE), "As in a scene, in the part's own coordinates.") \
  X(PART, MEMBERS, "members", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a member", THINGS(MEMBER), "As in a scene.") \
  X(PART, HINGES, "hinges", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a hinge", THINGS(HINGE), "As in a scene.") \
  X(PART, CELLS, "cells", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a cell", THINGS(CELL), "As in a scene.") \
  X(PART, PIPES, "pipes", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a pipe", THINGS(PIPE), "As in a scene.") \
  X(PART, COLLISIONS, "collisions", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a collision", THINGS(COLLISION), "As in a scene.") \
  X(PART, DISTANCES, "distances", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a distance", THINGS(DISTANCE), "As in a scene.") \
  X(PART, FEET, "feet", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a foot", THINGS(FOOT), "As in a scene.") \
  X(PART, BEAMS, "beams", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a beam", THINGS(BEAM), "As in a scene.") \
  X(PART, ACTUATORS, "actuators", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an actuator", THINGS(ACTUATOR), "As in a scene.") \
  X(PART, LOADS, "loads", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a load", THINGS(LOAD), "As in a scene; forces turn with the part.") \
  X(PART, UNBALANCES, "unbalances", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an unbalance", THINGS(UNBALANCE), "As in a scene.") \
  X(PART, SLIDERS, "sliders", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a slider", THINGS(SLIDER), "As in a scene.") \
  X(PART, SIGNALS, "signals", THINGS, NONE, ANY, "", OPTIONAL, 0, "a signal", THINGS(SIGNAL), "As in a scene, in addition to those of the scene.") \
  X(PART, CONFIGURATIONS, "configurations", THINGS, NONE, ANY, "", OPTIONAL, 0, "`{NODE: [x, y], ...}` or the keys of a [configuration](#configuration)", THINGS(CONFIGURATION), "Shapes of the part; all else stays as drawn.") \
  X(PART, SENSORS, "sensors", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a sensor", THINGS(SENSOR), "As in a scene.") \
  X(PART, STATES, "states", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a state", THINGS(STATE), "As in a scene.") \
  X(PART, OSCILLATORS, "oscillators", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an oscillator", THINGS(OSCILLATOR), "As in a scene.") \
  X(PART, CONTROLLERS, "controllers", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a controller", THINGS(CONTROLLER), "As in a scene.") \
  X(PART, CONTACTS, "contacts", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a contact", THINGS(CONTACT), "Nodes that may touch the ground, each with settings of its contact, or `{}`.") \
  X(PART, PARTS, "parts", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a part", THINGS(PART), "Parts for use within this one.") \
  X(PART, PLACE, "place", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a [place](#place)", THINGS(PLACE), "Copies of other parts within this one.") \
  X(PART, MERGE, "merge", FREE, NONE, ANY, "", OPTIONAL, 0, "touching, or {node: other node, ...}", FIELD(strut_part_keys, merge), "As in a scene, for nodes of the part.") \
  X(PART, PORTS, "ports", THINGS, NONE, ANY, "all nodes", OPTIONAL, 0, "the name of a node", FIELD(strut_part_keys, ports), "Names under which nodes are visible from outside; all other nodes are then hidden.") \
  X(PART, ISOLATED, "isolated", WORD, NONE, ANY, "no, `yes` with `use`", OPTIONAL, 0, "no|yes", FIELD(strut_part_keys, isolated), "`yes`: the part sees only its own parameters, groups, signals and parts.")

#define STRUT_PLACE_KEYS(X) \
  X(PLACE, PART, "part", NAME, NONE, ANY, "", REQUIRED, 0, "", FIELD(strut_place_keys, part), "The part to copy.") \
  X(PLACE, FLIP, "flip", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|x|y|both", FIELD(strut_place_keys, flip), "Changes the sign of coordinates. The order is always flip, scale, turn, move.") \
  X(PLACE, SCALE, "scale", FREE, NONE, ANY, "1", OPTIONAL, 0, "a number above zero, or fit", FIELD(strut_place_keys, scale), "Factor of all lengths of the copy, but not of masses, forces and stiffnesses. `fit`: as `onto` requires.") \
  X(PLACE, TURN, "turn", NUMBER, ANGLE, ANY, "0", OPTIONAL, 1, "", FIELD(strut_place_keys, turn), "Rotation of the copy about its origin, counter-clockwise.") \
  X(PLACE, AT, "at", PAIR, LENGTH, ANY, "[0, 0]", OPTIONAL, 2, "", FIELD(strut_place_keys, at), "Position of the copy's origin.") \
  X(PLACE, ONTO, "onto", THINGS, NONE, ANY, "", OPTIONAL, 2, "the name of a node outside", FIELD(strut_place_keys, onto), "Instead of `at`: one or two nodes of the copy and the placed nodes with which they merge. Two pairs also turn the copy, with `scale: fit` if their distances differ.") \
  X(PLACE, SET, "set", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression", FIELD(strut_place_keys, set), "Parameters of the part. Expressions may use the copy's numbers `i` and, in a lattice, `j`.") \
  X(PLACE, REPEAT, "repeat", FREE, NONE, ANY, "once", OPTIONAL, 0, "a number of copies, or the keys of repeat", FIELD(strut_place_keys, repeat), "Several copies.")

#define STRUT_REPEAT_KEYS(X) \
  X(REPEAT, COUNT, "count", FREE, NONE, ANY, "", REQUIRED, 0, "a whole number, or [n, m] for a lattice", FIELD(strut_repeat_keys, count), "Number of copies, numbered from 0.") \
  X(REPEAT, STEP, "step", FREE, NONE, ANY, "[0, 0]", OPTIONAL, 0, "a displacement such as [1 m, 0], or two of a lattice", FIELD(strut_repeat_keys, step), "Displacement from each copy to the next, in the copy's own frame.") \
  X(REPEAT, TURN, "turn", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", FIELD(strut_repeat_keys, turn), "Rotation of each copy against the one before.") \
  X(REPEAT, SCALE, "scale", NUMBER, NONE, ABOVE_ZERO, "1", OPTIONAL, 0, "", FIELD(strut_repeat_keys, scale), "Size of each copy divided by that of the one before.") \
  X(REPEAT, ABOUT, "about", PAIR, LENGTH, ANY, "[0, 0]", OPTIONAL, 0, "", FIELD(strut_repeat_keys, about), "The centre of `turn` and `scale`.") \
  X(REPEAT, NEXT, "next", FREE, NONE, ANY, "", OPTIONAL, 0, "the keys of next, or two such mappings for a lattice", FIELD(strut_repeat_keys, next), "What a copy shares with the next one.") \
  X(REPEAT, CLOSED, "closed", FREE, NONE, ANY, "no", OPTIONAL, 0, "yes, no, or {node: node of the first copy, ...}", FIELD(strut_repeat_keys, closed), "`yes`: the first copy follows the last one. A mapping names other nodes of the first copy, as in a ring with a twist.")

#define STRUT_NEXT_KEYS(X) \
  X(NEXT, MERGE, "merge", THINGS, NONE, ANY, "", OPTIONAL, 0, "the name of a node of the next copy", FIELD(strut_next_keys, merge), "Nodes of a copy and those of the next copy with which they merge: `{b: a}`.") \
  X(NEXT, MEMBERS, "members", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a member", THINGS(MEMBER), "Members between the two copies; `next.NAME` is a node of the next one.") \
  X(NEXT, HINGES, "hinges", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a hinge", THINGS(HINGE), "Likewise, between the two copies.") \
  X(NEXT, CELLS, "cells", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a cell", THINGS(CELL), "Likewise, between the two copies.") \
  X(NEXT, COLLISIONS, "collisions", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a collision", THINGS(COLLISION), "Likewise, between the two copies.") \
  X(NEXT, DISTANCES, "distances", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a distance", THINGS(DISTANCE), "Likewise, between the two copies.") \
  X(NEXT, FEET, "feet", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a foot", THINGS(FOOT), "Likewise, between the two copies.") \
  X(NEXT, BEAMS, "beams", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a beam", THINGS(BEAM), "Likewise, between the two copies.") \
  X(NEXT, ACTUATORS, "actuators", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an actuator", THINGS(ACTUATOR), "Likewise, between the two copies.") \
  X(NEXT, SLIDERS, "sliders", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a slider", THINGS(SLIDER), "Likewise, between the two copies.") \
  X(NEXT, SENSORS, "sensors", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a sensor", THINGS(SENSOR), "Likewise, between the two copies.")

#define STRUT_BEAM_KEYS(X) \
  X(BEAM, NODES, "nodes", NAME_PAIR, NONE, ANY, "", REQUIRED, 0, "", REFERENCE(strut_beam, node, NODE), "The nodes at its ends. A beam is straight at rest.") \
  X(BEAM, BENDING_STIFFNESS, "bending_stiffness", NUMBER, BENDING_STIFFNESS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_beam, bending_stiffness), "EI. With parts of length h a hinge has the stiffness EI / h, at a clamp 2 EI / h.") \
  X(BEAM, AXIAL_STIFFNESS, "axial_stiffness", NUMBER, FORCE, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_beam, axial_stiffness), "EA of the beam.") \
  X(BEAM, PARTS, "parts", NUMBER, NONE, WHOLE(1, 10000), "10", OPTIONAL, 0, "", FIELD(strut_beam, parts), "Number of bars.") \
  X(BEAM, MASS, "mass", NUMBER, MASS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_beam, mass), "Mass of the whole beam.") \
  X(BEAM, DAMPING, "damping", NUMBER, TIME, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_beam, damping), "Ratio of damping to stiffness of the material (Kelvin-Voigt), of bars and hinges alike.") \
  X(BEAM, CLAMPED, "clamped", WORD, NONE, ANY, "none", OPTIONAL, 0, "none|start|end|both", FIELD(strut_beam, clamped), "Ends at which a fixed node holds the direction; they move with a node that `moves`.") \
  X(BEAM, CLAMPED_TO, "clamped_to", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(CLAMPED_TO), "Members and other beams to which its ends keep their drawn angle.")

#define STRUT_CLAMPED_TO_KEYS(X) \
  X(CLAMPED_TO, START, "start", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_beam, clamped_to[0]), "A bar, spring or beam that ends at the first node.") \
  X(CLAMPED_TO, END, "end", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_beam, clamped_to[1]), "A bar, spring or beam that ends at the second node.")

#define STRUT_OSCILLATOR_KEYS(X) \
  X(OSCILLATOR, FREQUENCY, "frequency", NUMBER, FREQUENCY, ANY, "", REQUIRED, 0, "", FIELD(strut_oscillator, frequency), "Natural frequency.") \
  X(OSCILLATOR, PHASE, "phase", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", FIELD(strut_oscillator, phase), "Phase at t = 0.") \
  X(OSCILLATOR, COUPLING, "coupling", THINGS, NONE, ANY, "", OPTIONAL, 0, "the strength K of the coupling to that oscillator [1/s]", FIELD(strut_oscillator, coupling), "Adds K sin(phase of the other - own phase - bias) to the rate of the phase.") \
  X(OSCILLATOR, BIAS, "bias", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", FIELD(strut_oscillator, bias), "Phase by which the others should be ahead.") \
  X(OSCILLATOR, FEEDBACK, "feedback", EXPRESSION, CONTEXT, ANY, "", OPTIONAL, 0, "", FIELD(strut_oscillator, feedback), "An expression, as of a signal, that is added to the rate of the phase.")

#define STRUT_CONTROLLER_KEYS(X) \
  X(CONTROLLER, SENSOR, "sensor", NAME, NONE, ANY, "", REQUIRED, 0, "", REFERENCE(strut_controller, sensor, SENSOR), "The controlled sensor, s.") \
  X(CONTROLLER, TARGET, "target", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_controller, target), "Desired value of the sensor. The error is e = target - s.") \
  X(CONTROLLER, GAIN, "gain", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_controller, gain), "The signal is gain * e + integral * (integral of e) - derivative * ds/dt.") \
  X(CONTROLLER, INTEGRAL, "integral", NUMBER, CONTEXT, ANY, "0", OPTIONAL, 0, "", FIELD(strut_controller, integral), "Gain of the integral of e, in the unit of `gain` per second.") \
  X(CONTROLLER, DERIVATIVE, "derivative", NUMBER, CONTEXT, ANY, "0", OPTIONAL, 0, "", FIELD(strut_controller, derivative), "Gain of -ds/dt, in the unit of `gain` times a second. If the signal drives a rest length, `every` is required.") \
  X(CONTROLLER, LEAST, "least", NUMBER, CONTEXT, ANY, "none", OPTIONAL, 0, "", CHOICE(strut_controller, limited[0], true, FIELD(strut_controller, limit[0])), "Lower limit of the signal.") \
  X(CONTROLLER, MOST, "most", NUMBER, CONTEXT, ANY, "none", OPTIONAL, 0, "", CHOICE(strut_controller, limited[1], true, FIELD(strut_controller, limit[1])), "Upper limit of the signal. At a limit the integral does not wind up.") \
  X(CONTROLLER, EVERY, "every", NUMBER, TIME, ABOVE_ZERO, "0", OPTIONAL, 0, "", FIELD(strut_controller, every), "Sampling interval; 0: the controller is continuous.") \
  X(CONTROLLER, KIND, "kind", WORD, NONE, ANY, "pid", OPTIONAL, 0, "pid|relay", NONE, "`relay`: the controller has the keys of a [relay](#relay).")

#define STRUT_PIPE_KEYS(X) \
  X(PIPE, CELLS, "cells", NAME_PAIR, NONE, ANY, "", REQUIRED, 0, "", REFERENCE(strut_pipe, cell, CELL), "The two cells, with isothermal gas.") \
  X(PIPE, CONDUCTANCE, "conductance", NUMBER, CONDUCTANCE, NOT_NEGATIVE, "", REQUIRED, 0, "", FIELD(strut_pipe, conductance), "C: the flow from the first cell to the second is C (p_a - p_b), measured as pressure times area per time. The energy it sets free counts as work of drives.")

#define STRUT_NETWORK_KEYS(X) \
  X(NETWORK, FILE, "network", TEXT, NONE, ANY, "", REQUIRED, 0, "", FIELD(strut_network, file), "File of weights, in the folder of the scene or below. Each line is a neuron: weights of the values of the layer before, then the bias, separated by commas. An empty line separates layers.") \
  X(NETWORK, INPUTS, "inputs", FREE, NONE, ANY, "", REQUIRED, 0, "a list of expressions without unit", FIELD(strut_network, inputs), "Inputs of the first layer, such as `[l/(1 mm), touch]`.") \
  X(NETWORK, OUTPUT, "output", NUMBER, NONE, WHOLE(1, 1000), "1", OPTIONAL, 0, "", FIELD(strut_network, output), "Number of the neuron of the last layer that is the signal.") \
  X(NETWORK, LAST, "last", WORD, NONE, ANY, "tanh", OPTIONAL, 0, "tanh|linear", FIELD(strut_network, last), "Activation of the last layer; the others use tanh.") \
  X(NETWORK, SCALE, "scale", NUMBER, CONTEXT, ANY, "1", OPTIONAL, 0, "", FIELD(strut_network, scale), "Factor and unit of the signal.") \
  X(NETWORK, EVERY, "every", NUMBER, TIME, ABOVE_ZERO, "0", OPTIONAL, 0, "", FIELD(strut_network, every), "Sampling interval; 0: the controller is continuous.")

#define STRUT_DATA_KEYS(X) \
  X(DATA, FILE, "file", TEXT, NONE, ANY, "", REQUIRED, 0, "", FIELD(strut_data_table, file), "A table as text, below the folder of this file: cells separated by commas, semicolons or tabs, with a point or, unless commas separate, a comma before decimals. Lines that begin with `#` are comments, empty cells gaps.") \
  X(DATA, HEADER, "header", NUMBER, NONE, WHOLE(1, 1000), "as the file shows", OPTIONAL, 0, "", FIELD(strut_data_table, header), "Number of lines above the first row, with the names on the last of them that has no units. A name that is there twice is preceded by what is above it, up to the next cell: `snout.x`.") \
  X(DATA, UNITS, "units", THINGS, NONE, ANY, "those in the header", OPTIONAL, 0, "a unit such as `mm`, or what one counts, such as `1/(240 Hz)`", NONE, "Units of columns, by their names or by what follows the last dot of these; `1`: none.") \
  X(DATA, FLIP, "flip", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|x|y|both", FIELD(strut_data_table, flip), "Changes the sign of coordinates, such as those of pixels, whose y points downwards. The order is always flip, scale, rotate, shift. Columns are coordinates if x and y alone tell their names apart, such as `n1.x` and `n1.y`, `x1` and `y1`.") \
  X(DATA, SCALE, "scale", NUMBER, CONTEXT, ABOVE_ZERO, "1", OPTIONAL, 0, "", UNIT(strut_data_table, scale, scale_unit), "Length of a pixel, such as `0.21 mm`, for coordinates without unit; or a factor of those that are lengths.") \
  X(DATA, ROTATE, "rotate", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", FIELD(strut_data_table, rotate), "Turns coordinates about the origin, counter-clockwise.") \
  X(DATA, SHIFT, "shift", PAIR, LENGTH, ANY, "[0, 0]", OPTIONAL, 0, "", FIELD(strut_data_table, shift), "Is added to coordinates.") \
  X(DATA, SKIP, "skip", NUMBER, NONE, WHOLE(0, 1000000000), "0", OPTIONAL, 0, "", FIELD(strut_data_table, skip), "Number of rows below the header that are left out.") \
  X(DATA, WEIGHTS, "weights", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_data_table, weights), "Column of the weights of rows, from 0 on; or what follows the last dot in names of such columns, of which each is for those with the same beginning: `likelihood` for `snout.x` and `snout.likelihood`.")

#define STRUT_ROW_KEYS(X) \
  X(ROW, IN_X, "x", TEXT, NONE, ANY, "", REQUIRED, 0, "", FIELD(strut_row_keys, column[0]), "Column of the position in x, such as `film.x1`.") \
  X(ROW, IN_Y, "y", TEXT, NONE, ANY, "", REQUIRED, 0, "", FIELD(strut_row_keys, column[1]), "Column of the position in y.") \
  X(ROW, ROW, "row", NUMBER, NONE, WHOLE(1, 1000000000), "1", OPTIONAL, 7, "", FIELD(strut_row_keys, row), "Number of the row, counted from 1.") \
  X(ROW, TIME, "time", NUMBER, TIME, ANY, "", OPTIONAL, 7, "", FIELD(strut_row_keys, time), "Instead of `row`: a time of the table, between whose rows positions are interpolated.")

#define STRUT_STUDY_KEYS(X) \
  X(STUDY, VERSION, "strut", VERSION, NONE, ANY, "", REQUIRED, 0, "1", NONE, "Version of the language.") \
  X(STUDY, NAME, "study", TEXT, NONE, ANY, "", REQUIRED, 0, "", FIELD(strut_study, name), "Name of the study.") \
  X(STUDY, DESCRIPTION, "description", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study, description), "Purpose of the study.") \
  X(STUDY, MODEL, "model", TEXT, NONE, ANY, "", REQUIRED, 0, "", FIELD(strut_study, model), "File of the model, in the folder of the study or below.") \
  X(STUDY, SET, "set", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression or a text", BY_HAND, "Values of the model's parameters at all points; `--set` takes precedence.") \
  X(STUDY, DATA, "data", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of [data](#data)", THINGS(DATA), "Tables of measured data, for the study itself.") \
  X(STUDY, AXES, "axes", AXES, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "The points are all combinations of the axes; the last varies fastest. An axis is `{NAME: [...]}`, `{NAME: {...}}` (a [range](#range)), `{zip: {NAME: ..., NAME: ...}}`, `{points: FILE}` ([points](#points)) or `{sample: {...}}` ([sample](#sample)). Required without `search` or `sensitivity`; with one of these, each point has its own.") \
  X(STUDY, DERIVE, "derive", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression", BY_HAND, "Parameters that follow from others at each point, such as `{step: 1/(1000*frequency)}`.") \
  X(STUDY, VARIANTS, "variants", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a [variant](#variant)", THINGS(VARIANT), "Variants of the model, for example with other numerics. They form the first axis, column `variant`.") \
  X(STUDY, SOLVER, "solver", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(SOLVER), "Keys that replace those of the model.") \
  X(STUDY, RUN, "run", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(RUN), "Keys that replace those of the model.") \
  X(STUDY, INITIAL, "initial", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(INITIAL), "Keys that replace those of the model.") \
  X(STUDY, OUTPUT, "output", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(OUTPUT), "Keys that replace those of the model.") \
  X(STUDY, KEEP, "keep", KEEP, NONE, ANY, "[velocity, velocity_spread, motion, periods, force_evaluations, outcome, quantities]", OPTIONAL, 0, STRUT_KEEP_WORD_LIST, BY_HAND, "Columns of the table. `distance` is per drive period; `work`, `losses`, `residual` belong to the energy balance; `cost_of_transport` is net drive work / (weight * distance); `expected_error` is relative, of slow motions to a thousandth of the size per period; `contacts` gives duty factors and heights; `equilibrium_count` includes saddles; `critical_factor` is the first loss of stability, `limit_factor` the first limit point; `quantities` are all measured ones, each also available by name; `NODE.y`, `MEMBER.force`, `energy.total` and other columns of the motion are those at the end of the run.") \
  X(STUDY, DERIVATIVES, "derivatives", NAMES, NONE, ANY, "as the model says", OPTIONAL, 0, "a parameter", NONE, "Parameters of the model, numbers: columns `COLUMN.d.PARAMETER` with the derivatives of what is kept by each of them, and `COLUMN.d.PARAMETER.error`. Both are empty where there is none. See [derivatives](numerics.md#derivatives).") \
  X(STUDY, TRAJECTORIES, "trajectories", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_study, trajectories), "Write the results of each run to a folder `runs/POINT`, as `strut run -o` does.") \
  X(STUDY, CHECK, "check", MAP, NONE, ANY, "", OPTIONAL, 0, "", SELF(strut_study, CHECK), "Repeats each point more accurately and marks the points whose outcome changes.") \
  X(STUDY, FIGURES, "figures", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a [figure](#figure)", THINGS(FIGURE), "Figures of the table or of the recorded motions, each written to NAME.svg.") \
  X(STUDY, COMPUTE, "compute", WORD, NONE, ANY, "run", OPTIONAL, 0, "run|equilibria|modes|rigidity|path|form", FIELD(strut_study, compute), "What is computed at each point: a run, or the results of the command of that name. By default the table keeps all columns of an analysis except `node_count`, `member_count`, `degrees_of_freedom`, `total_mass`, `lowest_barrier`, `lengths`, `positions`, `stiffness`, `shape_distance` and `curve_distance`.") \
  X(STUDY, LOWEST, "lowest", NUMBER, NONE, WHOLE(1, 20), "3", OPTIONAL, 0, "", FIELD(strut_study, lowest), "Number of lowest `states`, `energies`, `barriers` (the lowest escape barrier of each state), `frequencies` and `damping_ratios` that a row lists. `lowest_barrier` is the lowest out of any stable state.") \
  X(STUDY, AT, "at", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study, at), "The equilibrium for modes, rigidity and path, as option `--at` of these commands.") \
  X(STUDY, PATH, "path", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(PATH), "What `compute: path` follows.") \
  X(STUDY, REFINE, "refine", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(REFINE), "Divides the cells of a map where a column changes, instead of computing a fine grid.") \
  X(STUDY, SENSITIVITY, "sensitivity", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(SENSITIVITY), "Computes how much each parameter contributes to each column: derivatives, and first-order and total indices from samples.") \
  X(STUDY, STIFFNESS_AT, "stiffness_at", MAP, NONE, ANY, "", OPTIONAL, 0, "", SELF(strut_study, STIFFNESS_AT), "With `compute: modes`: node and direction of the column `stiffness`.") \
  X(STUDY, SHAPE, "shape", THINGS, NONE, ANY, "", OPTIONAL, 0, "positions `[x, y]` of nodes", BY_HAND, "Positions of some or all nodes for the column `shape_distance`: the root mean square over nodes, after the best rigid motion, of the end of a run, the nearest stable state or the equilibrium of modes.") \
  X(STUDY, LIKE, "like", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study, goal.like), "A configuration of the model with positions, instead of `shape`.") \
  X(STUDY, CURVE, "curve", POINTS, CONTEXT, ANY, "", OPTIONAL, 0, "", LIST(strut_study, goal.curve, goal.curve_count), "With `compute: path` and `over: NODE.x` or `NODE.y`: displacements and forces `[[-1 mm, 2 N], ...]` for the column `curve_distance`, the root mean square of the force differences.") \
  X(STUDY, LIMIT, "limit", MAP, NONE, ANY, "", OPTIONAL, 0, "", SELF(strut_study, LIMIT), "Largest cost of a point. A point that needs more fails, and its row says so.") \
  X(STUDY, FORM, "form", MAP, NONE, ANY, "", OPTIONAL, 0, "", SELF(strut_study, FORM), "Settings of `compute: form`.") \
  X(STUDY, SEARCH, "search", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(SEARCH), "Searches for the parameters with the best value of a column, instead of computing a grid.") \
  X(STUDY, FOLLOW, "follow", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(FOLLOW), "Follows periodic motions, stable or not, over a parameter, as `strut path --periodic` does, instead of running the points.") \
  X(STUDY, FIT, "fit", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(FIT), "Finds the parameters with which the model matches measured numbers, and what these say of them.")

#define STRUT_RANGE_KEYS(X) \
  X(RANGE, FROM, "from", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_range_keys, from), "First value.") \
  X(RANGE, TO, "to", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_range_keys, to), "Last value, if a whole number of steps leads to it.") \
  X(RANGE, STEP, "step", NUMBER, CONTEXT, ANY, "", OPTIONAL, 4, "", FIELD(strut_range_keys, step), "Difference between successive values.") \
  X(RANGE, COUNT, "count", NUMBER, NONE, ABOVE_ZERO, "", OPTIONAL, 4, "", FIELD(strut_range_keys, count), "Number of values, including both ends.") \
  X(RANGE, SCALE, "scale", WORD, NONE, ANY, "linear", OPTIONAL, 0, "linear|log", FIELD(strut_range_keys, scale), "`log`: equal ratios instead of equal differences; needs `count`.")

#define STRUT_VARIANT_KEYS(X) \
  X(VARIANT, SOLVER, "solver", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(SOLVER), "Keys that replace those of the study and of the model.") \
  X(VARIANT, RUN, "run", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(RUN), "Keys that replace those of the study and of the model.") \
  X(VARIANT, INITIAL, "initial", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(INITIAL), "Keys that replace those of the study and of the model.") \
  X(VARIANT, OUTPUT, "output", MAP, NONE, ANY, "", OPTIONAL, 0, "", SECTION(OUTPUT), "Keys that replace those of the study and of the model.")

#define STRUT_CHECK_KEYS(X) \
  X(CHECK, HALF_STEP, "half_step", WORD, NONE, ANY, "no", OPTIONAL, 5, "no|yes", FIELD(strut_study, half_step), "Repeats with half the step, or with half the `accuracy` if the model gives one.") \
  X(CHECK, ACCURACY, "accuracy", NUMBER, NONE, SHARE(STRUT_MOST_ACCURACY), "", OPTIONAL, 5, "", FIELD(strut_study, check_accuracy), "Repeats with this accuracy.")

#define STRUT_FIGURE_KEYS(X) \
  X(FIGURE, KIND, "kind", WORD, NONE, ANY, "lines", OPTIONAL, 0, "lines|map|motion|period|snapshots|best|points|winner", FIELD(strut_study_figure, kind), "Of the table: `lines`, or a `map` whose colour shows a value. Of recorded motions, which need `trajectories: yes`: `motion` (lines), `period` and `snapshots` (a picture of each run, as by `strut run --draw`). Of a [search](#search): `best` (best objective over evaluations), `points` (over `x` and `y`) and `winner` (the best model beside the start).") \
  X(FIGURE, AT_X, "x", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, x), "Column on the x axis; required for lines, maps and motion. Lines over texts are bars. Columns of a motion: the axes, `node`, `time`, `elapsed` since the start of the record, `x`, `y`, and displacements `dx`, `dy` since then.") \
  X(FIGURE, AT_Y, "y", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, y), "Column on the y axis; required for lines, maps and motion.") \
  X(FIGURE, SERIES, "series", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, series), "Lines: the column with one line for each of its values.") \
  X(FIGURE, COLOR, "color", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, color), "Map: the column that colour shows; hatched where `flips` is 1.") \
  X(FIGURE, PANELS, "panels", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, panels), "The column with one panel for each of its values.") \
  X(FIGURE, BAND, "band", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, band), "Lines: `COLUMN=TEXT`, a grey band where the column has that text, halfway to the neighbouring points.") \
  X(FIGURE, ONLY, "only", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, only), "`COLUMN=TEXT`: draws only rows with that text in the column, such as `variant=coarse`.") \
  X(FIGURE, DIFFERENCE, "difference", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, difference), "A column with two texts. Lines show `y` of the second minus `y` of the first; maps the second, hatched where they differ; pictures the second, with the first dashed.") \
  X(FIGURE, FROM, "from", NUMBER, TIME, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, from), "Motion: start of the time range.") \
  X(FIGURE, TO, "to", NUMBER, TIME, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, to), "Motion: end of the time range.") \
  X(FIGURE, SCALE, "scale", PAIR, NONE, ANY, "[1, 1]", OPTIONAL, 0, "", FIELD(strut_study_figure, scale), "Period: magnification of the motion along x and y.") \
  X(FIGURE, TIMES, "times", TIMES, NONE, ANY, "six", OPTIONAL, 0, "", LIST(strut_study_figure, times, time_count), "Snapshots: instants to draw.") \
  X(FIGURE, TITLE, "title", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, title), "Title of the figure.") \
  X(FIGURE, LABELS, "labels", NAMES, NONE, ANY, "by the columns", OPTIONAL, 0, "a label", LIST(strut_study_figure, labels, label_count), "Lines, motion and best: what the legend calls the curves, in their order.") \
  X(FIGURE, X_LABEL, "x_label", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, x_label), "Lines, map and motion: label of the x axis, by default the column's name. The unit is added.") \
  X(FIGURE, Y_LABEL, "y_label", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, y_label), "Likewise for the y axis.") \
  X(FIGURE, X_LIMITS, "x_limits", PAIR, CONTEXT, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, x_limits), "Lines, map and motion: ends of the x axis, ascending, without unit in the column's SI unit.") \
  X(FIGURE, Y_LIMITS, "y_limits", PAIR, CONTEXT, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, y_limits), "Likewise for the y axis.") \
  X(FIGURE, COLORS, "colors", WORD, NONE, ANY, "auto", OPTIONAL, 0, "auto|sequential|diverging|grey", FIELD(strut_study_figure, colours), "Map: the colour scale of numbers.")

#define STRUT_PATH_KEYS(X) \
  X(PATH, LOAD, "load", TEXT, NONE, ANY, "all without a signal", OPTIONAL, 6, "", FIELD(strut_study, path.load), "The load to scale.") \
  X(PATH, OVER, "over", TEXT, NONE, ANY, "", OPTIONAL, 6, "", FIELD(strut_study, path.over), "Instead of a load: an actuator, or a displacement `NODE.x` or `NODE.y`.") \
  X(PATH, FROM, "from", NUMBER, CONTEXT, ANY, "0", OPTIONAL, 0, "", CHOICE(strut_study, path.from_given, true, FIELD(strut_study, path.from)), "Start value: a load factor, or in the unit of `over`.") \
  X(PATH, UNTIL, "until", NUMBER, CONTEXT, ANY, "load factor 1", OPTIONAL, 0, "", CHOICE(strut_study, path.until_given, true, FIELD(strut_study, path.until)), "End value, likewise. Required with `over`.") \
  X(PATH, STEPS, "steps", NUMBER, NONE, WHOLE(1, 1000000), "400", OPTIONAL, 0, "", FIELD(strut_study, path.steps), "Maximum number of steps.")

#define STRUT_FORM_KEYS(X) \
  X(FORM, FROM, "from", WORD, NONE, ANY, "scene", OPTIONAL, 0, "scene|densities|lengths|prestress", FIELD(strut_study, form.from), "What determines the shape; `scene`: as the model's keys say.") \
  X(FORM, LEAST_TENSION, "least_tension", NUMBER, FORCE, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_study, form.least_tension), "Lower bound on the tension of every cable.") \
  X(FORM, LEAST_DENSITY, "least_density", NUMBER, STIFFNESS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_study, form.least_density), "Lower bound on the force density of every cable.") \
  X(FORM, OBJECTIVE, "objective", WORD, NONE, ANY, "largest", OPTIONAL, 0, "largest|sum|squares", FIELD(strut_study, form.objective), "What the prestress minimises: the largest force, the sum of the forces (both as magnitudes), or the sum of squares of the cables' force densities.")

#define STRUT_POINTS_KEYS(X) \
  X(POINTS, FILE, "file", TEXT, NONE, ANY, "", REQUIRED, 0, "", FIELD(strut_points_keys, file), "A CSV file with a header, below the folder of the study. `NAME [UNIT]` is the heading of a parameter; without a unit, values are in SI.") \
  X(POINTS, COLUMNS, "columns", NAMES, NONE, ANY, "all but `point`, `status` and `message`", OPTIONAL, 0, "", FIELD(strut_points_keys, columns), "The columns to use; others are skipped.")

#define STRUT_SAMPLE_KEYS(X) \
  X(SAMPLE, COUNT, "count", NUMBER, NONE, WHOLE(1, 1000000), "", REQUIRED, 0, "", FIELD(strut_sample_keys, count), "Number of points.") \
  X(SAMPLE, SEED, "seed", NUMBER, NONE, WHOLE(1, 4294967295), "1", OPTIONAL, 0, "", FIELD(strut_sample_keys, seed), "Seed of the points; the same seed gives the same points.") \
  X(SAMPLE, SCHEME, "scheme", WORD, NONE, ANY, "sobol", OPTIONAL, 0, "sobol|lhs|random", FIELD(strut_sample_keys, scheme), "`sobol`: Sobol's sequence, shifted by the seed; `lhs`: Latin hypercube; `random`: independent points.") \
  X(SAMPLE, OVER, "over", THINGS, NONE, COUNT(1, STRUT_SAMPLE_MOST_NUMBERS), "", REQUIRED, 0, "a [distribution](#distribution)", THINGS(DISTRIBUTION), "The parameters and their distributions.") \
  X(SAMPLE, CORRELATION, "correlation", FREE, NONE, ANY, "", OPTIONAL, 0, "a list of rows of numbers", NONE, "Correlation of the parameters, in their order, such as `[[1, 0.5], [0.5, 1]]`: that of the normal numbers behind their distributions. Without it they are independent.")

#define STRUT_DISTRIBUTION_KEYS(X) \
  X(DISTRIBUTION, UNIFORM, "uniform", NUMBERS, CONTEXT, ANY, "", OPTIONAL, 10, "", CHOICE(strut_distribution, kind, STRUT_DISTRIBUTION_UNIFORM, NUMBERS(strut_distribution, number)), "`[LEAST, MOST]`.") \
  X(DISTRIBUTION, LOG_UNIFORM, "log_uniform", NUMBERS, CONTEXT, ANY, "", OPTIONAL, 10, "", CHOICE(strut_distribution, kind, STRUT_DISTRIBUTION_LOG_UNIFORM, NUMBERS(strut_distribution, number)), "`[LEAST, MOST]`, on one side of 0; the logarithm is uniform.") \
  X(DISTRIBUTION, NORMAL, "normal", NUMBERS, CONTEXT, ANY, "", OPTIONAL, 10, "", CHOICE(strut_distribution, kind, STRUT_DISTRIBUTION_NORMAL, NUMBERS(strut_distribution, number)), "`[MEAN, DEVIATION]`.") \
  X(DISTRIBUTION, LOGNORMAL, "lognormal", NUMBERS, CONTEXT, ANY, "", OPTIONAL, 10, "", CHOICE(strut_distribution, kind, STRUT_DISTRIBUTION_LOGNORMAL, NUMBERS(strut_distribution, number)), "`[MEDIAN, DEVIATION]`, the deviation that of the natural logarithm, without unit.") \
  X(DISTRIBUTION, TRIANGULAR, "triangular", NUMBERS, CONTEXT, ANY, "", OPTIONAL, 10, "", CHOICE(strut_distribution, kind, STRUT_DISTRIBUTION_TRIANGULAR, NUMBERS(strut_distribution, number)), "`[LEAST, MODE, MOST]`.")

#define STRUT_LIMIT_KEYS(X) \
  X(LIMIT, EVALUATIONS, "evaluations", NUMBER, NONE, WHOLE(1, 1000000000000000), "none", OPTIONAL, 0, "", FIELD(strut_study, limit.evaluations), "Force evaluations of each run, including its check. The same points fail on every machine.") \
  X(LIMIT, TIME, "time", NUMBER, TIME, ABOVE_ZERO, "none", OPTIONAL, 0, "", FIELD(strut_study, limit.time), "Elapsed time of a point. Which points fail depends on the machine and its load; `--retry` computes them again.")

#define STRUT_REFINE_KEYS(X) \
  X(REFINE, WHERE, "where", NAME, NONE, ANY, "", REQUIRED, 0, "", FIELD(strut_study, refine.where), "A column of the table, such as `outcome`. Cells whose points differ in it are divided; a failed point differs from all others.") \
  X(REFINE, DEPTH, "depth", NUMBER, NONE, WHOLE(1, 10), "", REQUIRED, 0, "", FIELD(strut_study, refine.depth), "Number of divisions: the finest cells are 2^depth times narrower than those of the axes.") \
  X(REFINE, BY, "by", NUMBER, NONE, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_study, refine.by), "Numbers count as different if they differ by more than this, in the SI unit of the column.") \
  X(REFINE, AXES, "axes", NAMES, NONE, ANY, "the axes with ranges", OPTIONAL, 0, "", BY_HAND, "The parameters of the two axes to divide.")

#define STRUT_SENSITIVITY_KEYS(X) \
  X(SENSITIVITY, OF, "of", NAMES, NONE, ANY, "", REQUIRED, 0, "a column of the table", LIST(strut_study_sensitivity, of, of_count), "Columns of the table: numbers, or texts such as `outcome`.") \
  X(SENSITIVITY, OVER, "over", THINGS, NONE, COUNT(1, STRUT_SENSITIVITY_MOST), "", REQUIRED, 0, "a [distribution](#distribution)", THINGS(DISTRIBUTION), "The parameters and their distributions.") \
  X(SENSITIVITY, SAMPLES, "samples", NUMBER, NONE, WHOLE(0, 100000), "256", OPTIONAL, 0, "", FIELD(strut_study_sensitivity, samples), "Base samples of Saltelli's design; n parameters need n + 2 points each. 0: derivatives only.") \
  X(SENSITIVITY, SEED, "seed", NUMBER, NONE, WHOLE(1, 4294967295), "1", OPTIONAL, 0, "", FIELD(strut_study_sensitivity, seed), "Seed of the points; the same seed gives the same points.") \
  X(SENSITIVITY, SCHEME, "scheme", WORD, NONE, ANY, "sobol", OPTIONAL, 0, "sobol|lhs|random", FIELD(strut_study_sensitivity, scheme), "As of a [sample](#sample).") \
  X(SENSITIVITY, DERIVATIVES, "derivatives", WORD, NONE, ANY, "yes", OPTIONAL, 0, "no|yes", FIELD(strut_study_sensitivity, derivatives), "[Derivatives](numerics.md#derivatives) at the medians, one further point.") \
  X(SENSITIVITY, THRESHOLD, "threshold", NUMBER, NONE, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_study_sensitivity, threshold), "Reports the shares of samples above it, within it in size, and below its negative, in the SI unit of the columns. 0: only the share above 0.")

#define STRUT_STIFFNESS_AT_KEYS(X) \
  X(STIFFNESS_AT, NODE, "node", NAME, NONE, ANY, "", REQUIRED, 0, "", FIELD(strut_study, goal.stiffness_node), "A node of the model.") \
  X(STIFFNESS_AT, DIRECTION, "direction", NUMBER, ANGLE, ANY, "", REQUIRED, 0, "", FIELD(strut_study, goal.stiffness_direction), "Angle from the x axis; 90 deg is upwards.")

#define STRUT_SCENE_PATH_KEYS(X) \
  X(SCENE_PATH, STAGES, "stages", FREE, NONE, ANY, "", OPTIONAL, 0, "a list of stages such as [{load: NAME}]", BY_HAND, "Stages in order; each starts at the end of the one before.") \
  X(SCENE_PATH, FRICTION, "friction", WORD, NONE, ANY, "none", OPTIONAL, 0, "none|kept", FIELD(strut_experiment, path_friction), "`kept`: contacts stick and slide along the path by static and kinetic friction. This holds for every path of the model.")

#define STRUT_STAGE_KEYS(X) \
  X(STAGE, LOAD, "load", FREE, NONE, ANY, "", OPTIONAL, 7, "the name of a load, or a list of them", BY_HAND, "The load, or loads, whose factor grows. Loads named by any stage begin with the factor 0; all others act from the start.") \
  X(STAGE, OVER, "over", TEXT, NONE, ANY, "", OPTIONAL, 7, "", FIELD(strut_path_stage, over), "Instead: an actuator, or a displacement `NODE.x` or `NODE.y`, which stays held afterwards.") \
  X(STAGE, RELEASE, "release", TEXT, NONE, ANY, "", OPTIONAL, 7, "", FIELD(strut_path_stage, release), "Instead: a held `NODE.x` or `NODE.y`, whose reaction is reduced to zero.") \
  X(STAGE, UNTIL, "until", NUMBER, CONTEXT, ANY, "load factor 1", OPTIONAL, 0, "", FIELD(strut_path_stage, until), "Value at the end of the stage: a load factor, or in the unit of `over`, where it is required.") \
  X(STAGE, HOLD, "hold", NAMES, NONE, ANY, "", OPTIONAL, 0, "", LIST(strut_path_stage, hold, hold_count), "Coordinates `[NODE.x, NODE.y, ...]` that stay fixed from the start of the stage.") \
  X(STAGE, STOP, "stop", FREE, NONE, ANY, "", OPTIONAL, 0, "`{NODE.x: LENGTH}`", BY_HAND, "Ends the stage when a node has moved this far in it.") \
  X(STAGE, STEPS, "steps", NUMBER, NONE, WHOLE(1, 1000000), "400", OPTIONAL, 0, "", FIELD(strut_path_stage, steps), "Maximum number of steps.")

#define STRUT_SEARCH_KEYS(X) \
  X(SEARCH, MAXIMISE, "maximise", FREE, NONE, ANY, "", OPTIONAL, 12, "an expression of columns, or a list of two", BY_HAND, "The goal to maximise: a column of the table, or an expression of columns such as `velocity/frequency`. With two, `[velocity, -cost_of_transport]`, the search finds the points that no other beats in both.") \
  X(SEARCH, MINIMISE, "minimise", FREE, NONE, ANY, "", OPTIONAL, 12, "an expression of columns, or a list of two", BY_HAND, "The goal to minimise, likewise: `abs(velocity - 10 mm/s)`.") \
  X(SEARCH, OVER, "over", THINGS, NONE, COUNT(1, STRUT_SEARCH_MOST_VARIABLES), "", REQUIRED, 0, "the keys of a [variable](#variable), or a list of choices", THINGS(VARIABLE), "The parameters to find.") \
  X(SEARCH, METHOD, "method", WORD, NONE, ANY, "multistart", OPTIONAL, 0, "multistart|crs2|direct|isres|cobyla|bobyqa|sbplx|neldermead|cma|nsga2|bfgs", FIELD(strut_study_search, method), "Global: `multistart` (even points, then `sbplx` from the best two that lie apart), `crs2` (controlled random search, then `sbplx`), `direct` (dividing rectangles, no seed), `isres` (evolution), `cma` (CMA-ES). Local, from a start: `cobyla`, `bobyqa`, `sbplx`, `neldermead`. Two goals always use `nsga2`. `bfgs` follows the derivatives of the goal by the variables from a start, and ends where they vanish; see [searches](search.md#what-can-be-asked-for).") \
  X(SEARCH, EVALUATIONS, "evaluations", NUMBER, NONE, WHOLE(1, 100000), "200", OPTIONAL, 0, "", FIELD(strut_study_search, evaluations), "Number of different points that each search may compute.") \
  X(SEARCH, STARTS, "starts", NUMBER, NONE, WHOLE(1, 1000), "1", OPTIONAL, 0, "", FIELD(strut_study_search, starts), "Number of searches side by side. The first begins at `start`, the others elsewhere.") \
  X(SEARCH, SEED, "seed", NUMBER, NONE, WHOLE(1, 4294960000), "1", OPTIONAL, 0, "", FIELD(strut_study_search, seed), "Seed of the first search; the next search has the next seed. The same seed gives the same points.") \
  X(SEARCH, SUBJECT_TO, "subject_to", NAMES, NONE, COUNT(0, STRUT_SEARCH_MOST_CONDITIONS), "", OPTIONAL, 0, "", BY_HAND, "Conditions on the best point, such as `work < 2 mJ` or `outcome = I`: `<`, `<=`, `>`, `>=` between expressions of columns, `=` and `!=` between a column of texts and a word.") \
  X(SEARCH, WORST_OVER, "worst_over", THINGS, NONE, ANY, "", OPTIONAL, 0, "a list of values, or the keys of a [range](#range)", BY_HAND, "Scenarios: each evaluation computes all combinations of these values, of which the worst counts. `subject_to` must hold in all.")

#define STRUT_VARIABLE_KEYS(X) \
  X(VARIABLE, FROM, "from", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_search_variable, from), "Lower bound.") \
  X(VARIABLE, TO, "to", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_search_variable, to), "Upper bound.") \
  X(VARIABLE, START, "start", NUMBER, CONTEXT, ANY, "the middle", OPTIONAL, 0, "", FIELD(strut_search_variable, start), "Where the first search begins.") \
  X(VARIABLE, SCALE, "scale", WORD, NONE, ANY, "linear", OPTIONAL, 0, "linear|log", FIELD(strut_search_variable, logarithmic), "`log`: the search works with the logarithm.") \
  X(VARIABLE, WRAPS, "wraps", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_search_variable, wraps), "`yes`: both bounds are the same point, such as 0 deg and 360 deg of a phase.") \
  X(VARIABLE, INTEGER, "integer", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_search_variable, integer), "`yes`: whole numbers only, in the SI unit.")

#define STRUT_FIT_KEYS(X) \
  X(FIT, OVER, "over", THINGS, NONE, COUNT(1, STRUT_FIT_MOST_VARIABLES), "", REQUIRED, 0, "the keys of a [variable](#variable)", THINGS(VARIABLE), "The parameters to find, by their ranges; the first start is at `start`.") \
  X(FIT, MATCH, "match", THINGS, NONE, COUNT(1, STRUT_FIT_MOST_MATCHES), "", REQUIRED, 0, "the keys of a [match](#match), and what is compared", THINGS(MATCH), "Sets of measured numbers, all of which count together.") \
  X(FIT, STARTS, "starts", NUMBER, NONE, WHOLE(1, 1000), "8", OPTIONAL, 0, "", FIELD(strut_study_fit, starts), "Number of fits from different starts; all but the first begin anywhere in the ranges.") \
  X(FIT, SEED, "seed", NUMBER, NONE, WHOLE(1, 4294967295), "1", OPTIONAL, 0, "", FIELD(strut_study_fit, seed), "Seed of the starts; the same seed gives the same starts.")

#define STRUT_MATCH_KEYS(X) \
  X(MATCH, TIME, "time", NAME, NONE, ANY, "", OPTIONAL, 13, "", NONE, "Column of the times of a motion. 0 is where the run starts.") \
  X(MATCH, DISPLACEMENT, "displacement", NAME, NONE, ANY, "", OPTIONAL, 13, "", NONE, "Column of the displacements of a `path` over a coordinate, as `path` of the study says.") \
  X(MATCH, FORCE, "force", NAME, NONE, ANY, "", OPTIONAL, 0, "", NONE, "Column of the forces at these displacements.") \
  X(MATCH, COMPUTE, "compute", WORD, NONE, ANY, "", OPTIONAL, 13, "run|equilibria|modes|rigidity|path|form", FIELD(strut_fit_match, compute), "What is compared are columns of the table of a study that computes this: `frequency_1: 12.5 Hz`.") \
  X(MATCH, NOISE, "noise", NUMBER, CONTEXT, ANY, "not known", OPTIONAL, 0, "", NONE, "Standard deviation of the numbers. Without it, it follows from the residuals, which then cannot tell whether the model is right.") \
  X(MATCH, ALIGN, "align", MAP, NONE, ANY, "", OPTIONAL, 0, "", SELF(strut_fit_match, ALIGN), "What else may move the model onto the numbers.") \
  X(MATCH, SET, "set", THINGS, NONE, ANY, "", OPTIONAL, 0, "a value", NONE, "Values of other parameters in this match, such as the drive of a film. What one match sets, all must set.")

#define STRUT_ALIGN_KEYS(X) \
  X(ALIGN, SHIFT, "shift", WORD, NONE, ANY, "fixed", OPTIONAL, 0, "fixed|free", FIELD(strut_fit_match, align.shift), "`free`: coordinates may be shifted.") \
  X(ALIGN, ROTATE, "rotate", WORD, NONE, ANY, "fixed", OPTIONAL, 0, "fixed|free", FIELD(strut_fit_match, align.rotate), "`free`: coordinates may be rotated about the origin.") \
  X(ALIGN, DELAY, "delay", WORD, NONE, ANY, "fixed", OPTIONAL, 0, "fixed|free", FIELD(strut_fit_match, align.delay), "`free`: times may be later than those of the run by the same time.")

#define STRUT_FOLLOW_KEYS(X) \
  X(FOLLOW, OVER, "over", NAME, NONE, ANY, "", REQUIRED, 0, "", LATER(FIELD(strut_study_follow, over)), "The parameter that varies.") \
  X(FOLLOW, FROM, "from", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_study_follow, from), "Lower end of its range.") \
  X(FOLLOW, TO, "to", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_study_follow, to), "Upper end of its range.") \
  X(FOLLOW, AT, "at", NUMBERS, CONTEXT, COUNT(1, STRUT_STUDY_FOLLOW_MOST_AT), "the model's own value, or the middle", OPTIONAL, 0, "", LIST(strut_study_follow, at, at_count), "Values at which runs find the first motions.") \
  X(FOLLOW, START_FROM, "start_from", NAMES, NONE, COUNT(1, STRUT_STUDY_FOLLOW_MOST_FROM), "as the model says", OPTIONAL, 0, "a configuration", LIST(strut_study_follow, start_from, start_count), "Configurations in whose equilibria these runs start.") \
  X(FOLLOW, ACCURACY, "accuracy", NUMBER, NONE, SHARE(STRUT_FOLLOW_MOST_ACCURACY), STRUT_TEXT_OF(STRUT_FOLLOW_USUAL_PERCENT) " %", OPTIONAL, 0, "", FIELD(strut_study_follow, accuracy), "Relative error of velocities.") \
  X(FOLLOW, INTEGRATOR, "integrator", WORD, NONE, ANY, "`rk4-events`, or `adaptive` where that cannot", OPTIONAL, 0, STRUT_INTEGRATOR_WORDS, FIELD(strut_study_follow, integrator), "Integration method; it must locate events if there are contacts or cables.") \
  X(FOLLOW, STEPS, "steps", NUMBER, NONE, WHOLE(1, 100000), STRUT_TEXT_OF(STRUT_FOLLOW_USUAL_STEPS), OPTIONAL, 0, "", FIELD(strut_study_follow, steps), "Maximum number of steps of a branch in each direction.") \
  X(FOLLOW, BASINS, "basins", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_study_follow, basins), "Kicks the stable motions at the values of `at`, to find how far they may be pushed.")

/**
 * Keys that go together, X(section, given, rule, keys, message): where a mapping has one of the keys `given`, or in any
 * case if that is "", it
 *   NEEDS   one of the alternatives, each a key or several joined by +. Reported at the thing's name;
 *   ONLY    likewise, and no other of all these keys;
 *   WANTS   likewise, reported at the key that is given;
 *   FORBIDS each of the keys, where it stands.
 * In a message %o is who the mapping belongs to, %k the key that must not be there, %g the key that is given, and %v its
 * value.
 */
#define STRUT_KEY_RULES(X) \
  X(COLLISION, "nodes|members|between", FORBIDS, "node", "%o names a node beside a pair, expected 'node' and 'member', or 'nodes' with two nodes, or 'members' with two members, or 'between'") \
  X(COLLISION, "", NEEDS, "nodes|members|between|node+member", "%o does not name two things, expected 'node' and 'member', or 'nodes' with two nodes, or 'members' with two members, or 'between'") \
  X(DISTANCE, "", ONLY, "nodes+along|node+line", "%o must have 'nodes' and 'along', or 'node' and 'line'") \
  X(CELL, "pressure|gas", FORBIDS, "stiffness|law|damping|rest_area", "%o gives '%k' beside '%g'; a cell is elastic, or has a pressure, or a gas") \
  X(CELL, "", NEEDS, "pressure|gas|stiffness|law|damping|rest_area", "%o lacks 'pressure', expected a pressure such as '500 N/m', or 'gas', or the 'stiffness' of its area") \
  X(LAW, "data", NEEDS, "over", "%o lacks 'over', expected the column of x, such as tensile.x") \
  X(ACTUATOR, "", NEEDS, "member|hinge|cell", "%o lacks 'member', expected the name of a member, or 'hinge' with the name of a hinge") \
  X(ACTUATOR, "", NEEDS, "signal|force|moment", "%o lacks 'signal', expected a signal such as {sine: {amplitude: 1 mm, frequency: 10 Hz}}, or a signal's name; or 'force' or 'moment' instead") \
  X(ACTUATOR, "cell", FORBIDS, "force|moment", "%o gives a '%k' to a cell, whose pressure a 'signal' drives") \
  X(ACTUATOR, "hinge", FORBIDS, "force", "%o gives a 'force' to a hinge, which takes a 'moment'") \
  X(ACTUATOR, "member", FORBIDS, "moment", "%o gives a 'moment' to a member, which takes a 'force'") \
  X(LOAD, "", NEEDS, "node|hinge|member", "%o lacks 'node', expected the name of a node, or 'hinge' or 'member' for a moment") \
  X(LOAD, "hinge|member", FORBIDS, "force", "%o gives a 'force' to a hinge or member, which takes a 'moment'") \
  X(LOAD, "hinge|member", NEEDS, "moment|force", "%o lacks 'moment', expected a moment such as '2 N m'") \
  X(LOAD, "node", FORBIDS, "moment", "%o gives a 'moment' to a node, which takes a 'force'") \
  X(LOAD, "node", NEEDS, "force|moment", "%o lacks 'force', expected two numbers such as [10 N, 0]") \
  X(UNBALANCE, "", NEEDS, "speed|angle", "%o lacks 'speed', expected one such as '30 Hz', or 'angle' with a signal") \
  X(GROUND, "profile|circle", FORBIDS, "height|slope|through|normal", "%o is a %g, so it has no '%k'") \
  X(FRICTION, "mu_static|mu_kinetic", FORBIDS, "mu", "%o gives both 'mu' and '%g', expected 'mu', or 'mu_static' and 'mu_kinetic'") \
  X(FRICTION, "mu_static|mu_kinetic", FORBIDS, "mu_forward", "%o gives both 'mu_forward' and '%g', expected 'mu', or 'mu_forward' and 'mu_backward'") \
  X(FRICTION, "mu_forward", FORBIDS, "mu", "%o gives both 'mu' and 'mu_forward', expected 'mu', or 'mu_forward' and 'mu_backward'") \
  X(SIGNAL, "", NEEDS, "constant|sine|half_sine|square|ramp|table|sum|expression|data", "expected a kind of signal for %o") \
  X(STARTS, "", NEEDS, "contact|sensor", "%o names no event; write {contact: NODE}, or {sensor: NAME, above: LEVEL}") \
  X(STARTS, "sensor", NEEDS, "above|below|contact", "%o needs a level, 'above' or 'below', of its sensor") \
  X(STARTS, "contact", FORBIDS, "above|below", "%o gives a level, which only a sensor passes") \
  X(RELAY, "", ONLY, "on_above+off_below|on_below+off_above", "%o needs two thresholds: on_above with off_below, or on_below with off_above") \
  X(SENSOR, "", NEEDS, "length|force|angle|contact|position|velocity|energy|area|pressure|distance|contact_force|collision_force|of", "%o senses nothing; write one of length, force, angle, contact, position, velocity, energy, area, pressure, distance, contact_force and collision_force, such as {length: MEMBER}, or any column: {of: com.vy}") \
  X(SENSOR, "position|velocity", NEEDS, "along", "%o needs 'along': x or y") \
  X(INITIAL, "equilibrium", FORBIDS, "configuration|positions|settle", "%o gives both 'equilibrium' and '%k', expected one of them") \
  X(RUN, "periods", NEEDS, "of", "%o lacks 'of', expected the actuator, load or signal whose periods count") \
  X(SCENE_PATH, "", NEEDS, "stages|friction", "%o lacks 'stages', expected a list of stages such as [{load: NAME}]") \
  X(STAGE, "", NEEDS, "load|over|release", "%o lacks 'load', 'over' or 'release'") \
  X(STAGE, "over", WANTS, "until", "%o lacks 'until', the end value of '%v'") \
  X(STAGE, "release", FORBIDS, "until", "%o gives 'until' beside 'release', which ends without reaction") \
  X(STUDY, "", NEEDS, "axes|sensitivity|search|follow|fit", "%o lacks 'axes', expected a list of axes such as [{friction: [0.1, 0.2]}]") \
  X(STUDY, "shape", FORBIDS, "like", "'shape' and 'like' of %o exclude each other") \
  X(STUDY, "search", FORBIDS, "refine", "a study that searches has no grid to refine") \
  X(STUDY, "sensitivity", FORBIDS, "refine|trajectories|search", "'%k' and '%g' exclude each other: use two studies") \
  X(STUDY, "follow", FORBIDS, "refine|trajectories|search|sensitivity|keep|check|limit|shape|like", "'%k' and '%g' exclude each other: use two studies") \
  X(STUDY, "fit", FORBIDS, "axes|variants|refine|search|follow|sensitivity|trajectories|check|keep|compute", "'%k' and '%g' exclude each other: use two studies") \
  X(RANGE, "", NEEDS, "step|count", "the range of %o lacks 'step' or 'count'") \
  X(DISTRIBUTION, "", NEEDS, "uniform|log_uniform|normal|lognormal|triangular", "expected a distribution such as {uniform: [1, 2]} for %o") \
  X(PATH, "over", NEEDS, "until", "%o lacks 'until', the end value of '%v'") \
  X(SEARCH, "", NEEDS, "maximise|minimise", "%o lacks 'maximise' or 'minimise', a column of the table or an expression of columns") \
  X(MATCH, "displacement|compute", FORBIDS, "align", "'align' of %o is for motions and shapes") \
  X(MATCH, "displacement", NEEDS, "force", "%o of a displacement lacks 'force'")

/** The sections: X(NAME, name, its rows, the text above their table in the reference). */
#define STRUT_SECTIONS(X) \
  X(SCENE, "scene", STRUT_SCENE_FIELDS, "The keys at the top level of a model.") \
  X(PART, "part", STRUT_PART_KEYS, "`parts: {NAME: {...}}`: a piece of structure, which `place` copies. It sees the scene's parameters, groups and signals, but only its own nodes.") \
  X(PLACE, "place", STRUT_PLACE_KEYS, "`place: {NAME: {...}}`: one or several copies of a part, with names such as `NAME.node` or `NAME.3.node`.") \
  X(REPEAT, "repeat", STRUT_REPEAT_KEYS, "`repeat: {...}` of a placement. Copy k results from copy 0 by k motions, each a scaling and rotation about `about`, then a displacement by `step` in its own frame.") \
  X(NEXT, "next", STRUT_NEXT_KEYS, "`next: {...}` of `repeat`: what a copy shares with the next one. Names are those of the copy; `next.NAME` belongs to the next copy.") \
  X(NODE, "node", STRUT_NODE_FIELDS, "`nodes: {NAME: [x, y]}`, or `nodes: {NAME: {position: [x, y], ...}}` with these keys.") \
  X(MOVES, "moves", STRUT_MOVES_FIELDS, "`nodes: {NAME: {moves: {...}}}`: the node's position is the drawn one plus the signal, which must not jump. Statics and settling keep it where it is at t = 0.") \
  X(MEMBER, "member", STRUT_MEMBER_FIELDS, "`members: {NAME: {...}}`. A member needs a stiffness, a damping, or both. An own rest length, in whichever of its four keys, replaces that of the group; so does an own stiffness.") \
  X(HINGE, "hinge", STRUT_HINGE_FIELDS, "`hinges: {NAME: {...}}`. A hinge needs a stiffness, a damping, or a law that brings its own stiffness.") \
  X(CELL, "cell", STRUT_CELL_FIELDS, "`cells: {NAME: {...}}` with `pressure`, `gas` or `stiffness`. In the plane a pressure is a force per length.") \
  X(GAS, "gas", STRUT_GAS_FIELDS, "`cells: {NAME: {gas: {...}}}`.") \
  X(COLLISION, "collision", STRUT_COLLISION_FIELDS, "`collisions: {NAME: {...}}` with `node` and `member`, `nodes`, `members`, or `between`. Things pass through each other unless a collision names them.") \
  X(DISTANCE, "distance", STRUT_DISTANCE_FIELDS, "`distances: {NAME: {...}}` with `nodes` and `along`, or `node` and `line`. A distance needs a stiffness, a damping, or a law that brings its own stiffness.") \
  X(FOOT, "foot", STRUT_FOOT_FIELDS, "`feet: {NAME: {member, node, radius}}`: a circular arc at the end of a member, which rolls on straight grounds at rest. Friction acts at the point of contact, with its moment on the member. Karnopp's law becomes smooth within its stick band, so that a loaded foot creeps. Statics ignore the friction.") \
  X(BEAM, "beam", STRUT_BEAM_KEYS, "`beams: {NAME: {...}}`. A beam is short for nodes `NAME.1`, `NAME.2`, ... between its ends, bars `NAME.1`, ..., and hinges `NAME.1`, ... at these nodes; at a clamp also for a fixed node and the hinge `NAME.start` or `NAME.end`. `strut export` writes these.") \
  X(CLAMPED_TO, "clamped_to", STRUT_CLAMPED_TO_KEYS, "`clamped_to: {start: NAME, end: NAME}` of a beam: the end keeps its drawn angle to a member or to another beam that has the node, too, by the hinge `NAME.start` or `NAME.end`. Several beams at one node also get hinges between each other, such as `NAME.start.OTHER`.") \
  X(LAW, "law", STRUT_LAW_FIELDS, "`law: {...}` of a member, a hinge or a distance, or only its kind, such as `law: logarithmic`; `law: tension_only` and `law: compression_only` are linear and carry one sign. For a hinge read angle for length and moment for force. `polynomial`, `table` and `curve` bring their own stiffness, so that the member must not give one.") \
  X(RAYLEIGH, "rayleigh", STRUT_RAYLEIGH_FIELDS, "`rayleigh: {...}`: adds the damping ratio alpha / (2 w) + beta w / 2 to a mode of angular frequency w.") \
  X(GROUND, "ground", STRUT_GROUND_FIELDS, "`ground: {...}`: the line, profile or circle that nodes may touch; or several, `grounds: {NAME: {...}}`.") \
  X(CIRCLE, "circle", STRUT_CIRCLE_FIELDS, "`circle: {...}` of a ground.") \
  X(MOTION, "motion", STRUT_MOTION_FIELDS, "`motion: {x: SIGNAL, y: SIGNAL}` of a ground: its displacement, which must not jump. The energy balance includes its work on the structure.") \
  X(FRICTION, "friction", STRUT_FRICTION_FIELDS, "`friction: {...}` of the ground, a group or a contact. A contact's keys override those of its groups, and these those of the ground. Every law needs `mu`, or `mu_static` and `mu_kinetic`; for `smooth` `mu_kinetic` is enough. If friction depends on the direction, `mu_forward` and `mu_backward` replace `mu`.") \
  X(CONTACT, "contact", STRUT_CONTACT_FIELDS, "`ground: {contacts: {NODE: {...}}}`: settings of a single contact.") \
  X(ACTUATOR, "actuator", STRUT_ACTUATOR_FIELDS, "`actuators: {NAME: {...}}` with a `signal`, a `force` of a member or a `moment` of a hinge.") \
  X(LOAD, "load", STRUT_LOAD_FIELDS, "`loads: {NAME: {...}}`.") \
  X(UNBALANCE, "unbalance", STRUT_UNBALANCE_FIELDS, "`unbalances: {NAME: {...}}` with a `speed` or an `angle`. An unbalance exerts m r w^2 outwards, plus the effect of a changing speed. In statics and settling its mass is at the node.") \
  X(SLIDER, "slider", STRUT_SLIDER_FIELDS, "`sliders: {NAME: {...}}`. In statics and settling a slider stays where it is at t = 0.") \
  X(SIGNAL, "signal", STRUT_SIGNAL_FIELDS, "A signal is a mapping with one of these keys, or the name of an entry of `signals`. Its use determines its unit: a length, angle, pressure, force or moment for an actuator, a length for the motion of a ground or node, no unit for a load.") \
  X(SINE, "sine", STRUT_SINE_FIELDS, "`{sine: {...}}`.") \
  X(HALF_SINE, "half_sine", STRUT_HALF_SINE_FIELDS, "`{half_sine: {...}}`: a single pulse.") \
  X(SQUARE, "square", STRUT_SQUARE_FIELDS, "`{square: {...}}`.") \
  X(RAMP, "ramp", STRUT_RAMP_FIELDS, "`{ramp: {...}}`.") \
  X(SENSOR, "sensor", STRUT_SENSOR_FIELDS, "`sensors: {NAME: {...}}` with one of these keys. Expressions of signals and measured quantities use the name. In an expression, `rate(NAME)` is the rate of a length, angle, position, area or distance.") \
  X(STATE, "state", STRUT_STATE_FIELDS, "`states: {NAME: {...}}`.") \
  X(OSCILLATOR, "oscillator", STRUT_OSCILLATOR_KEYS, "`oscillators: {NAME: {...}}`. In expressions the name is the phase, an angle: `2 mm * sin(NAME)`. `strut export` writes oscillators as states.") \
  X(CONTROLLER, "controller", STRUT_CONTROLLER_KEYS, "`controllers: {NAME: {...}}`. The integral is the state `NAME_integral`. `strut export` writes PID controllers as signals and states.") \
  X(RELAY, "relay", STRUT_RELAY_FIELDS, "`controllers: {NAME: {kind: relay, ...}}`: a signal with two values, with `on_above` and `off_below`, or `on_below` and `off_above`.") \
  X(PIPE, "pipe", STRUT_PIPE_KEYS, "`pipes: {NAME: {cells: [a, b], conductance}}`: gas that flows between two cells. The name is a state: the amount that has flowed, pressure times area. `strut export` writes a pipe as sensors, signals and actuators.") \
  X(NETWORK, "network", STRUT_NETWORK_KEYS, "`controllers: {NAME: {network: FILE, ...}}`: a signal from a neural network. `strut export` writes its neurons as signals `NAME_1_1` and so on.") \
  X(RUBBING, "friction of a collision", STRUT_RUBBING_FIELDS, "`collisions: {NAME: {friction: {...}}}`: friction of two bodies in contact, smooth in the speed, so that loaded contacts creep. It acts on nodes and axes, without a moment due to the thickness.") \
  X(MAXWELL, "maxwell", STRUT_MAXWELL_FIELDS, "`members: {NAME: {maxwell: {...}}}`: the force of the branch follows F' = k (u' - F/c), with the elongation u. In statics it is 0.") \
  X(STARTS, "starts", STRUT_STARTS_FIELDS, "`{sine: {...}, starts: {...}}` of any signal: begins its time at the touchdown of a node, which methods with events locate, or when a sensor passes a level.") \
  X(CONFIGURATION, "configuration", STRUT_CONFIGURATION_FIELDS, "`configurations: {NAME: {NODE: [x, y], ...}}`, or `configurations: {NAME: {...}}` with these keys. `{}` is the drawn shape. If a node is called `contacts`, write contacts as a list of lists; if one is called `shape`, a mapping under that key is the shape.") \
  X(INITIAL, "initial", STRUT_INITIAL_FIELDS, "`initial: {...}`.") \
  X(SETTLE, "settle", STRUT_SETTLE_FIELDS, "`initial: {settle: {...}}`.") \
  X(EQUILIBRIA, "equilibria", STRUT_EQUILIBRIA_FIELDS, "`equilibria: {...}`: the search of `strut equilibria` and of `initial: {equilibrium: NAME}`.") \
  X(SCENE_PATH, "path in stages", STRUT_SCENE_PATH_KEYS, "`path: {stages: [{...}, ...]}` of a model. [Stages](statics.md#stages) has an example.") \
  X(STAGE, "stage", STRUT_STAGE_KEYS, "`path: {stages: [{...}]}`, each with one of `load`, `over`, `release`.") \
  X(SOLVER, "solver", STRUT_SOLVER_FIELDS, "`solver: {...}`.") \
  X(RUN, "run", STRUT_RUN_FIELDS, "`run: {...}`: either `duration`, or `periods` and `of`.") \
  X(MEASURE, "measure", STRUT_MEASURE_FIELDS, "`run: {measure: {...}}`.") \
  X(QUANTITY, "quantity", STRUT_QUANTITY_FIELDS, "`run: {measure: {quantities: {NAME: {...}}}}`.") \
  X(STEADY, "steady", STRUT_STEADY_FIELDS, "`run: {measure: {steady: {...}}}`.") \
  X(OUTPUT, "output", STRUT_OUTPUT_FIELDS, "`output: {...}`.") \
  X(DATA, "data", STRUT_DATA_KEYS, "`data: {NAME: {file: FILE, ...}}` of a scene or a study. `NAME.COLUMN` is a column; its unit stands in the header, `x [mm]` or `Force (N)`, on a line below it, or under `units`. [Measured data](language.md#measured-data) has examples. Parameters are not known here: a file is read once for all points of a study.") \
  X(ROW, "row of data", STRUT_ROW_KEYS, "`{NODE: {x: film.x1, y: film.y1, row: 1}}` in place of `[x, y]` of a [configuration](#configuration) or an initial position.") \
  X(STUDY, "study", STRUT_STUDY_KEYS, "The keys at the top level of a study, a file for `strut sweep`. Expressions in `set` and `derive` may use the model's parameters.") \
  X(RANGE, "range", STRUT_RANGE_KEYS, "`axes: [{NAME: {...}}]`: values of a parameter, by `step` or `count`.") \
  X(VARIANT, "variant", STRUT_VARIANT_KEYS, "`variants: {NAME: {...}}` of a study.") \
  X(CHECK, "check", STRUT_CHECK_KEYS, "`check: {...}` of a study.") \
  X(FIGURE, "figure", STRUT_FIGURE_KEYS, "`figures: {NAME: {...}}` of a study.") \
  X(PATH, "path", STRUT_PATH_KEYS, "`path: {...}` of a study with `compute: path`, as the options of `strut path`.") \
  X(FORM, "form", STRUT_FORM_KEYS, "`form: {...}` of a study with `compute: form`, as the options of `strut form` (`from` is `--given`).") \
  X(POINTS, "points", STRUT_POINTS_KEYS, "`axes: [{points: {...}}]` of a study, or short `{points: FILE}`.") \
  X(SAMPLE, "sample", STRUT_SAMPLE_KEYS, "`axes: [{sample: {...}}]` of a study: parameters from distributions.") \
  X(DISTRIBUTION, "distribution", STRUT_DISTRIBUTION_KEYS, "`over: {NAME: {...}}` of a sample or a sensitivity analysis, with one of these keys.") \
  X(LIMIT, "limit", STRUT_LIMIT_KEYS, "`limit: {...}` of a study.") \
  X(REFINE, "refine", STRUT_REFINE_KEYS, "`refine: {...}` of a study.") \
  X(SENSITIVITY, "sensitivity", STRUT_SENSITIVITY_KEYS, "`sensitivity: {...}` of a study. The results are in `sensitivity.csv` beside the table.") \
  X(STIFFNESS_AT, "stiffness_at", STRUT_STIFFNESS_AT_KEYS, "`stiffness_at: {...}` of a study.") \
  X(SEARCH, "search", STRUT_SEARCH_KEYS, "`search: {...}` of a study, with `maximise` or `minimise`. [Searches](search.md) has examples.") \
  X(VARIABLE, "variable", STRUT_VARIABLE_KEYS, "`over: {NAME: {...}}` of a search. `{NAME: [...]}` is a list of choices, numbers or texts.") \
  X(FOLLOW, "follow", STRUT_FOLLOW_KEYS, "`follow: {...}` of a study, as the options of `strut path --periodic`. [Branches of motions](follow.md#studies-of-branches) has an example.") \
  X(FIT, "fit", STRUT_FIT_KEYS, "`fit: {...}` of a study. [From a film to a model](fit.md) has an example.") \
  X(MATCH, "match", STRUT_MATCH_KEYS, "`match: {NAME: {...}}` of a fit: with `time`, a motion; with `displacement`, a curve of a path; with `compute`, columns of a table; otherwise a shape, where the run starts. The other keys are what the model has, such as `n1.x` or `m3.force`, and their values columns of `data`, or numbers.") \
  X(ALIGN, "align", STRUT_ALIGN_KEYS, "`align: {...}` of a match.")
/* clang-format on */
