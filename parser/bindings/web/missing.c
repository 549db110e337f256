/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What strut does not have in a browser, refused by name: it stands for the files that use these libraries. And hypot. */
#pragma GCC diagnostic ignored "-Wunused-parameter"

#include <math.h>

#include "engine/output/draw/figure.h"
#include "engine/output/figures/run_figure.h"
#include "engine/output/figures/statics_figures.h"
#include "engine/output/page/page.h"
#include "engine/statics/algebra.h"
#include "engine/study/search/optimisers.h"
#include "parser/program/study/sweep.h"

/* ---- figures, for which Cairo and Pango are too large ---- */

#define NO_FIGURE(NAME, ...)                                                                       \
  strut_status NAME(const strut_plot *plot, __VA_ARGS__, strut_error *error) {                     \
    return strut_fail(error, STRUT_USAGE,                                                          \
                      "strut in a browser draws no figures; use the program strut");               \
  }
NO_FIGURE(strut_equilibria_figure, const strut_model *model, const strut_equilibria *equilibria)
NO_FIGURE(strut_form_figure, const strut_model *model, const double (*drawn)[2])
NO_FIGURE(strut_modes_figure, const strut_model *model, const strut_modes *modes, size_t panels)
NO_FIGURE(strut_waves_figure, const strut_model *model, const strut_waves *waves)
NO_FIGURE(strut_path_figure, const strut_model *model, const strut_path *path)
NO_FIGURE(strut_rigidity_figure, const strut_model *model, const double *positions, const char *at,
          const strut_rigidity *rigidity)
NO_FIGURE(strut_figure_draw, strut_figure *figure)
strut_status strut_run_figure_draw(const strut_run_figure *figure, const strut_model *model,
                                   const strut_trajectory *motion, const strut_summary *summary,
                                   strut_error *error) {
  return strut_figure_draw(NULL, NULL, error);
}

/* ---- pages, sparse algebra, optimisers ---- */

char *strut_page_html(const strut_page *page, strut_page_frames *frames, strut_error *error) {
  strut_fail(error, STRUT_USAGE, "strut in a browser writes no pages; it has the data of a page");
  return NULL;
}

/* Small systems do not come here: rigidity and modes solve them by dense matrices. */
strut_status strut_sparse_algebra_load(const strut_sparse_algebra_library **library,
                                       strut_error *error) {
  *library = NULL;
  return strut_fail(error, STRUT_USAGE,
                    "the structure is too large for strut in a browser, which has neither SPQR nor "
                    "ARPACK; use the program strut");
}

bool strut_search_optimise_by_nlopt(const strut_search_task *task,
                                    const strut_search_asker *asker) {
  return false; /* no call of the library searches */
}

/* ---- studies by file, with their fits and figures: no call of the package computes one ---- */

strut_status strut_sweep_study_try(const strut_arguments *arguments, strut_sweep_study *study,
                                   strut_error *error) {
  return strut_fail(error, STRUT_USAGE,
                    "strut in a browser computes no studies; use the program strut");
}
strut_status strut_study_job_compute(strut_study_job *job) { return STRUT_USAGE; }
void strut_sweep_study_close(strut_sweep_study *study) {}

/* ---- of GLPK the presolver and the dual simplex method, for which linear_program.c does not ask ---- */

#pragma GCC diagnostic ignored "-Wmissing-prototypes"
typedef struct NPP NPP;
typedef struct glp_prob glp_prob;
NPP *_glp_npp_create_wksp(void) { return NULL; }
void _glp_npp_load_prob(NPP *npp, glp_prob *problem, int names, int solution, int scaling) {}
int _glp_npp_simplex(NPP *npp, const void *how) { return 0; }
void _glp_npp_build_prob(NPP *npp, glp_prob *problem) {}
void _glp_npp_postprocess(NPP *npp, glp_prob *problem) {}
void _glp_npp_unload_sol(NPP *npp, glp_prob *problem) {}
void _glp_npp_delete_wksp(NPP *npp) {}
int _glp_spy_dual(glp_prob *problem, const void *how) { return 0; }

/*
 * hypot with the bits of the GNU C library (2.35 and later), which the program has; emscripten's own differs in the
 * last bit, and GSL's decompositions and eigenvalues carry that on.
 *
 * Algorithm: C. F. Borges, An Improved Algorithm for hypot(a, b), arXiv:1904.09481: a root, and one correction.
 */

/* Of a >= b > 0 whose squares neither overflow nor underflow. */
static double corrected(double a, double b) {
  double h = sqrt(a * a + b * b), first, second;
  if (h <= 2.0 * b) {
    double over = h - b;
    first = a * (2.0 * over - a);
    second = (over - 2.0 * (a - b)) * over;
  } else {
    double over = h - a;
    first = 2.0 * over * (a - 2.0 * b);
    second = (4.0 * over - b) * b + over * over;
  }
  return h - (first + second) / (2.0 * h);
}

double hypot(double x, double y) {
  const double half_bit = 0x1p-54, scale = 0x1p-600;
  if (!isfinite(x) || !isfinite(y)) return isinf(x) || isinf(y) ? (double)INFINITY : x + y;
  double a = fmax(fabs(x), fabs(y)), b = fmin(fabs(x), fabs(y));
  if (b <= a * half_bit) return a + b;
  if (a > 0x1p+511) return corrected(a * scale, b * scale) / scale;
  if (b < 0x1p-459) return corrected(a / scale, b / scale) * scale;
  return corrected(a, b);
}
