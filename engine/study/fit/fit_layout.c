/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the numbers of all matches are in the model, and the numbers of their alignments; which determine most. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/study/fit/fit_parts.h"
#include "engine/study/search/optimisers.h"
#include "engine/study/sweep/sweep.h"

/* The column of numbers of a name, or NULL. */
static const strut_slot_column *find_column(const strut_sweep_plan *plan, const char *name) {
  for (size_t i = plan->axis_columns; i < plan->column_count; i++)
    if (!plan->columns[i].word && strcmp(plan->columns[i].name, name) == 0)
      return &plan->columns[i];
  return NULL;
}

/* The place whose coordinate a quantity is, if it is one, and which. */
static int axis_of(const strut_quantity_definition *quantity, strut_column *place) {
  if (!quantity || quantity->length != 1 ||
      quantity->program[0].operation != STRUT_OPERATION_COLUMN)
    return -1;
  *place = quantity->program[0].column;
  switch ((int)place->kind) {
    case STRUT_COLUMN_NODE_X:
    case STRUT_COLUMN_CENTRE_X: return 0;
    case STRUT_COLUMN_NODE_Y:
    case STRUT_COLUMN_CENTRE_Y: place->kind--; return 1;
    default: return -1;
  }
}

static strut_status refuse(strut_fit_layout *layout, size_t m, size_t s, const char *why,
                           strut_error *error) {
  const strut_fit_match *match = &layout->fit->matches[m];
  strut_sweep_plan *table = &layout->parts[m].table;
  layout->refused.series = &match->series[s];
  if (strut_slot_named(table->columns, table->column_count, match->series[s].of) ==
      table->column_count) { /* it may be misspelt */
    layout->refused.table = *table;
    *table = (strut_sweep_plan){0};
  }
  return strut_fail(error, STRUT_BAD_SCENE, "match '%.60s': '%.80s' %s", match->name,
                    match->series[s].of, why);
}

/* Why a series does not fit the model; NULL: it does. `column`: that of a TABLE, whose numbers may have no unit. */
static const char *find_flaw(const strut_fit_layout *layout, const strut_fit_match *match,
                             const strut_fit_series *series, const strut_setup *setup,
                             const strut_slot_column *column) {
  const char *over = layout->plan->study->path.over, *unit = "N";
  bool curve = match->kind == STRUT_FIT_CURVE, table = match->kind == STRUT_FIT_TABLE;
  if (table && !column) return "is no column of numbers of that computation";
  if (curve && !setup->experiment.stage_count &&
      !(over && strut_coordinate_find(&setup->scene, over) >= 0))
    return "needs the study's 'path' over a coordinate, such as {over: b.y, until: 5 mm} for "
           "displacements up to 5 mm";
  if (table)
    unit = strcmp(series->unit, "1") == 0 ? series->unit : column->unit;
  else if (!curve)
    unit = strut_fit_quantity(&setup->experiment, series->of)->unit;
  return strcmp(unit, series->unit) == 0 ? NULL : "has another unit than its numbers";
}

/* What the series of a match are in the model. */
static strut_status find_sources(strut_fit_layout *layout, size_t m, const strut_setup *setup,
                                 strut_error *error) {
  const strut_fit_match *match = &layout->fit->matches[m];
  bool moves = match->kind == STRUT_FIT_MOTION || match->kind == STRUT_FIT_REST;
  strut_fit_source *sources;
  strut_column *places;
  if (!STRUT_ALLOCATE(&layout->arena, STRUT_NEW(sources, match->series_count),
                      STRUT_NEW(places, match->series_count)))
    return strut_no_memory(error, "");
  layout->parts[m].sources = sources;
  for (size_t s = 0; s < match->series_count; s++) {
    const strut_fit_series *series = &match->series[s];
    const strut_sweep_plan *table = &layout->parts[m].table;
    const strut_slot_column *column = find_column(table, series->of);
    const char *flaw = find_flaw(layout, match, series, setup, column);
    if (flaw) return refuse(layout, m, s, flaw, error);
    sources[s] = (strut_fit_source){-1, -1, 0};
    if (column)
      sources[s].column =
          (int64_t)strut_slot_place(table->columns, (size_t)(column - table->columns));
    if (moves)
      sources[s].axis = axis_of(strut_fit_quantity(&setup->experiment, series->of), &places[s]);
    for (size_t k = 0; k < s && sources[s].axis >= 0; k++)
      if (sources[k].axis == 1 - sources[s].axis && places[k].kind == places[s].kind &&
          places[k].item == places[s].item)
        sources[s].partner = (int32_t)k, sources[k].partner = (int32_t)s;
  }
  for (size_t s = 0; s < match->series_count && match->align.rotate; s++)
    if (sources[s].axis >= 0 && sources[s].partner < 0)
      return refuse(layout, m, s, "cannot be rotated without the other coordinate of the same node",
                    error);
  return STRUT_OK;
}

