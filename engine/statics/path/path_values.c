/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a path has, a row for each value. */
#include "engine/statics/path/path.h"

static bool over_load(const strut_path *path) { return path->over == STRUT_PATH_OVER_LOAD; }

static bool is_held(const strut_result_object *of, size_t k) {
  return ((const strut_path *)of->outer->at)->held[k];
}

/* The parameter of the path around: a load's factor and what it is in newtons, or a value. */
#define PARAMETER(X, FACTOR)                                                                       \
  X("factor", "1", IF(over_load(path), NUMBER(FACTOR)), "factor of the loads")                     \
  X("value", "", IF(!over_load(path), NUMBER(FACTOR)), "the parameter, in its SI unit")            \
  X("force", "N", IF(over_load(path) && path->reference > 0, NUMBER((FACTOR)*path->reference)),    \
    "the load, where all are alike")

#define STATE(X)                                                                                   \
  PARAMETER(X, state->factor)                                                                      \
  X("arc", "1", NUMBER(state->arc), "length of the path from its beginning, without a dimension")  \
  X("nodes", "m", OF(NODE, state->q), "positions", .column = {"x [m]", "y [m]"})                   \
  X("forces", "N", OF(MEMBER, state->force), "tensions of members, with their stops",              \
    .column = {"force [N]"}, .label = {""})                                                        \
  X("moments", "N m", IF(of->scene->hinge_count, OF(HINGE, state->moment)), "moments of hinges",   \
    .column = {"moment [N m]"}, .label = {" moment"})                                              \
  X("pressures", "N/m", IF(of->scene->cell_count, OF(CELL, state->pressure)),                      \
    "pressures inside cells", .column = {"pressure [N/m]"}, .label = {" pressure"})                \
  X("distance_forces", "N", IF(of->scene->distance_count, OF(DISTANCE, state->distance)),          \
    "forces of distances", .column = {"force [N]"}, .label = {""})                                 \
  X("reactions", "N", OF_WHERE(NODE, state->reaction, is_held), "forces of supports",              \
    .column = {"reaction_x [N]", "reaction_y [N]"}, .label = {" support x", " support y"})         \
  X("contacts", "N", OF(CONTACT, state->contact), "normal forces of the ground",                   \
    .column = {"ground [N]"}, .label = {" ground"})                                                \
  X("friction", "N", IF(path->friction, OF(CONTACT, state->friction)),                             \
    "friction, along the tangent", .column = {"friction [N]"}, .label = {" friction"})
STRUT_VALUES(strut_path_state_values, STATE, const strut_path_state *state = of->at;
             const strut_path *path = of->outer->at)

#define POINT(X)                                                                                   \
  X("stable", "", FLAG(point->negative == 0), "whether no eigenvalue is below zero beyond it")     \
  X("negative_eigenvalues", "", COUNT(point->negative),                                            \
    "eigenvalues of the stiffness below zero beyond it")                                           \
  X(NULL, "", SAME, "", .rows = &strut_path_state_values)
STRUT_VALUES_HERE(point_values, POINT, const strut_path_point *point = of->at)

#define EVENT(X)                                                                                   \
  X("kind", "", TEXT(strut_path_event_name(event->kind)), "what happens")                          \
  X("detail", "", TEXT(event->detail), "in words")                                                 \
  X("stable_before", "", FLAG(event->before == 0), "whether the path before is stable")            \
  X("stable_after", "", FLAG(event->after == 0), "whether the path behind is stable")              \
  X("negative_before", "", COUNT(event->before), "eigenvalues below zero before")                  \
  X("negative_after", "", COUNT(event->after), "eigenvalues below zero behind")                    \
  X(NULL, "", SAME, "", .rows = &strut_path_state_values)
STRUT_VALUES_HERE(event_values, EVENT, const strut_path_event *event = of->at)

#define WALK(X)                                                                                    \
  X("load", "", TEXT(walk->load), "name of the load; null: all loads without a signal")            \
  X("over", "", TEXT(over_load(walk) ? NULL : walk->name), "the parameter; null: a load's factor") \
  X("unit", "", TEXT(walk->unit), "SI unit of the parameter")                                      \
  X("end", "", TEXT(strut_path_end_word(walk->end)), "why it ended")                               \
  X("remark", "", TEXT(walk->remark[0] ? walk->remark : NULL), "more about its end")               \
  X("points", "", LIST(walk->points, walk->point_count), "in their order", .rows = &point_values)  \
  X("events", "", LIST(walk->events, walk->event_count), "in their order", .rows = &event_values)
STRUT_VALUES_HERE(walk_values, WALK, const strut_path *walk = of->at)

#define BRANCH(X)                                                                                  \
  X("from_branch", "", COUNT(branch->from.path), "the branch that it leaves, 0: the path itself")  \
  PARAMETER(X, branch->from.factor)                                                                \
  X("arc", "1", NUMBER(branch->from.arc), "where it leaves")                                       \
  X("twin", "", COUNT(branch->from.twin), "branch to the other side, if it does the same; or 0")   \
  X(NULL, "", SAME, "", .rows = &walk_values)
STRUT_VALUES_HERE(branch_values, BRANCH, const strut_path *branch = of->at;
                  const strut_path *path = of->outer->at)

#define PATH(X)                                                                                    \
  X(NULL, "", SAME, "", .rows = &walk_values)                                                      \
  X("branches", "", IF(path->branches, LIST(path->branches, path->branch_count)),                  \
    "paths that leave at bifurcations", .rows = &branch_values)                                    \
  X("earlier_stages", "", IF(path->stages, LIST(path->stages, path->stage_count)),                 \
    "of a path in stages, those before this one", .rows = &walk_values)
STRUT_VALUES(strut_path_values, PATH, const strut_path *path = of->at)
