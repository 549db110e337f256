/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures the work-precision tables: cells in turns, tables as text, CSV and figures. */
#include "tests/bench/precision.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/integrate/limit/step_limit.h"

enum {
  MOST_SETTINGS = 14,
  MOST_METHODS = 40,
  MOST_ROWS = MOST_METHODS * MOST_SETTINGS,
  LEVELS = 6,
  ROUNDS = 3
};
static const double levels[LEVELS] = {2e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10};
static const double REPEATED = 0.25; /* longer cells are timed once [s] */
static const double SHORTEST = 5e-3; /* shorter ones several times in a row [s] */
static const double OWN_PAIR = 1e-2; /* strut's own pair is the reference if so much closer */

#ifndef BENCH_SUNDIALS
const precision_method precision_sundials_methods[] = {{.name = NULL}};
#endif

/* A scene while it is measured. */
typedef struct scene_run {
  precision_problem problem, rigid;
  double reference; /* [m/s] */
  double floor;     /* difference of the references, relative: no smaller error is known */
  char pair[300];   /* the methods that it is the difference of */
  double limit;     /* CPU time of a cell [s] */
  size_t count;
  precision_row rows[MOST_ROWS];
} scene_run;

static const precision_method *method_at(size_t i) {
  static const precision_method *const tables[] = {precision_strut_methods, precision_gsl_methods,
                                                   precision_sundials_methods};
  for (size_t t = 0; t < sizeof tables / sizeof tables[0]; t++)
    for (const precision_method *m = tables[t]; m->name; m++)
      if (i-- == 0) return m;
  return NULL;
}

static const precision_method *method_named(const char *name) {
  for (size_t i = 0; method_at(i); i++)
    if (strcmp(method_at(i)->name, name) == 0) return method_at(i);
  return NULL;
}

static const precision_scene *scene_named(const char *name) {
  for (size_t i = 0; precision_scene_at(i); i++)
    if (strcmp(precision_scene_at(i)->name, name) == 0) return precision_scene_at(i);
  return NULL;
}

static bool is_accuracy(const precision_method *m) {
  return strcmp(m->name, PRECISION_ACCURACY) == 0;
}

static precision_problem *problem_of(scene_run *s, const precision_method *m) {
  return m->rigid ? &s->rigid : &s->problem;
}

static bool solve(scene_run *s, const precision_method *m, double setting, double limit,
                  precision_answer *answer) {
  *answer = (precision_answer){.velocity = (double)NAN};
  precision_allow(limit);
  bool applies = m->solve(problem_of(s, m), m, setting, answer);
  answer->late = precision_late;
  if (applies && !answer->late && isnan(answer->velocity) && !answer->note[0])
    snprintf(answer->note, sizeof answer->note, "unstable");
  if (answer->late) snprintf(answer->note, sizeof answer->note, "longer than %g s", limit);
  precision_allow(0.0);
  return applies;
}

/* The i-th setting of a method's ladder; NAN: none. */
static double setting_at(scene_run *s, const precision_method *m, int i) {
  const precision_problem *p = problem_of(s, m);
  double limit = 0.0, part = p->end / (double)p->parts;
  if (is_accuracy(m)) return i < LEVELS ? levels[i] : (double)NAN;
  if (m->ladder == PRECISION_TOLERANCES) return pow(10.0, -2 - i);
  if (m->ladder == PRECISION_LONG_STEPS) return ldexp(part / 50, -i);
  if (strut_step_limit_for_method(p->model, strut_integrator_find(m->like), &limit, NULL) !=
      STRUT_OK)
    return (double)NAN;
  return ldexp(fmin(0.95 * limit, part / 8), -i);
}

/* ---- references ---- */

static double reference_by(scene_run *s, const char *name, double setting, double limit) {
  const precision_method *m = method_named(name);
  precision_answer answer = {.velocity = (double)NAN};
  if (m) solve(s, m, setting, limit, &answer);
  return answer.velocity;
}

