/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What draws without computing: the page of a run or a model, and figures of tables. */
#include "parser/program/commands.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "engine/base/memory.h"
#include "engine/output/figures/table_figure.h"
#include "engine/output/file.h"
#include "engine/output/page/page.h"
#include "parser/language/write/write_scene.h"
#include "parser/language/yaml/document.h"
#include "parser/program/command/scene_options.h"

/* A page holds a few million numbers: reading more than 128 MB of motion would be wasted. */
static const size_t ROOM = (size_t)1 << 24;

/* Runs on one page. */
enum { MOST_RUNS = 2 };

enum { SEARCH_ALL, SEARCH_NONE, SEARCH_OF_MODEL };

static const strut_option options[] = {
    STRUT_OUTPUT_OPTION("FILE.html", "the page to write (default RUN.html)"),
    {STRUT_FILLS(equilibria), "equilibria", "WHICH",
     "all or none (default: all of a MODEL, none of a RUN); of two, those of the first",
     .words = "all|none"},
    {STRUT_FILLS(overrides), "set", "NAME=VALUE", "change a parameter of MODEL; may be repeated"},
    {.name = NULL},
};

static bool ends_with(const char *text, const char *end) {
  size_t length = strlen(text), wanted = strlen(end);
  return length > wanted && strcasecmp(text + length - wanted, end) == 0;
}

/* The path of a run or model without slashes at its end; returns its length, or that of the whole. */
static int trim_path(const char *path, char *text, size_t size) {
  size_t length = strlen(path);
  while (length > 1 && path[length - 1] == '/') length--;
  return snprintf(text, size, "%.*s", (int)length, path);
}

/* RUN.html or MODEL.html beside what is shown, in `text`; false where that has no name. */
static bool choose_page(const char *shown, char *text, size_t size) {
  int used = trim_path(shown, text, size);
  const char *slash = strrchr(text, '/'), *name = slash ? slash + 1 : text;
  bool nameless =
      !*name || strcmp(name, "-") == 0 || strcmp(name, ".") == 0 || strcmp(name, "..") == 0;
  if (nameless || used < 0 || (size_t)used + sizeof ".html" > size) return false;
  char *end = text + used;
  if (ends_with(text, ".yaml")) end -= strlen(".yaml");
  if (ends_with(text, ".yml")) end -= strlen(".yml");
  strcpy(end, ".html");
  return true;
}

/* A search that fails leaves a remark on the page; only an interrupt or lack of memory is a failure. */
static strut_status find_equilibria(const strut_arguments *arguments, const strut_opened *opened,
                                    const strut_flag *interrupt, strut_equilibria *all,
                                    strut_error *remark) {
  strut_equilibria_options wanted = {.interrupt = interrupt};
  strut_experiment experiment = opened->setup.experiment;
  strut_progress progress = strut_progress_begin(arguments->quiet);
  experiment.progress = progress.wanted ? strut_progress_show : NULL;
  experiment.progress_context = &progress;
  strut_status status = strut_equilibria_find(opened->model, &experiment, &wanted, all, remark);
  strut_progress_end(&progress);
  return status == STRUT_INTERRUPTED || status == STRUT_NO_MEMORY ? status : STRUT_OK;
}

/* `frames` of each run. */
static void print_written(const strut_arguments *arguments, const strut_page_frames *frames,
                          size_t bytes) {
  if (arguments->quiet) return;
  printf("%s: ", arguments->output);
  for (size_t i = 0; i < arguments->model_count; i++) {
    if (frames[i].shown == 0) continue;
    printf("%s%zu frame%s", i > 0 ? "beside " : "", frames[i].shown,
           frames[i].shown == 1 ? "" : "s");
    if (frames[i].shown < frames[i].recorded)
      printf(", evenly chosen from %zu recorded", frames[i].recorded);
    printf(", ");
  }
  printf("%.1f MB\n", 1e-6 * (double)bytes);
}

