"""Runs every command block of README.md, docs/*.md and the examples of --help, as printed and in the order of the page, each
page in a folder that `twincell example` made. The examples of --help run with -q, which prints nothing unless something
fails; this holds every verb against that rule.

A command block is an indented or fenced block whose first word is a program or a loop. The line before a block may hold
    <!-- not run: REASON -->       the block takes long or needs what a test machine lacks
    <!-- needs PROGRAM -->         the block runs where PROGRAM is installed
    <!-- prints -->                the block is no command: its lines are among those that the commands before it print, in
                                   this order; "..." stands for lines that are left out, numbers may differ by 2 %
usage: pages_test.py TWINCELL SOURCE_FOLDER SCRATCH_FOLDER [PAGE...]     (PAGE: README.md, docs/NAME.md or --help)
"""
import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

program, source, scratch = map(os.path.abspath, sys.argv[1:4])
PROGRAMS = r"(for|source|twincell|mkdir|cd|\(cd|\./run|mpirun|cmake|ctest|gnuplot|lmp)\b"

# What a page promises about its results: (file or None for the printed text, what it contains).
PROMISES = {
    "docs/first_hour.md": [
        ("first-hour/CELL.png", ""), ("first-hour/cells/gamma-0.9.png", ""), ("first-hour/twins/report/report.html", ""),
        ("first-hour/twins/report/figures/boundaries.svg", ""),
        (None, "Same phase on both sides at 2 of 2 drive strengths."),
        (None, "Onset of bouncing: Gamma between 0.9 and 1.6"),
        (None, "compatible"),
    ],
}

# Examples of --help that do not run here, by the beginning of the command.
HELP_NOT_RUN = {
    "twincell reproduce": "takes ten minutes",
    "mpirun": "needs MPI ranks",
}


def blocks_of_page(text):
    """(lines, mark) of each block of commands or of what they print; mark is the comment before it or ''."""
    found, lines, fenced, i = [], text.splitlines(), False, 0
    while i < len(lines):
        mark = re.fullmatch(r"<!-- ((?:not run|needs|prints).*) -->", lines[i - 2].strip() if i > 1 and not lines[i - 1].strip() else lines[i - 1].strip() if i else "")
        block = []
        if lines[i].startswith("```"):
            i += 1
            while not lines[i].startswith("```"):
                block.append(lines[i])
                i += 1
        elif lines[i].startswith("    ") and (i == 0 or not lines[i - 1].strip() or lines[i - 1].startswith("<!--")):
            while i < len(lines) and lines[i].startswith("    "):
                block.append(lines[i][4:])
                i += 1
        i += 1
        if block and mark and mark.group(1) == "prints":
            found.append((block, "prints"))
        elif block and re.match(PROGRAMS, block[0]):
            found.append((joined(block), mark.group(1) if mark else ""))
    return found


def joined(lines):
    """Commands of a block; a line that ends with a backslash continues."""
    return [c for c in re.sub(r"\\\n\s*", "", "\n".join(lines)).split("\n") if c.strip()]


def help_of(*words):
    return subprocess.run([program, *words, "--help"], capture_output=True, text=True, check=True).stdout


def verbs_of(text):
    listed = re.search(r"^(?:Subc|C)ommands:?\s*$(.*)", text, re.M | re.S | re.I)
    return re.findall(r"^  ([a-z][a-z-]+)(?: |$)", re.split(r"^Example", listed.group(1), flags=re.M)[0], re.M) if listed else []


def blocks_of_help():
    found = []

    def visit(*words):
        text = help_of(*words)
        examples = re.search(r"^Examples?:\n((?:  .+\n?)+)", text, re.M)
        below = verbs_of(text)
        assert examples or not words, f"twincell {' '.join(words)} --help has no example"
        if words:
            for command in joined([line[2:] for line in examples.group(1).splitlines()]):
                why = next((w for start, w in HELP_NOT_RUN.items() if command.startswith(start)), "")
                found.append(([command], why and "not run: " + why))
        for verb in below:
            visit(*words, verb)

    visit()
    return found


