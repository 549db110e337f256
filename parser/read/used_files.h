/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Files that a scene names: its `base`, and those that its parts `use`.
 *
 * They are read once, right after the scene's own text, and laid into its tree: the root becomes the base
 * with the scene's keys laid over it, and the value of a part that uses a file the structure of that file
 * with the part's keys laid over it, and isolated. `base` and `use` are gone then, so that what is made of
 * the tree later (scenes of a study, its identity, texts) needs no files. Places in them have the file's
 * number.
 */
#ifndef STRUT_PARSER_READ_USED_FILES_H
#define STRUT_PARSER_READ_USED_FILES_H

#include "parser/yaml/document.h"

/** Most levels of files that use files. */
enum { STRUT_DEEPEST_FILE = 16 };

/**
 * Reads all files that the document's tree names, directly or not. diagnostics, whose `file` is the path of
 * the document, own their texts. STRUT_BAD_SCENE: some file or name in it was reported; the root is NULL
 * where the base is missing, and parts whose file is missing keep their `use`.
 */
STRUT_API strut_status strut_read_used_files(strut_document *document,
                                             strut_diagnostics *diagnostics);

#endif
