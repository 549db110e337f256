/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/quantities.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/run/measure/meter.h"
#include "engine/scene/signal_program.h"

/* The postfix program of a measured quantity: values, magnitudes, and the branches that kinks divide. */

/* On which side of a kink, or on which step, the operands are. */
static uint64_t branch_of(strut_operation operation, double a, double b, double result) {
  uint64_t step = 0;
  switch ((int)operation) {
    case STRUT_OPERATION_ABS:
    case STRUT_OPERATION_POWER: return a < 0.0; /* an even one has a root with a kink */
    case STRUT_OPERATION_MULTIPLY: return a == b && a < 0.0; /* a square */
    case STRUT_OPERATION_HYPOT: return (uint64_t)(a < 0.0) << 1 | (uint64_t)(b < 0.0);
    case STRUT_OPERATION_MIN:
    case STRUT_OPERATION_MAX: return b < a;
    case STRUT_OPERATION_FLOOR:
    case STRUT_OPERATION_CEIL:
    case STRUT_OPERATION_ROUND:
      result += 0.0; /* of -0, too */
      memcpy(&step, &result, sizeof step);
      return step;
    default: return 0;
  }
}

static const strut_sensitivity sensitivities[] = {
#define STRUT_OPERATION_ROW(id, operands, word, sensitivity) STRUT_SENSITIVITY_##sensitivity,
    STRUT_OPERATION_TABLE(STRUT_OPERATION_ROW)
#undef STRUT_OPERATION_ROW
};

double strut_quantity_program_evaluate(const strut_quantity_definition *definition,
                                       const size_t *index, const double *value, double *stack,
                                       uint64_t *branch) {
  size_t top = 0;
  uint64_t gathered = 0;
  for (size_t i = 0; i < definition->length; i++) {
    const strut_instruction *instruction = &definition->program[i];
    if (instruction->operation == STRUT_OPERATION_NUMBER) {
      stack[top++] = instruction->number;
    } else if (instruction->operation == STRUT_OPERATION_COLUMN) {
      stack[top++] = value[index[i]];
    } else {
      int count = strut_operation_operands(instruction->operation);
      top -= (size_t)count;
      assert(top < definition->depth);
      double a = stack[top], b = count > 1 ? stack[top + 1] : 0.0;
      stack[top] = strut_operation_apply(instruction->operation, a, b);
      if (branch)
        gathered =
            strut_gather_branch(gathered, branch_of(instruction->operation, a, b, stack[top]));
      top++;
    }
  }
  assert(top == 1);
  if (branch) *branch = gathered;
  return stack[0];
}

/* Propagates the uncertainties da and db of the operands to the result. */
static double propagate_uncertainty(strut_operation operation, double a, double b, double da,
                                    double db) {
  switch (sensitivities[operation]) {
    case STRUT_SENSITIVITY_PRODUCT: return a * db + b * da;
    case STRUT_SENSITIVITY_QUOTIENT: return da / b + a * db / (b * b);
    case STRUT_SENSITIVITY_POWER: return a > 0.0 ? fabs(b) * pow(a, b) * da / a : da;
    case STRUT_SENSITIVITY_ROOT: return a > 0.0 ? 0.5 * da / sqrt(a) : sqrt(da);
    case STRUT_SENSITIVITY_EXPONENTIAL: return exp(a) * da;
    case STRUT_SENSITIVITY_LOGARITHM: return a > 0.0 ? da / a : 0.0;
    case STRUT_SENSITIVITY_SUM:
    case STRUT_SENSITIVITY_BOUNDED: break;
  }
  return da + db;
}

