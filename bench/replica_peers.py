#!/usr/bin/env python3
"""Beds that differ in the seed, one in each lane of the SIMD vectors, beside the list solver, in processor time.

usage: replica_peers.py BUILD [--json] [--gamma GAMMA]

BUILD is the folder that holds bench/replica_cost, which says what is compared. Every row is one run, so only ratios
within a row compare. Needs AVX-512; without it, it says so and ends.
"""

import argparse
import json
from pathlib import Path

from measured import measured

WIDTHS = [3, 5, 7, 14]  # 36, 100, 196, 784 beads


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=Path)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--gamma", type=float, default=2.0)
    options = parser.parse_args()
    rows = [measured(options.build / "bench" / "replica_cost", width, options.gamma) for width in WIDTHS]
    if options.json:
        print(json.dumps(rows, indent=1))
        return
    print("time of the list solver over that of replicas, and visited pairs per bead and step")
    print(f"{'beads':>6} {'matched':>8} {'no lists':>9} {'alike':>6} {'list':>9} {'matched':>8} {'alike':>6}  bits")
    for r in rows:
        print(
            f"{r['beads']:6} {r['ratio_matched']:8.2f} {r['ratio_matched_without_lists']:9.2f} {r['ratio_alike']:6.2f} "
            f"{r['list_visits']:9.2f} {r['matched_visits']:8.2f} {r['alike_visits']:6.2f}  "
            f"{'same' if r['same_bits'] else 'DIFFERENT'}"
        )


if __name__ == "__main__":
    main()
