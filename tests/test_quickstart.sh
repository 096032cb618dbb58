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

"$root/tests/check_quickstart.py" "$folder/out" "$root/samples/gecko.obj" \
  "$root/samples/gecko_step.obj"
