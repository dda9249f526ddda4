"""Decodes the Cryptomattes of an EXR file with a reader and a hash that are not dapple's.

python3 decode_cryptomatte.py FILE TYPE [NAME ALONE]

Checks that the manifest's ids are the hashes of its names and that coverages add up to alpha, and
prints each name's mean coverage. With NAME and ALONE, another file: prints the largest difference
between the coverage of NAME and the alpha of ALONE. Exit code 1: something is wrong.
Specification: https://github.com/Psyop/Cryptomatte
"""

import json
import struct
import sys

import numpy
import OpenEXR

MASK = 0xFFFFFFFF


def rotated(value, bits):
    return (value << bits | value >> (32 - bits)) & MASK


def murmur3(data):
    """MurmurHash3_x86_32, seed 0."""
    hash_value = 0
    whole = len(data) // 4 * 4
    for (block,) in struct.iter_unpack("<I", data[:whole]):
        hash_value ^= rotated(block * 0xCC9E2D51 & MASK, 15) * 0x1B873593 & MASK
        hash_value = (rotated(hash_value, 13) * 5 + 0xE6546B64) & MASK
    tail = int.from_bytes(data[whole:], "little")
    hash_value ^= rotated(tail * 0xCC9E2D51 & MASK, 15) * 0x1B873593 & MASK
    hash_value ^= len(data)
    for factor, shift in ((0x85EBCA6B, 16), (0xC2B2AE35, 13), (1, 16)):
        hash_value = (hash_value ^ hash_value >> shift) * factor & MASK
    return hash_value


def float_id(name):
    bits = murmur3(name.encode())
    exponent = min(max(bits >> 23 & 255, 1), 254)
    return bits & 0x807FFFFF | exponent << 23


def read(path):
    """Channels of all parts, and the attributes of all headers."""
    channels, attributes = {}, {}
    with OpenEXR.File(path, separate_channels=True) as file:
        for part in file.parts:
            attributes.update(part.header)
            channels.update({name: channel.pixels for name, channel in part.channels.items()})
    return channels, attributes


def coverage(channels, kind, wanted):
    total = 0
    for layer in ("00", "01", "02"):
        for id_channel, share in (("R", "G"), ("B", "A")):
            ids = channels[f"{kind}{layer}.{id_channel}"].view(numpy.uint32)
            total = total + numpy.where(ids == wanted, channels[f"{kind}{layer}.{share}"], 0)
    return total


def main(path, kind, name=None, alone=None):
    channels, attributes = read(path)
    keys = [key for key, value in attributes.items()
            if key.startswith("cryptomatte/") and key.endswith("/name") and value == kind]
    assert len(keys) == 1, "one key for the type"
    stem = keys[0][: -len("name")]
    assert stem == f"cryptomatte/{murmur3(kind.encode()):08x}"[:19] + "/"
    assert attributes[stem + "hash"] == "MurmurHash3_32"
    assert attributes[stem + "conversion"] == "uint32_to_float32"
    manifest = json.loads(attributes[stem + "manifest"])
    total = 0
    for known, digits in manifest.items():
        assert int(digits, 16) == float_id(known), known
        share = coverage(channels, kind, float_id(known))
        total = total + share
        print(f"{known}: {share.mean():.6f}")
    difference = numpy.abs(total - channels["A"]).max()
    print(f"sum and alpha differ by at most {difference:.2e}")
    # A half of alpha has steps of 2^-11.
    assert difference < (1e-6 if channels["A"].dtype == numpy.float32 else 5e-4)
    if name is not None:
        other, _ = read(alone)
        share = coverage(channels, kind, float_id(name))
        print(f"{name}: at most {numpy.abs(share - other['A']).max():.2e} from its alpha alone")


if __name__ == "__main__":
    main(*sys.argv[1:])
