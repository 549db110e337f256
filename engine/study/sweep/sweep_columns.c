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

/*
 * The columns of each word of `keep`, in order: word, name, unit, whether its cells are words, and the
 * value in a summary s, where `watched` says whether steady motion was looked for.
 */
#define ENTRY_TABLE(X)                                                                             \
  X(VELOCITY, "velocity", "m/s", false, s->velocity)                                               \
  X(SPREAD, "velocity_spread", "m/s", false, s->velocity_spread)                                   \
  X(INTERVAL, "velocity_interval", "m/s", false, watched ? s->steady.interval : (double)NAN)       \
  X(MOTION, "motion", "1", true, (double)NAN)                                                      \
  X(REPEATS, "repeats", "1", false, watched ? (double)s->steady.repeats : (double)NAN)             \
  X(PERIODS, "periods", "1", false,                                                                \
    watched        ? (double)s->steady.periods                                                     \
    : period > 0.0 ? s->duration / period                                                          \
                   : (double)NAN)                                                                  \
  X(DISTANCE, "distance", "m", false, period > 0.0 ? s->velocity * period : (double)NAN)           \
  X(DURATION, "duration", "s", false, s->duration)                                                 \
  X(SETTLE_TIME, "settle_time", "s", false, s->settle_time)                                        \
  X(STEPS, "steps", "1", false, (double)s->steps)                                                  \
  X(EVALUATIONS, "force_evaluations", "1", false, (double)s->force_evaluations)                    \
  X(CHECKS, "check_evaluations", "1", false, (double)s->accuracy.check_evaluations)                \
  X(EVENTS, "events", "1", false, (double)s->events)                                               \
  X(METHOD, "method", "1", true, (double)NAN)                                                      \
  X(STEP, "step", "s", false, s->step)                                                             \
  X(STEP_LIMIT, "step_limit", "s", false, s->step_limit)                                           \
  X(EXPECTED, "expected_error", "1", false,                                                        \
    s->accuracy.wanted > 0.0 ? s->accuracy.expected : (double)NAN)                                 \
  X(KEPT, "accuracy_kept", "1", false,                                                             \
    s->accuracy.wanted > 0.0 ? (double)s->accuracy.kept : (double)NAN)                             \
  STRUT_ENERGY_TABLE(ENERGY_##X)                                                                   \
  X(RESIDUAL, "residual", "J", false, s->energy.residual)

typedef struct entry {
  strut_keep keep;
  const char *name, *unit;
  bool word;
} entry;

static const entry entries[] = {
#define ENTRY(keep, name, unit, word, value) {STRUT_KEEP_##keep, name, unit, word},
#define ENERGY_ENTRY(name, kind, label) ENTRY(kind, #name, "J", false, )
    ENTRY_TABLE(ENTRY)};
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
    const char *node = strut_contact_name(scene, i);
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
    return strut_no_memory(error, "");
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
  if (!values) return strut_no_memory(error, "");
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
  const double values[] = {
#define VALUE(keep, name, unit, word, value) value,
#define ENERGY_VALUE(name, kind, label) s->energy.name,
      ENTRY_TABLE(VALUE)};
  return values[index];
}

static const char *word_of(const strut_summary *s, strut_keep keep) {
  return keep == STRUT_KEEP_METHOD ? s->method : strut_motion_name(s->steady.kind);
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
