/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * strut in Octave and MATLAB, on the library's interface, strut/abi.h. strut_mex.c, the MEX file, calls it.
 *
 *   strut_mex(COMMAND, HANDLE, ...)
 *
 * is what the functions beside this file call: strut_load, strut_run and so on. Scenes stay in the library and
 * have a handle, a uint64 number; everything else becomes Octave's own structs and matrices.
 * Numbers are passed as they are, not by a text, so that they have the program's bits.
 */
#include <ctype.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "mex.h"
#include "strut/abi.h"

/* ---- scenes by handle ---- */

/* The scenes that are open; a handle is an index here and, in its upper half, how often the place was used. */
typedef struct place {
  strutlib_scene *scene;
  uint32_t uses;
} place;

static place *places;
static uint32_t place_count;

static void close_all(void) {
  for (uint32_t i = 0; i < place_count; i++) strutlib_close(places[i].scene);
  free(places);
  places = NULL;
  place_count = 0;
}

static uint64_t keep_scene(strutlib_scene *scene) {
  uint32_t i = 0;
  while (i < place_count && places[i].scene) i++;
  if (i == place_count) {
    place *more = realloc(places, (place_count + 16) * sizeof *more);
    if (!more) {
      strutlib_close(scene);
      mexErrMsgIdAndTxt("strut:no_memory", "memory is out");
    }
    memset(more + place_count, 0, 16 * sizeof *more);
    places = more;
    place_count += 16;
  }
  places[i].scene = scene;
  return (uint64_t)++places[i].uses << 32 | i;
}

static place *find_place(const mxArray *handle) {
  uint64_t number = mxIsUint64(handle) && mxGetNumberOfElements(handle) == 1
                        ? *(const uint64_t *)mxGetData(handle)
                        : UINT64_MAX;
  uint32_t i = (uint32_t)number;
  bool open = i < place_count && places[i].scene && places[i].uses == number >> 32;
  return open ? &places[i] : NULL;
}

static strutlib_scene *find_scene(const mxArray *handle) {
  place *p = find_place(handle);
  if (!p) mexErrMsgIdAndTxt("strut:usage", "this is no open scene; open one by strut_load");
  return p->scene;
}

/* ---- errors and interrupts ---- */

/* Raises strut:STATUS with the whole report, as the program shows it; does not return. */
static void raise_error(strutlib_error *error) {
  if (!error) mexErrMsgIdAndTxt("strut:no_memory", "memory is out");
  char identifier[80];
  snprintf(identifier, sizeof identifier, "strut:%s",
           strutlib_status_name(strutlib_error_status(error)));
  const char *report = strutlib_error_report(error);
  size_t length = strlen(report);
  char *text = mxMalloc(length + 1); /* released by the interpreter */
  memcpy(text, report, length + 1);
  while (length && text[length - 1] == '\n') text[--length] = '\0';
  strutlib_error_free(error);
  mexErrMsgIdAndTxt(identifier, "%s", text);
}

static strutlib_control *control;

static void interrupt(int number) {
  (void)number;
  strutlib_interrupt(control);
}

/* Ctrl-C during a call ends the call; before and after it is the interpreter's. */
static struct sigaction before_call;

static strutlib_control *begin_call(void) {
  struct sigaction action = {0};
  if (!control) control = strutlib_control_create();
  if (!control) mexErrMsgIdAndTxt("strut:no_memory", "memory is out");
  strutlib_control_reset(control);
  action.sa_handler = interrupt;
  sigaction(SIGINT, &action, &before_call);
  return control;
}

static void end_call(void) { sigaction(SIGINT, &before_call, NULL); }

/* ---- arguments ---- */

typedef struct pairs {
  size_t count;
  const char **names, **values;
} pairs;

static const char *text_of(const mxArray *value, const char *what) {
  char number[40];
  if (mxIsChar(value)) {
    char *text = mxArrayToString(value);
    if (text) return text;
  }
  bool scalar = mxGetNumberOfElements(value) == 1 && !mxIsComplex(value);
  if (scalar && mxIsLogical(value)) return mxIsLogicalScalarTrue(value) ? "yes" : "no";
  if (scalar && mxIsNumeric(value)) {
    snprintf(number, sizeof number, "%.17g", mxGetScalar(value));
    char *text = mxMalloc(strlen(number) + 1);
    return strcpy(text, number);
  }
  mexErrMsgIdAndTxt("strut:usage", "expected a text or a number for '%s'", what);
  return NULL;
}