/* Lists the numbers of a match; returns their range, which the size of its motions is taken for. */
static double list_numbers(strut_fit_layout *layout, size_t m) {
  const strut_fit_match *match = &layout->fit->matches[m];
  strut_fit_number *number = layout->numbers + match->series[0].first, *first = number;
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (size_t s = 0; s < match->series_count; s++)
    for (size_t i = 0; i < match->count; i++, number++) { /* comparisons leave out NANs */
      const strut_fit_series *series = &match->series[s];
      const strut_data_column *of = series->column;
      *number = (strut_fit_number){match, series, match->at ? match->at[i] : (double)NAN,
                                   .measured = of ? of->values[i] : (double)NAN,
                                   .factor = of && of->weights ? sqrt(of->weights[i]) : 1.0};
      least = fmin(least, number->measured);
      most = fmax(most, number->measured);
    }
  double range = most > least ? most - least : fmax(fabs(most), 1e-12);
  layout->parts[m].noise = match->noise > 0.0 ? match->noise : range;
  layout->noise_known = layout->noise_known && match->noise > 0.0;
  while (first < number) first++->factor /= layout->parts[m].noise;
  return range;
}

/*
 * Turns and delays have a range, as parameters do: by a delay a motion begins no further from its start, or from its own
 * first time, than it lasts. Where it begins long after the model's own run has ended, or before 0, its clock is its own.
 */
static bool add_aligned(strut_fit_layout *layout, size_t m, strut_fit_aligns what, double own,
                        double scale) {
  static const char *const names[] = {"shift_x", "shift_y", "rotate", "delay"};
  static const char *const units[] = {"m", "m", "rad", "s"};
  const strut_fit_match *match = &layout->fit->matches[m];
  bool delay = what == STRUT_FIT_DELAY;
  const double range[] = {HUGE_VAL, HUGE_VAL, STRUT_TAU, scale};
  double first = delay ? match->at[0] : 0.0, latest = fmax(own, STRUT_FIT_OWN_CLOCK * scale);
  double start = first < 0.0 || first > latest ? first : 0.0;
  const char *name = strut_arena_format(&layout->arena, "%s.%s", match->name, names[what]);
  size_t i = layout->aligned_count++;
  layout->parts[m].aligned[what] = (int32_t)i;
  layout->unknowns[i] = (strut_fit_unknown){name, units[what], NULL, what, {start, first}, scale};
  layout->low[i] = 1.0 + (start - range[what]) / scale;
  layout->high[i] = 1.0 + (fmax(start, first) + range[what]) / scale;
  return name != NULL;
}

/* `own`: the duration of the model's own run; `range`: that of the numbers. */
static bool add_alignments(strut_fit_layout *layout, size_t m, double own, double range) {
  const strut_fit_match *match = &layout->fit->matches[m];
  const double scale[] = {range, range, 1.0, strut_fit_span(match)};
  bool free[] = {false, false, match->align.rotate, match->align.delay}, fine = true;
  for (size_t s = 0; s < match->series_count && match->align.shift; s++) {
    int axis = layout->parts[m].sources[s].axis;
    if (axis >= 0 && match->series[s].column) free[axis] = true;
  }
  for (int what = 0; what < STRUT_FIT_ALIGNS_COUNT; what++) {
    layout->parts[m].aligned[what] = -1;
    if (free[what]) fine = add_aligned(layout, m, (strut_fit_aligns)what, own, scale[what]) && fine;
  }
  return fine;
}

