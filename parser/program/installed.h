/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What is installed with the program: found from where the program is, so that all may be moved. And
 * files of the user's.
 */
#pragma once

#include <stdbool.h>

enum { STRUT_LONGEST_PATH = 4096 };

/**
 * The path of `name` below share/strut, or of `built` beside a program that is not installed; false where
 * neither exists.
 */
bool strut_find_installed(const char *name, const char *built, char path[STRUT_LONGEST_PATH]);
