/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/algebra.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/forces/tangent.h"

struct strut_spectrum_workspace {
  const strut_potential *potential;
  strut_arena arena;
  strut_sparse *hessian;
  double least; /* of the spectrum at hand [N] */
  bool uneven;  /* stiffnesses differ by so much that the dense solver may lose the soft ones */
  strut_tridiagonal dense;
  double *soft;                /* (n, n) room for the form on soft modes, then its eigenvectors */
  double *raw, *value, *noise; /* (n) */
  double *work;                /* (n) */
  double *vector, *turned;     /* (n, n) */
  double *along, *across, *form_noise; /* (n) of one member in each soft mode; noise of the form */
  int32_t *order;                      /* (n) */
};

static double *numbers(strut_arena *arena, size_t count) {
  return strut_arena_allocate(arena, count, sizeof(double));
}

static bool is_uneven(const strut_model *model) {
  double low = HUGE_VAL, high = 0.0;
  for (int32_t j = 0; j < model->members.count; j++) {
    double c = model->members.stiffness[j];
    if (!(c > 0)) continue;
    low = fmin(low, c), high = fmax(high, c);
  }
  for (int32_t i = 0; i < model->elements.count; i++) {
    double c = strut_element_stiffest(model, i);
    if (!(c > 0)) continue;
    low = fmin(low, c), high = fmax(high, c);
  }
  for (int32_t i = 0; i < model->contacts.count; i++) {
    double c = model->contacts.entry[i].stiffness;
    low = fmin(low, c), high = fmax(high, c);
  }
  return high > 1e7 * low;
}

strut_spectrum_workspace *strut_spectrum_create(const strut_potential *potential) {
  strut_spectrum_workspace *room = strut_allocate(1, sizeof *room);
  size_t n = (size_t)potential->n;
  if (!room) return NULL;
  room->potential = potential;
  room->uneven = is_uneven(potential->model);
  double **square[] = {&room->soft, &room->vector, &room->turned};
  double **line[] = {&room->raw,   &room->value,  &room->noise,     &room->work,
                     &room->along, &room->across, &room->form_noise};
  bool good = true;
  for (size_t i = 0; i < sizeof square / sizeof square[0]; i++)
    good = good && (*square[i] = numbers(&room->arena, n * n));
  for (size_t i = 0; i < sizeof line / sizeof line[0]; i++)
    good = good && (*line[i] = numbers(&room->arena, n));
  good = good && (room->order = strut_arena_allocate(&room->arena, n, sizeof *room->order));
  good = good && strut_tridiagonal_create(&room->dense, potential->n, &room->arena);
  good = good && (room->hessian = strut_potential_matrix(potential, &room->arena));
  if (good) return room;
  strut_spectrum_free(room);
  return NULL;
}

void strut_spectrum_free(strut_spectrum_workspace *room) {
  if (!room) return;
  strut_arena_free(&room->arena);
  strut_release(room);
}

/* The order of values from small to large; equal ones keep theirs. */
static void sort_order(const double *value, int32_t n, int32_t *order) {
  for (int32_t i = 0; i < n; i++) {
    int32_t k = i;
    for (; k > 0 && value[order[k - 1]] > value[i]; k--) order[k] = order[k - 1];
    order[k] = i;
  }
}

static bool fill_dense(strut_spectrum_workspace *room) {
  const strut_sparse *h = room->hessian;
  size_t n = (size_t)h->n;
  memset(room->dense.z, 0, n * n * sizeof *room->dense.z);
  for (size_t j = 0; j < n; j++)
    for (int32_t k = h->start[j]; k < h->start[j + 1]; k++) {
      size_t i = (size_t)h->row[k];
      if (!isfinite(h->value[k])) return false;
      room->dense.z[i * n + j] = room->dense.z[j * n + i] = h->value[k];
    }
  return true;
}

/* The change of a coordinate in mode i; 0 where it is held. */
static double moved(const strut_spectrum_workspace *room, const double *mode, uint32_t at) {
  int32_t row = room->potential->row_of[at];
  return row < 0 ? 0.0 : mode[row];
}

/*
 * Adds stiffness * x x' + geometric * y y' to the form on `count` modes, where x, y are how a
 * member stretches and turns in them; and to each mode's noise what the rounding of both amounts
 * to.
 */
