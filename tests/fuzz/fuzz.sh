#!/bin/sh
# Fuzzes both lifts with clang's libFuzzer:  fuzz.sh FOLDER [SECONDS]
# Exit status 77 where clang or its runtime is missing.
set -eu
folder=$1
seconds=${2:-10}
root=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p "$folder/corpus"

sanitizers=fuzzer,address,undefined,float-divide-by-zero
if ! echo 'int LLVMFuzzerTestOneInput(const char *d, long n); int LLVMFuzzerTestOneInput(const char *d, long n) { return (int)(n * 0 * (d != 0)); }' |
    clang -x c -fsanitize=$sanitizers -o "$folder/probe" - 2>"$folder/probe.log"; then
    echo "fuzz.sh: no clang with libFuzzer: skipped"
    exit 77
fi
includes="-I$root/include -I$root/lib -I$root/tests/overflow"
for part in lift camera; do
    # shellcheck disable=SC2086 # one word a folder
    clang -x c++ -std=gnu++11 -O1 -g -fsanitize=$sanitizers -fno-sanitize=function -Wno-unused-function $includes \
        -c "$root/tests/overflow/$part.cpp" -o "$folder/$part.o"
done
# shellcheck disable=SC2086
clang -std=c99 -O1 -g -ffp-contract=off -fsanitize=$sanitizers -fno-sanitize-recover=all \
    -DEDML_LIBFUZZER $includes \
    "$root/tests/fuzz_lift.c" "$root"/lib/*/*.c "$folder/lift.o" "$folder/camera.o" -lm \
    -o "$folder/fuzz_lift"
# Inputs that exactly fill the 14 keypoints and the byte before them.
"$folder/fuzz_lift" -seed=1 -max_total_time="$seconds" -max_len=169 -len_control=0 \
    -artifact_prefix="$folder/" -print_final_stats=1 "$folder/corpus"
