/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the shards of a study have, on stdout.
 */
#ifndef STRUT_PARSER_CLI_SWEEP_SHARDS_H
#define STRUT_PARSER_CLI_SWEEP_SHARDS_H

#include "engine/study/results/shard.h"

/** A line, or an object of a JSON list, for each shard in the directory that is begun or missing. */
strut_status strut_sweep_print_shards(const char *directory, const strut_shards_found *found,
                                      strut_arena *arena, bool json);

#endif
