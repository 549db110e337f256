/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_slots FILE: CPU time of a row of a study's results, written, found again and tabled (here). */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "engine/study/results/slots.h"
#include "engine/study/results/study_table.h"

enum { POINTS = 1000000, NUMBERS = 14 };

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void tell(const char *what, double begin) {
  printf("%-8s %6.3f us a point\n", what, 1e6 * (now() - begin) / POINTS);
}

static strut_status write_all(strut_slots *slots, strut_error *error) {
  strut_status status = STRUT_OK;
  double numbers[NUMBERS] = {0};
  char words[1][STRUT_SLOT_WORD] = {"periodic"};
  for (int64_t i = 0; i < POINTS && status == STRUT_OK; i++) {
    for (int k = 0; k < NUMBERS; k++) numbers[k] = sin((double)(i + k));
    strut_result_slot row = {STRUT_OK, numbers, (const char(*)[STRUT_SLOT_WORD])words, NULL};
    status = strut_slots_put(slots, i, &row, error);
  }
  return status;
}

static strut_status measure(const char *path, strut_error *error) {
  strut_slot_column columns[NUMBERS + 1] = {{"motion", "", true}};
  for (int i = 1; i <= NUMBERS; i++) columns[i] = (strut_slot_column){"velocity", "m/s", false};
  strut_slots_description plan = {.version = "",
                                  .name = "",
                                  .points = POINTS,
                                  .count = POINTS,
                                  .columns = columns,
                                  .column_count = NUMBERS + 1};
  strut_slots *slots = NULL;
  unlink(path);
  strut_status status = strut_slots_open(path, &plan, &slots, error);
  double begin = now();
  if (status == STRUT_OK) status = write_all(slots, error);
  tell("written", begin);
  strut_slots_close(slots);
  slots = NULL;
  begin = now();
  if (status == STRUT_OK) status = strut_slots_read(path, &slots, &plan, error);
  tell("found", begin);
  begin = now();
  if (status == STRUT_OK)
    status = strut_study_table_write(".", "bench_slots.csv", &slots, 1, error);
  tell("tabled", begin);
  unlink("bench_slots.csv");
  strut_slots_close(slots);
  return status;
}

int main(int argc, char **argv) {
  strut_error error = {0};
  if (argc != 2) {
    fprintf(stderr, "usage: bench_slots FILE\n");
    return 1;
  }
  strut_status status = measure(argv[1], &error);
  unlink(argv[1]);
  if (status != STRUT_OK) fprintf(stderr, "%s\n", error.message);
  struct rusage usage;
  if (getrusage(RUSAGE_SELF, &usage) == 0) printf("memory   %6ld kB\n", usage.ru_maxrss);
  return strut_status_exit_code(status);
}
