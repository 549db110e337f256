/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The model's numbers as static tables, a row with its name each, and the lines that divide by the mass. */
#include <stdio.h>
#include <string.h>

#include "engine/model/mass.h"
#include "engine/output/code/writer.h"

/* An array of numbers, or of those that follow from indices; `per` of them in a line. */
static void add_array(strut_code_writer *w, const char *name, const double *values, size_t count,
                      size_t per) {
  strut_buffer_add(&w->text, "static const real %s[] = {", name);
  for (size_t i = 0; i < count; i++) {
    strut_buffer_add(&w->text, i % per ? " " : "\n    ");
    strut_code_add_real(w, values[i]);
    strut_buffer_add(&w->text, i + 1 < count ? "," : "");
  }
  strut_buffer_add(&w->text, "};\n");
}

/* The same of pairs (nodes, 2), a node in each line. */
static void add_of_nodes(strut_code_writer *w, const char *name, const char *what,
                         const double *values) {
  strut_buffer_add(&w->text, "/* %s */\nstatic const real %s[] = {\n", what, name);
  for (size_t i = 0; i < w->nodes.count; i++) {
    strut_buffer_add(&w->text, "    ");
    strut_code_add_real(w, values[2 * i]);
    strut_code_add_field(w, values[2 * i + 1]);
    strut_buffer_add(&w->text, ", /* ");
    strut_code_add_comment(w, w->scene->nodes[i].name);
    strut_buffer_add(&w->text, " */\n");
  }
  strut_buffer_add(&w->text, "};\n\n");
}

static void add_members(strut_code_writer *w) {
  const strut_member_table *t = &w->model->members;
  bool damping = strut_code_holds(w, "damping"), slack = strut_code_holds(w, "slack");
  if (!t->count) return;
  strut_buffer_add(&w->text,
                   "typedef struct member {\n"
                   "  index_type from, to; /* where the x of its nodes stand */\n"
                   "  real stiffness, rest; /* [N/m]; length without force [m] */\n");
  if (damping) strut_buffer_add(&w->text, "  real damping; /* [N s/m] */\n");
  if (slack)
    strut_buffer_add(
        &w->text, "  unsigned char cable; /* carries no force while slack, and never pushes */\n");
  strut_buffer_add(&w->text, "} member;\n\nstatic const member members[] = {\n");
  for (int32_t j = 0; j < t->count; j++) {
    strut_buffer_add(&w->text, "    {%u, %u", t->from[j], t->to[j]);
    strut_code_add_field(w, t->stiffness[j]);
    strut_code_add_field(w, t->rest[j]);
    if (damping) strut_code_add_field(w, t->damping[j]);
    if (slack) strut_buffer_add(&w->text, ", %d", t->slack[j] >= 0.0);
    strut_code_end_row(w, w->scene->members[j].name);
  }
  strut_buffer_add(&w->text, "};\n\n");
}

void strut_code_add_member_law(strut_code_writer *w) {
  strut_code_add_law(w, "member_tension");
  strut_code_add_law(w, "member_energy");
}

void strut_code_add_step_law(strut_code_writer *w) {
  strut_code_add_law(w, "rk4_stage");
  strut_code_add_law(w, "rk4_end");
}

static void add_drives(strut_code_writer *w) {
  const strut_drive_table *d = &w->model->drives;
  const strut_load_table *l = &w->model->loads;
  if (!strut_code_holds(w, "inputs")) return;
  strut_buffer_add(&w->text, "enum { DRIVES = %d, LOADS = %d };\n\n", d->count, l->count);
  if (d->count) {
    strut_buffer_add(&w->text,
                     "typedef struct drive {\n  index_type member;\n"
                     "  unsigned char first; /* of those on its member */\n"
                     "} drive;\n\nstatic const drive drives[] = {\n");
    for (int32_t i = 0; i < d->count; i++) {
      strut_buffer_add(&w->text, "    {%d, %d", strut_code_slot(w->model, d->member[i]),
                       d->first[i]);
      strut_code_end_row(w, w->inputs.name[i]);
    }
    strut_buffer_add(&w->text, "};\n\n");
    strut_code_add_own_rests(w);
  }
  if (!l->count) return;
  strut_buffer_add(&w->text,
                   "typedef struct load {\n  index_type at;\n"
                   "  real x, y; /* [N], times the input */\n"
                   "} load;\n\nstatic const load loads[] = {\n");
  for (int32_t i = 0; i < l->count; i++) {
    strut_buffer_add(&w->text, "    {%d", 2 * l->node[i]);
    strut_code_add_field(w, l->x[i]);
    strut_code_add_field(w, l->y[i]);
    strut_code_end_row(w, w->inputs.name[d->count + i]);
  }
  strut_buffer_add(&w->text, "};\n\n");
}

