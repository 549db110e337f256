# SPDX-License-Identifier: GPL-3.0-or-later
"""The documentation site in a real browser, from files, without a web server: on a phone nothing is wider than the
screen, every image is there, both themes have readable text, and the search finds.

    python3 tests/site_browser_test.py SITE [SHOTS]

SITE is what site_test.py or the target `site` built. With SHOTS pictures of pages are written there. Exits with 77
where there is no Chromium, no Selenium or no site.
"""
import base64
import pathlib
import shutil
import sys
import tempfile
import time

site = pathlib.Path(sys.argv[1]).resolve()
shots = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
SHOWN = ("index", "tutorial", "language", "language-keys", "gallery", "paper", "comparison", "cheat-sheet", "theory",
         "joss/paper", "dev/recipes", "source/models/basics/belt.yaml")
CONTRAST_NEEDED = 4.5  # by WCAG 2.1, level AA
failures = 0

for program in ("chromium", "chromedriver"):
    if not shutil.which(program):
        print("skipped: there is no", program)
        sys.exit(77)
try:
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
except ImportError:
    print("skipped: there is no python3-selenium")
    sys.exit(77)
if not (site / "index.html").is_file():
    print("skipped: there is no site in", site)
    sys.exit(77)


def fail(text):
    global failures
    failures += 1
    print("FAILED:", text)


def browser(profile):
    options = Options()
    for flag in ("--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
                 "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage", "--hide-scrollbars",
                 f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)


def set_screen(driver, width, theme):
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
        "features": [{"name": "prefers-color-scheme", "value": theme}]})
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
        "width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 500})


def open_page(driver, name, query=""):
    driver.get((site / f"{name}.html").as_uri() + query)


# Elements that stick out of the window and are in no box that scrolls.
STICKING_OUT = """
const wide = [];
for (const element of document.querySelectorAll("article *")) {
  if (element.getBoundingClientRect().right <= innerWidth + 1) continue;
  let box = element;
  while (box && !/auto|scroll|hidden/.test(getComputedStyle(box).overflowX)) box = box.parentElement;
  if (!box || box === document.body || box === document.documentElement) wide.push(element.outerHTML.slice(0, 100));
}
return [document.documentElement.scrollWidth, wide.slice(0, 3)];
"""

# Ratios of brightness between a page's texts and what is behind them, as WCAG defines them; the lowest.
CONTRAST = """
const channel = (c) => (c /= 255, c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
const parse = (text) => text.match(/[\\d.]+/g).map(Number);
const bright = ([r, g, b]) => 0.2126 * channel(r) + 0.7152 * channel(g) + 0.0722 * channel(b);
const behind = (element) => {
  for (; element; element = element.parentElement) {
    const color = parse(getComputedStyle(element).backgroundColor);
    if (color.length === 3 || color[3] > 0.99) return color;
  }
  return [255, 255, 255];
};
let lowest = [21, ""];
for (const element of document.querySelectorAll("article *, .sidebar-tree a")) {
  if (![...element.childNodes].some((node) => node.nodeType === 3 && node.data.trim())) continue;
  if (element.closest(".headerlink") || !element.getClientRects().length) continue;
  const ground = behind(element), color = parse(getComputedStyle(element).color);
  const alpha = color.length > 3 ? color[3] : 1;
  const seen = color.slice(0, 3).map((c, i) => alpha * c + (1 - alpha) * ground[i]);
  const [a, b] = [bright(seen), bright(ground)];
  const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  if (ratio < lowest[0]) lowest = [ratio, element.outerHTML.slice(0, 100)];
}
return [...lowest, bright(behind(document.querySelector("article")))];
"""


def check_phone(driver):
    set_screen(driver, 400, "light")
    names = sorted(path.relative_to(site).with_suffix("").as_posix() for path in site.rglob("*.html")
                   if path.name != "try.html")
    sources = [name for name in names if name.startswith("source/")]  # files shown, one like the other
    for name in sorted({*names} - {*sources}) + sources[::10]:
        open_page(driver, name)
        width, wide = driver.execute_script(STICKING_OUT)
        if width > 400 or wide:
            fail(f"{name}: {width} wide on a screen of 400: {wide}")
        broken = driver.execute_script(
            "return [...document.images].filter((i) => !i.complete || i.naturalWidth < 20).map((i) => i.src)")
        if broken:
            fail(f"{name}: images that do not show: {broken}")
    for entry in driver.get_log("browser"):
        if entry["level"] == "SEVERE":
            fail(f"the browser complains: {entry['message']}")


def check_themes(driver):
    for theme in ("light", "dark"):
        set_screen(driver, 1280, theme)
        for name in SHOWN:
            open_page(driver, name)
            ratio, element, ground = driver.execute_script(CONTRAST)
            if ratio < CONTRAST_NEEDED:
                fail(f"{name}, {theme}: text with a contrast of {ratio:.1f}: {element}")
            if (ground > 0.5) != (theme == "light"):
                fail(f"{name}: its ground in the {theme} theme has brightness {ground:.2f}")
    # The button goes from what the reader prefers (dark) to light, and other pages remember it.
    driver.execute_script("document.querySelector('.content-icon-container .theme-toggle').click()")
    open_page(driver, "index")
    if driver.execute_script(CONTRAST)[2] < 0.5:
        fail("the button for the light theme has no effect")
    driver.execute_script("localStorage.clear()")


def check_search(driver):
    for words, wanted in (("stick-slip", "gallery.html"), ("belt_speed", "language-keys.html")):
        open_page(driver, "find", "?q=" + words)
        for _ in range(100):
            time.sleep(0.1)
            found = driver.execute_script(
                "return [...document.querySelectorAll('#search-results li a')].map((a) => a.href)")
            if any(wanted in link for link in found):
                break
        else:
            fail(f"the search for {words} finds {found}, not {wanted}")


def take_shots(driver):
    shots.mkdir(parents=True, exist_ok=True)
    for kind, width, theme in (("light", 1280, "light"), ("dark", 1280, "dark"), ("phone", 400, "light")):
        set_screen(driver, width, theme)
        for name in SHOWN:
            open_page(driver, name)
            height = driver.execute_script("return document.documentElement.scrollHeight")
            picture = driver.execute_cdp_cmd("Page.captureScreenshot", {
                "captureBeyondViewport": True,
                "clip": {"x": 0, "y": 0, "width": width, "height": min(height, 2500), "scale": 1}})
            (shots / f"{name.replace('/', '-')}-{kind}.png").write_bytes(base64.b64decode(picture["data"]))
    print("pictures in", shots)


profile = tempfile.mkdtemp()
driver = browser(profile)
try:
    check_phone(driver)
    check_themes(driver)
    check_search(driver)
    if shots:
        take_shots(driver)
finally:
    driver.quit()
    shutil.rmtree(profile, ignore_errors=True)
sys.exit(failures > 0)
