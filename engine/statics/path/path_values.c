/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a path has, a row for each value. */
#include <math.h>

#include "engine/statics/path/path.h"

static bool over_load(const strut_path *path) { return path->over == STRUT_PATH_OVER_LOAD; }

static bool is_held(const strut_result_object *of, size_t k) {
  return ((const strut_path *)of->outer->at)->held[k];
}

/* The parameter of the path around: a load's factor and what it is in newtons, or a value. */
#define PARAMETER(X, FACTOR)                                                                       \
  X("factor", "1", IF(over_load(path), NUMBER(FACTOR)), "factor of the loads")                     \
  X("value", "", IF(!over_load(path), NUMBER(FACTOR)),                                             \
    "the parameter, in its SI unit; of NODE.x and NODE.y the displacement")                        \
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
  X("over", "", TEXT(over_load(walk) ? NULL : walk->name),                                         \
    "the parameter, or the node displaced; null: a load's factor")                                 \
  X("unit", "", TEXT(walk->unit), "SI unit of the parameter")                                      \
  X("end", "", TEXT(strut_path_end_word(walk->end)), "why it ended")                               \
  X("remark", "", TEXT(walk->remark[0] ? walk->remark : NULL),                                     \
    "more about its end, and long parts on which nothing happens")                                 \
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

/* ---- what people read ---- */

enum { MOST_POINTS = 20 };

/* The force that goes with the parameter: of a displaced coordinate its reaction. */
static double force_of(const strut_result_object *of, const strut_path_state *state) {
  const strut_path *path = of->outer->at;
  if (path->coordinate >= 0) return state->reaction[path->coordinate];
  return over_load(path) && path->reference > 0 ? state->factor * path->reference : (double)NAN;
}

/* The node that is farthest from where the path began at some point of it; a free one if there is. */
static size_t farthest_node(const strut_path *path, const strut_scene *scene) {
  const double *from = path->points[0].at.q;
  double most = -1;
  size_t best = 0;
  for (int pass = 0; pass < 2 && most < 0; pass++)
    for (size_t k = 0; k < path->point_count; k++)
      for (size_t i = 0; i < scene->node_count; i++) {
        const double *q = path->points[k].at.q;
        if (pass == 0 && scene->nodes[i].fixed[0] && scene->nodes[i].fixed[1]) continue;
        double away = hypot(q[2 * i] - from[2 * i], q[2 * i + 1] - from[2 * i + 1]);
        if (away > most * (1 + 1e-9)) most = away, best = i;
      }
  return best;
}

static double move_of(const strut_result_object *of, const strut_path_state *state, size_t axis) {
  const strut_path *path = of->outer->at;
  size_t at = 2 * farthest_node(path, of->scene) + axis;
  return state->q[at] - path->points[0].at.q[at];
}

static const char *stability_of(const strut_path *path) {
  size_t stable = 0;
  for (size_t k = 0; k < path->point_count; k++) stable += path->points[k].negative == 0;
  return stable == path->point_count ? "stable" : stable ? "stable in part" : "unstable";
}

static const char *parameter_of(const strut_path *path) {
  return over_load(path) ? "factor" : path->coordinate >= 0 ? "displacement" : path->name;
}

#define FACTOR(X, STATE)                                                                           \
  X(NULL, "", ROUNDED(8, CALLED(parameter_of(path), path->unit, (STATE)->factor)), "",             \
    .label = {""})
#define SHOWN(X, STATE)                                                                            \
  FACTOR(X, STATE)                                                                                 \
  X(NULL, "N", ROUNDED(8, NUMBER(force_of(of, STATE))), "", .label = {"force"})                    \
  X(NULL, "m", ROUNDED(6, NUMBER(move_of(of, STATE, 0))), "", .label = {"moves x"})                \
  X(NULL, "m", ROUNDED(6, NUMBER(move_of(of, STATE, 1))), "", .label = {"moves y"})
#define SHOWN_POINT(X)                                                                             \
  SHOWN(X, &point->at)                                                                             \
  X(NULL, "", TEXT(point->negative ? "unstable" : "stable"), "", .label = {"is"})
STRUT_VALUES_HERE(shown_point_values, SHOWN_POINT, const strut_path_point *point = of->at;
                  const strut_path *path = of->outer->at)
#define SHOWN_EVENT(X)                                                                             \
  SHOWN(X, &event->at)                                                                             \
  X(NULL, "", TEXT(strut_path_event_name(event->kind)), "", .label = {"event"})                    \
  X(NULL, "", TEXT(event->detail), "", .label = {"detail"})
STRUT_VALUES_HERE(shown_event_values, SHOWN_EVENT, const strut_path_event *event = of->at;
                  const strut_path *path = of->outer->at)