/* Between which values a result of this size lies: at the corners where it rises or falls in each operand. */
static void bound_result(strut_operation operation, strut_magnitude a, strut_magnitude b,
                         strut_magnitude *result) {
  strut_sensitivity kind = sensitivities[operation];
  bool corners = operation == STRUT_OPERATION_ADD || operation == STRUT_OPERATION_SUBTRACT ||
                 operation == STRUT_OPERATION_NEGATE || kind == STRUT_SENSITIVITY_PRODUCT ||
                 kind == STRUT_SENSITIVITY_EXPONENTIAL ||
                 (kind == STRUT_SENSITIVITY_QUOTIENT && b.low * b.high > 0.0);
  bool even = operation == STRUT_OPERATION_POWER && fmod(b.low, 2.0) == 0.0 && b.low == b.high;
  result->low = even ? 0.0 : -result->size, result->high = result->size;
  for (int k = 0; k < 4 && corners; k++) {
    double value = strut_operation_apply(operation, k & 1 ? a.low : a.high, k & 2 ? b.low : b.high);
    result->low = k ? fmin(result->low, value) : value;
    result->high = k ? fmax(result->high, value) : value;
  }
}

static strut_magnitude combine_magnitudes(strut_operation operation, strut_magnitude a,
                                          strut_magnitude b) {
  double size = 1.0;
  switch (sensitivities[operation]) {
    case STRUT_SENSITIVITY_EXPONENTIAL:
      a.size = a.high;
      if (a.high <= 1.0) a.noise = a.still; /* what lies further below hardly counts */
      /* fall through */
    case STRUT_SENSITIVITY_PRODUCT:
    case STRUT_SENSITIVITY_QUOTIENT:
    case STRUT_SENSITIVITY_ROOT:
      size = fabs(strut_operation_apply(operation, a.size, b.size));
      break;
    case STRUT_SENSITIVITY_POWER:
      size = fabs(strut_operation_apply(operation, a.size, b.high));
      break;
    case STRUT_SENSITIVITY_SUM: size = fmax(a.size, b.size); break;
    case STRUT_SENSITIVITY_LOGARITHM:
    case STRUT_SENSITIVITY_BOUNDED: break;
  }
  strut_magnitude result = {
      .size = size,
      .span = propagate_uncertainty(operation, a.size, b.size, a.span, b.span),
      .noise = propagate_uncertainty(operation, a.size, b.size, a.noise, b.noise)};
  bool single = a.low == a.high || b.low == b.high; /* beside a constant or nothing */
  bool power = sensitivities[operation] == STRUT_SENSITIVITY_POWER;
  result.still = single ? propagate_uncertainty(operation, power ? fmin(a.size, 1.0) : a.size,
                                                b.size, a.still, b.still)
                        : result.noise;
  bound_result(operation, a, b, &result);
  return result;
}

/* Evaluates the program on magnitudes: sums take the larger size and add range and rounding. */
static strut_magnitude evaluate_magnitude(const strut_quantity_definition *definition,
                                          const size_t *index, const strut_magnitude *value,
                                          strut_magnitude *stack) {
  size_t top = 0;
  for (size_t i = 0; i < definition->length; i++) {
    const strut_instruction *instruction = &definition->program[i];
    if (instruction->operation == STRUT_OPERATION_NUMBER) {
      double number = instruction->number;
      stack[top++] = (strut_magnitude){.size = fabs(number), .low = number, .high = number};
    } else if (instruction->operation == STRUT_OPERATION_COLUMN) {
      stack[top++] = value[index[i]];
    } else {
      int count = strut_operation_operands(instruction->operation);
      strut_magnitude none = {0};
      top -= (size_t)count;
      assert(top < definition->depth);
      stack[top] =
          combine_magnitudes(instruction->operation, stack[top], count > 1 ? stack[top + 1] : none);
      top++;
    }
  }
  assert(top == 1);
  return stack[0];
}

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
static bool needs_inner(const strut_meter *meter) {
  strut_reduction take = meter->definition->take;
  if (take == STRUT_TAKE_MEAN) return meter->rate_of == NONE;
  return take != STRUT_TAKE_FINAL && take != STRUT_TAKE_CHANGE && take != STRUT_TAKE_RATE;
}

