/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a path has, a row for each value. */
#include "engine/statics/path/path.h"

static const strut_path *path_of(const strut_result_object *of) { return of->outer->at; }

/* The parameter: a load's factor and what it is in newtons, or a value. */
static bool is_over_load(const strut_path *path) { return path->over == STRUT_PATH_OVER_LOAD; }
static bool of_load(const strut_result_object *of) { return is_over_load(path_of(of)); }
static bool of_value(const strut_result_object *of) { return !of_load(of); }
static bool of_force(const strut_result_object *of) {
  return of_load(of) && path_of(of)->reference > 0;
}
static strut_value force_of(const strut_result_object *of) {
  const strut_path_state *state = of->at;
  return strut_value_number(state->factor * path_of(of)->reference);
}

/* Only coordinates that are held have a reaction. */
static bool is_held(const strut_result_object *of, size_t k) { return path_of(of)->held[k]; }
static bool with_friction(const strut_result_object *of) { return path_of(of)->friction; }

#define STATE(MEMBER, KEY, UNIT, WHAT) STRUT_VALUE(strut_path_state, MEMBER, KEY, UNIT, WHAT)
#define STATE_OF(MEMBER, AXIS, KEY, UNIT, WHAT)                                                    \
  STRUT_VALUE_OF(strut_path_state, MEMBER, AXIS, KEY, UNIT, WHAT)

static const strut_value_row state_rows[] = {
    {STATE(factor, "factor", "1", "factor of the loads"), .there = of_load},
    {STATE(factor, "value", "", "the parameter, in its SI unit"), .there = of_value},
    {STRUT_VALUE_GET(force_of, "force", "N", "the load, where all are alike"), .there = of_force},
    {STATE(arc, "arc", "1", "length of the path from its beginning, without a dimension")},
    {STATE_OF(q, STRUT_OWNER_NODE, "nodes", "m", "positions"), .column = {"x [m]", "y [m]"}},
    {STATE_OF(force, STRUT_OWNER_MEMBER, "forces", "N", "tensions of members, with their stops"),
     .column = {"force [N]"}, .label = {""}},
    {STATE_OF(moment, STRUT_OWNER_HINGE, "moments", "N m", "moments of hinges"),
     .column = {"moment [N m]"}, .label = {" moment"}},
    {STATE_OF(pressure, STRUT_OWNER_CELL, "pressures", "N/m", "pressures inside cells"),
     .column = {"pressure [N/m]"}, .label = {" pressure"}},
    {STATE_OF(distance, STRUT_OWNER_DISTANCE, "distance_forces", "N", "forces of distances"),
     .column = {"force [N]"}, .label = {""}},
    {STATE_OF(reaction, STRUT_OWNER_NODE, "reactions", "N", "forces of supports"), .has = is_held,
     .column = {"reaction_x [N]", "reaction_y [N]"}, .label = {" support x", " support y"}},
    {STATE_OF(contact, STRUT_OWNER_CONTACT, "contacts", "N", "normal forces of the ground"),
     .column = {"ground [N]"}, .label = {" ground"}},
    {STATE_OF(friction, STRUT_OWNER_CONTACT, "friction", "N", "friction, along the tangent"),
     .there = with_friction, .column = {"friction [N]"}, .label = {" friction"}}};
const strut_value_rows strut_path_state_values = STRUT_VALUE_ROWS(state_rows);

static strut_value is_stable(const strut_result_object *of) {
  return strut_value_flag(((const strut_path_point *)of->at)->negative == 0);
}
static strut_value kind_of(const strut_result_object *of) {
  return strut_value_text(strut_path_event_name(((const strut_path_event *)of->at)->kind));
}
static strut_value before_is_stable(const strut_result_object *of) {
  return strut_value_flag(((const strut_path_event *)of->at)->before == 0);
}
static strut_value after_is_stable(const strut_result_object *of) {
  return strut_value_flag(((const strut_path_event *)of->at)->after == 0);
}

#define EVENT(MEMBER, KEY, UNIT, WHAT) STRUT_VALUE(strut_path_event, MEMBER, KEY, UNIT, WHAT)