/* Forces where something happens. */
#define END_FORCES(X)                                                                              \
  X(NULL, "", TEXT(point == path->points ? "start" : "end"), "", .label = {"at"})                  \
  FACTOR(X, &point->at)                                                                            \
  X(NULL, "", SAME, "", .rows = &strut_path_state_values)
STRUT_VALUES_HERE(end_force_values, END_FORCES, const strut_path_point *point = of->at;
                  const strut_path *path = of->outer->at)
#define EVENT_FORCES(X)                                                                            \
  X(NULL, "", TEXT(strut_path_event_name(event->kind)), "", .label = {"at"})                       \
  FACTOR(X, &event->at)                                                                            \
  X(NULL, "", SAME, "", .rows = &strut_path_state_values)
STRUT_VALUES_HERE(event_force_values, EVENT_FORCES, const strut_path_event *event = of->at;
                  const strut_path *path = of->outer->at)

/* Of a branch or a stage. */
#define SUMMARY(X)                                                                                 \
  X(NULL, "", COUNT(of->index + 1), "", .label = {"number"})                                       \
  X(NULL, "", IF(branch, COUNT(walk->from.path)), "", .label = {"leaves branch"})                  \
  X(NULL, "", TEXT(over_load(walk) ? "loads" : walk->name), "", .label = {"over"})                 \
  X(NULL, "", CALLED(NULL, walk->unit, branch ? walk->from.factor : walk->points[0].at.factor),    \
    "", .label = {"from"})                                                                         \
  X(NULL, "", CALLED(NULL, walk->unit, walk->points[walk->point_count - 1].at.factor), "",         \
    .label = {"to"})                                                                               \
  X(NULL, "", COUNT(walk->point_count), "", .label = {"points"})                                   \
  X(NULL, "", COUNT(walk->event_count), "", .label = {"events"})                                   \
  X(NULL, "", TEXT(stability_of(walk)), "", .label = {"is"})                                       \
  X(NULL, "", IF(branch && walk->from.twin, COUNT(walk->from.twin)), "",                           \
    .label = {"twin of branch"})                                                                   \
  X(NULL, "", TEXT(walk->remark), "", .label = {"remark"})
STRUT_VALUES_HERE(summary_values, SUMMARY, const strut_path *walk = of->at;
                  const strut_path *path = of->outer->at;
                  bool branch = path->branches && walk >= path->branches &&
                                walk < path->branches + path->branch_count)

static bool is_sampled(const strut_result_object *of, size_t k) {
  const strut_path *path = of->at;
  return k % ((path->point_count + MOST_POINTS - 1) / MOST_POINTS) == 0 ||
         k + 1 == path->point_count;
}

static bool is_end(const strut_result_object *of, size_t k) {
  return k == 0 || k + 1 == ((const strut_path *)of->at)->point_count;
}

#define PATH(X)                                                                                    \
  X(NULL, "", TEXT(path->name), "", .label = {"path over"})                                        \
  X(NULL, "", COUNT(path->point_count), "", .label = {"points"})                                   \
  X(NULL, "", TEXT(path->remark), "", .label = {"remark"})                                         \
  X(NULL, "", TEXT(of->scene->nodes[farthest_node(path, of->scene)].name), "",                     \
    .label = {"moves most"})                                                                       \
  X(NULL, "", LIST_WHERE(path->points, path->point_count, is_sampled), "",                         \
    .rows = &shown_point_values, .label = {"points"})                                              \
  X(NULL, "", LIST(path->events, path->event_count), "", .rows = &shown_event_values,              \
    .label = {"events"})                                                                           \
  X(NULL, "", LIST_WHERE(path->points, path->point_count, is_end), "", .rows = &end_force_values,  \
    .label = {"forces"})                                                                           \
  X(NULL, "", LIST(path->events, path->event_count), "", .rows = &event_force_values,              \
    .label = {"forces at events"})                                                                 \
  X(NULL, "", IF(path->branches, LIST(path->branches, path->branch_count)), "",                    \
    .rows = &summary_values, .label = {"branches"})                                                \
  X(NULL, "", IF(path->stages, LIST(path->stages, path->stage_count)), "",                         \
    .rows = &summary_values, .label = {"stages before"})                                           \
  X(NULL, "", SAME, "", .rows = &walk_values)                                                      \
  X("branches", "", IF(path->branches, LIST(path->branches, path->branch_count)),                  \
    "paths that leave at bifurcations", .rows = &branch_values)                                    \
  X("earlier_stages", "", IF(path->stages, LIST(path->stages, path->stage_count)),                 \
    "of a path in stages, those before this one", .rows = &walk_values)
STRUT_VALUES(strut_path_values, PATH, const strut_path *path = of->at)
