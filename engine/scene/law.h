/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Elastic laws: the force of a member, the moment of a hinge, as a function of its strain.
 *
 * A law is a row of STRUT_LAWS and two functions in a header of engine/scene/laws. It knows material
 * only: e is any strain (a length [m], an angle [rad], an area [m^2]), e0 its natural value, x = e - e0,
 * and the force is the one that does work on e. Laws of cells are in laws/cells.h.
 * Reader, checks, forces, energies, stiffness, statics and located events loop over this table, so that a
 * law is added only here; see docs/dev/recipes.md.
 */
#pragma once

#include "engine/base/status.h"
#include "engine/scene/laws/cells.h"
#include "engine/scene/laws/curves.h"
#include "engine/scene/laws/springs.h"

/**
 * The laws: X(NAME, name, word, needs, context); context is passed on. needs: bits of the parameters
 * (laws/numbers.h) that the law needs, NAME_MAY that it may have, 0 if not given; OWN: it has a stiffness
 * of its own, so that the element must not give one.
 */
#define STRUT_LAWS(X, context)                                                                     \
  X(LINEAR, linear, "linear", 0, context)                                                          \
  X(BILINEAR, bilinear, "bilinear", KNEE_BIT | SECOND_STIFFNESS_BIT, context)                      \
  X(PLAY, play, "play", GAP_BIT, context)                                                          \
  X(ELASTIC_PLASTIC, elastic_plastic, "elastic_plastic", YIELD_BIT | SECOND_STIFFNESS_MAY,         \
    context)                                                                                       \
  X(POLYNOMIAL, polynomial, "polynomial", COEFFICIENTS_BIT | OWN, context)                         \
  X(LOGARITHMIC, logarithmic, "logarithmic", 0, context)                                           \
  X(EXPONENTIAL, exponential, "exponential", SCALE_BIT, context)                                   \
  X(TABLE, table, "table", POINTS_BIT | OWN, context)                                              \
  X(FOLDING, folding, "curve", POINTS_MAY | CONTROL_POINTS_MAY | OWN, context)

/**
 * Those of members and hinges come first, then the one that a model gives to members with an axial_stiffness
 * whose rest length is driven. No scene can ask for that, so that it has no word.
 */
#define STRUT_ALL_LAWS(X, context)                                                                 \
  STRUT_LAWS(X, context) X(AXIAL, axial, "", 0, context) STRUT_CELL_LAWS(X, context)

typedef enum strut_law_kind {
#define STRUT_LAW_ROW(NAME, ...) STRUT_LAW_##NAME,
  STRUT_ALL_LAWS(STRUT_LAW_ROW, )
#undef STRUT_LAW_ROW
      STRUT_LAW_COUNT
} strut_law_kind;
/** Laws of members and hinges. */
enum { STRUT_MEMBER_LAW_COUNT = STRUT_LAW_AXIAL };

enum {
#define STRUT_LAW_ROW(NAME, ...) STRUT_LAW_PARAMETER_##NAME,
  STRUT_LAW_PARAMETERS(STRUT_LAW_ROW) STRUT_LAW_LISTS(STRUT_LAW_ROW)
#undef STRUT_LAW_ROW
      STRUT_LAW_PARAMETER_COUNT,
  STRUT_LAW_NUMBER_COUNT = STRUT_LAW_PARAMETER_COEFFICIENTS /* the lists come last */
};

/** Which sign of force is carried. One that is not carried, or beyond the natural strain, is none. */
typedef enum strut_carries {
  STRUT_CARRIES_BOTH,
  STRUT_CARRIES_TENSION,
  STRUT_CARRIES_COMPRESSION
} strut_carries;

/** Where the points of a law come from. */
typedef enum strut_law_source {
  STRUT_LAW_POINTS,
  STRUT_LAW_CONTROL_POINTS, /* of a curve: of one Bezier curve */
  STRUT_LAW_DATA_POINTS     /* of a table: measured ones */
} strut_law_source;

/** A law as a scene describes it. */
typedef struct strut_law {
  strut_law_kind kind;
  strut_carries carries;
#define STRUT_LAW_ROW(NAME, field, ...) double field;
  STRUT_LAW_PARAMETERS(STRUT_LAW_ROW)
#undef STRUT_LAW_ROW
  size_t count;
  const double *x, *force; /* (count) points of a table; of a polynomial coefficients, in `force` */
  bool smooth;             /* of a table: a monotone spline instead of straight lines */
  strut_law_source source; /* of these points */
  const char *data, *over; /* of measured ones: the columns of force and x */
  bool mirrored;           /* of both: x and force count with both signs */
  double rounding;         /* of a curve: share of each piece that its rounded corners take */
} strut_law;

typedef struct strut_law_row {
  const char *word;
  unsigned needs; /* bit p: parameter p */
  bool own;       /* the stiffness is part of its numbers */
  unsigned may;   /* bit p: parameter p may be given */
} strut_law_row;