static const struct candidate {
  const char *name;
  int library;    /* methods of one library are not independent */
  double setting; /* tolerance, or number of halvings of the largest step */
  double limit;   /* CPU time [s] */
} candidates[] = {{"adaptive", 0, 1e-12, 30},
                  {"adaptive", 0, 1e-11, 30},
                  {"rk4-events", 0, 6, 30},
                  {"GSL rkf45", 1, 1e-8, 20},
                  {"GSL rkf45", 1, 1e-7, 120},
                  {"GSL rk8pd", 1, 1e-13, 5},
                  {"ARKODE ERK 8", 2, 1e-13, 5},
                  {"ARKODE ERK 8, roots", 2, 1e-13, 5},
                  {"ARKODE ERK 5, roots", 2, 1e-12, 5}};
enum { CANDIDATES = sizeof candidates / sizeof candidates[0] };

/* The pair that agrees best, of different libraries or, with `within`, of strut's methods. */
static double closest(const double *velocity, bool within, size_t pair[2]) {
  double least = (double)INFINITY;
  for (size_t i = 0; i < CANDIDATES; i++)
    for (size_t k = i + 1; k < CANDIDATES; k++) {
      double apart = fabs(velocity[k] / velocity[i] - 1);
      const struct candidate *a = &candidates[i], *b = &candidates[k];
      bool fits =
          within ? b->library == 0 && strcmp(a->name, b->name) != 0 : a->library != b->library;
      if (fits && apart < least) least = apart, pair[0] = i, pair[1] = k;
    }
  return least;
}

/* By two methods of different libraries; of strut alone where these agree much better. */
static bool find_reference(scene_run *s) {
  double velocity[CANDIDATES];
  size_t pair[2] = {0}, own[2] = {0};
  for (size_t i = 0; i < CANDIDATES; i++) {
    const precision_method *m = method_named(candidates[i].name);
    double setting = candidates[i].setting;
    if (m && m->ladder != PRECISION_TOLERANCES) setting = setting_at(s, m, (int)setting);
    velocity[i] = reference_by(s, candidates[i].name, setting, candidates[i].limit);
  }
  s->floor = closest(velocity, false, pair);
  double alone = closest(velocity, true, own);
  if (isfinite(s->floor))
    snprintf(s->pair, sizeof s->pair, "%s and %s differ by %.1e", candidates[pair[0]].name,
             candidates[pair[1]].name, s->floor);
  else
    snprintf(s->pair, sizeof s->pair, "no other library ends in time");
  if (alone < OWN_PAIR * s->floor) {
    size_t used = strlen(s->pair);
    snprintf(s->pair + used, sizeof s->pair - used, "; used: %s and %s, by %.1e",
             candidates[own[0]].name, candidates[own[1]].name, alone);
    s->floor = alone, pair[0] = own[0];
  }
  s->reference = velocity[pair[0]];
  return isfinite(s->floor);
}

/* ---- cells ---- */

static void fill_error(const scene_run *s, precision_row *row) {
  row->error = fabs(row->answer.velocity / s->reference - 1);
}

static precision_row *add_cell(scene_run *s, const precision_method *m, double setting) {
  precision_row *row = &s->rows[s->count++];
  *row = (precision_row){.method = m, .setting = setting};
  row->applies = solve(s, m, setting, s->limit, &row->answer);
  fill_error(s, row);
  return row;
}

/* Ever finer settings, until errors no longer show or a cell takes too long. */
static void add_method(scene_run *s, const precision_method *m) {
  int below = 0;
  if (m->rigid && !s->problem.scene->rigid) return;
  for (int i = 0; i < MOST_SETTINGS && below < 2; i++) {
    double setting = setting_at(s, m, i);
    if (isnan(setting)) return;
    const precision_row *row = add_cell(s, m, setting);
    if (!row->applies || row->answer.late) return;
    below = row->error <= fmax(s->floor, 1e-12) ? below + 1 : 0;
  }
}

