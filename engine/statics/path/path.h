/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The path of equilibria as a parameter changes, past limit points too: a load's factor, an
 * actuator's length, the displacement of a node, or anything that a scene depends on.
 *
 * Arc-length continuation: predictor along the tangent, Newton's method with one condition on the
 * length of the step. Between events what is taut and what touches stays fixed, so that the path is
 * smooth there. Where that changes the path has a kink: the stiffness is another one on each side,
 * and stability is judged on both. Positions carry twice a double's digits, so that stiff bars do
 * not spoil the forces.
 */
#pragma once

#include "engine/model/model.h"
#include "engine/scene/experiment.h"
#include "engine/scene/value_rows.h"

/** What 0 steps stand for. */
#define STRUT_PATH_USUAL_STEPS 400

/** Free coordinates that a path is followed with at most: its matrices are dense. */
enum { STRUT_PATH_COORDINATES = 600 };

/** What may happen on a path, with its name. */
#define STRUT_PATH_EVENTS(X)                                                                       \
  X(LIMIT, "limit point") /* the parameter turns back */                                           \
  /* an eigenvalue of the stiffness changes its sign, the parameter goes on */                     \
  X(BIFURCATION, "bifurcation")                                                                    \
  X(SLACK, "slack")                                                                                \
  X(TAUT, "taut")                                                                                  \
  X(TOUCHDOWN, "touchdown")                                                                        \
  X(LIFT_OFF, "lift-off")                                                                          \
  /* the parameter turns back at a kink: no eigenvalue passes zero */                              \
  X(KINK_LIMIT, "limit point at a kink")                                                           \
  /* the parameter continues, but the number of negative eigenvalues jumps */                      \
  X(KINK_BIFURCATION, "bifurcation at a kink")                                                     \
  X(ENGAGE, "engages") /* a stop is reached, or another element of one sign begins to act */       \
  X(RELEASE, "releases")                                                                           \
  X(LAW, "kink of a law")                                                                          \
  X(CORNER, "corner") /* a node passes a corner of a profile, where the force on it turns */       \
  X(SLIP, "slips")                                                                                 \
  X(STICK, "sticks")                                                                               \
  X(ZERO_LENGTH, "zero length") /* a member shrinks to nothing, and its force turns round */       \
  X(MECHANISM, "mechanism")     /* motions without stiffness, from which the path leads on */

typedef enum strut_path_event_kind {
#define STRUT_PATH_EVENT(NAME, text) STRUT_PATH_##NAME,
  STRUT_PATH_EVENTS(STRUT_PATH_EVENT)
} strut_path_event_kind;

STRUT_API const char *strut_path_event_name(strut_path_event_kind kind);

/** What a path is at one of its points or events. */
typedef struct strut_path_state {
  double factor;    /* the parameter: a load's factor [1], else in its SI unit */
  double arc;       /* from the beginning; coordinates in units of the structure's size, the
                        parameter in units of the range asked for [1] */
  double *q;        /* (length) [m] */
  double *force;    /* (members) tension, with stops [N] */
  double *moment;   /* (hinges) [N m] */
  double *pressure; /* (cells) inside [N/m] */
  double *distance; /* (distances) force [N] */
  double *reaction; /* (length) force of supports on held coordinates, else 0 [N] */
  double *contact;  /* (contacts) normal force of the ground [N] */
  double *friction; /* (contacts) on the node along the tangent; 0 unless it is kept [N] */
} strut_path_state;

typedef struct strut_path_point {
  strut_path_state at;
  int32_t negative; /* eigenvalues of the stiffness below zero beyond it: 0 is stable */
} strut_path_point;

typedef struct strut_path_event {
  strut_path_state at;
  strut_path_event_kind kind;
  int32_t index; /* of the member or node that changes, of a guide's node; of the node that moves
                         most at a limit point or bifurcation; of the element that engages, releases or
                         passes a kink */
  int32_t before, after; /* eigenvalues of the stiffness below zero on its two sides */
  const char *detail;    /* in words */
} strut_path_event;

/** Why a path ends, with the word for it in files. */
#define STRUT_PATH_ENDS(X)                                                                         \
  X(UNTIL, "until")                                                                                \
  X(STOP, "stop")                                                                                  \
  X(STEPS, "steps")     /* the maximum number of steps */                                          \
  X(AWAY, "away")       /* a node left all bounds, or the parameter went ten ranges back */        \
  X(LOST, "lost")       /* no equilibrium nearby; the remark says where */                         \
  X(INVALID, "invalid") /* the scene is invalid beyond this value; the remark says why */          \
  X(CLOSED, "closed")   /* it came back to its first point */                                      \
  X(JOINED, "joined")   /* of a branch: at a bifurcation found before; the remark says where */

typedef enum strut_path_end {
#define STRUT_PATH_END(NAME, text) STRUT_PATH_##NAME,
  STRUT_PATH_ENDS(STRUT_PATH_END)
} strut_path_end;

STRUT_API const char *strut_path_end_word(strut_path_end end);

/** Branches that are followed from one path at most, those of its branches included. */
#define STRUT_PATH_BRANCHES 256

