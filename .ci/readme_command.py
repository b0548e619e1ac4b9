"""Print the test command of the README: the second of the two console blocks under "## Set up"."""

import re
import sys
from pathlib import Path

text = Path(__file__).parents[1].joinpath("README.md").read_text(encoding="utf-8")
section = re.search(r"^## Set up\s*?\n(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)
blocks = re.findall(r"^```console\s*?\n(.*?)^```", section[1] if section else "", re.MULTILINE | re.DOTALL)
commands = [[line[2:] for line in block.splitlines() if line.startswith("$ ")] for block in blocks]
if [len(lines) for lines in commands] != [1, 1]:
    sys.exit(f'README.md: "## Set up" must hold two console blocks with one "$ " line each; found {commands}')
print(commands[1][0])