/* ---- masses ---- */

/* Does each coordinate stand in a group or the factor, so that no other inverse is wanted? */
static bool all_coupled(const strut_model *model) {
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    if (model->fixed[i]) return false;
  return !model->mass->any_single;
}

static int operator_count(const strut_model *model) { return model->mass->shared ? 1 : 2; }
static const char *operator_name(const strut_model *model, int c) {
  return model->mass->shared ? "xy" : c ? "y" : "x";
}

/* Groups of both coordinates, one after the other in the shared arrays. */
static void add_groups(strut_code_writer *w) {
  const strut_model *model = w->model;
  size_t node = 0, entry = 0;
  if (!strut_code_holds(w, "groups")) return;
  strut_buffer_add(&w->text,
                   "/* Nodes that masses couple: their number, and where they and the "
                   "inverse of their mass matrix begin. */\n"
                   "typedef struct group {\n  index_type size, node;\n"
                   "  uint32_t inverse;\n} group;\n\n");
  for (int c = 0; c < operator_count(model); c++) {
    const strut_mass_operator *op = &model->mass->coordinate[c];
    if (!op->block_count) continue;
    strut_buffer_add(&w->text, "static const group groups_%s[] = {\n", operator_name(model, c));
    for (int32_t b = 0; b < op->block_count; b++) {
      size_t n = (size_t)op->block_size[b];
      strut_buffer_add(&w->text, "    {%zu, %zu, %zu},\n", n, node, entry);
      node += n, entry += n * n;
    }
    strut_buffer_add(&w->text, "};\n");
  }
  strut_buffer_add(&w->text, "static const index_type group_node[] = {\n");
  for (int c = 0; c < operator_count(model); c++) {
    const strut_mass_operator *op = &model->mass->coordinate[c];
    const uint32_t *at = op->block_at;
    for (int32_t b = 0; b < op->block_count; at += op->block_size[b++]) {
      strut_buffer_add(&w->text, "   ");
      for (int32_t i = 0; i < op->block_size[b]; i++) strut_buffer_add(&w->text, " %u,", at[i]);
      strut_buffer_add(&w->text, "\n");
    }
  }
  strut_buffer_add(&w->text, "};\nstatic const real group_inverse[] = { /* [1/kg] */\n");
  for (int c = 0; c < operator_count(model); c++) {
    const strut_mass_operator *op = &model->mass->coordinate[c];
    const double *row = op->block_inverse;
    for (int32_t b = 0; b < op->block_count; b++)
      for (int32_t i = 0, n = op->block_size[b]; i < n; i++, row += n) {
        strut_buffer_add(&w->text, "   ");
        for (int32_t j = 0; j < n; j++) {
          strut_buffer_add(&w->text, " ");
          strut_code_add_real(w, row[j]);
          strut_buffer_add(&w->text, ",");
        }
        strut_buffer_add(&w->text, "\n");
      }
  }
  strut_buffer_add(&w->text, "};\n\n");
}

static void add_indices(strut_code_writer *w, const char *type, const char *name, const char *of,
                        const int32_t *values, size_t count, int32_t times) {
  strut_buffer_add(&w->text, "static const %s %s_%s[] = {", type, name, of);
  for (size_t i = 0; i < count; i++)
    strut_buffer_add(&w->text, "%s%d%s", i % 16 ? " " : "\n    ", times * values[i],
                     i + 1 < count ? "," : "");
  strut_buffer_add(&w->text, "};\n");
}

