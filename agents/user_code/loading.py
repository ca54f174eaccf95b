"""Classes from outside the package, named in a text: ``my_file.py:MyPolicy`` or ``package.module:MyPolicy``.

The text alone says where a class comes from, so every process that reads it finds the class by itself. Naming
a class executes the code of its file, with all rights of the user who does so.
"""

import contextlib
import hashlib
import importlib
import inspect
import re
import sys
import traceback
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any, Final

from kswarms.agents.common.errors import InputError

_NOT_THE_USERS: Final = (f"{Path(__file__).parents[2]}/", sys.prefix, sys.base_prefix, "<frozen")
"""Where code lies whose line would not help a user to find the mistake."""


def is_reference(name: str) -> bool:
    """Tell whether a name means a class from outside; no name of the package has a colon."""
    return ":" in name


def load_class(field: str, reference: str, base: type | None = None) -> type[Any]:
    """Return the class that a reference names.

    A file is executed once in a process for each content that it has; a module is imported as Python
    does, from the current directory too.

    Parameters
    ----------
    field : str
        What the class is for, to be named in an error.
    reference : str
        ``path/to/my_file.py:MyPolicy``, the path relative to the current directory, or
        ``package.module:MyPolicy``.
    base : type, optional
        What it must be a subclass of, with all abstract methods defined.

    Raises
    ------
    InputError
        If there is no such file, module or class, its code fails, or it is no such subclass.
    """
    where, name = _split(field, reference)
    module = _module_of(field, reference, where)
    found = getattr(module, name, None)
    if not inspect.isclass(found):
        classes = (key for key, value in vars(module).items() if inspect.isclass(value))
        own = ", ".join(key for key in classes if getattr(module, key).__module__ == module.__name__)
        raise InputError(field, reference, f"{where} has no class {name}; there are {own or 'none'}")
    if base is not None:
        if not issubclass(found, base):
            raise InputError(field, reference, f"must be a subclass of {base.__module__}.{base.__name__}")
        missing = sorted(getattr(found, "__abstractmethods__", ()))
        if missing:
            raise InputError(field, reference, f"{name} must define {', '.join(missing)}")
    return found


def sources(field: str, reference: str) -> list[Path]:
    """Return the files whose code a reference stands for.

    That is the file that it names, or the module's, or all Python files of the package that the module is in.

    Raises
    ------
    InputError
        If there is no such file or module.
    """
    where, _ = _split(field, reference)
    if where.endswith(".py"):
        return [Path(where)]
    module = _module_of(field, reference, where)
    folders = getattr(sys.modules[where.partition(".")[0]], "__path__", None)
    if folders is None:
        return [Path(str(module.__file__))]
    return sorted(file for folder in folders for file in Path(folder).rglob("*.py"))


@contextlib.contextmanager
def blaming(field: str, reference: str, what: str) -> Iterator[None]:
    """Turn whatever code from outside raises into one line that tells where; faults of the package pass.

    Parameters
    ----------
    field, reference : str
        What the code is for, and where it is; a name of the package's own changes nothing.
    what : str
        What is being done, as the beginning of a sentence, for example ``choose(0)``.

    Raises
    ------
    InputError
        If the code in the context raises; its own ones pass.
    """
    try:
        yield
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        if not is_reference(reference):
            raise
        cause = " ".join(f"{type(error).__name__}: {error}".rstrip(": ").split())
        if not isinstance(error, SyntaxError):  # which tells its line itself
            frames = traceback.extract_tb(error.__traceback__)
            theirs = [frame for frame in frames if not frame.filename.startswith(_NOT_THE_USERS)]
            place = (theirs or frames)[-1]
            if not place.filename.startswith("<"):
                cause += f" ({Path(place.filename).name}, line {place.lineno})"
        raise InputError(field, reference, f"{what} raises {cause}") from error


def _split(field: str, reference: str) -> tuple[str, str]:
    where, _, name = reference.rpartition(":")
    if not where or not name.isidentifier():
        raise InputError(field, reference, "must be path/to/my_file.py:MyClass or package.module:MyClass")
    return where, name


def _module_of(field: str, reference: str, where: str) -> ModuleType:
    if where.endswith(".py"):
        path = Path(where)
        try:
            path = path.resolve()
            source = path.read_bytes()
        except ValueError as error:  # of a NUL, which is not printed
            raise InputError(field, reference, f"must name a file ({error})") from None
        except OSError as error:
            reason = error.strerror or "unreadable"
            raise InputError(field, reference, f"must name a file; {path}: {reason}") from None
        with blaming(field, reference, f"importing {path.name}"):
            return _executed(path, source)
    directory = str(Path.cwd())
    if directory not in sys.path and "" not in sys.path:
        sys.path.append(directory)  # a command, unlike `python -m`, does not look there
    with blaming(field, reference, f"importing {where}"):
        return importlib.import_module(where)


@lru_cache(maxsize=64)
def _executed(path: Path, source: bytes) -> ModuleType:
    """Execute a file as a module, anew only if its content has changed."""
    named = hashlib.sha256(str(path).encode()).hexdigest()[:8]
    module = ModuleType("_".join(("user", re.sub(r"\W", "_", path.stem), named)))
    module.__file__ = str(path)
    # Pickle, dataclasses and pydantic look for a class's module there.
    sys.modules[module.__name__] = module
    try:
        exec(compile(source, str(path), "exec"), vars(module))
    except BaseException:
        del sys.modules[module.__name__]
        raise
    return module
