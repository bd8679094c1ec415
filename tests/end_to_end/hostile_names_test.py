#!/usr/bin/env python3
"""Names of files, columns and axes that are commands, tags or no text at all, through every verb that draws or writes.

usage: hostile_names_test.py TWINCELL SCRATCH

Each name goes through the same verbs as a harmless one. No command in it runs, no tag of it is a tag of a page, and
every JSON, TOML, SVG and XML file is one.
"""
import collections
import html.parser
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

try:
    import tomllib
except ImportError:  # Python before 3.11
    tomllib = None

HARMLESS = b"plain"
HOSTILE = [
    # A page, gnuplot, a terminal and the shell; the first goes through every verb, as it takes a minute.
    b"<img src=x onerror=alert(1)><b>\x1b]0;PWNED\x07x'.system(\"touch PWNED\").'$(touch PWNED)`touch PWNED`a\";touch PWNED;\"&touch PWNED",
    b"two\nlines = 1\n[PWNED] %{x} {@b} a_b^c &~ \\",
    b"\xff\xfe no text",
]
SCENE = ("preset = \"fortini-huang-2015\"\n[beads]\nlayers = 3\n[cell]\nwidth = 8\n[drive]\ngamma = 1.5\n"
         "[time]\ncycles = 2\ndiscard = 0\n")
faults = []


def fault(name, text):
    faults.append(f"{name!r}: {text}")


class Tags(html.parser.HTMLParser):
    """Tags with the names of their attributes, as a browser would see them."""

    def __init__(self):
        super().__init__()
        self.seen = collections.Counter()

    def handle_starttag(self, tag, attributes):
        self.seen[(tag, tuple(sorted(key for key, _ in attributes)))] += 1


