#!/bin/sh
# Puts Unity into DEST (DEST/src/unity.c and what it includes), from the copy in Debian's source
# package of cjson: for machines that have a Debian mirror but not Unity's own host.
#
#     get_unity.sh DEST
#
# Needs apt-get, not root; the system's package lists stay as they are.  Nothing is done when DEST
# has the files already.
set -eu

die() {
    echo "get_unity.sh: $*; pass -DUNITY_ROOT=FOLDER with unity.c and unity.h instead" >&2
    exit 1
}

[ $# -eq 1 ] || { echo "usage: get_unity.sh DEST" >&2; exit 2; }
dest=$1
[ -f "$dest/src/unity.h" ] && exit 0 # the last file that is put there
command -v apt-get >/dev/null || die "no apt-get here"

mkdir -p "$dest"
dest=$(cd "$dest" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
mkdir -p lists/partial cache/archives/partial parts

# The system's package sources, asked for source packages: deb822 files, then classic lines.
for file in /etc/apt/sources.list.d/*.sources; do
    [ -f "$file" ] || continue
    sed 's/^Types:.*/Types: deb-src/' "$file" >"parts/$(basename "$file")"
done
cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null |
    sed -n 's/^deb\(-src\)\{0,1\}[[:space:]]/deb-src /p' | sort -u >parts/classic.list
cat parts/* | grep -q deb-src || die "no package sources in /etc/apt"

apt() {
    apt-get -qq -o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts="$PWD/parts" \
        -o Dir::State::Lists="$PWD/lists" -o Dir::Cache="$PWD/cache" -o APT::Sandbox::User= \
        -o Acquire::Retries=1 -o Acquire::http::Timeout=20 -o Acquire::https::Timeout=20 "$@"
}
apt update >log 2>&1 || true # one source that fails need not be the one that matters
apt source --download-only cjson >>log 2>&1 || { cat log >&2; die "cannot fetch Debian's cjson"; }

tar xzf cjson_*.orig.tar.gz --strip-components=3 --wildcards '*/tests/unity/*'
mkdir -p "$dest/src" "$dest/examples"
cp examples/unity_config.h "$dest/examples/" # its unity_internals.h includes this one
cp src/unity.c src/unity_internals.h src/unity.h "$dest/src/"
