/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A result: made empty by Python, filled by a scene's call. */
#include "parser/python/module.h"

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
