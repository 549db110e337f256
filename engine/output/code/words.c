/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The words of the templates. */
#include <assert.h>
#include <ctype.h>
#include <string.h>

#include "engine/model/mass.h"
#include "engine/output/code/code.h"
#include "engine/output/code/writer.h"

/* ---- conditions ---- */

static bool is_active(const strut_code_writer *w, unsigned term) { return w->model->terms & term; }

static bool has_float(const strut_code_writer *w) { return w->options->single; }
static bool has_inputs(const strut_code_writer *w) { return strut_code_input_count(w->model) > 0; }
static bool has_signals(const strut_code_writer *w) {
  return has_inputs(w) || strut_code_has_sliding(w);
}
static bool has_drive(const strut_code_writer *w) { return w->model->drives.count > 0; }
static bool has_loads(const strut_code_writer *w) { return w->model->loads.count > 0; }
static bool has_members(const strut_code_writer *w) { return w->scene->member_count > 0; }
static bool has_damping(const strut_code_writer *w) { return is_active(w, STRUT_TERM_DAMPING); }
static bool has_slack(const strut_code_writer *w) { return is_active(w, STRUT_TERM_SLACK); }
static bool has_constant(const strut_code_writer *w) { return is_active(w, STRUT_TERM_CONSTANT); }
static bool has_contact(const strut_code_writer *w) {
  return is_active(w, STRUT_TERM_CONTACT | STRUT_TERM_SURFACES);
}
static bool has_slope(const strut_code_writer *w) { return is_active(w, STRUT_TERM_SLOPE); }
static bool has_friction(const strut_code_writer *w) {
  return has_contact(w) && is_active(w, STRUT_TERM_FRICTION);
}
static bool has_directional(const strut_code_writer *w) {
  return is_active(w, STRUT_TERM_DIRECTION);
}
static bool has_elements(const strut_code_writer *w) { return w->model->elements.count > 0; }
static bool has_actuator_forces(const strut_code_writer *w) {
  return w->model->actuator_forces.count > 0;
}
static bool has_strains(const strut_code_writer *w) {
  return has_elements(w) || has_actuator_forces(w);
}
static bool has_angle(const strut_code_writer *w) { return strut_code_has_strain(w, "angle", 5); }
static bool has_expressions(const strut_code_writer *w) {
  return strut_code_has_internal_states(w) || strut_code_has_relays(w) ||
         strut_code_has_signal(w, STRUT_EXPRESSION);
}
static bool has_memory(const strut_code_writer *w) { return is_active(w, STRUT_TERM_MEMORY); }
static bool has_laws(const strut_code_writer *w) {
  return has_members(w) || has_contact(w) || has_strains(w) || strut_code_has_sliding(w);
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
static bool has_mass_damping(const strut_code_writer *w) {
  return is_active(w, STRUT_TERM_MASS_DAMPING);
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

static const strut_code_condition conditions[] = {{"float", has_float},
                                                  {"signals", has_signals},
                                                  {"mass_damping", has_mass_damping},
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
                                                  {"directional", has_directional},
                                                  {"laws", has_laws},
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
                                                  {"angle", has_angle},
                                                  {"expressions", has_expressions},
                                                  {"memory", has_memory},
                                                  {"breakables", strut_code_has_breakables},
                                                  {NULL, NULL}};

/* The row of a word; NULL: it is not in the table. */
static const strut_code_condition *find_condition(const strut_code_condition *table,
                                                  const char *word, size_t length) {
  for (; table->word; table++)
    if (strlen(table->word) == length && !memcmp(table->word, word, length)) return table;
  return NULL;
}

bool strut_code_has(const strut_code_writer *w, const char *word, size_t length) {
  const strut_code_condition *const tables[] = {conditions, strut_code_ground_conditions,
                                                strut_code_feedback_conditions,
                                                strut_code_sliding_conditions};
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
  for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++) {
    const strut_code_condition *found = find_condition(tables[i], word, length);
    if (found) return found->holds(w);
  }
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
  strut_buffer_add(&w->text, " *\n * Written by %s export --format code", w->options->program);
  const strut_scene *scene = w->scene;
  for (size_t i = 0; i < scene->parameter_count; i++) {
    strut_buffer_add(&w->text, i ? ", " : "\n * with ");
    strut_code_add_comment(w, scene->parameters[i].name);
    strut_buffer_add(&w->text, " = ");
    strut_code_add_comment(w, scene->parameters[i].text);
  }
  strut_buffer_add(
      &w->text,
      ".\n *\n"
      " * Permission under section 7 of the GNU General Public License, version 3: anyone\n"
      " * who has this file may use, change and distribute it under any terms. It belongs to\n"
      " * those who described the model, although parts of it are copied from strut.\n");
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

/* The longest factor of a coordinate's masses. */
static size_t factor_length(const strut_code_writer *w) {
  const strut_mass_operator *op = w->model->mass->coordinate;
  int32_t n = op[0].factor ? op[0].factor->n : 0;
  if (op[1].factor && op[1].factor->n > n) n = op[1].factor->n;
  return (size_t)n;
}

/* Numbers of things, by which arrays of the state are sized; those that there are none of are left out. */
static void add_counts(strut_code_writer *w) {
  bool states = strut_code_has_states(w);
  const struct {
    const char *of;
    size_t count;
  } counts[] = {{"NODES", w->nodes.count},
                {"MEMBERS", w->members.count},
                {"INPUTS", w->inputs.count},
                {"CONTACTS", (size_t)w->model->contacts.count},
                {"ELEMENTS", (size_t)w->model->elements.count},
                {"SLOTS", has_elements(w) ? (size_t)strut_code_slot_count(w) : 0},
                {"YIELDING", (size_t)strut_code_slider_count(w)},
                {"BREAKABLES", w->breakables.count},
                {"STATES", w->states.count},
                {"COORDINATES", states ? 2 * w->nodes.count + w->states.count : 0},
                {"SENSORS", strut_code_holds(w, "sensors") ? w->sensors.count : 0},
                {"SLIDERS", w->sliders.count},
                {"FACTOR", factor_length(w)}};
  strut_buffer_add(&w->text, "enum {");
  for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
    if (counts[i].count || i < 2)
      strut_buffer_add(&w->text, "%s\n  %s_%s = %zu", i ? "," : "", w->upper, counts[i].of,
                       counts[i].count);
  strut_buffer_add(&w->text, "\n};\n\n");
}

static void add_enums(strut_code_writer *w) {
  add_counts(w);
  add_enum(w, "node", &w->nodes, "Nodes: x is q[2 * node], y is q[2 * node + 1].");
  if (has_members(w)) add_enum(w, "member", &w->members, "Members.");
  if (strut_code_holds(w, "sensors")) add_enum(w, "sensor", &w->sensors, "Sensors.");
  if (strut_code_has_states(w))
    add_enum(w, "internal", &w->states,
             "Internal states, behind the velocities: those of the scene, of lags, and forces of "
             "Maxwell branches.");
  if (w->sliders.count)
    add_enum(w, "slider", &w->sliders, "Masses that slide along their members.");
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

static void add_dual_type(strut_code_writer *w) {
  strut_buffer_add(&w->text,
                   "/* A number and its rate, of which expressions are computed. */\n"
                   "typedef struct dual {\n  double value, rate;\n} dual;\n\n");
}

/* A word that templates have text put in place of. */
typedef struct part {
  const char *word;
  void (*add)(strut_code_writer *);
  const strut_embedded *template; /* or one that is expanded */
} part;

static void add_reals(strut_code_writer *w, const double *values, size_t count) {
  for (size_t i = 0; i < count; i++) {
    if (i) strut_buffer_add(&w->text, ", ");
    strut_code_add_real(w, values[i]);
  }
}

static void add_sine(strut_code_writer *w) {
  static const double c[] = {-1.0 / 6,  -1.0 / 5040,  -1.0 / 39916800,   -1.0 / 1307674368000.0,
                             1.0 / 120, 1.0 / 362880, 1.0 / 6227020800.0};
  add_reals(w, c, sizeof c / sizeof c[0]);
}
static void add_cosine(strut_code_writer *w) {
  static const double c[] = {
      1.0 / 24,   1.0 / 40320,    1.0 / 479001600.0,   1.0 / 20922789888000.0,
      -1.0 / 720, -1.0 / 3628800, -1.0 / 87178291200.0};
  add_reals(w, c, sizeof c / sizeof c[0]);
}
static void add_truth(strut_code_writer *w, const char *word) {
  strut_buffer_add(&w->text, strut_code_holds(w, word) ? "1" : "0");
}
static void add_damped(strut_code_writer *w) { add_truth(w, "damping"); }
static void add_slackens(strut_code_writer *w) { add_truth(w, "slack"); }
static void add_driven(strut_code_writer *w) { add_truth(w, "drive"); }
static void add_crossley(strut_code_writer *w) { add_truth(w, "hunt_crossley"); }

/* The run's method and step. */
static bool uses_verlet(const strut_code_writer *w) {
  return !strcmp(w->experiment->integrator, "verlet");
}
static void add_method(strut_code_writer *w) {
  strut_buffer_add(&w->text, uses_verlet(w) ? "verlet" : "rk4");
}
static void add_step(strut_code_writer *w) {
  double limit = 0.5 * (uses_verlet(w) ? w->verlet_limit : w->rk4_limit);
  strut_code_add_double(w, w->experiment->step > 0.0 ? w->experiment->step : limit);
}

/* Coordinates in arrays of the state. */
static void add_length(strut_code_writer *w) {
  strut_buffer_add(&w->text, strut_code_has_states(w) ? "%s_COORDINATES" : "2 * %s_NODES",
                   w->upper);
}
static void add_samples(strut_code_writer *w) {
  strut_buffer_add(&w->text, "%d", strut_code_sample_count(w));
}
static void add_starts(strut_code_writer *w) {
  strut_buffer_add(&w->text, "%d", strut_code_start_count(w));
}
static void add_relays(strut_code_writer *w) {
  strut_buffer_add(&w->text, "%d", strut_code_relay_count(w));
}
/* The function that takes plastic strains as they are. */
static void add_observe(strut_code_writer *w) {
  strut_buffer_add(&w->text, strut_code_slider_count(w) ? "observe" : "exert");
}

static const part parts[] = {{"title", add_title, NULL},
                             {"limits", add_limits, NULL},
                             {"enums", add_enums, NULL},
                             {"node_names", add_node_names, NULL},
                             {"model", strut_code_add_model, NULL},
                             {"solve", strut_code_add_solve, NULL},
                             {"signals", strut_code_add_signals, NULL},
                             {"element_code", NULL, strut_code_elements_template},
                             {"elements", strut_code_add_elements, NULL},
                             {"blocks", strut_code_add_blocks, NULL},
                             {"actuator_forces", strut_code_add_actuator_forces, NULL},
                             {"dual_code", NULL, strut_code_duals_template},
                             {"ground_code", NULL, strut_code_grounds_template},
                             {"memory_code", NULL, strut_code_memory_template},
                             {"observed_code", NULL, strut_code_observed_template},
                             {"feedback_code", NULL, strut_code_feedback_template},
                             {"sliding_code", NULL, strut_code_sliding_template},
                             {"sliders", strut_code_add_sliders, NULL},
                             {"places", strut_code_add_places, NULL},
                             {"resting", strut_code_add_resting, NULL},
                             {"resting_damping", strut_code_add_resting_damping, NULL},
                             {"dual_type", add_dual_type, NULL},
                             {"maxwell", strut_code_add_maxwell, NULL},
                             {"sensors", strut_code_add_sensors, NULL},
                             {"feedback", strut_code_add_feedback, NULL},
                             {"breakables", strut_code_add_breakables, NULL},
                             {"surfaces", strut_code_add_surfaces, NULL},
                             {"sine", add_sine, NULL},
                             {"cosine", add_cosine, NULL},
                             {"damped", add_damped, NULL},
                             {"slackens", add_slackens, NULL},
                             {"driven", add_driven, NULL},
                             {"crossley", add_crossley, NULL},
                             {"member_law", strut_code_add_member_law, NULL},
                             {"step_law", strut_code_add_step_law, NULL},
                             {"ground_law", strut_code_add_ground_law, NULL},
                             {"friction", strut_code_add_friction, NULL},
                             {"strains", strut_code_add_strains, NULL},
                             {"element_laws", strut_code_add_element_laws, NULL},
                             {"law_numbers", strut_code_add_law_numbers, NULL},
                             {"method", add_method, NULL},
                             {"step", add_step, NULL},
                             {"length", add_length, NULL},
                             {"samples", add_samples, NULL},
                             {"starts", add_starts, NULL},
                             {"relays", add_relays, NULL},
                             {"observe", add_observe, NULL}};

void strut_code_add_part(strut_code_writer *w, const char *word, size_t length) {
  for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
    if (strlen(parts[i].word) == length && !memcmp(parts[i].word, word, length)) {
      if (parts[i].template)
        strut_code_expand(w, parts[i].template->text);
      else
        parts[i].add(w);
      return;
    }
  assert(false && "a template asks for a text that there is not");
}
