"""Loading of user-defined classes, named in texts: ``my_file.py:MyPolicy`` or ``package.module:MyPolicy``.

The reference is enough for any process to load the class. Loading a class executes the code of its file.
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

_LIBRARY_PREFIXES: Final = (f"{Path(__file__).parents[2]}/", sys.prefix, sys.base_prefix, "<frozen")
"""Path prefixes of code that is not the user's; error messages name the last line outside them."""


def is_reference(name: str) -> bool:
    """Return whether a name refers to a user-defined class; built-in names have no colon."""
    return ":" in name


def load_class(field: str, reference: str, base: type | None = None) -> type[Any]:
    """Return the class that a reference names; errors name `field`.

    A file is executed once per process and content; its path is relative to the current directory. A module
    is imported, also from the current directory. The class must define all abstract methods of `base`.
    """
    where, name = _split(field, reference)
    module = _load_module(field, reference, where)
    found = getattr(module, name, None)
    if not inspect.isclass(found):
        classes = (key for key, value in vars(module).items() if inspect.isclass(value))
        own = ", ".join(key for key in classes if getattr(module, key).__module__ == module.__name__)
        raise InputError(field, reference, f"{where} has no class {name}; its classes: {own or 'none'}")
    if base is not None:
        if not issubclass(found, base):
            raise InputError(field, reference, f"must be a subclass of {base.__module__}.{base.__name__}")
        missing = sorted(getattr(found, "__abstractmethods__", ()))
        if missing:
            raise InputError(field, reference, f"{name} must define {', '.join(missing)}")
    return found


def reference_to(kind: Any) -> str | None:
    """Return the reference from which another process can load a class; None if there is none."""
    module = sys.modules.get(getattr(kind, "__module__", ""))
    name = getattr(kind, "__qualname__", "")
    if module is None or not inspect.isclass(kind) or getattr(module, name, None) is not kind:
        return None
    if module.__spec__ is not None:
        return f"{module.__spec__.name}:{name}"
    path = Path(getattr(module, "__file__", None) or "").absolute()
    if path.suffix != ".py":
        return None  # an interactive session
    where = path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path
    return f"{where}:{name}"


def sources(field: str, reference: str) -> list[Path]:
    """Return the files with the code of a reference: its file, or all files of the module's package."""
    where, _ = _split(field, reference)
    if where.endswith(".py"):
        return [Path(where)]
    module = _load_module(field, reference, where)
    folders = getattr(sys.modules[where.partition(".")[0]], "__path__", None)
    if folders is None:
        return [Path(str(module.__file__))]
    return sorted(file for folder in folders for file in Path(folder).rglob("*.py"))


@contextlib.contextmanager
def user_errors(field: str, reference: str, what: str) -> Iterator[None]:
    """Re-raise errors of user code as `InputError` with file and line; `what` names the failing step."""
    try:
        yield
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        cause = " ".join(f"{type(error).__name__}: {error}".rstrip(": ").split())
        if not isinstance(error, SyntaxError):  # its message has the line
            frames = traceback.extract_tb(error.__traceback__)
            user_frames = [frame for frame in frames if not frame.filename.startswith(_LIBRARY_PREFIXES)]
            place = (user_frames or frames)[-1]
            if not place.filename.startswith("<"):
                cause += f" ({Path(place.filename).name}, line {place.lineno})"
        raise InputError(field, reference, f"{what} raises {cause}") from error


def _split(field: str, reference: str) -> tuple[str, str]:
    where, _, name = reference.rpartition(":")
    if not where or not name.isidentifier():
        raise InputError(field, reference, "must be path/to/my_file.py:MyClass or package.module:MyClass")
    return where, name


def _load_module(field: str, reference: str, where: str) -> ModuleType:
    if where.endswith(".py"):
        path = Path(where)
        try:
            path = path.resolve()
            source = path.read_bytes()
        except ValueError as error:  # a NUL character
            raise InputError(field, reference, f"must name a file ({error})") from None
        except OSError as error:
            reason = error.strerror or "unreadable"
            raise InputError(field, reference, f"must name a file; {path}: {reason}") from None
        with user_errors(field, reference, f"importing {path.name}"):
            return _execute(path, source)
    directory = str(Path.cwd())
    if directory not in sys.path and "" not in sys.path:
        sys.path.append(directory)  # console scripts, unlike `python -m`, do not search it
    with user_errors(field, reference, f"importing {where}"):
        return importlib.import_module(where)


@lru_cache(maxsize=64)
def _execute(path: Path, source: bytes) -> ModuleType:
    """Execute a file as a module, again only if its content has changed."""
    digest = hashlib.sha256(str(path).encode()).hexdigest()[:8]
    module = ModuleType("_".join(("user", re.sub(r"\W", "_", path.stem), digest)))
    module.__file__ = str(path)
    # Pickle, dataclasses and pydantic look up the module of a class there.
    sys.modules[module.__name__] = module
    try:
        exec(compile(source, str(path), "exec"), vars(module))
    except BaseException:
        del sys.modules[module.__name__]
        raise
    return module
