/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/physics/random_world.h"

#include "tests/support/check.h"
#include "tests/support/random.h"

enum section {
  NODES,
  MEMBERS,
  HINGES,
  CELLS,
  COLLISIONS,
  DISTANCES,
  GROUNDS,
  SIGNALS,
  ACTUATORS,
  LOADS,
  UNBALANCES,
  SENSORS,
  STATES,
  OSCILLATORS,
  CONTROLLERS,
  OTHERS,
  SECTION_COUNT
};

static const char *const KEYS[SECTION_COUNT] = {
    "nodes",      "members", "hinges",  "cells",       "collisions",
    "distances",  "grounds", "signals", "actuators",   "loads",
    "unbalances", "sensors", "states",  "oscillators", "controllers"};

__attribute__((format(printf, 3, 4))) static void put(random_world *w, enum section section,
                                                      const char *format, ...) {
  char *text = w->section[section];
  size_t used = strlen(text), room = sizeof w->section[section] - used;
  va_list arguments;
  va_start(arguments, format);
  int length = vsnprintf(text + used, room, format, arguments);
  va_end(arguments);
  assert_true(length >= 0 && (size_t)length < room);
}

static double between(random_world *w, double low, double high) {
  return random_between(&w->random, low, high);
}
static bool once_in(random_world *w, int times) { return random_once_in(&w->random, times); }
static int below(random_world *w, int count) { return random_below(&w->random, count); }
static bool has(const random_world *w, unsigned part) { return w->parts & part; }

/* Another node of the ring, at least `apart` further. */
static int across(random_world *w, int from, int apart) {
  return (from + apart + below(w, w->ring - 2 * apart + 1)) % w->ring;
}

/* ---- the structure ---- */

static void put_nodes(random_world *w) {
  for (int i = 0; i < w->ring; i++) {
    double turn = 2 * acos(-1) * (i + between(w, -0.15, 0.15)) / w->ring;
    bool moved = i == 1 && has(w, WORLD_DRIVES);
    put(w, NODES, "  n%d: {position: [%.17g, %.17g], mass: %.17g%s}\n", i, cos(turn), sin(turn),
        between(w, 0.5, 2),
        i == 0  ? ", fixed: both"
        : moved ? ", fixed: x, moves: {x: shake, y: lift}"
                : "");
  }
  for (int i = w->ring; i < w->nodes; i++)
    put(w, NODES, "  n%d: {position: [%.17g, %.17g], mass: %.17g}\n", i, 0.5 * (i - w->ring) - 0.3,
        between(w, -0.3, 0.3), between(w, 0.5, 2));
}

/* Laws whose force has no kink, or any of them. */
static const char *put_law(random_world *w, char *text, size_t size) {
  switch (below(w, has(w, WORLD_SMOOTH) ? 4 : 7)) {
    case 0:
      snprintf(text, size, "law: {kind: polynomial, coefficients: [%.17g, %.17g, %.17g]}",
               between(w, 20, 100), between(w, -50, 50), between(w, 100, 900));
      break;
    case 1: snprintf(text, size, "stiffness: %.17g, law: logarithmic", between(w, 50, 200)); break;
    case 2:
      snprintf(text, size, "stiffness: %.17g, law: {kind: exponential, scale: %.17g}",
               between(w, 50, 200), between(w, 0.2, 1));
      break;
    case 3: snprintf(text, size, "stiffness: %.17g", between(w, 50, 200)); break;
    case 4:
      snprintf(text, size,
               "stiffness: %.17g, law: {kind: bilinear, knee: %.17g, second_stiffness: %.17g}",
               between(w, 50, 200), between(w, 0.02, 0.2), between(w, 10, 300));
      break;
    case 5:
      snprintf(text, size, "stiffness: %.17g, law: {kind: play, gap: %.17g}, longest: %.17g",
               between(w, 50, 200), between(w, 0.02, 0.2), between(w, 1.2, 1.9));
      break;
    default:
      snprintf(text, size, "stiffness: %.17g, law: %s, shortest: %.17g, stop_damping: %.17g",
               between(w, 50, 200), once_in(w, 2) ? "tension_only" : "compression_only",
               between(w, 1, 1.7), between(w, 0, 2));
  }
  return text;
}

