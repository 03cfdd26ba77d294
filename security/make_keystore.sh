#!/bin/bash
# Makes a keystore with one enclave per policy: `security/make_keystore.sh FOLDER`.
# Needs a ROS 2 Jazzy installation with sros2 (`sudo apt install ros-jazzy-sros2`), sourced.
set -euo pipefail
store="${1:?usage: make_keystore.sh FOLDER}"
policies="$(cd "$(dirname "${BASH_SOURCE[0]}")/policies" && pwd)"
command -v ros2 > /dev/null || {
  echo "make_keystore: no ros2 here: source a ROS 2 installation; wheels have no ros2cli" >&2
  exit 2
}
umask 077 # private keys
[ -d "$store" ] || ros2 security create_keystore "$store"
for policy in "$policies"/*.xml; do
  enclave="/ghc/$(basename "$policy" .xml)"
  ros2 security create_enclave "$store" "$enclave"
  ros2 security create_permission "$store" "$enclave" "$policy"
done
cat << END
Start each node with
  export GHC_NETWORK=network ROS_SECURITY_ENABLE=true ROS_SECURITY_STRATEGY=Enforce
  export ROS_SECURITY_KEYSTORE=$(cd "$store" && pwd)
  ros2 run ghc_controller controller --ros-args --enclave /ghc/controller ...
END
