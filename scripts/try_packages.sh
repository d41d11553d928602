#!/usr/bin/env bash
# try_packages.sh FILE.deb...: installs Debian packages in a bare Debian 12 with nothing but their dependencies, and runs talus there.
# Needs root and mmdebstrap; uses the mirror of this machine.
set -euo pipefail
root=$(mktemp -d /var/tmp/talus-root-XXXXXX)
trap 'rm -rf --one-file-system "$root"' EXIT
mirror=$(sed -nE 's/^(URIs:|deb( \[[^]]*\])?) *(http[^ ]*).*/\3/p' /etc/apt/sources.list /etc/apt/sources.list.d/* 2>/dev/null | head -1 || true)
mmdebstrap --mode=root --variant=minbase --quiet bookworm "$root" "${mirror:-http://deb.debian.org/debian}"
cp "$@" "$root/tmp/"
cp /etc/resolv.conf "$root/etc/" 2>/dev/null || true
in_root() { chroot "$root" /usr/bin/env -i PATH=/usr/bin:/bin:/usr/sbin:/sbin HOME=/root DEBIAN_FRONTEND=noninteractive "$@"; }
in_root apt-get update -qq
in_root sh -c 'apt-get install -y -qq --no-install-recommends /tmp/*.deb >/tmp/install.log 2>&1 || { cat /tmp/install.log; exit 1; }'
in_root talus --version
in_root talus element /usr/share/doc/talus/cases/element/undrained_simple_shear.toml --out /tmp/shear.csv
in_root sh -c 'wc -l /tmp/shear.csv; du -sh --apparent-size / 2>/dev/null | tail -1; test -f /usr/lib/libtalus_umat.so'
in_root sh -c 'talus run /usr/share/doc/talus/cases/slump_2d.toml --until "1 ms" --out /tmp/slump >/tmp/run.log 2>&1 || { cat /tmp/run.log; exit 1; }'
in_root test -f /usr/include/talus/law.h
if in_root test -d /usr/lib/python3/dist-packages/talus; then
  in_root python3 - <<'EOF'
import talus
sand = talus.Law("mohr_coulomb", E="20 MPa", nu=0.3, c="5 kPa", phi="30 deg", psi="5 deg")
state = sand.initial_state(pressure="100 kPa")
sand.update(state, [0, -1e-3, 0, 0, 0, 0], dt=1)
path = talus.element(sand, test="triaxial", drainage="drained", pressure="100 kPa", axial_strain="5 %")
run = talus.open("/tmp/slump")
print(talus.version(), path["q"].max(), run.outcome, len(run.snapshots))
EOF
fi
echo "the packages install and run in a bare Debian 12"
