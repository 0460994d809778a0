#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens the pages of `nscdd report` in Debian's chromium and uses them as people do: with sliders, keyboard and mouse,
on a narrow screen, without colour vision. Numbers shown are compared with those that other verbs print.

The program is $NSCDD_PROGRAM, the source tree $NSCDD_SOURCE.
"""
import csv
import io
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.actions.wheel_input import ScrollOrigin
from selenium.webdriver.common.keys import Keys

import colours

sys.path.insert(0, os.path.join(os.environ["NSCDD_SOURCE"], "plots"))
import perspective  # noqa: E402

EPSILON, ETA = "0,0.1,1,10", "0.3,1,3,10,inf"
FAILED = []


def check(holds, what):
    print(("ok      " if holds else "FAILED  ") + what)
    if not holds:
        FAILED.append(what)


def nscdd(folder, *arguments):
    environment = dict(os.environ, NSCDD_DATA=os.environ["NSCDD_SOURCE"])
    return subprocess.run([os.environ["NSCDD_PROGRAM"], *arguments], cwd=folder, env=environment, check=True,
                          capture_output=True, text=True, timeout=240).stdout


def script_of_page(name):
    return (Path(os.environ["NSCDD_SOURCE"]) / "src/formats/report/page" / name).read_text(encoding="utf-8")


def rows(text):
    return list(csv.DictReader(io.StringIO(text)))


def reported(browser, folder, page, *arguments):
    """The page that nscdd report makes, in the browser."""
    nscdd(folder, "report", *arguments, "-o", page)
    return Page(browser, os.path.join(folder, page))


def open_browser():
    options = Options()
    options.binary_location = "/usr/bin/chromium"
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))


class Page:
    """One page in the browser."""

    def __init__(self, browser, path, width=1280, height=900):
        self.browser, self.path = browser, path
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 800})
        browser.get("file://" + path)
        self.settle()

    def js(self, code, *arguments):
        return self.browser.execute_script(code, *arguments)

    def settle(self):
        """Waits until what was asked for is drawn."""
        self.browser.execute_async_script(
            "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()));")

    def by_id(self, name):
        return self.browser.find_element("id", name)

    def text(self, name):
        return self.by_id(name).text

    def click(self, name):
        self.by_id(name).click()
        self.settle()

    def press(self, name, *keys):
        """To a control."""
        self.by_id(name).send_keys(*keys)
        self.settle()

    def keys(self, *keys):
        """To whatever has the focus."""
        ActionChains(self.browser, duration=0).send_keys(*keys).perform()
        self.settle()

    def focused(self):
        return self.js("return document.activeElement.id")

    def pixels(self):
        """What the canvas shows: a number that changes with any pixel, the part that is drawn on, and how often the
        commonest colours occur there, {(r, g, b, alpha): times}."""
        picture, drawn, counted = self.js("""
            const scene = document.getElementById("scene"), copy = document.createElement("canvas");
            [copy.width, copy.height] = [scene.width, scene.height];
            const context = copy.getContext("2d", { willReadFrequently: true });
            context.drawImage(scene, 0, 0);
            const pixels = new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer);
            const colours = new Map();
            let hash = 2166136261, drawn = 0;
            for (const pixel of pixels) {
              hash = Math.imul(hash ^ pixel, 16777619);
              if (!(pixel >>> 24)) continue;
              drawn += 1;
              colours.set(pixel, (colours.get(pixel) ?? 0) + 1);
            }
            const commonest = [...colours].sort((a, b) => b[1] - a[1]).slice(0, 20);
            return [hash, drawn / pixels.length, commonest];""")
        colours_seen = {tuple(int(pixel) >> shift & 255 for shift in (0, 8, 16, 24)): n for pixel, n in counted}
        return picture, drawn, colours_seen

    def picture(self):
        return self.pixels()[0]

    def switch(self, layer, on):
        box = self.by_id("layer-" + layer)
        if box.is_selected() != on:
            box.click()
        self.settle()

    def quiet(self, name):
        entries = self.browser.get_log("browser")
        check(not entries, f"{name}: no message on the console {entries or ''}")
        check(self.js("return performance.getEntriesByType('resource').length") == 0, f"{name}: nothing is loaded")


def number(text):
    """The number that a page shows, such as 5.12·10⁻³."""
    plain = text.replace("−", "-").translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))
    match = re.fullmatch(r"(?:(-?[\d.]+)·)?10(-?\d+)", plain)
    return float(match.group(1) or 1) * 10.0 ** int(match.group(2)) if match and "10" in text and any(
        c in text for c in "⁻⁰¹²³⁴⁵⁶⁷⁸⁹") else float(plain)


def check_renders(page, name):
    _, inked, seen = page.pixels()
    check(inked > 0.2, f"{name}: the canvas shows something ({inked:.0%} of it)")
    check(len(seen) > 5, f"{name}: in several colours")
    check(page.js("return document.querySelectorAll('.chart path').length") >= 2, f"{name}: there are curves")
    check("undefined" not in page.js("return document.body.innerText") and
          "NaN" not in page.js("return document.body.innerText"), f"{name}: no number is missing in a text")


def check_sliders(page, sweep):
    """Every point of the grid, by the keys of the sliders."""
    count = {"epsilon": len(EPSILON.split(",")), "eta": len(ETA.split(","))}
    wrong, markers = [], set()
    for e in range(count["epsilon"]):
        page.by_id("epsilon").send_keys(Keys.HOME if e == 0 else Keys.ARROW_RIGHT)
        for h in range(count["eta"]):
            page.by_id("eta").send_keys(Keys.HOME if h == 0 else Keys.ARROW_RIGHT)
            row = sweep[e * count["eta"] + h]
            shown, expected = number(page.text("rho")), float(row["subdominant_radius"])
            if abs(shown - expected) > 1e-6 * expected + 1e-13:
                wrong.append((row["epsilon"], row["eta"], shown, expected))
            place = page.js("const m = document.querySelector('#along-eta .marker');"
                            "return m.getAttribute('cx') + ' ' + m.getAttribute('cy')")
            markers.add((e, h, place))
            rate = expected
            if 1e-14 < rate < 1 and f"{-1 / np.log10(rate):.3g}" not in page.text("meaning"):
                wrong.append((row["epsilon"], row["eta"], page.text("meaning")))
    check(not wrong, f"sliders: ρ is that of nscdd sweep at all {len(sweep)} points {wrong or ''}")
    places = {place.split()[0] for _, _, place in markers}
    check(len(places) == count["eta"], "sliders: the point on the curve moves along η")
    check(len({place for _, _, place in markers}) > 2 * count["eta"], "sliders: and up and down with ε")
    check(page.by_id("eta").get_attribute("aria-valuetext").startswith("∞"), "sliders: they say their value")


def use_focused(page):
    """Uses what has the focus by its keys."""
    name = page.focused()
    if name in ("epsilon", "eta"):
        before = page.text(name + "-value")
        page.keys(Keys.HOME)
        first = page.text(name + "-value")
        page.keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
        check(len({first, page.text(name + "-value")}) == 2 and before, f"keyboard: arrow keys move {name}")
    if name == "layer-contacts":
        before = page.picture()
        page.keys(Keys.SPACE)
        check(page.picture() != before, "keyboard: the blank switches contacts off")
        page.keys(Keys.SPACE)
    if name == "scene":
        width = page.js("return getComputedStyle(document.activeElement).outlineWidth")
        check(width == "3px", f"keyboard: the focus is seen ({width})")
        before = page.picture()
        page.keys("+")
        check(page.picture() != before, "keyboard: + zooms")
        page.keys(Keys.ARROW_LEFT, "0")
        check(page.picture() == before, "keyboard: 0 shows the whole again")
        page.keys("n")
        check(page.text("grain").startswith("Grain 0: mass 1 kg"), f"keyboard: N names a grain: {page.text('grain')}")
        page.keys(Keys.ESCAPE)


def tab_through(page, use):
    """The names of all that Tab reaches, in their order."""
    page.js("document.activeElement.blur(); window.scrollTo(0, 0)")
    reached = []
    for _ in range(40):
        page.keys(Keys.TAB)
        if page.focused() in reached and page.focused():
            break
        reached.append(page.focused())
        use(page)
    return reached


IN_SPACE = ("layer-inner", "grain-size", "cut")


def check_keyboard(page, more=()):
    """Tab alone reaches everything that can be used, and keys use it."""
    wanted = {"scene", "zoom-in", "zoom-out", "whole", "layer-contacts", "layer-labels", "layer-hatching", "layer-mode",
              "amplitude", "epsilon", "eta", "go-best", *more}
    missing = wanted - set(tab_through(page, use_focused))
    check(not missing, f"keyboard: Tab reaches all controls {missing or ''}")


def check_mouse(page):
    scene = page.by_id("scene")
    found = ""
    for dx in range(-150, 151, 25):
        ActionChains(page.browser, duration=0).move_to_element_with_offset(scene, dx, 10).perform()
        hint = page.by_id("hint")
        found = hint.text if hint.is_displayed() else found
    check(found.startswith("Grain ") and "subdomain" in found, f"mouse: a grain says what it is: {found}")
    before = page.picture()
    ActionChains(page.browser, duration=0).move_to_element(scene).click_and_hold().move_by_offset(30, 10).release().perform()
    page.settle()
    check(page.picture() != before, "mouse: dragging moves the picture")
    page.click("whole")
    check_wheel(page, scene)


def check_wheel(page, scene):
    """The wheel zooms in the picture that has the focus, and scrolls the page otherwise."""
    turn = lambda: (ActionChains(page.browser, duration=0).scroll_from_origin(ScrollOrigin.from_element(scene), 0, 40)
                    .perform(), page.settle())
    page.js("document.activeElement.blur()")
    before = page.picture()
    turn()
    check(page.picture() == before, "wheel: the page scrolls past a picture without focus")
    scene.click()
    before = page.picture()
    turn()
    check(page.picture() != before, "wheel: it zooms in the picture that has the focus")
    page.keys(Keys.ESCAPE)
    page.click("whole")


def check_ticks(page, name):
    """Every chart has three numbers or more on its upright axis, all different, and steps are whole numbers."""
    for chart, texts in page.js("""return [...document.querySelectorAll('.chart')].filter((c) => c.querySelector('svg'))
        .map((c) => [c.id, [...c.querySelectorAll('svg:first-child > text')].map((t) => [t.textContent,
          t.getAttribute('text-anchor'), t.getAttribute('x') === '52'])]);"""):
        upright = [text for text, anchor, at_axis in texts if anchor == "end" and at_axis]
        check(len(upright) >= 3 and len(set(upright)) == len(upright), f"{name}: ticks of {chart}: {upright}")
        if any(text == "step" for text, _, _ in texts):
            flat = [text for text, anchor, _ in texts if anchor == "middle"][:-2]
            check(flat and all(re.fullmatch(r"\d+", text) for text in flat), f"{name}: steps of {chart}: {flat}")


def check_modes(page):
    """Arrows change with the point, and grow with the amplitude."""
    page.press("epsilon", Keys.END)
    last = page.picture()
    page.press("epsilon", Keys.HOME)
    first = page.picture()
    check(first != last, "modes: another ε has another mode")
    page.press("amplitude", Keys.END)
    check(page.picture() != first, "modes: arrows grow with the amplitude")
    page.by_id("amplitude").send_keys(*[Keys.ARROW_LEFT] * 10)
    page.switch("mode", False)
    without = page.picture()
    page.switch("mode", True)
    check(page.picture() != without, "modes: they can be switched off")


def check_sets(page, sweep):
    """The active contacts have other radii, those of the sweep with them."""
    page.browser.find_element("css selector", "input[value=active]").click()
    page.by_id("epsilon").send_keys(Keys.HOME)
    page.by_id("eta").send_keys(Keys.END)
    expected = float(sweep[len(ETA.split(",")) - 1]["subdominant_radius"])
    check(abs(number(page.text("rho")) - expected) < 1e-6, "sets: the radius of active contacts is that of the sweep")
    page.by_id("go-best").click()
    check(page.text("eta-value") != "∞", "sets: the button goes to a point next to the best η")
    page.browser.find_element("css selector", "input[value=all]").click()


def check_contrast(page, name):
    """Every text against what lies behind it."""
    pairs = page.js("""
      const seen = new Map(), walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
      for (let node = walker.nextNode(); node; node = walker.nextNode()) {
        const holder = node.parentElement;
        if (!node.textContent.trim() || !holder.getClientRects().length || holder.closest("script, style")) continue;
        const style = getComputedStyle(holder), svg = holder instanceof SVGElement;
        let behind = holder;
        while (behind && getComputedStyle(behind).backgroundColor === "rgba(0, 0, 0, 0)") behind = behind.parentElement;
        const ground = behind ? getComputedStyle(behind).backgroundColor : "rgb(255, 255, 255)";
        seen.set((svg ? style.fill : style.color) + "|" + ground, node.textContent.trim().slice(0, 40));
      }
      return [...seen];""")
    rgb = lambda text: tuple(float(v) for v in re.findall(r"[\d.]+", text)[:3])
    low = [(words, both) for both, words in pairs if colours.contrast(*map(rgb, both.split("|"))) < 4.5]
    check(len(pairs) > 3 and not low, f"{name}: contrast of {len(pairs)} kinds of text is at least 4.5 {low or ''}")


def check_colours(page):
    """Neighbouring subdomains have colours that are told apart, whatever the colour vision."""
    for layer in ("contacts", "labels", "hatching", "mode"):
        page.switch(layer, False)
    flat, _, seen = page.pixels()
    drawn = sum(seen.values())
    filled = [colour[:3] for colour, n in seen.items() if n > 0.04 * drawn]
    check(len(filled) == 4, f"colours: four subdomains around a point have four colours, met {filled}")
    for vision, (distance, _) in colours.closest(filled).items():
        check(distance > 25, f"colours: told apart with {vision} vision (distance {distance:.0f})")
    page.switch("hatching", True)
    page.click("zoom-in")
    page.click("whole")
    check(page.picture() != flat, "colours: hatching is a second sign")
    listed = re.search(r"const palette = \[(.*?)\];", script_of_page("data.js")).group(1)
    palette = [tuple(int(c[i:i + 2], 16) for i in (0, 2, 4)) for c in re.findall(r"#(\w{6})", listed)]
    for vision, (distance, pair) in colours.closest(palette).items():
        check(distance > 15, f"colours: all {len(palette)} told apart with {vision} vision ({distance:.0f}, {pair})")


def check_narrow(page, name, sliders):
    """The same 400 pixels wide: one column, nothing beside the screen, controls large enough for a finger."""
    page = Page(page.browser, page.path, 400, 800)
    check(page.js("return document.documentElement.scrollWidth") <= 400, f"{name}: no scrolling sideways at 400 pixels")
    out = page.js("""return [...document.querySelectorAll("main *, footer *")].filter((e) => !e.closest(".scroll, pre, svg")
      && e.getBoundingClientRect().right > 400.5).map((e) => e.tagName + "#" + e.id)""")
    check(not out, f"{name}: nothing reaches beyond the screen {out or ''}")
    for slider in sliders:
        box = page.by_id(slider).rect
        check(box["width"] > 250 and box["height"] >= 24, f"{name}: {slider} can be moved by a finger")
    check_renders(page, name)


def check_run(page, path):
    with h5py.File(path) as file:
        iterations, kept = file["summary/iterations"][:], file["steps/step"][:]
    pictures = []
    page.by_id("step").send_keys(Keys.HOME)
    for k, step in enumerate(kept):
        if k > 0:
            page.by_id("step").send_keys(Keys.ARROW_RIGHT)
        page.settle()
        check(page.text("step-value").startswith(f"step {step},"), f"run: the slider goes to step {step}")
        if step > 0:
            check(page.text("step-text").startswith(f"{iterations[step - 1]:,} iteration"),
                  f"run: step {step} took {iterations[step - 1]} iterations")
            check(page.js("return document.querySelectorAll('#iterations path').length") >= 4,
                  "run: its indicators are drawn over the iterations")
        pictures.append(page.picture())
    check(all(a != b for a, b in zip(pictures, pictures[1:])), "run: force chains change from step to step")
    page.switch("contacts", False)
    check(page.picture() != pictures[-1], "run: force chains can be switched off")
    page.switch("contacts", True)
    reached = set(tab_through(page, lambda _: None))
    check({"scene", "step", "play", "layer-contacts"} <= reached, "run: Tab reaches all controls")


def check_print(page):
    page.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    check(not page.by_id("zoom-in").is_displayed() and page.by_id("rho").is_displayed(), "print: values without buttons")
    page.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})


def check_camera(page):
    """The camera of the page is that of the figures in space, and leaves the plane as it is."""
    code = script_of_page("camera.js")
    low, high = [-1.0, 2.0, 0.5], [4.0, 5.0, 9.0]
    points = np.random.default_rng(1).uniform(low, high, (50, 3))
    for azimuth, elevation in ((28, 16), (-75, 60), (200, -30)):
        seen = page.js(code + """
            const camera = createCamera(true), [points, low, high, azimuth, elevation] = arguments;
            camera.aim(low, high);
            camera.turn(azimuth, elevation);
            return points.map((p) => camera.project(...p));""", points.tolist(), low, high, azimuth, elevation)
        screen, nearness, scale = perspective.Camera(low, high, azimuth, elevation).project(points)
        far = np.abs(np.column_stack([screen, nearness, scale]) - seen).max()
        check(far < 1e-12, f"camera: it sees points where plots/perspective.py does ({far:.1e})")
    flat = page.js(code + "return arguments[0].map(([x, y]) => createCamera(false).project(x, y, 0))", points.tolist())
    check(np.array_equal(flat, np.column_stack([points[:, :2], np.zeros(50), np.ones(50)])), "camera: a plane stays")
    order = page.js(code + """
        const near = Float32Array.from(arguments[0]);
        return [...fromFarToNear(near, Math.min(...arguments[0]), Math.max(...arguments[0]))];""",
                    points[:, 0].tolist())
    check(sorted(order) == list(range(50)) and np.all(np.diff(points[order, 0]) > -1e-3), "camera: far things come first")


def check_space(page, name):
    """The camera turns, and lets one look into the packing."""
    page.by_id("scene").click()
    page.keys(Keys.ESCAPE, "0")
    first = page.picture()
    page.keys(Keys.ARROW_LEFT)
    turned = page.picture()
    page.keys(Keys.ARROW_RIGHT)
    check(page.picture() == first != turned, f"{name}: arrow keys turn the camera, and back")
    page.keys(Keys.ARROW_UP)
    check(page.picture() not in (first, turned), f"{name}: and up")
    ActionChains(page.browser, duration=0).key_down(Keys.SHIFT).send_keys(Keys.ARROW_LEFT).key_up(Keys.SHIFT).perform()
    page.settle()
    moved = page.picture()
    page.keys("0")
    check(page.picture() == first != moved, f"{name}: 0 brings back where it was seen from first")
    page.press("grain-size", Keys.HOME)
    small = page.picture()
    page.press("grain-size", Keys.END)
    large = page.picture()
    drawn = page.pixels()[1]
    check(len({first, small, large}) == 3, f"{name}: grains shrink and grow")
    check(page.by_id("grain-size").get_attribute("aria-valuetext") == "100 %", f"{name}: the slider says how much")
    page.press("cut", Keys.END)
    left = page.pixels()[1]
    check(0.005 < left < 0.8 * drawn, f"{name}: what lies in front is cut away ({drawn:.0%} to {left:.0%})")
    page.press("cut", Keys.HOME)
    page.switch("inner", False)
    check(0.01 < page.pixels()[1] < 0.95 * drawn, f"{name}: grains of the interface alone are shown")
    page.switch("inner", True)
    check(page.picture() == large, f"{name}: and all again")


def check_pages_in_space(browser, folder):
    """Spheres: the same page with a camera that turns."""
    nscdd(folder, "generate", "fcc", "--set", "packing.columns=6", "--set", "packing.rows=6", "--set",
          "packing.layers=6", "-o", "fcc.csv")
    grid = ["--epsilon", EPSILON, "--eta", ETA]
    cut = ["--subdomains", "2x2x2"]
    page = reported(browser, folder, "fcc.html", "fcc.csv", *cut, *grid)
    check_renders(page, "spheres")
    check_camera(page)
    check_sliders(page, rows(nscdd(folder, "sweep", "fcc.csv", *cut, *grid, "--csv", "-")))
    check_modes(page)
    check_space(page, "spheres")
    check_keyboard(page, IN_SPACE)
    check_mouse(page)
    check_contrast(page, "spheres")
    check("turn" in page.text("scene-help"), "spheres: the help says how to turn")
    page.quiet("spheres")
    check_narrow(page, "spheres", ("epsilon", "eta"))
    case = os.path.join(os.environ["NSCDD_SOURCE"], "studies/newton-scalability-in-space/deposit.toml")
    nscdd(folder, "simulate", case, "--algorithm", "generic", "--steps", "3", "--set", "solver.tolerance=1e-2",
          "--convergence", "bed.csv", "-o", "bed.h5")
    page = reported(browser, folder, "bed.html", "bed.h5", "--convergence", "bed.csv")
    check_renders(page, "run of spheres")
    check_run(page, os.path.join(folder, "bed.h5"))
    check_space(page, "run of spheres")
    check("512 spheres" in page.text("lead") and "Spheres" in page.text("facts"), "run of spheres: they are called so")
    page.by_id("scene").click()
    page.keys("n")
    check(page.text("grain").startswith("Sphere "), f"run of spheres: N names one: {page.text('grain')}")
    page.quiet("run of spheres")
    check_narrow(page, "run of spheres", ("step",))


def check_packing_pages(browser, folder):
    grid = ["--epsilon", EPSILON, "--eta", ETA]
    page = reported(browser, folder, "disks12.html", "disks12", *grid)
    swept = {contacts: rows(nscdd(folder, "sweep", "disks12", *grid, "--contacts", contacts, "--csv", "-"))
             for contacts in ("all", "active")}
    check_renders(page, "packing")
    check_sliders(page, swept["all"])
    check_modes(page)
    check_keyboard(page)
    check_mouse(page)
    check_sets(page, swept["active"])
    check_ticks(page, "packing")
    check_contrast(page, "packing")
    check_print(page)
    page.quiet("packing")
    check_narrow(page, "packing", ("epsilon", "eta"))
    page = reported(browser, folder, "hexagonal.html", "hexagonal", "--subdomains", "2x2", "--epsilon", "1",
                    "--eta", "1,inf")
    check_colours(page)
    page.quiet("lattice")


def check_alone(browser, folder):
    """Where no η is finite there is no point next to the best one."""
    page = reported(browser, folder, "generic.html", "disks12", "--epsilon", "1", "--eta", "inf")
    check("Best η" in page.text("best-text") and not page.by_id("go-best").is_displayed(), "best: no button without η")
    check("∞ 1/kg" not in page.text("figures"), "best: infinity has no unit")


def check_run_pages(browser, folder):
    nscdd(folder, "simulate", "settle-1k", "--algorithm", "generic", "--subdomains", "2x1", "--steps", "3", "--set",
          "solver.tolerance=1e-2", "--convergence", "run.csv", "-o", "run.h5")
    page = reported(browser, folder, "run.html", "run.h5", "--convergence", "run.csv")
    check_renders(page, "run")
    check_run(page, os.path.join(folder, "run.h5"))
    check_ticks(page, "run")
    check_contrast(page, "run")
    page.quiet("run")
    check_narrow(page, "run", ("step",))
    nscdd(folder, "simulate", "settle-1k", "--algorithm", "generic", "--subdomains", "30x30", "--steps", "1", "-o",
          "many.h5")
    page = reported(browser, folder, "many.html", "many.h5")
    check("900 subdomains" in page.text("facts"), "run: subdomains without a contact are counted")
    check_renders(page, "run of 900 subdomains")
    check_ticks(page, "run of one step")
    check(page.by_id("play").is_enabled(), "run: the first state and one step are played")
    one = reported(browser, folder, "one.html", "many.h5", "--steps", "1")
    check(not one.by_id("play").is_enabled(), "run: one step is not played")
    page.quiet("run of 900 subdomains")


def check_criterion(browser, folder):
    """The criterion of a run has a curve of its own and the line of its tolerance is called after that curve."""
    for criterion, tolerance, name in (("quad_dv", "1e-2", "Quad/DV"), ("mean_dv_over_r", "1e-3", "|mean DV over r|"),
                                       ("qm_16", "1e-1", "QM/16"), ("normal_change", "1e-3", "Σ|Δrₙ|/Σrₙ"),
                                       ("zeta", "1e-3", "ζ")):
        nscdd(folder, "simulate", "settle-1k", "--steps", "2", "--criterion", criterion, "--tolerance", tolerance,
              "--convergence", f"{criterion}.csv", "-o", f"{criterion}.h5")
        page = reported(browser, folder, f"{criterion}.html", f"{criterion}.h5", "--convergence", f"{criterion}.csv")
        for chart in ("criteria", "iterations"):
            keys = page.by_id(chart).find_element("css selector", ".keys").text.split("\n")
            check(name in keys, f"criterion: {name} is among the curves of {chart}, met {keys}")
            check(f"tolerance of {name}" in page.text(chart), f"criterion: the rule in {chart} is called {name}")
        check(f"{name} to " in page.text("facts"), f"criterion: the facts call it {name}")
        page.quiet(f"criterion {name}")


BODIES = """[packing]
file = "bodies.csv"
[partition]
grid = [{cells}]
[dynamics]
step = 0.01
steps = 20
gravity = [{gravity}]
[[boundary]]
name = "shelf"
shape = "plank"
{plank}
radius = 0.1
[[boundary]]
name = "clump"
shape = "grains"
first = 0
last = 1
centre = [{centre}]
free = [{free}]
mass = 1
inertia = {inertia}
"""
IN_PLANE = {"cells": "1, 1", "gravity": "0, -9.81", "plank": "from = [-1, 0]\nto = [1, 0]", "centre": "0, 0.3",
            "free": '"x", "y", "spin"', "inertia": "0.1"}
IN_SPACE_TOO = {"cells": "1, 1, 1", "gravity": "0, 0, -9.81", "centre": "0, 0, 0.3", "inertia": "[0.1, 0.1, 0.1]",
                "plank": "point = [0, 0, 0]\nnormal = [0, 0, 1]\naxis = [1, 0, 0]\nlength = 2\nwidth = 1",
                "free": '"x", "y", "z", "spin_x", "spin_y", "spin"'}


def check_bodies(browser, folder):
    """A clump on a plank: its disks look like free ones, and the plank has ends."""
    for name, values, grains in (("plane", IN_PLANE, "x,y,radius\n-0.1,0.3,0.1\n0.1,0.3,0.1\n"),
                                 ("space", IN_SPACE_TOO, "x,y,z,radius\n-0.1,0,0.3,0.1\n0.1,0,0.3,0.1\n")):
        Path(folder, "bodies.csv").write_text(grains, encoding="utf-8")
        Path(folder, "bodies.toml").write_text(BODIES.format(**values), encoding="utf-8")
        nscdd(folder, "simulate", "bodies.toml", "-o", "bodies.h5", "--force")
        page = reported(browser, folder, f"bodies-{name}.html", "bodies.h5")
        facts = page.text("facts")
        check("0 free, 2 of 1 body, 0 of boundaries" in facts, f"bodies in {name}: they are counted {facts[:60]}")
        walls = page.js("return JSON.parse(document.getElementById('data').textContent).steps.at(-1).walls")
        check([len(wall) for wall in walls] == [6 if name == "plane" else 12], f"bodies in {name}: the plank has ends")
        page.js("document.getElementById('scene').focus()")
        page.keys("n")
        check("of body clump" in page.text("grain"), f"bodies in {name}: a grain names its body {page.text('grain')}")
        if name == "plane":
            seen = page.pixels()[2]
            check((0x56, 0xb4, 0xe9) in {one[:3] for one in seen}, "bodies in plane: disks look like free ones")
            grey = [one for one in seen if abs(one[0] - 84) < 3 and one[0] == one[1] == one[2] and one[3] < 90]
            check(grey, f"bodies in plane: the plank is filled {list(seen)[:6]}")
        page.quiet(f"bodies in {name}")


BOX = """[packing]
generator = "deposit"
grains = 30
width = 3.0
radius_max = 0.198
[masses]
density = 2500
[partition]
grid = [1, 1]
[dynamics]
steps = 12
""" + "".join(f"[[boundary]]\nname = \"{name}\"\nshape = \"wall\"\nfrom = {start}\nto = {end}\n"
              for name, start, end in (("floor", [0, 0], [1, 0]), ("right", [3, 0], [3, 1]), ("left", [0, 1], [0, 0])))


def check_problems(browser, folder):
    """Contact problems: a network of LMGC90 is drawn, a file of FCLIB without places is not."""
    Path(folder, "box.toml").write_text(BOX, encoding="utf-8")
    nscdd(folder, "simulate", "box.toml", "-o", "box.h5")
    nscdd(folder, "export", "box.h5", "--lmgc90", "box")
    nscdd(folder, "export", "box.h5", "--fclib", "12", "-o", "box.hdf5")
    grid = ["--epsilon", "1", "--eta", "1,inf"]
    page = reported(browser, folder, "network.html", "box/OUTBOX/Vloc_Rloc.OUT.12", "--subdomains", "2x1", *grid)
    check("30 bodies" in page.text("lead") and page.by_id("picture").is_displayed(), "network: bodies are drawn")
    facts = page.text("facts")
    check(all(word in facts for word in ("Friction", "Rank of W", "Impulses, guess 1")), f"network: facts {facts[:80]}")
    page.js("document.getElementById('scene').focus()")
    page.keys("n")
    check(page.text("grain").startswith("Body 0: "), f"network: a body has its name {page.text('grain')}")
    check((0x56, 0xb4, 0xe9) in {one[:3] for one in page.pixels()[2]}, "network: bodies are coloured")
    page.quiet("network")
    page = reported(browser, folder, "problem.html", "box.hdf5", "--subdomains", "metis:2", *grid)
    check("no picture" in page.text("lead") and not page.by_id("picture").is_displayed(), "problem: has no picture")
    check(number(page.text("rho")) > 0, f"problem: has a radius {page.text('rho')}")
    page.quiet("problem")


def main():
    browser = open_browser()
    try:
        with tempfile.TemporaryDirectory() as folder:
            check_packing_pages(browser, folder)
            check_alone(browser, folder)
            check_run_pages(browser, folder)
            check_criterion(browser, folder)
            check_pages_in_space(browser, folder)
            check_bodies(browser, folder)
            check_problems(browser, folder)
    finally:
        browser.quit()
    if FAILED:
        sys.exit(f"{len(FAILED)} statements do not hold")


if __name__ == "__main__":
    main()
