/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What strut does not have in a browser, refused by name: it stands for the files that use these libraries. */
#include <assert.h>

#include "engine/integrate/batch/batch.h"
#include "engine/output/draw/cairo_page.h"
#include "engine/output/page/page.h"
#include "engine/statics/algebra.h"
#include "engine/study/search/optimisers.h"

strut_status strut_cairo_load(const strut_cairo_library **library, strut_error *error) {
  *library = NULL;
  return strut_fail(error, STRUT_USAGE, "strut in a browser draws no figures; use the program strut");
}

char *strut_page_html(const strut_page *page, strut_page_frames *frames, strut_error *error) {
  (void)page;
  (void)frames;
  strut_fail(error, STRUT_USAGE, "strut in a browser writes no pages; it has the data of a page");
  return NULL;
}

/* Small systems do not come here: rigidity and modes solve them by dense matrices. */
strut_status strut_sparse_algebra_load(const strut_sparse_algebra_library **library,
                                       strut_error *error) {
  *library = NULL;
  return strut_fail(error, STRUT_USAGE,
                    "the structure is too large for strut in a browser, which has neither SPQR nor "
                    "ARPACK; use the program strut");
}

bool strut_search_optimise_by_nlopt(const strut_search_task *task, const strut_search_asker *asker) {
  (void)task;
  (void)asker;
  return false; /* no call of the library searches */
}

/* Runs side by side in wide registers: strut_batch_widest says that there are none. */
static void no_batch(const strut_batch *b) {
  (void)b;
  assert(false);
}
void strut_batch_rk4_4(strut_batch *b, int64_t count) { (void)count, no_batch(b); }
void strut_batch_rk4_8(strut_batch *b, int64_t count) { (void)count, no_batch(b); }
void strut_batch_rk4_8_halves(strut_batch *b, int64_t count) { (void)count, no_batch(b); }
