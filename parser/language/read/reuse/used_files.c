/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that a scene names. See used_files.h. */
#define _XOPEN_SOURCE 700 /* realpath belongs to the X/Open part of POSIX */

#include "parser/language/read/reuse/used_files.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/name_map.h"
#include "parser/language/read/reader.h"
#include "parser/language/read/reuse/overlay.h"

/* Values that files which are used several times may repeat, as those of aliases. */
enum { MOST_REPEATED = 1000000 };

/* A file that was read, or is being read. */
typedef struct text_file {
  const char *path;
  uint64_t device, inode;
  bool known; /* device and inode are */
  bool open;  /* what it names is being read */
  bool failed;
  unsigned number, height; /* levels of files that it names */
  strut_tree *text;        /* as it stands there; NULL: it could not be read */
  strut_tree *scene;       /* laid over its base; NULL: not yet */
  strut_tree *whole;       /* and with the files of its parts */
  strut_tree *part;        /* what a part takes of that */
  size_t values, uses;     /* in all of it; how many parts have it */
} text_file;

typedef struct loader {
  strut_document *document;
  strut_diagnostics *diagnostics;
  const char *folder; /* below which all files lie */
  size_t bytes;       /* of all texts */
  size_t repeated;    /* values of files that are used again */
  size_t count;
  text_file
      *files; /* (STRUT_USED_FILES_MOST + 1) by their numbers; the first is the scene itself */
  unsigned depth;
  text_file *stack[STRUT_DEEPEST_FILE + 1]; /* that are open */
  bool failed, out_of_memory;
} loader;

/* ---- one file ---- */

/* "a.yaml -> b.yaml -> " of the files that are open, from `first` on. */
static void format_chain(const loader *self, const text_file *first, char *text, size_t size) {
  size_t used = 0, i = 0;
  while (self->stack[i] != first) i++;
  *text = '\0';
  for (; i < self->depth && used + 90 < size; i++)
    used += (size_t)snprintf(text + used, size - used, "%.80s -> ", self->stack[i]->path);
}

/* Marks the places; returns the number of values. */
static size_t set_file(strut_tree *tree, unsigned number) {
  size_t count = 1;
  if (tree->place.file == number) return 0; /* shared by aliases */
  tree->place.file = number & 0xFFu;
  for (strut_tree *child = tree->first; child; child = child->next)
    count += set_file(child, number);
  return count;
}

/* Adds the messages about a file to those of the scene; the first says where the file is used. */
static void take_messages(loader *self, const strut_diagnostics *own, const text_file *f,
                          const strut_tree *name) {
  for (size_t i = 0; i < own->count; i++) {
    strut_place place = own->items[i].place;
    place.file = f->number & 0xFFu;
    size_t before = self->diagnostics->count;
    strut_diagnose(self->diagnostics, place, "%s", own->items[i].message);
    if (!i && self->diagnostics->count > before)
      strut_diagnose_note(self->diagnostics, before, name->place, "the file is used here");
  }
  self->diagnostics->unstored += own->unstored;
}

/* The tree of the file's text, in the document's memory. NULL: it was reported. */
static strut_tree *read_tree(loader *self, text_file *f, const strut_tree *name) {
  const strut_used_file *used = &self->diagnostics->used[f->number - 1];
  strut_diagnostics own = {0};
  strut_diagnostics_source(&own, used->file, used->text, used->length);
  strut_tree *before = self->document->root;
  strut_status status = strut_document_read(self->document, &own);
  strut_tree *root = self->document->root;
  self->document->root = before;
  if (status == STRUT_NO_MEMORY) self->out_of_memory = true;
  take_messages(self, &own, f, name);
  strut_diagnostics_free(&own);
  if (status != STRUT_OK) return NULL;
  f->values = set_file(root, f->number);
  return root;
}

