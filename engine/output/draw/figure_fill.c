/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Filling a figure in, and its file. See figure.h. */
#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/text.h"
#include "engine/output/draw/figure.h"
#include "engine/output/file.h"
#include "engine/output/result_values.h"

enum { TEXT = 800 };                /* bytes of a text at most */
static const double MARK_GAP = 4.2; /* [pt] */

/* One more item of a list, whose address that is: zeroed, in the arena, or the spare. Room doubles. */
static void *add(strut_figure *figure, void *list, size_t *count, size_t size) {
  char *items;
  assert(size <= sizeof figure->spare);
  if (!figure->failed && (*count & (*count - 1)) == 0) {
    memcpy(&items, list, sizeof items);
    char *more = strut_arena_allocate(&figure->arena, *count ? 2 * *count : 1, size);
    if (more && *count) memcpy(more, items, *count * size);
    if (more) memcpy(list, &more, sizeof more);
    figure->failed = !more;
  }
  if (figure->failed) return memset(&figure->spare, 0, sizeof figure->spare);
  memcpy(&items, list, sizeof items);
  return items + (*count)++ * size;
}

#define ADD(FIGURE, LIST, COUNT) add(FIGURE, &(LIST), &(COUNT), sizeof *(LIST))

strut_panel *strut_add_panel(strut_figure *figure) {
  return ADD(figure, figure->panels, figure->panel_count);
}

strut_series *strut_add_series(strut_figure *figure, strut_panel *panel, const char *label) {
  strut_series *series = ADD(figure, panel->series, panel->series_count);
  series->label = label;
  series->look = -1;
  return series;
}

strut_point *strut_add_point(strut_figure *figure, strut_series *series, double x, double y) {
  strut_point *point = ADD(figure, series->points, series->count);
  *point = (strut_point){x, y, (double)NAN, (double)NAN, (double)NAN, false};
  return point;
}

strut_band *strut_add_band(strut_figure *figure, strut_panel *panel, double low, double high,
                           const char *label) {
  strut_band *band = ADD(figure, panel->bands, panel->band_count);
  *band = (strut_band){low, high, false, label};
  return band;
}

strut_label *strut_add_mark(strut_figure *figure, strut_panel *panel, double x, double y,
                            const char *text) {
  strut_label *mark = ADD(figure, panel->marks, panel->mark_count);
  *mark = (strut_label){.text = text,
                        .font = {.size = 7, .halo = strut_faded(strut_grey(1), 0.85)},
                        .at = {x, y},
                        .gap = MARK_GAP};
  return mark;
}

strut_shape *strut_add_shape(strut_figure *figure, strut_panel *panel, const strut_model *model,
                             const double *positions) {
  strut_shape *shape = ADD(figure, panel->shapes, panel->shape_count);
  shape->model = model;
  shape->q = positions;
  figure->failed = figure->failed || !positions;
  return shape;
}

strut_shape *strut_add_ghost(strut_figure *figure, strut_panel *panel, const strut_model *model,
                             const double *positions, double grey) {
  strut_shape *shape = strut_add_shape(figure, panel, model, positions);
  shape->style = (strut_structure_style){.colouring = STRUT_COLOUR_ONE,
                                         .colour = strut_grey(grey),
                                         .no_nodes = true,
                                         .no_supports = true};
  return shape;
}

strut_shape *strut_add_forces(strut_figure *figure, strut_panel *panel, const strut_model *model,
                              const double *positions, const double *force, double limit) {
  strut_shape *shape = strut_add_shape(figure, panel, model, positions);
  shape->style = (strut_structure_style){
      .colouring = STRUT_COLOUR_FORCE, .values = force, .slack_forces = force, .limit = limit};
  shape->ground = true;
  return shape;
}

strut_series *strut_add_line(strut_figure *figure, strut_panel *panel, strut_series_kind kind,
                             strut_pen pen) {
  strut_series *series = strut_add_series(figure, panel, NULL);
  series->kind = kind;
  series->pen = pen;
  return series;
}

void strut_add_segment(strut_figure *figure, strut_panel *panel, strut_series_kind kind,
                       strut_pen pen, const double from[2], const double to[2]) {
  strut_series *series = strut_add_line(figure, panel, kind, pen);
  strut_add_point(figure, series, from[0], from[1]);
  strut_add_point(figure, series, to[0], to[1]);
}

void strut_add_displacements(strut_figure *figure, strut_panel *panel, const strut_model *model,
                             const double *from, const double *to) {
  enum { MOST = 200 };
  const strut_pen pen = {.colour = strut_palette_thing(2), .width = 0.8};
  if (model->node_count <= MOST) strut_add_key(figure, STRUT_KEY_ARROW, pen, "displacement");
  for (int32_t i = 0; i < model->node_count && model->node_count <= MOST; i++)
    strut_add_segment(figure, panel, STRUT_SERIES_ARROW, pen, from + 2 * i, to + 2 * i);
}

