/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `strut sweep --requests`: requests by the files of DAKOTA, or line by line, and the command. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/select.h>
#include <unistd.h>

#include "engine/base/number_text.h"
#include "engine/output/buffer.h"
#include "engine/output/file.h"
#include "engine/output/json_value.h"
#include "engine/study/sweep/evaluation.h"
#include "parser/command/arguments.h"
#include "parser/command/run_settings.h"
#include "parser/program/commands.h"
#include "parser/program/options.h"
#include "parser/program/streams.h"
#include "parser/program/sweep.h"
#include "parser/study/study_request.h"
#include "parser/yaml/text.h"

/** What all evaluations of a process have in common. */
typedef struct strut_evaluate_task {
  const strut_arguments *arguments;
  const strut_study_file *file;
  strut_request_choice choice; /* of the command line */
  strut_evaluator *evaluator;
  const strut_flag *interrupt;
} strut_evaluate_task;

enum { MOST_MESSAGES = 50 };

/* The result of a function: the one of its name, or the only number where there is one of each. */
static const strut_evaluated *find_result(const strut_evaluation *evaluation,
                                          const strut_dakota_file *file, size_t function) {
  const strut_evaluated *only = NULL;
  size_t numbers = 0;
  for (size_t i = 0; i < evaluation->count; i++) {
    const strut_evaluated *r = &evaluation->results[i];
    if (r->word) continue;
    if (strcmp(r->name, file->functions[function].name) == 0) return r;
    if (strcmp(r->name, STRUT_KEPT_COLUMN) == 0) continue; /* it is there without being asked for */
    only = r;
    numbers++;
  }
  return numbers == 1 && file->function_count == 1 ? only : NULL;
}

static strut_status refuse_function(const strut_evaluation *evaluation,
                                    const strut_dakota_function *f, const char *path) {
  char names[300] = "";
  size_t used = 0;
  for (size_t i = 0; i < evaluation->count && used < sizeof names - 1; i++) {
    if (evaluation->results[i].word) continue;
    int n = snprintf(names + used, sizeof names - used, "%s%s", used ? ", " : "",
                     evaluation->results[i].name);
    used += n > 0 ? (size_t)n : 0;
  }
  fprintf(stderr,
          "strut: error: %s:%u:%u: the response '%s' is no result: say response_descriptors of "
          "these to DAKOTA, or choose others by --keep: %s\n",
          path, f->place.line, f->place.column, f->name, names);
  return STRUT_BAD_SCENE;
}

/* A line for each value that is wanted. STRUT_DIVERGED: one is missing. */
static strut_status list_values(const strut_evaluation *evaluation, const strut_dakota_file *file,
                                const char *path, strut_buffer *text) {
  for (size_t i = 0; i < file->function_count; i++) {
    const strut_dakota_function *f = &file->functions[i];
    const strut_evaluated *r = find_result(evaluation, file, i);
    char number[STRUT_NUMBER_TEXT];
    if (!r) return refuse_function(evaluation, f, path);
    if (!(f->wanted & 1)) continue;
    if (r->number != r->number) {
      fprintf(stderr, "strut: this evaluation has no '%s'\n", r->name);
      return STRUT_DIVERGED;
    }
    strut_number_text(r->number, number);
    strut_buffer_add(text, "%s %s\n", number, *f->name ? f->name : r->name);
  }
  return STRUT_OK;
}

/* What the results file says: values, or FAIL, after which DAKOTA continues as its input says. */
static strut_status write_results(strut_status status, strut_buffer *text, const char *results) {
  strut_error error = {0};
  if (status == STRUT_DIVERGED) {
    strut_release(strut_buffer_take(text));
    strut_buffer_add(text, "FAIL\n");
    status = STRUT_OK;
  }
  strut_buffer_add(text, "%s", ""); /* a text even where no value is wanted */
  char *whole = strut_buffer_take(text);
  if (!status && !whole) status = strut_print_out_of_memory();
  if (!status) status = strut_print_failure(strut_file_write_path(results, whole, &error), &error);
  strut_release(whole);
  return status;
}

