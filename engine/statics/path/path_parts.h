/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What an equilibrium path is made of: its parameter, its equations, events on it, and the walk. */
#pragma once

#include <gsl/gsl_matrix.h>
#include <gsl/gsl_permutation.h>

#include "engine/base/arithmetic.h"
#include "engine/base/vec.h"
#include "engine/statics/path/path.h"
#include "engine/statics/potential.h"

/* The parameter of a path: how each number of the equations depends on it. */

/**
 * Numbers of the equations that a parameter may change, or their derivatives with respect to it.
 */
typedef struct strut_path_terms {
  double *stiffness;               /* (slots) [N/m] */
  double *rest, *rest_low;         /* (slots) rest length as a sum of two [m] */
  double *position, *position_low; /* (length) of held coordinates, likewise [m] */
  double *force;                   /* (length) gravity and loads [N] */
  const strut_model *laws;         /* with elements, contacts and grounds of these numbers */
  struct strut_path_scene *scene; /* that `laws` is of if it is not the path's own model, or NULL */
} strut_path_terms;

/** strut_path_parameter_create fills it; of the one in use the address must not change. */
typedef struct strut_path_parameter {
  const strut_path_options *options;
  const strut_model *model;         /* at `from`: of all others the structure must be the same */
  const double *load;               /* (length) loads at factor 1 [N], then (slots) moments [N m] */
  double from, range;               /* [SI]; range is not 0 */
  strut_path_terms base, low, high; /* at `from`, and to both sides as the latest rates took them */
  double apart;                     /* of these two */
  double refused_at;                /* the last value that was refused, and why */
  strut_error refusal;              /* STRUT_OK: none was */
} strut_path_parameter;

/** Terms of zeros in the arena; false: out of memory. */
bool strut_path_terms_create(const strut_model *model, strut_arena *arena, strut_path_terms *terms);
/** Releases the scene that terms were read from; what lies in the arena stays. */
void strut_path_terms_release(strut_path_terms *terms);

/**
 * Completes a parameter with model, options, load, from and range; `position` (length) are the held coordinates at `from`. STRUT_USAGE where the parameter changes
 * nothing at rest, or the structure itself; STRUT_NO_MEMORY.
 */
strut_status strut_path_parameter_create(strut_path_parameter *parameter, const double *position,
                                         strut_arena *arena, strut_error *error);

/** The terms at a value; false: there are none, parameter->refusal says why. */
bool strut_path_parameter_terms(strut_path_parameter *parameter, strut_dd value,
                                strut_path_terms *terms);
/** Their derivatives with respect to the parameter; false likewise. */
bool strut_path_parameter_rates(strut_path_parameter *parameter, double value,
                                strut_path_terms *rates);

/* Elements in the equations of a path: running cables, hinges, other laws, stops. For system.c.
 *
 * They are evaluated in double. Which ones act and on which smooth piece of its law each stays is
 * frozen between events, as for cables. An angle stays near that of the last point kept, so that it
 * is continuous over whole turns.
 */

struct strut_path_system;

/** An element at the point that was evaluated last. */
typedef struct strut_path_element {
  double rate;       /* of its force with the parameter, its strain held */
  double turn;       /* value near which an angle is taken; NAN: its natural one */
  bool acts, turned; /* straight, and shrunk to nothing since the last point */
  int piece;         /* of its law */
} strut_path_element;

/** What may change about an element: whether it acts (kink -1), or on which side of a kink it is. */
typedef struct strut_path_element_switch {
  int32_t element, kink;
} strut_path_element_switch;

typedef struct strut_path_elements {
  int32_t switch_count;
  strut_path_element *element;         /* (elements) */
  double noise;                        /* rounding of the stiffest [N/m] */
  strut_path_element_switch *switches; /* (switch_count) kinks of one element ascending */
  double *material; /* (slots) of cables that rub at guides, at the last point; or NULL */
  int *guide_mode;  /* (slots) STRUT_GUIDE_*, by the same places */
} strut_path_elements;

