/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Films where memory is out. */
#include "engine/base/memory.h"
#include "engine/output/figures/run_figure.h"
#include "tests/models/run_model.h"
#include "tests/support/check.h"
#include "tests/unit/scratch.h"

enum { FRAMES = 3 };

static const char text[] =
    "nodes: {a: {position: [0, 0], mass: 1}, b: {position: [1, 0], mass: 1},\n"
    "        c: {position: [0.5, 0.5], mass: 1}}\n"
    "members: {ab: {nodes: [a, b], kind: bar, stiffness: 10},\n"
    "          bc: {nodes: [b, c], kind: cable, stiffness: 10}}\n"
    "ground: {stiffness: 1000}\n"
    "run: {duration: 1}\n";

typedef struct things {
  model_run run;
  strut_model *model;
  strut_trajectory motion;
  double time[FRAMES], position[FRAMES][6], force[FRAMES][2], contact[FRAMES][6];
  int32_t contact_node[3];
} things;

/* A motion of three frames over a tenth of a second. */
static void make(things *t) {
  memset(t, 0, sizeof *t);
  t->run = model_read_text("views", text, set_none);
  assert_ok(strut_model_compile(&t->run.setup.scene, &t->model, NULL));
  for (int i = 0; i < FRAMES; i++) {
    t->time[i] = 0.05 * i;
    for (int k = 0; k < 6; k++) t->position[i][k] = t->model->start[k] + 0.1 * i;
    t->force[i][0] = i - 1;
    t->contact[i][0] = i;
  }
  for (int k = 0; k < 3; k++) t->contact_node[k] = k;
  t->motion = (strut_trajectory){.frames = FRAMES,
                                 .recorded = FRAMES,
                                 .every = 1,
                                 .node_count = 3,
                                 .member_count = 2,
                                 .contact_count = 3,
                                 .time = t->time,
                                 .position = t->position[0],
                                 .force = t->force[0],
                                 .contact = t->contact[0],
                                 .contact_node = t->contact_node};
}

static void things_free(things *t) {
  strut_model_free(t->model);
  model_run_free(&t->run);
}

TEST(film_without_memory) {
  OWN(things) t;
  const char *directory = scratch_make();
  strut_film film = {.path = scratch_path("a.gif"), .speed = 1};
  if (strut_film_check(&film, 0.1, NULL) != STRUT_OK) skip();
  make(&t);
  film.experiment = &t.run.setup.experiment;
  REFUSE_EACH(n, status, 5) {
    strut_error error = {0};
    status = refused(n, strut_film_make(&film, t.model, &t.motion, &error));
    assert_all_equal(error.status, status, scratch_count(directory), status == STRUT_OK ? 1 : 0);
    if (status == STRUT_OK) assert_int_equal(film.frames, 3);
  }
}

/* Frames that are no numbers end the film; one that begins so has none. */
TEST(film_of_what_is_a_number) {
  OWN(things) t;
  const char *directory = scratch_make();
  strut_film film = {.path = scratch_path("a.gif"), .speed = 0.5};
  if (strut_film_check(&film, 0.1, NULL) != STRUT_OK) skip();
  make(&t);
  film.experiment = &t.run.setup.experiment;
  t.position[2][1] = (double)NAN;
  t.motion.status = STRUT_DIVERGED;
  assert_ok(strut_film_make(&film, t.model, &t.motion, NULL));
  assert_int_equal(film.frames, 3); /* 0.05 s at half the speed and 25 frames per second */
  t.position[0][0] = (double)INFINITY;
  assert_int_equal(strut_film_make(&film, t.model, &t.motion, NULL), STRUT_DIVERGED);
  assert_int_equal(scratch_count(directory), 1);
}
