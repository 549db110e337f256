/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Steps that stop at events: what the methods with located events share.
 *
 * Each contact, cable and element with a kink has a discrete mode, which is frozen within a step: in one mode the
 * right-hand side is smooth. A step whose end contradicts a mode is taken again up to the moment
 * where that began; there the mode changes, and the rest of the step follows. Steps so end on the
 * grid n dt as those of any other method.
 */
#pragma once

#include <assert.h>

#include "engine/forces/drives/drives.h"
#include "engine/integrate/integrator.h"

/** Modes of a contact. u: sliding speed; N: normal force; s: the side, +-1. */
typedef enum strut_contact_mode {
  STRUT_MODE_OPEN,  /* does not touch */
  STRUT_MODE_SLIDE, /* touches; no friction, or the smooth law, of which u is an argument */
  STRUT_MODE_SLIP,  /* friction -s mu N; Coulomb: s u > 0, Karnopp: s u > delta */
  STRUT_MODE_STICK, /* Coulomb: u = 0, held by a multiplier within mu_0 N */
  STRUT_MODE_BAND,  /* Karnopp: |u| < delta, friction balances the other forces, up to mu N */
  STRUT_MODE_PUSH,  /* Karnopp with mu_0 > mu: |u| < delta, pushed towards s by more than mu_0 N */
  STRUT_MODE_YIELD, /* Karnopp with mu_0 > mu: |u| < delta, at the threshold mu_0 N, where holding lets
                       the other forces grow and pushing relieves them (Filippov's sliding mode):
                       friction between both, continuous over a thin layer of F_res */
  STRUT_MODE_CREEP /* Karnopp: u = s delta, held by a multiplier: inside the band inertia pushes
                       the node out, outside friction pushes it back (Filippov's sliding mode) */
} strut_contact_mode;

/** Acceleration of nodes under a unit force on one contact's node: a column of M^-1, cut where it
    is below 1e-18 of its largest entry. */
typedef struct strut_contact_compliance {
  int32_t count;
  const uint32_t *at;     /* (count) 2 * node */
  const double *xy;       /* (count, 2) x per unit force in x, y per unit in y [1/kg] */
  double normal, tangent; /* of the node itself, along the ground's normal and tangent [1/kg]; with
                             surfaces the larger of x and y */
  double own[2];          /* of the node itself, in x and in y [1/kg] */
  const double *constant; /* xy without masses that slide; NULL where none do */
} strut_contact_compliance;

/** A contact at one end of a step. */
typedef struct strut_touch {
  double gap, into, slip;      /* height above ground [m], speeds along normal and tangent [m/s] */
  double into_rate, slip_rate; /* their time derivatives [m/s^2] */
  double normal, friction;     /* on the node [N] */
  double applied;              /* F_res: other forces along the ground [N] */
} strut_touch;

/** What a contact of a surface has beside that: its axes turn, and the ground may move. */
typedef struct strut_contact_frame {
  strut_contact_axes axes;
  double into_drift, slip_drift; /* rates of the speeds without acceleration of the node [m/s^2] */
  double ground_into, ground_along; /* speed of a shaken ground along the axes [m/s] */
  double alone; /* of the applied force, without other contacts of the node [N] */
} strut_contact_frame;

/** One end of a step: positions, velocities, accelerations (length) and contacts. */
typedef struct strut_step_end {
  double *q, *v, *a;
  strut_touch *touch; /* (contacts) of those that are closed; of open ones the gap alone */
  /* (switches) force as if it acted, and how far the strain is beyond the kink, both positive where it
     acts; and the rate of the latter. Of a kink: the margins to both ends of its piece, the lesser */
  double *tension, *stretch, *stretch_rate;
  double power[STRUT_POWER_ROOM]; /* [W]; only with the energy balance */
  /* all forces but the ground's, and their powers: a change of modes needs no others anew */
  double *structure, structure_power[STRUT_POWER_ROOM];
  strut_ground_motion *motion; /* (grounds) NULL where none is shaken */
  strut_contact_frame *frame;  /* (contacts) beside `touch`; NULL without STRUT_TERM_SURFACES */
} strut_step_end;

/** A closed contact that slips or has no friction, alone on its body, on level ground: all that a
    step asks of it in one place. */
