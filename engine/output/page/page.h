/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The page: one HTML file that shows a run or a model, without a network, in any browser.
 *
 * What the program writes is data; what the page does with them is in page.html, page.css and the
 * scripts beside this header, and in Debian's dygraphs, all put into the library at build time. The
 * data are one JSON object in <script type="application/json" id="strut-data">, in which '<', '>' and
 * '&' are written as escapes, so that no name can end it; those of a second run, drawn pale behind
 * the first, are a like object in "strut-beside". On the page, strutPage.show(data, beside) replaces
 * what is shown by such objects any number of times. What it has are the rows of page_data.c, and
 *   motion: null or {
 *     frames, recorded, every: as in strut_trajectory, status: completed|diverged|interrupted,
 *     track: node index or null for the centre of mass (as the scene measures)
 *     time, and each channel but velocities and lengths: null or a block (time and position are always there);
 *     energy_names: [text, ...]; weights: [kg, ...] of the nodes, for the centre of mass }
 *
 * Modes and paths are no part of it: JSON of their results has all their numbers. Data of such a
 * result are those of its structure, on which a page may draw them: as a motion with `made`:
 * {note: text, clock: [text of each frame]}, which has no charts and a camera that rests.
 *
 * A block is {columns, quantum, unit, names, components, data, bytes}: of a channel of things their names, the last of
 * which may be the total, and those of what each has; data, where the scene has some, are those beside each column, by
 * strut_data_dots. Bytes are integers n of `frames` rows, (frames, columns); a
 * value is n * quantum. Column after column, the first number as it is, the second as its difference to the
 * first, from then on the second difference; each as zigzag (2 n, or -2 n - 1 where n < 0) in
 * little-endian groups of 7 bits, all of it deflated (raw, RFC 1951) and in base64. Numbers stay
 * below 2^53. Scripts may give {values: [number, ...]} instead.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "engine/model/model.h"
#include "engine/output/buffer.h"
#include "engine/output/trajectory.h"
#include "engine/scene/experiment.h"
#include "engine/statics/equilibria/equilibria.h"

/** The content of a page. Nothing is owned. */
typedef struct strut_page {
  const strut_model *model;
  const strut_experiment *experiment; /* that `motion` is of */
  const strut_trajectory *motion;     /* NULL: nothing moves */
  const strut_equilibria *equilibria; /* NULL: none are shown */
  const char *remark;                 /* why no equilibria are shown, or NULL */
  const char *summary;                /* the text of summary.json, or NULL */
  const char *yaml;                   /* the scene as text */
  const char *label;                  /* see above, or NULL */
  const struct strut_page *beside;    /* a second run on the same page, or NULL */
  size_t most_bytes;                  /* of the data, about; 0: 4 million. Frames are left out
                                         evenly until they fit, down to two */
} strut_page;

/** The frames on a page; 0 where nothing moves. */
typedef struct strut_page_frames {
  size_t shown, recorded;
} strut_page_frames;

/**
 * The JSON object of the data alone, without what is beside it; the same bytes each time, in a block
 * of strut_allocate, or NULL with the error. `frames` may be NULL.
 */
STRUT_API char *strut_page_data(const strut_page *page, strut_page_frames *frames,
                                strut_error *error);
/** The whole file likewise. `frames`, which may be NULL, are two where there is a page beside it. */
STRUT_API char *strut_page_html(const strut_page *page, strut_page_frames *frames,
                                strut_error *error);

/* ---- arrays over time as compact blocks ---- */

/** An array (frames, columns) of which every `every`-th frame is used, and the last. */
typedef struct strut_rows {
  const double *values; /* finite */
  size_t frames, columns, every;
} strut_rows;

/** The number of frames used. */
STRUT_API size_t strut_rows_taken(const strut_rows *rows);
/** Offset of the i-th series. */
STRUT_API const double *strut_rows_at(const strut_rows *rows, size_t i);
/** The largest magnitude among all frames. */
STRUT_API double strut_rows_largest(const strut_rows *rows);

/** As many quanta as a value may have at most: so that no number of a block reaches 2^53. */
#define STRUT_MOST_QUANTA 562949953421312.0 /* 2^49 */

/**
 * The largest number of the form 1, 2 or 5 times a power of ten that is not above `wanted`; but
 * large enough that `largest` has at most STRUT_MOST_QUANTA of it.
 */
STRUT_API double strut_round_quantum(double wanted, double largest);
/** True if every value of rows is a whole multiple of `quantum`, to the last bits of a double. */
STRUT_API bool strut_rows_multiples(const strut_rows *rows, double quantum);

/** The bytes of a block before they become base64. */
typedef struct strut_block {
  double quantum;
  size_t columns, size;
  unsigned char *bytes; /* (size) deflated; owned */
} strut_block;

/** False when memory is out. No value may be more than STRUT_MOST_QUANTA quanta. */
STRUT_API bool strut_block_encode(const strut_rows *rows, double quantum, strut_block *block);
/** A zeroed block is allowed; it is zeroed again. */
STRUT_API void strut_block_free(strut_block *block);

/**
 * The value of the key motion, about `room` bytes of it, or null, in a block of strut_allocate; NULL: no memory. Frames
 * from the first that is not finite, or far out of all bounds, are left out; then as many evenly as it takes.
 */
STRUT_API char *strut_page_motion(const strut_page *page, size_t room, strut_page_frames *frames);