def run_page(name):
    """(text to print, number of commands run, number not run, whether all went well)."""
    blocks = blocks_of_help() if name == "--help" else blocks_of_page(pathlib.Path(source, name).read_text())
    script, skipped, ran = ["set -e -o pipefail"], [], 0
    printed, first = [], 0  # (lines, first and last command that print them)
    for commands, mark in blocks:
        if mark == "prints":
            assert ran > first, f"{name}: what is printed by no command: {commands[0]}"
            printed.append((commands, first, ran))
            continue
        first = ran
        if mark.startswith("not run") or (mark.startswith("needs ") and not shutil.which(mark.split()[1])):
            skipped += [f"  not run: {c}   ({mark.removeprefix('not run: ')})" for c in commands]
            continue
        for command in commands:
            ran += 1
            script += ["echo \"@ $EPOCHREALTIME \"" + shell_quoted(command), quiet(command) if name == "--help" else command]
    script.append("echo \"@ $EPOCHREALTIME end\"")
    with tempfile.TemporaryDirectory(dir=scratch) as folder:
        home = pathlib.Path(folder)
        (home / "bin").mkdir()
        (home / "bin/twincell").symlink_to(program)
        subprocess.run([program, "example", home / "work"], check=True, capture_output=True)
        where = dict(os.environ, PATH=f"{home / 'bin'}:{os.environ['PATH']}", OMPI_ALLOW_RUN_AS_ROOT="1",
                     OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
        done = subprocess.run(["bash", "-c", "\n".join(script)], cwd=home / "work", env=where, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=280)
        marks = [(float(t), c) for t, c in re.findall(r"^@ (\d+\.\d+) (.*)$", done.stdout, re.M)]
        text = [f"== {name}: {ran} commands run, {len(skipped)} not run"]
        text += [f"  {after[0] - before[0]:5.1f} s  {before[1]}" for before, after in zip(marks, marks[1:])] + skipped
        outputs = re.split(r"^@ \d+\.\d+ .*\n", done.stdout, flags=re.M)[1:]
        good = done.returncode == 0
        if not good:
            text += [f"FAILED with exit code {done.returncode}: {marks[-1][1] if marks else ''}", done.stdout[-3000:]]
        for lines, begin, end in printed if good else []:
            missing = first_missing(lines, "".join(outputs[begin:end]).splitlines())
            if missing is not None:
                text.append(f"FAILED: the commands do not print, where the page says so: {missing}")
                good = False
        for file, phrase in PROMISES.get(name, []) if good else []:
            holds = phrase in done.stdout if file is None else (home / "work" / file).stat().st_size > 1000
            if not holds:
                text.append(f"FAILED: {file or 'the output'} lacks what the page promises: {phrase}")
                good = False
    return "\n".join(text), ran, len(skipped), good


NUMBER = r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?"


def same_line(stated, printed):
    """Whether the words are the same and the numbers differ by 2 % or two units of the last digit at most."""
    if re.sub(NUMBER, "#", stated).split() != re.sub(NUMBER, "#", printed).split():
        return False
    for a, b in zip(re.findall(NUMBER, stated), re.findall(NUMBER, printed)):
        mantissa, _, power = a.partition("e")
        unit = 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))
        if abs(float(a) - float(b)) > max(0.02 * abs(float(a)), 2.001 * unit if "." in a else 0):
            return False
    return True


def first_missing(lines, output):
    """The first of the lines that the output lacks, or has elsewhere; None if there is none."""
    at, anywhere = 0, True
    for line in lines:
        if line.strip() == "...":
            anywhere = True
            continue
        found = next((k for k in range(at, len(output)) if same_line(line, output[k])), None)
        if found is None or (not anywhere and found != at):
            return line
        at, anywhere = found + 1, False
    return None


def quiet(command):
    """The command with -q, which must print nothing; as it is if the verb prints for another program."""
    if re.match(r"twincell (help|completion|sweep template)\b", command) or not re.fullmatch(r"twincell [^|<>;&]+", command):
        return command
    return f'said=$({command} -q 2>&1); [ -z "$said" ] || {{ echo "-q does not silence: $said"; exit 1; }}'


def shell_quoted(word):
    return "'" + word.replace("'", "'\\''") + "'"


def main():
    pages = sys.argv[4:] or ["--help", "README.md"] + sorted(f"docs/{p.name}" for p in pathlib.Path(source, "docs").glob("*.md"))
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        results = list(pool.map(run_page, pages))
    for text, ran, skipped, _ in results:
        if ran + skipped:
            print(text)
    total = sum(r[1] for r in results)
    print(f"{total} commands run, {sum(r[2] for r in results)} not run, on {sum(1 for r in results if r[1])} pages")
    if not sys.argv[4:]:
        assert total >= 60, "the commands of the pages are not found"
    sys.exit(0 if all(r[3] for r in results) else 1)


main()