static void put_damping(random_world *w, enum section section) {
  if (has(w, WORLD_DRIVES) && once_in(w, 2))
    put(w, section, ", damping_ratio: %.17g", between(w, 0.01, 0.3));
  else
    put(w, section, ", damping: %.17g", between(w, 0.1, 2));
}

static void put_structure(random_world *w) {
  char law[240];
  put_nodes(w);
  for (int i = 0; i < w->ring; i++) {
    put(w, MEMBERS, "  ring%d: {kind: %s, nodes: [n%d, n%d], mass: %.17g, %s: %.17g", i,
        once_in(w, 2) ? "bar" : "spring", i, (i + 1) % w->ring, between(w, 0, 0.5),
        once_in(w, 2) ? "stiffness" : "axial_stiffness", between(w, 150, 300));
    put_damping(w, MEMBERS);
    put(w, MEMBERS, ", rest_length_ratio: %.17g}\n", between(w, 0.9, 1.1));
  }
  bool slack = !has(w, WORLD_SMOOTH);               /* it may get slack */
  bool axial = has(w, WORLD_DRIVES) && w->ring % 2; /* a winch drives its rest length */
  put(w, MEMBERS, "  rope: {kind: cable, nodes: [n0, n2, n4, n3], %s, mass: 0.3",
      axial ? "axial_stiffness: 240" : "stiffness: 80");
  put_damping(w, MEMBERS);
  put(w, MEMBERS, ", rest_length_ratio: %.17g}\n", slack ? between(w, 0.8, 1.05) : 0.6);
  for (int k = 0; k < 3; k++) {
    int a = below(w, w->ring);
    put(w, MEMBERS, "  tie%d: {kind: spring, nodes: [n%d, n%d], %s", k, a, across(w, a, 2),
        put_law(w, law, sizeof law));
    put(w, MEMBERS, ", damping: %.17g, rest_length_ratio: %.17g}\n", between(w, 0.1, 1),
        between(w, 0.8, 1.1));
  }
  for (int i = w->ring; i < w->nodes; i++) /* inner nodes hang on three springs each */
    for (int k = 0; k < 3; k++)
      put(w, MEMBERS,
          "  in%d_%d: {kind: spring, nodes: [n%d, n%d], stiffness: %.17g, damping: 0.2}\n", i, k, i,
          (2 * k + i) % w->ring, between(w, 20, 80));
  put(w, MEMBERS, "  inner: {kind: bar, nodes: [n%d, n%d], stiffness: 300, mass: 0.2}\n", w->ring,
      w->ring + 1);
  for (int k = 0; k < 2; k++) {
    int b = below(w, w->ring);
    put(w, HINGES, "  hinge%d: {nodes: [n%d, n%d, n%d], damping: %.17g", k,
        (b + w->ring - 1) % w->ring, b, (b + 1) % w->ring, between(w, 0, 0.3));
    put(w, HINGES, "%s%.17g%s}\n",
        k ? ", law: {kind: polynomial, coefficients: [" : ", stiffness: ", between(w, 5, 20),
        k ? ", 1, 9]}" : "");
  }
}

/* ---- cells and collisions ---- */

