/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of a fit: what was measured and the model, residuals, profiles. */
#include <math.h>
#include <string.h>

#include "engine/output/draw/figure.h"
#include "engine/study/fit/fit.h"

/* Residuals within so many standard deviations are usual. */
static const double USUAL = 2.0;

enum { CURVE = 41 }; /* points of a parabola */

/* Does a series have numbers that were measured? */
static bool is_measured(const strut_fit_match *match, size_t s) {
  bool some = false;
  for (size_t i = 0; i < match->count; i++) some = some || !isnan(match->series[s].measured[i]);
  return some;
}

static strut_axis axis_of_match(const strut_fit_match *match) {
  if (match->kind == STRUT_FIT_MOTION) return strut_axis_of("time", "s");
  if (match->kind == STRUT_FIT_CURVE) return strut_axis_of("displacement", "m");
  return strut_axis_of("number", "");
}

static double place_of(const strut_fit_match *match, size_t i) {
  return match->at ? match->at[i] : (double)i + 1.0;
}

/* Adds dots where something was measured: these numbers times `unit`. */
static strut_series *add_dots(strut_figure *figure, strut_panel *panel, const char *label,
                              const strut_fit_match *match, size_t s, const double *numbers,
                              double unit) {
  strut_series *dots = strut_add_series(figure, panel, label);
  dots->cloud = true;
  for (size_t i = 0; i < match->count; i++)
    if (!isnan(match->series[s].measured[i]))
      strut_add_point(figure, dots, place_of(match, i), numbers[i] * unit);
  return dots;
}

/* Numbers as dots, and the model as a line, a panel for each series. */
static void add_data(strut_figure *figure, const strut_fit_result *result, size_t m, size_t s) {
  const strut_fit_match *match = &result->fit->matches[m];
  const double *model = result->predicted + strut_fit_first(result->fit, m, s);
  strut_panel *panel = strut_add_panel(figure);
  panel->x = axis_of_match(match);
  panel->y = strut_axis_in(match->series[s].of, match->series[s].unit, (strut_file_unit){0});
  panel->title = match->name;
  add_dots(figure, panel, "measured", match, s, match->series[s].measured, 1.0)->look = 1;
  strut_series *line = strut_add_series(figure, panel, "model");
  line->look = 0;
  line->markers = match->count > 1 ? STRUT_MARKERS_NONE : STRUT_MARKERS_ALL;
  for (size_t i = 0; i < match->count; i++)
    strut_add_point(figure, line, place_of(match, i), model[i]);
}

/* Residuals of a match, all of whose series are in one panel. */
static void add_residuals(strut_figure *figure, const strut_fit_result *result, size_t m) {
  const strut_fit_match *match = &result->fit->matches[m];
  bool known = match->noise > 0.0;
  double unit = known ? 1.0 : 1.0 / result->scale;
  strut_panel *panel = strut_add_panel(figure);
  panel->x = axis_of_match(match);
  panel->y = strut_axis_of(known ? "residual over noise" : "residual over its deviation", "");
  panel->title = match->name;
  for (size_t s = 0; s < match->series_count; s++) {
    const double *residual = result->residual + strut_fit_first(result->fit, m, s);
    if (!is_measured(match, s)) continue;
    add_dots(figure, panel, match->series[s].of, match, s, residual, unit);
  }
  strut_add_band(figure, panel, -USUAL, USUAL, "95 % of the usual ones")->level = true;
}

/* The least sum over a parameter: its ends, and the parabola of the standard error. */
static void add_profile(strut_figure *figure, const strut_fit_result *result, size_t k) {
  const strut_fit_estimate *e = &result->estimates[result->aligned_count + k];
  const strut_fit_row *ends = &result->ends[2 * k];
  double best = result->starts[result->best].sum, variance = result->scale * result->scale;
  strut_panel *panel = strut_add_panel(figure);
  panel->x = strut_axis_in(e->name, e->unit, result->fit->variables[k].shown);
  panel->y = strut_axis_of("rise of chi-square", "");
  strut_series *line = strut_add_series(figure, panel, "by the standard error");
  line->look = 1, line->markers = STRUT_MARKERS_NONE;
  for (int i = 0; i < CURVE && isfinite(e->error); i++) {
    double z = 5.0 * i / (CURVE - 1.0) - 2.5;
    strut_add_point(figure, line, e->value + z * e->error, z * z);
  }
  for (int side = 0; side < 2; side++) {
    double way = ends[side].values[k] - e->value, rise = (ends[side].sum - best) / variance;
    strut_series *profile = strut_add_series(figure, panel, "through the ends of the profile");
    profile->look = 0, profile->markers = STRUT_MARKERS_NONE;
    for (int i = 0; i < CURVE && isfinite(rise); i++) {
      double part = i / (CURVE - 1.0);
      strut_add_point(figure, profile, e->value + part * way, part * part * rise);
    }
    if (isfinite(rise)) strut_add_mark(figure, panel, ends[side].values[k], rise, NULL)->dot = true;
  }
}

/* Draws a figure as directory/name. */
static strut_status draw(strut_figure *figure, const char *directory, const char *name,
                         strut_error *error) {
  const strut_plot plot = {.path = strut_figure_text(figure, "%s/%s", directory, name)};
  return strut_figure_draw(&plot, figure, error);
}

strut_status strut_fit_figures(const strut_fit_result *result, const char *directory,
                               strut_error *error) {
  const char *title = result->plan->study->name;
  const strut_figure empty = {.title = title, .columns = 2, .least_width = 200.0};
  strut_figure data = empty, residuals = empty, profiles = empty;
  if (!result->found) return STRUT_OK;
  for (size_t m = 0; m < result->fit->match_count; m++) {
    for (size_t s = 0; s < result->fit->matches[m].series_count; s++)
      if (is_measured(&result->fit->matches[m], s)) add_data(&data, result, m, s);
    add_residuals(&residuals, result, m);
  }
  for (size_t k = 0; k < result->variable_count; k++) add_profile(&profiles, result, k);
  strut_add_key(&profiles, STRUT_KEY_DOT, (strut_pen){.colour = strut_grey(0.1), .width = 0.6},
                "end of the 95 % interval");
  strut_status status = draw(&data, directory, "fit.svg", error);
  strut_status second = draw(&residuals, directory, "residuals.svg", status ? NULL : error);
  strut_status third = draw(&profiles, directory, "profiles.svg", status || second ? NULL : error);
  return status ? status : second ? second : third;
}
