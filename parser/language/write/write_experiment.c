/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shapes, the start, and the experiment, as YAML. See writer.h. */
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/scene/things.h"
#include "parser/language/expression/expression.h"
#include "parser/language/write/writer.h"

/* ---- the search for equilibria and the initial state ---- */

/* Same bits? -0 and 0 differ. */
static bool same(const double a[2], const double b[2]) { return memcmp(a, b, 2 * sizeof *a) == 0; }

static void put_search(strut_writer *writer) {
  const strut_search *search = &writer->experiment->search,
                     *usual = &writer->usual.experiment.search;
  if (strut_fields_differ(STRUT_SECTION_EQUILIBRIA, search, usual))
    strut_put_line(writer, "equilibria", STRUT_SECTION_EQUILIBRIA, search, usual, NULL);
}

/* A name that refers to the configuration: its own, unless a text parameter has that name. */
static const char *leading_name(const strut_scene *scene, const char *name) {
  const char *leading = name;
  bool taken = false;
  for (size_t i = 0; i < scene->parameter_count; i++) {
    const strut_parameter *parameter = &scene->parameters[i];
    if (!isnan(parameter->value)) continue; /* no text */
    if (strcmp(parameter->name, name) == 0) taken = true;
    if (strcmp(parameter->text, name) == 0 && !strut_configuration_named(scene, parameter->name))
      leading = parameter->name;
  }
  return taken ? leading : name;
}

static void put_initial_pair(strut_writer *writer, bool *begun, bool *listed, const char *key,
                             const char *node, const double pair[2]) {
  if (!*begun) strut_put(writer, "initial:\n");
  if (!*listed) strut_put(writer, key);
  *begun = *listed = true;
  strut_put(writer, "    ");
  strut_put_name(writer, node);
  strut_put(writer, ": ");
  strut_put_pair(writer, pair);
  strut_put(writer, "\n");
}

/* Above every stability limit: settling takes half of that then, as it does where the file gives no step at all. */
static const double ABOVE_LIMITS = 1e9;

/* The step of settling, if it differs from that of the run. */
static void put_settling_step(strut_writer *writer, strut_mapping *mapping, int key,
                              const void *object) {
  const strut_settle *settle = object;
  double step = settle->step < 0.0 ? ABOVE_LIMITS : settle->step, of_run = writer->experiment->step;
  if (step == of_run || !(settle->step > 0.0 || (settle->step < 0.0 && of_run > 0.0))) return;
  strut_put_key_name(writer, mapping, key);
  strut_put_number(writer, step);
}

static void put_initial(strut_writer *writer) {
  static const double rest[2] = {0.0, 0.0};
  const strut_scene *scene = writer->scene;
  bool begun = false, positions = false, velocities = false;
  if (scene->start_equilibrium >= 0) {
    strut_put(writer, "initial:\n  equilibrium: ");
    strut_put_name(writer,
                   leading_name(scene, scene->configurations[scene->start_equilibrium].name));
    strut_put(writer, "\n");
    begun = true;
  }
  for (size_t i = 0; i < scene->node_count && scene->start_equilibrium < 0; i++) {
    const strut_node *node = &scene->nodes[i];
    if (!same(node->start, node->position))
      put_initial_pair(writer, &begun, &positions, "  positions:\n", node->name, node->start);
  }
  for (size_t i = 0; i < scene->node_count; i++) {
    const strut_node *node = &scene->nodes[i];
    if (!same(node->velocity, rest))
      put_initial_pair(writer, &begun, &velocities, "  velocities:\n", node->name, node->velocity);
  }
  if (!writer->experiment->settle.wanted) return;
  strut_put(writer, begun ? "  " : "initial:\n  ");
  strut_put_line(writer, "settle", STRUT_SECTION_SETTLE, &writer->experiment->settle,
                 &writer->usual.experiment.settle, put_settling_step);
}

