/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The structure as YAML, and the order of the whole file. See write_scene.h. */
#include "parser/write/write_scene.h"

#include <math.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "parser/write/writer.h"

/* Same bits? -0 and 0 differ. */
static bool same(const double a[2], const double b[2]) { return memcmp(a, b, 2 * sizeof *a) == 0; }

static void put_text(strut_writer *writer, const char *key, const char *text) {
  if (!*text) return;
  strut_put(writer, key);
  strut_put(writer, ": ");
  strut_put_quoted(writer, text);
  strut_put(writer, "\n");
}

/* An expression, on one line however it was written. */
static void put_expression(strut_writer *writer, const char *text) {
  char one[2] = {0};
  for (; *text; text++) {
    one[0] = *text;
    strut_put(writer, strchr("\r\n\t", *text) ? " " : one);
  }
}

/* For the record only: the numbers below contain them already. */
static void put_parameters(strut_writer *writer) {
  if (!writer->scene->parameter_count) return;
  strut_put(writer, "parameters: # as they were; their values stand in the numbers below\n");
  for (size_t i = 0; i < writer->scene->parameter_count; i++) {
    const strut_parameter *p = &writer->scene->parameters[i];
    strut_put(writer, "  ");
    strut_put(writer, p->name);
    strut_put(writer, ": ");
    if (isnan(p->value))
      strut_put_quoted(writer, p->text);
    else
      put_expression(writer, p->text);
    strut_put(writer, "\n");
  }
}

static void put_head(strut_writer *writer) {
  const strut_scene *scene = writer->scene;
  strut_put(writer, "# The scene as it was used, in SI units.\nstrut: 1\n");
  put_text(writer, "name", scene->name);
  put_text(writer, "description", scene->description);
  put_text(writer, "source", scene->source);
  put_parameters(writer);
  strut_put(writer, "mass_model: ");
  strut_put(writer, scene->mass_model == STRUT_MASS_LUMPED ? "lumped\n" : "consistent\n");
  if (scene->bar_model == STRUT_BARS_RIGID) strut_put(writer, "bars: rigid\n");
  strut_put(writer, "gravity: ");
  strut_put_pair(writer, scene->gravity);
  strut_put(writer, "\n");
}

static void put_nodes(strut_writer *writer) {
  static const char *const supports[] = {"none", "x", "y", "both"};
  strut_put(writer, "nodes:\n");
  for (size_t i = 0; i < writer->scene->node_count; i++) {
    const strut_node *node = &writer->scene->nodes[i];
    int fixed = (node->fixed[0] ? 1 : 0) + (node->fixed[1] ? 2 : 0);
    bool first = false, bare = !fixed && node->mass == 0.0 && !signbit(node->mass);
    strut_put(writer, "  ");
    strut_put_name(writer, node->name);
    strut_put(writer, bare ? ": " : ": {position: ");
    strut_put_pair(writer, node->position);
    strut_put_value(writer, &first, "mass", node->mass);
    if (fixed) {
      strut_put_key(writer, &first, "fixed");
      strut_put(writer, supports[fixed]);
    }
    strut_put(writer, bare ? "\n" : "}\n");
  }
}

static void put_members(strut_writer *writer) {
  static const char *const kinds[] = {"bar", "spring", "cable"};
  static const char *const rests[] = {"rest_length_ratio", "rest_length", "pretension",
                                      "force_density"};
  const strut_scene *scene = writer->scene;
  if (scene->member_count) strut_put(writer, "members:\n");
  for (size_t i = 0; i < scene->member_count; i++) {
    const strut_member *m = &scene->members[i];
    bool first = false;
    strut_put(writer, "  ");
    strut_put_name(writer, m->name);
    strut_put(writer, ": {nodes: [");
    strut_put_name(writer, scene->nodes[m->node[0]].name);
    strut_put(writer, ", ");
    strut_put_name(writer, scene->nodes[m->node[1]].name);
    strut_put(writer, "], kind: ");
    strut_put(writer, kinds[m->kind]);
    strut_put_value(writer, &first, "stiffness", m->stiffness);
    strut_put_value(writer, &first, "axial_stiffness", m->axial_stiffness);
    strut_put_value(writer, &first, "damping", m->damping);
    strut_put_value(writer, &first, "mass", m->mass);
    strut_put_key(writer, &first, rests[m->rest_kind]);
    strut_put_number(writer, m->rest_value);
    strut_put(writer, "}\n");
  }
}

static bool no_friction(const strut_friction *f) {
  return f->law == STRUT_FRICTION_NONE && f->mu_static == 0.0 && f->mu_kinetic == 0.0 &&
         f->stick_velocity == 0.0 && f->width == 0.0;
}

static bool same_friction(const strut_friction *a, const strut_friction *b) {
  return a->law == b->law &&
         same((const double[2]){a->mu_static, a->mu_kinetic},
              (const double[2]){b->mu_static, b->mu_kinetic}) &&
         a->stick_velocity == b->stick_velocity && a->width == b->width;
}

