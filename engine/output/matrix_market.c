/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/exports.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/number_text.h"
#include "engine/output/buffer.h"
#include "engine/output/file.h"
#include "engine/output/results.h"
#include "engine/statics/rigidity/rigidity_parts.h"

static const char *const names[] = {"node_names.csv",
                                    "rows.csv",
                                    "columns.csv",
                                    "connectivity.mtx",
                                    "equilibrium.mtx",
                                    "mass.mtx",
                                    "stiffness_elastic.mtx",
                                    "stiffness_geometric.mtx",
                                    "stiffness_contact.mtx",
                                    "damping.mtx",
                                    NULL};

/* The data of all files. */
typedef struct source {
  const strut_model *model;
  const double *q;
  const char *at;
  strut_equilibrium_matrix equilibrium;
  strut_linear_matrices linear;
} source;

typedef void write_function(FILE *stream, const source *from);

static void write_number(FILE *stream, double value) {
  char text[STRUT_NUMBER_TEXT];
  strut_number_text(value, text);
  fputs(text, stream);
}

static void write_nodes(FILE *stream, const source *from) {
  const strut_scene *scene = from->model->scene;
  fputs("row,node,x,y\n", stream);
  for (size_t i = 0; i < scene->node_count; i++) {
    fprintf(stream, "%zu,", i + 1);
    strut_csv_write(stream, scene->nodes[i].name);
    for (size_t k = 0; k < 2; k++) {
      fputc(',', stream);
      write_number(stream, from->q[2 * i + k]);
    }
    fputc('\n', stream);
  }
}

static void write_rows(FILE *stream, const source *from) {
  const strut_equilibrium_matrix *a = &from->equilibrium;
  fputs("row,node,coordinate\n", stream);
  for (int32_t r = 0; r < a->rows; r++) {
    int32_t at = a->coordinate[r];
    fprintf(stream, "%" PRId32 ",", r + 1);
    strut_csv_write(stream, from->model->scene->nodes[at / 2].name);
    fputs(at % 2 ? ",y\n" : ",x\n", stream);
  }
}

/* The nodes that a running cable passes between its ends, as one cell. */
static void write_guides(FILE *stream, const strut_scene *scene, const strut_member *member) {
  fputc(',', stream);
  for (size_t k = 0; k < member->guide_count; k++)
    fprintf(stream, "%s%s", k ? " " : "", scene->nodes[member->guides[k]].name);
}

static bool has_inner_nodes(const strut_scene *scene) {
  for (size_t j = 0; j < scene->member_count; j++)
    if (scene->members[j].guide_count) return true;
  return scene->hinge_count + scene->cell_count > 0;
}

static void write_member_column(FILE *stream, const strut_scene *scene, size_t j, bool inner) {
  const strut_member *member = &scene->members[j];
  fprintf(stream, "%zu,", j + 1);
  strut_csv_write(stream, member->name);
  fprintf(stream, ",%s,", strut_member_kind_name(member->kind));
  strut_csv_write(stream, scene->nodes[member->node[0]].name);
  fputc(',', stream);
  strut_csv_write(stream, scene->nodes[member->node[1]].name);
  if (inner) write_guides(stream, scene, member);
  fputc('\n', stream);
}

static void write_hinge_column(FILE *stream, const strut_scene *scene, size_t i) {
  const strut_hinge *hinge = &scene->hinges[i];
  fprintf(stream, "%zu,", scene->member_count + i + 1);
  strut_csv_write(stream, hinge->name);
  fputs(",hinge,", stream);
  for (int k = 0; k < 3; k++) {
    strut_csv_write(stream, scene->nodes[hinge->node[(int[]){0, 2, 1}[k]]].name);
    fputc(k < 2 ? ',' : '\n', stream);
  }
}

static void write_cell_column(FILE *stream, const strut_scene *scene, size_t i) {
  const strut_cell *cell = &scene->cells[i];
  size_t last = cell->node_count - 1;
  fprintf(stream, "%zu,", scene->member_count + scene->hinge_count + i + 1);
  strut_csv_write(stream, cell->name);
  fputs(",cell,", stream);
  strut_csv_write(stream, scene->nodes[cell->node[0]].name);
  fputc(',', stream);
  strut_csv_write(stream, scene->nodes[cell->node[last]].name);
  fputc(',', stream);
  for (size_t k = 1; k < last; k++)
    fprintf(stream, "%s%s", k > 1 ? " " : "", scene->nodes[cell->node[k]].name);
  fputc('\n', stream);
}

/* A column `over` of the nodes in between where there are running cables, hinges or cells. */
static void write_columns(FILE *stream, const source *from) {
  const strut_scene *scene = from->model->scene;
  bool inner = has_inner_nodes(scene);
  fprintf(stream, "column,member,kind,from,to%s\n", inner ? ",over" : "");
  for (size_t j = 0; j < scene->member_count; j++) write_member_column(stream, scene, j, inner);
  for (size_t i = 0; i < scene->hinge_count; i++) write_hinge_column(stream, scene, i);
  for (size_t i = 0; i < scene->cell_count; i++) write_cell_column(stream, scene, i);
}

