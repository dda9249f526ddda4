"""OpenCL drivers that pip installed, for machines whose system has none."""

from __future__ import annotations

import os
import sys
from pathlib import Path

#: Where pip's packages put the driver library, below sys.prefix.
_LIBRARIES = ("lib/libintelocl.so",)


def _system_has_driver() -> bool:
    vendors = Path("/etc/OpenCL/vendors")
    return vendors.is_dir() and any(vendors.glob("*.icd"))


def use_driver_of_pip() -> None:
    """Points OpenCL's loader at a driver below sys.prefix, unless the system or the user has one."""
    if any(name in os.environ for name in ("OCL_ICD_VENDORS", "OCL_ICD_FILENAMES")):
        return
    if _system_has_driver():
        return
    for name in _LIBRARIES:
        library = Path(sys.prefix) / name
        if library.exists():
            os.environ["OCL_ICD_FILENAMES"] = str(library)
            return
