/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/exports.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/number_text.h"
#include "engine/output/buffer.h"

typedef struct mjcf_writer {
  const strut_model *model;
  const strut_scene *scene;
  const strut_experiment *experiment;
  strut_buffer text, controls; /* of the key frame */
  strut_mjcf *out;
  size_t motors;
} mjcf_writer;

static void note(mjcf_writer *w, const char *text) {
  if (w->out->note_count < STRUT_MJCF_MOST_NOTES) w->out->notes[w->out->note_count++] = text;
}

/* ---- what MJCF cannot express ---- */

static void refuse_members(strut_unsupported *r, const strut_scene *scene) {
  size_t laws = 0, pushing = 0, stops = 0, ends = 0, maxwell = 0, rub = 0, ratios = 0, wraps = 0;
  for (size_t i = 0; i < scene->member_count; i++) {
    const strut_member *m = &scene->members[i];
    bool one_sided = m->law.carries != STRUT_CARRIES_BOTH && m->kind != STRUT_CABLE;
    laws += m->law.kind != STRUT_LAW_LINEAR || one_sided;
    stops += m->shortest > 0.0 || m->longest > 0.0;
    ends += strut_member_ends(m);
    maxwell += m->maxwell.stiffness > 0.0;
    rub += m->guide_friction > 0.0;
    wraps += m->guide_radius > 0.0;
    pushing += m->guide_count && m->kind != STRUT_CABLE;
    ratios += m->guide_count && m->damping_ratio > 0.0;
  }
  strut_unsupported_add(r, laws, "laws of members");
  strut_unsupported_add(r, pushing, "springs over guides");
  strut_unsupported_add(r, stops, "stops");
  strut_unsupported_add(r, ends, "members that break or are released");
  strut_unsupported_add(r, maxwell, "Maxwell branches");
  strut_unsupported_add(r, rub, "friction at guides");
  strut_unsupported_add(r, wraps, "guides with a radius");
  strut_unsupported_add(r, ratios, "damping ratios of running cables");
}

static strut_status check(const strut_model *model, strut_error *error) {
  const strut_scene *s = model->scene;
  strut_unsupported r = {.used = 0};
  strut_unsupported_add(&r, s->hinge_count, "hinges and beams");
  strut_unsupported_add(&r, s->cell_count, "cells");
  strut_unsupported_add(&r, s->collision_count, "collisions");
  strut_unsupported_add(&r, s->distance_count, "distances");
  strut_unsupported_add(&r, s->foot_count, "feet");
  strut_unsupported_add(&r, model->contacts.grips, "friction that follows a signal");
  strut_unsupported_add(&r, s->ground_count, "grounds other than one line at rest");
  strut_unsupported_add(&r, s->ground.present && s->ground.belt_speed != 0.0, "belts");
  strut_unsupported_add(&r, s->support_motion_count, "supports that move");
  strut_unsupported_add(&r, s->unbalance_count, "rotating masses");
  strut_unsupported_add(&r, s->sliding_count, "sliders");
  strut_unsupported_add(&r, s->sensor_count + s->state_count, "sensors and controllers");
  strut_unsupported_add(&r, s->rayleigh_mass > 0.0 || s->rayleigh_stiffness > 0.0,
                        "Rayleigh's damping");
  refuse_members(&r, s);
  if (r.used)
    return strut_fail(
        error, STRUT_BAD_SCENE,
        "the scene has what MJCF is not written for: %s; leave it out to export the rest", r.text);
  for (size_t i = 0; i < s->node_count; i++)
    if (!(s->nodes[i].fixed[0] && s->nodes[i].fixed[1]) && !(model->weight[i] > 0.0))
      return strut_fail(error, STRUT_BAD_SCENE,
                        "node '%s' has no mass, which MuJoCo wants of each body that moves",
                        s->nodes[i].name);
  return STRUT_OK;
}

/* ---- attributes ---- */

static void add_xml(strut_buffer *to, const char *text) {
  static const char special[] = "&<>\"";
  static const char *const escapes[] = {"&amp;", "&lt;", "&gt;", "&quot;"};
  for (; *text; text++) {
    const char *found = strchr(special, *text);
    if (found)
      strut_buffer_add(to, "%s", escapes[found - special]);
    else
      strut_buffer_add(to, "%c", *text);
  }
}

static void add_attribute(strut_buffer *to, const char *name, const char *text) {
  strut_buffer_add(to, " %s=\"", name);
  add_xml(to, text);
  strut_buffer_add(to, "\"");
}

