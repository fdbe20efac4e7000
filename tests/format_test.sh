#!/usr/bin/env bash
# Every C++ file is laid out as .clang-format says. Fails, not skips, without clang-format: format_test.sh SOURCE_DIR
set -euo pipefail
cd "$1"

tool=$(command -v clang-format-14 || command -v clang-format) || {
  echo "clang-format is missing"
  exit 1
}
list=$(find patches tess raytracer tests reference \( -name '*.h' -o -name '*.cpp' \) | sort)
mapfile -t files <<<"$list"
echo "$("$tool" --version): ${#files[@]} files"
if ((${#files[@]} < 10)); then
  echo "found fewer files than there can be"
  exit 1
fi
wrong=$("$tool" --dry-run --Werror "${files[@]}" 2>&1 | grep -E '^[^ ]+:[0-9]+:[0-9]+: ' || true)
if [[ -n $wrong ]]; then
  head -n 20 <<<"$wrong"
  echo "$(wc -l <<<"$wrong") places; mend with: $tool -i FILE"
  exit 1
fi
