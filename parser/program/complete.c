/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the cursor is decides what fits: a command, an option, an option's value, a file. See complete.h. */
#include "parser/program/complete.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/memory.h"
#include "engine/integrate/integrator.h"
#include "engine/output/file.h"
#include "parser/language/keys.h"
#include "parser/program/commands.h"
#include "parser/program/streams.h"
#include "parser/read/read_scene.h"
#include "parser/read/reader.h"
#include "parser/read/used_files.h"
#include "parser/yaml/diagnostics.h"

void strut_offer(const strut_completion *c, const char *text, const char *end, const char *help) {
  if (strncmp(text, c->word, strlen(c->word)) != 0 || strpbrk(text, "\t\n")) return;
  printf("%.*s%s%s", c->kept, c->before, text, end);
  if (help && *help) {
    putchar('\t');
    for (const char *h = help; *h; h++) putchar(*h == '\t' || *h == '\n' ? ' ' : *h);
  }
  putchar('\n');
}

static void offer_words(const strut_completion *c, const char *words) {
  char word[40];
  for (int i = 0; strut_word_at(words, i, word, sizeof word); i++) strut_offer(c, word, "", NULL);
}

static void offer_commands(const strut_completion *c) {
  for (size_t i = 0; strut_command_at(i); i++)
    strut_offer(c, strut_command_at(i)->name, "", strut_command_at(i)->summary);
}

static void offer_options(const strut_completion *c, const strut_command *command) {
  char name[64];
  for (size_t i = 0; strut_option_at(command, i); i++) {
    snprintf(name, sizeof name, "--%s", strut_option_at(command, i)->name);
    strut_offer(c, name, "", strut_option_at(command, i)->help);
  }
  for (const strut_command_variant *f = command->forms; f && f->selector; f++) {
    if (f > command->forms && f->command == f[-1].command) continue; /* offered once it is chosen */
    snprintf(name, sizeof name, "--%s", f->selector);
    strut_offer(c, name, "", f->command->summary);
  }
}

static void offer_methods(const strut_completion *c) {
  for (size_t i = 0; strut_integrator_at(i); i++)
    strut_offer(c, strut_integrator_at(i)->name, "", strut_integrator_at(i)->description);
}

/* ---- values of options ---- */

/* Options that are one of some words; a test compares them with what the commands accept. */
static const struct word_option {
  const char *command; /* NULL: every one */
  strut_option_id id;
  const char *words;
} word_options[] = {{"form", STRUT_OPTION_GIVEN, "densities|lengths|prestress"},
                    {"form", STRUT_OPTION_OBJECTIVE, "largest|sum|squares"},
                    {"tradeoff", STRUT_OPTION_MEASURE, "velocity|position|energy"},
                    {"plot", STRUT_OPTION_KIND, "curves|map|work-precision"},
                    {NULL, STRUT_OPTION_LOG, "x|y|xy"},
                    {NULL, STRUT_OPTION_COLORS, "auto|sequential|diverging|grey"},
                    {NULL, STRUT_OPTION_DRAW, "overview|period|snapshots|curves"},
                    {NULL, STRUT_OPTION_EQUILIBRIA, "all|none"},
                    {NULL, STRUT_OPTION_EMIT, "slurm|parallel|htcondor"},
                    {"export", STRUT_OPTION_FORMAT, "scene|matrices|code|vtk|build|mjcf"},
                    {NULL, STRUT_OPTION_INPUT, "ntrt|tensegritysim|springable|tables"},
                    {NULL, STRUT_OPTION_REAL, "double|float"},
                    {NULL, STRUT_OPTION_COMPLETION, "bash|zsh|fish"},
                    {NULL, STRUT_OPTION_WIDTH, "page|column"}};

