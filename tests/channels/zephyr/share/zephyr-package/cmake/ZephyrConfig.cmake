# Stands for Zephyr: builds an application and the modules of EXTRA_ZEPHYR_MODULES with the toolchain file that is
# given.
#
# DOTCONFIG is a file that Kconfig wrote.
get_filename_component(ZEPHYR_STUB ${CMAKE_CURRENT_LIST_DIR}/../../.. ABSOLUTE)
include(${ZEPHYR_STUB}/../board.cmake)
project(Zephyr-Stub C)
macro(project)
endmacro()
read_configuration(${DOTCONFIG})

# What all of it is compiled with, and every header of a module's.
add_library(zephyr_interface INTERFACE)
target_include_directories(zephyr_interface INTERFACE ${ZEPHYR_STUB}/include)
target_compile_options(zephyr_interface INTERFACE -std=gnu17 -Os -ffunction-sections -fdata-sections
                       -fno-strict-aliasing -Wall -Wextra -Werror -Wno-unused-parameter)

function(zephyr_include_directories folder)
  get_filename_component(folder ${folder} ABSOLUTE)
  target_include_directories(zephyr_interface INTERFACE ${folder})
endfunction()

macro(zephyr_library_named name)
  set(ZEPHYR_CURRENT_LIBRARY ${name})
  add_library(${name} STATIC)
  target_link_libraries(${name} PUBLIC zephyr_interface)
endmacro()

function(zephyr_library_sources)
  target_sources(${ZEPHYR_CURRENT_LIBRARY} PRIVATE ${ARGN})
endfunction()

function(zephyr_library_compile_options)
  target_compile_options(${ZEPHYR_CURRENT_LIBRARY} PRIVATE ${ARGN})
endfunction()

foreach(module IN LISTS EXTRA_ZEPHYR_MODULES)
  file(STRINGS ${module}/zephyr/module.yml build REGEX "^  cmake: ")
  string(REPLACE "  cmake: " "" build ${build})
  add_subdirectory(${module}/${build} modules/edmlift)
endforeach()

add_board_program(app ${ZEPHYR_STUB}/board.c ${CONFIG_MAIN_STACK_SIZE} edmlift)
set_source_files_properties(src/main.c PROPERTIES COMPILE_DEFINITIONS main=zephyr_main)
add_bits(edmlift)
