#!/usr/bin/env bash
# Makes the picture of every scene, or of those named: scenes/make_pictures.sh [NAME...]
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")"
exr=$(mktemp --suffix .exr)
trap 'rm -f "$exr"' EXIT
(($# > 0)) || set -- *.json
for scene in "$@"; do
  name=$(basename "$scene" .json)
  [[ $name == scene.schema ]] && continue
  ../isophote render "$name.json" -o "$exr" --aov none
  ../isophote display "$exr" -o "$name.jpg"
done
