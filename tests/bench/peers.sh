#!/bin/sh
# make bench-peers: other programs beside this one, from the index of Python packages that pip is set to, in an environment
# of their own below BUILD; tests/bench/peers.txt pins their versions, tests/bench/peers.py measures.
BUILD=${BUILD:-build}
OPENBLAS_NUM_THREADS=1
export OPENBLAS_NUM_THREADS
peers=$BUILD/peers
absent() { echo "bench-peers: $1" >&2; exit 3; }
command -v python3 > /dev/null || absent 'python3 is not installed (Debian: apt-get install python3 python3-venv)'
python3 -c 'import venv, ensurepip' 2> /dev/null ||
   absent 'the venv module of python3 is absent (Debian: apt-get install python3-venv)'
if ! cmp -s tests/bench/peers.txt "$peers/installed.txt"; then
   python3 -m venv --clear "$peers" || absent "no environment in $peers"
   "$peers/bin/python" -m pip install --quiet --disable-pip-version-check -r tests/bench/peers.txt ||
      absent 'pip got no packages: is there a package index, and has it these versions for this python3?'
   cp tests/bench/peers.txt "$peers/installed.txt"
fi
exec "$peers/bin/python" -B tests/bench/peers.py "$BUILD" "$@"
