#!/usr/bin/env bash
# Unpacks a Debian package into an empty folder and uses the program that is in it.
# usage: try_package.sh PACKAGE.deb FOLDER
set -euo pipefail
package=$1 root=$2
dpkg-deb --extract "$package" "$root"
program=$root/usr/bin/twincell
for file in share/man/man1/twincell-track.1 share/bash-completion/completions/twincell share/zsh/vendor-completions/_twincell \
  share/fish/vendor_completions.d/twincell.fish share/doc/twincell/first_hour.md share/doc/twincell/copyright \
  include/twincell/trajectory/trajectory.hpp; do
  [ -f "$root/usr/$file" ] || { echo "$package lacks usr/$file" >&2; exit 1; }
done
depends=$(dpkg-deb --field "$package" Depends)
for library in libopencv-core libhdf5 libtiff gnuplot-nox; do
  [[ "$depends" == *$library* ]] || { echo "$package does not depend on $library: $depends" >&2; exit 1; }
done
"$program" --version
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
printf 'preset = "fortini-huang-2015"\n[cell]\nwidth = 6\n[beads]\ncount = 30\n[drive]\ngamma = 1.5\n[time]\ndiscard = 0\ncycles = 1\n' >"$scratch/scene.toml"
"$program" simulate "$scratch/scene.toml" -o "$scratch/run.h5" -q >/dev/null
"$program" analyze "$scratch/run.h5" --only q6 -q >/dev/null
"$program" export "$scratch/run.h5" --to xyz -o "$scratch/run.xyz" -q >/dev/null
PATH=$(realpath "$root")/usr/bin:$PATH "$(dirname "${BASH_SOURCE[0]}")/first_page.sh" "$root/usr/share/doc/twincell/first_hour.md" "$scratch/first"
source "$root/usr/share/bash-completion/completions/twincell"
COMP_WORDS=(twincell tr) COMP_CWORD=1
_twincell
[ "${COMPREPLY[*]}" = track ] || { echo "the completion of 'tr' is '${COMPREPLY[*]}'" >&2; exit 1; }
echo "$package: $(dpkg-deb --field "$package" Installed-Size) KiB; $depends"
