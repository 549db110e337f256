/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/follow/follow_parts.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/buffer.h"
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

__attribute__((format(printf, 2, 3))) static void note(follower *f, const char *format, ...) {
  va_list arguments;
  if (f->r->note_count == sizeof f->r->notes / sizeof f->r->notes[0]) return;
  va_start(arguments, format);
  vsnprintf(f->r->notes[f->r->note_count++], STRUT_FOLLOW_NOTE, format, arguments);
  va_end(arguments);
}

static void name_start(const follower *f, const strut_follow_start *start, char *text,
                       size_t size) {
  snprintf(text, size, "%s%s%s", start->from ? start->from : "", start->from ? " at " : "",
           strut_quantity_of_any(start->value, 6, *f->o->unit ? f->o->unit : "1").text);
}

/* ---- starts ---- */

static strut_status place_start(follower *f, const strut_follow_start *start, strut_setup *setup) {
  strut_scene *scene = &setup->scene;
  if (start->from) {
    scene->start_equilibrium = strut_thing_find(scene, STRUT_THING_CONFIGURATION, start->from);
    if (scene->start_equilibrium < 0)
      return strut_fail(f->error, STRUT_USAGE, "the model has no configuration '%s' to start from",
                        start->from);
    setup->experiment.settle.wanted = false;
  }
  return strut_resolve_start_equilibrium(setup, f->error);
}

/* Runs from the start until the motion is steady; `y` becomes a state of it at the start of a period. */
static strut_status run_start(follower *f, const strut_setup *setup, const strut_model *model,
                              double *y, strut_summary *summary) {
  strut_experiment e = setup->experiment;
  size_t length = (size_t)model->length;
  strut_snapshot end = {.q = y, .v = y + length};
  e.accuracy = START_ACCURACY;
  e.steady.wanted = true;
  e.steady.tolerance = START_TOLERANCE;
  e.quantity_count = 0;
  e.periods = fmin(fmax(e.periods, LEAST_PERIODS), MOST_PERIODS);
  e.measure_last = fmin(e.measure_last, e.periods);
  e.output_last = 0.0;
  strut_run_options options = {.interrupt = f->o->interrupt, .without_balance = true, .to = &end};
  strut_status status = strut_simulate_accurately(model, &e, &options, summary, f->error);
  y[2 * length] = 0.0;
  return status;
}

static double accuracy_of(const follower *f) {
  return f->o->accuracy > 0.0 ? f->o->accuracy : ACCURACY;
}

/* Opens the system at the value with a method. */
static strut_status open_with(follower *f, double value, const char *method) {
  strut_follow_system *s = &f->s;
  bool adaptive = strcmp(method, strut_integrator_for(STRUT_ROLE_REFERENCE)->name) == 0;
  *s = (strut_follow_system){.scenes = f->o->scenes,
                             .low = f->o->low,
                             .high = f->o->high,
                             .how.method = method,
                             .how.tolerance = fmin(2.5e-6, accuracy_of(f) * TOLERANCE),
                             .how.steps_per_period = adaptive ? STEPS_PER_PERIOD : FIXED_STEPS,
                             .how.repeats = 1,
                             .how.threads = f->o->threads,
                             .how.interrupt = f->o->interrupt};
  snprintf(f->r->method, sizeof f->r->method, "%s", method);
  f->r->tolerance = s->how.tolerance;
  f->opened = true;
  return strut_follow_open(s, value, f->error);
}

/*
 * Fixed steps make the smoothest period map; where variations cannot follow them, or there would be too many,
 * the method with error control serves.
 */
