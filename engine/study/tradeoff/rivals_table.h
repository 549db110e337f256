/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Made by tests/bench/rivals_table.py from docs/rivals/rivals.txt: class, error, least and largest
   quotient, scenes, those on which no other solver keeps the error. */
/* clang-format off */
{CONTACT, 2e-02, 2.83, 13.3, 8, 0},
{CONTACT, 1e-03, 2.83, 7.98, 8, 4},
{CONTACT, 1e-04, 1.27, 2.78, 8, 6},
{CONTACT, 1e-06, 2.84, 54.2, 8, 6},
{CONTACT, 1e-08, 2.51, 2.51, 6, 5},
{CONTACT, 1e-10, 1.75, 1.75, 2, 1},
{SMOOTH, 2e-02, 0.517, 2.96, 5, 0},
{SMOOTH, 1e-03, 0.32, 2.93, 5, 0},
{SMOOTH, 1e-04, 0.437, 3.46, 5, 0},
{SMOOTH, 1e-06, 1.21, 2.95, 4, 0},
{SMOOTH, 1e-08, 0.746, 1.34, 4, 0},
{SMOOTH, 1e-10, 0.793, 1.71, 4, 0},
{STIFF, 2e-02, 29.5, 90.6, 2, 0},
{STIFF, 1e-03, 17.9, 49.5, 2, 0},
{STIFF, 1e-04, 9.58, 39.9, 2, 0},
{STIFF, 1e-06, 2.47, 143, 2, 0},
{STIFF, 1e-08, 1.11, 40.8, 2, 0},
{STIFF, 1e-10, 0.564, 0.903, 2, 0},
