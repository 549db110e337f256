/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The module: long calls, texts, and functions of the package as a whole. */
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "parser/bindings/python/module.h"

/*
 * Long calls. Python runs the handlers of signals between two of its own instructions only, and only in the
 * thread that began the program. A call therefore computes in a thread of its own, and the thread that made it
 * looks for signals: Ctrl-C ends everything within a moment, also what reports no progress.
 */

#define LOOK_EVERY 50000000L /* ns */

typedef struct {
  void (*compute)(void *context);
  void *context;
  pthread_mutex_t mutex;
  pthread_cond_t changed;
  int done;
  double fraction;
} call;

static void *compute(void *argument) {
  call *c = argument;
  c->compute(c->context);
  pthread_mutex_lock(&c->mutex);
  c->done = 1;
  pthread_cond_signal(&c->changed);
  pthread_mutex_unlock(&c->mutex);
  return NULL;
}

static int note_progress(void *context, double fraction) {
  call *c = context;
  pthread_mutex_lock(&c->mutex);
  c->fraction = fraction;
  pthread_mutex_unlock(&c->mutex);
  return 0;
}

/* Starts the thread, which receives no signals: 0, or what pthread_create returns. */
static int start(call *c, pthread_t *thread) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  int refused = pthread_create(thread, NULL, compute, c);
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  return refused;
}

/* Waits until the call is done, or a moment: 1 if it is done. */
static int is_done(call *c, int patient) {
  struct timespec until;
  clock_gettime(CLOCK_MONOTONIC, &until);
  until.tv_nsec += LOOK_EVERY;
  if (until.tv_nsec >= 1000000000L) {
    until.tv_nsec -= 1000000000L;
    until.tv_sec++;
  }
  int late = 0;
  pthread_mutex_lock(&c->mutex);
  while (!c->done && !late) {
    late = patient ? pthread_cond_wait(&c->changed, &c->mutex)
                   : pthread_cond_timedwait(&c->changed, &c->mutex, &until);
  }
  int done = c->done;
  pthread_mutex_unlock(&c->mutex);
  return done;
}

/* Handlers of signals and progress(fraction), with the interpreter's lock: 0, or -1 if one raises. */
static int look(call *c, PyObject *progress) {
  if (PyErr_CheckSignals() != 0) {
    return -1;
  }
  if (progress == Py_None) {
    return 0;
  }
  pthread_mutex_lock(&c->mutex);
  double fraction = c->fraction;
  pthread_mutex_unlock(&c->mutex);
  PyObject *answer = PyObject_CallFunction(progress, "d", fraction);
  Py_XDECREF(answer);
  return answer == NULL ? -1 : 0;
}

int strut_py_wait(void (*function)(void *), void *context, strutlib_control *control,
                  PyObject *progress) {
  call c = {.compute = function, .context = context};
  pthread_condattr_t attributes;
  pthread_condattr_init(&attributes);
  pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
  pthread_mutex_init(&c.mutex, NULL);
  pthread_cond_init(&c.changed, &attributes);
  pthread_condattr_destroy(&attributes);
  if (control != NULL && progress != Py_None) {
    strutlib_control_on_progress(control, note_progress, &c);
  }
  int raised = 0;
  pthread_t thread;
  PyThreadState *unlocked = PyEval_SaveThread();
  if (start(&c, &thread) != 0) { /* no threads left: then without Ctrl-C */
    compute(&c);
  } else {
    while (!is_done(&c, raised)) {
      PyEval_RestoreThread(unlocked);
      raised = look(&c, progress) != 0;
      if (raised && control != NULL) {
        strutlib_interrupt(control);
      }
      unlocked = PyEval_SaveThread();
    }
    pthread_join(thread, NULL);
  }
  PyEval_RestoreThread(unlocked);
  if (control != NULL) {
    strutlib_control_on_progress(control, NULL, NULL);
  }
  pthread_cond_destroy(&c.changed);
  pthread_mutex_destroy(&c.mutex);
  return raised ? -1 : 0;
}

strut_py_types *strut_py_types_of(PyObject *module) { return PyModule_GetState(module); }

void *strut_py_new(PyTypeObject *type, PyObject *module) {
  PyObject *object = PyType_GenericAlloc(type, 0);
  if (object != NULL) {
    ((strut_py_result *)object)->module = Py_NewRef(module);
  }
  return object;
}

void strut_py_delete(PyObject *object) {
  PyTypeObject *type = Py_TYPE(object);
  Py_XDECREF(((strut_py_result *)object)->module);
  freefunc release = (freefunc)PyType_GetSlot(type, Py_tp_free);
  release(object);
  Py_DECREF(type);
}

/* ---- texts ---- */