/* Options that take the words of a key. */
static const struct key_option {
  strut_option_id id;
  int key;
} key_options[] = {{STRUT_OPTION_BARS, STRUT_KEY_SCENE_BARS},
                   {STRUT_OPTION_MASS_MODEL, STRUT_KEY_SCENE_MASS_MODEL},
                   {STRUT_OPTION_FRICTION_LAW, STRUT_KEY_FRICTION_LAW},
                   {STRUT_OPTION_DAMPING_LAW, STRUT_KEY_GROUND_DAMPING_LAW}};

static const char *words_of(const strut_command *command, strut_option_id id) {
  for (size_t i = 0; i < sizeof word_options / sizeof word_options[0]; i++) {
    const struct word_option *o = &word_options[i];
    if (o->id == id && (!o->command || strcmp(o->command, command->name) == 0)) return o->words;
  }
  for (size_t i = 0; i < sizeof key_options / sizeof key_options[0]; i++)
    if (key_options[i].id == id) return strut_key_at(key_options[i].key)->words;
  return NULL;
}

/* Only what is behind the last comma is completed. */
static void keep_list(strut_completion *c) {
  const char *comma = strrchr(c->word, ',');
  if (!comma) return;
  c->kept += (int)(comma + 1 - c->word);
  c->word = comma + 1;
}

static const char *files_of(const char *argument) {
  if (strcmp(argument, "DIR") == 0) return ":folders";
  return strncmp(argument, "FILE", 4) == 0 ? ":files" : ":";
}

/* The directive for the last line. */
static const char *complete_value(const strut_command *command, const strut_option *option,
                                  strut_completion *c) {
  const char *words = words_of(command, option->id);
  if (words) offer_words(c, words);
  if (words) return ":";
  switch ((int)option->id) {
    case STRUT_OPTION_SET:
    case STRUT_OPTION_VARY:
      if (strchr(c->word, '='))
        strut_offer_values(c);
      else
        strut_offer_parameters(c);
      return ":";
    case STRUT_OPTION_AT: strut_offer_shapes(c); return ":";
    case STRUT_OPTION_INTEGRATOR: keep_list(c), offer_methods(c); return ":";
    case STRUT_OPTION_SUPPORTS: keep_list(c), strut_offer_nodes(c); return ":";
    case STRUT_OPTION_LOAD: strut_offer_loads(c); return ":";
    case STRUT_OPTION_OVER: strut_offer_path_parameters(c); return ":";
    case STRUT_OPTION_Y: keep_list(c), strut_offer_columns(c, ""); return ":";
    case STRUT_OPTION_X:
    case STRUT_OPTION_BY:
    case STRUT_OPTION_PANELS:
    case STRUT_OPTION_DIFFERENCE:
    case STRUT_OPTION_LABEL:
    case STRUT_OPTION_DOUBT: strut_offer_columns(c, ""); return ":";
    case STRUT_OPTION_BAND:
    case STRUT_OPTION_ONLY: strut_offer_columns(c, "="); return ":";
    default: return files_of(option->argument);
  }
}

/* ---- the command line ---- */

/* The option that `word` is, whole; its value follows "=" in *value, else NULL. */
static const strut_option *option_of(const strut_command *command, const char *word,
                                     const char **value) {
  *value = NULL;
  if (word[0] != '-' || !word[1]) return NULL;
  for (size_t i = 0; strut_option_at(command, i); i++) {
    const strut_option *option = strut_option_at(command, i);
    size_t length = strlen(option->name);
    if (word[1] != '-' && (int)option->id == word[1] && !word[2]) return option;
    if (word[1] != '-' || strncmp(word + 2, option->name, length) != 0) continue;
    if (word[2 + length] == '=') *value = word + 3 + length;
    if (*value || !word[2 + length]) return option;
  }
  return NULL;
}

/* The first file or folder among the positional arguments. */
static const char *find_model(const strut_command *command, int count, char **words) {
  for (int i = 0; i < count; i++) {
    const char *value;
    const strut_option *option = option_of(command, words[i], &value);
    if (option && option->argument && !value) i++;
    if (!option && words[i][0] != '-' && access(words[i], R_OK) == 0) return words[i];
  }
  return NULL;
}

