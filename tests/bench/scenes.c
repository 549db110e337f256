/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/bench/scenes.h"

#include <stdio.h>
#include <string.h>

#include "parser/language/read/read_scene.h"

/* Sizes of a chain's frame and its members; the names of a node tell column and row. */
#define SIDE 0.1
#define BAR_STIFFNESS 1e5
#define BAR_MASS 0.1
#define CABLE_STIFFNESS 3000.0
#define CABLE_RATIO 0.98
#define DAMPING 0.2
enum { PER_FRAME = 5 };

strut_status bench_read(strut_setup *setup, const char *file, const char *const *set,
                        strut_error *error) {
  char path[1000], names[3][40], *text = NULL;
  strut_override overrides[3];
  size_t count = 0, length = 0;
  strut_diagnostics diagnostics = {0};
  for (; count < 3 && set[count]; count++) {
    const char *equals = strchr(set[count], '=');
    snprintf(names[count], sizeof names[count], "%.*s", (int)(equals - set[count]), set[count]);
    overrides[count] = (strut_override){names[count], equals + 1};
  }
  snprintf(path, sizeof path, "%s/../%s", STRUT_TESTS_DIR, file);
  strut_status status = strut_file_read(path, &text, &length, error);
  if (status == STRUT_OK) {
    status =
        strut_setup_read(setup, path, text, length, overrides, count, STRUT_FOR_RUN, &diagnostics);
    if (status != STRUT_OK) strut_fail(error, status, "%s is not a valid scene", path);
  }
  strut_diagnostics_free(&diagnostics);
  strut_release(text);
  return status;
}

/* The scene that the motion has, compiled, if it could be made. */
static bool begin(bench_motion *m, strut_status status, const char *method, double step,
                  strut_error *error) {
  strut_integrator_settings settings = strut_integrator_settings_of(&m->setup.experiment);
  settings.step = step;
  m->method = strut_integrator_find(method);
  if (status == STRUT_OK) status = strut_model_compile(&m->setup.scene, &m->model, error);
  if (status == STRUT_OK) status = strut_state_create(m->model, &m->state, error);
  if (status == STRUT_OK) m->workspace = m->method->create(m->model, m->state, &settings);
  if (m->workspace) {
    strut_state_reset(m->model, m->state);
    return true;
  }
  fprintf(stderr, "strut_bench: %s: %s\n", strut_status_text(status), error->message);
  bench_free(m);
  return false;
}

bool bench_crawler(bench_motion *m, const char *method, double step) {
  strut_error error = {0};
  *m = (bench_motion){0};
  return begin(m,
               bench_read(&m->setup, "tests/golden/crawler.yaml", (const char *[]){NULL}, &error),
               method, step, &error);
}

void bench_free(bench_motion *m) {
  strut_state_free(m->state);
  strut_model_free(m->model);
  strut_setup_free(&m->setup);
}

static strut_status allocate(strut_setup *setup, size_t nodes, size_t members) {
  strut_setup_init(setup);
  setup->scene.nodes = strut_arena_allocate(&setup->scene.arena, nodes, sizeof *setup->scene.nodes);
  setup->scene.members =
      strut_arena_allocate(&setup->scene.arena, members, sizeof *setup->scene.members);
  if (!setup->scene.nodes || !setup->scene.members) {
    strut_setup_free(setup);
    return STRUT_NO_MEMORY;
  }
  setup->scene.node_count = nodes, setup->scene.member_count = members;
  return STRUT_OK;
}

static void place(strut_node *node, double x, double y) {
  *node = strut_node_default();
  node->position[0] = node->start[0] = x;
  node->position[1] = node->start[1] = y;
}

static strut_member link(strut_member_kind kind, size_t from, size_t to) {
  strut_member member = strut_member_default();
  member.kind = kind;
  member.node[0] = (int32_t)from, member.node[1] = (int32_t)to;
  member.stiffness = kind == STRUT_BAR ? BAR_STIFFNESS : CABLE_STIFFNESS;
  member.mass = kind == STRUT_BAR ? BAR_MASS : 0;
  member.rest_value = kind == STRUT_BAR ? 1 : CABLE_RATIO;
  member.damping = DAMPING;
  return member;
}

static size_t frames_of(size_t members) { return members < PER_FRAME ? 1 : members / PER_FRAME; }

static strut_status make_chain(strut_setup *setup, size_t members, strut_mass_model mass) {
  size_t frames = frames_of(members);
  strut_status status = allocate(setup, 2 * (frames + 1), PER_FRAME * frames);
  if (status != STRUT_OK) return status;
  for (size_t i = 0; i <= frames; i++) {
    place(&setup->scene.nodes[2 * i], SIDE * (double)i, 0);
    place(&setup->scene.nodes[2 * i + 1], SIDE * (double)i, SIDE);
  }
  for (int i = 0; i < 2; i++)
    setup->scene.nodes[i].fixed[0] = setup->scene.nodes[i].fixed[1] = true;
  strut_member *next = setup->scene.members;
  for (size_t low = 0; low < 2 * frames; low += 2) {
    *next++ = link(STRUT_BAR, low, low + 3);
    *next++ = link(STRUT_BAR, low + 1, low + 2);
    *next++ = link(STRUT_CABLE, low, low + 2);
    *next++ = link(STRUT_CABLE, low + 1, low + 3);
    *next++ = link(STRUT_CABLE, low + 2, low + 3);
  }
  setup->scene.mass_model = mass;
  return STRUT_OK;
}

bool bench_chain(bench_motion *m, size_t members, strut_mass_model mass) {
  strut_error error = {0};
  *m = (bench_motion){0};
  return begin(m, make_chain(&m->setup, members, mass), "rk4", 1e-4, &error);
}
