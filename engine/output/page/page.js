/* SPDX-License-Identifier: GPL-3.0-or-later */
"use strict";
document.getElementById("name").textContent =
  JSON.parse(document.getElementById("strut-data").textContent).name;
