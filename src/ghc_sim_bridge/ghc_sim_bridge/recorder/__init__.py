"""Recording of topics into a rosbag2 folder, and reading of one, including truncated ones."""
