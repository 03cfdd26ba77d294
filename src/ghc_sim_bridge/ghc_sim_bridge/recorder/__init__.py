"""Recording of topics into an MCAP file."""