/** The words of the laws as the key table lists them: "linear|bilinear|...". */
#define STRUT_LAW_WORD(NAME, name, word, ...) "|" word
#define STRUT_LAW_WORDS (&("" STRUT_LAWS(STRUT_LAW_WORD, ))[1])

/** The row of a valid law. */
static inline const strut_law_row *strut_law_at(strut_law_kind kind) {
  enum {
    MAY = 16, /* bits from here on: what may be given */
    LOW = (1 << STRUT_LAW_PARAMETER_COUNT) - 1,
#define STRUT_LAW_ROW(NAME, ...)                                                                   \
  NAME##_BIT = 1 << STRUT_LAW_PARAMETER_##NAME, NAME##_MAY = NAME##_BIT << MAY,
    STRUT_LAW_PARAMETERS(STRUT_LAW_ROW) STRUT_LAW_LISTS(STRUT_LAW_ROW)
#undef STRUT_LAW_ROW
        OWN = 1 << STRUT_LAW_PARAMETER_COUNT
  };
  static const strut_law_row rows[] = {
#define STRUT_LAW_ROW(NAME, name, word, needs, context)                                            \
  {word, (needs)&LOW, ((needs)&OWN) != 0, (needs) >> MAY},
      STRUT_ALL_LAWS(STRUT_LAW_ROW, )
#undef STRUT_LAW_ROW
  };
  return &rows[kind];
}

/** Is it a law of STRUT_CELL_LAWS? */
static inline bool strut_law_is_of_cells(strut_law_kind kind) { return kind >= STRUT_LAW_PRESSURE; }

static inline bool strut_law_needs(strut_law_kind kind, int parameter) {
  return strut_law_at(kind)->needs >> parameter & 1u;
}

/** May the parameter be given, needed or not? */
static inline bool strut_law_allows(strut_law_kind kind, int parameter) {
  return strut_law_needs(kind, parameter) || strut_law_at(kind)->may >> parameter & 1u;
}

/** A parameter of laws; the lists, which come last, have a key only. */
typedef struct strut_law_parameter {
  const char *key;
  bool above_zero; /* where a law needs it */
  int power;     /* it is a force over this power of a strain: 1 a slope, 0 a force; -1: a strain */
  size_t offset; /* in a strut_law */
} strut_law_parameter;

