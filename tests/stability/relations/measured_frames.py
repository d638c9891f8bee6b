"""Frames for the measuring relations: grains that a map carries, drawn here by a code of its own, and published images."""
import os
import pathlib
import struct
import zlib

import numpy as np


def splat(width, height, at, level, size):
    """Sum of Gaussian grains."""
    reach = int(np.ceil(3.5 * size.max()))
    near = np.arange(-reach, reach + 1)
    column, row = np.rint(at[:, 0]).astype(int), np.rint(at[:, 1]).astype(int)
    seen = (column > -reach) & (column < width + reach) & (row > -reach) & (row < height + reach)
    at, level, size, column, row = at[seen], level[seen], size[seen], column[seen], row[seen]
    columns, rows = column[:, None] + near, row[:, None] + near
    x = np.exp(-0.5 * ((columns - at[:, :1]) / size[:, None])**2)
    y = np.exp(-0.5 * ((rows - at[:, 1:]) / size[:, None])**2)
    wide, tall = width + 4 * reach, height + 4 * reach
    places = (rows[:, :, None] + 2 * reach) * wide + columns[:, None, :] + 2 * reach
    out = np.bincount(places.ravel(), (level[:, None, None] * y[:, :, None] * x[:, None, :]).ravel(), wide * tall)
    return out.reshape(tall, wide)[2 * reach:2 * reach + height, 2 * reach:2 * reach + width]


def drawn(width, height, place, frames, seed, noise_seed=0, noise=2.0, grain=1.6, density=0.08):
    """Frames 0 ... frames - 1; place(X, k): where the grain that is at X [n][2] (column, row) in frame 0 is in frame k."""
    dice = np.random.default_rng(seed)
    margin = 48
    count = int(density * (width + 2 * margin) * (height + 2 * margin))
    start = dice.uniform([-margin, -margin], [width + margin, height + margin], (count, 2))
    level, size = dice.uniform(-1, 1, count), grain * dice.uniform(0.75, 1.3, count)
    out = []
    for k in range(frames):
        grey = 118 + 42 * splat(width, height, place(start, k), level, size)
        grey += np.random.default_rng([seed, noise_seed, k]).normal(0, noise, grey.shape)
        out.append(np.clip(np.rint(grey), 0, 255).astype(np.uint8))
    return out


def vortex(width, height, step, radius):
    """About the middle, fastest (px a frame) at the radius."""
    middle = np.array([width / 2, height / 2])

    def place(start, k):
        r = start - middle
        turn = k * step / radius * np.exp(0.5 * (1 - (r**2).sum(axis=1) / radius**2))
        c, s = np.cos(turn), np.sin(turn)
        return middle + np.stack([c * r[:, 0] - s * r[:, 1], s * r[:, 0] + c * r[:, 1]], axis=1)
    return place


def band(width, height, step, half_width, onset=0):
    """Along a row: the sides move by -step and step px a frame from a frame on."""
    def place(start, k):
        u = max(0, k - onset) * step * np.tanh((start[:, 1] - 0.46 * height - 0.07 * start[:, 0]) / half_width)
        return start + np.stack([u, 0.07 * u], axis=1)
    return place


def evenly(width, height, shift, gradient):
    """By a shift and a gradient of displacement a frame, about the middle."""
    middle = np.array([width / 2, height / 2])

    def place(start, k):
        return start + k * (np.asarray(shift) + (start - middle) @ np.asarray(gradient).T)
    return place


# Annex K of ITU-T T.81: steps of luminance at quality 50.
STEPS = np.array([[16, 11, 10, 16, 24, 40, 51, 61], [12, 12, 14, 19, 26, 58, 60, 55], [14, 13, 16, 24, 40, 57, 69, 56],
                  [14, 17, 22, 29, 51, 87, 80, 62], [18, 22, 37, 56, 68, 109, 103, 77], [24, 35, 55, 64, 81, 104, 113, 92],
                  [49, 64, 78, 87, 103, 121, 120, 101], [72, 92, 95, 98, 112, 100, 103, 99]])


