# Set-up that tools/demo, tools/check and others share.  To be sourced, by bash 3.2 or later, under
# `set -euo pipefail`: it goes to the root of the repository and defines
#
#   step TEXT LOG COMMAND...           one line of output; what the command prints is in build/log
#   need_packages [cmake] [COMMAND:PACKAGE]...
#                                      compiler, Python with venv, with `cmake` also that and Ninja or Make,
#                                      and the commands, or files, named: installs what is missing, or says
#                                      its name
#   firmware_packages                  such pairs, for tools/reports/targets.py
#   make_venv [NAME]                   build/venv by tools/requirements.txt; with a NAME build/venv-NAME
#                                      by tools/requirements-NAME.txt.  Sets `venv`
#   use_ccache                         compilers by ccache, where there is one: what was compiled before, by a
#                                      test or in another run, is taken from build/ccache
#   configure FOLDER [OPTION]...       cmake with Ninja where there is one
#
# PYTHON names another interpreter than the first suitable one on the path.

# shellcheck shell=bash
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit
root=$PWD
logs=build/log
venv=build/venv
if ! mkdir -p "$logs" 2>/dev/null || ! [ -w "$logs" ] || ! [ -w build ]; then
    echo "Cannot write into $root/build: copy the repository to a folder of your own." >&2
    exit 1
fi

# What Python compiled of modules is kept, even where the environment says that it is not: a program
# starts in a third of the time.
unset PYTHONDONTWRITEBYTECODE
export PYTHONPYCACHEPREFIX=$root/build/pycache

has() { command -v "$1" >/dev/null 2>&1 || [[ $1 = /* && -e $1 ]]; } # a command, or a file by its whole path

step() {
    local text=$1 log=$logs/$2.log start=$SECONDS
    shift 2
    printf '%-44s' "$text"
    if "$@" >"$log" 2>&1; then
        printf '%4d s\n' $((SECONDS - start))
    else
        printf 'failed\n\n' && tail -n 20 "$log" >&2
        printf '\nThe whole log: %s\n' "$root/$log" >&2
        return 1
    fi
}

# ---- What the system must have -----------------------------------------------------------------

has_compiler() { # with the C library's headers
    has cc && echo '#include <stdio.h>' | cc -E - >/dev/null 2>&1
}

has_cmake() { # 3.16 or later
    local version
    has cmake && version=$(cmake --version | sed -n 's/^cmake version //p') &&
        printf '3.16\n%s\n' "$version" | sort -V -C
}

find_python() { # prints the first one that is 3.11 or later and can make environments
    local python
    for python in ${PYTHON:-python3 python3.13 python3.12 python3.11 /usr/bin/python3}; do
        if "$python" -c 'import ensurepip, sys, venv; sys.exit(sys.version_info < (3, 11))' \
            >/dev/null 2>&1; then
            echo "$python"
            return
        fi
    done
    return 1
}

missing_packages() { # prints Debian's names, those of COMMAND:PACKAGE arguments included
    has_compiler || echo gcc libc6-dev
    find_python >/dev/null || echo python3 python3-venv
    local pair
    for pair in "$@"; do
        if [ "$pair" = cmake ]; then
            has_cmake || echo cmake
            has ninja || has make || echo ninja-build
        else
            has "${pair%%:*}" || echo "${pair#*:}"
        fi
    done
}

as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"; else sudo -n "$@"; fi
}

apt_install() { # waits up to ten minutes where another program installs, as Debian itself does after a start
    as_root env DEBIAN_FRONTEND=noninteractive \
        apt-get install -q -y --no-install-recommends -o DPkg::Lock::Timeout=600 "$@"
}

# What apt-get would install: "31 packages, 120 MB".
apt_size() {
    apt-get install -s -q --no-install-recommends "$@" 2>/dev/null | grep -c '^Inst' | tr '\n' ' '
    printf 'packages, '
    apt-get install --assume-no -q --no-install-recommends -o Debug::NoLocking=1 "$@" 2>/dev/null |
        sed -n 's/^After this operation, \(.*\) of additional disk space.*/\1/p'
}

need_packages() {
    local packages
    packages=$(missing_packages "$@" | xargs)
    [ -n "$packages" ] || return 0
    if has apt-get && as_root true 2>/dev/null; then
        # shellcheck disable=SC2086 # one word a package
        {
            step "Reading Debian's package lists" apt-update as_root apt-get update -q || return 1
            printf 'Missing: %s\n         (%s)\n' "$packages" "$(apt_size $packages)"
            step "Installing them" packages apt_install $packages || return 1
        }
        packages=$(missing_packages "$@" | xargs)
        [ -n "$packages" ] || return 0
    fi
    {
        echo "Please install (Debian's names): $packages"
        echo "Needed: a C compiler, Python 3.11 with venv, where asked for CMake 3.16, or later ones."
    } >&2
    return 1
}

# The C libraries have no command of their own.
# shellcheck disable=SC2034 # used by who sources this
firmware_packages=(
    arm-none-eabi-gcc:gcc-arm-none-eabi arm-none-eabi-gcc:picolibc-arm-none-eabi
    riscv64-unknown-elf-gcc:gcc-riscv64-unknown-elf
    riscv64-unknown-elf-gcc:picolibc-riscv64-unknown-elf
    qemu-system-arm:qemu-system-arm qemu-system-riscv32:qemu-system-misc
)

# ---- Python and CMake --------------------------------------------------------------------------

make_venv() {
    # The copy says what was installed, and is written last.
    local suffix=${1:+-$1} wanted
    wanted=tools/requirements$suffix.txt
    venv=build/venv$suffix
    "$venv/bin/python" -c '' 2>/dev/null && cmp -s "$wanted" "$venv/requirements.txt" && return
    sed -n '1s/^# //p' "$wanted"
    step "Python packages into $venv" "venv$suffix" install_python "$wanted" &&
        cp "$wanted" "$venv/requirements.txt"
}

install_python() {
    "$venv/bin/python" -m pip --version || "$(find_python)" -m venv --clear "$venv" || return 1
    local pip=("$venv/bin/python" -m pip install --disable-pip-version-check) uv
    # Hundreds of megabytes take pip minutes.  Where uv does not get through, pip may, by its settings.
    if uv=$(grep '^uv==' "$1") && "${pip[@]}" "$uv" && "$venv/bin/uv" pip install --python "$venv/bin/python" -r "$1"; then
        return
    fi
    "${pip[@]}" -r "$1"
}

use_ccache() {
    has ccache || return 0
    export CCACHE_DIR=$root/build/ccache CCACHE_MAXSIZE=1G
    local compiler links=$CCACHE_DIR/compilers
    mkdir -p "$links"
    for compiler in cc gcc c++ g++ clang clang++ arm-none-eabi-gcc riscv64-unknown-elf-gcc; do
        if has "$compiler"; then ln -sf "$(command -v ccache)" "$links/$compiler"; fi
    done
    export PATH=$links:$PATH
}

configure() {
    local folder=$1 generator=()
    shift
    # A folder keeps the generator that it was made with.
    if has ninja && [ ! -f "$folder/CMakeCache.txt" ]; then generator=(-G Ninja); fi
    cmake -S . -B "$folder" ${generator[@]+"${generator[@]}"} "$@" # bash 3.2: an empty array is unset
}
