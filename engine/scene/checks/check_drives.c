/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules about what drives a structure, and about the experiment. See check.h. */
#include <math.h>
#include <stdio.h>

#include "engine/scene/checks/check_rules.h"
#include "engine/scene/profile.h"
#include "engine/scene/signal_program.h"

bool strut_is_pulled(const strut_scene *scene, int32_t member, int32_t hinge) {
  for (size_t i = 0; i < scene->actuator_count; i++) {
    const strut_actuator *actuator = &scene->actuators[i];
    if (actuator->force &&
        (actuator->member >= 0 ? actuator->member == member
                               : actuator->hinge >= 0 && actuator->hinge == hinge))
      return true;
  }
  return false;
}

/* What is wrong with where a support moves, or NULL. */
static const char *fault_of_motion(const strut_scene *scene, size_t i) {
  const strut_support_motion *motion = &scene->support_motions[i], *last = i ? motion - 1 : NULL;
  if (motion->axis < 0 || motion->axis > 1) return "moves along an axis other than x and y";
  if (!scene->nodes[motion->node].fixed[motion->axis])
    return "moves in a direction in which it is not fixed";
  if (last &&
      (motion->node < last->node || (motion->node == last->node && motion->axis <= last->axis)))
    return "moves out of order: motions follow nodes, x before y, each once";
  if (last && motion->node == last->node) return NULL; /* the rest is said of its x */
  if (scene->bar_model == STRUT_BARS_RIGID)
    return "moves, but bars are rigid; make them elastic, bars: elastic";
  for (size_t k = 0; k < scene->contact_count; k++)
    if (scene->contacts[k].node == motion->node)
      return "moves and may touch the ground; leave it out of the ground's nodes";
  return NULL;
}

bool strut_check_motion(strut_checker *checker, const char *key, int32_t signal, const char *what,
                        const char *moved) {
  const strut_scene *scene = checker->scene;
  double when;
  if (!strut_exists(signal, scene->signal_count))
    return strut_fault_of(checker, key, "%s has a signal that does not exist", what);
  if (checker->wild[signal]) return false;
  if (!strut_signal_is_wave(scene->signals, signal))
    return strut_fault_of(checker, key,
                          "%s is an expression, a lag, samples or a start, whose acceleration is "
                          "not known; use waves, ramps, tables and sums of them",
                          what);
  return !strut_signal_value_jumps(scene->signals, signal, HUGE_VAL, &when) ||
         strut_fault_of(checker, key,
                        "%s jumps at t = %g s, but a %s cannot jump; use a ramp, a table, or waves "
                        "that begin and stop at zero",
                        what, when, moved);
}

static void check_motions(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  char what[240];
  for (size_t i = 0; i < scene->support_motion_count; i++) {
    const strut_support_motion *motion = &scene->support_motions[i];
    if (!strut_exists(motion->node, scene->node_count)) {
      strut_report_finding(checker, STRUT_ON_SCENE, 0, "nodes",
                           "motion number %zu is of a node that does not exist", i + 1);
      continue;
    }
    strut_check_begin(checker, STRUT_THING_NODE, (size_t)motion->node);
    const char *fault = fault_of_motion(scene, i);
    snprintf(what, sizeof what, "the motion of %s in %c", checker->owner, "xy"[motion->axis & 1]);
    if (fault)
      strut_fault(checker, "moves", "%s", fault);
    else
      strut_check_motion(checker, "moves", motion->signal, what, "support");
  }
}

static void check_unbalances(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  char what[240];
  for (size_t i = 0; i < scene->unbalance_count; i++) {
    const strut_unbalance *unbalance = &scene->unbalances[i];
    strut_check_begin(checker, STRUT_THING_UNBALANCE, i);
    strut_check_fields(checker, STRUT_FIELDS_UNBALANCE, unbalance, NULL);
    strut_check_number(checker, STRUT_FIELDS_UNBALANCE, "speed", unbalance->speed);
    if (!strut_exists(unbalance->node, scene->node_count))
      strut_fault(checker, "node", "rotates about a node that does not exist");
    if (unbalance->signal == -1) continue;
    snprintf(what, sizeof what, "the angle of %s", checker->owner);
    strut_check_motion(checker, "angle", unbalance->signal, what, "rotating mass");
  }
}

