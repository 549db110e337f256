/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/elements.h"
#include "engine/output/figures/statics_figures.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/memory.h"
#include "engine/base/vec.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/draw/chart.h"
#include "engine/output/draw/legend.h"
#include "engine/output/draw/structure.h"

enum { NAMED = 12, LED = 200, TITLE = 200 }; /* nodes with names, nodes with arrows; bytes */

static const double GAP = 12.0, EDGE = 4.0, MARGIN = 13.0; /* [pt] */
static const double NARROWEST = 112.0;                     /* panel, for its title [pt] */
static const double TALLEST = 190.0;                       /* drawing inside a panel [pt] */
static const double COVERED = 0.12;                        /* of a panel, by names */
static const double NODE = 2.3;                            /* radius of a node as drawn [pt] */
static const double TITLE_LINE = 11.5, WORD_LINES = 19.0;
static const double UNSTRAINED = 1e-9; /* strain by rounding, relative to displacement over size */

typedef struct figure {
  strut_canvas *canvas;
  const strut_model *model;
  const strut_modes *modes;
  size_t count, columns, rows;
  size_t shown[STRUT_MODES_FIGURE_MOST]; /* indices of modes */
  double *moved;                         /* (length) the shape displaced along the mode [m] */
  double *strain, *taut;                 /* (members); taut: 0 where a cable is slack at rest */
  double size;                           /* larger extent of the shape at rest [m] */
  strut_bounds bounds[STRUT_MODES_FIGURE_MOST], all; /* of the panels, and of all together */
  double head, scale, panel_width;                   /* [pt], [pt/m] */
  strut_arena arena;
} figure;

static bool allocate_arrays(figure *f) {
  size_t length = (size_t)f->model->length, members = f->model->scene->member_count + 1;
  f->moved = strut_arena_allocate(&f->arena, length, sizeof(double));
  f->strain = strut_arena_allocate(&f->arena, members, sizeof(double));
  f->taut = strut_arena_allocate(&f->arena, members, sizeof(double));
  return f->moved && f->strain && f->taut;
}

/* Chooses the modes with panels: rigid-body motions only if there are no others. */
static void choose_modes(figure *f, size_t panels) {
  size_t others = 0, most = panels ? panels : STRUT_MODES_FIGURE_PANELS;
  if (most > STRUT_MODES_FIGURE_MOST) most = STRUT_MODES_FIGURE_MOST;
  for (size_t i = 0; i < f->modes->count; i++) others += f->modes->list[i].kind != STRUT_MODE_RIGID;
  for (size_t i = 0; i < f->modes->count && f->count < most; i++)
    if (!others || f->modes->list[i].kind != STRUT_MODE_RIGID) f->shown[f->count++] = i;
}

/* Displaces the shape at rest along a mode, to the amplitude that is drawn. */
static void displace(figure *f, const strut_mode *mode) {
  const double *q = f->modes->q;
  double most = 0.0;
  for (int32_t i = 0; i < f->model->node_count; i++)
    most = fmax(most, hypot(mode->shape[2 * i], mode->shape[2 * i + 1]));
  double scale = most > 0 ? STRUT_MODES_FIGURE_SWING * f->size / most : 0.0;
  for (int32_t i = 0; i < f->model->length; i++) {
    f->moved[i] = q[i] + scale * mode->shape[i];
  }
}

/* Strains of all members by the displacement drawn, to first order; returns the largest. */
static double compute_strains(figure *f) {
  const double *q = f->modes->q;
  double largest = 0.0;
  for (size_t j = 0; j < f->model->scene->member_count; j++) {
    const strut_member *m = &f->model->scene->members[j];
    double change = 0.0, length = 0.0;
    for (size_t k = 0; k <= m->guide_count; k++) {
      int32_t a = strut_member_node(m, k), b = strut_member_node(m, k + 1);
      double along[2], part, own = 0.0;
      for (int d = 0; d < 2; d++) {
        along[d] = q[2 * b + d] - q[2 * a + d];
        own += along[d] * (f->moved[2 * b + d] - q[2 * b + d] - f->moved[2 * a + d] + q[2 * a + d]);
      }
      length += part = hypot(along[0], along[1]);
      change += part > 0 ? own / part : 0.0;
    }
    f->strain[j] = length > 0 ? change / length : 0.0;
    largest = fmax(largest, fabs(f->strain[j]));
  }
  return largest > UNSTRAINED ? largest : 0.0;
}

static void find_taut(figure *f) {
  const double *q = f->modes->q;
  for (size_t j = 0; j < f->model->scene->member_count; j++) {
    const strut_member *m = &f->model->scene->members[j];
    bool slack = m->kind == STRUT_CABLE && strut_member_path_length(f->model, (int32_t)j, q) <=
                                               f->model->members.rest[j] * (1 - 1e-12);
    f->taut[j] = slack ? 0.0 : 1.0;
  }
}

