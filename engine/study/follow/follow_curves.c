/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curves of the special points of all branches over a second parameter, with what is written of them. */
#include <math.h>
#include <string.h>

#include "engine/base/text.h"
#include "engine/study/follow/follow_parts.h"

/* Longest step of a parameter in its range; steps each way; drive steps that show a gap's extrema. */
static const double LONGEST = 0.03;
enum { STEPS_PER_PERIOD = 200 };

/* ---- following ---- */

/* The curve through a special point of a branch, unless it is known. */
static void follow_from(const strut_follow_options *options, strut_follow_result *result,
                        strut_follow_system *system, const strut_follow_point *point) {
  bool gap = point->kind == STRUT_FOLLOW_TOUCH || point->kind == STRUT_FOLLOW_LIFT;
  const strut_follow_curve_start start = {point->kind, gap ? point->node : NULL, point->at};
  const strut_follow_limits limits = {
      .steps = options->steps > 0 ? options->steps : STRUT_FOLLOW_USUAL_CURVE_STEPS,
      .longest = LONGEST};
  for (size_t i = 0; i < result->curve_count; i++)
    if (strut_follow_curve_passes(system, &result->curves[i], &start)) return;
  if (result->curve_count == STRUT_FOLLOW_MOST_CURVES) return;
  strut_follow_branch *curve = &result->curves[result->curve_count];
  int64_t steps = system->how.steps_per_period;
  if (gap && steps < STEPS_PER_PERIOD)
    strut_follow_set_periods(system, system->how.repeats, STEPS_PER_PERIOD);
  strut_status status = strut_follow_curve_make(system, &start, &limits, curve);
  strut_follow_set_periods(system, system->how.repeats, steps);
  if (curve->count > 1 && (!status || status == STRUT_INTERRUPTED)) {
    result->curve_count++;
    return;
  }
  if (!status)
    strut_follow_note(
        result, "the curve of the %s%s%.60s at %s is not followed: %.120s",
        strut_follow_kind_word(point->kind), gap ? " of " : "", gap ? point->node : "",
        strut_quantity_of_any(point->at.value[0], 6, *result->unit ? result->unit : "1").text,
        curve->count ? curve->ends[1] : curve->ends[0]);
  strut_follow_branch_free(curve);
}

strut_status strut_follow_find_curves(const strut_follow_options *options,
                                      strut_follow_result *result, const strut_follow_system *like,
                                      strut_error *error) {
  strut_follow_system plane = {.scenes = options->scenes,
                               .parameters = 2,
                               .low = {options->low, options->second.low},
                               .high = {options->high, options->second.high},
                               .how = like->how};
  plane.how.repeats = 1;
  const double value[2] = {0.5 * (options->low + options->high), options->second.value};
  strut_status status = strut_follow_open(&plane, value, error);
  plane.length = like->length, plane.speed = like->speed;
  for (size_t i = 0; i < result->count; i++) {
    const strut_follow_branch *branch = &result->branches[i].branch;
    for (size_t k = 0; k < branch->count && !status; k++) {
      if (!strut_follow_curve_known(branch->points[k].kind)) continue;
      strut_follow_set_periods(&plane, branch->repeats, plane.how.steps_per_period);
      follow_from(options, result, &plane, &branch->points[k]);
      status = plane.status;
    }
  }
  strut_follow_close(&plane);
  return status;
}

/* ---- values ---- */

#define POINT(X)                                                                                   \
  X(NULL, "", COUNT(of->outer->index + 1), "", .column = {"curve"})                                \
  X(NULL, "", TEXT(strut_follow_kind_word(c->kind)), "", .column = {"kind"})                       \
  X(NULL, "", TEXT(c->node), "", .column = {"node"})                                               \
  X(NULL, "", COUNT(c->repeats), "", .column = {"period_multiple"})                                \
  X(NULL, "", NUMBER(p->arc), "", .column = {"arclength"})                                         \
  X("values", "", NUMBERS(p->at.value, 2), "of both parameters")                                   \
  X(NULL, "", CALLED(r->name, r->unit, p->at.value[0]), "", .column = {""})                        \
  X(NULL, "", CALLED(r->second.name, r->second.unit, p->at.value[1]), "", .column = {""})          \
  X("velocity", "m/s", NUMBER(p->velocity), "mean", .column = {"velocity [m/s]"})                  \
  X(NULL, "", NUMBER(p->work), "", .column = {"work [J]"})                                         \
  X(NULL, "", NUMBER(c->travels ? (double)NAN : p->amplitude), "", .column = {"amplitude [m]"})    \
  X("amplitude", "m", IF(!c->travels, NUMBER(p->amplitude)), "half the largest range")             \
  X("stable", "", FLAG(p->stable), "whether it is, beside the curve")                              \
  X(NULL, "", TEXT(p->stable ? "yes" : "no"), "", .column = {"stable"})                            \
  X(NULL, "", PART(p->multiplier), "", .rows = &strut_follow_multiplier_values)                    \
  X(NULL, "", TEXT(of->index == c->start ? "start" : strut_follow_kind_word(p->kind)), "",         \
    .column = {"point"})
STRUT_VALUES_HERE(point_values, POINT, const strut_follow_result *r = strut_result_whole(of);
                  const strut_follow_branch *c = of->outer->at;
                  const strut_follow_point *p = of->at)

static const strut_follow_point *cusp_at(const strut_result_object *of, size_t k) {
  const strut_follow_point *point = &((const strut_follow_branch *)of->at)->points[k];
  return point->kind == STRUT_FOLLOW_CUSP ? point : NULL;
}

