/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/modes/waves.h"

#include <float.h>
#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_sort_double.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/scene/things.h"
#include "engine/statics/modes/parts.h"

enum { SAMPLES_ALONE = 200, SAMPLES_OF_LINE = 40, SAMPLES_ACROSS = 24 };
static const double LONG_WAVE = 1e-3; /* phase at which speeds are measured [turns] */
static const double LOCATED = 1e-7;   /* phase to which edges of gaps are located [turns] */
static const double REAL_GAP = 1e-6;  /* width of a gap, of its lower edge */

/* A line through the zone goes from corner to corner. */
typedef struct zone_corner {
  const char *name;
  double phase[2];
} zone_corner;

static const zone_corner ALONE[] = {{"0", {0.0, 0.0}}, {"1/2", {0.5, 0.0}}};
static const zone_corner PLANE[] = {{"G", {0.0, 0.0}}, {"X", {0.5, 0.0}}, {"M", {0.5, 0.5}},
                                    {"G", {0.0, 0.0}}, {"Y", {0.0, 0.5}}, {"M", {0.5, 0.5}}};

typedef struct solver {
  const strut_lattice_cell *cell;
  const strut_experiment *experiment;
  strut_vibration *v;
  gsl_matrix_complex *k, *m;
  gsl_vector *values;
  gsl_eigen_genherm_workspace *workspace;
  bool failed; /* some matrix had no eigenvalues */
} solver;

static bool create_solver(solver *s) {
  size_t n = (size_t)s->cell->n;
  s->k = gsl_matrix_complex_alloc(n, n);
  s->m = gsl_matrix_complex_alloc(n, n);
  s->values = gsl_vector_alloc(n);
  s->workspace = gsl_eigen_genherm_alloc(n);
  return s->k && s->m && s->values && s->workspace;
}

static void free_solver(solver *s) {
  if (s->k) gsl_matrix_complex_free(s->k);
  if (s->m) gsl_matrix_complex_free(s->m);
  if (s->values) gsl_vector_free(s->values);
  if (s->workspace) gsl_eigen_genherm_free(s->workspace);
  strut_vibration_free(s->v);
}

static void add_entry(gsl_matrix_complex *matrix, int32_t row, int32_t column, gsl_complex value) {
  gsl_complex *at = gsl_matrix_complex_ptr(matrix, (size_t)row, (size_t)column);
  *at = gsl_complex_add(*at, value);
}

/* u of a node is that of its owner times exp(i shift phase); so are rows and columns of K and M. */
static void fold(solver *s, const double phase[2]) {
  const strut_lattice_cell *cell = s->cell;
  const strut_sparse *a = s->v->shape->pattern;
  const int32_t *coordinate = s->v->shape->coordinate;
  gsl_matrix_complex_set_zero(s->k);
  gsl_matrix_complex_set_zero(s->m);
  for (int32_t j = 0; j < s->v->n; j++)
    for (int32_t at = a->start[j]; at < a->start[j + 1]; at++) {
      int32_t from = coordinate[a->row[at]], to = coordinate[j];
      int32_t r = cell->row[from], c = cell->row[to];
      double k = s->v->k[at], m = s->v->m[at], turns = 0.0;
      if (r < 0 || c < 0) continue;
      for (int d = 0; d < 2; d++)
        turns += (cell->shift[to / 2][d] - cell->shift[from / 2][d]) * phase[d];
      gsl_complex wave = gsl_complex_polar(1.0, STRUT_TAU * turns);
      add_entry(s->k, r, c, gsl_complex_mul_real(wave, k));
      add_entry(s->m, r, c, gsl_complex_mul_real(wave, m));
      if (from == to) continue;
      add_entry(s->k, c, r, gsl_complex_mul_real(gsl_complex_conjugate(wave), k));
      add_entry(s->m, c, r, gsl_complex_mul_real(gsl_complex_conjugate(wave), m));
    }
}

/* All frequencies at a phase, ascending [Hz]. */
static void solve(solver *s, const double phase[2], double *frequency) {
  size_t n = (size_t)s->cell->n;
  double nothing = 4.0 * DBL_EPSILON * (double)n * s->v->largest;
  if (s->failed || strut_experiment_interrupted(s->experiment)) {
    memset(frequency, 0, n * sizeof *frequency);
    return;
  }
  fold(s, phase);
  s->failed = gsl_eigen_genherm(s->k, s->m, s->values, s->workspace) != 0;
  for (size_t i = 0; i < n; i++) {
    double value = gsl_vector_get(s->values, i);
    if (fabs(value) <= nothing) value = 0.0;
    frequency[i] = copysign(sqrt(fabs(value)), value) / STRUT_TAU;
  }
  gsl_sort(frequency, 1, n);
}

/* ---- samples ---- */