strut_key_item *strut_add_key(strut_figure *figure, strut_key_sign sign, strut_pen pen,
                              const char *text) {
  for (size_t i = 0; i < figure->key_count && text; i++)
    if (figure->keys[i].text && strcmp(figure->keys[i].text, text) == 0) return &figure->keys[i];
  strut_key_item *item = ADD(figure, figure->keys, figure->key_count);
  item->sign = sign;
  item->pen = pen;
  item->text = text;
  return item;
}

const char *strut_figure_text(strut_figure *figure, const char *format, ...) {
  char text[TEXT];
  va_list rest;
  strut_c_locale locale = strut_c_locale_enter();
  va_start(rest, format);
  vsnprintf(text, sizeof text, format, rest);
  va_end(rest);
  strut_c_locale_leave(locale);
  const char *kept = strut_arena_text(&figure->arena, text, (size_t)strut_text_bytes(text, TEXT));
  figure->failed = figure->failed || !kept;
  return kept ? kept : "";
}

double *strut_figure_numbers(strut_figure *figure, const double *from, size_t count) {
  double *numbers = strut_arena_allocate(&figure->arena, count + 1, sizeof *numbers);
  figure->failed = figure->failed || !numbers;
  if (numbers && from) memcpy(numbers, from, count * sizeof *numbers);
  return numbers;
}

strut_colour_scale strut_force_scale(double limit, const strut_beyond *beyond) {
  return (strut_colour_scale){.name = limit > 0 ? "force" : NULL,
                              .unit = "N",
                              .low = -limit,
                              .high = limit,
                              .colours = STRUT_COLOURS_SIGNED,
                              .beyond = beyond ? *beyond : (strut_beyond){0}};
}

double strut_largest(const double *values, size_t count) {
  double most = 0;
  for (size_t i = 0; values && i < count; i++)
    if (isfinite(values[i])) most = fmax(most, fabs(values[i]));
  return most;
}

/* A figure's data as JSON: for programs that draw it in their own way. */

#define AXIS(X)                                                                                    \
  X("name", "", TEXT(a->name), "what is along it")                                                 \
  X("unit", "", TEXT(a->unit), "of its numbers")                                                   \
  X("shown", "", IF(a->shown.name, TEXT(a->shown.name)), "the unit of the file")                   \
  X("shown_size", "", IF(a->shown.name, NUMBER(a->shown.size)), "of it, in the unit")              \
  X("logarithmic", "", FLAG(a->logarithmic), "whether it is")                                      \
  X("from", "", NUMBER(a->low), "null: from the data")                                             \
  X("to", "", NUMBER(a->high), "null: from the data")                                              \
  X("categories", "", IF(a->names, ARRAY(a->name_count, category)), "at 0, 1, ...")
static strut_value category(const strut_result_object *of, size_t i) {
  return STRUT_VALUE_AS_TEXT(((const strut_axis *)of->at)->names[i]);
}
STRUT_VALUES_HERE(axis_values, AXIS, const strut_axis *a = of->at)

static strut_value stable(const strut_result_object *of, size_t i) {
  return STRUT_VALUE_AS_FLAG(!((const strut_series *)of->at)->points[i].unstable);
}

/* Whether any point has a whisker, a value, or no stability. */
static bool any(const strut_series *series, int what) {
  for (const strut_point *p = series->points; p < series->points + series->count; p++)
    if (what == 0 ? p->unstable : isfinite(what == 1 ? p->low : p->value)) return true;
  return false;
}

static const strut_point none;
#define STRUT_VALUE_AS_OF_POINTS(NUMBER)                                                           \
  STRUT_VALUE_AS_OF_STRUCTS(&(s->points ? s->points : &none)->NUMBER, s->count, sizeof *s->points)

#define SERIES(X)                                                                                  \
  X("label", "", TEXT(s->label), "in the legend")                                                  \
  X("x", "", OF_POINTS(x), "in the axis's unit")                                                   \
  X("y", "", OF_POINTS(y), "null: a gap")                                                          \
  X("dots", "", IF(s->kind == STRUT_SERIES_DOTS, FLAG(true)), "not joined by lines")               \
  X("bar", "", IF(s->bar > 0, NUMBER(s->bar)), "the width of bars from 0, along x")                \
  X("low", "", IF(any(s, 1), OF_POINTS(low)), "ends of whiskers")                                  \
  X("high", "", IF(any(s, 1), OF_POINTS(high)), "ends of whiskers")                                \
  X("stable", "", IF(any(s, 0), ARRAY(s->count, stable)), "else the line is dashed")               \
  X("value", "", IF(any(s, 2), OF_POINTS(value)), "the dots' colours")
