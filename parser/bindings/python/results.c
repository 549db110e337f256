/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Results and simulations, and the arrays that they show. */
#include <time.h>

#include "parser/bindings/python/module.h"

/* ---- an array of doubles by the buffer protocol: numpy.asarray and memoryview see it without a copy ---- */

typedef struct {
  PyObject_HEAD PyObject *module;
  PyObject *owner;
  double *data;
  int dimensions, writable;
  Py_ssize_t length; /* bytes */
  Py_ssize_t shape[STRUTLIB_DIMENSIONS], strides[STRUTLIB_DIMENSIONS];
} array_object;

PyObject *strut_py_array(PyObject *module, PyObject *owner, const double *data, int dimensions,
                         const size_t *shape, const size_t *stride, int writable) {
  array_object *array = strut_py_new(strut_py_types_of(module)->array, module);
  if (array == NULL) {
    return NULL;
  }
  array->owner = Py_NewRef(owner);
  array->data = (double *)data; /* written only where that is allowed */
  array->dimensions = dimensions;
  array->writable = writable;
  array->length = (Py_ssize_t)sizeof *data;
  for (int i = 0; i < dimensions; i++) {
    array->shape[i] = (Py_ssize_t)shape[i];
    array->strides[i] = (Py_ssize_t)(stride[i] * sizeof *data);
    array->length *= array->shape[i];
  }
  return (PyObject *)array;
}

static void delete_array(PyObject *self) {
  Py_XDECREF(((array_object *)self)->owner);
  strut_py_delete(self);
}

static int is_contiguous(const array_object *array) {
  Py_ssize_t expected = (Py_ssize_t)sizeof(double);
  for (int i = array->dimensions; i-- > 0;) {
    if (array->shape[i] > 1 && array->strides[i] != expected) {
      return array->length == 0;
    }
    expected *= array->shape[i];
  }
  return 1;
}

static int get_buffer(PyObject *self, Py_buffer *view, int flags) {
  static double nothing; /* what an empty array points at, since NULL means failure to some */
  array_object *array = (array_object *)self;
  view->obj = NULL;
  if ((flags & PyBUF_WRITABLE) == PyBUF_WRITABLE && !array->writable) {
    PyErr_SetString(PyExc_BufferError, "these numbers are read-only");
    return -1;
  }
  if ((flags & PyBUF_F_CONTIGUOUS) == PyBUF_F_CONTIGUOUS && array->dimensions > 1) {
    PyErr_SetString(PyExc_BufferError, "the array is in C's order");
    return -1;
  }
  if ((flags & PyBUF_STRIDES) != PyBUF_STRIDES && !is_contiguous(array)) {
    PyErr_SetString(PyExc_BufferError, "the array is not contiguous");
    return -1;
  }
  if ((flags & PyBUF_C_CONTIGUOUS) == PyBUF_C_CONTIGUOUS && !is_contiguous(array)) {
    PyErr_SetString(PyExc_BufferError, "the array is not contiguous");
    return -1;
  }
  view->buf = array->data != NULL ? (void *)array->data : (void *)&nothing;
  view->len = array->length;
  view->readonly = !array->writable;
  view->itemsize = (Py_ssize_t)sizeof(double);
  view->format = (flags & PyBUF_FORMAT) == PyBUF_FORMAT ? (char *)"d" : NULL;
  view->ndim = (flags & PyBUF_ND) == PyBUF_ND ? array->dimensions : 1;
  view->shape = (flags & PyBUF_ND) == PyBUF_ND ? array->shape : NULL;
  view->strides = (flags & PyBUF_STRIDES) == PyBUF_STRIDES ? array->strides : NULL;
  view->suboffsets = NULL;
  view->internal = NULL;
  view->obj = Py_NewRef(self);
  return 0;
}

static PyType_Slot array_slots[] = {{Py_tp_dealloc, (void *)delete_array},
                                    {Py_bf_getbuffer, (void *)get_buffer},
                                    {Py_tp_doc, (void *)"Doubles by the buffer protocol."},
                                    {0, NULL}};