static void find_bounds(figure *f) {
  f->all = strut_bounds_none();
  strut_bounds_add(&f->all, f->model, f->modes->q);
  f->size = fmax(f->all.high[0] - f->all.low[0], f->all.high[1] - f->all.low[1]);
  if (!(f->size > 0)) f->size = f->model->size;
  for (size_t k = 0; k < f->count; k++) {
    f->bounds[k] = strut_bounds_none();
    strut_bounds_add(&f->bounds[k], f->model, f->modes->q);
    displace(f, &f->modes->list[f->shown[k]]);
    strut_bounds_add(&f->bounds[k], f->model, f->moved);
    strut_bounds_widen(&f->all, f->bounds[k].low, f->bounds[k].high);
  }
}

/* Bounds of the panels in a row: one width for all rows, the height of this row. */
static strut_bounds row_bounds(const figure *f, size_t row) {
  strut_bounds bounds = f->all;
  bounds.low[1] = HUGE_VAL;
  bounds.high[1] = -HUGE_VAL;
  for (size_t k = row * f->columns; k < (row + 1) * f->columns && k < f->count; k++) {
    bounds.low[1] = fmin(bounds.low[1], f->bounds[k].low[1]);
    bounds.high[1] = fmax(bounds.high[1], f->bounds[k].high[1]);
  }
  return bounds;
}

static double row_height(const figure *f, size_t row) {
  strut_bounds bounds = row_bounds(f, row);
  return f->head + f->scale * (bounds.high[1] - bounds.low[1]) + 2 * MARGIN;
}

/* As many panels in a row as make the structure largest on a page no taller than wide. */
static void arrange(figure *f, double width) {
  double wide = fmax(f->all.high[0] - f->all.low[0], 1e-6 * f->size);
  double high = fmax(f->all.high[1] - f->all.low[1], 1e-6 * f->size);
  for (size_t columns = 1; columns <= f->count; columns++) {
    size_t rows = (f->count + columns - 1) / columns;
    double panel = (width - 2 * EDGE - (double)(columns - 1) * GAP) / (double)columns;
    if (panel < NARROWEST && columns > 1) break;
    double tallest = fmin(TALLEST, fmax(width / (double)rows - f->head, 40.0));
    double scale = fmin((panel - 2 * MARGIN) / wide, (tallest - 2 * MARGIN) / high);
    if (scale < f->scale * (1 - 1e-9)) continue; /* of equal scales the fewest rows win */
    f->scale = scale;
    f->columns = columns;
    f->rows = rows;
    f->panel_width = panel;
  }
}

static void write_title(const strut_mode *mode, size_t number, char title[TITLE]) {
  strut_c_locale locale = strut_c_locale_enter();
  if (mode->kind == STRUT_MODE_ELASTIC) {
    int used = snprintf(title, TITLE, "mode %zu: %s", number,
                        strut_drawn_quantity(mode->angular_frequency / STRUT_TAU, 4, "Hz").text);
    if (isfinite(mode->damping_ratio) && mode->damping_ratio > 0 && used > 0)
      snprintf(title + used, TITLE - (size_t)used, ", \xCE\xB6 = %.2g", mode->damping_ratio);
  } else if (mode->kind == STRUT_MODE_UNSTABLE || mode->kind == STRUT_MODE_UNKNOWN) {
    snprintf(title, TITLE, "mode %zu: %s", number,
             mode->kind == STRUT_MODE_UNSTABLE ? "unstable" : "frequency not known");
  } else {
    int used = snprintf(title, TITLE, "mode %zu: %s", number,
                        mode->kind == STRUT_MODE_RIGID ? "rigid-body motion" : "mechanism");
    if (mode->just_taut && used > 0)
      snprintf(title + used, TITLE - (size_t)used, ", %d member%s just taut", (int)mode->just_taut,
               mode->just_taut == 1 ? "" : "s");
  }
  strut_c_locale_leave(locale);
}

/* Names the moving nodes. Colours show the strained members. */
static void describe_mode(const strut_mode *mode, char words[TITLE + TITLE / 2]) {
  const char *end = strchr(mode->description, ';');
  char growth[TITLE / 2] = "";
  if (mode->kind == STRUT_MODE_UNSTABLE) {
    strut_c_locale locale = strut_c_locale_enter();
    snprintf(growth, sizeof growth, "grows e-fold in %s: ",
             strut_drawn_quantity(1.0 / sqrt(-mode->eigenvalue), 3, "s").text);
    strut_c_locale_leave(locale);
  }
  snprintf(words, TITLE + TITLE / 2, "%s%.*s", growth,
           strut_text_bytes(mode->description, end ? (int)(end - mode->description) : TITLE),
           mode->description);
}

