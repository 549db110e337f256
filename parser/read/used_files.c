/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/read/used_files.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "engine/base/name_map.h"
#include "parser/read/overlay.h"
#include "parser/read/safe_path.h"

/* Values that files which are used several times may repeat, as those of aliases. */
enum { MOST_REPEATED = 1000000 };

/* A file that was read, or is being read. */
typedef struct file {
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
} file;

typedef struct loader {
  strut_document *document;
  strut_diagnostics *diagnostics;
  const char *folder; /* below which all files lie */
  size_t bytes;       /* of all texts */
  size_t repeated;    /* values of files that are used again */
  size_t count;
  file *files; /* (STRUT_USED_FILES_MOST + 1) by their numbers; the first is the scene itself */
  unsigned depth;
  file *stack[STRUT_DEEPEST_FILE + 1]; /* that are open */
  bool failed, out_of_memory;
} loader;

/* ---- one file ---- */

/* "a.yaml -> b.yaml -> " of the files that are open, from `first` on. */
static void format_chain(const loader *l, const file *first, char *text, size_t size) {
  size_t used = 0, i = 0;
  while (l->stack[i] != first) i++;
  *text = '\0';
  for (; i < l->depth && used + 90 < size; i++)
    used += (size_t)snprintf(text + used, size - used, "%.80s -> ", l->stack[i]->path);
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

/* The messages about a file, told about the scene; the first says where the file is used. */
static void take_messages(loader *l, const strut_diagnostics *own, const file *f,
                          const strut_tree *name) {
  for (size_t i = 0; i < own->count; i++) {
    strut_place place = own->items[i].place;
    place.file = f->number & 0xFFu;
    size_t before = l->diagnostics->count;
    strut_diagnose(l->diagnostics, place, "%s", own->items[i].message);
    if (!i && l->diagnostics->count > before)
      strut_diagnose_note(l->diagnostics, before, name->place, "the file is used here");
  }
  l->diagnostics->unstored += own->unstored;
}

/* The tree of the file's text, in the document's memory. NULL: it was reported. */
static strut_tree *read_tree(loader *l, file *f, const strut_tree *name) {
  const strut_used_file *used = &l->diagnostics->used[f->number - 1];
  strut_diagnostics own = {0};
  strut_diagnostics_source(&own, used->file, used->text, used->length);
  strut_tree *before = l->document->root;
  strut_status status = strut_document_read(l->document, &own);
  strut_tree *root = l->document->root;
  l->document->root = before;
  if (status == STRUT_NO_MEMORY) l->out_of_memory = true;
  take_messages(l, &own, f, name);
  strut_diagnostics_free(&own);
  if (status != STRUT_OK) return NULL;
  f->values = set_file(root, f->number);
  return root;
}

/* The file of that name, whose text has been read. NULL: it was reported. */
static file *find_file(loader *l, const strut_tree *name) {
  const file *from = &l->files[name->place.file];
  strut_safe_text text = {0};
  strut_error error = {0};
  strut_status status =
      strut_safe_read(l->folder, from->path, name->text,
                      l->bytes < STRUT_TEXT_MOST ? STRUT_TEXT_MOST - l->bytes : 0, &text, &error);
  if (status == STRUT_NO_MEMORY) l->out_of_memory = true;
  if (status != STRUT_OK) {
    strut_diagnose(l->diagnostics, name->place, "%s", error.message);
    return NULL;
  }
  for (size_t i = 0; i < l->count; i++)
    if (l->files[i].known && l->files[i].device == text.device && l->files[i].inode == text.inode) {
      strut_safe_text_free(&text);
      return &l->files[i];
    }
  unsigned number = strut_diagnostics_use(l->diagnostics, text.path, text.text, text.length);
  if (!number) {
    strut_diagnose(l->diagnostics, name->place, "more than %d files are used",
                   STRUT_USED_FILES_MOST);
    strut_safe_text_free(&text);
    return NULL;
  }
  file *f = &l->files[l->count++];
  l->bytes += text.length;
  strut_diagnostics_own(l->diagnostics, number, text.text);
  *f = (file){.path = l->diagnostics->used[number - 1].file,
              .device = text.device,
              .inode = text.inode,
              .known = true,
              .number = number};
  text.text = NULL;
  strut_safe_text_free(&text);
  f->text = read_tree(l, f, name);
  f->failed = !f->text;
  return f;
}

/* May the file be opened from those that are open? If not, that is reported. */
static bool enter(loader *l, file *f, const strut_tree *name) {
  char chain[1200];
  if (f->open) {
    format_chain(l, f, chain, sizeof chain);
    strut_diagnose(l->diagnostics, name->place, "files use each other in a circle: %s%s", chain,
                   f->path);
    return false;
  }
  if (l->depth + f->height > STRUT_DEEPEST_FILE) {
    strut_diagnose(l->diagnostics, name->place, "files use each other more than %d deep",
                   STRUT_DEEPEST_FILE);
    return false;
  }
  l->stack[l->depth++] = f;
  f->open = true;
  return true;
}

static void leave(loader *l, file *f) {
  l->depth--;
  f->open = false;
  file *outer = l->stack[l->depth - 1];
  if (outer->height < f->height + 1) outer->height = f->height + 1;
}

/* Is it a scene of this version of the language? */
static bool is_scene(loader *l, const file *f, const strut_tree *name) {
  const char *expected = "expected a scene";
  strut_place place = name->place;
  if (f->text->kind != STRUT_TREE_MAP) {
    strut_diagnose(l->diagnostics, place, "'%s' is not a mapping, %s", f->path, expected);
    return false;
  }
  bool study = strut_tree_find(f->text, "study", NULL) && !strut_tree_find(f->text, "nodes", NULL);
  if (study) {
    strut_diagnose(l->diagnostics, place, "'%s' is a study, %s", f->path, expected);
    return false;
  }
  const strut_tree *version = strut_tree_find(f->text, "strut", NULL);
  if (version && version->kind == STRUT_TREE_SCALAR && strcmp(version->text, "1") == 0) return true;
  strut_diagnose(l->diagnostics, place, "'%s' is not a scene of this version: it lacks 'strut: 1'",
                 f->path);
  return false;
}

static bool lay_over_base(loader *l, file *f);
static strut_tree *with_files(loader *l, strut_tree *map);

/* The file that `name` names, laid over its base; `whole`: with all files of its parts, too. */
static file *load(loader *l, const strut_tree *name, const char *key, bool whole) {
  if (name->kind != STRUT_TREE_SCALAR) {
    strut_diagnose(l->diagnostics, name->place, "expected the path of a file for '%s', found a %s",
                   key, name->kind == STRUT_TREE_LIST ? "list" : "mapping");
    return NULL;
  }
  file *f = find_file(l, name);
  if (!f || f->failed || !enter(l, f, name)) return NULL;
  bool fine = f->scene || (is_scene(l, f, name) && lay_over_base(l, f));
  if (fine && whole && !f->whole) {
    f->whole = with_files(l, f->scene);
    fine = f->whole != NULL;
    if (!fine) l->out_of_memory = true;
  }
  leave(l, f);
  f->failed = !fine;
  return fine ? f : NULL;
}

/* ---- what a part takes of a file ---- */

static bool add(strut_tree *map, strut_tree ***end, strut_tree *key, strut_tree *value) {
  if (!key || !value) return false;
  **end = key;
  key->next = value;
  *end = &value->next;
  map->count++;
  return true;
}

static strut_tree *copied(loader *l, const strut_tree *node) {
  strut_tree *copy = strut_arena_allocate(&l->document->arena, 1, sizeof *copy);
  if (!copy) return NULL;
  *copy = *node;
  copy->next = NULL;
  return copy;
}

/* A mapping without entries, where the node stands. */
static strut_tree *empty_map(loader *l, const strut_tree *node) {
  strut_tree *map = copied(l, node);
  if (!map) return NULL;
  *map = (strut_tree){.kind = STRUT_TREE_MAP, .place = node->place, .text = ""};
  return map;
}

/* Adds the entry, with an empty mapping where `value` is NULL, unless there is one of that name. */
static bool add_once(loader *l, strut_tree *map, strut_tree ***end, strut_name_map *names,
                     const strut_tree *key, const strut_tree *value) {
  int32_t known = strut_name_map_add(names, key->text, 0);
  if (known != -1) return known >= 0;
  return add(map, end, copied(l, key), value ? copied(l, value) : empty_map(l, key));
}

/* The contacts of a ground whose nodes are listed: of the ground's keys these belong to the structure. */
static strut_tree *contacts_of(loader *l, const strut_tree *ground) {
  const strut_tree *nodes = strut_tree_find(ground, "nodes", NULL);
  const strut_tree *own = strut_tree_find(ground, "contacts", NULL);
  if (own && own->kind != STRUT_TREE_MAP) own = NULL;
  strut_tree *map = empty_map(l, ground);
  if (!map) return NULL;
  strut_tree **end = &map->first;
  strut_name_map names = {0};
  bool fine = true;
  for (const strut_tree *k = own ? own->first : NULL; k && fine; k = k->next->next)
    fine = add_once(l, map, &end, &names, k, k->next);
  const strut_tree *item = nodes && nodes->kind == STRUT_TREE_LIST ? nodes->first : NULL;
  for (; item && fine; item = item->next)
    if (item->kind == STRUT_TREE_SCALAR) fine = add_once(l, map, &end, &names, item, NULL);
  strut_name_map_free(&names);
  return fine ? map : NULL;
}

/* Of a scene's keys those that a part has too; unknown ones, so that they are reported. */
static bool is_taken(const char *key) {
  return strut_key_find(STRUT_SECTION_PART, key) >= 0 ||
         (strut_key_find(STRUT_SECTION_SCENE, key) < 0 && strcmp(key, "ground") != 0);
}

/* The scene as a part. NULL: memory is out. */
static strut_tree *make_part(loader *l, const strut_tree *root) {
  strut_tree *part = empty_map(l, root), **end = part ? &part->first : NULL;
  if (!part) return NULL;
  for (const strut_tree *k = root->first; k; k = k->next->next)
    if (is_taken(k->text) && !add(part, &end, copied(l, k), copied(l, k->next))) return NULL;
  strut_tree *key = NULL, *ground = strut_tree_find(root, "ground", &key);
  if (!ground || ground->kind != STRUT_TREE_MAP) return part;
  strut_tree *contacts = contacts_of(l, ground), *name = copied(l, key);
  if (!contacts || !name) return NULL;
  name->text = "contacts";
  if (contacts->count && !add(part, &end, name, contacts)) return NULL;
  return part;
}

/* ---- the files of a tree ---- */

/* Takes a key out of a mapping whose entries are not shared. */
static void drop_key(strut_tree *map, const char *name) {
  strut_tree **link = &map->first;
  while (*link && strcmp((*link)->text, name) != 0) link = &(*link)->next->next;
  if (!*link) return;
  *link = (*link)->next->next;
  map->count--;
}

/* `isolated: yes` in place of `use`, which has been done. False: memory is out. */
static bool isolate(loader *l, strut_tree *part, const strut_tree *name) {
  strut_tree *key = copied(l, name), *value = copied(l, name), **end = &part->first;
  if (!key || !value) return false;
  drop_key(part, "use");
  drop_key(part, "isolated");
  key->quoted = value->quoted = false;
  key->text = "isolated", value->text = "yes";
  while (*end) end = &(*end)->next;
  return add(part, &end, key, value);
}

/* Files that each use another twice would make a tree that is too large to be written or compared. */
static bool may_repeat(loader *l, file *used, const strut_tree *name) {
  l->stack[l->depth - 1]->values += used->values;
  bool before = l->repeated <= MOST_REPEATED;
  if (used->uses++) l->repeated += used->values;
  if (l->repeated <= MOST_REPEATED) return true;
  if (before)
    strut_diagnose(l->diagnostics, name->place, "more than %d values are repeated by used files",
                   MOST_REPEATED);
  return false;
}

/* The part's keys laid over what it takes of its file; the part itself where that was reported. */
static strut_tree *use_file(loader *l, strut_tree *part) {
  strut_tree *name = strut_tree_find(part, "use", NULL);
  if (!name || name->count) return part;
  file *used = load(l, name, "use", true);
  if (used && !used->part) used->part = make_part(l, used->whole);
  if (used && !used->part) l->out_of_memory = true;
  if (!used || !used->part || !may_repeat(l, used, name)) {
    l->failed = true;
    name->count = 1; /* it has been reported */
    return part;
  }
  const strut_overlay overlay = {.arena = &l->document->arena, .diagnostics = l->diagnostics};
  size_t before = l->diagnostics->count;
  strut_tree *whole =
      strut_lay_over(&overlay, (strut_mapping_kind){STRUT_SECTION_PART, false}, used->part, part);
  if (!whole || !isolate(l, whole, name)) l->out_of_memory = true;
  if (l->diagnostics->count > before) l->failed = true;
  return whole ? whole : part;
}

/* The mapping with the files of its parts, and of those within them. NULL: memory is out. */
static strut_tree *with_files(loader *l, strut_tree *map) {
  const strut_tree *parts = strut_tree_find(map, "parts", NULL);
  if (!parts || parts->kind != STRUT_TREE_MAP) return map;
  strut_tree *result = copied(l, map), *inner = copied(l, parts);
  if (!result || !inner) return NULL;
  strut_tree **end = &inner->first;
  inner->first = NULL;
  inner->count = 0;
  for (const strut_tree *k = parts->first; k; k = k->next->next) {
    strut_tree *part = copied(l, k->next);
    bool keys = part && part->kind == STRUT_TREE_MAP;
    if (keys) part = with_files(l, part); /* before those of its file come in */
    if (keys && part) part = use_file(l, part);
    if (l->out_of_memory || !add(inner, &end, copied(l, k), part)) return NULL;
  }
  end = &result->first;
  result->first = NULL;
  result->count = 0;
  for (const strut_tree *k = map->first; k; k = k->next->next)
    if (!add(result, &end, copied(l, k), k->next == parts ? inner : copied(l, k->next)))
      return NULL;
  return result;
}

/* Sets the file's scene; a base that cannot be read was reported. */
static bool lay_over_base(loader *l, file *f) {
  const strut_mapping_kind kind = {STRUT_SECTION_SCENE, false};
  const strut_tree *name = strut_tree_find(f->text, "base", NULL);
  f->scene = f->text;
  if (!name) return true;
  f->scene = NULL;
  file *base = load(l, name, "base", false);
  if (!base) return false;
  const strut_overlay overlay = {.arena = &l->document->arena, .diagnostics = l->diagnostics};
  size_t before = l->diagnostics->count;
  f->scene = strut_lay_over(&overlay, kind, base->scene, f->text);
  if (!f->scene) l->out_of_memory = true;
  if (!f->scene) return false;
  f->scene->place = f->text->place;
  drop_key(f->scene, "base");
  if (!strut_tree_find(f->text, "strut", NULL))
    drop_key(f->scene, "strut"); /* every file says it itself */
  return l->diagnostics->count == before;
}

static strut_status load_all(loader *l, strut_tree *root) {
  struct stat found;
  file *top = &l->files[l->count++];
  *top =
      (file){.path = l->diagnostics->file ? l->diagnostics->file : "", .text = root, .open = true};
  l->stack[l->depth++] = top;
  if (stat(top->path, &found) == 0) {
    top->known = true;
    top->device = (uint64_t)found.st_dev;
    top->inode = (uint64_t)found.st_ino;
  }
  bool fine = lay_over_base(l, top);
  if (fine) top->whole = with_files(l, top->scene);
  if (fine && !top->whole) l->out_of_memory = true;
  l->document->root = top->whole;
  if (l->out_of_memory) return STRUT_NO_MEMORY;
  return fine && !l->failed ? STRUT_OK : STRUT_BAD_SCENE;
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