static const char *complete_argument(const strut_command *command, const strut_completion *c) {
  const char *model = command->model ? command->model : "";
  if (strcmp(command->name, "help") == 0) offer_commands(c);
  for (int i = 0; i < STRUT_SECTION_COUNT && strncmp(model, "SECTION", 7) == 0; i++)
    strut_offer(c, strut_section_name((strut_section)i), "", NULL);
  if (strcmp(model, "EXAMPLE") == 0) strut_offer_examples(c);
  if (strcmp(model, "DIR") == 0) return ":folders";
  if (strcmp(model, "TABLE") == 0) return ":files csv";
  if (strstr(model, "RUN") || strncmp(model, "FILE", 4) == 0) return ":files";
  bool scene = strncmp(model, "MODEL", 5) == 0 || strcmp(model, "STUDY") == 0;
  return scene ? ":files yaml yml" : ":";
}

static const char *complete_in(const strut_command *command, int count, char **words) {
  const char *word = words[count - 1], *value;
  strut_completion c = {.word = word, .before = word};
  c.model = find_model(command, count - 1, words);
  const strut_option *option = option_of(command, word, &value);
  if (option && value && option->argument) {
    c.kept = (int)(value - word);
    c.word = value;
    return complete_value(command, option, &c);
  }
  option = count > 1 ? option_of(command, words[count - 2], &value) : NULL;
  if (option && !value && option->argument) return complete_value(command, option, &c);
  if (word[0] != '-') return complete_argument(command, &c);
  offer_options(&c, command);
  return ":";
}

strut_status strut_complete(int count, char **words) {
  const char *directive = ":";
  const strut_command *command = NULL;
  if (count == 1) {
    strut_completion c = {.word = words[0], .before = words[0]};
    offer_commands(&c);
  }
  for (size_t i = 0; count > 1 && !command && strut_command_at(i); i++)
    if (strcmp(strut_command_at(i)->name, words[0]) == 0) command = strut_command_at(i);
  if (command) command = strut_command_variant_of(command, count - 2, words + 1);
  if (command) directive = complete_in(command, count - 1, words + 1);
  puts(directive);
  return STRUT_OK;
}

/*
 * Names in the model that a command line mentions. Messages would disturb the line that is being typed:
 * what cannot be read offers nothing. See complete.h.
 */

enum { LARGEST = 4 << 20, PATH = 4096 };

/* The model as a tree, with what its base gives; and as a scene if it is valid. Zero-initialise. */
typedef struct opened {
  char path[PATH];
  char *text;
  size_t length;
  strut_diagnostics diagnostics;
  strut_scene_source *source;
  strut_document alone; /* the tree of a text that is no valid source */
  const strut_tree *root;
  strut_setup setup;
  bool valid;
} opened;

static void close_model(opened *o) {
  strut_scene_source_free(o->source);
  strut_document_free(&o->alone);
  strut_diagnostics_free(&o->diagnostics);
  if (o->valid) strut_setup_free(&o->setup);
  strut_release(o->text);
  *o = (opened){.text = NULL};
}

static bool read_text(opened *o) {
  struct stat found;
  strut_error error = {0};
  bool small = stat(o->path, &found) == 0 && S_ISREG(found.st_mode) && found.st_size <= LARGEST;
  return small && strut_file_read(o->path, &o->text, &o->length, &error) == STRUT_OK;
}

/* The path of the model of a study, which is o->path, where a study may name it. */
static bool follow_study(opened *o, const strut_tree *root) {
  const strut_tree *model = strut_tree_find(root, "model", NULL);
  strut_arena arena = {0};
  strut_safe_text text = {0};
  strut_error error = {0};
  if (!model || model->kind != STRUT_TREE_SCALAR) return false;
  const char *folder = strut_folder_of(o->path, &arena);
  bool found = folder &&
               strut_safe_read(folder, o->path, model->text, LARGEST, &text, &error) == STRUT_OK &&
               strlen(text.path) < sizeof o->path;
  if (found) strcpy(o->path, text.path);
  strut_safe_text_free(&text);
  strut_arena_free(&arena);
  return found;
}

