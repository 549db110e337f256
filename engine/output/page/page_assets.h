/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The parts of the page that are the same for every run, put in at build time (EmbedFiles.cmake). Apart from
 * page.h, which is installed.
 */
#ifndef STRUT_ENGINE_OUTPUT_PAGE_PAGE_ASSETS_H
#define STRUT_ENGINE_OUTPUT_PAGE_PAGE_ASSETS_H

#include "engine/output/buffer.h"

/*
 * Each ends with a row of NULL. In the template, page.html, four comments are replaced:
 * strut:title by the title's text, strut:style by <style> elements, strut:data by the <script> element of
 * the data, strut:scripts by <script> elements.
 */
extern const strut_embedded strut_page_template[];
extern const strut_embedded strut_page_styles[];
extern const strut_embedded strut_page_notice[];  /* of dygraphs: whose it is, and its licence */
extern const strut_embedded strut_page_scripts[]; /* in the order in which they run */

#endif