static void put_bodies(random_world *w) {
  put(w, CELLS, "  balloon: {nodes: [n0");
  for (int i = 1; i < w->ring; i++) put(w, CELLS, ", n%d", i);
  if (once_in(w, 2))
    put(w, CELLS, "], gas: {kind: isothermal, pressure: %.17g, outside: %.17g}}\n",
        between(w, 50, 150), between(w, 50, 150));
  else
    put(w, CELLS, "], gas: {kind: isentropic, exponent: %.17g, pressure: %.17g, outside: %.17g}}\n",
        between(w, 1.1, 1.7), between(w, 50, 150), between(w, 50, 150));
  put(w, CELLS, "  sail: {nodes: [n4, n%d, n2], pressure: %.17g}\n", w->ring, between(w, -20, 20));
  put(w, CELLS, "  pad: {nodes: [n0");
  for (int i = 1; i < w->ring; i++) put(w, CELLS, ", n%d", i);
  put(w, CELLS, "], damping: 0.7, %s}\n",
      w->ring % 2            ? "law: {kind: polynomial, coefficients: [9, 3, 7]}"
      : has(w, WORLD_SMOOTH) ? "stiffness: 6, rest_area: 2.5"
                             : "stiffness: 9, law: compression_only, rest_area: 3");
  put(w, ACTUATORS, "  blow: {cell: sail, signal: breath}\n");
  put(w, SIGNALS, "  breath: {sine: {amplitude: %.17g, frequency: 3}}\n", between(w, 1, 9));
  if (has(w, WORLD_SMOOTH)) return;
  static const char *const pair[] = {"node: n%d, member: ring2", "nodes: [n%d, n3]",
                                     "members: [inner, ring3]", "members: [inner, ring4]"};
  for (int k = 0; k < 4; k++) {
    char who[64];
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
    snprintf(who, sizeof who, pair[k], w->ring + k % 2);
#pragma GCC diagnostic pop
    put(w, COLLISIONS, "  hit%d: {%s, thickness: %.17g, stiffness: %.17g, damping: %.17g}\n", k,
        who, between(w, 0.2, 1.2), between(w, 30, 200), between(w, 0, 3));
  }
}

static void put_distances(random_world *w) {
  bool smooth = has(w, WORLD_SMOOTH);
  put(w, DISTANCES,
      "  ahead: {nodes: [n1, n4], along: %.17g deg, damping: %.17g, law: {kind: polynomial, "
      "coefficients: [%.17g, 0, %.17g]}}\n",
      between(w, -180, 180), between(w, 0, 1), between(w, 2, 12), between(w, 0, 50));
  put(w, DISTANCES,
      "  high: {nodes: [n%d, n2], along: y, stiffness: %.17g, rest_distance: %.17g%s}\n", w->ring,
      between(w, 2, 12), between(w, -1, 1), smooth ? "" : ", damping: 0.5, law: compression_only");
  put(w, DISTANCES, "  aside: {node: n3, line: [n0, n5], stiffness: %.17g, damping: %.17g%s}\n",
      between(w, 2, 12), between(w, 0, 1), smooth ? "" : ", law: {kind: play, gap: 0.05}");
}

/* ---- grounds ---- */

static bool put_friction(random_world *w) {
  double mu = between(w, 0.2, 0.8);
  bool smooth = once_in(w, 2);
  if (once_in(w, 3)) return false;
  const char *curve = w->ring % 2 ? "smooth" : "stribeck, decay_velocity: 0.4";
  put(w, GROUNDS, ", friction: {law: %s", smooth ? curve : "karnopp");
  if (once_in(w, 2))
    put(w, GROUNDS, ", mu_forward: %.17g, mu_backward: %.17g", mu, between(w, 0.2, 0.8));
  else
    put(w, GROUNDS, ", mu_static: %.17g, mu_kinetic: %.17g", 1.2 * mu, mu);
  put(w, GROUNDS, ", %s: %.17g}", smooth ? "width" : "stick_velocity", between(w, 0.1, 0.5));
  return true;
}

static void put_ground(random_world *w, int first, int last) {
  bool light = has(w, WORLD_LIGHT);
  put(w, GROUNDS, ", stiffness: %.17g", light ? between(w, 2e3, 5e3) : between(w, 100, 400));
  if (once_in(w, 2))
    put(w, GROUNDS, ", damping: %.17g", between(w, 0, 5));
  else
    put(w, GROUNDS, ", damping_law: hunt_crossley, dissipation: %.17g", between(w, 0, 2));
  double belt = once_in(w, 2) ? between(w, -1, 1) : 0.0;
  if (put_friction(w) && belt != 0.0) put(w, GROUNDS, ", belt_speed: %.17g", belt);
  put(w, GROUNDS, ", nodes: [");
  for (int i = first; i <= last; i++) put(w, GROUNDS, "%sn%d", i > first ? ", " : "", i);
  put(w, GROUNDS, "]}\n");
}

