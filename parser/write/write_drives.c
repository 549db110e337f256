/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signals, what they drive, and the experiment, as YAML. See writer.h. */
#include <math.h>
#include <string.h>

#include "parser/write/writer.h"

static const double TWO_PI = 6.283185307179586476925;

/* The name of the signal in the file, or NULL: it is written where it is used. */
static const char *signal_name(const strut_writer *writer, int32_t index) {
  const char *name = writer->scene->signals[index].name;
  return name ? name : index == writer->period_signal ? "signal_of_the_period" : NULL;
}

/* An angle in radians that is read back as exactly so many turns, if there is one. */
static double radians(double turns) {
  double angle = turns * TWO_PI, up = angle, down = angle;
  for (int i = 0; i < 4; i++) {
    if (up / TWO_PI == turns) return up;
    if (down / TWO_PI == turns) return down;
    up = nextafter(up, (double)INFINITY);
    down = nextafter(down, -(double)INFINITY);
  }
  return angle;
}

static void put_signal(strut_writer *writer, int32_t index);

static void put_reference(strut_writer *writer, int32_t index) {
  const char *name = signal_name(writer, index);
  if (name)
    strut_put_name(writer, name);
  else
    put_signal(writer, index);
}

static void put_wave(strut_writer *writer, const strut_signal *s) {
  bool first = true, wave = s->kind != STRUT_RAMP;
  strut_put(writer, "{");
  strut_put_key(writer, &first, "amplitude");
  strut_put_number(writer, s->amplitude);
  if (wave) {
    strut_put_key(writer, &first, "frequency");
    strut_put_number(writer, s->frequency);
  }
  if (s->kind == STRUT_SINE || s->kind == STRUT_SQUARE)
    strut_put_value(writer, &first, "phase", radians(s->phase));
  strut_put_value(writer, &first, "start", s->start);
  if (s->kind != STRUT_HALF_SINE && isfinite(s->stop)) {
    strut_put_key(writer, &first, "stop");
    strut_put_number(writer, s->stop);
  }
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

static void put_signal(strut_writer *writer, int32_t index) {
  static const char *const kinds[] = {"constant", "sine",  "half_sine", "square",
                                      "ramp",     "table", "sum"};
  const strut_signal *s = &writer->scene->signals[index];
  strut_put(writer, "{");
  strut_put(writer, kinds[s->kind]);
  strut_put(writer, ": ");
  if (s->kind == STRUT_CONSTANT) {
    strut_put_number(writer, s->amplitude);
  } else if (s->kind == STRUT_TABLE) {
    put_table(writer, s);
  } else if (s->kind == STRUT_SUM) {
    strut_put(writer, "[");
    for (size_t i = 0; i < s->term_count; i++) {
      if (i) strut_put(writer, ", ");
      put_reference(writer, s->terms[i]);
    }
    strut_put(writer, "]");
  } else {
    put_wave(writer, s);
  }
  strut_put(writer, "}");
}

static void put_named_signals(strut_writer *writer) {
  bool any = false;
  for (size_t i = 0; i < writer->scene->signal_count; i++) {
    const char *name = signal_name(writer, (int32_t)i);
    if (!name) continue;
    strut_put(writer, any ? "  " : "signals:\n  ");
    any = true;
    strut_put_name(writer, name);
    strut_put(writer, ": ");
    put_signal(writer, (int32_t)i);
    strut_put(writer, "\n");
  }
}

void strut_put_drives(strut_writer *writer) {
  const strut_scene *scene = writer->scene;
  put_named_signals(writer);
  if (scene->actuator_count) strut_put(writer, "actuators:\n");
  for (size_t i = 0; i < scene->actuator_count; i++) {
    strut_put(writer, "  ");
    strut_put_name(writer, scene->actuators[i].name);
    strut_put(writer, ": {member: ");
    strut_put_name(writer, scene->members[scene->actuators[i].member].name);
    strut_put(writer, ", signal: ");
    put_reference(writer, scene->actuators[i].signal);
    strut_put(writer, "}\n");
  }
  if (scene->load_count) strut_put(writer, "loads:\n");
  for (size_t i = 0; i < scene->load_count; i++) {
    strut_put(writer, "  ");
    strut_put_name(writer, scene->loads[i].name);
    strut_put(writer, ": {node: ");
    strut_put_name(writer, scene->nodes[scene->loads[i].node].name);
    strut_put(writer, ", force: ");
    strut_put_pair(writer, scene->loads[i].force);
    if (scene->loads[i].signal >= 0) {
      strut_put(writer, ", signal: ");
      put_reference(writer, scene->loads[i].signal);
    }
    strut_put(writer, "}\n");
  }
}

/* Does `name` lead a reader of `of` to the signal? */
static bool leads_to(const strut_scene *scene, const char *name, int32_t signal) {
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

/* What `of` may say for the signal whose periods count; NULL: it needs a name first. */
static const char *period_name(const strut_scene *scene, const strut_experiment *e) {
  if (e->period_of && leads_to(scene, e->period_of, e->period_signal)) return e->period_of;
  const char *own = scene->signals[e->period_signal].name;
  if (own && leads_to(scene, own, e->period_signal)) return own;
  for (size_t i = 0; i < scene->actuator_count; i++)
    if (leads_to(scene, scene->actuators[i].name, e->period_signal))
      return scene->actuators[i].name;
  for (size_t i = 0; i < scene->load_count; i++)
    if (leads_to(scene, scene->loads[i].name, e->period_signal)) return scene->loads[i].name;
  return NULL;
}

static void put_steady(strut_writer *writer, bool *first, const strut_steady *steady) {
  bool inner = true;
  strut_put_key(writer, first, "steady");
  strut_put(writer, "{");
  strut_put_value(writer, &inner, "tolerance", steady->tolerance);
  strut_put_value(writer, &inner, "floor", steady->floor);
  strut_put_value(writer, &inner, "successive", steady->successive);
  if (steady->shooting) {
    strut_put_key(writer, &inner, "shooting");
    strut_put(writer, "yes");
  }
  strut_put(writer, "}");
}

static void put_run(strut_writer *writer) {
  const strut_scene *scene = writer->scene;
  const strut_experiment *e = writer->experiment;
  bool first = true, inner = true;
  if (e->duration == 0.0 && e->periods == 0.0) return;
  strut_put(writer, "run: {");
  strut_put_value(writer, &first, "duration", e->duration);
  strut_put_value(writer, &first, "periods", e->periods);
  if (e->periods > 0.0) {
    const char *name = period_name(scene, e);
    strut_put_key(writer, &first, "of");
    strut_put_name(writer, name ? name : signal_name(writer, e->period_signal));
  }
  if (e->measure_last > 0.0 || e->measure_node >= 0 || e->steady.wanted || e->quantity_count) {
    strut_put_key(writer, &first, "measure");
    strut_put(writer, "{");
    strut_put_value(writer, &inner, "last", e->measure_last);
    if (e->steady.wanted) put_steady(writer, &inner, &e->steady);
    if (e->measure_node >= 0) {
      strut_put_key(writer, &inner, "node");
      strut_put_name(writer, scene->nodes[e->measure_node].name);
    }
    strut_put_quantities(writer, &inner);
    strut_put(writer, "}");
  }
  strut_put(writer, "}\n");
}

void strut_put_experiment(strut_writer *writer) {
  static const char *const channels[] = {"position", "velocity", "length",
                                         "force",    "contact",  "energy"};
  const strut_experiment *e = writer->experiment;
  bool first = true, any = false;
  strut_put(writer, "solver: {");
  strut_put_key(writer, &first, "integrator");
  strut_put_name(writer, e->integrator);
  strut_put_value(writer, &first, "step", e->step);
  if (e->tolerance != 1e-6) strut_put_value(writer, &first, "tolerance", e->tolerance);
  strut_put_value(writer, &first, "refine", e->refine);
  strut_put_value(writer, &first, "refine_time", e->refine_time);
  strut_put_value(writer, &first, "accuracy", e->accuracy);
  if (e->budget != STRUT_USUAL_BUDGET) strut_put_value(writer, &first, "budget", e->budget);
  strut_put(writer, "}\n");
  put_run(writer);
  strut_put(writer, "output: {");
  first = true;
  strut_put_value(writer, &first, "every", e->output_every);
  strut_put_value(writer, &first, "last", e->output_last);
  strut_put_key(writer, &first, "channels");
  strut_put(writer, "[");
  for (unsigned i = 0; i < 6; i++) {
    if (!(e->channels & 1u << i)) continue;
    if (any) strut_put(writer, ", ");
    any = true;
    strut_put(writer, channels[i]);
  }
  strut_put(writer, "]}\n");
}
