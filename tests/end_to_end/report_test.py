#!/usr/bin/env python3
"""A report in a browser: real clicks, keys and downloads, and no request that leaves the page.

usage: report_test.py TWINCELL SOURCE_DIR SCRATCH [PICTURES]    (PICTURES: folder for screenshots)
Talks to Debian's Chromium through a pipe (DevTools protocol); exits 77, saying so, where there is none.
"""
import json
import pathlib
import sys
import time

from browser import PATIENCE, check_fit, prepare, run, watched_browser


def make_report(program, source, scratch):
    """An experiment with its twin at Gamma = 0.9 and one more simulation, at Gamma = 1.6, without an experiment."""
    stack = source / "data_samples/demo/gamma-0.9"
    run(program, "match", stack, stack / "CELL.toml", "--twins", "1", "--set", "time.steps_per_contact=20", "-q", "-o", scratch / "twin")
    run(program, "simulate", source / "data_samples/demo/experiment.toml", "-q", "--set", "time.cycles=2", "-o", scratch / "more.h5")
    run(program, "compare", "-q", "-o", scratch / "report", "--no-film", "--experiment", scratch / "twin/experiment.h5",
        "--simulation", scratch / "twin/simulation-1.h5", scratch / "more.h5")
    return scratch / "report/report.html"


def circles(browser, side, what="circle"):
    return browser.value(f"document.querySelectorAll('#panel-{side} {what}').length")


def outline(browser, side):
    return browser.value(f"[...document.querySelectorAll('#panel-{side} .found circle')].map(c => c.getAttribute('cx') + c.getAttribute('cy')).join()")


def check_clicks(browser):
    """A click on a symbol of the phase diagram shows that bed."""
    point = "[...document.querySelectorAll('#phase-diagram .scatterlayer .point')].find(p => p.__data__.data === {})"
    names = browser.value("[...document.querySelectorAll('#phase-diagram .scatterlayer .point')].map(p => p.__data__.data)")
    assert set(names) >= {0, 1, 2}, f"symbols of runs 0, 1, 2 are drawn, not {names}"
    browser.click(point.format(2))
    browser.wait("document.body.dataset.run === '2'", "a click on the simulation at Gamma = 1.6 shows it")
    assert "1.6" in browser.value("document.getElementById('point-title').textContent")
    assert browser.value("document.getElementById('panel-experiment').hidden"), "no experiment was made there"
    assert circles(browser, "simulation", ".found circle") == 100
    alone = outline(browser, "simulation")
    browser.click(point.format(0))
    browser.wait("document.body.dataset.run === '0'", "a click on the experiment shows it")
    assert circles(browser, "experiment", ".found circle") == 100
    assert circles(browser, "simulation", ".found circle") == 100
    assert outline(browser, "simulation") != alone, "the twin is another bed"


def check_overlay(browser):
    """Frames, layers and colours follow the controls."""
    assert circles(browser, "experiment", "image.raw") == 1, "the camera's frame is shown"
    before = outline(browser, "experiment")
    browser.click("document.getElementById('moment')")
    browser.key("Home", 36)
    browser.wait("document.getElementById('moment-label').textContent.startsWith('cycle 0, phase 0')", "Home leads to the first frame")
    assert outline(browser, "experiment") != before, "another frame, other places"
    # The first frame: found beads lie on the dark discs of the picture, and the twin begins where they are.
    away = browser.value("""(() => { const at = s => [...document.querySelectorAll(`#panel-${s} .found circle`)].map(c => [+c.getAttribute('cx'), +c.getAttribute('cy')]);
      const e = at('experiment'), s = at('simulation');
      return Math.max(...s.map(p => Math.min(...e.map(q => Math.hypot(p[0] - q[0], p[1] - q[1]))))) })()""")
    assert away < 1.2, f"a bead of the twin begins {away:.2f} px from where the camera saw it (a tenth of a bead is 1.2 px)"
    dark = browser.value("""(async () => { const image = document.querySelector('#panel-experiment image.raw'), bitmap = new Image();
      bitmap.src = image.getAttribute('href'); await bitmap.decode();
      const canvas = document.createElement('canvas'); canvas.width = bitmap.width; canvas.height = bitmap.height;
      const pen = canvas.getContext('2d'); pen.drawImage(bitmap, 0, 0);
      const grey = (x, y) => pen.getImageData(Math.round(x), Math.round(y), 1, 1).data[0];
      const beads = [...document.querySelectorAll('#panel-experiment .found circle')].map(c => grey(+c.getAttribute('cx'), +c.getAttribute('cy')));
      return [Math.max(...beads), grey(bitmap.width / 2, 5)] })()""")
    assert dark[0] < 0.75 * dark[1], f"circles sit on beads: centres up to {dark[0]}, background {dark[1]}"
    browser.click("document.getElementById('layer-raw')")
    assert circles(browser, "experiment", "image.raw") == 0, "the frame can be taken away"
    browser.click("document.getElementById('layer-other')")
    assert circles(browser, "experiment", ".other circle") == 100, "the other side can be laid on top"
    browser.click("document.getElementById('layer-other')")
    browser.click("document.getElementById('layer-raw')")
    fills = {}
    for by in ("q6", "psi6", "structure", "coordination"):
        browser.value(f"(() => {{ const s = document.getElementById('colour'); s.value = '{by}'; s.dispatchEvent(new Event('change')) }})()")
        fills[by] = browser.value("[...new Set([...document.querySelectorAll('#panel-experiment .found circle')].map(c => c.getAttribute('fill') + c.getAttribute('stroke')))].sort().join()")
    assert len(set(fills.values())) == 4, f"each number has its colours: {fills}"
    browser.value("document.getElementById('moment').focus()")
    browser.key("End", 35)
    assert circles(browser, "experiment", ".tracks polyline") > 0, "tracers leave tracks"
    for film, same, differing, least in (("cycle", 0, 1, 4), ("strobe", 1, 0, 2)):  # parts of "cycle 3, phase 5/20"
        browser.value(f"document.getElementById('film').value = '{film}'")
        browser.value("(() => { window.watch?.disconnect(); window.played = []; window.watch = new MutationObserver(() => played.push(document.getElementById('moment-label').textContent))"
                      "; watch.observe(document.getElementById('moment-label'), {childList: true}) })()")
        browser.click("document.getElementById('play')")
        browser.wait("played.length >= 5", f"the film {film} plays")
        browser.click("document.getElementById('play')")
        parts = [label.split(", ") for label in browser.value("played")[:5]]
        assert len({p[same] for p in parts}) == 1 and len({p[differing] for p in parts}) >= least, f"{film}: {parts}"
    for name in ("s_k", "s_j"):
        assert browser.value(f"document.querySelectorAll('#series-{name} .scatterlayer .trace').length") >= 2, name


