/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/statics/algebra.h"

#include "engine/base/vec.h"

struct strut_spectrum_workspace {
  const strut_potential *potential;
  double least;  /* of the spectrum at hand [N] */
  bool uneven;   /* stiffnesses differ by so much that the dense solver may lose the soft ones */
  double *dense; /* (n, n) the Hessian; eigenvectors of the form on soft modes */
  double *soft;  /* (n, n) room for this form */
  double *value, *noise;               /* (n) */
  double *vector, *turned;             /* (n, n) */
  double *along, *across, *form_noise; /* (n) of one force in each soft mode; noise of the form */
};

static bool is_uneven(const strut_model *model) {
  double low = HUGE_VAL, high = 0.0;
  for (int32_t i = 0; i < strut_force_count(model, true); i++) {
    double c = strut_force_stiffest(model, i);
    if (c > 0) low = fmin(low, c), high = fmax(high, c);
  }
  return high > 1e7 * low;
}

strut_spectrum_workspace *strut_spectrum_create(const strut_potential *potential,
                                                strut_arena *arena) {
  strut_spectrum_workspace *room = strut_arena_allocate(arena, 1, sizeof *room);
  size_t n = (size_t)potential->n;
  if (!room ||
      !STRUT_NUMBERS(arena, n * n, &room->dense, &room->soft, &room->vector, &room->turned) ||
      !STRUT_NUMBERS(arena, n, &room->value, &room->noise, &room->along, &room->across,
                     &room->form_noise))
    return NULL;
  room->potential = potential;
  room->uneven = is_uneven(potential->model);
  return room;
}

static bool fill_dense(const strut_sparse *matrix, strut_spectrum_workspace *room) {
  size_t n = (size_t)matrix->n;
  memset(room->dense, 0, n * n * sizeof *room->dense);
  for (size_t j = 0; j < n; j++)
    for (int32_t k = matrix->start[j]; k < matrix->start[j + 1]; k++) {
      size_t i = (size_t)matrix->row[k];
      if (!isfinite(matrix->value[k])) return false;
      room->dense[i * n + j] = room->dense[j * n + i] = matrix->value[k];
    }
  return true;
}

/* The change of a coordinate of a force in a mode; 0 where it is held. */
static double moved(const strut_mode_form *form, int32_t mode, const strut_force *force,
                    int32_t k) {
  int32_t row = form->row_of[strut_force_coordinate(force, k)];
  return row < 0 ? 0.0
                 : form->vector[(size_t)mode * form->mode_step + (size_t)row * form->row_step];
}

/* How a force is strained along b in a mode. A member is by what its ends move apart, which a motion of both does not blur. */
static double change_of(const strut_mode_form *form, int32_t mode, const strut_force *force,
                        const double *b) {
  bool member = force->kind == STRUT_FORCE_MEMBER;
  double sum = 0.0;
  for (int32_t k = member ? 2 : 0; k < 2 * force->nodes; k++)
    sum += b[k] * (moved(form, mode, force, k) - (member ? moved(form, mode, force, k - 2) : 0.0));
  return sum;
}

/*
 * Adds slope x x' + across y y', where a force is strained by x along b and turns by y along side; and to each mode's
 * noise what the rounding of both amounts to.
 */
static void add_squares(strut_mode_form *form, const strut_force *force, const double *b,
                        double slope, const double *side, double uncertain) {
  const double bits = 8.0 * DBL_EPSILON, turn = force->across, size = fabs(turn);
  double *x = form->along, *y = form->across;
  for (int32_t i = 0; i < form->count; i++) {
    bool turns = force->kind == STRUT_FORCE_MEMBER || turn != 0.0;
    x[i] = change_of(form, i, force, b);
    y[i] = turns ? change_of(form, i, force, side) : 0.0;
    for (int32_t k = 0; k <= i; k++)
      form->sum[i * form->count + k] += slope * x[i] * x[k] + turn * y[i] * y[k];
    /* modes are known to some last bits, and so is what a member stretches and turns in them */
    form->noise[i] += bits * (slope * fabs(x[i]) * (fabs(x[i]) + bits) +
                              size * fabs(y[i]) * (fabs(y[i]) + bits)) +
                      bits * bits * (slope + size) + uncertain * y[i] * y[i];
  }
}

