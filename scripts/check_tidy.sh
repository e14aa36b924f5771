#!/usr/bin/env bash
# clang-tidy with the checks of .clang-tidy; a finding is an error. About 15 s a file.
#   scripts/check_tidy.sh                what changed since the branch left main (BASE=REF: since it left REF), also what is not committed yet
#   scripts/check_tidy.sh controller     all sources of these folders or files
# A header that changed is looked at through the source of its own name, or else through the first that includes it. Needs a
# configured build (BUILD, default build/) for the compile commands.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build="${BUILD:-build}"
tidy="$(command -v clang-tidy-14 || command -v clang-tidy)" || { echo "clang-tidy is missing: apt-get install clang-tidy-14" >&2; exit 2; }
[ -f "$build/compile_commands.json" ] || { echo "no $build/compile_commands.json: run scripts/test.sh first" >&2; exit 2; }

if [ $# -gt 0 ]; then
  mapfile -t named < <(git ls-files "$@")
else
  base="${BASE:-$(git rev-parse --verify --quiet origin/main >/dev/null && echo origin/main || echo main)}"
  from="$(git merge-base "$base" HEAD)" || { echo "no commit in common with $base: say BASE=REF" >&2; exit 2; }
  mapfile -t named < <({ git diff --name-only --diff-filter=d "$from"; git ls-files --others --exclude-standard; } | sort -u)
fi

# Sources of packages that are not there have no compile command.
compiled() { grep -q "$PWD/$1\"" "$build/compile_commands.json"; }
files=()
for file in "${named[@]}"; do
  case "$file" in
    *.cc) source="$file" ;;
    *.h)
      source="${file%.h}.cc"
      [ -f "$source" ] && compiled "$source" || source="$(git grep -l -F "#include \"$file\"" -- '*.cc' | head -n 1 || true)"
      ;;
    *) continue ;;
  esac
  if [ -n "$source" ] && compiled "$source"; then files+=("$source"); else echo "not looked at, as nothing compiles it: $file" >&2; fi
done
[ "${#files[@]}" -gt 0 ] || { echo "no C++ changed"; exit 0; }
printf '%s\n' "${files[@]}" | sort -u | tr '\n' '\0' | xargs -0 -n 1 -P "$(nproc)" "$tidy" -p "$build" --quiet
