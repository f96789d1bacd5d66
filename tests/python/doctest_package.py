"""Runs the examples in the docstrings of the package and of its README."""
import doctest
import importlib
import inspect
import pathlib
import pkgutil
import sys

import accdec

README = pathlib.Path(__file__).parents[2] / "apps" / "python" / "README.md"


def methods_without():
    """Public methods without a docstring of their own."""
    methods = [(name, method, getattr(getattr(accdec, name), method)) for name in accdec.__all__
               if inspect.isclass(getattr(accdec, name)) and getattr(accdec, name).__module__.startswith("accdec")
               for method, made in vars(getattr(accdec, name)).items()
               if not method.startswith("_") and (callable(made) or isinstance(made, staticmethod))]
    return [f"{name}.{method}" for name, method, made in methods if not (made.__doc__ or "").strip()]


def main():
    options = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    names = ["accdec"] + [f"accdec.{module.name}" for module in pkgutil.iter_modules(accdec.__path__)]
    failed = tried = 0
    for name in names:
        result = doctest.testmod(importlib.import_module(name), optionflags=options)
        failed, tried = failed + result.failed, tried + result.attempted
    if README.exists():
        result = doctest.testfile(str(README), module_relative=False, optionflags=options)
        failed, tried = failed + result.failed, tried + result.attempted
    missing = [name for name in accdec.__all__ if not getattr(accdec, name).__doc__] + methods_without()
    bare = [name for name in accdec.__all__
            if inspect.isfunction(getattr(accdec, name)) and ">>>" not in (getattr(accdec, name).__doc__ or "")]
    print(f"{tried} examples, {failed} failed; without a docstring: {missing or 'none'}, an example: {bare or 'none'}")
    return 1 if failed or missing or bare or tried < 10 else 0


if __name__ == "__main__":
    sys.exit(main())
