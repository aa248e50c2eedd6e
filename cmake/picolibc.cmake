# What the toolchain files share: picolibc, the board that QEMU imitates, its memory.
#
# Programs print through semihosting and end with an exit status, and `cmake` runs them in QEMU.
# EDMLIFT_FLASH and EDMLIFT_RAM are ADDRESS,SIZE.
set(EDMLIFT_BOARD mps2-an385 CACHE STRING "Board that qemu -M knows")
set(EDMLIFT_FLASH 0,0x400000 CACHE STRING "Address and size of the flash")
set(EDMLIFT_RAM 0x20000000,0x400000 CACHE STRING "Address and size of the RAM")
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
