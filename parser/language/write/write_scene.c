/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The structure and its drives as YAML, and the order of the whole file. See write_scene.h. */
#include "parser/language/write/write_scene.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/text.h"
#include "engine/base/vec.h"
#include "parser/language/write/writer.h"

/* ---- signals, and what they drive ---- */

const char *strut_signal_name(const strut_writer *writer, int32_t index) {
  assert(index >= 0 && (size_t)index < writer->scene->signal_count);
  const char *name = writer->scene->signals[index].name;
  return name ? name : index == writer->period_signal ? "signal_of_the_period" : NULL;
}

void strut_put_signal_reference(strut_writer *writer, int32_t index) {
  const strut_signal *signal = &writer->scene->signals[index];
  const strut_signal usual = strut_signal_default(signal->kind);
  const char *name = strut_signal_name(writer, index);
  if (name)
    strut_put_name(writer, name);
  else
    strut_put_mapping(writer, STRUT_SECTION_SIGNAL, signal, &usual, NULL);
}

static void put_named_signals(strut_writer *writer) {
  bool any = false;
  for (size_t i = 0; i < writer->scene->signal_count; i++) {
    const strut_signal *signal = &writer->scene->signals[i];
    const strut_signal usual = strut_signal_default(signal->kind);
    const char *name = strut_signal_name(writer, (int32_t)i);
    if (!name || signal->kind == STRUT_RELAY) continue;
    strut_put(writer, any ? "  " : "signals:\n  ");
    any = true;
    strut_put_line(writer, name, STRUT_SECTION_SIGNAL, signal, &usual, NULL);
  }
}

/* PID controllers have become signals and states. */
static void put_relays(strut_writer *writer) {
  bool any = false;
  strut_signal usual = strut_signal_default(STRUT_RELAY);
  usual.relay.off = (double)NAN; /* it is always written */
  for (size_t i = 0; i < writer->scene->signal_count; i++) {
    const strut_signal *signal = &writer->scene->signals[i];
    if (signal->kind != STRUT_RELAY) continue;
    strut_put(writer, any ? "  " : "controllers:\n  ");
    any = true;
    strut_put_line(writer, signal->name, STRUT_SECTION_RELAY, signal, &usual, NULL);
  }
}

static void put_drives(strut_writer *writer) {
  const strut_sliding_mass placed = {.member = -1,
                                     .share = (double)NAN}; /* the position is always written */
  strut_put_things(writer, STRUT_THING_SENSOR, STRUT_SECTION_SENSOR, NULL);
  strut_put_things(writer, STRUT_THING_STATE, STRUT_SECTION_STATE, NULL);
  put_named_signals(writer);
  put_relays(writer);
  strut_put_things(writer, STRUT_THING_ACTUATOR, STRUT_SECTION_ACTUATOR, NULL);
  strut_put_things(writer, STRUT_THING_UNBALANCE, STRUT_SECTION_UNBALANCE, NULL);
  strut_put_things(writer, STRUT_THING_SLIDER, STRUT_SECTION_SLIDER, &placed);
  strut_put_things(writer, STRUT_THING_LOAD, STRUT_SECTION_LOAD, NULL);
}

/* ---- the whole file ---- */

/* An expression, on one line. */
static void put_expression(strut_writer *writer, const char *text) {
  char one[2] = {0};
  for (; *text; text++) {
    one[0] = *text;
    strut_put(writer, strchr("\r\n\t", *text) ? " " : one);
  }
}

/* For the record only: the numbers below contain them already. */
static void put_parameters(strut_writer *writer) {
  strut_put(writer, "# as they were; their values stand in the numbers below");
  for (size_t i = 0; i < writer->scene->parameter_count; i++) {
    const strut_parameter *parameter = &writer->scene->parameters[i];
    strut_put(writer, "\n  ");
    strut_put(writer, parameter->name);
    strut_put(writer, ": ");
    if (isnan(parameter->value))
      strut_put_quoted(writer, parameter->text);
    else
      put_expression(writer, parameter->text);
  }
}