static bool make_meter(strut_quantities *quantities, const strut_quantity_definition *definition,
                       const strut_experiment *experiment, strut_arena *arena, strut_meter *meter) {
  double accuracy = experiment->accuracy;
  strut_column primitive;
  *meter = (strut_meter){.definition = definition, .rate_of = NONE};
  meter->index = strut_arena_allocate(arena, definition->length, sizeof *meter->index);
  if (!meter->index) return false;
  for (size_t i = 0; i < definition->length; i++)
    if (definition->program[i].operation == STRUT_OPERATION_COLUMN)
      meter->index[i] = strut_columns_add(&quantities->columns, definition->program[i].column);
  bool mean = definition->length == 1 && definition->take == STRUT_TAKE_MEAN;
  if (mean && find_primitive(definition->program[0].column, &primitive))
    meter->rate_of = strut_columns_add(&quantities->columns, primitive);
  meter->inner = needs_inner(meter);
  meter->exact = experiment->exact_sums && meter->inner && strut_takes_sum(definition);
  meter->accuracy = accuracy > 0.0 ? accuracy : USUAL_ACCURACY;
  quantities->inner = quantities->inner || meter->inner;
  return true;
}

static void see_piece(strut_observer *observer, strut_state *state,
                      const strut_motion_piece *piece);

strut_quantities *strut_quantities_create(const strut_model *model,
                                          const strut_experiment *experiment, strut_arena *arena) {
  size_t columns = 0, depth = 1;
  strut_quantities *quantities = strut_arena_allocate(arena, 1, sizeof *quantities);
  if (!quantities) return NULL;
  for (size_t i = 0; i < experiment->quantity_count; i++) {
    columns += experiment->quantities[i].length + 1;
    if (experiment->quantities[i].depth > depth) depth = experiment->quantities[i].depth;
  }
  quantities->count = experiment->quantity_count;
  quantities->observer.see = see_piece;
  quantities->by_periods = strut_experiment_span(experiment, model->scene).period > 0.0;
  bool ready =
      STRUT_ALLOCATE(arena, STRUT_NEW(quantities->meters, quantities->count),
                     STRUT_NEW(quantities->grid, quantities->count * STRUT_MOST_SAMPLES),
                     STRUT_NEW(quantities->coarse, quantities->count),
                     STRUT_NEW(quantities->stack, depth), STRUT_NEW(quantities->sizes, columns),
                     STRUT_NEW(quantities->size_stack, depth)) &&
      strut_columns_create(model, columns, arena, &quantities->columns) &&
      strut_dense_create(model, arena, &quantities->dense);
  for (size_t i = 0; i < quantities->count && ready; i++)
    ready = make_meter(quantities, &experiment->quantities[i], experiment, arena,
                       &quantities->meters[i]);
  return ready ? quantities : NULL;
}

bool strut_quantities_need_balance(const strut_experiment *experiment) {
  for (size_t i = 0; i < experiment->quantity_count; i++)
    for (size_t k = 0; k < experiment->quantities[i].length; k++) {
      const strut_instruction *instruction = &experiment->quantities[i].program[k];
      if (instruction->operation != STRUT_OPERATION_COLUMN) continue;
      if (strut_observable_at(instruction->column.kind)->need == STRUT_OBSERVED_BALANCE)
        return true;
    }
  return false;
}

bool strut_quantities_need_pieces(const strut_quantities *quantities) { return quantities->inner; }

void strut_quantities_observe(strut_quantities *quantities) { quantities->observed = true; }

/* ---- values at an instant ---- */

/* The row of a place of the grid. */
static double *row_at(const strut_quantities *quantities, int k) {
  return quantities->grid + (size_t)k * quantities->count;
}

static double evaluate_meter(const strut_quantities *quantities, size_t i) {
  strut_meter *meter = &quantities->meters[i];
  const strut_quantity_definition *definition = meter->definition;
  double value = strut_quantity_program_evaluate(
      definition, meter->index, quantities->columns.value, quantities->stack, &meter->seen);
  for (size_t k = 0; k < definition->length; k++)
    if (definition->program[k].operation == STRUT_OPERATION_COLUMN)
      meter->seen =
          strut_gather_branch(meter->seen, (uint64_t)quantities->columns.branch[meter->index[k]]);
  return value;
}

