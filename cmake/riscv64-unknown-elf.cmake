# Cross compiling for RV32 with riscv64-unknown-elf-gcc and picolibc; CMakePresets.json has cores.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR riscv32)
set(CMAKE_C_COMPILER riscv64-unknown-elf-gcc)
set(EDMLIFT_CPU "-march=rv32imc -mabi=ilp32" CACHE STRING "Flags that name the core")
set(EDMLIFT_BOARD virt CACHE STRING "Board that qemu -M knows")
set(EDMLIFT_FLASH 0x80000000,0x400000 CACHE STRING "Address and size of the flash")
set(EDMLIFT_RAM 0x80400000,0x400000 CACHE STRING "Address and size of the RAM")
set(EDMLIFT_QEMU qemu-system-riscv32 -bios none)
set(CMAKE_C_FLAGS_INIT "-mcmodel=medany ${EDMLIFT_CPU}") # QEMU's memory begins at 0x80000000
include(${CMAKE_CURRENT_LIST_DIR}/picolibc.cmake)