/** The parameter of the continuation. */
typedef enum strut_path_over {
  STRUT_PATH_OVER_LOAD,       /* a factor of loads */
  STRUT_PATH_OVER_ACTUATOR,   /* what an actuator adds to its member's rest length [m], or to its
                                 hinge's rest angle [rad] */
  STRUT_PATH_OVER_COORDINATE, /* displacement of a node along x or y [m] */
  STRUT_PATH_OVER_SCENE       /* a number that scenes are made of */
} strut_path_over;

typedef struct strut_path {
  strut_path_over over;
  const char *load;   /* the load's name, or NULL: all loads without a signal */
  const char *name;   /* what is continued over, for people */
  const char *unit;   /* its SI unit; "" for none */
  double reference;   /* [N] that a load's factor 1 stands for where all loads are alike; else 0 */
  bool several;       /* it is so for each of several loads */
  int32_t coordinate; /* that is displaced, 2 node + 1 for y; else -1 */
  bool friction;      /* it was kept */
  bool grips;         /* and some contact has static friction */
  size_t point_count, event_count;
  strut_path_point *points;
  strut_path_event *events;
  strut_path_end end;
  char remark[1000];      /* why it ended before `until`, and long parts on which nothing happens */
  const double *material; /* (slots) of cables that rub at guides, at the end: capstan.h; or NULL */
  const int *guide_mode;  /* (slots) what slipped last at their guides; or NULL */
  const int *piece;       /* (elements) of the law of each at the end, as elements.h counts them */
  const uint8_t *held;    /* (length) 1 where a coordinate has a reaction, in some stage */
  size_t stage_count;
  struct strut_path *stages; /* (stage_count) of a path in stages, those before this one */
  size_t branch_count;
  struct strut_path *branches; /* (branch_count) of branches, too: all are listed here */
  /** Of a branch: where it leaves, and what it resembles. Branches are numbered from 1. */
  struct {
    int32_t path;       /* the branch that it leaves, 0: the path itself */
    double factor, arc; /* of the bifurcation there */
    int32_t twin; /* the branch to the other side, if the parameter does the same on it; or 0 */
  } from;
  strut_arena arena;
} strut_path;

/** Rows of a strut_path, and of a strut_path_state in it. */
STRUT_API extern const strut_value_rows strut_path_values;
STRUT_API extern const strut_value_rows strut_path_state_values;

/** The scene, and its experiment, where the parameter has a value; the caller frees `setup`. */
typedef strut_status (*strut_path_scene_at)(void *context, double value, strut_setup *setup,
                                            strut_error *error);

/** A displacement at which a path ends, counted from where it begins. */
typedef struct strut_path_stop {
  bool given;
  int32_t coordinate;  /* 2 node + 1 for y */
  double displacement; /* [m] */
} strut_path_stop;

typedef struct strut_path_options {
  strut_path_over over;
  const char *load; /* over a load: its name; NULL: all loads without a signal */
  int32_t index;    /* of the actuator; of the coordinate, 2 node + 1 for y */
  const char *name; /* over a scene's number: its name, and its SI unit ("" for none) */
  const char *unit;
  strut_path_scene_at scene_at;
  void *context;
  const char *at;      /* equilibrium to begin at by name; NULL: where the start comes to rest */
  const double *start; /* (length) or, before `at`, the equilibrium itself, with the parameter at
                          `from`; a coordinate that is displaced has its value there */
  bool friction;       /* static and kinetic friction act, by the history of the path */
  const strut_path *after; /* with `start`: the path that this one continues, with its memory */
  double from;             /* where the path begins: in SI, or the factor */
  double until;            /* where it ends; a load's factor from 0 to 0 ends at 1 */
  int32_t steps;           /* maximum number of steps; 0: the usual ones; of each branch, too */
  int32_t branches;     /* bifurcations are left for other paths: 1 on this path, 2 on its branches
                           too, ... */
  strut_path_stop stop; /* or earlier, here */
} strut_path_options;

/**
 * Begins at an equilibrium of the structure where the parameter is `from`: of loads, that without
 * them unless from says more. Everything else stays as it is. A free coordinate that is displaced
 * is held from the beginning: displacement counts from where the equilibrium has it. A named load
 * with a signal counts with its force alone. Friction and drives are left out. strut_path_free
 * releases it, after a failure too; model and options' texts must outlive it. STRUT_USAGE for a
 * load that is not there or no load at all, a parameter that does nothing or changes what the
 * structure is made of; STRUT_NOT_SETTLED where there is no equilibrium to begin at,
 * STRUT_NO_MEMORY, and what scene_at fails with at `from`.
 */
STRUT_API strut_status strut_path_follow(const strut_model *model,
                                         const strut_experiment *experiment,
                                         const strut_path_options *options, strut_path *path,
                                         strut_error *error);
STRUT_API void strut_path_free(strut_path *path);
/**
 * Follows the stages of the experiment one after the other, each from the end of the one before: loads
 * that a stage names begin with the factor 0, and keep what their last stage gave them, as do actuators
 * and displaced coordinates until they are released. `path` is that of the last stage that was begun,
 * with those before it in path->stages; its remark says which stages were not begun, and why.
 * Of `usual` count `at`, of the first stage; `branches`, of the last; and `steps`, where a stage gives
 * none. Errors as strut_path_follow.
 */
STRUT_API strut_status strut_path_follow_stages(const strut_model *model,
                                                const strut_experiment *experiment,
                                                const strut_path_options *usual, strut_path *path,
                                                strut_error *error);
