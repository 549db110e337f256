/* SPDX-License-Identifier: GPL-3.0-or-later */
/** For tests of the writers: a directory of their own, a full disk, and looking at files. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/** Makes an empty directory and returns its path; it goes with all in it at the next call or the end. */
const char *scratch_make(void);
/** Path of a name in the directory; the last four results stay good. */
const char *scratch_path(const char *name);
/** Files and directories in `directory`, hidden ones too; -1 where there is no such directory. */
int scratch_count(const char *directory);
bool scratch_exists(const char *path);
/** A file's bytes with a NUL behind them, to be freed with free; NULL where it cannot be read. */
char *scratch_read(const char *path, size_t *length);
/** Fails the test unless the file has just these bytes. */
void scratch_expect(const char *path, const char *bytes, size_t length);
/** Puts a file system of `kilobytes` onto a directory; false where that is not allowed. */
bool scratch_mount_small_disk(const char *directory, int kilobytes);
void scratch_unmount(const char *directory);
