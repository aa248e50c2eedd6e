"""How PlatformIO compiles for an emulated core: its flags are options of the project."""

from SCons.Script import Default, DefaultEnvironment

env = DefaultEnvironment()
cross = env.GetProjectOption("custom_cross")
cpu = env.GetProjectOption("custom_cpu_flags").split()
core = env.GetProjectOption("custom_core")
env.Replace(
    CC=f"{cross}gcc", CXX=f"{cross}g++", LINK=f"{cross}gcc", AR=f"{cross}ar",
    RANLIB=f"{cross}ranlib", PROGSUFFIX=".elf",
)  # fmt: skip
env.Append(
    CCFLAGS=[*cpu, *"-Os -Wall -Wextra -Werror -ffunction-sections -fdata-sections".split()],
    CFLAGS=["-std=gnu11"],
    CXXFLAGS="-std=gnu++11 -fno-exceptions -fno-rtti -fno-threadsafe-statics".split(),
    CPPPATH=[core],
    LINKFLAGS=[*cpu, *env.GetProjectOption("custom_link_flags").split()],
    LIBS=["m"],
)
env.BuildSources("$BUILD_DIR/core", core)
Default(env.BuildProgram())
