/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The canvas: pixels where they belong, same bytes twice, whole files or none, colours that grow. */
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include "engine/output/draw/figure.h"
#include "tests/support/check.h"
#include "tests/unit/scratch.h"

static const char *const endings[] = {"svg", "pdf", "png"};

static const char *folder;

BEFORE_EACH { folder = scratch_make(); }

static const char *path_of(const char *name, const char *ending) {
  char full[40];
  snprintf(full, sizeof full, "%s.%s", name, ending);
  return scratch_path(full);
}

static void draw_something(strut_canvas *c) {
  const double corners[3][2] = {{10, 10}, {60, 20}, {30, 70}};
  for (size_t i = 0; i < 2; i++) {
    const strut_fill fill = {strut_palette_thing(i), strut_faded(strut_grey(1), (double)i)};
    strut_draw_polygon(c, corners, 3, &fill, NULL);
  }
  strut_draw_arrow(c, 5, 5, 80, 40, 6, (strut_pen){.colour = strut_grey(0), .width = 1});
  strut_draw_text(c, 50, 50, "<b>&\"' \xd7\xa9\xd7\x9c\xd7\x95\xd7\x9d", (strut_font){.size = 9});
  strut_draw_text(c, 50, 50, "up", (strut_font){.upwards = true, .halo = strut_grey(1)});
}

static strut_canvas *open_canvas(const char *path, double width, double height) {
  strut_canvas *c;
  assert_ok(strut_canvas_open(path, width, height, "A <title> & more", &c, NULL));
  return c;
}

static void commit(strut_canvas *c) {
  assert_ok(strut_canvas_commit(c, NULL));
  strut_canvas_free(c);
}

static void write_picture(const char *path) {
  strut_canvas *c = open_canvas(path, 100, 80);
  draw_something(c);
  commit(c);
}

#define MINUS "\xe2\x88\x92"

/* A quantity's ASCII u is drawn as micro, and the sign of a number as a minus; those of words are not. */
TEST(signs) {
  static const struct {
    const char *written, *drawn;
    bool same;
  } cases[] = {{"50 us", "50 \xc2\xb5s", true},
               {"1 um/s, 2 uN", "1 \xc2\xb5m/s, 2 \xc2\xb5N", true},
               {"-3.2 uJ", MINUS "3.2 \xc2\xb5J", true},
               {"from -1e-3, (-2)", "from " MINUS "1e" MINUS "3, (" MINUS "2)", false},
               {"n-1", "n" MINUS "1", false},
               {"3 users", "3 \xc2\xb5sers", false},
               {"us", "\xc2\xb5s", false}};
  strut_canvas *c;
  assert_ok(strut_canvas_open_pixels(1, 1, 1, &c, NULL));
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    double one = strut_text_box(c, cases[i].written, (strut_font){.size = 100}).width;
    double two = strut_text_box(c, cases[i].drawn, (strut_font){.size = 100}).width;
    assert_true((fabs(one - two) < 1e-3) == cases[i].same);
  }
  strut_canvas_free(c);
}

/* Labels that crowd around one point are all drawn, none over another, else a note counts the rest. */
TEST(labels) {
  const char *path = scratch_path("labels.svg");
  double box[40][4];
  size_t count = 0, length;
  strut_canvas *c = open_canvas(path, 200, 160);
  for (int i = 0; i < 20; i++) {
    char text[20];
    snprintf(text, sizeof text, "label %d", i);
    strut_draw_label(c, &(strut_label){.text = text, .at = {100, 80}, .gap = 3, .angle = 0.1 * i});
  }
  commit(c);
  FREED char *bytes = scratch_read(path, &length);
  assert_non_null(bytes);
  for (char *at = strstr(bytes, "<t box"); at; at = strstr(at + 1, "<t box")) {
    double *b = box[count++];
    assert_int_equal(sscanf(at, "<t box=\"%lf %lf %lf %lf\">", &b[0], &b[1], &b[2], &b[3]), 4);
  }
  char *note = strstr(bytes, " labels left out");
  while (note && note[-1] != '>') note--;
  assert_int_equal(note ? (int)count - 1 + atoi(note) : (int)count, 20);
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < i; k++) {
      double wide = fmin(box[i][0] + box[i][2], box[k][0] + box[k][2]) - fmax(box[i][0], box[k][0]);
      double high = fmin(box[i][1] + box[i][3], box[k][1] + box[k][3]) - fmax(box[i][1], box[k][1]);
      assert_true(wide < 0.2 || high < 0.2);
    }
}

