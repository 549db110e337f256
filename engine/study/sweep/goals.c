/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/sweep/goals.h"

#include <math.h>
#include <string.h>

#include "engine/statics/rigidity/node_stiffness.h"

static int32_t find_node(const strut_scene *scene, const char *name) {
  for (size_t i = 0; i < scene->node_count; i++)
    if (strcmp(scene->nodes[i].name, name) == 0) return (int32_t)i;
  return -1;
}

static const strut_configuration *find_configuration(const strut_scene *scene, const char *name) {
  for (size_t i = 0; i < scene->configuration_count; i++)
    if (strcmp(scene->configurations[i].name, name) == 0) return &scene->configurations[i];
  return NULL;
}

static strut_status check_node(const strut_scene *scene, const char *key, const char *name,
                               strut_error *error) {
  if (!name || find_node(scene, name) >= 0) return STRUT_OK;
  return strut_fail(error, STRUT_BAD_SCENE, "'%s' of the study: the model has no node '%.60s'", key,
                    name);
}

strut_status strut_goals_check(const strut_study *study, const strut_scene *scene,
                               strut_error *error) {
  strut_status status = check_node(scene, "stiffness_at", study->stiffness_node, error);
  for (size_t i = 0; i < study->shape_count && !status; i++)
    status = check_node(scene, "shape", study->shape_nodes[i], error);
  if (status || !study->like) return status;
  const strut_configuration *c = find_configuration(scene, study->like);
  if (!c)
    return strut_fail(error, STRUT_BAD_SCENE,
                      "'like' of the study: the model has no configuration '%.60s'", study->like);
  if (!c->shaped)
    return strut_fail(error, STRUT_BAD_SCENE,
                      "'like' of the study: configuration '%.60s' gives no positions of its shape",
                      study->like);
  return STRUT_OK;
}

/* The i-th pair of a node's place and of the place that is wanted; false: no such node. */
static bool find_pair(const strut_study *study, const strut_scene *scene,
                      const strut_configuration *like, const double *positions, size_t i,
                      double is[2], double wanted[2]) {
  int32_t node = like ? (int32_t)i : find_node(scene, study->shape_nodes[i]);
  if (node < 0) return false;
  memcpy(is, positions + 2 * node, 2 * sizeof *is);
  memcpy(wanted, like ? like->position[i] : study->shape[i], 2 * sizeof *wanted);
  return true;
}

double strut_goals_shape_distance(const strut_study *study, const strut_scene *scene,
                                  const double *positions) {
  const strut_configuration *like = study->like ? find_configuration(scene, study->like) : NULL;
  size_t count = like ? scene->node_count : study->like ? 0 : study->shape_count;
  double a[2], b[2], middle_a[2] = {0.0, 0.0}, middle_b[2] = {0.0, 0.0};
  double square = 0.0, dot = 0.0, cross = 0.0, n = (double)count;
  for (size_t i = 0; i < count; i++) {
    if (!find_pair(study, scene, like, positions, i, a, b)) return (double)NAN;
    for (int d = 0; d < 2; d++) middle_a[d] += a[d] / n, middle_b[d] += b[d] / n;
  }
  for (size_t i = 0; i < count; i++) {
    find_pair(study, scene, like, positions, i, a, b);
    for (int d = 0; d < 2; d++) a[d] -= middle_a[d], b[d] -= middle_b[d];
    dot += a[0] * b[0] + a[1] * b[1];
    cross += a[0] * b[1] - a[1] * b[0];
  }
  double size = hypot(dot, cross), c = size > 0.0 ? dot / size : 1.0;
  double s = size > 0.0 ? cross / size : 0.0;
  for (size_t i = 0; i < count; i++) {
    find_pair(study, scene, like, positions, i, a, b);
    for (int d = 0; d < 2; d++) a[d] -= middle_a[d], b[d] -= middle_b[d];
    double x = c * a[0] - s * a[1] - b[0], y = s * a[0] + c * a[1] - b[1];
    square += x * x + y * y;
  }
  return count ? sqrt(square / n) : (double)NAN;
}

/* The force that holds the displaced coordinate, at a displacement; NAN: not reached. */
static double force_at(const strut_path *path, double displacement) {
  for (size_t i = 0; i < path->point_count; i++) {
    const strut_path_point *p = &path->points[i], *before = i ? p - 1 : p;
    double u = p->factor, u0 = before->factor;
    double f = p->reaction[path->coordinate], f0 = before->reaction[path->coordinate];
    if (u == displacement) return f;
    if (i && (u0 - displacement) * (u - displacement) < 0.0)
      return f0 + (f - f0) * (displacement - u0) / (u - u0);
  }
  return (double)NAN;
}

double strut_goals_curve_distance(const strut_study *study, const strut_path *path) {
  double square = 0.0;
  if (path->coordinate < 0 || !study->curve_count) return (double)NAN;
  for (size_t i = 0; i < study->curve_count; i++) {
    double away = force_at(path, study->curve[i][0]) - study->curve[i][1];
    square += away * away;
  }
  return sqrt(square / (double)study->curve_count);
}

strut_status strut_goals_stiffness(const strut_study *study, const strut_model *model,
                                   const double *q, double *stiffness, strut_error *error) {
  strut_node_stiffness *s;
  const char *reason;
  int32_t node = study->stiffness_node ? find_node(model->scene, study->stiffness_node) : -1;
  *stiffness = (double)NAN;
  if (node < 0) return STRUT_OK;
  strut_status status = strut_node_stiffness_create(model, q, &s, &reason, error);
  if (status || !s) return status;
  const double direction[2] = {cos(study->stiffness_direction), sin(study->stiffness_direction)};
  *stiffness = strut_node_stiffness_along(s, node, direction);
  strut_node_stiffness_free(s);
  return STRUT_OK;
}
