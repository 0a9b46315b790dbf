# What the scripts share. Source it; it moves to the project's folder.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# Compiler and libraries of the program, as Debian 12 names them.
BUILD_PACKAGES=(
  cmake ninja-build clang libopencv-dev libavformat-dev libswscale-dev libapriltag-dev libeigen3-dev
  libceres-dev libcli11-dev libcereal-dev libyaml-cpp-dev nlohmann-json3-dev libfmt-dev libtbb-dev libboost-dev libcairo2-dev
  liblz4-dev libzstd-dev libopenigtlink-dev cyclonedds-dev cyclonedds-tools libwebsocketpp-dev
  pkg-config
)
# The documentation site (scripts/site).
SITE_PACKAGES=(mkdocs mkdocs-material python3)
# The Python module with its tests and notebooks.
PYTHON_PACKAGES=(
  pybind11-dev python3-dev python3-numpy python3-pytest python3-nbconvert python3-ipykernel
  python3-matplotlib python3-mypy
)
# More for tests, benchmarks, the thesis's figures and checks; librosbag-storage-dev reads bags of
# ROS 1, openigtlink-examples are peers at the virtual robot, Open MPI spreads batches, parallel is
# their peer in bench/, opencv-doc holds real chessboard pictures, poppler-utils turns printed pages into pictures.
TEST_PACKAGES=(
  libgtest-dev libgmock-dev libbenchmark-dev libgeos-dev librosbag-storage-dev
  openigtlink-examples
  libopenmpi-dev openmpi-bin parallel g++ libclang-rt-14-dev llvm clang-format clang-tidy groff-base opencv-doc poppler-utils chromium
  "${SITE_PACKAGES[@]}" "${PYTHON_PACKAGES[@]}"
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

# build PRESET [TARGET...]: configures once, then builds what has changed of the targets, or of all,
# and says how far it is. The rest is estimated from the steps done: they are much alike.
build() {
  local preset=$1 folder=build/$1 targets=()
  shift
  if [ "$preset" = program ]; then folder=build/release; fi
  if [ $# -gt 0 ]; then targets=(--target "$@"); fi
  if [ ! -f "$folder/build.ninja" ]; then
    say "configuring $folder"
    mkdir -p build
    cmake --preset "$preset" >"$folder.log" 2>&1 || { cat "$folder.log"; die "cmake found no way"; }
  fi
  say "building $folder"
  NINJA_STATUS='@%f %t %e ' cmake --build "$folder" --parallel "$(nproc)" "${targets[@]}" |
    progress
}

# progress: turns ninja's lines "@done all seconds what" into a few, and passes on all others
# (warnings, errors).
progress() {
  local line finished all s next_s=0 left
  while IFS= read -r line; do
    if ! [[ $line =~ ^@([0-9]+)\ ([0-9]+)\ ([0-9]+) ]]; then
      printf '%s\n' "$line"
      continue
    fi
    finished=${BASH_REMATCH[1]} all=${BASH_REMATCH[2]} s=${BASH_REMATCH[3]} left=
    if [ "$s" -lt "$next_s" ] && [ "$finished" -lt "$all" ]; then continue; fi
    next_s=$((s + 15))
    if [ "$finished" -ge 5 ] && [ "$finished" -lt "$all" ]; then
      left=", about $((s * (all - finished) / finished / 60 + 1)) min left"
    fi
    printf '    %d of %d steps, %d min %02d s%s\n' "$finished" "$all" $((s / 60)) $((s % 60)) "$left"
  done
}