static void add_numbers(strut_buffer *to, const char *name, const double *values, size_t count) {
  char text[STRUT_NUMBER_TEXT];
  strut_buffer_add(to, " %s=\"", name);
  for (size_t i = 0; i < count; i++) {
    strut_number_text(values[i], text);
    strut_buffer_add(to, "%s%s", i ? " " : "", text);
  }
  strut_buffer_add(to, "\"");
}

static void add_number(strut_buffer *to, const char *name, double value) {
  add_numbers(to, name, &value, 1);
}

/* ---- sections ---- */

/* Radius of the spheres that touch the ground: small beside the structure. */
static double touch_radius(const strut_scene *scene) {
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
  for (size_t i = 0; i < scene->node_count; i++)
    for (int c = 0; c < 2; c++) {
      low[c] = fmin(low[c], scene->nodes[i].start[c]);
      high[c] = fmax(high[c], scene->nodes[i].start[c]);
    }
  double size = fmax(high[0] - low[0], high[1] - low[1]);
  return size > 0.0 ? 0.01 * size : 0.01;
}

static void write_head(mjcf_writer *w) {
  const strut_scene *s = w->scene;
  const double gravity[] = {s->gravity[0], 0.0, s->gravity[1]};
  bool classic = strncmp(w->experiment->integrator, "rk4", 3) == 0;
  strut_buffer_add(&w->text, "<!-- Written by strut: plane x z, SI units. -->\n<mujoco");
  add_attribute(&w->text, "model", *s->name ? s->name : "structure");
  strut_buffer_add(&w->text,
                   ">\n  <compiler angle=\"radian\" inertiafromgeom=\"false\"/>\n  <option");
  if (w->experiment->step > 0.0) add_number(&w->text, "timestep", w->experiment->step);
  add_numbers(&w->text, "gravity", gravity, 3);
  strut_buffer_add(&w->text, " integrator=\"%s\"/>\n", classic ? "RK4" : "Euler");
}

static void write_ground(mjcf_writer *w, double radius) {
  const strut_ground *g = &w->scene->ground;
  const double pos[] = {radius * sin(g->slope), 0.0, g->height - radius * cos(g->slope)};
  const double turn[] = {0.0, -g->slope, 0.0}, size[] = {0.0, 0.0, 1.0};
  if (!g->present) return;
  strut_buffer_add(&w->text,
                   "    <geom name=\"ground\" type=\"plane\" contype=\"0\" conaffinity=\"1\"");
  add_numbers(&w->text, "pos", pos, 3);
  add_numbers(&w->text, "euler", turn, 3);
  add_numbers(&w->text, "size", size, 3);
  strut_buffer_add(&w->text, "/>\n");
  note(
      w,
      "stiffness, damping and static friction of contacts: MuJoCo has its own soft contacts, which "
      "get the kinetic coefficient and may creep");
}

static const strut_contact *contact_of(const strut_scene *scene, size_t node) {
  for (size_t i = 0; i < scene->contact_count; i++)
    if (scene->contacts[i].node == (int32_t)node) return &scene->contacts[i];
  return NULL;
}

static void write_body(mjcf_writer *w, size_t i, double radius) {
  static const char *const axes[] = {"1 0 0", "0 0 1"};
  const strut_node *n = &w->scene->nodes[i];
  const double pos[] = {n->start[0], 0.0, n->start[1]};
  const strut_contact *contact = contact_of(w->scene, i);
  double mass = w->model->weight[i], turn = mass * radius * radius;
  const double inertia[] = {turn, turn, turn};
  strut_buffer_add(&w->text, "    <body");
  add_attribute(&w->text, "name", n->name);
  add_numbers(&w->text, "pos", pos, 3);
  strut_buffer_add(&w->text, ">\n");
  for (int c = 0; c < 2; c++) {
    if (n->fixed[c]) continue;
    strut_buffer_add(&w->text, "      <joint name=\"");
    add_xml(&w->text, n->name);
    strut_buffer_add(&w->text, ".%c\" type=\"slide\" axis=\"%s\"/>\n", "xy"[c], axes[c]);
  }
  if (!(n->fixed[0] && n->fixed[1])) {
    strut_buffer_add(&w->text, "      <inertial pos=\"0 0 0\"");
    add_number(&w->text, "mass", mass);
    add_numbers(&w->text, "diaginertia", inertia, 3);
    strut_buffer_add(&w->text, "/>\n");
  }
  if (contact) {
    const double friction[] = {contact->friction.mu_kinetic, 0.005, 0.0001};
    strut_buffer_add(&w->text, "      <geom type=\"sphere\" contype=\"1\" conaffinity=\"0\"");
    add_number(&w->text, "size", radius);
    add_numbers(&w->text, "friction", friction, 3);
    strut_buffer_add(&w->text, "/>\n");
  }
  strut_buffer_add(&w->text, "      <site");
  add_attribute(&w->text, "name", n->name);
  strut_buffer_add(&w->text, "/>\n    </body>\n");
}

