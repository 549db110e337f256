/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/scratch.h"

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/test.h"

static char directory[64];
static pid_t owner; /* the process that made it; a child that exits leaves it */

static void scratch_remove(void) {
  char command[128];
  snprintf(command, sizeof command, "rm -rf '%s'", directory);
  if (getpid() == owner && system(command) != 0) abort();
}

const char *scratch_make(void) {
  if (!directory[0]) atexit(scratch_remove);
  scratch_remove();
  strcpy(directory, "/tmp/strut-test-XXXXXX");
  owner = getpid();
  if (!mkdtemp(directory)) abort();
  return directory;
}

const char *scratch_path(const char *name) {
  static char paths[4][512];
  static int next;
  char *path = paths[next++ % 4];
  snprintf(path, sizeof paths[0], "%s/%s", directory, name);
  return path;
}

int scratch_count(const char *path) {
  DIR *open = opendir(path);
  if (!open) return -1;
  int count = -2; /* . and .. */
  for (struct dirent *entry = readdir(open); entry; entry = readdir(open))
    if (strcmp(entry->d_name, ".strut-files") != 0) count++; /* the list of what strut wrote */
  closedir(open);
  return count;
}

bool scratch_exists(const char *path) { return access(path, F_OK) == 0; }

char *scratch_read(const char *path, size_t *length) {
  struct stat found;
  FILE *stream = fopen(path, "rb");
  if (!stream) return NULL;
  if (fstat(fileno(stream), &found) != 0) abort();
  char *text = calloc((size_t)found.st_size + 1, 1);
  *length = fread(text, 1, (size_t)found.st_size, stream);
  fclose(stream);
  return text;
}

void scratch_expect(const char *path, const char *bytes, size_t length) {
  size_t there = 0;
  FREED char *now = scratch_read(path, &there);
  assert_int_equal(there, length);
  assert_memory_equal(now, bytes, length);
}

bool scratch_mount_small_disk(const char *path, int kilobytes) {
  char command[700];
  if (geteuid() != 0) return false;
  snprintf(command, sizeof command, "mount -t tmpfs -o size=%dk none '%s' 2>/dev/null", kilobytes,
           path);
  return system(command) == 0;
}

void scratch_unmount(const char *path) {
  char command[700];
  snprintf(command, sizeof command, "umount '%s'", path);
  if (system(command) != 0) abort();
}
