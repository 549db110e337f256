/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/page_ink.h"

#include <math.h>

#include "engine/base/memory.h"

static const double LARGEST_PAGE = 20000.0; /* side of a page [pt]; squares beyond are not kept */
static const double HATCHED = 0.3,
                    DASHED = 0.6; /* darkness of hatching and of dashes, of its ink */
enum { MOST_CROSSINGS = 64 };

bool strut_page_ink_create(strut_page_ink *ink, double width, double height) {
  *ink = (strut_page_ink){.columns = (int)ceil(fmin(fmax(width, 1.0), LARGEST_PAGE)),
                          .rows = (int)ceil(fmin(fmax(height, 1.0), LARGEST_PAGE))};
  ink->dark = strut_allocate((size_t)ink->columns * (size_t)ink->rows, sizeof *ink->dark);
  return ink->dark != NULL;
}

void strut_page_ink_free(strut_page_ink *ink) { strut_release(ink->dark); }

static double darkness(strut_colour c) {
  return 1.0 - (0.3 * c.red + 0.59 * c.green + 0.11 * c.blue);
}

/* First and last square of a range, on the page; first > last where there are none. */
static void find_squares(double low, double high, int count, int range[2]) {
  range[0] = low > 0.0 ? (int)fmin(floor(low), count) : 0;
  range[1] = high < count ? (int)fmax(ceil(high), 0.0) - 1 : count - 1;
}

/* The part of a page's square ranges that a clip leaves. */
static void clip_squares(const strut_page_ink *ink, strut_box clip, int x[2], int y[2]) {
  find_squares(clip.x, clip.x + clip.width, ink->columns, x);
  find_squares(clip.y, clip.y + clip.height, ink->rows, y);
}

/* Where a segment enters and leaves the box, as fractions of it; false: it is not inside. */
static bool clip_segment(const strut_box *box, const double a[2], const double b[2],
                         double part[2]) {
  const double low[2] = {box->x, box->y}, high[2] = {box->x + box->width, box->y + box->height};
  part[0] = 0.0, part[1] = 1.0;
  for (int d = 0; d < 2; d++) {
    double step = b[d] - a[d];
    if (step == 0.0 && !(a[d] >= low[d] && a[d] <= high[d])) return false;
    if (step == 0.0) continue;
    double enter = (low[d] - a[d]) / step, leave = (high[d] - a[d]) / step;
    part[0] = fmax(part[0], fmin(enter, leave));
    part[1] = fmin(part[1], fmax(enter, leave));
  }
  return part[0] <= part[1];
}

static void stamp(strut_page_ink *ink, const int x[2], const int y[2], double dark) {
  for (int row = y[0]; row <= y[1]; row++)
    for (int column = x[0]; column <= x[1]; column++) {
      float *at = &ink->dark[(size_t)row * (size_t)ink->columns + (size_t)column];
      *at = fmaxf(*at, (float)dark);
    }
}

static void draw_segment(strut_page_ink *ink, const strut_box *clip, const double from[2],
                         const double to[2], double width, double dark) {
  const double a[2] = {strut_settle_coordinate(from[0]), strut_settle_coordinate(from[1])};
  const double b[2] = {strut_settle_coordinate(to[0]), strut_settle_coordinate(to[1])};
  double part[2], length = hypot(b[0] - a[0], b[1] - a[1]), half = 0.5 * fmax(width - 1.0, 0.0);
  if (!isfinite(length) || !clip_segment(clip, a, b, part)) return;
  int steps = (int)ceil((part[1] - part[0]) * length), last[2] = {-1, -1};
  for (int i = 0; i <= steps; i++) {
    double t = part[0] + (part[1] - part[0]) * (steps ? (double)i / steps : 0.0);
    const double at[2] = {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])};
    int x[2], y[2];
    find_squares(at[0] - half, floor(at[0] + half) + 1.0, ink->columns, x);
    find_squares(at[1] - half, floor(at[1] + half) + 1.0, ink->rows, y);
    if (x[0] == last[0] && y[0] == last[1]) continue;
    last[0] = x[0], last[1] = y[0];
    stamp(ink, x, y, dark);
  }
}

