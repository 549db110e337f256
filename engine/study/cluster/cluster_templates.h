/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * slurm.sh, embedded at build time and followed by a row of NULL. @NAME@ is to be
 * replaced, and a line whose NAME has no value left out.
 */
#ifndef STRUT_ENGINE_STUDY_CLUSTER_CLUSTER_TEMPLATES_H
#define STRUT_ENGINE_STUDY_CLUSTER_CLUSTER_TEMPLATES_H

#include "engine/output/buffer.h"

extern const strut_embedded strut_slurm_template[];

#endif