/* Pairs of a name and a value. */
static pairs read_pairs(int count, const mxArray *const *values) {
  pairs p = {.count = (size_t)count / 2};
  if (count % 2) mexErrMsgIdAndTxt("strut:usage", "expected pairs of a name and a value");
  p.names = mxMalloc((p.count + 1) * sizeof *p.names);
  p.values = mxMalloc((p.count + 1) * sizeof *p.values);
  for (size_t i = 0; i < p.count; i++) {
    if (!mxIsChar(values[2 * i]))
      mexErrMsgIdAndTxt("strut:usage", "expected a name, a text, as argument %d of the pairs",
                        (int)(2 * i + 1));
    p.names[i] = text_of(values[2 * i], "a name");
    p.values[i] = text_of(values[2 * i + 1], p.names[i]);
  }
  return p;
}

/* A list of texts: a cell array. */
static const char **read_texts(const mxArray *cells, size_t *count, const char *what) {
  if (!mxIsCell(cells)) mexErrMsgIdAndTxt("strut:usage", "expected a cell array of %s", what);
  *count = mxGetNumberOfElements(cells);
  const char **texts = mxMalloc((*count + 1) * sizeof *texts);
  for (size_t i = 0; i < *count; i++) {
    const mxArray *item = mxGetCell(cells, (mwIndex)i);
    texts[i] = item && !mxIsEmpty(item) ? text_of(item, what) : NULL;
  }
  return texts;
}

/* ---- results as structs ---- */

/* A field's name for any name: cell.3.top becomes cell_3_top. */
static void field_name(const char *name, char *field, size_t size) {
  size_t used = 0;
  if (!isalpha((unsigned char)name[0]) && used + 1 < size) field[used++] = 'x';
  for (; *name && used + 1 < size; name++)
    field[used++] = isalnum((unsigned char)*name) || *name == '_' ? *name : '_';
  field[used] = '\0';
}

/* Adds a field; where another name has become the same one, with a number behind it. */
static void add_field(mxArray *to, const char *name, mxArray *value) {
  char plain[60], field[80];
  field_name(name, plain, sizeof plain);
  strcpy(field, plain);
  for (int n = 2; mxGetFieldNumber(to, field) >= 0; n++)
    snprintf(field, sizeof field, "%s_%d", plain, n);
  int number = mxAddField(to, field);
  if (number >= 0) mxSetFieldByNumber(to, 0, number, value);
}

static mxArray *new_struct(void) { return mxCreateStructMatrix(1, 1, 0, NULL); }

/* An array of the library as one of Octave: the first index runs fastest there. */
static mxArray *new_array(const double *data, int dimensions, const size_t *shape,
                          const size_t *stride) {
  mwSize size[STRUTLIB_DIMENSIONS] = {1, 1, 1, 1};
  size_t index[STRUTLIB_DIMENSIONS] = {0}, count = 1;
  for (int d = 0; d < dimensions; d++) count *= shape[d], size[d] = (mwSize)shape[d];
  mxArray *array =
      mxCreateNumericArray(dimensions < 2 ? 2 : dimensions, size, mxDOUBLE_CLASS, mxREAL);
  double *to = mxGetPr(array);
  for (size_t n = 0; n < count; n++) {
    size_t at = 0;
    for (int d = 0; d < dimensions; d++) at += index[d] * stride[d];
    to[n] = data[at];
    for (int d = 0; d < dimensions && ++index[d] == shape[d]; d++) index[d] = 0;
  }
  return array;
}

static mxArray *result_array(const strutlib_result *r, const char *name) {
  const double *data;
  int dimensions;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS];
  return strutlib_result_array(r, name, &data, &dimensions, shape, stride)
             ? new_array(data, dimensions, shape, stride)
             : NULL;
}

static const char *join(const char *name, const char *key) {
  size_t size = strlen(name) + strlen(key) + 2;
  char *text = mxMalloc(size);
  snprintf(text, size, "%s%s%s", name, *name ? "." : "", key);
  return text;
}