typedef struct strut_sliding_contact {
  uint32_t at;
  int32_t index, nodes;      /* contact; nodes that answer to it */
  double stiffness, damping; /* [N/m], [N s/m] */
  double answer, friction;   /* along the normal [1/kg]; friction force over normal force [1] */
  double side, edge;         /* slips while side * u >= edge [m/s] */
  const uint32_t *place;     /* (nodes) */
  const double *xy;          /* (nodes, 2) */
} strut_sliding_contact;

/**
 * Something that ends a mode: what it is of, the value that it ends at 0 (positive while the mode holds),
 * that value's rate (NONE: not known, a secant must do), and what it does to the modes. The functions are in
 * event_kinds.c.
 */
#define STRUT_EVENT_KINDS(X)                                                                        \
  X(NONE, CONTACT, no_end, NULL, no_effect)                                                         \
  /* an open contact closes */                                                                      \
  X(TOUCH, CONTACT, gap, NULL, close_nearest)                                                       \
  /* a closed one opens */                                                                          \
  X(OPEN, CONTACT, depth, depth_rate, open)                                                         \
  /* slip ends: u reaches 0, or the band */                                                         \
  X(SLIP_ENDS, CONTACT, slip_left, slip_rate, end_slip)                                             \
  /* |u| reaches the edge of the band from inside */                                                \
  X(LEAVES_STICK_BAND, CONTACT, band_left, band_rate, leave_band)                                   \
  /* a stuck node's multiplier leaves mu_0 N */                                                     \
  X(STICK_BREAKS, CONTACT, stick_left, NULL, break_stick)                                           \
  /* creep's multiplier reaches mu N: slip */                                                       \
  X(CREEP_OUT, CONTACT, creep_out_left, NULL, creep_out)                                            \
  /* it reaches the band's force: band */                                                           \
  X(CREEP_IN, CONTACT, creep_in_left, NULL, creep_in)                                               \
  /* |F_res| passes mu_0 N inside the band, either way */                                           \
  X(PUSH, CONTACT, push_left, NULL, push)                                                           \
  /* F_res leaves the layer about mu_0 N */                                                         \
  X(YIELDED, CONTACT, yield_left, NULL, end_yield)                                                  \
  /* the ground damper's sign changes */                                                            \
  X(DAMPER, CONTACT, speed_left, speed_rate, turn_damper)                                           \
  /* a cable or an element that carries one sign begins or ceases to act */                         \
  X(ACTS, LAW, of_law, NULL, act)                                                                   \
  /* an element's strain passes a kink of its law */                                                \
  X(KINK, LAW, of_law, NULL, pass_kink)                                                             \
  /* a slider or a cable at a guide gives way, or holds again */                                    \
  X(SLIDER, LAW, of_law, NULL, remember)                                                            \
  /* a member or a hinge breaks */                                                                  \
  X(BREAK, LAW, of_law, NULL, remember)                                                             \
  /* another facet of the surface comes nearer to a closed contact */                               \
  X(FACET, CONTACT, facet_left, NULL, change_facet)                                                 \
  /* a relay's input or a sensor passes a threshold; the stepper switches it, or starts a signal */ \
  X(THRESHOLD, LAW, of_law, NULL, no_effect)                                                        \
  /* a member shrinks to nothing, and its force turns round */                                      \
  X(TURN, LAW, of_law, turn_rate, turn)

typedef enum strut_event_kind {
#define STRUT_EVENT_ROW(NAME, ...) STRUT_EVENT_##NAME,
  STRUT_EVENT_KINDS(STRUT_EVENT_ROW)
#undef STRUT_EVENT_ROW
} strut_event_kind;

/** Something that switches: a cable or an element that carries one sign, an element's kinks, a threshold. */
typedef struct strut_law_switch {
  int32_t member;         /* of a cable; -1: of an element */
  int32_t element;        /* of an element; -1: of a cable */
  strut_event_kind event; /* what ends its mode: ACTS, KINK, SLIDER, BREAK, THRESHOLD or TURN */
  bool
      abrupt; /* its force has a jump or no slope where it begins to act: the stretch ends it, too */
  double stiffness; /* force per strain, by which stretch and force are compared */
  double damping;
  int32_t
      guide; /* with SLIDER 1 + the guide; 0: the slider of `element` itself; with TURN 1 + the segment */
  bool straight;     /* whether the cable passes straight over it */
  bool whole;        /* whether a cable with guide friction is taut */
  int32_t breakable; /* what may break, where neither member nor element is one; else unused */
  int32_t signal;    /* with THRESHOLD 1 + its signal */
  int32_t kink;      /* with THRESHOLD 1 + the kink of the signal that it is instead */
} strut_law_switch;