/* The tree of o->path; false where there is none. */
static bool read_tree(opened *o) {
  if (!read_text(o)) return false;
  if (strut_scene_source_open(o->path, o->text, o->length, &o->diagnostics, &o->source) ==
      STRUT_OK) {
    o->root = strut_scene_source_document(o->source)->root;
  } else {
    strut_diagnostics_free(&o->diagnostics);
    o->diagnostics = (strut_diagnostics){0};
    strut_diagnostics_source(&o->diagnostics, o->path, o->text, o->length);
    strut_document_read(&o->alone, &o->diagnostics);
    o->root = o->alone.root;
  }
  return o->root && o->root->kind == STRUT_TREE_MAP;
}

static bool open_model(const strut_completion *c, opened *o) {
  struct stat found;
  if (!c->model) return false;
  bool run = stat(c->model, &found) == 0 && S_ISDIR(found.st_mode);
  int length = snprintf(o->path, sizeof o->path, "%s%s", c->model, run ? "/scene.yaml" : "");
  if (length < 0 || (size_t)length >= sizeof o->path || !read_tree(o)) return false;
  if (!strut_tree_is_study(o->root)) return true;
  opened model = {.text = NULL};
  memcpy(model.path, o->path, sizeof model.path);
  bool followed = follow_study(&model, o->root);
  close_model(o);
  *o = model;
  return followed && read_tree(o) && !strut_tree_is_study(o->root);
}

/* Things of copies are known once the scene was read. */
static bool read_scene(opened *o) {
  strut_diagnostics unused = {0};
  o->valid = strut_setup_read(&o->setup, o->path, o->text, o->length, NULL, 0, STRUT_FOR_ANY,
                              &unused) == STRUT_OK;
  strut_diagnostics_free(&unused);
  return o->valid;
}

/* The names in a mapping of the tree. */
static void offer_keys(const strut_completion *c, const opened *o, const char *map,
                       const char *end) {
  const strut_tree *things = strut_tree_find(o->root, map, NULL);
  if (!things || things->kind != STRUT_TREE_MAP) return;
  for (const strut_tree *key = things->first; key; key = key->next->next) {
    bool shown = key->next->kind == STRUT_TREE_SCALAR;
    strut_offer(c, key->text, end, shown ? key->next->text : NULL);
  }
}

void strut_offer_parameters(const strut_completion *c) {
  opened o = {.text = NULL};
  if (open_model(c, &o)) offer_keys(c, &o, "parameters", "=");
  close_model(&o);
}

void strut_offer_values(const strut_completion *c) {
  opened o = {.text = NULL};
  size_t length = strcspn(c->word, "=");
  const strut_tree *map = open_model(c, &o) ? strut_tree_find(o.root, "parameters", NULL) : NULL;
  for (const strut_tree *key = map && map->kind == STRUT_TREE_MAP ? map->first : NULL; key;
       key = key->next->next) {
    if (strlen(key->text) != length || strncmp(key->text, c->word, length) != 0 ||
        key->next->kind != STRUT_TREE_SCALAR)
      continue;
    strut_completion value = *c;
    value.word = c->word + length + 1;
    value.kept = c->kept + (int)length + 1;
    strut_offer(&value, key->next->text, "", "as in the model");
  }
  close_model(&o);
}

void strut_offer_shapes(const strut_completion *c) {
  opened o = {.text = NULL};
  strut_offer(c, "drawn", "", "the drawn shape");
  strut_offer(c, "start", "", "where a run starts");
  if (open_model(c, &o)) {
    if (read_scene(&o))
      for (size_t i = 0; i < o.setup.scene.configuration_count; i++)
        strut_offer(c, o.setup.scene.configurations[i].name, "", "configuration");
    else
      offer_keys(c, &o, "configurations", "");
  }
  close_model(&o);
}

