/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What modes and waves have, a row for each value. */
#include "engine/base/vec.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/modes/waves.h"

#define MODE(X)                                                                                    \
  X(NULL, "", COUNT(of->index + 1), "", .column = {"mode"})                                        \
  X("frequency", "Hz", NUMBER(mode->angular_frequency / STRUT_TAU), "without damping",             \
    .column = {"frequency [Hz]"}, .label = {""})                                                   \
  X("angular_frequency", "1/s", NUMBER(mode->angular_frequency), "without damping")                \
  X("eigenvalue", "1/s^2", NUMBER(mode->eigenvalue), "its square; below zero: it grows")           \
  X("damping_ratio", "1", NUMBER(mode->damping_ratio), "null: nothing oscillates",                 \
    .column = {"damping ratio"}, .label = {"damping"})                                             \
  X("damped_frequency", "Hz", NUMBER(mode->damped_frequency / STRUT_TAU), "0 where it creeps",     \
    .column = {"damped frequency [Hz]"})                                                           \
  X("decay_rate", "1/s", NUMBER(mode->decay_rate),                                                 \
    "of the amplitude; the slower, where it creeps", .column = {"decay rate [1/s]"})               \
  X("residual", "1", NUMBER(mode->residual), "of the eigenproblem, relative")                      \
  X("error", "1", NUMBER(mode->error), "bound of the eigenvalue's, relative", .column = {"error"}, \
    .label = {""})                                                                                 \
  X("kind", "", TEXT(strut_mode_kind_name(mode->kind)), "rigid-body, mechanism, elastic, ...",     \
    .column = {"kind"}, .label = {""})                                                             \
  X("description", "", TEXT(mode->description), "in words", .column = {"description"},             \
    .label = {"shape"})                                                                            \
  X("shape", "1", OF(NODE, mode->shape), "the largest entry is 1")
STRUT_VALUES(strut_mode_values, MODE, const strut_mode *mode = of->at)

static const char *closed_name(const strut_result_object *of, size_t i) {
  return of->scene->nodes[((const strut_modes *)of->at)->closed[i]].name;
}

static const char *name_of_idle(const strut_result_object *of, size_t i, strut_idleness kind) {
  const strut_modes *modes = of->at;
  return modes->idleness[i] == kind ? of->scene->members[i].name : NULL;
}

static const char *slack_name(const strut_result_object *of, size_t i) {
  return name_of_idle(of, i, STRUT_SLACK);
}

static const char *just_taut_name(const strut_result_object *of, size_t i) {
  return name_of_idle(of, i, STRUT_JUST_TAUT);
}

#define MODES(X)                                                                                   \
  X("at", "", TEXT(modes->at), "name of the equilibrium")                                          \
  X("nodes", "m", OF(NODE, modes->q), "its positions")                                             \
  X("coordinates", "", COUNT(modes->coordinates), "free ones")                                     \
  X("contacts", "", NAMES(closed_name, modes->closed_count), "nodes that touch the ground")        \
  X("slack", "", NAMES(slack_name, of->scene->member_count), "members that take no part")          \
  X("just_taut", "", NAMES(just_taut_name, of->scene->member_count),                               \
    "members without a force that would act one way only, counted as slack")                       \
  X("method", "", TEXT(modes->dense ? "dense" : "sparse"), "all modes, or the lowest")             \
  X("condition", "1", NUMBER(modes->condition), "largest eigenvalue over the smallest, not zero")  \
  X("at_rest", "", FLAG(modes->at_rest), "whether the shape is an equilibrium")                    \
  X("settle", "", IF(modes->settle.evaluations, PART(&modes->settle)), "how it was found",         \
    .rows = &strut_settle_values)                                                                  \
  X("damping", "", TEXT(modes->damped_exactly ? "quadratic eigenproblem" : "modal quotient"),      \
    "how it was computed")                                                                         \
  X("left_out", "", TEXT(modes->left_out), "what acts in a run, but not here")                     \
  X("modes", "", LIST(modes->list, modes->count), "by eigenvalue", .rows = &strut_mode_values,     \
    .label = {"mode"})
