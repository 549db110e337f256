/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The scene: the input of the user as a plain, editable description in SI units.
 *
 * A scene owns all its texts and arrays in one arena (strut_scene_free releases them). Items refer
 * to each other by array index; -1 means none. However a scene was filled, strut_setup_check
 * decides whether it is valid, and strut_model_compile turns it into a model to run.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/scene/data.h"
#include "engine/scene/friction.h"
#include "engine/scene/law.h"
#include "engine/scene/signal.h"
#include "engine/scene/signal_program.h"

enum { STRUT_LANGUAGE_VERSION = 1 };

typedef struct strut_node {
  const char *name;
  double position[2]; /* as drawn [m] */
  double mass;        /* point mass [kg], >= 0 */
  bool fixed[2];      /* supported in x, in y */
  double start[2];    /* position at t = 0 [m]; equals position unless the scene says otherwise */
  double velocity[2]; /* at t = 0 [m/s]; 0 where fixed */
} strut_node;

typedef enum strut_member_kind {
  STRUT_BAR,    /* pulls and pushes; drawn thick */
  STRUT_SPRING, /* pulls and pushes: the paper's tensioned members */
  STRUT_CABLE   /* pulls only: force max(0, elastic + damper) while stretched, 0 while slack */
} strut_member_kind;

/** "bar", "spring" or "cable". */
STRUT_API const char *strut_member_kind_name(strut_member_kind kind);

/** The quantity that defines the rest length; strut_member_rest converts it to the others. */
typedef enum strut_rest_kind {
  STRUT_REST_RATIO,        /* rest length / drawn length [1]; the default, with value 1 */
  STRUT_REST_LENGTH,       /* rest length [m] */
  STRUT_REST_PRETENSION,   /* force in the drawn shape [N], tension positive */
  STRUT_REST_FORCE_DENSITY /* that force / drawn length [N/m] */
} strut_rest_kind;

/** Most nodes of a running cable or of a cell. */
enum { STRUT_MOST_ELEMENT_NODES = 32 };

/** A spring and a dashpot in a row, beside a member: F' = stiffness (u' - F / damping). */
typedef struct strut_maxwell {
  double stiffness; /* [N/m]; 0: there is none */
  double damping;   /* [N s/m]; 0 when the time is given */
  double time;      /* damping / stiffness [s] */
  double force;     /* at t = 0 [N] */
} strut_maxwell;

/** Side of a cable, followed from its first node to its last, on which the circles of its guides are. */
typedef enum strut_guide_side {
  STRUT_GUIDE_AS_DRAWN, /* each as the cable turns over it */
  STRUT_GUIDE_LEFT,
  STRUT_GUIDE_RIGHT
} strut_guide_side;

typedef struct strut_member {
  const char *name;
  int32_t node[2]; /* i1, i2 of the paper; of a running cable its ends */
  int32_t *guides; /* (guide_count) of a running cable: the nodes that it passes in between */
  size_t guide_count;
  strut_member_kind kind;
  double stiffness;       /* c [N/m], >= 0; 0 when axial_stiffness is given */
  double axial_stiffness; /* EA [N], >= 0; then c = EA / rest length */
  double damping;         /* k [N s/m], >= 0 */
  double mass;            /* of the whole member [kg], >= 0 */
  strut_rest_kind rest_kind;
  double rest_value;        /* in the unit of rest_kind */
  strut_law law;            /* linear by default; a cable carries tension whatever the law says */
  double shortest, longest; /* lengths at which stops act [m]; 0: none */
  double stop_stiffness;    /* [N/m]; 0: 100 times the member's */
  double stop_damping;      /* [N s/m] of a stop while it acts */
  double breaks_at;         /* tension from which on the member carries nothing [N]; 0: never */
  double released_at;       /* time from which on it carries nothing [s]; 0: never */
  double guide_friction;    /* of a running cable at its guides [1] */
  double guide_radius;      /* of circles about its guides [m]; 0: points */
  strut_guide_side guide_side; /* on which side of it they are */
  double damping_ratio;        /* instead of damping, or 0: of the critical one, see theory.md */
  strut_maxwell maxwell;
} strut_member;

