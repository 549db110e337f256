/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A layout with every channel and rows that exercise numbers, for tests of the writers. */
#pragma once

#include "engine/run/recorder.h"

/** Three nodes (one with an awkward name), two members, two contacts, energy: all six channels. */
const strut_record_layout *sample_layout(void);
/** The value in that row and column: a deterministic, awkward number; column 0 is the time. */
double sample_value(size_t row, size_t column);
/** Rows first .. first + count - 1 in a block to free. */
double *sample_rows(const strut_record_layout *layout, size_t first, size_t count);
/** begin, all rows in uneven portions, end with the status; stops at the first failure. */
strut_status sample_feed(strut_sink *sink, size_t rows, strut_status run_status,
                         strut_error *error);
