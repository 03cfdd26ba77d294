# ROS 2 Jazzy from the wheels of a virtual environment, as a prefix of the ament index. The set-up
# copies this file into .venv as local_setup.sh; install/setup.bash then sources it first, as it
# sources /opt/ros/jazzy where that was there at build time.

_ghc_prefix="${COLCON_CURRENT_PREFIX:-$VIRTUAL_ENV}"

# Libraries of the wheels of another environment, from a Python that is a parent of this shell.
_ghc_rest="${LD_LIBRARY_PATH:-}:"
_ghc_kept=""
while [ -n "$_ghc_rest" ]; do
  _ghc_entry="${_ghc_rest%%:*}"
  _ghc_rest="${_ghc_rest#*:}"
  case "$_ghc_entry" in
    "" | */site-packages/ros_*.libs) ;;
    *) [ -e "$_ghc_entry/../pyvenv.cfg" ] || _ghc_kept="$_ghc_kept:$_ghc_entry" ;;
  esac
done

# With the guard set, a Python of the wheels does not start itself a second time to find these.
_ghc_own="$_ghc_prefix/lib"
for _ghc_entry in "$_ghc_prefix"/lib/python3.*/site-packages/ros_*.libs; do
  _ghc_own="$_ghc_own:$_ghc_entry"
done
export LD_LIBRARY_PATH="$_ghc_own$_ghc_kept"
export _ROS_WHEELS_BOOTSTRAP_COMPLETE=1

case ":${AMENT_PREFIX_PATH:-}:" in
  *":$_ghc_prefix:"*) ;;
  *) export AMENT_PREFIX_PATH="$_ghc_prefix${AMENT_PREFIX_PATH:+:$AMENT_PREFIX_PATH}" ;;
esac

unset _ghc_prefix _ghc_rest _ghc_kept _ghc_own _ghc_entry
