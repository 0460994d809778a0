# SPDX-License-Identifier: GPL-3.0-or-later
"""What long work does to the process that it runs in: others go on, Ctrl-C ends it, and nothing of it is changed."""
import ctypes
import os
import re
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import bed, lattice

import nscdd


class Interrupting(threading.Thread):
    """Sends Ctrl-C to this process some seconds after `begun` says so, once, unless it is left before."""

    def __init__(self, after, begun=lambda: True):
        super().__init__(daemon=True)
        self.after, self.begun, self.left = after, begun, threading.Event()

    def run(self):
        while not self.begun() and not self.left.wait(0.01):
            pass
        if not self.left.wait(self.after):
            os.kill(os.getpid(), signal.SIGINT)

    def __enter__(self):
        self.start()

    def __exit__(self, *_):
        self.left.set()
        self.join()


def long_sweep(progress=None):
    parts = nscdd.decompose(lattice(12, 12), (4, 4))
    return nscdd.sweep(parts, np.geomspace(1e-3, 1e3, 20_000), progress=progress)


def large_contraction():
    return nscdd.contraction(nscdd.decompose(lattice(120, 100), "metis:16"), epsilon=1e-4, eta=1e-2)


def test_ctrl_c_ends_a_sweep():
    rows = []
    with pytest.raises(KeyboardInterrupt), Interrupting(0.2, lambda: rows):
        long_sweep(lambda done, total: rows.append((done, total)))
    assert 0 < rows[-1][0] < rows[-1][1] == 20_000


def test_ctrl_c_ends_a_spectrum():
    """Between two factorisations or solves: the whole takes seconds of the processor, what is interrupted part of it."""
    b = large_contraction()
    started, clock = time.process_time(), time.monotonic()
    whole = nscdd.spectral_radius(b, certify=True, solver="shift-invert")
    work, seconds = time.process_time() - started, time.monotonic() - clock
    assert whole.converged
    started = time.process_time()
    with pytest.raises(KeyboardInterrupt), Interrupting(0.1 * seconds):
        nscdd.spectral_radius(b, certify=True, solver="shift-invert")
    assert time.process_time() - started < 0.8 * work
    again = nscdd.spectral_radius(b, certify=True, solver="shift-invert")
    assert (again.value, again.residual) == (whole.value, whole.residual)  # what was interrupted left nothing behind


def test_ctrl_c_ends_a_generator_and_a_solver():
    seen = [0]
    with pytest.raises(KeyboardInterrupt), Interrupting(0.2):
        nscdd.generate("deposit", grains=3_000_000, progress=lambda done, total: seen.append(done))
    assert seen[-1] < 2_000_000
    w, q = np.eye(1000) + np.ones((1000, 1000)), np.random.default_rng(0).normal(size=1000)
    with pytest.raises(KeyboardInterrupt), Interrupting(0.3):
        nscdd.solve(w, q, 0.5, solver="nlgs", maximum_sweeps=10**9, tolerance=1e-300, check_every=1)


def test_ctrl_c_ends_arpack():
    """Between two products of its iteration, which takes far longer in all."""
    b = large_contraction()
    started = time.process_time()
    with pytest.raises(KeyboardInterrupt), Interrupting(0.3):
        nscdd.spectral_radius(b, solver="arpack")
    interrupted = time.process_time() - started
    small = nscdd.contraction(nscdd.decompose(bed(900, 3), "metis:8"), 0.05)
    found = nscdd.spectral_radius(small, solver="arpack")  # ARPACK is left as it was
    assert found.converged and found.value == nscdd.spectral_radius(small, solver="arpack").value
    assert interrupted < 8


def test_ctrl_c_ends_an_inexact_stage_one():
    parts = nscdd.decompose(lattice(60, 60), "metis:16")
    with pytest.raises(KeyboardInterrupt), Interrupting(0.5):
        nscdd.sweep(parts, 1e-4, gauss_seidel_sweeps=200, solver="arpack")


@pytest.mark.parametrize("solver", ["generic", "nlgs", "newton"])
def test_ctrl_c_ends_a_single_step(solver):
    """Between two iterations, or checks of a contact solver, of a step that is never done."""
    case = os.path.join(os.environ["NSCDD_SOURCE"], "cases", "settle-1k.toml")
    settings = {"dynamics.steps": 1, "dynamics.step": 0.02, "solver.algorithm": solver}
    if solver == "newton":
        settings |= {"solver.tolerance": 1e-300, "solver.maximum_iterations": 10**6}
    else:  # without a criterion it cannot stall
        settings |= {"solver.criterion": "none", "solver.maximum_iterations": 10**8}
    seen = []
    started = time.monotonic()
    with pytest.raises(KeyboardInterrupt), Interrupting(1):
        nscdd.simulate(case, settings=settings, callback=seen.append)
    assert seen == [] and time.monotonic() - started < 120


