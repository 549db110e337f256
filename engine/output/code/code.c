/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/code/code.h"

#include <assert.h>
#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/integrate/integrator.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/model/mass.h"
#include "engine/output/code/writer.h"
#include "engine/output/exports.h"
#include "engine/output/file.h"
#include "engine/output/results.h"

/* ---- what cannot be exported ---- */

static size_t count_rubbing(const strut_scene *scene) {
  size_t rubs = 0;
  for (size_t i = 0; i < scene->member_count; i++) rubs += scene->members[i].guide_friction > 0.0;
  return rubs;
}

/* Laws and strains are their own texts. Sticking that is exact needs a method with events. */
static void add_unwritten_laws(strut_unsupported *r, strut_law_set has) {
  char text[200];
  for (unsigned k = 0; k < STRUT_FRICTION_LAW_COUNT; k++) {
    bool exact = strut_friction_is_exact((strut_friction_law)k);
    snprintf(
        text, sizeof text,
        "friction law %s (its stops and starts are located within steps; use karnopp or smooth)",
        strut_friction_law_at((strut_friction_law)k)->word);
    strut_unsupported_add(r, exact && has.friction >> k & 1u, text);
  }
  for (unsigned k = 0; k < STRUT_LAW_COUNT; k++) {
    snprintf(text, sizeof text, "law %s", strut_law_at((strut_law_kind)k)->word);
    strut_unsupported_add(r, has.law >> k & 1u && !strut_code_knows_element_law((strut_law_kind)k),
                          text);
  }
  for (unsigned k = 0; k < STRUT_STRAIN_COUNT; k++) {
    const char *name = strut_strain_name((strut_strain_kind)k);
    char function[100];
    snprintf(function, sizeof function, "strain_%s", name);
    snprintf(text, sizeof text, "strain %s", name);
    strut_unsupported_add(r, has.strain >> k & 1u && !strut_code_knows_law(function), text);
  }
}

strut_status strut_code_check(const strut_model *model, strut_error *error) {
  const strut_scene *s = model->scene;
  strut_unsupported r = {.used = 0};
  strut_unsupported_add(&r, (model->terms & STRUT_TERM_RIGID) != 0,
                        "bars: rigid (their forces follow from equations "
                        "that each step would solve; use bars: elastic)");
  size_t pushed = 0;
  for (size_t i = 0; i < s->sensor_count; i++)
    pushed += s->sensors[i].kind == STRUT_SENSOR_CONTACT_FORCE;
  strut_unsupported_add(&r, pushed, "sensors of contact forces");
  strut_unsupported_add(&r, s->foot_count, "feet");
  strut_unsupported_add(&r, strut_bristle_count(s), "friction with bristles");
  strut_unsupported_add(&r, strut_collisions_rub(s), "friction of collisions");
  strut_unsupported_add(&r, model->contacts.grips, "friction that follows a signal");
  strut_unsupported_add(&r, count_rubbing(s), "friction at guides");
  strut_unsupported_add(&r, model->laws.strain >> STRUT_STRAIN_WRAP & 1u, "guides with a radius");
  add_unwritten_laws(&r, model->laws);
  strut_unsupported_add(&r, s->support_motion_count, "moves of nodes");
  strut_unsupported_add(&r, s->unbalance_count, "unbalances");
  if (r.used)
    return strut_fail(error, STRUT_BAD_SCENE,
                      "the scene has what no C code is written for: %s; leave it out, or compute "
                      "it in your program and give it as an input",
                      r.text);
  if (!model->mass)
    return strut_fail(error, STRUT_BAD_SCENE,
                      "a free node has no mass, so that no step can be made; give it one");
  return STRUT_OK;
}

/* ---- files ---- */

/* NULL: memory is out, or some number is no float. */
static char *expand(strut_code_writer *w, const strut_embedded *template) {
  strut_code_expand(w, template->text);
  return strut_buffer_take(&w->text);
}

static strut_status prepare(strut_code_writer *w, strut_error *error) {
  const char *prefix = w->options->prefix;
  for (size_t i = 0; prefix[i] && i + 1 < sizeof w->upper; i++)
    w->upper[i] = (char)toupper((unsigned char)prefix[i]);
  if (!strut_code_make_names(w)) return strut_no_memory(error, "");
  strut_status status =
      strut_step_limit_for_method(w->model, strut_integrator_find("rk4"), &w->rk4_limit, error);
  if (!status)
    status = strut_step_limit_for_method(w->model, strut_integrator_find("verlet"),
                                         &w->verlet_limit, error);
  return status;
}

