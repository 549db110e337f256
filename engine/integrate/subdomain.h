/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A large structure divided among threads: each has a subdomain, a model of its own nodes and of ghost nodes
 * around them.
 *
 * Ghosts reach so far that STRUT_PASSES evaluations of the forces, one after the other, give the own nodes
 * the right motion although the outermost ghosts lack members; or one layer, where others tell how ghosts
 * move. Every node adds up its members in the scene's order, and every member that the energy balance counts
 * is counted by one subdomain, in whole blocks of the energy balance.
 *
 * Nodes are stored in the order of their last members, so that a node is ready to move soon after it was met.
 */
#ifndef STRUT_ENGINE_INTEGRATE_SUBDOMAIN_H
#define STRUT_ENGINE_INTEGRATE_SUBDOMAIN_H

#include "engine/base/memory.h"
#include "engine/model/state.h"

enum { STRUT_PASSES = 4 };

/** What all subdomains have in common. */
typedef struct strut_subdivision {
  const strut_model *model;
  const int32_t
      *member;    /* (members) the scene's member that is stored at k; NULL: as in the scene */
  int32_t *node;  /* (nodes) nodes in the order of their last members */
  int32_t *place; /* (nodes) the place of each in it */
  int32_t parts, *begin; /* (parts + 1) places where the nodes of each part begin */
  int32_t *block;        /* (parts + 1) blocks of the energy balance where its members begin */
  int32_t *shared;       /* (nodes) number of a node that is a ghost somewhere, or -1 */
  int32_t shared_count;
  int depth; /* layers of ghosts */
} strut_subdivision;

typedef struct strut_subdomain {
  strut_model model; /* its tables of members, contacts, loads and drives are the subdomain's */
  strut_state state; /* what kernels ask of one; q and v stay empty */
  int32_t count, own_begin, own_end; /* nodes, and which of them are its own */
  int32_t *node;                     /* (count) of the scene */
  int32_t block_begin, block_end;    /* blocks of members that the energy balance counts here */
  int32_t balance_begin;   /* block of the energy balance that the first of them belongs to */
  int32_t *need, *ready;   /* (blocks) nodes that have been met; that are done */
  int32_t *contact, *load; /* of the scene; both by node */
  int32_t *drive_order;    /* (drives) by slot */
  int32_t *published, *ghost, published_count,
      ghost_count; /* own nodes that are ghosts elsewhere */
} strut_subdomain;

/** depth: layers of ghosts, at most STRUT_PASSES. False: out of memory. */
bool strut_subdivision_create(const strut_model *model, const int32_t *member, int parts, int depth,
                              strut_arena *arena, strut_subdivision *division);
/** Members that all subdomains work on, over those that there are, about; without making them. */
double strut_subdivision_overlap(const strut_subdivision *division);
/** One thread per subdomain may do so at a time, each with an arena of its own. False: out of memory. */
bool strut_subdomain_create(const strut_subdivision *division, int part, strut_arena *arena,
                            strut_subdomain *domain);
/** Numbers the nodes that any subdomain has as ghosts, when all have been made. */
void strut_subdivision_share(strut_subdivision *division, strut_subdomain *const *domain);
/** Then, for each: lists of what it publishes and of its ghosts. */
bool strut_subdomain_connect(const strut_subdivision *division, strut_arena *arena,
                             strut_subdomain *domain);

#endif
