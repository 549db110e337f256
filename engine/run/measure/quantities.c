/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/quantities.h"

#include <math.h>
#include <string.h>

#include "engine/run/measure/columns.h"
#include "engine/run/measure/quantity_program.h"
#include "engine/run/measure/time_grid.h"

/* A mark this close to the end of a step, in steps, counts as being there. */
static const double MARK_TOLERANCE = 1e-6;

/* Results below these parts of their terms are rounding: of differences, and of others. */
static const double CANCELLED = 1e-10, ROUNDED = 1e-15;

/* Successive second differences within this factor belong to a smooth curve. */
static const double SMOOTH = 2.0;

enum { RECENT = 5 };

/* Sums and extremes over a stretch of the window. */
typedef struct stretch {
  double integral, square; /* integrals of the value and its square over the time */
  double low, high;
  double begin;   /* value at the start */
  double origin;  /* position at the start, where its change is the integral */
  double time;    /* start [s] */
  double rise;    /* sum of all increases */
  double arrival; /* when the target was first reached or passed [s]; NAN: not yet */
} stretch;

typedef struct meter {
  const strut_quantity_definition *definition;
  size_t *index;  /* (length) the columns of the program */
  size_t rate_of; /* column whose change is the integral of a single velocity; or NONE */
  double value;   /* after the latest step */
  double recent[RECENT];
  int recent_count;
  double largest;      /* absolute value in the window */
  stretch whole, part; /* since the start of the window; since the latest mark */
  double result;       /* up to the latest mark */
  int64_t parts;       /* periods so far; mean of their values; sum of squares about it */
  double part_mean, part_square;
} meter;

struct strut_quantities {
  strut_columns columns;
  size_t count, next; /* of quantities; the next mark to pass */
  double time;        /* of the latest mark passed [s] */
  double begin;       /* of the first */
  bool by_periods;
  meter *meters;                       /* (count) */
  double *last;                        /* (count) values before the latest step */
  double *stack;                       /* (depth) */
  strut_magnitude *sizes, *size_stack; /* (columns), (depth) */
};

static const size_t NONE = (size_t)-1;

/* The column whose time derivative a column is. */
static bool find_primitive(strut_column column, strut_column *primitive) {
  static const strut_column_kind rates[][2] = {{STRUT_COLUMN_NODE_VX, STRUT_COLUMN_NODE_X},
                                               {STRUT_COLUMN_NODE_VY, STRUT_COLUMN_NODE_Y},
                                               {STRUT_COLUMN_CENTRE_VX, STRUT_COLUMN_CENTRE_X},
                                               {STRUT_COLUMN_CENTRE_VY, STRUT_COLUMN_CENTRE_Y},
                                               {STRUT_COLUMN_RATE, STRUT_COLUMN_LENGTH},
                                               {STRUT_COLUMN_HINGE_RATE, STRUT_COLUMN_HINGE_ANGLE}};
  *primitive = column;
  for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
    if (column.kind != rates[i][0]) continue;
    primitive->kind = rates[i][1];
    return true;
  }
  return false;
}

static bool make_meter(strut_quantities *q, const strut_quantity_definition *d, strut_arena *arena,
                       meter *m) {
  strut_column primitive;
  *m = (meter){.definition = d, .rate_of = NONE};
  m->index = strut_arena_allocate(arena, d->length, sizeof *m->index);
  if (!m->index) return false;
  for (size_t i = 0; i < d->length; i++)
    if (d->program[i].operation == STRUT_OPERATION_COLUMN)
      m->index[i] = strut_columns_add(&q->columns, d->program[i].column);
  bool mean = d->length == 1 && d->take == STRUT_TAKE_MEAN;
  if (mean && find_primitive(d->program[0].column, &primitive))
    m->rate_of = strut_columns_add(&q->columns, primitive);
  return true;
}