/* Values of all quantities at the fraction s of the piece. */
static void evaluate_at(const motion_part *part, double s, double *row) {
  strut_quantities *quantities = part->quantities;
  double t;
  if (s >= 1.0 && !quantities->dense.away)
    t = part->piece->begin + part->piece->length;
  else
    t = strut_dense_place(&quantities->dense, part->state, part->piece, s);
  strut_columns_evaluate(&quantities->columns, part->state, t);
  for (size_t i = 0; i < quantities->count; i++) row[i] = evaluate_meter(quantities, i);
}

/* One quantity at the fraction `at` of the part. */
static double sample_part(void *context, double at) {
  const motion_part *part = context;
  strut_quantities *quantities = part->quantities;
  double s = part->from + at * (part->to - part->from);
  double t = strut_dense_place(&quantities->dense, part->state, part->piece, s);
  strut_columns_evaluate(&quantities->columns, part->state, t);
  return evaluate_meter(quantities, part->meter);
}

/* Fills the rows of the grid that divide the part into 2^depth. */
static void fill_grid(const motion_part *part, int depth) {
  strut_quantities *quantities = part->quantities;
  int last = STRUT_MOST_SAMPLES - 1, stride = last >> depth;
  for (int k = 0; k <= last; k += stride) {
    if (quantities->known[k]) continue;
    double at = part->from + (part->to - part->from) * k / last;
    evaluate_at(part, at, row_at(quantities, k));
    quantities->known[k] = true;
  }
}

static void copy_samples(const motion_part *part, int depth, strut_samples *samples) {
  const strut_quantities *quantities = part->quantities;
  int stride = (STRUT_MOST_SAMPLES - 1) >> depth;
  samples->count = (1 << depth) + 1;
  for (int k = 0; k < samples->count; k++)
    samples->value[k] = row_at(quantities, k * stride)[part->meter];
}

/* By how much the value in the middle of the part depends on the order of the interpolation. */
static double find_doubt(const motion_part *part) {
  strut_quantities *quantities = part->quantities;
  if (!quantities->coarse_known) {
    quantities->dense.coarse = true;
    evaluate_at(part, 0.5 * (part->from + part->to), quantities->coarse);
    quantities->dense.coarse = false;
    quantities->coarse_known = true;
  }
  return fabs(quantities->coarse[part->meter] -
              row_at(quantities, (STRUT_MOST_SAMPLES - 1) / 2)[part->meter]);
}

/* ---- parts of pieces ---- */

/* Adds a part of the piece, whose value at the begin is m->value, to one quantity. */
static void add_to_meter(motion_part *part, size_t i, double begin) {
  strut_quantities *quantities = part->quantities;
  strut_meter *meter = &quantities->meters[i];
  strut_samples samples = {.begin = begin,
                           .length = (part->to - part->from) * part->piece->length,
                           .sample = sample_part,
                           .context = part};
  double end = row_at(quantities, STRUT_MOST_SAMPLES - 1)[i];
  part->meter = i;
  if (part->piece->ends_only) meter->elapsed = 0.0; /* a straight line */
  if (part->piece->ends_only || strut_meter_is_even(meter, end, samples.length)) {
    strut_meter_add_even(meter, end, begin, samples.length);
    return;
  }
  row_at(quantities, 0)[i] = meter->value;
  int depth = 0;
  do {
    depth++;
    fill_grid(part, depth);
    copy_samples(part, depth, &samples);
    samples.resolved = strut_meter_is_resolved(meter, &samples);
  } while (depth < STRUT_DEEPEST && !samples.resolved);
  if (depth > 1) samples.doubt = find_doubt(part);
  strut_meter_add(meter, &samples);
}

