/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Blocks of the page, taken apart again by zlib and the inverse written here; and which frames of a
   motion a page takes. */
#include <float.h>
#include <zlib.h>

#include "engine/output/page/page.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

static uint64_t seed = 1;
static double uniform(void) { return random_between(&seed, -1, 1); }

/* The block's values, (frames, columns); to be freed. Fails on bytes too many or too few. */
static double *decode(const strut_block *block, size_t frames) {
  size_t numbers = frames * block->columns, most = 10 * numbers + 1;
  FREED unsigned char *bytes = malloc(most);
  double *values = malloc((numbers + 1) * sizeof *values);
  z_stream zip = {.next_in = block->bytes, .avail_in = (uInt)block->size};
  assert_non_null(bytes);
  assert_non_null(values);
  zip.next_out = bytes;
  zip.avail_out = (uInt)most;
  assert_int_equal(inflateInit2(&zip, -15), Z_OK);
  assert_int_equal(inflate(&zip, Z_FINISH), Z_STREAM_END);
  assert_int_equal(zip.avail_in, 0);
  size_t length = zip.total_out, at = 0;
  inflateEnd(&zip);
  for (size_t c = 0; c < block->columns; c++) {
    int64_t n = 0, slope = 0;
    for (size_t f = 0; f < frames; f++) {
      uint64_t z = 0;
      for (int shift = 0;; shift += 7) {
        assert_true(at < length && shift < 63);
        z |= (uint64_t)(bytes[at] & 127) << shift;
        if (!(bytes[at++] & 128)) break;
      }
      assert_true(z < UINT64_C(1) << 53);
      int64_t number = z & 1 ? -(int64_t)(z / 2) - 1 : (int64_t)(z / 2);
      slope = f < 2 ? number : slope + number;
      n = f == 0 ? number : n + slope;
      values[f * block->columns + c] = (double)n * block->quantum;
    }
  }
  assert_int_equal(at, length);
  return values;
}

/* Encodes, decodes and compares what is taken; the error is at most half a quantum. */
static size_t check(const double *values, size_t frames, size_t columns, size_t every,
                    double quantum) {
  strut_rows rows = {values, frames, columns, every};
  strut_block block;
  assert_true(strut_block_encode(&rows, quantum, &block));
  assert_int_equal(block.columns, columns);
  assert_true(block.quantum == quantum);
  size_t taken = strut_rows_taken(&rows), size = block.size;
  FREED double *back = decode(&block, taken);
  for (size_t i = 0; i < taken; i++) {
    size_t frame = i * every < frames ? i * every : frames - 1;
    for (size_t c = 0; c < columns; c++) {
      double value = values[frame * columns + c], error = fabs(back[i * columns + c] - value);
      assert_true(error <= 0.5 * quantum * (1 + 1e-9) + 2 * DBL_EPSILON * fabs(value));
    }
  }
  strut_block_free(&block);
  return size;
}

TEST(every_value_comes_back) {
  enum { FRAMES = 1001, COLUMNS = 7 };
  static double values[FRAMES * COLUMNS];
  static const double scales[] = {1e-300, 1e-9, 1, 12345.678, 1e300};
  for (size_t s = 0; s < sizeof scales / sizeof *scales; s++) {
    for (size_t i = 0; i < FRAMES * COLUMNS; i++) values[i] = scales[s] * uniform();
    strut_rows rows = {values, FRAMES, COLUMNS, 1};
    double largest = strut_rows_largest(&rows);
    for (size_t every = 1; every <= 2048; every *= 2) {
      check(values, FRAMES, COLUMNS, every, strut_round_quantum(1e-5 * largest, largest));
      check(values, FRAMES, COLUMNS, every, strut_round_quantum(0, largest)); /* the finest */
    }
  }
}

/* From one end of what a block can hold to the other, and back. */
TEST(the_largest_numbers_fit) {
  static const double values[] = {
      STRUT_MOST_QUANTA, -STRUT_MOST_QUANTA, STRUT_MOST_QUANTA, -STRUT_MOST_QUANTA, 0, -1, 1,
      STRUT_MOST_QUANTA};
  check(values, 8, 1, 1, 1);
  check(values, 4, 2, 1, 1);
  check(values, 1, 8, 1, 1);
  check(values, 1, 1, 1, 1);
  check(values, 2, 1, 1, 1);
}

TEST(motion_takes_few_bytes) {
  enum { FRAMES = 100001 };
  FREED double *values = malloc(2 * FRAMES * sizeof *values);
  assert_non_null(values);
  for (size_t i = 0; i < 2 * FRAMES; i++)
    values[i] = (i % 2 ? 0.01 : 0.1) * sin(6.283185307179586e-2 * (double)(i / 2));
  assert_true(check(values, FRAMES, 2, 1, 1e-7) < 2 * FRAMES * 3 / 2);
  for (size_t i = 0; i < 2 * FRAMES; i++) values[i] = 1e-4 * (double)(i / 2) - 3;
  assert_true(check(values, FRAMES, 2, 1, 1e-7) < 2000);
}

