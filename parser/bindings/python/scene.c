/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scene: what is in it, and what is computed of it. */
#include <stdlib.h>
#include <string.h>

#include "parser/bindings/python/module.h"

static strutlib_scene *handle(PyObject *self) { return ((strut_py_scene *)self)->scene; }

static void delete_scene(PyObject *self) {
  strutlib_close(handle(self));
  strut_py_delete(self);
}

/* ---- what is in it ---- */

static PyObject *names(PyObject *self, PyObject *argument) {
  const char *kind = PyUnicode_AsUTF8AndSize(argument, NULL);
  if (kind == NULL) {
    return NULL;
  }
  size_t count = strutlib_name_count(handle(self), kind);
  PyObject *tuple = PyTuple_New((Py_ssize_t)count);
  for (size_t i = 0; i < count && tuple != NULL; i++) {
    PyObject *name = strut_py_text(strutlib_name(handle(self), kind, i));
    if (name == NULL || PyTuple_SetItem(tuple, (Py_ssize_t)i, name) != 0) {
      Py_CLEAR(tuple);
    }
  }
  return tuple;
}

/* A number, a flag or a text by its dotted name, or None. */
static PyObject *value(PyObject *self, PyObject *argument) {
  const char *name = PyUnicode_AsUTF8AndSize(argument, NULL);
  if (name == NULL) {
    return NULL;
  }
  double number = 0;
  int flag = 0;
  if (strutlib_scene_number(handle(self), name, &number)) {
    return PyFloat_FromDouble(number);
  }
  if (strutlib_scene_flag(handle(self), name, &flag)) {
    return PyBool_FromLong(flag);
  }
  return strut_py_text(strutlib_scene_text(handle(self), name));
}

static PyObject *array(PyObject *self, PyObject *argument) {
  const char *name = PyUnicode_AsUTF8AndSize(argument, NULL);
  const double *data = NULL;
  int dimensions = 0;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS];
  if (name == NULL) {
    return NULL;
  }
  if (!strutlib_scene_array(handle(self), name, &data, &dimensions, shape, stride)) {
    Py_RETURN_NONE;
  }
  return strut_py_array(((strut_py_scene *)self)->module, self, data, dimensions, shape, stride, 0);
}

static PyObject *warnings(PyObject *self, PyObject *none) {
  (void)none;
  PyObject *list = PyList_New(0);
  const char *text;
  for (size_t i = 0; list != NULL && (text = strutlib_scene_warning(handle(self), i)); i++) {
    PyObject *warning = strut_py_text(text);
    if (warning == NULL || PyList_Append(list, warning) != 0) {
      Py_CLEAR(list);
    }
    Py_XDECREF(warning);
  }
  return list;
}

static PyObject *yaml(PyObject *self, PyObject *parts) {
  int with_parts = PyObject_IsTrue(parts);
  strutlib_error *error = NULL;
  return with_parts < 0
             ? NULL
             : strut_py_own_text(strutlib_scene_yaml(handle(self), with_parts, &error), error);
}

static PyObject *json(PyObject *self, PyObject *none) {
  (void)none;
  strutlib_error *error = NULL;
  return strut_py_own_text(strutlib_scene_json(handle(self), &error), error);
}

static PyObject *svg(PyObject *self, PyObject *none) {
  (void)none;
  strutlib_error *error = NULL;
  char *text = NULL;
  Py_BEGIN_ALLOW_THREADS /**/
      text = strutlib_scene_svg(handle(self), &error);
  Py_END_ALLOW_THREADS /**/
      return strut_py_own_text(text, error);
}

typedef struct {
  const strutlib_scene *scene;
  int equilibria;
  strutlib_control *control;
  strutlib_error *error;
  char *text;
} page;

static void write_page(void *context) {
  page *p = context;
  p->text = strutlib_scene_html(p->scene, p->equilibria, p->control, &p->error);
}

static PyObject *html(PyObject *self, PyObject *arguments) {
  page p = {.scene = handle(self)};
  if (!PyArg_ParseTuple(arguments, "p:html", &p.equilibria)) {
    return NULL;
  }
  p.control = strutlib_control_create();
  if (p.control == NULL) {
    return PyErr_NoMemory();
  }
  int raised = strut_py_wait(write_page, &p, p.control, Py_None);
  strutlib_control_free(p.control);
  if (raised) {
    strutlib_release(p.text);
    strutlib_error_free(p.error);
    return NULL;
  }
  return strut_py_own_text(p.text, p.error);
}

