/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/abi/scratch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "engine/output/ownership.h"
#include "parser/read/read_scene.h"

strut_status abi_scratch_begin(abi_scratch *s, const char *name, strut_error *error) {
  const char *temporary = getenv("TMPDIR");
  bool usable = temporary && *temporary && strlen(temporary) < sizeof s->folder - 40;
  snprintf(s->folder, sizeof s->folder, "%s/strut-XXXXXX", usable ? temporary : "/tmp");
  if (!mkdtemp(s->folder))
    return strut_fail(error, STRUT_FILE_TROUBLE, "cannot create a temporary folder in '%s'",
                      usable ? temporary : "/tmp");
  snprintf(s->path, sizeof s->path, "%s/%s", s->folder, name);
  return STRUT_OK;
}

char *abi_scratch_read(const abi_scratch *s, const char *name, strut_error *error) {
  char path[sizeof s->path], *text = NULL;
  size_t length;
  snprintf(path, sizeof path, "%s/%s", s->folder, name);
  strut_file_read(path, &text, &length, error);
  return text;
}

static void remove_file(const abi_scratch *s, const char *name) {
  char path[sizeof s->path];
  snprintf(path, sizeof path, "%s/%s", s->folder, name);
  unlink(path);
}

void abi_scratch_end(const abi_scratch *s, const char *const *names) {
  for (size_t i = 0; names[i]; i++) remove_file(s, names[i]);
  remove_file(s, STRUT_OWNERSHIP_LIST);
  rmdir(s->folder);
}
