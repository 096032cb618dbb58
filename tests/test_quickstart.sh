#!/usr/bin/env bash
# Runs samples/quickstart into a new folder: it must say where the picture and the volume are, and
# they must be there.
#
#   tests/test_quickstart.sh ROOT
set -euo pipefail

root=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# From elsewhere, with no input: neither may matter.
cd /
"$root/samples/quickstart" "$folder/out" < /dev/null > "$folder/stdout"
cat "$folder/stdout"

for line in "picture: $folder/out/section.png" "volume:  $folder/out/map.vdb"; do
  if ! tail -n 2 "$folder/stdout" | grep -qxF "$line"; then
    echo "quickstart does not end with the line '$line'" >&2
    exit 1
  fi
done
for file in map.ply map.vdb slices.exr section.png report.json; do
  if [[ ! -s $folder/out/$file ]]; then
    echo "quickstart wrote no $file" >&2
    exit 1
  fi
done

# The two geckos are clean closed meshes and a good map exists: a report that says otherwise is
# wrong, or the defaults are.
/usr/bin/python3 - "$folder/out/report.json" << 'PYTHON'
import json
import sys

report = json.load(open(sys.argv[1]))
assert report["source"]["vertices"] == 6256, report["source"]
assert report["source"]["boundary_loops"] == 0 and report["source"]["genus"] == 0, report["source"]
error = report["boundary_error"]
assert error["samples"] >= 20000, error
assert 0 < error["rms"] <= error["p99"] <= error["max"], error
# An order below the size of the toes, 0.03 of the diagonal thick.
assert error["rms"] < 3e-3, error
assert report["jacobian"]["folded_fraction"] < 0.01, report["jacobian"]
assert report["grid"]["interior_voxels"] > 10000, report["grid"]
PYTHON
