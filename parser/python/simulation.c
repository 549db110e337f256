/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A simulation. What a controller calls thousands of times a second is short here: a few steps are made at once,
 * with the interpreter's lock; many are divided into pieces of some milliseconds, without it, between
 * which signals are looked for. The bits do not depend on that division.
 */
#include <time.h>

#include "parser/python/module.h"

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

static PyObject *array(PyObject *self, PyObject *argument) {
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

static PyMethodDef methods[] = {
    {"advance", advance, METH_O, "advance(steps): makes steps; arrays follow."},
    {"array", array, METH_O, "array(name): a live Array, or None."},
    {"input", input, METH_O, "input(name): a writable Array, or None."},
    {"snapshot", snapshot, METH_NOARGS, "snapshot(): all of the state, for restore."},
    {"restore", restore, METH_O, "restore(snapshot): back to where that was taken."},
    {NULL, NULL, 0, NULL}};

static PyGetSetDef values[] = {
    {"time", time_of, NULL, "Time reached [s].", NULL},
    {"step", step_of, NULL, "The step [s].", NULL},
    {"input_work", input_work, NULL, "Work that changes of inputs have done [J].", NULL},
    {NULL, NULL, NULL, NULL, NULL}};

static PyType_Slot slots[] = {{Py_tp_dealloc, (void *)delete_simulation},
                              {Py_tp_methods, methods},
                              {Py_tp_getset, values},
                              {Py_tp_doc, (void *)"A strutlib_simulation."},
                              {0, NULL}};
PyType_Spec strut_py_simulation_spec = {
    .name = "strut._strut.Simulation",
    .basicsize = sizeof(simulation_object),
    .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION | Py_TPFLAGS_IMMUTABLETYPE,
    .slots = slots};

static PyType_Slot snapshot_slots[] = {{Py_tp_dealloc, (void *)delete_snapshot},
                                       {Py_tp_doc, (void *)"A strutlib_snapshot."},
                                       {0, NULL}};
PyType_Spec strut_py_snapshot_spec = {
    .name = "strut._strut.Snapshot",
    .basicsize = sizeof(snapshot_object),
    .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION | Py_TPFLAGS_IMMUTABLETYPE,
    .slots = snapshot_slots};
