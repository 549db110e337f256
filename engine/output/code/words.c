/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The words of the templates, and the names and literals of the text. */
#include <assert.h>
#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/number_text.h"
#include "engine/model/mass.h"
#include "engine/output/code/templates.h"
#include "engine/output/code/writer.h"

/* ---- literals and comments ---- */

static void add_literal(strut_code_writer *w, const char *digits, const char *suffix) {
  strut_buffer_add(&w->text, "%s%s%s", digits, strpbrk(digits, ".e") ? "" : ".0", suffix);
}

void strut_code_add_double(strut_code_writer *w, double value) {
  char text[STRUT_NUMBER_TEXT];
  strut_number_text(value, text);
  add_literal(w, text, "");
}

void strut_code_add_real(strut_code_writer *w, double value) {
  char text[STRUT_NUMBER_TEXT];
  if (!w->options->single) {
    strut_code_add_double(w, value);
    return;
  }
  float nearest = (float)value;
  if (!isfinite(nearest)) w->no_float = true;
  int digits = 1;
  do snprintf(text, sizeof text, "%.*g", digits, (double)nearest);
  while (digits++ < FLT_DECIMAL_DIG &&
         !(strtof(text, NULL) >= nearest && strtof(text, NULL) <= nearest));
  add_literal(w, text, "f");
}

void strut_code_add_comment(strut_code_writer *w, const char *text) {
  for (const unsigned char *c = (const unsigned char *)text; *c; c++)
    strut_buffer_add(&w->text, "%c", *c < 32 || *c == 127 || strchr("*\\?", *c) ? '_' : *c);
}

void strut_code_add_field(strut_code_writer *w, double value) {
  strut_buffer_add(&w->text, ", ");
  strut_code_add_real(w, value);
}

void strut_code_end_row(strut_code_writer *w, const char *name) {
  strut_buffer_add(&w->text, "}, /* ");
  strut_code_add_comment(w, name ? name : "");
  strut_buffer_add(&w->text, " */\n");
}

void strut_code_add_constant(strut_code_writer *w, const char *name, double value) {
  strut_buffer_add(&w->text, "static const real %s = ", name);
  strut_code_add_real(w, value);
  strut_buffer_add(&w->text, ";\n");
}

/* ---- identifiers ---- */

bool strut_code_is_prefix(const char *text) {
  size_t length = strlen(text);
  if (length < 1 || length > 64 || !isalpha((unsigned char)text[0])) return false;
  for (; *text; text++)
    if (!isalnum((unsigned char)*text) && *text != '_') return false;
  return true;
}

static char identifier_letter(char c) {
  bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
  return plain ? c : '_';
}

void strut_code_prefix_of(const char *text, char prefix[65]) {
  const char *slash = strrchr(text, '/'), *stem = slash ? slash + 1 : text;
  size_t length = strcspn(stem, "."), used = 0;
  bool letter = (*stem >= 'a' && *stem <= 'z') || (*stem >= 'A' && *stem <= 'Z');
  if (!letter && length) used = (size_t)snprintf(prefix, 65, "model_");
  if (!length) used = (size_t)snprintf(prefix, 65, "model");
  for (size_t i = 0; i < length && used < 64; i++) prefix[used++] = identifier_letter(stem[i]);
  prefix[used] = '\0';
}

static bool make_names(strut_code_writer *w, strut_code_names *names, size_t count,
                       const char *(*name_of)(strut_code_writer *, size_t)) {
  strut_name_map taken = {0};
  bool good = true;
  names->count = count;
  names->name = strut_arena_allocate(&w->arena, count, sizeof *names->name);
  if (!names->name) return false;
  for (size_t i = 0; i < count && good; i++) {
    const char *given = name_of(w, i), *text = given ? given : "";
    size_t length = strlen(text);
    char *name = strut_arena_allocate(&w->arena, length + 24, 1);
    if (!name) {
      good = false;
      break;
    }
    for (size_t k = 0; k < length; k++) name[k] = identifier_letter(text[k]);
    int32_t other = strut_name_map_add(&taken, name, (int32_t)i);
    for (int again = 2; other >= 0; again++) {
      snprintf(name + length, 24, "_%d", again);
      other = strut_name_map_add(&taken, name, (int32_t)i);
    }
    good = other == -1;
    names->name[i] = name;
  }
  strut_name_map_free(&taken);
  return good;
}

