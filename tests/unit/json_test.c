/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run's summary as JSON, read back with cJSON bit by bit, and as a table for people. */
#include <locale.h>

#include <cjson/cJSON.h>

#include "engine/output/buffer.h"
#include "engine/output/run_report.h"
#include "tests/support/motion.h"

static strut_node node = {.name = "n1"};
static strut_parameter parameters[] = {{.name = "frequency", .text = "10 Hz", .value = 10.0},
                                       {.name = "amplitude", .text = "0.1 mm", .value = 1e-4},
                                       {.name = "start", .text = "I", .value = (double)NAN}};
static const char *names[] = {"n1", "a \"b\"\\\n"};
static double positions[] = {0.1 + 0.2, -1e-300, 5e-324, 1.7976931348623157e308};
static strut_contact_summary contacts[] = {{.node = "n1", .duty = 1.0 / 3.0, .max_height = 1.1e-3}};

static strut_scene scene = {.name = "Cr\xc3\xa4wler",
                            .description = "",
                            .source = "",
                            .nodes = &node,
                            .node_count = 1,
                            .parameters = parameters,
                            .parameter_count = 3};
static strut_summary summary;

BEFORE_EACH {
  summary = (strut_summary){.status = STRUT_OK,
                            .velocity = 9.7812345678901234e-3,
                            .velocity_spread = (double)NAN,
                            .window.start = 100.0,
                            .duration = 110.0,
                            .settle_time = 0.7,
                            .spent.steps = INT64_C(9007199254740993), /* not a double */
                            .spent.evaluations = 4400000,
                            .step = 1e-4,
                            .step_limit = (double)INFINITY,
                            .spent.wall_time = 0.25,
                            .end.node_count = 2,
                            .end.contact_count = 1,
                            .end.node_names = names,
                            .end.positions = positions,
                            .end.contacts = contacts,
                            .energy = {1.0 / 7.0, 2, 3, 4, 5, 6, 7, 7.5, 8, 9, 10, 11, -1e-17, 13},
                            .balance = STRUT_BALANCE_OPEN};
}

static const cJSON *at(const cJSON *from, const char *key) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(from, key);
  if (!item) fail_msg("no '%s'", key);
  return item;
}

static void assert_number(const cJSON *from, const char *key, double expected) {
  const cJSON *item = at(from, key);
  assert_true(cJSON_IsNumber(item));
  assert_memory_equal(&item->valuedouble, &expected, sizeof expected);
}

static void assert_text(const cJSON *from, const char *key, const char *expected) {
  assert_string_equal(cJSON_GetStringValue(at(from, key)), expected);
}

static void assert_energy(const cJSON *energy, const strut_energy *e) {
  const struct {
    const char *key;
    double value;
  } fields[] = {{"kinetic", e->kinetic},
                {"elastic", e->elastic},
                {"gravity", e->gravity},
                {"contact", e->contact},
                {"drive_work", e->drive_work},
                {"load_work", e->load_work},
                {"belt_work", e->belt_work},
                {"support_work", e->support_work},
                {"dissipated_members", e->dissipated_members},
                {"dissipated_contact", e->dissipated_contact},
                {"dissipated_friction", e->dissipated_friction},
                {"initial", e->initial},
                {"residual", e->residual},
                {"exchanged", e->moved}};
  for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++)
    assert_number(energy, fields[i].key, fields[i].value);
  assert_text(energy, "balance", "open");
  const char *note = cJSON_GetStringValue(cJSON_GetObjectItem(energy, "note"));
  assert_true(note && strstr(note, "balance NOT closed: "));
  assert_int_equal(cJSON_GetArraySize(energy), sizeof fields / sizeof fields[0] + 2);
}

TEST(every_field) {
  RELEASED char *text = strut_summary_json(&summary, &scene, true);
  assert_non_null(strstr(text, "\"steps\":\t9007199254740993,")); /* all digits */
  cJSON *json = cJSON_Parse(text);
  assert_non_null(json);
  assert_text(json, "name", scene.name);
  assert_text(json, "strut_version", STRUT_VERSION);
  assert_number(json, "language", 1.0);
  assert_text(json, "status", "completed");
  assert_true(cJSON_IsNull(at(json, "reason")));
  assert_number(json, "velocity", summary.velocity);
  assert_true(cJSON_IsNull(at(json, "velocity_spread")));
  assert_number(json, "window_start", 100.0);
  assert_number(json, "duration", 110.0);
  assert_number(json, "settle_time", 0.7);
  assert_number(json, "force_evaluations", 4400000.0);
  assert_number(json, "step", 1e-4);
  assert_true(cJSON_IsNull(at(json, "step_limit")));
  assert_number(json, "wall_time", 0.25);
  assert_number(at(json, "parameters"), "amplitude", 1e-4);
  assert_text(at(json, "parameters"), "start", "I");
  for (int i = 0; i < 2; i++) {
    const cJSON *position = at(at(at(json, "nodes"), names[i]), "position");
    assert_int_equal(cJSON_GetArraySize(position), 2);
    assert_memory_equal(&cJSON_GetArrayItem(position, 0)->valuedouble, &positions[2 * i], 8);
    assert_memory_equal(&cJSON_GetArrayItem(position, 1)->valuedouble, &positions[2 * i + 1], 8);
  }
  assert_number(at(at(json, "contacts"), "n1"), "duty", 1.0 / 3.0);
  assert_number(at(at(json, "contacts"), "n1"), "max_height", 1.1e-3);
  assert_energy(at(json, "energy"), &summary.energy);
  cJSON_Delete(json);
}

