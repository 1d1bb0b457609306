#!/bin/sh
# Have gputils, gpsim and what the bridge is compiled with; install them from Debian where we may.
packages="gputils gpsim gpsim-dev libglib2.0-dev g++ pkg-config"
present() {
    command -v gpasm && command -v gplink && command -v gpsim && command -v g++ &&
        pkg-config --exists glib-2.0 && test -f /usr/include/gpsim/sim_context.h
} >/dev/null 2>&1

present && exit 0
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    { apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install -y $packages; } >&2
fi
present && exit 0
echo "the firmware needs gputils and gpsim: on Debian, apt-get install $packages" >&2
exit 1
