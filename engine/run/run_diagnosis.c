/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors that end a run, and warnings about its result, each with cause and remedy. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/forces/elements.h"
#include "engine/forces/nearby.h"
#include "engine/forces/surfaces.h"
#include "engine/run/simulate_parts.h"

/* A run beyond this multiple of the scene's size counts as diverged. */
static const double RUNAWAY = 1e10;
int32_t strut_run_find_lost_node(const strut_model *model, const strut_state *state) {
  double bound = RUNAWAY * model->size;
  int32_t lost = -1;
  for (int32_t i = 0; i < 2 * model->node_count; i++) {
    double away = fabs(state->q[i] - model->start[i]);
    if (away <= bound && isfinite(state->v[i])) continue;
    if (!model->fixed[i]) return i / 2; /* a NaN spreads, but not first from what is held */
    if (lost < 0) lost = i / 2;
  }
  return lost;
}

strut_status strut_run_fail_lost_node(const strut_run *run, int32_t node) {
  double limit = strut_step_limit_monitor_last_limit(run->model, &run->watch.limit),
         least = run->summary->step_limit;
  double seen = (double)run->watch.limit.last * run->dt;
  const char *remedy = run->dt > 0.5 * fmin(limit, least) ? "use a smaller step"
                       : run->summary->feedback
                           ? "look for a loop of sensors and drives that is unstable, of which the "
                             "largest step knows nothing; a smaller step may also help"
                           : "look for a member or contact that is far too stiff, or a load that "
                             "grows without bound; a smaller step may also help";
  if (run->watch.limit.lowest > 0.0 && !run->options->force)
    return strut_step_limit_monitor_fail(&run->watch.limit, run->state, least, run->error);
  if (limit < 0.99 * least)
    return strut_fail(run->error, STRUT_DIVERGED,
                      "node '%s' left all bounds at t = %.9g s with dt = %g s (largest stable step "
                      "at the start: %.4g s, at t = %.9g s: %.4g s); %s",
                      run->summary->end.node_names[node], strut_run_time(run), run->dt, least, seen,
                      limit, remedy);
  return strut_fail(run->error, STRUT_DIVERGED,
                    "node '%s' left all bounds at t = %.9g s with dt = %g s (largest stable step "
                    "at the start: %.4g s); %s",
                    run->summary->end.node_names[node], strut_run_time(run), run->dt, least,
                    remedy);
}

/* Bodies this near to each other beside their thickness may soon have passed through each other. */
static const double DEEP = 0.5;

static double speed_of(const strut_run *run, uint32_t at) {
  return hypot(run->state->v[at], run->state->v[at + 1]);
}

void strut_run_watch_collisions(strut_run *run) {
  const strut_element_table *elements = &run->model->elements;
  const strut_nearby *near =
      elements->scattered ? strut_nearby_at(run->model, run->state, run->state->q) : NULL;
  int32_t count = near ? near->count : elements->count;
  for (int32_t k = 0; k < count && !run->tunnel.element; k++) {
    int32_t i = near ? near->element[k] : k;
    const strut_element *element = &elements->element[i];
    const uint32_t *at = elements->at + element->first;
    if (element->role != STRUT_ELEMENT_COLLISION) continue;
    double other = speed_of(run, at[1]);
    if (element->nodes > 2) other = fmax(other, speed_of(run, at[2]));
    double speed = speed_of(run, at[0]) + other;
    bool fast = !run->method->events && speed * run->dt > element->natural;
    strut_element_pose pose;
    strut_element_evaluate(run->model, i, run->state->latest->rest, run->state->q, (double)NAN,
                           &pose);
    if (!fast && !(pose.strain < DEEP * element->natural)) continue;
    run->tunnel.element = i + 1;
    run->tunnel.speed = fast ? speed : 0.0;
  }
}

void strut_run_watch_bristles(strut_run *run) {
  for (int32_t i = 0; i < run->model->rubbing.count; i++) {
    double decay = strut_rubbing_bristle_decay(run->model, run->state, i);
    if (decay > run->bristles.decay) run->bristles.item = i, run->bristles.decay = decay;
  }
}

