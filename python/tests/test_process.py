"""Interruption, progress, threads, forks and collected objects."""

import gc
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import dapple
import numpy as np
import pytest

UP = [0, 1, 0]


def test_an_exception_of_the_progress_function_ends_the_call(
    tree: dapple.Scene, ground: np.ndarray
) -> None:
    calls: list[float] = []

    def progress(fraction: float) -> None:
        calls.append(fraction)
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        tree.occlusion(np.repeat(ground, 100, axis=0), UP, rays=4096, progress=progress)
    assert len(calls) == 1
    with pytest.raises(LookupError, match="enough"):
        tree.render(width=64, height=64, spp=64, progress=progress)
    assert tree.occlusion(ground, UP).shape == (400,)


def test_a_progress_function_cannot_call_dapple(tree: dapple.Scene, ground: np.ndarray) -> None:
    with pytest.raises(dapple.UsageError, match="progress function must not call"):
        tree.occlusion(ground, UP, progress=lambda _: tree.occlusion(ground, UP))


LONG_CALLS = {
    "occlusion": 'scene.occlusion(points, UP, rays=1 << 14, estimator="exact")',
    "irradiance": 'scene.irradiance(points, UP, rays=1 << 10, estimator="exact")',
    "measure": 'scene.measure(points, UP, rays=1 << 14, estimator="exact")',
    "render": "scene.render(width=1920, height=1080, spp=4096)",
    # Between two questions whether to stop are 262,144 samples, of more rays the more rays there are.
    "bake": 'dapple.load("scene:tree?leaves=200000").bake(rays=1024, target_error=0)',
}


@pytest.mark.parametrize("call", LONG_CALLS.values(), ids=list(LONG_CALLS))
def test_an_interrupt_ends_a_long_call(call: str) -> None:
    script = f"""
import dapple, numpy as np, os, signal, threading, time
UP = {UP}
scene = dapple.load("scene:tree?leaves=2000")
scene.add_sun([0, 1, 0], angular_diameter=5)
points = np.random.default_rng(1).uniform(-2, 2, (1_000_000, 3))
scene.occlusion(points[:10], UP)
def interrupt():
    time.sleep(1)
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=interrupt).start()
start = time.time()
try:
    {call}
    print("finished")
except KeyboardInterrupt:
    print("interrupted")
assert scene.occlusion(points[:10], UP).shape == (10,)
"""
    found = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=300, check=False
    )
    assert found.stdout.strip() == "interrupted", found.stderr


def test_threads_share_a_scene(tree: dapple.Scene, ground: np.ndarray) -> None:
    expected = tree.occlusion(ground, UP)
    wrong: list[int] = []

    def work(number: int) -> None:
        scene = dapple.load("scene:tree?leaves=2000&opacity=0.85") if number % 2 else tree
        for _ in range(3):
            if not np.array_equal(scene.occlusion(ground, UP), expected):
                wrong.append(number)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_a_scene_may_change_while_another_thread_uses_it(ground: np.ndarray) -> None:
    scene = dapple.load("scene:tree?leaves=2000&opacity=0.85")
    failures: list[BaseException] = []

    def query() -> None:
        try:
            for _ in range(5):
                scene.occlusion(ground, UP)
        except BaseException as error:
            failures.append(error)

    thread = threading.Thread(target=query)
    thread.start()
    for i in range(20):
        scene.set_opacity(scene.materials[0], i / 20)
        scene.add_sun([0, 1, 0], name=f"sun{i}")
    thread.join()
    assert not failures


def test_other_threads_run_during_a_call(tree: dapple.Scene) -> None:
    ticks = 0
    done = threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not done.is_set():
            ticks += 1
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    tree.render(width=128, height=128, spp=64, light=False)
    done.set()
    thread.join()
    assert ticks > 5


def test_a_forked_child_is_told(tree: dapple.Scene, ground: np.ndarray) -> None:
    if sys.platform != "linux":
        pytest.skip("processes are forked on Linux")
    tree.occlusion(ground, UP)
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            tree.occlusion(ground, UP)
            os.write(writer, b"no error")
        except dapple.UsageError as error:
            os.write(writer, str(error).encode())
        finally:
            os._exit(0)
    os.waitpid(child, 0)
    assert b"spawn" in os.read(reader, 1000)
    assert tree.occlusion(ground, UP).shape == (400,)


def spawned_work(_: int) -> float:
    scene = dapple.load("scene:tree?leaves=100")
    return float(scene.occlusion([[0, 0.01, 0]], UP)[0])


def test_spawned_processes_work() -> None:
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        values = pool.map(spawned_work, range(2))
    assert values[0] == values[1]


def test_results_outlive_their_scene() -> None:
    scene = dapple.load("scene:tree?leaves=100")
    ao = scene.occlusion([[0, 0.01, 0]], UP)
    picture = scene.render(width=8, height=8, spp=4)
    pixels = picture["ao.R"]
    del scene, picture
    gc.collect()
    assert 0 <= ao[0] <= 1 and 0 <= pixels.min() and pixels.max() <= 1


def resident_bytes() -> int:
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_calls_leave_no_memory_behind(tree: dapple.Scene, ground: np.ndarray) -> None:
    if sys.platform != "linux":
        pytest.skip("/proc tells the resident memory on Linux")
    points = np.repeat(ground, 50, axis=0)
    for _ in range(20):
        result_bytes = tree.occlusion(points, UP, rays=1).nbytes
    before = resident_bytes()
    for _ in range(300):
        tree.occlusion(points, UP, rays=1)
    # The results, the smallest arrays of a call, would be 24 MB if they all stayed.
    assert resident_bytes() - before < 300 * result_bytes / 2