PyType_Spec strut_py_array_spec = {
    .name = "strut._strut.Array",
    .basicsize = sizeof(array_object),
    .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION | Py_TPFLAGS_IMMUTABLETYPE,
    .slots = array_slots};

/* A result: made empty by Python, filled by a scene's call. */

/* Its handle, or NULL with an exception where no call has filled it. */
static strutlib_result *handle(PyObject *self) {
  strutlib_result *result = ((strut_py_result *)self)->result;
  if (result == NULL) {
    PyErr_SetString(PyExc_ValueError, "there is no result");
  }
  return result;
}

static int is_filled(PyObject *self) { return ((strut_py_result *)self)->result != NULL; }

static void delete_result(PyObject *self) {
  strutlib_result_free(((strut_py_result *)self)->result);
  strut_py_delete(self);
}

static PyObject *text_of(PyObject *self, const char *(*text)(const strutlib_result *)) {
  const strutlib_result *result = handle(self);
  return result == NULL ? NULL : strut_py_text(text(result));
}

static PyObject *command(PyObject *self, PyObject *none) {
  (void)none;
  return text_of(self, strutlib_result_command);
}

static PyObject *json(PyObject *self, PyObject *none) {
  (void)none;
  return text_of(self, strutlib_result_json);
}

static PyObject *table(PyObject *self, PyObject *none) {
  (void)none;
  return text_of(self, strutlib_result_table);
}

static PyObject *status(PyObject *self, PyObject *none) {
  (void)none;
  const strutlib_result *result = handle(self);
  return result == NULL ? NULL
                        : strut_py_text(strutlib_status_name(strutlib_result_status(result)));
}

/* Everything that item(result, i) returns before NULL. */
static PyObject *list_of(PyObject *self, const char *(*item)(const strutlib_result *, size_t)) {
  const strutlib_result *result = handle(self);
  PyObject *list = result == NULL ? NULL : PyList_New(0);
  const char *text;
  for (size_t i = 0; list != NULL && (text = item(result, i)) != NULL; i++) {
    PyObject *name = strut_py_text(text);
    if (name == NULL || PyList_Append(list, name) != 0) {
      Py_CLEAR(list);
    }
    Py_XDECREF(name);
  }
  return list;
}

static PyObject *warnings(PyObject *self, PyObject *none) {
  (void)none;
  return list_of(self, strutlib_result_warning);
}

static PyObject *array_names(PyObject *self, PyObject *none) {
  (void)none;
  return list_of(self, strutlib_result_array_name);
}

static PyObject *columns(PyObject *self, PyObject *none) {
  (void)none;
  return list_of(self, strutlib_result_column);
}

static PyObject *array(PyObject *self, PyObject *argument) {
  const strutlib_result *result = handle(self);
  const char *name = result == NULL ? NULL : PyUnicode_AsUTF8AndSize(argument, NULL);
  const double *data = NULL;
  int dimensions = 0;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS];
  if (name == NULL) {
    return NULL;
  }
  if (!strutlib_result_array(result, name, &data, &dimensions, shape, stride)) {
    Py_RETURN_NONE;
  }
  return strut_py_array(((strut_py_result *)self)->module, self, data, dimensions, shape, stride,
                        0);
}

static PyObject *unit(PyObject *self, PyObject *argument) {
  const strutlib_result *result = handle(self);
  const char *name = result == NULL ? NULL : PyUnicode_AsUTF8AndSize(argument, NULL);
  return name == NULL ? NULL : strut_py_text(strutlib_result_array_unit(result, name));
}

/* The words of a sweep's column, one per point. */
static PyObject *words(PyObject *self, PyObject *arguments) {
  const char *column;
  Py_ssize_t count;
  const strutlib_result *result = handle(self);
  if (result == NULL || !PyArg_ParseTuple(arguments, "sn:words", &column, &count)) {
    return NULL;
  }
  PyObject *list = PyList_New(0);
  for (Py_ssize_t i = 0; i < count && list != NULL; i++) {
    PyObject *word = strut_py_text(strutlib_result_cell(result, column, (size_t)i));
    if (word == NULL || PyList_Append(list, word) != 0) {
      Py_CLEAR(list);
    }
    Py_XDECREF(word);
  }
  return list;
}

