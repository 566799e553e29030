"""Checks of arguments: arrays as C++ takes them, or an Error that names the argument."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core

Error = _core.Error
Floats = npt.NDArray[np.float64]

_MOST_SCRATCHES = 10_000_000
_started_in: int | None = None


def in_this_process() -> None:
    """Refuse work in a forked child of a process that worked already: its threads are not there."""
    global _started_in
    if _started_in is None:
        _started_in = os.getpid()
    elif _started_in != os.getpid():
        raise Error("pyburin: this process was forked after pyburin had worked; start it with the method 'spawn'")


def array_of(name: str, value: Any) -> npt.NDArray[Any]:
    """`value` as NumPy sees it, without a copy where its layout fits (DLPack, buffers, `__array__`)."""
    try:
        if hasattr(value, "__dlpack__") and not hasattr(value, "__array__"):
            return np.from_dlpack(value)
        return np.asarray(value)
    except Exception as error:  # whatever the object's own conversion raises
        raise Error(f"{name}: is no array of numbers ({error})") from None


def floats(name: str, value: Any, shape: tuple[int | None, ...]) -> Floats:
    """`value` as a contiguous float64 array of `shape`; None stands for any length.

    Other layouts (strides, byte order, float32, integers, read-only) are copied.
    """
    return _finite(name, value, shape, np.float64)


def pictures(name: str, value: Any, shape: tuple[int, ...]) -> npt.NDArray[np.float32]:
    """`value` as a contiguous float32 array of `shape`, without a copy if it is one."""
    return _finite(name, value, shape, np.float32)


def _finite(name: str, value: Any, shape: tuple[int | None, ...], kind: Any) -> npt.NDArray[Any]:
    array = array_of(name, value)
    if array.dtype.kind not in "fiu":
        raise Error(f"{name}: has the type {array.dtype}; give float64, float32 or integers")
    if array.ndim != len(shape) or any(n is not None and n != m for n, m in zip(shape, array.shape)):
        raise Error(f"{name}: has the shape {array.shape}; give {_words(shape)}")
    with np.errstate(over="ignore"):
        out = np.asarray(array, dtype=kind, order="C")
    if not np.isfinite(out).all():
        raise Error(f"{name}: has a value that is not finite; replace or drop it")
    return out


def number(name: str, value: Any, *, above: float | None = None, least: float | None = None,
           most: float | None = None) -> float:
    """One finite number within bounds."""
    out = float(floats(name, value, ()))
    if above is not None and not out > above:
        raise Error(f"{name}: is {out:g}; it must be above {above:g}")
    if least is not None and not out >= least:
        raise Error(f"{name}: is {out:g}; it must be at least {least:g}")
    if most is not None and not out <= most:
        raise Error(f"{name}: is {out:g}; it must be at most {most:g}")
    return out


def integer(name: str, value: Any, least: int, most: int) -> int:
    """One integer from `least` to `most`."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)):
        raise Error(f"{name}: is {type(value).__name__}; give an integer")
    if not least <= value <= most:
        raise Error(f"{name}: is {value}; give {least} to {most}")
    return int(value)


def flag(name: str, value: Any) -> bool:
    """True or False."""
    if not isinstance(value, (bool, np.bool_)):
        raise Error(f"{name}: is {type(value).__name__}; give True or False")
    return bool(value)


def text(name: str, value: Any) -> str:
    """A string."""
    if not isinstance(value, str):
        raise Error(f"{name}: is {type(value).__name__}; give a string")
    return value


def ends(value: Any) -> Floats:
    """Ends of scratches, (N, 2, 2) or (N, 4), as (N, 4)."""
    array = array_of("ends_mm", value)
    if array.ndim == 2:
        out = floats("ends_mm", array, (None, 4))
    else:
        out = floats("ends_mm", array, (None, 2, 2)).reshape(-1, 4)
    if len(out) > _MOST_SCRATCHES:
        raise Error(f"ends_mm: has {len(out)} scratches; give at most {_MOST_SCRATCHES}")
    return out


def column(name: str, value: Any, size: int, *, most: float = np.inf) -> Floats | None:
    """A positive number for each scratch, from (N,) or one number for all; None stays None."""
    if value is None:
        return None
    out = floats(name, value, () if array_of(name, value).ndim == 0 else (size,))
    if not ((out > 0) & (out <= most)).all():
        raise Error(f"{name}: has a value that is not above 0{'' if most == np.inf else f' and at most {most:g}'}")
    return np.ascontiguousarray(np.broadcast_to(out, (size,)))


def _words(shape: tuple[int | None, ...]) -> str:
    return "(" + ", ".join("N" if n is None else str(n) for n in shape) + ("," if len(shape) == 1 else "") + ")"
