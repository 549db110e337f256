/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The columns of a study's table, and their cells from the summary of a run. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/run/measure/quantities.h"
#include "engine/study/sweep/sweep_parts.h"

static const strut_keep USUAL[] = {STRUT_KEEP_VELOCITY,  STRUT_KEEP_SPREAD,      STRUT_KEEP_MOTION,
                                   STRUT_KEEP_PERIODS,   STRUT_KEEP_EVALUATIONS, STRUT_KEEP_OUTCOME,
                                   STRUT_KEEP_QUANTITIES};

void strut_sweep_begin_smooth(strut_sweep_plan *plan, strut_keep keep) {
  plan->smooth = strut_kept_word_at(keep)->of & STRUT_KEEP_SMOOTH;
}

static bool keeps(const strut_sweep_plan *plan, strut_keep keep) {
  return strut_keep_has(&plan->keep, keep);
}

/* Does one of the first `count` columns have this name? An axis may share the name of a column. */
static bool is_taken(const strut_sweep_plan *plan, size_t count, const char *name) {
  bool found = false;
  for (size_t i = 0; i < count && !found; i++) found = strcmp(plan->columns[i].name, name) == 0;
  return found;
}

/* Room for one more column. */
static bool make_room(strut_sweep_plan *plan) {
  const size_t count = plan->column_count, more = 2 * count + 32;
  if (count < plan->column_capacity) return true;
  const strut_slot_column *columns = plan->columns;
  const strut_derived_column *derived = plan->derived;
  if (!STRUT_ALLOCATE(&plan->arena, STRUT_NEW(plan->columns, more), STRUT_NEW(plan->derived, more)))
    return false;
  if (count) memcpy(plan->columns, columns, count * sizeof *columns);
  if (count) memcpy(plan->derived, derived, count * sizeof *derived);
  plan->column_capacity = more;
  return true;
}

bool strut_sweep_add_column(strut_sweep_plan *plan, const char *prefix, const char *name,
                            const char *unit, bool word) {
  const char *text = strut_arena_format(&plan->arena, "%s%s", prefix, name);
  while (text && plan->column_count >= plan->axis_columns &&
         is_taken(plan, plan->axis_columns, text))
    text = strut_arena_format(&plan->arena, "run_%s", text);
  if (!make_room(plan)) return false;
  bool kept = plan->column_count >= plan->axis_columns && !plan->by && text && !word;
  if (kept && (plan->smooth || strut_sweep_is_analysed(plan->study, text)))
    plan->derived[plan->derived_count++] =
        (strut_derived_column){plan->column_count, !plan->smooth};
  plan->columns[plan->column_count++] = (strut_slot_column){text, unit, word};
  return text != NULL;
}

/* Copies the names of a scene that outlive it, if they are wanted. */
static bool copy_names(strut_sweep_plan *plan, const strut_scene *scene, bool wanted,
                       strut_channel_owner owner, size_t *count, const char ***to) {
  *count = wanted ? strut_owner_count(owner, scene) : 0;
  *to = strut_arena_allocate(&plan->arena, *count, sizeof **to);
  for (size_t i = 0; i < *count && *to; i++) {
    const char *name = strut_owner_name(owner, scene, i);
    (*to)[i] = strut_arena_text(&plan->arena, name, strlen(name));
    if (!(*to)[i]) return false;
  }
  return *to != NULL;
}

static bool keep_names(strut_sweep_plan *plan, const strut_scene *scene) {
  return copy_names(plan, scene, keeps(plan, STRUT_KEEP_CONTACTS), STRUT_OWNER_CONTACT,
                    &plan->contact_count, &plan->contacts) &&
         copy_names(plan, scene, keeps(plan, STRUT_KEEP_POSITIONS), STRUT_OWNER_NODE,
                    &plan->node_count, &plan->nodes) &&
         copy_names(plan, scene, keeps(plan, STRUT_KEEP_LENGTHS), STRUT_OWNER_MEMBER,
                    &plan->member_count, &plan->members);
}

