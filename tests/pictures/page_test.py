# SPDX-License-Identifier: GPL-3.0-or-later
"""The page as a reader has it: it plays, scrubs, shows the recorded numbers, asks nobody for anything.

python3 page_test.py FOLDER, which page_test.sh fills.
"""

import csv
import json
import struct
import time

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from page_driver import (SVG, browser, check_silence, clock, files_of, folder, ink, open_page, press_save,
                         recorded, run, saved_svg, wait_for_drawing)
from testing import check, finish


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
        shown = clock(driver)
        digits = len(shown.partition(".")[2])
        check(abs(float(shown) - row[0]) <= 0.50001 * 10 ** -digits, f"{name}: the clock shows {shown} at {row[0]}")
        columns = len(row) // nodes  # x, y and perhaps velocities, after the time
        expected = [row[1 + columns * i + d] for i in range(nodes) for d in range(2)]
        shown = run(driver, "strut.positions()")
        worst = max(worst, max(abs(a - b) for a, b in zip(expected, shown)))
    check(worst <= 0.5000001 * quantum, f"{name}: positions are off by {worst}, quantum {quantum}")
    check(quantum <= 1e-5 * run(driver, "strut.data.size"), f"{name}: quantum {quantum} is coarse")


def check_clock(driver, name):
    """Neighbouring frames have different times, of one width and no more digits than that takes."""
    texts = driver.execute_script("""
      const all = [];
      for (let f = 0; f < Math.min(strut.frames, 200); f++) {
        strut.seek(f);
        all.push(document.querySelector("#clock b").textContent);
      }
      return all;""")
    check(len(set(texts)) == len(texts), f"{name}: the clock shows the same for two frames")
    check(len({len(text) for text in texts}) == 1, f"{name}: the clock's width changes: {texts[:3]}")
    digits = len(clock(driver).partition(".")[2])
    fewer = {f"{float(text.split()[0]):.{max(digits - 1, 0)}f}" for text in texts}
    check(digits <= 6 and (digits == 0 or len(fewer) < len(texts)), f"{name}: {texts[0]}")
    times = [0.123456789012, 0.223456789012, 0.3234567891]
    check(run(driver, f"strutPage.decimalsOf({times})") == 1, "too many digits of uneven times")
    check(run(driver, "strutPage.decimalsOf([0, 1e-9])") == 6, "more than six digits")


def check_names_below_clock(driver, name):
    """No name of a node lies on the time or the number of the frame."""
    covered = driver.execute_async_script("""
      const kind = CanvasRenderingContext2D.prototype, own = kind.fillText, found = [], done = arguments[0];
      const clock = document.querySelector("#clock"), right = clock.offsetLeft + clock.offsetWidth;
      kind.fillText = function (text, x, y) {
        const wide = this.measureText(text).width;
        const left = x - { left: 0, right: wide }[this.textAlign] ?? wide / 2;
        if (this.canvas.id === "canvas" && left < right && y - 6 < clock.offsetTop + clock.offsetHeight) found.push(text);
        own.call(this, text, x, y);
      };
      strut.seek(0);
      requestAnimationFrame(() => requestAnimationFrame(() => { kind.fillText = own; done(found); }));""")
    check(not covered, f"{name}: {covered} on the clock")


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
    driver.execute_script("arguments[0].value = 7; arguments[0].dispatchEvent(new Event('input'))", scrub)
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
    data["motion"]["force"]["names"] = HOSTILE[3:3 + len(data["members"])]
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
    texts = [text.text for text in saved_svg(driver, name).iter(SVG + "text")]
    shortened = [text if len(text) <= 24 else text[:23] + "\u2026" for text in HOSTILE[:3]]
    check(set(shortened) <= set(texts), f"{name}: the picture's texts are {texts}")
    check(files_of("svg") == ["script-script-alert-1-script-b-bold-b-quoted-too-מבנה.svg"],
          f"{name}: saved as {files_of('svg')}")
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


def colours_of(driver):
    """Colours of the stage's opaque pixels that many have."""
    return run(driver, "(() => { const c = document.getElementById('canvas'), n = {};"
                       "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
                       "for (let i = 0; i < d.length; i += 4) if (d[i + 3] === 255) {"
                       "const k = d[i] + ',' + d[i + 1] + ',' + d[i + 2]; n[k] = (n[k] || 0) + 1; }"
                       "return Object.keys(n).filter((k) => n[k] > 20); })()")