static PyObject *yaml(PyObject *self, PyObject *none) {
  (void)none;
  const strutlib_result *result = handle(self);
  strutlib_error *error = NULL;
  return result == NULL ? NULL : strut_py_own_text(strutlib_result_yaml(result, &error), error);
}

static PyObject *svg(PyObject *self, PyObject *arguments) {
  PyObject *names, *values;
  strut_py_texts options[2];
  const strutlib_result *result = handle(self);
  if (result == NULL || !PyArg_ParseTuple(arguments, "OO:svg", &names, &values) ||
      strut_py_pairs_read(names, values, options) != 0) {
    return NULL;
  }
  strutlib_error *error = NULL;
  char *text = NULL;
  Py_BEGIN_ALLOW_THREADS /**/
      text =
          strutlib_result_svg(result, options[0].count, options[0].text, options[1].text, &error);
  Py_END_ALLOW_THREADS /**/
      strut_py_texts_free(&options[0]);
  strut_py_texts_free(&options[1]);
  return strut_py_own_text(text, error);
}

static PyObject *html(PyObject *self, PyObject *none) {
  (void)none;
  const strutlib_result *result = handle(self);
  if (result == NULL) {
    return NULL;
  }
  strutlib_error *error = NULL;
  char *text = NULL;
  Py_BEGIN_ALLOW_THREADS /**/
      text = strutlib_result_html(result, &error);
  Py_END_ALLOW_THREADS /**/
      return strut_py_own_text(text, error);
}

static PyMethodDef methods[] = {
    {"command", command, METH_NOARGS, "What made it: run, equilibria, ..."},
    {"status", status, METH_NOARGS, "A word: ok, diverged, interrupted, ..."},
    {"json", json, METH_NOARGS, "The program's --json."},
    {"table", table, METH_NOARGS, "The table that the program prints."},
    {"warnings", warnings, METH_NOARGS, "What the program would warn of."},
    {"array", array, METH_O, "array(name): an Array, or None."},
    {"array_names", array_names, METH_NOARGS, "Arrays that are not in the JSON."},
    {"columns", columns, METH_NOARGS, "Columns of a sweep."},
    {"unit", unit, METH_O, "unit(name): unit of an array, or None."},
    {"words", words, METH_VARARGS, "words(column, count): texts of a sweep's column, or None."},
    {"yaml", yaml, METH_NOARGS, "The scene as it was run, or the model that a form is."},
    {"svg", svg, METH_VARARGS, "svg(names, values): the figure."},
    {"html", html, METH_NOARGS, "The page."},
    {NULL, NULL, 0, NULL}};

static PyType_Slot slots[] = {{Py_tp_dealloc, (void *)delete_result},
                              {Py_nb_bool, (void *)is_filled},
                              {Py_tp_methods, methods},
                              {Py_tp_doc, (void *)"A strutlib_result."},
                              {0, NULL}};
PyType_Spec strut_py_result_spec = {
    .name = "strut._strut.Result",
    .basicsize = sizeof(strut_py_result),
    .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION | Py_TPFLAGS_IMMUTABLETYPE,
    .slots = slots};

/*
 * A simulation. What a controller calls thousands of times a second is short here: a few steps are made at once,
 * with the interpreter's lock; many are divided into pieces of some milliseconds, without it, between
 * which signals are looked for. The bits do not depend on that division.
 */

#define SHORT 20e-6 /* s: a piece this short keeps the interpreter's lock */
#define PIECE 5e-3  /* s: signals are looked for as often */

typedef struct {
  PyObject_HEAD PyObject *module;
  strutlib_simulation *simulation;
  strutlib_control *control;
  double step_time; /* s of one step, as last measured */
  int busy;         /* a thread is advancing it, without the interpreter's lock */
} simulation_object;

typedef struct {
  PyObject_HEAD PyObject *module;
  PyObject *simulation; /* kept, so that no other one takes its place in memory */
  strutlib_snapshot *snapshot;
} snapshot_object;

