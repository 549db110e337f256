/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/summary.h"

#include "engine/base/memory.h"

void strut_summary_free(strut_summary *summary) {
  strut_release(summary->node_names);
  strut_release(summary->positions);
  strut_release(summary->contacts);
  summary->node_names = NULL;
  summary->positions = NULL;
  summary->contacts = NULL;
  summary->node_count = summary->contact_count = 0;
}
