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
#include "engine/statics/algebra.h"
#include "engine/statics/minimise.h"
#include "engine/statics/modes/parts.h"

enum { SAMPLES_ALONE = 200, SAMPLES_OF_LINE = 40, SAMPLES_ACROSS = 24 };
static const double SAME_PLACE = 1e-6; /* distance, in shorter steps of the lattice */
static const double FARTHEST = 1e6;    /* steps between nodes of one cell */

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

typedef struct lattice_cell {
  const strut_model *model;
  int32_t *owner;      /* (nodes) the node of this cell that a node repeats; itself if none */
  int32_t (*shift)[2]; /* (nodes) whole steps from there */
  int32_t n;           /* coordinates of a cell */
  int32_t *row;        /* (length) of a coordinate's owner among them; -1 where held */
  int32_t *first;      /* (n) coordinate of a row */
  int32_t images;
} lattice_cell;

/* ---- a cell: its nodes among those of its neighbours ---- */

/* Whole steps from point a to point b; false where they lie otherwise. */
static bool steps_between(const strut_scene *scene, const double a[2], const double b[2],
                          int32_t steps[2]) {
  const double(*s)[2] = scene->lattice, d[2] = {b[0] - a[0], b[1] - a[1]};
  double count[2] = {0.0, 0.0}, shorter = hypot(s[0][0], s[0][1]);
  if (scene->lattice_count == 2) {
    double area = s[0][0] * s[1][1] - s[0][1] * s[1][0];
    count[0] = (d[0] * s[1][1] - d[1] * s[1][0]) / area;
    count[1] = (s[0][0] * d[1] - s[0][1] * d[0]) / area;
    shorter = fmin(shorter, hypot(s[1][0], s[1][1]));
  } else {
    count[0] = (d[0] * s[0][0] + d[1] * s[0][1]) / (shorter * shorter);
  }
  if (!(fabs(count[0]) < FARTHEST && fabs(count[1]) < FARTHEST)) return false;
  double left[2] = {d[0], d[1]};
  for (int k = 0; k < scene->lattice_count; k++) {
    steps[k] = (int32_t)lround(count[k]);
    for (int c = 0; c < 2; c++) left[c] -= steps[k] * s[k][c];
  }
  return hypot(left[0], left[1]) <= SAME_PLACE * shorter;
}

/* Finds the first node that node i repeats, and whether a second one in the same place could be meant. */
static strut_status find_owner(lattice_cell *cell, int32_t i, strut_error *error) {
  const strut_scene *scene = cell->model->scene;
  int32_t steps[2] = {0, 0};
  cell->owner[i] = i;
  for (int32_t k = 0; k < i; k++) {
    if (cell->owner[k] != k ||
        !steps_between(scene, scene->nodes[k].position, scene->nodes[i].position, steps))
      continue;
    if (steps[0] == 0 && steps[1] == 0) continue; /* two nodes in one place */
    if (cell->owner[i] != i)
      return strut_fail(
          error, STRUT_BAD_SCENE,
          "--wave: node '%s' lies whole steps of the lattice from both '%s' and '%s', which "
          "are drawn in one place, so it is not clear whose image it is; draw one of "
          "them elsewhere in the cell",
          scene->nodes[i].name, scene->nodes[cell->owner[i]].name, scene->nodes[k].name);
    cell->owner[i] = k;
    memcpy(cell->shift[i], steps, sizeof steps);
    cell->images++;
  }
  return STRUT_OK;
}

/* Does every step of the lattice lead from some node to another? */
static strut_status check_steps(const lattice_cell *cell, strut_error *error) {
  const strut_scene *scene = cell->model->scene;
  for (int k = 0; k < scene->lattice_count; k++) {
    bool used = false;
    for (int32_t i = 0; i < cell->model->node_count; i++) used = used || cell->shift[i][k] != 0;
    if (!used)
      return strut_fail(
          error, STRUT_BAD_SCENE,
          "--wave: no node lies a step [%g m, %g m] of the lattice from another one, so "
          "nothing ties the cell to the next; draw the nodes of the next cell at which "
          "members of this one end",
          scene->lattice[k][0], scene->lattice[k][1]);
  }
  return STRUT_OK;
}