static strut_status compute(const strut_evaluate_task *task, const strut_dakota_file *file,
                            strut_request *request, strut_setup *setup, const char *path,
                            strut_buffer *text) {
  strut_evaluation evaluation;
  strut_status status = strut_evaluate(task->evaluator, &request->study, setup, &evaluation);
  if (status) return status;
  for (size_t i = 0; i < evaluation.warning_count; i++)
    fprintf(stderr, "strut: warning: %s\n", evaluation.warnings[i]);
  if (!evaluation.status) return list_values(&evaluation, file, path, text);
  fprintf(stderr, "strut: %s\n", evaluation.message);
  return STRUT_DIVERGED;
}

static void print_findings(strut_diagnostics *diagnostics, const strut_request_findings *findings) {
  const char *messages =
      diagnostics->count ? strut_diagnostics_render(diagnostics, MOST_MESSAGES) : "";
  if (messages) fputs(messages, stderr);
  for (size_t i = 0; i < findings->count && i < STRUT_REQUEST_FINDINGS; i++)
    fprintf(stderr, "strut: error: %s\n", findings->text[i]);
}

/* Answers one parameters file with a results file. Messages go to stderr. */
static strut_status strut_evaluate_dakota(const strut_evaluate_task *task, const char *parameters,
                                          const char *results) {
  char *text = NULL;
  size_t length = 0;
  strut_error error = {0};
  strut_diagnostics diagnostics = {0};
  strut_dakota_file file = {0};
  strut_request request;
  strut_setup setup;
  strut_buffer values = {0};
  strut_request_findings findings = {.file = parameters};
  strut_request_begin(task->file, &request);
  strut_status status = strut_file_read(parameters, &text, &length, &error);
  strut_print_failure(status, &error);
  if (!status) {
    strut_diagnostics_source(&diagnostics, parameters, text, length);
    status = strut_request_choose(&request, &task->choice, &error);
    if (!status) status = strut_dakota_read(text, length, &diagnostics, &file);
    if (!status) status = strut_dakota_request(task->file, &file, &request, &diagnostics);
    if (!status) status = strut_request_setup(task->file, &request, &setup, &findings);
    print_findings(&diagnostics, &findings);
    if (status == STRUT_NO_MEMORY) strut_print_out_of_memory();
    if (!status)
      status = compute(task, &file, &request, &setup, parameters, &values);
    else if (status == STRUT_BAD_SCENE && findings.count > 0)
      status = STRUT_DIVERGED; /* values */
    status = write_results(status, &values, results);
  }
  strut_request_free(&request);
  strut_dakota_free(&file);
  strut_diagnostics_free(&diagnostics);
  strut_release(text);
  return status;
}

/* Requests as lines of JSON, each answered as soon as it is read. */

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
  const char *in = strut_option_text(a, STRUT_OPTION_REQUESTS);
  const char *out = strut_option_text(a, STRUT_OPTION_ANSWERS);
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

/* Answers every line. Messages about streams go to stderr. */
static strut_status strut_evaluate_lines(const strut_evaluate_task *task) {
  exchange x = {.task = task};
  char *line;
  size_t length;
  x.status = open_streams(&x);
  while (!x.status && next_line(&x, &line, &length)) answer(&x, line, length);
  if (x.status && x.status != STRUT_INTERRUPTED) strut_print_error(&x.error);
  return close_streams(&x);
}

enum { EVALUATE_MOST_MESSAGES = 50, MOST_THREADS = 4096 };