/** A spring of the angle at the second of three nodes, from the first to the third. */
typedef struct strut_hinge {
  const char *name;
  int32_t node[3];
  double stiffness;   /* [N m/rad] */
  double damping;     /* [N m s/rad] */
  double rest_angle;  /* [rad]; NAN: as drawn, within half a turn */
  strut_law law;      /* of the angle and the moment */
  double breaks_at;   /* size of the moment from which on the hinge has none [N m]; 0: never */
  double released_at; /* time from which on it has none [s]; 0: never */
} strut_hinge;

/** A polygon of nodes, in either sense, under a given pressure, filled with a closed gas, or elastic. */
typedef struct strut_cell {
  const char *name;
  int32_t *node; /* (node_count) */
  size_t node_count;
  strut_law_kind law; /* one of STRUT_CELL_LAWS; STRUT_LAW_LINEAR: it is elastic */
  double pressure;    /* [N/m], pushing outwards; of a gas as drawn, absolute */
  double exponent;    /* of an isentropic gas, > 1 */
  double outside;     /* pressure outside a gas [N/m] */
  /* of an elastic cell */
  double stiffness, damping; /* loss of pressure per area and its rate [N/m^3], [N s/m^3] */
  double rest_area;          /* without pressure [m^2]; NAN: as drawn */
  strut_law elastic;         /* of the area beyond that one and minus the pressure */
} strut_cell;

/** Does its area have a law of its own, with neither a given pressure nor a gas? */
static inline bool strut_cell_is_elastic(const strut_cell *cell) {
  return !strut_law_is_of_cells(cell->law);
}

/**
 * Two bodies that may touch: two of nodes and members, each as thick as half of `thickness`. A node is a
 * disc, a member a straight rod with round ends. They push each other apart and never pull.
 */
typedef struct strut_collision {
  const char *name;
  int32_t node[2], member[2]; /* two of these, node[0] and member[0] first; the others -1 */
  double thickness;           /* distance of their axes at which they touch [m], > 0 */
  double stiffness;           /* [N/m], > 0 */
  double damping;             /* [N s/m] while they push */
  strut_friction
      friction; /* smooth, or with a decay_velocity Stribeck's; none where mu_kinetic is 0 */
} strut_collision;

/**
 * A spring of a distance: of node[1] from node[0] along a direction, positive where it lies ahead; or of
 * node[0] from the line through two nodes, positive on the left of the way from line[0] to line[1].
 */
typedef struct strut_distance_spring {
  const char *name;
  int32_t node[2], line[2]; /* -1: unused in its form */
  double along;             /* the direction, from +x [rad] */
  double stiffness;         /* [N/m] */
  double damping;           /* [N s/m] */
  double rest_distance;     /* [m], of either sign; NAN: as drawn */
  strut_law law;            /* of distance - rest distance and the force, tension positive */
} strut_distance_spring;

/** Damping law of the ground; d is the depth, d' its rate. */
typedef enum strut_ground_damping {
  STRUT_DAMPING_APPROACH,      /* (8): c_g d + k_g max(d', 0), which jumps at touchdown */
  STRUT_DAMPING_HUNT_CROSSLEY, /* c_g d (1 + chi d'), never pulling: continuous */
  STRUT_DAMPING_COUNT
} strut_ground_damping;

/** Shape of a ground's surface. */
typedef enum strut_ground_shape {
  STRUT_GROUND_LINE,
  STRUT_GROUND_PROFILE, /* a polyline, solid to the right of its direction, its ends continued straight */
  STRUT_GROUND_CIRCLE /* solid inside, or outside */
} strut_ground_shape;

/**
 * The ground line y = height + x tan(slope); its surface moves along itself at belt_speed. The fields
 * after damping_law are those of scene->grounds only.
 */
typedef struct strut_ground {
  bool present;
  double height;                    /* [m] */
  double slope;                     /* [rad], within +-pi/2; of grounds, any */
  double belt_speed;                /* [m/s], along the slope, positive towards +x */
  strut_ground_damping damping_law; /* of all contacts */
  const char *name;                 /* "" of `ground:` */
  strut_ground_shape shape;
  bool placed;              /* the line goes through `through`, otherwise through (0, height) */
  double through[2];        /* [m] */
  size_t point_count;       /* of a profile */
  double (*points)[2];      /* (point_count) [m] */
  double centre[2], radius; /* of a circle [m] */
  bool inside;              /* the free space of a circle is inside */
  bool moves[2];            /* the surface is shaken in x, in y: */
  int32_t motion[2];        /* signals of its displacement, where it moves [m] */
} strut_ground;