static void add_form(strut_spectrum_workspace *room, int32_t count, double stiffness,
                     double geometric, double uncertain) {
  const double *x = room->along, *y = room->across;
  for (int32_t i = 0; i < count; i++) {
    for (int32_t k = 0; k <= i; k++)
      room->soft[i * count + k] += stiffness * x[i] * x[k] + geometric * y[i] * y[k];
    /* modes are known to some last bits, and so is what a member stretches and turns in them */
    double bits = 8.0 * DBL_EPSILON;
    room->form_noise[i] += bits * (stiffness * fabs(x[i]) * (fabs(x[i]) + bits) +
                                   fabs(geometric) * fabs(y[i]) * (fabs(y[i]) + bits)) +
                           bits * bits * (stiffness + fabs(geometric)) + uncertain * y[i] * y[i];
  }
}

typedef struct form_sum {
  strut_spectrum_workspace *room;
  const double *q;
  int32_t count;
} form_sum;

static void add_member(void *context, int32_t j, const strut_member_tangent *m) {
  const form_sum *sum = context;
  strut_spectrum_workspace *room = sum->room;
  const strut_member_table *t = &room->potential->model->members;
  uint32_t a = t->from[j], b = t->to[j];
  double length = m->pose.length, bit = strut_coordinate_rounding(sum->q + a, sum->q + b);
  if (!(length > 0.0) && t->rest[j] > 0.0) return;
  strut_vec2 u = length > 0.0 ? m->pose.unit : (strut_vec2){1.0, 0.0};
  for (int32_t i = 0; i < sum->count; i++) {
    const double *mode = room->vector + (size_t)i * (size_t)room->potential->n;
    double mx = moved(room, mode, b) - moved(room, mode, a);
    double my = moved(room, mode, b + 1) - moved(room, mode, a + 1);
    room->along[i] = u.x * mx + u.y * my;
    room->across[i] = u.x * my - u.y * mx;
  }
  add_form(room, sum->count, m->along, m->across, length > 0.0 ? m->along * bit / length : 0.0);
}

/* The force that last bits of positions and strain are worth. */
static double uncertain_force(const strut_model *model, int32_t i, const strut_element_pose *pose,
                              const double *q) {
  const strut_element *e = &model->elements.element[i];
  double bits = fabs(pose->strain) * DBL_EPSILON;
  for (int32_t k = 0; k < e->nodes; k++) {
    const double *at = q + model->elements.at[e->first + k];
    bits =
        fmax(bits, hypot(pose->b[2 * k], pose->b[2 * k + 1]) * strut_coordinate_rounding(at, at));
  }
  return fabs(pose->slope) * bits;
}

/* Along its gradient like a member; what its force adds by bending the strain directly. */
static void add_element(void *context, int32_t i, const strut_element_pose *pose) {
  const form_sum *sum = context;
  strut_spectrum_workspace *room = sum->room;
  const strut_model *model = room->potential->model;
  const strut_element *e = &model->elements.element[i];
  const uint32_t *at = model->elements.at + e->first;
  int32_t n = 2 * e->nodes;
  double bend[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT] = {0}, own[STRUT_MOST_GRADIENT];
  strut_element_bend(model, i, sum->q, 1.0, bend);
  double uncertain = uncertain_force(model, i, pose, sum->q);
  for (int32_t k = 0; k < sum->count; k++) {
    const double *mode = room->vector + (size_t)k * (size_t)room->potential->n;
    room->along[k] = room->across[k] = 0.0;
    for (int32_t r = 0; r < n; r++)
      room->along[k] += pose->b[r] * moved(room, mode, at[r / 2] + (uint32_t)(r % 2));
  }
  add_form(room, sum->count, pose->slope, 0.0, 0.0);
  for (int32_t k = 0; k < sum->count; k++) {
    const double *mode = room->vector + (size_t)k * (size_t)room->potential->n;
    for (int32_t r = 0; r < n; r++) {
      own[r] = 0.0;
      for (int32_t c = 0; c < n; c++)
        own[r] += bend[r * n + c] * moved(room, mode, at[c / 2] + (uint32_t)(c % 2));
    }
    for (int32_t l = 0; l <= k; l++) {
      const double *other = room->vector + (size_t)l * (size_t)room->potential->n;
      double form = 0.0, size = 0.0;
      for (int32_t r = 0; r < n; r++) {
        double x = own[r] * moved(room, other, at[r / 2] + (uint32_t)(r % 2));
        form += x, size += fabs(x);
      }
      room->soft[k * sum->count + l] += pose->force * form;
      if (l == k)
        room->form_noise[k] += (16.0 * DBL_EPSILON * fabs(pose->force) + uncertain) * size;
    }
  }
}

