/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Round numbers on axes, how they are written, and frames with them. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/text.h"
#include "engine/output/draw/painter.h"

/* Ticks with more significant digits get a common offset. */
enum { MOST_DIGITS = 5 };

static double round_step(double rough) {
  double power = pow(10.0, floor(log10(rough))), part = rough / power;
  return power * (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10);
}

/* The number with fewest digits within five ranges of the middle. */
static double common_part(double low, double high) {
  double middle = low + 0.5 * (high - low), near = middle;
  for (int k = (int)floor(log10(fabs(middle))); k >= (int)floor(log10(high - low)); k--) {
    double power = pow(10.0, k);
    near = round(middle / power) * power;
    if (fabs(near - middle) <= 5 * (high - low)) break;
  }
  return near;
}

size_t strut_ticks(double low, double high, int wanted, double ticks[STRUT_MOST_TICKS]) {
  size_t count = 0;
  if (!(high > low) || !isfinite(high - low) || wanted < 1) return 0;
  if (wanted > STRUT_MOST_TICKS / 3) wanted = STRUT_MOST_TICKS / 3;
  double step = round_step((high - low) / wanted);
  double first = ceil(low / step - 1e-9);
  for (double k = first; k * step <= high + 1e-9 * step && count < STRUT_MOST_TICKS; k++) {
    if (count && k * step <= ticks[count - 1]) break; /* closer than doubles resolve */
    ticks[count++] = k == 0 ? 0 : k * step;
  }
  return count;
}

const char *strut_prefix(double largest, const char *unit, double *factor) {
  static const char *const names[] = {"f", "p", "n", "µ", "m", "", "k", "M", "G", "T", "P"};
  *factor = 1;
  if (!strut_unit_takes_prefix(unit) || !(largest > 0) || !isfinite(largest)) return "";
  double group = floor(log10(largest) / 3 + 1e-12);
  if (group < -5 || group > 5) return "";
  *factor = pow(1000.0, group);
  return names[(int)group + 5];
}

static void write_power(char *text, size_t size, int exponent) {
  static const char *const raised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  char digits[16];
  int used = snprintf(text, size, "10%s", exponent < 0 ? "⁻" : "");
  snprintf(digits, sizeof digits, "%d", abs(exponent));
  for (const char *d = digits; *d; d++)
    used += snprintf(text + used, size - (size_t)used, "%s", raised[*d - '0']);
}

/* Powers of ten as print writes them. */
static void write_number(char *text, size_t size, const char *format, int decimals, double value) {
  snprintf(text, size, format, decimals, value == 0 ? 0 : value); /* no minus zero */
  char *power = strchr(text, 'e');
  if (!power) return;
  int exponent = atoi(power + 1);
  size_t used = (size_t)(power - text);
  used += (size_t)snprintf(power, size - used, "×");
  write_power(text + used, size - used, exponent);
}

static void write_label(const strut_axis *axis, const char *prefix, const char *offset,
                        strut_tick_set *set) {
  const char *name = axis->name ? axis->name : "", *unit = axis->unit;
  if (axis->shown.name && *unit == 'u') prefix = "µ", unit++;
  snprintf(set->label, sizeof set->label, "%s%s%s%s%s", name, offset,
           *unit ? (*name ? " in " : "in ") : "", *unit ? prefix : "", unit);
}

static void linear_ticks(const strut_axis *axis, int wanted, strut_tick_set *set) {
  double factor, largest = fmax(fabs(axis->low), fabs(axis->high)), offset = 0;
  char offset_text[64] = "";
  set->count = strut_ticks(axis->low, axis->high, wanted, set->at);
  double step = set->count > 1 ? set->at[1] - set->at[0] : axis->high - axis->low;
  bool far = largest / step > 2 * pow(10.0, MOST_DIGITS);
  if (far) { /* the common part of all ticks goes into the label */
    offset = common_part(axis->low, axis->high);
    largest = fmax(fabs(axis->low - offset), fabs(axis->high - offset));
  }
  const char *prefix = strut_prefix(largest, axis->shown.name ? "" : axis->unit, &factor);
  if (far) {
    char number[48];
    write_number(number, sizeof number, "%.*g", 12, fabs(offset));
    snprintf(offset_text, sizeof offset_text, " %s %s%s%s", offset > 0 ? "\xe2\x88\x92" : "+",
             number, *axis->unit ? " " : "", axis->unit);
  }
  write_label(axis, prefix, offset_text, set);
  step /= factor;
  double size = largest / factor;
  bool plain = size < 1e5 && step > 1e-6;
  int decimals = plain ? (int)fmax(0, ceil(-log10(step) - 1e-6)) : 3;
  for (size_t i = 0; i < set->count; i++)
    write_number(set->text[i], STRUT_TICK_TEXT, plain ? "%.*f" : "%.*g", decimals,
                 (set->at[i] - offset) / factor);
}

