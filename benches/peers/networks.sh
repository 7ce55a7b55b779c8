#!/bin/sh
# Measures whole runs on networks of fractures, up to five million unknowns, and writes docs/performance/networks.md; see
# benches/README.md.
#
#     sh benches/peers/networks.sh [--up-to THOUSANDS]
set -eu
here=$(cd "$(dirname "$0")" && pwd)
sh "$here/setup"
exec "$here/../../target/peers/venv/bin/python" "$here/networks.py" "$@"
