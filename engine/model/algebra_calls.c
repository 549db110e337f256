/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/algebra_calls.h"

#include <pthread.h>

const void *strut_algebra_loaded;

strut_status strut_algebra_load(strut_error *error) {
  return strut_library_load(&strut_algebra_loaded, strut_algebra_table_find,
                            sizeof(strut_algebra_library), error);
}

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int inside, threads_before;

void strut_algebra_begin(void) {
  if (!strut_algebra->set_threads || !strut_algebra->get_threads) return;
  pthread_mutex_lock(&lock);
  if (inside++ == 0) {
    threads_before = strut_algebra->get_threads();
    strut_algebra->set_threads(1);
  }
  pthread_mutex_unlock(&lock);
}

void strut_algebra_end(void) {
  if (!strut_algebra->set_threads || !strut_algebra->get_threads) return;
  pthread_mutex_lock(&lock);
  if (--inside == 0) strut_algebra->set_threads(threads_before);
  pthread_mutex_unlock(&lock);
}
