/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Made by tests/bench/rivals_table.py from docs/rivals/rivals.txt: class, error, least and largest
   quotient, scenes, those on which no other solver keeps the error. */
#ifndef STRUT_ENGINE_STUDY_TRADEOFF_RIVALS_TABLE_H
#define STRUT_ENGINE_STUDY_TRADEOFF_RIVALS_TABLE_H
/* clang-format off */
#define STRUT_RIVALS(X) \
  X(CONTACT, 2e-02, 2.44, 20.8, 8, 0) \
  X(CONTACT, 1e-03, 2.44, 8.24, 8, 4) \
  X(CONTACT, 1e-04, 1.58, 2.16, 8, 6) \
  X(CONTACT, 1e-06, 3.28, 36.8, 8, 6) \
  X(CONTACT, 1e-08, 4.94, 4.94, 6, 5) \
  X(CONTACT, 1e-10, 4.77, 4.77, 2, 1) \
  X(SMOOTH, 2e-02, 1.05, 3.3, 5, 0) \
  X(SMOOTH, 1e-03, 1.04, 4.84, 5, 0) \
  X(SMOOTH, 1e-04, 1, 3.14, 5, 0) \
  X(SMOOTH, 1e-06, 1.36, 3.19, 4, 0) \
  X(SMOOTH, 1e-08, 0.633, 3.79, 4, 0) \
  X(SMOOTH, 1e-10, 0.646, 4.12, 4, 1) \
  X(STIFF, 2e-02, 42.6, 146, 2, 0) \
  X(STIFF, 1e-03, 33.4, 113, 2, 0) \
  X(STIFF, 1e-04, 19.2, 77, 2, 0) \
  X(STIFF, 1e-06, 2.29, 232, 2, 0) \
  X(STIFF, 1e-08, 2.13, 78.6, 2, 0) \
  X(STIFF, 1e-10, 1.9, 2.59, 2, 0)
#endif