/* CPU time of a cell as the mean of enough runs for the clock. */
static double seconds_again(scene_run *s, const precision_row *row) {
  int runs = 1 + (int)fmin(SHORTEST / fmax(row->answer.seconds, 1e-6), 200);
  double sum = 0.0;
  for (int i = 0; i < runs; i++) {
    precision_answer again;
    solve(s, row->method, row->setting, s->limit, &again);
    sum += again.seconds;
  }
  return sum / runs;
}

static void repeat_cells(scene_run *s) {
  for (size_t i = 0; i < s->count; i++) {
    precision_row *row = &s->rows[i];
    if (row->answer.seconds < REPEATED && !isnan(row->error))
      row->answer.seconds = fmin(row->answer.seconds, seconds_again(s, row));
  }
}

typedef enum cost { EVALUATIONS, CPU_TIME, COSTS } cost;

static double cost_of(const precision_row *row, cost kind) {
  return kind == CPU_TIME ? row->answer.seconds : (double)row->answer.evaluations;
}

/* What a method asks for an error; no row: it does not offer it. */
typedef struct offer {
  const precision_row *row;
  double cost;
} offer;

static bool is_cheaper(offer a, offer than) { return a.row && (!than.row || a.cost < than.cost); }

/* --accuracy must keep what was asked for. */
static bool keeps_promise(const precision_row *row, double error) {
  return row->setting <= error && row->error <= error && !row->answer.note[0];
}

/*
 * Cost at an error that the coarser row does not keep and the finer one does: on the diagram's line between both, so
 * that it does not depend on where settings happen to lie.
 */
static double cost_between(const precision_row *coarser, const precision_row *finer, double error,
                           cost kind) {
  double fine = cost_of(finer, kind), coarse = cost_of(coarser, kind);
  if (!(coarser->error < HUGE_VAL && finer->error > 0.0 && coarse > 0.0 && coarse < fine))
    return fine;
  double part = log(error / finer->error) / log(coarser->error / finer->error);
  return fine * pow(coarse / fine, part);
}

/*
 * The cheapest row of a method within an error, whose finer settings keep it too: one small error alone may be a
 * coincidence.
 */
static offer cheapest_of(const scene_run *s, const precision_method *m, double error, cost kind) {
  offer best = {NULL, 0.0};
  const precision_row *finer = NULL;
  for (size_t i = s->count; i-- > 0;) {
    const precision_row *row = &s->rows[i];
    if (row->method != m || (isnan(row->error) && !best.row)) continue;
    bool kept = is_accuracy(m) ? keeps_promise(row, error) : row->error <= error;
    offer found = {row, cost_of(row, kind)};
    if (!kept && !is_accuracy(m)) {
      found = (offer){finer, finer ? cost_between(row, finer, error, kind) : 0.0};
      return is_cheaper(found, best) ? found : best;
    }
    if (kept && is_cheaper(found, best)) best = found;
    finer = row;
  }
  return best;
}

typedef enum contender { OF_OTHERS, OF_STRUT } contender;

static offer cheapest(const scene_run *s, contender who, double error, cost kind) {
  offer best = {NULL, 0.0};
  for (size_t i = 0; method_at(i); i++) {
    const precision_method *m = method_at(i);
    if (m->strut != (who == OF_STRUT) || is_accuracy(m)) continue;
    offer found = cheapest_of(s, m, error, kind);
    if (is_cheaper(found, best)) best = found;
  }
  return best;
}

/* ---- output ---- */

static void print_offer(offer o) {
  if (o.row)
    printf(" %-20s %8.3g", o.row->method->name, o.cost);
  else
    printf(" %-20s %8s", "none", "-");
}

static void print_ratio(offer a, offer b) {
  if (a.row && b.row)
    printf(" %7.3g", a.cost / b.cost);
  else
    printf(" %7s", "-");
}

