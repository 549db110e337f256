/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Elements, forces of actuators and expressions: which there are, their tables, and the programs of expressions. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/forces/memory.h"
#include "engine/output/code/templates.h"
#include "engine/output/code/writer.h"
#include "engine/scene/signal_program.h"

static const char *const law_names[] = {
#define STRUT_NAME(NAME, name, ...) #name,
    STRUT_ALL_LAWS(STRUT_NAME, )
#undef STRUT_NAME
};

/* ---- which there are ---- */

static bool is_word(const char *word, size_t length, const char *name) {
  return strlen(name) == length && !memcmp(word, name, length);
}

static bool has_law(const strut_code_writer *w, strut_law_kind law) {
  const strut_element_table *t = &w->model->elements;
  for (int32_t i = 0; i < t->count; i++) {
    const strut_element *e = &t->element[i];
    if (e->law == law || (e->law == STRUT_LAW_AXIAL && e->numbers.material == (int)law))
      return true;
  }
  return false;
}

static bool has_strain(const strut_code_writer *w, strut_strain_kind strain) {
  const strut_element_table *t = &w->model->elements;
  for (int32_t b = 0; b < t->block_count; b++)
    if (t->block[b].strain == strain) return true;
  return false;
}

/* A length is a path without guides. */
static bool has_path(const strut_code_writer *w) {
  const strut_actuator_force_table *t = &w->model->actuator_forces;
  for (int32_t i = 0; i < t->count; i++)
    if (t->item[i].strain != STRUT_STRAIN_ANGLE) return true;
  return has_strain(w, STRUT_STRAIN_LENGTH) || has_strain(w, STRUT_STRAIN_PATH);
}

bool strut_code_has_strain(const strut_code_writer *w, const char *word, size_t length) {
  if (is_word(word, length, "path")) return has_path(w);
  for (int k = 0; k < STRUT_STRAIN_COUNT; k++)
    if (is_word(word, length, strut_strain_name((strut_strain_kind)k)))
      return has_strain(w, (strut_strain_kind)k);
  assert(false && "a template asks for a strain that there is not");
  return false;
}

bool strut_code_has_law(const strut_code_writer *w, const char *word, size_t length) {
  bool gas = has_law(w, STRUT_LAW_ISOTHERMAL) || has_law(w, STRUT_LAW_ISENTROPIC);
  if (is_word(word, length, "gas")) return gas;
  /* before it has yielded it is linear */
  if (is_word(word, length, "straight"))
    return has_law(w, STRUT_LAW_LINEAR) || has_law(w, STRUT_LAW_ELASTIC_PLASTIC);
  if (is_word(word, length, "cell")) return gas || has_law(w, STRUT_LAW_PRESSURE);
  for (int k = 0; k < STRUT_LAW_COUNT; k++)
    if (is_word(word, length, law_names[k])) return has_law(w, (strut_law_kind)k);
  assert(false && "a template asks for a law that there is not");
  return false;
}

/* ---- elements ---- */

int32_t strut_code_slot(const strut_model *model, int32_t slot) {
  int32_t members = model->members.count,
          padded = (members + STRUT_LANES - 1) / STRUT_LANES * STRUT_LANES;
  return slot < members ? slot : slot - padded + members;
}

int32_t strut_code_slot_count(const strut_code_writer *w) {
  return (int32_t)(w->scene->member_count + w->scene->hinge_count + w->scene->cell_count);
}

static void add_nodes(strut_code_writer *w, const char *name, const uint32_t *at, int32_t count) {
  strut_buffer_add(&w->text, "static const index_type %s[] = {", name);
  for (int32_t i = 0; i < count; i++)
    strut_buffer_add(&w->text, "%s%u%s", i % 16 ? " " : "\n    ", at[i], i + 1 < count ? "," : "");
  strut_buffer_add(&w->text, "};\n");
}

/* Natural strains of the slots, from which drives start. */
void strut_code_add_own_rests(strut_code_writer *w) {
  const strut_model *model = w->model;
  int32_t members = model->members.count, count = strut_code_slot_count(w);
  int32_t padded = (members + STRUT_LANES - 1) / STRUT_LANES * STRUT_LANES;
  if (!model->drives.count || !model->elements.count) return;
  strut_buffer_add(&w->text, "static const real own_rest[] = {");
  for (int32_t i = 0; i < count; i++) {
    strut_buffer_add(&w->text, i % 5 ? " " : "\n    ");
    strut_code_add_real(w, model->members.rest[i < members ? i : i - members + padded]);
    strut_buffer_add(&w->text, i + 1 < count ? "," : "");
  }
  strut_buffer_add(&w->text, "};\n\n");
}