static const strut_value_row point_rows[] = {
    {STRUT_VALUE_GET(is_stable, "stable", "", "whether no eigenvalue is below zero beyond it")},
    {STRUT_VALUE(strut_path_point, negative, "negative_eigenvalues", "",
                 "eigenvalues of the stiffness below zero beyond it")},
    {STRUT_VALUE_SAME(state_rows)}};
static const strut_value_row event_rows[] = {
    {STRUT_VALUE_GET(kind_of, "kind", "", "what happens")},
    {EVENT(detail, "detail", "", "in words")},
    {STRUT_VALUE_GET(before_is_stable, "stable_before", "", "whether the path before is stable")},
    {STRUT_VALUE_GET(after_is_stable, "stable_after", "", "whether the path behind is stable")},
    {EVENT(before, "negative_before", "", "eigenvalues below zero before")},
    {EVENT(after, "negative_after", "", "eigenvalues below zero behind")},
    {STRUT_VALUE_SAME(state_rows)}};
static const strut_value_rows point_values = STRUT_VALUE_ROWS(point_rows);
static const strut_value_rows event_values = STRUT_VALUE_ROWS(event_rows);

static strut_value end_of(const strut_result_object *of) {
  return strut_value_text(strut_path_end_word(((const strut_path *)of->at)->end));
}
static strut_value over_of(const strut_result_object *of) {
  const strut_path *path = of->at;
  return strut_value_text(is_over_load(path) ? NULL : path->name);
}

#define PATH(MEMBER, KEY, UNIT, WHAT) STRUT_VALUE(strut_path, MEMBER, KEY, UNIT, WHAT)

static const strut_value_row walk_rows[] = {
    {PATH(load, "load", "", "name of the load; null: all loads without a signal")},
    {STRUT_VALUE_GET(over_of, "over", "", "the parameter; null: a load's factor")},
    {PATH(unit, "unit", "", "SI unit of the parameter")},
    {STRUT_VALUE_GET(end_of, "end", "", "why it ended")},
    {PATH(remark, "remark", "", "more about its end")},
    {STRUT_VALUE_STRUCTS(strut_path, points, point_count, &point_values, "points",
                         "in their order")},
    {STRUT_VALUE_STRUCTS(strut_path, events, event_count, &event_values, "events",
                         "in their order")}};
static const strut_value_rows walk_values = STRUT_VALUE_ROWS(walk_rows);

static strut_value force_at_branch(const strut_result_object *of) {
  const strut_path *branch = of->at;
  return strut_value_number(branch->from.factor * path_of(of)->reference);
}

static const strut_value_row branch_rows[] = {
    {PATH(from.path, "from_branch", "", "number of the branch that it leaves, 0: the path itself")},
    {PATH(from.factor, "factor", "1", "where it leaves"), .there = of_load},
    {PATH(from.factor, "value", "", "where it leaves"), .there = of_value},
    {STRUT_VALUE_GET(force_at_branch, "force", "N", "where it leaves"), .there = of_force},
    {PATH(from.arc, "arc", "1", "where it leaves")},
    {PATH(from.twin, "twin", "", "the branch to the other side, if it does the same there; or 0")},
    {STRUT_VALUE_SAME(walk_rows)}};
static const strut_value_rows branch_values = STRUT_VALUE_ROWS(branch_rows);

static bool with_branches(const strut_result_object *of) {
  return ((const strut_path *)of->at)->branches;
}
static bool with_stages(const strut_result_object *of) {
  return ((const strut_path *)of->at)->stages;
}

static const strut_value_row path_rows[] = {
    {STRUT_VALUE_SAME(walk_rows)},
    {STRUT_VALUE_STRUCTS(strut_path, branches, branch_count, &branch_values, "branches",
                         "paths that leave at bifurcations"),
     .there = with_branches},
    {STRUT_VALUE_STRUCTS(strut_path, stages, stage_count, &walk_values, "earlier_stages",
                         "of a path in stages, those before this one"),
     .there = with_stages}};
const strut_value_rows strut_path_values = STRUT_VALUE_ROWS(path_rows);
