// SPDX-License-Identifier: GPL-3.0-or-later
// The button for the theme, the section in view in the table of contents, figures by themselves, and scenes in the
// playground beside the text.
"use strict";

function nextTheme(theme) {
  const preferred = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  const other = preferred === "dark" ? "light" : "dark";
  return { auto: other, [other]: preferred, [preferred]: "auto" }[theme] || "auto";
}

function markSection() {
  const links = [...document.querySelectorAll(".toc-tree a[href^='#']")].filter((a) => a.hash.length > 1);
  let current = null;
  for (const link of links) {
    const section = document.getElementById(decodeURIComponent(link.hash.slice(1)));
    if (section && section.getBoundingClientRect().top < 100) current = link;
  }
  for (const link of links) link.parentElement.classList.toggle("scroll-current", link === current);
}

const ROOM_FOR_TWO = 1000; // [px] of a window that shows the playground beside the text

function closePlayground() {
  document.getElementById("playground")?.remove();
  document.body.classList.remove("trying");
}

function openPlayground(link) {
  closePlayground();
  const panel = document.createElement("aside"), close = document.createElement("button");
  const frame = document.createElement("iframe");
  panel.id = "playground";
  close.type = "button";
  close.textContent = "Close";
  close.addEventListener("click", () => {
    closePlayground();
    link.focus();
  });
  frame.title = "Playground: " + link.textContent;
  frame.src = link.href + "&embed=1";
  panel.append(close, frame);
  document.body.append(panel);
  document.body.classList.add("trying");
  link.scrollIntoView({ block: "nearest" });
  close.focus();
}

addEventListener("DOMContentLoaded", () => {
  for (const link of document.querySelectorAll("a.try")) { // narrow windows follow the link
    link.addEventListener("click", (event) => {
      if (innerWidth < ROOM_FOR_TWO || event.ctrlKey || event.metaKey || event.shiftKey) return;
      event.preventDefault();
      openPlayground(link);
    });
  }
  document.documentElement.classList.remove("no-js");
  for (const button of document.getElementsByClassName("theme-toggle")) {
    button.addEventListener("click", () => {
      const theme = nextTheme(document.body.dataset.theme);
      document.body.dataset.theme = theme;
      localStorage.setItem("theme", theme);
    });
  }
  for (const image of document.querySelectorAll(".figures img")) { // a tap shows it in full size
    const link = document.createElement("a");
    link.href = image.src;
    image.replaceWith(link);
    link.append(image);
  }
  let asked = false;
  addEventListener("scroll", () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      markSection();
    });
  }, { passive: true });
  markSection();
});
