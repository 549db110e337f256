/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of this folder share. See code.h. */
#ifndef STRUT_ENGINE_OUTPUT_CODE_WRITER_H
#define STRUT_ENGINE_OUTPUT_CODE_WRITER_H

#include "engine/base/name_map.h"
#include "engine/output/buffer.h"
#include "engine/output/code/code.h"

/* Identifiers of things in an enum, all different. */
typedef struct strut_code_names {
  size_t count;
  char **name; /* (count) */
} strut_code_names;

enum { STRUT_CODE_MOST_LAW_TEXTS = 400 };

typedef struct strut_code_writer {
  const strut_model *model;
  const strut_scene *scene;
  const strut_experiment *experiment;
  const strut_code_options *options;
  char upper[65]; /* the prefix in capitals */
  strut_code_names nodes, members, inputs, breakables, signals, sensors, states, sliders;
  double rk4_limit, verlet_limit; /* largest stable steps [s] */
  strut_buffer text;
  bool no_float;                             /* some number is none of a float */
  bool law_texts[STRUT_CODE_MOST_LAW_TEXTS]; /* which definitions of law_text.c are written */
  strut_arena arena;
} strut_code_writer;

/* Grounds that are shaken, an axis each; the n-th of them, NULL: there are no more. */
int32_t strut_code_shake_count(const strut_model *model);
const strut_ground *strut_code_shaken(const strut_model *model, int32_t n, int *axis);

/* Inputs: the drives in the model's order, then the loads with a signal, then the forces of actuators, then the
   motions of grounds. */
static inline int32_t strut_code_input_count(const strut_model *model) {
  return model->drives.count + model->loads.count + model->actuator_forces.count +
         strut_code_shake_count(model);
}

/* names.c: makes the identifiers; false: memory is out. */
bool strut_code_make_names(strut_code_writer *w);

/* Appends a text as it may stand in a comment. */
void strut_code_add_comment(strut_code_writer *w, const char *text);
/* Appends a literal of the file's numbers, or of a double whatever these are. */
void strut_code_add_real(strut_code_writer *w, double value);
void strut_code_add_double(strut_code_writer *w, double value);

/* Parts of declarations: ", 1.0"; the end of a row, with its name as a comment; a constant. */
void strut_code_add_field(strut_code_writer *w, double value);
void strut_code_end_row(strut_code_writer *w, const char *name);
void strut_code_add_constant(strut_code_writer *w, const char *name, double value);

/* What templates ask for: does a word hold; declarations; numbers in a line. Words are the templates' own. */
bool strut_code_has(const strut_code_writer *w, const char *word, size_t length);
bool strut_code_holds(const strut_code_writer *w, const char *word);
void strut_code_add_part(strut_code_writer *w, const char *word, size_t length);

/* A word that templates ask for; tables of them end with a row of NULL. */
typedef struct strut_code_condition {
  const char *word;
  bool (*holds)(const strut_code_writer *);
} strut_code_condition;

/* ground_tables.c: contacts, and the surfaces they touch where these are not one straight line at rest. */
extern const strut_code_condition strut_code_ground_conditions[];
bool strut_code_has_circles(const strut_code_writer *w);
bool strut_code_has_pieces(const strut_code_writer *w);
void strut_code_add_contacts(strut_code_writer *w);
void strut_code_add_ground_law(strut_code_writer *w);
void strut_code_add_friction(strut_code_writer *w);
void strut_code_add_surfaces(strut_code_writer *w);

/* feedback_tables.c: what follows the motion. Signals that no input follows are left out. */
extern const strut_code_condition strut_code_feedback_conditions[];
bool strut_code_has_feedback(const strut_code_writer *w);
bool strut_code_has_states(const strut_code_writer *w);
bool strut_code_has_internal_states(const strut_code_writer *w);
bool strut_code_has_relays(const strut_code_writer *w);
/* How many samples, times of start and sides of relays the state has, and which a signal has. */
int32_t strut_code_sample_count(const strut_code_writer *w);
int32_t strut_code_start_count(const strut_code_writer *w);
int32_t strut_code_relay_count(const strut_code_writer *w);
int32_t strut_code_sample_of(const strut_code_writer *w, int32_t signal);
int32_t strut_code_start_of(const strut_code_writer *w, int32_t signal);
int32_t strut_code_relay_of(const strut_code_writer *w, int32_t signal);
/* Internal state k, which is that of a lag or a Maxwell branch where `kind` is not empty. */
const char *strut_code_state_name(const strut_code_writer *w, int32_t k, const char **kind);
void strut_code_add_start_states(strut_code_writer *w);
void strut_code_add_maxwell(strut_code_writer *w);
void strut_code_add_sensors(strut_code_writer *w);
void strut_code_add_feedback(strut_code_writer *w);