/** One node that may touch the ground. */
typedef struct strut_contact {
  int32_t node;
  double stiffness;   /* c_g [N/m], > 0 */
  double damping;     /* k_g [N s/m], >= 0; acts while the node moves into the ground, (8) */
  double dissipation; /* chi [s/m], >= 0; instead of k_g with the Hunt-Crossley law */
  strut_friction friction;
  int32_t ground;   /* index into scene->grounds; 0 of scene->ground */
  int32_t piece;    /* convex piece of a profile (profile.h); 0 otherwise */
  const char *name; /* NULL: that of its node */
} strut_contact;

/**
 * Drives the rest length of a member, the rest angle of a hinge, or the pressure of a cell: it + signal(t).
 * Or adds a force along the member, tension positive, or a moment that closes the hinge where positive.
 */
typedef struct strut_actuator {
  const char *name;
  int32_t member, signal;
  int32_t hinge; /* where member is -1 */
  uint32_t
      force; /* not 0: the signal is a force [N] (1) or a moment [N m] (2) added to the member's or hinge's own */
  int32_t cell; /* where both are -1 */
} strut_actuator;

/** A supported coordinate of a node that moves in a run: where it starts, plus signal(t). */
typedef struct strut_support_motion {
  int32_t node, axis; /* axis: 0 x, 1 y; the node is fixed there */
  int32_t signal;     /* [m] */
} strut_support_motion;

/** A mass that rotates about a node: at `phase`, plus speed t or signal(t), from +x [rad]. */
typedef struct strut_unbalance {
  const char *name;
  int32_t node, signal; /* signal: of the angle [rad], or -1 */
  double mass, radius;  /* [kg], [m] */
  double speed, phase;  /* [rad/s], 0 with a signal; [rad] */
} strut_unbalance;

/**
 * A point mass on the straight line between the two nodes of a member, at the share of that line from the
 * first node that is `share`, plus signal(t) if there is one. It weighs, and it follows its signal exactly.
 */
typedef struct strut_sliding_mass {
  const char *name;
  int32_t member, signal; /* signal: or -1, at rest on the member */
  double mass;            /* [kg], > 0 */
  double share;           /* 0 at the first node, 1 at the second */
  bool travel; /* the signal is a length [m] along the member as drawn, otherwise a share [1] */
} strut_sliding_mass;

/** A force on a node, or a couple: a moment on the angle of a hinge or of a member; times signal(t) if there is one. */
typedef struct strut_load {
  const char *name;
  int32_t node;
  double force[2]; /* [N]; with a signal a direction, or a force scaled by the signal */
  int32_t signal;  /* or -1 */
  bool couple;
  int32_t hinge, member; /* of a couple; one of them is -1 */
  double moment;         /* of a couple, counter-clockwise [N m] */
} strut_load;

static inline void strut_load_scale(strut_load *load, double factor) {
  for (int c = 0; c < 2; c++) load->force[c] *= factor;
  load->moment *= factor;
}

/** A parameter as used, for the record only: the numbers of the scene already contain it. */
typedef struct strut_parameter {
  const char *name;
  const char *text; /* as written, such as "10 Hz" */
  double value;     /* SI; NAN where it is a text, such as a configuration's name */
  strut_file_unit shown;
} strut_parameter;

typedef enum strut_mass_model { STRUT_MASS_CONSISTENT, STRUT_MASS_LUMPED } strut_mass_model;

typedef enum strut_bar_model {
  STRUT_BARS_ELASTIC,
  STRUT_BARS_RIGID /* bars keep the length they have at the start, as loaded there */
} strut_bar_model;

/** Some nodes, in the order they were given. */
typedef struct strut_node_set {
  size_t count;
  int32_t *node; /* (count) */
} strut_node_set;

/** A named shape: a start, and the name of an equilibrium of that shape. */
typedef struct strut_configuration {
  const char *name;
  bool shaped;           /* some position was given; otherwise contacts alone identify it */
  double (*position)[2]; /* (node_count) [m]; as drawn where the scene gives none */
  size_t set_count;      /* sets of contact nodes on which it may stand; 0: not given */
  strut_node_set *sets;  /* (set_count) */
} strut_configuration;

/**
 * A circular arc at an end of a member: it stands on the node there, square to the member, on whose line its
 * middle lies. It rolls on every ground that the node may touch, as a whole circle.
 */
