/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libFuzzer: any bytes in the canonical layout. Aborts where that is not its own layout. */
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"
#include "parser/yaml/layout.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool promise) {
  if (!promise) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  strut_error error = {0};
  char *text = malloc(size + 1), *result = NULL, *again = NULL;
  if (!text) return 0;
  if (size) memcpy(text, data, size);
  text[size] = '\0';
  strut_status status = strut_layout_text(text, size, &result, &error);
  require(status == STRUT_OK || status == STRUT_BAD_SCENE);
  require((status == STRUT_OK) == (result != NULL));
  require(status == STRUT_OK || error.message[0]);
  if (result) {
    require(strut_layout_text(result, strlen(result), &again, &error) == STRUT_OK);
    require(strcmp(result, again) == 0);
  }
  strut_release(result);
  strut_release(again);
  free(text);
  return 0;
}