static strut_font word_font(double width) {
  return (strut_font){.size = 7, .colour = strut_grey(0.3), .width = width};
}

static void draw_head(figure *f, strut_box box, size_t number) {
  const strut_mode *mode = &f->modes->list[number];
  const strut_font bold = {.size = 8, .bold = true};
  const strut_font plain = word_font(box.width);
  char text[TITLE + TITLE / 2], fitted[STRUT_FITTED_TEXT];
  write_title(mode, number + 1, text);
  strut_draw_text(f->canvas, box.x, box.y,
                  strut_text_fit(f->canvas, text, bold, box.width, 0, fitted), bold);
  describe_mode(mode, text);
  strut_draw_text(f->canvas, box.x, box.y + TITLE_LINE, text, plain);
}

static strut_pen arrow_pen(void) {
  return (strut_pen){.colour = strut_palette_thing(2), .width = 0.8};
}
static strut_pen contact_pen(void) { return (strut_pen){.colour = strut_grey(0.1), .width = 0.9}; }

/* Arrows from the nodes at rest to where they are displaced, where they are long enough. */
static void draw_arrows(const figure *f, const strut_window *window) {
  for (int32_t i = 0; i < f->model->node_count && f->model->node_count <= LED; i++) {
    double from[2], to[2];
    strut_window_point(window, f->modes->q + 2 * i, from);
    strut_window_point(window, f->moved + 2 * i, to);
    double length = hypot(to[0] - from[0], to[1] - from[1]), end = 1.0 - NODE / length;
    if (length < 2 * NODE) continue;
    strut_draw_arrow(f->canvas, from[0], from[1], from[0] + end * (to[0] - from[0]),
                     from[1] + end * (to[1] - from[1]), 4.5, arrow_pen());
  }
}

/* True if names cover little of the drawing; the texts name the moving nodes anyway. */
static bool names_fit(figure *f, strut_box box) {
  double covered = 0.0;
  if (f->model->node_count > NAMED) return false;
  for (int32_t i = 0; i < f->model->node_count; i++) {
    double width, height;
    strut_text_size(f->canvas, f->model->scene->nodes[i].name, (strut_font){.size = 7.5}, &width,
                    &height);
    covered += width * height;
  }
  return covered <= COVERED * box.width * box.height;
}

static void draw_panel(figure *f, strut_box box, strut_bounds bounds, size_t number) {
  draw_head(f, box, number);
  box.y += f->head;
  box.height -= f->head;
  strut_window window = strut_window_fit(box, bounds, MARGIN);
  const strut_structure_style rest = {.colouring = STRUT_COLOUR_ONE,
                                      .colour = strut_grey(0.8),
                                      .slack_forces = f->taut,
                                      .no_nodes = true};
  displace(f, &f->modes->list[number]);
  double largest = compute_strains(f);
  const strut_structure_style bent = {.colouring = STRUT_COLOUR_FORCE,
                                      .values = f->strain,
                                      .limit = largest > 0 ? largest : 1.0,
                                      .slack_forces = f->taut,
                                      .no_supports = true};
  strut_draw_ground(f->canvas, &window, f->model);
  strut_draw_structure(f->canvas, &window, f->model, f->modes->q, &rest);
  for (int32_t k = 0; k < f->modes->closed_count; k++) {
    double at[2];
    strut_window_point(&window, f->modes->q + 2 * f->modes->closed[k], at);
    const strut_pen pen = contact_pen();
    strut_draw_circle(f->canvas, at[0], at[1], 3.4, NULL, &pen);
  }
  strut_draw_structure(f->canvas, &window, f->model, f->moved, &bent);
  draw_arrows(f, &window);
  if (names_fit(f, box)) strut_draw_names(f->canvas, &window, f->model, f->moved, false);
}

/* Names the modes that have no panel; empty where all have one. */
static void describe_omitted(const figure *f, char text[TITLE]) {
  size_t rigid = 0, left = f->modes->count - f->count;
  for (size_t i = 0; i < f->modes->count; i++) rigid += f->modes->list[i].kind == STRUT_MODE_RIGID;
  if (f->modes->list[f->shown[0]].kind == STRUT_MODE_RIGID) rigid -= f->count;
  left -= rigid;
  text[0] = '\0';
  int used = 0;
  if (rigid)
    used = snprintf(text, TITLE, "not drawn: %zu rigid-body motion%s", rigid, rigid > 1 ? "s" : "");
  if (left)
    snprintf(text + used, TITLE - (size_t)used, "%s%zu higher mode%s",
             used ? ", " : "not drawn: ", left, left > 1 ? "s" : "");
}