/* A coordinate is held where that of any image is. */
static void number_rows(lattice_cell *cell) {
  const strut_scene *scene = cell->model->scene;
  int32_t nodes = cell->model->node_count;
  memset(cell->row, 0, (size_t)cell->model->length * sizeof *cell->row);
  for (int32_t i = 0; i < nodes; i++)
    for (int32_t c = 0; c < 2; c++)
      if (scene->nodes[i].fixed[c]) cell->row[2 * cell->owner[i] + c] = -1;
  for (int32_t i = 0; i < 2 * nodes; i++) {
    if (cell->owner[i / 2] != i / 2 || cell->row[i] < 0) continue;
    cell->first[cell->n] = i;
    cell->row[i] = cell->n++;
  }
  for (int32_t i = 0; i < 2 * nodes; i++) cell->row[i] = cell->row[2 * cell->owner[i / 2] + i % 2];
}

static strut_status create_cell(const strut_model *model, strut_arena *arena, lattice_cell *cell,
                                strut_error *error) {
  size_t nodes = (size_t)model->node_count, length = (size_t)model->length;
  *cell = (lattice_cell){.model = model};
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(cell->owner, nodes), STRUT_NEW(cell->shift, nodes),
                      STRUT_NEW(cell->row, length), STRUT_NEW(cell->first, length)))
    return strut_no_memory(error, "");
  if (model->scene->lattice_count == 0)
    return strut_fail(error, STRUT_USAGE,
                      "--wave needs 'lattice' in the scene, the steps by which the structure "
                      "repeats, such as lattice: [[100 mm, 0]]");
  strut_status status = STRUT_OK;
  for (int32_t i = 0; i < model->node_count && status == STRUT_OK; i++)
    status = find_owner(cell, i, error);
  if (status == STRUT_OK) status = check_steps(cell, error);
  if (status != STRUT_OK) return status;
  number_rows(cell);
  if (cell->n == 0)
    return strut_fail(error, STRUT_BAD_SCENE,
                      "--wave: no node is free to move, so there are no waves");
  if (cell->n > STRUT_MOST_BANDS)
    return strut_fail(
        error, STRUT_BAD_SCENE,
        "--wave: the cell has %d coordinates; waves are computed for at most %d. Choose the "
        "smallest part of the structure that repeats",
        (int)cell->n, (int)STRUT_MOST_BANDS);
  return STRUT_OK;
}

/* ---- its equilibrium ---- */

static const double MOST_LEFT = 16.0; /* force that rounding may leave, over the least */

static strut_status not_found(const lattice_cell *cell, const double *gradient,
                              strut_error *error) {
  int32_t worst = 0;
  for (int32_t r = 0; r < cell->n; r++)
    if (fabs(gradient[r]) > fabs(gradient[worst])) worst = r;
  return strut_fail(
      error, STRUT_NOT_SETTLED,
      "the repeated structure finds no equilibrium near this shape: a force of %.3g N "
      "stays on node '%s'. Draw the cell in equilibrium among its neighbours, or hold "
      "what loads move",
      fabs(gradient[worst]), cell->model->scene->nodes[cell->first[worst] / 2].name);
}

/* Images lie whole steps away, to all digits. */
static void place_images(const lattice_cell *cell, double *q) {
  const strut_scene *scene = cell->model->scene;
  for (int32_t i = 0; i < cell->model->length; i++) {
    int32_t owner = cell->owner[i / 2];
    if (owner == i / 2) continue;
    q[i] = q[2 * owner + i % 2];
    for (int k = 0; k < scene->lattice_count; k++)
      q[i] += cell->shift[i / 2][k] * scene->lattice[k][i % 2];
  }
}

/*
 * Moves q (length) to an equilibrium of the repeated structure whose steps are held; `residual` is the largest net
 * force that is left there [N].
 */
static strut_status settle_cell(const lattice_cell *cell, const strut_experiment *experiment,
                                double *q, double *residual, strut_error *error) {
  strut_potential *potential = NULL;
  strut_minimiser *minimiser = NULL;
  strut_arena scratch = {0};
  double *gradient = strut_arena_allocate(&scratch, (size_t)cell->n, sizeof *gradient);
  strut_status status = gradient ? strut_potential_create_tied(cell->model, cell->row, cell->n,
                                                               &scratch, &potential, error)
                                 : strut_no_memory(error, "");
  if (status == STRUT_OK) status = strut_minimiser_create(potential, &scratch, &minimiser, error);
  if (status == STRUT_OK) {
    strut_minimiser_watch(minimiser, experiment->interrupt);
    strut_minimiser_stay(minimiser);
    place_images(cell, q);
    strut_descent descent = strut_minimise(minimiser, q);
    *residual = descent.residual;
    status = strut_experiment_end(experiment, status, error);
    strut_potential_gradient(potential, q, gradient);
    if (status == STRUT_OK && !(descent.residual <= MOST_LEFT * descent.rounding))
      status = not_found(cell, gradient, error);
  }
  strut_arena_free(&scratch);
  return status;
}

