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

static bool allocate_walk(walker *w, const double *q, strut_arena *arena, int32_t rows) {
  size_t length = (size_t)w->model->length;
  size_t members = (size_t)strut_equilibrium_columns(w->model);
  w->start = q;
  w->q = strut_arena_allocate(arena, length, sizeof(double));
  w->before = strut_arena_allocate(arena, length, sizeof(double));
  w->motion = strut_arena_allocate(arena, (size_t)rows + 1, sizeof(double));
  w->step = strut_arena_allocate(arena, (size_t)rows + 1, sizeof(double));
  w->length = strut_arena_allocate(arena, members + 1, sizeof(double));
  w->strain = strut_arena_allocate(arena, members + 1, sizeof(double));
  w->gram = strut_arena_allocate(arena, members * members + 1, sizeof(double));
  if (!w->q || !w->before || !w->motion || !w->step || !w->length || !w->strain || !w->gram)
    return false;
  memcpy(w->q, q, length * sizeof *q);
  return true;
}

static bool build_matrix(walker *w) {
  strut_arena_free(&w->matrix);
  return strut_equilibrium_matrix_build(w->model, w->q, &w->matrix, &w->a) == STRUT_OK;
}

/* x (members) = (A' A + damping)^-1 x, by Cholesky; false where rounding spoils it. */
static bool solve_gram(walker *w, double *x) {
  const strut_equilibrium_matrix *a = &w->a;
  size_t n = (size_t)a->columns;
  if (n == 0) return true;
  for (int32_t j = 0; j < a->columns; j++) {
    memset(w->step, 0, (size_t)a->rows * sizeof *w->step);
    for (int32_t k = a->start[j]; k < a->start[j + 1]; k++) w->step[a->row[k]] = a->value[k];
    strut_equilibrium_elongate(a, w->step, w->gram + (size_t)j * n);
    w->gram[(size_t)j * n + (size_t)j] += DAMPING;
  }
  gsl_matrix_view gram = gsl_matrix_view_array(w->gram, n, n);
  gsl_vector_view view = gsl_vector_view_array(x, n);
  if (gsl_linalg_cholesky_decomp1(&gram.matrix) != 0) return false;
  return gsl_linalg_cholesky_svx(&gram.matrix, &view.vector) == 0;
}

static double largest_strain(const walker *w) {
  double largest = 0.0;
  for (int32_t j = w->a.members; j < w->a.columns; j++) /* change of an angle */
    largest = fmax(largest, fabs(w->a.length[j] - w->length[j]) / w->a.size);
  for (int32_t j = 0; j < w->a.members; j++)
    if (w->length[j] > 0)
      largest = fmax(largest, fabs(w->a.length[j] - w->length[j]) / w->length[j]);
    else
      largest = fmax(largest, w->a.length[j] / w->model->size);
  return largest;
}

/* Back to the lengths by the least displacement that does it. */
static bool correct(walker *w, double *strain) {
  for (int i = 0; i < MOST_CORRECTIONS; i++) {
    if (!build_matrix(w)) return false;
    *strain = largest_strain(w);
    if (*strain <= KEPT) return true;
    for (int32_t j = 0; j < w->a.columns; j++) w->strain[j] = w->length[j] - w->a.length[j];
    if (!solve_gram(w, w->strain)) return false;
    strut_equilibrium_multiply(&w->a, w->strain, w->step);
    for (int32_t r = 0; r < w->a.rows; r++) w->q[w->a.coordinate[r]] += w->step[r];
  }
  return false;
}

/* The motion at hand without what stretches members here; largest entry 1. */
static bool straighten(walker *w) {
  strut_equilibrium_elongate(&w->a, w->motion, w->strain);
  if (!solve_gram(w, w->strain)) return false;
  strut_equilibrium_multiply(&w->a, w->strain, w->step);
  double largest = 0.0;
  for (int32_t r = 0; r < w->a.rows; r++) {
    w->motion[r] -= w->step[r];
    largest = fmax(largest, fabs(w->motion[r]));
  }
  for (int32_t r = 0; r < w->a.rows; r++) w->motion[r] /= largest;
  return largest > 0.1;
}

static bool stride(walker *w, double stride_length, double *strain) {
  double gone = 0.0;
  memcpy(w->before, w->q, (size_t)w->model->length * sizeof *w->q);
  for (int32_t r = 0; r < w->a.rows; r++) w->q[w->a.coordinate[r]] += stride_length * w->motion[r];
  if (!correct(w, strain)) return false;
  for (int32_t r = 0; r < w->a.rows; r++) {
    int32_t at = w->a.coordinate[r];
    w->motion[r] = w->q[at] - w->before[at];
    gone = fmax(gone, fabs(w->motion[r]));
  }
  for (int32_t r = 0; r < w->a.rows; r++) w->motion[r] /= gone > 0 ? gone : 1.0;
  return gone >= PROGRESS * stride_length;
}

