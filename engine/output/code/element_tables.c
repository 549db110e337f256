/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Elements, forces of actuators and expressions: which there are, their tables, and the programs of expressions. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/forces/history.h"
#include "engine/output/code/code.h"
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

static bool actuates_strain(const strut_code_writer *w, strut_strain_kind strain) {
  const strut_actuator_force_table *t = &w->model->actuator_forces;
  for (int32_t i = 0; i < t->count; i++)
    if (t->item[i].strain == strain) return true;
  return false;
}

bool strut_code_has_strain(const strut_code_writer *w, const char *word, size_t length) {
  for (int k = 0; k < STRUT_STRAIN_COUNT; k++)
    if (is_word(word, length, strut_strain_name((strut_strain_kind)k)))
      return has_strain(w, (strut_strain_kind)k);
  assert(false && "a template asks for a strain that there is not");
  return false;
}

void strut_code_add_strains(strut_code_writer *w) {
  char name[64];
  for (int k = 0; k < STRUT_STRAIN_COUNT; k++) {
    strut_strain_kind strain = (strut_strain_kind)k;
    snprintf(name, sizeof name, "strain_%s", strut_strain_name(strain));
    if (has_strain(w, strain) || actuates_strain(w, strain)) strut_code_add_law(w, name);
  }
}

bool strut_code_has_law(const strut_code_writer *w, const char *word, size_t length) {
  for (int k = 0; k < STRUT_LAW_COUNT; k++)
    if (is_word(word, length, law_names[k])) return has_law(w, (strut_law_kind)k);
  assert(false && "a template asks for a law that there is not");
  return false;
}

/* ---- laws ---- */

bool strut_code_knows_element_law(strut_law_kind law) {
  char name[64];
  if (law == STRUT_LAW_FOLDING)
    return false; /* which piece of it holds is a memory that is not written */
  snprintf(name, sizeof name, "law_%s", law_names[law]);
  return strut_code_knows_law(name);
}

static bool has_cells(const strut_code_writer *w) {
  for (int k = 0; k < STRUT_LAW_COUNT; k++)
    if (strut_law_is_of_cells((strut_law_kind)k) && has_law(w, (strut_law_kind)k)) return true;
  return false;
}

/* Does some law of the model take this number? That of EA over the rest length asks all for the second stiffness. */
static bool has_number(const strut_code_writer *w, int p) {
  bool some = p == STRUT_LAW_PARAMETER_SECOND_STIFFNESS && has_law(w, STRUT_LAW_AXIAL);
  for (int k = 0; k < STRUT_LAW_COUNT; k++)
    some = some || (has_law(w, (strut_law_kind)k) && strut_law_allows((strut_law_kind)k, p));
  return some;
}

/* What functions of laws take: those numbers that the model's laws have. */
void strut_code_add_law_numbers(strut_code_writer *w) {
  if (has_law(w, STRUT_LAW_TABLE)) strut_code_add_law(w, "law_curve");
  strut_buffer_add(&w->text,
                   "typedef struct law_numbers {\n"
                   "  real stiffness; /* force per strain */\n");
  for (int p = 0; p < STRUT_LAW_NUMBER_COUNT; p++)
    if (has_number(w, p)) strut_buffer_add(&w->text, "  real %s;\n", strut_law_key(p));
  if (has_law(w, STRUT_LAW_TABLE)) strut_buffer_add(&w->text, "  const law_curve *curve;\n");
  if (has_law(w, STRUT_LAW_POLYNOMIAL))
    strut_buffer_add(&w->text, "  size_t count;\n  const real *coefficient; /* (count) */\n");
  if (has_law(w, STRUT_LAW_AXIAL))
    strut_buffer_add(&w->text,
                     "  real axial; /* EA, and the law that has it */\n  int material;\n");
  if (has_cells(w))
    strut_buffer_add(&w->text,
                     "  real area, outside, exponent; /* as drawn [m^2]; pressure outside "
                     "[N/m]; of an isentropic gas */\n");
  strut_buffer_add(&w->text, "} law_numbers;\n\n");
}

static void add_numbers(strut_code_writer *w, int32_t i, int32_t *coefficient) {
  const strut_element *e = &w->model->elements.element[i];
  const strut_law_numbers *n = &e->numbers;
  const double parameters[] = {
#define STRUT_FIELD(NAME, field, ...) n->field,
      STRUT_LAW_PARAMETERS(STRUT_FIELD)
#undef STRUT_FIELD
  };
  size_t count = e->law == STRUT_LAW_POLYNOMIAL ? n->count : 0;
  strut_buffer_add(&w->text, ", {");
  strut_code_add_real(w, n->stiffness);
  for (int p = 0; p < STRUT_LAW_NUMBER_COUNT; p++)
    if (has_number(w, p)) strut_code_add_field(w, parameters[p]);
  if (has_law(w, STRUT_LAW_TABLE) && e->law == STRUT_LAW_TABLE)
    strut_buffer_add(&w->text, ", &curve_%d", i);
  else if (has_law(w, STRUT_LAW_TABLE))
    strut_buffer_add(&w->text, ", NULL");
  if (has_law(w, STRUT_LAW_POLYNOMIAL))
    strut_buffer_add(&w->text, ", %zu, coefficient + %d", count, *coefficient);
  *coefficient += (int32_t)count;
  if (has_law(w, STRUT_LAW_AXIAL)) {
    strut_code_add_field(w, n->axial);
    strut_buffer_add(&w->text, ", %d", n->material);
  }
  if (has_cells(w)) {
    strut_code_add_field(w, n->area);
    strut_code_add_field(w, n->outside);
    strut_code_add_field(w, n->exponent);
  }
  strut_buffer_add(&w->text, "}");
}

