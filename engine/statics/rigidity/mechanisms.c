/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/rigidity/rigidity.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/statics/algebra.h"
#include "engine/statics/potential.h"

/* Most members of a walk: each step solves a dense system of that size. */
enum { WALK_MEMBERS = 200 };

typedef struct finite_walk {
  bool arrived;  /* all the way, with lengths kept */
  double moved;  /* largest change of a distance between two nodes at the end [m] */
  double strain; /* largest relative change of a member's length on the way */
} finite_walk;

enum { STEPS = 10, MOST_CORRECTIONS = 12 };

static const double STRIDE = 0.01;       /* of the size, by the node that moves most */
static const double KEPT = 1e-12;        /* strain that counts as none */
static const double PROGRESS = 0.5;      /* of a stride that corrections must leave */
static const double LEAST_CHANGE = 0.02; /* of the size: else it was a rigid motion */
/* Redundant members make A' A singular; this much on its diagonal leaves the rest alone. */
static const double DAMPING = 1e-11;

typedef struct walker {
  const strut_model *model;
  const double *start; /* positions at the beginning */
  double *q, *before, *motion, *length, *strain, *gram, *step;
  strut_equilibrium_matrix a;
  strut_arena matrix;
} walker;

static bool allocate_walk(walker *self, const double *positions, strut_arena *arena, int32_t rows) {
  size_t length = (size_t)self->model->length;
  size_t members = (size_t)strut_equilibrium_columns(self->model);
  self->start = positions;
  self->q = strut_arena_copy(arena, positions, length, sizeof *positions);
  return self->q && STRUT_NUMBERS(arena, length, &self->before) &&
         STRUT_NUMBERS(arena, rows, &self->motion, &self->step) &&
         STRUT_NUMBERS(arena, members, &self->length, &self->strain) &&
         STRUT_NUMBERS(arena, members * members, &self->gram);
}

static bool build_matrix(walker *self) {
  strut_arena_free(&self->matrix);
  return strut_equilibrium_matrix_build(self->model, self->q, &self->matrix, &self->a) == STRUT_OK;
}

/* x (members) = (A' A + damping)^-1 x, by Cholesky; false where rounding spoils it. */
static bool solve_gram(walker *self, double *vector) {
  const strut_equilibrium_matrix *matrix = &self->a;
  size_t n = (size_t)matrix->columns;
  if (n == 0) return true;
  for (int32_t j = 0; j < matrix->columns; j++) {
    memset(self->step, 0, (size_t)matrix->rows * sizeof *self->step);
    for (int32_t k = matrix->start[j]; k < matrix->start[j + 1]; k++)
      self->step[matrix->row[k]] = matrix->value[k];
    strut_equilibrium_elongate(matrix, self->step, self->gram + (size_t)j * n);
    self->gram[(size_t)j * n + (size_t)j] += DAMPING;
  }
  gsl_matrix_view gram = gsl_matrix_view_array(self->gram, n, n);
  gsl_vector_view view = gsl_vector_view_array(vector, n);
  if (gsl_linalg_cholesky_decomp1(&gram.matrix) != 0) return false;
  return gsl_linalg_cholesky_svx(&gram.matrix, &view.vector) == 0;
}

static double largest_strain(const walker *self) {
  double largest = 0.0;
  for (int32_t j = self->a.members; j < self->a.columns; j++) /* change of an angle */
    largest = fmax(largest, fabs(self->a.length[j] - self->length[j]) / self->a.size);
  for (int32_t j = 0; j < self->a.members; j++)
    if (self->length[j] > 0)
      largest = fmax(largest, fabs(self->a.length[j] - self->length[j]) / self->length[j]);
    else
      largest = fmax(largest, self->a.length[j] / self->model->size);
  return largest;
}

/* Back to the lengths by the least displacement that does it. */
static bool correct(walker *self, double *strain) {
  for (int i = 0; i < MOST_CORRECTIONS; i++) {
    if (!build_matrix(self)) return false;
    *strain = largest_strain(self);
    if (*strain <= KEPT) return true;
    for (int32_t j = 0; j < self->a.columns; j++)
      self->strain[j] = self->length[j] - self->a.length[j];
    if (!solve_gram(self, self->strain)) return false;
    strut_equilibrium_multiply(&self->a, self->strain, self->step);
    for (int32_t r = 0; r < self->a.rows; r++) self->q[self->a.coordinate[r]] += self->step[r];
  }
  return false;
}

