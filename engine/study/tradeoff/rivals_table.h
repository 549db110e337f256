/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Made by tests/bench/rivals_table.py from docs/rivals/rivals.txt: class, error, least and largest
   quotient, scenes, those on which no other solver keeps the error. */
#ifndef STRUT_ENGINE_STUDY_TRADEOFF_RIVALS_TABLE_H
#define STRUT_ENGINE_STUDY_TRADEOFF_RIVALS_TABLE_H
/* clang-format off */
#define STRUT_RIVALS(X) \
  X(CONTACT, 2e-02, 2.84, 13.3, 8, 0) \
  X(CONTACT, 1e-03, 2.84, 7.98, 8, 4) \
  X(CONTACT, 1e-04, 1.31, 2.99, 8, 6) \
  X(CONTACT, 1e-06, 3.83, 53.7, 8, 6) \
  X(CONTACT, 1e-08, 5.68, 5.68, 6, 5) \
  X(CONTACT, 1e-10, 4.34, 4.34, 2, 1) \
  X(SMOOTH, 2e-02, 1.57, 3.48, 5, 0) \
  X(SMOOTH, 1e-03, 1.57, 3.48, 5, 0) \
  X(SMOOTH, 1e-04, 1.38, 3.25, 5, 0) \
  X(SMOOTH, 1e-06, 1.28, 3.26, 4, 0) \
  X(SMOOTH, 1e-08, 0.663, 3.26, 4, 0) \
  X(SMOOTH, 1e-10, 1.23, 3.73, 4, 0) \
  X(STIFF, 2e-02, 29.8, 88, 2, 0) \
  X(STIFF, 1e-03, 19.2, 50.8, 2, 0) \
  X(STIFF, 1e-04, 10.2, 40.4, 2, 0) \
  X(STIFF, 1e-06, 2.36, 144, 2, 0) \
  X(STIFF, 1e-08, 2.59, 41, 2, 0) \
  X(STIFF, 1e-10, 2.1, 2.16, 2, 0)
#endif
