/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * libFuzzer target: any text is read as a study of the model of tests/language/studies or refused with
 * a message; of what is read, the first, the middle and the last point have a scene or a message.
 * Seeds: tests/language/studies/good and the cases of bad, unpacked. It runs in the repository's root.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "engine/study/sweep/sweep.h"
#include "parser/language/study/read_study.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool promise) {
  if (!promise) abort();
}

/* A folder of this process's own, with the model as it lies beside the folder of studies; its name. */
static const char *folder(void) {
  static char name[] = "/tmp/strut-fuzz-XXXXXX";
  static bool made;
  if (made) return name;
  char text[8192], path[64];
  FILE *model = fopen("tests/language/studies/good/models/model.yaml", "rb");
  require(mkdtemp(name) && model);
  size_t length = fread(text, 1, sizeof text, model);
  fclose(model);
  snprintf(path, sizeof path, "%s/model.yaml", name);
  FILE *copy = fopen(path, "wb");
  require(copy && fwrite(text, 1, length, copy) == length && fclose(copy) == 0);
  snprintf(path, sizeof path, "%s/good", name);
  require(mkdir(path, 0700) == 0);
  made = true;
  return name;
}

static void check_value(const strut_study_column *column, const strut_study_value *value) {
  require(column->word ? value->word != NULL : !value->word);
  require(column->word || isfinite(value->number));
}

/* A point has a scene, or a message that says why not. */
static void check_point(strut_study_file *file, int64_t point) {
  size_t columns = strut_grid_columns(&file->study);
  strut_study_value *values = strut_allocate(columns + 1, sizeof *values);
  strut_error error = {0};
  strut_setup setup;
  require(values != NULL);
  strut_grid_values(&file->study, point, values);
  for (size_t k = 0; k < columns; k++)
    check_value(strut_grid_column(&file->study, k, NULL), &values[k]);
  strut_status status = strut_study_setup(file, values, &setup, &error);
  require(status == STRUT_OK || (status == STRUT_BAD_SCENE && error.message[0]));
  if (status == STRUT_OK) strut_setup_free(&setup);
  require(strut_study_try(file, values, NULL) == status);
  require(strut_study_messages(file, 50) != NULL);
  strut_release(values);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  char path[64];
  strut_study_file file;
  strut_error error = {0};
  snprintf(path, sizeof path, "%s/good/study.yaml", folder());
  FILE *text = fopen(path, "wb");
  require(text != NULL);
  size_t written = fwrite(data, 1, size, text);
  require(fclose(text) == 0 && written == size);
  strut_status status = strut_study_open(path, NULL, 0, &file, &error);
  const char *messages = strut_study_messages(&file, 50);
  require(status == STRUT_OK || status == STRUT_BAD_SCENE || status == STRUT_FILE_TROUBLE);
  require(messages != NULL);
  if (status == STRUT_BAD_SCENE) require(messages[0] != '\0');
  if (status == STRUT_FILE_TROUBLE) require(error.message[0] != '\0');
  if (status == STRUT_OK) {
    int64_t points = strut_grid_points(&file.study);
    char *identity = strut_study_identity(&file);
    require(!messages[0] && identity && points != 0 && points <= STRUT_STUDY_MOST_POINTS);
    strut_release(identity);
    for (int k = 0; k < 3 && points > 0; k++) check_point(&file, k * (points - 1) / 2);
  }
  strut_study_close(&file);
  return 0;
}
