"""Scenes and the program, which the tests share."""

import os
import shutil

import dapple
import numpy as np
import pytest


def plate_scene(opacity: float = 1.0, half: float = 1.0, height: float = 1.0) -> dapple.Scene:
    """A horizontal square above the origin."""
    corners = [[-half, height, -half], [half, height, -half], [half, height, half], [-half, height, half]]
    return dapple.Scene.from_arrays(corners, [[0, 1, 2], [0, 2, 3]], opacity)


@pytest.fixture
def plate() -> dapple.Scene:
    return plate_scene()


@pytest.fixture(scope="session")
def tree() -> dapple.Scene:
    return dapple.load("scene:tree?leaves=2000&opacity=0.85")


@pytest.fixture(scope="session")
def ground() -> np.ndarray:
    x, z = np.meshgrid(np.linspace(-2, 2, 20), np.linspace(-2, 2, 20))
    return np.stack([x.ravel(), np.full(x.size, 0.01), z.ravel()], axis=1).astype(np.float32)


@pytest.fixture(scope="session")
def program() -> str:
    """Path of the program dapple."""
    found = os.environ.get("DAPPLE_PROGRAM") or shutil.which("dapple")
    if not found:
        pytest.skip("there is no program dapple in PATH or DAPPLE_PROGRAM")
    return found
