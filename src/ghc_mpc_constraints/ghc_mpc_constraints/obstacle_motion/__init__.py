"""Generator of obstacle motion: measurements and the motion planned from them."""
