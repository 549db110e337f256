/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is known of a shape's rigidity: in words, and a row for each value. */
#include <math.h>
#include <stdio.h>

#include "engine/base/text.h"
#include "engine/statics/rigidity/rigidity.h"

enum { FEW_DIGITS = 4 };

static const char *stress_source_words(strut_stress_source source) {
  static const char *const words[] = {
      "no self-stress state", "the self-stress state", "the member forces",
      "a combination of states that tensions all cables", "the first self-stress state"};
  return words[source];
}

static void write_test(const strut_result_object *of, char words[STRUT_VALUE_ROOM]) {
  const strut_mechanisms *all = &((const strut_rigidity *)strut_result_whole(of))->mechanisms;
  const strut_mechanism *motion = of->at;
  bool followed = isfinite(motion->moved) && motion->kind == STRUT_MOTION_FINITE;
  if (motion->kind == STRUT_MOTION_RIGID_BODY) {
    snprintf(words, STRUT_VALUE_ROOM, "not prevented by the supports");
  } else if (motion->kind == STRUT_MOTION_INFINITESIMAL && all->by_forces) {
    snprintf(words, STRUT_VALUE_ROOM, "stiffened by the member forces: %s",
             strut_quantity_of(motion->stiffness, FEW_DIGITS, "N/m").text);
  } else if (motion->kind == STRUT_MOTION_INFINITESIMAL) {
    snprintf(
        words, STRUT_VALUE_ROOM, "stiffened by a self-stress state%s",
        all->stiffener_pulls ? "" : ", but none is known that does so without compressing a cable");
  } else if (followed) {
    snprintf(words, STRUT_VALUE_ROOM, "member lengths constant within %.0e over %s", motion->strain,
             strut_quantity_of(motion->moved, FEW_DIGITS, "m").text);
  } else if (motion->kind == STRUT_MOTION_FINITE) {
    snprintf(words, STRUT_VALUE_ROOM,
             "finite: without self-stress the member lengths are independent");
  } else {
    snprintf(words, STRUT_VALUE_ROOM,
             "undecided: no stiffening self-stress found, and it could not be followed");
  }
}

static const char *why_not(const strut_rigidity *rigidity) {
  if (!rigidity->stress.positive) return "the stress matrix has a negative eigenvalue";
  if (rigidity->stress.supported && rigidity->stress.nullity > 0)
    return "the stress matrix is not definite on the free coordinates";
  if (!rigidity->stress.supported && rigidity->stress.nullity > 3)
    return "the stress matrix vanishes on more than affine motions";
  if (!rigidity->stress.supported && rigidity->stress.nullity < 3)
    return "the forces do not balance";
  if (!rigidity->stress.supported && rigidity->stress.on_conic)
    return "an affine motion keeps all lengths: the members have only two directions";
  return "a cable is in compression";
}

static void write_super_stability(const strut_result_object *of, char words[STRUT_VALUE_ROOM]) {
  const strut_rigidity *rigidity = of->at;
  const char *source = stress_source_words(rigidity->source);
  if (rigidity->states.count == 0)
    snprintf(words, STRUT_VALUE_ROOM, "no: %s", source);
  else if (rigidity->stress.by_elements)
    snprintf(words, STRUT_VALUE_ROOM,
             "not judged: elements (hinges, cells, running cables) carry %s", source);
  else if (!rigidity->stress.tested)
    snprintf(words, STRUT_VALUE_ROOM, "not tested: the structure is too large");
  else if (rigidity->stress.super_stable)
    snprintf(words, STRUT_VALUE_ROOM, "yes, by %s", source);
  else
    snprintf(words, STRUT_VALUE_ROOM, "%s, by %s: %s",
             rigidity->states.count == 1 ? "no" : "not shown", source, why_not(rigidity));
}

/* ---- columns of the equilibrium matrix ---- */

/* Column of thing i of an owner: members, then hinges, cells, distances. */
static size_t column_of(const strut_scene *scene, strut_channel_owner owner, size_t i) {
  size_t hinges = scene->member_count, cells = hinges + scene->hinge_count;
  return i + (owner == STRUT_OWNER_HINGE      ? hinges
              : owner == STRUT_OWNER_CELL     ? cells
              : owner == STRUT_OWNER_DISTANCE ? cells + scene->cell_count
                                              : 0);
}

