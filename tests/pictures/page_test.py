# SPDX-License-Identifier: GPL-3.0-or-later
"""The page as a reader has it: it plays, scrubs, shows the recorded numbers, asks nobody for anything.

python3 page_test.py FOLDER, which page_test.sh fills.
"""

import csv
import json
import os
import pathlib
import sys
import tempfile
import time

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

folder = pathlib.Path(sys.argv[1]).resolve()
failures = []


def check(good, what):
    if not good:
        failures.append(what)
        print("FAILED:", what)


def browser(width, height):
    options = Options()
    profile = tempfile.mkdtemp(dir=folder)
    for flag in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic",
                 "--no-first-run", "--disable-background-networking",
                 "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage",
                 f"--user-data-dir={profile}", f"--window-size={width},{height}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
    driver.set_script_timeout(60)
    if width < 500:  # narrower than Chromium's windows can be
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 2, "mobile": True})
    return driver


def open_page(driver, name):
    driver.get((folder / name).as_uri())
    ready = driver.execute_async_script(
        "const done = arguments[0];"
        "window.strut.ready.then(() => done('ready'), (e) => done(String(e.stack)));")
    check(ready == "ready", f"{name}: {ready}")


def run(driver, script):
    return driver.execute_script("return " + script)


def check_silence(driver, name):
    """Nothing on the console, nothing asked of a network."""
    for entry in driver.get_log("browser"):
        if "willReadFrequently" in entry["message"]:
            continue  # this test itself looks at the pixels
        check(entry["level"] not in ("SEVERE", "WARNING"), f"{name}: console: {entry['message']}")
    asked = []
    for entry in driver.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        params = message["params"]
        # The browser's own first tab asks for its own things.
        if message["method"] == "Network.requestWillBeSent" and params["documentURL"].startswith("file:"):
            asked.append(params["request"]["url"])
    check(asked, f"{name}: the log of requests is empty: it would not show any")
    for url in asked:
        check(url.startswith(("file://" + str(folder), "data:", "blob:")), f"{name}: asks for {url}")


