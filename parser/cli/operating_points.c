/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/operating_points.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/memory.h"
#include "parser/cli/open_model.h"
#include "parser/cli/streams.h"

enum { MOST_TEXT = 400 };

/* Vigna's splitmix64: every seed will do, and every machine draws the same. */
static double draw(uint64_t *seed) {
  uint64_t z = (*seed += 0x9E3779B97F4A7C15u);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static size_t word_count(const char *text) {
  size_t count = 1;
  for (; *text; text++) count += *text == ',';
  return count;
}

/* The value that u from 0 to 1 stands for, as an expression of the language or a word. */
static bool choose(const char *range, double u, char text[MOST_TEXT]) {
  const char *dots = strstr(range, "..");
  int used;
  if (dots) {
    int low = (int)(dots - range);
    strut_c_locale locale = strut_c_locale_enter();
    used = snprintf(text, MOST_TEXT, "(%.*s) + %.17g*((%s) - (%.*s))", low, range, u, dots + 2, low,
                    range);
    strut_c_locale_leave(locale);
  } else {
    size_t wanted = (size_t)(u * (double)word_count(range));
    const char *word = range;
    while (wanted-- > 0) word = strchr(word, ',') + 1;
    used = snprintf(text, MOST_TEXT, "%.*s", (int)strcspn(word, ","), word);
  }
  return used > 0 && used < MOST_TEXT;
}

/* Whether NAME=LOW..HIGH or NAME=WORD,WORD says something. */
static strut_status check(const strut_command *command, const strut_override *varied) {
  const char *value = varied->value, *dots = strstr(value, "..");
  bool good = dots ? dots > value && dots[2] : *value && *value != ',';
  for (const char *c = value; *c && !dots; c++)
    good = good && !(*c == ',' && (c[1] == ',' || c[1] == '\0'));
  if (good && strlen(value) < MOST_TEXT / 3) return STRUT_OK;
  fprintf(stderr, "strut %s: --vary expects NAME=LOW..HIGH or NAME=WORD,WORD,... and not '%s=%s'\n",
          command->name, varied->name, value);
  return STRUT_USAGE;
}

static strut_status open_one(const strut_command *command, const strut_arguments *arguments,
                             uint64_t *seed, size_t number, strut_setup *setup) {
  size_t varied = arguments->varied_count, set = arguments->override_count;
  strut_override *overrides = strut_allocate(set + varied + 1, sizeof *overrides);
  char(*texts)[MOST_TEXT] = strut_allocate(varied + 1, sizeof *texts);
  strut_status status = overrides && texts ? STRUT_OK : strut_print_out_of_memory();
  for (size_t i = 0; i < set && status == STRUT_OK; i++) overrides[i] = arguments->overrides[i];
  for (size_t i = 0; i < varied && status == STRUT_OK; i++) {
    choose(arguments->varied[i].value, draw(seed), texts[i]);
    overrides[set + i] = (strut_override){arguments->varied[i].name, texts[i]};
  }
  if (status == STRUT_OK) {
    strut_arguments here = *arguments;
    here.overrides = overrides;
    here.override_count = set + varied;
    status = strut_open_model(&here, STRUT_OPEN_FOR_RUN, setup);
    if (status != STRUT_OK && varied > 0) {
      fprintf(stderr, "strut %s: that was operating point %zu:", command->name, number + 1);
      for (size_t i = 0; i < varied; i++)
        fprintf(stderr, " --set '%s=%s'", overrides[set + i].name, overrides[set + i].value);
      fputc('\n', stderr);
    }
  }
  strut_release(overrides);
  strut_release(texts);
  return status;
}

strut_status strut_operating_points_open(const strut_command *command,
                                         const strut_arguments *arguments, size_t count,
                                         uint64_t seed, strut_operating_points *points) {
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < arguments->varied_count && status == STRUT_OK; i++)
    status = check(command, &arguments->varied[i]);
  if (status == STRUT_OK && count > 1 && strcmp(arguments->model, "-") == 0) {
    fprintf(stderr, "strut %s: operating points read the model again and again: give a file\n",
            command->name);
    status = STRUT_USAGE;
  }
  *points = (strut_operating_points){.count = 0};
  if (status != STRUT_OK) return status;
  points->setups = strut_allocate(count, sizeof *points->setups);
  points->list = strut_allocate(count, sizeof *points->list);
  if (!points->setups || !points->list) status = strut_print_out_of_memory();
  for (size_t p = 0; p < count && status == STRUT_OK; p++) {
    status = open_one(command, arguments, &seed, p, &points->setups[p]);
    points->list[p] = &points->setups[p];
    if (status == STRUT_OK) points->count++;
  }
  if (status != STRUT_OK) strut_operating_points_free(points);
  return status;
}

void strut_operating_points_free(strut_operating_points *points) {
  for (size_t p = 0; p < points->count; p++) strut_setup_free(&points->setups[p]);
  strut_release(points->setups);
  strut_release(points->list);
  *points = (strut_operating_points){.count = 0};
}
