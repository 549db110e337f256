/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The page put together: the template with the data and everything it needs inside. */
#include "engine/output/page/page.h"

#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/page/page_assets.h"
#include "engine/output/page/page_parts.h"

/* A text as it may stand between tags. */
static void add_text(strut_buffer *to, const char *text) {
  for (; *text; text++) {
    switch (*text) {
      case '<': strut_buffer_add(to, "&lt;"); break;
      case '>': strut_buffer_add(to, "&gt;"); break;
      case '&': strut_buffer_add(to, "&amp;"); break;
      default: strut_buffer_add(to, "%c", *text);
    }
  }
}

static void add_elements(strut_buffer *to, const strut_embedded *files, const char *element) {
  for (; files->text; files++)
    strut_buffer_add(to, "<%s>\n%s</%s>\n", element, files->text, element);
}

/* What takes the place of <!--strut:NAME-->, of which name begins with NAME. */
static void add_part(strut_buffer *to, const strut_page *page, const char *name, const char *data) {
  const char *title = page->model->scene->name;
  if (strncmp(name, "title", 5) == 0) {
    add_text(to, *title ? title : "strut");
  } else if (strncmp(name, "style", 5) == 0) {
    add_elements(to, strut_page_styles, "style");
  } else if (strncmp(name, "data", 4) == 0) {
    strut_buffer_add(to, "<script type=\"application/json\" id=\"strut-data\">\n");
    strut_buffer_add(to, "%s</script>\n", data);
  } else if (strncmp(name, "scripts", 7) == 0) {
    strut_buffer_add(to, "<!--\n%s-->\n", strut_page_notice->text);
    add_elements(to, strut_page_scripts, "script");
  }
}

char *strut_page_html(const strut_page *page, strut_page_frames *frames, strut_error *error) {
  static const char open[] = "<!--strut:", close[] = "-->";
  strut_page_frames taken = {0};
  char *data = strut_page_data(page, &taken);
  strut_buffer html = {0};
  const char *at = strut_page_template->text, *next;
  if (!data) {
    strut_fail(error, STRUT_NO_MEMORY, "out of memory for the page");
    return NULL;
  }
  while ((next = strstr(at, open)) != NULL) {
    strut_buffer_add(&html, "%.*s", (int)(next - at), at);
    add_part(&html, page, next + strlen(open), data);
    at = strstr(next, close) + strlen(close);
  }
  strut_buffer_add(&html, "%s", at);
  strut_release(data);
  char *text = strut_buffer_take(&html);
  if (!text) strut_fail(error, STRUT_NO_MEMORY, "out of memory for the page");
  if (frames) *frames = taken;
  return text;
}