static const char *node_name(strut_code_writer *w, size_t i) { return w->scene->nodes[i].name; }
static const char *member_name(strut_code_writer *w, size_t i) { return w->scene->members[i].name; }

/* The n-th load of the scene that has a signal. */
static const strut_load *driven_load(const strut_scene *scene, size_t n) {
  for (size_t i = 0; i < scene->load_count; i++)
    if (scene->loads[i].signal >= 0 && n-- == 0) return &scene->loads[i];
  assert(false && "inputs are counted from the same loads");
  return NULL;
}

/* The n-th actuator of the scene that gives a force, or that gives none. */
static const strut_actuator *actuator(const strut_scene *scene, bool force, size_t n) {
  for (size_t i = 0; i < scene->actuator_count; i++)
    if (scene->actuators[i].force == force && n-- == 0) return &scene->actuators[i];
  assert(false && "inputs are counted from the same actuators");
  return NULL;
}

/* "GROUND_x" */
static const char *shake_name(strut_code_writer *w, size_t n) {
  int axis;
  const strut_ground *ground = strut_code_shaken(w->model, (int32_t)n, &axis);
  const char *of = ground->name && ground->name[0] ? ground->name : "ground";
  size_t length = strlen(of) + 3;
  char *name = strut_arena_allocate(&w->arena, length, 1);
  if (name) snprintf(name, length, "%s_%c", of, "xy"[axis]);
  return name;
}

static const char *input_name(strut_code_writer *w, size_t i) {
  size_t drives = (size_t)w->model->drives.count, loads = (size_t)w->model->loads.count;
  size_t others = drives + loads + (size_t)w->model->actuator_forces.count;
  return i >= others          ? shake_name(w, i - others)
         : i < drives         ? actuator(w->scene, false, i)->name
         : i < drives + loads ? driven_load(w->scene, i - drives)->name
                              : actuator(w->scene, true, i - drives - loads)->name;
}

static const char *breakable_name(strut_code_writer *w, size_t i) {
  const strut_breakable *b = &w->model->elements.breakable[i];
  return b->role == STRUT_ELEMENT_HINGE ? w->scene->hinges[b->item].name
                                        : w->scene->members[b->item].name;
}

bool strut_code_make_names(strut_code_writer *w) {
  return make_names(w, &w->nodes, w->scene->node_count, node_name) &&
         make_names(w, &w->members, w->scene->member_count, member_name) &&
         make_names(w, &w->inputs, (size_t)strut_code_input_count(w->model), input_name) &&
         make_names(w, &w->breakables, (size_t)w->model->elements.breakable_count, breakable_name);
}

/* ---- conditions ---- */

static bool has_law(const strut_code_writer *w, strut_friction_law law) {
  const strut_contact_table *c = &w->model->contacts;
  for (int32_t i = 0; i < c->count; i++)
    if (c->entry[i].friction.law == law) return true;
  return false;
}
static bool in_plan(const strut_code_writer *w, unsigned term) { return w->model->plan & term; }