/* The motion at hand without what stretches members here; largest entry 1. */
static bool straighten(walker *self) {
  strut_equilibrium_elongate(&self->a, self->motion, self->strain);
  if (!solve_gram(self, self->strain)) return false;
  strut_equilibrium_multiply(&self->a, self->strain, self->step);
  double largest = 0.0;
  for (int32_t r = 0; r < self->a.rows; r++) {
    self->motion[r] -= self->step[r];
    largest = fmax(largest, fabs(self->motion[r]));
  }
  for (int32_t r = 0; r < self->a.rows; r++) self->motion[r] /= largest;
  return largest > 0.1;
}

static bool stride(walker *self, double stride_length, double *strain) {
  double gone = 0.0;
  memcpy(self->before, self->q, (size_t)self->model->length * sizeof *self->q);
  for (int32_t r = 0; r < self->a.rows; r++)
    self->q[self->a.coordinate[r]] += stride_length * self->motion[r];
  if (!correct(self, strain)) return false;
  for (int32_t r = 0; r < self->a.rows; r++) {
    int32_t at = self->a.coordinate[r];
    self->motion[r] = self->q[at] - self->before[at];
    gone = fmax(gone, fabs(self->motion[r]));
  }
  for (int32_t r = 0; r < self->a.rows; r++) self->motion[r] /= gone > 0 ? gone : 1.0;
  return gone >= PROGRESS * stride_length;
}

/* Largest change of the distance between two nodes: zero for rigid motions. */
static double change_of_shape(const walker *self) {
  double largest = 0.0;
  for (int32_t i = 0; i < self->model->node_count; i++)
    for (int32_t k = 0; k < i; k++) {
      const double *p = self->q, *s = self->start;
      double now = strut_distance(p + 2 * k, p + 2 * i);
      double then = strut_distance(s + 2 * k, s + 2 * i);
      largest = fmax(largest, fabs(now - then));
    }
  return largest;
}

/*
 * Walks from q (length) along the motion (rows of A at q) in steps of a hundredth of the model's
 * size, returning to the lengths by Newton's method after each. STRUT_OK or STRUT_NO_MEMORY.
 */
static strut_status walk_finite_motion(const strut_model *model, const double *positions,
                                       const double *motion, finite_walk *walk) {
  *walk = (finite_walk){.moved = (double)NAN, .strain = (double)NAN};
  if (strut_equilibrium_columns(model) > WALK_MEMBERS) return STRUT_OK;
  strut_arena scratch = {0};
  walker w = {.model = model};
  strut_status status = STRUT_NO_MEMORY;
  strut_equilibrium_matrix first;
  if (strut_equilibrium_matrix_build(model, positions, &scratch, &first) == STRUT_OK &&
      allocate_walk(&w, positions, &scratch, first.rows) && build_matrix(&w)) {
    status = STRUT_OK;
    memcpy(w.length, first.length, (size_t)first.columns * sizeof *w.length);
    memcpy(w.motion, motion, (size_t)first.rows * sizeof *motion);
    bool good = true;
    double worst = 0.0;
    for (int i = 0; i < STEPS && good; i++) {
      double strain = 0.0;
      good = straighten(&w) && stride(&w, STRIDE * model->size, &strain);
      worst = fmax(worst, strain);
    }
    walk->moved = change_of_shape(&w);
    walk->strain = worst;
    walk->arrived = good && walk->moved >= LEAST_CHANGE * model->size;
  }
  strut_arena_free(&w.matrix);
  strut_arena_free(&scratch);
  return status;
}

/* Forms and parts of vectors this small beside the largest are rounding. */
static const double ROUNDING = 1e-8;

/* With more motions or states than these, forms are not compared. */
enum { MOST_MOTIONS = 40, MOST_STATES = 200 };

typedef struct sorter {
  const strut_model *model;
  const strut_equilibrium_matrix *a;
  const double *q;
  const strut_self_stress *states;
  strut_arena *arena;
  strut_arena scratch;
  size_t rows, members, n; /* members: and hinges; n: motions that are not rigid-body */
  double *motion;          /* (3 + n, rows): rigid-body ones, then the others */
  double *inner;           /* where the others begin */
  double *density;         /* (members) scratch */
  double *forms;           /* (states, n, n) of the states of self-stress; NULL: not compared */
  double *scale;           /* (states) largest densities of theirs */
  double *form, *value, *vector, *turned; /* (n, n), (n), (n, n), (n, rows) scratch */
} sorter;

const char *strut_motion_kind_name(strut_motion_kind kind) {
  static const char *const names[] = {"rigid-body", "infinitesimal", "finite", "undecided"};
  return names[kind];
}