/** False: out of memory. */
bool strut_path_elements_create(const strut_model *model, strut_arena *arena,
                                strut_path_elements *elements);

/** Adds forces, stiffness and the parameter's slope of all elements at system->q. */
void strut_path_add_elements(struct strut_path_system *system);

/** As strut_path_switch_value, for an element's switch at the terms and positions of the system. */
double strut_path_element_switch_value(const struct strut_path_system *system, int32_t which);

/* Cables that rub at their guides, in a path that keeps friction. For parameter.c and walk.c. */

/** Is this element such a cable? */
bool strut_path_rubs(const struct strut_path_system *system, int32_t element);
/** Is there one? Then the stiffness has no symmetry. */
bool strut_path_has_rubbing(const struct strut_path_system *system);
/** In place of its forces, stiffness and slope as an element. */
void strut_path_add_rubbing(struct strut_path_system *system, int32_t element);
void strut_path_rubbing_reactions(const struct strut_path_system *system, int32_t element,
                                  double *reaction);

/* Contacts in the equations of a path: nodes on lines, circles and profiles. For system.c. */

/** A contact at the point that was evaluated last. */
typedef struct strut_path_contact {
  strut_contact_pose pose; /* against the facet that it lies on */
  bool touches;            /* the ground acts, whatever the sign of the gap */
  int32_t facet;           /* on which it lies as long as it touches */
  /* with friction: */
  bool grips;        /* it has a static coefficient */
  bool sticks;       /* while it touches: it sticks; else it slides */
  double direction;  /* of sliding along its tangent, 1 or -1; 0: none was found yet */
  double tangent[2]; /* where it sticks, along which */
  strut_dd anchor;   /* and where along it nothing would hold it back [m] */
} strut_path_contact;

typedef struct strut_path_contacts {
  strut_path_contact *contact; /* (contacts) */
  double grip;                 /* stiffness of contacts that stick [N/m]; 0 without friction */
  bool has_corners;            /* some surface has several facets: then a switch more for each */
} strut_path_contacts;

/** Adds forces, stiffness and the parameter's slope of all contacts at system->latest->q. */
void strut_path_add_contacts(struct strut_path_system *system);
/** The normal forces, friction along the tangents, and what they take from the reactions (length). */
void strut_path_contact_reactions(const struct strut_path_system *system, double *reaction,
                                  double *contact, double *friction);
/** Name of its ground, "the ground" where there is only one. */
const char *strut_path_ground_name(const struct strut_path_system *system, int32_t contact);

/** As strut_path_switch_value: of touching, and of staying on its facet. */
double strut_path_contact_switch_value(const struct strut_path_system *system, int32_t contact);
double strut_path_corner_value(const struct strut_path_system *system, int32_t contact);
void strut_path_contact_switch_set(struct strut_path_system *system, int32_t contact, bool on);

/* Friction of contacts; only where the path keeps it. */

/** Finds which contacts have static friction; false: none. */
bool strut_path_friction_create(struct strut_path_system *system);
/** All that touch stick, with the forces that equilibrium needs; after strut_path_evaluate. */
void strut_path_friction_begin(struct strut_path_system *system);
/** Is the kinetic coefficient of a contact another than the static one? */
bool strut_path_friction_drops(const struct strut_path_system *system, int32_t contact);
/** As strut_path_switch_value, of a contact that sticks; of another one -INFINITY. */
double strut_path_grip_value(const struct strut_path_system *system, int32_t contact);
void strut_path_grip_set(struct strut_path_system *system, int32_t contact, bool on);

/* The equations of a path: equilibrium for a parameter, with what is taut and touching held fixed.
 *
 * Unknown is y: the free coordinates in units of the structure's size, then the parameter from
 * `from` in units of its range; n + 1 numbers, followed by n + 1 that are added to them for the
 * digits that a double does not have. A bar of 1e11 N/m turns the last bit of a metre into 1e-5 N.
 */

enum { STRUT_PATH_MOTIONS = 3 };

