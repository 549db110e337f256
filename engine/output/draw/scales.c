/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What figures are described with, and is the same wherever they are drawn: colours, ranges, quantities, bounds. */
#include <assert.h>
#include <gsl/gsl_sort_double.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/draw/figure.h"

/* ---- colours ---- */

/* Anchors at equal distances; the lightness of each row grows from left to right. */
enum { ANCHORS = 5 };
static const unsigned SIGNED[ANCHORS] = {0x0A1F66, 0x2F4A9E, 0x7D8390, 0xC98B45, 0xF5A31A};
static const unsigned SEQUENCE[ANCHORS] = {0x2A0F54, 0x33508C, 0x1F8A8C, 0x55B567, 0xD3CB2F};
static const unsigned DIVERGING[ANCHORS] = {0x1B4A9C, 0x7AA3D4, 0xEBEBEB, 0xE59A52, 0x9C430C};
static const unsigned THINGS[STRUT_PALETTE_THINGS] = {0x0060A8, 0xD55E00, 0x009E73, 0xB0508F,
                                                      0xE69F00, 0x4FAEE6, 0x333333};

static strut_colour from(unsigned rgb) {
  return (strut_colour){(double)(rgb >> 16) / 255.0, (double)(rgb >> 8 & 255) / 255.0,
                        (double)(rgb & 255) / 255.0, 1.0};
}

/* value from 0 to 1 along the anchors. */
static strut_colour between(const unsigned anchors[ANCHORS], double value) {
  double place = (value > 0 ? value < 1 ? value : 1.0 : 0.0) * (ANCHORS - 1);
  int i = (int)place < ANCHORS - 1 ? (int)place : ANCHORS - 2;
  double t = place - i;
  strut_colour a = from(anchors[i]), b = from(anchors[i + 1]);
  return (strut_colour){a.red + t * (b.red - a.red), a.green + t * (b.green - a.green),
                        a.blue + t * (b.blue - a.blue), 1.0};
}

strut_colour strut_palette_at(strut_colours colours, double value, double low, double high) {
  static const unsigned *const anchors[] = {[STRUT_COLOURS_SEQUENTIAL] = SEQUENCE,
                                            [STRUT_COLOURS_DIVERGING] = DIVERGING,
                                            [STRUT_COLOURS_SIGNED] = SIGNED};
  double part = (value - low) / (high - low), limit = fmax(fabs(low), fabs(high));
  assert(colours != STRUT_COLOURS_AUTO && "a map decides what AUTO means");
  if (colours == STRUT_COLOURS_GREY) return strut_grey(0.12 + 0.8 * fmax(0, fmin(1, part)));
  return between(anchors[colours],
                 colours == STRUT_COLOURS_SEQUENTIAL ? part : 0.5 + 0.5 * value / limit);
}

strut_colour strut_palette_thing(size_t i) { return from(THINGS[i % STRUT_PALETTE_THINGS]); }

strut_colour strut_grey(double brightness) {
  return (strut_colour){brightness, brightness, brightness, 1.0};
}

strut_colour strut_faded(strut_colour colour, double alpha) {
  colour.alpha *= alpha;
  return colour;
}

strut_pen strut_series_pen(size_t look) {
  enum { DASHES = 7 };
  static const double dashes[DASHES][4] = {{0},      {5, 2}, {1.2, 1.8}, {6, 2, 1.2, 2},
                                           {3, 1.5}, {8, 2}, {2, 3}};
  strut_pen pen = {.colour = strut_palette_thing(look), .width = 1.2};
  /* When colours repeat, dashes differ. */
  size_t dash = (look + 3 * (look / STRUT_PALETTE_THINGS)) % DASHES;
  for (int i = 0; i < 4; i++) pen.dash[i] = dashes[dash][i];
  pen.butt = pen.dash[0] > 0;
  return pen;
}

bool strut_member_is_driven(const strut_scene *scene, size_t member) {
  for (size_t i = 0; i < scene->actuator_count; i++)
    if (scene->actuators[i].member == (int32_t)member) return true;
  return false;
}

