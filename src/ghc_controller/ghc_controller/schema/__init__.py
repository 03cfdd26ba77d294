"""How YAML becomes values: a strict reader whose messages name the place."""