PyObject *strut_py_simulation(PyObject *module, strutlib_simulation *simulation,
                              strutlib_control *control) {
  simulation_object *object = strut_py_new(strut_py_types_of(module)->simulation, module);
  if (object == NULL) {
    strutlib_simulation_close(simulation);
    strutlib_control_free(control);
    return NULL;
  }
  object->simulation = simulation;
  object->control = control;
  object->step_time = PIECE; /* nothing is known: one step at first */
  return (PyObject *)object;
}

static void delete_simulation(PyObject *self) {
  simulation_object *s = (simulation_object *)self;
  strutlib_simulation_close(s->simulation);
  strutlib_control_free(s->control);
  strut_py_delete(self);
}

/* The simulation unless another thread advances it: NULL with an exception. */
static simulation_object *idle(PyObject *self) {
  simulation_object *s = (simulation_object *)self;
  if (s->busy) {
    PyErr_SetString(PyExc_RuntimeError,
                    "another thread is advancing this simulation; one simulation per thread");
    return NULL;
  }
  return s;
}

static double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Steps until signals are looked for again. */
static long piece_of(const simulation_object *s, long steps) {
  double most = PIECE / s->step_time;
  return most >= (double)steps ? steps : most > 1 ? (long)most : 1;
}

/* Makes the steps, timed: the library's status. */
static int advance_piece(simulation_object *s, long steps, strutlib_error **error) {
  double begin = seconds();
  int status = strutlib_simulation_advance(s->simulation, steps, error);
  double each = (seconds() - begin) / (double)steps;
  /* A step that met the scheduler shall not make all later pieces small: at most ten times as fast again. */
  s->step_time = each > 0.1 * s->step_time ? each : 0.1 * s->step_time;
  return status;
}

static PyObject *advance(PyObject *self, PyObject *argument) {
  long left = PyLong_AsLong(argument);
  if (left < 0) {
    if (!PyErr_Occurred()) {
      PyErr_SetString(PyExc_ValueError, "the number of steps is negative");
    }
    return NULL;
  }
  simulation_object *s = idle(self);
  if (s == NULL) {
    return NULL;
  }
  strutlib_error *error = NULL;
  int status = STRUTLIB_OK;
  if ((double)left * s->step_time < SHORT && left > 0) {
    status = advance_piece(s, left, &error);
    left = 0;
  }
  while (left > 0 && status == STRUTLIB_OK) {
    long piece = piece_of(s, left);
    s->busy = 1;
    Py_BEGIN_ALLOW_THREADS /**/
        status = advance_piece(s, piece, &error);
    Py_END_ALLOW_THREADS /**/
        s->busy = 0;
    left -= piece;
    if (PyErr_CheckSignals() != 0) {
      strutlib_error_free(error);
      return NULL;
    }
  }
  if (status != STRUTLIB_OK) {
    return strut_py_raise(error);
  }
  Py_RETURN_NONE;
}

static PyObject *time_of(PyObject *self, void *none) {
  (void)none;
  simulation_object *s = idle(self);
  return s == NULL ? NULL : PyFloat_FromDouble(strutlib_simulation_time(s->simulation));
}

static PyObject *step_of(PyObject *self, void *none) {
  (void)none;
  simulation_object *s = idle(self);
  return s == NULL ? NULL : PyFloat_FromDouble(strutlib_simulation_step(s->simulation));
}

static PyObject *input_work(PyObject *self, void *none) {
  (void)none;
  simulation_object *s = idle(self);
  return s == NULL ? NULL : PyFloat_FromDouble(strutlib_simulation_input_work(s->simulation));
}

static PyObject *live_array(PyObject *self, PyObject *argument) {
  simulation_object *s = idle(self);
  const char *name = s == NULL ? NULL : PyUnicode_AsUTF8AndSize(argument, NULL);
  const double *data = NULL;
  int dimensions = 0;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS];
  if (name == NULL) {
    return NULL;
  }
  if (!strutlib_simulation_array(s->simulation, name, &data, &dimensions, shape, stride)) {
    Py_RETURN_NONE;
  }
  return strut_py_array(s->module, self, data, dimensions, shape, stride, 0);
}