strut_pen strut_kind_pen(strut_member_kind kind, bool driven) {
  static const double widths[] = {[STRUT_BAR] = 2.4, [STRUT_SPRING] = 1.3, [STRUT_CABLE] = 0.8};
  size_t thing = driven ? 2 : kind == STRUT_SPRING ? 0 : 1;
  return (strut_pen){
      .colour = kind == STRUT_BAR && !driven ? strut_grey(0.15) : strut_palette_thing(thing),
      .width = kind > STRUT_CABLE ? 2.0 : widths[kind]};
}

/* ---- texts ---- */

int strut_text_bytes(const char *text, int most) {
  int length = (int)strnlen(text, (size_t)most), last = length;
  while (last > 0 && ((unsigned char)text[last - 1] & 0xC0) == 0x80) last--;
  if (last == 0) return 0;
  unsigned char lead = (unsigned char)text[last - 1];
  int wanted = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : lead >= 0xC0 ? 2 : 1;
  return length - last + 1 < wanted ? last - 1 : length;
}

double strut_round_below(double value) {
  double power = pow(10.0, floor(log10(value)));
  return value >= 5 * power ? 5 * power : value >= 2 * power ? 2 * power : power;
}

/* ---- ranges of axes ---- */

/* Part of the values that is rounding; lengths [m] and velocities [m/s] far below an atom's
   size. */
static const double ROUNDING = 1e-12, LEAST_LENGTH = 1e-13;

/* True if values differ by rounding only; a length or velocity far below an atom's size becomes zero. */
static bool is_noise(double *low, double *high, const char *unit) {
  double size = fmax(fabs(*low), fabs(*high));
  bool length = unit && (strcmp(unit, "m") == 0 || strcmp(unit, "m/s") == 0);
  if (length && size < LEAST_LENGTH) *low = *high = 0;
  return !(*high - *low > ROUNDING * size);
}

void strut_axis_include(strut_axis *axis, double value) {
  if (!isfinite(value) || (axis->logarithmic && !(value > 0))) return;
  if (!(axis->low <= value)) axis->low = value;
  if (!(axis->high >= value)) axis->high = value;
}

void strut_axis_settle(strut_axis *axis, double room) {
  if (!isfinite(axis->low) || !isfinite(axis->high) || axis->low > axis->high) {
    axis->low = axis->logarithmic ? 0.1 : 0;
    axis->high = 1;
  }
  if (axis->logarithmic) {
    if (!(axis->high > 0)) axis->high = 1;
    if (!(axis->low > 0)) axis->low = 1e-3 * axis->high;
    double wider = pow(axis->high / axis->low, room);
    if (axis->high / axis->low < 1.5) wider = fmax(wider, 2);
    axis->low = fmin(fmax(axis->low / wider, 1e-300), 1e299);
    axis->high = fmax(fmin(axis->high * wider, 1e300), 2 * axis->low);
    return;
  }
  bool constant = is_noise(&axis->low, &axis->high, axis->unit);
  double span = axis->high - axis->low;
  double size = fmax(fabs(axis->low), fabs(axis->high));
  if (constant || !isfinite(span)) { /* a constant is drawn in the middle */
    span = size > 1e-300 ? fmin(size, 1e300) : 1;
    room = isfinite(axis->high - axis->low) ? 0.1 : 0;
  }
  axis->low -= room * span;
  axis->high += room * span;
}

/* ---- ranges that few values do not flatten ---- */

/* Values that take more than this part of a scale are left out of it, if they are few. */
static const double MOST_OF_RANGE = 0.75;

/* Sorts the finite values to the front. Returns how many there are. */
static size_t sort_finite(double *values, size_t count) {
  size_t kept = 0;
  for (size_t i = 0; i < count; i++)
    if (isfinite(values[i])) values[kept++] = values[i];
  if (kept) gsl_sort(values, 1, kept);
  return kept;
}