/* The file of that name, whose text has been read. NULL: it was reported. */
static text_file *find_file(loader *self, const strut_tree *name) {
  const text_file *from = &self->files[name->place.file];
  strut_safe_text text = {0};
  strut_error error = {0};
  strut_status status = strut_safe_read(
      self->folder, from->path, name->text,
      self->bytes < STRUT_TEXT_MOST ? STRUT_TEXT_MOST - self->bytes : 0, &text, &error);
  if (status == STRUT_NO_MEMORY) self->out_of_memory = true;
  if (status != STRUT_OK) {
    strut_diagnose(self->diagnostics, name->place, "%s", error.message);
    return NULL;
  }
  for (size_t i = 0; i < self->count; i++)
    if (self->files[i].known && self->files[i].device == text.device &&
        self->files[i].inode == text.inode) {
      strut_safe_text_free(&text);
      return &self->files[i];
    }
  unsigned number = strut_diagnostics_use(self->diagnostics, text.path, text.text, text.length);
  if (!number) {
    strut_diagnose(self->diagnostics, name->place, "more than %d files are used",
                   STRUT_USED_FILES_MOST);
    strut_safe_text_free(&text);
    return NULL;
  }
  text_file *f = &self->files[self->count++];
  self->bytes += text.length;
  strut_diagnostics_own(self->diagnostics, number, text.text);
  *f = (text_file){.path = self->diagnostics->used[number - 1].file,
                   .device = text.device,
                   .inode = text.inode,
                   .known = true,
                   .number = number};
  text.text = NULL;
  strut_safe_text_free(&text);
  f->text = read_tree(self, f, name);
  f->failed = !f->text;
  return f;
}

/* May the file be opened from those that are open? If not, that is reported. */
static bool enter(loader *self, text_file *f, const strut_tree *name) {
  char chain[1200];
  if (f->open) {
    format_chain(self, f, chain, sizeof chain);
    strut_diagnose(self->diagnostics, name->place, "files use each other in a circle: %s%s", chain,
                   f->path);
    return false;
  }
  if (self->depth + f->height > STRUT_DEEPEST_FILE) {
    strut_diagnose(self->diagnostics, name->place, "files use each other more than %d deep",
                   STRUT_DEEPEST_FILE);
    return false;
  }
  self->stack[self->depth++] = f;
  f->open = true;
  return true;
}

static void leave(loader *self, text_file *f) {
  self->depth--;
  f->open = false;
  text_file *outer = self->stack[self->depth - 1];
  if (outer->height < f->height + 1) outer->height = f->height + 1;
}

static bool is_scene(loader *self, const text_file *f, const strut_tree *name) {
  const strut_tree *version = strut_tree_find(f->text, "strut", NULL);
  bool known = version && version->kind == STRUT_TREE_SCALAR && strcmp(version->text, "1") == 0;
  const char *fault = f->text->kind != STRUT_TREE_MAP ? "is not a mapping, expected a scene"
                      : strut_tree_is_study(f->text)  ? "is a study, expected a scene"
                      : !known ? "is not a scene of this version: it lacks 'strut: 1'"
                               : NULL;
  if (fault) strut_diagnose(self->diagnostics, name->place, "'%s' %s", f->path, fault);
  return !fault;
}

static bool lay_over_base(loader *self, text_file *f);
static strut_tree *with_files(loader *self, strut_tree *map);

/* The file that `name` names, laid over its base; `whole`: with all files of its parts, too. */
static text_file *load(loader *self, const strut_tree *name, const char *key, bool whole) {
  if (name->kind != STRUT_TREE_SCALAR) {
    strut_diagnose(self->diagnostics, name->place,
                   "expected the path of a file for '%s', found a %s", key,
                   name->kind == STRUT_TREE_LIST ? "list" : "mapping");
    return NULL;
  }
  text_file *f = find_file(self, name);
  if (!f || f->failed || !enter(self, f, name)) return NULL;
  bool fine = f->scene || (is_scene(self, f, name) && lay_over_base(self, f));
  if (fine && whole && !f->whole) {
    f->whole = with_files(self, f->scene);
    fine = f->whole != NULL;
    if (!fine) self->out_of_memory = true;
  }
  leave(self, f);
  f->failed = !fine;
  return fine ? f : NULL;
}

/* ---- what a part takes of a file ---- */

/* Adds the entry, with an empty mapping where `value` is NULL, unless there is one of that name. */
static bool add_once(loader *self, strut_tree_builder *map, strut_name_map *names,
                     const strut_tree *key, const strut_tree *value) {
  strut_arena *arena = &self->document->arena;
  int32_t known = strut_name_map_add(names, key->text, 0);
  if (known != -1) return known >= 0;
  return strut_tree_append(
      map, strut_tree_copy(arena, key),
      value ? strut_tree_copy(arena, value) : strut_tree_begin(arena, key).map);
}

/* The contacts of a ground whose nodes are listed: of the ground's keys these belong to the structure. */
static strut_tree *contacts_of(loader *self, const strut_tree *ground) {
  const strut_tree *nodes = strut_tree_find(ground, "nodes", NULL);
  const strut_tree *own = strut_tree_find(ground, "contacts", NULL);
  if (own && own->kind != STRUT_TREE_MAP) own = NULL;
  strut_tree_builder map = strut_tree_begin(&self->document->arena, ground);
  strut_name_map names = {0};
  bool fine = map.map != NULL;
  for (const strut_tree *tree = own ? own->first : NULL; tree && fine; tree = tree->next->next)
    fine = add_once(self, &map, &names, tree, tree->next);
  const strut_tree *item = nodes && nodes->kind == STRUT_TREE_LIST ? nodes->first : NULL;
  for (; item && fine; item = item->next)
    if (item->kind == STRUT_TREE_SCALAR) fine = add_once(self, &map, &names, item, NULL);
  strut_name_map_free(&names);
  return fine ? map.map : NULL;
}