PyObject *strut_py_text(const char *text) {
  if (text == NULL) {
    Py_RETURN_NONE;
  }
  return PyUnicode_DecodeUTF8(text, (Py_ssize_t)strlen(text), "surrogateescape");
}

PyObject *strut_py_own_text(char *text, strutlib_error *error) {
  if (text == NULL) {
    return strut_py_raise(error);
  }
  PyObject *copy = strut_py_text(text);
  strutlib_release(text);
  return copy;
}

/* One text of a tuple into *text: 0 or -1. */
static int read_text(PyObject *item, const char **text) {
  if (item == Py_None) {
    *text = NULL;
    return 0;
  }
  Py_ssize_t length = 0;
  *text = PyUnicode_AsUTF8AndSize(item, &length);
  if (*text == NULL) {
    return -1;
  }
  if (strlen(*text) != (size_t)length) {
    PyErr_SetString(PyExc_ValueError, "a text holds the character NUL");
    return -1;
  }
  return 0;
}

int strut_py_texts_read(PyObject *tuple, strut_py_texts *texts) {
  *texts = (strut_py_texts){0};
  if (!PyTuple_Check(tuple)) {
    PyErr_SetString(PyExc_TypeError, "a tuple of texts is needed");
    return -1;
  }
  Py_ssize_t count = PyTuple_Size(tuple);
  texts->text = malloc(((size_t)count + 1) * sizeof *texts->text);
  if (texts->text == NULL) {
    PyErr_NoMemory();
    return -1;
  }
  for (Py_ssize_t i = 0; i < count; i++) {
    if (read_text(PyTuple_GetItem(tuple, i), &texts->text[i]) != 0) {
      strut_py_texts_free(texts);
      return -1;
    }
  }
  texts->count = (size_t)count;
  return 0;
}

void strut_py_texts_free(strut_py_texts *texts) {
  free(texts->text);
  *texts = (strut_py_texts){0};
}

int strut_py_pairs_read(PyObject *names, PyObject *values, strut_py_texts pair[2]) {
  if (strut_py_texts_read(names, &pair[0]) != 0) {
    return -1;
  }
  if (strut_py_texts_read(values, &pair[1]) != 0) {
    strut_py_texts_free(&pair[0]);
    return -1;
  }
  if (pair[0].count != pair[1].count) {
    strut_py_texts_free(&pair[0]);
    strut_py_texts_free(&pair[1]);
    PyErr_SetString(PyExc_ValueError, "as many values as names are needed");
    return -1;
  }
  return 0;
}

/* ---- errors ---- */

/* (file, line, column, length, text, source, hint, key) of each located message. */
static PyObject *located_messages(const strutlib_error *error) {
  size_t count = strutlib_error_count(error);
  PyObject *list = PyList_New(0);
  for (size_t i = 0; i < count && list != NULL; i++) {
    PyObject *message = Py_BuildValue(
        "(NnnnNNNN)", strut_py_text(strutlib_error_file(error, i)),
        (Py_ssize_t)strutlib_error_line(error, i), (Py_ssize_t)strutlib_error_column(error, i),
        (Py_ssize_t)strutlib_error_length(error, i), strut_py_text(strutlib_error_text(error, i)),
        strut_py_text(strutlib_error_source(error, i)),
        strut_py_text(strutlib_error_hint(error, i)), strut_py_text(strutlib_error_key(error, i)));
    if (message == NULL || PyList_Append(list, message) != 0) {
      Py_CLEAR(list);
    }
    Py_XDECREF(message);
  }
  return list;
}

/* The exception that strut._errors.make makes of an error. */
static PyObject *exception_of(const strutlib_error *error) {
  PyObject *module = PyImport_ImportModule("strut._errors");
  if (module == NULL) {
    return NULL;
  }
  int status = strutlib_error_status(error);
  PyObject *messages = located_messages(error);
  PyObject *exception = NULL;
  if (messages != NULL) {
    exception = PyObject_CallMethod(module, "make", "sNNO", strutlib_status_name(status),
                                    strut_py_text(strutlib_error_message(error)),
                                    strut_py_text(strutlib_error_report(error)), messages);
  }
  Py_XDECREF(messages);
  Py_DECREF(module);
  return exception;
}

PyObject *strut_py_raise(strutlib_error *error) {
  if (error == NULL) { /* the library could not even say why */
    return PyErr_NoMemory();
  }
  PyObject *exception = exception_of(error);
  strutlib_error_free(error);
  if (exception != NULL) {
    PyErr_SetObject((PyObject *)Py_TYPE(exception), exception);
    Py_DECREF(exception);
  }
  return NULL;
}

/* ---- functions ---- */

static PyObject *scene_of(PyObject *module, strutlib_scene *scene, strutlib_error *error) {
  if (scene == NULL) {
    return strut_py_raise(error);
  }
  strut_py_scene *object = strut_py_new(strut_py_types_of(module)->scene, module);
  if (object == NULL) {
    strutlib_close(scene);
    return NULL;
  }
  object->scene = scene;
  return (PyObject *)object;
}