static int32_t count_coefficients(const strut_element *e) {
  return e->law == STRUT_LAW_POLYNOMIAL ? (int32_t)e->numbers.count : 0;
}

static void add_coefficients(strut_code_writer *w) {
  const strut_element_table *t = &w->model->elements;
  if (!has_law(w, STRUT_LAW_POLYNOMIAL)) return;
  strut_buffer_add(&w->text, "static const real coefficient[] = {\n");
  for (int32_t i = 0; i < t->count; i++)
    for (int32_t k = 0; k < count_coefficients(&t->element[i]); k++) {
      strut_buffer_add(&w->text, k ? " " : "    ");
      strut_code_add_real(w, t->element[i].numbers.coefficient[k]);
      strut_buffer_add(&w->text, k + 1 < count_coefficients(&t->element[i]) ? "," : ",\n");
    }
  strut_buffer_add(&w->text, "};\n");
}

static void add_list(strut_code_writer *w, const double *values, size_t count) {
  for (size_t i = 0; i < count; i++) {
    strut_buffer_add(&w->text, i ? ", " : "");
    strut_code_add_real(w, values[i]);
  }
}

/* A curve of each element with a table. */
static void add_curves(strut_code_writer *w) {
  const strut_element_table *t = &w->model->elements;
  for (int32_t i = 0; i < t->count; i++) {
    const strut_law_curve *c = t->element[i].numbers.curve;
    if (t->element[i].law != STRUT_LAW_TABLE) continue;
    strut_buffer_add(&w->text, "static const real curve_x_%d[] = {", i);
    add_list(w, c->x, c->count);
    strut_buffer_add(&w->text, "};\nstatic const real curve_energy_%d[] = {", i);
    add_list(w, c->energy, c->count);
    strut_buffer_add(&w->text, "};\nstatic const real curve_piece_%d[][4] = {\n", i);
    for (size_t k = 0; k + 1 < c->count; k++) {
      strut_buffer_add(&w->text, "    {");
      add_list(w, c->piece[k], 4);
      strut_buffer_add(&w->text, "},\n");
    }
    strut_buffer_add(&w->text,
                     "};\nstatic const curve curve_%d = {%zu, curve_x_%d, curve_piece_%d, "
                     "curve_energy_%d};\n",
                     i, c->count, i, i, i);
  }
}

/* Functions of the laws whose stiffness follows the rest length, before they are defined. */
static void declare_materials(strut_code_writer *w) {
  const strut_element_table *t = &w->model->elements;
  bool declared[STRUT_LAW_COUNT] = {false};
  for (int32_t i = 0; i < t->count; i++) {
    int material = t->element[i].numbers.material;
    if (t->element[i].law != STRUT_LAW_AXIAL || declared[material]) continue;
    declared[material] = true;
    strut_buffer_add(&w->text,
                     "static real force_%s(const element *m, real e, real e0);\n"
                     "static real energy_%s(const element *m, real e, real e0);\n",
                     law_names[material], law_names[material]);
  }
}

static void add_material(strut_code_writer *w, const strut_element *e) {
  const char *law = law_names[e->numbers.material];
  bool axial = e->law == STRUT_LAW_AXIAL;
  strut_code_add_field(w, e->numbers.axial);
  if (axial) strut_buffer_add(&w->text, ", force_%s, energy_%s", law, law);
  if (!axial) strut_buffer_add(&w->text, ", NULL, NULL");
}

/* ---- what yields, breaks or is released ---- */

bool strut_code_has_breakables(const strut_code_writer *w) {
  return w->model->elements.breakable_count > 0;
}

/* How many elements before i yield. */
static int32_t count_sliders(const strut_element_table *t, int32_t i) {
  int32_t count = 0;
  for (int32_t k = 0; k < i; k++) count += t->element[k].law == STRUT_LAW_ELASTIC_PLASTIC;
  return count;
}

int32_t strut_code_slider_count(const strut_code_writer *w) {
  return count_sliders(&w->model->elements, w->model->elements.count);
}

static void add_slider(strut_code_writer *w, int32_t i) {
  const strut_element *e = &w->model->elements.element[i];
  bool yields = e->law == STRUT_LAW_ELASTIC_PLASTIC;
  strut_buffer_add(&w->text, ", %d", yields ? count_sliders(&w->model->elements, i) : -1);
  strut_code_add_field(w, yields ? strut_slider_spring(e) : 0.0);
  strut_code_add_field(w, yields ? strut_slider_yield(e) : 0.0);
  strut_code_add_field(w, yields ? strut_slider_share(e) : 0.0);
}

