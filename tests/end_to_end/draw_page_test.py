#!/usr/bin/env python3
"""The page of `draw -o page.html` in a browser: beads where the trajectory has them, colours, player, zoom, 3D, and no request
that leaves the page.

usage: draw_page_test.py TWINCELL SCRATCH [PICTURES]    (PICTURES: folder for screenshots)
Exits 77, saying so, where there is no chromium.
"""
import csv
import json
import pathlib
import subprocess
import sys

import h5py

from browser import check_fit, prepare, run, watched_browser

SCENE = """preset = "fortini-huang-2015"
[beads]
count = 60
[cell]
width = 12.0
[drive]
gamma = 2.0
[time]
discard = 0
cycles = 2
phases = 10
"""
BALLS = """[cell]
dimension = 3
width = 5.0
depth = 4.0
plates = "walls"
[beads]
count = 30
[drive]
gamma = 2.0
omega = 1.0
[time]
discard = 0
cycles = 1
phases = 5
"""


def slide(browser, id, value, event="input"):
    browser.value(f"(() => {{ const s = document.getElementById('{id}'); s.value = '{value}'; s.dispatchEvent(new Event('{event}')) }})()")


def frame(browser):
    return int(browser.value("document.body.dataset.frame"))


def table(program, trajectory, file):
    """Frames of the trajectory as lists of rows, from the program's table, in which y points down."""
    run(program, "export", trajectory, "--to", "csv", "-o", file, "-q")
    frames = {}
    for row in csv.DictReader(open(file)):
        frames.setdefault(int(row["frame"]), []).append(row)
    return frames


def colour_at(browser, x, y):
    """Colour on the canvas at a place in sigma, as the page projects it."""
    return browser.value(f"""(() => {{ const v = JSON.parse(document.getElementById('window').dataset.view), c = document.getElementById('cell');
      const px = v.x + v.scale * ({x} - v.centre[0]), py = v.y - v.scale * ({y} - v.centre[2]);
      return [...c.getContext('2d').getImageData(Math.round(px * devicePixelRatio), Math.round(py * devicePixelRatio), 1, 1).data].slice(0, 3) }})()""")


def check_beads(browser, frames, number):
    """Every bead of a frame has the colour of its speed at its place, and beside the bed there is none."""
    slide(browser, "frame", number)
    data = json.loads(browser.value("document.getElementById('data').textContent"))
    low, high = data["colour"]["range"]
    assert low < high
    worst = 0
    for row in frames[number]:
        speed = sum(float(row[v]) ** 2 for v in ("vx", "vy")) ** 0.5
        level = round(255 * (speed - low) / (high - low))
        wanted = [int(data["map"][level][k:k + 2], 16) for k in (1, 3, 5)]
        seen = colour_at(browser, float(row["x"]), -float(row["y"]))
        worst = max(worst, *(abs(a - b) for a, b in zip(seen, wanted)))
    assert worst <= 6, f"a bead has another colour than its speed: {worst} of 255"
    assert int(browser.value("document.body.dataset.shown")) == len(frames[number])
    top = max(-float(row["y"]) for row in frames[number]) + 0.8
    assert browser.value(f"""(() => {{ const v = JSON.parse(document.getElementById('window').dataset.view), c = document.getElementById('cell');
      return c.getContext('2d').getImageData(Math.round(v.x * devicePixelRatio), Math.round((v.y - v.scale * ({top} - v.centre[2])) * devicePixelRatio), 1, 1).data[3] }})()""") == 0, "nothing is drawn above the bed"


def check_player(browser):
    slide(browser, "frame", 0)
    slide(browser, "speed", 50, "change")
    browser.click("document.getElementById('play')")
    browser.wait("Number(document.body.dataset.frame) > 2", "the page plays")
    assert browser.value("document.getElementById('play').textContent") == "Pause"
    browser.click("document.getElementById('play')")
    stopped = frame(browser)
    browser.value("new Promise(r => setTimeout(r, 200))")
    assert frame(browser) == stopped, "paused"
    slide(browser, "frame", 5)
    browser.value("document.activeElement.blur()")
    browser.key("ArrowRight", 39)
    assert frame(browser) == 6
    browser.key("ArrowLeft", 37)
    assert frame(browser) == 5
    assert "cycle 0   phase 5/10   Gamma 2" in browser.value("document.getElementById('frame-label').textContent")