static inline const strut_law_parameter *strut_law_parameter_at(int p) {
  enum { ANY_NUMBER, ABOVE_ZERO };
  enum { STRAIN = -1, FORCE, SLOPE };
  static const strut_law_parameter rows[] = {
#define STRUT_LAW_ROW(NAME, field, range, measure)                                                 \
  {#field, range == ABOVE_ZERO, measure, offsetof(strut_law, field)},
#define STRUT_LAW_LIST(NAME, field, ...) {#field, false, 0, 0},
      STRUT_LAW_PARAMETERS(STRUT_LAW_ROW) STRUT_LAW_LISTS(STRUT_LAW_LIST)
#undef STRUT_LAW_ROW
  };
  return &rows[p];
}

/** The law's number p, p < STRUT_LAW_NUMBER_COUNT. */
static inline double *strut_law_number(strut_law *law, int p) {
  return (double *)(void *)((char *)law + strut_law_parameter_at(p)->offset);
}
static inline double strut_law_value(const strut_law *law, int p) {
  return *(const double *)(const void *)((const char *)law + strut_law_parameter_at(p)->offset);
}

/*
 * Law axial: the law `material` of a member with a stiffness that is EA over the present natural strain.
 */

/** The law by itself, with the stiffness in n. */
static inline strut_law_response strut_law_of_material(const strut_law_numbers *n, double e,
                                                       double e0, int piece) {
  switch (n->material) {
#define STRUT_LAW_ROW(NAME, name, ...)                                                             \
  case STRUT_LAW_##NAME: return strut_law_##name(n, e, e0, piece);
    STRUT_LAWS(STRUT_LAW_ROW, )
#undef STRUT_LAW_ROW
    default: break;
  }
  return (strut_law_response){0.0, 0.0, 0.0, 0.0};
}

/** Share of the first natural strain below which none is left. */
#define STRUT_AXIAL_LEAST 1e-6

/**
 * The natural strain over which EA is taken. Below the least one the stiffness stays what it is there, so that
 * a step that went too far can be judged; a run stops.
 */
static inline double strut_axial_length(const strut_law_numbers *n, double e0) {
  double least = STRUT_AXIAL_LEAST * n->axial / n->stiffness;
  return e0 > least ? e0 : least;
}

static inline strut_law_response strut_law_axial(const strut_law_numbers *n, double e, double e0,
                                                 int piece) {
  strut_law_numbers now = *n;
  now.stiffness = n->axial / strut_axial_length(n, e0);
  strut_law_response r = strut_law_of_material(&now, e, e0, piece);
  double energy = r.energy;
  if (n->second_stiffness != 0.0) { /* the energy that is in proportion to EA */
    now.second_stiffness = 0.0;
    energy = strut_law_of_material(&now, e, e0, piece).energy;
  }
  if (strut_axial_length(n, e0) == e0) r.excess -= energy / e0;
  return r;
}

static inline int strut_law_axial_kinks(const strut_law_numbers *n) {
  switch (n->material) {
#define STRUT_LAW_ROW(NAME, name, ...)                                                             \
  case STRUT_LAW_##NAME: return strut_law_##name##_kinks(n);
    STRUT_LAWS(STRUT_LAW_ROW, )
#undef STRUT_LAW_ROW
    default: break;
  }
  return 0;
}

static inline double strut_law_axial_kink(const strut_law_numbers *n, int k) {
  switch (n->material) {
#define STRUT_LAW_ROW(NAME, name, ...)                                                             \
  case STRUT_LAW_##NAME: return strut_law_##name##_kink(n, k);
    STRUT_LAWS(STRUT_LAW_ROW, )
#undef STRUT_LAW_ROW
    default: break;
  }
  return 0.0;
}

/** Force, energy and slope at strain e. piece: the smooth piece to stay on, or -1 for the one at e. */
static inline strut_law_response strut_law_respond(strut_law_kind kind, const strut_law_numbers *n,
                                                   double e, double e0, int piece) {
  switch (kind) {
#define STRUT_LAW_ROW(NAME, name, ...)                                                             \
  case STRUT_LAW_##NAME: return strut_law_##name(n, e, e0, piece);
    STRUT_ALL_LAWS(STRUT_LAW_ROW, )
#undef STRUT_LAW_ROW
    case STRUT_LAW_COUNT: break;
  }
  return (strut_law_response){0.0, 0.0, 0.0, 0.0};
}

/** Number of x at which the law changes its slope or jumps. */
static inline int strut_law_kinks(strut_law_kind kind, const strut_law_numbers *n) {
  switch (kind) {
#define STRUT_LAW_ROW(NAME, name, ...)                                                             \
  case STRUT_LAW_##NAME: return strut_law_##name##_kinks(n);
    STRUT_ALL_LAWS(STRUT_LAW_ROW, )
#undef STRUT_LAW_ROW
    case STRUT_LAW_COUNT: break;
  }
  return 0;
}

/** The x of kink k, ascending. */
static inline double strut_law_kink(strut_law_kind kind, const strut_law_numbers *n, int k) {
  switch (kind) {
#define STRUT_LAW_ROW(NAME, name, ...)                                                             \
  case STRUT_LAW_##NAME: return strut_law_##name##_kink(n, k);
    STRUT_ALL_LAWS(STRUT_LAW_ROW, )
#undef STRUT_LAW_ROW
    case STRUT_LAW_COUNT: break;
  }
  return 0.0;
}

/** Does x grow (1) or fall (-1) along a piece, from the one before it to the one after it? */
static inline int strut_law_way(strut_law_kind kind, const strut_law_numbers *n, int piece) {
  return kind == STRUT_LAW_FOLDING ? strut_folding_way(n->curve, piece) : 1;
}

/** Distances of x from the begin and the end of a piece; INFINITY where it has none. */
static inline void strut_law_margins(strut_law_kind kind, const strut_law_numbers *n, int piece,
                                     double x, double *low, double *high) {
  double way = strut_law_way(kind, n, piece);
  *low = piece > 0 ? way * (x - strut_law_kink(kind, n, piece - 1)) : HUGE_VAL;
  *high = piece < strut_law_kinks(kind, n) ? way * (strut_law_kink(kind, n, piece) - x) : HUGE_VAL;
}

/** The smooth piece in which x lies: the number of kinks below it. Of a curve see history.h. */
static inline int strut_law_piece(strut_law_kind kind, const strut_law_numbers *n, double x) {
  int kinks = strut_law_kinks(kind, n), piece = 0;
  while (piece < kinks && strut_law_kink(kind, n, piece) < x) piece++;
  return piece;
}

/*
 * The points of a law `table` or `curve`: those given, or of the Bezier curve or the rounded corners that they
 * describe, and their mirror images.
 */

/** Control points that a Bezier curve has at most. */
enum { STRUT_MOST_CONTROL_POINTS = 64 };

/** A point with its elongation and its force; slope: of the force there, NAN where the law is straight. */
typedef struct strut_curve_point {
  double x, force, slope;
} strut_curve_point;

/** At least as many as strut_curve_trace fills in. */
STRUT_API size_t strut_curve_room(const strut_law *law);
/**
 * Fills in the points of a law that strut_curve_fault finds no fault in, from one end to the other, and
 * returns how many there are. Folds are among them. Between two of which a slope is NAN the law is straight.
 */
STRUT_API size_t strut_curve_trace(const strut_law *law, strut_curve_point *point);
/** What is wrong with the points of a law that has some, at least two, if their numbers are finite, or NULL. */
STRUT_API const char *strut_curve_fault(const strut_law *law);
