/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Made by tests/bench/rivals_table.py from docs/rivals/rivals.txt: class, error, least and largest
   quotient, scenes, those on which no other solver keeps the error. */
#ifndef STRUT_ENGINE_STUDY_TRADEOFF_RIVALS_TABLE_H
#define STRUT_ENGINE_STUDY_TRADEOFF_RIVALS_TABLE_H
/* clang-format off */
#define STRUT_RIVALS(X) \
  X(CONTACT, 2e-02, 2.53, 12.8, 8, 0) \
  X(CONTACT, 1e-03, 2.53, 7.91, 8, 4) \
  X(CONTACT, 1e-04, 1.63, 2.24, 8, 6) \
  X(CONTACT, 1e-06, 3.14, 102, 8, 6) \
  X(CONTACT, 1e-08, 5.22, 5.22, 6, 5) \
  X(CONTACT, 1e-10, 4.03, 4.03, 2, 1) \
  X(SMOOTH, 2e-02, 1.31, 3.42, 5, 0) \
  X(SMOOTH, 1e-03, 1.26, 5, 5, 0) \
  X(SMOOTH, 1e-04, 1.05, 3.42, 5, 0) \
  X(SMOOTH, 1e-06, 1.36, 4.58, 4, 0) \
  X(SMOOTH, 1e-08, 0.776, 3.03, 4, 0) \
  X(SMOOTH, 1e-10, 0.873, 4.02, 4, 1) \
  X(STIFF, 2e-02, 42.7, 175, 2, 0) \
  X(STIFF, 1e-03, 33.3, 139, 2, 0) \
  X(STIFF, 1e-04, 19.1, 103, 2, 0) \
  X(STIFF, 1e-06, 2.22, 272, 2, 0) \
  X(STIFF, 1e-08, 2, 81.8, 2, 0) \
  X(STIFF, 1e-10, 1.84, 2.44, 2, 0)
#endif
