/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/compile_parts.h"

#include <math.h>
#include <string.h>

#include "engine/model/mass.h"
#include "engine/scene/signal.h"

/* Entries of an answer below this part of its largest one change no bit that matters. */
static const double NEGLIGIBLE = 1e-18;

bool strut_sliding_masses_compile(strut_model *model) {
  const strut_scene *scene = model->scene;
  strut_sliding_table *table = &model->sliding;
  size_t count = scene->sliding_count;
  if (!count) return true;
  strut_sliding_item *item = strut_arena_allocate(&model->arena, count, sizeof *item);
  int32_t *moving = strut_arena_allocate(&model->arena, count, sizeof *moving);
  if (!item || !moving) return false;
  for (size_t i = 0; i < count; i++) {
    const strut_sliding_mass *mass = &scene->sliding_masses[i];
    const int32_t *node = scene->members[mass->member].node;
    item[i] = (strut_sliding_item){.member = mass->member,
                                   .at = {2 * (uint32_t)node[0], 2 * (uint32_t)node[1]},
                                   .mass = mass->mass,
                                   .start = strut_sliding_mass_share(scene, i, 0.0),
                                   .base = mass->share,
                                   .scale = strut_sliding_mass_scale(scene, i),
                                   .signal = mass->signal};
    if (mass->signal < 0) continue;
    moving[table->moving_count++] = (int32_t)i;
    table->corners = table->corners || strut_signal_has_corners(scene->signals, mass->signal);
    model->terms |= STRUT_TERM_SLIDING_MASS;
  }
  table->count = (int32_t)count;
  table->item = item;
  table->moving = moving;
  return true;
}

/* Columns of M^-1 for both coordinates of a node, into `column` (length). */
static void solve_column(const strut_model *model, uint32_t at, double *column, double *force,
                         double *work) {
  memset(force, 0, (size_t)model->length * sizeof *force);
  force[at] = force[at + 1] = 1.0;
  strut_mass_solve(model, force, column, work);
}

static bool keep_answer(strut_model *model, double *const *column, strut_sliding_answer *answer) {
  double most = 0.0;
  int32_t end = 2 * model->node_count, count = 0;
  for (int32_t k = 0; k < end; k++) most = fmax(most, fmax(fabs(column[0][k]), fabs(column[1][k])));
  uint32_t *at = strut_arena_allocate(&model->arena, (size_t)model->node_count, sizeof *at);
  if (!at) return false;
  for (int32_t k = 0; k < end; k += 2) {
    bool any = false;
    for (int c = 0; c < 4; c++) any = any || fabs(column[c / 2][k + c % 2]) > NEGLIGIBLE * most;
    if (any) at[count++] = (uint32_t)k;
  }
  double *xy = strut_arena_allocate(&model->arena, 4 * (size_t)count, sizeof *xy);
  for (int32_t k = 0; xy && k < count; k++)
    for (int c = 0; c < 4; c++) xy[4 * k + c] = column[c / 2][at[k] + (uint32_t)(c % 2)];
  *answer = (strut_sliding_answer){count, at, xy};
  return xy;
}

/* Entries of M^-1 between the nodes of moving mass l and those of all others, by its columns. */
static void keep_entries(const strut_sliding_table *table, int32_t l, double *const *column,
                         double *between) {
  int32_t n = 2 * table->moving_count;
  for (int32_t i = 0; i < n; i++)
    for (int32_t e = 0; e < 2; e++)
      for (int32_t c = 0; c < 2; c++)
        between[(c * n + i) * n + 2 * l + e] =
            column[e][table->item[table->moving[i / 2]].at[i % 2] + (uint32_t)c];
}

double strut_sliding_moment(const strut_model *model, double t, int axis, const double *positions) {
  const strut_sliding_table *table = &model->sliding;
  double sum = 0.0;
  for (int32_t k = 0; k < table->moving_count; k++) {
    const strut_sliding_item *item = &table->item[table->moving[k]];
    double span = positions[item->at[1] + (uint32_t)axis] - positions[item->at[0] + (uint32_t)axis];
    double share = strut_sliding_mass_share(model->scene, (size_t)table->moving[k], t);
    sum += item->mass * (share - item->start) * span;
  }
  return sum;
}

strut_status strut_sliding_masses_solve(strut_model *model) {
  strut_sliding_table *table = &model->sliding;
  size_t count = (size_t)table->moving_count, length = (size_t)model->length;
  if (!count || !model->mass) return STRUT_OK;
  strut_sliding_answer *answer = strut_arena_allocate(&model->arena, count, sizeof *answer);
  double *between = strut_arena_allocate(&model->arena, 8 * count * count, sizeof *between);
  double *scratch = strut_allocate(4 * length, sizeof *scratch);
  bool good = answer && between && scratch;
  for (int32_t l = 0; l < table->moving_count && good; l++) {
    double *column[2] = {scratch, scratch + length}, *force = scratch + 2 * length;
    for (int e = 0; e < 2; e++)
      solve_column(model, table->item[table->moving[l]].at[e], column[e], force, force + length);
    good = keep_answer(model, column, &answer[l]);
    keep_entries(table, l, column, between);
  }
  strut_release(scratch);
  table->answer = answer;
  table->between = between;
  return good ? STRUT_OK : STRUT_NO_MEMORY;
}
