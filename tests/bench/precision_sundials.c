/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * SUNDIALS' CVODE and ARKODE in the work-precision tables, set up as their manuals advise:
 * - Adams by fixed-point iteration; BDF and DIRK by Newton's method with a dense Jacobian by differences up to
 *   MOST_DENSE unknowns, above by GMRES; BDF with the detection of its stability limit, for oscillations;
 * - absolute tolerances, in units of the motion's displacement and speed; implicit methods on stiff scenes with looser
 *   ones for velocities; no limit on the number of steps, and many tries at a jump of the forces;
 * - with roots, a restart at each.
 */
#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunlinsol/sunlinsol_spgmr.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "tests/bench/precision.h"
#include "tests/bench/scenes.h"

enum { ADAMS, BDF, ERK5, ERK6, ERK8, DIRK4, DIRK5 };
enum { MOST_DENSE = 200, MOST_TEST_FAILS = 100 };

typedef struct solver {
  precision_problem *problem;
  const precision_method *method;
  int kind;
  void *memory;
  SUNContext context;
  N_Vector y, tolerance;
  SUNMatrix matrix;
  SUNLinearSolver linear;
  SUNNonlinearSolver iteration;
} solver;

static int rate(realtype t, N_Vector y, N_Vector dydt, void *problem) {
  return precision_rate(problem, t, N_VGetArrayPointer(y), N_VGetArrayPointer(dydt)) ? 0 : -1;
}

static int roots(realtype t, N_Vector y, realtype *value, void *problem) {
  precision_roots(problem, t, N_VGetArrayPointer(y), value);
  return 0;
}

static void be_silent(int code, const char *module, const char *function, char *message,
                      void *data) {
  (void)code, (void)module, (void)function, (void)message, (void)data;
}

static bool is_cvode(const solver *s) { return s->kind <= BDF; }
static bool is_erk(const solver *s) { return s->kind >= ERK5 && s->kind <= ERK8; }

static void create_linear(solver *s) {
  int n = 2 * s->problem->n;
  if (n <= MOST_DENSE) {
    s->matrix = SUNDenseMatrix(n, n, s->context);
    s->linear = SUNLinSol_Dense(s->y, s->matrix, s->context);
  } else {
    s->linear = SUNLinSol_SPGMR(s->y, SUN_PREC_NONE, 0, s->context);
  }
}

static void create_cvode(solver *s, double longest) {
  s->memory = CVodeCreate(s->kind == ADAMS ? CV_ADAMS : CV_BDF, s->context);
  CVodeInit(s->memory, rate, 0.0, s->y);
  CVodeSVtolerances(s->memory, 0.0, s->tolerance);
  CVodeSetUserData(s->memory, s->problem);
  CVodeSetErrHandlerFn(s->memory, be_silent, NULL);
  CVodeSetMaxNumSteps(s->memory, -1);
  CVodeSetMaxErrTestFails(s->memory, MOST_TEST_FAILS);
  CVodeSetMaxStep(s->memory, longest);
  if (s->kind == ADAMS) {
    s->iteration = SUNNonlinSol_FixedPoint(s->y, 0, s->context);
    CVodeSetNonlinearSolver(s->memory, s->iteration);
  } else {
    create_linear(s);
    CVodeSetLinearSolver(s->memory, s->linear, s->matrix);
    CVodeSetStabLimDet(s->memory, SUNTRUE);
  }
  if (s->method->roots) CVodeRootInit(s->memory, s->problem->roots, roots);
}

static void create_erk(solver *s, double longest) {
  static const ARKODE_ERKTableID tables[] = {ARKODE_DORMAND_PRINCE_7_4_5, ARKODE_VERNER_8_5_6,
                                             ARKODE_FEHLBERG_13_7_8};
  s->memory = ERKStepCreate(rate, 0.0, s->y, s->context);
  ERKStepSVtolerances(s->memory, 0.0, s->tolerance);
  ERKStepSetUserData(s->memory, s->problem);
  ERKStepSetErrHandlerFn(s->memory, be_silent, NULL);
  ERKStepSetTableNum(s->memory, tables[s->kind - ERK5]);
  ERKStepSetMaxNumSteps(s->memory, -1);
  ERKStepSetMaxErrTestFails(s->memory, MOST_TEST_FAILS);
  ERKStepSetMaxStep(s->memory, longest);
  if (s->method->roots) ERKStepRootInit(s->memory, s->problem->roots, roots);
}

static void create_dirk(solver *s, double longest) {
  s->memory = ARKStepCreate(NULL, rate, 0.0, s->y, s->context);
  ARKStepSVtolerances(s->memory, 0.0, s->tolerance);
  ARKStepSetUserData(s->memory, s->problem);
  ARKStepSetErrHandlerFn(s->memory, be_silent, NULL);
  ARKStepSetTableNum(s->memory,
                     s->kind == DIRK4 ? ARKODE_ESDIRK437L2SA_7_3_4 : ARKODE_ESDIRK547L2SA2_7_4_5,
                     ARKODE_ERK_NONE);
  ARKStepSetMaxNumSteps(s->memory, -1);
  ARKStepSetMaxErrTestFails(s->memory, MOST_TEST_FAILS);
  ARKStepSetMaxStep(s->memory, longest);
  create_linear(s);
  ARKStepSetLinearSolver(s->memory, s->linear, s->matrix);
}

