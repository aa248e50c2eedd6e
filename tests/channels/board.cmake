# What the stand-ins of ESP-IDF and Zephyr share: programs for a board of QEMU's, in the memory of the toolchain file
# that was given.  MHZ is the clock of the chip that it stands for, whose instructions take a cycle each;
# COUNTS_PER_1000 what the board counts in 1000 of them.
set(EDMLIFT_TESTS ${CMAKE_CURRENT_LIST_DIR}/..)

# `board` is a file with main(), which runs the program on a stack of so many bytes, and what it calls of the system;
# the rest is linked.
function(add_board_program name board stack)
  add_executable(${name} ${board})
  set_source_files_properties(${board} PROPERTIES COMPILE_OPTIONS "-Os;-Wno-unused-function" COMPILE_DEFINITIONS
                              "MHZ=${MHZ};COUNTS_PER_1000=${COUNTS_PER_1000};STACK=${stack}")
  target_include_directories(${name} PRIVATE ${EDMLIFT_TESTS}/targets/bench)
  target_link_libraries(${name} PRIVATE ${ARGN} m)
  target_link_options(${name} PRIVATE -DPICOLIBC_INTEGER_PRINTF_SCANF
                      -Wl,--defsym=__stack_size=6144,-Map=${name}.map)
endfunction()

# What the model direct computes, bit by bit.
function(add_bits library)
  add_executable(bits ${EDMLIFT_TESTS}/targets/bits.c)
  target_compile_definitions(bits PRIVATE PARTS=2)
  target_include_directories(bits PRIVATE ${EDMLIFT_TESTS}/../lib)
  target_compile_options(bits PRIVATE -O2)
  target_link_libraries(bits PRIVATE ${library} m)
endfunction()

# Sets what a .config or sdkconfig switches on.
macro(read_configuration file)
  file(STRINGS ${file} lines REGEX "^CONFIG_")
  foreach(line IN LISTS lines)
    string(REGEX MATCH "^(CONFIG_[A-Z0-9_]+)=(.*)$" whole "${line}")
    set(${CMAKE_MATCH_1} "${CMAKE_MATCH_2}")
  endforeach()
endmacro()