/* A list of structs is a struct array with the fields of all, [] where one has none; any other a cell array. */
static mxArray *join_items(mxArray **items, size_t count) {
  bool structs = count > 0;
  for (size_t i = 0; i < count; i++) structs = structs && mxIsStruct(items[i]);
  if (!structs) {
    mxArray *cells = mxCreateCellMatrix((mwSize)count, 1);
    for (size_t i = 0; i < count; i++) mxSetCell(cells, (mwIndex)i, items[i]);
    return cells;
  }
  mxArray *all = mxCreateStructMatrix((mwSize)count, 1, 0, NULL);
  for (size_t i = 0; i < count; i++)
    for (int f = 0; f < mxGetNumberOfFields(items[i]); f++) {
      const char *name = mxGetFieldNameByNumber(items[i], f);
      int number = mxGetFieldNumber(all, name);
      if (number < 0) number = mxAddField(all, name);
      mxSetFieldByNumber(all, (mwIndex)i, number,
                         mxDuplicateArray(mxGetFieldByNumber(items[i], 0, f)));
    }
  return all;
}

/* Whatever the JSON of a result has at a dotted name; [] for null. */
static mxArray *json_value(const strutlib_result *r, const char *name) {
  double number;
  int flag;
  const char *text;
  if (*name && strutlib_result_number(r, name, &number)) return mxCreateDoubleScalar(number);
  if (*name && strutlib_result_flag(r, name, &flag)) return mxCreateLogicalScalar(flag != 0);
  if (*name && (text = strutlib_result_text(r, name)) != NULL) return mxCreateString(text);
  const char *key = strutlib_result_key(r, name, 0);
  if (key) {
    mxArray *all = new_struct();
    for (size_t i = 0; (key = strutlib_result_key(r, name, i)) != NULL; i++)
      add_field(all, key, json_value(r, join(name, key)));
    return all;
  }
  size_t count = strutlib_result_count(r, name);
  if (!count) return mxCreateDoubleMatrix(0, 0, mxREAL);
  const char *first = join(name, "0");
  bool structs = strutlib_result_key(r, first, 0) != NULL;
  mxArray *array = structs || strutlib_result_text(r, first) ? NULL : result_array(r, name);
  if (array) return array;
  mxArray **items = mxMalloc(count * sizeof *items);
  for (size_t i = 0; i < count; i++) {
    char index[24];
    snprintf(index, sizeof index, "%zu", i);
    items[i] = json_value(r, join(name, index));
  }
  return join_items(items, count);
}

static mxArray *name_list(const strutlib_scene *scene, const char *kind) {
  size_t count = strutlib_name_count(scene, kind);
  mxArray *cells = mxCreateCellMatrix((mwSize)count, 1);
  for (size_t i = 0; i < count; i++)
    mxSetCell(cells, (mwIndex)i, mxCreateString(strutlib_name(scene, kind, i)));
  return cells;
}

static mxArray *all_names(const strutlib_scene *scene) {
  mxArray *names = new_struct();
  const char *kind;
  for (size_t i = 0; (kind = strutlib_name(scene, "kinds", i)) != NULL; i++)
    if (strutlib_name_count(scene, kind)) add_field(names, kind, name_list(scene, kind));
  return names;
}

static mxArray *warnings_of(const strutlib_result *r) {
  size_t count = 0;
  while (strutlib_result_warning(r, count)) count++;
  mxArray *cells = mxCreateCellMatrix((mwSize)count, 1);
  for (size_t i = 0; i < count; i++)
    mxSetCell(cells, (mwIndex)i, mxCreateString(strutlib_result_warning(r, i)));
  return cells;
}

/* ---- recorded channels ---- */

/* Is it a channel of things, for each of which there is a field? Energies are those of the whole. */
static bool is_of_things(const char *name) {
  const char *kind = strutlib_channel_kind(name);
  return kind && strcmp(kind, "energies") != 0;
}

/* Component c of an array (samples, things[, components]) as a matrix (samples, things). */
static mxArray *plane_of(const strutlib_result *r, const char *name, size_t c) {
  const double *data;
  int dimensions;
  size_t shape[STRUTLIB_DIMENSIONS] = {0}, stride[STRUTLIB_DIMENSIONS] = {0};
  if (!strutlib_result_array(r, name, &data, &dimensions, shape, stride)) return NULL;
  return new_array(data + (dimensions > 2 ? c * stride[2] : 0), dimensions < 2 ? dimensions : 2,
                   shape, stride);
}

/* The struct nodes, members, ... of the result, made when it is needed. */
static mxArray *things_of(mxArray *result, const char *kind) {
  mxArray *things = mxGetField(result, 0, kind);
  if (things) return things;
  add_field(result, kind, new_struct());
  return mxGetField(result, 0, kind);
}