typedef struct strut_event_stepper strut_event_stepper;

/** What an observer of the pieces needs beside the ends of a step. */
typedef struct strut_event_view {
  double *q, *v;                 /* (length) at the begin of the step */
  double work[STRUT_POWER_ROOM]; /* there [J] */
  double *memory;                /* (strut_history_count) there */
  strut_step_end instant;        /* of contact forces within the piece */
  bool smooth;                   /* nothing has switched or jumped since the latest piece */
} strut_event_view;

enum { STRUT_MOST_STAGES = 13 };

/** An explicit Runge-Kutta method. After a trial stepper->stage[k] holds the velocities of stage k > 0. */
typedef struct strut_tableau {
  int stages; /* the step's end is one more, and the first stage of the next step */
  int order;
  double ahead[STRUT_MOST_STAGES + 1];                     /* times, in steps */
  double weight[STRUT_MOST_STAGES + 1][STRUT_MOST_STAGES]; /* of the stages before; of the step */
  double
      difference[STRUT_MOST_STAGES + 1]; /* weights of the local error; 0 without error control */
} strut_tableau;

/** A step from stepper->now at time t over h to stepper->next, with the works of it in stepper->gained. */
typedef void strut_event_trial(const strut_model *model, const strut_state *state,
                               strut_event_stepper *stepper, double t, double h);

/** What a method adds: how one step goes while nothing happens. */
typedef struct strut_step_formula {
  strut_event_trial *trial;
  int stages; /* (length) arrays it needs in stepper->stage */
  bool exact; /* iterate roots to rounding, and locate kinks as well as jumps */
  /** Fills stepper->next->q and what trial needs beside it, where positions are known before forces are:
      q + h v + h^2/2 a at any fraction of a step. trial expects it done. NULL: they are not. */
  void (*predict)(const strut_model *model, strut_event_stepper *stepper, double h);
  /* with error control, by stepper->control; the last two stages are not trial's: they hold the state at the begin of
     the grid step */
  bool adaptive;
  /** Takes steps up to grid point `end` while nothing happens, with the bits that trial gives; stops
      before the step in which something does, with stepper->tried if it has tried that one. May be NULL. */
  void (*advance_until_event)(const strut_model *model, strut_state *state,
                              strut_event_stepper *stepper, double dt, int64_t end);
  const strut_tableau *tableau; /* NULL: variations cannot follow */
} strut_step_formula;

/** What is left of the margin by whose zero the mode of a closed contact, or of what remembers, ends, where that is
    least at a stage. */
typedef struct strut_least_margin {
  double margin; /* [N], of a hinge [N m]; HUGE_VAL: the ends of a step say all about the mode */
  double at;     /* part of the step */
} strut_least_margin;

/** Modes of contacts, (contacts) each. */
typedef struct strut_contact_modes {
  uint8_t *of;           /* strut_contact_mode */
  int8_t *side, *damper; /* s; ground damper: 1 on, -1 off, 0: by its sign */
  int32_t *facet;        /* of closed contacts of surfaces; NULL without STRUT_TERM_SURFACES */
  double *outward;       /* the sign of gaps that keep the mode: 1 open, -1 closed */
} strut_contact_modes;

/** What strut_update_active_set makes of the modes. */
typedef struct strut_active_set {
  int32_t *closed, closed_count; /* contacts that touch, ascending */
  int32_t *stuck, stuck_count,
      stuck_room;                 /* those in STICK or CREEP; count < 0: without a factor */
  double *factor;                 /* (stuck_count, stuck_count) Cholesky factor of T' M^-1 T */
  double *work;                   /* (stuck_room) */
  bool decoupled;                 /* level ground, and no two closed contacts are of one body */
  bool all_sliding;               /* decoupled, and all closed contacts are in this list: */
  strut_sliding_contact *sliding; /* (closed_count) */
} strut_active_set;

