# Cross compiling for Cortex-M with arm-none-eabi-gcc and picolibc.  EDMLIFT_CPU chooses the core:
# -DEDMLIFT_CPU="-mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard".
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(EDMLIFT_CPU "-mcpu=cortex-m3" CACHE STRING "Flags that name the core")
set(CMAKE_C_FLAGS_INIT "${EDMLIFT_CPU} -mthumb --specs=picolibc.specs")
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES EDMLIFT_CPU)
