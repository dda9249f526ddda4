"""OpenCL drivers that pip installed, for machines whose system has none."""

from __future__ import annotations

import atexit
import ctypes
import os
import shutil
import tempfile
import warnings
from importlib import metadata
from pathlib import Path

_INTEL = ("intel-opencl-rt", "libintelocl.so")
_POCL = ("pocl-binary-distribution", "libpocl*.so")


def _system_has_driver() -> bool:
    vendors = Path("/etc/OpenCL/vendors")
    return vendors.is_dir() and any(vendors.glob("*.icd"))


def _library(package: str, pattern: str) -> Path | None:
    """The file of that pattern in an installed package, or none."""
    try:
        files = metadata.files(package) or []
    except metadata.PackageNotFoundError:
        return None
    found = (Path(str(file.locate())) for file in files if file.match(pattern))
    return next((path.resolve() for path in found if path.exists()), None)


def _driver_of_pip() -> Path | None:
    """Intel's runtime, or else PyPI's PoCL if it finds the linker that it needs, or none."""
    intel = _library(*_INTEL)
    if intel is not None:
        return intel
    pocl = _library(*_POCL)
    if pocl is not None and shutil.which("ld") is None:  # it would end the process
        warnings.warn(
            "PoCL of pocl-binary-distribution needs the linker ld: install it (Debian: binutils), "
            "or pip install 'dapple[cpu]'",
            RuntimeWarning,
            stacklevel=4,
        )
        return None
    return pocl


def use_driver_of_pip() -> None:
    """Points OpenCL's loader at pip's driver, unless the system has one or the user names one."""
    if any(name in os.environ for name in ("OCL_ICD_VENDORS", "OCL_ICD_FILENAMES")):
        return
    library = None if _system_has_driver() else _driver_of_pip()
    if library is None:
        return
    # Before the engine's own oneTBB, which may be too old for the driver.
    ctypes.CDLL(str(library))
    # Loaders of every make read such a folder.
    vendors = tempfile.mkdtemp(prefix="dapple-")
    atexit.register(shutil.rmtree, vendors, ignore_errors=True)
    (Path(vendors) / "pip.icd").write_text(str(library), encoding="utf-8")
    os.environ["OCL_ICD_VENDORS"] = vendors
