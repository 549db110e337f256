/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The Python module strut._strut: objects around the handles of parser/bindings/abi/abi.h, in CPython's limited
 * interface, so that one file serves Python 3.11 and later. It converts and checks; names, tables and
 * everything for people are in the package's Python files.
 *
 * Every object keeps a reference to its module, which holds the types, and to what it was made of: an
 * array lives as long as somebody looks at it, and with it the handle that owns its numbers.
 */
#ifndef STRUT_PARSER_BINDINGS_PYTHON_MODULE_H
#define STRUT_PARSER_BINDINGS_PYTHON_MODULE_H

#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include "strut/abi.h"

typedef struct {
  PyTypeObject *scene, *result, *simulation, *snapshot, *array;
} strut_py_types;

typedef struct {
  PyObject_HEAD PyObject *module;
  strutlib_scene *scene;
} strut_py_scene;

typedef struct {
  PyObject_HEAD PyObject *module;
  strutlib_result *result; /* NULL until a call has filled it */
} strut_py_result;

extern PyType_Spec strut_py_scene_spec, strut_py_result_spec, strut_py_simulation_spec,
    strut_py_snapshot_spec, strut_py_array_spec;

/** The types of `module`. */
strut_py_types *strut_py_types_of(PyObject *module);
/** A new object of `type`, zeroed behind its head but for `module`, which stands first. */
void *strut_py_new(PyTypeObject *type, PyObject *module);
/** Frees an object made by strut_py_new, of which everything else was released. */
void strut_py_delete(PyObject *object);

/** Raises the exception of strut._errors for an error, which it frees; returns NULL. */
PyObject *strut_py_raise(strutlib_error *error);
/** A text, None where it is NULL. */
PyObject *strut_py_text(const char *text);
/** The same of a text that belongs to the caller; NULL raises `error`. */
PyObject *strut_py_own_text(char *text, strutlib_error *error);

/** The texts of a tuple of str or None (NULL), valid as long as the tuple. */
typedef struct {
  size_t count;
  const char **text;
} strut_py_texts;
/** 0, or -1 with an exception. Also 0 texts are freed by strut_py_texts_free. */
int strut_py_texts_read(PyObject *tuple, strut_py_texts *texts);
void strut_py_texts_free(strut_py_texts *texts);
/** Names and values of the same length; 0, or -1 with an exception and nothing to free. */
int strut_py_pairs_read(PyObject *names, PyObject *values, strut_py_texts pair[2]);

/**
 * The object by which numpy and memoryview see data of `owner`; the type of
 * strutlib_scene_array and its like. Strides are counted in doubles.
 */
PyObject *strut_py_array(PyObject *module, PyObject *owner, const double *data, int dimensions,
                         const size_t *shape, const size_t *stride, int writable);

/**
 * Runs compute(context) in a thread of its own while this one, without the interpreter's lock, waits and
 * every 50 ms looks for signals and calls progress(fraction), unless that is None. Where one of them
 * raises, `control` is interrupted. Returns when compute() has: 0, or -1 with the exception. `control`
 * may be NULL for calls that cannot be interrupted.
 */
int strut_py_wait(void (*compute)(void *context), void *context, strutlib_control *control,
                  PyObject *progress);

/** A simulation opened by Scene.simulation. */
PyObject *strut_py_simulation(PyObject *module, strutlib_simulation *simulation,
                              strutlib_control *control);

#endif