static bool is_rigid(const mjcf_writer *w, size_t i) {
  return w->scene->bar_model == STRUT_BARS_RIGID && w->scene->members[i].kind == STRUT_BAR;
}

static void write_tendon(mjcf_writer *w, size_t i) {
  const strut_member *m = &w->scene->members[i];
  strut_rest rest = {0};
  strut_member_rest(w->scene, i, &rest);
  double length = w->model->members.rest[i];
  const double range[] = {0.0, length};
  double damping = m->guide_count ? m->damping : w->model->members.damping[i];
  strut_buffer_add(&w->text, "    <spatial");
  add_attribute(&w->text, "name", m->name);
  if (!is_rigid(w, i)) {
    add_number(&w->text, "stiffness", rest.stiffness);
    if (damping > 0.0) add_number(&w->text, "damping", damping);
    if (m->kind == STRUT_CABLE)
      add_numbers(&w->text, "springlength", range, 2);
    else
      add_number(&w->text, "springlength", length);
  }
  strut_buffer_add(&w->text, ">\n");
  for (size_t k = 0; k < m->guide_count + 2; k++) {
    strut_buffer_add(&w->text, "      <site");
    add_attribute(&w->text, "site", w->scene->nodes[strut_member_node(m, k)].name);
    strut_buffer_add(&w->text, "/>\n");
  }
  strut_buffer_add(&w->text, "    </spatial>\n");
}

static void write_rigid(mjcf_writer *w) {
  bool any = false;
  double step = w->experiment->step > 0.0 ? w->experiment->step : 0.002; /* MuJoCo's own */
  const double solref[] = {2.0 * step, 1.0};
  for (size_t i = 0; i < w->scene->member_count; i++) {
    if (!is_rigid(w, i)) continue;
    if (!any) strut_buffer_add(&w->text, "  <equality>\n");
    any = true;
    strut_buffer_add(&w->text, "    <tendon");
    add_attribute(&w->text, "tendon1", w->scene->members[i].name);
    add_numbers(&w->text, "solref", solref, 2); /* as stiff as the step allows */
    strut_buffer_add(&w->text, " solimp=\"0.9999 0.9999 0.001\"/>\n");
  }
  if (!any) return;
  strut_buffer_add(&w->text, "  </equality>\n");
  note(w, "rigid bars: they are constraints of MuJoCo, as stiff as its step allows");
}

/* A motor; `control` is its control where the run begins. */
static void write_motor(mjcf_writer *w, const char *name, const char *suffix, double control) {
  char number[STRUT_NUMBER_TEXT];
  if (w->motors++ == 0) strut_buffer_add(&w->text, "  <actuator>\n");
  strut_number_text(control, number);
  strut_buffer_add(&w->controls, "%s%s", w->motors > 1 ? " " : "", number);
  strut_buffer_add(&w->text, "    <motor name=\"");
  add_xml(&w->text, name);
  strut_buffer_add(&w->text, "%s\"", suffix);
}

static void write_actuators(mjcf_writer *w) {
  for (size_t i = 0; i < w->scene->actuator_count; i++) {
    const strut_actuator *a = &w->scene->actuators[i];
    strut_rest rest = {0};
    strut_member_rest(w->scene, (size_t)a->member, &rest);
    write_motor(w, a->name, "", 0.0);
    add_attribute(&w->text, "tendon", w->scene->members[a->member].name);
    add_number(&w->text, "gear", a->force ? -1.0 : rest.stiffness);
    strut_buffer_add(&w->text, "/>\n");
  }
  if (w->scene->actuator_count)
    note(w,
         "signals of actuators: their values are the controls, of a driven rest length its change "
         "in m (a driven cable then pushes where it would be slack, and an axial_stiffness does "
         "not follow the length)");
}

