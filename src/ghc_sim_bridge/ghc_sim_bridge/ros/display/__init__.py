"""The node that publishes what RViz and Foxglove draw (docs/display.md)."""
