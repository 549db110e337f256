/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/quantities.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/run/measure/meter.h"

/* ---- quantities over a window ---- */

/* A mark this close to the end of a step, in steps, counts as being there. */
static const double MARK_TOLERANCE = 1e-6;

/* To what extremes are resolved where no accuracy is asked for [1]. */
static const double USUAL_ACCURACY = 1e-3;

/* A kink is located to this part of a piece; and how many of them in one, at most. */
static const double LOCATED = 1e-12;
enum { MOST_KINKS = 16 };

/* Results below these parts of their terms are rounding: of differences, and of others. */
static const double CANCELLED = 1e-10, ROUNDED = 1e-15;

struct strut_quantities {
  strut_observer observer; /* first: this is what the state knows */
  strut_columns columns;
  strut_dense dense;
  strut_marks marks;
  size_t count, next; /* of quantities; the next mark to pass */
  double time;        /* of the latest mark passed [s] */
  double begin;       /* of the first */
  bool by_periods;
  bool inner;                          /* some quantity needs what happens between steps */
  bool observed;                       /* and the method shows it */
  bool fresh;                          /* nothing has been seen since the window was begun */
  strut_meter *meters;                 /* (count) */
  double *stack;                       /* (depth) */
  strut_magnitude *sizes, *size_stack; /* (columns), (depth) */
  /* the part of a piece under way: values of all quantities at equal distances, row by row */
  double *grid;                   /* (STRUT_MOST_SAMPLES, count) */
  bool known[STRUT_MOST_SAMPLES]; /* which rows are filled */
  double *coarse;                 /* (count) in the middle, by polynomials of one order less */
  bool coarse_known;
};

/* A part of a piece of the motion: fractions of it. */
typedef struct motion_part {
  strut_quantities *quantities;
  strut_state *state;
  strut_motion_piece *piece;
  double from, to;
  double start; /* time of the piece [s] */
  size_t meter; /* whose samples are asked for */
} motion_part;

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

/* Does what happens between steps matter? */
static bool needs_inner(const strut_meter *m) {
  switch (m->definition->take) {
    case STRUT_TAKE_MEAN: return m->rate_of == NONE;
    case STRUT_TAKE_FINAL:
    case STRUT_TAKE_CHANGE:
    case STRUT_TAKE_RATE: return false;
    case STRUT_TAKE_MIN:
    case STRUT_TAKE_MAX:
    case STRUT_TAKE_RANGE:
    case STRUT_TAKE_RMS:
    case STRUT_TAKE_RISE:
    case STRUT_TAKE_ARRIVAL: break;
  }
  return true;
}

static bool make_meter(strut_quantities *q, const strut_quantity_definition *d, double accuracy,
                       strut_arena *arena, strut_meter *m) {
  strut_column primitive;
  *m = (strut_meter){.definition = d, .rate_of = NONE};
  m->index = strut_arena_allocate(arena, d->length, sizeof *m->index);
  if (!m->index) return false;
  for (size_t i = 0; i < d->length; i++)
    if (d->program[i].operation == STRUT_OPERATION_COLUMN)
      m->index[i] = strut_columns_add(&q->columns, d->program[i].column);
  bool mean = d->length == 1 && d->take == STRUT_TAKE_MEAN;
  if (mean && find_primitive(d->program[0].column, &primitive))
    m->rate_of = strut_columns_add(&q->columns, primitive);
  m->inner = needs_inner(m);
  m->accuracy = accuracy > 0.0 ? accuracy : USUAL_ACCURACY;
  q->inner = q->inner || m->inner;
  return true;
}

static void see_piece(strut_observer *observer, strut_state *state,
                      const strut_motion_piece *piece);