static void put_stage_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                              const void *object) {
  const strut_path_stage *stage = object;
  if (key == STRUT_KEY_STAGE_LOAD && *stage->load) {
    const strut_scene *scene = writer->scene;
    const char *before = "[";
    strut_put_key_name(writer, mapping, key);
    for (size_t i = 0; i < scene->load_count; i++) {
      if (!strut_path_names_load(stage->load, scene->loads[i].name)) continue;
      strut_put(writer, before);
      strut_put_name(writer, scene->loads[i].name);
      before = ", ";
    }
    strut_put(writer, "]");
  } else if (key == STRUT_KEY_STAGE_STOP && stage->stop >= 0) {
    strut_put_key_name(writer, mapping, key);
    strut_put(writer, "{");
    strut_put_coordinate(writer, stage->stop);
    strut_put(writer, ": ");
    strut_put_number(writer, stage->stop_distance);
    strut_put(writer, "}");
  }
}

static void put_path(strut_writer *writer) {
  strut_path_stage none = {.load = "", .over = "", .release = ""};
  const strut_experiment *experiment = writer->experiment;
  if (experiment->stage_count || experiment->path_friction) strut_put(writer, "path:\n");
  if (experiment->path_friction) strut_put(writer, "  friction: kept\n");
  if (experiment->stage_count) strut_put(writer, "  stages:\n");
  for (size_t i = 0; i < experiment->stage_count; i++) {
    strut_path_stage stage = experiment->stages[i];
    if (!stage.load) stage.load = none.load;
    if (!stage.over) stage.over = none.over;
    if (!stage.release) stage.release = none.release;
    /* always written but of a release: its default is another for each kind of stage */
    none.until = *stage.release ? stage.until : (double)NAN;
    strut_put(writer, "    - ");
    strut_put_mapping(writer, STRUT_SECTION_STAGE, &stage, &none, put_stage_by_hand);
    strut_put(writer, "\n");
  }
}

void strut_put_shapes(strut_writer *writer) {
  strut_put_things(writer, STRUT_THING_CONFIGURATION, STRUT_SECTION_CONFIGURATION, NULL);
  put_search(writer);
  put_path(writer);
  put_initial(writer);
}

/* ---- solver, run and output ---- */

/* What `of` may name, and the signal of one; -1: none. */
static const strut_thing drivers[] = {STRUT_THING_ACTUATOR, STRUT_THING_LOAD, STRUT_THING_SIGNAL};
enum { DRIVERS = sizeof drivers / sizeof drivers[0] };

static int32_t signal_of(const strut_scene *scene, strut_thing kind, size_t i) {
  if (kind == STRUT_THING_SIGNAL) return (int32_t)i;
  return kind == STRUT_THING_LOAD ? scene->loads[i].signal : scene->actuators[i].signal;
}

static bool refers_to(const strut_scene *scene, const char *name, int32_t signal) {
  bool found = false;
  for (size_t k = 0; k < DRIVERS; k++)
    for (size_t i = 0; i < strut_thing_count(scene, drivers[k]); i++) {
      const char *own = strut_thing_name(scene, drivers[k], i);
      int32_t of = signal_of(scene, drivers[k], i);
      if (!own || strcmp(own, name) != 0 || of < 0) continue;
      if (of != signal) return false;
      found = true;
    }
  return found;
}

/* A name that `of` may use for the signal whose periods count; NULL: the signal needs a name first. */
static const char *period_name(const strut_scene *scene, const strut_experiment *experiment) {
  const char *own = scene->signals[experiment->period_signal].name;
  if (experiment->period_of && refers_to(scene, experiment->period_of, experiment->period_signal))
    return experiment->period_of;
  if (own && refers_to(scene, own, experiment->period_signal)) return own;
  for (size_t k = 0; k < DRIVERS; k++)
    for (size_t i = 0; i < strut_thing_count(scene, drivers[k]); i++) {
      const char *name = strut_thing_name(scene, drivers[k], i);
      if (name && refers_to(scene, name, experiment->period_signal)) return name;
    }
  return NULL;
}

static void put_measure_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                                const void *object) {
  (void)object;
  if (key == STRUT_KEY_MEASURE_QUANTITIES) strut_put_quantities(writer, mapping);
}

