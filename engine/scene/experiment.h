/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The experiment done on a scene: how its start is found, the method, step and duration of a run,
 * what is measured and recorded, and how equilibria are searched for.
 *
 * A scene compiles to one model, on which any number of experiments can run. Indices refer to the
 * scene's arrays.
 */
#ifndef STRUT_ENGINE_SCENE_EXPERIMENT_H
#define STRUT_ENGINE_SCENE_EXPERIMENT_H

#include "engine/scene/quantity.h"
#include "engine/scene/scene.h"

enum { STRUT_USUAL_BUDGET = 20 }; /* see strut_experiment.budget */

/** Coming to rest before t = 0: actuators, loads with a signal and the belt are off. */
typedef struct strut_settle {
  bool wanted;
  bool friction;       /* kept; off by default, as in the paper: then nothing holds on a slope */
  double speed;        /* at rest when every speed is below this [m/s]; paper 1e-8 */
  double acceleration; /* and every acceleration below this [m/s^2]; paper 1e-8 */
  double limit;        /* gives up after this much simulated time [s] */
  double
      evaluations; /* and after this many evaluations of the forces; 0: STRUT_SETTLE_EVALUATIONS */
  double step;     /* of the Runge-Kutta method that settles [s]; 0: the experiment's, whatever its
                          method; below zero: chosen by the stability limit */
  bool perturb;    /* leave an equilibrium that is unstable, and settle again */
} strut_settle;

static const double STRUT_SETTLE_EVALUATIONS = 4e7;

typedef enum strut_channel {
  STRUT_CHANNEL_POSITION = 1,
  STRUT_CHANNEL_VELOCITY = 2,
  STRUT_CHANNEL_LENGTH = 4,
  STRUT_CHANNEL_FORCE = 8,
  STRUT_CHANNEL_CONTACT = 16,
  STRUT_CHANNEL_ENERGY = 32
} strut_channel;

enum { STRUT_MOST_STARTS = 1000000000 };
#define STRUT_MOST_SEED 9007199254740992.0 /* 2^53: every seed is a number of the language */

/** How all equilibria are looked for. */
typedef struct strut_search {
  size_t support_count;     /* sets of contact nodes to hold in turn; 0: every one that is needed */
  strut_node_set *supports; /* (support_count) of each set the first node is pinned, others roll */
  int64_t starts;           /* random starts for each set, up to STRUT_MOST_STARTS; 0: until
                               little can be missing */
  uint64_t seed;            /* up to STRUT_MOST_SEED */
} strut_search;

/** Stopping when the motion repeats itself, in a run by periods. */
typedef struct strut_steady {
  bool wanted;
  double tolerance;   /* of the measured velocity, relative to it [1]; default 0.005 */
  double floor;       /* differences below this count as none [m/s]; 0: taken from the scene */
  int32_t successive; /* so many repetitions in a row must agree; default 5 */
  double
      mean_tolerance; /* of an irregular motion's mean velocity [1], where the run goes on from one
                            that was long enough already; 0: tolerance */
  bool shooting;      /* finish the orbit by Newton's method, and give its Floquet multipliers */
} strut_steady;

/**
 * X(row, "word"): the methods of integration, in the order of their table; their rows strut_integrator_*
 * are in engine/integrate.
 */
#define STRUT_INTEGRATORS(X)                                                                       \
  X(rk4, "rk4")                                                                                    \
  X(euler, "euler")                                                                                \
  X(verlet, "verlet")                                                                              \
  X(rk4_events, "rk4-events")                                                                      \
  X(euler_events, "euler-events")                                                                  \
  X(verlet_events, "verlet-events")                                                                \
  X(adaptive, "adaptive")                                                                          \
  X(midpoint, "midpoint")
/** Their words as the key table lists them: "rk4|euler|...". */
#define STRUT_INTEGRATOR_WORD(row, word) "|" word
#define STRUT_INTEGRATOR_WORDS (&("" STRUT_INTEGRATORS(STRUT_INTEGRATOR_WORD))[1])

/** How the start is found, what to integrate, for how long, and what to measure. */
typedef struct strut_experiment {
  const char *integrator; /* name in the table of methods; default "rk4" */
  double step;            /* dt [s], > 0; of an adaptive method the largest; 0: it is chosen */
  double tolerance;       /* of an adaptive method, relative [1]; default 1e-6 */
  double refine;          /* after a touchdown steps so much shorter [1], by methods that do; 0:
                             taken from the scene; 1: none */
  double refine_time;     /* for so long [s]; 0: taken from the scene */
  double refine_rate;     /* taken from the scene: fastest rate of a closed contact times the short
                             step [1]; default 0.25 */
  double refine_memory;   /* taken from the scene: so many relaxation times long [1]; default 8 */
  double accuracy;        /* wanted of the measured quantity, relative [1]: method and step are
                             chosen by it; 0: they are as given */
  double budget;          /* work allowed for that, in fine runs by a fixed step */
  strut_steady steady;
  strut_settle settle;   /* before t = 0 */
  strut_search search;   /* of equilibria */
  double duration;       /* [s]; 0 when given in periods */
  double periods;        /* number of periods of signal `period_signal`; 0 when in seconds */
  int32_t period_signal; /* or -1 */
  const char *period_of; /* the name the file used for it, or NULL */
  double measure_last;   /* window: the last so many periods (if periods > 0), else seconds; 0 =
                             the whole run */
  int32_t measure_node;  /* whose velocity (14) is measured; -1: the centre of mass */
  size_t quantity_count;
  strut_quantity_definition *quantities; /* (quantity_count) measured beside that velocity */
  double output_every; /* sampling interval [s]; 0: a thousandth of the recorded time */
  double output_last;  /* record only the last so many periods or seconds; 0: all */
  unsigned channels;   /* strut_channel bits; default position, length, force */
} strut_experiment;

/** A scene and the experiment on it: what a file of the language describes. */
typedef struct strut_setup {
  strut_scene scene; /* its arena also owns the experiment's texts and arrays */
  strut_experiment experiment;
} strut_setup;

/** The experiment where nothing is said of it. */
STRUT_API strut_experiment strut_experiment_default(void);
/** A scene by strut_scene_init, with the default experiment. */
STRUT_API void strut_setup_init(strut_setup *setup);
/** Frees all that the scene and the experiment own, and zeroes both. */
STRUT_API void strut_setup_free(strut_setup *setup);

/** Duration, drive period and measuring window that the experiment amounts to, all in [s]. */
typedef struct strut_span {
  double duration;
  double period;       /* 0 when the run is given in seconds */
  double window_start; /* the window ends with the run */
  double record_start; /* first time to record */
  double record_every;
} strut_span;
STRUT_API strut_span strut_experiment_span(const strut_experiment *experiment,
                                           const strut_scene *scene);

#endif
