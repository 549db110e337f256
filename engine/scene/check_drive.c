/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules about ground, signals, drives, loads and the experiment. See check.h. */
#include <math.h>
#include <stdio.h>

#include "engine/scene/check_rules.h"
#include "engine/scene/profile.h"
#include "engine/scene/signal_motion.h"
#include "engine/scene/signal_program.h"

enum { MOST_TERMS = 10000, DEEPEST_SUM = 64 };

static const double QUARTER_TURN = 1.57079632679489661923;

static bool check_table(strut_checker *checker, size_t index, const char *owner) {
  const strut_signal *s = &checker->scene->signals[index];
  if (!s->point_count) {
    strut_report_finding(checker, STRUT_ON_SIGNAL, index, "table", "the table of %s has no points",
                         owner);
    return false;
  }
  for (size_t i = 0; i < s->point_count; i++) {
    if (!isfinite(s->time[i]) || !isfinite(s->value[i]))
      strut_report_finding(checker, STRUT_ON_SIGNAL, index, "table",
                           "point %zu in the table of %s is not finite", i + 1, owner);
    else if (i && s->time[i] <= s->time[i - 1])
      strut_report_finding(
          checker, STRUT_ON_SIGNAL, index, "table",
          "the times in the table of %s must increase, but point %zu at %g s follows %g s", owner,
          i + 1, s->time[i], s->time[i - 1]);
    else
      continue;
    return false;
  }
  return true;
}

/* Signal that part i of a sum or an expression refers to; -1: it refers to none. */
static int32_t part_of(const strut_signal *s, size_t i) {
  if (s->kind == STRUT_SUM) return s->terms[i];
  const strut_instruction *p = &s->program.instruction[i];
  bool refers = p->operation == STRUT_OPERATION_COLUMN && p->column.kind == STRUT_COLUMN_SIGNAL;
  return refers ? p->column.item : -1;
}

static size_t part_count(const strut_signal *s) {
  if (s->kind == STRUT_SUM) return s->term_count;
  return strut_signal_has_program(s) ? s->program.length : 0;
}

/* Counts parts and depth of a sum or an expression, whose signals have been checked before. */
static bool check_sum(strut_checker *checker, size_t index, const char *owner, uint32_t *size,
                      uint32_t *depth) {
  const strut_signal *s = &checker->scene->signals[index];
  uint64_t terms = 1;
  if (strut_signal_has_program(s) && !strut_check_program(checker, index, owner)) return false;
  if (s->kind == STRUT_RELAY && !strut_check_relay(checker, index, owner)) return false;
  if (s->kind == STRUT_SUM && !s->term_count) {
    strut_report_finding(checker, STRUT_ON_SIGNAL, index, "sum", "the sum of %s has no terms",
                         owner);
    return false;
  }
  for (size_t i = 0; i < part_count(s); i++) {
    int32_t term = part_of(s, i);
    if (term < 0 && strut_signal_has_program(s)) continue;
    if (term < 0 || (size_t)term >= index) {
      strut_report_finding(checker, STRUT_ON_SIGNAL, index, "sum",
                           "term %zu of %s is not a signal that comes before it", i + 1, owner);
      return false;
    }
    if (checker->wild[term]) return false; /* reported there */
    terms += size[term];
    if (depth[term] >= depth[index]) depth[index] = depth[term] + 1;
  }
  size[index] = terms > MOST_TERMS ? MOST_TERMS + 1 : (uint32_t)terms;
  if (terms <= MOST_TERMS && depth[index] <= DEEPEST_SUM) return true;
  strut_report_finding(checker, STRUT_ON_SIGNAL, index, NULL,
                       "%s has more than %d terms, or sums within sums more than %d deep", owner,
                       MOST_TERMS, DEEPEST_SUM);
  return false;
}

