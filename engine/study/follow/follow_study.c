/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/follow/follow_parts.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/run/accuracy/accuracy.h"
#include "engine/scene/things.h"
#include "engine/statics/equilibria/equilibria.h"

/* Accuracy of velocities, relative; the tolerance of error control for it; steps of a period. */
static const double ACCURACY = STRUT_FOLLOW_USUAL_PERCENT / 100, TOLERANCE = 1e-3;
enum { STEPS_PER_PERIOD = 50, FIXED_STEPS = 2000 };
/* A run that starts a branch: its accuracy, tolerance of steady motion, and periods. */
static const double START_ACCURACY = 0.02, START_TOLERANCE = 0.005;
static const double LEAST_PERIODS = 300.0, MOST_PERIODS = 2000.0;
/* Longest step of the parameter, in its range. */
static const double LONGEST = 0.02;
/* Most drive periods of a doubled branch. */
enum { MOST_REPEATS = 16 };
/* Runs between attempts to make a motion exact, and their length in its repetitions. */
enum { MORE_RUNS = 4, MORE_PERIODS = 15 };

typedef struct follower {
  const strut_follow_options *o;
  strut_follow_result *r;
  strut_follow_system s;
  strut_follow_limits limits;
  strut_error *error;
  bool opened, stepped; /* stepped: fixed steps, whose number has been chosen */
} follower;

void strut_follow_note(strut_follow_result *result, const char *format, ...) {
  va_list arguments;
  if (result->note_count == sizeof result->notes / sizeof result->notes[0]) return;
  va_start(arguments, format);
  vsnprintf(result->notes[result->note_count++], STRUT_FOLLOW_NOTE, format, arguments);
  va_end(arguments);
}

/* A copy of a text that belongs to the result; NULL of NULL, or out of memory. */
static char *copy_text(strut_follow_result *result, const char *text) {
  return text ? strut_arena_format(&result->arena, "%s", text) : NULL;
}

/* The values of both parameters at one of the first. */
#define VALUES_AT(SELF, VALUE) ((const double[2]){VALUE, (SELF)->o->second.value})

/* ---- starts ---- */

static strut_status place_start(follower *self, const strut_follow_start *start,
                                strut_setup *setup) {
  strut_scene *scene = &setup->scene;
  if (start->from) {
    scene->start_equilibrium = strut_thing_find(scene, STRUT_THING_CONFIGURATION, start->from);
    if (scene->start_equilibrium < 0)
      return strut_fail(self->error, STRUT_USAGE,
                        "the model has no configuration '%s' to start from", start->from);
    setup->experiment.settle.wanted = false;
  }
  return strut_resolve_start_equilibrium(setup, self->error);
}

/* Runs from the start until the motion is steady; `y` becomes a state of it at the start of a period. */
static strut_status run_start(follower *self, const strut_setup *setup, const strut_model *model,
                              double *unknowns, strut_summary *summary) {
  strut_experiment e = setup->experiment;
  size_t length = (size_t)model->length;
  strut_snapshot end = {.q = unknowns, .v = unknowns + length};
  e.accuracy = START_ACCURACY;
  e.steady.wanted = true;
  e.steady.tolerance = START_TOLERANCE;
  e.quantity_count = 0;
  e.periods = fmin(fmax(e.periods, LEAST_PERIODS), MOST_PERIODS);
  e.measure_last = fmin(e.measure_last, e.periods);
  e.output_last = 0.0;
  strut_run_options options = {
      .interrupt = self->o->interrupt, .without_balance = true, .to = &end};
  strut_status status = strut_simulate_accurately(model, &e, &options, summary, self->error);
  unknowns[2 * length] = 0.0;
  return status;
}

static double accuracy_of(const follower *self) {
  return self->o->accuracy > 0.0 ? self->o->accuracy : ACCURACY;
}