strut_quantities *strut_quantities_create(const strut_model *model, const strut_experiment *e,
                                          double step, strut_arena *arena) {
  size_t columns = 0, depth = 1;
  strut_quantities *q = strut_arena_allocate(arena, 1, sizeof *q);
  if (!q) return NULL;
  for (size_t i = 0; i < e->quantity_count; i++) {
    columns += e->quantities[i].length + 1;
    if (e->quantities[i].depth > depth) depth = e->quantities[i].depth;
  }
  q->count = e->quantity_count;
  q->by_periods = strut_experiment_span(e, model->scene).period > 0.0;
  q->meters = strut_arena_allocate(arena, q->count, sizeof *q->meters);
  q->last = strut_arena_allocate(arena, q->count, sizeof *q->last);
  q->stack = strut_arena_allocate(arena, depth, sizeof *q->stack);
  q->sizes = strut_arena_allocate(arena, columns, sizeof *q->sizes);
  q->size_stack = strut_arena_allocate(arena, depth, sizeof *q->size_stack);
  bool ready = q->meters && q->last && q->stack && q->sizes && q->size_stack &&
               strut_columns_create(model, step, columns, arena, &q->columns);
  for (size_t i = 0; i < q->count && ready; i++)
    ready = make_meter(q, &e->quantities[i], arena, &q->meters[i]);
  return ready ? q : NULL;
}

bool strut_quantities_need_ledger(const strut_experiment *e) {
  for (size_t i = 0; i < e->quantity_count; i++)
    for (size_t k = 0; k < e->quantities[i].length; k++) {
      const strut_instruction *p = &e->quantities[i].program[k];
      bool ledger = p->column.kind >= STRUT_COLUMN_DRIVES && p->column.kind <= STRUT_COLUMN_LOST;
      if (p->operation == STRUT_OPERATION_COLUMN && ledger) return true;
    }
  return false;
}

static double evaluate_meter(const strut_quantities *q, const meter *m) {
  return strut_quantity_program_evaluate(m->definition, m->index, q->columns.value, q->stack);
}

static stretch begin_stretch(const meter *m, double time, double value, double origin) {
  return (stretch){.low = value,
                   .high = value,
                   .begin = value,
                   .origin = origin,
                   .time = time,
                   .arrival = value == m->definition->target ? time : (double)NAN};
}

static void note_extreme(stretch *s, double value) {
  if (!(value >= s->low)) s->low = value; /* a NaN remains */
  if (!(value <= s->high)) s->high = value;
}

/* Adds a part of a step of `time` [s] that begins at `begin` [s], linear from one value to another. */
static void add_interval(meter *m, double from, double to, double begin, double time) {
  stretch *const both[] = {&m->whole, &m->part};
  double before = from - m->definition->target, after = to - m->definition->target;
  bool arrives = (before < 0.0 && after >= 0.0) || (before > 0.0 && after <= 0.0);
  for (int k = 0; k < 2; k++) {
    both[k]->integral += 0.5 * (from + to) * time;
    both[k]->square += 0.5 * (from * from + to * to) * time;
    note_extreme(both[k], to);
    both[k]->rise += fmax(to - from, 0.0);
    if (arrives && isnan(both[k]->arrival))
      both[k]->arrival = begin + time * (before / (before - after));
  }
  m->largest = fmax(m->largest, fabs(to));
}

/* Reduces a stretch that ends here to its value. */
static double reduce_stretch(const meter *m, const stretch *s, double time, double value,
                             double place) {
  double length = time - s->time;
  switch (m->definition->take) {
    case STRUT_TAKE_MEAN: return (m->rate_of == NONE ? s->integral : place - s->origin) / length;
    case STRUT_TAKE_MIN: return s->low;
    case STRUT_TAKE_MAX: return s->high;
    case STRUT_TAKE_RANGE: return s->high - s->low;
    case STRUT_TAKE_RMS: return sqrt(s->square / length);
    case STRUT_TAKE_FINAL: return value;
    case STRUT_TAKE_CHANGE: return value - s->begin;
    case STRUT_TAKE_RATE: return (value - s->begin) / length;
    case STRUT_TAKE_RISE: return s->rise;
    case STRUT_TAKE_ARRIVAL: return s->arrival;
  }
  return (double)NAN;
}

static void open_window(meter *m, double time, double value, double place) {
  m->whole = m->part = begin_stretch(m, time, value, place);
  m->parts = 0;
  m->part_mean = m->part_square = 0.0;
  m->recent_count = 0;
  m->largest = fabs(value);
}