/* Checks the numbers of a waveform. */
static bool check_wave(strut_checker *checker, size_t index, const char *owner) {
  const strut_signal *s = &checker->scene->signals[index];
  bool wave = s->kind == STRUT_SINE || s->kind == STRUT_HALF_SINE || s->kind == STRUT_SQUARE;
  const strut_checked whose = {STRUT_ON_SIGNAL, index, owner, NULL};
  const struct {
    const char *key;
    double value;
  } numbers[] = {{"amplitude", s->amplitude}, {"phase", s->phase}, {"start", s->start}};
  bool valid = true; /* as of a sine, whatever the wave */
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
    valid =
        strut_check_number(checker, &whose, STRUT_FIELDS_SINE, numbers[i].key, numbers[i].value) &&
        valid;
  if (wave)
    valid =
        strut_check_number(checker, &whose, STRUT_FIELDS_SINE, "frequency", s->frequency) && valid;
  if (!valid) return false;
  if (s->kind == STRUT_RAMP && !isfinite(s->stop))
    strut_report_finding(checker, STRUT_ON_SIGNAL, index, "stop", "%s needs a stop", owner);
  else if (!(s->stop > s->start))
    strut_report_finding(checker, STRUT_ON_SIGNAL, index, "stop",
                         "the stop of %s must come after its start, found %g s after %g s", owner,
                         s->stop, s->start);
  else
    return true;
  return false;
}

/* Times at which a signal jumps per second; tables and ramps jump as often as they are long. */
static double jump_rate(const strut_signal *s) {
  double rate = s->kind == STRUT_SQUARE ? 2.0 * s->frequency : 0.0;
  return s->every > 0.0 ? fmax(rate, 1.0 / s->every) : rate;
}

/* A run stops at each jump: more of them than this in a step, or in a run without one, are a mistake. */
static const double MOST_JUMPS_OF_STEP = 1e3, MOST_JUMPS_OF_RUN = 1e9;

static void check_jumps(strut_checker *checker, size_t index, const char *owner) {
  const strut_experiment *e = checker->experiment;
  const strut_signal *s = &checker->scene->signals[index];
  bool step = e->step > 0.0 && isfinite(e->step);
  double rate = jump_rate(s), span = step ? e->step : e->duration;
  if (checker->purpose != STRUT_FOR_RUN || !(span > 0.0 && isfinite(span))) return;
  if (rate * span <= (step ? MOST_JUMPS_OF_STEP : MOST_JUMPS_OF_RUN)) return;
  bool sampled = s->every > 0.0 && s->every * rate <= 1.0;
  strut_report_finding(
      checker, STRUT_ON_SIGNAL, index, sampled ? "every" : "frequency",
      "%s jumps %.3g times within %s of %g s, expected at most %g; give %s%s", owner, rate * span,
      step ? "a step" : "the run", span, step ? MOST_JUMPS_OF_STEP : MOST_JUMPS_OF_RUN,
      sampled ? "a longer 'every'" : "a lower frequency", step ? " or a smaller step" : "");
}

/* Formats the name of a signal for messages: its own, or that of its first user. */
static void call_signal(char owner[200], const strut_scene *scene, const size_t *user, size_t i) {
  char thing[200];
  size_t u = user[i];
  if (scene->signals[i].name || !u) {
    strut_format_name(owner, "signal", scene->signals[i].name, i);
    return;
  }
  size_t drives = scene->actuator_count + scene->load_count;
  if (u > drives) {
    int32_t node = scene->support_motions[u - 1 - drives].node;
    strut_format_name(thing, "node", scene->nodes[node].name, (size_t)node);
    snprintf(owner, 200, "the signal of %.180s", thing);
    return;
  }
  bool actuator = u <= scene->actuator_count;
  size_t index = actuator ? u - 1 : u - 1 - scene->actuator_count;
  strut_format_name(thing, actuator ? "actuator" : "load",
                    actuator ? scene->actuators[index].name : scene->loads[index].name, index);
  snprintf(owner, 200, "the signal of %.180s", thing);
}

/*
 * Finds for each signal 1 + the number of the actuator that uses it, loads and moving supports counted
 * on; 0: none.
 */
static void find_users(const strut_scene *scene, size_t *user) {
  for (size_t i = scene->support_motion_count; i-- > 0;) {
    const strut_support_motion *m = &scene->support_motions[i];
    if (m->signal >= 0 && (size_t)m->signal < scene->signal_count && m->node >= 0 &&
        (size_t)m->node < scene->node_count)
      user[m->signal] = 1 + scene->actuator_count + scene->load_count + i;
  }
  for (size_t i = scene->load_count; i-- > 0;)
    if (scene->loads[i].signal >= 0 && (size_t)scene->loads[i].signal < scene->signal_count)
      user[scene->loads[i].signal] = 1 + scene->actuator_count + i;
  for (size_t i = scene->actuator_count; i-- > 0;)
    if (scene->actuators[i].signal >= 0 && (size_t)scene->actuators[i].signal < scene->signal_count)
      user[scene->actuators[i].signal] = 1 + i;
  for (size_t i = scene->signal_count; i-- > 0;) /* terms precede their sum */
    for (size_t t = 0; t < part_count(&scene->signals[i]); t++) {
      int32_t term = part_of(&scene->signals[i], t);
      if (term >= 0 && (size_t)term < i && !user[term]) user[term] = user[i];
    }
}