static void put_run_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                            const void *object) {
  const strut_experiment *experiment = object;
  bool measures = experiment->measure_last > 0.0 || experiment->measure_node >= 0 ||
                  experiment->steady.wanted || experiment->quantity_count;
  if (key == STRUT_KEY_RUN_OF && experiment->periods > 0.0) {
    const char *name = period_name(writer->scene, experiment);
    strut_put_key_name(writer, mapping, key);
    strut_put_name(writer, name ? name : strut_signal_name(writer, experiment->period_signal));
  } else if (key == STRUT_KEY_RUN_MEASURE && measures) {
    strut_put_key_name(writer, mapping, key);
    strut_put_mapping(writer, STRUT_SECTION_MEASURE, experiment, &writer->usual.experiment,
                      put_measure_by_hand);
  }
}

static void put_section(strut_writer *writer, int key, strut_section section,
                        strut_put_by_hand *by_hand) {
  strut_put_line(writer, strut_key_at(key)->name, section, writer->experiment,
                 &writer->usual.experiment, by_hand);
}

void strut_put_experiment(strut_writer *writer) {
  const strut_experiment *experiment = writer->experiment;
  put_section(writer, STRUT_KEY_SCENE_SOLVER, STRUT_SECTION_SOLVER, NULL);
  if (experiment->duration != 0.0 || experiment->periods != 0.0)
    put_section(writer, STRUT_KEY_SCENE_RUN, STRUT_SECTION_RUN, put_run_by_hand);
  put_section(writer, STRUT_KEY_SCENE_OUTPUT, STRUT_SECTION_OUTPUT, NULL);
}

/* ---- measured quantities ---- */

static const struct operation_row {
  size_t operands;
  const char *word;
} operations[] = {
#define STRUT_OPERATION_ROW(id, operands, word, sensitivity) {operands, word},
    STRUT_OPERATION_TABLE(STRUT_OPERATION_ROW)
#undef STRUT_OPERATION_ROW
};

/* How tightly operators bind; numbers, columns and functions need no parentheses. */
enum { OF_SUM = 1, OF_PRODUCT, OF_SIGN, OF_POWER, OF_PRIMARY };

static int binding(const strut_instruction *instruction) {
  static const int operators[STRUT_OPERATION_COUNT] = {
      [STRUT_OPERATION_ADD] = OF_SUM,          [STRUT_OPERATION_SUBTRACT] = OF_SUM,
      [STRUT_OPERATION_MULTIPLY] = OF_PRODUCT, [STRUT_OPERATION_DIVIDE] = OF_PRODUCT,
      [STRUT_OPERATION_NEGATE] = OF_SIGN,      [STRUT_OPERATION_POWER] = OF_POWER};
  if (instruction->operation == STRUT_OPERATION_NUMBER &&
      (instruction->unit || signbit(instruction->number)))
    return 0;
  return operators[instruction->operation] ? operators[instruction->operation] : OF_PRIMARY;
}

/* Index of the first instruction of the operand whose last one is program[end - 1]. */
static size_t begin_of(const strut_instruction *program, size_t end) {
  size_t needed = 1;
  while (needed > 0) needed += operations[program[--end].operation].operands - 1;
  return end;
}

/* Names that an expression would split are written in parentheses. */
static void put_owner(strut_writer *writer, const char *kind, const char *name) {
  bool plain = !strchr(STRUT_DIGITS, *name) && !name[strspn(name, STRUT_LETTERS STRUT_DIGITS)];
  for (int owner = 0; owner < STRUT_OWNER_COUNT && plain; owner++) {
    const char *group = strut_owner_row_of((strut_channel_owner)owner)->group;
    plain = !group || strcmp(group, name) != 0;
  }
  if (plain)
    strut_put(writer, name);
  else
    strut_buffer_add(&writer->out, "%s(%s)", kind, name);
}