/* sliding_tables.c: masses that slide along members. The signal of the k-th that moves, -1: there are no more. */
extern const strut_code_condition strut_code_sliding_conditions[];
bool strut_code_has_sliding(const strut_code_writer *w);
int32_t strut_code_slider_signal(const strut_code_writer *w, int32_t k);
const char *strut_code_slider_name(const strut_code_writer *w, int32_t k);
void strut_code_add_sliders(strut_code_writer *w);
void strut_code_add_places(strut_code_writer *w);
void strut_code_add_resting(strut_code_writer *w);
void strut_code_add_resting_damping(strut_code_writer *w);

/* model_tables.c: the law of members. */
void strut_code_add_member_law(strut_code_writer *w);
/* The formulas of rk4. */
void strut_code_add_step_law(strut_code_writer *w);
/* Declarations of the model: members, contacts, drives, loads, masses, start. And the lines that solve for
   accelerations. */
void strut_code_add_model(strut_code_writer *w);
void strut_code_add_solve(strut_code_writer *w);
/* A function for each signal that acts, and the table of the inputs' own. */
void strut_code_add_signals(strut_code_writer *w);
/* Second derivatives of the signals that move sliders. */
void strut_code_add_second_rates(strut_code_writer *w);
/* Does some signal that acts, or one of its terms, have this kind? */
bool strut_code_has_signal(const strut_code_writer *w, strut_signal_kind kind);
/* Is the signal that of an input, or part of one? */
bool strut_code_signal_acts(const strut_code_writer *w, int32_t signal);

/* element_tables.c: what templates ask for behind "strain_", "law_" and "op_". */
bool strut_code_has_strain(const strut_code_writer *w, const char *word, size_t length);
bool strut_code_has_law(const strut_code_writer *w, const char *word, size_t length);
bool strut_code_has_operation(const strut_code_writer *w, const char *word, size_t length);
/* Where a natural strain stands: those of members, of hinges, of cells. */
int32_t strut_code_slot(const strut_model *model, int32_t slot);
int32_t strut_code_slot_count(const strut_code_writer *w);
/* Natural strains of all slots, from which drives start. */
void strut_code_add_own_rests(strut_code_writer *w);
void strut_code_add_elements(strut_code_writer *w);
int32_t strut_code_slider_count(const strut_code_writer *w);
bool strut_code_has_breakables(const strut_code_writer *w);
void strut_code_add_breakables(strut_code_writer *w);
void strut_code_add_blocks(strut_code_writer *w);
void strut_code_add_strains(strut_code_writer *w);
/* Is there a text of it? */
bool strut_code_knows_element_law(strut_law_kind law);
void strut_code_add_element_laws(strut_code_writer *w);
void strut_code_add_law_numbers(strut_code_writer *w);
void strut_code_add_actuator_forces(strut_code_writer *w);
/* The lines that compute an expression at t, into x[0]. */
void strut_code_add_program(strut_code_writer *w, const strut_program *program);

/* Expands a template into the text. */
void strut_code_expand(strut_code_writer *w, const char *template);

/* The engine's own texts of laws (scene/laws, forces/strains) in exported code: put into the program at build
 * time, taken apart into functions and types, and written with the exported code's words.
 *
 * `LAW(name)` and `strut_name` become `name`, doubles `real`, numbers of formulas floats where these are
 * wanted. Functions with preprocessor lines inside are not for other programs.
 */

/** Writes the function or type `name`, without prefix, after all that it names and that is not written yet. */
void strut_code_add_law(strut_code_writer *w, const char *name);
/** Do the texts have it? */
bool strut_code_knows_law(const char *name);

#endif