/* Largest change of the distance between two nodes: zero for rigid motions. */
static double change_of_shape(const walker *w) {
  double largest = 0.0;
  for (int32_t i = 0; i < w->model->node_count; i++)
    for (int32_t k = 0; k < i; k++) {
      const double *p = w->q, *s = w->start;
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
static strut_status walk_finite_motion(const strut_model *model, const double *q,
                                       const double *motion, finite_walk *walk) {
  *walk = (finite_walk){.moved = (double)NAN, .strain = (double)NAN};
  if (strut_equilibrium_columns(model) > WALK_MEMBERS) return STRUT_OK;
  strut_arena scratch = {0};
  walker w = {.model = model};
  strut_status status = STRUT_NO_MEMORY;
  strut_equilibrium_matrix first;
  if (strut_equilibrium_matrix_build(model, q, &scratch, &first) == STRUT_OK &&
      allocate_walk(&w, q, &scratch, first.rows) && build_matrix(&w)) {
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
static void collect(sorter *s, const double *space, size_t count, size_t rigid) {
  double *rest = s->turned;
  memcpy(rest, space, count * s->rows * sizeof *rest);
  for (size_t i = 0; i < count; i++)
    strut_remove_shares(s->motion, rigid, s->rows, rest + i * s->rows);
  for (size_t k = 0; k < s->n; k++) {
    double best = -1.0, *chosen = s->inner + k * s->rows;
    for (size_t i = 0; i < count; i++) {
      double left = strut_dot(rest + i * s->rows, rest + i * s->rows, (ptrdiff_t)s->rows);
      if (left <= best * 1.0001) continue;
      best = left;
      memcpy(chosen, rest + i * s->rows, s->rows * sizeof *rest);
    }
    double norm = sqrt(strut_remove_shares(s->motion, rigid + k, s->rows, chosen));
    for (size_t c = 0; c < s->rows; c++) chosen[c] /= norm;
    for (size_t i = 0; i < count; i++) strut_remove_shares(chosen, 1, s->rows, rest + i * s->rows);
  }
}

/* Fills in the densities of member forces and returns the largest. */
static double set_density(sorter *s, const double *force) {
  double largest = 0.0;
  for (size_t j = 0; j < s->members; j++) {
    s->density[j] = strut_column_density(s->a, (int32_t)j, force[j]);
    largest = fmax(largest, fabs(s->density[j]));
  }
  return largest;
}

/* The form of member forces on the inner motions; returns the largest density, its scale. */
static double form_of(sorter *s, const double *force, double *form) {
  double scale = set_density(s, force);
  strut_stress_form_on(s->model, s->a, s->density, s->inner, (int32_t)s->n, form);
  return scale;
}

/* Replaces the inner motions by the combinations that diagonalise a form, which it overwrites. */
static bool rotate(sorter *s, double *form) {
  if (!strut_symmetric_eigen(form, s->n, s->value, s->vector)) return false;
  memset(s->turned, 0, s->n * s->rows * sizeof *s->turned);
  for (size_t i = 0; i < s->n; i++)
    for (size_t k = 0; k < s->n; k++)
      for (size_t c = 0; c < s->rows; c++)
        s->turned[i * s->rows + c] += s->vector[i * s->n + k] * s->inner[k * s->rows + c];
  memcpy(s->inner, s->turned, s->n * s->rows * sizeof *s->turned);
  return true;
}

static bool compare_states(sorter *s) {
  size_t square = s->n * s->n, count = (size_t)s->states->count;
  if (!s->states->force || count > MOST_STATES || s->n > MOST_MOTIONS) return true;
  s->forms = strut_arena_allocate(&s->scratch, count * square + 1, sizeof *s->forms);
  s->scale = strut_arena_allocate(&s->scratch, count + 1, sizeof *s->scale);
  if (!s->forms || !s->scale) return false;
  for (size_t i = 0; i < count; i++)
    s->scale[i] = form_of(s, s->states->force + i * s->members, s->forms + i * square);
  return true;
}

/* A state of self-stress that is positive on all inner motions, with cables pulled if it can. */
static strut_status find_stiffener(sorter *s, strut_mechanisms *m) {
  double *force = strut_arena_allocate(s->arena, s->members + 1, sizeof *force);
  if (!force) return STRUT_NO_MEMORY;
  for (int cables = 1; cables >= 0 && s->forms; cables--) {
    strut_stress_wish wish = {
        .cables = cables, .motions = (int32_t)s->n, .forms = s->forms, .scale = s->scale};
    bool found = false;
    strut_status status = strut_self_stress_combine(s->model, s->states, &wish, force, &found);
    if (status != STRUT_OK) return status;
    if (!found) continue;
    m->stiffener = force;
    m->stiffener_pulls = cables;
    return STRUT_OK;
  }
  return STRUT_OK;
}

/* Sorts motions that no state of self-stress affects first, by the sum of squared forms. */
static bool separate(sorter *s, size_t *silent) {
  size_t n = s->n, count = s->forms ? (size_t)s->states->count : 0;
  memset(s->form, 0, n * n * sizeof *s->form);
  for (size_t i = 0; i < count; i++) {
    const double *f = s->forms + i * n * n;
    double size = s->scale[i];
    for (size_t r = 0; r < n && size > 0; r++)
      for (size_t c = 0; c < n; c++)
        s->form[r * n + c] += strut_dot(f + r * n, f + c * n, (ptrdiff_t)n) / (size * size);
  }
  if (!rotate(s, s->form)) return false;
  *silent = 0;
  while (*silent < n && s->value[*silent] <= ROUNDING * ROUNDING) (*silent)++;
  return true;
}

/* The rigid-body motions over the same rows as A; returns how many, or -1: out of memory. */
static int32_t rigid_motions(const sorter *s, double *motion) {
  strut_potential *rows = NULL;
  if (strut_potential_create(s->model, NULL, false, &rows, NULL) != STRUT_OK) return -1;
  int32_t count = strut_rigid_motions(rows, s->q, NULL, motion);
  strut_potential_free(rows);
  return count;
}

static strut_status follow(sorter *s, strut_mechanism *m) {
  finite_walk walk;
  strut_status status = walk_finite_motion(s->model, s->q, m->motion, &walk);
  m->moved = walk.moved, m->strain = walk.strain;
  if (walk.arrived) m->kind = STRUT_MOTION_FINITE;
  return status;
}

/* Of two motions one state of self-stress stiffens some combinations and drives others: between
   them lie two that it leaves alone, which may be the ways of a linkage that lies flat. */
static strut_status try_between(sorter *s, strut_mechanism *two) {
  double *x = s->inner + (s->n - 2) * s->rows, *y = x + s->rows;
  double scale = set_density(s, s->states->force);
  double a = strut_stress_form(s->model, s->a, s->density, x, x);
  double b = strut_stress_form(s->model, s->a, s->density, x, y);
  double c = strut_stress_form(s->model, s->a, s->density, y, y), root = b * b - a * c;
  if (!(root > ROUNDING * scale * scale)) return STRUT_OK;
  double *way = strut_arena_allocate(s->arena, 2 * s->rows, sizeof *way);
  if (!way) return STRUT_NO_MEMORY;
  for (int k = 0; k < 2; k++) { /* a u^2 + 2 b u v + c v^2 = 0, without cancellation */
    double t = b + (b >= 0 ? sqrt(root) : -sqrt(root));
    double u = k == 0 ? -t : c, v = k == 0 ? a : -t, norm = hypot(u, v);
    for (size_t i = 0; i < s->rows; i++)
      way[(size_t)k * s->rows + i] = (u * x[i] + v * y[i]) / norm;
    two[k].motion = way + (size_t)k * s->rows;
    strut_status status = follow(s, &two[k]);
    if (status != STRUT_OK) return status;
  }
  return STRUT_OK;
}

/* Nothing stiffens them all: those without any form are walked along. */
static strut_status try_to_walk(sorter *s, strut_mechanism *list) {
  size_t silent = 0;
  if (!separate(s, &silent)) return STRUT_NO_MEMORY;
  bool judged = s->states->count == 0 || s->forms; /* else silence says nothing */
  for (size_t i = 0; i < s->n; i++) {
    list[i].kind = STRUT_MOTION_UNDECIDED;
    if (judged && i >= silent) continue;
    /* without self-stress members are independent, and every mechanism is a finite one */
    if (s->states->count == 0) list[i].kind = STRUT_MOTION_FINITE;
    if (i >= MOST_MOTIONS) continue;
    strut_status status = follow(s, &list[i]);
    if (status != STRUT_OK) return status;
  }
  bool pair = judged && s->states->count == 1 && s->n - silent == 2;
  return pair ? try_between(s, list + silent) : STRUT_OK;
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

static strut_status judge(sorter *s, const double *force, strut_mechanisms *m,
                          strut_mechanism *list) {
  for (size_t i = 0; i < s->n; i++) list[i] = blank(STRUT_MOTION_UNDECIDED, s->inner + i * s->rows);
  if (force && s->n <= MOST_MOTIONS) {
    double size = form_of(s, force, s->form);
    if (!rotate(s, s->form)) return STRUT_NO_MEMORY;
    m->by_forces = s->value[0] > ROUNDING * size;
  }
  if (!compare_states(s)) return STRUT_NO_MEMORY;
  strut_status status = find_stiffener(s, m);
  if (status != STRUT_OK) return status;
  if (m->stiffener && !force) { /* its own principal motions are the ones to show */
    form_of(s, m->stiffener, s->form);
    if (!rotate(s, s->form)) return STRUT_NO_MEMORY;
  }
  if (m->by_forces || m->stiffener) {
    for (size_t i = 0; i < s->n; i++) list[i].kind = STRUT_MOTION_INFINITESIMAL;
    return STRUT_OK;
  }
  return try_to_walk(s, list);
}

static double form_along(sorter *s, const double *force, const double *motion) {
  set_density(s, force);
  return strut_stress_form(s->model, s->a, s->density, motion, motion);
}

static void measure_and_count(sorter *s, const double *force, strut_mechanisms *m) {
  int32_t *count[] = {&m->rigid_body, &m->infinitesimal, &m->finite, &m->undecided};
  for (int32_t i = 0; i < m->count; i++) {
    strut_mechanism *mode = &m->list[i];
    ++*count[mode->kind];
    if (mode->kind == STRUT_MOTION_RIGID_BODY) continue;
    if (force) mode->stiffness = form_along(s, force, mode->motion);
    if (m->stiffener) mode->stress_form = form_along(s, m->stiffener, mode->motion);
  }
}

/* Only counts motions where they are too many to list. */
static strut_status only_count(sorter *s, strut_mechanisms *m) {
  double *rigid = strut_arena_allocate(&s->scratch, 3 * s->rows + 1, sizeof *rigid);
  if (!rigid) return STRUT_NO_MEMORY;
  m->rigid_body = rigid_motions(s, rigid);
  int32_t others = m->count - m->rigid_body;
  if (m->rigid_body < 0) return STRUT_NO_MEMORY;
  if (s->states->count == 0)
    m->finite = others;
  else
    m->undecided = others;
  return STRUT_OK;
}

static bool allocate_sorter(sorter *s, size_t count) {
  size_t square = count * count + 1, room = (count + 3) * s->rows + 1;
  s->motion = strut_arena_allocate(s->arena, room, sizeof(double));
  s->turned = strut_arena_allocate(&s->scratch, room, sizeof(double));
  s->density = strut_arena_allocate(&s->scratch, s->members + 1, sizeof(double));
  s->form = strut_arena_allocate(&s->scratch, square, sizeof(double));
  s->value = strut_arena_allocate(&s->scratch, count + 1, sizeof(double));
  s->vector = strut_arena_allocate(&s->scratch, square, sizeof(double));
  return s->motion && s->turned && s->density && s->form && s->value && s->vector;
}

static double largest_motion(const sorter *s, const double *motion) {
  double largest = 0.0;
  for (int32_t i = 0; i < s->model->length; i += 2) {
    int32_t x = s->a->row_of[i], y = s->a->row_of[i + 1];
    largest = fmax(largest, hypot(x < 0 ? 0.0 : motion[x], y < 0 ? 0.0 : motion[y]));
  }
  return largest;
}

static strut_status sort(sorter *s, const strut_null_spaces *spaces, const double *force,
                         strut_mechanisms *m) {
  size_t count = (size_t)m->count;
  m->list = strut_arena_allocate(s->arena, count, sizeof *m->list);
  if (!m->list || !allocate_sorter(s, count)) return STRUT_NO_MEMORY;
  int32_t found = rigid_motions(s, s->motion);
  if (found < 0) return STRUT_NO_MEMORY;
  size_t rigid = (size_t)found < count ? (size_t)found : count;
  s->n = count - rigid;
  s->inner = s->motion + rigid * s->rows;
  for (size_t i = 0; i < rigid; i++)
    m->list[i] = blank(STRUT_MOTION_RIGID_BODY, s->motion + i * s->rows);
  collect(s, spaces->motion, count, rigid);
  strut_status status = s->n > 0 ? judge(s, force, m, m->list + rigid) : STRUT_OK;
  if (status == STRUT_OK) measure_and_count(s, force, m);
  for (size_t i = 0; i < count; i++) m->list[i].largest = largest_motion(s, m->list[i].motion);
  return status;
}

strut_status strut_mechanisms_find(const strut_model *model, const double *q, const double *force,
                                   strut_rigidity *r) {
  r->mechanisms = (strut_mechanisms){.count = r->spaces.motions};
  if (r->spaces.motions == 0) return STRUT_OK;
  sorter s = {.model = model, .a = &r->matrix, .q = q, .states = &r->states, .arena = &r->arena};
  s.rows = (size_t)r->matrix.rows, s.members = (size_t)r->matrix.columns;
  strut_status status = r->spaces.motion ? sort(&s, &r->spaces, force, &r->mechanisms)
                                         : only_count(&s, &r->mechanisms);
  strut_arena_free(&s.scratch);
  return status;
}
