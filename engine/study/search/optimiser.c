/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/search/optimiser.h"

#include <math.h>

#include "engine/base/memory.h"
#include "engine/study/search/cma.h"

/* Generations are multiples of this, on any machine, so that they fill lanes or processors. */
enum { SIDE_BY_SIDE = 8 };

/* CMA-ES: asks for a generation at a time. */
static bool optimise_by_cma(const strut_search_task *task, const strut_search_asker *asker) {
  const strut_cma_options options = {.dimension = task->dimension,
                                     .start = task->start,
                                     .multiple = SIDE_BY_SIDE,
                                     .seed = task->seed,
                                     .wraps = task->wraps};
  strut_cma *cma = NULL;
  if (strut_cma_create(&options, &cma, NULL)) return false;
  size_t count = strut_cma_population(cma);
  double *values = strut_allocate(count, sizeof *values);
  bool more = values != NULL;
  while (more && !strut_cma_stopped(cma)) {
    more = asker->ask(asker->context, count, strut_cma_ask(cma), values, NULL);
    if (more) strut_cma_tell(cma, values);
  }
  bool fine = values != NULL;
  strut_release(values);
  strut_cma_free(cma);
  return fine;
}

bool strut_search_optimise(const strut_search_task *task, const strut_search_asker *asker) {
  switch (task->method) {
    case STRUT_SEARCH_CMA: return optimise_by_cma(task, asker);
    case STRUT_SEARCH_NSGA2: return strut_search_optimise_by_nsga2(task, asker);
    case STRUT_SEARCH_CRS2:
    case STRUT_SEARCH_DIRECT:
    case STRUT_SEARCH_ISRES:
    case STRUT_SEARCH_COBYLA:
    case STRUT_SEARCH_BOBYQA:
    case STRUT_SEARCH_SBPLX:
    case STRUT_SEARCH_NELDERMEAD:
    case STRUT_SEARCH_MULTISTART: return strut_search_optimise_by_nlopt(task, asker);
    case STRUT_SEARCH_METHOD_COUNT: break;
  }
  return true;
}

double strut_search_share(uint64_t *state) {
  uint64_t z = (*state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  z ^= z >> 31;
  return ((double)(z >> 11) + 0.5) * 0x1p-53;
}

strut_search_spread strut_search_spread_begin(size_t dimension, uint64_t seed) {
  strut_search_spread spread = {.golden = 2.0, .seed = seed};
  for (int i = 0; i < 60; i++)
    spread.golden = pow(1.0 + spread.golden, 1.0 / ((double)dimension + 1.0));
  return spread;
}

double strut_search_spread_at(const strut_search_spread *spread, int64_t i, size_t k) {
  uint64_t state = spread->seed + k * 0x9e3779b97f4a7c15u; /* the k-th number after the seed */
  double at = strut_search_share(&state) + (double)i * pow(spread->golden, -(double)(k + 1));
  return at - floor(at);
}
