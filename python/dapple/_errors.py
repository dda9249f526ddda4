"""The exceptions of dapple. Each has the one line that the program would print."""


class Error(RuntimeError):
    """The work could not be finished: disk, memory, a device that failed."""


class UsageError(Error, ValueError):
    """An argument is wrong or missing. Messages about options name the command line's flag."""


class InputError(Error):
    """A scene, image or lights file is wrong; the message names file and element."""


class DeviceError(Error):
    """There is no usable OpenCL device."""