/* What labels keep off, of a net of lines and an area at round places; the noise is that of rounding. */
static strut_canvas *blackened_net(double noise) {
  const strut_pen pen = {.colour = strut_grey(0), .width = 1.0};
  const strut_fill fill = {.colour = strut_grey(0.6)};
  strut_canvas *canvas;
  double at[9][2];
  assert_int_equal(strut_canvas_open_pixels(100, 100, 1.0, &canvas, NULL), STRUT_OK);
  strut_canvas_clip(canvas, (strut_box){5 - noise, 5 + noise, 90 + noise, 90 - noise});
  for (int i = 0; i < 9; i++)
    for (int d = 0; d < 2; d++)
      at[i][d] = 20.0 + 30.0 * (d ? i / 3 : i % 3) + (i * 5 + d) % 3 * noise - noise;
  for (int i = 0; i < 9; i++)
    for (int k = 0; k < i; k++)
      strut_draw_segment(canvas, at[k][0], at[k][1], at[i][0], at[i][1], pen);
  strut_draw_polygon(canvas, (const double(*)[2])at + 3, 3, &fill, NULL);
  strut_canvas_unclip(canvas);
  return canvas;
}

/* Another processor or BLAS rounds otherwise: what decides where labels stand is the same. */
TEST(rounding_moves_no_ink) {
  strut_canvas *one = blackened_net(0.0);
  double all = strut_canvas_ink(one, (strut_box){0, 0, 100, 100});
  assert_true(all > 500 && all < 5000);
  for (int sign = -1; sign <= 1; sign += 2) {
    strut_canvas *two = blackened_net(sign * 1e-12);
    for (int k = 0; k < 100 * 100; k++) {
      const strut_box pixel = {k % 100, k / 100, 1, 1};
      assert_true(strut_canvas_ink(one, pixel) == strut_canvas_ink(two, pixel));
    }
    strut_canvas_free(two);
  }
  strut_canvas_free(one);
}

TEST(same_bytes) {
  for (size_t k = 0; k < 3; k++) {
    const char *one = path_of("first", endings[k]), *two = path_of("second", endings[k]);
    size_t size;
    write_picture(one);
    if (k == 1) sleep(1); /* a clock in the file would show */
    write_picture(two);
    FREED char *first = scratch_read(one, &size);
    assert_true(first && size > 500);
    scratch_expect(two, first, size);
  }
  assert_int_equal(scratch_count(folder), 6);
}

TEST(png_size) {
  size_t length;
  write_picture(scratch_path("size.png"));
  FREED char *bytes = scratch_read(scratch_path("size.png"), &length);
  const unsigned char *head = (const unsigned char *)bytes;
  assert_true(head && length > 24);
  assert_memory_equal(head + 1, "PNG", 3);
  assert_int_equal(head[18] << 8 | head[19], 417); /* 100 pt at 300 to the inch, rounded */
  assert_int_equal(head[22] << 8 | head[23], 333);
}

TEST(names) {
  static const char *const good[] = {"a.svg", "b/c.pdf", "./x.y.png"};
  static const char *const bad[] = {"a", "a.bmp", ".svg", "d.svg/file", "d/.png", "a.SVG", ""};
  strut_error error;
  for (size_t i = 0; i < 3; i++) assert_int_equal(strut_figure_check_name(good[i], &error), 0);
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    assert_fails(strut_figure_check_name(bad[i], &error), STRUT_USAGE, error, ".pdf");
}

TEST(nothing_left) {
  strut_canvas *c;
  for (size_t k = 0; k < 3; k++) {
    c = open_canvas(path_of("left", endings[k]), 100, 80);
    draw_something(c);
    strut_canvas_free(c);
    assert_int_equal(scratch_count(folder), 0);
  }
  assert_int_equal(strut_canvas_open("/nowhere/at/all.svg", 100, 80, "", &c, NULL),
                   STRUT_FILE_TROUBLE);
  assert_null(c);
}

