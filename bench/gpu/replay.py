#!/usr/bin/env python3
"""Launches kernels of occlusion rays with the arguments that capture.cpp wrote, by CUDA's driver: times them, and
compares their results. NVIDIA's profiler can look at them:

    replay.py FOLDER FOLDER/program.bin other.cubin
    ncu --set full -k occlusion_scalar replay.py --rounds 1 FOLDER FOLDER/program.bin

In: the folder, and kernels as PTX or cubin. Out: a line for each, with times over that of the first."""
import argparse
import ctypes
import statistics
from pathlib import Path

import numpy

cuda = ctypes.CDLL("libcuda.so.1")


def call(name, *arguments):
    code = getattr(cuda, name)(*arguments)
    if code:
        text = ctypes.c_char_p()
        cuda.cuGetErrorString(code, ctypes.byref(text))
        raise SystemExit(f"{name}: {(text.value or b'unknown error').decode()} ({code})")


def start_driver():
    device, context = ctypes.c_int(), ctypes.c_void_p()
    call("cuInit", 0)
    call("cuDeviceGet", ctypes.byref(device), 0)
    call("cuDevicePrimaryCtxRetain", ctypes.byref(context), device)
    call("cuCtxSetCurrent", context)


class Launch:
    """Work-items, group size and arguments; the last buffer holds the results: transmittance, visits | tests << 16."""

    def __init__(self, folder):
        head, *lines = (folder / "launch.txt").read_text().splitlines()
        self.items, self.group = int(head.split()[1]), int(head.split()[3])
        self.arguments = []
        for line in lines:
            index, kind = line.split()
            data = (folder / f"arg{index}.bin").read_bytes()
            value = self.upload(data) if kind == "buffer" else ctypes.create_string_buffer(data, len(data))
            self.arguments.append(value)
        self.pointers = (ctypes.c_void_p * len(self.arguments))(*map(ctypes.addressof, self.arguments))

    def upload(self, data):
        memory = ctypes.c_uint64()
        call("cuMemAlloc_v2", ctypes.byref(memory), ctypes.c_size_t(len(data)))
        call("cuMemcpyHtoD_v2", memory, data, ctypes.c_size_t(len(data)))
        self.results, self.results_size = memory, len(data)
        return memory

    def seconds(self, function):
        begin, end, milliseconds = ctypes.c_void_p(), ctypes.c_void_p(), ctypes.c_float()
        call("cuEventCreate", ctypes.byref(begin), 0)
        call("cuEventCreate", ctypes.byref(end), 0)
        call("cuEventRecord", begin, None)
        groups = -(-self.items // self.group)
        call("cuLaunchKernel", function, groups, 1, 1, self.group, 1, 1, 0, None, self.pointers, None)
        call("cuEventRecord", end, None)
        call("cuEventSynchronize", end)
        call("cuEventElapsedTime", ctypes.byref(milliseconds), begin, end)
        return milliseconds.value / 1000

    def clear_results(self):
        call("cuMemsetD8_v2", self.results, ctypes.c_ubyte(255), ctypes.c_size_t(self.results_size))

    def read_results(self):
        data = ctypes.create_string_buffer(self.results_size)
        call("cuMemcpyDtoH_v2", data, self.results, ctypes.c_size_t(self.results_size))
        return numpy.frombuffer(data.raw, dtype=numpy.uint32).reshape(-1, 2)


def load(path, kernel):
    module, function = ctypes.c_void_p(), ctypes.c_void_p()
    # CUDA's driver refuses what OpenCL's compiler says of textures, of which there are none.
    program = path.read_bytes().replace(b", texmode_independent", b"")
    call("cuModuleLoadData", ctypes.byref(module), program + b"\0")
    call("cuModuleGetFunction", ctypes.byref(function), module, kernel.encode())
    return function


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("programs", type=Path, nargs="+")
    parser.add_argument("--kernel", default="occlusion_scalar")
    parser.add_argument("--rounds", type=int, default=7)
    options = parser.parse_args()
    start_driver()
    launch = Launch(options.folder)
    functions = [load(path, options.kernel) for path in options.programs]
    seconds = [[] for _ in functions]
    results = []
    for turn in range(options.rounds):
        for function, taken in zip(functions, seconds):
            launch.clear_results()
            taken.append(launch.seconds(function))
            if turn == 0:
                results.append(launch.read_results())
    first = statistics.median(seconds[0])
    is_ray = numpy.isfinite(results[0][:, 0].copy().view(numpy.float32))  # others were not written
    for path, taken, found in zip(options.programs, seconds, results):
        transmittances = [part[is_ray, 0].copy().view(numpy.float32) for part in (found, results[0])]
        difference = numpy.abs(transmittances[0] - transmittances[1]).max()
        print(f"{path.name}: {1e3 * statistics.median(taken):.3f} ms, {statistics.median(taken) / first:.3f}, "
              f"largest difference of {is_ray.sum()} rays {difference:.2g}")


if __name__ == "__main__":
    main()