/* Opens the system at the value with a method. */
static strut_status open_with(follower *self, double value, const char *method) {
  strut_follow_system *system = &self->s;
  bool adaptive = strcmp(method, strut_integrator_for(STRUT_ROLE_REFERENCE)->name) == 0;
  *system = (strut_follow_system){.scenes = self->o->scenes,
                                  .parameters = 1,
                                  .low = {self->o->low},
                                  .high = {self->o->high},
                                  .how.method = method,
                                  .how.tolerance = fmin(2.5e-6, accuracy_of(self) * TOLERANCE),
                                  .how.steps_per_period = adaptive ? STEPS_PER_PERIOD : FIXED_STEPS,
                                  .how.repeats = 1,
                                  .how.threads = self->o->threads,
                                  .how.interrupt = self->o->interrupt};
  snprintf(self->r->method, sizeof self->r->method, "%s", method);
  self->r->tolerance = system->how.tolerance;
  self->opened = true;
  return strut_follow_open(system, VALUES_AT(self, value), self->error);
}

/*
 * Fixed steps make the smoothest period map; where variations cannot follow them, or there would be too many,
 * the method with error control serves.
 */
static strut_status open_system(follower *self, double value) {
  strut_follow_system *system = &self->s;
  const char *fixed = strut_integrator_for(STRUT_ROLE_EXACT_STICK)->name;
  const char *careful = strut_integrator_for(STRUT_ROLE_REFERENCE)->name;
  if (self->opened) {
    strut_follow_set_value(system, VALUES_AT(self, value));
    return system->status;
  }
  strut_status status = open_with(self, value, self->o->method ? self->o->method : fixed);
  if (!status && !self->o->method) {
    self->stepped = system->variation && strut_follow_choose_steps(system, accuracy_of(self));
    status = system->status;
    if (!status && !self->stepped) {
      strut_follow_close(system);
      status = open_with(self, value, careful);
    }
  }
  if (status) return status;
  self->r->title =
      copy_text(self->r, system->setup.scene.name ? system->setup.scene.name : "model");
  return self->r->title ? STRUT_OK : strut_no_memory(self->error, "");
}

/* Is the motion on a branch that is known? Notes it. */
static bool is_known(follower *self, const double *unknowns, const char *label) {
  for (size_t i = 0; i < self->r->count; i++) {
    const strut_follow_branch *branch = &self->r->branches[i].branch;
    if (branch->repeats != self->s.how.repeats || !strut_follow_is_on(&self->s, branch, unknowns))
      continue;
    strut_follow_note(self->r, "the motion from %s is on branch %zu", label, i + 1);
    return true;
  }
  return false;
}

static void add_branch(follower *self, const double *unknowns, const double *direction,
                       const char *label, int32_t parent) {
  if (self->r->count == STRUT_FOLLOW_MOST_BRANCHES) {
    strut_follow_note(self->r, "there are more branches, which were not followed");
    return;
  }
  strut_followed_branch *branch = &self->r->branches[self->r->count];
  branch->parent = parent;
  snprintf(branch->label, sizeof branch->label, "%s", label);
  strut_status status =
      strut_follow_branch_make(&self->s, unknowns, direction, &self->limits, &branch->branch);
  if ((!status || status == STRUT_INTERRUPTED) && branch->branch.count >= 2) {
    self->r->count++;
    return;
  }
  const char *why = branch->branch.ends[1];
  if (!status)
    strut_follow_note(self->r, "no branch leads away from %s%s%s", label, *why ? ": " : "", why);
  strut_follow_branch_free(&branch->branch);
}

/*
 * Makes the motion exact. Where Newton's method does not get there, as at kinks, a stable motion is
 * approached by running on.
 */
static bool make_exact(follower *self, double *unknowns, char reason[200]) {
  strut_follow_system *system = &self->s;
  bool found = strut_follow_correct(system, unknowns, reason);
  for (int k = 0; k < MORE_RUNS && !system->status && !found; k++) {
    for (int i = 0; i < MORE_PERIODS; i++)
      if (!isfinite(strut_follow_apply(system, unknowns, false).travel)) return false;
    strut_follow_centre(system, unknowns);
    found = strut_follow_correct(system, unknowns, reason);
  }
  return found;
}

