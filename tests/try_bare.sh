#!/usr/bin/env bash
# Installs a Debian package on a bare Debian 12, which it makes in a folder, and runs the first page of the tutorial there.
# Needs root, debootstrap and the network.
# usage: try_bare.sh PACKAGE.deb FOLDER
set -euo pipefail
package=$1 root=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
[ "$(id -u)" = 0 ] || { echo "a bare system can be made by root only" >&2; exit 1; }
[ ! -e "$root" ] || { echo "$root exists; remove it first" >&2; exit 1; }
mkdir -p "$root"
# The folder is removed only when nothing is mounted in it: its /dev is that of the machine.
leave() {
  umount "$root/dev" "$root/proc" 2>/dev/null || true
  if grep -qs " $(realpath "$root")/" /proc/mounts; then echo "$root holds a mount and is left there" >&2; else rm -rf "$root"; fi
}
trap leave EXIT
debootstrap --variant=minbase bookworm "$root" >"$root.log" 2>&1 || { tail -3 "$root.log" >&2; exit 1; }
mount -t proc proc "$root/proc"
mount --bind /dev "$root/dev"
cp "$package" "$root/root/twincell.deb"
cp "$here/first_page.sh" "$root/root/"
chroot "$root" env DEBIAN_FRONTEND=noninteractive bash -c '
  set -e
  apt-get update -qq
  apt-get install -y -qq --no-install-recommends /root/twincell.deb
  ' >>"$root.log" 2>&1 || { tail -3 "$root.log" >&2; exit 1; }
chroot "$root" env HOME=/root LANG=C.UTF-8 bash -c '
  twincell --version
  bash /root/first_page.sh /usr/share/doc/twincell/first_hour.md /root/try'
