/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a structure consists of, and how it is driven. */
#include <math.h>

#include "engine/study/compare/compare_parts.h"

static double total_mass(const strut_scene *scene) {
  double mass = 0.0;
  for (size_t i = 0; i < scene->node_count; i++) mass += scene->nodes[i].mass;
  for (size_t j = 0; j < scene->member_count; j++) mass += scene->members[j].mass;
  return mass;
}

static double free_coordinates(const strut_scene *scene) {
  double count = 0.0;
  for (size_t i = 0; i < scene->node_count; i++)
    for (int d = 0; d < 2; d++) count += !scene->nodes[i].fixed[d];
  return count;
}

/* The coefficient of sliding friction that all contacts share. */
static void put_friction(strut_compare_work *work, const strut_scene *scene) {
  const strut_compare_quantity at = STRUT_COMPARE_FRICTION;
  if (scene->contact_count == 0) {
    strut_compare_leave(work, at, at, "nothing may touch a ground");
    return;
  }
  double mu[2] = {HUGE_VAL, 0.0};
  for (size_t i = 0; i < scene->contact_count; i++) {
    const strut_friction *f = &scene->contacts[i].friction;
    double here = f->law == STRUT_FRICTION_NONE ? 0.0 : f->mu_kinetic;
    mu[0] = fmin(mu[0], here);
    mu[1] = fmax(mu[1], here);
  }
  if (mu[0] < mu[1])
    strut_compare_leave(work, at, at, "contacts differ in friction");
  else
    strut_compare_put(work, at, mu[0]);
}

/* Of the signal that runs are measured by, else of the only actuator. */
static void put_drive(strut_compare_work *work, const strut_scene *scene) {
  int32_t signal = work->column->input->setup->experiment.period_signal;
  if (signal < 0 && scene->actuator_count == 1) signal = scene->actuators[0].signal;
  if (signal < 0) {
    strut_compare_leave(work, STRUT_COMPARE_DRIVE_FREQUENCY, STRUT_COMPARE_DRIVE_AMPLITUDE,
                        scene->actuator_count ? "more than one drive" : "there is no drive");
    return;
  }
  double period = strut_signal_period(scene->signals, signal);
  const strut_signal *s = &scene->signals[signal];
  if (period > 0.0)
    strut_compare_put(work, STRUT_COMPARE_DRIVE_FREQUENCY, 1.0 / period);
  else
    strut_compare_leave(work, STRUT_COMPARE_DRIVE_FREQUENCY, STRUT_COMPARE_DRIVE_FREQUENCY,
                        "the drive has no period");
  if (s->kind == STRUT_SINE || s->kind == STRUT_SQUARE || s->kind == STRUT_HALF_SINE)
    strut_compare_put(work, STRUT_COMPARE_DRIVE_AMPLITUDE, s->amplitude);
  else
    strut_compare_leave(work, STRUT_COMPARE_DRIVE_AMPLITUDE, STRUT_COMPARE_DRIVE_AMPLITUDE,
                        "the drive is not a wave of one amplitude");
}

strut_status strut_compare_structure(strut_compare_work *work, const strut_model *model) {
  const strut_scene *scene = model->scene;
  double kinds[3] = {0, 0, 0};
  for (size_t j = 0; j < scene->member_count; j++) kinds[scene->members[j].kind]++;
  strut_compare_put(work, STRUT_COMPARE_NODES, (double)scene->node_count);
  strut_compare_put(work, STRUT_COMPARE_MEMBERS, (double)scene->member_count);
  strut_compare_put(work, STRUT_COMPARE_BARS, kinds[STRUT_BAR]);
  strut_compare_put(work, STRUT_COMPARE_SPRINGS, kinds[STRUT_SPRING]);
  strut_compare_put(work, STRUT_COMPARE_CABLES, kinds[STRUT_CABLE]);
  strut_compare_put(work, STRUT_COMPARE_CONTACTS, (double)scene->contact_count);
  strut_compare_put(work, STRUT_COMPARE_ACTUATORS, (double)scene->actuator_count);
  strut_compare_put(work, STRUT_COMPARE_MASS, total_mass(scene));
  strut_compare_put(work, STRUT_COMPARE_FREEDOMS, free_coordinates(scene));
  put_friction(work, scene);
  put_drive(work, scene);
  return STRUT_OK;
}
