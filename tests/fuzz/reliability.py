"""What the fuzzers counted: kept in docs/reliability.csv, shown in docs/reliability.md. Called by ./run reliability.

    reliability.py executions READER                                 how many inputs the reader had so far
    reliability.py add READER EXECUTIONS FINDINGS COMMIT SANITIZERS  keeps one campaign
    reliability.py page                                              writes the page
"""
import csv
import datetime
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
LEDGER = ROOT / "docs/reliability.csv"
COLUMNS = ["reader", "executions", "findings", "date", "commit", "sanitizers"]


def readers():
    lines = (ROOT / "tests/fuzz/readers.txt").read_text().splitlines()
    return [line.split()[0] for line in lines if line and not line.startswith("#")]


def campaigns():
    if not LEDGER.exists():
        return []
    with LEDGER.open(newline="") as file:
        return list(csv.DictReader(file))


def executions(reader):
    return sum(int(c["executions"]) for c in campaigns() if c["reader"] == reader)


def add(reader, n, findings, commit, sanitizers):
    fresh = not LEDGER.exists()
    with LEDGER.open("a", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        if fresh:
            out.writerow(COLUMNS)
        date = datetime.datetime.now(datetime.timezone.utc).date().isoformat()
        out.writerow([reader, int(n), int(findings), date, commit, sanitizers])


def page():
    """One line per reader, commit and set of sanitizers; campaigns of a kind are added up."""
    sums = {}
    for c in campaigns():
        key = (c["reader"], c["commit"], c["sanitizers"])
        n, findings, _ = sums.get(key, (0, 0, ""))
        sums[key] = (n + int(c["executions"]), findings + int(c["findings"]), c["date"])
    text = ["# Reliability", "",
            "`./run reliability` wrote this page from docs/reliability.csv, which it keeps: what clang's libFuzzer counted.",
            "An input is made from the files of `tests/fuzz/corpus` by chance and by what code it reaches. A finding is an input",
            "that crashes the reader, lasts 20 s, asks for more than a gigabyte, or meets an exception that says nothing to a user.",
            "", "| campaign | reader | executions | findings | last run | commit | sanitizers |", "|---|---|---|---|---|---|---|"]
    for name in readers():
        rows = [(k, v) for k, v in sums.items() if k[0] == name]
        for (_, commit, sanitizers), (n, findings, date) in rows:
            text.append(f"| fuzz | {name} | {n} | {findings} | {date} | {commit} | {sanitizers} |")
        if not rows:
            text.append(f"| fuzz | {name} | 0 | – | – | – | – |")
    (ROOT / "docs/reliability.md").write_text("\n".join(text) + "\n")


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["executions", reader]:
            print(executions(reader))
        case ["add", reader, n, findings, commit, sanitizers]:
            add(reader, n, findings, commit, sanitizers)
        case ["page"]:
            page()
        case _:
            sys.exit(__doc__)