/* What fixed steps can follow of a decay [1/s]: as far as each method is stable on the real axis. */
static double longest_step(const strut_run *run, double decay) {
  static const double most[STRUT_REGIONS] = {HUGE_VAL, 2.7, 2.0, 2.0};
  return most[run->method->region] / decay;
}

/* The limit of steps that is known knows nothing of internal states, such as the gas of pipes. */
strut_status strut_run_check_rates(const strut_run *run) {
  const strut_scene *scene = run->model->scene;
  int32_t state;
  if (!run->model->feedback.state_count || run->options->force) return STRUT_OK;
  double *work = strut_allocate(3 * (size_t)run->model->length, sizeof *work);
  if (!work) return strut_no_memory(run->error, "for the model");
  double rate = strut_states_rate(run->model, run->state,
                                  strut_time_grid_at(&run->grid, run->state->step), work, &state);
  double step = longest_step(run, rate);
  strut_release(work);
  if (!(run->dt > step)) return STRUT_OK;
  size_t lag = (size_t)state - scene->state_count;
  const char *name = (size_t)state < scene->state_count
                         ? scene->states[state].name
                         : scene->signals[run->model->feedback.lagged[lag]].name;
  return strut_fail(run->error, STRUT_STEP_TOO_LARGE,
                    "%s '%s' settles within %.3g s at t = %.9g s, too fast for a step of %g s of "
                    "%s; use solver.step <= %.2g s, adaptive, or --force to run anyway",
                    (size_t)state < scene->state_count ? "pipe or state" : "the lag of signal",
                    name ? name : "", 1.0 / rate, strut_run_time(run), run->dt, run->method->name,
                    0.9 * step);
}

static void warn_of_bristles(const strut_run *run) {
  double step = longest_step(run, run->bristles.decay);
  if (!(run->dt > step)) return;
  int32_t contact = run->model->rubbing.item[run->bristles.item].contact;
  strut_summary_warn(
      run->summary, "bristles",
      "the bristles that hold '%s' straighten within %.3g s as they slide, too fast for a step of "
      "%g s; use one below %.2g s, or adaptive",
      run->model->scene->nodes[run->model->contacts.entry[contact].node].name,
      1.0 / run->bristles.decay, run->dt, step);
}

static void warn_of_tunnelling(const strut_run *run) {
  if (!run->tunnel.element) return;
  const strut_element *element = &run->model->elements.element[run->tunnel.element - 1];
  const strut_collision *collision = &run->model->scene->collisions[element->item];
  if (run->tunnel.speed == 0.0) {
    strut_summary_warn(
        run->summary, "tunnelling",
        "the sides of collision '%s' were pressed into each other by more than half "
        "its thickness of %.3g m, and may have passed through; use a larger stiffness",
        collision->name, collision->thickness);
    return;
  }
  strut_summary_warn(run->summary, "tunnelling",
                     "the sides of collision '%s' moved at up to %.3g m/s, which is more than its "
                     "thickness of %.3g m in a step of %g s: they may have passed through each "
                     "other; use a smaller step",
                     collision->name, run->tunnel.speed, collision->thickness, run->dt);
}

strut_status strut_run_check_collapse(const strut_run *run) {
  const strut_scene *scene = run->model->scene;
  int32_t cell = strut_cell_that_collapsed(run->model, run->state->q);
  int32_t member = strut_member_that_is_wound_in(run->model, run->state->latest->rest);
  strut_status rates = cell >= 0 ? strut_run_check_rates(run) : STRUT_OK;
  if (rates) return rates;
  if (cell >= 0)
    return strut_fail(
        run->error, STRUT_DIVERGED,
        "the area of cell '%s' reached zero at t = %.9g s, so that it encloses nothing; "
        "keep its nodes apart, or use a smaller step if they should not meet",
        scene->cells[cell].name, strut_run_time(run));
  if (member >= 0)
    return strut_fail(
        run->error, STRUT_DIVERGED,
        "the rest length of member '%s' reached zero at t = %.9g s, where its stiffness, "
        "axial_stiffness / rest length, has no bound; shorten it by less",
        scene->members[member].name, strut_run_time(run));
  return STRUT_OK;
}