/* Of a scene's keys those that a part has too; unknown ones, so that they are reported. */
static bool is_taken(const char *key) {
  return strut_key_find(STRUT_SECTION_PART, key) >= 0 ||
         (strut_key_find(STRUT_SECTION_SCENE, key) < 0 && strcmp(key, "ground") != 0);
}

/* The scene as a part. NULL: memory is out. */
static strut_tree *make_part(loader *self, const strut_tree *root) {
  strut_arena *arena = &self->document->arena;
  strut_tree_builder part = strut_tree_begin(arena, root);
  for (const strut_tree *tree = root->first; tree; tree = tree->next->next)
    if (is_taken(tree->text) && !strut_tree_share(&part, arena, tree, tree->next)) return NULL;
  strut_tree *key = NULL, *ground = strut_tree_find(root, "ground", &key);
  if (!ground || ground->kind != STRUT_TREE_MAP) return part.map;
  strut_tree *contacts = contacts_of(self, ground),
             *name = strut_tree_scalar(arena, key, "contacts");
  if (!contacts || !name) return NULL;
  if (contacts->count && !strut_tree_append(&part, name, contacts)) return NULL;
  return part.map;
}

/* ---- the files of a tree ---- */

/* `isolated: yes` in place of `use`, which has been done. False: memory is out. */
static bool isolate(loader *self, strut_tree *part, const strut_tree *name) {
  strut_arena *arena = &self->document->arena;
  strut_tree_builder b = {part, &part->first};
  strut_tree_drop(part, "use");
  strut_tree_drop(part, "isolated");
  while (*b.end) b.end = &(*b.end)->next;
  return strut_tree_append(&b, strut_tree_scalar(arena, name, "isolated"),
                           strut_tree_scalar(arena, name, "yes"));
}

/* Files that each use another twice would make a tree that is too large to be written or compared. */
static bool may_repeat(loader *self, text_file *used, const strut_tree *name) {
  self->stack[self->depth - 1]->values += used->values;
  bool before = self->repeated <= MOST_REPEATED;
  if (used->uses++) self->repeated += used->values;
  if (self->repeated <= MOST_REPEATED) return true;
  if (before)
    strut_diagnose(self->diagnostics, name->place, "more than %d values are repeated by used files",
                   MOST_REPEATED);
  return false;
}

/* The part's keys laid over what it takes of its file; the part itself where that was reported. */
static strut_tree *use_file(loader *self, strut_tree *part) {
  strut_tree *name = strut_tree_find(part, "use", NULL);
  if (!name || name->count) return part;
  text_file *used = load(self, name, "use", true);
  if (used && !used->part) used->part = make_part(self, used->whole);
  if (used && !used->part) self->out_of_memory = true;
  if (!used || !used->part || !may_repeat(self, used, name)) {
    self->failed = true;
    name->count = 1; /* it has been reported */
    return part;
  }
  const strut_overlay overlay = {.arena = &self->document->arena, .diagnostics = self->diagnostics};
  size_t before = self->diagnostics->count;
  strut_tree *whole =
      strut_lay_over(&overlay, (strut_mapping_kind){STRUT_SECTION_PART, false}, used->part, part);
  if (!whole || !isolate(self, whole, name)) self->out_of_memory = true;
  if (self->diagnostics->count > before) self->failed = true;
  return whole ? whole : part;
}

/* The mapping with the files of its parts, and of those within them. NULL: memory is out. */
static strut_tree *with_files(loader *self, strut_tree *map) {
  const strut_tree *parts = strut_tree_find(map, "parts", NULL);
  if (!parts || parts->kind != STRUT_TREE_MAP) return map;
  strut_arena *arena = &self->document->arena;
  strut_tree_builder inner = strut_tree_begin(arena, parts), result = strut_tree_begin(arena, map);
  for (const strut_tree *tree = parts->first; tree; tree = tree->next->next) {
    strut_tree *part = strut_tree_copy(arena, tree->next);
    bool keys = part && part->kind == STRUT_TREE_MAP;
    if (keys) part = with_files(self, part); /* before those of its file come in */
    if (keys && part) part = use_file(self, part);
    if (self->out_of_memory || !strut_tree_append(&inner, strut_tree_copy(arena, tree), part))
      return NULL;
  }
  for (const strut_tree *k = map->first; k; k = k->next->next)
    if (!strut_tree_share(&result, arena, k, k->next == parts ? inner.map : k->next)) return NULL;
  return result.map;
}

