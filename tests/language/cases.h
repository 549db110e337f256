/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Faulty scenes and studies, of documents that hold many: a base, and cases that change lines of it.
 * docs/dev/testing.md describes the format.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { CASE_MOST_MESSAGES = 40, CASE_MOST_SETS = 8 };

typedef struct faulty_case {
  char *name;     /* empty for a base */
  char *document; /* PATH:LINE of the document that has the case */
  char *text;     /* of the scene or study, NUL-terminated; may hold further NULs */
  size_t length;
  bool is_base;        /* a base, which has no fault */
  const char *purpose; /* "run", "statics" or "any" */
  size_t message_count, set_count;
  char *message[CASE_MOST_MESSAGES]; /* "LINE:COLUMN: text"; notes have "note: " before that */
  char *set[CASE_MOST_SETS];         /* "NAME=VALUE" */
} faulty_case;

typedef struct faulty_cases {
  faulty_case *items;
  size_t count;
} faulty_cases;

/** All cases of the documents (*.cases) of a folder, by document and place in it. What cannot be read, or a
    change that does not fit exactly one line of the base, ends the program with a message. */
faulty_cases read_faulty_cases(const char *folder);
void free_faulty_cases(faulty_cases *cases);
/** The case of that name; NULL where none has it. */
const faulty_case *find_faulty_case(const faulty_cases *cases, const char *name);
/** Writes the text as FOLDER/NAME.yaml; false, with a message, where that fails. */
bool write_faulty_case(const faulty_case *c, const char *folder);
