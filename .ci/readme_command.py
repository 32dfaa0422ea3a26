"""Print one of the README's two commands: the code block below the comment <!-- command: NAME -->."""

import pathlib
import re
import sys

name = sys.argv[1]
readme = (pathlib.Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")
found = re.search(rf"<!-- command: {name} -->\s*```(?:sh|bash)?\n(.*?)\n```", readme, re.DOTALL)
if found is None:
    sys.exit(f"README.md has no code block below <!-- command: {name} -->")
print(found[1])