STRUT_VALUES_HERE(series_values, SERIES, const strut_series *s = of->at)

#define BAND(X)                                                                                    \
  X("label", "", TEXT(b->label), "in the legend")                                                  \
  X("along", "", TEXT(b->level ? "y" : "x"), "the axis that it lies on")                           \
  X("from", "", NUMBER(b->low), "where it begins")                                                 \
  X("to", "", NUMBER(b->high), "where it ends")
STRUT_VALUES_HERE(band_values, BAND, const strut_band *b = of->at)

/* A category by name, or a number, row by row. */
static strut_value cell(const strut_result_object *of, size_t k) {
  const strut_map *map = of->at;
  if (!map->names) return STRUT_VALUE_AS_NUMBER(map->value[k]);
  return STRUT_VALUE_AS_TEXT(isnan(map->value[k]) ? NULL : map->names[(size_t)map->value[k]]);
}

static strut_value doubt(const strut_result_object *of, size_t k) {
  return STRUT_VALUE_AS_FLAG(((const strut_map *)of->at)->doubtful[k]);
}

#define MAP(X)                                                                                     \
  X("x", "", NUMBERS(m->xs, m->columns), "middles of the columns")                                 \
  X("y", "", NUMBERS(m->ys, m->rows), "middles of the rows")                                       \
  X("cells", "", ARRAY(m->columns * m->rows, cell), "row by row")                                  \
  X("doubtful", "", IF(m->doubtful, ARRAY(m->columns * m->rows, doubt)), "likewise: hatched")
STRUT_VALUES_HERE(map_values, MAP, const strut_map *m = of->at)

#define MARK(X)                                                                                    \
  X("at", "", NUMBERS(m->at, 2), "its place")                                                      \
  X("text", "", TEXT(m->text), "beside it")
STRUT_VALUES_HERE(mark_values, MARK, const strut_label *m = of->at)

static strut_value node_name(const strut_result_object *of, size_t i) {
  return STRUT_VALUE_AS_TEXT(((const strut_shape *)of->at)->model->scene->nodes[i].name);
}

static strut_value member_ends(const strut_result_object *of, size_t k) {
  const strut_member *member = &((const strut_shape *)of->at)->model->scene->members[k];
  return STRUT_VALUE_AS_INDICES(member->node, 2);
}

#define SHAPE(X)                                                                                   \
  X("names", "", ARRAY(s->model->node_count, node_name), "of the nodes")                           \
  X("nodes", "m", TABLE((const double(*)[2])s->q, s->model->node_count, 2), "where they are")      \
  X("members", "", ARRAY(s->model->scene->member_count, member_ends), "indices of their ends")     \
  X("values", "", IF(s->style.values, NUMBERS(s->style.values, s->model->scene->member_count)),    \
    "that they are coloured by")
STRUT_VALUES_HERE(shape_values, SHAPE, const strut_shape *s = of->at)

static strut_value place(const strut_result_object *of, size_t i) {
  return STRUT_VALUE_AS_NUMBERS(&((const strut_series *)of->at)->points[i].x, 2);
}

#define TRAIL(X) X("points", "m", ARRAY(s->count, place), "a line in the plane")
STRUT_VALUES_HERE(trail_values, TRAIL, const strut_series *s = of->at)

#define VIEW(X)                                                                                    \
  X("shapes", "", LIST(p->shapes, p->shape_count), "the lowest first", .rows = &shape_values)      \
  X("trails", "", LIST(p->series, p->series_count), "lines over them", .rows = &trail_values)
STRUT_VALUES_HERE(view_values, VIEW, const strut_panel *p = of->at)

#define SCALE(X)                                                                                   \
  X("name", "", TEXT(s->name), "what the colours show")                                            \
  X("unit", "", TEXT(s->unit), "of its numbers")                                                   \
  X("from", "", IF(s->high > s->low, NUMBER(s->low)), "absent: from the data")                     \
  X("to", "", IF(s->high > s->low, NUMBER(s->high)), "absent: from the data")
STRUT_VALUES_HERE(scale_values, SCALE, const strut_colour_scale *s = of->at)

#define PANEL(X)                                                                                   \
  X("title", "", TEXT(p->title), "above it")                                                       \
  X("note", "", IF(p->note, TEXT(p->note)), "below that")                                          \
  X("x", "", IF(!p->shape_count, PART(&p->x)), "", .rows = &axis_values)                           \
  X("y", "", IF(!p->shape_count, PART(&p->y)), "", .rows = &axis_values)                           \
  X("series", "", IF(!p->shape_count, LIST(p->series, p->series_count)), "",                       \
    .rows = &series_values)                                                                        \
  X("bands", "", IF(p->bands, LIST(p->bands, p->band_count)), "", .rows = &band_values)            \
  X("map", "", IF(p->map, PART(p->map)), "", .rows = &map_values)                                  \
  X("view", "", IF(p->shape_count, PART(p)), "", .rows = &view_values)                             \
  X("marks", "", IF(p->marks, LIST(p->marks, p->mark_count)), "", .rows = &mark_values)            \
  X("scale", "", IF(p->scale.name, PART(&p->scale)), "", .rows = &scale_values)