/* Keeps all columns that the study can have. */
static void keep_all(strut_study *study) {
  const strut_study own = *study;
  study->keep = (strut_keep_set){{0}};
  for (unsigned k = 0; k < STRUT_KEEP_COUNT; k++) {
    bool there = strut_kept_word_at(k)->of >> own.compute & 1u;
    if (k == STRUT_KEEP_STIFFNESS) there = there && own.goal.stiffness_node;
    if (k == STRUT_KEEP_SHAPE) there = there && (own.goal.like || own.goal.shape_count);
    if (k == STRUT_KEEP_CURVE) there = there && own.goal.curve_count;
    if (there) strut_keep_add(&study->keep, k);
  }
}

/* The study that computes the columns of a match, or its path. */
static strut_status make_table(strut_fit_layout *layout, size_t m, strut_error *error) {
  const strut_fit_match *match = &layout->fit->matches[m];
  layout->parts[m].study = *layout->plan->study;
  layout->parts[m].study.compute = match->compute;
  if (match->kind != STRUT_FIT_TABLE) return STRUT_OK;
  keep_all(&layout->parts[m].study);
  return strut_sweep_plan_make(&layout->parts[m].study, &layout->plan->scenes,
                               &layout->parts[m].table, error);
}

static strut_status find_all(strut_fit_layout *layout, strut_error *error) {
  const strut_sweep_plan *plan = layout->plan;
  strut_setup setup;
  strut_study_value *values =
      strut_arena_allocate(&layout->arena, plan->axis_columns + 1, sizeof *values);
  if (!values) return strut_no_memory(error, "");
  strut_grid_values(plan->study, 0, values);
  strut_status status = plan->scenes.setup(plan->scenes.context, values, &setup, error);
  if (status) return status;
  double own = strut_experiment_span(&setup.experiment, &setup.scene).duration;
  for (size_t m = 0; m < layout->fit->match_count && !status; m++) {
    status = make_table(layout, m, error);
    if (!status) status = find_sources(layout, m, &setup, error);
    if (!status && !add_alignments(layout, m, own, list_numbers(layout, m)))
      status = strut_no_memory(error, "");
  }
  strut_setup_free(&setup);
  return status;
}

/* There must be as many numbers that count as parameters. */
static strut_status check_count(strut_fit_layout *layout, strut_error *error) {
  strut_fit_case all;
  bool fine = strut_fit_case_create(layout, &all);
  strut_arena_free(&all.arena);
  if (!fine) return strut_no_memory(error, "");
  if (all.used >= layout->parameters) return STRUT_OK;
  layout->refused.series = layout->fit->matches[0].series;
  return strut_fail(error, STRUT_BAD_SCENE,
                    "%zu parameters and alignments need as many numbers that count, found %zu",
                    layout->parameters, all.used);
}

strut_status strut_fit_layout_make(const strut_sweep_plan *plan, const strut_flag *interrupt,
                                   strut_fit_layout *layout, strut_error *error) {
  const strut_study_fit *fit = plan->study->fit;
  *layout =
      (strut_fit_layout){.plan = plan, .fit = fit, .interrupt = interrupt, .noise_known = true};
  for (size_t m = 0; m < fit->match_count; m++)
    layout->count += fit->matches[m].count * fit->matches[m].series_count;
  size_t most = STRUT_FIT_ALIGNS_COUNT * fit->match_count, all = most + fit->variable_count;
  layout->standing = strut_equilibrium_cache_create();
  if (!layout->standing ||
      !STRUT_ALLOCATE(&layout->arena, STRUT_NEW(layout->unknowns, all),
                      STRUT_NEW(layout->parts, fit->match_count),
                      STRUT_NEW(layout->numbers, layout->count), STRUT_NEW(layout->low, all),
                      STRUT_NEW(layout->high, all)))
    return strut_no_memory(error, "");
  strut_status status = find_all(layout, error);
  layout->parameters = layout->aligned_count + fit->variable_count;
  for (size_t i = layout->aligned_count, k = 0; k < fit->variable_count; i++, k++) {
    const strut_search_variable *of = &fit->variables[k];
    layout->unknowns[i] = (strut_fit_unknown){of->name, of->unit, .variable = of};
    layout->low[i] = 1.0, layout->high[i] = 2.0;
  }
  return status ? status : check_count(layout, error);
}

