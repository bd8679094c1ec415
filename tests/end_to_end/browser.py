"""Debian's Chromium without a window, driven through a pipe (DevTools protocol), and what every page must satisfy."""
import base64
import contextlib
import fcntl
import json
import os
import pathlib
import select
import shutil
import subprocess
import sys
import tempfile
import time

PATIENCE = 60  # s


def skip(why):
    print("skipped: " + why)
    sys.exit(77)


class Browser:
    """Chromium without a window."""

    def __init__(self, program, profile):
        here_out, there_in = os.pipe()[::-1]
        there_out, here_in = os.pipe()[::-1]
        # The child's ends become 3 and 4, so none may be there already.
        ends = [fcntl.fcntl(fd, fcntl.F_DUPFD, 10) for fd in (there_in, there_out)]

        def pass_ends():
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        self.process = subprocess.Popen(
            [program, "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
             "--disable-component-update", "--disable-background-networking", "--remote-debugging-pipe",
             "--user-data-dir=" + str(profile), "about:blank"],
            close_fds=False, preexec_fn=pass_ends, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for fd in (there_in, there_out, *ends):
            os.close(fd)
        self.out, self.inward = here_out, here_in
        self.buffer, self.number, self.events, self.session = b"", 0, [], None

    def message(self, until):
        while b"\0" not in self.buffer:
            ready, _, _ = select.select([self.inward], [], [], max(0, until - time.monotonic()))
            if not ready:
                raise TimeoutError("the browser does not answer")
            piece = os.read(self.inward, 1 << 20)
            if not piece:
                raise RuntimeError("the browser is gone")
            self.buffer += piece
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, **parameters):
        self.number += 1
        request = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            request["sessionId"] = self.session
        os.write(self.out, json.dumps(request).encode() + b"\0")
        until = time.monotonic() + PATIENCE
        while True:
            answer = self.message(until)
            if answer.get("id") == self.number:
                assert "error" not in answer, f"{method}: {answer['error']}"
                return answer["result"]
            self.events.append(answer)

    def value(self, expression):
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in result, f"{expression}: {result['exceptionDetails']}"
        return result["result"].get("value")

    def wait(self, expression, what):
        until = time.monotonic() + PATIENCE
        while not self.value(expression):
            assert time.monotonic() < until, f"waited in vain: {what}"
            time.sleep(0.05)

    def open(self, url, width, height):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600)
        self.call("Page.navigate", url=url)
        self.wait("document.readyState === 'complete' && document.body.dataset.ready === 'yes'", "the page says that it is ready")

    def middle(self, expression):
        """Where the element is, scrolled into sight."""
        self.value(f"({expression}).scrollIntoView({{block: 'center', behavior: 'instant'}})")
        time.sleep(0.1)
        box = self.value(f"(b => [b.x + b.width / 2, b.y + b.height / 2])(({expression}).getBoundingClientRect())")
        assert box, expression
        return box

    def click(self, expression):
        x, y = self.middle(expression)
        for kind, more in (("mouseMoved", {}), ("mousePressed", {"button": "left", "clickCount": 1}), ("mouseReleased", {"button": "left", "clickCount": 1})):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)
            time.sleep(0.1)

    def key(self, name, code):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=name, code=name, windowsVirtualKeyCode=code)

    def picture(self, file):
        size = self.call("Page.getLayoutMetrics")["cssContentSize"]
        shot = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=True,
                         clip={"x": 0, "y": 0, "width": size["width"], "height": min(size["height"], 6000), "scale": 1})
        pathlib.Path(file).write_bytes(base64.b64decode(shot["data"]))


def run(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    assert done.returncode == 0, f"{words}: {done.stderr}"
    return done.stdout


def prepare(scratch):
    """Empties the folder of a test and returns the path of the browser. Without a browser the test is skipped."""
    chromium = shutil.which("chromium")
    if not chromium:
        skip("no chromium here (Debian: chromium), so the page was not opened")
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir(parents=True)
    return chromium


@contextlib.contextmanager
def watched_browser(program):
    """A browser for a `with` block, at whose end no page has asked anything of the outside or raised an error."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = open_browser(program, profile)
        try:
            yield browser
            check_no_request(browser)
        finally:
            browser.process.terminate()
            browser.process.wait()


def open_browser(program, profile):
    """A browser with one empty page, whose requests and errors are watched."""
    browser = Browser(program, profile)
    target = browser.call("Target.createTarget", url="about:blank")["targetId"]
    browser.session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
    for domain in ("Page", "Runtime", "Network"):
        browser.call(domain + ".enable")
    return browser


def check_fit(browser, width):
    wide = browser.value("document.documentElement.scrollWidth")
    assert wide <= width, f"the page is {wide} px wide on a screen of {width}"
    small = browser.value("Math.min(...[...document.querySelectorAll('p, td, th, figcaption, label, .plotly text')].filter(e => e.getBoundingClientRect().width > 0).map(e => parseFloat(getComputedStyle(e).fontSize)))")
    assert small >= 10, f"letters of {small} px"


def check_no_request(browser):
    outside = [e["params"]["request"]["url"] for e in browser.events if e.get("method") == "Network.requestWillBeSent"]
    assert outside, "requests are watched"
    assert all(url.startswith(("file:", "data:", "blob:")) for url in outside), outside
    errors = [e["params"]["exceptionDetails"] for e in browser.events if e.get("method") == "Runtime.exceptionThrown"]
    assert not errors, errors