/* The node that moves fastest, of those that touch a ground or of all. */
static const char *fastest_node(const strut_run *run, bool of_contacts) {
  const strut_contact_table *contacts = &run->model->contacts;
  int32_t count = of_contacts ? contacts->count : run->model->node_count, found = 0;
  double most = -1.0;
  for (int32_t i = 0; i < count; i++) {
    uint32_t at = of_contacts ? contacts->at[i] : 2 * (uint32_t)i;
    if (speed_of(run, at) > most) most = speed_of(run, at), found = (int32_t)at / 2;
  }
  return run->model->scene->nodes[found].name;
}

static strut_status check_losses(const strut_run *run) {
  static const char *const names[] = {[STRUT_LOSS_MEMBERS] = "the dampers of members",
                                      [STRUT_LOSS_CONTACT] = "the ground's dampers",
                                      [STRUT_LOSS_FRICTION] = "friction"};
  const strut_balance_monitor *monitor = &run->watch.balance;
  if (!(monitor->given > 0.0) || run->options->force || run->state->trouble) return STRUT_OK;
  bool contacts = monitor->giver != STRUT_LOSS_MEMBERS;
  return strut_fail(
      run->error, STRUT_DIVERGED,
      "by t = %.9g s %s gave %.3g J, which they can only take: the step of %s cannot follow the "
      "motion, which is fastest at node '%s'; use a smaller step%s, or --force to continue anyway",
      monitor->time + run->grid.offset, names[monitor->giver], monitor->given, run->method->name,
      fastest_node(run, contacts),
      monitor->giver == STRUT_LOSS_FRICTION ? " or a smaller friction" : "");
}

static const char *first_not_finite(const strut_energy *energy) {
#define STRUT_ENERGY_CHECK(name, kind, label)                                                      \
  if (!isfinite(energy->name)) return label;
  STRUT_ENERGY_TABLE(STRUT_ENERGY_CHECK)
  return "residual";
}

strut_status strut_run_check_states(const strut_run *run) {
  const strut_feedback_table *feedback = &run->model->feedback;
  const strut_scene *scene = run->model->scene;
  for (int32_t i = 0; i < feedback->state_count; i++) {
    if (isfinite(run->state->v[feedback->base + i])) continue;
    bool own = (size_t)i < scene->state_count,
         bent = i >= feedback->state_count - feedback->bristle_count;
    return strut_fail(
        run->error, STRUT_DIVERGED,
        "%s%s%s is no longer a finite number at t = %.9g s with dt = %g s; look at its "
        "rate, or use a smaller step",
        own    ? "state '"
        : bent ? "the bend of bristles"
               : "the lag of a signal or the force of a Maxwell branch",
        own ? scene->states[i].name : "", own ? "'" : "", strut_run_time(run), run->dt);
  }
  return STRUT_OK;
}

strut_status strut_run_check_balance(const strut_run *run) {
  const strut_energy *energy = &run->summary->energy;
  strut_status states = strut_run_check_states(run);
  if (states) return states;
  int32_t lost = strut_run_find_lost_node(run->model, run->state);
  if (lost >= 0) return strut_run_fail_lost_node(run, lost);
  if (isfinite(energy->residual) && isfinite(energy->moved)) return check_losses(run);
  return strut_fail(
      run->error, STRUT_DIVERGED,
      "the energy balance (%s) is no longer a finite number at t = %.9g s with dt = "
      "%g s, and fastest is node '%s'; look for a stiffness, law or drive that is far "
      "too large there",
      first_not_finite(energy), strut_run_time(run), run->dt, fastest_node(run, false));
}

