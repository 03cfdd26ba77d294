"""Life cycle of a node process: start, spin, stop on a signal, exit with at most one line."""

from __future__ import annotations

import gc
import signal
import sys
from collections.abc import Callable, Sequence
from functools import wraps
from typing import ParamSpec, Protocol, TypeVar

import rclpy
from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

from ghc_controller.errors import GhcError, InvalidValue
from ghc_controller.ros.process.freed_memory import limit_arenas
from ghc_controller.ros.stop_signals import STOP_SIGNALS
from ghc_controller.ros.this_host import stay_on_this_host

P = ParamSpec("P")
R = TypeVar("R")

EXIT_FAILED = 1  # failed while running, e.g. a partner is missing or the simulation diverged
EXIT_REFUSED = 2  # invalid parameter or file: never ran

# A signal is handled when Python code next runs: at the next callback, or after this long. It is
# also what makes EventsExecutor usable: its endless spin() never fires in the binary wheels, and
# 32 bytes stay in it per slice.
SPIN_SLICE = 0.2  # [s]


class RunnableNode(Protocol):
    """Interface that `run_node` requires of a node."""

    node: Node
    executor: str  # events | single

    def close(self) -> None:
        """Write pending output; called once, while ROS is still up."""


def guarded(stop: Future, callback: Callable[P, R]) -> Callable[P, R | None]:
    """Callback whose errors shut the node down cleanly; executors would log a traceback."""

    @wraps(callback)  # rclpy inspects the signature to decide what to pass
    def call(*args: P.args, **kwargs: P.kwargs) -> R | None:
        try:
            return callback(*args, **kwargs)
        except (GhcError, OSError) as error:
            if not stop.done():
                stop.set_exception(error)
            return None

    return call


def tolerant(
    callback: Callable[P, R],
    topic: str,
    reject: Callable[[str, str], object],
    fatal: tuple[type[Exception], ...] = (),
) -> Callable[P, R | None]:
    """Callback of `topic` that rejects a message instead of raising: the node keeps running.

    Args:
        reject: called with the topic and the exception.
        fatal: errors not caused by the message; they are raised to the caller.
    """

    @wraps(callback)
    def call(*args: P.args, **kwargs: P.kwargs) -> R | None:
        try:
            return callback(*args, **kwargs)
        except fatal:
            raise
        except Exception as error:  # a message may be anything
            reject(topic, f"message rejected, {type(error).__name__}: {error}")
            return None

    return call


def make_executor(kind: str) -> Executor:
    """Executor by the name that the parameter `executor` uses."""
    return EventsExecutor() if kind == "events" else SingleThreadedExecutor()


def spin_until(executor: Executor, stop: Future) -> None:
    """Spin until `stop` is done.

    Each slice waits for a future of its own: an executor leaves a callback with the one that it
    waits for, and those of `stop` would add up, by 20 MB per hour with a single thread.
    """
    slices = [Future()]
    stop.add_done_callback(lambda _: slices[0].done() or slices[0].set_result(None))
    while not stop.done():
        slices[0] = Future()
        executor.spin_until_future_complete(slices[0], SPIN_SLICE)


def run_node(
    name: str, create: Callable[[Future], RunnableNode], args: Sequence[str] | None = None
) -> int:
    """Run a node until SIGINT, SIGTERM or the end of the future that `create` is given.

    Returns the exit code of the process.

    Signals are handled here and not by rclpy: its handler takes the context down at once, under
    a callback that may be publishing or writing its last file.
    """
    limit_arenas()
    stop = Future()
    for number in STOP_SIGNALS:
        signal.signal(number, lambda _signal, _frame: stop.done() or stop.set_result(None))
    try:
        stay_on_this_host()
        rclpy.init(
            args=list(sys.argv if args is None else args),
            signal_handler_options=SignalHandlerOptions.NO,
        )
    except (InvalidValue, RuntimeError) as error:  # rclpy's root for malformed --ros-args
        return _complain(name, error, EXIT_REFUSED)
    try:
        return _run(name, create, stop)
    finally:
        rclpy.try_shutdown()
        for number in STOP_SIGNALS:
            # A second Ctrl-C during interpreter shutdown must not turn success into a kill.
            signal.signal(number, signal.SIG_IGN)


def _run(name: str, create: Callable[[Future], RunnableNode], stop: Future) -> int:
    try:
        runnable = create(stop)
    except (GhcError, OSError) as error:
        return _complain(name, error, EXIT_REFUSED)
    # Existing objects are permanent: the garbage collector need not scan them during a tick.
    gc.collect()
    gc.freeze()
    executor = make_executor(runnable.executor)
    executor.add_node(runnable.node)
    try:
        spin_until(executor, stop)
    finally:  # also after a bug: keep what was recorded so far
        try:
            runnable.close()
        except (GhcError, OSError) as error:
            stop.set_exception(error)
    failure = stop.exception()
    gc.unfreeze()  # else what refers to itself outlives the interpreter
    executor.remove_node(runnable.node)
    executor.shutdown()
    runnable.node.destroy_node()
    return 0 if failure is None else _complain(name, failure, EXIT_FAILED)


def _complain(name: str, error: Exception, code: int) -> int:
    print(f"{name}: {' '.join(str(error).split())}", file=sys.stderr, flush=True)
    return code
