#!/usr/bin/env python3
"""The page of `locate --view` in a browser: sliders, hypotheses, tooltips, and no request that leaves the page.

usage: locate_view_test.py TWINCELL SOURCE_DIR SCRATCH [PICTURES]    (PICTURES: folder for screenshots)
Exits 77, saying so, where there is no chromium.
"""
import json
import pathlib
import sys

from browser import check_fit, prepare, run, watched_browser


def text(browser, id):
    return browser.value(f"document.getElementById('{id}').textContent")


def circles(browser, kind):
    return browser.value(f"document.querySelectorAll('#picture circle.{kind}').length")


def kept(browser):
    return int(browser.value("document.body.dataset.kept"))


def slide(browser, id, value, event="input"):
    browser.value(f"(() => {{ const s = document.getElementById('{id}'); s.value = '{value}'; s.dispatchEvent(new Event('{event}')) }})()")


def locate_again(program, browser, folder):
    """What the program finds with the command of the page, without its -o."""
    words = text(browser, "command").split()
    assert words[:2] == ["twincell", "locate"], words
    words[words.index("-o") + 1] = folder / "again.csv"
    said = json.loads(run(program, *words[1:], "--json", "-q"))
    return sum(f["beads"] for f in said["frames"][:12])


def check_run(browser, program, folder):
    """The page opens with what the run found."""
    assert circles(browser, "kept") == 100 and circles(browser, "dropped") == 0
    assert kept(browser) == 300
    assert "12.0" in text(browser, "sizes") and "found 300" in text(browser, "count")
    assert "--diameter" not in text(browser, "command"), "the run needed no option"
    assert locate_again(program, browser, folder) == 300
    tip = browser.value("document.querySelector('#picture circle.kept title').textContent")
    assert tip.startswith("bead: a bead") and "score" in tip, tip
    for name in ("diameter", "score"):
        assert browser.value(f"document.querySelectorAll('#histogram-{name} rect.bar-kept').length") >= 1
        assert "300 kept, 0 dropped" in browser.value(f"document.getElementById('histogram-{name}').getAttribute('aria-label')")
    places = "[...document.querySelectorAll('#picture circle')].map(c => c.getAttribute('cx') + ' ' + c.getAttribute('cy')).join()"
    before = browser.value(places)
    slide(browser, "frame", 2)
    assert text(browser, "frame-label") == "frame 2"
    assert browser.value(places) != before, "another frame, other places"
    slide(browser, "frame", 0)


def check_picture(browser):
    """Circles sit on dark discs of the picture that is in the page."""
    dark = browser.value("""(async () => { const bitmap = new Image(); bitmap.src = document.querySelector('#picture image').getAttribute('href'); await bitmap.decode();
      const canvas = document.createElement('canvas'); canvas.width = bitmap.width; canvas.height = bitmap.height;
      const pen = canvas.getContext('2d'); pen.drawImage(bitmap, 0, 0);
      const grey = (x, y) => pen.getImageData(Math.round(x), Math.round(y), 1, 1).data[0];
      const beads = [...document.querySelectorAll('#picture circle')].map(c => grey(+c.getAttribute('cx'), +c.getAttribute('cy')));
      return [Math.max(...beads), grey(bitmap.width / 2, 5)] })()""")
    assert dark[0] < 0.75 * dark[1], f"centres up to {dark[0]}, background {dark[1]}"


