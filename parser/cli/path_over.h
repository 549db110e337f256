/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What `strut path --over NAME` follows: a parameter of the model's file, an actuator, or the
 * coordinate of a node; and the scenes that the file means where its parameter has a value.
 */
#ifndef STRUT_PARSER_CLI_PATH_OVER_H
#define STRUT_PARSER_CLI_PATH_OVER_H

#include "engine/statics/path/path.h"
#include "parser/cli/options.h"

/** The model's file, read once. Zero-initialise; strut_path_over_free releases it. */
typedef struct strut_path_over_source {
  const char *file;
  char *text;
  size_t length;
  strut_scene_source *source;
  strut_setting *settings; /* (setting_count) those of --set, and last the one that is followed */
  size_t setting_count;
} strut_path_over_source;

/**
 * Fills in what is followed, and from where to where: from --over, --load, --from and --until. The
 * file's text in `source` is read anew for each value of a parameter. Fails with the reason on stderr.
 */
strut_status strut_path_over_read(const strut_command *command, const strut_arguments *arguments,
                                  const strut_scene *scene, strut_path_over_source *source,
                                  strut_path_options *wanted);
void strut_path_over_free(strut_path_over_source *source);

#endif