STRUT_VALUES_HERE(panel_values, PANEL, const strut_panel *p = of->at)

#define KEY(X) X("text", "", TEXT(k->text), "what something means")
STRUT_VALUES_HERE(key_values, KEY, const strut_key_item *k = of->at)

#define FIGURE(X)                                                                                  \
  X("title", "", TEXT(f->title), "above all")                                                      \
  X("note", "", IF(f->note, TEXT(f->note)), "below the title")                                     \
  X("panels", "", LIST(f->panels, f->panel_count), "row by row", .rows = &panel_values)            \
  X("key", "", IF(f->keys, LIST(f->keys, f->key_count)), "", .rows = &key_values)
STRUT_VALUES_HERE(figure_values, FIGURE, const strut_figure *f = of->at)

/* ---- files ---- */

strut_picture_format strut_picture_format_of(const char *path) {
  static const char *const endings[] = {".svg", ".pdf", ".png", ".json"};
  const char *dot = strrchr(path, '.');
  bool name = dot && !strchr(dot, '/') && dot != path && dot[-1] != '/';
  for (int i = 0; i < STRUT_PICTURE_PIXELS && name; i++)
    if (strcmp(dot, endings[i]) == 0) return (strut_picture_format)i;
  return STRUT_PICTURE_PIXELS;
}

strut_status strut_figure_check_name(const char *path, strut_error *error) {
  if (strut_picture_format_of(path) != STRUT_PICTURE_PIXELS) return STRUT_OK;
  return strut_fail(error, STRUT_USAGE,
                    "unknown picture format '%s': the name must end with .svg, .pdf or .png, or "
                    ".json for its data",
                    path);
}

static strut_status write_json(const strut_plot *plot, const strut_figure *figure,
                               strut_error *error) {
  strut_figure own = *figure;
  if (plot->title) own.title = plot->title;
  char *text = strut_values_json(&figure_values, &own, NULL);
  strut_status status = text ? strut_file_write_path(plot->path, text, error)
                             : strut_no_memory(error, "while drawing");
  strut_release(text);
  return status;
}

static void choose_axis(strut_axis *axis, const strut_axis_choice *choice) {
  if (choice->label) axis->name = choice->label;
  if (choice->limited) axis->low = choice->low, axis->high = choice->high;
  axis->logarithmic = axis->logarithmic || choice->logarithmic;
}

/* Arrows of the ground's forces have one scale, unless it is given. */
static void settle_arrows(strut_figure *figure) {
  const strut_pen pen = {.colour = strut_palette_thing(1), .width = 1.1};
  double largest = 0;
  for (int pass = 0; pass < 2; pass++)
    for (strut_panel *panel = figure->panels; panel < figure->panels + figure->panel_count; panel++)
      for (strut_shape *s = panel->shapes; s < panel->shapes + panel->shape_count; s++) {
        if (!s->forces || s->force_limit > 0) continue;
        if (pass)
          s->force_limit = largest;
        else
          largest =
              fmax(largest, strut_largest(s->forces[0], 2 * (size_t)s->model->contacts.count));
      }
  if (largest > 0)
    strut_add_key(figure, STRUT_KEY_ARROW, pen,
                  strut_figure_text(figure, "contact force, up to %s",
                                    strut_quantity_of(largest, 3, "N").text));
}

strut_status strut_figure_draw(const strut_plot *plot, strut_figure *figure, strut_error *error) {
  const strut_cairo_library *cairo = NULL;
  strut_c_locale locale = strut_c_locale_enter();
  strut_status status = strut_figure_check_name(plot->path, error);
  for (size_t i = 0; i < figure->panel_count; i++) {
    choose_axis(&figure->panels[i].x, &plot->x);
    choose_axis(&figure->panels[i].y, &plot->y);
  }
  settle_arrows(figure);
  if (!status && figure->failed) status = strut_no_memory(error, "while drawing");
  if (!status && strut_picture_format_of(plot->path) == STRUT_PICTURE_JSON)
    status = write_json(plot, figure, error);
  else if (!status && !(status = strut_cairo_load(&cairo, error)))
    status = cairo->draw(plot, figure, error);
  strut_arena_free(&figure->arena);
  strut_c_locale_leave(locale);
  return status;
}