STRUT_VALUES(strut_modes_values, MODES, const strut_modes *modes = of->at)

/* ---- waves ---- */

#define BAND(X)                                                                                    \
  X("low", "Hz", NUMBER(band->low.frequency), "lowest frequency", .label = {"lowest"})             \
  X("low_at", "1", NUMBERS(band->low.phase, waves->steps), "its wave, in turns for each step")     \
  X("high", "Hz", NUMBER(band->high.frequency), "highest frequency", .label = {"highest"})         \
  X("high_at", "1", NUMBERS(band->high.phase, waves->steps), "its wave, likewise")
STRUT_VALUES_HERE(band_values, BAND, const strut_wave_band *band = of->at;
                  const strut_waves *waves = of->outer->at)

#define GAP(X)                                                                                     \
  X("below", "", COUNT(gap->below), "bands below it", .label = {"bands below"})                    \
  X("low", "Hz", NUMBER(gap->low), "where it begins", .label = {"from"})                           \
  X("high", "Hz", NUMBER(gap->high), "where it ends", .label = {"to"})
STRUT_VALUES_HERE(gap_values, GAP, const strut_wave_gap *gap = of->at)

#define CORNER(X)                                                                                  \
  X("name", "", TEXT(corner->name), "0, 1/2, or G, X, M, Y")                                       \
  X("along", "1", NUMBER(waves->along[corner->sample]), "its place on the line")
STRUT_VALUES_HERE(corner_values, CORNER, const strut_wave_corner *corner = of->at;
                  const strut_waves *waves = of->outer->at)

#define SAMPLE(X)                                                                                  \
  X("along", "1", NUMBER(waves->along[of->index]), "its place on the line",                        \
    .column = {"along [1]"})                                                                       \
  X("phase", "1", NUMBERS(waves->phase[of->index], waves->steps), "in turns for each step",        \
    .column = {"phase"})                                                                           \
  X("frequencies", "Hz",                                                                           \
    NUMBERS(waves->frequency + of->index * (size_t)waves->band_count, waves->shown), "ascending",  \
    .column = {"band"})
STRUT_VALUES(strut_wave_values, SAMPLE, const strut_waves *waves = of->outer->at)

#define WAVES(X)                                                                                   \
  X("at", "", TEXT(waves->at), "the shape that the equilibrium was found from")                    \
  X("lattice", "m", TABLE(of->scene->lattice, waves->steps, 2), "steps from a cell to the next")   \
  X("nodes", "m", OF(NODE, waves->q), "positions at the equilibrium")                              \
  X("moved", "m", NUMBER(waves->moved), "largest displacement of a node from that shape")          \
  X("residual", "N", NUMBER(waves->residual), "largest net force on a node")                       \
  X("coordinates", "", COUNT(waves->band_count), "of a cell: the number of bands")                 \
  X("images", "", COUNT(waves->images), "nodes that are those of neighbouring cells")              \
  X("samples", "", COUNT(waves->count + waves->inside), "of the wave vector")                      \
  X("speeds", "m/s", TABLE(waves->speed, waves->steps, waves->acoustic), "of long waves")          \
  X("bands", "", LIST(waves->band, waves->shown), "ascending", .rows = &band_values,               \
    .label = {"band"})                                                                             \
  X("gaps", "", LIST(waves->gaps, waves->gap_count), "frequencies that no wave has",               \
    .rows = &gap_values, .label = {"gap"})                                                         \
  X("corners", "", LIST(waves->corner, waves->corner_count), "of the line through the zone",       \
    .rows = &corner_values)                                                                        \
  X("waves", "", LIST(waves->along, waves->count), "samples along it", .rows = &strut_wave_values)
STRUT_VALUES(strut_waves_values, WAVES, const strut_waves *waves = of->at)
