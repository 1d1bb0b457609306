#!/bin/sh
# Have gputils, gpsim and what the bridge is compiled with; install them from Debian where we may.
packages="gputils gpsim gpsim-dev libglib2.0-dev g++ pkg-config"
present() {
    command -v gpasm && command -v gplink && command -v gpsim && command -v g++ &&
        pkg-config --exists glib-2.0 && test -f /usr/include/gpsim/sim_context.h
} >/dev/null 2>&1

present && exit 0
root=
[ "$(id -u)" = 0 ] || root="sudo -n"
if command -v apt-get >/dev/null && $root true 2>/dev/null; then
    echo "installing $packages" >&2
    $root apt-get -qq update >&2 &&
        $root env DEBIAN_FRONTEND=noninteractive \
            timeout 600 apt-get -qq install -y --no-install-recommends $packages >/dev/null
fi
present && exit 0
echo "the firmware needs gputils and gpsim; on Debian: apt-get install $packages" >&2
exit 1
