/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <string.h>

#include "parser/document_parts.h"
#include "parser/text.h"

/* What libyaml says, in whose context, and what a person wants to hear. */
static const struct rule {
  const char *problem, *context; /* stretches of libyaml's words; NULL: any */
  bool at_context;               /* the place is where the context begins */
  const char *begun;             /* appended with the context's line, or NULL */
  const char *message;
} rules[] = {
    {"mapping values are not allowed", NULL, false, NULL,
     "unexpected ':'; a key begins a new line, and a text that holds ': ' needs quotes"},
    {"tab character", NULL, false, NULL, "a tab is not allowed as indentation; use spaces"},
    {"end of stream", "quoted scalar", true, NULL, "this quote is never closed"},
    {"document indicator", "quoted scalar", true, NULL, "this quote is not closed"},
    {"expected ',' or ']'", NULL, false, "the list begun", "expected ',' or ']'"},
    {"expected ',' or '}'", NULL, false, "the mapping begun", "expected ',' or '}'"},
    {"could not find expected ':'", NULL, true, NULL, "expected ':' and a value behind this key"},
    {"expected key", NULL, false, "the mapping begun",
     "expected a key at the same indentation as the other keys"},
    {"expected '-' indicator", NULL, false, "the list begun",
     "expected '- ' at the same indentation as the other items"},
    {"block sequence entries are not allowed", NULL, false, NULL,
     "a '- ' item is not allowed here; begin it on a new line, or write [a, b]"},
    {"mapping keys are not allowed", NULL, false, NULL, "a '? ' key is not allowed here"},
    {"expected node content", NULL, false, NULL, "a value is missing here"},
    {"unknown escape character", NULL, false, NULL,
     "unknown escape; in double quotes a backslash is written '\\\\'"},
    {"hexdecimal number", "quoted scalar", false, NULL, "an escape lacks hexadecimal digits"},
    {"invalid Unicode", NULL, false, NULL, "the escape is not a character of Unicode"},
    {"alphabetic or numeric character", "anchor", false, NULL,
     "expected a name behind '&'; a text that begins with '&' needs quotes"},
    {"alphabetic or numeric character", "alias", false, NULL,
     "expected a name behind '*'; a text that begins with '*' needs quotes"},
    {NULL, "tag", false, NULL, "tags (words that begin with '!') are not allowed"},
    {"undefined tag handle", NULL, false, NULL, "tags (words that begin with '!') are not allowed"},
    {"incompatible YAML document", NULL, false, NULL, "only YAML 1.1 and 1.2 can be read"},
    {"version", "directive", false, NULL, "expected '%YAML 1.2'"},
    {"<document start>", NULL, false, NULL, "expected '---' behind a %YAML line"},
    {"block scalar", NULL, false, NULL, "expected '|' or '>' and then a new line"},
};

static bool has(const char *text, const char *part) {
  return !part || (text && strstr(text, part));
}

static strut_place place_at(const strut_diagnostics *diagnostics, yaml_mark_t mark, char *here) {
  strut_cursor cursor = strut_cursor_begin(diagnostics->text, diagnostics->length);
  strut_cursor_to_index(&cursor, mark.index);
  *here = cursor.offset < cursor.length ? cursor.text[cursor.offset] : '\0';
  return (strut_place){(uint32_t)mark.line + 1, (uint32_t)mark.column + 1, 1};
}

/* "found character that cannot start any token" */
static void report_start(strut_diagnostics *diagnostics, strut_place place, char here) {
  if (here == '\t')
    strut_diagnose(diagnostics, place, "a tab is not allowed as indentation; use spaces");
  else
    strut_diagnose(diagnostics, place, "a value cannot begin with '%c'; put it in quotes", here);
}

/* Where a list or mapping is open at the end of the text, its beginning is the place of interest. */
static bool report_open(const yaml_parser_t *parser, strut_diagnostics *diagnostics, char here) {
  bool list = has(parser->problem, "expected ',' or ']'");
  if (here != '\0' || (!list && !has(parser->problem, "expected ',' or '}'"))) return false;
  strut_place place = place_at(diagnostics, parser->context_mark, &here);
  strut_diagnose(diagnostics, place, "this '%c' is never closed", list ? '[' : '{');
  return true;
}

bool strut_document_syntax_error(const yaml_parser_t *parser, strut_diagnostics *diagnostics) {
  if (parser->error == YAML_MEMORY_ERROR) return false;
  char here;
  strut_place place = place_at(diagnostics, parser->problem_mark, &here);
  if (has(parser->problem, "cannot start any token")) {
    report_start(diagnostics, place, here);
    return true;
  }
  if (report_open(parser, diagnostics, here)) return true;
  for (size_t i = 0; i < sizeof rules / sizeof rules[0]; i++) {
    const struct rule *rule = &rules[i];
    if (!has(parser->problem, rule->problem) || !has(parser->context, rule->context)) continue;
    if (rule->at_context) place = place_at(diagnostics, parser->context_mark, &here);
    if (rule->begun)
      strut_diagnose(diagnostics, place, "%s (%s in line %zu)", rule->message, rule->begun,
                     parser->context_mark.line + 1);
    else
      strut_diagnose(diagnostics, place, "%s", rule->message);
    return true;
  }
  strut_diagnose(diagnostics, place, "not valid YAML: %s%s%s",
                 parser->problem ? parser->problem : "unknown trouble", parser->context ? " " : "",
                 parser->context ? parser->context : "");
  return true;
}