void strut_check_drives(strut_checker *checker) {
  check_motions(checker);
  check_unbalances(checker);
  const strut_scene *scene = checker->scene;
  for (size_t i = 0; i < scene->actuator_count; i++) {
    const strut_actuator *actuator = &scene->actuators[i];
    strut_check_begin(checker, STRUT_THING_ACTUATOR, i);
    bool hinge = actuator->member < 0 && strut_exists(actuator->hinge, scene->hinge_count);
    bool cell = actuator->member < 0 && actuator->hinge < 0 &&
                strut_exists(actuator->cell, scene->cell_count);
    strut_law_kind law = cell ? scene->cells[actuator->cell].law : STRUT_LAW_PRESSURE;
    if (law != STRUT_LAW_PRESSURE && law != STRUT_LAW_ISOTHERMAL)
      strut_fault(checker, "cell",
                  "drives the pressure of cell '%s', but that of an isentropic gas or an "
                  "elastic cell follows from its area; give the cell a pressure or an "
                  "isothermal gas",
                  scene->cells[actuator->cell].name);
    else if (cell && actuator->force)
      strut_fault(checker, "cell", "gives a force to a cell, whose pressure a signal drives");
    else if (!hinge && !cell && !strut_exists(actuator->member, scene->member_count))
      strut_fault(checker, "member", "drives a member that does not exist");
    else if (!hinge && !cell && scene->bar_model == STRUT_BARS_RIGID &&
             scene->members[actuator->member].kind == STRUT_BAR)
      strut_fault(checker, "member",
                  "drives a bar, but bars are rigid; make the member a spring, or bars: elastic");
    else if (!hinge && !cell && actuator->force &&
             scene->members[actuator->member].guide_radius > 0.0)
      strut_fault(checker, "member",
                  "gives a force along '%s', whose guides have a radius; drive its rest "
                  "length instead",
                  scene->members[actuator->member].name);
    else if (!hinge && !cell && !actuator->force &&
             scene->members[actuator->member].axial_stiffness > 0.0 &&
             scene->members[actuator->member].law.kind == STRUT_LAW_ELASTIC_PLASTIC)
      strut_fault(checker, "member",
                  "drives the rest length of an elastic-plastic member with an "
                  "axial_stiffness, of which it is not defined how much set is wound in; "
                  "give the member its stiffness instead");
    if (!strut_exists(actuator->signal, scene->signal_count))
      strut_fault(checker, "signal", "has no signal");
    else if (!checker->wild[actuator->signal])
      strut_check_driven_rate(checker);
  }
  for (size_t i = 0; i < scene->load_count; i++) {
    const strut_load *load = &scene->loads[i];
    strut_check_begin(checker, STRUT_THING_LOAD, i);
    const char *key = !load->couple ? "node" : load->hinge >= 0 ? "hinge" : "member";
    if (!(!load->couple      ? strut_exists(load->node, scene->node_count)
          : load->hinge >= 0 ? strut_exists(load->hinge, scene->hinge_count)
                             : strut_exists(load->member, scene->member_count)))
      strut_fault(checker, key, "acts on a %s that does not exist", key);
    if (!isfinite(load->force[0] + load->force[1] + load->moment))
      strut_fault_of(checker, load->couple ? "moment" : "force", "the %s of %s is not finite",
                     load->couple ? "moment" : "force", checker->owner);
    if (load->signal != -1 && !strut_exists(load->signal, scene->signal_count))
      strut_fault(checker, "signal", "has a signal that does not exist");
  }
}

static bool check_length(strut_checker *checker) {
  const strut_experiment *experiment = checker->experiment;
  const strut_experiment usual = {0};
  strut_check_begin_with(checker, STRUT_ON_RUN, 0, "the run");
  if (!strut_check_fields(checker, STRUT_FIELDS_RUN, experiment, &usual)) return false;
  if (experiment->duration > 0.0 && experiment->periods > 0.0)
    return strut_fault_of(checker, "periods",
                          "the run has both a duration and a number of periods; give one");
  if (experiment->periods == 0.0) return experiment->duration > 0.0;
  if (!strut_exists(experiment->period_signal, checker->scene->signal_count))
    return strut_fault_of(checker, "of", "a run in periods needs a signal to define the period");
  if (checker->wild[experiment->period_signal]) return false; /* reported there */
  double period = strut_signal_period(checker->scene->signals, experiment->period_signal);
  if (period > 0.0 && isfinite(period * experiment->periods)) return true;
  if (period > 0.0 && isfinite(period))
    return strut_fault_of(checker, "periods", "the duration of the run overflows");
  return strut_fault_of(
      checker, "of",
      "'%s' has no period: the run can be given in periods of a sine, a "
      "half-sine, a square, or a sum whose longest period is a multiple of the others",
      experiment->period_of ? experiment->period_of : "the signal");
}

