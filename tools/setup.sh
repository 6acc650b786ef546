# Sourced by tools/demo and tools/test: installs the Debian packages that are missing, configures and builds.
# Repeatable: what is there already is not done again.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

say() { printf '== %s\n' "$*"; }

install_missing_packages() {
  local missing=() package
  while read -r package; do
    package=${package#optional:}
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
  done < <(grep -v '^#' tools/packages.txt)
  [ ${#missing[@]} -gt 0 ] || return 0
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "these Debian packages are missing, and neither root nor sudo is here: ${missing[*]}" >&2; exit 1; }
    as_root=(sudo)
  fi
  say "installing ${missing[*]}"
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

build() { # build PRESET [TARGET...]
  local preset=$1; shift
  local folder=build; [ "$preset" = release ] || folder=build-$preset
  [ -f "$folder/build.ninja" ] || { say "configuring ($preset)"; cmake --preset "$preset" >/dev/null; }
  say "building ($preset)"
  cmake --build --preset "$preset" ${1:+--target "$@"}
}

install_missing_packages
