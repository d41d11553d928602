#!/usr/bin/python3
"""Opens FOLDER/report.html in a browser, uses it as a reader would, and holds what it shows against the run's own files.

usage: use_report.py FOLDER [SCREENSHOT]
"""

import base64
import csv
import io
import json
import pathlib
import sys
import time

import h5py
import numpy
from PIL import Image
from selenium.webdriver import ActionChains, Keys
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import Select, WebDriverWait

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from browser import chromium

folder = pathlib.Path(sys.argv[1]).resolve()
report = (folder / "report.html").as_uri()


def browser(*more):
    return chromium("--window-size=1300,1000", *more, logs={"browser": "ALL", "performance": "ALL"})


def hold_vane_against_its_motion(points, time):
    """Turned back by 300 degrees a second about y (from z to x) and moved back by 0.1 m/s, all points lie on the box."""
    x, y, z = (numpy.array(points).reshape(-1, 3) - [0.125 + 0.1 * time, 0, 0.1]).T
    c, s = numpy.cos(numpy.radians(300) * time), numpy.sin(numpy.radians(300) * time)
    outside = abs(numpy.array([c * x - s * z, y, s * x + c * z]).T) - [0.015, 0.02, 0.02]
    assert len(x) > 100 and abs(outside.max(axis=1)).max() < 1e-5, abs(outside.max(axis=1)).max()


def play_through(page, button, times):
    """Playing shows each instant after the one before, the first after the last; Pause holds, whenever it was pressed.

    The page itself notes what it shows: looks from outside, at their own rhythm, can miss the same instant each time.
    """
    page.execute_script("window.shown = []; document.addEventListener('instant', (e) => window.shown.push(e.detail))")

    def shown():
        return page.execute_script("return window.shown")

    button.click()
    WebDriverWait(page, 60).until(lambda _: len(shown()) > len(times))
    # What an earlier Play began does not go on: Pause and Play twice, then Pause, pressed while an instant comes into view.
    for presses in (2, 2, 1):
        page.execute_script("const [button, presses] = arguments; document.addEventListener('instant', "
                            "() => { for (let i = 0; i < presses; ++i) button.click(); }, {once: true})", button, presses)
        enough = len(shown()) + 2
        WebDriverWait(page, 60).until(lambda _: len(shown()) >= enough or button.text == "Play")
    before = len(shown())
    time.sleep(2)
    assert len(shown()) == before
    places = [times.index(t) for t in shown()]
    assert all(b == (a + 1) % len(times) for a, b in zip(places, places[1:])), places