/* Decades; within few of them also 2 and 5 times, as plain numbers. */
static void logarithmic_ticks(const strut_axis *axis, int wanted, strut_tick_set *set) {
  double from = log10(axis->low), to = log10(axis->high);
  int each = (int)fmax(1, ceil((to - from) / fmax(wanted, 1)));
  bool few = to - from < 1.5;
  write_label(axis, "", "", set);
  for (int k = (int)floor(from); k <= (int)ceil(to); k++) {
    double decade = pow(10.0, k);
    for (int m = 1; m <= 9; m++) {
      double value = m * decade;
      if (value < axis->low * (1 - 1e-9) || value > axis->high * (1 + 1e-9)) continue;
      bool major = few ? m == 1 || m == 2 || m == 5 : m == 1 && k % each == 0;
      if (major && set->count < STRUT_MOST_TICKS) {
        char *text = set->text[set->count];
        set->at[set->count++] = value;
        if (few && value >= 1e-4 && value < 1e5) {
          write_number(text, STRUT_TICK_TEXT, "%.*g", 6, value);
        } else if (m == 1) {
          write_power(text, STRUT_TICK_TEXT, k);
        }
      } else if (!major && to - from < 12 && set->minor_count < STRUT_MOST_MINOR) {
        set->minor[set->minor_count++] = value;
      }
    }
  }
}

static void name_ticks(const strut_axis *axis, strut_tick_set *set) {
  for (size_t i = 0; i < axis->name_count && i < STRUT_MOST_TICKS; i++) {
    set->at[set->count] = (double)i;
    snprintf(set->text[set->count++], STRUT_TICK_TEXT, "%.*s",
             strut_text_bytes(axis->names[i], STRUT_TICK_TEXT - 1), axis->names[i]);
  }
  write_label(axis, "", "", set);
}

void strut_axis_ticks(const strut_axis *axis, int wanted, strut_tick_set *set) {
  strut_c_locale locale = strut_c_locale_enter();
  strut_axis in = *axis; /* in the unit that is shown */
  assert(!(axis->low > axis->high));
  *set = (strut_tick_set){0};
  in.shown = strut_unit_shown(axis->unit, axis->shown);
  in.unit = in.shown.name ? in.shown.name : axis->unit ? axis->unit : "";
  double size = in.shown.name ? in.shown.size : 1;
  in.low /= size, in.high /= size;
  if (axis->names)
    name_ticks(&in, set);
  else if (axis->logarithmic)
    logarithmic_ticks(&in, wanted, set);
  else
    linear_ticks(&in, wanted, set);
  for (size_t i = 0; i < set->count && !axis->names; i++) set->at[i] *= size;
  for (size_t i = 0; i < set->minor_count; i++) set->minor[i] *= size;
  strut_c_locale_leave(locale);
}

static const double TICK_SIZE = 7.5, LABEL_SIZE = 8, TICK = 2.5, GAP = 2.5;
static const double RIGHT = 10;      /* half of the last tick's text */
static const double LEAST_LEFT = 26; /* so that frames one above the other line up more often */
static const double UPWARDS = 120;   /* most of names that stand upwards [pt] */

static double widest_text(strut_canvas *canvas, const strut_tick_set *set) {
  double widest = 0;
  for (size_t i = 0; i < set->count; i++)
    widest =
        fmax(widest, strut_text_box(canvas, set->text[i], (strut_font){.size = TICK_SIZE}).width);
  return widest;
}

/* As many ticks as have room for their texts. */
static strut_tick_set ticks_along_x(strut_canvas *canvas, const strut_axis *axis, double width) {
  strut_tick_set set;
  for (int wanted = 10; wanted > 0; wanted--) {
    strut_axis_ticks(axis, wanted, &set);
    if ((double)set.count * (widest_text(canvas, &set) + 8) <= width) break;
  }
  return set;
}

static strut_tick_set ticks_along_y(const strut_axis *axis, double height) {
  strut_tick_set set;
  strut_axis_ticks(axis, (int)fmax(1, fmin(10, height / 22)), &set);
  return set;
}