static void put_grounds(random_world *w) {
  int last = w->nodes - 1;
  double low = has(w, WORLD_LIGHT) ? 0.3 : 0; /* how much further away they are */
  put(w, GROUNDS, "  floor: {height: %.17g, slope: %.17g", between(w, -0.9, -0.5) - 2 * low,
      between(w, -0.3, 0.3));
  put_ground(w, 2, last);
  put(w, GROUNDS, "  wall: {through: [%.17g, %.17g], %s", between(w, -1, -0.7) - low,
      between(w, -1, 1), once_in(w, 2) ? "slope: -95 deg" : "normal: [3, 0.4]");
  put_ground(w, 3, last);
  put(w, GROUNDS, "  stone: {circle: {centre: [%.17g, %.17g], radius: %.17g}", between(w, -1, 1),
      between(w, -1.2, -0.6) - 1.5 * low, between(w, 0.2, 0.6) - low / 2);
  put_ground(w, 4, last);
  put(w, GROUNDS,
      "  hoop: {circle: {centre: [%.17g, %.17g], radius: %.17g, inside: yes}, "
      "motion: {x: sway, y: breathe}",
      between(w, -0.1, 0.1), between(w, -0.1, 0.1), between(w, 0.85, 1.2) + low);
  put_ground(w, 2, w->ring - 1);
  put(w, GROUNDS, "  stairs: {profile: [");
  for (int k = 0; k < 7; k++)
    put(w, GROUNDS, "%s[%.17g, %.17g]", k ? ", " : "", 0.5 * (k - 3) + between(w, -0.15, 0.15),
        between(w, -0.9, -0.5) - 1.8 * low);
  put(w, GROUNDS, "], motion: {y: breathe}");
  put_ground(w, 2, last);
  put(w, SIGNALS, "  sway: {sine: {amplitude: %.17g, frequency: 2}}\n", between(w, 0.01, 0.1));
  put(w, SIGNALS, "  breathe: {sum: [sway, {sine: {amplitude: 0.05, frequency: 3.1}}]}\n");
}

/* ---- drives ---- */

static void put_drives(random_world *w) {
  put(w, SIGNALS, "  shake: {sine: {amplitude: %.17g, frequency: 1.7}}\n", between(w, 0.02, 0.1));
  put(w, SIGNALS, "  lift: {sum: [shake, {sine: {amplitude: 0.03, frequency: 2.9}}]}\n");
  put(w, SIGNALS,
      "  turn: {sum: [{ramp: {amplitude: 40, stop: 3}}, {sine: {amplitude: 0.5, frequency: "
      "2}}]}\n");
  put(w, SIGNALS, "  push: {table: [[0, 0], [0.7, %.17g], [2, -5]]}\n", between(w, 3, 9));
  put(w, SIGNALS, "  pulse: {half_sine: {amplitude: 0.1, frequency: 0.6}}\n");
  put(w, SIGNALS, "  kick: {square: {amplitude: 0.2, frequency: 0.9}}\n");
  put(w, SIGNALS, "  gust: {square: {amplitude: 0.2, frequency: 1.9, phase: 0.3}}\n");
  put(w, SIGNALS, "  nod: {half_sine: {amplitude: 0.1, frequency: 0.6, start: 50.3 ms}}\n");
  put(w, UNBALANCES, "  rotor: {node: n3, mass: 0.3, radius: %.17g, speed: %.17g, phase: 50 deg}\n",
      between(w, 0.05, 0.3), between(w, 5, 20));
  put(w, UNBALANCES, "  motor: {node: n4, mass: 0.2, radius: 0.1, angle: turn}\n");
  put(w, ACTUATORS, "  piston: {member: ring2, force: push}\n");
  put(w, ACTUATORS, "  hoist: {member: rope, force: push}\n");
  put(w, ACTUATORS, "  winch: {member: rope, signal: pulse}\n");
  put(w, ACTUATORS, "  jack: {member: tie0, signal: shake}\n");
  put(w, ACTUATORS, "  knee: {hinge: hinge0, moment: kick}\n");
  put(w, ACTUATORS, "  servo: {hinge: hinge1, signal: nod}\n");
  put(w, LOADS, "  wind: {node: n2, force: [%.17g, 2], signal: gust}\n", between(w, -3, 3));
  put(w, OTHERS, "rayleigh: {mass: %.17g, stiffness: %.17g}\n", between(w, 0, 0.5),
      between(w, 0, 2e-3));
  put(w, OTHERS, "mass_model: %s\n", once_in(w, 3) ? "lumped" : "consistent");
}

