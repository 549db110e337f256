/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The valid scenes of the repository, for tests that go through all of them.
 */
#pragma once

#include <stddef.h>

#include "parser/language/read/read_scene.h"

typedef struct scene_file {
  char path[600];
  char *text; /* NUL-terminated; malloc */
  size_t length;
} scene_file;

/** Every .yaml file below tests/language/good and models but for studies; none fails the test. */
size_t scene_files(scene_file **files);
/** The cases of tests/language/bad, each as if it were a file there: texts that are refused. */
size_t refused_files(scene_file **files);
void free_scene_files(scene_file *files, size_t count);

/** Reads text as a scene for a run, quietly. The caller frees the scene. */
strut_status read_quietly(const char *text, size_t length, strut_setup *setup);
/** The same of a text whose path is given, so that the files which it names are found. */
strut_status read_quietly_as(const char *path, const char *text, size_t length, strut_setup *setup);
/** The scene in the text of that path, written back; NULL where it is refused. strut_release it. */
char *read_and_write(const char *path, const char *text, size_t length);
