/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures as SVG and pages as HTML, in memory. */
#include "parser/bindings/abi/handles.h"

#include "engine/model/state.h"
#include "engine/output/draw/figure.h"
#include "engine/output/page/page.h"
#include "parser/language/write/write_scene.h"
#include "parser/program/command/scene_options.h"

static const strut_option svg_options[] = {{.table = strut_plot_setting_options},
                                           {.table = strut_run_figure_options},
                                           {.table = strut_axis_options},
                                           {.name = NULL}};
const strut_command abi_svg_command = {.name = "svg", .options = svg_options};

strut_status abi_plot_read(const strut_arguments *arguments, const char *path, strut_plot *plot) {
  *plot = (strut_plot){.path = path};
  return strut_plot_settings_read(arguments, 0, plot);
}

/* ---- figures ---- */

static const char figure_name[] = "figure.svg";
static const char *const files[] = {figure_name, NULL};

/* The figure that `status` says was drawn as a file, or NULL with the error; its folder goes. */
static char *take_figure(const abi_scratch *self, strut_status status, strut_error *what) {
  char *text = status == STRUT_OK ? abi_scratch_read(self, figure_name, what) : NULL;
  if (status != STRUT_OK) what->status = status;
  abi_scratch_end(self, files);
  return text;
}

static char *draw_result(const strutlib_result *result, abi_call *call) {
  abi_scratch scratch;
  if (!result->draw) {
    strut_fail(&call->what, STRUT_USAGE, "there is no figure of %s", result->command->name);
    return NULL;
  }
  if (abi_scratch_begin(&scratch, figure_name, &call->what) != STRUT_OK) return NULL;
  strut_status status = result->draw(result, &call->arguments, scratch.path, &call->what);
  return take_figure(&scratch, status, &call->what);
}

char *strutlib_result_svg(const strutlib_result *result, size_t count, const char *const *names,
                          const char *const *values, strutlib_error **error) {
  /* There is a figure: options that belong to one are in their place. */
  abi_call call = {.arguments.command = &abi_svg_command, .error = error};
  char *text = NULL;
  if (abi_lacks(error, result, "result")) return NULL;
  abi_enter(error);
  strut_status status = abi_call_begin(&call, &(abi_pairs){count, names, values});
  if (status == STRUT_OK && !(text = draw_result(result, &call))) status = call.what.status;
  abi_call_leave(&call, status);
  abi_messages_free(&call.messages);
  return text;
}

enum { WIDTH = 510, MARGIN = 24 }; /* [pt] of a drawing */

/* The structure at the start. */
static strut_status draw_start(const strut_model *model, const char *path, strut_error *what) {
  strut_state *state = NULL;
  strut_status status = strut_state_create(model, &state, what);
  if (status != STRUT_OK) return status;
  strut_shape shape = {
      .model = model, .q = state->q, .style.member_names = true, .ground = true, .names = true};
  strut_panel panel = {.shape_count = 1, .shapes = &shape, .margin = MARGIN};
  status =
      strut_figure_draw(&(strut_plot){.path = path, .width = WIDTH},
                        &(strut_figure){.panel_count = 1, .panels = &panel, .aspect = 1.2}, what);
  strut_state_free(state);
  return status;
}

char *strutlib_scene_svg(const strutlib_scene *scene, strutlib_error **error) {
  strut_model *model = NULL;
  strut_error what = {0};
  abi_scratch scratch;
  char *text = NULL;
  if (abi_lacks(error, scene, "scene")) return NULL;
  abi_enter(error);
  strut_status status = strut_model_compile(&scene->setup.scene, &model, &what);
  if (status == STRUT_OK) status = abi_scratch_begin(&scratch, figure_name, &what);
  if (status == STRUT_OK)
    text = take_figure(&scratch, draw_start(model, scratch.path, &what), &what);
  strut_model_free(model);
  return abi_leave_text(error, text, &what);
}

/* ---- pages and their data ---- */

/* strut_page_html or strut_page_data. */
typedef char *page_writer(const strut_page *page, strut_page_frames *frames, strut_error *error);

static char *write_page(strut_page *page, const strut_setup *setup, page_writer *writer,
                        strut_error *what) {
  char *yaml = strut_setup_write(setup);
  page->yaml = yaml;
  page->experiment = &setup->experiment;
  char *text = yaml ? writer(page, NULL, what) : NULL;
  strut_release(yaml);
  return text;
}

/* `still`: a result without motion and equilibria shows its structure, if it has a model. */
static char *result_page(const strutlib_result *result, bool still, page_writer *writer,
                         strutlib_error **error) {
  strut_error what = {0};
  char *text = NULL;
  if (abi_lacks(error, result, "result")) return NULL;
  abi_enter(error);
  strut_page page = {.model = result->model,
                     .motion = abi_result_motion(result),
                     .equilibria = abi_result_equilibria(result)};
  if (page.motion) page.summary = result->json;
  if (!page.equilibria) page.remark = "No search for equilibria was made.";
  if (page.motion && !page.motion->position) page.motion = NULL;
  if (page.motion || page.equilibria || (still && page.model))
    text = write_page(&page, &result->setup, writer, &what);
  else
    strut_fail(&what, STRUT_USAGE, "there is no page of %s without a recorded motion",
               result->command->name);
  return abi_leave_text(error, text, &what);
}

/* With the equilibria, or a remark where they were not searched or cannot be found. */
static char *scene_page(const strutlib_scene *scene, bool search, const strutlib_control *control,
                        page_writer *writer, strutlib_error **error) {
  const strut_equilibria_options options = {.interrupt = abi_interrupt_of(control)};
  strut_model *model = NULL;
  strut_equilibria all = {0};
  strut_setup setup;
  strut_error what = {0}, remark = {.message = "No search for equilibria was made."};
  char *text = NULL;
  if (abi_lacks(error, scene, "scene")) return NULL;
  abi_enter(error);
  if (abi_setup(scene, STRUT_FOR_ANY_STATICS, &setup, error) != STRUT_OK)
    return abi_leave_text(error, NULL, NULL);
  strut_status status = strut_resolve_start_equilibrium(&setup, &what), found = STRUT_OK;
  if (status == STRUT_OK) status = strut_model_compile(&setup.scene, &model, &what);
  if (status == STRUT_OK && search)
    found = strut_equilibria_find(model, &setup.experiment, &options, &all, &remark);
  if (found == STRUT_INTERRUPTED || found == STRUT_NO_MEMORY)
    what = remark, what.status = status = found;
  strut_page page = {.model = model, .remark = remark.message};
  if (search && found == STRUT_OK) page.equilibria = &all, page.remark = NULL;
  if (status == STRUT_OK) text = write_page(&page, &setup, writer, &what);
  strut_equilibria_free(&all);
  strut_model_free(model);
  strut_setup_free(&setup);
  return abi_leave_text(error, text, &what);
}

#define PAGES(WORD, STILL, WRITER)                                                                 \
  char *strutlib_result_##WORD(const strutlib_result *result, strutlib_error **error) {            \
    return result_page(result, STILL, WRITER, error);                                              \
  }                                                                                                \
  char *strutlib_scene_##WORD(const strutlib_scene *scene, int equilibria,                         \
                              strutlib_control *control, strutlib_error **error) {                 \
    return scene_page(scene, equilibria != 0, control, WRITER, error);                             \
  }
PAGES(html, false, strut_page_html)
PAGES(page_data, true, strut_page_data)
