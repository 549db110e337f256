/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * `strut complete WORD...`, which strut.bash calls: prints the words that complete the last one, a line each, and a
 * last line that begins with a colon: ":" alone, ":files" or ":files yaml yml" where files (of these endings) fit
 * too, or ":folders".
 */
#include <stdio.h>
#include <string.h>

#include "parser/language/keys/keys.h"
#include "parser/program/commands.h"

typedef struct completion {
  const char *word;   /* as typed so far, within an argument: behind its last comma or "--set=" */
  int kept;           /* bytes before it in the argument, which are printed again */
  const char *before; /* the argument */
} completion;

/* Prints the text if it begins as the word does. */
static void offer(const completion *self, const char *text) {
  if (strncmp(text, self->word, strlen(self->word)) == 0 && !strpbrk(text, "\t\n"))
    printf("%.*s%s\n", self->kept, self->before, text);
}

static void offer_commands(const completion *self) {
  for (size_t i = 0; strut_command_at(i); i++) offer(self, strut_command_at(i)->name);
}

static void offer_options(const completion *self, const strut_command *command) {
  char name[64];
  for (size_t i = 0; strut_option_at(command, i); i++) {
    snprintf(name, sizeof name, "--%s", strut_option_at(command, i)->name);
    offer(self, name);
  }
  for (const strut_command_variant *variant = command->forms; variant && variant->selector;
       variant++) {
    snprintf(name, sizeof name, "--%s", variant->selector);
    offer(self, name);
  }
}

static void offer_example(void *context, const char *model) { offer(context, model); }

/* ---- the command line ---- */

/* What fits the value of an option; returns the last line. */
static const char *complete_value(const strut_option *option, completion *self) {
  const char *comma = strrchr(self->word, ',');
  if (comma) { /* only what is behind the last comma is completed */
    self->kept += (int)(comma + 1 - self->word);
    self->word = comma + 1;
  }
  char word[40];
  for (int i = 0; strut_option_word(option, i, word, sizeof word); i++) offer(self, word);
  if (strcmp(option->argument, "DIR") == 0) return ":folders";
  return strncmp(option->argument, "FILE", 4) == 0 ? ":files" : ":";
}

static const char *complete_argument(const strut_command *command, completion *self) {
  const char *model = command->model ? command->model : "";
  if (strncmp(model, "COMMAND", 7) == 0) offer_commands(self);
  for (int i = 0; i < STRUT_SECTION_COUNT && strncmp(model, "SECTION", 7) == 0; i++)
    offer(self, strut_section_name((strut_section)i));
  if (strcmp(model, "EXAMPLE") == 0) strut_examples_list(offer_example, self);
  if (strcmp(model, "DIR") == 0) return ":folders";
  if (strcmp(model, "TABLE") == 0) return ":files csv";
  if (strstr(model, "RUN") || strncmp(model, "FILE", 4) == 0) return ":files";
  bool scene = strncmp(model, "MODEL", 5) == 0 || strcmp(model, "STUDY") == 0;
  return scene ? ":files yaml yml" : ":";
}

static const char *complete_in(const strut_command *command, int count, char **words) {
  char *word = words[count - 1], *value;
  completion c = {.word = word, .before = word};
  const strut_option *option = word[0] == '-' ? strut_option_of(command, word, &value) : NULL;
  if (option && value && option->argument) {
    c.kept = (int)(value - word);
    c.word = value;
    return complete_value(option, &c);
  }
  option = count > 1 && words[count - 2][0] == '-'
               ? strut_option_of(command, words[count - 2], &value)
               : NULL;
  if (option && !value && option->argument) return complete_value(option, &c);
  if (word[0] != '-') return complete_argument(command, &c);
  offer_options(&c, command);
  return ":";
}

strut_status strut_complete(int count, char **words) {
  const char *directive = ":";
  const strut_command *command = count > 1 ? strut_command_named(words[0]) : NULL;
  if (count == 1) offer_commands(&(completion){.word = words[0], .before = words[0]});
  if (command) {
    command = strut_command_variant_of(command, count - 2, words + 1);
    directive = complete_in(command, count - 1, words + 1);
  }
  puts(directive);
  return STRUT_OK;
}