typedef struct strut_foot {
  const char *name;
  int32_t member, node; /* the node is one of the member's ends */
  double radius;        /* [m], > 0 */
} strut_foot;

typedef struct strut_scene {
  const char *name, *description, *source; /* never NULL */
  strut_mass_model mass_model;
  strut_bar_model bar_model;
  double gravity[2]; /* [m/s^2]; default 0, 0 */
  size_t node_count, member_count, hinge_count, contact_count, actuator_count, load_count,
      signal_count, parameter_count, configuration_count;
  strut_node *nodes;
  strut_member *members;
  strut_hinge *hinges;
  strut_ground ground;     /* one straight line at rest; otherwise not present, and in `grounds` */
  strut_contact *contacts; /* in the order of nodes, grounds and pieces, one of each at most */
  strut_actuator *actuators;
  strut_load *loads;
  strut_signal *signals;
  strut_parameter *parameters;
  strut_configuration *configurations;
  int32_t start_equilibrium; /* configuration at whose equilibrium a run starts, or -1. A run wants
                                it resolved into positions: strut_resolve_start_equilibrium */
  strut_arena arena;         /* owns every text and array of the scene */
  int32_t lattice_count;     /* 1 or 2 where the structure repeats without end; else 0 */
  double lattice[2][2];      /* (lattice_count, 2) steps from cell to cell [m] */
  double rayleigh_mass;      /* damping by mass, alpha M v [1/s] */
  double rayleigh_stiffness; /* damping by stiffness, beta c in every member and hinge [s] */
  size_t support_motion_count;
  strut_support_motion *support_motions; /* in the order of nodes, x before y */
  size_t cell_count;
  strut_cell *cells;
  size_t collision_count;
  strut_collision *collisions;
  size_t distance_count;
  strut_distance_spring *distances;
  size_t foot_count;
  strut_foot *feet;
  size_t unbalance_count;
  strut_unbalance *unbalances;
  size_t ground_count;   /* 0 without a ground, and with `ground` */
  strut_ground *grounds; /* in the arena, too */
  size_t sensor_count, state_count;
  strut_sensor *sensors;
  strut_internal_state *states;
  size_t sliding_count;
  strut_sliding_mass *sliding_masses;
  size_t table_count;
  const strut_data_table *tables; /* (table_count) measured data; scenes of one text share them */
} strut_scene;

/** Default structs: zero except where stated above, names empty, indices -1. */
STRUT_API void strut_scene_init(strut_scene *scene);
STRUT_API strut_node strut_node_default(void);
STRUT_API strut_member strut_member_default(void);
STRUT_API strut_hinge strut_hinge_default(void);
STRUT_API strut_contact strut_contact_default(void);
STRUT_API strut_cell strut_cell_default(void);
STRUT_API strut_collision strut_collision_default(void);
/** Frees the contents of the scene and zeroes it. */
STRUT_API void strut_scene_free(strut_scene *scene);
/** Time of the last start or end of a signal, after which motions may be steady [s]. */
STRUT_API double strut_scene_last_signal_event(const strut_scene *scene);
/** Do all signals without an end repeat themselves after this time [s]? */
STRUT_API bool strut_scene_signals_repeat(const strut_scene *scene, double time);

/**
 * The four equivalent descriptions of the prestress of a member, and its stiffness, in the drawn
 * shape.
 */
typedef struct strut_rest {
  double drawn_length;  /* [m] */
  double length;        /* rest length lambda_0 [m] */
  double ratio;         /* rest length / drawn length [1] */
  double pretension;    /* force in the drawn shape [N], tension positive (cables: 0 when slack) */
  double force_density; /* pretension / drawn length [N/m] */
  double stiffness;     /* c [N/m] */
} strut_rest;

/**
 * Resolves the rest length of a member from its description. With c: L0 = L - t/c; with EA: L0 = EA
 * L/(EA + t). Returns false where that is impossible (pretension without stiffness, rest length not
 * >= 0).
 */
STRUT_API bool strut_member_rest(const strut_scene *scene, size_t member, strut_rest *rest);

/** Does a member not turn at guide k (1 is the first) in the drawn shape? */
STRUT_API bool strut_member_is_straight_at(const strut_scene *scene, const strut_member *member,
                                           size_t k);