/* ---- feedback ---- */

/* A number without a unit; the deeper, the simpler. */
static size_t grow(random_world *w, const char *const *atoms, int count, int depth, char *text,
                   size_t room) {
  static const char *const pattern[] = {"sin(%)",
                                        "cos(%)",
                                        "atan(%)/(1 rad)",
                                        "sqrt(1 + (%)^2)",
                                        "(% + %)",
                                        "(% - 0.5*%)",
                                        "% * %",
                                        "(%) / (3 + cos(%))",
                                        "exp(-(%)^2)",
                                        "max(%, %)",
                                        "min(%, 0.3)",
                                        "hypot(%, 1 + %)",
                                        "-abs(%)",
                                        "atan2(%, 2 + %)/(1 rad)",
                                        "(1.5 + sin(%))^(0.2 * %)"};
  const char *from = pattern[below(w, (int)(sizeof pattern / sizeof pattern[0]))];
  size_t used = 0;
  if (depth == 0 || once_in(w, 4)) from = atoms[below(w, count)];
  for (; *from; from++) {
    if (*from == '%')
      used += grow(w, atoms, count, depth - 1, text + used, room - used);
    else
      text[used++] = *from;
    assert_true(used + 1 < room);
  }
  text[used] = '\0';
  return used;
}

static const char *const PLACES[] = {"t/(1 s)",    "(l/(1 m))", "angle/(1 rad)", "x/(1 m)", "0.7",
                                     "wave/(1 m)", "z",         "phase/(1 rad)", "2"};
static const char *const RATES[] = {
    "vy/(1 m/s)", "f/(10 N)",        "kinetic/(9 J)", "touch",
    "l/(1 m)",    "rate(l)/(1 m/s)", "slow/(1 m)",    "rate(angle)/(1 rad/s)"};
enum {
  PLACE_COUNT = sizeof PLACES / sizeof PLACES[0],
  RATE_COUNT = sizeof RATES / sizeof RATES[0]
};

/* Remembers the text of an expression under its name; `format` has one %s for the grown part. */
static const char *remember(random_world *w, const char *name, const char *before,
                            const char *const *atoms, int count, const char *after) {
  char grown[1000];
  assert_true(w->text_count < WORLD_TEXTS);
  slow_text *t = &w->texts[w->text_count++];
  do grow(w, atoms, count, 2, grown, sizeof grown);
  while (strlen(grown) > 90);
  snprintf(t->name, sizeof t->name, "%s", name);
  int length = snprintf(t->text, sizeof t->text, "%s%s%s", before, grown, after);
  assert_true(length > 0 && (size_t)length < sizeof t->text);
  return t->text;
}

