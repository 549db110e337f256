/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An array of doubles by the buffer protocol: numpy.asarray and memoryview see it without a copy. */
#include "parser/python/module.h"

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

static PyType_Slot slots[] = {{Py_tp_dealloc, (void *)delete_array},
                              {Py_bf_getbuffer, (void *)get_buffer},
                              {Py_tp_doc, (void *)"Doubles by the buffer protocol."},
                              {0, NULL}};
PyType_Spec strut_py_array_spec = {
    .name = "strut._strut.Array",
    .basicsize = sizeof(array_object),
    .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION | Py_TPFLAGS_IMMUTABLETYPE,
    .slots = slots};
