/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The library as a whole: versions, codes, controls, and what holds while a call computes. */
#include <gsl/gsl_errno.h>
#include <stdlib.h>
#include <string.h>

#include "parser/abi/handles.h"

int strutlib_abi_version(void) { return STRUTLIB_ABI_VERSION; }
const char *strutlib_version(void) { return STRUT_VERSION; }
void strutlib_release(char *text) { strut_release(text); }

char *abi_give(char *text, strutlib_error **error) {
  if (!text) abi_no_memory(error);
  return text;
}

/* ---- codes ---- */

_Static_assert(STRUTLIB_OK == (int)STRUT_OK && STRUTLIB_USAGE == (int)STRUT_USAGE &&
                   STRUTLIB_BAD_SCENE == (int)STRUT_BAD_SCENE &&
                   STRUTLIB_DIVERGED == (int)STRUT_DIVERGED &&
                   STRUTLIB_STEP_TOO_LARGE == (int)STRUT_STEP_TOO_LARGE &&
                   STRUTLIB_NOT_SETTLED == (int)STRUT_NOT_SETTLED &&
                   STRUTLIB_SINGULAR == (int)STRUT_SINGULAR &&
                   STRUTLIB_WORK_LIMIT == (int)STRUT_WORK_LIMIT &&
                   STRUTLIB_FILE_TROUBLE == (int)STRUT_FILE_TROUBLE &&
                   STRUTLIB_NO_MEMORY == (int)STRUT_NO_MEMORY &&
                   STRUTLIB_INTERRUPTED == (int)STRUT_INTERRUPTED &&
                   STRUTLIB_INACCURATE == (int)STRUT_INACCURATE &&
                   STRUTLIB_INACCURATE + 1 == (int)STRUT_STATUS_COUNT,
               "the header's numbers are those of strut_status");

static const char *const status_names[] = {
    "ok",       "usage",      "bad_scene",    "diverged",  "step_too_large", "not_settled",
    "singular", "work_limit", "file_trouble", "no_memory", "interrupted",    "inaccurate"};

static bool is_status(int status) { return status >= 0 && status < (int)STRUT_STATUS_COUNT; }

const char *strutlib_status_name(int status) {
  return is_status(status) ? status_names[status] : "unknown";
}

const char *strutlib_status_text(int status) {
  return is_status(status) ? strut_status_text((strut_status)status) : "unknown status";
}

int strutlib_exit_code(int status) {
  return is_status(status) ? strut_status_exit_code((strut_status)status) : 1;
}

/* ---- controls ---- */

strutlib_control *strutlib_control_create(void) {
  return strut_allocate(1, sizeof(strutlib_control));
}

void strutlib_control_free(strutlib_control *control) { strut_release(control); }
void strutlib_interrupt(strutlib_control *control) {
  if (control) control->interrupt = 1;
}

void strutlib_control_reset(strutlib_control *control) {
  if (control) control->interrupt = 0;
}

int strutlib_control_interrupted(const strutlib_control *control) {
  return control && control->interrupt != 0;
}

void strutlib_control_on_progress(strutlib_control *control, strutlib_progress progress,
                                  void *context) {
  if (!control) return;
  control->context = context;
  control->progress = progress;
}

/* ---- GSL's error handler ---- */

/*
 * GSL has one handler for the whole process, which by default aborts. It is off while any call computes;
 * the last one that leaves puts back what the host had, unless the host has set another meanwhile.
 */
static pthread_mutex_t handler_lock = PTHREAD_MUTEX_INITIALIZER;
static int computing;
static gsl_error_handler_t *of_host;

void abi_enter(strutlib_error **error) {
  if (error) *error = NULL;
  pthread_mutex_lock(&handler_lock);
  if (computing++ == 0) of_host = gsl_set_error_handler_off();
  pthread_mutex_unlock(&handler_lock);
}

void abi_leave(void) {
  pthread_mutex_lock(&handler_lock);
  if (--computing == 0) {
    gsl_error_handler_t *now = gsl_set_error_handler_off();
    gsl_error_handler_t *off = gsl_set_error_handler(of_host);
    if (now != off) gsl_set_error_handler(now);
  }
  pthread_mutex_unlock(&handler_lock);
}

/* ---- options ---- */

static const strut_command *command_of(const char *name) {
  for (size_t i = 0; name && abi_command_at(i); i++)
    if (strcmp(abi_command_at(i)->name, name) == 0) return abi_command_at(i);
  return NULL;
}

static const strut_option *option_of(const char *command, size_t i) {
  const strut_command *found = command_of(command);
  for (size_t k = 0; found && found->options[k].id != STRUT_OPTION_END; k++)
    if (k == i) return &found->options[k];
  return NULL;
}

const char *strutlib_option_name(const char *command, size_t i) {
  const strut_option *option = option_of(command, i);
  return option ? option->name : NULL;
}

const char *strutlib_option_help(const char *command, size_t i) {
  const strut_option *option = option_of(command, i);
  return option ? option->help : NULL;
}

/* ---- calls ---- */

void abi_call_fail(abi_call *call, strut_status status, const strut_error *what) {
  bool told = !(what && what->message[0]) && call->messages->error.message[0];
  abi_fail_with(call->error, status, told ? &call->messages->error : what);
}

strut_status abi_call_begin(abi_call *call, const strutlib_scene *scene,
                            const strut_command *command, size_t count, const char *const *names,
                            const char *const *values, strutlib_control *control,
                            strutlib_error **error, abi_messages *messages) {
  *call = (abi_call){.error = error, .control = control, .messages = messages};
  if (abi_lacks(error, scene, "scene") || abi_lacks_pairs(error, count, names, values))
    return STRUT_USAGE;
  call->listener = abi_listen(messages);
  call->arguments = (strut_arguments){.model = scene->source->name,
                                      .overrides = scene->overrides,
                                      .override_count = scene->setting_count,
                                      .listener = &call->listener};
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < count && status == STRUT_OK; i++)
    status = strut_argument_set(command, names[i], values[i], &call->arguments);
  if (status == STRUT_OK && control && control->interrupt) {
    abi_fail(error, STRUTLIB_INTERRUPTED, "interrupted before anything was computed");
    return STRUT_INTERRUPTED;
  }
  if (status != STRUT_OK) abi_call_fail(call, status, NULL);
  return status;
}
