/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the cursor is decides what fits: a command, an option, an option's value, a file. See complete.h. */
#include "parser/program/complete.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "engine/integrate/integrator.h"
#include "parser/language/keys.h"
#include "parser/program/commands.h"

void strut_offer(const strut_completion *c, const char *text, const char *end, const char *help) {
  if (strncmp(text, c->word, strlen(c->word)) != 0 || strpbrk(text, "\t\n")) return;
  printf("%.*s%s%s", c->kept, c->before, text, end);
  if (help && *help) {
    putchar('\t');
    for (const char *h = help; *h; h++) putchar(*h == '\t' || *h == '\n' ? ' ' : *h);
  }
  putchar('\n');
}

static void offer_words(const strut_completion *c, const char *words) {
  char word[40];
  for (int i = 0; strut_word_at(words, i, word, sizeof word); i++) strut_offer(c, word, "", NULL);
}

static void offer_commands(const strut_completion *c) {
  for (size_t i = 0; strut_command_at(i); i++)
    strut_offer(c, strut_command_at(i)->name, "", strut_command_at(i)->summary);
}

static void offer_options(const strut_completion *c, const strut_command *command) {
  char name[64];
  for (size_t i = 0; strut_option_at(command, i); i++) {
    snprintf(name, sizeof name, "--%s", strut_option_at(command, i)->name);
    strut_offer(c, name, "", strut_option_at(command, i)->help);
  }
}

static void offer_methods(const strut_completion *c) {
  for (size_t i = 0; strut_integrator_at(i); i++)
    strut_offer(c, strut_integrator_at(i)->name, "", strut_integrator_at(i)->description);
}

/* ---- values of options ---- */

/* Options that are one of some words; a test compares them with what the commands accept. */
static const struct word_option {
  const char *command; /* NULL: every one */
  strut_option_id id;
  const char *words;
} word_options[] = {{"form", STRUT_OPTION_FROM, "densities|lengths|prestress"},
                    {"form", STRUT_OPTION_OBJECTIVE, "largest|sum|squares"},
                    {"tradeoff", STRUT_OPTION_MEASURE, "velocity|position|energy"},
                    {"plot", STRUT_OPTION_KIND, "curves|map|work-precision"},
                    {NULL, STRUT_OPTION_LOG, "x|y|xy"},
                    {NULL, STRUT_OPTION_COLORS, "auto|sequential|diverging|grey"},
                    {NULL, STRUT_OPTION_DRAW, "overview|period|snapshots|curves"},
                    {NULL, STRUT_OPTION_EQUILIBRIA, "all|none"},
                    {NULL, STRUT_OPTION_EMIT, "slurm|parallel|htcondor"},
                    {"export", STRUT_OPTION_FORMAT, "vtk|build|mjcf"},
                    {"import", STRUT_OPTION_FORMAT, "ntrt|tensegritysim|springable|tables"},
                    {NULL, STRUT_OPTION_WIDTH, "page|column"}};

/* Options that take the words of a key. */
static const struct key_option {
  strut_option_id id;
  int key;
} key_options[] = {{STRUT_OPTION_BARS, STRUT_KEY_SCENE_BARS},
                   {STRUT_OPTION_MASS_MODEL, STRUT_KEY_SCENE_MASS_MODEL},
                   {STRUT_OPTION_FRICTION_LAW, STRUT_KEY_FRICTION_LAW},
                   {STRUT_OPTION_DAMPING_LAW, STRUT_KEY_GROUND_DAMPING_LAW},
                   {STRUT_OPTION_COMPUTE, STRUT_KEY_STUDY_COMPUTE}};

static const char *words_of(const strut_command *command, strut_option_id id) {
  for (size_t i = 0; i < sizeof word_options / sizeof word_options[0]; i++) {
    const struct word_option *o = &word_options[i];
    if (o->id == id && (!o->command || strcmp(o->command, command->name) == 0)) return o->words;
  }
  for (size_t i = 0; i < sizeof key_options / sizeof key_options[0]; i++)
    if (key_options[i].id == id) return strut_key_at(key_options[i].key)->words;
  return NULL;
}

/* Only what is behind the last comma is completed. */
static void keep_list(strut_completion *c) {
  const char *comma = strrchr(c->word, ',');
  if (!comma) return;
  c->kept += (int)(comma + 1 - c->word);
  c->word = comma + 1;
}

static const char *files_of(const char *argument) {
  if (strcmp(argument, "DIR") == 0) return ":folders";
  return strncmp(argument, "FILE", 4) == 0 ? ":files" : ":";
}

