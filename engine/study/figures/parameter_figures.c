/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of a fit. */
#include <math.h>
#include <string.h>

#include "engine/output/draw/figure.h"
#include "engine/study/fit/fit.h"

/* Residuals within so many standard deviations are usual. */
static const double USUAL = 2.0;

enum { CURVE = 41 }; /* points of a parabola */

static strut_axis axis_of_match(const strut_fit_match *match) {
  if (match->kind == STRUT_FIT_MOTION) return strut_axis_of("time", "s");
  if (match->kind == STRUT_FIT_CURVE) return strut_axis_of("displacement", "m");
  return strut_axis_of("number", "");
}

/* Number i of a match over its time or displacement, or over i. */
static void add_number(strut_figure *figure, strut_series *to, const strut_fit_number *number,
                       size_t i, double value) {
  strut_add_point(figure, to, isnan(number->at) ? (double)i + 1.0 : number->at, value);
}

/* Numbers as dots, and the model as a line, a panel for each series. */
static void add_data(strut_figure *figure, const strut_fit_result *result,
                     const strut_fit_match *match, const strut_fit_series *of) {
  const strut_fit_number *number = result->numbers + of->first;
  strut_panel *panel = strut_add_panel(figure);
  panel->x = axis_of_match(match);
  panel->y = strut_axis_in(of->of, of->unit, (strut_file_unit){0});
  if (result->fit->match_count > 1) panel->title = match->name;
  strut_series *dots = strut_add_series(figure, panel, "measured");
  dots->kind = STRUT_SERIES_DOTS, dots->look = 1;
  for (size_t i = 0; i < match->count; i++)
    if (!isnan(number[i].measured)) add_number(figure, dots, &number[i], i, number[i].measured);
  strut_series *line = strut_add_series(figure, panel, "model");
  line->look = 0;
  line->unmarked = true;
  for (size_t i = 0; i < match->count; i++)
    add_number(figure, line, &number[i], i, number[i].predicted);
}

/* Residuals of a match, all of whose series are in one panel. */
static void add_residuals(strut_figure *figure, const strut_fit_result *result,
                          const strut_fit_match *match) {
  bool known = match->noise > 0.0;
  double unit = known ? 1.0 : 1.0 / result->scale;
  strut_panel *panel = strut_add_panel(figure);
  panel->x = axis_of_match(match);
  panel->y = strut_axis_of(known ? "residual over noise" : "residual over its deviation", "");
  if (result->fit->match_count > 1) panel->title = match->name;
  for (size_t s = 0; s < match->series_count; s++) {
    const strut_fit_number *number = result->numbers + match->series[s].first;
    if (!match->series[s].column) continue;
    strut_series *dots = strut_add_series(figure, panel, match->series[s].of);
    dots->kind = STRUT_SERIES_DOTS;
    for (size_t i = 0; i < match->count; i++)
      if (!isnan(number[i].measured))
        add_number(figure, dots, &number[i], i, number[i].residual * unit);
  }
  strut_add_band(figure, panel, -USUAL, USUAL, "95 % of the usual ones")->level = true;
}

/* The least sum over a parameter: its ends, and the parabola of the standard error. */
static void add_profile(strut_figure *figure, const strut_fit_result *result, size_t k) {
  size_t own = result->aligned_count + k;
  const strut_fit_estimate *e = &result->estimates[own];
  const strut_fit_row *ends = &result->ends[2 * k];
  double best = result->starts[result->best].sum, variance = result->scale * result->scale;
  strut_panel *panel = strut_add_panel(figure);
  panel->x = strut_axis_in(e->name, e->unit, result->fit->variables[k].shown);
  panel->y = strut_axis_of("rise of chi-square", "");
  strut_series *line = strut_add_series(figure, panel, "by the standard error");
  line->look = 1, line->unmarked = true;
  for (int i = 0; i < CURVE && isfinite(e->error); i++) {
    double z = 5.0 * i / (CURVE - 1.0) - 2.5;
    strut_add_point(figure, line, e->value + z * e->error, z * z);
  }
  for (int side = 0; side < 2; side++) {
    double way = ends[side].values[own] - e->value, rise = (ends[side].sum - best) / variance;
    strut_series *profile = strut_add_series(figure, panel, "through the ends of the profile");
    profile->look = 0, profile->unmarked = true;
    for (int i = 0; i < CURVE && isfinite(rise); i++) {
      double part = i / (CURVE - 1.0);
      strut_add_point(figure, profile, e->value + part * way, part * part * rise);
    }
    if (isfinite(rise))
      strut_add_mark(figure, panel, ends[side].values[own], rise, NULL)->dot = true;
  }
}

strut_status strut_fit_figures(const strut_fit_result *result, const char *directory,
                               strut_error *error) {
  static const char *const names[] = {"fit", "residuals", "profiles"};
  strut_figure figures[3];
  strut_status status = STRUT_OK;
  if (!result->found) return STRUT_OK;
  for (int i = 0; i < 3; i++)
    figures[i] = (strut_figure){.title = result->plan->study->name,
                                .columns = 2,
                                .least_width = 200.0,
                                .one_legend = i != 1};
  for (size_t m = 0; m < result->fit->match_count; m++) {
    const strut_fit_match *match = &result->fit->matches[m];
    for (size_t s = 0; s < match->series_count; s++)
      if (match->series[s].column) add_data(&figures[0], result, match, &match->series[s]);
    add_residuals(&figures[1], result, match);
  }
  for (size_t k = 0; k < result->variable_count; k++) add_profile(&figures[2], result, k);
  strut_add_key(&figures[2], STRUT_KEY_DOT, (strut_pen){.colour = strut_grey(0.1), .width = 0.6},
                "end of the 95 % interval");
  for (int i = 0; i < 3; i++) { /* all, whatever happens to one */
    const strut_plot plot = {
        .path = strut_figure_text(&figures[i], "%s/%s.svg", directory, names[i]),
        .texts = result->plan->texts};
    strut_status drawn = strut_figure_draw(&plot, &figures[i], status ? NULL : error);
    if (!status) status = drawn;
  }
  return status;
}
