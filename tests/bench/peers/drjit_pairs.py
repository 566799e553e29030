#!/usr/bin/env python3
"""Burin's iteration beside Dr.Jit's, of the same pairs: tests/bench/peers/drjit_pairs.py [--iterations N]

Needs Dr.Jit and numpy from PyPI, an LLVM that suits it, and Burin built:

  python3 -m venv peers && peers/bin/pip install drjit numpy
  sudo apt-get install libllvm19
  export DRJIT_LIBLLVM_PATH=/usr/lib/x86_64-linux-gnu/libLLVM-19.so
  cmake --build build/release --target burin_bench burin_peer_pairs
  peers/bin/python tests/bench/peers/drjit_pairs.py

Dr.Jit evaluates the paper's formula as the paper does: of each pair the footprint's four edges, clamped to the groove's
width, the closed integral over each, added into the picture; a picture loss; and the way back to the scratches' ends by
its reverse mode. In its favor: two real logarithms and arctangents an edge where the paper has four complex ones, no
share of the plain face, no Adam, scratches without ends (as in the paper), the pairs given. Times are processor time of
one iteration on one thread; Burin's is that of tests/bench (PaperDesign: pairs found, clipped at their ends, loss,
Adam). Embree finds them by the paper's recipe; where each view has pixels of its own, as the paper's, it does so for each.
Dr.Jit's picture is held against Burin's exact double integral first: a peer that is wrong proves nothing.
"""
import argparse
import json
import math
import subprocess
import tempfile
import time
from pathlib import Path

import drjit as dr
import numpy as np
from drjit.llvm import ad

SOURCE = Path(__file__).resolve().parent.parent.parent.parent
BOARD_MM, PIXELS, WIDTH_MM, DEPTH_MM, ALPHA = 300.0, 512, 0.03, 0.03, 0.04  # tests/bench/paper_scene.cpp
SCRATCHES, VIEWS = 40000, 2  # of those that tests/bench has, the paper's


def lobe(e, k, s, from_t, to_t, level, slope):
    """The integral of (level + slope t) (R + R^2) over [from_t, to_t], R = 1 / (1 - u) (docs/model.md 4.5 to 4.9)."""
    p = 1 + k
    g, f = 2 * (1 - s * s / p), 2 * e / p
    one = 1 / p
    b, c = (level - slope * e / p) / p, slope / (p * p)
    constant = one * one + one
    n1, n1_tau = (2 * one + 1) * g + f * f, -(2 * one + 1) * f
    n2, n2_tau = g * g - f * f * s * s, -2 * f * g

    def at(t):
        tau = p * t + e
        n = tau * tau + s * s
        j1 = dr.atan2(tau, s) / s
        k1 = 0.5 * dr.log(n)
        j2 = (tau / n + j1) / (2 * s * s)
        k2 = -0.5 / n
        return (constant * (b * tau + 0.5 * c * tau * tau) + b * (n1 * j1 + n1_tau * k1 + n2 * j2 + n2_tau * k2) +
                c * (n1 * k1 + n1_tau * (tau - s * s * j1) + n2 * k2 + n2_tau * (j1 - s * s * j2)))

    return at(to_t) - at(from_t)


def dhat(ends, corners, h):
    """The paper's integral of each pair in mm^2; ends x0, y0, x1, y1, corners four of x, y, h three."""
    x0, y0, x1, y1 = ends
    dx, dy = x1 - x0, y1 - y0
    inverse = dr.rsqrt(dx * dx + dy * dy)
    yx, yy = dx * inverse, dy * inverse
    xx, xy = yy, -yx
    rim = math.sqrt(1 - math.exp(-2 * DEPTH_MM / WIDTH_MM))
    hx, hy, hz = h[0] * xx + h[1] * xy, h[0] * yx + h[1] * yy, h[2]
    r = math.sqrt(1 - ALPHA * ALPHA)
    e, k = r * hx, r * hz
    s = dr.sqrt(hy * hy + ALPHA * ALPHA * (hx * hx + hz * hz))
    half = 0.5 * WIDTH_MM
    t = [((x - x0) * xx + (y - y0) * xy) / half for x, y in corners]
    up = [((x - x0) * yx + (y - y0) * yy) / half for x, y in corners]
    middle = 0.25 * (up[0] + up[1] + up[2] + up[3])  # counted from there, digits are kept
    total = 0
    for i in range(4):
        j = (i + 1) % 4
        run = t[j] - t[i]
        slope = dr.select(dr.abs(run) > 1e-5, (up[j] - up[i]) / run, 0)
        level = up[i] - middle - slope * t[i]
        a, b = dr.clip(t[i], -rim, rim), dr.clip(t[j], -rim, rim)
        total += lobe(e, k, s, a, b, level, slope) + lobe(-e, -k, s, a, b, level, slope)
    return dr.abs(total) * (half * half * ALPHA * ALPHA / math.pi / 4)


def rms(values):
    return math.sqrt((values ** 2).mean())


