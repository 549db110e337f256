/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/command_view.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "engine/output/page/page.h"
#include "parser/cli/interrupt.h"
#include "parser/cli/open_run.h"
#include "parser/cli/option_values.h"
#include "parser/cli/streams.h"
#include "parser/write/write_scene.h"

/* A page holds a few million numbers, so that more than this need not be read: 128 MB. */
static const size_t ROOM = (size_t)1 << 24;

static const char *const searches[] = {"all", "none", NULL};
enum { SEARCH_ALL, SEARCH_NONE };

static const strut_option options[] = {
    {STRUT_OPTION_OUTPUT, "output", "FILE", "the page: FILE ends with .html"},
    {STRUT_OPTION_EQUILIBRIA, "equilibria", "WHICH", "all shapes at rest, or none"},
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "give a model's parameter another value"},
    {STRUT_OPTION_QUIET, "quiet", NULL, "do not say what was written"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static bool ends_with(const char *text, const char *end) {
  size_t length = strlen(text), wanted = strlen(end);
  return length > wanted && strcasecmp(text + length - wanted, end) == 0;
}

/* Before anything is computed: a name for a page, and a place where it can be written. */
static strut_status check_output(const strut_arguments *arguments) {
  const char *path = arguments->output;
  if (!path) {
    fprintf(stderr, "strut view: where to? give -o FILE.html\n");
    return STRUT_USAGE;
  }
  if (!ends_with(path, ".html") && !ends_with(path, ".htm")) {
    fprintf(stderr, "strut view: '%s' is no name for a page: it ends with .html\n", path);
    return STRUT_USAGE;
  }
  return strut_try_file(path);
}

/* A search that finds nothing, or cannot, is no reason to have no page: the page says why. Only an
   interrupt and the lack of memory are failures. */
static strut_status find_equilibria(const strut_opened *opened, int search,
                                    const volatile sig_atomic_t *interrupt, strut_equilibria *all,
                                    strut_error *remark) {
  strut_equilibria_options wanted = {.interrupt = interrupt};
  if (search == SEARCH_NONE) return STRUT_OK;
  strut_status status =
      strut_equilibria_find(opened->model, &opened->setup.experiment, &wanted, all, remark);
  return status == STRUT_INTERRUPTED || status == STRUT_NO_MEMORY ? status : STRUT_OK;
}

static void say(const strut_arguments *arguments, const strut_page_frames *frames, size_t bytes) {
  if (arguments->quiet) return;
  printf("%s: ", arguments->output);
  if (frames->shown > 0) printf("%zu frame%s, ", frames->shown, frames->shown == 1 ? "" : "s");
  if (frames->shown > 0 && frames->shown < frames->recorded)
    printf("evenly of %zu recorded, ", frames->recorded);
  printf("%.1f MB\n", 1e-6 * (double)bytes);
}

static strut_status write_page(const strut_arguments *arguments, const strut_page *page,
                               const volatile sig_atomic_t *interrupt, strut_error *error) {
  strut_page_frames frames;
  char *html = strut_page_html(page, &frames, error);
  if (!html) return error->status;
  strut_status status = *interrupt
                            ? strut_fail(error, STRUT_INTERRUPTED, "interrupted; there is no page")
                            : strut_file_write_path(arguments->output, html, error);
  if (status == STRUT_OK) say(arguments, &frames, strlen(html));
  strut_release(html);
  return status;
}

static strut_status show(const strut_arguments *arguments, const strut_opened *opened, int search) {
  strut_equilibria all = {0};
  strut_error error = {0}, remark = {0};
  char *yaml = NULL;
  const volatile sig_atomic_t *interrupt = strut_interrupt_watch();
  strut_status status = find_equilibria(opened, search, interrupt, &all, &remark);
  if (status != STRUT_OK) error = remark;
  if (status == STRUT_OK) {
    yaml = strut_setup_write(&opened->setup);
    if (!yaml) status = strut_fail(&error, STRUT_NO_MEMORY, "out of memory");
  }
  if (status == STRUT_OK) {
    strut_page page = {.model = opened->model,
                       .experiment = &opened->setup.experiment,
                       .motion = opened->run ? &opened->motion : NULL,
                       .equilibria = remark.status == STRUT_OK ? &all : NULL,
                       .remark = search == SEARCH_NONE ? "not looked for" : remark.message,
                       .summary = opened->summary,
                       .yaml = yaml};
    status = write_page(arguments, &page, interrupt, &error);
  }
  if (status != STRUT_OK) strut_print_error(&error);
  strut_release(yaml);
  strut_equilibria_free(&all);
  return status;
}

static strut_status run(const strut_arguments *arguments) {
  strut_opened opened = {0};
  int search = SEARCH_ALL;
  strut_status status =
      strut_option_word(&strut_command_view, arguments, STRUT_OPTION_EQUILIBRIA, searches, &search);
  if (status == STRUT_OK) status = check_output(arguments);
  if (status == STRUT_OK)
    status = strut_open_run(&strut_command_view, arguments, STRUT_OPEN_AS_RUN, ROOM, &opened);
  if (status != STRUT_OK) return status;
  status = show(arguments, &opened, search);
  strut_opened_free(&opened);
  return status;
}

const strut_command strut_command_view = {
    .name = "view",
    .model = "RUN|MODEL",
    .summary = "makes a page to play a run on, for any browser",
    .details =
        "\nRUN is a directory that 'strut run MODEL -o DIR' made: the page plays its motion,\n"
        "with charts. Of a MODEL it shows the shape at the start. Both come with the shapes at\n"
        "rest as cards and with the scene's text. The page is one file that needs no network;\n"
        "frames are left out evenly where it would be larger than about 4 MB, and it says so.\n",
    .options = options,
    .run = run,
};
