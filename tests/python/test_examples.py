"""Every program in examples/python ends with 0, which it does only if its result is right."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.parametrize("program", sorted((Path(__file__).parents[2] / "examples" / "python").glob("*.py")),
                         ids=lambda p: p.name)
def test_example(program: Path) -> None:
    subprocess.run([sys.executable, str(program)], check=True, timeout=300)