def check_kinds(driver):
    """Members whose forces are not known are grey and blue, not orange as if they pulled; a key says
    which are which."""
    for scheme in ("light", "dark"):
        driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [
            {"name": "prefers-color-scheme", "value": scheme}]})
        wait_for_drawing(driver)
        colours = [[int(part) for part in colour.split(",")] for colour in colours_of(driver)]
        warm = [colour for colour in colours if colour[0] > colour[2] + 30]
        check(len(colours) >= 3 and not warm, f"model.html, {scheme}: colours {colours}")
        texts = [text.text for text in saved_svg(driver, "model.html").iter(SVG + "text")]
        check({"bar", "cable"} <= set(texts) and "spring" not in texts and "force" not in texts,
              f"model.html: the key has {texts}")
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


def state_of(driver, box):
    """Is a choice shown, is it enabled, and why not."""
    return driver.execute_script(
        "const e = document.getElementById(arguments[0]), l = e.parentElement;"
        "return [!l.hidden, !e.disabled, l.title];", box)


def check_choices(driver):
    """A choice without effect anywhere is hidden; one without effect on this shape is disabled."""
    open_page(driver, "blind.html")
    for box in ("colour", "arrows"):
        check(not state_of(driver, box)[0], f"blind.html: {box} is offered without its channel")
    open_page(driver, "blind-cards.html")
    for box in ("colour", "arrows"):
        shown, enabled, title = state_of(driver, box)
        check(shown and not enabled and "this motion" in title,
              f"blind-cards.html: {box} of the motion: {shown}, {enabled}, {title}")
    card = driver.find_element(By.CSS_SELECTOR, ".card")
    driver.execute_script("strutPage.onPick = (index) => { window.pickedCard = index; }")
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", card)
    card.click()
    check(run(driver, "window.pickedCard") == 0, "the choice of a card is not passed on")
    for box in ("colour", "arrows"):
        check(state_of(driver, box) == [True, True, ""], f"blind-cards.html: {box} of a card")
    check(not state_of(driver, "trails")[1], "blind-cards.html: trails of an equilibrium")
    driver.find_element(By.ID, "back").click()
    check(not state_of(driver, "arrows")[1], "blind-cards.html: arrows after a card")


def rows_of(driver, table):
    return [[cell.text for cell in row.find_elements(By.TAG_NAME, "td")]
            for row in driver.find_elements(By.CSS_SELECTOR, f"#{table} tr")]


def check_texts(driver):
    """Micro is written with its letter; measured quantities and the accuracy are in the summary."""
    open_page(driver, "crawler.html")
    text = driver.find_element(By.TAG_NAME, "body").text
    check(["integration step", "100 \u00b5s"] in rows_of(driver, "parameters") and
          " um" not in text and " us" not in text, "crawler.html: micro is written as u")
    check(run(driver, "strutPage.micro('9 um/s, 5 us; 3 u, 4 use, 2 umbrellas')") ==
          "9 \u00b5m/s, 5 \u00b5s; 3 u, 4 use, 2 umbrellas", "micro in other words")
    open_page(driver, "pulley.html")
    rows = dict(row for row in rows_of(driver, "summary") if len(row) == 2)
    measured = json.loads((folder / "pulley/summary.json").read_text(encoding="utf-8"))["measured"]
    for name, quantity in measured.items():
        value = f"{quantity['value']:.4g} {quantity['unit']}".replace("0.25 m", "250 mm") \
            .replace("0.5 m", "500 mm")
        check(rows.get(name, "").startswith(value), f"pulley.html: {name} is {rows.get(name)}, not {value}")
        check("known within" in rows.get(name, ""), f"pulley.html: no error of {name}: {rows.get(name)}")
    check("accuracy" in rows, f"pulley.html: no accuracy in {list(rows)}")


