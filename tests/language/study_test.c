/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Studies that are read, and studies that are refused with exactly the messages they announce. */
#include <dirent.h>

#include "engine/base/memory.h"
#include "engine/study/sweep/sweep.h"
#include "parser/language/keys/keys.h"
#include "parser/language/study/read_study.h"
#include "tests/language/case_messages.h"
#include "tests/support/check.h"

#define FOLDER STRUT_TESTS_DIR "/language/studies/"

static char *read_text(const char *path) {
  FILE *file = fopen(path, "rb");
  if (!file) return NULL;
  char *text = calloc(1, 1 << 16);
  if (fread(text, 1, (1 << 16) - 1, file) == 0) text[0] = '\0';
  fclose(file);
  return text;
}

/* As `strut sweep` does: the first point, then the ends of each axis. */
static strut_status try_ends(strut_study_file *file) {
  strut_study_value values[16];
  assert_true(file->column_count <= 16);
  strut_grid_values(&file->study, 0, values);
  strut_status status = strut_study_try(file, values, NULL);
  int64_t stride = 1;
  for (size_t a = file->study.axis_count; a-- > 0 && !status;) {
    strut_grid_values(&file->study, stride * (file->study.axes[a].count - 1), values);
    status = strut_study_try(file, values, NULL);
    stride *= file->study.axes[a].count;
  }
  return status;
}

/* What a case calls the file of a place. */
static const char *file_of(const strut_diagnostics *found, strut_place place) {
  const char *name = strut_diagnostics_text(found, place).file, *dot = strrchr(name, '.');
  return dot && strcmp(dot, ".csv") == 0 ? "table " : strstr(name, "/models/") ? "model " : "";
}

/* Reads a base or case from the folder, which holds the models and tables that it names. */
static size_t check_case(faulty_case *c, const char *folder) {
  char path[600];
  size_t wrong = 0;
  strut_study_file file;
  strut_error error = {0};
  strut_setting set[CASE_MOST_SETS];
  split_settings(c, set);
  assert_true(write_faulty_case(c, folder));
  snprintf(path, sizeof path, "%s/%s.yaml", folder, c->name);
  strut_status status = strut_study_open(path, set, c->set_count, &file, &error);
  if (status == STRUT_OK) status = try_ends(&file);
  if (status != (c->is_base ? STRUT_OK : STRUT_BAD_SCENE)) {
    print_error("%s: %s: status %d, %s\n", c->document, c->name, status, error.message);
    wrong++;
  }
  wrong += strike_messages(c, &file.diagnostics, file_of);
  wrong += strike_messages(c, &file.model_diagnostics, file_of) + missing_messages(c);
  assert_non_null(strut_study_messages(&file, 50));
  strut_study_close(&file);
  return wrong;
}

TEST(bad_studies_are_refused) {
  char folder[] = "/tmp/strut-studies-XXXXXX", command[700];
  size_t wrong = 0, faulty = 0;
  assert_non_null(mkdtemp(folder));
  snprintf(command, sizeof command, "cp -R " FOLDER "bad/. %s", folder);
  assert_int_equal(system(command), 0);
  faulty_cases cases = read_faulty_cases(FOLDER "bad");
  for (size_t i = 0; i < cases.count; i++)
    if (!cases.items[i].is_base) assert_true(write_faulty_case(&cases.items[i], folder));
  for (size_t i = 0; i < cases.count; i++) {
    wrong += check_case(&cases.items[i], folder);
    faulty += !cases.items[i].is_base;
  }
  free_faulty_cases(&cases);
  snprintf(command, sizeof command, "rm -rf %s", folder);
  assert_int_equal(system(command), 0);
  print_message("%zu faulty studies\n", faulty);
  assert_true(faulty > 10);
  assert_int_equal(wrong, 0);
}

static void open_good(const char *name, strut_study_file *file) {
  static char path[600]; /* the study refers to it */
  strut_error error = {0};
  snprintf(path, sizeof path, FOLDER "good/%s", name);
  strut_status status = strut_study_open(path, NULL, 0, file, &error);
  if (status == STRUT_OK) status = try_ends(file);
  if (status != STRUT_OK)
    print_error("%s: %s\n%s", name, error.message, strut_study_messages(file, 50));
  assert_ok(status);
}