/* Collects the null space beside the rigid motions, vectors with the largest remainder first. */
static void collect(sorter *self, const double *space, size_t count, size_t rigid) {
  double *rest = self->turned;
  memcpy(rest, space, count * self->rows * sizeof *rest);
  for (size_t i = 0; i < count; i++)
    strut_remove_shares(self->motion, rigid, self->rows, rest + i * self->rows);
  for (size_t k = 0; k < self->n; k++) {
    double best = -1.0, *chosen = self->inner + k * self->rows;
    for (size_t i = 0; i < count; i++) {
      double left = strut_dot(rest + i * self->rows, rest + i * self->rows, (ptrdiff_t)self->rows);
      if (left <= best * 1.0001) continue;
      best = left;
      memcpy(chosen, rest + i * self->rows, self->rows * sizeof *rest);
    }
    double norm = sqrt(strut_remove_shares(self->motion, rigid + k, self->rows, chosen));
    for (size_t c = 0; c < self->rows; c++) chosen[c] /= norm;
    for (size_t i = 0; i < count; i++)
      strut_remove_shares(chosen, 1, self->rows, rest + i * self->rows);
  }
}

/* Fills in the densities of member forces and returns the largest. */
static double set_density(sorter *self, const double *force) {
  double largest = 0.0;
  for (size_t j = 0; j < self->members; j++) {
    self->density[j] = strut_column_density(self->a, (int32_t)j, force[j]);
    largest = fmax(largest, fabs(self->density[j]));
  }
  return largest;
}

/* The form of member forces on the inner motions; returns the largest density, its scale. */
static double form_of(sorter *self, const double *force, double *form) {
  double scale = set_density(self, force);
  strut_stress_form_on(self->model, self->a, self->density, self->inner, (int32_t)self->n, form);
  return scale;
}

/* Replaces the inner motions by the combinations that diagonalise a form, which it overwrites. */
static bool rotate(sorter *self, double *form) {
  if (!strut_symmetric_eigen(form, self->n, self->value, self->vector)) return false;
  memset(self->turned, 0, self->n * self->rows * sizeof *self->turned);
  for (size_t i = 0; i < self->n; i++)
    for (size_t k = 0; k < self->n; k++)
      for (size_t c = 0; c < self->rows; c++)
        self->turned[i * self->rows + c] +=
            self->vector[i * self->n + k] * self->inner[k * self->rows + c];
  memcpy(self->inner, self->turned, self->n * self->rows * sizeof *self->turned);
  return true;
}

static bool compare_states(sorter *self) {
  size_t square = self->n * self->n, count = (size_t)self->states->count;
  if (!self->states->force || count > MOST_STATES || self->n > MOST_MOTIONS) return true;
  if (!STRUT_NUMBERS(&self->scratch, count * square, &self->forms) ||
      !STRUT_NUMBERS(&self->scratch, count, &self->scale))
    return false;
  for (size_t i = 0; i < count; i++)
    self->scale[i] =
        form_of(self, self->states->force + i * self->members, self->forms + i * square);
  return true;
}

/* A state of self-stress that is positive on all inner motions, with cables pulled if it can. */
static strut_status find_stiffener(sorter *self, strut_mechanisms *mechanisms) {
  double *force = strut_arena_allocate(self->arena, self->members + 1, sizeof *force);
  if (!force) return STRUT_NO_MEMORY;
  for (int cables = 1; cables >= 0 && self->forms; cables--) {
    strut_stress_wish wish = {
        .cables = cables, .motions = (int32_t)self->n, .forms = self->forms, .scale = self->scale};
    bool found = false;
    strut_status status =
        strut_self_stress_combine(self->model, self->states, &wish, force, &found);
    if (status != STRUT_OK) return status;
    if (!found) continue;
    mechanisms->stiffener = force;
    mechanisms->stiffener_pulls = cables;
    return STRUT_OK;
  }
  return STRUT_OK;
}

/* Sorts motions that no state of self-stress affects first, by the sum of squared forms. */
static bool separate(sorter *self, size_t *silent) {
  size_t n = self->n, count = self->forms ? (size_t)self->states->count : 0;
  memset(self->form, 0, n * n * sizeof *self->form);
  for (size_t i = 0; i < count; i++) {
    const double *f = self->forms + i * n * n;
    double size = self->scale[i];
    for (size_t r = 0; r < n && size > 0; r++)
      for (size_t c = 0; c < n; c++)
        self->form[r * n + c] += strut_dot(f + r * n, f + c * n, (ptrdiff_t)n) / (size * size);
  }
  if (!rotate(self, self->form)) return false;
  *silent = 0;
  while (*silent < n && self->value[*silent] <= ROUNDING * ROUNDING) (*silent)++;
  return true;
}

