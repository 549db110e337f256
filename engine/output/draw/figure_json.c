/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A figure's data as JSON: for programs that draw it in their own way. */
#include <math.h>

#include "engine/output/draw/figure.h"
#include "engine/output/result_values.h"

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
  X("dots", "", IF(s->cloud, FLAG(true)), "not joined by lines")                                   \
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
  if (!map->category) return STRUT_VALUE_AS_NUMBER(map->value[k]);
  return STRUT_VALUE_AS_TEXT(map->category[k] < 0 ? NULL : map->names[map->category[k]]);
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

#define TRAIL(X) X("points", "m", TABLE(t->at, t->count, 2), "a line in the plane")
STRUT_VALUES_HERE(trail_values, TRAIL, const strut_trail *t = of->at)

#define VIEW(X)                                                                                    \
  X("shapes", "", LIST(p->shapes, p->shape_count), "the lowest first", .rows = &shape_values)      \
  X("trails", "", LIST(p->trails, p->trail_count), "lines over them", .rows = &trail_values)
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

char *strut_figure_json(const strut_plot *plot, const strut_figure *figure) {
  strut_figure own = *figure;
  if (plot->title) own.title = plot->title;
  return strut_values_json(&figure_values, &own, NULL);
}
