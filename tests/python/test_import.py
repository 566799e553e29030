"""The package: what it imports, and that its names are documented."""

from __future__ import annotations

import subprocess
import sys

import pyburin as burin


def test_import_needs_numpy_alone() -> None:
    """No module outside the standard library and NumPy; and no PyTorch or JAX, which are for those who ask."""
    code = ("import numpy, sys; before = set(sys.modules); import pyburin; print(*sorted({m.split('.')[0] for m in "
            "set(sys.modules) - before} - set(sys.stdlib_module_names)))")
    got = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.split()
    assert "pyburin" in got and set(got) <= {"pyburin", "numpy", "nanobind"}


def test_public_names_are_documented() -> None:
    for name in burin.__all__:
        assert getattr(burin, name).__doc__, name
    assert burin.has("core") and not burin.has("telescope")
    assert burin.simd() in ("sse2", "avx2", "avx512", "generic")