strut_status strut_run_fail_method(const strut_run *run) {
  static const char *const why[] = {
      [STRUT_FAILURE_STEP] =
          "the step needed for the tolerance became too small to advance the time; use a larger "
          "solver.tolerance, or look for a member of zero length",
      [STRUT_FAILURE_NEWTON] =
          "the iteration of the implicit step did not converge; use a smaller step",
      [STRUT_FAILURE_RIGID] =
          "the lengths of rigid bars cannot be kept; use a smaller step, or look for bars that "
          "constrain each other",
      [STRUT_FAILURE_INTERRUPT] = "it was interrupted"};
  if (run->state->trouble == STRUT_FAILURE_IMPLICIT)
    return strut_fail(
        run->error, STRUT_DIVERGED,
        "%s found no solution of its step at t = %.9g s, near node '%s', with dt = %g s; use a "
        "smaller step, or look there for a member whose length passes through zero",
        run->method->name, strut_run_time(run),
        run->summary->end.node_names[run->state->trouble_node], run->dt);
  if (run->state->trouble == STRUT_FAILURE_RELAY)
    return strut_fail(
        run->error, STRUT_DIVERGED,
        "relay '%s' switches at t = %.9g s, and what it drives takes its own input past the other "
        "threshold at once, so that it would switch back without end; set the thresholds further "
        "apart, or sample it ('every')",
        run->model->scene->signals[run->state->trouble_node].name, strut_run_time(run));
  if (run->state->trouble == STRUT_FAILURE_GUIDE) {
    const uint32_t *at = run->model->elements.at + run->state->trouble_node;
    const char *const *name = run->summary->end.node_names;
    return strut_fail(
        run->error, STRUT_DIVERGED,
        "'%s' and '%s' meet at (%.6g, %.6g) m at t = %.9g s: the cable that runs there would be "
        "pulled through its guide; end the run before, or keep the two apart by a collision",
        name[at[0] / 2], name[at[1] / 2], run->state->q[at[0]], run->state->q[at[0] + 1],
        run->state->trouble_time);
  }
  return strut_fail(run->error, STRUT_DIVERGED, "%s failed at t = %.9g s: %s", run->method->name,
                    strut_run_time(run), why[run->state->trouble]);
}

/*
 * Has most of the exchanged energy appeared without a source? This happens where motions grow by
 * numerical instability, also those that slack cables and open contacts bound.
 */
static bool has_spurious_energy(const strut_run *run) {
  strut_energy e;
  if (!run->state->balance) return false;
  if (!(run->dt > 0.5 * run->summary->step_limit))
    return false; /* far below the limit, the step is not the cause */
  strut_balance_fill(run->model, run->state, &run->watch.initial,
                     strut_time_grid_at(&run->grid, run->state->step), &e);
  double there = e.kinetic + e.elastic + fabs(e.gravity) + e.contact;
  return e.residual > 0.5 * (e.moved + fabs(e.initial) + there);
}

strut_status strut_run_check_step_limit(strut_run *run) {
  if (run->state->step < run->watch.limit.next) return STRUT_OK;
  strut_stick_band_sample(run->model, run->state, &run->watch.band);
  bool unstable = !run->options->force && has_spurious_energy(run);
  if (unstable && !(run->watch.limit.lowest > 0.0))
    strut_step_limit_monitor_check(run->model, run->state, &run->watch.limit);
  if (!unstable) strut_step_limit_monitor_sample(run->model, run->state, &run->watch.limit);
  if (run->options->force) return STRUT_OK;
  if (!run->watch.limit.motion_lost && !unstable) return STRUT_OK;
  return strut_step_limit_monitor_fail(&run->watch.limit, run->state, run->summary->step_limit,
                                       run->error);
}

/* ---- warnings ---- */

/* Warns of contacts whose stick band is too narrow for the step. */
static void warn_of_narrow_bands(const strut_run *run) {
  strut_summary *summary = run->summary;
  const char *first = NULL;
  size_t count = 0;
  double needed = 0.0, times = 0.0;
  for (size_t i = 0; i < summary->end.contact_count; i++) {
    if (!(summary->end.contacts[i].band_needed > 0.0)) continue;
    if (!count++) first = summary->end.contacts[i].node;
    needed = fmax(needed, summary->end.contacts[i].band_needed);
    double band = run->model->contacts.entry[i].friction.stick_velocity;
    times = fmax(times, summary->end.contacts[i].band_needed / band);
  }
  char more[40] = "";
  if (count > 1) snprintf(more, sizeof more, " and %zu more", count - 1);
  if (count)
    strut_summary_warn(summary, "stick_band",
                       "node '%s'%s stuck only by chance, if at all: a step changes the slip "
                       "velocity by %.2g m/s, %.3g times the band; use stick_velocity >= %.2g m/s, "
                       "a smaller step, or a method with events",
                       first, more, needed, times, needed);
}

