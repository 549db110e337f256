/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The MEX file: it loads strut_body.so, which lies beside it, and passes every call on.
 *
 * Octave and MATLAB have loaded a BLAS of their own, whose functions would take the place of those that
 * strut's libraries were linked with, and change the last bits of some results. RTLD_DEEPBIND lets the
 * body and all that it needs look among themselves first.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

#include "mex.h"

typedef void (*mex_function)(int outputs, mxArray **output, int count, const mxArray **values);

static mex_function load_body(void) {
  Dl_info self;
  char path[4096] = "";
  if (!dladdr((void *)load_body, &self) || !self.dli_fname) return NULL;
  const char *slash = strrchr(self.dli_fname, '/');
  int folder = slash ? (int)(slash - self.dli_fname) + 1 : 0;
  snprintf(path, sizeof path, "%.*sstrut_body.so", folder, self.dli_fname);
  void *body = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND);
  if (!body) mexErrMsgIdAndTxt("strut:file_trouble", "cannot load %s: %s", path, dlerror());
  return (mex_function)dlsym(body, "strut_body");
}

void mexFunction(int outputs, mxArray **output, int count, const mxArray **values) {
  static mex_function body;
  if (!body) body = load_body();
  if (!body) mexErrMsgIdAndTxt("strut:file_trouble", "strut_body.so is not that of strut");
  body(outputs, output, count, values);
}