/** Bit k: guide k (1 is the first) of a member is to its right (wrap.h). */
STRUT_API uint32_t strut_member_right_guides(const strut_scene *scene, const strut_member *member);
/** Node k of a member's way: its first node, its guides, its second node; k < guide_count + 2. */
static inline int32_t strut_member_node(const strut_member *member, size_t k) {
  return k == 0                    ? member->node[0]
         : k > member->guide_count ? member->node[1]
                                   : member->guides[k - 1];
}

/** True for a member that carries nothing from some force or time on. */
static inline bool strut_member_ends(const strut_member *member) {
  return member->breaks_at > 0.0 || member->released_at > 0.0;
}

/** A distance in the drawn shape, and the one without force [m]. */
STRUT_API double strut_distance_drawn(const strut_scene *scene, size_t index);
STRUT_API double strut_distance_rest(const strut_scene *scene, size_t index);

/** The same of a hinge. */
static inline bool strut_hinge_ends(const strut_hinge *hinge) {
  return hinge->breaks_at > 0.0 || hinge->released_at > 0.0;
}

/** True for a member whose force is not that of a plain spring or cable between two nodes. */
static inline bool strut_member_is_special(const strut_member *member) {
  bool one_sided = member->law.carries != STRUT_CARRIES_BOTH && member->kind != STRUT_CABLE;
  return member->guide_count || member->law.kind != STRUT_LAW_LINEAR || one_sided ||
         strut_member_ends(member);
}

/**
 * Puts supports that move where they are at t = 0 and takes their motion away; with `shapes` as drawn
 * and in configurations, too, where rest lengths must be resolved. The arrays must be the scene's own.
 */
STRUT_API void strut_scene_hold_supports(strut_scene *scene, bool shapes);

/** Stops rotating masses: each becomes part of its node's mass. The nodes must be the scene's own. */
STRUT_API void strut_scene_stop_unbalances(strut_scene *scene);
/** The mass of all nodes, members, sliders and rotating masses [kg]. */
STRUT_API double strut_scene_mass(const strut_scene *scene);
/** Multiplies all masses by that factor. */
STRUT_API void strut_scene_scale_masses(strut_scene *scene, double factor);
/** Share of its member at which a sliding mass is at time t [s]. */
STRUT_API double strut_sliding_mass_share(const strut_scene *scene, size_t index, double t);
/** The rate of that share [1/s]. */
STRUT_API double strut_sliding_mass_rate(const strut_scene *scene, size_t index, double t);
/** The share per unit of its signal. */
STRUT_API double strut_sliding_mass_scale(const strut_scene *scene, size_t index);
/** Leaves sliding masses where they are at t = 0. False: out of memory of the arena. */
STRUT_API bool strut_scene_hold_sliding_masses(strut_scene *scene, strut_arena *arena);
/** Some node may touch something. */
static inline bool strut_scene_has_ground(const strut_scene *scene) {
  return scene->ground.present || scene->ground_count > 0;
}

/** Friction that follows a signal becomes that of t = 0; 1 of a signal that follows a sensor. */
STRUT_API void strut_scene_stop_grip(const strut_scene *scene, strut_friction *friction);

/**
 * Replaces the grounds of a copy of a scene by grounds at rest where they are at t = 0, without belts;
 * false: out of memory of the arena.
 */
STRUT_API bool strut_scene_stop_grounds(strut_scene *scene, strut_arena *arena);
/** Moves everything in a copy whose nodes, configurations and grounds are its own; false: out of memory. */
STRUT_API bool strut_scene_shift(strut_scene *scene, const double by[2], strut_arena *arena);

/** What outputs call a contact: the name of its node, with that of the ground where there are several. */
static inline const char *strut_contact_name(const strut_scene *scene, size_t contact) {
  const strut_contact *c = &scene->contacts[contact];
  return c->name ? c->name : scene->nodes[c->node].name;
}

/** Angle of a hinge as drawn, in (-pi, pi] [rad]. */
STRUT_API double strut_hinge_drawn(const strut_scene *scene, size_t hinge);
/** Rest angle of a hinge [rad]. */
STRUT_API double strut_hinge_rest(const strut_scene *scene, size_t hinge);

/** Area of a cell as drawn, positive where its nodes run counter-clockwise [m^2]. */
STRUT_API double strut_cell_drawn(const strut_scene *scene, size_t cell);
