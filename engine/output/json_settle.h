/* SPDX-License-Identifier: GPL-3.0-or-later */
/** How a start settled, as every report's JSON has it. */
#ifndef STRUT_ENGINE_OUTPUT_JSON_SETTLE_H
#define STRUT_ENGINE_OUTPUT_JSON_SETTLE_H

#include "engine/output/json_value.h"
#include "engine/run/measure/summary.h"

/** Adds how a start settled as the member `settle`; nothing where it did not. */
void strut_json_settle(strut_json *json, struct cJSON *to, const strut_settle_summary *how);

#endif
