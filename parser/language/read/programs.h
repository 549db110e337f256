/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Sensors, states, signals and controllers: the names and programs that their readers share. Internal to parser/. */
#pragma once

#include "parser/language/read/reader.h"

/** Of what a sensor sees. */
strut_dimension strut_sensor_dimension(const strut_sensor *sensor);
/** One column of the motion as a program of one instruction; NULL: that is reported. */
strut_instruction *strut_read_column(strut_reader *reader, const strut_tree *value, const char *key,
                                     strut_owner owner, strut_column *column);
/** Of the values of an observable. */
strut_dimension strut_column_dimension(strut_column_kind kind);
/** Finds a sensor or a state as a column and its dimension. */
bool strut_find_sensed(strut_reader *reader, const char *name, strut_column *column,
                       strut_dimension *dimension);
/** Is it the name of a sensor, a state or a signal? Then the column is filled, with item -1 where it is broken. */
bool strut_find_variable(strut_reader *reader, strut_piece name, strut_column *column,
                         strut_dimension *dimension);
/** OWNER.FIELD as written in the text: a name with dots. */
strut_piece strut_whole_name(strut_piece owner, strut_piece field);
/** The rate of a sensor as a column, as strut_find_column. */
int strut_find_sensor_rate(strut_reader *reader, strut_piece name, strut_column *column,
                           strut_dimension *dimension, strut_refusal *refusal);
/** Names and values at t = 0 of internal states, oscillators and controllers; their rates. */
void strut_list_states(strut_reader *reader);
void strut_read_states(strut_reader *reader);
/** read_controllers.c: signals and rates of controllers, and rates of oscillators. */
void strut_list_controllers(strut_reader *reader);
void strut_read_controllers(strut_reader *reader);
bool strut_read_oscillator(strut_reader *reader, const strut_tree *key, int32_t state);
/** May an expression read the name of a `kind`, and mean nothing else by it? If not, that is reported. */
bool strut_check_variable_name(strut_reader *reader, const strut_tree *key, const char *kind);
/** Appends an internal state; -1: out of memory, or too many errors. */
int32_t strut_add_state(strut_reader *reader, const strut_tree *key, const char *name,
                        strut_dimension dimension, double start);
/** Appends the signal that a controller is; -1: out of memory. gain: its gain where that has no unit, or NULL. */
int32_t strut_add_controller_signal(strut_reader *reader, const strut_tree *key,
                                    const strut_signal *signal, strut_dimension dimension,
                                    bool bare, const strut_tree *gain);
/** The signal that the controller behind the key stands for; -1: it was reported. */
int32_t strut_read_controller(strut_reader *reader, const strut_tree *key);
bool strut_is_relay(const strut_tree *map);
int32_t strut_read_network(strut_reader *reader, const strut_tree *key);
/** Enters a signal, or controller, by its name. */
void strut_list_signal(strut_reader *reader, const strut_tree *key, bool controller);
/** A program under construction: instructions in postfix order. */
typedef struct strut_program_builder {
  strut_reader *reader;
  strut_instruction *code; /* in scratch */
  size_t length, room, stacked, most;
} strut_program_builder;
/**
 * Appends instructions, a letter each: # a number with its dimension, s a sensor, r its rate, x a state, v a signal
 * (whose numbers follow as arguments); the operations + - * / and < the lesser, > the greater, i sine, t tanh.
 */
void strut_build(strut_program_builder *self, const char *postfix, ...);
/** The whole, in the scene's memory. */
strut_program strut_built(const strut_program_builder *self);
/**
 * "NAME_END" of a part of what the key names, where no `taken` name or, with NULL, no variable is called so; NULL:
 * that is reported as one of `what`, such as "a part of pipe".
 */
const char *strut_made_name(strut_reader *reader, const strut_tree *key, const char *what,
                            const char *end, const strut_name_map *taken);
/** Most sensors, and most actuators, that pipes stand for. */
size_t strut_pipes_most(strut_reader *reader);
/** Their sensors, states and signals; and after actuators those that they stand for. */
void strut_read_pipes(strut_reader *reader);
void strut_add_pipe_drives(strut_reader *reader);
/** An expression of the time, sensors and signals; in the scene's memory. */
bool strut_read_signal_program(strut_reader *reader, const strut_tree *value, const char *key,
                               strut_owner owner, strut_program *program, strut_quantity *quantity);
/**
 * Index of a named signal that an expression reads, and its dimension, NAN of one made of plain numbers;
 * -1: it was reported.
 */
int32_t strut_use_signal(strut_reader *reader, const char *name, strut_dimension *dimension);
/** The expression as a program that the scene keeps, by the compiler's names; NULL: that is reported. */
strut_instruction *strut_compile(strut_reader *reader, const strut_tree *value, const char *key,
                                 strut_owner owner, strut_compiler *compiler,
                                 strut_quantity *quantity);
/**
 * Within {...} a comma ends an unquoted text: angle(a, b) becomes "angle(a". True where that has
 * happened, which is reported.
 */
bool strut_ends_at_comma(strut_reader *reader, const strut_tree *of, const char *key,
                         strut_owner owner);