strut_axes strut_axes_place(strut_canvas *canvas, strut_box box, strut_axis x, strut_axis y) {
  double line = strut_text_box(canvas, "0", (strut_font){.size = TICK_SIZE}).height;
  double label = strut_text_box(canvas, "0", (strut_font){.size = LABEL_SIZE}).height;
  double above = 0.5 * TICK_SIZE, room = box.width - LEAST_LEFT - label - GAP - RIGHT;
  strut_axes axes = {.x = x, .y = y, .ticks = line};
  strut_tick_set set;
  strut_axis_ticks(&x, 1, &set);
  axes.upwards = x.name_count && widest_text(canvas, &set) > room / (double)x.name_count - 2;
  if (axes.upwards) axes.ticks = fmin(widest_text(canvas, &set), UPWARDS);
  double below = x.names && !x.name_count ? GAP : TICK + GAP + axes.ticks + label;
  double height = fmax(box.height - above - below, 10);
  set = ticks_along_y(&y, height);
  double left = fmax(widest_text(canvas, &set) + TICK + GAP, LEAST_LEFT) + label + GAP;
  axes.frame = (strut_box){box.x + left, box.y + above, fmax(box.width - left - RIGHT, 10), height};
  return axes;
}

static double axis_fraction(const strut_axis *axis, double value) {
  if (axis->logarithmic) return log10(value / axis->low) / log10(axis->high / axis->low);
  return (value - axis->low) / (axis->high - axis->low);
}

void strut_axes_point(const strut_axes *axes, const double place[2], double point[2]) {
  point[0] = axes->frame.x + axes->frame.width * axis_fraction(&axes->x, place[0]);
  point[1] = axes->frame.y + axes->frame.height * (1.0 - axis_fraction(&axes->y, place[1]));
}

strut_axes strut_view_axes(strut_box box, const strut_panel *view) {
  const strut_bounds *b = &view->bounds;
  double size[2] = {b->high[0] - b->low[0], b->high[1] - b->low[1]};
  double arrows = strut_view_arrows(view);
  double room[2] = {fmax(box.width - 2 * view->margin, 1),
                    fmax(box.height - arrows - 2 * view->margin, 1)};
  bool empty = !(size[0] >= 0 && size[1] >= 0);
  double x = empty ? 0 : b->low[0] + 0.5 * size[0], y = empty ? 0 : b->low[1] + 0.5 * size[1];
  double scale = fmin(room[0] / size[0], room[1] / size[1]);
  if (empty || !(scale < HUGE_VAL)) scale = fmin(room[0], room[1]); /* a single point: 1 m wide */
  double half = 0.5 * box.width / scale, top = y + 0.5 * (box.height - arrows) / scale;
  return (strut_axes){.x = {.low = x - half, .high = x + half},
                      .y = {.low = top - box.height / scale, .high = top},
                      .frame = box,
                      .scale = scale};
}

/* The label below the middle of the frame; a long one ends where the axes do, and is shortened if need be. */
static void label_x(strut_canvas *canvas, const strut_box *box, double y, const char *label) {
  strut_font font = {.size = LABEL_SIZE, .across = 0.5};
  double right = box->x + box->width + RIGHT, left = fmax(box->x - LEAST_LEFT - LABEL_SIZE, 0.0);
  double width = strut_text_box(canvas, label, font).width;
  if (width > right - left) width = font.width = right - left, font.lines = 1;
  strut_draw_text(canvas, fmin(box->x + 0.5 * box->width, right - 0.5 * width), y, label, font);
}

/* A tick at a value of the axis d, `length` outwards; a faint line across the frame where it has a text. */
static void draw_tick(strut_canvas *canvas, const strut_axes *axes, int d, double value,
                      const char *text) {
  const strut_box *box = &axes->frame;
  const strut_pen grid = {.colour = strut_grey(0.9), .width = 0.4, .butt = true};
  const strut_pen tick = {.colour = strut_grey(0.25), .width = 0.6, .butt = true};
  double at[2], bottom = box->y + box->height, length = text ? TICK : 0.6 * TICK;
  strut_axes_point(axes, (const double[2]){d ? axes->x.low : value, d ? value : axes->y.low}, at);
  if (text && d) strut_draw_segment(canvas, box->x, at[1], box->x + box->width, at[1], grid);
  if (text && !d) strut_draw_segment(canvas, at[0], box->y, at[0], bottom, grid);
  strut_draw_segment(canvas, at[0], at[1], at[0] - d * length, at[1] + (1 - d) * length, tick);
  strut_font font = {.size = TICK_SIZE, .across = d ? 1 : 0.5, .down = d ? 0.5 : 0};
  if (!d && axes->x.name_count) /* names side by side, or upwards */
    font.lines = 1,
    font.width = axes->upwards ? axes->ticks : box->width / (double)axes->x.name_count - 2;
  if (!d && axes->upwards) font.upwards = true, font.across = 1, font.down = 0.5;
  strut_draw_text(canvas, d ? box->x - TICK - GAP : at[0], d ? at[1] : bottom + TICK + 1, text,
                  font);
}