static void close_part(meter *m, double time, double value, double place) {
  double of_part = reduce_stretch(m, &m->part, time, value, place), d = of_part - m->part_mean;
  m->result = reduce_stretch(m, &m->whole, time, value, place);
  m->parts++;
  m->part_mean += d / (double)m->parts;
  m->part_square += d * (of_part - m->part_mean);
  m->part = begin_stretch(m, time, value, place);
}

/* Interpolates the primitive at the fraction `s` of the latest step, of length h [s]. */
static double interpolate_primitive(const strut_quantities *q, const meter *m, double h, double s) {
  const strut_columns *c = &q->columns;
  if (m->rate_of == NONE) return 0.0;
  size_t x = m->rate_of, v = m->index[0];
  if (s >= 1.0) return c->value[x];
  return strut_hermite(c->before[x], c->before[v], c->value[x], c->value[v], h, s);
}

/* Passes the mark `time` at the fraction `s` of the step, which began at `step_begin` [s]; `from`:
 * fraction of the mark before. */
static void pass_mark(strut_quantities *q, double time, double step_begin, double h, double from,
                      double s, const double *last) {
  for (size_t i = 0; i < q->count; i++) {
    meter *m = &q->meters[i];
    double now = m->value, rise = now - last[i];
    double a = from > 0.0 ? last[i] + from * rise : last[i];
    double b = s < 1.0 ? last[i] + s * rise : now;
    double place = interpolate_primitive(q, m, h, s);
    if (q->next > 0) {
      add_interval(m, a, b, step_begin + from * h, (s - from) * h);
      close_part(m, time, b, place);
    } else {
      open_window(m, time, b, place);
    }
  }
  if (q->next == 0) q->begin = time;
  q->time = time;
  q->next++;
}

/* Finds an extreme between steps where the values around it lie on a smooth curve. */
static void refine_extremes(meter *m) {
  const double *f = m->recent;
  double left = (f[2] - f[1]) - (f[1] - f[0]), middle = (f[3] - f[2]) - (f[2] - f[1]);
  double right = (f[4] - f[3]) - (f[3] - f[2]);
  if (!((f[2] - f[1]) * (f[3] - f[2]) <= 0.0) || !(left * middle > 0.0 && right * middle > 0.0))
    return;
  double least = fmin(fabs(middle), fmin(fabs(left), fabs(right)));
  double most = fmax(fabs(middle), fmax(fabs(left), fabs(right)));
  if (most > SMOOTH * least) return;
  double slope = 0.5 * (f[3] - f[1]), vertex = f[2] - 0.5 * slope * slope / middle;
  note_extreme(&m->whole, vertex);
  note_extreme(&m->part, vertex);
}

static void store_recent(meter *m, double value) {
  strut_reduction take = m->definition->take;
  if (take != STRUT_TAKE_MIN && take != STRUT_TAKE_MAX && take != STRUT_TAKE_RANGE) return;
  if (m->recent_count == RECENT)
    memmove(m->recent, m->recent + 1, (RECENT - 1) * sizeof *m->recent);
  else
    m->recent_count++;
  m->recent[m->recent_count - 1] = value;
  if (m->recent_count == RECENT) refine_extremes(m);
}

void strut_quantities_begin(strut_quantities *q, const strut_marks *marks, strut_state *state) {
  q->next = 0;
  strut_columns_begin(&q->columns, state);
  for (size_t i = 0; i < q->count; i++) {
    q->meters[i].value = evaluate_meter(q, &q->meters[i]);
    q->meters[i].result = (double)NAN;
    q->meters[i].parts = 0;
  }
  if (fabs(marks->time[0] / marks->step - (double)state->step) >= MARK_TOLERANCE) return;
  for (size_t i = 0; i < q->count; i++) {
    meter *m = &q->meters[i];
    open_window(m, marks->time[0], m->value,
                m->rate_of == NONE ? 0.0 : q->columns.value[m->rate_of]);
    store_recent(m, m->value);
  }
  q->begin = q->time = marks->time[0];
  q->next = 1;
}