/* The force that last bits of positions and strain are worth. */
static double uncertain_force(const strut_force *force, const double *q) {
  double bits = fabs(force->pose.strain) * DBL_EPSILON;
  for (int32_t k = 0; k < force->nodes; k++) {
    const double *at = q + force->at[k], *b = &force->pose.b[2 * k];
    bits = fmax(bits, hypot(b[0], b[1]) * strut_coordinate_rounding(at, at));
  }
  return fabs(force->pose.slope) * bits;
}

/* What the force of an element adds by bending the strain directly. */
static void add_bend(strut_mode_form *form, const strut_force *force, const double *q) {
  int32_t n = 2 * force->nodes, count = form->count;
  double bend[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT] = {0}, own[STRUT_MOST_GRADIENT];
  double uncertain = uncertain_force(force, q), pull = force->pose.force;
  strut_element_bend(form->model, force->index, q, 1.0, bend);
  for (int32_t k = 0; k < count; k++) {
    for (int32_t r = 0; r < n; r++) {
      own[r] = 0.0;
      for (int32_t c = 0; c < n; c++) own[r] += bend[r * n + c] * moved(form, k, force, c);
    }
    for (int32_t l = 0; l <= k; l++) {
      double sum = 0.0, size = 0.0;
      for (int32_t r = 0; r < n; r++) {
        double x = own[r] * moved(form, l, force, r);
        sum += x, size += fabs(x);
      }
      form->sum[k * count + l] += pull * sum;
      if (l < k) continue;
      form->noise[k] += (16.0 * DBL_EPSILON * fabs(pull) + uncertain) * size;
      form->part = fmax(form->part, fmax(fabs(pull * sum), fabs(force->pose.slope) *
                                                               form->along[k] * form->along[k]));
    }
  }
}

void strut_mode_form_add(strut_mode_form *form, const strut_force *force, const double *q) {
  static const double right[4] = {-1.0, 0.0, 1.0, 0.0}, up[4] = {0.0, -1.0, 0.0, 1.0};
  const double *b = force->pose.b, *side = force->side;
  double length = force->pose.strain, slope = force->pose.slope, uncertain = 0.0;
  if (force->kind == STRUT_FORCE_MEMBER) {
    const double *from = q + force->at[0], *to = q + force->at[1];
    if (length == 0.0) b = right, side = up; /* a spring alike in all directions, or none */
    if (length == 0.0) slope = force->across;
    if (length != 0.0) uncertain = slope * strut_coordinate_rounding(from, to) / fabs(length);
  }
  add_squares(form, force, b, slope, side, uncertain);
  if (force->kind == STRUT_FORCE_ELEMENT) add_bend(form, force, q);
}

/* Replaces the first `count` eigenpairs by those of the form summed member by member. */
static bool refine(strut_spectrum_workspace *room, const double *q, int32_t count) {
  size_t n = (size_t)room->potential->n, m = (size_t)count;
  memset(room->soft, 0, m * m * sizeof *room->soft);
  memset(room->form_noise, 0, m * sizeof *room->form_noise);
  strut_mode_form form = {.model = room->potential->model,
                          .row_of = room->potential->row_of,
                          .count = count,
                          .vector = room->vector,
                          .mode_step = n,
                          .row_step = 1,
                          .sum = room->soft,
                          .noise = room->form_noise,
                          .along = room->along,
                          .across = room->across};
  strut_force_visit visit = strut_potential_visit(room->potential, q, room->least);
  for (const strut_force *force; (force = strut_force_next(&visit));)
    strut_mode_form_add(&form, force, q);
  for (size_t i = 0; i < m; i++)
    for (size_t k = 0; k < i; k++) room->soft[k * m + i] = room->soft[i * m + k];
  if (!strut_eigen_ascending(room->soft, count, room->value, room->dense)) return false;
  double largest = fmax(fabs(room->value[0]), fabs(room->value[m - 1]));
  memset(room->turned, 0, m * n * sizeof *room->turned);
  for (size_t i = 0; i < m; i++) {
    double noise = count * DBL_EPSILON * largest; /* of the dense solver, among the soft modes */
    for (size_t k = 0; k < m; k++) {
      double weight = room->dense[i * m + k];
      noise += weight * weight * room->form_noise[k];
      for (size_t at = 0; at < n; at++)
        room->turned[i * n + at] += weight * room->vector[k * n + at];
    }
    room->noise[i] = noise;
  }
  memcpy(room->vector, room->turned, m * n * sizeof *room->vector);
  return true;
}