static void write_loads(mjcf_writer *w) {
  static const char *const suffixes[] = {".x", ".y"};
  bool varies = false, held = false;
  for (size_t i = 0; i < w->scene->load_count; i++) {
    const strut_load *l = &w->scene->loads[i];
    const strut_node *n = &w->scene->nodes[l->node];
    varies = varies || l->signal >= 0;
    for (int c = 0; c < 2; c++) {
      if (l->force[c] == 0.0 || n->fixed[c]) continue;
      held = held || l->signal < 0;
      write_motor(w, l->name, suffixes[c], l->signal < 0 ? 1.0 : 0.0);
      strut_buffer_add(&w->text, " joint=\"");
      add_xml(&w->text, n->name);
      strut_buffer_add(&w->text, "%s\"", suffixes[c]);
      add_number(&w->text, "gear", l->force[c]);
      strut_buffer_add(&w->text, "/>\n");
    }
  }
  if (varies) note(w, "signals of loads: their values are the controls");
  if (held) note(w, "constant loads act where the controls of the key frame \"start\" are set");
}

/* Velocities and controls where the run begins. */
static void write_start(mjcf_writer *w) {
  strut_buffer velocity = {0};
  char number[STRUT_NUMBER_TEXT];
  bool moves = false;
  for (size_t i = 0; i < w->scene->node_count; i++)
    for (int c = 0; c < 2; c++) {
      const strut_node *n = &w->scene->nodes[i];
      if (n->fixed[c]) continue;
      moves = moves || n->velocity[c] != 0.0;
      strut_number_text(n->velocity[c], number);
      strut_buffer_add(&velocity, "%s%s", velocity.length ? " " : "", number);
    }
  if (moves || w->motors) {
    strut_buffer_add(&w->text, "  <keyframe>\n    <key name=\"start\"");
    if (moves) add_attribute(&w->text, "qvel", velocity.text ? velocity.text : "");
    if (w->motors) add_attribute(&w->text, "ctrl", w->controls.text ? w->controls.text : "");
    strut_buffer_add(&w->text, "/>\n  </keyframe>\n");
  }
  strut_release(strut_buffer_take(&velocity));
}

static void write_all(mjcf_writer *w) {
  double radius = touch_radius(w->scene);
  bool shared = false, damped = false;
  for (size_t i = 0; i < w->scene->member_count; i++) {
    const strut_member *m = &w->scene->members[i];
    shared = shared || m->mass > 0.0;
    damped = damped || (m->kind == STRUT_CABLE && (m->damping > 0.0 || m->damping_ratio > 0.0));
  }
  if (shared && w->scene->mass_model == STRUT_MASS_CONSISTENT)
    note(w,
         "consistent masses of members: half of each is at either end, as with mass_model: lumped");
  if (damped) note(w, "dampers of cables act while these are slack, too");
  write_head(w);
  strut_buffer_add(&w->text, "  <worldbody>\n");
  write_ground(w, radius);
  for (size_t i = 0; i < w->scene->node_count; i++) write_body(w, i, radius);
  strut_buffer_add(&w->text, "  </worldbody>\n");
  if (w->scene->member_count) strut_buffer_add(&w->text, "  <tendon>\n");
  for (size_t i = 0; i < w->scene->member_count; i++) write_tendon(w, i);
  if (w->scene->member_count) strut_buffer_add(&w->text, "  </tendon>\n");
  write_rigid(w);
  write_actuators(w);
  write_loads(w);
  if (w->motors) strut_buffer_add(&w->text, "  </actuator>\n");
  write_start(w);
  strut_buffer_add(&w->text, "</mujoco>\n");
}

strut_status strut_mjcf_make(const strut_model *model, const strut_experiment *experiment,
                             strut_mjcf *mjcf, strut_error *error) {
  mjcf_writer w = {.model = model, .scene = model->scene, .experiment = experiment, .out = mjcf};
  *mjcf = (strut_mjcf){0};
  strut_status status = check(model, error);
  if (status) return status;
  strut_c_locale locale = strut_c_locale_enter();
  write_all(&w);
  strut_c_locale_leave(locale);
  strut_release(strut_buffer_take(&w.controls));
  mjcf->text = strut_buffer_take(&w.text);
  return mjcf->text ? STRUT_OK : strut_no_memory(error, "");
}

void strut_mjcf_free(strut_mjcf *mjcf) {
  strut_release(mjcf->text);
  *mjcf = (strut_mjcf){0};
}
