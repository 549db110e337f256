/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signals, what they drive, and the experiment, as YAML. See writer.h. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/write/writer.h"

/* The name of the signal in the file; NULL if it is written where it is used. */
static const char *signal_name(const strut_writer *writer, int32_t index) {
  assert(index >= 0 && (size_t)index < writer->scene->signal_count);
  const char *name = writer->scene->signals[index].name;
  return name ? name : index == writer->period_signal ? "signal_of_the_period" : NULL;
}

/* The angle in radians that reads back as exactly this number of turns, if there is one. */
static double radians(double turns) {
  double angle = turns * STRUT_TAU, up = angle, down = angle;
  for (int i = 0; i < 4; i++) {
    if (up / STRUT_TAU == turns) return up;
    if (down / STRUT_TAU == turns) return down;
    up = nextafter(up, (double)INFINITY);
    down = nextafter(down, -(double)INFINITY);
  }
  return angle;
}

static void put_signal(strut_writer *writer, int32_t index);

void strut_put_signal_reference(strut_writer *writer, int32_t index) {
  const char *name = signal_name(writer, index);
  if (name)
    strut_put_name(writer, name);
  else
    put_signal(writer, index);
}

/* The phase is kept in turns and written as an angle. */
static void put_phase(strut_writer *writer, strut_mapping *mapping, int key, const void *object) {
  const strut_signal *signal = object;
  if (signal->phase == 0.0 && !signbit(signal->phase)) return;
  strut_put_key_name(writer, mapping, key);
  strut_put_number(writer, radians(signal->phase));
}

static void put_wave(strut_writer *writer, const strut_signal *signal) {
  strut_mapping mapping = STRUT_MAPPING_INLINE;
  const strut_signal usual = strut_signal_default(signal->kind);
  strut_put(writer, "{");
  strut_put_fields(writer, &mapping, strut_wave_section(signal->kind), signal, &usual, put_phase);
  strut_put(writer, "}");
}

static void put_table(strut_writer *writer, const strut_signal *s) {
  strut_put(writer, "[");
  for (size_t i = 0; i < s->point_count; i++) {
    if (i) strut_put(writer, ", ");
    strut_put_pair(writer, (const double[2]){s->time[i], s->value[i]});
  }
  strut_put(writer, "]");
}

static void put_trigger(strut_writer *writer, strut_mapping *mapping,
                        const strut_trigger *trigger) {
  const strut_scene *scene = writer->scene;
  bool contact = trigger->kind == STRUT_TRIGGER_CONTACT;
  strut_mapping inner = STRUT_MAPPING_INLINE;
  if (trigger->kind == STRUT_TRIGGER_NONE) return;
  strut_put_key_name(writer, mapping, STRUT_KEY_SIGNAL_STARTS);
  strut_put(writer, "{");
  strut_put_key_name(writer, &inner, contact ? STRUT_KEY_STARTS_CONTACT : STRUT_KEY_STARTS_SENSOR);
  strut_put_name(writer,
                 contact ? scene->nodes[trigger->item].name : scene->sensors[trigger->item].name);
  if (!contact) {
    strut_put_key_name(
        writer, &inner,
        trigger->kind == STRUT_TRIGGER_ABOVE ? STRUT_KEY_STARTS_ABOVE : STRUT_KEY_STARTS_BELOW);
    strut_put_number(writer, trigger->level);
  }
  if (trigger->each) {
    strut_put_key_name(writer, &inner, STRUT_KEY_STARTS_EACH);
    strut_put(writer, "yes");
  }
  strut_put(writer, "}");
}

static void put_modifier(strut_writer *writer, strut_mapping *mapping, int key, double time) {
  if (time == 0.0) return;
  strut_put_key_name(writer, mapping, key);
  strut_put_number(writer, time);
}

static void put_signal(strut_writer *writer, int32_t index) {
  const strut_signal *s = &writer->scene->signals[index];
  strut_mapping mapping = STRUT_MAPPING_INLINE;
  strut_put(writer, "{");
  strut_put_key_name(writer, &mapping, STRUT_KEY_SIGNAL_CONSTANT + (int)s->kind);
  if (s->kind == STRUT_CONSTANT) {
    strut_put_number(writer, s->amplitude);
  } else if (s->kind == STRUT_TABLE) {
    put_table(writer, s);
  } else if (s->kind == STRUT_EXPRESSION) {
    strut_put_program(writer, s->program.instruction, s->program.length);
  } else if (s->kind == STRUT_SUM) {
    strut_put(writer, "[");
    for (size_t i = 0; i < s->term_count; i++) {
      if (i) strut_put(writer, ", ");
      strut_put_signal_reference(writer, s->terms[i]);
    }
    strut_put(writer, "]");
  } else {
    put_wave(writer, s);
  }
  put_trigger(writer, &mapping, &s->trigger);
  put_modifier(writer, &mapping, STRUT_KEY_SIGNAL_LAG, s->lag);
  put_modifier(writer, &mapping, STRUT_KEY_SIGNAL_EVERY, s->every);
  strut_put(writer, "}");
}