def recoded(frame, quality):
    """What JPEG makes of a frame at a quality of 50 to 100."""
    n = np.arange(8)
    C = np.cos(np.pi * (2 * n + 1) * n[:, None] / 16) * np.where(n == 0, np.sqrt(1 / 8), 0.5)[:, None]
    step = np.maximum(1, np.floor((STEPS * (200 - 2 * quality) + 50) / 100))
    height, width = frame.shape
    wide = np.pad(frame, ((0, -height % 8), (0, -width % 8)), "edge") - 128.0
    blocks = wide.reshape(wide.shape[0] // 8, 8, wide.shape[1] // 8, 8).transpose(0, 2, 1, 3)
    blocks = C.T @ (np.rint(C @ blocks @ C.T / step) * step) @ C
    out = blocks.transpose(0, 2, 1, 3).reshape(wide.shape)[:height, :width]
    return np.clip(np.rint(out + 128), 0, 255).astype(np.uint8)


def read(path):
    """An uncompressed 8-bit BMP or TIFF of one channel, of one strip."""
    data = pathlib.Path(path).read_bytes()
    if data[:2] == b"BM":
        start, = struct.unpack_from("<I", data, 10)
        width, height, _, bits = struct.unpack_from("<iiHH", data, 18)
        assert bits == 8, path
        rows = np.frombuffer(data, np.uint8, abs(height) * ((width + 3) // 4 * 4), start).reshape(abs(height), -1)[:, :width]
        return rows[::-1].copy() if height > 0 else rows.copy()
    order = "<" if data[:2] == b"II" else ">"
    at, = struct.unpack_from(order + "I", data, 4)
    tags = {}
    for n in range(struct.unpack_from(order + "H", data, at)[0]):
        tag, kind, _ = struct.unpack_from(order + "HHI", data, at + 2 + 12 * n)
        tags[tag] = struct.unpack_from(order + ("H" if kind == 3 else "I"), data, at + 10 + 12 * n)[0]
    assert tags.get(258, 1) == 8 and tags.get(259, 1) == 1, path
    return np.frombuffer(data, np.uint8, tags[256] * tags[257], tags[273]).reshape(tags[257], tags[256]).copy()


# Two frames each, cut to a part that shows material all over.
PUBLISHED = {
    "speckle, sheared": ("speckle_affine/Pattern_1.bmp", "speckle_affine/Pattern_1_Shear.bmp", 180, 180),
    "particles, PIV Challenge": ("openpiv/test14_disp_series/disp_104a.bmp", "openpiv/test14_disp_series/disp_104b.bmp", 40, 60),
    "speckle, DIC Challenge": ("dic_challenge_14/Sample14 Reference.tif", "dic_challenge_14/Sample14 L5 Amp0.1b.tif", 200, 900),
    "speckle, shifted by 2 px": ("dice_rigid_shift/ref.tif", "dice_rigid_shift/def_2.tif", 150, 150),
}


def published(width, height):
    """Pairs by name, those of PIVNP_TEST_DATA that are there."""
    folder = pathlib.Path(os.environ.get("PIVNP_TEST_DATA", "/nowhere"))
    return {name: [read(folder / path)[top:top + height, left:left + width] for path in (first, second)]
            for name, (first, second, top, left) in PUBLISHED.items() if (folder / first).exists() and (folder / second).exists()}


def png(frame):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + row.tobytes() for row in frame)
    head = struct.pack(">IIBBBBB", frame.shape[1], frame.shape[0], 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b"")


def save(folder, frames, names=None):
    """As PGM, or as PNG where a name ends so."""
    folder.mkdir(parents=True)
    for k, frame in enumerate(frames):
        name = names[k] if names else f"f{k:04d}.pgm"
        head = b"P5\n%d %d\n255\n" % (frame.shape[1], frame.shape[0])
        (folder / name).write_bytes(png(frame) if name.endswith(".png") else head + np.ascontiguousarray(frame).tobytes())