/* What such a column's force is: a moment [N m], a pressure [N/m] outwards, or itself [N]. */
static double column_force(const strut_rigidity *rigidity, strut_channel_owner owner,
                           double force) {
  return owner == STRUT_OWNER_HINGE  ? force * rigidity->matrix.size
         : owner == STRUT_OWNER_CELL ? -force / rigidity->matrix.size + 0.0
                                     : force;
}

/* An angle [rad], an area [m^2] or a length [m]. */
static double column_extent(const strut_rigidity *rigidity, strut_channel_owner owner, size_t j) {
  double length = rigidity->matrix.length[j];
  return owner == STRUT_OWNER_HINGE  ? length / rigidity->matrix.size
         : owner == STRUT_OWNER_CELL ? length * rigidity->matrix.size
                                     : length;
}

/* ---- forces of all columns, an array that is the object ---- */

static double item_of(const strut_result_object *of, strut_channel_owner owner, size_t i) {
  const double *force = of->at;
  return column_force(strut_result_whole(of), owner, force[column_of(of->scene, owner, i)]);
}

static double moment_of(const strut_result_object *of, size_t i) {
  return item_of(of, STRUT_OWNER_HINGE, i);
}
static double pressure_of(const strut_result_object *of, size_t i) {
  return item_of(of, STRUT_OWNER_CELL, i);
}
static double distance_of(const strut_result_object *of, size_t i) {
  return item_of(of, STRUT_OWNER_DISTANCE, i);
}
static double density_of(const strut_result_object *of, size_t j) {
  const strut_rigidity *rigidity = strut_result_whole(of);
  return rigidity->matrix.length[j] > 0 ? ((const double *)of->at)[j] / rigidity->matrix.length[j]
                                        : 0.0;
}

#define OTHERS(X, BEFORE)                                                                          \
  X(BEFORE "moments", "N m", IF(of->scene->hinge_count, OF_EACH(HINGE, moment_of)), "of hinges")   \
  X(BEFORE "pressures", "N/m", IF(of->scene->cell_count, OF_EACH(CELL, pressure_of)), "in cells")  \
  X(BEFORE "distance_forces", "N", IF(of->scene->distance_count, OF_EACH(DISTANCE, distance_of)),  \
    "of distances")

#define STATE(X)                                                                                   \
  X("forces", "N", OF(MEMBER, of->at), "of members, up to a factor", .label = {""})                \
  X("force_densities", "N/m", OF_EACH(MEMBER, density_of), "of members, up to the same factor")    \
  OTHERS(X, "")                                                                                    \
  X("feasible", "", FLAG(r->states.cables_pull[of->index]), "whether no cable is compressed")
STRUT_VALUES_HERE(state_values, STATE, const strut_rigidity *r = strut_result_whole(of))

#define FEASIBLE(X)                                                                                \
  X("feasible", "N", OF(MEMBER, of->at), "a state that compresses no cable, up to a factor")       \
  OTHERS(X, "feasible_")
STRUT_VALUES_HERE(feasible_values, FEASIBLE, )

#define STIFFENER(X)                                                                               \
  X("stiffened_by", "N", OF(MEMBER, of->at), "a state that stiffens the mechanisms")               \
  OTHERS(X, "stiffened_by_")
STRUT_VALUES_HERE(stiffener_values, STIFFENER, )

/* A list of states, each as long as the matrix has columns. */
static strut_value list_of_states(const strut_rigidity *r) {
  strut_value list = STRUT_VALUE_AS_LIST(r->states.force, r->states.count);
  list.size = (size_t)r->matrix.columns * sizeof *r->states.force;
  return list;
}

