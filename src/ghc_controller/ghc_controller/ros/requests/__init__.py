"""Requests of the controller node: priority transitions and references, from bytes to replies."""

from ghc_controller.ros.requests.subscriber import RequestSubscriber
from ghc_controller.ros.requests.topics import REFERENCE, TRANSITION

__all__ = ["REFERENCE", "TRANSITION", "RequestSubscriber"]