static PyObject *input(PyObject *self, PyObject *argument) {
  simulation_object *s = idle(self);
  const char *name = s == NULL ? NULL : PyUnicode_AsUTF8AndSize(argument, NULL);
  double *data = NULL;
  int dimensions = 0;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS];
  if (name == NULL) {
    return NULL;
  }
  if (!strutlib_simulation_input(s->simulation, name, &data, &dimensions, shape, stride)) {
    Py_RETURN_NONE;
  }
  return strut_py_array(s->module, self, data, dimensions, shape, stride, 1);
}

static PyObject *snapshot(PyObject *self, PyObject *none) {
  (void)none;
  simulation_object *s = idle(self);
  if (s == NULL) {
    return NULL;
  }
  strutlib_error *error = NULL;
  strutlib_snapshot *stored = strutlib_simulation_snapshot(s->simulation, &error);
  if (stored == NULL) {
    return strut_py_raise(error);
  }
  snapshot_object *object = strut_py_new(strut_py_types_of(s->module)->snapshot, s->module);
  if (object == NULL) {
    strutlib_snapshot_free(stored);
    return NULL;
  }
  object->simulation = Py_NewRef(self);
  object->snapshot = stored;
  return (PyObject *)object;
}

static PyObject *restore(PyObject *self, PyObject *argument) {
  simulation_object *s = idle(self);
  if (s == NULL) {
    return NULL;
  }
  if (Py_TYPE(argument) != strut_py_types_of(s->module)->snapshot) {
    PyErr_SetString(PyExc_TypeError, "restore takes what snapshot() returned");
    return NULL;
  }
  strutlib_error *error = NULL;
  const snapshot_object *stored = (snapshot_object *)argument;
  if (strutlib_simulation_restore(s->simulation, stored->snapshot, &error) != STRUTLIB_OK) {
    return strut_py_raise(error);
  }
  Py_RETURN_NONE;
}

static void delete_snapshot(PyObject *self) {
  strutlib_snapshot_free(((snapshot_object *)self)->snapshot);
  Py_XDECREF(((snapshot_object *)self)->simulation);
  strut_py_delete(self);
}

static PyMethodDef simulation_methods[] = {
    {"advance", advance, METH_O, "advance(steps): makes steps; arrays follow."},
    {"array", live_array, METH_O, "array(name): a live Array, or None."},
    {"input", input, METH_O, "input(name): a writable Array, or None."},
    {"snapshot", snapshot, METH_NOARGS, "snapshot(): all of the state, for restore."},
    {"restore", restore, METH_O, "restore(snapshot): back to where that was taken."},
    {NULL, NULL, 0, NULL}};

static PyGetSetDef values[] = {
    {"time", time_of, NULL, "Time reached [s].", NULL},
    {"step", step_of, NULL, "The step [s].", NULL},
    {"input_work", input_work, NULL, "Work that changes of inputs have done [J].", NULL},
    {NULL, NULL, NULL, NULL, NULL}};

static PyType_Slot simulation_slots[] = {{Py_tp_dealloc, (void *)delete_simulation},
                                         {Py_tp_methods, simulation_methods},
                                         {Py_tp_getset, values},
                                         {Py_tp_doc, (void *)"A strutlib_simulation."},
                                         {0, NULL}};
PyType_Spec strut_py_simulation_spec = {
    .name = "strut._strut.Simulation",
    .basicsize = sizeof(simulation_object),
    .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION | Py_TPFLAGS_IMMUTABLETYPE,
    .slots = simulation_slots};

static PyType_Slot snapshot_slots[] = {{Py_tp_dealloc, (void *)delete_snapshot},
                                       {Py_tp_doc, (void *)"A strutlib_snapshot."},
                                       {0, NULL}};
PyType_Spec strut_py_snapshot_spec = {
    .name = "strut._strut.Snapshot",
    .basicsize = sizeof(snapshot_object),
    .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION | Py_TPFLAGS_IMMUTABLETYPE,
    .slots = snapshot_slots};