static strut_status open_system(follower *f, double value) {
  strut_follow_system *s = &f->s;
  const char *fixed = strut_integrator_for(STRUT_ROLE_EXACT_STICK)->name;
  const char *careful = strut_integrator_for(STRUT_ROLE_REFERENCE)->name;
  if (f->opened) return strut_follow_set_value(s, value, f->error);
  strut_status status = open_with(f, value, f->o->method ? f->o->method : fixed);
  bool good = !f->o->method && s->variation;
  if (!status && good) status = strut_follow_choose_steps(s, accuracy_of(f), &good, f->error);
  f->stepped = good;
  if (!status && !good && !f->o->method) {
    strut_follow_close(s);
    status = open_with(f, value, careful);
  }
  if (status) return status;
  f->r->title =
      strut_arena_format(&f->r->arena, "%s", s->setup.scene.name ? s->setup.scene.name : "model");
  return f->r->title ? STRUT_OK : strut_no_memory(f->error, "");
}

/* Is the motion on a branch that is known? Notes it. */
static strut_status find_known(follower *f, const double *y, const char *label, bool *known) {
  *known = false;
  for (size_t i = 0; i < f->r->count && !*known; i++) {
    const strut_follow_branch *b = &f->r->branches[i].branch;
    if (b->repeats != f->s.how.repeats) continue;
    strut_status status = strut_follow_is_on(&f->s, b, y, known, f->error);
    if (status) return status;
    if (*known) note(f, "the motion from %s is on branch %zu", label, i + 1);
  }
  return STRUT_OK;
}

static strut_status add_branch(follower *f, const double *y, const double *direction,
                               const char *label, int32_t parent) {
  if (f->r->count == STRUT_FOLLOW_MOST_BRANCHES) {
    note(f, "there are more branches, which were not followed");
    return STRUT_OK;
  }
  strut_followed_branch *b = &f->r->branches[f->r->count];
  b->parent = parent;
  snprintf(b->label, sizeof b->label, "%s", label);
  strut_status status =
      strut_follow_branch_make(&f->s, y, direction, &f->limits, &b->branch, f->error);
  if ((status && status != STRUT_INTERRUPTED) || b->branch.count < 2) {
    const char *why = b->branch.ends[1];
    if (!status)
      note(f, "no branch leads away from %s%s%s", label, why && *why ? ": " : "", why ? why : "");
    strut_follow_branch_free(&b->branch);
    return status;
  }
  f->r->count++;
  return status;
}

/*
 * Makes the motion exact. Where Newton's method does not get there, as at kinks, a stable motion is
 * approached by running on.
 */
static strut_status make_exact(follower *f, double *y, bool *found, char reason[200]) {
  strut_follow_system *s = &f->s;
  strut_status status = strut_follow_correct(s, y, found, reason, f->error);
  for (int k = 0; k < MORE_RUNS && !status && !*found; k++) {
    for (int i = 0; i < MORE_PERIODS; i++)
      if (!isfinite(strut_follow_apply(s, y, false).travel)) return STRUT_OK;
    strut_follow_centre(s, y);
    status = strut_follow_correct(s, y, found, reason, f->error);
  }
  return status;
}

/* The motion at the start, which the run has found, and its branch. */
static strut_status follow_motion(follower *f, const char *label, double *y, int32_t repeats) {
  char reason[200] = "";
  bool found = false, known = false;
  strut_status status = strut_follow_set_repeats(&f->s, repeats, f->error);
  if (status) return status;
  if (f->r->count == 0 && !strut_follow_set_units(&f->s, y)) return STRUT_OK;
  strut_follow_centre(&f->s, y);
  status = make_exact(f, y, &found, reason);
  if (!status && found && f->stepped && f->r->count == 0)
    status = strut_follow_check_steps(&f->s, y, accuracy_of(f), f->error);
  if (status) return status;
  if (!found) {
    note(f, "the motion from %s: %s", label, reason);
    return STRUT_OK;
  }
  strut_follow_centre(&f->s, y);
  status = find_known(f, y, label, &known);
  return status || known ? status : add_branch(f, y, NULL, label, -1);
}