static void put_head_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                             const void *object) {
  const strut_scene *scene = object;
  if (key == STRUT_KEY_SCENE_PARAMETERS && scene->parameter_count) {
    strut_put_key_name(writer, mapping, key);
    put_parameters(writer);
  } else if (key == STRUT_KEY_SCENE_LATTICE && scene->lattice_count) {
    strut_put_key_name(writer, mapping, key);
    for (int k = 0; k < scene->lattice_count; k++) {
      strut_put(writer, k ? ", " : "[");
      strut_put_pair(writer, scene->lattice[k]);
    }
    strut_put(writer, "]");
  }
}

static void put_head(strut_writer *writer) {
  strut_mapping mapping = STRUT_MAPPING_LINES("");
  strut_put(writer, "# The scene as it was used, in SI units.");
  strut_put_fields(writer, &mapping, STRUT_SECTION_SCENE, writer->scene, &writer->usual,
                   put_head_by_hand);
  strut_put(writer, "\n");
}

static void put_units(strut_writer *writer, strut_mapping *mapping, int key, const void *object) {
  const strut_data_table *table = object;
  if (key != STRUT_KEY_DATA_UNITS || !table->unit_count) return;
  strut_put_key_name(writer, mapping, key);
  for (size_t i = 0; i < table->unit_count; i++) {
    strut_put(writer, i ? ", " : "{");
    strut_put_name(writer, table->units[2 * i]);
    strut_put(writer, ": ");
    strut_put_quoted(writer, table->units[2 * i + 1]);
  }
  strut_put(writer, "}");
}

static void put_data(strut_writer *writer) {
  static const strut_data_table usual = STRUT_DATA_USUAL;
  for (size_t i = 0; i < writer->scene->table_count; i++) {
    strut_put(writer, i ? "  " : "data:\n  ");
    strut_put_line(writer, writer->scene->tables[i].name, STRUT_SECTION_DATA,
                   &writer->scene->tables[i], &usual, put_units);
  }
}

/* The node is a copy; its name is the scene's. */
static void put_node_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                             const void *object) {
  const strut_scene *scene = writer->scene;
  const char *name = ((const strut_node *)object)->name;
  bool any = false;
  if (key != STRUT_KEY_NODE_MOVES) return;
  for (size_t i = 0; i < scene->support_motion_count; i++) {
    const strut_support_motion *motion = &scene->support_motions[i];
    if (scene->nodes[motion->node].name != name) continue;
    if (!any) strut_put_key_name(writer, mapping, key);
    strut_put(writer, any ? ", " : "{");
    strut_put(writer, motion->axis ? "y: " : "x: ");
    strut_put_signal_reference(writer, motion->signal);
    any = true;
  }
  if (any) strut_put(writer, "}");
}

/* The node with what its motion says already left out. True if it moves. */
static bool leave_out_moves(const strut_scene *scene, size_t i, strut_node *node) {
  bool moves = false;
  for (size_t k = 0; k < scene->support_motion_count; k++) {
    const strut_support_motion *motion = &scene->support_motions[k];
    if ((size_t)motion->node != i) continue;
    node->fixed[motion->axis] = false;
    moves = true;
  }
  return moves;
}

static void put_nodes(strut_writer *writer) {
  strut_put(writer, "nodes:\n");
  for (size_t i = 0; i < writer->scene->node_count; i++) {
    strut_node copy = writer->scene->nodes[i];
    const strut_node *node = &copy;
    strut_mapping mapping = STRUT_MAPPING_INLINE;
    bool moves = leave_out_moves(writer->scene, i, &copy);
    strut_node drawn = strut_node_default(); /* nothing but a position */
    memcpy(drawn.position, node->position, sizeof drawn.position);
    bool bare = !moves && !strut_fields_differ(STRUT_SECTION_NODE, node, &drawn);
    strut_put(writer, "  ");
    strut_put_name(writer, node->name);
    strut_put(writer, bare ? ": " : ": {");
    if (bare)
      strut_put_pair(writer, node->position);
    else
      strut_put_fields(writer, &mapping, STRUT_SECTION_NODE, node, &drawn, put_node_by_hand);
    strut_put(writer, bare ? "\n" : "}\n");
  }
}

void strut_put_law(strut_writer *writer, const strut_law *law) {
  strut_law usual = {.kind = STRUT_LAW_LINEAR};
  for (int i = 0; i < STRUT_LAW_NUMBER_COUNT; i++) /* what a law needs is written, zero or not */
    if (strut_law_needs(law->kind, i)) *strut_law_number(&usual, i) = (double)NAN;
  strut_put_mapping(writer, STRUT_SECTION_LAW, law, &usual, NULL);
}

