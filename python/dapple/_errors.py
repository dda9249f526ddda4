"""The exceptions of dapple. Each has the one line that the program would print."""


class Error(RuntimeError):
    """The work could not be finished: disk, memory, a device that failed.

    >>> issubclass(dapple.InputError, dapple.Error)
    True
    """

    __module__ = "dapple"


class UsageError(Error, ValueError):
    """An argument is wrong or missing. Messages about options name the command line's flag.

    >>> dapple.load("scene:tree?leaves=100").occlusion([[0, 0]], [0, 1, 0])
    Traceback (most recent call last):
    dapple.UsageError: points has the shape (1, 2); it must be (n, 3)
    """

    __module__ = "dapple"


class InputError(Error):
    """A scene, image or lights file is wrong; the message names file and element.

    >>> dapple.load("missing.glb")
    Traceback (most recent call last):
    dapple.InputError: missing.glb: no such file
    """

    __module__ = "dapple"


class DeviceError(Error):
    """There is no usable OpenCL device.

    >>> dapple.load("scene:tree?leaves=100").occlusion([[0, 0, 0]], [0, 1, 0], device="none")
    Traceback (most recent call last):
    dapple.DeviceError: no OpenCL device matches ...
    """

    __module__ = "dapple"
