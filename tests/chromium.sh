#!/bin/sh
# Have the browser that the live page is tested in; install it from Debian where we may.
present() { command -v "${USMBENCH_CHROMIUM:-chromium}" >/dev/null 2>&1; }

present && exit 0
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    { apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends chromium; } >&2
fi
present && exit 0
echo "the live page is tested in chromium: on Debian, apt-get install chromium" >&2
exit 1