void strut_fit_layout_free(strut_fit_layout *layout) {
  for (size_t m = 0; layout->fit && layout->parts && m < layout->fit->match_count; m++)
    strut_sweep_plan_free(&layout->parts[m].table);
  strut_equilibrium_cache_free(layout->standing);
  strut_arena_free(&layout->arena);
  *layout = (strut_fit_layout){0};
}

/* ---- parameters ---- */

double strut_fit_value(const strut_fit_layout *layout, size_t i, double parameter) {
  const strut_fit_unknown *of = &layout->unknowns[i];
  return of->variable ? strut_search_value(of->variable, parameter - 1.0).number
                      : (parameter - 1.0) * of->scale;
}

double strut_fit_parameter(const strut_fit_layout *layout, size_t i, double value) {
  const strut_fit_unknown *of = &layout->unknowns[i];
  return 1.0 + (of->variable
                    ? strut_search_number(of->variable, (strut_study_value){.number = value})
                    : value / of->scale);
}

double strut_fit_slope(const strut_fit_layout *layout, size_t i, double parameter) {
  const strut_search_variable *variable = layout->unknowns[i].variable;
  if (!variable) return layout->unknowns[i].scale;
  if (!variable->logarithmic) return variable->to - variable->from;
  return strut_fit_value(layout, i, parameter) * log(variable->to / variable->from);
}

void strut_fit_fill_values(const strut_fit_layout *layout, int64_t row, const double *parameters,
                           strut_study_value *values) {
  strut_grid_values(layout->plan->study, row, values);
  for (size_t i = layout->aligned_count; i < layout->parameters; i++)
    values[layout->fit->column + i - layout->aligned_count].number =
        strut_fit_value(layout, i, parameters[i]);
}

void strut_fit_choose_start(const strut_fit_layout *layout, int64_t start, double *parameters) {
  const strut_study_fit *fit = layout->fit;
  strut_search_spread spread =
      strut_search_spread_begin(fit->variable_count + layout->aligned_count, (uint64_t)fit->seed);
  for (size_t i = 0; i < layout->parameters; i++) {
    const strut_fit_unknown *of = &layout->unknowns[i];
    size_t k = i - layout->aligned_count;
    parameters[i] = !of->variable ? strut_fit_parameter(layout, i, of->starts[start % 4 == 2])
                    : start == 0  ? 1.0 + strut_search_start(of->variable)
                                  : 1.0 + strut_search_spread_at(&spread, start - 1, k);
  }
}

/* ---- what determines the parameters best, from the model alone ---- */

/* Derivatives of everything, of which candidates take their part. */
typedef struct planning {
  const strut_fit_layout *layout;
  strut_fit_plan *plan;
  double *jacobian; /* (count, parameters); rows of gaps are 0 */
  double *part;     /* (count, parameters) of a candidate, the other rows 0 */
} planning;

/* Values the numbers of two series, or all of a match, or all (NULL): with those alignments that they depend on. */
static bool add_candidate(planning *self, const char *name, const strut_fit_match *match,
                          const strut_fit_series *one, const strut_fit_series *other) {
  const strut_fit_layout *layout = self->layout;
  strut_fit_plan *plan = self->plan;
  size_t n = layout->parameters, first = layout->aligned_count, kept = n - first;
  strut_fit_spectrum spectrum;
  strut_fit_candidate *candidate = &plan->candidates[plan->count++];
  *candidate = (strut_fit_candidate){.name = name, .determinant = -HUGE_VAL};
  candidate->errors = strut_arena_allocate(&plan->arena, plan->variable_count, sizeof(double));
  if (!candidate->errors || !name) return false;
  memset(self->part, 0, layout->count * n * sizeof *self->part);
  for (size_t k = 0; k < layout->count; k++) {
    const strut_fit_number *number = &layout->numbers[k];
    if (one ? number->series != one && number->series != other : match && number->match != match)
      continue;
    memcpy(self->part + k * n, self->jacobian + k * n, n * sizeof *self->part);
    if (!isnan(number->measured)) candidate->numbers++;
  }
  for (size_t i = 0; i < first; i++) {
    bool moves = false;
    for (size_t k = 0; k < layout->count; k++) moves = moves || self->part[k * n + i] != 0.0;
    kept += moves;
  }
  if (!strut_fit_spectrum_find(self->part, layout->count, n, &plan->arena, &spectrum)) return false;
  bool enough = candidate->numbers >= kept;
  for (size_t k = first; k < n; k++)
    candidate->errors[k - first] = enough ? sqrt(spectrum.covariance[k * n + k]) *
                                                fabs(strut_fit_slope(layout, k, plan->at[k]))
                                          : HUGE_VAL;
  if (!enough) return true;
  candidate->least = spectrum.singular[kept - 1];
  candidate->determinant = 0.0;
  for (size_t i = 0; i < kept; i++) candidate->determinant += 2.0 * log10(spectrum.singular[i]);
  return true;
}

