"""docs/validation.md from what the verification tests print: `ctest -L verification -V | validation_page.py PAGE`.

Every checked number is one line, VALIDATION|id|test|law or case|outside number|measured|error|tolerance|source
(tests/support/validation.hpp). The page appears whole or not at all."""

import os
import re
import sys

HEAD = """# Validation results

`./run validation` generates this page: it runs the verification tests and records the numbers that they print. Each row compares one number from
outside the code (closed form, paper, other program) with the number that the program gives. A row without an outside number of its own measures an
error, and its outside number is 0. Tolerances are absolute and two-sided. If the reference is a bound, the row states the bound and has no error. For
averages over many beads the tolerance is at least twice the standard error.

| id | law or case | outside number | source | measured | error | tolerance | test |
|---|---|---|---|---|---|---|---|
"""

TAIL = """
## Notes on individual rows

- **V2.4.** With the spring law and `tangential = "spring"`, the spring takes up the dashpot's share at the Coulomb limit. In a fast oblique impact with a
  strong tangential dashpot the force then follows k_t v_t instead of staying at μ|F_n|. This is a property of that reading of "truncate". The sliding
  test therefore uses the dashpot with a slider and no spring (`tangential = "dashpot"`).
- **V3.1.** A contact that begins a fraction θ into a step gives velocity Verlet an energy error of (ω₀Δt)² θ(1−θ) of the energy of approach. A contact
  that ends there gives the opposite error. In a gas of N beads the energy performs a random walk: after N_c collisions its relative change is
  (π/n)² √(N_c/45)/N. At n = 50 and N = 256 this reaches 1e-4 after about 2000 collisions. The energy does not drift, but Verlet cannot keep it to 1e-4
  over 1e7 steps, which the verification plan requires. The split integrator does not show this random walk: `integrator = "split"` with
  `steps_per_contact = 100` keeps the required 1e-4, and the required 1e-5 of fitted drift, over the 1e7 steps. With `steps_per_contact = 50` it keeps
  1e-4 over one twentieth of these steps.
- **V3.5.** Henderson's formula is 1.2 % above the virial series at φ = 0.6, so the series is the outside number there. Its coefficients are those of Table 1
  of Clisby and McCoy; B₃ and B₄ are closed forms. The disc fluid freezes only at φ = 0.70. Soft beads are compared through the Barker–Henderson
  diameter, and by extrapolation from three stiffnesses to infinite stiffness.
- **V4.1.** N is limited to 400. In larger systems long shear modes, which cool more slowly than the other modes, hold several per cent of the energy
  at t = 5 τ.
- **V4.4.** Janssen (1895): F/W = (1 − exp(−x))/x, x = 2 μ K H/L in a plane cell of width L with a bed of height H. K = (1 − sin²φ)/(1 + sin²φ) (Krynine 1945)
  is the ratio of stresses at a wall where friction is fully mobilised, with tan φ = μ. H is measured. The share differs by 0.1 from one
  packing to the next; the tolerance is two standard errors of the mean of six.
- **V4.7.** The split integrator at n = 50 reaches here what plain Verlet steps reach at n = 500: near the bifurcation the scatter of e over entry phases
  must be below 1e-3.
- **V4.14.** In this test the middle of the cell is at x = 0. With another origin a mirror image is rounded differently, and the differences grow from 1e-16.

## Other checks

| what | against | test |
|---|---|---|
| lattices at the start | 2D: rows of 20 and 19 beads; 3D: 12 neighbours, 6 of them in the layer, a mirror plane; gap 0 | `unit.Crystal.*` |
| polydisperse bead sizes | variance of a uniform and of a truncated normal distribution; mass proportional to R² or R³ | `unit.Sizes.*` |
| neighbour search by cells | all pairs and images, size ratio 1 : 100; the number of candidates per bead is independent of the number of beads | `unit.CellGrid.*` |
| every solver, law, dimension and integrator; neighbour lists built at every step or never (V2.14) | each other and the all-pairs oracle, bit for bit | `agreement.*` |
| fits | exact data; NIST's certified problems; coverage of the 95 % intervals | `recovery.*Fit*`, `recovery.Nist.*` |
| correlated series, bootstraps, binomial intervals | coverage over synthetic processes with known truth | `unit.Statistics.*` |
| locator on synthetic frames | recall and precision 1; rms error against the Cramér–Rao bound | `tests/recovery/imaging/locator_test.cpp` |
| locator and linker on real frames | published centres and identities (Lafaye de Micheaux et al. 2018) | `tests/recovery/imaging/real_images_test.cpp` |
| camera → tracker → trajectory | the trajectory that was filmed | `tests/recovery/imaging/closed_loop_test.cpp` |
| both papers' models, driven | LAMMPS's positions, to rounding and its growth | `tests/end_to_end/lammps_test.cpp` |
| H5MD file | h5py: the same bits; MDAnalysis: the same numbers | `end_to_end.client_*` |
"""


def order(row):
    return [int(number) for number in re.findall(r"\d+", row[0])]


def main():
    rows = []
    for line in sys.stdin:
        found = re.match(r"(?:\d+: )?VALIDATION\|(.*)$", line.rstrip("\n"))
        if found:
            fields = found.group(1).split("|")
            # A bar in a field stands for an absolute value: |spin|.
            if len(fields) != 8:
                fields = [fields[0], fields[1], "|".join(fields[2:-5])] + fields[-5:]
            rows.append(fields)
    if not rows:
        sys.exit("validation_page: the tests printed no VALIDATION line.")
    rows.sort(key=lambda row: (order(row), row[1]))  # stable: within a test as it printed them
    page = HEAD
    for number, test, case, outside, measured, error, tolerance, source in rows:
        case, source = case.replace("|", "\\|"), source.replace("|", "\\|")
        page += f"| {number} | {case} | {outside} | {source} | {measured} | {error} | {tolerance} | `{test}` |\n"
    part = sys.argv[1] + ".part"
    with open(part, "w", encoding="utf-8") as out:
        out.write(page + TAIL)
    os.replace(part, sys.argv[1])
    print(f"{len(rows)} numbers, {len({row[0] for row in rows})} rows of the plan: {sys.argv[1]}")


main()