void strut_check_signals(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  uint32_t *size = strut_allocate(scene->signal_count, sizeof *size);
  uint32_t *depth = strut_allocate(scene->signal_count, sizeof *depth);
  size_t *user = strut_allocate(scene->signal_count, sizeof *user);
  if (!size || !depth || !user) checker->out_of_memory = true;
  if (!checker->out_of_memory) find_users(scene, user);
  for (size_t i = 0; !checker->out_of_memory && i < scene->signal_count; i++) {
    const strut_signal *s = &scene->signals[i];
    char owner[200];
    call_signal(owner, scene, user, i);
    size[i] = depth[i] = 1;
    if ((unsigned)s->kind >= STRUT_SIGNAL_KINDS) {
      strut_report_finding(checker, STRUT_ON_SIGNAL, i, NULL, "%s is of an unknown kind", owner);
      checker->wild[i] = true;
      continue;
    }
    bool modified = strut_check_modifiers(checker, i, owner);
    checker->wild[i] = !modified || (s->kind == STRUT_TABLE ? !check_table(checker, i, owner)
                                     : s->kind == STRUT_SUM || strut_signal_has_program(s)
                                         ? !check_sum(checker, i, owner, size, depth)
                                         : !check_wave(checker, i, owner));
    if (!checker->wild[i]) check_jumps(checker, i, owner);
  }
  strut_release(size);
  strut_release(depth);
  strut_release(user);
}

static void check_friction(strut_checker *checker, size_t index, const char *owner) {
  const strut_friction *f = &checker->scene->contacts[index].friction;
  if ((unsigned)f->law >= STRUT_FRICTION_LAW_COUNT) {
    strut_report_finding(checker, STRUT_ON_CONTACT, index, "law",
                         "the friction law of %s is unknown", owner);
    return;
  }
  const strut_checked whose = {STRUT_ON_CONTACT, index, owner, NULL};
  const strut_friction none = {0};
  strut_check_fields(checker, &whose, STRUT_FIELDS_FRICTION, f, &none);
  for (int p = 0; p < STRUT_FRICTION_PARAMETER_COUNT; p++)
    if (strut_friction_needs(f->law, p) && strut_friction_value(f, p) == 0.0)
      strut_check_number(checker, &whose, STRUT_FIELDS_FRICTION, strut_friction_key(p), 0.0);
}

static void check_line(strut_checker *checker, size_t index, const char *owner) {
  const strut_ground *g = &checker->scene->grounds[index];
  const strut_checked whose = {STRUT_ON_GROUND, index, owner, NULL};
  strut_check_number(checker, &whose, STRUT_FIELDS_GROUND, "height", g->height);
  strut_check_number(checker, &whose, STRUT_FIELDS_GROUND, "slope", g->slope);
  for (int c = 0; c < 2; c++)
    strut_check_number(checker, &whose, STRUT_FIELDS_GROUND, "through", g->through[c]);
  if (!g->placed && fabs(cos(g->slope)) < 1e-12)
    strut_report_finding(checker, STRUT_ON_GROUND, index, "slope",
                         "%s is upright, so that it has no height at x = 0; give a point of it, "
                         "through: [x, y]",
                         owner);
}

