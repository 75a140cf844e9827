#!/usr/bin/env bash
# Install the programs that read our files in the tests: node with rabbit-ear, fold and icon sets, rsvg-convert, inkscape,
# Xvfb, hp2xx, qpdf, mutool, admesh, librecad, freecad, chromium, and what Inkscape's DXF importer needs.
# What is there already is left alone. What cannot be installed is no error: the tests that need it skip and say so.
set -uo pipefail
cd "$(dirname "$0")"

have() { command -v "$1" >/dev/null 2>&1; }

packages=()
if ! have node || ! have npm; then packages+=(nodejs npm); fi
have rsvg-convert || packages+=(librsvg2-bin)
have inkscape || packages+=(inkscape)
have Xvfb || packages+=(xvfb)  # Inkscape runs extensions only where there is a screen
have hp2xx || packages+=(hp2xx)
have admesh || packages+=(admesh)
have qpdf || packages+=(qpdf)
have mutool || packages+=(mupdf-tools)
have librecad || packages+=(librecad)
have freecadcmd || packages+=(freecad)
have chromium || packages+=(chromium)
/usr/bin/python3 -c "import cssselect, lxml, numpy" 2>/dev/null || packages+=(python3-cssselect python3-lxml python3-numpy)

if [ "${#packages[@]}" -gt 0 ]; then
    if [ "$(id -u)" = 0 ] && have apt-get; then
        echo "installing ${packages[*]}"
        # One by one: one that cannot be had must not keep the others away.
        timeout 120 apt-get update -qq >/dev/null || true
        for package in "${packages[@]}"; do
            DEBIAN_FRONTEND=noninteractive timeout 300 \
                apt-get install -y -qq --no-install-recommends "$package" >/dev/null 2>&1 ||
                echo "tests/tools.sh: $package cannot be installed; the tests that need it will skip"
        done
    else
        echo "tests/tools.sh: not root, or no apt-get: install ${packages[*]} yourself to run all tests"
    fi
fi

if have npm && ! cmp -s node/package-lock.json node/node_modules/.installed; then
    if (cd node && timeout 300 npm ci --silent --no-audit --no-fund); then
        cp node/package-lock.json node/node_modules/.installed
    else
        echo "tests/tools.sh: npm ci failed; the tests with rabbit-ear, fold and icons will skip"
    fi
fi
exit 0
