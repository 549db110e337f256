/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/page/page.h"

#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/buffer.h"

/*
 * The page put together: the template with the data and everything it needs inside.
 *
 * The parts that are the same for every run are embedded at build time; each ends with a row of NULL. In the
 * template, page.html, four comments are replaced: strut:title by the title's text, strut:style by <style>
 * elements, strut:data by the <script> element of the data, strut:scripts by <script> elements.
 */
extern const strut_embedded strut_page_template[], strut_page_styles[];
extern const strut_embedded strut_page_notice[];  /* of dygraphs: whose it is, and its licence */
extern const strut_embedded strut_page_scripts[]; /* in the order in which they run */

/* Appends a text, escaped for HTML. */
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

static void add_scripts(strut_buffer *to) {
  strut_buffer_add(to, "<!--\n%s-->\n", strut_page_notice->text);
  add_elements(to, strut_page_scripts, "script");
}

static void add_data(strut_buffer *to, const char *id, const char *data) {
  strut_buffer_add(to, "<script type=\"application/json\" id=\"%s\">\n%s</script>\n", id, data);
}

/* Appends the replacement of <!--strut:NAME-->; `name` begins with NAME. `data` are of the page and,
   or NULL, of what is beside it. */
static void add_part(strut_buffer *to, const strut_page *page, const char *name,
                     char *const data[2]) {
  const char *title = page->model->scene->name;
  if (strncmp(name, "title", 5) == 0) {
    add_text(to, *title ? title : "strut");
  } else if (strncmp(name, "style", 5) == 0) {
    add_elements(to, strut_page_styles, "style");
  } else if (strncmp(name, "data", 4) == 0) {
    add_data(to, "strut-data", data[0]);
    if (data[1]) add_data(to, "strut-beside", data[1]);
  } else if (strncmp(name, "scripts", 7) == 0) {
    add_scripts(to);
  }
}

/* The template with its comments replaced, or NULL when memory is out. */
static char *fill_template(const strut_page *page, char *const data[2]) {
  static const char open[] = "<!--strut:", close[] = "-->";
  strut_buffer html = {0};
  const char *at = strut_page_template->text, *next;
  while ((next = strstr(at, open)) != NULL) {
    strut_buffer_add(&html, "%.*s", (int)(next - at), at);
    add_part(&html, page, next + strlen(open), data);
    at = strstr(next, close) + strlen(close);
  }
  strut_buffer_add(&html, "%s", at);
  return strut_buffer_take(&html);
}

char *strut_page_html(const strut_page *page, strut_page_frames *frames, strut_error *error) {
  const strut_page *pages[2] = {page, page->beside};
  char *data[2] = {NULL, NULL}, *html = NULL;
  bool good = true;
  for (int i = 0; i < 2 && pages[i] && good; i++) {
    data[i] = strut_page_data(pages[i], frames ? &frames[i] : NULL, error);
    good = data[i] != NULL;
  }
  if (good) {
    html = fill_template(page, data);
    if (!html) strut_no_memory(error, "for the page");
  }
  for (int i = 0; i < 2; i++) strut_release(data[i]);
  return html;
}