/* `ends` (NULL after the last) are put behind each. */
static void offer_all_nodes(const strut_completion *c, opened *o, const char *const *ends) {
  if (!o->valid && !read_scene(o)) {
    for (; *ends; ends++) offer_keys(c, o, "nodes", *ends);
    return;
  }
  for (size_t i = 0; i < o->setup.scene.node_count; i++)
    for (const char *const *end = ends; *end; end++)
      strut_offer(c, o->setup.scene.nodes[i].name, *end, "node");
}

void strut_offer_nodes(const strut_completion *c) {
  static const char *const ends[] = {"", NULL};
  opened o = {.text = NULL};
  if (open_model(c, &o)) offer_all_nodes(c, &o, ends);
  close_model(&o);
}

void strut_offer_loads(const strut_completion *c) {
  opened o = {.text = NULL};
  if (open_model(c, &o)) {
    if (read_scene(&o))
      for (size_t i = 0; i < o.setup.scene.load_count; i++)
        strut_offer(c, o.setup.scene.loads[i].name, "", "load");
    else
      offer_keys(c, &o, "loads", "");
  }
  close_model(&o);
}

void strut_offer_path_parameters(const strut_completion *c) {
  static const char *const ends[] = {".x", ".y", NULL};
  opened o = {.text = NULL};
  if (open_model(c, &o)) {
    offer_keys(c, &o, "parameters", "");
    offer_keys(c, &o, "actuators", "");
    /* names and displacements of a large structure would fill the screen */
    const char *dot = strrchr(c->word, '.');
    if (*c->word || dot) offer_all_nodes(c, &o, ends);
  }
  close_model(&o);
}

void strut_offer_columns(const strut_completion *c, const char *end) {
  char line[8192];
  FILE *file = c->model ? fopen(c->model, "r") : NULL;
  if (!file) return;
  bool read = fgets(line, sizeof line, file) != NULL;
  fclose(file);
  if (!read) return;
  line[strcspn(line, "\r\n")] = '\0';
  for (char *at = line, *next; at; at = next) {
    next = strchr(at, ',');
    if (next) *next++ = '\0';
    char *unit = strstr(at, " [");
    if (unit) *unit = '\0';
    if (!strchr(at, '"')) strut_offer(c, at, end, unit ? unit + 1 : NULL);
  }
}

const char *const strut_shells[] = {"bash", "zsh", "fish", NULL};

static const strut_option completion_options[] = {
    {STRUT_OPTION_COMPLETION, "completion", "SHELL", "bash, zsh or fish"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static const char *shell_at(const void *context, size_t i) {
  (void)context;
  return strut_shells[i];
}

static strut_status run_completion(const strut_arguments *arguments) {
  static const strut_embedded *const scripts[] = {strut_bash_script, strut_zsh_script,
                                                  strut_fish_script};
  const char *shell = strut_option_text(arguments, STRUT_OPTION_COMPLETION);
  for (size_t i = 0; strut_shells[i]; i++)
    if (strcmp(strut_shells[i], shell) == 0) return strut_print(scripts[i]->text);
  const char *near = strut_did_you_mean(shell, shell_at, NULL);
  return strut_print_usage_error(
      &strut_command_completion, "expected bash, zsh or fish, not '%s'%s%s%s", shell,
      near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

const strut_command strut_command_completion = {
    .name = "help --completion",
    .summary = "prints the completion script of a shell: bash, zsh or fish",
    .details =
        "\nThe script completes commands, options and their values: a model's own parameters "
        "after\n"
        "--set, its configurations after --at, methods after --integrator. An installed strut has "
        "it\n"
        "in place. Otherwise, for the running shell:\n\n"
        "  bash  source <(strut help --completion bash)\n"
        "  zsh   source <(strut help --completion zsh)\n"
        "  fish  strut help --completion fish | source\n",
    .options = completion_options,
    .run = run_completion,
};