static void put_sensor_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                               const void *object) {
  const strut_sensor *sensor = object;
  bool directed = sensor->kind == STRUT_SENSOR_POSITION || sensor->kind == STRUT_SENSOR_VELOCITY;
  if (key != STRUT_KEY_SENSOR_ALONG || !directed) return;
  strut_put_key_name(writer, mapping, key);
  strut_put(writer, sensor->along ? "y" : "x");
}

static void put_states(strut_writer *writer) {
  const strut_scene *scene = writer->scene;
  if (scene->state_count) strut_put(writer, "states:\n");
  for (size_t i = 0; i < scene->state_count; i++) {
    const strut_internal_state *state = &scene->states[i];
    strut_put(writer, "  ");
    strut_put_name(writer, state->name);
    strut_put(writer, ": {rate: ");
    strut_put_program(writer, state->rate.instruction, state->rate.length);
    strut_put(writer, state->unit ? ", start: \"" : ", start: ");
    strut_put_number(writer, state->start);
    strut_put(writer, state->unit ? " " : "");
    strut_put(writer, state->unit ? state->unit : "");
    strut_put(writer, state->unit ? "\"}\n" : "}\n");
  }
}

static void put_named_signals(strut_writer *writer) {
  bool any = false;
  for (size_t i = 0; i < writer->scene->signal_count; i++) {
    const char *name = signal_name(writer, (int32_t)i);
    if (!name || writer->scene->signals[i].kind == STRUT_RELAY) continue;
    strut_put(writer, any ? "  " : "signals:\n  ");
    any = true;
    strut_put_name(writer, name);
    strut_put(writer, ": ");
    put_signal(writer, (int32_t)i);
    strut_put(writer, "\n");
  }
}

/* PID controllers have become signals and states. */
static void put_relays(strut_writer *writer) {
  bool any = false;
  for (size_t i = 0; i < writer->scene->signal_count; i++) {
    const strut_signal *s = &writer->scene->signals[i];
    const strut_relay usual = {.off = (double)NAN}; /* it is always written */
    strut_mapping mapping = STRUT_MAPPING_INLINE;
    if (s->kind != STRUT_RELAY) continue;
    strut_put(writer, any ? "  " : "controllers:\n  ");
    any = true;
    strut_put_name(writer, s->name);
    strut_put(writer, ": {");
    strut_put_key_name(writer, &mapping, STRUT_KEY_RELAY_KIND);
    strut_put(writer, "relay");
    strut_put_key_name(writer, &mapping, STRUT_KEY_RELAY_OF);
    strut_put_program(writer, s->program.instruction, s->program.length);
    strut_put_fields(writer, &mapping, STRUT_SECTION_RELAY, &s->relay, &usual, NULL);
    put_modifier(writer, &mapping, STRUT_KEY_RELAY_EVERY, s->every);
    strut_put(writer, "}\n");
  }
}

/* What a signal adds to, or its force or moment. */
static void put_actuator_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                                 const void *object) {
  const strut_actuator *a = object;
  int own = !a->force        ? STRUT_KEY_ACTUATOR_SIGNAL
            : a->member >= 0 ? STRUT_KEY_ACTUATOR_FORCE
                             : STRUT_KEY_ACTUATOR_MOMENT;
  if (key != own) return;
  strut_put_key_name(writer, mapping, key);
  strut_put_signal_reference(writer, a->signal);
}

static void put_unbalance_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                                  const void *object) {
  const strut_unbalance *u = object;
  if (key != STRUT_KEY_UNBALANCE_SPEED || u->signal >= 0) return;
  strut_put_key_name(writer, mapping, key);
  strut_put_number(writer, u->speed);
}

static void put_slider_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                               const void *object) {
  const strut_sliding_mass *s = object;
  if (key != STRUT_KEY_SLIDER_MEMBER) return;
  strut_put_key_name(writer, mapping, key);
  strut_put_name(writer, writer->scene->members[s->member].name);
}