static bool allocate(strut_waves *w, size_t corners, size_t each) {
  size_t n = (size_t)w->band_count;
  w->count = (corners - 1) * each + 1;
  w->phase = strut_arena_allocate(&w->arena, w->count, sizeof *w->phase);
  w->along = strut_arena_allocate(&w->arena, w->count, sizeof *w->along);
  w->frequency = strut_arena_allocate(&w->arena, w->count * n, sizeof *w->frequency);
  w->band = strut_arena_allocate(&w->arena, n, sizeof *w->band);
  w->gaps = strut_arena_allocate(&w->arena, n, sizeof *w->gaps);
  return w->phase && w->along && w->frequency && w->band && w->gaps;
}

static void include(strut_waves *w, const double phase[2], const double *frequency) {
  for (int32_t b = 0; b < w->band_count; b++) {
    const strut_wave_edge edge = {frequency[b], {phase[0], phase[1]}};
    if (edge.frequency < w->band[b].low.frequency) w->band[b].low = edge;
    if (edge.frequency > w->band[b].high.frequency) w->band[b].high = edge;
  }
}

static void sample_line(solver *s, strut_waves *w, const zone_corner *corner, size_t each) {
  for (size_t i = 0; i < w->count; i++) {
    size_t line = i / each;
    double part = (double)(i % each) / (double)each;
    for (int d = 0; d < 2; d++)
      w->phase[i][d] = part == 0.0 ? corner[line].phase[d]
                                   : corner[line].phase[d] +
                                         part * (corner[line + 1].phase[d] - corner[line].phase[d]);
    w->along[i] = (double)i / (double)each;
    double *frequency = w->frequency + i * (size_t)w->band_count;
    solve(s, w->phase[i], frequency);
    include(w, w->phase[i], frequency);
    if (i % each) continue;
    w->corner[w->corner_count++] = (strut_wave_corner){corner[line].name, i};
  }
}

/* The zone beside its line: half of it, since waves both ways have the same frequency. */
static void sample_inside(solver *s, strut_waves *w, double *frequency) {
  for (int i = 0; i <= SAMPLES_ACROSS / 2; i++)
    for (int j = -SAMPLES_ACROSS / 2 + 1; j <= SAMPLES_ACROSS / 2; j++, w->inside++) {
      const double phase[2] = {(double)i / SAMPLES_ACROSS, (double)j / SAMPLES_ACROSS};
      solve(s, phase, frequency);
      include(w, phase, frequency);
    }
}

/* ---- gaps ---- */

/* Climbs (sign 1) or descends from the best sample of a band, to the phase LOCATED. */
static void locate(solver *s, int32_t band, double sign, strut_wave_edge *edge, double *frequency) {
  double step = 1.0 / SAMPLES_OF_LINE;
  while (step > LOCATED && !strut_experiment_interrupted(s->experiment)) {
    bool better = false;
    for (int k = 0; k < 2 * s->cell->model->scene->lattice_count; k++) {
      double phase[2] = {edge->phase[0], edge->phase[1]};
      phase[k / 2] += k % 2 ? -step : step;
      solve(s, phase, frequency);
      if (!(sign * (frequency[band] - edge->frequency) > 0)) continue;
      *edge = (strut_wave_edge){frequency[band], {phase[0], phase[1]}};
      better = true;
    }
    if (!better) step *= 0.5;
  }
}

static void find_gaps(solver *s, strut_waves *w, double *frequency) {
  strut_wave_edge under = {0.0, {0.0, 0.0}};
  for (int32_t b = 0; b < w->band_count; b++) {
    double lowest = under.frequency * (1.0 + REAL_GAP);
    if (w->band[b].low.frequency > lowest) {
      if (b > 0) locate(s, b - 1, 1.0, &w->band[b - 1].high, frequency);
      locate(s, b, -1.0, &w->band[b].low, frequency);
      double low = b > 0 ? w->band[b - 1].high.frequency : 0.0;
      if (w->band[b].low.frequency > low * (1.0 + REAL_GAP))
        w->gaps[w->gap_count++] = (strut_wave_gap){b, low, w->band[b].low.frequency};
    }
    under = w->band[b].high;
  }
}

/* ---- long waves ---- */

/* Speed of a band from two long waves: exact up to the square of the longer one's phase. */
static void measure_speeds(solver *s, strut_waves *w, double *frequency) {
  const double(*step)[2] = s->cell->model->scene->lattice;
  const double *first = w->frequency; /* at no phase at all */
  while (w->acoustic < 2 && w->acoustic < w->band_count && first[w->acoustic] == 0.0) w->acoustic++;
  for (int k = 0; k < w->steps; k++) {
    /* the waves' normal is across the other step, and their length that between its lines */
    double length = hypot(step[k][0], step[k][1]);
    if (w->steps == 2)
      length = fabs(step[0][0] * step[1][1] - step[0][1] * step[1][0]) /
               hypot(step[1 - k][0], step[1 - k][1]);
    for (int half = 0; half < 2; half++) {
      double phase[2] = {0.0, 0.0};
      phase[k] = half ? 0.5 * LONG_WAVE : LONG_WAVE;
      solve(s, phase, frequency);
      for (int32_t b = 0; b < w->acoustic; b++) {
        double speed = frequency[b] / phase[k] * length;
        w->speed[k][b] = half ? 2.0 * speed - w->speed[k][b] : speed;
      }
    }
  }
}