static void put_friction(strut_writer *writer, const strut_friction *f) {
  static const char *const laws[] = {"none", "karnopp", "coulomb", "smooth"};
  bool first = false;
  strut_put(writer, "{law: ");
  strut_put(writer, laws[f->law]);
  strut_put_key(writer, &first, "mu_static");
  strut_put_number(writer, f->mu_static);
  strut_put_key(writer, &first, "mu_kinetic");
  strut_put_number(writer, f->mu_kinetic);
  strut_put_value(writer, &first, "stick_velocity", f->stick_velocity);
  strut_put_value(writer, &first, "width", f->width);
  strut_put(writer, "}");
}

/* What is different for one contact. Frictions are given to all of them, or to each. */
static bool put_contact(strut_writer *writer, const strut_contact *c, bool shared, bool begun) {
  const strut_scene *scene = writer->scene;
  const strut_contact *all = &scene->contacts[0];
  bool first = true, friction = !shared && !no_friction(&c->friction);
  bool stiffness = c->stiffness != all->stiffness, damping = c->damping != all->damping;
  bool dissipation = c->dissipation != all->dissipation;
  if (!stiffness && !damping && !dissipation && !friction) return begun;
  strut_put(writer, begun ? "    " : "  contacts:\n    ");
  strut_put_name(writer, scene->nodes[c->node].name);
  strut_put(writer, ": {");
  if (stiffness) strut_put_value(writer, &first, "stiffness", c->stiffness);
  if (damping) strut_put_key(writer, &first, "damping");
  if (damping) strut_put_number(writer, c->damping);
  if (dissipation) strut_put_key(writer, &first, "dissipation");
  if (dissipation) strut_put_number(writer, c->dissipation);
  if (friction) strut_put_key(writer, &first, "friction");
  if (friction) put_friction(writer, &c->friction);
  strut_put(writer, "}\n");
  return true;
}

static void put_line(strut_writer *writer, const char *key, double value) {
  bool first = true;
  if (value == 0.0 && !signbit(value)) return;
  strut_put(writer, "  ");
  strut_put_value(writer, &first, key, value);
  strut_put(writer, "\n");
}

static void put_ground(strut_writer *writer) {
  const strut_scene *scene = writer->scene;
  const strut_contact *all = scene->contacts;
  bool shared = true, begun = false;
  if (!scene->ground.present || !scene->contact_count) return;
  strut_put(writer, "ground:\n");
  put_line(writer, "height", scene->ground.height);
  put_line(writer, "slope", scene->ground.slope);
  put_line(writer, "belt_speed", scene->ground.belt_speed);
  put_line(writer, "stiffness", all->stiffness);
  put_line(writer, "damping", all->damping);
  if (scene->ground.damping_law == STRUT_DAMPING_HUNT_CROSSLEY)
    strut_put(writer, "  damping_law: hunt_crossley\n");
  put_line(writer, "dissipation", all->dissipation);
  for (size_t i = 1; i < scene->contact_count; i++)
    if (!same_friction(&all[i].friction, &all->friction)) shared = false;
  if (shared && !no_friction(&all->friction)) {
    strut_put(writer, "  friction: ");
    put_friction(writer, &all->friction);
    strut_put(writer, "\n");
  }
  strut_put(writer, "  nodes: ");
  if (scene->contact_count == scene->node_count) strut_put(writer, "all");
  for (size_t i = 0; i < scene->contact_count && scene->contact_count < scene->node_count; i++) {
    strut_put(writer, i ? ", " : "[");
    strut_put_name(writer, scene->nodes[all[i].node].name);
  }
  strut_put(writer, scene->contact_count < scene->node_count ? "]\n" : "\n");
  for (size_t i = 0; i < scene->contact_count; i++)
    begun = put_contact(writer, &all[i], shared, begun);
}

/* Is the signal whose periods count one that nothing names? Then it gets a name of its own. */
static int32_t nameless_period(const strut_scene *scene, const strut_experiment *e) {
  if (e->periods == 0.0 || scene->signals[e->period_signal].name) return -1;
  for (size_t i = 0; i < scene->actuator_count; i++)
    if (scene->actuators[i].signal == e->period_signal) return -1;
  for (size_t i = 0; i < scene->load_count; i++)
    if (scene->loads[i].signal == e->period_signal) return -1;
  return e->period_signal;
}

char *strut_setup_write(const strut_setup *setup) {
  const strut_experiment *e = &setup->experiment;
  strut_writer writer = {
      .scene = &setup->scene, .experiment = e, .period_signal = nameless_period(&setup->scene, e)};
  strut_c_locale locale = strut_c_locale_enter();
  put_head(&writer);
  put_nodes(&writer);
  put_members(&writer);
  put_ground(&writer);
  strut_put_drives(&writer);
  strut_put_shapes(&writer);
  strut_put_experiment(&writer);
  strut_c_locale_leave(locale);
  if (!writer.failed) return writer.text;
  strut_release(writer.text);
  return NULL;
}