/* ---- what is computed of it ---- */

typedef strutlib_result *command(const strutlib_scene *, size_t, const char *const *,
                                 const char *const *, strutlib_control *, strutlib_error **);

#define COMMAND(NAME) {#NAME, strutlib_##NAME},
static const struct {
  const char *name;
  command *function;
} commands[] = {STRUTLIB_CALLS(COMMAND){NULL, NULL}};

/* One call of the library, with all that it needs and returns. */
typedef struct {
  const strutlib_scene *scene;
  command *function; /* NULL: a sweep */
  strut_py_texts options[2];
  strut_py_texts axes, keep, words; /* of a sweep */
  const double *points;
  size_t point_count;
  strutlib_control *control;
  strutlib_result *result;
  strutlib_simulation *simulation;
  strutlib_error *error;
} request;

static void compute(void *context) {
  request *r = context;
  r->result = r->function(r->scene, r->options[0].count, r->options[0].text, r->options[1].text,
                          r->control, &r->error);
}

static void sweep_points(void *context) {
  request *r = context;
  r->result =
      strutlib_sweep(r->scene, r->axes.count, r->axes.text, r->point_count, r->points,
                     r->words.text, r->keep.count, r->keep.text, r->options[0].count,
                     r->options[0].text, r->options[1].text, NULL, NULL, r->control, &r->error);
}

static void open_simulation(void *context) {
  request *r = context;
  r->simulation = strutlib_simulation_open(r->scene, r->options[0].count, r->options[0].text,
                                           r->options[1].text, r->control, &r->error);
}

static void release_request(request *r) {
  strut_py_texts_free(&r->options[0]);
  strut_py_texts_free(&r->options[1]);
  strut_py_texts_free(&r->axes);
  strut_py_texts_free(&r->keep);
  strut_py_texts_free(&r->words);
  strutlib_control_free(r->control);
}

/*
 * Makes the call and puts what it returns into `result`, also where it failed or was interrupted; then
 * raises. Takes the request's memory.
 */
static PyObject *fill(request *r, void (*function)(void *), PyObject *result, PyObject *progress) {
  r->control = strutlib_control_create();
  if (r->control == NULL) {
    release_request(r);
    return PyErr_NoMemory();
  }
  int raised = strut_py_wait(function, r, r->control, progress);
  release_request(r);
  strutlib_result_free(((strut_py_result *)result)->result);
  ((strut_py_result *)result)->result = r->result;
  if (raised) {
    strutlib_error_free(r->error);
    return NULL;
  }
  if (r->error != NULL || r->result == NULL) {
    return strut_py_raise(r->error);
  }
  Py_RETURN_NONE;
}

static PyObject *call(PyObject *self, PyObject *arguments) {
  strut_py_types *types = strut_py_types_of(((strut_py_scene *)self)->module);
  PyObject *result, *option_names, *option_values, *progress;
  const char *name;
  request r = {.scene = handle(self)};
  if (!PyArg_ParseTuple(arguments, "O!sOOO:call", types->result, &result, &name, &option_names,
                        &option_values, &progress)) {
    return NULL;
  }
  for (size_t i = 0; commands[i].name != NULL; i++) {
    if (strcmp(commands[i].name, name) == 0) {
      r.function = commands[i].function;
    }
  }
  if (r.function == NULL) {
    return PyErr_Format(PyExc_ValueError, "no such command: %s", name);
  }
  if (strut_py_pairs_read(option_names, option_values, r.options) != 0) {
    return NULL;
  }
  return fill(&r, compute, result, progress);
}

/* The texts of a sweep: 0 or -1. */
static int read_sweep(request *r, PyObject *axes, PyObject *words, PyObject *keep,
                      PyObject *option_names, PyObject *option_values) {
  if (strut_py_texts_read(axes, &r->axes) != 0 || strut_py_texts_read(keep, &r->keep) != 0 ||
      (words != Py_None && strut_py_texts_read(words, &r->words) != 0)) {
    return -1;
  }
  if (words != Py_None && r->words.count != r->point_count * r->axes.count) {
    PyErr_SetString(PyExc_ValueError, "a word or None is needed for each point and axis");
    return -1;
  }
  return strut_py_pairs_read(option_names, option_values, r->options);
}