static int32_t breakable_of(const strut_element_table *t, int32_t element) {
  for (int32_t b = 0; b < t->breakable_count; b++)
    for (int32_t i = t->breakable[b].first; i >= 0; i = t->element[i].sibling)
      if (i == element) return b;
  return -1;
}

void strut_code_add_breakables(strut_code_writer *w) {
  const strut_element_table *t = &w->model->elements;
  strut_buffer_add(&w->text, "static const breakable breakables[] = {\n");
  for (int32_t b = 0; b < t->breakable_count; b++) {
    const strut_breakable *k = &t->breakable[b];
    strut_buffer_add(&w->text, "    {%d", k->role == STRUT_ELEMENT_HINGE);
    strut_buffer_add(&w->text, k->force < HUGE_VAL ? "" : ", (real)HUGE_VAL");
    if (k->force < HUGE_VAL) strut_code_add_field(w, k->force);
    strut_buffer_add(&w->text, k->time < HUGE_VAL ? ", " : ", HUGE_VAL");
    if (k->time < HUGE_VAL) strut_code_add_double(w, k->time);
    strut_code_end_row(w, w->breakables.name[b]);
  }
  strut_buffer_add(&w->text, "};\n\n");
}

/* The fields of struct element in elements.c.in. */
static void add_element(strut_code_writer *w, int32_t i, int32_t *coefficient) {
  const strut_model *model = w->model;
  const strut_element *e = &model->elements.element[i];
  const strut_law_numbers *n = &e->numbers;
  int32_t slot = e->remembers ? e->base : e->slot;
  double natural = slot >= 0 ? model->members.rest[slot] : e->natural;
  int32_t count = count_coefficients(e);
  strut_buffer_add(&w->text, "    {%d, %d, %d", slot >= 0 ? strut_code_slot(model, slot) : -1,
                   e->first, e->nodes);
  strut_code_add_field(w, e->carries);
  strut_code_add_field(w, natural);
  strut_code_add_field(w, e->damping);
  strut_code_add_field(w, n->stiffness);
  if (has_law(w, STRUT_LAW_BILINEAR)) {
    strut_code_add_field(w, n->knee);
    strut_code_add_field(w, n->second_stiffness);
  }
  if (has_law(w, STRUT_LAW_PLAY)) strut_code_add_field(w, n->gap);
  if (has_law(w, STRUT_LAW_EXPONENTIAL)) strut_code_add_field(w, n->scale);
  if (has_law(w, STRUT_LAW_POLYNOMIAL)) strut_buffer_add(&w->text, ", %d, %d", *coefficient, count);
  *coefficient += count;
  if (has_law(w, STRUT_LAW_TABLE) && e->law == STRUT_LAW_TABLE)
    strut_buffer_add(&w->text, ", &curve_%d", i);
  else if (has_law(w, STRUT_LAW_TABLE))
    strut_buffer_add(&w->text, ", NULL");
  if (has_law(w, STRUT_LAW_AXIAL)) add_material(w, e);
  if (has_law(w, STRUT_LAW_ELASTIC_PLASTIC)) add_slider(w, i);
  if (strut_code_has_breakables(w))
    strut_buffer_add(&w->text, ", %d", breakable_of(&model->elements, i));
  if (strut_code_has_law(w, "cell", 4)) {
    strut_code_add_field(w, n->area);
    strut_code_add_field(w, n->outside);
    strut_code_add_field(w, n->exponent);
  }
  strut_code_end_row(w, strut_element_name(w->scene, e));
}

void strut_code_add_elements(strut_code_writer *w) {
  const strut_element_table *t = &w->model->elements;
  const strut_element *last = &t->element[t->count - 1];
  int32_t coefficient = 0;
  add_nodes(w, "element_node", t->at, last->first + last->nodes);
  add_coefficients(w);
  add_curves(w);
  declare_materials(w);
  strut_buffer_add(&w->text, "static const element elements[] = {\n");
  for (int32_t i = 0; i < t->count; i++) add_element(w, i, &coefficient);
  strut_buffer_add(&w->text, "};\n");
  if (w->scene->member_count) {
    strut_buffer_add(&w->text, "static const int member_of_element[] = {");
    for (int32_t i = 0; i < t->count; i++)
      strut_buffer_add(&w->text, "%s%d", i ? ", " : "",
                       strut_element_is_of_member(&t->element[i]) ? t->element[i].item : -1);
    strut_buffer_add(&w->text, "};\n");
  }
  strut_buffer_add(&w->text, "\n");
}