static void put_feedback(random_world *w) {
  put(w, SENSORS,
      "  l: {length: rope}\n  angle: {angle: hinge0}\n  x: {position: n3, along: x}\n"
      "  vy: {velocity: n4, along: y}\n  f: {force: ring2}\n  kinetic: {energy: kinetic}\n"
      "  touch: {contact: n%d}\n",
      w->ring + 1);
  put(w, SIGNALS, "  wave: {sine: {amplitude: 0.1 m, frequency: 1.3}}\n");
  put(w, SIGNALS, "  follow: {expression: \"%s\"}\n",
      remember(w, "follow", "0.1 m*sin(", PLACES, PLACE_COUNT, ")"));
  put(w, SIGNALS, "  bend: {expression: \"%s\"}\n",
      remember(w, "bend", "0.2 rad*sin(", PLACES, PLACE_COUNT, ")"));
  put(w, SIGNALS, "  slow: {expression: \"%s\", lag: %.17g}\n",
      remember(w, "slow", "0.1 m*cos(", PLACES, PLACE_COUNT, ")"), between(w, 0.05, 0.5));
  put(w, SIGNALS, "  react: {expression: \"%s\"}\n",
      remember(w, "react", "", RATES, RATE_COUNT, ""));
  put(w, SIGNALS, "  thrust: {expression: \"%s\"}\n",
      remember(w, "thrust", "3 N*sin(", RATES, RATE_COUNT, ")"));
  put(w, SIGNALS, "  both: {sum: [wave, {sum: [slow, follow]}]}\n");
  put(w, STATES, "  z: {rate: \"%s\", start: %.17g}\n",
      remember(w, "z", "0.5/(1 s)*sin(", PLACES, PLACE_COUNT, ")"), between(w, -1, 1));
  put(w, OSCILLATORS,
      "  phase: {frequency: 1 Hz, phase: 20 deg, coupling: {other: 2 rad/s}, bias: 30 deg}\n"
      "  other: {frequency: 1.2 Hz, coupling: {phase: 1.5}, feedback: \"0.3 rad/s*sin(z)\"}\n");
  static const char *const rates[][2] = {
      {"phase", "2*pi*1 + 2*sin(other - phase - pi/6)"},
      {"other", "2*pi*1.2 + 1.5*sin(phase - other) + 0.3*sin(z)"}};
  for (int k = 0; k < 2; k++) {
    slow_text *t = &w->texts[w->text_count++];
    snprintf(t->name, sizeof t->name, "%s", rates[k][0]);
    snprintf(t->text, sizeof t->text, "%s", rates[k][1]);
  }
  put(w, ACTUATORS,
      "  pace: {member: ring3, signal: both}\n  curl: {hinge: hinge0, signal: bend}\n");
  put(w, ACTUATORS, "  reflex: {member: tie1, force: thrust}\n");
  put(w, LOADS, "  lift: {node: n2, force: [1, 2], signal: react}\n");
  for (int k = 0; k < 2; k++)
    put(w, MEMBERS,
        "  gel%d: {kind: %s, nodes: [n%d, n%d], stiffness: 20, maxwell: {stiffness: %.17g, %s: "
        "%.17g, force: %.17g}}\n",
        k, k ? "bar" : "spring", k, k + 3, between(w, 20, 90), k ? "time" : "damping",
        between(w, 0.3, 3), between(w, -3, 3));
  put(w, ACTUATORS, "  melt: {member: gel1, signal: both}\n");
}

static void put_samples(random_world *w) {
  double gain = between(w, 0.1, 0.5), most = between(w, 0.01, 0.1);
  put(w, SIGNALS, "  stairs: {sine: {amplitude: 0.1, frequency: 2}, every: 4 ms}\n");
  put(w, SENSORS, "  held: {length: ring4}\n");
  put(w, CONTROLLERS,
      "  hold: {sensor: held, target: 0.9 m, gain: %.17g, integral: 2 Hz, least: %.17g, most: "
      "%.17g}\n",
      gain, -most, most);
  put(w, ACTUATORS,
      "  keep: {member: ring4, signal: hold}\n  step: {member: ring2, signal: stairs}\n");
  slow_text *t = &w->texts[w->text_count++];
  snprintf(t->name, sizeof t->name, "hold");
  snprintf(t->text, sizeof t->text, "min(max(%.17g*(0.9 - held) + 2*hold_integral, %.17g), %.17g)",
           gain, -most, most);
  t = &w->texts[w->text_count++];
  snprintf(t->name, sizeof t->name, "hold_integral");
  snprintf(t->text, sizeof t->text,
           "0.9 - held + (hold - (%.17g*(0.9 - held) + 2*hold_integral))/%.17g", gain, gain);
}