/* The motion at the start, which the run has found, and its branch. */
static void follow_motion(follower *self, const char *label, double *unknowns, int32_t repeats) {
  strut_follow_system *system = &self->s;
  bool first = self->r->count == 0;
  char reason[200] = "";
  if (!strut_follow_set_periods(system, repeats, system->how.steps_per_period)) return;
  if (first && !strut_follow_set_units(system, unknowns)) return;
  strut_follow_centre(system, unknowns);
  bool found = make_exact(self, unknowns, reason);
  if (found && self->stepped && first)
    strut_follow_check_steps(system, unknowns, accuracy_of(self));
  if (system->status) return;
  if (!found) {
    strut_follow_note(self->r, "the motion from %s: %s", label, reason);
    return;
  }
  strut_follow_centre(system, unknowns);
  if (!is_known(self, unknowns, label) && !system->status)
    add_branch(self, unknowns, NULL, label, -1);
}

static strut_status follow_start(follower *self, const strut_follow_start *start) {
  char label[STRUT_FOLLOW_LABEL];
  strut_setup setup;
  strut_model *model = NULL;
  strut_summary summary = {0};
  snprintf(label, sizeof label, "%s%s%s", start->from ? start->from : "", start->from ? " at " : "",
           strut_quantity_of_any(start->value, 6, *self->o->unit ? self->o->unit : "1").text);
  strut_status status = open_system(self, start->value);
  if (status) return status;
  status = self->o->scenes.setup(self->o->scenes.context, VALUES_AT(self, start->value), &setup,
                                 self->error);
  if (status) return status;
  status = place_start(self, start, &setup);
  if (!status) status = strut_model_compile(&setup.scene, &model, self->error);
  double *y = status ? NULL : strut_allocate(self->s.both, sizeof *y);
  if (!status && !y) status = strut_no_memory(self->error, "");
  if (!status) status = run_start(self, &setup, model, y, &summary);
  if (status == STRUT_DIVERGED || status == STRUT_WORK_LIMIT) {
    strut_follow_note(self->r, "the run from %.80s failed: %.200s", label, self->error->message);
    status = STRUT_OK;
  } else if (!status && summary.steady.kind != STRUT_MOTION_PERIODIC) {
    strut_follow_note(self->r,
                      "the motion from %s is %s after %" PRId64 " periods, which starts no branch",
                      label, strut_motion_name(summary.steady.kind), summary.steady.periods);
  } else if (!status) {
    follow_motion(self, label, y, summary.steady.repeats > 0 ? summary.steady.repeats : 1);
    status = self->s.status;
  }
  strut_summary_free(&summary);
  strut_release(y);
  strut_model_free(model);
  strut_setup_free(&setup);
  return status;
}

/* ---- doubled branches ---- */

static void follow_doubling(follower *self, size_t index, const strut_follow_point *point) {
  char label[STRUT_FOLLOW_LABEL];
  strut_follow_system *system = &self->s;
  int32_t repeats = 2 * self->r->branches[index].branch.repeats;
  double value = point->at.value[0];
  if (repeats > MOST_REPEATS) return;
  snprintf(label, sizeof label, "the period doubling of branch %zu at %s", index + 1,
           strut_quantity_of_any(value, 6, *self->o->unit ? self->o->unit : "1").text);
  /* it may be known from another doubling, at its other end */
  for (size_t i = 0; i < self->r->count; i++) {
    const strut_followed_branch *branch = &self->r->branches[i];
    if (branch->parent != (int32_t)index || branch->branch.count == 0) continue;
    const strut_follow_point *last = &branch->branch.points[branch->branch.count - 1];
    if (fabs(last->at.value[0] - value) < 2e-3 * (self->o->high - self->o->low)) return;
  }
  if (strut_follow_set_value(system, point->at.value) &&
      strut_follow_set_periods(system, repeats, system->how.steps_per_period))
    add_branch(self, point->at.y, point->critical, label, (int32_t)index);
}

static void follow_doublings(follower *self) {
  for (size_t i = 0; i < self->r->count; i++)
    for (size_t k = 0; k < self->r->branches[i].branch.count && !self->s.status; k++) {
      const strut_follow_point *point = &self->r->branches[i].branch.points[k];
      if (point->kind == STRUT_FOLLOW_DOUBLING && point->critical) follow_doubling(self, i, point);
    }
}

/* ---- basins ---- */