static void add_thing(mxArray *things, const char *name, const char *field, const mxArray *matrix,
                      size_t column) {
  char own[80];
  size_t samples = mxGetM(matrix);
  mxArray *values = mxCreateDoubleMatrix((mwSize)samples, 1, mxREAL);
  if (samples)
    memcpy(mxGetPr(values), mxGetPr(matrix) + column * samples, samples * sizeof(double));
  field_name(name, own, 60);
  if (!mxGetField(things, 0, own)) add_field(things, name, new_struct());
  add_field(mxGetField(things, 0, own), field, values);
}

/* Each thing's columns into its field of nodes, members, ..., and matrices (samples, things) of all. */
static void add_channel(mxArray *result, const strutlib_scene *scene, const strutlib_result *r,
                        const char *name) {
  const char *column, *kind = strutlib_channel_kind(name);
  for (size_t k = 0; (column = strutlib_channel_column(name, k)) != NULL; k++) {
    mxArray *matrix = plane_of(r, name, k), *things = things_of(result, kind);
    if (!matrix) continue;
    size_t count = mxGetN(matrix), known = strutlib_name_count(scene, kind);
    for (size_t i = 0; i < count && i < known; i++)
      add_thing(things, strutlib_name(scene, kind, i), column, matrix, i);
    add_field(result, column, matrix);
  }
}

/* ---- commands ---- */

typedef strutlib_result *(*compute)(const strutlib_scene *scene, size_t count,
                                    const char *const *names, const char *const *values,
                                    strutlib_control *control, strutlib_error **error);

static strutlib_result *call(compute what, const strutlib_scene *scene, int count,
                             const mxArray *const *values) {
  strutlib_error *error = NULL;
  pairs p = read_pairs(count, values);
  strutlib_control *c = begin_call();
  strutlib_result *r = what(scene, p.count, p.names, p.values, c, &error);
  end_call();
  if (r && error) { /* there is something: it is returned, and its status says why it is not all */
    strutlib_error_free(error);
    error = NULL;
  }
  if (!r) raise_error(error);
  return r;
}

static mxArray *summarise(const strutlib_scene *scene, const strutlib_result *r) {
  mxArray *all = new_struct();
  add_field(all, "status", mxCreateString(strutlib_status_name(strutlib_result_status(r))));
  add_field(all, "names", all_names(scene));
  add_field(all, "warnings", warnings_of(r));
  add_field(all, "summary", json_value(r, ""));
  return all;
}

static mxArray *run(const strutlib_scene *scene, int count, const mxArray *const *values) {
  strutlib_result *r = call(strutlib_run, scene, count, values);
  mxArray *all = summarise(scene, r);
  const char *name;
  for (size_t i = 0; (name = strutlib_result_array_name(r, i)) != NULL; i++) {
    if (is_of_things(name)) {
      add_channel(all, scene, r, name);
      continue;
    }
    mxArray *array = strchr(name, '.') ? NULL : result_array(r, name);
    if (array) add_field(all, name, array);
  }
  strutlib_result_free(r);
  return all;
}

/* Results at rest are their JSON. */
static mxArray *at_rest(compute what, const strutlib_scene *scene, int count,
                        const mxArray *const *values) {
  strutlib_result *r = call(what, scene, count, values);
  mxArray *all = json_value(r, "");
  add_field(all, "names", all_names(scene));
  strutlib_result_free(r);
  return all;
}

