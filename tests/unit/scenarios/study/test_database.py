"""The file of a ledger: reading without rights, changes by others, journals and doctored schemas."""

import os
import shutil
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.study import database, file_systems
from kswarms.scenarios.study.database import create_database, open_database

INSERT = "INSERT INTO scenarios VALUES (?, 'x')"


@pytest.fixture
def ledger() -> Iterator[Path]:
    """Return the path of an empty ledger that other users can read."""
    with TemporaryDirectory() as directory:
        Path(directory).chmod(0o755)
        create_database(Path(directory, "ledger.sqlite"))
        yield Path(directory, "ledger.sqlite")


@contextmanager
def without_rights(directory: Path) -> Iterator[None]:
    """Take the right to write to a directory from this process."""
    mode = directory.stat().st_mode
    directory.chmod(0o555)
    if os.geteuid() == 0:
        os.seteuid(65534)
    try:
        yield
    finally:
        if os.getuid() == 0:
            os.seteuid(0)
        directory.chmod(mode)


def insert(db: sqlite3.Connection, name: str) -> None:
    with db:
        db.execute(INSERT, (name,))


def names(path: Path) -> list[str]:
    with closing(open_database(path, create=False)) as db:
        return [name for (name,) in db.execute("SELECT id FROM scenarios ORDER BY id")]


def leave_finished(path: Path) -> None:
    with closing(open_database(path, create=True)) as db:
        insert(db, "a")


def leave_wal_mode(path: Path) -> None:
    """Leave a ledger as version 0.1.0 did."""
    with closing(sqlite3.connect(path)) as db:
        db.execute("PRAGMA journal_mode = WAL")
        insert(db, "a")


def leave_killed(path: Path) -> None:
    child = os.fork()
    if child == 0:
        insert(open_database(path, create=True), "a")
        os._exit(0)
    os.waitpid(child, 0)
    assert Path(f"{path}-wal").stat().st_size > 0


@pytest.mark.parametrize("leave", [leave_finished, leave_wal_mode, leave_killed])
@pytest.mark.parametrize("name", ["ledger.sqlite", "a?mode=rwc#%41 b.sqlite", os.fsdecode(b"a\xff.sqlite")])
def test_reading_needs_no_right_to_write_and_changes_nothing(
    leave: Callable[[Path], None], name: str, ledger: Path
) -> None:
    path = ledger.rename(ledger.with_name(name))
    leave(path)
    before = {each.name: each.read_bytes() for each in path.parent.iterdir() if "-shm" not in each.name}
    with without_rights(path.parent):
        assert names(path) == ["a"]
    assert names(path) == ["a"]
    after = {each.name: each.read_bytes() for each in path.parent.iterdir() if "-shm" not in each.name}
    assert after == before


def test_a_path_with_two_slashes_at_its_start_is_read(ledger: Path) -> None:
    assert names(Path(f"/{ledger}")) == []


def test_a_ledger_can_be_read_while_it_is_written(ledger: Path) -> None:
    with closing(open_database(ledger, create=True)) as db:
        insert(db, "a")
        with without_rights(ledger.parent):
            assert names(ledger) == ["a"]
        with closing(open_database(ledger, create=False)) as reader:
            insert(db, "b")
            assert len(list(reader.execute("SELECT * FROM scenarios"))) == 2
            with pytest.raises(sqlite3.OperationalError, match="readonly"):
                reader.execute(INSERT, ("c",))
    assert names(ledger) == ["a", "b"]


