"""Results directories: which are used, and which are refused before anything in them changes."""

import os
import stat
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.calibration.directory import open_calibration
from kswarms.scenarios.contribution.table import prepare_table
from kswarms.scenarios.study.directory import make_directory, write_json
from kswarms.scenarios.study.study import Study


def snapshot(directory: Path) -> dict[str, object]:
    """Return kind, content and time of every file below a directory."""
    found: dict[str, object] = {}
    for path in sorted(directory.rglob("*")):
        status = path.lstat()
        content = path.read_bytes() if stat.S_ISREG(status.st_mode) else b""
        found[str(path)] = (stat.S_IFMT(status.st_mode), status.st_mtime_ns, content)
    return found


def fail(*_: object) -> Any:
    raise AssertionError("the directory was not refused")


def enter_study(directory: Path) -> None:
    Study(directory).__enter__()


def enter_calibration(directory: Path) -> None:
    open_calibration(directory, {}, fail)


def enter_new_calibration(directory: Path) -> None:
    open_calibration(directory, {}, fail, fresh=True)


@pytest.fixture
def key(tmp_path: Path) -> Path:
    """Write a file of the user beside the directory."""
    (tmp_path / "out").mkdir()
    (tmp_path / "key").write_text("precious")
    return tmp_path / "key"


ENTRIES = [enter_study, prepare_table, enter_calibration, enter_new_calibration]


@pytest.mark.parametrize("enter", ENTRIES)
@pytest.mark.parametrize(
    "name", ["lock", "manifest.json", "figures/fig-6.1c.png", "runs.parquet", "thesis.tex", "slurm-1.out"]
)
def test_a_directory_of_the_user_is_refused_and_unchanged(
    enter: Callable[[Path], None], name: str, key: Path
) -> None:
    mine = key.with_name("out") / name
    mine.parent.mkdir(exist_ok=True)
    mine.write_text("precious")
    before = snapshot(key.parent)
    with pytest.raises(InputError, match=r"^out='.*/out': must be a new or empty directory, or one that ksw"):
        enter(key.with_name("out"))
    assert snapshot(key.parent) == before


@pytest.mark.parametrize(
    ("enter", "main"),
    [
        (enter_study, "ledger.sqlite"),
        (prepare_table, "contribution.parquet"),
        (enter_calibration, "games.jsonl"),
        (enter_new_calibration, "games.jsonl"),
    ],
)
@pytest.mark.parametrize("content", [b"precious", b'{"calibration": {}}\n[3]\n', b"[" * 5000])
def test_a_main_file_of_another_program_is_refused_and_unchanged(
    enter: Callable[[Path], None], main: str, content: bytes, key: Path
) -> None:
    (key.parent / "out" / main).write_bytes(content)
    (key.parent / "out" / "lock").write_text("precious")
    (key.parent / "out" / "calibration.json").write_text("precious")
    before = snapshot(key.parent)
    with pytest.raises(InputError, match=r"a ledger of kswarms|readable Parquet file|no file of games"):
        enter(key.parent / "out")
    assert snapshot(key.parent) == before


@pytest.mark.parametrize("kind", ["link", "broken link", "pipe", "directory"])
@pytest.mark.parametrize(
    "name", ["lock", "manifest.json", "runs.parquet", "ledger.sqlite", "ledger.sqlite-wal", "figures"]
)
def test_files_of_a_study_are_regular(kind: str, name: str, key: Path) -> None:
    out = key.parent / "out"
    with Study(out):
        pass
    path = out / name
    path.unlink(missing_ok=True)
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "directory" and name != "figures":
        path.mkdir()
    else:
        path.symlink_to("../key" if kind == "link" else "../absent")
    before = snapshot(key.parent)
    with pytest.raises(InputError, match=rf"^out='.*/out/{name}': must be a (file, not a|directory and no)"):
        Study(out).__enter__()
    assert snapshot(key.parent) == before


def test_hidden_files_do_not_count(tmp_path: Path) -> None:
    for name in (".DS_Store", ".nfs0001", ".ipynb_checkpoints/notes"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    with Study(tmp_path):
        pass
    assert {".DS_Store", ".nfs0001", ".ipynb_checkpoints", "ledger.sqlite"} < {
        path.name for path in tmp_path.iterdir()
    }


def test_results_of_several_commands_share_a_directory(tmp_path: Path) -> None:
    make_directory(tmp_path, "contribution.parquet")
    (tmp_path / "contribution.parquet").touch()
    (tmp_path / "figures").mkdir()
    with Study(tmp_path):
        pass
    (tmp_path / "contribution.parquet").unlink()
    prepare_table(tmp_path)
    (tmp_path / "ledger.sqlite").rename(tmp_path / "games.jsonl")
    with pytest.raises(InputError, match=r"has a lock but no ledger[.]sqlite; use another directory"):
        Study(tmp_path).__enter__()


def test_a_process_that_is_killed_at_the_start_leaves_a_directory_of_kswarms(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def kill(*_: object) -> None:
        raise KeyboardInterrupt

    out = tmp_path / "out"
    with monkeypatch.context() as patch:
        patch.setattr("kswarms.scenarios.study.outputs.directory_lock", kill)
        with pytest.raises(KeyboardInterrupt):
            Study(out).__enter__()
    assert {path.name for path in out.iterdir()} == {"ledger.sqlite"}
    with Study(out):
        pass


@pytest.mark.parametrize("make", [lambda path: path.symlink_to("../../key"), os.mkfifo, os.mkdir])
def test_figures_are_regular_files(make: Callable[[Path], None], key: Path) -> None:
    out = key.parent / "out"
    with Study(out):
        (out / "figures").mkdir()
    make(out / "figures" / "fig-6.1c.png")
    for enter in (enter_study, prepare_table):
        with pytest.raises(InputError, match=r"^out='.*/figures/fig-6\.1c\.png': must be a file, not a dir"):
            enter(out)


def test_figures_must_be_writable_before_the_games(key: Path) -> None:
    out = key.parent / "out"
    with Study(out):
        pass
    (out / "figures").write_text("in the way")
    with pytest.raises(InputError, match=r"^out='.*/out/figures': must be a directory"):
        Study(out).__enter__()


def test_a_json_file_that_cannot_be_written_stays_unchanged(tmp_path: Path) -> None:
    path = tmp_path / "content.json"
    write_json(path, {"a": 1})
    with pytest.raises(TypeError):
        write_json(path, {"a": object()})
    assert path.read_text() == '{\n "a": 1\n}\n'
    assert list(tmp_path.iterdir()) == [path]