/* One matrix by its entries, as a sparse one. */
static mxArray *sparse(const strutlib_result *r, const char *name) {
  const double *row, *column, *value, *size;
  int dimensions;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS], s[STRUTLIB_DIMENSIONS] = {0};
  if (!strutlib_result_array(r, join(name, "row"), &row, &dimensions, shape, stride) ||
      !strutlib_result_array(r, join(name, "column"), &column, &dimensions, shape, stride) ||
      !strutlib_result_array(r, join(name, "value"), &value, &dimensions, shape, stride) ||
      !strutlib_result_array(r, join(name, "size"), &size, &dimensions, s, s + 1))
    return NULL;
  size_t entries = shape[0], columns = (size_t)size[1];
  mxArray *matrix =
      mxCreateSparse((mwSize)size[0], (mwSize)columns, (mwSize)(entries ? entries : 1), mxREAL);
  mwIndex *jc = mxGetJc(matrix), *ir = mxGetIr(matrix);
  double *pr = mxGetPr(matrix);
  memset(jc, 0, (columns + 1) * sizeof *jc);
  for (size_t e = 0; e < entries; e++) jc[(size_t)column[e] + 1]++;
  for (size_t c = 0; c < columns; c++) jc[c + 1] += jc[c];
  mwIndex *next = mxMalloc((columns + 1) * sizeof *next);
  memcpy(next, jc, (columns + 1) * sizeof *next);
  for (size_t e = 0; e < entries; e++) { /* insertion keeps the rows of a column in order */
    mwIndex begin = jc[(size_t)column[e]], at = next[(size_t)column[e]]++;
    for (; at > begin && ir[at - 1] > (mwIndex)row[e]; at--)
      ir[at] = ir[at - 1], pr[at] = pr[at - 1];
    ir[at] = (mwIndex)row[e], pr[at] = value[e];
  }
  return matrix;
}

static mxArray *matrices(const strutlib_scene *scene, int count, const mxArray *const *values) {
  static const char *const names[] = {
      "mass",    "connectivity",     "equilibrium", "stiffness_elastic", "stiffness_geometric",
      "damping", "stiffness_contact"};
  strutlib_result *r = call(strutlib_matrices, scene, count, values);
  mxArray *all = new_struct();
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    mxArray *matrix = sparse(r, names[i]);
    if (matrix) add_field(all, names[i], matrix);
  }
  add_field(all, "names", all_names(scene));
  strutlib_result_free(r);
  return all;
}

/* A column of numbers, or of words. */
static mxArray *column_of(const strutlib_result *r, const char *name, size_t points) {
  mxArray *column = result_array(r, name);
  if (column) return column;
  column = mxCreateCellMatrix((mwSize)points, 1);
  for (size_t p = 0; p < points; p++) {
    const char *word = strutlib_result_cell(r, name, p);
    mxSetCell(column, (mwIndex)p, mxCreateString(word ? word : ""));
  }
  return column;
}

static mxArray *table_of(const strutlib_result *r, size_t points) {
  static const char *const last[] = {"status", "message"};
  mxArray *all = new_struct();
  const char *name;
  for (size_t i = 0; (name = strutlib_result_column(r, i)) != NULL; i++)
    add_field(all, name, column_of(r, name, points));
  for (int k = 0; k < 2; k++)
    if (mxGetFieldNumber(all, last[k]) < 0) add_field(all, last[k], column_of(r, last[k], points));
  return all;
}

/*
 * sweep(AXES, POINTS, WORDS, KEEP, pairs): POINTS is (points, axes), WORDS a cell array of the same size or
 * empty.
 */
static mxArray *sweep(const strutlib_scene *scene, int count, const mxArray *const *values) {
  size_t axis_count, word_count = 0, keep_count;
  strutlib_error *error = NULL;
  if (count < 4 || !mxIsDouble(values[1]))
    mexErrMsgIdAndTxt("strut:usage", "expected axes, points, words and what to keep");
  const char **axes = read_texts(values[0], &axis_count, "names of parameters");
  const char **words = read_texts(values[2], &word_count, "words");
  const char **keep = read_texts(values[3], &keep_count, "columns to keep");
  size_t points = mxGetM(values[1]);
  if (mxGetN(values[1]) != axis_count || (word_count && word_count != points * axis_count))
    mexErrMsgIdAndTxt("strut:usage", "%zu parameters, but points of %zu columns", axis_count,
                      (size_t)mxGetN(values[1]));
  const double *by_column = mxGetPr(values[1]);
  double *by_row = mxMalloc((points * axis_count + 1) * sizeof *by_row);
  const char **words_by_row = mxMalloc((points * axis_count + 1) * sizeof *words_by_row);
  for (size_t p = 0; p < points; p++)
    for (size_t a = 0; a < axis_count; a++) {
      by_row[p * axis_count + a] = by_column[a * points + p];
      words_by_row[p * axis_count + a] = word_count ? words[a * points + p] : NULL;
    }
  pairs options = read_pairs(count - 4, values + 4);
  strutlib_control *c = begin_call();
  strutlib_result *r = strutlib_sweep(
      scene, axis_count, axes, points, by_row, word_count ? words_by_row : NULL, keep_count, keep,
      options.count, options.names, options.values, NULL, NULL, c, &error);
  end_call();
  if (!r) raise_error(error);
  strutlib_error_free(error);
  mxArray *all = table_of(r, points);
  strutlib_result_free(r);
  return all;
}

