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

os.environ["TWINCELL_PROGRAM"] = os.path.abspath(sys.argv[2])
sys.dont_write_bytecode = True
sys.exit(pytest.main(["-q", "-p", "no:cacheprovider", sys.argv[1], *sys.argv[3:]]))