static void draw_ticks(strut_canvas *canvas, const strut_axes *axes, int d,
                       const strut_tick_set *set) {
  for (size_t i = 0; i < set->count; i++) draw_tick(canvas, axes, d, set->at[i], set->text[i]);
  for (size_t i = 0; i < set->minor_count; i++) draw_tick(canvas, axes, d, set->minor[i], NULL);
}

void strut_draw_axes(strut_canvas *canvas, const strut_axes *axes) {
  const strut_box *box = &axes->frame;
  const strut_tick_set x = ticks_along_x(canvas, &axes->x, box->width);
  const strut_tick_set y = ticks_along_y(&axes->y, box->height);
  double left = fmax(widest_text(canvas, &y), LEAST_LEFT - TICK - GAP);
  draw_ticks(canvas, axes, 0, &x);
  draw_ticks(canvas, axes, 1, &y);
  label_x(canvas, box, box->y + box->height + TICK + 1 + axes->ticks, x.label);
  strut_draw_text(canvas, box->x - TICK - 2 * GAP - left, box->y + 0.5 * box->height, y.label,
                  (strut_font){.size = LABEL_SIZE,
                               .across = 0.5,
                               .down = 1,
                               .upwards = true,
                               .width = box->height + 2 * LABEL_SIZE,
                               .lines = 1});
  strut_draw_box(canvas, *box, NULL, &(strut_pen){.colour = strut_grey(0.25), .width = 0.6});
}

/* Ranges of axes, of colours and of views that a figure leaves to its data. */

static const double ROOM = 0.06;     /* above and below the data */
static const double FEW = 0.05;      /* outliers, of all values */
static const double ONE_SIGN = 1e-9; /* noise of the other sign makes no signed quantity */

/* Widens the axes that are not NULL by all that a panel shows. */
static void include_panel(const strut_panel *panel, strut_axis *x, strut_axis *y) {
  double limits[2];
  for (size_t i = 0; i < panel->series_count; i++) {
    const strut_series *series = &panel->series[i];
    for (const strut_point *p = series->points; p < series->points + series->count; p++) {
      if (!isfinite(p->x) || !isfinite(p->y)) continue;
      if (x) strut_axis_include(x, p->x);
      for (int k = 0; y && k < 3; k++)
        strut_axis_include(y, k == 0 ? p->y : k == 1 ? p->low : p->high);
    }
  }
  for (int d = 0; d < 2 && panel->map; d++) {
    strut_axis *axis = d ? y : x;
    strut_map_limits(d ? panel->map->ys : panel->map->xs,
                     d ? panel->map->rows : panel->map->columns, limits);
    for (int k = 0; k < 2 && axis; k++) strut_axis_include(axis, limits[k]);
  }
}

/* The range of what is seen of the panels' numbers, of the y axis or of the scale. False: out of memory. */
static bool find_range(const strut_panel *panels, size_t count, bool scale, double range[2],
                       strut_beyond *beyond, strut_arena *arena) {
  size_t known = 0, room = 1;
  const strut_panel *end = panels + count;
  for (const strut_panel *panel = panels; panel < end; panel++) {
    for (size_t s = 0; s < panel->series_count; s++) room += panel->series[s].count;
    if (panel->map) room += panel->map->columns * panel->map->rows;
  }
  double *values = strut_arena_allocate(arena, room, sizeof *values);
  range[0] = range[1] = (double)NAN;
  for (const strut_panel *panel = panels; panel < end && values; panel++) {
    for (size_t s = 0; s < panel->series_count; s++)
      for (size_t k = 0; k < panel->series[s].count; k++)
        values[known++] = scale ? panel->series[s].points[k].value : panel->series[s].points[k].y;
    for (size_t k = 0; scale && panel->map && k < panel->map->columns * panel->map->rows; k++)
      values[known++] = panel->map->value[k];
  }
  if (values) *beyond = strut_leave_out(values, known, FEW, range);
  return values != NULL;
}