static void check_window(strut_checker *checker, strut_subject subject, const char *owner,
                         double last) {
  const strut_experiment *experiment = checker->experiment;
  bool periods = experiment->periods > 0.0;
  double whole = periods ? experiment->periods : experiment->duration;
  if (last <= whole) return;
  strut_report_finding(checker, subject, 0, "last", "%s the last %g %s of a run of %g %s", owner,
                       last, periods ? "periods" : "s", whole, periods ? "periods" : "s");
}

static void check_step(strut_checker *checker, bool length_known) {
  const strut_experiment *experiment = checker->experiment;
  strut_check_begin_with(checker, STRUT_ON_SOLVER, 0, "the solver");
  if (!experiment->integrator || !*experiment->integrator)
    strut_fault(checker, "integrator", "names no integrator");
  if (experiment->step == 0.0) {
    if (checker->purpose == STRUT_FOR_RUN && !checker->step_given_later &&
        !(experiment->accuracy > 0.0) && !strut_experiment_is_adaptive(experiment->integrator))
      strut_fault(checker, "step", "has no step, expected a time such as '0.1 ms'");
    return;
  }
  if (!strut_check_number(checker, STRUT_FIELDS_SOLVER, "step", experiment->step) || !length_known)
    return;
  double duration = strut_experiment_span(experiment, checker->scene).duration;
  if (experiment->step > duration)
    strut_fault_of(checker, "step", "the step of %g s is longer than the whole run of %g s",
                   experiment->step, duration);
  else if (duration / experiment->step > 1e15)
    strut_fault_of(checker, "step", "the run of %g s would take more than 1e15 steps of %g s",
                   duration, experiment->step);
}

