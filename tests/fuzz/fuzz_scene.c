/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * libFuzzer target: any text is read or refused; what is read can be written, read again and written to
 * the same text. Seeds: tests/language/good and the cases of tests/language/bad, unpacked.
 */
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "parser/language/read/read_scene.h"
#include "parser/language/write/write_scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The text behind the comments at its head, which say what the parameters were. */
static const char *body(const char *text) {
  while (*text == '#') text = strchr(text, '\n') + 1;
  return text;
}

static strut_status read_text(strut_setup *setup, const char *text, size_t length,
                              strut_purpose purpose) {
  strut_diagnostics diagnostics = {0};
  strut_status status =
      strut_setup_read(setup, "fuzz.yaml", text, length, NULL, 0, purpose, &diagnostics);
  /* A refusal has a message, and a message can be shown. */
  if (status == STRUT_BAD_SCENE && !diagnostics.count) abort();
  if (status == STRUT_OK && diagnostics.count) abort();
  if (!strut_diagnostics_render(&diagnostics, 50)) abort();
  strut_diagnostics_free(&diagnostics);
  return status;
}

static void check_purpose(const char *text, size_t length, strut_purpose purpose) {
  strut_setup first, second;
  if (read_text(&first, text, length, purpose) != STRUT_OK) return;
  char *written = strut_setup_write(&first);
  if (!written || read_text(&second, written, strlen(written), purpose) != STRUT_OK) abort();
  char *again = strut_setup_write(&second);
  if (!again || strcmp(body(written), body(again)) != 0) abort();
  strut_release(written);
  strut_release(again);
  strut_setup_free(&first);
  strut_setup_free(&second);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  char *text = malloc(size + 1);
  if (!text) return 0;
  memcpy(text, data, size);
  text[size] = '\0';
  check_purpose(text, size, STRUT_FOR_RUN);
  check_purpose(text, size, STRUT_FOR_STATICS);
  free(text);
  return 0;
}
