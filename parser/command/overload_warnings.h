/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Warnings about structures at rest in which something carries more than it can (forces/history.h).
 */
#ifndef STRUT_PARSER_COMMAND_OVERLOAD_WARNINGS_H
#define STRUT_PARSER_COMMAND_OVERLOAD_WARNINGS_H

#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/path/path.h"
#include "parser/command/messages.h"

/** Of the shape q (length), at `where`. */
void strut_warn_of_overload(const strut_listener *listener, const strut_model *model,
                            const double *q, const char *where);
/** Of all stable equilibria. */
void strut_warn_of_equilibria(const strut_listener *listener, const strut_model *model,
                              const strut_equilibria *all);
/** Of the first point of a path where that is so. */
void strut_warn_of_path(const strut_listener *listener, const strut_scene *scene,
                        const strut_path *path);

#endif