static mxArray *scene_array(const strutlib_scene *scene, const char *name) {
  const double *data;
  int dimensions;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS];
  return strutlib_scene_array(scene, name, &data, &dimensions, shape, stride)
             ? new_array(data, dimensions, shape, stride)
             : NULL;
}

/* What a scene shows of itself. */
static mxArray *describe(const strutlib_scene *scene) {
  static const char *const arrays[][2] = {
      {"nodes.position", "position"},         {"nodes.mass", "mass"},
      {"members.nodes", "members"},           {"members.length", "length"},
      {"members.rest_length", "rest_length"}, {"members.stiffness", "stiffness"},
      {"members.pretension", "pretension"},   {"members.mass", "member_mass"}};
  mxArray *all = new_struct(), *parameters = new_struct();
  for (size_t i = 0; i < strutlib_name_count(scene, "parameters"); i++) {
    const char *name = strutlib_name(scene, "parameters", i);
    double value;
    if (strutlib_scene_number(scene, join("parameters", name), &value))
      add_field(parameters, name, mxCreateDoubleScalar(value));
  }
  add_field(all, "parameters", parameters);
  add_field(all, "names", all_names(scene));
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++) {
    mxArray *array = scene_array(scene, arrays[i][0]);
    if (!array) continue;
    double *index = i == 2 ? mxGetPr(array) : NULL; /* indices count from 1 here */
    for (size_t n = 0; index && n < mxGetNumberOfElements(array); n++) index[n] += 1.0;
    add_field(all, arrays[i][1], array);
  }
  return all;
}

static void load(int outputs, mxArray **output, int count, const mxArray *const *values) {
  strutlib_error *error = NULL;
  if (count < 1 || !mxIsChar(values[0]))
    mexErrMsgIdAndTxt("strut:usage", "expected the name of a model's file");
  const char *path = text_of(values[0], "a file");
  pairs p = read_pairs(count - 1, values + 1);
  strutlib_scene *scene = strutlib_open(path, p.count, p.names, p.values, &error);
  if (!scene) raise_error(error);
  output[0] = mxCreateNumericMatrix(1, 1, mxUINT64_CLASS, mxREAL);
  *(uint64_t *)mxGetData(output[0]) = keep_scene(scene);
  if (outputs > 1) output[1] = describe(scene);
}

#define COMPUTE(NAME) {#NAME, strutlib_##NAME},
static const struct {
  const char *name;
  compute what;
} computes[] = {STRUTLIB_CALLS(COMPUTE)};

static void at_exit(void) {
  close_all();
  strutlib_control_free(control);
  control = NULL;
}

void strut_body(int outputs, mxArray **output, int count, const mxArray **values);

void strut_body(int outputs, mxArray **output, int count, const mxArray **values) {
  mexAtExit(at_exit);
  if (count < 1 || !mxIsChar(values[0]))
    mexErrMsgIdAndTxt("strut:usage", "use strut_load, strut_run and so on; see help strut_load");
  const char *command = text_of(values[0], "a command");
  values++, count--;
  if (strcmp(command, "load") == 0) {
    load(outputs, output, count, values);
    return;
  }
  if (strcmp(command, "version") == 0) {
    output[0] = mxCreateString(strutlib_version());
    return;
  }
  if (count < 1) mexErrMsgIdAndTxt("strut:usage", "expected a scene of strut_load");
  if (strcmp(command, "close") == 0) {
    place *p = find_place(values[0]);
    if (p) strutlib_close(p->scene), p->scene = NULL;
    return;
  }
  const strutlib_scene *scene = find_scene(values[0]);
  values++, count--;
  if (strcmp(command, "run") == 0)
    output[0] = run(scene, count, values);
  else if (strcmp(command, "sweep") == 0)
    output[0] = sweep(scene, count, values);
  else if (strcmp(command, "matrices") == 0)
    output[0] = matrices(scene, count, values);
  else {
    size_t i = 0, all = sizeof computes / sizeof computes[0];
    while (i < all && strcmp(computes[i].name, command) != 0) i++;
    if (i == all) mexErrMsgIdAndTxt("strut:usage", "unknown command '%s'", command);
    output[0] = at_rest(computes[i].what, scene, count, values);
  }
}
