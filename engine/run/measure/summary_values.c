/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a run has, a row for each value. */
#include <math.h>
#include <stdio.h>

#include "engine/base/text.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"

static void write_warning(const strut_result_object *of, char text[STRUT_VALUE_ROOM]) {
  strut_settle_warning(of->at, text, STRUT_VALUE_ROOM);
}

#define SETTLE(X)                                                                                  \
  X("step", "s", NUMBER(how->step), "of the method that settled")                                  \
  X("evaluations", "", COUNT(how->evaluations), "of the forces; not among the run's")              \
  X("perturbations", "", COUNT(how->perturbations), "off an unstable equilibrium")                 \
  X("stable", "", FLAG(!how->unstable), "whether the equilibrium is")                              \
  X("node", "", TEXT(how->node), "that moves most where it is not")                                \
  X("stiffness", "N/m", NUMBER(how->unstable ? how->stiffness : (double)NAN),                      \
    "lowest eigenvalue where it is not")                                                           \
  X("growth_rate", "1/s", NUMBER(how->unstable ? how->growth_rate : (double)NAN),                  \
    "of that motion without damping")                                                              \
  X("warning", "", WORDS(write_warning), "in words", .label = {""})
STRUT_VALUES(strut_settle_values, SETTLE, const strut_settle_summary *how = of->at)

/* ---- groups ---- */

#define WARNING(X)                                                                                 \
  X("code", "", TEXT(warning->code), "for programs")                                               \
  X("text", "", TEXT(warning->text), "finding, likely cause and remedy")
STRUT_VALUES_HERE(warning_values, WARNING, const strut_warning *warning = of->at)

#define FELL(X)                                                                                    \
  X("limit", "s", NUMBER(fell->limit), "largest stable step where it was lowest")                  \
  X("time", "s", NUMBER(fell->time), "when it was")                                                \
  X("since", "s", NUMBER(fell->since), "when it first fell below the step")                        \
  X("steps", "", COUNT(fell->steps), "that were larger")
STRUT_VALUES_HERE(fell_values, FELL, const strut_step_limit_violation *fell = of->at)

#define STEADY(X)                                                                                  \
  X("kind", "", TEXT(strut_motion_name(steady->kind)), "periodic, irregular, transient, creeping") \
  X("repeats", "1", COUNT(steady->repeats), "drive periods of one repetition")                     \
  X("periods", "1", COUNT(steady->periods), "drive periods until that was known")                  \
  X("velocity_interval", "m/s", NUMBER(steady->interval), "half its 95 % confidence interval")     \
  X("residual", "1", NUMBER(steady->residual), "change of the shape over one repetition")
STRUT_VALUES_HERE(steady_values, STEADY, const strut_steady_summary *steady = of->at)

#define ACCURACY(X)                                                                                \
  X("wanted", "1", NUMBER(accuracy->wanted), "relative error asked for")                           \
  X("expected", "1", NUMBER(accuracy->expected),                                                   \
    "relative error to expect of the velocity; null: not known")                                   \
  X("kept", "1", FLAG(accuracy->kept), "whether it is within what was asked for")                  \
  X("scale", "m/s", NUMBER(accuracy->scale), "velocity below which errors are not relative")       \
  X("why", "", TEXT(accuracy->why), "method, step and reason")                                     \
  X("check_evaluations", "1", COUNT(accuracy->check_evaluations), "of forces, besides the run's")
STRUT_VALUES_HERE(accuracy_values, ACCURACY, const strut_accuracy_summary *accuracy = of->at)

/* The residual of the balance and what it means, in one statement. */
static void write_residual(const strut_result_object *of, char text[STRUT_VALUE_ROOM]) {
  const strut_summary *summary = of->at;
  const strut_energy *energy = &summary->energy;
  strut_rounded_quantity residual = strut_quantity_of(energy->residual, 4, "J");
  bool kept = summary->balance != STRUT_BALANCE_NOT_KEPT && energy->moved > 0.0 &&
              isfinite(energy->residual);
  double part = fabs(energy->residual) / energy->moved;
  if (!kept && energy->residual != 0.0)
    snprintf(text, STRUT_VALUE_ROOM, "%s", residual.text);
  else if (kept && summary->balance == STRUT_BALANCE_OPEN)
    snprintf(text, STRUT_VALUE_ROOM, "%s, balance NOT closed: %.2g %% of the energy exchanged",
             residual.text, 100.0 * part);
  else if (kept)
    snprintf(text, STRUT_VALUE_ROOM, "%s, balance closed%s", residual.text,
             part <= 0.01 ? " within 1 % of the energy exchanged"
                          : " up to the rounding of the stored energy");
}