static void check_profile(strut_checker *checker, size_t index, const char *owner) {
  size_t segment, other;
  strut_profile_fault fault =
      strut_profile_check(&checker->scene->grounds[index], &segment, &other);
  switch (fault) {
    case STRUT_PROFILE_FINE: break;
    case STRUT_PROFILE_NO_MEMORY: checker->out_of_memory = true; break;
    case STRUT_PROFILE_SHORT:
      strut_report_finding(checker, STRUT_ON_GROUND, index, "profile",
                           "the profile of %s needs at least two points", owner);
      break;
    case STRUT_PROFILE_POINT:
      strut_report_finding(checker, STRUT_ON_GROUND, index, "profile",
                           "point %zu of the profile of %s is not finite", segment + 1, owner);
      break;
    case STRUT_PROFILE_ZERO:
      strut_report_finding(checker, STRUT_ON_GROUND, index, "profile",
                           "points %zu and %zu of the profile of %s are one point", segment + 1,
                           segment + 2, owner);
      break;
    case STRUT_PROFILE_BACK:
      strut_report_finding(checker, STRUT_ON_GROUND, index, "profile",
                           "the profile of %s turns back onto itself at point %zu", owner,
                           segment + 1);
      break;
    case STRUT_PROFILE_CROSSES:
      strut_report_finding(checker, STRUT_ON_GROUND, index, "profile",
                           "the profile of %s crosses itself: its segments %zu and %zu meet; its "
                           "ends continue straight",
                           owner, other + 1, segment + 1);
      break;
  }
}

/* A displacement that jumps would take the ground through nodes. */
static void check_motion(strut_checker *checker, size_t index, const char *owner) {
  const strut_scene *scene = checker->scene;
  const strut_ground *g = &scene->grounds[index];
  double when;
  for (int c = 0; c < 2; c++) {
    const char *axis = c ? "y" : "x";
    if (!g->moves[c]) continue;
    int32_t signal = g->motion[c];
    if (signal < 0 || (size_t)signal >= scene->signal_count)
      strut_report_finding(checker, STRUT_ON_GROUND, index, "motion",
                           "the motion of %s in %s has no signal", owner, axis);
    else if (!checker->wild[signal] && !strut_signal_is_wave(scene->signals, signal))
      strut_report_finding(
          checker, STRUT_ON_GROUND, index, "motion",
          "the motion of %s in %s is an expression, a lag, samples or a start, whose "
          "acceleration is not known; use waves, ramps, tables and sums of them",
          owner, axis);
    else if (!checker->wild[signal] &&
             strut_signal_value_jumps(scene->signals, signal, HUGE_VAL, &when))
      strut_report_finding(checker, STRUT_ON_GROUND, index, "motion",
                           "the motion of %s in %s jumps; use a ramp, a table, or waves that begin "
                           "and stop at zero",
                           owner, axis);
  }
}

static void check_grounds(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  if (scene->ground.present)
    strut_report_finding(checker, STRUT_ON_GROUND, 0, NULL, "there are both a ground and grounds");
  for (size_t i = 0; i < scene->ground_count; i++) {
    const strut_ground *g = &scene->grounds[i];
    bool single = scene->ground_count == 1 && !(g->name && *g->name), used = false;
    char owner[200];
    if (single)
      snprintf(owner, sizeof owner, "the ground");
    else
      strut_format_name(owner, "ground", g->name, i);
    const strut_checked whose = {STRUT_ON_GROUND, i, owner, NULL};
    const strut_checked circle = {STRUT_ON_GROUND, i, owner, "circle"};
    strut_check_number(checker, &whose, STRUT_FIELDS_GROUND, "belt_speed", g->belt_speed);
    if ((unsigned)g->damping_law >= STRUT_DAMPING_COUNT)
      strut_report_finding(checker, STRUT_ON_GROUND, i, "damping_law",
                           "the damping law of %s is unknown", owner);
    switch (g->shape) {
      case STRUT_GROUND_LINE: check_line(checker, i, owner); break;
      case STRUT_GROUND_PROFILE: check_profile(checker, i, owner); break;
      case STRUT_GROUND_CIRCLE:
        for (int c = 0; c < 2; c++)
          strut_check_number(checker, &circle, STRUT_FIELDS_CIRCLE, "centre", g->centre[c]);
        strut_check_number(checker, &circle, STRUT_FIELDS_CIRCLE, "radius", g->radius);
        break;
    }
    check_motion(checker, i, owner);
    for (size_t k = 0; k < scene->contact_count; k++)
      used = used || scene->contacts[k].ground == (int32_t)i;
    if (!used)
      strut_report_finding(checker, STRUT_ON_GROUND, i, "nodes", "no node may touch %s", owner);
  }
}

/* Contacts follow their nodes, then grounds, then pieces, one of each. */
static bool follows(const strut_contact *before, const strut_contact *c) {
  if (c->node != before->node) return c->node > before->node;
  if (c->ground != before->ground) return c->ground > before->ground;
  return c->piece > before->piece;
}

