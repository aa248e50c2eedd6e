# Flags of the library itself.
#
# -ffp-contract=off makes float results the same bits on every target, as lib/number/real_f32.h does where no
# flags are passed; -fno-math-errno lets the compiler use its square root instruction.
function(edmlift_compile target)
  target_include_directories(${target}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>)
  set_target_properties(${target} PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
  if(CMAKE_C_COMPILER_ID MATCHES "GNU|Clang")
    target_compile_options(${target} PRIVATE
      -ffp-contract=off -fno-math-errno -ffunction-sections -fdata-sections
      -pedantic -Wall -Wextra -Wconversion -Wshadow -Wvla -Wdouble-promotion)
  endif()
  # There gcc computes floats in double as C99, which the library refuses, and in float as GNU C.
  if(CMAKE_C_COMPILER_ID STREQUAL "GNU" AND CMAKE_SYSTEM_PROCESSOR STREQUAL "s390x")
    set_target_properties(${target} PROPERTIES C_EXTENSIONS ON)
  endif()
  find_library(EDMLIFT_LIBM m)
  if(EDMLIFT_LIBM)
    target_link_libraries(${target} PUBLIC m)
  endif()
endfunction()
