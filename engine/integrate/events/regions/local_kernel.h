/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Hot: forces and steps of one region. See local_events.h; the functions are in local_kernel.c. */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_REGIONS_LOCAL_KERNEL_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_REGIONS_LOCAL_KERNEL_H

#include "engine/integrate/events/event_stepping.h"
#include "engine/integrate/events/regions/local_region.h"

/*
 * Steps of error control may be far shorter than the longest, by so many halvings; shorter ones reach no
 * farther.
 */
enum { STRUT_LOCAL_HALVINGS = 24 };

typedef struct strut_local_events {
  strut_local_region_map map;
  double longest;                  /* step [s] */
  int reach[STRUT_LOCAL_HALVINGS]; /* of regions in steps of that over 2^k; 0: too far */
  strut_local_region region;
  strut_event_stepper own; /* of the region under way */
  strut_step_formula formula;
  strut_state shell; /* what else the law asks of a state */
  bool far, failed;  /* something changed far out; the region cannot be stepped alone */
  int64_t evaluated; /* nodes, since so many counted as an evaluation of the forces */
  /** The step of the whole, which moves the halo. */
  struct {
    const strut_step_end *begin, *end;
    double start, span; /* [s] */
  } whole;
  /** Members of the region, one after the other. */
  struct {
    uint32_t *from, *to;
    double *stiffness, *damping, *rest;
    strut_member_table table;
    int32_t *law_of, *law; /* (members) law of a cable, or -1; (laws) those of the region */
  } members;
  /** (length) each. */
  struct {
    double *quiet_q, *quiet_v; /* the region's step without events */
    double *more_q, *more_v;   /* what regions add to the step of the whole */
    double *own_q, *own_v;     /* their own ends */
    double *push_q, *push_v;   /* what their masses do to their halos: M times a change of motion */
    double *far_q, *far_v;     /* that change */
  } motion;
  /** (nodes) each. */
  struct {
    uint8_t *seed, *joined; /* where events are; those that a region has been grown from */
    uint8_t *regions;       /* regions with this node: 0, 1, or 2 for more */
    uint8_t *inside;        /* whether it was in the middle of the region that wrote it */
    int32_t *seeds, *written, *changed; /* lists */
    int32_t seed_count, written_count, changed_count;
  } nodes;
  /** How contacts of the region answer along the ground to each other. */
  struct {
    double *of;      /* (place, place), where known */
    double *columns; /* (few, node_count, 2) of M^-1 T where few are stuck */
    uint8_t *known;
    int32_t *place; /* (contacts) in the region's list */
    int32_t *first; /* columns where the rows of the stuck contacts' factor begin */
    int32_t *factored, factored_count; /* the stuck contacts it belongs to */
  } answers;
  /** Modes at the beginning of the step. */
  struct {
    uint8_t *mode, *acting; /* (contacts), (laws) */
    int8_t *side, *damper;
  } before;
} strut_local_events;

/** The trial of a region's stepper. */
void strut_local_trial(const strut_model *model, strut_state *state, strut_event_stepper *l,
                       double t, double h);
/** The members of the region into its table. */
void strut_local_load_members(const strut_model *model, strut_local_events *p);
/** Positions and velocities of the halo at a part of the step, and region->halo_a. */
void strut_local_place_halo(strut_local_events *p, double part, double *q, double *v);

#endif