/* Candidates of a match: places, "n1" of "n1.x" and "n1.y", and the whole. */
static bool add_match(planning *self, size_t m) {
  const strut_fit_match *match = &self->layout->fit->matches[m];
  size_t before = self->plan->count;
  bool fine = true;
  for (size_t s = 0; s < match->series_count && fine; s++) {
    int32_t partner = self->layout->parts[m].sources[s].partner;
    const char *of = match->series[s].of, *dot = strrchr(of, '.');
    int length = (int)(partner >= 0 && dot ? dot - of : (int64_t)strlen(of));
    if (partner >= 0 && partner < (int32_t)s) continue;
    fine = add_candidate(
        self, strut_arena_format(&self->plan->arena, "%s: %.*s", match->name, length, of), match,
        &match->series[s], partner < 0 ? NULL : &match->series[partner]);
  }
  return fine &&
         (self->plan->count - before < 2 || add_candidate(self, match->name, match, NULL, NULL));
}

/* The most certain first. */
static int by_worth(const void *a, const void *b) {
  const strut_fit_candidate *first = a, *second = b;
  if (first->determinant != second->determinant)
    return first->determinant > second->determinant ? -1 : 1;
  return strcmp(first->name, second->name);
}

/* The derivatives at the first place in the ranges where the model can be computed. */
static strut_status differentiate(const planning *self, strut_fit_case *one, strut_error *error) {
  strut_least_squares problem = strut_fit_problem(one);
  for (int k = 0; k < STRUT_FIT_MOST_PLACES && !one->status; k++) {
    strut_fit_choose_start(one->layout, k, self->plan->at);
    if (strut_least_squares_jacobian(&problem, self->plan->at, self->part, self->jacobian))
      return STRUT_OK;
  }
  return one->status ? strut_fail(error, one->status, "%s", one->error.message)
                     : strut_fail(error, STRUT_DIVERGED,
                                  "the model cannot be computed at any of %d places in the ranges",
                                  STRUT_FIT_MOST_PLACES);
}

strut_status strut_fit_plan_find(const strut_sweep_plan *of, const strut_flag *interrupt,
                                 strut_fit_plan *plan, strut_error *error) {
  const strut_study_fit *fit = of->study->fit;
  strut_fit_layout layout = {0};
  strut_fit_case one = {0};
  planning self = {.layout = &layout, .plan = plan};
  *plan = (strut_fit_plan){.fit = fit, .variable_count = fit->variable_count};
  strut_status status = strut_fit_layout_make(of, interrupt, &layout, error);
  size_t n = layout.parameters, most = 1 + fit->match_count;
  for (size_t m = 0; m < fit->match_count; m++) most += fit->matches[m].series_count;
  bool fine =
      !status && STRUT_NUMBERS(&layout.arena, layout.count * n, &self.jacobian, &self.part) &&
      STRUT_ALLOCATE(&plan->arena, STRUT_NEW(plan->candidates, most), STRUT_NEW(plan->at, n)) &&
      strut_fit_case_create(&layout, &one);
  if (fine) status = differentiate(&self, &one, error);
  for (size_t m = 0; m < fit->match_count && !status && fine; m++) fine = add_match(&self, m);
  if (!status && fine && fit->match_count > 1) fine = add_candidate(&self, "all", NULL, NULL, NULL);
  if (!status && !fine) status = strut_no_memory(error, "");
  if (!status) qsort(plan->candidates, plan->count, sizeof *plan->candidates, by_worth);
  strut_arena_free(&one.arena);
  strut_fit_layout_free(&layout);
  return status;
}
