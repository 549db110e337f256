/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules about sensors and the programs of signals. See check.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/scene/check_rules.h"
#include "engine/scene/signal_program.h"

static bool exists(int32_t index, size_t count) { return index >= 0 && (size_t)index < count; }

static bool touches(const strut_scene *scene, int32_t node) {
  for (size_t i = 0; i < scene->contact_count; i++)
    if (scene->contacts[i].node == node) return true;
  return false;
}

static void check_sensor(strut_checker *checker, size_t index) {
  const strut_scene *scene = checker->scene;
  const strut_sensor *s = &scene->sensors[index];
  bool known = true;
  char owner[200];
  strut_format_name(owner, "sensor", s->name, index);
  switch (s->kind) {
    case STRUT_SENSOR_LENGTH:
    case STRUT_SENSOR_FORCE: known = exists(s->item, scene->member_count); break;
    case STRUT_SENSOR_ANGLE: known = exists(s->item, scene->hinge_count); break;
    case STRUT_SENSOR_CONTACT:
    case STRUT_SENSOR_POSITION:
    case STRUT_SENSOR_VELOCITY: known = exists(s->item, scene->node_count) && s->along < 2; break;
    case STRUT_SENSOR_ENERGY: known = s->energy <= STRUT_SENSED_TOTAL; break;
    case STRUT_SENSOR_KINDS: known = false;
  }
  if (!known)
    strut_report_finding(checker, STRUT_ON_SENSOR, index, NULL,
                         "%s is of a thing that does not exist", owner);
  else if (s->kind == STRUT_SENSOR_CONTACT && !scene->ground.present)
    strut_report_finding(checker, STRUT_ON_SENSOR, index, "contact",
                         "%s is of a contact, but there is no ground; add 'ground' to the scene",
                         owner);
  else if (s->kind == STRUT_SENSOR_CONTACT && !touches(scene, s->item))
    strut_report_finding(checker, STRUT_ON_SENSOR, index, "contact",
                         "%s is of node '%s', which cannot touch the ground; list it in 'nodes' of "
                         "the ground",
                         owner, scene->nodes[s->item].name);
  else if (s->kind == STRUT_SENSOR_FORCE && scene->bar_model == STRUT_BARS_RIGID &&
           scene->members[s->item].kind == STRUT_BAR)
    strut_report_finding(checker, STRUT_ON_SENSOR, index, "force",
                         "%s is of the force of a bar, but bars are rigid; make the member a "
                         "spring, or bars: elastic",
                         owner);
}

void strut_check_sensors(strut_checker *checker) {
  for (size_t i = 0; i < checker->scene->sensor_count; i++) check_sensor(checker, i);
}

/* Is the instruction one that a signal may have? */
static bool is_known(const strut_scene *scene, const strut_instruction *p, size_t signal) {
  if (p->operation == STRUT_OPERATION_NUMBER) return isfinite(p->number);
  if (p->operation != STRUT_OPERATION_COLUMN) return (unsigned)p->operation < STRUT_OPERATION_COUNT;
  if (p->column.kind == STRUT_COLUMN_TIME) return true;
  if (p->column.kind == STRUT_COLUMN_SENSOR) return exists(p->column.item, scene->sensor_count);
  return p->column.kind == STRUT_COLUMN_SIGNAL && exists(p->column.item, signal);
}

bool strut_check_program(strut_checker *checker, size_t index, const char *owner) {
  const strut_program *program = &checker->scene->signals[index].program;
  size_t top = 0, most = 0;
  bool valid = program->length > 0;
  for (size_t i = 0; i < program->length && valid; i++) {
    const strut_instruction *p = &program->instruction[i];
    valid = is_known(checker->scene, p, index);
    if (!valid) break;
    size_t operands = (size_t)strut_operation_operands(p->operation);
    valid = top >= operands;
    top += 1 - operands;
    if (valid && top > most) most = top;
  }
  if (!valid || top != 1)
    strut_report_finding(checker, STRUT_ON_SIGNAL, index, "expression",
                         "the program of %s is not valid", owner);
  else if (most > STRUT_MOST_PROGRAM_DEPTH)
    strut_report_finding(checker, STRUT_ON_SIGNAL, index, "expression",
                         "the expression of %s needs more than %d intermediate numbers", owner,
                         STRUT_MOST_PROGRAM_DEPTH);
  else
    return true;
  return false;
}

void strut_check_driven_rate(strut_checker *checker, size_t actuator, const char *owner) {
  const strut_scene *scene = checker->scene;
  const strut_actuator *a = &scene->actuators[actuator];
  strut_signal_traits traits = strut_signal_describe(scene->signals, scene->sensors, a->signal);
  if (traits.sensor < 0) return;
  strut_report_finding(checker, STRUT_ON_ACTUATOR, actuator, "signal",
                       "%s drives a rest %s by sensor '%s', whose rate is not known; a rest %s may "
                       "follow lengths, angles and positions, and a load any sensor",
                       owner, a->member >= 0 ? "length" : "angle",
                       scene->sensors[traits.sensor].name, a->member >= 0 ? "length" : "angle");
}
