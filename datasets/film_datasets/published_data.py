"""The small datasets that are installed with the package; examples/published_datasets.py makes them."""

from __future__ import annotations

from pathlib import Path

from film_datasets.files import SUFFIX, read
from film_model.base.errors import did_you_mean, shown
from film_model.base.foreign import Dataset

HERE = Path(__file__).parent


def _files() -> dict[str, Path]:
    """Files by name: inside the installed package, or beside it in a working copy."""
    folder = HERE / "published" if (HERE / "published").is_dir() else HERE.parent / "published"
    return {path.stem: path for path in sorted(folder.glob(f"*{SUFFIX}"))}


def published() -> dict[str, str]:
    """The names that `load` takes, each with the title of its dataset."""
    return {name: str(read(path).attrs["title"]) for name, path in _files().items()}


def load(name: str) -> Dataset:
    """A dataset that is installed with the package, e.g. "zener". Raises KeyError for an unknown name.

    >>> sorted(fd.published())[:2]
    ['finite_element_impacts', 'finite_element_pairs']
    >>> fd.load("zener").sizes["target_thickness"]
    121
    """
    files = _files()
    if name not in files:
        hint = did_you_mean(str(name), files) or f"; there are {', '.join(files)}"
        raise KeyError(f"no published dataset is called {shown(name)}{hint}")
    return read(files[name])