/* Pieces of each ground; of a profile with faults, which are reported, any number. */
static size_t *count_pieces(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  size_t *pieces = strut_allocate(scene->ground_count + 1, sizeof *pieces), segment, other;
  if (!pieces) checker->out_of_memory = true;
  for (size_t i = 0; i < scene->ground_count && pieces; i++) {
    const strut_ground *g = &scene->grounds[i];
    bool faulty = g->shape == STRUT_GROUND_PROFILE && strut_profile_check(g, &segment, &other);
    pieces[i] = faulty ? SIZE_MAX : strut_ground_pieces(g);
  }
  return pieces;
}

static bool has_surface(const strut_scene *scene, const strut_contact *c, const size_t *pieces) {
  if (!scene->ground_count) return c->ground == 0 && c->piece == 0;
  if (c->ground < 0 || (size_t)c->ground >= scene->ground_count || c->piece < 0) return false;
  return (size_t)c->piece < pieces[c->ground];
}

static void check_contacts(strut_checker *checker, const size_t *pieces) {
  const strut_scene *scene = checker->scene;
  for (size_t i = 0; i < scene->contact_count; i++) {
    const strut_contact *c = &scene->contacts[i];
    if (c->node < 0 || (size_t)c->node >= scene->node_count) {
      strut_report_finding(checker, STRUT_ON_CONTACT, i, NULL,
                           "contact number %zu is of a node that does not exist", i + 1);
      continue;
    }
    char owner[200];
    strut_format_name(owner, "the contact of node", scene->nodes[c->node].name, (size_t)c->node);
    if (i && !follows(&scene->contacts[i - 1], c))
      strut_report_finding(checker, STRUT_ON_CONTACT, i, NULL,
                           "%s is out of order: contacts follow their nodes, one for each at most",
                           owner);
    if (!has_surface(scene, c, pieces))
      strut_report_finding(checker, STRUT_ON_CONTACT, i, NULL,
                           "%s is with a ground, or a piece of one, that does not exist", owner);
    const strut_checked whose = {STRUT_ON_CONTACT, i, owner, NULL};
    strut_check_fields(checker, &whose, STRUT_FIELDS_CONTACT, c, NULL);
    check_friction(checker, i, owner);
  }
}

void strut_check_ground(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const strut_ground *g = &scene->ground;
  const strut_checked whose = {STRUT_ON_GROUND, 0, "the ground", NULL};
  strut_check_number(checker, &whose, STRUT_FIELDS_GROUND, "height", g->height);
  strut_check_number(checker, &whose, STRUT_FIELDS_GROUND, "belt_speed", g->belt_speed);
  if (!(fabs(g->slope) < QUARTER_TURN))
    strut_report_finding(
        checker, STRUT_ON_GROUND, 0, "slope",
        "the slope of the ground must lie between -90 deg and 90 deg, found %g deg; a line at any "
        "angle needs a point, through: [x, y]",
        g->slope / QUARTER_TURN * 90.0);
  if ((unsigned)g->damping_law >= STRUT_DAMPING_COUNT)
    strut_report_finding(checker, STRUT_ON_GROUND, 0, "damping_law",
                         "the ground's damping law is unknown");
  if (g->present && !scene->contact_count)
    strut_report_finding(checker, STRUT_ON_GROUND, 0, "nodes", "no node may touch the ground");
  if (scene->ground_count) check_grounds(checker);
  if (!strut_scene_has_ground(scene) && scene->contact_count)
    strut_report_finding(checker, STRUT_ON_GROUND, 0, NULL, "there are contacts but no ground");
  size_t *pieces = count_pieces(checker);
  if (pieces) check_contacts(checker, pieces);
  strut_release(pieces);
}

static bool exists(int32_t index, size_t count) { return index >= 0 && (size_t)index < count; }

bool strut_is_pulled(const strut_scene *scene, int32_t member, int32_t hinge) {
  for (size_t i = 0; i < scene->actuator_count; i++) {
    const strut_actuator *a = &scene->actuators[i];
    if (a->force && (a->member >= 0 ? a->member == member : a->hinge >= 0 && a->hinge == hinge))
      return true;
  }
  return false;
}