/* The range of the colours; of a signed quantity with zero in the middle. */
static bool settle_scale(const strut_panel *panels, size_t count, strut_colour_scale *scale,
                         strut_arena *arena) {
  double range[2];
  if (scale->high > scale->low) return true;
  if (!find_range(panels, count, true, range, &scale->beyond, arena)) return false;
  strut_axis axis = {.unit = scale->unit, .low = range[0], .high = range[1]};
  strut_axis_settle(&axis, 0);
  scale->low = axis.low, scale->high = axis.high;
  bool signs = scale->low < -ONE_SIGN * scale->high && scale->high > -ONE_SIGN * scale->low;
  if (scale->colours == STRUT_COLOURS_AUTO)
    scale->colours = signs ? STRUT_COLOURS_DIVERGING : STRUT_COLOURS_SEQUENTIAL;
  if (scale->colours != STRUT_COLOURS_DIVERGING) return true;
  scale->high = fmax(fabs(scale->low), fabs(scale->high));
  scale->low = -scale->high;
  return true;
}

/* All views show what any of them has to. */
static void settle_views(strut_panel *panels, size_t count) {
  strut_bounds all = strut_bounds_none();
  for (strut_panel *panel = panels; panel < panels + count; panel++) {
    const strut_bounds *own = &panel->bounds;
    if (own->low[0] != 0 || own->low[1] != 0 || own->high[0] != 0 || own->high[1] != 0) {
      strut_bounds_widen(&all, own->low, own->high);
      continue;
    }
    for (size_t i = 0; i < panel->shape_count; i++)
      strut_bounds_add(&all, panel->shapes[i].model, panel->shapes[i].q);
    for (size_t i = 0; i < panel->series_count; i++)
      for (size_t k = 0; k < panel->series[i].count; k++) {
        const double place[] = {panel->series[i].points[k].x, panel->series[i].points[k].y};
        strut_bounds_widen(&all, place, place);
      }
  }
  for (size_t i = 0; i < count; i++) panels[i].bounds = all;
}

/* Says in a panel's note how many points lie beyond its y axis. False: out of memory. */
static bool count_beyond(strut_panel *panel, strut_arena *arena) {
  strut_beyond beyond = {0};
  const strut_axis *axis = &panel->y;
  char text[STRUT_BEYOND_TEXT];
  for (size_t i = 0; i < panel->series_count; i++)
    for (size_t k = 0; k < panel->series[i].count; k++) {
      double y = panel->series[i].points[k].y;
      bool out = y > axis->high || y < axis->low;
      beyond.above += out;
      if (out && fabs(y) > fabs(beyond.farthest)) beyond.farthest = y;
    }
  if (!beyond.above) return true;
  panel->note =
      strut_arena_format(arena, "%s%s%s", panel->note ? panel->note : "", panel->note ? "; " : "",
                         strut_beyond_text(&beyond, "point", axis->unit, axis->shown, text));
  return panel->note != NULL;
}

bool strut_panels_settle(strut_panel *panels, size_t count, strut_arena *arena) {
  if (panels->shape_count) {
    settle_views(panels, count);
    return true;
  }
  strut_axis x = panels->x, y = panels->y;
  strut_colour_scale scale = panels->scale;
  strut_beyond beyond;
  double range[2];
  bool fit_x = isnan(x.low) || isnan(x.high), fit_y = isnan(y.low) || isnan(y.high);
  bool cells = panels->map != NULL, trim = panels->outliers && fit_y && !y.logarithmic;
  for (size_t i = 0; i < count; i++)
    include_panel(&panels[i], fit_x ? &x : NULL, fit_y ? &y : NULL);
  if (fit_y && panels->zero) strut_axis_include(&y, 0);
  double missing = fit_y ? panels->least - (y.high - y.low) : 0;
  if (missing > 0) y.low -= 0.5 * missing, y.high += 0.5 * missing;
  if (trim && !find_range(panels, count, false, range, &beyond, arena)) return false;
  if (trim && beyond.below + beyond.above) y.low = range[0], y.high = range[1];
  strut_axis_settle(&x, fit_x && !cells ? panels->room : 0);
  strut_axis_settle(&y, fit_y && !cells ? ROOM : 0);
  if (scale.name && !settle_scale(panels, count, &scale, arena)) return false;
  for (size_t i = 0; i < count; i++) {
    panels[i].x.low = x.low, panels[i].x.high = x.high;
    panels[i].y.low = y.low, panels[i].y.high = y.high;
    panels[i].outliers = trim;
    if (scale.name) panels[i].scale = scale;
    if (trim && !count_beyond(&panels[i], arena)) return false;
  }
  return true;
}