#define SELF_STRESS(X)                                                                             \
  X("count", "", COUNT(r->states.count), "of independent states, s", .label = {"s"})               \
  X("states", "", BY(list_of_states(r)), "null: too many to list", .rows = &state_values,          \
    .label = {"states, up to a factor"})                                                           \
  X("feasible", "", IF(listed && !r->feasible, TEXT(NULL)), "null: none is known")                 \
  X(NULL, "", IF(listed && r->feasible, PART(r->feasible)), "", .rows = &feasible_values)
STRUT_VALUES_HERE(self_stress_values, SELF_STRESS, const strut_rigidity *r = of->at;
                  bool listed = r->states.count > 0 && r->states.force)

/* ---- mechanisms ---- */

/* Scaled so that the node that moves most moves by 1. */
static double motion_of(const strut_result_object *of, size_t k) {
  const strut_rigidity *rigidity = strut_result_whole(of);
  const strut_mechanism *mode = of->at;
  int32_t row = rigidity->matrix.row_of[k];
  double moves = row < 0 ? 0.0 : mode->motion[row], largest = mode->largest;
  return !(largest > 0) ? moves : fabs(moves) < 1e-13 * largest ? 0.0 : moves / largest;
}

#define MODE(X)                                                                                    \
  X("kind", "", TEXT(strut_motion_kind_name(mode->kind)),                                          \
    "rigid-body, infinitesimal, finite, ...", .label = {""})                                       \
  X("stiffness", "N/m", NUMBER(mode->stiffness), "by the forces in the shape")                     \
  X("stress_form", "1/m", NUMBER(mode->stress_form), "by the state that stiffens")                 \
  X("moved", "m", NUMBER(mode->moved), "followed: largest change of a distance between nodes")     \
  X("strain", "1", NUMBER(mode->strain), "and of a member's length, relative")                     \
  X("test", "", WORDS(write_test), "in words", .label = {""})                                      \
  X("nodes", "1", OF_EACH(NODE, motion_of), "motion: the node that moves most moves by 1")
STRUT_VALUES_HERE(mode_values, MODE, const strut_mechanism *mode = of->at)

#define MECHANISMS(X)                                                                              \
  X("count", "", COUNT(m->count), "of independent ones, f", .label = {"f"})                        \
  X("rigid_body", "", COUNT(m->rigid_body), "of the whole", .label = {""})                         \
  X("infinitesimal", "", COUNT(m->infinitesimal), "some self-stress stiffens them", .label = {""}) \
  X("finite", "", COUNT(m->finite), "member lengths stay", .label = {""})                          \
  X("undecided", "", COUNT(m->undecided), "neither is known", .label = {""})                       \
  X("modes", "", LIST(m->list, m->count), "null: too many to list", .rows = &mode_values,          \
    .label = {""})                                                                                 \
  X(NULL, "", IF(listed && m->stiffener, PART(m->stiffener)), "", .rows = &stiffener_values)
STRUT_VALUES_HERE(mechanism_values, MECHANISMS, const strut_mechanisms *m = of->at;
                  bool listed = m->list || !m->count)

/* ---- verdicts ---- */

#define MAXWELL(X)                                                                                 \
  X("members_minus_coordinates", "", COUNT(r->matrix.columns - r->matrix.rows), "of the matrix",   \
    .label = {"members - coordinates"})                                                            \
  X("self_stress_minus_mechanisms", "", COUNT(r->states.count - r->mechanisms.count), "the same",  \
    .label = {"s - f"})
STRUT_VALUES_HERE(maxwell_values, MAXWELL, const strut_rigidity *r = of->at)

#define STRESS(X)                                                                                  \
  X("eigenvalues", "N/m", NUMBERS(stress->eigenvalues, stress->count), "ascending")                \
  X("nullity", "", COUNT(stress->nullity), "of them, zero up to rounding")                         \
  X("of", "", TEXT(stress_source_words(r->source)), "the forces")                                  \
  X("on", "", TEXT(stress->supported ? "free coordinates" : "nodes"), "motions")
STRUT_VALUES_HERE(stress_values, STRESS, const strut_rigidity *r = strut_result_whole(of);
                  const strut_stress_matrix *stress = of->at)

