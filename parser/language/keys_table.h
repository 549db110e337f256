/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The table of the language: one line for each key. See keys.h for what is made of it.
 *
 * X(room, id, name, type, measure, range, need, set, default, words, description)
 * Of the keys of one set (not 0) a mapping may give one only. Words are separated by '|'.
 */
#ifndef STRUT_PARSER_LANGUAGE_KEYS_TABLE_H
#define STRUT_PARSER_LANGUAGE_KEYS_TABLE_H

/* clang-format off */
#define STRUT_KEY_TABLE(X) \
  X(SCENE, VERSION, "strut", VERSION, NONE, ANY, true, 0, "", "1", "Version of the language.") \
  X(SCENE, NAME, "name", TEXT, NONE, ANY, false, 0, "", "", "What the scene is called.") \
  X(SCENE, DESCRIPTION, "description", TEXT, NONE, ANY, false, 0, "", "", "What it shows.") \
  X(SCENE, SOURCE, "source", TEXT, NONE, ANY, false, 0, "", "", "Where its numbers come from.") \
  X(SCENE, PARAMETERS, "parameters", THINGS, NONE, ANY, false, 0, "", "an expression or a quoted text", "Named values that expressions may use and `--set` may change.") \
  X(SCENE, GROUPS, "groups", THINGS, NONE, ANY, false, 0, "", "keys of a member, a node or a contact", "Defaults that members, nodes and contacts share. Own keys win.") \
  X(SCENE, NODES, "nodes", THINGS, NONE, ANY, true, 0, "", "`[x, y]` or the keys of a node", "The points of the structure.") \
  X(SCENE, MEMBERS, "members", THINGS, NONE, ANY, false, 0, "", "the keys of a member", "What joins the nodes.") \
  X(SCENE, MASS_MODEL, "mass_model", WORD, NONE, ANY, false, 0, "consistent", "consistent|lumped", "How a member's mass acts: as of a uniform rod (the paper's), or half at each end.") \
  X(SCENE, BARS, "bars", WORD, NONE, ANY, false, 0, "elastic", "elastic|rigid", "Of a run: `rigid` bars keep the length they have at its start, as loaded there; their stiffness and damping then count only while it settles.") \
  X(SCENE, GRAVITY, "gravity", PAIR, ACCELERATION, ANY, false, 0, "[0, 0]", "", "Acceleration of free fall.") \
  X(SCENE, GROUND, "ground", MAP, NONE, ANY, false, 0, "", "", "The line that nodes may touch. Without it there is none.") \
  X(SCENE, ACTUATORS, "actuators", THINGS, NONE, ANY, false, 0, "", "the keys of an actuator", "Members whose rest length a signal changes. Several on one member add up.") \
  X(SCENE, LOADS, "loads", THINGS, NONE, ANY, false, 0, "", "the keys of a load", "Forces on nodes.") \
  X(SCENE, SIGNALS, "signals", THINGS, NONE, ANY, false, 0, "", "a signal", "Signals with a name, for use in several places.") \
  X(SCENE, CONFIGURATIONS, "configurations", THINGS, NONE, ANY, false, 0, "", "`{NODE: [x, y], ...}` or the keys of a [configuration](#configuration)", "Shapes with a name: to start from, and to call equilibria by. A node that is not listed stays as drawn.") \
  X(SCENE, INITIAL, "initial", MAP, NONE, ANY, false, 0, "", "", "The state at t = 0. Without it: at rest, as drawn.") \
  X(SCENE, EQUILIBRIA, "equilibria", MAP, NONE, ANY, false, 0, "", "", "How equilibria are looked for.") \
  X(SCENE, SOLVER, "solver", MAP, NONE, ANY, false, 0, "", "", "How to integrate. A run needs it.") \
  X(SCENE, RUN, "run", MAP, NONE, ANY, false, 0, "", "", "How long, and what to measure. A run needs it.") \
  X(SCENE, OUTPUT, "output", MAP, NONE, ANY, false, 0, "", "", "What to record.") \
  X(NODE, POSITION, "position", PAIR, LENGTH, ANY, true, 0, "", "", "Where the node is drawn.") \
  X(NODE, GROUP, "group", GROUPS, NONE, ANY, false, 0, "", "", "Where its defaults come from; the later group wins.") \
  X(NODE, MASS, "mass", NUMBER, MASS, NOT_NEGATIVE, false, 0, "0", "", "Point mass, besides what its members bring.") \
  X(NODE, FIXED, "fixed", FIXED, NONE, ANY, false, 0, "none", "none|x|y|both", "Supports; also as a list, `[x, y]`.") \
  X(MEMBER, GROUP, "group", GROUPS, NONE, ANY, false, 0, "", "", "Where its defaults come from; the later group wins.") \
  X(MEMBER, NODES, "nodes", NODE_PAIR, NONE, ANY, true, 0, "", "", "The two nodes it joins.") \
  X(MEMBER, KIND, "kind", WORD, NONE, ANY, true, 0, "", "bar|spring|cable", "A bar and a spring pull and push; a cable only pulls, and carries nothing while slack.") \
  X(MEMBER, STIFFNESS, "stiffness", NUMBER, STIFFNESS, NOT_NEGATIVE, false, 1, "0", "", "Force for each length of stretch.") \
  X(MEMBER, AXIAL_STIFFNESS, "axial_stiffness", NUMBER, FORCE, NOT_NEGATIVE, false, 1, "", "", "EA; the stiffness is EA / rest length.") \
  X(MEMBER, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, false, 0, "0", "", "Force for each speed of stretch.") \
  X(MEMBER, MASS, "mass", NUMBER, MASS, NOT_NEGATIVE, false, 0, "0", "", "Of the whole member.") \
  X(MEMBER, REST_LENGTH, "rest_length", NUMBER, LENGTH, NOT_NEGATIVE, false, 2, "", "", "Length at which it carries no force.") \
  X(MEMBER, REST_LENGTH_RATIO, "rest_length_ratio", NUMBER, NONE, NOT_NEGATIVE, false, 2, "1", "", "Rest length / drawn length.") \
  X(MEMBER, PRETENSION, "pretension", NUMBER, FORCE, ANY, false, 2, "", "", "Force in the drawn shape; tension is positive.") \
  X(MEMBER, FORCE_DENSITY, "force_density", NUMBER, STIFFNESS, ANY, false, 2, "", "", "Force in the drawn shape / drawn length.") \
  X(GROUND, HEIGHT, "height", NUMBER, LENGTH, ANY, false, 0, "0", "", "Of the line where x = 0.") \
  X(GROUND, SLOPE, "slope", NUMBER, ANGLE, ANY, false, 0, "0", "", "Angle of the line, rising towards +x; within -90 deg and 90 deg.") \
  X(GROUND, BELT_SPEED, "belt_speed", NUMBER, VELOCITY, ANY, false, 0, "0", "", "Speed of the surface along itself, towards +x.") \
  X(GROUND, STIFFNESS, "stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, true, 0, "", "", "Force for each depth of a node below the line.") \
  X(GROUND, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, false, 0, "0", "", "Force for each speed of a node that moves into the ground.") \
  X(GROUND, DAMPING_LAW, "damping_law", WORD, NONE, ANY, false, 0, "printed", "printed|hunt_crossley", "`printed`: stiffness * depth + damping * speed inwards, which jumps at touchdown. `hunt_crossley`: stiffness * depth * (1 + dissipation * speed inwards), never pulling, without a jump.") \
  X(GROUND, DISSIPATION, "dissipation", NUMBER, DISSIPATION, NOT_NEGATIVE, false, 0, "0", "", "Of the Hunt-Crossley law, instead of `damping`.") \
  X(GROUND, FRICTION, "friction", MAP, NONE, ANY, false, 0, "", "", "Friction of every contact. Without it there is none.") \
  X(GROUND, NODES, "nodes", CONTACT_NODES, NONE, ANY, false, 0, "all", "", "Which nodes may touch the ground: `all`, or a list.") \
  X(GROUND, CONTACTS, "contacts", THINGS, NONE, ANY, false, 0, "", "the keys of a contact", "What is different for a node; named by the node.") \
  X(FRICTION, LAW, "law", WORD, NONE, ANY, false, 0, "karnopp", STRUT_FRICTION_WORDS, "`karnopp`: Coulomb friction with a stick band, the paper's. `coulomb`: exact sticking; needs a method with events. `smooth`: -mu_kinetic N u / sqrt(u^2 + width^2), which creeps.") \
  X(FRICTION, MU, "mu", NUMBER, NONE, NOT_NEGATIVE, false, 0, "", "", "Both coefficients.") \
  X(FRICTION, MU_STATIC, "mu_static", NUMBER, NONE, NOT_NEGATIVE, false, 0, "", "", "Coefficient of sticking.") \
  X(FRICTION, MU_KINETIC, "mu_kinetic", NUMBER, NONE, NOT_NEGATIVE, false, 0, "", "", "Coefficient of sliding.") \
  X(FRICTION, STICK_VELOCITY, "stick_velocity", NUMBER, VELOCITY, ABOVE_ZERO, false, 0, "", "", "Half the width of the stick band. Karnopp's law needs it.") \
  X(FRICTION, WIDTH, "width", NUMBER, VELOCITY, ABOVE_ZERO, false, 0, "", "", "Of the smooth law, which needs it: the speed at which friction has 0.71 of its full value.") \
  X(CONTACT, GROUP, "group", GROUPS, NONE, ANY, false, 0, "", "", "Where its defaults come from; the later group wins.") \
  X(CONTACT, STIFFNESS, "stiffness", NUMBER, STIFFNESS, ABOVE_ZERO, false, 0, "the ground's", "", "Instead of the ground's.") \
  X(CONTACT, DAMPING, "damping", NUMBER, DAMPING, NOT_NEGATIVE, false, 0, "the ground's", "", "Instead of the ground's.") \
  X(CONTACT, DISSIPATION, "dissipation", NUMBER, DISSIPATION, NOT_NEGATIVE, false, 0, "the ground's", "", "Instead of the ground's.") \
  X(CONTACT, FRICTION, "friction", MAP, NONE, ANY, false, 0, "the ground's", "", "Overrides the ground's key by key.") \
  X(ACTUATOR, MEMBER, "member", NAME, NONE, ANY, true, 0, "", "", "The member it drives.") \
  X(ACTUATOR, SIGNAL, "signal", SIGNAL, LENGTH, ANY, true, 0, "", "", "Added to the member's rest length.") \
  X(LOAD, NODE, "node", NAME, NONE, ANY, true, 0, "", "", "The node it acts on.") \
  X(LOAD, FORCE, "force", PAIR, FORCE, ANY, true, 0, "", "", "The force, or with a signal the force at a signal of 1.") \
  X(LOAD, SIGNAL, "signal", SIGNAL, NONE, ANY, false, 0, "constant 1", "", "A factor on the force.") \
  X(SIGNAL, CONSTANT, "constant", NUMBER, CONTEXT, ANY, false, 0, "", "", "The same value for t >= 0.") \
  X(SIGNAL, SINE, "sine", MAP, NONE, ANY, false, 0, "", "", "amplitude * sin(2 pi frequency (t - start) + phase).") \
  X(SIGNAL, HALF_SINE, "half_sine", MAP, NONE, ANY, false, 0, "", "", "The first half-wave of a sine, once.") \
  X(SIGNAL, SQUARE, "square", MAP, NONE, ANY, false, 0, "", "", "+amplitude in the first half of a period, -amplitude in the second.") \
  X(SIGNAL, RAMP, "ramp", MAP, NONE, ANY, false, 0, "", "", "From 0 at start to amplitude at stop; then it stays.") \
  X(SIGNAL, TABLE, "table", TABLE, CONTEXT, ANY, false, 0, "", "", "Points `[[t, value], ...]` joined by straight lines; the ends hold.") \
  X(SIGNAL, SUM, "sum", SIGNALS, CONTEXT, ANY, false, 0, "", "", "A list of signals, added.") \
  X(SINE, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, true, 0, "", "", "Largest value.") \
  X(SINE, FREQUENCY, "frequency", NUMBER, FREQUENCY, ABOVE_ZERO, true, 0, "", "", "Periods in a second.") \
  X(SINE, PHASE, "phase", NUMBER, ANGLE, ANY, false, 0, "0", "", "Angle at start.") \
  X(SINE, START, "start", NUMBER, TIME, ANY, false, 0, "0", "", "The signal is 0 before.") \
  X(SINE, STOP, "stop", NUMBER, TIME, ANY, false, 0, "never", "", "The signal is 0 from then on.") \
  X(HALF_SINE, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, true, 0, "", "", "Largest value.") \
  X(HALF_SINE, FREQUENCY, "frequency", NUMBER, FREQUENCY, ABOVE_ZERO, true, 0, "", "", "Of the sine; the half-wave lasts 1 / (2 frequency).") \
  X(HALF_SINE, START, "start", NUMBER, TIME, ANY, false, 0, "0", "", "When the half-wave begins.") \
  X(SQUARE, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, true, 0, "", "", "Largest value.") \
  X(SQUARE, FREQUENCY, "frequency", NUMBER, FREQUENCY, ABOVE_ZERO, true, 0, "", "", "Periods in a second.") \
  X(SQUARE, PHASE, "phase", NUMBER, ANGLE, ANY, false, 0, "0", "", "Angle at start.") \
  X(SQUARE, START, "start", NUMBER, TIME, ANY, false, 0, "0", "", "The signal is 0 before.") \
  X(SQUARE, STOP, "stop", NUMBER, TIME, ANY, false, 0, "never", "", "The signal is 0 from then on.") \
  X(RAMP, AMPLITUDE, "amplitude", NUMBER, CONTEXT, ANY, true, 0, "", "", "Value at stop and after.") \
  X(RAMP, START, "start", NUMBER, TIME, ANY, false, 0, "0", "", "When it leaves 0.") \
  X(RAMP, STOP, "stop", NUMBER, TIME, ANY, true, 0, "", "", "When it reaches amplitude.") \
  X(CONFIGURATION, CONTACTS, "contacts", NODE_SETS, NONE, ANY, false, 0, "", "", "The nodes it rests on; several lists are alternatives.") \
  X(CONFIGURATION, SHAPE, "shape", THINGS, NONE, ANY, false, 0, "", "`[x, y]`", "Positions near it; a node that is not listed is as drawn. Without `shape` the contacts alone tell it.") \
  X(INITIAL, CONFIGURATION, "configuration", NAME, NONE, ANY, false, 0, "", "", "A configuration, or a text parameter that names one.") \
  X(INITIAL, EQUILIBRIUM, "equilibrium", NAME, NONE, ANY, false, 0, "", "", "A configuration, or a text parameter that names one, at whose equilibrium the run begins; instead of `configuration`, `positions` and `settle`.") \
  X(INITIAL, POSITIONS, "positions", THINGS, NONE, ANY, false, 0, "", "`[x, y]`", "Positions of single nodes; they win over the configuration.") \
  X(INITIAL, VELOCITIES, "velocities", THINGS, NONE, ANY, false, 0, "", "`[vx, vy]`", "Velocities of single nodes.") \
  X(INITIAL, VELOCITY, "velocity", PAIR, VELOCITY, ANY, false, 0, "[0, 0]", "", "Velocity of every other node, where it is free.") \
  X(INITIAL, SETTLE, "settle", SETTLE, NONE, ANY, false, 0, "false", "", "Come to rest before t = 0, with actuators, driven loads, belt and, as in the paper, friction off: `true`, or a mapping.") \
  X(SETTLE, SPEED, "speed", NUMBER, VELOCITY, ABOVE_ZERO, false, 0, "1e-8", "", "At rest when every node is slower than this") \
  X(SETTLE, ACCELERATION, "acceleration", NUMBER, ACCELERATION, ABOVE_ZERO, false, 0, "1e-8", "", "and accelerates less than this.") \
  X(SETTLE, LIMIT, "limit", NUMBER, TIME, ABOVE_ZERO, false, 0, "100", "", "Give up after so much simulated time.") \
  X(SETTLE, EVALUATIONS, "evaluations", NUMBER, NONE, ABOVE_ZERO, false, 0, "4e7", "", "Give up after so many evaluations of the forces.") \
  X(SETTLE, STEP, "step", NUMBER, TIME, NOT_NEGATIVE, false, 0, "`solver.step`", "", "Step of the Runge-Kutta method that settles, whatever the run's method. `0`, no step in the file, or one above the stability limit: half that limit.") \
  X(SETTLE, PERTURB, "perturb", WORD, NONE, ANY, false, 0, "no", "no|yes", "Leave an equilibrium that is unstable: a small push along its most unstable direction, then settle again, until it is stable.") \
  X(SETTLE, FRICTION, "friction", WORD, NONE, ANY, false, 0, "none", "none|kept", "Without friction, as in the paper; `kept` lets it hold, as a body on a slope needs.") \
  X(EQUILIBRIA, SUPPORTS, "supports", NODE_SETS, NONE, ANY, false, 0, "every pair that can carry", "", "Contact nodes to hold in turn: of each list the first is pinned, the others roll on the ground.") \
  X(EQUILIBRIA, STARTS, "starts", NUMBER, NONE, NOT_NEGATIVE, false, 0, "until little can be missing", "", "Random starts for each list of supports.") \
  X(EQUILIBRIA, SEED, "seed", NUMBER, NONE, NOT_NEGATIVE, false, 0, "1", "", "Of the random starts; the same seed gives the same answer.") \
  X(SOLVER, INTEGRATOR, "integrator", WORD, NONE, ANY, false, 0, "rk4", STRUT_INTEGRATOR_WORDS, "The method.") \
  X(SOLVER, STEP, "step", NUMBER, TIME, ABOVE_ZERO, false, 0, "", "", "Time step; of `adaptive` the longest. A run needs it, or `accuracy`.") \
  X(SOLVER, TOLERANCE, "tolerance", NUMBER, NONE, ABOVE_ZERO, false, 0, "1e-6", "", "Of `adaptive`: local error of a step, relative.") \
  X(SOLVER, REFINE, "refine", NUMBER, NONE, ABOVE_ZERO, false, 0, "from the scene", "", "Of methods with events: so many times shorter steps after a touchdown; 1 for none.") \
  X(SOLVER, REFINE_TIME, "refine_time", NUMBER, TIME, ABOVE_ZERO, false, 0, "from the scene", "", "For so long.") \
  X(SOLVER, ACCURACY, "accuracy", NUMBER, NONE, ABOVE_ZERO, false, 0, "", "", "Wanted of the measured quantity, relative, such as 1 %: method and step are chosen by it.") \
  X(SOLVER, BUDGET, "budget", NUMBER, NONE, ABOVE_ZERO, false, 0, "20", "", "Work that `accuracy` may take, in fine runs by a fixed step; where it does not do, the answer says so.") \
  X(RUN, DURATION, "duration", NUMBER, TIME, ABOVE_ZERO, false, 3, "", "", "Length of the run.") \
  X(RUN, PERIODS, "periods", NUMBER, NONE, ABOVE_ZERO, false, 3, "", "", "Length of the run in periods; needs `of`.") \
  X(RUN, OF, "of", NAME, NONE, ANY, false, 0, "", "", "The actuator, load or signal whose periods count.") \
  X(RUN, MEASURE, "measure", MAP, NONE, ANY, false, 0, "", "", "What to measure. Without it: the centre of mass, over the whole run.") \
  X(MEASURE, LAST, "last", NUMBER, CONTEXT, ABOVE_ZERO, false, 0, "the whole run", "", "The window: the last so many periods if the run is in periods, else the last so much time.") \
  X(MEASURE, NODE, "node", NAME, NONE, ANY, false, 0, "the centre of mass", "", "Whose velocity.") \
  X(MEASURE, STEADY, "steady", STEADY, NONE, ANY, false, 0, "false", "", "Stop when the motion repeats itself, in a run by periods, which then are the most it takes: `true`, or a mapping.") \
  X(MEASURE, QUANTITIES, "quantities", THINGS, NONE, ANY, false, 0, "", "an expression, whose mean is meant, or the keys of a [quantity](#quantity)", "What else to measure over the window.") \
  X(QUANTITY, OF, "of", EXPRESSION, NONE, ANY, true, 0, "", "", "What is measured: columns of the motion and arithmetic of them, as [the language](language.md#measured-quantities) lists them.") \
  X(QUANTITY, TAKE, "take", WORD, NONE, ANY, false, 0, "mean", "mean|min|max|range|rms|final|change|rate", "What the window makes of it: its `mean` over the time, `min`, `max`, `range` (max - min), `rms`, its `final` value at the window's end, its `change` over the window, or the `rate` of that, change / time.") \
  X(QUANTITY, ACCURACY, "accuracy", NUMBER, CONTEXT, ABOVE_ZERO, false, 0, "that of the solver", "", "Wanted of it: relative if without a unit, such as 1 %, else in its own unit, such as 0.1 mm.") \
  X(STEADY, TOLERANCE, "tolerance", NUMBER, NONE, ABOVE_ZERO, false, 0, "0.5 %", "", "Of the velocity, relative to it.") \
  X(STEADY, FLOOR, "floor", NUMBER, VELOCITY, ABOVE_ZERO, false, 0, "from the scene", "", "Differences of the velocity below this count as none.") \
  X(STEADY, SUCCESSIVE, "successive", NUMBER, NONE, ABOVE_ZERO, false, 0, "5", "", "So many repetitions in a row must agree.") \
  X(STEADY, SHOOTING, "shooting", WORD, NONE, ANY, false, 0, "no", "no|yes", "Finish a periodic motion by Newton's method on its period, and give the Floquet multipliers; of structures with up to 48 free coordinates.") \
  X(OUTPUT, EVERY, "every", NUMBER, TIME, ABOVE_ZERO, false, 0, "a thousandth", "", "Time between two samples.") \
  X(OUTPUT, LAST, "last", NUMBER, CONTEXT, ABOVE_ZERO, false, 0, "the whole run", "", "Record the last so many periods, or the last so much time.") \
  X(OUTPUT, CHANNELS, "channels", WORDS, NONE, ANY, false, 0, "[position, length, force]", "position|velocity|length|force|contact|energy", "A list of what to record.") \
  X(STUDY, VERSION, "strut", VERSION, NONE, ANY, true, 0, "", "1", "Version of the language.") \
  X(STUDY, NAME, "study", TEXT, NONE, ANY, true, 0, "", "", "What the study is called.") \
  X(STUDY, DESCRIPTION, "description", TEXT, NONE, ANY, false, 0, "", "", "What it is for.") \
  X(STUDY, MODEL, "model", TEXT, NONE, ANY, true, 0, "", "", "The file of the model, from the study's own folder.") \
  X(STUDY, SET, "set", THINGS, NONE, ANY, false, 0, "", "an expression or a text", "Values of the model's parameters at every point, as by `--set`, which wins.") \
  X(STUDY, AXES, "axes", AXES, NONE, ANY, true, 0, "", "", "A list; each gives one parameter values, `{NAME: [...]}` or `{NAME: {...}}` with the keys of a [range](#range), or several together, `{zip: {NAME: ..., NAME: ...}}`. Axes cross; the last is the fastest.") \
  X(STUDY, DERIVE, "derive", THINGS, NONE, ANY, false, 0, "", "an expression", "Parameters that follow from others at each point, such as `{step: 1/(1000*frequency)}`.") \
  X(STUDY, VARIANTS, "variants", THINGS, NONE, ANY, false, 0, "", "the keys of a [variant](#variant)", "The same points in several ways, such as with other numerics: an axis before all others, whose column is `variant`.") \
  X(STUDY, SOLVER, "solver", MAP, NONE, ANY, false, 0, "", "", "Keys that replace those of the model.") \
  X(STUDY, RUN, "run", MAP, NONE, ANY, false, 0, "", "", "Keys that replace those of the model.") \
  X(STUDY, INITIAL, "initial", MAP, NONE, ANY, false, 0, "", "", "Keys that replace those of the model.") \
  X(STUDY, OUTPUT, "output", MAP, NONE, ANY, false, 0, "", "", "Keys that replace those of the model.") \
  X(STUDY, KEEP, "keep", KEEP, NONE, ANY, false, 0, "[velocity, velocity_spread, motion, periods, force_evaluations, outcome, quantities]", "velocity|velocity_spread|velocity_interval|motion|repeats|periods|distance|duration|settle_time|steps|force_evaluations|check_evaluations|events|method|step|step_limit|expected_error|energy|work|losses|residual|contacts|positions|outcome|quantities|accuracy_kept", "What of each run stands in the table: velocity [m/s] and its spread over the window; `velocity_interval`, `motion` (periodic, irregular, transient), `repeats` and `periods` of a run that stops when steady; `distance` travelled in a drive period; `energy` (at the end), `work` (of drives, loads, belt), `losses`, `residual` of the balance; `contacts` (duty and height of each), `positions` (of each node at the end), `accuracy_kept` (1 where the accuracy wanted was kept, else 0), `outcome` (the nearest configuration); `quantities` (all that the model's `measure` names), or the names of some of them; and the rest of the summary.") \
  X(STUDY, TRAJECTORIES, "trajectories", WORD, NONE, ANY, false, 0, "no", "no|yes", "Write each run into a folder of its own, `runs/POINT`, as `strut run -o` does.") \
  X(STUDY, CHECK, "check", MAP, NONE, ANY, false, 0, "", "", "Run each point again, more exactly, and mark those that end elsewhere.") \
  X(STUDY, FIGURES, "figures", THINGS, NONE, ANY, false, 0, "", "the keys of a [figure](#figure)", "Drawings of the table, or of what runs recorded: NAME.svg each.") \
  X(RANGE, FROM, "from", NUMBER, CONTEXT, ANY, true, 0, "", "", "The first value.") \
  X(RANGE, TO, "to", NUMBER, CONTEXT, ANY, true, 0, "", "", "The last value, where the steps meet it.") \
  X(RANGE, STEP, "step", NUMBER, CONTEXT, ANY, false, 4, "", "", "From one value to the next; or") \
  X(RANGE, COUNT, "count", NUMBER, NONE, ABOVE_ZERO, false, 4, "", "", "so many values, both ends among them.") \
  X(RANGE, SCALE, "scale", WORD, NONE, ANY, false, 0, "linear", "linear|log", "`log`: equal ratios instead of equal steps; needs `count`.") \
  X(VARIANT, SOLVER, "solver", MAP, NONE, ANY, false, 0, "", "", "Keys that replace those of the study and the model.") \
  X(VARIANT, RUN, "run", MAP, NONE, ANY, false, 0, "", "", "Keys that replace those of the study and the model.") \
  X(VARIANT, INITIAL, "initial", MAP, NONE, ANY, false, 0, "", "", "Keys that replace those of the study and the model.") \
  X(VARIANT, OUTPUT, "output", MAP, NONE, ANY, false, 0, "", "", "Keys that replace those of the study and the model.") \
  X(CHECK, HALF_STEP, "half_step", WORD, NONE, ANY, false, 5, "no", "no|yes", "With half the step, or of a model with `accuracy` half of that.") \
  X(CHECK, ACCURACY, "accuracy", NUMBER, NONE, ABOVE_ZERO, false, 5, "", "", "With this accuracy.") \
  X(FIGURE, KIND, "kind", WORD, NONE, ANY, false, 0, "lines", "lines|map|motion|period|snapshots", "Of the table: `lines`, or a `map`, a colour for each point. Of what runs recorded, which needs `trajectories: yes`: `motion`, lines of a table with a row for each node at each time, whose columns are those of the axes, `node`, `time`, `elapsed` (since the record began), `x`, `y`, and `dx`, `dy` (since then too); `period` and `snapshots` as `strut run --draw` does, each run a picture of its own.") \
  X(FIGURE, AT_X, "x", NAME, NONE, ANY, false, 0, "", "", "A column of the table. Required of lines, maps and motion.") \
  X(FIGURE, AT_Y, "y", NAME, NONE, ANY, false, 0, "", "", "Another; of a map the second axis. Required as `x`.") \
  X(FIGURE, SERIES, "series", NAME, NONE, ANY, false, 0, "", "", "Of lines: the column that tells them apart.") \
  X(FIGURE, COLOR, "color", NAME, NONE, ANY, false, 0, "", "", "Of a map: the column that is coloured; hatched where `flips` is 1.") \
  X(FIGURE, PANELS, "panels", NAME, NONE, ANY, false, 0, "", "", "The column that has a panel for each of its values.") \
  X(FIGURE, BAND, "band", TEXT, NONE, ANY, false, 0, "", "", "Of lines: `COLUMN=TEXT`, grey where the column has that text, half way to the neighbours.") \
  X(FIGURE, ONLY, "only", TEXT, NONE, ANY, false, 0, "", "", "`COLUMN=TEXT`: of the rows whose column has that text, such as `variant=coarse`.") \
  X(FIGURE, DIFFERENCE, "difference", NAME, NONE, ANY, false, 0, "", "", "A column with two different texts: lines of `y` of the second less that of the first; a map of the second, hatched where the first says otherwise; a picture of the second, the first dashed.") \
  X(FIGURE, FROM, "from", NUMBER, TIME, ANY, false, 0, "", "", "Of motion: nothing before.") \
  X(FIGURE, TO, "to", NUMBER, TIME, ANY, false, 0, "", "", "Of motion: nothing after.") \
  X(FIGURE, SCALE, "scale", PAIR, NONE, ANY, false, 0, "[1, 1]", "", "Of `period`: motion along x and y is drawn so many times as large.") \
  X(FIGURE, TIMES, "times", TIMES, NONE, ANY, false, 0, "six", "", "Of `snapshots`: when.") \
  X(FIGURE, TITLE, "title", TEXT, NONE, ANY, false, 0, "", "", "What stands above it.")
/* clang-format on */

#endif
