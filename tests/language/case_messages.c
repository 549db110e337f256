/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/language/case_messages.h"

#include "tests/support/test.h"

void split_settings(faulty_case *c, strut_setting *settings) {
  for (size_t i = 0; i < c->set_count; i++) {
    char *equals = strchr(c->set[i], '=');
    *equals = '\0';
    settings[i] = (strut_setting){.name = c->set[i], .text = equals + 1};
  }
}

static size_t strike(faulty_case *c, const char *where, strut_place place, const char *message) {
  char line[1200];
  snprintf(line, sizeof line, "%s%u:%u: %s", where, place.line, place.column, message);
  for (size_t k = 0; k < c->message_count; k++)
    if (strcmp(c->message[k], line) == 0) {
      c->message[k][0] = '\0';
      return 0;
    }
  print_error("%s: %s: not expected: %s\n", c->document, c->name, line);
  return 1;
}

size_t strike_messages(faulty_case *c, const strut_diagnostics *found,
                       const char *(*file_of)(const strut_diagnostics *, strut_place)) {
  size_t wrong = 0;
  for (size_t i = 0; i < found->count; i++) {
    const strut_diagnostic *d = &found->items[i];
    wrong += strike(c, file_of ? file_of(found, d->place) : "", d->place, d->message);
    for (size_t k = 0; k < STRUT_MESSAGE_NOTES && d->note[k]; k++)
      wrong += strike(c, "note: ", d->note_place[k], d->note[k]);
  }
  return wrong;
}

size_t missing_messages(const faulty_case *c) {
  size_t missing = 0;
  for (size_t i = 0; i < c->message_count; i++) {
    if (!c->message[i][0]) continue;
    print_error("%s: %s: not found: %s\n", c->document, c->name, c->message[i]);
    missing++;
  }
  return missing;
}