/* Does a good study have this text? */
static bool stands_in_a_good_study(const char *text) {
  DIR *folder = opendir(FOLDER "good");
  bool found = false;
  assert_non_null(folder);
  for (struct dirent *entry; !found && (entry = readdir(folder)) != NULL;) {
    char path[600];
    if (!strstr(entry->d_name, ".yaml")) continue;
    snprintf(path, sizeof path, FOLDER "good/%s", entry->d_name);
    FREED char *good = read_text(path);
    found = strstr(good, text) != NULL;
  }
  closedir(folder);
  return found;
}

TEST(every_key_stands_in_a_good_study) {
  for (int key = strut_section_first(STRUT_SECTION_STUDY); key < STRUT_KEY_COUNT; key++) {
    char with_colon[60];
    snprintf(with_colon, sizeof with_colon, "%s:", strut_key_at(key)->name);
    if (!stands_in_a_good_study(with_colon))
      fail_msg("no good study has the key '%s'", strut_key_at(key)->name);
  }
}

/* The words of `keep` are bits of the study, in one order. */
TEST(keep_is_one_table) {
  static const char *const words[] = {
#define WORD(name, word, of) word,
      STRUT_KEEP_TABLE(WORD)
#undef WORD
  };
  char word[40];
  for (int i = 0; i < STRUT_KEEP_COUNT; i++) {
    assert_non_null(strut_word_at(strut_key_at(STRUT_KEY_STUDY_KEEP)->words, i, word, sizeof word));
    assert_string_equal(word, words[i]);
  }
  assert_null(strut_word_at(strut_key_at(STRUT_KEY_STUDY_KEEP)->words, STRUT_KEEP_COUNT, word,
                            sizeof word));
}

TEST(points_of_files_and_samples) {
  strut_study_file file;
  strut_study_value values[16];
  strut_setup setup;
  open_good("points.yaml", &file);
  assert_all_equal(strut_grid_points(&file.study), 2 * 5, file.table_count, 1);
  strut_grid_values(&file.study, 7, values);
  assert_true(values[0].number == 0.75 && values[1].number == 200);
  assert_string_equal(values[2].word, "far");
  assert_ok(strut_study_setup(&file, values, &setup, NULL));
  assert_true(setup.scene.nodes[1].mass == 0.75);
  strut_setup_free(&setup);
  char *copy = strut_study_copy(&file, "elsewhere.yaml", NULL, 0);
  assert_non_null(strstr(copy, "model: elsewhere.yaml\n"));
  assert_non_null(
      strstr(copy, "- points: {file: points-1.csv, columns: [mass, stiffness, start]}"));
  strut_release(copy);
  strut_study_close(&file);
  open_good("points-short.yaml", &file);
  assert_int_equal(strut_grid_points(&file.study), 2 * 2);
  strut_study_close(&file);
}

TEST(studies_of_what_is_at_rest) {
  static const char *const names[] = {"path.yaml", "path-load.yaml", "form.yaml", "modes.yaml"};
  strut_study_file file;
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    open_good(names[i], &file);
    if (i == 0) {
      assert_int_equal(file.study.compute, STRUT_COMPUTE_PATH);
      assert_string_equal(file.study.path.over, "drive");
      assert_true(file.study.path.from == -1e-3 && file.study.path.until == 10e-3);
      assert_string_equal(file.study.path.until_unit, "m");
      assert_int_equal(file.study.path.steps, 50);
    }
    if (i == 2) assert_true(file.study.form.least_density == 2.0 && file.study.form.from == 3);
    strut_study_close(&file);
  }
}