/* What is wrong with where a support moves, or NULL. */
static const char *fault_of_motion(const strut_scene *scene, size_t i) {
  const strut_support_motion *m = &scene->support_motions[i], *last = i ? m - 1 : NULL;
  if (m->axis < 0 || m->axis > 1) return "moves along an axis other than x and y";
  if (!scene->nodes[m->node].fixed[m->axis]) return "moves in a direction in which it is not fixed";
  if (last && (m->node < last->node || (m->node == last->node && m->axis <= last->axis)))
    return "moves out of order: motions follow nodes, x before y, each once";
  if (last && m->node == last->node) return NULL; /* the rest is said of its x */
  if (scene->bar_model == STRUT_BARS_RIGID)
    return "moves, but bars are rigid; make them elastic, bars: elastic";
  for (size_t k = 0; k < scene->contact_count; k++)
    if (scene->contacts[k].node == m->node)
      return "moves and may touch the ground; leave it out of the ground's nodes";
  return NULL;
}

static void check_motions(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  double when;
  char owner[200];
  for (size_t i = 0; i < scene->support_motion_count; i++) {
    const strut_support_motion *m = &scene->support_motions[i];
    if (!exists(m->node, scene->node_count)) {
      strut_report_finding(checker, STRUT_ON_SCENE, 0, "nodes",
                           "motion number %zu is of a node that does not exist", i + 1);
      continue;
    }
    strut_format_name(owner, "node", scene->nodes[m->node].name, (size_t)m->node);
    const char *fault = fault_of_motion(scene, i);
    if (fault)
      strut_report_finding(checker, STRUT_ON_NODE, (size_t)m->node, "moves", "%s %s", owner, fault);
    else if (!exists(m->signal, scene->signal_count))
      strut_report_finding(checker, STRUT_ON_NODE, (size_t)m->node, "moves",
                           "%s moves by a signal that does not exist", owner);
    else if (!checker->wild[m->signal] && !strut_signal_is_wave(scene->signals, m->signal))
      strut_report_finding(
          checker, STRUT_ON_NODE, (size_t)m->node, "moves",
          "%s moves by an expression, a lag, samples or a start, whose acceleration is "
          "not known; use waves, ramps, tables and sums of them",
          owner);
    else if (!checker->wild[m->signal] &&
             strut_signal_value_jumps(scene->signals, m->signal, HUGE_VAL, &when))
      strut_report_finding(checker, STRUT_ON_NODE, (size_t)m->node, "moves",
                           "the signal that moves %s in %c jumps at t = %g s, but a support cannot "
                           "jump; use a ramp or a table",
                           owner, "xy"[m->axis], when);
  }
}

static void check_unbalances(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  char owner[200];
  double when;
  for (size_t i = 0; i < scene->unbalance_count; i++) {
    const strut_unbalance *u = &scene->unbalances[i];
    strut_format_name(owner, "unbalance", u->name, i);
    const strut_checked whose = {STRUT_ON_UNBALANCE, i, owner, NULL};
    strut_check_fields(checker, &whose, STRUT_FIELDS_UNBALANCE, u, NULL);
    strut_check_number(checker, &whose, STRUT_FIELDS_UNBALANCE, "speed", u->speed);
    if (!exists(u->node, scene->node_count))
      strut_report_finding(checker, STRUT_ON_UNBALANCE, i, "node",
                           "%s rotates about a node that does not exist", owner);
    if (u->signal == -1) continue;
    if (!exists(u->signal, scene->signal_count))
      strut_report_finding(checker, STRUT_ON_UNBALANCE, i, "angle",
                           "%s has a signal that does not exist", owner);
    else if (!checker->wild[u->signal] && !strut_signal_is_wave(scene->signals, u->signal))
      strut_report_finding(checker, STRUT_ON_UNBALANCE, i, "angle",
                           "the angle of %s is an expression, a lag, samples or a start, whose "
                           "acceleration is not known; use waves, ramps, tables and sums of them",
                           owner);
    else if (!checker->wild[u->signal] &&
             strut_signal_value_jumps(scene->signals, u->signal, HUGE_VAL, &when))
      strut_report_finding(
          checker, STRUT_ON_UNBALANCE, i, "angle",
          "the angle of %s jumps at t = %g s, but a rotating mass cannot jump; use "
          "a ramp or a table",
          owner, when);
  }
}

