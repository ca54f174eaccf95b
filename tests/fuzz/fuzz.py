"""Give random mistaken inputs to kswarms: ``python -m tests.fuzz.fuzz --inputs 5000``.

Each input must end in five minutes, with exit status 0, 1 or 2 and no traceback, or with an `InputError`.
A refusal is one line and writes nothing; no temporary file is left. An input is determined by its name.
"""

import argparse
import contextlib
import io
import resource
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import tomlkit

from kswarms.scenarios.cli import invoke
from tests.fuzz import command_lines, python_calls
from tests.fuzz.harness import Failure, try_input

GENERATORS: Final = command_lines.GENERATORS | python_calls.GENERATORS
MAX_MEMORY: Final = 8 * 10**9
"""Memory of the script (bytes)."""
RECORD: Final = "robots,conflicts,trajectory"


@contextlib.contextmanager
def base_study() -> Iterator[Path]:
    """Yield a directory with a scenario file, findings and a small study."""
    with tempfile.TemporaryDirectory(prefix="fuzz-study-") as text, contextlib.chdir(text):
        Path("tiny.toml").write_text(tomlkit.dumps(command_lines.SCENARIO), encoding="utf-8")
        words = ["run", "tiny.toml", *command_lines.QUICK, "--out", "study", "--record", RECORD]
        with contextlib.redirect_stdout(io.StringIO()):
            assert invoke(words) == 0
        yield Path(text)


def name_of(seed: int, k: int) -> str:
    """Return the name of an input; its kind comes first."""
    return f"{list(GENERATORS)[k % len(GENERATORS)]}/{seed}/{k}"


def fuzz(names: list[str], study: Path) -> Iterator[Failure]:
    """Give the inputs of these names; yield failures."""
    for k, name in enumerate(names):
        if k % 200 == 199:
            print(f"{k + 1} inputs", file=sys.stderr, flush=True)  # noqa: T201
        failure = try_input(name, GENERATORS[name.split("/")[0]], study)
        if failure is not None:
            yield failure


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--inputs", type=int, default=5000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kind", choices=GENERATORS, help="inputs of this kind only")
    parser.add_argument("names", nargs="*", help="names of single inputs to repeat")
    given = parser.parse_args()
    numbers = range(given.first, given.first + given.inputs)
    names = given.names or [name_of(given.seed, k) for k in numbers]
    names = [name for name in names if given.kind in (None, name.split("/")[0])]
    resource.setrlimit(resource.RLIMIT_AS, (MAX_MEMORY, MAX_MEMORY))  # an input that needs more is a failure
    begin, failed = time.monotonic(), Counter[str]()
    with base_study() as study:
        for failure in fuzz(names, study):
            failed[failure.name.split("/")[0]] += 1
            print(f"{failure.name}\n  {failure.description}\n  {failure.problem}", flush=True)  # noqa: T201
    seconds = time.monotonic() - begin
    print(f"{len(names)} inputs, {failed.total()} failures {dict(failed)}, {seconds:.0f} s")  # noqa: T201
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
