/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/tradeoff/tradeoff_words.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/quantity_text.h"

const char *strut_study_percent(double error, char text[STRUT_STUDY_WORDS]) {
  if (isnan(error))
    snprintf(text, STRUT_STUDY_WORDS, "-");
  else if (isinf(error))
    snprintf(text, STRUT_STUDY_WORDS, "diverged");
  else if (error >= 10)
    snprintf(text, STRUT_STUDY_WORDS, "%.0e %%", 100 * error);
  else if (error >= 0.0995)
    snprintf(text, STRUT_STUDY_WORDS, "%.0f %%", 100 * error);
  else
    snprintf(text, STRUT_STUDY_WORDS, "%.2g %%", 100 * error);
  return text;
}

const char *strut_study_group(const strut_tradeoff_row *row, char text[STRUT_STUDY_WORDS]) {
  if (!isfinite(row->refine))
    snprintf(text, STRUT_STUDY_WORDS, "%s", row->method->name);
  else if (row->refine > 0)
    snprintf(text, STRUT_STUDY_WORDS, "%s, refined %.3g", row->method->name, row->refine);
  else
    snprintf(text, STRUT_STUDY_WORDS, "%s, refined", row->method->name);
  return text;
}

const char *strut_study_step(const strut_tradeoff_row *row, char text[STRUT_STUDY_WORDS]) {
  if (isfinite(row->tolerance))
    snprintf(text, STRUT_STUDY_WORDS, "%.0e", row->tolerance);
  else
    snprintf(text, STRUT_STUDY_WORDS, "%s", strut_quantity_of(row->step, 3, "s").text);
  return text;
}

const char *strut_study_measure(strut_tradeoff_measure measure) {
  static const char *const names[] = {"", "velocity", "position", "energy"};
  return names[measure];
}

static const char *refined(const strut_tradeoff_row *row, char text[STRUT_STUDY_WORDS]) {
  text[0] = '\0';
  if (isfinite(row->refine) && row->refine > 0)
    snprintf(text, STRUT_STUDY_WORDS, ", steps divided by %.3g after touchdowns", row->refine);
  else if (isfinite(row->refine))
    snprintf(text, STRUT_STUDY_WORDS, ", steps refined after touchdowns as the scene suggests");
  return text;
}

static void advise_level(strut_buffer *text, const strut_tradeoff *r, double level) {
  char a[STRUT_STUDY_WORDS], b[STRUT_STUDY_WORDS], c[STRUT_STUDY_WORDS], d[STRUT_STUDY_WORDS];
  int best = strut_tradeoff_best(r, 0, level);
  strut_buffer_add(text, "  %5s: ", strut_study_percent(level, a));
  if (best < 0) {
    strut_buffer_add(text, "none of these keeps it\n");
    return;
  }
  const strut_tradeoff_row *row = &r->rows[best], *base = &r->rows[r->base];
  strut_buffer_add(text, "%s, %s%s%s: %.2g of the cost of %s, %s", row->method->name,
                   isfinite(row->tolerance) ? "tolerance " : "", strut_study_step(row, a),
                   refined(row, b), row->evaluations, base->method->name,
                   strut_study_step(base, c));
  if (isfinite(row->cpu)) strut_buffer_add(text, " (%.2g of its CPU time)", row->cpu);
  strut_buffer_add(text, "; error at most %s\n",
                   strut_study_percent(strut_tradeoff_promise(r, best), d));
}

/* Whether a fidelity reaches some level cheaper than the scene's own model does, and which. */
static int bargain_of(const strut_tradeoff *r, int fidelity, double *level) {
  for (int i = STRUT_TRADEOFF_LEVELS; i-- > 0;) {
    int own = strut_tradeoff_best(r, 0, strut_tradeoff_level(i));
    int other = strut_tradeoff_best(r, fidelity, strut_tradeoff_level(i));
    *level = strut_tradeoff_level(i);
    if (other >= 0 && (own < 0 || r->rows[other].evaluations < 0.9 * r->rows[own].evaluations))
      return other;
  }
  return -1;
}

static void advise_model(strut_buffer *text, const strut_tradeoff *r, int fidelity) {
  const strut_model_variant *f = &r->fidelities[fidelity];
  char a[STRUT_STUDY_WORDS], b[STRUT_STUDY_WORDS], c[STRUT_STUDY_WORDS];
  if (!f->run) {
    strut_buffer_add(text, "  %s: not run; %s\n", f->name, f->remark);
    return;
  }
  double level = 0, change = f->model_spread.worst;
  int row = bargain_of(r, fidelity, &level);
  strut_buffer_add(text, "  %s: %s the answer by %s", f->name,
                   r->point_count > 1 ? "in the worst case changes" : "changes",
                   strut_study_percent(change, a));
  if (row >= 0) {
    int own = strut_tradeoff_best(r, 0, level);
    strut_buffer_add(text, "; a bargain for %s: %s, %s costs %.2g, ", strut_study_percent(level, a),
                     r->rows[row].method->name, strut_study_step(&r->rows[row], b),
                     r->rows[row].evaluations);
    if (own >= 0)
      strut_buffer_add(text, "the scene's own model %.2g\n", r->rows[own].evaluations);
    else
      strut_buffer_add(text, "the scene's own model does not keep it here\n");
  } else if (change > strut_tradeoff_level(0)) {
    strut_buffer_add(text, ": not a bargain in this scene\n");
  } else {
    strut_buffer_add(text, " (floor %s), and is no cheaper: not a bargain in this scene\n",
                     strut_study_percent(f->floor_spread.worst, c));
  }
}

void strut_study_advise(strut_buffer *text, const strut_tradeoff *r) {
  strut_buffer_add(text,
                   "Advice: the cheapest that keep an error, there and at all finer "
                   "settings that were run\n");
  for (int i = 0; i < STRUT_TRADEOFF_LEVELS; i++) advise_level(text, r, strut_tradeoff_level(i));
  if (r->fidelity_count > 1)
    strut_buffer_add(text, "\nOther models, converged, against the scene's own\n");
  for (size_t i = 1; i < r->fidelity_count; i++) advise_model(text, r, (int)i);
}
