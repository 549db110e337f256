# SPDX-License-Identifier: GPL-3.0-or-later
"""Chromium for page_test.py: opening pages of the folder that it is given, looking at them, saving from them."""

import csv
import json
import os
import pathlib
import sys
import tempfile
import time
import xml.etree.ElementTree

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from testing import check

os.environ.setdefault("SE_OFFLINE", "true")  # Selenium is not to look for drivers elsewhere
folder = pathlib.Path(sys.argv[1]).resolve()
saved = folder / "saved"
SVG = "{http://www.w3.org/2000/svg}"


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
    driver.execute_cdp_cmd("Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(saved)})
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


def clock(driver):
    return run(driver, "document.querySelector('#clock b').textContent").removesuffix(" s")


def ink(driver):
    """Pixels of the stage that are not blank."""
    return run(driver, "(() => { const c = document.getElementById('canvas');"
                       "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
                       "let n = 0; for (let i = 3; i < d.length; i += 4) n += d[i] > 40; return n; })()")


def wait_for_drawing(driver):
    driver.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(() => arguments[0]()))")


def files_of(ending):
    return [path.name for path in saved.glob("*." + ending)]


def press_save(driver, ending):
    """Presses the button and returns the bytes of the file; only that file is in the folder then."""
    saved.mkdir(exist_ok=True)
    for path in saved.iterdir():
        path.unlink()
    button = driver.find_element(By.ID, "save-" + ending)
    check(ending.upper() in button.accessible_name, f"the button's name is {button.accessible_name}")
    driver.execute_script("arguments[0].focus()", button)
    button.send_keys(Keys.ENTER)
    for _ in range(100):
        if len(files_of(ending)) == len(list(saved.iterdir())) == 1:
            return next(saved.iterdir()).read_bytes()
        time.sleep(0.1)
    check(False, f"no file {ending}: {list(saved.iterdir())}")
    return b""


def saved_svg(driver, name):
    text = press_save(driver, "svg")
    try:
        return xml.etree.ElementTree.fromstring(text)
    except xml.etree.ElementTree.ParseError as error:
        check(False, f"{name}: its picture is no XML: {error}")
        return xml.etree.ElementTree.Element("none")
