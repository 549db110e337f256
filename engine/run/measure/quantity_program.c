/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The postfix program of a measured quantity: values, magnitudes, and the branches that kinks divide. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/run/measure/quantities.h"
#include "engine/scene/signal_program.h"

/* On which side of a kink, or on which step, the operands are. */
static uint64_t branch_of(strut_operation operation, double a, double b, double result) {
  uint64_t step = 0;
  switch ((int)operation) {
    case STRUT_OPERATION_ABS: return a < 0.0;
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

static strut_magnitude combine_magnitudes(strut_operation operation, strut_magnitude a,
                                          strut_magnitude b) {
  double size = 1.0;
  switch (sensitivities[operation]) {
    case STRUT_SENSITIVITY_PRODUCT:
    case STRUT_SENSITIVITY_QUOTIENT:
    case STRUT_SENSITIVITY_POWER:
    case STRUT_SENSITIVITY_ROOT:
    case STRUT_SENSITIVITY_EXPONENTIAL:
      size = fabs(strut_operation_apply(operation, a.size, b.size));
      break;
    case STRUT_SENSITIVITY_SUM: size = fmax(a.size, b.size); break;
    case STRUT_SENSITIVITY_LOGARITHM:
    case STRUT_SENSITIVITY_BOUNDED: break;
  }
  return (strut_magnitude){size, propagate_uncertainty(operation, a.size, b.size, a.span, b.span),
                           propagate_uncertainty(operation, a.size, b.size, a.noise, b.noise)};
}

strut_magnitude strut_quantity_program_magnitude(const strut_quantity_definition *definition,
                                                 const size_t *index, const strut_magnitude *value,
                                                 strut_magnitude *stack) {
  size_t top = 0;
  for (size_t i = 0; i < definition->length; i++) {
    const strut_instruction *instruction = &definition->program[i];
    if (instruction->operation == STRUT_OPERATION_NUMBER) {
      stack[top++] = (strut_magnitude){.size = fabs(instruction->number)};
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