def check_tables(browser, downloads):
    column = "[...document.querySelectorAll('table[data-name=runs] tbody tr')].map(r => parseFloat(r.cells[2].innerText))"
    head = "document.querySelectorAll('table[data-name=runs] th')[2]"
    browser.click(head)
    assert browser.value(column) == sorted(browser.value(column)), "a click sorts"
    browser.click(head)
    assert browser.value(column) == sorted(browser.value(column), reverse=True), "another turns the order round"
    browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(downloads))
    browser.click("document.querySelector('table[data-name=runs]').closest('.scroll').previousElementSibling")
    until = time.monotonic() + PATIENCE
    while not (downloads / "runs.csv").exists():
        assert time.monotonic() < until, "runs.csv is not saved"
        time.sleep(0.1)
    lines = (downloads / "runs.csv").read_text().splitlines()
    assert len(lines) == 4 and lines[0].startswith("run,side,Γ,"), lines
    assert [line.split(",")[2] for line in lines[1:]] == ["1.6", "0.9", "0.9"], lines


def check_opening(browser):
    """Verdict, diagram and frames come first; the diagram has regions and does not reach below N_l = 0."""
    assert browser.value("document.title").startswith("Experiment and simulation: cell 10 σ wide, N_l = 10 (20"), browser.value("document.title")
    order = browser.value("['verdict', 'phase-diagram', 'panel-experiment'].map(id => document.getElementById(id).getBoundingClientRect().y + scrollY)"
                          ".concat(document.querySelector('nav').getBoundingClientRect().y + scrollY)")
    assert order[0] < min(order[1:3]) and max(order[1:3]) < order[3], order
    assert browser.value("document.querySelectorAll('#phase-diagram .shapelayer path').length") >= 2, "the phases are shaded"
    assert browser.value("document.getElementById('phase-diagram')._fullLayout.xaxis.range[0]") >= 0
    places = browser.value("[...document.querySelectorAll('#phase-diagram .scatterlayer .point')].filter(p => typeof p.__data__.data === 'number')"
                           ".map(p => (b => [b.x + b.width / 2, b.y + b.height / 2])(p.getBoundingClientRect()))")
    apart = min(max(abs(p[0] - q[0]), abs(p[1] - q[1])) for k, p in enumerate(places) for q in places[:k])
    assert apart >= 14, f"symbols of two runs are {apart:.0f} px apart"
    missing = browser.value("[...document.querySelectorAll('svg[role=img], [role=img], button, select, input')].filter(e => e.getClientRects().length && "
                            "!e.getAttribute('aria-label') && !e.labels?.length && !e.textContent.trim()).map(e => e.outerHTML.slice(0, 80))")
    assert not missing, f"without an alternative text: {missing}"