static strut_status write_page(const strut_arguments *arguments, const strut_page *page,
                               const strut_flag *interrupt, strut_error *error) {
  strut_page_frames frames[MOST_RUNS] = {0};
  char *html = strut_page_html(page, frames, error);
  if (!html) return error->status;
  strut_status status =
      *interrupt ? strut_fail(error, STRUT_INTERRUPTED, "interrupted; no page was written")
                 : strut_file_write_path(arguments->output, html, error);
  if (status == STRUT_OK) print_written(arguments, frames, strlen(html));
  strut_release(html);
  return status;
}

/* The pages of all runs, the first with what is beside it; their texts are to be released. */
static strut_status describe_pages(const strut_opened *opened, size_t count, strut_page *pages,
                                   char **yaml) {
  for (size_t i = 0; i < count; i++) {
    yaml[i] = strut_setup_write(&opened[i].setup);
    if (!yaml[i]) return STRUT_NO_MEMORY;
    pages[i] = (strut_page){.model = opened[i].model,
                            .experiment = &opened[i].setup.experiment,
                            .motion = opened[i].run ? &opened[i].motion : NULL,
                            .beside = i + 1 < count ? &pages[i + 1] : NULL,
                            .summary = opened[i].summary,
                            .yaml = yaml[i]};
  }
  return STRUT_OK;
}

static strut_status make_page(const strut_arguments *arguments, const strut_opened *opened,
                              int search) {
  strut_equilibria all = {0};
  strut_error error = {0}, remark = {0};
  strut_page pages[MOST_RUNS];
  char *yaml[MOST_RUNS] = {NULL}, labels[MOST_RUNS][PATH_MAX];
  const strut_flag *interrupt = strut_interrupt_watch();
  strut_status status = STRUT_OK;
  if (search == SEARCH_ALL) {
    status = find_equilibria(arguments, opened, interrupt, &all, &remark);
    if (status != STRUT_OK) error = remark;
  }
  if (status == STRUT_OK) {
    status = describe_pages(opened, arguments->model_count, pages, yaml);
    if (status != STRUT_OK) strut_no_memory(&error, "");
  }
  if (status == STRUT_OK) {
    for (size_t i = 0; i < arguments->model_count && arguments->model_count > 1; i++) {
      trim_path(arguments->models[i], labels[i], PATH_MAX); /* tells two runs apart */
      pages[i].label = labels[i];
    }
    if (remark.status == STRUT_OK) pages->equilibria = &all;
    pages->remark = search == SEARCH_NONE ? "No search for equilibria was made." : remark.message;
    status = write_page(arguments, pages, interrupt, &error);
  }
  if (status != STRUT_OK) strut_print_error(&error);
  for (size_t i = 0; i < MOST_RUNS; i++) strut_release(yaml[i]);
  strut_equilibria_free(&all);
  return status;
}

/* Opens what the arguments name, which of several must all be runs; on failure nothing is left to free. */
static strut_status open_all(const strut_arguments *arguments, strut_opened *opened) {
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < arguments->model_count && status == STRUT_OK; i++) {
    strut_arguments one = *arguments;
    one.model = arguments->models[i];
    status = strut_open_run(&one, ROOM, &opened[i]);
    if (status == STRUT_OK && arguments->model_count > 1 && !opened[i].run)
      status = strut_usage_error(
          arguments, "two runs can be shown side by side, but '%s' is a model", one.model);
  }
  for (size_t i = 0; i < MOST_RUNS && status != STRUT_OK; i++) strut_opened_free(&opened[i]);
  return status;
}

static strut_status run_view(const strut_arguments *given) {
  strut_opened opened[MOST_RUNS] = {0};
  strut_arguments with_output = *given, *arguments = &with_output;
  char page[PATH_MAX];
  if (arguments->model_count > MOST_RUNS)
    return strut_usage_error(arguments, "unexpected argument '%s'", arguments->models[MOST_RUNS]);
  if (!arguments->output && choose_page(arguments->model, page, sizeof page))
    arguments->output = page;
  if (!arguments->output) return strut_usage_error(arguments, "missing -o FILE.html");
  int search = arguments->equilibria.text ? arguments->equilibria.index : SEARCH_OF_MODEL;
  if (!ends_with(arguments->output, ".html") && !ends_with(arguments->output, ".htm"))
    return strut_usage_error(arguments, "'%s' is not the name of a page: it must end in .html",
                             arguments->output);
  strut_status status = strut_try_file(arguments->output);
  if (status == STRUT_OK) status = open_all(arguments, opened);
  if (status == STRUT_OK) {
    if (search == SEARCH_OF_MODEL && !opened->run) search = SEARCH_ALL;
    status = make_page(arguments, opened, search);
  }
  for (size_t i = 0; i < MOST_RUNS; i++) strut_opened_free(&opened[i]);
  return status;
}