static void create(solver *s, double setting) {
  const precision_problem *p = s->problem;
  bool loose = s->method->implicit && p->scene->loose > 0;
  SUNContext_Create(NULL, &s->context);
  s->y = N_VNew_Serial(2 * p->n, s->context);
  s->tolerance = N_VNew_Serial(2 * p->n, s->context);
  double *tolerance = N_VGetArrayPointer(s->tolerance);
  for (int i = 0; i < p->n; i++) {
    tolerance[i] = setting * p->reach;
    tolerance[p->n + i] = setting * p->speed * (loose ? p->scene->loose : 1.0);
  }
  precision_start(s->problem, N_VGetArrayPointer(s->y));
  double longest = p->end / (double)p->parts / 5;
  if (is_cvode(s))
    create_cvode(s, longest);
  else if (is_erk(s))
    create_erk(s, longest);
  else
    create_dirk(s, longest);
}

static void destroy(solver *s) {
  if (is_cvode(s))
    CVodeFree(&s->memory);
  else if (is_erk(s))
    ERKStepFree(&s->memory);
  else
    ARKStepFree(&s->memory);
  if (s->linear) SUNLinSolFree(s->linear);
  if (s->matrix) SUNMatDestroy(s->matrix);
  if (s->iteration) SUNNonlinSolFree(s->iteration);
  N_VDestroy(s->y);
  N_VDestroy(s->tolerance);
  SUNContext_Free(&s->context);
}

static void restart(solver *s, double t) {
  if (is_cvode(s))
    CVodeReInit(s->memory, t, s->y);
  else if (is_erk(s))
    ERKStepReset(s->memory, t, s->y);
  else
    ARKStepReset(s->memory, t, s->y);
}

static void stop_at(solver *s, double to) {
  if (is_cvode(s))
    CVodeSetStopTime(s->memory, to);
  else if (is_erk(s))
    ERKStepSetStopTime(s->memory, to);
  else
    ARKStepSetStopTime(s->memory, to);
}

/* One step, or with `whole` up to the stop time or a root. */
static int advance(solver *s, double to, double *t, bool whole) {
  if (is_cvode(s)) return CVode(s->memory, to, s->y, t, whole ? CV_NORMAL : CV_ONE_STEP);
  int mode = whole ? ARK_NORMAL : ARK_ONE_STEP;
  if (is_erk(s)) return ERKStepEvolve(s->memory, to, s->y, t, mode);
  return ARKStepEvolve(s->memory, to, s->y, t, mode);
}

static bool integrate(solver *s, double *t, double to) {
  bool whole = !(s->problem->model->terms & STRUT_TERM_MEMORY);
  int flag = 0;
  if (*t < to) stop_at(s, to);
  while (*t < to && flag >= 0) {
    flag = advance(s, to, t, whole);
    bool jumped = precision_renew(s->problem, *t, N_VGetArrayPointer(s->y));
    if (*t < to && flag >= 0 && (jumped || flag == CV_ROOT_RETURN)) {
      restart(s, *t);
      stop_at(s, to);
    }
  }
  return flag >= 0;
}

static bool solve(precision_problem *p, const precision_method *method, double setting,
                  precision_answer *answer) {
  solver s = {.problem = p, .method = method, .kind = method->variant};
  double t = 0.0, from = 0.0;
  if (method->roots && p->roots == 0) {
    snprintf(answer->note, sizeof answer->note, "no events");
    return false;
  }
  double begin = bench_seconds();
  create(&s, setting);
  double *y = N_VGetArrayPointer(s.y);
  bool good = integrate(&s, &t, p->begin);
  if (good) from = precision_place(p, y);
  good = good && integrate(&s, &t, p->end);
  answer->velocity = good ? (precision_place(p, y) - from) / (p->end - p->begin) : (double)NAN;
  answer->seconds = bench_seconds() - begin;
  answer->evaluations = p->evaluations;
  if (!good && !precision_late) snprintf(answer->note, sizeof answer->note, "failed at %.3g s", t);
  destroy(&s);
  return true;
}

const precision_method precision_sundials_methods[] = {
    {.name = "CVODE Adams", .variant = ADAMS, .solve = solve},
    {.name = "CVODE Adams, roots", .roots = true, .variant = ADAMS, .solve = solve},
    {.name = "CVODE BDF", .implicit = true, .variant = BDF, .solve = solve},
    {.name = "CVODE BDF, roots", .implicit = true, .roots = true, .variant = BDF, .solve = solve},
    {.name = "ARKODE ERK 5", .variant = ERK5, .solve = solve},
    {.name = "ARKODE ERK 5, roots", .roots = true, .variant = ERK5, .solve = solve},
    {.name = "ARKODE ERK 6", .variant = ERK6, .solve = solve},
    {.name = "ARKODE ERK 8", .variant = ERK8, .solve = solve},
    {.name = "ARKODE ERK 8, roots", .roots = true, .variant = ERK8, .solve = solve},
    {.name = "ARKODE DIRK 4", .implicit = true, .variant = DIRK4, .solve = solve},
    {.name = "ARKODE DIRK 5", .implicit = true, .variant = DIRK5, .solve = solve},
    {.name = NULL}};