def check_zoom(browser):
    scale = "JSON.parse(document.getElementById('window').dataset.view).scale"
    before = browser.value(scale)
    slide(browser, "zoom", 4, "change")
    assert abs(browser.value(scale) / before - 4) < 1e-9
    bar = float(browser.value("document.getElementById('window').dataset.scaleBar"))
    slide(browser, "zoom", 1, "change")
    assert abs(browser.value(scale) / before - 1) < 1e-9
    assert float(browser.value("document.getElementById('window').dataset.scaleBar")) > bar
    x, y = browser.middle("document.getElementById('cell')")
    browser.call("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=-400)
    browser.wait(f"{scale} > {before} * 2", "the wheel zooms")
    slide(browser, "zoom", 1, "change")


def check_hover(browser, frames):
    slide(browser, "frame", 5)
    row = frames[5][7]
    place = f"""(() => {{ const v = JSON.parse(document.getElementById('window').dataset.view), b = document.getElementById('cell').getBoundingClientRect();
      return [b.x + v.x + v.scale * ({row['x']} - v.centre[0]), b.y + v.y - v.scale * ({-float(row['y'])} - v.centre[2])] }})()"""
    browser.middle("document.getElementById('cell')")
    x, y = browser.value(place)
    browser.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
    browser.wait("document.getElementById('readout').textContent.startsWith('bead 7: x ')", "a bead under the pointer says what it is")
    said = browser.value("document.getElementById('readout').textContent")
    assert f"x {float(row['x']):.2f}"[:5] in said and "speed" in said, said


def check_tracks(browser):
    painted = "(d => { let n = 0; for (let k = 3; k < d.length; k += 4) n += d[k] > 0; return n })(document.getElementById('cell').getContext('2d').getImageData(0, 0, document.getElementById('cell').width, document.getElementById('cell').height).data)"
    slide(browser, "frame", 15)
    before = browser.value(painted)
    slide(browser, "tracks", 5, "change")
    assert browser.value(painted) > before, "tracks are drawn"
    slide(browser, "tracks", 0, "change")


def check_arrows_and_lines(browser, frames, counts):
    """Arrows lie along the velocities, the longest 2 sigma long; contacts are lines as wide as their force; both can be hidden."""
    fastest = max(sum(float(row[v]) ** 2 for v in ("vx", "vy")) ** 0.5 for rows in frames.values() for row in rows)
    slide(browser, "frame", 3)
    assert int(browser.value("document.body.dataset.vectors")) == len(frames[3])
    on_arrow = 0
    for row in frames[3]:
        x, z = (float(row[r]) + 0.6 * 2 / fastest * float(row[v]) for r, v in (("x", "vx"), ("y", "vy")))
        beside = [colour_at(browser, x + px, -z) for px in (-0.015, 0, 0.015)]  # about a pixel
        on_arrow += any(red > green + 60 and red > blue + 60 for red, green, blue in beside)
    assert on_arrow > 0.8 * len(frames[3]), f"{on_arrow} of {len(frames[3])} arrows lie along their velocity"
    most = max(range(len(counts)), key=counts.__getitem__)
    slide(browser, "frame", most)
    assert 0.5 * counts[most] < int(browser.value("document.body.dataset.contacts")) <= counts[most]
    for name in ("vectors", "contacts"):
        browser.click(f"document.getElementById('{name}')")
        assert browser.value(f"document.body.dataset.{name}") == "0", f"{name} can be hidden"


def check_bound(program, folder, trajectory):
    done = subprocess.run([program, "draw", trajectory, "-o", folder / "page.html", "--contacts"], capture_output=True, text=True)
    assert done.returncode == 2 and "needs contacts" in done.stderr, done
    done = subprocess.run([program, "draw", trajectory, "-o", folder / "page.html", "--colour", "speed", "--colour-range", "2", "1"], capture_output=True, text=True)
    assert done.returncode == 2 and "a larger one" in done.stderr, done


def main():
    program, scratch = sys.argv[1], pathlib.Path(sys.argv[2]) / "draw_page_in_browser"
    pictures = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None
    chromium = prepare(scratch)
    (scratch / "flat.toml").write_text(SCENE)
    (scratch / "balls.toml").write_text(BALLS)
    for name in ("flat", "balls"):
        run(program, "simulate", scratch / f"{name}.toml", "-o", scratch / f"{name}.h5", "-q")
    check_bound(program, scratch, scratch / "flat.h5")
    page, solid = scratch / "flat.html", scratch / "balls.html"
    said = json.loads(run(program, "draw", scratch / "flat.h5", "-o", page, "--colour", "speed", "--json", "-q"))
    assert said["frames"] == 20 and abs(said["megabytes"] * 1e6 - page.stat().st_size) < 1, said
    run(program, "draw", scratch / "balls.h5", "-o", solid, "-q")
    frames = table(program, scratch / "flat.h5", scratch / "flat.csv")
    run(program, "simulate", scratch / "flat.toml", "--set", "drive.gamma=0.9", "--contacts", "-o", scratch / "held.h5", "-q")
    run(program, "draw", scratch / "held.h5", "-o", scratch / "held.html", "--vectors", "--contacts", "-q")
    held = table(program, scratch / "held.h5", scratch / "held.csv")
    counts = [int(n) for n in h5py.File(scratch / "held.h5")["twincell/contact_forces/count"][:]]
    with watched_browser(chromium) as browser:
        for width, height in ((1280, 900), (390, 844)):
            browser.open(page.resolve().as_uri(), width, height)
            check_fit(browser, width)
            for number in (0, 7, 19):
                check_beads(browser, frames, number)
            check_player(browser)
            check_zoom(browser)
            check_tracks(browser)
            if width == 1280:
                check_hover(browser, frames)
            if pictures:
                browser.picture(pictures / f"draw_page_{width}.png")
        assert browser.value("getComputedStyle(document.getElementById('with-vectors')).display") == "none", "no switch without velocities"
        browser.open((scratch / "held.html").resolve().as_uri(), 1280, 900)
        check_arrows_and_lines(browser, held, counts)
        browser.open(solid.resolve().as_uri(), 1280, 900)
        assert int(browser.value("document.body.dataset.shown")) == 30
        if pictures:
            browser.picture(pictures / "draw_page_3d.png")
    print("the page was used at 1280 and 390 px; nothing was asked of the outside")


main()