def test_what_ends_the_work_is_what_is_raised():
    """An interrupted search for a curve says so, not what it met on its way out."""
    parts = nscdd.decompose(lattice(12, 12), (4, 4))
    with pytest.raises(KeyboardInterrupt), Interrupting(0.3):
        nscdd.curve(parts, (1e-5, 1e5), [0.1, 0.3, 1.0, 3.0, np.inf], tolerance=1e-7)


def test_a_callback_may_use_the_library():
    """Also from within: no lock of the library is held while Python is called."""
    parts = nscdd.decompose(lattice(8, 8), (2, 2))
    b = nscdd.contraction(parts, 0.1)
    seen = []
    nscdd.sweep(parts, np.geomspace(1e-2, 1, 6), solver="shift-invert",
                progress=lambda done, total: seen.append(nscdd.spectral_radius(b, solver="arpack").value))
    assert seen and len(set(seen)) == 1


def test_a_callback_that_raises_ends_the_work():
    def refuse(done, total):
        raise RuntimeError(f"enough after {done}")

    with pytest.raises(RuntimeError, match="enough after"):
        long_sweep(refuse)


def test_other_threads_go_on():
    b = large_contraction()
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.005)

    thread = threading.Thread(target=tick)
    thread.start()
    started = time.monotonic()
    nscdd.spectral_radius(b)
    ended = time.monotonic()
    done.set()
    thread.join()
    within = [t for t in ticks if started < t < ended]
    # Without the release of the interpreter lock there would be none.
    assert len(within) > 20 * (ended - started)


def test_two_threads_at_once():
    b = nscdd.contraction(nscdd.decompose(bed(800), "metis:6"), 0.01, 1.0)
    expected = nscdd.spectral_radius(b).value
    found = [None] * 4

    def work(k):
        found[k] = nscdd.spectral_radius(b, solver="shift-invert" if k % 2 else "auto").value

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_progress_counts_up_to_the_end(capsys):
    parts = nscdd.decompose(lattice(5, 5), (2, 1))
    seen = []
    nscdd.sweep(parts, [0.1, 1, 10], progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (3, 3) and seen == sorted(seen)
    seen.clear()
    nscdd.optimum(parts, [0.1, 1], contacts="all", progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (2, 2)
    seen.clear()
    nscdd.generate("deposit", grains=400_000, progress=lambda done, total: seen.append((done, total)))
    assert 0 < seen[-1][0] < seen[-1][1] == 400_000 and seen == sorted(seen)  # calls are 50 ms apart
    nscdd.sweep(parts, [0.1, 1, 10], progress=True)
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.endswith("3 of 3, 0 s\n") and "#" * 30 in captured.err


def test_threads_change_no_bit():
    parts = nscdd.decompose(bed(1500, 2), "metis:8")
    one, all_of_them = (nscdd.sweep(parts, [1e-3, 1], [0.1, np.inf], solver="shift-invert", threads=threads)
                        for threads in (1, 0))
    for name in one:
        np.testing.assert_array_equal(one[name], all_of_them[name])


def open_blas():
    paths = {path for path in re.findall(r"/\S+\.so\S*", Path("/proc/self/maps").read_text(encoding="utf-8"))}
    for path in sorted(paths):
        library = ctypes.CDLL(path) if "blas" in path else None
        if library is not None and hasattr(library, "openblas_get_num_threads"):
            return library
    raise AssertionError(f"expected OpenBLAS among {sorted(paths)}")


def caught_signals():
    return re.search(r"SigCgt:\s*(\w+)", Path("/proc/self/status").read_text(encoding="utf-8")).group(1)


def test_the_process_is_left_as_it_was():
    blas, c = open_blas(), ctypes.CDLL(None)
    blas.openblas_set_num_threads(2)
    np.random.seed(3)
    expected = np.random.uniform(size=3)
    np.random.seed(3)
    c.srandom(5)
    sequence = [c.random() for _ in range(6)]
    c.srandom(5)
    handlers = [signal.getsignal(s) for s in (signal.SIGINT, signal.SIGTERM)]
    before = caught_signals(), np.geterr(), os.getcwd(), dict(os.environ), threading.active_count()
    assert [c.random() for _ in range(3)] == sequence[:3]
    parts = nscdd.decompose(lattice(20, 20), "metis:6")  # METIS draws random numbers, dense spectra call the BLAS
    nscdd.spectral_radius(nscdd.contraction(parts, 0.0, 1.0), certify=True, solver="dense")
    nscdd.sweep(parts, [0.1], solver="arpack")
    with pytest.raises(nscdd.Error):
        nscdd.spectral_radius(nscdd.contraction(parts, -1.0))
    assert [c.random() for _ in range(3)] == sequence[3:]
    assert (caught_signals(), np.geterr(), os.getcwd(), dict(os.environ), threading.active_count()) == before
    assert [signal.getsignal(s) for s in (signal.SIGINT, signal.SIGTERM)] == handlers
    assert blas.openblas_get_num_threads() == 2
    np.testing.assert_array_equal(np.random.uniform(size=3), expected)