static void add_contact(void *context, int32_t i, const strut_closed_contact *contact) {
  const form_sum *sum = context;
  strut_spectrum_workspace *room = sum->room;
  const strut_contact_table *c = &room->potential->model->contacts;
  for (int32_t k = 0; k < sum->count; k++) {
    const double *mode = room->vector + (size_t)k * (size_t)room->potential->n;
    const double *n = contact->axes.normal, *t = contact->axes.tangent;
    double x = moved(room, mode, c->at[i]), y = moved(room, mode, c->at[i] + 1);
    room->along[k] = x * n[0] + y * n[1];
    room->across[k] = contact->across != 0.0 ? x * t[0] + y * t[1] : 0.0;
  }
  add_form(room, sum->count, contact->stiffness, contact->across, 0.0);
}

/* Replaces the first `count` eigenpairs by those of the form summed member by member. */
static bool refine(strut_spectrum_workspace *room, const double *q, int32_t count) {
  size_t n = (size_t)room->potential->n, m = (size_t)count;
  memset(room->soft, 0, m * m * sizeof *room->soft);
  memset(room->form_noise, 0, m * sizeof *room->form_noise);
  form_sum sum = {room, q, count};
  strut_tangent_visit(room->potential->model, q, room->potential->model->members.rest, room->least,
                      room->potential->ground ? STRUT_CLOSED_TOUCHING : STRUT_CLOSED_NONE, &sum,
                      add_member, add_element, add_contact);
  for (size_t i = 0; i < m; i++)
    for (size_t k = 0; k < i; k++) room->soft[k * m + i] = room->soft[i * m + k];
  if (!strut_eigen(room->soft, count, room->raw, room->work)) return false;
  sort_order(room->raw, count, room->order);
  double largest = fmax(fabs(room->raw[room->order[0]]), fabs(room->raw[room->order[m - 1]]));
  memset(room->turned, 0, m * n * sizeof *room->turned);
  for (size_t i = 0; i < m; i++) {
    size_t column = (size_t)room->order[i];
    double noise = count * DBL_EPSILON * largest; /* of the dense solver, among the soft modes */
    for (size_t k = 0; k < m; k++) {
      double weight = room->soft[column * m + k];
      noise += weight * weight * room->form_noise[k];
      for (size_t at = 0; at < n; at++)
        room->turned[i * n + at] += weight * room->vector[k * n + at];
    }
    room->value[i] = room->raw[column];
    room->noise[i] = noise;
  }
  memcpy(room->vector, room->turned, m * n * sizeof *room->vector);
  return true;
}

static bool reduce(strut_spectrum_workspace *room, const double *q, double least) {
  room->least = least;
  strut_potential_hessian_above(room->potential, q, least, room->hessian);
  if (!fill_dense(room)) return false;
  strut_tridiagonal_reduce(&room->dense);
  return true;
}

/* Below this share of the largest, eigenvalues of the dense solver are not worth their digits. */
static const double LOST = 1e-10;

bool strut_spectrum_finish(strut_spectrum_workspace *room, const double *q, bool careful,
                           strut_spectrum *spectrum) {
  int32_t n = room->potential->n, soft = 0, lost = 0;
  *spectrum = (strut_spectrum){n, room->value, room->vector, room->noise};
  if (n == 0) return true;
  if (!strut_tridiagonal_eigen(&room->dense, room->raw)) return false;
  sort_order(room->raw, n, room->order);
  size_t rows = (size_t)n;
  for (size_t i = 0; i < rows; i++) {
    room->value[i] = room->raw[room->order[i]];
    memcpy(room->vector + i * rows, room->dense.z + (size_t)room->order[i] * rows,
           rows * sizeof *room->vector);
  }
  double largest = fmax(fabs(room->value[0]), fabs(room->value[n - 1]));
  for (int32_t i = 0; i < n; i++) {
    room->noise[i] = n * DBL_EPSILON * largest;
    if (fabs(room->value[i]) < LOST * largest) lost++;
    if (room->value[i] < 1e-3 * largest) soft = i + 1;
  }
  if (soft == 0 || !(careful || (lost > 0 && room->uneven))) return true;
  return refine(room, q, soft);
}

bool strut_spectrum_reduce(strut_spectrum_workspace *room, const double *q, strut_tridiagonal **t,
                           bool *singular) {
  *t = &room->dense;
  if (!reduce(room, q, 0.0)) return false;
  double noise = fmax(8.0 * room->dense.n * DBL_EPSILON, room->uneven ? LOST : 0.0);
  double shift = noise * room->dense.bound + DBL_MIN;
  int32_t above = strut_tridiagonal_factor(&room->dense, -shift);
  *singular = strut_tridiagonal_factor(&room->dense, shift) != above;
  return true;
}

bool strut_spectrum_compute(strut_spectrum_workspace *room, const double *q, double least,
                            bool careful, strut_spectrum *spectrum) {
  return reduce(room, q, least) && strut_spectrum_finish(room, q, careful, spectrum);
}
