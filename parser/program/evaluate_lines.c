/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requests as lines of JSON, each answered as soon as it is read. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/select.h>
#include <unistd.h>

#include "engine/output/file.h"
#include "engine/output/json_value.h"
#include "parser/program/evaluate.h"
#include "parser/program/streams.h"
#include "parser/yaml/text.h"

enum { MOST_LINE = 1 << 20, READ_AT_ONCE = 1 << 16 };

/* Where requests come from and answers go. */
typedef struct exchange {
  const strut_evaluate_task *task;
  const char *name; /* of the requests, for messages */
  int from;
  char *text; /* read but not answered: text[begin..end) */
  size_t begin, end;
  bool over;     /* nothing more can be read */
  bool skipping; /* within a line that is too long */
  uint32_t line;
  FILE *to;
  strut_file file;
  bool misunderstood, failed, inaccurate; /* some request was */
  strut_status status;                    /* what ends the loop early */
  strut_error error;
} exchange;

/* ---- reading ---- */

/* Waits for input with the signals blocked elsewhere, so that none is missed. False: interrupted. */
static bool wait_for_input(const exchange *x) {
  sigset_t stops, before;
  fd_set input;
  int ready = -1;
  sigemptyset(&stops);
  sigaddset(&stops, SIGINT);
  sigaddset(&stops, SIGTERM);
  sigprocmask(SIG_BLOCK, &stops, &before);
  while (!*x->task->interrupt && ready < 0) {
    FD_ZERO(&input);
    FD_SET(x->from, &input);
    ready = pselect(x->from + 1, &input, NULL, NULL, NULL, &before);
    if (ready < 0 && errno != EINTR) break; /* read() says what is wrong */
  }
  sigprocmask(SIG_SETMASK, &before, NULL);
  return !*x->task->interrupt;
}

static void read_more(exchange *x) {
  if (x->begin > 0) memmove(x->text, x->text + x->begin, x->end - x->begin);
  x->end -= x->begin;
  x->begin = 0;
  if (!wait_for_input(x)) {
    x->status = STRUT_INTERRUPTED;
    return;
  }
  ssize_t got = read(x->from, x->text + x->end, READ_AT_ONCE);
  if (got < 0 && errno == EINTR) return;
  if (got < 0)
    x->status =
        strut_fail(&x->error, STRUT_FILE_TROUBLE, "cannot read '%s': %s", x->name, strerror(errno));
  if (got == 0) x->over = true;
  if (got > 0) x->end += (size_t)got;
}

/* The next line that is not blank, without its end. False: there is none, or x->status says why. */
static bool next_line(exchange *x, char **line, size_t *length) {
  while (!x->status) {
    char *start = x->text + x->begin, *stop = memchr(start, '\n', x->end - x->begin);
    size_t left = x->end - x->begin;
    if (!stop && !x->over && left <= MOST_LINE) {
      read_more(x);
      continue;
    }
    if (!stop && x->over && left == 0) return false;
    *length = stop ? (size_t)(stop - start) : left;
    *line = start;
    x->begin += *length + (stop != NULL);
    bool middle = x->skipping;
    x->skipping = !stop && !x->over;
    if (middle) continue; /* of a line that was answered already */
    x->line++;
    if (*length > MOST_LINE || strspn(start, " \t\r") < *length) return true;
  }
  return false;
}

/* ---- answering ---- */

static void begin_answer(strut_json *json, const exchange *x, const strut_request *request,
                         strut_status status, const char *status_text) {
  const strut_tree *id = request->id;
  strut_json_integer(json, json->root, "line", x->line);
  if (id && id->quoted) strut_json_text(json, json->root, "id", id->text);
  if (id && !id->quoted) strut_json_raw(json, json->root, "id", id->text);
  strut_json_integer(json, json->root, "code", strut_status_exit_code(status));
  strut_json_text(json, json->root, "status", status_text);
}

static void send_answer(exchange *x, strut_json *json) {
  char *text = strut_json_end_line(json);
  errno = 0;
  if (!text)
    x->status = strut_no_memory(&x->error, "for an answer");
  else if (fputs(text, x->to) < 0 || (!x->file.stream && fflush(x->to) != 0))
    x->status =
        strut_fail(&x->error, STRUT_FILE_TROUBLE, "cannot write the answers: %s", strerror(errno));
  strut_release(text);
}

static void refuse(exchange *x, const strut_request *request, strut_status status,
                   const strut_request_findings *findings) {
  strut_json json = strut_json_begin();
  begin_answer(&json, x, request, status,
               status == STRUT_BAD_SCENE ? "invalid request" : strut_status_text(status));
  bool known = findings->count > 0;
  strut_json_text(&json, json.root, "message",
                  known ? findings->text[0] : strut_status_text(status));
  if (findings->count > 1) {
    struct cJSON *list = strut_json_array(&json, json.root, "messages");
    for (size_t i = 0; i < findings->count && i < STRUT_REQUEST_FINDINGS; i++)
      strut_json_text(&json, list, NULL, findings->text[i]);
  }
  send_answer(x, &json);
  x->misunderstood = true;
}