static void write_banner(FILE *stream, const source *from, const char *kind, const char *what) {
  fprintf(stream, "%%%%MatrixMarket matrix coordinate %s\n%% %s; at: %s\n", kind, what, from->at);
}

static void write_connectivity(FILE *stream, const source *from) {
  const strut_scene *scene = from->model->scene;
  write_banner(stream, from, "integer general",
               "connectivity: -1 at a member's first node, 1 at its second");
  fprintf(stream, "%zu %zu %zu\n", scene->node_count, scene->member_count, 2 * scene->member_count);
  for (size_t j = 0; j < scene->member_count; j++)
    fprintf(stream, "%d %zu -1\n%d %zu 1\n", scene->members[j].node[0] + 1, j + 1,
            scene->members[j].node[1] + 1, j + 1);
}

static void write_equilibrium(FILE *stream, const source *from) {
  const strut_equilibrium_matrix *a = &from->equilibrium;
  write_banner(stream, from, "real general",
               "equilibrium matrix: member forces to the loads that they hold, 1");
  fprintf(stream, "%d %d %d\n", a->rows, a->columns, a->start[a->columns]);
  for (int32_t j = 0; j < a->columns; j++)
    for (int32_t k = a->start[j]; k < a->start[j + 1]; k++) {
      fprintf(stream, "%d %d ", a->row[k] + 1, j + 1);
      write_number(stream, a->value[k]);
      fputc('\n', stream);
    }
}

/* The lower triangle; structural zeros are omitted. */
static void write_symmetric(FILE *stream, const source *from, const strut_sparse *matrix,
                            const char *what) {
  int32_t count = 0;
  for (int32_t k = 0; k < matrix->start[matrix->n]; k++) count += matrix->value[k] != 0.0;
  write_banner(stream, from, "real symmetric", what);
  fprintf(stream, "%d %d %d\n", matrix->n, matrix->n, count);
  for (int32_t j = 0; j < matrix->n; j++)
    for (int32_t k = matrix->start[j]; k < matrix->start[j + 1]; k++) {
      if (matrix->value[k] == 0.0) continue;
      fprintf(stream, "%d %d ", matrix->row[k] + 1, j + 1);
      write_number(stream, matrix->value[k]);
      fputc('\n', stream);
    }
}

static void write_mass(FILE *stream, const source *from) {
  write_symmetric(stream, from, from->linear.mass, "mass, kg");
}

static void write_elastic(FILE *stream, const source *from) {
  write_symmetric(stream, from, from->linear.elastic, "elastic stiffness, N/m");
}

static void write_geometric(FILE *stream, const source *from) {
  write_symmetric(stream, from, from->linear.geometric, "geometric stiffness, N/m");
}

static void write_contact(FILE *stream, const source *from) {
  write_symmetric(stream, from, from->linear.contact, "stiffness of the ground, N/m");
}

static void write_damping(FILE *stream, const source *from) {
  write_symmetric(stream, from, from->linear.damping, "damping, N s/m");
}

static strut_status write_file(const strut_results *results, const char *name,
                               write_function *write, const source *from, strut_error *error) {
  strut_file file = {0};
  strut_status status = strut_file_open(&file, results->stage, name, error);
  if (status != STRUT_OK) return status;
  write(file.stream, from);
  status = strut_file_commit(&file, error);
  if (status != STRUT_OK) strut_file_abandon(&file);
  return status;
}

static strut_status write_all(const char *directory, const source *from, strut_error *error) {
  static write_function *const writers[] = {
      write_nodes, write_rows,    write_columns,   write_connectivity, write_equilibrium,
      write_mass,  write_elastic, write_geometric, write_contact,      write_damping};
  strut_results results = {0};
  strut_status status = strut_results_begin_named(&results, directory, names, error);
  if (status != STRUT_OK) return status;
  for (int i = 0; names[i] && status == STRUT_OK; i++)
    if (writers[i] != write_contact || from->linear.contact)
      status = write_file(&results, names[i], writers[i], from, error);
  if (status == STRUT_OK) return strut_results_commit(&results, error);
  strut_results_abandon(&results);
  return status;
}

strut_status strut_matrices_write(const char *directory, const strut_model *model, const double *q,
                                  const char *at, strut_error *error) {
  source from = {.model = model, .q = q, .at = at};
  strut_arena arena = {0};
  strut_status status = strut_equilibrium_matrix_build(model, q, &arena, &from.equilibrium);
  if (status == STRUT_OK) status = strut_linear_matrices_build(model, q, &arena, &from.linear);
  if (status == STRUT_OK) {
    strut_c_locale locale = strut_c_locale_enter();
    status = write_all(directory, &from, error);
    strut_c_locale_leave(locale);
  } else {
    strut_fail(error, status, "out of memory");
  }
  strut_arena_free(&arena);
  return status;
}
