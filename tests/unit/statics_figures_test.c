/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of modes and of a path: without memory there is none, nor half of one. */
#include <unistd.h>

#include "engine/output/draw/figure.h"
#include "engine/output/figures/statics_figures.h"
#include "tests/models/run_model.h"
#include "tests/support/check.h"
#include "tests/unit/scratch.h"

/* What draws it, with the n-th allocation failing; whether it was drawn all the same. */
typedef strut_status (*drawing)(const strut_model *model, const void *what, strut_error *error);

static void fails_cleanly(drawing draw, const strut_model *model, const void *what) {
  const char *scratch = scratch_make();
  unlink(scratch_path("a.svg"));
  REFUSE_EACH(n, status, 3) {
    strut_error error = {0};
    status = refused(n, draw(model, what, &error));
    assert_int_equal(error.message[0] != 0, status != STRUT_OK);
    assert_int_equal(scratch_count(scratch), status == STRUT_OK);
  }
  assert_true(scratch_exists(scratch_path("a.svg")));
}

static strut_status draw_modes(const strut_model *model, const void *what, strut_error *error) {
  return strut_modes_figure(&(strut_plot){.path = scratch_path("a.svg"), .width = 300}, model, what,
                            0, error);
}

static strut_status draw_path(const strut_model *model, const void *what, strut_error *error) {
  return strut_path_figure(&(strut_plot){.path = scratch_path("a.svg"), .width = 300}, model, what,
                           error);
}

TEST(modes) {
  OWN(model_run) run = {0};
  OWN(strut_modes) modes = {0};
  run = model_read("basics/x-frame", set_none);
  assert_ok(strut_model_compile(&run.setup.scene, &run.model, NULL));
  assert_ok(
      strut_modes_find(run.model, &run.setup.experiment, &(strut_modes_options){0}, &modes, NULL));
  fails_cleanly(draw_modes, run.model, &modes);
}

TEST(path) {
  OWN(model_run) run = {0};
  OWN(strut_path) path = {0};
  run = model_read("basics/von-mises-truss", set_to("load=12"));
  assert_ok(strut_model_compile(&run.setup.scene, &run.model, NULL));
  assert_ok(
      strut_path_follow(run.model, &run.setup.experiment, &(strut_path_options){0}, &path, NULL));
  fails_cleanly(draw_path, run.model, &path);
}

/* No letter is cut in two, and a line that is cut keeps within its width. */
TEST(texts) {
  static const char text[] = "\xD7\xA9\xD7\x9C\xD7\x95\xD7\x9D \xE2\x82\xAC \xF0\x9F\x98\x80 node";
  strut_canvas *canvas = NULL;
  assert_ok(strut_canvas_open_pixels(1, 1, 1.0, &canvas, NULL));
  double line = strut_text_box(canvas, text, (strut_font){.size = 8}).height;
  for (double room = 200; room > 20; room -= 3) {
    const strut_font font = {.size = 8, .width = room, .lines = 1};
    assert_true(strut_text_box(canvas, text, font).width <= room + 1e-3);
    assert_true(fabs(strut_text_box(canvas, text, font).height - line) < 0.5 * line);
  }
  strut_canvas_free(canvas);
  assert_all_equal(strut_text_bytes("abc", 2), 2, strut_text_bytes("a\xE2\x82\xAC", 3), 1);
  assert_int_equal(strut_text_bytes("a\xE2\x82\xAC", 4), 4);
  assert_int_equal(strut_text_bytes("\xD7\xA9\xD7", 3), 2); /* cut by who made it */
  assert_int_equal(strut_text_bytes("\xF0\x9F\x98\x80", 3), 0);
}
