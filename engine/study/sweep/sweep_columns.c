/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The columns of a study's table, and their cells from the summary of a run. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/study/sweep/grid.h"
#include "engine/study/sweep/sweep_parts.h"

#define BIT(name) (1u << STRUT_KEEP_##name)
static const unsigned USUAL = BIT(VELOCITY) | BIT(SPREAD) | BIT(MOTION) | BIT(PERIODS) |
                              BIT(EVALUATIONS) | BIT(OUTCOME) | BIT(QUANTITIES);

/* The columns of each word of `keep`, in order. */
typedef struct entry {
  strut_keep keep;
  const char *name, *unit;
  bool word;
} entry;

static const entry entries[] = {
    {STRUT_KEEP_VELOCITY, "velocity", "m/s", false},
    {STRUT_KEEP_SPREAD, "velocity_spread", "m/s", false},
    {STRUT_KEEP_INTERVAL, "velocity_interval", "m/s", false},
    {STRUT_KEEP_MOTION, "motion", "1", true},
    {STRUT_KEEP_REPEATS, "repeats", "1", false},
    {STRUT_KEEP_PERIODS, "periods", "1", false},
    {STRUT_KEEP_DISTANCE, "distance", "m", false},
    {STRUT_KEEP_DURATION, "duration", "s", false},
    {STRUT_KEEP_SETTLE_TIME, "settle_time", "s", false},
    {STRUT_KEEP_STEPS, "steps", "1", false},
    {STRUT_KEEP_EVALUATIONS, "force_evaluations", "1", false},
    {STRUT_KEEP_CHECKS, "check_evaluations", "1", false},
    {STRUT_KEEP_EVENTS, "events", "1", false},
    {STRUT_KEEP_METHOD, "method", "1", true},
    {STRUT_KEEP_STEP, "step", "s", false},
    {STRUT_KEEP_STEP_LIMIT, "step_limit", "s", false},
    {STRUT_KEEP_EXPECTED, "expected_error", "1", false},
    {STRUT_KEEP_KEPT, "accuracy_kept", "1", false},
    {STRUT_KEEP_ENERGY, "kinetic", "J", false},
    {STRUT_KEEP_ENERGY, "elastic", "J", false},
    {STRUT_KEEP_ENERGY, "gravity", "J", false},
    {STRUT_KEEP_ENERGY, "contact", "J", false},
    {STRUT_KEEP_WORK, "drive_work", "J", false},
    {STRUT_KEEP_WORK, "load_work", "J", false},
    {STRUT_KEEP_WORK, "belt_work", "J", false},
    {STRUT_KEEP_LOSSES, "dissipated_members", "J", false},
    {STRUT_KEEP_LOSSES, "dissipated_contact", "J", false},
    {STRUT_KEEP_LOSSES, "dissipated_friction", "J", false},
    {STRUT_KEEP_RESIDUAL, "residual", "J", false},
};
enum { ENTRIES = sizeof entries / sizeof entries[0] };

static bool keeps(const strut_sweep_plan *plan, strut_keep keep) { return plan->keep >> keep & 1u; }

/* Does one of the first `count` columns have this name? An axis may share the name of a column. */
static bool is_taken(const strut_sweep_plan *plan, size_t count, const char *name) {
  bool found = false;
  for (size_t i = 0; i < count && !found; i++) found = strcmp(plan->columns[i].name, name) == 0;
  return found;
}

/* Adds a column; one with the name of an axis gets the prefix "run_". */
static bool add_column(strut_sweep_plan *plan, const char *prefix, const char *name,
                       const char *unit, bool word) {
  const char *text = strut_arena_format(&plan->arena, "%s%s", prefix, name);
  while (text && plan->column_count >= plan->axis_columns &&
         is_taken(plan, plan->axis_columns, text))
    text = strut_arena_format(&plan->arena, "run_%s", text);
  assert(plan->column_count < plan->column_capacity);
  plan->columns[plan->column_count++] = (strut_slot_column){text, unit, word};
  return text != NULL;
}

static bool add_things(strut_sweep_plan *plan, const strut_scene *scene) {
  bool fine = true;
  for (size_t i = 0; i < scene->contact_count && keeps(plan, STRUT_KEEP_CONTACTS); i++) {
    const char *node = scene->nodes[scene->contacts[i].node].name;
    fine = fine && add_column(plan, "duty_", node, "1", false) &&
           add_column(plan, "height_", node, "m", false);
  }
  for (size_t i = 0; i < scene->node_count && keeps(plan, STRUT_KEEP_POSITIONS); i++)
    fine = fine && add_column(plan, "x_", scene->nodes[i].name, "m", false) &&
           add_column(plan, "y_", scene->nodes[i].name, "m", false);
  return fine;
}

