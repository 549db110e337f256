/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/write/json_writer.h"

static void begin_line(strut_json_writer *json) {
  strut_put(&json->text, json->inside ? ",\n" : json->depth ? "\n" : "");
  for (int i = 0; i < json->depth; i++) strut_put(&json->text, " ");
  json->inside = true;
}

static void begin_value(strut_json_writer *json) {
  if (!json->keyed) begin_line(json);
  json->keyed = false;
}

void strut_json_open(strut_json_writer *json, char bracket) {
  begin_value(json);
  strut_put_part(&json->text, &bracket, 1);
  json->depth++;
  json->inside = false;
}

void strut_json_close(strut_json_writer *json, char bracket) {
  json->depth--;
  if (json->inside) {
    strut_put(&json->text, "\n");
    for (int i = 0; i < json->depth; i++) strut_put(&json->text, " ");
  }
  strut_put_part(&json->text, &bracket, 1);
  json->inside = true;
}

void strut_json_key(strut_json_writer *json, const char *key) {
  begin_line(json);
  strut_put_quoted(&json->text, key);
  strut_put(&json->text, ": ");
  json->keyed = true;
}

void strut_json_put_text(strut_json_writer *json, const char *text) {
  begin_value(json);
  strut_put_quoted(&json->text, text); /* its escapes are those of JSON, too */
}

void strut_json_put_raw(strut_json_writer *json, const char *raw) {
  begin_value(json);
  strut_put(&json->text, raw);
}

char *strut_json_finish(strut_json_writer *json) {
  strut_put(&json->text, "\n");
  if (!json->text.failed) return json->text.text;
  strut_release(json->text.text);
  return NULL;
}