/** Contacts in all modes, (contacts) each. */
typedef struct strut_contact_bodies {
  const strut_contact_entry *entry; /* the model's, or a state's with STRUT_TERM_SURFACES */
  strut_contact_compliance *compliance;
  double *settling_time; /* relaxation time of a closed contact [s] */
  int32_t *body;         /* equal where a force on one accelerates the other */
  int passes;            /* sweeps over normal and tangent where they are coupled by M */
  bool *body_seen;       /* scratch */
  double *damped;        /* scratch: damper force while it is being solved for [N] */
  double *scatter;       /* (length) scratch, zero between uses */
} strut_contact_bodies;

/** Cables, elements and relays that switch, cables first. */
typedef struct strut_law_switches {
  strut_law_switch *item; /* (count) */
  int32_t count;
  uint8_t *acting; /* (count) of those without kinks */
  /* where collisions are many: those that may switch, of state->nearby, made so often; else NULL */
  int32_t *nearby, nearby_count;
  int64_t nearby_made;
} strut_law_switches;

/** Members whose force turns round where they shrink to nothing: laws behind all others, which count while one may. */
typedef struct strut_turns {
  int32_t first, count;
  const uint32_t *ends; /* (count, 2) their nodes */
  double *ahead; /* (count, 2) direction in which the step begins, or in which it has just passed */
  int64_t due;   /* the grid step from which on they are looked at */
  int64_t step;  /* the grid step under way */
  int32_t pieces; /* accepted in it */
  bool on;        /* they count among the laws */
  bool stepped;   /* a step has been accepted since the latest look */
} strut_turns;

/** Lengths of steps. */
typedef struct strut_step_control {
  double wanted_step;                        /* of the settings [s] */
  double refine, refine_time, refine_memory; /* after a touchdown [1], [s], [1] */
  /* with error control: */
  double tolerance, h, error; /* relative, step to try [s], relative to what is allowed [1] */
  double fastest;             /* speed of the steps accepted so far [m/s] */
  double
      speed; /* of these and of all trials of the next one: what errors of velocities are compared with */
  double own_speed;          /* of the latest trial */
  double longest;            /* a step of the grid [s] */
  double frequency;          /* of the fastest spring of members and contacts [rad/s] */
  double rounding;           /* of what the pair says of accelerations [m/s^2] */
  strut_least_margin *least; /* (contacts, laws) in the latest step, of closed ones and memory */
  double work[STRUT_POWER_ROOM]; /* at the begin of the grid step [J] */
} strut_step_control;

/** How often modes have switched without a step between: many may do so at one moment, but none many times. */
typedef struct strut_chatter {
  int at_once;       /* switches since the latest step */
  int switches;      /* since the latest grid point, or step that separates them */
  uint8_t *times;    /* (contacts, then laws) since the latest step */
  int32_t *switched; /* (count) those that are not 0 */
  int32_t count;
  int most;         /* the largest of them */
  int32_t pushed;   /* contact that passed its threshold last, or -1 */
  double pushed_at; /* when that was [s] */
} strut_chatter;

/** Workspace of a method with events; in the state's arena. */
struct strut_event_stepper {
  const strut_step_formula *formula;
  strut_step_end end[2], *now, *next; /* now->q and now->v are the state's own */
  double **stage;                     /* (formula->stages) arrays (length) */
  double *middle;                     /* (length) scratch: places within the step */
  double gained[STRUT_POWER_ROOM];    /* by the step from now to next [J] */
  strut_contact_modes modes;
  strut_active_set active;
  strut_contact_bodies contacts;
  strut_law_switches laws;
  strut_turns turns;
  strut_kinks kinks; /* of signals: state->modes.kinks */
  strut_step_control control;
  strut_chatter chatter;
  double done; /* of the grid step under way [s] */
  double
      next_break; /* when a drive or load jumps next, with the state's time_offset [s]; INFINITY: never */
  bool looks;  /* signals may ask for shorter steps */
  bool scales; /* an accepted step has scales to keep: error control, or kinks of signals */
  bool started;
  bool fresh;                      /* now->structure holds for now */
  bool tried;                      /* next is the end of the step that is due */
  strut_event_view *view;          /* NULL: nothing is observed */
  struct strut_implicit *implicit; /* of implicit.c */
};

/** Laws that may switch: `count` of them, each by its place in a list. */
static inline int32_t strut_laws_of(const strut_law_switches *laws) {
  return laws->nearby ? laws->nearby_count : laws->count;
}
static inline int32_t strut_law_of(const strut_law_switches *laws, int32_t place) {
  assert(place >= 0 && place < strut_laws_of(laws));
  return laws->nearby ? laws->nearby[place] : place;
}

