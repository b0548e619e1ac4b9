"""The page as one file: HTML with its script, its style, the core in WebAssembly and the data."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
import zlib
from functools import cache
from pathlib import Path
from typing import Any

from film_model.base.files import written_whole
from film_model.explorer.content import Content
from film_model.scene import Scene

FOLDER = Path(__file__).parent / "web"
WASM = Path(__file__).parent / "_film_core.wasm"
_LEFT_OUT = re.compile(r"^ *//[^\n]*\n| */\*\*(?:(?!\*/).)*\*/\n?|^ +", re.MULTILINE | re.DOTALL)
SCRIPTS = (
    *("core", "data", "units", "effects", "solve", "modes", "panels", "plates", "oblique"),
    *("state", "studies", "draw", "netcdf", "export", "controls", "parts", "app"),
)
"""The files of the page's script, in the order in which they run."""

EXAMPLES = (
    *("tungsten-carbide-ball", "ball-on-composite-plate", "ball-on-plate", "drop-test-on-glass", "shot-peening"),
    *("hail", "ball-on-rod", "ball-on-beam", "ball-on-structure", "two-balls"),
)
"""The scenes that the page offers under these names, in the folder `scenes`. The first is shown when it opens."""


def page(scene: Scene | None = None) -> str:
    """The HTML of the page; it opens with the scene, or with the first example.

    Raises SimulationError if the page cannot simulate the scene, ImportError if this installation has no WebAssembly.
    """
    content = Content([*([] if scene is None else [("scene", scene)]), *examples()])
    script = _script(content.script)
    style = _text("style.css")
    table = content.table()
    parts = {
        "policy": _policy(script, style),
        "title": html.escape(table["scenes"][0]["title"]),
        "style": style,
        "data": _json(table),
        "core": _packed(wasm()),
        "curves": _packed(content.curves),
        "script": script,
    }
    text = _text("index.html")
    for name, part in parts.items():
        text = text.replace(f"<!--{name}-->", part, 1)
    return text


def write_page(path: Path, scene: Scene | None = None) -> None:
    """Write the page to a file, whole or not at all."""
    text = page(scene)
    with written_whole(path) as beside:
        beside.write_text(text, "utf-8")


@cache
def wasm() -> bytes:
    """The core in WebAssembly. Raises ImportError if this installation was built without zig."""
    if not WASM.exists():
        raise ImportError(f"{WASM} is missing: install ziglang (pip install ziglang), then film-model again")
    return WASM.read_bytes()


def scripts() -> dict[str, str]:
    """The page's own scripts by name, without the recorded formulas."""
    return {name: _text(f"{name}.js") for name in SCRIPTS}


@cache
def examples() -> tuple[tuple[str, Scene], ...]:
    """The scenes of the page, by name."""
    return tuple((name, Scene.from_toml(FOLDER.with_name("scenes") / f"{name}.toml")) for name in EXAMPLES)


def _script(formulas: str) -> str:
    """All scripts in one scope, without types, indentation and the comments that take whole lines."""
    own = _LEFT_OUT.sub("", "\n".join([*scripts().values(), formulas, "main();"]))
    return f'(() => {{\n"use strict";\n{own}}})();\n'


def _policy(script: str, style: str) -> str:
    """The Content-Security-Policy: this script and this style alone, and nothing from outside."""
    only = {"script-src": f"{_hash(script)} 'wasm-unsafe-eval'", "style-src": _hash(style), "img-src": "data: blob:"}
    rules = {"default-src": "'none'", **only, "base-uri": "'none'", "form-action": "'none'"}
    return "; ".join(f"{name} {value}" for name, value in rules.items())


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _json(table: Any) -> str:
    """JSON that cannot end the element that it is in."""
    text = json.dumps(table, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")


def _packed(data: bytes) -> str:
    return base64.b64encode(zlib.compress(data, 9)).decode()


def _text(name: str) -> str:
    return (FOLDER / name).read_text("utf-8")
