/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Words that complete a command line, for the shells: `strut complete WORD...`, see parser/program/shells.
 *
 * A line each, "WORD" or "WORD<tab>explanation"; and a last line that begins with a colon: ":" alone,
 * ":files" or ":files yaml yml" where files (of these endings) fit too, ":folders".
 */
#ifndef STRUT_PARSER_PROGRAM_COMPLETE_H
#define STRUT_PARSER_PROGRAM_COMPLETE_H

#include <stdbool.h>
#include <stddef.h>

#include "engine/base/status.h"
#include "engine/output/page/page.h"
#include "parser/program/options.h"

/** What is being completed. */
typedef struct strut_completion {
  const char *word;   /* as typed so far, within an argument: behind its last comma or "--set=" */
  int kept;           /* bytes before it in the argument, which are printed again */
  const char *before; /* the argument */
  const char *model;  /* the first file or folder among the arguments, or NULL */
} strut_completion;

/** Prints the words for the last of `words` (count >= 0), which may be empty. */
strut_status strut_complete(int count, char **words);
/** Prints text + end if it begins as the word does. */
void strut_offer(const strut_completion *c, const char *text, const char *end, const char *help);

/** complete.c: names in the model, or in the table, that is among the arguments. */
void strut_offer_parameters(const strut_completion *c);
void strut_offer_values(const strut_completion *c); /* NAME=VALUE as the model has it */
void strut_offer_shapes(const strut_completion *c);
void strut_offer_nodes(const strut_completion *c);
void strut_offer_loads(const strut_completion *c);
void strut_offer_path_parameters(const strut_completion *c);
/** command_examples.c */
void strut_offer_examples(const strut_completion *c);
void strut_offer_columns(const strut_completion *c, const char *end);

/** complete.c: the script for a shell, or NULL. */
extern const char *const strut_shells[]; /* bash, zsh, fish, NULL */

/* The scripts of the folder shells, embedded at build time: each followed by a row of NULL. */

extern const strut_embedded strut_bash_script[], strut_zsh_script[], strut_fish_script[];
/** The scene of `strut examples --new`, with @FILE@ and @NAME@ for its names. */
extern const strut_embedded strut_new_scene[];

#endif
