"""Several users and several experiments on one host do not get in each other's way."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import pytest

from ghc_controller.errors import GhcError
from ghc_sim_bridge.run.domain import DomainLock
from ghc_sim_bridge.run.folder_lock import folder_lock
from ghc_sim_bridge.scenario.home import mark_home, results_home
from ghc_sim_bridge.scenario.scenario import load_scenario

HOLD = """
import sys, time
from pathlib import Path
from ghc_sim_bridge.run.folder_lock import folder_lock
with folder_lock(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""


@pytest.fixture
def own_tmp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A temporary folder in which no lock was ever taken."""
    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path / "ghc_ros_domains"


def test_other_users_can_lock_domains_too(own_tmp: Path) -> None:
    """With a strict umask: the folder is open to all, and so is the file of the first lock."""
    before = os.umask(0o077)
    try:
        first, second = DomainLock(), DomainLock()
    finally:
        os.umask(before)
    assert (first.id, second.id) == (1, 2)
    assert stat.S_IMODE(own_tmp.stat().st_mode) == 0o1777
    assert stat.S_IMODE((own_tmp / "1.lock").stat().st_mode) == 0o666
    first.release()
    second.release()


@pytest.mark.skipif(os.geteuid() != 0, reason="needs the right to become another user")
def test_a_second_user_finds_a_free_domain(monkeypatch: pytest.MonkeyPatch) -> None:
    """Locks of root and of user 65534, held at the same time, are of different domains."""
    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    with tempfile.TemporaryDirectory(dir="/tmp") as folder:
        Path(folder).chmod(0o1777)
        monkeypatch.setattr(tempfile, "tempdir", folder)
        lock = DomainLock()
        reader, writer = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                os.setuid(65534)
                os.write(writer, str(DomainLock().id).encode())
            finally:
                os._exit(0)
        os.waitpid(child, 0)
        os.close(writer)
        assert (lock.id, os.read(reader, 10)) == (1, b"2")
        lock.release()


def test_a_folder_of_results_is_written_by_one_experiment_at_a_time(tmp_path: Path) -> None:
    """Rejected while another process holds it, free again when that is killed."""
    folder = tmp_path / "results" / "lemniscate" / "cascade"
    other = subprocess.Popen([sys.executable, "-c", HOLD, folder], stdout=subprocess.PIPE)
    assert other.stdout is not None
    assert other.stdout.readline() == b"held\n"
    with pytest.raises(GhcError, match="written by another experiment"), folder_lock(folder):
        pass
    other.kill()
    other.wait()
    with folder_lock(folder):
        pass


def test_scenario_files_of_one_name_do_not_share_a_folder(tmp_path: Path) -> None:
    original = load_scenario("lemniscate")
    assert results_home(original, tmp_path) == tmp_path / "lemniscate"
    homes = []
    for place in ("a", "b"):
        mine = replace(original, name="mine", file=tmp_path / place / "mine.yaml")
        homes.append(results_home(mine, tmp_path))
        mark_home(mine, homes[-1])
        assert results_home(mine, tmp_path) == homes[-1]  # the next run finds the same one
        same = replace(original, file=tmp_path / place / "lemniscate.yaml")
        homes.append(results_home(same, tmp_path))
    assert homes[0] == tmp_path / "mine"
    assert len({*homes, tmp_path / "lemniscate"}) == 5