/* Adds a part of the piece without kinks that matter, to whose end values the last row belongs, to all quantities. */
static void add_smooth_part(motion_part *part) {
  strut_quantities *quantities = part->quantities;
  double begin = part->start + part->from * part->piece->length;
  if (!(part->to > part->from)) return;
  memset(quantities->known, 0, sizeof quantities->known);
  quantities->known[0] = quantities->known[STRUT_MOST_SAMPLES - 1] = true;
  quantities->coarse_known = false;
  for (size_t i = 0; i < quantities->count; i++) add_to_meter(part, i, begin);
}

/* Evaluates all at the end of the part: which quantities have a kink in it that matters? */
static bool find_kinks(const motion_part *part) {
  strut_quantities *quantities = part->quantities;
  double *row = row_at(quantities, STRUT_MOST_SAMPLES - 1);
  double length = (part->to - part->from) * part->piece->length;
  bool any = false;
  evaluate_at(part, part->to, row);
  for (size_t i = 0; i < quantities->count; i++) {
    strut_meter *meter = &quantities->meters[i];
    meter->ahead = meter->seen;
    meter->kinked = meter->inner && meter->ahead != meter->branch &&
                    strut_meter_may_turn(meter, row[i], length);
    any = any || meter->kinked;
  }
  return any && !part->piece->ends_only;
}

/* Has one of these kinks been passed at the fraction s of the piece? Values there: `coarse`. */
static bool is_kink_passed(const motion_part *part, double s) {
  const strut_quantities *quantities = part->quantities;
  bool any = false;
  evaluate_at(part, s, quantities->coarse);
  for (size_t i = 0; i < quantities->count; i++)
    any = any || (quantities->meters[i].kinked &&
                  quantities->meters[i].seen != quantities->meters[i].branch);
  return any;
}

/* Adds the part up to the first kink, and moves its begin there. */
static void add_to_kink(motion_part *part) {
  strut_quantities *quantities = part->quantities;
  double low = part->from, high = part->to, end = part->to;
  while (high - low > LOCATED) {
    double middle = 0.5 * (low + high);
    *(is_kink_passed(part, middle) ? &high : &low) = middle;
  }
  part->to = low;
  evaluate_at(part, low, row_at(quantities, STRUT_MOST_SAMPLES - 1));
  add_smooth_part(part);
  (void)is_kink_passed(part, high);
  for (size_t i = 0; i < quantities->count; i++)
    if (quantities->meters[i].kinked && quantities->meters[i].seen != quantities->meters[i].branch)
      strut_meter_jump(&quantities->meters[i], part->start + low * part->piece->length,
                       quantities->coarse[i]);
  part->from = low, part->to = end;
}

/* Adds a part of the piece to all quantities, from kink to kink. */
static void add_part(motion_part *part) {
  strut_quantities *quantities = part->quantities;
  if (!(part->to > part->from)) return;
  for (int k = 0; find_kinks(part) && k < MOST_KINKS; k++) add_to_kink(part);
  add_smooth_part(part);
  for (size_t i = 0; i < quantities->count; i++)
    quantities->meters[i].branch = quantities->meters[i].ahead;
}

static double primitive_of(const strut_quantities *quantities, const strut_meter *meter) {
  return meter->rate_of == NONE ? 0.0 : quantities->columns.value[meter->rate_of];
}

/* Tells who asked for it the values at the next mark. */
static void keep_values(const strut_quantities *quantities, const double *row) {
  size_t count = quantities->count;
  if (quantities->marks.value)
    memcpy(quantities->marks.value + quantities->next * count, row, count * sizeof *row);
}

/* Passes the mark at the fraction s of the piece, up to which it has been added; the first opens the window. */
static void pass_mark(const motion_part *part, double s) {
  strut_quantities *quantities = part->quantities;
  double time = quantities->marks.time[quantities->next], *row = row_at(quantities, 0);
  evaluate_at(part, s, row);
  for (size_t i = 0; i < quantities->count; i++) {
    strut_meter *meter = &quantities->meters[i];
    if (quantities->next > 0)
      strut_meter_mark(meter, time, meter->value, primitive_of(quantities, meter));
    else
      strut_meter_open(meter, time, row[i], primitive_of(quantities, meter));
  }
  keep_values(quantities, row);
  if (quantities->next == 0) quantities->begin = time;
  quantities->time = time;
  quantities->next++;
}