/* Sets the file's scene; a base that cannot be read was reported. */
static bool lay_over_base(loader *self, text_file *f) {
  const strut_mapping_kind kind = {STRUT_SECTION_SCENE, false};
  const strut_tree *name = strut_tree_find(f->text, "base", NULL);
  f->scene = f->text;
  if (!name) return true;
  f->scene = NULL;
  text_file *base = load(self, name, "base", false);
  if (!base) return false;
  const strut_overlay overlay = {.arena = &self->document->arena, .diagnostics = self->diagnostics};
  size_t before = self->diagnostics->count;
  f->scene = strut_lay_over(&overlay, kind, base->scene, f->text);
  if (!f->scene) self->out_of_memory = true;
  if (!f->scene) return false;
  f->scene->place = f->text->place;
  strut_tree_drop(f->scene, "base");
  if (!strut_tree_find(f->text, "strut", NULL))
    strut_tree_drop(f->scene, "strut"); /* every file says it itself */
  return self->diagnostics->count == before;
}

static strut_status load_all(loader *self, strut_tree *root) {
  struct stat found;
  text_file *top = &self->files[self->count++];
  *top = (text_file){
      .path = self->diagnostics->file ? self->diagnostics->file : "", .text = root, .open = true};
  self->stack[self->depth++] = top;
  if (stat(top->path, &found) == 0) {
    top->known = true;
    top->device = (uint64_t)found.st_dev;
    top->inode = (uint64_t)found.st_ino;
  }
  bool fine = lay_over_base(self, top);
  if (fine) top->whole = with_files(self, top->scene);
  if (fine && !top->whole) self->out_of_memory = true;
  self->document->root = top->whole;
  if (self->out_of_memory) return STRUT_NO_MEMORY;
  return fine && !self->failed ? STRUT_OK : STRUT_BAD_SCENE;
}

strut_status strut_read_used_files(strut_document *document, strut_diagnostics *diagnostics) {
  strut_tree *root = document->root;
  bool any = root && (strut_tree_find(root, "base", NULL) || strut_tree_find(root, "parts", NULL));
  if (!any) return STRUT_OK;
  strut_arena arena = {0};
  loader l = {.document = document, .diagnostics = diagnostics, .bytes = diagnostics->length};
  l.files = strut_arena_allocate(&arena, STRUT_USED_FILES_MOST + 1, sizeof *l.files);
  l.folder = strut_folder_of(diagnostics->file ? diagnostics->file : "", &arena);
  strut_status status = l.files && l.folder ? load_all(&l, root) : STRUT_NO_MEMORY;
  strut_arena_free(&arena);
  return status;
}

/* ---- files below the folder of another ---- */

#ifndef PATH_MAX
#define PATH_MAX 4096
#endif

char *strut_folder_of(const char *path, strut_arena *arena) {
  const char *slash = strrchr(path, '/');
  if (!slash) return strut_arena_text(arena, ".", 1);
  return strut_arena_text(arena, path, slash == path ? 1 : (size_t)(slash - path));
}

static bool climbs(const char *name) {
  for (const char *at = name; *at;) {
    size_t length = strcspn(at, "/");
    if (length == 2 && at[0] == '.' && at[1] == '.') return true;
    at += length;
    at += *at == '/';
  }
  return false;
}

static strut_status check_name(const char *name, strut_error *error) {
  if (!*name) return strut_fail(error, STRUT_BAD_SCENE, "expected the path of a file, found ''");
  if (*name == '/')
    return strut_fail(error, STRUT_BAD_SCENE,
                      "'%.300s' is an absolute path, expected one below the folder of this file",
                      name);
  if (climbs(name))
    return strut_fail(error, STRUT_BAD_SCENE,
                      "'%.300s' has a '..', expected a path below the folder of this file", name);
  return STRUT_OK;
}

/* What `real` has behind the folder `root`; NULL: it lies elsewhere. Both have their links resolved. */
static const char *path_below(const char *root, const char *real) {
  size_t length = strlen(root);
  if (length == 1) return real + 1; /* the root of the file system */
  return strncmp(real, root, length) == 0 && real[length] == '/' ? real + length + 1 : NULL;
}

/*
 * Opens a file below the folder part by part, following no link, so that a path that is changed
 * meanwhile cannot lead elsewhere. -1 with errno; ELOOP and ENOTDIR then mean that it was changed.
 */