static bool has_float(const strut_code_writer *w) { return w->options->single; }
static bool has_inputs(const strut_code_writer *w) { return strut_code_input_count(w->model) > 0; }
static bool has_drive(const strut_code_writer *w) { return w->model->drives.count > 0; }
static bool has_loads(const strut_code_writer *w) { return w->model->loads.count > 0; }
static bool has_members(const strut_code_writer *w) { return w->scene->member_count > 0; }
static bool has_damping(const strut_code_writer *w) { return in_plan(w, STRUT_TERM_DAMPING); }
static bool has_slack(const strut_code_writer *w) { return in_plan(w, STRUT_TERM_SLACK); }
static bool has_constant(const strut_code_writer *w) { return in_plan(w, STRUT_TERM_CONSTANT); }
static bool has_contact(const strut_code_writer *w) {
  return in_plan(w, STRUT_TERM_CONTACT | STRUT_TERM_SURFACES);
}
static bool has_surfaces(const strut_code_writer *w) { return in_plan(w, STRUT_TERM_SURFACES); }
static bool has_shaken(const strut_code_writer *w) { return strut_code_shake_count(w->model) > 0; }
static bool has_slope(const strut_code_writer *w) { return in_plan(w, STRUT_TERM_SLOPE); }
static bool has_friction(const strut_code_writer *w) {
  return has_contact(w) && in_plan(w, STRUT_TERM_FRICTION);
}
static bool has_smooth(const strut_code_writer *w) { return has_law(w, STRUT_FRICTION_SMOOTH); }
/* Contacts without friction among others have Karnopp's with coefficients of 0. */
static bool has_karnopp(const strut_code_writer *w) {
  return has_friction(w) && (has_law(w, STRUT_FRICTION_KARNOPP) || has_law(w, STRUT_FRICTION_NONE));
}
static bool has_directional(const strut_code_writer *w) { return in_plan(w, STRUT_TERM_DIRECTION); }
static bool has_speed(const strut_code_writer *w) { return has_karnopp(w) || has_directional(w); }
static bool has_elements(const strut_code_writer *w) { return w->model->elements.count > 0; }
static bool has_actuator_forces(const strut_code_writer *w) {
  return w->model->actuator_forces.count > 0;
}
static bool has_strains(const strut_code_writer *w) {
  return has_elements(w) || has_actuator_forces(w);
}
static bool has_path(const strut_code_writer *w) { return strut_code_has_strain(w, "path", 4); }
static bool has_angle(const strut_code_writer *w) { return strut_code_has_strain(w, "angle", 5); }
static bool has_expressions(const strut_code_writer *w) {
  return strut_code_has_signal(w, STRUT_EXPRESSION);
}
static bool has_memory(const strut_code_writer *w) { return in_plan(w, STRUT_TERM_MEMORY); }
static bool has_root(const strut_code_writer *w) {
  return has_members(w) || has_smooth(w) || has_path(w) || strut_code_has_strain(w, "reach", 5) ||
         strut_code_has_circles(w) || strut_code_has_pieces(w);
}
static bool has_belt(const strut_code_writer *w) { return w->model->contacts.belt_speed != 0.0; }
static bool has_hunt_crossley(const strut_code_writer *w) {
  const strut_contact_table *c = &w->model->contacts;
  bool some = w->scene->ground.damping_law == STRUT_DAMPING_HUNT_CROSSLEY;
  for (int32_t i = 0; i < c->count; i++) some = some || c->entry[i].dissipation > 0.0;
  return some;
}
static bool has_gravity(const strut_code_writer *w) {
  return w->scene->gravity[0] != 0.0 || w->scene->gravity[1] != 0.0;
}
static bool has_consistent(const strut_code_writer *w) {
  return w->scene->mass_model == STRUT_MASS_CONSISTENT;
}
static bool has_groups(const strut_code_writer *w) {
  const strut_mass_operator *op = w->model->mass->coordinate;
  return op[0].block_count || op[1].block_count;
}
static bool has_factor(const strut_code_writer *w) {
  const strut_mass_operator *op = w->model->mass->coordinate;
  return op[0].factor || op[1].factor;
}
static bool has_wave(const strut_code_writer *w) {
  return strut_code_has_signal(w, STRUT_SINE) || strut_code_has_signal(w, STRUT_HALF_SINE);
}
static bool has_table_signal(const strut_code_writer *w) {
  return strut_code_has_signal(w, STRUT_TABLE);
}

bool strut_code_has(const strut_code_writer *w, const char *word, size_t length) {
  static const struct {
    const char *word;
    bool (*holds)(const strut_code_writer *);
  } words[] = {{"float", has_float},
               {"inputs", has_inputs},
               {"drive", has_drive},
               {"loads", has_loads},
               {"members", has_members},
               {"damping", has_damping},
               {"slack", has_slack},
               {"constant", has_constant},
               {"contact", has_contact},
               {"slope", has_slope},
               {"friction", has_friction},
               {"smooth", has_smooth},
               {"karnopp", has_karnopp},
               {"directional", has_directional},
               {"speed", has_speed},
               {"root", has_root},
               {"belt", has_belt},
               {"hunt_crossley", has_hunt_crossley},
               {"gravity", has_gravity},
               {"consistent", has_consistent},
               {"groups", has_groups},
               {"factor", has_factor},
               {"wave", has_wave},
               {"table_signal", has_table_signal},
               {"elements", has_elements},
               {"actuator_forces", has_actuator_forces},
               {"strains", has_strains},
               {"path", has_path},
               {"angle", has_angle},
               {"expressions", has_expressions},
               {"memory", has_memory},
               {"breakables", strut_code_has_breakables},
               {"surfaces", has_surfaces},
               {"shaken", has_shaken},
               {"circles", strut_code_has_circles},
               {"pieces", strut_code_has_pieces},
               {"facets", strut_code_has_facets},
               {"belts", strut_code_has_belts},
               {"corners", strut_code_has_corners}};
  static const struct {
    const char *prefix;
    bool (*holds)(const strut_code_writer *, const char *, size_t);
  } families[] = {{"strain_", strut_code_has_strain},
                  {"law_", strut_code_has_law},
                  {"op_", strut_code_has_operation}};
  for (size_t i = 0; i < sizeof families / sizeof families[0]; i++) {
    size_t skip = strlen(families[i].prefix);
    if (length > skip && !memcmp(word, families[i].prefix, skip))
      return families[i].holds(w, word + skip, length - skip);
  }
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
    if (strlen(words[i].word) == length && !memcmp(words[i].word, word, length))
      return words[i].holds(w);
  assert(false && "a template asks for a word that there is not");
  return false;
}

