/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/analysis.h"
#include "parser/cli/commands.h"

#include <stdio.h>
#include <string.h>

#include "engine/output/figures/statics_figures.h"
#include "engine/output/report/equilibria_report.h"
#include "parser/cli/streams.h"
#include "parser/yaml/diagnostics.h"

/* JSON readers represent integers exactly up to here. */
static const int64_t MOST_STARTS = 1000000000, MOST_SEED = 9007199254740992;

static const char *const file_names[] = {"equilibria.json", NULL};

static const strut_option options[] = {
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    {STRUT_OPTION_SUPPORTS, "supports", "NODES", "hold only these contact nodes, such as n1,n4"},
    {STRUT_OPTION_STARTS, "starts", "N", "number of random starts per search (default automatic)"},
    {STRUT_OPTION_SEED, "seed", "S", "seed of the random starts (default as the scene says)"},
    {STRUT_OPTION_ALL, "all", NULL,
     "list every equilibrium, and the positions of those that stand"},
    {STRUT_OPTION_OUTPUT, "output", "DIR", "write equilibria.json into DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print everything as one JSON object"},
    STRUT_PLOT_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static const char *node_name_at(const void *context, size_t i) {
  const strut_scene *scene = context;
  return i < scene->node_count ? scene->nodes[i].name : NULL;
}

static strut_status refuse_node(const strut_scene *scene, const char *name, const char *why) {
  const char *near = strut_did_you_mean(name, node_name_at, scene);
  fprintf(stderr, "strut equilibria: --supports: %s '%s'", why, name);
  if (near && strcmp(near, name) != 0) fprintf(stderr, "; did you mean '%s'?", near);
  fputc('\n', stderr);
  return STRUT_USAGE;
}

/* "n1,n4" as nodes, in the scene's arena; *set stays NULL without --supports. */
static strut_status read_supports(const strut_arguments *arguments, strut_scene *scene,
                                  strut_node_set **set) {
  const char *text = strut_option_text(arguments, STRUT_OPTION_SUPPORTS);
  if (!text) return STRUT_OK;
  size_t most = strlen(text) + 1;
  strut_node_set *to = strut_arena_allocate(&scene->arena, 1, sizeof *to);
  char *word = strut_arena_allocate(&scene->arena, most, 1);
  if (to) to->node = strut_arena_allocate(&scene->arena, most, sizeof *to->node);
  if (!to || !word || !to->node) return strut_print_out_of_memory();
  for (const char *at = text;; at++) {
    size_t length = strcspn(at, ","), found = 0;
    memcpy(word, at, length);
    word[length] = '\0';
    while (found < scene->node_count && strcmp(scene->nodes[found].name, word) != 0) found++;
    if (found == scene->node_count) return refuse_node(scene, word, "there is no node");
    for (size_t i = 0; i < to->count; i++)
      if (to->node[i] == (int32_t)found) return refuse_node(scene, word, "named twice:");
    to->node[to->count++] = (int32_t)found;
    at += length;
    if (!*at) break;
  }
  *set = to;
  return STRUT_OK;
}

static strut_status read_options(const strut_arguments *arguments, strut_setup *setup,
                                 strut_equilibria_options *to, uint64_t *seed) {
  int64_t starts = 0, chosen = (int64_t)setup->experiment.search.seed;
  strut_node_set *set = NULL;
  strut_status status = strut_option_integer(&strut_command_equilibria, arguments,
                                             STRUT_OPTION_STARTS, 0, MOST_STARTS, &starts);
  if (!status)
    status = strut_option_integer(&strut_command_equilibria, arguments, STRUT_OPTION_SEED, 0,
                                  MOST_SEED, &chosen);
  if (!status) status = read_supports(arguments, &setup->scene, &set);
  *seed = (uint64_t)chosen;
  *to = (strut_equilibria_options){
      .starts = starts, .seed = seed, .supports = set, .interrupt = strut_interrupt_watch()};
  return status;
}

/* Stable shapes in which something would break or yield. */
static void warn_of_overloads(const strut_model *model, const strut_equilibria *all) {
  for (size_t i = 0; i < all->count; i++) {
    const strut_equilibrium *e = &all->list[i];
    char where[200];
    if (e->point.label != STRUT_STABLE) continue;
    snprintf(where, sizeof where, "in %.180s", e->name);
    strut_warn_of_overload(model, e->point.q, where);
  }
}

static strut_status analyse_equilibria(strut_analysis *a, strut_error *error) {
  strut_equilibria_options wanted;
  strut_equilibria all = {0};
  uint64_t seed;
  strut_status status = read_options(a->arguments, &a->setup, &wanted, &seed);
  if (!status) status = strut_equilibria_find(a->model, &a->setup.experiment, &wanted, &all, error);
  if (!status)
    status = strut_report(a->arguments, a->names, strut_equilibria_json(&all, a->model), NULL,
                          strut_equilibria_table(&all, a->model, a->arguments->all), error);
  if (!status) warn_of_overloads(a->model, &all);
  if (!status && a->plot.path && all.count > 0)
    status = strut_equilibria_figure(&a->plot, a->model, &all, error);
  if (!status && all.count == 0) status = strut_fail(error, STRUT_NOT_SETTLED, "%s", all.remark);
  strut_equilibria_free(&all);
  return status;
}

static strut_status run_equilibria(const strut_arguments *arguments) {
  return strut_analysis_run(&strut_command_equilibria, arguments, file_names, analyse_equilibria);
}

const strut_command strut_command_equilibria = {
    .name = "equilibria",
    .model = "MODEL",
    .summary = "finds all equilibria, and the energy barriers between stable ones",
    .details =
        "\nThe search holds pairs of contact nodes in turn in place of the ground and starts from\n"
        "the drawn shape, mirrored copies and random shapes. Stable shapes are then released on\n"
        "the real ground, without drive and friction. The table lists what stands there and the\n"
        "energy barriers between; 'stiffness' is the lowest eigenvalue, 'found' the number of\n"
        "starts that ended there. --all adds shapes that sink, tip over or are unstable.\n"
        "Names such as n1-n4-2 give the touching nodes and the rank by energy.\n"
        "Exit code 3 if nothing ever comes to rest.\n",
    .options = options,
    .run = run_equilibria,
    .timed = true,
};
