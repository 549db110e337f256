/* SPDX-License-Identifier: GPL-3.0-or-later */
/* TIOCGWINSZ is not in POSIX 2008; without it COLUMNS tells. */
#define _DEFAULT_SOURCE 1
#include "parser/cli/terminal.h"

#include <langinfo.h>
#include <locale.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/ioctl.h>
#include <unistd.h>

static bool says_utf8(const char *name) {
  for (; *name; name++)
    if (strncasecmp(name, "utf-8", 5) == 0 || strncasecmp(name, "utf8", 4) == 0) return true;
  return false;
}

/* The name of the locale of letters; a locale that is not installed still has one. */
static const char *locale_name(void) {
  static const char *const variables[] = {"LC_ALL", "LC_CTYPE", "LANG"};
  for (size_t i = 0; i < sizeof variables / sizeof variables[0]; i++) {
    const char *value = getenv(variables[i]);
    if (value && *value) return value;
  }
  return "C";
}

bool strut_terminal_unicode(void) {
  locale_t locale = newlocale(LC_CTYPE_MASK, "", (locale_t)0);
  if (locale == (locale_t)0) return says_utf8(locale_name());
  bool unicode = says_utf8(nl_langinfo_l(CODESET, locale));
  freelocale(locale);
  return unicode;
}

int strut_terminal_columns(int descriptor, int usual) {
#ifdef TIOCGWINSZ
  struct winsize size = {0};
  if (ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return (int)size.ws_col;
#else
  (void)descriptor;
#endif
  const char *text = getenv("COLUMNS");
  long columns = text ? strtol(text, NULL, 10) : 0;
  return columns > 0 && columns < 10000 ? (int)columns : usual;
}