strut_quantities *strut_quantities_create(const strut_model *model, const strut_experiment *e,
                                          strut_arena *arena) {
  size_t columns = 0, depth = 1;
  strut_quantities *q = strut_arena_allocate(arena, 1, sizeof *q);
  if (!q) return NULL;
  for (size_t i = 0; i < e->quantity_count; i++) {
    columns += e->quantities[i].length + 1;
    if (e->quantities[i].depth > depth) depth = e->quantities[i].depth;
  }
  q->count = e->quantity_count;
  q->observer.see = see_piece;
  q->by_periods = strut_experiment_span(e, model->scene).period > 0.0;
  q->meters = strut_arena_allocate(arena, q->count, sizeof *q->meters);
  q->grid = strut_arena_allocate(arena, q->count * STRUT_MOST_SAMPLES, sizeof *q->grid);
  q->coarse = strut_arena_allocate(arena, q->count, sizeof *q->coarse);
  q->stack = strut_arena_allocate(arena, depth, sizeof *q->stack);
  q->sizes = strut_arena_allocate(arena, columns, sizeof *q->sizes);
  q->size_stack = strut_arena_allocate(arena, depth, sizeof *q->size_stack);
  bool ready = q->meters && q->grid && q->coarse && q->stack && q->sizes && q->size_stack &&
               strut_columns_create(model, columns, arena, &q->columns) &&
               strut_dense_create(model, arena, &q->dense);
  for (size_t i = 0; i < q->count && ready; i++)
    ready = make_meter(q, &e->quantities[i], e->accuracy, arena, &q->meters[i]);
  return ready ? q : NULL;
}

bool strut_quantities_need_balance(const strut_experiment *e) {
  for (size_t i = 0; i < e->quantity_count; i++)
    for (size_t k = 0; k < e->quantities[i].length; k++) {
      const strut_instruction *p = &e->quantities[i].program[k];
      if (p->operation != STRUT_OPERATION_COLUMN) continue;
      if (strut_observable_at(p->column.kind)->need == STRUT_OBSERVED_BALANCE) return true;
    }
  return false;
}

bool strut_quantities_need_pieces(const strut_quantities *q) { return q->inner; }

void strut_quantities_observe(strut_quantities *q) { q->observed = true; }

/* ---- values at an instant ---- */

/* The row of a place of the grid. */
static double *row_at(const strut_quantities *q, int k) { return q->grid + (size_t)k * q->count; }

static double evaluate_meter(const strut_quantities *q, size_t i) {
  strut_meter *m = &q->meters[i];
  const strut_quantity_definition *d = m->definition;
  double value = strut_quantity_program_evaluate(d, m->index, q->columns.value, q->stack, &m->seen);
  for (size_t k = 0; k < d->length; k++)
    if (d->program[k].operation == STRUT_OPERATION_COLUMN)
      m->seen = strut_gather_branch(m->seen, (uint64_t)q->columns.branch[m->index[k]]);
  return value;
}

/* Values of all quantities at the fraction s of the piece. */
static void evaluate_at(const motion_part *part, double s, double *row) {
  strut_quantities *q = part->quantities;
  double t;
  if (s >= 1.0 && !q->dense.away)
    t = part->piece->begin + part->piece->length;
  else
    t = strut_dense_place(&q->dense, part->state, part->piece, s);
  strut_columns_evaluate(&q->columns, part->state, t);
  for (size_t i = 0; i < q->count; i++) row[i] = evaluate_meter(q, i);
}

/* One quantity at the fraction `at` of the part. */
static double sample_part(void *context, double at) {
  const motion_part *part = context;
  strut_quantities *q = part->quantities;
  double s = part->from + at * (part->to - part->from);
  double t = strut_dense_place(&q->dense, part->state, part->piece, s);
  strut_columns_evaluate(&q->columns, part->state, t);
  return evaluate_meter(q, part->meter);
}

/* Fills the rows of the grid that divide the part into 2^depth. */
static void fill_grid(const motion_part *part, int depth) {
  strut_quantities *q = part->quantities;
  int last = STRUT_MOST_SAMPLES - 1, stride = last >> depth;
  for (int k = 0; k <= last; k += stride) {
    if (q->known[k]) continue;
    double at = part->from + (part->to - part->from) * k / last;
    evaluate_at(part, at, row_at(q, k));
    q->known[k] = true;
  }
}

static void copy_samples(const motion_part *part, int depth, strut_samples *samples) {
  const strut_quantities *q = part->quantities;
  int stride = (STRUT_MOST_SAMPLES - 1) >> depth;
  samples->count = (1 << depth) + 1;
  for (int k = 0; k < samples->count; k++) samples->value[k] = row_at(q, k * stride)[part->meter];
}