/* Below this share of the largest, eigenvalues of the dense solver are not worth their digits. */
static const double LOST = 1e-10;

double strut_spectrum_noise(const strut_spectrum_workspace *room, double largest) {
  return fmax(8.0 * room->potential->n * DBL_EPSILON, room->uneven ? LOST : 0.0) * largest +
         DBL_MIN;
}

bool strut_spectrum_compute(strut_spectrum_workspace *room, const strut_sparse *hessian,
                            const double *q, double least, bool careful, strut_spectrum *spectrum) {
  int32_t n = room->potential->n, soft = 0, lost = 0;
  *spectrum = (strut_spectrum){n, room->value, room->vector, room->noise};
  if (n == 0) return true;
  room->least = least;
  if (!fill_dense(hessian, room) ||
      !strut_eigen_ascending(room->dense, n, room->value, room->vector))
    return false;
  double largest = fmax(fabs(room->value[0]), fabs(room->value[n - 1]));
  for (int32_t i = 0; i < n; i++) {
    room->noise[i] = n * DBL_EPSILON * largest;
    if (fabs(room->value[i]) < LOST * largest) lost++;
    if (room->value[i] < 1e-3 * largest) soft = i + 1;
  }
  if (soft == 0 || !(careful || (lost > 0 && room->uneven))) return true;
  return refine(room, q, soft);
}

static const double *mode_of(const strut_spectrum *spectrum, int32_t i) {
  return spectrum->vector + (size_t)i * (size_t)spectrum->n;
}

void strut_spectrum_split(const strut_spectrum *spectrum, const double *gradient, double still,
                          double *part, uint8_t *idle) {
  for (int32_t i = 0; i < spectrum->n; i++) {
    part[i] = strut_dot(mode_of(spectrum, i), gradient, spectrum->n);
    idle[i] = fabs(spectrum->value[i]) <= 4.0 * spectrum->noise[i] && fabs(part[i]) <= still;
  }
}

double strut_spectrum_combine(const strut_spectrum *spectrum, const double *vector, double *step) {
  double square = 0.0;
  memset(step, 0, (size_t)spectrum->n * sizeof *step);
  for (int32_t i = 0; i < spectrum->n; i++) {
    if (vector[i] == 0.0) continue;
    square += vector[i] * vector[i];
    for (int32_t k = 0; k < spectrum->n; k++) step[k] += vector[i] * mode_of(spectrum, i)[k];
  }
  return sqrt(square);
}

bool strut_spectrum_rebalance(const strut_spectrum *spectrum, const double *value, double stiff,
                              const double *gradient, double *step) {
  bool any = false;
  for (int32_t i = 0; i < spectrum->n; i++) {
    const double *mode = mode_of(spectrum, i);
    if (!(value[i] > stiff && spectrum->value[i] > stiff)) continue;
    double far = strut_dot(mode, gradient, spectrum->n) / spectrum->value[i];
    for (int32_t k = 0; k < spectrum->n; k++) step[k] -= far * mode[k];
    any = true;
  }
  return any;
}
