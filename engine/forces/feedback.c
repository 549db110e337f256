/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hot where a scene has sensors. See feedback.h. */
#include "engine/forces/feedback.h"

#include "engine/forces/drive.h"
#include "engine/forces/elements.h"
#include "engine/forces/energy.h"
#include "engine/forces/forces.h"
#include "engine/model/pose.h"

/* Length of a member and its rate. */
static void sense_length(const strut_model *model, const strut_state *state, int32_t member,
                         const double *q, const double *v, double *value, double *rate) {
  strut_member_values values = strut_member_measure_at(model, state, member, q, v);
  *value = values.length, *rate = values.rate;
}

static void sense_angle(const strut_model *model, const strut_state *state, int32_t element,
                        const double *q, const double *v, double *value, double *rate) {
  strut_element_pose pose;
  strut_element_evaluate(model, element, state->rest, q, state->element_turn[element], &pose);
  *value = pose.strain;
  *rate = strut_element_rate(model, element, &pose, v);
}

static double sense_energy(const strut_model *model, const strut_state *state, int32_t which,
                           const double *q, const double *v) {
  strut_energies e = strut_energy_evaluate_at(model, state, q, v);
  return which == STRUT_SENSED_KINETIC   ? e.kinetic
         : which == STRUT_SENSED_ELASTIC ? e.elastic
                                         : e.kinetic + e.elastic + e.gravity + e.contact;
}

static void sense(const strut_model *model, const strut_state *state, strut_sensor_entry sensor,
                  const double *q, const double *v, double *value, double *rate) {
  *rate = 0.0;
  switch (sensor.kind) {
    case STRUT_SENSOR_LENGTH: sense_length(model, state, sensor.at, q, v, value, rate); break;
    case STRUT_SENSOR_ANGLE: sense_angle(model, state, sensor.at, q, v, value, rate); break;
    case STRUT_SENSOR_CONTACT:
      *value =
          sensor.at >= 0 && strut_contact_gap(&model->contacts, sensor.at, q) < 0.0 ? 1.0 : 0.0;
      break;
    case STRUT_SENSOR_POSITION: *value = q[sensor.at], *rate = v[sensor.at]; break;
    case STRUT_SENSOR_VELOCITY: *value = v[sensor.at]; break;
    case STRUT_SENSOR_FORCE:
      *value = strut_member_measure_at(model, state, sensor.at, q, v).force;
      break;
    case STRUT_SENSOR_ENERGY: *value = sense_energy(model, state, sensor.at, q, v); break;
    case STRUT_SENSOR_KINDS: break;
  }
}

static void sense_all(const strut_model *model, strut_state *state, bool driven, const double *q,
                      const double *v) {
  const strut_feedback_table *f = &model->feedback;
  for (int32_t i = 0; i < f->count; i++)
    if (strut_sensor_needs_drives(f->sensor[i].kind) == driven)
      sense(model, state, f->sensor[i], q, v, &state->sensor[i], &state->sensor_rate[i]);
}

void strut_feedback_apply(const strut_model *model, strut_state *state, double t, const double *q,
                          const double *v) {
  sense_all(model, state, false, q, v);
  strut_drive_apply_sensed(model, state, t);
  if (model->feedback.needs_drives) sense_all(model, state, true, q, v);
}
