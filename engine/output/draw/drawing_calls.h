/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Cairo's, Pango's and GLib's functions under their own names, called through the table; for canvas.c, which
 * loads it when a canvas is opened. A name that is missing here is missing in drawing_library.h, too.
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_DRAWING_CALLS_H
#define STRUT_ENGINE_OUTPUT_DRAW_DRAWING_CALLS_H

#include "engine/output/draw/drawing_library.h"

/** NULL before strut_drawing_load. */
extern const void *strut_drawing_loaded;
#define strut_drawing ((const strut_drawing_library *)strut_drawing_loaded)

/** Makes the libraries ready, once; fails where they are not installed, or memory is out. */
strut_status strut_drawing_load(strut_error *error);

/* GLib has macros of some of these names. */
#undef g_free
#undef g_object_unref
#undef g_utf8_make_valid
#undef g_utf8_validate

#define cairo_append_path (strut_drawing->cairo_append_path)
#define cairo_arc (strut_drawing->cairo_arc)
#define cairo_clip (strut_drawing->cairo_clip)
#define cairo_clip_extents (strut_drawing->cairo_clip_extents)
#define cairo_clip_preserve (strut_drawing->cairo_clip_preserve)
#define cairo_close_path (strut_drawing->cairo_close_path)
#define cairo_copy_path (strut_drawing->cairo_copy_path)
#define cairo_create (strut_drawing->cairo_create)
#define cairo_destroy (strut_drawing->cairo_destroy)
#define cairo_fill (strut_drawing->cairo_fill)
#define cairo_fill_preserve (strut_drawing->cairo_fill_preserve)
#define cairo_font_options_create (strut_drawing->cairo_font_options_create)
#define cairo_font_options_destroy (strut_drawing->cairo_font_options_destroy)
#define cairo_font_options_set_antialias (strut_drawing->cairo_font_options_set_antialias)
#define cairo_font_options_set_hint_metrics (strut_drawing->cairo_font_options_set_hint_metrics)
#define cairo_font_options_set_hint_style (strut_drawing->cairo_font_options_set_hint_style)
#define cairo_get_target (strut_drawing->cairo_get_target)
#define cairo_image_surface_create (strut_drawing->cairo_image_surface_create)
#define cairo_image_surface_get_data (strut_drawing->cairo_image_surface_get_data)
#define cairo_image_surface_get_stride (strut_drawing->cairo_image_surface_get_stride)
#define cairo_line_to (strut_drawing->cairo_line_to)
#define cairo_move_to (strut_drawing->cairo_move_to)
#define cairo_new_path (strut_drawing->cairo_new_path)
#define cairo_paint (strut_drawing->cairo_paint)
#define cairo_path_destroy (strut_drawing->cairo_path_destroy)
#define cairo_pdf_surface_create_for_stream (strut_drawing->cairo_pdf_surface_create_for_stream)
#define cairo_pdf_surface_set_metadata (strut_drawing->cairo_pdf_surface_set_metadata)
#define cairo_rectangle (strut_drawing->cairo_rectangle)
#define cairo_restore (strut_drawing->cairo_restore)
#define cairo_rotate (strut_drawing->cairo_rotate)
#define cairo_save (strut_drawing->cairo_save)
#define cairo_scale (strut_drawing->cairo_scale)
#define cairo_set_dash (strut_drawing->cairo_set_dash)
#define cairo_set_line_cap (strut_drawing->cairo_set_line_cap)
#define cairo_set_line_join (strut_drawing->cairo_set_line_join)
#define cairo_set_line_width (strut_drawing->cairo_set_line_width)
#define cairo_set_source_rgb (strut_drawing->cairo_set_source_rgb)
#define cairo_set_source_rgba (strut_drawing->cairo_set_source_rgba)
#define cairo_status (strut_drawing->cairo_status)
#define cairo_status_to_string (strut_drawing->cairo_status_to_string)
#define cairo_stroke (strut_drawing->cairo_stroke)
#define cairo_stroke_preserve (strut_drawing->cairo_stroke_preserve)
#define cairo_surface_destroy (strut_drawing->cairo_surface_destroy)
#define cairo_surface_finish (strut_drawing->cairo_surface_finish)
#define cairo_surface_flush (strut_drawing->cairo_surface_flush)
#define cairo_surface_status (strut_drawing->cairo_surface_status)
#define cairo_surface_write_to_png_stream (strut_drawing->cairo_surface_write_to_png_stream)
#define cairo_svg_surface_create_for_stream (strut_drawing->cairo_svg_surface_create_for_stream)
#define cairo_translate (strut_drawing->cairo_translate)
#define g_free (strut_drawing->g_free)
#define g_object_unref (strut_drawing->g_object_unref)
#define g_utf8_make_valid (strut_drawing->g_utf8_make_valid)
#define g_utf8_validate (strut_drawing->g_utf8_validate)
#define pango_cairo_context_set_font_options (strut_drawing->pango_cairo_context_set_font_options)
#define pango_cairo_context_set_resolution (strut_drawing->pango_cairo_context_set_resolution)
#define pango_cairo_create_layout (strut_drawing->pango_cairo_create_layout)
#define pango_cairo_layout_path (strut_drawing->pango_cairo_layout_path)
#define pango_cairo_show_layout (strut_drawing->pango_cairo_show_layout)
#define pango_context_set_round_glyph_positions                                                    \
  (strut_drawing->pango_context_set_round_glyph_positions)
#define pango_font_description_free (strut_drawing->pango_font_description_free)
#define pango_font_description_new (strut_drawing->pango_font_description_new)
#define pango_font_description_set_absolute_size                                                   \
  (strut_drawing->pango_font_description_set_absolute_size)
#define pango_font_description_set_family_static                                                   \
  (strut_drawing->pango_font_description_set_family_static)
#define pango_font_description_set_style (strut_drawing->pango_font_description_set_style)
#define pango_font_description_set_weight (strut_drawing->pango_font_description_set_weight)
#define pango_layout_context_changed (strut_drawing->pango_layout_context_changed)
#define pango_layout_get_context (strut_drawing->pango_layout_get_context)
#define pango_layout_get_extents (strut_drawing->pango_layout_get_extents)
#define pango_layout_set_alignment (strut_drawing->pango_layout_set_alignment)
#define pango_layout_set_font_description (strut_drawing->pango_layout_set_font_description)
#define pango_layout_set_text (strut_drawing->pango_layout_set_text)
#define pango_layout_set_width (strut_drawing->pango_layout_set_width)
#define pango_layout_set_wrap (strut_drawing->pango_layout_set_wrap)

#endif
