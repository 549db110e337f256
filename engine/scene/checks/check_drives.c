/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules about what drives a structure, and about the experiment. See check.h. */
#include <math.h>
#include <stdio.h>

#include "engine/scene/checks/check_rules.h"
#include "engine/scene/profile.h"
#include "engine/scene/signal_motion.h"
#include "engine/scene/signal_program.h"

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
  for (size_t i = 0; i < scene->support_motion_count; i++) {
    const strut_support_motion *m = &scene->support_motions[i];
    if (!strut_exists(m->node, scene->node_count)) {
      strut_report_finding(checker, STRUT_ON_SCENE, 0, "nodes",
                           "motion number %zu is of a node that does not exist", i + 1);
      continue;
    }
    strut_check_begin(checker, STRUT_THING_NODE, (size_t)m->node);
    const char *fault = fault_of_motion(scene, i);
    if (fault)
      strut_fault(checker, "moves", "%s", fault);
    else if (!strut_exists(m->signal, scene->signal_count))
      strut_fault(checker, "moves", "moves by a signal that does not exist");
    else if (!checker->wild[m->signal] && !strut_signal_is_wave(scene->signals, m->signal))
      strut_fault(checker, "moves",
                  "moves by an expression, a lag, samples or a start, whose acceleration is "
                  "not known; use waves, ramps, tables and sums of them");
    else if (!checker->wild[m->signal] &&
             strut_signal_value_jumps(scene->signals, m->signal, HUGE_VAL, &when))
      strut_fault_of(checker, "moves",
                     "the signal that moves %s in %c jumps at t = %g s, but a support cannot "
                     "jump; use a ramp or a table",
                     checker->owner, "xy"[m->axis], when);
  }
}

static void check_unbalances(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  double when;
  for (size_t i = 0; i < scene->unbalance_count; i++) {
    const strut_unbalance *u = &scene->unbalances[i];
    strut_check_begin(checker, STRUT_THING_UNBALANCE, i);
    strut_check_fields(checker, STRUT_FIELDS_UNBALANCE, u, NULL);
    strut_check_number(checker, STRUT_FIELDS_UNBALANCE, "speed", u->speed);
    if (!strut_exists(u->node, scene->node_count))
      strut_fault(checker, "node", "rotates about a node that does not exist");
    if (u->signal == -1) continue;
    if (!strut_exists(u->signal, scene->signal_count))
      strut_fault(checker, "angle", "has a signal that does not exist");
    else if (!checker->wild[u->signal] && !strut_signal_is_wave(scene->signals, u->signal))
      strut_fault_of(checker, "angle",
                     "the angle of %s is an expression, a lag, samples or a start, whose "
                     "acceleration is not known; use waves, ramps, tables and sums of them",
                     checker->owner);
    else if (!checker->wild[u->signal] &&
             strut_signal_value_jumps(scene->signals, u->signal, HUGE_VAL, &when))
      strut_fault_of(checker, "angle",
                     "the angle of %s jumps at t = %g s, but a rotating mass cannot jump; use "
                     "a ramp or a table",
                     checker->owner, when);
  }
}

void strut_check_drives(strut_checker *checker) {
  check_motions(checker);
  check_unbalances(checker);
  const strut_scene *scene = checker->scene;
  for (size_t i = 0; i < scene->actuator_count; i++) {
    const strut_actuator *a = &scene->actuators[i];
    strut_check_begin(checker, STRUT_THING_ACTUATOR, i);
    bool hinge = a->member < 0 && strut_exists(a->hinge, scene->hinge_count);
    bool cell = a->member < 0 && a->hinge < 0 && strut_exists(a->cell, scene->cell_count);
    strut_law_kind law = cell ? scene->cells[a->cell].law : STRUT_LAW_PRESSURE;
    if (law != STRUT_LAW_PRESSURE && law != STRUT_LAW_ISOTHERMAL)
      strut_fault(checker, "cell",
                  "drives the pressure of cell '%s', but that of an isentropic gas or an "
                  "elastic cell follows from its area; give the cell a pressure or an "
                  "isothermal gas",
                  scene->cells[a->cell].name);
    else if (cell && a->force)
      strut_fault(checker, "cell", "gives a force to a cell, whose pressure a signal drives");
    else if (!hinge && !cell && !strut_exists(a->member, scene->member_count))
      strut_fault(checker, "member", "drives a member that does not exist");
    else if (!hinge && !cell && scene->bar_model == STRUT_BARS_RIGID &&
             scene->members[a->member].kind == STRUT_BAR)
      strut_fault(checker, "member",
                  "drives a bar, but bars are rigid; make the member a spring, or bars: elastic");
    else if (!hinge && !cell && a->force && scene->members[a->member].guide_radius > 0.0)
      strut_fault(checker, "member",
                  "gives a force along '%s', whose guides have a radius; drive its rest "
                  "length instead",
                  scene->members[a->member].name);
    else if (!hinge && !cell && !a->force && scene->members[a->member].axial_stiffness > 0.0 &&
             scene->members[a->member].law.kind == STRUT_LAW_ELASTIC_PLASTIC)
      strut_fault(checker, "member",
                  "drives the rest length of an elastic-plastic member with an "
                  "axial_stiffness, of which it is not defined how much set is wound in; "
                  "give the member its stiffness instead");
    if (!strut_exists(a->signal, scene->signal_count))
      strut_fault(checker, "signal", "has no signal");
    else if (!checker->wild[a->signal])
      strut_check_driven_rate(checker);
  }
  for (size_t i = 0; i < scene->load_count; i++) {
    const strut_load *l = &scene->loads[i];
    strut_check_begin(checker, STRUT_THING_LOAD, i);
    const char *key = !l->couple ? "node" : l->hinge >= 0 ? "hinge" : "member";
    if (!(!l->couple      ? strut_exists(l->node, scene->node_count)
          : l->hinge >= 0 ? strut_exists(l->hinge, scene->hinge_count)
                          : strut_exists(l->member, scene->member_count)))
      strut_fault(checker, key, "acts on a %s that does not exist", key);
    if (!isfinite(l->force[0] + l->force[1] + l->moment))
      strut_fault_of(checker, l->couple ? "moment" : "force", "the %s of %s is not finite",
                     l->couple ? "moment" : "force", checker->owner);
    if (l->signal != -1 && !strut_exists(l->signal, scene->signal_count))
      strut_fault(checker, "signal", "has a signal that does not exist");
  }
}