void strut_check_drives(strut_checker *checker) {
  check_motions(checker);
  check_unbalances(checker);
  const strut_scene *scene = checker->scene;
  char owner[200];
  for (size_t i = 0; i < scene->actuator_count; i++) {
    const strut_actuator *a = &scene->actuators[i];
    strut_format_name(owner, "actuator", a->name, i);
    bool hinge = a->member < 0 && exists(a->hinge, scene->hinge_count);
    bool cell = a->member < 0 && a->hinge < 0 && exists(a->cell, scene->cell_count);
    if (cell && scene->cells[a->cell].law != STRUT_LAW_PRESSURE)
      strut_report_finding(checker, STRUT_ON_ACTUATOR, i, "cell",
                           "%s drives the pressure of cell '%s', but the pressure of a gas follows "
                           "from its area; give the cell a pressure instead of a gas",
                           owner, scene->cells[a->cell].name);
    else if (cell && a->force)
      strut_report_finding(checker, STRUT_ON_ACTUATOR, i, "cell",
                           "%s gives a force to a cell, whose pressure a signal drives", owner);
    else if (!hinge && !cell && !exists(a->member, scene->member_count))
      strut_report_finding(checker, STRUT_ON_ACTUATOR, i, "member",
                           "%s drives a member that does not exist", owner);
    else if (!hinge && !cell && scene->bar_model == STRUT_BARS_RIGID &&
             scene->members[a->member].kind == STRUT_BAR)
      strut_report_finding(
          checker, STRUT_ON_ACTUATOR, i, "member",
          "%s drives a bar, but bars are rigid; make the member a spring, or bars: elastic", owner);
    else if (!hinge && !cell && !a->force && scene->members[a->member].axial_stiffness > 0.0 &&
             scene->members[a->member].law.kind == STRUT_LAW_ELASTIC_PLASTIC)
      strut_report_finding(checker, STRUT_ON_ACTUATOR, i, "member",
                           "%s drives the rest length of an elastic-plastic member with an "
                           "axial_stiffness, of which it is not defined how much set is wound in; "
                           "give the member its stiffness instead",
                           owner);
    if (!exists(a->signal, scene->signal_count))
      strut_report_finding(checker, STRUT_ON_ACTUATOR, i, "signal", "%s has no signal", owner);
    else if (!checker->wild[a->signal])
      strut_check_driven_rate(checker, i, owner);
  }
  for (size_t i = 0; i < scene->load_count; i++) {
    const strut_load *l = &scene->loads[i];
    strut_format_name(owner, "load", l->name, i);
    if (!exists(l->node, scene->node_count))
      strut_report_finding(checker, STRUT_ON_LOAD, i, "node",
                           "%s acts on a node that does not exist", owner);
    if (!isfinite(l->force[0]) || !isfinite(l->force[1]))
      strut_report_finding(checker, STRUT_ON_LOAD, i, "force", "the force of %s is not finite",
                           owner);
    if (l->signal != -1 && !exists(l->signal, scene->signal_count))
      strut_report_finding(checker, STRUT_ON_LOAD, i, "signal",
                           "%s has a signal that does not exist", owner);
  }
}

/* Checks the length of the run: its duration, or its period. */
static bool check_length(strut_checker *checker) {
  const strut_experiment *e = checker->experiment;
  const strut_experiment usual = {0};
  const strut_checked whose = {STRUT_ON_RUN, 0, "the run", NULL};
  if (!strut_check_fields(checker, &whose, STRUT_FIELDS_RUN, e, &usual)) return false;
  if (e->duration > 0.0 && e->periods > 0.0) {
    strut_report_finding(checker, STRUT_ON_RUN, 0, "periods",
                         "the run has both a duration and a number of periods; give one");
    return false;
  }
  if (e->periods == 0.0) return e->duration > 0.0;
  if (!exists(e->period_signal, checker->scene->signal_count)) {
    strut_report_finding(checker, STRUT_ON_RUN, 0, "of",
                         "a run in periods needs a signal to define the period");
    return false;
  }
  if (checker->wild[e->period_signal]) return false; /* reported there */
  double period = strut_signal_period(checker->scene->signals, e->period_signal);
  if (period > 0.0 && isfinite(period * e->periods)) return true;
  if (period > 0.0 && isfinite(period))
    strut_report_finding(checker, STRUT_ON_RUN, 0, "periods", "the duration of the run overflows");
  else
    strut_report_finding(
        checker, STRUT_ON_RUN, 0, "of",
        "'%s' has no period: the run can be given in periods of a sine, a half-sine, a square, or "
        "a sum whose longest period is a multiple of the others",
        e->period_of ? e->period_of : "the signal");
  return false;
}