static void put_rayleigh(strut_writer *writer) {
  if (strut_fields_differ(STRUT_SECTION_RAYLEIGH, writer->scene, &writer->usual.scene))
    strut_put_line(writer, "rayleigh", STRUT_SECTION_RAYLEIGH, writer->scene, &writer->usual.scene,
                   NULL);
}

static bool frictions_differ(const strut_friction *first, const strut_friction *second) {
  return strut_fields_differ(STRUT_SECTION_FRICTION, first, second) ||
         first->directional != second->directional || first->driven != second->driven ||
         first->signal != second->signal;
}

static bool has_friction(const strut_friction *friction) {
  const strut_friction none = {STRUT_FRICTION_NONE};
  return frictions_differ(friction, &none);
}

static void put_friction(strut_writer *writer, const strut_friction *friction) {
  strut_friction usual = {STRUT_FRICTION_NONE};
  /* all its coefficients are written, of one with a signal none */
  usual.mu_static = usual.mu_kinetic = friction->driven ? friction->mu_static : (double)NAN;
  if (friction->directional) usual.mu_static_backward = usual.mu_kinetic_backward = (double)NAN;
  strut_put_mapping(writer, STRUT_SECTION_FRICTION, friction, &usual, NULL);
}

/* Contacts of the ground that is being written; those of further pieces are like that of the first. */
static bool is_written(const strut_writer *writer, const strut_contact *contact) {
  return contact->ground == writer->ground && contact->piece == 0;
}

/* The first contact of the ground that is being written, or NULL. */
static const strut_contact *first_contact(const strut_writer *writer) {
  for (size_t i = 0; i < writer->scene->contact_count; i++)
    if (is_written(writer, &writer->scene->contacts[i])) return &writer->scene->contacts[i];
  return NULL;
}

/* Friction is written once for all contacts where they share it, else for each contact that has it. */
static bool friction_is_shared(const strut_writer *writer) {
  const strut_scene *scene = writer->scene;
  const strut_contact *first = first_contact(writer);
  for (size_t i = 0; i < scene->contact_count; i++)
    if (is_written(writer, &scene->contacts[i]) &&
        frictions_differ(&scene->contacts[i].friction, &first->friction))
      return false;
  return true;
}

/* The keys in which one contact differs from the first. */
static void put_contact(strut_writer *writer, const strut_contact *contact, bool friction) {
  strut_mapping mapping = STRUT_MAPPING_INLINE;
  strut_put_name(writer, writer->scene->nodes[contact->node].name);
  strut_put(writer, ": {");
  strut_put_fields(writer, &mapping, STRUT_SECTION_CONTACT, contact, first_contact(writer), NULL);
  if (friction) {
    strut_put_key_name(writer, &mapping, STRUT_KEY_CONTACT_FRICTION);
    put_friction(writer, &contact->friction);
  }
  strut_put(writer, "}");
}

static void put_contacts(strut_writer *writer, strut_mapping *mapping) {
  const strut_scene *scene = writer->scene;
  const strut_contact *first = first_contact(writer);
  bool shared = friction_is_shared(writer), begun = false;
  for (size_t i = 0; i < scene->contact_count; i++) {
    const strut_contact *contact = &scene->contacts[i];
    if (!is_written(writer, contact)) continue;
    bool friction = !shared && has_friction(&contact->friction);
    if (!friction && !strut_fields_differ(STRUT_SECTION_CONTACT, contact, first)) continue;
    if (!begun) strut_put(writer, mapping->separator);
    if (!begun) strut_put(writer, "contacts:");
    strut_put(writer, mapping->next);
    strut_put(writer, "  ");
    begun = true;
    put_contact(writer, contact, friction);
  }
}

static void put_ground_nodes(strut_writer *writer) {
  const strut_scene *scene = writer->scene;
  size_t count = 0;
  for (size_t i = 0; i < scene->contact_count; i++)
    count += is_written(writer, &scene->contacts[i]);
  bool every = count == scene->node_count, begun = false;
  strut_put(writer, every ? "all" : "[");
  for (size_t i = 0; i < scene->contact_count && !every; i++) {
    if (!is_written(writer, &scene->contacts[i])) continue;
    if (begun) strut_put(writer, ", ");
    begun = true;
    strut_put_name(writer, scene->nodes[scene->contacts[i].node].name);
  }
  if (!every) strut_put(writer, "]");
}