typedef struct strut_path_system {
  const strut_model *model;
  strut_potential *potential; /* for the numbers of its free coordinates */
  int32_t n;
  bool lends;     /* no point since the beginning had a stiffness without motions that meet none */
  bool drifts;    /* the parameter works on a motion of the whole that meets no stiffness */
  bool strayed;   /* the last search for a switch left the path, see strut_path_locate */
  double stop_at; /* position of the coordinate at which the path stops [m] */
  double size;    /* [m] */
  strut_path_parameter parameter;
  /**
   * (members, elements, contacts) Forces at the point that was evaluated last, with what is taut, acts and touches
   * frozen: pose.acts. Of a member that has shrunk to nothing and turned round, length and direction are the negative,
   * and so smooth.
   */
  strut_force *force;
  strut_path_elements elements;
  strut_path_contacts contacts;
  /** The numbers of the equations, and their rates with the parameter. */
  struct {
    strut_path_terms terms, rates; /* at terms_at; about rates_at */
    strut_dd terms_at;
    double rates_at;
    bool has_terms, has_rates;
  } equations;
  /** The latest place. */
  struct {
    uint8_t *pulling; /* (members) 1 where forces act, of whatever sign */
    double *ahead;    /* (2 members) directions at the last point kept; 0: none is known yet */
    double *q, *q_low, *g, *slope, *row; /* (length), (length), (n), (n) dg/dy_n, (n + 1) scratch */
    double forces;                       /* the largest force: what g is compared with [N] */
  } latest;
  /** Motions of the whole that were given a stiffness. */
  struct {
    int32_t count;
    double by, *motion; /* (STRUT_PATH_MOTIONS, n), and scratch of the same size */
    int32_t most;       /* that supports have left anywhere on the path */
  } held;
  struct {
    gsl_matrix *hessian, *bordered; /* (n, n), (n + 1, n + 1), with room for planes */
    gsl_vector *right, *solution;   /* (n + 1), likewise */
    gsl_permutation *order;
  } algebra;
  /** After strut_path_spectrum. */
  struct {
    double *value, *vector, *work; /* (n) ascending; (n, n) the mode of value i in row i; scratch */
    int32_t negative;  /* eigenvalues below zero, and elements folded back, which have one each */
    int32_t folded;    /* these */
    double noise;      /* rounding of the stiffness's entries [N/m] */
    double soft_parts; /* the largest part that an element has in a soft eigenvalue [N/m] */
  } spectrum;
  strut_arena arena;
} strut_path_system;

/**
 * `held` (length) or NULL: coordinates held besides the supports. The caller creates the parameter
 * in system->parameter before any other call; the system's address must not change. Free it after a
 * failure too.
 */
strut_status strut_path_system_create(const strut_model *model, const uint8_t *held,
                                      strut_path_system *system, strut_error *error);
void strut_path_system_free(strut_path_system *system);

/** y (2 n + 2) from positions of the free coordinates, at the parameter's start. */
void strut_path_unplace(const strut_path_system *system, const double *q, double *unknowns);
/** The parameter's value at y. */
double strut_path_value(const strut_path_system *system, const double *unknowns);

/** The force of an element. */
static inline strut_force *strut_path_element_force(const strut_path_system *system,
                                                    int32_t element) {
  return &system->force[system->model->members.count + element];
}
/** Adds a force with its gradient, that one's rate with the parameter (2 nodes each), and its matrix (2 nodes, 2 nodes). */
void strut_path_add_force(strut_path_system *system, const strut_force *force,
                          const double *gradient, const double *rate, const double *matrix);
/** The same of a member or an element whose force changes with the parameter by `rate` where its strain does not. */
void strut_path_add_strain(strut_path_system *system, const strut_force *force, double rate);

/** Everything at y, which need be no equilibrium; false: no scene has this value. */
bool strut_path_evaluate(strut_path_system *system, const double *unknowns);

/**
 * Newton's method to equilibrium on the plane row . y = value. Iterations used, or -1: it does not
 * converge.
 */