static strut_status check_masses(const solver *s, strut_arena *arena, strut_error *error) {
  double *mass = strut_arena_allocate(arena, (size_t)s->cell->n, sizeof *mass);
  if (!mass) return strut_no_memory(error, "");
  for (int32_t i = 0; i < s->v->n; i++) {
    int32_t row = s->cell->row[s->v->shape->coordinate[i]];
    if (row >= 0) mass[row] += s->v->mass[i];
  }
  for (int32_t r = 0; r < s->cell->n; r++)
    if (!(mass[r] > 0))
      return strut_fail(error, STRUT_SINGULAR,
                        "node '%s' has no mass, so waves have no finite frequency there; give it a "
                        "mass or hold it",
                        s->cell->model->scene->nodes[s->cell->first[r] / 2].name);
  return STRUT_OK;
}

static strut_status solve_zone(solver *s, strut_waves *w, strut_error *error) {
  bool plane = w->steps == 2;
  const zone_corner *corner = plane ? PLANE : ALONE;
  size_t each = plane ? SAMPLES_OF_LINE : SAMPLES_ALONE;
  size_t corners = plane ? sizeof PLANE / sizeof *PLANE : sizeof ALONE / sizeof *ALONE;
  double *frequency = strut_arena_allocate(&w->arena, (size_t)w->band_count, sizeof *frequency);
  if (!frequency || !allocate(w, corners, each) || !create_solver(s))
    return strut_no_memory(error, "");
  for (int32_t b = 0; b < w->band_count; b++) {
    w->band[b].low.frequency = HUGE_VAL;
    w->band[b].high.frequency = -HUGE_VAL;
  }
  sample_line(s, w, corner, each);
  if (plane) sample_inside(s, w, frequency);
  find_gaps(s, w, frequency);
  measure_speeds(s, w, frequency);
  if (s->failed)
    return strut_fail(
        error, STRUT_SINGULAR,
        "the cell's frequencies cannot be computed; check the masses and stiffnesses");
  return STRUT_OK;
}

/* The shape from which the equilibrium is sought. */
static strut_status choose_shape(const strut_scene *scene, const char *at, strut_waves *w,
                                 double *q, strut_error *error) {
  w->at = "drawn";
  for (size_t i = 0; i < scene->node_count; i++)
    memcpy(q + 2 * i, scene->nodes[i].position, sizeof scene->nodes[i].position);
  if (!at || strcmp(at, "drawn") == 0) return STRUT_OK;
  const strut_configuration *named = strut_configuration_named(scene, at);
  if (!named || !named->shaped)
    return strut_fail(error, STRUT_USAGE,
                      "--at '%s': waves start from 'drawn' or from a configuration with positions",
                      at);
  w->at = named->name;
  memcpy(q, named->position, scene->node_count * 2 * sizeof *q);
  return STRUT_OK;
}

static strut_status find(const strut_model *model, const strut_experiment *experiment,
                         const strut_waves_options *options, strut_waves *w, strut_error *error) {
  strut_lattice_cell cell;
  size_t length = (size_t)model->length;
  double *q = strut_arena_allocate(&w->arena, length, sizeof *q);
  double *before = strut_arena_allocate(&w->arena, length, sizeof *before);
  if (!q || !before) return strut_no_memory(error, "");
  strut_status status = strut_lattice_cell_create(model, &w->arena, &cell, error);
  if (status == STRUT_OK) status = choose_shape(model->scene, options->at, w, q, error);
  if (status != STRUT_OK) return status;
  memcpy(before, q, length * sizeof *q);
  w->q = q;
  w->steps = model->scene->lattice_count;
  w->images = cell.images;
  w->band_count = cell.n;
  w->shown = options->count > 0 && options->count < cell.n ? options->count : cell.n;
  status = strut_lattice_cell_settle(&cell, experiment, q, &w->residual, error);
  if (status != STRUT_OK) return status;
  for (size_t i = 0; i < length; i += 2)
    w->moved = fmax(w->moved, hypot(q[i] - before[i], q[i + 1] - before[i + 1]));
  solver s = {.cell = &cell, .experiment = experiment};
  status = strut_vibration_create(model, q, NULL, 0, NULL, &s.v, error);
  if (status == STRUT_OK) status = check_masses(&s, &w->arena, error);
  if (status == STRUT_OK) status = solve_zone(&s, w, error);
  free_solver(&s);
  return status;
}

strut_status strut_waves_find(const strut_model *model, const strut_experiment *experiment,
                              const strut_waves_options *options, strut_waves *waves,
                              strut_error *error) {
  *waves = (strut_waves){0};
  return strut_experiment_end(experiment, find(model, experiment, options, waves, error), error);
}

void strut_waves_free(strut_waves *waves) {
  strut_arena_free(&waves->arena);
  *waves = (strut_waves){0};
}
