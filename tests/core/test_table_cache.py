"""Tables on disk: found by what determines them, bounded, shared, and never fatal."""

import os
import subprocess
import sys
import warnings
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from eigencontact.core import table_cache as module
from eigencontact.core.table_cache import TableCache, address, table_cache
from eigencontact.errors import SceneError

TABLE = {"values": np.arange(1000.0).reshape(10, 100), "bounds": np.array([1e-9, 0.1])}


@pytest.fixture
def tables(tmp_path):
    return TableCache(tmp_path / "tables")


def kept(tables, name, used=None):
    """Keep the table under a name; it was last used so many seconds ago."""
    tables.keep(name, TABLE)
    if used is not None:
        moment = 1.7e9 - used
        os.utime(tables.folder / f"{name}.npz", (moment, moment))


def test_a_table_comes_back_to_the_last_bit(tables):
    assert tables.find("a") is None
    kept(tables, "a")
    found = TableCache(tables.folder).find("a", "values", "bounds")
    assert found.keys() == TABLE.keys()
    for name, values in TABLE.items():
        np.testing.assert_array_equal(found[name], values, strict=True)
    assert tables.find("a", "values", "more") is None


# --- addresses ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Solid:
    modulus: float
    number: int = field(default=0, compare=False)


@dataclass(frozen=True)
class Other:
    modulus: float


DIFFERENT = [
    (1,), (1.0,), ("1",), (True,), (None,), (b"1",), ((1, 2),), ((1,), 2), (1, 2), (12,), ("ab", "c"), ("a", "bc"),
    (0.1,), (np.nextafter(0.1, 1),), (np.array([1.0, 2.0]),), (np.array([[1.0, 2.0]]),), (np.array([1, 2]),),
    (Solid(1.0),), (Solid(2.0),), (Other(1.0),), (Path("ab"),), ("ab",), (),
]  # fmt: skip


def test_what_differs_has_another_address():
    keys = [address(*parts) for parts in DIFFERENT]
    assert len(set(keys)) == len(DIFFERENT)
    assert all(len(key) == 64 for key in keys)


def test_what_is_equal_has_the_same_address():
    assert address(Solid(1.0, number=3)) == address(Solid(1.0))
    assert address([1.0, 2]) == address((np.float64(1.0), 2))
    assert address(np.eye(3)) == address(np.asfortranarray(np.eye(3)))


def test_what_cannot_be_told_has_no_address():
    assert address(object()) is None
    assert address(np.array([object()])) is None
    assert address(Solid) is None


def test_other_code_has_another_address(tmp_path):
    """A process sees the source as it was when it first asked."""
    (tmp_path / "law.py").write_text("class Law: pass\n")
    code = "import law; from eigencontact.core.table_cache import address; print(address(1, code=(law.Law(),)))"
    keys = []
    for text in ("class Law: pass\n", "class Law: pass  # changed\n", "class Law: pass\n"):
        (tmp_path / "law.py").write_text(text)
        done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
        keys.append(done.stdout)
    assert keys[0] == keys[2] != keys[1]
    assert address(1, code=("eigencontact.core.tensors",)) == address(1, code=("eigencontact.core.names",))
    assert address(1, code=("eigencontact.core.tensors",)) != address(1, code=("eigencontact.errors",))


# --- damage and disks -------------------------------------------------------------------------------------------


def damaged(path, damage):
    """Damage the bytes of a file, or replace it by a valid file with other arrays."""
    whole = path.read_bytes()
    middle = len(whole) // 2
    flipped = whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1 :]
    bytes_of = {"cut": whole[:middle], "flipped": flipped, "empty": b"", "text": b"no table"}
    if damage in bytes_of:
        path.write_bytes(bytes_of[damage])
        return
    with np.load(path) as stored:
        arrays = {name: stored[name] for name in stored.files}
    values = arrays["values"]
    arrays |= {
        "altered": {"values": values * 1.01},
        "shape": {"values": values.T},
        "type": {"values": values.astype(np.float32)},
        "nan": {"values": np.full_like(values, np.nan)},
        "words": {"values": np.full(values.shape, "1.0")},
        "objects": {"values": np.array([object()])},
        "more": {"others": values},
        "checksum": {"sha256": np.array([1.0, 2.0])},
    }.get(damage, {})
    if damage == "no checksum":
        del arrays["sha256"]
    if damage == "other table":
        arrays = TABLE
    np.savez(path, **arrays)


DAMAGES = (
    "cut", "flipped", "empty", "text", "altered", "shape", "type", "nan", "words", "objects", "more", "checksum",
    "no checksum", "other table",
)  # fmt: skip


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_table_is_absent_with_one_line_and_can_be_kept_again(tables, damage):
    kept(tables, "a")
    path = tables.folder / "a.npz"
    damaged(path, damage)
    with pytest.warns(UserWarning, match=r"must be as the program stored it \(got .+\); the program computes") as lines:
        assert tables.find("a") is None
    (line,) = lines
    assert str(path) in str(line.message)
    assert len(warnings.formatwarning(line.message, line.category, line.filename, line.lineno).splitlines()) == 1
    kept(tables, "a")
    np.testing.assert_array_equal(tables.find("a")["values"], TABLE["values"])