/* Whether a number is 1, 2 or 5 times a power of ten, by its text. */
static bool is_round(double value) {
  char text[40];
  snprintf(text, sizeof text, "%.14e", value);
  return strtod(text, NULL) == value && strchr("125", text[0]) &&
         strncmp(text + 1, ".00000000000000e", 16) == 0;
}

TEST(quanta_are_round_and_fine_enough) {
  assert_all(strut_round_quantum(1e-7, 1) == 1e-7, strut_round_quantum(0.999e-7, 1) == 5e-8);
  assert_true(strut_round_quantum(4.99, 1) == 2);
  assert_true(strut_round_quantum(1e-20, 562.949953421312) == 1e-12);
  for (int i = 0; i < 20000; i++) {
    double wanted = pow(10, 280 * uniform()), largest = wanted * pow(10, 14 * uniform());
    double quantum = strut_round_quantum(wanted, largest);
    assert_all(is_round(quantum), largest / quantum <= STRUT_MOST_QUANTA);
    if (wanted * STRUT_MOST_QUANTA > 10 * largest)
      assert_true(quantum <= wanted && quantum > wanted / 2.6);
  }
  assert_all(strut_round_quantum(0, 0) > 0, isfinite(strut_round_quantum(1e303, DBL_MAX)));
}

TEST(whole_steps_are_exact) {
  enum { FRAMES = 5000 };
  static double time[FRAMES];
  for (size_t i = 0; i < FRAMES; i++) time[i] = (double)(1000000 + 7 * i) * 1e-4;
  strut_rows rows = {time, FRAMES, 1, 3};
  OWN(strut_block) block;
  assert_all(strut_rows_multiples(&rows, 1e-4), !strut_rows_multiples(&rows, 2e-4),
             !strut_rows_multiples(&rows, 0));
  assert_true(strut_block_encode(&rows, 1e-4, &block));
  FREED double *back = decode(&block, strut_rows_taken(&rows));
  for (size_t i = 0; i + 1 < strut_rows_taken(&rows); i++) assert_true(back[i] == time[3 * i]);
}

/* A weight on a spring. */
static strut_model *weight(strut_setup *setup) {
  strut_model *model = NULL;
  strut_setup_init(setup);
  build_support(&setup->scene, 0, 0);
  build_mass(&setup->scene, 1, 0, 2);
  build_member(&setup->scene, STRUT_SPRING, 0, 1, 100, 0, 0);
  setup->experiment.step = 1e-3;
  assert_ok(strut_model_compile(&setup->scene, &model, NULL));
  return model;
}

/* A page of a motion of it; NULL: none. */
static char *page_of(strut_trajectory *moved, size_t most, strut_page_frames *frames) {
  OWN(strut_setup) setup;
  OWN_POINTER(strut_model) model = weight(&setup);
  strut_page page = {.model = model,
                     .experiment = &setup.experiment,
                     .motion = moved,
                     .yaml = "strut: 1\n",
                     .most_bytes = most};
  char *html = strut_page_html(&page, frames, NULL);
  assert_non_null(html);
  return html;
}

enum { FRAMES = 1000 };
static double times[FRAMES], positions[FRAMES * 4], forces[FRAMES];

static strut_trajectory swing(void) {
  for (size_t i = 0; i < FRAMES; i++) {
    times[i] = (double)i * 1e-3;
    positions[4 * i] = positions[4 * i + 1] = positions[4 * i + 3] = 0;
    positions[4 * i + 2] = 1 + 0.1 * sin(0.05 * (double)i);
    forces[i] = 10 * sin(0.05 * (double)i);
  }
  return (strut_trajectory){.frames = FRAMES,
                            .node_count = 2,
                            .member_count = 1,
                            .every = 1,
                            .recorded = FRAMES,
                            .time = times,
                            .position = positions,
                            .force = forces};
}

static void has(const char *html, const char *text) {
  if (!strstr(html, text)) fail_msg("the page lacks %s", text);
}

/* What cannot be shown ends the motion, which counts as diverged then. */
TEST(a_motion_ends_where_it_is_no_motion) {
  static const double bad[] = {(double)NAN, (double)INFINITY, -(double)INFINITY, 1e300, -1e300};
  strut_page_frames frames;
  strut_trajectory moved = swing();
  strut_release(page_of(&moved, 0, &frames));
  assert_int_equal(frames.shown, FRAMES);
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    for (int what = 0; what < 2; what++) {
      moved = swing();
      if (what == 1 && isfinite(bad[i])) continue; /* a force may be anything */
      *(what ? &forces[700] : &positions[4 * 700 + 3]) = bad[i];
      RELEASED char *html = page_of(&moved, 0, &frames);
      assert_all_equal(frames.shown, 700, frames.recorded, FRAMES);
      has(html, "\"frames\":700,\"recorded\":1000,\"every\":1,\"status\":\"diverged\"");
      has(html, "\"position\":{\"columns\":4,\"quantum\":1e-6,"); /* not that of 1e300 */
    }
  }
  moved = swing();
  positions[3] = (double)NAN;
  char *html = page_of(&moved, 0, &frames);
  assert_int_equal(frames.shown, 0);
  has(html, "\"motion\":null");
  strut_release(html);
}