def recorded(name):
    with open(folder / name / "nodes.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    return [[float(cell) for cell in row] for row in rows[1:]]


def check_numbers(driver, name, rows, nodes):
    """Times are exactly the recorded ones, positions within half of what the page says."""
    frames = run(driver, "strut.frames")
    check(frames == len(rows), f"{name}: {frames} frames of {len(rows)}")
    quantum = run(driver, "strut.data.motion.position.quantum")
    worst = 0
    for frame in {0, 1, frames // 3, frames // 2, frames - 2, frames - 1}:
        driver.execute_script("strut.seek(arguments[0])", frame)
        row = rows[frame]
        check(abs(run(driver, "strut.time") - row[0]) <= 1e-12 * max(1, row[0]),
              f"{name}: frame {frame} is at {run(driver, 'strut.time')}, recorded at {row[0]}")
        shown = driver.find_element(By.ID, "clock").text.split(" s")[0]
        check(abs(float(shown) - row[0]) <= 1e-11 * max(1, row[0]),
              f"{name}: the clock shows {shown} at {row[0]}")
        columns = len(row) // nodes  # x, y and perhaps velocities, after the time
        expected = [row[1 + columns * i + d] for i in range(nodes) for d in range(2)]
        shown = run(driver, "strut.positions()")
        worst = max(worst, max(abs(a - b) for a, b in zip(expected, shown)))
    check(worst <= 0.5000001 * quantum, f"{name}: positions are off by {worst}, quantum {quantum}")
    check(quantum <= 1e-5 * run(driver, "strut.data.size"), f"{name}: quantum {quantum} is coarse")


def check_player(driver, name):
    driver.execute_script("strut.seek(0)")
    span = run(driver, "strut.data.motion.frames && [strut.time, (strut.seek(strut.frames - 1), "
                       "strut.time), strut.seek(0)]")
    speed = float(driver.find_element(By.ID, "speed").get_attribute("value"))
    begin = time.monotonic()
    driver.find_element(By.ID, "play").click()
    time.sleep(1.5)
    check(run(driver, "strut.playing"), f"{name}: does not play")
    driver.find_element(By.ID, "play").click()
    elapsed = time.monotonic() - begin
    moved = run(driver, "strut.time") - span[0]
    length = span[1] - span[0]
    expected = speed * elapsed % length
    apart = min(abs(moved - expected), length - abs(moved - expected))
    check(apart <= 0.6 * speed + 0.02 * length,
          f"{name}: played {moved} s in {elapsed:.2f} s at speed {speed} of {length} s")
    frame = run(driver, "strut.frame")
    time.sleep(0.3)
    check(frame == run(driver, "strut.frame"), f"{name}: goes on after a pause")
    scrub = driver.find_element(By.ID, "scrub")
    driver.execute_script("arguments[0].value = 7; arguments[0].dispatchEvent(new Event('input'))",
                          scrub)
    check(run(driver, "strut.frame") == 7, f"{name}: the slider does not scrub")
    body = driver.find_element(By.TAG_NAME, "body")
    for key, frame in ((Keys.ARROW_RIGHT, 8), (Keys.ARROW_LEFT, 7), (Keys.HOME, 0),
                       (Keys.END, run(driver, "strut.frames") - 1)):
        body.send_keys(key)
        check(run(driver, "strut.frame") == frame, f"{name}: key {key!r} does not go to {frame}")
    body.send_keys(Keys.SPACE)
    check(run(driver, "strut.playing"), f"{name}: space does not play")
    body.send_keys(Keys.SPACE)
    check(not run(driver, "strut.playing"), f"{name}: space does not pause")


def check_charts(driver, name):
    charts = run(driver, "strut.charts().length")
    check(charts > 0, f"{name}: no charts")
    for part in (0.25, 0.75):
        driver.execute_script("strut.seek(Math.round(arguments[0] * strut.frames))", part)
        for chart in run(driver, "strut.charts()"):
            check(abs(chart["cursor"] - chart["x"]) < 1, f"{name}: {chart['name']}: cursor is off")
    plot = driver.find_element(By.CSS_SELECTOR, ".chart .plot")
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", plot)
    driver.execute_script(
        "const b = arguments[0].getBoundingClientRect();"
        "const at = {clientX: b.left + 0.5 * b.width, clientY: b.top + 0.5 * b.height,"
        " bubbles: true, button: 0};"
        "arguments[0].dispatchEvent(new PointerEvent('pointerdown', at));"
        "window.dispatchEvent(new PointerEvent('pointerup', at));", plot)
    check(0.35 < run(driver, "strut.frame / strut.frames") < 0.65, f"{name}: a click does not seek")


def check_panels(driver):
    """A run without a search: the first chart is of what moves most, parameters are in view."""
    open_page(driver, "bouncing.html")
    first = run(driver, "Array.from(document.querySelector('.chart-title').querySelectorAll('bdi'),"
                        " (e) => e.textContent)")
    check(first == ["ball y"], f"bouncing.html: the first chart is of {first}")
    rows = [row.text for row in driver.find_elements(By.CSS_SELECTOR, "#parameters tr")]
    check(any(row.startswith("integration method ") for row in rows), f"bouncing.html: parameters {rows}")
    check(not driver.find_element(By.ID, "cards-section").is_displayed(),
          "bouncing.html: equilibria that nobody asked for")


def ink(driver):
    """Pixels of the stage that are not blank."""
    return run(driver, "(() => { const c = document.getElementById('canvas');"
                       "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
                       "let n = 0; for (let i = 3; i < d.length; i += 4) n += d[i] > 40; return n; })()")


def wait_for_drawing(driver):
    driver.execute_async_script(
        "requestAnimationFrame(() => requestAnimationFrame(() => arguments[0]()))")


def check_cards(driver, name, listed):
    cards = driver.find_elements(By.CSS_SELECTOR, ".card")
    stable = [e for e in listed if e["label"] in ("stable", "floppy")]
    left_out = run(driver, "strut.data.equilibria_left_out || 0")
    check(len(cards) + left_out >= len(stable) and cards, f"{name}: {len(cards)} cards")
    standing = [e for e in listed if e["outcome"] == "stands"]
    shown = [card for card in cards if card.is_displayed()]
    check(len(shown) == len(standing), f"{name}: {len(shown)} cards of {len(standing)} that stand")
    for card in shown[:3]:
        title = card.find_element(By.TAG_NAME, "b").text
        match = next(e for e in listed if e["name"] == title)
        driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", card)
        card.click()
        expected = [value for point in match["nodes"].values() for value in point]
        shown = run(driver, "strut.positions()")
        size = run(driver, "strut.data.size")
        worst = max(abs(a - b) for a, b in zip(expected, shown))
        check(len(expected) == len(shown) and worst < 1e-6 * size,
              f"{name}: card {title} shows another shape, off by {worst}")
        wait_for_drawing(driver)
        check(ink(driver) > 200, f"{name}: card {title} draws nothing")
    driver.find_element(By.ID, "back").click()
    check(run(driver, "strut.picked") == -1, f"{name}: no way back to the motion")


def check_layout(driver, name, width):
    wide = run(driver, "[document.documentElement.scrollWidth, document.documentElement.clientWidth]")
    check(wide[0] <= wide[1], f"{name}: {wide[0]} pixels wide in a window of {wide[1]}")
    driver.execute_script("window.scrollTo(0, 0)")
    box = run(driver, "document.getElementById('play').getBoundingClientRect()")
    height = run(driver, "window.innerHeight")
    check(box["width"] > 20 and 0 <= box["left"] and box["right"] <= wide[1] and box["bottom"] <= height,
          f"{name}: the play button is not in view at {width} pixels: {box}, {height}")


HOSTILE = ["</script><script>alert(3)</script>", "<img src=x onerror=alert(4)>",
           "שלום & \"مرحبا\"", "<b onmouseover=alert(5)>", "'; alert(6); '"]


def make_hostile_names(path):
    """Puts names into a page that strut's language would refuse, escaped as strut escapes texts."""
    page = path.read_text(encoding="utf-8")
    begin = page.index(">", page.index('id="strut-data"')) + 1
    end = page.index("</script>", begin)
    data = json.loads(page[begin:end])
    for i, node in enumerate(data["nodes"]):
        node["name"] = HOSTILE[i]
    for i, member in enumerate(data["members"]):
        member["name"] = HOSTILE[3 + i]
    text = json.dumps(data).replace("<", "\\u003c")
    path.write_text(page[:begin] + text + page[end:], encoding="utf-8")


def check_hostile(driver):
    name = "hostile.html"
    make_hostile_names(folder / name)
    open_page(driver, name)
    title = "</script><script>alert(1)</script><b>bold</b> & \"quoted\" 'too' <!-- מבנה"
    check(driver.find_element(By.ID, "name").text == title, f"{name}: the name reads differently")
    check(driver.title.strip() == title, f"{name}: the title reads {driver.title}")
    check(not driver.find_elements(By.CSS_SELECTOR, "img, svg, b[onmouseover], #name *, #source *"),
          f"{name}: a name became an element")
    scripts = run(driver, "Array.from(document.scripts, (s) => s.textContent.slice(0, 40))")
    check(not any("alert" in text for text in scripts), f"{name}: a name became a script")
    names = run(driver, "strut.data.nodes.map((n) => n.name)")
    check(names == HOSTILE[:3], f"{name}: names are {names}")
    yaml = run(driver, "document.getElementById('yaml').textContent")
    check("<img src=x onerror=alert(2)>" in yaml, f"{name}: the scene's text is not literal")
    legend = run(driver, "Array.from(document.querySelectorAll('.chart-title bdi'), (e) => e.textContent)")
    check(HOSTILE[3] in legend, f"{name}: the charts are of {legend}")
    wait_for_drawing(driver)
    check(ink(driver) > 200, f"{name}: nothing is drawn")
    check_silence(driver, name)


def check_camera(driver, name):
    """All nodes of all frames stand on the stage, the camera following."""
    outside = driver.execute_script("""
      const s = window.strut, canvas = document.getElementById("canvas"), bad = [];
      for (let f = 0; f < s.frames; f += 7) {
        s.seek(f);
        const at = s.onStage();
        for (let i = 0; i < at.length; i += 2)
          if (!(at[i] >= 0 && at[i] <= canvas.clientWidth && at[i + 1] >= 0 &&
                at[i + 1] <= canvas.clientHeight)) bad.push([f, i / 2, at[i], at[i + 1]]);
      }
      return bad;""")
    check(not outside, f"{name}: nodes outside the picture: {outside[:3]}")


def check_damaged(driver):
    """A page cut by a disk or a mail program says so."""
    text = (folder / "two-mass.html").read_text(encoding="utf-8")
    begin = text.index('"bytes":"', text.index('"position"')) + len('"bytes":"')
    (folder / "damaged.html").write_text(text[:begin] + text[begin + 400:], encoding="utf-8")
    driver.get((folder / "damaged.html").as_uri())
    driver.execute_async_script("window.strut.ready.then(arguments[0], () => arguments[0]())")
    said = driver.find_element(By.ID, "trouble").text
    check("damaged" in said, f"damaged.html: a damaged page says {said!r}")
    driver.get_log("browser")


def check_run(driver, width):
    open_page(driver, "crawler.html")
    check_layout(driver, "crawler.html", width)
    wait_for_drawing(driver)
    check(ink(driver) > 500, "crawler.html: nothing is drawn")
    check_numbers(driver, "crawler.html", recorded("crawler"), 5)
    check_player(driver, "crawler.html")
    check_charts(driver, "crawler.html")
    check_camera(driver, "crawler.html")
    listed = json.loads((folder / "crawler.json").read_text(encoding="utf-8"))["equilibria"]
    check_cards(driver, "crawler.html", listed)
    check_silence(driver, "crawler.html")


def main():
    for width, height in ((1280, 800), (360, 780)):
        driver = browser(width, height)
        try:
            check_run(driver, width)
            if width > 1000:
                open_page(driver, "two-mass.html")
                check_numbers(driver, "two-mass.html", recorded("two-mass"), 2)
                check_player(driver, "two-mass.html")
                check_silence(driver, "two-mass.html")
                open_page(driver, "model.html")
                wait_for_drawing(driver)
                check(ink(driver) > 200 and run(driver, "strut.frames") == 0,
                      "model.html: a model at rest is not drawn")
                check_silence(driver, "model.html")
                check_panels(driver)
                check_hostile(driver)
                check_damaged(driver)
        finally:
            driver.quit()
    print(f"{len(failures)} failures")
    return 1 if failures else 0


os.environ.setdefault("SE_OFFLINE", "true")  # Selenium is not to look for drivers elsewhere
sys.exit(main())