static void print_costs(const scene_run *s, cost kind) {
  printf("  %-6s %-29s %-29s %7s %7s\n", "error",
         kind == CPU_TIME ? "strut, CPU s" : "strut, forces", "others", "o/strut", "acc/best");
  for (int l = 0; l < LEVELS && levels[l] >= s->floor; l++) {
    offer own = cheapest(s, OF_STRUT, levels[l], kind);
    offer other = cheapest(s, OF_OTHERS, levels[l], kind);
    printf("  %-6.0e", levels[l]);
    print_offer(own);
    print_offer(other);
    print_ratio(other, own);
    print_ratio(cheapest_of(s, method_named(PRECISION_ACCURACY), levels[l], kind),
                is_cheaper(own, other) ? own : other);
    printf("\n");
  }
}

static void print_table(const scene_run *s) {
  printf("\n%s: %.10g mm/s; %s\n", s->problem.scene->title, 1e3 * s->reference, s->pair);
  for (cost kind = 0; kind < COSTS; kind++) print_costs(s, kind);
  for (size_t i = 0; i < s->count; i++)
    if (!s->rows[i].applies) printf("  %s: %s\n", s->rows[i].method->name, s->rows[i].answer.note);
  fflush(stdout);
}

/* Lines of all methods would hide each other: those that are the cheapest of their side for some error. */
static bool is_drawn(const scene_run *s, const precision_method *m) {
  bool drawn = is_accuracy(m);
  for (int l = 0; l < LEVELS; l++)
    for (cost kind = 0; kind < COSTS; kind++) {
      const precision_row *row = cheapest(s, m->strut ? OF_STRUT : OF_OTHERS, levels[l], kind).row;
      drawn = drawn || (row && row->method == m);
    }
  return drawn;
}

static strut_status draw(const char *path, const scene_run *s, strut_error *error) {
  static precision_row drawn[MOST_ROWS];
  size_t count = 0;
  for (size_t i = 0; i < s->count; i++)
    if (is_drawn(s, s->rows[i].method)) drawn[count++] = s->rows[i];
  return precision_draw(path, s->problem.scene, drawn, count, error);
}

static void print_cell(FILE *file, const char *format, double value) {
  fputc(',', file);
  if (isfinite(value)) fprintf(file, format, value);
}

static bool write_csv(const char *path, const scene_run *s) {
  FILE *file = fopen(path, "w");
  if (!file) return false;
  fputs("scene,method,tolerance,step [s],error,evaluations,cpu [s],note\n", file);
  for (size_t i = 0; i < s->count; i++) {
    const precision_row *row = &s->rows[i];
    bool steps = row->method->ladder != PRECISION_TOLERANCES;
    fprintf(file, "%s,\"%s\"", s->problem.scene->name, row->method->name);
    print_cell(file, "%.0e", steps ? (double)NAN : row->setting);
    print_cell(file, "%.4g", steps ? row->setting : (double)NAN);
    print_cell(file, "%.2e", row->error);
    fprintf(file, ",%lld", (long long)row->answer.evaluations);
    fprintf(file, ",%.3g,\"%s\"\n", row->answer.seconds, row->answer.note);
  }
  return fclose(file) == 0;
}

static int write_files(const char *folder, const scene_run *s) {
  char path[1000];
  strut_error error = {0};
  const char *name = s->problem.scene->name;
  snprintf(path, sizeof path, "%s/%s.csv", folder, name);
  if (!write_csv(path, s)) {
    fprintf(stderr, "strut_bench: cannot write %s\n", path);
    return 4;
  }
  snprintf(path, sizeof path, "%s/%s.svg", folder, name);
  strut_status status = draw(path, s, &error);
  if (status != STRUT_OK) fprintf(stderr, "strut_bench: %s\n", error.message);
  return strut_status_exit_code(status);
}

