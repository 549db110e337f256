/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Manual pages in man(7), made from the tables of commands, options and keys.
 */
#ifndef STRUT_PARSER_PROGRAM_MANUAL_H
#define STRUT_PARSER_PROGRAM_MANUAL_H

#include "parser/program/options.h"

/** Prints strut(1), the page of a command, or strut-model(5). */
void strut_manual_of_program(void);
void strut_manual_of_command(const strut_command *command);
void strut_manual_of_language(void);

/** manual.c: source of a page. Text is Markdown with code in backticks; lines are kept short. */
void strut_manual_begin(const char *name, int chapter, const char *summary);
void strut_manual_heading(const char *macro, const char *text);
void strut_manual_text(const char *markdown);
void strut_manual_item(const char *markdown); /* the tag of a paragraph that follows */

#endif