static bool add_things(strut_sweep_plan *plan) {
  bool fine = true;
  strut_sweep_begin_smooth(plan, STRUT_KEEP_CONTACTS);
  for (size_t i = 0; i < plan->contact_count; i++)
    fine = fine && strut_sweep_add_column(plan, "duty_", plan->contacts[i], "1", false) &&
           strut_sweep_add_column(plan, "height_", plan->contacts[i], "m", false);
  strut_sweep_begin_smooth(plan, STRUT_KEEP_POSITIONS);
  for (size_t i = 0; i < plan->node_count; i++)
    fine = fine && strut_sweep_add_column(plan, "x_", plan->nodes[i], "m", false) &&
           strut_sweep_add_column(plan, "y_", plan->nodes[i], "m", false);
  for (size_t i = 0; i < plan->member_count; i++)
    fine = fine && strut_sweep_add_column(plan, "length_", plan->members[i], "m", false);
  return fine;
}

static bool is_kept(const strut_study *study, const char *quantity) {
  for (size_t i = 0; i < study->quantity_count; i++)
    if (strcmp(study->quantities[i], quantity) == 0) return true;
  return false;
}

/* Adds the measured quantities that are kept; one with the name of a column gets a prefix. */
static bool add_quantities(strut_sweep_plan *plan, const strut_experiment *experiment) {
  strut_sweep_begin_smooth(plan, STRUT_KEEP_QUANTITIES);
  for (size_t i = 0; i < experiment->quantity_count; i++) {
    const strut_quantity_definition *definition = &experiment->quantities[i];
    if (!keeps(plan, STRUT_KEEP_QUANTITIES) && !is_kept(plan->study, definition->name)) continue;
    const char *name = strut_arena_text(&plan->arena, definition->name, strlen(definition->name));
    const char *unit = strut_arena_text(&plan->arena, definition->unit, strlen(definition->unit));
    if (!name || !unit) return false;
    plan->names_member[plan->quantity_count] = strut_quantity_names_member(definition);
    plan->quantities[plan->quantity_count++] = name;
    bool taken =
        is_taken(plan, plan->column_count, name) && !is_taken(plan, plan->axis_columns, name);
    if (!strut_sweep_add_column(plan, taken ? "measured_" : "", name, unit, false)) return false;
    const char *member = strut_arena_format(&plan->arena, "%s_member", name);
    if (!member || (strut_quantity_names_member(definition) &&
                    !strut_sweep_add_column(plan, "", member, "1", true)))
      return false;
  }
  return true;
}

/* What is kept of a point. */
static bool add_kept(strut_sweep_plan *plan, const strut_setup *setup) {
  bool fine = keep_names(plan, &setup->scene), run = plan->study->compute == STRUT_COMPUTE_RUN;
  for (size_t i = 0; i < plan->axis_columns && fine; i++) {
    const strut_study_column *column = strut_grid_column(plan->study, i, NULL);
    fine = strut_sweep_add_column(plan, "", column->name, column->unit, column->word);
  }
  fine = fine && strut_kept_columns(plan, setup) && add_things(plan);
  if (!fine || !run) return fine;
  fine = add_quantities(plan, &setup->experiment);
  if (fine && keeps(plan, STRUT_KEEP_OUTCOME))
    fine = strut_sweep_add_column(plan, "", "outcome", "1", true);
  if (fine && keeps(plan, STRUT_KEEP_SHAPE))
    fine = strut_sweep_add_column(plan, "", "shape_distance", "m", false);
  plan->smooth = false;
  if (fine && plan->start) fine = strut_sweep_add_column(plan, "", "start_unstable", "1", false);
  if (fine && plan->accurate)
    fine = strut_sweep_add_column(plan, "", STRUT_KEPT_COLUMN, "1", false);
  return fine;
}