/* Values just after the begin of a piece, which may have jumped there. */
static void pass_jump(const motion_part *part, double time) {
  strut_quantities *quantities = part->quantities;
  evaluate_at(part, 0.0, row_at(quantities, 0));
  for (size_t i = 0; i < quantities->count; i++)
    strut_meter_jump(&quantities->meters[i], time, row_at(quantities, 0)[i]);
}

/* Measures a piece: up to each mark within it, then to its end. */
static void see_piece(strut_observer *observer, strut_state *state,
                      const strut_motion_piece *seen) {
  strut_quantities *quantities = (strut_quantities *)observer;
  strut_motion_piece piece = *seen;
  double begin = piece.begin + (state->time_offset - quantities->marks.offset), h = piece.length;
  motion_part part = {.quantities = quantities, .state = state, .piece = &piece, .start = begin};
  double end = begin + h, near = MARK_TOLERANCE * quantities->marks.step;
  bool smooth = piece.smooth && !quantities->fresh;
  if (quantities->next >= quantities->marks.count) return;
  if (quantities->next > 0 && quantities->inner && !smooth) pass_jump(&part, begin);
  quantities->fresh = false;
  while (quantities->next < quantities->marks.count &&
         quantities->marks.time[quantities->next] <= end + near) {
    double s = (quantities->marks.time[quantities->next] - begin) / h;
    part.to = s * h > h - near ? 1.0 : fmax(s, part.from);
    if (quantities->next > 0) add_part(&part);
    pass_mark(&part, part.to);
    part.from = part.to;
  }
  part.to = 1.0;
  if (quantities->next > 0 && quantities->next < quantities->marks.count) add_part(&part);
  strut_dense_return(&quantities->dense, state, &piece);
  /* a recording may watch the steps of a method without pieces */
  if (quantities->next >= quantities->marks.count && state->watched.observer == observer)
    state->watched.observer = NULL;
}

/* May a mark lie within the next step of the grid? */
static bool mark_is_near(const strut_quantities *quantities, double begin) {
  return quantities->next < quantities->marks.count &&
         quantities->marks.time[quantities->next] <= begin + 1.5 * quantities->marks.step;
}

/* Does a step of the grid matter by its end alone? */
static bool ends_suffice(const strut_quantities *quantities) {
  return !quantities->inner && quantities->next > 0;
}

void strut_quantities_begin(strut_quantities *quantities, const strut_marks *marks,
                            strut_state *state) {
  double t = (double)state->step * marks->step;
  quantities->marks = *marks;
  quantities->next = 0;
  quantities->fresh = true;
  /* what jumps where the window begins has its value from before that, as at its end */
  if (quantities->observed)
    t -= fmax(4.0 * DBL_EPSILON * t, state->step > 0 ? 1e-12 * marks->step : 0.0);
  strut_columns_begin(&quantities->columns, state, t);
  for (size_t i = 0; i < quantities->count; i++) {
    quantities->meters[i].result = (double)NAN;
    quantities->meters[i].parts = 0;
  }
  if (quantities->observed)
    state->watched.observer = &quantities->observer;
  else
    strut_dense_keep(&quantities->dense, state);
  if (fabs(marks->time[0] / marks->step - (double)state->step) >= MARK_TOLERANCE) return;
  for (size_t i = 0; i < quantities->count; i++) {
    strut_meter *meter = &quantities->meters[i];
    double *value = &row_at(quantities, 0)[i];
    *value = evaluate_meter(quantities, i);
    strut_meter_open(meter, marks->time[0], *value, primitive_of(quantities, meter));
  }
  keep_values(quantities, row_at(quantities, 0));
  quantities->begin = quantities->time = marks->time[0];
  quantities->next = 1;
}