TEST(files_know_no_wall_time) {
  RELEASED char *first = strut_summary_json(&summary, &scene, false);
  summary.spent.wall_time = 17.0;
  RELEASED char *second = strut_summary_json(&summary, &scene, false);
  assert_null(strstr(first, "wall_time"));
  assert_string_equal(first, second);
}

TEST(a_run_that_stopped_says_why) {
  summary.status = STRUT_DIVERGED;
  strcpy(summary.reason, "node 'n1' left at t = 0.5 s");
  summary.velocity = (double)-INFINITY;
  RELEASED char *text = strut_summary_json(&summary, &scene, false);
  cJSON *json = cJSON_Parse(text);
  assert_text(json, "status", "diverged");
  assert_text(json, "reason", "node 'n1' left at t = 0.5 s");
  assert_true(cJSON_IsNull(at(json, "velocity")));
  cJSON_Delete(json);
  summary.status = STRUT_INTERRUPTED;
  RELEASED char *other = strut_summary_json(&summary, &scene, false);
  assert_non_null(strstr(other, "\"interrupted\""));
}

/* cJSON's memory fails as ours does: no leak, no half text. */
static void *counted_allocate(size_t size) { return strut_allocate(size, 1); }

TEST(no_memory) {
  cJSON_Hooks hooks = {counted_allocate, strut_release};
  cJSON_InitHooks(&hooks);
  RELEASED char *expected = strut_summary_json(&summary, &scene, true);
  for (int table = 0; table < 2; table++) REFUSE_EACH(n, status, table ? 0 : 99) {
      strut_fail_allocation_after(n);
      char *text = table ? strut_summary_table(&summary, &scene, 0)
                         : strut_summary_json(&summary, &scene, true);
      status = granted_again(text ? STRUT_OK : STRUT_NO_MEMORY);
      if (text && !table) assert_string_equal(text, expected);
      strut_release(text);
    }
  cJSON_InitHooks(NULL);
}

TEST(the_table) {
  summary.spent.steps = 1100000;
  summary.step_limit = 5.123456e-4;
  summary.velocity_spread = 2e-6;
  RELEASED char *text = strut_summary_table(&summary, &scene, 0);
  static const char *const expected[] = {
      "Cr\xc3\xa4wler: completed\n",
      "  mean velocity of the centre of mass along x  9.781 mm/s\n",
      "  spread of the velocity                       2 um/s\n"
      "  measured from                                100 s\n",
      "  duration                                     110 s\n"
      "  settling time                                700 ms\n",
      "  steps                                        1100000\n"
      "  step                                         100 us\n",
      "  largest stable step                          512.3 us\n",
      "  computed                                     4400000 force evaluations in 250 ms, "
      "227.3 ns per step\n",
      "  energy, kinetic                              142.9 mJ\n",
      "  lost to friction                             10 J\n",
      "  n1             300 mm",
      "  n1             0.3333      1.1 mm\n"};
  for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++)
    if (!strstr(text, expected[i])) fail_msg("'%s' is not in:\n%s", expected[i], text);
}

TEST(a_long_table_is_cut) {
  enum { NODES = 5000 };
  FREED const char **many = calloc(NODES, sizeof *many);
  FREED double *places = calloc(2 * NODES, sizeof *places);
  for (size_t i = 0; i < NODES; i++) many[i] = "n";
  summary.end.node_names = many;
  summary.end.positions = places;
  summary.end.node_count = NODES;
  RELEASED char *text = strut_summary_table(&summary, &scene, 0);
  assert_non_null(strstr(text, "  ... and 4990 more: JSON and CSV have all\n"));
  int lines = 0;
  for (const char *c = text; *c; c++) lines += *c == '\n';
  assert_in_range(lines, 20, 45);
}

TEST(quantities) {
  static const struct {
    double value;
    int digits;
    const char *unit, *text;
  } cases[] = {{0.0, 4, "m", "0 m"},
               {1.0, 4, "m", "1 m"},
               {0.99996, 4, "m", "1 m"},
               {0.9999, 4, "m", "999.9 mm"},
               {1000.0, 4, "N/m", "1 kN/m"},
               {999.96, 4, "N/m", "1 kN/m"},
               {-9.78123e-3, 3, "m/s", "-9.78 mm/s"},
               {1e-6, 4, "s", "1 us"},
               {1e-3, 4, "s", "1 ms"},
               {123456789.0, 4, "N/m", "123.5 MN/m"},
               {6.8e-4, 2, "s/s", "680 us/s"},
               {0.12345, 1, "s", "100 ms"},
               {6.14e-3, 2, "s", "6.1 ms"},
               {3e-20, 4, "J", "3e-20 J"},
               {2e-10, 4, "m", "2e-10 m"},
               {5e12, 4, "J", "5000 GJ"},
               {(double)NAN, 4, "m", "none"},
               {(double)INFINITY, 4, "s", "no limit"}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    assert_string_equal(strut_quantity_of(cases[i].value, cases[i].digits, cases[i].unit).text,
                        cases[i].text);
  }
}

/* A comma as decimal point must not come through; where no such locale is installed, skip. */
TEST(the_locale_does_not_matter) {
  if (!setlocale(LC_ALL, "de_DE.UTF-8") && !setlocale(LC_ALL, "fr_FR.UTF-8")) skip();
  RELEASED char *json_there = strut_summary_json(&summary, &scene, true);
  RELEASED char *table_there = strut_summary_table(&summary, &scene, 0);
  setlocale(LC_ALL, "C");
  RELEASED char *json = strut_summary_json(&summary, &scene, true);
  RELEASED char *table = strut_summary_table(&summary, &scene, 0);
  assert_all_texts(json_there, json, table_there, table);
}