static PyObject *open_file(PyObject *module, PyObject *arguments) {
  PyObject *path = NULL, *names, *values;
  strut_py_texts pair[2];
  if (!PyArg_ParseTuple(arguments, "O&OO:open", PyUnicode_FSConverter, &path, &names, &values)) {
    return NULL;
  }
  if (strut_py_pairs_read(names, values, pair) != 0) {
    Py_DECREF(path);
    return NULL;
  }
  strutlib_error *error = NULL;
  strutlib_scene *scene = NULL;
  const char *name = PyBytes_AsString(path);
  Py_BEGIN_ALLOW_THREADS /**/
      scene = strutlib_open(name, pair[0].count, pair[0].text, pair[1].text, &error);
  Py_END_ALLOW_THREADS /**/
      strut_py_texts_free(&pair[0]);
  strut_py_texts_free(&pair[1]);
  Py_DECREF(path);
  return scene_of(module, scene, error);
}

static PyObject *open_text(PyObject *module, PyObject *arguments) {
  const char *name, *text;
  Py_ssize_t length;
  PyObject *names, *values;
  strut_py_texts pair[2];
  if (!PyArg_ParseTuple(arguments, "ss#OO:open_text", &name, &text, &length, &names, &values) ||
      strut_py_pairs_read(names, values, pair) != 0) {
    return NULL;
  }
  strutlib_error *error = NULL;
  strutlib_scene *scene = NULL;
  Py_BEGIN_ALLOW_THREADS /**/
      scene = strutlib_open_text(name, text, (size_t)length, pair[0].count, pair[0].text,
                                 pair[1].text, &error);
  Py_END_ALLOW_THREADS /**/
      strut_py_texts_free(&pair[0]);
  strut_py_texts_free(&pair[1]);
  return scene_of(module, scene, error);
}

static PyObject *scene_with(PyObject *module, PyObject *arguments) {
  PyObject *from, *names, *values;
  strut_py_texts pair[2];
  if (!PyArg_ParseTuple(arguments, "O!OO:with_", strut_py_types_of(module)->scene, &from, &names,
                        &values) ||
      strut_py_pairs_read(names, values, pair) != 0) {
    return NULL;
  }
  strutlib_error *error = NULL;
  strutlib_scene *scene = NULL;
  Py_BEGIN_ALLOW_THREADS /**/
      scene = strutlib_scene_with(((strut_py_scene *)from)->scene, pair[0].count, pair[0].text,
                                  pair[1].text, &error);
  Py_END_ALLOW_THREADS /**/
      strut_py_texts_free(&pair[0]);
  strut_py_texts_free(&pair[1]);
  return scene_of(module, scene, error);
}

static PyObject *options(PyObject *module, PyObject *argument) {
  (void)module;
  const char *command = NULL;
  if (read_text(argument, &command) != 0) {
    return NULL;
  }
  if (command == NULL) {
    PyErr_SetString(PyExc_TypeError, "the name of a command is needed, such as 'run', not None");
    return NULL;
  }
  PyObject *list = PyList_New(0);
  const char *name;
  for (size_t i = 0; list != NULL && (name = strutlib_option_name(command, i)) != NULL; i++) {
    PyObject *option =
        Py_BuildValue("(NN)", strut_py_text(name), strut_py_text(strutlib_option_help(command, i)));
    if (option == NULL || PyList_Append(list, option) != 0) {
      Py_CLEAR(list);
    }
    Py_XDECREF(option);
  }
  return list;
}

/* A tuple of texts: those of a function of a channel and an index, up to the first NULL. */
static PyObject *texts_of(const char *(*text)(const char *channel, size_t i), const char *channel) {
  Py_ssize_t count = 0;
  while (text(channel, (size_t)count) != NULL) {
    count++;
  }
  PyObject *tuple = PyTuple_New(count);
  for (Py_ssize_t i = 0; tuple != NULL && i < count; i++) {
    PyObject *item = strut_py_text(text(channel, (size_t)i));
    if (item == NULL || PyTuple_SetItem(tuple, i, item) != 0) {
      Py_CLEAR(tuple);
    }
  }
  return tuple;
}

static PyObject *channels(PyObject *module, PyObject *none) {
  (void)module, (void)none;
  PyObject *list = PyList_New(0);
  const char *name;
  for (size_t i = 0; list != NULL && (name = strutlib_channel(i)) != NULL; i++) {
    PyObject *channel = Py_BuildValue(
        "(NNNN)", strut_py_text(name), strut_py_text(strutlib_channel_kind(name)),
        texts_of(strutlib_channel_component, name), texts_of(strutlib_channel_column, name));
    if (channel == NULL || PyList_Append(list, channel) != 0) {
      Py_CLEAR(list);
    }
    Py_XDECREF(channel);
  }
  return list;
}