int strut_path_correct(strut_path_system *system, const double *row, double value,
                       double *unknowns);

/** Dimension of a kernel that is searched, at most. */
enum { STRUT_PATH_KERNEL = 6 };

/** Planes row . y = value that a solution lies on, and forces b stiff along all but the last row that it may lack. */
typedef struct strut_path_planes {
  int32_t null;      /* such forces; planes are one more */
  const double *row; /* (null + 1, n + 1) */
  const double *value;
  double stiff, far; /* [N]; a step longer than `far` leads nowhere */
  double *lack;      /* (null) b */
} strut_path_planes;

/** The same on planes. */
int strut_path_correct_on(strut_path_system *system, const strut_path_planes *planes,
                          double *unknowns);
/** Solves [K + by slope stiff row'; row 0] x = (top, bottom) into algebra.solution, top (n) or NULL; false: singular. */
bool strut_path_solve(strut_path_system *system, const strut_path_planes *planes, const double *top,
                      const double *bottom, double by);

/** The unit tangent with row . tangent > 0; false if the system is singular. */
bool strut_path_tangent(strut_path_system *system, const double *unknowns, const double *row,
                        double *tangent);

/**
 * Eigenvalues of the stiffness with all digits near zero too, modes, and how many are negative, into
 * system->spectrum. False: no scene has this value.
 */
bool strut_path_spectrum(strut_path_system *system, const double *unknowns);
/** The mode (n) of an eigenvalue. */
static inline double *strut_path_mode(const strut_path_system *system, int32_t i) {
  return system->spectrum.vector + (size_t)i * (size_t)system->n;
}
/** The largest eigenvalue, absolute. */
static inline double strut_path_largest_value(const strut_path_system *system) {
  return strut_largest_magnitude(system->spectrum.value, system->n);
}

/** What may change along the path; switches are numbered in this order. */
typedef enum strut_path_switch_kind {
  STRUT_PATH_CABLE, /* of members: also whether a spring or a bar has turned round */
  STRUT_PATH_TOUCH,
  STRUT_PATH_FACET, /* does a contact stay on its facet? None without corners */
  STRUT_PATH_GRIP,  /* none without friction */
  STRUT_PATH_ELEMENT
} strut_path_switch_kind;

/** A switch of a kind: of a member, a contact, or one of elements.switches. */
typedef struct strut_path_switch {
  strut_path_switch_kind of;
  int32_t index;
} strut_path_switch;

int32_t strut_path_switch_count(const strut_path_system *system);
strut_path_switch strut_path_switch_at(const strut_path_system *system, int32_t which);
/**
 * Above 0 where it ought to be on (pulls, touches) [m], NAN where no scene has this value;
 * -INFINITY for what never changes: members that are no cables, kinks where an element does not act.
 */
double strut_path_switch_value(strut_path_system *system, int32_t which, const double *unknowns);
bool strut_path_switch_is_on(const strut_path_system *system, int32_t which);
void strut_path_switch_set(strut_path_system *system, int32_t which, bool on);

/* Where something happens on one piece of a path, to rounding. */

/**
 * A step: from one point (2 n + 2) of the path to the next, and the tangent (n + 1) it began with.
 */
typedef struct strut_path_piece {
  const double *from, *tangent, *to;
  double length; /* tangent . (to - from) */
} strut_path_piece;

/** A number that changes along the path; `which` is the caller's. */
typedef double (*strut_path_measure)(strut_path_system *system, const double *y,
                                     const strut_path_piece *piece, int32_t which);

/** The value of a switch, strut_path_switch_value; of a contact that slides, how fast the path leads it back. */
double strut_path_measure_switch(strut_path_system *system, const double *unknowns,
                                 const strut_path_piece *piece, int32_t which);
/** An eigenvalue of the stiffness, counted from the lowest. */
double strut_path_measure_eigenvalue(strut_path_system *system, const double *unknowns,
                                     const strut_path_piece *piece, int32_t which);