def test_half_a_transaction_is_undone(ledger: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(database, "network_file_system", lambda _: "nfs4")
    leave_finished(ledger)
    child = os.fork()
    if child == 0:
        db = open_database(ledger, create=True)
        db.execute("PRAGMA cache_size = 1")
        with db:
            db.executemany(INSERT, ((f"b{k}",) for k in range(5000)))
            os._exit(0)
    os.waitpid(child, 0)
    assert Path(f"{ledger}-journal").stat().st_size > 0
    with without_rights(ledger.parent), pytest.raises(OSError, match=r"ledger\.sqlite: "):
        names(ledger)
    assert names(ledger) == ["a"]


def test_the_journal_suits_the_file_system(ledger: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for kind, journal in (("", "wal"), ("nfs4", "delete"), ("fuse.sshfs", "delete")):
        monkeypatch.setattr(database, "network_file_system", lambda _, kind=kind: kind)
        with closing(open_database(ledger, create=True)) as db:
            insert(db, kind)
            assert next(db.execute("PRAGMA journal_mode")) == (journal,)
        assert [path.name for path in ledger.parent.iterdir()] == ["ledger.sqlite"]


def overwrite(path: Path) -> None:
    other = path.with_name("other.sqlite")
    create_database(other)
    with closing(open_database(other, create=True)) as db:
        db.executemany(INSERT, ((f"c{k}",) for k in range(5000)))
        db.commit()
    shutil.copyfile(other, path)


def empty(path: Path) -> None:
    path.write_bytes(b"")


def truncate(path: Path) -> None:
    with path.open("r+b") as file:
        file.truncate(50)


def replace(path: Path) -> None:
    overwrite(path.with_name("new.sqlite"))
    path.with_name("new.sqlite").replace(path)


@pytest.mark.parametrize("kind", ["", "nfs4"])
@pytest.mark.parametrize("change", [Path.unlink, replace])
def test_a_ledger_that_was_deleted_or_replaced_is_noticed_and_rescued(
    change: Callable[[Path], None], kind: str, ledger: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(database, "network_file_system", lambda _: kind)
    with closing(open_database(ledger, create=True)) as db:
        insert(db, "a")
        insert(db, "b")
        change(ledger)
        after = ledger.exists() and ledger.read_bytes()
        for _ in range(2):
            with pytest.raises(
                OSError, match=r"was deleted, replaced or overwritten; its runs are in rescued-"
            ):
                insert(db, "c")
    assert (ledger.exists() and ledger.read_bytes()) == after
    (rescued,) = ledger.parent.glob("rescued-*.sqlite")
    assert names(rescued) == ["a", "b"]


@pytest.mark.parametrize("change", [overwrite, empty, truncate])
def test_a_ledger_that_was_overwritten_is_noticed(change: Callable[[Path], None], ledger: Path) -> None:
    with closing(open_database(ledger, create=True)) as db:
        insert(db, "a")
        change(ledger)
        after = ledger.read_bytes()
        with pytest.raises(OSError, match=r"was deleted, replaced or overwritten; its runs are lost"):
            insert(db, "c")
    assert ledger.read_bytes() == after
    assert {path.name for path in ledger.parent.iterdir()} <= {"ledger.sqlite", "other.sqlite"}


def test_a_deleted_directory_is_noticed(tmp_path: Path) -> None:
    create_database(tmp_path / "ledger.sqlite")
    with closing(open_database(tmp_path / "ledger.sqlite", create=True)) as db:
        shutil.rmtree(tmp_path)
        with pytest.raises(OSError, match="its runs are lost"):
            insert(db, "a")


@pytest.mark.parametrize(
    "statement",
    [
        "CREATE VIEW more AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i FROM n) SELECT i FROM n",
        "CREATE TRIGGER more AFTER INSERT ON runs BEGIN DELETE FROM runs; END",
        "CREATE VIRTUAL TABLE more USING fts5(a)",
    ],
)
@pytest.mark.parametrize("create", [True, False])
def test_a_schema_that_can_execute_statements_is_refused(statement: str, create: bool, ledger: Path) -> None:
    with closing(sqlite3.connect(ledger)) as db:
        db.execute(statement)
        db.commit()
    with pytest.raises(InputError, match=r"must be a ledger of kswarms .with 'more', which is no table"):
        open_database(ledger, create)


def test_two_processes_can_create_a_ledger_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "ledger.sqlite"
    real = database._prepare

    def prepare(db: sqlite3.Connection, create: bool) -> None:
        monkeypatch.setattr(database, "_prepare", real)
        db.execute("SELECT 1 FROM sqlite_master")
        create_database(path)
        db.executescript(f"BEGIN IMMEDIATE; {database._TABLES} COMMIT")

    monkeypatch.setattr(database, "_prepare", prepare)
    create_database(path)
    assert names(path) == []


MOUNTS = """\
22 1 8:1 / / rw,relatime shared:1 - ext4 /dev/sda1 rw
30 22 0:40 / /home rw - nfs4 server:/home rw
31 22 0:41 / /home/me/my\\040scratch rw shared:5 master:2 - xfs /dev/sdb rw
32 22 0:42 / /scratch rw - lustre fs@tcp:/scratch rw
33 22 0:43 / /mnt rw - fuse.sshfs me@host: rw
34 22 0:44 / /box rw - fuse.fuse-overlayfs box rw
35 22 0:45 / /twice rw - tmpfs tmpfs rw
36 22 0:46 / /twice rw - cifs //server/share rw
"""


@pytest.mark.parametrize(
    ("directory", "kind"),
    [
        ("/results", ""),
        ("/home/me/results", "nfs4"),
        ("/homes", ""),
        ("/home/me/my scratch/results", ""),
        ("/scratch", "lustre"),
        ("/mnt/a/b", "fuse.sshfs"),
        ("/box/a", ""),
        ("/twice/a", "cifs"),
    ],
)
def test_network_file_systems_are_known(
    directory: str, kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "mountinfo").write_text(MOUNTS)
    monkeypatch.setattr(file_systems, "_MOUNTS", tmp_path / "mountinfo")
    assert file_systems.network_file_system(Path(directory)) == kind
    monkeypatch.setattr(file_systems, "_MOUNTS", tmp_path / "absent")
    assert file_systems.network_file_system(Path(directory)) == ""