/* The motion of a branch between two of its points, made exact; kicked where it is stable. */
static void push_between(follower *self, size_t index, const strut_follow_point *from,
                         double value) {
  strut_follow_system *system = &self->s;
  strut_follow_result *result = self->r;
  const strut_follow_motion *a = &from->at, *b = &from[1].at;
  double rise = b->value[0] - a->value[0], part = rise != 0.0 ? (value - a->value[0]) / rise : 0.0;
  char reason[200];
  if (!from->stable || !from[1].stable || result->basin_count == STRUT_FOLLOW_MOST_BASINS) return;
  if (!strut_follow_set_value(system, VALUES_AT(self, value)) ||
      !strut_follow_set_periods(system, result->branches[index].branch.repeats,
                                system->how.steps_per_period))
    return;
  double *y = strut_follow_allocate(system, &result->arena, system->both, sizeof *y);
  for (size_t i = 0; i < system->both && y; i++) y[i] = a->y[i] + part * (b->y[i] - a->y[i]);
  if (!y || !strut_follow_correct(system, y, reason)) return;
  strut_follow_centre(system, y);
  strut_follow_basin *basin = &result->basins[result->basin_count];
  *basin = (strut_follow_basin){.branch = index, .value = value};
  if (strut_follow_push(system, y, basin)) result->basin_count++;
}

static void push_motions(follower *self) {
  for (size_t v = 0; v < self->o->start_count; v++) {
    double value = self->o->starts[v].value;
    bool again = false;
    for (size_t i = 0; i < v; i++) again = again || self->o->starts[i].value == value;
    for (size_t i = 0; i < self->r->count && !again; i++) {
      const strut_follow_branch *branch = &self->r->branches[i].branch;
      for (size_t k = 0; k + 1 < branch->count && !self->s.status; k++) {
        const strut_follow_point *from = &branch->points[k];
        double low = from->at.value[0], high = from[1].at.value[0];
        bool within = low < high ? low <= value && value < high : high < value && value <= low;
        if (high == value && k + 2 == branch->count) within = true;
        if (within) push_between(self, i, from, value);
      }
    }
  }
}

strut_status strut_follow_make(const strut_follow_options *options, strut_follow_result *result,
                               strut_error *error) {
  *result = (strut_follow_result){.low = options->low, .high = options->high};
  follower f = {.o = options,
                .r = result,
                .error = error,
                .limits = {.steps = options->steps > 0 ? options->steps : STRUT_FOLLOW_USUAL_STEPS,
                           .longest = LONGEST,
                           .progress = options->progress,
                           .progress_context = options->progress_context}};
  result->second = options->second;
  result->shown = options->shown;
  result->name = copy_text(result, options->name);
  result->unit = copy_text(result, options->unit);
  result->second.name = copy_text(result, options->second.name);
  result->second.unit = copy_text(result, options->second.unit);
  bool kept = result->name && result->unit && !result->second.name == !options->second.name;
  strut_status status = kept ? STRUT_OK : strut_no_memory(error, "");
  for (size_t i = 0; i < options->start_count && !status; i++)
    status = follow_start(&f, &options->starts[i]);
  if (!status) follow_doublings(&f);
  if (!status && options->basins) push_motions(&f);
  if (!status) status = f.s.status;
  if (!status && result->second.name && result->count > 0)
    status = strut_follow_find_curves(options, result, &f.s, error);
  if (!status && result->count == 0)
    status = strut_fail(error, STRUT_NOT_SETTLED, "there is no periodic motion to follow: %s",
                        result->note_count ? result->notes[0] : "no start was given");
  if (status == STRUT_INTERRUPTED && result->count > 0)
    strut_follow_note(result, "interrupted: branches are missing, or end early");
  if (f.opened) strut_follow_close(&f.s);
  return status;
}

strut_status strut_follow_possible(const strut_follow_options *options, strut_error *error) {
  follower f = {.o = options, .r = strut_allocate(1, sizeof *f.r), .error = error};
  if (!f.r) return strut_no_memory(error, "");
  strut_status status = open_system(&f, options->low);
  if (f.opened) strut_follow_close(&f.s);
  strut_follow_free(f.r);
  strut_release(f.r);
  return status;
}

void strut_follow_free(strut_follow_result *result) {
  for (size_t i = 0; i < result->count; i++) strut_follow_branch_free(&result->branches[i].branch);
  for (size_t i = 0; i < result->curve_count; i++) strut_follow_branch_free(&result->curves[i]);
  strut_arena_free(&result->arena);
  result->count = result->note_count = 0;
}