static strut_status write_files(strut_code_writer *w, const char *directory, strut_error *error) {
  const strut_embedded *const templates[] = {strut_code_header_template, strut_code_source_template,
                                             strut_code_example_template};
  static const char *const endings[] = {".h", ".c", "_example.c"};
  char name[3][80];
  const char *const names[] = {name[0], name[1], name[2], NULL};
  char *text[3] = {NULL};
  strut_results results = {0};
  for (int i = 0; i < 3; i++) {
    snprintf(name[i], sizeof name[i], "%s%s", w->options->prefix, endings[i]);
    text[i] = expand(w, templates[i]);
  }
  strut_status status = STRUT_OK;
  if (w->no_float)
    status = strut_fail(error, STRUT_BAD_SCENE,
                        "some number of the scene is above 3.4e38, which no float is; use --real "
                        "double");
  if (!status) status = strut_results_begin_named(&results, directory, names, error);
  for (int i = 0; i < 3 && !status; i++) {
    status = strut_file_write_block(results.stage, name[i], text[i], error);
    text[i] = NULL;
  }
  for (int i = 0; i < 3; i++) strut_release(text[i]);
  if (!status) return strut_results_commit(&results, error);
  strut_results_abandon(&results);
  return status;
}

strut_status strut_code_write(const char *directory, const strut_model *model,
                              const strut_experiment *experiment, const strut_code_options *options,
                              strut_error *error) {
  strut_code_writer w = {
      .model = model, .scene = model->scene, .experiment = experiment, .options = options};
  strut_status status = strut_code_check(model, error);
  if (!status) status = prepare(&w, error);
  if (!status) {
    strut_c_locale locale = strut_c_locale_enter();
    status = write_files(&w, directory, error);
    strut_c_locale_leave(locale);
  }
  strut_arena_free(&w.arena);
  return status;
}

/* Templates to text; code.h says how they are written. */

enum { MOST_NESTED = 8 };

/* Which of the nested conditions hold. */
typedef struct conditions {
  bool holds[MOST_NESTED];
  int depth;
} conditions;

static size_t word_length(const char *text) {
  return strspn(text, "abcdefghijklmnopqrstuvwxyz_0123456789");
}

static bool all_hold(const strut_code_writer *w, const char *line, const char *end) {
  bool all = true;
  while (line < end) {
    line += strspn(line, " ");
    bool not = *line == '!';
    if (not ) line++;
    size_t length = word_length(line);
    if (!length) break;
    all = all && strut_code_has(w, line, length) != not ;
    line += length;
  }
  return all;
}

static bool is_shown(const conditions *c) {
  bool shown = true;
  for (int i = 0; i < c->depth; i++) shown = shown && c->holds[i];
  return shown;
}

static void add_line(strut_code_writer *w, const char *line, const char *end) {
  while (line < end) {
    size_t plain = strcspn(line, "$@");
    if (plain > (size_t)(end - line)) plain = (size_t)(end - line);
    if (plain) strut_buffer_add(&w->text, "%.*s", (int)plain, line);
    line += plain;
    if (line >= end) break;
    if (*line++ == '$') {
      strut_buffer_add(&w->text, "%s", w->options->prefix);
    } else if (*line == '_') {
      strut_buffer_add(&w->text, "%s", w->upper);
    } else {
      size_t length = word_length(line);
      strut_code_add_part(w, line, length);
      line += length;
    }
  }
}

static bool starts(const char *line, const char *word) {
  return !strncmp(line, word, strlen(word));
}

void strut_code_expand(strut_code_writer *w, const char *template) {
  conditions c = {.depth = 0};
  for (const char *line = template, *end; *line; line = end) {
    end = line + strcspn(line, "\n");
    end += *end == '\n';
    if (starts(line, "@if ")) {
      assert(c.depth < MOST_NESTED);
      c.holds[c.depth++] = all_hold(w, line + 4, end - 1);
    } else if (starts(line, "@else")) {
      c.holds[c.depth - 1] = !c.holds[c.depth - 1];
    } else if (starts(line, "@end")) {
      c.depth--;
    } else if (!is_shown(&c)) {
      continue;
    } else if (starts(line, "@table ")) {
      strut_code_add_part(w, line + 7, word_length(line + 7));
    } else {
      add_line(w, line, end);
    }
  }
  assert(c.depth == 0);
}