def use(page):
    page.get(report)

    def element(name):
        return page.find_element(By.ID, name)

    def state():
        return page.execute_script("return window.talus.state()")

    def wait(condition):
        WebDriverWait(page, 60).until(lambda _: condition())

    def pixels(canvas):
        url = page.execute_script(f"return document.getElementById('{canvas}').toDataURL('image/png')")
        return numpy.asarray(Image.open(io.BytesIO(base64.b64decode(url.split(",")[1]))).convert("RGBA")).astype(int)

    def drawn():
        """How many pixels the particles cover."""
        return (pixels("particles")[:, :, 3] > 0).sum()

    wait(lambda: page.execute_script("return window.talus && window.talus.state().ready"))
    assert page.find_element(By.TAG_NAME, "h1").text == "A cylinder <falls> & spreads"
    assert not element("without").is_displayed()

    # The time slider: each instant's particles stand where the snapshot says, with the values it says.
    series = json.loads((folder / "particles.hdf.series").read_text())["files"]
    assert state()["frames"] == len(series)
    element("instant").send_keys(Keys.HOME)
    wait(lambda: state()["frame"] == 0)
    before = pixels("particles")
    for frame, listed in enumerate(series):
        wait(lambda: state()["frame"] == frame)
        snapshot = h5py.File(folder / listed["name"])
        assert snapshot["talus/time"][0] == listed["time"] == state()["time"]
        points = snapshot["VTKHDF/Points"][:]
        seen = numpy.array(page.execute_script("return window.talus.places()")).reshape(-1, 3)
        step = (points.max(0) - points.min(0)) / 65535  # half of it is lost to rounding, and 2^-24 as in any 32 bits
        assert (abs(seen - points) <= step / 2 + 2**-23 * abs(points).max()).all()
        speed = numpy.linalg.norm(snapshot["VTKHDF/PointData/velocity"][:], axis=1)
        shown = numpy.array(page.execute_script("return window.talus.values()"))
        # each component is rounded to eleven bits, then to nine; what is smaller than 2^-28 of the largest has fewer
        rounding = 2**-11 + 2**-9
        assert (abs(shown - speed) <= rounding * speed + 2**-36 * speed.max()).all()
        hold_vane_against_its_motion(page.execute_script("return window.talus.solids()")[0], listed["time"])
        element("instant").send_keys(Keys.ARROW_RIGHT)
    assert (pixels("particles") != before).any(axis=2).sum() > 1000, "the particles fall"

    # Colour.
    Select(element("range")).select_by_visible_text("min-max, current frame")
    before = pixels("particles")
    Select(element("quantity")).select_by_visible_text("stress zz")
    wait(lambda: state()["quantity"] == "stress zz")
    stress = h5py.File(folder / series[-1]["name"])["VTKHDF/PointData/stress"][:, 2]
    assert (pixels("particles") != before).any(axis=2).sum() > 1000
    assert abs(state()["low"] - stress.min()) <= 1e-6 * abs(stress.min()), "the scale begins at the least value"
    assert element("unit").text == "Pa"

    # Both colour maps rise evenly in lightness: no tenth of the scale twice as long as another, to the eye (CIE 1976).
    for name in ("viridis", "cividis"):
        Select(element("map")).select_by_visible_text(name)
        strip = pixels("frame")
        column = strip[:, strip.shape[1] - 130 + 14 + 9, :3] / 255
        coloured = numpy.where(column.max(1) - column.min(1) > 0.05)[0]
        coloured = coloured[(coloured > 72) & (coloured < strip.shape[0] - 62)]
        linear = numpy.where(column <= 0.04045, column / 12.92, ((column + 0.055) / 1.055) ** 2.4)
        luminance = (linear @ [0.2126, 0.7152, 0.0722])[coloured[0]:coloured[-1] + 1]
        lightness = 116 * numpy.cbrt(luminance) - 16
        steps = -numpy.diff(lightness[numpy.linspace(0, len(lightness) - 1, 11).astype(int)])
        assert steps.min() > 0 and steps.max() < 2 * steps.min(), (name, steps)

    # The clip plane takes particles away; those that stay lie on one side of it.
    whole = drawn()
    Select(element("clip_axis")).select_by_visible_text("y")
    y = points[:, 1]
    assert 0 < state()["kept"] < len(y), state()
    element("clip_side").click()
    other = state()["kept"]
    element("clip_side").click()
    assert state()["kept"] + other == len(y)
    element("clip_place").send_keys(Keys.END)
    assert drawn() < whole / 10
    Select(element("clip_axis")).select_by_visible_text("nothing")
    assert drawn() == whole

    # Turning, and reading a particle.
    camera = state()["camera"]
    stage = element("particles")
    page.execute_script("arguments[0].scrollIntoView({block: 'center'})", stage)
    ActionChains(page).drag_and_drop_by_offset(stage, 120, 40).perform()
    assert state()["camera"] != camera
    ys, xs = numpy.where(pixels("particles")[:, :, 3] > 0)
    middle = numpy.argmin((xs - numpy.median(xs)) ** 2 + (ys - numpy.median(ys)) ** 2)
    offset = int(xs[middle] - stage.size["width"] / 2), int(ys[middle] - stage.size["height"] / 2)
    ActionChains(page).move_to_element_with_offset(stage, *offset).perform()
    words = element("reading").text.split()  # stress zz VALUE Pa particle NUMBER, at ...
    number, value = int(words[words.index("particle") + 1].rstrip(",")), float(words[2])
    # it is read to four digits
    assert abs(value - stress[number]) <= (rounding + 5e-4) * abs(stress[number]), element("reading").text

    # The keyboard.
    stage_box = element("stage")
    stage_box.send_keys(Keys.HOME)
    wait(lambda: state()["frame"] == 0)
    stage_box.send_keys(Keys.SPACE)
    wait(lambda: state()["frame"] >= 2)
    stage_box.send_keys(Keys.SPACE)
    play_through(page, element("play"), [entry["time"] for entry in series])

    # A curve: what the legend says under the pointer is a row of the history; a click goes to its instant.
    rows = list(csv.DictReader(open(folder / "history.csv")))
    chart = element("chart-height")
    page.execute_script("arguments[0].scrollIntoView({block: 'center'})", chart)
    ActionChains(page).move_to_element(chart).perform()
    legend = element("legend-height").text.split()
    seconds, height = float(legend[legend.index("time") + 1]), float(legend[legend.index("point:") + 1])
    row = min(rows, key=lambda r: abs(float(r["time [s]"]) - seconds))
    assert abs(float(row["time [s]"]) - seconds) <= 1e-5 * seconds
    assert abs(float(row["height [m]"]) * 1e3 - height) <= 1e-5 * height, (legend, row["height [m]"])
    ActionChains(page).click().perform()
    nearest = min(range(len(series)), key=lambda i: abs(series[i]["time"] - float(row["time [s]"])))
    wait(lambda: state()["frame"] == nearest)

    for entry in page.get_log("browser"):
        raise AssertionError(entry)
    for entry in page.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            url = message["params"]["request"]["url"]
            assert url == report or url.startswith(("data:", "blob:")), url
    if len(sys.argv) > 2:
        page.save_screenshot(sys.argv[2])