static bool is_kept(const strut_study *study, const char *quantity) {
  for (size_t i = 0; i < study->quantity_count; i++)
    if (strcmp(study->quantities[i], quantity) == 0) return true;
  return false;
}

/* Adds the measured quantities that are kept; one with the name of a column gets a prefix. */
static bool add_quantities(strut_sweep_plan *plan, const strut_experiment *e) {
  for (size_t i = 0; i < e->quantity_count; i++) {
    const strut_quantity_definition *d = &e->quantities[i];
    if (!keeps(plan, STRUT_KEEP_QUANTITIES) && !is_kept(plan->study, d->name)) continue;
    const char *name = strut_arena_text(&plan->arena, d->name, strlen(d->name));
    const char *unit = strut_arena_text(&plan->arena, d->unit, strlen(d->unit));
    if (!name || !unit) return false;
    plan->quantities[plan->quantity_count++] = name;
    bool taken =
        is_taken(plan, plan->column_count, name) && !is_taken(plan, plan->axis_columns, name);
    if (!add_column(plan, taken ? "measured_" : "", name, unit, false)) return false;
  }
  return true;
}

static bool add_columns(strut_sweep_plan *plan, const strut_setup *setup) {
  bool fine = true;
  for (size_t i = 0; i < plan->axis_columns && fine; i++) {
    const strut_study_column *c = strut_grid_column(plan->study, i, NULL);
    fine = add_column(plan, "", c->name, c->unit, c->word);
  }
  for (size_t i = 0; i < ENTRIES && fine; i++)
    if (keeps(plan, entries[i].keep))
      fine = add_column(plan, "", entries[i].name, entries[i].unit, entries[i].word);
  fine = fine && add_things(plan, &setup->scene) && add_quantities(plan, &setup->experiment);
  if (fine && keeps(plan, STRUT_KEEP_OUTCOME)) fine = add_column(plan, "", "outcome", "1", true);
  if (fine && plan->start) fine = add_column(plan, "", "start_unstable", "1", false);
  if (fine && plan->check)
    fine = add_column(plan, "check_", "velocity", "m/s", false) &&
           add_column(plan, "check_", plan->flips ? "outcome" : "motion", "1", true) &&
           add_column(plan, "", "flips", "1", false);
  return fine;
}

static strut_status choose_columns(strut_sweep_plan *plan, const strut_setup *setup,
                                   strut_error *error) {
  const strut_scene *scene = &setup->scene;
  const strut_study *study = plan->study;
  bool shapes = scene->configuration_count > 0;
  bool usual = !study->keep && !study->quantity_count;
  plan->keep = usual ? USUAL : study->keep;
  if (usual && !shapes) plan->keep &= ~BIT(OUTCOME);
  plan->start = usual && setup->experiment.settle.wanted;
  plan->check = study->half_step || study->check_accuracy > 0.0;
  if (plan->check && shapes) plan->keep |= BIT(OUTCOME);
  if (plan->check && !shapes) plan->keep |= BIT(MOTION);
  plan->flips = plan->check && shapes;
  size_t quantities = setup->experiment.quantity_count;
  size_t most = plan->axis_columns + ENTRIES + 5 + 2 * scene->contact_count +
                2 * scene->node_count + quantities;
  plan->column_capacity = most;
  plan->columns = strut_arena_allocate(&plan->arena, most, sizeof *plan->columns);
  plan->quantities = strut_arena_allocate(&plan->arena, quantities, sizeof *plan->quantities);
  if (!plan->columns || !plan->quantities || !add_columns(plan, setup))
    return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  return STRUT_OK;
}

strut_status strut_sweep_plan_make(const strut_study *study, const strut_sweep_scenes *scenes,
                                   strut_sweep_plan *plan, strut_error *error) {
  *plan = (strut_sweep_plan){.study = study, .scenes = *scenes};
  plan->points = strut_grid_points(study);
  plan->axis_columns = strut_grid_columns(study);
  if (plan->points < 0)
    return strut_fail(error, STRUT_USAGE, "a study may have at most 1e9 points");
  strut_setup setup;
  strut_study_value *values =
      strut_arena_allocate(&plan->arena, plan->axis_columns + 1, sizeof *values);
  if (!values) return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  strut_grid_values(study, 0, values);
  strut_status status = scenes->setup(scenes->context, values, &setup, error);
  if (status) return status;
  status = choose_columns(plan, &setup, error);
  strut_setup_free(&setup);
  return status;
}