void strut_put_drives(strut_writer *writer) {
  const strut_sliding_mass placed = {.share = (double)NAN}; /* the position is always written */
  strut_put_things(writer, STRUT_THING_SENSOR, STRUT_SECTION_SENSOR, NULL, put_sensor_by_hand);
  put_states(writer);
  put_named_signals(writer);
  put_relays(writer);
  strut_put_things(writer, STRUT_THING_ACTUATOR, STRUT_SECTION_ACTUATOR, NULL,
                   put_actuator_by_hand);
  strut_put_things(writer, STRUT_THING_UNBALANCE, STRUT_SECTION_UNBALANCE, NULL,
                   put_unbalance_by_hand);
  strut_put_things(writer, STRUT_THING_SLIDER, STRUT_SECTION_SLIDER, &placed, put_slider_by_hand);
  strut_put_things(writer, STRUT_THING_LOAD, STRUT_SECTION_LOAD, NULL, NULL);
}

/* Would `of: name` refer to this signal? */
static bool refers_to(const strut_scene *scene, const char *name, int32_t signal) {
  bool found = false;
  for (size_t i = 0; i < scene->actuator_count; i++)
    if (strcmp(scene->actuators[i].name, name) == 0) {
      if (scene->actuators[i].signal != signal) return false;
      found = true;
    }
  for (size_t i = 0; i < scene->load_count; i++)
    if (strcmp(scene->loads[i].name, name) == 0 && scene->loads[i].signal >= 0) {
      if (scene->loads[i].signal != signal) return false;
      found = true;
    }
  for (size_t i = 0; i < scene->signal_count; i++)
    if (scene->signals[i].name && strcmp(scene->signals[i].name, name) == 0) {
      if ((int32_t)i != signal) return false;
      found = true;
    }
  return found;
}

/* A name that `of` may use for the signal whose periods count; NULL: the signal needs a name first. */
static const char *period_name(const strut_scene *scene, const strut_experiment *e) {
  if (e->period_of && refers_to(scene, e->period_of, e->period_signal)) return e->period_of;
  const char *own = scene->signals[e->period_signal].name;
  if (own && refers_to(scene, own, e->period_signal)) return own;
  for (size_t i = 0; i < scene->actuator_count; i++)
    if (refers_to(scene, scene->actuators[i].name, e->period_signal))
      return scene->actuators[i].name;
  for (size_t i = 0; i < scene->load_count; i++)
    if (refers_to(scene, scene->loads[i].name, e->period_signal)) return scene->loads[i].name;
  return NULL;
}

static void put_measure_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                                const void *object) {
  const strut_experiment *e = object;
  strut_mapping steady = STRUT_MAPPING_INLINE;
  if (key == STRUT_KEY_MEASURE_STEADY && e->steady.wanted) {
    strut_put_key_name(writer, mapping, key);
    strut_put(writer, "{");
    strut_put_fields(writer, &steady, STRUT_SECTION_STEADY, &e->steady,
                     &writer->usual.experiment.steady, NULL);
    strut_put(writer, "}");
  } else if (key == STRUT_KEY_MEASURE_QUANTITIES) {
    strut_put_quantities(writer, mapping);
  }
}

static void put_run_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                            const void *object) {
  const strut_experiment *e = object;
  strut_mapping measure = STRUT_MAPPING_INLINE;
  bool measures =
      e->measure_last > 0.0 || e->measure_node >= 0 || e->steady.wanted || e->quantity_count;
  if (key == STRUT_KEY_RUN_OF && e->periods > 0.0) {
    const char *name = period_name(writer->scene, e);
    strut_put_key_name(writer, mapping, key);
    strut_put_name(writer, name ? name : signal_name(writer, e->period_signal));
  } else if (key == STRUT_KEY_RUN_MEASURE && measures) {
    strut_put_key_name(writer, mapping, key);
    strut_put(writer, "{");
    strut_put_fields(writer, &measure, STRUT_SECTION_MEASURE, e, &writer->usual.experiment,
                     put_measure_by_hand);
    strut_put(writer, "}");
  }
}

/* One of the scene's mappings, on a line of its own. */
static void put_section(strut_writer *writer, int key, strut_section section,
                        strut_put_by_hand *by_hand) {
  strut_mapping top = STRUT_MAPPING_INLINE, mapping = STRUT_MAPPING_INLINE;
  strut_put_key_name(writer, &top, key);
  strut_put(writer, "{");
  strut_put_fields(writer, &mapping, section, writer->experiment, &writer->usual.experiment,
                   by_hand);
  strut_put(writer, "}\n");
}

void strut_put_experiment(strut_writer *writer) {
  const strut_experiment *e = writer->experiment;
  put_section(writer, STRUT_KEY_SCENE_SOLVER, STRUT_SECTION_SOLVER, NULL);
  if (e->duration != 0.0 || e->periods != 0.0)
    put_section(writer, STRUT_KEY_SCENE_RUN, STRUT_SECTION_RUN, put_run_by_hand);
  put_section(writer, STRUT_KEY_SCENE_OUTPUT, STRUT_SECTION_OUTPUT, NULL);
}