static void put_column(strut_writer *writer, strut_column column) {
  const strut_scene *scene = writer->scene;
  const char *word = strut_observable_at(column.kind)->word;
  strut_channel_owner owner = strut_observable_at(column.kind)->owner;
  strut_thing thing = strut_thing_of_owner(owner);
  if (owner == STRUT_OWNER_SENSOR || owner == STRUT_OWNER_SIGNAL || owner == STRUT_OWNER_STATE) {
    bool rate = column.kind == STRUT_COLUMN_SENSOR_RATE;
    strut_buffer_add(&writer->out, rate ? "rate(%s)" : "%s",
                     strut_thing_name(scene, thing, (size_t)column.item));
    return;
  }
  if (owner == STRUT_OWNER_PAIR) {
    strut_buffer_add(&writer->out, "%s(%s, %s)", word, scene->nodes[column.item].name,
                     scene->nodes[column.other].name);
    return;
  }
  if (thing < STRUT_THING_COUNT)
    put_owner(writer, strut_thing_at(thing)->word,
              strut_thing_name(scene, thing, (size_t)column.item));
  else if (owner != STRUT_OWNER_RUN)
    strut_put(writer, strut_owner_row_of(owner)->group);
  strut_buffer_add(&writer->out, "%s%s", owner != STRUT_OWNER_RUN ? "." : "", word);
}

static void put_number(strut_writer *writer, const strut_instruction *instruction) {
  strut_put_number(writer, instruction->number);
  if (instruction->unit) strut_put(writer, " "), strut_put(writer, instruction->unit);
}

static void put_operand(strut_writer *writer, const strut_instruction *program, size_t end,
                        int least);

static void put_call(strut_writer *writer, const strut_instruction *program, size_t end) {
  size_t operands = operations[program[end - 1].operation].operands;
  size_t second = end - 1, first = operands > 1 ? begin_of(program, second) : second;
  strut_buffer_add(&writer->out, "%s(", operations[program[end - 1].operation].word);
  put_operand(writer, program, first, OF_SUM);
  if (operands > 1) strut_put(writer, ", "), put_operand(writer, program, second, OF_SUM);
  strut_put(writer, ")");
}

static void put_operator(strut_writer *writer, const strut_instruction *program, size_t end,
                         int level) {
  const char *word = operations[program[end - 1].operation].word;
  if (level == OF_SIGN) {
    strut_put(writer, word);
    put_operand(writer, program, end - 1, OF_SIGN);
    return;
  }
  size_t second = end - 1, first = begin_of(program, second);
  const char *space = level == OF_POWER ? "" : " ";
  put_operand(writer, program, first, level == OF_POWER ? OF_PRIMARY : level);
  strut_buffer_add(&writer->out, "%s%s%s", space, word, space);
  put_operand(writer, program, second, level == OF_POWER ? OF_PRIMARY : level + 1);
}

/* The operand that ends before `end`, in parentheses where it binds less tightly than `least`. */
static void put_operand(strut_writer *writer, const strut_instruction *program, size_t end,
                        int least) {
  const strut_instruction *last = &program[end - 1];
  int level = binding(last);
  bool enclosed = level < least;
  if (enclosed) strut_put(writer, "(");
  if (last->operation == STRUT_OPERATION_NUMBER)
    put_number(writer, last);
  else if (last->operation == STRUT_OPERATION_COLUMN)
    put_column(writer, last->column);
  else if (level == OF_PRIMARY)
    put_call(writer, program, end);
  else
    put_operator(writer, program, end, level);
  if (enclosed) strut_put(writer, ")");
}

void strut_put_program(strut_writer *writer, const strut_instruction *program, size_t length) {
  strut_writer part = {.scene = writer->scene};
  put_operand(&part, program, length, OF_SUM);
  if (part.out.failed || !part.out.text)
    writer->out.failed = true;
  else
    strut_put_quoted(writer, part.out.text);
  strut_release(part.out.text);
}

void strut_put_quantities(strut_writer *writer, strut_mapping *mapping) {
  const strut_experiment *experiment = writer->experiment;
  const strut_quantity_definition usual = {0};
  if (!experiment->quantity_count) return;
  strut_put_key_name(writer, mapping, STRUT_KEY_MEASURE_QUANTITIES);
  for (size_t i = 0; i < experiment->quantity_count; i++) {
    strut_put(writer, i ? ", " : "{");
    strut_put_name(writer, experiment->quantities[i].name);
    strut_put(writer, ": ");
    strut_put_mapping(writer, STRUT_SECTION_QUANTITY, &experiment->quantities[i], &usual, NULL);
  }
  strut_put(writer, "}");
}
