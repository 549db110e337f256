/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/algebra.h"

#include <assert.h>
#include <glpk.h>
#include <math.h>
#include <setjmp.h>

/* Tried in turn: GLPK's own choice has been seen to call a programme infeasible that is not. */
enum { SCALINGS = 3, LOOK_EVERY = 20 /* ms */ };
static const int scalings[SCALINGS] = {GLP_SF_AUTO, GLP_SF_EQ, 0};

static const double TOLERANCE = 1e-10; /* of bounds and of reduced costs */

bool strut_linear_program_create(strut_linear_program *p, int32_t rows, int32_t columns,
                                 size_t entries, strut_arena *arena) {
  *p = (strut_linear_program){.rows = rows, .columns = columns, .entry_room = entries};
  double **by_row[] = {&p->row_low, &p->row_high}, **by_column[] = {&p->low, &p->high, &p->cost};
  bool good = true;
  for (int i = 0; i < 2; i++) {
    *by_row[i] = strut_arena_allocate(arena, (size_t)rows, sizeof(double));
    good = good && *by_row[i];
  }
  for (int i = 0; i < 3; i++) {
    *by_column[i] = strut_arena_allocate(arena, (size_t)columns, sizeof(double));
    good = good && *by_column[i];
  }
  p->entry_row = strut_arena_allocate(arena, entries, sizeof *p->entry_row);
  p->entry_column = strut_arena_allocate(arena, entries, sizeof *p->entry_column);
  p->entry = strut_arena_allocate(arena, entries, sizeof *p->entry);
  if (!good || !p->entry_row || !p->entry_column || !p->entry) return false;
  for (int32_t j = 0; j < columns; j++) p->high[j] = HUGE_VAL;
  return true;
}

void strut_linear_program_add(strut_linear_program *p, int32_t row, int32_t column, double value) {
  assert(row >= 0 && row < p->rows);
  assert(column >= 0 && column < p->columns);
  if (value == 0) return;
  assert(p->entry_count < p->entry_room);
  p->entry_row[p->entry_count] = row;
  p->entry_column[p->entry_count] = column;
  p->entry[p->entry_count++] = value;
}

static int kind_of(double low, double high) {
  if (low == high) return GLP_FX;
  if (isfinite(low)) return isfinite(high) ? GLP_DB : GLP_LO;
  return isfinite(high) ? GLP_UP : GLP_FR;
}

/* The entries as GLPK wants them, counted from 1. */
typedef struct entries {
  int *row, *column;
  double *value;
} entries;

static bool make_entries(const strut_linear_program *p, entries *e) {
  size_t count = p->entry_count;
  e->row = strut_allocate(count + 1, sizeof *e->row);
  e->column = strut_allocate(count + 1, sizeof *e->column);
  e->value = strut_allocate(count + 1, sizeof *e->value);
  if (!e->row || !e->column || !e->value) return false;
  for (size_t i = 0; i < count; i++) {
    e->row[i + 1] = p->entry_row[i] + 1;
    e->column[i + 1] = p->entry_column[i] + 1;
    e->value[i + 1] = p->entry[i];
  }
  return true;
}

static void free_entries(entries *e) {
  strut_release(e->row);
  strut_release(e->column);
  strut_release(e->value);
}

static strut_linear_program_end end_of(int code, int status) {
  if (code == 0 && status == GLP_OPT) return STRUT_PROGRAM_OPTIMAL;
  if (code == 0 && status == GLP_NOFEAS) return STRUT_PROGRAM_INFEASIBLE;
  if (code == 0 && status == GLP_UNBND) return STRUT_PROGRAM_UNBOUNDED;
  return STRUT_PROGRAM_FAILED;
}

/* From scratch: its code, with the answer in the problem. */
static int run_simplex(glp_prob *problem, int scaling) {
  glp_smcp how;
  glp_init_smcp(&how);
  how.msg_lev = GLP_MSG_ON; /* so that it calls look_up now and then */
  how.out_frq = LOOK_EVERY;
  how.tol_bnd = how.tol_dj = TOLERANCE;
  if (scaling) {
    glp_scale_prob(problem, scaling);
  } else {
    glp_unscale_prob(problem);
  }
  glp_adv_basis(problem, 0);
  return glp_simplex(problem, &how);
}

static void solve(const strut_linear_program *p, const entries *e, double *x, double *sum,
                  strut_linear_program_end *end) {
  glp_prob *problem = glp_create_prob();
  glp_set_obj_dir(problem, GLP_MIN);
  if (p->rows > 0) glp_add_rows(problem, p->rows);
  if (p->columns > 0) glp_add_cols(problem, p->columns);
  for (int32_t i = 0; i < p->rows; i++)
    glp_set_row_bnds(problem, i + 1, kind_of(p->row_low[i], p->row_high[i]), p->row_low[i],
                     p->row_high[i]);
  for (int32_t j = 0; j < p->columns; j++) {
    glp_set_col_bnds(problem, j + 1, kind_of(p->low[j], p->high[j]), p->low[j], p->high[j]);
    glp_set_obj_coef(problem, j + 1, p->cost[j]);
  }
  glp_load_matrix(problem, (int)p->entry_count, e->row, e->column, e->value);
  *end = STRUT_PROGRAM_FAILED;
  for (int i = 0; i < SCALINGS && *end != STRUT_PROGRAM_OPTIMAL; i++) {
    int code = run_simplex(problem, scalings[i]);
    *end = end_of(code, glp_get_status(problem));
  }
  *sum = glp_get_obj_val(problem);
  for (int32_t j = 0; j < p->columns; j++) x[j] = glp_get_col_prim(problem, j + 1);
  glp_delete_prob(problem);
}

typedef struct way_out {
  jmp_buf place;
  const strut_flag *interrupt;
} way_out;

/* GLPK knows no other way out when memory fails than to end the process, or this. */
static void leave(void *out) { longjmp(((way_out *)out)->place, STRUT_NO_MEMORY); }

/* GLPK has something to print, which nobody reads: the moment to look for an interrupt. */
static int look_up(void *context, const char *text) {
  way_out *out = context;
  (void)text;
  if (out->interrupt && *out->interrupt) longjmp(out->place, STRUT_INTERRUPTED);
  return 1;
}

strut_status strut_linear_program_solve(const strut_linear_program *p, double *x, double *sum,
                                        strut_linear_program_end *end) {
  assert(p->entry_count <= p->entry_room);
  way_out out = {.interrupt = p->interrupt};
  entries e = {0};
  if (!make_entries(p, &e) || glp_init_env() > 1) {
    free_entries(&e);
    return STRUT_NO_MEMORY;
  }
  strut_status left = STRUT_OK;
  switch (setjmp(out.place)) { /* once left, all that GLPK has is lost to us */
    case 0: break;
    case STRUT_INTERRUPTED: left = STRUT_INTERRUPTED; break;
    default: left = STRUT_NO_MEMORY;
  }
  if (left) {
    glp_free_env();
    free_entries(&e);
    return left;
  }
  glp_term_out(GLP_ON);
  glp_term_hook(look_up, &out);
  glp_error_hook(leave, &out);
  solve(p, &e, x, sum, end);
  glp_error_hook(NULL, NULL);
  glp_term_hook(NULL, NULL);
  free_entries(&e);
  return STRUT_OK;
}
