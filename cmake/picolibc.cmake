# What the toolchain files share: picolibc, the memory of EDMLIFT_BOARD, QEMU that imitates it.
#
# Programs print through semihosting and end with an exit status, and `cmake` runs them in QEMU.
# EDMLIFT_FLASH and EDMLIFT_RAM are ADDRESS,SIZE.
set(EDMLIFT_LIBM m CACHE STRING "Library of sqrtf()")
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES EDMLIFT_CPU)

string(APPEND CMAKE_C_FLAGS_INIT " --specs=picolibc.specs")
string(REPLACE "," ",--defsym=__flash_size=" flash ${EDMLIFT_FLASH})
string(REPLACE "," ",--defsym=__ram_size=" ram ${EDMLIFT_RAM})
set(CMAKE_EXE_LINKER_FLAGS_INIT "--oslib=semihost --crt0=semihost -Wl,--gc-sections \
-Wl,--defsym=__flash=${flash},--defsym=__ram=${ram},--defsym=__stack_size=2048")
set(CMAKE_EXECUTABLE_SUFFIX_C .elf)
set(CMAKE_CROSSCOMPILING_EMULATOR ${EDMLIFT_QEMU} -M ${EDMLIFT_BOARD} -display none -monitor none
    -serial none -chardev stdio,id=out -semihosting-config enable=on,target=native,chardev=out
    -kernel)