static strut_status follow_start(follower *f, const strut_follow_start *start) {
  char label[STRUT_FOLLOW_LABEL];
  strut_setup setup;
  strut_model *model = NULL;
  strut_summary summary = {0};
  name_start(f, start, label, sizeof label);
  strut_status status = open_system(f, start->value);
  if (status) return status;
  status = f->o->scenes.setup(f->o->scenes.context, start->value, &setup, f->error);
  if (status) return status;
  status = place_start(f, start, &setup);
  if (!status) status = strut_model_compile(&setup.scene, &model, f->error);
  double *y = status ? NULL : strut_allocate(f->s.both, sizeof *y);
  if (!status && !y) status = strut_no_memory(f->error, "");
  if (!status) status = run_start(f, &setup, model, y, &summary);
  if (status == STRUT_DIVERGED || status == STRUT_WORK_LIMIT) {
    note(f, "the run from %.80s failed: %.200s", label, f->error->message);
    status = STRUT_OK;
  } else if (!status && summary.steady.kind != STRUT_MOTION_PERIODIC) {
    note(f, "the motion from %s is %s after %" PRId64 " periods, which starts no branch", label,
         strut_motion_name(summary.steady.kind), summary.steady.periods);
  } else if (!status) {
    status = follow_motion(f, label, y, summary.steady.repeats > 0 ? summary.steady.repeats : 1);
  }
  strut_summary_free(&summary);
  strut_release(y);
  strut_model_free(model);
  strut_setup_free(&setup);
  return status;
}

/* ---- doubled branches ---- */

static strut_status follow_doubling(follower *f, size_t index, const strut_follow_point *p) {
  char label[STRUT_FOLLOW_LABEL];
  int32_t repeats = 2 * f->r->branches[index].branch.repeats;
  if (repeats > MOST_REPEATS) return STRUT_OK;
  snprintf(label, sizeof label, "the period doubling of branch %zu at %s", index + 1,
           strut_quantity_of_any(p->value, 6, *f->o->unit ? f->o->unit : "1").text);
  strut_status status = strut_follow_set_value(&f->s, p->value, f->error);
  if (!status) status = strut_follow_set_repeats(&f->s, repeats, f->error);
  /* it may be known from another doubling, at its other end */
  for (size_t i = 0; i < f->r->count && !status; i++) {
    const strut_followed_branch *b = &f->r->branches[i];
    if (b->parent != (int32_t)index || b->branch.count == 0) continue;
    const strut_follow_point *last = &b->branch.points[b->branch.count - 1];
    if (fabs(last->value - p->value) < 2e-3 * (f->o->high - f->o->low)) return STRUT_OK;
  }
  return status ? status : add_branch(f, p->y, p->critical, label, (int32_t)index);
}

static strut_status follow_doublings(follower *f) {
  for (size_t i = 0; i < f->r->count; i++)
    for (size_t k = 0; k < f->r->branches[i].branch.count; k++) {
      const strut_follow_point *p = &f->r->branches[i].branch.points[k];
      if (p->kind != STRUT_FOLLOW_DOUBLING || !p->critical) continue;
      strut_status status = follow_doubling(f, i, p);
      if (status) return status;
    }
  return STRUT_OK;
}

/* ---- basins ---- */

/* The motion of a branch between two of its points, made exact; kicked where it is stable. */
static strut_status push_between(follower *f, size_t index, size_t k, double value) {
  const strut_follow_branch *b = &f->r->branches[index].branch;
  const strut_follow_point *from = &b->points[k], *to = from + 1;
  strut_follow_basin *basin = &f->r->basins[f->r->basin_count];
  double part = to->value != from->value ? (value - from->value) / (to->value - from->value) : 0.0;
  char reason[200];
  bool found = false;
  if (!from->stable || !to->stable || f->r->basin_count == STRUT_FOLLOW_MOST_BASINS)
    return STRUT_OK;
  strut_status status = strut_follow_set_value(&f->s, value, f->error);
  if (!status) status = strut_follow_set_repeats(&f->s, b->repeats, f->error);
  double *y = status ? NULL : strut_arena_allocate(&f->r->arena, f->s.both, sizeof(double));
  if (!y) return status ? status : strut_no_memory(f->error, "");
  for (size_t i = 0; i < f->s.both; i++) y[i] = from->y[i] + part * (to->y[i] - from->y[i]);
  status = strut_follow_correct(&f->s, y, &found, reason, f->error);
  if (status || !found) return status;
  strut_follow_centre(&f->s, y);
  *basin = (strut_follow_basin){.branch = index, .value = value};
  basin->velocity = from->velocity + part * (to->velocity - from->velocity);
  status = strut_follow_push(&f->s, y, basin, f->error);
  if (!status) f->r->basin_count++;
  return status;
}

