/* SPDX-License-Identifier: GPL-3.0-or-later */
/* unpack_cases FOLDER INTO [--messages]: writes each case of the documents of FOLDER as INTO/NAME.yaml, and
   its messages as INTO/NAME.expect, for fuzzers and for tests of the program. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/language/cases.h"

static bool write_messages(const faulty_case *c, const char *folder) {
  char path[600];
  snprintf(path, sizeof path, "%s/%s.expect", folder, c->name);
  FILE *file = fopen(path, "w");
  for (size_t i = 0; file && i < c->message_count; i++) fprintf(file, "%s\n", c->message[i]);
  return file && fclose(file) == 0;
}

int main(int count, char **words) {
  bool messages = count == 4 && strcmp(words[3], "--messages") == 0, written = true;
  if (count != 3 && !messages) {
    fprintf(stderr, "usage: unpack_cases FOLDER INTO [--messages]\n");
    return EXIT_FAILURE;
  }
  faulty_cases cases = read_faulty_cases(words[1]);
  for (size_t i = 0; i < cases.count && written; i++) {
    const faulty_case *c = &cases.items[i];
    if (c->is_base) continue;
    written = write_faulty_case(c, words[2]) && (!messages || write_messages(c, words[2]));
  }
  free_faulty_cases(&cases);
  return written ? EXIT_SUCCESS : EXIT_FAILURE;
}