/* The rigid-body motions over the same rows as A; returns how many, or -1: out of memory. */
static int32_t rigid_motions(sorter *self, double *motion) {
  strut_potential *rows;
  if (strut_potential_create(self->model, NULL, false, &self->scratch, &rows, NULL)) return -1;
  return strut_rigid_motions(rows, self->q, NULL, motion);
}

static strut_status follow(sorter *self, strut_mechanism *mechanism) {
  finite_walk walk;
  strut_status status = walk_finite_motion(self->model, self->q, mechanism->motion, &walk);
  mechanism->moved = walk.moved, mechanism->strain = walk.strain;
  if (walk.arrived) mechanism->kind = STRUT_MOTION_FINITE;
  return status;
}

/* Of two motions one state of self-stress stiffens some combinations and drives others: between
   them lie two that it leaves alone, which may be the ways of a linkage that lies flat. */
static strut_status try_between(sorter *self, strut_mechanism *two) {
  double *x = self->inner + (self->n - 2) * self->rows, *y = x + self->rows;
  double scale = set_density(self, self->states->force);
  double a = strut_stress_form(self->model, self->a, self->density, x, x);
  double b = strut_stress_form(self->model, self->a, self->density, x, y);
  double c = strut_stress_form(self->model, self->a, self->density, y, y), root = b * b - a * c;
  if (!(root > ROUNDING * scale * scale)) return STRUT_OK;
  double *way = strut_arena_allocate(self->arena, 2 * self->rows, sizeof *way);
  if (!way) return STRUT_NO_MEMORY;
  for (int k = 0; k < 2; k++) { /* a u^2 + 2 b u v + c v^2 = 0, without cancellation */
    double t = b + (b >= 0 ? sqrt(root) : -sqrt(root));
    double u = k == 0 ? -t : c, v = k == 0 ? a : -t, norm = hypot(u, v);
    for (size_t i = 0; i < self->rows; i++)
      way[(size_t)k * self->rows + i] = (u * x[i] + v * y[i]) / norm;
    two[k].motion = way + (size_t)k * self->rows;
    strut_status status = follow(self, &two[k]);
    if (status != STRUT_OK) return status;
  }
  return STRUT_OK;
}

/* Nothing stiffens them all: those without any form are walked along. */
static strut_status try_to_walk(sorter *self, strut_mechanism *list) {
  size_t silent = 0;
  if (!separate(self, &silent)) return STRUT_NO_MEMORY;
  bool judged = self->states->count == 0 || self->forms; /* else silence says nothing */
  for (size_t i = 0; i < self->n; i++) {
    list[i].kind = STRUT_MOTION_UNDECIDED;
    if (judged && i >= silent) continue;
    /* without self-stress members are independent, and every mechanism is a finite one */
    if (self->states->count == 0) list[i].kind = STRUT_MOTION_FINITE;
    if (i >= MOST_MOTIONS) continue;
    strut_status status = follow(self, &list[i]);
    if (status != STRUT_OK) return status;
  }
  bool pair = judged && self->states->count == 1 && self->n - silent == 2;
  return pair ? try_between(self, list + silent) : STRUT_OK;
}

static strut_mechanism blank(strut_motion_kind kind, const double *motion) {
  const double none = (double)NAN;
  return (strut_mechanism){.kind = kind,
                           .motion = motion,
                           .stiffness = none,
                           .stress_form = none,
                           .moved = none,
                           .strain = none};
}

static strut_status judge(sorter *self, const double *force, strut_mechanisms *mechanisms,
                          strut_mechanism *list) {
  for (size_t i = 0; i < self->n; i++)
    list[i] = blank(STRUT_MOTION_UNDECIDED, self->inner + i * self->rows);
  if (force && self->n <= MOST_MOTIONS) {
    double size = form_of(self, force, self->form);
    if (!rotate(self, self->form)) return STRUT_NO_MEMORY;
    mechanisms->by_forces = self->value[0] > ROUNDING * size;
  }
  if (!compare_states(self)) return STRUT_NO_MEMORY;
  strut_status status = find_stiffener(self, mechanisms);
  if (status != STRUT_OK) return status;
  if (mechanisms->stiffener && !force) { /* its own principal motions are the ones to show */
    form_of(self, mechanisms->stiffener, self->form);
    if (!rotate(self, self->form)) return STRUT_NO_MEMORY;
  }
  if (mechanisms->by_forces || mechanisms->stiffener) {
    for (size_t i = 0; i < self->n; i++) list[i].kind = STRUT_MOTION_INFINITESIMAL;
    return STRUT_OK;
  }
  return try_to_walk(self, list);
}