/* The laws of members whose stiffness is EA over their rest length. */
static void add_materials(strut_code_writer *w) {
  const strut_element_table *t = &w->model->elements;
  bool has[STRUT_LAW_COUNT] = {false};
  char name[64];
  for (int32_t i = 0; i < t->count; i++)
    if (t->element[i].law == STRUT_LAW_AXIAL) has[t->element[i].numbers.material] = true;
  strut_code_add_law(w, "law_response");
  for (int k = 0; k < STRUT_LAW_COUNT; k++) {
    snprintf(name, sizeof name, "law_%s", law_names[k]);
    if (has[k]) strut_code_add_law(w, name);
  }
  strut_buffer_add(&w->text,
                   "static law_response law_of_material(const law_numbers *n, real e, real e0, int "
                   "piece) {\n  switch (n->material) {\n");
  for (int k = 0; k < STRUT_LAW_COUNT; k++)
    if (has[k])
      strut_buffer_add(&w->text, "    case %d: return law_%s(n, e, e0, piece);\n", k, law_names[k]);
  strut_buffer_add(&w->text, "  }\n  return (law_response){0, 0, 0, 0};\n}\n\n");
}

/* A law's force and energy apart, of which a step wants one. */
void strut_code_add_element_laws(strut_code_writer *w) {
  const strut_element_table *t = &w->model->elements;
  bool written[STRUT_LAW_COUNT] = {false};
  char name[64];
  if (has_law(w, STRUT_LAW_AXIAL)) add_materials(w);
  for (int32_t b = 0; b < t->block_count; b++) {
    strut_law_kind law = t->block[b].law;
    if (written[law]) continue;
    written[law] = true;
    snprintf(name, sizeof name, "law_%s", law_names[law]);
    strut_code_add_law(w, name);
    strut_buffer_add(&w->text,
                     "static real force_%s(const element *m, real e, real e0) {\n"
                     "  return %s(&m->law, e, e0, -1).force;\n}\n\n"
                     "static real energy_%s(const element *m, real e, real e0) {\n"
                     "  return %s(&m->law, e, e0, -1).energy;\n}\n\n",
                     law_names[law], name, law_names[law], name);
  }
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
                     "};\nstatic const law_curve curve_%d = {%zu, curve_x_%d, curve_piece_%d, "
                     "curve_energy_%d, %d, %d};\n",
                     i, c->count, i, i, i, c->smooth, c->start);
  }
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
  int32_t slot = e->remembers ? e->base : e->slot;
  double natural = slot >= 0 ? model->members.rest[slot] : e->natural;
  strut_buffer_add(&w->text, "    {%d, %d, %d", slot >= 0 ? strut_code_slot(model, slot) : -1,
                   e->first, e->nodes);
  strut_code_add_field(w, e->carries);
  strut_code_add_field(w, natural);
  strut_code_add_field(w, e->damping);
  if (has_strain(w, STRUT_STRAIN_ALONG)) strut_code_add_field(w, e->axis);
  add_numbers(w, i, coefficient);
  if (has_law(w, STRUT_LAW_ELASTIC_PLASTIC)) add_slider(w, i);
  if (strut_code_has_breakables(w))
    strut_buffer_add(&w->text, ", %d", breakable_of(&model->elements, i));
  strut_code_end_row(w, strut_element_name(w->scene, e));
}

void strut_code_add_elements(strut_code_writer *w) {
  const strut_element_table *t = &w->model->elements;
  const strut_element *last = &t->element[t->count - 1];
  int32_t coefficient = 0;
  add_nodes(w, "element_node", t->at, last->first + last->nodes);
  add_coefficients(w);
  add_curves(w);
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
    const char *law = law_names[k->law];
    strut_buffer_add(&w->text, "    {strain_%s, force_%s, energy_%s, %d, %d},\n",
                     strut_strain_name(k->strain), law, law, k->begin, k->end);
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
                     strut_strain_name(t->item[i].strain), t->item[i].first, t->item[i].nodes,
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
    case STRUT_OPERATION_TANH: return (operation_name){"tanh", "dual_tanh", true};
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