/* Checks the length of the run: its duration, or its period. */
static bool check_length(strut_checker *checker) {
  const strut_experiment *e = checker->experiment;
  const strut_experiment usual = {0};
  strut_check_begin_with(checker, STRUT_ON_RUN, 0, "the run");
  if (!strut_check_fields(checker, STRUT_FIELDS_RUN, e, &usual)) return false;
  if (e->duration > 0.0 && e->periods > 0.0)
    return strut_report_finding(checker, STRUT_ON_RUN, 0, "periods",
                                "the run has both a duration and a number of periods; give one");
  if (e->periods == 0.0) return e->duration > 0.0;
  if (!strut_exists(e->period_signal, checker->scene->signal_count))
    return strut_report_finding(checker, STRUT_ON_RUN, 0, "of",
                                "a run in periods needs a signal to define the period");
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
    if (checker->purpose == STRUT_FOR_RUN && !checker->step_given_later && !(e->accuracy > 0.0) &&
        !strut_experiment_is_adaptive(e->integrator))
      strut_report_finding(checker, STRUT_ON_SOLVER, 0, "step",
                           "the solver has no step, expected a time such as '0.1 ms'");
    return;
  }
  strut_check_begin_with(checker, STRUT_ON_SOLVER, 0, "the solver");
  if (!strut_check_number(checker, STRUT_FIELDS_SOLVER, "step", e->step) || !length_known) return;
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
  strut_check_begin_with(checker, STRUT_ON_INITIAL, 0, "settling");
  if (settle->wanted) strut_check_fields(checker, STRUT_FIELDS_SETTLE, settle, &usual.settle);
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
  if (e->measure_node != -1 && !strut_exists(e->measure_node, scene->node_count))
    strut_report_finding(checker, STRUT_ON_RUN, 0, "node", "the measured node does not exist");
  strut_check_begin_with(checker, STRUT_ON_RUN, 0, "the measuring window");
  bool measure = strut_check_fields(checker, STRUT_FIELDS_MEASURE, e, &usual);
  strut_check_begin_with(checker, STRUT_ON_OUTPUT, 0, "the output");
  bool output = strut_check_fields(checker, STRUT_FIELDS_OUTPUT, e, &usual);
  if (!length_known) return;
  if (measure) check_window(checker, STRUT_ON_RUN, "cannot measure over", e->measure_last);
  if (output) check_window(checker, STRUT_ON_OUTPUT, "cannot record", e->output_last);
}

/* ---- masses that slide along members ---- */

/* Shares this far beyond an end are there but for rounding. */
static const double ROUNDING = 1e-9;
/* Times at which a signal is sampled: where it may turn, and evenly over the run. */
enum { MOST_TURNS = 1000, MOST_SAMPLES = 2000 };

static bool node_has_mass(const strut_scene *scene, int32_t node) {
  if (scene->nodes[node].mass > 0.0) return true;
  for (size_t i = 0; i < scene->unbalance_count; i++)
    if (scene->unbalances[i].node == node && scene->unbalances[i].mass > 0.0) return true;
  for (size_t j = 0; j < scene->member_count; j++)
    for (size_t k = 0; k < scene->members[j].guide_count + 2; k++)
      if (scene->members[j].mass > 0.0 && strut_member_node(&scene->members[j], k) == node)
        return true;
  return false;
}