#define TENSEGRITY(X)                                                                              \
  X("label", "", TEXT(t->label), "in words", .label = {"kind"})                                    \
  X("self_stress", "", FLAG(t->self_stress), "there is a state of self-stress")                    \
  X("cables", "", FLAG(t->cables), "what is pulled are cables")                                    \
  X("stiffened_mechanism", "", FLAG(t->mechanism),                                                 \
    "which self-stress with pulled cables stiffens")                                               \
  X("all_states_stiffen", "", FLAG(t->all_states), "every listed state does")                      \
  X("struts_apart", "", FLAG(t->struts_apart), "no two members that are pressed meet")             \
  X("struts_inside", "", FLAG(t->struts_inside), "what is pulled is one net around all struts")
STRUT_VALUES_HERE(tensegrity_values, TENSEGRITY, const strut_tensegrity *t = of->at)

/* Of several states another combination might do it. */
static bool is_judged(const strut_rigidity *rigidity) {
  bool single = rigidity->states.count <= 1;
  return rigidity->states.count == 0 ||
         (rigidity->stress.tested && (single || rigidity->stress.super_stable));
}

/* Of a cable that does not pull. */
static const char *name_of_idle(const strut_result_object *of, size_t j) {
  const strut_member *member = &of->scene->members[j];
  bool pulls = ((const strut_rigidity *)of->at)->force[j] > 0.0;
  return member->kind == STRUT_CABLE && !pulls ? member->name : NULL;
}

/* ---- members and elements, each under its name ---- */

#define MEMBER(X)                                                                                  \
  X("kind", "", TEXT(strut_member_kind_name(of->scene->members[j].kind)), "spring, cable, bar",    \
    .label = {""})                                                                                 \
  X("length", "m", NUMBER(r->matrix.length[j]), "in the shape", .label = {""})                     \
  X("force", "N", NUMBER(r->force[j]), "its tension there", .label = {""})                         \
  X("force_density", "N/m", NUMBER(r->matrix.length[j] > 0 ? r->density[j] : (double)NAN),         \
    "force over length", .label = {""})
STRUT_VALUES_HERE(member_values, MEMBER, const strut_rigidity *r = strut_result_whole(of);
                  size_t j = of->index)