static const char *strain_function(strut_strain_kind strain) {
  return strut_strain_name(strain == STRUT_STRAIN_LENGTH ? STRUT_STRAIN_PATH : strain);
}

void strut_code_add_blocks(strut_code_writer *w) {
  const strut_element_table *t = &w->model->elements;
  strut_buffer_add(
      &w->text,
      "enum { BLOCKS = %d, MOST_GRADIENT = %d };\n\n"
      "/* Elements begin .. end - 1 have one strain and one law. */\n"
      "typedef struct block {\n"
      "  real (*strain)(const index_type *at, int n, const real *q, real near, real *b);\n"
      "  real (*force)(const element *m, real e, real e0);\n"
      "  real (*energy)(const element *m, real e, real e0);\n"
      "  int begin, end;\n} block;\n\nstatic const block blocks[] = {\n",
      t->block_count, 2 * t->most_nodes);
  for (int32_t b = 0; b < t->block_count; b++) {
    const strut_element_block *k = &t->block[b];
    bool yields = k->law == STRUT_LAW_ELASTIC_PLASTIC;
    const char *law = law_names[yields ? STRUT_LAW_LINEAR : k->law];
    strut_buffer_add(&w->text, "    {strain_%s, force_%s, energy_%s, %d, %d},\n",
                     strain_function(k->strain), law, law, k->begin, k->end);
  }
  strut_buffer_add(&w->text, "};\n\n");
}

/* ---- forces of actuators ---- */

void strut_code_add_actuator_forces(strut_code_writer *w) {
  const strut_actuator_force_table *t = &w->model->actuator_forces;
  const strut_actuator_force *last = &t->item[t->count - 1];
  int32_t most = 2, first = w->model->drives.count + w->model->loads.count;
  for (int32_t i = 0; i < t->count; i++)
    if (t->item[i].nodes > most) most = t->item[i].nodes;
  strut_buffer_add(&w->text, "enum { FORCES = %d, MOST_ACTUATOR_GRADIENT = %d };\n\n", t->count,
                   2 * most);
  add_nodes(w, "actuator_node", t->at, last->first + last->nodes);
  strut_buffer_add(
      &w->text,
      "typedef struct actuator_force {\n"
      "  real (*strain)(const index_type *at, int n, const real *q, real near, real *b);\n"
      "  int first, nodes; /* its nodes: entries of actuator_node */\n"
      "} actuator_force;\n\nstatic const actuator_force actuator_forces[] = {\n");
  for (int32_t i = 0; i < t->count; i++)
    strut_buffer_add(&w->text, "    {strain_%s, %d, %d}, /* %s */\n",
                     strain_function(t->item[i].strain), t->item[i].first, t->item[i].nodes,
                     w->inputs.name[first + i]);
  strut_buffer_add(&w->text, "};\n\n");
}

/* ---- expressions ---- */

typedef struct operation_name {
  const char *word;     /* in templates, behind "op_" */
  const char *function; /* in duals.c.in */
  bool chain;           /* by the chain rule */
} operation_name;

/* NULL: no function. */
static operation_name name_of(strut_operation operation) {
  switch (operation) {
    case STRUT_OPERATION_ADD: return (operation_name){"add", "add", false};
    case STRUT_OPERATION_SUBTRACT: return (operation_name){"subtract", "subtract", false};
    case STRUT_OPERATION_MULTIPLY: return (operation_name){"multiply", "multiply", false};
    case STRUT_OPERATION_DIVIDE: return (operation_name){"divide", "divide", false};
    case STRUT_OPERATION_POWER: return (operation_name){"power", "power", true};
    case STRUT_OPERATION_NEGATE: return (operation_name){"negate", "negate", false};
    case STRUT_OPERATION_SIN: return (operation_name){"sin", "dual_sin", true};
    case STRUT_OPERATION_COS: return (operation_name){"cos", "dual_cos", true};
    case STRUT_OPERATION_TAN: return (operation_name){"tan", "dual_tan", true};
    case STRUT_OPERATION_ASIN: return (operation_name){"asin", "dual_asin", true};
    case STRUT_OPERATION_ACOS: return (operation_name){"acos", "dual_acos", true};
    case STRUT_OPERATION_ATAN: return (operation_name){"atan", "dual_atan", true};
    case STRUT_OPERATION_ATAN2: return (operation_name){"atan2", "dual_atan2", true};
    case STRUT_OPERATION_SQRT: return (operation_name){"sqrt", "dual_sqrt", true};
    case STRUT_OPERATION_EXP: return (operation_name){"exp", "dual_exp", true};
    case STRUT_OPERATION_LOG: return (operation_name){"log", "dual_log", true};
    case STRUT_OPERATION_LOG10: return (operation_name){"log10", "dual_log10", true};
    case STRUT_OPERATION_ABS: return (operation_name){"abs", "dual_abs", false};
    case STRUT_OPERATION_MIN: return (operation_name){"min", "least", false};
    case STRUT_OPERATION_MAX: return (operation_name){"max", "most", false};
    case STRUT_OPERATION_FLOOR: return (operation_name){"floor", "dual_floor", false};
    case STRUT_OPERATION_CEIL: return (operation_name){"ceil", "dual_ceil", false};
    case STRUT_OPERATION_ROUND: return (operation_name){"round", "dual_round", false};
    case STRUT_OPERATION_HYPOT: return (operation_name){"hypot", "dual_hypot", true};
    case STRUT_OPERATION_NUMBER:
    case STRUT_OPERATION_COLUMN:
    case STRUT_OPERATION_COUNT: break;
  }
  return (operation_name){NULL, NULL, false};
}