static double form_along(sorter *self, const double *force, const double *motion) {
  set_density(self, force);
  return strut_stress_form(self->model, self->a, self->density, motion, motion);
}

static void measure_and_count(sorter *self, const double *force, strut_mechanisms *mechanisms) {
  int32_t *count[] = {&mechanisms->rigid_body, &mechanisms->infinitesimal, &mechanisms->finite,
                      &mechanisms->undecided};
  for (int32_t i = 0; i < mechanisms->count; i++) {
    strut_mechanism *mode = &mechanisms->list[i];
    ++*count[mode->kind];
    if (mode->kind == STRUT_MOTION_RIGID_BODY) continue;
    if (force) mode->stiffness = form_along(self, force, mode->motion);
    if (mechanisms->stiffener)
      mode->stress_form = form_along(self, mechanisms->stiffener, mode->motion);
  }
}

/* Only counts motions where they are too many to list. */
static strut_status only_count(sorter *self, strut_mechanisms *mechanisms) {
  double *rigid = strut_arena_allocate(&self->scratch, 3 * self->rows + 1, sizeof *rigid);
  if (!rigid) return STRUT_NO_MEMORY;
  mechanisms->rigid_body = rigid_motions(self, rigid);
  int32_t others = mechanisms->count - mechanisms->rigid_body;
  if (mechanisms->rigid_body < 0) return STRUT_NO_MEMORY;
  if (self->states->count == 0)
    mechanisms->finite = others;
  else
    mechanisms->undecided = others;
  return STRUT_OK;
}

static bool allocate_sorter(sorter *self, size_t count) {
  size_t room = (count + 3) * self->rows;
  strut_arena *scratch = &self->scratch;
  return STRUT_NUMBERS(self->arena, room, &self->motion) &&
         STRUT_NUMBERS(scratch, room, &self->turned) &&
         STRUT_NUMBERS(scratch, self->members, &self->density) &&
         STRUT_NUMBERS(scratch, count, &self->value) &&
         STRUT_NUMBERS(scratch, count * count, &self->form, &self->vector);
}

static double largest_motion(const sorter *self, const double *motion) {
  double largest = 0.0;
  for (int32_t i = 0; i < self->model->length; i += 2) {
    int32_t x = self->a->row_of[i], y = self->a->row_of[i + 1];
    largest = fmax(largest, hypot(x < 0 ? 0.0 : motion[x], y < 0 ? 0.0 : motion[y]));
  }
  return largest;
}

static strut_status sort(sorter *self, const strut_null_spaces *spaces, const double *force,
                         strut_mechanisms *mechanisms) {
  size_t count = (size_t)mechanisms->count;
  mechanisms->list = strut_arena_allocate(self->arena, count, sizeof *mechanisms->list);
  if (!mechanisms->list || !allocate_sorter(self, count)) return STRUT_NO_MEMORY;
  int32_t found = rigid_motions(self, self->motion);
  if (found < 0) return STRUT_NO_MEMORY;
  size_t rigid = (size_t)found < count ? (size_t)found : count;
  self->n = count - rigid;
  self->inner = self->motion + rigid * self->rows;
  for (size_t i = 0; i < rigid; i++)
    mechanisms->list[i] = blank(STRUT_MOTION_RIGID_BODY, self->motion + i * self->rows);
  collect(self, spaces->motion, count, rigid);
  strut_status status =
      self->n > 0 ? judge(self, force, mechanisms, mechanisms->list + rigid) : STRUT_OK;
  if (status == STRUT_OK) measure_and_count(self, force, mechanisms);
  for (size_t i = 0; i < count; i++)
    mechanisms->list[i].largest = largest_motion(self, mechanisms->list[i].motion);
  return status;
}

strut_status strut_mechanisms_find(const strut_model *model, const double *positions,
                                   const double *force, strut_rigidity *rigidity) {
  rigidity->mechanisms = (strut_mechanisms){.count = rigidity->spaces.motions};
  if (rigidity->spaces.motions == 0) return STRUT_OK;
  sorter s = {.model = model,
              .a = &rigidity->matrix,
              .q = positions,
              .states = &rigidity->states,
              .arena = &rigidity->arena};
  s.rows = (size_t)rigidity->matrix.rows, s.members = (size_t)rigidity->matrix.columns;
  strut_status status = rigidity->spaces.motion
                            ? sort(&s, &rigidity->spaces, force, &rigidity->mechanisms)
                            : only_count(&s, &rigidity->mechanisms);
  strut_arena_free(&s.scratch);
  return status;
}
