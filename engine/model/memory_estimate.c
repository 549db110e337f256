/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/memory_estimate.h"

#include <stdio.h>

#include "engine/base/memory_limit.h"

/* Bytes for each thing, from the tables and matrices that hold it: a little less than what
   chains and grids of 350,000 nodes were seen to take, so that nothing is refused that would do. */
static const double PER_NODE = 440.0, PER_MEMBER = 220.0, PER_CONTACT = 100.0;
/* Rows and numbers of a factor, CHOLMOD's and the copy that is kept of it. */
static const double PER_NONZERO = 24.0, PER_ROW = 40.0;

enum { WORDS = 160 };

double strut_memory_needed(const strut_scene *scene) {
  return PER_NODE * (double)scene->node_count + PER_MEMBER * (double)scene->member_count +
         PER_CONTACT * (double)(strut_scene_has_ground(scene) ? scene->contact_count : 0) +
         (double)scene->arena.bytes;
}

static const char *name_scene(const strut_scene *scene, char words[WORDS]) {
  snprintf(words, WORDS, "a scene of %zu nodes and %zu members", scene->node_count,
           scene->member_count);
  return words;
}

strut_status strut_memory_check_model(const strut_scene *scene, strut_error *error) {
  char words[WORDS];
  return strut_memory_check(strut_memory_needed(scene), name_scene(scene, words), error);
}

strut_status strut_memory_fail_model(const strut_scene *scene, strut_error *error) {
  char words[WORDS];
  return strut_memory_fail(strut_memory_needed(scene), name_scene(scene, words), error);
}

static double factor_needs(int32_t rows, double nonzeros, char words[WORDS]) {
  snprintf(words, WORDS, "the factor of a matrix of %d rows, with %.3g nonzeros,", (int)rows,
           nonzeros);
  return PER_NONZERO * nonzeros + PER_ROW * (double)rows;
}

strut_status strut_memory_check_factor(int32_t rows, double nonzeros, strut_error *error) {
  char words[WORDS];
  if (nonzeros > (double)INT32_MAX)
    return strut_fail(
        error, STRUT_NO_MEMORY,
        "the factor of a matrix of %d rows would have %.3g nonzeros, more than can be "
        "counted; lumped masses need none",
        (int)rows, nonzeros);
  double bytes = factor_needs(rows, nonzeros, words);
  return strut_memory_check(bytes, words, error);
}

strut_status strut_memory_fail_factor(int32_t rows, double nonzeros, strut_error *error) {
  char words[WORDS];
  double bytes = factor_needs(rows, nonzeros, words);
  return strut_memory_fail(bytes, words, error);
}