/* What the second run of a point adds. */
static bool add_check(strut_sweep_plan *plan) {
  bool fine = true;
  if (plan->check)
    fine = strut_sweep_add_column(plan, "check_", "velocity", "m/s", false) &&
           strut_sweep_add_column(plan, "check_", plan->flips ? "outcome" : "motion", "1", true) &&
           strut_sweep_add_column(plan, "", "flips", "1", false);
  return fine;
}

/* What a run keeps, always whether a requested accuracy was reached, and whether it is repeated. */
static void choose_of_run(strut_sweep_plan *plan, const strut_setup *setup, bool usual) {
  const strut_study *study = plan->study;
  bool shapes = setup->scene.configuration_count > 0;
  plan->keep = study->keep;
  for (size_t i = 0; i < sizeof USUAL / sizeof USUAL[0] && usual; i++)
    if (shapes || USUAL[i] != STRUT_KEEP_OUTCOME) strut_keep_add(&plan->keep, USUAL[i]);
  plan->accurate = setup->experiment.accuracy > 0.0 && !keeps(plan, STRUT_KEEP_KEPT);
  plan->start = usual && setup->experiment.settle.wanted;
  plan->check = !study->search && (study->half_step || study->check_accuracy > 0.0);
  if (plan->check && shapes) strut_keep_add(&plan->keep, STRUT_KEEP_OUTCOME);
  if (plan->check && !shapes) strut_keep_add(&plan->keep, STRUT_KEEP_MOTION);
  plan->flips = plan->check && shapes;
}

static strut_status choose_columns(strut_sweep_plan *plan, const strut_setup *setup,
                                   const strut_study_value *values, strut_error *error) {
  const strut_scene *scene = &setup->scene;
  const strut_study *study = plan->study;
  bool usual = strut_keep_is_empty(&study->keep) && !study->quantity_count && !study->follow;
  strut_status status = strut_goals_check(study, scene, &plan->fault, error);
  if (study->compute == STRUT_COMPUTE_RUN) {
    choose_of_run(plan, setup, usual);
  } else {
    plan->keep = usual ? strut_statics_usual((strut_compute)study->compute) : study->keep;
    if (!status) status = strut_statics_check(study, setup, error);
  }
  if (status) return status;
  size_t quantities = setup->experiment.quantity_count;
  if (!STRUT_ALLOCATE(&plan->arena, STRUT_NEW(plan->quantities, quantities),
                      STRUT_NEW(plan->names_member, quantities)) ||
      !add_kept(plan, setup))
    return strut_no_memory(error, "");
  plan->smooth = false;
  status = strut_sweep_derivative_columns(plan, setup, values, error);
  return status || add_check(plan) ? status : strut_no_memory(error, "");
}