/** The rate of the parameter along the path; which: -1 where it may turn at a bifurcation. */
double strut_path_measure_turn(strut_path_system *system, const double *unknowns,
                               const strut_path_piece *piece, int32_t which);

/**
 * The point y (2 n + 2) of the piece where the measure is 0; it must have different signs at the
 * ends. Returns the place along the tangent, 0 to piece->length, or -1: no such change of sign. Where the search for a
 * switch leaves the path system->strayed is set, and y is the last point before.
 */
double strut_path_locate(strut_path_system *system, const strut_path_piece *piece,
                         strut_path_measure measure, int32_t which, double *unknowns);

/* The walk along a path: what its steps share. For path.c, walk.c, events.c and branches.c. */

/** Bifurcations that branches are followed from, and paths that leave one of them, at most. */
enum { STRUT_PATH_FORKS = 32, STRUT_PATH_RAYS = 256 };

/** A path that leaves a point: its direction, and a point on it a small radius away. */
typedef struct strut_path_ray {
  double *y, *direction; /* (2 n + 2), (n + 1) of unit length */
  int32_t negative;      /* eigenvalues below zero there */
  int32_t own;           /* -1, 1: the path that is walked, before and after; else 0 */
  bool done;             /* it was walked */
} strut_path_ray;

typedef struct strut_path_rays {
  int32_t count, null; /* how many; the dimension of the kernel */
  double radius;
  strut_path_ray *ray; /* (count) the most stable first */
} strut_path_rays;

/** What a walk is at a point: what is taut, acts and touches, and where it goes. */
typedef struct strut_path_frozen {
  bool lends;
  uint8_t *pulling;            /* (members) */
  strut_path_contact *contact; /* (contacts) */
  strut_path_element *element; /* (elements) */
  double *y, *next, *tangent;  /* (2 n + 2) */
} strut_path_frozen;

/** A bifurcation that branches may leave: all that a walk needs to begin there. */
typedef struct strut_path_fork {
  double *y; /* (2 n + 2) */
  strut_path_rays rays;
  strut_path_frozen frozen;
  double factor, arc;
  int32_t path, depth;
} strut_path_fork;

/** What changes at limit points and bifurcations: eigenvalues below zero, and the way of the parameter. */
typedef struct strut_path_side {
  int32_t negative;
  int way; /* 0: along it nothing changes beyond rounding */
} strut_path_side;

/** A part of a step: its begin, and the place of its end along the tangent there. */
typedef struct strut_path_part {
  double *y, *tangent, *end; /* (2 n + 2) */
  strut_path_side before;
} strut_path_part;

/** A step that is taken again in parts. */
typedef struct strut_path_check {
  strut_path_part whole, inner;
  double *y, *tangent, *next_tangent; /* (2 n + 2) where it is */
  bool blurred;                       /* an eigenvalue had no sign */
} strut_path_check;

typedef struct strut_path_walk {
  strut_path_system system;
  strut_path *path;
  double *y, *next;               /* (2 n + 2) the present point, and the next */
  double *tangent, *next_tangent; /* (n + 1) there */
  double *trial, *spare, *upward; /* (2 n + 2) scratch; (0, ..., 0, 1) */
  double *beyond;                 /* (2 n + 2) where a step would lead that a switch ends */
  strut_path_check check;
  double *fork, *values, *scale; /* (2 n + 2) scratch; (n) eigenvalues at y, and scratch */
  double *earlier_values;        /* (n) at the point before, if nothing jumped since */
  double *first, *first_tangent; /* (2 n + 2), (n + 1) where the path begins */
  double *last, *last_tangent;   /* (2 n + 2), (n + 1) where the latest step began */
  double last_arc;
  double *settled; /* (length) scratch */
  /** Moves q (length) downhill to rest where the parameter has a value; false: it finds none. NULL: not to be had. */
  bool (*settle)(void *settler, double value, double *q);
  void *settler;
  double earlier; /* how far back that is; 0: not known */
  /** A short part of the latest step with what changes on it. */
  struct {
    double *from, *tangent, *to;
    bool known;
  } part;
  double arc, step;
  int32_t negative; /* eigenvalues below zero beyond y */
  int32_t bends;    /* kinks that stand for a smooth bend since the last point */
  size_t point_room, event_room;
  bool failed; /* memory was out */
  /** Bifurcations found, where branches are asked for. */
  struct {
    strut_path_fork *fork; /* (STRUT_PATH_BRANCHES), or NULL: not asked for */
    size_t count;
    int32_t path, depth; /* of the path that is walked */
    int32_t left,
        lost; /* bifurcations or branches for which there was no room; that did not begin */
  } forks;
} strut_path_walk;