/* ---- frequencies ---- */

typedef struct solver {
  const lattice_cell *cell;
  const strut_experiment *experiment;
  strut_vibration *v;
  gsl_matrix_complex *k, *m;
  gsl_vector *values;
  gsl_eigen_genherm_workspace *workspace;
  bool failed; /* some matrix had no eigenvalues */
} solver;

static bool create_solver(solver *self) {
  size_t n = (size_t)self->cell->n;
  self->k = gsl_matrix_complex_alloc(n, n);
  self->m = gsl_matrix_complex_alloc(n, n);
  self->values = gsl_vector_alloc(n);
  self->workspace = gsl_eigen_genherm_alloc(n);
  return self->k && self->m && self->values && self->workspace;
}

static void free_solver(solver *self) {
  if (self->k) gsl_matrix_complex_free(self->k);
  if (self->m) gsl_matrix_complex_free(self->m);
  if (self->values) gsl_vector_free(self->values);
  if (self->workspace) gsl_eigen_genherm_free(self->workspace);
}

static void add_entry(gsl_matrix_complex *matrix, int32_t row, int32_t column, gsl_complex value) {
  gsl_complex *at = gsl_matrix_complex_ptr(matrix, (size_t)row, (size_t)column);
  *at = gsl_complex_add(*at, value);
}

/* u of a node is that of its owner times exp(i shift phase); so are rows and columns of K and M. */
static void fold(solver *self, const double phase[2]) {
  const lattice_cell *cell = self->cell;
  const strut_sparse *matrix = self->v->shape->pattern;
  const int32_t *coordinate = self->v->shape->coordinate;
  gsl_matrix_complex_set_zero(self->k);
  gsl_matrix_complex_set_zero(self->m);
  for (int32_t j = 0; j < self->v->n; j++)
    for (int32_t at = matrix->start[j]; at < matrix->start[j + 1]; at++) {
      int32_t from = coordinate[matrix->row[at]], to = coordinate[j];
      int32_t r = cell->row[from], c = cell->row[to];
      double k = self->v->k[at], m = self->v->m[at], turns = 0.0;
      if (r < 0 || c < 0) continue;
      for (int d = 0; d < 2; d++)
        turns += (cell->shift[to / 2][d] - cell->shift[from / 2][d]) * phase[d];
      gsl_complex wave = gsl_complex_polar(1.0, STRUT_TAU * turns);
      add_entry(self->k, r, c, gsl_complex_mul_real(wave, k));
      add_entry(self->m, r, c, gsl_complex_mul_real(wave, m));
      if (from == to) continue;
      add_entry(self->k, c, r, gsl_complex_mul_real(gsl_complex_conjugate(wave), k));
      add_entry(self->m, c, r, gsl_complex_mul_real(gsl_complex_conjugate(wave), m));
    }
}

/* All frequencies at a phase, ascending [Hz]. */
static void solve(solver *self, const double phase[2], double *frequency) {
  size_t n = (size_t)self->cell->n;
  double nothing = 4.0 * DBL_EPSILON * (double)n * self->v->largest;
  if (self->failed || strut_experiment_interrupted(self->experiment)) {
    memset(frequency, 0, n * sizeof *frequency);
    return;
  }
  fold(self, phase);
  self->failed = gsl_eigen_genherm(self->k, self->m, self->values, self->workspace) != 0;
  for (size_t i = 0; i < n; i++) {
    double value = gsl_vector_get(self->values, i);
    if (fabs(value) <= nothing) value = 0.0;
    frequency[i] = copysign(sqrt(fabs(value)), value) / STRUT_TAU;
  }
  gsl_sort(frequency, 1, n);
}

/* ---- samples ---- */

static bool allocate(strut_waves *waves, size_t corners, size_t each) {
  size_t n = (size_t)waves->band_count;
  waves->count = (corners - 1) * each + 1;
  return STRUT_ALLOCATE(&waves->arena, STRUT_NEW(waves->phase, waves->count),
                        STRUT_NEW(waves->band, n), STRUT_NEW(waves->gaps, n)) &&
         STRUT_NUMBERS(&waves->arena, waves->count, &waves->along) &&
         STRUT_NUMBERS(&waves->arena, waves->count * n, &waves->frequency);
}