def use_map(page):
    """The map of a run on terrain: layers, instants and values under the pointer, against the files parsed here."""
    page.get(report)

    def element(name):
        return page.find_element(By.ID, name)

    def state():
        return page.execute_script("return window.talus_map.state()")

    def wait(condition):
        WebDriverWait(page, 60).until(lambda _: condition())

    def asc(what):
        lines = next((folder / "maps").glob(f"*_{what}.asc")).read_text().split("\n")
        head = {key.lower(): float(value) for key, value in (line.split() for line in lines[:6])}
        numbers = numpy.array([line.split() for line in lines[6:] if line], dtype=float)
        assert numpy.shape(numbers) == (head["nrows"], head["ncols"])
        return head, numbers

    def at(head, numbers, east, north):
        column = int((east - head["xllcorner"]) // head["cellsize"])
        row = int(head["nrows"]) - 1 - int((north - head["yllcorner"]) // head["cellsize"])
        return numbers[row, column]

    wait(lambda: page.execute_script("return window.talus_map && window.talus_map.state().ready"))
    page.execute_script("document.getElementById('map_view').scrollIntoView()")
    canvas = element("map_canvas")
    size = canvas.size
    for what, name in (("pft", "Peak flow thickness"), ("pfv", "Peak flow speed"), ("ppr", "Peak dynamic pressure"),
                       ("arrival", "Time of arrival"), ("deposit", "Deposit thickness"), ("change", "Change of the surface")):
        Select(element("map_layer")).select_by_value([o.get_attribute("value") for o in Select(element("map_layer")).options
                                                      if o.text.startswith(name)][0])
        wait(lambda: state()["layer"] == what)
        head, numbers = asc(what)
        rows, columns = numpy.where(numbers > (0.01 if what == "change" else 0))
        for i in range(0, len(rows), max(1, len(rows) // 7)):
            east = head["xllcorner"] + (columns[i] + 0.5) * head["cellsize"]
            north = head["yllcorner"] + (head["nrows"] - rows[i] - 0.5) * head["cellsize"]
            value = numbers[rows[i], columns[i]]
            wait(lambda: abs(page.execute_script(f"return window.talus_map.value_at({east}, {north})") - value) <= 0.0025 * value)
            u, v = page.execute_script(f"return window.talus_map.screen({east}, {north})")
            ActionChains(page).move_to_element_with_offset(canvas, int(u - size["width"] / 2), int(v - size["height"] / 2)).perform()
            words = element("map_reading").text
            assert words.startswith(name + ": "), words
            e, n = float(words.split("east ")[1].split(",")[0]), float(words.split("north ")[1].split(" ")[0])
            read, there = float(words.split(": ")[1].split(" ")[0]), at(head, numbers, e, n)
            assert abs(e - east) < head["cellsize"] and abs(read - there) <= 0.0075 * there, (words, there)
            ground = float(words.split("ground ")[1].split(" ")[0])
            assert 0 < ground < 9000, words

    # Scrubbing shows the maps in time; the last instant is the deposit.
    element("map_instant").send_keys(Keys.END)
    wait(lambda: state()["layer"] == "thickness" and state()["frame"] == state()["frames"] - 1)
    frames = json.loads((folder / "maps/frames/frames.json").read_text())
    assert state()["frames"] == len(frames) >= 4
    wait(lambda: element("map_time").text == "t = {:g} s".format(float("{:.3g}".format(state()["time"]))))
    head, numbers = asc("deposit")
    rows, columns = numpy.where(numbers > 0)
    for i in range(0, len(rows), 5):
        east = head["xllcorner"] + (columns[i] + 0.5) * head["cellsize"]
        north = head["yllcorner"] + (head["nrows"] - rows[i] - 0.5) * head["cellsize"]
        value = numbers[rows[i], columns[i]]
        wait(lambda: abs(page.execute_script(f"return window.talus_map.value_at({east}, {north})") - value) <= 0.0025 * value)
    wait(lambda: page.execute_script("return window.talus.state().ready"))  # it tells of its own first instant
    play_through(page, element("map_play"), [frame["time"] for frame in frames])
    element("map_play").click()
    page.execute_script("document.dispatchEvent(new CustomEvent('seek', {detail: 1.01}))")  # as a click on a curve does
    wait(lambda: element("map_play").text == "Play" and state()["frame"] == 1)
    scale = state()["scale"]
    element("map_in").click()
    assert state()["scale"] > scale
    for width in (390, 1440):
        page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": width, "height": 844, "deviceScaleFactor": 1, "mobile": width < 500})
        # no sideways scrolling
        wait(lambda: page.execute_script("return document.documentElement.scrollWidth") <= width)
    for entry in page.get_log("browser"):
        raise AssertionError(entry)


def use_on_screens(page):
    """On a laptop the particles and all their controls are in view; a telephone scrolls downwards only."""
    for width, height in ((1440, 900), (390, 844)):
        page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                             {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500})
        page.get(report)
        WebDriverWait(page, 60).until(lambda _: page.execute_script("return window.talus && window.talus.state().ready"))
        state = page.execute_script("return window.talus.state()")
        assert state["frame"] == state["frames"] - 1, "it begins with the deposit"
        assert page.execute_script("return document.documentElement.scrollWidth") <= width, width
        assert page.execute_script("return document.getElementById('viewer').getBoundingClientRect().height") <= height
        page.find_element(By.CSS_SELECTOR, ".profiles svg polyline")
    names = [option.text for option in Select(page.find_element(By.ID, "quantity")).options]
    assert "mean pressure p" in names and "p" not in names, names


def use_without_webgl(page):
    page.get(report)
    assert page.find_element(By.ID, "without").is_displayed()
    assert not page.find_element(By.ID, "viewer").is_displayed()
    assert page.find_element(By.CSS_SELECTOR, "figure img[src^='data:image/png']").is_displayed()
    assert page.find_element(By.CSS_SELECTOR, "#chart-front canvas").is_displayed()


webgl = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
visits = [(use_map, webgl)] if (folder / "maps").exists() else [(use, webgl), (use_on_screens, webgl),
                                                                  (use_without_webgl, ("--disable-3d-apis",))]
for visit, arguments in visits:
    page = browser(*arguments)
    try:
        visit(page)
    finally:
        page.quit()