bool strut_code_holds(const strut_code_writer *w, const char *word) {
  return strut_code_has(w, word, strlen(word));
}

/* ---- tables and numbers ---- */

static void add_title(strut_code_writer *w) {
  strut_buffer_add(&w->text, " * ");
  strut_code_add_comment(w, w->scene->name[0] ? w->scene->name : w->options->prefix);
  strut_buffer_add(&w->text, "\n");
  if (w->scene->source[0]) {
    strut_buffer_add(&w->text, " * ");
    strut_code_add_comment(w, w->scene->source);
    strut_buffer_add(&w->text, "\n");
  }
  strut_buffer_add(&w->text, " *\n * Written by %s export --code", w->options->program);
  const strut_scene *scene = w->scene;
  for (size_t i = 0; i < scene->parameter_count; i++) {
    strut_buffer_add(&w->text, i ? ", " : "\n * with ");
    strut_code_add_comment(w, scene->parameters[i].name);
    strut_buffer_add(&w->text, " = ");
    strut_code_add_comment(w, scene->parameters[i].text);
  }
  strut_buffer_add(&w->text, ".\n");
}

static void add_limits(strut_code_writer *w) {
  strut_buffer_add(&w->text, " *\n * Largest stable steps: rk4 %.5g s, verlet %.5g s.\n",
                   w->rk4_limit, w->verlet_limit);
}

static void add_enum(strut_code_writer *w, const char *type, const strut_code_names *names,
                     const char *what) {
  char word[16];
  size_t length = strlen(type);
  for (size_t i = 0; i <= length; i++) word[i] = (char)toupper((unsigned char)type[i]);
  strut_buffer_add(&w->text, "/** %s */\ntypedef enum %s_%s {\n", what, w->options->prefix, type);
  for (size_t i = 0; i < names->count; i++)
    strut_buffer_add(&w->text, "  %s_%s_%s%s\n", w->upper, word, names->name[i],
                     i + 1 < names->count ? "," : "");
  strut_buffer_add(&w->text, "} %s_%s;\n\n", w->options->prefix, type);
}

static void add_enums(strut_code_writer *w) {
  const strut_mass_operator *op = w->model->mass->coordinate;
  strut_buffer_add(&w->text, "enum { %s_NODES = %zu, %s_MEMBERS = %zu", w->upper, w->nodes.count,
                   w->upper, w->members.count);
  if (has_inputs(w)) strut_buffer_add(&w->text, ", %s_INPUTS = %zu", w->upper, w->inputs.count);
  if (has_contact(w))
    strut_buffer_add(&w->text, ", %s_CONTACTS = %d", w->upper, w->model->contacts.count);
  if (has_elements(w))
    strut_buffer_add(&w->text, ", %s_ELEMENTS = %d, %s_SLOTS = %d", w->upper,
                     w->model->elements.count, w->upper, strut_code_slot_count(w));
  if (strut_code_slider_count(w))
    strut_buffer_add(&w->text, ", %s_SLIDERS = %d", w->upper, strut_code_slider_count(w));
  if (strut_code_has_breakables(w))
    strut_buffer_add(&w->text, ", %s_BREAKABLES = %zu", w->upper, w->breakables.count);
  if (has_factor(w)) {
    int32_t n = op[0].factor ? op[0].factor->n : 0;
    if (op[1].factor && op[1].factor->n > n) n = op[1].factor->n;
    strut_buffer_add(&w->text, ", %s_FACTOR = %d", w->upper, n);
  }
  strut_buffer_add(&w->text, " };\n\n");
  add_enum(w, "node", &w->nodes, "Nodes: x is q[2 * node], y is q[2 * node + 1].");
  if (has_members(w)) add_enum(w, "member", &w->members, "Members.");
  if (strut_code_has_breakables(w))
    add_enum(w, "breakable", &w->breakables, "Members and hinges that break or are released.");
  if (has_inputs(w))
    add_enum(w, "input", &w->inputs,
             "Actuators of lengths, loads that change with time, actuators of forces, motions of "
             "grounds.");
}