/** Arrays of one end of a step, with or without positions and velocities of its own. False: out of memory. */
bool strut_step_end_create(const strut_model *model, strut_arena *arena, bool borrowed,
                           strut_step_end *end);
/** Workspace for a method; NULL: out of memory. */
void *strut_event_stepper_create(const strut_model *model, strut_state *state,
                                 const strut_step_formula *formula,
                                 const strut_integrator_settings *settings);
/** Makes the modes anew from q and v. */
void strut_event_stepper_restart(const strut_model *model, strut_state *state, void *workspace,
                                 double dt);
/** Prepares for an observer; see strut_integrator. */
bool strut_event_stepper_observe(const strut_model *model, strut_state *state, void *workspace);
/** Takes the trial as often as state->watched.rehearsals says, twice as far where positions are not predicted. */
void strut_event_rehearse(strut_event_trial *trial, const strut_model *model,
                          const strut_state *state, strut_event_stepper *stepper, double t,
                          double h);
/** `count` steps of dt. */
void strut_event_stepper_advance(const strut_model *model, strut_state *state, void *workspace,
                                 double dt, int64_t count);

/** Of the row of a method with events. */
#define STRUT_STEPS_TO_EVENTS                                                                      \
  .events = true, .restart = strut_event_stepper_restart, .advance = strut_event_stepper_advance,  \
  .observe = strut_event_stepper_observe

/* ---- parts of it, in contact_compliance.c, contact_modes.c and event_location.c ---- */

/** Responses, settling times, refinement. STRUT_OK or STRUT_NO_MEMORY. */
strut_status strut_event_stepper_prepare(const strut_model *model, strut_state *state,
                                         const strut_integrator_settings *settings,
                                         strut_event_stepper *stepper);
/** Lists closed and stuck contacts after modes have changed and factors T' M^-1 T. */
void strut_update_active_set(const strut_model *model, strut_event_stepper *stepper);
/** Compliances of the closed contacts with sliding masses as they have been placed. */
void strut_refresh_compliances(const strut_model *model, const strut_state *state,
                               strut_event_stepper *stepper);
/** Multipliers that hold the stuck contacts: adds to a, writes end->touch[].friction. */
void strut_solve_stick_constraints(const strut_model *model, strut_event_stepper *stepper,
                                   double *acceleration, strut_step_end *end);
/** a += acceleration by the force (normal, tangential) on a contact's node, along these axes. */
void strut_apply_contact_impulse(const strut_contact_compliance *compliance,
                                 const strut_contact_axes *axes, double normal, double tangential,
                                 double *acceleration);
/** Acceleration, contact forces and powers of stepper->now at time t, in the present modes. */
void strut_evaluate_acceleration(const strut_model *model, const strut_state *state,
                                 strut_event_stepper *stepper, double t);

typedef struct strut_event {
  strut_event_kind kind;
  int32_t index;   /* of the contact, or into stepper->laws.item */
  double fraction; /* of the step, by interpolation */
} strut_event;

/** Does the event end the mode of a law, not of a contact? */
bool strut_event_is_of_law(strut_event_kind kind);
/** The earliest event between now and next, a step h apart; kind NONE if every mode holds. */
strut_event strut_event_first(const strut_model *model, const strut_state *state,
                              strut_event_stepper *stepper, double h);
/**
 * After a step of h from now to next, whose ends have been measured and say that every mode holds: where within it one
 * does not, by the cubics along which nodes move, as a part of the step; 0: nowhere (between.c).
 */
double strut_event_between(const strut_model *model, const strut_state *state,
                           strut_event_stepper *stepper, double h);
/**
 * Takes the step of h from now at time t again up to the event, or to one that comes before it. Returns the length
 * taken; next is its end. Exact formulas go on until the root is known to 1e-13 of the step, or to rounding.
 */
double strut_event_locate(const strut_model *model, const strut_state *state,
                          strut_event_stepper *stepper, double t, double h, strut_event *event);
