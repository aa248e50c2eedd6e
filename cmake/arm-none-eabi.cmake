# Cross compiling for Cortex-M with arm-none-eabi-gcc and picolibc; CMakePresets.json has cores.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(EDMLIFT_CPU "-mcpu=cortex-m3" CACHE STRING "Flags that name the core")
set(EDMLIFT_QEMU qemu-system-arm)
set(CMAKE_C_FLAGS_INIT "-mthumb ${EDMLIFT_CPU}")
include(${CMAKE_CURRENT_LIST_DIR}/picolibc.cmake)