static bool asks_for(const strut_instruction *p, const char *word, size_t length) {
  operation_name name = name_of(p->operation);
  if (is_word(word, length, "signal"))
    return p->operation == STRUT_OPERATION_COLUMN && p->column.kind == STRUT_COLUMN_SIGNAL;
  if (is_word(word, length, "chain")) return name.chain;
  return name.word && is_word(word, length, name.word);
}

static bool program_asks_for(const strut_program *p, const char *word, size_t length) {
  for (size_t i = 0; i < p->length; i++)
    if (asks_for(&p->instruction[i], word, length)) return true;
  return false;
}

bool strut_code_has_operation(const strut_code_writer *w, const char *word, size_t length) {
  for (size_t s = 0; s < w->scene->signal_count; s++)
    if (strut_code_signal_acts(w, (int32_t)s) &&
        program_asks_for(&w->scene->signals[s].program, word, length))
      return true;
  for (size_t k = 0; k < w->scene->state_count && strut_code_has_feedback(w); k++)
    if (program_asks_for(&w->scene->states[k].rate, word, length)) return true;
  return false;
}

/* The time, a sensor or its rate, or an internal state. */
static void add_column(strut_code_writer *w, strut_column column) {
  bool rate = column.kind == STRUT_COLUMN_SENSOR_RATE;
  if (column.kind == STRUT_COLUMN_TIME) {
    strut_buffer_add(&w->text, "(dual){t, 1};\n");
  } else if (column.kind == STRUT_COLUMN_STATE) {
    strut_buffer_add(&w->text, "internal_state(o, %d, t);\n", column.item);
  } else {
    const char *of = w->sensors.name[column.item];
    strut_buffer_add(&w->text, "(dual){o->s->sensor%s[%s_SENSOR_%s], ", rate ? "_rate" : "",
                     w->upper, of);
    if (!rate) strut_buffer_add(&w->text, "o->s->sensor_rate[%s_SENSOR_%s]};\n", w->upper, of);
    if (rate) strut_buffer_add(&w->text, "0};\n");
  }
}

/* "x[2] = add(x[2], x[3]);", an operation a line, on a stack x. */
void strut_code_add_program(strut_code_writer *w, const strut_program *program) {
  size_t top = 0;
  strut_buffer_add(&w->text, "  dual x[%zu];\n", program->depth > 0 ? program->depth : 1);
  for (size_t i = 0; i < program->length; i++) {
    const strut_instruction *p = &program->instruction[i];
    int operands = strut_operation_operands(p->operation);
    if (operands == 0) {
      strut_buffer_add(&w->text, "  x[%zu] = ", top++);
      if (p->operation == STRUT_OPERATION_NUMBER) {
        strut_buffer_add(&w->text, "(dual){");
        strut_code_add_double(w, p->number);
        strut_buffer_add(&w->text, ", 0};\n");
      } else if (p->column.kind == STRUT_COLUMN_SIGNAL) {
        strut_buffer_add(&w->text, "follow(%ssignal_%s, t);\n",
                         strut_code_has_feedback(w) ? "o, " : "", w->signals.name[p->column.item]);
      } else {
        add_column(w, p->column);
      }
    } else if (operands == 1) {
      strut_buffer_add(&w->text, "  x[%zu] = %s(x[%zu]);\n", top - 1,
                       name_of(p->operation).function, top - 1);
    } else {
      top--;
      strut_buffer_add(&w->text, "  x[%zu] = %s(x[%zu], x[%zu]);\n", top - 1,
                       name_of(p->operation).function, top - 1, top);
    }
  }
}