void strut_page_ink_line(strut_page_ink *ink, strut_box clip, const double (*points)[2],
                         size_t count, strut_pen pen) {
  double dark = darkness(pen.colour) * pen.colour.alpha * fmin(1.0, pen.width);
  if (pen.dash[0] > 0.0) dark *= DASHED;
  const strut_box page = {0, 0, ink->columns, ink->rows};
  clip = strut_settle_box(clip);
  double right = fmin(clip.x + clip.width, page.width);
  double bottom = fmin(clip.y + clip.height, page.height);
  strut_box seen = {fmax(clip.x, 0.0), fmax(clip.y, 0.0), 0, 0};
  seen.width = right - seen.x, seen.height = bottom - seen.y;
  if (!(dark > 0.02) || !(seen.width > 0.0) || !(seen.height > 0.0)) return;
  for (size_t i = 1; i < count; i++)
    draw_segment(ink, &seen, points[i - 1], points[i], pen.width, dark);
}

/* Abscissas at which the polygon's edges cross a level, ascending. */
static int find_crossings(const double (*points)[2], size_t count, double level,
                          double at[MOST_CROSSINGS]) {
  int found = 0;
  for (size_t i = 0; i < count && found < MOST_CROSSINGS; i++) {
    const double *from = points[i], *to = points[i + 1 < count ? i + 1 : 0];
    const double a[2] = {strut_settle_coordinate(from[0]), strut_settle_coordinate(from[1])};
    const double b[2] = {strut_settle_coordinate(to[0]), strut_settle_coordinate(to[1])};
    if ((a[1] <= level) == (b[1] <= level)) continue;
    double x = a[0] + (level - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
    int k = found++;
    for (; k > 0 && at[k - 1] > x; k--) at[k] = at[k - 1];
    at[k] = x;
  }
  return found;
}

void strut_page_ink_fill(strut_page_ink *ink, strut_box clip, const double (*points)[2],
                         size_t count, const strut_fill *fill) {
  double alpha = fill->colour.alpha, dark = darkness(fill->colour), crossing[MOST_CROSSINGS];
  double hatch = fill->hatch != STRUT_HATCH_NONE ? HATCHED * darkness(fill->hatch_colour) : 0.0;
  double low = HUGE_VAL, high = -HUGE_VAL;
  int x[2], y[2], rows[2];
  for (size_t i = 0; i < count; i++) {
    if (!isfinite(points[i][0] + points[i][1])) return;
    low = fmin(low, points[i][1]), high = fmax(high, points[i][1]);
  }
  clip_squares(ink, strut_settle_box(clip), x, y);
  find_squares(strut_settle_coordinate(low), strut_settle_coordinate(high), ink->rows, rows);
  for (int row = rows[0] > y[0] ? rows[0] : y[0]; row <= rows[1] && row <= y[1]; row++) {
    int crossings = find_crossings(points, count, row + 0.5, crossing);
    for (int k = 0; k + 1 < crossings; k += 2) {
      int columns[2];
      find_squares(crossing[k], crossing[k + 1], ink->columns, columns);
      for (int c = columns[0] > x[0] ? columns[0] : x[0]; c <= columns[1] && c <= x[1]; c++) {
        float *at = &ink->dark[(size_t)row * (size_t)ink->columns + (size_t)c];
        *at = (float)fmin(1.0, (double)*at * (1.0 - alpha) + dark * alpha + hatch);
      }
    }
  }
}

double strut_page_ink_sum(const strut_page_ink *ink, strut_box box) {
  int x[2], y[2];
  double sum = 0.0;
  clip_squares(ink, box, x, y);
  for (int row = y[0]; row <= y[1]; row++)
    for (int column = x[0]; column <= x[1]; column++)
      sum += (double)ink->dark[(size_t)row * (size_t)ink->columns + (size_t)column];
  return sum;
}