static void put_ground_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                               const void *object) {
  const strut_ground_section *section = object;
  if (key == STRUT_KEY_GROUND_FRICTION) {
    const strut_friction *friction = &section->contact.friction;
    if (!friction_is_shared(writer) || !has_friction(friction)) return;
    strut_put_key_name(writer, mapping, key);
    put_friction(writer, friction);
  } else if (key == STRUT_KEY_GROUND_CONTACTS) {
    put_contacts(writer, mapping);
  } else if (key == STRUT_KEY_GROUND_NODES) { /* a normal is written as the slope */
    strut_put_key_name(writer, mapping, key);
    put_ground_nodes(writer);
  }
}

/* The keys of one ground, on lines that begin with `indent`, a line break before it. */
static void put_one_ground(strut_writer *writer, const strut_ground *ground, const char *indent) {
  const strut_ground_section usual = {.contact = strut_contact_default()};
  strut_mapping mapping = {indent, indent};
  const strut_contact *first = first_contact(writer);
  if (!first) return;
  strut_ground_section section = {.ground = *ground, .contact = *first};
  strut_put_fields(writer, &mapping, STRUT_SECTION_GROUND, &section, &usual, put_ground_by_hand);
}

static void put_ground(strut_writer *writer) {
  const strut_scene *scene = writer->scene;
  bool single = scene->ground_count == 1 && !*scene->grounds[0].name;
  if (!strut_scene_has_ground(scene) || !scene->contact_count) return;
  strut_put(writer, single || scene->ground.present ? "ground:" : "grounds:");
  if (scene->ground.present) put_one_ground(writer, &scene->ground, "\n  ");
  for (size_t g = 0; g < scene->ground_count; g++) {
    writer->ground = (int32_t)g;
    if (!single) {
      strut_put(writer, "\n  ");
      strut_put_name(writer, scene->grounds[g].name);
      strut_put(writer, ":");
    }
    put_one_ground(writer, &scene->grounds[g], single ? "\n  " : "\n    ");
  }
  strut_put(writer, "\n");
}

/* The signal whose periods count, if it has no name and nothing named uses it; else -1. */
static int32_t nameless_period(const strut_scene *scene, const strut_experiment *experiment) {
  if (experiment->periods == 0.0 || scene->signals[experiment->period_signal].name) return -1;
  for (size_t i = 0; i < scene->actuator_count; i++)
    if (scene->actuators[i].signal == experiment->period_signal) return -1;
  for (size_t i = 0; i < scene->load_count; i++)
    if (scene->loads[i].signal == experiment->period_signal) return -1;
  for (size_t i = 0; i < scene->ground_count; i++)
    for (int c = 0; c < 2; c++)
      if (scene->grounds[i].moves[c] && scene->grounds[i].motion[c] == experiment->period_signal)
        return -1;
  return experiment->period_signal;
}

char *strut_setup_write(const strut_setup *setup) {
  const strut_experiment *experiment = &setup->experiment;
  strut_writer writer = {.scene = &setup->scene,
                         .experiment = experiment,
                         .period_signal = nameless_period(&setup->scene, experiment)};
  strut_setup_init(&writer.usual);
  strut_c_locale locale = strut_c_locale_enter();
  put_head(&writer);
  put_data(&writer);
  put_nodes(&writer);
  strut_put_things(&writer, STRUT_THING_MEMBER, STRUT_SECTION_MEMBER, NULL);
  strut_put_things(&writer, STRUT_THING_HINGE, STRUT_SECTION_HINGE, NULL);
  strut_put_things(&writer, STRUT_THING_CELL, STRUT_SECTION_CELL, NULL);
  strut_put_things(&writer, STRUT_THING_COLLISION, STRUT_SECTION_COLLISION, NULL);
  strut_put_things(&writer, STRUT_THING_DISTANCE, STRUT_SECTION_DISTANCE, NULL);
  strut_put_things(&writer, STRUT_THING_FOOT, STRUT_SECTION_FOOT, NULL);
  put_rayleigh(&writer);
  put_ground(&writer);
  put_drives(&writer);
  strut_put_shapes(&writer);
  strut_put_experiment(&writer);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&writer.out);
}