static strut_value cusp_of(const strut_result_object *of, size_t k) {
  const strut_follow_point *cusp = cusp_at(of, k);
  return STRUT_VALUE_AS_IF(cusp, NUMBERS(cusp->at.value, 2));
}

/* A parameter's value at a cusp. */
static strut_value cusp_value_of(const strut_result_object *of, size_t k) {
  const strut_follow_result *result = strut_result_whole(of);
  const strut_follow_point *cusp = cusp_at(of, k / 2);
  return STRUT_VALUE_AS_IF(
      cusp, CALLED(k % 2 ? result->second.name : result->name,
                   k % 2 ? result->second.unit : result->unit, cusp->at.value[k % 2]));
}

#define CURVE(X)                                                                                   \
  X("kind", "", TEXT(strut_follow_kind_word(c->kind)), "of its special points", .label = {""})     \
  X("node", "", TEXT(c->node), "that they are about", .label = {""})                               \
  X("period_multiple", "", COUNT(c->repeats), "drive periods of one repetition")                   \
  X("begins", "", TEXT(c->ends[0]), "why", .label = {""})                                          \
  X("ends", "", TEXT(c->ends[1]), "why", .label = {""})                                            \
  X(NULL, "", COUNT(c->count), "", .label = {"points"})                                            \
  X("cusps", "", ARRAY(c->count, cusp_of), "values of both parameters where two folds meet")       \
  X(NULL, "", ARRAY(2 * c->count, cusp_value_of), "", .label = {"cusps"})                          \
  X("points", "", LIST(c->points, c->count), "all", .rows = &point_values)
STRUT_VALUES_HERE(curve_values, CURVE, const strut_follow_branch *c = of->at)

#define CURVES(X)                                                                                  \
  X("and", "", TEXT(r->second.name), "the second parameter", .label = {""})                        \
  X("and_unit", "", TEXT(r->second.unit), "of it")                                                 \
  X("and_from", "", NUMBER(r->second.low), "its range")                                            \
  X("and_to", "", NUMBER(r->second.high), "its range")                                             \
  X("and_at", "", NUMBER(r->second.value), "where the branches are")                               \
  X("curves", "", LIST(r->curves, r->curve_count), "of special points", .rows = &curve_values,     \
    .label = {"curve"})
STRUT_VALUES(strut_follow_curves_values, CURVES, const strut_follow_result *r = of->at)

/*
 * How far a stable motion may be pushed: kicks of the whole structure at the start of a period, after each
 * of which the motion must come back. The smallest that it does not come back from is found by bisection
 * between kicks that grow; since boundaries of basins may be intricate, smaller ones may exist.
 */

/* Smallest and largest kick, in speeds of the motion; growth between them; halvings. */
static const double FIRST = 0.05, LARGEST = 20.0, GROWTH = 1.6;
enum { HALVINGS = 4 };
/* Periods after which the motion must be back, and how near. */
enum { PERIODS = 60 };
static const double NEAR = 0.02;

typedef struct kick {
  const char *name;
  double along, outward; /* parts of the ground's tangent and normal */
} kick;
static const kick kicks[STRUT_FOLLOW_KICKS] = {
    {"forwards", 1.0, 0.0}, {"backwards", -1.0, 0.0}, {"up", 0.0, 1.0}, {"down", 0.0, -1.0}};

const char *strut_follow_kick_name(int i) { return kicks[i].name; }

/* Does the motion come back from a kick of this speed [m/s]? `y`, `work` (both): on it; scratch. */
static bool comes_back(strut_follow_system *system, const double *unknowns, const kick *self,
                       double speed, double *work) {
  const strut_model *model = system->model;
  const double *t = model->contacts.tangent, *n = model->contacts.normal;
  bool ground = model->contacts.count > 0;
  memcpy(work, unknowns, system->both * sizeof(double));
  for (int32_t i = 0; i < 2 * model->node_count; i++) {
    double along = ground ? t[i % 2] : i % 2 == 0, outward = ground ? n[i % 2] : i % 2 == 1;
    if (!model->fixed[i])
      work[model->length + i] += speed * (self->along * along + self->outward * outward);
  }
  for (int period = 0; period < PERIODS; period += system->how.repeats) {
    if (!isfinite(strut_follow_apply(system, work, false).travel)) return false;
    strut_follow_centre(system, work);
    if (strut_follow_change(system, unknowns, work, system->buffers.f) < NEAR) return true;
  }
  return false;
}

/* Speed of the smallest kick found from which it does not come back [m/s]; INFINITY: none up to LARGEST. */
static double smallest_kick(strut_follow_system *system, const double *unknowns, const kick *self,
                            double *work) {
  double low = 0.0, high = FIRST * system->speed;
  while (comes_back(system, unknowns, self, high, work)) {
    low = high, high *= GROWTH;
    if (high > LARGEST * system->speed) return HUGE_VAL;
    if (strut_follow_interrupted(system)) return (double)NAN;
  }
  for (int i = 0; i < HALVINGS && !strut_follow_interrupted(system); i++) {
    double middle = low > 0.0 ? sqrt(low * high) : 0.5 * high;
    *(comes_back(system, unknowns, self, middle, work) ? &low : &high) = middle;
  }
  return high;
}

bool strut_follow_push(strut_follow_system *system, const double *unknowns,
                       strut_follow_basin *basin) {
  double *work = strut_follow_allocate(system, &system->arena, system->both, sizeof *work);
  for (int i = 0; i < STRUT_FOLLOW_KICKS && !system->status; i++)
    basin->kick[i] = smallest_kick(system, unknowns, &kicks[i], work);
  return !system->status;
}
