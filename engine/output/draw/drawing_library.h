/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The functions of Cairo, Pango and GLib that the canvas calls, as one table, so that a program may load
 * these libraries when it first draws instead of at its start (engine/base/library_tables.h).
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_DRAWING_LIBRARY_H
#define STRUT_ENGINE_OUTPUT_DRAW_DRAWING_LIBRARY_H

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <pango/pangocairo.h>

#include "engine/base/library_tables.h"

#define STRUT_DRAWING_FUNCTIONS(X)                                                                 \
  X(cairo_append_path)                                                                             \
  X(cairo_arc)                                                                                     \
  X(cairo_clip)                                                                                    \
  X(cairo_clip_extents)                                                                            \
  X(cairo_clip_preserve)                                                                           \
  X(cairo_close_path)                                                                              \
  X(cairo_copy_path)                                                                               \
  X(cairo_create)                                                                                  \
  X(cairo_destroy)                                                                                 \
  X(cairo_fill)                                                                                    \
  X(cairo_fill_preserve)                                                                           \
  X(cairo_font_options_create)                                                                     \
  X(cairo_font_options_destroy)                                                                    \
  X(cairo_font_options_set_antialias)                                                              \
  X(cairo_font_options_set_hint_metrics)                                                           \
  X(cairo_font_options_set_hint_style)                                                             \
  X(cairo_get_target)                                                                              \
  X(cairo_image_surface_create)                                                                    \
  X(cairo_image_surface_get_data)                                                                  \
  X(cairo_image_surface_get_stride)                                                                \
  X(cairo_line_to)                                                                                 \
  X(cairo_move_to)                                                                                 \
  X(cairo_new_path)                                                                                \
  X(cairo_paint)                                                                                   \
  X(cairo_path_destroy)                                                                            \
  X(cairo_pdf_surface_create_for_stream)                                                           \
  X(cairo_pdf_surface_set_metadata)                                                                \
  X(cairo_rectangle)                                                                               \
  X(cairo_restore)                                                                                 \
  X(cairo_rotate)                                                                                  \
  X(cairo_save)                                                                                    \
  X(cairo_scale)                                                                                   \
  X(cairo_set_dash)                                                                                \
  X(cairo_set_line_cap)                                                                            \
  X(cairo_set_line_join)                                                                           \
  X(cairo_set_line_width)                                                                          \
  X(cairo_set_source_rgb)                                                                          \
  X(cairo_set_source_rgba)                                                                         \
  X(cairo_status)                                                                                  \
  X(cairo_status_to_string)                                                                        \
  X(cairo_stroke)                                                                                  \
  X(cairo_stroke_preserve)                                                                         \
  X(cairo_surface_destroy)                                                                         \
  X(cairo_surface_finish)                                                                          \
  X(cairo_surface_flush)                                                                           \
  X(cairo_surface_status)                                                                          \
  X(cairo_surface_write_to_png_stream)                                                             \
  X(cairo_svg_surface_create_for_stream)                                                           \
  X(cairo_translate)                                                                               \
  X(g_free)                                                                                        \
  X(g_object_unref)                                                                                \
  X(g_utf8_make_valid)                                                                             \
  X(g_utf8_validate)                                                                               \
  X(pango_cairo_context_set_font_options)                                                          \
  X(pango_cairo_context_set_resolution)                                                            \
  X(pango_cairo_create_layout)                                                                     \
  X(pango_cairo_layout_path)                                                                       \
  X(pango_cairo_show_layout)                                                                       \
  X(pango_context_set_round_glyph_positions)                                                       \
  X(pango_font_description_free)                                                                   \
  X(pango_font_description_new)                                                                    \
  X(pango_font_description_set_absolute_size)                                                      \
  X(pango_font_description_set_family_static)                                                      \
  X(pango_font_description_set_style)                                                              \
  X(pango_font_description_set_weight)                                                             \
  X(pango_layout_context_changed)                                                                  \
  X(pango_layout_get_context)                                                                      \
  X(pango_layout_get_extents)                                                                      \
  X(pango_layout_set_alignment)                                                                    \
  X(pango_layout_set_font_description)                                                             \
  X(pango_layout_set_text)                                                                         \
  X(pango_layout_set_width)                                                                        \
  X(pango_layout_set_wrap)

typedef struct strut_drawing_library {
  strut_library_stamp stamp;
#define FUNCTION(name) __typeof__(name) *name;
  STRUT_DRAWING_FUNCTIONS(FUNCTION)
#undef FUNCTION
} strut_drawing_library;

/** The table of the libraries that this program was linked to, or that a module of it was. */
extern STRUT_API const strut_drawing_library strut_drawing_table;

#endif
