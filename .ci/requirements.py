"""Print what extras of the project require, one a line for `pip install -r`: python .ci/requirements.py dev jax."""

import re
import sys
import tomllib
from pathlib import Path

EXTRAS = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]


def required(name: str) -> set[str]:
    """Of an extra, with those of the extras that it names."""
    found: set[str] = set()
    for line in EXTRAS[name]:
        own = re.fullmatch(r"film-model\[(.*)\]", line)
        found |= set().union(*map(required, own[1].split(","))) if own else {line}
    return found


print("\n".join(sorted(set().union(*map(required, sys.argv[1:])))))