/* The directive for the last line. */
static const char *complete_value(const strut_command *command, const strut_option *option,
                                  strut_completion *c) {
  const char *words = words_of(command, option->id);
  if (words) offer_words(c, words);
  if (words) return ":";
  switch ((int)option->id) {
    case STRUT_OPTION_SET:
    case STRUT_OPTION_VARY:
      if (strchr(c->word, '='))
        strut_offer_values(c);
      else
        strut_offer_parameters(c);
      return ":";
    case STRUT_OPTION_AT: strut_offer_shapes(c); return ":";
    case STRUT_OPTION_INTEGRATOR: offer_methods(c); return ":";
    case STRUT_OPTION_KEEP:
      keep_list(c), offer_words(c, strut_key_at(STRUT_KEY_STUDY_KEEP)->words);
      return ":";
    case STRUT_OPTION_METHODS: keep_list(c), offer_methods(c); return ":";
    case STRUT_OPTION_SUPPORTS: keep_list(c), strut_offer_nodes(c); return ":";
    case STRUT_OPTION_LOAD: strut_offer_loads(c); return ":";
    case STRUT_OPTION_OVER: strut_offer_path_parameters(c); return ":";
    case STRUT_OPTION_Y: keep_list(c), strut_offer_columns(c, ""); return ":";
    case STRUT_OPTION_X:
    case STRUT_OPTION_BY:
    case STRUT_OPTION_PANELS:
    case STRUT_OPTION_DIFFERENCE:
    case STRUT_OPTION_LABEL:
    case STRUT_OPTION_DOUBT: strut_offer_columns(c, ""); return ":";
    case STRUT_OPTION_BAND:
    case STRUT_OPTION_ONLY: strut_offer_columns(c, "="); return ":";
    default: return files_of(option->argument);
  }
}

/* ---- the command line ---- */

/* The option that `word` is, whole; its value follows "=" in *value, else NULL. */
static const strut_option *option_of(const strut_command *command, const char *word,
                                     const char **value) {
  *value = NULL;
  if (word[0] != '-' || !word[1]) return NULL;
  for (size_t i = 0; strut_option_at(command, i); i++) {
    const strut_option *option = strut_option_at(command, i);
    size_t length = strlen(option->name);
    if (word[1] != '-' && (int)option->id == word[1] && !word[2]) return option;
    if (word[1] != '-' || strncmp(word + 2, option->name, length) != 0) continue;
    if (word[2 + length] == '=') *value = word + 3 + length;
    if (*value || !word[2 + length]) return option;
  }
  return NULL;
}

/* The first file or folder among the positional arguments. */
static const char *find_model(const strut_command *command, int count, char **words) {
  for (int i = 0; i < count; i++) {
    const char *value;
    const strut_option *option = option_of(command, words[i], &value);
    if (option && option->argument && !value) i++;
    if (!option && words[i][0] != '-' && access(words[i], R_OK) == 0) return words[i];
  }
  return NULL;
}

static const char *complete_argument(const strut_command *command, const strut_completion *c) {
  const char *model = command->model ? command->model : "";
  if (strcmp(command->name, "help") == 0) offer_commands(c);
  for (size_t i = 0; strut_shells[i] && strcmp(model, "SHELL") == 0; i++)
    strut_offer(c, strut_shells[i], "", NULL);
  for (int i = 0; i < STRUT_SECTION_COUNT && strncmp(model, "SECTION", 7) == 0; i++)
    strut_offer(c, strut_section_name((strut_section)i), "", NULL);
  if (strcmp(model, "EXAMPLE") == 0) strut_offer_examples(c);
  if (strcmp(model, "DIR") == 0) return ":folders";
  if (strcmp(model, "TABLE") == 0) return ":files csv";
  if (strstr(model, "RUN") || strncmp(model, "FILE", 4) == 0) return ":files";
  bool scene = strncmp(model, "MODEL", 5) == 0 || strcmp(model, "STUDY") == 0;
  return scene ? ":files yaml yml" : ":";
}

static const char *complete_in(const strut_command *command, int count, char **words) {
  const char *word = words[count - 1], *value;
  strut_completion c = {.word = word, .before = word};
  c.model = find_model(command, count - 1, words);
  const strut_option *option = option_of(command, word, &value);
  if (option && value && option->argument) {
    c.kept = (int)(value - word);
    c.word = value;
    return complete_value(command, option, &c);
  }
  option = count > 1 ? option_of(command, words[count - 2], &value) : NULL;
  if (option && !value && option->argument) return complete_value(command, option, &c);
  if (word[0] != '-') return complete_argument(command, &c);
  offer_options(&c, command);
  return ":";
}

strut_status strut_complete(int count, char **words) {
  const char *directive = ":";
  const strut_command *command = NULL;
  if (count == 1) {
    strut_completion c = {.word = words[0], .before = words[0]};
    offer_commands(&c);
  }
  for (size_t i = 0; count > 1 && !command && strut_command_at(i); i++)
    if (strcmp(strut_command_at(i)->name, words[0]) == 0) command = strut_command_at(i);
  if (command) directive = complete_in(command, count - 1, words + 1);
  puts(directive);
  return STRUT_OK;
}
