/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A file of springable while it is read: what its lines and its behaviours share. */
#ifndef STRUT_PARSER_IMPORT_SPRINGABLE_H
#define STRUT_PARSER_IMPORT_SPRINGABLE_H

#include "parser/import/import_parts.h"

enum { MOST_FIELDS = 8, MOST_CHAIN = 32, LONGEST_FIELD = 400, MOST_POINTS = 32 };

typedef struct strut_springable_parameter {
  const char *name, *own; /* in the file and in the scene */
  double value;
} strut_springable_parameter;

typedef struct strut_springable_point {
  long index;
  double position[2];
  bool held; /* in x and y */
} strut_springable_point;

/* One field of a line: its text without blanks at the ends. */
typedef struct strut_springable_field {
  const char *text;
  strut_place place;
} strut_springable_field;

typedef struct strut_springable {
  strut_import_scene *scene;
  strut_diagnostics *said;
  uint32_t line;
  size_t field_count;
  strut_springable_field fields[MOST_FIELDS];
  size_t parameter_count, node_count, node_room;
  strut_springable_parameter *parameters;
  strut_springable_point *nodes;
  size_t springs, angles, paths, distances, middles, areas, loads; /* so far */
  size_t stage_loads;      /* of the stage of LOADING that is being read */
  bool staged, blocking;   /* stages are written; after "block" */
  const char *hold, *stop; /* of the stage: its coordinates, or "" */
} strut_springable;

/* What a spring's line says behind its nodes. */
typedef struct strut_spring_values {
  const char *kind, *stiffness, *rest, *law;
} strut_spring_values;

/** The i-th field of the line, "" where there is none; and its place. */
const char *strut_springable_text(const strut_springable *r, size_t i);
strut_place strut_springable_place(const strut_springable *r, size_t i);
/** The node of that number, or NULL. */
const strut_springable_point *strut_springable_node(const strut_springable *r, long index);
/**
 * An expression as a scene's, or its number where it names nodes' coordinates; NULL where what is wrong was
 * reported. *value may be NULL.
 */
const char *strut_springable_expression(strut_springable *r, const char *text, strut_place place,
                                        double *value);
/** A whole number from 0 on at *at, which moves past it; -1: there is none. */
long strut_springable_index(const char **at);

/* The behaviour in the line's second field. NULL or false: it is another, or what is wrong was reported. */

/** That of a linear behaviour, "k", "k=3" or "LINEAR(k=3)". */
const char *strut_springable_stiffness(strut_springable *r);
/** Says that the line's element is left out for its behaviour. */
void strut_springable_note(strut_springable *r);
/** A PIECEWISE or ZIGZAG behaviour as ", law: {...}", a table; BEZIER, BEZIER2 or ZIGZAG2 as a curve. */
const char *strut_springable_curve(strut_springable *r);
/** Two straight pieces of a spring as a cable; `running`: over several nodes; length: its rest length, or NULL. */
bool strut_springable_two_pieces(strut_springable *r, bool running, const char *length,
                                 strut_spring_values *v);
/** CONTACT(f0; uc; delta), a force ((delta - d) / uc)^3 f0 below the distance delta. */
bool strut_springable_contact(strut_springable *r, strut_spring_values *v);
/** A gas as ", gas: {...}"; rest: the field of its natural area, or "". */
const char *strut_springable_gas(strut_springable *r, const char *rest);

#endif
