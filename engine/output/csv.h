/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Trajectories as CSV: nodes.csv, members.csv, hinges.csv, cells.csv, contacts.csv, energy.csv, whichever has channels.
 */
#ifndef STRUT_ENGINE_OUTPUT_CSV_H
#define STRUT_ENGINE_OUTPUT_CSV_H

#include "engine/run/recorder.h"

/** A sink that writes into directory (which exists). NULL when memory is out. */
STRUT_API strut_sink *strut_csv_create(const char *directory);
/** Frees the sink; abandons what was not ended. */
STRUT_API void strut_csv_free(strut_sink *sink);

#endif