static void add_node_names(strut_code_writer *w) {
  strut_buffer_add(&w->text, "static const char *const node_names[] = {");
  for (size_t i = 0; i < w->nodes.count; i++)
    strut_buffer_add(&w->text, "%s\"%s\"", i ? ", " : "", w->nodes.name[i]);
  strut_buffer_add(&w->text, "};\n");
}

static void add_element_code(strut_code_writer *w) {
  strut_code_expand(w, strut_code_elements_template->text);
}
static void add_memory_code(strut_code_writer *w) {
  strut_code_expand(w, strut_code_memory_template->text);
}
static void add_ground_code(strut_code_writer *w) {
  strut_code_expand(w, strut_code_grounds_template->text);
}
static void add_dual_code(strut_code_writer *w) {
  strut_code_expand(w, strut_code_duals_template->text);
}

void strut_code_add_table(strut_code_writer *w, const char *word, size_t length) {
  static const struct {
    const char *word;
    void (*add)(strut_code_writer *);
  } words[] = {{"title", add_title},
               {"limits", add_limits},
               {"enums", add_enums},
               {"node_names", add_node_names},
               {"model", strut_code_add_model},
               {"solve", strut_code_add_solve},
               {"signals", strut_code_add_signals},
               {"element_code", add_element_code},
               {"elements", strut_code_add_elements},
               {"blocks", strut_code_add_blocks},
               {"actuator_forces", strut_code_add_actuator_forces},
               {"dual_code", add_dual_code},
               {"ground_code", add_ground_code},
               {"memory_code", add_memory_code},
               {"breakables", strut_code_add_breakables},
               {"surfaces", strut_code_add_surfaces}};
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
    if (strlen(words[i].word) == length && !memcmp(words[i].word, word, length)) {
      words[i].add(w);
      return;
    }
  assert(false && "a template asks for a table that there is not");
}

static void add_reals(strut_code_writer *w, const double *values, size_t count) {
  for (size_t i = 0; i < count; i++) {
    if (i) strut_buffer_add(&w->text, ", ");
    strut_code_add_real(w, values[i]);
  }
}

void strut_code_add_word(strut_code_writer *w, const char *word, size_t length) {
  static const double sine[] = {-1.0 / 6,  -1.0 / 5040,  -1.0 / 39916800,   -1.0 / 1307674368000.0,
                                1.0 / 120, 1.0 / 362880, 1.0 / 6227020800.0};
  static const double cosine[] = {
      1.0 / 24,   1.0 / 40320,    1.0 / 479001600.0,   1.0 / 20922789888000.0,
      -1.0 / 720, -1.0 / 3628800, -1.0 / 87178291200.0};
  static const double arctangent[] = {-1.0 / 3,  1.0 / 5,  -1.0 / 7,  1.0 / 9,
                                      -1.0 / 11, 1.0 / 13, -1.0 / 15, 1.0 / 17,
                                      -1.0 / 19, 1.0 / 21, -1.0 / 23, 1.0 / 25};
  bool verlet = !strcmp(w->experiment->integrator, "verlet");
  if (length == 4 && !memcmp(word, "sine", 4)) {
    add_reals(w, sine, sizeof sine / sizeof sine[0]);
  } else if (length == 6 && !memcmp(word, "cosine", 6)) {
    add_reals(w, cosine, sizeof cosine / sizeof cosine[0]);
  } else if (length == 10 && !memcmp(word, "arctangent", 10)) {
    add_reals(w, arctangent, sizeof arctangent / sizeof arctangent[0]);
  } else if (length == 6 && !memcmp(word, "method", 6)) {
    strut_buffer_add(&w->text, verlet ? "verlet" : "rk4");
  } else if (length == 4 && !memcmp(word, "step", 4)) {
    double limit = 0.5 * (verlet ? w->verlet_limit : w->rk4_limit);
    strut_code_add_double(w, w->experiment->step > 0.0 ? w->experiment->step : limit);
  } else {
    assert(false && "a template asks for a number that there is not");
  }
}