#define ENERGY(X)                                                                                  \
  STRUT_ENERGY_TABLE(ENERGY_OF_##X)                                                                \
  X("input_work", "J", IF(s->controlled, NUMBER(s->input_work)), "by a controller; in drive_work") \
  X("initial", "J", NUMBER(s->energy.initial), "at the beginning")                                 \
  X("residual", "J", NUMBER(s->energy.residual), "that appeared without a source")                 \
  X("exchanged", "J", NUMBER(s->energy.moved), "what the residual compares to")                    \
  X("balance", "", TEXT(strut_balance_name(s->balance)), "closed or open; null: not kept")         \
  X("note", "", WORDS(write_residual), "residual and balance in words")
#define ENERGY_OF_STRUT_VALUE_ROW(NAME, KIND, LABEL) STRUT_VALUE_ROW(#NAME, "J", , LABEL)
#define ENERGY_OF_STRUT_VALUE_FILL(NAME, KIND, LABEL)                                              \
  STRUT_VALUE_FILL(#NAME, "J", NUMBER(s->energy.NAME), LABEL)
STRUT_VALUES_HERE(energy_values, ENERGY, const strut_summary *s = of->at)

/* ---- things, each under its name ---- */

static const strut_summary *summary_of(const strut_result_object *of) { return of->at; }

#define NAME_OF(THINGS, NAME)                                                                      \
  static const char *name_of_##THINGS(const strut_result_object *of, size_t i) {                   \
    return summary_of(of)->NAME;                                                                   \
  }
NAME_OF(measured, measured[i].name)
NAME_OF(nodes, end.node_names[i])
NAME_OF(hinges, end.hinges[i].hinge)
NAME_OF(cells, end.cells[i].cell)
NAME_OF(breaks, end.breaks[i].name)
NAME_OF(jumps, end.jumps[i].name)
NAME_OF(contacts, end.contacts[i].node)

/* Was the error of a quantity looked at? */
static bool is_judged(const strut_measured *m, const strut_summary *s) {
  return isfinite(m->expected) || (strut_measured_arrival(m) && s->accuracy.wanted > 0.0);
}

/* What is to be known of it beside its value. */
static void write_note(const strut_result_object *of, char text[STRUT_VALUE_ROOM]) {
  const strut_measured *m = of->at;
  const strut_summary *s = summary_of(of->outer);
  const char *missing = s->status != STRUT_OK       ? "the window was not reached"
                        : strut_measured_arrival(m) ? "the target was not reached"
                                                    : "not finite";
  const char *plain[] = {m->undecided      ? "not decided"
                         : isnan(m->value) ? missing
                                           : NULL,
                         m->zero ? "zero up to rounding" : NULL};
  size_t used = 0, room = STRUT_VALUE_ROOM;
  for (int i = 0; i < 2; i++)
    if (plain[i])
      used += (size_t)snprintf(text + used, room - used, "%s%s", used ? "; " : "", plain[i]);
  if (m->member)
    used += (size_t)snprintf(text + used, room - used, "%sin %.40s", used ? "; " : "", m->member);
  if (isfinite(m->expected))
    snprintf(text + used, room - used, "%s%s within %s", used ? "; " : "",
             m->kept ? "known" : "NOT as accurate as requested, but",
             strut_quantity_of_any(m->expected, 2, m->unit).text);
}

#define MEASURED(X)                                                                                \
  X("value", "", CALLED(NULL, m->unit, m->value),                                                  \
    "in its SI unit; null: its window was not reached", .label = {""})                             \
  X("unit", "", TEXT(m->unit), "SI")                                                               \
  X("spread", "", CALLED(NULL, m->unit, m->spread),                                                \
    "standard deviation over the window's periods", .label = {""})                                 \
  X("scale", "", NUMBER(m->scale), "its largest magnitude over the window, or that of its terms")  \
  X("zero", "", FLAG(m->zero), "whether it is zero up to rounding")                                \
  X("member", "", IF(m->member, TEXT(m->member)), "that has the largest force")                    \
  X("arrival", "", IF(strut_measured_arrival(m), TEXT(strut_measured_arrival(m))),                 \
    "reached, never, or not decided")                                                              \
  X("expected", "", IF(isfinite(m->expected), NUMBER(m->expected)), "error to expect, SI")         \
  X("kept", "", IF(is_judged(m, summary_of(of->outer)), FLAG(m->kept)),                            \
    "within what was asked for")                                                                   \
  X("note", "", WORDS(write_note), "what else is known, in words", .label = {""})
STRUT_VALUES_HERE(measured_values, MEASURED, const strut_measured *m = of->at)

#define DERIVATIVE(X)                                                                              \
  X("of", "", TEXT(d->of), "what is measured", .label = {""})                                      \
  X("by", "", TEXT(d->by), "a parameter", .label = {""})                                           \
  X("value", "", NUMBER(d->is.value), "in the unit below; null: there is none", .label = {""})     \
  X("error", "", NUMBER(d->is.error), "of the value", .label = {""})                               \
  X("unit", "", TEXT(d->unit), "SI", .label = {""})                                                \
  X("verdict", "", TEXT(strut_derivative_words(d->is.verdict)),                                    \
    "differentiable, not differentiable here, not known", .label = {""})
STRUT_VALUES_HERE(derivative_values, DERIVATIVE, const strut_summary_derivative *d = of->at)

#define NODE(X) X("position", "m", NUMBERS(of->at, 2), "at the end", .label = {"x", "y"})
STRUT_VALUES_HERE(node_values, NODE, )

#define HINGE(X)                                                                                   \
  X("angle", "rad", NUMBER(hinge->angle), "at the end", .label = {""})                             \
  X("moment", "N m", NUMBER(hinge->moment), "at the end", .label = {""})
STRUT_VALUES_HERE(hinge_values, HINGE, const strut_hinge_summary *hinge = of->at)

#define CELL(X)                                                                                    \
  X("area", "m^2", NUMBER(cell->area), "at the end", .label = {""})                                \
  X("pressure", "N/m", NUMBER(cell->pressure), "at the end", .label = {""})
STRUT_VALUES_HERE(cell_values, CELL, const strut_cell_summary *cell = of->at)

#define BROKEN(X)                                                                                  \
  X("time", "s", NUMBER(broken->time), "when it broke", .label = {"from"})                         \
  X("released", "", FLAG(broken->released), "on purpose", .label = {""})
STRUT_VALUES_HERE(broken_values, BROKEN, const strut_break_summary *broken = of->at)

#define JUMP(X)                                                                                    \
  X("count", "", COUNT(jump->count), "of jumps since the run began", .label = {"times"})           \
  X("last", "s", NUMBER(jump->last), "time of the last one", .label = {"last at"})                 \
  X("energy", "J", NUMBER(jump->freed), "that they set free", .label = {"set free"})
STRUT_VALUES_HERE(jump_values, JUMP, const strut_jump_summary *jump = of->at)

#define CONTACT(X)                                                                                 \
  X("duty", "1", NUMBER(contact->duty), "share of the window in contact",                          \
    .label = {"contact time"})                                                                     \
  X("max_height", "m", NUMBER(contact->max_height), "above the ground in the window",              \
    .label = {""})                                                                                 \
  X("stick_velocity_needed", "m/s", IF(contact->band_needed > 0.0, NUMBER(contact->band_needed)),  \
    "for sticking with this step")
STRUT_VALUES_HERE(contact_values, CONTACT, const strut_contact_summary *contact = of->at)

/* ---- a run ---- */

static void write_worth(const strut_result_object *of, char text[STRUT_VALUE_ROOM]) {
  strut_summary_worth(of->at, text, STRUT_VALUE_ROOM);
}

#define SUMMARY(X)                                                                                 \
  X("language", "", COUNT(STRUT_LANGUAGE_VERSION), "version of the scene's language")              \
  X("status", "", TEXT(strut_status_text(s->status)), "how the run ended")                         \
  X("reason", "", TEXT(s->reason[0] ? s->reason : NULL), "why, where it failed")                   \
  X("warnings", "", LIST(s->warnings, s->warning_count), "once for each cause",                    \
    .rows = &warning_values)                                                                       \
  X("worth", "", WORDS(write_worth), "what the numbers are worth, in words")                       \
  X("caveat", "", TEXT(s->caveat[0] ? s->caveat : NULL), "why the error is not known")             \
  X("velocity", "m/s", NUMBER(s->velocity), "mean over the window, along x")                       \
  X("velocity_spread", "m/s", NUMBER(s->velocity_spread), "standard deviation over its periods")   \
  X("velocity_zero", "1", IF(s->velocity_zero, FLAG(true)), "it is zero up to rounding")           \
  X("window_start", "s", NUMBER(s->window.start), "of the window that means are taken over")       \
  X("window_duration", "s", NUMBER(s->window.time), "of that window")                              \
  X("window_drive_work", "J", NUMBER(s->window.work), "of the actuators in that window")           \
  X("duration", "s", NUMBER(s->duration), "of the run")                                            \
  X("settle_time", "s", NUMBER(s->settle_time), "simulated before it, to come to rest")            \
  X("settle", "", IF(s->settle.evaluations, PART(&s->settle)), "how the start settled",            \
    .rows = &strut_settle_values)                                                                  \
  X("steps", "1", COUNT(s->spent.steps), "of the run")                                             \
  X("force_evaluations", "1", COUNT(s->spent.evaluations), "of the run")                           \
  X("events", "1", COUNT(s->spent.events), "located in time")                                      \
  X("forced_steps", "1", IF(s->spent.forced > 0, COUNT(s->spent.forced)),                          \
    "in which something switched too often to be followed")                                        \
  X("method", "1", TEXT(s->method), "of integration")                                              \
  X("step", "s", NUMBER(s->step), "its step")                                                      \
  X("step_limit", "s", NUMBER(s->step_limit), "largest stable one; null: none")                    \
  X("feedback", "", IF(s->feedback, FLAG(true)), "which `step_limit` leaves out")                  \
  X("step_limit_violation", "", IF(s->limit_fell.limit > 0.0, PART(&s->limit_fell)),               \
    "where the largest stable step fell below the step", .rows = &fell_values)                     \
  X("steady", "", IF(s->steady.kind, PART(&s->steady)), "kind of motion", .rows = &steady_values)  \
  X("accuracy", "", IF(s->accuracy.wanted > 0.0, PART(&s->accuracy)), "where one was asked for",   \
    .rows = &accuracy_values)

#define THINGS(X)                                                                                  \
  X("measured", "",                                                                                \
    IF(s->measured_count, NAMED(s->measured, s->measured_count, name_of_measured)),                \
    "quantities of `measure`", .rows = &measured_values, .label = {""})                            \
  X("derivatives", "", IF(s->derivative_count, LIST(s->derivatives, s->derivative_count)),         \
    "of what is measured by parameters", .rows = &derivative_values, .label = {"derivatives"})     \
  X("parameters", "", PARAMETERS, "of the scene")                                                  \
  X("nodes", "", NAMED((const double(*)[2])s->end.positions, s->end.node_count, name_of_nodes),    \
    "at the end", .rows = &node_values, .label = {"node"})                                         \
  X("hinges", "",                                                                                  \
    IF(s->end.hinge_count, NAMED(s->end.hinges, s->end.hinge_count, name_of_hinges)),              \
    "at the end", .rows = &hinge_values, .label = {"hinge"})                                       \
  X("cells", "", IF(s->end.cell_count, NAMED(s->end.cells, s->end.cell_count, name_of_cells)),     \
    "at the end", .rows = &cell_values, .label = {"cell"})                                         \
  X("broken", "",                                                                                  \
    IF(s->end.break_count, NAMED(s->end.breaks, s->end.break_count, name_of_breaks)),              \
    "what broke or was released", .rows = &broken_values, .label = {"carries nothing"})            \
  X("jumps", "", IF(s->end.jump_count, NAMED(s->end.jumps, s->end.jump_count, name_of_jumps)),     \
    "elements whose law folds and that jumped", .rows = &jump_values, .label = {"jumps at folds"}) \
  X("contacts", "", NAMED(s->end.contacts, s->end.contact_count, name_of_contacts),                \
    "over the window", .rows = &contact_values, .label = {"contact"})                              \
  X("energy", "", PART(s), "at the end of the run, works and losses over all of it",               \
    .rows = &energy_values)

#define UNTIMED(X) SUMMARY(X) THINGS(X)
#define TIMED(X)                                                                                   \
  SUMMARY(X)                                                                                       \
  X("wall_time", "s", NUMBER(s->spent.wall_time), "spent stepping") THINGS(X)
STRUT_VALUES(strut_summary_values, UNTIMED, const strut_summary *s = of->at)
STRUT_VALUES(strut_timed_summary_values, TIMED, const strut_summary *s = of->at)

#define COLUMN(X)                                                                                  \
  X("work_per_distance", "N", NUMBER(strut_summary_work_per_distance(s)), "of the drives")         \
  X("cost_of_transport", "1", NUMBER(strut_summary_cost_of_transport(s)),                          \
    "the same over the weight")
STRUT_VALUES(strut_summary_column_values, COLUMN, const strut_summary *s = of->at)