static PyObject *sweep(PyObject *self, PyObject *arguments) {
  strut_py_types *types = strut_py_types_of(((strut_py_scene *)self)->module);
  PyObject *result, *axes, *points, *words, *keep, *option_names, *option_values, *progress;
  Py_ssize_t count;
  Py_buffer buffer;
  request r = {.scene = handle(self)};
  if (!PyArg_ParseTuple(arguments, "O!OnOOOOOO:sweep", types->result, &result, &axes, &count,
                        &points, &words, &keep, &option_names, &option_values, &progress) ||
      PyObject_GetBuffer(points, &buffer, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) != 0) {
    return NULL;
  }
  PyObject *answer = NULL;
  Py_ssize_t axis_count = PyTuple_Check(axes) ? PyTuple_Size(axes) : -1;
  if (axis_count < 0) {
    PyErr_SetString(PyExc_TypeError, "a tuple of names is needed");
  } else if (buffer.format == NULL || strcmp(buffer.format, "d") != 0 || count < 0 ||
             buffer.len / (Py_ssize_t)sizeof(double) != count * axis_count) {
    PyErr_SetString(PyExc_ValueError, "a double is needed for each point and axis");
  } else {
    r.points = buffer.buf;
    r.point_count = (size_t)count;
    if (read_sweep(&r, axes, words, keep, option_names, option_values) != 0) {
      release_request(&r);
    } else {
      answer = fill(&r, sweep_points, result, progress);
    }
  }
  PyBuffer_Release(&buffer);
  return answer;
}

static PyObject *simulation(PyObject *self, PyObject *arguments) {
  PyObject *option_names, *option_values;
  request r = {.scene = handle(self)};
  if (!PyArg_ParseTuple(arguments, "OO:simulation", &option_names, &option_values) ||
      strut_py_pairs_read(option_names, option_values, r.options) != 0) {
    return NULL;
  }
  strutlib_control *control = strutlib_control_create();
  if (control == NULL) {
    release_request(&r);
    return PyErr_NoMemory();
  }
  r.control = control;
  int raised = strut_py_wait(open_simulation, &r, control, Py_None);
  r.control = NULL; /* the simulation keeps it */
  release_request(&r);
  if (raised || r.simulation == NULL) {
    strutlib_simulation_close(r.simulation);
    strutlib_control_free(control);
    if (raised) {
      strutlib_error_free(r.error);
      return NULL;
    }
    return strut_py_raise(r.error);
  }
  strutlib_error_free(r.error);
  return strut_py_simulation(((strut_py_scene *)self)->module, r.simulation, control);
}

static PyMethodDef methods[] = {
    {"names", names, METH_O, "names(kind): the names of a kind of things, in order."},
    {"value", value, METH_O, "value(name): a number, flag or text by dotted name, or None."},
    {"array", array, METH_O, "array(name): an Array, or None."},
    {"warnings", warnings, METH_NOARGS, "What is valid but implausible."},
    {"yaml", yaml, METH_O, "yaml(parts): the scene, resolved or with its parameters and parts."},
    {"json", json, METH_NOARGS, "The resolved scene."},
    {"svg", svg, METH_NOARGS, "The drawn structure."},
    {"html", html, METH_VARARGS, "html(equilibria): the page of a model."},
    {"call", call, METH_VARARGS, "call(result, command, names, values, progress)"},
    {"sweep", sweep, METH_VARARGS,
     "sweep(result, axes, count, points, words, keep, names, values, progress)"},
    {"simulation", simulation, METH_VARARGS, "simulation(names, values)"},
    {NULL, NULL, 0, NULL}};

static PyType_Slot slots[] = {{Py_tp_dealloc, (void *)delete_scene},
                              {Py_tp_methods, methods},
                              {Py_tp_doc, (void *)"A strutlib_scene."},
                              {0, NULL}};
PyType_Spec strut_py_scene_spec = {
    .name = "strut._strut.Scene",
    .basicsize = sizeof(strut_py_scene),
    .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION | Py_TPFLAGS_IMMUTABLETYPE,
    .slots = slots};