def check_downloads(driver):
    name = "crawler.html"
    open_page(driver, name)
    driver.execute_script("strut.seek(70)")
    wait_for_drawing(driver)
    picture = saved_svg(driver, name)
    texts = [text.text for text in picture.iter(SVG + "text")]
    check({"n1", "n2", "n3", "n4", "n5", "force"} <= set(texts), f"{name}: the picture's texts {texts}")
    paths = [path.get("d") for path in picture.iter(SVG + "path")]
    check(len(paths) > 20 and not any("NaN" in path for path in paths), f"{name}: {len(paths)} paths")
    check(picture.find(SVG + "title").text.endswith(clock(driver).strip() + " s"), f"{name}: its title")
    size = run(driver, "[document.getElementById('canvas').clientWidth,"
                       "document.getElementById('canvas').clientHeight]")
    check([float(picture.get(key)) for key in ("width", "height")] == size, f"{name}: SVG's size")
    image = press_save(driver, "png")
    check(image[:8] == b"\x89PNG\r\n\x1a\n" and
          list(struct.unpack(">2I", image[16:24])) == [2 * part for part in size], f"{name}: PNG's size")
    table = list(csv.reader(press_save(driver, "csv").decode("utf-8").splitlines()))
    check(table[0][:2] == ["time [s]", "displacement: centre of mass x [m]"] and
          "contact force: n1 [N]" in table[0], f"{name}: columns {table[0]}")
    with open(folder / "crawler/members.csv", encoding="utf-8", newline="") as file:
        recorded_forces = list(csv.DictReader(file))
    check(len(table) == 1 + len(recorded_forces), f"{name}: {len(table)} rows")
    column = next(i for i, head in enumerate(table[0]) if head.startswith("member force: "))
    member = table[0][column].removeprefix("member force: ").removesuffix(" [N]")
    for row, wanted in list(zip(table[1:], recorded_forces))[::50]:
        check(abs(float(row[0]) - float(wanted["time [s]"])) < 1e-9 and
              abs(float(row[column]) - float(wanted[member + ".force [N]"])) < 0.02,
              f"{name}: row {row[0]} of the curves")
    numbers = json.loads(press_save(driver, "json"))
    check(numbers["summary"] == run(driver, "strut.data.summary") and
          len(numbers["equilibria"]) > 3 and "beside" not in numbers, f"{name}: numbers {list(numbers)}")
    check(files_of("json") == ["Nine-member-multistable-crawler.json"], f"saved as {files_of('json')}")
    check(run(driver, "[strutPage.fileName('../..', '.x'), strutPage.fileName('a/b\\\\c:d', '.x')]") ==
          ["strut.x", "a-b-c-d.x"], "names of files")
    check_silence(driver, name)


def data_of(name, part="strut-data"):
    page = (folder / name).read_text(encoding="utf-8")
    begin = page.index(">", page.index(f'id="{part}"')) + 1
    return json.loads(page[begin:page.index("</script>", begin)])


def show(driver, data, beside=None):
    result = driver.execute_async_script(
        "const done = arguments[2]; strutPage.show(arguments[0], arguments[1])"
        ".then(() => done('shown'), (e) => done(String(e.stack)));", data, beside)
    check(result == "shown", f"show: {result}")