const strut_command strut_command_view = {
    .name = "view",
    .model = "RUN|MODEL [RUN2]",
    .many = true,
    .summary = "writes an interactive HTML page of a run or model",
    .details =
        "\nRUN is a directory written by 'strut run MODEL -o DIR': the page plays its motion, "
        "with\n"
        "charts, parameters and summary; --equilibria all adds the equilibria as cards. A second\n"
        "run, RUN2, is drawn pale behind the first, its curves dashed, its numbers beside. For a\n"
        "MODEL the page shows the shape at the start and the equilibria. The page is a single "
        "file\n"
        "that works offline; above about 4 MB it keeps an even selection of the frames, and says\n"
        "so. Without -o it is RUN.html or MODEL.html beside the input; a file that strut did not\n"
        "write is never overwritten.\n",
    .options = options,
    .run = run_view,
};

/* ---- `strut plot` ---- */

/* In the order of `draws`. */
static const char kinds[] = "curves|map";

static const strut_option plot_options[] = {
    {STRUT_FILLS(plot), "plot", "FILE", "write the figure into FILE (.svg, .pdf, .png or .json)"},
    {.table = strut_width_options},
    {STRUT_FILLS(kind), "kind", "KIND", "curves (default) or map", .words = kinds},
    {STRUT_FILLS(drawn.x), "x", "COLUMN", "column of the x axis (default: the first)"},
    {STRUT_FILLS(drawn.y), "y", "COLUMN,...", "columns of the y axis (default: the second)"},
    {STRUT_FILLS(drawn.series), "by", "COLUMN", "one curve for each value of the column"},
    {STRUT_FILLS(drawn.panels), "panels", "COLUMN", "one panel for each value of the column"},
    {STRUT_FILLS(drawn.band), "band", "COLUMN=TEXT", "grey background where COLUMN is TEXT"},
    {STRUT_FILLS(drawn.only), "only", "COLUMN=TEXT", "only rows in which COLUMN is TEXT"},
    {STRUT_FILLS(drawn.difference), "difference", "COLUMN",
     "draw the column's second text minus its first; hatch maps where they differ"},
    {STRUT_FILLS(drawn.color), "label", "COLUMN", "values of a map"},
    {STRUT_FILLS(drawn.doubt), "doubt", "COLUMN", "hatch a map where COLUMN is not 0"},
    {STRUT_FILLS(log), "log", "AXES", "logarithmic axes: x, y or xy", .words = "x|y|xy"},
    {STRUT_FILLS(labels), "labels", "TEXT,...", "what the legend calls the curves, in their order"},
    {STRUT_FILLS(title), "title", "TEXT", "title above the figure", .of_figure = true},
    {.table = strut_axis_options},
    {STRUT_FILLS(colors), "colors", "SCALE",
     "colour scale of a map: auto (default), sequential, diverging or grey",
     .words = "auto|sequential|diverging|grey"},
    {.name = NULL},
};

static const char *column_name_at(const void *context, size_t i) {
  const strut_table *table = context;
  return i < table->column_count ? table->columns[i].name : NULL;
}

/* Some row has the text of COLUMN=TEXT. */
static void judge_text(const void *context, size_t i, const strut_figure_key *key, const char *text,
                       char fault[STRUT_MESSAGE_MOST]) {
  const strut_table *table = context;
  const strut_table_column *column = &table->columns[i];
  for (size_t k = 0; k < table->row_count && *key->ends == '='; k++)
    if (strcmp(column->text[k], text) == 0) return;
  if (*key->ends == '=')
    snprintf(fault, STRUT_MESSAGE_MOST, "no row of the table has '%.60s' in column '%.60s'", text,
             column->name);
}

