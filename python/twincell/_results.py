"""How results look in a notebook."""
from __future__ import annotations

from html import escape

import numpy as np

from . import _core


def _shown(result) -> str:
    if result.absent:
        return f"absent: {result.absent}"
    if isinstance(result.value, np.ndarray):
        return f"array {result.value.shape}"
    if isinstance(result.value, str):
        return result.value
    return f"{result.value:.6g}"


def _interval(result) -> str:
    if result.interval is None:
        return result.no_interval
    return f"[{result.interval[0]:.6g}, {result.interval[1]:.6g}]"


def _row(result) -> str:
    cells = (result.name, _shown(result), _interval(result), result.unit,
             f"{result.n} {result.n_of}".strip() if result.n else "", result.source)
    return "<tr>" + "".join(f"<td>{escape(c)}</td>" for c in cells) + "</tr>"


def _table(results) -> str:
    heads = ("result", "value", "interval", "unit", "samples", "source")
    return ("<table><thead><tr>" + "".join(f"<th>{h}</th>" for h in heads) + "</tr></thead><tbody>"
            + "".join(_row(r) for r in results) + "</tbody></table>")


def _repr(self) -> str:
    unit = "" if self.unit in ("", "1") else " " + self.unit
    return f"<{self.name}: {_shown(self)}{unit} {_interval(self)}>".replace(" >", ">")


def _to_dataframe(self):
    """One row per result: value (None for an array), low, high, unit, n, source, absent."""
    import pandas as pd

    rows = [{"value": None if isinstance(r.value, np.ndarray) else r.value,
             "low": r.interval[0] if r.interval else np.nan, "high": r.interval[1] if r.interval else np.nan,
             "unit": r.unit, "n": r.n, "source": r.source, "absent": r.absent} for r in self.values()]
    return pd.DataFrame(rows, index=self.keys())


def _format(self, form: str) -> str:
    if not form:
        return str(self)
    return format(self.value if isinstance(self.value, str) else float(self), form)


def _get(self, name, default=None):
    """The result of this name, or `default`."""
    return self[name] if name in self else default


_core.Result.__format__ = _format
_core.Results.get = _get
_core.Result._repr_html_ = lambda self: _table([self])
_core.Result.__repr__ = _repr
_core.Results._repr_html_ = lambda self: _table(self.values())
_core.Results.__iter__ = lambda self: iter(self.keys())
_core.Results.items = lambda self: list(zip(self.keys(), self.values()))
_core.Results.to_dataframe = _to_dataframe