static PyObject *yaml_places(PyObject *module, PyObject *arguments) {
  const char *name, *text;
  strutlib_error *error = NULL;
  (void)module;
  if (!PyArg_ParseTuple(arguments, "ss:yaml_places", &name, &text)) {
    return NULL;
  }
  char *places = strutlib_yaml_places(name, text, &error);
  return strut_py_own_text(places, error);
}

static PyObject *status_name(PyObject *module, PyObject *argument) {
  (void)module;
  int status = (int)PyLong_AsLong(argument);
  return status == -1 && PyErr_Occurred() ? NULL : strut_py_text(strutlib_status_name(status));
}

static PyObject *status_text(PyObject *module, PyObject *argument) {
  (void)module;
  int status = (int)PyLong_AsLong(argument);
  return status == -1 && PyErr_Occurred() ? NULL : strut_py_text(strutlib_status_text(status));
}

static PyObject *new_result(PyObject *module, PyObject *none) {
  (void)none;
  return strut_py_new(strut_py_types_of(module)->result, module);
}

static PyMethodDef functions[] = {
    {"result", new_result, METH_NOARGS, "result(): an empty Result, for a scene's call."},
    {"open", open_file, METH_VARARGS, "open(path, names, values): a scene's file."},
    {"open_text", open_text, METH_VARARGS, "open_text(name, text, names, values): a scene's text."},
    {"with_", scene_with, METH_VARARGS, "with_(scene, names, values): further settings."},
    {"options", options, METH_O, "options(command): its options and what they mean."},
    {"channels", channels, METH_NOARGS, "channels(): (name, kind, components, columns) of each."},
    {"yaml_places", yaml_places, METH_VARARGS, "yaml_places(name, text): a YAML text as JSON."},
    {"status_name", status_name, METH_O, "status_name(number): a status as a word."},
    {"status_text", status_text, METH_O, "status_text(number): a status as a few words."},
    {NULL, NULL, 0, NULL}};

/* ---- the module ---- */

static int add_type(PyObject *module, PyType_Spec *spec, PyTypeObject **type) {
  *type = (PyTypeObject *)PyType_FromModuleAndSpec(module, spec, NULL);
  return *type == NULL ? -1 : PyModule_AddType(module, *type);
}

static int execute(PyObject *module) {
  strut_py_types *types = strut_py_types_of(module);
  if (add_type(module, &strut_py_scene_spec, &types->scene) != 0 ||
      add_type(module, &strut_py_result_spec, &types->result) != 0 ||
      add_type(module, &strut_py_simulation_spec, &types->simulation) != 0 ||
      add_type(module, &strut_py_snapshot_spec, &types->snapshot) != 0 ||
      add_type(module, &strut_py_array_spec, &types->array) != 0) {
    return -1;
  }
  if (strutlib_abi_version() < STRUTLIB_ABI_VERSION) {
    PyErr_Format(PyExc_ImportError, "libstrut.so.0 is older than this module: interface %d, not %d",
                 strutlib_abi_version(), STRUTLIB_ABI_VERSION);
    return -1;
  }
  PyObject *version = strut_py_text(strutlib_version());
  int added = version == NULL ? -1 : PyModule_AddObjectRef(module, "version", version);
  Py_XDECREF(version);
  return added;
}

static int traverse(PyObject *module, visitproc visit, void *arg) {
  strut_py_types *types = strut_py_types_of(module);
  Py_VISIT(types->scene);
  Py_VISIT(types->result);
  Py_VISIT(types->simulation);
  Py_VISIT(types->snapshot);
  Py_VISIT(types->array);
  return 0;
}

static int clear(PyObject *module) {
  strut_py_types *types = strut_py_types_of(module);
  Py_CLEAR(types->scene);
  Py_CLEAR(types->result);
  Py_CLEAR(types->simulation);
  Py_CLEAR(types->snapshot);
  Py_CLEAR(types->array);
  return 0;
}

static PyModuleDef_Slot slots[] = {{Py_mod_exec, (void *)execute}, {0, NULL}};

static PyModuleDef definition = {.m_base = PyModuleDef_HEAD_INIT,
                                 .m_name = "strut._strut",
                                 .m_doc = "Handles of libstrut.so.0; use the package strut.",
                                 .m_size = sizeof(strut_py_types),
                                 .m_methods = functions,
                                 .m_slots = slots,
                                 .m_traverse = traverse,
                                 .m_clear = clear};

PyMODINIT_FUNC PyInit__strut(void);
PyMODINIT_FUNC PyInit__strut(void) { return PyModuleDef_Init(&definition); }
