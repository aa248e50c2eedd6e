#!/bin/sh
# Fuzzes the lifts, and the readers of lift_stdin, with clang's libFuzzer, in two steps:
#
#     libfuzzer.sh FOLDER build
#     libfuzzer.sh FOLDER run [SECONDS]
#
# Exit status 77 where clang or its runtime is missing.
set -eu
folder=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "$folder/corpus" "$folder/corpus_stdin"

sanitizers=fuzzer,address,undefined,float-divide-by-zero
nothing='int LLVMFuzzerTestOneInput(const char *d, long n) { return d == 0 && n > 0; }'
if ! echo "$nothing" |
    clang -x c -fsanitize=$sanitizers -o "$folder/probe" - 2>"$folder/probe.log"; then
    echo "SKIPPED fuzz_libfuzzer: there is no clang with libFuzzer (Debian: clang, libclang-rt-14-dev)"
    exit 77
fi

build() {
    includes="-I$root/include -I$root/lib -I$root/tests/overflow"
    for part in lift camera; do
        # shellcheck disable=SC2086 # one word a folder
        clang -x c++ -std=gnu++11 -O1 -g -Wno-unused-function -fsanitize=$sanitizers \
            -fno-sanitize=function $includes -c "$root/tests/overflow/$part.cpp" -o "$folder/$part.o"
    done
    # shellcheck disable=SC2086
    clang -std=c99 -O1 -g -ffp-contract=off -fsanitize=$sanitizers -fno-sanitize-recover=all \
        -DEDML_LIBFUZZER $includes "$root/tests/fuzz/fuzz_lift.c" "$root"/lib/*/*.c \
        "$folder/lift.o" "$folder/camera.o" -lm -o "$folder/fuzz_lift"
    stdin=$root/examples/lift_stdin
    parts=$(find "$stdin" -name '*.c' ! -name main.c)
    # shellcheck disable=SC2086
    clang -std=c99 -O1 -g -ffp-contract=off -fsanitize=$sanitizers -fno-sanitize-recover=all \
        -DEDML_LIBFUZZER -DJSON_TEXT=2048 $includes "-I$stdin" "$root/tests/fuzz/fuzz_stdin.c" $parts "$root"/lib/*/*.c \
        -lm -o "$folder/fuzz_stdin"
}

case $2 in
build) build ;;
run) # inputs that exactly fill the 14 keypoints and the byte before them
    "$folder/fuzz_lift" -seed=1 -max_total_time="${3:-10}" -max_len=169 -len_control=0 \
        -artifact_prefix="$folder/" -print_final_stats=1 "$folder/corpus"
    # detectors' files to begin with
    "$folder/fuzz_stdin" -seed=1 -max_total_time="${3:-10}" -max_len=8192 \
        -dict="$root/tests/fuzz/stdin.dict" -artifact_prefix="$folder/" -print_final_stats=1 \
        "$folder/corpus_stdin" "$root/tests/python/cases" ;;
esac