/* Warns of feet that creep at different speeds and so strain a member. */
static void warn_of_creep(const strut_run *run) {
  const strut_band_tie *tie = strut_stick_band_strained(&run->watch.band);
  if (!tie) return;
  const strut_scene *scene = run->model->scene;
  const strut_contact_entry *contact = run->model->contacts.entry;
  strut_summary_warn(run->summary, "stick_creep",
                     "nodes '%s' and '%s' stick, but creep within their stick bands at different "
                     "speeds: this strained member '%s' by up to %.2g of the static friction of "
                     "one of them, which may slip too early; use a method with events, such as "
                     "rk4-events, or a narrower band with a smaller step",
                     scene->nodes[contact[tie->contact[0]].node].name,
                     scene->nodes[contact[tie->contact[1]].node].name,
                     scene->members[tie->member].name, tie->worst);
}

/* Feet that creep faster than this part of the structure's mean speed change its motion. */
static const double WIDE = 0.1;

/* Warns of friction that gave energy, and of bands so wide that creeping is much of the motion. */
static void warn_of_wide_bands(const strut_run *run) {
  const strut_balance_monitor *monitor = &run->watch.balance;
  static const char *const remedy =
      "use 'law: coulomb' with a method with events, such as rk4-events, or a far smaller "
      "stick_velocity";
  if (run->summary->energy.rubbed > 0.0)
    strut_summary_warn(
        run->summary, "friction_gives",
        "friction gave %.3g J, which it can only take: within its band Karnopp's law "
        "balances the other forces whatever the speed, so that what should rest "
        "creeps, even uphill; %s",
        monitor->rubbed, remedy);
  if (monitor->crept > WIDE * monitor->speed)
    strut_summary_warn(run->summary, "wide_band",
                       "feet that should stick creep within their stick bands, at %.2g %% of the "
                       "mean speed of the structure, which changes its motion; %s",
                       100.0 * monitor->crept / monitor->speed, remedy);
}

static void warn_of_limit(const strut_run *run) {
  const strut_step_limit_violation *violation = &run->summary->limit_fell;
  if (run->summary->status != STRUT_OK || !(violation->limit > 0.0)) return;
  strut_summary_warn(run->summary, "step_limit",
                     "the largest stable step fell to %.4g s at t = %.9g s, below the step %g s; "
                     "use solver.step <= %.2g s",
                     violation->limit, violation->time, run->summary->step, 0.9 * violation->limit);
}

/* Quantities are not followed between steps where interpolation leaves more than this part of their size. */
static const double COARSE = 0.01;

/* Names the quantity that fixed steps follow worst between their ends. */
static void warn_of_coarse_steps(const strut_run *run) {
  const strut_summary *summary = run->summary;
  const strut_measured *worst = NULL;
  double most = COARSE;
  for (size_t i = 0;
       i < summary->measured_count && summary->status == STRUT_OK && !run->options->chosen; i++) {
    const strut_measured *measured = &summary->measured[i];
    if (!(measured->doubt > most * measured->scale)) continue;
    most = measured->doubt / measured->scale;
    worst = measured;
  }
  if (!worst) return;
  strut_summary_warn(
      run->summary, "coarse_step",
      "quantity '%s' is known only within some %.2g %%: steps of %g s are too coarse "
      "to follow it from one to the next; use a smaller step, or --accuracy 1%%",
      worst->name, 100.0 * most, summary->step);
}

/* A drive that changes by more than this part of its member within a step jumps. */
static const double JUMP = 1e-3;