TEST(a_study_is_what_it_says) {
  strut_study_file file;
  strut_setup setup;
  strut_study_value values[5];
  open_good("every-key.yaml", &file);
  assert_all_equal(strut_grid_points(&file.study), 2 * 3 * 2 * 3, file.study.figure_count, 6);
  const strut_study_figure *figures = file.study.figures;
  assert_all(
      figures[0].kind == STRUT_FIGURE_LINES && isinf(figures[0].to),
      figures[3].kind == STRUT_FIGURE_MOTION && figures[3].from == 0.1 && figures[3].to == 0.2);
  assert_int_equal(figures[4].time_count, 2);
  assert_all(figures[4].times[1] == 0.12 && figures[5].scale[0] == 10, file.study.half_step);
  assert_int_equal(file.study.keep.bits[0],
                   1 << STRUT_KEEP_VELOCITY | 1 << STRUT_KEEP_WORK | 1 << STRUT_KEEP_POSITIONS);
  strut_grid_values(&file.study, 18 + 2 * 6 + 1 * 3 + 1, values);
  assert_string_equal(values[0].word, "long");
  assert_ok(strut_study_setup(&file, values, &setup, NULL));
  assert_all(setup.scene.loads[0].force[0] == 0.25, setup.scene.nodes[1].mass == 0.5);
  assert_true(setup.scene.members[0].stiffness == 200);
  assert_true(setup.scene.signals[setup.scene.actuators[0].signal].amplitude == 2e-3);
  double f = setup.scene.signals[setup.scene.actuators[0].signal].frequency;
  assert_true(f > 3.16227766 && f < 3.16227767);
  assert_true(setup.experiment.step == 1 / (500 * f)); /* derived from the axis */
  assert_string_equal(setup.experiment.integrator, "verlet");
  assert_true(setup.experiment.duration == 3 && setup.experiment.periods == 0);
  assert_int_equal(setup.experiment.measure_node, 1); /* kept below the study's own keys */
  assert_true(setup.scene.nodes[1].start[0] == 1.01);
  assert_true(setup.experiment.output_every == 0.01 && setup.experiment.output_last == 0);
  strut_setup_free(&setup);
  strut_grid_values(&file.study, 2 * 6 + 1 * 3 + 1, values); /* the same of the other variant */
  assert_string_equal(values[0].word, "coarse");
  assert_ok(strut_study_setup(&file, values, &setup, NULL));
  assert_string_equal(setup.experiment.integrator, "euler");
  assert_true(setup.experiment.step == 1 / (500 * f) && setup.experiment.duration == 2);
  assert_true(setup.scene.nodes[1].start[0] == 1.02 && setup.experiment.output_last == 0.1);
  assert_true(setup.scene.loads[0].force[0] == 0.25);
  strut_setup_free(&setup);
  strut_study_close(&file);
}

/* Former names of keys in a study and its variants: read, noted once, and replaced by current ones. */
TEST(former_names_are_noted_once) {
  static const double expected[] = {1e-3, 1e-9};
  strut_study_file file;
  open_good("former-names.yaml", &file);
  for (int64_t variant = 0; variant < 2; variant++) {
    strut_study_value values[2];
    OWN(strut_setup) setup;
    strut_grid_values(&file.study, 2 * variant, values);
    assert_ok(strut_study_setup(&file, values, &setup, NULL));
    assert_true(setup.experiment.steady.floor == expected[variant]);
    assert_int_equal(setup.experiment.steady.successive, 4);
  }
  const char *notes = strut_study_notes(&file);
  assert_non_null(strstr(notes,
                         "former-names.yaml:5:43: note: 'successive' is now called "
                         "'repetitions'"));
  assert_non_null(strstr(notes,
                         "former-names.yaml:8:35: note: 'floor' is now called "
                         "'absolute_tolerance'"));
  assert_all_equal(file.diagnostics.note_count, 0, file.model_diagnostics.note_count, 2);
  strut_study_close(&file);
}

/* Comments and blanks change nothing; what decides results does. */
TEST(identity) {
  static const strut_setting stiff[] = {{.name = "stiffness", .text = "101 N/m"}};
  strut_study_file a, b, c;
  open_good("accuracy.yaml", &a);
  open_good("accuracy.yaml", &b);
  assert_ok(strut_study_open(FOLDER "good/accuracy.yaml", stiff, 1, &c, NULL));
  char *one = strut_study_identity(&a), *two = strut_study_identity(&b),
       *other = strut_study_identity(&c);
  assert_string_equal(one, two);
  assert_string_not_equal(one, other);
  strut_release(one);
  strut_release(two);
  strut_release(other);
  strut_study_close(&a);
  strut_study_close(&b);
  strut_study_close(&c);
}

/* Every allocation fails once: an answer, and nothing left behind. */
TEST(no_memory) {
  static const char *const files[] = {FOLDER "good/every-key.yaml", FOLDER "good/points.yaml"};
  for (int i = 0; i < 2; i++) REFUSE_EACH(n, status, 1) {
      strut_study_file file;
      status = refused(n, strut_study_open(files[i], NULL, 0, &file, NULL));
      strut_study_close(&file);
    }
}
