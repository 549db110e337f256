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

bool strut_linear_program_create(strut_linear_program *program, int32_t rows, int32_t columns,
                                 size_t entries, strut_arena *arena) {
  *program = (strut_linear_program){.rows = rows, .columns = columns, .entry_room = entries};
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(program->entry_row, entries + 1),
                      STRUT_NEW(program->entry_column, entries + 1)) ||
      !STRUT_NUMBERS(arena, entries + 1, &program->entry) ||
      !STRUT_NUMBERS(arena, rows, &program->row_low, &program->row_high) ||
      !STRUT_NUMBERS(arena, columns, &program->low, &program->high, &program->cost))
    return false;
  for (int32_t j = 0; j < columns; j++) program->high[j] = HUGE_VAL;
  return true;
}

void strut_linear_program_add(strut_linear_program *program, int32_t row, int32_t column,
                              double value) {
  assert(row >= 0 && row < program->rows);
  assert(column >= 0 && column < program->columns);
  if (value == 0) return;
  assert(program->entry_count < program->entry_room);
  size_t at = ++program->entry_count;
  program->entry_row[at] = row + 1, program->entry_column[at] = column + 1;
  program->entry[at] = value;
}

static int kind_of(double low, double high) {
  if (low == high) return GLP_FX;
  if (isfinite(low)) return isfinite(high) ? GLP_DB : GLP_LO;
  return isfinite(high) ? GLP_UP : GLP_FR;
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

static void solve(const strut_linear_program *program, double *vector, double *sum,
                  strut_linear_program_end *end) {
  glp_prob *problem = glp_create_prob();
  glp_set_obj_dir(problem, GLP_MIN);
  if (program->rows > 0) glp_add_rows(problem, program->rows);
  if (program->columns > 0) glp_add_cols(problem, program->columns);
  for (int32_t i = 0; i < program->rows; i++)
    glp_set_row_bnds(problem, i + 1, kind_of(program->row_low[i], program->row_high[i]),
                     program->row_low[i], program->row_high[i]);
  for (int32_t j = 0; j < program->columns; j++) {
    glp_set_col_bnds(problem, j + 1, kind_of(program->low[j], program->high[j]), program->low[j],
                     program->high[j]);
    glp_set_obj_coef(problem, j + 1, program->cost[j]);
  }
  glp_load_matrix(problem, (int)program->entry_count, program->entry_row, program->entry_column,
                  program->entry);
  *end = STRUT_PROGRAM_FAILED;
  for (int i = 0; i < SCALINGS && *end != STRUT_PROGRAM_OPTIMAL; i++) {
    int code = run_simplex(problem, scalings[i]);
    *end = end_of(code, glp_get_status(problem));
  }
  *sum = glp_get_obj_val(problem);
  for (int32_t j = 0; j < program->columns; j++) vector[j] = glp_get_col_prim(problem, j + 1);
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

strut_status strut_linear_program_solve(const strut_linear_program *program, double *vector,
                                        double *sum, strut_linear_program_end *end) {
  assert(program->entry_count <= program->entry_room);
  way_out out = {.interrupt = program->interrupt};
  if (glp_init_env() > 1) return STRUT_NO_MEMORY;
  strut_status left = STRUT_OK;
  switch (setjmp(out.place)) { /* once left, all that GLPK has is lost to us */
    case 0: break;
    case STRUT_INTERRUPTED: left = STRUT_INTERRUPTED; break;
    default: left = STRUT_NO_MEMORY;
  }
  if (left) {
    glp_free_env();
    return left;
  }
  glp_term_out(GLP_ON);
  glp_term_hook(look_up, &out);
  glp_error_hook(leave, &out);
  solve(program, vector, sum, end);
  glp_error_hook(NULL, NULL);
  glp_term_hook(NULL, NULL);
  return STRUT_OK;
}
