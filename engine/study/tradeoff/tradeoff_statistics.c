/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors from values and references; spreads over the operating points; fronts; best bargains. */
#include <math.h>
#include <stdlib.h>

#include "engine/study/tradeoff/tradeoff_parts.h"

static const double levels[STRUT_TRADEOFF_LEVELS] = {0.05, 0.01, 0.005, 0.001};

double strut_tradeoff_level(int i) { return levels[i]; }

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

strut_spread strut_spread_of(const double *values, size_t count, double *scratch) {
  if (count == 0) return (strut_spread){(double)NAN, (double)NAN, (double)NAN};
  for (size_t i = 0; i < count; i++) scratch[i] = values[i];
  qsort(scratch, count, sizeof *scratch, ascending);
  size_t half = count / 2, rank = (9 * count + 9) / 10;
  double median = count % 2 ? scratch[half] : 0.5 * (scratch[half - 1] + scratch[half]);
  return (strut_spread){median, scratch[rank - 1], scratch[count - 1]};
}

static void judge_row(study *s, strut_tradeoff_row *row) {
  strut_tradeoff *r = s->result;
  const strut_model_variant *own = &r->fidelities[0], *f = &r->fidelities[row->fidelity];
  for (size_t p = 0; p < r->point_count; p++) {
    const double *value = row->value + p * r->value_count;
    double error = strut_study_distance(s, p, value, f->value + p * r->value_count);
    double total = strut_study_distance(s, p, value, own->value + p * r->value_count);
    row->error[p] = fmax(error, f->floor[p]);
    row->total[p] = fmax(total, own->floor[p]);
  }
  row->error_spread = strut_spread_of(row->error, r->point_count, s->scratch);
  row->total_spread = strut_spread_of(row->total, r->point_count, s->scratch);
}

static void find_fronts(strut_tradeoff *r) {
  for (size_t i = 0; i < r->row_count; i++) {
    strut_tradeoff_row *a = &r->rows[i];
    a->front = isfinite(a->error_spread.worst);
    for (size_t k = 0; k < r->row_count && a->front; k++) {
      const strut_tradeoff_row *b = &r->rows[k];
      if (b->fidelity != a->fidelity || !isfinite(b->error_spread.worst)) continue;
      bool no_worse =
          b->evaluations <= a->evaluations && b->error_spread.worst <= a->error_spread.worst;
      bool better =
          b->evaluations < a->evaluations || b->error_spread.worst < a->error_spread.worst;
      a->front = !(no_worse && better);
    }
  }
}

void strut_study_judge(study *s) {
  strut_tradeoff *r = s->result;
  for (size_t i = 0; i < r->fidelity_count; i++) {
    strut_model_variant *f = &r->fidelities[i];
    for (size_t p = 0; p < r->point_count && i > 0 && f->run; p++)
      f->model_error[p] = strut_study_distance(s, p, f->value + p * r->value_count,
                                               r->fidelities[0].value + p * r->value_count);
    f->model_spread = strut_spread_of(f->model_error, r->point_count, s->scratch);
    f->floor_spread = strut_spread_of(f->floor, r->point_count, s->scratch);
  }
  for (size_t i = 0; i < r->row_count; i++) judge_row(s, &r->rows[i]);
  find_fronts(r);
}

double strut_study_smallest(const study *s, int fidelity) {
  const strut_tradeoff *r = s->result;
  double smallest = 1;
  for (size_t i = 0; i < r->row_count; i++) {
    double worst = r->rows[i].error_spread.worst;
    if (r->rows[i].fidelity == fidelity && worst > 0 && worst < smallest) smallest = worst;
  }
  return smallest;
}

/* Whether b is a finer setting of the same group, or a itself. */
static bool finer(const strut_tradeoff_row *a, const strut_tradeoff_row *b) {
  if (a->group != b->group) return false;
  return isfinite(a->tolerance) ? b->tolerance <= a->tolerance : b->step <= a->step;
}

double strut_tradeoff_promise(const strut_tradeoff *r, int row) {
  double most = 0;
  for (size_t k = 0; k < r->row_count; k++)
    if (finer(&r->rows[row], &r->rows[k])) most = fmax(most, r->rows[k].total_spread.worst);
  return most;
}

int strut_tradeoff_best(const strut_tradeoff *r, int fidelity, double level) {
  int best = -1;
  for (size_t i = 0; i < r->row_count; i++) {
    const strut_tradeoff_row *row = &r->rows[i];
    if (row->fidelity != fidelity || !(strut_tradeoff_promise(r, (int)i) <= level)) continue;
    if (best < 0 || row->evaluations < r->rows[best].evaluations) best = (int)i;
  }
  return best;
}
