"""OpenCL drivers that pip installed, for machines whose system has none."""

from __future__ import annotations

import atexit
import ctypes
import os
import shutil
import tempfile
from importlib import metadata
from pathlib import Path
from typing import Callable


def at_exit(function: Callable[[], object]) -> None:
    """Calls the function when this process ends, not when one ends that was forked from it."""
    process = os.getpid()
    atexit.register(lambda: function() if os.getpid() == process else None)


def _system_has_driver() -> bool:
    vendors = Path("/etc/OpenCL/vendors")
    return vendors.is_dir() and any(vendors.glob("*.icd"))


def _driver_of_pip() -> Path | None:
    """Intel's runtime (intel-opencl-rt), wherever pip put it, or none.

    PoCL of pocl-binary-distribution 3.0 is not looked for: it links kernels with the system's `ld`
    against libgcc and libc, and ends the process where these are missing.
    """
    try:
        files = metadata.files("intel-opencl-rt") or []
    except metadata.PackageNotFoundError:
        return None
    found = (Path(str(file.locate())) for file in files if file.name == "libintelocl.so")
    return next((path.resolve() for path in found if path.exists()), None)


def use_driver_of_pip() -> None:
    """Points OpenCL's loader at pip's driver, unless the system has one or the user names one."""
    # A process that dapple's own started, by multiprocessing for example, has its parent's folder.
    of_parent = Path(os.environ.get("OCL_ICD_VENDORS", "")) / "pip.icd"
    if of_parent.parent.name.startswith("dapple-") and of_parent.exists():
        ctypes.CDLL(of_parent.read_text(encoding="utf-8"))
        return
    if any(name in os.environ for name in ("OCL_ICD_VENDORS", "OCL_ICD_FILENAMES")):
        return
    library = None if _system_has_driver() else _driver_of_pip()
    if library is None:
        return
    # Before the engine's own oneTBB, which may be too old for the driver.
    ctypes.CDLL(str(library))
    # Loaders of every make read such a folder.
    vendors = tempfile.mkdtemp(prefix="dapple-")
    at_exit(lambda: shutil.rmtree(vendors, ignore_errors=True))
    (Path(vendors) / "pip.icd").write_text(str(library), encoding="utf-8")
    os.environ["OCL_ICD_VENDORS"] = vendors
