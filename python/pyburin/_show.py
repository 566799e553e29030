"""Pictures as PNG and HTML, for notebooks: without other packages."""

from __future__ import annotations

import base64
import html
import struct
import zlib
from typing import Any, Sequence

import numpy as np
import numpy.typing as npt

from . import _checks
from ._checks import Error


def png(picture: npt.ArrayLike) -> bytes:
    """A picture as a PNG file: (H, W), (H, W, 1) or (H, W, 3), gamma-encoded, white is 1, row 0 on top.

    Raises
    ------
    Error
        For another shape, or a value that is not finite.
    """
    array = _checks.array_of("picture", picture)
    if array.ndim == 2:
        array = array[..., None]
    values = _checks.floats("picture", array, (None, None, None))
    if values.shape[2] not in (1, 3) or 0 in values.shape:
        raise Error(f"picture: has the shape {values.shape}; give (H, W), (H, W, 1) or (H, W, 3)")
    bytes_of = np.round(255 * np.clip(values, 0, 1)).astype(np.uint8)
    height, width, channels = bytes_of.shape

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = np.zeros((height, 1 + width * channels), np.uint8)  # each row begins with its filter: none
    rows[:, 1:] = bytes_of.reshape(height, -1)
    head = struct.pack(">IIBBBBB", width, height, 8, 2 if channels == 3 else 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows.tobytes())) + chunk(b"IEND", b"")


def figures(pictures: Sequence[tuple[str, bytes]]) -> str:
    """HTML of captions and PNG files, side by side."""
    cells = []
    for caption, data in pictures:
        source = base64.b64encode(data).decode()
        cells.append(f'<figure style="margin:4px"><img alt="{html.escape(caption)}" style="max-width:320px;'
                     f'image-rendering:auto" src="data:image/png;base64,{source}"><figcaption>{html.escape(caption)}'
                     "</figcaption></figure>")
    return '<div style="display:flex;flex-wrap:wrap">' + "".join(cells) + "</div>"


def table(rows: Sequence[Sequence[Any]]) -> str:
    """HTML of a table; the first row has its headings."""
    lines = []
    for number, row in enumerate(rows):
        cell = "th" if number == 0 else "td"
        lines.append("<tr>" + "".join(f"<{cell}>{html.escape(str(v))}</{cell}>" for v in row) + "</tr>")
    return "<table>" + "".join(lines) + "</table>"


def lines_of(ends_mm: npt.NDArray[np.float64], size_mm: tuple[float, float] | None = None) -> str:
    """SVG of scratches, y upwards, of at most 20,000 of them."""
    some = ends_mm[:: max(1, -(-len(ends_mm) // 20_000))].reshape(-1, 4)
    high = (ends_mm.reshape(-1, 2).max(0) if size_mm is None else np.asarray(size_mm)) if len(ends_mm) else np.ones(2)
    low = ends_mm.reshape(-1, 2).min(0) if size_mm is None and len(ends_mm) else np.zeros(2)
    width, height = high - low
    path = "".join(f"M{a - low[0]:.2f} {high[1] - b:.2f}L{c - low[0]:.2f} {high[1] - d:.2f}" for a, b, c, d in some)
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="320" viewBox="0 0 {width:.2f} {height:.2f}" '
            f'style="background:#222"><path d="{path}" stroke="#eee" stroke-width="{max(width, height) / 1000:.3f}" '
            'fill="none"/></svg>')