class Session:
    def __init__(self, program, name, folder):
        self.program, self.name, self.folder = program, name, folder

    def run(self, *words, code=0):
        done = subprocess.run([self.program, *words], cwd=self.folder, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        said = done.stderr.decode(errors="replace")
        if done.returncode != code:
            fault(self.name, f"{words}: exit code {done.returncode}: {said[-400:]}")
        if re.search(r"[\x00-\x08\x0b-\x1f]", re.sub(r"\r[^\n]*", "", said)):
            fault(self.name, f"{words}: control characters on stderr: {said!r}")
        if b"--json" in [os.fsencode(w) for w in words]:
            try:
                json.loads(done.stdout)
            except ValueError as error:
                fault(self.name, f"{words}: no JSON on stdout: {error}")
        return done.stdout

    def all_verbs(self, thorough):
        n = b"./" + self.name
        put = lambda ending, text: (self.folder / os.fsdecode(self.name + ending)).write_bytes(text)
        put(b".toml", SCENE.encode())
        self.run("simulate", n + b".toml", "-o", n + b".h5", "--json", "-q")
        self.run("info", n + b".h5", "--json")
        self.run("validate", n + b".h5")
        self.run("explain", n + b".toml", "--json")
        self.run("measure", n + b".toml", "-o", n + b".m.h5", "--json", "-q")
        self.run("analyze", n + b".h5", "-o", n + b".r.h5", "--figures", n + b".fig", "--json", "-q")
        self.run("render", n + b".h5", "-o", n + b".frames", "--movie", n + b".avi", "--json", "-q")
        self.run("info", n + b".avi", "--json")
        self.run("draw", n + b".h5", "-o", n + b".drawn.png", "--json", "-q")
        self.run("draw", n + b".h5", "-o", n + b".drawn.avi", "--frames", ":2", "--json", "-q")
        cell = n + b".frames/CELL.toml"
        self.run("locate", n + b".frames", "--frames", "0:2", "-o", n + b".csv", "--overlay", n + b".png",
                 "--debug-dir", n + b".debug", "--view", n + b".html", "--json", "-q")
        self.run("track", n + b".frames", "--cell", cell, "-o", n + b".t.h5", "--csv", n + b".t.csv", "--json", "-q")
        self.run("compare", "--experiment", n + b".t.h5", "--simulation", n + b".h5", "-o", n + b".report", "--json",
                 "-q")
        for kind in ("beads", "plate", "walls"):
            self.run("calibrate", kind, n + b".frames", "--cell", cell, "-o", n + b".cal.toml", "--figures",
                     n + b".cal." + kind.encode(), "--json", "-q")
        self.deck(n)
        self.fit(n, put)
        self.sweep(n, put)
        if thorough:
            self.run("match", n + b".frames", cell, "-o", n + b".twin", "--json", "-q")
            self.run("reproduce", "p1-appendix", "-o", n + b".reproduced", "--json", "-q")
            self.run("cost", "calibration", "--quick", "-o", n + b".cost", "--json", "-q")

    def deck(self, n):
        said = self.run("export", n + b".toml", "--to", "lammps", "-o", n + b".deck", "--json", "-q")
        try:
            command = json.loads(said)["run"].split(" && ")[0]
        except ValueError:
            return
        if b"\xff" not in self.name:  # JSON cannot hold that one
            where = subprocess.run(["sh", "-c", command + " && pwd"], cwd=self.folder, stdout=subprocess.PIPE).stdout
            if not where.rstrip(b"\n").endswith(self.name + b".deck"):
                fault(self.name, f"the shell makes {where} of {command}")

    def fit(self, n, put):
        column = self.name.replace(b"\n", b" ").replace(b",", b" ").replace(b"\"", b"")
        rows = b"".join(b"%d,%g,0.1\n" % (k, 2.5 * k + (k % 3) * 0.05) for k in range(1, 9))
        put(b".table.csv", b"x," + column + b",s" + b"\n" + rows)
        self.run("fit", n + b".table.csv", "--law", "line", "--x", "x", "--y", column, "--sigma", "s", "-o",
                 n + b".fitted", "--json", "-q")
        if self.name == HARMLESS:
            return
        put(b".table2.csv", column + b",y\n" + rows.replace(b",0.1", b""))
        self.run("fit", n + b".table2.csv", "--law", "line", "-o", n + b".fitted2", "--json", "-q")

    def sweep(self, n, put):
        if b"\xff" in self.name:  # TOML cannot name such a scene
            scene = SCENE_TABLE
        else:
            scene = "scene = " + json.dumps(os.fsdecode(self.name) + ".toml") + "\n"
        put(b".plan.toml", (scene + "[axes]\ndrive.gamma = [1.2, 1.4]\nstart.kind = [\"crystal_a\", \"crystal_b\"]\n")
            .encode())
        for verb in ("plan", "run", "status"):
            self.run("sweep", verb, n + b".plan.toml", "--folder", n + b".swept", "--json", "-q")
        self.run("sweep", "collect", n + b".plan.toml", "--folder", n + b".swept", "-o", n + b".results.json", "--json",
                 "-q")
        # What a scheduler would run, with a program in twincell's place that does nothing.
        stubs = self.folder / "stubs"
        stubs.mkdir(exist_ok=True)
        for program in ["twincell"] + ([] if shutil.which("parallel") else ["parallel"]):
            (stubs / program).write_text("#!/bin/sh\nexit 0\n")
            (stubs / program).chmod(0o755)
        for engine in ("slurm", "parallel"):
            script = self.run("sweep", "template", engine, n + b".plan.toml", "--folder", n + b".swept")
            done = subprocess.run(["bash", "-c", script], cwd=self.folder, stderr=subprocess.PIPE,
                                  env={**os.environ, "PATH": f"{stubs}:{os.environ['PATH']}"})
            if done.returncode != 0:
                fault(self.name, f"the script of sweep template {engine} fails: {done.stderr}")

    def look(self):
        """What lies there now: tags of pages, and files that are not what they should be."""
        tags = collections.Counter()
        for folder, folders, files in os.walk(os.fsencode(self.folder)):
            for entry in folders + files:
                if entry == b"PWNED":
                    fault(self.name, f"a command was run: {os.path.join(folder, entry)!r}")
            for entry in files:
                path = os.path.join(folder, entry)
                ending = os.path.splitext(entry)[1]
                with open(path, "rb") as file:
                    data = file.read()
                try:
                    if ending == b".json":
                        json.loads(data)
                    elif ending == b".svg":
                        xml.etree.ElementTree.fromstring(data)
                    elif ending == b".toml" and tomllib:
                        document = tomllib.loads(data.decode())
                        if "PWNED" in document or "lines" in document:
                            fault(self.name, f"{path!r}: a name became a key")
                    elif ending == b".html":
                        page = Tags()
                        page.feed(data.decode())
                        tags += page.seen
                        for text in re.findall(rb"<script type=\"application/json\"[^>]*>(.*?)</script>", data, re.S):
                            json.loads(text)
                except (ValueError, xml.etree.ElementTree.ParseError) as error:
                    fault(self.name, f"{path!r}: {error}")
                if entry.endswith(b".lammps") or entry.startswith(b"in."):
                    for line in data.splitlines():
                        if b"PWNED" in line and not line.startswith(b"#"):
                            fault(self.name, f"{path!r}: outside a comment: {line!r}")
        return tags


SCENE_TABLE = "[scene]\n" + re.sub(r"\[(\w+)\]", r"[scene.\1]", SCENE)


def main():
    program, scratch = sys.argv[1], pathlib.Path(sys.argv[2])
    tags = {}
    for k, name in enumerate([HARMLESS] + HOSTILE):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="hostile-", dir=scratch))
        try:
            session = Session(program, name, folder)
            session.all_verbs(thorough=k < 2)
            tags[name] = session.look()
            if k >= 2 or name == HARMLESS:
                continue
            if tags[name] != tags[HARMLESS]:
                fault(name, f"other tags in pages: {tags[name] - tags[HARMLESS]}, missing "
                            f"{tags[HARMLESS] - tags[name]}")
        finally:
            shutil.rmtree(os.fsencode(folder))
    print(f"{len(HOSTILE)} hostile names, {sum(tags[HARMLESS].values())} tags in pages, {len(faults)} faults")
    for text in faults:
        print("FAULT " + text.encode(errors="backslashreplace").decode())
    sys.exit(1 if faults else 0)


main()