static bool open_scene(scene_run *s, const precision_scene *scene, double limit) {
  *s = (scene_run){.limit = limit * (scene->periods > 0 ? 2 : 1)};
  if (!precision_open(&s->problem, scene, false)) return false;
  if (scene->rigid && !precision_open(&s->rigid, scene, true)) {
    precision_close(&s->problem);
    return false;
  }
  return true;
}

static void close_scene(scene_run *s) {
  if (s->problem.scene->rigid) precision_close(&s->rigid);
  precision_close(&s->problem);
}

static int measure_scene(scene_run *s, const precision_scene *scene, const char *folder,
                         double limit) {
  if (!open_scene(s, scene, limit)) return 1;
  int code = 0;
  if (find_reference(s)) {
    for (size_t m = 0; method_at(m); m++) add_method(s, method_at(m));
    for (int r = 1; r < ROUNDS; r++) repeat_cells(s);
    print_table(s);
    if (folder) code = write_files(folder, s);
  } else {
    printf("\n%s: no reference\n", scene->title);
    code = 1;
  }
  close_scene(s);
  return code;
}

static bool is_wanted(const precision_scene *scene, char *const *names, int count) {
  for (int i = 0; i < count; i++)
    if (strcmp(names[i], scene->name) == 0) return true;
  return count == 0;
}

int bench_precision(const char *folder, double limit, char *const *names, int count) {
  static scene_run s;
  int code = 0;
  for (int i = 0; i < count; i++)
    if (!scene_named(names[i])) {
      fprintf(stderr, "strut_bench: unknown scene '%s'; scenes are:", names[i]);
      for (size_t k = 0; precision_scene_at(k); k++)
        fprintf(stderr, " %s", precision_scene_at(k)->name);
      fputc('\n', stderr);
      return 1;
    }
#ifndef BENCH_SUNDIALS
  puts("CVODE, ARKODE: not built with SUNDIALS");
#endif
  for (size_t i = 0; precision_scene_at(i); i++)
    if (is_wanted(precision_scene_at(i), names, count)) {
      int failed = measure_scene(&s, precision_scene_at(i), folder, limit);
      code = failed ? failed : code;
    }
  return code;
}

/* ---- a check that can fail ---- */

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* All methods converge to one answer: the median of their finest runs, so that none is right by itself. */
int bench_precision_check(void) {
  enum { COARSE = 3, FINE = 6 };
  static scene_run s;
  static const double BOUND = 1e-4; /* error of every fine run */
  static const double FIRM = 1e-8;  /* coarse runs need not be worse than fine ones below it */
  double sorted[MOST_METHODS];
  int wrong = 0;
  size_t count = 0;
  const precision_scene *scene = scene_named("smooth-friction");
  if (!open_scene(&s, scene, 5.0)) return 1;
  for (size_t m = 0; method_at(m) && count < MOST_METHODS; m++) {
    const precision_method *method = method_at(m);
    if (is_accuracy(method) || method->rigid) continue;
    if (add_cell(&s, method, setting_at(&s, method, COARSE))->applies)
      add_cell(&s, method, setting_at(&s, method, FINE));
    else
      s.count--;
  }
  for (size_t i = 1; i < s.count; i += 2) sorted[count++] = s.rows[i].answer.velocity;
  qsort(sorted, count, sizeof *sorted, ascending);
  s.reference = sorted[count / 2];
  for (size_t i = 0; i < s.count; i += 2) {
    precision_row *coarse = &s.rows[i], *fine = &s.rows[i + 1];
    fill_error(&s, coarse), fill_error(&s, fine);
    bool good = fine->error < BOUND && (fine->error < coarse->error || coarse->error < FIRM);
    printf("%-20s %8.1e %8.1e %8lld%s\n", fine->method->name, coarse->error, fine->error,
           (long long)fine->answer.evaluations, good ? "" : "  wrong");
    wrong += !good;
  }
  close_scene(&s);
  return wrong > 0;
}