enum { ITEMS = 8 };

static size_t make_key(const figure *f, char at[TITLE], char rest[TITLE],
                       strut_key_item items[ITEMS]) {
  size_t count = 0;
  snprintf(at, TITLE, "%s %.*s%s", f->modes->at_rest ? "equilibrium" : "shape",
           strut_text_bytes(f->modes->at, 150), f->modes->at,
           f->modes->at_rest ? "" : " (no equilibrium)");
  describe_omitted(f, rest);
  items[count++] = (strut_key_item){
      .sign = STRUT_KEY_LINE, .pen = {.colour = strut_grey(0.8), .width = 1.8}, .text = at};
  if (f->modes->closed_count)
    items[count++] =
        (strut_key_item){.sign = STRUT_KEY_DOT, .pen = contact_pen(), .text = "closed contact"};
  if (f->model->node_count <= LED)
    items[count++] =
        (strut_key_item){.sign = STRUT_KEY_ARROW, .pen = arrow_pen(), .text = "displacement"};
  if (f->model->scene->member_count)
    items[count++] = (strut_key_item){
        .sign = STRUT_KEY_SIGNED, .before = "shortens", .text = "stretches, relative per mode"};
  if (rest[0]) items[count++] = (strut_key_item){.sign = STRUT_KEY_WORDS, .text = rest};
  return count;
}

/* Measures the heights of the panels' texts and of the key. */
static strut_status measure_texts(figure *f, double width, const strut_key_item *items,
                                  size_t count, double *key, strut_error *error) {
  strut_canvas *ruler;
  strut_status status = strut_canvas_open_pixels(1, 1, 1.0, &ruler, error);
  if (status != STRUT_OK) return status;
  *key = strut_key_height(ruler, width - 2 * EDGE, items, count);
  double words = 0.0;
  for (size_t k = 0; k < f->count; k++) {
    char text[TITLE + TITLE / 2];
    double wide, high;
    describe_mode(&f->modes->list[f->shown[k]], text);
    const strut_font font = word_font(f->panel_width);
    strut_text_size(ruler, text, font, &wide, &high);
    words = fmax(words, high);
  }
  f->head = TITLE_LINE + words;
  strut_canvas_free(ruler);
  return STRUT_OK;
}

static strut_status draw_figure(figure *f, const strut_plot *plot, strut_error *error) {
  const char *title = strut_plot_title(plot, f->model->scene->name);
  double width = plot->width;
  char at[TITLE], rest[TITLE];
  strut_key_item items[ITEMS] = {{0}};
  size_t count = make_key(f, at, rest, items);
  double key, head = 0.0, height = 2 * EDGE;
  const strut_heading heading = {.width = width, .edge = EDGE, .title = title};
  strut_status status = strut_heading_measure(&heading, &head, error);
  if (status == STRUT_OK) status = measure_texts(f, width, items, count, &key, error);
  if (status != STRUT_OK) return status;
  for (size_t row = 0; row < f->rows; row++) height += row_height(f, row) + GAP;
  height += head + key - 0.5 * GAP;
  status = strut_canvas_open(plot->path, width, height, title, &f->canvas, error);
  if (status != STRUT_OK) return status;
  strut_heading_draw(f->canvas, &heading);
  strut_box box = {EDGE, EDGE + head, f->panel_width, 0};
  for (size_t row = 0; row < f->rows; row++, box.y += box.height + GAP) {
    box.height = row_height(f, row);
    for (size_t k = row * f->columns; k < (row + 1) * f->columns && k < f->count; k++) {
      box.x = EDGE + (double)(k % f->columns) * (f->panel_width + GAP);
      draw_panel(f, box, row_bounds(f, row), f->shown[k]);
    }
  }
  strut_draw_key(f->canvas, (strut_box){EDGE, height - EDGE - key, width - 2 * EDGE, key}, items,
                 count);
  status = strut_canvas_commit(f->canvas, error);
  strut_canvas_free(f->canvas);
  return status;
}

strut_status strut_modes_figure(const strut_plot *plot, const strut_model *model,
                                const strut_modes *modes, size_t panels, strut_error *error) {
  figure f = {.model = model, .modes = modes, .head = TITLE_LINE + WORD_LINES + 2.0};
  choose_modes(&f, panels);
  strut_status status = STRUT_NO_MEMORY;
  if (allocate_arrays(&f)) {
    find_taut(&f);
    find_bounds(&f);
    arrange(&f, plot->width);
    status = draw_figure(&f, plot, error);
  } else {
    strut_no_memory(error, "");
  }
  strut_arena_free(&f.arena);
  return status;
}