static int open_below(const char *root, const char *below, struct stat *found) {
  int folder = open(root, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  while (folder >= 0) {
    char part[NAME_MAX + 1];
    size_t length = strcspn(below, "/");
    bool last = !below[length];
    int next = -1;
    if (length > NAME_MAX) {
      errno = ENAMETOOLONG;
    } else {
      memcpy(part, below, length);
      part[length] = '\0';
      int how = last ? O_NONBLOCK | O_NOCTTY : O_DIRECTORY;
      bool regular = !last || (fstatat(folder, part, found, AT_SYMLINK_NOFOLLOW) == 0 &&
                               S_ISREG(found->st_mode));
      if (regular) next = openat(folder, part, O_RDONLY | O_NOFOLLOW | O_CLOEXEC | how);
    }
    int code = errno;
    close(folder);
    errno = code;
    if (last || next < 0) return next;
    folder = next;
    below += length + 1;
  }
  return -1;
}

/* Reads `size` bytes and one more, which must not exist. */
static strut_status read_bytes(int descriptor, size_t size, strut_safe_text *file,
                               strut_error *error) {
  file->text = strut_allocate(size + 2, 1);
  if (!file->text) return strut_no_memory(error, "");
  while (file->length <= size) {
    ssize_t got = read(descriptor, file->text + file->length, size + 1 - file->length);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return strut_file_fail(error, "read", file->path, errno);
    if (got == 0) break;
    file->length += (size_t)got;
  }
  if (file->length > size)
    return strut_fail(error, STRUT_FILE_TROUBLE, "'%.300s' has changed while it was read",
                      file->path);
  file->text[file->length] = '\0';
  return STRUT_OK;
}

static strut_status read_below(const char *root, const char *below, size_t most,
                               strut_safe_text *file, strut_error *error) {
  struct stat found = {0};
  int descriptor = open_below(root, below, &found);
  int code = errno;
  strut_status status;
  if (descriptor >= 0 && fstat(descriptor, &found) != 0) {
    status = strut_file_fail(error, "read", file->path, errno);
  } else if ((descriptor >= 0 || found.st_nlink > 0) && !S_ISREG(found.st_mode)) {
    status = strut_fail(error, STRUT_BAD_SCENE, "'%.300s' is not a regular file", file->path);
  } else if (descriptor < 0) {
    status = strut_file_fail(error, "read", file->path, code);
  } else if (found.st_size > 0 && (uintmax_t)found.st_size > most) {
    status = strut_fail(error, STRUT_BAD_SCENE, "'%.300s' has %jd bytes, expected at most %zu",
                        file->path, (intmax_t)found.st_size, most);
  } else {
    file->device = (uint64_t)found.st_dev;
    file->inode = (uint64_t)found.st_ino;
    status = read_bytes(descriptor, (size_t)found.st_size, file, error);
  }
  if (descriptor >= 0) close(descriptor);
  return status;
}

/* The path of `name` from the folder of `from`, in a block of strut_allocate. */
static char *join(const char *from, const char *name) {
  const char *slash = strrchr(from, '/');
  size_t folder = slash ? (size_t)(slash - from) + 1 : 0;
  char *path = strut_allocate(folder + strlen(name) + 1, 1);
  if (!path) return NULL;
  memcpy(path, from, folder);
  strcpy(path + folder, name);
  return path;
}

strut_status strut_safe_read(const char *root, const char *from, const char *name, size_t most,
                             strut_safe_text *file, strut_error *error) {
  char top[PATH_MAX], real[PATH_MAX];
  *file = (strut_safe_text){0};
  strut_status status = check_name(name, error);
  if (status) return status;
  file->path = join(from, name);
  if (!file->path) return strut_no_memory(error, "");
  if (!realpath(root, top)) {
    status = strut_file_fail(error, "read", root, errno);
  } else if (!realpath(file->path, real)) {
    status = strut_file_fail(error, "read", file->path, errno);
  } else {
    const char *below = path_below(top, real);
    if (strcmp(top, real) == 0)
      status = strut_fail(error, STRUT_BAD_SCENE, "'%.300s' is not a regular file", file->path);
    else if (!below)
      status = strut_fail(error, STRUT_BAD_SCENE, "'%.300s' leads out of the folder '%.200s'",
                          file->path, root);
    else
      status = read_below(top, below, most, file, error);
  }
  if (status) strut_safe_text_free(file);
  return status;
}

void strut_safe_text_free(strut_safe_text *file) {
  strut_release(file->path);
  strut_release(file->text);
  *file = (strut_safe_text){0};
}
