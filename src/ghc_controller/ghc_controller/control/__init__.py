"""Requests to a controller, and its status; the loop is in controller.py."""