/* The characters of all blocks of a page. */
static size_t count_data(const char *html) {
  static const char key[] = "\"bytes\":\"";
  size_t sum = 0;
  for (const char *at = html; (at = strstr(at, key)) != NULL;) {
    at += sizeof key - 1;
    sum += strcspn(at, "\"");
  }
  assert_true(sum > 0);
  return sum;
}

TEST(frames_are_left_out_until_they_fit) {
  strut_page_frames frames;
  size_t previous = FRAMES + 1;
  strut_trajectory moved = swing();
  for (size_t most = 16000; most >= 250; most /= 2) {
    char *html = page_of(&moved, most, &frames), head[80];
    assert_true(frames.shown <= previous && frames.shown >= 2);
    assert_true(frames.shown == 2 || count_data(html) <= most);
    const char *at = strstr(html, "\"every\":");
    assert_non_null(at);
    size_t every = strtoull(at + 8, NULL, 10); /* a power of two; and the last frame */
    assert_int_equal(every & (every - 1), 0);
    assert_int_equal(frames.shown, (FRAMES - 1) / every + 1 + ((FRAMES - 1) % every != 0));
    snprintf(head, sizeof head, "\"frames\":%zu,\"recorded\":1000,", frames.shown);
    has(html, head);
    previous = frames.shown;
    strut_release(html);
  }
  assert_true(previous < FRAMES / 4);
}

/* The data alone are those in the page, and what is beside it follows. */
TEST(a_page_has_its_data_and_those_beside_it) {
  OWN(strut_setup) setup;
  strut_page_frames frames[2];
  strut_trajectory moved = swing();
  OWN_POINTER(strut_model) model = weight(&setup);
  strut_page second = {.model = model,
                       .experiment = &setup.experiment,
                       .motion = &moved,
                       .yaml = "strut: 1\n",
                       .label = "</second>",
                       .most_bytes = 1000};
  strut_page page = second;
  page.label = NULL, page.most_bytes = 0, page.beside = &second;
  RELEASED char *data = strut_page_data(&page, NULL, NULL);
  RELEASED char *other = strut_page_data(&second, &frames[1], NULL);
  assert_true(data && other && frames[1].shown < FRAMES);
  RELEASED char *html = strut_page_html(&page, frames, NULL);
  assert_non_null(html);
  assert_int_equal(frames[0].shown, FRAMES);
  assert_true(frames[1].shown < FRAMES && frames[1].recorded == FRAMES);
  assert_true(data[0] == '{' && strchr(data, '<') == NULL);
  has(html, data);
  has(html, other);
  has(data, "\"label\":\"\"");
  has(other, "\"label\":\"\\u003c/second\\u003e\"");
}

TEST(memory_that_is_out_is_reported) {
  OWN(strut_setup) setup;
  strut_error error = {0};
  strut_trajectory moved = swing();
  OWN_POINTER(strut_model) model = weight(&setup);
  strut_page page = {
      .model = model, .experiment = &setup.experiment, .motion = &moved, .yaml = "strut: 1\n"};
  const strut_page beside = page;
  page.beside = &beside;
  int64_t failed = 0;
  for (int64_t n = 0;; n++) {
    strut_fail_allocation_after(n);
    char *html = strut_page_html(&page, NULL, &error);
    strut_fail_allocation_after(-1);
    if (html) {
      strut_release(html);
      break;
    }
    assert_int_equal(error.status, STRUT_NO_MEMORY);
    failed++;
  }
  assert_true(failed > 5);
}

static size_t count(const char *html, const char *text) {
  size_t found = 0;
  for (const char *at = html; (at = strstr(at, text)) != NULL; at++) found++;
  return found;
}

/* A program that builds its own scene may give things names that the language refuses. */
TEST(no_name_becomes_markup) {
  static const char evil[] = "</script><!--<script>&\"\\\xe2\x80\xa8\n";
  OWN(strut_setup) setup;
  OWN_POINTER(strut_model) model = weight(&setup);
  strut_page page = {.model = model, .experiment = &setup.experiment, .yaml = "strut: 1\n"};
  RELEASED char *plain = strut_page_html(&page, NULL, NULL);
  setup.scene.nodes[0].name = setup.scene.members[0].name = setup.scene.name =
      setup.scene.description = evil;
  page.yaml = page.remark = page.summary = evil;
  RELEASED char *html = strut_page_html(&page, NULL, NULL);
  assert_true(plain && html);
  assert_all_equal(count(html, "<script"), count(plain, "<script"), count(html, "</script"),
                   count(plain, "</script"), count(html, "<!--"), count(plain, "<!--"));
  assert_int_equal(count(html, "\xe2\x80\xa8"), count(plain, "\xe2\x80\xa8") + 1); /* the title */
  has(html,
      "{\"name\":\"\\u003c/"
      "script\\u003e\\u003c!--\\u003cscript\\u003e\\u0026\\\"\\\\\\u2028\\n\",");
}