/** Copies what it is into the arena, and back; false: out of memory. */
bool strut_path_freeze(const strut_path_walk *walk, strut_arena *arena, strut_path_frozen *frozen);
void strut_path_thaw(strut_path_walk *walk, const strut_path_frozen *frozen);

/** Of a point y. */
static inline size_t strut_path_bytes(const strut_path_walk *walk) {
  return 2 * ((size_t)walk->system.n + 1) * sizeof(double);
}

/** From y: what pulls and touches there, the tangent along which the load does work, a point. */
bool strut_path_walk_begin(strut_path_walk *walk);
/** One step, with all events on it; false: the path ends here, path->end says why. */
bool strut_path_walk_step(strut_path_walk *walk);
/**
 * Finds what pulls, acts and touches at walk->y and the tangent there, and corrects y by up to `most`; false: there is
 * no tangent, or no such equilibrium.
 */
bool strut_path_set_out(strut_path_walk *walk, double most);
/** Takes the latest step back to its point y (2 n + 2), at which the path ends. */
void strut_path_end_within(strut_path_walk *walk, const double *unknowns, strut_path_end end);

/* Motions without stiffness, beside rounding. */

/**
 * Motions at y that meet no stiffness beyond rounding, in no member by itself: how many, the modes
 * from `first` on. 0 too where another motion is unstable.
 */
int32_t strut_path_find_mechanisms(strut_path_system *system, const double *unknowns,
                                   int32_t *first);
/**
 * Where a stable path has motions without stiffness at a point: continues where the structure comes to rest a little
 * further, with the same forces. False: there is no such motion, or no such rest, and nothing has changed.
 */
bool strut_path_leave_mechanism(strut_path_walk *walk, const double *unknowns, double sense);
/** Remarks long parts of the path on which no member carries a force, or nothing changes. */
void strut_path_remark_idle(const strut_path_walk *walk);
/** The node that a mode (n) moves most. */
int32_t strut_path_most_moved(const strut_path_system *system, const double *mode);

/**
 * The scene with the actuator at a value: rest length, angle or pressure of what it drives are those of
 * the drawn model and the value. What changes is copied into the arena. STRUT_USAGE where there is no
 * such rest length, STRUT_NO_MEMORY.
 */
strut_status strut_path_set_actuator(const strut_model *drawn, int32_t actuator, double value,
                                     strut_arena *arena, strut_scene *scene, strut_error *error);

/** Notes why a path ended that took all its steps. */
void strut_path_remark_steps(strut_path_walk *walk, int32_t steps);

/** The next point and its tangent, on the branch of the present one; false: there is none. */
bool strut_path_find_next(strut_path_walk *walk);

/**
 * Reports limit points and bifurcations on a piece, which ends in walk->next. True: the path ends at one of them,
 * walk->fork, and goes on along `way`.
 */
bool strut_path_find_criticals(strut_path_walk *walk, const strut_path_piece *piece,
                               strut_path_ray *way);

/** Does the parameter turn back on the step? No sign of a rate below rounding counts. */
bool strut_path_turns_back(const strut_path_walk *walk);
/** All paths through y, where eigenvalues vanish; that with walk->tangent is the walk's own. */
void strut_path_find_rays(strut_path_walk *walk, const double *unknowns, strut_path_rays *rays);
/** Does only rounding part two branches that pass between two points? */
bool strut_path_is_rounding(strut_path_walk *walk, const double *from, const double *to);

