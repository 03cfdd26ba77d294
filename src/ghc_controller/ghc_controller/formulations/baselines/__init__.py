"""Laws that prioritised control is compared with, each close to the equations of its paper."""
