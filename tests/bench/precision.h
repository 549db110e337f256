/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Work-precision: strut's methods and solvers of other libraries integrate the same scenes.
 *
 * The right-hand side of all is strut_forces_acceleration; strut's own methods evaluate the same law in their loops.
 * An answer is the mean x-velocity over the scene's window, of the node or the centre of mass that the scene measures.
 */
#pragma once

#include "engine/base/flag.h"
#include "engine/integrate/integrator.h"

/** A scene to integrate; zero where nothing special. */
typedef struct precision_scene {
  const char *name, *title;
  const char *file;   /* below the project's folder */
  const char *set[4]; /* "name=value" of parameters; NULL after the last */
  double periods;     /* instead of the file's; the last third is the window */
  double loose;       /* factor on the velocity tolerances of implicit methods; 0: 1 */
  bool rigid;         /* also with rigid bars, by strut */
} precision_scene;

/** The i-th scene, or NULL after the last. */
const precision_scene *precision_scene_at(size_t i);

/** A compiled scene, and a state whose q and v hold the point of the latest evaluation. */
typedef struct precision_problem {
  const precision_scene *scene;
  strut_setup setup;
  strut_model *model;
  strut_state *state;
  int n;               /* free coordinates */
  int32_t *coordinate; /* (n) */
  double *a;           /* (length) accelerations */
  double begin, end;   /* of the window [s]; the run begins at 0 */
  int64_t parts;       /* fixed steps divide end / parts */
  double reach, speed; /* largest displacement [m] and velocity [m/s]: units of tolerances */
  int roots;           /* event functions */
  int64_t evaluations;
} precision_problem;

/** Reads and compiles; false with a message on stderr. rigid: with rigid bars. */
bool precision_open(precision_problem *p, const precision_scene *scene, bool rigid);
void precision_close(precision_problem *p);

/** Set when the time of precision_allow is over: the next evaluation of the forces fails. */
extern strut_flag precision_late;
/** Allows so much CPU time from now on [s]; 0: any. */
void precision_allow(double seconds);

/* The initial value problem y' = f(t, y), y = (positions, velocities) of the free coordinates, (2 n). */

/** y at t = 0; forgets what yielded or folded. */
void precision_start(precision_problem *p, double *y);
/** f; false where the time is over or the answer not finite. */
bool precision_rate(precision_problem *p, double t, const double *y, double *rate);
/**
 * Event functions (roots), zero where the forces or their rates jump: the height of each contact, its speeds into the
 * ground and past both edges of the stick band while it is closed, and the stretch of each cable.
 */
void precision_roots(precision_problem *p, double t, const double *y, double *value);
/** After a step: folds keep their piece. True if forces have jumped. */
bool precision_renew(precision_problem *p, double t, const double *y);
/** x that the window's displacement is measured by [m]. */
double precision_place(precision_problem *p, const double *y);
/** The same of positions q (length). */
double precision_place_at(const precision_problem *p, const double *q);

typedef struct precision_answer {
  double velocity;     /* [m/s]; NAN: failed */
  int64_t evaluations; /* of the forces, checks included */
  double seconds;      /* CPU time */
  bool late;           /* ended by precision_allow */
  char note[160];      /* why it failed, or how it went; else empty */
} precision_answer;

/** What a method's settings are. */
typedef enum precision_ladder {
  PRECISION_TOLERANCES, /* 1e-2, 1e-3, ... */
  PRECISION_STEPS,      /* the largest stable one of `like`, and halves */
  PRECISION_LONG_STEPS  /* 1/50 of a part of the run, and halves */
} precision_ladder;

/** One way to integrate a problem. */
typedef struct precision_method {
  const char *name;
  bool strut;
  precision_ladder ladder;
  const char *like; /* strut's method of that name, or with its limit of the step */
  bool roots, implicit, rigid;
  int variant; /* for `solve` */
  /** Solves with a tolerance or step. False: it does not apply, and the note tells why. */
  bool (*solve)(precision_problem *p, const struct precision_method *method, double setting,
                precision_answer *answer);
} precision_method;

/** The method whose settings are promised errors. */
#define PRECISION_ACCURACY "--accuracy"

/** Tables of methods, each ended by one without a name. */
extern const precision_method precision_strut_methods[], precision_gsl_methods[],
    precision_sundials_methods[];

/** One measured cell of the table. */
typedef struct precision_row {
  const precision_method *method;
  double setting, error; /* relative to the reference; NAN: none */
  bool applies;          /* false: refused, see the note */
  precision_answer answer;
} precision_row;

/** Draws error over evaluations and over CPU time of the rows, (count), into an SVG. */
strut_status precision_draw(const char *path, const precision_scene *scene,
                            const precision_row *rows, size_t count, strut_error *error);

/**
 * Measures all methods on all scenes or those named, (count), with so much CPU time per cell [s]. folder: where
 * SCENE.csv and SCENE.svg go, or NULL. Returns the exit code.
 */
int bench_precision(const char *folder, double limit, char *const *names, int count);
/** One scene, few tolerances: do all methods converge to one answer? Returns the exit code. */
int bench_precision_check(void);