/** First root in [0, 1] of the cubic with these values and slopes at 0 and 1; g0 > 0 > g1. */
double strut_event_cubic_root(double g0, double d0, double g1, double d1);
/** The value that event ends at 0, at an end; positive while the mode holds. */
double strut_event_value(const strut_model *model, const strut_event_stepper *stepper,
                         const strut_step_end *end, strut_event_kind kind, int32_t index);
/** Forces and strains of the laws that switch, at an end that has just been evaluated. */
void strut_event_measure(const strut_model *model, const strut_state *state,
                         strut_event_stepper *stepper, const strut_step_end *end);
/** Where collisions are many: all of them apart, and those listed that may touch at now. */
void strut_event_part_all(const strut_model *model, strut_state *state,
                          strut_event_stepper *stepper);
/** Time derivative of that value where it is known; false where a secant must do. */
bool strut_event_rate(const strut_event_stepper *stepper, const strut_step_end *end,
                      strut_event_kind kind, int32_t index, double *rate);
/** Before a step of a formula that predicts: the first touchdown or opening. */
strut_event strut_event_predict(const strut_model *model, const strut_state *state,
                                const strut_event_stepper *stepper, double h);

/* ---- turns.c: members that shrink to nothing ---- */

/** How many there are; into item and ends, unless these are NULL. */
int32_t strut_turns_list(const strut_model *model, strut_law_switch *item, uint32_t *ends);
/** After a trial of h: finds whether one may turn round within it, and so counts. */
void strut_turns_look(const strut_model *model, const strut_state *state,
                      strut_event_stepper *stepper, double h);
static inline bool strut_turns_due(const strut_state *state, const strut_event_stepper *stepper) {
  return state->step >= stepper->turns.due;
}
void strut_turns_measure(const strut_event_stepper *stepper, const strut_step_end *end);
/** After a step has been accepted while they count. */
void strut_turns_keep(const strut_model *model, const strut_state *state,
                      strut_event_stepper *stepper);
/** To the forces of the structure: those that have turned since the step began go on as before. */
void strut_turns_hold(const strut_model *model, const strut_state *state,
                      const strut_event_stepper *stepper, const double *positions,
                      const double *velocity);
/** Does law k, whose second node is no longer ahead, pass through nothing, not beside it? */
bool strut_turn_passes(const strut_model *model, const strut_event_stepper *stepper, int32_t k,
                       double h);
/** As strut_event_between, of law k. */
double strut_turn_between(const strut_model *model, const strut_event_stepper *stepper, int32_t k,
                          double h);
void strut_turn_round(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                      int32_t k, double t);
/** Where the cubic with these values, both above 0, and slopes at 0 and 1 is lowest, if below 0 by more than faint. */
double strut_event_dip(double g0, double d0, double g1, double d1, double faint);

/** Of methods with error control (runge_kutta.c): notes what is left of margins at a stage. */
void strut_event_note_stage(const strut_event_stepper *stepper, double at, bool first);
/** What the ends of a step of sufficient accuracy, and its stages, say about the time between. */
void strut_event_look_between(const strut_model *model, const strut_state *state,
                              strut_event_stepper *stepper, double h);

/* ---- contact_modes.c: what an event does is made of these ---- */

/** Mode of contact i, which touches, from its speeds; with surfaces on `facet`, or -1: the nearest. */
void strut_contact_close(const strut_model *model, strut_event_stepper *stepper, int32_t i,
                         int32_t facet);
/** After a step of h: the dampers of contacts at rest follow its sign, which ends no step; others have a mode that does.
    `event`: modes end at the step's end. */
void strut_contact_rest(strut_event_stepper *stepper, double h, bool event);
/** Sets the speed of contact i along the ground exactly. */
void strut_contact_snap(const strut_model *model, strut_event_stepper *stepper, int32_t i,
                        double slip);
/** Law k passes the nearer kink of its piece at time t. */
void strut_law_pass_kink(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                         int32_t k, double t);
/** Evaluates stepper->now at time t, letting go of one overloaded stuck contact after the other. */
void strut_modes_derive(const strut_model *model, const strut_state *state,
                        strut_event_stepper *stepper, double t);
/** Changes the mode at stepper->now, time t, and leaves it fresh. */
void strut_event_apply(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                       strut_event event, double t);
/** Modes from q and v alone. */
void strut_modes_start(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                       double t);
/* ---- history_modes.c: sliders, and what breaks ---- */

