# Shared by scripts/demo and scripts/test: installs what is missing, configures, builds. Source it from the project's
# top folder.

say() { printf '\n== %s\n' "$*"; }
die() { printf 'error: %s\n' "$*" >&2; exit 1; }

# missing_packages [LIST ...]: the packages of scripts/packages.txt, and of further lists, that are not installed.
missing_packages() {
  grep -hvE '^(#|$)' scripts/packages.txt "$@" | while read -r package; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || printf '%s ' "$package"
  done
}

install_packages() {  # [LIST ...]
  command -v apt-get >/dev/null || die "apt-get not found: these scripts are for Debian 12; elsewhere install what scripts/packages.txt lists and use the CMake presets"
  local missing
  missing=$(missing_packages "$@")
  if [ -z "$missing" ]; then
    echo "All Debian packages are installed."
    return
  fi
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || die "needs root or sudo to install: $missing"
    as_root=(sudo)
  fi
  say "Installing Debian packages: $missing"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -q
  # shellcheck disable=SC2086
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $missing
}

# Where scripts/test-packages keeps its trees, if all of them are there and this user may use them.
package_trees() {
  local trees=${PIVNP_TREES:-$HOME/.cache/pivnp-trees}
  [ "$(id -u)" -eq 0 ] && [ -f "$trees/bookworm/.made" ] && [ -f "$trees/trixie/.made" ] && ls -d "$trees"/needs-* >/dev/null 2>&1 && echo "$trees"
  return 0
}

# build_preset release|dev [target ...]
# From scratch, sources are compiled several at a time (half the work); a build folder that is there stays as it is.
build_preset() {
  local preset=$1 together=()
  shift
  [ -f "build/$preset/CMakeCache.txt" ] || together=(-DPIVNP_UNITY=ON)
  say "Building the $preset preset (build/$preset)"
  cmake --preset "$preset" -DPIVNP_SPLIT_TESTS="${PIVNP_SPLIT_TESTS:-OFF}" "${together[@]}" >"build-$preset.log" 2>&1 || { cat "build-$preset.log" >&2; die "configuration of the $preset preset failed"; }
  rm -f "build-$preset.log"
  if [ "$#" -gt 0 ]; then cmake --build "build/$preset" --target "$@"; else cmake --build "build/$preset"; fi
}