static const strut_option options[] = {
    {STRUT_OPTION_REQUESTS, "requests", "FILE", "read requests from FILE, - for standard input"},
    {STRUT_OPTION_COMPUTE, "compute", "WHAT",
     "run (default), equilibria, modes, rigidity, path or form"},
    {STRUT_OPTION_KEEP, "keep", "WORD,...", "which results, as 'keep' of a study"},
    {STRUT_OPTION_AT, "at", "NAME", "the equilibrium of modes, rigidity or path"},
    {STRUT_OPTION_ANSWERS, "answers", "FILE", "write answers to FILE (default: standard output)"},
    {STRUT_OPTION_DAKOTA, "dakota", NULL,
     "read DAKOTA's PARAMETERS file and write its RESULTS file"},
    {STRUT_OPTION_THREADS, "threads", "N", "number of threads of a search (default 1)"},
    STRUT_RUN_SETTING_OPTIONS,
    STRUT_SET_OPTION,
    {STRUT_OPTION_COUNT_POINTS, "count", NULL, "only print the names and units of the results"},
    {STRUT_OPTION_JSON, "json", NULL, "with --count: print one JSON object"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_status check_arguments(const strut_arguments *a) {
  const strut_command *command = &strut_command_requests;
  const char *in = strut_option_text(a, STRUT_OPTION_REQUESTS);
  bool files = in || strut_option_text(a, STRUT_OPTION_ANSWERS);
  if (a->json && !a->count_points)
    return strut_print_usage_error(command, "--json is for --count: answers are JSON anyway");
  bool answers = strut_option_text(a, STRUT_OPTION_ANSWERS);
  if (a->count_points && (a->dakota || answers || a->model_count > 1))
    return strut_print_usage_error(command, "--count computes nothing: it goes with a model alone");
  if (a->dakota && files)
    return strut_print_usage_error(
        command, "--dakota names its files itself: omit --requests and --answers");
  if (a->dakota && a->model_count != 3)
    return strut_print_usage_error(
        command, "--dakota expects MODEL PARAMETERS RESULTS, found %zu arguments", a->model_count);
  if (!a->dakota && a->model_count > 1)
    return strut_print_usage_error(command, "unexpected argument '%s'", a->models[1]);
  bool same = strcmp(a->model, "-") == 0 &&
              (a->dakota ? strcmp(a->models[1], "-") == 0 : !in || strcmp(in, "-") == 0);
  if (same && !a->count_points)
    return strut_print_usage_error(command,
                                   "model and requests cannot both come from standard input");
  return STRUT_OK;
}

static strut_status report(strut_study_file *file, strut_status status, strut_error *error) {
  if (status == STRUT_BAD_SCENE && !error->message[0]) {
    const char *messages = strut_study_messages(file, EVALUATE_MOST_MESSAGES);
    if (!messages) return strut_print_out_of_memory();
    fputs(messages, stderr);
  } else if (status) {
    if (!error->message[0]) strut_fail(error, status, "%s", strut_status_text(status));
    strut_print_error(error);
  }
  return status;
}

/* The model must make a scene without a request, and give what is to be kept. */
static strut_status try_model(const strut_evaluate_task *task, strut_study_file *file) {
  strut_error error = {0};
  strut_setup setup;
  strut_request request;
  strut_request_findings findings = {.file = "--keep"};
  strut_request_begin(file, &request);
  strut_status status = strut_request_choose(&request, &task->choice, &error);
  if (status) {
    strut_print_usage_error(&strut_command_requests, "%s", error.message);
    strut_request_free(&request);
    return STRUT_USAGE;
  }
  status = strut_request_setup(file, &request, &setup, &findings);
  if (!status) strut_setup_free(&setup);
  for (size_t i = 0; i < findings.count && i < STRUT_REQUEST_FINDINGS; i++)
    fprintf(stderr, "strut: error: %s\n", findings.text[i]);
  if (status == STRUT_NO_MEMORY) strut_print_out_of_memory();
  strut_request_free(&request);
  return status;
}

static strut_status give_setup(void *context, const strut_study_value *values, strut_setup *setup,
                               strut_error *error) {
  const strut_evaluate_task *task = context;
  strut_request request;
  strut_request_findings findings = {.file = ""};
  (void)values;
  strut_request_begin(task->file, &request);
  strut_status status = strut_request_choose(&request, &task->choice, error);
  if (!status) status = strut_request_setup(task->file, &request, setup, &findings);
  strut_request_free(&request);
  return status;
}

/* The results with their units: a line each, or a list of objects. */
static strut_status print_results(const strut_sweep_plan *plan, bool as_json) {
  strut_json json = strut_json_begin();
  struct cJSON *list = strut_json_array(&json, json.root, "results");
  for (size_t i = 0; i < plan->column_count; i++) {
    const strut_slot_column *c = &plan->columns[i];
    bool plain = c->word || !*c->unit || strcmp(c->unit, "1") == 0;
    struct cJSON *item = strut_json_object(&json, list, NULL);
    strut_json_text(&json, item, "name", c->name);
    strut_json_text(&json, item, "unit", plain ? "1" : c->unit);
    strut_json_bool(&json, item, "text", c->word);
    if (!as_json && plain) printf("%s\n", c->name);
    if (!as_json && !plain) printf("%s [%s]\n", c->name, c->unit);
  }
  char *text = strut_json_end(&json);
  if (as_json) return strut_print_block(text);
  strut_release(text);
  return STRUT_OK;
}

static strut_status print_columns(strut_evaluate_task *task) {
  strut_error error = {0};
  strut_request request;
  strut_sweep_plan plan = {0};
  const strut_sweep_scenes scenes = {.setup = give_setup, .context = task};
  strut_request_begin(task->file, &request);
  strut_status status = strut_request_choose(&request, &task->choice, &error);
  if (!status) status = strut_sweep_plan_make(&request.study, &scenes, &plan, &error);
  if (!status) status = print_results(&plan, task->arguments->json);
  if (status) strut_print_error(&error);
  strut_sweep_plan_free(&plan);
  strut_request_free(&request);
  return status;
}

static strut_status evaluate(strut_evaluate_task *task) {
  const strut_arguments *a = task->arguments;
  int64_t threads = 1;
  strut_status early = strut_option_integer(&strut_command_requests, a, STRUT_OPTION_THREADS, 1,
                                            MOST_THREADS, &threads);
  if (early) return early;
  if (a->count_points) return print_columns(task);
  task->interrupt = strut_interrupt_watch();
  task->evaluator = strut_evaluator_create(task->interrupt, (int)threads);
  if (!task->evaluator) return strut_print_out_of_memory();
  strut_status status = a->dakota ? strut_evaluate_dakota(task, a->models[1], a->models[2])
                                  : strut_evaluate_lines(task);
  strut_evaluator_free(task->evaluator);
  return status;
}

static strut_status run_evaluate(const strut_arguments *arguments) {
  strut_error error = {0};
  strut_study_file file = {0};
  strut_evaluate_task task = {
      .arguments = arguments,
      .file = &file,
      .choice = {.compute = strut_option_text(arguments, STRUT_OPTION_COMPUTE),
                 .keep = strut_option_text(arguments, STRUT_OPTION_KEEP),
                 .at = strut_option_text(arguments, STRUT_OPTION_AT)}};
  strut_status status = check_arguments(arguments);
  if (status) return status;
  status = strut_study_open_either(arguments->model, arguments->overrides,
                                   arguments->override_count, &file, &error);
  report(&file, status, &error);
  if (!status) status = strut_sweep_adjust(&strut_command_requests, arguments, &file);
  if (!status) status = try_model(&task, &file);
  if (!status) status = evaluate(&task);
  strut_study_close(&file);
  return status;
}

const strut_command strut_command_requests = {
    .name = "sweep --requests",
    .model = "MODEL|STUDY",
    .many = true,
    .summary = "answers requests, each a set of parameters, in one process",
    .details =
        "\nEach line is a request in JSON, such as {\"friction\": 0.2}, or\n"
        "{\"id\": 7, \"set\": {\"friction\": 0.2, \"frequency\": \"12 Hz\"}, \"keep\": "
        "[\"velocity\"]} with\n"
        "compute, keep, at and variant as choices. Numbers are in SI. Each gets one line with "
        "code,\n"
        "status, and results or message, at once and in order; a failure does not end the loop.\n"
        "The axes of a STUDY do not matter; its other keys do.\n"
        "With --dakota, after MODEL: PARAMETERS RESULTS, as DAKOTA calls a driver. The response\n"
        "descriptors name the results; a failed point is written as FAIL.\n"
        "\nExit code: 2 if a request could not be understood, else 3 if one failed, else 5 if one "
        "is\n"
        "less accurate than requested, which its result accuracy_kept says, else 0;\n"
        "with --dakota 0 where RESULTS says FAIL.\n",
    .options = options,
    .run = run_evaluate,
};
