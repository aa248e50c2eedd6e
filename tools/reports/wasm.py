"""How the library is compiled to WebAssembly, by clang and wasm-ld, without a C library."""

from data.paths import ROOT

NPM = ROOT / "tools" / "npm"
# Loops that the compiler makes vectors of, or unrolls, are longer and no faster: the kernels say
# themselves where they want either.
COMPILE = [
    "clang", "--target=wasm32", "-std=c99", "-O2",
    "-fno-vectorize", "-fno-slp-vectorize", "-fno-unroll-loops",
    "-mbulk-memory", "-mnontrapping-fptoint",
    "-fvisibility=hidden", "-ffreestanding", f"-I{NPM / 'libc'}",
    "-ffunction-sections", "-fdata-sections",
]  # fmt: skip
EXPORTED = ["-fvisibility=default"]  # all of glue.c, and nothing of the library
LINK = [
    "wasm-ld", "--no-entry", "--export-dynamic", "--gc-sections", "--strip-all", "--stack-first",
    "-z", "stack-size=16384",
]  # fmt: skip
