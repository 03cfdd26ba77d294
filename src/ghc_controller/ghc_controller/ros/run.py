"""Life of a node process: start, spin, stop on a signal, end with a clear line or none at all."""

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
from ghc_controller.ros.stop_signals import STOP_SIGNALS
from ghc_controller.ros.this_host import stay_on_this_host

P = ParamSpec("P")
R = TypeVar("R")

EXIT_FAILED = 1  # a partner is missing, the simulation diverged: failed while running
EXIT_REFUSED = 2  # a parameter or file cannot be used: never ran

# A signal is handled when Python code next runs: at the next callback, or after this long. It is
# also what makes EventsExecutor usable: its endless spin() never fires in the binary wheels.
SPIN_SLICE = 0.1  # [s]


class RunnableNode(Protocol):
    """What `run_node` needs to know of a node."""

    node: Node
    executor: str  # events | single

    def close(self) -> None:
        """Write what has to be written; called once, with ROS still up."""


def guarded(stop: Future, callback: Callable[P, R]) -> Callable[P, R | None]:
    """Callback whose errors end the node in order; executors would log a traceback of them."""

    @wraps(callback)  # rclpy looks at the signature to decide what to pass
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
    """Callback of `topic` that rejects a message instead of raising: the node lives.

    Args:
        reject: told the topic, and what was raised.
        fatal: errors that are no fault of the message, and go on to the caller.
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


def run_node(
    name: str, create: Callable[[Future], RunnableNode], args: Sequence[str] | None = None
) -> int:
    """Run a node until SIGINT, SIGTERM or the end of the future that `create` is given.

    Returns the exit code of the process.

    Signals are handled here and not by rclpy: its handler takes the context down at once, under
    a callback that may be publishing or writing its last file.
    """
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
            # A second Ctrl-C, while the interpreter winds up, must not turn success into a kill.
            signal.signal(number, signal.SIG_IGN)


def _run(name: str, create: Callable[[Future], RunnableNode], stop: Future) -> int:
    try:
        runnable = create(stop)
    except (GhcError, OSError) as error:
        return _complain(name, error, EXIT_REFUSED)
    # What is there now stays: the garbage collector need not walk through it under a tick.
    gc.collect()
    gc.freeze()
    executor = make_executor(runnable.executor)
    executor.add_node(runnable.node)
    try:
        while not stop.done():
            executor.spin_until_future_complete(stop, SPIN_SLICE)
    finally:  # also on a mistake of ours: what was recorded so far is worth keeping
        try:
            runnable.close()
        except (GhcError, OSError) as error:
            stop.set_exception(error)
    failure = stop.exception()
    executor.remove_node(runnable.node)
    executor.shutdown()
    runnable.node.destroy_node()
    return 0 if failure is None else _complain(name, failure, EXIT_FAILED)


def _complain(name: str, error: Exception, code: int) -> int:
    print(f"{name}: {' '.join(str(error).split())}", file=sys.stderr, flush=True)
    return code