void strut_quantities_step(strut_quantities *q, const strut_marks *marks, strut_state *state) {
  if (q->next >= marks->count) return;
  double n = (double)state->step, step = marks->step, h = marks->length, from = 0.0;
  double *last = q->last, begin = (n - 1.0) * step + state->time_offset;
  q->columns.shorter = h - step;
  strut_columns_evaluate(&q->columns, state);
  for (size_t i = 0; i < q->count; i++) {
    last[i] = q->meters[i].value;
    q->meters[i].value = evaluate_meter(q, &q->meters[i]);
  }
  for (size_t i = 0; i < q->count && q->next > 0; i++)
    store_recent(&q->meters[i], q->meters[i].value);
  while (q->next < marks->count && marks->time[q->next] / step <= n + MARK_TOLERANCE) {
    double s = (marks->time[q->next] / step - (n - 1.0)) * (step / h);
    if (s > 1.0 - MARK_TOLERANCE) s = 1.0;
    pass_mark(q, marks->time[q->next], begin, h, from, s, last);
    from = s;
  }
  if (q->next == 0 || q->next >= marks->count) return;
  for (size_t i = 0; i < q->count; i++) {
    meter *m = &q->meters[i];
    double now = m->value, start = from > 0.0 ? last[i] + from * (now - last[i]) : last[i];
    if (from < 1.0) add_interval(m, start, now, begin + from * h, (1.0 - from) * h);
  }
}

/* Fills size, span and noise of all columns over the window. */
static void measure_columns(strut_quantities *q) {
  const strut_columns *c = &q->columns;
  for (size_t i = 0; i < c->count; i++)
    q->sizes[i] = (strut_magnitude){.size = c->largest[i],
                                    .span = strut_columns_span(c, i),
                                    .noise = strut_columns_noise(c, i)};
}

/* The member of the largest force, where the largest one of all was asked for. */
static const char *loaded_member(const strut_quantities *q, const meter *m) {
  const strut_quantity_definition *d = m->definition;
  bool asked = false;
  for (size_t i = 0; i < d->length; i++)
    asked = asked || (d->program[i].operation == STRUT_OPERATION_COLUMN &&
                      d->program[i].column.kind == STRUT_COLUMN_LARGEST_FORCE);
  if (!asked || d->take != STRUT_TAKE_MAX || q->columns.loaded_most < 0) return NULL;
  return q->columns.model->scene->members[q->columns.loaded_most].name;
}

static void fill_measured(strut_quantities *q, meter *m, strut_measured *to) {
  strut_reduction take = m->definition->take;
  bool differs = take == STRUT_TAKE_RANGE || take == STRUT_TAKE_CHANGE || take == STRUT_TAKE_RATE ||
                 take == STRUT_TAKE_RISE;
  bool cancels = take == STRUT_TAKE_MEAN || take == STRUT_TAKE_CHANGE || take == STRUT_TAKE_RATE;
  double per = take == STRUT_TAKE_RATE ? q->time - q->begin : 1.0;
  strut_magnitude made =
      strut_quantity_program_magnitude(m->definition, m->index, q->sizes, q->size_stack);
  double size = fmax(made.size, m->largest);
  if (!isfinite(m->result)) return;
  to->value = m->result;
  to->member = loaded_member(q, m);
  if (take == STRUT_TAKE_ARRIVAL) { /* a time, not a value of the expression */
    to->scale = fabs(m->result);
    return;
  }
  double scale = (differs ? made.span : size) / per;
  if (isfinite(scale)) to->scale = scale;
  double noise = made.noise + (cancels ? CANCELLED : ROUNDED) * size;
  to->zero = fabs(to->value) <= noise / per;
  if (q->by_periods && m->parts > 1) to->spread = sqrt(m->part_square / (double)(m->parts - 1));
}

void strut_quantities_finish(strut_quantities *q, strut_summary *summary) {
  if (q->next < 2) return;
  measure_columns(q);
  for (size_t i = 0; i < q->count && i < summary->measured_count; i++)
    fill_measured(q, &q->meters[i], &summary->measured[i]);
}