static strut_status push_motions(follower *f) {
  for (size_t v = 0; v < f->o->start_count; v++) {
    double value = f->o->starts[v].value;
    bool again = false;
    for (size_t i = 0; i < v; i++) again = again || f->o->starts[i].value == value;
    for (size_t i = 0; i < f->r->count && !again; i++) {
      const strut_follow_branch *b = &f->r->branches[i].branch;
      for (size_t k = 0; k + 1 < b->count; k++) {
        double low = b->points[k].value, high = b->points[k + 1].value;
        bool within = low < high ? low <= value && value < high : high < value && value <= low;
        if (b->points[k + 1].value == value && k + 2 == b->count) within = true;
        strut_status status = within ? push_between(f, i, k, value) : STRUT_OK;
        if (status) return status;
      }
    }
  }
  return STRUT_OK;
}

/* The second parameter, with texts that stay. */
static strut_status keep_second(strut_follow_result *r, const strut_follow_second *second,
                                strut_error *error) {
  r->second = *second;
  r->second.name = strut_arena_format(&r->arena, "%s", second->name);
  r->second.unit = strut_arena_format(&r->arena, "%s", second->unit);
  r->second.scenes = (strut_follow_plane){NULL, NULL};
  return r->second.name && r->second.unit ? STRUT_OK : strut_no_memory(error, "");
}

strut_status strut_follow_make(const strut_follow_options *options, strut_follow_result *result,
                               strut_error *error) {
  double clock = strut_run_clock();
  *result = (strut_follow_result){.low = options->low, .high = options->high};
  follower f = {.o = options,
                .r = result,
                .error = error,
                .limits = {.steps = options->steps > 0 ? options->steps : STRUT_FOLLOW_USUAL_STEPS,
                           .longest = LONGEST,
                           .progress = options->progress,
                           .progress_context = options->progress_context}};
  result->name = strut_arena_format(&result->arena, "%s", options->name);
  result->unit = strut_arena_format(&result->arena, "%s", options->unit);
  strut_status status = result->name && result->unit ? STRUT_OK : strut_no_memory(error, "");
  if (!status && options->second.name) status = keep_second(result, &options->second, error);
  for (size_t i = 0; i < options->start_count && !status; i++)
    status = follow_start(&f, &options->starts[i]);
  if (!status && !options->not_doubled) status = follow_doublings(&f);
  if (!status && options->basins) status = push_motions(&f);
  if (!status && result->second.name && result->count > 0)
    status = strut_follow_find_curves(options, result, &f.s, error);
  if (!status && result->count == 0)
    status = strut_fail(error, STRUT_NOT_SETTLED, "there is no periodic motion to follow: %s",
                        result->note_count ? result->notes[0] : "no start was given");
  if (status == STRUT_INTERRUPTED && result->count > 0)
    note(&f, "interrupted: branches are missing, or end early");
  if (f.opened) strut_follow_close(&f.s);
  result->seconds = strut_run_clock() - clock;
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
  for (size_t i = 0; i < result->curve_count; i++) strut_follow_curve_free(&result->curves[i]);
  strut_arena_free(&result->arena);
  result->count = result->note_count = 0;
}