static void check_window(strut_checker *checker, strut_subject subject, const char *owner,
                         double last) {
  const strut_experiment *e = checker->experiment;
  bool periods = e->periods > 0.0;
  double whole = periods ? e->periods : e->duration;
  if (last <= whole) return;
  strut_report_finding(checker, subject, 0, "last", "%s the last %g %s of a run of %g %s", owner,
                       last, periods ? "periods" : "s", whole, periods ? "periods" : "s");
}

/* Checks the step and the resulting number of steps. */
static void check_step(strut_checker *checker, bool length_known) {
  const strut_experiment *e = checker->experiment;
  if (!e->integrator || !*e->integrator)
    strut_report_finding(checker, STRUT_ON_SOLVER, 0, "integrator",
                         "the solver names no integrator");
  if (e->step == 0.0) {
    if (checker->purpose == STRUT_FOR_RUN && !checker->step_given_later && !(e->accuracy > 0.0))
      strut_report_finding(checker, STRUT_ON_SOLVER, 0, "step",
                           "the solver has no step, expected a time such as '0.1 ms'");
    return;
  }
  const strut_checked whose = {STRUT_ON_SOLVER, 0, "the solver", NULL};
  if (!strut_check_number(checker, &whose, STRUT_FIELDS_SOLVER, "step", e->step) || !length_known)
    return;
  double duration = strut_experiment_span(e, checker->scene).duration;
  if (e->step > duration)
    strut_report_finding(checker, STRUT_ON_SOLVER, 0, "step",
                         "the step of %g s is longer than the whole run of %g s", e->step,
                         duration);
  else if (duration / e->step > 1e15)
    strut_report_finding(checker, STRUT_ON_SOLVER, 0, "step",
                         "the run of %g s would take more than 1e15 steps of %g s", duration,
                         e->step);
}

void strut_check_experiment(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const strut_experiment *e = checker->experiment;
  const strut_settle *settle = &e->settle;
  const strut_experiment usual = {0};
  const strut_checked settling = {STRUT_ON_INITIAL, 0, "settling", NULL};
  const strut_checked window = {STRUT_ON_RUN, 0, "the measuring window", NULL};
  const strut_checked record = {STRUT_ON_OUTPUT, 0, "the output", NULL};
  if (settle->wanted)
    strut_check_fields(checker, &settling, STRUT_FIELDS_SETTLE, settle, &usual.settle);
  if (settle->wanted && !isfinite(settle->step))
    strut_report_finding(checker, STRUT_ON_INITIAL, 0, "step",
                         "the step of settling is not finite");
  if (!isfinite(scene->gravity[0]) || !isfinite(scene->gravity[1]))
    strut_report_finding(checker, STRUT_ON_SCENE, 0, "gravity", "gravity is not finite");
  if ((unsigned)scene->mass_model > STRUT_MASS_LUMPED)
    strut_report_finding(checker, STRUT_ON_SCENE, 0, "mass_model", "the mass model is unknown");
  if ((unsigned)scene->bar_model > STRUT_BARS_RIGID)
    strut_report_finding(checker, STRUT_ON_SCENE, 0, "bars", "the model of bars is unknown");
  if (e->steady.wanted && !(e->periods > 0.0) && checker->purpose == STRUT_FOR_RUN)
    strut_report_finding(
        checker, STRUT_ON_RUN, 0, "measure",
        "steady motion is detected from period to period: the run needs 'periods' and 'of'");
  bool length_known = check_length(checker);
  if (checker->purpose == STRUT_FOR_RUN && e->duration == 0.0 && e->periods == 0.0)
    strut_report_finding(checker, STRUT_ON_RUN, 0, NULL,
                         "the run has neither a duration nor periods");
  check_step(checker, length_known);
  if (e->measure_node != -1 && !exists(e->measure_node, scene->node_count))
    strut_report_finding(checker, STRUT_ON_RUN, 0, "node", "the measured node does not exist");
  bool measure = strut_check_fields(checker, &window, STRUT_FIELDS_MEASURE, e, &usual);
  bool output = strut_check_fields(checker, &record, STRUT_FIELDS_OUTPUT, e, &usual);
  if (!length_known) return;
  if (measure) check_window(checker, STRUT_ON_RUN, "cannot measure over", e->measure_last);
  if (output) check_window(checker, STRUT_ON_OUTPUT, "cannot record", e->output_last);
}