void strut_quantities_step(strut_quantities *quantities, double length, strut_state *state) {
  double begin = ((double)state->step - 1.0) * quantities->marks.step;
  if (quantities->observed || quantities->next >= quantities->marks.count)
    return; /* the method has shown it; or it is over */
  if (ends_suffice(quantities) && !mark_is_near(quantities, begin)) {
    strut_columns_evaluate(&quantities->columns, state, begin + length);
    for (size_t i = 0; i < quantities->count; i++)
      strut_meter_add_even(&quantities->meters[i], evaluate_meter(quantities, i), begin, length);
  } else {
    strut_motion_piece piece = strut_dense_step(&quantities->dense, state, begin, length);
    see_piece(&quantities->observer, state, &piece);
  }
  if (!ends_suffice(quantities) || mark_is_near(quantities, begin + length))
    strut_dense_keep(&quantities->dense, state);
}

bool strut_quantity_names_member(const strut_quantity_definition *definition) {
  bool asked = false;
  for (size_t i = 0; i < definition->length; i++)
    asked = asked || (definition->program[i].operation == STRUT_OPERATION_COLUMN &&
                      definition->program[i].column.kind == STRUT_COLUMN_LARGEST_FORCE);
  return asked && definition->take == STRUT_TAKE_MAX;
}

static void fill_measured(strut_quantities *quantities, strut_meter *meter, strut_measured *to) {
  strut_reduction take = meter->definition->take;
  bool differs = take == STRUT_TAKE_RANGE || take == STRUT_TAKE_CHANGE || take == STRUT_TAKE_RATE ||
                 take == STRUT_TAKE_RISE;
  bool cancels = take == STRUT_TAKE_MEAN || take == STRUT_TAKE_CHANGE || take == STRUT_TAKE_RATE;
  strut_magnitude made = evaluate_magnitude(meter->definition, meter->index, quantities->sizes,
                                            quantities->size_stack);
  double size = fmax(made.size, meter->largest), window = quantities->time - quantities->begin;
  double per = take == STRUT_TAKE_RATE ? window : 1.0;
  bool summed = take == STRUT_TAKE_MEAN || take == STRUT_TAKE_RMS;
  to->rounding = (made.noise + (cancels ? CANCELLED : ROUNDED) * size) / per;
  if (take == STRUT_TAKE_ARRIVAL) to->margin = strut_meter_margin(meter);
  if (!isfinite(meter->result)) return;
  to->doubt = meter->doubt / (summed ? window : 1.0);
  to->left = strut_meter_left(meter, window);
  to->value = meter->result;
  int32_t loaded = quantities->columns.loaded; /* where the largest force of all was asked for */
  if (strut_quantity_names_member(meter->definition) && loaded >= 0)
    to->member = quantities->columns.instant.model->scene->members[loaded].name;
  if (take == STRUT_TAKE_ARRIVAL) { /* a time, not a value of the expression */
    to->scale = fabs(meter->result);
    return;
  }
  double scale = (differs ? made.span : size) / per;
  if (isfinite(scale)) to->scale = scale;
  to->zero = fabs(to->value) <= to->rounding;
  if (quantities->by_periods && meter->parts > 1)
    to->spread = sqrt(meter->part_square / (double)(meter->parts - 1));
}

void strut_quantities_finish(strut_quantities *quantities, strut_summary *summary) {
  if (quantities->next < 2) return;
  const strut_columns *columns = &quantities->columns;
  for (size_t i = 0; i < columns->count; i++) /* over the window */
    quantities->sizes[i] = (strut_magnitude){.size = columns->largest[i],
                                             .low = columns->least[i],
                                             .high = columns->most[i],
                                             .span = strut_columns_span(columns, i),
                                             .noise = strut_columns_noise(columns, i),
                                             .still = strut_columns_noise(columns, i)};
  for (size_t i = 0; i < quantities->count && i < summary->measured_count; i++)
    fill_measured(quantities, &quantities->meters[i], &summary->measured[i]);
}
