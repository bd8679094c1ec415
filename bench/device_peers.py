#!/usr/bin/env python3
"""Beds on a graphics card beside one bed on a core of the same machine, in particle-steps per second of the clock.

usage: device_peers.py BUILD [--json] [--device gpu|host]

BUILD is the folder that holds bench/device_cost. Every bed of a row is the same bed of Fortini & Huang 2015; the bits
of all of them are compared with those of the bed on the core. Without a graphics card it says so and ends.
"""

import argparse
import json
from pathlib import Path

from measured import measured

# Layers of 20 beads, beds, samples a period.
ROWS = [(20, 1, 20), (20, 126, 20), (20, 126, 400), (40, 126, 400), (60, 126, 400), (6, 1056, 20), (20, 1056, 20)]
PERIODS = 1


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=Path)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--device", choices=["gpu", "host"], default="gpu")
    options = parser.parse_args()
    program = options.build / "bench" / "device_cost"
    rows = [measured(program, options.device, *row[:2], PERIODS, *row[2:]) for row in ROWS]
    if options.json:
        print(json.dumps(rows, indent=1))
        return
    print(rows[0]["device"])
    print(f"{'beads':>6} {'beds':>6} {'samples':>8} {'card, /s':>10} {'core, /s':>10} {'cores':>7} {'us/step':>8} {'same bits':>10}")
    for r in rows:
        print(
            f"{r['beads']:6} {r['beds']:6} {r['samples']:8} {r['rate']:10.3g} {r['core_rate']:10.3g} "
            f"{r['ratio']:7.1f} {r['us_per_step']:8.1f} {r['same_bits']:10}"
        )


if __name__ == "__main__":
    main()