void strut_check_experiment(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const strut_experiment *experiment = checker->experiment;
  const strut_settle *settle = &experiment->settle;
  const strut_experiment usual = {0};
  strut_check_begin_with(checker, STRUT_ON_INITIAL, 0, "settling");
  if (settle->wanted) strut_check_fields(checker, STRUT_FIELDS_SETTLE, settle, &usual.settle);
  if (settle->wanted && !isfinite(settle->step))
    strut_fault_of(checker, "step", "the step of settling is not finite");
  strut_check_begin_with(checker, STRUT_ON_SCENE, 0, "the scene");
  if (!isfinite(scene->gravity[0]) || !isfinite(scene->gravity[1]))
    strut_fault_of(checker, "gravity", "gravity is not finite");
  if ((unsigned)scene->mass_model > STRUT_MASS_LUMPED)
    strut_fault_of(checker, "mass_model", "the mass model is unknown");
  if ((unsigned)scene->bar_model > STRUT_BARS_RIGID)
    strut_fault_of(checker, "bars", "the model of bars is unknown");
  if (experiment->steady.wanted && !(experiment->periods > 0.0) &&
      checker->purpose == STRUT_FOR_RUN)
    strut_report_finding(
        checker, STRUT_ON_RUN, 0, "measure",
        "steady motion is detected from period to period: the run needs 'periods' and 'of'");
  bool length_known = check_length(checker);
  if (checker->purpose == STRUT_FOR_RUN && experiment->duration == 0.0 &&
      experiment->periods == 0.0)
    strut_report_finding(checker, STRUT_ON_RUN, 0, NULL,
                         "the run has neither a duration nor periods");
  check_step(checker, length_known);
  if (experiment->measure_node != -1 && !strut_exists(experiment->measure_node, scene->node_count))
    strut_report_finding(checker, STRUT_ON_RUN, 0, "node", "the measured node does not exist");
  strut_check_begin_with(checker, STRUT_ON_RUN, 0, "the measuring window");
  bool measure = strut_check_fields(checker, STRUT_FIELDS_MEASURE, experiment, &usual);
  strut_check_begin_with(checker, STRUT_ON_OUTPUT, 0, "the output");
  bool output = strut_check_fields(checker, STRUT_FIELDS_OUTPUT, experiment, &usual);
  if (output && experiment->step > STRUT_MOST_IN_STEP * experiment->output_every &&
      experiment->output_every > 0.0)
    strut_report_finding(checker, STRUT_ON_OUTPUT, 0, "every",
                         "'every' is %.3g samples in a step of %g s; at most %g are taken",
                         experiment->step / experiment->output_every, experiment->step,
                         STRUT_MOST_IN_STEP);
  if (!length_known) return;
  if (measure) check_window(checker, STRUT_ON_RUN, "cannot measure over", experiment->measure_last);
  if (output) check_window(checker, STRUT_ON_OUTPUT, "cannot record", experiment->output_last);
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

static bool check_carrier(strut_checker *checker) {
  size_t i = checker->index;
  const strut_scene *scene = checker->scene;
  const strut_member *member = &scene->members[scene->sliding_masses[i].member];
  const char *fault = NULL;
  if (member->guide_count)
    fault = "runs over guides; only members between two nodes carry sliders";
  else if (strut_member_ends(member))
    fault = "breaks or is released; take breaks_at and released_at away";
  if (fault)
    return strut_fault(checker, "member", "is on member '%s', which %s", member->name, fault);
  for (int k = 0; k < 2; k++) {
    const strut_node *node = &scene->nodes[member->node[k]];
    if (node_moves(scene, member->node[k]))
      strut_fault(checker, "member",
                  "is on a member whose node '%s' moves by a signal; sliders need "
                  "members between free or fixed nodes",
                  node->name);
    else if (!(node->fixed[0] && node->fixed[1]) && !node_has_mass(scene, member->node[k]))
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
  const strut_experiment *experiment = checker->experiment;
  const strut_sliding_mass *mass = &scene->sliding_masses[i];
  double time[MOST_TURNS], until = experiment->duration > 0.0 ? experiment->duration : 1.0,
                           first = HUGE_VAL;
  if (mass->signal < 0) {
    if (outside(mass->share))
      strut_fault(checker, "position",
                  "is at %.6g of its member, which is beyond its ends; expected a "
                  "share from 0 to 1",
                  mass->share);
    return;
  }
  size_t count = strut_signal_times(scene->signals, mass->signal, 0.0, HUGE_VAL, time, MOST_TURNS);
  for (size_t k = 0; k < count; k++)
    if (time[k] >= 0.0 && time[k] < first && outside(strut_sliding_mass_share(scene, i, time[k])))
      first = time[k];
  for (int k = 0; k <= MOST_SAMPLES && isfinite(until); k++) {
    double t = until * k / MOST_SAMPLES;
    if (t < first && outside(strut_sliding_mass_share(scene, i, t))) first = t;
  }
  if (!(first < HUGE_VAL)) return;
  strut_fault(checker, mass->travel ? "travel" : "moves",
              "is at %.6g of its member at t = %g s, which is beyond its ends; "
              "expected shares from 0 to 1",
              strut_sliding_mass_share(scene, i, first), first);
}

/* Has the motion an acceleration, and no jumps? */
static bool check_signal(strut_checker *checker) {
  const strut_sliding_mass *mass = &checker->scene->sliding_masses[checker->index];
  char what[240];
  snprintf(what, sizeof what, "the motion of %s", checker->owner);
  return mass->signal == -1 ||
         strut_check_motion(checker, mass->travel ? "travel" : "moves", mass->signal, what, "mass");
}

void strut_check_sliding_masses(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  for (size_t i = 0; i < scene->sliding_count; i++) {
    const strut_sliding_mass *mass = &scene->sliding_masses[i];
    strut_check_begin(checker, STRUT_THING_SLIDER, i);
    strut_check_fields(checker, STRUT_FIELDS_SLIDER, mass, NULL);
    bool placed = isfinite(mass->share);
    if (!strut_exists(mass->member, scene->member_count)) {
      strut_fault(checker, "member", "is on a member that does not exist");
      continue;
    }
    if (checker->loose[mass->member]) continue;
    bool carried = check_carrier(checker);
    if (carried && mass->signal >= 0 && scene->bar_model == STRUT_BARS_RIGID)
      strut_fault(checker, mass->travel ? "travel" : "moves",
                  "moves, but bars are rigid; make them elastic, bars: elastic");
    if (check_signal(checker) && placed) check_way(checker);
  }
}