/** Adds their switches to the laws, for which there is space. */
void strut_history_list(const strut_model *model, const strut_state *state,
                        strut_law_switches *laws);
/** Of a slider or what breaks, at an end: its margin into end->tension; with the first guide of a cable, of all. */
void strut_history_measure(const strut_model *model, const strut_state *state,
                           const strut_event_stepper *stepper, const strut_step_end *end,
                           int32_t k);
/** Lets all sliders follow their forces at now, and back to their yields. */
void strut_history_thaw(const strut_model *model, strut_state *state, strut_event_stepper *stepper);
/** Freezes the mode of switch k at now, whose forces have been evaluated. */
void strut_history_start(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                         int32_t k);
/** Changes the mode at the event of switch k, at time t. */
void strut_history_apply(const strut_model *model, strut_state *state, strut_event_stepper *stepper,
                         int32_t k, double t);
/** Of what has broken, no switch acts. */
void strut_history_drop_gone(const strut_model *model, strut_state *state,
                             strut_law_switches *laws);

/** A cable, law k, acts from now on, or not. */
void strut_cable_set_acting(strut_state *state, strut_event_stepper *stepper, int32_t k,
                            bool pulls);
/** After a drive has jumped: laws anew; contacts keep their modes, since nothing has moved. */
void strut_modes_after_jump(const strut_model *model, strut_state *state,
                            strut_event_stepper *stepper, double t);
/** After a step, what need not be located: opening. True if something changed. */
bool strut_modes_after_step(const strut_model *model, strut_event_stepper *stepper);

/*
 * Contacts of surfaces (engine/model/surfaces.h) in methods with events.
 *
 * Within a step a closed contact keeps to one facet, as if its line had no ends; where another facet comes
 * nearer is an event. A contact's axes turn with its node, so they are measured with its gap and speeds.
 */

/** Fills *touch and *frame with the kinematics of contact i at q, v and the motion of the grounds then. */
void strut_surface_measure(const strut_contact_table *contacts, const strut_contact_modes *modes,
                           const strut_ground_motion *motion, int32_t i, const double *positions,
                           const double *velocity, strut_touch *touch, strut_contact_frame *frame);
/** As add_contact_forces, for surfaces. */
void strut_surface_add_forces(const strut_model *model, const strut_event_stepper *stepper,
                              const double *positions, const double *velocity, double *force,
                              bool damped, const strut_step_end *end);
/** Force along the surface of closed contact closed[k] by all else on its node, other contacts included. */
double strut_surface_applied(const strut_contact_table *contacts, const strut_active_set *active,
                             int32_t k, const strut_step_end *end);
/** As the same of event_kernel.h, for one closed contact. */
void strut_surface_measure_rates(const strut_contact_table *contacts, int32_t i,
                                 const double *acceleration, strut_touch *touch,
                                 const strut_contact_frame *frame);
/** Power that the ground's own motion gives to the structure through contact i [W]. */
double strut_surface_moving_power(const strut_touch *touch, const strut_contact_frame *frame);
/** By how much the facet of closed contact i is nearer than every other one at an end [m]. */
double strut_surface_facet_margin(const strut_contact_table *contacts,
                                  const strut_contact_modes *modes, const strut_step_end *end,
                                  int32_t i, int32_t *nearest);
/** The motion of the grounds at time t into an end. */
void strut_surface_move(const strut_model *model, const strut_state *state, strut_step_end *end,
                        double t);

/** 1 / (mass of the node of a contact) along a unit vector [1/kg]. */
static inline double strut_compliance_along(const strut_contact_compliance *compliance,
                                            const double unit[2]) {
  return compliance->own[0] * unit[0] * unit[0] + compliance->own[1] * unit[1] * unit[1];
}

/** Axes of contact i: those of the ground, or, with frames, of its surface where it was measured. */
static inline const strut_contact_axes *strut_axes_of_contact(const strut_contact_table *contacts,
                                                              const strut_contact_frame *frame,
                                                              int32_t i) {
  assert(i >= 0 && i < contacts->count);
  return frame ? &frame[i].axes : &contacts->axes;
}
/**
 * Closed contacts, and open ones that may touch at stepper->next or, with h > 0, within the step of h that ends there.
 * Ascending, into list (contacts); returns their number.
 */
int32_t strut_surface_candidates(const strut_model *model, const strut_event_stepper *stepper,
                                 double h, int32_t *list);