/** Are branches to be followed from the bifurcation y? */
bool strut_path_wants_fork(strut_path_walk *walk, const double *unknowns);
/** Keeps the bifurcation at y; the walk goes on along `way`, or NULL: along its own path. */
void strut_path_keep_fork(strut_path_walk *walk, const double *unknowns,
                          const strut_path_rays *rays, const strut_path_ray *way);
/** After the walk along a path: the branches of the bifurcations kept, into path->branches. */
void strut_path_walk_branches(strut_path_walk *walk, strut_path *path,
                              const strut_experiment *experiment);

/** Switches this close to zero change together, in units of the structure's size. */
#define STRUT_PATH_EVEN 1e-9
/** A length that has no direction, likewise. */
#define STRUT_PATH_NOTHING 1e-12

/**
 * Throws the switch `which` at walk->y, and those that stand at zero there and are thrown with it,
 * and reports them and what the kink does to parameter and stability. `beyond` is where the old
 * stiffness would have led. The new tangent points to the side that they were thrown to. False:
 * there is none.
 */
bool strut_path_pass_kink(strut_path_walk *walk, int32_t which, const double *beyond);

/** The same where a node leaves its facet over a corner, along which the parameter changes at once. */
bool strut_path_pass_corner(strut_path_walk *walk, int32_t contact);
/** The same where a member shrinks to nothing, so that its force turns round. */
bool strut_path_pass_zero_length(strut_path_walk *walk, int32_t member);
/** Is this switch that of such a member? */
bool strut_path_turns_round(const strut_path_system *system, int32_t which);
/** The same where a contact begins to slide, with the same jump, or to stick. */
bool strut_path_pass_grip(strut_path_walk *walk, int32_t which, const double *beyond);
/** At a point that is kept: materials are renewed, and guides that began to slip or stick since the last one reported. */
void strut_path_keep_guides(strut_path_walk *walk);
/** Reports a parameter that turns back at walk->y, or a change of stability if it continues. */
void strut_path_report_exchange(strut_path_walk *walk, double turn, int32_t before);

/** Is this switch one of the many kinks that stand for the bend of a smooth law? */
bool strut_path_is_bend(const strut_path_system *system, int32_t which);

/** Keeps the latest eigenvalues as those of walk->y. */
void strut_path_keep_values(strut_path_walk *walk);
/** Has a motion of the latest spectrum no stiffness beside a share of the largest? Then a tangent is one of many. */
bool strut_path_is_loose(const strut_path_system *system, double share);
/** Eigenvalues below zero at walk->y, into walk->negative. */
void strut_path_count_negative(strut_path_walk *walk);

/** Name of the path's parameter, as the subject of a sentence. */
const char *strut_path_subject(const strut_path_walk *walk);
/** The parameter at a value, "the factor 1.5"; returns the text. */
enum { STRUT_PATH_TEXT = 200 };
const char *strut_path_at(const strut_path_walk *walk, double value, char text[STRUT_PATH_TEXT]);
/**
 * "can grow no further" where the parameter turns that went on by `turn` [ranges], or "grows again
 * from".
 */
const char *strut_path_turn(const strut_path_walk *walk, double turn);

/** a . b over the first n + 1 numbers. */
double strut_path_dot(const strut_path_walk *walk, const double *first, const double *second);
/** Distance of two points of the path in y. */
double strut_path_distance(const strut_path_walk *walk, const double *first, const double *second);
/** Keeps walk->y; `negative` beyond it. */
void strut_path_add_point(strut_path_walk *walk, int32_t negative);
/** Keeps y, in the order of the path. `detail` is copied. */
void strut_path_add_event(strut_path_walk *walk, strut_path_event_kind kind, const double *unknowns,
                          int32_t index, int32_t before, int32_t after, const char *detail);
