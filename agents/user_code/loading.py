"""Loading of user-defined classes, named in texts: ``my_file.py:MyPolicy`` or ``package.module:MyPolicy``.

The reference is enough for any process to load the class. Only `load_class` executes code: the form of a
reference is checked, and its files are found, without an import.
"""

import contextlib
import hashlib
import importlib
import importlib.util
import inspect
import re
import sys
import traceback
from collections.abc import Iterator
from functools import lru_cache
from importlib.machinery import ModuleSpec, PathFinder
from itertools import islice
from pathlib import Path
from types import ModuleType
from typing import Any, Final

from kswarms.agents.common.errors import InputError
from kswarms.agents.common.input_files import read_input_file
from kswarms.agents.common.limits import MAX_CODE_FILES, MAX_TEXT_FILE

_LIBRARY_PREFIXES: Final = (f"{Path(__file__).parents[2]}/", sys.prefix, sys.base_prefix, "<frozen")
"""Path prefixes of code that is not the user's; error messages name the last line outside them."""


def is_reference(name: str) -> bool:
    """Return whether a name refers to a user-defined class; built-in names have no colon."""
    return ":" in name


def check_reference(field: str, reference: str) -> None:
    """Raise an `InputError` unless a reference has a valid form; the file or module need not exist."""
    where, _, name = reference.rpartition(":")
    is_module = all(part.isidentifier() for part in where.split("."))
    if not name.isidentifier() or not (where.endswith(".py") or is_module):
        raise InputError(field, reference, "must be path/to/my_file.py:MyClass or package.module:MyClass")


def load_class(field: str, reference: str, base: type | None = None) -> type[Any]:
    """Return the class that a reference names; errors name `field`.

    A file is executed once per process and content; its path is relative to the current directory. A module
    is imported, also from the current directory. The class must define all abstract methods of `base`.
    """
    check_reference(field, reference)
    where, _, name = reference.rpartition(":")
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
    """Return the files with the code of a reference: its file, or all files of the module's package.

    Nothing is imported; a file that a reference names need not exist.
    """
    check_reference(field, reference)
    where = reference.rpartition(":")[0]
    if where.endswith(".py"):
        return [Path(where)]
    package = where.partition(".")[0]
    found = _find_top_level(package)
    if found is None:
        raise InputError(field, reference, f"must name a module; there is no {package}")
    folders = found.submodule_search_locations
    if folders is None:
        return [Path(found.origin)] if found.has_location and found.origin else []
    files = [*islice((file for each in folders for file in Path(each).rglob("*.py")), MAX_CODE_FILES + 1)]
    if len(files) > MAX_CODE_FILES:
        raise InputError(field, reference, f"must be of a package of at most {MAX_CODE_FILES:,} Python files")
    return sorted(files)


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


def _find_top_level(name: str) -> ModuleSpec | None:
    """Find a top-level module or package as an import would; only a submodule would import its package."""
    try:
        found = importlib.util.find_spec(name)
    except ValueError:  # a loaded module without a spec
        found = None
    return found or PathFinder.find_spec(name, [str(Path.cwd())])


def _load_module(field: str, reference: str, where: str) -> ModuleType:
    if where.endswith(".py"):
        source = read_input_file(field, Path(where), MAX_TEXT_FILE)
        path = Path(where).resolve()
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