/* By how much the value in the middle of the part depends on the order of the interpolation. */
static double find_doubt(const motion_part *part) {
  strut_quantities *q = part->quantities;
  if (!q->coarse_known) {
    q->dense.coarse = true;
    evaluate_at(part, 0.5 * (part->from + part->to), q->coarse);
    q->dense.coarse = false;
    q->coarse_known = true;
  }
  return fabs(q->coarse[part->meter] - row_at(q, (STRUT_MOST_SAMPLES - 1) / 2)[part->meter]);
}

/* ---- parts of pieces ---- */

/* Adds a part of the piece, whose value at the begin is m->value, to one quantity. */
static void add_to_meter(motion_part *part, size_t i, double begin) {
  strut_quantities *q = part->quantities;
  strut_meter *m = &q->meters[i];
  strut_samples samples = {.begin = begin,
                           .length = (part->to - part->from) * part->piece->length,
                           .sample = sample_part,
                           .context = part};
  double end = row_at(q, STRUT_MOST_SAMPLES - 1)[i];
  part->meter = i;
  if (part->piece->ends_only) m->elapsed = 0.0; /* a straight line */
  if (part->piece->ends_only || strut_meter_is_even(m, end, samples.length)) {
    strut_meter_add_even(m, end, begin, samples.length);
    return;
  }
  row_at(q, 0)[i] = m->value;
  int depth = 0;
  do {
    depth++;
    fill_grid(part, depth);
    copy_samples(part, depth, &samples);
  } while (depth < STRUT_DEEPEST && !strut_meter_is_resolved(m, &samples));
  if (depth > 1) samples.doubt = find_doubt(part);
  strut_meter_add(m, &samples);
}

/* Adds a part of the piece without kinks that matter, to whose end values the last row belongs, to all quantities. */
static void add_smooth_part(motion_part *part) {
  strut_quantities *q = part->quantities;
  double begin = part->start + part->from * part->piece->length;
  if (!(part->to > part->from)) return;
  memset(q->known, 0, sizeof q->known);
  q->known[0] = q->known[STRUT_MOST_SAMPLES - 1] = true;
  q->coarse_known = false;
  for (size_t i = 0; i < q->count; i++) add_to_meter(part, i, begin);
}

/* Evaluates all at the end of the part: which quantities have a kink in it that matters? */
static bool find_kinks(const motion_part *part) {
  strut_quantities *q = part->quantities;
  double *row = row_at(q, STRUT_MOST_SAMPLES - 1);
  double length = (part->to - part->from) * part->piece->length;
  bool any = false;
  evaluate_at(part, part->to, row);
  for (size_t i = 0; i < q->count; i++) {
    strut_meter *m = &q->meters[i];
    m->ahead = m->seen;
    m->kinked = m->inner && m->ahead != m->branch && strut_meter_may_turn(m, row[i], length);
    any = any || m->kinked;
  }
  return any && !part->piece->ends_only;
}

/* Has one of these kinks been passed at the fraction s of the piece? Values there: `coarse`. */
static bool is_kink_passed(const motion_part *part, double s) {
  const strut_quantities *q = part->quantities;
  bool any = false;
  evaluate_at(part, s, q->coarse);
  for (size_t i = 0; i < q->count; i++)
    any = any || (q->meters[i].kinked && q->meters[i].seen != q->meters[i].branch);
  return any;
}

/* Adds the part up to the first kink, and moves its begin there. */
static void add_to_kink(motion_part *part) {
  strut_quantities *q = part->quantities;
  double low = part->from, high = part->to, end = part->to;
  while (high - low > LOCATED) {
    double middle = 0.5 * (low + high);
    *(is_kink_passed(part, middle) ? &high : &low) = middle;
  }
  part->to = low;
  evaluate_at(part, low, row_at(q, STRUT_MOST_SAMPLES - 1));
  add_smooth_part(part);
  (void)is_kink_passed(part, high);
  for (size_t i = 0; i < q->count; i++)
    if (q->meters[i].kinked && q->meters[i].seen != q->meters[i].branch)
      strut_meter_jump(&q->meters[i], part->start + low * part->piece->length, q->coarse[i]);
  part->from = low, part->to = end;
}

