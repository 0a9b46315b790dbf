# What the scripts share. Source it; it moves to the project's folder.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# Compiler, libraries and tools as Debian 12 names them.
BUILD_PACKAGES=(
  cmake ninja-build g++ libopencv-dev libapriltag-dev libeigen3-dev libceres-dev libcli11-dev
  libyaml-cpp-dev nlohmann-json3-dev libfmt-dev libtbb-dev libboost-dev
)
# What the tests and checks need beside these; opencv-doc holds real chessboard pictures.
# Tests, bench and flextip-reproduce: libgtest-dev, libgmock-dev, libbenchmark-dev, libgeos-dev.
TEST_PACKAGES=(
  clang clang-format clang-tidy opencv-doc libgtest-dev libgmock-dev libbenchmark-dev libgeos-dev
)
NODE_PACKAGES=(nodejs npm)

say() { printf '\033[1m==> %s\033[0m\n' "$*"; }
die() { printf 'flextip: %s\n' "$*" >&2; exit 1; }

# missing_packages NAME...: those that dpkg does not know as installed, one a line.
missing_packages() {
  local name
  for name in "$@"; do
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null)" = installed ] || echo "$name"
  done
}

# apt_install NAME...: installs what is missing; asks apt for nothing where nothing is.
apt_install() {
  command -v dpkg-query >/dev/null || die "this is no Debian: install by hand what scripts/lib.sh lists"
  local missing as_root=()
  read -r -d '' -a missing <<<"$(missing_packages "$@")" || true
  [ ${#missing[@]} -gt 0 ] || return 0
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || die "these packages are missing, and there is neither root nor sudo: ${missing[*]}"
    as_root=(sudo)
  fi
  say "installing ${missing[*]}"
  "${as_root[@]}" apt-get update || die "apt-get update failed: is there a network?"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}" \
    || die "apt-get could not install ${missing[*]}"
}

# install_node_modules: what package-lock.json names, unless it is there already.
install_node_modules() {
  local stamp=node_modules/.installed-lock
  cmp -s package-lock.json "$stamp" && return 0
  command -v npm >/dev/null || apt_install "${NODE_PACKAGES[@]}"
  say "npm ci"
  npm ci --ignore-scripts --no-audit --no-fund || die "npm ci failed: is there a network?"
  cp package-lock.json "$stamp"
}

# build PRESET [TARGET...]: configures once, then builds what has changed of the targets, or of all.
build() {
  local preset=$1 launcher=() targets=()
  shift
  if [ $# -gt 0 ]; then targets=(--target "$@"); fi
  if command -v ccache >/dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
  if [ ! -f "build/$preset/build.ninja" ]; then
    say "configuring $preset"
    cmake --preset "$preset" "${launcher[@]}"
  fi
  say "building $preset"
  cmake --build --preset "$preset" --parallel "$(nproc)" "${targets[@]}"
}