def check_panels(browser):
    """Both sides of a filmed twin are drawn in one scale, at one phase of one cycle."""
    widths = browser.value("['experiment', 'simulation'].map(s => document.querySelector(`#panel-${s} .found circle`).getBoundingClientRect().width)")
    assert abs(widths[0] / widths[1] - 1) < 0.01, f"a bead is {widths} px wide"
    boxes = browser.value("['experiment', 'simulation'].map(s => document.querySelector(`#panel-${s} svg`).getAttribute('viewBox'))")
    assert boxes[0] == boxes[1], boxes
    # The frame of the film is where its beads are: the lowest row stands above the plate of the picture.
    assert circles(browser, "simulation", "image.raw") == 1, "the film is shown"
    moments = browser.value("['experiment', 'simulation'].map(s => document.querySelector(`#panel-${s} figcaption`).textContent.match(/cycle [0-9]+, phase [0-9]+/)[0])")
    assert moments[0] == moments[1], moments


def check_print(browser):
    """The page is not wider than the paper."""
    browser.call("Emulation.setEmulatedMedia", media="print")
    browser.value("document.querySelectorAll('details.section').forEach(d => d.open = true)")
    wide = browser.value("document.documentElement.scrollWidth")
    assert wide <= 794, f"{wide} px wide on A4"
    assert "s_b" in browser.value("[...document.querySelectorAll('table[data-name=runs] th')].filter(h => h.getClientRects().length).map(h => h.innerText).join()").replace("sb", "s_b")
    browser.call("Emulation.setEmulatedMedia", media="screen")


def check_sections(browser):
    """Contents lead to their sections, sections fold, the differences are the real ones by default."""
    ids = browser.value("[...document.querySelectorAll('nav a')].map(a => a.getAttribute('href').slice(1))")
    assert len(ids) >= 8 and browser.value(f"{json.dumps(ids)}.every(id => document.getElementById(id).matches('details'))"), ids
    assert not browser.value("document.getElementById('conventions').open")
    browser.click("document.querySelector('nav a[href=\"#conventions\"]')")
    browser.wait("document.getElementById('conventions').open", "a link of the contents opens its section")
    browser.click("document.querySelector('#conventions > summary')")
    browser.wait("!document.getElementById('conventions').open", "a click on the heading folds a section")
    rows = "[...document.querySelectorAll('table[data-name=differences] tbody tr')].filter(r => r.getClientRects().length)"
    real = browser.value("document.querySelectorAll('table[data-name=differences] tr.real').length")
    every = browser.value("document.querySelectorAll('table[data-name=differences] tbody tr').length")
    assert browser.value(rows + ".length") == real < every, "only the real differences are shown"
    table = browser.value("(t => [t.scrollWidth, t.parentElement.clientWidth])(document.querySelector('table[data-name=differences]'))")
    assert table[0] <= table[1], f"what differences are made of is in sight: {table}"
    browser.click("document.getElementById('only-real')")
    assert browser.value(rows + ".length") == every, "the switch shows all"
    browser.click("document.getElementById('only-real')")


def check_theme_and_keys(browser):
    """The switch changes the colours of page and graphs; arrow keys go from run to run."""
    colours = "[getComputedStyle(document.body).backgroundColor, document.querySelector('#phase-diagram .bglayer .bg, #phase-diagram .main-svg').style.cssText]"
    before = browser.value(colours)
    browser.click("document.getElementById('theme')")
    after = browser.value(colours)
    assert before[0] != after[0] and before[1] != after[1], (before, after)
    browser.click("document.getElementById('theme')")
    assert browser.value(colours) == before
    run = browser.value("document.body.dataset.run")
    browser.value("document.getElementById('phase-diagram').focus()")
    browser.key("ArrowRight", 39)
    browser.wait(f"document.body.dataset.run !== '{run}'", "an arrow key shows another run")


def main():
    program, source, scratch = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]) / "report_in_browser"
    pictures = pathlib.Path(sys.argv[4]) if len(sys.argv) > 4 else None
    chromium = prepare(scratch)
    url = make_report(program, source, scratch).resolve().as_uri()
    with watched_browser(chromium) as browser:
        browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "light"}])
        browser.open(url, 1280, 900)
        check_fit(browser, 1280)
        check_opening(browser)
        check_sections(browser)
        check_theme_and_keys(browser)
        check_clicks(browser)
        check_overlay(browser)
        check_tables(browser, scratch)
        browser.open((scratch / "twin/report/report.html").resolve().as_uri(), 1280, 900)
        check_panels(browser)
        browser.open(url, 794, 1123)
        check_print(browser)
        if pictures:
            browser.picture(pictures / "laptop.png")
        browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
        browser.open(url, 390, 844)
        check_fit(browser, 390)
        assert browser.value("getComputedStyle(document.body).backgroundColor") == "rgb(21, 24, 28)", "dark as the system says"
        check_opening(browser)
        check_clicks(browser)
        if pictures:
            browser.picture(pictures / "phone.png")
    print("the report was clicked through at 1280 and 390 px; nothing was asked of the outside")


main()