static bool node_moves(const strut_scene *scene, int32_t node) {
  for (size_t i = 0; i < scene->support_motion_count; i++)
    if (scene->support_motions[i].node == node) return true;
  return false;
}

/* Can the member carry a mass that slides? */
static bool check_carrier(strut_checker *checker) {
  size_t i = checker->index;
  const strut_scene *scene = checker->scene;
  const strut_member *m = &scene->members[scene->sliding_masses[i].member];
  const char *fault = NULL;
  if (m->guide_count)
    fault = "runs over guides; only members between two nodes carry sliders";
  else if (strut_member_ends(m))
    fault = "breaks or is released; take breaks_at and released_at away";
  if (fault) return strut_fault(checker, "member", "is on member '%s', which %s", m->name, fault);
  for (int k = 0; k < 2; k++) {
    const strut_node *node = &scene->nodes[m->node[k]];
    if (node_moves(scene, m->node[k]))
      strut_fault(checker, "member",
                  "is on a member whose node '%s' moves by a signal; sliders need "
                  "members between free or fixed nodes",
                  node->name);
    else if (!(node->fixed[0] && node->fixed[1]) && !node_has_mass(scene, m->node[k]))
      strut_fault(checker, "member",
                  "is on a member whose node '%s' has no mass but the slider's; give "
                  "the node or the member a mass",
                  node->name);
    else
      continue;
    return false;
  }
  return true;
}

static bool outside(double share) { return !(share >= -ROUNDING && share <= 1.0 + ROUNDING); }

/* Reports the first sampled time at which the mass is beyond an end of its member. */
static void check_way(strut_checker *checker) {
  size_t i = checker->index;
  const strut_scene *scene = checker->scene;
  const strut_experiment *e = checker->experiment;
  const strut_sliding_mass *s = &scene->sliding_masses[i];
  double time[MOST_TURNS], until = e->duration > 0.0 ? e->duration : 1.0, first = HUGE_VAL;
  if (s->signal < 0) {
    if (outside(s->share))
      strut_fault(checker, "position",
                  "is at %.6g of its member, which is beyond its ends; expected a "
                  "share from 0 to 1",
                  s->share);
    return;
  }
  size_t count = strut_signal_times(scene->signals, s->signal, 0.0, HUGE_VAL, time, MOST_TURNS);
  for (size_t k = 0; k < count; k++)
    if (time[k] >= 0.0 && time[k] < first && outside(strut_sliding_mass_share(scene, i, time[k])))
      first = time[k];
  for (int k = 0; k <= MOST_SAMPLES && isfinite(until); k++) {
    double t = until * k / MOST_SAMPLES;
    if (t < first && outside(strut_sliding_mass_share(scene, i, t))) first = t;
  }
  if (!(first < HUGE_VAL)) return;
  strut_fault(checker, s->travel ? "travel" : "moves",
              "is at %.6g of its member at t = %g s, which is beyond its ends; "
              "expected shares from 0 to 1",
              strut_sliding_mass_share(scene, i, first), first);
}

/* Has the motion an acceleration, and no jumps? */
static bool check_signal(strut_checker *checker) {
  size_t i = checker->index;
  const strut_scene *scene = checker->scene;
  const strut_sliding_mass *s = &scene->sliding_masses[i];
  const char *key = s->travel ? "travel" : "moves";
  double when;
  if (s->signal == -1) return true;
  if (!strut_exists(s->signal, scene->signal_count))
    return strut_fault(checker, key, "has a signal that does not exist");
  if (checker->wild[s->signal]) return false;
  if (!strut_signal_is_wave(scene->signals, s->signal))
    return strut_fault(checker, key,
                       "moves by an expression, a lag, samples or a start, whose acceleration "
                       "is not known; use waves, ramps, tables and sums of them");
  if (!strut_signal_value_jumps(scene->signals, s->signal, HUGE_VAL, &when)) return true;
  return strut_fault_of(checker, key,
                        "the signal that moves %s jumps at t = %g s, but a mass cannot jump; use a "
                        "ramp, a table, or waves that begin and stop at zero",
                        checker->owner, when);
}

void strut_check_sliding_masses(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  for (size_t i = 0; i < scene->sliding_count; i++) {
    const strut_sliding_mass *s = &scene->sliding_masses[i];
    strut_check_begin(checker, STRUT_THING_SLIDER, i);
    strut_check_fields(checker, STRUT_FIELDS_SLIDER, s, NULL);
    bool placed = isfinite(s->share);
    if (!strut_exists(s->member, scene->member_count)) {
      strut_fault(checker, "member", "is on a member that does not exist");
      continue;
    }
    if (checker->loose[s->member]) continue;
    bool carried = check_carrier(checker);
    if (carried && s->signal >= 0 && scene->bar_model == STRUT_BARS_RIGID)
      strut_fault(checker, s->travel ? "travel" : "moves",
                  "moves, but bars are rigid; make them elastic, bars: elastic");
    if (check_signal(checker) && placed) check_way(checker);
  }
}