static void include(strut_waves *waves, const double phase[2], const double *frequency) {
  for (int32_t b = 0; b < waves->band_count; b++) {
    const strut_wave_edge edge = {frequency[b], {phase[0], phase[1]}};
    if (edge.frequency < waves->band[b].low.frequency) waves->band[b].low = edge;
    if (edge.frequency > waves->band[b].high.frequency) waves->band[b].high = edge;
  }
}

static void sample_line(solver *self, strut_waves *waves, const zone_corner *corner, size_t each) {
  for (size_t i = 0; i < waves->count; i++) {
    size_t line = i / each;
    double part = (double)(i % each) / (double)each;
    for (int d = 0; d < 2; d++)
      waves->phase[i][d] =
          part == 0.0
              ? corner[line].phase[d]
              : corner[line].phase[d] + part * (corner[line + 1].phase[d] - corner[line].phase[d]);
    waves->along[i] = (double)i / (double)each;
    double *frequency = waves->frequency + i * (size_t)waves->band_count;
    solve(self, waves->phase[i], frequency);
    include(waves, waves->phase[i], frequency);
    if (i % each) continue;
    waves->corner[waves->corner_count++] = (strut_wave_corner){corner[line].name, i};
  }
}

/* The zone beside its line: half of it, since waves both ways have the same frequency. */
static void sample_inside(solver *self, strut_waves *waves, double *frequency) {
  for (int i = 0; i <= SAMPLES_ACROSS / 2; i++)
    for (int j = -SAMPLES_ACROSS / 2 + 1; j <= SAMPLES_ACROSS / 2; j++, waves->inside++) {
      const double phase[2] = {(double)i / SAMPLES_ACROSS, (double)j / SAMPLES_ACROSS};
      solve(self, phase, frequency);
      include(waves, phase, frequency);
    }
}

/* ---- gaps ---- */

/* Climbs (sign 1) or descends from the best sample of a band, to the phase LOCATED. */
static void locate(solver *self, int32_t band, double sign, strut_wave_edge *edge,
                   double *frequency) {
  double step = 1.0 / SAMPLES_OF_LINE;
  while (step > LOCATED && !strut_experiment_interrupted(self->experiment)) {
    bool better = false;
    for (int k = 0; k < 2 * self->cell->model->scene->lattice_count; k++) {
      double phase[2] = {edge->phase[0], edge->phase[1]};
      phase[k / 2] += k % 2 ? -step : step;
      solve(self, phase, frequency);
      if (!(sign * (frequency[band] - edge->frequency) > 0)) continue;
      *edge = (strut_wave_edge){frequency[band], {phase[0], phase[1]}};
      better = true;
    }
    if (!better) step *= 0.5;
  }
}

static void find_gaps(solver *self, strut_waves *waves, double *frequency) {
  strut_wave_edge under = {0.0, {0.0, 0.0}};
  for (int32_t b = 0; b < waves->band_count; b++) {
    double lowest = under.frequency * (1.0 + REAL_GAP);
    if (waves->band[b].low.frequency > lowest) {
      if (b > 0) locate(self, b - 1, 1.0, &waves->band[b - 1].high, frequency);
      locate(self, b, -1.0, &waves->band[b].low, frequency);
      double low = b > 0 ? waves->band[b - 1].high.frequency : 0.0;
      if (waves->band[b].low.frequency > low * (1.0 + REAL_GAP))
        waves->gaps[waves->gap_count++] = (strut_wave_gap){b, low, waves->band[b].low.frequency};
    }
    under = waves->band[b].high;
  }
}

/* ---- long waves ---- */

/* Speed of a band from two long waves: exact up to the square of the longer one's phase. */
static void measure_speeds(solver *self, strut_waves *waves, double *frequency) {
  const double(*step)[2] = self->cell->model->scene->lattice;
  const double *first = waves->frequency; /* at no phase at all */
  while (waves->acoustic < 2 && waves->acoustic < waves->band_count &&
         first[waves->acoustic] == 0.0)
    waves->acoustic++;
  for (int k = 0; k < waves->steps; k++) {
    /* the waves' normal is across the other step, and their length that between its lines */
    double length = hypot(step[k][0], step[k][1]);
    if (waves->steps == 2)
      length = fabs(step[0][0] * step[1][1] - step[0][1] * step[1][0]) /
               hypot(step[1 - k][0], step[1 - k][1]);
    for (int half = 0; half < 2; half++) {
      double phase[2] = {0.0, 0.0};
      phase[k] = half ? 0.5 * LONG_WAVE : LONG_WAVE;
      solve(self, phase, frequency);
      for (int32_t b = 0; b < waves->acoustic; b++) {
        double speed = frequency[b] / phase[k] * length;
        waves->speed[k][b] = half ? 2.0 * speed - waves->speed[k][b] : speed;
      }
    }
  }
}

