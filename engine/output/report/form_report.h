/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What a found form holds, as a table and as JSON.
 */
#ifndef STRUT_ENGINE_OUTPUT_REPORT_FORM_REPORT_H
#define STRUT_ENGINE_OUTPUT_REPORT_FORM_REPORT_H

#include "engine/statics/form/form.h"

/** Texts in blocks of strut_allocate; NULL: memory was out. The scene is the one found. */
STRUT_API char *strut_form_json(const strut_form *form, const strut_scene *scene);
STRUT_API char *strut_form_table(const strut_form *form, const strut_setup *setup);

#endif
