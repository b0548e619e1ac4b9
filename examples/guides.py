"""Run the commands of the pages in docs/start and docs/how_to, and write their output into the pages.

A block whose first line is a comment with a file's name becomes that file; in a block of the console, what follows a
line "$ command" is its output. The commands of a page run in one folder, in order.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

DOCS = Path(__file__).parents[1] / "docs"
PAGES = tuple(path for part in ("start", "how_to") for path in sorted((DOCS / part).glob("*.md")))
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"# ([\w.]+\.\w+)\n")
PICTURE = re.compile(r"!\[[^]]*\]\((\w+\.png)\)")
INSTALLS = ("python3 -m venv", ".venv", ". .venv", "pip install")
"""Beginnings of the commands that install the package, which are not run."""

DURATION = re.compile(r"[\d.e+]+ a second, [\d.]+ s\b")
"""What a sweep says of its own speed."""

LONG = re.compile(r"-?\b\d(?=[\d.]{5})\d*\.\d+(?:e[-+]?\d+)?")
CLOSE = 1e-3
"""Numbers of six characters and more, and how far they may differ: a fit amplifies rounding, which differs among
processors."""

COLOURS = 64
"""Colours of a picture, which make it a quarter as large."""


def run(command: str, folder: Path) -> str:
    """What a command prints: its output, then its warnings."""
    path = os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", "")))
    environment = {**os.environ, "PATH": path, "PYTHONIOENCODING": "utf-8"}
    shell = ["bash", "-c", command]
    done = subprocess.run(shell, cwd=folder, env=environment, capture_output=True, encoding="utf-8", check=False)
    return (done.stdout + done.stderr).replace(f"{folder}{os.sep}", "").rstrip("\n")


def same(one: str, other: str) -> bool:
    """Whether two texts are the same but for the duration of a sweep and digits that depend on the processor."""
    texts = [DURATION.sub("", text) for text in (one, other)]
    numbers = [[float(number) for number in LONG.findall(text)] for text in texts]
    alike = LONG.sub("", texts[0]) == LONG.sub("", texts[1])
    return alike and all(abs(a - b) <= CLOSE * abs(b) for a, b in zip(*numbers, strict=True))


def page(text: str, folder: Path) -> str:
    """The text of a page with the output of its commands, which run in the folder.

    Raises ValueError with the output of a command that ends in a traceback.
    """

    def block(match: re.Match[str]) -> str:
        kind, body = match[1], match[2]
        if kind == "console":
            commands = [line for line in body.splitlines() if line.startswith("$ ")]
            outputs = (run(line[2:], folder) if not line[2:].startswith(INSTALLS) else "" for line in commands)
            lines = [line for pair in zip(commands, outputs, strict=True) for line in pair if line]
            if any("Traceback (most recent call last)" in line for line in lines):
                raise ValueError("\n".join(lines))
            written = "```console\n" + "".join(f"{line}\n" for line in lines) + "```"
            return match[0] if same(written, match[0]) else written
        name = FILE.match(body)
        if name is None:
            raise ValueError(f"this block does not name its file in a comment on its first line:\n{body}")
        (folder / name[1]).write_text(body, encoding="utf-8")
        return match[0]

    return BLOCK.sub(block, text)


def main() -> None:
    """Write the outputs and the pictures into all pages, or into those named on the command line."""
    for path in (path for path in PAGES if len(sys.argv) == 1 or path.stem in sys.argv):
        with tempfile.TemporaryDirectory() as name:
            text = page(path.read_text(encoding="utf-8"), Path(name))
            path.write_text(text, encoding="utf-8")
            for picture in PICTURE.findall(text):
                drawn = Image.open(Path(name, picture)).convert("RGB")
                drawn.quantize(COLOURS).save(path.parent / picture, optimize=True)
        print(path)


if __name__ == "__main__":
    main()
