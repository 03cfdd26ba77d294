"""What requests by hand share: the life of the process, the lines that it prints."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from typing import Protocol

import rclpy
from builtin_interfaces.msg import Time
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from ghc_controller.errors import InvalidValue
from ghc_controller.ros.run import EXIT_FAILED, EXIT_REFUSED
from ghc_controller.ros.stop_signals import (
    interrupt_on_stop_signals,
    raise_if_stopped,
    stop_was_asked,
)
from ghc_controller.ros.this_host import stay_on_this_host
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_controller.types import NANOSECONDS

_INTERRUPTED = 130


class Request(Protocol):
    """A request by hand that is under way."""

    node: Node
    exit_code: int | None  # None while it is under way

    def send_when_heard(self) -> None:
        """Send it, once, when a controller will get it and can answer; called again and again."""

    def missing(self) -> str:
        """What did not happen yet, for the message when time is up."""


def follow(
    name: str, arguments: Sequence[str], create: Callable[[], Request], timeout: float
) -> int:
    """Send a request and follow it to its end; the exit code of the process.

    Args:
        arguments: of the process, its name first; ROS reads its own ones.
        create: makes the request; called with ROS up.
        timeout: [s] of wall time.
    """
    try:
        stay_on_this_host()
        # No handler of rclpy: it would take the context down under the loop.
        rclpy.init(args=list(arguments), signal_handler_options=SignalHandlerOptions.NO)
    except (InvalidValue, RuntimeError) as error:  # rclpy's root for malformed --ros-args
        return complain(name, str(error), EXIT_REFUSED)
    interrupt_on_stop_signals()
    try:
        return _follow(name, create(), timeout)
    except (KeyboardInterrupt, ExternalShutdownException):
        return complain(name, "interrupted", _INTERRUPTED)
    except RuntimeError:  # what an interrupt becomes while rclpy converts a message
        if not stop_was_asked():
            raise
        return complain(name, "interrupted", _INTERRUPTED)
    finally:
        rclpy.try_shutdown()


def _follow(name: str, request: Request, timeout: float) -> int:
    executor = SingleThreadedExecutor()
    executor.add_node(request.node)
    try:
        return _spin(name, executor, request, timeout)
    finally:  # before the context goes, which the executor's own end needs
        executor.shutdown()


def _spin(name: str, executor: SingleThreadedExecutor, request: Request, timeout: float) -> int:
    deadline = time.monotonic() + timeout
    while request.exit_code is None:
        executor.spin_once(timeout_sec=0.05)
        raise_if_stopped()
        request.send_when_heard()
        if time.monotonic() > deadline:
            return complain(name, f"{request.missing()} within {timeout:g} s", EXIT_FAILED)
    return request.exit_code


def add_timing(parser: argparse.ArgumentParser, what: str) -> None:
    """The options `--start` and `--timeout` of a request; `what` is its move or ramp."""
    parser.add_argument(
        "--start",
        type=stamp,
        default=0.0,
        metavar="SECONDS",
        help=f"time of the robot at which the {what} starts (default: at once)",
    )
    parser.add_argument(
        "--timeout",
        type=float,
        default=60.0,
        metavar="SECONDS",
        help=f"wall time until the end of the {what} (default: 60)",
    )


def stamp(text: str) -> float:
    """Time [s] of an argument; argparse reports what a time message cannot hold."""
    seconds = float(text)
    if not 0.0 <= seconds < 2**31:
        raise argparse.ArgumentTypeError(f"{text} given, 0 to {2**31 - 1} expected")
    return seconds


def line(stamp: Time, word: str, detail: str) -> str:
    """One line of the output; `stamp` is the robot's time."""
    return f"t = {nanoseconds_from_time(stamp) / NANOSECONDS:8.3f} s  {word:9}  {detail}"


def show(text: str) -> None:
    """Print one line at once."""
    print(text, flush=True)


def complain(name: str, text: str, code: int) -> int:
    """One line on standard error; the exit code."""
    print(f"{name}: {' '.join(text.split())}", file=sys.stderr, flush=True)
    return code