def check_two(driver):
    """Two runs on one page: a ghost at the same time, dashed curves, a second column."""
    name = "two.html"
    open_page(driver, name)
    rows, others = recorded("two-mass"), recorded("rougher")
    for frame in (0, 200, 900):
        driver.execute_script("strut.seek(arguments[0])", frame)
        at = next(other for other in others if abs(other[0] - rows[frame][0]) < 1e-9)
        ghost = run(driver, "strut.ghost()")
        columns = len(at) // 2
        shift = [ghost[2 * i] - at[1 + columns * i] for i in range(2)]
        check(abs(shift[1] - shift[0]) < 1e-6 and abs(ghost[1] - at[2]) < 1e-5, f"{name}: ghost of frame {frame}: {shift}")
        if frame == 0:
            nodes = run(driver, "strut.positions()")
            check(abs(sum(nodes[::2]) - sum(ghost[::2])) < 1e-5, f"{name}: starts apart, {nodes}, {ghost}")
    for chart in run(driver, "strut.charts()"):
        check(chart["series"] % 2 == 0 < chart["series"], f"{name}: curves of {chart}")
    parameters = {row[0]: row[1:] for row in rows_of(driver, "parameters") if row}
    check(parameters["friction"] == ["0.1", "\u2260", "0.3"] and
          parameters["band"] == ["1 \u00b5m/s", "", "1 \u00b5m/s"], f"{name}: {parameters}")
    heads = [cell.text for cell in driver.find_elements(By.CSS_SELECTOR, "#summary th")]
    check(heads == ["", "two-mass", "", "rougher"], f"{name}: columns {heads}")
    same = [row for row in rows_of(driver, "summary") if row and row[0] == "run"]
    check(same == [["run", "completed", "", "completed"]], f"{name}: the summary has {same}")
    head = press_save(driver, "csv").decode("utf-8").splitlines()[0]
    check(" of rougher [" in head, f"{name}: columns {head}")
    check(json.loads(press_save(driver, "json"))["beside"]["label"] == "rougher", f"{name}: numbers")
    wait_for_drawing(driver)
    check_silence(driver, name)
    show(driver, data_of("crawler.html"), data_of("two-mass.html"))  # another structure
    check(len(run(driver, "strut.ghost()")) == 4 and run(driver, "strut.positions().length") == 10,
          "another structure is no ghost")
    check("hardly overlap" in driver.find_element(By.ID, "beside").text, "recordings apart")
    show(driver, data_of("two-mass.html"))
    check(run(driver, "strut.ghost()") is None and
          not driver.find_element(By.ID, "beside").is_displayed(), "a ghost that is no more")


def check_again(driver):
    """A page shows other data, and what the user chose stays."""
    name = "crawler.html"
    open_page(driver, name)
    place = "compareDocumentPosition(document.getElementById('charts-section')) & 4"
    check(run(driver, "document.getElementById('live').hidden && Boolean(document.getElementById('live')."
              + place + ")"), "#live is not above the charts")
    data, other = data_of(name), data_of("two-mass.html")
    driver.execute_script("""
      const choose = (id, value) => {
        const e = document.getElementById(id);
        if (typeof value === "boolean") e.checked = value;
        else e.value = value;
        e.dispatchEvent(new Event("change"));
      };
      choose("speed", "0.5");
      choose("camera", "whole");
      choose("trails", false);
      const boxes = Array.from(document.querySelectorAll("#chart-choices label"));
      for (const [kind, wanted] of [["contact force", false], ["height above the ground", true]]) {
        const box = boxes.find((l) => l.textContent.trim() === kind).querySelector("input");
        box.checked = wanted;
        box.dispatchEvent(new Event("change"));
      }
      strut.seek(333);""")
    before = run(driver, "[strut.time, strut.charts().map((c) => c.name)]")
    check("height above the ground" in before[1] and "contact force" not in before[1], f"{before}")
    for _ in range(3):
        show(driver, data)
    after = run(driver, "[strut.time, strut.charts().map((c) => c.name)]")
    check(after == before, f"shown again: {before} became {after}")
    check(run(driver, "['speed', 'camera', 'trails'].map((id) => document.getElementById(id))"
                      ".map((e) => (e.type === 'checkbox' ? e.checked : e.value))") ==
          ["0.5", "whole", False], "the user's choices are gone")
    driver.find_element(By.TAG_NAME, "body").send_keys(Keys.ARROW_RIGHT)
    check(run(driver, "strut.frame") == 334, "a key acts more than once after data were replaced")
    show(driver, other)
    check(run(driver, "strut.data.name") == other["name"] ==
          driver.find_element(By.ID, "name").text == driver.title, "another run has the old name")
    check(run(driver, "strut.frames") == other["motion"]["frames"], "frames of another run")
    check(run(driver, "document.querySelectorAll('.chart').length === strut.charts().length"),
          "charts of the old run are left")
    check(not driver.find_elements(By.CSS_SELECTOR, ".card"), "cards of the old run are left")
    show(driver, data_of("model.html"))
    check(run(driver, "strut.frames") == 0 and
          not driver.find_element(By.ID, "transport").is_displayed() and
          not driver.find_element(By.ID, "charts-section").is_displayed() and
          not driver.find_element(By.ID, "clock").is_displayed(), "a model after a run moves")
    show(driver, data)
    check(run(driver, "strut.charts().map((c) => c.name)") == before[1], "charts after a model")
    bad = json.loads(json.dumps(data))
    bad["motion"]["position"]["bytes"] = bad["motion"]["position"]["bytes"][:400]
    driver.execute_async_script("strutPage.show(arguments[0]).catch(() => arguments[1]())", bad)
    check(driver.find_element(By.ID, "trouble").is_displayed(), "damaged data are not reported")
    driver.get_log("browser")
    show(driver, data)
    check(not driver.find_element(By.ID, "trouble").is_displayed(), "an old trouble is left")
    check_silence(driver, name)