/* Adds a part of the piece to all quantities, from kink to kink. */
static void add_part(motion_part *part) {
  strut_quantities *q = part->quantities;
  if (!(part->to > part->from)) return;
  for (int k = 0; find_kinks(part) && k < MOST_KINKS; k++) add_to_kink(part);
  add_smooth_part(part);
  for (size_t i = 0; i < q->count; i++) q->meters[i].branch = q->meters[i].ahead;
}

static double primitive_of(const strut_quantities *q, const strut_meter *m) {
  return m->rate_of == NONE ? 0.0 : q->columns.value[m->rate_of];
}

/* Passes the mark at the fraction s of the piece, up to which it has been added; the first opens the window. */
static void pass_mark(const motion_part *part, double s) {
  strut_quantities *q = part->quantities;
  double time = q->marks.time[q->next], *row = row_at(q, 0);
  evaluate_at(part, s, row);
  for (size_t i = 0; i < q->count; i++) {
    strut_meter *m = &q->meters[i];
    if (q->next > 0)
      strut_meter_mark(m, time, m->value, primitive_of(q, m));
    else
      strut_meter_open(m, time, row[i], primitive_of(q, m));
  }
  if (q->next == 0) q->begin = time;
  q->time = time;
  q->next++;
}

/* Values just after the begin of a piece, which may have jumped there. */
static void pass_jump(const motion_part *part, double time) {
  strut_quantities *q = part->quantities;
  evaluate_at(part, 0.0, row_at(q, 0));
  for (size_t i = 0; i < q->count; i++) strut_meter_jump(&q->meters[i], time, row_at(q, 0)[i]);
}

/* Measures a piece: up to each mark within it, then to its end. */
static void see_piece(strut_observer *observer, strut_state *state,
                      const strut_motion_piece *seen) {
  strut_quantities *q = (strut_quantities *)observer;
  strut_motion_piece piece = *seen;
  double begin = piece.begin + (state->time_offset - q->marks.offset), h = piece.length;
  motion_part part = {.quantities = q, .state = state, .piece = &piece, .start = begin};
  double end = begin + h, near = MARK_TOLERANCE * q->marks.step;
  bool smooth = piece.smooth && !q->fresh;
  if (q->next >= q->marks.count) return;
  if (q->next > 0 && q->inner && !smooth) pass_jump(&part, begin);
  q->fresh = false;
  while (q->next < q->marks.count && q->marks.time[q->next] <= end + near) {
    double s = (q->marks.time[q->next] - begin) / h;
    part.to = s * h > h - near ? 1.0 : fmax(s, part.from);
    if (q->next > 0) add_part(&part);
    pass_mark(&part, part.to);
    part.from = part.to;
  }
  part.to = 1.0;
  if (q->next > 0 && q->next < q->marks.count) add_part(&part);
  strut_dense_return(&q->dense, state, &piece);
  if (q->next >= q->marks.count) state->watched.observer = NULL;
}

/* May a mark lie within the next step of the grid? */
static bool mark_is_near(const strut_quantities *q, double begin) {
  return q->next < q->marks.count && q->marks.time[q->next] <= begin + 1.5 * q->marks.step;
}

/* Does a step of the grid matter by its end alone? */
static bool ends_suffice(const strut_quantities *q) { return !q->inner && q->next > 0; }

void strut_quantities_begin(strut_quantities *q, const strut_marks *marks, strut_state *state) {
  double t = (double)state->step * marks->step;
  q->marks = *marks;
  q->next = 0;
  q->fresh = true;
  /* what jumps where the window begins has its value from before that, as at its end */
  if (q->observed) t -= fmax(4.0 * DBL_EPSILON * t, state->step > 0 ? 1e-12 * marks->step : 0.0);
  strut_columns_begin(&q->columns, state, t);
  for (size_t i = 0; i < q->count; i++) {
    q->meters[i].result = (double)NAN;
    q->meters[i].parts = 0;
  }
  if (q->observed)
    state->watched.observer = &q->observer;
  else
    strut_dense_keep(&q->dense, state);
  if (fabs(marks->time[0] / marks->step - (double)state->step) >= MARK_TOLERANCE) return;
  for (size_t i = 0; i < q->count; i++) {
    strut_meter *m = &q->meters[i];
    strut_meter_open(m, marks->time[0], evaluate_meter(q, i), primitive_of(q, m));
  }
  q->begin = q->time = marks->time[0];
  q->next = 1;
}

