/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The table of the language: one row for each key. keys.h says what is made of it.
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
  X(SCENE, NAME, "name", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_scene, name), "What the scene is called.") \
  X(SCENE, DESCRIPTION, "description", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_scene, description), "What it shows.") \
  X(SCENE, SOURCE, "source", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_scene, source), "Where its numbers come from.") \
  X(SCENE, PARAMETERS, "parameters", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression or a quoted text", BY_HAND, "Named values that expressions may use and `--set` may change.") \
  X(SCENE, GROUPS, "groups", THINGS, NONE, ANY, "", OPTIONAL, 0, "keys of a member, a node or a contact", BY_HAND, "Defaults that members, nodes and contacts share. Own keys win.") \
  X(SCENE, NODES, "nodes", THINGS, NONE, ANY, "", REQUIRED, 0, "`[x, y]` or the keys of a node", BY_HAND, "The points of the structure.") \
  X(SCENE, MEMBERS, "members", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a member", BY_HAND, "What joins the nodes.") \
  X(SCENE, MASS_MODEL, "mass_model", WORD, NONE, ANY, "consistent", WRITTEN, 0, "consistent|lumped", FIELD(strut_scene, mass_model), "How a member's mass acts: as of a uniform rod (the paper's), or half at each end.") \
  X(SCENE, BARS, "bars", WORD, NONE, ANY, "elastic", OPTIONAL, 0, "elastic|rigid", FIELD(strut_scene, bar_model), "Of a run: `rigid` bars keep the length they have at its start, as loaded there; their stiffness and damping then count only while it settles.") \
  X(SCENE, GRAVITY, "gravity", PAIR, ACCELERATION, ANY, "[0, 0]", WRITTEN, 0, "", FIELD(strut_scene, gravity), "Acceleration of free fall.") \
  X(SCENE, GROUND, "ground", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "The line that nodes may touch. Without it there is none.") \
  X(SCENE, ACTUATORS, "actuators", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of an actuator", BY_HAND, "Members whose rest length a signal changes. Several on one member add up.") \
  X(SCENE, LOADS, "loads", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a load", BY_HAND, "Forces on nodes.") \
  X(SCENE, SIGNALS, "signals", THINGS, NONE, ANY, "", OPTIONAL, 0, "a signal", BY_HAND, "Signals with a name, for use in several places.") \
  X(SCENE, CONFIGURATIONS, "configurations", THINGS, NONE, ANY, "", OPTIONAL, 0, "`{NODE: [x, y], ...}` or the keys of a [configuration](#configuration)", BY_HAND, "Shapes with a name: to start from, and to call equilibria by. A node that is not listed stays as drawn.") \
  X(SCENE, INITIAL, "initial", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "The state at t = 0. Without it: at rest, as drawn.") \
  X(SCENE, EQUILIBRIA, "equilibria", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "How equilibria are looked for.") \
  X(SCENE, SOLVER, "solver", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "How to integrate. A run needs it.") \
  X(SCENE, RUN, "run", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "How long, and what to measure. A run needs it.") \
  X(SCENE, OUTPUT, "output", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "What to record.") \
  X(NODE, POSITION, "position", PAIR, LENGTH, ANY, "", REQUIRED, 0, "", FIELD(strut_node, position), "Where the node is drawn.") \
  X(NODE, GROUP, "group", GROUPS, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Where its defaults come from; the later group wins.") \
  X(NODE, MASS, "mass", NUMBER, MASS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_node, mass), "Point mass, besides what its members bring.") \
  X(NODE, FIXED, "fixed", FIXED, NONE, ANY, "none", OPTIONAL, 0, "none|x|y|both", FIELD(strut_node, fixed), "Supports; also as a list, `[x, y]`.") \
  X(MEMBER, GROUP, "group", GROUPS, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Where its defaults come from; the later group wins.") \
  X(MEMBER, NODES, "nodes", NODE_PAIR, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "The two nodes it joins.") \
  X(MEMBER, KIND, "kind", WORD, NONE, ANY, "", REQUIRED, 0, "bar|spring|cable", FIELD(strut_member, kind), "A bar and a spring pull and push; a cable only pulls, and carries nothing while slack.") \
  X(MEMBER, STIFFNESS, "stiffness", NUMBER, STIFFNESS, NOT_NEGATIVE, "0", OPTIONAL, 1, "", FIELD(strut_member, stiffness), "Force for each length of stretch.") \
  X(MEMBER, AXIAL_STIFFNESS, "axial_stiffness", NUMBER, FORCE, NOT_NEGATIVE, "", OPTIONAL, 1, "", FIELD(strut_member, axial_stiffness), "EA; the stiffness is EA / rest length.") \
  X(MEMBER, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_member, damping), "Force for each speed of stretch.") \
  X(MEMBER, MASS, "mass", NUMBER, MASS, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_member, mass), "Of the whole member.") \
  X(MEMBER, REST_LENGTH, "rest_length", NUMBER, LENGTH, NOT_NEGATIVE, "", OPTIONAL, 2, "", BY_HAND, "Length at which it carries no force.") \
  X(MEMBER, REST_LENGTH_RATIO, "rest_length_ratio", NUMBER, NONE, NOT_NEGATIVE, "1", OPTIONAL, 2, "", BY_HAND, "Rest length / drawn length.") \
  X(MEMBER, PRETENSION, "pretension", NUMBER, FORCE, ANY, "", OPTIONAL, 2, "", BY_HAND, "Force in the drawn shape; tension is positive.") \
  X(MEMBER, FORCE_DENSITY, "force_density", NUMBER, STIFFNESS, ANY, "", OPTIONAL, 2, "", BY_HAND, "Force in the drawn shape / drawn length.") \
  X(GROUND, HEIGHT, "height", NUMBER, LENGTH, ANY, "0", OPTIONAL, 0, "", FIELD(strut_ground_section, ground.height), "Of the line where x = 0.") \
  X(GROUND, SLOPE, "slope", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", FIELD(strut_ground_section, ground.slope), "Angle of the line, rising towards +x; within -90 deg and 90 deg.") \
  X(GROUND, BELT_SPEED, "belt_speed", NUMBER, VELOCITY, ANY, "0", OPTIONAL, 0, "", FIELD(strut_ground_section, ground.belt_speed), "Speed of the surface along itself, towards +x.") \
  X(GROUND, STIFFNESS, "stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_ground_section, contact.stiffness), "Force for each depth of a node below the line.") \
  X(GROUND, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_ground_section, contact.damping), "Force for each speed of a node that moves into the ground.") \
  X(GROUND, DAMPING_LAW, "damping_law", WORD, NONE, ANY, "approach_only", OPTIONAL, 0, "approach_only|hunt_crossley", FIELD(strut_ground_section, ground.damping_law), "`approach_only`: stiffness * depth + damping * speed inwards, without damping while the node moves out (the paper's law, which jumps at touchdown). `hunt_crossley`: stiffness * depth * (1 + dissipation * speed inwards), never pulling, without a jump.") \
  X(GROUND, DISSIPATION, "dissipation", NUMBER, DISSIPATION, NOT_NEGATIVE, "0", OPTIONAL, 0, "", FIELD(strut_ground_section, contact.dissipation), "Of the Hunt-Crossley law, instead of `damping`.") \
  X(GROUND, FRICTION, "friction", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Friction of every contact. Without it there is none.") \
  X(GROUND, NODES, "nodes", CONTACT_NODES, NONE, ANY, "all", OPTIONAL, 0, "", BY_HAND, "Which nodes may touch the ground: `all`, or a list.") \
  X(GROUND, CONTACTS, "contacts", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a contact", BY_HAND, "What is different for a node; named by the node.") \
  X(FRICTION, LAW, "law", WORD, NONE, ANY, "karnopp", WRITTEN, 0, "none|karnopp|coulomb|smooth", FIELD(strut_friction, law), "`karnopp`: Coulomb friction with a stick band, the paper's. `coulomb`: exact sticking; needs a method with events. `smooth`: -mu_kinetic N u / sqrt(u^2 + width^2), which creeps.") \
  X(FRICTION, MU, "mu", NUMBER, NONE, NOT_NEGATIVE, "", OPTIONAL, 0, "", BY_HAND, "Both coefficients.") \
  X(FRICTION, MU_STATIC, "mu_static", NUMBER, NONE, NOT_NEGATIVE, "", WRITTEN, 0, "", FIELD(strut_friction, mu_static), "Coefficient of sticking.") \
  X(FRICTION, MU_KINETIC, "mu_kinetic", NUMBER, NONE, NOT_NEGATIVE, "", WRITTEN, 0, "", FIELD(strut_friction, mu_kinetic), "Coefficient of sliding.") \
  X(FRICTION, STICK_VELOCITY, "stick_velocity", NUMBER, VELOCITY, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_friction, stick_velocity), "Half the width of the stick band. Karnopp's law needs it.") \
  X(FRICTION, WIDTH, "width", NUMBER, VELOCITY, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_friction, width), "Of the smooth law, which needs it: the speed at which friction has 0.71 of its full value.") \
  X(CONTACT, GROUP, "group", GROUPS, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Where its defaults come from; the later group wins.") \
  X(CONTACT, STIFFNESS, "stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, "the ground's", OPTIONAL, 0, "", FIELD(strut_contact, stiffness), "Instead of the ground's.") \
  X(CONTACT, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, "the ground's", OPTIONAL, 0, "", FIELD(strut_contact, damping), "Instead of the ground's.") \
  X(CONTACT, DISSIPATION, "dissipation", NUMBER, DISSIPATION, NOT_NEGATIVE, "the ground's", OPTIONAL, 0, "", FIELD(strut_contact, dissipation), "Instead of the ground's.") \
  X(CONTACT, FRICTION, "friction", MAP, NONE, ANY, "the ground's", OPTIONAL, 0, "", BY_HAND, "Overrides the ground's key by key.") \
  X(ACTUATOR, MEMBER, "member", NAME, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "The member it drives.") \
  X(ACTUATOR, SIGNAL, "signal", SIGNAL, LENGTH, ANY, "", REQUIRED, 0, "", BY_HAND, "Added to the member's rest length.") \
  X(LOAD, NODE, "node", NAME, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "The node it acts on.") \
  X(LOAD, FORCE, "force", PAIR, FORCE, ANY, "", REQUIRED, 0, "", FIELD(strut_load, force), "The force, or with a signal the force at a signal of 1.") \
  X(LOAD, SIGNAL, "signal", SIGNAL, NONE, ANY, "constant 1", OPTIONAL, 0, "", BY_HAND, "A factor on the force.") \
  X(SIGNAL, CONSTANT, "constant", NUMBER, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "The same value for t >= 0.") \
  X(SIGNAL, SINE, "sine", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "amplitude * sin(2 pi frequency (t - start) + phase).") \
  X(SIGNAL, HALF_SINE, "half_sine", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "The first half-wave of a sine, once.") \
  X(SIGNAL, SQUARE, "square", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "+amplitude in the first half of a period, -amplitude in the second.") \
  X(SIGNAL, RAMP, "ramp", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "From 0 at start to amplitude at stop; then it stays.") \
  X(SIGNAL, TABLE, "table", TABLE, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "Points `[[t, value], ...]` joined by straight lines; the ends hold.") \
  X(SIGNAL, SUM, "sum", SIGNALS, CONTEXT, ANY, "", OPTIONAL, 0, "", BY_HAND, "A list of signals, added.") \
  X(SINE, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, amplitude), "Largest value.") \
  X(SINE, FREQUENCY, "frequency", NUMBER, FREQUENCY, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_signal, frequency), "Periods in a second.") \
  X(SINE, PHASE, "phase", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", BY_HAND, "Angle at start.") \
  X(SINE, START, "start", NUMBER, TIME, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, start), "The signal is 0 before.") \
  X(SINE, STOP, "stop", NUMBER, TIME, ANY, "never", OPTIONAL, 0, "", FIELD(strut_signal, stop), "The signal is 0 from then on.") \
  X(HALF_SINE, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, amplitude), "Largest value.") \
  X(HALF_SINE, FREQUENCY, "frequency", NUMBER, FREQUENCY, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_signal, frequency), "Of the sine; the half-wave lasts 1 / (2 frequency).") \
  X(HALF_SINE, START, "start", NUMBER, TIME, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, start), "When the half-wave begins.") \
  X(SQUARE, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, amplitude), "Largest value.") \
  X(SQUARE, FREQUENCY, "frequency", NUMBER, FREQUENCY, ABOVE_ZERO, "", REQUIRED, 0, "", FIELD(strut_signal, frequency), "Periods in a second.") \
  X(SQUARE, PHASE, "phase", NUMBER, ANGLE, ANY, "0", OPTIONAL, 0, "", BY_HAND, "Angle at start.") \
  X(SQUARE, START, "start", NUMBER, TIME, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, start), "The signal is 0 before.") \
  X(SQUARE, STOP, "stop", NUMBER, TIME, ANY, "never", OPTIONAL, 0, "", FIELD(strut_signal, stop), "The signal is 0 from then on.") \
  X(RAMP, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, amplitude), "Value at stop and after.") \
  X(RAMP, START, "start", NUMBER, TIME, ANY, "0", OPTIONAL, 0, "", FIELD(strut_signal, start), "When it leaves 0.") \
  X(RAMP, STOP, "stop", NUMBER, TIME, ANY, "", REQUIRED, 0, "", FIELD(strut_signal, stop), "When it reaches amplitude.") \
  X(CONFIGURATION, CONTACTS, "contacts", NODE_SETS, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "The nodes it rests on; several lists are alternatives.") \
  X(CONFIGURATION, SHAPE, "shape", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[x, y]`", BY_HAND, "Positions near it; a node that is not listed is as drawn. Without `shape` the contacts alone tell it.") \
  X(INITIAL, CONFIGURATION, "configuration", NAME, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "A configuration, or a text parameter that names one.") \
  X(INITIAL, EQUILIBRIUM, "equilibrium", NAME, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "A configuration, or a text parameter that names one, at whose equilibrium the run begins; instead of `configuration`, `positions` and `settle`.") \
  X(INITIAL, POSITIONS, "positions", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[x, y]`", BY_HAND, "Positions of single nodes; they win over the configuration.") \
  X(INITIAL, VELOCITIES, "velocities", THINGS, NONE, ANY, "", OPTIONAL, 0, "`[vx, vy]`", BY_HAND, "Velocities of single nodes.") \
  X(INITIAL, VELOCITY, "velocity", PAIR, VELOCITY, ANY, "[0, 0]", OPTIONAL, 0, "", BY_HAND, "Velocity of every other node, where it is free.") \
  X(INITIAL, SETTLE, "settle", SETTLE, NONE, ANY, "false", OPTIONAL, 0, "", BY_HAND, "Come to rest before t = 0, with actuators, driven loads, belt and, as in the paper, friction off: `true`, or a mapping.") \
  X(SETTLE, SPEED, "speed", NUMBER, VELOCITY, ABOVE_ZERO, "1e-8", WRITTEN, 0, "", FIELD(strut_settle, speed), "At rest when every node is slower than this") \
  X(SETTLE, ACCELERATION, "acceleration", NUMBER, ACCELERATION, ABOVE_ZERO, "1e-8", WRITTEN, 0, "", FIELD(strut_settle, acceleration), "and accelerates less than this.") \
  X(SETTLE, LIMIT, "limit", NUMBER, TIME, ABOVE_ZERO, "100", WRITTEN, 0, "", FIELD(strut_settle, limit), "Give up after so much simulated time.") \
  X(SETTLE, EVALUATIONS, "evaluations", NUMBER, NONE, ABOVE_ZERO, "4e7", OPTIONAL, 0, "", FIELD(strut_settle, evaluations), "Give up after so many evaluations of the forces.") \
  X(SETTLE, STEP, "step", NUMBER, TIME, NOT_NEGATIVE, "`solver.step`", OPTIONAL, 0, "", BY_HAND, "Step of the Runge-Kutta method that settles, whatever the run's method. `0`, no step in the file, or one above the stability limit: half that limit.") \
  X(SETTLE, PERTURB, "perturb", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_settle, perturb), "Leave an equilibrium that is unstable: a small push along its most unstable direction, then settle again, until it is stable.") \
  X(SETTLE, FRICTION, "friction", WORD, NONE, ANY, "none", OPTIONAL, 0, "none|kept", FIELD(strut_settle, friction), "Without friction, as in the paper; `kept` lets it hold, as a body on a slope needs.") \
  X(EQUILIBRIA, SUPPORTS, "supports", NODE_SETS, NONE, ANY, "every pair that can carry", OPTIONAL, 0, "", BY_HAND, "Contact nodes to hold in turn: of each list the first is pinned, the others roll on the ground.") \
  X(EQUILIBRIA, STARTS, "starts", NUMBER, NONE, WHOLE(0, STRUT_MOST_STARTS), "until little can be missing", OPTIONAL, 0, "", FIELD(strut_search, starts), "Random starts for each list of supports.") \
  X(EQUILIBRIA, SEED, "seed", NUMBER, NONE, WHOLE(0, STRUT_MOST_SEED), "1", WRITTEN, 0, "", FIELD(strut_search, seed), "Of the random starts; the same seed gives the same answer.") \
  X(SOLVER, INTEGRATOR, "integrator", WORD, NONE, ANY, "rk4", WRITTEN, 0, "rk4|euler|verlet|rk4-events|euler-events|verlet-events|adaptive|midpoint", FIELD(strut_experiment, integrator), "The method.") \
  X(SOLVER, STEP, "step", NUMBER, TIME, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_experiment, step), "Time step; of `adaptive` the longest. A run needs it, or `accuracy`.") \
  X(SOLVER, TOLERANCE, "tolerance", NUMBER, NONE, ABOVE_ZERO, "1e-6", OPTIONAL, 0, "", FIELD(strut_experiment, tolerance), "Of `adaptive`: local error of a step, relative.") \
  X(SOLVER, REFINE, "refine", NUMBER, NONE, ABOVE_ZERO, "from the scene", OPTIONAL, 0, "", FIELD(strut_experiment, refine), "Of methods with events: so many times shorter steps after a touchdown; 1 for none.") \
  X(SOLVER, REFINE_TIME, "refine_time", NUMBER, TIME, ABOVE_ZERO, "from the scene", OPTIONAL, 0, "", FIELD(strut_experiment, refine_time), "For so long.") \
  X(SOLVER, ACCURACY, "accuracy", NUMBER, NONE, ABOVE_ZERO, "", OPTIONAL, 0, "", FIELD(strut_experiment, accuracy), "Wanted of the measured quantity, relative, such as 1 %: method and step are chosen by it.") \
  X(SOLVER, BUDGET, "budget", NUMBER, NONE, ABOVE_ZERO, "20", OPTIONAL, 0, "", FIELD(strut_experiment, budget), "Work that `accuracy` may take, in fine runs by a fixed step; where it does not do, the answer says so.") \
  X(RUN, DURATION, "duration", NUMBER, TIME, ABOVE_ZERO, "", OPTIONAL, 3, "", FIELD(strut_experiment, duration), "Length of the run.") \
  X(RUN, PERIODS, "periods", NUMBER, NONE, ABOVE_ZERO, "", OPTIONAL, 3, "", FIELD(strut_experiment, periods), "Length of the run in periods; needs `of`.") \
  X(RUN, OF, "of", NAME, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "The actuator, load or signal whose periods count.") \
  X(RUN, MEASURE, "measure", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "What to measure. Without it: the centre of mass, over the whole run.") \
  X(MEASURE, LAST, "last", NUMBER, CONTEXT, ABOVE_ZERO, "the whole run", OPTIONAL, 0, "", FIELD(strut_experiment, measure_last), "The window: the last so many periods if the run is in periods, else the last so much time.") \
  X(MEASURE, STEADY, "steady", STEADY, NONE, ANY, "false", OPTIONAL, 0, "", BY_HAND, "Stop when the motion repeats itself, in a run by periods, which then are the most it takes: `true`, or a mapping.") \
  X(MEASURE, NODE, "node", NAME, NONE, ANY, "the centre of mass", OPTIONAL, 0, "", BY_HAND, "Whose velocity.") \
  X(MEASURE, QUANTITIES, "quantities", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression, whose mean is meant, or the keys of a [quantity](#quantity)", BY_HAND, "What else to measure over the window.") \
  X(QUANTITY, OF, "of", EXPRESSION, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "What is measured: columns of the motion and arithmetic of them, as [the language](language.md#measured-quantities) lists them.") \
  X(QUANTITY, TAKE, "take", WORD, NONE, ANY, "mean", OPTIONAL, 0, "mean|min|max|range|rms|final|change|rate", FIELD(strut_quantity_definition, take), "What the window makes of it: its `mean` over the time, `min`, `max`, `range` (max - min), `rms`, its `final` value at the window's end, its `change` over the window, or the `rate` of that, change / time.") \
  X(QUANTITY, ACCURACY, "accuracy", NUMBER, CONTEXT, ABOVE_ZERO, "that of the solver", OPTIONAL, 0, "", BY_HAND, "Wanted of it: relative if without a unit, such as 1 %, else in its own unit, such as 0.1 mm.") \
  X(STEADY, TOLERANCE, "tolerance", NUMBER, NONE, ABOVE_ZERO, "0.5 %", WRITTEN, 0, "", FIELD(strut_steady, tolerance), "Of the velocity, relative to it.") \
  X(STEADY, ABSOLUTE_TOLERANCE, "absolute_tolerance", NUMBER, VELOCITY, ABOVE_ZERO, "from the scene", OPTIONAL, 0, "", FIELD(strut_steady, floor), "Differences of the velocity below this count as none.") \
  X(STEADY, REPETITIONS, "repetitions", NUMBER, NONE, WHOLE(2, 16), "5", WRITTEN, 0, "", FIELD(strut_steady, successive), "So many repetitions in a row must agree.") \
  X(STEADY, SHOOTING, "shooting", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_steady, shooting), "Finish a periodic motion by Newton's method on its period, and give the Floquet multipliers; of structures with up to 48 free coordinates.") \
  X(OUTPUT, EVERY, "every", NUMBER, TIME, ABOVE_ZERO, "a thousandth", OPTIONAL, 0, "", FIELD(strut_experiment, output_every), "Time between two samples.") \
  X(OUTPUT, LAST, "last", NUMBER, CONTEXT, ABOVE_ZERO, "the whole run", OPTIONAL, 0, "", FIELD(strut_experiment, output_last), "Record the last so many periods, or the last so much time.") \
  X(OUTPUT, CHANNELS, "channels", WORDS, NONE, ANY, "[position, length, force]", WRITTEN, 0, "position|velocity|length|force|contact|energy", FIELD(strut_experiment, channels), "A list of what to record.") \
  X(STUDY, VERSION, "strut", VERSION, NONE, ANY, "", REQUIRED, 0, "1", BY_HAND, "Version of the language.") \
  X(STUDY, NAME, "study", TEXT, NONE, ANY, "", REQUIRED, 0, "", FIELD(strut_study, name), "What the study is called.") \
  X(STUDY, DESCRIPTION, "description", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study, description), "What it is for.") \
  X(STUDY, MODEL, "model", TEXT, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "The file of the model, from the study's own folder.") \
  X(STUDY, SET, "set", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression or a text", BY_HAND, "Values of the model's parameters at every point, as by `--set`, which wins.") \
  X(STUDY, AXES, "axes", AXES, NONE, ANY, "", REQUIRED, 0, "", BY_HAND, "A list; each gives one parameter values, `{NAME: [...]}` or `{NAME: {...}}` with the keys of a [range](#range), or several together, `{zip: {NAME: ..., NAME: ...}}`. Axes cross; the last is the fastest.") \
  X(STUDY, DERIVE, "derive", THINGS, NONE, ANY, "", OPTIONAL, 0, "an expression", BY_HAND, "Parameters that follow from others at each point, such as `{step: 1/(1000*frequency)}`.") \
  X(STUDY, VARIANTS, "variants", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a [variant](#variant)", BY_HAND, "The same points in several ways, such as with other numerics: an axis before all others, whose column is `variant`.") \
  X(STUDY, SOLVER, "solver", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Keys that replace those of the model.") \
  X(STUDY, RUN, "run", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Keys that replace those of the model.") \
  X(STUDY, INITIAL, "initial", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Keys that replace those of the model.") \
  X(STUDY, OUTPUT, "output", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Keys that replace those of the model.") \
  X(STUDY, KEEP, "keep", KEEP, NONE, ANY, "[velocity, velocity_spread, motion, periods, force_evaluations, outcome, quantities]", OPTIONAL, 0, "velocity|velocity_spread|velocity_interval|motion|repeats|periods|distance|duration|settle_time|steps|force_evaluations|check_evaluations|events|method|step|step_limit|expected_error|energy|work|losses|residual|contacts|positions|outcome|quantities|accuracy_kept", BY_HAND, "What of each run stands in the table: velocity [m/s] and its spread over the window; `velocity_interval`, `motion` (periodic, irregular, transient), `repeats` and `periods` of a run that stops when steady; `distance` travelled in a drive period; `energy` (at the end), `work` (of drives, loads, belt), `losses`, `residual` of the balance; `contacts` (duty and height of each), `positions` (of each node at the end), `accuracy_kept` (1 where the accuracy wanted was kept, else 0), `outcome` (the nearest configuration); `quantities` (all that the model's `measure` names), or the names of some of them; and the rest of the summary.") \
  X(STUDY, TRAJECTORIES, "trajectories", WORD, NONE, ANY, "no", OPTIONAL, 0, "no|yes", FIELD(strut_study, trajectories), "Write each run into a folder of its own, `runs/POINT`, as `strut run -o` does.") \
  X(STUDY, CHECK, "check", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Run each point again, more exactly, and mark those that end elsewhere.") \
  X(STUDY, FIGURES, "figures", THINGS, NONE, ANY, "", OPTIONAL, 0, "the keys of a [figure](#figure)", BY_HAND, "Drawings of the table, or of what runs recorded: NAME.svg each.") \
  X(RANGE, FROM, "from", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "The first value.") \
  X(RANGE, TO, "to", NUMBER, CONTEXT, ANY, "", REQUIRED, 0, "", BY_HAND, "The last value, where the steps meet it.") \
  X(RANGE, STEP, "step", NUMBER, CONTEXT, ANY, "", OPTIONAL, 4, "", BY_HAND, "From one value to the next; or") \
  X(RANGE, COUNT, "count", NUMBER, NONE, ABOVE_ZERO, "", OPTIONAL, 4, "", BY_HAND, "so many values, both ends among them.") \
  X(RANGE, SCALE, "scale", WORD, NONE, ANY, "linear", OPTIONAL, 0, "linear|log", BY_HAND, "`log`: equal ratios instead of equal steps; needs `count`.") \
  X(VARIANT, SOLVER, "solver", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Keys that replace those of the study and the model.") \
  X(VARIANT, RUN, "run", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Keys that replace those of the study and the model.") \
  X(VARIANT, INITIAL, "initial", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Keys that replace those of the study and the model.") \
  X(VARIANT, OUTPUT, "output", MAP, NONE, ANY, "", OPTIONAL, 0, "", BY_HAND, "Keys that replace those of the study and the model.") \
  X(CHECK, HALF_STEP, "half_step", WORD, NONE, ANY, "no", OPTIONAL, 5, "no|yes", FIELD(strut_study, half_step), "With half the step, or of a model with `accuracy` half of that.") \
  X(CHECK, ACCURACY, "accuracy", NUMBER, NONE, ABOVE_ZERO, "", OPTIONAL, 5, "", FIELD(strut_study, check_accuracy), "With this accuracy.") \
  X(FIGURE, KIND, "kind", WORD, NONE, ANY, "lines", OPTIONAL, 0, "lines|map|motion|period|snapshots", FIELD(strut_study_figure, kind), "Of the table: `lines`, or a `map`, a colour for each point. Of what runs recorded, which needs `trajectories: yes`: `motion`, lines of a table with a row for each node at each time, whose columns are those of the axes, `node`, `time`, `elapsed` (since the record began), `x`, `y`, and `dx`, `dy` (since then too); `period` and `snapshots` as `strut run --draw` does, each run a picture of its own.") \
  X(FIGURE, AT_X, "x", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, x), "A column of the table. Required of lines, maps and motion.") \
  X(FIGURE, AT_Y, "y", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, y), "Another; of a map the second axis. Required as `x`.") \
  X(FIGURE, SERIES, "series", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, series), "Of lines: the column that tells them apart.") \
  X(FIGURE, COLOR, "color", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, color), "Of a map: the column that is coloured; hatched where `flips` is 1.") \
  X(FIGURE, PANELS, "panels", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, panels), "The column that has a panel for each of its values.") \
  X(FIGURE, BAND, "band", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, band), "Of lines: `COLUMN=TEXT`, grey where the column has that text, half way to the neighbours.") \
  X(FIGURE, ONLY, "only", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, only), "`COLUMN=TEXT`: of the rows whose column has that text, such as `variant=coarse`.") \
  X(FIGURE, DIFFERENCE, "difference", NAME, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, difference), "A column with two different texts: lines of `y` of the second less that of the first; a map of the second, hatched where the first says otherwise; a picture of the second, the first dashed.") \
  X(FIGURE, FROM, "from", NUMBER, TIME, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, from), "Of motion: nothing before.") \
  X(FIGURE, TO, "to", NUMBER, TIME, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, to), "Of motion: nothing after.") \
  X(FIGURE, SCALE, "scale", PAIR, NONE, ANY, "[1, 1]", OPTIONAL, 0, "", FIELD(strut_study_figure, scale), "Of `period`: motion along x and y is drawn so many times as large.") \
  X(FIGURE, TIMES, "times", TIMES, NONE, ANY, "six", OPTIONAL, 0, "", BY_HAND, "Of `snapshots`: when.") \
  X(FIGURE, TITLE, "title", TEXT, NONE, ANY, "", OPTIONAL, 0, "", FIELD(strut_study_figure, title), "What stands above it.")
/* clang-format on */

#endif
