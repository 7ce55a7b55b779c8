#!/bin/sh
# Measures accuracy and time of Kluft and OpenGeoSys on a penny-shaped crack and writes docs/performance/penny-peers.md and
# docs/performance/penny-peers.svg; see benches/README.md. Kluft's release build must stand in target/release.
#
#     sh benches/peers/penny.sh [--resume] [--report]
set -eu
here=$(cd "$(dirname "$0")" && pwd)
sh "$here/setup"
exec "$here/../../target/peers/venv/bin/python" "$here/penny.py" "$@"