def check_empty(driver):
    """A page without data waits for show()."""
    page = (folder / "crawler.html").read_text(encoding="utf-8")
    begin = page.index(">", page.index('id="strut-data"')) + 1
    empty = page[:begin] + "\n" + page[page.index("</script>", begin):]
    (folder / "empty.html").write_text(empty, encoding="utf-8")
    open_page(driver, "empty.html")
    driver.find_element(By.TAG_NAME, "body").send_keys(" ")
    driver.execute_script("window.dispatchEvent(new Event('resize'))")
    wait_for_drawing(driver)
    check(run(driver, "strut.data") is None, "an empty page has data")
    show(driver, data_of("crawler.html"))
    wait_for_drawing(driver)
    check(ink(driver) > 500 and run(driver, "strut.charts().length") > 0, "an empty page stays empty")
    check_silence(driver, "empty.html")


def check_data(driver):
    """Data that are named like columns of the run: dots in its charts, columns of its table."""
    open_page(driver, "spring.html")
    check([c["series"] for c in run(driver, "strut.charts()")] == [3, 2], f"data: {run(driver, 'strut.charts()')}")
    check("b x (dots: measured)" in driver.find_element(By.ID, "charts").text, "data: no word of them")
    head, *rows = csv.reader(press_save(driver, "csv").decode("utf-8").splitlines())
    for name, wanted in (("displacement: b x measured [m]", {0.25: -0.015, 0.9005: -0.002}),
                         ("member force: m measured [N]", {0.25: 0.3, 0.5: 0.4, 0.9005: 0.5})):
        column = head.index(name)
        found = {float(row[0]): float(row[column]) for row in rows if row[column] not in ("", "null")}
        check(found.keys() == wanted.keys() and all(abs(found[t] - v) < 1e-9 for t, v in wanted.items()),
              f"data: {name} is {found}")
    check(len(rows) == len(recorded("spring")) + 1, f"data: {len(rows)} rows")
    check_silence(driver, "spring.html")


def check_narrow(driver, width):
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
        "width": width, "height": 780, "deviceScaleFactor": 2, "mobile": True})
    for name in ("crawler.html", "two.html", "pulley.html", "model.html"):
        open_page(driver, name)
        wide = run(driver, "document.documentElement.scrollWidth")
        check(wide <= width, f"{name}: {wide} pixels wide in a window of {width}")
        for button in driver.find_elements(By.CSS_SELECTOR, ".save button, button.save"):
            right = driver.execute_script("return arguments[0].getBoundingClientRect().right", button)
            check(right <= width, f"{name}: a button ends at {right} of {width} pixels")


def check_run(driver, width):
    open_page(driver, "frame.html")
    check_names_below_clock(driver, "frame.html")
    open_page(driver, "crawler.html")
    check_layout(driver, "crawler.html", width)
    wait_for_drawing(driver)
    check(ink(driver) > 500, "crawler.html: nothing is drawn")
    check_numbers(driver, "crawler.html", recorded("crawler"), 5)
    check_player(driver, "crawler.html")
    check_clock(driver, "crawler.html")
    check_charts(driver, "crawler.html")
    check_camera(driver, "crawler.html")
    listed = json.loads((folder / "crawler.json").read_text(encoding="utf-8"))["equilibria"]
    check_cards(driver, "crawler.html", listed)
    check_silence(driver, "crawler.html")


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
            check_kinds(driver)
            check_silence(driver, "model.html")
            check_panels(driver)
            check_choices(driver)
            check_texts(driver)
            check_downloads(driver)
            check_two(driver)
            check_again(driver)
            check_empty(driver)
            check_hostile(driver)
            check_damaged(driver)
            check_data(driver)
        else:
            check_narrow(driver, 400)
    finally:
        driver.quit()
finish()