/* A full disk is reported on commit. */
TEST(full) {
  strut_canvas *c = open_canvas(scratch_path("full.svg"), 100, 80);
  draw_something(c);
  struct rlimit before; /* no disk is needed: a limit of files' sizes does the same */
  assert_true(getrlimit(RLIMIT_FSIZE, &before) == 0 && signal(SIGXFSZ, SIG_IGN) != SIG_ERR);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &(struct rlimit){100, before.rlim_max}), 0);
  assert_int_equal(strut_canvas_commit(c, NULL), STRUT_FILE_TROUBLE);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
  strut_canvas_free(c);
  assert_int_equal(scratch_count(folder), 0);
}

static void assert_pixel(strut_canvas *c, int x, int y, unsigned red, unsigned green,
                         unsigned blue) {
  size_t stride;
  const unsigned char *at = strut_canvas_pixels(c, &stride) + (size_t)y * stride + 4 * (size_t)x;
  if (at[2] != red || at[1] != green || at[0] != blue)
    fail_msg("pixel %d, %d is %d %d %d", x, y, at[2], at[1], at[0]);
}

TEST(pixels) {
  strut_canvas *c;
  const strut_fill red = {.colour = {1, 0, 0, 1}}, blue = {.colour = {0, 0, 1, 1}};
  assert_ok(strut_canvas_open_pixels(200, 100, 2.0, &c, NULL));
  assert_true(strut_canvas_box(c).width == 100 && strut_canvas_box(c).height == 50);
  assert_pixel(c, 0, 0, 255, 255, 255);
  strut_draw_box(c, (strut_box){10, 20, 30, 10}, &red, NULL);
  assert_pixel(c, 20, 40, 255, 0, 0); /* its corners, at two pixels a point */
  assert_pixel(c, 79, 59, 255, 0, 0);
  assert_pixel(c, 19, 40, 255, 255, 255);
  assert_pixel(c, 80, 59, 255, 255, 255);
  strut_canvas_clip(c, (strut_box){50, 0, 10, 50});
  strut_draw_box(c, (strut_box){0, 0, 100, 5}, &blue, NULL);
  strut_canvas_unclip(c);
  assert_pixel(c, 99, 5, 255, 255, 255);
  assert_pixel(c, 100, 5, 0, 0, 255);
  assert_pixel(c, 120, 5, 255, 255, 255);
  strut_canvas_clear(c, strut_grey(0));
  assert_pixel(c, 20, 40, 0, 0, 0);
  strut_canvas_free(c);
}

/* Numbers that no page has change nothing else. */
TEST(far_away) {
  const strut_pen pen = {.colour = strut_grey(0), .width = 1};
  const strut_fill fill = {.colour = strut_grey(0.5), .hatch = strut_grey(1)};
  const double points[3][2] = {{NAN, 1}, {1e300, -INFINITY}, {3, -1e300}};
  strut_canvas *c = open_canvas(scratch_path("far.svg"), 100, 80);
  strut_draw_line(c, points, 3, pen);
  strut_draw_line(c, points, 0, pen);
  strut_draw_circle(c, NAN, INFINITY, 3, &fill, &pen);
  strut_draw_arrow(c, 1, 1, 1, 1, 5, pen);
  strut_draw_arrow(c, NAN, 1, 1, 1, 5, pen);
  strut_draw_text(c, NAN, 1e300, "far", (strut_font){0});
  strut_draw_text(c, 1, 1, "", (strut_font){0});
  strut_draw_text(c, 1, 1, "not UTF-8: \xff\xfe", (strut_font){0});
  commit(c);
  assert_int_equal(scratch_count(folder), 1);
}

/* Lightness as the eye sees it, about: luma of the sRGB values. */
static double lightness(strut_colours colours, double at) {
  strut_colour c = strut_palette_at(colours, at, colours == STRUT_COLOURS_SIGNED ? -1 : 0, 1);
  return 0.299 * c.red + 0.587 * c.green + 0.114 * c.blue;
}

TEST(palettes) {
  for (int k = 0; k < 2; k++) {
    strut_colours colours = k ? STRUT_COLOURS_SIGNED : STRUT_COLOURS_SEQUENTIAL;
    for (double i = k ? -100 : 0; i < 100; i++)
      assert_true(lightness(colours, (i + 1) / 100) > lightness(colours, i / 100));
    assert_true(lightness(colours, 5) < (k ? 0.75 : 0.78));
  }
  assert_true(strut_palette_at(STRUT_COLOURS_SIGNED, NAN, -1, 1).alpha > 0);
}