static void add_factors(strut_code_writer *w) {
  const strut_model *model = w->model;
  if (!strut_code_holds(w, "factor")) return;
  strut_buffer_add(&w->text,
                   "/* L D L' of a mass matrix: columns of L below the diagonal. */\n"
                   "typedef struct factor {\n  int n;\n"
                   "  const index_type *node; /* where the x of its rows stand */\n"
                   "  const uint32_t *start;\n  const index_type *row;\n"
                   "  const real *value, *inverse_diagonal;\n} factor;\n\n");
  for (int c = 0; c < operator_count(model); c++) {
    const strut_mass_operator *op = &model->mass->coordinate[c];
    const strut_factor *f = op->factor;
    const char *of = operator_name(model, c);
    char name[24];
    if (!f) continue;
    size_t n = (size_t)f->n, entries = (size_t)f->start[n];
    add_indices(w, "index_type", "factor_node", of, op->factor_node, n, 2);
    add_indices(w, "uint32_t", "factor_start", of, f->start, n + 1, 1);
    add_indices(w, "index_type", "factor_row", of, f->row, entries, 1);
    snprintf(name, sizeof name, "factor_value_%s", of);
    add_array(w, name, f->value, entries, 4);
    snprintf(name, sizeof name, "factor_inverse_%s", of);
    add_array(w, name, f->inverse_diagonal, n, 4);
    strut_buffer_add(&w->text,
                     "static const factor factor_%s = {%zu, factor_node_%s, factor_start_%s, "
                     "factor_row_%s, factor_value_%s, factor_inverse_%s};\n\n",
                     of, n, of, of, of, of, of);
  }
}

static void add_masses(strut_code_writer *w) {
  const strut_model *model = w->model;
  if (!all_coupled(model))
    add_of_nodes(w, "inverse_mass", "1 / mass, 0 where a node is fixed or masses couple it [1/kg]",
                 model->mass->inverse);
  add_groups(w);
  add_factors(w);
  if (strut_code_holds(w, "mass_damping"))
    strut_code_add_constant(w, "mass_damping", model->mass_damping);
  add_array(w, "point_mass", model->point_mass, (size_t)model->node_count, 5);
  if (strut_code_holds(w, "members"))
    add_array(w, "member_mass", model->members.mass, (size_t)model->members.count, 5);
  if (strut_code_holds(w, "gravity")) {
    add_array(w, "weight", model->weight, (size_t)model->node_count, 5);
    add_array(w, "gravity", w->scene->gravity, 2, 2);
  }
  strut_buffer_add(&w->text, "\n");
}

void strut_code_add_model(strut_code_writer *w) {
  const strut_model *model = w->model;
  bool small = model->length < 65536 && model->members.count < 65536;
  strut_buffer_add(&w->text, "typedef %s index_type;\n\n", small ? "uint16_t" : "uint32_t");
  add_members(w);
  strut_code_add_contacts(w);
  add_drives(w);
  if (strut_code_holds(w, "constant"))
    add_of_nodes(w, "constant_force", "weight, and loads without a signal [N]",
                 model->constant_force);
  add_masses(w);
  add_of_nodes(w, "start", "positions at t = 0 [m]", model->start);
  add_of_nodes(w, "start_velocity", "velocities at t = 0 [m/s]", model->velocity);
  strut_code_add_start_states(w);
}

void strut_code_add_solve(strut_code_writer *w) {
  const strut_mass *mass = w->model->mass;
  if (!all_coupled(w->model))
    strut_buffer_add(
        &w->text, "  for (int i = 0; i < 2 * %s_NODES; i++) a[i] = force[i] * inverse_mass[i];\n",
        w->upper);
  for (int c = 0; c < 2; c++) {
    const strut_mass_operator *op = &mass->coordinate[c];
    const char *of = operator_name(w->model, c);
    if (op->block_count)
      strut_buffer_add(&w->text, "  solve_groups(groups_%s, %d, force + %d, a + %d);\n", of,
                       op->block_count, c, c);
    if (op->factor)
      strut_buffer_add(&w->text, "  solve_factor(&factor_%s, force + %d, a + %d, s->solve);\n", of,
                       c, c);
  }
}
