"""A recorded run as columns: the largest torque rate of each joint, from joint_commands.

python examples/read_recording.py <folder of a recording> [topic]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory


def columns(folder: Path, topic: str) -> dict[str, np.ndarray]:
    """Time [s] and effort [Nm] by joint; `pandas.DataFrame(...)` of it is a data frame."""
    names: list[str] = []
    rows = []
    for file in sorted(folder.glob("*.mcap")):
        with file.open("rb") as stream:
            reader = make_reader(stream, decoder_factories=[DecoderFactory()])
            for _, _, _, message in reader.iter_decoded_messages(topics=[topic]):
                stamp, names = message.header.stamp, list(message.name)
                rows.append([stamp.sec + 1e-9 * stamp.nanosec, *message.effort])
    values = np.array(rows).reshape(len(rows), -1).T
    return dict(zip(["time", *names], values, strict=False))


def main() -> None:
    """Print what was recorded, and the largest torque rates."""
    if len(sys.argv) < 2:
        sys.exit("give the folder of a recording, such as results/priority_switching/recording")
    topic = sys.argv[2] if len(sys.argv) > 2 else "/joint_commands"
    table = columns(Path(sys.argv[1]), topic)
    if not table:
        sys.exit(f"no message of {topic} in {sys.argv[1]}")
    time = table.pop("time")
    print(f"{topic}: {len(time)} messages from {time[0]:.3f} s to {time[-1]:.3f} s")
    period = float(np.diff(time).min())  # [s] of the recording, which may leave messages out
    in_a_row = np.diff(time) < 1.5 * period
    for joint, effort in table.items():
        rates = np.abs(np.diff(effort))[in_a_row] / period
        print(f"{joint}: {rates.max(initial=0.0):6.1f} Nm/s at {1e3 * period:.3g} ms")


if __name__ == "__main__":
    main()