def test_a_table_under_the_name_of_another_is_absent(tables):
    kept(tables, "a")
    kept(tables, "b")
    (tables.folder / "a.npz").replace(tables.folder / "b.npz")
    with pytest.warns(UserWarning, match="do not match the checksum"):
        assert tables.find("b") is None


def test_a_folder_that_cannot_be_made_keeps_nothing(tmp_path):
    (tmp_path / "file").write_text("")
    tables = TableCache(tmp_path / "file" / "tables")
    kept(tables, "a")
    assert tables.find("a") is None
    assert tables.entries() == []
    tables.clear()


def test_a_folder_may_be_there_to_read_only(tables, monkeypatch):
    def refused(*_, **__):
        raise PermissionError(13, "Permission denied")

    kept(tables, "a")
    monkeypatch.setattr(os, "utime", refused)
    monkeypatch.setattr(module.tempfile, "mkstemp", refused)
    kept(tables, "b")
    np.testing.assert_array_equal(tables.find("a")["values"], TABLE["values"])
    assert tables.find("b") is None


def test_a_disk_that_is_full_keeps_nothing_and_leaves_nothing(tables, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    kept(tables, "a")
    assert list(tables.folder.iterdir()) == []


# --- size -------------------------------------------------------------------------------------------------------


def names(tables):
    return {entry.path.stem for entry in tables.entries()}


def test_tables_used_longest_ago_go_first(tables):
    for age, name in enumerate("abcde"):
        kept(tables, name, used=age)
    size = tables.entries()[0].size
    tables.find("e")  # the oldest, but used now
    tables.set_limit(int(3.5 * size))
    assert names(tables) == {"e", "a", "b"}
    kept(tables, "f")  # four are more than the limit: down to 80 % of it, two
    assert len(tables.entries()) == 2
    assert {"e", "f"} == names(tables)
    assert TableCache(tables.folder).limit == int(3.5 * size)


def test_another_process_may_have_filled_the_folder(tables):
    kept(tables, "a", used=10)
    for name in "bc":
        kept(TableCache(tables.folder), name)
    tables.set_limit(2 * tables.entries()[0].size)
    assert names(tables) == {"b", "c"}


def test_a_damaged_limit_is_the_usual_one(tables):
    assert tables.limit == module.DEFAULT_LIMIT
    tables.set_limit(12345)
    assert tables.limit == 12345
    (tables.folder / "limit").write_text("many")
    assert tables.limit == module.DEFAULT_LIMIT


def test_a_limit_must_be_positive(tables):
    with pytest.raises(SceneError, match=r"cache.limit must be positive \[bytes\].*\(got 0\)"):
        tables.set_limit(0)


def test_unfinished_files_of_the_dead_are_removed_and_those_of_the_living_are_not(tables):
    kept(tables, "a")
    for name, age in (("dead.unfinished", 1e5), ("living.unfinished", 0.0)):
        path = tables.folder / name
        path.write_bytes(b"half")
        moment = path.stat().st_mtime - age
        os.utime(path, (moment, moment))
    kept(TableCache(tables.folder), "b")
    assert {path.name for path in tables.folder.iterdir()} == {"a.npz", "b.npz", "living.unfinished"}
    tables.clear()
    assert list(tables.folder.iterdir()) == []


def test_many_may_write_and_read_at_once(tables):
    tables.set_limit(40_000)  # four tables: eviction goes on all the time

    def work(number):
        own = TableCache(tables.folder)
        name = "abcdefgh"[number % 8]
        own.keep(name, {"values": np.full(1000, float(number % 8))})
        found = own.find(name)
        return found is None or bool((found["values"] == number % 8).all())

    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(work, range(200)))
    assert not list(tables.folder.glob("*.unfinished"))


# --- where ------------------------------------------------------------------------------------------------------


def test_the_folder_is_where_the_platform_keeps_such_files(monkeypatch, tmp_path):
    monkeypatch.delenv("EIGENCONTACT_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert table_cache().folder == tmp_path / "eigencontact"
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")  # must be ignored, says its specification
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr(sys, "platform", "linux")
    assert table_cache().folder == tmp_path / ".cache" / "eigencontact"
    monkeypatch.setattr(sys, "platform", "darwin")
    assert table_cache().folder == tmp_path / "Library" / "Caches" / "eigencontact"


@pytest.mark.parametrize("word", ["", "off", " OFF "])
def test_it_can_be_turned_off(monkeypatch, word):
    monkeypatch.setenv("EIGENCONTACT_CACHE", word)
    assert table_cache() is None


def test_a_folder_of_ones_own(monkeypatch, tmp_path):
    monkeypatch.setenv("EIGENCONTACT_CACHE", str(tmp_path / "mine"))
    assert table_cache().folder == tmp_path / "mine"
    assert table_cache() is table_cache()
    monkeypatch.setenv("EIGENCONTACT_CACHE", "~/mine")
    assert table_cache().folder == Path.home() / "mine"


def test_a_user_without_a_home_keeps_nothing(monkeypatch):
    monkeypatch.delenv("EIGENCONTACT_CACHE")
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)

    def nowhere():
        raise RuntimeError("no home")

    monkeypatch.setattr(Path, "home", nowhere)
    assert table_cache() is None