void strut_quantities_step(strut_quantities *q, double length, strut_state *state) {
  double begin = ((double)state->step - 1.0) * q->marks.step;
  if (q->observed || q->next >= q->marks.count) return; /* the method has shown it; or it is over */
  if (ends_suffice(q) && !mark_is_near(q, begin)) {
    strut_columns_evaluate(&q->columns, state, begin + length);
    for (size_t i = 0; i < q->count; i++)
      strut_meter_add_even(&q->meters[i], evaluate_meter(q, i), begin, length);
  } else {
    strut_motion_piece piece = strut_dense_step(&q->dense, state, begin, length);
    see_piece(&q->observer, state, &piece);
  }
  if (!ends_suffice(q) || mark_is_near(q, begin + length)) strut_dense_keep(&q->dense, state);
}

/* Fills size, span and noise of all columns over the window. */
static void measure_columns(strut_quantities *q) {
  const strut_columns *c = &q->columns;
  for (size_t i = 0; i < c->count; i++)
    q->sizes[i] = (strut_magnitude){.size = c->largest[i],
                                    .span = strut_columns_span(c, i),
                                    .noise = strut_columns_noise(c, i)};
}

bool strut_quantity_names_member(const strut_quantity_definition *d) {
  bool asked = false;
  for (size_t i = 0; i < d->length; i++)
    asked = asked || (d->program[i].operation == STRUT_OPERATION_COLUMN &&
                      d->program[i].column.kind == STRUT_COLUMN_LARGEST_FORCE);
  return asked && d->take == STRUT_TAKE_MAX;
}

/* The member of the largest force, where the largest one of all was asked for. */
static const char *loaded_member(const strut_quantities *q, const strut_meter *m) {
  if (!strut_quantity_names_member(m->definition) || q->columns.loaded < 0) return NULL;
  return q->columns.instant.model->scene->members[q->columns.loaded].name;
}

static void fill_measured(strut_quantities *q, strut_meter *m, strut_measured *to) {
  strut_reduction take = m->definition->take;
  bool differs = take == STRUT_TAKE_RANGE || take == STRUT_TAKE_CHANGE || take == STRUT_TAKE_RATE ||
                 take == STRUT_TAKE_RISE;
  bool cancels = take == STRUT_TAKE_MEAN || take == STRUT_TAKE_CHANGE || take == STRUT_TAKE_RATE;
  strut_magnitude made =
      strut_quantity_program_magnitude(m->definition, m->index, q->sizes, q->size_stack);
  double size = fmax(made.size, m->largest), window = q->time - q->begin;
  double per = take == STRUT_TAKE_RATE ? window : 1.0;
  bool summed = take == STRUT_TAKE_MEAN || take == STRUT_TAKE_RMS;
  to->rounding = (made.noise + (cancels ? CANCELLED : ROUNDED) * size) / per;
  if (take == STRUT_TAKE_ARRIVAL) to->margin = strut_meter_margin(m);
  if (!isfinite(m->result)) return;
  to->doubt = m->doubt / (summed ? window : 1.0);
  to->left = strut_meter_left(m);
  to->value = m->result;
  to->member = loaded_member(q, m);
  if (take == STRUT_TAKE_ARRIVAL) { /* a time, not a value of the expression */
    to->scale = fabs(m->result);
    return;
  }
  double scale = (differs ? made.span : size) / per;
  if (isfinite(scale)) to->scale = scale;
  to->zero = fabs(to->value) <= to->rounding;
  if (q->by_periods && m->parts > 1) to->spread = sqrt(m->part_square / (double)(m->parts - 1));
}

void strut_quantities_finish(strut_quantities *q, strut_summary *summary) {
  if (q->next < 2) return;
  measure_columns(q);
  for (size_t i = 0; i < q->count && i < summary->measured_count; i++)
    fill_measured(q, &q->meters[i], &summary->measured[i]);
}
