/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The messages that faulty cases announce, and those that are found. */
#pragma once

#include "parser/language/read/read_scene.h"
#include "tests/language/cases.h"

/** The settings of a case, whose texts they divide: (c->set_count). */
void split_settings(faulty_case *c, strut_setting *settings);
/**
 * Strikes messages and their notes off those that the case announces; says which are not among them, and returns how
 * many. file_of: what a case calls the file of a place, NULL: nothing.
 */
size_t strike_messages(faulty_case *c, const strut_diagnostics *found,
                       const char *(*file_of)(const strut_diagnostics *found, strut_place place));
/** Says which of the announced messages are left, and returns how many. */
size_t missing_messages(const faulty_case *c);
