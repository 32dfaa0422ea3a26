"""A maker's own checksum: a function in Python that a system file names, imported and called."""

from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import importlib
import importlib.util
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

from ...errors import ConfigError, RunError, nearest, short
from .module_names import bound_names, installed

Computed = Callable[[bytes, int, int, int], int]
"""A function (payload, identifier, counter, bits of the checksum's signal) -> checksum."""


@dataclasses.dataclass(frozen=True)
class MakerChecksum:
    """The function "module:function" of a system file in `folder`, whose key `place` names it.

    `signal` is what it fills, as "message.signal". The module is MODULE.py in the folder, else an installed
    one.
    """

    name: str
    folder: str
    place: str
    signal: str

    @property
    def file(self) -> Path | None:
        """The module's file in the folder; None where it has none there."""
        base = Path(self.folder, *self.name.partition(":")[0].split("."))
        files = (base.with_suffix(".py"), base / "__init__.py")
        return next((file for file in files if file.is_file()), None)

    def check(self) -> None:
        """Raise ConfigError where there is no such module or function, without running any code of either.

        A module that may bind names while it runs, or that is no Python, may have any function.
        """
        wanted, _, name = self.name.partition(":")
        file = self.file
        if file is None:
            there, file = installed(wanted)
            if not there:
                raise self._missing()
        if file is None:
            return
        try:
            names = bound_names(file.read_bytes(), str(file))
        except OSError as error:
            raise ConfigError(f"{self.place}: {file} cannot be read: {error.strerror}") from error
        except (SyntaxError, ValueError) as error:
            raise self._not_imported(error) from error
        if names is not None and name not in names:
            raise self._lacking(str(file), name, names)

    def loaded(self) -> Computed:
        """Import the module, and return its function with its answers checked.

        Raises ConfigError where there is no such module or function, or the import fails. What is returned
        raises RunError, which names file, signal and exception.
        """
        _, _, name = self.name.partition(":")
        module = self._module()
        function = getattr(module, name, None)
        if function is None:
            public = [known for known, value in vars(module).items() if callable(value)]
            raise self._lacking(self._where(module), name, public)
        if not callable(function):
            raise ConfigError(f"{self.place}: {name} of {self._where(module)} is no function")
        where = self._where(module)

        def computed(payload: bytes, identifier: int, counter: int, bits: int) -> int:
            try:
                found = function(payload, identifier, counter)
            except Exception as error:  # whatever somebody else's function raises
                raise self._failed(where, f"{type(error).__name__}: {error}{_line(error)}") from error
            if not isinstance(found, int) or isinstance(found, bool) or not 0 <= found < 1 << bits:
                raise self._failed(
                    where,
                    f"it returned {short(found)}, and a whole number from 0 to {(1 << bits) - 1} is needed",
                )
            return int(found)

        return computed

    def _module(self) -> ModuleType:
        wanted, _, _ = self.name.partition(":")
        try:
            if self.file is not None:
                return _imported(self.file, self.folder)
            return importlib.import_module(wanted)
        except ModuleNotFoundError as error:
            if error.name is not None and wanted.split(".")[: error.name.count(".") + 1] == error.name.split(
                "."
            ):
                raise self._missing() from error
            raise self._not_imported(error) from error
        except Exception as error:  # whatever the module raises
            raise self._not_imported(error) from error

    def _missing(self) -> ConfigError:
        wanted = self.name.partition(":")[0]
        files = [path.stem for path in sorted(Path(self.folder).glob("*.py"))]
        return ConfigError(
            f"{self.place}: there is no module '{wanted}', neither {wanted.replace('.', '/')}.py in "
            f"{self.folder} nor installed{nearest(wanted, files)}"
        )

    def _lacking(self, where: str, name: str, known: Iterable[str]) -> ConfigError:
        return ConfigError(f"{self.place}: {where} has no '{name}'{nearest(name, known)}")

    def _not_imported(self, error: Exception) -> ConfigError:
        what = self.file or self.name.partition(":")[0]
        return ConfigError(
            f"{self.place}: {what} cannot be imported: {type(error).__name__}: {error}{_line(error)}"
        )

    def _where(self, module: ModuleType) -> str:
        return str(getattr(module, "__file__", None) or module.__name__)

    def _failed(self, where: str, reason: str) -> RunError:
        return RunError(f"the checksum {self.signal} by {self.name} of {where}: {reason}")


def _imported(file: Path, folder: str) -> ModuleType:
    """Import a file under a name that nothing else has; it finds what stands beside it."""
    digest = hashlib.sha256(str(file.resolve()).encode()).hexdigest()[:16]
    spec = importlib.util.spec_from_file_location(f"evcosim_checksum_{digest}", file)
    assert spec is not None and spec.loader is not None  # it ends in .py
    module = importlib.util.module_from_spec(spec)
    with _beside(folder):
        sys.modules[spec.name] = module  # dataclasses look themselves up there
        try:
            spec.loader.exec_module(module)
        except BaseException:
            del sys.modules[spec.name]
            raise
    return module


@contextlib.contextmanager
def _beside(folder: str) -> Iterator[None]:
    """Let imports find the modules of a folder within the block."""
    sys.path.insert(0, folder)
    try:
        yield
    finally:
        with contextlib.suppress(ValueError):
            sys.path.remove(folder)


def _line(error: BaseException) -> str:
    """Return the innermost place of an error's traceback in words."""
    trace: Any = None if isinstance(error, SyntaxError) else error.__traceback__  # it says the line itself
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    if trace is None:
        return ""
    return f" ({Path(trace.tb_frame.f_code.co_filename).name}, line {trace.tb_lineno})"