strut_beyond strut_leave_out(double *values, size_t count, double share, double range[2]) {
  const double held[2] = {range[0], range[1]};
  size_t kept = sort_finite(values, count), most = (size_t)(share * (double)kept);
  double least = HUGE_VAL, core[2] = {0};
  strut_beyond beyond = {0};
  if (!kept) return beyond;
  for (size_t below = 0; below <= most; below++) { /* the others above */
    double from = fmin(held[0], values[below]);
    double to = fmax(held[1], values[kept - 1 - (most - below)]);
    if (to - from < least) least = to - from, core[0] = from, core[1] = to;
  }
  range[0] = fmin(held[0], values[0]), range[1] = fmax(held[1], values[kept - 1]);
  if (!(least > 0 && least < (1 - MOST_OF_RANGE) * (range[1] - range[0]))) return beyond;
  range[0] = core[0], range[1] = core[1];
  for (size_t i = 0; i < kept; i++) {
    double value = values[i], farther = fmax(core[0] - value, value - core[1]);
    if (farther <= 0.5 * least) {
      range[0] = fmin(range[0], value), range[1] = fmax(range[1], value);
      continue;
    }
    ++*(value < core[0] ? &beyond.below : &beyond.above);
    if (fabs(value) > fabs(beyond.farthest)) beyond.farthest = value;
  }
  return beyond;
}

const char *strut_beyond_text(const strut_beyond *beyond, const char *what, const char *unit,
                              strut_file_unit shown, char text[STRUT_BEYOND_TEXT]) {
  size_t count = beyond->below + beyond->above;
  text[0] = '\0';
  if (count)
    snprintf(text, STRUT_BEYOND_TEXT, "%zu %s%s beyond the scale, up to %s", count, what,
             count > 1 ? "s" : "",
             strut_quantity_shown(beyond->farthest, 3, unit && *unit ? unit : "1", shown).text);
  return text;
}

/* ---- bounds of structures ---- */

strut_bounds strut_bounds_none(void) {
  return (strut_bounds){{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
}

void strut_bounds_widen(strut_bounds *bounds, const double low[2], const double high[2]) {
  for (int d = 0; d < 2; d++) {
    bounds->low[d] = fmin(bounds->low[d], low[d]);
    bounds->high[d] = fmax(bounds->high[d], high[d]);
  }
}

void strut_bounds_add(strut_bounds *bounds, const strut_model *model, const double *positions) {
  for (int32_t i = 0; i < 2 * model->node_count; i++) {
    if (!isfinite(positions[i])) continue;
    bounds->low[i % 2] = fmin(bounds->low[i % 2], positions[i]);
    bounds->high[i % 2] = fmax(bounds->high[i % 2], positions[i]);
  }
  for (size_t m = 0; m < model->scene->member_count; m++) { /* circles of guides */
    const strut_member *member = &model->scene->members[m];
    double radius = member->guide_radius;
    for (size_t k = 1; k <= member->guide_count && radius > 0.0; k++) {
      const double *at = positions + 2 * strut_member_node(member, k);
      strut_bounds_widen(bounds, (const double[2]){at[0] - radius, at[1] - radius},
                         (const double[2]){at[0] + radius, at[1] + radius});
    }
  }
}

void strut_bounds_share(strut_bounds *bounds, const double size[2]) {
  double middle = 0.5 * (bounds->low[0] + bounds->high[0]);
  bounds->low[0] = middle - 0.5 * size[0], bounds->high[0] = middle + 0.5 * size[0];
  bounds->high[1] = bounds->low[1] + size[1];
}

double strut_bounds_extent(const strut_bounds *bounds) {
  return fmax(bounds->high[0] - bounds->low[0], bounds->high[1] - bounds->low[1]);
}

strut_bounds strut_bounds_of(const strut_model *model, const double *positions) {
  strut_bounds bounds = strut_bounds_none();
  strut_bounds_add(&bounds, model, positions);
  return bounds;
}