typedef struct jump {
  const char *name;               /* of what is driven */
  const char *kind, *what, *unit; /* "member", "length", "m" */
  double change, time;            /* in that unit, [s] */
} jump;

/* What actuator i drives, and a value beside which its changes are large or small. */
static jump describe_drive(const strut_model *model, const strut_actuator *actuator,
                           double *scale) {
  const strut_scene *scene = model->scene;
  if (actuator->member >= 0) {
    *scale = model->members.rest[actuator->member];
    return (jump){scene->members[actuator->member].name, "member", "length", "m", 0.0, 0.0};
  }
  *scale = 1.0;
  if (actuator->hinge >= 0)
    return (jump){scene->hinges[actuator->hinge].name, "hinge", "angle", "rad", 0.0, 0.0};
  *scale = fmax(fabs(scene->cells[actuator->cell].pressure),
                fabs(scene->signals[actuator->signal].amplitude));
  *scale = fmax(*scale, DBL_MIN);
  return (jump){scene->cells[actuator->cell].name, "cell", "pressure", "N/m", 0.0, 0.0};
}

/* Finds the largest jump of a drive between two times, relative to its member. */
static jump find_jump(const strut_run *run, double from, double to) {
  const strut_scene *scene = run->model->scene;
  jump found = {.name = NULL};
  double worst = JUMP;
  for (size_t i = 0; i < scene->actuator_count; i++) {
    const strut_actuator *actuator = &scene->actuators[i];
    if (actuator->force) continue;
    double when = 0.0, length;
    jump drive = describe_drive(run->model, actuator, &length);
    double change = strut_signal_jump(scene->signals, actuator->signal, run->dt, from, to, &when);
    if (!(change > worst * length)) continue;
    worst = change / length;
    found = drive;
    found.change = change, found.time = when;
  }
  return found;
}

static bool has_touchdowns(const strut_run *run) {
  for (size_t i = 0; i < run->summary->end.contact_count; i++)
    if (run->summary->end.contacts[i].max_height > 0.0) return true;
  return false;
}

static bool has_switches(const strut_model *model) {
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *element = &model->elements.element[i];
    if (element->carries || strut_law_kinks(element->law, &element->numbers)) return true;
  }
  return false;
}

/* Does some contact stick? */
static bool has_stick(const strut_model *model) {
  for (int32_t i = 0; i < model->contacts.count; i++) {
    strut_friction_law law = model->contacts.entry[i].friction.law;
    if (strut_friction_has_band(law) || strut_friction_is_exact(law)) return true;
  }
  return false;
}

/* Events that fixed steps pass over, or NULL. */
static const char *describe_missed_events(const strut_run *run) {
  if (run->method->events || run->method->region == STRUT_REGION_ALL) return NULL;
  bool friction = has_stick(run->model), cables = run->model->terms & STRUT_TERM_SLACK;
  bool bounces = has_touchdowns(run);
  if (bounces && friction) return "touchdowns and changes between sticking and slipping";
  if (bounces) return "touchdowns";
  if (friction) return "changes between sticking and slipping";
  if (cables) return "cables that become taut";
  if (run->model->terms & STRUT_TERM_MEMORY) return "what breaks, is released, yields or folds";
  return has_switches(run->model) ? "stops, cables or kinks of laws" : NULL;
}

