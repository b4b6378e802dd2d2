"""Compiled kernels are kept under a key of all their sources."""

import shutil
from pathlib import Path

import pytest

from ospace.kernels.jit import cache


@pytest.fixture
def fresh(monkeypatch, tmp_path):
    """A cache that knows nothing, over a copy of the kernels."""
    sources = tmp_path / "kernels"
    shutil.copytree(Path(cache.__file__).parents[1], sources, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(cache, "__file__", str(sources / "jit" / "cache.py"))
    monkeypatch.setenv("OSPACE_CACHE_DIR", str(tmp_path / "cache"))
    cache.directory.cache_clear()
    yield sources
    cache.directory.cache_clear()


@pytest.mark.parametrize("edited", ["spatial.py", "jit/simd.py"])
def test_an_edit_of_any_kernel_file_moves_the_folder(fresh, edited):
    before = cache.directory()
    source = fresh / edited
    source.write_text(source.read_text() + "\n# edited\n")
    cache.directory.cache_clear()
    assert cache.directory() not in (None, before)


def test_the_same_sources_find_their_folder_again(fresh):
    before = cache.directory()
    cache.directory.cache_clear()
    assert cache.directory() == before
    assert before.is_dir()


def test_where_nothing_can_be_written_there_is_no_folder(fresh, monkeypatch, tmp_path):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("OSPACE_CACHE_DIR", str(tmp_path / "file"))
    cache.directory.cache_clear()
    with pytest.warns(RuntimeWarning, match="OSPACE_CACHE_DIR"):
        assert cache.directory() is None
    with cache.keyed_on_sources() as writable:
        assert not writable


def test_numbas_own_setting_is_left_as_it_was(fresh):
    import numba

    before = numba.config.CACHE_DIR
    with cache.keyed_on_sources():
        assert str(cache.directory()) == numba.config.CACHE_DIR
    assert before == numba.config.CACHE_DIR