/* ---- memory ---- */

static void put_memory(random_world *w) {
  put(w, MEMBERS,
      "  absorber: {kind: spring, nodes: [n1, n4], stiffness: 100, damping: 0.2, law: {kind: "
      "elastic_plastic, "
      "yield: %.17g, second_stiffness: %.17g}}\n",
      between(w, 1, 6), once_in(w, 2) ? 0.0 : between(w, 5, 40));
  put(w, MEMBERS,
      "  string: {kind: cable, nodes: [n1, n3], stiffness: 60, pretension: 1, breaks_at: %.17g, "
      "longest: %.17g, stop_stiffness: 300}\n",
      between(w, 2, 9), between(w, 1.7, 1.9));
  put(w, MEMBERS,
      "  latch: {kind: spring, nodes: [n0, n4], stiffness: 90, pretension: 5, released_at: %.17g, "
      "longest: 2.5}\n",
      between(w, 0.01, 0.15));
  put(w, MEMBERS,
      "  belt: {kind: cable, nodes: [n1, n%d, n%d, n4, n5], stiffness: 60, damping: %.17g, "
      "pretension: %.17g, guide_friction: %.17g}\n",
      w->ring, w->ring + 1, once_in(w, 2) ? 0.0 : 0.1, between(w, 1, 9), between(w, 0.05, 0.4));
  put(w, HINGES,
      "  fuse: {nodes: [n2, n3, n4], stiffness: 20, damping: 0.1, law: {kind: elastic_plastic, "
      "yield: %.17g}}\n",
      between(w, 0.3, 2));
  put(w, HINGES, "  snap: {nodes: [n3, n4, n5], stiffness: 9, breaks_at: %.17g}\n",
      between(w, 0.5, 3));
  put(w, SIGNALS, "  reel: {sine: {amplitude: 0.1, frequency: 1.1}}\n");
  put(w, ACTUATORS,
      "  winder: {member: belt, signal: reel}\n  presser: {member: absorber, signal: reel}\n");
}

static void assemble(random_world *w) {
  size_t used = 0;
  for (int k = 0; k < SECTION_COUNT; k++) {
    if (!w->section[k][0]) continue;
    bool bare = k == OTHERS;
    int length = snprintf(w->text + used, sizeof w->text - used, "%s%s%s", bare ? "" : KEYS[k],
                          bare ? "" : ":\n", w->section[k]);
    assert_true(length > 0 && (size_t)length < sizeof w->text - used);
    used += (size_t)length;
  }
}

void random_world_make(random_world *w, uint64_t seed, unsigned parts) {
  *w = (random_world){.parts = parts, .random = seed ^ 0x5851f42d4c957f2du};
  w->ring = 6 + below(w, 2), w->nodes = w->ring + 2;
  put(w, OTHERS, "strut: 1\ngravity: [%.17g, %.17g]\n", between(w, -1, 1), between(w, -9, 0));
  put_structure(w);
  if (has(w, WORLD_BODIES)) put_bodies(w);
  if (has(w, WORLD_BODIES)) put_distances(w);
  if (has(w, WORLD_GROUNDS)) put_grounds(w);
  if (has(w, WORLD_DRIVES)) put_drives(w);
  if (has(w, WORLD_FEEDBACK)) put_feedback(w);
  if (has(w, WORLD_SAMPLES)) put_samples(w);
  if (has(w, WORLD_MEMORY)) put_memory(w);
  put(w, OTHERS, "solver: {step: 1 ms}\nrun: {duration: 0.2}\n");
  assemble(w);
}
