"""Runs one file of the module's tests; exits with 77 and a sentence where a package that it needs is missing.

usage: run_tests.py FILE PROGRAM [OPTION of pytest ...]   (the interpreter or PYTHONPATH knows the module)
"""
import importlib.util
import os
import sys

missing = [name for name in ("numpy", "pandas", "pytest") if importlib.util.find_spec(name) is None]
if missing:
    print(f"The tests of the Python module need python3-{', python3-'.join(missing)}; skipped.")
    sys.exit(77)

import pytest  # noqa: E402


class Outcome:
    """Whether any test was skipped, and whether any ran."""

    skipped = ran = False

    def pytest_runtest_logreport(self, report):
        self.skipped = self.skipped or report.skipped
        self.ran = self.ran or (report.when == "call" and not report.skipped)


os.environ["TWINCELL_PROGRAM"] = os.path.abspath(sys.argv[2])
sys.dont_write_bytecode = True
outcome = Outcome()
code = pytest.main(["-q", "-rs", "-p", "no:cacheprovider", sys.argv[1], *sys.argv[3:]], plugins=[outcome])
sys.exit(77 if code == 0 and outcome.skipped and not outcome.ran else code)
