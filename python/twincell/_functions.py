"""Functions that name the nearest option for a wrong one; compiled ones with a signature, and with a name by which pickle finds them."""
from __future__ import annotations

import difflib
import functools
import inspect
import types

from . import _core, _names


def _signature(function):
    """The signature in the first line of the docstring that pybind11 writes; None if Python cannot read it."""
    made = {}
    try:
        exec("from __future__ import annotations\ndef " + function.__doc__.partition("\n")[0] + ": ...", made)
    except (SyntaxError, NameError):  # a default whose text is no expression
        return None
    return inspect.signature(made[function.__name__])


def _known(options, signature, name):
    """The options by the names of the signature: also with the underscore of range_, which `match` takes.

    TypeError for others, with the nearest name.
    """
    known = {}
    for option, value in options.items():
        plain = option.rstrip("_")
        if option not in signature.parameters and plain in signature.parameters and plain not in options:
            option = plain
        if option not in signature.parameters:
            near = difflib.get_close_matches(option, signature.parameters, 1)
            here = _names.OPTIONS.get((name, option))
            raise TypeError(f"{name}() has no argument '{option}'" + (
                f"; here: {here}." if here else f"; did you mean '{near[0]}'?" if near else "."))
        known[option] = value
    return known


def named(function, name):
    """`function` as the function `name` of the package."""
    signature = _signature(function) if isinstance(function, types.BuiltinFunctionType) else inspect.signature(function)

    def call(*args, **options):
        return function(*args, **(options if signature is None else _known(options, signature, name)))

    functools.update_wrapper(call, function)
    del call.__wrapped__  # else inspect asks the compiled function, which has no signature
    call.__module__, call.__qualname__ = __package__, name
    if signature is not None:
        call.__signature__ = signature
    return call


def _states_options(thing):
    """Whether a function of the package states all of its options: those that run the program do not."""
    return inspect.isfunction(thing) and (thing.__module__ or "").startswith(__package__ + ".") and all(
        p.kind is not p.VAR_KEYWORD for p in inspect.signature(thing).parameters.values())


def name_functions(module):
    """Names the functions among the attributes of the package, and the static compiled ones of its classes."""
    for name, thing in list(module.items()):
        if name.startswith("_"):
            continue
        if isinstance(thing, types.BuiltinFunctionType) or _states_options(thing):
            module[name] = named(thing, name)
        elif inspect.isclass(thing) and thing.__module__ == _core.__name__:
            for member, static in list(vars(thing).items()):
                if isinstance(static, staticmethod) and isinstance(static.__func__, types.BuiltinFunctionType):
                    setattr(thing, member, staticmethod(named(static.__func__, f"{name}.{member}")))
