/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a run records for its figures: apart, since a build that draws none records it for its page. */
#include "engine/output/figures/run_figure.h"

static const unsigned shown[] = {
    [STRUT_RUN_OVERVIEW] = STRUT_CHANNEL_FORCE | STRUT_CHANNEL_CONTACT | STRUT_CHANNEL_ANGLE,
    [STRUT_RUN_PERIOD] = 0,
    [STRUT_RUN_SNAPSHOTS] = STRUT_CHANNEL_FORCE | STRUT_CHANNEL_CONTACT,
    [STRUT_RUN_CURVES] = STRUT_CHANNEL_FORCE | STRUT_CHANNEL_CONTACT | STRUT_CHANNEL_ENERGY |
                         STRUT_CHANNEL_ANGLE | STRUT_CHANNEL_MOMENT | STRUT_CHANNEL_AREA |
                         STRUT_CHANNEL_PRESSURE,
};

unsigned strut_run_figure_channels(strut_run_view view) {
  return STRUT_CHANNEL_POSITION | shown[view];
}
