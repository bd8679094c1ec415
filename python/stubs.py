"""Writes the type stubs of twincell._core from the signatures and docstrings of the built module.

usage: stubs.py OUTPUT
"""
import inspect
import re
import sys
import textwrap
from pathlib import Path

sys.path.pop(0)  # the folder of this file, in which twincell/ is the source
import twincell._core as core  # noqa: E402


def clean(signature):
    signature = signature.replace("twincell._core.", "").replace("buffer", "bytes")
    signature = re.sub(r"numpy\.ndarray(\[[^\]]*\])?", "numpy.ndarray", signature)
    signature = re.sub(r"\b(Optional|Union|List|Tuple|Dict|Iterator|Callable|Sequence)\[", r"typing.\1[", signature)
    signature = re.sub(r"List\[(\w+)\[\d+\]\]", r"Sequence[\1]", signature)
    signature = signature.replace("os.PathLike", "str | os.PathLike[str]")
    signature = re.sub(r"= <.*?>(?=[,)])", "= ...", signature)
    return re.sub(r"\b(handle|object)\b", "typing.Any", signature)


def docstring(text, indent="    "):
    """`text` as the lines of a docstring; none without a text."""
    text = textwrap.dedent(text or "").strip().replace("\\", "\\\\").replace('"""', r'\"\"\"')
    if not text:
        return []
    if text.endswith('"'):
        text = text[:-1] + '\\"'
    return [indent + '"""' + text.replace("\n", "\n" + indent) + '"""']


def function(name, thing, indent, decorator=""):
    doc = thing.__doc__ or ""
    head, _, text = doc.partition("\n")
    overloads = re.findall(rf"^\d+\. {re.escape(name)}(\(.*\)) -> (.*)$", doc, flags=re.M)
    if overloads:
        return "\n".join(textwrap.indent(f"@typing.overload\ndef {name}{clean(a)} -> {clean(r)}: ...", indent)
                         for a, r in overloads)
    match = re.match(rf"{re.escape(name)}(\(.*\)) -> (.*)$", head)
    lines = [decorator] if decorator else []
    if match:
        lines += [f"def {name}{clean(match[1])} -> {clean(match[2])}:"]
    else:
        try:
            lines += [f"def {name}{inspect.signature(thing)}:"]
        except (TypeError, ValueError):
            lines += [f"def {name}(*args: typing.Any, **options: typing.Any) -> typing.Any:"]
        text = doc
    lines += docstring(text) + ["    ..."]
    return textwrap.indent("\n".join(lines), indent)


def attribute(name, thing, indent):
    doc = (thing.fget.__doc__ or "") if thing.fget else ""
    match = re.search(r"-> (.*)", doc)
    kind = clean(match[1].split("\n")[0]) if match else "typing.Any"
    lines = ["@property", f"def {name}(self) -> {kind}:"]
    lines += docstring(thing.__doc__)
    return textwrap.indent("\n".join(lines + ["    ..."]), indent)


def class_(name, thing):
    bases = [b.__name__ for b in thing.__bases__ if b.__name__ not in ("pybind11_object", "object")]
    lines = [f"class {name}({', '.join(bases)}):" if bases else f"class {name}:"]
    lines += docstring(thing.__doc__)
    for member, value in sorted(vars(thing).items()):
        if member.startswith("_") and member not in ("__init__", "__len__", "__getitem__", "__next__", "__iter__", "__array__"):
            continue
        if isinstance(value, property):
            lines += [attribute(member, value, "    ")]
        elif isinstance(value, staticmethod):
            lines += [function(member, value.__func__, "    ", "@staticmethod")]
        elif callable(value):
            lines += [function(member, value, "    ")]
    return "\n".join(lines + ["    ..."])


def main():
    parts = ['"""The C++ side of twincell; written by stubs.py."""', "import os\nimport typing\n\nimport numpy"]
    for name, thing in sorted(vars(core).items()):
        if name.startswith("__"):
            continue
        if inspect.isclass(thing):
            parts.append(class_(name, thing))
        elif callable(thing):
            parts.append(function(name, thing, ""))
        elif isinstance(thing, str):
            parts.append(f"{name}: str")
    text = "\n\n".join(parts) + "\n"
    compile(text, sys.argv[1], "exec")  # no stub that a reader of stubs would refuse
    Path(sys.argv[1]).write_text(text, encoding="utf-8")


main()
