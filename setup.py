"""The build step that pyproject.toml cannot declare: it starts without the files of an earlier build."""

from __future__ import annotations

import os
import shutil

from setuptools import setup
from setuptools.command.build_py import build_py


class CleanBuild(build_py):
    """Copy the packages into an empty folder.

    setuptools copies into build/lib and packs all that is there, so that a module that was moved or deleted
    since the last build would stay in the wheel, and an older file that is newer by its date too.
    """

    def run(self) -> None:
        """Remove build/lib, then copy; an editable installation copies nothing and keeps it."""
        if not self.editable_mode and os.path.isdir(self.build_lib):
            shutil.rmtree(self.build_lib)
        super().run()


setup(cmdclass={"build_py": CleanBuild})
