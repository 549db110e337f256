/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <gsl/gsl_interp.h>
#include <math.h>

#include "engine/model/compile_parts.h"
#include "engine/scene/curve.h"

/* Slopes at the points of a smooth table, of Steffen's monotone spline. */
static bool find_slopes(const strut_law *law, double *slope) {
  if (!law->smooth || law->count < 3) return true;
  gsl_interp *spline = gsl_interp_alloc(gsl_interp_steffen, law->count);
  if (!spline) return false;
  bool good = gsl_interp_init(spline, law->x, law->force, law->count) == 0;
  for (size_t i = 0; i < law->count && good; i++)
    slope[i] = gsl_interp_eval_deriv(spline, law->x, law->force, law->x[i], NULL);
  gsl_interp_free(spline);
  return good;
}

/* Coefficients of a cubic from values and slopes at its two ends, h apart; straight where one has no slope. */
static void fill_piece(const strut_law *law, const double *slope, size_t i, double piece[4]) {
  double h = law->x[i + 1] - law->x[i], rise = (law->force[i + 1] - law->force[i]) / h;
  bool straight = isnan(slope[i]) || isnan(slope[i + 1]);
  piece[0] = law->force[i];
  piece[1] = straight ? rise : slope[i];
  piece[2] = straight ? 0.0 : (3.0 * rise - 2.0 * slope[i] - slope[i + 1]) / h;
  piece[3] = straight ? 0.0 : (slope[i] + slope[i + 1] - 2.0 * rise) / (h * h);
}

/*
 * The law with its points as scene/curve.h makes them of those given, and their slopes, where they have some;
 * false: out of memory.
 */
static bool take_points(strut_arena *arena, strut_law *law, double **slope) {
  size_t room = strut_curve_room(law);
  strut_curve_point *point = strut_allocate(room, sizeof *point);
  double *x = strut_arena_allocate(arena, room, sizeof *x);
  double *force = strut_arena_allocate(arena, room, sizeof *force);
  *slope = strut_arena_allocate(arena, room, sizeof **slope);
  bool made = point && x && force && *slope;
  if (made) law->count = strut_curve_trace(law, point);
  for (size_t i = 0; i < law->count && made; i++)
    x[i] = point[i].x, force[i] = point[i].force, (*slope)[i] = point[i].slope;
  law->x = x, law->force = force;
  strut_release(point);
  return made;
}

/* The stable piece of a curve at x = 0 whose force is least. */
static int find_start(const strut_law_curve *curve) {
  double least = HUGE_VAL;
  int start = 0;
  for (int i = 0; i + 1 < (int)curve->count; i++) {
    if (strut_folding_way(curve, i) < 0 || strut_folding_beyond(curve, i, 0.0)) continue;
    double force = fabs(strut_law_curve_piece(curve, (size_t)i, 0.0).force);
    if (force < least) least = force, start = i;
  }
  return start;
}

static const strut_law_curve *make_curve(strut_model *model, const strut_law *given) {
  strut_arena *arena = &model->arena;
  strut_law points = *given;
  const strut_law *law = &points;
  double *slope;
  if (!take_points(arena, &points, &slope)) return NULL;
  size_t n = law->count;
  strut_law_curve *curve = strut_arena_allocate(arena, 1, sizeof *curve);
  double(*piece)[4] = strut_arena_allocate(arena, n, sizeof *piece);
  double *energy = strut_arena_allocate(arena, n, sizeof *energy);
  if (!curve || !piece || !energy || !find_slopes(law, slope)) return NULL;
  bool folds = law->kind == STRUT_LAW_FOLDING;
  *curve = (strut_law_curve){n, law->x, (const double(*)[4])piece, energy, law->smooth, 0};
  for (size_t i = 0; i + 1 < n; i++) {
    double h = law->x[i + 1] - law->x[i], *p = piece[i];
    fill_piece(law, slope, i, p);
    energy[i + 1] = energy[i] + h * (p[0] + h * (p[1] / 2.0 + h * (p[2] / 3.0 + h * p[3] / 4.0)));
  }
  strut_law_numbers numbers = {.curve = curve};
  if (folds)
    curve->start = find_start(curve),
    curve->smooth = law->source == STRUT_LAW_CONTROL_POINTS || law->rounding > 0.0;
  double origin = strut_law_respond(law->kind, &numbers, 0.0, 0.0, -1).energy;
  for (size_t i = 0; i < n; i++) energy[i] -= origin;
  return curve;
}

bool strut_law_numbers_set(strut_model *model, const strut_law *law, double stiffness,
                           strut_law_numbers *numbers) {
  *numbers = (strut_law_numbers){.stiffness = stiffness};
#define STRUT_LAW_ROW(NAME, field, ...) numbers->field = law->field;
  STRUT_LAW_PARAMETERS(STRUT_LAW_ROW)
#undef STRUT_LAW_ROW
  if (strut_law_needs(law->kind, STRUT_LAW_PARAMETER_COEFFICIENTS))
    numbers->coefficient = law->force, numbers->count = law->count;
  if (strut_law_allows(law->kind, STRUT_LAW_PARAMETER_POINTS) &&
      !(numbers->curve = make_curve(model, law)))
    return false;
  if (strut_law_at(law->kind)->own)
    numbers->stiffness = strut_law_respond(law->kind, numbers, 0.0, 0.0, -1).slope;
  return true;
}
