/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/bench/scenes.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

#include "parser/language/read/read_scene.h"

strut_status bench_read(strut_setup *setup, const char *file, const char *const *set,
                        strut_error *error) {
  char path[1000], names[3][40], *text = NULL;
  strut_setting overrides[3];
  size_t count = 0, length = 0;
  strut_diagnostics diagnostics = {0};
  for (; count < 3 && set[count]; count++) {
    const char *equals = strchr(set[count], '=');
    snprintf(names[count], sizeof names[count], "%.*s", (int)(equals - set[count]), set[count]);
    overrides[count] = (strut_setting){.name = names[count], .text = equals + 1};
  }
  snprintf(path, sizeof path, "%s/../%s", STRUT_TESTS_DIR, file);
  strut_status status = strut_file_read(path, &text, &length, error);
  if (status == STRUT_OK) {
    status =
        strut_setup_read(setup, path, text, length, overrides, count, STRUT_FOR_RUN, &diagnostics);
    if (status != STRUT_OK) strut_fail(error, status, "%s is not a valid scene", path);
  }
  strut_diagnostics_free(&diagnostics);
  strut_release(text);
  return status;
}

bool bench_crawler(bench_motion *m, const char *method, double step) {
  strut_error error = {0};
  *m = (bench_motion){.method = strut_integrator_find(method)};
  strut_status status =
      bench_read(&m->setup, "tests/golden/crawler.yaml", (const char *[]){NULL}, &error);
  strut_integrator_settings settings = strut_integrator_settings_of(&m->setup.experiment);
  settings.step = step;
  if (status == STRUT_OK) status = strut_model_compile(&m->setup.scene, &m->model, &error);
  if (status == STRUT_OK) status = strut_state_create(m->model, &m->state, &error);
  if (status == STRUT_OK) m->workspace = m->method->create(m->model, m->state, &settings);
  if (m->workspace) {
    strut_state_reset(m->model, m->state);
    return true;
  }
  fprintf(stderr, "strut_bench: %s: %s\n", strut_status_text(status), error.message);
  bench_free(m);
  return false;
}

void bench_free(bench_motion *m) {
  strut_state_free(m->state);
  strut_model_free(m->model);
  strut_setup_free(&m->setup);
}

double bench_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
