/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The scripts of the folder shells, embedded at build time: each followed by a row of NULL. */
#ifndef STRUT_PARSER_PROGRAM_SHELLS_H
#define STRUT_PARSER_PROGRAM_SHELLS_H

#include "engine/output/page/page.h"

extern const strut_embedded strut_bash_script[], strut_zsh_script[], strut_fish_script[];
/** The scene of `strut new`, with @FILE@ and @NAME@ for its names. */
extern const strut_embedded strut_new_scene[];

#endif
