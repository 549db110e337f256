/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * libFuzzer: any bytes as a file to import. The first byte chooses the format. Aborts on a broken promise.
 */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "parser/import/import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool promise) {
  if (!promise) abort();
}

/* A zero byte divides the text into two files. */
static void read_foreign(strut_import_format format, const char *text, size_t length) {
  strut_import_file files[2] = {{.name = "fuzz"}, {.name = "other"}};
  strut_diagnostics result = {0};
  strut_error error = {0};
  char *scene = NULL;
  size_t first = format == STRUT_IMPORT_TABLES ? strlen(text) : length;
  size_t count = format == STRUT_IMPORT_TABLES ? 2 : 1;
  for (size_t i = 0; i < count; i++) {
    files[i].length = i ? length - first - (first < length) : first;
    files[i].text = strut_allocate(files[i].length + 1, 1);
    if (files[i].text && files[i].length)
      memcpy(files[i].text, i ? text + first + 1 : text, files[i].length);
  }
  strut_status status = strut_import(format, files, count, 0.0, &scene, &result, &error);
  size_t said = files[0].diagnostics.count + files[1].diagnostics.count + result.count;
  require(status == STRUT_OK || said > 0 || error.message[0]);
  require(status != STRUT_OK || (scene && !said));
  strut_release(scene);
  strut_diagnostics_free(&result);
  strut_import_files_free(files, 2);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size == 0) return 0;
  char *text = malloc(size);
  if (!text) return 0;
  memcpy(text, data + 1, size - 1);
  text[size - 1] = '\0';
  switch (data[0] % 4) {
    case 0: read_foreign(STRUT_IMPORT_NTRT, text, size - 1); break;
    case 1: read_foreign(STRUT_IMPORT_TENSEGRITYSIM, text, size - 1); break;
    case 2: read_foreign(STRUT_IMPORT_SPRINGABLE, text, size - 1); break;
    default: read_foreign(STRUT_IMPORT_TABLES, text, size - 1); break;
  }
  strut_import_guess(text, size - 1);
  free(text);
  return 0;
}