class Work:
    def __init__(self, folder, views, number):
        read = lambda name, kind: np.fromfile(folder / name, dtype=kind)
        self.number = number
        self.ends = [number(read(f'{n}.f64', np.float64)) for n in ('x0', 'y0', 'x1', 'y1')]
        self.pixel, self.scratch = ad.UInt32(read('pixel.u32', np.uint32)), ad.UInt32(read('scratch.u32', np.uint32))
        self.h = [[number(np.ascontiguousarray(read(f'h_{v}.f64', np.float64).reshape(-1, 3)[:, k])) for k in range(3)]
                  for v in range(views)]
        self.factor = [number(read(f'factor_{v}.f64', np.float64)) for v in range(views)]
        self.glints = [read(f'glints_{v}.f64', np.float64) for v in range(views)]
        self.target = [number(np.full(PIXELS * PIXELS, 0.4)) for _ in range(views)]
        self.exposure = [float(0.05 / g.mean()) for g in self.glints]
        dr.eval(self.ends, self.pixel, self.scratch, self.h, self.factor, self.target)

    def away_from_ends(self):
        """The pixels that no scratch ends in or beside."""
        near = np.zeros((PIXELS + 2, PIXELS + 2), dtype=bool)
        x0, y0, x1, y1 = (np.asarray(v) for v in self.ends)
        for x, y in ((x0, y0), (x1, y1)):
            column = np.clip((x * PIXELS / BOARD_MM).astype(int), 0, PIXELS - 1) + 1
            row = np.clip(((BOARD_MM - y) * PIXELS / BOARD_MM).astype(int), 0, PIXELS - 1) + 1
            for across in (-1, 0, 1):
                for down in (-1, 0, 1):
                    near[row + down, column + across] = True
        return ~near[1:-1, 1:-1].ravel()

    def picture(self, view):
        pitch = BOARD_MM / PIXELS
        column, row = self.number(self.pixel % PIXELS), self.number(self.pixel // PIXELS)
        left, top = column * pitch, BOARD_MM - row * pitch
        corners = [(left, top), (left + pitch, top), (left + pitch, top - pitch), (left, top - pitch)]
        ends = [dr.gather(self.number, v, self.scratch) for v in self.ends]
        h = [dr.gather(self.number, v, self.pixel) for v in self.h[view]]
        out = dr.zeros(self.number, PIXELS * PIXELS)
        dr.scatter_add(out, dhat(ends, corners, h), self.pixel)
        return out * self.factor[view]

    def iteration(self):
        for v in self.ends:
            dr.disable_grad(v)
            dr.enable_grad(v)
        loss = 0
        for view in range(len(self.h)):
            shown = dr.power(dr.maximum(self.exposure[view] * self.picture(view), 1e-4), 1 / 2.2)
            loss += dr.mean(dr.square(shown - self.target[view]))
        dr.backward(loss)
        gradients = [dr.grad(v) for v in self.ends]
        dr.eval(gradients)
        dr.sync_thread()
        return gradients


def burins(name):
    done = subprocess.run([SOURCE / 'build/release/tests/bench/burin_bench', f'--benchmark_filter={name}', '--benchmark_format=json'],
                          capture_output=True, text=True, check=True)
    return json.loads(done.stdout)['benchmarks'][0]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--iterations', type=int, default=20)
    o = parser.parse_args()
    dr.set_thread_count(0)  # this thread alone
    with tempfile.TemporaryDirectory() as made:
        subprocess.run([SOURCE / 'build/release/tests/bench/burin_peer_pairs', str(SCRATCHES), str(VIEWS), made], check=True)
        exact, work = Work(Path(made), VIEWS, ad.Float64), Work(Path(made), VIEWS, ad.Float)
    whole = exact.away_from_ends()
    for name, of in (('double', exact), ('float', work)):
        errors = [rms((np.asarray(of.picture(v)) - exact.glints[v])[whole]) / exact.glints[v].max() for v in range(VIEWS)]
        print(f"Dr.Jit, {name}: RMS {max(errors):.1e} of the picture's peak ({100 * whole.mean():.0f} % of the pixels have no end near)")
    work.iteration()
    began = time.process_time()
    for _ in range(o.iterations):
        work.iteration()
    peer_ms = 1e3 * (time.process_time() - began) / o.iterations
    burin_ms = burins(f'PaperDesign/scratches:{SCRATCHES}/views:{VIEWS}/gram:0/placed:0/bright:0/threads:1/')['cpu_time']
    embree_ms = burins('FindPairsByEmbree/for_peers')['cpu_time']
    print(f'| processor time of an iteration, {SCRATCHES:,} x {VIEWS} | ms | times Burin\'s |\n| --- | --- | --- |')
    for what, ms in (('Burin', burin_ms), ('Dr.Jit, its pairs given', peer_ms),
                     ('and found by Embree, once for all views', peer_ms + embree_ms),
                     ('and found by Embree, for each view', peer_ms + VIEWS * embree_ms)):
        print(f'| {what} | {ms:.1f} | {ms / burin_ms:.1f} |')


if __name__ == '__main__':
    main()
