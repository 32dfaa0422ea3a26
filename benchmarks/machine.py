"""What the figures were measured on: processor, system, versions."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import time
from pathlib import Path


def about(packages: tuple[str, ...] = ("numpy", "numba", "fmpy", "pythonfmu")) -> str:
    """One sentence on the machine and the packages that the figures depend on."""
    versions = [f"Python {platform.python_version()}", *map(_version, packages)]
    return (
        f"{_processor()}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}; "
        f"{', '.join(versions)}; {time.strftime('%Y-%m-%d')}"
    )


def cores() -> list[int]:
    """The processors that this process may use, in order; [] where the system does not say."""
    return sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []


def _version(package: str) -> str:
    try:
        return f"{package} {importlib.metadata.version(package)}"
    except importlib.metadata.PackageNotFoundError:
        return f"no {package}"


def _processor() -> str:
    """The name of the processor, where the system tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return next((name for name in names if name), platform.processor() or "processor not told")