static void send_evaluation(exchange *x, const strut_request *request,
                            const strut_evaluation *evaluation) {
  strut_json json = strut_json_begin();
  strut_status status = evaluation->inaccurate ? STRUT_INACCURATE : evaluation->status;
  begin_answer(&json, x, request, status, strut_status_text(status));
  x->inaccurate = x->inaccurate || evaluation->inaccurate;
  if (evaluation->status) {
    strut_json_text(&json, json.root, "message", evaluation->message);
    x->failed = true;
  } else {
    struct cJSON *results = strut_json_object(&json, json.root, "results");
    for (size_t i = 0; i < evaluation->count; i++) {
      const strut_evaluated *r = &evaluation->results[i];
      if (r->word)
        strut_json_text(&json, results, r->name, *r->word ? r->word : NULL);
      else
        strut_json_number(&json, results, r->name, r->number);
    }
  }
  if (evaluation->warning_count > 0) {
    struct cJSON *list = strut_json_array(&json, json.root, "warnings");
    for (size_t i = 0; i < evaluation->warning_count; i++)
      strut_json_text(&json, list, NULL, evaluation->warnings[i]);
  }
  send_answer(x, &json);
}

static void add_finding(exchange *x, strut_request *request, strut_request_findings *findings,
                        uint32_t column, const char *text) {
  const char *whole =
      strut_arena_format(&request->arena, "%s:%u:%u: %s", x->name, x->line, column, text);
  findings->text[findings->count++] = whole ? whole : "out of memory";
}

/* From the text of a request to its scene. */
static strut_status read_request(exchange *x, const char *line, size_t length,
                                 strut_request *request, strut_setup *setup,
                                 strut_request_findings *findings) {
  strut_tree *tree;
  strut_json_error json;
  strut_error error = {0};
  if (length > MOST_LINE) {
    add_finding(x, request, findings, MOST_LINE + 1, "a line may have at most 1048576 bytes");
    return STRUT_BAD_SCENE;
  }
  strut_status status = strut_json_text_read(line, length, x->line, &request->arena, &tree, &json);
  if (status == STRUT_BAD_SCENE) add_finding(x, request, findings, json.column, json.message);
  if (!status) status = strut_request_choose(request, &x->task->choice, &error);
  if (!status) status = strut_request_read(x->task->file, tree, request, findings);
  if (!status) status = strut_request_setup(x->task->file, request, setup, findings);
  return status;
}

static void answer(exchange *x, const char *line, size_t length) {
  strut_request request;
  strut_setup setup;
  strut_evaluation evaluation;
  strut_request_findings findings = {.file = x->name};
  strut_request_begin(x->task->file, &request);
  strut_status status = read_request(x, line, length, &request, &setup, &findings);
  if (status) {
    refuse(x, &request, status, &findings);
  } else {
    x->status = strut_evaluate(x->task->evaluator, &request.study, &setup, &evaluation);
    if (!x->status) send_evaluation(x, &request, &evaluation);
  }
  strut_request_free(&request);
}

/* ---- streams ---- */

static strut_status open_streams(exchange *x) {
  const strut_arguments *a = x->task->arguments;
  const char *in = strut_option_text(a, STRUT_OPTION_IN);
  const char *out = strut_option_text(a, STRUT_OPTION_OUT);
  bool standard = !in || strcmp(in, "-") == 0;
  x->name = standard ? "<stdin>" : in;
  x->from = standard ? STDIN_FILENO : open(in, O_RDONLY | O_CLOEXEC);
  if (x->from < 0)
    return strut_fail(&x->error, STRUT_FILE_TROUBLE, "cannot open '%s': %s", in, strerror(errno));
  x->text = strut_allocate(MOST_LINE + READ_AT_ONCE + 1, 1);
  if (!x->text) return strut_no_memory(&x->error, "");
  x->to = stdout;
  if (!out || strcmp(out, "-") == 0) return STRUT_OK;
  strut_status status = strut_file_open_path(&x->file, out, &x->error);
  if (!status) x->to = x->file.stream;
  return status;
}

/* A file has the answers so far where the loop was interrupted, and is not there after other trouble. */
static strut_status close_streams(exchange *x) {
  bool keep = !x->status || x->status == STRUT_INTERRUPTED;
  strut_error error = {0};
  if (x->file.stream && keep) {
    strut_status status = strut_file_commit(&x->file, &error);
    if (status) strut_print_error(&error);
    if (status) x->status = status;
  }
  strut_file_abandon(&x->file);
  if (x->from > STDIN_FILENO) close(x->from);
  strut_release(x->text);
  if (x->status) return x->status;
  return x->misunderstood ? STRUT_BAD_SCENE
         : x->failed      ? STRUT_DIVERGED
         : x->inaccurate  ? STRUT_INACCURATE
                          : STRUT_OK;
}

strut_status strut_evaluate_lines(const strut_evaluate_task *task) {
  exchange x = {.task = task};
  char *line;
  size_t length;
  x.status = open_streams(&x);
  while (!x.status && next_line(&x, &line, &length)) answer(&x, line, length);
  if (x.status && x.status != STRUT_INTERRUPTED) strut_print_error(&x.error);
  return close_streams(&x);
}