/* Texts with commas between, in the table's arena. */
static strut_status read_labels(const strut_arguments *arguments, strut_table *table,
                                strut_study_figure *figure) {
  const char *at = arguments->labels;
  if (!at) return STRUT_OK;
  figure->labels = strut_arena_allocate(&table->arena, strlen(at) + 1, sizeof *figure->labels);
  for (bool more = figure->labels; more; more = *at++ == ',') {
    const char *label = strut_arena_text(&table->arena, at, strcspn(at, ","));
    if (!label) return strut_print_out_of_memory();
    figure->labels[figure->label_count++] = label;
    at += strlen(label);
  }
  return figure->labels ? STRUT_OK : strut_print_out_of_memory();
}

/* What the options choose of the table. */
static strut_status read_figure(const strut_arguments *arguments, strut_table *table,
                                strut_study_figure *figure) {
  const strut_table_column *columns = table->columns;
  const strut_figure_columns names = {"the table", column_name_at, judge_text, table};
  char fault[STRUT_MESSAGE_MOST];
  bool map = arguments->kind.index == 1;
  *figure = arguments->drawn;
  figure->kind = map ? STRUT_FIGURE_MAP : STRUT_FIGURE_LINES;
  figure->colours = (strut_study_colours)arguments->colors.index;
  if (!figure->x) figure->x = columns[0].name;
  if (!figure->y) figure->y = columns[table->column_count > 1 ? 1 : 0].name;
  if (!figure->color && map && table->column_count > 2) figure->color = columns[2].name;
  const strut_figure_key *wrong = strut_figure_fault(figure, &names, fault);
  if (wrong) return strut_usage_error(arguments, "--%s: %s", wrong->option, fault);
  if (map && !figure->color) return strut_usage_error(arguments, "a map needs a third column");
  return read_labels(arguments, table, figure);
}

/* Refuses options that belong to the other kind of diagram. */
static strut_status check_kind(const strut_arguments *arguments) {
  const bool map = arguments->kind.index == 1;
  const strut_study_figure *drawn = &arguments->drawn;
  const struct {
    const char *option, *text;
    bool map;
  } own[] = {{"by", drawn->series, false},
             {"band", drawn->band, false},
             {"labels", arguments->labels, false},
             {"log", arguments->log.text, false},
             {"label", drawn->color, true},
             {"doubt", drawn->doubt, true},
             {"colors", arguments->colors.text, true}};
  for (size_t i = 0; i < sizeof own / sizeof *own; i++)
    if (own[i].text && own[i].map != map)
      return strut_usage_error(arguments, "--kind %s has no option --%s", map ? "map" : "curves",
                               own[i].option);
  return STRUT_OK;
}

static strut_status run_plot(const strut_arguments *arguments) {
  strut_plot plot;
  strut_table table;
  strut_study_figure figure;
  strut_error error = {0};
  strut_status status = check_kind(arguments);
  if (status == STRUT_OK) status = strut_plot_read(arguments, 0, &plot);
  if (status != STRUT_OK) return status;
  if (!plot.path) return strut_usage_error(arguments, "missing --plot FILE");
  status = strut_table_read(arguments->listener, arguments->model, &table);
  if (status != STRUT_OK) return status;
  status = read_figure(arguments, &table, &figure);
  if (!status) status = strut_table_draw(&plot, &figure, &table, false, &error);
  if (error.message[0]) strut_print_error(&error);
  strut_arena_free(&table.arena);
  return status;
}

const strut_command strut_command_plot = {
    .name = "plot",
    .model = "TABLE",
    .summary = "draws curves or a map from a table",
    .details =
        "\nTABLE is a CSV file with a header such as \"frequency [Hz],velocity [m/s],start\", as\n"
        "strut writes it, or - for the standard input. Units get prefixes, curves differ\n"
        "by colour, dashes and markers, and cells without a number break a curve.\n",
    .options = plot_options,
    .run = run_plot,
};
