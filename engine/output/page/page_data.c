/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The page's data: one JSON object, safe inside <script>. */
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/page/page_parts.h"
#include "engine/output/summary_rows.h"

struct cJSON;

static const size_t MOST_BYTES = 4000000, MOST_YAML = 600000;

static void add_nodes(strut_json *json, const strut_scene *scene) {
  struct cJSON *nodes = strut_json_array(json, json->root, "nodes");
  for (size_t i = 0; i < scene->node_count; i++) {
    struct cJSON *node = strut_json_object(json, nodes, NULL);
    strut_json_text(json, node, "name", scene->nodes[i].name);
    struct cJSON *fixed = strut_json_array(json, node, "fixed");
    for (int c = 0; c < 2; c++) strut_json_bool(json, fixed, NULL, scene->nodes[i].fixed[c]);
  }
}

static void add_members(strut_json *json, const strut_scene *scene) {
  static const char *const kinds[] = {"bar", "spring", "cable"};
  struct cJSON *members = strut_json_array(json, json->root, "members");
  for (size_t i = 0; i < scene->member_count; i++) {
    const strut_member *member = &scene->members[i];
    struct cJSON *to = strut_json_object(json, members, NULL);
    strut_json_text(json, to, "name", member->name);
    strut_json_integer(json, to, "from", member->node[0]);
    strut_json_integer(json, to, "to", member->node[1]);
    strut_json_text(json, to, "kind", kinds[member->kind]);
  }
}

static void add_ground(strut_json *json, const strut_scene *scene) {
  struct cJSON *contacts = strut_json_array(json, json->root, "contacts");
  for (size_t i = 0; i < scene->contact_count; i++)
    strut_json_integer(json, contacts, NULL, scene->contacts[i].node);
  if (!scene->ground.present) {
    strut_json_text(json, json->root, "ground", NULL);
    return;
  }
  struct cJSON *ground = strut_json_object(json, json->root, "ground");
  strut_json_number(json, ground, "height", scene->ground.height);
  strut_json_number(json, ground, "slope", scene->ground.slope);
  strut_json_number(json, ground, "belt_speed", scene->ground.belt_speed);
}

/* The scene's text; of a very long one its beginning, up to the end of a line. */
static bool add_yaml(strut_json *json, const char *yaml) {
  size_t length = strlen(yaml), kept = length;
  if (length > MOST_YAML) {
    kept = MOST_YAML;
    while (kept > 0 && yaml[kept - 1] != '\n') kept--;
  }
  strut_buffer text = {0};
  strut_buffer_add(&text, "%.*s", (int)kept, yaml);
  if (kept < length)
    strut_buffer_add(&text, "# ... and %zu bytes more, which are left out here\n", length - kept);
  char *shown = strut_buffer_take(&text);
  if (shown) strut_json_text(json, json->root, "yaml", shown);
  strut_release(shown);
  return shown;
}

/* Everything but the motion. */
static char *still_data(const strut_page *page) {
  const strut_model *model = page->model;
  const strut_scene *scene = model->scene;
  strut_json json = strut_json_begin();
  strut_json_text(&json, json.root, "strut", STRUT_VERSION);
  strut_json_text(&json, json.root, "name", scene->name);
  strut_json_text(&json, json.root, "description", scene->description);
  strut_json_text(&json, json.root, "source", scene->source);
  add_nodes(&json, scene);
  add_members(&json, scene);
  add_ground(&json, scene);
  strut_json_numbers(&json, json.root, "start", model->start, 2 * (size_t)model->node_count);
  strut_json_number(&json, json.root, "size", model->size);
  if (!strut_page_add_equilibria(&json, page)) json.failed = true;
  struct cJSON *rows = strut_json_array(&json, json.root, "summary");
  strut_summary_rows(&json, rows, page->summary, page->experiment, scene);
  if (!add_yaml(&json, page->yaml)) json.failed = true;
  strut_json_text(&json, json.root, "study", NULL);
  return strut_json_end(&json);
}

/* Bytes that JSON needs nowhere but in its texts, where an escape says the same; or NULL. */
static const char *escape(const unsigned char *at, size_t *taken) {
  *taken = 1;
  switch (*at) {
    case '<': return "\\u003c";
    case '>': return "\\u003e";
    case '&': return "\\u0026";
    case 0xe2:
      if (at[1] != 0x80 || (at[2] != 0xa8 && at[2] != 0xa9)) return NULL;
      *taken = 3;
      return at[2] == 0xa8 ? "\\u2028" : "\\u2029";
    default: return NULL;
  }
}

/* Appends JSON as it may stand in <script>, without what cJSON puts between things: the end of a
   line and a tab are never within a text. */
static void add_safe(strut_buffer *buffer, const char *json) {
  const char *from = json;
  for (const char *at = json;; at++) {
    size_t taken = 1;
    const char *other = *at == '\n' || *at == '\t' ? "" : escape((const unsigned char *)at, &taken);
    if (*at && !other) continue;
    strut_buffer_add(buffer, "%.*s%s", (int)(at - from), from, other ? other : "");
    if (!*at) return;
    at += taken - 1;
    from = at + 1;
  }
}

char *strut_page_data(const strut_page *page, strut_page_frames *frames) {
  size_t most = page->most_bytes ? page->most_bytes : MOST_BYTES;
  char *still = still_data(page);
  strut_buffer buffer = {0};
  if (!still) return NULL;
  add_safe(&buffer, still);
  strut_release(still);
  if (buffer.failed) {
    strut_release(strut_buffer_take(&buffer));
    return NULL;
  }
  size_t room = most > 2 * buffer.length ? most - buffer.length : most / 2;
  buffer.text[--buffer.length] = '\0'; /* its last brace; the motion comes before it */
  strut_buffer_add(&buffer, ",\"motion\":");
  strut_page_add_motion(&buffer, page, room, frames);
  strut_buffer_add(&buffer, "}\n");
  return strut_buffer_take(&buffer);
}
