"""docs/validation.md from what the verification tests print: `ctest -L verification -V | validation_page.py PAGE`.

Every checked number is one line, VALIDATION|id|test|law or case|outside number|measured|error|tolerance|source
(tests/support/validation.hpp). The page appears whole or not at all."""

import os
import re
import sys

HEAD = """# What is checked against what

`./run validation` makes this page: it runs the verification tests and writes down what they print. One row is one number from outside the
code (closed form, paper, other program) and what the program gave. A row without an outside number of its own measures an error, whose
outside number is 0. Tolerances are absolute and two-sided; those of averages over many beads are at least twice the standard error.

| id | law or case | outside number | source | measured | error | tolerance | test |
|---|---|---|---|---|---|---|---|
"""

TAIL = """
## Readings

- **V2.4.** With the spring law and `slip = "rescale"` the spring takes up the dashpot's share at the limit; in a fast oblique impact with a strong
  tangential dashpot the force then follows k_t v_t instead of staying at μ|F_n|. This is a property of that reading of "truncate"; the
  sliding test therefore uses the slider law.
- **V3.1.** Velocity Verlet errs by (ω₀Δt)² θ(1−θ) of the energy of approach where a contact begins a share θ into a step, and by the opposite
  where it ends. In a gas of N beads the energy walks at random by (π/n)² √(N_c/45)/N of itself in N_c collisions: at n = 50 and N = 256 by 1e-4
  after about 2000. It does not drift, but 1e-4 over 1e7 steps, what the plan asks for, is not to be had so. Where steps are split the walk is gone:
  `integrator = "split"` with `steps_per_contact = 100` holds the plan's 1e-4, and its 1e-5 of fitted drift, over the 1e7 steps; with 50 it holds 1e-4
  over a twentieth of them.
- **V3.5.** Henderson's formula lies 1.2 % above the virial series at φ = 0.6; there the series is the outside number. Its coefficients are those of Clisby and McCoy's
  Table 1; B₃ and B₄ are closed forms. The fluid of discs freezes at φ = 0.70 only. Soft beads are compared
  through the diameter of Barker and Henderson, and by three stiffnesses carried to infinity.
- **V4.1.** N is 400, not more: in larger systems long shear modes, which cool more slowly than the rest, hold several per cent of the energy
  at t = 5 τ.
- **V4.7.** Split steps at n = 50 do here what plain steps need n = 500 for: near the bifurcation the scatter of e over entry phases must be
  below 1e-3.
- **V4.14.** The middle of the cell is x = 0 there. Elsewhere a mirror image has other digits, and differences grow from 1e-16.

## Checked elsewhere

| what | against | test |
|---|---|---|
| lattices at the start | rows of 20 and 19; in space 12 neighbours, 6 in the layer, a mirror plane; gap 0 | `unit.Crystal.*` |
| spread sizes | variance of a uniform law, of a cut normal one; mass as R² or R³ | `unit.Sizes.*` |
| near pairs by cells | all pairs and images, 1 : 100 in size; candidates a bead independent of their number | `unit.CellGrid.*` |
| every kernel, law, dimension and integrator; lists built at every step or never (V2.14) | each other and the all-pairs oracle, bit for bit | `agreement.*` |
| fits | exact data; NIST's certified problems; coverage of the 95 % intervals | `recovery.*Fit*`, `recovery.Nist.*` |
| block averages, bootstraps, binomial intervals | coverage over synthetic processes with known truth | `unit.Statistics.*` |
| locator on synthetic frames | recall, precision 1; rms against the Cramér–Rao bound | `tests/recovery/locator_test.cpp` |
| locator and linker on real frames | published centres and identities (Lafaye de Micheaux et al. 2018) | `tests/recovery/real_images_test.cpp` |
| camera → tracker → trajectory | the trajectory that was filmed | `tests/recovery/closed_loop_test.cpp` |
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