static strut_status check_masses(const solver *self, strut_arena *arena, strut_error *error) {
  double *mass = strut_arena_allocate(arena, (size_t)self->cell->n, sizeof *mass);
  if (!mass) return strut_no_memory(error, "");
  for (int32_t i = 0; i < self->v->n; i++) {
    int32_t row = self->cell->row[self->v->shape->coordinate[i]];
    if (row >= 0) mass[row] += self->v->mass[i];
  }
  for (int32_t r = 0; r < self->cell->n; r++)
    if (!(mass[r] > 0))
      return strut_fail(error, STRUT_SINGULAR,
                        "node '%s' has no mass, so waves have no finite frequency there; give it a "
                        "mass or hold it",
                        self->cell->model->scene->nodes[self->cell->first[r] / 2].name);
  return STRUT_OK;
}

static strut_status solve_zone(solver *self, strut_waves *waves, strut_error *error) {
  bool plane = waves->steps == 2;
  const zone_corner *corner = plane ? PLANE : ALONE;
  size_t each = plane ? SAMPLES_OF_LINE : SAMPLES_ALONE;
  size_t corners = plane ? sizeof PLANE / sizeof *PLANE : sizeof ALONE / sizeof *ALONE;
  double *frequency =
      strut_arena_allocate(&waves->arena, (size_t)waves->band_count, sizeof *frequency);
  if (!frequency || !allocate(waves, corners, each) || !create_solver(self))
    return strut_no_memory(error, "");
  for (int32_t b = 0; b < waves->band_count; b++) {
    waves->band[b].low.frequency = HUGE_VAL;
    waves->band[b].high.frequency = -HUGE_VAL;
  }
  sample_line(self, waves, corner, each);
  if (plane) sample_inside(self, waves, frequency);
  find_gaps(self, waves, frequency);
  measure_speeds(self, waves, frequency);
  if (self->failed)
    return strut_fail(
        error, STRUT_SINGULAR,
        "the cell's frequencies cannot be computed; check the masses and stiffnesses");
  return STRUT_OK;
}

/* The shape from which the equilibrium is sought. */
static strut_status choose_shape(const strut_scene *scene, const char *at, strut_waves *waves,
                                 double *q, strut_error *error) {
  waves->at = "drawn";
  for (size_t i = 0; i < scene->node_count; i++)
    memcpy(q + 2 * i, scene->nodes[i].position, sizeof scene->nodes[i].position);
  if (!at || strcmp(at, "drawn") == 0) return STRUT_OK;
  const strut_configuration *named = strut_configuration_named(scene, at);
  if (!named || !named->shaped)
    return strut_fail(error, STRUT_USAGE,
                      "--at '%s': waves start from 'drawn' or from a configuration with positions",
                      at);
  waves->at = named->name;
  memcpy(q, named->position, scene->node_count * 2 * sizeof *q);
  return STRUT_OK;
}

static strut_status find(const strut_model *model, const strut_experiment *experiment,
                         const strut_waves_options *options, strut_waves *waves,
                         strut_error *error) {
  lattice_cell cell;
  size_t length = (size_t)model->length;
  double *q, *before;
  if (!STRUT_NUMBERS(&waves->arena, length, &q, &before)) return strut_no_memory(error, "");
  strut_status status = create_cell(model, &waves->arena, &cell, error);
  if (status == STRUT_OK) status = choose_shape(model->scene, options->at, waves, q, error);
  if (status != STRUT_OK) return status;
  memcpy(before, q, length * sizeof *q);
  waves->q = q;
  waves->steps = model->scene->lattice_count;
  waves->images = cell.images;
  waves->band_count = cell.n;
  waves->shown = options->count > 0 && options->count < cell.n ? options->count : cell.n;
  status = settle_cell(&cell, experiment, q, &waves->residual, error);
  if (status != STRUT_OK) return status;
  for (size_t i = 0; i < length; i += 2)
    waves->moved = fmax(waves->moved, hypot(q[i] - before[i], q[i + 1] - before[i + 1]));
  solver s = {.cell = &cell, .experiment = experiment};
  status = strut_vibration_create(model, q, NULL, 0, NULL, &waves->arena, &s.v, error);
  if (status == STRUT_OK) status = check_masses(&s, &waves->arena, error);
  if (status == STRUT_OK) status = solve_zone(&s, waves, error);
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
