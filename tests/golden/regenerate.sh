#!/usr/bin/env bash
# Makes the golden files anew, from wherever it is called; those within tolerance stay as they are:
#
#     bash tests/golden/regenerate.sh && git diff --stat tests/golden
set -euo pipefail
cd "$(dirname "$0")/../.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

while read -r -a words; do
    case "${words[0]:-#}" in '#'*) continue ;; esac
    cargo run --quiet -- solve "${words[@]:1}" -o "$out/${words[0]}" --quiet < /dev/null
done < tests/golden/cases.txt
cargo run --quiet -- compare tests/golden "$out" --bless