def check_residual(browser):
    """The residual takes the place of the frame: grey inside the beads, whose profile describes them; not everywhere."""
    shown = "document.querySelector('#picture image').getAttribute('href')"
    frame = browser.value(shown)
    levels = """(async () => { const image = document.querySelector('#picture image'), bitmap = new Image();
      bitmap.src = image.getAttribute('href'); await bitmap.decode();
      const canvas = document.createElement('canvas'); canvas.width = bitmap.width; canvas.height = bitmap.height;
      const pen = canvas.getContext('2d'); pen.drawImage(bitmap, 0, 0);
      const beads = [...document.querySelectorAll('#picture circle')].map(c =>
        pen.getImageData(Math.floor(+c.getAttribute('cx')), Math.floor(+c.getAttribute('cy')), 1, 1).data[0]);
      const all = pen.getImageData(0, 0, bitmap.width, bitmap.height).data.filter((v, k) => k % 4 === 0);
      return [beads, all.filter(v => Math.abs(v - 128) > 32).length / all.length, bitmap.width, +image.getAttribute('width')] })()"""
    beads, far, _, _ = browser.value(levels)
    assert beads and sum(abs(v - 128) > 32 for v in beads) > 0.9 * len(beads), "dark beads in the frame"
    browser.click("document.getElementById('layer-residual')")
    assert browser.value(shown) != frame
    beads, far, width, shown_width = browser.value(levels)
    assert sum(abs(v - 128) <= 16 for v in beads) > 0.9 * len(beads), beads
    assert 0.01 < far < 0.2 and width == shown_width, (far, width, shown_width)
    browser.click("document.getElementById('layer-residual')")
    assert browser.value(shown) == frame


def check_sliders(browser, program, folder):
    """Sliders change at once what is kept, with a reason, and the command says the same as the program finds."""
    slide(browser, "score", 1)
    assert kept(browser) == 0 and circles(browser, "lost") == 100, "no disc has the score 1"
    tips = browser.value("[...document.querySelectorAll('#picture circle title')].every(t => t.textContent.startsWith('unexplained: ') && t.textContent.includes('score below 1'))")
    assert tips, "each dropped candidate says why"
    assert "unexplained 100" in text(browser, "key")
    assert text(browser, "command").endswith("--min-explained 1")
    assert locate_again(program, browser, folder) == 0
    browser.click("document.getElementById('reset')")
    assert kept(browser) == 300 and "--min-explained" not in text(browser, "command")
    slide(browser, "size-0", 13)  # within 20 %: the same beads
    assert kept(browser) == 300
    assert "--diameter 13.00 --dark --refine exact" in text(browser, "command")
    assert locate_again(program, browser, folder) == 300
    slide(browser, "size-0", 17.5)
    assert kept(browser) < 100, "beads of 12 px are none of 17.5 px"
    browser.click("document.getElementById('reset')")


def check_hypotheses(browser):
    """Polarity and rows of the table show the candidates of other settings."""
    assert "chosen" in browser.value("document.querySelector('#tried tr[data-set=\"0\"]').className")
    slide(browser, "polarity", "bright", "change")
    assert "--bright" in text(browser, "command") and kept(browser) != 300
    rows = browser.value("[...document.querySelectorAll('#tried tr[data-set]')].map(r => r.dataset.set)")
    assert len(rows) >= 2, rows
    for row in rows:
        browser.click(f"document.querySelector('#tried tr[data-set=\"{row}\"]')")
        shown = browser.value("document.querySelector('#tried tr.chosen code').textContent")
        command = text(browser, "command")
        assert row == "0" or command.endswith(shown), (shown, command)
    browser.click("document.getElementById('reset')")
    assert kept(browser) == 300


def check_hover(browser):
    x, y = browser.middle("document.querySelector('#picture circle.kept')")
    browser.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
    browser.wait("document.getElementById('readout').textContent.startsWith('bead')", "a circle under the pointer says what it is")


def main():
    program, source, scratch = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]) / "locate_view_in_browser"
    pictures = pathlib.Path(sys.argv[4]) if len(sys.argv) > 4 else None
    chromium = prepare(scratch)
    page = scratch / "view.html"
    run(program, "locate", source / "data_samples/demo/gamma-0.9", "-q", "--frames", "0:3", "-o", scratch / "beads.csv", "--view", page)
    with watched_browser(chromium) as browser:
        for width, height in ((1280, 900), (390, 844)):
            browser.open(page.resolve().as_uri(), width, height)
            check_fit(browser, width)
            check_run(browser, program, scratch)
            check_picture(browser)
            check_residual(browser)
            check_sliders(browser, program, scratch)
            check_hypotheses(browser)
            if width == 1280:
                check_hover(browser)
            if pictures:
                browser.picture(pictures / f"locate_view_{width}.png")
                browser.click("document.getElementById('layer-residual')")
                browser.picture(pictures / f"locate_view_residual_{width}.png")
    print("the page was used at 1280 and 390 px; nothing was asked of the outside")


main()
