"""Recording of topics into a rosbag2 folder, and reading of one, also of one that was cut."""