/* Explains an open balance: likely cause and remedy. */
static void explain_balance(const strut_run *run, char *text, size_t size) {
  const strut_balance_monitor *monitor = &run->watch.balance;
  bool sudden = fabs(monitor->worst) > 0.5 * fabs(run->summary->energy.residual);
  double offset = run->grid.offset, from = monitor->from + offset, to = monitor->to + offset;
  double begin = (double)run->first * run->dt + offset, now = strut_run_time(run);
  jump j =
      sudden ? find_jump(run, from - run->dt, to) : find_jump(run, begin + 1e-3 * run->dt, now);
  const char *over = describe_missed_events(run);
  if (run->options->chosen) {
    snprintf(text, size, "%s", STRUT_BALANCE_CHOSEN);
    return;
  }
  int used = sudden ? snprintf(text, size, ", most of it by t = %.6g s", to) : 0;
  text += used, size -= (size_t)used;
  if (j.name)
    snprintf(text, size,
             "; likely because the drive of %s '%s' changes its %s by %.3g %s within one step at "
             "t = %.6g s; spread the change over many steps, use a smaller step, or --accuracy 1%%",
             j.kind, j.name, j.what, j.change, j.unit, j.time);
  else if (over)
    snprintf(text, size,
             "; likely because fixed steps pass over %s; use rk4-events, a smaller step, or "
             "--accuracy 1%%",
             over);
  else if (run->method->lag == 0.0)
    snprintf(text, size,
             "; the tolerance of %g allows that; use a smaller solver.tolerance, or --accuracy 1%%",
             run->experiment->tolerance);
  else
    snprintf(text, size,
             "; likely because the step of %g s is too large for the fastest motion; use a smaller "
             "step, or --accuracy 1%%",
             run->dt);
}

static void warn_of_balance(const strut_run *run) {
  char why[400] = "";
  if (run->summary->balance == STRUT_BALANCE_OPEN) explain_balance(run, why, sizeof why);
  strut_balance_warn(run->summary, why);
}

/* Phase errors of vibrations matter from here on [rad]: they are errors relative to the amplitude. */
static const double SHIFTED = 0.05;
/* Less of the exchanged energy than this is no motion, but its rounding. */
static const double AT_REST = 1e-6;

/*
 * The largest error from the phase that fixed steps lose, relative to a vibration's first amplitude, which
 * dampers and friction reduce as exp(-decay t / 2); *rate: its frequency [rad/s].
 */
static double shifted_phase(const strut_run *run, double *rate) {
  const strut_motion_frequency *frequency = &run->watch.frequency;
  const strut_energy *energy = &run->summary->energy;
  double time = run->summary->duration;
  if (!(frequency->movement > AT_REST * energy->moved && frequency->curvature > 0.0)) return 0.0;
  *rate = sqrt(frequency->curvature / frequency->movement);
  double rubbed = fmax(0.0, energy->dissipated_friction) * (double)frequency->samples / time;
  double decay = (frequency->damping + rubbed) / frequency->movement,
         lasts = fmin(time, 2.0 / decay);
  double z = *rate * run->dt,
         lag = run->method->lag * z * z * (run->method->order > 2 ? z * z : 1.0);
  return lag * *rate * lasts * exp(-0.5 * decay * lasts);
}

/* States that the error is unknown where steps pass over events, or lose the phase of vibrations. */
static void add_caveat(const strut_run *run) {
  strut_summary *summary = run->summary;
  const char *events = describe_missed_events(run);
  double rate = 0.0, shift = shifted_phase(run, &rate);
  summary->caveat[0] = '\0';
  if (run->options->chosen || summary->status != STRUT_OK) return;
  if (events)
    snprintf(summary->caveat, sizeof summary->caveat, "fixed steps of %s pass over %s",
             summary->method, events);
  else if (summary->spent.forced)
    snprintf(summary->caveat, sizeof summary->caveat,
             "contacts or laws switch too often to be followed in %lld steps, first at t = %.6g s; "
             "use a smaller solver.step",
             (long long)summary->spent.forced, run->state->forced.first + run->grid.offset);
  else if (shift > SHIFTED)
    snprintf(summary->caveat, sizeof summary->caveat,
             "steps of %.3g s shift the phase of vibrations at %.3g Hz, where most of the kinetic "
             "energy is, by some %.2g rad",
             run->dt, rate / STRUT_TAU, shift);
}

void strut_run_warn(const strut_run *run) {
  add_caveat(run);
  strut_summary_warn_of_start(run->summary);
  warn_of_balance(run);
  warn_of_narrow_bands(run);
  warn_of_creep(run);
  warn_of_wide_bands(run);
  warn_of_limit(run);
  warn_of_coarse_steps(run);
  warn_of_tunnelling(run);
  if (run->bristles.decay > 0.0) warn_of_bristles(run);
}
