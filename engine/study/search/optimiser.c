/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/search/optimiser.h"

#include "engine/base/memory.h"
#include "engine/study/search/cma.h"

/* Generations are multiples of this, on any machine, so that they fill lanes or processors. */
enum { SIDE_BY_SIDE = 8 };

/* CMA-ES: asks for a generation at a time. */
static bool optimise_by_cma(const strut_search_task *task, const strut_search_asker *asker) {
  const strut_cma_options options = {.dimension = task->dimension,
                                     .start = task->start,
                                     .multiple = SIDE_BY_SIDE,
                                     .seed = task->seed};
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
  return task->method == STRUT_SEARCH_CMA ? optimise_by_cma(task, asker)
                                          : strut_search_optimise_by_nlopt(task, asker);
}
