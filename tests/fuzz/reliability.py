"""What fuzzers and sanitizers searched: kept in docs/reliability.csv, shown in docs/reliability.md. Called by ./run.

    reliability.py executions READER                                 how many inputs the reader had so far
    reliability.py add READER EXECUTIONS FINDINGS COMMIT SANITIZERS  keeps one campaign of a fuzzer
    reliability.py suite NAME TESTS JUNIT COMMIT SANITIZERS          keeps one run of tests, from what ctest wrote; TESTS
                                                                     says which they were
    reliability.py page                                              writes the page
"""
import csv
import datetime
import pathlib
import sys
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
LEDGER = ROOT / "docs/reliability.csv"
# One row per everything but the counts, which are added up.
COLUMNS = ["campaign", "subject", "executions", "findings", "date", "commit", "sanitizers"]


def readers():
    lines = (ROOT / "tests/fuzz/readers.txt").read_text().splitlines()
    return [line.split()[0] for line in lines if line and not line.startswith("#")]


def rows():
    if not LEDGER.exists():
        return []
    with LEDGER.open(newline="") as file:
        return list(csv.DictReader(file))


def summed(all_rows, without=()):
    """Rows that differ in nothing but their counts, and in the columns `without`, as one, in the place of the first; of
    what is left out the last is kept."""
    sums = {}
    for row in all_rows:
        key = tuple(row[c] for c in COLUMNS if c not in ("executions", "findings", *without))
        before = sums.get(key)
        sums[key] = row | {c: int(row[c]) + (int(before[c]) if before else 0) for c in ("executions", "findings")}
    return list(sums.values())


def executions(reader):
    return sum(int(r["executions"]) for r in rows() if r["campaign"] == "fuzz" and r["subject"] == reader)


def keep(campaign, subject, n, findings, commit, sanitizers):
    date = datetime.datetime.now(datetime.timezone.utc).date().isoformat()
    fresh = dict(zip(COLUMNS, [campaign, subject, int(n), int(findings), date, commit, sanitizers]))
    # A suite that is run again on one commit replaces what it said before; a fuzzer's inputs are new ones.
    old = [r for r in rows() if campaign == "fuzz" or any(r[c] != fresh[c] for c in ("campaign", "subject", "commit"))]
    whole = LEDGER.with_suffix(".csv.part")
    with whole.open("w", newline="") as file:
        out = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        out.writeheader()
        out.writerows(summed(old + [fresh]))
    whole.replace(LEDGER)


def suite(name, tests, junit, commit, sanitizers):
    said = xml.etree.ElementTree.parse(junit).getroot()
    ran = int(said.get("tests")) - int(said.get("skipped")) - int(said.get("disabled"))
    if ran == 0:
        sys.exit(f"reliability.py: {junit} holds no test that ran.")
    keep(name, tests, ran, said.get("failures"), commit, sanitizers)


def page():
    text = ["# Reliability", "",
            "`./run` wrote this page from docs/reliability.csv, which it keeps.", "",
            "**Fuzzing of readers** (`./run reliability`), as counted by clang's libFuzzer. It varies the files of `tests/fuzz/corpus` at",
            "random and keeps the variants that reach new code. A finding is an input that crashes the reader, takes 20 s, asks for more",
            "than a gigabyte, or causes an exception without a message for a user.",
            "The findings of `hdf5` are of the HDF5 library, from before a child process tried each file first (`SECURITY.md`).",
            "", "| campaign | reader | executions | findings | last run | commit | sanitizers |", "|---|---|---|---|---|---|---|"]
    table = lambda found: [f"| {' | '.join(str(r[c]) for c in [*COLUMNS[:4], 'date', 'commit', 'sanitizers'])} |" for r in found]
    fuzz = summed((r for r in rows() if r["campaign"] == "fuzz"), without=["date"])
    for name in readers():
        text += table(r for r in fuzz if r["subject"] == name) or [f"| fuzz | {name} | 0 | – | – | – | – |"]
    text += ["", "**Tests under sanitizers** (`./run asan`, `./run tsan`). A sanitizer ends a program in which it finds a fault, and the test",
             "then fails. The kernels for vector units (`sim/kernels/kernels_avx*.cpp`) and libraries are not instrumented; the agreement tests",
             "run the same source as scalar kernels.",
             "", "| campaign | tests | ran | failed | last run | commit | sanitizers |", "|---|---|---|---|---|---|---|"]
    suites = [r for r in rows() if r["campaign"] != "fuzz"]
    text += table(suites) or ["| – | – | 0 | – | – | – | – |"]
    (ROOT / "docs/reliability.md").write_text("\n".join(text) + "\n")


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["executions", reader]:
            print(executions(reader))
        case ["add", reader, n, findings, commit, sanitizers]:
            keep("fuzz", reader, n, findings, commit, sanitizers)
        case ["suite", name, tests, junit, commit, sanitizers]:
            suite(name, tests, junit, commit, sanitizers)
        case ["page"]:
            page()
        case _:
            sys.exit(__doc__)