#define ELEMENT_ROWS(NAME, OWNER)                                                                  \
  static const char *NAME##_name(const strut_result_object *of, size_t i) {                        \
    return strut_owner_name(STRUT_OWNER_##OWNER, of->scene, i);                                    \
  }                                                                                                \
  STRUT_VALUES_HERE(NAME##_values, NAME##_TABLE, const strut_rigidity *r = strut_result_whole(of); \
                    size_t j = column_of(of->scene, STRUT_OWNER_##OWNER, of->index))
#define ELEMENT(X, OWNER, EXTENT, EXTENT_UNIT, FORCE, FORCE_UNIT)                                  \
  X(EXTENT, EXTENT_UNIT, NUMBER(column_extent(r, STRUT_OWNER_##OWNER, j)), "in the shape",         \
    .label = {""})                                                                                 \
  X(FORCE, FORCE_UNIT, NUMBER(column_force(r, STRUT_OWNER_##OWNER, r->force[j])), "there",         \
    .label = {""})
#define hinge_TABLE(X) ELEMENT(X, HINGE, "angle", "rad", "moment", "N m")
#define cell_TABLE(X) ELEMENT(X, CELL, "area", "m^2", "pressure", "N/m")
#define distance_TABLE(X) ELEMENT(X, DISTANCE, "distance", "m", "force", "N")
ELEMENT_ROWS(hinge, HINGE)
ELEMENT_ROWS(cell, CELL)
ELEMENT_ROWS(distance, DISTANCE)

static const char *member_name(const strut_result_object *of, size_t i) {
  return of->scene->members[i].name;
}

#define RIGIDITY(X)                                                                                \
  X("at", "", TEXT(r->at), "name of the shape", .label = {"rigidity at"})                          \
  X("nodes", "", COUNT(scene->node_count), "number")                                               \
  X("members", "", COUNT(scene->member_count), "number")                                           \
  X("hinges", "", IF(scene->hinge_count, COUNT(scene->hinge_count)), "number")                     \
  X("cells", "", IF(scene->cell_count, COUNT(scene->cell_count)), "number")                        \
  X("distances", "", IF(scene->distance_count, COUNT(scene->distance_count)), "number")            \
  X("free_coordinates", "", COUNT(r->matrix.rows), "rows of the equilibrium matrix",               \
    .label = {""})                                                                                 \
  X("supports", "", COUNT(2 * scene->node_count - (size_t)r->matrix.rows), "held coordinates")     \
  X("method", "", TEXT(r->spaces.dense ? "svd" : "qr"), "singular values, or sparse QR")           \
  X("tolerance", "1", NUMBER(STRUT_RANK_TOLERANCE), "of the largest, below which one is zero")     \
  X("rank", "", COUNT(r->spaces.rank), "of the equilibrium matrix", .label = {""})                 \
  X("largest", "1", NUMBER(r->spaces.largest), "singular value, or diagonal entry of R")           \
  X("kept", "1", NUMBER(r->spaces.kept), "smallest that counts",                                   \
    .label = {"smallest singular value kept"})                                                     \
  X("dropped", "1", NUMBER(r->spaces.dropped), "largest that does not",                            \
    .label = {"largest dropped"})                                                                  \
  X("weak", "", COUNT(r->spaces.weak), "that count, but are below a millionth of the largest",     \
    .label = {""})                                                                                 \
  X("without_length", "", COUNT(r->without_length), "members without a direction",                 \
    .label = {"members without length"})                                                           \
  X("self_stress", "", PART(r), "states of self-stress", .rows = &self_stress_values,              \
    .label = {""})                                                                                 \
  X("mechanisms", "", PART(&r->mechanisms), "motions that stretch no member",                      \
    .rows = &mechanism_values, .label = {""})                                                      \
  X("maxwell_calladine", "", PART(r), "the count", .rows = &maxwell_values,                        \
    .label = {"Maxwell-Calladine"})                                                                \
  X("class", "", COUNT(r->bars_at_node > 1 ? r->bars_at_node : 1), "most bars that meet",          \
    .label = {"most bars at a node"})                                                              \
  X("super_stable", "", KNOWN(is_judged(r), FLAG(r->stress.super_stable)), "null: not judged")     \
  X("super_stability", "", WORDS(write_super_stability), "in words", .label = {"super stable"})    \
  X("stress_matrix", "", KNOWN(r->stress.tested, PART(&r->stress)), "null: not tested",            \
    .rows = &stress_values)                                                                        \
  X("classification", "", PART(&r->tensegrity), "what kind of tensegrity",                         \
    .rows = &tensegrity_values, .label = {"tensegrity"})                                           \
  X("equilibrium", "", FLAG(r->equilibrium), "whether the shape is one", .label = {""})            \
  X("residual", "N", NUMBER(r->residual), "largest net force on a free coordinate",                \
    .label = {"net force"})                                                                        \
  X("self_equilibrium", "", FLAG(r->self_equilibrium), "whether the members balance alone")        \
  X("without_force", "", NAMES(name_of_idle, scene->member_count), "cables that do not pull",      \
    .label = {""})                                                                                 \
  X("members_at", "", NAMED(r->force, scene->member_count, member_name), "in the shape",           \
    .rows = &member_values, .label = {"member"})                                                   \
  X("hinges_at", "", IF(scene->hinge_count, NAMED(r->force, scene->hinge_count, hinge_name)),      \
    "in the shape", .rows = &hinge_values, .label = {"hinge"})                                     \
  X("cells_at", "", IF(scene->cell_count, NAMED(r->force, scene->cell_count, cell_name)),          \
    "in the shape", .rows = &cell_values, .label = {"cell"})                                       \
  X("distances_at", "",                                                                            \
    IF(scene->distance_count, NAMED(r->force, scene->distance_count, distance_name)),              \
    "in the shape", .rows = &distance_values, .label = {"distance"})
STRUT_VALUES(strut_rigidity_values, RIGIDITY, const strut_rigidity *r = of->at;
             const strut_scene *scene = of->scene)