void strut_sweep_plan_free(strut_sweep_plan *plan) {
  strut_arena_free(&plan->arena);
  *plan = (strut_sweep_plan){0};
}

void strut_sweep_number(strut_row_buffer *cells, double value) {
  cells->numbers[cells->number_count++] = value;
}

void strut_sweep_word(strut_row_buffer *cells, const char *word) {
  char *to = cells->words[cells->word_count++];
  memset(to, 0, STRUT_SLOT_WORD);
  for (size_t i = 0; i + 1 < STRUT_SLOT_WORD && word[i]; i++) to[i] = word[i];
}

/* The value of an entry; NAN if the summary has none. */
static double number_of(const strut_summary *s, const strut_setup *setup, size_t index) {
  double period = strut_experiment_span(&setup->experiment, &setup->scene).period;
  bool watched = s->steady.kind != STRUT_MOTION_NOT_WATCHED;
  const double values[ENTRIES] = {s->velocity,
                                  s->velocity_spread,
                                  watched ? s->steady.interval : (double)NAN,
                                  (double)NAN,
                                  watched ? (double)s->steady.repeats : (double)NAN,
                                  watched        ? (double)s->steady.periods
                                  : period > 0.0 ? s->duration / period
                                                 : (double)NAN,
                                  period > 0.0 ? s->velocity * period : (double)NAN,
                                  s->duration,
                                  s->settle_time,
                                  (double)s->steps,
                                  (double)s->force_evaluations,
                                  (double)s->accuracy.check_evaluations,
                                  (double)s->events,
                                  (double)NAN,
                                  s->step,
                                  s->step_limit,
                                  s->accuracy.wanted > 0.0 ? s->accuracy.expected : (double)NAN,
                                  s->accuracy.wanted > 0.0 ? (double)s->accuracy.kept : (double)NAN,
                                  s->energy.kinetic,
                                  s->energy.elastic,
                                  s->energy.gravity,
                                  s->energy.contact,
                                  s->energy.drive_work,
                                  s->energy.load_work,
                                  s->energy.belt_work,
                                  s->energy.dissipated_members,
                                  s->energy.dissipated_contact,
                                  s->energy.dissipated_friction,
                                  s->energy.residual};
  return values[index];
}

static const char *word_of(const strut_summary *s, strut_keep keep) {
  static const char *const kinds[] = {"", "periodic", "irregular", "transient"};
  return keep == STRUT_KEEP_METHOD ? s->method : kinds[s->steady.kind];
}

static void fill_things(const strut_sweep_plan *plan, const strut_scene *scene,
                        const strut_summary *s, strut_row_buffer *cells) {
  for (size_t i = 0; i < scene->contact_count && keeps(plan, STRUT_KEEP_CONTACTS); i++) {
    bool known = s && i < s->contact_count;
    strut_sweep_number(cells, known ? s->contacts[i].duty : (double)NAN);
    strut_sweep_number(cells, known ? s->contacts[i].max_height : (double)NAN);
  }
  for (size_t i = 0; i < 2 * scene->node_count && keeps(plan, STRUT_KEEP_POSITIONS); i++)
    strut_sweep_number(cells, s && i < 2 * s->node_count ? s->positions[i] : (double)NAN);
}

/* A variant may lack a quantity of the first point, which names the columns. */
static double measured_value(const strut_summary *s, const char *name) {
  for (size_t i = 0; i < s->measured_count; i++)
    if (strcmp(s->measured[i].name, name) == 0) return s->measured[i].value;
  return (double)NAN;
}

void strut_sweep_fill(const strut_sweep_plan *plan, const strut_setup *setup,
                      const strut_summary *summary, const char *outcome, strut_row_buffer *cells) {
  for (size_t i = 0; i < ENTRIES; i++) {
    if (!keeps(plan, entries[i].keep)) continue;
    if (entries[i].word)
      strut_sweep_word(cells, summary ? word_of(summary, entries[i].keep) : "");
    else
      strut_sweep_number(cells, summary ? number_of(summary, setup, i) : (double)NAN);
  }
  if (summary) fill_things(plan, &setup->scene, summary, cells);
  for (size_t i = 0; i < plan->quantity_count; i++)
    strut_sweep_number(cells, summary ? measured_value(summary, plan->quantities[i]) : (double)NAN);
  if (keeps(plan, STRUT_KEEP_OUTCOME)) strut_sweep_word(cells, outcome);
  if (plan->start)
    strut_sweep_number(cells, summary ? (double)summary->settle.unstable : (double)NAN);
}
