/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens, runs and closes again and again, for valgrind: abi_rounds COUNT. */
#include "tests/abi/attempts.h"

static int go_round(strutlib_scene *scene) {
  for (int i = 0; i < ATTEMPTS; i++) {
    strutlib_error *error = NULL;
    bool good = attempts[i].call(scene, &error);
    if (!good) fprintf(stderr, "%s: %s", attempts[i].name, strutlib_error_report(error));
    strutlib_error_free(error);
    if (!good) return 1;
  }
  return 0;
}

int main(int count, char **arguments) {
  strutlib_scene *scene = attempts_begin();
  int bad = !scene;
  for (int i = count == 2 ? atoi(arguments[1]) : 1; i > 0 && !bad; i--) bad = go_round(scene);
  return !attempts_end(scene) || bad;
}
