"""The build steps that pyproject.toml cannot declare: an empty folder, and native FMUs' libraries on Linux.

A wheel that is built on Linux, where there is a C compiler, ships the machine code of the built-in models, so
that its user needs none; its tag says on which systems that runs. EVCOSIM_WHEEL=pure leaves it out, and
EVCOSIM_WHEEL=native is an error where it cannot be made. Editable installations have none.
"""

from __future__ import annotations

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

from setuptools import setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

SHIPPED = "evcosim/fmus/native/shipped"


class CleanBuild(build_py):
    """Copy the packages into an empty folder, and add the libraries of built-in models.

    setuptools copies into build/lib and packs all that is there, so that a module that was moved or deleted
    since the last build would stay in the wheel, and an older file that is newer by its date too.
    """

    tag = ""
    """The platforms on which the libraries run; "" where there are none."""

    def run(self) -> None:
        """Remove build/lib, copy, compile; an editable installation copies nothing and keeps it."""
        if not self.editable_mode and os.path.isdir(self.build_lib):
            shutil.rmtree(self.build_lib)
        super().run()
        if not self.editable_mode:
            self.tag = self._ship()

    def _ship(self) -> str:
        """Compile the models of build/lib, and return the tag of the platforms; "" for a pure wheel."""
        wanted = os.environ.get("EVCOSIM_WHEEL", "")
        if wanted not in ("", "pure", "native"):
            sys.exit(f"EVCOSIM_WHEEL={wanted}: it is pure, native or not set")
        if wanted == "pure":
            return ""
        folder = pathlib.Path(self.build_lib).resolve()
        with tempfile.TemporaryDirectory() as metadata:
            self._describe(pathlib.Path(metadata))
            path = os.pathsep.join((str(folder), metadata))
            done = subprocess.run(
                [sys.executable, "-B", "-m", "evcosim.fmus.native.ship", str(folder / SHIPPED)],
                env={**os.environ, "PYTHONPATH": path},
                cwd=metadata,
                capture_output=True,
                text=True,
            )
        if done.returncode:
            shutil.rmtree(folder / SHIPPED, ignore_errors=True)
            if wanted == "native":
                sys.exit(f"native units cannot be shipped: {done.stderr}")
            print(f"evcosim: a pure wheel, without native units: {done.stderr}", file=sys.stderr)
            return ""
        return done.stdout.strip()

    def _describe(self, folder: pathlib.Path) -> None:
        """Write what FMUs tell of the distribution, which is not installed yet: version and license."""
        version = self.distribution.get_version()
        about = folder / f"evcosim-{version}.dist-info"
        (about / "licenses").mkdir(parents=True)
        (about / "METADATA").write_text(f"Metadata-Version: 2.4\nName: evcosim\nVersion: {version}\n")
        shutil.copy("LICENSE", about / "licenses")


class TaggedWheel(bdist_wheel):
    """A wheel for every Python 3; for the platforms of the libraries, if it ships any."""

    def run(self) -> None:
        """Build first, which says whether there are libraries."""
        self.run_command("build")
        if tag := self.get_finalized_command("build_py").tag:
            self.distribution.has_ext_modules = lambda: True  # it goes to where machine code is installed
            self.root_is_pure = False
            self.platform_tag = tag
        super().run()

    def get_tag(self) -> tuple[str, str, str]:
        """Return the tags of Python, its binary interface and the platform."""
        return "py3", "none", "any" if self.root_is_pure else self.platform_tag


setup(cmdclass={"build_py": CleanBuild, "bdist_wheel": TaggedWheel})
