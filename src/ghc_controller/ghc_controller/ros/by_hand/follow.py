"""Shared by the request commands: life cycle of the process and its output."""

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
    """A pending request from the command line."""

    node: Node
    exit_code: int | None  # None while it is pending

    def send_when_heard(self) -> None:
        """Send it once a controller can receive it and reply; called repeatedly."""

    def missing(self) -> str:
        """What has not happened yet, for the timeout message."""


def follow(
    name: str, arguments: Sequence[str], create: Callable[[], Request], timeout: float
) -> int:
    """Send a request and follow it to its end; the exit code of the process.

    Args:
        arguments: of the process, its name first; ROS arguments are removed.
        create: makes the request; called after rclpy.init.
        timeout: [s] of wall time.
    """
    try:
        stay_on_this_host()
        # No signal handler of rclpy: it would shut down the context during the loop.
        rclpy.init(args=list(arguments), signal_handler_options=SignalHandlerOptions.NO)
    except (InvalidValue, RuntimeError) as error:  # rclpy's root for malformed --ros-args
        return complain(name, str(error), EXIT_REFUSED)
    interrupt_on_stop_signals()
    try:
        return _follow(name, create(), timeout)
    except (KeyboardInterrupt, ExternalShutdownException):
        return complain(name, "interrupted", _INTERRUPTED)
    except RuntimeError:  # raised for an interrupt while rclpy converts a message
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
    finally:  # before the context, which the executor needs to shut down
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


def where_controllers_are(node: Node, topic: str) -> str:
    """In a namespace without a controller: which ones have its `topic`; else ""."""
    ours = node.get_namespace()
    ends = f"/{topic}"
    names = [name for name, _ in node.get_topic_names_and_types() if name.endswith(ends)]
    known = [
        name.removesuffix(ends) or "/" for name in names if node.get_publishers_info_by_topic(name)
    ]
    if ours in known or not known:
        return ""
    return f" in '{ours}'; known: {', '.join(known)}, chosen by --ros-args -r __ns:=NAMESPACE;"


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
