"""Decodes the Cryptomattes of an EXR file with a reader and a hash that are not dapple's.

python3 decode_cryptomatte.py FILE TYPE [NAME ALONE]

Checks that the manifest's ids are the hashes of its names and that coverages add up to alpha, and
prints each name's mean coverage. With NAME and ALONE, another file: the coverage of NAME must be the
alpha of ALONE to 1e-3. Exit code 1: something is wrong.

Needs only Python. It reads scanlines, of one part or several, uncompressed or with ZIP or ZIPS:
https://openexr.com/en/latest/OpenEXRFileLayout.html. Parts of other compressions are passed over.
Specification: https://github.com/Psyop/Cryptomatte
"""

import json
import struct
import sys
import zlib

MASK = 0xFFFFFFFF
MULTIPART = 0x1000
LINES = {0: 1, 2: 1, 3: 16}  # of a chunk, by compression: none, ZIPS, ZIP
KINDS = {0: ("I", 4), 1: ("e", 2), 2: ("f", 4)}  # of a channel's values


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


class Bytes:
    """A file's bytes, read from front to back."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        self.at += count
        return self.data[self.at - count : self.at]

    def unpack(self, form):
        return struct.unpack("<" + form, self.take(struct.calcsize("<" + form)))

    def text(self):
        end = self.data.index(b"\0", self.at)
        text = self.data[self.at : end].decode()
        self.at = end + 1
        return text


def read_header(data):
    """Attributes by name: strings as such, others as bytes. Empty: no more headers."""
    attributes = {}
    while name := data.text():
        kind = data.text()
        value = data.take(*data.unpack("i"))
        attributes[name] = value.decode() if kind == "string" else value
    return attributes


def channels_of(header):
    """Names and kinds of values, in the order in which each line has them."""
    data, channels = Bytes(header["channels"]), []
    while name := data.text():
        channels.append((name, KINDS[data.unpack("i")[0]]))
        data.take(12)
    return channels


def unpacked(block, compression, size):
    """A chunk's bytes: ZIP stores differences, of bytes of even places before those of odd ones."""
    if compression == 0 or len(block) == size:
        return block
    stored = bytearray(zlib.decompress(block))
    for i in range(1, len(stored)):
        stored[i] = (stored[i - 1] + stored[i] - 128) & 255
    half = (len(stored) + 1) // 2
    out = bytearray(len(stored))
    out[0::2], out[1::2] = stored[:half], stored[half:]
    return bytes(out)


def read(path):
    """The channels' bytes and kinds by name, and the attributes of all headers."""
    with open(path, "rb") as file:
        data = Bytes(file.read())
    magic, version = data.unpack("II")
    assert magic == 20000630
    headers = [read_header(data)]
    while version & MULTIPART and (header := read_header(data)):
        headers.append(header)
    windows = [struct.unpack("<4i", header["dataWindow"]) for header in headers]
    compressions = [header["compression"][0] for header in headers]
    parts = [channels_of(header) for header in headers]
    tables = []
    for header, window, compression in zip(headers, windows, compressions):
        lines = window[3] - window[1] + 1
        chunks = -(-lines // LINES.get(compression, 32))
        if "chunkCount" in header:
            (chunks,) = struct.unpack("<i", header["chunkCount"])
        tables.append(data.unpack(f"{chunks}Q"))
    found, attributes = {}, {}
    for part, (header, window) in enumerate(zip(headers, windows)):
        attributes.update(header)
        if compressions[part] not in LINES:
            continue
        width = window[2] - window[0] + 1
        rows = {name: [] for name, _ in parts[part]}
        for offset in tables[part]:
            data.at = offset + (4 if version & MULTIPART else 0)
            first, size = data.unpack("ii")
            count = min(LINES[compressions[part]], window[3] - first + 1)
            line = width * sum(kind[1] for _, kind in parts[part])
            lines = Bytes(unpacked(data.take(size), compressions[part], count * line))
            for _ in range(count):
                for name, kind in parts[part]:
                    rows[name].append(lines.take(width * kind[1]))
        found.update({name: (b"".join(rows[name]), kind[0]) for name, kind in parts[part]})
    return found, attributes


def values(channels, name, kind=None):
    if name not in channels:
        sys.exit(f"there is no channel {name} that is uncompressed or compressed by ZIP or ZIPS")
    data, form = channels[name]
    return [value for (value,) in struct.iter_unpack("<" + (kind or form), data)]


def coverage(channels, kind, wanted):
    total = [0.0] * len(values(channels, f"{kind}00.R"))
    for layer in ("00", "01", "02"):
        if f"{kind}{layer}.R" not in channels:
            break  # fewer names than ranks
        for id_channel, share in (("R", "G"), ("B", "A")):
            ids = values(channels, f"{kind}{layer}.{id_channel}", "I")
            shares = values(channels, f"{kind}{layer}.{share}")
            total = [t + (s if i == wanted else 0) for t, i, s in zip(total, ids, shares)]
    return total


def largest_difference(some, others):
    return max(abs(a - b) for a, b in zip(some, others))


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
    total = [0.0] * len(values(channels, f"{kind}00.R"))
    for known, digits in manifest.items():
        assert int(digits, 16) == float_id(known), known
        share = coverage(channels, kind, float_id(known))
        total = [t + s for t, s in zip(total, share)]
        print(f"{known}: {sum(share) / len(share):.6f}")
    assert sum(total) > 0.01 * len(total), "nothing is covered"
    difference = largest_difference(total, values(channels, "A"))
    print(f"sum and alpha differ by at most {difference:.2e}")
    # A half of alpha has steps of 2^-11.
    assert difference < (1e-6 if channels["A"][1] == "f" else 5e-4)
    if name is not None:
        assert name in manifest, name
        other, _ = read(alone)
        difference = largest_difference(coverage(channels, kind, float_id(name)),
                                        values(other, "A"))
        print(f"{name}: at most {difference:.2e} from its alpha alone")
        assert difference < 1e-3


if __name__ == "__main__":
    main(*sys.argv[1:])
