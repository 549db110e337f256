/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Made by tests/bench/rivals_table.py from docs/rivals/rivals.txt: class, error, least and largest
   quotient, scenes, those on which no other solver keeps the error. */
#ifndef STRUT_ENGINE_STUDY_TRADEOFF_RIVALS_TABLE_H
#define STRUT_ENGINE_STUDY_TRADEOFF_RIVALS_TABLE_H
/* clang-format off */
#define STRUT_RIVALS(X) \
  X(CONTACT, 2e-02, 2.33, 11.4, 8, 0) \
  X(CONTACT, 1e-03, 2.33, 8.03, 8, 4) \
  X(CONTACT, 1e-04, 2.23, 2.33, 8, 6) \
  X(CONTACT, 1e-06, 2.34, 62.2, 8, 6) \
  X(CONTACT, 1e-08, 3.87, 3.87, 6, 5) \
  X(CONTACT, 1e-10, 2.89, 2.89, 2, 1) \
  X(SMOOTH, 2e-02, 0.925, 3.18, 5, 0) \
  X(SMOOTH, 1e-03, 0.946, 5.14, 5, 0) \
  X(SMOOTH, 1e-04, 0.963, 3.18, 5, 0) \
  X(SMOOTH, 1e-06, 1.36, 3.18, 4, 0) \
  X(SMOOTH, 1e-08, 0.873, 3.02, 4, 0) \
  X(SMOOTH, 1e-10, 1.37, 4.36, 4, 1) \
  X(STIFF, 2e-02, 42.1, 97.6, 2, 0) \
  X(STIFF, 1e-03, 32.9, 88.9, 2, 0) \
  X(STIFF, 1e-04, 18.9, 82, 2, 0) \
  X(STIFF, 1e-06, 2.26, 254, 2, 0) \
  X(STIFF, 1e-08, 2.26, 115, 2, 0) \
  X(STIFF, 1e-10, 2.1, 2.21, 2, 0)
#endif