strut_status strut_sweep_plan_make(const strut_study *study, const strut_sweep_scenes *scenes,
                                   strut_sweep_plan *plan, strut_error *error) {
  strut_setup setup;
  *plan = (strut_sweep_plan){.study = study, .scenes = *scenes};
  if (strut_grid_points(study) < 0)
    return strut_fail(error, STRUT_USAGE, "a study may have at most 1e9 points");
  strut_study_value *values =
      strut_arena_allocate(&plan->arena, strut_grid_columns(study) + 1, sizeof *values);
  if (!values) return strut_no_memory(error, "");
  strut_grid_values(study, 0, values);
  strut_status status = scenes->setup(scenes->context, values, &setup, error);
  if (status) return status;
  plan->points = strut_grid_points(study);
  plan->axis_columns = strut_grid_columns(study);
  status = choose_columns(plan, &setup, values, error);
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

void strut_sweep_axes(const strut_sweep_plan *plan, const strut_study_value *values,
                      strut_row_buffer *cells) {
  for (size_t i = 0; i < plan->axis_columns; i++) {
    if (plan->columns[i].word)
      strut_sweep_word(cells, values[i].word);
    else
      strut_sweep_number(cells, values[i].number);
  }
}

void strut_sweep_end_row(strut_row_buffer *cells, strut_status status, const strut_error *error) {
  if (error)
    snprintf(cells->message, sizeof cells->message, "%.*s", (int)sizeof cells->message - 1,
             error->message);
  cells->row = (strut_result_slot){.status = status,
                                   .numbers = cells->numbers,
                                   .words = (const char(*)[STRUT_SLOT_WORD])cells->words,
                                   .message = cells->message};
}

bool strut_sweep_stops(strut_status status) {
  return status == STRUT_NO_MEMORY || status == STRUT_FILE_TROUBLE || status == STRUT_INTERRUPTED;
}

int64_t strut_sweep_named(const char *name, size_t i, const strut_scene *scene,
                          strut_channel_owner owner) {
  size_t count = strut_owner_count(owner, scene);
  if (i < count && strcmp(strut_owner_name(owner, scene, i), name) == 0) return (int64_t)i;
  for (size_t k = 0; k < count; k++)
    if (strcmp(strut_owner_name(owner, scene, k), name) == 0) return (int64_t)k;
  return -1;
}

void strut_sweep_fill_positions(const strut_sweep_plan *plan, const strut_scene *scene,
                                const double *positions, strut_row_buffer *cells) {
  for (size_t i = 0; i < plan->node_count; i++) {
    int64_t at = strut_sweep_named(plan->nodes[i], i, scene, STRUT_OWNER_NODE);
    for (int c = 0; c < 2; c++)
      strut_sweep_number(cells, positions && at >= 0 ? positions[2 * at + c] : (double)NAN);
  }
}

static void fill_contacts(const strut_sweep_plan *plan, const strut_scene *scene,
                          const strut_summary *summary, strut_row_buffer *cells) {
  for (size_t i = 0; i < plan->contact_count; i++) {
    int64_t at = strut_sweep_named(plan->contacts[i], i, scene, STRUT_OWNER_CONTACT);
    if (at >= (int64_t)summary->end.contact_count) at = -1;
    strut_sweep_number(cells, at >= 0 ? summary->end.contacts[at].duty : (double)NAN);
    strut_sweep_number(cells, at >= 0 ? summary->end.contacts[at].max_height : (double)NAN);
  }
}

/* A variant may lack a quantity of the first point, which names the columns: NULL. */
static const strut_measured *find_measured(const strut_summary *summary, const char *name) {
  for (size_t i = 0; summary && i < summary->measured_count; i++)
    if (strcmp(summary->measured[i].name, name) == 0) return &summary->measured[i];
  return NULL;
}

static void fill_measured(const strut_sweep_plan *plan, const strut_summary *summary,
                          strut_row_buffer *cells) {
  for (size_t i = 0; i < plan->quantity_count; i++) {
    const strut_measured *measured = find_measured(summary, plan->quantities[i]);
    strut_sweep_number(cells, measured ? measured->value : (double)NAN);
    if (plan->names_member[i])
      strut_sweep_word(cells, measured && measured->member ? measured->member : "");
  }
}

void strut_sweep_fill(const strut_sweep_plan *plan, const strut_setup *setup,
                      const strut_summary *summary, const char *outcome, strut_row_buffer *cells) {
  strut_kept_fill_run(plan, setup, summary, cells);
  if (summary) {
    bool known = summary->end.node_count == setup->scene.node_count;
    fill_contacts(plan, &setup->scene, summary, cells);
    strut_sweep_fill_positions(plan, &setup->scene, known ? summary->end.positions : NULL, cells);
  }
  fill_measured(plan, summary, cells);
  if (keeps(plan, STRUT_KEEP_OUTCOME)) strut_sweep_word(cells, outcome);
  if (keeps(plan, STRUT_KEEP_SHAPE))
    strut_sweep_number(cells, summary ? strut_goals_shape_distance(plan->study, &setup->scene,
                                                                   summary->end.positions)
                                      : (double)NAN);
  if (plan->start)
    strut_sweep_number(cells, summary ? (double)summary->settle.unstable : (double)NAN);
  if (plan->accurate)
    strut_sweep_number(cells, summary && summary->accuracy.wanted > 0.0
                                  ? (double)summary->accuracy.kept
                                  : (double)NAN);
}
