# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by tools/package and tools/first-uses after common.sh. Makes a root of Debian 12 with nothing but apt, in
# which commands run as on a newly installed machine.
base="$root/build/root/base.tar"

# Exits with 2 where this machine cannot make such a root.
need_fresh_roots() {
  . /etc/os-release
  if [ "${VERSION_CODENAME:-}" != bookworm ]; then
    echo "$(basename "$0"): expected Debian 12 (bookworm), met ${PRETTY_NAME:-another system}" >&2
    exit 2
  fi
  if [ "$(id -u)" -ne 0 ]; then
    echo "$(basename "$0"): a fresh root takes root rights. Run: sudo tools/$(basename "$0")" >&2
    exit 2
  fi
}

# need_packages FOLDER: exits with 2 if the folder lacks a package that debian/control names.
need_packages() {
  local missing="" package
  for package in $(awk '/^Package:/ {print $2}' "$root/debian/control"); do
    compgen -G "$1/${package}_*.deb" >/dev/null || missing+=" $package"
  done
  if [ -n "$missing" ]; then
    echo "$(basename "$0"): expected packages in ${1#"$root/"}, missing:$missing" >&2
    echo "  make them: tools/package --build-only" >&2
    exit 2
  fi
}

# The bare system, made once: the packages of Debian itself among the sources of this machine's apt, with its proxies.
make_base() {
  [ -e "$base" ] && return
  mkdir -p "$(dirname "$base")"
  local options=() sources
  while IFS= read -r line; do options+=("--aptopt=$line"); done < <(apt-config dump |
    grep -E '^Acquire::(Check-|https?::)' || true)
  sources=$(apt-get indextargets --format 'deb $(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' \
    'Origin: Debian')
  if [ -z "$sources" ]; then
    echo "$(basename "$0"): expected sources of Debian in apt, met none; 'apt-get update' fetches their lists" >&2
    exit 2
  fi
  quietly "$root/build/root/base.log" mmdebstrap --variant=apt --mode=root --include=ca-certificates "${options[@]}" \
    bookworm "$base.partial.tar" - <<<"$sources"
  mv "$base.partial.tar" "$base"
}

# fresh_root PACKAGES: unpacks the bare system into a temporary folder, named in $fresh, which goes when the tool ends
# or makes the next one. Its apt finds the packages of the folder PACKAGES beside those of Debian. TMPDIR chooses the
# disk.
fresh=""
remove_root() {
  [ -z "$fresh" ] || rm -rf --one-file-system "$fresh"
  fresh=""
}
trap remove_root EXIT
fresh_root() {
  local packages=$1 folder
  make_base
  remove_root
  fresh=$(mktemp --directory "${TMPDIR:-/var/tmp}/nscdd-root.XXXXXX")
  folder=$fresh
  chmod 755 "$folder"
  tar --extract --numeric-owner --file "$base" --directory "$folder"
  cp /etc/resolv.conf "$folder/etc/resolv.conf"
  mkdir "$folder/packages"
  cp "$packages"/*.deb "$folder/packages/"
  (cd "$folder/packages" && dpkg-scanpackages --multiversion . >Packages 2>/dev/null)
  echo 'deb [trusted=yes] file:/packages ./' >"$folder/etc/apt/sources.list.d/nscdd.list"
}

# in_root FOLDER COMMAND...: runs a command in there as root with an environment of its own. Its mounts and what it
# starts end with it. What this machine says of its processor to OpenBLAS holds in there, too.
in_root() {
  local folder=$1
  shift
  local settings=(PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive)
  while IFS= read -r line; do settings+=("$line"); done < <(env | grep '^OPENBLAS_' || true)
  local mounts='mount -t proc proc "$0/proc" && mount -t sysfs -o ro sysfs "$0/sys"
    mkdir -p "$0/dev/shm" && mount -t tmpfs tmpfs "$0/dev/shm"'
  unshare --mount --pid --fork --kill-child /bin/sh -c "set -e; $mounts; exec \"\$@\"" "$folder" \
    env -i "${settings[@]}" chroot "$folder" "$@"
}
